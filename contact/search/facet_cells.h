// Facets by cell, and what the cells were made for. Private to the search.
#pragma once

#include "contact/search/broad_phase.h"

typedef struct facet_cells {
    bool made;
    double range; // [m] what they were made with: how far bodies looked ...
    int32_t pair_count;
    uint64_t pairs_key;     // ... and which were near
    double (*x)[3];         // nodes of the surface then ...
    body_box *box;          // ... and boxes, bodies with facets first
    bool *further;          // of each chunk of nodes: some have moved further than the cells allow
    double origin[3], cell; // [m]
    int32_t n[3];
    int32_t *first, *face; // facets of cell c: face[first[c] .. first[c + 1])
    size_t first_capacity, face_capacity, x_capacity, box_capacity, further_capacity;
} facet_cells;

// Aborts where cells that are made list facets that there are not.
void brunt_facet_cells_validate(const facet_cells *cells, int32_t faces);
