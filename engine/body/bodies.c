#include "body/bodies.h"

#include <string.h>

#include "base/error.h"

const char *brunt_bodies_name(const brunt_bodies *bodies, int body) {
    const brunt_body_ref *ref = &bodies->all[body];
    return ref->ops->name(ref);
}

int brunt_bodies_find(const brunt_bodies *bodies, const char *name) {
    int low = 0, high = bodies->count;
    while (low < high) {
        const int middle = (low + high) / 2, order = strcmp(brunt_bodies_name(bodies, middle), name);
        if (order == 0) return middle;
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return BRUNT_NONE;
}

brunt_body_ref *brunt_bodies_summed(const brunt_bodies *bodies, int i) {
    const bool points = i < bodies->mpm_count;
    return &bodies->all[points ? bodies->mpm[i].index : bodies->fem[i - bodies->mpm_count].index];
}

void brunt_bodies_validate(const brunt_bodies *bodies) {
    BRUNT_ASSERT(bodies->mpm_count + bodies->fem_count == bodies->count);
    for (int i = 0; i < bodies->count; i++) {
        const brunt_body_ref *ref = &bodies->all[i];
        BRUNT_ASSERT(!ref->mpm != !ref->fem && ref->ops == (ref->mpm ? &brunt_points_ops : &brunt_mesh_ops));
        BRUNT_ASSERT((ref->mpm ? ref->mpm->index : ref->fem->index) == i);
        BRUNT_ASSERT(!i || strcmp(brunt_bodies_name(bodies, i - 1), brunt_bodies_name(bodies, i)) < 0);
        ref->ops->validate(ref);
    }
}
