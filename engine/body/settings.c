// What a scene sets once for the whole run.
#include "body/settings.h"

#include <string.h>

#include "base/error.h"
#include "base/parallel.h"
#include "mpm/courant.h"

static double cfl_of(const brunt_world_def *def, bool particles) {
    if (def->cfl > 0) return def->cfl;
    return particles ? brunt_default_cfl(def->dimension, def->kernel, def->transfer) : 0.5;
}

void brunt_settings_make(brunt_settings *s, const brunt_world_def *def, bool particles) {
    s->dimension = def->dimension;
    s->threads = def->threads > 0 ? def->threads : brunt_threads_available();
    if (s->threads > BRUNT_THREAD_LIMIT) s->threads = BRUNT_THREAD_LIMIT;
    s->kernel = def->kernel, s->transfer = def->transfer;
    s->flip = def->flip, s->fixed_step = def->step, s->end = def->end;
    s->scheme = def->scheme, s->integrator = def->integrator, s->newton = def->newton;
    s->predictor = def->predictor;
    s->axisymmetric = def->axisymmetric;
    s->least_step = def->least_step;
    s->energy_limit = def->energy_limit, s->cell = def->cell, s->gravity_ramp = def->gravity_ramp;
    memcpy(s->gravity, def->gravity, sizeof s->gravity);
    for (int a = 0; a < def->dimension; a++) s->has_gravity = s->has_gravity || def->gravity[a] != 0;
    s->cfl = cfl_of(def, particles);
}

void brunt_settings_validate(const brunt_settings *s) {
    BRUNT_ASSERT(s->dimension == 2 || s->dimension == 3);
    BRUNT_ASSERT(s->threads >= 1 && s->threads <= BRUNT_THREAD_LIMIT);
    BRUNT_ASSERT(s->fixed_step >= 0 && s->cfl > 0 && s->end > 0);
}
