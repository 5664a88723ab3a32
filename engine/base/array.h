// Growable arrays: a typed pointer, and beside it what it can hold as size_t `array_capacity` [bytes].
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/memory.h"

// How many elements an array has whose extent is its initialiser's.
#define BRUNT_COUNT(table) ((int)(sizeof(table) / sizeof *(table)))

// Makes `array` hold `count` elements and keeps its first `keep`; what is new is zero. Grows by half to stay rare: a
// block is taken only when there is not room. Whether there is none: then the array is as it was. The arguments are
// evaluated more than once.
//   double *x; size_t x_capacity;   ...   if (BRUNT_RESERVE(s->x, n, 0)) ...
#define BRUNT_RESERVE(array, count, keep) BRUNT_RESERVE_IN(array, array##_capacity, count, keep)

// Room for one more element than `array_count`, all of which are kept.
#define BRUNT_GROW(array) BRUNT_RESERVE(array, (size_t)array##_count + 1, (size_t)array##_count)

// The same where the capacity has another name.
#define BRUNT_RESERVE_IN(array, capacity, count, keep)                                                                 \
    ((array) = brunt_array_fit((array), &(capacity), sizeof *(array), (count), (keep)),                                \
     !brunt_array_holds((array), (capacity), sizeof *(array), (count)))

// The same with words: BRUNT_OK, or BRUNT_FAILED with what (a plural) there was no memory for.
//   if (BRUNT_CAPACITY(s->x, n, 0, "places of nodes", error)) return BRUNT_FAILED;
#define BRUNT_CAPACITY(array, count, keep, what, error)                                                                \
    BRUNT_CAPACITY_IN(array, array##_capacity, count, keep, what, error)
#define BRUNT_CAPACITY_IN(array, capacity, count, keep, what, error)                                                   \
    (BRUNT_RESERVE_IN(array, capacity, count, keep)                                                                    \
         ? brunt_fail_memory((error), (what), (size_t)(count), sizeof *(array))                                        \
         : BRUNT_OK)
#define BRUNT_CAPACITY_MORE(array, what, error)                                                                        \
    BRUNT_CAPACITY(array, (size_t)array##_count + 1, (size_t)array##_count, what, error)

// The same of what is made once and freed by brunt_free: zeros.
#define BRUNT_NEW(array, count, what, error)                                                                           \
    ((array) = brunt_alloc((size_t)(count) * sizeof *(array)),                                                         \
     (array) ? BRUNT_OK : brunt_fail_memory((error), (what), (size_t)(count), sizeof *(array)))

// The memory of an array that has been made to hold `count` elements of `size` bytes, or `memory` itself when it held
// them or nothing is left. It is returned, not written through a pointer: a T * is no void * (C17 6.5p7).
void *brunt_array_fit(void *memory, size_t *capacity, size_t size, size_t count, size_t keep);

static inline bool brunt_array_holds(const void *memory, size_t capacity, size_t size, size_t count) {
    return memory && count <= capacity / size;
}
