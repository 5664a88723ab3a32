// What the files of the contact surface share. Private to them.
#pragma once

#include "contact/surface/contact_surface.h"

enum { BRUNT_SURFACE_PIECE = 1024 };

// --- contact_surface.c
// Room for so many nodes and faces, with what is there kept: exactly that at the start, later half as much again, so
// that surfaces that grow seldom ask for it. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_reserve(brunt_contact_surface *s, int32_t node_count, int32_t face_count, brunt_error *error);
// Owners of nodes and faces, and what follows from the lists of them. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_surface_relate(brunt_contact_surface *s, brunt_error *error);

// --- surface_faces.c
// Faces of the active bodies, and which of their nodes are near something, by the places of all of them.
void brunt_surface_make_faces(brunt_contact_surface *s, int threads, brunt_timer *timer);

// --- surface_ways.c
struct brunt_surface_way brunt_surface_no_way(void);
int32_t brunt_surface_chunks(const brunt_contact_surface *s); // how many there may be
// How far the nodes of each group have moved against what is near them, from what chunks of nodes have.
void brunt_surface_compare_ways(brunt_contact_surface *s, int threads, brunt_timer *timer);

// --- membrane_sides.c
// The other side of a membrane: `nodes` nodes and `faces` faces once more, behind them, facing the other way.
void brunt_membrane_add_back(int32_t *node, int32_t nodes, int32_t (*face)[4], int32_t faces);
// What membranes need besides, when there are any. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_membrane_sides_make(brunt_contact_surface *s, brunt_error *error);
// Elements within two rings of the nodes of membranes that touch themselves. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_membrane_patches_make(brunt_contact_surface *s, brunt_error *error);
