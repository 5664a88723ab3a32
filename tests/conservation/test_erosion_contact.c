// Labels: stability
// Contact of meshes that lose elements: no force where one goes, none gets through what is left, momenta and energy are
// kept, loose nodes meet others, the surface follows from the elements there are. Elements are taken out by hand,
// through the marks that failure and strain set.
#include "tests/support/hard_case.h"
#include "tests/support/hard_world.h"
#include "world/world.h"

static double random_number(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

// ------------------------------------------------------------------------------------------ worlds

static brunt_body_def *mesh_box(brunt_world_def *def, const char *name, const double low[3], const double high[3],
                                brunt_element_kind kind, double size, bool keep) {
    brunt_body_def *b = def_box(def, name, low, high);
    b->method = BRUNT_FEM, b->element = kind, b->size = size;
    b->erosion.strain = 100; // it may lose elements; which ones, the tests say
    b->erosion.keep = keep;
    return b;
}

static brunt_world_def begin(int dimension, double friction) {
    brunt_world_def def = def_begin(dimension, 1);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def.contact.friction = friction;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_material(&def, "neo-hookean", 8000, 1e7, 0.3);
    return def;
}

static const double wave_speed = 36.7; // of the first material

static void middle_of(const brunt_fem_body *fem, int32_t slot, double x[3]) {
    const int n = fem->traits->nodes;
    for (int a = 0; a < 3; a++) {
        x[a] = 0;
        for (int c = 0; c < n; c++)
            x[a] += (double)brunt_fem_node(fem, fem->element_node[(int64_t)slot * n + c])[a] / n;
    }
}

static int32_t element_at(const brunt_fem_body *fem, const double x[3]) {
    int32_t best = -1;
    double least = INFINITY;
    for (int32_t s = 0; s < fem->slots; s++) {
        double m[3], square = 0;
        if (fem->element_id[s] < 0) continue;
        middle_of(fem, s, m);
        for (int a = 0; a < 3; a++) square += (m[a] - x[a]) * (m[a] - x[a]);
        if (square < least) least = square, best = s;
    }
    return best;
}

static void mark(brunt_fem_body *fem, int32_t slot) {
    if (fem->mark[slot] != BRUNT_MARK_NONE) return;
    int32_t b = 0;
    while (b + 1 < fem->block_count && fem->block[b + 1].first <= slot) b++;
    fem->mark[slot] = BRUNT_MARK_STRAINED;
    fem->report[b].marked++;
}

static void erode(brunt_world *world) {
    brunt_error error = {0};
    ck_assert_msg(brunt_erode_marked(world, world->clock.dt, &error) == BRUNT_OK, "%s", error.message);
}

// Velocities are those of the middle of a step, stress of its end: `transfer` has what stress does to them between.
static double stored(const brunt_energy *e) { return e->kinetic + e->internal + e->hourglass + e->transfer; }

// ------------------------------------------------------------------------------------------ what lies inside

static const int hex_face[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

static bool in_tet(const double *const p[4], const double x[3]) {
    double a[3][3], r[3];
    for (int k = 0; k < 3; k++) {
        r[k] = x[k] - p[0][k];
        for (int i = 0; i < 3; i++) a[i][k] = p[i + 1][k] - p[0][k];
    }
#define DET(u, v, w)                                                                                                   \
    ((u)[0] * ((v)[1] * (w)[2] - (v)[2] * (w)[1]) - (u)[1] * ((v)[0] * (w)[2] - (v)[2] * (w)[0]) +                     \
     (u)[2] * ((v)[0] * (w)[1] - (v)[1] * (w)[0]))
    const double d = DET(a[0], a[1], a[2]), u = DET(r, a[1], a[2]) / d, v = DET(a[0], r, a[2]) / d,
                 w = DET(a[0], a[1], r) / d;
    return u > 0 && v > 0 && w > 0 && u + v + w < 1;
}

// Most points are not in the box of its nodes, which holds all of it.
static bool in_element(const brunt_fem_body *fem, int32_t slot, const double x[3]) {
    const int n = fem->traits->nodes;
    const int32_t *node = fem->element_node + (int64_t)slot * n;
    double p[8][3], centre[3] = {0};
    for (int a = 0; a < fem->dim; a++) {
        bool below = false, above = false;
        for (int c = 0; c < n; c++) {
            p[c][a] = (double)brunt_fem_node(fem, node[c])[a];
            below = below || p[c][a] <= x[a], above = above || p[c][a] >= x[a];
            centre[a] += p[c][a] / n;
        }
        if (!below || !above) return false;
    }
    if (fem->dim == 2) {
        for (int c = 0; c < n; c++) {
            const double *u = p[c], *v = p[(c + 1) % n];
            if ((v[0] - u[0]) * (x[1] - u[1]) - (v[1] - u[1]) * (x[0] - u[0]) <= 0) return false;
        }
        return true;
    }
    if (n == 4) return in_tet((const double *const[4]){p[0], p[1], p[2], p[3]}, x);
    for (int f = 0; f < 6; f++) { // 24 tetrahedra between the centre and the triangles of the faces
        double middle[3] = {0};
        for (int c = 0; c < 4; c++)
            for (int a = 0; a < 3; a++) middle[a] += p[hex_face[f][c]][a] / 4;
        for (int c = 0; c < 4; c++)
            if (in_tet((const double *const[4]){centre, middle, p[hex_face[f][c]], p[hex_face[f][(c + 1) % 4]]}, x))
                return true;
    }
    return false;
}

static double segment_distance(const double a[3], const double b[3], const double x[3]) {
    double ab = 0, ax = 0, square = 0;
    for (int k = 0; k < 3; k++) ab += (b[k] - a[k]) * (b[k] - a[k]), ax += (b[k] - a[k]) * (x[k] - a[k]);
    const double t = fmin(1, fmax(0, ax / ab));
    for (int k = 0; k < 3; k++) square += pow(x[k] - a[k] - t * (b[k] - a[k]), 2);
    return sqrt(square);
}

static double triangle_distance(const double a[3], const double b[3], const double c[3], const double x[3]) {
    double e[3], g[3], r[3], n[3], nn = 0, rn = 0;
    for (int k = 0; k < 3; k++) e[k] = b[k] - a[k], g[k] = c[k] - a[k], r[k] = x[k] - a[k];
    for (int k = 0; k < 3; k++) n[k] = e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3];
    for (int k = 0; k < 3; k++) nn += n[k] * n[k], rn += r[k] * n[k];
    double u = 0, v = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, l = (k + 2) % 3;
        u += (r[i] * g[l] - r[l] * g[i]) * n[k] / nn, v += (e[i] * r[l] - e[l] * r[i]) * n[k] / nn;
    }
    if (u >= 0 && v >= 0 && u + v <= 1) return fabs(rn) / sqrt(nn);
    return fmin(segment_distance(a, b, x), fmin(segment_distance(b, c, x), segment_distance(c, a, x)));
}

// To the surface that body k has now, found from its elements alone.
static double surface_distance(const brunt_fem_body *fem, const brunt_faces *faces, const double x[3]) {
    double least = INFINITY;
    for (int32_t f = 0; f < faces->count; f++) {
        double p[4][3], middle[3] = {0};
        int n = 0;
        for (; n < 4 && faces->node[f][n] >= 0; n++)
            for (int a = 0; a < 3; a++) p[n][a] = (double)brunt_fem_node(fem, faces->node[f][n])[a];
        for (int c = 0; c < n; c++)
            for (int a = 0; a < 3; a++) middle[a] += p[c][a] / n;
        if (n == 2) least = fmin(least, segment_distance(p[0], p[1], x));
        if (n == 3) least = fmin(least, triangle_distance(p[0], p[1], p[2], x));
        for (int c = 0; n == 4 && c < 4; c++) least = fmin(least, triangle_distance(p[c], p[(c + 1) % 4], middle, x));
    }
    return least;
}

// Greatest depth of a node that has elements in the live elements of the other body [m]; how many are deeper than
// `limit`.
static double deepest_node(const brunt_world *world, double limit, int *count) {
    double deepest = 0;
    *count = 0;
    for (int k = 0; k < 2; k++) {
        const brunt_fem_body *me = &world->bodies.fem[k], *other = &world->bodies.fem[!k];
        brunt_faces faces;
        ck_assert_int_eq(brunt_fem_faces(other, &faces, NULL), 0);
        for (int32_t n = 0; n < me->node_count; n++) {
            const real *at = brunt_fem_node(me, n);
            const double x[3] = {(double)at[0], (double)at[1], (double)at[2]};
            if (brunt_fem_removed(me, n)) continue;
            for (int32_t s = 0; s < other->slots; s++) {
                if (other->element_id[s] < 0 || !in_element(other, s, x)) continue;
                const double depth = surface_distance(other, &faces, x);
                deepest = fmax(deepest, depth);
                *count += depth > limit;
                break;
            }
        }
        brunt_faces_free(&faces);
    }
    return deepest;
}

// ------------------------------------------------------------------------------------------ the surface

static const brunt_element_kind kinds[] = {BRUNT_QUAD4, BRUNT_TRI3, BRUNT_HEX8, BRUNT_TET4};
static double deep(brunt_element_kind kind) { return brunt_element_dimension(kind) == 3; }

static int by_nodes(const void *a, const void *b) { return memcmp(a, b, 4 * sizeof(int32_t)); }

// Faces of the skin's body k as sorted numbers of the body's nodes.
static int32_t (*surface_faces(const brunt_contact_surface *s, int k))[4] {
    const int32_t count = s->face_end[k] - s->face_range[k];
    int32_t(*list)[4] = malloc(((size_t)count + 1) * sizeof *list);
    for (int32_t f = 0; f < count; f++)
        for (int c = 0; c < 4; c++) {
            const int32_t n = s->face[s->face_range[k] + f][c];
            list[f][c] = n < 0 ? -1 : s->node[n];
        }
    qsort(list, (size_t)count, sizeof *list, by_nodes);
    return list;
}

// After each erosion the skin has the faces that brunt_fem_faces finds and their nodes, in ascending order, with all
// links.
START_TEST(surface_is_that_of_the_elements) {
    const brunt_element_kind kind = kinds[_i];
    const double z = deep(kind), h = 0.2;
    brunt_world_def def = begin(brunt_element_dimension(kind), 0);
    mesh_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 1, z), kind, h, true);
    mesh_box(&def, "b", XYZ(0, 1.01, 0), XYZ(1, 1.6, z), kind, h, false);
    brunt_world *world = world_take(&def);
    world_steps(world, 2);
    uint64_t seed = 7;
    for (int round = 0; round < 12; round++) {
        for (int k = 0; k < 2; k++)
            for (int32_t s = 0; s < world->bodies.fem[k].slots; s++)
                if (world->bodies.fem[k].element_id[s] >= 0 && random_number(&seed) < (round == 11 ? 2 : 0.15))
                    mark(&world->bodies.fem[k], s);
        erode(world);
        const brunt_contact_surface *s = &world->contact.surface;
        for (int k = 0; k < 2; k++) {
            const brunt_fem_body *fem = &world->bodies.fem[k];
            brunt_faces faces;
            ck_assert_int_eq(brunt_fem_faces(fem, &faces, NULL), 0);
            ck_assert_int_eq(faces.count, s->face_end[k] - s->face_range[k]);
            int32_t(*list)[4] = surface_faces(s, k);
            qsort(faces.node, (size_t)faces.count, sizeof *faces.node, by_nodes);
            ck_assert_int_eq(memcmp(list, faces.node, (size_t)faces.count * sizeof *list), 0);
            int32_t expected = 0;
            for (int32_t n = 0; n < fem->node_count; n++) {
                bool of = fem->bonds[n] == 0 && k == 0; // a keeps its loose nodes
                for (int32_t f = 0; f < faces.count && !of; f++)
                    for (int c = 0; c < 4; c++) of = of || faces.node[f][c] == n;
                if (!of) continue;
                ck_assert_int_eq(s->node[s->node_range[k] + expected], n);
                expected++;
            }
            ck_assert_int_eq(expected, s->node_end[k] - s->node_range[k]);
            brunt_faces_free(&faces);
            free(list);
        }
        for (int32_t n = 0; n < s->node_count; n++)
            for (int32_t q = s->face_first[n]; q < s->face_first[n + 1]; q++) {
                bool has = false;
                for (int c = 0; c < 4; c++) has = has || s->face[s->face_of[q]][c] == n;
                ck_assert(has);
            }
        world_steps(world, 2);
    }
    ck_assert_int_eq(world->bodies.fem[0].element_count, 0); // bodies without elements go on
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ one element

typedef struct pressed {
    double before, after, error, drift;
} pressed;

// A block meets a plate at `speed` wave speeds; when the wave has reached the plate's far side, elements that touch
// leave: bit 0 of `which` the plate's, bit 1 the block's. Greatest contact force of a step before that and after it.
static pressed press(brunt_element_kind kind, int which, bool keep, double speed) {
    const double z = deep(kind), h = z ? 0.125 : 0.05, v = speed * wave_speed;
    brunt_world_def def = begin(brunt_element_dimension(kind), 0.2);
    mesh_box(&def, "plate", XYZ(-0.5, -0.5, -0.5 * z), XYZ(0.5, 0, 0.5 * z), kind, h, keep);
    def_velocity(mesh_box(&def, "tool", XYZ(-0.31, 0.01 * h, -0.31 * z), XYZ(0.29, 0.6, 0.29 * z), kind, h, keep), 0,
                 -v, 0);
    brunt_world *world = world_take(&def);
    pressed p = {0};
    bool gone = false;
    while (brunt_world_time(world) < 1.5 / wave_speed) {
        world_steps(world, 1);
        double *most = gone ? &p.after : &p.before;
        *most = fmax(*most, fabs(world_pair(world, 0).force[1]));
        if (gone || brunt_world_time(world) < 0.5 / wave_speed) continue;
        gone = true;
        if (which & 1) mark(&world->bodies.fem[0], element_at(&world->bodies.fem[0], XYZ(0.02, -0.3 * h, 0.02 * z)));
        if (which & 2)
            mark(&world->bodies.fem[1], element_at(&world->bodies.fem[1], XYZ(-0.1, -0.03 + 0.5 * h, 0.02 * z)));
        erode(world);
    }
    p.error = world_energy(world).error_relative, p.drift = world_momentum(world).linear_drift;
    brunt_world_destroy(world);
    return p;
}

// The contact force after an element has gone is no greater than it would have been: measured, within 3 %.
START_TEST(no_spike) {
    const brunt_element_kind kind = kinds[_i % 4];
    const double speed = _i / 4 ? 0.3 : 0.05;
    const pressed whole = press(kind, 0, false, speed);
    for (int which = 1; which <= 3; which++) {
        const pressed p = press(kind, which, which == 3, speed);
        printf("%s, %.2f c, %d: force before %.4g, after %.4g; whole %.4g; error %.1e, drift %.1e\n",
               brunt_element_name(kind), speed, which, p.before, p.after, whole.after, p.error, p.drift);
        hard_case("C27", p.after / fmax(whole.after, p.before), 2, 1.2,
                  "%s, %g c, element of %s: force after it, of that without", brunt_element_name(kind), speed,
                  which == 1   ? "the plate"
                  : which == 2 ? "the block"
                               : "both");
        ck_assert_double_lt(fabs(p.error), 2 * fabs(whole.error) + 1e-3);
        ck_assert_double_lt(p.drift, ROUNDING);
    }
}
END_TEST

// Two bodies that lie in each other: what is laid open inside the other one when the first layer goes is not thrown
// out of it. The overlap stays until they part; only their approach ends.
START_TEST(overlap_at_birth) {
    const brunt_element_kind kind = kinds[_i];
    const double z = deep(kind), h = 0.125, v = 0.02 * wave_speed;
    brunt_world_def def = begin(brunt_element_dimension(kind), 0);
    def.contact.allow_overlap = true;
    mesh_box(&def, "plate", XYZ(-0.5, -0.5, -0.5 * z), XYZ(0.5, 0, 0.5 * z), kind, h, false);
    def_velocity(mesh_box(&def, "tool", XYZ(-0.31, -1.2 * h, -0.31 * z), XYZ(0.31, 0.4, 0.31 * z), kind, h, false), 0,
                 -v, 0);
    brunt_world *world = world_take(&def);
    brunt_fem_body *plate = &world->bodies.fem[0];
    world_steps(world, 1);
    for (int32_t s = 0; s < plate->slots; s++) { // the first layer
        double x[3];
        if (plate->element_id[s] < 0) continue;
        middle_of(plate, s, x);
        if (x[1] > -h) mark(plate, s);
    }
    erode(world);
    const brunt_energy start = world_energy(world);
    double most = 0, force = 0;
    const double area = 0.62 * (z ? 0.62 : 1), plane_wave = 0.5 * 1000 * wave_speed * v * area;
    while (brunt_world_time(world) < 1 / wave_speed) {
        world_steps(world, 1);
        const brunt_energy e = world_energy(world);
        most = fmax(most, stored(&e));
        force = fmax(force, fabs(world_pair(world, 0).force[1]));
    }
    const brunt_body_sums tool = world_sums(world, 1);
    printf("%s: born 0.2 h inside; force %.2f of a plane wave's, E/E0 %.5f, tool at %.2f v\n", brunt_element_name(kind),
           force / plane_wave, most / stored(&start), tool.velocity[1] / v);
    ck_assert_double_lt(most, (1 + 2e-3) * stored(&start));
    ck_assert_double_lt(force,
                        8 * plane_wave); // surface nodes are stopped in one step, half as fast again on the way out
    ck_assert_double_lt(fabs(tool.velocity[1]), 1.0 * v);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ through a plate

typedef struct drilling {
    double depth, made, error, drift, angular, speed;
    int eroded;
    uint64_t hash;
} drilling;

typedef struct drill {
    brunt_element_kind kind;
    double speed, friction, ratio;
    bool keep;
    uint64_t seed;
    int threads, restart; // 0: not; else after so many steps
} drill;

static brunt_world *drill_world(const drill *o) {
    const double z = deep(o->kind), h = 0.1, size = (z ? 4 : 8) * h * o->ratio, wide = z ? 0.5 : 1, thick = z ? 5 : 10;
    const double v = o->speed * wave_speed, low = -size / 2 + 0.013, high = size / 2 + 0.013;
    brunt_world_def def = begin(brunt_element_dimension(o->kind), o->friction);
    def.threads = o->threads;
    mesh_box(&def, "plate", XYZ(-wide, -thick * h, -wide * z), XYZ(wide, 0, wide * z), o->kind, h, o->keep);
    brunt_body_def *b = mesh_box(&def, "tool", XYZ(low, 0.02 * h, low * z), XYZ(high, size + 0.02 * h, high * z),
                                 o->kind, h * o->ratio, o->keep);
    b->material = 1;
    def_velocity(b, 0.1 * v, -v, 0);
    return world_take(&def);
}

// Marks what is crushed or torn, and ahead of the tool one in five by chance each time it has come 0.3 elements
// further.
static void mark_ahead(brunt_world *world, double size, uint64_t *seed, bool due) {
    brunt_fem_body *plate = &world->bodies.fem[0];
    const brunt_body_sums tool = world_sums(world, 1);
    const int dim = plate->dim;
    real *const *F = brunt_element_scalars(plate, BRUNT_ELEMENT_deformation_gradient);
    for (int32_t s = 0; s < plate->slots; s++) {
        double x[3], greatest = 0, J;
        if (plate->element_id[s] < 0) continue;
        middle_of(plate, s, x);
        for (int c = 0; c < dim * dim; c++) greatest = fmax(greatest, fabs((double)F[c][s]));
        J = dim == 2 ? (double)(F[0][s] * F[3][s] - F[1][s] * F[2][s])
                     : (double)(F[0][s] * (F[4][s] * F[8][s] - F[5][s] * F[7][s]) -
                                F[1][s] * (F[3][s] * F[8][s] - F[5][s] * F[6][s]) +
                                F[2][s] * (F[3][s] * F[7][s] - F[4][s] * F[6][s]));
        const bool ahead = x[1] > tool.low[1] - 0.22 && fabs(x[0] - tool.centre[0]) < size / 2 + 0.1 &&
                           fabs(x[2] - tool.centre[2]) < size / 2 + 0.1;
        if (J < 0.4 || J > 2 || greatest > 1.7 || (due && ahead && random_number(seed) < 0.2)) mark(plate, s);
    }
}

static drilling drive(const drill *o) {
    const double z = deep(o->kind), h = 0.1, size = (z ? 4 : 8) * h * o->ratio, v = o->speed * wave_speed;
    brunt_world *world = drill_world(o);
    drilling d = {0};
    uint64_t seed = o->seed;
    double next = 0.5 * h / v;
    const double end = ((z ? 5 : 10) * h + 1.5 * size) / v, initial = world_energy(world).initial;
    for (int step = 0; brunt_world_time(world) < end; step++) {
        if (o->restart && step == o->restart) {
            brunt_world *fresh = drill_world(o);
            world_copy_state(world, fresh);
            brunt_world_destroy(world);
            world = fresh;
        }
        world_steps(world, 1);
        const bool due = brunt_world_time(world) > next;
        if (due) next += 0.3 * h / v;
        mark_ahead(world, size, &seed, due);
        erode(world);
        const brunt_energy e = world_energy(world);
        d.made = fmax(d.made, (stored(&e) + e.eroded) / initial - 1);
        if (o->restart || o->threads > 1 || step % 8) continue;
        int inside;
        d.depth = fmax(d.depth, deepest_node(world, 0, &inside) / h);
    }
    const brunt_momentum p = world_momentum(world);
    brunt_eroded gone;
    brunt_body_eroded(world, 0, &gone);
    d.eroded = (int)gone.elements;
    d.error = world_energy(world).error_relative, d.drift = p.linear_drift, d.angular = p.angular_drift;
    d.speed = -world_sums(world, 1).velocity[1] / v, d.hash = brunt_world_hash(world);
    brunt_world_destroy(world);
    return d;
}

// Blocks of 8 x 8 elements (in space 4 x 4 x 4) through plates 10 (5) elements thick that lose elements ahead of them
// by chance. Deepest over 24 (hex8: 60) seeds, speeds of 0.1 to 0.5 c, edges 0.7 to 1.3 h: 0.012 h (quad4), 0.07 h
// (tri3), 0.24 h (hex8), 0.19 h (tet4): edges that cut into edges. Where only facets that face a node's normal bear,
// hexahedra get 0.97 h deep.
START_TEST(through_a_plate) {
    static const struct drill cases[] = {
        {BRUNT_QUAD4, 0.15, 0, 0.7, true, 1, 1, 0}, {BRUNT_QUAD4, 0.5, 0.2, 1, false, 2, 1, 0},
        {BRUNT_TRI3, 0.15, 0, 0.7, false, 3, 1, 0}, {BRUNT_TRI3, 0.5, 0.2, 1, true, 4, 1, 0},
        {BRUNT_TET4, 0.5, 0.2, 1, true, 5, 1, 0},   {BRUNT_HEX8, 0.25, 0.2, 1, true, 1, 1, 0},
        {BRUNT_HEX8, 0.5, 0, 1, false, 2, 1, 0},    {BRUNT_HEX8, 0.25, 0.2, 1, true, 3, 1, 0},
        {BRUNT_HEX8, 0.5, 0, 1, false, 4, 1, 0},    {BRUNT_HEX8, 0.25, 0.2, 1, false, 5, 1, 0},
        {BRUNT_HEX8, 0.5, 0, 1, true, 6, 1, 0}};
    const drill *o = &cases[_i];
    const drilling d = drive(o);
    printf(
        "%s, %.2f c: %d eroded, deepest %.3f h, E/E0 - 1 at most %.1e, error %.1e, drift %.1e %.1e, tool at %.2f v\n",
        brunt_element_name(o->kind), o->speed, d.eroded, d.depth, d.made, d.error, d.drift, d.angular, d.speed);
    ck_assert_int_gt(d.eroded, 20);
    ck_assert_double_lt(d.depth, deep(o->kind) ? 0.3 : 0.1);
    ck_assert_double_lt(d.made, 1e-4);
    ck_assert_double_lt(fabs(d.error), 5e-3);
    ck_assert_double_lt(d.drift, ROUNDING);
    ck_assert_double_lt(d.angular, 100 * ROUNDING);
}
END_TEST

START_TEST(same_bits) {
    drill o = {.kind = kinds[_i], .speed = 0.5, .friction = 0.2, .ratio = 1, .keep = true, .seed = 3, .threads = 1};
    const drilling one = drive(&o);
    o.threads = 2;
    const drilling two = drive(&o);
    o.threads = 1, o.restart = 45;
    const drilling again = drive(&o);
    ck_assert_int_gt(one.eroded, 20);
    ck_assert_uint_eq(one.hash, two.hash);
    ck_assert_uint_eq(one.hash, again.hash);
}
END_TEST

// ------------------------------------------------------------------------------------------ material points

// Particles in live elements of the plate, deeper than `limit`, and the deepest [m].
static double deepest_particle(brunt_world *world, double limit, int *count) {
    const brunt_fem_body *plate = &world->bodies.fem[0];
    const int body = world->bodies.mpm[0].index;
    double *x = world_field(world, body, "position"), deepest = 0;
    brunt_faces faces;
    ck_assert_int_eq(brunt_fem_faces(plate, &faces, NULL), 0);
    *count = 0;
    for (int64_t i = 0; i < brunt_body_particles(world, body); i++)
        for (int32_t s = 0; s < plate->slots; s++) {
            if (plate->element_id[s] < 0 || !in_element(plate, s, x + 3 * i)) continue;
            const double depth = surface_distance(plate, &faces, x + 3 * i);
            deepest = fmax(deepest, depth);
            *count += depth > limit;
            break;
        }
    brunt_faces_free(&faces);
    free(x);
    return deepest;
}

// A block of material points through a plate of elements that go ahead of it.
START_TEST(points_through_a_plate) {
    const brunt_element_kind kind = kinds[_i % 4];
    const bool augury = _i / 4 == 0;
    const double z = deep(kind), h = 0.1, size = (z ? 3 : 6) * h, v = 0.3 * wave_speed, wide = z ? 0.4 : 0.8;
    brunt_world_def def = begin(brunt_element_dimension(kind), 0.1);
    def.cell = h;
    def.contact.method = augury ? BRUNT_CONTACT_AUGURY : BRUNT_CONTACT_MULTI_VELOCITY;
    mesh_box(&def, "plate", XYZ(-wide, -0.4, -wide * z), XYZ(wide, 0, wide * z), kind, h, _i % 2);
    brunt_body_def *tool =
        def_box(&def, "tool", XYZ(-size / 2, 0.05 * h, -size / 2 * z), XYZ(size / 2, size, size / 2 * z));
    tool->material = 1;
    def_velocity(tool, 0, -v, 0);
    brunt_world *world = world_take(&def);
    uint64_t seed = 5;
    double next = 0.5 * h / v, depth = 0, made = -1;
    const double initial = world_energy(world).initial;
    int deepest = 0;
    for (int step = 0; brunt_world_time(world) < 0.8 / v; step++) {
        world_steps(world, 1);
        const bool due = brunt_world_time(world) > next;
        if (due) next += 0.3 * h / v;
        mark_ahead(world, size, &seed, due);
        erode(world);
        const brunt_energy e = world_energy(world);
        made = fmax(made, (stored(&e) + e.eroded) / initial - 1);
        if (step % 4) continue;
        int inside;
        depth = fmax(depth, deepest_particle(world, 0.5 * h, &inside) / h);
        deepest = inside > deepest ? inside : deepest;
    }
    brunt_eroded gone;
    brunt_body_eroded(world, 0, &gone);
    const brunt_momentum p = world_momentum(world);
    const brunt_energy e = world_energy(world);
    printf(
        "%s, %s: %d eroded, deepest %.2f h, %d beyond half an element, E/E0 - 1 at most %.1e, error %.1e, drift %.1e "
        "%.1e\n",
        brunt_element_name(kind), augury ? "augury" : "multi-velocity", (int)gone.elements, depth, deepest, made,
        e.error_relative, p.linear_drift, p.angular_drift);
    ck_assert_int_gt(gone.elements, 20);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    if (augury) ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(made, 1e-4);
    ck_assert_double_lt(fabs(e.error_relative), 2e-2);
    ck_assert_int_eq(deepest, 0);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ very fast

// Two blocks, the upper one of elements or of material points, at `v`; elements that the shock turns inside out go.
static brunt_world *fast_world(brunt_element_kind kind, bool points, double v) {
    const double z = deep(kind), h = 0.1, size = (z ? 4 : 6) * h;
    brunt_world_def def = begin(brunt_element_dimension(kind), 0);
    def.cell = h;
    mesh_box(&def, "plate", XYZ(-size, -size, -size * z), XYZ(size, 0, size * z), kind, h, true);
    if (points)
        def_box(&def, "tool", XYZ(-size / 2, 0.3 * h, -size / 2 * z), XYZ(size / 2, size, size / 2 * z));
    else
        mesh_box(&def, "tool", XYZ(-size / 2 + 0.01, 0.3 * h, (-size / 2 + 0.01) * z),
                 XYZ(size / 2 + 0.01, size, (size / 2 + 0.01) * z), kind, h, true);
    for (int k = 0; k < 2; k++) def.bodies[k].erosion.inverted = def.bodies[k].method == BRUNT_FEM;
    def_velocity(&def.bodies[1], 0, -v, 0);
    return world_take(&def);
}

// What was not tried with points: more than 0.5, where the points' own compression makes energy in the transfers, as
// the ledger says (0.06 to 0.15 of what there is at 3 c), or turns them inside out. Contact has no part in that.
static const struct fast_case {
    brunt_element_kind kind;
    double share; // of an element that they come nearer in the first step
    bool points;
} fast_cases[] = {{BRUNT_QUAD4, 0.5, false}, {BRUNT_QUAD4, 0.9, false}, {BRUNT_QUAD4, 0.99, false},
                  {BRUNT_TRI3, 0.99, false}, {BRUNT_HEX8, 0.99, false}, {BRUNT_TET4, 0.5, false},
                  {BRUNT_QUAD4, 0.5, true},  {BRUNT_HEX8, 0.5, true}};
enum { FAST_CASES = sizeof fast_cases / sizeof fast_cases[0] };

// At 1.2 to 3.3 wave speeds nothing gets through, and no energy is made. Hexahedra that are crushed get deep at their
// edges: 0.62 of an element (0.616 and 0.626 in two builds, whose last digits differ), 0.31 where touches give nothing
// back.
START_TEST(very_fast) {
    const struct fast_case *c = &fast_cases[_i];
    const double h = 0.1;
    brunt_world *world = fast_world(c->kind, c->points, 0);
    const double dt = brunt_world_dt(world), v = c->share * h / dt;
    brunt_world_destroy(world);
    world = fast_world(c->kind, c->points, v);
    const double first = brunt_world_dt(world), initial = world_energy(world).initial;
    double made = -1, depth = 0;
    int steps = 0;
    for (; brunt_world_time(world) < 3 * h / v + 0.6 / v; steps++) {
        int inside;
        world_steps(world, 1);
        const brunt_energy e = world_energy(world);
        made = fmax(made, (stored(&e) + e.eroded) / initial - 1);
        if (steps % 4) continue;
        const double deepest = c->points ? deepest_particle(world, 0, &inside) : deepest_node(world, 0, &inside);
        depth = fmax(depth, deepest / h);
    }
    const brunt_body_sums a = world_sums(world, 0), b = world_sums(world, 1);
    const brunt_momentum p = world_momentum(world);
    printf("%s and %s, v dt/h %.2f (%.2f c): %d steps, deepest %.2f h; E/E0 - 1 at most %.1e, error %.1e; %.2f v and "
           "%.2f v, "
           "drift %.1e\n",
           brunt_element_name(c->kind), c->points ? "points" : "mesh", v * first / h, v / wave_speed, steps, depth,
           made, world_energy(world).error_relative, b.velocity[1] / v, a.velocity[1] / v, p.linear_drift);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    hard_case("C03", fmax(0, made), 1e-4, 1e-4, "%s and %s, %g of an edge in a step: energy made",
              brunt_element_name(c->kind), c->points ? "points" : "mesh", c->share);
    hard_case("C03", depth, 0.5, deep(c->kind) && !c->points ? 0.63 : 0.1,
              "%s and %s, %g of an edge in a step: depth [edges]", brunt_element_name(c->kind),
              c->points ? "points" : "mesh", c->share);
    ck_assert_double_gt(b.low[1], a.low[1] + 0.5 * h);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ loose nodes

// All elements of a cube go: its nodes fly on, and rebound from a block or rest on a plane. Without `keep` nothing is
// left.
START_TEST(loose_nodes) {
    const brunt_element_kind kind = kinds[_i % 4];
    const bool keep = _i / 4 == 0;
    const double z = deep(kind), h = 0.125, v = 0.05 * wave_speed;
    brunt_world_def def = begin(brunt_element_dimension(kind), 0.1);
    brunt_body_def *block = mesh_box(&def, "block", XYZ(-0.5, -0.5, -0.5 * z), XYZ(0.5, 0, 0.5 * z), kind, h, false);
    block->material = 1;
    def_velocity(
        mesh_box(&def, "cube", XYZ(-0.21, 0.3 * h, -0.21 * z), XYZ(0.19, 0.3 * h + 0.4, 0.19 * z), kind, h, keep), 0,
        -v, 0);
    brunt_world *world = world_take(&def);
    world_steps(world, 1);
    brunt_fem_body *cube = &world->bodies.fem[1];
    for (int32_t s = 0; s < cube->slots; s++)
        if (cube->element_id[s] >= 0) mark(cube, s);
    erode(world);
    ck_assert_int_eq(cube->element_count, 0);
    world_until(world, 0.8 / v);
    const brunt_momentum p = world_momentum(world);
    const brunt_reaction f = world_pair(world, 0);
    const brunt_energy e = world_energy(world);
    int inside;
    deepest_node(world, 0.05 * h, &inside);
    printf("%s, keep %d: impulse %.3g, %d inside, E/E0 %.4f, drift %.1e %.1e\n", brunt_element_name(kind), keep,
           f.impulse[1], inside, (stored(&e) + e.eroded) / e.initial, p.linear_drift, p.angular_drift);
    ck_assert_int_eq(inside, 0);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(stored(&e) + e.eroded, (1 + 1e-4) * e.initial);
    if (keep)
        ck_assert_double_gt(fabs(f.impulse[1]), 0.5 * v * 1000 * 0.4 * 0.4 * (z ? 0.4 : 1));
    else
        ck_assert_double_eq(f.impulse[1], 0);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ sheets

// A membrane in contact with itself and with a block that falls through it: both sides lose the same elements.
static brunt_world *torn_world(brunt_element_kind kind) {
    brunt_world_def def = begin(3, 0.1);
    brunt_body_def *sheet = mesh_box(&def, "sheet", XYZ(0, 0, 0), XYZ(1, 1, 0.1), kind, 0.1, true);
    sheet->method = BRUNT_MEMBRANE, sheet->thickness = 0.01;
    sheet->faces = brunt_def_alloc(sizeof *sheet->faces), sheet->face_count = 1;
    snprintf(sheet->faces[0], sizeof sheet->faces[0], "zmin");
    mesh_box(&def, "tool", XYZ(0.33, 0.33, 0.006), XYZ(0.68, 0.68, 0.3), BRUNT_HEX8, 0.1, false)->velocity[2] = -8;
    def.contact.pairs = brunt_alloc(sizeof *def.contact.pairs), def.contact.pair_count = 1;
    def.contact.pairs[0] =
        (brunt_pair_def){.a = "sheet", .b = "sheet", .method = BRUNT_CONTACT_AUGURY, .friction = 0.1};
    return world_take(&def);
}

static int fem_elements(const brunt_world *world) { return world->bodies.fem[0].element_count; }

START_TEST(torn_membrane) {
    const brunt_element_kind kind = _i ? BRUNT_MEMBRANE_TRI3 : BRUNT_MEMBRANE_QUAD4;
    brunt_world *world = torn_world(kind);
    uint64_t seed = 3, hash[2];
    int steps = 0;
    for (int k = 0; k < 2; k++) {
        brunt_world *copy = NULL;
        const uint64_t from = seed;
        const int first = steps;
        if (k) {
            copy = torn_world(kind);
            world_copy_state(world, copy);
        }
        for (int run = 0; run <= k; run++) {
            brunt_world *w = run ? copy : world;
            seed = from;
            for (steps = first; steps < first + 40; steps++) {
                world_steps(w, 1);
                brunt_fem_body *fem = &w->bodies.fem[0];
                for (int32_t s = 0; s < fem->slots && steps % 5 == 4; s++)
                    if (fem->element_id[s] >= 0 && random_number(&seed) < 0.06) mark(fem, s);
                erode(w);
            }
            hash[run] = brunt_world_hash(w);
            const brunt_contact_surface *surface = &w->contact.surface;
            ck_assert_int_eq(surface->face_end[0] - surface->face_range[0], fem_elements(w));
            ck_assert_int_eq(surface->face_range[1] - surface->face_end[0], fem_elements(w));
            for (int32_t n = surface->node_end[0]; n < surface->node_range[1]; n++)
                ck_assert_int_eq(surface->node[surface->membrane.front[n]], surface->node[n]);
        }
        if (!k) continue;
        ck_assert_uint_eq(hash[0], hash[1]);
        brunt_world_destroy(copy);
    }
    const brunt_momentum p = world_momentum(world);
    printf("%s: %d elements left, impulse %.3g, drift %.1e %.1e, error %.1e\n", brunt_element_name(kind),
           fem_elements(world), world_pair(world, 1).impulse[2], p.linear_drift, p.angular_drift,
           world_energy(world).error_relative);
    ck_assert_double_lt(p.linear_drift, ROUNDING);
    ck_assert_double_lt(p.angular_drift, 100 * ROUNDING);
    ck_assert_double_lt(fabs(world_energy(world).error_relative), 1e-2);
    ck_assert_double_gt(fabs(world_pair(world, 1).impulse[2]), 1);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ cost

// Surfaces that change in each step ask for no memory once they have had as much.
START_TEST(no_growth) {
    brunt_world_def def = begin(3, 0);
    mesh_box(&def, "a", XYZ(0, 0, 0), XYZ(1, 1, 1), BRUNT_HEX8, 0.1, false);
    def_velocity(mesh_box(&def, "b", XYZ(0.1, 1.001, 0.1), XYZ(0.9, 1.6, 0.9), BRUNT_HEX8, 0.1, false), 0, -1, 0);
    brunt_world *world = world_take(&def);
    uint64_t seed = 1;
    int64_t calls = 0;
    for (int k = 0; k < 200; k++) {
        if (k == 150) calls = brunt_memory_calls();
        world_steps(world, 1);
        for (int q = 0; q < 3; q++) {
            int32_t s;
            do s = (int32_t)(random_number(&seed) * world->bodies.fem[0].slots);
            while (world->bodies.fem[0].element_id[s] < 0);
            mark(&world->bodies.fem[0], s);
        }
        erode(world);
    }
    calls = brunt_memory_calls() - calls;
    printf("%d allocations in the last 50 of 200 erosions\n", (int)calls);
    ck_assert_int_le(calls, 3); // of contact points there may be more than ever before
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("erosion_contact");
    ADD_LOOP(surface_is_that_of_the_elements, 4);
    ADD_LOOP(no_spike, 8);
    ADD_LOOP(overlap_at_birth, 4);
    ADD_LOOP(through_a_plate, 11);
    ADD_LOOP(same_bits, 4);
    ADD_LOOP(points_through_a_plate, 8);
    ADD_LOOP(very_fast, FAST_CASES);
    ADD_LOOP(loose_nodes, 8);
    ADD_LOOP(torn_membrane, 2);
    ADD(no_growth);
    return suite_main(suite);
}
