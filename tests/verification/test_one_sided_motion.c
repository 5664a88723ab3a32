// Contact when one side alone moves. What is remembered of a search from step to step must follow both sides: a body
// that slides far over one that is held, and one that is held far from where the other begins. Every pairing of meshes,
// material points, membranes and planes, each side the one that moves, in both orders of the bodies, the right way up,
// upside down and against a wall.
#include "tests/support/hard_world.h"

static const double H = 0.01;       // [m] cells and edges
static const double SPEED = 1;      // [m/s] a tenth of the wave speed
static const double THICK = 0.2;    // edges
static const double GRAVITY = 10;   // [m/s^2] presses by half a percent of the stiffness
static const double DISTANCE = 8.3; // edges: from how far away bodies approach; contact looks a quarter of one

typedef enum side { MESH, POINTS, MEMBRANE, PLANE } side;
static const char *const side_name[] = {"mesh", "points", "sheet", "plane"};

// A block `a` that slides over `b`, or hits it; `turn`: which way is up.
typedef struct motion {
    int dim, turn;
    side a, b;
    bool b_moves, b_first, approach;
    brunt_contact_method method;
} motion;

// ------------------------------------------------------------------------------------------ which way is up

// Along the way, across, up: as places or vectors of the world.
static void turn(const motion *m, const double in[3], double out[3]) {
    const int up = m->dim - 1;
    double v[3] = {in[0], m->dim == 3 ? in[1] : 0, 0};
    v[up] = in[2];
    if (m->turn == 1) v[0] = -v[0], v[up] = -v[up];
    if (m->turn == 2) v[0] = in[2], v[up] = in[0];
    memcpy(out, v, sizeof v);
}

static int up_axis(const motion *m) { return m->turn == 2 ? 0 : m->dim - 1; }
static double up_sign(const motion *m) { return m->turn == 1 ? -1 : 1; }

static const char *top_face(const motion *m) {
    static const char *const names[] = {"zmax", "zmin", "xmax"};
    return names[m->turn];
}

static void turn_box(const motion *m, const double low[3], const double high[3], brunt_shape *shape) {
    double p[3], q[3];
    turn(m, low, p), turn(m, high, q);
    shape->kind = BRUNT_BOX;
    for (int a = 0; a < 3; a++) shape->min[a] = fmin(p[a], q[a]), shape->max[a] = fmax(p[a], q[a]);
}

// ------------------------------------------------------------------------------------------ bodies

static brunt_body_def *add_body(brunt_world_def *def, const motion *m, const char *name, side kind, const double low[3],
                                const double high[3], const double v[3]) {
    brunt_body_def *b = def_body(def, name);
    turn_box(m, low, high, &b->shape);
    double velocity[3];
    turn(m, v, velocity);
    def_velocity(b, velocity[0], velocity[1], velocity[2]);
    if (kind == POINTS) return b;
    b->method = kind == MEMBRANE ? BRUNT_MEMBRANE : BRUNT_FEM;
    b->element = kind == MEMBRANE ? BRUNT_MEMBRANE_QUAD4 : m->dim == 3 ? BRUNT_HEX8 : BRUNT_QUAD4;
    b->size = H;
    if (kind == MESH) return b;
    b->thickness = THICK * H;
    b->faces = brunt_alloc(sizeof *b->faces), b->face_count = 1;
    snprintf(*b->faces, sizeof *b->faces, "%s", top_face(m));
    return b;
}

// Gives all nodes of a mesh or sheet, which is one element thick, or the lower half of a slab of points, a velocity.
static void drive(brunt_world_def *def, const motion *m, const char *name, side kind, const double v[3]) {
    double velocity[3];
    turn(m, v, velocity);
    if (kind != POINTS) {
        brunt_group_def *g = &def->groups[def->group_count++];
        *g = brunt_group_def_default();
        snprintf(g->body, sizeof g->body, "%s", name), snprintf(g->group, sizeof g->group, "surface");
        for (int a = 0; a < m->dim; a++) g->component[a] = true, g->value[a] = velocity[a];
        return;
    }
    brunt_region_def *r = &def->regions[def->region_count++];
    *r = brunt_region_def_default();
    snprintf(r->body, sizeof r->body, "%s", name);
    turn_box(m, XYZ(-100 * H, -100 * H, -100 * H), XYZ(100 * H, 100 * H, -2 * H), &r->shape);
    for (int a = 0; a < m->dim; a++) r->component[a] = true, r->velocity[a] = velocity[a];
}

static double half_of(side kind) { return kind == POINTS ? 0.25 * H : kind == MEMBRANE ? 0.5 * THICK * H : 0; }
static double travel(const motion *m) { return (m->dim == 3 ? 8 : 20) * H; }

static brunt_world *begin(const motion *m) {
    brunt_world_def def = def_begin(m->dim, H);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.regions = brunt_alloc(DEF_CAPACITY * sizeof *def.regions);
    def.contact.method = m->method;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    const double way = travel(m), gap = (m->approach ? DISTANCE : 0.02) * H +
                                        (m->a == MEMBRANE ? half_of(MEMBRANE) : 0) +
                                        (m->b == MEMBRANE ? half_of(MEMBRANE) : 0);
    const double wide = m->approach ? 8 * H : way + 9 * H, tall = m->a == MEMBRANE ? H : m->dim == 3 ? 3 * H : 4 * H;
    const double *along = m->approach ? XYZ(0, 0, -SPEED) : XYZ(SPEED, 0, 0);
    double v[3];
    for (int a = 0; a < 3; a++) v[a] = m->b_moves ? -along[a] : along[a];
    const double *still = XYZ(0, 0, 0), *va = m->b_moves ? still : v, *vb = m->b_moves ? v : still;
    // The upper face of a sheet's box is where it is.
    const double low[3] = {0.03 * H, 0.04 * H, m->a == MEMBRANE ? gap - H : gap},
                 high[3] = {3.03 * H, 3.04 * H, low[2] + tall};
    add_body(&def, m, m->b_first ? "q" : "p", m->a, low, high, va);
    const char *base = m->b_first ? "p" : "q";
    if (m->b == PLANE) {
        double normal[3], velocity[3];
        turn(m, XYZ(0, 0, 1), normal), turn(m, vb, velocity);
        brunt_plane_def *p = def_plane(&def, XYZ(0, 0, 0), normal, BRUNT_SEPARATE, 0);
        memcpy(p->velocity, velocity, sizeof p->velocity);
    } else {
        add_body(&def, m, base, m->b, XYZ(-3 * H, -2 * H, m->b == POINTS ? -4 * H : -H), XYZ(wide - 3 * H, 5 * H, 0),
                 vb);
        drive(&def, m, base, m->b, vb);
    }
    if (!m->approach) turn(m, XYZ(0, 0, -GRAVITY), def.gravity);
    return world_take(&def);
}

// ------------------------------------------------------------------------------------------ what is measured

static int body_named(const brunt_world *world, const char *name) {
    for (int b = 0; b < brunt_body_count(world); b++)
        if (!strcmp(brunt_body_name(world, b), name)) return b;
    ck_abort_msg("there is no body %s", name);
    return -1;
}

// Lowest, or highest, place of a body's nodes or particles.
static double end_of(brunt_world *world, const motion *m, int body, bool high) {
    double(*x)[3] = (void *)world_field(world, body, "position"), end = high ? -INFINITY : INFINITY;
    for (int64_t i = 0; i < brunt_body_nodes(world, body) + brunt_body_particles(world, body); i++) {
        const double up = up_sign(m) * x[i][up_axis(m)];
        end = high ? fmax(end, up) : fmin(end, up);
    }
    free(x);
    return end;
}

typedef struct found {
    double
        depth; // edges: furthest that the block's underside has come below the other's top, less what keeps them apart
    double impulse; // of the weight's, or of the momentum that one has
} found;

static found go(const motion *m) {
    brunt_world *world = begin(m);
    const int a = body_named(world, m->b_first ? "q" : "p");
    const double end = m->approach ? 1.6 * DISTANCE * H / SPEED : travel(m) / SPEED, mass = world_sums(world, a).mass;
    found f = {-INFINITY, 0};
    for (int k = 1; k <= 20; k++) {
        world_until(world, end * k / 20);
        const double top = m->b == PLANE ? (m->b_moves && m->approach ? SPEED * brunt_world_time(world) : 0)
                                         : end_of(world, m, body_named(world, m->b_first ? "p" : "q"), true);
        f.depth = fmax(f.depth,
                       (half_of(m->a) + half_of(m->b == PLANE ? MESH : m->b) + top - end_of(world, m, a, false)) / H);
    }
    brunt_reaction force = m->b == PLANE ? world_boundary(world, 0) : world_pair(world, 0);
    f.impulse = fabs(force.impulse[up_axis(m)]) / (mass * (m->approach ? SPEED : GRAVITY * end));
    brunt_world_destroy(world);
    return f;
}

// How deep the upper one may seem to be [edges]: facets are met to a thousandth. Points are pressed flat by the load
// that is on them (sudden weight, or the pressure of the blow), and a slab of points more so under the block than
// beside it. What meets at grid nodes sees surfaces through kernels.
static double allowed(const motion *m) {
    const double modulus = 1.35e5,
                 strain = m->approach ? SPEED / sqrt(modulus / 1000) : 2 * 1000 * GRAVITY * 4 * H / modulus;
    const bool nodes = m->b == POINTS && (m->a == POINTS || m->method == BRUNT_CONTACT_MULTI_VELOCITY);
    return 1e-3 + strain * ((m->a == POINTS ? 0.25 : 0) + (m->b == POINTS ? 4.25 : 0)) + (nodes ? 0.15 : 0);
}

// All ways about of a pairing. How many are not stopped.
static int try_ways(motion m) {
    double deepest = -INFINITY, least = INFINITY, most = 0;
    int failed = 0;
    for (int k = 0; k < (m.dim == 3 ? 4 : 12); k++) { // in space each turn about once
        m.b_moves = k & 1, m.b_first = k >> 1 & 1, m.turn = (k + (k >> 2)) % 3;
        found f = go(&m);
        deepest = fmax(deepest, f.depth), least = fmin(least, f.impulse), most = fmax(most, f.impulse);
        const bool stops = f.depth <= allowed(&m), pressed = f.impulse > 0.5 && f.impulse < (m.approach ? 2.2 : 1.5);
        if (stops && pressed) continue;
        failed++;
        printf("the %s one moves, the %s one first, turn %d: %.4f edges deep, impulse %.3f\n",
               m.b_moves ? "lower" : "upper", m.b_first ? "lower" : "upper", m.turn, f.depth, f.impulse);
    }
    printf("%dD %-6s %s %-6s: deepest %.5f edges (of %.5f), impulse %.3f to %.3f\n", m.dim, side_name[m.a],
           m.approach ? "onto" : "over", side_name[m.b], deepest, allowed(&m), least, most);
    return failed;
}

static void try_all(int dim, bool approach, brunt_contact_method method) {
    int failed = 0;
    for (int a = MESH; a <= MEMBRANE; a++)
        for (int b = MESH; b <= PLANE; b++) {
            if (dim == 2 && (a == MEMBRANE || b == MEMBRANE)) continue;
            if (method == BRUNT_CONTACT_MULTI_VELOCITY && a != POINTS && b != POINTS) continue;
            failed += try_ways((motion){.dim = dim, .a = a, .b = b, .approach = approach, .method = method});
        }
    ck_assert_msg(!failed, "%d motions are not stopped", failed);
}

START_TEST(slides_2d) { try_all(2, false, BRUNT_CONTACT_AUGURY); }
END_TEST
START_TEST(slides_3d) { try_all(3, false, BRUNT_CONTACT_AUGURY); }
END_TEST
START_TEST(approaches_2d) { try_all(2, true, BRUNT_CONTACT_AUGURY); }
END_TEST
START_TEST(approaches_3d) { try_all(3, true, BRUNT_CONTACT_AUGURY); }
END_TEST
START_TEST(on_the_grid_2d) {
    try_all(2, false, BRUNT_CONTACT_MULTI_VELOCITY);
    try_all(2, true, BRUNT_CONTACT_MULTI_VELOCITY);
}
END_TEST
START_TEST(on_the_grid_3d) {
    try_all(3, false, BRUNT_CONTACT_MULTI_VELOCITY);
    try_all(3, true, BRUNT_CONTACT_MULTI_VELOCITY);
}
END_TEST

// ------------------------------------------------------------------------------------------ what flows, rolls and is
// fast

// A world of one mesh that is held, an element thick and with its upper side at 0; what else is in it follows.
static brunt_world_def over_held_mesh(double length, double friction) {
    const motion m = {.dim = 2};
    brunt_world_def def = def_begin(2, H);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_AUGURY, def.contact.friction = friction;
    def.gravity[1] = -GRAVITY;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    add_body(&def, &m, "floor", MESH, XYZ(-3 * H, 0, -H), XYZ(length, 0, 0), XYZ(0, 0, 0));
    drive(&def, &m, "floor", MESH, XYZ(0, 0, 0));
    return def;
}

// The lowest particle over `time`; below -1 at the first that is lower than that.
static double lowest(brunt_world *world, int body, double time) {
    double low = INFINITY;
    for (int k = 1; k <= 20 && low > -1; k++) {
        world_until(world, time * k / 20);
        low = fmin(low, end_of(world, &(motion){.dim = 2}, body, false) / H);
    }
    brunt_world_destroy(world);
    return low;
}

START_TEST(cylinder_rolls) {
    const double r = 4 * H;
    brunt_world_def def = over_held_mesh(30 * H, 0.5);
    brunt_body_def *b = def_ball(&def, "roller", XYZ(0, r + 0.01 * H, 0), r);
    def_velocity(b, 1, 0, 0);
    b->spin[2] = -1 / r, b->spin_about[1] = r + 0.01 * H;
    double low = lowest(world_take(&def), 1, 0.25);
    printf("lowest particle of a cylinder that rolls: %.4f of a cell over the mesh\n", low);
    ck_assert(low > 0);
}
END_TEST

START_TEST(column_falls) {
    brunt_world_def def = over_held_mesh(60 * H, 0);
    brunt_body_def *b = def_box(&def, "water", XYZ(0, 0.01 * H, 0), XYZ(8 * H, 16 * H, 0));
    b->material = def.material_count;
    brunt_material_def *water = &def.materials[def.material_count++];
    *water = brunt_material_def_default("water", "newtonian");
    brunt_error error = {0};
    water->density = 1000;
    ck_assert_int_eq(brunt_material_set(water, "dynamic_viscosity", 1e-3, NULL, &error), BRUNT_OK);
    ck_assert_int_eq(brunt_material_set(water, "eos", 0, "tait", &error), BRUNT_OK);
    ck_assert_int_eq(brunt_material_set(water, "eos.c0", 20, NULL, &error), BRUNT_OK);
    ck_assert_int_eq(brunt_material_set(water, "eos.tension", 0, NULL, &error), BRUNT_OK);
    def_plane(&def, XYZ(0, 0, 0), XYZ(1, 0, 0), BRUNT_SEPARATE, 0);
    double low = lowest(world_take(&def), 1, 0.3);
    printf("lowest particle of a column of water on a held mesh: %.4f of a cell\n", low);
    ck_assert(low > 0.2); // a particle reaches a quarter of one
}
END_TEST

// How far the lowest centre is behind a plane after the first blow [cells]. The plane goes most of a cell in a step, or
// it and the block together.
static double first_blow(bool both, double gap) {
    const double v = both ? 20 : 40; // [m/s] two and four times the wave speed
    brunt_world_def def = def_begin(2, H);
    def.cfl = 0.9;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    brunt_body_def *b = def_box(&def, "block", XYZ(0, gap, 0), XYZ(8 * H, gap + 10 * H, 0));
    if (both) def_velocity(b, 0, -v, 0);
    brunt_plane_def *p = def_plane(&def, XYZ(0, 0, 0), XYZ(0, 1, 0), BRUNT_SEPARATE, 0);
    p->velocity[1] = v;
    brunt_world *world = world_take(&def);
    while (world_boundary(world, 0).impulse[1] == 0) world_steps(world, 1);
    const double depth = v * brunt_world_time(world) - end_of(world, &(motion){.dim = 2}, 0, false);
    brunt_world_destroy(world);
    return depth / H;
}

START_TEST(fast_plane) {
    double deepest = -INFINITY;
    for (int k = 0; k < 10; k++) deepest = fmax(deepest, first_blow(_i == 1, (5 + 0.1 * k) * H));
    printf("a fast plane%s: centres %.4f cells behind it after the first blow\n", _i ? " that is met" : "", deepest);
    ck_assert(deepest < 0);
}
END_TEST

// The cells of the run that goes on were made for where the block was long ago, those of the other one just now.
START_TEST(restart_on_the_way) {
    motion m = {.dim = 2, .a = POINTS, .b = MESH, .b_moves = _i == 1, .method = BRUNT_CONTACT_AUGURY};
    brunt_world *one = begin(&m), *two = begin(&m);
    world_until(one, 0.37 * travel(&m) / SPEED);
    world_copy_state(one, two);
    world_until(one, travel(&m) / SPEED), world_until(two, travel(&m) / SPEED);
    for (int b = 0; b < 2; b++) {
        double *p = world_field(one, b, "position"), *q = world_field(two, b, "position");
        const int64_t n = brunt_body_nodes(one, b) + brunt_body_particles(one, b);
        ck_assert_int_eq(memcmp(p, q, (size_t)n * 3 * sizeof *p), 0);
        free(p), free(q);
    }
    brunt_world_destroy(one), brunt_world_destroy(two);
}
END_TEST

// A plate that is held together with a block that slides on it, both on their way at an edge and more a step, and a
// third body that flies across and hits the plate's end, or the block: what cells of facets were made for has gone far,
// some together and some not. `k`: which way they fly, and which body comes.
static brunt_world_def flying(int k) {
    const motion m = {.dim = 3, .turn = k % 3, .method = BRUNT_CONTACT_AUGURY};
    const double fly = k & 1 ? -20 : 20, across = k & 2 ? 20 : 0;
    brunt_world_def def = def_begin(3, H);
    def.contact.method = m.method;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    add_body(&def, &m, "plate", MESH, XYZ(0, 0, -H), XYZ(9 * H, 4 * H, 0), XYZ(fly, across, 0));
    add_body(&def, &m, "block", MESH, XYZ(0.3 * H, 0.4 * H, 0), XYZ(3.3 * H, 3.4 * H, 2 * H),
             XYZ(fly + 1, across, -0.5));
    const double from = k & 4 ? 5 * H : 0.5 * H, above = k & 4 ? 0.6 * H : 2.6 * H;
    add_body(&def, &m, "third", MESH, XYZ(from, 0.7 * H, above), XYZ(from + 2 * H, 2.7 * H, above + 2 * H),
             XYZ(fly, across, -3));
    turn(&m, XYZ(0, 0, -GRAVITY), def.gravity);
    return def;
}

// Each step is what one is that begins with nothing but the state.
START_TEST(cells_come_along) {
    brunt_world_def def = flying(_i);
    brunt_world *one = world_take(&def);
    int64_t met = 0;
    for (int step = 0; step < 120; step++) {
        brunt_world_def again = flying(_i);
        brunt_world *two = world_take(&again);
        world_copy_state(one, two);
        world_steps(one, 1), world_steps(two, 1);
        ck_assert_msg(brunt_world_hash(one) == brunt_world_hash(two), "flight %d: another step %d", _i, step);
        for (int p = 0; p < 3; p++) met += world_pair(one, p).area > 0;
        brunt_world_destroy(two);
    }
    printf("flight %d: %lld touches in %g s\n", _i, (long long)met, brunt_world_time(one));
    ck_assert_int_gt(met, 30);
    brunt_world_destroy(one);
}
END_TEST

// A body of pieces that do not touch each other, of which all but the first are held: its box stays where it is while
// the first one flies.
static void add_pieces(brunt_world_def *def, const char *name, const brunt_shape *piece, int count, const double v[3]) {
    brunt_body_def *b = def_body(def, name);
    brunt_mesh mesh = {.kind = BRUNT_HEX8, .nodes = brunt_def_alloc(3 * 600 * sizeof(double))};
    mesh.elements = brunt_def_alloc(8 * 600 * sizeof *mesh.elements),
    mesh.groups = brunt_def_alloc(sizeof *mesh.groups);
    brunt_group *held = &mesh.groups[mesh.group_count++];
    snprintf(held->name, sizeof held->name, "held");
    held->nodes = brunt_def_alloc(600 * sizeof *held->nodes);
    for (int p = 0; p < count; p++) {
        brunt_mesh one;
        ck_assert_int_eq(brunt_mesh_shape(&piece[p], 3, BRUNT_HEX8, H, &one, NULL), BRUNT_OK);
        ck_assert_int_le(mesh.node_count + one.node_count, 600);
        for (int32_t e = 0; e < 8 * one.element_count; e++)
            mesh.elements[8 * mesh.element_count + e] = mesh.node_count + one.elements[e];
        memcpy(mesh.nodes + mesh.node_count, one.nodes, (size_t)one.node_count * sizeof *one.nodes);
        for (int32_t n = 0; n < one.node_count && p > 0; n++) held->nodes[held->count++] = mesh.node_count + n;
        mesh.node_count += one.node_count, mesh.element_count += one.element_count;
        brunt_mesh_free(&one);
    }
    b->method = BRUNT_FEM, b->mesh = mesh;
    def_velocity(b, v[0], v[1], v[2]);
    brunt_group_def *g = &def->groups[def->group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "%s", name), snprintf(g->group, sizeof g->group, "held");
    for (int a = 0; a < 3; a++) g->component[a] = true;
}

static brunt_shape box_of(const double low[3], const double size[3]) {
    brunt_shape box = {.kind = BRUNT_BOX};
    for (int a = 0; a < 3; a++) box.min[a] = low[a] * H, box.max[a] = (low[a] + size[a]) * H;
    return box;
}

// Slabs that slide one way and the other along a plate, or one that falls on it from beyond where facets are looked
// for: posts, which are held, keep the boxes of their bodies where they are.
static brunt_world_def between_posts(int first, int end) {
    static const double v[3][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 0, -1}}, at[3] = {2.3, 12.4, 6.2}, high[3] = {0, 0, 1.7};
    brunt_world_def def = def_begin(3, H);
    def.groups = brunt_alloc(DEF_CAPACITY * sizeof *def.groups);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def_material(&def, "neo-hookean", 1000, 1e5, 0.3);
    const brunt_shape plate[] = {box_of(XYZ(8, 15, -1), XYZ(1, 1, 1)), box_of(XYZ(0, 0, -1), XYZ(18, 10, 1))};
    add_pieces(&def, "plate", plate, 2, XYZ(0, 0, 0));
    for (int k = first; k < end; k++) {
        const double y = 3.4 * k + 0.3;
        const brunt_shape piece[] = {box_of(XYZ(at[k], y, high[k]), XYZ(3, 2, 0.6)),
                                     box_of(XYZ(-3, y - 0.6, -1), XYZ(1, 3, 5)),
                                     box_of(XYZ(20, y - 0.6, -1), XYZ(1, 3, 5))};
        add_pieces(&def, (const char *[]){"one", "two", "three"}[k], piece, 3, v[k]);
    }
    def.gravity[2] = -GRAVITY;
    return def;
}

START_TEST(boxes_that_stay) {
    static const int slabs[][2] = {{0, 2}, {0, 1}, {1, 2}, {2, 3}};
    const int first = slabs[_i][0], end = slabs[_i][1], count = end - first;
    brunt_world_def def = between_posts(first, end);
    brunt_world *one = world_take(&def);
    int64_t met[3] = {0}; // of pairs
    for (int step = 0; step < 150; step++) {
        brunt_world_def again = between_posts(first, end);
        brunt_world *two = world_take(&again);
        world_copy_state(one, two);
        world_steps(one, 1), world_steps(two, 1);
        ck_assert_msg(brunt_world_hash(one) == brunt_world_hash(two), "another step %d", step);
        for (int p = 0; p < (count > 1 ? 3 : 1); p++) met[p] += world_pair(one, p).area > 0;
        brunt_world_destroy(two);
    }
    int pairs = 0;
    for (int p = 0; p < 3; p++) pairs += met[p] > 5;
    printf("between posts: %d pairs touch in %g s\n", pairs, brunt_world_time(one));
    ck_assert_int_eq(pairs, count);
    brunt_world_destroy(one);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("one_sided_motion");
    ADD(slides_2d);
    ADD(slides_3d);
    ADD(approaches_2d);
    ADD(approaches_3d);
    ADD(on_the_grid_2d);
    ADD(on_the_grid_3d);
    ADD(cylinder_rolls);
    ADD(column_falls);
    TCase *looped = tcase_create("fast_plane");
    tcase_add_loop_test(looped, fast_plane, 0, 2);
    tcase_add_loop_test(looped, restart_on_the_way, 0, 2);
    tcase_add_loop_test(looped, cells_come_along, 0, 8);
    tcase_add_loop_test(looped, boxes_that_stay, 0, 4);
    suite_add_tcase(suite, looped);
    return suite_main(suite);
}
