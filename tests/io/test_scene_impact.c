// Scenes of impact and penetration: materials of the library, failure and erosion, explosives, rings, graded meshes,
// tied bodies; and what only the world that is made of a scene can refuse.
#include "tests/support/small_scene.h"

#include <math.h>

#include "io/output/measures.h"
#include "base/memory.h"
#include "io/scene/scene_keys.h"

// `materials` and what else a test is about are put in front of two touching blocks.
static const char blocks[] =
    "brunt: 1\n"
    "time: {end: 1 ms}\n"
    "grid: {cell: 1 mm}\n"
    "bodies:\n"
    "  left: {method: mpm, material: stuff, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 mm, 4 mm]}}}\n"
    "  right: {method: fem, material: stuff, size: 1 mm, shape: {box: {min: [4 mm, 0, 0], max: [8 mm, 4 mm, 4 mm]}}}\n"
    "materials:\n"
    "  stuff: ";

static void read_with(const char *stuff, brunt_scene *scene) {
    char text[4096];
    snprintf(text, sizeof text, "%s%s\n", blocks, stuff);
    small_scene_of(text, scene, NULL, 0);
}

// Not inlined: gcc 12 takes what open_memstream sets for a pointer to a dead local.
__attribute__((noinline)) static char *resolved(const brunt_scene *scene) { return small_scene_resolved(scene); }

static brunt_material_def library(const char *name, const char *as) {
    brunt_material_def def;
    brunt_error error = {0};
    ck_assert_msg(brunt_material_preset(name, as, &def, &error) == BRUNT_OK, "%s", error.message);
    return def;
}

// A value that is left open is the model's own, or stays so.
static void expect_values(const brunt_model *model, const double *found, const double *wanted) {
    for (int k = 0; k < model->parameter_count; k++) {
        const double own = model->parameters[k].initial, want = isnan(wanted[k]) && !isnan(found[k]) ? own : wanted[k];
        ck_assert_msg(found[k] == want || (isnan(found[k]) && isnan(want)), "%s.%s is %.17g, not %.17g", model->name,
                      model->parameters[k].key, found[k], want);
    }
}

static void expect_alike(const brunt_material_def *found, const brunt_material_def *wanted) {
    const brunt_model *strength = brunt_find_strength(wanted->strength), *eos = brunt_find_eos(wanted->eos),
                      *failure = brunt_find_failure(wanted->failure);
    ck_assert_str_eq(found->name, wanted->name);
    ck_assert_str_eq(found->strength, wanted->strength);
    ck_assert_str_eq(found->eos, wanted->eos);
    ck_assert_str_eq(found->failure, wanted->failure);
    ck_assert_double_eq(found->density, wanted->density);
    expect_values(strength, found->strength_parameters, wanted->strength_parameters);
    if (eos) expect_values(eos, found->eos_parameters, wanted->eos_parameters);
    ck_assert(found->bulk_viscosity == wanted->bulk_viscosity);
    if (wanted->bulk_viscosity)
        expect_values(&brunt_bulk_viscosity, found->viscosity_parameters, wanted->viscosity_parameters);
    if (!failure) return;
    expect_values(failure, found->failure_parameters, wanted->failure_parameters);
    ck_assert(found->failure_action == wanted->failure_action);
}

// The state after some steps of the scene as it is and as it is written, which must be the same.
static void expect_same_run(const brunt_scene *scene, int steps) {
    brunt_scene again;
    char *first = resolved(scene);
    ck_assert_msg(!strstr(first, "preset"), "%s", first);
    small_scene_of(first, &again, NULL, 0);
    char *second = resolved(&again);
    ck_assert_str_eq(first, second);
    brunt_world *one = small_world(scene), *other = small_world(&again);
    small_steps(one, steps);
    small_steps(other, steps);
    ck_assert(brunt_world_hash(one) == brunt_world_hash(other));
    brunt_world_destroy(one);
    brunt_world_destroy(other);
    brunt_scene_free(&again);
    free(first);
    free(second);
}

START_TEST(presets_become_keys) {
    for (int32_t p = 0; p < brunt_preset_count(); p++) {
        char stuff[128];
        snprintf(stuff, sizeof stuff, "{preset: %s}", brunt_preset(p).name);
        brunt_scene scene, again;
        read_with(stuff, &scene);
        const brunt_material_def wanted = library(brunt_preset(p).name, "stuff");
        expect_alike(&scene.world.materials[0], &wanted);
        char *text = resolved(&scene);
        ck_assert_msg(!strstr(text, "preset"), "%s", text);
        small_scene_of(text, &again, NULL, 0);
        expect_alike(&again.world.materials[0], &wanted);
        free(text);
        brunt_scene_free(&again);
        brunt_scene_free(&scene);
    }
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(presets_run_as_written) {
    static const char *const stuff[] = {"{preset: copper-ofhc}", "{preset: tnt}\ndetonations: [{point: [0, 0, 0]}]",
                                        "{preset: steel-4340, failure: {action: soften, d1: 0.1}}",
                                        "{preset: concrete-48mpa}"};
    for (size_t s = 0; s < sizeof stuff / sizeof *stuff; s++) {
        brunt_scene scene;
        read_with(stuff[s], &scene);
        scene.world.bodies[0].velocity[0] = 0; // at rest but for what burns: the library's constants are in the step
        expect_same_run(&scene, 20);
        brunt_scene_free(&scene);
    }
}
END_TEST

static double strength_value(const brunt_scene *scene, const char *key) {
    const brunt_material_def *m = &scene->world.materials[0];
    const brunt_model *model = brunt_find_strength(m->strength);
    for (int k = 0; k < model->parameter_count; k++)
        if (!strcmp(model->parameters[k].key, key)) return m->strength_parameters[k];
    ck_abort_msg("no parameter %s", key);
}

static double failure_value(const brunt_scene *scene, const char *key) {
    const brunt_material_def *m = &scene->world.materials[0];
    const brunt_model *model = brunt_find_failure(m->failure);
    ck_assert_ptr_nonnull(model);
    for (int k = 0; k < model->parameter_count; k++)
        if (!strcmp(model->parameters[k].key, key)) return m->failure_parameters[k];
    ck_abort_msg("no parameter %s", key);
}

START_TEST(what_is_typed_beside_a_preset_stays) {
    const brunt_material_def copper = library("copper-ofhc", "stuff");
    const brunt_material_def *m;
    brunt_scene scene;
    // Single values, at every depth.
    read_with("{preset: copper-ofhc, density: 8 g/cm^3, A: 1 MPa, eos: {s: 1.2}, failure: {d2: 7, action: soften}, "
              "viscosity: {linear: 0.3}}",
              &scene);
    m = &scene.world.materials[0];
    ck_assert_double_eq(m->density, 8000);
    ck_assert_double_eq(strength_value(&scene, "A"), 1e6);
    ck_assert_double_eq(strength_value(&scene, "B"), 292e6);
    ck_assert_str_eq(m->eos, copper.eos);
    ck_assert_double_eq(m->eos_parameters[1], 1.2);
    ck_assert_double_eq(m->eos_parameters[0], copper.eos_parameters[0]);
    ck_assert_double_eq(failure_value(&scene, "d2"), 7);
    ck_assert_double_eq(failure_value(&scene, "d3"), -3.03);
    ck_assert(m->failure_action == BRUNT_FAILURE_SOFTEN && m->bulk_viscosity);
    ck_assert_double_eq(m->viscosity_parameters[0], 0.3);
    expect_same_run(&scene, 5);
    brunt_scene_free(&scene);
    // What is left out.
    read_with("{preset: copper-ofhc, eos: none, failure: none, viscosity: none}", &scene);
    m = &scene.world.materials[0];
    ck_assert(!*m->eos && !*m->failure && !m->bulk_viscosity);
    ck_assert_double_eq(strength_value(&scene, "B"), 292e6);
    expect_same_run(&scene, 5);
    brunt_scene_free(&scene);
    read_with("{preset: copper-ofhc, failure: none}", &scene);
    m = &scene.world.materials[0];
    ck_assert(!*m->failure && !strcmp(m->eos, copper.eos));
    brunt_scene_free(&scene);
    // Another equation of state, with none of the library's values; the same one typed out.
    read_with("{preset: copper-ofhc, eos: {model: tait, c0: 3 km/s}}", &scene);
    m = &scene.world.materials[0];
    ck_assert_str_eq(m->eos, "tait");
    ck_assert_double_eq(m->eos_parameters[0], 3000);
    ck_assert_str_eq(m->failure, copper.failure);
    brunt_scene_free(&scene);
    // Another strength model: density and equation of state remain where it takes one, damage does not.
    read_with("{preset: copper-ofhc, model: von-mises, E: 124 GPa, nu: 0.34, yield: 100 MPa}", &scene);
    m = &scene.world.materials[0];
    ck_assert_str_eq(m->strength, "von-mises");
    ck_assert_double_eq(m->density, 8930);
    ck_assert(!strcmp(m->eos, copper.eos) && !*m->failure);
    expect_same_run(&scene, 5);
    brunt_scene_free(&scene);
    read_with("{preset: copper-ofhc, model: neo-hookean, E: 124 GPa, nu: 0.34}", &scene);
    m = &scene.world.materials[0];
    ck_assert(!strcmp(m->strength, "neo-hookean") && !*m->eos && !*m->failure);
    ck_assert_double_eq(m->density, 8930);
    brunt_scene_free(&scene);
    // The library's own model named as well.
    read_with("{preset: copper-ofhc, model: johnson-cook}", &scene);
    expect_alike(&scene.world.materials[0], &copper);
    brunt_scene_free(&scene);
}
END_TEST

// What a failure model shares with the strength model is not in the scene, so that one change changes both.
START_TEST(shared_parameters_stay_open) {
    static const char *const shared[] = {"rate0", "melt", "reference_temperature"};
    static const char stuff[] = "{preset: copper-ofhc, melt: 1500 K, failure: {d1: 0.5}}";
    brunt_scene scene;
    read_with(stuff, &scene);
    char *text = resolved(&scene), *failure = strstr(text, "failure:");
    ck_assert_ptr_nonnull(failure);
    for (size_t k = 0; k < sizeof shared / sizeof *shared; k++) {
        ck_assert_double_nan(failure_value(&scene, shared[k]));
        char line[64];
        snprintf(line, sizeof line, "      %s:", shared[k]); // deeper than the strength model's
        ck_assert_msg(!strstr(failure, line), "%s", text);
    }
    ck_assert_double_eq(strength_value(&scene, "melt"), 1500);
    free(text);
    brunt_scene_free(&scene);
    read_with("{preset: copper-ofhc, failure: {melt: 1400 K}}", &scene);
    ck_assert_double_eq(failure_value(&scene, "melt"), 1400);
    ck_assert_double_eq(strength_value(&scene, "melt"), 1356);
    expect_same_run(&scene, 2);
    brunt_scene_free(&scene);
}
END_TEST

START_TEST(keys_have_their_values) {
    static const char text[] =
        "brunt: 1\n"
        "dimension: 2\n"
        "axisymmetric: true\n"
        "time: {end: 1 ms, least_step: 2 ns}\n"
        "grid: {cell: 1 mm}\n"
        "materials: {copper: {preset: copper-ofhc}, tnt: {preset: tnt}}\n"
        "bodies:\n"
        "  a: {method: fem, material: copper, size: 1 mm, shape: {box: {min: [0, 0], max: [8 mm, 4 mm]}},\n"
        "    grading: {x: [[2 mm, 50 %], [8 mm, 2]]}, erosion: {strain: 150 %, step: 3 ns, inverted: erode, debris: "
        "keep}}\n"
        "  b: {method: mpm, material: tnt, shape: {box: {min: [0, 6 mm], max: [8 mm, 9 mm]}}, erosion: {}}\n"
        "  c: {method: mpm, material: copper, shape: {box: {min: [0, 9 mm], max: [8 mm, 12 mm]}}}\n"
        "detonations:\n"
        "  - {point: [0, 6 mm], normal: [0, 1], time: -1 us, body: b}\n"
        "  - {point: [1 mm, 6 mm]}\n"
        "contact: {pairs: [{between: [c, b], method: tied}]}\n"
        "measures:\n"
        "  shape: {profile: {name: density, axis: [0, 1], center: [0, 1 mm], reference: [[0 mm, 1 g/cm^3], [2 mm, "
        "3e3], [2 mm, 5 g/cm^3]]}, "
        "expect: 0, tolerance: 1 %, tolerance_is: absolute}\n"
        "  of_b: {profile: {name: stress, component: yy, body: b, axis: [1, 0], reference: [[0, 1]]}}\n"
        "  front: {history: body.b.velocity_y, take: rise}\n";
    brunt_scene scene, again;
    small_scene_of(text, &scene, NULL, 0);
    char *written = resolved(&scene);
    small_scene_of(written, &again, NULL, 0);
    free(written);
    for (int pass = 0; pass < 2; pass++) { // as typed, and as written
        const brunt_scene *s = pass ? &again : &scene;
        const brunt_world_def *w = &s->world;
        ck_assert(w->axisymmetric && w->least_step == 2e-9);
        const brunt_erosion_def *e = &w->bodies[0].erosion;
        ck_assert(e->strain == 1.5 && e->step == 3e-9 && e->inverted && e->keep);
        e = &w->bodies[1].erosion;
        ck_assert(isinf(e->strain) && e->step == 0 && !e->inverted && !e->keep);
        e = &w->bodies[2].erosion;
        ck_assert(isinf(e->strain) && e->step == 0 && !e->inverted && !e->keep);
        const brunt_curve *g = w->bodies[0].grading;
        ck_assert_int_eq(g[0].count, 2);
        ck_assert(g[1].count == 0 && g[2].count == 0);
        ck_assert(g[0].points[0][0] == 2e-3 && g[0].points[0][1] == 0.5 && g[0].points[1][1] == 2);
        ck_assert(!w->bodies[1].total_lagrangian && !w->bodies[2].total_lagrangian);
        ck_assert_int_eq(w->detonation_count, 2);
        const brunt_detonation_def *d = w->detonations;
        ck_assert(d[0].point[1] == 6e-3 && d[0].normal[1] == 1 && d[0].time == -1e-6 && !strcmp(d[0].body, "b"));
        ck_assert(d[1].point[0] == 1e-3 && d[1].normal[1] == 0 && d[1].time == 0 && !*d[1].body);
        ck_assert(w->contact.pairs[0].method == BRUNT_CONTACT_TIED && w->contact.pairs[0].friction == 0);
        const brunt_measure *m = s->measures;
        ck_assert(m[0].kind == BRUNT_MEASURE_PROFILE && !*m[0].body && !strcmp(m[0].field, "density"));
        ck_assert(m[0].axis[1] == 1 && m[0].center[1] == 1e-3 && m[0].absolute && m[0].component == -1);
        ck_assert_int_eq(m[0].curve.count, 3);
        ck_assert(m[0].curve.points[0][1] == 1e3 && m[0].curve.points[1][0] == 2e-3);
        ck_assert(m[0].curve.points[2][0] == 2e-3 && m[0].curve.points[2][1] == 5e3);
        ck_assert(!strcmp(m[1].body, "b") && m[1].component == 1);
        ck_assert(m[2].take == BRUNT_TAKE_RISE);
    }
    brunt_scene_free(&scene);
    brunt_scene_free(&again);
    read_with("{preset: copper-ofhc}", &scene);
    ck_assert(!scene.world.axisymmetric && scene.world.least_step == 0 && scene.world.detonation_count == 0);
    ck_assert(isinf(scene.world.bodies[0].erosion.strain) && scene.world.bodies[1].grading[0].count == 0);
    brunt_scene_free(&scene);
    ck_assert_uint_eq(brunt_memory_live(), 0);
}
END_TEST

START_TEST(total_lagrangian_bodies) {
    static const char text[] = "brunt: 1\ntime: {end: 1}\ngrid: {cell: 1}\n"
                               "materials: {m: {model: neo-hookean, density: 1, E: 1, nu: 0}}\n"
                               "bodies: {b: {method: mpm, material: m, lagrangian: total, shape: {sphere: {center: [0, "
                               "0, 0], radius: 4}}}}\n";
    brunt_scene scene;
    small_scene_of(text, &scene, NULL, 0);
    ck_assert(scene.world.bodies[0].total_lagrangian);
    expect_same_run(&scene, 2);
    brunt_scene_free(&scene);
}
END_TEST

// A graded body of a scene has the nodes that its mesh has, and a profile over it is read.
START_TEST(graded_bodies) {
    static const char text[] =
        "brunt: 1\ndimension: 2\ntime: {end: 1}\nmaterials: {m: {model: neo-hookean, density: 1, E: 1, nu: 0}}\n"
        "bodies: {b: {method: fem, material: m, size: 0.1, shape: {box: {min: [0, 0], max: [1, 1]}}, place: "
        "[{translate: [5, 0]}], "
        "grading: {x: [[0, 1], [1, 3]]}}}\n"
        "boundaries: [{group: xmax, body: b, fix: all}]\n";
    brunt_scene scene;
    small_scene_of(text, &scene, NULL, 0);
    brunt_world *world = small_world(&scene);
    ck_assert_int_eq(brunt_body_size(world, 0, BRUNT_AT_ELEMENTS), 5 * 10); // ln 3 / 0.2 = 5.49
    const int64_t n = brunt_body_size(world, 0, BRUNT_AT_NODES);
    ck_assert_int_eq(n, 6 * 11);
    double *x = malloc(sizeof *x * 3 * (size_t)n), nearest = INFINITY;
    brunt_body_read(world, 0, brunt_body_find_field(world, 0, "position"), x);
    for (int64_t i = 0; i < n; i++) nearest = fmin(nearest, fabs(x[3 * i] - 5 - (pow(3, 0.4) - 1) / 2));
    ck_assert_double_le(nearest, 1e-6);
    free(x);
    brunt_world_destroy(world);
    expect_same_run(&scene, 5);
    brunt_scene_free(&scene);
}
END_TEST

typedef struct refused_world {
    const char *text, *message;
} refused_world;

static void expect_refused(const char *head, const refused_world *cases, int count) {
    for (int c = 0; c < count; c++) {
        char text[4096];
        brunt_scene scene;
        brunt_error error = {0};
        snprintf(text, sizeof text, "%s%s", head, cases[c].text);
        small_scene_of(text, &scene, NULL, 0);
        brunt_world *world = brunt_world_create(&scene.world, &error);
        ck_assert_msg(!world, "%s", cases[c].text);
        ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, cases[c].message), "%s\nis refused with: %s", cases[c].text, error.message);
        brunt_scene_free(&scene);
    }
    ck_assert_uint_eq(brunt_memory_live(), 0);
}

// Scenes whose mistakes show only when the world is made.
START_TEST(worlds_that_are_refused) {
    static const char head[] = "brunt: 1\ntime: {end: 1 ms}\ngrid: {cell: 1 mm}\n"
                               "materials: {m: {preset: copper-ofhc}, tnt: {preset: tnt}, water: {preset: water}, "
                               "gum: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.4}}\n";
    static const refused_world cases[] = {
        {"dimension: 2\naxisymmetric: true\n"
         "bodies: {b: {method: mpm, material: m, shape: {box: {min: [-1 mm, 0], max: [4 mm, 4 mm]}}}}\n",
         "bodies.b: a particle at r = "},
        {"dimension: 2\naxisymmetric: true\n"
         "bodies: {b: {method: fem, material: m, size: 1 mm, shape: {box: {min: [-1 mm, 0], max: [4 mm, 4 mm]}}}}\n",
         "bodies.b"},
        {"boundaries: [{name: cut, plane: {point: [0, 0, 0], normal: [1, 0, 0]}, condition: symmetry}]\n"
         "bodies: {b: {method: fem, material: m, size: 1 mm, shape: {box: {min: [-1 mm, 0, 0], max: [4 mm, 4 mm, 4 "
         "mm]}}}}\n",
         "bodies.b: it reaches 0.001 m behind the plane of symmetry 'cut'"},
        {"boundaries: [{name: cut, plane: {point: [0, 0, 0], normal: [1, 0, 0]}, condition: symmetry}]\n"
         "bodies: {b: {method: mpm, material: m, shape: {box: {min: [-1 mm, 0, 0], max: [4 mm, 4 mm, 4 mm]}}}}\n",
         "behind the plane of symmetry 'cut'"},
        {"dimension: 2\naxisymmetric: true\nloads: {gravity: [9.81, 0]}\n"
         "bodies: {b: {method: mpm, material: m, shape: {box: {min: [0, 0], max: [4 mm, 4 mm]}}}}\n",
         "loads.gravity: 9.81 m/s^2 along x, away from the axis of revolution"},
        {"dimension: 2\naxisymmetric: true\n"
         "bodies: {b: {method: mpm, material: m, spin: {rate: 3 rad/s}, shape: {box: {min: [0, 0], max: [4 mm, 4 "
         "mm]}}}}\n",
         "bodies.b.spin: rings do not turn in their plane"},
        {"dimension: 2\naxisymmetric: true\n"
         "bodies: {b: {method: mpm, material: m, lagrangian: total, shape: {box: {min: [0, 0], max: [4 mm, 4 mm]}}}}\n",
         "not in axisymmetric scenes"},
        {"bodies: {b: {method: mpm, material: gum, lagrangian: total, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 mm, "
         "4 mm]}}}, "
         "c: {method: mpm, material: gum, shape: {box: {min: [9 mm, 0, 0], max: [12 mm, 4 mm, 4 mm]}}}}\n",
         "contact of 'b' and 'c': bodies of material points meet at the nodes of their grids"},
        {"bodies: {b: {method: mpm, material: gum, lagrangian: total, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 mm, "
         "4 mm]}}}, "
         "c: {method: mpm, material: gum, shape: {box: {min: [9 mm, 0, 0], max: [12 mm, 4 mm, 4 mm]}}}}\n"
         "contact: {method: tied}\n",
         "contact of 'b' and 'c'"},
        {"bodies: {b: {method: mpm, material: water, lagrangian: total, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 "
         "mm, 4 mm]}}}}\n",
         "is a fluid: it has no undeformed configuration"},
        {"bodies: {b: {method: fem, material: m, size: 1 mm, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 mm, 4 "
         "mm]}}}}\n"
         "detonations: [{point: [0, 0, 0], body: b}]\n",
         "detonations[0]: it lights nothing, no material of body b is an explosive"},
        {"bodies: {b: {method: fem, material: m, size: 1 mm, shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, grading: "
         "{x: [[0, 1e-3]]}}}\n",
         "bodies.b: an edge length of 0.001 m makes more than 100 million nodes"},
    };
    expect_refused(head, cases, (int)(sizeof cases / sizeof *cases));
}
END_TEST

// Barriers have no energy where a gap is closed: at a plane, a mesh, and where only edges cross.
START_TEST(closed_gaps_are_refused) {
    static const char head[] = "brunt: 1\ndimension: 3\ntime: {end: 1 ms, scheme: implicit, step: 10 us}\n"
                               "grid: {cell: 1 mm}\nmaterials: {gum: {model: neo-hookean, density: 1000, E: 1 MPa, nu: "
                               "0.4}}\n";
    static const refused_world cases[] = {
        {"bodies: {b: {method: fem, material: gum, size: 2 mm, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 mm, 4 "
         "mm]}}}}\n"
         "boundaries: [{name: floor, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate}]\n",
         "bodies.b has a gap of 0 m to the plane 'floor' at the start, at (0, 0, 0) m: barriers want more than 0 m, "
         "0.0002 m to begin"},
        {"bodies: {b: {method: mpm, material: gum, particles_per_cell: 8, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 "
         "mm, 4 mm]}}}}\n"
         "boundaries: [{name: floor, plane: {point: [0, 0, 0.5 mm], normal: [0, 0, 1]}, condition: separate}]\n",
         "bodies.b has a gap of -0.00025 m to the plane 'floor' at the start"},
        {"bodies: {b: {method: fem, material: gum, size: 2 mm, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 mm, 4 "
         "mm]}}}}\n"
         "boundaries: [{name: floor, plane: {point: [0, 0, -1e-15], normal: [0, 0, 1]}, condition: separate}]\n",
         "bodies.b has a gap of 0 m to the plane 'floor' at the start"},
        {"bodies: {b: {method: mpm, material: gum, particles_per_cell: 8, shape: {box: {min: [0, 0, 0], max: [4 mm, 4 "
         "mm, 4 mm]}}}, c: {method: fem, material: gum, size: 2 mm, shape: {box: {min: [0, 0, 3.75 mm], max: [4 mm, 4 "
         "mm, 8 mm]}}}}\n",
         "bodies.b touches bodies.c at the start, or lies in it"},
        {"bodies: {b: {method: fem, material: gum, size: 10 mm, shape: {box: {min: [0, 4 mm, 0], max: [10 mm, 5 mm, 1 "
         "mm]}}}, c: {method: fem, material: gum, size: 10 mm, shape: {box: {min: [4 mm, 0, 1 mm], max: [5 mm, 10 mm, "
         "2 mm]}}}}\n",
         "bodies.b has a gap of 0 m to bodies.c at the start, at (0.00"},
    };
    expect_refused(head, cases, (int)(sizeof cases / sizeof *cases));
}
END_TEST

// How many warnings of a world of two explosives say `text`.
static int warnings_with(const char *detonations, const char *text) {
    brunt_scene scene;
    char typed[256];
    snprintf(typed, sizeof typed, "{preset: tnt}%s", detonations);
    read_with(typed, &scene);
    brunt_world *world = small_world(&scene);
    int found = 0;
    for (int32_t w = 0; w < brunt_warning_count(world); w++)
        found += strstr(brunt_world_warning(world, w), text) != NULL;
    brunt_world_destroy(world);
    brunt_scene_free(&scene);
    return found;
}

START_TEST(explosives_that_are_doubtful) {
    ck_assert_int_eq(warnings_with("", "this explosive is never lit"), 2);
    const char *left = "\ndetonations: [{point: [0, 0, 0], body: left}]",
               *far = "\ndetonations: [{point: [9 m, 0, 0]}]";
    ck_assert_int_eq(warnings_with(left, "bodies.right: this explosive is never lit"), 1);
    ck_assert_int_eq(warnings_with(left, "bodies.left: an explosive without bulk viscosity"), 1);
    ck_assert_int_eq(warnings_with(left, "outside of this explosive"), 0);
    ck_assert_int_eq(warnings_with(far, "outside of this explosive"), 2);
}
END_TEST

// Fluid that comes apart: what the step may be, or that none will do and what will.
START_TEST(lone_points_are_warned_of) {
    static const char text[] = "brunt: 1\ndimension: 2\ntime: {end: 1 ms, cfl: 0.9}\n"
                               "grid: {cell: 10 mm, kernel: %s}\n"
                               "materials: {water: {model: newtonian, density: 1000, dynamic_viscosity: 1e-3, eos: "
                               "{model: tait, c0: 25, tension: 0}}}\n"
                               "bodies: {w: {method: mpm, material: water, shape: {box: {min: [0, 0], max: [0.1, "
                               "0.1]}}}}\n";
    static const char *const kernels[] = {"linear", "quadratic"},
                             *const said[] = {"bodies.w: material points that come away from others bear pressure "
                                              "alone, which with this kernel and transfer is stable at no step: "
                                              "grid.kernel quadratic or cubic is wanted, or grid.transfer flip or pic",
                                              "is stable up to cfl 0.6; time.cfl is 0.9"};
    for (int k = 0; k < 2; k++) {
        char typed[1024];
        brunt_scene scene;
        snprintf(typed, sizeof typed, text, kernels[k]);
        small_scene_of(typed, &scene, NULL, 0);
        brunt_world *world = small_world(&scene);
        int found = 0;
        for (int32_t w = 0; w < brunt_warning_count(world); w++)
            found += strstr(brunt_world_warning(world, w), said[k]) != NULL;
        ck_assert_int_eq(found, 1);
        brunt_world_destroy(world);
        brunt_scene_free(&scene);
    }
}
END_TEST

// The plan says where the default of contact.touch does not act, and only there.
START_TEST(touch_of_membranes_is_told) {
    static const char text[] =
        "brunt: 1\ndimension: 3\ntime: {end: 1 ms}\n"
        "materials: {gum: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\n"
        "bodies:\n"
        "  drum: {method: membrane, material: gum, shape: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, faces: [zmin], "
        "size: "
        "1, thickness: 1 mm}\n"
        "  block: {method: fem, material: gum, size: 1, shape: {box: {min: [0, 0, 2], max: [1, 1, 3]}}}\n";
    static const char *const sets[] = {"contact.touch=elastic", "contact.touch=inelastic", "contact.method=none"};
    for (int s = 0; s < 3; s++) {
        brunt_scene scene;
        small_scene_of(text, &scene, &sets[s], 1);
        brunt_world *world = small_world(&scene);
        int found = 0;
        for (int32_t e = 0; e < brunt_effect_count(world); e++) {
            const brunt_effect effect = brunt_world_effect(world, e);
            if (strcmp(effect.name, "membranes") != 0) continue;
            ck_assert(effect.on);
            found += strstr(effect.because, "gives nothing back (contact.touch)") != NULL;
        }
        ck_assert_int_eq(found, s == 0);
        brunt_world_destroy(world);
        brunt_scene_free(&scene);
    }
}
END_TEST

// Nodes that two boundaries hold or move: the first has them, and where the second would move them otherwise that is
// said once, of any number of nodes.
START_TEST(boundaries_that_share_nodes) {
    static const char head[] = "brunt: 1\ndimension: 3\ntime: {end: 1 ms}\n"
                               "materials: {gum: {model: neo-hookean, density: 1000, E: 1 MPa, nu: 0.3}}\n"
                               "bodies:\n"
                               "  a: {method: fem, material: gum, size: 1, shape: {box: {min: [0, 0, 0], max: [1, 1, "
                               "1]}}}\n"
                               "  b: {method: fem, material: gum, size: 1, shape: {box: {min: [0, 0, 2], max: [1, 1, "
                               "3]}}}\n"
                               "boundaries:\n";
    static const struct {
        const char *boundaries, *said; // NULL: nothing
    } cases[] = {
        {"  - {name: hold, body: a, group: xmin, fix: all}\n  - {name: push, body: a, group: xmin, velocity: [1, 0, "
         "0]}",
         "boundaries (push): 4 of the 4 nodes of group 'xmin' of body 'a' are moved by boundaries (hold) along x: it "
         "comes first, and 'push' does not move them there"},
        {"  - {name: push, body: a, group: xmin, velocity: [1, 0, 2]}\n  - {name: hold, body: a, group: ymin, fix: "
         "all}",
         "boundaries (hold): 2 of the 4 nodes of group 'ymin' of body 'a' are moved by boundaries (push) along x z: "
         "it"},
        {"  - {name: turn, body: a, group: zmin, rotation: {angle: 1, axis: [0, 0, 1]}}\n"
         "  - {name: lift, body: a, group: zmin, displacement: [free, free, 1]}",
         "are moved by boundaries (turn) along z: it comes first, and 'lift'"},
        {"  - {name: slow, body: a, group: zmin, velocity: [0, 0, 1]}\n"
         "  - {name: fast, body: a, group: zmin, velocity: [0, 0, 1], table: [[0, 0], [1, 1]]}",
         "are moved by boundaries (slow) along z: it comes first, and 'fast'"},
        {"  - {name: lift, body: a, group: zmin, displacement: [free, free, 1]}\n"
         "  - {name: turn, body: a, group: zmin, rotation: {angle: 1, axis: [0, 0, 1]}}",
         NULL},
        {"  - {name: one, body: a, group: xmin, fix: all}\n  - {name: two, body: a, group: ymin, fix: all}", NULL},
        {"  - {name: one, body: a, group: xmin, velocity: [1, 0, 0]}\n"
         "  - {name: two, body: a, group: ymin, velocity: [1, 0, 0]}",
         NULL},
        {"  - {name: one, body: a, group: xmin, fix: [y]}\n"
         "  - {name: two, body: a, group: xmin, velocity: [1, free, free]}",
         NULL},
        {"  - {name: one, body: a, group: xmin, fix: all}\n  - {name: two, body: b, group: xmin, velocity: [1, 0, 0]}",
         NULL},
        {"  - {name: one, body: a, group: xmin, fix: all}\n  - {name: two, body: a, group: xmax, velocity: [1, 0, 0]}",
         NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1200];
        brunt_scene scene;
        const int length = snprintf(text, sizeof text, "%s%s\n", head, cases[i].boundaries);
        ck_assert_int_eq(brunt_scene_parse(text, (size_t)length, "shared.yaml", NULL, 0, &scene, stderr), BRUNT_OK);
        brunt_world *world = small_world(&scene);
        ck_assert_msg(brunt_warning_count(world) == (cases[i].said != NULL), "%s: %d warnings", cases[i].boundaries,
                      (int)brunt_warning_count(world));
        if (cases[i].said)
            ck_assert_msg(strstr(brunt_world_warning(world, 0), cases[i].said) != NULL, "%s",
                          brunt_world_warning(world, 0));
        brunt_world_destroy(world);
        brunt_scene_free(&scene);
    }
}
END_TEST

__attribute__((noinline)) static char *captured(const char *section, bool *found) {
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    *found = brunt_scene_keys(section, out);
    fclose(out);
    return text;
}

START_TEST(reference_has_presets_and_failure) {
    bool found;
    char *presets = captured("presets", &found), *all = captured(NULL, &found);
    for (int32_t p = 0; p < brunt_preset_count(); p++) {
        ck_assert_msg(strstr(presets, brunt_preset(p).name), "%s", presets);
        ck_assert(strstr(all, brunt_preset(p).name));
    }
    ck_assert(strstr(presets, "Johnson and Cook") && !strstr(presets, "grid.cell"));
    for (const char *line = presets; *line; line += strcspn(line, "\n"), line += *line == '\n')
        ck_assert_msg(strcspn(line, "\n") <= 120, "wider than 120: %.130s", line);
    for (int k = 0; k < brunt_failure_model_count; k++) {
        const brunt_model *model = brunt_failure_models[k];
        char *own = captured(model->name, &found);
        ck_assert(found && strstr(all, model->name));
        for (int p = 0; p < model->parameter_count; p++) ck_assert(strstr(own, model->parameters[p].key));
        free(own);
    }
    char *own = captured("detonations", &found);
    ck_assert(found && strstr(own, "detonations[].normal") && !strstr(own, "bodies"));
    free(own);
    free(presets);
    free(all);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("scene_impact");
    TCase *tests = tcase_create("scene_impact");
    tcase_add_test(tests, presets_become_keys);
    tcase_add_test(tests, presets_run_as_written);
    tcase_add_test(tests, what_is_typed_beside_a_preset_stays);
    tcase_add_test(tests, shared_parameters_stay_open);
    tcase_add_test(tests, keys_have_their_values);
    tcase_add_test(tests, total_lagrangian_bodies);
    tcase_add_test(tests, graded_bodies);
    tcase_add_test(tests, worlds_that_are_refused);
    tcase_add_test(tests, closed_gaps_are_refused);
    tcase_add_test(tests, explosives_that_are_doubtful);
    tcase_add_test(tests, lone_points_are_warned_of);
    tcase_add_test(tests, touch_of_membranes_is_told);
    tcase_add_test(tests, boundaries_that_share_nodes);
    tcase_add_test(tests, reference_has_presets_and_failure);
    suite_add_tcase(suite, tests);
    return suite_main(suite);
}
