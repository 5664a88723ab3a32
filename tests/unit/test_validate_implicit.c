// Parts of implicit steps that a wrong write has broken are noticed between two steps.
#include "contact/barrier/barrier_parts.h"
#include "scheme/implicit.h"
#include "tests/support/broken_world.h"
#include "tests/support/implicit_world.h"

#ifdef BRUNT_FLOAT
int main(void) { return 0; } // implicit steps want double
#else

// A mesh that presses on another by a barrier, with friction; points with a mirror that hang from a line.
static brunt_world *implicit(void) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_mesh(&def, "below", XYZ(2, 0, 0), XYZ(2.4, 0.3, 0));
    def_velocity(def_mesh(&def, "above", XYZ(2, 0.305, 0), XYZ(2.4, 0.6, 0)), 0.1, -0.1, 0);
    def_box(&def, "points", XYZ(0, 0, 0), XYZ(0.4, 0.3, 0));
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SLIP, 0);
    def.surfaces = brunt_alloc(sizeof *def.surfaces), def.surface_count = 1;
    brunt_boundary_surface_def *line = &def.surfaces[0];
    *line = brunt_boundary_surface_def_default();
    line->condition = BRUNT_STICK;
    line->point = brunt_alloc(2 * sizeof *line->point), line->point_count = 2;
    line->facet = brunt_alloc(sizeof *line->facet), line->facet_count = 1;
    line->point[0][0] = 0.4, line->point[1][1] = line->point[0][1] = 0.3;
    memcpy(line->facet[0], (const int32_t[4]){0, 1, -1, -1}, sizeof line->facet[0]);
    def.gravity[1] = -1;
    go_implicit(&def, BRUNT_EULER, 1e-3);
    def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.friction = 0.3, def.contact.distance = 0.01;
    return world_take(&def);
}

static struct brunt_implicit *of(brunt_world *w) { return w->plan.implicit; }
static void implicit_terms(brunt_world *w) { of(w)->term_count--; }
static void unknown_base(brunt_world *w) { of(w)->unknowns.base[1]++; }
static void unknown_number(brunt_world *w) { of(w)->unknowns.number[0][0] = of(w)->unknowns.count; }
static void unknown_mass(brunt_world *w) { of(w)->unknowns.mass[0] = -1; }
static void unknown_holder(brunt_world *w) { of(w)->unknowns.holder[0] = (int16_t)(w->boundaries.boundary_count + 1); }
static void unknown_image(brunt_world *w) {
    const brunt_images *images = &of(w)->unknowns.images;
    images->leader[images->follower[0]] = images->follower[0];
}
static void matrix_column(brunt_world *w) { of(w)->newton.matrix.column[0] = of(w)->newton.matrix.nodes; }
static void matrix_diagonal(brunt_world *w) { of(w)->newton.matrix.diagonal[1]++; }
static void matrix_solver(brunt_world *w) { of(w)->newton.linear.ops = NULL; }
static void barrier_facet(brunt_world *w) {
    of(w)->contact.barrier->facet[0][0] = of(w)->contact.barrier->vertex_count;
}
static void barrier_range(brunt_world *w) { of(w)->contact.barrier->source.range *= 0.5; }
static void barrier_place(brunt_world *w) { of(w)->contact.barrier->contacts.contact[0].place[0] = -1; }
static void barrier_force(brunt_world *w) { of(w)->contact.barrier->lagged.contact[0].normal_force = 0; }
static void contact_pair(brunt_world *w) { of(w)->contact.barrier->pair[0].account = w->pairs.count; }
static void surface_piece(brunt_world *w) { w->boundaries.surfaces.surface[0].particle[0].piece++; }
static void surface_normal(brunt_world *w) { w->boundaries.surfaces.surface[0].particle[0].normal[0] += 1; }
static void surface_tangent(brunt_world *w) { w->boundaries.surfaces.surface[0].particle[0].tangent[0][1] += 1; }
static void surface_cell(brunt_world *w) { w->boundaries.surfaces.surface[0].cell_particle[0] = -1; }
static void surface_traction(brunt_world *w) { w->boundaries.surfaces.surface[0].traction[0] = NAN; }

static const broken_row rows[] = {
    {implicit, implicit_terms},  {implicit, unknown_base},  {implicit, unknown_number},   {implicit, unknown_mass},
    {implicit, unknown_holder},  {implicit, unknown_image}, {implicit, matrix_column},    {implicit, matrix_diagonal},
    {implicit, matrix_solver},   {implicit, barrier_facet}, {implicit, barrier_range},    {implicit, barrier_place},
    {implicit, barrier_force},   {implicit, contact_pair},  {implicit, surface_piece},    {implicit, surface_normal},
    {implicit, surface_tangent}, {implicit, surface_cell},  {implicit, surface_traction},
};

START_TEST(broken_part_is_noticed) { check_noticed(&rows[_i]); }
END_TEST

int main(void) {
    Suite *suite = suite_create("validate_implicit");
    ADD_LOOP(broken_part_is_noticed, BRUNT_COUNT(rows));
    return suite_main(suite);
}
#endif
