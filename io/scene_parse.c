// The world that a checked tree describes, and what its keys must say together.
#include "scene_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"

void brunt_copy_text(scene_reader *reader, const scene_node *node, char *out, size_t size) {
    if (!node || !node->good || !node->text) return;
    if (strlen(node->text) >= size) {
        brunt_tree_complain(reader->tree, node, "too long: at most %d bytes are wanted", (int)size - 1);
        return;
    }
    memcpy(out, node->text, strlen(node->text) + 1);
}

static int children_of(const scene_node *node, scene_kind kind) { return node && node->kind == kind ? node->count : 0; }

// An array for as many entries as a map or list has.
static void *entries_for(scene_reader *reader, int count, size_t size) {
    if (count == 0) return NULL;
    void *memory = brunt_alloc((size_t)count * size);
    if (!memory) reader->tree->exhausted = true;
    return memory;
}

static bool nonzero(const double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return length > 0 && isfinite(length);
}

// ---------------------------------------------------------------------------------------------------- names

const brunt_body_def *brunt_body_named(const scene_reader *reader, const char *name) {
    const brunt_world_def *world = &reader->scene->world;
    for (int i = 0; i < world->body_count; i++)
        if (strcmp(world->bodies[i].name, name) == 0) return &world->bodies[i];
    return NULL;
}

static void complain_name(scene_reader *reader, const scene_node *node, const char *what, const char *parent) {
    enum { SHOWN = 64 };
    const char *names[SHOWN];
    int count = 0;
    const scene_node *map = brunt_tree_child(reader->tree->root, parent);
    for (const scene_node *child = map ? map->first : NULL; child && child->key && count < SHOWN; child = child->next)
        names[count++] = child->key;
    const char *nearest = brunt_nearest_name(node->text, names, count);
    char all[512] = "";
    size_t used = 0;
    for (int i = 0; i < count && used + 4 < sizeof all; i++)
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    if (nearest)
        brunt_tree_complain(reader->tree, node, "there is no %s '%s', did you mean '%s'?", what, node->text, nearest);
    else
        brunt_tree_complain(reader->tree, node, "there is no %s '%s'; there are: %s", what, node->text,
                            count ? all : "none");
}

void brunt_check_body_name(scene_reader *reader, const scene_node *node) {
    if (!node || !node->good || !node->text) return;
    if (!brunt_tree_child(brunt_tree_child(reader->tree->root, "bodies"), node->text))
        complain_name(reader, node, "body", "bodies");
}

// ---------------------------------------------------------------------------------------------------- time and grid

static void fill_time(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *time = brunt_tree_child(reader->tree->root, "time");
    if (!time || time->kind != SCENE_MAP) return;
    world->end = brunt_real_of(time, "end", 0);
    world->step = brunt_real_of(time, "step", 0);
    const scene_node *step = brunt_tree_child(time, "step"), *cfl = brunt_tree_child(time, "cfl");
    if (step && cfl) brunt_tree_complain_key(reader->tree, step, "step and cfl are both given, one of them is wanted");
    if (step && world->step > world->end && world->end > 0)
        brunt_tree_complain(reader->tree, step, "the step is longer than the run");
    if (!step && !cfl) brunt_add_default(reader, time, "cfl", "0.5");
    world->cfl = brunt_real_of(time, "cfl", world->cfl);
    world->energy_limit = brunt_real_of(time, "energy_limit", world->energy_limit);
}

static void fill_grid(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    scene_node *grid = brunt_tree_child(reader->tree->root, "grid");
    if (!grid || grid->kind != SCENE_MAP) return;
    world->cell = brunt_real_of(grid, "cell", 0);
    brunt_vector_of(grid, "origin", world->origin);
    world->kernel = (brunt_kernel)(BRUNT_LINEAR + (int)brunt_real_of(grid, "kernel", 1));
    scene_node *transfer = brunt_tree_child(grid, "transfer");
    if (!transfer) return;
    if (transfer->kind == SCENE_SCALAR && transfer->good && transfer->value[0] == BRUNT_FLIP) {
        // The word alone and the map with its default are the same: the resolved scene has the map.
        transfer->kind = SCENE_MAP;
        brunt_add_default(reader, transfer, "flip", "0.99");
    }
    if (transfer->kind == SCENE_MAP) {
        if (!brunt_tree_child(transfer, "flip"))
            brunt_tree_complain(reader->tree, transfer, "{flip: SHARE} is wanted, or one of the words pic, flip, apic");
        world->transfer = BRUNT_FLIP;
        world->flip = brunt_real_of(transfer, "flip", world->flip);
    } else {
        world->transfer = (brunt_transfer)(int)brunt_real_of(grid, "transfer", BRUNT_APIC);
    }
}

// ---------------------------------------------------------------------------------------------------- materials

static void check_model(scene_reader *reader, const scene_node *at, const brunt_model *model, const double *parameters,
                        double density, bool with_eos) {
    real constants[BRUNT_MAX_CONSTANTS] = {0};
    const char *wrong = model->prepare ? model->prepare(parameters, density, with_eos, constants) : NULL;
    if (wrong) brunt_tree_complain_key(reader->tree, at, "%s: %s", model->name, wrong);
}

static void fill_material(scene_reader *reader, const scene_node *node, brunt_material_def *material) {
    if (node->kind != SCENE_MAP) return;
    scene_node *eos = brunt_tree_child(node, "eos"), *viscosity = brunt_tree_child(node, "viscosity");
    material->density = brunt_real_of(node, "density", 0);
    snprintf(material->strength, sizeof material->strength, "%s", brunt_text_of(node, "model", ""));
    const brunt_model *strength = brunt_find_strength(material->strength);
    bool density = material->density > 0;
    if (strength && brunt_read_parameters(node, strength, material->strength_parameters) && density)
        check_model(reader, node, strength, material->strength_parameters, material->density, eos != NULL);
    if (strength && eos && !strength->accepts_eos)
        brunt_tree_complain_key(reader->tree, eos, "%s has a pressure of its own and takes no equation of state",
                                strength->name);
    if (eos && eos->kind == SCENE_MAP) {
        snprintf(material->eos, sizeof material->eos, "%s", brunt_text_of(eos, "model", ""));
        const brunt_model *model = brunt_find_eos(material->eos);
        if (model && brunt_read_parameters(eos, model, material->eos_parameters) && density)
            check_model(reader, eos, model, material->eos_parameters, material->density, true);
    }
    if (viscosity && viscosity->kind == SCENE_MAP) {
        material->bulk_viscosity = true;
        if (brunt_read_parameters(viscosity, &brunt_bulk_viscosity, material->viscosity_parameters) && density)
            check_model(reader, viscosity, &brunt_bulk_viscosity, material->viscosity_parameters, material->density,
                        eos != NULL);
    }
}

static void fill_materials(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *map = brunt_tree_child(reader->tree->root, "materials");
    int count = children_of(map, SCENE_MAP);
    world->materials = entries_for(reader, count, sizeof *world->materials);
    if (!world->materials) return;
    for (const scene_node *child = map->first; child; child = child->next) {
        brunt_material_def *material = &world->materials[world->material_count++];
        snprintf(material->name, sizeof material->name, "%s", child->key);
        fill_material(reader, child, material);
    }
}

// ---------------------------------------------------------------------------------------------------- bodies

// Largest number of lattice intervals across anything: block coordinates are 32-bit.
static const double CELL_COUNT_LIMIT = 1e9, PARTICLE_LIMIT = 2147483648.0;

static void check_particles(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    scene_tree *tree = reader->tree;
    int dimension = reader->dimension;
    const scene_node *count = brunt_tree_child(node, "particles_per_cell"),
                     *spacing = brunt_tree_child(node, "spacing");
    if (count && spacing)
        brunt_tree_complain_key(tree, spacing, "spacing and particles_per_cell are both given, one of them is wanted");
    if (!count && !spacing && dimension)
        count = brunt_add_default(reader, node, "particles_per_cell", dimension == 2 ? "4" : "8");
    body->spacing = brunt_real_of(node, "spacing", 0);
    body->particles_per_cell = (int32_t)brunt_real_of(node, "particles_per_cell", 0);
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

static void check_size(scene_reader *reader, const scene_node *node, const brunt_body_def *body) {
    double min[3] = {0}, max[3] = {0}, cell = reader->scene->world.cell;
    const scene_node *shape = brunt_tree_child(node, "shape");
    int dimension = reader->dimension;
    if (!dimension) return;
    if (!brunt_shape_bounds(&body->shape, dimension, min, max)) {
        brunt_tree_complain_key(reader->tree, shape,
                                "the shape is unbounded or empty: cut a half-space with a bounded shape");
        return;
    }
    double smallest = INFINITY, volume = 1, farthest = 0;
    for (int c = 0; c < dimension; c++) {
        double extent = max[c] - min[c];
        smallest = fmin(smallest, extent);
        volume *= extent;
        farthest = fmax(farthest, fmax(fabs(min[c]), fabs(max[c])));
    }
    for (int c = 0; c < dimension; c++) farthest = fmax(farthest, fabs(body->place.translation[c]));
    if (!isfinite(volume) || !isfinite(farthest)) {
        brunt_tree_complain_key(reader->tree, shape, "the shape is too large to be computed with");
        return;
    }
    if (!(cell > 0)) return;
    char a[32], b[32];
    brunt_format_number(cell, a);
    brunt_format_number(smallest, b);
    if (cell > smallest)
        brunt_tree_complain_key(reader->tree, shape,
                                "the grid's cell (%s m) is larger than the body's smallest extent (%s m)", a, b);
    if (farthest / cell > CELL_COUNT_LIMIT)
        brunt_tree_complain_key(reader->tree, shape, "the body reaches more than 1e9 cells (of %s m) from the origin",
                                a);
    int per_cell = body->particles_per_cell > 0 ? body->particles_per_cell : 1;
    double spacing = body->spacing > 0 ? body->spacing : cell / pow(per_cell, 1.0 / dimension);
    double particles = volume / pow(spacing, dimension);
    if (!(particles < PARTICLE_LIMIT))
        brunt_tree_complain_key(reader->tree, shape, "about %.3g particles fill it, at most %.0f can be held",
                                particles, PARTICLE_LIMIT - 1);
}

static void fill_jitter(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    body->fill = (brunt_fill)(int)brunt_real_of(node, "fill", 0);
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

static void fill_spin(scene_reader *reader, const scene_node *spin, brunt_body_def *body) {
    if (!spin || spin->kind != SCENE_MAP) return;
    const scene_node *rate = brunt_tree_child(spin, "rate"), *axis = brunt_tree_child(spin, "axis");
    brunt_vector_of(spin, "about", body->spin_about);
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
        if (!nonzero(direction))
            brunt_tree_complain(reader->tree, axis, "the axis has zero length");
        else
            for (int c = 0; c < 3; c++) body->spin[c] = rate->value[0] * direction[c] / length;
    }
}

static void fill_wave(scene_reader *reader, const scene_node *wave, brunt_body_def *body) {
    if (!wave || wave->kind != SCENE_MAP) return;
    brunt_vector_of(wave, "velocity", body->wave_velocity);
    body->wave_phase = brunt_real_of(wave, "phase", 0);
    if (brunt_vector_of(wave, "wave_vector", body->wave_vector) && !nonzero(body->wave_vector))
        brunt_tree_complain(reader->tree, brunt_tree_child(wave, "wave_vector"), "the wave vector has zero length");
}

static void fill_body(scene_reader *reader, scene_node *node, brunt_body_def *body) {
    brunt_world_def *world = &reader->scene->world;
    if (node->kind != SCENE_MAP) return;
    const scene_node *material = brunt_tree_child(node, "material");
    body->material = -1;
    for (int i = 0; i < world->material_count; i++)
        if (strcmp(world->materials[i].name, brunt_text_of(node, "material", "")) == 0) body->material = i;
    if (material && material->good && body->material < 0) complain_name(reader, material, "material", "materials");
    int mistakes = reader->tree->message_count;
    const scene_node *shape = brunt_tree_child(node, "shape");
    brunt_fill_shape_def(reader, shape, &body->shape);
    body->place = brunt_fill_place(reader, brunt_tree_child(node, "place"));
    check_particles(reader, node, body);
    if (shape && shape->good && mistakes == reader->tree->message_count) check_size(reader, node, body);
    fill_jitter(reader, node, body);
    brunt_vector_of(node, "velocity", body->velocity);
    fill_spin(reader, brunt_tree_child(node, "spin"), body);
    fill_wave(reader, brunt_tree_child(node, "wave"), body);
    body->temperature = brunt_real_of(node, "temperature", body->temperature);
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const brunt_body_def *)a)->name, ((const brunt_body_def *)b)->name);
}

static void fill_bodies(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *map = brunt_tree_child(reader->tree->root, "bodies");
    int count = children_of(map, SCENE_MAP);
    world->bodies = entries_for(reader, count, sizeof *world->bodies);
    if (!world->bodies) return;
    for (scene_node *child = map->first; child; child = child->next) {
        brunt_body_def *body = &world->bodies[world->body_count++];
        *body = brunt_body_def_default();
        snprintf(body->name, sizeof body->name, "%s", child->key);
        fill_body(reader, child, body);
    }
    qsort(world->bodies, (size_t)world->body_count, sizeof *world->bodies, by_name);
}

// ---------------------------------------------------------------------------------------------------- contact

static void fill_pair(scene_reader *reader, scene_node *node, brunt_pair_def *pair) {
    brunt_contact_def *contact = &reader->scene->world.contact;
    if (node->kind != SCENE_MAP) return;
    static const char *const methods[] = {"none", "multi-velocity"};
    char friction[32];
    brunt_format_number(contact->friction, friction);
    if (!brunt_tree_child(node, "method")) brunt_add_default(reader, node, "method", methods[contact->method]);
    if (!brunt_tree_child(node, "friction")) brunt_add_default(reader, node, "friction", friction);
    pair->method = (brunt_contact_method)(int)brunt_real_of(node, "method", contact->method);
    pair->friction = brunt_real_of(node, "friction", 0);
    const scene_node *between = brunt_tree_child(node, "between");
    if (!between || !between->good) return;
    if (between->count != 2) {
        brunt_tree_complain(reader->tree, between, "%d names are given, the two bodies of the pair are wanted",
                            between->count);
        return;
    }
    brunt_check_body_name(reader, between->first);
    brunt_check_body_name(reader, between->last);
    brunt_copy_text(reader, between->first, pair->a, sizeof pair->a);
    brunt_copy_text(reader, between->last, pair->b, sizeof pair->b);
    for (int i = 0; i < contact->pair_count; i++) {
        const brunt_pair_def *other = &contact->pairs[i];
        if (other == pair || !*other->a) continue;
        if ((strcmp(other->a, pair->a) == 0 && strcmp(other->b, pair->b) == 0) ||
            (strcmp(other->a, pair->b) == 0 && strcmp(other->b, pair->a) == 0))
            brunt_tree_complain(reader->tree, between, "this pair is there twice");
    }
}

static void fill_contact(scene_reader *reader) {
    brunt_contact_def *contact = &reader->scene->world.contact;
    const scene_node *node = brunt_tree_child(reader->tree->root, "contact");
    if (!node || node->kind != SCENE_MAP) return;
    contact->method = (brunt_contact_method)(int)brunt_real_of(node, "method", contact->method);
    contact->friction = brunt_real_of(node, "friction", 0);
    contact->allow_overlap = brunt_real_of(node, "initial_overlap", 0) == 1;
    const scene_node *list = brunt_tree_child(node, "pairs");
    contact->pairs = entries_for(reader, children_of(list, SCENE_LIST), sizeof *contact->pairs);
    if (!contact->pairs) return;
    for (scene_node *child = list->first; child; child = child->next)
        fill_pair(reader, child, &contact->pairs[contact->pair_count++]);
}

// ---------------------------------------------------------------------------------------------------- boundaries

static void refuse_key(scene_reader *reader, const scene_node *node, const char *key, const char *why) {
    const scene_node *child = brunt_tree_child(node, key);
    if (child) brunt_tree_complain_key(reader->tree, child, "%s", why);
}

static void check_symmetry(scene_reader *reader, const scene_node *node, const brunt_plane_def *plane) {
    const brunt_world_def *world = &reader->scene->world;
    const scene_node *where = brunt_tree_child(node, "plane");
    int axis = -1, nonzeros = 0;
    for (int c = 0; c < 3; c++)
        if (plane->normal[c] != 0) axis = c, nonzeros++;
    if (nonzeros > 1) {
        brunt_tree_complain(reader->tree, brunt_tree_child(where, "normal"),
                            "a symmetry plane stands across x, y or z");
        return;
    }
    if (nonzeros == 0 || !(world->cell > 0)) return;
    double lines = (plane->point[axis] - world->origin[axis]) / world->cell;
    if (!(fabs(lines - round(lines)) < 1e-9 * fmax(1, fabs(lines)))) {
        char a[32], b[32];
        brunt_format_number(world->origin[axis] + floor(lines) * world->cell, a);
        brunt_format_number(world->origin[axis] + ceil(lines) * world->cell, b);
        brunt_tree_complain(reader->tree, brunt_tree_child(where, "point"),
                            "a symmetry plane lies on a grid line: %c = %s or %s is wanted (or move grid.origin)",
                            "xyz"[axis], a, b);
    }
}

static void fill_plane(scene_reader *reader, scene_node *node, brunt_plane_def *plane) {
    const scene_node *where = brunt_tree_child(node, "plane"), *condition = brunt_tree_child(node, "condition");
    brunt_vector_of(where, "point", plane->point);
    bool normal = brunt_vector_of(where, "normal", plane->normal);
    if (normal && !nonzero(plane->normal))
        brunt_tree_complain(reader->tree, brunt_tree_child(where, "normal"), "the normal has zero length");
    if (!condition)
        brunt_tree_complain(reader->tree, node, "'condition' is missing: one of stick, slip, separate, symmetry");
    plane->condition = (brunt_condition)(int)brunt_real_of(node, "condition", BRUNT_SEPARATE);
    if (condition && condition->good && plane->condition != BRUNT_SEPARATE)
        refuse_key(reader, node, "friction", "friction acts only with condition: separate");
    else if (!brunt_tree_child(node, "friction"))
        brunt_add_default(reader, node, "friction", "0");
    plane->friction = brunt_real_of(node, "friction", 0);
    static const char *const regional[] = {"from", "until", "place"};
    for (int i = 0; i < 3; i++) refuse_key(reader, node, regional[i], "this belongs to a region, not to a plane");
    scene_node *velocity = brunt_tree_child(node, "velocity");
    if (plane->condition == BRUNT_SYMMETRY)
        refuse_key(reader, node, "velocity", "a symmetry plane does not move");
    else if (!velocity)
        brunt_add_default(reader, node, "velocity", "0");
    if (velocity && (velocity->free[0] || velocity->free[1] || velocity->free[2]))
        brunt_tree_complain(reader->tree, velocity, "`free` is for regions; a wall has a velocity");
    else
        brunt_vector_of(node, "velocity", plane->velocity);
    if (plane->condition == BRUNT_SYMMETRY && normal) check_symmetry(reader, node, plane);
    brunt_check_body_name(reader, brunt_tree_child(node, "body"));
    brunt_copy_text(reader, brunt_tree_child(node, "body"), plane->body, sizeof plane->body);
}

static void fill_region(scene_reader *reader, scene_node *node, brunt_region_def *region) {
    const scene_node *velocity = brunt_tree_child(node, "velocity"), *until = brunt_tree_child(node, "until");
    brunt_fill_shape_def(reader, brunt_tree_child(node, "region"), &region->shape);
    region->place = brunt_fill_place(reader, brunt_tree_child(node, "place"));
    refuse_key(reader, node, "condition", "this belongs to a plane, not to a region");
    refuse_key(reader, node, "friction", "this belongs to a plane, not to a region");
    if (!velocity)
        brunt_tree_complain(reader->tree, node, "'velocity' is missing: a list of numbers or `free`, in m/s");
    bool any = false;
    for (int c = 0; c < 3; c++) {
        region->component[c] = c < reader->dimension && velocity && velocity->good && !velocity->free[c];
        region->velocity[c] = region->component[c] ? velocity->value[c] : 0;
        any |= region->component[c];
    }
    if (velocity && velocity->good && !any && reader->dimension)
        brunt_tree_complain(reader->tree, velocity, "all components are free: nothing would be prescribed");
    if (!brunt_tree_child(node, "from")) brunt_add_default(reader, node, "from", "0");
    region->start = brunt_real_of(node, "from", 0);
    if (!until) until = brunt_add_default(reader, node, "until", "none");
    region->end = brunt_real_of(node, "until", INFINITY);
    if (until && until->good && !(region->start < region->end))
        brunt_tree_complain(reader->tree, until, "until must be after from");
    brunt_check_body_name(reader, brunt_tree_child(node, "body"));
    brunt_copy_text(reader, brunt_tree_child(node, "body"), region->body, sizeof region->body);
}

static void check_wall_names(scene_reader *reader, const scene_node *list) {
    for (const scene_node *a = list->first; a; a = a->next) {
        const char *name = brunt_text_of(a, "name", "");
        for (const scene_node *b = list->first; *name && b != a; b = b->next)
            if (strcmp(brunt_text_of(b, "name", ""), name) == 0)
                brunt_tree_complain(reader->tree, brunt_tree_child(a, "name"), "the name '%s' is there twice", name);
    }
}

static void fill_boundaries(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *list = brunt_tree_child(reader->tree->root, "boundaries");
    int count = children_of(list, SCENE_LIST);
    world->planes = entries_for(reader, count, sizeof *world->planes);
    world->regions = entries_for(reader, count, sizeof *world->regions);
    if (!world->planes || !world->regions) return;
    for (scene_node *node = list->first; node; node = node->next) {
        if (node->kind != SCENE_MAP) continue;
        bool plane = brunt_tree_child(node, "plane"), region = brunt_tree_child(node, "region");
        if (plane == region) {
            brunt_tree_complain(reader->tree, node, "exactly one of plane and region is wanted");
            continue;
        }
        char name[32];
        snprintf(name, sizeof name, "%s%d", plane ? "plane" : "region",
                 (plane ? world->plane_count : world->region_count) + 1);
        if (!brunt_tree_child(node, "name")) brunt_add_default(reader, node, "name", name);
        const scene_node *given = brunt_tree_child(node, "name");
        if (plane) {
            brunt_plane_def *def = &world->planes[world->plane_count++];
            *def = brunt_plane_def_default();
            brunt_copy_text(reader, given, def->name, sizeof def->name);
            fill_plane(reader, node, def);
        } else {
            brunt_region_def *def = &world->regions[world->region_count++];
            *def = brunt_region_def_default();
            brunt_copy_text(reader, given, def->name, sizeof def->name);
            fill_region(reader, node, def);
        }
    }
    check_wall_names(reader, list);
}

void brunt_fill_world(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *root = reader->tree->root, *loads = brunt_tree_child(root, "loads");
    *world = brunt_world_def_default();
    if (reader->dimension) world->dimension = reader->dimension;
    brunt_copy_text(reader, brunt_tree_child(root, "title"), reader->scene->title, sizeof reader->scene->title);
    fill_time(reader);
    fill_grid(reader);
    fill_materials(reader);
    fill_bodies(reader);
    fill_contact(reader);
    fill_boundaries(reader);
    brunt_vector_of(loads, "gravity", world->gravity);
    world->gravity_ramp = brunt_real_of(loads, "gravity_ramp", 0);
}

// ---------------------------------------------------------------------------------------------------- output

void brunt_fill_output(scene_reader *reader) {
    brunt_output_def *output = &reader->scene->output;
    const scene_node *node = brunt_tree_child(reader->tree->root, "output");
    if (!node || node->kind != SCENE_MAP) return;
    output->every = brunt_real_of(node, "every", 0);
    output->history = brunt_real_of(node, "history", 0);
    output->checkpoint = brunt_real_of(node, "checkpoint", 600);
    output->float32 = brunt_real_of(node, "precision", 0) == 0;
    const scene_node *fields = brunt_tree_child(node, "fields"), *probes = brunt_tree_child(node, "probes");
    output->fields = entries_for(reader, children_of(fields, SCENE_LIST), sizeof *output->fields);
    for (const scene_node *child = output->fields ? fields->first : NULL; child; child = child->next)
        brunt_copy_text(reader, child, output->fields[output->field_count++], sizeof *output->fields);
    output->probes = entries_for(reader, children_of(probes, SCENE_MAP), sizeof *output->probes);
    for (const scene_node *child = output->probes ? probes->first : NULL; child; child = child->next) {
        brunt_probe *probe = &output->probes[output->probe_count++];
        snprintf(probe->name, sizeof probe->name, "%.*s", BRUNT_NAME_LENGTH - 1, child->key);
        brunt_check_body_name(reader, brunt_tree_child(child, "body"));
        brunt_copy_text(reader, brunt_tree_child(child, "body"), probe->body, sizeof probe->body);
        brunt_copy_text(reader, brunt_tree_child(child, "field"), probe->field, sizeof probe->field);
        brunt_vector_of(child, "point", probe->point);
    }
}
