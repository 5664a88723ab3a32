// Named groups of nodes that are held, moved or loaded.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "world/world.h"

double brunt_curve_at(const brunt_curve *curve, double time) {
    if (!curve->count) return 1;
    const double(*p)[2] = (const double(*)[2])curve->points;
    if (time <= p[0][0]) return p[0][1];
    for (int32_t k = 1; k < curve->count; k++)
        if (time < p[k][0])
            return p[k - 1][1] + (p[k][1] - p[k - 1][1]) * (time - p[k - 1][0]) / (p[k][0] - p[k - 1][0]);
    return p[curve->count - 1][1];
}

static bool moves(const brunt_group_def *group) {
    return group->action == BRUNT_GROUP_VELOCITY || group->action == BRUNT_GROUP_DISPLACEMENT;
}

// ------------------------------------------------------------------------------------------ making

static void list_groups(const brunt_fem_body *fem, char *out, size_t size) {
    size_t used = 0;
    out[0] = 0;
    for (int32_t g = 0; g < fem->group_count && used < size; g++)
        used += (size_t)snprintf(out + used, size - used, "%s%s", g ? ", " : "", fem->groups[g].name);
    if (!fem->group_count) snprintf(out, size, "none");
}

// The faces whose nodes are all in the group.
static int take_faces(brunt_world *world, brunt_node_set *hold, const char *name) {
    const brunt_fem_body *fem = &world->bodies.fem[hold->fem];
    brunt_faces faces;
    if (brunt_fem_faces(fem, &faces)) return brunt_fail(NULL, BRUNT_FAILED, "out of memory");
    hold->place = brunt_alloc((size_t)(fem->node_count + 1) * sizeof *hold->place);
    hold->force = brunt_alloc((size_t)(hold->node_count + 1) * 3 * sizeof *hold->force);
    hold->face = brunt_alloc((size_t)(faces.count + 1) * sizeof *hold->face);
    int status = hold->place && hold->force && hold->face ? BRUNT_OK : BRUNT_FAILED;
    if (world->boundaries.sets.def[hold - world->boundaries.sets.set].action == BRUNT_GROUP_GAS) {
        hold->area = brunt_alloc((size_t)(hold->node_count + 1) * 3 * sizeof *hold->area);
        status = hold->area ? status : BRUNT_FAILED;
    }
    if (fem->bonds) {
        hold->whole = brunt_alloc((size_t)(faces.count + 1) * sizeof *hold->whole);
        hold->owner = brunt_alloc((size_t)(faces.count + 1) * sizeof *hold->owner);
        status = hold->whole && hold->owner ? status : BRUNT_FAILED;
    }
    for (int32_t i = 0; !status && i < hold->node_count; i++) hold->place[hold->node[i]] = i + 1;
    for (int32_t f = 0; !status && f < faces.count; f++) {
        bool all = true;
        for (int c = 0; c < 4; c++) all = all && (faces.node[f][c] < 0 || hold->place[faces.node[f][c]]);
        if (!all) continue;
        memcpy(hold->face[hold->face_count++], faces.node[f], sizeof *hold->face);
        if (!hold->whole) continue;
        memcpy(hold->whole[hold->whole_count], faces.node[f], sizeof *hold->face);
        hold->owner[hold->whole_count++] = fem->element_id[faces.element[f]];
    }
    brunt_faces_free(&faces);
    if (!status && !hold->face_count)
        brunt_warn(world, "boundaries (%s): no face of the body has all its nodes in the group: nothing is loaded",
                   name);
    return status;
}

const brunt_node_set *brunt_node_sets_follow(brunt_world *world, int fem, int32_t *element) {
    const brunt_node_set *opened = NULL;
    for (int k = 0; k < world->boundaries.sets.count; k++) {
        brunt_node_set *hold = &world->boundaries.sets.set[k];
        if (hold->fem != fem || !hold->whole_count) continue;
        brunt_fem_ranks(&world->bodies.fem[fem]);
        hold->face_count = 0;
        for (int32_t f = 0; f < hold->whole_count; f++) {
            if (world->bodies.fem[fem].rank[hold->owner[f]] >= 0)
                memcpy(hold->face[hold->face_count++], hold->whole[f], sizeof *hold->face);
            else if (world->boundaries.sets.def[k].action == BRUNT_GROUP_GAS && !opened)
                opened = hold, *element = hold->owner[f];
        }
    }
    return opened;
}

static int make_hold(brunt_world *world, int index, brunt_error *error) {
    brunt_node_set *hold = &world->boundaries.sets.set[index];
    const brunt_group_def *def = &world->boundaries.sets.def[index];
    brunt_wall *wall = &world->boundaries.walls[hold->wall];
    hold->fem = -1;
    for (int k = 0; k < world->bodies.fem_count; k++)
        if (!strcmp(world->bodies.fem[k].name, def->body)) hold->fem = k;
    if (hold->fem < 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).body: there is no finite-element body '%s'",
                          wall->name, def->body);
    brunt_fem_body *fem = &world->bodies.fem[hold->fem];
    wall->body = fem->index;
    const brunt_group *group = NULL;
    for (int32_t g = 0; g < fem->group_count; g++)
        if (!strcmp(fem->groups[g].name, def->group)) group = &fem->groups[g];
    if (!group) {
        char names[600];
        list_groups(fem, names, sizeof names);
        return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).group: body '%s' has no group '%s'; it has: %s",
                          wall->name, def->body, def->group, names);
    }
    for (int32_t k = 1; k < def->table.count; k++)
        if (!(def->table.points[k][0] > def->table.points[k - 1][0]))
            return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).table: times must grow from point to point",
                              wall->name);
    hold->node = group->nodes, hold->node_count = group->count;
    if (!moves(def)) {
        if (!fem->load && !(fem->load = brunt_alloc((size_t)(fem->node_count + 1) * 4 * sizeof(real))))
            return brunt_fail(error, BRUNT_FAILED, "out of memory");
        if (take_faces(world, hold, wall->name)) return brunt_fail(error, BRUNT_FAILED, "out of memory");
        return def->action == BRUNT_GROUP_GAS ? brunt_gas_start(world, hold, def, error) : BRUNT_OK;
    }
    if (!fem->held && !(fem->held = brunt_alloc((size_t)fem->node_count + 1)))
        return brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (!world->boundaries.sets.holder[hold->fem] &&
        !(world->boundaries.sets.holder[hold->fem] =
              brunt_alloc(((size_t)fem->node_count + 1) * sizeof **world->boundaries.sets.holder)))
        return brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int32_t i = 0; i < hold->node_count; i++)
        for (int a = 0; a < world->settings.dimension; a++) {
            if (!def->component[a] || world->boundaries.sets.holder[hold->fem][hold->node[i]][a]) continue;
            fem->held[hold->node[i]] |= (uint8_t)(1 << a);
            world->boundaries.sets.holder[hold->fem][hold->node[i]][a] = (uint8_t)(index + 1);
        }
    return BRUNT_OK;
}

int brunt_node_sets_make(brunt_world *world, const brunt_world_def *def, brunt_error *error) {
    world->boundaries.sets.count = def->group_count;
    if (def->group_count > 255) return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries: more than 255 groups");
    world->boundaries.sets.set = brunt_alloc((size_t)(def->group_count + 1) * sizeof *world->boundaries.sets.set);
    world->boundaries.sets.def = brunt_alloc((size_t)(def->group_count + 1) * sizeof *world->boundaries.sets.def);
    world->boundaries.sets.holder =
        brunt_alloc((size_t)(world->bodies.fem_count + 1) * sizeof *world->boundaries.sets.holder);
    if (!world->boundaries.sets.set || !world->boundaries.sets.def || !world->boundaries.sets.holder)
        return brunt_fail(error, BRUNT_FAILED, "out of memory");
    for (int k = 0; k < def->group_count; k++) {
        brunt_group_def *group = &world->boundaries.sets.def[k];
        *group = def->groups[k];
        group->table.points = NULL;
        if (group->table.count) {
            size_t bytes = (size_t)group->table.count * sizeof *group->table.points;
            if (!(group->table.points = brunt_alloc(bytes))) return brunt_fail(error, BRUNT_FAILED, "out of memory");
            memcpy(group->table.points, def->groups[k].table.points, bytes);
        }
        world->boundaries.sets.set[k].wall = world->boundaries.wall_count - def->group_count + k;
        world->boundaries.walls[world->boundaries.sets.set[k].wall].group = group;
        int status = make_hold(world, k, error);
        if (status) return status;
    }
    return BRUNT_OK;
}

void brunt_node_sets_free(brunt_world *world) {
    for (int k = 0; k < world->boundaries.sets.count && world->boundaries.sets.set; k++) {
        brunt_free(world->boundaries.sets.set[k].face);
        brunt_free(world->boundaries.sets.set[k].whole);
        brunt_free(world->boundaries.sets.set[k].owner);
        brunt_free(world->boundaries.sets.set[k].force);
        brunt_free(world->boundaries.sets.set[k].place);
        brunt_free(world->boundaries.sets.set[k].area);
    }
    for (int k = 0; k < world->boundaries.sets.count && world->boundaries.sets.def; k++)
        brunt_free(world->boundaries.sets.def[k].table.points);
    for (int k = 0; k < world->bodies.fem_count && world->boundaries.sets.holder; k++)
        brunt_free(world->boundaries.sets.holder[k]);
    brunt_free(world->boundaries.sets.set);
    brunt_free(world->boundaries.sets.def);
    brunt_free(world->boundaries.sets.holder);
}

// ------------------------------------------------------------------------------------------ loads

// Corners of a face: where its nodes are, or were at the start.
static void face_corners(const brunt_fem_body *fem, const int32_t node[4], bool start, double (*x)[3]) {
    for (int c = 0; c < 4 && node[c] >= 0; c++)
        for (int a = 0; a < 3; a++)
            x[c][a] = (double)(start ? fem->start[4 * (size_t)node[c] + (size_t)a] : brunt_fem_node(fem, node[c])[a]);
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
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
static void ring_shares(const double (*x)[3], double (*share)[3]) {
    for (int c = 0; c < 2; c++) {
        const double around = M_PI / 3 * (x[0][0] + x[1][0] + x[c][0]);
        share[c][0] = around * (x[1][1] - x[0][1]), share[c][1] = around * (x[0][0] - x[1][0]), share[c][2] = 0;
    }
}

static void make_forces(brunt_world *world, brunt_node_set *hold, const brunt_group_def *def, double time, double dt) {
    brunt_fem_body *fem = &world->bodies.fem[hold->fem];
    const bool traction = def->action == BRUNT_GROUP_TRACTION;
    double push = def->action == BRUNT_GROUP_GAS ? brunt_gas_push(world, hold, def, time, dt)
                                                 : -def->value[0] * brunt_curve_at(&def->table, time);
    double factor = traction ? brunt_curve_at(&def->table, time) : 0;
    memset(hold->force, 0, (size_t)hold->node_count * 3 * sizeof *hold->force);
    for (int32_t f = 0; f < hold->face_count; f++) {
        const int32_t *node = hold->face[f];
        const int corners = node[2] < 0 ? 2 : node[3] < 0 ? 3 : 4;
        double x[4][3], shares[4][3];
        face_corners(fem, node, traction, x);
        if (world->settings.axisymmetric)
            ring_shares((const double(*)[3])x, shares);
        else
            brunt_face_shares((const double(*)[3])x, corners, shares);
        for (int c = 0; c < corners; c++) {
            const double *share = shares[c];
            double *force = hold->force + 3 * (hold->place[node[c]] - 1);
            double size = sqrt(share[0] * share[0] + share[1] * share[1] + share[2] * share[2]);
            for (int a = 0; a < world->settings.dimension; a++)
                force[a] += traction ? factor * def->value[a] * size : push * share[a];
        }
    }
    for (int32_t i = 0; world->settings.axisymmetric && i < hold->node_count; i++)
        if (fem->start[4 * (size_t)hold->node[i]] == 0) hold->force[3 * i] = 0; // the axis bears it
    for (int32_t i = 0; i < hold->node_count; i++)
        for (int a = 0; a < 3; a++) fem->load[4 * (size_t)hold->node[i] + (size_t)a] += (real)hold->force[3 * i + a];
}

// Half of the work of the loads, at the velocities as they are; with `impulse`, that too.
static void book_loads(brunt_world *world, const brunt_node_set *hold, double dt, bool impulse) {
    const brunt_fem_body *fem = &world->bodies.fem[hold->fem];
    brunt_impulse_account *last = &world->boundaries.walls[hold->wall].last;
    double work = 0;
    for (int32_t i = 0; i < hold->node_count; i++) {
        const real *node = brunt_fem_node(fem, hold->node[i]);
        const double *F = hold->force + 3 * i;
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

void brunt_loads_begin(brunt_world *world, double time, double dt) {
    for (int k = 0; k < world->bodies.fem_count; k++)
        if (world->bodies.fem[k].load)
            memset(world->bodies.fem[k].load, 0, (size_t)world->bodies.fem[k].node_count * 4 * sizeof(real));
    for (int k = 0; k < world->boundaries.sets.count; k++) {
        if (moves(&world->boundaries.sets.def[k])) continue;
        make_forces(world, &world->boundaries.sets.set[k], &world->boundaries.sets.def[k], time, dt);
        book_loads(world, &world->boundaries.sets.set[k], dt, true);
    }
}

void brunt_loads_end(brunt_world *world, double dt) {
    for (int k = 0; k < world->boundaries.sets.count; k++)
        if (!moves(&world->boundaries.sets.def[k])) book_loads(world, &world->boundaries.sets.set[k], dt, false);
}

// ------------------------------------------------------------------------------------------ prescribed motion

void brunt_fem_hold_all(brunt_world *world, const double gravity[3], double time, double dt, double step) {
    for (int k = 0; k < world->boundaries.sets.count; k++) {
        const brunt_group_def *def = &world->boundaries.sets.def[k];
        if (!moves(def)) continue;
        const brunt_node_set *hold = &world->boundaries.sets.set[k];
        brunt_fem_body *fem = &world->bodies.fem[hold->fem];
        brunt_impulse_account *last = &world->boundaries.walls[hold->wall].last;
        double now = brunt_curve_at(&def->table, time + 0.5 * step), then = brunt_curve_at(&def->table, time + step);
        for (int32_t i = 0; i < hold->node_count; i++) {
            const int32_t n = hold->node[i];
            if (brunt_fem_removed(fem, n)) continue;
            real *node = brunt_fem_node(fem, n), force[3];
            double J[3] = {0}, x[3], old[3] = {0}, v[3] = {0}, mean[3] = {0};
            brunt_fem_internal_force(fem, n, force);
            for (int a = 0; a < 3; a++) x[a] = (double)node[a];
            for (int a = 0; a < world->settings.dimension; a++) {
                if (world->boundaries.sets.holder[hold->fem][n][a] != k + 1) continue;
                double mass = (double)node[BRUNT_FEM_MASS], trial = (double)node[BRUNT_FEM_V + a];
                double load = fem->load ? (double)fem->load[4 * (size_t)n + (size_t)a] : 0;
                old[a] = trial - dt * (((double)force[a] + load) / mass + gravity[a]);
                v[a] = def->action == BRUNT_GROUP_VELOCITY
                           ? now * def->value[a]
                           : ((double)fem->start[4 * (size_t)n + (size_t)a] + then * def->value[a] - x[a]) / step;
                J[a] = mass * fem->drag_mass * (v[a] - trial);
                mean[a] = 0.5 * (old[a] + v[a]);
                node[BRUNT_FEM_V + a] = (real)v[a];
            }
            brunt_impulse_account_book(last, &last->normal_loss, J, x, old, v, mean);
        }
    }
}

void brunt_fem_hold_contact(brunt_world *world) {
    const brunt_contact_surface *s = &world->contact.surface;
    for (int k = 0; k < s->fem_count && world->boundaries.sets.count; k++) {
        if (!s->active[k] || !world->boundaries.sets.holder[k]) continue;
        for (int32_t n = s->node_range[k]; n < s->node_end[k]; n++)
            for (int a = 0; a < world->settings.dimension; a++) {
                int holder = world->boundaries.sets.holder[k][s->node[n]][a];
                if (!holder || s->impulse[n][a] == 0) continue;
                double J[3] = {0};
                J[a] = -s->impulse[n][a];
                brunt_impulse_account *last =
                    &world->boundaries.walls[world->boundaries.sets.set[holder - 1].wall].last;
                brunt_impulse_account_book(last, &last->normal_loss, J, s->x[n], s->v[n], s->v[n], s->v[n]);
            }
    }
}
