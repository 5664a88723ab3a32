// What the functions of an element's kernel are called: ELEMENT, which the element defines before it includes its
// kernel, and what they do, so that a profile tells them apart.
#pragma once

#define PASTE(a, b) a##_##b
#define NAMED(a, b) PASTE(a, b)
#define MODES_OF NAMED(ELEMENT, modes)
#define NODAL NAMED(ELEMENT, nodal)
#define GRADIENT NAMED(ELEMENT, gradient)
#define SECTION_OF NAMED(ELEMENT, section)
#define STAGE NAMED(ELEMENT, stage)
#define GATHER NAMED(ELEMENT, gather)
#define HOURGLASS NAMED(ELEMENT, hourglass)
#define KINEMATICS NAMED(ELEMENT, kinematics)
#define FREQUENCY NAMED(ELEMENT, frequency)
#define INTERNAL NAMED(ELEMENT, internal)
#define BLOCK NAMED(ELEMENT, block)
#define KEEPING NAMED(ELEMENT, keeping)
#define FORCES NAMED(ELEMENT, forces)
#define MEAN_GRADIENT NAMED(ELEMENT, mean_gradient)
