// Another program, run to its end: with a limit on its time, and stopped with this one.
#pragma once

#include <signal.h>

#include "brunt.h"

typedef enum brunt_child_fate {
    BRUNT_CHILD_ENDED,   // with `code`
    BRUNT_CHILD_KILLED,  // by the signal `code`
    BRUNT_CHILD_TIMEOUT, // by us, past its limit
    BRUNT_CHILD_STOPPED  // it was told to stop because this program was
} brunt_child_fate;

typedef struct brunt_child_end {
    brunt_child_fate fate;
    int code;
    double seconds; // [s] of the clock, start and end included
} brunt_child_end;

// Runs arguments[0] with the arguments (NULL ends them) and waits. What it prints is dropped, what it says of errors
// goes to the file `messages`. `limit`: [s], INFINITY for none. `stop` (may be NULL): as soon as it is not 0 the child
// gets SIGTERM and ten seconds. A child does not outlive this program. BRUNT_IO_ERROR when it cannot be started.
int brunt_child_run(char *const *arguments, const char *messages, double limit, const volatile sig_atomic_t *stop,
                    brunt_child_end *end, brunt_error *error);
