// Crowds of a scene. Private to the scene reader.
#pragma once

#include "io/scene/crowd.h"
#include "io/scene/scene_reader.h"

// The crowd that a body's keys ask for. False: none, or a mistake that has been said.
bool brunt_read_crowd(scene_reader *reader, scene_node *body, brunt_crowd *crowd);
// What a member is made of, at the origin.
void brunt_crowd_shape(const brunt_crowd *crowd, brunt_shape *shape);
// How many materials of their own the members of crowds have; there must be room for them where they are expanded.
int brunt_crowd_materials(const brunt_crowd *crowds, int count);
// All members from the first of them, which is filled as one at the origin.
void brunt_expand_crowd(scene_reader *reader, const scene_node *node, const brunt_crowd *crowd,
                        brunt_body_def *members);
// Bodies in order of name that a name stands for: one, or all members of a crowd. How many; 0: there are none.
int32_t brunt_bodies_named(const scene_reader *reader, const char *name, int32_t *first);
