// The distance of two features (points, edges, triangles), and its derivatives by the places of their vertices.
//
// A distance is the least length of r = sum w_i x_i over the one or two free coordinates on the features ("free");
// places of both are counted together, the first feature's before the other's, with weights w of both signs. So all
// kinds share one gradient, w_i n, and one Hessian (envelope theorem). Lengths in m, places relative to any origin:
// near the features, so that digits are not lost.
#pragma once

#include <stdbool.h>

enum { BRUNT_CLOSEST_PLACES = 5, BRUNT_CUBIC_PLACES = 4 };

typedef struct brunt_closest {
    int places;        // 2 points, 3 point and edge, 4 point and triangle, or two edges, up to 5 point and curve
    bool flat, curved; // n does not turn: planes; a curve, whose r has the second derivative tangent[1]
    int free;          // coordinates on the features that d is least over: 0, 1, 2
    double d, n[3];    // distance, of curves with a sign; unit vector from the other feature to the first
    double w[BRUNT_CLOSEST_PLACES];    // of places, sum 0: r = sum w x = d n
    double g[2][BRUNT_CLOSEST_PLACES]; // derivatives of w by the free coordinates
    double tangent[2][3];              // derivatives of r by them [m]: along the features
} brunt_closest;

// A curve in the plane, over s from 0 to 1: y(s) = sum of w_i(s) x_i, w_i(s) = sum of weight[i][k] s^k. Its first two
// places are its ends.
typedef struct brunt_cubic {
    int places;
    double weight[BRUNT_CUBIC_PLACES][4];
} brunt_cubic;

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

// The weights of a curve's places at s.
void brunt_cubic_weights(const brunt_cubic *curve, double s, double weight[BRUNT_CUBIC_PLACES]);
// The part of a curve that a point is nearest to: bits of its ends, as of an edge, and where; the distance.
int brunt_closest_of_cubic(const double q[3], const double (*x)[3], const brunt_cubic *curve, double *s, double *d);
// [m] What a curve, whose first two places are its ends, leaves its chord by at most.
double brunt_cubic_bend(const double (*x)[3], const brunt_cubic *curve);
// The distance of a point to a curve at its nearest place s, places the point's, then the curve's: above 0 to the right
// of the way along the curve, or (`side` -1) to the left. The Hessian has the curve's own bend.
void brunt_closest_cubic(const double q[3], const double (*x)[3], const brunt_cubic *curve, double s, int side,
                         brunt_closest *c);

// Adds to h what `brunt_closest_hessian` says of a curve.
void brunt_cubic_hessian(const brunt_closest *c, double outer, double inner, double *h);

// Two edges: places a0, a1, b0, b1, and the region: bits of a's ends, and those of b's times 4. Weights are 0 at ends
// that do not bear.
int brunt_closest_edges(const double a[2][3], const double b[2][3], brunt_closest *c);

// Adds `outer` (n w)(n w)^T + `inner` times the Hessian of d to h, of places * dim rows: h[(i * dim + k) * places * dim
// + j * dim + l].
void brunt_closest_hessian(const brunt_closest *c, int dim, double outer, double inner, double *h);

// |ea x eb|^2, its gradient by ea and eb, and its second derivatives, row major 6 x 6.
double brunt_edge_cross(const double ea[3], const double eb[3], double gradient[6], double hessian[36]);
