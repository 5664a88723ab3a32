#include "io/output/pvd.h"

#include <stdio.h>

#include "base/error.h"
#include "base/memory.h"
#include "io/file/atomic_file.h"
#include "io/output/parts.h"

int brunt_picture_parts_list(brunt_picture_parts *parts, const brunt_world *world, brunt_error *error) {
    const int32_t bodies = brunt_body_count(world), surfaces = brunt_boundary_surface_count(world);
    int32_t links;
    *parts = (brunt_picture_parts){.part = brunt_alloc(sizeof *parts->part * (size_t)(bodies + surfaces + 1))};
    if (!parts->part) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    brunt_picture_part *next = parts->part;
    for (int32_t b = 0; b < bodies; b = brunt_part_end(world, b), next++) {
        next->kind = BRUNT_PICTURE_BODY, next->index = b;
        brunt_part_name(world, b, next->name);
    }
    for (int32_t s = 0; s < surfaces; s++, next++) {
        brunt_boundary_surface_report report;
        brunt_boundary_surface_read(world, s, &report);
        next->kind = BRUNT_PICTURE_BOUNDARY, next->index = s;
        snprintf(next->name, sizeof next->name, "%s", report.name);
    }
    if (brunt_world_static(world) && brunt_world_links(world, &links)) {
        next->kind = BRUNT_PICTURE_LINKS;
        snprintf(next->name, sizeof next->name, "contact.links");
        next++;
    }
    parts->count = (int32_t)(next - parts->part);
    return BRUNT_OK;
}

void brunt_picture_parts_free(brunt_picture_parts *parts) {
    brunt_free(parts->part);
    *parts = (brunt_picture_parts){0};
}

void brunt_picture_name(char out[128], const brunt_picture_part *part, int64_t number) {
    snprintf(out, 128, "vtu/%s%s_%06lld.vtu", part->kind == BRUNT_PICTURE_BOUNDARY ? "boundary." : "", part->name,
             (long long)number);
}

int brunt_pvd_write(const char *path, const brunt_picture_parts *parts, const double *times, int64_t count,
                    brunt_error *error) {
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\" "
          "header_type=\"UInt64\">\n  <Collection>\n",
          file.stream);
    for (int64_t n = 0; n < count; n++)
        for (int32_t p = 0; p < parts->count; p++) {
            char name[128];
            brunt_picture_name(name, &parts->part[p], n);
            fprintf(file.stream, "    <DataSet timestep=\"%.17g\" group=\"\" part=\"%d\" name=\"%s\" file=\"%s\"/>\n",
                    times[n], (int)p, parts->part[p].name, name);
        }
    fputs("  </Collection>\n</VTKFile>\n", file.stream);
    return brunt_atomic_commit(&file, error);
}
