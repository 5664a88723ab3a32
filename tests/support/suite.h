// What every suite ends with.
#pragma once

#include <check.h>
#include <stdlib.h>

// Check's process writes down where each assertion holds, a call of the system each time: a loop of a million takes
// seconds, and most of a suite's time. A test that crashes is told by its name and where it begins.
#define _mark_point(file, line) ((void)0)

// The sanitizers see what is done with memory and numbers, not what comes of it, and take several times as long: what
// goes where others have gone is left out there.
#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

// A tolerance for either precision of the engine.
#ifdef BRUNT_FLOAT
#define TOLERANCE(in_double, in_float) (in_float)
#else
#define TOLERANCE(in_double, in_float) (in_double)
#endif

// Runs a suite; the exit code of its program: 1 when a test failed, or CK_RUN_CASE names none of it. That single
// precision has nothing of a suite is no failure.
static inline int suite_main(Suite *suite) {
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner), run = srunner_ntests_run(runner);
    srunner_free(runner);
    return failed || (!run && getenv("CK_RUN_CASE"));
}
