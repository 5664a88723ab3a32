// Crowds of a scene: one body's keys, as many bodies.
#include "io/scene/scene_crowd.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "materials/prepared.h"

// ---------------------------------------------------------------------------------------------------- what it is

static void read_count(scene_reader *reader, const scene_node *node, brunt_crowd *crowd) {
    if (!node || !node->good) return;
    for (int a = 0; a < crowd->dimension; a++) {
        const double n = node->value[a];
        if (!(n >= 1 && n <= BRUNT_CROWD_LIMIT && n == floor(n)))
            brunt_tree_complain(reader->tree, node, "whole numbers of 1 to %d are wanted, one an axis",
                                BRUNT_CROWD_LIMIT);
        else
            crowd->count[a] = (int32_t)n;
    }
}

static bool read_two(scene_reader *reader, const scene_node *map, const char *key, const char *wanted, double to[2]) {
    const scene_node *node = brunt_tree_child(map, key);
    if (!node || !node->good) return false;
    if (node->count != 2) {
        brunt_tree_complain(reader->tree, node, "two numbers are wanted: %s", wanted);
        return false;
    }
    to[0] = node->first->value[0], to[1] = node->last->value[0];
    return true;
}

static void read_young(scene_reader *reader, const scene_node *map, brunt_crowd *crowd) {
    const scene_node *normal = brunt_tree_child(map, "normal"), *between = brunt_tree_child(map, "between");
    double range[2], bell[2] = {0};
    if (!read_two(reader, map, "between", "the least and the greatest", range)) return;
    if (!(range[0] > 0 && range[0] < range[1] && isfinite(range[1]))) {
        brunt_tree_complain(reader->tree, between, "the least must be above 0, the greatest above it");
        return;
    }
    if (normal && !read_two(reader, map, "normal", "the mean and the standard deviation", bell)) return;
    if (normal && !(bell[1] > 0)) {
        brunt_tree_complain(reader->tree, normal, "the standard deviation must be above 0");
        return;
    }
    if (normal && !(bell[0] >= range[0] && bell[0] <= range[1])) {
        brunt_tree_complain(reader->tree, normal, "the mean must be between %g and %g Pa (between)", range[0],
                            range[1]);
        return;
    }
    crowd->draws_young = true;
    crowd->low = range[0], crowd->high = range[1], crowd->mean = bell[0], crowd->sd = bell[1];
}

static void refuse_others(scene_reader *reader, const scene_node *body) {
    static const char *const keys[] = {"shape", "mesh", "grading", "faces"};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        brunt_refuse_key(reader, body, keys[k], "a crowd is of disks or balls of its own, this is for single bodies");
    const scene_node *method = brunt_tree_child(body, "method");
    if (method && method->good && method->value[0] == BRUNT_MEMBRANE)
        brunt_tree_complain(reader->tree, method, "a crowd is of method fem or mpm");
}

bool brunt_read_crowd(scene_reader *reader, scene_node *body, brunt_crowd *crowd) {
    const scene_node *map = brunt_tree_child(body, "crowd");
    const int mistakes = reader->tree->message_count;
    *crowd = (brunt_crowd){.dimension = reader->dimension, .seed = 1};
    if (!map || map->kind != SCENE_MAP) {
        brunt_refuse_key(reader, body, "random", "this belongs to a crowd, none is given");
        return false;
    }
    if (!reader->dimension) return false;
    scene_node *random = brunt_tree_child(body, "random");
    const scene_node *lattice = brunt_tree_child(map, "lattice"), *count = brunt_tree_child(map, "count");
    crowd->lattice = (brunt_lattice)(int)brunt_real_of(map, "lattice", BRUNT_LATTICE_SQUARE);
    crowd->radius = brunt_real_of(map, "radius", 0);
    crowd->spread = brunt_real_of(map, "radius_spread", 0);
    crowd->gap = brunt_real_of(map, "gap", 0);
    read_count(reader, count, crowd);
    if (crowd->lattice == BRUNT_LATTICE_HEX && crowd->dimension == 3)
        brunt_tree_complain(reader->tree, lattice, "hex is for two dimensions, square or random is wanted");
    if (crowd->lattice == BRUNT_LATTICE_HEX && crowd->count[0] == 1 && crowd->count[1] > 1)
        brunt_tree_complain(reader->tree, count, "rows of hex want two members at least: each second has one less");
    if (!random && (crowd->spread > 0 || crowd->lattice == BRUNT_LATTICE_RANDOM))
        random = brunt_add_default(reader, body, "random", "{}");
    crowd->seed = (uint64_t)brunt_real_of(random, "seed", 1);
    if (random && brunt_tree_child(random, "E")) read_young(reader, brunt_tree_child(random, "E"), crowd);
    refuse_others(reader, body);
    if (mistakes == reader->tree->message_count && brunt_crowd_size(crowd) > BRUNT_CROWD_LIMIT)
        brunt_tree_complain(reader->tree, count, "at most %d members can be held", BRUNT_CROWD_LIMIT);
    return mistakes == reader->tree->message_count && crowd->radius > 0 && count && count->good;
}

void brunt_crowd_shape(const brunt_crowd *crowd, brunt_shape *shape) {
    *shape = (brunt_shape){.kind = BRUNT_SPHERE, .radius = crowd->radius};
}

// ---------------------------------------------------------------------------------------------------- its members

// Of the strength model, where it has a modulus; BRUNT_NONE.
static int young_of(const brunt_material_def *material) {
    const brunt_model *model = brunt_find_strength(material->strength);
    for (int p = 0; model && p < model->parameter_count; p++)
        if (strcmp(model->parameters[p].key, "E") == 0) return p;
    return BRUNT_NONE;
}

int brunt_crowd_materials(const brunt_crowd *crowds, int count) {
    int64_t more = 0;
    for (int k = 0; k < count; k++)
        if (crowds[k].radius > 0 && crowds[k].draws_young) more += brunt_crowd_size(&crowds[k]);
    return (int)(more > INT32_MAX / 2 ? INT32_MAX / 2 : more);
}

// A material for each member, behind those there are, for which there is room. The first of them; `of` where all have
// that.
static int32_t make_materials(scene_reader *reader, const scene_node *body, const brunt_crowd *crowd, int32_t of) {
    brunt_world_def *world = &reader->scene->world;
    const int32_t size = (int32_t)brunt_crowd_size(crowd), first = world->material_count;
    if (!crowd->draws_young || of < 0) return of;
    const int E = young_of(&world->materials[of]);
    if (E < 0) {
        const scene_node *young = brunt_tree_child(brunt_tree_child(body, "random"), "E");
        brunt_tree_complain_key(reader->tree, young, "material '%s' has no E (%s)", world->materials[of].name,
                                world->materials[of].strength);
        return of;
    }
    for (int32_t i = 0; i < size; i++) {
        brunt_material_def *own = &world->materials[world->material_count++];
        *own = world->materials[of];
        own->strength_parameters[E] = brunt_crowd_young(crowd, i);
    }
    return first;
}

void brunt_expand_crowd(scene_reader *reader, const scene_node *node, const brunt_crowd *crowd,
                        brunt_body_def *members) {
    const brunt_body_def whole = members[0];
    const int32_t size = (int32_t)brunt_crowd_size(crowd);
    const int32_t first = make_materials(reader, node, crowd, whole.material);
    if (strlen(whole.name) + 9 > BRUNT_NAME_LENGTH)
        brunt_tree_complain_key(reader->tree, node, "the name of a crowd is too long: its members have a number more");
    for (int32_t i = 0; i < size; i++) {
        brunt_body_def *body = &members[i];
        double x[3];
        *body = whole;
        snprintf(body->name, sizeof body->name, "%.*s.%d", BRUNT_NAME_LENGTH - 12, whole.name, i + 1);
        if (first != whole.material) body->material = first + i;
        body->shape.radius = brunt_crowd_radius(crowd, i);
        body->size = whole.size * (body->shape.radius / crowd->radius); // the same mesh, larger or smaller
        brunt_crowd_centre(crowd, i, x);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) body->place.translation[a] += whole.place.rotation[3 * a + b] * x[b];
    }
}

// ---------------------------------------------------------------------------------------------------- by name

static int32_t first_from(const brunt_world_def *world, const char *name) {
    int32_t low = 0, high = world->body_count; // in order of name
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (strcmp(world->bodies[middle].name, name) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int32_t brunt_bodies_named(const scene_reader *reader, const char *name, int32_t *first) {
    const brunt_world_def *world = &reader->scene->world;
    char from[BRUNT_NAME_LENGTH + 1], to[BRUNT_NAME_LENGTH + 1];
    *first = first_from(world, name);
    if (*first < world->body_count && strcmp(world->bodies[*first].name, name) == 0) return 1;
    snprintf(from, sizeof from, "%.*s.", BRUNT_NAME_LENGTH - 1, name);
    snprintf(to, sizeof to, "%.*s/", BRUNT_NAME_LENGTH - 1, name); // '/' is the next after '.'
    *first = first_from(world, from);
    return first_from(world, to) - *first;
}
