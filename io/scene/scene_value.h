// One value against its row of the table of keys. Private to scene_check.c.
#pragma once

#include "io/scene/scene_reader.h"

enum { NAMES_LIMIT = 128 }; // keys of a group, words of a key

// "a map", "a list", "a single value", "nothing".
const char *brunt_kind_name(const scene_node *node);
// False after a message, at the key or the value, when it is no name.
bool brunt_check_name(scene_reader *reader, const scene_node *node, const char *name, bool at_key);
// "a, b, c"
void brunt_list_names(const char *const *names, int count, char *out, size_t size);
// Kind, unit, range, word or name of a value that is no group; `node` is good, and has its numbers, when they are.
void brunt_check_single_value(scene_reader *reader, scene_node *node, const scene_key *row);
