// A study file: its keys are checked like those of a scene, then every case is made and its scene read, so that nothing
// is found out after hours that could have been said at once.
#include "io/study/study_reader.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "io/scene/scene_reader.h"
#include "io/study/study_view.h"

enum { CASE_LIMIT = 10000, CHOICE_LIMIT = 64 };

typedef struct study_reader {
    scene_reader base; // tree and units
    brunt_study *study;
    const scene_node *values[BRUNT_STUDY_AXES]; // list or map that the values of an axis are the children of
    bool keyed[BRUNT_STUDY_AXES];               // key or keys are given: a value is what they take
    bool used[BRUNT_STUDY_AXES];                // some text holds its placeholder
} study_reader;

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

static scene_tree *tree_of(study_reader *r) { return r->base.tree; }

static void *entries(study_reader *r, int32_t count, size_t size) {
    void *memory = brunt_alloc((size_t)(count + 1) * size);
    if (!memory) tree_of(r)->exhausted = true;
    return memory;
}

static void complain_choice(study_reader *r, const scene_node *node, const char *what, const char *name,
                            const char *const *names, int count, bool key) {
    char all[900] = "";
    size_t used = 0;
    for (int i = 0; i < count && used + 4 < sizeof all; i++)
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", names[i]);
    const char *nearest = brunt_nearest_name(name, names, count);
    void (*complain)(scene_tree *, const scene_node *, const char *, ...) =
        key ? brunt_tree_complain_key : brunt_tree_complain;
    if (nearest)
        complain(tree_of(r), node, "there is no %s '%.60s', did you mean '%s'?", what, name, nearest);
    else
        complain(tree_of(r), node, "there is no %s '%.60s'; there are: %s", what, name, count ? all : "none");
}

static int32_t axis_named(study_reader *r, const scene_node *node, const char *name, bool key) {
    const char *names[BRUNT_STUDY_AXES];
    for (int32_t a = 0; a < r->study->axis_count; a++) {
        names[a] = r->study->axes[a].name;
        if (strcmp(names[a], name) == 0) return a;
    }
    complain_choice(r, node, "axis", name, names, r->study->axis_count, key);
    return -1;
}

static int32_t value_labelled(study_reader *r, const scene_node *node, int32_t a, const char *label, bool key) {
    const brunt_study_axis *axis = &r->study->axes[a];
    const char *names[CHOICE_LIMIT];
    int count = 0;
    for (int32_t v = 0; v < axis->value_count; v++) {
        if (strcmp(axis->values[v].label, label) == 0) return v;
        if (count < CHOICE_LIMIT) names[count++] = axis->values[v].label;
    }
    char what[80];
    snprintf(what, sizeof what, "value of %s", axis->name);
    complain_choice(r, node, what, label, names, count, key);
    return -1;
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
    char reach[160];
    if (!brunt_usable_number(number, false, reach, sizeof reach)) {
        snprintf(why, size, "'%.60s' is %s", text, reach);
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
        brunt_tree_complain(tree_of(r), node, "%s%sa number is wanted", why, *why ? ": " : "");
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
            brunt_tree_complain(tree_of(r), node, "a value is wanted; a placeholder is text: \"{%.60s}\"", child->key);
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
            axis_named(r, node, name, false);
        } else {
            brunt_tree_complain(tree_of(r), node,
                                "'%.40s' is no placeholder: {NAME}, {NAME*2} or {NAME/2} of an axis is wanted", p);
        }
    }
}

// "path=value"; NULL after a message or without memory.
static char *make_set(study_reader *r, const char *path, const scene_node *node) {
    if (strchr(path, '=')) {
        brunt_tree_complain_key(tree_of(r), node, "'%.60s' is not a path like bodies.rod.velocity", path);
        return NULL;
    }
    if (node->kind == SCENE_SCALAR && node->plain && !*node->text) {
        brunt_tree_complain(tree_of(r), node, "a value is wanted");
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
    if (!copy) tree_of(r)->exhausted = true;
    return copy;
}

// "bench/studies/x.yaml" and "../scenes/y.yaml": "bench/studies/../scenes/y.yaml".
static void take_path(study_reader *r, const scene_node *node, char out[1024]) {
    const char *slash = strrchr(r->study->source, '/');
    int folder = slash && *node->text != '/' ? (int)(slash + 1 - r->study->source) : 0;
    if (snprintf(out, 1024, "%.*s%s", folder, r->study->source, node->text) >= 1024)
        brunt_tree_complain(tree_of(r), node, "too long a path");
    check_placeholders(r, node);
}

static bool is_special(const char *path) {
    return strcmp(path, "scene") == 0 || strcmp(path, "threads") == 0 || strcmp(path, "program") == 0;
}

static void take_special(study_reader *r, const char *what, const scene_node *node, brunt_study_value *value) {
    if (node->kind != SCENE_SCALAR || !*node->text) {
        brunt_tree_complain(tree_of(r), node, "one %s is wanted", strcmp(what, "threads") ? "file" : "number");
    } else if (strcmp(what, "scene") == 0) {
        take_path(r, node, value->scene);
    } else if (strcmp(what, "program") == 0) {
        take_path(r, node, value->program);
    } else {
        char *end;
        long threads = strtol(node->text, &end, 10);
        if (*end || threads < 1 || threads > 256)
            brunt_tree_complain(tree_of(r), node, "'%.60s' is no number of threads; 1 to 256 are wanted", node->text);
        else
            value->threads = (int32_t)threads;
    }
}

// What one path of a value takes.
static void take_path_value(study_reader *r, const char *path, const scene_node *node, brunt_study_value *value) {
    if (is_special(path)) {
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
        brunt_tree_complain(tree_of(r), map, "a map from paths of the scene to values is wanted");
        return;
    }
    study->sets = entries(r, map->count, sizeof *study->sets);
    for (const scene_node *child = study->sets ? map->first : NULL; child; child = child->next) {
        if (is_special(child->key)) {
            brunt_tree_complain_key(tree_of(r), child, "not among the paths of a scene: it is given %s",
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
    if (one && many) brunt_tree_complain_key(tree_of(r), many, "key and keys are both given, one of them is wanted");
    if (one && one->good) keys->node[keys->count++] = one;
    if (many && (many->kind != SCENE_LIST || many->count == 0 || many->count > CHOICE_LIMIT - 1)) {
        brunt_tree_complain(tree_of(r), many, "a list of paths is wanted");
        return;
    }
    for (const scene_node *child = many ? many->first : NULL; child; child = child->next) {
        if (child->kind == SCENE_SCALAR && *child->text)
            keys->node[keys->count++] = child;
        else
            brunt_tree_complain(tree_of(r), child, "a path is wanted");
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
        brunt_tree_complain(tree_of(r), child, "%s: a map from short labels to values is wanted",
                            *text ? "too long to be its own label" : "nothing is given");
    copy_name(value->label, sizeof value->label, text);
    free(text);
    const brunt_study_axis *axis = &r->study->axes[a];
    for (int32_t v = 0; v < axis->value_count; v++)
        if (*value->label && strcmp(axis->values[v].label, value->label) == 0)
            brunt_tree_complain(tree_of(r), child, "'%s' is there twice", value->label);
}

// Its number: that of the value itself, else that of its label.
static void take_number(study_reader *r, const scene_node *child, int32_t a, brunt_study_value *value) {
    brunt_study_axis *axis = &r->study->axes[a];
    char base[BRUNT_UNIT_LENGTH] = "1", why[320] = "";
    const bool resolution = axis->role == BRUNT_STUDY_RESOLUTION;
    number_state state =
        child->kind == SCENE_SCALAR ? read_number(r, child->text, &value->number, base, why, sizeof why) : NOT_ONE;
    if (state == NOT_ONE && child->key) state = read_number(r, child->key, &value->number, base, why, sizeof why);
    if (resolution && state == BAD_NUMBER) brunt_tree_complain(tree_of(r), child, "%s", why);
    if (resolution && state == NOT_ONE)
        brunt_tree_complain(tree_of(r), child,
                            "a number is wanted (as the value or as its label): a resolution has one");
    if (state != NUMBER) return;
    if (resolution && value->number <= 0)
        brunt_tree_complain(tree_of(r), child, "'%s' is out of range, > 0 is wanted", value->label);
    const char *unit = strcmp(base, "1") == 0 ? "" : base;
    if (axis->value_count == 0) copy_name(axis->unit, sizeof axis->unit, unit);
    if (resolution && axis->value_count && strcmp(axis->unit, unit) != 0)
        brunt_tree_complain(tree_of(r), child, "'%s' is of another unit than the values before it", value->label);
    for (int32_t v = 0; resolution && v < axis->value_count; v++)
        if (axis->values[v].number == value->number)
            brunt_tree_complain(tree_of(r), child, "'%s' is there twice, as '%s'", value->label, axis->values[v].label);
}

static void fill_value(study_reader *r, const scene_node *child, int32_t a, const axis_keys *keys, bool scaled) {
    brunt_study_axis *axis = &r->study->axes[a];
    brunt_study_value *value = &axis->values[axis->value_count];
    value->number = NAN;
    take_label(r, child, a, value);
    take_number(r, child, a, value);
    int32_t sets = keys->count ? keys->count : child->kind == SCENE_MAP ? child->count : 0;
    value->sets = entries(r, sets, sizeof *value->sets);
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
        brunt_tree_complain(tree_of(r), child, "a map from paths to what they take is wanted, or the axis needs a key");
    for (const scene_node *entry = child->kind == SCENE_MAP ? child->first : NULL; entry; entry = entry->next)
        take_path_value(r, entry->key, entry, value);
}

static void fill_axis(study_reader *r, const scene_node *node, int32_t a) {
    brunt_study_axis *axis = &r->study->axes[a];
    const scene_node *values = brunt_tree_child(node, "values"), *scale = brunt_tree_child(node, "scale");
    axis_keys keys = {.count = 0};
    read_keys(r, node, &keys);
    if (!values == !scale) {
        brunt_tree_complain_key(tree_of(r), node,
                                values ? "values and scale are both given, one of them is wanted"
                                       : "values are missing: a list or map of them, or scale");
        return;
    }
    if (values && (values->kind == SCENE_SCALAR || values->count == 0)) {
        brunt_tree_complain(tree_of(r), values, "a list of values or a map from labels to values is wanted");
        return;
    }
    if (scale && keys.count == 0) brunt_tree_complain_key(tree_of(r), scale, "a key is wanted: what is scaled?");
    for (int k = 0; k < keys.count; k++)
        if (scale && is_special(keys.node[k]->text))
            brunt_tree_complain(tree_of(r), keys.node[k], "'%s' has no number to be scaled", keys.node[k]->text);
    if (scale && !scale->good) return;
    r->values[a] = values ? values : scale;
    r->keyed[a] = keys.count > 0;
    axis->values = entries(r, r->values[a]->count, sizeof *axis->values);
    for (const scene_node *child = axis->values ? r->values[a]->first : NULL; child; child = child->next)
        fill_value(r, child, a, &keys, scale != NULL);
}

// Names first: any text may hold placeholders of any axis.
static void fill_axes(study_reader *r, const scene_node *map) {
    brunt_study *study = r->study;
    study->resolution = -1;
    if (!map || map->kind != SCENE_MAP) return;
    if (map->count > BRUNT_STUDY_AXES) {
        brunt_tree_complain_key(tree_of(r), map, "%d axes are given, at most %d are wanted", map->count,
                                BRUNT_STUDY_AXES);
        return;
    }
    for (const scene_node *child = map->first; child; child = child->next) {
        brunt_study_axis *axis = &study->axes[study->axis_count];
        copy_name(axis->name, sizeof axis->name, child->key);
        if (brunt_real_of(child, "role", 0) == BRUNT_STUDY_RESOLUTION) {
            axis->role = BRUNT_STUDY_RESOLUTION;
            if (study->resolution >= 0)
                brunt_tree_complain_key(tree_of(r), child, "%s is an axis of resolution already, one at most is wanted",
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
            brunt_tree_complain_key(tree_of(r), child,
                                    "nothing takes it: key or keys, or text that holds {%s}, is wanted", child->key);
    }
}

// ---------------------------------------------------------------------------------------------------- measures

static void fill_table(study_reader *r, const scene_node *node, brunt_study_measure *measure) {
    const scene_node *axis = brunt_tree_child(node, "axis"), *values = brunt_tree_child(node, "values");
    measure->reference = BRUNT_REFERENCE_TABLE;
    if (!axis || axis->kind != SCENE_SCALAR || !values || values->kind != SCENE_MAP || node->count != 2) {
        brunt_tree_complain(tree_of(r), node, "{axis: NAME, values: {LABEL: NUMBER, ...}} is wanted");
        return;
    }
    int32_t a = axis_named(r, axis, axis->text, false);
    if (a < 0) return;
    const brunt_study_axis *of = &r->study->axes[a];
    measure->table_axis = a;
    measure->table = entries(r, of->value_count, sizeof *measure->table);
    if (!measure->table) return;
    for (int32_t v = 0; v < of->value_count; v++) measure->table[v] = NAN;
    for (const scene_node *child = values->first; child; child = child->next) {
        int32_t v = value_labelled(r, child, a, child->key, true);
        double number = wanted_number(r, child);
        if (v >= 0) measure->table[v] = number;
    }
    for (int32_t v = 0; v < of->value_count; v++)
        if (!brunt_tree_child(values, of->values[v].label))
            brunt_tree_complain(tree_of(r), values, "the number of '%s' is missing", of->values[v].label);
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
        if (state == BAD_NUMBER) brunt_tree_complain(tree_of(r), node, "%s", why);
        if (state != NOT_ONE) return;
        const char *nearest = brunt_nearest_name(text, words, 3);
        brunt_tree_complain(tree_of(r), node,
                            "%s%s%sscene, finest, richardson, a number or {axis: NAME, values: {...}} "
                            "is wanted",
                            nearest ? "did you mean '" : "", nearest ? nearest : "", nearest ? "'? " : "");
    }
    if (measure->reference != BRUNT_REFERENCE_NUMBER && r->study->resolution < 0 && r->study->axis_count)
        brunt_tree_complain(tree_of(r), node, "an axis with role: resolution is wanted for it");
}

static void fill_measures(study_reader *r, const scene_node *map) {
    brunt_study *study = r->study;
    if (!map || map->kind != SCENE_MAP) return;
    if (map->count > BRUNT_STUDY_MEASURES) {
        brunt_tree_complain_key(tree_of(r), map, "%d measures are given, at most %d are wanted", map->count,
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
            brunt_tree_complain_key(tree_of(r), of, "it goes with reference: finest and reference: richardson");
        measure->scale = brunt_real_of(child, "scale", NAN);
        measure->order = brunt_real_of(child, "order", NAN);
    }
}

// ---------------------------------------------------------------------------------------------------- cases

static bool next_case(const brunt_study *study, int32_t value[BRUNT_STUDY_AXES]) {
    for (int32_t a = study->axis_count - 1; a >= 0; a--) {
        if (++value[a] < study->axes[a].value_count) return true;
        value[a] = 0;
    }
    return false;
}

typedef struct skip_rule {
    int32_t value[BRUNT_STUDY_AXES]; // -1: any
} skip_rule;

static int32_t read_skips(study_reader *r, const scene_node *list, skip_rule **rules) {
    *rules = NULL;
    if (!list) return 0;
    if (list->kind != SCENE_LIST) {
        brunt_tree_complain(tree_of(r), list, "a list of maps from axes to labels is wanted");
        return 0;
    }
    *rules = entries(r, list->count, sizeof **rules);
    int32_t count = 0;
    for (const scene_node *child = *rules ? list->first : NULL; child; child = child->next) {
        skip_rule rule;
        for (int32_t a = 0; a < BRUNT_STUDY_AXES; a++) rule.value[a] = -1;
        bool good = child->kind == SCENE_MAP && child->count;
        if (!good) brunt_tree_complain(tree_of(r), child, "a map from axes to labels is wanted");
        for (const scene_node *entry = good ? child->first : NULL; entry; entry = entry->next) {
            int32_t a = axis_named(r, entry, entry->key, true), v = -1;
            if (a >= 0 && entry->kind == SCENE_SCALAR) v = value_labelled(r, entry, a, entry->text, false);
            if (entry->kind != SCENE_SCALAR) brunt_tree_complain(tree_of(r), entry, "one label is wanted");
            if (v < 0)
                good = false;
            else
                rule.value[a] = v;
        }
        if (good) (*rules)[count++] = rule;
    }
    return count;
}

static bool skipped(const brunt_study *study, const int32_t *value, const skip_rule *rules, int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        bool all = true;
        for (int32_t a = 0; a < study->axis_count; a++) all &= rules[i].value[a] < 0 || rules[i].value[a] == value[a];
        if (all) return true;
    }
    return false;
}

static bool same_line(const brunt_study *study, const int32_t *x, const int32_t *y) {
    for (int32_t a = 0; a < study->axis_count; a++)
        if (a != study->resolution && x[a] != y[a]) return false;
    return true;
}

// "APIC, quadratic"; a label that begins with a digit has its axis before it: "FLIP, order = 2".
static void name_line(const brunt_study *study, const brunt_study_case *c, char *out, size_t size) {
    size_t used = 0;
    for (int32_t a = 0; a < study->axis_count && used + 1 < size; a++) {
        if (a == study->resolution) continue;
        const char *label = study->axes[a].values[c->value[a]].label;
        bool bare = !isdigit((unsigned char)*label);
        int wrote = snprintf(out + used, size - used, "%s%s%s%s", used ? ", " : "", bare ? "" : study->axes[a].name,
                             bare ? "" : " = ", label);
        used += wrote > 0 ? (size_t)wrote : 0;
    }
}

static void add_case(brunt_study *study, const int32_t *value) {
    brunt_study_case *c = &study->cases[study->case_count++];
    memcpy(c->value, value, sizeof c->value);
    c->wall_median = c->wall_least = c->wall_most = NAN;
    for (int32_t m = 0; m < BRUNT_STUDY_MEASURES; m++) c->result[m] = c->expect[m] = c->error[m] = NAN;
    for (const brunt_study_case *other = study->cases; other < c; other++)
        if (same_line(study, other->value, value)) {
            c->line = other->line;
            return;
        }
    c->line = study->line_count++;
    name_line(study, c, study->lines[c->line].label, sizeof study->lines[c->line].label);
}

static void make_cases(study_reader *r) {
    brunt_study *study = r->study;
    const scene_node *root = tree_of(r)->root;
    skip_rule *rules;
    int32_t rule_count = read_skips(r, brunt_tree_child(root, "skip"), &rules);
    double all = 1;
    for (int32_t a = 0; a < study->axis_count; a++) all *= study->axes[a].value_count;
    if (study->axis_count && all > CASE_LIMIT)
        brunt_tree_complain_key(tree_of(r), brunt_tree_child(root, "axes"), "%.0f cases, at most %d are wanted", all,
                                CASE_LIMIT);
    if (study->axis_count && all >= 1 && all <= CASE_LIMIT) {
        study->cases = entries(r, (int32_t)all, sizeof *study->cases);
        study->lines = entries(r, (int32_t)all, sizeof *study->lines);
        int32_t value[BRUNT_STUDY_AXES] = {0};
        bool more = study->cases && study->lines;
        for (; more; more = next_case(study, value))
            if (!skipped(study, value, rules, rule_count)) add_case(study, value);
        if (study->case_count < 2 && tree_of(r)->message_count == 0)
            brunt_tree_complain_key(tree_of(r), brunt_tree_child(root, "axes"),
                                    "%d case is left, at least two are wanted: an axis with two values",
                                    study->case_count);
    }
    for (int32_t c = 0; c < study->case_count; c++)
        study->cases[c].wall = entries(r, study->repeats, sizeof *study->cases[c].wall);
    brunt_free(rules);
}

static void check_methods_named(study_reader *r) {
    const brunt_study *study = r->study;
    const scene_node *measures = brunt_tree_child(tree_of(r)->root, "measures");
    const char *names[CHOICE_LIMIT];
    int count = 0;
    for (int32_t l = 0; l < study->line_count && count < CHOICE_LIMIT; l++)
        if (*study->lines[l].label) names[count++] = study->lines[l].label;
    for (int32_t m = 0; m < study->measure_count; m++) {
        const char *of = study->measures[m].of;
        bool limit = study->measures[m].reference == BRUNT_REFERENCE_RICHARDSON;
        bool found = !*of || !(limit || study->measures[m].reference == BRUNT_REFERENCE_FINEST);
        for (int i = 0; i < count; i++) found |= strcmp(names[i], of) == 0;
        for (int32_t a = 0; a < study->axis_count; a++)
            for (int32_t v = 0; a != study->resolution && v < study->axes[a].value_count; v++)
                found |= strcmp(study->axes[a].values[v].label, of) == 0;
        if (found) continue;
        complain_choice(r, brunt_tree_child(brunt_tree_child(measures, study->measures[m].name), "of"), "method", of,
                        names, count, false);
    }
}

// ---------------------------------------------------------------------------------------------------- their scenes

static const scene_node *child_number(const scene_node *node, int32_t index) {
    const scene_node *child = node ? node->first : NULL;
    for (; child && index > 0; index--) child = child->next;
    return child;
}

// The value in the study file that brought a set.
static const scene_node *place_of(study_reader *r, study_origin origin) {
    const scene_node *root = tree_of(r)->root;
    if (origin.axis < 0) return child_number(brunt_tree_child(root, "set"), origin.set);
    const scene_node *value = child_number(r->values[origin.axis], origin.value);
    if (r->keyed[origin.axis] || !value) return value;
    const scene_node *entry = value->first;
    for (int32_t s = origin.set; entry; entry = entry->next) {
        if (is_special(entry->key)) continue;
        if (s-- == 0) break;
    }
    return entry ? entry : value;
}

// Where the scene of a case is named: the last axis that gives one, else the study's own.
static const scene_node *place_of_scene(study_reader *r, const brunt_study_case *c) {
    for (int32_t a = r->study->axis_count - 1; a >= 0; a--) {
        const scene_node *value = child_number(r->values[a], c->value[a]);
        if (!*r->study->axes[a].values[c->value[a]].scene) continue;
        const scene_node *own = r->keyed[a] ? NULL : brunt_tree_child(value, "scene");
        return own ? own : value;
    }
    const scene_node *scene = brunt_tree_child(tree_of(r)->root, "scene");
    return scene ? scene : tree_of(r)->root;
}

typedef struct seen_list {
    char *text[SCENE_MESSAGE_LIMIT];
    const scene_node *at[SCENE_MESSAGE_LIMIT];
    int count;
} seen_list;

// True once for each mistake at a place, whichever cases bring it again.
static bool first_time(study_reader *r, seen_list *seen, const scene_node *at, const char *text) {
    for (int i = 0; i < seen->count; i++)
        if (seen->at[i] == at && strcmp(seen->text[i], text) == 0) return false;
    if (seen->count >= SCENE_MESSAGE_LIMIT) return true;
    seen->text[seen->count] = brunt_tree_text(tree_of(r), text, strlen(text));
    if (!seen->text[seen->count]) return false;
    seen->at[seen->count++] = at;
    return true;
}

static void report_line(study_reader *r, const brunt_study_case *c, const study_job *job, seen_list *seen,
                        const char *line) {
    char label[320];
    brunt_study_case_label(r->study, c, label);
    for (int32_t s = 0; strncmp(line, "--set ", 6) == 0 && s < job->set_count; s++) {
        size_t length = strlen(job->sets[s]);
        if (strncmp(line + 6, job->sets[s], length) != 0 || strncmp(line + 6 + length, ": ", 2) != 0) continue;
        const scene_node *at = place_of(r, job->origins[s]);
        const char *text = line + 6 + length + 2;
        if (at && first_time(r, seen, at, text)) brunt_tree_complain(tree_of(r), at, "in the scene: %s", text);
        return;
    }
    const scene_node *at = place_of_scene(r, c);
    if (first_time(r, seen, at, line)) brunt_tree_complain(tree_of(r), at, "with %s: %s", label, line);
}

static void check_measures(study_reader *r, const brunt_study_case *c, const brunt_scene *scene, seen_list *seen) {
    const brunt_study *study = r->study;
    const scene_node *map = brunt_tree_child(tree_of(r)->root, "measures");
    const char *names[CHOICE_LIMIT];
    int count = 0;
    for (int32_t i = 0; i < scene->measure_count && count < CHOICE_LIMIT; i++) names[count++] = scene->measures[i].name;
    for (int32_t m = 0; m < study->measure_count; m++) {
        const brunt_study_measure *measure = &study->measures[m];
        const brunt_measure *found = NULL;
        for (int32_t i = 0; i < scene->measure_count; i++)
            if (strcmp(scene->measures[i].name, measure->name) == 0) found = &scene->measures[i];
        const scene_node *at = brunt_tree_child(map, measure->name);
        char what[1100], label[320];
        snprintf(what, sizeof what, "measure in %.1000s:", scene->source);
        if (!found) {
            if (first_time(r, seen, at, what)) complain_choice(r, at, what, measure->name, names, count, true);
        } else if (measure->reference == BRUNT_REFERENCE_NUMBER && isnan(measure->exact) && isnan(found->expect)) {
            brunt_study_case_label(study, c, label);
            if (first_time(r, seen, at, "expect"))
                brunt_tree_complain_key(tree_of(r), at,
                                        "with %s the scene expects nothing of it: a reference is wanted", label);
        }
    }
}

static void check_case(study_reader *r, const brunt_study_case *c, seen_list *seen) {
    study_job job;
    study_origin culprit;
    brunt_error error = {0};
    int status = brunt_study_job(r->study, c, &job, &culprit, &error);
    const scene_node *at = status == BRUNT_BAD_INPUT ? place_of(r, culprit) : NULL;
    if (at && first_time(r, seen, at, error.message)) brunt_tree_complain(tree_of(r), at, "%s", error.message);
    if (status == BRUNT_FAILED) tree_of(r)->exhausted = true;
    char *text = NULL;
    size_t length = 0;
    FILE *messages = status ? NULL : open_memstream(&text, &length);
    if (messages) {
        brunt_scene scene;
        int read = brunt_scene_read(job.scene, (const char *const *)job.sets, job.set_count, &scene, messages);
        fclose(messages);
        for (char *line = text ? strtok(text, "\n") : NULL; line && read; line = strtok(NULL, "\n"))
            if (*line != ' ') report_line(r, c, &job, seen, line); // indented: the line of the scene, and a caret
        if (!read) check_measures(r, c, &scene, seen);
        if (!read) brunt_scene_free(&scene);
    }
    free(text);
    brunt_study_job_free(&job);
}

static void check_cases(study_reader *r) {
    const scene_node *root = tree_of(r)->root;
    for (int32_t c = 0; c < r->study->case_count; c++) {
        bool has_scene = *r->study->scene;
        for (int32_t a = 0; a < r->study->axis_count; a++)
            has_scene |= *r->study->axes[a].values[r->study->cases[c].value[a]].scene != 0;
        if (has_scene) continue;
        char label[320];
        brunt_study_case_label(r->study, &r->study->cases[c], label);
        brunt_tree_complain_key(tree_of(r), root, "'scene' is missing: with %s there is none", label);
        return;
    }
    seen_list *seen = brunt_tree_alloc(tree_of(r), sizeof *seen);
    if (!seen) return;
    seen->count = 0;
    for (int32_t c = 0; c < r->study->case_count; c++) check_case(r, &r->study->cases[c], seen);
}

// ---------------------------------------------------------------------------------------------------- the whole

static void fill_accuracies(study_reader *r, const scene_node *list) {
    static const double usual[] = {0.1, 0.03, 0.01};
    brunt_study *study = r->study;
    if (list && list->count > BRUNT_STUDY_ACCURACIES)
        brunt_tree_complain(tree_of(r), list, "%d are given, at most %d are wanted", list->count,
                            BRUNT_STUDY_ACCURACIES);
    for (const scene_node *child = list ? list->first : NULL; child; child = child->next)
        if (study->accuracy_count < BRUNT_STUDY_ACCURACIES)
            study->accuracies[study->accuracy_count++] = child->good ? child->value[0] : NAN;
    for (int i = 0; !list && i < 3; i++) study->accuracies[study->accuracy_count++] = usual[i];
}

static void read_study(study_reader *r) {
    brunt_study *study = r->study;
    scene_tree *tree = tree_of(r);
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
    make_cases(r);
    check_methods_named(r);
    // Values that are wrong by themselves would only be said twice.
    if (tree->message_count == 0) check_cases(r);
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
