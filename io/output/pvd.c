#include "io/output/pvd.h"

#include <stdio.h>

#include "io/file/atomic_file.h"

void brunt_picture_name(char out[128], const char *body, int64_t number) {
    snprintf(out, 128, "vtu/%s_%06lld.vtu", body, (long long)number);
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
        for (int32_t b = 0; b < brunt_body_count(world); b++) {
            char name[128];
            brunt_picture_name(name, brunt_body_name(world, b), n);
            fprintf(file.stream, "    <DataSet timestep=\"%.17g\" group=\"\" part=\"%d\" name=\"%s\" file=\"%s\"/>\n",
                    times[n], (int)b, brunt_body_name(world, b), name);
        }
    fputs("  </Collection>\n</VTKFile>\n", file.stream);
    return brunt_atomic_commit(&file, error);
}
