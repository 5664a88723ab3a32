// Making what implicit steps keep: terms of the bodies, the solver, how small a correction is small.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "scheme/implicit.h"

// ------------------------------------------------------------------------------------------ the solver

// Grid nodes in reach of particles.
static int count_reached(const brunt_grid *grid, int64_t *count, brunt_error *error) {
    const size_t nodes = (size_t)grid->slot_count * BRUNT_BLOCK_NODES;
    uint8_t *mark;
    if (BRUNT_NEW(mark, nodes + 1, "marks of grid nodes", error)) return BRUNT_FAILED;
    brunt_grid_mark_reached(grid, mark);
    *count = 0;
    for (size_t n = 0; n < nodes; n++) *count += mark[n];
    brunt_free(mark);
    return BRUNT_OK;
}

// Blocks of a row: nodes that an inner node of a mesh couples with.
static double row_of_mesh(const brunt_fem_body *fem) {
    const bool simplex = brunt_element_is_simplex(fem->kind);
    return fem->dim == 2 || fem->traits->membrane ? (simplex ? 7 : 9) : (simplex ? 15 : 27);
}

// How large the systems are. BRUNT_FAILED: out of memory.
static int measure_systems(const brunt_world *world, brunt_linear_size *size, brunt_error *error) {
    const double dt = world->settings.fixed_step;
    double blocks = 0;
    *size = (brunt_linear_size){.dim = world->settings.dimension};
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        size->nodes += fem->node_count;
        blocks += row_of_mesh(fem) * fem->node_count;
        size->courant = fmax(size->courant, (double)fem->material.wave_speed * dt / fem->mean_edge);
    }
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        const brunt_body *body = &world->bodies.mpm[i];
        int64_t nodes;
        if (count_reached(&body->grid, &nodes, error)) return BRUNT_FAILED;
        size->nodes += nodes;
        blocks += pow(2 * body->grid.order + 1, body->grid.dim) * (double)nodes;
        size->courant = fmax(size->courant, (double)body->material.wave_speed * dt / (double)body->grid.h);
    }
    size->blocks = blocks / fmax((double)size->nodes, 1);
    if (world->settings.scheme == BRUNT_STATIC) size->courant = INFINITY;
    return BRUNT_OK;
}

static void choose_solver(struct brunt_implicit *m, brunt_solver wanted) {
    enum { ITERATION_LIMIT = 300, MANY_ITERATIONS = 20000 };
    m->choice = brunt_linear_choose(&m->size);
    if (m->still) { // whether an equilibrium is stable it says beside
        m->choice.solver = &brunt_linear_direct;
        snprintf(m->choice.why, sizeof m->choice.why, "direct: it tells whether an equilibrium is stable");
    }
    if (m->holds) {
        m->choice.solver = &brunt_linear_direct;
        snprintf(m->choice.why, sizeof m->choice.why, "tractions of boundaries follow with one factor");
    }
    m->options.solver = wanted == BRUNT_SOLVER_AUTO     ? m->choice.solver
                        : wanted == BRUNT_SOLVER_DIRECT ? &brunt_linear_direct
                                                        : &brunt_linear_pcg;
    m->options.matrix_free = wanted == BRUNT_SOLVER_MATRIX_FREE;
    m->options.preconditioner = m->options.matrix_free ? BRUNT_BLOCK_JACOBI : m->choice.preconditioner;
    if (m->forces) {
        m->options.solver = &brunt_linear_unsymmetric;
        snprintf(m->choice.why, sizeof m->choice.why, "a material without a potential: its matrices are not symmetric");
    }
    // What is left of a correction falls as its square only where systems are solved exactly.
    m->options.early = m->options.solver != &brunt_linear_pcg;
    m->options.fallback = wanted == BRUNT_SOLVER_AUTO && !m->forces;
    m->options.linear_iterations = m->options.fallback ? ITERATION_LIMIT : MANY_ITERATIONS;
}

// ------------------------------------------------------------------------------------------ what is small

static const double SMALL_PART = 1e-2; // of the least gap
static const double LAST = 0.1;        // of the tolerance: the last step of Newton's method, where there is no energy

double brunt_implicit_measure(void *context, const brunt_team *team, const double *p, int64_t *where) {
    struct brunt_implicit *m = context;
    const brunt_unknowns *u = &m->unknowns;
    double most = 0;
    *where = -1;
    m->options.tolerance = m->tolerance;
    if (m->contact.barrier)
        m->options.tolerance = fmin(m->tolerance, SMALL_PART * brunt_barrier_least_gap(m->contact.barrier) / m->dt);
    for (int32_t n = 0; n < u->mesh_count; n++) {
        double square = 0;
        for (int a = 0; a < u->dim; a++) square += p[n * (int64_t)u->dim + a] * p[n * (int64_t)u->dim + a];
        if (!(square <= most)) most = square, *where = n;
    }
    for (int i = 0; i < m->world->bodies.mpm_count; i++) {
        const brunt_particles *particles = &m->world->bodies.mpm[i].particles;
        brunt_mpm_interpolate(m->mpm[i], team, p, m->moved);
        for (int64_t s = 0; s < particles->slots; s++) {
            if (particles->id[s] < 0) continue; // nothing is known there
            double square = 0;
            for (int a = 0; a < u->dim; a++) square += m->moved[s * u->dim + a] * m->moved[s * u->dim + a];
            if (!(square <= most)) most = square, *where = -2 - s;
        }
    }
    return sqrt(most) / m->dt;
}

// ------------------------------------------------------------------------------------------ making

static const brunt_weights weights_of[] = {{1, 0.5, 1, 1, 1}, {0.5, 0.25, 0.5, 0.5, 0.5}}, // by brunt_integrator
    weights_of_load_steps = {1, 0.5, 1, 1, 0.5};
_Static_assert(BRUNT_COUNT(weights_of) == BRUNT_NEWMARK + 1, "weights of each integrator");

// Proximal shares, of the stiffness of nodes: where few material points are near a node of a grid its own may be lost.
static const double EVERYWHERE = 1e-12;

static int make_bodies(brunt_world *world, struct brunt_implicit *m, brunt_error *error) {
    int32_t base = 0;
    m->term[m->term_count++] =
        m->still ? (brunt_term){&brunt_proximal_ops, &m->proximal} : (brunt_term){&brunt_inertia_ops, &m->inertia};
    m->term[m->term_count++] = (brunt_term){&brunt_dead_load_ops, &m->loads};
    m->term[m->term_count++] = (brunt_term){&brunt_pull_ops, &m->pull};
    m->proximal.unknowns = m->inertia.unknowns = m->loads.unknowns = m->pull.unknowns = m->drag.unknowns = &m->unknowns;
    if (world->boundaries.damping.active) m->term[m->term_count++] = (brunt_term){&brunt_drag_ops, &m->drag};
    if (m->holds) m->term[m->term_count++] = (brunt_term){&brunt_boundary_rows_ops, &m->rows};
    if (m->holds) m->term[m->term_count++] = (brunt_term){&brunt_ghost_ops, &m->ghost};
    m->fixed_terms = m->term_count;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        brunt_fem_body *fem = &world->bodies.fem[k];
        const char *why = brunt_fem_implicit(fem);
        if (why) return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s: %s", fem->name, why);
        fem->material.implicit = true;
        if (!(m->fem[k] = brunt_fem_potential_make(fem, base, &m->team, error))) return BRUNT_FAILED;
        m->term[m->term_count++] = brunt_fem_potential_term(m->fem[k]);
        base += fem->node_count;
    }
    for (int i = 0; i < world->bodies.mpm_count; i++) {
        brunt_body *body = &world->bodies.mpm[i];
        const char *why = brunt_mpm_implicit(body);
        if (why) return brunt_fail(error, BRUNT_BAD_INPUT, "bodies.%s: %s", body->name, why);
        body->material.implicit = true;
        if (!(m->mpm[i] = brunt_mpm_potential_make(body, error))) return BRUNT_FAILED;
        m->term[m->term_count++] = brunt_mpm_potential_term(m->mpm[i]);
    }
    m->body_terms = m->term_count;
    return BRUNT_OK;
}

static int make_contact(brunt_world *world, struct brunt_implicit *m, const brunt_world_def *def, brunt_error *error) {
    const int status = brunt_implicit_contact_make(&m->contact, world, def, error);
    if (status || !m->contact.barrier) return status;
    m->friction_iterations = def->contact.friction_iterations;
    m->term[m->term_count++] = brunt_barrier_term(m->contact.barrier);
    m->rubs = brunt_barrier_has_friction(m->contact.barrier);
    if (m->rubs) m->term[m->term_count++] = brunt_barrier_friction_term(m->contact.barrier);
    return BRUNT_OK;
}

static void set_options(brunt_world *world, struct brunt_implicit *m) {
    const brunt_newton_def *newton = &world->settings.newton;
    double slowest = INFINITY;
    for (int b = 0; b < world->bodies.count; b++)
        slowest = fmin(slowest, (double)brunt_bodies_material(&world->bodies, b)->wave_speed);
    m->options = brunt_newton_defaults();
    m->options.tolerance = m->tolerance = newton->tolerance * slowest;
    m->options.iterations = newton->iterations;
    m->options.accuracy = newton->accuracy;
    m->weights = m->still ? weights_of_load_steps : weights_of[world->settings.given.integrator];
    if (m->still) {
        m->options.tolerance = newton->tolerance;
        m->options.unbalance = brunt_static_unbalance;
        m->options.stable = true;
        m->leads = world->settings.given.predictor == BRUNT_PREDICTOR_TANGENT;
        m->proximal.everywhere = EVERYWHERE;
    } else {
        m->options.measure = brunt_implicit_measure;
        m->options.balance = brunt_implicit_balance;
    }
    world->clock.next_dt = world->settings.fixed_step;
    world->clock.newton = world->clock.newton_last =
        (brunt_newton_counts){.least_gap = INFINITY, .least_part = INFINITY};
}

int brunt_implicit_make(brunt_world *world, const brunt_world_def *def, brunt_error *error) {
    if (!brunt_scheme_minimises(world->settings.scheme)) return BRUNT_OK;
    if (BRUNT_NEW(world->plan.implicit, 1, "room for implicit steps", error)) return BRUNT_FAILED;
    struct brunt_implicit *m = world->plan.implicit;
    const brunt_bodies *bodies = &world->bodies;
    m->world = world;
    m->still = world->settings.scheme == BRUNT_STATIC;
    m->team.threads = world->settings.threads;
    m->holds = world->boundaries.surfaces.count > 0;
    m->rows.still = m->still;
    BRUNT_TRY(brunt_boundary_surfaces_sides(&world->boundaries.surfaces, bodies, def->contact.allow_overlap, error));
    if (BRUNT_NEW(m->fem, bodies->fem_count + 1, "potentials of meshes", error) ||
        BRUNT_NEW(m->mpm, bodies->mpm_count + 1, "potentials of bodies of points", error) ||
        BRUNT_NEW(m->term, bodies->count + BRUNT_OTHER_TERM_LIMIT, "terms of a step", error) ||
        brunt_unknowns_make(&m->unknowns, world, error))
        return BRUNT_FAILED;
    set_options(world, m);
    if (measure_systems(world, &m->size, error)) return BRUNT_FAILED;
    for (int b = 0; b < bodies->count; b++)
        m->forces = m->forces || brunt_bodies_material(&world->bodies, b)->differences;
    m->rows.forces = m->forces;
    m->rows.known = m->forces ? LAST * m->tolerance : 0;
    m->rows.answer_limit = BRUNT_BOUNDARY_ANSWER_LIMIT;
    if (m->forces && brunt_solver_iterates(world->settings.newton.solver))
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "newton.solver: conjugate gradients solve symmetric systems, and a material without a "
                          "potential has others: "
                          "auto or direct is wanted");
    choose_solver(m, world->settings.newton.solver);
    brunt_implicit_follow(&world->plan);
    BRUNT_TRY(make_bodies(world, m, error));
    BRUNT_TRY(make_contact(world, m, def, error));
    return brunt_implicit_condense(m, error);
}

// Terms by what they are of; the rest is each part's own.
void brunt_implicit_validate(const struct brunt_implicit *m, const brunt_bodies *bodies,
                             const brunt_boundaries *boundaries, int pairs) {
    BRUNT_ASSERT(m->fixed_terms >= 3 && m->body_terms == m->fixed_terms + bodies->count);
    BRUNT_ASSERT(m->term_count == m->body_terms + (m->contact.barrier != NULL) + m->rubs);
    for (int t = 0; t < m->term_count; t++) BRUNT_ASSERT(m->term[t].ops && m->term[t].self);
    BRUNT_ASSERT(m->team.threads >= 1 && m->dt >= 0 && m->options.solver && m->options.tolerance >= 0);
    brunt_unknowns_validate(&m->unknowns, bodies, boundaries->boundary_count);
    brunt_implicit_contact_validate(&m->contact, bodies->count, boundaries->boundary_count, pairs);
    brunt_newton_validate(&m->newton);
}

void brunt_implicit_free(brunt_plan *plan, const brunt_bodies *bodies) {
    struct brunt_implicit *m = plan->implicit;
    if (!m) return;
    for (int k = 0; m->fem && k < bodies->fem_count; k++) brunt_fem_potential_free(m->fem[k]);
    for (int i = 0; m->mpm && i < bodies->mpm_count; i++) brunt_mpm_potential_free(m->mpm[i]);
    brunt_fields *f = &m->field;
    double *const fields[] = {f->u,         f->v,           f->aim,       f->acceleration, f->load,  f->force_before,
                              f->gradient,  f->contact,     f->step,      f->zero,         m->moved, f->pull,
                              f->stiffness, m->drag_weight, m->drag_rest, f->rub,          f->tried, f->best};
    for (size_t k = 0; k < sizeof fields / sizeof *fields; k++) brunt_free(fields[k]);
    brunt_free(f->support), brunt_free(m->last), brunt_free(m->turned);
    brunt_newton_free(&m->newton);
    brunt_implicit_contact_free(&m->contact);
    brunt_implicit_condense_free(m);
    brunt_boundary_rows_free(&m->rows);
    brunt_ghost_free(&m->ghost);
    brunt_unknowns_free(&m->unknowns, bodies);
    brunt_free(m->fem);
    brunt_free(m->mpm);
    brunt_free(m->term);
    brunt_free(m);
    plan->implicit = NULL;
}

// ------------------------------------------------------------------------------------------ the pass of numbers

static int reserve(const brunt_bodies *bodies, struct brunt_implicit *m, brunt_error *error) {
    brunt_fields *f = &m->field;
    const size_t n = (size_t)brunt_implicit_components(m) + 1;
    size_t most = 1;
    for (int i = 0; i < bodies->mpm_count; i++)
        if ((size_t)bodies->mpm[i].particles.slots > most) most = (size_t)bodies->mpm[i].particles.slots;
    const bool failed = m->still ? BRUNT_CAPACITY(f->stiffness, n, 0, "unknowns", error) ||
                                       BRUNT_CAPACITY(f->support, n, 0, "unknowns", error)
                                 : BRUNT_CAPACITY(f->v, n, 0, "unknowns", error) ||
                                       BRUNT_CAPACITY(f->aim, n, 0, "unknowns", error) ||
                                       BRUNT_CAPACITY(f->acceleration, n, 0, "unknowns", error);
    return failed || BRUNT_CAPACITY(f->u, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(f->load, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(f->force_before, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(f->gradient, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(f->contact, n, 0, "unknowns", error) || BRUNT_CAPACITY(f->step, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(f->zero, n, 0, "unknowns", error) || BRUNT_CAPACITY(f->pull, n, 0, "unknowns", error) ||
           BRUNT_CAPACITY(m->moved, most * (size_t)m->unknowns.dim, 0, "ways of particles", error);
}

int brunt_pass_number(brunt_world *world, brunt_step *step, brunt_error *error) {
    (void)step;
    struct brunt_implicit *m = world->plan.implicit;
    if (brunt_unknowns_number(&m->unknowns, world, error) || reserve(&world->bodies, m, error) ||
        brunt_implicit_drag_number(m, world, error))
        return brunt_fail_inner(&world->clock, NULL, error);
    m->loads.force = m->field.load, m->inertia.aim = m->field.aim;
    m->proximal.stiffness = m->field.stiffness, m->proximal.support = m->field.support;
    if (m->holds && brunt_ghost_step(&m->ghost, world, &m->unknowns, error))
        return brunt_fail_inner(&world->clock, NULL, error);
    return brunt_implicit_contact_points(&m->contact, &world->bodies, &m->unknowns, error)
               ? brunt_fail_inner(&world->clock, NULL, error)
               : BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ what is read of it

bool brunt_world_newton(const brunt_world *world, brunt_newton_counts *so_far, brunt_newton_counts *last) {
    if (so_far) *so_far = world->clock.newton;
    if (last) *last = world->clock.newton_last;
    return world->plan.implicit != NULL;
}

bool brunt_world_static(const brunt_world *world) { return world->settings.scheme == BRUNT_STATIC; }

size_t brunt_implicit_bytes(const brunt_world *world) {
    const struct brunt_implicit *m = world->plan.implicit;
    const brunt_fields *f = &m->field;
    size_t bytes = brunt_unknowns_bytes(&m->unknowns, &world->bodies) + m->moved_capacity + m->last_capacity +
                   m->drag_weight_capacity + m->drag_rest_capacity + brunt_implicit_contact_bytes(&m->contact) +
                   f->contact_capacity + brunt_boundary_rows_bytes(&m->rows) + brunt_ghost_bytes(&m->ghost) +
                   brunt_boundary_surfaces_bytes(&world->boundaries.surfaces);
    for (int k = 0; k < world->bodies.fem_count; k++) bytes += brunt_fem_potential_bytes(m->fem[k]);
    for (int i = 0; i < world->bodies.mpm_count; i++) bytes += brunt_mpm_potential_bytes(m->mpm[i]);
    return bytes + f->u_capacity + f->v_capacity + f->aim_capacity + f->acceleration_capacity + f->load_capacity +
           f->force_before_capacity + f->gradient_capacity + f->step_capacity + f->zero_capacity + f->pull_capacity +
           f->stiffness_capacity + f->support_capacity + f->rub_capacity + f->tried_capacity + f->best_capacity;
}

size_t brunt_implicit_matrix_bytes(const brunt_plan *plan) {
    const brunt_newton *n = &plan->implicit->newton;
    const brunt_block_matrix *a = &n->matrix;
    return a->first_capacity + a->column_capacity + a->diagonal_capacity + a->value_capacity + n->gradient_capacity +
           n->step_capacity + n->trial_capacity + brunt_matrix_free_bytes(&n->free) +
           brunt_condensation_bytes(&plan->implicit->condensation);
}

bool brunt_world_newton_systems(const brunt_world *world, brunt_newton_systems *systems) {
    const struct brunt_implicit *m = world->plan.implicit;
    if (!m) return false;
    *systems = (brunt_newton_systems){.unknowns = m->size.nodes * m->size.dim,
                                      .courant = m->size.courant,
                                      .solver = m->options.matrix_free ? "matrix-free" : m->options.solver->name,
                                      .why = world->settings.newton.solver == BRUNT_SOLVER_AUTO || m->forces
                                                 ? m->choice.why
                                                 : "newton.solver asks for it",
                                      .tolerance = m->options.tolerance,
                                      .bytes = (double)brunt_implicit_bytes(world)};
    return true;
}
