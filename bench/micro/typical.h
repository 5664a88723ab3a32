// What the benchmarks of kernels have in common: parameters of a model, and how results are written.
#pragma once

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "brunt.h"
#include "materials/material.h"
#include "base/memory.h"
#include "rows.h"

static const double typical_density = 8960;

// Of a model that is not one of metals, those of the library; else of OFHC copper: Johnson and Cook (1983), shock data
// as commonly tabulated, in C1 .. C4 as Mie and Gruneisen's to third order; Drucker and Prager's with a cohesion of its
// strength. What is not here has its table's default. Returns the density [kg/m^3].
static inline double typical_parameters(const brunt_model *model, double *out) {
    static const char *const library[][2] = {
        {"johnson-holmquist-2", "alumina"}, {"holmquist-johnson-cook", "concrete-48mpa"}, {"jwl", "tnt"}};
    static const struct {
        const char *key;
        double value;
    } copper[] = {
        {"E", 124e9},
        {"nu", 0.34},
        {"yield", 90e6},
        {"hardening", 292e6},
        {"A", 90e6},
        {"B", 292e6},
        {"n", 0.31},
        {"C", 0.025},
        {"m", 1.09},
        {"melt", 1356},
        {"c0", 3940},
        {"s", 1.49},
        {"gamma0", 1.96},
        {"heat_capacity", 383},
        {"dynamic_viscosity", 1e-3},
        {"initial_energy", 1e9},
        {"C1", 139e9},
        {"C2", 275e9},
        {"C3", 218e9},
        {"C4", 1.96},
        {"cohesion", 90e6},
        {"friction_angle", 0.5},
        {"dilatancy_angle", 0.2},
    };
    for (size_t k = 0; k < sizeof library / sizeof *library; k++) {
        brunt_material_def def;
        brunt_error error = {0};
        if (strcmp(library[k][0], model->name) != 0) continue;
        if (brunt_material_preset(library[k][1], "material", &def, &error) != BRUNT_OK) {
            fprintf(stderr, "%s\n", error.message);
            exit(70);
        }
        const bool strength = strcmp(def.strength, model->name) == 0;
        memcpy(out, strength ? def.strength_parameters : def.eos_parameters,
               (size_t)model->parameter_count * sizeof *out);
        return def.density;
    }
    for (int i = 0; i < model->parameter_count; i++) {
        out[i] = model->parameters[i].initial;
        for (size_t k = 0; k < sizeof copper / sizeof *copper; k++)
            if (strcmp(copper[k].key, model->parameters[i].key) == 0) out[i] = copper[k].value;
    }
    return typical_density;
}
