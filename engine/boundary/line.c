// Lines and surfaces that hold material points, as kinds of boundaries: what they do is in boundary_surface.c, and by
// terms of implicit steps.
#include <math.h>
#include <stdio.h>

#include "base/check.h"
#include "base/error.h"
#include "base/memory.h"
#include "boundary/boundaries.h"
#include "boundary/kinds.h"

#define REFUSE(...) return brunt_fail(error, BRUNT_BAD_INPUT, __VA_ARGS__)

BRUNT_BOUNDARY_ENTRIES(surface, brunt_boundary_surface)

brunt_boundary_surface_def brunt_boundary_surface_def_default(void) {
    return (brunt_boundary_surface_def){
        .condition = BRUNT_STICK, .piece = 1.5, .particles = 4, .rotation = {.axis = {0, 0, 1}}};
}

static void free_all(brunt_world_def *def) {
    for (int32_t i = 0; i < def->surface_count; i++) {
        brunt_free(def->surfaces[i].point);
        brunt_free(def->surfaces[i].facet);
        brunt_free(def->surfaces[i].table.points);
    }
    brunt_free(def->surfaces);
}

// Facets name corners that there are.
static int check_facets(const brunt_boundary_surface_def *surface, int dim, int32_t index, brunt_error *error) {
    if (surface->point_count < dim || surface->facet_count < 1)
        REFUSE("boundaries[%d]: %s at least", index,
               dim == 2 ? "a line wants two points" : "a surface wants a triangle");
    for (int32_t f = 0; f < surface->facet_count; f++)
        for (int c = 0; c < dim + (dim == 3 && surface->facet[f][3] != -1); c++)
            if (surface->facet[f][c] < 0 || surface->facet[f][c] >= surface->point_count)
                REFUSE("boundaries[%d]: facet %d has corner %d of %d", index, f, surface->facet[f][c],
                       surface->point_count);
    return BRUNT_OK;
}

// A free tool: what it has, and that nothing else says how it moves.
static int check_tool(const brunt_world_def *def, const brunt_boundary_surface_def *tool, const char *owner,
                      brunt_error *error) {
    const double *I = tool->inertia, *w = tool->spin;
    const bool turns = I[0] > 0 || I[1] > 0 || I[2] > 0, spins = w[0] != 0 || w[1] != 0 || w[2] != 0;
    BRUNT_CHECK_NUMBERS(owner, {".mass", &tool->mass, 1, BRUNT_NOT_NEGATIVE},
                        {".inertia", tool->inertia, 3, BRUNT_NOT_NEGATIVE},
                        {".center", tool->center, 3, BRUNT_ANY_NUMBER}, {".spin", tool->spin, 3, BRUNT_ANY_NUMBER});
    if (turns && !(tool->mass > 0)) REFUSE("%s.inertia: it goes with a mass", owner);
    if (spins && !turns) REFUSE("%s.spin: it goes with an inertia, without one nothing turns", owner);
    if (!(tool->mass > 0)) return BRUNT_OK;
    if (tool->displacement || tool->rotation.angle != 0 || tool->table.count)
        REFUSE("%s.mass: what has a mass goes as forces have it: velocity is that at the start, and displacement, "
               "rotation "
               "and table prescribe a motion",
               owner);
    if (turns && def->dimension == 2 && (I[0] > 0 || I[1] > 0 || w[0] != 0 || w[1] != 0 || !(I[2] > 0)))
        REFUSE("%s.inertia: in two dimensions it turns about z alone", owner);
    for (int a = 0; a < 3 && turns && def->dimension == 3; a++)
        if (!(I[a] > 0) || I[a] > (I[(a + 1) % 3] + I[(a + 2) % 3]) * (1 + 1e-12))
            REFUSE("%s.inertia: each is above 0 and no more than the sum of the other two", owner);
    if (def->axisymmetric && (turns || tool->value[0] != 0))
        REFUSE("%s.mass: a ring moves along its axis, and does not turn", owner);
    for (int32_t p = 0; p < def->plane_count; p++)
        if (def->planes[p].condition == BRUNT_SYMMETRY)
            REFUSE("%s.mass: a free tool and its image by a plane of symmetry would be two", owner);
    return BRUNT_OK;
}

static int check(const brunt_world_def *def, const void *one, int32_t w, brunt_error *error) {
    const brunt_boundary_surface_def *surface = one;
    char owner[80];
    snprintf(owner, sizeof owner, "boundaries[%d]", w);
    BRUNT_TRY(brunt_check_name_ends("boundaries", w, surface->body, error));
    BRUNT_TRY(brunt_check_choice(owner, ".condition", (unsigned)surface->condition, BRUNT_SEPARATE + 1, error));
    BRUNT_TRY(brunt_check_array("boundaries: points", surface->point_count, surface->point, error));
    BRUNT_TRY(brunt_check_array("boundaries: facets", surface->facet_count, surface->facet, error));
    BRUNT_TRY(check_facets(surface, def->dimension, w, error));
    BRUNT_TRY(brunt_check_curve(owner, ".table", &surface->table, error));
    for (int32_t k = 0; k < surface->point_count; k++)
        BRUNT_CHECK_NUMBERS(owner, {".line.points", surface->point[k], 3, BRUNT_ANY_NUMBER});
    BRUNT_CHECK_NUMBERS(owner, {".friction", &surface->friction, 1, BRUNT_NOT_NEGATIVE},
                        {".value", surface->value, 3, BRUNT_ANY_NUMBER}, {".piece", &surface->piece, 1, BRUNT_POSITIVE},
                        {".about", surface->about, 3, BRUNT_ANY_NUMBER});
    const brunt_rotation_def *turn = &surface->rotation;
    const int turned = turn->angle != 0 && isfinite(turn->angle);
    BRUNT_CHECK_NUMBERS(owner, {".rotation.angle", &turn->angle, 1, BRUNT_ANY_NUMBER},
                        {".rotation.axis", turn->axis, 3 * turned, BRUNT_ANY_NUMBER},
                        {".rotation.about", turn->about, 3 * turned, BRUNT_ANY_NUMBER});
    if (turned && !(hypot(hypot(turn->axis[0], turn->axis[1]), turn->axis[2]) > 0))
        REFUSE("%s.rotation.axis: the axis has zero length", owner);
    if (turned && def->dimension == 2 && (turn->axis[0] != 0 || turn->axis[1] != 0))
        REFUSE("%s.rotation.axis: in two dimensions what turns does so about z", owner);
    if (turned && !surface->displacement &&
        (surface->value[0] != 0 || surface->value[1] != 0 || surface->value[2] != 0))
        REFUSE("%s.rotation: it goes with a displacement, since the table is the factor of both", owner);
    if (surface->friction > 0 && surface->condition != BRUNT_SEPARATE)
        REFUSE("%s.friction: friction acts only with condition separate", owner);
    BRUNT_TRY(check_tool(def, surface, owner, error));
    if (surface->particles < 1) REFUSE("%s.particles_per_cell: %d is less than 1", owner, surface->particles);
    if (!(def->cell > 0)) REFUSE("%s: it holds material points, and there are none", owner);
    return BRUNT_OK;
}

static const char *refusal(const brunt_world_def *def, const void *one, const char **key) {
    *key = "";
    if (def->scheme == BRUNT_EXPLICIT) return NULL;
    if (((const brunt_boundary_surface_def *)one)->mass > 0) {
        *key = ".mass";
        return BRUNT_EXPLICIT_ONLY ": in implicit and load steps the motion of a line or mesh is prescribed";
    }
    if (brunt_solver_iterates(def->newton.solver))
        return def->newton.solver == BRUNT_SOLVER_PCG
                   ? "newton.solver: pcg has no factor for the tractions of boundaries to follow with: direct or auto"
                   : "newton.solver: matrix-free has no factor for the tractions of boundaries to follow with: direct "
                     "or auto";
    return NULL;
}

// The rest follows with the bodies (boundary_surface.c).
static int make(const brunt_boundary_making *m, const void *one, int w, brunt_error *error) {
    (void)error;
    const brunt_boundary_surface_def *surface = one;
    if (m->def->scheme != BRUNT_EXPLICIT) return BRUNT_OK;
    if (surface->condition == BRUNT_SEPARATE && brunt_boundary_has_fluid(m->def))
        brunt_warn(
            m->messages,
            "boundaries[%d] (%s): beside a line or mesh of condition separate the pressure of fluids is wrong in "
            "the two nearest rows of particles, and gas at rest tears there",
            w, m->all->boundary[w].name);
    m->all->meets_points = true;
    m->all->has_friction = m->all->has_friction || surface->friction > 0;
    return BRUNT_OK;
}

const brunt_boundary_kind brunt_kind_surface = {
    BRUNT_BOUNDARY_ROW("surface"),
    .refusal = refusal,
    .velocity = brunt_boundary_surface_speed,
    .meet_points = brunt_boundary_surface_meet,
    .met_points = brunt_boundary_surface_met,
};
