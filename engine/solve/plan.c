// What a world does and does not do: effects, passes, arrays.
#include <stdio.h>
#include <string.h>

#include "world.h"

// The first model that brings an effect, NULL when none does; `flag`: where brunt_model says so.
static const brunt_model *find_model(const brunt_world *world, size_t flag) {
    for (int i = 0; i < world->body_count; i++)
        for (int k = 0; k < BRUNT_COMPONENTS; k++) {
            const brunt_model *model = world->bodies[i].material.model[k];
            if (model && *(const bool *)((const char *)model + flag)) return model;
        }
    return NULL;
}

#define BRUNT_EFFECTS(X)                                                                                               \
    X(affine, world->transfer == BRUNT_APIC, "grid.transfer")                                                          \
    X(contact, world->has_contact, "contact.method")                                                                   \
    X(friction, world->has_friction, "friction of contact or boundaries")                                              \
    X(walls, world->has_walls, "boundaries: condition separate")                                                       \
    X(mirrors, world->mirror_count > 0, "boundaries: condition symmetry or slip")                                      \
    X(conditions, world->has_conditions, "boundaries: stick, oblique slip, region")                                    \
    X(gravity, world->has_gravity, "loads.gravity")

#define BRUNT_MODEL_EFFECTS(X)                                                                                         \
    X(plasticity, plastic) X(thermal, thermal) X(equation_of_state, eos) X(bulk_viscosity, viscous)

enum {
#define COUNT(name, ...) EFFECT_##name,
    BRUNT_EFFECTS(COUNT) BRUNT_MODEL_EFFECTS(COUNT) EFFECT_COUNT
#undef COUNT
};

int32_t brunt_effect_count(const brunt_world *world) {
    (void)world;
    return EFFECT_COUNT;
}

brunt_effect brunt_world_effect(const brunt_world *world, int32_t effect) {
    switch (effect) {
#define ROW(name, on, key)                                                                                             \
    case EFFECT_##name: return (brunt_effect){#name, on, (on) ? key : ""};
        BRUNT_EFFECTS(ROW)
#undef ROW
#define ROW(effect_name, flag)                                                                                         \
    case EFFECT_##effect_name: {                                                                                       \
        const brunt_model *model = find_model(world, offsetof(brunt_model, flag));                                     \
        return (brunt_effect){#effect_name, model != NULL, model ? model->name : ""};                                         \
    }
        BRUNT_MODEL_EFFECTS(ROW)
#undef ROW
    default: return (brunt_effect){"", false, ""};
    }
}

bool brunt_pass_planned(const brunt_world *world, int pass) {
    switch (pass) {
#define ROW(name, when)                                                                                                \
    case BRUNT_PASS_##name: return when;
        BRUNT_PASSES(ROW)
#undef ROW
    default: return false;
    }
}

int32_t brunt_pass_count(const brunt_world *world) {
    int32_t n = 0;
    for (int p = 0; p < BRUNT_PASS_COUNT; p++) n += brunt_pass_planned(world, p);
    return n;
}

brunt_pass brunt_world_pass(const brunt_world *world, int32_t index) {
    static const char *const names[] = {
#define ROW(name, when) #name,
        BRUNT_PASSES(ROW)
#undef ROW
    };
    for (int p = 0; p < BRUNT_PASS_COUNT; p++) {
        if (!brunt_pass_planned(world, p) || index-- > 0) continue;
        brunt_pass pass = {.name = names[p], .calls = world->pass[p].calls, .seconds = world->pass[p].seconds};
        for (size_t t = 0; t < sizeof pass.thread_seconds / sizeof pass.thread_seconds[0]; t++)
            pass.thread_seconds[t] = world->pass[p].thread_seconds[t];
        return pass;
    }
    return (brunt_pass){.name = ""};
}

// Arrays: of each body its particle fields, its sort and its grid.
enum { EXTRA = 2 };

int32_t brunt_array_count(const brunt_world *world) {
    int32_t n = 0;
    for (int i = 0; i < world->body_count; i++) {
        const brunt_particles *p = &world->bodies[i].particles;
        for (int f = 0; f < p->field_count; f++) n += p->field[f].components > 0;
        n += EXTRA;
    }
    return n;
}

brunt_array brunt_world_array(const brunt_world *world, int32_t index) {
    brunt_array array = {.unit = ""};
    for (int i = 0; i < world->body_count; i++) {
        const brunt_body *body = &world->bodies[i];
        const brunt_particles *p = &body->particles;
        size_t fields = 0;
        for (int f = 0; f < p->field_count; f++) {
            size_t bytes = (size_t)p->field[f].components * (size_t)p->capacity * sizeof(real);
            fields += bytes;
            if (!bytes || index-- > 0) continue;
            snprintf(array.name, sizeof array.name, "%s.%s", body->name, p->field[f].name);
            array.unit = p->field[f].unit, array.components = p->field[f].components, array.bytes = bytes;
            return array;
        }
        if (index-- == 0) {
            snprintf(array.name, sizeof array.name, "%s: ids and sort", body->name);
            array.components = 1, array.bytes = p->slab_bytes - fields;
            return array;
        }
        if (index-- == 0) {
            snprintf(array.name, sizeof array.name, "%s: grid", body->name);
            array.components = 1, array.bytes = brunt_grid_bytes(&body->grid);
            return array;
        }
    }
    return array;
}
