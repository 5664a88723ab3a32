// A study file: its keys are checked like those of a scene, then every case is made and its scene read, so that nothing
// is found out after hours that could have been said at once.
#include "base/array.h"
#include "io/study/study_cases.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "io/study/study_view.h"

static void release_value(brunt_study_value *value) {
    for (int32_t s = 0; s < value->set_count; s++) brunt_free(value->sets[s]);
    brunt_free(value->sets);
}

void brunt_study_free(brunt_study *study) {
    if (!study) return;
    for (int32_t s = 0; s < study->set_count; s++) brunt_free(study->sets[s]);
    brunt_free(study->sets);
    for (int32_t a = 0; a < study->axis_count; a++) {
        for (int32_t v = 0; v < study->axes[a].value_count; v++) release_value(&study->axes[a].values[v]);
        brunt_free(study->axes[a].values);
    }
    for (int32_t m = 0; m < study->measure_count; m++) brunt_free(study->measures[m].table);
    for (int32_t c = 0; c < study->case_count; c++) brunt_free(study->cases[c].wall);
    brunt_free(study->cases);
    brunt_free(study->lines);
    memset(study, 0, sizeof *study);
}

// ---------------------------------------------------------------------------------------------------- helpers

scene_tree *study_tree(study_reader *r) { return r->base.tree; }

void *study_entries(study_reader *r, int32_t count, size_t size) {
    void *memory = brunt_alloc((size_t)(count + 1) * size);
    if (!memory) study_tree(r)->exhausted = true;
    return memory;
}

void study_complain_choice(study_reader *r, const scene_node *node, const char *what, const char *name,
                           const char *const *names, int count, bool key) {
    char all[900] = "";
    size_t used = 0;
    for (int i = 0; i < count && used + 4 < sizeof all; i++)
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    const char *nearest = brunt_nearest_name(name, names, count);
    void (*complain)(scene_tree *, const scene_node *, const char *, ...) =
        key ? brunt_tree_complain_key : brunt_tree_complain;
    if (nearest)
        complain(study_tree(r), node, "there is no %s '%.60s', did you mean '%s'?", what, name, nearest);
    else
        complain(study_tree(r), node, "there is no %s '%.60s'; there are: %s", what, name, count ? all : "none");
}

int32_t study_axis_named(study_reader *r, const scene_node *node, const char *name, bool key) {
    const char *names[BRUNT_STUDY_AXES];
    for (int32_t a = 0; a < r->study->axis_count; a++) {
        names[a] = r->study->axes[a].name;
        if (strcmp(names[a], name) == 0) return a;
    }
    study_complain_choice(r, node, "axis", name, names, r->study->axis_count, key);
    return BRUNT_NONE;
}

int32_t study_value_labelled(study_reader *r, const scene_node *node, int32_t a, const char *label, bool key) {
    const brunt_study_axis *axis = &r->study->axes[a];
    const char *names[CHOICE_LIMIT];
    int count = 0;
    for (int32_t v = 0; v < axis->value_count; v++) {
        if (strcmp(axis->values[v].label, label) == 0) return v;
        if (count < CHOICE_LIMIT) names[count++] = axis->values[v].label;
    }
    char what[80];
    snprintf(what, sizeof what, "value of %s", axis->name);
    study_complain_choice(r, node, what, label, names, count, key);
    return BRUNT_NONE;
}

static void copy_name(char *out, size_t size, const char *text) { snprintf(out, size, "%.*s", (int)size - 1, text); }

// A number with any unit. NOT_ONE: it does not begin like a number. BAD_NUMBER: its unit is none, or it is too large or
// small; `why` says so.
typedef enum number_state { NOT_ONE, NUMBER, BAD_NUMBER } number_state;

static number_state read_number(study_reader *r, const char *text, double *value, char base[BRUNT_UNIT_LENGTH],
                                char *why, size_t size) {
    const char *rest;
    double number;
    if (brunt_read_number(text, &number, &rest)) return NOT_ONE;
    while (*rest == ' ') rest++;
    strcpy(base, "1");
    if (*rest && !brunt_units_to_si(r->base.units, rest, &number, base, why, size)) return BAD_NUMBER;
    char range[160];
    if (!brunt_usable_number(number, false, range, sizeof range)) {
        snprintf(why, size, "'%.60s' is %s", text, range);
        return BAD_NUMBER;
    }
    *value = number;
    return NUMBER;
}

// Says what is wrong when `node` is no number.
static double wanted_number(study_reader *r, const scene_node *node) {
    char base[BRUNT_UNIT_LENGTH], why[320] = "";
    double value = NAN;
    if (node->kind != SCENE_SCALAR || read_number(r, node->text, &value, base, why, sizeof why) != NUMBER)
        brunt_tree_complain(study_tree(r), node, "%s%sa number is wanted", why, *why ? ": " : "");
    return value;
}

// ---------------------------------------------------------------------------------------------------- values to sets

// True when the scalar means the same without quotes wherever it stands in flow style.
static bool safe_plain(const char *text) {
    bool number = strchr("-+.", *text) && *text;
    if (!isalnum((unsigned char)(number ? text[1] : text[0]))) return false;
    for (const char *c = text; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("_-./%^*+() ", *c)) return false;
    return text[strlen(text) - 1] != ' ';
}

static void write_flow(FILE *out, const scene_node *node) {
    if (node->kind == SCENE_SCALAR) {
        if (safe_plain(node->text)) {
            fputs(node->text, out);
            return;
        }
        fputc('"', out);
        for (const char *c = node->text; *c; c++) {
            if (*c == '"' || *c == '\\') fputc('\\', out);
            fputs(*c == '\n' ? "\\n" : (char[]){*c, 0}, out);
        }
        fputc('"', out);
        return;
    }
    fputc(node->kind == SCENE_MAP ? '{' : '[', out);
    for (const scene_node *child = node->first; child; child = child->next) {
        if (child != node->first) fputs(", ", out);
        if (node->kind == SCENE_MAP) fprintf(out, safe_plain(child->key) ? "%s: " : "\"%s\": ", child->key);
        write_flow(out, child);
    }
    fputc(node->kind == SCENE_MAP ? '}' : ']', out);
}

// What begins like a placeholder must be one. Plain {h} is a map in YAML: that, too, is said.
static void check_placeholders(study_reader *r, const scene_node *node) {
    for (const scene_node *child = node->first; child; child = child->next) {
        bool empty = child->kind == SCENE_SCALAR && child->plain && !*child->text;
        if (node->kind == SCENE_MAP && node->count == 1 && empty)
            brunt_tree_complain(study_tree(r), node, "a value is wanted; a placeholder is text: \"{%.60s}\"",
                                child->key);
        else
            check_placeholders(r, child);
    }
    for (const char *p = node->kind == SCENE_SCALAR ? strchr(node->text, '{') : NULL; p; p = strchr(p + 1, '{')) {
        double factor;
        const char *rest;
        bool unknown;
        int32_t a = brunt_study_placeholder(r->study, p, &factor, &rest, &unknown);
        if (a >= 0) {
            r->used[a] = true;
        } else if (unknown) {
            char name[64];
            snprintf(name, sizeof name, "%.*s", (int)strcspn(p + 1, "*/}"), p + 1);
            study_axis_named(r, node, name, false);
        } else {
            brunt_tree_complain(study_tree(r), node,
                                "'%.40s' is no placeholder: {NAME}, {NAME*2} or {NAME/2} of an axis is wanted", p);
        }
    }
}

// "path=value"; NULL after a message or without memory.
static char *make_set(study_reader *r, const char *path, const scene_node *node) {
    if (strchr(path, '=')) {
        brunt_tree_complain_key(study_tree(r), node, "'%.60s' is not a path like bodies.rod.velocity", path);
        return NULL;
    }
    if (node->kind == SCENE_SCALAR && node->plain && !*node->text) {
        brunt_tree_complain(study_tree(r), node, "a value is wanted");
        return NULL;
    }
    check_placeholders(r, node);
    char *text = NULL, *copy = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    if (out) {
        fprintf(out, "%s=", path);
        write_flow(out, node);
        if (fclose(out) == 0) copy = brunt_study_copy(text);
    }
    free(text);
    if (!copy) study_tree(r)->exhausted = true;
    return copy;
}

// "bench/studies/x.yaml" and "../scenes/y.yaml": "bench/studies/../scenes/y.yaml".
static void take_path(study_reader *r, const scene_node *node, char out[1024]) {
    const char *slash = strrchr(r->study->source, '/');
    int folder = slash && *node->text != '/' ? (int)(slash + 1 - r->study->source) : 0;
    if (snprintf(out, 1024, "%.*s%s", folder, r->study->source, node->text) >= 1024)
        brunt_tree_complain(study_tree(r), node, "too long a path");
    check_placeholders(r, node);
}

bool study_key_is_special(const char *path) {
    return strcmp(path, "scene") == 0 || strcmp(path, "threads") == 0 || strcmp(path, "program") == 0;
}

static void take_special(study_reader *r, const char *what, const scene_node *node, brunt_study_value *value) {
    if (node->kind != SCENE_SCALAR || !*node->text) {
        brunt_tree_complain(study_tree(r), node, "one %s is wanted", strcmp(what, "threads") ? "file" : "number");
    } else if (strcmp(what, "scene") == 0) {
        take_path(r, node, value->scene);
    } else if (strcmp(what, "program") == 0) {
        take_path(r, node, value->program);
    } else {
        char *end;
        long threads = strtol(node->text, &end, 10);
        if (*end || threads < 1 || threads > BRUNT_THREAD_LIMIT)
            brunt_tree_complain(study_tree(r), node, "'%.60s' is no number of threads; 1 to %d are wanted", node->text,
                                BRUNT_THREAD_LIMIT);
        else
            value->threads = (int32_t)threads;
    }
}

// What one path of a value takes.
static void take_path_value(study_reader *r, const char *path, const scene_node *node, brunt_study_value *value) {
    if (study_key_is_special(path)) {
        take_special(r, path, node, value);
        return;
    }
    char *set = make_set(r, path, node);
    if (set) value->sets[value->set_count++] = set;
}

static void fill_sets(study_reader *r, const scene_node *map) {
    brunt_study *study = r->study;
    if (!map) return;
    if (map->kind != SCENE_MAP) {
        brunt_tree_complain(study_tree(r), map, "a map from paths of the scene to values is wanted");
        return;
    }
    study->sets = study_entries(r, map->count, sizeof *study->sets);
    for (const scene_node *child = study->sets ? map->first : NULL; child; child = child->next) {
        if (study_key_is_special(child->key)) {
            brunt_tree_complain_key(study_tree(r), child, "not among the paths of a scene: it is given %s",
                                    strcmp(child->key, "program") ? "outside of `set`" : "by an axis");
            continue;
        }
        char *set = make_set(r, child->key, child);
        if (set) study->sets[study->set_count++] = set;
    }
}

// ---------------------------------------------------------------------------------------------------- axes

typedef struct axis_keys {
    const scene_node *node[CHOICE_LIMIT];
    int count;
} axis_keys;

static void read_keys(study_reader *r, const scene_node *node, axis_keys *keys) {
    const scene_node *one = brunt_tree_child(node, "key"), *many = brunt_tree_child(node, "keys");
    if (one && many) brunt_tree_complain_key(study_tree(r), many, "key and keys are both given, one of them is wanted");
    if (one && one->good) keys->node[keys->count++] = one;
    if (many && (many->kind != SCENE_LIST || many->count == 0 || many->count > CHOICE_LIMIT - 1)) {
        brunt_tree_complain(study_tree(r), many, "a list of paths is wanted");
        return;
    }
    for (const scene_node *child = many ? many->first : NULL; child; child = child->next) {
        if (child->kind == SCENE_SCALAR && *child->text)
            keys->node[keys->count++] = child;
        else
            brunt_tree_complain(study_tree(r), child, "a path is wanted");
    }
}

static void take_label(study_reader *r, const scene_node *child, int32_t a, brunt_study_value *value) {
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    if (!out) return;
    if (child->key)
        fputs(child->key, out);
    else if (child->kind == SCENE_SCALAR)
        fputs(child->text, out);
    else
        write_flow(out, child);
    fclose(out);
    if (!*text || length >= sizeof value->label)
        brunt_tree_complain(study_tree(r), child, "%s: a map from short labels to values is wanted",
                            *text ? "too long to be its own label" : "nothing is given");
    copy_name(value->label, sizeof value->label, text);
    free(text);
    const brunt_study_axis *axis = &r->study->axes[a];
    for (int32_t v = 0; v < axis->value_count; v++)
        if (*value->label && strcmp(axis->values[v].label, value->label) == 0)
            brunt_tree_complain(study_tree(r), child, "'%s' is there twice", value->label);
}

// Its number: that of the value itself, else that of its label.
static void take_number(study_reader *r, const scene_node *child, int32_t a, brunt_study_value *value) {
    brunt_study_axis *axis = &r->study->axes[a];
    char base[BRUNT_UNIT_LENGTH] = "1", why[320] = "";
    const bool resolution = axis->role == BRUNT_STUDY_RESOLUTION;
    number_state state =
        child->kind == SCENE_SCALAR ? read_number(r, child->text, &value->number, base, why, sizeof why) : NOT_ONE;
    if (state == NOT_ONE && child->key) state = read_number(r, child->key, &value->number, base, why, sizeof why);
    if (resolution && state == BAD_NUMBER) brunt_tree_complain(study_tree(r), child, "%s", why);
    if (resolution && state == NOT_ONE)
        brunt_tree_complain(study_tree(r), child,
                            "a number is wanted (as the value or as its label): a resolution has one");
    if (state != NUMBER) return;
    if (resolution && value->number <= 0)
        brunt_tree_complain(study_tree(r), child, "'%s' is out of range, > 0 is wanted", value->label);
    const char *unit = strcmp(base, "1") == 0 ? "" : base;
    if (axis->value_count == 0) copy_name(axis->unit, sizeof axis->unit, unit);
    if (resolution && axis->value_count && strcmp(axis->unit, unit) != 0)
        brunt_tree_complain(study_tree(r), child, "'%s' is of another unit than the values before it", value->label);
    for (int32_t v = 0; resolution && v < axis->value_count; v++)
        if (axis->values[v].number == value->number && strcmp(axis->values[v].label, value->label) != 0)
            brunt_tree_complain(study_tree(r), child, "'%s' is there twice, as '%s'", value->label,
                                axis->values[v].label);
}

static void fill_value(study_reader *r, const scene_node *child, int32_t a, const axis_keys *keys, bool scaled) {
    brunt_study_axis *axis = &r->study->axes[a];
    brunt_study_value *value = &axis->values[axis->value_count];
    value->number = NAN;
    take_label(r, child, a, value);
    take_number(r, child, a, value);
    int32_t sets = keys->count ? keys->count : child->kind == SCENE_MAP ? child->count : 0;
    value->sets = study_entries(r, sets, sizeof *value->sets);
    axis->value_count++;
    if (!value->sets) return;
    for (int k = 0; k < keys->count; k++) {
        const char *path = keys->node[k]->text;
        if (!scaled) {
            take_path_value(r, path, child, value);
            continue;
        }
        char set[512], factor[32];
        brunt_format_number(value->number, factor);
        snprintf(set, sizeof set, "%.400s*=%s", path, factor);
        if ((value->sets[value->set_count] = brunt_study_copy(set))) value->set_count++;
    }
    if (keys->count) return;
    if (child->kind == SCENE_LIST || (child->kind == SCENE_SCALAR && child->key && !isfinite(value->number)))
        brunt_tree_complain(study_tree(r), child,
                            "a map from paths to what they take is wanted, or the axis needs a key");
    for (const scene_node *entry = child->kind == SCENE_MAP ? child->first : NULL; entry; entry = entry->next)
        take_path_value(r, entry->key, entry, value);
}

static void fill_axis(study_reader *r, const scene_node *node, int32_t a) {
    brunt_study_axis *axis = &r->study->axes[a];
    const scene_node *values = brunt_tree_child(node, "values"), *scale = brunt_tree_child(node, "scale");
    axis_keys keys = {.count = 0};
    read_keys(r, node, &keys);
    if (!values == !scale) {
        brunt_tree_complain_key(study_tree(r), node,
                                values ? "values and scale are both given, one of them is wanted"
                                       : "values are missing: a list or map of them, or scale");
        return;
    }
    if (values && (values->kind == SCENE_SCALAR || values->count == 0)) {
        brunt_tree_complain(study_tree(r), values, "a list of values or a map from labels to values is wanted");
        return;
    }
    if (scale && keys.count == 0) brunt_tree_complain_key(study_tree(r), scale, "a key is wanted: what is scaled?");
    for (int k = 0; k < keys.count; k++)
        if (scale && study_key_is_special(keys.node[k]->text))
            brunt_tree_complain(study_tree(r), keys.node[k], "'%s' has no number to be scaled", keys.node[k]->text);
    if (scale && !scale->good) return;
    r->values[a] = values ? values : scale;
    r->keyed[a] = keys.count > 0;
    axis->values = study_entries(r, r->values[a]->count, sizeof *axis->values);
    for (const scene_node *child = axis->values ? r->values[a]->first : NULL; child; child = child->next)
        fill_value(r, child, a, &keys, scale != NULL);
}

// Names first: any text may hold placeholders of any axis.
static void fill_axes(study_reader *r, const scene_node *map) {
    brunt_study *study = r->study;
    study->resolution = -1;
    if (!map || map->kind != SCENE_MAP) return;
    if (map->count > BRUNT_STUDY_AXES) {
        brunt_tree_complain_key(study_tree(r), map, "%d axes are given, at most %d are wanted", map->count,
                                BRUNT_STUDY_AXES);
        return;
    }
    for (const scene_node *child = map->first; child; child = child->next) {
        brunt_study_axis *axis = &study->axes[study->axis_count];
        copy_name(axis->name, sizeof axis->name, child->key);
        if (brunt_real_of(child, "role", 0) == BRUNT_STUDY_RESOLUTION) {
            axis->role = BRUNT_STUDY_RESOLUTION;
            if (study->resolution >= 0)
                brunt_tree_complain_key(study_tree(r), child,
                                        "%s is an axis of resolution already, one at most is wanted",
                                        study->axes[study->resolution].name);
            study->resolution = study->axis_count;
        }
        study->axis_count++;
    }
    int32_t a = 0;
    for (const scene_node *child = map->first; child; child = child->next) fill_axis(r, child, a++);
}

static void check_axes_used(study_reader *r, const scene_node *map) {
    int32_t a = 0;
    for (const scene_node *child = map && r->study->axis_count ? map->first : NULL; child; child = child->next, a++) {
        const brunt_study_axis *axis = &r->study->axes[a];
        bool plain = r->values[a] && !brunt_tree_child(child, "key") && !brunt_tree_child(child, "keys") &&
                     r->values[a] == brunt_tree_child(child, "values");
        int32_t v = 0;
        for (const scene_node *value = plain ? r->values[a]->first : NULL; value; value = value->next, v++)
            plain &= value->kind == SCENE_SCALAR && (!value->key || isfinite(axis->values[v].number));
        if (plain && !r->used[a])
            brunt_tree_complain_key(study_tree(r), child,
                                    "nothing takes it: key or keys, or text that holds {%s}, is wanted", child->key);
    }
}

// ---------------------------------------------------------------------------------------------------- measures

static void fill_table(study_reader *r, const scene_node *node, brunt_study_measure *measure) {
    const scene_node *axis = brunt_tree_child(node, "axis"), *values = brunt_tree_child(node, "values");
    measure->reference = BRUNT_REFERENCE_TABLE;
    if (!axis || axis->kind != SCENE_SCALAR || !values || values->kind != SCENE_MAP || node->count != 2) {
        brunt_tree_complain(study_tree(r), node, "{axis: NAME, values: {LABEL: NUMBER, ...}} is wanted");
        return;
    }
    int32_t a = study_axis_named(r, axis, axis->text, false);
    if (a < 0) return;
    const brunt_study_axis *of = &r->study->axes[a];
    measure->table_axis = a;
    measure->table = study_entries(r, of->value_count, sizeof *measure->table);
    if (!measure->table) return;
    for (int32_t v = 0; v < of->value_count; v++) measure->table[v] = NAN;
    for (const scene_node *child = values->first; child; child = child->next) {
        int32_t v = study_value_labelled(r, child, a, child->key, true);
        double number = wanted_number(r, child);
        if (v >= 0) measure->table[v] = number;
    }
    for (int32_t v = 0; v < of->value_count; v++)
        if (!brunt_tree_child(values, of->values[v].label))
            brunt_tree_complain(study_tree(r), values, "the number of '%s' is missing", of->values[v].label);
}

static void fill_reference(study_reader *r, const scene_node *node, brunt_study_measure *measure) {
    static const char *const words[] = {"scene", "finest", "richardson"};
    measure->reference = BRUNT_REFERENCE_NUMBER;
    measure->exact = NAN; // of the scene
    if (!node) return;
    if (node->kind == SCENE_MAP) {
        fill_table(r, node, measure);
        return;
    }
    const char *text = node->kind == SCENE_SCALAR ? node->text : "";
    if (strcmp(text, words[0]) == 0) return;
    if (strcmp(text, words[1]) == 0) {
        measure->reference = BRUNT_REFERENCE_FINEST;
    } else if (strcmp(text, words[2]) == 0) {
        measure->reference = BRUNT_REFERENCE_RICHARDSON;
    } else {
        char base[BRUNT_UNIT_LENGTH], why[320];
        number_state state = read_number(r, text, &measure->exact, base, why, sizeof why);
        if (state == BAD_NUMBER) brunt_tree_complain(study_tree(r), node, "%s", why);
        if (state != NOT_ONE) return;
        const char *nearest = brunt_nearest_name(text, words, BRUNT_COUNT(words));
        brunt_tree_complain(study_tree(r), node,
                            "%s%s%sscene, finest, richardson, a number or {axis: NAME, values: {...}} "
                            "is wanted",
                            nearest ? "did you mean '" : "", nearest ? nearest : "", nearest ? "'? " : "");
    }
    if (measure->reference != BRUNT_REFERENCE_NUMBER && r->study->resolution < 0 && r->study->axis_count)
        brunt_tree_complain(study_tree(r), node, "an axis with role: resolution is wanted for it");
}

static void fill_measures(study_reader *r, const scene_node *map) {
    brunt_study *study = r->study;
    if (!map || map->kind != SCENE_MAP) return;
    if (map->count > BRUNT_STUDY_MEASURES) {
        brunt_tree_complain_key(study_tree(r), map, "%d measures are given, at most %d are wanted", map->count,
                                BRUNT_STUDY_MEASURES);
        return;
    }
    for (const scene_node *child = map->first; child; child = child->next) {
        brunt_study_measure *measure = &study->measures[study->measure_count++];
        copy_name(measure->name, sizeof measure->name, child->key);
        fill_reference(r, brunt_tree_child(child, "reference"), measure);
        brunt_copy_text(&r->base, brunt_tree_child(child, "title"), measure->title, sizeof measure->title);
        if (!*measure->title) snprintf(measure->title, sizeof measure->title, "error of %s", child->key);
        const scene_node *of = brunt_tree_child(child, "of");
        brunt_copy_text(&r->base, of, measure->of, sizeof measure->of);
        if (of && measure->reference != BRUNT_REFERENCE_FINEST && measure->reference != BRUNT_REFERENCE_RICHARDSON)
            brunt_tree_complain_key(study_tree(r), of, "it goes with reference: finest and reference: richardson");
        measure->scale = brunt_real_of(child, "scale", NAN);
        measure->order = brunt_real_of(child, "order", NAN);
    }
}

// ---------------------------------------------------------------------------------------------------- the whole

static void fill_accuracies(study_reader *r, const scene_node *list) {
    static const double usual[] = {0.1, 0.03, 0.01};
    brunt_study *study = r->study;
    if (list && list->count > BRUNT_STUDY_ACCURACIES)
        brunt_tree_complain(study_tree(r), list, "%d are given, at most %d are wanted", list->count,
                            BRUNT_STUDY_ACCURACIES);
    for (const scene_node *child = list ? list->first : NULL; child; child = child->next)
        if (study->accuracy_count < BRUNT_STUDY_ACCURACIES)
            study->accuracies[study->accuracy_count++] = child->good ? child->value[0] : NAN;
    for (int i = 0; !list && i < BRUNT_COUNT(usual); i++) study->accuracies[study->accuracy_count++] = usual[i];
}

static void read_study(study_reader *r) {
    brunt_study *study = r->study;
    scene_tree *tree = study_tree(r);
    brunt_check_keys(&r->base);
    const scene_node *root = tree->root, *scene = brunt_tree_child(root, "scene"),
                     *axes = brunt_tree_child(root, "axes");
    brunt_copy_text(&r->base, brunt_tree_child(root, "title"), study->title, sizeof study->title);
    study->threads = (int32_t)brunt_real_of(root, "threads", 1);
    study->repeats = (int32_t)brunt_real_of(root, "repeats", 3);
    study->time_limit = brunt_real_of(root, "time_limit", 3600);
    fill_axes(r, axes);
    if (scene && scene->good) take_path(r, scene, study->scene);
    fill_sets(r, brunt_tree_child(root, "set"));
    check_axes_used(r, axes);
    fill_measures(r, brunt_tree_child(root, "measures"));
    fill_accuracies(r, brunt_tree_child(root, "accuracies"));
    study_make_cases(r);
    study_check_methods(r);
    // Values that are wrong by themselves would only be said twice.
    if (tree->message_count == 0) study_check_cases(r);
}

static void take_names(brunt_study *study, const char *path) {
    copy_name(study->source, sizeof study->source, path);
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strrchr(base, '.');
    int length = dot && dot != base ? (int)(dot - base) : (int)strlen(base);
    snprintf(study->name, sizeof study->name, "%.*s", length, base);
}

int brunt_study_read(const char *path, brunt_study *study, FILE *messages) {
    memset(study, 0, sizeof *study);
    char *text;
    size_t length;
    int status = brunt_read_text(path, &text, &length, messages);
    if (status) return status;
    take_names(study, path);
    scene_tree tree = {.format = &brunt_study_format, .name = study->source, .source = text, .length = length};
    study_reader reader = {.base = {.tree = &tree, .units = brunt_units_open()}, .study = study};
    tree.exhausted = !reader.base.units;
    tree.root = tree.exhausted ? NULL : brunt_tree_parse(&tree, text, length, NULL);
    if (tree.root && tree.root->kind != SCENE_MAP)
        brunt_tree_complain(&tree, tree.root, "a study is a map that starts with 'brunt_study: 1'");
    else if (tree.root && brunt_tree_child(tree.root, "brunt"))
        brunt_tree_complain(&tree, tree.root, "this is a scene, for 'brunt run'; a study is wanted");
    else if (tree.root)
        read_study(&reader);
    status = tree.message_count || tree.exhausted ? BRUNT_BAD_INPUT : BRUNT_OK;
    if (status) brunt_tree_report(&tree, messages);
    if (status) brunt_study_free(study);
    brunt_units_close(reader.base.units);
    brunt_tree_free(&tree);
    brunt_free(text);
    return status;
}
