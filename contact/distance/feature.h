// Edges and corners, where the nearest facets of a body meet.
//
// A place that is equally near to facets that share an edge or a corner meets that one, and not whichever of them comes
// first: its own nodes bear, along the mean normal of the facets that tie, or along the line to the place where that is
// outside. Of two bodies that are mirror images neither has a side of its own to slide off to.
#pragma once

#include "contact/distance/point_facet.h"

enum { BRUNT_FEATURE_NODES = 32 };

// An edge by its two nodes, a corner by its one twice; or, of a quadrilateral alone, where some of its four triangles
// meet, which are its ridges when it is warped.
typedef struct brunt_feature {
    bool any; // whether there is one
    int32_t end[2];
    int32_t face, triangles; // bits of the triangles; 0: an edge or corner
} brunt_feature;

// Nodes that some faces have in common.
typedef struct brunt_shared {
    int32_t node[4], count;
} brunt_shared;
// Leaves those that `face` has, too; of none before it, all its own. Whether there are any; else `shared` stays.
bool brunt_feature_share(const brunt_contact_surface *surface, int32_t face, brunt_shared *shared);

// Unit mean of the faces' normals at the feature: at a corner each by its angle there, so that it does not depend on
// how a surface is cut into faces.
bool brunt_feature_normal(const brunt_contact_surface *surface, const brunt_feature *feature, const int32_t *face,
                          int count, double n[3]);
// Shares of the ends of an edge or corner in the point of it that is nearest to x.
void brunt_feature_values(const brunt_contact_surface *surface, const brunt_feature *feature, const double x[3],
                          double weight[2]);

// A feature, as it is seen along n from a place x.
typedef struct brunt_feature_position {
    const brunt_feature *feature;
    const double *n, *x; // [-] of length 1; [m]
} brunt_feature_position;

// A feature as master: its nodes and those of the faces about it that are seen along n, with their weights where x is
// and the gradients of those across n; `height` of x above the feature along n. The motion is that of the feature's
// nodes, and turns as its faces do on the mean: exact for every rigid motion. How many nodes.
int brunt_feature_weights(const brunt_contact_surface *surface, const brunt_feature_position *place,
                          int32_t node[BRUNT_FEATURE_NODES], double weight[BRUNT_FEATURE_NODES],
                          double gradient[BRUNT_FEATURE_NODES][3], double *height);
