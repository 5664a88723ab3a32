// The system of an iteration of Newton's method without its matrix: products are those of the terms that have them
// (bodies, from their tangents at points), and of a small matrix of the others, which couples what is in contact alone.
// Of the whole there are the blocks on the diagonal, for the preconditioner.
#pragma once

#include "linear/fold.h"

typedef struct brunt_matrix_free {
    brunt_block_matrix blocks; // the diagonal of all: the matrix that a solver is given
    // What products are of: terms, and the matrix of those without products; unknowns that are held (NULL: none) have
    // rows and columns of the unit matrix.
    const brunt_block_matrix *rest;
    const brunt_term *terms;
    int count;
    const uint8_t *held;
    const brunt_fold *fold; // nodes that follow others, as `rest` has them already; NULL: none
    double raise;           // diagonal entries are multiplied by 1 + this
    double *x;              // what is multiplied, 0 where it is held, of followers as of their leaders
    size_t x_capacity;
} brunt_matrix_free;

// The Hessian at u of the terms that have products, and the blocks; of the others `rest` has it already. BRUNT_OK, or
// BRUNT_FAILED: out of memory.
int brunt_matrix_free_take(brunt_matrix_free *f, const brunt_team *team, const double *u, bool project,
                           brunt_error *error);
// Holds what is to be held, raises the diagonal: of the blocks; products follow.
void brunt_matrix_free_hold(brunt_matrix_free *f, const brunt_team *team);
void brunt_matrix_free_raise(brunt_matrix_free *f, double raise);
// y = A x, of the system that is solved (brunt_product_fn).
void brunt_matrix_free_product(void *matrix_free, const brunt_team *team, const double *x, double *y);
// y = H x, of the Hessian itself: nothing is held or raised; x has followers as their leaders, y nothing of them.
void brunt_matrix_free_hessian(const brunt_matrix_free *f, const brunt_team *team, const double *x, double *y);
size_t brunt_matrix_free_bytes(const brunt_matrix_free *f);
void brunt_matrix_free_free(brunt_matrix_free *f);
