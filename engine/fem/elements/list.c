// The elements there are, in the order of brunt_element_kind.
#include "fem/element.h"

#define ELEMENTS(X) X(tet4) X(hex8) X(tri3) X(quad4) X(membrane_quad4) X(membrane_tri3)

#define DECLARE(element) extern const brunt_element brunt_##element;
ELEMENTS(DECLARE)

#define ADDRESS(element) &brunt_##element,
const brunt_element *const brunt_elements[BRUNT_ELEMENT_KINDS] = {ELEMENTS(ADDRESS)};

#define AXISYMMETRIC(X) X(BRUNT_TRI3, axisymmetric_tri3) X(BRUNT_QUAD4, axisymmetric_quad4)

#define DECLARE_KIND(kind, element) DECLARE(element)
AXISYMMETRIC(DECLARE_KIND)

#define BY_KIND(kind, element) [kind] = &brunt_##element,
const brunt_element *const brunt_axisymmetric_elements[BRUNT_ELEMENT_KINDS] = {AXISYMMETRIC(BY_KIND)};
