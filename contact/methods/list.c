#include "contact/methods/method.h"

static bool points_alone(bool a, bool b) { return !a && !b; }
static bool mesh_and_points(bool a, bool b) { return a != b; }
static bool any_mesh(bool a, bool b) { return a || b; }

// The published form acts on every surface, touched or not.
static void mark_all(const brunt_contact_context *m) {
    for (int k = 0; k < m->surface->fem_count; k++) m->surface->active[k] = true;
}

static int act_published(const brunt_contact_context *m, const brunt_contact_work *work) {
    return brunt_augury_paper(m, work->def->transfer, work->augury);
}

static int act_averaged(const brunt_contact_context *m, const brunt_contact_work *work) {
    return brunt_augury_surface(m, work->def->form == BRUNT_AUGURY_SMOOTH, work->augury);
}

static int act_on_grid(const brunt_contact_context *m, const brunt_contact_work *work) {
    return brunt_surface_on_grid_meet(m, work->grid_sweeps, work->surface_on_grid);
}

static void account_on_grid(const brunt_contact_context *m, const brunt_contact_work *work) {
    brunt_surface_on_grid_finish(m, *work->surface_on_grid);
}

// Constraints at facets, and those at planes, which any surface may meet: solved together.
static int act_at_facets(const brunt_contact_context *m, const brunt_contact_work *work) {
    brunt_constraint_set *set = work->constraints;
    brunt_node_to_facet *facets = *work->node_to_facet;
    brunt_constraints_clear(set);
    if (brunt_node_to_facet_planes(m, m->walls, m->wall_count, m->time, facets, set)) return -1;
    if (work->facets && brunt_node_to_facet_find(m, m->mpm, m->mpm_count, facets, set)) return -1;
    if (brunt_constraints_solve(set, work->sweeps, work->def->tolerance, m->threads, m->timer) < 0) return -1;
    brunt_node_to_facet_account_fixed(m, m->walls, m->wall_count, m->time, facets, set);
    brunt_node_to_facet_finish(m, m->mpm, facets, set);
    return 0;
}

#define METHOD(name) (1u << BRUNT_CONTACT_##name)
#define FORM(name) (1u << BRUNT_AUGURY_##name)

// clang-format off
const brunt_contact_row brunt_contact_rows[BRUNT_CONTACT_ROWS] = {
    {"grid velocity", METHOD(MULTI_VELOCITY) | METHOD(TIED), 0, points_alone, NULL, NULL, NULL},
    {"published", METHOD(AUGURY), FORM(PAPER), any_mesh, mark_all, act_published, NULL},
    {"averaged surface", METHOD(AUGURY), FORM(SMOOTH) | FORM(SURFACE), any_mesh, NULL, act_averaged, NULL},
    {"surface on grid", METHOD(MULTI_VELOCITY), 0, mesh_and_points, brunt_surface_on_grid_near, act_on_grid, account_on_grid},
    {"barrier", METHOD(BARRIER), 0, any_mesh, NULL, NULL, NULL},
    {"node to facet", METHOD(AUGURY), FORM(AFFINE), any_mesh, NULL, act_at_facets, NULL},
};
// clang-format on

bool brunt_contact_accepts(brunt_contact_method method, bool mesh_a, bool mesh_b) {
    if (method == BRUNT_CONTACT_NONE) return true;
    for (int r = 0; r < BRUNT_CONTACT_ROWS; r++)
        if (brunt_contact_rows[r].methods >> method & 1 && brunt_contact_rows[r].accepts(mesh_a, mesh_b)) return true;
    return false;
}
