#include "io/scene/crowd.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"

static const double PI = 3.14159265358979323846;

double brunt_crowd_draw(const brunt_crowd *crowd, int64_t index, brunt_drawn what, uint64_t k) {
    uint64_t bits = brunt_hash_add(brunt_hash_add(0, crowd->seed), (uint64_t)index);
    bits = brunt_hash_add(brunt_hash_add(bits, (uint64_t)what), k);
    return (double)(bits >> 11) * 0x1p-53;
}

// ---------------------------------------------------------------------------------------------------- places

// Of two rows, the second of which has one less.
static int64_t two_rows(const brunt_crowd *crowd) { return 2 * (int64_t)crowd->count[0] - 1; }

int64_t brunt_crowd_size(const brunt_crowd *crowd) {
    double size = 1;
    for (int a = 0; a < crowd->dimension; a++) size *= crowd->count[a];
    if (crowd->lattice == BRUNT_LATTICE_HEX) size -= crowd->count[1] / 2;
    return size > BRUNT_CROWD_LIMIT ? BRUNT_CROWD_LIMIT + 1 : (int64_t)size;
}

double brunt_crowd_pitch(const brunt_crowd *crowd) { return 2 * crowd->radius * (1 + crowd->spread) + crowd->gap; }

double brunt_crowd_radius(const brunt_crowd *crowd, int64_t index) {
    if (crowd->spread == 0) return crowd->radius;
    return crowd->radius * (1 + crowd->spread * (2 * brunt_crowd_draw(crowd, index, BRUNT_DRAWN_RADIUS, 0) - 1));
}

void brunt_crowd_centre(const brunt_crowd *crowd, int64_t index, double x[3]) {
    const double pitch = brunt_crowd_pitch(crowd);
    x[0] = x[1] = x[2] = 0;
    if (crowd->lattice == BRUNT_LATTICE_HEX) {
        const int64_t pair = index / two_rows(crowd), in = index % two_rows(crowd), odd = in >= crowd->count[0];
        x[0] = pitch * (odd ? 1 + (double)(in - crowd->count[0]) : 0.5 + (double)in);
        x[1] = pitch * (0.5 + sqrt(0.75) * (double)(2 * pair + odd));
        return;
    }
    const double room = crowd->lattice == BRUNT_LATTICE_RANDOM ? pitch - 2 * brunt_crowd_radius(crowd, index) : 0;
    int64_t left = index;
    for (int a = 0; a < crowd->dimension; a++) {
        const double shift = room > 0 ? brunt_crowd_draw(crowd, index, BRUNT_DRAWN_PLACE, (uint64_t)a) - 0.5 : 0;
        x[a] = pitch * (0.5 + (double)(left % crowd->count[a])) + room * shift;
        left /= crowd->count[a];
    }
}

// ---------------------------------------------------------------------------------------------------- properties

// From an even draw, or from one of the bell itself where that is narrow beside the range: either way a fair part of
// them is taken, as long as the mean is in the range.
double brunt_crowd_young(const brunt_crowd *crowd, int64_t index) {
    const double width = crowd->high - crowd->low;
    const bool narrow = crowd->sd > 0 && crowd->sd * sqrt(2 * PI) < width;
    double young = crowd->low;
    for (uint64_t k = 0;; k += 2) {
        const double u = brunt_crowd_draw(crowd, index, BRUNT_DRAWN_YOUNG, k),
                     v = brunt_crowd_draw(crowd, index, BRUNT_DRAWN_YOUNG, k + 1);
        if (narrow) {
            young = crowd->mean + crowd->sd * sqrt(-2 * log(1 - u)) * cos(2 * PI * v);
            if (young >= crowd->low && young <= crowd->high) return young;
            continue;
        }
        young = crowd->low + width * u;
        const double off = crowd->sd > 0 ? (young - crowd->mean) / crowd->sd : 0;
        if (v < exp(-0.5 * off * off)) return young;
    }
}

int brunt_crowd_of(const char *body) {
    const char *dot = strchr(body, '.');
    return dot ? (int)(dot - body) : 0;
}
