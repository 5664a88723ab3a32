#include "base/messages.h"

#include <stdarg.h>
#include <stdio.h>

#include "base/error.h"
#include "base/memory.h"

enum { MESSAGE_LIMIT = 64 };

void brunt_warn(brunt_messages *messages, const char *format, ...) {
    if (!messages->text && !(messages->text = brunt_alloc(MESSAGE_LIMIT * sizeof *messages->text))) return;
    if (messages->count == MESSAGE_LIMIT) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(messages->text[messages->count++], sizeof *messages->text, format, arguments);
    va_end(arguments);
}

void brunt_messages_free(brunt_messages *messages) { brunt_free(messages->text); }

void brunt_messages_validate(const brunt_messages *m) { BRUNT_ASSERT(m->count >= 0 && (m->count == 0 || m->text)); }
