// What readers of kinds of boundaries share: a file each, boundary_KEY.c. Private to them.
#pragma once

#include "io/scene/scene_reader.h"

// Fills the definition of a boundary from its map: brunt_fill_plane, ...
#define BRUNT_FILL_BOUNDARY(NAME, kind, type, word, what)                                                              \
    void brunt_fill_##kind(scene_reader *reader, scene_node *node, type##_def *def);
BRUNT_BOUNDARY_KINDS(BRUNT_FILL_BOUNDARY)
#undef BRUNT_FILL_BOUNDARY

void brunt_fill_body_of(scene_reader *reader, const scene_node *node, char name[BRUNT_NAME_LENGTH]);
// Whether there are material points among the bodies a boundary acts on; a name that is wrong is another mistake.
bool brunt_acts_on_particles(const scene_reader *reader, const char *name);
// A vector of which some components may be free.
void brunt_fill_partial(scene_reader *reader, const scene_node *node, bool component[3], double value[3]);
// A turn; in three dimensions its axis must be given.
void brunt_fill_rotation(scene_reader *reader, const scene_node *turn, brunt_rotation_def *rotation);
// Factors over time.
void brunt_fill_table(scene_reader *reader, const scene_node *node, brunt_curve *table);
// "plane, region and group": names of a list, one after the other; `name` of i.
#define BRUNT_LIST_NAMES(out, count, name)                                                                             \
    for (size_t i = 0, used = 0; i < (count) && used < sizeof(out); i++)                                               \
    used += (size_t)snprintf((out) + used, sizeof(out) - used, "%s%s",                                                 \
                             i == 0            ? ""                                                                    \
                             : i + 1 < (count) ? ", "                                                                  \
                                               : " and ",                                                              \
                             (name))
