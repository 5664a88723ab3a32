// The elements there are, by their kind; and those about an axis, by the kind that a section is of.
#include "base/array.h"
#include "fem/element.h"

#define ELEMENTS(X)                                                                                                    \
    X(BRUNT_TET4, tet4)                                                                                                \
    X(BRUNT_HEX8, hex8)                                                                                                \
    X(BRUNT_TRI3, tri3)                                                                                                \
    X(BRUNT_QUAD4, quad4)                                                                                              \
    X(BRUNT_MEMBRANE_QUAD4, membrane_quad4)                                                                            \
    X(BRUNT_MEMBRANE_TRI3, membrane_tri3)

#define AXISYMMETRIC(X)                                                                                                \
    X(BRUNT_TRI3, axisymmetric_tri3)                                                                                   \
    X(BRUNT_QUAD4, axisymmetric_quad4)

#define DECLARE(kind, element) extern const brunt_element brunt_##element;
ELEMENTS(DECLARE)
AXISYMMETRIC(DECLARE)

#define BY_KIND(kind, element) [kind] = &brunt_##element,
const brunt_element *const brunt_elements[BRUNT_ELEMENT_KINDS] = {ELEMENTS(BY_KIND)};
#define AND_ONE(kind, element) +1
_Static_assert(0 ELEMENTS(AND_ONE) == BRUNT_ELEMENT_KINDS, "a row of brunt_elements for each kind");
const brunt_element *const brunt_axisymmetric_elements[BRUNT_ELEMENT_KINDS] = {
    AXISYMMETRIC(BY_KIND)}; // NULL: not about an axis
_Static_assert(BRUNT_COUNT(brunt_axisymmetric_elements) == BRUNT_COUNT(brunt_elements), "both by kind");
