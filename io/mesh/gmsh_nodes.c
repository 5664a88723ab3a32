// Nodes of a file of gmsh, and which has a tag.
#include "io/mesh/gmsh_nodes.h"
#include "base/error.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

// A node by its tag.
typedef struct gmsh_numbered {
    int64_t tag;
    int32_t node;
} gmsh_numbered;

static bool allocate_nodes(gmsh_cursor *c, int64_t count) {
    if (c->status) return false;
    c->file->node_tag = brunt_alloc((size_t)count * sizeof *c->file->node_tag);
    c->file->x = brunt_alloc((size_t)count * sizeof *c->file->x);
    if (!c->file->node_tag || !c->file->x) gmsh_out_of_memory(c);
    return !c->status;
}

static int64_t node_tag(gmsh_cursor *c, int bytes) {
    const char *at = c->at;
    int64_t tag = gmsh_integer(c, bytes, "the number of a node");
    if (tag <= 0) gmsh_complain(c, at, "a node has number %lld, numbers above 0 are wanted", (long long)tag);
    return tag;
}

static void read_position(gmsh_cursor *c, double *x) {
    for (int d = 0; d < 3; d++) x[d] = gmsh_real(c, "a coordinate of a node");
}

void gmsh_read_nodes_2(gmsh_cursor *c) {
    gmsh_file *file = c->file;
    int64_t count = file->node_count;
    if (!allocate_nodes(c, count)) return;
    for (int64_t i = 0; i < count && !c->status; i++) {
        gmsh_begin_line(c);
        file->node_tag[i] = node_tag(c, 4);
        read_position(c, file->x[i]);
        gmsh_end_line(c);
    }
}

void gmsh_read_nodes_4(gmsh_cursor *c) {
    gmsh_file *file = c->file;
    int64_t blocks = gmsh_count(c, 8, 8, 20, "the number of blocks of nodes"), total, done = 0;
    total = gmsh_count(c, 8, 8, 32, "the number of nodes");
    gmsh_integer(c, 8, "the least node number");
    gmsh_integer(c, 8, "the greatest node number");
    gmsh_end_line(c);
    file->node_count = (int32_t)total;
    if (!allocate_nodes(c, total)) return;
    for (int64_t b = 0; b < blocks && !c->status; b++) {
        gmsh_begin_line(c);
        const char *at = c->at;
        int32_t dimension = gmsh_tag(c, "the dimension of an entity");
        gmsh_tag(c, "the tag of an entity");
        int32_t parametric = gmsh_tag(c, "0 or 1 (parametric)");
        int64_t count = gmsh_count(c, 8, 8, 32, "the number of nodes of a block");
        gmsh_end_line(c);
        if (dimension < 0 || dimension > 3 || parametric < 0 || parametric > 1)
            gmsh_complain(c, at, "a block of nodes of dimension %d, parametric %d", (int)dimension, (int)parametric);
        if (count > total - done)
            gmsh_complain(c, at, "more nodes than the %lld that $Nodes begins with", (long long)total);
        for (int64_t i = 0; i < count && !c->status; i++) {
            gmsh_begin_line(c);
            file->node_tag[done + i] = node_tag(c, 8);
            gmsh_end_line(c);
        }
        for (int64_t i = 0; i < count && !c->status; i++) {
            gmsh_begin_line(c);
            read_position(c, file->x[done + i]);
            for (int d = 0; d < dimension * parametric; d++) gmsh_real(c, "a parameter of a node");
            gmsh_end_line(c);
        }
        done += count;
    }
    if (done != total)
        gmsh_complain(c, c->at, "%lld nodes instead of the %lld that $Nodes begins with", (long long)done,
                      (long long)total);
}

static int by_tag(const void *a, const void *b) {
    const gmsh_numbered *p = a, *q = b;
    return (p->tag > q->tag) - (p->tag < q->tag);
}

static bool number_densely(gmsh_cursor *c, size_t span) {
    gmsh_file *file = c->file;
    file->node_of = brunt_alloc(span * sizeof *file->node_of);
    if (!file->node_of) return false;
    file->node_of_count = span;
    memset(file->node_of, 0xff, span * sizeof *file->node_of);
    for (int32_t n = 0; n < file->node_count && !c->status; n++) {
        int32_t *node = &file->node_of[file->node_tag[n] - file->least_tag];
        if (*node >= 0) gmsh_complain(c, c->at, "node %lld is given twice", (long long)file->node_tag[n]);
        *node = n;
    }
    return true;
}

static bool number_sparsely(gmsh_cursor *c) {
    gmsh_file *file = c->file;
    file->numbered = brunt_alloc((size_t)file->node_count * sizeof *file->numbered);
    if (!file->numbered) return false;
    for (int32_t n = 0; n < file->node_count; n++) file->numbered[n] = (gmsh_numbered){file->node_tag[n], n};
    qsort(file->numbered, (size_t)file->node_count, sizeof *file->numbered, by_tag);
    for (int32_t n = 1; n < file->node_count; n++)
        if (file->numbered[n].tag == file->numbered[n - 1].tag)
            gmsh_complain(c, c->at, "node %lld is given twice", (long long)file->numbered[n].tag);
    return true;
}

void gmsh_number_nodes(gmsh_cursor *c) {
    gmsh_file *file = c->file;
    if (c->status || !file->node_count) return;
    int64_t least = INT64_MAX, greatest = 0;
    for (int32_t n = 0; n < file->node_count; n++) {
        if (file->node_tag[n] < least) least = file->node_tag[n];
        if (file->node_tag[n] > greatest) greatest = file->node_tag[n];
    }
    file->least_tag = least;
    bool dense = greatest - least < 8 * (int64_t)file->node_count + 1000;
    if (!(dense ? number_densely(c, (size_t)(greatest - least) + 1) : number_sparsely(c))) gmsh_out_of_memory(c);
}

int32_t gmsh_find_node(const gmsh_file *file, int64_t tag) {
    if (file->node_of) {
        uint64_t at = (uint64_t)tag - (uint64_t)file->least_tag;
        return at < file->node_of_count ? file->node_of[at] : BRUNT_NONE;
    }
    if (!file->numbered) return BRUNT_NONE;
    gmsh_numbered key = {.tag = tag};
    const gmsh_numbered *found = bsearch(&key, file->numbered, (size_t)file->node_count, sizeof key, by_tag);
    return found ? found->node : BRUNT_NONE;
}
