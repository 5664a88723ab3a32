// Reading a body's fields, whatever it is made of.
#include <string.h>

#include "world/world.h"

int32_t brunt_body_field_count(const brunt_world *world, int32_t body) {
    const brunt_body_ref ref = world->bodies.all[body];
    return ref.mpm ? brunt_read_particle_fields(ref.mpm) : brunt_read_mesh_fields(world, ref.fem);
}

brunt_field_info brunt_body_field(const brunt_world *world, int32_t body, int32_t field) {
    const brunt_body_ref ref = world->bodies.all[body];
    return ref.mpm ? brunt_read_particle_field(ref.mpm, field) : brunt_read_mesh_field(world, ref.fem, field);
}

int32_t brunt_body_find_field(const brunt_world *world, int32_t body, const char *name) {
    for (int32_t f = 0; name && f < brunt_body_field_count(world, body); f++)
        if (!strcmp(brunt_body_field(world, body, f).name, name)) return f;
    return -1;
}

void brunt_body_read(brunt_world *world, int32_t body, int32_t field, double *out) {
    const brunt_body_ref ref = world->bodies.all[body];
    if (ref.mpm)
        brunt_read_particles(ref.mpm, field, out);
    else
        brunt_read_mesh(world, ref.fem, field, out);
}
