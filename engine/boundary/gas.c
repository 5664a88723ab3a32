// Ideal gas of one pressure and temperature in the volume that a group's faces enclose (the control volume of airbags:
// Wang and Nefske, SAE paper 880654 (1988)): p = (gamma - 1) E / V, dE = -p dV + inflow.
//
// The volume is that of the cone of the faces with a point, 1/3 int (x - o) . n dA, which is the enclosed one when the
// faces close, by themselves or with planes of symmetry through the origin, in which the point then lies. Otherwise it
// is one of the faces' own, so that a volume far from the origin keeps its digits. Its derivative by a node's place is
// int N_a n dA, by which the pressure acts: exact for bilinear faces, so that pressure on a closed surface has neither
// resultant nor torque. Between two steps the gas expands at constant entropy.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/saved.h"
#include "boundary/curve.h"
#include "boundary/gas.h"

static int corners_of(const int32_t node[4]) { return node[3] < 0 ? 3 : 4; }

// As seen from `from`.
static void places(const brunt_fem_body *fem, const int32_t node[4], const double from[3], double (*x)[3]) {
    for (int c = 0; c < corners_of(node); c++)
        for (int a = 0; a < 3; a++) x[c][a] = (double)brunt_fem_node(fem, node[c])[a] - from[a];
}

static void apex_of(const brunt_node_set *set, double apex[3]) {
    for (int a = 0; a < 3; a++)
        apex[a] = set->gas_halved[a] || !set->face_count ? 0 : (double)brunt_fem_node(set->fem, set->face[0][0])[a];
}

static double triple(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

double brunt_gas_volume(const brunt_node_set *set) {
    const brunt_fem_body *fem = set->fem;
    double volume = 0, apex[3];
    apex_of(set, apex);
    for (int32_t f = 0; f < set->face_count; f++) {
        double x[4][3];
        const int n = corners_of(set->face[f]);
        places(fem, set->face[f], apex, x);
        if (n == 3)
            volume += triple(x[0], x[1], x[2]) / 6;
        else // the mean of the two ways to cut a quadrilateral is its bilinear surface
            volume += (triple(x[0], x[1], x[2]) + triple(x[0], x[2], x[3]) + triple(x[0], x[1], x[3]) +
                       triple(x[1], x[2], x[3])) /
                      12;
    }
    return volume + set->def.gas.volume;
}

typedef struct edge {
    int32_t low, high;
} edge;

static int by_nodes(const void *a, const void *b) {
    const edge *p = a, *q = b;
    return p->low != q->low ? (p->low > q->low) - (p->low < q->low) : (p->high > q->high) - (p->high < q->high);
}

// Whether it is on one; notes which.
static bool on_plane_of_symmetry(brunt_node_set *set, const edge *e) {
    const brunt_fem_body *fem = set->fem;
    bool any = false;
    for (int a = 0; a < fem->dim; a++) {
        const double p = fabs((double)brunt_fem_node(fem, e->low)[a]),
                     q = fabs((double)brunt_fem_node(fem, e->high)[a]);
        if (fmax(p, q) <= 1e-6 * (double)fem->mean_edge) any = set->gas_halved[a] = true;
    }
    return any;
}

// An edge that an odd number of the faces has, and that is on no plane of symmetry through the origin, if there is one
// (`open`), and its middle. Notes the planes that close the faces.
static int find_opening(brunt_node_set *set, bool *open, double at[3], brunt_error *error) {
    const brunt_fem_body *fem = set->fem;
    edge *edges;
    size_t count = 0;
    if (BRUNT_NEW(edges, (size_t)set->face_count * 4 + 1, "edges of an envelope", error)) return BRUNT_FAILED;
    for (int32_t f = 0; f < set->face_count; f++) {
        const int n = corners_of(set->face[f]);
        for (int c = 0; c < n; c++) {
            const int32_t p = set->face[f][c], q = set->face[f][(c + 1) % n];
            edges[count++] = (edge){p < q ? p : q, p < q ? q : p};
        }
    }
    qsort(edges, count, sizeof *edges, by_nodes);
    *open = false;
    for (size_t i = 0, next; i < count && !*open; i = next) {
        for (next = i; next < count && !by_nodes(&edges[i], &edges[next]);) next++;
        *open = (next - i) % 2 == 1 && !on_plane_of_symmetry(set, &edges[i]);
        for (int a = 0; a < 3 && *open; a++)
            at[a] = 0.5 * (double)(brunt_fem_node(fem, edges[i].low)[a] + brunt_fem_node(fem, edges[i].high)[a]);
    }
    brunt_free(edges);
    return BRUNT_OK;
}

int brunt_gas_start(brunt_node_set *set, brunt_error *error) {
    const char *name = set->boundary->name;
    const brunt_gas_def *gas = &set->def.gas;
    if (set->fem->dim != 3)
        return brunt_fail(error, BRUNT_BAD_INPUT, "boundaries (%s).gas: enclosed gas is for three dimensions", name);
    if (!(gas->gamma > 1) || !(gas->pressure >= 0) || !(gas->outside >= 0) || !(gas->volume >= 0))
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "boundaries (%s).gas: gamma > 1 and pressures and volume >= 0 are wanted", name);
    double at[3];
    bool open;
    if (find_opening(set, &open, at, error)) return BRUNT_FAILED;
    if (open)
        return brunt_fail(
            error, BRUNT_BAD_INPUT,
            "boundaries (%s).gas: the faces are open at (%.4g, %.4g, %.4g) m: they must close, by themselves "
            "or with planes of symmetry x = 0, y = 0, z = 0",
            name, at[0], at[1], at[2]);
    set->gas_volume = brunt_gas_volume(set);
    set->gas_energy = gas->pressure * set->gas_volume / (gas->gamma - 1);
    if (set->gas_volume > 0) return BRUNT_OK;
    return brunt_fail(
        error, BRUNT_BAD_INPUT,
        "boundaries (%s).gas: the faces enclose %.4g m^3: they must be turned outward and enclose some, or "
        "give gas.volume",
        name, set->gas_volume);
}

double brunt_gas_push(brunt_node_set *set, double time, double dt) {
    const brunt_group_def *def = &set->def;
    const double volume = brunt_gas_volume(set), gamma = def->gas.gamma;
    if (!(volume > 0)) {
        set->gas_volume = volume;
        return 0;
    }
    set->gas_energy *= pow(set->gas_volume / volume, gamma - 1);
    set->gas_volume = volume;
    const double inflow = def->gas.inflow * brunt_curve_at(&def->table, time) * dt;
    // dt reaches from the middle of the last step to that of the next one: half of its inflow is there by now. With all
    // of it the work would be first order in the step.
    const double energy = set->gas_energy + 0.5 * inflow;
    set->gas_energy += inflow;
    set->gas_inflow += inflow;
    return (gamma - 1) * energy / volume - def->gas.outside;
}

// ------------------------------------------------------------------------------------------ to be read, and kept

const brunt_node_set *brunt_gas_number(const brunt_node_sets *sets, int32_t index) {
    return &sets->set[sets->gas[index]];
}

int32_t brunt_gas_sets(const brunt_node_sets *sets) { return sets->gas_count; }

brunt_gas brunt_gas_now(const brunt_node_set *set) {
    const double gamma = set->def.gas.gamma;
    brunt_gas gas = {.volume = brunt_gas_volume(set), .inflow = set->gas_inflow};
    memcpy(gas.name, set->boundary->name, sizeof gas.name);
    gas.energy = set->gas_energy * pow(set->gas_volume / gas.volume, gamma - 1);
    gas.pressure = (gamma - 1) * gas.energy / gas.volume;
    return gas;
}

#define SET(member) BRUNT_SAVED(brunt_node_set, member)
static const brunt_saved saved[] = {SET(gas_energy), SET(gas_volume), SET(gas_inflow)};
enum { ROWS = BRUNT_COUNT(saved) };

int64_t brunt_gas_state_count(const brunt_node_sets *sets) {
    return brunt_gas_sets(sets) * brunt_saved_count(saved, ROWS);
}

void brunt_gas_state_get(const brunt_node_sets *sets, double *out) {
    for (int k = 0; k < sets->gas_count; k++) out = brunt_saved_get(saved, ROWS, &sets->set[sets->gas[k]], out);
}

void brunt_gas_state_set(brunt_node_sets *sets, const double *in) {
    for (int k = 0; k < sets->gas_count; k++) in = brunt_saved_set(saved, ROWS, &sets->set[sets->gas[k]], in);
}
