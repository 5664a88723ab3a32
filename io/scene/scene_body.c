// Bodies of a scene: what each method needs of them, and which keys are the other's.
#include "io/scene/scene_crowd.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/memory.h"
#include "base/names.h"
#include "io/mesh/gmsh.h"
#include "geometry/element_traits.h"
#include "geometry/mesh_shape.h"
#include "materials/prepared.h"

// Largest number of lattice intervals across anything: block coordinates are 32-bit.
static const double CELL_COUNT_LIMIT = 1e9, PARTICLE_LIMIT = 2147483648.0, ELEMENT_LIMIT = 2147483648.0;

// ---------------------------------------------------------------------------------------------------- size

// What says how large a body is: its shape, or the crowd that it is the first of.
static const scene_node *shape_of(const scene_node *node) {
    const scene_node *shape = brunt_tree_child(node, "shape");
    return shape ? shape : brunt_tree_child(node, "crowd");
}

typedef struct extents {
    double smallest, largest, volume, surface, farthest; // of the box around it: [m], [m^dimension], [m^2]
} extents;

// A length of 0.1 and an extent of 0.3 - 0.2 are the same: decimals of a file are taken as this near.
static const double DECIMALS = 1e-6;

// False after a message when there is nothing to fill.
static bool measure_shape(scene_reader *reader, const scene_node *shape, const brunt_body_def *body, extents *out) {
    double min[3] = {0}, max[3] = {0};
    int dimension = reader->dimension;
    if (!brunt_shape_bounds(&body->shape, dimension, min, max)) {
        brunt_tree_complain_key(reader->tree, shape,
                                "the shape is unbounded or empty: cut a half-space with a bounded shape");
        return false;
    }
    *out = (extents){.smallest = INFINITY, .volume = 1};
    for (int c = 0; c < dimension; c++) {
        double extent = max[c] - min[c];
        out->surface += 2 * extent * (max[(c + 1) % 3] - min[(c + 1) % 3]);
        out->smallest = fmin(out->smallest, extent);
        out->largest = fmax(out->largest, extent);
        out->volume *= extent;
        out->farthest = fmax(out->farthest, fmax(fabs(min[c]), fabs(max[c])));
        out->farthest = fmax(out->farthest, fabs(body->place.translation[c]));
    }
    if (isfinite(out->volume) && isfinite(out->farthest)) return true;
    brunt_tree_complain_key(reader->tree, shape, "the shape is too large to be computed with");
    return false;
}

static void check_filling(scene_reader *reader, const scene_node *shape, const brunt_body_def *body) {
    double cell = reader->scene->world.cell;
    int dimension = reader->dimension;
    extents size;
    if (!measure_shape(reader, shape, body, &size) || !(cell > 0)) return;
    char a[32], b[32];
    brunt_format_number(cell, a);
    brunt_format_number(size.smallest, b);
    if (cell > size.smallest * (1 + DECIMALS))
        brunt_tree_complain_key(reader->tree, shape,
                                "the grid's cell (%s m) is larger than the body's smallest extent (%s m)", a, b);
    if (size.farthest / cell > CELL_COUNT_LIMIT)
        brunt_tree_complain_key(reader->tree, shape, "the body reaches more than 1e9 cells (of %s m) from the origin",
                                a);
    int per_cell = body->particles_per_cell > 0 ? body->particles_per_cell : 1;
    double spacing = body->spacing > 0 ? body->spacing : cell / pow(per_cell, 1.0 / dimension);
    double particles = size.volume / pow(spacing, dimension);
    if (!(particles < PARTICLE_LIMIT))
        brunt_tree_complain_key(reader->tree, shape, "about %.3g particles fill it, at most %.0f can be held",
                                particles, PARTICLE_LIMIT - 1);
}

// Which faces a shape has does not depend on the size of the elements: the coarsest mesh tells.
static void check_faces(scene_reader *reader, const scene_node *node, const brunt_body_def *body, double largest) {
    brunt_mesh mesh;
    brunt_error error = {0};
    if (brunt_mesh_surface(&body->shape, body->element, largest, (const char(*)[BRUNT_NAME_LENGTH])body->faces,
                           body->face_count, &mesh, &error))
        brunt_tree_complain(reader->tree, brunt_tree_child(node, "faces"), "%s", error.message);
    brunt_mesh_free(&mesh);
}

static void check_meshing(scene_reader *reader, const scene_node *node, const brunt_body_def *body) {
    const scene_node *shape = shape_of(node), *edge = brunt_tree_child(node, "size");
    brunt_shape_kind kind = body->shape.kind;
    brunt_mesh_cut cut;
    brunt_error error = {0};
    if (brunt_mesh_cutting(&body->shape, reader->dimension, &cut, &error)) {
        brunt_tree_complain_key(reader->tree, shape, "%s; a mesh file (mesh: FILE.msh) can be anything", error.message);
        return;
    }
    if ((kind >= BRUNT_HALF_SPACE && kind != BRUNT_INTERSECTION) ||
        (kind == BRUNT_PRISM && body->shape.point_count != 4)) {
        brunt_tree_complain_key(reader->tree, shape,
                                "%s has no mesh of its own: box, sphere, cylinder, tube and polygons with four corners "
                                "have, and halves and quarters of them as intersections with boxes; a mesh file (mesh: "
                                "FILE.msh) can be anything",
                                kind == BRUNT_PRISM ? "this polygon" : shape->first->key);
        return;
    }
    extents size;
    if (!measure_shape(reader, shape, body, &size)) return;
    if (body->face_count && reader->dimension == 3 && brunt_element_is_membrane(body->element))
        check_faces(reader, node, body, size.largest);
    if (!(body->size > 0)) return;
    char a[32], b[32];
    brunt_format_number(body->size, a);
    brunt_format_number(size.largest, b);
    if (body->size > size.largest * (1 + DECIMALS))
        brunt_tree_complain(reader->tree, edge, "the elements (%s m) are larger than the body (%s m)", a, b);
    if (size.farthest / body->size > CELL_COUNT_LIMIT) // places of nodes would have lost too many digits
        brunt_tree_complain_key(reader->tree, shape,
                                "the body reaches more than 1e9 elements (of %s m) from the origin", a);
    // As many as cubes, or six times that of tetrahedra and twice of triangles.
    double cells = body->method == BRUNT_MEMBRANE ? size.surface / (body->size * body->size)
                                                  : size.volume / pow(body->size, reader->dimension);
    double elements = cells * brunt_element_traits_of(body->element)->shape->pieces;
    if (!brunt_tree_child(node, "grading") && !(elements < ELEMENT_LIMIT))
        brunt_tree_complain(reader->tree, edge, "about %.3g elements fill the shape, at most %.0f can be held",
                            elements, ELEMENT_LIMIT - 1);
}

// ---------------------------------------------------------------------------------------------------- material points

static void fill_count(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    scene_tree *tree = reader->tree;
    int dimension = reader->dimension;
    const scene_node *count = brunt_tree_child(node, "particles_per_cell"),
                     *spacing = brunt_tree_child(node, "spacing");
    if (count && spacing)
        brunt_tree_complain_key(tree, spacing, "spacing and particles_per_cell are both given, one of them is wanted");
    if (!count && !spacing && dimension)
        count = brunt_add_default(reader, node, "particles_per_cell", dimension == 2 ? "4" : "8");
    if (count && count->good) body->particles_per_cell = (int32_t)count->value[0];
    if (!count || !count->good || !dimension) return;
    int n = body->particles_per_cell, root = (int)lround(dimension == 2 ? sqrt(n) : cbrt(n));
    if ((dimension == 2 ? root * root : root * root * root) == n) return;
    int below = root, above = root + 1;
    if ((dimension == 2 ? root * root : root * root * root) > n) below = root - 1, above = root;
    if (below < 1) below = 1;
    brunt_tree_complain(tree, count, "%d is not a %s, as %d or %d", n, dimension == 2 ? "square number" : "cube",
                        dimension == 2 ? below * below : below * below * below,
                        dimension == 2 ? above * above : above * above * above);
}

static void fill_jitter(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    static const char *const keys[2] = {"jitter", "seed"}, *const initial[2] = {"0.25", "1"};
    for (int i = 0; i < 2; i++) {
        const scene_node *given = brunt_tree_child(node, keys[i]);
        if (given && body->fill != BRUNT_FILL_JITTERED)
            brunt_tree_complain_key(reader->tree, given, "%s is given without fill: jittered", keys[i]);
        if (!given && body->fill == BRUNT_FILL_JITTERED) brunt_add_default(reader, node, keys[i], initial[i]);
    }
    body->jitter = brunt_real_of(node, "jitter", 0);
    body->seed = (uint64_t)brunt_real_of(node, "seed", (double)body->seed);
}

static void fill_particles(scene_reader *reader, scene_node *node, brunt_body_def *body, bool measurable) {
    if (!shape_of(node))
        brunt_tree_complain_key(reader->tree, node, "'shape' is missing: what is filled with particles");
    int mistakes = reader->tree->message_count;
    fill_count(reader, node, body);
    if (measurable && mistakes == reader->tree->message_count) check_filling(reader, shape_of(node), body);
    fill_jitter(reader, node, body);
}

// ---------------------------------------------------------------------------------------------------- finite elements

bool brunt_find_mesh(scene_reader *reader, scene_node *node, char path[BRUNT_SCENE_PATH]) {
    const char *source = reader->scene->source, *slash = strrchr(source, '/');
    int folder = slash && node->text[0] != '/' ? (int)(slash - source) + 1 : 0;
    struct stat status;
    char joined[BRUNT_SCENE_PATH], *whole = NULL;
    int length = snprintf(joined, sizeof joined, "%.*s%s", folder, source, node->text);
    if (length < 0 || length >= (int)sizeof joined) {
        brunt_tree_complain(reader->tree, node, "the path is too long");
        return false;
    }
    // Pipes and devices could make the reader wait for ever.
    if (!*node->text || stat(joined, &status) != 0)
        brunt_tree_complain(reader->tree, node, "the mesh file '%.400s' cannot be read: %s", joined, strerror(errno));
    else if (!S_ISREG(status.st_mode))
        brunt_tree_complain(reader->tree, node, "'%.400s' is not a file", joined);
    else if (!(whole = realpath(joined, NULL)))
        brunt_tree_complain(reader->tree, node, "the mesh file '%.400s' cannot be read: %s", joined, strerror(errno));
    bool found = whole && snprintf(path, BRUNT_SCENE_PATH, "%s", whole) < BRUNT_SCENE_PATH;
    free(whole);
    if (found) {
        char *kept = brunt_tree_text(reader->tree, path, strlen(path));
        if (!kept) return false;
        node->text = kept;
    }
    return found;
}

void brunt_scale_places(const scene_node *node, const char *key, double (*x)[3], int32_t count) {
    const double unit = brunt_real_of(node, key, 1);
    for (int32_t n = 0; n < count; n++)
        for (int a = 0; a < 3; a++) x[n][a] *= unit;
}

// True when the body has elements whose kind is known.
static bool read_mesh(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    scene_node *mesh = brunt_tree_child(node, "mesh");
    const scene_node *group = brunt_tree_child(node, "group");
    brunt_refuse_key(reader, node, "element", "a mesh file has elements of its own");
    brunt_refuse_key(reader, node, "size", "a mesh file has elements of its own");
    char name[BRUNT_NAME_LENGTH] = "", path[BRUNT_SCENE_PATH];
    brunt_copy_text(reader, group, name, sizeof name);
    if (!mesh->good || !reader->dimension || (group && !*name) || !brunt_find_mesh(reader, mesh, path)) return false;
    brunt_error error = {0};
    int status = body->method == BRUNT_MEMBRANE
                     ? brunt_gmsh_read_membrane(path, name, &body->mesh, reader->warnings, &error)
                     : brunt_gmsh_read(path, name, reader->dimension, &body->mesh, reader->warnings, &error);
    if (status) {
        brunt_tree_complain(reader->tree, mesh, "%s", error.message);
        return false;
    }
    if (!brunt_tree_child(node, "mesh_unit")) brunt_add_default(reader, node, "mesh_unit", "1 m");
    brunt_scale_places(node, "mesh_unit", body->mesh.nodes, body->mesh.node_count);
    body->element = body->mesh.kind;
    return true;
}

static bool fill_elements(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    const scene_node *kind = brunt_tree_child(node, "element");
    int dimension = reader->dimension;
    const bool membrane = body->method == BRUNT_MEMBRANE;
    brunt_refuse_key(reader, node, "group", "this belongs to a mesh file, none is given");
    brunt_refuse_key(reader, node, "mesh_unit", "this belongs to a mesh file, none is given");
    if (!kind && dimension)
        kind = brunt_add_default(reader, node, "element", dimension == 2 || membrane ? "quad4" : "hex8");
    const brunt_element_kind solid = kind && kind->good ? brunt_element_named(kind->text) : BRUNT_HEX8;
    body->element = solid;
    if (!brunt_tree_child(node, "size"))
        brunt_tree_complain_key(reader->tree, node, "'size' is missing: a length (m), edge of the elements");
    bool known = kind && kind->good && dimension;
    char wanted[128];
    if (known && membrane && brunt_element_dimension(solid) == 3) {
        brunt_element_choice(2, wanted, sizeof wanted);
        brunt_tree_complain(reader->tree, kind, "a membrane has elements %s, not %s", wanted, kind->text);
        return false;
    }
    if (known && membrane) {
        body->element = brunt_element_as_membrane(solid);
        return true;
    }
    if (known && brunt_element_dimension(solid) != dimension) {
        brunt_element_choice(dimension, wanted, sizeof wanted);
        brunt_tree_complain(reader->tree, kind, "%s is for %d dimensions, %s is wanted", kind->text,
                            brunt_element_dimension(solid), wanted);
        return false;
    }
    return known;
}

static void fill_grading(scene_reader *reader, const scene_node *node, brunt_body_def *body) {
    static const char *const axes[3] = {"x", "y", "z"};
    const scene_node *map = brunt_tree_child(node, "grading");
    if (!map || map->kind != SCENE_MAP) return;
    if (body->shape.kind != BRUNT_BOX || body->method == BRUNT_MEMBRANE || brunt_tree_child(node, "mesh"))
        brunt_tree_complain_key(reader->tree, map, "only the mesh of a box of method fem is graded");
    for (int a = 0; a < 3; a++) {
        const scene_node *list = brunt_tree_child(map, axes[a]);
        brunt_curve *curve = &body->grading[a];
        if (!list || !list->good) continue;
        curve->points = brunt_entries_for(reader, list->count, sizeof *curve->points);
        for (const scene_node *point = curve->points ? list->first : NULL; point; point = point->next) {
            double *to = curve->points[curve->count++];
            to[0] = point->first->value[0];
            to[1] = point->last->value[0];
            if (point->last->base && strcmp(point->last->base, "1") != 0)
                brunt_tree_complain(reader->tree, point->last, "a factor on size has no unit");
            else if (!(to[1] > 0))
                brunt_tree_complain(reader->tree, point->last, "a factor on size must be above 0");
            if (curve->count > 1 && !(to[0] > to[-2]))
                brunt_tree_complain(reader->tree, point->first, "the coordinates must ascend");
        }
    }
}

static void fill_hourglass(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    const scene_node *map = brunt_tree_child(node, "hourglass");
    const bool simplex = brunt_element_is_simplex(body->element);
    if (map && simplex) {
        brunt_tree_complain_key(reader->tree, map, "triangles and tetrahedra have no zero-energy modes to control");
        return;
    }
    if (simplex) return;
    if (!map) map = brunt_add_default(reader, node, "hourglass", "{}");
    body->hourglass = (brunt_hourglass)(int)brunt_real_of(map, "form", BRUNT_HOURGLASS_STIFFNESS);
    body->hourglass_coefficient = brunt_real_of(map, "coefficient", NAN);
}

// A material that is good by itself may have no form for membranes.
static void check_membrane_material(scene_reader *reader, const scene_node *node, const brunt_body_def *body) {
    brunt_material material;
    brunt_error error = {0};
    if (body->material < 0) return;
    const brunt_material_def *def = &reader->scene->world.materials[body->material];
    if (brunt_material_make(def, &material, NULL) == BRUNT_OK &&
        brunt_material_make_membrane(def, body->tension_only, &material, &error) != BRUNT_OK)
        brunt_tree_complain(reader->tree, brunt_tree_child(node, "material"), "%s", error.message);
}

static void fill_membrane(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    const scene_node *faces = brunt_tree_child(node, "faces"), *method = brunt_tree_child(node, "method");
    if (reader->dimension == 2) brunt_tree_complain(reader->tree, method, "membranes are for three dimensions");
    if (!brunt_tree_child(node, "thickness"))
        brunt_tree_complain_key(reader->tree, node, "'thickness' is missing: a length (m), of the sheet");
    check_membrane_material(reader, node, body);
    if (brunt_tree_child(node, "mesh"))
        brunt_refuse_key(reader, node, "faces", "a mesh file is the sheet as it is: group chooses a part of it");
    if (!faces || !faces->good || brunt_tree_child(node, "mesh")) return;
    body->faces = brunt_entries_for(reader, faces->count, sizeof *body->faces);
    for (const scene_node *face = body->faces ? faces->first : NULL; face; face = face->next)
        brunt_copy_text(reader, face, body->faces[body->face_count++], sizeof *body->faces);
}

static void fill_fem(scene_reader *reader, scene_node *node, brunt_body_def *body, bool measurable) {
    bool shape = shape_of(node), mesh = brunt_tree_child(node, "mesh"), known = false;
    if (body->method == BRUNT_MEMBRANE) fill_membrane(reader, node, body);
    if (shape == mesh) {
        brunt_tree_complain_key(reader->tree, node, "exactly one of shape and mesh is wanted, %s given",
                                shape ? "both are" : "none is");
        return;
    }
    int mistakes = reader->tree->message_count;
    known = mesh ? read_mesh(reader, node, body) : fill_elements(reader, node, body);
    if (known) fill_hourglass(reader, node, body);
    fill_grading(reader, node, body);
    if (shape && measurable && mistakes == reader->tree->message_count && reader->dimension)
        check_meshing(reader, node, body);
}

// ---------------------------------------------------------------------------------------------------- motion

static void fill_spin(scene_reader *reader, const scene_node *spin, brunt_body_def *body) {
    if (!spin || spin->kind != SCENE_MAP) return;
    const scene_node *rate = brunt_tree_child(spin, "rate"), *axis = brunt_tree_child(spin, "axis");
    if (!rate || !rate->good) return;
    if (rate->components == 3) {
        if (axis) brunt_tree_complain_key(reader->tree, axis, "the rate is a vector and has its axis already");
        brunt_vector_of(spin, "rate", body->spin);
    } else if (reader->dimension == 2) {
        body->spin[2] = rate->value[0];
    } else if (!axis) {
        brunt_tree_complain(reader->tree, rate, "a number needs an axis beside it, or give a vector");
    } else {
        double direction[3] = {0};
        if (!brunt_vector_of(spin, "axis", direction)) return;
        double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
        if (!brunt_nonzero(direction))
            brunt_tree_complain(reader->tree, axis, "the axis has zero length");
        else
            for (int c = 0; c < 3; c++) body->spin[c] = rate->value[0] * direction[c] / length;
    }
}

static void check_wave(scene_reader *reader, const scene_node *wave, const brunt_body_def *body) {
    const scene_node *vector = wave ? brunt_tree_child(wave, "wave_vector") : NULL;
    if (vector && vector->good && !brunt_nonzero(body->wave_vector))
        brunt_tree_complain(reader->tree, vector, "the wave vector has zero length");
}

// ---------------------------------------------------------------------------------------------------- bodies

// `crowd` NULL: it is none.
static void fill_body(scene_reader *reader, scene_node *node, const brunt_names *materials, const brunt_crowd *crowd,
                      brunt_body_def *body) {
    if (node->kind != SCENE_MAP) return;
    const scene_node *material = brunt_tree_child(node, "material"), *method = brunt_tree_child(node, "method");
    const char *of = brunt_text_of(node, "material", "");
    body->material = brunt_names_find(materials, of, strlen(of));
    if (material && material->good && body->material < 0)
        brunt_complain_name(reader, material, "material", "materials");
    int mistakes = reader->tree->message_count;
    const scene_node *shape = brunt_tree_child(node, "shape");
    brunt_fill_shape_def(reader, shape, &body->shape);
    if (crowd) brunt_crowd_shape(crowd, &body->shape);
    body->place = brunt_fill_placement(reader, brunt_tree_child(node, "place"));
    bool measurable = ((shape && shape->good) || crowd) && reader->dimension && mistakes == reader->tree->message_count;
    body->method = (brunt_method)(int)brunt_real_of(node, "method", BRUNT_MPM);
    // Without a method it is not known which keys are wanted.
    if (method && method->good) brunt_fill_fields(reader, node, "bodies.*", 1u << body->method, body);
    if (method && method->good && body->method == BRUNT_MPM) fill_particles(reader, node, body, measurable);
    if (method && method->good && body->method != BRUNT_MPM) fill_fem(reader, node, body, measurable);
    const scene_node *erosion = brunt_tree_child(node, "erosion");
    if (erosion && body->method == BRUNT_MPM)
        brunt_refuse_key(reader, erosion, "step", "material points have no stable step of their own");
    fill_spin(reader, brunt_tree_child(node, "spin"), body);
    check_wave(reader, brunt_tree_child(node, "wave"), body);
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const brunt_body_def *)a)->name, ((const brunt_body_def *)b)->name);
}

// Bodies of the scene's keys, and in `crowd` which of those are crowds: of others the radius is 0.
static int64_t count_bodies(scene_reader *reader, const scene_node *map, brunt_crowd *crowd) {
    int64_t count = 0;
    for (scene_node *child = map->first; child; child = child->next, crowd++) {
        if (child->kind != SCENE_MAP || !brunt_read_crowd(reader, child, crowd)) crowd->radius = 0;
        count += crowd->radius > 0 ? brunt_crowd_size(crowd) : 1;
    }
    return count;
}

static void fill_all(scene_reader *reader, const scene_node *map, const brunt_names *materials,
                     const brunt_crowd *crowd) {
    brunt_world_def *world = &reader->scene->world;
    for (scene_node *child = map->first; child; child = child->next, crowd++) {
        const bool many = crowd->radius > 0;
        brunt_body_def *body = &world->bodies[world->body_count];
        *body = brunt_body_def_default();
        snprintf(body->name, sizeof body->name, "%s", child->key);
        fill_body(reader, child, materials, many ? crowd : NULL, body);
        if (many) brunt_expand_crowd(reader, child, crowd, body);
        world->body_count += many ? (int32_t)brunt_crowd_size(crowd) : 1;
    }
}

// Members of crowds may have materials of their own: room for them, before names are looked up where they are.
static void reserve_materials(scene_reader *reader, const brunt_crowd *crowds, int count) {
    brunt_world_def *world = &reader->scene->world;
    const int more = brunt_crowd_materials(crowds, count);
    brunt_material_def *all = more ? brunt_entries_for(reader, world->material_count + more, sizeof *all) : NULL;
    if (!all) return;
    if (world->material_count) memcpy(all, world->materials, (size_t)world->material_count * sizeof *all);
    brunt_free(world->materials);
    world->materials = all;
}

void brunt_fill_bodies(scene_reader *reader) {
    enum { LIMIT = 4 * BRUNT_CROWD_LIMIT };
    brunt_world_def *world = &reader->scene->world;
    const scene_node *map = brunt_tree_child(reader->tree->root, "bodies");
    const int keys = brunt_children_of(map, SCENE_MAP);
    brunt_crowd *crowds = brunt_entries_for(reader, keys, sizeof *crowds);
    const int64_t count = crowds ? count_bodies(reader, map, crowds) : 0;
    if (count > LIMIT) brunt_tree_complain_key(reader->tree, map, "more than %d bodies cannot be held", LIMIT);
    if (count <= LIMIT) world->bodies = brunt_entries_for(reader, (int)count, sizeof *world->bodies);
    brunt_names materials = {.count = 0};
    if (world->bodies) reserve_materials(reader, crowds, keys);
    if (world->bodies && world->material_count &&
        brunt_names_sort(&materials, world->materials[0].name, sizeof *world->materials, world->material_count, NULL))
        reader->tree->exhausted = true;
    if (world->bodies && !reader->tree->exhausted) {
        fill_all(reader, map, &materials, crowds);
        qsort(world->bodies, (size_t)world->body_count, sizeof *world->bodies, by_name);
    }
    brunt_names_free(&materials);
    brunt_free(crowds);
}
