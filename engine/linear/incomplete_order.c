// In which order nodes are eliminated, and which of them by threads side by side.
#include <string.h>

#include "linear/incomplete.h"

// Two slabs cost 0 to 3 % more iterations, four 12 to 20 %: two it is, where they are worth it.
enum { SLABS = 2 };
// In blocks: what a level costs beyond its own, by waking threads and waiting for them.
enum { LEVEL_COST = 3000 };

typedef struct cut {
    const brunt_block_matrix *a;
    int8_t *level;                  // -1: none yet
    int32_t begin[BRUNT_SLABS + 1]; // of each slab
    int slabs, levels;
    int64_t weight[BRUNT_LEVELS][BRUNT_SLABS]; // blocks
} cut;

// Slabs of about as many blocks each, but for what the first of two has more than the other.
static void cut_slabs(cut *c, int64_t more) {
    const brunt_block_matrix *a = c->a;
    const int64_t all = brunt_block_matrix_blocks(a);
    int32_t r = 0;
    for (int s = 0; s <= c->slabs; s++) {
        while (r < a->nodes && a->first[r] * c->slabs < all * s + more * (s == 1)) r++;
        c->begin[s] = s < c->slabs ? r : a->nodes;
    }
}

// Whether a node of a slab that ends at `end` couples with one of a later slab that has no level yet.
static bool waits(const cut *c, int32_t node, int32_t end) {
    const brunt_block_matrix *a = c->a;
    for (int64_t k = a->first[node + 1] - 1; k >= a->first[node] && a->column[k] >= end; k--)
        if (c->level[a->column[k]] < 0) return true;
    return false;
}

// Gives nodes their level; the last one takes all that is left, as one piece.
static void find_levels(cut *c) {
    int64_t left = c->a->nodes;
    memset(c->level, -1, (size_t)c->a->nodes);
    memset(c->weight, 0, sizeof c->weight);
    for (c->levels = 0; left > 0; c->levels++) {
        const bool last = c->levels == BRUNT_LEVELS - 1;
        for (int s = 0; s < c->slabs; s++)
            for (int32_t n = c->begin[s]; n < c->begin[s + 1]; n++) {
                if (c->level[n] >= 0 || (!last && waits(c, n, c->begin[s + 1]))) continue;
                c->level[n] = (int8_t)c->levels, left--;
                c->weight[c->levels][last ? 0 : s] += c->a->first[n + 1] - c->a->first[n];
            }
    }
}

// What as many threads as slabs take, in blocks.
static int64_t cost_of(const cut *c) {
    int64_t cost = 0;
    for (int l = 0; l < c->levels; l++) {
        int64_t most = 0;
        for (int s = 0; s < c->slabs; s++)
            if (c->weight[l][s] > most) most = c->weight[l][s];
        cost += most + LEVEL_COST;
    }
    return cost;
}

// Of two slabs the first has what couples with the second last, alone: it is larger by as much, so that neither waits.
static void cut_into(cut *c, int slabs) {
    c->slabs = slabs;
    cut_slabs(c, 0);
    find_levels(c);
    if (slabs != 2) return;
    cut_slabs(c, c->weight[0][1] - c->weight[0][0]);
    find_levels(c);
}

static void cut_best(cut *c) {
    cut_into(c, SLABS);
    if (cost_of(c) >= brunt_block_matrix_blocks(c->a)) cut_into(c, 1);
}

typedef struct piece {
    int32_t begin, end; // nodes
    int level;
    bool back;
} piece;

// From place p on; the place after it.
static int32_t place_piece(brunt_incomplete *f, piece w, int32_t p) {
    for (int32_t k = 0; k < w.end - w.begin; k++) {
        const int32_t n = w.back ? w.end - 1 - k : w.begin + k;
        if (f->turn[n] == w.level) f->order[p] = n, f->place[n] = p++;
    }
    return p;
}

void brunt_incomplete_order(brunt_incomplete *f, int slabs) {
    cut c = {.a = f->a, .level = f->turn};
    if (slabs)
        cut_into(&c, slabs);
    else
        cut_best(&c);
    f->slabs = c.slabs, f->levels = c.levels;
    int32_t p = 0;
    for (int l = 0; l < c.levels; l++)
        for (int s = 0; s < c.slabs; s++) {
            f->first[l * c.slabs + s] = p;
            if (l < BRUNT_LEVELS - 1)
                p = place_piece(f, (piece){c.begin[s], c.begin[s + 1], l, s % 2}, p);
            else if (s == 0) // one piece: its slabs may couple
                p = place_piece(f, (piece){0, f->a->nodes, l, false}, p);
        }
    f->first[c.levels * c.slabs] = p;
    for (int32_t k = 0; k < p; k++) f->turn[f->order[k]] = (int8_t)(2 * f->turn[f->order[k]]);
    for (int s = 1; s < c.slabs; s += 2)
        for (int32_t n = c.begin[s]; n < c.begin[s + 1]; n++) f->turn[n] += f->turn[n] < 2 * (BRUNT_LEVELS - 1);
}
