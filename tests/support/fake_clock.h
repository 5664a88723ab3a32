// A clock that no other work on the machine touches, in the place of engine/base/clock.c: a reading is one tick later
// than the one before, by whichever thread. Ticks are powers of two, so that sums and differences of times are exact.
#pragma once

#include <stdatomic.h>
#include <stdint.h>

#include "base/parallel.h"

static _Atomic int64_t fake_ticks;
static double fake_tick = 0x1p-16; // [s]

double brunt_clock(void) { return fake_tick * (double)atomic_fetch_add(&fake_ticks, 1); }
