// Labels: conservation
//
// Elements that leave their bodies: what goes with them is booked to rounding, what is left goes on.
#include "tests/support/def_world.h"

#include "tests/support/hard_case.h"
#include "world/world.h"

static const double E = 1e7, NU = 0.3, DENSITY = 1000;

static const struct {
    int dimension;
    brunt_element_kind kind;
    bool axisymmetric;
} kinds[] = {{2, BRUNT_TRI3, false}, {2, BRUNT_QUAD4, false},         {3, BRUNT_TET4, false},
             {3, BRUNT_HEX8, false}, {3, BRUNT_MEMBRANE_TRI3, false}, {2, BRUNT_TRI3, true},
             {2, BRUNT_QUAD4, true}, {3, BRUNT_MEMBRANE_QUAD4, false}};
enum { SOLIDS = 4, KINDS = sizeof kinds / sizeof kinds[0], MAY_INVERT = KINDS - 1 };

static brunt_body_def *block(brunt_world_def *def, int k, const double min[3], const double max[3], double size) {
    const bool sheet = kinds[k].kind == BRUNT_MEMBRANE_TRI3 || kinds[k].kind == BRUNT_MEMBRANE_QUAD4;
    brunt_body_def *body = def_box(def, "block", min, max);
    body->method = sheet ? BRUNT_MEMBRANE : BRUNT_FEM, body->element = kinds[k].kind, body->size = size;
    if (!sheet) return body;
    body->thickness = 0.01;
    body->faces = brunt_alloc(sizeof *body->faces);
    body->face_count = 1;
    snprintf(body->faces[0], sizeof body->faces[0], "zmax");
    return body;
}

// A body that turns, flies and swings; of metal where it can be.
static brunt_world_def thrown(int k, brunt_hourglass hourglass) {
    const bool sheet = kinds[k].kind >= BRUNT_MEMBRANE_QUAD4, rings = kinds[k].axisymmetric;
    brunt_world_def def = def_begin(kinds[k].dimension, 0);
    def.axisymmetric = rings;
    brunt_error error = {0};
    brunt_material_def *m = &def.materials[def.material_count++];
    *m = brunt_material_def_default("m", sheet ? "neo-hookean" : "von-mises");
    brunt_material_set(m, "density", DENSITY, NULL, &error);
    brunt_material_set(m, "E", E, NULL, &error);
    brunt_material_set(m, "nu", NU, NULL, &error);
    if (!sheet) brunt_material_set(m, "yield", 0.01 * E, NULL, &error);
    ck_assert_msg(error.code == BRUNT_OK, "%s", error.message);
    const double size = kinds[k].dimension == 2 || sheet ? 0.06 : 0.125;
    brunt_body_def *body = block(&def, k, XYZ(1, 2, 3), XYZ(2, 3, sheet ? 3.01 : 4), size);
    body->hourglass = sheet ? BRUNT_HOURGLASS_STIFFNESS : hourglass;
    def_velocity(body, rings ? 0 : 3, -2, kinds[k].dimension == 3 ? 1 : 0);
    body->spin[2] = rings ? 0 : 5;
    if (kinds[k].dimension == 3) body->spin[0] = -3;
    for (int a = 0; a < kinds[k].dimension; a++)
        body->wave_velocity[a] = 2 - 0.7 * a, body->wave_vector[a] = a == 1 ? -7 : 5;
    body->erosion.inverted = true; // which does not happen here: it only makes the body one that erodes
    def.cfl = 0.5;
    return def;
}

static uint32_t random_state;
static uint32_t random_below(uint32_t n) {
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)random_state * n) >> 32);
}

static void mark(brunt_fem_body *fem, int32_t slot) {
    int32_t b = 0;
    while (b + 1 < fem->block_count && fem->block[b + 1].first <= slot) b++;
    if (fem->mark[slot] != BRUNT_MARK_NONE) return;
    fem->mark[slot] = BRUNT_MARK_FAILED;
    fem->report[b].marked++;
}

static void mark_random(brunt_fem_body *fem, int32_t count) {
    for (int32_t i = 0; i < count && fem->element_count > 0; i++) {
        int32_t slot;
        do slot = (int32_t)random_below((uint32_t)fem->slots);
        while (fem->element_id[slot] < 0);
        mark(fem, slot);
    }
}

static void erode(brunt_world *world) {
    brunt_error error = {0};
    ck_assert_msg(brunt_erode_marked(world, brunt_world_dt(world), &error) == BRUNT_OK, "%s", error.message);
}

static brunt_eroded eroded_of(const brunt_world *world) {
    brunt_eroded e;
    brunt_body_eroded(world, 0, &e);
    return e;
}

// What the ledger counts of a mesh, node by node and from the forces on nodes: kinetic energy, the half step of the
// internal forces, stored energy with the springs.
typedef struct audit {
    double energy, mass, p[3], h[3];
} audit;

static audit audit_of(brunt_world *world) {
    brunt_fem_body *fem = &world->bodies.fem[0];
    audit a = {.energy = brunt_fem_energy(fem, 0, fem->block_count).internal};
    for (int32_t b = 0; b < fem->block_count; b++) a.energy += fem->report[b].hourglass_stored;
    for (int32_t n = 0; n < fem->node_count; n++) {
        const real *node = brunt_fem_node(fem, n);
        const double m = (double)node[BRUNT_FEM_MASS];
        real force[3];
        brunt_fem_internal_force(fem, n, force);
        a.mass += m;
        for (int i = 0; i < 3; i++) {
            const double v = (double)node[BRUNT_FEM_V + i];
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            a.energy += 0.5 * m * v * v + 0.5 * brunt_world_dt(world) * (double)force[i] * v;
            a.p[i] += m * v;
            a.h[i] +=
                m * ((double)node[j] * (double)node[BRUNT_FEM_V + k] - (double)node[k] * (double)node[BRUNT_FEM_V + j]);
        }
    }
    if (world->settings.axisymmetric) a.p[0] = a.h[2] = 0; // of whole rings
    return a;
}

static const double EXACT = sizeof(real) == 4 ? 3e-6 : 1e-13; // of what there is

// The ledger before and after, and what the account says against what is missing.
static void check_accounts(brunt_world *world, const brunt_energy *e, const brunt_momentum *m, const brunt_eroded *c,
                           const audit *a, const double scale[3]) {
    brunt_energy f = world_energy(world);
    brunt_momentum n = world_momentum(world);
    brunt_eroded d = eroded_of(world);
    audit b = audit_of(world);
    ck_assert_double_lt(fabs(f.total - e->total), EXACT * scale[0]);
    ck_assert_double_lt(fabs(f.error - e->error), EXACT * scale[0]);
    ck_assert_double_lt(fabs((d.energy - c->energy) - (a->energy - b.energy)), EXACT * scale[0]);
    ck_assert_double_lt(fabs(f.plastic - e->plastic), EXACT * scale[0]);
    ck_assert_double_lt(fabs((d.mass - c->mass) - (a->mass - b.mass)), EXACT * a->mass);
    ck_assert_double_lt(n.linear_drift, ROUNDING);
    ck_assert_double_lt(n.angular_drift, ROUNDING);
    for (int i = 0; i < 3; i++) {
        ck_assert_double_lt(fabs((d.momentum[i] - c->momentum[i]) - (a->p[i] - b.p[i])), EXACT * scale[1]);
        ck_assert_double_lt(fabs((d.angular[i] - c->angular[i]) - (a->h[i] - b.h[i])), EXACT * scale[2]);
        ck_assert_double_lt(fabs((n.linear[i] - n.linear_impulse[i]) - (m->linear[i] - m->linear_impulse[i])),
                            EXACT * scale[1]);
    }
}

// 1000 erosions over all kinds of elements, with both kinds of hourglass control, of bodies that move and deform.
START_TEST(random_erosions_are_accounted) {
    const int k = _i % KINDS;
    brunt_world_def def = thrown(k, _i < KINDS ? BRUNT_HOURGLASS_STIFFNESS : BRUNT_HOURGLASS_VISCOUS);
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    random_state = (uint32_t)_i + 1;
    const int64_t start = brunt_body_elements(world, 0);
    double worst = 0;
    world_steps(world, 10);
    const audit whole = audit_of(world);
    const double scale[3] = {whole.energy, whole.mass * 10, whole.mass * 50};
    // One to three at a time; then, so that many nodes go, half of what there is.
    for (int bulk = 0; bulk < 4; bulk += eroded_of(world).elements >= 100) {
        brunt_energy e = world_energy(world);
        brunt_momentum m = world_momentum(world);
        brunt_eroded c = eroded_of(world);
        audit a = audit_of(world);
        mark_random(fem, bulk ? fem->element_count / 2 : 1 + (int32_t)random_below(3));
        erode(world);
        check_accounts(world, &e, &m, &c, &a, scale);
        worst = fmax(worst, fabs(world_energy(world).total - e.total) / scale[0]);
        world_steps(world, 2);
        ck_assert_double_lt(fabs(world_energy(world).error_relative), 0.02);
    }
    ck_assert_int_gt(eroded_of(world).nodes, brunt_body_nodes(world, 0) / 20);
    brunt_eroded c = eroded_of(world);
    printf("erosion, %s %s: %lld of %lld elements, %lld nodes, energy jumps by %.1e at most, error %.1e\n",
           brunt_element_name(kinds[k].kind), _i < KINDS ? "stiffness" : "viscous", (long long)c.elements,
           (long long)start, (long long)c.nodes, worst, world_energy(world).error_relative);
    ck_assert_int_eq(brunt_body_elements(world, 0), start - c.elements);
    ck_assert_int_eq(c.failed, c.elements);
    ck_assert_double_gt(c.energy, 0);
    brunt_world_destroy(world);
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}
END_TEST

// The order of what is left: ids once each, padding copies without volume, bonds and places in blocks as they would be
// counted anew.
static void check_order(const brunt_fem_body *fem) {
    const int nodes = fem->traits->nodes;
    int32_t *bonds = calloc((size_t)fem->node_count, sizeof *bonds), live = 0;
    uint8_t *seen = calloc((size_t)fem->mesh_elements, 1);
    const real *volume = fem->scalar[fem->field[BRUNT_ELEMENT_reference_volume].first];
    for (int32_t b = 0; b < fem->block_count; b++) {
        const brunt_fem_block *block = &fem->block[b];
        const int32_t end = b + 1 < fem->block_count ? fem->block[b + 1].first : fem->slots;
        for (int32_t s = block->first; s < end; s++) {
            const bool real_one = s < block->first + block->count;
            ck_assert_int_eq(fem->element_id[s] >= 0, real_one);
            ck_assert_int_eq(volume[s] > 0, real_one);
            for (int a = 0; a < nodes; a++) {
                const int32_t n = fem->element_node[s * nodes + a];
                ck_assert_int_eq(fem->block_node[block->node_first + fem->local[s * nodes + a]], n);
                bonds[n] += real_one;
            }
            if (!real_one) continue;
            ck_assert_int_eq(seen[fem->element_id[s]]++, 0);
            live++;
        }
    }
    ck_assert_int_eq(live, fem->element_count);
    for (int32_t n = 0; n < fem->node_count; n++) ck_assert_int_eq(bonds[n], fem->bonds[n]);
    free(bonds);
    free(seen);
}

START_TEST(order_is_kept) {
    brunt_world_def def = thrown(_i, BRUNT_HOURGLASS_STIFFNESS);
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    while (fem->element_count > 0) {
        mark_random(fem, 1 + fem->element_count / 3);
        erode(world);
        check_order(fem);
    }
    brunt_world_destroy(world);
}
END_TEST

// Read by number, ascending, whatever lies where in memory.
START_TEST(readers_see_what_is_left) {
    brunt_world_def def = thrown(_i, BRUNT_HOURGLASS_STIFFNESS);
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    const int nodes = fem->traits->nodes;
    const int64_t start = brunt_body_elements(world, 0);
    int32_t *before = malloc((size_t)(start * nodes) * sizeof *before),
            *after = malloc((size_t)(start * nodes) * sizeof *after);
    brunt_body_connectivity(world, 0, before);
    mark_random(fem, 20);
    erode(world);
    brunt_body_connectivity(world, 0, after);
    double *id = world_field(world, 0, "element"), *volume = world_field(world, 0, "volume");
    const int64_t count = brunt_body_elements(world, 0);
    ck_assert_int_lt(count, start);
    ck_assert_int_eq(brunt_body_size(world, 0, BRUNT_AT_ELEMENTS), count);
    for (int64_t e = 0; e < count; e++) {
        if (e) ck_assert_double_gt(id[e], id[e - 1]);
        ck_assert_double_gt(volume[e], 0);
        ck_assert_mem_eq(after + e * nodes, before + (int64_t)id[e] * nodes, (size_t)nodes * sizeof *after);
    }
    free(id), free(volume), free(before), free(after);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ by strain

// A bar whose halves fly apart; it tears where it is drawn most, in the middle.
static brunt_world_def torn(int k, bool keep) {
    brunt_world_def def = def_begin(kinds[k].dimension, 0);
    def_material(&def, "neo-hookean", DENSITY, E, NU);
    brunt_body_def *body = block(&def, k, XYZ(-1, -0.1, -0.1), XYZ(1, 0.1, 0.1), 0.1);
    body->wave_velocity[0] = 60, body->wave_vector[0] = PI / 2;
    body->erosion.strain = 0.4;
    body->erosion.keep = keep;
    def.cfl = 0.7;
    return def;
}

START_TEST(bar_tears_in_two) {
    brunt_world_def def = torn(_i, false);
    brunt_world *world = world_take(&def);
    const brunt_body_sums start = world_sums(world, 0);
    world_until(world, 0.02);
    const brunt_eroded c = eroded_of(world);
    const brunt_momentum m = world_momentum(world);
    double half[2] = {0}, low = -INFINITY, high = INFINITY;
    const brunt_fem_body *fem = &world->bodies.fem[0];
    for (int32_t n = 0; n < fem->node_count; n++) {
        const real *node = brunt_fem_node(fem, n);
        if (brunt_fem_removed(fem, n)) continue;
        half[node[0] > 0] += (double)(node[BRUNT_FEM_MASS] * node[BRUNT_FEM_V]);
        if (node[0] > 0)
            high = fmin(high, (double)node[0]);
        else
            low = fmax(low, (double)node[0]);
    }
    printf("torn bar, %s: %lld elements, gap %.3f m, momenta %.4f %.4f, lost %.2e, energy error %.1e\n",
           brunt_element_name(kinds[_i].kind), (long long)c.elements, high - low, half[0], half[1], c.momentum[0],
           world_energy(world).error_relative);
    ck_assert_int_gt(c.strained, 0);
    ck_assert_int_eq(c.strained, c.elements);
    ck_assert_double_gt(high - low, 0.5);
    ck_assert_double_gt(half[1], 0.2 * start.mass / 2 * 60);
    ck_assert_double_lt(fabs(half[0] + half[1] + c.momentum[0] - m.linear_initial[0]), ROUNDING * half[1]);
    ck_assert_double_lt(m.linear_drift, ROUNDING);
    ck_assert_double_lt(m.angular_drift, ROUNDING);
    ck_assert_double_lt(fabs(world_energy(world).error_relative), 0.01);
    brunt_world_destroy(world);
}
END_TEST

// With `keep` no mass is lost: nodes fly on at the velocity they had, and only stored energy leaves.
START_TEST(kept_nodes_fly_on) {
    brunt_world_def def = torn(_i, true);
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    const double mass = world_sums(world, 0).mass;
    mark_random(fem, 1 + fem->element_count / 2);
    erode(world);
    const brunt_eroded c = eroded_of(world);
    ck_assert_int_gt(c.nodes, 0);
    ck_assert_double_eq(c.mass, 0);
    int32_t loose = 0;
    while (loose < fem->node_count && fem->bonds[loose]) loose++;
    ck_assert_int_lt(loose, fem->node_count);
    const double x = (double)brunt_fem_node(fem, loose)[0], v = (double)brunt_fem_node(fem, loose)[BRUNT_FEM_V];
    world_until(world, 0.005);
    ck_assert_double_eq((double)brunt_fem_node(fem, loose)[BRUNT_FEM_V], v);
    ck_assert_double_eq_tol((double)brunt_fem_node(fem, loose)[0], x + 0.005 * v, 1e-5);
    ck_assert_double_eq_tol(world_sums(world, 0).mass, mass, mass * ROUNDING);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// sqrt(2/3 e:e) of pure shear, uniaxial stretch in plane strain: to the last digit before and after the limit.
START_TEST(strain_is_the_equivalent_logarithmic_one) {
    for (int side = -1; side <= 1; side += 2)
        for (int shear = 0; shear < (kinds[_i].kind >= BRUNT_MEMBRANE_QUAD4 ? 3 : 2); shear++) {
            brunt_world_def def = thrown(_i, BRUNT_HOURGLASS_STIFFNESS);
            def.bodies[0].erosion.strain = 0.3;
            brunt_world *world = world_take(&def);
            brunt_fem_body *fem = &world->bodies.fem[0];
            // ln of the stretches: (a, -a, 0) has 2 a / sqrt 3; (a, 0, 0) has 2 a / 3.
            const double eps = sizeof(real) == 4 ? 1e-4 : 1e-9;
            const double a = 0.3 * (1 + side * eps) * (shear ? sqrt(3) / 2 : 1.5);
            real *const *F = brunt_element_scalars(fem, BRUNT_ELEMENT_deformation_gradient);
            const int dim = fem->point_dim;
            const int32_t slot = fem->block[0].first;
            const double turn = fem->traits->membrane ? 0 : 0.7, c = cos(turn), s = sin(turn);
            const double l1 = exp(a), l2 = shear == 1 ? exp(-a) : 1; // the third, F_33 or across a sheet, is 1 ...
            if (shear == 2)                                          // ... or a sheet's gets thinner instead
                brunt_element_scalars(fem, BRUNT_ELEMENT_thickness_stretch)[0][slot] = (real)exp(-a);
            F[0][slot] = (real)(c * l1), F[1][slot] = (real)(-s * l2);
            F[dim][slot] = (real)(s * l1), F[dim + 1][slot] = (real)(c * l2);
            brunt_fem_mark_strained(fem, 0, 0.3);
            ck_assert_int_eq(fem->mark[slot], side > 0 ? BRUNT_MARK_STRAINED : BRUNT_MARK_NONE);
            ck_assert_int_eq(fem->report[0].marked, side > 0);
            brunt_world_destroy(world);
        }
}
END_TEST

// ------------------------------------------------------------------------------------------ by failure

// Johnson-Cook damage with a constant fracture strain: elements go when theirs has reached it, with what they have
// dissipated left in the ledger. `soften` does not erode.
START_TEST(failed_elements_go) {
    for (int soften = 0; soften < 2; soften++) {
        brunt_world_def def = torn(_i, false);
        brunt_error error = {0};
        brunt_material_def *m = &def.materials[0];
        *m = brunt_material_def_default("m", "johnson-cook");
        brunt_material_set(m, "density", DENSITY, NULL, &error);
        brunt_material_set(m, "E", E, NULL, &error);
        brunt_material_set(m, "nu", NU, NULL, &error);
        brunt_material_set(m, "A", 0.02 * E, NULL, &error);
        brunt_material_set(m, "B", 0.05 * E, NULL, &error);
        brunt_material_set(m, "n", 0.5, NULL, &error);
        brunt_material_set(m, "melt", 1000, NULL, &error);
        brunt_material_set(m, "heat_capacity", 500, NULL, &error);
        brunt_material_set(m, "failure", 0, "johnson-cook-damage", &error);
        brunt_material_set(m, "failure.d1", 0.2, NULL, &error);
        if (soften) {
            brunt_material_set(m, "eos", 0, "mie-gruneisen", &error);
            brunt_material_set(m, "eos.c0", 100, NULL, &error);
            brunt_material_set(m, "eos.s", 1.5, NULL, &error);
            brunt_material_set(m, "eos.gamma0", 1.5, NULL, &error);
            brunt_material_set(m, "failure.action", 0, "soften", &error);
        }
        ck_assert_msg(error.code == BRUNT_OK, "%s", error.message);
        def.bodies[0].erosion.strain = INFINITY;
        brunt_world *world = world_take(&def);
        ck_assert_int_eq(world->erosion.active, !soften);
        while (brunt_world_time(world) < 0.01) {
            const brunt_eroded c = eroded_of(world);
            const brunt_energy e = world_energy(world);
            world_steps(world, 1);
            const brunt_energy f = world_energy(world);
            if (eroded_of(world).elements > c.elements) {
                ck_assert_double_ge(f.plastic, e.plastic * (1 - 1e-9));
                ck_assert_double_ge(f.heat, e.heat * (1 - 1e-9));
            }
            if (!soften) {
                double *damage = world_field(world, 0, "damage");
                for (int64_t k = 0; k < brunt_body_elements(world, 0); k++) ck_assert_double_lt(damage[k], 1);
                free(damage);
            }
        }
        const brunt_eroded c = eroded_of(world);
        const brunt_energy e = world_energy(world);
        printf("failed, %s: %lld elements, %lld left, %lld nodes, eroded %.3g J, plastic %.3g J, energy error %.1e\n",
               brunt_element_name(kinds[_i].kind), (long long)c.failed, (long long)brunt_body_elements(world, 0),
               (long long)c.nodes, c.energy, e.plastic, e.error_relative);
        ck_assert_int_eq(c.failed > 0, !soften);
        ck_assert_int_eq(c.failed, c.elements);
        ck_assert_double_lt(fabs(e.error_relative), 0.02);
        ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
        ck_assert_double_lt(world_momentum(world).angular_drift, ROUNDING);
        brunt_world_destroy(world);
    }
}
END_TEST

// ------------------------------------------------------------------------------------------ same bits

// One and two threads; a new world that takes up the state in the middle; an old one that is wound back to it.
START_TEST(threads_and_restarts_change_no_bit) {
    brunt_world_def def = torn(_i, false);
    def.gravity[1] = -9.81;
    brunt_world *one = world_from(&def), *third = world_from(&def);
    def.threads = 2;
    brunt_world *two = world_take(&def);
    while (!eroded_of(one).elements) world_steps(one, 1), world_steps(two, 1);
    const int64_t first = eroded_of(one).elements;
    world_steps(third, 3);
    world_copy_state(one, third);
    ck_assert(brunt_world_hash(third) == brunt_world_hash(one));
    for (int s = 0; s < 60; s++) {
        world_steps(one, 1), world_steps(two, 1), world_steps(third, 1);
        ck_assert(brunt_world_hash(one) == brunt_world_hash(two));
        ck_assert(brunt_world_hash(one) == brunt_world_hash(third));
    }
    ck_assert_int_gt(eroded_of(one).elements, first);
    brunt_eroded a = eroded_of(one), b = eroded_of(two), c = eroded_of(third);
    ck_assert_mem_eq(&a, &b, sizeof a);
    ck_assert_mem_eq(&a, &c, sizeof a);
    ck_assert_double_eq(world_energy(one).total, world_energy(third).total);
    brunt_world *fresh = two; // which has gone on since
    world_steps(fresh, 20);
    world_copy_state(one, fresh);
    world_steps(one, 5), world_steps(fresh, 5);
    ck_assert(brunt_world_hash(one) == brunt_world_hash(fresh));
    brunt_world_destroy(one);
    brunt_world_destroy(two);
    brunt_world_destroy(third);
}
END_TEST

START_TEST(foreign_elements_are_refused) {
    brunt_world_def def = torn(3, false);
    brunt_world *world = world_take(&def);
    brunt_state_block info = brunt_state_info(world, 1);
    ck_assert_str_eq(info.name, "bodies/block/elements");
    int64_t *values = malloc((size_t)info.count * sizeof *values);
    const uint64_t hash = brunt_world_hash(world);
    brunt_error error;
    for (int q = 0; q < 4; q++) {
        brunt_state_get(world, 1, values);
        if (q == 0) values[0] = values[1];
        if (q == 1) values[0] = brunt_body_elements(world, 0);
        if (q == 2) values[info.count - 1] = brunt_body_nodes(world, 0);
        if (q == 3) values[0] = -1;
        ck_assert_int_eq(brunt_state_set(world, 1, values, info.count, &error), BRUNT_BAD_INPUT);
        ck_assert(brunt_world_hash(world) == hash);
    }
    free(values);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ inside out, and short
// steps

// A soft block is driven into itself, so much faster than sound that elements close within a step.
static brunt_world_def crushed(int k, brunt_hourglass hourglass) {
    brunt_world_def def = def_begin(kinds[k].dimension, 0);
    def_material(&def, "neo-hookean", DENSITY, E, NU);
    brunt_body_def *body = block(&def, k, XYZ(-0.5, -0.2, -0.2), XYZ(0.5, 0.2, 0.2), 0.1);
    body->hourglass = hourglass;
    body->wave_velocity[0] = -600, body->wave_vector[0] = PI;
    def.cfl = 0.9;
    return def;
}

START_TEST(inverted_elements_are_an_error_or_go) {
    const int k = _i % SOLIDS;
    const brunt_hourglass hourglass = _i < SOLIDS ? BRUNT_HOURGLASS_STIFFNESS : BRUNT_HOURGLASS_VISCOUS;
    brunt_world_def def = crushed(k, hourglass);
    brunt_world *world = world_from(&def);
    brunt_error error = {0};
    while (brunt_world_time(world) < 0.01 && !brunt_world_step(world, 0.01, &error)) {}
    ck_assert_int_eq(error.code, BRUNT_FAILED);
    ck_assert_msg(strstr(error.message, "inside out") && strstr(error.message, "erosion.inverted"), "%s",
                  error.message);
    ck_assert_str_eq(error.body, "block");
    ck_assert_int_ge(error.id, 0);
    brunt_world_destroy(world);
    def.bodies[0].erosion.inverted = true;
    world = world_take(&def);
    world_until(world, 0.01);
    const brunt_eroded c = eroded_of(world);
    printf("inverted, %s: %lld elements, %lld left\n", brunt_element_name(kinds[k].kind), (long long)c.inverted,
           (long long)brunt_body_elements(world, 0));
    ck_assert_int_gt(c.inverted, 0);
    ck_assert_int_eq(c.inverted, c.elements);
    hard_case("C10", world_momentum(world).linear_drift, ROUNDING, ROUNDING, "%s, %s: drift of momentum with what went",
              brunt_element_name(kinds[k].kind), _i < SOLIDS ? "springs" : "viscous");
    ck_assert_double_lt(world_momentum(world).angular_drift, ROUNDING);
    ck_assert(isfinite(world_energy(world).total) && isfinite(world_energy(world).hourglass));
    brunt_world_destroy(world);
}
END_TEST

// Within a step a corner goes to the far side of the opposite one ...
static void shoot(brunt_fem_body *fem, double dt) {
    for (int a = 0; a < fem->dim; a++) {
        const double x = (double)brunt_fem_node(fem, 0)[a];
        double middle = 0;
        for (int32_t n = 0; n < fem->node_count; n++) middle += (double)brunt_fem_node(fem, n)[a] / fem->node_count;
        brunt_fem_node(fem, 0)[BRUNT_FEM_V + a] = (real)(12 * (middle - x) / dt);
    }
}

// ... or all of them to a line, since a sheet has no inside. (That of a quadrilateral keeps an area, by its warp.)
static void flatten(brunt_fem_body *fem, double dt) {
    for (int32_t n = 0; n < fem->node_count; n++) {
        real *node = brunt_fem_node(fem, n), force[3];
        brunt_fem_internal_force(fem, n, force);
        for (int a = 1; a < 3; a++)
            node[BRUNT_FEM_V + a] =
                (real)((2.5 - (double)node[a]) / dt - dt * (double)force[a] / (double)node[BRUNT_FEM_MASS]);
    }
}

// What an element takes along that turns inside out is exact, too: its forces act over one more step, and the work they
// did there is not stored any more. One swinging element, of which a node is shot through the others.
START_TEST(inverted_elements_are_accounted) {
    const int k = _i % MAY_INVERT;
    brunt_world_def def = thrown(k, _i < MAY_INVERT ? BRUNT_HOURGLASS_STIFFNESS : BRUNT_HOURGLASS_VISCOUS);
    def.bodies[0].size = 1;
    def.bodies[0].erosion.keep = _i % 2;
    const double dt = def.step = 5e-4;
    brunt_error error = {0};
    if (kinds[k].kind < BRUNT_MEMBRANE_QUAD4) { // whose stress would relax in a step without motion
        brunt_material_def *law = &def.materials[0];
        *law = brunt_material_def_default("m", "johnson-cook");
        static const struct {
            const char *key;
            double value;
        } set[] = {{"density", DENSITY}, {"E", E},        {"nu", NU},     {"A", 0.002 * E},      {"B", 0.1 * E},
                   {"C", 0.2},           {"rate0", 1e-3}, {"melt", 1000}, {"heat_capacity", 500}};
        for (size_t q = 0; q < sizeof set / sizeof *set; q++)
            brunt_material_set(law, set[q].key, set[q].value, NULL, &error);
        ck_assert_msg(error.code == BRUNT_OK, "%s", error.message);
        for (int a = 0; a < 3; a++) def.bodies[0].wave_velocity[a] *= 10;
    }
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    world_steps(world, 4);
    if (fem->traits->membrane)
        flatten(fem, dt);
    else
        shoot(fem, dt);
    world->ledger.fem_kinetic = brunt_fem_audit(fem, 0, fem->node_count).kinetic;
    world->ledger.fem_stress_work = 0;
    for (int32_t b = 0; b < fem->block_count; b++) world->ledger.fem_stress_work += brunt_fem_stress_work(fem, b, dt);
    const brunt_energy before = world_energy(world);
    const brunt_momentum m = world_momentum(world);
    const double stored = before.internal, half = 0.5 * world->ledger.fem_stress_work;
    world_steps(world, 1);
    const brunt_energy after = world_energy(world);
    const brunt_momentum n = world_momentum(world);
    ck_assert_int_gt(eroded_of(world).inverted, 0);
    if (fem->element_count == 0) { // else others have followed the node
        const double seen = sizeof(real) == 4 ? 0 : 100 * EXACT * before.kinetic;
        ck_assert_double_gt(fabs(half), seen);
        ck_assert_double_gt(stored, seen);
        ck_assert_double_lt(fabs(after.error - before.error), EXACT * before.kinetic);
        ck_assert_double_lt(fabs(after.plastic - before.plastic), EXACT * before.kinetic);
    }
    printf("shot through, %s: %d left, error changes by %.1e, half a step's work is %.1e of the kinetic energy\n",
           brunt_element_name(kinds[k].kind), fem->element_count, (after.error - before.error) / before.kinetic,
           half / before.kinetic);
    for (int a = 0; a < 3; a++)
        ck_assert_double_lt(fabs((n.linear[a] - n.linear_impulse[a]) - (m.linear[a] - m.linear_impulse[a])),
                            ROUNDING * sqrt(2 * before.kinetic * 1000));
    brunt_world_destroy(world);
}
END_TEST

// A ring that flies through the axis in a step keeps its section as it was, and is inside out: its hoop is negative.
START_TEST(rings_that_cross_the_axis_go) {
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "neo-hookean", DENSITY, E, NU);
    def.axisymmetric = true;
    brunt_body_def *body = block(&def, _i ? 5 : 6, XYZ(0.1, 0, 0), XYZ(0.2, 0.1, 0), 0.1);
    def_velocity(body, -600, 0, 0);
    body->erosion.inverted = true;
    def.step = 4e-4;
    brunt_world *world = world_take(&def);
    const int64_t elements = brunt_body_elements(world, 0);
    world_steps(world, 1);
    ck_assert_int_eq(eroded_of(world).inverted, elements);
    ck_assert_int_eq(brunt_body_elements(world, 0), 0);
    brunt_world_destroy(world);
}
END_TEST

// A body reaches as far as what is left of it.
START_TEST(bounds_are_those_of_what_is_left) {
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "neo-hookean", DENSITY, E, NU);
    block(&def, 1, XYZ(0, 0, 0), XYZ(1, 1, 0), 0.25)->erosion.inverted = true;
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    for (int32_t s = 0; s < fem->slots; s++) {
        bool beyond = fem->element_id[s] >= 0;
        for (int a = 0; a < 4; a++) beyond = beyond && brunt_fem_node(fem, fem->element_node[4 * s + a])[0] > (real)0.4;
        if (beyond) mark(fem, s);
    }
    erode(world);
    const brunt_body_sums sums = world_sums(world, 0);
    ck_assert_int_eq(brunt_body_elements(world, 0), 8);
    ck_assert_double_eq(sums.high[0], 0.5);
    ck_assert_double_eq(sums.high[1], 1);
    brunt_world_destroy(world);
}
END_TEST

// Of a block with one element that is too short that one goes, and no other of its block.
START_TEST(only_what_is_short_goes) {
    brunt_world_def def = def_begin(2, 0);
    def_material(&def, "neo-hookean", DENSITY, E, NU);
    brunt_body_def *body = block(&def, 1, XYZ(0, 0, 0), XYZ(1, 1, 0), 0.25);
    body->erosion.step = 1e-9;
    def.cfl = 0.01;
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    ck_assert_int_eq(fem->block_count, 1);
    world->erosion.rule[0].step = 0.8 * fem->least_step;
    for (int32_t n = 0; n < fem->node_count; n++) {
        real *x = brunt_fem_node(fem, n);
        if (x[0] == 0 && x[1] == 0) x[0] = x[1] = (real)0.1; // of one element alone
    }
    world_steps(world, 2);
    ck_assert_int_eq(eroded_of(world).short_step, 1);
    ck_assert_int_eq(brunt_body_elements(world, 0), 15);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(short_elements_go_or_the_run_stops) {
    brunt_world_def def = crushed(_i, BRUNT_HOURGLASS_STIFFNESS);
    def.bodies[0].wave_velocity[0] = -120;
    def.cfl = 0.3;
    snprintf(def.materials[0].strength, sizeof def.materials[0].strength, "neo-hookean");
    brunt_world *world = world_from(&def);
    const double start = brunt_world_dt(world) / 0.3;
    brunt_error error = {0};
    brunt_world_destroy(world);

    def.least_step = 0.6 * start;
    world = world_from(&def);
    while (brunt_world_time(world) < 0.01 && !brunt_world_step(world, 0.01, &error)) {}
    ck_assert_int_eq(error.code, BRUNT_FAILED);
    ck_assert_msg(strstr(error.message, "least_step") && strstr(error.message, "body 'block', element"), "%s",
                  error.message);
    ck_assert_int_ge(error.id, 0);
    brunt_world_destroy(world);

    def.bodies[0].erosion.step = 0.6 * start;
    world = world_take(&def);
    for (error.code = BRUNT_OK; brunt_world_time(world) < 0.005;) {
        int status = brunt_world_step(world, 0.005, &error);
        ck_assert_msg(status == BRUNT_OK, "%s", error.message);
        for (int32_t b = 0; b < world->bodies.fem[0].block_count; b++)
            ck_assert_double_ge(world->bodies.fem[0].report[b].stable_step, 0.6 * start);
    }
    const brunt_eroded c = eroded_of(world);
    printf("short, %s: %lld elements, %lld left, energy error %.2e\n", brunt_element_name(kinds[_i].kind),
           (long long)c.short_step, (long long)brunt_body_elements(world, 0), world_energy(world).error_relative);
    ck_assert_int_gt(c.short_step, 0);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

// ------------------------------------------------------------------------------------------ what is left of loads

START_TEST(faces_of_gone_elements_bear_no_load) {
    brunt_world_def def = torn(3, false);
    def.bodies[0].wave_velocity[0] = 0;
    def.groups = brunt_alloc(2 * sizeof *def.groups);
    brunt_group_def *g = &def.groups[def.group_count++];
    *g = brunt_group_def_default();
    snprintf(g->body, sizeof g->body, "block");
    snprintf(g->group, sizeof g->group, "xmax");
    g->action = BRUNT_GROUP_PRESSURE, g->value[0] = 1000;
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    world_steps(world, 2);
    const double whole = world_boundary(world, 0).force[0];
    ck_assert_double_eq_tol(whole, -1000 * 0.04, 0.01);
    // One element of the four at that end.
    for (int32_t s = 0; s < fem->slots; s++) {
        double x[3] = {0};
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) x[i] += (double)brunt_fem_node(fem, fem->element_node[8 * s + a])[i] / 8;
        if (fem->element_id[s] >= 0 && x[0] > 0.9 && x[1] > 0 && x[2] > 0) mark(fem, s);
    }
    erode(world);
    brunt_world *other = world; // and after a restart
    world_steps(world, 1);
    ck_assert_double_eq_tol(world_boundary(world, 0).force[0], -1000 * 0.03, 0.01);
    world_copy_state(world, other);
    world_steps(other, 1);
    ck_assert_double_eq_tol(world_boundary(other, 0).force[0], -1000 * 0.03, 0.01);
    brunt_energy e = world_energy(world);
    ck_assert_double_lt(fabs(e.error), (sizeof(real) == 4 ? 1e-2 : 1e-3) * fabs(e.external_work));
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(gas_does_not_flow_out) {
    brunt_world_def def = torn(3, false);
    def.groups = brunt_alloc(2 * sizeof *def.groups);
    brunt_group_def *g = &def.groups[def.group_count++];
    *g = brunt_group_def_default();
    snprintf(g->name, sizeof g->name, "gas");
    snprintf(g->body, sizeof g->body, "block");
    snprintf(g->group, sizeof g->group, "surface");
    g->action = BRUNT_GROUP_GAS;
    g->gas = (brunt_gas_def){.gamma = 1.4, .pressure = 1e5, .outside = 1e5};
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    while (brunt_world_time(world) < 0.01 && !brunt_world_step(world, 0.01, &error)) {}
    ck_assert_int_eq(error.code, BRUNT_FAILED);
    ck_assert_msg(strstr(error.message, "(gas)") && strstr(error.message, "'block'"), "%s", error.message);
    brunt_world_destroy(world);
}
END_TEST

// Held nodes and damped ones, gravity, all of it gone: the step is that of the mesh as it was, and nothing moves or has
// energy any more.
START_TEST(body_without_elements_runs_on) {
    brunt_world_def def = thrown(_i, BRUNT_HOURGLASS_STIFFNESS);
    def.bodies[0].damping = 10;
    def.gravity[1] = -9.81;
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    world_steps(world, 5);
    const double dt = brunt_world_dt(world), initial = world_energy(world).initial;
    for (int32_t s = 0; s < fem->slots; s++)
        if (fem->element_id[s] >= 0) mark(fem, s);
    erode(world);
    ck_assert_int_eq(brunt_body_elements(world, 0), 0);
    ck_assert_int_eq(eroded_of(world).nodes, brunt_body_nodes(world, 0));
    const double error = world_energy(world).error;
    double *x = world_field(world, 0, "position");
    world_steps(world, 30);
    double *y = world_field(world, 0, "position");
    ck_assert_double_lt(brunt_world_dt(world), 3 * dt);
    ck_assert_mem_eq(x, y, (size_t)brunt_body_nodes(world, 0) * 3 * sizeof *x);
    brunt_energy e = world_energy(world);
    ck_assert_double_lt(fabs(e.kinetic), 1e-12 * initial);
    ck_assert_double_lt(fabs(e.error - error), 1e-12 * initial);
    ck_assert_double_lt(world_momentum(world).linear_drift, ROUNDING);
    brunt_body_sums sums = world_sums(world, 0);
    for (int a = 0; a < 3; a++)
        ck_assert(isfinite(sums.centre[a]) && isfinite(sums.velocity[a]) && isfinite(sums.low[a]));
    free(x), free(y);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(steps_allocate_nothing) {
    brunt_world_def def = torn(3, false);
    brunt_world *world = world_take(&def);
    brunt_fem_body *fem = &world->bodies.fem[0];
    mark_random(fem, 12);
    erode(world);
    const int64_t calls = brunt_memory_calls();
    for (int k = 0; k < 6; k++) {
        world_steps(world, 2);
        mark_random(fem, 1);
        erode(world);
    }
    ck_assert_int_eq(brunt_memory_calls(), calls);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(without_erosion_there_is_nothing) {
    brunt_world_def def = torn(3, false);
    def.bodies[0].erosion.strain = INFINITY;
    brunt_world *world = world_take(&def);
    ck_assert(!world->erosion.active && !world->erosion.account && !world->erosion.rule && !world->erosion.work);
    ck_assert(!world->bodies.fem[0].bonds && !world->bodies.fem[0].mark && !world->bodies.fem[0].rank);
    for (int32_t p = 0; p < brunt_pass_count(world); p++) ck_assert_str_ne(brunt_world_pass(world, p).name, "erosion");
    for (int32_t f = 0; f < brunt_effect_count(world); f++)
        if (!strcmp(brunt_world_effect(world, f).name, "erosion")) ck_assert(!brunt_world_effect(world, f).on);
    for (int32_t b = 0; b < brunt_state_count(world); b++)
        ck_assert_ptr_null(strstr(brunt_state_info(world, b).name, "elements"));
    brunt_eroded e = eroded_of(world), none = {0};
    ck_assert_mem_eq(&e, &none, sizeof e);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(bad_limits_are_refused) {
    for (int q = 0; q < 5; q++) {
        brunt_world_def def = torn(3, false);
        if (q == 0) def.bodies[0].erosion.strain = 0;
        if (q == 1) def.bodies[0].erosion.strain = NAN;
        if (q == 2) def.bodies[0].erosion.step = -1;
        if (q == 3) def.least_step = -1;
        if (q == 4) def.bodies[0].method = BRUNT_MPM, def.cell = 0.1, def.bodies[0].erosion.step = 1e-9;
        brunt_error error = {0};
        brunt_world *world = brunt_world_create(&def, &error);
        ck_assert_ptr_null(world);
        ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
        ck_assert_msg(strstr(error.message, q == 3 ? "least_step" : "erosion"), "%s", error.message);
        brunt_world_def_free(&def);
    }
    ck_assert_int_eq((int)brunt_memory_live(), 0);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("erosion");
    TCase *all = tcase_create("all");
    suite_add_tcase(suite, all);
    tcase_add_loop_test(all, random_erosions_are_accounted, 0, 2 * KINDS);
    tcase_add_loop_test(all, order_is_kept, 0, KINDS);
    tcase_add_loop_test(all, readers_see_what_is_left, 0, KINDS);
    tcase_add_loop_test(all, bar_tears_in_two, 0, SOLIDS);
    tcase_add_loop_test(all, kept_nodes_fly_on, 0, SOLIDS);
    tcase_add_loop_test(all, strain_is_the_equivalent_logarithmic_one, 0, KINDS);
    tcase_add_loop_test(all, failed_elements_go, 0, SOLIDS);
    tcase_add_loop_test(all, threads_and_restarts_change_no_bit, 0, SOLIDS);
    tcase_add_test(all, foreign_elements_are_refused);
    tcase_add_loop_test(all, inverted_elements_are_an_error_or_go, 0, 2 * SOLIDS);
    tcase_add_loop_test(all, inverted_elements_are_accounted, 0, 2 * MAY_INVERT);
    tcase_add_loop_test(all, rings_that_cross_the_axis_go, 0, 2);
    tcase_add_test(all, only_what_is_short_goes);
    tcase_add_test(all, bounds_are_those_of_what_is_left);
    tcase_add_loop_test(all, short_elements_go_or_the_run_stops, 0, SOLIDS);
    tcase_add_test(all, faces_of_gone_elements_bear_no_load);
    tcase_add_test(all, gas_does_not_flow_out);
    tcase_add_loop_test(all, body_without_elements_runs_on, 0, KINDS);
    tcase_add_test(all, steps_allocate_nothing);
    tcase_add_test(all, without_erosion_there_is_nothing);
    tcase_add_test(all, bad_limits_are_refused);
    return suite_main(suite);
}
