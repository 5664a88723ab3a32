// Named groups of nodes that are held, moved or loaded.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/vector.h"
#include "boundary/curve.h"
#include "boundary/damping.h"
#include "boundary/gas.h"
#include "boundary/node_sets.h"

enum { GRAIN = 512, AHEAD = 12 }; // AHEAD: nodes of a group that are fetched meanwhile

// A load of 0, whatever its table says, is none: no forces are kept and no pass runs.
static bool is_idle(const brunt_node_set *set) {
    bool idle = set->does->values > 0;
    for (int a = 0; a < set->does->values; a++) idle = idle && set->def.value[a] == 0;
    return idle;
}

static bool loads(const brunt_node_set *set) { return !set->does->moves && !is_idle(set); }

// ------------------------------------------------------------------------------------------ making

static void list_groups(const brunt_fem_body *fem, char *out, size_t size) {
    size_t used = 0;
    out[0] = 0;
    for (int32_t g = 0; g < fem->group_count && used < size; g++)
        used += (size_t)snprintf(out + used, size - used, "%s%s", g ? ", " : "", fem->groups[g].name);
    if (!fem->group_count) snprintf(out, size, "none");
}

// Room for the faces, and for what acts on their nodes.
static int reserve_arrays(brunt_node_set *set, int32_t faces, brunt_error *error) {
    const size_t components = (size_t)(set->node_count + 1) * 3;
    if (BRUNT_NEW(set->place, set->fem->node_count + 1, "places of nodes in a group", error) ||
        BRUNT_NEW(set->force, components, "forces on nodes of a group", error) ||
        BRUNT_NEW(set->face, faces + 1, "faces of a group", error))
        return BRUNT_FAILED;
    if (set->does->gas && BRUNT_NEW(set->area, components, "areas of nodes of a group", error)) return BRUNT_FAILED;
    if (!set->fem->bonds) return BRUNT_OK;
    if (BRUNT_NEW(set->whole, faces + 1, "faces of a group", error)) return BRUNT_FAILED;
    return BRUNT_NEW(set->owner, faces + 1, "elements of faces of a group", error);
}

// The faces whose nodes are all in the group.
static int take_faces(brunt_node_set *set, brunt_messages *messages, brunt_error *error) {
    const brunt_fem_body *fem = set->fem;
    brunt_faces faces;
    int status = brunt_fem_faces(fem, &faces, error);
    if (status) return status;
    status = reserve_arrays(set, faces.count, error);
    for (int32_t i = 0; !status && i < set->node_count; i++) set->place[set->node[i]] = i + 1;
    for (int32_t f = 0; !status && f < faces.count; f++) {
        bool all = true;
        for (int c = 0; c < 4; c++) all = all && (faces.node[f][c] < 0 || set->place[faces.node[f][c]]);
        if (!all) continue;
        memcpy(set->face[set->face_count++], faces.node[f], sizeof *set->face);
        if (!set->whole) continue;
        memcpy(set->whole[set->whole_count], faces.node[f], sizeof *set->face);
        set->owner[set->whole_count++] = fem->element_id[faces.element[f]];
    }
    brunt_faces_free(&faces);
    if (status) return status;
    if (!set->face_count)
        brunt_warn(messages, "boundaries (%s): no face of the body has all its nodes in the group: nothing is loaded",
                   set->boundary->name);
    return BRUNT_OK;
}

const brunt_node_set *brunt_node_sets_follow(brunt_node_sets *sets, brunt_fem_body *fem, int32_t *element) {
    const brunt_node_set *opened = NULL;
    for (int k = sets->first[fem - sets->fem]; k != BRUNT_NONE; k = sets->set[k].next) {
        brunt_node_set *set = &sets->set[k];
        if (!set->whole_count) continue;
        brunt_fem_ranks(fem);
        set->face_count = 0;
        for (int32_t f = 0; f < set->whole_count; f++) {
            if (fem->rank[set->owner[f]] >= 0)
                memcpy(set->face[set->face_count++], set->whole[f], sizeof *set->face);
            else if (set->does->gas && !opened)
                opened = set, *element = set->owner[f];
        }
    }
    return opened;
}

static int make_load(brunt_node_set *set, brunt_messages *messages, brunt_error *error) {
    brunt_fem_body *fem = set->fem;
    if (!fem->load && BRUNT_NEW(fem->load, (size_t)(fem->node_count + 1) * 4, "loads on nodes of a mesh", error))
        return BRUNT_FAILED;
    int status = take_faces(set, messages, error);
    if (status) return status;
    return set->does->start ? set->does->start(set, error) : BRUNT_OK;
}

static bool same_table(const brunt_curve *a, const brunt_curve *b) {
    bool same = a->count == b->count;
    for (int32_t i = 0; same && i < a->count; i++)
        same = a->points[i][0] == b->points[i][0] && a->points[i][1] == b->points[i][1];
    return same;
}

static bool same_turn(const brunt_rotation_def *a, const brunt_rotation_def *b) {
    bool same = a->angle == b->angle;
    for (int c = 0; c < 3; c++) same = same && a->axis[c] == b->axis[c] && a->about[c] == b->about[c];
    return same;
}

// Whether a set leaves component c where it is: a turn does along its axis.
static bool keeps(const brunt_node_set *set, int c) {
    const double *axis = set->def.rotation.axis;
    return set->does->turns ? axis[(c + 1) % 3] == 0 && axis[(c + 2) % 3] == 0 : set->def.value[c] == 0;
}

// Components of `both` that two sets move each in its own way. A turn that comes later, about an axis along which an
// earlier set pushes, is meant to go along.
static unsigned disagree(const brunt_node_set *later, const brunt_node_set *earlier, unsigned both) {
    const brunt_group_def *a = &later->def, *b = &earlier->def;
    const bool alike = a->action == b->action && same_table(&a->table, &b->table) &&
                       (!later->does->turns || same_turn(&a->rotation, &b->rotation));
    for (int c = 0; c < 3; c++)
        if ((keeps(later, c) && (later->does->turns || keeps(earlier, c))) || (alike && a->value[c] == b->value[c]))
            both &= ~(1u << c);
    return both;
}

// Says which sets before this one have nodes of it, each once. Nodes of groups ascend.
static void warn_of_taken(const brunt_node_sets *sets, const brunt_node_set *set, unsigned wanted,
                          brunt_messages *messages) {
    for (const brunt_node_set *other = sets->set; other < set; other++) {
        if (other->fem != set->fem || !other->holds) continue;
        unsigned lost = 0;
        int32_t count = 0;
        for (int32_t i = 0, j = 0; i < set->node_count; i++) {
            while (j < other->node_count && other->node[j] < set->node[i]) j++;
            if (j == other->node_count || other->node[j] != set->node[i]) continue;
            const unsigned here = disagree(set, other, wanted & other->holds[j]);
            lost |= here, count += here != 0;
        }
        if (!count) continue;
        brunt_warn(messages,
                   "boundaries (%s): %d of the %d nodes of group '%s' of body '%s' are moved by boundaries (%s) along"
                   "%s%s%s: it comes first, and '%s' does not move them there",
                   set->boundary->name, (int)count, (int)set->node_count, set->def.group, set->def.body,
                   other->boundary->name, lost & 1 ? " x" : "", lost & 2 ? " y" : "", lost & 4 ? " z" : "",
                   set->boundary->name);
    }
}

// Marks the components that a set prescribes: the first that does has them.
static int make_prescribed(brunt_node_sets *sets, brunt_node_set *set, brunt_messages *messages, brunt_error *error) {
    brunt_fem_body *fem = set->fem;
    uint8_t **taken = &sets->taken[set->fem_index];
    if (!fem->held && BRUNT_NEW(fem->held, fem->node_count + 1, "nodes that are held", error)) return BRUNT_FAILED;
    if (!*taken && BRUNT_NEW(*taken, fem->node_count + 1, "nodes that are held", error)) return BRUNT_FAILED;
    if (BRUNT_NEW(set->holds, set->node_count + 1, "nodes that are held", error) ||
        BRUNT_NEW(set->internal, 3 * (size_t)(set->node_count + 1), "forces on nodes that are held", error))
        return BRUNT_FAILED;
    unsigned wanted = 0, lost = 0;
    for (int a = 0; a < fem->dim; a++) wanted |= (unsigned)set->def.component[a] << a;
    for (int32_t i = 0; i < set->node_count; i++) {
        const int32_t n = set->node[i];
        lost |= wanted & (*taken)[n];
        set->holds[i] = (uint8_t)(wanted & ~(unsigned)(*taken)[n]);
        (*taken)[n] |= set->holds[i], fem->held[n] |= set->holds[i];
    }
    if (lost) warn_of_taken(sets, set, wanted, messages);
    return BRUNT_OK;
}

// The body and the group of its mesh that a set is of.
static int find_nodes(brunt_node_set *set, const brunt_bodies *bodies, brunt_error *error) {
    const brunt_group_def *def = &set->def;
    const int body = brunt_bodies_find(bodies, def->body);
    set->fem = body < 0 ? NULL : bodies->all[body].fem;
    if (set->fem) set->fem_index = (int)(set->fem - bodies->fem);
    if (!set->fem)
        return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).body: there is no finite-element body '%s'",
                          set->boundary->name, def->body);
    const brunt_fem_body *fem = set->fem;
    set->boundary->body = fem->index;
    const brunt_group *group = NULL;
    for (int32_t g = 0; g < fem->group_count; g++)
        if (!strcmp(fem->groups[g].name, def->group)) group = &fem->groups[g];
    if (group) {
        set->node = group->nodes, set->node_count = group->count;
        return BRUNT_OK;
    }
    char names[600];
    list_groups(fem, names, sizeof names);
    return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).group: body '%s' has no group '%s'; it has: %s",
                      set->boundary->name, def->body, def->group, names);
}

// A definition, with a curve of its own. In load steps what has none grows from nothing, but velocities: motion does.
static int copy_definition(brunt_group_def *copy, const brunt_group_def *def, bool load_steps, brunt_error *error) {
    static const double ramp[][2] = {{0, 0}, {1, 1}};
    const brunt_curve grows = {.points = (double(*)[2])ramp, .count = BRUNT_COUNT(ramp)};
    const brunt_group_row *does = &brunt_group_rows[def->action];
    const bool ramped = load_steps && !def->table.count && (!does->moves || does->goal);
    const brunt_curve *table = ramped ? &grows : &def->table;
    *copy = *def;
    return brunt_curve_copy(&copy->table, table, error);
}

// Which sets each body has, in their order, and which have gas.
static void list_sets(brunt_node_sets *sets) {
    for (int i = 0; i < sets->fem_count; i++) sets->first[i] = BRUNT_NONE;
    for (int k = sets->count; k-- > 0;) {
        int *first = &sets->first[sets->set[k].fem_index];
        sets->set[k].next = *first, *first = k;
    }
    for (int k = 0; k < sets->count; k++)
        if (sets->set[k].does->gas) sets->gas[sets->gas_count++] = k;
}

int brunt_node_sets_make(brunt_node_sets *sets, const brunt_world_def *def, const brunt_bodies *bodies,
                         brunt_boundary *boundaries, brunt_messages *messages, brunt_error *error) {
    if (BRUNT_NEW(sets->set, def->group_count + 1, "groups of nodes", error) ||
        BRUNT_NEW(sets->gas, def->group_count + 1, "groups of nodes", error) ||
        BRUNT_NEW(sets->first, bodies->fem_count + 1, "meshes with groups", error) ||
        BRUNT_NEW(sets->taken, bodies->fem_count + 1, "meshes with groups", error))
        return BRUNT_FAILED;
    sets->count = def->group_count, sets->fem_count = bodies->fem_count, sets->fem = bodies->fem;
    for (int k = 0; k < sets->count; k++) {
        brunt_node_set *set = &sets->set[k];
        set->boundary = &boundaries[k];
        if (copy_definition(&set->def, &def->groups[k], def->scheme == BRUNT_STATIC, error)) return BRUNT_FAILED;
        set->boundary->group = &set->def;
        set->does = &brunt_group_rows[set->def.action];
        int status = find_nodes(set, bodies, error);
        if (status) return status;
        for (int32_t i = 1; i < set->def.table.count; i++)
            if (!(set->def.table.points[i][0] > set->def.table.points[i - 1][0]))
                return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).table: times must grow from point to point",
                                  set->boundary->name);
        if (is_idle(set)) continue;
        status = set->does->moves ? make_prescribed(sets, set, messages, error) : make_load(set, messages, error);
        if (status) return status;
        sets->act = true;
        sets->has_gas = sets->has_gas || set->does->gas;
    }
    list_sets(sets);
    return BRUNT_OK;
}

void brunt_node_sets_free(brunt_node_sets *sets) {
    for (int k = 0; k < sets->count; k++) {
        brunt_node_set *set = &sets->set[k];
        brunt_free(set->holds);
        brunt_free(set->internal);
        brunt_free(set->face);
        brunt_free(set->whole);
        brunt_free(set->owner);
        brunt_free(set->force);
        brunt_free(set->place);
        brunt_free(set->area);
        brunt_free(set->def.table.points);
    }
    for (int k = 0; k < sets->fem_count; k++) brunt_free(sets->taken[k]);
    brunt_free(sets->set);
    brunt_free(sets->first);
    brunt_free(sets->gas);
    brunt_free(sets->taken);
}

void brunt_node_sets_validate(const brunt_node_sets *sets) {
    int listed = 0;
    for (int i = 0; i < sets->fem_count; i++)
        for (int k = sets->first[i], before = -1; k != BRUNT_NONE; before = k, k = sets->set[k].next, listed++)
            BRUNT_ASSERT(k > before && k < sets->count && sets->set[k].fem_index == i);
    BRUNT_ASSERT(listed == sets->count && sets->gas_count >= 0 && sets->gas_count <= sets->count);
    for (int k = 0; k < sets->count; k++) {
        const brunt_node_set *set = &sets->set[k];
        BRUNT_ASSERT(set->fem && set->boundary && set->boundary->group == &set->def);
        BRUNT_ASSERT(set->does->moves ? set->holds && set->fem->held : is_idle(set) || (set->force && set->fem->load));
        BRUNT_ASSERT(set->face_count >= 0 && (!set->whole || set->face_count <= set->whole_count));
        BRUNT_ASSERT(!set->does->gas || set->gas_energy >= 0);
    }
}

// ------------------------------------------------------------------------------------------ loads

// Corners of a face: where its nodes are, or were at the start.
static void face_corners(const brunt_fem_body *fem, const int32_t node[4], bool start, double (*x)[3]) {
    for (int c = 0; c < 4 && node[c] >= 0; c++)
        for (int a = 0; a < 3; a++)
            x[c][a] = (double)(start ? fem->start[4 * (size_t)node[c] + (size_t)a] : brunt_fem_node(fem, node[c])[a]);
}

// With x = m + a xi + b eta + c xi eta, the normal (a + c eta) x (b + c xi) = a x b + xi a x c + eta c x b is linear,
// and int N = 1, int N xi = s / 3, int N eta = t / 3 for the corner at xi = s, eta = t.
static void quad_shares(const double (*x)[3], double (*share)[3]) {
    static const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    double a[3], b[3], c[3], flat[3], along[3], across[3];
    for (int k = 0; k < 3; k++) {
        const double p = x[2][k] - x[0][k], q = x[3][k] - x[1][k];
        a[k] = 0.25 * (p - q), b[k] = 0.25 * (p + q);
        c[k] = 0.25 * ((x[0][k] - x[1][k]) + (x[2][k] - x[3][k]));
    }
    cross(a, b, flat);
    cross(a, c, along);
    cross(c, b, across);
    for (int n = 0; n < 4; n++)
        for (int k = 0; k < 3; k++) share[n][k] = flat[k] + (sign[n][0] * along[k] + sign[n][1] * across[k]) / 3;
}

void brunt_face_shares(const double (*x)[3], int corners, double (*share)[3]) {
    if (corners == 4) {
        quad_shares(x, share);
        return;
    }
    double e[3], g[3], normal[3];
    if (corners == 2) {
        normal[0] = 0.5 * (x[1][1] - x[0][1]), normal[1] = -0.5 * (x[1][0] - x[0][0]), normal[2] = 0;
    } else {
        for (int k = 0; k < 3; k++) e[k] = x[1][k] - x[0][k], g[k] = x[2][k] - x[0][k];
        cross(e, g, normal);
        for (int k = 0; k < 3; k++) normal[k] /= 6;
    }
    for (int n = 0; n < corners; n++) memcpy(share[n], normal, sizeof normal);
}

// Of rings, those of the whole circle: 2 pi int N_a r n ds, r being linear along the face. A pressure on them is the
// slope of the volume pi int r^2 dz that they enclose.
static void axisymmetric_shares(const double (*x)[3], double (*share)[3]) {
    for (int c = 0; c < 2; c++) {
        const double around = M_PI / 3 * (x[0][0] + x[1][0] + x[c][0]);
        share[c][0] = around * (x[1][1] - x[0][1]), share[c][1] = around * (x[0][0] - x[1][0]), share[c][2] = 0;
    }
}

static void make_forces(brunt_node_set *set, double time, double dt) {
    brunt_fem_body *fem = set->fem;
    const brunt_group_def *def = &set->def;
    const bool axisymmetric = fem->element->axisymmetric;
    const bool traction = !set->does->push;
    double push = traction ? 0 : set->does->push(set, time, dt);
    double factor = traction ? brunt_curve_at(&def->table, time) : 0;
    memset(set->force, 0, (size_t)set->node_count * 3 * sizeof *set->force);
    for (int32_t f = 0; f < set->face_count; f++) {
        const int32_t *node = set->face[f];
        const int corners = node[2] < 0 ? 2 : node[3] < 0 ? 3 : 4;
        double x[4][3], shares[4][3];
        face_corners(fem, node, traction, x);
        if (axisymmetric)
            axisymmetric_shares((const double(*)[3])x, shares);
        else
            brunt_face_shares((const double(*)[3])x, corners, shares);
        for (int c = 0; c < corners; c++) {
            const double *share = shares[c];
            double *force = set->force + 3 * (set->place[node[c]] - 1);
            double size = sqrt(share[0] * share[0] + share[1] * share[1] + share[2] * share[2]);
            for (int a = 0; a < fem->dim; a++) force[a] += traction ? factor * def->value[a] * size : push * share[a];
        }
    }
    for (int32_t i = 0; axisymmetric && i < set->node_count; i++)
        if (fem->start[4 * (size_t)set->node[i]] == 0) set->force[3 * i] = 0; // the axis carries it
    for (int32_t i = 0; i < set->node_count; i++)
        for (int a = 0; a < 3; a++) fem->load[4 * (size_t)set->node[i] + (size_t)a] += (real)set->force[3 * i + a];
}

// Half of the work of the loads, at the velocities as they are; with `impulse`, that too.
static void account_loads(const brunt_node_set *set, double dt, bool impulse) {
    const brunt_fem_body *fem = set->fem;
    brunt_impulse_account *last = &set->boundary->last;
    double work = 0;
    for (int32_t i = 0; i < set->node_count; i++) {
        const real *node = brunt_fem_node(fem, set->node[i]);
        const double *F = set->force + 3 * i;
        for (int a = 0; a < 3; a++) {
            int k = (a + 1) % 3, l = (a + 2) % 3;
            work += 0.5 * dt * F[a] * (double)node[BRUNT_FEM_V + a];
            if (!impulse) continue;
            last->impulse[a] += dt * F[a];
            last->angular[a] += dt * ((double)node[k] * F[l] - (double)node[l] * F[k]);
        }
    }
    last->external_work += work;
}

void brunt_loads_begin(brunt_node_sets *sets, const brunt_bodies *bodies, double time, double dt) {
    for (int k = 0; k < bodies->fem_count; k++) {
        const brunt_fem_body *fem = &bodies->fem[k];
        if (fem->load) memset(fem->load, 0, (size_t)fem->node_count * 4 * sizeof(real));
    }
    for (int k = 0; k < sets->count; k++) {
        brunt_node_set *set = &sets->set[k];
        if (!loads(set)) continue;
        make_forces(set, time, dt);
        if (set->does->gas && !(set->gas_volume > 0)) sets->gas_lost = set;
        account_loads(set, dt, true);
    }
}

void brunt_loads_end(const brunt_node_sets *sets, double dt) {
    for (int k = 0; k < sets->count; k++)
        if (loads(&sets->set[k])) account_loads(&sets->set[k], dt, false);
}

// ------------------------------------------------------------------------------------------ prescribed motion

brunt_placement brunt_node_set_goal(const brunt_node_set *set, double time) {
    const brunt_group_def *def = &set->def;
    return set->does->goal ? set->does->goal(def, brunt_curve_at(&def->table, time)) : brunt_placement_identity();
}

double brunt_node_set_way(const brunt_node_set *set, const brunt_placement *goal, int32_t node, int a) {
    const real *start = set->fem->start + 4 * (size_t)node;
    double x = goal->translation[a];
    for (int b = 0; b < 3; b++) x += goal->rotation[3 * a + b] * (double)start[b];
    return x - (double)brunt_fem_node(set->fem, node)[BRUNT_FEM_X + a];
}

static void gather_forces(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const brunt_node_set *set = context;
    for (int64_t i = begin; i < end; i++) {
        if (i + AHEAD < end) brunt_fem_fetch_force(set->fem, set->node[i + AHEAD]);
        if (!brunt_fem_removed(set->fem, set->node[i]))
            brunt_fem_internal_force(set->fem, set->node[i], set->internal + 3 * i);
    }
}

static void prescribe(brunt_node_set *set, const brunt_kick *kick, double time, double step) {
    const brunt_group_def *def = &set->def;
    brunt_fem_body *fem = set->fem;
    brunt_impulse_account *last = &set->boundary->last;
    const double now = brunt_curve_at(&def->table, time + 0.5 * step);
    const brunt_placement goal = brunt_node_set_goal(set, time + step);
    const double dt = kick->dt;
    brunt_parallel(kick->threads, set->node_count, GRAIN, gather_forces, set, kick->timer);
    for (int32_t i = 0; i < set->node_count; i++) {
        const int32_t n = set->node[i];
        if (i + AHEAD < set->node_count) __builtin_prefetch(brunt_fem_node(fem, set->node[i + AHEAD]), 1);
        if (brunt_fem_removed(fem, n)) continue;
        real *node = brunt_fem_node(fem, n);
        const real *force = set->internal + 3 * (size_t)i;
        double J[3] = {0}, x[3], old[3] = {0}, v[3] = {0}, mean[3] = {0};
        for (int a = 0; a < 3; a++) x[a] = (double)node[a];
        for (int a = 0; a < fem->dim; a++) {
            if (!(set->holds[i] >> a & 1)) continue;
            double mass = (double)node[BRUNT_FEM_MASS], trial = (double)node[BRUNT_FEM_V + a];
            double load = fem->load ? (double)fem->load[4 * (size_t)n + (size_t)a] : 0;
            old[a] = trial - dt * (((double)force[a] + load) / mass + kick->gravity[a]);
            v[a] = set->does->goal ? brunt_node_set_way(set, &goal, n, a) / step : now * def->value[a];
            J[a] = mass * fem->damping_mass * (v[a] - trial);
            mean[a] = 0.5 * (old[a] + v[a]);
            node[BRUNT_FEM_V + a] = (real)v[a];
        }
        brunt_impulse_account_record(last, &last->normal_loss, J, x, old, v, mean);
    }
}

void brunt_node_sets_prescribe(const brunt_node_sets *sets, const brunt_kick *kick, double time, double step) {
    for (int k = 0; k < sets->count; k++)
        if (sets->set[k].does->moves) prescribe(&sets->set[k], kick, time, step);
}

// The first of ascending numbers from `at` on that is no less than n; as fast as it is near.
static int32_t advance(const int32_t *number, int32_t at, int32_t end, int32_t n) {
    int32_t step = 1;
    for (; at + step <= end && number[at + step - 1] < n; step *= 2) at += step;
    for (; step; step /= 2)
        if (at + step <= end && number[at + step - 1] < n) at += step;
    return at;
}

static void account_contact(const brunt_node_set *set, const brunt_contact_surface *s) {
    brunt_impulse_account *last = &set->boundary->last;
    const int32_t end = s->node_end[set->fem_index];
    int32_t n = s->node_range[set->fem_index];
    for (int32_t i = 0; i < set->node_count; i++) {
        n = advance(s->node, n, end, set->node[i]);
        if (n == end) return;
        if (s->node[n] != set->node[i] || !s->motion.near[n]) continue;
        for (int a = 0; a < s->dim; a++) {
            if (!(set->holds[i] >> a & 1) || s->output.impulse[n][a] == 0) continue;
            double J[3] = {0};
            J[a] = -s->output.impulse[n][a];
            brunt_impulse_account_record(last, &last->normal_loss, J, s->x[n], s->v[n], s->v[n], s->v[n]);
        }
    }
}

void brunt_node_sets_account_contact(const brunt_node_sets *sets, const brunt_contact_surface *surface) {
    for (int k = 0; k < sets->count && surface->fem_count; k++) {
        const brunt_node_set *set = &sets->set[k];
        if (set->holds && surface->active[set->fem_index]) account_contact(set, surface);
    }
}
