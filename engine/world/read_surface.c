// What is read of lines and surfaces that hold material points.
#include <string.h>

#include "world/world.h"

int32_t brunt_boundary_surface_count(const brunt_world *world) { return world->boundaries.surfaces.count; }

static void read_tool(const brunt_tool *tool, brunt_boundary_surface_report *report) {
    report->mass = tool->mass;
    for (int a = 0; a < 3; a++) report->position[a] = tool->centre[a] + tool->way[a];
    memcpy(report->velocity, tool->v, sizeof tool->v);
    memcpy(report->angular_momentum, tool->momentum, sizeof tool->momentum);
    brunt_tool_spin(tool, report->spin);
    report->kinetic = brunt_tool_kinetic(tool), report->gravity_work = tool->gravity_work;
}

void brunt_boundary_surface_read(const brunt_world *world, int32_t index, brunt_boundary_surface_report *report) {
    const brunt_boundary_surface *s = &world->boundaries.surfaces.surface[index];
    const brunt_impulse_account *last = &s->boundary->last, *all = &s->boundary->account;
    const double kick = world->clock.kick;
    *report = (brunt_boundary_surface_report){
        .work = all->external_work, .drift = s->drift, .pieces = s->pieces, .active = s->active};
    memcpy(report->name, s->boundary->name, sizeof report->name);
    for (int a = 0; a < 3; a++) {
        const int i = (a + 1) % 3, j = (a + 2) % 3;
        const double turn = s->def.about[i] * last->impulse[j] - s->def.about[j] * last->impulse[i];
        report->force[a] = kick > 0 ? last->impulse[a] / kick : 0;
        report->moment[a] = kick > 0 ? (last->angular[a] - turn) / kick : 0;
        report->impulse[a] = all->impulse[a];
    }
    if (s->tool.free) read_tool(&s->tool, report);
}

int64_t brunt_boundary_surface_size(const brunt_world *world, int32_t index) {
    return world->boundaries.surfaces.surface[index].particle_count;
}

void brunt_boundary_surface_particles(const brunt_world *world, int32_t index,
                                      const brunt_boundary_surface_arrays *out) {
    const brunt_boundary_surface *s = &world->boundaries.surfaces.surface[index];
    const int rows = brunt_boundary_surface_rows(s, world->settings.dimension);
    const brunt_placement place = brunt_boundary_surface_place(s, world->clock.time);
    double direction[3];
    for (int32_t b = 0; b < s->particle_count; b++) {
        const brunt_boundary_particle *p = &s->particle[b];
        double *traction = out->traction + 3 * (size_t)b;
        for (int a = 0; a < 3; a++) {
            out->position[3 * (size_t)b + (size_t)a] = place.translation[a];
            out->normal[3 * (size_t)b + (size_t)a] = traction[a] = 0;
            for (int i = 0; i < 3; i++) {
                out->position[3 * (size_t)b + (size_t)a] += place.rotation[3 * a + i] * p->x[i];
                out->normal[3 * (size_t)b + (size_t)a] += place.rotation[3 * a + i] * p->normal[i];
            }
        }
        for (int k = 0; k < rows; k++) {
            double t = 0;
            for (int i = 0; i < s->bodies; i++)
                t -= s->traction[3 * ((size_t)i * (size_t)s->pieces + (size_t)p->piece) + (size_t)k];
            brunt_boundary_surface_direction(s, p, k, direction);
            for (int a = 0; a < 9; a++) traction[a / 3] += t * place.rotation[a] * direction[a % 3];
        }
        out->weight[b] = p->weight, out->piece[b] = p->piece;
    }
}
