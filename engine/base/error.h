// Errors the library returns. It never prints and never exits: the caller decides.
#pragma once

#include <stdarg.h>

#include "brunt.h"

// Fills `error` (may be NULL) with a code and a formatted message, and returns the code.
int brunt_fail(brunt_error *error, int code, const char *format, ...) __attribute__((format(printf, 3, 4)));

// A programmer's error: says where and aborts. Never used for what a user can get wrong.
void brunt_assert_failed(const char *condition, const char *file, int line);
#define BRUNT_ASSERT(condition) ((condition) ? (void)0 : brunt_assert_failed(#condition, __FILE__, __LINE__))
