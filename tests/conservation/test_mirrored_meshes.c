// Given meshes, none of whose facets is level with another, do the same in a mirror, with axes that change places, and
// with bodies in the other order: blocks that erode each other, folded membranes that a block closes, or tears, and
// blocks in implicit steps.
//
// Steps are given: stable ones go by the fastest wave of a tile of elements, and which are in a tile hangs on their
// numbers.
#include "tests/support/reflected.h"

#include "tests/support/fem_bodies.h"

enum { EACH = 6, LOOKS = 8 };

typedef struct meeting {
    const char *name;
    brunt_element_kind kind[2];
    double strain, friction; // at which elements leave; of the contact
    bool keep;
    int steps, seed; // of the shifts of the nodes
    bool implicit;
} meeting;

static const meeting meetings[] = {
    {"tetrahedra erode hexahedra", {BRUNT_TET4, BRUNT_HEX8}, 0.3, 0, false, 120, 13, false},
    {"hexahedra folded over themselves", {BRUNT_TET4, BRUNT_HEX8}, 0.3, 0, false, 120, 6, false},
    {"hexahedra erode each other", {BRUNT_HEX8, BRUNT_HEX8}, 0.2, 0.3, false, 120, 7, false},
    {"debris of tetrahedra", {BRUNT_TET4, BRUNT_TET4}, 0.3, 0.3, true, 120, 19, false},
    {"a fold of quadrilaterals", {BRUNT_MEMBRANE_QUAD4, BRUNT_TET4}, INFINITY, 0.3, false, 240, 5, false},
    {"a fold of triangles", {BRUNT_MEMBRANE_TRI3, BRUNT_HEX8}, INFINITY, 0, false, 240, 17, false},
    {"another of triangles", {BRUNT_MEMBRANE_TRI3, BRUNT_HEX8}, INFINITY, 0, false, 240, 5, false},
    {"a fold that tears", {BRUNT_MEMBRANE_TRI3, BRUNT_HEX8}, 0.05, 0.3, false, 240, 3, false},
    {"debris of a fold", {BRUNT_MEMBRANE_QUAD4, BRUNT_TET4}, 0.05, 0.3, true, 240, 4, false},
    {"blocks in implicit steps", {BRUNT_TET4, BRUNT_HEX8}, INFINITY, 0.3, false, 16, 2, true},
};
enum { MEETINGS = sizeof meetings / sizeof *meetings };

static bool is_handed(const reflection *r) {
    const bool even = r->from[1] == (r->from[0] + 1) % AXES;
    return even == (r->sign[0] * r->sign[1] * r->sign[2] > 0);
}

// The same elements in a mirror, with their corners in the order that goes round them.
static void turn_over(brunt_mesh *mesh) {
    static const int order[BRUNT_ELEMENT_KINDS][BRUNT_ELEMENT_NODES] = {[BRUNT_TET4] = {1, 0, 2, 3},
                                                                        [BRUNT_HEX8] = {0, 3, 2, 1, 4, 7, 6, 5},
                                                                        [BRUNT_MEMBRANE_QUAD4] = {0, 3, 2, 1},
                                                                        [BRUNT_MEMBRANE_TRI3] = {0, 2, 1}};
    const int nodes = brunt_element_nodes(mesh->kind);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int32_t *own = mesh->elements + e * nodes, was[BRUNT_ELEMENT_NODES];
        memcpy(was, own, (size_t)nodes * sizeof *own);
        for (int c = 0; c < nodes; c++) own[c] = was[order[mesh->kind][c]];
    }
}

static void reflect_mesh(brunt_mesh *mesh, const reflection *r) {
    for (int32_t n = 0; n < mesh->node_count; n++) {
        double x[AXES];
        memcpy(x, mesh->nodes[n], sizeof x);
        reflect(r, x, mesh->nodes[n]);
    }
    if (!is_handed(r)) turn_over(mesh);
}

// A sheet in the form of a U that lies on its side, open towards -x, its arms 0.2 apart; askew and uneven.
static brunt_mesh fold_mesh(brunt_element_kind kind) {
    enum { ALONG = 14, ACROSS = 6, ROW = ACROSS + 1 };
    const int corners = brunt_element_nodes(kind);
    brunt_mesh mesh = {.kind = kind, .node_count = (ALONG + 1) * ROW, .element_count = ALONG * ACROSS * (5 - corners)};
    mesh.nodes = brunt_alloc((size_t)mesh.node_count * sizeof *mesh.nodes);
    mesh.elements = brunt_alloc((size_t)(mesh.element_count * corners) * sizeof *mesh.elements);
    int32_t *out = mesh.elements;
    for (int i = 0, k = 0; i <= ALONG; i++)
        for (int j = 0; j <= ACROSS; j++, k++) {
            const double u = 6.0 * i / ALONG - 3, turn = fmax(-1, fmin(1, u)) * PI / 2; // the middle third is the bend
            const double x[3] = {0.1 * cos(turn) - 0.35 * fmax(0, fabs(u) - 1), 0.7 * j / ACROSS - 0.35 + 0.04 * u,
                                 0.1 * sin(turn)};
            for (int a = 0; a < 3; a++) mesh.nodes[k][a] = x[a] + 0.01 * uniform(-1, 1);
            if (i == ALONG || j == ACROSS) continue;
            const int32_t corner[4] = {k, k + ROW, k + ROW + 1, k + 1};
            for (int c = 0; c < 4 && corners == 4; c++) *out++ = corner[c];
            for (int p = 0; p < 2 && corners == 3; p++)
                for (int c = 0; c < 3; c++) *out++ = corner[triangle_of_square[p][c]];
        }
    return mesh;
}

static brunt_body_def *def_mesh(brunt_world_def *def, const char *name, const meeting *m, int k, const reflection *r) {
    static const double low[2][AXES] = {{-0.75, -0.36, -0.41}, {0.03, -0.25, -0.37}}, over[AXES] = {-0.8, -0.3, 0.12},
                        fast[2][AXES] = {{3, 2, -1}, {-45, 7, 12}}, down[AXES] = {2, -3, -15};
    const bool fold = m->kind[0] >= BRUNT_MEMBRANE_QUAD4, sheet = fold && k == 0;
    brunt_body_def *b = def_body(def, name);
    b->method = sheet ? BRUNT_MEMBRANE : BRUNT_FEM;
    b->mesh = sheet ? fold_mesh(m->kind[k]) : box_mesh(m->kind[k], EACH, 0.75, 0.12, true);
    b->thickness = sheet ? 0.01 : 0;
    for (int32_t n = 0; n < b->mesh.node_count && !sheet; n++)
        for (int a = 0; a < AXES; a++) b->mesh.nodes[n][a] += fold ? over[a] : low[k][a];
    double v[AXES] = {0};
    if (!sheet) reflect(r, fold ? down : fast[k], v);
    def_velocity(b, v[0], v[1], v[2]);
    reflect_mesh(&b->mesh, r);
    b->erosion.strain = fold && !sheet ? INFINITY : m->strain, b->erosion.keep = m->keep,
    b->erosion.inverted = b->erosion.strain < INFINITY;
    return b;
}

static brunt_world *meet(const meeting *m, const reflection *r) {
    brunt_world_def def = def_begin(3, 0);
    const bool fold = m->kind[0] >= BRUNT_MEMBRANE_QUAD4;
    def_material(&def, "neo-hookean", 1000, fold ? 2e6 : 1e7, 0.3);
    def.contact.method = BRUNT_CONTACT_AUGURY, def.contact.friction = m->friction, def.step = fold ? 1.5e-4 : 1e-4;
    if (m->implicit) {
        def.scheme = BRUNT_IMPLICIT, def.contact.method = BRUNT_CONTACT_BARRIER, def.contact.distance = 0.01;
        def.newton.tolerance = 1e-10, def.step = fold ? 2.5e-3 : 5e-4;
    }
    random_state = m->seed;
    for (int k = 0; k < 2; k++) def_mesh(&def, k == r->swap ? "a" : "b", m, k, r);
    if (fold) {
        def.contact.pairs = brunt_alloc(sizeof *def.contact.pairs), def.contact.pair_count = 1;
        brunt_pair_def *p = &def.contact.pairs[0];
        *p = (brunt_pair_def){.method = def.contact.method, .friction = m->friction};
        snprintf(p->a, sizeof p->a, "%s", r->swap ? "b" : "a"), snprintf(p->b, sizeof p->b, "%s", p->a);
    }
    return world_take(&def);
}

START_TEST(meshes_do_as_in_a_mirror) {
    const meeting *m = &meetings[_i];
    if (m->implicit && sizeof(real) != sizeof(double)) return; // they want double precision
    outcome as[LOOKS];
    brunt_world *world = meet(m, &plain);
    const double energy = world_energy(world).initial;
    double momentum = 0, pressed = 0;
    for (int k = 0; k < 2; k++)
        for (int a = 0; a < AXES; a++) momentum = fmax(momentum, fabs(world_sums(world, k).momentum[a]));
    for (int k = 0; k < LOOKS; k++) {
        world_steps(world, m->steps / LOOKS);
        as[k] = outcome_of(world, &plain);
        pressed = fmax(pressed, as[k].energy[2]);
    }
    brunt_eroded gone[2];
    for (int k = 0; k < 2; k++) brunt_body_eroded(world, k, &gone[k]);
    const int64_t left = gone[0].elements + gone[1].elements;
    printf("  %s: %lld elements have left, contact %.1e of the energy\n", m->name, (long long)left, pressed / energy);
    ck_assert(left > 20 || m->strain == INFINITY);
    ck_assert_double_gt(pressed, (m->implicit ? 2e-3 : 0.01) * energy); // they have met; barriers are soft
    brunt_world_destroy(world);
    for (int i = 0; i < REFLECTIONS; i++) {
        double most = 0;
        world = meet(m, &reflections[i]);
        for (int k = 0; k < LOOKS; k++) {
            world_steps(world, m->steps / LOOKS);
            const outcome now = outcome_of(world, &reflections[i]);
            most = fmax(most, greatest_between(&now, &as[k], energy, momentum));
        }
        brunt_world_destroy(world);
        printf("    %s: differs by %.1e\n", reflections[i].name, most);
        ck_assert_double_le(most, sizeof(real) == sizeof(double) ? 1e-10 : 1e-3);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("mirrored meshes");
    ADD_LOOP(meshes_do_as_in_a_mirror, MEETINGS);
    return suite_main(suite);
}
