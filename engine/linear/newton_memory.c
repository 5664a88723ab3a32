// What lasts from one minimisation to the next, and what is usual.
#include "base/error.h"
#include "base/memory.h"
#include "linear/newton.h"

brunt_newton_options brunt_newton_defaults(void) {
    return (brunt_newton_options){
        .iterations = 100, .accuracy = 1e-3, .linear_iterations = 5000, .early = true, .solver = &brunt_linear_direct};
}

void brunt_newton_free(brunt_newton *n) {
    brunt_block_matrix_free(&n->matrix);
    brunt_matrix_free_free(&n->free);
    brunt_linear_close(&n->linear);
    brunt_free(n->gradient), brunt_free(n->step), brunt_free(n->trial), brunt_free(n->stencils);
    *n = (brunt_newton){0};
}

void brunt_newton_validate(const brunt_newton *n) {
    brunt_block_matrix_validate(&n->matrix);
    brunt_block_matrix_validate(&n->free.blocks);
    BRUNT_ASSERT(n->analysed >= 0 && (n->analysed == 0 || n->linear.ops)); // what is analysed is so by a solver
    BRUNT_ASSERT(!n->linear.ops == !n->linear.self);
}
