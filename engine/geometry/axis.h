// The axis of revolution of axisymmetric scenes.
#pragma once

// What a body of an axisymmetric scene is told that reaches over the axis, whatever it is made of.
#define BRUNT_CUT_AT_AXIS                                                                                              \
    "bodies lie at r >= 0, what is on the axis of revolution is cut there (shape: an intersection with a box from x "  \
    "= 0 on)"
