// What definitions have in common beside the public interface.
#pragma once

#include "brunt.h"

enum { BRUNT_WORLD_COOKIE = 0x6272756e }; // the mark of a definition that was filled by its default function
enum { BRUNT_MOST_PAIRS = 64 };           // of bodies in contact, with an account each

// Two pairs of bodies in contact that have one name, "a-b", which columns of the history are called by: of 'a-b' with
// 'c' and 'a' with 'b-c'. Bodies by index, each pair in order of name. False: there are none.
bool brunt_pairs_of_one_name(const brunt_world_def *def, int32_t first[2], int32_t second[2]);

// Tells of all that the scheme of a definition cannot do, by the path of what asks for it ("bodies.rod.damping") and
// why. The definition is sound otherwise.
typedef void brunt_refusal_fn(void *context, const char *path, const char *reason);
void brunt_scheme_refusals(const brunt_world_def *def, brunt_refusal_fn *refuse, void *context);
