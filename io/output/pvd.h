// The collection ParaView opens: which picture belongs to which body and time.
#pragma once

#include "brunt.h"

// Name of the picture `number` of a body, inside the output folder: "vtu/<body>_<number>.vtu".
void brunt_picture_name(char out[128], const char *body, int64_t number);

// Rewrites the collection (aside, then renamed): picture n, at times[n] [s], of every body of the world.
int brunt_pvd_write(const char *path, const brunt_world *world, const double *times, int64_t count, brunt_error *error);
