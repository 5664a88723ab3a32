// The pattern of a matrix from lists of stencils. First which stencils hold each node, then row by row the union of
// these, by a marker for each node; each thread keeps the rows that it has made until all rows have their place.
#include "linear/fold.h"

#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/memory.h"

enum { LIST_SHIFT = 40, LISTS = 1 << 23, ROW_GRAIN = 64, FEW = 24 }; // a sign, 23 bits of list, 40 of number

typedef struct row_maker {
    int32_t *mark;   // of each node: the row + 1 that has it
    int32_t *column; // rows made by this thread, one after the other
    int64_t made;
    size_t mark_capacity, column_capacity;
    brunt_error error;
} row_maker;

typedef struct row_place {
    int64_t at;
    int32_t count, worker;
} row_place;

struct brunt_pattern_scratch {
    int64_t *first;   // nodes + 1: of each node, where its stencils are listed
    int64_t *stencil; // list << LIST_SHIFT | number
    row_place *row;   // where a new row is until it has its place
    int64_t *new_first;
    int32_t *new_column;
    size_t first_capacity, stencil_capacity, row_capacity, new_first_capacity, new_column_capacity;
    int64_t *version; // of the lists that the pattern has been made of; 0: not known
    bool *known;      // lists that the pattern has already
    int lists;        // that have versions
    size_t version_capacity, known_capacity;
    row_maker maker[BRUNT_THREAD_LIMIT];
};

typedef struct pattern_work {
    brunt_block_matrix *m;
    const brunt_pattern *pattern;
    struct brunt_pattern_scratch *s;
    bool keep;
} pattern_work;

static int32_t leader_of(const brunt_pattern *p, int32_t node) { return p->fold ? p->fold->leader[node] : node; }

// Stencils of the lists that the pattern has not, one list after the other, in a part for each thread.
typedef struct holder_work {
    struct brunt_pattern_scratch *s;
    const brunt_pattern *pattern;
    int64_t stencils;
    int parts;
    bool fill; // else they are counted
} holder_work;

static void hold(const holder_work *w, int32_t *next, int32_t node, int64_t stencil) {
    if (w->fill) w->s->stencil[w->s->first[node] + next[node]] = stencil;
    next[node]++;
}

// By node, how many stencils of a part hold it: `next`.
static void hold_list(const holder_work *w, int l, int64_t begin, int64_t end, int32_t *next) {
    const brunt_stencils *list = w->pattern->stencils + l;
    for (int64_t i = begin; i < end; i++)
        for (int64_t k = list->first[i]; k < list->first[i + 1]; k++) {
            const int32_t n = list->node[k], leader = leader_of(w->pattern, n);
            BRUNT_ASSERT(n >= 0 && n < w->pattern->nodes);
            hold(w, next, n, (int64_t)l << LIST_SHIFT | i);
            if (leader != n) hold(w, next, leader, (int64_t)l << LIST_SHIFT | i);
        }
}

static void hold_parts(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const holder_work *w = context;
    for (int64_t part = begin; part < end; part++) {
        const int64_t from = w->stencils * part / w->parts, to = w->stencils * (part + 1) / w->parts;
        int64_t first = 0;
        for (int l = 0; l < w->pattern->lists; l++) {
            const int64_t count = w->s->known[l] ? 0 : w->pattern->stencils[l].count;
            const int64_t low = from - first < 0 ? 0 : from - first, high = to - first < count ? to - first : count;
            if (low < high) hold_list(w, l, low, high, w->s->maker[part].mark);
            first += count;
        }
    }
}

// Which stencils of lists that the pattern has not hold each node, in the order of lists and of stencils. Counts are in
// the marks.
static int list_holders(struct brunt_pattern_scratch *s, const brunt_team *team, const brunt_pattern *p,
                        brunt_error *error) {
    holder_work work = {.s = s, .pattern = p, .parts = team->threads};
    for (int l = 0; l < p->lists; l++) work.stencils += s->known[l] ? 0 : p->stencils[l].count;
    if (BRUNT_CAPACITY(s->first, (size_t)p->nodes + 1, 0, "nodes of a matrix", error)) return BRUNT_FAILED;
    for (int t = 0; t < work.parts; t++) memset(s->maker[t].mark, 0, (size_t)p->nodes * sizeof *s->maker[t].mark);
    brunt_parallel_each(team->threads, work.parts, hold_parts, &work, team->timer);
    int64_t entries = 0;
    for (int32_t n = 0; n < p->nodes; n++) {
        s->first[n] = entries;
        int32_t before = 0;
        for (int t = 0; t < work.parts; t++) {
            const int32_t count = s->maker[t].mark[n];
            s->maker[t].mark[n] = before, before += count;
        }
        entries += before;
    }
    s->first[p->nodes] = entries;
    if (BRUNT_CAPACITY(s->stencil, (size_t)entries, 0, "stencils of nodes of a matrix", error)) return BRUNT_FAILED;
    work.fill = true;
    brunt_parallel_each(team->threads, work.parts, hold_parts, &work, team->timer);
    return BRUNT_OK;
}

static void sort_few(int32_t *a, int64_t count) {
    for (int64_t i = 1; i < count; i++) {
        const int32_t x = a[i];
        int64_t k = i;
        for (; k > 0 && a[k - 1] > x; k--) a[k] = a[k - 1];
        a[k] = x;
    }
}

// By merging; `room` for as many.
static void sort_columns(int32_t *a, int64_t count, int32_t *room) {
    if (count <= FEW) {
        sort_few(a, count);
        return;
    }
    const int64_t half = count / 2;
    sort_columns(a, half, room);
    sort_columns(a + half, count - half, room);
    if (a[half - 1] < a[half]) return;
    memcpy(room, a, (size_t)half * sizeof *a);
    int64_t i = 0, j = half, k = 0;
    while (i < half && j < count) a[k++] = room[i] < a[j] ? room[i++] : a[j++];
    while (i < half) a[k++] = room[i++];
}

// Puts columns that the row has not yet behind `count` others; there is room for all.
static int64_t mark_columns(row_maker *w, int32_t row, const int32_t *column, int64_t columns, int64_t count) {
    int32_t *to = w->column + w->made;
    for (int64_t k = 0; k < columns; k++)
        if (w->mark[column[k]] != row + 1) w->mark[column[k]] = row + 1, to[count++] = column[k];
    return count;
}

static int64_t mark_leaders(row_maker *w, int32_t row, const brunt_fold *fold, int64_t count) {
    const int64_t had = count;
    for (int64_t k = 0; k < had; k++) count = mark_columns(w, row, &fold->leader[w->column[w->made + k]], 1, count);
    return count;
}

// Room for `more` columns of the row under way, which has `count`, and as much again to sort them in.
static int reserve_row(row_maker *w, int64_t count, int64_t more) {
    return BRUNT_CAPACITY(w->column, (size_t)(w->made + 2 * (count + more)), (size_t)(w->made + count),
                          "columns of rows of a matrix", &w->error);
}

// The columns of a row, and how many. BRUNT_NONE: out of memory.
static int64_t make_row(const pattern_work *work, row_maker *w, int32_t row) {
    const struct brunt_pattern_scratch *s = work->s;
    const brunt_block_matrix *m = work->m;
    const int64_t kept = work->keep ? m->first[row + 1] - m->first[row] : 0;
    if (reserve_row(w, 0, kept + 1)) return BRUNT_NONE;
    if (kept && s->first[row] == s->first[row + 1]) {
        memcpy(w->column + w->made, m->column + m->first[row], (size_t)kept * sizeof(int32_t));
        return kept;
    }
    int64_t count = mark_columns(w, row, &row, 1, 0);
    if (kept) count = mark_columns(w, row, m->column + m->first[row], kept, count);
    for (int64_t k = s->first[row]; k < s->first[row + 1]; k++) {
        const brunt_stencils *list = work->pattern->stencils + (s->stencil[k] >> LIST_SHIFT);
        const int64_t i = s->stencil[k] & (((int64_t)1 << LIST_SHIFT) - 1), size = list->first[i + 1] - list->first[i];
        if (reserve_row(w, count, size)) return BRUNT_NONE;
        count = mark_columns(w, row, list->node + list->first[i], size, count);
    }
    if (work->pattern->fold) {
        if (reserve_row(w, count, count)) return BRUNT_NONE;
        count = mark_leaders(w, row, work->pattern->fold, count);
    }
    sort_columns(w->column + w->made, count, w->column + w->made + count);
    return count;
}

static void make_rows(void *context, int64_t begin, int64_t end, int worker) {
    const pattern_work *work = context;
    row_maker *w = work->s->maker + worker;
    for (int64_t r = begin; r < end && !w->error.code; r++) {
        const int64_t count = make_row(work, w, (int32_t)r);
        work->s->row[r] = (row_place){w->made, (int32_t)count, worker};
        if (count > 0) w->made += count;
    }
}

static void place_rows(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    const pattern_work *work = context;
    struct brunt_pattern_scratch *s = work->s;
    for (int64_t r = begin; r < end; r++) {
        const row_place *p = s->row + r;
        memcpy(s->new_column + s->new_first[r], s->maker[p->worker].column + p->at, (size_t)p->count * sizeof(int32_t));
    }
}

int64_t brunt_block_matrix_place(const brunt_block_matrix *m, int64_t row, int64_t column) {
    int64_t low = m->first[row], high = m->first[row + 1];
    while (low < high) {
        const int64_t middle = (low + high) / 2;
        if (m->column[middle] < column)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void find_diagonals(void *context, int64_t begin, int64_t end, int worker) {
    (void)worker;
    brunt_block_matrix *m = context;
    for (int64_t r = begin; r < end; r++) m->diagonal[r] = brunt_block_matrix_place(m, r, r);
}

static bool couples(const brunt_block_matrix *m, int32_t row, int32_t column) {
    const int64_t at = brunt_block_matrix_place(m, row, column);
    return at < m->first[row + 1] && m->column[at] == column;
}

// Whether two nodes couple, and their leaders with both.
static bool all_couple(const brunt_block_matrix *m, const brunt_pattern *p, int32_t a, int32_t b) {
    const int32_t A = leader_of(p, a), B = leader_of(p, b);
    return couples(m, a, b) && (A == a || couples(m, A, b)) && (B == b || couples(m, a, B)) &&
           (A == a || B == b || couples(m, A, B));
}

typedef struct search_work {
    const brunt_block_matrix *m;
    const brunt_pattern *pattern;
    const brunt_stencils *list;
    bool *missing; // of each worker
} search_work;

static void find_missing(void *context, int64_t begin, int64_t end, int worker) {
    const search_work *w = context;
    const brunt_stencils *list = w->list;
    for (int64_t s = begin; s < end && !w->missing[worker]; s++)
        for (int64_t i = list->first[s]; i < list->first[s + 1]; i++)
            for (int64_t j = list->first[s]; j < list->first[s + 1]; j++)
                if (!all_couple(w->m, w->pattern, list->node[i], list->node[j])) w->missing[worker] = true;
}

static bool has_stencils(const brunt_block_matrix *m, const brunt_team *team, const brunt_pattern *p,
                         const brunt_stencils *list) {
    bool missing[BRUNT_THREAD_LIMIT] = {false}, any = false;
    search_work work = {m, p, list, missing};
    brunt_parallel(team->threads, list->count, ROW_GRAIN, find_missing, &work, team->timer);
    for (int t = 0; t < BRUNT_THREAD_LIMIT; t++) any = any || missing[t];
    return !any;
}

// Whether a pattern that is kept has all of the stencils, and which lists it has.
static bool complete(const brunt_block_matrix *m, const brunt_team *team, const brunt_pattern *p, bool keep) {
    struct brunt_pattern_scratch *s = m->scratch;
    bool all = keep;
    for (int l = 0; l < p->lists; l++) {
        const int64_t before = l < s->lists ? s->version[l] : 0;
        s->known[l] = keep && p->stencils[l].version && p->stencils[l].version == before;
        all = all && (s->known[l] || has_stencils(m, team, p, &p->stencils[l]));
        s->version[l] = p->stencils[l].version;
    }
    s->lists = p->lists;
    return all;
}

static int make_marks(const brunt_block_matrix *m, const brunt_team *team, int32_t nodes, brunt_error *error) {
    for (int t = 0; t < team->threads; t++)
        if (BRUNT_CAPACITY(m->scratch->maker[t].mark, (size_t)nodes, 0, "nodes of a matrix", error))
            return BRUNT_FAILED;
    return BRUNT_OK;
}

static int make_versions(struct brunt_pattern_scratch *s, int lists, brunt_error *error) {
    static const char of_stencils[] = "lists of stencils of a matrix";
    return BRUNT_CAPACITY(s->version, (size_t)lists + 1, (size_t)s->lists, of_stencils, error) ||
                   BRUNT_CAPACITY(s->known, (size_t)lists + 1, 0, of_stencils, error)
               ? BRUNT_FAILED
               : BRUNT_OK;
}

// The rows, into new_first and new_column.
static int new_rows(pattern_work *work, const brunt_team *team, brunt_error *error) {
    struct brunt_pattern_scratch *s = work->s;
    const int32_t nodes = work->pattern->nodes;
    if (list_holders(s, team, work->pattern, error) ||
        BRUNT_CAPACITY(s->row, (size_t)nodes, 0, "rows of a matrix", error))
        return BRUNT_FAILED;
    for (int t = 0; t < team->threads; t++) {
        row_maker *w = s->maker + t;
        memset(w->mark, 0, (size_t)nodes * sizeof *w->mark);
        w->made = 0, w->error.code = BRUNT_OK;
    }
    brunt_parallel(team->threads, nodes, ROW_GRAIN, make_rows, work, team->timer);
    for (int t = 0; t < team->threads; t++)
        if (brunt_hand_on(error, &s->maker[t].error)) return BRUNT_FAILED;
    if (BRUNT_CAPACITY(s->new_first, (size_t)nodes + 1, 0, "rows of a matrix", error)) return BRUNT_FAILED;
    s->new_first[0] = 0;
    for (int32_t r = 0; r < nodes; r++) s->new_first[r + 1] = s->new_first[r] + s->row[r].count;
    if (BRUNT_CAPACITY(s->new_column, (size_t)s->new_first[nodes], 0, "blocks of a matrix", error)) return BRUNT_FAILED;
    brunt_parallel(team->threads, nodes, ROW_GRAIN, place_rows, work, team->timer);
    return BRUNT_OK;
}

static bool same_pattern(const brunt_block_matrix *m, const brunt_pattern *p) {
    const struct brunt_pattern_scratch *s = m->scratch;
    return m->pattern && m->dim == p->dim && m->nodes == p->nodes && m->first[m->nodes] == s->new_first[m->nodes] &&
           !memcmp(m->first, s->new_first, ((size_t)m->nodes + 1) * sizeof *m->first) &&
           !memcmp(m->column, s->new_column, (size_t)m->first[m->nodes] * sizeof *m->column);
}

// Takes the rows that have been made for its own.
static int take_rows(brunt_block_matrix *m, const brunt_team *team, const brunt_pattern *p, brunt_error *error) {
    struct brunt_pattern_scratch *s = m->scratch;
    const size_t values = (size_t)s->new_first[p->nodes] * (size_t)(p->dim * p->dim);
    if (BRUNT_CAPACITY(m->diagonal, (size_t)p->nodes, 0, "rows of a matrix", error) ||
        BRUNT_CAPACITY(m->value, values, 0, "values of a matrix", error))
        return BRUNT_FAILED;
    int64_t *first = m->first;
    int32_t *column = m->column;
    const size_t first_capacity = m->first_capacity, column_capacity = m->column_capacity;
    m->first = s->new_first, m->first_capacity = s->new_first_capacity;
    m->column = s->new_column, m->column_capacity = s->new_column_capacity;
    s->new_first = first, s->new_first_capacity = first_capacity;
    s->new_column = column, s->new_column_capacity = column_capacity;
    m->dim = p->dim, m->nodes = p->nodes, m->pattern++;
    brunt_parallel(team->threads, m->nodes, ROW_GRAIN, find_diagonals, m, team->timer);
    return BRUNT_OK;
}

int brunt_block_matrix_pattern(brunt_block_matrix *m, const brunt_team *team, const brunt_pattern *p,
                               brunt_error *error) {
    BRUNT_ASSERT((p->dim == 2 || p->dim == 3) && p->lists < LISTS && p->nodes >= 0);
    if (!m->scratch && BRUNT_NEW(m->scratch, 1, "room to make a matrix", error)) return BRUNT_FAILED;
    const bool keep = p->keep && m->pattern && m->nodes == p->nodes && m->dim == p->dim;
    pattern_work work = {m, p, m->scratch, keep};
    if (make_marks(m, team, p->nodes, error) || make_versions(m->scratch, p->lists, error)) return BRUNT_FAILED;
    if (!complete(m, team, p, keep))
        if (new_rows(&work, team, error) || (!same_pattern(m, p) && take_rows(m, team, p, error))) return BRUNT_FAILED;
    brunt_block_matrix_zero(m, team);
    return BRUNT_OK;
}

int32_t *brunt_block_matrix_marks(const brunt_block_matrix *m, int worker) {
    BRUNT_ASSERT(m->scratch && m->scratch->maker[worker].mark);
    return m->scratch->maker[worker].mark;
}

void brunt_block_matrix_free(brunt_block_matrix *m) {
    struct brunt_pattern_scratch *s = m->scratch;
    if (s) {
        for (int t = 0; t < BRUNT_THREAD_LIMIT; t++) brunt_free(s->maker[t].mark), brunt_free(s->maker[t].column);
        brunt_free(s->first), brunt_free(s->stencil), brunt_free(s->row);
        brunt_free(s->new_first), brunt_free(s->new_column), brunt_free(s->version), brunt_free(s->known);
        brunt_free(s);
    }
    brunt_free(m->first), brunt_free(m->column), brunt_free(m->diagonal), brunt_free(m->value);
    *m = (brunt_block_matrix){0};
}
