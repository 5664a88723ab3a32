// The collection ParaView opens: which picture belongs to which body and time.
#pragma once

#include "brunt.h"

typedef enum brunt_picture_kind { BRUNT_PICTURE_BODY, BRUNT_PICTURE_BOUNDARY, BRUNT_PICTURE_LINKS } brunt_picture_kind;

// A part of a picture, a file of its own.
typedef struct brunt_picture_part {
    brunt_picture_kind kind;
    int32_t index; // of the body, of a crowd its first one; of the line or surface
    char name[BRUNT_NAME_LENGTH];
} brunt_picture_part;

// The parts of all pictures of a run: the bodies, all members of a crowd as one, then the lines and surfaces that hold
// material points, then, of load steps with contact, what bodies do to each other.
typedef struct brunt_picture_parts {
    int32_t count;
    brunt_picture_part *part;
} brunt_picture_parts;

// BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_picture_parts_list(brunt_picture_parts *parts, const brunt_world *world, brunt_error *error);
void brunt_picture_parts_free(brunt_picture_parts *parts);

// Name of a part of picture `number`, inside the output folder: "vtu/<body>_<number>.vtu", of a boundary
// "vtu/boundary.<name>_<number>.vtu", of links "vtu/contact.links_<number>.vtu".
void brunt_picture_name(char out[128], const brunt_picture_part *part, int64_t number);

// Rewrites the collection (aside, then renamed): picture n, at times[n] [s], in all its parts.
int brunt_pvd_write(const char *path, const brunt_picture_parts *parts, const double *times, int64_t count,
                    brunt_error *error);
