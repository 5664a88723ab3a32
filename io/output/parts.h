// Parts of what is written: a body each, but all members of a crowd are one (io/scene/crowd.h).
#pragma once

#include "brunt.h"

// A part is known by its first body. That of the next one.
int32_t brunt_part_end(const brunt_world *world, int32_t first);
void brunt_part_name(const brunt_world *world, int32_t first, char out[BRUNT_NAME_LENGTH]);
