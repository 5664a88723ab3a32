// What parts of a definition are looked at by: numbers, names, choices, arrays. Each gives BRUNT_OK, or BRUNT_BAD_INPUT
// with `owner` and `key` and what is wrong ("bodies.rod" and ".size").
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "brunt/error.h"
#include "brunt/mesh.h"
#include "brunt/shape.h"

#define BRUNT_TRY(...)                                                                                                 \
    do {                                                                                                               \
        const int tried = (__VA_ARGS__);                                                                               \
        if (tried) return tried;                                                                                       \
    } while (0)

// What a number may be besides finite and of a size that can be computed with.
enum { BRUNT_ANY_NUMBER = 0, BRUNT_NOT_NEGATIVE = 1, BRUNT_POSITIVE = 2, BRUNT_OR_INFINITE = 4, BRUNT_OR_NAN = 8 };

typedef struct brunt_numbers {
    const char *key;
    const double *value;
    int count, rule;
} brunt_numbers;

int brunt_check_number(const char *owner, const char *key, double v, int rule, brunt_error *error);
int brunt_check_numbers(const char *owner, const brunt_numbers *list, size_t count, brunt_error *error);
// Returns from the function that has it when one of {key, values, count, rule}, ... is wrong.
#define BRUNT_CHECK_NUMBERS(owner, ...)                                                                                \
    BRUNT_TRY(brunt_check_numbers(owner, (const brunt_numbers[]){__VA_ARGS__},                                         \
                                  sizeof((const brunt_numbers[]){__VA_ARGS__}) / sizeof(brunt_numbers), error))
int brunt_check_array(const char *what, int32_t count, const void *array, brunt_error *error);
// A name ends within its array.
int brunt_check_name_ends(const char *what, int index, const char name[BRUNT_NAME_LENGTH], brunt_error *error);
// An enumerator is one of the first `count` numbers.
int brunt_check_choice(const char *owner, const char *key, unsigned value, unsigned count, brunt_error *error);
int brunt_check_curve(const char *owner, const char *key, const brunt_curve *curve, brunt_error *error);
