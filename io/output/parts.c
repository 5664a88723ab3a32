#include "io/output/parts.h"

#include <stdio.h>
#include <string.h>

#include "io/scene/crowd.h"

// Members stand side by side in the order of names: a dot comes before all that other names have.
int32_t brunt_part_end(const brunt_world *world, int32_t first) {
    const char *name = brunt_body_name(world, first);
    const int crowd = brunt_crowd_of(name);
    int32_t end = first + 1;
    while (crowd && end < brunt_body_count(world) && !strncmp(brunt_body_name(world, end), name, (size_t)crowd + 1))
        end++;
    return end;
}

void brunt_part_name(const brunt_world *world, int32_t first, char out[BRUNT_NAME_LENGTH]) {
    const char *name = brunt_body_name(world, first);
    const int crowd = brunt_crowd_of(name);
    snprintf(out, BRUNT_NAME_LENGTH, "%.*s", crowd ? crowd : BRUNT_NAME_LENGTH - 1, name);
}
