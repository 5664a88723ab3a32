// Bodies that push each other, and their tractions, as the last implicit or static step has left them.
#include <math.h>

#include "contact/contact.h"
#include "scheme/implicit.h"

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static const brunt_implicit_contact *contact_of(const brunt_plan *plan) {
    return plan->implicit && plan->implicit->contact.barrier ? &plan->implicit->contact : NULL;
}

bool brunt_world_links(const brunt_world *world, int32_t *count) {
    const brunt_implicit_contact *c = contact_of(&world->plan);
    *count = c && c->forces.count > c->plane_count ? c->forces.count - c->plane_count : 0;
    return c != NULL;
}

brunt_link brunt_world_link(const brunt_world *world, int32_t index) {
    const brunt_implicit_contact *c = contact_of(&world->plan);
    int32_t count;
    const brunt_barrier_pair *pair = &brunt_barrier_pairs(c->barrier, &count)[index];
    const brunt_barrier_force *force = &c->forces.force[c->plane_count + index];
    brunt_link link = {
        .a = pair->a, .b = pair->b, .normal = length(force->normal), .friction = length(force->friction)};
    const double bound = pair->friction * link.normal;
    link.share = bound > 0 && isfinite(bound) ? link.friction / bound : 0;
    for (int a = 0; a < 3; a++) link.force[a] = force->normal[a] + force->friction[a];
    return link;
}

static const double SLIPS = 0.99; // of its bound

void brunt_world_link_sums(const brunt_world *world, brunt_link_sums *sums) {
    int32_t links;
    *sums = (brunt_link_sums){.count = 0};
    brunt_world_links(world, &links);
    for (int32_t i = 0; i < links; i++) {
        const brunt_link link = brunt_world_link(world, i);
        if (!(link.normal > 0)) continue;
        const double off = link.normal - sums->mean;
        sums->count++;
        sums->mean += off / sums->count;
        sums->sd += off * (link.normal - sums->mean); // of squares, until the end
        sums->greatest = fmax(sums->greatest, link.normal);
        sums->slipping += link.share > SLIPS;
    }
    if (sums->count > 0) sums->sd = sqrt(sums->sd / sums->count);
}

int brunt_world_tell_tractions(brunt_world *world, brunt_error *error) {
    struct brunt_implicit *m = world->plan.implicit;
    if (!contact_of(&world->plan) || m->unknowns.dim != 2)
        return brunt_fail(
            error, BRUNT_BAD_INPUT,
            "output.tractions: of two dimensions, implicit or load steps and contact.method barrier or penalty");
    m->contact.tells = true;
    return BRUNT_OK;
}

const brunt_traction *brunt_world_tractions(const brunt_world *world, int32_t *count) {
    const brunt_implicit_contact *c = contact_of(&world->plan);
    *count = c ? c->tractions.count : 0;
    return c ? c->tractions.traction : NULL;
}
