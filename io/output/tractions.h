// Tractions along the rims of meshes, as the last step has left them: tractions.csv.
#pragma once

#include "brunt.h"

int brunt_tractions_write(const char *path, const brunt_world *world, brunt_error *error);
