// The nearest point of a facet.
#pragma once

#include "contact/surface/contact_surface.h"

typedef struct brunt_closest {
    double d[3];      // [m] from the nearest point to the place asked for; mean, where several are as near
    double square;    // [m^2] of the distance
    double normal[3]; // outward unit normal of the facet there, mean where triangles meet
    bool inside;      // the nearest point is no edge and no corner of the facet
    int triangle;     // of a quadrilateral: which of its four triangles about the centre; else 0 ...
    int triangles;    // ... and bits of all that have the nearest point, when there are several; else 0
} brunt_closest;

// What is as near as this share of a facet's width is equally near.
#define BRUNT_TIE 1e-6

brunt_closest brunt_closest_on_face(const brunt_contact_surface *surface, int32_t face, const double x[3]);
// The same; of a facet whose square of the distance is more than `beyond` [m^2] that square alone is told.
brunt_closest brunt_closest_on_face_within(const brunt_contact_surface *surface, int32_t face, const double x[3],
                                           double beyond);
// Weights of the facet's nodes where x projects onto its plane, alone.
void brunt_face_values(const brunt_contact_surface *surface, int32_t face, int triangle, const double x[3],
                       double weight[4]);
// A facet, of a quadrilateral the triangle found, and a place x [m] that is projected onto its plane.
typedef struct brunt_facet_position {
    int32_t face;
    int triangle;
    const double *x;
} brunt_facet_position;
// Weights of the facet's nodes where x projects onto its plane (they may be outside 0..1), their gradients along the
// plane [1/m], its unit normal, and the distance of x from it [m].
void brunt_face_weights(const brunt_contact_surface *surface, const brunt_facet_position *place, double weight[4],
                        double gradient[4][3], double normal[3], double *height);
