// The library of materials: sets of keys and values, applied as if a user had typed them.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "brunt.h"
#include "base/error.h"
#include "materials/tensor.h"

enum { VALUE_LIMIT = 40 };

typedef struct preset_value {
    const char *key;
    double value;
    const char *text; // of keys that take a word: "eos", "failure"
} preset_value;

typedef struct preset {
    brunt_preset_info info;
    const char *model;
    preset_value values[VALUE_LIMIT]; // in SI; up to the first without a key
} preset;

// clang-format off
// Johnson-Cook plasticity with its equation of state: elastic constants, A B n C m, melt, reference temperature and heat
// capacity; c0 s gamma0. Its damage: d1 .. d5.
#define ELASTIC(rho, E_, nu_) {"density", rho, NULL}, {"E", E_, NULL}, {"nu", nu_, NULL}
#define FLOW(A_, B_, n_, C_, m_) {"A", A_, NULL}, {"B", B_, NULL}, {"n", n_, NULL}, {"C", C_, NULL}, {"m", m_, NULL}
#define HEAT(melt_, from, c) {"melt", melt_, NULL}, {"reference_temperature", from, NULL}, {"heat_capacity", c, NULL}
#define SHOCK(c0_, s_, gamma0_) {"eos", 0, "mie-gruneisen"}, {"eos.c0", c0_, NULL}, {"eos.s", s_, NULL}, {"eos.gamma0", gamma0_, NULL}
#define DAMAGE(d1_, d2_, d3_, d4_, d5_) {"failure", 0, "johnson-cook-damage"}, {"failure.d1", d1_, NULL}, {"failure.d2", d2_, NULL}, \
    {"failure.d3", d3_, NULL}, {"failure.d4", d4_, NULL}, {"failure.d5", d5_, NULL}
#define JC83 "Johnson and Cook, 7th Int. Symp. on Ballistics (1983), table 1"
#define JC85 "damage: Johnson and Cook, Eng. Fract. Mech. 21 (1985) 31"
#define STEINBERG "Steinberg, UCRL-MA-106439 (1996)"

static const preset presets[] = {
    {{"copper-ofhc", "oxygen-free high-conductivity copper, annealed; with damage",
      JC83 "; shock and density: " STEINBERG "; " JC85},
     "johnson-cook",
     {ELASTIC(8930, 124e9, 0.34), FLOW(90e6, 292e6, 0.31, 0.025, 1.09), HEAT(1356, 298, 383), SHOCK(3940, 1.489, 2.02),
      DAMAGE(0.54, 4.89, -3.03, 0.014, 1.12)}},
    {{"armco-iron", "Armco iron, with damage; the shock law ends at 13 GPa, where iron changes its phase",
      JC83 "; shock: Barker and Hollenbach, J. Appl. Phys. 45 (1974) 4872, gamma0: " STEINBERG "; " JC85},
     "johnson-cook",
     {ELASTIC(7890, 207e9, 0.29), FLOW(175e6, 380e6, 0.32, 0.060, 0.55), HEAT(1811, 298, 452), SHOCK(4630, 1.33, 1.69),
      DAMAGE(-2.20, 5.43, -0.47, 0.016, 0.63)}},
    {{"steel-4340", "4340 steel, quenched and tempered to Rockwell C 30; with damage",
      JC83 "; shock: " STEINBERG "; " JC85},
     "johnson-cook",
     {ELASTIC(7830, 200e9, 0.29), FLOW(792e6, 510e6, 0.26, 0.014, 1.03), HEAT(1793, 298, 477), SHOCK(4578, 1.33, 1.67),
      DAMAGE(0.05, 3.44, -2.12, 0.002, 0.61)}},
    {{"weldox-460e", "structural steel of 460 MPa, with damage (published for power-law rate factors, of which the logarithm is the first order)",
      "Borvik, Hopperstad, Berstad and Langseth, Eur. J. Mech. A 20 (2001) 685, and Int. J. Impact Eng. 27 (2002) 37; c0 and s: as karamelo's examples have them; gamma0 = 3 alpha K / (rho c) with their alpha = 1.1e-5 / K"},
     "johnson-cook",
     {ELASTIC(7850, 200e9, 0.33), FLOW(490e6, 807e6, 0.73, 0.0114, 0.94), {"rate0", 5e-4, NULL}, HEAT(1800, 293, 452),
      SHOCK(5030, 1.5, 1.92), DAMAGE(0.0705, 1.732, -0.54, -0.015, 0)}},
    {{"aluminium-6061-t6", "aluminium 6061-T6, with damage",
      "Lesuer, Kay and LeBlanc, UCRL-JC-134118 (2001); shock: " STEINBERG "; damage: Johnson and Holmquist, LA-11463-MS (1989)"},
     "johnson-cook",
     {ELASTIC(2703, 68.9e9, 0.33), FLOW(324e6, 114e6, 0.42, 0.002, 1.34), HEAT(925, 293, 896), SHOCK(5240, 1.40, 1.97),
      DAMAGE(-0.77, 1.45, -0.47, 0, 1.6)}},
    {{"aluminium-2024-t351", "aluminium 2024-T351, without damage", JC83 "; shock and density: " STEINBERG},
     "johnson-cook",
     {ELASTIC(2785, 73.1e9, 0.33), FLOW(265e6, 426e6, 0.34, 0.015, 1.00), HEAT(775, 298, 875), SHOCK(5328, 1.338, 2.00)}},
    {{"tungsten-alloy", "tungsten with 7 % nickel and 3 % iron, without damage",
      JC83 "; E and nu: makers' data of 90W-7Ni-3Fe; shock: pure tungsten, " STEINBERG},
     "johnson-cook",
     {ELASTIC(17000, 345e9, 0.28), FLOW(1506e6, 177e6, 0.12, 0.016, 1.00), HEAT(1723, 298, 134), SHOCK(4030, 1.237, 1.67)}},
    {{"alumina", "alumina AD-99.5",
      "Anderson, Johnson and Holmquist, 15th Int. Symp. on Ballistics (1995), as Cronin et al., 4th European LS-DYNA Users Conference (2003), have it"},
     "johnson-holmquist-2",
     {{"density", 3700, NULL}, {"G", 90.16e9, NULL}, {"K1", 130.95e9, NULL}, {"A", 0.93, NULL}, {"N", 0.6, NULL}, {"B", 0.31, NULL},
      {"M", 0.6, NULL}, {"C", 0, NULL}, {"T", 0.2e9, NULL}, {"HEL", 2.79e9, NULL}, {"P_HEL", 1.46e9, NULL}, {"D1", 0.005, NULL},
      {"D2", 1.0, NULL}, {"beta", 1, NULL}}},
    {{"concrete-48mpa", "concrete of 48 MPa", "Holmquist, Johnson and Cook, 14th Int. Symp. on Ballistics (1993)"},
     "holmquist-johnson-cook",
     {{"density", 2440, NULL}, {"G", 14.86e9, NULL}, {"fc", 48e6, NULL}, {"A", 0.79, NULL}, {"B", 1.60, NULL}, {"N", 0.61, NULL},
      {"C", 0.007, NULL}, {"SMAX", 7.0, NULL}, {"D1", 0.04, NULL}, {"D2", 1.0, NULL}, {"EFMIN", 0.01, NULL}, {"T", 4e6, NULL},
      {"P_crush", 16e6, NULL}, {"mu_crush", 0.001, NULL}, {"P_lock", 0.80e9, NULL}, {"mu_lock", 0.10, NULL}, {"K1", 85e9, NULL},
      {"K2", -171e9, NULL}, {"K3", 208e9, NULL}}},
    {{"aluminium-rods", "stacked aluminium rods, a granular material in two dimensions, for collapses of columns",
      "Nguyen, Nguyen, Bui, Nguyen and Fukagawa, Landslides 14 (2017) 69, as SPHinXsys's test_2d_column_collapse has it"},
     "mohr-coulomb",
     {ELASTIC(2040, 5.84e6, 0.3), {"cohesion", 0, NULL}, {"friction_angle", 0.38222711, NULL}}},
    {{"lead", "lead as in computations of hypervelocity impact; linear hardening, no heat",
      "Anderson, Trucano and Mullin, Int. J. Impact Eng. 9 (1990) 89, as MPM3D has it (Zhang, Chen and Liu, The Material Point Method (2016))"},
     "von-mises",
     {ELASTIC(11350, 22.4e9, 0.42), {"yield", 12e6, NULL}, {"hardening", 125e6, NULL}, SHOCK(2092, 1.45, 2.0)}},
    {{"water", "water at 20 C, which tears instead of bearing tension",
      "shock: Nagayama et al., J. Appl. Phys. 91 (2002) 476; gamma0 = alpha c^2 / c_p"},
     "newtonian",
     {{"density", 998.2, NULL}, {"dynamic_viscosity", 1.0e-3, NULL}, SHOCK(1450, 1.99, 0.11), {"eos.tension", 0, NULL}}},
    {{"air", "air at 15 C and 101325 Pa", "ICAO Standard Atmosphere, Doc 7488"},
     "newtonian",
     {{"density", 1.225, NULL}, {"dynamic_viscosity", 1.79e-5, NULL}, {"eos", 0, "ideal-gas"}, {"eos.gamma", 1.4, NULL},
      {"eos.initial_energy", 253312.5, NULL}}},
    {{"tnt", "cast TNT; wants a detonation, and bulk viscosity",
      "Dobratz and Crawford, LLNL Explosives Handbook, UCRL-52997 (1985); bulk modulus: rho c0^2 of the unburnt Hugoniot, Gibbs and Popolato, LASL Explosive Property Data (1980)"},
     "newtonian",
     {{"density", 1630, NULL}, {"eos", 0, "jwl"}, {"eos.detonation_speed", 6930, NULL}, {"eos.A", 371.2e9, NULL}, {"eos.B", 3.231e9, NULL},
      {"eos.R1", 4.15, NULL}, {"eos.R2", 0.95, NULL}, {"eos.omega", 0.30, NULL}, {"eos.initial_energy", 7.0e9, NULL},
      {"eos.bulk_modulus", 10.8e9, NULL}}},
};
// clang-format on

int32_t brunt_preset_count(void) { return BRUNT_COUNT(presets); }

brunt_preset_info brunt_preset(int32_t index) { return presets[index].info; }

int brunt_material_preset(const char *name, const char *as, brunt_material_def *def, brunt_error *error) {
    if (!name || !as || !def)
        return brunt_fail(error, BRUNT_BAD_INPUT, "materials: the name of a material of the library is wanted");
    for (size_t k = 0; k < BRUNT_COUNT(presets); k++) {
        const preset *from = &presets[k];
        if (strcmp(from->info.name, name) != 0) continue;
        int status = BRUNT_OK;
        *def = brunt_material_def_default(as, from->model);
        for (int v = 0; v < VALUE_LIMIT && from->values[v].key && !status; v++)
            status = brunt_material_set(def, from->values[v].key, from->values[v].value, from->values[v].text, error);
        return status;
    }
    return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.preset: there is no material '%s' in the library", as,
                      name);
}
