// What a test measures of a hard case, for the page of all of them (hard_cases.md, made by hard_cases.py).
#pragma once

#include "tests/support/suite.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

// Asserts that `measured` is at most `bound`, which is the least that must go on to hold, and tells the page what was
// measured beside what is `asked`: equal where the case holds. `number` is the case's in the catalogue, C01 to C31; the
// format and what follows say what is measured and in which unit. Where the environment's BRUNT_HARD_CASES names a
// folder, a line for the page is added to a file there.
__attribute__((format(printf, 5, 6))) static inline void hard_case(const char *number, double measured, double asked,
                                                                   double bound, const char *format, ...) {
    char what[200], path[4096];
    va_list values;
    va_start(values, format);
    vsnprintf(what, sizeof what, format, values);
    va_end(values);
    printf("  %s %s: %.3g, asked %.3g\n", number, what, measured, asked);
    const char *folder = getenv("BRUNT_HARD_CASES");
    if (folder && *folder) {
        snprintf(path, sizeof path, "%s/%s.tsv", folder, program_invocation_short_name);
        FILE *file = fopen(path, "a");
        ck_assert_msg(file != NULL, "%s cannot be written", path);
        fprintf(file, "%s\t%s\t%s\t%.2g\t%.3g\t%s\n", number, program_invocation_short_name, what, measured, asked,
                measured <= asked ? "holds" : "falls short");
        fclose(file);
    }
    ck_assert_msg(measured <= bound, "%s %s: %.6g, more than %.6g", number, what, measured, bound);
}
