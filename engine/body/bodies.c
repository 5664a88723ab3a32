#include "body/bodies.h"

const char *brunt_bodies_name(const brunt_bodies *bodies, int body) {
    const brunt_body_ref *ref = &bodies->all[body];
    return ref->fem ? ref->fem->name : ref->mpm->name;
}
