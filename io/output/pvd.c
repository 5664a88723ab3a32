#include "io/output/pvd.h"

#include <stdio.h>

#include "base/array.h"
#include "io/file/atomic_file.h"
#include "io/output/parts.h"

static int32_t links_part(const brunt_world *world) {
    return brunt_body_count(world) + brunt_boundary_surface_count(world);
}

bool brunt_picture_is_links(const brunt_world *world, int32_t part) {
    int32_t count;
    return part == links_part(world) && brunt_world_static(world) && brunt_world_links(world, &count);
}

int32_t brunt_picture_next(const brunt_world *world, int32_t part) {
    const int32_t bodies = brunt_body_count(world), next = part < bodies ? brunt_part_end(world, part) : part + 1;
    return next < links_part(world) || brunt_picture_is_links(world, next) ? next : BRUNT_NONE;
}

// What a part is of; *boundary: whether that is a line or surface.
static void part_name(const brunt_world *world, int32_t part, char out[BRUNT_NAME_LENGTH], bool *boundary) {
    const int32_t bodies = brunt_body_count(world);
    brunt_boundary_surface_report report;
    *boundary = part >= bodies && !brunt_picture_is_links(world, part);
    if (part >= bodies && !*boundary) {
        snprintf(out, BRUNT_NAME_LENGTH, "contact.links");
        return;
    }
    if (!*boundary) {
        brunt_part_name(world, part, out);
        return;
    }
    brunt_boundary_surface_read(world, part - bodies, &report);
    snprintf(out, BRUNT_NAME_LENGTH, "%s", report.name);
}

void brunt_picture_name(char out[128], const brunt_world *world, int32_t part, int64_t number) {
    char name[BRUNT_NAME_LENGTH];
    bool boundary;
    part_name(world, part, name, &boundary);
    snprintf(out, 128, "vtu/%s%s_%06lld.vtu", boundary ? "boundary." : "", name, (long long)number);
}

int brunt_pvd_write(const char *path, const brunt_world *world, const double *times, int64_t count,
                    brunt_error *error) {
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\" "
          "header_type=\"UInt64\">\n  <Collection>\n",
          file.stream);
    for (int64_t n = 0; n < count; n++)
        for (int32_t b = 0, number = 0; b >= 0; b = brunt_picture_next(world, b), number++) {
            char name[128], part[BRUNT_NAME_LENGTH];
            bool boundary;
            brunt_picture_name(name, world, b, n);
            part_name(world, b, part, &boundary);
            fprintf(file.stream, "    <DataSet timestep=\"%.17g\" group=\"\" part=\"%d\" name=\"%s\" file=\"%s\"/>\n",
                    times[n], (int)number, part, name);
        }
    fputs("  </Collection>\n</VTKFile>\n", file.stream);
    return brunt_atomic_commit(&file, error);
}
