// Warnings for the user, kept with the world.
#pragma once

typedef struct brunt_messages {
    char (*text)[256];
    int count;
} brunt_messages;
