// The collection ParaView opens: which picture belongs to which body and time.
#pragma once

#include "brunt.h"

// Parts of a picture, a file each: the bodies, all members of a crowd as one, then the lines and surfaces that hold
// material points, then, of load steps with contact, what bodies do to each other. From 0 on: the part behind one;
// BRUNT_NONE: there is none.
int32_t brunt_picture_next(const brunt_world *world, int32_t part);
// Whether it is that last one; whether a body, else a line or surface behind the bodies.
bool brunt_picture_is_links(const brunt_world *world, int32_t part);
// Name of a part of picture `number`, inside the output folder: "vtu/<body>_<number>.vtu", of a boundary
// "vtu/boundary.<name>_<number>.vtu", of links "vtu/contact.links_<number>.vtu".
void brunt_picture_name(char out[128], const brunt_world *world, int32_t part, int64_t number);

// Rewrites the collection (aside, then renamed): picture n, at times[n] [s], in all its parts.
int brunt_pvd_write(const char *path, const brunt_world *world, const double *times, int64_t count, brunt_error *error);
