// Nodes that follow others: the image of a node by a symmetry plane goes where the node goes, turned. Terms are
// functions of all nodes and know nothing of it; what is minimised is their sum at u = P u_free, with gradient P^T g
// and Hessian P^T H P. Followers stay among the unknowns; what is solved has rows and columns of the unit matrix for
// them.
#pragma once

#include "linear/block_matrix.h"

typedef struct brunt_fold {
    int32_t count;
    const int32_t *follower; // ascending
    const int32_t *leader;   // of every node; itself where it follows none. A leader follows none
    const double *sign;      // of every component of every node: its leader's times -1, 0 or 1
} brunt_fold;

// x = P x: followers as their leaders.
void brunt_fold_spread(const brunt_fold *fold, int dim, double *x);
// g = P^T g: what followers have goes to their leaders, and is 0 then.
void brunt_fold_gather(const brunt_fold *fold, int dim, double *g);
// H = P^T H P, of a matrix whose pattern is of the fold too (block_matrix.h): rows and columns of followers are 0.
void brunt_fold_matrix(const brunt_fold *fold, const brunt_team *team, brunt_block_matrix *m);
// Diagonal blocks of followers go to their leaders, in a matrix that has no others.
void brunt_fold_diagonal(const brunt_fold *fold, brunt_block_matrix *m);
// Diagonal entries of followers are 1.
void brunt_fold_hold(const brunt_fold *fold, brunt_block_matrix *m);
