#include "base/error.h"

#include <stdio.h>
#include <stdlib.h>

int brunt_fail(brunt_error *error, int code, const char *format, ...) {
    if (!error) return code;
    error->code = code;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    return code;
}

// The one place where the library ends the process: after a programmer's error nothing it holds can be trusted.
void brunt_assert_failed(const char *condition, const char *file, int line) {
    fprintf(stderr, "brunt: %s:%d: assertion failed: %s\n", file, line, condition);
    abort();
}
