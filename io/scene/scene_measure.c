// Measures of a scene: what is measured, over which time, and against what it is judged.
#include "base/array.h"
#include "boundary/group_actions.h"
#include "boundary/kinds.h"
#include "io/scene/scene_crowd.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"

static bool one_of(const char *name, const char *const *names, int count) {
    for (int i = 0; i < count; i++)
        if (strcmp(name, names[i]) == 0) return true;
    return false;
}

// Names that columns of the history may have, maps each.
struct scene_columns {
    scene_node boundaries, gas, probes;
    scene_node selves; // bodies whose contact with themselves is asked for
};

static void enter(scene_reader *reader, scene_node *map, const char *name) {
    scene_node *node = brunt_tree_alloc(reader->tree, sizeof *node);
    if (!node) return;
    *node = (scene_node){.key = (char *)name};
    brunt_tree_append(map, node);
}

static void list_columns(scene_reader *reader, struct scene_columns *all) {
    const brunt_world_def *world = &reader->scene->world;
    const brunt_output_def *output = &reader->scene->output;
    *all = (struct scene_columns){{.kind = SCENE_MAP}, {.kind = SCENE_MAP}, {.kind = SCENE_MAP}, {.kind = SCENE_MAP}};
    for (brunt_boundary_entry e = {.w = -1}; brunt_boundary_entry_next(world, &e);)
        enter(reader, &all->boundaries, e.kind->name(e.entry));
    for (int32_t i = 0; i < world->group_count; i++)
        if (brunt_group_rows[world->groups[i].action].gas) enter(reader, &all->gas, world->groups[i].name);
    for (int i = 0; i < output->probe_count; i++) enter(reader, &all->probes, output->probes[i].name);
    for (int32_t p = 0; p < world->contact.pair_count; p++) {
        const brunt_pair_def *pair = &world->contact.pairs[p];
        if (pair->method != BRUNT_CONTACT_NONE && strcmp(pair->a, pair->b) == 0) enter(reader, &all->selves, pair->a);
    }
}

// "prefix.NAME.rest" or "prefix.NAME": whether NAME is one of those.
static bool names_part(const char *rest, const scene_node *names) {
    char name[BRUNT_NAME_LENGTH];
    const size_t length = strcspn(rest, ".");
    snprintf(name, sizeof name, "%.*s", (int)length, rest);
    return length < sizeof name && brunt_tree_child(names, name);
}

// Whether "A-B", `length` long, is a pair of bodies that meet.
static bool is_pair(const scene_reader *reader, const char *rest, size_t length) {
    char pair[2 * BRUNT_NAME_LENGTH];
    if (length >= sizeof pair) return false;
    snprintf(pair, sizeof pair, "%.*s", (int)length, rest);
    for (char *dash = strchr(pair, '-'); dash; *dash = '-', dash = strchr(dash + 1, '-')) { // names may have some
        *dash = 0;
        const brunt_body_def *a = brunt_body_named(reader, pair), *b = brunt_body_named(reader, dash + 1);
        if (a && b && (a != b || brunt_tree_child(&reader->columns->selves, a->name))) return true;
    }
    return false;
}

// Members of crowds have a dot in their names.
static bool pair_exists(const scene_reader *reader, const char *rest) {
    for (size_t length = strcspn(rest, ".");; length += 1 + strcspn(rest + length + 1, ".")) {
        if (is_pair(reader, rest, length)) return true;
        if (!rest[length]) return false;
    }
}

static bool body_exists(const scene_reader *reader, const char *rest) {
    char name[BRUNT_NAME_LENGTH];
    const size_t length = strcspn(rest, ".");
    int32_t first;
    snprintf(name, sizeof name, "%.*s", (int)length, rest);
    if (length >= sizeof name) return false;
    const int32_t count = brunt_bodies_named(reader, name, &first);
    if (count < 2 || rest[length] != '.' || !isdigit((unsigned char)rest[length + 1])) return count > 0;
    const size_t whole = length + 1 + strcspn(rest + length + 1, ".");
    snprintf(name, sizeof name, "%.*s", (int)whole, rest);
    return whole < sizeof name && brunt_body_named(reader, name);
}

static const char *gas_mistake(const struct scene_columns *columns, const char *rest) {
    static const char *const quantities[] = {"volume", "pressure", "energy", "inflow"};
    const char *dot = strchr(rest, '.');
    if (!dot || !names_part(rest, &columns->gas)) return "there is no boundary of that name with gas";
    return one_of(dot + 1, quantities, BRUNT_COUNT(quantities))
               ? NULL
               : "of gas there are volume, pressure, energy and inflow";
}

static const char *newton_mistake(const char *rest) {
    static const char *const counts[] = {"iterations", "halvings",  "linear_iterations", "cuts",
                                         "residual",   "least_gap", "least_part"};
    return one_of(rest, counts, sizeof counts / sizeof *counts)
               ? NULL
               : "of Newton's method there are iterations, halvings, linear_iterations, cuts, residual, least_gap and "
                 "least_part";
}

// What of a column can be known before the engine runs: its family, and the names of bodies, boundaries and probes in
// it.
static const char *column_mistake(const scene_reader *reader, const char *column) {
    static const char *const plain[] = {"time", "step", "dt"};
    static const char *const energies[] = {"kinetic",        "internal",      "mechanical", "plastic",  "hourglass",
                                           "contact",        "friction",      "viscosity",  "transfer", "eroded",
                                           "heat",           "external_work", "initial",    "total",    "error",
                                           "error_relative", "scheme"};
    static const char *const links[] = {"count", "mean", "sd", "greatest", "slipping"};
    static const char *const balances[] = {"body", "all"};
    static const char families[] =
        "columns are time, step, dt, energy.*, momentum.*, newton.*, balance.*, links.*, body.NAME.*, contact.A-B.*, "
        "wall.NAME.*, gas.NAME.* and probe.NAME";
    const char *dot = strchr(column, '.');
    if (!dot) return one_of(column, plain, BRUNT_COUNT(plain)) ? NULL : families;
    const char *rest = dot + 1;
    size_t family = (size_t)(dot - column);
    if (!*rest) return "the name ends with its dot";
    if (family == 6 && strncmp(column, "energy", 6) == 0)
        return one_of(rest, energies, sizeof energies / sizeof *energies)
                   ? NULL
                   : "energies are kinetic, internal, plastic, hourglass, contact, friction, viscosity, transfer, "
                     "eroded, heat, scheme, external_work, initial, total, error, error_relative";
    if (family == 8 && strncmp(column, "momentum", 8) == 0) return NULL;
    if (family == 6 && strncmp(column, "newton", 6) == 0) return newton_mistake(rest);
    if (family == 7 && strncmp(column, "balance", 7) == 0)
        return one_of(rest, balances, BRUNT_COUNT(balances)) ? NULL : "of balances there are body and all";
    if (family == 5 && strncmp(column, "links", 5) == 0)
        return one_of(rest, links, BRUNT_COUNT(links)) ? NULL
                                                       : "of links there are count, mean, sd, greatest, slipping";
    if (family == 4 && strncmp(column, "body", 4) == 0)
        return body_exists(reader, rest) ? NULL : "there is no such body";
    if (family == 7 && strncmp(column, "contact", 7) == 0)
        return pair_exists(reader, rest) ? NULL : "there is no such pair of bodies, A-B is wanted";
    if (family == 4 && strncmp(column, "wall", 4) == 0)
        return names_part(rest, &reader->columns->boundaries) ? NULL : "there is no boundary of that name";
    if (family == 3 && strncmp(column, "gas", 3) == 0) return gas_mistake(reader->columns, rest);
    if (family == 5 && strncmp(column, "probe", 5) == 0)
        return names_part(rest, &reader->columns->probes) ? NULL : "there is no probe of that name";
    return families;
}

// `energy: total` is `history: energy.total`; `at` is `take`. The resolved scene has the longer names.
static void unfold(scene_reader *reader, scene_node *node) {
    scene_node *energy = brunt_tree_child(node, "energy"), *at = brunt_tree_child(node, "at");
    if (energy && brunt_tree_child(node, "history")) {
        brunt_tree_complain_key(reader->tree, energy, "energy is a history, too: one of them is wanted");
    } else if (energy && energy->good) {
        char column[96];
        snprintf(column, sizeof column, "energy.%.60s", energy->text);
        scene_node *history = brunt_add_default(reader, node, "history", column);
        if (!history) return;
        // Mistakes in it are the user's, at the place of what was typed.
        history->line = energy->line, history->column = energy->column, history->option = energy->option;
        brunt_tree_remove(energy);
    }
    if (at && at->good && !brunt_tree_child(node, "take")) {
        scene_node *take = brunt_add_default(reader, node, "take", at->text);
        if (!take) return;
        take->line = at->line, take->column = at->column, take->option = at->option;
        brunt_tree_remove(at);
    } else if (at && brunt_tree_child(node, "take")) {
        brunt_tree_complain_key(reader->tree, at, "at and take are the same, one of them is wanted");
    }
}

static void fill_slab(scene_reader *reader, const scene_node *where, brunt_measure *measure) {
    const scene_node *to = brunt_tree_child(where, "to");
    measure->slab_min = brunt_real_of(where, "from", -INFINITY);
    measure->slab_max = brunt_real_of(where, "to", INFINITY);
    if (to && to->good && !(measure->slab_min < measure->slab_max))
        brunt_tree_complain(reader->tree, to, "to must be above from");
}

static void fill_place_of(scene_reader *reader, scene_node *where, brunt_measure *measure, bool axis_wanted) {
    scene_node *axis = brunt_tree_child(where, "axis");
    bool given = brunt_vector_of(where, "axis", measure->axis);
    if (given && measure->axis[0] == 0 && measure->axis[1] == 0 && measure->axis[2] == 0)
        brunt_tree_complain(reader->tree, axis, "the axis has zero length");
    if (!axis && axis_wanted) brunt_tree_complain_key(reader->tree, where, "'axis' is missing: a direction");
    fill_slab(reader, where, measure); // what has no rows for from and to has none
    if (measure->kind == BRUNT_MEASURE_FIELD && axis && !brunt_tree_child(where, "center"))
        brunt_add_default(reader, where, "center", "0");
    brunt_vector_of(where, "center", measure->center);
}

static bool has_unit(const scene_node *node) {
    return node && node->good && node->base && strcmp(node->base, "1") != 0;
}

static void fill_profile(scene_reader *reader, scene_node *where, brunt_measure *measure) {
    const scene_node *reference = brunt_tree_child(where, "reference");
    fill_place_of(reader, where, measure, false);
    if (!reference || !reference->good) return;
    measure->curve.points = brunt_entries_for(reader, reference->count, sizeof *measure->curve.points);
    bool zero = true;
    for (const scene_node *point = measure->curve.points ? reference->first : NULL; point; point = point->next) {
        double *to = measure->curve.points[measure->curve.count++];
        to[0] = point->first->value[0];
        to[1] = point->last->value[0];
        zero = zero && to[1] == 0;
        if (!has_unit(point->last)) continue;
        if (*measure->curve_unit && strcmp(measure->curve_unit, point->last->base) != 0)
            brunt_tree_complain(reader->tree, point->last, "this value is in %s, one before it in %s",
                                point->last->base, measure->curve_unit);
        snprintf(measure->curve_unit, sizeof measure->curve_unit, "%.63s", point->last->base);
    }
    if (zero) brunt_tree_complain(reader->tree, reference, "it is 0 everywhere, distances are relative to its size");
}

// Columns that the scheme has not got are not measured, which is said where nothing worse is wrong with them.
static void note_absent(scene_reader *reader, const scene_node *where, brunt_measure *measure, bool sound) {
    const brunt_scheme scheme = reader->scene->world.scheme;
    const bool loads =
        scheme != BRUNT_STATIC && (!strncmp(measure->column, "links.", 6) || !strncmp(measure->column, "balance.", 8));
    measure->absent = loads || (!strncmp(measure->column, "newton.", 7) && !brunt_scheme_minimises(scheme));
    if (measure->absent && sound)
        brunt_scene_warn_at(reader, where, false,
                            loads ? "not measured: links and balances are of static steps"
                                  : "not measured: Newton's method is of implicit and static steps");
}

static void fill_kind(scene_reader *reader, scene_node *node, brunt_measure *measure) {
    static const char *const kinds[] = {
#define X(NAME, name) #name,
        BRUNT_MEASURE_KINDS(X)
#undef X
    };
    scene_tree *tree = reader->tree;
    scene_node *where = NULL;
    int count = 0;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        scene_node *child = brunt_tree_child(node, kinds[k]);
        if (!child) continue;
        where = child;
        measure->kind = (brunt_measure_kind)k;
        count++;
    }
    if (count != 1) {
        char names[200] = "";
        const size_t kind_count = sizeof kinds / sizeof *kinds;
        for (size_t k = 1, used = 0; k < kind_count && used < sizeof names; k++)
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", k + 1 < kind_count ? ", " : " and ",
                                     kinds[k]);
        brunt_tree_complain_key(tree, node, "%s of history (or energy)%s is given, exactly one is wanted",
                                count ? "more than one" : "none", names);
        return;
    }
    if (measure->kind == BRUNT_MEASURE_HISTORY) {
        brunt_copy_text(reader, where, measure->column, sizeof measure->column);
        const char *mistake = where->good ? column_mistake(reader, where->text) : NULL;
        if (mistake) brunt_tree_complain(tree, where, "'%.100s' is no column of the history: %s", where->text, mistake);
        note_absent(reader, where, measure, mistake == NULL);
        return;
    }
    if (where->kind != SCENE_MAP) return;
    char path[64];
    snprintf(path, sizeof path, "measures.*.%s", kinds[measure->kind]);
    brunt_fill_fields(reader, where, path, 0, measure);
    brunt_check_body_name(reader, brunt_tree_child(where, "body"));
    brunt_copy_text(reader, brunt_tree_child(where, "body"), measure->body, sizeof measure->body);
    if (measure->kind == BRUNT_MEASURE_FIELD || measure->kind == BRUNT_MEASURE_PROFILE) {
        brunt_copy_text(reader, brunt_tree_child(where, "name"), measure->field, sizeof measure->field);
        // magnitude x y z xx yy zz xy yz xz: vectors and symmetric tensors both count from 0
        int word = (int)brunt_real_of(where, "component", 0);
        measure->component = word == 0 ? -1 : word <= 3 ? word - 1 : word - 4;
        if (measure->kind == BRUNT_MEASURE_PROFILE) {
            fill_profile(reader, where, measure);
            return;
        }
        bool slab =
            brunt_tree_child(where, "from") || brunt_tree_child(where, "to") || brunt_tree_child(where, "center");
        fill_place_of(reader, where, measure, slab);
    } else {
        const bool about = measure->kind == BRUNT_MEASURE_RADIUS || measure->kind == BRUNT_MEASURE_TWIST;
        measure->within = brunt_real_of(where, "within", INFINITY);
        fill_place_of(reader, where, measure, about && reader->dimension == 3);
    }
}

// A distance over a range is a pure number; the curve's own unit is compared with that of the column once there is one.
static void check_curve_units(scene_reader *reader, const scene_node *node, const scene_node *curve) {
    static const char *const pure[] = {"expect", "tolerance"};
    scene_tree *tree = reader->tree;
    const char *unit = "1";
    for (const scene_node *point = curve->first; point; point = point->next) {
        const char *base = point->last->base;
        if (strcmp(base, "1") == 0) continue;
        if (strcmp(unit, "1") != 0 && strcmp(unit, base) != 0)
            brunt_tree_complain(tree, point->last, "this value is in %s, one before it in %s", base, unit);
        unit = base;
        if (brunt_tree_child(node, "relative_to")) {
            brunt_tree_complain(tree, point->last,
                                "the history is divided (relative_to): a number without unit is wanted");
            break;
        }
    }
    for (int i = 0; i < BRUNT_COUNT(pure); i++) {
        const scene_node *key = brunt_tree_child(node, pure[i]);
        if (has_unit(key)) brunt_tree_complain(tree, key, "a distance relative to the curve's range has no unit");
    }
    const scene_node *printed = brunt_tree_child(node, "unit");
    if (printed && printed->good && *printed->text && strcmp(printed->text, "1") != 0)
        brunt_tree_complain(tree, printed, "a distance relative to the curve's range has no unit");
}

static void fill_curve(scene_reader *reader, scene_node *node, brunt_measure *measure) {
    const scene_node *curve = brunt_tree_child(node, "curve");
    scene_tree *tree = reader->tree;
    if (!curve) return;
    if (measure->kind != BRUNT_MEASURE_HISTORY) {
        brunt_tree_complain_key(tree, curve, "a curve over time is for measures of the history");
        return;
    }
    if (!curve->good) return;
    check_curve_units(reader, node, curve);
    double least = INFINITY, most = -INFINITY;
    measure->curve.points = brunt_entries_for(reader, curve->count, sizeof *measure->curve.points);
    for (const scene_node *point = measure->curve.points ? curve->first : NULL; point; point = point->next) {
        double *to = measure->curve.points[measure->curve.count++], value = point->last->value[0];
        to[0] = point->first->value[0];
        to[1] = value;
        least = fmin(least, value);
        most = fmax(most, value);
        if (has_unit(point->last))
            snprintf(measure->curve_unit, sizeof measure->curve_unit, "%.63s", point->last->base);
    }
    if (measure->curve.count && !(most > least))
        brunt_tree_complain(tree, curve, "its values are all the same, distances are relative to their range");
    else if (!isfinite(most - least))
        brunt_tree_complain(tree, curve, "the range of its values is no number");
}

// The window of a curve is where there is one, unless a narrower one is given.
static void check_curve_times(scene_reader *reader, scene_node *node, brunt_measure *measure) {
    const brunt_curve *curve = &measure->curve;
    scene_tree *tree = reader->tree;
    const scene_node *take = brunt_tree_child(node, "take"), *from = brunt_tree_child(node, "from"),
                     *to = brunt_tree_child(node, "to"), *shown = brunt_tree_child(node, "curve");
    double first = curve->points[0][0], last = curve->points[curve->count - 1][0], end = reader->scene->world.end;
    char text[32];
    brunt_take t = measure->take;
    if (take && take->good && t != BRUNT_TAKE_END && t != BRUNT_TAKE_INITIAL && t != BRUNT_TAKE_MIN &&
        t != BRUNT_TAKE_MAX && t != BRUNT_TAKE_MEAN && t != BRUNT_TAKE_MAX_ABS)
        brunt_tree_complain(tree, take,
                            "the distance from a curve is reduced by max_abs, max, min, mean, initial or end");
    if (!from) measure->from = first;
    if (!to) measure->to = last;
    double tolerance = 1e-9 * (last - first);
    if (from && from->good && (measure->from < first - tolerance || measure->from > last + tolerance))
        brunt_tree_complain(tree, from, "there is no curve then");
    if (to && to->good && (measure->to < first - tolerance || measure->to > last + tolerance))
        brunt_tree_complain(tree, to, "there is no curve then");
    brunt_format_number(end, text);
    if (!from && first < 0)
        brunt_tree_complain(tree, shown, "it begins before the run: `from` says from when it is compared");
    if (!to && end > 0 && last > end * (1 + 1e-9))
        brunt_tree_complain(tree, shown, "it ends after the run has ended (%s s): `to` says until when it is compared",
                            text);
    else if (!(measure->from < measure->to) && !(from && to))
        brunt_tree_complain(tree, shown, "nothing of it is left between from and to");
}

static void fill_time_of(scene_reader *reader, scene_node *node, brunt_measure *measure) {
    scene_tree *tree = reader->tree;
    const scene_node *take = brunt_tree_child(node, "take"), *from = brunt_tree_child(node, "from"),
                     *to = brunt_tree_child(node, "to");
    bool history = measure->kind == BRUNT_MEASURE_HISTORY, field = measure->kind == BRUNT_MEASURE_FIELD;
    if (!take && field)
        brunt_tree_complain_key(tree, node,
                                "'take' is missing: a field is reduced over the body by min, max, mean or max_abs");
    const bool curved = brunt_tree_child(node, "curve") != NULL;
    if (!take && !field) take = brunt_add_default(reader, node, "take", history && curved ? "max_abs" : "end");
    measure->take = (brunt_take)(int)brunt_real_of(node, "take", BRUNT_TAKE_END);
    if (take && take->good) {
        brunt_take t = measure->take;
        bool over_particles =
            t == BRUNT_TAKE_MIN || t == BRUNT_TAKE_MAX || t == BRUNT_TAKE_MEAN || t == BRUNT_TAKE_MAX_ABS;
        if (field && !over_particles)
            brunt_tree_complain(tree, take, "a field is reduced over the body by min, max, mean or max_abs");
        if (!field && !history && t != BRUNT_TAKE_END)
            brunt_tree_complain(tree, take, "this is measured at the end only");
    }
    if (!history && from) brunt_tree_complain_key(tree, from, "a time window is for measures of the history");
    if (!history && to) brunt_tree_complain_key(tree, to, "a time window is for measures of the history");
    measure->from = brunt_real_of(node, "from", 0);
    measure->to = brunt_real_of(node, "to", INFINITY);
    double end = reader->scene->world.end, last = end * (1 + 1e-9);
    static const char way_out[] = "a window within it is wanted, or --set measures={} for a short run";
    char text[32];
    brunt_format_number(end, text);
    if (end > 0 && from && from->good && measure->from > last)
        brunt_tree_complain(tree, from, "the window starts after the run has ended (%s s): %s", text, way_out);
    if (end > 0 && to && to->good && measure->to > last)
        brunt_tree_complain(tree, to, "the window ends after the run has ended (%s s): %s", text, way_out);
    if (to && to->good && !(measure->from < measure->to)) brunt_tree_complain(tree, to, "to must be after from");
    if (measure->curve.count && history) check_curve_times(reader, node, measure);
}

static void fill_reference(scene_reader *reader, scene_node *node, brunt_measure *measure) {
    const scene_node *relative = brunt_tree_child(node, "relative_to");
    const scene_node *minus = brunt_tree_child(node, "minus");
    measure->minus = brunt_real_of(node, "minus", 0);
    if (has_unit(minus)) snprintf(measure->minus_unit, sizeof measure->minus_unit, "%.63s", minus->base);
    measure->relative_to = NAN;
    if (!relative || !relative->good) return;
    if (!relative->number)
        measure->relative_to_initial = true;
    else if (relative->value[0] == 0)
        brunt_tree_complain(reader->tree, relative, "a division by zero");
    else
        measure->relative_to = relative->value[0];
    if (has_unit(relative)) snprintf(measure->relative_unit, sizeof measure->relative_unit, "%.63s", relative->base);
}

static void fill_expectation(scene_reader *reader, scene_node *node, brunt_measure *measure) {
    scene_tree *tree = reader->tree;
    const scene_node *expect = brunt_tree_child(node, "expect"), *tolerance = brunt_tree_child(node, "tolerance"),
                     *kind = brunt_tree_child(node, "tolerance_is");
    measure->expect = brunt_real_of(node, "expect", NAN);
    measure->tolerance = brunt_real_of(node, "tolerance", NAN);
    if (tolerance && !expect) brunt_tree_complain_key(tree, tolerance, "a tolerance without expect");
    if (expect && !tolerance) brunt_tree_complain_key(tree, expect, "expect without a tolerance");
    if (kind && !tolerance) brunt_tree_complain_key(tree, kind, "tolerance_is without a tolerance");
    // A distance from a curve is relative as it is, to the curve's range.
    if (tolerance && !kind)
        kind =
            brunt_add_default(reader, node, "tolerance_is",
                              measure->curve.count && measure->kind == BRUNT_MEASURE_HISTORY ? "absolute" : "relative");
    measure->absolute = kind && kind->good && kind->value[0] == 1;
    if (has_unit(tolerance) && kind && kind->good && !measure->absolute)
        brunt_tree_complain(tree, tolerance, "a tolerance with a unit needs tolerance_is: absolute");
    if (has_unit(tolerance) && has_unit(expect) && strcmp(tolerance->base, expect->base) != 0)
        brunt_tree_complain(tree, tolerance, "the tolerance is in %s, expect in %s", tolerance->base, expect->base);
    if (expect && expect->good && measure->expect == 0 && tolerance && tolerance->good && !measure->absolute)
        brunt_tree_complain(tree, tolerance,
                            "a tolerance relative to 0 cannot be met: tolerance_is: absolute is wanted");
}

static void fill_unit(scene_reader *reader, scene_node *node, brunt_measure *measure) {
    scene_node *unit = brunt_tree_child(node, "unit");
    const scene_node *expect = brunt_tree_child(node, "expect");
    if (!unit || !unit->good) return;
    if (*unit->text) {
        char base[BRUNT_UNIT_LENGTH], why[256];
        double one = 1, zero = 0;
        if (!brunt_units_to_si(reader->units, unit->text, &one, base, why, sizeof why) ||
            !brunt_units_to_si(reader->units, unit->text, &zero, base, why, sizeof why))
            brunt_tree_complain(reader->tree, unit, "%s", why);
        else if (one != 1 || zero != 0)
            brunt_tree_complain(reader->tree, unit, "measures are printed in SI: '%.40s' has a factor, %s is wanted",
                                unit->text, brunt_units_written(base));
        else if (has_unit(expect) && strcmp(expect->base, base) != 0)
            brunt_tree_complain(reader->tree, unit, "the unit is %s, but expect is in %s", unit->text, expect->base);
    } else if (has_unit(expect)) {
        unit->text = (char *)expect->base;
    }
    brunt_copy_text(reader, unit, measure->unit, sizeof measure->unit);
}

void brunt_fill_measures(scene_reader *reader) {
    brunt_scene *scene = reader->scene;
    scene_node *map = brunt_tree_child(reader->tree->root, "measures");
    if (!map || map->kind != SCENE_MAP || map->count == 0) return;
    scene->measures = brunt_alloc((size_t)map->count * sizeof *scene->measures);
    if (!scene->measures) {
        reader->tree->exhausted = true;
        return;
    }
    struct scene_columns columns;
    list_columns(reader, &columns);
    reader->columns = &columns;
    for (scene_node *node = map->first; node; node = node->next) {
        brunt_measure *measure = &scene->measures[scene->measure_count++];
        measure->component = -1;
        measure->slab_min = -INFINITY;
        measure->slab_max = INFINITY;
        snprintf(measure->name, sizeof measure->name, "%.*s", BRUNT_NAME_LENGTH - 1, node->key);
        if (node->kind != SCENE_MAP) continue;
        unfold(reader, node);
        fill_kind(reader, node, measure);
        fill_curve(reader, node, measure);
        fill_time_of(reader, node, measure);
        fill_reference(reader, node, measure);
        fill_expectation(reader, node, measure);
        fill_unit(reader, node, measure);
        brunt_copy_text(reader, brunt_tree_child(node, "source"), measure->source, sizeof measure->source);
    }
    reader->columns = NULL;
}
