// What the machine can do at most, measured now: the two sides of the roofline model (S. Williams, A. Waterman, D.
// Patterson, Commun. ACM 52(4), 2009).
#pragma once

#include "base/error.h"

// Bandwidth to memory [B/s] of a triad a = b + s c over arrays far larger than the caches (written lines count twice:
// they are read first), and arithmetic [flop/s] of independent multiply-adds of `real` in registers, on `threads`
// threads. Takes some 0.3 s. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_roofline_measure(int threads, double *bytes_per_second, double *flops_per_second, brunt_error *error);
