// Parts of a set, each swept over by one thread. Private to the solution.
#pragma once

#include "contact/constraint/constraint.h"

enum { BRUNT_CONSTRAINT_GRAIN = 128 }; // constraints of a chunk

// Divides the chunks of points among at most `threads` threads by where they are, makes the columns of the nodes that
// points of several parts press on, and room for what those are given. Which part a point is in changes no sum.
// BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_constraints_make_parts(brunt_constraint_set *set, int threads, brunt_timer *timer, brunt_error *error);
// Runs a task over the chunks, in the order of the points within a part.
void brunt_constraints_over_parts(brunt_constraint_set *set, int threads, brunt_task_fn *task, brunt_timer *timer);
