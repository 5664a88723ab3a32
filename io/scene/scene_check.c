// The tree against the table of keys: every value gets its kind, unit and range checked, every missing one its default.
#include "io/scene/scene_value.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

enum { PARAMETER_ORDER = 32 };

static void check_value(scene_reader *reader, scene_node *node, const scene_key *row);
static void check_group(scene_reader *reader, scene_node *node, const char *pattern);

// ---------------------------------------------------------------------------------------------------- groups

// The model that a map of parameters belongs to: where its name is misspelt the one that is meant, so that what else is
// wrong there is said at once. NULL: it names none.
static const brunt_model *model_of(const scene_node *map, const char *path) {
    if (strncmp(path, "materials.*.viscosity.", 22) == 0) return &brunt_bulk_viscosity;
    const scene_node *name = brunt_tree_child(map, "model");
    if (!name || name->kind != SCENE_SCALAR) return NULL;
    const brunt_model *model = brunt_scene_model(path, name->text);
    const char *names[NAMES_LIMIT];
    int count;
    const brunt_model *const *models = brunt_scene_models(path, &count);
    for (int m = 0; m < count; m++) names[m] = models[m]->name;
    const char *meant = model ? NULL : brunt_nearest_name(name->text, names, count);
    return meant ? brunt_scene_model(path, meant) : model;
}

static const brunt_parameter *find_parameter(const brunt_model *model, const char *key) {
    for (int p = 0; p < model->parameter_count; p++)
        if (strcmp(model->parameters[p].key, key) == 0) return &model->parameters[p];
    return NULL;
}

// A failure model takes what it shares with the strength model from there.
static bool is_shared(const scene_node *map, const scene_key *slot, const char *key) {
    if (strncmp(slot->path, "materials.*.failure.", 20) != 0 || !map->parent) return false;
    // Its name may be typed, and checked, after `failure`.
    const brunt_model *strength = model_of(map->parent, "materials.*.<parameter>");
    return strength && find_parameter(strength, key);
}

static const scene_key *parameter_row(scene_reader *reader, const scene_key *slot, const brunt_parameter *parameter,
                                      bool shared) {
    scene_key *row = brunt_tree_alloc(reader->tree, sizeof *row);
    char path[128];
    snprintf(path, sizeof path, "%.*s%s", (int)(strlen(slot->path) - strlen("<parameter>")), slot->path,
             parameter->key);
    char *kept = brunt_tree_text(reader->tree, path, strlen(path));
    if (!row || !kept) return NULL;
    char initial[32] = ""; // what is shared stays open
    if (isinf(parameter->initial) && !shared)
        snprintf(initial, sizeof initial, "none");
    else if (!isnan(parameter->initial) && !shared)
        brunt_format_number(parameter->initial, initial);
    *row = (scene_key){.path = kept,
                       .type = SCENE_REAL,
                       .unit = parameter->unit,
                       .initial = shared                      ? ""
                                  : isnan(parameter->initial) ? NULL
                                                              : brunt_tree_text(reader->tree, initial, strlen(initial)),
                       .min = parameter->min,
                       .max = parameter->max,
                       .min_open = parameter->min_open,
                       .max_open = parameter->max_open,
                       .words = isinf(parameter->initial) ? "none" : NULL,
                       .doc = parameter->doc};
    return row;
}

// The children in the order of the table: the resolved scene then does not depend on how it was typed.
static void sort_children(scene_node *node) {
    scene_node *sorted = NULL, *last = NULL;
    for (scene_node *child = node->first, *next; child; child = next) {
        next = child->next;
        scene_node **at = last && last->order <= child->order ? &last->next : &sorted; // most are in order
        while (*at && (*at)->order <= child->order) at = &(*at)->next;
        child->next = *at;
        *at = child;
        if (!child->next) last = child;
    }
    node->first = sorted;
    node->last = last;
}

scene_node *brunt_add_default(scene_reader *reader, scene_node *map, const char *key, const char *text) {
    char path[256];
    const scene_format *format = reader->tree->format;
    const scene_key *row = NULL;
    if (map->row) {
        bool entry = map->parent && map->parent->row && map->parent->row == map->row;
        snprintf(path, sizeof path, "%s%s.%s", map->row->path,
                 !entry                          ? ""
                 : map->row->type == SCENE_NAMED ? ".*"
                                                 : "[]",
                 key);
        row = brunt_format_row(format, path);
    } else {
        row = brunt_format_row(format, key);
    }
    if (!row) return NULL;
    scene_node *node = NULL;
    bool vector = row->type == SCENE_VECTOR || row->type == SCENE_PARTIAL;
    if (vector || *text == '[' || *text == '{') {
        node = brunt_tree_node(reader->tree, *text == '{' ? SCENE_MAP : SCENE_LIST);
        int count = vector ? (reader->dimension ? reader->dimension : 3) : *text == '[' ? 1 : 0;
        for (int i = 0; node && i < count; i++) {
            scene_node *child = brunt_tree_node(reader->tree, SCENE_SCALAR);
            if (!child) return NULL;
            child->text = vector ? brunt_tree_text(reader->tree, text, strlen(text))
                                 : brunt_tree_text(reader->tree, text + 1, strlen(text) - 2);
            if (!child->text) return NULL;
            brunt_tree_append(node, child);
        }
    } else {
        node = brunt_tree_node(reader->tree, SCENE_SCALAR);
        if (node)
            node->text = brunt_tree_text(reader->tree, strcmp(text, "''") == 0 ? "" : text,
                                         strcmp(text, "''") == 0 ? 0 : strlen(text));
        if (node && !node->text) return NULL;
    }
    if (!node || !(node->key = brunt_tree_text(reader->tree, key, strlen(key)))) return NULL;
    brunt_tree_append(map, node);
    check_value(reader, node, row);
    node->order = (int)(row - format->rows) * PARAMETER_ORDER;
    sort_children(map);
    return node;
}

static void complain_unknown(scene_reader *reader, scene_node *child, const char *pattern, const char *const *known,
                             int count, const brunt_model *model) {
    scene_tree *tree = reader->tree;
    const char *nearest = brunt_nearest_name(child->key, known, count);
    if (model) {
        // A parameter of another model of the same kind says more than a likeness.
        char path[128];
        snprintf(path, sizeof path, "%s.<parameter>", pattern);
        int models;
        const brunt_model *const *list = brunt_scene_models(path, &models);
        for (int m = 0; m < models && !nearest; m++)
            if (find_parameter(list[m], child->key)) {
                brunt_tree_complain_key(tree, child, "this is a parameter of %s, not of %s", list[m]->name,
                                        model->name);
                return;
            }
    }
    // Shapes are few, and a cube is no tube: all are said.
    if (nearest && strcmp(pattern, "<shape>") != 0) {
        brunt_tree_complain_key(tree, child, "unknown key, did you mean '%s'?", nearest);
        return;
    }
    char all[1200];
    brunt_list_names(known, count, all, sizeof all);
    brunt_tree_complain_key(tree, child, "unknown key; there are: %s", all);
}

static bool alike(const brunt_parameter *a, const brunt_parameter *b) {
    return a->min == b->min && a->max == b->max && a->min_open == b->min_open && a->max_open == b->max_open &&
           strcmp(a->unit, b->unit) == 0;
}

// Of a map whose model is not known: what all models that have the key say of its value.
static void check_of_any(scene_reader *reader, scene_node *child, const scene_key *slot, const char *const *known,
                         int count) {
    const brunt_parameter *found = NULL;
    int models;
    bool same = true;
    const brunt_model *const *list = brunt_scene_models(slot->path, &models);
    for (int m = 0; m < models; m++) {
        const brunt_parameter *parameter = find_parameter(list[m], child->key);
        same = same && (!parameter || !found || alike(parameter, found));
        if (parameter && !found) found = parameter;
    }
    const scene_key *row = found && same ? parameter_row(reader, slot, found, true) : NULL;
    if (row) check_value(reader, child, row);
    if (!found) complain_unknown(reader, child, "", known, count, NULL);
}

typedef struct group_rows {
    const scene_key *row[NAMES_LIMIT];
    const char *key[NAMES_LIMIT];
    int order[NAMES_LIMIT];
    int count;
    const brunt_model *model;
    const scene_key *unknown; // parameters of a model that is not known; NULL: there are none
} group_rows;

static void collect_rows(scene_reader *reader, const scene_node *node, const char *pattern, group_rows *rows) {
    rows->count = 0;
    rows->model = NULL;
    rows->unknown = NULL;
    const scene_format *format = reader->tree->format;
    for (int i = 0; i < *format->row_count; i++) {
        const scene_key *row = &format->rows[i];
        const char *key = brunt_scene_child_key(row, pattern);
        if (!key || rows->count >= NAMES_LIMIT) continue;
        if (row->dimension && reader->dimension && row->dimension != reader->dimension) continue;
        if (row->type == SCENE_PARAMETERS) {
            rows->model = model_of(node, row->path);
            if (!rows->model) rows->unknown = row;
            for (int p = 0; rows->model && p < rows->model->parameter_count && rows->count < NAMES_LIMIT; p++) {
                const scene_key *made = parameter_row(reader, row, &rows->model->parameters[p],
                                                      is_shared(node, row, rows->model->parameters[p].key));
                if (!made) return;
                rows->row[rows->count] = made;
                rows->key[rows->count] = rows->model->parameters[p].key;
                rows->order[rows->count++] = i * PARAMETER_ORDER + p;
            }
            continue;
        }
        rows->row[rows->count] = row;
        rows->key[rows->count] = key;
        rows->order[rows->count++] = i * PARAMETER_ORDER;
    }
}

// An override may make an entry where another was meant: the name among the file's own that is like it, NULL for none.
static const char *meant_instead(const scene_node *node) {
    const char *names[NAMES_LIMIT];
    int count = 0;
    if (!node->option || !node->key || !node->parent || node->parent->kind != SCENE_MAP) return NULL;
    for (const scene_node *other = node->parent->first; other && count < NAMES_LIMIT; other = other->next)
        if (other != node && other->key && !other->option) names[count++] = other->key;
    return brunt_nearest_name(node->key, names, count);
}

static void add_missing(scene_reader *reader, scene_node *node, const group_rows *rows, int r) {
    const scene_key *row = rows->row[r];
    if (brunt_tree_child(node, "preset") || (node->parent && brunt_tree_child(node->parent, "preset")))
        return; // one that is unknown: what it would have brought is not missed
    if (!row->initial) {
        char want[160] = "";
        const char *meant = meant_instead(node);
        if (meant) { // said once, however much is missing: the same message at one place counts once
            brunt_tree_complain_key(reader->tree, node, "there is no '%s', did you mean '%s'?", node->key, meant);
            return;
        }
        if (row->type == SCENE_REAL || row->type == SCENE_VECTOR) {
            brunt_units_describe(reader->units, row->unit, want, sizeof want);
            brunt_tree_complain_key(reader->tree, node, "'%s' is missing: %s, %s", rows->key[r], want, row->doc);
        } else {
            brunt_tree_complain_key(reader->tree, node, "'%s' is missing: %s", rows->key[r], row->doc);
        }
        return;
    }
    if (!*row->initial || row->depends || row->only) return;
    if (brunt_format_row(reader->tree->format, row->path) == row) {
        brunt_add_default(reader, node, rows->key[r], row->initial);
        return;
    }
    scene_node *child = brunt_tree_node(reader->tree, SCENE_SCALAR);
    if (!child || !(child->key = brunt_tree_text(reader->tree, rows->key[r], strlen(rows->key[r])))) return;
    child->text = (char *)row->initial;
    brunt_tree_append(node, child);
    check_value(reader, child, row);
    child->order = rows->order[r];
}

// A key in its former spelling becomes that of today, with a warning; in both it is a mistake.
static void rename_former(scene_reader *reader, scene_node *node, const group_rows *rows) {
    for (int r = 0; r < rows->count; r++) {
        const char *former = rows->row[r]->former;
        scene_node *child = former ? brunt_tree_child(node, former) : NULL;
        if (!child) continue;
        if (brunt_tree_child(node, rows->key[r])) {
            brunt_tree_complain_key(reader->tree, child, "this is the former name of '%s', one of them is wanted",
                                    rows->key[r]);
            brunt_tree_remove(child);
            continue;
        }
        brunt_scene_warn_at(reader, child, true, "the name is now '%s', this one goes with the next version",
                            rows->key[r]);
        char *key = brunt_tree_text(reader->tree, rows->key[r], strlen(rows->key[r]));
        if (key) brunt_tree_rename(child, key);
    }
}

static void check_group(scene_reader *reader, scene_node *node, const char *pattern) {
    group_rows rows;
    if (node->kind != SCENE_MAP) {
        group_rows known;
        collect_rows(reader, node, pattern, &known);
        char all[1200];
        brunt_list_names(known.key, known.count, all, sizeof all);
        brunt_tree_complain(reader->tree, node, "%s is given, a map is wanted with: %s", brunt_kind_name(node), all);
        return;
    }
    node->good = true;
    collect_rows(reader, node, pattern, &rows);
    rename_former(reader, node, &rows);
    bool found[NAMES_LIMIT] = {false};
    for (scene_node *child = node->first; child; child = child->next) {
        int r = 0;
        while (r < rows.count && strcmp(rows.key[r], child->key) != 0) r++;
        if (r < rows.count) {
            found[r] = true;
            child->order = rows.order[r];
            check_value(reader, child, rows.row[r]);
            continue;
        }
        char path[256];
        snprintf(path, sizeof path, "%s%s%.100s", pattern, *pattern ? "." : "", child->key);
        const scene_key *other = brunt_format_row(reader->tree->format, path);
        if (other && other->dimension)
            brunt_tree_complain_key(reader->tree, child, "there is none in %d dimensions", reader->dimension);
        else if (rows.unknown)
            check_of_any(reader, child, rows.unknown, rows.key, rows.count);
        else
            complain_unknown(reader, child, pattern, rows.key, rows.count, rows.model);
    }
    for (int r = 0; r < rows.count; r++)
        if (!found[r]) add_missing(reader, node, &rows, r);
    sort_children(node);
}

static void check_shape(scene_reader *reader, scene_node *node) {
    int mistakes = reader->tree->message_count;
    check_group(reader, node, "<shape>");
    if (node->kind == SCENE_MAP && node->count != 1)
        brunt_tree_complain(reader->tree, node, "%d shapes are given, exactly one is wanted (a union takes several)",
                            node->count);
    // Good all through: what has a mistake anywhere in it is not measured.
    node->good = mistakes == reader->tree->message_count;
}

static void check_named(scene_reader *reader, scene_node *node, const scene_key *row) {
    if (node->kind != SCENE_MAP) {
        brunt_tree_complain(reader->tree, node, "%s is given, a map of names is wanted: %s", brunt_kind_name(node),
                            row->doc);
        return;
    }
    if (node->count == 0 && !row->initial) {
        brunt_tree_complain(reader->tree, node, "there are none, at least one is wanted");
        return;
    }
    node->good = true;
    char pattern[128];
    snprintf(pattern, sizeof pattern, "%s.*", row->path);
    for (scene_node *child = node->first; child; child = child->next) {
        child->row = row;
        brunt_check_name(reader, child, child->key, true);
        check_group(reader, child, pattern);
    }
}

static void check_entries(scene_reader *reader, scene_node *node, const scene_key *row) {
    if (node->kind != SCENE_LIST) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list is wanted (entries start with '-'): %s",
                            brunt_kind_name(node), row->doc);
        return;
    }
    node->good = true;
    char pattern[128];
    snprintf(pattern, sizeof pattern, "%s[]", row->path);
    for (scene_node *child = node->first; child; child = child->next) {
        child->row = row;
        check_group(reader, child, pattern);
    }
}

static void check_shapes(scene_reader *reader, scene_node *node) {
    if (node->kind != SCENE_LIST || node->count == 0) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of shapes is wanted",
                            node->kind == SCENE_LIST ? "an empty list" : brunt_kind_name(node));
        return;
    }
    node->good = true;
    for (scene_node *child = node->first; child; child = child->next) {
        child->row = node->row;
        check_shape(reader, child);
        node->good &= child->good;
    }
}

static void check_value(scene_reader *reader, scene_node *node, const scene_key *row) {
    node->row = row;
    node->good = false;
    switch (row->type) {
    case SCENE_GROUP: check_group(reader, node, row->path); break;
    case SCENE_NAMED: check_named(reader, node, row); break;
    case SCENE_ENTRIES: check_entries(reader, node, row); break;
    case SCENE_WORD:
        if (node->kind == SCENE_MAP && brunt_scene_word_or_map(row))
            check_group(reader, node, row->path);
        else
            brunt_check_single_value(reader, node, row);
        break;
    case SCENE_SHAPE: check_shape(reader, node); break;
    case SCENE_SHAPES: check_shapes(reader, node); break;
    default: brunt_check_single_value(reader, node, row); break;
    }
}

void brunt_check_keys(scene_reader *reader) { check_group(reader, reader->tree->root, ""); }

// As the number that it is: 2.0 is 2. 0: neither 2 nor 3, which the check of numbers says.
static int dimension_of(const char *text) {
    double value;
    const char *rest;
    text += strspn(text, " ");
    if (brunt_read_number(text, &value, &rest) || rest[strspn(rest, " \t\n")]) return 0;
    return value == 2 ? 2 : value == 3 ? 3 : 0;
}

void brunt_check_scene(scene_reader *reader) {
    // The lengths of all vectors hang on the dimension, so it is looked at before anything else.
    scene_node *root = reader->tree->root, *dimension = brunt_tree_child(root, "dimension");
    reader->dimension = dimension ? 0 : 3;
    if (dimension && dimension->kind == SCENE_SCALAR) reader->dimension = dimension_of(dimension->text);
    brunt_expand_presets(reader);
    brunt_check_keys(reader);
}

// ---------------------------------------------------------------------------------------------------- accepted values

bool brunt_read_parameters(const scene_node *map, const brunt_model *model, double *parameters) {
    bool good = true;
    for (int p = 0; p < model->parameter_count && p < BRUNT_PARAMETER_LIMIT; p++) {
        parameters[p] = brunt_real_of(map, model->parameters[p].key, NAN);
        const double initial = model->parameters[p].initial; // the word `none` is infinity of its sign
        if (isinf(parameters[p]) && isinf(initial)) parameters[p] = initial;
        good &= !isnan(parameters[p]);
    }
    return good;
}

double brunt_real_of(const scene_node *map, const char *key, double fallback) {
    const scene_node *node = brunt_tree_child(map, key);
    return node && node->good && node->kind == SCENE_SCALAR ? node->value[0] : fallback;
}

const char *brunt_text_of(const scene_node *map, const char *key, const char *fallback) {
    const scene_node *node = brunt_tree_child(map, key);
    return node && node->good && node->kind == SCENE_SCALAR && node->text ? node->text : fallback;
}

bool brunt_vector_of(const scene_node *map, const char *key, double out[3]) {
    const scene_node *node = brunt_tree_child(map, key);
    if (!node || !node->good || node->components < 2) return false;
    for (int c = 0; c < 3; c++) out[c] = node->value[c];
    return true;
}
