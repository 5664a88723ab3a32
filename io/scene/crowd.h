// Crowds: many disks or balls by one definition. Where each is and what it is of follows from its number and the seed
// alone, by a hash of both: no order and no number of threads makes a difference.
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef enum brunt_lattice { BRUNT_LATTICE_SQUARE, BRUNT_LATTICE_HEX, BRUNT_LATTICE_RANDOM } brunt_lattice;

enum { BRUNT_CROWD_LIMIT = 1000000 }; // members

// What is drawn, each from numbers of its own.
typedef enum brunt_drawn { BRUNT_DRAWN_RADIUS, BRUNT_DRAWN_YOUNG, BRUNT_DRAWN_PLACE } brunt_drawn;

typedef struct brunt_crowd {
    int dimension;
    brunt_lattice lattice;
    int32_t count[3]; // along x, y, z; hex (2D): each second row has one less
    double radius;    // [m]
    double spread;    // [-] radii are even between radius (1 - spread) and radius (1 + spread)
    double gap;       // [m] between the largest that stand side by side
    uint64_t seed;
    bool draws_young; // [Pa] Young's modulus, between low and high: ...
    double mean, sd;  // ... normal, what is outside drawn anew; sd 0: even
    double low, high;
} brunt_crowd;

// Members, at most BRUNT_CROWD_LIMIT + 1.
int64_t brunt_crowd_size(const brunt_crowd *crowd);
// [m] between neighbours.
double brunt_crowd_pitch(const brunt_crowd *crowd);
// Of member `index`, from 0: its radius [m], its centre [m] (the box about the lattice begins at 0), its modulus [Pa].
double brunt_crowd_radius(const brunt_crowd *crowd, int64_t index);
void brunt_crowd_centre(const brunt_crowd *crowd, int64_t index, double x[3]);
double brunt_crowd_young(const brunt_crowd *crowd, int64_t index);
// Even in [0, 1): number `k` of what is drawn for a member.
double brunt_crowd_draw(const brunt_crowd *crowd, int64_t index, brunt_drawn what, uint64_t k);

// Bodies of crowds are called "grains.17", from 1 on: the length of the crowd's name, 0: it is no member.
int brunt_crowd_of(const char *body);
