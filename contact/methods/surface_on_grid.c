#include "contact/methods/surface_on_grid_parts.h"

#include "contact/planes/followed.h"

enum { GRAIN = 16, MORE_SWEEPS = 4 };

void brunt_surface_on_grid_free(brunt_surface_on_grid *w) {
    if (!w) return;
    void *owned[] = {w->range, w->link,        w->item,       w->contact, w->by_contact, w->place, w->changed,
                     w->near,  w->block_first, w->block_face, w->touch,   w->met,        w};
    for (size_t k = 0; k < sizeof owned / sizeof owned[0]; k++) brunt_free(owned[k]);
}

void brunt_surface_on_grid_validate(const brunt_surface_on_grid *w) {
    for (int32_t l = 0; l < w->link_count; l++)
        BRUNT_ASSERT(w->link[l].contact >= 0 && w->link[l].contact < w->contact_count && isfinite(w->link[l].weight));
    for (int32_t i = 0; i < w->item_count; i++)
        BRUNT_ASSERT(w->item[i].first >= 0 && w->item[i].first + w->item[i].count <= w->link_count);
    for (int32_t i = 0; i < w->contact_count; i++) {
        const contact *c = &w->contact[i];
        BRUNT_ASSERT(c->first >= 0 && c->count >= 0 && c->first + c->count <= w->link_count);
        BRUNT_ASSERT(c->leader >= 0 && c->leader <= i && c->next >= -1 && c->next < w->contact_count);
        BRUNT_ASSERT(c->normal_impulse >= 0);
    }
}

size_t brunt_surface_on_grid_bytes(const brunt_surface_on_grid *w) {
    return w ? w->range_capacity + w->link_capacity + w->item_capacity + w->contact_capacity + w->by_contact_capacity +
                   w->place_capacity + w->changed_capacity + w->near_capacity + w->block_first_capacity +
                   w->block_face_capacity + w->touch_capacity + w->met_capacity
             : 0;
}

// Velocity of the mesh at a contact, of the surface's `of`.
static void map_velocity(const job *j, const contact *c, double (*of)[3], double v[3]) {
    const brunt_surface_on_grid *w = j->w;
    v[0] = v[1] = v[2] = 0;
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &w->link[w->by_contact[i]];
        const double m = l->weight * j->m->surface->mass[l->surface] / c->mass;
        for (int a = 0; a < 3; a++) v[a] += m * l->sign[a] * of[l->surface][a];
    }
}

// Brings one contact to its complementarity condition, as far as mesh and body are concerned there; returns the change
// of velocity [m/s].
static double solve_contact(const job *j, contact *c, double vs[3]) {
    double v[3], slip[3], along, normal_inverse = c->held ? 0 : c->inverse_s[0], friction_inverse = normal_inverse;
    memset(c->applied, 0, sizeof c->applied);
    if (!isfinite(c->target)) return 0;
    map_velocity(j, c, j->m->surface->v, v);
    for (int a = 0; a < 3; a++) slip[a] = vs[a] - v[a];
    along = dot(slip, c->n);
    for (int a = 0; a < 3; a++) {
        slip[a] -= along * c->n[a];
        normal_inverse += c->n[a] * c->n[a] * (c->held ? c->inverse[a] + c->inverse_s[a] : c->inverse[a]);
        friction_inverse = fmax(friction_inverse, c->inverse_s[a] + c->inverse[a]);
    }
    if (!(normal_inverse > 0)) return 0; // neither gives way
    const double step = brunt_coulomb_normal(&c->normal_impulse, c->relax * (c->target - along) / normal_inverse);
    double changed = fabs(step) * normal_inverse;
    for (int a = 0; a < 3; a++) c->applied[a] = step * c->n[a];
    if (c->pair->friction > 0) {
        double wanted[3], change[3];
        for (int a = 0; a < 3; a++) wanted[a] = c->friction_impulse[a] - c->relax * slip[a] / friction_inverse;
        brunt_coulomb_project(3, c->pair->friction, c->normal_impulse, wanted, c->friction_impulse, change);
        for (int a = 0; a < 3; a++) c->applied[a] += change[a];
        changed = fmax(changed, brunt_coulomb_norm(3, change) * friction_inverse);
    }
    for (int a = 0; a < 3; a++) vs[a] += c->applied[a] * c->inverse_s[a];
    return changed;
}

static void solve_contacts(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    brunt_surface_on_grid *w = j->w;
    for (int64_t i = j->range->contact + begin; i < j->range->contact + end; i++) {
        w->changed[i] = 0;
        if (w->contact[i].leader != i) continue;
        for (int32_t c = (int32_t)i; c >= 0; c = w->contact[c].next)
            w->changed[i] = fmax(w->changed[i], solve_contact(j, &w->contact[c], w->contact[i].v));
    }
}

// What the mesh's nodes get of what the contacts gave in this sweep (eq. 59).
static void scatter_impulses(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const job *j = context;
    const brunt_surface_on_grid *w = j->w;
    brunt_contact_surface *s = j->m->surface;
    for (int64_t i = j->range->item + begin; i < j->range->item + end; i++) {
        const int32_t n = w->item[i].surface;
        double change[3] = {0};
        for (int32_t l = w->item[i].first; l < w->item[i].first + w->item[i].count; l++) {
            if (!w->link[l].own) continue;
            const contact *c = &w->contact[w->link[l].contact];
            for (int a = 0; a < 3; a++) change[a] -= w->link[l].weight * c->applied[a] / c->mass;
        }
        for (int a = 0; a < 3; a++) {
            s->output.impulse[n][a] += s->mass[n] * change[a];
            if (s->inverse[n][a] > 0) s->v[n][a] += change[a];
        }
    }
}

// The back of a membrane moves with its front.
static void follow_front(brunt_contact_surface *s) {
    for (int k = 0; k < s->fem_count; k++)
        for (int32_t n = s->node_end[k]; s->active[k] && n < s->node_range[k + 1]; n++)
            memcpy(s->v[n], s->v[s->membrane.front[n]], sizeof s->v[n]);
}

// Whether some node of a mesh is met by two bodies. What they squeeze between them passes on in a sweep no more than a
// share of what its own mass can carry.
static int squeezed(brunt_surface_on_grid *w, const brunt_contact_surface *s, bool *found, brunt_error *error) {
    int32_t met = 0;
    *found = false;
    for (int32_t b = 0; b < w->range_count; b++) met += w->range[b].item_end > w->range[b].item;
    if (met < 2) return BRUNT_OK;
    if (RESERVE(w, met, s->node_count + 1, "nodes of surfaces", error)) return BRUNT_FAILED;
    memset(w->met, 0, (size_t)s->node_count * sizeof *w->met);
    for (int32_t i = 0; i < w->item_count && !*found; i++) *found = w->met[w->item[i].surface]++ > 0;
    return BRUNT_OK;
}

static double sweep(job *j) {
    const brunt_contact_context *m = j->m;
    double greatest = 0;
    for (int32_t k = 0; k < j->w->range_count; k++) {
        // What two bodies squeeze between them should not know which of them has the first name.
        const range *r = j->range = &j->w->range[m->step % 2 ? j->w->range_count - 1 - k : k];
        brunt_parallel(m->threads, r->contact_end - r->contact, GRAIN, solve_contacts, j, m->timer);
        brunt_parallel(m->threads, r->item_end - r->item, GRAIN, scatter_impulses, j, m->timer);
        for (int32_t c = r->contact; c < r->contact_end; c++) greatest = fmax(greatest, j->w->changed[c]);
    }
    return greatest;
}

// The node has what all contacts gave it even where it is held: the condition then takes it, and records it.
static void scatter_node(const brunt_surface_on_grid *w, int32_t leader, int dim) {
    const contact *first = &w->contact[leader];
    for (int a = 0; a < dim; a++) {
        double v = first->v[a];
        for (int32_t c = leader; c >= 0 && !(first->inverse_s[a] > 0); c = w->contact[c].next)
            v += (w->contact[c].normal_impulse * w->contact[c].n[a] + w->contact[c].friction_impulse[a]) /
                 (double)first->at[BRUNT_NODE_MASS];
        first->at[BRUNT_NODE_VELOCITY + a] = (real)v;
    }
}

int brunt_surface_on_grid_meet(const brunt_contact_context *m, int sweeps, brunt_surface_on_grid **work,
                               brunt_error *error) {
    if (!*work && BRUNT_NEW(*work, 1, "room for meshes at the points' grid", error)) return BRUNT_FAILED;
    brunt_surface_on_grid *w = *work;
    job j = {.m = m, .w = w};
    w->range_count = w->link_count = w->item_count = w->contact_count = 0;
    if (RESERVE(w, range, m->mpm_count + 1, "bodies of material points", error)) return BRUNT_FAILED;
    for (int b = 0; b < m->mpm_count; b++)
        if (brunt_surface_on_grid_link(&j, b, error)) return BRUNT_FAILED;
    if (!w->contact_count) return BRUNT_OK;
    if (brunt_surface_on_grid_sort(w, error)) return BRUNT_FAILED;
    for (int32_t b = 0; b < w->range_count; b++) {
        if (brunt_surface_on_grid_look(&j, b, error)) return BRUNT_FAILED;
        if (m->symmetry_count) brunt_surface_on_grid_reflect(&j);
    }
    bool two;
    if (squeezed(w, m->surface, &two, error)) return BRUNT_FAILED;
    for (int k = 0; k < (two ? MORE_SWEEPS : 1) * sweeps; k++)
        if (!(sweep(&j) > 0)) break;
    for (int32_t i = 0; i < w->contact_count; i++)
        if (w->contact[i].leader == i) scatter_node(w, i, m->mpm[w->contact[i].mpm].grid.dim);
    follow_front(m->surface);
    return BRUNT_OK;
}

static void account_contact(const job *j, const contact *c) {
    const int dim = j->m->mpm[c->mpm].grid.dim;
    const double sign = j->m->mpm[c->mpm].index > j->m->surface->fem[c->fem]->index ? 1 : -1,
                 own = (double)(c->at[BRUNT_NODE_SPARE] / c->at[BRUNT_NODE_MASS]);
    static const double rest[3] = {0, 0, 0};
    double normal_impulse[3], friction_impulse[3], old[3], now[3];
    map_velocity(j, c, j->m->surface->old, old);
    map_velocity(j, c, j->m->surface->v, now);
    for (int a = 0; a < 3; a++) {
        normal_impulse[a] = sign * own * c->normal_impulse * c->n[a],
        friction_impulse[a] = sign * own * c->friction_impulse[a];
        old[a] = sign * ((a < dim ? (double)c->at[BRUNT_NODE_OLD + a] : 0) - old[a]);
        now[a] = sign * ((a < dim ? (double)c->at[BRUNT_NODE_VELOCITY + a] : 0) - now[a]);
    }
    brunt_impulse_account *last = &c->pair->last;
    brunt_impulse_account_record(last, &last->normal_loss, normal_impulse, c->x, old, now, rest);
    if (c->pair->friction > 0)
        brunt_impulse_account_record(last, &last->friction_loss, friction_impulse, c->x, old, now, rest);
    last->area += own * c->area;
}

static void mark_state(const job *j, const contact *c) {
    brunt_contact_surface *s = j->m->surface;
    const bool slips =
        !(dot(c->friction_impulse, c->friction_impulse) < (1 - 1e-9) * pow(c->pair->friction * c->normal_impulse, 2));
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &j->w->link[j->w->by_contact[i]];
        if (!l->own) continue;
        s->output.gap[l->surface] = fmin(s->output.gap[l->surface], c->gap);
        if (slips || !s->output.state[l->surface]) s->output.state[l->surface] = slips ? 2 : 1;
    }
}

// Across a symmetry plane the two do not get the same, each being the half of a whole: the rest is the plane's.
static void account_symmetry(const job *j, const contact *c, brunt_boundary *boundaries) {
    const brunt_grid *grid = &j->m->mpm[c->mpm].grid;
    const double own = (double)(c->at[BRUNT_NODE_SPARE] / c->at[BRUNT_NODE_MASS]);
    static const double none[3] = {0};
    double applied = 0;
    for (int32_t i = c->first; i < c->first + c->count; i++) {
        const link *l = &j->w->link[j->w->by_contact[i]];
        applied += l->own ? l->weight * j->m->surface->mass[l->surface] / c->mass : 0;
    }
    brunt_symmetry_plane plane[BRUNT_MAX_PLANES];
    const int count = brunt_symmetry_of(j->m, &j->m->mpm[c->mpm], plane);
    int32_t at[3];
    brunt_node_coordinates(grid, c->slot, c->node, at);
    for (int a = 0; a < grid->dim; a++) {
        double share[BRUNT_MAX_PLANES], across[3] = {0};
        brunt_symmetry_shares(plane, count, at, a, share);
        for (int m = 0; m < count; m++) {
            if (!brunt_symmetry_carries(&plane[m], at, a) || plane[m].boundary < 0) continue;
            across[a] = share[m] * (own - applied) * (c->normal_impulse * c->n[a] + c->friction_impulse[a]);
            brunt_impulse_account_reaction(&boundaries[plane[m].boundary].last, across, none);
        }
    }
}

void brunt_surface_on_grid_finish(const brunt_contact_context *m, const brunt_surface_on_grid *work) {
    if (!work) return;
    job j = {.m = m, .w = (brunt_surface_on_grid *)work};
    for (int32_t i = 0; i < work->contact_count; i++) {
        const contact *c = &work->contact[i];
        if (!(c->normal_impulse > 0)) continue;
        account_contact(&j, c);
        mark_state(&j, c);
        if (m->symmetry_count) account_symmetry(&j, c, m->boundaries);
    }
}
