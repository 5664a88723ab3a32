// Warnings for the user, kept until they are asked for.
#pragma once

typedef struct brunt_messages {
    char (*text)[256];
    int count;
} brunt_messages;

void brunt_warn(brunt_messages *messages, const char *format, ...) __attribute__((format(printf, 2, 3)));
void brunt_messages_free(brunt_messages *messages);
void brunt_messages_validate(const brunt_messages *messages); // aborts where there is a count and no text
