// Writes files of gmsh for the tests: format 2.2 and 4.1, text and binary, any node tags.
#pragma once

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct gmsh_part {
    int type, nodes, dimension; // of gmsh: 1 line, 2 triangle, 3 quadrangle, 4 tetrahedron, 5 hexahedron, ...
    int physical;               // 0: in no group
    int count;
    const int32_t *elements; // node indices from 0
} gmsh_part;

typedef struct gmsh_model {
    int node_count;
    double (*x)[3];
    const int64_t *tags; // of the nodes; NULL: from 1
    int part_count;
    gmsh_part part[16];
    int name_count;
    struct {
        int dimension, tag;
        const char *name;
    } name[16];
} gmsh_model;

static void gmsh_put(FILE *out, bool binary, int bytes, int64_t value) {
    int32_t narrow = (int32_t)value;
    if (!binary)
        fprintf(out, "%" PRId64 " ", value);
    else
        fwrite(bytes == 4 ? (void *)&narrow : (void *)&value, (size_t)bytes, 1, out);
}
static void gmsh_position(FILE *out, bool binary, const double *x) {
    if (binary)
        fwrite(x, sizeof *x, 3, out);
    else
        fprintf(out, "%.17g %.17g %.17g ", x[0], x[1], x[2]);
}
static void gmsh_line(FILE *out, bool binary) {
    if (!binary) fputc('\n', out);
}
static int64_t gmsh_node(const gmsh_model *m, int32_t node) { return m->tags ? m->tags[node] : node + 1; }

static void gmsh_write_2(const gmsh_model *m, bool binary, FILE *out) {
    int total = 0, number = 1;
    fprintf(out, "$Nodes\n%d\n", m->node_count);
    for (int n = 0; n < m->node_count; n++) {
        gmsh_put(out, binary, 4, gmsh_node(m, n));
        gmsh_position(out, binary, m->x[n]);
        gmsh_line(out, binary);
    }
    for (int p = 0; p < m->part_count; p++) total += m->part[p].count;
    fprintf(out, "%s$EndNodes\n$Elements\n%d\n", binary ? "\n" : "", total);
    for (int p = 0; p < m->part_count; p++) {
        const gmsh_part *part = &m->part[p];
        if (binary && part->count) {
            gmsh_put(out, true, 4, part->type);
            gmsh_put(out, true, 4, part->count);
            gmsh_put(out, true, 4, 2);
        }
        for (int e = 0; e < part->count; e++) {
            gmsh_put(out, binary, 4, number++);
            if (!binary) fprintf(out, "%d 2 ", part->type);
            gmsh_put(out, binary, 4, part->physical);
            gmsh_put(out, binary, 4, p + 1);
            for (int a = 0; a < part->nodes; a++)
                gmsh_put(out, binary, 4, gmsh_node(m, part->elements[e * part->nodes + a]));
            gmsh_line(out, binary);
        }
    }
    fprintf(out, "%s$EndElements\n", binary ? "\n" : "");
}

static void gmsh_write_entities(const gmsh_model *m, bool binary, FILE *out) {
    static const double box[6] = {0, 0, 0, 1, 1, 1};
    fputs("$Entities\n", out);
    for (int d = 0; d < 4; d++) {
        int count = 0;
        for (int p = 0; p < m->part_count; p++) count += m->part[p].dimension == d;
        gmsh_put(out, binary, 8, count);
    }
    gmsh_line(out, binary);
    for (int d = 0; d < 4; d++) {
        for (int p = 0; p < m->part_count; p++) {
            if (m->part[p].dimension != d) continue;
            gmsh_put(out, binary, 4, p + 1);
            gmsh_position(out, binary, box);
            if (d) gmsh_position(out, binary, box + 3);
            gmsh_put(out, binary, 8, m->part[p].physical != 0);
            if (m->part[p].physical) gmsh_put(out, binary, 4, m->part[p].physical);
            if (d) gmsh_put(out, binary, 8, 1), gmsh_put(out, binary, 4, -1);
            gmsh_line(out, binary);
        }
    }
    fprintf(out, "%s$EndEntities\n", binary ? "\n" : "");
}

// Nodes in two blocks, the second with parameters, so that both are read.
static void gmsh_write_4(const gmsh_model *m, bool binary, FILE *out) {
    int total = 0, number = 1, half = m->node_count / 2;
    gmsh_write_entities(m, binary, out);
    fputs("$Nodes\n", out);
    int64_t header[4] = {2, m->node_count, 1, m->node_count};
    for (int i = 0; i < 4; i++) gmsh_put(out, binary, 8, header[i]);
    gmsh_line(out, binary);
    for (int b = 0; b < 2; b++) {
        int begin = b ? half : 0, end = b ? m->node_count : half;
        gmsh_put(out, binary, 4, 2), gmsh_put(out, binary, 4, 1), gmsh_put(out, binary, 4, b);
        gmsh_put(out, binary, 8, end - begin);
        gmsh_line(out, binary);
        for (int n = begin; n < end; n++) gmsh_put(out, binary, 8, gmsh_node(m, n)), gmsh_line(out, binary);
        for (int n = begin; n < end; n++) {
            gmsh_position(out, binary, m->x[n]);
            if (b && binary) fwrite(m->x[n], sizeof(double), 2, out);
            if (b && !binary) fputs("0.5 -1e-3", out);
            gmsh_line(out, binary);
        }
    }
    for (int p = 0; p < m->part_count; p++) total += m->part[p].count;
    fprintf(out, "%s$EndNodes\n$Elements\n", binary ? "\n" : "");
    header[0] = m->part_count, header[1] = header[3] = total;
    for (int i = 0; i < 4; i++) gmsh_put(out, binary, 8, header[i]);
    gmsh_line(out, binary);
    for (int p = 0; p < m->part_count; p++) {
        const gmsh_part *part = &m->part[p];
        gmsh_put(out, binary, 4, part->dimension), gmsh_put(out, binary, 4, p + 1),
            gmsh_put(out, binary, 4, part->type);
        gmsh_put(out, binary, 8, part->count);
        gmsh_line(out, binary);
        for (int e = 0; e < part->count; e++) {
            gmsh_put(out, binary, 8, number++);
            for (int a = 0; a < part->nodes; a++)
                gmsh_put(out, binary, 8, gmsh_node(m, part->elements[e * part->nodes + a]));
            gmsh_line(out, binary);
        }
    }
    fprintf(out, "%s$EndElements\n", binary ? "\n" : "");
}

static void gmsh_write(const char *path, const gmsh_model *m, int version, bool binary) {
    FILE *out = fopen(path, "wb");
    int32_t one = 1;
    fprintf(out, "$MeshFormat\n%s %d 8\n", version == 4 ? "4.1" : "2.2", binary);
    if (binary) fwrite(&one, sizeof one, 1, out), fputc('\n', out);
    fputs("$EndMeshFormat\n", out);
    if (m->name_count) {
        fprintf(out, "$PhysicalNames\n%d\n", m->name_count);
        for (int p = 0; p < m->name_count; p++)
            fprintf(out, "%d %d \"%s\"\n", m->name[p].dimension, m->name[p].tag, m->name[p].name);
        fputs("$EndPhysicalNames\n", out);
    }
    (version == 4 ? gmsh_write_4 : gmsh_write_2)(m, binary, out);
    fclose(out);
}
