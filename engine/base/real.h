// Floating-point type of the build, dimensions and tensor layouts used everywhere.
#pragma once

#include <stdint.h>

#ifdef BRUNT_FLOAT
typedef float real;
#define BRUNT_REAL_NAME "float"
#else
typedef double real;
#define BRUNT_REAL_NAME "double"
#endif

// Tensor layouts. The two-dimensional (plane strain) ones are what is left of the three-dimensional ones:
//   vector     x y z                  | x y
//   matrix     row major, 3 by 3      | row major, 2 by 2 (the 33 component is 1 for a deformation gradient, 0 for a
//   rate) symmetric  XX YY ZZ XY YZ XZ      | XX YY ZZ XY                       (the order VTK wants)
#define BRUNT_VECTOR(dim) (dim)
#define BRUNT_MATRIX(dim) ((dim) * (dim))
#define BRUNT_SYMMETRIC(dim) ((dim) == 3 ? 6 : 4)
