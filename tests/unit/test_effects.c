// Every effect that a scene can ask for is said by the plan: by a scene that asks for it, by no other; with a
// coefficient of 0 it is off. And the table of passes is one: names, units, parts.
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brunt.h"
#include "scheme/scheme.h"
#include "tests/support/suite.h"

// What a scene is made of: two bodies apart, of material points, or of meshes, one of them a membrane.
typedef struct scene {
    brunt_material_def materials[2];
    brunt_body_def bodies[2];
    brunt_plane_def plane;
    brunt_pair_def pair;
    brunt_detonation_def detonation;
    brunt_world_def def;
} scene;

static void make_points(scene *s) {
    *s = (scene){.plane = brunt_plane_def_default(), .def = brunt_world_def_default()};
    for (int i = 0; i < 2; i++) {
        s->materials[i] = (brunt_material_def){
            .name = "rubber", .density = 1000, .strength = "neo-hookean", .strength_parameters = {1e6, 0.3}};
        brunt_body_def *b = &s->bodies[i];
        *b = brunt_body_def_default();
        snprintf(b->name, sizeof b->name, "%c", 'a' + i);
        b->shape.kind = BRUNT_BOX;
        for (int a = 0; a < 3; a++) b->shape.min[a] = a ? 0 : 2 * i, b->shape.max[a] = b->shape.min[a] + 0.4;
        b->size = 0.2;
    }
    snprintf(s->materials[1].name, sizeof s->materials[1].name, "other");
    s->def.cell = 0.1, s->def.end = 1;
    s->def.contact.method = BRUNT_CONTACT_NONE;
    s->def.transfer = BRUNT_PIC;
    s->def.materials = s->materials, s->def.material_count = 2;
    s->def.bodies = s->bodies, s->def.body_count = 2;
    s->plane.normal[1] = 1, s->plane.point[1] = -1;
    snprintf(s->pair.a, sizeof s->pair.a, "a");
    snprintf(s->pair.b, sizeof s->pair.b, "b");
}

static void make_mesh(scene *s) {
    make_points(s);
    for (int i = 0; i < 2; i++) s->bodies[i].method = BRUNT_FEM, s->bodies[i].element = BRUNT_TET4;
}

static void make_membrane(scene *s) {
    make_mesh(s);
    s->bodies[0].method = BRUNT_MEMBRANE, s->bodies[0].element = BRUNT_MEMBRANE_TRI3;
    s->bodies[0].thickness = 1e-3;
}

static void none(scene *s) { (void)s; }
static void apic(scene *s) { s->def.transfer = BRUNT_APIC; }
static void keeping(scene *s) { apic(s), s->def.apic = 0.9; }
static void apic_of_0(scene *s) { apic(s), s->def.apic = 0; }
static void share_of_pic(scene *s) { s->def.apic = 0.9; }
static void flip_of_0(scene *s) { s->def.transfer = BRUNT_FLIP, s->def.flip = 0; }
static void gravity(scene *s) { s->def.gravity[1] = -1; }
static void no_gravity(scene *s) { s->def.gravity_ramp = 1; }
static void total(scene *s) { s->bodies[0].total_lagrangian = true; }
static void on_grid(scene *s) { s->def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY; }
static void rub(scene *s) { on_grid(s), s->def.contact.friction = 0.3; }
static void no_friction(scene *s) { on_grid(s), s->def.contact.friction = 0; }
static void augury(scene *s) { s->def.contact.method = BRUNT_CONTACT_AUGURY; }
static void add_pair(scene *s) { s->def.contact.pairs = &s->pair, s->def.contact.pair_count = 1; }
static void tie(scene *s) { add_pair(s), s->pair.method = BRUNT_CONTACT_TIED; }
static void apart(scene *s) { add_pair(s), s->pair.method = BRUNT_CONTACT_NONE; }
static void self(scene *s) {
    add_pair(s);
    s->pair.method = BRUNT_CONTACT_AUGURY;
    snprintf(s->pair.b, sizeof s->pair.b, "a");
}
static void one_way(scene *s) {
    add_pair(s);
    s->pair.method = BRUNT_CONTACT_AUGURY, s->pair.sides = BRUNT_SIDES_SLAVE;
}
static void add_plane(scene *s) { s->def.planes = &s->plane, s->def.plane_count = 1; }
static void stick(scene *s) { add_plane(s), s->plane.condition = BRUNT_STICK; }
static void move_stick(scene *s) { stick(s), s->plane.velocity[1] = 1; }
static void mirror(scene *s) { add_plane(s), s->plane.condition = BRUNT_SYMMETRY; }
static void rough(scene *s) { add_plane(s), s->plane.friction = 0.3; }
static void hexes(scene *s) { s->bodies[0].element = BRUNT_HEX8; }
static void no_springs(scene *s) { hexes(s), s->bodies[0].hourglass_coefficient = 0; }
static void no_dampers(scene *s) { no_springs(s), s->bodies[0].hourglass = BRUNT_HOURGLASS_VISCOUS; }
static void drag(scene *s) { s->bodies[0].damping = 3; }
static void tension_only(scene *s) { s->bodies[0].tension_only = true; }
static void strain(scene *s) { s->bodies[0].erosion.strain = 1; }
static void plastic(scene *s) {
    snprintf(s->materials[0].strength, sizeof s->materials[0].strength, "von-mises");
    s->materials[0].strength_parameters[2] = 1e5;
}
static void thin(scene *s) { // bulk viscosity of 0
    s->materials[0].bulk_viscosity = true;
}
static void viscous(scene *s) { thin(s), s->materials[0].viscosity_parameters[1] = 1.5; }
static void hot(scene *s) {
    const double parameters[] = {1e6, 0.3, 1e5, 0, 1, 0.1, 1, 1, 1000, 293.15, 400, 0.9};
    snprintf(s->materials[0].strength, sizeof s->materials[0].strength, "johnson-cook");
    memcpy(s->materials[0].strength_parameters, parameters, sizeof parameters);
}
static void hot_static(scene *s) { hot(s), s->materials[0].strength_parameters[5] = 0; }
static void cold(scene *s) { hot(s), s->materials[0].strength_parameters[11] = 0; }
static void cold_static(scene *s) { cold(s), s->materials[0].strength_parameters[5] = 0; }
static void glass(scene *s) {
    const double parameters[] = {1e6, 2e6, 0,   0,   0.93, 0.77, 0.088, 0.35, 0.003,
                                 1,   0.5, 1e5, 1e6, 5e5,  0.05, 0.85,  1,    INFINITY};
    snprintf(s->materials[0].strength, sizeof s->materials[0].strength, "johnson-holmquist-2");
    memcpy(s->materials[0].strength_parameters, parameters, sizeof parameters);
}
static void glass_static(scene *s) { glass(s), s->materials[0].strength_parameters[8] = 0; }
static void load(scene *s) {
    static brunt_group_def group;
    group = brunt_group_def_default();
    snprintf(group.body, sizeof group.body, "a");
    snprintf(group.group, sizeof group.group, "xmax");
    group.action = BRUNT_GROUP_PRESSURE, group.value[0] = 1;
    s->def.groups = &group, s->def.group_count = 1;
}
static void load_of_0(scene *s) { load(s), s->def.groups[0].value[0] = 0; }
static void break_off(scene *s) {
    plastic(s);
    snprintf(s->materials[0].failure, sizeof s->materials[0].failure, "johnson-cook-damage");
    const double parameters[] = {0.5, 0, 0, 0, 0, 1, INFINITY, 293.15, 1, INFINITY};
    memcpy(s->materials[0].failure_parameters, parameters, sizeof parameters);
    s->materials[0].failure_action = BRUNT_FAILURE_ERODE;
}
static void soften(scene *s) {
    break_off(s);
    s->materials[0].failure_action = BRUNT_FAILURE_SOFTEN;
    snprintf(s->materials[0].eos, sizeof s->materials[0].eos, "polynomial");
    s->materials[0].eos_parameters[1] = 1e6, s->materials[0].eos_parameters[8] = INFINITY;
}

#ifndef BRUNT_FLOAT // implicit steps are of double precision
static void implicit(scene *s) {
    s->def.scheme = BRUNT_IMPLICIT, s->def.step = 1e-3;
    s->bodies[0].velocity[0] = 1; // at rest there is nothing to look for
}
static void barrier(scene *s) { implicit(s), s->def.contact.method = BRUNT_CONTACT_BARRIER; }
static void implicit_tie(scene *s) { implicit(s), tie(s); }
#endif

typedef struct asked {
    const char *name;
    void (*make)(scene *s), (*ask)(scene *s);
    const char *effects; // in their order
} asked;

static const asked list[] = {
    {"points", make_points, none, ""},
    {"affine", make_points, apic, "affine "},
    {"gravity", make_points, gravity, "gravity "},
    {"gravity of 0", make_points, no_gravity, ""},
    {"share of FLIP of 0", make_points, flip_of_0, ""},
    {"share of APIC", make_points, keeping, "affine kept_share "},
    {"share of APIC of 0", make_points, apic_of_0, "affine "},
    {"share of APIC, with PIC", make_points, share_of_pic, ""},
    {"total Lagrangian", make_points, total, "total_lagrangian "},
    {"contact of points", make_points, on_grid, "contact "},
    {"friction", make_points, rub, "contact friction "},
    {"friction of 0", make_points, no_friction, "contact "},
    {"tied", make_points, tie, "contact tied "},
    {"a pair without contact", make_points, apart, ""},
    {"plane", make_points, add_plane, "boundaries "},
    {"rough plane", make_points, rough, "friction boundaries "},
    {"stick", make_points, stick, "symmetry "},
    {"stick that moves", make_points, move_stick, "conditions "},
    {"symmetry", make_points, mirror, "symmetry "},
    {"strain", make_points, strain, "erosion "},
    {"plasticity", make_points, plastic, "plasticity "},
    {"failure", make_points, break_off, "erosion plasticity damage "},
    {"softening", make_points, soften, "softening plasticity equation_of_state damage "},
    {"bulk viscosity of 0", make_points, thin, ""},
    {"bulk viscosity", make_points, viscous, "bulk_viscosity "},
    {"rate and heat", make_points, hot, "plasticity rate_dependence thermal "},
    {"rate of 0", make_points, hot_static, "plasticity thermal "},
    {"heat of 0", make_points, cold, "plasticity rate_dependence "},
    {"rate and heat of 0", make_points, cold_static, "plasticity "},
    {"ceramics", make_points, glass, "plasticity rate_dependence damage "},
    {"ceramics, rate of 0", make_points, glass_static, "plasticity damage "},
    {"load", make_mesh, load, "elements groups "},
    {"load of 0", make_mesh, load_of_0, "elements "},
    {"mesh", make_mesh, none, "elements "},
    {"contact of meshes", make_mesh, augury, "elements contact surfaces "},
    {"one-way contact", make_mesh, one_way, "elements contact one_way_contact surfaces "},
    {"hourglass", make_mesh, hexes, "elements hourglass "},
    {"hourglass of 0", make_mesh, no_springs, "elements "},
    {"viscous hourglass of 0", make_mesh, no_dampers, "elements "},
    {"damping", make_mesh, drag, "elements damping "},
    {"strain of meshes", make_mesh, strain, "elements erosion "},
    {"softening of meshes", make_mesh, soften, "elements softening plasticity equation_of_state damage "},
#ifndef BRUNT_FLOAT
    {"implicit", make_mesh, implicit, "implicit elements "},
    {"barrier", make_mesh, barrier, "implicit elements barrier "},
    {"implicit, of points", make_points, implicit, "implicit "},
    {"implicit and tied", make_points, implicit_tie, "implicit contact tied "},
#endif
    {"membrane", make_membrane, none, "elements membranes "},
    {"tension only", make_membrane, tension_only, "elements membranes tension_only "},
    {"self-contact", make_membrane, self, "elements contact self_contact surfaces membranes "},
};

START_TEST(plan_says_what_was_asked_for) {
    const asked *a = &list[_i];
    scene *s = calloc(1, sizeof *s);
    ck_assert_ptr_nonnull(s);
    a->make(s);
    a->ask(s);
    brunt_error error;
    brunt_world *world = brunt_world_create(&s->def, &error);
    ck_assert_msg(world != NULL, "%s: %s", a->name, error.message);
    char said[512] = "";
    for (int32_t e = 0; e < brunt_effect_count(world); e++) {
        const brunt_effect effect = brunt_world_effect(world, e);
        ck_assert_int_eq(effect.on, effect.because[0] != 0);
        if (effect.on) strcat(strcat(said, effect.name), " ");
    }
    ck_assert_msg(!strcmp(said, a->effects), "%s: %s", a->name, said);
    // An effect that is off has no array.
    static const char *const arrays[][2] = {{"hourglass", "hourglass"},
                                            {"thermal", "temperature"},
                                            {"bulk_viscosity", "visc"},
                                            {"damage", "damage"},
                                            {"flip", "grid_velocity"}};
    for (int32_t k = 0; k < brunt_array_count(world); k++)
        for (size_t e = 0; e < sizeof arrays / sizeof *arrays; e++)
            ck_assert_msg(strstr(a->effects, arrays[e][0]) || !strstr(brunt_world_array(world, k).name, arrays[e][1]),
                          "%s: %s", a->name, brunt_world_array(world, k).name);
    ck_assert_msg(!brunt_world_step(world, INFINITY, &error), "%s: %s", a->name, error.message);
    for (int32_t p = 0; p < brunt_pass_count(world); p++) ck_assert_int_gt(brunt_world_pass(world, p).calls, 0);
    brunt_world_destroy(world);
    free(s);
}
END_TEST

START_TEST(detonations_are_said) {
    scene *s = calloc(1, sizeof *s);
    ck_assert_ptr_nonnull(s);
    for (int lit = 0; lit < 2; lit++) {
        make_points(s);
        brunt_error error;
        ck_assert_int_eq(brunt_material_preset("tnt", "tnt", &s->materials[0], &error), BRUNT_OK);
        s->detonation = (brunt_detonation_def){.time = 0};
        s->def.detonations = &s->detonation, s->def.detonation_count = lit;
        brunt_world *world = brunt_world_create(&s->def, &error);
        ck_assert_msg(world != NULL, "%s", error.message);
        int found = 0;
        for (int32_t e = 0; e < brunt_effect_count(world); e++) {
            const brunt_effect effect = brunt_world_effect(world, e);
            found += !strcmp(effect.name, "detonation") && effect.on == lit;
        }
        ck_assert_int_eq(found, 1);
        brunt_world_destroy(world);
    }
    free(s);
}
END_TEST

// Where damping times step is less than any number there is none: 0 / 0 had come of it.
START_TEST(least_damping) {
    scene *s = calloc(1, sizeof *s);
    ck_assert_ptr_nonnull(s);
    make_mesh(s);
    s->bodies[0].damping = sizeof(real) == sizeof(double) ? 1e-300 : 1e-30, s->bodies[0].velocity[0] = 1;
    s->def.step = 1e-25, s->def.end = 1;
    brunt_error error;
    brunt_world *world = brunt_world_create(&s->def, &error);
    ck_assert_msg(world != NULL, "%s", error.message);
    brunt_energy before, after;
    brunt_world_energy(world, &before);
    for (int k = 0; k < 2; k++) ck_assert_msg(!brunt_world_step(world, INFINITY, &error), "%s", error.message);
    brunt_world_energy(world, &after);
    ck_assert_double_gt(before.kinetic, 0);
    ck_assert_double_eq_tol(after.kinetic, before.kinetic, 1e-6 * before.kinetic);
    brunt_world_destroy(world);
    free(s);
}
END_TEST

static void check_table(const brunt_pass_row *table, int count) {
    for (int i = 0; i < count; i++) {
        const brunt_pass_row *row = &table[i];
        ck_assert(row->name && row->name[0] && row->unit && row->unit[0] && row->wanted);
        ck_assert(row->run || row->kind == BRUNT_PASS_INNER);
        int whole = 0;
        for (int k = 0; k < count; k++) whole += table[k].kind != BRUNT_PASS_PART && !strcmp(table[k].name, row->name);
        ck_assert_msg(whole == 1, "%s stands %d times", row->name, whole);
    }
}

START_TEST(table_of_passes) {
    check_table(brunt_explicit_passes, brunt_explicit_pass_count);
    check_table(brunt_implicit_passes, brunt_implicit_pass_count);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("effects");
    TCase *tests = tcase_create("effects");
    tcase_add_loop_test(tests, plan_says_what_was_asked_for, 0, sizeof list / sizeof *list);
    tcase_add_test(tests, detonations_are_said);
    tcase_add_test(tests, least_damping);
    tcase_add_test(tests, table_of_passes);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
