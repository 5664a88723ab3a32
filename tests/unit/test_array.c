// Labels: double
// Growable arrays: what they keep, what is zero, when a block is taken.
#include <check.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/memory.h"
#include "tests/support/suite.h"

typedef struct item {
    double x[3];
} item;

START_TEST(grows_by_half_and_keeps) {
    struct {
        item *list;
        size_t list_capacity;
        int32_t list_count;
    } s = {0};
    const int64_t calls = brunt_memory_calls();
    for (int32_t n = 0; n < 1000; n++) {
        ck_assert(!BRUNT_GROW(s.list));
        ck_assert_double_eq(s.list[n].x[2], 0);
        s.list[s.list_count++].x[2] = n + 1;
    }
    ck_assert_int_lt(brunt_memory_calls() - calls, 20); // 1.5^17 = 985
    for (int32_t n = 0; n < 1000; n++) ck_assert_double_eq(s.list[n].x[2], n + 1);
    const item *before = s.list;
    const int64_t settled = brunt_memory_calls();
    ck_assert(!BRUNT_RESERVE(s.list, 10, 0));
    ck_assert_ptr_eq(s.list, before);
    ck_assert_int_eq(brunt_memory_calls(), settled);
    brunt_free(s.list);
}
END_TEST

START_TEST(nothing_asked_for_is_an_array) {
    double *list = NULL;
    size_t room = 0;
    ck_assert(!BRUNT_RESERVE_IN(list, room, 0, 0));
    ck_assert_ptr_nonnull(list);
    brunt_free(list);
}
END_TEST

// The address sanitizer ends a program that asks for too much unless it is told to give nothing.
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void) { return "allocator_may_return_null=1"; }

// More bytes than a size_t counts, and more than there are: refused, and the array is as it was.
START_TEST(refused_as_it_was) {
    item *list = NULL;
    size_t list_capacity = 0;
    ck_assert(!BRUNT_RESERVE(list, 3, 0));
    list[2].x[0] = 7;
    const item *before = list;
    const size_t had = list_capacity;
    ck_assert(BRUNT_RESERVE(list, SIZE_MAX / sizeof(item) + 2, 3));
    ck_assert(BRUNT_RESERVE(list, SIZE_MAX / 4 / sizeof(item), 3));
    ck_assert_ptr_eq(list, before);
    ck_assert_uint_eq(list_capacity, had);
    ck_assert_double_eq(list[2].x[0], 7);
    brunt_free(list);
}
END_TEST

// What there was no room for, how many and how large: the same words for an array that grows and one that is made once.
START_TEST(refused_with_words) {
    item *list = NULL, *other;
    size_t list_capacity = 0;
    brunt_error error = {.id = -1};
    const size_t many = SIZE_MAX / 4 / sizeof(item);
    char wanted[128];
    snprintf(wanted, sizeof wanted, "out of memory: no room for %zu places of nodes of %zu bytes each", many,
             sizeof(item));
    ck_assert_int_eq(BRUNT_CAPACITY(list, 3, 0, "places of nodes", &error), BRUNT_OK);
    ck_assert_int_eq(error.code, BRUNT_OK);
    ck_assert_int_eq(BRUNT_CAPACITY(list, many, 3, "places of nodes", &error), BRUNT_FAILED);
    ck_assert_int_eq(error.code, BRUNT_FAILED);
    ck_assert_str_eq(error.message, wanted);
    error = (brunt_error){.id = -1};
    ck_assert_int_eq(BRUNT_NEW(other, many, "places of nodes", &error), BRUNT_FAILED);
    ck_assert_ptr_null(other);
    ck_assert_str_eq(error.message, wanted);
    brunt_free(list);
}
END_TEST

// What failed in a thread is handed on with its words, and with nothing else of it.
START_TEST(handed_on) {
    brunt_error error = {.id = -1, .time = 3}, thread = {0};
    ck_assert_int_eq(brunt_hand_on(&error, &thread), BRUNT_OK);
    ck_assert_int_eq(error.code, BRUNT_OK);
    ck_assert_int_eq(brunt_fail_memory(&thread, "places of nodes", 2, 24), BRUNT_FAILED);
    ck_assert_int_eq(brunt_hand_on(&error, &thread), BRUNT_FAILED);
    ck_assert_int_eq(error.code, BRUNT_FAILED);
    ck_assert_str_eq(error.message, thread.message);
    ck_assert_int_eq(error.id, -1);
    ck_assert_double_eq(error.time, 3);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("array");
    TCase *c = tcase_create("array");
    tcase_add_test(c, grows_by_half_and_keeps);
    tcase_add_test(c, nothing_asked_for_is_an_array);
    tcase_add_test(c, refused_as_it_was);
    tcase_add_test(c, refused_with_words);
    tcase_add_test(c, handed_on);
    suite_add_tcase(suite, c);
    return suite_main(suite);
}
