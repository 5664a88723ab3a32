#include "io/output/tractions.h"

#include "io/file/atomic_file.h"

int brunt_tractions_write(const char *path, const brunt_world *world, brunt_error *error) {
    int32_t count;
    brunt_atomic_file file;
    const brunt_traction *all = brunt_world_tractions(world, &count);
    const int status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    fputs("body,other,along [m],x [m],y [m],normal [Pa],tangential [Pa]\n", file.stream);
    for (int32_t i = 0; i < count; i++) {
        const brunt_traction *t = &all[i];
        brunt_reaction reaction = {.name = ""};
        if (t->boundary >= 0) brunt_boundary_reaction(world, t->boundary, &reaction);
        fprintf(file.stream, "%s,%s,%.9g,%.9g,%.9g,%.9g,%.9g\n", brunt_body_name(world, t->body),
                t->other >= 0 ? brunt_body_name(world, t->other) : reaction.name, t->along, t->position[0],
                t->position[1], t->normal, t->tangential);
    }
    return brunt_atomic_commit(&file, error);
}
