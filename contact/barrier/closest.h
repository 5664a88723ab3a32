// The distance of two features (points, edges, triangles), and its derivatives by the places of their vertices.
//
// A distance is the least length of r = sum w_i x_i over the one or two free coordinates on the features ("free");
// places of both are counted together, the first feature's before the other's, with weights w of both signs. So all
// kinds share one gradient, w_i n, and one Hessian (envelope theorem). Lengths in m, places relative to any origin:
// near the features, so that digits are not lost.
#pragma once

#include <stdbool.h>

enum { BRUNT_CLOSEST_PLACES = 4 };

typedef struct brunt_closest {
    int places;           // 2 points, 3 point and edge, 4 point and triangle, or two edges
    bool flat;            // n does not turn: planes
    int free;             // coordinates on the features that d is least over: 0, 1, 2
    double d, n[3];       // distance; unit vector from the other feature to the first
    double w[4];          // of places, sum 0: r = sum w x = d n
    double g[2][4];       // derivatives of w by the free coordinates
    double tangent[2][3]; // derivatives of r by them [m]: along the features
} brunt_closest;

// Which of the vertices a point is nearest to the hull of: a bit each.
enum { BRUNT_AT_A = 1, BRUNT_AT_B = 2, BRUNT_AT_C = 4 };

// Distance of two points that differ; of a point and the line of an edge; of a point and the plane of a triangle: where
// the region is known to be that.
void brunt_closest_points(const double q[3], const double a[3], brunt_closest *c);
void brunt_closest_line(const double q[3], const double a[3], const double b[3], brunt_closest *c);
void brunt_closest_plane(const double q[3], const double p[3][3], brunt_closest *c);

// Region of an edge, and of a triangle, that a point is nearest to, and the distance. Right above the border of two
// regions, but for rounding, it is what they share: the same for all that share it, when vertices are given in the same
// order.
int brunt_closest_of_edge(const double q[3], const double a[3], const double b[3], double *d);
int brunt_closest_of_triangle(const double q[3], const double p[3][3], double *d);

// Two edges: places a0, a1, b0, b1, and the region: bits of a's ends, and those of b's times 4. Weights are 0 at ends
// that do not bear.
int brunt_closest_edges(const double a[2][3], const double b[2][3], brunt_closest *c);

// Adds `outer` (n w)(n w)^T + `inner` times the Hessian of d to h, of places * dim rows: h[(i * dim + k) * places * dim
// + j * dim + l].
void brunt_closest_hessian(const brunt_closest *c, int dim, double outer, double inner, double *h);

// |ea x eb|^2, its gradient by ea and eb, and its second derivatives, row major 6 x 6.
double brunt_edge_cross(const double ea[3], const double eb[3], double gradient[6], double hessian[36]);
