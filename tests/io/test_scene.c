// The scene reader: what a good scene becomes, units, overrides, the resolved scene, the reference, the schema, and
// broken scenes.
//
// Every file of tests/bad_scenes begins with lines "# expect: LINE:COLUMN: SUBSTRING", one for each mistake that must
// be reported, in order; no other mistake may be.
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <check.h>
#include <jansson.h>

#include "tests/support/hard_case.h"
#include "tests/support/small_scene.h"
#include "base/memory.h"
#include "io/scene/scene.h"
#include "io/scene/scene_keys.h"
#include "io/scene/units.h"
#include "tests/support/suite.h"

static const char good[] =
    "brunt: 1\n"
    "title: 'A \"good\" scene: all of it'\n"
    "dimension: 3\n"
    "time: {end: 80 us, cfl: 0.4, energy_limit: none}\n"
    "grid: {cell: 0.5 mm, origin: [1 mm, 0, 0], kernel: cubic, transfer: {flip: 0.98}}\n"
    "materials:\n"
    "  steel: {model: johnson-cook, density: 7.85 g/cm^3, E: 200 GPa, nu: 0.3, A: 800 MPa, B: 500 MPa, n: 0.26, C: "
    "0.014,\n"
    "    m: 1.03, melt: 1520 degC, heat_capacity: 477 J/kg/K, eos: {model: mie-gruneisen, c0: 4.57 km/s, s: 1.49, "
    "gamma0: 1.93},\n"
    "    viscosity: {quadratic: 2}}\n"
    "  gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}\n"
    "bodies:\n"
    "  rod: &rod\n"
    "    method: mpm\n"
    "    material: steel\n"
    "    shape: {cylinder: {center: [0, 0, 0], axis: [0, 0, 2], radius: 4 mm, length: 25 mm}}\n"
    "    particles_per_cell: 27\n"
    "    fill: jittered\n"
    "    seed: 7\n"
    "    velocity: [0, 0, -190 m/s]\n"
    "    spin: {rate: 600 rpm, axis: [0, 0, 3], about: [0, 0, 1 cm]}\n"
    "    temperature: 20 degC\n"
    "  anvil:\n"
    "    method: mpm\n"
    "    material: gum\n"
    "    shape:\n"
    "      difference:\n"
    "        - box: {min: [-20 mm, -20 mm, -10 mm], max: [20 mm, 20 mm, 0]}\n"
    "        - half-space: {point: [0, 0, -5 mm], normal: [0, 0, 1]}\n"
    "    place: [{translate: [0, 0, -1 mm]}, {rotate: {axis: [0, 0, 1], angle: 90 deg}}]\n"
    "    spacing: 0.4 mm\n"
    "    wave: {velocity: [1, 0, 0], wave_vector: [0, 0, 2 1/mm], phase: 180 deg}\n"
    "contact: {friction: 20 %, pairs: [{between: [rod, anvil], friction: 0.5}]}\n"
    "boundaries:\n"
    "  - {plane: {point: [0, 0, -5 mm], normal: [0, 0, 1]}, condition: separate, friction: 0.3, body: rod}\n"
    "  - {name: grip, region: {sphere: {center: [0, 0, 0], radius: 1 mm}}, velocity: [free, 0, 2 m/s], until: 10 us}\n"
    "  - {plane: {point: [0, 0, 0], normal: [0, 1, 0]}, condition: symmetry}\n"
    "loads: {gravity: [0, 0, -9.81], gravity_ramp: 1 ms}\n"
    "output: {every: 2 us, history: 50 ns, checkpoint: none, fields: [velocity, stress], precision: float64,\n"
    "  probes: {tip: {body: rod, point: [0, 0, 0], field: velocity}}}\n"
    "measures:\n"
    "  kept: {energy: total, at: end, relative_to: initial, expect: 1, tolerance: 5 %}\n"
    "  length: {extent: {body: rod, axis: [0, 0, 1]}, expect: 17.6 mm, tolerance: 0.2 mm, tolerance_is: absolute, "
    "source: x}\n"
    "  width: {radius: {body: rod, axis: [0, 0, 1], from: 0, to: 5 mm}}\n"
    "  strain: {field: {body: rod, name: stress, component: yz}, take: max-abs}\n"
    "  push: {history: wall.plane1.force_z, take: mean, from: 10 us, to: 40 us}\n";

// Finite elements: two bodies of elements with groups, one of particles, all forms of loading.
static const char elements[] =
    "brunt: 1\n"
    "dimension: 3\n"
    "time: {end: 1 ms}\n"
    "grid: {cell: 1 mm}\n"
    "materials:\n"
    "  gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}\n"
    "bodies:\n"
    "  beam: {method: fem, material: gum, shape: {box: {min: [0, 0, 0], max: [40 mm, 10 mm, 10 mm]}}, size: 2 mm,\n"
    "    hourglass: {form: viscous, coefficient: 0.2}, mass_scaling: 2 ns, velocity: [0, 0, -1 m/s]}\n"
    "  tets: {method: fem, material: gum, shape: {sphere: {center: [0, 0, 40 mm], radius: 5 mm}}, size: 1 mm,\n"
    "    element: tet4, spin: {rate: [0, 0, 2]}}\n"
    "  sand: {method: mpm, material: gum, shape: {sphere: {center: [20 mm, 0, 40 mm], radius: 5 mm}}}\n"
    "contact:\n"
    "  {friction: 0.3, form: published, iterations: 0, cell: 3 mm, transfer: pic, pairs: [{between: [tets, beam], "
    "method: "
    "none}]}\n"
    "boundaries:\n"
    "  - {group: xmin, body: beam, fix: [x, z]}\n"
    "  - {group: xmax, body: beam, fix: all}\n"
    "  - {name: pull, group: xmax, body: beam, displacement: [free, 0, 2 mm], table: [[0, 0], [0.5 ms, 50 %], [1 ms, "
    "1]]}\n"
    "  - {group: surface, body: tets, velocity: [1, free, free]}\n"
    "  - {group: ymax, body: beam, traction: [0, 1 kPa, 0]}\n"
    "  - {group: ymin, body: beam, pressure: 2 MPa}\n"
    "  - {plane: {point: [0.3 mm, 0, 0], normal: [1, 0, 0]}, condition: symmetry, body: beam}\n"
    "measures: {push: {history: wall.pull.force_z}, deep: {history: contact.beam-tets.area, take: max}}\n";

// Membranes: a bag with gas that may touch itself, a flag of two faces of a box, and what they may meet.
static const char sheets[] =
    "brunt: 1\n"
    "dimension: 3\n"
    "time: {end: 1 ms}\n"
    "grid: {cell: 2 mm}\n"
    "materials:\n"
    "  gum: {model: neo-hookean, density: 1000, E: 1e6, nu: 0.4}\n"
    "  water: {model: newtonian, density: 1000, dynamic_viscosity: 1 mPa s, eos: {model: tait, c0: 10 m/s}}\n"
    "bodies:\n"
    "  bag: {method: membrane, material: gum, shape: {sphere: {center: [0, 0, 0], radius: 20 mm}}, size: 3 mm,\n"
    "    thickness: 0.2 mm, tension_only: true, contact_thickness: 1 mm, damping: 50 1/s}\n"
    "  flag: {method: membrane, material: gum, shape: {box: {min: [-20 mm, -20 mm, 30 mm], max: [20 mm, 20 mm, 31 "
    "mm]}},\n"
    "    size: 4 mm, thickness: 0.2 mm, faces: [zmin, xmin], element: tri3, mass_scaling: 10 ns}\n"
    "  block: {method: fem, material: gum, shape: {box: {min: [0, 0, 50 mm], max: [5 mm, 5 mm, 55 mm]}}, size: 1 mm}\n"
    "  drop: {method: mpm, material: water, shape: {sphere: {center: [0, 0, -60 mm], radius: 5 mm}}}\n"
    "contact:\n"
    "  {friction: 0.1, pairs: [{between: [bag, bag], friction: 0.4}, {between: [drop, flag], method: "
    "multi-velocity}]}\n"
    "boundaries:\n"
    "  - {name: air, group: surface, body: bag, gas: {pressure: 2 bar, outside: 1 bar, inflow: 1 kW}, table: [[0, 1], "
    "[1 ms, 0]]}\n"
    "  - {group: border, body: flag, fix: all}\n"
    "measures: {p: {history: gas.air.pressure, take: max}, v: {history: gas.air.volume}}\n";

static char *messages;
static size_t message_length;

// Where `messages` are collected, in the place of those before.
static FILE *open_messages(void) {
    free(messages);
    messages = NULL;
    return open_memstream(&messages, &message_length);
}

static int parse_file(const char *name, const char *text, const char *const *sets, int set_count, brunt_scene *scene) {
    FILE *out = open_messages();
    int status = brunt_scene_parse(text, strlen(text), name, sets, set_count, scene, out);
    fclose(out);
    return status;
}

static int parse(const char *text, const char *const *sets, int set_count, brunt_scene *scene) {
    return parse_file("dir/good.yaml", text, sets, set_count, scene);
}

static void parse_good(brunt_scene *scene) {
    int status = parse(good, NULL, 0, scene);
    ck_assert_msg(status == BRUNT_OK, "%s", messages);
}

static char *write_text(const brunt_scene *scene) {
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    ck_assert_int_eq(brunt_scene_write(scene, out), BRUNT_OK);
    fclose(out);
    return text;
}

// Meshes are looked for in the folder of `name`.
static void check_fixpoint(const char *text, const char *name) {
    brunt_scene s;
    ck_assert_msg(parse_file(name, text, NULL, 0, &s) == BRUNT_OK, "%s: %s", name, messages);
    char *first = write_text(&s);
    brunt_scene_free(&s);
    ck_assert_msg(parse(first, NULL, 0, &s) == BRUNT_OK, "%s as written: %s\n%s", name, messages, first);
    char *second = write_text(&s);
    brunt_scene_free(&s);
    ck_assert_str_eq(first, second);
    free(first);
    free(second);
}

static double parameter(const brunt_model *model, const double *values, const char *key) {
    for (int p = 0; p < model->parameter_count; p++)
        if (strcmp(model->parameters[p].key, key) == 0) return values[p];
    ck_abort_msg("no parameter %s", key);
    return 0;
}

#define NEAR(a, b) ck_assert_double_eq_tol(a, b, 1e-12 * fabs((double)(b)) + 1e-300)

START_TEST(world_values) {
    brunt_scene s;
    parse_good(&s);
    const brunt_world_def *w = &s.world;
    ck_assert_str_eq(s.name, "good");
    ck_assert_str_eq(s.title, "A \"good\" scene: all of it");
    ck_assert_int_eq(w->dimension, 3);
    NEAR(w->end, 80e-6);
    NEAR(w->cfl, 0.4);
    ck_assert(w->step == 0 && isinf(w->energy_limit));
    NEAR(w->cell, 0.5e-3);
    NEAR(w->origin[0], 1e-3);
    ck_assert_int_eq(w->kernel, BRUNT_CUBIC);
    ck_assert_int_eq(w->transfer, BRUNT_FLIP);
    NEAR(w->flip, 0.98);
    ck_assert_int_eq(w->material_count, 2);
    const brunt_material_def *steel = &w->materials[0];
    const brunt_model *jc = brunt_find_strength("johnson-cook"), *mg = brunt_find_eos("mie-gruneisen");
    ck_assert_str_eq(steel->strength, "johnson-cook");
    NEAR(steel->density, 7850);
    NEAR(parameter(jc, steel->strength_parameters, "E"), 200e9);
    NEAR(parameter(jc, steel->strength_parameters, "melt"), 1793.15);
    ck_assert_str_eq(steel->eos, "mie-gruneisen");
    NEAR(parameter(mg, steel->eos_parameters, "c0"), 4570);
    ck_assert(steel->bulk_viscosity && !w->materials[1].bulk_viscosity);
    NEAR(parameter(&brunt_bulk_viscosity, steel->viscosity_parameters, "quadratic"), 2);
    NEAR(parameter(&brunt_bulk_viscosity, steel->viscosity_parameters, "linear"),
         brunt_bulk_viscosity.parameters[0].initial);
    ck_assert_str_eq(w->materials[1].eos, "");
    NEAR(w->gravity[2], -9.81);
    NEAR(w->gravity_ramp, 1e-3);
    brunt_scene_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(body_values) {
    brunt_scene s;
    parse_good(&s);
    ck_assert_int_eq(s.world.body_count, 2);
    const brunt_body_def *anvil = &s.world.bodies[0], *rod = &s.world.bodies[1];
    ck_assert_str_eq(anvil->name, "anvil");
    ck_assert_str_eq(rod->name, "rod");
    ck_assert_int_eq(rod->material, 0);
    ck_assert_int_eq(anvil->material, 1);
    ck_assert_int_eq(rod->shape.kind, BRUNT_CYLINDER);
    NEAR(rod->shape.radius, 4e-3);
    NEAR(rod->shape.length, 25e-3);
    ck_assert_int_eq(rod->particles_per_cell, 27);
    ck_assert_int_eq(rod->fill, BRUNT_FILL_JITTERED);
    ck_assert_uint_eq(rod->seed, 7);
    NEAR(rod->jitter, 0.25);
    NEAR(rod->velocity[2], -190);
    NEAR(rod->spin[2], 20 * 3.14159265358979323846);
    NEAR(rod->spin_about[2], 0.01);
    NEAR(rod->temperature, 293.15);
    ck_assert_int_eq(anvil->shape.kind, BRUNT_DIFFERENCE);
    ck_assert_int_eq(anvil->shape.child_count, 2);
    ck_assert_int_eq(anvil->shape.children[1].kind, BRUNT_HALF_SPACE);
    NEAR(anvil->shape.children[0].min[0], -0.02);
    NEAR(anvil->spacing, 0.4e-3);
    ck_assert_int_eq(anvil->particles_per_cell, 0);
    // The quarter turn takes x to y, and comes after the shift.
    ck_assert_double_eq_tol(anvil->place.rotation[3], 1, 1e-14);
    ck_assert_double_eq_tol(anvil->place.translation[2], -1e-3, 1e-17);
    NEAR(anvil->wave_vector[2], 2000);
    NEAR(anvil->wave_phase, 3.14159265358979323846);
    brunt_scene_free(&s);
}
END_TEST

START_TEST(contact_and_boundaries) {
    brunt_scene s;
    parse_good(&s);
    const brunt_world_def *w = &s.world;
    ck_assert_int_eq(w->contact.method, BRUNT_CONTACT_MULTI_VELOCITY);
    NEAR(w->contact.friction, 0.2);
    ck_assert(!w->contact.allow_overlap);
    ck_assert_int_eq(w->contact.pair_count, 1);
    ck_assert_str_eq(w->contact.pairs[0].a, "rod");
    NEAR(w->contact.pairs[0].friction, 0.5);
    ck_assert_int_eq(w->contact.pairs[0].method, BRUNT_CONTACT_MULTI_VELOCITY);
    ck_assert_int_eq(w->plane_count, 2);
    ck_assert_str_eq(w->planes[0].name, "plane1");
    ck_assert_str_eq(w->planes[0].body, "rod");
    NEAR(w->planes[0].friction, 0.3);
    ck_assert_int_eq(w->planes[1].condition, BRUNT_SYMMETRY);
    ck_assert_int_eq(w->region_count, 1);
    const brunt_region_def *grip = &w->regions[0];
    ck_assert_str_eq(grip->name, "grip");
    ck_assert(!grip->component[0] && grip->component[1] && grip->component[2]);
    NEAR(grip->velocity[2], 2);
    ck_assert(grip->start == 0);
    NEAR(grip->end, 10e-6);
    brunt_scene_free(&s);
}
END_TEST

START_TEST(element_bodies) {
    brunt_scene s;
    ck_assert_msg(parse(elements, NULL, 0, &s) == BRUNT_OK, "%s", messages);
    const brunt_body_def *beam = &s.world.bodies[0], *sand = &s.world.bodies[1], *tets = &s.world.bodies[2];
    ck_assert(beam->method == BRUNT_FEM && tets->method == BRUNT_FEM && sand->method == BRUNT_MPM);
    ck_assert(beam->element == BRUNT_HEX8 && tets->element == BRUNT_TET4);
    NEAR(beam->size, 2e-3);
    NEAR(beam->mass_scaling, 2e-9);
    ck_assert(beam->hourglass == BRUNT_HOURGLASS_VISCOUS);
    NEAR(beam->hourglass_coefficient, 0.2);
    ck_assert(isnan(tets->hourglass_coefficient) && tets->mass_scaling == 0 && tets->mesh.node_count == 0);
    NEAR(tets->spin[2], 2);
    ck_assert_int_eq(sand->particles_per_cell, 8);
    ck_assert(s.warnings == NULL);
    brunt_scene_free(&s);
    // The kind follows the dimension; without particles no grid is wanted, and the whole of `contact` may be left out.
    static const char flat[] =
        "brunt: 1\ndimension: 2\ntime: {end: 1}\nmaterials: {m: {model: neo-hookean, density: 1, "
        "E: 1, nu: 0}}\nbodies: {b: {method: fem, material: m, size: 0.1, shape: {disk: {center: "
        "[0, 0], radius: 2}}}}\n";
    ck_assert_msg(parse(flat, NULL, 0, &s) == BRUNT_OK, "%s", messages);
    ck_assert(s.world.bodies[0].element == BRUNT_QUAD4 && s.world.bodies[0].hourglass == BRUNT_HOURGLASS_STIFFNESS);
    ck_assert(isnan(s.world.bodies[0].hourglass_coefficient) && s.world.cell == 0);
    ck_assert_int_eq(s.world.contact.method, BRUNT_CONTACT_AUGURY);
    ck_assert_str_eq(s.output.fields[0], "default");
    brunt_scene_free(&s);
    const char *grid = "grid={cell: 1}";
    ck_assert_int_eq(parse(flat, &grid, 1, &s), BRUNT_OK);
    ck_assert_str_eq(s.warnings, "grid: no body is of method mpm, it is not used\n");
    NEAR(s.world.cell, 1);
    brunt_scene_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(membranes) {
    brunt_scene s;
    ck_assert_msg(parse(sheets, NULL, 0, &s) == BRUNT_OK, "%s", messages);
    const brunt_body_def *bag = &s.world.bodies[0], *block = &s.world.bodies[1], *flag = &s.world.bodies[3];
    ck_assert(bag->method == BRUNT_MEMBRANE && flag->method == BRUNT_MEMBRANE && block->method == BRUNT_FEM);
    ck_assert(bag->element == BRUNT_MEMBRANE_QUAD4 && flag->element == BRUNT_MEMBRANE_TRI3);
    NEAR(bag->thickness, 0.2e-3);
    NEAR(bag->contact_thickness, 1e-3);
    NEAR(bag->damping, 50);
    ck_assert(isnan(flag->contact_thickness) && flag->damping == 0 && block->damping == 0 && block->thickness == 0);
    ck_assert(bag->tension_only && !flag->tension_only && bag->face_count == 0);
    ck_assert_int_eq(flag->face_count, 2);
    ck_assert_str_eq(flag->faces[1], "xmin");
    NEAR(flag->mass_scaling, 1e-8);
    const brunt_contact_def *c = &s.world.contact;
    ck_assert_int_eq(c->method, BRUNT_CONTACT_AUGURY);
    ck_assert_str_eq(c->pairs[0].a, "bag");
    ck_assert_str_eq(c->pairs[0].b, "bag");
    ck_assert_int_eq(c->pairs[0].method, BRUNT_CONTACT_AUGURY);
    ck_assert_int_eq(c->pairs[1].method, BRUNT_CONTACT_MULTI_VELOCITY);
    const brunt_group_def *air = &s.world.groups[0];
    ck_assert_int_eq(air->action, BRUNT_GROUP_GAS);
    NEAR(air->gas.gamma, 1.4);
    NEAR(air->gas.pressure, 2e5);
    NEAR(air->gas.outside, 1e5);
    NEAR(air->gas.inflow, 1e3);
    ck_assert(air->gas.volume == 0 && air->table.count == 2);
    ck_assert_str_eq(s.measures[0].column, "gas.air.pressure");
    brunt_scene_free(&s);
    // Without particles no grid is wanted, and a lonely membrane's contact is augury.
    static const char alone[] =
        "brunt: 1\ndimension: 3\ntime: {end: 1}\nmaterials: {m: {model: neo-hookean, density: 1, E: 1, nu: 0}}\n"
        "bodies: {b: {method: membrane, material: m, size: 1, thickness: 0.1, shape: {sphere: {center: [0, 0, 0], "
        "radius: 2}}}}\n";
    ck_assert_msg(parse(alone, NULL, 0, &s) == BRUNT_OK, "%s", messages);
    ck_assert_int_eq(s.world.contact.method, BRUNT_CONTACT_AUGURY);
    NEAR(s.world.cfl, 0.9);
    brunt_scene_free(&s);
    // Multi-velocity for all where no two meshes are.
    const char *grid[] = {"contact={method: multi-velocity, pairs: [{between: [bag, flag], method: none}, "
                          "{between: [bag, block], method: augury}, {between: [block, flag], method: none}]}"};
    ck_assert_msg(parse(sheets, grid, 1, &s) == BRUNT_OK, "%s", messages);
    brunt_scene_free(&s);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(augury) {
    brunt_scene s;
    ck_assert_msg(parse(elements, NULL, 0, &s) == BRUNT_OK, "%s", messages);
    const brunt_contact_def *c = &s.world.contact;
    ck_assert_int_eq(c->method, BRUNT_CONTACT_AUGURY);
    ck_assert_int_eq(c->form, BRUNT_AUGURY_PUBLISHED);
    ck_assert_int_eq(c->iterations, 0);
    ck_assert_int_eq(c->transfer, BRUNT_PIC);
    NEAR(c->cell, 3e-3);
    ck_assert_int_eq(c->pairs[0].method, BRUNT_CONTACT_NONE);
    NEAR(c->pairs[0].friction, 0.3);
    brunt_scene_free(&s);
    const char *sets[] = {"contact={pairs: [{between: [sand, tets], friction: 0.5}]}"};
    ck_assert_msg(parse(elements, sets, 1, &s) == BRUNT_OK, "%s", messages);
    ck_assert(s.world.contact.form == BRUNT_AUGURY_NODE_TO_FACET && s.world.contact.iterations == -1);
    ck_assert(s.world.contact.transfer == BRUNT_APIC && s.world.contact.cell == 0);
    ck_assert_int_eq(s.world.contact.pairs[0].method, BRUNT_CONTACT_AUGURY);
    brunt_scene_free(&s);
    // Multi-velocity for all, but not where a body of elements is.
    const char *bridged[] = {
        "contact={method: multi-velocity, pairs: [{between: [sand, tets], method: augury}, {between: "
        "[beam, tets], method: none}, {between: [sand, beam], method: none}], form: averaged_facets}"};
    ck_assert_msg(parse(elements, bridged, 1, &s) == BRUNT_OK, "%s", messages);
    ck_assert_int_eq(s.world.contact.form, BRUNT_AUGURY_AVERAGED_FACETS);
    brunt_scene_free(&s);
}
END_TEST

START_TEST(groups) {
    brunt_scene s;
    ck_assert_msg(parse(elements, NULL, 0, &s) == BRUNT_OK, "%s", messages);
    ck_assert_int_eq(s.world.group_count, 6);
    const brunt_group_def *g = s.world.groups;
    ck_assert_str_eq(g[0].name, "group1");
    ck_assert_str_eq(g[0].group, "xmin");
    ck_assert_str_eq(g[0].body, "beam");
    ck_assert(g[0].action == BRUNT_GROUP_VELOCITY && g[0].component[0] && !g[0].component[1] && g[0].component[2]);
    ck_assert(g[0].value[0] == 0 && g[0].table.count == 0);
    ck_assert(g[1].component[0] && g[1].component[1] && g[1].component[2]);
    ck_assert_str_eq(g[2].name, "pull");
    ck_assert(g[2].action == BRUNT_GROUP_DISPLACEMENT && !g[2].component[0] && g[2].component[1]);
    NEAR(g[2].value[2], 2e-3);
    ck_assert_int_eq(g[2].table.count, 3);
    NEAR(g[2].table.points[1][0], 0.5e-3);
    NEAR(g[2].table.points[1][1], 0.5);
    ck_assert(g[3].action == BRUNT_GROUP_VELOCITY && g[3].component[0] && !g[3].component[2]);
    ck_assert_str_eq(g[3].name, "group4");
    NEAR(g[3].value[0], 1);
    ck_assert(g[4].action == BRUNT_GROUP_TRACTION);
    NEAR(g[4].value[1], 1e3);
    ck_assert(g[5].action == BRUNT_GROUP_PRESSURE);
    NEAR(g[5].value[0], 2e6);
    brunt_scene_free(&s);
}
END_TEST

// Coordinates of a body, of a surface and of cells times what 1 stands for in their files.
static void meshes_in_millimetres(const char *name, const char *scene) {
    brunt_scene s;
    const char *body = "bodies.b.mesh_unit=1 mm",
               *shape = "bodies.b={method: fem, material: m, element: hex8, size: 1,"
                        " shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, mesh_unit: 1 mm}";
    ck_assert_msg(parse_file(name, scene, &body, 1, &s) == BRUNT_OK, "%s", messages);
    NEAR(s.world.bodies[0].mesh.nodes[1][0], 1e-3);
    NEAR(s.world.bodies[0].mesh.nodes[4][2], 1e-3);
    char *text = write_text(&s);
    ck_assert(strstr(text, "mesh_unit: 0.001\n") != NULL);
    brunt_scene_free(&s), free(text);
    ck_assert_int_eq(parse_file(name, scene, &shape, 1, &s), BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(messages, "mesh_unit: this belongs to a mesh file"), "%s", messages);
    const char *surface[] = {"grid={cell: 0.1}",
                             "boundaries=[{mesh: {file: two.msh, group: left face, unit: 2 cm}, condition: separate}]",
                             "bodies.b={method: mpm, material: m, shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}}"};
    ck_assert_msg(parse_file(name, scene, surface, 3, &s) == BRUNT_OK, "%s", messages);
    NEAR(s.world.surfaces[0].point[1][1], 0.02);
    brunt_scene_free(&s);
}

// A cube of two tetrahedra beside the scene: found from the scene's folder, whole path in the resolved scene.
START_TEST(mesh_files) {
    char folder[] = "/tmp/brunt_scene_XXXXXX", path[128], scene[512], wanted[160];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/two.msh", folder);
    FILE *file = fopen(path, "w");
    fputs(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"core\"\n2 2 \"left face\"\n$EndPhysicalNames\n"
        "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
        "$Elements\n3\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 2 3 4 5\n3 2 2 2 2 1 3 4\n$EndElements\n",
        file);
    fclose(file);
    snprintf(scene, sizeof scene,
             "brunt: 1\ndimension: 3\ntime: {end: 1}\nmaterials: {m: {model: neo-hookean, density: 1, E: 1, nu: 0}}\n"
             "bodies: {b: {method: fem, material: m, mesh: two.msh, group: core}}\n"
             "boundaries: [{group: left face, body: b, fix: all}]\n");
    char name[128];
    snprintf(name, sizeof name, "%s/scene.yaml", folder);
    brunt_scene s;
    FILE *out = open_messages();
    int status = brunt_scene_parse(scene, strlen(scene), name, NULL, 0, &s, out);
    fclose(out);
    ck_assert_msg(status == BRUNT_OK, "%s", messages);
    const brunt_mesh *mesh = &s.world.bodies[0].mesh;
    ck_assert_int_eq(mesh->kind, BRUNT_TET4);
    ck_assert_int_eq(s.world.bodies[0].element, BRUNT_TET4);
    ck_assert_int_eq(mesh->node_count, 5);
    ck_assert_int_eq(mesh->element_count, 2);
    ck_assert_str_eq(s.world.groups[0].group, "left face");
    char *text = write_text(&s);
    snprintf(wanted, sizeof wanted, "mesh: \"%s\"\n", path);
    ck_assert_msg(strstr(text, wanted) != NULL, "%s", text);
    brunt_scene_free(&s);
    check_fixpoint(text, "scene with a mesh file");
    free(text);
    // Its face is a sheet by itself, with groups `left face` and `surface`.
    const char *sheet[] = {"bodies.b={method: membrane, material: m, mesh: two.msh, group: left face, thickness: 0.01}",
                           "boundaries[0].group=surface"};
    ck_assert_msg(parse_file(name, scene, sheet, 2, &s) == BRUNT_OK, "%s", messages);
    ck_assert_int_eq(s.world.bodies[0].mesh.kind, BRUNT_MEMBRANE_TRI3);
    ck_assert_int_eq(s.world.bodies[0].element, BRUNT_MEMBRANE_TRI3);
    ck_assert_int_eq(s.world.bodies[0].mesh.element_count, 1);
    ck_assert_int_eq(s.world.bodies[0].mesh.group_count, 2);
    brunt_scene_free(&s);
    // ... and a surface that holds material points, as it is turned or the other way.
    for (int reversed = 0; reversed < 2; reversed++) {
        const char *surface[] = {
            "time={end: 1, scheme: implicit, step: 0.1}", "grid={cell: 0.1}",
            "bodies.b={method: mpm, material: m, shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}}",
            reversed ? "boundaries=[{mesh: {file: two.msh, group: left face, reversed: true}, condition: slip}]"
                     : "boundaries=[{mesh: {file: two.msh, group: left face}, condition: slip, velocity: [1, 2, 3]}]"};
        ck_assert_msg(parse_file(name, scene, surface, 4, &s) == BRUNT_OK, "%s", messages);
        const brunt_boundary_surface_def *def = &s.world.surfaces[0];
        ck_assert(s.world.surface_count == 1 && def->facet_count == 1 && def->point_count == 3);
        ck_assert(def->facet[0][0] == 0 && def->facet[0][1] == 1 + reversed && def->facet[0][2] == 2 - reversed);
        ck_assert(def->facet[0][3] == -1 && def->condition == BRUNT_SLIP && !def->displacement);
        for (int k = 0; k < 3; k++) NEAR(def->value[k], reversed ? 0 : k + 1);
        ck_assert_str_eq(def->name, "mesh1");
        brunt_scene_free(&s);
    }
    const char *other = "bodies.b.group=shell";
    ck_assert_int_eq(brunt_scene_parse(scene, strlen(scene), name, &other, 1, &s, NULL), BRUNT_BAD_INPUT);
    meshes_in_millimetres(name, scene);
    remove(path);
    remove(folder);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(output_and_measures) {
    brunt_scene s;
    parse_good(&s);
    NEAR(s.output.every, 2e-6);
    NEAR(s.output.history, 50e-9);
    ck_assert(isinf(s.output.checkpoint) && !s.output.float32);
    ck_assert_int_eq(s.output.field_count, 2);
    ck_assert_str_eq(s.output.fields[1], "stress");
    ck_assert_str_eq(s.output.probes[0].name, "tip");
    ck_assert_int_eq(s.measure_count, 5);
    const brunt_measure *kept = &s.measures[0], *length = &s.measures[1], *width = &s.measures[2],
                        *strain = &s.measures[3], *push = &s.measures[4];
    ck_assert_int_eq(kept->kind, BRUNT_MEASURE_HISTORY);
    ck_assert_str_eq(kept->column, "energy.total");
    ck_assert(kept->take == BRUNT_TAKE_END && kept->relative_to_initial && isnan(kept->relative_to));
    NEAR(kept->tolerance, 0.05);
    ck_assert(!kept->absolute);
    ck_assert_int_eq(length->kind, BRUNT_MEASURE_EXTENT);
    NEAR(length->expect, 0.0176);
    ck_assert(length->absolute);
    ck_assert_str_eq(length->unit, "m");
    ck_assert_str_eq(length->source, "x");
    ck_assert_int_eq(width->kind, BRUNT_MEASURE_RADIUS);
    NEAR(width->slab_max, 5e-3);
    ck_assert(width->slab_min == 0 && isnan(width->expect));
    ck_assert_int_eq(strain->kind, BRUNT_MEASURE_FIELD);
    ck_assert_int_eq(strain->component, 4);
    ck_assert_int_eq(strain->take, BRUNT_TAKE_MAX_ABS);
    ck_assert(isinf(strain->slab_min) && isinf(strain->slab_max));
    NEAR(push->from, 10e-6);
    NEAR(push->to, 40e-6);
    brunt_scene_free(&s);
}
END_TEST

START_TEST(units) {
    static const struct {
        const char *unit, *wanted;
        double one; // what 12 of it are; NAN: refused
    } rows[] = {{"mm", "m", 0.012},
                {"mm/us", "m/s", 12000},
                {"N/mm^2", "Pa", 12e6},
                {"degC", "K", 285.15},
                {"rpm", "rad/s", 0.4 * 3.14159265358979323846},
                {"deg", "rad", 12 * 3.14159265358979323846 / 180},
                {"\xc2\xb5s", "s", 12e-6},
                {"g/cm^3", "kg/m^3", 12000},
                {"%", "1", 0.12},
                {"rad/m", "1/m", 12},
                {"min", "s", 720},
                {"GPa", "m/s", NAN},
                {"Hz", "s", NAN},
                {"m^3/kg", "kg/m^3", NAN},
                {"1/s", "rad/s", NAN},
                {"deg", "1", NAN},
                {"mmm", "m", NAN},
                {"m)", "m", NAN},
                {"seconds since 2000-01-01", "s", NAN},
                {"m^999", "m", NAN}};
    brunt_units *u = brunt_units_open();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double value = 12;
        char message[320] = "";
        bool done = brunt_units_convert(u, rows[i].unit, rows[i].wanted, &value, message, sizeof message);
        ck_assert_msg(done == !isnan(rows[i].one), "%s to %s: %s", rows[i].unit, rows[i].wanted, message);
        if (done) ck_assert_double_eq_tol(value, rows[i].one, 1e-14 * fabs(rows[i].one));
        if (!done) ck_assert(*message && value == 12);
    }
    // Decimal prefixes give the double nearest to what was typed.
    for (int i = 1; i < 1000; i++) {
        char text[32], message[320];
        snprintf(text, sizeof text, "%de-3", i);
        double value = i;
        ck_assert(brunt_units_convert(u, "mm", "m", &value, message, sizeof message));
        ck_assert_msg(value == strtod(text, NULL), "%d mm", i);
    }
    brunt_units_close(u);
}
END_TEST

// What scenes are mostly written in is read without the database, and as by it: "(mm)" is not looked for before.
START_TEST(usual_units) {
    static const char *const rows[][2] = {
        {"m", "m"},      {"km", "m"},     {"cm", "m"},        {"mm", "m"},          {"um", "m"},
        {"nm", "m"},     {"s", "s"},      {"ms", "s"},        {"us", "s"},          {"ns", "s"},
        {"1/s", "1/s"},  {"kg", "kg"},    {"g", "kg"},        {"K", "K"},           {"m/s", "m/s"},
        {"km/s", "m/s"}, {"mm/s", "m/s"}, {"m/s^2", "m/s^2"}, {"kg/m^3", "kg/m^3"}, {"g/cm^3", "kg/m^3"},
        {"N", "N"},      {"kN", "N"},     {"Pa", "Pa"},       {"kPa", "Pa"},        {"MPa", "Pa"},
        {"GPa", "Pa"},   {"J", "J"},      {"mJ", "J"},        {"kJ", "J"},          {"W", "W"}};
    enum { ROWS = sizeof rows / sizeof *rows };
    brunt_units *with = brunt_units_open(), *without = brunt_units_open();
    double value = 1;
    char base[2][BRUNT_UNIT_LENGTH], message[320] = "", unit[32];
    ck_assert(brunt_units_convert(with, "inch", "m", &value, message, sizeof message)); // it is read now
    setenv("UDUNITS2_XML_PATH", "/nowhere/units.xml", 1);
    for (int i = 0; i < ROWS * 100; i++) {
        const char *const *row = rows[i % ROWS];
        const double given = i < ROWS ? 1 : i * 0.1371;
        double a = given, b = given;
        snprintf(unit, sizeof unit, "(%s)", row[0]);
        ck_assert_msg(brunt_units_convert(without, row[0], row[1], &a, message, sizeof message), "%s", message);
        ck_assert_msg(brunt_units_convert(with, unit, row[1], &b, message, sizeof message), "%s", message);
        ck_assert_msg(a == b, "%s: %.17g, by the database %.17g", row[0], a, b);
        a = b = given;
        ck_assert_msg(brunt_units_to_si(without, row[0], &a, base[0], message, sizeof message), "%s", message);
        ck_assert_msg(brunt_units_to_si(with, unit, &b, base[1], message, sizeof message), "%s", message);
        ck_assert_msg(a == b, "%s: %.17g, by the database %.17g", row[0], a, b);
        ck_assert_str_eq(base[0], base[1]);
    }
    ck_assert(!brunt_units_convert(without, "inch", "m", &value, message, sizeof message));
    ck_assert_ptr_nonnull(strstr(message, "database"));
    unsetenv("UDUNITS2_XML_PATH");
    brunt_units_close(without);
    brunt_units_close(with);
}
END_TEST

START_TEST(overrides) {
    const char *sets[] = {"time.end=0.2 ms",           "bodies.rod.velocity[2]=-50",    "boundaries[0].friction=0.1",
                          "boundaries.1.until=20 us",  "contact.initial_overlap=allow", "output.fields=[pressure]",
                          "materials.gum.viscosity={}"};
    brunt_scene s;
    int status = parse(good, sets, 7, &s);
    ck_assert_msg(status == BRUNT_OK, "%s", messages);
    NEAR(s.world.end, 0.2e-3);
    NEAR(s.world.bodies[1].velocity[2], -50);
    NEAR(s.world.planes[0].friction, 0.1);
    NEAR(s.world.regions[0].end, 20e-6);
    ck_assert(s.world.contact.allow_overlap);
    ck_assert_int_eq(s.output.field_count, 1);
    ck_assert(s.world.materials[1].bulk_viscosity);
    brunt_scene_free(&s);
    static const char *const threes[] = {"dimension=3.0", "dimension=+3", "dimension=0.3e1", "dimension=' 3 '"};
    for (int i = 0; i < 4; i++) { // whole numbers, however they are written
        ck_assert_msg(parse(good, &threes[i], 1, &s) == BRUNT_OK, "%s: %s", threes[i], messages);
        brunt_scene_free(&s);
    }
    static const struct {
        const char *set, *expect;
    } bad[] = {{"time.end=fast", "--set time.end=fast: time.end: 'fast' is not a number"},
               {"time.end", "--set time.end: path.to.key=value is wanted"},
               {"boundaries[9].friction=1", "--set boundaries[9].friction=1: boundaries has 3 entries"},
               {"time.end.x=1", "time.end is a single value"},
               {"time..end=1", "is not a path"},
               {"grid.cel=1", "--set grid.cel=1: grid.cel: unknown key, did you mean 'cell'?"},
               {"time.end=[", "--set time.end=[: not YAML"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ck_assert_int_eq(parse(good, &bad[i].set, 1, &s), BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(messages, bad[i].expect) != NULL, "%s\ngave\n%s", bad[i].set, messages);
    }
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

// {apic: 0} is apic to the bit, and a share is not.
START_TEST(shares_of_transfers) {
    static const char thrown[] =
        "brunt: 1\ndimension: 2\ntime: {end: 1 s}\ngrid: {cell: 0.1 m}\n"
        "materials:\n  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
        "bodies:\n  block: {method: mpm, material: rubber, shape: {box: {min: [0, 0], max: [1 m, 0.5 m]}},\n"
        "    velocity: [0, 1 m/s], wave: {velocity: [1 m/s, 0], wave_vector: [5 1/m, 3 1/m]}}\n";
    static const char *const transfers[] = {"grid.transfer=apic", "grid.transfer={apic: 0}",
                                            "grid.transfer={apic: 0.9}"};
    static const double share[] = {0, 0, 0.9};
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) {
        brunt_scene s;
        ck_assert_msg(parse(thrown, &transfers[k], 1, &s) == BRUNT_OK, "%s", messages);
        ck_assert_int_eq(s.world.transfer, BRUNT_APIC);
        NEAR(s.world.apic, share[k]);
        brunt_error error = {0};
        brunt_world *world = brunt_world_create(&s.world, &error);
        ck_assert_msg(world != NULL, "%s", error.message);
        ck_assert(brunt_effect_on(world, "kept_share") == (k == 2));
        for (int n = 0; n < 5; n++) ck_assert_msg(!brunt_world_step(world, INFINITY, &error), "%s", error.message);
        hash[k] = brunt_world_hash(world);
        brunt_world_destroy(world);
        char *text = write_text(&s);
        ck_assert(strstr(text, k ? "    apic: 0" : "  transfer: apic\n") && !strstr(text, "flip"));
        free(text);
        brunt_scene_free(&s);
    }
    ck_assert_uint_eq(hash[0], hash[1]);
    ck_assert_uint_ne(hash[0], hash[2]);
}
END_TEST

// A share of FLIP is of a time; what it was goes on by its own name. Whoever gives one of explicit steps is told.
START_TEST(share_of_flip_is_of_a_time) {
    static const char solid[] =
        "brunt: 1\ndimension: 2\ntime: {end: 1 s}\ngrid: {cell: 0.1 m}\n"
        "materials:\n  rubber: {model: neo-hookean, density: 1000 kg/m^3, E: 1 MPa, nu: 0.3}\n"
        "bodies:\n  block: {method: mpm, material: rubber, shape: {box: {min: [0, 0], max: [1 m, 0.5 m]}}}\n";
    static const struct {
        const char *set[2];
        double share;
        bool per_step;
        const char *told; // "": nothing is
    } ways[] = {
        {{"grid.transfer=flip", ""}, 0.99, false, "flip: 0.99 is now what is left after the time cell / 2c"},
        {{"grid.transfer={flip: 0.9}", ""}, 0.9, false, "flip: 0.9 is now what is left after the time cell / 2c"},
        {{"grid.transfer={flip: 1}", ""}, 1, false, ""},
        {{"grid.transfer={flip: 0.9}", "time={scheme: implicit, step: 1 ms, end: 1 s}"}, 0.9, false, ""},
        {{"grid.transfer={flip_per_step: 0.9}", ""}, 0.9, true, "this one goes with the next version"},
    };
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        brunt_scene s;
        ck_assert_msg(parse(solid, (const char **)ways[k].set, ways[k].set[1][0] ? 2 : 1, &s) == BRUNT_OK, "%s",
                      messages);
        ck_assert_int_eq(s.world.transfer, BRUNT_FLIP);
        NEAR(s.world.flip, ways[k].share);
        ck_assert(s.world.flip_per_step == ways[k].per_step);
        const char *said = s.warnings ? s.warnings : "";
        ck_assert_msg(ways[k].told[0] ? strstr(said, ways[k].told) != NULL : !said[0], "%s", said);
        brunt_scene_free(&s);
    }
}
END_TEST

static char *read_file(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    char *text = calloc(1, 1 << 20);
    if (text && fread(text, 1, (1 << 20) - 1, file) == 0) text[0] = 0;
    fclose(file);
    return text;
}

static const char *source_folder(void) {
    const char *folder = getenv("BRUNT_SOURCE");
    return folder ? folder : ".";
}

static bool is_yaml(const char *name) {
    size_t length = strlen(name);
    return length > 5 && strcmp(name + length - 5, ".yaml") == 0;
}

// The resolved scene is in the order of the table, whatever the order it was typed in.
START_TEST(order) {
    static const char *const texts[] = {
        "brunt: 1\ntime: {end: 1, cfl: 0.3}\ngrid: {cell: 1, kernel: linear}\nmaterials: {m: {model: neo-hookean, "
        "density: 1, "
        "E: 1, nu: 0}}\nbodies: {b: {method: mpm, material: m, shape: {sphere: {center: [0, 0, 0], radius: 2}}}}\n",
        "bodies: {b: {shape: {sphere: {radius: 2, center: [0, 0, 0]}}, material: m, method: mpm}}\nmaterials: {m: {nu: "
        "0, E: 1, "
        "density: 1, model: neo-hookean}}\ngrid: {kernel: linear, cell: 1}\ntime: {cfl: 0.3, end: 1}\nbrunt: 1\n"};
    char *written[2];
    for (int i = 0; i < 2; i++) {
        brunt_scene s;
        ck_assert_msg(parse(texts[i], NULL, 0, &s) == BRUNT_OK, "%s", messages);
        written[i] = write_text(&s);
        brunt_scene_free(&s);
    }
    ck_assert_str_eq(written[0], written[1]);
    free(written[0]);
    free(written[1]);
}
END_TEST

// The written scene reads back to the same scene, for the one above and for every example.
START_TEST(fixpoint) {
    check_fixpoint(good, "good");
    check_fixpoint(elements, "elements");
    check_fixpoint(sheets, "sheets");
    brunt_scene s;
    parse_good(&s);
    char *text = write_text(&s);
    ck_assert(strstr(text, "  end: 8e-05\n") && strstr(text, "    flip: 0.98\n") &&
              strstr(text, "    taylor_quinney: 0.9\n"));
    free(text);
    brunt_scene_free(&s);
    char path[1024];
    snprintf(path, sizeof path, "%s/bench/scenes", source_folder());
    DIR *folder = opendir(path);
    ck_assert_msg(folder != NULL, "%s", path);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (!is_yaml(entry->d_name)) continue;
        snprintf(path, sizeof path, "%s/bench/scenes/%s", source_folder(), entry->d_name);
        char *scene = read_file(path);
        ck_assert_ptr_nonnull(scene);
        check_fixpoint(scene, path);
        free(scene);
        count++;
    }
    closedir(folder);
    ck_assert_int_gt(count, 0);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

// Not inlined: gcc 12 takes what open_memstream sets for a pointer to a dead local.
__attribute__((noinline)) static char *captured(const char *section, bool *found) {
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    *found = brunt_scene_keys(section, out);
    fclose(out);
    return text;
}

START_TEST(reference) {
    bool found;
    char *text = captured(NULL, &found);
    ck_assert(found);
    for (int i = 0; i < brunt_scene_table_count; i++) {
        char line[256];
        snprintf(line, sizeof line, "\n  %s ", brunt_scene_table[i].path);
        ck_assert_msg(strstr(text, line) != NULL, "%s is not in the reference", brunt_scene_table[i].path);
    }
    for (int m = 0; m < brunt_strength_model_count; m++) {
        const brunt_model *model = brunt_strength_models[m];
        bool known;
        char *own = captured(model->name, &known);
        ck_assert(known && strstr(text, model->name));
        for (int p = 0; p < model->parameter_count; p++) ck_assert(strstr(own, model->parameters[p].key));
        free(own);
    }
    for (const char *line = text; *line; line += strcspn(line, "\n"), line += *line == '\n')
        ck_assert_msg(strcspn(line, "\n") <= 120, "wider than 120: %.130s", line);
    // The example at its top is a scene.
    const char *end = strstr(text, "\nValues take units");
    ck_assert_ptr_nonnull(end);
    char *example = strndup(text, (size_t)(end - text));
    check_fixpoint(example, "the example of the reference");
    free(example);
    free(text);
    text = captured("time", &found);
    ck_assert(found && strstr(text, "time.end") && !strstr(text, "grid.cell"));
    free(text);
    text = captured("time.cfl", &found);
    ck_assert(found && strstr(text, "time.cfl ") && !strstr(text, "time.end"));
    free(text);
    text = captured("bodies.*.random", &found);
    ck_assert(found && strstr(text, "bodies.*.random.seed") && !strstr(text, "bodies.*.random_"));
    ck_assert(!strstr(text, "bodies.*.seed"));
    free(text);
    static const char *const none[] = {"nonsense", "time.cf", "tim", "", "time."};
    for (int i = 0; i < 5; i++) {
        text = captured(none[i], &found);
        ck_assert_msg(!found && !*text, "%s: %s", none[i], text);
        free(text);
    }
}
END_TEST

// Whether a schema node describes the path, key by key.
static const json_t *schema_child(const json_t *root, const json_t *node, const char *key) {
    if (strcmp(key, "*") == 0) return json_object_get(node, "additionalProperties");
    const json_t *either = json_object_get(node, "anyOf");
    for (size_t i = 0; i < json_array_size(either); i++) {
        const json_t *found = schema_child(root, json_array_get(either, i), key);
        if (found) return found;
    }
    return json_object_get(json_object_get(node, "properties"), key);
}

START_TEST(schema) {
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    brunt_scene_schema(out);
    fclose(out);
    json_error_t error;
    json_t *root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(root != NULL, "%d:%d: %s", error.line, error.column, error.text);
    for (int i = 0; i < brunt_scene_table_count; i++) {
        char path[160], *rest = path;
        snprintf(path, sizeof path, "%s", brunt_scene_table[i].path);
        if (strstr(path, "<parameter>")) continue;
        const json_t *node = root;
        for (char *part; node && (part = strsep(&rest, "."));) {
            char *list = strstr(part, "[]");
            if (list) *list = 0;
            node = strcmp(part, "<shape>") == 0 ? json_object_get(json_object_get(root, "$defs"), "shape")
                                                : schema_child(root, node, part);
            if (list) node = json_object_get(node, "items");
        }
        ck_assert_msg(node != NULL, "%s is not in the schema", brunt_scene_table[i].path);
    }
    ck_assert_ptr_nonnull(strstr(text, "\"taylor_quinney\""));
    json_decref(root);
    free(text);
}
END_TEST

static void check_bad(const char *name, const char *text, size_t length) {
    char *out_text = NULL;
    size_t out_length;
    FILE *out = open_memstream(&out_text, &out_length);
    brunt_scene s;
    int status = brunt_scene_parse(text, length, name, NULL, 0, &s, out);
    fclose(out);
    ck_assert_msg(status == BRUNT_BAD_INPUT, "%s: status %d", name, status);
    small_expect_mistakes(name, name, text, out_text);
    free(out_text);
}

START_TEST(broken) {
    char path[1024];
    snprintf(path, sizeof path, "%s/tests/bad_scenes", source_folder());
    DIR *folder = opendir(path);
    ck_assert_msg(folder != NULL, "%s", path);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (!is_yaml(entry->d_name)) continue;
        snprintf(path, sizeof path, "%s/tests/bad_scenes/%s", source_folder(), entry->d_name);
        FILE *file = fopen(path, "rb");
        ck_assert_ptr_nonnull(file);
        static char text[1 << 16];
        size_t length = fread(text, 1, sizeof text - 1, file);
        text[length] = 0;
        fclose(file);
        check_bad(entry->d_name, text, length); // fails here, with its name
        count++;
    }
    closedir(folder);
    hard_case("C29", 180 - count, 0, 0, "bad scenes that get their message, of 180 at least: too few by");
}
END_TEST

START_TEST(files) {
    brunt_scene s;
    FILE *out = open_messages();
    ck_assert_int_eq(brunt_scene_read("/nonexistent/scene.yaml", NULL, 0, &s, out), BRUNT_IO_ERROR);
    fclose(out);
    ck_assert_ptr_nonnull(strstr(messages, "/nonexistent/scene.yaml: cannot be read: "));
    ck_assert_int_eq(brunt_scene_read("/", NULL, 0, &s, NULL), BRUNT_IO_ERROR);
    ck_assert_int_eq(brunt_scene_parse("", 0, "empty", NULL, 0, &s, NULL), BRUNT_BAD_INPUT);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("scene");
    TCase *tcase = tcase_create("scene");
    tcase_set_timeout(tcase, 0);
    tcase_add_test(tcase, world_values);
    tcase_add_test(tcase, body_values);
    tcase_add_test(tcase, contact_and_boundaries);
    tcase_add_test(tcase, element_bodies);
    tcase_add_test(tcase, membranes);
    tcase_add_test(tcase, augury);
    tcase_add_test(tcase, groups);
    tcase_add_test(tcase, mesh_files);
    tcase_add_test(tcase, output_and_measures);
    tcase_add_test(tcase, units);
    tcase_add_test(tcase, usual_units);
    tcase_add_test(tcase, overrides);
    tcase_add_test(tcase, shares_of_transfers);
    tcase_add_test(tcase, share_of_flip_is_of_a_time);
    tcase_add_test(tcase, order);
    tcase_add_test(tcase, fixpoint);
    tcase_add_test(tcase, reference);
    tcase_add_test(tcase, schema);
    tcase_add_test(tcase, broken);
    tcase_add_test(tcase, files);
    suite_add_tcase(suite, tcase);
    return suite_main(suite);
}
