#include "mpm/transfers.h"

#include "base/error.h"

void brunt_transfers_make(brunt_transfers *t, const brunt_world_def *def) {
    t->p2g = def->cells != BRUNT_QUADS ? brunt_p2g_triangles
                                       : brunt_find_p2g(def->dimension, def->axisymmetric, def->kernel, def->transfer);
    t->total_p2g = brunt_find_total_p2g(def->dimension, def->kernel, def->transfer);
    t->total_g2p = brunt_find_total_g2p(def->dimension, def->kernel, def->transfer);
    t->g2p = brunt_find_g2p(def->dimension, def->axisymmetric, def->kernel, def->transfer);
    t->outs = BRUNT_OUT_USUAL;
    if (def->transfer == BRUNT_APIC && def->apic > 0) {
        t->total_g2p = brunt_find_keeping_g2p(def->dimension, def->axisymmetric, def->kernel, true);
        t->g2p = brunt_find_keeping_g2p(def->dimension, def->axisymmetric, def->kernel, false);
        t->outs = BRUNT_OUT_KEEPING;
    }
    t->musl_velocity = brunt_find_musl_velocity(def->dimension, def->axisymmetric, def->kernel, def->transfer);
}

void brunt_transfers_validate(const brunt_transfers *t) {
    BRUNT_ASSERT(t->p2g && t->g2p && !t->total_p2g == !t->total_g2p);
}
