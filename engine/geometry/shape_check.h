// Shapes and places of a definition, as in base/check.h.
#pragma once

#include "brunt/error.h"
#include "brunt/shape.h"

// `depth`: of shapes of shapes that it is part of, 0 at first.
int brunt_check_shape(const char *owner, const brunt_shape *shape, int dim, int depth, brunt_error *error);
int brunt_check_placement(const char *owner, const brunt_placement *place, brunt_error *error);
