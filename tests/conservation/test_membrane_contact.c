// Labels: stability
// Contact of membranes, which have two sides: with solids, particles, planes, each other and themselves. What is kept,
// what does not get through, what is left alone. tests/README.md has the table.
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"

static const double THICK = 0.02; // [m]

// ------------------------------------------------------------------------------------------ worlds

static brunt_world_def begin(double cell, double friction) {
    brunt_world_def def = def_begin(3, cell);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.pairs = brunt_alloc(DEF_CAPACITY * sizeof *def.contact.pairs);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = friction;
    return def;
}

// A place on a sheet of n x m quadrilaterals, s and t in 0..1.
typedef void place_fn(double s, double t, double x[3]);

static void add_group(brunt_mesh *mesh, int at, const char *name, const int32_t *nodes, int32_t count) {
    brunt_group *g = &mesh->groups[at];
    snprintf(g->name, sizeof g->name, "%s", name);
    g->nodes = brunt_alloc((size_t)(count + 1) * sizeof *g->nodes);
    memcpy(g->nodes, nodes, (size_t)count * sizeof *nodes);
    g->count = count;
}

// Groups: border (all of it), left and right (s = 0 and 1), low (s < 1/2). `turned`: its front is where its back was.
static brunt_body_def *sheet(brunt_world_def *def, const char *name, int n, int m, place_fn *place, bool turned) {
    brunt_body_def *b = def_body(def, name);
    brunt_mesh *mesh = &b->mesh;
    b->method = BRUNT_MEMBRANE, b->thickness = THICK, b->element = BRUNT_MEMBRANE_QUAD4;
    *mesh = (brunt_mesh){.kind = BRUNT_MEMBRANE_QUAD4, .node_count = (n + 1) * (m + 1), .element_count = n * m};
    mesh->nodes = brunt_alloc((size_t)mesh->node_count * sizeof *mesh->nodes);
    mesh->elements = brunt_alloc((size_t)mesh->element_count * 4 * sizeof *mesh->elements);
    mesh->groups = brunt_alloc(4 * sizeof *mesh->groups), mesh->group_count = 4;
    int32_t *list[4], count[4] = {0}, *element = mesh->elements;
    for (int g = 0; g < 4; g++) list[g] = calloc((size_t)mesh->node_count, sizeof **list);
    for (int32_t i = 0, k = 0; i <= n; i++)
        for (int32_t j = 0; j <= m; j++, k++) {
            place((double)i / n, (double)j / m, mesh->nodes[k]);
            if (i == 0 || j == 0 || i == n || j == m) list[0][count[0]++] = k;
            if (i == 0) list[1][count[1]++] = k;
            if (i == n) list[2][count[2]++] = k;
            if (2 * i < n) list[3][count[3]++] = k;
            if (i == n || j == m) continue;
            const int32_t corner[4] = {k, k + m + 1, k + m + 2, k + 1};
            for (int c = 0; c < 4; c++) *element++ = corner[turned ? 3 - c : c];
        }
    static const char *const names[] = {"border", "left", "right", "low"};
    for (int g = 0; g < 4; g++) {
        add_group(mesh, g, names[g], list[g], count[g]);
        free(list[g]);
    }
    return b;
}

static brunt_body_def *mesh_box(brunt_world_def *def, const char *name, const double low[3], const double high[3],
                                double size) {
    brunt_body_def *b = def_box(def, name, low, high);
    b->method = BRUNT_FEM, b->element = BRUNT_HEX8, b->size = size;
    return b;
}

static brunt_group_def *hold(brunt_world_def *def, const char *body, const char *group) {
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", body), snprintf(g->group, sizeof g->group, "%s", group);
    return g;
}

static void meets_itself(brunt_world_def *def, const char *name) {
    brunt_pair_def *p = &def->contact.pairs[def->contact.pair_count++];
    *p = (brunt_pair_def){.method = BRUNT_CONTACT_AUGURY, .friction = def->contact.friction};
    snprintf(p->a, sizeof p->a, "%s", name), snprintf(p->b, sizeof p->b, "%s", name);
}

static int body_named(const brunt_world *world, const char *name) {
    for (int b = 0; b < brunt_body_count(world); b++)
        if (!strcmp(brunt_body_name(world, b), name)) return b;
    ck_abort_msg("there is no body %s", name);
    return -1;
}

static double stored(const brunt_energy *e) { return e->kinetic + e->internal + e->hourglass; }

// ------------------------------------------------------------------------------------------ what is on which side

// Height of a place over a sheet that is still a graph over the plane x, y; NAN beside it. From the places of its nodes
// alone: triangles about the middle of each element.
static double height_over(const double (*node)[3], const int32_t *quad, int64_t quads, const double p[3]) {
    for (int64_t q = 0; q < quads; q++, quad += 4) {
        double centre[3] = {0};
        for (int c = 0; c < 4; c++)
            for (int a = 0; a < 3; a++) centre[a] += 0.25 * node[quad[c]][a];
        for (int c = 0; c < 4; c++) {
            const double *a = node[quad[c]], *b = node[quad[(c + 1) % 4]];
            double e[2] = {b[0] - a[0], b[1] - a[1]}, g[2] = {centre[0] - a[0], centre[1] - a[1]},
                   r[2] = {p[0] - a[0], p[1] - a[1]}, det = e[0] * g[1] - e[1] * g[0];
            double u = (r[0] * g[1] - r[1] * g[0]) / det, v = (e[0] * r[1] - e[1] * r[0]) / det;
            if (u < -1e-12 || v < -1e-12 || u + v > 1 + 1e-12) continue;
            return p[2] - (a[2] + u * (b[2] - a[2]) + v * (centre[2] - a[2]));
        }
    }
    return NAN;
}

// Least and greatest height of a body's nodes, or particles, over a sheet.
static void heights(brunt_world *world, int membrane_body, int body, double *least, double *most) {
    double(*node)[3] = (void *)world_field(world, membrane_body, "position");
    double(*x)[3] = (void *)world_field(world, body, "position");
    int64_t quads = brunt_body_elements(world, membrane_body);
    int64_t count = brunt_body_nodes(world, body) + brunt_body_particles(world, body);
    int32_t *quad = malloc((size_t)(4 * quads) * sizeof *quad);
    brunt_body_connectivity(world, membrane_body, quad);
    *least = INFINITY, *most = -INFINITY;
    for (int64_t i = 0; i < count; i++) {
        double h = height_over((const double(*)[3])node, quad, quads, x[i]);
        if (h < *least) *least = h;
        if (h > *most) *most = h;
    }
    free(node), free(x), free(quad);
}

// The same the other way: nodes of a sheet under (over) the lower (upper) face of a block that hardly deforms.
static double stays_between(brunt_world *world, int body, double low, double high) {
    double(*x)[3] = (void *)world_field(world, body, "position"), out = 0;
    for (int64_t i = 0; i < brunt_body_nodes(world, body); i++) out = fmax(out, fmax(low - x[i][2], x[i][2] - high));
    free(x);
    return out;
}

static void flat(double s, double t, double x[3]) { x[0] = s, x[1] = t, x[2] = 0; }
static void wide(double s, double t, double x[3]) { x[0] = 1.6 * s - 0.3, x[1] = 1.6 * t - 0.3, x[2] = 0; }

// ------------------------------------------------------------------------------------------ between two blocks

// A free membrane with a block a tenth of an edge away on either side, both much nearer than an edge, and thrown at it.
START_TEST(between_two_blocks) {
    const bool turned = _i & 1;
    const double gap = 0.03;
    brunt_world_def def = begin(1, 0.3);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    sheet(&def, "m", 8, 8, wide, turned);
    mesh_box(&def, "above", XYZ(0.03, 0.01, gap), XYZ(1.03, 1.01, gap + 0.5), 0.25);
    brunt_body_def *below = mesh_box(&def, "below", XYZ(0, 0, -gap - 0.75), XYZ(1, 1, -gap), 0.25);
    def_velocity(&def.bodies[1], 0.2, 0, -2), def_velocity(below, 0, 0.1, 2);
    brunt_world *world = world_take(&def);
    const int m = body_named(world, "m"), a = body_named(world, "above"), b = body_named(world, "below");
    double over = INFINITY, under = -INFINITY, least, most, stray = 0, top = 0;
    for (int k = 0; k < 60; k++) {
        world_steps(world, 5);
        heights(world, m, a, &least, &most), over = fmin(over, least);
        heights(world, m, b, &least, &most), under = fmax(under, most);
        brunt_energy e = world_energy(world);
        top = fmax(top, stored(&e) / e.initial);
        stray = fmax(stray, stays_between(world, m, -0.3, 0.3));
    }
    brunt_energy e = world_energy(world);
    brunt_momentum p = world_momentum(world);
    brunt_body_sums up = world_sums(world, a), down = world_sums(world, b), membrane_sums = world_sums(world, m);
    printf("squeezed%s: upper block from %.4f, lower to %.4f (half thickness %.3f), apart at %.2f, %.2f m/s; "
           "E %.4f, most %.6f, error %.1e, drift %.1e %.1e\n",
           turned ? ", turned" : "", over, under, THICK / 2, up.velocity[2], down.velocity[2], stored(&e) / e.initial,
           top, e.error_relative, p.linear_drift, p.angular_drift);
    const char *how = turned ? ", sheet turned over" : "";
    hard_case("C08", 1 - fmin(over, -under) / (THICK / 2), 1, 0.2,
              "blocks on both sides of a sheet%s: depth [half thicknesses]", how);
    ck_assert_double_gt(up.velocity[2], 0.5);
    ck_assert_double_lt(down.velocity[2], -0.2);
    ck_assert(up.centre[2] > membrane_sums.centre[2] && membrane_sums.centre[2] > down.centre[2]);
    hard_case("C08", p.linear_drift, ROUNDING, ROUNDING, "blocks on both sides of a sheet%s: drift of momentum", how);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(fabs(e.error_relative), 2e-3);
    ck_assert_double_lt(top, 1 + 1e-4);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ ball on a membrane

// A ball on a clamped membrane, from above or (side -1) from below. Out: height of the centre against time.
enum { SAMPLES = 40 };
static void drop_ball(double side, bool turned, double z[SAMPLES]) {
    brunt_world_def def = begin(1, 0.2);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    sheet(&def, "m", 10, 10, flat, turned);
    hold(&def, "m", "border");
    brunt_body_def *ball = def_ball(&def, "ball", XYZ(0.5, 0.5, side * 0.33), 0.3);
    ball->method = BRUNT_FEM, ball->element = BRUNT_HEX8, ball->size = 0.12;
    def_velocity(ball, 0, 0, -2 * side);
    brunt_world *world = world_take(&def);
    const int m = body_named(world, "m"), b = body_named(world, "ball");
    double deepest = INFINITY, top = 0;
    for (int k = 0; k < SAMPLES; k++) {
        double least, most;
        world_until(world, 0.01 * (k + 1));
        heights(world, m, b, &least, &most);
        deepest = fmin(deepest, side > 0 ? least : -most);
        z[k] = world_sums(world, b).centre[2];
        brunt_energy e = world_energy(world);
        top = fmax(top, stored(&e) / e.initial);
    }
    brunt_energy e = world_energy(world);
    brunt_momentum p = world_momentum(world);
    brunt_body_sums s = world_sums(world, b);
    brunt_reaction held = world_boundary(world, 0);
    printf("ball from %s%s: nearest %.4f of %.3f, leaves at %.3f m/s, E %.4f, most %.6f, error %.1e, drift %.1e\n",
           side > 0 ? "above" : "below", turned ? ", turned" : "", deepest, THICK / 2, s.velocity[2],
           stored(&e) / e.initial, top, e.error_relative, p.linear_drift);
    ck_assert_double_gt(deepest, THICK / 2 - 0.03 * 0.1); // of an edge
    ck_assert_double_gt(side * s.velocity[2], 0.5);
    ck_assert_double_gt(side * held.impulse[2], 2 * s.mass);
    ck_assert_double_lt(top, 1 + 1e-4);
    ck_assert_double_lt(fabs(e.error_relative), 5e-3);
    ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    brunt_world_destroy(world);
}

START_TEST(both_sides_are_alike) {
    double above[SAMPLES], below[SAMPLES], turned[SAMPLES], far = 0;
    drop_ball(1, false, above);
    drop_ball(-1, false, below);
    drop_ball(1, true, turned);
    for (int k = 0; k < SAMPLES; k++) far = fmax(far, fmax(fabs(above[k] + below[k]), fabs(above[k] - turned[k])));
    printf("most that sides differ by: %.1e m\n", far);
    ck_assert_double_lt(far,
                        1e-4); // a thousandth of an edge: which of two equally near facets is met, rounding decides
}
END_TEST

// ------------------------------------------------------------------------------------------ particles

// Material points on either side of a free membrane, nearer to it than a cell and thrown at it: none comes through, and
// as the two bodies have no contact with each other, what passes between them does so through it.
START_TEST(particles_on_either_side) {
    const double cell = 0.1;
    brunt_world_def def = begin(cell, 0);
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    sheet(&def, "m", 10, 10, wide, false)->material = 1;
    def_velocity(def_box(&def, "above", XYZ(0.2, 0.2, 0.02), XYZ(0.8, 0.8, 0.42)), 0, 0.3, -1.5);
    def_velocity(def_box(&def, "below", XYZ(0.2, 0.2, -0.42), XYZ(0.8, 0.8, -0.02)), 0, 0, 1.5);
    brunt_pair_def *none = &def.contact.pairs[def.contact.pair_count++];
    *none = (brunt_pair_def){.a = "above", .b = "below", .method = BRUNT_CONTACT_NONE};
    brunt_world *world = world_take(&def);
    const int m = body_named(world, "m"), a = body_named(world, "above"), b = body_named(world, "below");
    double over = INFINITY, under = -INFINITY, least, most;
    for (int k = 0; k < 40; k++) {
        world_until(world, 0.01 * (k + 1));
        heights(world, m, a, &least, &most), over = fmin(over, least);
        heights(world, m, b, &least, &most), under = fmax(under, most);
    }
    brunt_energy e = world_energy(world);
    brunt_momentum p = world_momentum(world);
    brunt_body_sums up = world_sums(world, a), down = world_sums(world, b);
    printf("particles: above from %.4f, below to %.4f (spacing %.3f), apart at %.2f, %.2f m/s, E %.4f, error %.1e, "
           "drift %.1e "
           "%.1e\n",
           over, under, cell / 2, up.velocity[2], down.velocity[2], stored(&e) / e.initial, e.error_relative,
           p.linear_drift, p.angular_drift);
    ck_assert_double_gt(over, 0.5 * (THICK / 2 + cell / 4));
    ck_assert_double_lt(under, -0.5 * (THICK / 2 + cell / 4));
    ck_assert_double_gt(up.velocity[2], 0.3);
    ck_assert_double_lt(down.velocity[2], -0.3);
    ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(fabs(e.error_relative), 0.02);
    brunt_world_destroy(world);
}
END_TEST

// A fast ball of particles on a clamped membrane, or a held plate, of a quarter of a cell.
START_TEST(thin_targets_are_not_passed) {
    const bool plate = _i;
    const double cell = 0.1;
    brunt_world_def def = begin(cell, 0.2);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    if (plate)
        mesh_box(&def, "m", XYZ(0, 0, -0.025), XYZ(1, 1, 0), 0.1);
    else
        sheet(&def, "m", 12, 12, flat, false)->thickness = 0.25 * cell;
    hold(&def, "m", plate ? "xmin" : "border");
    if (plate) hold(&def, "m", "xmax");
    brunt_body_def *ball = def_ball(&def, "ball", XYZ(0.5, 0.5, 0.27), 0.2);
    def_velocity(ball, 0, 0, -8);
    brunt_world *world = world_take(&def);
    const int m = body_named(world, "m"), b = body_named(world, "ball");
    double nearest = INFINITY, least, most = 0;
    for (int k = 0; k < 40; k++) {
        world_until(world, 0.003 * (k + 1));
        if (!plate) {
            heights(world, m, b, &least, &most);
            nearest = fmin(nearest, least);
        }
    }
    brunt_momentum p = world_momentum(world);
    brunt_energy e = world_energy(world);
    brunt_body_sums s = world_sums(world, b);
    printf("ball on %s: nearest %.4f (spacing %.3f), leaves at %.2f m/s, E %.3f, error %.1e, drift %.1e\n",
           plate ? "plate" : "membrane", nearest, cell / 2, s.velocity[2], stored(&e) / e.initial, e.error_relative,
           p.linear_drift);
    ck_assert_double_gt(nearest, 0.5 * cell / 4);
    ck_assert_double_gt(s.velocity[2], 0);
    ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// A soft block of particles, or a hexahedral one, thrown into a corner of a closed box of membranes that are held:
// three walls bear at once.
START_TEST(into_a_corner) {
    const bool particles = !_i;
    brunt_world_def def = begin(0.1, 0);
    def_material(&def, "neo-hookean", 1000, 2e4, 0.3);
    brunt_body_def *m = def_box(&def, "m", XYZ(0, 0, 0), XYZ(1, 1, 1));
    m->method = BRUNT_MEMBRANE, m->element = BRUNT_MEMBRANE_QUAD4, m->size = 0.125, m->thickness = THICK / 4;
    hold(&def, "m", "surface");
    const double low[3] = {0.2, 0.22, 0.24}, high[3] = {0.7, 0.72, 0.74};
    brunt_body_def *b = particles ? def_box(&def, "b", low, high) : mesh_box(&def, "b", low, high, 0.125);
    def_velocity(b, -3, -2.9, -2.8);
    def.contact.allow_overlap = true;
    brunt_world *world = world_take(&def);
    const int body = body_named(world, "b");
    double out = 0;
    for (int k = 0; k < 40; k++) {
        world_until(world, 0.01 * (k + 1));
        double(*x)[3] = (void *)world_field(world, body, "position");
        for (int64_t i = 0; i < brunt_body_nodes(world, body) + brunt_body_particles(world, body); i++)
            for (int a = 0; a < 3; a++) out = fmax(out, fmax(-x[i][a], x[i][a] - 1));
        free(x);
    }
    brunt_momentum p = world_momentum(world);
    brunt_energy e = world_energy(world);
    brunt_body_sums s = world_sums(world, body);
    printf("corner, %s: %.4f m outside, leaves at %.2f %.2f %.2f m/s, E %.3f, error %.1e, drift %.1e\n",
           particles ? "particles" : "hexahedra", out, s.velocity[0], s.velocity[1], s.velocity[2],
           stored(&e) / e.initial, e.error_relative, p.linear_drift);
    ck_assert_double_le(out, particles ? 0 : 0.02 * 0.125);
    for (int a = 0; a < 3; a++) ck_assert_double_gt(s.velocity[a], 0.5);
    ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// Plates thinner than contact looks, each of one element, on both sides of a membrane: their far faces look the same
// way as what is on the other side, and must not be taken for it.
START_TEST(between_thin_plates) {
    brunt_world_def def = begin(1, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    sheet(&def, "m", 8, 8, wide, false);
    const double h = 0.03, gap = 0.012 + 0.01;
    def_velocity(mesh_box(&def, "above", XYZ(0.03, 0.01, gap), XYZ(1.03, 1.01, gap + h), 0.25), 0, 0, -0.5);
    def_velocity(mesh_box(&def, "below", XYZ(0, 0, -gap - h), XYZ(1, 1, -gap), 0.25), 0, 0, 0.5);
    brunt_world *world = world_take(&def);
    const int m = body_named(world, "m"), a = body_named(world, "above"), b = body_named(world, "below");
    double over = INFINITY, under = -INFINITY, least, most, top = 0;
    for (int k = 0; k < 60; k++) {
        world_until(world, 0.004 * (k + 1));
        heights(world, m, a, &least, &most), over = fmin(over, least);
        heights(world, m, b, &least, &most), under = fmax(under, most);
        brunt_energy e = world_energy(world);
        top = fmax(top, stored(&e) / e.initial);
    }
    brunt_momentum p = world_momentum(world);
    brunt_body_sums up = world_sums(world, a), down = world_sums(world, b);
    printf("thin plates: upper from %.4f, lower to %.4f, apart at %.3f, %.3f m/s, most %.6f, drift %.1e\n", over, under,
           up.velocity[2], down.velocity[2], top, p.linear_drift);
    ck_assert_double_gt(over, 0.8 * THICK / 2);
    ck_assert_double_lt(under, -0.8 * THICK / 2);
    ck_assert_double_gt(up.velocity[2], 0.05);
    ck_assert_double_lt(down.velocity[2], -0.05);
    ck_assert_double_lt(top, 1 + 1e-4);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ sheets and sheets

static void strip_x(double s, double t, double x[3]) { x[0] = 2 * s - 1, x[1] = 0.4 * t - 0.2, x[2] = 0; }
static void strip_y(double s, double t, double x[3]) { x[0] = 0.43 * t - 0.21, x[1] = 2 * s - 1, x[2] = 0.06; }

// Two strips that cross, the upper one thrown at the lower one, both held at their ends.
START_TEST(crossing_strips) {
    brunt_world_def def = begin(1, 0.2);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    sheet(&def, "lower", 16, 4, strip_x, false);
    def_velocity(sheet(&def, "upper", 16, 4, strip_y, _i & 1), 0, 0, -4);
    for (int b = 0; b < 2; b++)
        for (int k = 0; k < 2; k++) hold(&def, b ? "upper" : "lower", k ? "left" : "right");
    brunt_world *world = world_take(&def);
    const int low = body_named(world, "lower"), up = body_named(world, "upper");
    double nearest = INFINITY, least, most, top = 0;
    for (int k = 0; k < 60; k++) {
        world_until(world, 0.005 * (k + 1));
        heights(world, low, up, &least, &most);
        nearest = fmin(nearest, least);
        brunt_energy e = world_energy(world);
        top = fmax(top, stored(&e) / e.initial);
    }
    brunt_momentum p = world_momentum(world);
    brunt_energy e = world_energy(world);
    brunt_reaction f = world_pair(world, 0);
    printf("strips: nearest %.4f of %.3f, impulse %.2f N s, most %.6f, error %.1e, drift %.1e %.1e\n", nearest, THICK,
           f.impulse[2], top, e.error_relative, p.linear_drift, p.angular_drift);
    ck_assert_double_gt(nearest, 0.8 * THICK);
    ck_assert_double_gt(f.impulse[2], 5);
    ck_assert_double_lt(top, 1 + 1e-3);
    ck_assert_double_lt(fabs(e.error_relative), 0.01);
    ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

static void patch(double s, double t, double x[3]) { x[0] = 0.33 + 0.4 * s, x[1] = 0.28 + 0.4 * t, x[2] = 0.03; }

// A patch that comes to rest on a clamped membrane: a thickness above it, and its weight on it.
START_TEST(a_patch_rests) {
    brunt_world_def def = begin(1, 0.5);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    sheet(&def, "m", 8, 8, flat, false)->damping = 10;
    hold(&def, "m", "border");
    sheet(&def, "patch", 5, 5, patch, _i & 1)->damping = 10;
    def.gravity[2] = -10;
    brunt_world *world = world_take(&def);
    const int m = body_named(world, "m"), p = body_named(world, "patch");
    double nearest = INFINITY, least, most;
    for (int k = 0; k < 20; k++) {
        world_until(world, 0.05 * (k + 1));
        heights(world, m, p, &least, &most);
        nearest = fmin(nearest, least);
    }
    const double before = world_pair(world, 0).impulse[2], from = world_sums(world, p).momentum[2];
    world_until(world, 2);
    heights(world, m, p, &least, &most);
    // The air that damps it takes what moves; at rest nothing.
    double mean = fabs(world_pair(world, 0).impulse[2] - before) / 1.0, weight = 10 * world_sums(world, p).mass;
    double changed = fabs(world_sums(world, p).momentum[2] - from);
    printf("patch: nearest %.4f of %.3f, rests %.4f to %.4f above, force %.3f of %.3f N\n", nearest, THICK, least, most,
           mean, weight);
    ck_assert_double_gt(nearest, 0.8 * THICK);
    ck_assert_double_gt(least, 0.9 * THICK);
    ck_assert_double_lt(most, 1.3 * THICK);
    ck_assert_double_eq_tol(mean, weight, 0.05 * weight + changed);
    brunt_world_destroy(world);
}
END_TEST

// A strip folded over on itself: half of it on the plane z = 0, a half circle, the rest above.
static const double ABOVE = 0.15;
static void folded(double s, double t, double x[3]) {
    const double turn = PI * ABOVE / 2, length = 2 + turn, along = s * length;
    x[1] = 0.5 * t;
    if (along < 1) {
        x[0] = along, x[2] = 0;
    } else if (along > 1 + turn) {
        x[0] = 2 + turn - along, x[2] = ABOVE;
    } else {
        double angle = (along - 1) / turn * PI;
        x[0] = 1 + ABOVE / 2 * sin(angle), x[2] = ABOVE / 2 * (1 - cos(angle));
    }
}

// What a body does to itself adds up to nothing, whatever the area of it. Returns that.
static double checked_self_force(const brunt_world *world) {
    brunt_reaction force;
    brunt_pair_force(world, 0, &force);
    ck_assert_str_eq(force.name, "m-m");
    for (int k = 0; k < 3; k++) ck_assert(force.force[k] == 0 && force.impulse[k] == 0);
    return force.area;
}

static double fold(bool self, bool turned, double *error, double *drift, double *most_energy) {
    brunt_world_def def = begin(1, 0.3);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    sheet(&def, "m", 24, 6, folded, turned)->damping = 2;
    hold(&def, "m", "low");
    def.gravity[2] = -20;
    if (self) meets_itself(&def, "m");
    brunt_world *world = world_take(&def);
    double lowest = INFINITY, touched = 0;
    *most_energy = 0;
    for (int k = 0; k < 60; k++) {
        world_until(world, 0.005 * (k + 1));
        if (self) touched = fmax(touched, checked_self_force(world));
        double(*x)[3] = (void *)world_field(world, 0, "position");
        for (int64_t i = 0; i < brunt_body_nodes(world, 0); i++)
            if (2 * (i / 7) >= 24 + 4) lowest = fmin(lowest, x[i][2]); // past the edge of what is held, by two elements
        free(x);
        brunt_energy e = world_energy(world);
        *most_energy = fmax(*most_energy, stored(&e) - e.external_work);
    }
    brunt_energy e = world_energy(world);
    brunt_momentum p = world_momentum(world);
    *error = e.error_relative, *drift = p.linear_drift;
    // Layers of 0.5 that lie on each other over less than 1.
    ck_assert_msg(!self || (touched > 0.05 && touched < 0.5), "%g m^2 touched", touched);
    brunt_world_destroy(world);
    return lowest;
}

START_TEST(a_strip_folds_on_itself) {
    double error, drift, energy, without = fold(false, false, &error, &drift, &energy);
    for (int turned = 0; turned < 2; turned++) {
        double with = fold(true, turned, &error, &drift, &energy);
        printf("fold: lowest of the upper layer %.4f with self-contact (thickness %.3f), %.4f without; error %.1e, "
               "drift %.1e, "
               "energy made %.1e\n",
               with, THICK, without, error, drift, energy);
        hard_case("C21", 1 - with / THICK, 1, 0.5, "%s",
                  turned ? "strip folded, turned over: depth [thicknesses]" : "strip folded: depth [thicknesses]");
        ck_assert_double_lt(fabs(error), 0.01);
        ck_assert_double_lt(drift, 10 * ROUNDING);
    }
    ck_assert_double_lt(without, -0.05);
}
END_TEST

// Folded twice, three layers that are all nearer to each other than contact looks: each layer meets its neighbours, and
// is not hidden from one by the other.
static void zigzag(double s, double t, double x[3]) {
    const double gap = 0.05, turn = PI * gap / 2, along = s * (3 + 2 * turn);
    const double start[5] = {0, 1, 1 + turn, 2 + turn, 2 + 2 * turn};
    x[1] = 0.5 * t;
    if (along < start[1]) {
        x[0] = along, x[2] = 0;
    } else if (along < start[2]) {
        double angle = (along - start[1]) / turn * PI;
        x[0] = 1 + gap / 2 * sin(angle), x[2] = gap / 2 * (1 - cos(angle));
    } else if (along < start[3]) {
        x[0] = 1 - (along - start[2]), x[2] = gap;
    } else if (along < start[4]) {
        double angle = (along - start[3]) / turn * PI;
        x[0] = -gap / 2 * sin(angle), x[2] = gap + gap / 2 * (1 - cos(angle));
    } else {
        x[0] = along - start[4], x[2] = 2 * gap;
    }
}

// Greatest depth of any place of a layer below one it began above, where both are flat, by columns of equal x.
START_TEST(three_layers) {
    double worst[2];
    for (int self = 0; self < 2; self++) {
        brunt_world_def def = begin(1, 0.2);
        def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
        enum { N = 42, M = 6 };
        sheet(&def, "m", N, M, zigzag, false)->damping = 2;
        def.gravity[2] = -10;
        def_plane(&def, XYZ(0, 0, -THICK / 2), XYZ(0, 0, 1), BRUNT_SEPARATE, 0.3);
        if (self) meets_itself(&def, "m");
        brunt_world *world = world_take(&def);
        worst[self] = INFINITY;
        for (int k = 0; k < 30; k++) {
            world_until(world, 0.01 * (k + 1));
            double(*x)[3] = (void *)world_field(world, 0, "position");
            for (int i = 0; i <= N; i++)
                for (int j = 0; j <= N; j++) {
                    // Nodes of a layer over elements of the one below it, away from the bends; M / 2: in the middle.
                    const int layer = i * 3 / (N + 1), under = j * 3 / (N + 1), in = i % (N / 3), un = j % (N / 3);
                    if (under != layer - 1 || in < 3 || in > N / 3 - 4 || un < 3 || un > N / 3 - 4) continue;
                    const double *p = x[i * (M + 1) + M / 2], *a = x[j * (M + 1) + M / 2],
                                 *b = x[(j + 1) * (M + 1) + M / 2];
                    double u = (p[0] - a[0]) / (b[0] - a[0]);
                    if (u >= 0 && u <= 1) worst[self] = fmin(worst[self], p[2] - a[2] - u * (b[2] - a[2]));
                }
            free(x);
        }
        brunt_energy e = world_energy(world);
        brunt_momentum p = world_momentum(world);
        printf("three layers, self-contact %s: nearest %.4f of %.3f, error %.1e, drift %.1e\n", self ? "on" : "off",
               worst[self], THICK, e.error_relative, p.linear_drift);
        ck_assert_double_lt(fabs(e.error_relative), 0.01);
        ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
        brunt_world_destroy(world);
    }
    hard_case("C21", 1 - worst[1] / THICK, 1, 0.3, "three layers: depth [thicknesses]");
    ck_assert_double_lt(worst[0], 0.01 * THICK);
}
END_TEST

// A fold of 60 degrees that closes, as thick in contact as its first elements are near each other: those are
// neighbours, and no obstacle to each other; the next are further away than that.
static void sharp(double s, double t, double x[3]) {
    const double along = s < 0.5 ? 0.5 - s : s - 0.5, angle = s < 0.5 ? 0 : PI / 3;
    x[0] = along * cos(angle), x[1] = 0.5 * t, x[2] = along * sin(angle);
}

static uint64_t swing(bool self) {
    brunt_world_def def = begin(1, 0.2);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *m = sheet(&def, "m", 10, 5, sharp, false);
    m->contact_thickness = 0.93 * 0.1;
    m->wave_velocity[2] = -0.1, m->wave_vector[2] = 3;
    def.step = 2e-4;
    if (self) meets_itself(&def, "m");
    brunt_world *world = world_take(&def);
    world_steps(world, 100);
    uint64_t hash = brunt_world_hash(world);
    brunt_world_destroy(world);
    return hash;
}

START_TEST(neighbours_do_not_meet) { ck_assert_uint_eq(swing(true), swing(false)); }
END_TEST

// A strip pushed together from its ends until it lies in folds: it has no stiffness in bending and folds as finely as
// its elements let it. Energies stay bounded by the work done.
static void wavy(double s, double t, double x[3]) { x[0] = 2 * s - 1, x[1] = 0.3 * t, x[2] = 0.02 * sin(6 * PI * s); }
START_TEST(a_buckled_strip) {
    brunt_world_def def = begin(1, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *m = sheet(&def, "m", 40, 4, wavy, false);
    m->damping = 20, m->tension_only = true;
    for (int k = 0; k < 2; k++) {
        brunt_group_def *g = hold(&def, "m", k ? "right" : "left");
        g->action = BRUNT_GROUP_VELOCITY, g->value[0] = k ? -1.5 : 1.5;
    }
    meets_itself(&def, "m");
    brunt_world *world = world_take(&def);
    double top = 0;
    for (int k = 0; k < 40; k++) {
        world_until(world, 0.0125 * (k + 1));
        brunt_energy e = world_energy(world);
        top = fmax(top, stored(&e) / (fabs(e.external_work) + 1e-3));
    }
    brunt_energy e = world_energy(world);
    brunt_reaction f = world_pair(world, 0);
    printf("buckled: energy over work at most %.3f, error %.1e, contact took %.3e J of %.3e J\n", top, e.error_relative,
           e.contact + e.friction, e.external_work);
    hard_case("C21", top, 1, 1.05, "strip buckled from its ends: energy, of the work");
    hard_case("C21", fabs(e.error_relative), 0.02, 0.02, "strip buckled from its ends: error of the energy");
    ck_assert(isfinite(f.impulse[2]));
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ planes

START_TEST(on_a_plane) {
    const bool turned = _i & 1;
    brunt_world_def def = begin(1, 0);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *m = sheet(&def, "m", 6, 6, flat, turned);
    m->place = brunt_placement_rotate(m->place, XYZ(1, 0, 0), 0.1, XYZ(0, 0, 0));
    m->place = brunt_placement_translate(m->place, XYZ(0, 0, 0.05));
    m->damping = 2;
    def_plane(&def, XYZ(0, 0, 0), XYZ(0, 0, 1), BRUNT_SEPARATE, 0.3);
    def.gravity[2] = -10;
    brunt_world *world = world_take(&def);
    double lowest = INFINITY;
    for (int k = 0; k < 50; k++) {
        world_until(world, 0.02 * (k + 1));
        double(*x)[3] = (void *)world_field(world, 0, "position");
        for (int64_t i = 0; i < brunt_body_nodes(world, 0); i++) lowest = fmin(lowest, x[i][2]);
        free(x);
    }
    double weight = 10 * world_sums(world, 0).mass, height = world_sums(world, 0).centre[2];
    double before = world_boundary(world, 0).impulse[2];
    world_until(world, 2);
    double mean = (world_boundary(world, 0).impulse[2] - before) / 1.0;
    brunt_momentum p = world_momentum(world);
    printf("on a plane%s: lowest %.5f, rests at %.5f (half thickness %.3f), force %.4f of %.4f N, drift %.1e\n",
           turned ? ", turned" : "", lowest, height, THICK / 2, mean, weight, p.linear_drift);
    ck_assert_double_gt(lowest, 0.9 * THICK / 2);
    ck_assert_double_eq_tol(height, THICK / 2, 0.2 * THICK / 2);
    ck_assert_double_eq_tol(mean / weight, 1, 0.02);
    ck_assert_double_lt(p.linear_drift, 10 * ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what is not touched

static void far_away(double s, double t, double x[3]) { x[0] = s + 0.4, x[1] = t, x[2] = 0.9; }

static double *bystander(bool contact, int64_t *count) {
    brunt_world_def def = begin(1, 0.3);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    if (!contact) def.contact.method = BRUNT_CONTACT_NONE;
    sheet(&def, "a", 8, 8, flat, false);
    hold(&def, "a", "border");
    brunt_body_def *c = sheet(&def, "c", 8, 8, far_away, false);
    c->wave_velocity[0] = 1, c->wave_vector[0] = 3;
    def_velocity(mesh_box(&def, "b", XYZ(0.3, 0.3, 0.05), XYZ(0.7, 0.7, 0.45), 0.2), 0, 0, -2);
    def.step = 2e-4; // which contact would change
    brunt_world *world = world_take(&def);
    world_steps(world, 300);
    *count = 6 * brunt_body_nodes(world, 2);
    double *both = malloc((size_t)*count * sizeof *both), *v = world_field(world, 2, "velocity"),
           *x = world_field(world, 2, "position");
    memcpy(both, v, (size_t)*count / 2 * sizeof *v), memcpy(both + *count / 2, x, (size_t)*count / 2 * sizeof *x);
    free(v), free(x);
    if (contact) ck_assert_double_gt(fabs(world_pair(world, 0).impulse[2]), 1e-3);
    brunt_world_destroy(world);
    return both;
}

START_TEST(untouched_membranes_keep_every_bit) {
    int64_t n;
    double *with = bystander(true, &n), *without = bystander(false, &n);
    ck_assert(!memcmp(with, without, (size_t)n * sizeof *with));
    free(with), free(without);
}
END_TEST

// ------------------------------------------------------------------------------------------ threads and restart

static brunt_world_def busy(int kind) {
    brunt_world_def def = begin(0.2, 0.3);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    if (kind) {
        sheet(&def, "m", 24, 6, folded, false);
        hold(&def, "m", "low");
        def.gravity[2] = -200;
        meets_itself(&def, "m");
        return def;
    }
    sheet(&def, "m", 16, 16, wide, false);
    def_velocity(mesh_box(&def, "above", XYZ(0.03, 0.01, 0.015), XYZ(1.03, 1.01, 0.515), 0.1), 0.2, 0, -4);
    def_velocity(def_box(&def, "below", XYZ(0, 0, -0.42), XYZ(1, 1, -0.02)), 0, 0.1, 4);
    return def;
}

static uint64_t run(int kind, int threads, bool restart) {
    const int half = kind ? 300 : 60;
    brunt_world_def def = busy(kind);
    def.threads = threads;
    brunt_world *world = world_from(&def);
    world_steps(world, half);
    if (restart) {
        brunt_world *other = world_from(&def);
        world_copy_state(world, other);
        brunt_world_destroy(world);
        world = other;
    }
    brunt_world_def_free(&def);
    world_steps(world, half);
    brunt_energy e = world_energy(world);
    ck_assert_double_gt(e.contact + e.friction, 0);
    uint64_t hash = brunt_world_hash(world);
    brunt_world_destroy(world);
    return hash;
}

START_TEST(same_bits_for_threads_and_restart) {
    const uint64_t one = run(_i, 1, false);
    ck_assert_uint_eq(run(_i, 2, false), one);
    ck_assert_uint_eq(run(_i, 3, false), one);
    ck_assert_uint_eq(run(_i, 1, true), one);
    ck_assert_uint_eq(run(_i, 2, true), one);
}
END_TEST

START_TEST(no_allocation_in_a_step) {
    brunt_world_def def = busy(0);
    brunt_world *world = world_take(&def);
    world_steps(world, 80);
    int64_t before = brunt_memory_calls();
    world_steps(world, 20);
    ck_assert_int_le(brunt_memory_calls() - before, 2);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what is refused, what is
// said

static void expect_refusal(brunt_world_def *def, const char *text) {
    brunt_error error = {0};
    ck_assert_ptr_null(brunt_world_create(def, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_msg(strstr(error.message, text) != NULL, "%s", error.message);
    brunt_world_def_free(def);
}

START_TEST(refusals) {
    static const brunt_augury_form forms[] = {BRUNT_AUGURY_AVERAGED_FACETS, BRUNT_AUGURY_AVERAGED_SURFACE,
                                              BRUNT_AUGURY_PUBLISHED};
    size_t live = brunt_memory_live();
    for (int f = 0; f < 3; f++) {
        brunt_world_def def = busy(0);
        def.contact.form = forms[f];
        expect_refusal(&def, "node_to_facet");
    }
    brunt_world_def def = busy(0);
    meets_itself(&def, "above");
    expect_refusal(&def, "no membrane");
    def = busy(1);
    meets_itself(&def, "m");
    expect_refusal(&def, "twice");
    def = busy(1);
    meets_itself(&def, "absent");
    expect_refusal(&def, "absent");
    ck_assert_uint_eq(brunt_memory_live(), live);
}
END_TEST

static bool warns(const brunt_world *world, const char *text) {
    for (int w = 0; w < brunt_warning_count(world); w++)
        if (strstr(brunt_world_warning(world, w), text)) return true;
    return false;
}

START_TEST(warnings) {
    brunt_world_def def = busy(0);
    brunt_world *world = world_from(&def);
    for (int w = 0; w < brunt_warning_count(world); w++) puts(brunt_world_warning(world, w));
    ck_assert(!warns(world, "pass between") && !warns(world, "thickness"));
    brunt_world_destroy(world);
    def.bodies[2].spacing = 0.2;
    world = world_take(&def);
    ck_assert(warns(world, "pass between"));
    brunt_world_destroy(world);
    def = busy(1);
    def.bodies[0].thickness = 0.12;
    world = world_take(&def);
    ck_assert(warns(world, "thickness"));
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    Suite *suite = suite_create("sheet contact");
    ADD_LOOP(between_two_blocks, 2);
    ADD(both_sides_are_alike);
    ADD(particles_on_either_side);
    ADD_LOOP(thin_targets_are_not_passed, 2);
    ADD_LOOP(into_a_corner, 2);
    ADD(between_thin_plates);
    ADD_LOOP(crossing_strips, 2);
    ADD_LOOP(a_patch_rests, 2);
    ADD(a_strip_folds_on_itself);
    ADD(three_layers);
    ADD(neighbours_do_not_meet);
    ADD(a_buckled_strip);
    ADD_LOOP(on_a_plane, 2);
    ADD(untouched_membranes_keep_every_bit);
    ADD_LOOP(same_bits_for_threads_and_restart, 2);
    ADD(no_allocation_in_a_step);
    ADD(refusals);
    ADD(warnings);
    return suite_main(suite);
}
