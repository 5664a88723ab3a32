// The whole state of a world as named blocks of bytes: what a checkpoint stores.
#pragma once

#include <stdint.h>
#include "brunt/world.h"

#ifdef __cplusplus
extern "C" {
#endif

// All that a run needs to go on with the same bits, as named blocks of bytes: a checkpoint stores them, restore brings
// them back.
typedef struct brunt_state_block {
    char name[96]; // "bodies/rod/velocity", "world/ledger"
    char type;     // 'd' double, 'f' float, 'i' int64, 'b' bytes
    int64_t count; // elements
} brunt_state_block;

// At any moment brunt_state_get writes the `count` elements that brunt_state_info says then, and every set keeps what
// it does not name. The blocks of a body of particles list the same particles in the same order; only setting its ids
// (or the elements of a mesh that erodes) may change how many there are, so what it holds comes first: after fewer ids
// the first particles are left, after more the new ones are all 0. A set that is refused changes nothing. After ids,
// elements or a block "world/...", brunt_state_done must be called before the next step; after other fields alone it
// need not be.
int32_t brunt_state_count(brunt_world *world);
brunt_state_block brunt_state_info(brunt_world *world,
                                   int32_t block);                  // no name and no elements: there is no such block
void brunt_state_get(brunt_world *world, int32_t block, void *out); // `count` elements
int brunt_state_set(brunt_world *world, int32_t block, const void *in, int64_t count, brunt_error *error);
// Call after the last brunt_state_set: sorts and checks.
int brunt_state_done(brunt_world *world, brunt_error *error);

#ifdef __cplusplus
}
#endif
