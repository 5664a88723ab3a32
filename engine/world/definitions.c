// Default values of the definitions. What must be given (cell, end, materials, shapes, normals) starts as 0 and is
// refused by brunt_world_create when it is left so.
#include "world/definitions.h"

#include "brunt.h"
#include "base/memory.h"
#include "boundary/kinds.h"
#include "contact/methods/method.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

brunt_world_def brunt_world_def_default(void) {
    return (brunt_world_def){
        .cookie = BRUNT_WORLD_COOKIE,
        .dimension = 3,
        .kernel = BRUNT_QUADRATIC,
        .transfer = BRUNT_APIC,
        .flip = 0.99,
        .energy_limit = 0.1,
        .newton = {.tolerance = 1e-6, .iterations = 100, .cut = 6, .accuracy = 1e-3},
        .contact = {.method = brunt_contact_default(BRUNT_EXPLICIT, false),
                    .iterations = -1,
                    .tolerance = 0.01,
                    .transfer = BRUNT_APIC,
                    .friction_iterations = 1},
    };
}

brunt_body_def brunt_body_def_default(void) {
    return (brunt_body_def){
        .place = brunt_placement_identity(),
        .particles_per_cell = 0, // by dimension: 4 or 8
        .fill = BRUNT_FILL_REGULAR,
        .seed = 1,
        .temperature = 293.15,
        .element = BRUNT_HEX8,
        .hourglass_coefficient = NAN, // by form
        .contact_thickness = NAN,     // the thickness
        .erosion = {.strain = INFINITY},
    };
}

void brunt_world_def_free(brunt_world_def *def) {
    for (int32_t i = 0; i < def->body_count; i++) {
        brunt_shape_free(&def->bodies[i].shape);
        brunt_mesh_free(&def->bodies[i].mesh);
        brunt_free(def->bodies[i].faces);
        for (int a = 0; a < 3; a++) brunt_free(def->bodies[i].grading[a].points);
    }
    for (int k = 0; k < brunt_boundary_kind_count; k++) brunt_boundary_kinds[k]->free(def);
    brunt_mesh_free(&def->background);
    brunt_free(def->materials);
    brunt_free(def->bodies);
    brunt_free(def->detonations);
    brunt_free(def->contact.pairs);
    *def = (brunt_world_def){0};
}

// ---------------------------------------------------------------------------------------------------- pairs

// Whether two bodies are in contact: with itself a body is only where a pair says so.
static bool in_contact(const brunt_contact_def *contact, const char *a, const char *b) {
    brunt_contact_method method = strcmp(a, b) ? contact->method : BRUNT_CONTACT_NONE;
    for (int32_t q = 0; q < contact->pair_count; q++) {
        const brunt_pair_def *pair = &contact->pairs[q];
        if ((!strcmp(pair->a, a) && !strcmp(pair->b, b)) || (!strcmp(pair->a, b) && !strcmp(pair->b, a)))
            method = pair->method;
    }
    return method != BRUNT_CONTACT_NONE;
}

bool brunt_pairs_of_one_name(const brunt_world_def *def, int32_t first[2], int32_t second[2]) {
    const int32_t n = def->body_count;
    char name[2 * BRUNT_PAIR_LIMIT][2 * BRUNT_NAME_LENGTH + 2];
    int32_t pair[2 * BRUNT_PAIR_LIMIT][2], count = 0;
    if ((int64_t)n * (n - 1) / 2 > BRUNT_PAIR_LIMIT) return false; // they share accounts, which are numbered
    for (int32_t i = 0; i < n; i++)
        for (int32_t k = i; k < n; k++) {
            const bool turned = strcmp(def->bodies[i].name, def->bodies[k].name) > 0;
            const int32_t a = turned ? k : i, b = turned ? i : k;
            if (!in_contact(&def->contact, def->bodies[a].name, def->bodies[b].name)) continue;
            snprintf(name[count], sizeof *name, "%s-%s", def->bodies[a].name, def->bodies[b].name);
            pair[count][0] = a, pair[count][1] = b;
            for (int32_t other = 0; other < count; other++) {
                if (strcmp(name[other], name[count])) continue;
                memcpy(first, pair[other], sizeof pair[other]), memcpy(second, pair[count], sizeof pair[count]);
                return true;
            }
            count++;
        }
    return false;
}

void *brunt_def_alloc(size_t bytes) { return brunt_alloc(bytes); }
