// Numbers of a body's definition, a row each.
#include "world/definitions.h"

#define AT(member) offsetof(brunt_body_def, member), sizeof(((brunt_body_def *)0)->member) / sizeof(double)

#define METHOD(name) (1u << BRUNT_##name)
#pragma GCC diagnostic ignored "-Wmissing-field-initializers" // most rows leave out the last columns

// clang-format off
const brunt_body_number brunt_body_numbers[] = {
    {".size",                  AT(size),                  BRUNT_ANY_NUMBER, true, NULL},
    {".hourglass_coefficient", AT(hourglass_coefficient), BRUNT_NOT_NEGATIVE | BRUNT_OR_NAN, false, NULL},
    {".erosion.strain",        AT(erosion.strain),        BRUNT_POSITIVE | BRUNT_OR_INFINITE, false, NULL},
    {".erosion.step",          AT(erosion.step),          BRUNT_NOT_NEGATIVE, true, NULL},
    {".mass_scaling",          AT(mass_scaling),          BRUNT_NOT_NEGATIVE, true, ": implicit steps need none"},
    {".damping",               AT(damping),               BRUNT_NOT_NEGATIVE, false, NULL, "1/s", "0", METHOD(FEM) | METHOD(MEMBRANE), "fem, membrane: a force of - damping m v on every node; exact in explicit steps, whatever the step, of the order of time.integrator in implicit ones"},
    {".thickness",             AT(thickness),             BRUNT_ANY_NUMBER, false, NULL},
    {".contact_thickness",     AT(contact_thickness),     BRUNT_NOT_NEGATIVE | BRUNT_OR_NAN, false, NULL},
    {".spacing",               AT(spacing),               BRUNT_NOT_NEGATIVE, true, NULL},
    {".jitter",                AT(jitter),                BRUNT_NOT_NEGATIVE, false, NULL},
    {".velocity",              AT(velocity),              BRUNT_ANY_NUMBER, false, NULL},
    {".spin",                  AT(spin),                  BRUNT_ANY_NUMBER, false, NULL},
    {".spin_about",            AT(spin_about),            BRUNT_ANY_NUMBER, false, NULL},
    {".wave_velocity",         AT(wave_velocity),         BRUNT_ANY_NUMBER, false, NULL},
    {".wave_vector",           AT(wave_vector),           BRUNT_ANY_NUMBER, false, NULL},
    {".wave_phase",            AT(wave_phase),            BRUNT_ANY_NUMBER, false, NULL},
    {".temperature",           AT(temperature),           BRUNT_NOT_NEGATIVE, false, NULL},
};
// clang-format on
const int brunt_body_number_count = sizeof brunt_body_numbers / sizeof *brunt_body_numbers;

void brunt_body_coarsen(brunt_body_def *body, double factor) {
    for (int k = 0; k < brunt_body_number_count; k++)
        for (int c = 0; brunt_body_numbers[k].length && c < brunt_body_numbers[k].count; c++)
            ((double *)((char *)body + brunt_body_numbers[k].offset))[c] *= factor;
}
