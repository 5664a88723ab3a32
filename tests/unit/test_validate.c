// Parts of a world that a wrong write has broken are noticed between two steps.
#include "contact/search/node_to_facet_parts.h"
#include "tests/support/broken_world.h"

// Names of its own that others have as well.
#undef RESERVE
#define dot on_grid_dot
#define link on_grid_link
#include "contact/methods/surface_on_grid_parts.h"

// ------------------------------------------------------------------------------------------ worlds

// A block of material points on a plane, and a mesh with damping beside it.
static brunt_world *two_bodies(void) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def_box(&def, "block", XYZ(0, 0, 0), XYZ(0.4, 0.3, 0));
    def_mesh(&def, "mesh", XYZ(1, 0, 0), XYZ(1.4, 0.3, 0))->damping = 5;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    return world_take(&def);
}

// A mesh that meets another, or a block of points, by a method.
static brunt_world *meeting(brunt_contact_method method, bool points) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def_velocity(def_mesh(&def, "left", XYZ(0, 0, 0), XYZ(0.4, 0.3, 0)), 1, 0, 0);
    if (points)
        def_box(&def, "right", XYZ(0.4, 0, 0), XYZ(0.8, 0.3, 0));
    else
        def_mesh(&def, "right", XYZ(0.401, 0.05, 0), XYZ(0.8, 0.35, 0));
    def.contact.method = method;
    return world_take(&def);
}
static brunt_world *meshes(void) { return meeting(BRUNT_CONTACT_AUGURY, false); }
static brunt_world *mesh_on_grid(void) { return meeting(BRUNT_CONTACT_MULTI_VELOCITY, true); }

// ------------------------------------------------------------------------------------------ what breaks them

static void boundary_body(brunt_world *w) { w->boundaries.boundary[0].body = w->bodies.count; }
static void boundary_normal(brunt_world *w) { w->boundaries.boundary[0].plane.normal[1] = 0.9; }
static void boundary_symmetry(brunt_world *w) {
    w->boundaries.boundary[0].symmetry_plane = w->boundaries.symmetry_count;
}
static void boundary_acting(brunt_world *w) { w->boundaries.acting.list[0] = w->boundaries.boundary_count; }
static void boundary_account(brunt_world *w) { w->boundaries.boundary[0].account.impulse[1] = NAN; }
static void symmetry_count(brunt_world *w) { w->boundaries.symmetry_count = -1; }
static void damping_active(brunt_world *w) { w->boundaries.damping.active = false; }
static void damping_count(brunt_world *w) { w->boundaries.damping.fem_count++; }
static void ledger_number(brunt_world *w) { w->ledger.gravity_angular[2] = INFINITY; }
static void ledger_scale(brunt_world *w) { w->ledger.initial_energy = 2 * w->ledger.energy_scale + 1; }
static void plan_pass(brunt_world *w) { w->plan.pass_of[0] = w->plan.pass_count; }
static void plan_order(brunt_world *w) { w->plan.row[1] = w->plan.row[0], w->plan.pass_of[1] = w->plan.pass_of[0]; }
static void plan_rows(brunt_world *w) { w->plan.row_count = BRUNT_PASS_LIMIT + 1; }
static void timing_pass(brunt_world *w) { w->timing.pass = w->plan.pass_count; }
static void clock_steps(brunt_world *w) { w->clock.steps += 0.5; }
static void clock_step(brunt_world *w) { w->clock.dt = 0; }
static void scratch_capacity(brunt_world *w) { w->scratch.node_sums_capacity = w->scratch.node_sums ? 0 : 1; }
static void scratch_dofs(brunt_world *w) {
    brunt_particle_dofs *planes = &w->scratch.planes;
    planes->dof_count = (int32_t)(planes->dof_capacity / sizeof *planes->dof) + 1;
}
static void scratch_thread(brunt_world *w) { w->scratch.points[0].capacity = w->scratch.points[0].memory ? 0 : 1; }
static void grid_key(brunt_world *w) { w->bodies.mpm[0].grid.block_key[0]++; }
static void grid_source(brunt_world *w) { w->bodies.mpm[0].grid.slots[0].source[0] = -1; }
static void grid_slot(brunt_world *w) { w->bodies.mpm[0].grid.blocks[0].slot[0]++; }
static void pair_usual(brunt_world *w) { w->pairs.map.usual[1] = w->pairs.count; }
static void pair_entry(brunt_world *w) { w->pairs.map.entry[0].b = w->bodies.count; }
static void pair_account(brunt_world *w) { w->pairs.pair[0].last.area = -1; }
static void contact_rows(brunt_world *w) { w->contact.rows |= 1u << BRUNT_CONTACT_ROW_LIMIT; }
static void contact_frame(brunt_world *w) { w->contact.frame[0] = NAN; }
static void cache_face(brunt_world *w) { w->contact.node_to_facet->cache.nearest[0] = w->contact.surface.face_count; }
static void cache_motion(brunt_world *w) {
    distance_cache *cache = &w->contact.node_to_facet->cache;
    cache->node[1].since = -1;
}
static void cell_face(brunt_world *w) { w->contact.node_to_facet->cells.face[0] = -1; }
static void cell_order(brunt_world *w) { w->contact.node_to_facet->cells.first[1] = -1; }

static brunt_surface_on_grid *on_grid(brunt_world *w) {
    for (int r = 0; r < BRUNT_CONTACT_ROW_LIMIT; r++)
        if (w->contact.memory[r]) return w->contact.memory[r];
    return NULL;
}
static void on_grid_of(brunt_world *w) { on_grid(w)->link[0].contact = on_grid(w)->contact_count; }
static void on_grid_leader(brunt_world *w) { on_grid(w)->contact[0].leader = 1; }

static const broken_row rows[] = {
    {two_bodies, boundary_body},    {two_bodies, boundary_acting},
    {two_bodies, boundary_normal},  {two_bodies, boundary_symmetry},
    {two_bodies, boundary_account}, {two_bodies, symmetry_count},
    {two_bodies, damping_active},   {two_bodies, damping_count},
    {two_bodies, ledger_number},    {two_bodies, ledger_scale},
    {two_bodies, plan_pass},        {two_bodies, plan_order},
    {two_bodies, plan_rows},        {two_bodies, timing_pass},
    {two_bodies, clock_steps},      {two_bodies, clock_step},
    {two_bodies, scratch_capacity}, {two_bodies, scratch_dofs},
    {two_bodies, scratch_thread},   {two_bodies, grid_key},
    {two_bodies, grid_source},      {two_bodies, grid_slot},
    {two_bodies, pair_usual},       {meshes, pair_entry},
    {meshes, pair_account},         {meshes, contact_rows},
    {meshes, contact_frame},        {meshes, cache_face},
    {meshes, cache_motion},         {meshes, cell_face},
    {meshes, cell_order},           {mesh_on_grid, on_grid_of},
    {mesh_on_grid, on_grid_leader},
};

START_TEST(broken_part_is_noticed) { check_noticed(&rows[_i]); }
END_TEST

int main(void) {
    Suite *suite = suite_create("validate");
    ADD_LOOP(broken_part_is_noticed, BRUNT_COUNT(rows));
    return suite_main(suite);
}
