// The tree against the table of keys: every value gets its kind, unit and range checked, every missing one its default.
#include "io/scene/scene_reader.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

enum { NAMES_LIMIT = 128, PARAMETER_ORDER = 32 };

static void check_value(scene_reader *reader, scene_node *node, const scene_key *row);
static void check_group(scene_reader *reader, scene_node *node, const char *pattern);

static const char *kind_name(const scene_node *node) {
    switch (node->kind) {
    case SCENE_MAP: return "a map";
    case SCENE_LIST: return "a list";
    default: return node->text && (*node->text || !node->plain) ? "a single value" : "nothing";
    }
}

static bool usable_name(const char *name) {
    size_t length = strlen(name);
    if (length == 0) return false;
    for (size_t i = 0; i < length; i++)
        if (!isalnum((unsigned char)name[i]) && name[i] != '_' && name[i] != '-') return false;
    return true;
}

static bool check_name(scene_reader *reader, const scene_node *node, const char *name, bool at_key) {
    void (*complain)(scene_tree *, const scene_node *, const char *, ...) =
        at_key ? brunt_tree_complain_key : brunt_tree_complain;
    if (!usable_name(name)) {
        complain(reader->tree, node, "'%.60s' is not a name: letters, digits, _ and - are wanted", name);
        return false;
    }
    if (strlen(name) >= BRUNT_NAME_LENGTH) {
        complain(reader->tree, node, "the name is too long: at most %d characters are wanted", BRUNT_NAME_LENGTH - 1);
        return false;
    }
    return true;
}

// ---------------------------------------------------------------------------------------------------- numbers

static void describe_range(const scene_key *row, char *out, size_t size) {
    char low[32], high[32];
    brunt_format_number(row->min, low);
    brunt_format_number(row->max, high);
    if (isinf(row->max))
        snprintf(out, size, "%s %s", row->min_open ? ">" : ">=", low);
    else if (isinf(row->min))
        snprintf(out, size, "%s %s", row->max_open ? "<" : "<=", high);
    else if (row->min == row->max)
        snprintf(out, size, "%s", low);
    else
        snprintf(out, size, "a value %s %s and %s %s", row->min_open ? ">" : ">=", low,
                 row->max_open ? "<" : "<=", high);
}

static bool within(const scene_key *row, double value) {
    bool low = isinf(row->min) || (row->min_open ? value > row->min : value >= row->min);
    bool high = isinf(row->max) || (row->max_open ? value < row->max : value <= row->max);
    return low && high;
}

static void wanted(scene_reader *reader, const scene_key *row, char *out, size_t size) {
    if (row->type == SCENE_INTEGER)
        snprintf(out, size, "a whole number");
    else if (row->type == SCENE_ANY_UNIT || !row->unit)
        snprintf(out, size, "a number");
    else
        brunt_units_describe(reader->units, row->unit, out, size);
}

// One number with its unit. Writes to value[0] of the node.
static bool check_number(scene_reader *reader, scene_node *node, const scene_key *row) {
    scene_tree *tree = reader->tree;
    char want[128], why[320];
    node->row = row;
    node->good = false;
    if (node->kind != SCENE_SCALAR || (node->plain && !*node->text)) {
        wanted(reader, row, want, sizeof want);
        brunt_tree_complain(tree, node, "%s is given, %s is wanted", kind_name(node), want);
        return false;
    }
    if (row->words && row->type != SCENE_WORD && strcmp(node->text, row->words) == 0) {
        node->value[0] = INFINITY;
        return node->good = true;
    }
    const char *text = node->text, *rest;
    while (*text == ' ') text++;
    double value;
    const char *wrong = brunt_read_number(text, &value, &rest);
    if (wrong) {
        wanted(reader, row, want, sizeof want);
        brunt_tree_complain(tree, node, "'%.60s' is %s, %s is wanted%s%s%s", node->text, wrong, want,
                            row->words ? " (or the word '" : "", row->words ? row->words : "", row->words ? "')" : "");
        return false;
    }
    while (*rest == ' ' || *rest == '\t') rest++;
    size_t length = strlen(rest);
    while (length && (rest[length - 1] == ' ' || rest[length - 1] == '\n')) length--;
    char unit[160];
    snprintf(unit, sizeof unit, "%.*s", (int)length, rest);
    node->base = "1";
    if (*unit) {
        bool converted = false;
        if (row->type == SCENE_INTEGER) {
            snprintf(why, sizeof why, "'%.60s' is not a whole number without unit", node->text);
        } else if (row->type == SCENE_ANY_UNIT) {
            char base[BRUNT_UNIT_LENGTH];
            converted = brunt_units_to_si(reader->units, unit, &value, base, why, sizeof why);
            if (converted && !(node->base = brunt_tree_text(tree, base, strlen(base)))) return false;
        } else {
            converted = brunt_units_convert(reader->units, unit, row->unit ? row->unit : "1", &value, why, sizeof why);
        }
        if (!converted) {
            brunt_tree_complain(tree, node, "%s", why);
            return false;
        }
    }
    if (row->type == SCENE_INTEGER && (value != floor(value) || fabs(value) > 9007199254740992.0)) {
        brunt_tree_complain(tree, node, "'%.60s' is not a whole number", node->text);
        return false;
    }
    if (!within(row, value)) {
        describe_range(row, want, sizeof want);
        brunt_tree_complain(tree, node, "'%.60s' is out of range, %s is wanted", node->text, want);
        return false;
    }
    if (!brunt_usable_number(value, row->min == 0 && row->min_open, why, sizeof why)) {
        brunt_tree_complain(tree, node, "'%.60s' is %s", node->text, why);
        return false;
    }
    node->value[0] = value;
    node->number = true;
    return node->good = true;
}

static void check_components(scene_reader *reader, scene_node *node, const scene_key *row, int wanted_count) {
    char want[128];
    wanted(reader, row, want, sizeof want);
    node->row = row;
    if (node->kind != SCENE_LIST) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of %d numbers is wanted: [%s] each %s",
                            kind_name(node), wanted_count ? wanted_count : 3, wanted_count == 2 ? "x, y" : "x, y, z",
                            want);
        return;
    }
    bool unknown = wanted_count == 0; // the dimension itself is wrong: both lengths pass
    if (unknown ? node->count != 2 && node->count != 3 : node->count != wanted_count) {
        brunt_tree_complain(reader->tree, node, "%d component%s given, %d are wanted%s", node->count,
                            node->count == 1 ? " is" : "s are", unknown ? 3 : wanted_count,
                            row->type == SCENE_POLYGON ? ""
                            : wanted_count == 2        ? " in 2 dimensions"
                                                       : " in 3 dimensions");
        return;
    }
    bool good = true;
    int c = 0;
    for (scene_node *child = node->first; child; child = child->next, c++) {
        if (row->type == SCENE_PARTIAL && child->kind == SCENE_SCALAR && strcmp(child->text, "free") == 0) {
            node->free[c] = true;
            child->good = true;
            continue;
        }
        good &= check_number(reader, child, row);
        node->value[c] = child->value[0];
    }
    node->components = c;
    node->good = good;
}

static void check_polygon(scene_reader *reader, scene_node *node, const scene_key *row) {
    if (node->kind != SCENE_LIST) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of points [[x, y], ...] is wanted",
                            kind_name(node));
        return;
    }
    node->good = true;
    for (scene_node *child = node->first; child; child = child->next) {
        check_components(reader, child, row, 2);
        node->good &= child->good;
    }
}

// Points over ascending times, of a table factors, of a curve numbers with any unit; over places for a profile, which
// may jump.
static void check_table(scene_reader *reader, scene_node *node) {
    static const scene_key time = {.type = SCENE_REAL, .unit = "s", .min = -INFINITY, .max = INFINITY},
                           factor = {.type = SCENE_REAL, .unit = "1", .min = -INFINITY, .max = INFINITY},
                           place = {.type = SCENE_REAL, .unit = "m", .min = -INFINITY, .max = INFINITY},
                           any = {.type = SCENE_ANY_UNIT, .unit = "any", .min = -INFINITY, .max = INFINITY};
    bool profile = node->row->type == SCENE_PROFILE, curve = node->row->type == SCENE_CURVE || profile;
    const char *point = profile ? "[coordinate, value]" : curve ? "[time, value]" : "[time, factor]";
    if (node->kind != SCENE_LIST || node->count == 0) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of points [%s, ...] is wanted",
                            node->kind == SCENE_LIST ? "an empty list" : kind_name(node), point);
        return;
    }
    node->good = true;
    const scene_node *before = NULL;
    for (scene_node *child = node->first; child; child = child->next) {
        child->row = node->row;
        if (child->kind != SCENE_LIST || child->count != 2) {
            brunt_tree_complain(reader->tree, child, "%s is wanted: a %s and a %s", point,
                                profile ? "length (m)" : "time (s)", curve ? "number" : "pure number");
            node->good = false;
            continue;
        }
        bool timed = check_number(reader, child->first, profile ? &place : &time),
             good = check_number(reader, child->last, curve ? &any : &factor);
        child->good = timed && good;
        node->good &= child->good;
        if (timed && before &&
            !(profile ? child->first->value[0] >= before->value[0] : child->first->value[0] > before->value[0])) {
            brunt_tree_complain(reader->tree, child->first,
                                profile ? "the coordinates must not descend" : "the times must ascend");
            node->good = false;
        }
        if (timed) before = child->first;
    }
}

// ---------------------------------------------------------------------------------------------------- words

static void list_names(const char *const *names, int count, char *out, size_t size) {
    size_t used = 0;
    out[0] = 0;
    for (int i = 0; i < count && used + 4 < size; i++) {
        int wrote = snprintf(out + used, size - used, "%s%s", i ? ", " : "", names[i]);
        used += wrote > 0 ? (size_t)wrote : 0;
    }
}

// Says that `name` is none of the names, with the nearest one or else all of them.
static void complain_choice(scene_reader *reader, const scene_node *node, const char *name, const char *const *names,
                            int count) {
    char all[1200];
    const char *nearest = brunt_nearest_name(name, names, count);
    list_names(names, count, all, sizeof all);
    if (nearest)
        brunt_tree_complain(reader->tree, node, "'%.60s' is unknown, did you mean '%s'? Available: %s", name, nearest,
                            all);
    else
        brunt_tree_complain(reader->tree, node, "'%.60s' is not available. Available: %s", name, all);
}

static int model_names(const char *path, const char **names) {
    int count, n = 0;
    char parent[64];
    if (strcmp(path, "materials.*.preset") == 0) {
        for (; n < brunt_preset_count() && n < NAMES_LIMIT; n++) names[n] = brunt_preset(n).name;
        return n;
    }
    // "materials.*.eos.model" to the path of its parameters
    snprintf(parent, sizeof parent, "%.*s<parameter>", (int)(strlen(path) - strlen("model")), path);
    const brunt_model *const *models = brunt_scene_models(parent, &count);
    for (; n < count && n < NAMES_LIMIT; n++) names[n] = models[n]->name;
    return n;
}

static void check_word(scene_reader *reader, scene_node *node, const scene_key *row) {
    const char *names[NAMES_LIMIT];
    char words[NAMES_LIMIT][64];
    int count = 0, index = 0;
    if (row->words) {
        while (count < NAMES_LIMIT && brunt_scene_word_at(row->words, count, words[count], sizeof words[count])) {
            names[count] = words[count];
            count++;
        }
    } else {
        count = model_names(row->path, names);
    }
    if (node->kind != SCENE_SCALAR || !*node->text) {
        char all[1200];
        list_names(names, count, all, sizeof all);
        brunt_tree_complain(reader->tree, node, "%s is given, one of these is wanted: %s", kind_name(node), all);
        return;
    }
    if (row->words) {
        node->good = brunt_scene_word(row->words, node->text, &index);
        if (node->good) {
            node->text = brunt_tree_text(reader->tree, names[index], strlen(names[index]));
            node->value[0] = index;
            if (!node->text) node->good = false;
            return;
        }
    } else if (strcmp(row->path, "materials.*.preset") != 0) {
        // Spellings that the list itself accepts (mie-grueneisen) count.
        const brunt_model *model = brunt_scene_model(row->path, node->text);
        if (model) {
            node->text = brunt_tree_text(reader->tree, model->name, strlen(model->name));
            node->good = node->text != NULL;
            return;
        }
    }
    complain_choice(reader, node, node->text, names, count);
}

static void check_text(scene_reader *reader, scene_node *node, const scene_key *row) {
    if (node->kind != SCENE_SCALAR) {
        brunt_tree_complain(reader->tree, node, "%s is given, %s is wanted", kind_name(node),
                            row->type == SCENE_TEXT ? "text" : "a name");
        return;
    }
    node->good = row->type == SCENE_TEXT || check_name(reader, node, node->text, false);
}

static void check_names(scene_reader *reader, scene_node *node, const scene_key *row) {
    if (node->kind != SCENE_LIST) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of names is wanted", kind_name(node));
        return;
    }
    node->good = true;
    static const scene_key entry = {.type = SCENE_NAME};
    const bool pair = strcmp(row->path, "contact.pairs[].between") == 0; // a membrane may meet itself
    for (scene_node *child = node->first; child; child = child->next) {
        child->row = row;
        check_text(reader, child, &entry);
        for (scene_node *other = node->first; other != child; other = other->next) {
            if (pair || !child->good || !other->good || strcmp(other->text, child->text) != 0) continue;
            brunt_tree_complain(reader->tree, child, "'%s' is there twice", child->text);
            child->good = false;
        }
        node->good &= child->good;
    }
}

static void check_reals(scene_reader *reader, scene_node *node, const scene_key *row) {
    char want[128];
    wanted(reader, row, want, sizeof want);
    if (node->kind != SCENE_LIST || node->count == 0) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of numbers is wanted: each %s",
                            node->kind == SCENE_LIST ? "an empty list" : kind_name(node), want);
        return;
    }
    node->good = true;
    for (scene_node *child = node->first; child; child = child->next) node->good &= check_number(reader, child, row);
}

// Which axes: value[c] is 1 for those that are meant.
static void check_axes(scene_reader *reader, scene_node *node) {
    static const char *const axes[] = {"x", "y", "z"};
    int dimension = reader->dimension ? reader->dimension : 3;
    bool all = node->kind == SCENE_SCALAR && strcmp(node->text, "all") == 0;
    if (!all && (node->kind != SCENE_LIST || node->count == 0)) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of axes like [x, %s] or the word `all` is wanted",
                            node->kind == SCENE_LIST ? "an empty list" : kind_name(node), axes[dimension - 1]);
        return;
    }
    node->good = true;
    for (int c = 0; all && c < dimension; c++) node->value[c] = 1;
    for (scene_node *child = node->first; child; child = child->next) {
        int axis = -1;
        for (int c = 0; c < dimension && child->kind == SCENE_SCALAR; c++)
            if (strcmp(child->text, axes[c]) == 0) axis = c;
        child->row = node->row;
        child->good = axis >= 0 && node->value[axis] == 0;
        node->good &= child->good;
        if (child->kind != SCENE_SCALAR)
            brunt_tree_complain(reader->tree, child, "%s is given, one of the axes is wanted", kind_name(child));
        else if (axis < 0)
            complain_choice(reader, child, child->text, axes, dimension);
        else if (!child->good)
            brunt_tree_complain(reader->tree, child, "'%s' is there twice", child->text);
        else
            node->value[axis] = 1;
    }
}

// ---------------------------------------------------------------------------------------------------- groups

// The model that a map of parameters belongs to, NULL when it names none that exists.
static const brunt_model *model_of(const scene_node *map, const char *path) {
    if (strncmp(path, "materials.*.viscosity.", 22) == 0) return &brunt_bulk_viscosity;
    const scene_node *name = brunt_tree_child(map, "model");
    if (!name || name->kind != SCENE_SCALAR) return NULL;
    return brunt_scene_model(path, name->text);
}

// A failure model takes what it shares with the strength model from there.
static bool is_shared(const scene_node *map, const scene_key *slot, const char *key) {
    if (strncmp(slot->path, "materials.*.failure.", 20) != 0 || !map->parent) return false;
    const scene_node *name = brunt_tree_child(map->parent, "model"); // which may be typed, and checked, after `failure`
    if (!name || name->kind != SCENE_SCALAR) return false;
    const brunt_model *strength = brunt_find_strength(name->text);
    for (int p = 0; strength && p < strength->parameter_count; p++)
        if (strcmp(strength->parameters[p].key, key) == 0) return true;
    return false;
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
    scene_node *sorted = NULL;
    for (scene_node *child = node->first, *next; child; child = next) {
        next = child->next;
        scene_node **at = &sorted;
        while (*at && (*at)->order <= child->order) at = &(*at)->next;
        child->next = *at;
        *at = child;
    }
    node->first = sorted;
    node->last = NULL;
    for (scene_node *child = sorted; child; child = child->next) node->last = child;
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
            for (int p = 0; p < list[m]->parameter_count; p++)
                if (strcmp(list[m]->parameters[p].key, child->key) == 0) {
                    brunt_tree_complain_key(tree, child, "this is a parameter of %s, not of %s", list[m]->name,
                                            model->name);
                    return;
                }
    }
    if (nearest) {
        brunt_tree_complain_key(tree, child, "unknown key, did you mean '%s'?", nearest);
        return;
    }
    char all[1200];
    list_names(known, count, all, sizeof all);
    brunt_tree_complain_key(tree, child, "unknown key; there are: %s", all);
}

typedef struct group_rows {
    const scene_key *row[NAMES_LIMIT];
    const char *key[NAMES_LIMIT];
    int order[NAMES_LIMIT];
    int count;
    const brunt_model *model;
    bool model_unknown;
} group_rows;

static void collect_rows(scene_reader *reader, const scene_node *node, const char *pattern, group_rows *rows) {
    rows->count = 0;
    rows->model = NULL;
    rows->model_unknown = false;
    const scene_format *format = reader->tree->format;
    for (int i = 0; i < *format->row_count; i++) {
        const scene_key *row = &format->rows[i];
        const char *key = brunt_scene_child_key(row, pattern);
        if (!key || rows->count >= NAMES_LIMIT) continue;
        if (row->dimension && reader->dimension && row->dimension != reader->dimension) continue;
        if (row->type == SCENE_PARAMETERS) {
            rows->model = model_of(node, row->path);
            rows->model_unknown = !rows->model;
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
    if (!*row->initial || row->depends) return;
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

static void check_group(scene_reader *reader, scene_node *node, const char *pattern) {
    group_rows rows;
    if (node->kind != SCENE_MAP) {
        group_rows known;
        collect_rows(reader, node, pattern, &known);
        char all[1200];
        list_names(known.key, known.count, all, sizeof all);
        brunt_tree_complain(reader->tree, node, "%s is given, a map is wanted with: %s", kind_name(node), all);
        return;
    }
    node->good = true;
    collect_rows(reader, node, pattern, &rows);
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
        else if (!rows.model_unknown)
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
        brunt_tree_complain(reader->tree, node, "%s is given, a map of names is wanted: %s", kind_name(node), row->doc);
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
        check_name(reader, child, child->key, true);
        check_group(reader, child, pattern);
    }
}

static void check_entries(scene_reader *reader, scene_node *node, const scene_key *row) {
    if (node->kind != SCENE_LIST) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list is wanted (entries start with '-'): %s",
                            kind_name(node), row->doc);
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
                            node->kind == SCENE_LIST ? "an empty list" : kind_name(node));
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
    case SCENE_REAL:
    case SCENE_ANY_UNIT:
    case SCENE_INTEGER: check_number(reader, node, row); break;
    case SCENE_VECTOR:
    case SCENE_PARTIAL: check_components(reader, node, row, reader->dimension); break;
    case SCENE_TURN:
        if (node->kind == SCENE_LIST && reader->dimension != 2) {
            check_components(reader, node, row, 3);
        } else if (check_number(reader, node, row)) {
            node->components = 1;
        }
        break;
    case SCENE_POLYGON: check_polygon(reader, node, row); break;
    case SCENE_TABLE:
    case SCENE_PROFILE:
    case SCENE_CURVE: check_table(reader, node); break;
    case SCENE_AXES: check_axes(reader, node); break;
    case SCENE_TEXT:
    case SCENE_NAME: check_text(reader, node, row); break;
    case SCENE_NAMES: check_names(reader, node, row); break;
    case SCENE_WORD:
        // grid.transfer: a word, or a map whose one key is such a word with a number of its own.
        if (node->kind == SCENE_MAP && strcmp(row->path, "grid.transfer") == 0)
            check_group(reader, node, row->path);
        else
            check_word(reader, node, row);
        break;
    case SCENE_SHAPE: check_shape(reader, node); break;
    case SCENE_SHAPES: check_shapes(reader, node); break;
    case SCENE_REALS: check_reals(reader, node, row); break;
    case SCENE_ANY: node->good = true; break;
    case SCENE_PARAMETERS: break; // never a row of its own: replaced by the parameters
    }
}

void brunt_check_keys(scene_reader *reader) { check_group(reader, reader->tree->root, ""); }

void brunt_check_scene(scene_reader *reader) {
    // The lengths of all vectors hang on the dimension, so it is looked at before anything else.
    scene_node *root = reader->tree->root, *dimension = brunt_tree_child(root, "dimension");
    reader->dimension = dimension ? 0 : 3;
    if (dimension && dimension->kind == SCENE_SCALAR) {
        if (strcmp(dimension->text, "2") == 0) reader->dimension = 2;
        if (strcmp(dimension->text, "3") == 0) reader->dimension = 3;
    }
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
