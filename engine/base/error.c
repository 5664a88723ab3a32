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

int brunt_fail_memory(brunt_error *error, const char *what, size_t count, size_t size) {
    return brunt_fail(error, BRUNT_FAILED, "out of memory: no room for %zu %s of %zu bytes each", count, what, size);
}

int brunt_hand_on(brunt_error *error, const brunt_error *from) {
    return from->code ? brunt_fail(error, from->code, "%s", from->message) : BRUNT_OK;
}

// The one place where the library ends the process: after a programmer's error nothing it holds can be trusted.
void brunt_assert_failed(const char *condition, const char *file, int line) {
    fprintf(stderr, "brunt: %s:%d: assertion failed: %s\n", file, line, condition);
    abort();
}
