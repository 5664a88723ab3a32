// The surfaces of meshes and what they meet: each other, particles, planes.
#include <math.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "contact/methods/method.h"
#include "contact/search/initial_overlap.h"
#include "world/create.h"
#include "world/world.h"

static const double COARSE = 1.25; // cells: edges of meshes that meet particles at grid nodes
enum { GRID_SWEEPS = 8, TOUCH_SWEEPS = 64 };
static const double THIN = 0.01; // mean edges
static const double SHALLOW =
    0.2; // shorter mean edges of two: what is no deeper is met, and may be the facets of round bodies

static bool acts_on_fem(const brunt_world *world, const brunt_boundary *boundary) {
    if (!boundary->kind->meet_surface) return false;
    int first, end;
    brunt_bodies_meshes(&world->bodies, boundary->body, &first, &end);
    return first < end;
}

// Smallest and largest mean edge among the bodies, for the choice of the contact grid.
static void look_at_edges(const brunt_bodies *bodies, double *fine, double *coarse) {
    *fine = INFINITY, *coarse = 0;
    for (int k = 0; k < bodies->fem_count; k++) {
        *fine = fmin(*fine, bodies->fem[k].mean_edge);
        *coarse = fmax(*coarse, bodies->fem[k].mean_edge);
    }
}

// Membranes keep apart by their thickness, which is all there is to tell their sides by.
static void warn_of_thickness(brunt_world *world, const brunt_fem_body *fem, bool self) {
    const double thick = (double)fem->contact_thickness;
    bool other = self;
    for (int k = 0; k < world->bodies.fem_count; k++)
        other = other || (world->bodies.fem[k].traits->membrane &&
                          brunt_pair_of(&world->pairs.map, fem->index, world->bodies.fem[k].index) >= 0);
    if (self && thick > fem->mean_edge)
        brunt_warn(&world->messages,
                   "bodies.%s: its thickness in contact, %.4g m, is more than its mean edge, %.4g m: elements that are "
                   "neighbours across a fold push each other apart",
                   fem->name, thick, fem->mean_edge);
    if (other && thick < THIN * fem->mean_edge)
        brunt_warn(&world->messages,
                   "bodies.%s: its thickness in contact, %.4g m, is less than a hundredth of its mean edge, %.4g m: "
                   "layers that are pressed may pass through each other; contact_thickness takes a greater one",
                   fem->name, thick, fem->mean_edge);
}

// What membranes ask of contact: a form that knows their two sides, elements that particles do not fit through, and
// elements longer than they are thick.
static int check_membranes(brunt_world *world, bool *self, brunt_error *error) {
    const brunt_contact_row *facets = world->contact.facets;
    char forms[96];
    brunt_augury_words_of(brunt_augury_forms_of_membranes(), forms, sizeof forms);
    const int n = world->bodies.count;
    for (int k = 0; k < world->bodies.fem_count; k++) {
        const brunt_fem_body *fem = &world->bodies.fem[k];
        bool meets = facets && facets->affine; // which acts on all
        if (!fem->traits->membrane) continue;
        for (int i = 0; i < n; i++) {
            const bool pair = brunt_pair_of(&world->pairs.map, fem->index, i) >= 0;
            const brunt_body *mpm = world->bodies.all[i].mpm;
            meets = meets || pair;
            if (pair && mpm && fem->mean_edge < (1 - 1e-6) * mpm->spacing)
                brunt_warn(&world->messages,
                           "bodies.%s: its mean edge, %.4g m, is less than the spacing of the particles of '%s', %.4g "
                           "m: nodes can pass between them",
                           fem->name, fem->mean_edge, mpm->name, mpm->spacing);
        }
        if (facets && meets && !facets->knows_membranes)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "contact.form: %s is wanted where a membrane is in contact, here '%s'", forms, fem->name);
        self[k] = brunt_pair_of(&world->pairs.map, fem->index, fem->index) >= 0;
        warn_of_thickness(world, fem, self[k]);
    }
    return BRUNT_OK;
}

static int make_membranes(brunt_world *world, brunt_error *error) {
    bool any = false, *self;
    if (BRUNT_NEW(self, world->bodies.fem_count + 1, "marks of membranes", error)) return BRUNT_FAILED;
    int status = check_membranes(world, self, error);
    for (int k = 0; k < world->bodies.fem_count; k++) any = any || self[k];
    if (!status && any) status = brunt_surface_patches(&world->contact.surface, self, error);
    brunt_free(self);
    return status;
}

// The row that acts where there are planes alone.
static const brunt_contact_row *row_of_planes(void) {
    const brunt_contact_row *const *row = brunt_contact_rows;
    while (!(*row)->planes) row++;
    return *row;
}

// The row by which surfaces meet what they do.
static const brunt_contact_row *acting(const brunt_contact *contact) {
    return contact->facets ? contact->facets : row_of_planes();
}

int brunt_surfaces_make(brunt_world *world, const brunt_world_def *def, brunt_error *error) {
    if (brunt_scheme_minimises(def->scheme)) return BRUNT_OK; // barriers know surfaces of their own
    for (int w = 0; w < world->boundaries.boundary_count; w++)
        world->contact.has_surfaces = world->contact.has_surfaces || acts_on_fem(world, &world->boundaries.boundary[w]);
    for (int r = 0; r < brunt_contact_row_count; r++)
        world->contact.has_surfaces |= brunt_contact_rows[r]->act && world->contact.rows >> r & 1;
    world->contact.def = def->contact;
    world->contact.def.pairs = NULL, world->contact.def.pair_count = 0;
    world->contact.touch_sweeps = def->contact.iterations > 0 ? def->contact.iterations : TOUCH_SWEEPS;
    if (!world->contact.has_surfaces) return BRUNT_OK;
    world->contact.grid_sweeps = def->contact.iterations > 0 ? def->contact.iterations : GRID_SWEEPS;
    const brunt_contact_row *row = acting(&world->contact);
    if (world->contact.def.iterations < 0) world->contact.def.iterations = row->sweeps;
    brunt_fem_body **fems;
    if (BRUNT_NEW(fems, world->bodies.fem_count + 1, "meshes with surfaces", error)) return BRUNT_FAILED;
    for (int k = 0; k < world->bodies.fem_count; k++) fems[k] = &world->bodies.fem[k];
    int status = brunt_surface_make(&world->contact.surface, fems, world->bodies.fem_count, row->affine, error);
    brunt_free(fems);
    if (status) return status;
    if (world->contact.surface.membrane.side) {
        status = make_membranes(world, error);
        if (status) return status;
        if (def->contact.iterations < 0 && row->membrane_sweeps) world->contact.def.iterations = row->membrane_sweeps;
    }
    double fine, coarse;
    look_at_edges(&world->bodies, &fine, &coarse);
    world->contact.cell = def->contact.cell > 0 ? def->contact.cell : row->cell_factor * coarse;
    if (world->contact.has_grid_surfaces && coarse > COARSE * world->settings.cell)
        brunt_warn(&world->messages,
                   "grid.cell %g m is much less than the longest mean edge of a mesh, %g m: contact at the grid's "
                   "nodes may not "
                   "see particles between those of the mesh",
                   world->settings.cell, coarse);
    if (!(row->look > 0)) return BRUNT_OK;
    if (world->contact.cell < 0.7 * coarse)
        brunt_warn(&world->messages,
                   "contact.cell %g m is less than 0.7 of the longest mean edge, %g m: nodes may pass between those of "
                   "the other body unseen",
                   world->contact.cell, coarse);
    if (world->contact.cell > 4 * fine)
        brunt_warn(&world->messages,
                   "contact.cell %g m is more than 4 of the shortest mean edge, %g m: edges and corners are rounded by "
                   "as much",
                   world->contact.cell, fine);
    return BRUNT_OK;
}

// [m] that material points meet others out from their centres; 0 of meshes.
static double half_spacing(const brunt_bodies *bodies, int body) {
    const brunt_body *mpm = bodies->all[body].mpm;
    return mpm ? 0.5 * mpm->spacing : 0;
}

static bool meets(const void *pair_map, int32_t a, int32_t b) { return brunt_pair_of(pair_map, a, b) >= 0; }

// Bodies that lie in each other, or behind a plane, at the start. The contact surface is taken for it, and forgets that
// it was.
int brunt_surfaces_overlap(brunt_world *world, brunt_error *error) {
    const double none[3] = {0};
    brunt_contact_surface *s = &world->contact.surface;
    brunt_contact_context m = {.surface = s,
                               .body_count = world->bodies.count,
                               .boundaries = world->boundaries.boundary,
                               .acting = &world->boundaries.acting};
    if (s->fem_count) {
        brunt_surface_bounds(s, world->settings.threads, NULL);
        for (int k = 0; k < s->fem_count; k++) s->active[k] = true;
        brunt_surface_gather_state(s, 0, none, world->settings.threads, NULL);
        for (int k = 0; k < s->fem_count; k++) s->active[k] = s->motion.was_active[k] = false;
    }
    const brunt_overlap_rule rule = {.meets = meets, .self = &world->pairs.map, .least = SHALLOW};
    brunt_overlap o;
    const int status = brunt_overlap_find(&m, world->bodies.mpm, world->bodies.mpm_count,
                                          world->boundaries.boundary_count, &rule, &o, error);
    if (status || !o.any) return status;
    static const char way_out[] = "move one of them, or write contact.initial_overlap: allow";
    if (o.b < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "bodies.%s is %.4g m behind the plane '%s' at the start, at (%.6g, %.6g, %.6g) m; %s",
                          brunt_body_name(world, o.a), o.depth, world->boundaries.boundary[o.boundary].name, o.x[0],
                          o.x[1], o.x[2], way_out);
    const bool shallow = o.depth < half_spacing(&world->bodies, o.a) + half_spacing(&world->bodies, o.b);
    return brunt_fail(error, BRUNT_BAD_INPUT,
                      "bodies.%s overlaps bodies.%s by %.4g m at the start, at (%.6g, %.6g, %.6g) m%s; %s",
                      brunt_body_name(world, o.a), brunt_body_name(world, o.b), o.depth, o.x[0], o.x[1], o.x[2],
                      shallow ? BRUNT_POINTS_REACH : "", way_out);
}

int brunt_surfaces_renew(brunt_contact *contact, brunt_error *error) {
    if (!contact->has_surfaces) return BRUNT_OK;
    const int status = brunt_surface_renew(&contact->surface, false, error);
    return status ? status : brunt_node_to_facet_renew(contact->node_to_facet, &contact->surface, error);
}

// Whether a world has something for a row to do; planes are met where facets are.
static bool is_used(const brunt_contact *contact, int r) {
    const brunt_contact_row *row = brunt_contact_rows[r];
    return row->act && (contact->rows >> r & 1 || row->planes);
}

static brunt_contact_work contact_work(brunt_contact *contact) {
    return (brunt_contact_work){.def = &contact->def,
                                .grid_sweeps = contact->grid_sweeps,
                                .sweeps = acting(contact)->planes ? contact->def.iterations : row_of_planes()->sweeps,
                                .constraints = &contact->constraints,
                                .node_to_facet = &contact->node_to_facet};
}

// Names the mesh that is fastest, or farthest away: contact cannot look that far.
static int fail_far(const brunt_contact *contact, brunt_error *error) {
    const brunt_contact_surface *s = &contact->surface;
    int worst = -1;
    double most = -1;
    for (int k = 0; k < s->fem_count; k++) {
        double size = s->motion.speed[k];
        for (int a = 0; a < s->dim; a++) size = fmax(size, fmax(fabs(s->low[k][a]), fabs(s->high[k][a])));
        if (isnan(s->motion.speed[k]) || size > most) worst = k, most = isnan(s->motion.speed[k]) ? INFINITY : size;
    }
    if (worst < 0 || most < 1e150)
        return brunt_fail(error, BRUNT_FAILED, "a plane goes too far in a step for contact to be looked for");
    return brunt_fail(
        error, BRUNT_FAILED,
        "body '%s' goes so far in a step, or is so far away, that contact cannot be looked for (%.4g m, or m/s)",
        s->fem[worst]->name, most);
}

brunt_contact_context brunt_contact_context_of(brunt_world *world, double dt, brunt_timer *timer) {
    const brunt_contact_row *facets = world->contact.facets;
    return (brunt_contact_context){.surface = &world->contact.surface,
                                   .pairs = world->pairs.pair,
                                   .pair_map = &world->pairs.map,
                                   .body_count = world->bodies.count,
                                   .dt = dt,
                                   .cell = world->contact.cell,
                                   .iterations = world->contact.def.iterations,
                                   .springs = world->contact.def.stop == BRUNT_STOP_SPRING,
                                   .look = facets ? facets->look * world->contact.cell : 0,
                                   .step = (int64_t)world->clock.steps,
                                   .symmetry = world->boundaries.symmetry,
                                   .symmetry_count = world->boundaries.symmetry_count,
                                   .boundaries = world->boundaries.boundary,
                                   .boundary_count = world->boundaries.boundary_count,
                                   .acting = &world->boundaries.acting,
                                   .time = world->clock.time,
                                   .mpm = world->bodies.mpm,
                                   .mpm_count = world->bodies.mpm_count,
                                   .threads = world->settings.threads,
                                   .timer = timer};
}

static bool any_active(const brunt_contact_surface *s, const bool *active) {
    for (int k = 0; k < s->fem_count; k++)
        if (active[k]) return true;
    return false;
}

// Whether nothing comes near anything in this step, as in the one before: there is nothing more to do then. Methods
// with an eye of their own for what is near look themselves.
static bool is_clear(brunt_contact *contact, const brunt_contact_context *m) {
    brunt_contact_surface *s = &contact->surface;
    bool far, clear = !any_active(s, s->motion.was_active);
    for (int r = 0; r < brunt_contact_row_count; r++)
        clear = clear && !(brunt_contact_rows[r]->near && is_used(contact, r));
    if (!clear) return s->motion.rests = false;
    for (int anew = !s->motion.rests; anew <= 1; anew++) { // by the bounds that are kept, then by those of now
        brunt_surface_rest(s, anew, m->threads, m->timer);
        if (brunt_broad_phase(m, &contact->node_to_facet, &far, NULL)) break;
        if (any_active(s, s->active)) continue;
        brunt_surface_rest_moves(s, m->dt);
        memset(contact->frame, 0, sizeof contact->frame); // as of a state that is restored
        return true;
    }
    return s->motion.rests = false;
}

int brunt_surfaces_meet(brunt_world *world, const double gravity[3], double kick, double dt, brunt_error *error) {
    brunt_timer *timer = brunt_pass_timer(&world->timing);
    brunt_contact_context m = brunt_contact_context_of(world, dt, timer);
    m.kick = kick;
    if (is_clear(&world->contact, &m)) return BRUNT_OK;
    memcpy(world->contact.surface.motion.frame, world->contact.frame, sizeof world->contact.surface.motion.frame);
    brunt_surface_bounds(&world->contact.surface, world->settings.threads, timer);
    bool far;
    int failed = brunt_broad_phase(&m, &world->contact.node_to_facet, &far, error);
    if (far) return fail_far(&world->contact, error);
    brunt_contact *contact = &world->contact;
    if (!failed) failed = brunt_node_to_facet_begin(contact->node_to_facet, contact->surface.node_count, error);
    brunt_contact_work work = contact_work(contact);
    const brunt_contact_row *const *rows = brunt_contact_rows;
    const int count = brunt_contact_row_count;
    for (int r = 0; !failed && r < count; r++)
        if (rows[r]->near && is_used(contact, r)) rows[r]->near(&m);
    for (int r = 0; r < count; r++)
        if (!rows[r]->near_alone && is_used(contact, r)) brunt_surface_all_near(&contact->surface);
    if (!failed) brunt_surface_gather_state(&contact->surface, kick, gravity, world->settings.threads, timer);
    for (int r = 0; !failed && r < count; r++) {
        if (!is_used(contact, r)) continue;
        work.memory = contact->memory[r], work.facets = contact->rows >> r & 1;
        failed = rows[r]->act(&m, &work, error);
        contact->memory[r] = work.memory;
    }
    for (int r = 0; !failed && r < count; r++)
        if (rows[r]->account && is_used(contact, r)) work.memory = contact->memory[r], rows[r]->account(&m, &work);
    if (failed) return failed;
    brunt_surface_scatter_velocity(&world->contact.surface, dt, world->settings.threads, timer);
    memcpy(world->contact.frame, world->contact.surface.motion.frame, sizeof world->contact.surface.motion.frame);
    brunt_node_sets_account_contact(&world->boundaries.sets, &world->contact.surface);
    return BRUNT_OK;
}
