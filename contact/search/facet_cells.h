// Facets by cell, and what the cells were made for. Private to the search.
#pragma once

#include "contact/search/broad_phase.h"

// Of how far some nodes have moved [m]; low above high: of none.
typedef struct motion_bounds {
    double low[3], high[3];
} motion_bounds;

// A facet that is listed, and the cells along each axis that it is listed in.
typedef struct listed_facet {
    int32_t face, from[3], to[3];
} listed_facet;

// The facets of a run of those of one body that are listed: listed[first .. first + count), and their edges.
typedef struct facet_run {
    int32_t first, count, edge_count, first_edge;
    int32_t from, to; // rows of cells that any of them is in
} facet_run;

typedef struct facet_cells {
    bool made;
    double range; // [m] what they were made with: how far bodies looked ...
    int32_t pair_count;
    uint64_t pairs_key; // ... and which were near
    double (*x)[3];     // nodes of the surface then ...
    body_box *box;      // ... and boxes, bodies with facets first
    uint8_t *near; // of each node: it is of a facet that is listed, or has no facet; the others have some way to go
    motion_bounds (*moved)[2]; // of each chunk of nodes: of those that are near, and of the others
    double shift[3];        // [m] how far those that are near have moved together since: so far cells have moved, too
    double origin[3], cell; // [m]
    int32_t n[3];
    int32_t *first, *face; // facets of cell c: face[first[c] .. first[c + 1])
    listed_facet *listed;  // while the cells are made: of all runs, each with room for all facets of it
    facet_run *run;
    size_t listed_capacity, run_capacity, first_capacity, face_capacity, x_capacity, box_capacity, moved_capacity,
        near_capacity;
} facet_cells;

// Aborts where cells that are made list facets that there are not.
void brunt_facet_cells_validate(const facet_cells *cells, int32_t faces);
