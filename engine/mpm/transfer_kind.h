// What p2g and g2p are compiled for. The list of instances (transfer.c) gives every member as a literal, and the cores,
// always inline, are then loops of fixed lengths without branches.
#pragma once

#include <stdbool.h>

#include "brunt.h"

// Where kernels and material live.
typedef enum transfer_form {
    UPDATED,      // kernels in the present configuration; plane strain or space
    AXISYMMETRIC, // rings about x = 0: dimension 2, material points of dimension 3
    TOTAL         // kernels in the undeformed configuration
} transfer_form;

// Which part of g2p. The linear kernel does it in two: see g2p.h.
typedef enum transfer_stage { WHOLE, MUSL_VELOCITY, AFTER_MUSL } transfer_stage;

typedef struct transfer_kind {
    int dim, order; // of space, 2 or 3; of the kernel: 1 linear, 2 quadratic, 3 cubic
    brunt_transfer transfer;
    bool keeps; // of APIC: particles keep a share of what the grid does not see (g2p.h)
    transfer_form form;
    transfer_stage stage;
} transfer_kind;
