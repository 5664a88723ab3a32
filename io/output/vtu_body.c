// Pictures of bodies, and of crowds of them.
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "geometry/element_traits.h"
#include "io/output/parts.h"
#include "io/output/positions.h"
#include "io/output/vtu_picture.h"
#include "io/scene/crowd.h"

// A body whose picture is being taken.
typedef struct taking {
    brunt_world *world;
    int32_t body, end; // as far as the members of a crowd go, which are alike
    bool elements;
    brunt_vtu_picture *picture;
    char what[BRUNT_NAME_LENGTH + 16];
} taking;

static void *allocate(taking *t, size_t bytes, brunt_error *error) {
    return brunt_vtu_alloc(t->picture, bytes, t->what, error);
}

// Of all its bodies.
static int64_t size_of(const taking *t, brunt_location at) {
    int64_t size = 0;
    for (int32_t b = t->body; b < t->end; b++) size += brunt_body_size(t->world, b, at);
    return size;
}

// A field of all bodies that have it, one after the other. NULL: there is no memory.
static double *read_all(taking *t, const char *name, brunt_location at, int components, brunt_error *error) {
    const size_t count = (size_t)size_of(t, at) * (size_t)components;
    double *values = allocate(t, sizeof *values * count, error), *to = values;
    for (int32_t b = t->body; values && b < t->end; b++) {
        const int32_t field = brunt_body_find_field(t->world, b, name);
        if (field >= 0) brunt_body_read(t->world, b, field, to);
        to += brunt_body_size(t->world, b, at) * components;
    }
    return values;
}

static int add_integers(taking *t, const char *name, int64_t *values, bool at_cells) {
    brunt_vtu_add(t->picture,
                  (brunt_vtu_array){.name = name, .components = 1, .integers = values, .at_cells = at_cells});
    return BRUNT_OK;
}

static int add_ids(taking *t, bool at_cells, brunt_error *error) {
    const brunt_location here = at_cells ? BRUNT_AT_ELEMENTS : t->elements ? BRUNT_AT_NODES : BRUNT_AT_PARTICLES;
    int64_t *ids = allocate(t, sizeof *ids * (size_t)size_of(t, here), error), *to = ids;
    for (int32_t b = t->body; ids && b < t->end; b++) {
        const int32_t field = brunt_location_ids(t->world, b, here);
        const int64_t count = brunt_body_size(t->world, b, here);
        double *values = field >= 0 ? brunt_alloc(sizeof *values * (size_t)count) : NULL;
        if (field >= 0 && !values) return brunt_fail(error, BRUNT_FAILED, "out of memory for a picture's ids");
        if (values) brunt_body_read(t->world, b, field, values);
        for (int64_t i = 0; i < count; i++) *to++ = values ? (int64_t)values[i] : i;
        brunt_free(values);
    }
    return ids ? add_integers(t, "id", ids, at_cells) : BRUNT_FAILED;
}

// Of a crowd: whose each is, by its number.
static int add_members(taking *t, bool at_cells, brunt_error *error) {
    const brunt_location here = at_cells ? BRUNT_AT_ELEMENTS : t->elements ? BRUNT_AT_NODES : BRUNT_AT_PARTICLES;
    if (t->end == t->body + 1) return BRUNT_OK;
    int64_t *members = allocate(t, sizeof *members * (size_t)size_of(t, here), error), *to = members;
    for (int32_t b = t->body; members && b < t->end; b++) {
        const char *name = brunt_body_name(t->world, b);
        const int64_t number = strtoll(name + brunt_crowd_of(name) + 1, NULL, 10);
        for (int64_t i = 0; i < brunt_body_size(t->world, b, here); i++) *to++ = number;
    }
    return members ? add_integers(t, "member", members, at_cells) : BRUNT_FAILED;
}

static int add_cells(taking *t, brunt_error *error) {
    brunt_world *world = t->world;
    brunt_vtu_grid *grid = &t->picture->grid;
    const brunt_element_traits *element = brunt_element_traits_of(brunt_body_element(world, t->body));
    grid->cell_count = size_of(t, BRUNT_AT_ELEMENTS);
    grid->cell_nodes = element->nodes;
    grid->cell_type = element->shape->vtk_cell;
    int32_t *cells = allocate(t, sizeof *cells * (size_t)element->nodes * (size_t)grid->cell_count, error);
    int32_t *to = cells, first = 0;
    for (int32_t b = t->body; cells && b < t->end; b++) {
        const int64_t corners = element->nodes * brunt_body_size(world, b, BRUNT_AT_ELEMENTS);
        brunt_body_connectivity(world, b, to);
        for (int64_t i = 0; i < corners; i++) to[i] += first;
        to += corners, first += (int32_t)brunt_body_size(world, b, BRUNT_AT_NODES);
    }
    grid->cells = cells;
    return cells ? BRUNT_OK : BRUNT_FAILED;
}

static int add_grid(taking *t, brunt_error *error) {
    brunt_world *world = t->world;
    brunt_vtu_grid *grid = &t->picture->grid;
    t->elements = brunt_body_method(world, t->body) != BRUNT_MPM;
    const brunt_location here = t->elements ? BRUNT_AT_NODES : BRUNT_AT_PARTICLES;
    grid->point_count = size_of(t, here);
    if (grid->point_count > INT32_MAX)
        return brunt_fail(error, BRUNT_FAILED, "a picture of '%s' has more than %d points",
                          brunt_body_name(world, t->body), INT32_MAX);
    if (brunt_body_find_field(world, t->body, "position") < 0)
        return brunt_fail(error, BRUNT_FAILED, "body '%s' has no field 'position'", brunt_body_name(world, t->body));
    if (!(grid->points = read_all(t, "position", here, 3, error))) return BRUNT_FAILED;
    int status = add_ids(t, false, error);
    if (!status) status = add_members(t, false, error);
    if (!status && t->elements) status = add_cells(t, error);
    if (!status && t->elements) status = add_ids(t, true, error);
    return !status && t->elements ? add_members(t, true, error) : status;
}

static int add_field(taking *t, const char *name, brunt_error *error) {
    const brunt_vtu_picture *picture = t->picture;
    int32_t field = brunt_body_find_field(t->world, t->body, name);
    // The id is always there, and the position is the points.
    if (field < 0 || strcmp(name, "id") == 0 || strcmp(name, "position") == 0 || picture->array_count == PICTURE_FIELDS)
        return BRUNT_OK;
    for (int a = 0; a < picture->array_count; a++)
        if (strcmp(picture->arrays[a].name, name) == 0) return BRUNT_OK;
    const brunt_field_info info = brunt_body_field(t->world, t->body, field);
    const double *values = read_all(t, name, info.at, info.components, error);
    if (!values) return BRUNT_FAILED;
    brunt_vtu_add(t->picture, (brunt_vtu_array){.name = info.name,
                                                .unit = info.unit,
                                                .components = info.components,
                                                .values = values,
                                                .at_cells = info.at == BRUNT_AT_ELEMENTS});
    return BRUNT_OK;
}

// What a body shows when nothing is asked for.
static int add_default(taking *t, brunt_error *error) {
    static const char *const of_particles[] = {"velocity", NULL}, *const of_elements[] = {
                                                                      "displacement",  "velocity",
                                                                      "stress",        "plastic_strain",
                                                                      "contact_gap",   "contact_traction",
                                                                      "contact_state", NULL};
    int status = BRUNT_OK;
    for (const char *const *name = t->elements ? of_elements : of_particles; *name && !status; name++)
        status = add_field(t, *name, error);
    return status;
}

brunt_vtu_picture *brunt_vtu_take_body(brunt_world *world, int32_t body, const char (*fields)[64], int field_count,
                                       brunt_error *error) {
    taking t = {.world = world, .body = body, .end = brunt_part_end(world, body)};
    snprintf(t.what, sizeof t.what, "body '%s'", brunt_body_name(world, body));
    t.picture = brunt_vtu_start(world, t.what, error);
    if (!t.picture) return NULL;
    int status = add_grid(&t, error);
    for (int f = 0; f < field_count && !status; f++)
        status = strcmp(fields[f], "default") == 0 ? add_default(&t, error) : add_field(&t, fields[f], error);
    if (!status) return t.picture;
    brunt_vtu_release(t.picture);
    return NULL;
}
