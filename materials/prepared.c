#include "prepared.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "error.h"
#include "lanes.h"

static int prepare(const brunt_material_def *def, const brunt_model *model, const double *given, bool with_eos,
                   real *constants, brunt_error *error) {
    for (int k = 0; k < model->parameter_count; k++) {
        const brunt_parameter *row = &model->parameters[k];
        double v = given[k];
        bool low = row->min_open ? !(v > row->min) : !(v >= row->min),
             high = row->max_open ? !(v < row->max) : !(v <= row->max);
        if (low || high)
            return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s.%s: %g %s is outside its range %c%g, %g%c",
                              def->name, row->key, v, row->unit, row->min_open ? '(' : '[', row->min, row->max,
                              row->max_open ? ')' : ']');
    }
    const char *wrong = model->prepare(given, def->density, with_eos, constants);
    if (wrong) return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s: %s", def->name, wrong);
    return BRUNT_OK;
}

// Stress that the equation of state gives an undeformed point.
static real rest_stress(const brunt_model *eos, const real *constants) {
    real one[BRUNT_LANES], zero[BRUNT_LANES] = {0}, stress[6][BRUNT_LANES] = {{0}}, state[BRUNT_MAX_STATE][BRUNT_LANES];
    brunt_points points = {.count = BRUNT_LANES, .dim = 3, .volume = zero};
    for (int l = 0; l < BRUNT_LANES; l++) one[l] = 1;
    for (int c = 0; c < 9; c++) points.F[c] = c % 4 == 0 ? one : zero, points.L[c] = zero;
    for (int c = 0; c < 6; c++) points.stress[c] = stress[c];
    int count = 0;
    for (int s = 0; s < eos->state_count; s++)
        for (int c = 0; c < eos->state[s].components3; c++, count++) {
            points.state[count] = state[count];
            for (int l = 0; l < BRUNT_LANES; l++)
                state[count][l] = eos->state[s].initial ? eos->state[s].initial(constants, c) : 0;
        }
    eos->update(constants, &points);
    return stress[0][0];
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
    const double *given[BRUNT_COMPONENTS] = {def->strength_parameters, def->viscosity_parameters, def->eos_parameters};
    real speed[BRUNT_COMPONENTS] = {0};
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        const brunt_model *model = material->model[k];
        if (!model) continue;
        int status = prepare(def, model, given[k], eos != NULL, material->constants[k], error);
        if (status) return status;
        speed[k] = model->wave_speed(material->constants[k]);
        const brunt_model *reduced = model->reduced ? model->reduced(given[k]) : NULL;
        if (reduced) material->model[k] = reduced;
    }
    if (eos) material->rest_stress = rest_stress(eos, material->constants[BRUNT_EOS]);
    material->wave_speed = brunt_wave_speed(speed[BRUNT_STRENGTH], speed[BRUNT_EOS], speed[BRUNT_VISCOSITY]);
    if (!eos && strength->needs_eos)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.eos: model '%s' has no pressure of its own, an equation of state is wanted",
                          def->name, strength->name);
    return BRUNT_OK;
}

int brunt_material_make_sheet(const brunt_material_def *def, bool slack, brunt_material *material, brunt_error *error) {
    int status = brunt_material_make(def, material, error);
    if (status) return status;
    const brunt_model *strength = material->model[BRUNT_STRENGTH];
    if (!strength->update_sheet) {
        char names[400] = "";
        for (int k = 0; k < brunt_strength_model_count; k++)
            if (brunt_strength_models[k]->update_sheet)
                snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", names[0] ? ", " : "",
                         brunt_strength_models[k]->name);
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s.model: '%s' has no plane-stress form for membranes: %s have", def->name,
                          strength->name, names);
    }
    if (material->model[BRUNT_EOS] || material->model[BRUNT_VISCOSITY])
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "materials.%s: a membrane takes neither equation of state nor bulk viscosity", def->name);
    material->sheet = true;
    material->slack = slack;
    material->wave_speed = strength->wave_speed_sheet(material->constants[BRUNT_STRENGTH]);
    return BRUNT_OK;
}

void brunt_material_energy(const brunt_material *material, brunt_component k, const brunt_points *points,
                           brunt_point_energy *energy) {
    const brunt_model *model = material->model[k];
    if (!model) return;
    if (material->sheet) {
        brunt_points sheet = *points;
        sheet.slack = material->slack;
        model->energy_sheet(material->constants[k], &sheet, energy);
    } else if (model->energy)
        model->energy(material->constants[k], points, energy);
}

static void set_defaults(const brunt_model *model, double *values) {
    for (int k = 0; model && k < model->parameter_count; k++) values[k] = model->parameters[k].initial;
}

brunt_material_def brunt_material_def_default(const char *name, const char *model) {
    brunt_material_def def = {.density = NAN};
    snprintf(def.name, sizeof def.name, "%s", name);
    snprintf(def.strength, sizeof def.strength, "%s", model);
    set_defaults(brunt_find_strength(model), def.strength_parameters);
    return def;
}

int brunt_material_set(brunt_material_def *def, const char *key, double value, const char *text, brunt_error *error) {
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
    if (!strncmp(key, "eos.", 4)) model = brunt_find_eos(def->eos), values = def->eos_parameters, rest = key + 4;
    if (!strncmp(key, "viscosity.", 10))
        model = def->bulk_viscosity ? &brunt_bulk_viscosity : NULL, values = def->viscosity_parameters, rest = key + 10;
    for (int k = 0; model && k < model->parameter_count; k++)
        if (!strcmp(model->parameters[k].key, rest)) {
            values[k] = value;
            return BRUNT_OK;
        }
    return brunt_fail(error, BRUNT_BAD_INPUT, "materials.%s: model '%s' has no parameter '%s'", def->name,
                      model ? model->name : "", key);
}

brunt_update_result brunt_material_update(const brunt_material *material, brunt_points points[BRUNT_COMPONENTS],
                                          real *plastic, real *viscous) {
    const brunt_model *const *model = material->model;
    brunt_update_result total = {.bad = -1};
    const bool dissipates = model[BRUNT_STRENGTH]->plastic || model[BRUNT_STRENGTH]->shear_viscous;
    real speed[BRUNT_COMPONENTS] = {0}, viscosity = 0;
    for (int k = 0; k < BRUNT_COMPONENTS; k++) {
        if (!model[k]) continue;
        points[k].plastic_increment = model[BRUNT_EOS] && dissipates ? plastic : NULL;
        points[k].viscous_pressure = model[BRUNT_EOS] && model[BRUNT_VISCOSITY] ? viscous : NULL;
        points[k].slack = material->slack;
        brunt_update_result result =
            (material->sheet ? model[k]->update_sheet : model[k]->update)(material->constants[k], &points[k]);
        speed[k] = result.wave_speed;
        viscosity += result.viscosity;
        if (result.bad >= 0 && total.bad < 0) total.bad = result.bad, total.reason = result.reason;
    }
    total.wave_speed = brunt_wave_speed(speed[BRUNT_STRENGTH], speed[BRUNT_EOS], speed[BRUNT_VISCOSITY] + viscosity);
    return total;
}
