// What definitions have in common beside the public interface.
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/check.h"
#include "base/sweep.h"
#include "brunt.h"

enum { BRUNT_WORLD_COOKIE = 0x6272756e }; // the mark of a definition that was filled by its default function
enum { BRUNT_PAIR_LIMIT = 64 };           // of bodies in contact, with an account each

// Bounds of a body's shape where it is placed; without end where the shape has none.
brunt_box brunt_box_of_shape(const brunt_body_def *body, int dim);

// Two pairs of bodies in contact that have one name, "a-b", which columns of the history are called by: of 'a-b' with
// 'c' and 'a' with 'b-c'. Bodies by index, each pair in order of name. False: there are none.
bool brunt_pairs_of_one_name(const brunt_world_def *def, int32_t first[2], int32_t second[2]);

// Numbers of a body, a row each: what the check of definitions, the schemes and coarser worlds know of them.
typedef struct brunt_body_number {
    const char *key; // ".mass_scaling"
    size_t offset;   // of doubles in brunt_body_def
    int count;       // components
    int rule;        // BRUNT_NOT_NEGATIVE, ...
    bool length;     // a length, or a time that goes with it: a discretisation that is coarser has as much more of it
    const char *explicit_only; // implicit steps refuse what is above 0, and say this behind; NULL: they do not
    // Its key in scenes, where it is this number and nothing more; else doc is NULL, and io/scene/scene_keys.c has it.
    const char *unit, *initial; // "1/s"; "0", or "": it may be left out
    unsigned methods;           // bits of brunt_method that have it; 0: all
    const char *doc;
} brunt_body_number;
extern const brunt_body_number brunt_body_numbers[];
extern const int brunt_body_number_count;

// All lengths of a body's discretisation times `factor`, and what goes with them.
void brunt_body_coarsen(brunt_body_def *body, double factor);

// Where a body has it.
static inline const double *brunt_body_number_in(const brunt_body_def *body, const brunt_body_number *row) {
    return (const double *)((const char *)body + row->offset);
}

// Tells of all that the scheme of a definition cannot do, by the path of what asks for it ("bodies.rod.damping") and
// why. The definition is sound otherwise.
typedef void brunt_refusal_fn(void *context, const char *path, const char *reason);
void brunt_scheme_refusals(const brunt_world_def *def, brunt_refusal_fn *refuse, void *context);
