// What a file of a run, or a mesh file, holds, in words.
#pragma once

#include <stdio.h>

#include "brunt.h"

// Checkpoint, history, picture (.vtu), collection (.pvd) or mesh (.msh), told apart by their contents. BRUNT_BAD_INPUT
// for anything else and for a damaged file.
int brunt_describe_file(const char *path, FILE *out, brunt_error *error);
