// Bodies that lie in each other, or behind a plane, at the start: contact ends an approach, and would let them pass.
// They are refused with the place and the depth unless the definition allows it; bodies that touch are not.
#include "tests/support/hard_world.h"

typedef enum kind { QUAD, TRI, HEX, TET, POINTS, MEMBRANE } kind;
static const char *const kind_name[] = {"quad4", "tri3", "hex8", "tet4", "points", "sheet"};
static const brunt_element_kind element_of[] = {BRUNT_QUAD4, BRUNT_TRI3, BRUNT_HEX8,
                                                BRUNT_TET4,  BRUNT_HEX8, BRUNT_MEMBRANE_QUAD4};

// ------------------------------------------------------------------------------------------ worlds

static brunt_world_def begin(int dim, double cell) {
    brunt_world_def def = def_begin(dim, cell);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    return def;
}

// A box, its upper end alone where it is a sheet. `given`: the mesh is one that was read, not the box that is named.
static brunt_body_def *add(brunt_world_def *def, const char *name, kind k, const double low[3], const double high[3],
                           double size, bool given) {
    brunt_body_def *b = def_box(def, name, low, high);
    if (k == POINTS) {
        b->spacing = size;
        return b;
    }
    b->method = k == MEMBRANE ? BRUNT_MEMBRANE : BRUNT_FEM, b->element = element_of[k], b->size = size;
    if (k == MEMBRANE) {
        b->thickness = 0.1 * size;
        b->faces = brunt_alloc(sizeof *b->faces), b->face_count = 1;
        snprintf(*b->faces, sizeof *b->faces, "zmax");
    } else if (given) {
        brunt_error error = {0};
        ck_assert_msg(brunt_mesh_shape(&b->shape, def->dimension, b->element, size, &b->mesh, &error) == BRUNT_OK, "%s",
                      error.message);
    }
    return b;
}

// Empty when the world can be made.
static const char *refusal(brunt_world_def *def) {
    static char message[sizeof((brunt_error *)NULL)->message];
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(def, &error);
    snprintf(message, sizeof message, "%s", world ? "" : error.message);
    if (!world) ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    brunt_world_destroy(world);
    def->contact.allow_overlap = true;
    world = brunt_world_create(def, &error);
    ck_assert_msg(world != NULL, "it is allowed: %s", error.message);
    brunt_world_destroy(world);
    brunt_world_def_free(def);
    return message;
}

static void refused(brunt_world_def *def, const char *what) {
    const char *message = refusal(def);
    printf("  %s: %s\n", what, message);
    ck_assert_msg(strstr(message, "at the start") && strstr(message, "initial_overlap: allow"), "%s: '%s'", what,
                  message);
}

static void accepted(brunt_world_def *def, const char *what) {
    const char *message = refusal(def);
    ck_assert_msg(!*message, "%s: %s", what, message);
}

// Two cubes of edge 1, the second `gap` above the first and turned about the vertical; either may have the first name.
static brunt_world_def stack(kind lower, kind upper, double fine, double gap, double angle, bool swapped) {
    const int dim = lower == QUAD || lower == TRI || upper == QUAD || upper == TRI ? 2 : 3;
    brunt_world_def def = begin(dim, 0.25);
    const int up = dim - 1;
    double low[3] = {0.013, 0.017, 0.019}, high[3] = {1.013, 1.017, 1.019};
    low[up] = 1 + gap, high[up] = 2 + gap;
    add(&def, swapped ? "b" : "a", lower, XYZ(0, 0, 0), XYZ(1, 1, 1), 0.25, true);
    brunt_body_def *b = add(&def, swapped ? "a" : "b", upper, low, high, fine, true);
    if (dim == 3) b->place = brunt_placement_rotate(b->place, XYZ(0, 0, 1), angle, XYZ(0.5, 0.5, 0));
    return def;
}

// ------------------------------------------------------------------------------------------ each in each

// Edges of the first are 0.25, of the second 0.25 or much less: it is in the other by half an edge of its own.
START_TEST(one_in_the_other) {
    static const kind all[2][3] = {{QUAD, TRI, POINTS}, {HEX, TET, POINTS}};
    for (int space = 0; space < 2; space++)
        for (int k = 0; k < 9 * 2 * 2 * 2; k++) {
            const kind lower = all[space][k % 3], upper = all[space][k / 3 % 3];
            const bool swapped = k / 9 & 1, fine = k / 18 & 1, turned = k / 36 & 1;
            if ((lower == POINTS && upper == POINTS) || (turned && (!space || fine))) continue;
            const double size = fine ? (space ? 0.1 : 0.04) : upper == POINTS ? 0.125 : 0.25, angle = turned ? 0.3 : 0;
            char what[96];
            snprintf(what, sizeof what, "%s on %s, edge %g%s", kind_name[upper], kind_name[lower], size,
                     turned ? ", turned" : "");
            brunt_world_def def = stack(lower, upper, size, 0, angle, swapped);
            accepted(&def, what);
            def = stack(lower, upper, size, -0.55 * size, angle, swapped);
            refused(&def, what);
        }
}
END_TEST

// One in the place of the other, of the same elements and of others: no node of either is in the other one.
START_TEST(one_in_the_place_of_the_other) {
    for (int i = 0; i < 2 * (TET + 1); i++) {
        const kind k = (kind)(i / 2);
        const bool half = i % 2;
        brunt_world_def def = stack(k, k, half ? 0.125 : 0.25, -1, 0, false);
        refused(&def, kind_name[k]);
    }
}
END_TEST

// None of the nodes on the surface of the outer one is near the inner one.
START_TEST(one_wholly_in_the_other) {
    static const kind inner[] = {QUAD, HEX, TET, POINTS, MEMBRANE};
    for (int k = 0; k < 10; k++) {
        const kind in = inner[k % 5];
        const int dim = in == QUAD ? 2 : 3;
        const bool swapped = k / 5;
        brunt_world_def def = begin(dim, 0.1);
        add(&def, swapped ? "b" : "a", in == QUAD ? QUAD : HEX, XYZ(0, 0, 0), XYZ(1, 1, 1), 0.5, true);
        add(&def, swapped ? "a" : "b", in, XYZ(0.6, 0.6, 0.6), XYZ(0.9, 0.9, 0.9), 0.1, true);
        refused(&def, kind_name[in]);
    }
}
END_TEST

// Bars that cross: no node of either is in the other.
START_TEST(bars_that_cross) {
    for (int swapped = 0; swapped < 2; swapped++) {
        brunt_world_def def = begin(3, 0.1);
        add(&def, swapped ? "b" : "a", HEX, XYZ(-1, -0.1, -0.1), XYZ(1, 0.1, 0.1), 2, true);
        add(&def, swapped ? "a" : "b", HEX, XYZ(-0.1, -1, -0.1), XYZ(0.1, 1, 0.1), 2, true);
        refused(&def, "bars that cross");
        def = begin(3, 0.1);
        add(&def, swapped ? "b" : "a", HEX, XYZ(-1, -0.1, -0.1), XYZ(1, 0.1, 0.1), 2, true);
        add(&def, swapped ? "a" : "b", HEX, XYZ(-0.1, -1, 0.1), XYZ(0.1, 1, 0.3), 2, true);
        accepted(&def, "bars, one on the other");
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ sheets

// A sheet at the height of 0.13 edges of the block over nodes of it, or on top of it; fine and coarse.
START_TEST(membrane_through_a_body) {
    static const kind bodies[] = {HEX, TET, POINTS};
    for (int k = 0; k < 3 * 2 * 2; k++) {
        const kind body = bodies[k % 3];
        const bool swapped = k / 3 & 1, fine = k / 6;
        const double size = fine ? 0.1 : 1.4;
        brunt_world_def def = begin(3, 0.25);
        add(&def, swapped ? "b" : "a", body, XYZ(0, 0, 0), XYZ(1, 1, 1), 0.125, true);
        add(&def, swapped ? "a" : "b", MEMBRANE, XYZ(-0.2, -0.21, 0),
            XYZ(1.2, 1.19, 0.516 + (body == POINTS ? 0.04 : 0)), size, false);
        def.bodies[1].thickness = 1e-3;
        refused(&def, kind_name[body]);
        def = begin(3, 0.25);
        add(&def, swapped ? "b" : "a", body, XYZ(0, 0, 0), XYZ(1, 1, 1), 0.125, true);
        add(&def, swapped ? "a" : "b", MEMBRANE, XYZ(-0.2, -0.21, 0), XYZ(1.2, 1.19, 1.0005), size, false);
        def.bodies[1].thickness = 1e-3;
        accepted(&def, "a sheet on it");
    }
}
END_TEST

START_TEST(membranes_that_cross) {
    for (int k = 0; k < 4; k++) {
        const bool swapped = k & 1, apart = k >> 1;
        brunt_world_def def = begin(3, 0.25);
        add(&def, swapped ? "b" : "a", MEMBRANE, XYZ(0, 0, -1), XYZ(1, 1, 0), 0.1, false);
        brunt_body_def *b = add(&def, swapped ? "a" : "b", MEMBRANE, XYZ(0, 0, -1), XYZ(1, 1, 0.013), 0.1, false);
        b->place = brunt_placement_rotate(b->place, XYZ(1, 0, 0), 1.2, XYZ(0, 0.47, 0));
        if (apart) b->place = brunt_placement_translate(b->place, XYZ(0, 0, 0.6));
        if (apart)
            accepted(&def, "sheets apart");
        else
            refused(&def, "sheets that cross");
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ planes

START_TEST(behind_a_plane) {
    static const kind all[] = {QUAD, HEX, TET, POINTS, MEMBRANE};
    for (int k = 0; k < 5 * 3; k++) {
        const kind body = all[k % 5];
        const double depth = k / 5 == 0 ? 0 : k / 5 == 1 ? 0.1 : 5;
        const int dim = body == QUAD ? 2 : 3;
        for (int condition = BRUNT_SLIP; condition <= BRUNT_SEPARATE; condition++) {
            brunt_world_def def = begin(dim, 0.25);
            const double n[3] = {0.6, dim == 2 ? 0.8 : 0, dim == 3 ? 0.8 : 0}, on = body == MEMBRANE ? 0.8 : 0;
            add(&def, "a", body, XYZ(0, 0, 0), XYZ(1, 1, 1), 0.25, true);
            def_plane(&def, XYZ(n[0] * (on + depth), n[1] * (on + depth), n[2] * (on + depth)), n, condition, 0);
            if (depth > 0 && condition == BRUNT_SEPARATE)
                refused(&def, kind_name[body]);
            else
                accepted(&def, kind_name[body]);
        }
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ many, and none that meet

// Balls that touch in a row, with facets that are seen from both sides; a ring about a disk; bodies without a pair.
START_TEST(what_is_none) {
    brunt_world_def def = begin(3, 0.25);
    for (int k = 0; k < 6; k++) {
        char name[8];
        snprintf(name, sizeof name, "b%d", k);
        brunt_body_def *b = def_ball(&def, name, XYZ(1.0 * k, 0, 0), 0.5);
        b->method = BRUNT_FEM, b->element = k & 1 ? BRUNT_TET4 : BRUNT_HEX8, b->size = k & 2 ? 0.1 : 0.2;
    }
    accepted(&def, "balls that touch");
    def = begin(2, 0.25);
    brunt_body_def *ring = def_ball(&def, "ring", XYZ(0, 0, 0), 1);
    ring->shape.kind = BRUNT_TUBE, ring->shape.inner_radius = 0.5;
    ring->method = BRUNT_FEM, ring->element = BRUNT_QUAD4, ring->size = 0.1;
    brunt_body_def *disk = def_ball(&def, "disk", XYZ(0, 0, 0), 0.5);
    disk->method = BRUNT_FEM, disk->element = BRUNT_TRI3, disk->size = 0.13;
    accepted(&def, "a disk that fits its ring");
    def = stack(HEX, HEX, 0.25, -0.5, 0, false);
    def.contact.method = BRUNT_CONTACT_NONE;
    accepted(&def, "bodies that do not meet");
}
END_TEST

// ------------------------------------------------------------------------------------------ barriers

// Barriers know gaps, not insides: what lies in each other by however little would be kept there. Meshes that were
// read.
// `depth`: how it is told; NULL: they are apart.
static void expect_barriers(brunt_world_def *def, const char *what, const char *depth) {
    def->scheme = BRUNT_IMPLICIT, def->step = 1e-3;
    def->contact.method = BRUNT_CONTACT_BARRIER;
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(def, &error);
    printf("  %s: %s\n", what, error.message);
    ck_assert_msg(!depth == (world != NULL), "%s: %s", what, error.message);
    if (depth) ck_assert_msg(strstr(error.message, depth) != NULL, "%s: %s", what, error.message);
    brunt_world_destroy(world), brunt_world_def_free(def);
}

START_TEST(barriers_begin_outside) {
    static const kind all[2][3] = {{QUAD, TRI, POINTS}, {HEX, TET, POINTS}};
    for (int space = 0; space < 2; space++)
        for (int k = 0; k < 9 * 2; k++) {
            const kind lower = all[space][k % 3], upper = all[space][k / 3 % 3];
            const bool swapped = k / 9;
            if (lower == POINTS && upper == POINTS) continue;
            char what[96];
            snprintf(what, sizeof what, "%s on %s", kind_name[upper], kind_name[lower]);
            brunt_world_def def = stack(lower, upper, 0.25, 0.01, space ? 0.3 : 0, swapped);
            expect_barriers(&def, what, NULL);
            const double centre = lower == POINTS || upper == POINTS ? 0.125 : 0; // of the outermost points
            def = stack(lower, upper, 0.25, -0.01 - centre, space ? 0.3 : 0, swapped);
            expect_barriers(&def, what, " by 0.01 m at the start");
        }
    for (int k = QUAD; k <= TET; k++) {
        brunt_world_def def = stack(k, k, 0.125, -1, 0, false); // in the place of the other
        expect_barriers(&def, kind_name[k], "overlaps bodies.");
    }
}
END_TEST

// Rings whose facets cross though their circles do not.
START_TEST(facets_that_cross) {
    brunt_world_def def = begin(2, 0.25);
    for (int b = 0; b < 2; b++) {
        brunt_body_def *ring = add(&def, b ? "b" : "a", QUAD, XYZ(0, 0, 0), XYZ(6.283, 0.2, 0), 0.2, true);
        for (int32_t n = 0; n < ring->mesh.node_count; n++) {
            double *x = ring->mesh.nodes[n];
            const double r = (b ? 1.0005 : 0.7995) + x[1], t = x[0] * 0.7 + 0.1 * b; // not closed
            x[0] = -r * cos(t), x[1] = r * sin(t);
        }
    }
    expect_barriers(&def, "facets that cross", "overlaps bodies.");
}
END_TEST

int main(void) {
    Suite *suite = suite_create("initial_overlap");
    ADD(one_in_the_other);
    ADD(one_in_the_place_of_the_other);
    ADD(one_wholly_in_the_other);
    ADD(bars_that_cross);
    ADD(membrane_through_a_body);
    ADD(membranes_that_cross);
    ADD(behind_a_plane);
    ADD(what_is_none);
    ADD(barriers_begin_outside);
    ADD(facets_that_cross);
    return suite_main(suite);
}
