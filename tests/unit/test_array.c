// Labels: unit
// Growable arrays: what they keep, what is zero, when a block is taken.
#include <check.h>
#include <stdint.h>
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
        ck_assert_int_eq(BRUNT_GROW(s.list), 0);
        ck_assert_double_eq(s.list[n].x[2], 0);
        s.list[s.list_count++].x[2] = n + 1;
    }
    ck_assert_int_lt(brunt_memory_calls() - calls, 20); // 1.5^17 = 985
    for (int32_t n = 0; n < 1000; n++) ck_assert_double_eq(s.list[n].x[2], n + 1);
    const item *before = s.list;
    const int64_t settled = brunt_memory_calls();
    ck_assert_int_eq(BRUNT_RESERVE(s.list, 10, 0), 0);
    ck_assert_ptr_eq(s.list, before);
    ck_assert_int_eq(brunt_memory_calls(), settled);
    brunt_free(s.list);
}
END_TEST

START_TEST(nothing_asked_for_is_an_array) {
    double *list = NULL;
    size_t room = 0;
    ck_assert_int_eq(BRUNT_RESERVE_IN(list, room, 0, 0), 0);
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
    ck_assert_int_eq(BRUNT_RESERVE(list, 3, 0), 0);
    list[2].x[0] = 7;
    const item *before = list;
    const size_t had = list_capacity;
    ck_assert_int_eq(BRUNT_RESERVE(list, SIZE_MAX / sizeof(item) + 2, 3), -1);
    ck_assert_int_eq(BRUNT_RESERVE(list, SIZE_MAX / 4 / sizeof(item), 3), -1);
    ck_assert_ptr_eq(list, before);
    ck_assert_uint_eq(list_capacity, had);
    ck_assert_double_eq(list[2].x[0], 7);
    brunt_free(list);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("array");
    TCase *c = tcase_create("array");
    tcase_add_test(c, grows_by_half_and_keeps);
    tcase_add_test(c, nothing_asked_for_is_an_array);
    tcase_add_test(c, refused_as_it_was);
    suite_add_tcase(suite, c);
    return suite_main(suite);
}
