// Planes and the nodes of surfaces of meshes: what brunt_boundary_kind asks of planes (planes/boundary.h).
#pragma once

#include "contact/planes/boundary.h"

// Distance of a place in front of a plane [m], at a time [s].
double brunt_plane_distance(const brunt_plane_def *plane, double time, const double x[3]);
bool brunt_plane_near_surface(const brunt_contact_surface *s, int k, const brunt_boundary *boundary, double time,
                              double range);
// Adds the constraints of a plane that pushes, and applies one that holds.
int brunt_plane_meet_surface(const brunt_contact_context *m, brunt_boundary *boundary, brunt_node_to_facet *f,
                             brunt_constraint_set *set, brunt_error *error);
