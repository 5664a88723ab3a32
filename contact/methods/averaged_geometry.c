// Where the two bodies of a pair meet on the grid, their surfaces there, and what each node has of them.
#include "contact/methods/averaged_surface_parts.h"

// Cosines against d, or of slave and master normal: faces that make up d in its second round, facing faces, facing
// nodes, nodes that may be slaves.
static const double ALONG = 0.2, OPPOSED_FACE = 0.7, OPPOSED_NODE = 0.3, SLAVE = 0.1;
static const double OPPOSED = 0.2; // of c_A^4 + c_B^4: bodies whose normals agree that well with none between them
static const double LEAST_WEIGHT = 1e-4, LEAST_NORMAL = 0.3;
static const double DEEPEST = 1.5; // [cells] beyond it a node is taken to be on the far side

typedef struct adder {
    brunt_augury_grid *grid;
    brunt_augury_cloud *cloud;
    brunt_error *error;
} adder;

static int add_point(void *context, int32_t item, const double x[3]) {
    adder *to = context;
    return brunt_augury_cloud_add(to->grid, to->cloud, item, x, to->error);
}

int brunt_averaged_collect(averaged_job *j, int a, int b, bool *some, brunt_error *error) {
    brunt_augury_workspace *w = j->w;
    const brunt_contact_surface *s = j->surface;
    const double width = STENCIL_WIDTH * j->m->cell;
    brunt_augury_grid_start(&w->grid, s->dim, WIDTH, j->m->cell);
    for (int c = 0; c < 4; c++) w->cloud[c].count = 0;
    for (int c = 3; c >= 0; c--) { // faces first: without them nothing is left to do
        const int of = c % 2 ? b : a, other = c % 2 ? a : b;
        brunt_augury_box box;
        for (int k = 0; k < 3; k++) box.low[k] = s->low[other][k] - width, box.high[k] = s->high[other][k] + width;
        adder to = {&w->grid, &w->cloud[c], error};
        if (brunt_augury_near_visit(&w->near, s, of, c >= 2, &box, add_point, &to)) return BRUNT_FAILED;
        if (!(*some = w->cloud[c].count > 0)) return BRUNT_OK;
    }
    return brunt_augury_grid_finish(&w->grid, w->cloud, 4, error);
}

// Most points near a box are not near the body in it: blocks from which no node is reached that faces of both reach are
// left out throughout.
static int mark_blocks(averaged_job *j, brunt_error *error) {
    const brunt_augury_grid *grid = &j->w->grid;
    if (NEED(j->work, visitors, grid->block_count, 0, "blocks of the contact grid", error)) return BRUNT_FAILED;
    uint8_t *mark = j->work->visitors;
    memset(mark, 0, (size_t)grid->block_count);
    for (int round = 0; round < 2; round++)
        for (int32_t c = 0; c < grid->colour_first[BRUNT_AUGURY_COLOURS]; c++) {
            const int32_t b = grid->coloured[c];
            const int32_t *first[2] = {&j->w->cloud[2].block_first[b], &j->w->cloud[3].block_first[b]};
            const int bits = (first[0][1] > first[0][0]) | (first[1][1] > first[1][0]) << 1;
            for (int k = 0; k < 8; k++) {
                if (!(grid->reached[b] >> k & 1)) continue;
                if (!round)
                    mark[grid->next[b][k]] |= (uint8_t)bits;
                else if ((mark[grid->next[b][k]] & 3) == 3)
                    mark[b] |= 4;
            }
        }
    return BRUNT_OK;
}

static bool is_near(const averaged_job *j, const brunt_augury_point *p) { return j->work->visitors[p->block] & 4; }

static void add_faces(void *context, int32_t begin, int32_t end) {
    const averaged_job *j = context;
    const brunt_augury_cloud *cloud = &j->w->cloud[2 + j->of];
    if (!is_near(j, &cloud->point[begin])) return;
    for (int32_t k = begin; k < end; k++) {
        const int32_t f = cloud->item[k];
        const double *n = j->surface->face_normal[f], area = j->surface->face_area[f];
        const double add[4] = {area, area * n[0], area * n[1], area * n[2]};
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL];
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[k], at, w);
        for (int e = 0; e < count; e++) {
            double *s = j->work->sums[2 * at[e] + j->of].of;
            for (int a = 0; a < 4; a++) s[a] += w[e] * add[a];
        }
    }
}

// The direction from the first to the second body; 0 where there is none.
static bool direction(const surface_sums s[2], double d[3]) {
    double c[2];
    for (int a = 0; a < 3; a++) d[a] = 0;
    if (!(s[0].of[0] > 0 && s[1].of[0] > 0)) return false;
    for (int k = 0; k < 2; k++) {
        const double *normal = s[k].of + 1;
        double size = sqrt(dot(normal, normal)), coherence = size / s[k].of[0], square = coherence * coherence;
        c[k] = coherence > 1e-9 ? square * square : 0;
        for (int a = 0; a < 3 && c[k] > 0; a++) d[a] += (k ? -c[k] : c[k]) * normal[a] / size;
    }
    double size = sqrt(dot(d, d));
    bool clear = c[0] + c[1] > 1e-6 && size >= OPPOSED * (c[0] + c[1]);
    for (int a = 0; a < 3; a++) d[a] = clear ? d[a] / size : 0;
    return clear;
}

// Second round of the sums, and the facing surfaces: faces that look along d by more than `least`.
static void add_looking_faces(const averaged_job *j, int32_t begin, int32_t end, double least, bool opposed) {
    const brunt_augury_cloud *cloud = &j->w->cloud[2 + j->of];
    const double sign = j->of ? -1 : 1;
    if (!is_near(j, &cloud->point[begin])) return;
    for (int32_t k = begin; k < end; k++) {
        const int32_t f = cloud->item[k];
        const double *n = j->surface->face_normal[f], *x = j->surface->face_centre[f],
                     area_f = j->surface->face_area[f];
        const double add[4] = {area_f, area_f * n[0], area_f * n[1], area_f * n[2]};
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL];
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[k], at, w);
        for (int e = 0; e < count; e++) {
            const int32_t i = j->work->shared_of[at[e]];
            if (i < 0 || sign * dot(j->work->heading[i].d, n) <= least) continue;
            if (opposed) {
                side *s = &j->work->shared[i].side[j->of];
                const double area = w[e] * add[0];
                s->area += area;
                for (int a = 0; a < 3; a++) s->X[a] += area * x[a], s->n[a] += area * n[a];
            } else {
                double *s = j->work->sums[2 * at[e] + j->of].of;
                for (int a = 0; a < 4; a++) s[a] += w[e] * add[a];
            }
        }
    }
}

static void refine_faces(void *context, int32_t begin, int32_t end) {
    add_looking_faces(context, begin, end, ALONG, false);
}
static void face_faces(void *context, int32_t begin, int32_t end) {
    add_looking_faces(context, begin, end, OPPOSED_FACE, true);
}

static void add_masses(void *context, int32_t begin, int32_t end) {
    const averaged_job *j = context;
    const brunt_augury_cloud *cloud = &j->w->cloud[j->of];
    const double sign = j->of ? -1 : 1;
    if (!is_near(j, &cloud->point[begin])) return;
    for (int32_t k = begin; k < end; k++) {
        const int32_t p = cloud->item[k];
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL];
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[k], at, w);
        for (int e = 0; e < count; e++) {
            const int32_t i = j->work->shared_of[at[e]];
            if (i < 0 || sign * dot(j->work->heading[i].d, j->surface->normal[p]) <= OPPOSED_NODE) continue;
            side *s = &j->work->shared[i].side[j->of];
            s->mass += w[e] * j->surface->mass[p];
            for (int a = 0; a < 3; a++)
                if (!(j->surface->inverse[p][a] > 0)) s->fixed[a] += w[e] * j->surface->mass[p], s->rigid = true;
        }
    }
}

void brunt_averaged_scatter(averaged_job *j, int cloud, brunt_augury_scatter_fn *each) {
    j->of = cloud % 2;
    brunt_augury_scatter(&j->w->grid, &j->w->cloud[cloud], each, j, j->m->threads, j->m->timer);
}

int brunt_averaged_orient(averaged_job *j, bool *some, brunt_error *error) {
    brunt_averaged_work *work = j->work;
    const int32_t nodes = j->w->grid.block_count * j->w->grid.block_nodes;
    if (NEED(work, sums, 2 * nodes, 0, "nodes of the contact grid", error) ||
        NEED(work, shared_of, nodes, 0, "nodes of the contact grid", error) || mark_blocks(j, error))
        return BRUNT_FAILED;
    memset(work->sums, 0, 2 * (size_t)nodes * sizeof *work->sums);
    for (int b = 0; b < 2; b++) brunt_averaged_scatter(j, 2 + b, add_faces);
    work->shared_count = 0;
    for (int32_t i = 0; i < nodes; i++) {
        surface_sums *s = &work->sums[2 * i];
        double d[3];
        work->shared_of[i] = -1;
        if (s[0].of[0] == 0 || s[1].of[0] == 0 || !direction(s, d)) continue;
        if (NEED(work, shared, work->shared_count + 1, work->shared_count,
                 "nodes of the contact grid that bodies share", error) ||
            NEED(work, heading, work->shared_count + 1, work->shared_count,
                 "nodes of the contact grid that bodies share", error))
            return BRUNT_FAILED;
        shared_node *n = &work->shared[work->shared_count];
        *n = (shared_node){.x = {0}};
        work->heading[work->shared_count] = (heading){{d[0], d[1], d[2]}};
        brunt_augury_position(&j->w->grid, i, n->x);
        work->shared_of[i] = work->shared_count++;
        s[0] = s[1] = (surface_sums){0};
    }
    *some = false;
    if (!work->shared_count) return BRUNT_OK;
    for (int b = 0; b < 2; b++) brunt_averaged_scatter(j, 2 + b, refine_faces);
    for (int32_t i = 0; i < nodes; i++)
        if (work->shared_of[i] >= 0) *some |= direction(&work->sums[2 * i], work->heading[work->shared_of[i]].d);
    return BRUNT_OK;
}

// Facing surfaces and masses.
void brunt_averaged_face(averaged_job *j) {
    brunt_averaged_work *work = j->work;
    for (int b = 0; b < 2; b++) brunt_averaged_scatter(j, 2 + b, face_faces), brunt_averaged_scatter(j, b, add_masses);
    for (int32_t i = 0; i < work->shared_count; i++)
        for (int b = 0; b < 2; b++) {
            side *s = &work->shared[i].side[b];
            s->master = s->mass > 0 && s->area > 0;
            if (!s->master) continue;
            normalise(s->n);
            for (int a = 0; a < 3; a++) {
                s->X[a] /= s->area;
                s->share[a] = 1 / (s->fixed[a] > 0 ? s->fixed[a] : s->mass);
                s->inverse[a] = s->fixed[a] > 0 ? 0 : 1 / s->mass;
            }
        }
}

// Where the surface of the other body is, as the slave sees it.
static void find_surface(const averaged_job *j, averaged_node *p, double sum) {
    entry *e = entries_of(j, p, false);
    const int other = p - j->work->averaged_node < j->node_first[1];
    const double *x = j->surface->x[p->node];
    p->meets = false;
    p->gap = 0;
    p->n[0] = p->n[1] = p->n[2] = 0;
    if (sum < LEAST_WEIGHT) return;
    for (int k = 0; k < p->slave_count; k++) {
        const side *s = &j->work->shared[e[k].at].side[other];
        e[k].w /= sum;
        for (int a = 0; a < 3; a++) p->n[a] += e[k].w * s->n[a], p->gap += e[k].w * s->n[a] * (x[a] - s->X[a]);
    }
    p->meets = normalise(p->n) >= LEAST_NORMAL && -dot(p->n, j->surface->normal[p->node]) > SLAVE &&
               p->gap >= -DEEPEST * j->m->cell;
    if (p->meets && p->gap < j->surface->output.gap[p->node]) j->surface->output.gap[p->node] = p->gap;
}

void brunt_averaged_list_entries(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const averaged_job *j = context;
    for (int64_t k = begin; k < end; k++) {
        averaged_node *p = &j->work->averaged_node[k];
        const int of = k >= j->node_first[1];
        const int32_t in_cloud = (int32_t)k - j->node_first[of];
        const brunt_augury_cloud *cloud = &j->w->cloud[of];
        *p = (averaged_node){.node = cloud->item[in_cloud], .touched = -1};
        if (!is_near(j, &cloud->point[in_cloud])) continue;
        entry *master = entries_of(j, p, true), *slave = entries_of(j, p, false);
        int32_t at[BRUNT_AUGURY_STENCIL];
        double w[BRUNT_AUGURY_STENCIL], sum = 0;
        int count = brunt_augury_stencil(&j->w->grid, &cloud->point[in_cloud], at, w);
        for (int e = 0; e < count; e++) {
            const int32_t i = j->work->shared_of[at[e]];
            if (i < 0) continue;
            const shared_node *n = &j->work->shared[i];
            double looks = (of ? -1 : 1) * dot(j->work->heading[i].d, j->surface->normal[p->node]);
            if (looks > OPPOSED_NODE && n->side[of].master) master[p->master_count++] = (entry){w[e], i};
            if (looks > SLAVE && n->side[!of].master) slave[p->slave_count++] = (entry){w[e], i}, sum += w[e];
        }
        find_surface(j, p, sum);
    }
}
