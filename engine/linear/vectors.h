// Sums over vectors in pieces of fixed length, whose sums are added in order: the same bits for any number of threads.
#pragma once

#include "linear/term.h"

enum { BRUNT_SUM_PIECE = 4096 };

// Sums that brunt_dot wants room for.
static inline int64_t brunt_sum_pieces(int64_t count) { return (count + BRUNT_SUM_PIECE - 1) / BRUNT_SUM_PIECE; }

// a . b; `sums`: brunt_sum_pieces(count).
double brunt_dot(const brunt_team *team, int64_t count, const double *a, const double *b, double *sums);
// y += a x
void brunt_add_scaled(const brunt_team *team, int64_t count, double a, const double *x, double *y);
// y += a p, and then p = z + b p: one pass over p
void brunt_add_and_turn(const brunt_team *team, int64_t count, double a, double *p, double *y, double b,
                        const double *z);
