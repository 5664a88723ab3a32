// The lists of models. A new model is a file of its own and a line here; everything else (keys, checks, tests) follows.
#include "materials/material.h"

#include <math.h>
#include <string.h>

#include "base/simd.h"

#define STRENGTH_MODELS(X)                                                                                             \
    X(brunt_linear_elastic)                                                                                            \
    X(brunt_st_venant_kirchhoff)                                                                                       \
    X(brunt_neo_hookean)                                                                                               \
    X(brunt_von_mises)                                                                                                 \
    X(brunt_johnson_cook)                                                                                              \
    X(brunt_drucker_prager)                                                                                            \
    X(brunt_mohr_coulomb)                                                                                              \
    X(brunt_johnson_holmquist)                                                                                         \
    X(brunt_holmquist_johnson_cook)                                                                                    \
    X(brunt_newtonian)
#define EOS_MODELS(X) X(brunt_mie_gruneisen) X(brunt_polynomial) X(brunt_jwl) X(brunt_ideal_gas) X(brunt_tait)

#define FAILURE_MODELS(X) X(brunt_johnson_cook_damage)

#define DECLARE(model) extern const brunt_model model;
#define ADDRESS(model) &model,
STRENGTH_MODELS(DECLARE)
EOS_MODELS(DECLARE)
FAILURE_MODELS(DECLARE)

const brunt_model *const brunt_strength_models[] = {STRENGTH_MODELS(ADDRESS)};
const int brunt_strength_model_count = (int)(sizeof brunt_strength_models / sizeof *brunt_strength_models);
const brunt_model *const brunt_eos_models[] = {EOS_MODELS(ADDRESS)};
const int brunt_eos_model_count = (int)(sizeof brunt_eos_models / sizeof *brunt_eos_models);

const brunt_model *const brunt_failure_models[] = {FAILURE_MODELS(ADDRESS) NULL};
const int brunt_failure_model_count = (int)(sizeof brunt_failure_models / sizeof *brunt_failure_models) - 1;

static const brunt_model *find(const brunt_model *const *models, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (strcmp(models[i]->name, name) == 0) return models[i];
    return NULL;
}

const brunt_model *brunt_find_strength(const char *name) {
    return find(brunt_strength_models, brunt_strength_model_count, name);
}

const brunt_model *brunt_find_eos(const char *name) {
    // The transliteration of the umlaut that half of the literature uses.
    if (strcmp(name, "mie-grueneisen") == 0) name = "mie-gruneisen";
    return find(brunt_eos_models, brunt_eos_model_count, name);
}

const brunt_model *brunt_find_failure(const char *name) {
    return find(brunt_failure_models, brunt_failure_model_count, name);
}

real brunt_wave_speed(real strength, real eos, real viscosity) {
    real c = (real)sqrt((double)(strength * strength + eos * eos));
    return viscosity > 0 ? viscosity + (real)sqrt((double)(viscosity * viscosity + c * c)) : c;
}
