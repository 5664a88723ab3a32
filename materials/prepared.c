#include "materials/prepared.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/array.h"
#include "base/error.h"
#include "base/simd.h"

static int prepare(const brunt_material_def *def, brunt_component component, const brunt_model *model,
                   const double *given, bool with_eos, real *constants, brunt_error *error) {
    static const char *const part[] = {"", "viscosity.", "eos.", "failure."};
    _Static_assert(BRUNT_COUNT(part) == BRUNT_COMPONENTS, "a part of the key for each component");
    for (int k = 0; k < model->parameter_count; k++) {
        const brunt_parameter *row = &model->parameters[k];
        double v = given[k];
        bool low = row->min_open ? !(v > row->min) : !(v >= row->min),
             high = row->max_open ? !(v < row->max) : !(v <= row->max);
        if (low || high)
            return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.%s%s: %g %s is outside its range %c%g, %g%c",
                              def->name, part[component], row->key, v, row->unit, row->min_open ? '(' : '[', row->min,
                              row->max, row->max_open ? ')' : ']');
    }
    const char *wrong = model->prepare(given, def->density, with_eos, constants);
    if (wrong) return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s: %s", def->name, wrong);
    return BRUNT_OK;
}

// One step of a new point of a model, of 1 s, with the displacement gradient H; sound or failed. What stress it adds.
static void probe(const brunt_model *model, const real *constants, const double H[9], bool failed, double stress[6]) {
    real F[9][BRUNT_LANES], L[9][BRUNT_LANES], tau[6][BRUNT_LANES] = {{0}}, zero[BRUNT_LANES] = {0},
                                               state[BRUNT_MAX_STATE][BRUNT_LANES];
    brunt_material_points points = {.count = BRUNT_LANES, .dim = 3, .dt = 1, .volume = zero};
    if (failed) points.integrity = points.integrity_before = zero;
    for (int c = 0; c < 9; c++) {
        for (int l = 0; l < BRUNT_LANES; l++) L[c][l] = (real)H[c], F[c][l] = (real)H[c] + (c % 4 == 0);
        points.F[c] = F[c], points.L[c] = L[c];
    }
    for (int c = 0; c < 6; c++) points.stress[c] = tau[c];
    int count = 0;
    for (int s = 0; s < model->state_count; s++)
        for (int c = 0; c < model->state[s].components3; c++, count++) {
            points.state[count] = state[count];
            for (int l = 0; l < BRUNT_LANES; l++)
                state[count][l] = model->state[s].initial ? model->state[s].initial(constants, c) : 0;
        }
    model->update(constants, &points);
    for (int c = 0; c < 6; c++) stress[c] = (double)tau[c][0];
}

static int parameter_index(const brunt_model *model, const char *key) {
    for (int k = 0; model && k < model->parameter_count; k++)
        if (!strcmp(model->parameters[k].key, key)) return k;
    return BRUNT_NONE;
}

// The parameters of a failure model: what is left open is the strength model's parameter of that name, or its own
// default.
static int failure_parameters(const brunt_material_def *def, const brunt_model *strength, const brunt_model *failure,
                              double *values, brunt_error *error) {
    for (int k = 0; k < failure->parameter_count; k++) {
        const brunt_parameter *row = &failure->parameters[k];
        const int shared = parameter_index(strength, row->key);
        values[k] = def->failure_parameters[k];
        if (isnan(values[k])) values[k] = shared >= 0 ? def->strength_parameters[shared] : row->initial;
        if (!strength->thermal && !strcmp(row->unit, "K") && values[k] != row->initial && !isnan(values[k]))
            return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.failure.%s: model '%s' has no temperature",
                              def->name, row->key, strength->name);
    }
    return BRUNT_OK;
}

static int find_failure(const brunt_material_def *def, brunt_material *material, brunt_error *error) {
    const brunt_model *strength = material->model[BRUNT_STRENGTH], *eos = material->model[BRUNT_EOS];
    if (!def->failure[0]) return BRUNT_OK;
    const brunt_model *failure = material->model[BRUNT_FAILURE] = brunt_find_failure(def->failure);
    material->failure_action = def->failure_action;
    if (!failure)
        return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.failure: there is no failure model '%s'", def->name,
                          def->failure);
    if (!strength->plastic)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.failure: '%s' goes by plastic strain, and model '%s' has none", def->name,
                          failure->name, strength->name);
    if (strength->damage)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.failure: model '%s' has damage of its own and takes no failure model",
                          def->name, strength->name);
    if (def->failure_action == BRUNT_FAILURE_SOFTEN && !eos)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.failure.action: soften wants an equation of state, which carries pressure when "
                          "strength and tension are lost",
                          def->name);
    return BRUNT_OK;
}

// Whether the other models do what integrity says is their own business: a step of a failed point shows it.
static int check_softening(const brunt_material *material, brunt_error *error) {
    const brunt_model *strength = material->model[BRUNT_STRENGTH], *eos = material->model[BRUNT_EOS];
    double stress[6];
    if (material->integrity[1] < 0) return BRUNT_OK;
    probe(strength, material->constants[BRUNT_STRENGTH], (const double[9]){0, 0.1}, true, stress);
    if (stress[3] != 0)
        return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.failure: model '%s' does not soften: onset must be 1",
                          material->name, strength->name);
    for (int k = 1; k <= 4 && material->failure_action == BRUNT_FAILURE_SOFTEN; k++) {
        const double h = 0.02 * k;
        probe(eos, material->constants[BRUNT_EOS], (const double[9]){h, 0, 0, 0, h, 0, 0, 0, h}, true, stress);
        if (stress[0] > 0)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "materials.%s.failure.action: soften: equation of state '%s' keeps its tension",
                              material->name, eos->name);
    }
    return BRUNT_OK;
}

// The first of a model's state arrays that belongs to a state, BRUNT_NONE when it has no such.
static int8_t state_place(const brunt_model *model, const char *name, int dim) {
    int place = 0;
    for (int s = 0; model && s < model->state_count; s++) {
        if (!strcmp(model->state[s].name, name)) return (int8_t)place;
        place += dim == 3 ? model->state[s].components3 : model->state[s].components2;
    }
    return BRUNT_NONE;
}

// Of a failure model by its action, of a strength model with damage of its own where a failure strain is given.
static bool erodes(const brunt_material *material, const brunt_material_def *def) {
    const brunt_model *strength = material->model[BRUNT_STRENGTH];
    if (material->model[BRUNT_FAILURE]) return material->failure_action == BRUNT_FAILURE_ERODE;
    const int limit = strength->damage ? parameter_index(strength, "failure_strain") : -1;
    return limit >= 0 && isfinite(def->strength_parameters[limit]);
}

static bool wants_differences(const brunt_material *material) {
    for (int k = 0; k < BRUNT_COMPONENTS; k++)
        if (material->model[k] && brunt_model_no_potential(material->model[k], material->constants[k])) return true;
    return false;
}

int brunt_material_make(const brunt_material_def *def, brunt_material *material, brunt_error *error) {
    *material = (brunt_material){.density = (real)def->density};
    memcpy(material->name, def->name, sizeof material->name);
    if (!(def->density > 0) || !isfinite(def->density))
        return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.density: %g kg/m^3 is not a positive density",
                          def->name, def->density);
    const brunt_model *strength = brunt_find_strength(def->strength);
    if (!strength)
        return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.model: there is no model '%s'", def->name,
                          def->strength);
    const brunt_model *eos = def->eos[0] ? brunt_find_eos(def->eos) : NULL;
    if (def->eos[0] && !eos)
        return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.eos: there is no equation of state '%s'", def->name,
                          def->eos);
    if (eos && !strength->accepts_eos)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.eos: model '%s' brings its own pressure and takes no equation of state",
                          def->name, strength->name);
    material->model[BRUNT_STRENGTH] = strength;
    material->model[BRUNT_EOS] = eos;
    material->model[BRUNT_VISCOSITY] = def->bulk_viscosity ? &brunt_bulk_viscosity : NULL;
    double failure[BRUNT_PARAMETER_LIMIT];
    int status = find_failure(def, material, error);
    if (!status && material->model[BRUNT_FAILURE])
        status = failure_parameters(def, strength, material->model[BRUNT_FAILURE], failure, error);
    if (status) return status;
    const double *given[BRUNT_COMPONENTS] = {def->strength_parameters, def->viscosity_parameters, def->eos_parameters,
                                             failure};
    real speed[BRUNT_COMPONENTS] = {0};
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        const brunt_model *model = material->model[k];
        if (!model) continue;
        status = prepare(def, (brunt_component)k, model, given[k], eos != NULL, material->constants[k], error);
        if (status) return status;
        if (model->wave_speed) speed[k] = model->wave_speed(material->constants[k]);
        // What softens keeps its integrity whatever the parameters are.
        const bool whole = k == BRUNT_FAILURE && def->failure_action == BRUNT_FAILURE_SOFTEN;
        const brunt_model *reduced = model->reduced && !whole ? model->reduced(given[k]) : NULL;
        if (reduced) material->model[k] = reduced;
        if (model->off && model->off(given[k])) material->model[k] = NULL;
    }
    material->erodes = erodes(material, def), material->differences = wants_differences(material);
    for (int dim = 2; dim <= 3; dim++) {
        material->temperature[dim - 2] = state_place(material->model[BRUNT_STRENGTH], "temperature", dim);
        material->integrity[dim - 2] = state_place(material->model[BRUNT_FAILURE], "integrity", dim);
    }
    if (eos) {
        double stress[6];
        probe(eos, material->constants[BRUNT_EOS], (const double[9]){0}, false, stress);
        material->rest_stress = (real)stress[0];
    }
    status = check_softening(material, error);
    if (status) return status;
    material->wave_speed = brunt_wave_speed(speed[BRUNT_STRENGTH], speed[BRUNT_EOS], speed[BRUNT_VISCOSITY]);
    if (!eos && strength->needs_eos)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.eos: model '%s' has no pressure of its own, an equation of state is wanted",
                          def->name, strength->name);
    return BRUNT_OK;
}

void brunt_material_set_temperature(brunt_material *material, double temperature) {
    for (int k = 0; k < BRUNT_COMPONENTS && temperature > 0; k++)
        if (material->model[k] && material->model[k]->set_temperature)
            material->model[k]->set_temperature(material->constants[k], temperature);
}

int brunt_material_make_membrane(const brunt_material_def *def, bool tension_only, brunt_material *material,
                                 brunt_error *error) {
    int status = brunt_material_make(def, material, error);
    if (status) return status;
    const brunt_model *strength = material->model[BRUNT_STRENGTH];
    if (!strength->update_plane_stress) {
        char names[400] = "";
        for (int k = 0; k < brunt_strength_model_count; k++)
            if (brunt_strength_models[k]->update_plane_stress)
                snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", names[0] ? ", " : "",
                         brunt_strength_models[k]->name);
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.model: '%s' has no plane-stress form for membranes: %s have", def->name,
                          strength->name, names);
    }
    if (material->model[BRUNT_EOS] || material->model[BRUNT_VISCOSITY] || material->model[BRUNT_FAILURE])
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s: a membrane takes neither equation of state nor bulk viscosity nor failure",
                          def->name);
    material->membrane = true;
    material->tension_only = tension_only;
    material->wave_speed = strength->wave_speed_plane_stress(material->constants[BRUNT_STRENGTH]);
    return BRUNT_OK;
}

void brunt_material_energy(const brunt_material *material, brunt_component k, const brunt_material_points *points,
                           brunt_point_energy *energy) {
    const brunt_model *model = material->model[k];
    if (!model) return;
    if (material->membrane) {
        brunt_material_points own = *points;
        own.tension_only = material->tension_only;
        model->energy_plane_stress(material->constants[k], &own, energy);
    } else if (material->implicit && !material->differences && model->potential->energy)
        model->potential->energy(material->constants[k], points, energy);
    else if (model->energy)
        model->energy(material->constants[k], points, energy);
}

static void set_defaults(const brunt_model *model, double *values) {
    for (int k = 0; model && k < model->parameter_count; k++) values[k] = model->parameters[k].initial;
}

brunt_material_def brunt_material_def_default(const char *name, const char *model) {
    brunt_material_def def = {.density = NAN};
    snprintf(def.name, sizeof def.name, "%s", name ? name : "");
    snprintf(def.strength, sizeof def.strength, "%s", model ? model : "");
    set_defaults(brunt_find_strength(def.strength), def.strength_parameters);
    for (int k = 0; k < BRUNT_PARAMETER_LIMIT; k++) def.failure_parameters[k] = NAN;
    return def;
}

int brunt_material_set(brunt_material_def *def, const char *key, double value, const char *text, brunt_error *error) {
    if (!def || !key) return brunt_fail(error, BRUNT_BAD_INPUT, "a material and the key of what is set are wanted");
    if (!memchr(def->name, 0, sizeof def->name) || !memchr(def->strength, 0, sizeof def->strength) ||
        !memchr(def->eos, 0, sizeof def->eos) || !memchr(def->failure, 0, sizeof def->failure))
        return brunt_fail(error, BRUNT_BAD_INPUT, "a material has a name without its end");
    const brunt_model *model = brunt_find_strength(def->strength);
    double *values = def->strength_parameters;
    const char *rest = key;
    if (!strcmp(key, "density")) {
        def->density = value;
        return BRUNT_OK;
    }
    if (!strcmp(key, "viscosity")) {
        def->bulk_viscosity = true;
        set_defaults(&brunt_bulk_viscosity, def->viscosity_parameters);
        return BRUNT_OK;
    }
    if (!strcmp(key, "eos")) {
        if (!text || !brunt_find_eos(text))
            return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.eos: there is no equation of state '%s'", def->name,
                              text ? text : "");
        snprintf(def->eos, sizeof def->eos, "%s", text);
        set_defaults(brunt_find_eos(text), def->eos_parameters);
        return BRUNT_OK;
    }
    if (!strcmp(key, "failure")) {
        const brunt_model *failure = text ? brunt_find_failure(text) : NULL;
        if (!failure)
            return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.failure: there is no failure model '%s'", def->name,
                              text ? text : "");
        snprintf(def->failure, sizeof def->failure, "%s", text);
        for (int k = 0; k < BRUNT_PARAMETER_LIMIT; k++) def->failure_parameters[k] = NAN; // not yet given
        return BRUNT_OK;
    }
    if (!strcmp(key, "failure.action")) {
        const bool soften = text && !strcmp(text, "soften");
        if (!soften && (!text || strcmp(text, "erode") != 0))
            return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.failure.action: '%s' is neither erode nor soften",
                              def->name, text ? text : "");
        def->failure_action = soften ? BRUNT_FAILURE_SOFTEN : BRUNT_FAILURE_ERODE;
        return BRUNT_OK;
    }
    if (!strncmp(key, "failure.", 8))
        model = def->failure[0] ? brunt_find_failure(def->failure) : NULL, values = def->failure_parameters,
        rest = key + 8;
    if (!strncmp(key, "eos.", 4)) model = brunt_find_eos(def->eos), values = def->eos_parameters, rest = key + 4;
    if (!strncmp(key, "viscosity.", 10))
        model = def->bulk_viscosity ? &brunt_bulk_viscosity : NULL, values = def->viscosity_parameters, rest = key + 10;
    const int place = parameter_index(model, rest);
    if (place >= 0) {
        values[place] = value;
        return BRUNT_OK;
    }
    return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s: model '%s' has no parameter '%s'", def->name,
                      model ? model->name : "", key);
}

// What failure reads of the strength model, and the others of it.
static void connect_failure(const brunt_material *material, brunt_material_points points[BRUNT_COMPONENTS],
                            real *strain) {
    brunt_material_points *failure = &points[BRUNT_FAILURE];
    const int dim = failure->dim, temperature = material->temperature[dim - 2],
              integrity = material->integrity[dim - 2];
    points[BRUNT_STRENGTH].strain_increment = failure->strain_increment = strain;
    failure->temperature = temperature >= 0 ? points[BRUNT_STRENGTH].state[temperature] : NULL;
    for (int k = 0; k < BRUNT_FAILURE && integrity >= 0; k++) {
        points[k].integrity = failure->state[integrity];
        points[k].integrity_before = failure->state[integrity + 1];
    }
}

brunt_update_result brunt_material_update(const brunt_material *material,
                                          brunt_material_points points[BRUNT_COMPONENTS], real *plastic, real *viscous,
                                          real *strain) {
    const brunt_model *const *model = material->model;
    brunt_update_result total = {.bad = -1};
    const bool dissipates = model[BRUNT_STRENGTH]->plastic || model[BRUNT_STRENGTH]->shear_viscous;
    real speed[BRUNT_COMPONENTS] = {0}, viscosity = 0;
    if (model[BRUNT_FAILURE]) connect_failure(material, points, strain);
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        if (!model[k]) continue;
        points[k].plastic_increment = model[BRUNT_EOS] && dissipates ? plastic : NULL;
        points[k].viscous_pressure = model[BRUNT_EOS] && model[BRUNT_VISCOSITY] ? viscous : NULL;
        points[k].tension_only = material->tension_only;
        brunt_update_result result =
            (material->membrane ? model[k]->update_plane_stress : model[k]->update)(material->constants[k], &points[k]);
        speed[k] = result.wave_speed;
        viscosity += result.viscosity;
        total.failed = total.failed || result.failed;
        if (result.bad >= 0 && total.bad < 0) total.bad = result.bad, total.reason = result.reason;
    }
    total.wave_speed = brunt_wave_speed(speed[BRUNT_STRENGTH], speed[BRUNT_EOS], speed[BRUNT_VISCOSITY] + viscosity);
    return total;
}
