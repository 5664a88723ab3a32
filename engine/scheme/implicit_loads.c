// What acts in an implicit step beside stress and contact, and how fast it makes things go at its start.
#include <string.h>

#include "boundary/gravity.h"
#include "scheme/implicit.h"

void brunt_implicit_loads(brunt_world *world, double time, double *load) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_unknowns *u = &m->unknowns;
    double gravity[3];
    brunt_gravity_at(&world->settings, time, gravity);
    for (int32_t n = 0; n < u->count; n++)
        for (int a = 0; a < u->dim; a++) load[n * (int64_t)u->dim + a] = u->mass[n] * gravity[a];
    if (!world->boundaries.sets.count) return;
    brunt_loads_begin(&world->boundaries.sets, &world->bodies, time, 0);
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        for (int32_t i = 0; fem->load && i < fem->node_count; i++)
            for (int a = 0; a < u->dim; a++)
                load[(u->base[k] + i) * (int64_t)u->dim + a] += (double)fem->load[4 * (size_t)i + (size_t)a];
    }
}

void brunt_implicit_gradient(const struct brunt_implicit *m, int first, int end, const double *u, double *g) {
    memset(g, 0, (size_t)brunt_implicit_components(m) * sizeof *g);
    for (int t = first; t < end; t++)
        if (m->term[t].ops->gradient) m->term[t].ops->gradient(m->term[t].self, &m->team, u, g);
}
