// What a scene sets once for the whole run.
#include "body/settings.h"

#include "base/error.h"
#include "base/parallel.h"
#include "mpm/courant.h"

static double cfl_of(const brunt_world_def *def, bool particles) {
    if (def->cfl > 0) return def->cfl;
    return particles ? brunt_default_cfl(def->dimension, def->kernel, def->transfer) : 0.5;
}

// They belong to the definition, which may go before the world does.
static void drop_lists(brunt_world_def *def) {
#define DROP(NAME, kind, type, word, what) def->kind##s = NULL, def->kind##_count = 0;
    BRUNT_BOUNDARY_KINDS(DROP)
    def->materials = NULL, def->bodies = NULL, def->boundaries = NULL, def->detonations = NULL;
    def->material_count = def->body_count = def->boundary_count = def->detonation_count = 0;
    def->contact.pairs = NULL, def->contact.pair_count = 0;
    def->background = (brunt_mesh){.node_count = 0};
}

void brunt_settings_make(brunt_settings *s, const brunt_world_def *def, bool particles) {
    s->given = *def;
    drop_lists(&s->given);
    s->dimension = def->dimension;
    s->threads = def->threads > 0 ? def->threads : brunt_threads_available();
    if (s->threads > BRUNT_THREAD_LIMIT) s->threads = BRUNT_THREAD_LIMIT;
    s->transfer = def->transfer;
    s->flip_per_step = def->flip_per_step;
    s->flip = def->flip, s->apic = def->transfer == BRUNT_APIC ? def->apic : 0;
    s->fixed_step = def->step, s->end = def->end;
    s->scheme = def->scheme, s->newton = def->newton;
    s->axisymmetric = def->axisymmetric;
    s->cell = def->cell;
    for (int a = 0; a < def->dimension; a++) s->has_gravity = s->has_gravity || def->gravity[a] != 0;
    s->cfl = cfl_of(def, particles);
}

void brunt_settings_validate(const brunt_settings *s) {
    BRUNT_ASSERT(s->dimension == 2 || s->dimension == 3);
    BRUNT_ASSERT(s->threads >= 1 && s->threads <= BRUNT_THREAD_LIMIT);
    BRUNT_ASSERT(s->fixed_step >= 0 && s->cfl > 0 && s->end > 0);
}
