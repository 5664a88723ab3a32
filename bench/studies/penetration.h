// How deep one body is inside another: measured from outside, with nothing of the contact code.
#pragma once

#include "brunt.h"

typedef struct brunt_gap_probe brunt_gap_probe;

// Watches all pairs of finite-element bodies of a world. NULL: out of memory.
brunt_gap_probe *brunt_gap_probe_make(brunt_world *world);
void brunt_gap_probe_free(brunt_gap_probe *probe);
// Of the bodies as they are now: the greatest depth of a boundary node inside another body's elements [m], 0 when none
// is inside; and the least distance of a boundary node from another body's surface [m].
void brunt_gap_measure(brunt_gap_probe *probe, double *depth, double *distance);
