#include "io/performance/predict.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "world/definitions.h"

// The plan's passes, and what a step takes between them.
enum { PASSES = BRUNT_PREDICTION_PASSES };
// A world that fails within these cannot be run; one that fails later has a cost until then.
enum { FIRST_STEPS = 3 };

// What is spent on the world itself, or where that is only a few steps, on a rehearsal of a short run, and on all
// rehearsals at most [s]. In between they take a tenth of what they predict.
static const double sample_budget = 0.07, few_steps_budget = 0.5, least_budget = 0.5, budget_limit = 2.0,
                    deadline = 3.0;

// ------------------------------------------------------------------------------------------ steps that are timed

// Sums over steps, each counted `weight` times.
typedef struct sums {
    double weight, pass[PASSES];
} sums;

// A world while it is stepped.
typedef struct stage {
    brunt_world *world;
    int32_t passes;             // without "other"
    double seen[PASSES];        // [s] of each pass so far
    double cost[PASSES], taken; // [s] of the last step, and all of it
    double usual[PASSES];       // [s] running mean
    double dt;                  // [s] of the last step
} stage;

static stage stage_of(brunt_world *world) {
    stage s = {.world = world, .passes = brunt_pass_count(world)};
    if (s.passes > PASSES - 1) s.passes = PASSES - 1;
    for (int32_t p = 0; p < s.passes; p++) s.seen[p] = brunt_world_pass(world, p).seconds;
    return s;
}

// A thread that has to wait for another program's adds milliseconds to a pass of microseconds, which would be scaled
// up: beyond ten times what was usual is not counted. Contact that begins passes that within some ten steps.
static double count_cost(stage *s, int32_t pass, double cost) {
    const double least = 20e-6, counted = fmin(cost, 10 * s->usual[pass] + least);
    s->usual[pass] += 0.1 * (counted - s->usual[pass]);
    return counted;
}

static int take_step(stage *s, double limit, brunt_error *error) {
    double from = brunt_world_time(s->world), start = brunt_clock(), rest;
    const bool first = s->taken == 0;
    int status = brunt_world_step(s->world, limit, error);
    rest = s->taken = brunt_clock() - start;
    for (int32_t p = 0; p < s->passes; p++) {
        double now = brunt_world_pass(s->world, p).seconds, cost = now - s->seen[p];
        if (first) s->usual[p] = cost;
        s->cost[p] = count_cost(s, p, cost);
        s->seen[p] = now;
        rest -= cost;
    }
    s->cost[s->passes] = count_cost(s, s->passes, fmax(rest, 0));
    s->dt = brunt_world_time(s->world) - from;
    return status;
}

static void add_step(sums *to, const stage *s, double weight) {
    to->weight += weight;
    for (int32_t p = 0; p <= s->passes; p++) to->pass[p] += weight * s->cost[p];
}

enum { PARTS = 4 };

static double total_of(const sums *s, int32_t passes) {
    double total = 0;
    for (int32_t p = 0; p <= passes; p++) total += s->pass[p];
    return total;
}

// The first steps in parts: other work on the machine, and memory that is touched for the first time, add to some of
// them; the least is what is compared.
static const sums *least_part(const sums part[PARTS], int32_t passes) {
    const sums *least = NULL;
    double best = INFINITY;
    for (int i = 0; i < PARTS; i++) {
        double step = part[i].weight > 0 ? total_of(&part[i], passes) / part[i].weight : INFINITY;
        if (step < best) best = step, least = &part[i];
    }
    return least;
}

static double mean(const sums *s, int32_t pass) { return s->weight > 0 ? s->pass[pass] / s->weight : 0; }

static bool at_end(const brunt_world *world) { return brunt_world_time(world) >= brunt_world_end(world) * (1 - 1e-12); }

// ------------------------------------------------------------------------------------------ the world itself

typedef struct sample {
    sums all, first;     // steps of the world itself: all but the first, and those that a rehearsal's are compared with
    double first_dt, dt; // [s] first step, not yet cut by output; mean step
    double time, taken;  // [s] of the world at its end, of the clock in its steps
    double busy[PASSES]; // threads at work in each pass, in the mean
    bool ended, failed;  // the whole run was taken; it ended by failing
} sample;

// The times a run stops at, those of pictures: its steps are cut to meet them.
static double output_interval(const brunt_scene *scene) {
    return scene->output.every > 0 ? scene->output.every : INFINITY;
}

static void count_busy(const brunt_world *world, int32_t passes, double busy[PASSES]) {
    int threads = brunt_world_threads(world);
    for (int32_t p = 0; p <= passes; p++) {
        busy[p] = 1;
        if (p == passes) break;
        brunt_pass pass = brunt_world_pass(world, p);
        double sum = 0;
        for (int t = 0; t < threads; t++) sum += pass.thread_seconds[t];
        if (pass.seconds > 0) busy[p] = fmin(fmax(sum / pass.seconds, 1), threads);
    }
}

static double next_stop(const brunt_world *world, double interval) {
    return isinf(interval) ? INFINITY : (floor(brunt_world_time(world) / interval * (1 + 1e-12) + 1e-9) + 1) * interval;
}

// Steps of the world itself for `budget` seconds, or longer until there are some; added to what was sampled before. The
// first one touches memory for the first time and counts only when it stays alone.
static int take_sample(const brunt_scene *scene, brunt_world *world, double budget, sample *out, brunt_error *error) {
    stage s = stage_of(world);
    sums alone = {0}, part[PARTS] = {{0}};
    double interval = output_interval(scene), start = brunt_clock(), from = brunt_world_time(world), spent = 0;
    const sums before = out->all;
    *out = (sample){.all = before, .first_dt = brunt_world_dt(world)};
    int64_t steps = 0;
    while (!at_end(world) &&
           (steps < 2 || spent < budget || (steps < 2 * PARTS && spent < fmax(5 * budget, few_steps_budget))) &&
           spent < deadline) {
        int status = take_step(&s, next_stop(world, interval), error);
        if (status && brunt_world_steps(world) <= FIRST_STEPS) return status;
        out->failed = status != BRUNT_OK;
        out->taken += s.taken;
        spent = brunt_clock() - start;
        if (steps++ == 0) {
            add_step(&alone, &s, 1);
        } else {
            add_step(&part[(int)fmin(PARTS * spent / budget, PARTS - 1)], &s, 1);
            add_step(&out->all, &s, 1);
        }
        if (out->failed) break;
    }
    out->time = brunt_world_time(world);
    out->dt = (out->time - from) / (double)steps;
    out->ended = at_end(world) || out->failed;
    const sums *least = least_part(part, s.passes);
    out->first = least ? *least : alone;
    if (!(out->all.weight > 0)) out->all = alone;
    count_busy(world, s.passes, out->busy);
    return BRUNT_OK;
}

// ------------------------------------------------------------------------------------------ a coarser world

// All lengths of the discretisation times f, and what is measured by them. Bodies keep what they own: it belongs to the
// scene. False when nothing can be made coarser.
static bool coarsen(const brunt_world_def *fine, double f, brunt_world_def *def, brunt_body_def *bodies) {
    bool coarser = false;
    *def = *fine;
    def->bodies = bodies;
    def->cell *= f;
    def->contact.cell *= f;
    def->contact.allow_overlap = true; // of particles that stand for more
    def->least_step = 0;
    def->step = 0;
    def->energy_limit = INFINITY;
    def->threads = 1;
    for (int32_t b = 0; b < fine->body_count; b++) {
        brunt_body_def *body = &bodies[b];
        *body = fine->bodies[b];
        if (body->method != BRUNT_MPM && body->mesh.node_count) continue;
        coarser = true;
        brunt_body_coarsen(body, f);
    }
    return coarser;
}

typedef struct rehearsal {
    double factor, seconds; // [-], [s] of the clock
    double steps;           // of the run itself, from the rehearsal's
    double reached;         // [-] share of the world's time
    sums all, first;        // of steps, as often as the run itself takes them
    double growth;          // [-] of the arrays
    double ratio[PASSES];   // what each pass goes over in the run, over that here
    bool surface[PASSES];   // which of them go over surfaces
    bool failed, too_costly;
    char reason[256];
} rehearsal;

static double array_bytes(const brunt_world *world) {
    double bytes = 0;
    for (int32_t a = 0; a < brunt_array_count(world); a++) bytes += (double)brunt_world_array(world, a).bytes;
    return bytes;
}

static double points_of(const brunt_world *world) {
    return (double)(brunt_world_particles(world) + brunt_world_elements(world));
}

static double named_bytes(const brunt_world *world, const char *name) {
    for (int32_t a = 0; a < brunt_array_count(world); a++) {
        brunt_array array = brunt_world_array(world, a);
        if (!strcmp(array.name, name)) return (double)array.bytes;
    }
    return 0;
}

static double over(double a, double b, double otherwise) { return a > 0 && b > 0 ? a / b : otherwise; }

// What each pass goes over in `fine` over that in `coarse`: contact and boundaries surfaces, the rest particles or
// elements.
static void count_ratios(const brunt_world *fine, const brunt_world *coarse, rehearsal *r) {
    static const char *const of_elements[] = {"kick", "groups", "drift", "elements"};
    static const char *const of_surfaces[] = {"contact", "boundaries", "conditions", "symmetry", "surfaces"};
    double all = over(points_of(fine), points_of(coarse), 1);
    double particles = over((double)brunt_world_particles(fine), (double)brunt_world_particles(coarse), all);
    double elements = over((double)brunt_world_elements(fine), (double)brunt_world_elements(coarse), all);
    double surface = fmax(all / r->factor, 1);
    double faces = over(named_bytes(fine, "contact of surfaces"), named_bytes(coarse, "contact of surfaces"), surface);
    int32_t count = brunt_pass_count(fine) < PASSES ? brunt_pass_count(fine) : PASSES - 1;
    for (int32_t p = 0; p < count; p++) {
        const char *name = brunt_world_pass(fine, p).name;
        r->ratio[p] = particles;
        for (size_t e = 0; e < sizeof of_elements / sizeof *of_elements; e++)
            if (!strcmp(name, of_elements[e])) r->ratio[p] = elements;
        for (size_t e = 0; e < sizeof of_surfaces / sizeof *of_surfaces; e++)
            if (!strcmp(name, of_surfaces[e])) r->ratio[p] = surface, r->surface[p] = true;
        if (!strcmp(name, "surfaces")) r->ratio[p] = faces;
        if (!strcmp(name, "erosion") || !strcmp(name, "advance")) r->ratio[p] = all;
    }
    r->ratio[count] = all; // "other"
}

// Steps that the run itself takes while the rehearsal takes one of `dt`.
static double weight_of(const brunt_world_def *fine, double interval, double dt, double scale) {
    double step = fine->step > 0 ? fine->step : dt * scale;
    if (step < interval && isfinite(interval)) step = interval / ceil(interval / step * (1 - 1e-9));
    return dt / fmin(step, interval);
}

// Runs the coarser world to its end, or until `budget` seconds are up. False when it cannot be made, or has so many
// points that it is `too_costly`: at most `share` of the run itself is allowed.
static bool rehearse(const brunt_scene *scene, const brunt_world *fine, const sample *own, double f, double share,
                     double budget, rehearsal *out) {
    brunt_world_def def;
    brunt_body_def *bodies = brunt_alloc(sizeof *bodies * (size_t)scene->world.body_count);
    brunt_error error = {0};
    double start = brunt_clock(), interval = output_interval(scene);
    memset(out, 0, sizeof *out);
    out->factor = f;
    brunt_world *world = bodies && coarsen(&scene->world, f, &def, bodies) ? brunt_world_create(&def, &error) : NULL;
    if (world && points_of(world) > share * f * points_of(fine)) {
        out->too_costly = true;
        brunt_world_destroy(world);
        world = NULL;
    }
    if (world) {
        stage s = stage_of(world);
        sums part[PARTS] = {{0}};
        double bytes = array_bytes(world), scale = own->first_dt / brunt_world_dt(world);
        count_ratios(fine, world, out);
        for (int64_t taken = 0; !at_end(world); taken++) {
            double time = brunt_world_time(world);
            if (take_step(&s, INFINITY, &error)) {
                out->failed = true;
                snprintf(out->reason, sizeof out->reason, "%.250s", error.message);
                break;
            }
            double weight = weight_of(&scene->world, interval, s.dt, scale);
            out->steps += weight;
            if (taken == 0) continue;
            add_step(&out->all, &s, weight);
            if (time < own->time || taken <= 2 * PARTS)
                add_step(&part[(int)fmin(PARTS * time / own->time, PARTS - 1)], &s, weight);
            if (brunt_clock() - start > budget) break;
        }
        const sums *least = least_part(part, s.passes);
        if (least) out->first = *least;
        out->reached = fmin(brunt_world_time(world) / brunt_world_end(world), 1);
        out->growth = bytes > 0 ? fmax(array_bytes(world) / bytes, 1) : 1;
        brunt_world_destroy(world);
    }
    brunt_free(bodies);
    out->seconds = brunt_clock() - start;
    return world != NULL && out->all.weight > 0 && out->reached > 0;
}

// ------------------------------------------------------------------------------------------ from rehearsal to run

// Steps go on as they are: all that is known without a rehearsal, and of a run that was taken whole.
static void predict_by_sample(const brunt_world *world, const sample *own, brunt_prediction *out) {
    const double left = own->ended ? 0 : (brunt_world_end(world) - own->time) / own->dt;
    out->steps = (double)brunt_world_steps(world) + left;
    out->sampled_steps = (double)brunt_world_steps(world);
    out->sampled_seconds += own->taken;
    out->rehearsed = own->time / brunt_world_end(world);
    out->step_seconds = 0;
    for (int32_t p = 0; p < out->pass_count; p++) {
        out->passes[p].seconds = out->steps * mean(&own->all, p);
        out->step_seconds += out->passes[p].seconds;
    }
}

__attribute__((format(printf, 2, 3))) static void note(brunt_prediction *p, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(p->note, sizeof p->note, format, arguments);
    va_end(arguments);
}

// A pass costs what it costs at the start, and what the rehearsal's costs more later, scaled up. Where it costs less
// there, the share counts: the difference of two small numbers, scaled up, has gone below 0. Contact that larger cells
// find from the first step on, and the run's own not yet, is scaled up as a whole.
static void predict_by_rehearsal(const sample *own, const rehearsal *r, brunt_prediction *out) {
    out->steps = r->steps / r->reached;
    out->factor = r->factor;
    out->rehearsed = r->reached;
    out->growth = r->growth;
    out->step_seconds = 0;
    for (int32_t p = 0; p < out->pass_count; p++) {
        double later = mean(&r->all, p), first = mean(&r->first, p), at_start = mean(&own->first, p);
        double ratio = r->ratio[p] / own->busy[p], step = at_start * later / first;
        if (r->surface[p] && first * ratio > 4 * at_start)
            step = later * ratio;
        else if (later >= first)
            step = at_start + (later - first) * ratio;
        out->passes[p].seconds = out->steps * step;
        out->step_seconds += out->passes[p].seconds;
    }
    out->note[0] = 0;
    if (r->failed)
        note(out, "the rehearsal failed at %.0f %% of the time, the rest is taken to go on alike: %s", 100 * r->reached,
             r->reason);
    else if (r->reached < 1)
        note(out, "the rehearsal was left at %.0f %% of the time, the rest is taken to go on alike", 100 * r->reached);
}

static double clamp(double x, double low, double high) { return fmin(fmax(x, low), high); }

static const double factors[] = {16, 11.314, 8, 5.657, 4, 2.828, 2, 1.414};
enum { FACTORS = sizeof factors / sizeof *factors };

// The least factor whose rehearsal takes no longer than `budget`, if at f it takes `seconds` / f^exponent.
static int affordable(double seconds, double exponent, double budget) {
    int i = 0;
    while (i + 1 < FACTORS && seconds / pow(factors[i + 1], exponent) <= budget) i++;
    return i;
}

// A coarse rehearsal says what a finer one will take; the finer one counts.
static void rehearse_in_turn(const brunt_scene *scene, const brunt_world *world, const sample *own, double start,
                             brunt_prediction *out) {
    const double points = points_of(world), exponent = brunt_world_dimension(world) + 1, at_start = out->step_seconds;
    // Fewer than some 30 points are no rehearsal of anything.
    const double coarsest = pow(points / 30, 1 / (exponent - 1));
    const double scout = 0.15 * clamp(0.1 * at_start, least_budget, budget_limit);
    int i = affordable(at_start, exponent, scout);
    while (i + 1 < FACTORS && factors[i] > coarsest) i++;
    rehearsal first, second;
    int made = -1;
    for (int tries = 0; made < 0 && i < FACTORS && tries < 4; tries++) {
        // Strips one element wide do not lose points along all axes: a coarser one then.
        double share = i > 0 && tries < 3 ? 2 * scout / at_start : INFINITY;
        if (rehearse(scene, world, own, factors[i], share, start + deadline - brunt_clock(), &first))
            made = i;
        else
            i += first.too_costly ? -1 : 1;
    }
    if (made < 0) return;
    predict_by_rehearsal(own, &first, out);
    double measured = log(out->step_seconds * first.reached / first.seconds) / log(first.factor);
    double budget = clamp(0.1 * out->step_seconds, least_budget, budget_limit) - (brunt_clock() - start);
    int j = affordable(out->step_seconds, clamp(measured, 1, exponent), budget);
    for (int tries = 0; j > made && tries < 2; tries++, j--) {
        if (!rehearse(scene, world, own, factors[j], INFINITY, start + deadline - brunt_clock(), &second)) continue;
        if (second.reached < first.reached) continue;
        // Where material is pressed together most, more so in smaller cells, is where the step is from.
        double shrink =
            log(second.steps * first.reached / (first.steps * second.reached)) / log(first.factor / second.factor);
        second.steps *= pow(second.factor, clamp(shrink, 0, 0.2));
        predict_by_rehearsal(own, &second, out);
        break;
    }
}

// ------------------------------------------------------------------------------------------ public

static const double program_bytes = 18.5e6; // that are resident after a run of next to nothing, libraries included

int brunt_predict(const brunt_scene *scene, brunt_world *world, brunt_history *history, bool quick,
                  brunt_prediction *prediction, brunt_error *error) {
    double start = brunt_clock(), buffers = 0;
    sample own = {0};
    brunt_prediction *p = prediction;
    memset(p, 0, sizeof *p);
    p->growth = 1;
    p->first_step = brunt_world_dt(world);
    p->pass_count = brunt_pass_count(world) < PASSES ? brunt_pass_count(world) + 1 : PASSES;
    for (int32_t i = 0; i < p->pass_count; i++)
        snprintf(p->passes[i].name, sizeof p->passes[i].name, "%s",
                 i + 1 < p->pass_count ? brunt_world_pass(world, i).name : "other");
    p->array_bytes = array_bytes(world);
    double live = (double)brunt_memory_live();
    int status = take_sample(scene, world, sample_budget, &own, error);
    if (status) return status;
    live = fmax(live, (double)brunt_memory_live());
    predict_by_sample(world, &own, p);
    if (!own.ended && !quick && p->step_seconds < least_budget) {
        status = take_sample(scene, world, 2 * least_budget, &own, error);
        if (status) return status;
        predict_by_sample(world, &own, p);
    }
    if (!own.ended && quick) note(p, "not rehearsed: steps that shrink and contact that comes later are not seen");
    if (!own.ended && !quick) {
        rehearse_in_turn(scene, world, &own, start, p);
        if (p->factor == 0) { // nothing can be made coarser: a tenth of the run itself, whose latest steps go on
            own.all = (sums){.weight = 0};
            status = take_sample(scene, world, clamp(0.1 * p->step_seconds, least_budget, budget_limit), &own, error);
            if (status) return status;
            predict_by_sample(world, &own, p);
            note(p, "it cannot be made coarser, so that what comes later than %.2g %% of the time was not seen",
                 100 * p->rehearsed);
        }
    }
    if (own.ended) p->factor = 1, p->note[0] = 0;
    if (own.failed) note(p, "the run will fail: %.400s", error->message);
    status = brunt_predict_output(scene, world, history, p, &buffers, error);
    p->peak_bytes = program_bytes + live + (p->growth - 1) * p->array_bytes + buffers;
    p->rehearsal_seconds = brunt_clock() - start;
    return status;
}
