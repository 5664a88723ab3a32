// Errors the library returns. It never prints and never exits: the caller decides.
#pragma once

#include <stdarg.h>
#include <stddef.h>

#include "brunt.h"

// Fills `error` (may be NULL) with a code and a formatted message, and returns the code.
int brunt_fail(brunt_error *error, int code, const char *format, ...) __attribute__((format(printf, 3, 4)));
// There is no memory for `count` of what is said, of `size` bytes each. BRUNT_FAILED.
int brunt_fail_memory(brunt_error *error, const char *what, size_t count, size_t size) __attribute__((cold));
// Hands on what went wrong where it could not be told at once: of a thread, of a part. Its code; BRUNT_OK: nothing did.
int brunt_hand_on(brunt_error *error, const brunt_error *from);

enum { BRUNT_NONE = -1 }; // of a place in a list: there is none

// A programmer's error: says where and aborts. Never used for what a user can get wrong.
void brunt_assert_failed(const char *condition, const char *file, int line);
#define BRUNT_ASSERT(condition) ((condition) ? (void)0 : brunt_assert_failed(#condition, __FILE__, __LINE__))
