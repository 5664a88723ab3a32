// What every suite ends with.
#pragma once

#include <check.h>
#include <stdlib.h>

// Runs a suite; the exit code of its program: 1 when a test failed, or CK_RUN_CASE names none of it. That single
// precision has nothing of a suite is no failure.
static inline int suite_main(Suite *suite) {
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner), run = srunner_ntests_run(runner);
    srunner_free(runner);
    return failed || (!run && getenv("CK_RUN_CASE"));
}
