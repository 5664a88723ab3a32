// What a run says while it runs: to the console and, the same lines, to log.txt; one line about how far it is.
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "brunt.h"

typedef struct brunt_console {
    FILE *out;       // NULL: nothing is shown
    FILE *log;       // NULL: nothing is kept
    bool terminal;   // `out` is one: the progress line is rewritten in place
    bool line_open;  // a progress line stands on the terminal
    bool log_failed; // a line could not be written to the log
} brunt_console;

// `out` may be NULL.
brunt_console brunt_console_open(FILE *out);
// Prints to both; ends a progress line first.
void brunt_console_print(brunt_console *console, const char *format, ...) __attribute__((format(printf, 2, 3)));

typedef struct brunt_progress {
    brunt_console *console;
    double start_time, start_wall;  // [s] of the run, [s] of this leg's clock
    double shown_wall, logged_wall; // [s] when a line was last shown, logged
    double rate_wall, rate_time;    // [s] where the present window of rates began
    long long rate_steps;
    double steps_per_second, time_per_second; // of the last window
} brunt_progress;

brunt_progress brunt_progress_start(brunt_console *console, const brunt_world *world);
// Shows a line when one is due: every half second on a terminal; in a log the first after a second, then every ten.
void brunt_progress_update(brunt_progress *progress, brunt_world *world);
// Closes the line on a terminal.
void brunt_progress_end(brunt_progress *progress);

// "1 h 02 min", "3 min 20 s", "12 s", "0.5 s"
void brunt_duration(double seconds, char out[32]);
// "5000 particles", "1200 elements", "5000 particles, 1200 elements"
void brunt_counts(const brunt_world *world, char out[64]);
