// The nodes' part of a step: velocities from forces, places from velocities, and what the accounts need of both.
#include <math.h>

#include "fem/fem_body.h"
#include "base/simd.h"
#include "fem/record.h"

// Running sums of one kind, in double whatever the reals are: a float build would lose the digits of large bodies.
typedef double double4 __attribute__((vector_size(4 * sizeof(double))));

BRUNT_INLINE double4 widen(real4 a) { return __builtin_convertvector(a, double4); }

// a x b; the fourth component is left over.
BRUNT_INLINE double4 cross4(double4 a, double4 b) {
    double4 a1 = __builtin_shufflevector(a, a, 1, 2, 0, 3), b1 = __builtin_shufflevector(b, b, 1, 2, 0, 3);
    double4 c = a * b1 - a1 * b;
    return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

static void store3(double out[3], double4 a) {
    for (int i = 0; i < 3; i++) out[i] = a[i];
}

static double sum3(double4 a) { return a[0] + a[1] + a[2]; }

void brunt_fem_kick(brunt_fem_body *body, int32_t begin, int32_t end, double dt, const double gravity[3],
                    brunt_fem_sums *sums) {
    *sums = (brunt_fem_sums){0};
    const real4 g = {(real)(dt * gravity[0]), (real)(dt * gravity[1]), (real)(dt * gravity[2]), 0};
    double4 momentum = {0};
    for (int32_t n = begin; n < end; n++) {
        real *node = brunt_fem_node(body, n);
        real4 v = real4_load(node + BRUNT_FEM_V), force = {0};
        for (int32_t k = body->partial_first[n]; k < body->partial_first[n + 1]; k++)
            force += real4_load(body->partial + (size_t)body->partial_of[k] * 4);
        if (body->load) force += real4_load(body->load + (size_t)n * 4);
        const real mass = node[BRUNT_FEM_MASS];
        momentum += (double)mass * widen(v);
        real4_store(node + BRUNT_FEM_V, v + force * ((real)dt / mass) + g);
    }
    store3(sums->momentum_old, momentum);
}

BRUNT_INLINE void drift(brunt_fem_body *body, int32_t begin, int32_t end, double dt, bool moves, brunt_fem_sums *sums) {
    double4 first = {0}, momentum = {0}, kinetic = {0}, angular = {0};
    double mass_sum = 0, linear = 0, turning = 0, fastest = 0;
    for (int32_t n = begin; n < end; n++) {
        real *node = brunt_fem_node(body, n);
        real4 x = real4_load(node), v = real4_load(node + BRUNT_FEM_V);
        const real mass = x[3];
        x[3] = 0, v[3] = 0;
        const double m = (double)mass;
        double4 wide_v = widen(v), mv = m * wide_v;
        first += m * widen(x);
        x += (real)dt * v;
        double4 wide_x = widen(x), square = wide_v * wide_v, distance = wide_x * wide_x;
        mass_sum += m;
        momentum += mv;
        kinetic += m * square;
        angular += cross4(wide_x, mv);
        double v2 = sum3(square), x2 = sum3(distance);
        linear += m * sqrt(v2);
        turning += m * sqrt(v2 * x2);
        if (v2 > fastest) fastest = v2;
        x[3] = mass;
        if (moves) real4_store(node, x);
    }
    sums->mass = mass_sum;
    store3(sums->first_moment, first);
    store3(sums->momentum, momentum);
    sums->kinetic = 0.5 * sum3(kinetic);
    store3(sums->angular, angular);
    sums->scale_linear = linear;
    sums->scale_angular = turning;
    sums->speed = sqrt(fastest);
}

void brunt_fem_drift(brunt_fem_body *body, int32_t begin, int32_t end, double dt, brunt_fem_sums *sums) {
    drift(body, begin, end, dt, true, sums);
}

brunt_fem_sums brunt_fem_audit(brunt_fem_body *body, int32_t begin, int32_t end) {
    brunt_fem_sums sums = {0};
    drift(body, begin, end, 0, false, &sums);
    return sums;
}
