// What the forms of augury keep between steps: room, and nothing else.
#pragma once

#include "contact/methods/augury.h"
#include "contact/methods/augury_grid.h"
#include "contact/methods/augury_near.h"

typedef struct brunt_averaged_work brunt_averaged_work;   // surface and smooth (averaged_surface.c)
typedef struct brunt_published_work brunt_published_work; // paper (published.c)

struct brunt_augury_workspace {
    brunt_augury_near near;
    brunt_augury_grid grid;
    brunt_augury_cloud cloud[4]; // surface: nodes of a, of b, faces of a, of b; paper: all nodes
    brunt_averaged_work *averaged;
    brunt_published_work *published;
};

// The workspace, made when there is none. NULL: out of memory.
brunt_augury_workspace *brunt_augury_work(brunt_augury_workspace **work, brunt_error *error);
void brunt_averaged_work_free(brunt_averaged_work *averaged);
void brunt_published_work_free(brunt_published_work *published);
