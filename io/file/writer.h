// A thread that writes files beside the steps, one after the other in the order in which they are given.
//
// It is one of the run's threads: while it is at work the phases of steps take one fewer (base/parallel.h). Without it
// files are written where they are given. While it lives no other thread calls HDF5, which may not be made for threads.
#pragma once

#include <stdbool.h>

#include "brunt.h"

// What is to be written, taken from the run: nothing that steps change is looked at. `release` follows in any case, in
// place of `write` once another job has failed.
typedef struct brunt_job {
    int (*write)(void *job, brunt_error *error);
    void (*release)(void *job);
    void *job;
} brunt_job;

typedef struct brunt_writer brunt_writer;

// NULL and BRUNT_FAILED: out of memory. Where the system makes no thread, files are written where they are given.
brunt_writer *brunt_writer_start(bool beside, brunt_error *error);
// Once all that was given is written, or has failed. NULL: nothing.
void brunt_writer_end(brunt_writer *writer);

// Takes over a job, and waits as long as too many are in line. What earlier ones have failed at is told, as by
// brunt_writer_wait, but not forgotten.
int brunt_writer_give(brunt_writer *writer, brunt_job job, brunt_error *error);
// All that was given has been written when it returns BRUNT_OK; otherwise says what the first failure was, after which
// nothing was written, and forgets it.
int brunt_writer_wait(brunt_writer *writer, brunt_error *error);
// Whether something has failed that brunt_writer_wait has not told yet.
bool brunt_writer_failed(brunt_writer *writer);
