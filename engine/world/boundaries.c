// Planes, regions and groups of a definition: what becomes of each.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contact/planes/condition.h"
#include "base/error.h"
#include "base/memory.h"
#include "world/create.h"

static const double ON_GRID_LINE = 1e-6; // cells: how far off a mirror plane may be and still count as on the line

// Index of the axis a plane is normal to, -1 when it is oblique.
static int plane_axis(const brunt_plane_def *plane, int dim) {
    for (int a = 0; a < dim; a++)
        if (fabs(fabs(plane->normal[a]) - 1) < 1e-12) return a;
    return -1;
}

static bool has_fluid(const brunt_world_def *def) {
    for (int i = 0; i < def->body_count; i++) {
        const brunt_model *model = brunt_find_strength(def->materials[def->bodies[i].material].strength);
        if (def->bodies[i].method == BRUNT_MPM && model && model->fluid) return true;
    }
    return false;
}

static int make_plane(brunt_world *world, const brunt_world_def *def, int index, brunt_error *error) {
    brunt_boundary *wall = &world->boundaries.walls[index];
    brunt_plane_def *plane = &wall->plane;
    double size = 0;
    for (int a = 0; a < def->dimension; a++) size += plane->normal[a] * plane->normal[a];
    if (!(size > 0) || !isfinite(size)) REFUSE("boundaries[%d].plane.normal: it has no direction", index);
    for (int a = 0; a < 3; a++) plane->normal[a] = a < def->dimension ? plane->normal[a] / sqrt(size) : 0;
    if (!(plane->friction >= 0)) REFUSE("boundaries[%d].friction: %g is negative", index, plane->friction);
    bool moves = plane->velocity[0] != 0 || plane->velocity[1] != 0 || plane->velocity[2] != 0;
    int axis = plane_axis(plane, def->dimension);
    double at = axis < 0 ? 0 : (plane->point[axis] - def->origin[axis]) / def->cell;
    bool on_line = axis >= 0 && !moves && fabs(at - round(at)) < ON_GRID_LINE;
    if (!world->bodies.has_particles) { // meshes hold their nodes on any plane themselves
        world->boundaries.has_friction = world->boundaries.has_friction || plane->friction > 0;
        return BRUNT_OK;
    }
    const brunt_condition_row *row = &brunt_conditions[plane->condition];
    if (row->images && !on_line)
        REFUSE("boundaries[%d] (%s): a symmetry plane must stand still, be normal to an axis and lie on a grid line "
               "(cell %g m)",
               index, wall->name, def->cell);
    if (on_line && row->mirrors) {
        if (world->boundaries.mirror_count ==
            (int)(sizeof world->boundaries.mirrors / sizeof world->boundaries.mirrors[0]))
            REFUSE("boundaries: more than 16 symmetry and slip planes");
        for (int m = 0; m < world->boundaries.mirror_count; m++) {
            const brunt_symmetry_plane *other = &world->boundaries.mirrors[m];
            int32_t apart = (int32_t)round(at) - other->node;
            if (other->wall >= 0 && other->axis == axis && apart != 0 && abs(apart) <= (int)def->kernel &&
                has_fluid(def))
                brunt_warn(
                    &world->messages,
                    "boundaries[%d] (%s): this plane of symmetry or slip and '%s' are %d cells apart; the kernel "
                    "reaches over both, and fluids leak: at least %d are wanted",
                    index, wall->name, world->boundaries.walls[other->wall].name, abs(apart), (int)def->kernel + 1);
        }
        wall->mirror = world->boundaries.mirror_count;
        world->boundaries.mirrors[world->boundaries.mirror_count++] =
            (brunt_symmetry_plane){.axis = axis, .node = (int32_t)round(at), .wall = index};
        return BRUNT_OK;
    }
    if (row->of_fluids && has_fluid(def))
        brunt_warn(&world->messages, "boundaries[%d] (%s): %s", index, wall->name, row->of_fluids);
    world->boundaries.has_walls = world->boundaries.has_walls || row->pushes;
    world->boundaries.has_conditions = world->boundaries.has_conditions || !row->pushes;
    world->boundaries.has_friction = world->boundaries.has_friction || (row->pushes && plane->friction > 0);
    return BRUNT_OK;
}

int brunt_boundaries_make(brunt_world *world, const brunt_world_def *def, const brunt_body_def **order,
                          brunt_error *error) {
    world->boundaries.wall_count = def->plane_count + def->region_count + def->group_count + def->surface_count;
    world->boundaries.walls = brunt_alloc((size_t)(world->boundaries.wall_count + 1) * sizeof *world->boundaries.walls);
    if (!world->boundaries.walls) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    if (def->axisymmetric && world->bodies.has_particles)
        world->boundaries.mirrors[world->boundaries.mirror_count++] =
            (brunt_symmetry_plane){.axis = 0, .node = (int32_t)round(-def->origin[0] / def->cell), .wall = -1};
    for (int w = 0; w < world->boundaries.wall_count; w++) {
        brunt_boundary *wall = &world->boundaries.walls[w];
        wall->region = w >= def->plane_count;
        wall->mirror = wall->body = -1;
        if (w >= def->plane_count + def->region_count) { // the rest follows with the bodies
            const int group = w - def->plane_count - def->region_count, surface = group - def->group_count;
            const char *given = surface < 0 ? def->groups[group].name : def->surfaces[surface].name;
            if (given[0])
                memcpy(wall->name, given, sizeof wall->name);
            else
                snprintf(wall->name, sizeof wall->name, "%s%d", surface < 0 ? "group" : "surface", w + 1);
            continue;
        }
        if (wall->region)
            wall->where = def->regions[w - def->plane_count];
        else
            wall->plane = def->planes[w];
        const char *name = wall->region ? wall->where.name : wall->plane.name,
                   *body = wall->region ? wall->where.body : wall->plane.body;
        if (name[0])
            memcpy(wall->name, name, sizeof wall->name);
        else
            snprintf(wall->name, sizeof wall->name, "%s%d", wall->region ? "region" : "plane", w + 1);
        if (body[0] && (wall->body = brunt_find_ordered(order, def->body_count, body)) < 0)
            REFUSE("boundaries (%s).body: there is no body '%s'", wall->name, body);
        if (wall->region)
            world->boundaries.has_conditions = true;
        else {
            int status = make_plane(world, def, w, error);
            if (status) return status;
        }
    }
    return BRUNT_OK;
}
