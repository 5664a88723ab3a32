// One value against its row of the table of keys: its kind, unit and range, its word or name.
#include "io/scene/scene_value.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/text.h"

const char *brunt_kind_name(const scene_node *node) {
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

// "grains.17": a member of a crowd, where bodies are named.
static bool is_member(const char *name) {
    char crowd[BRUNT_NAME_LENGTH];
    const size_t length = strcspn(name, ".");
    snprintf(crowd, sizeof crowd, "%.*s", (int)length, name);
    return length < sizeof crowd && usable_name(crowd) && name[length] && name[length + 1] &&
           strspn(name + length + 1, "0123456789") == strlen(name + length + 1);
}

bool brunt_check_name(scene_reader *reader, const scene_node *node, const char *name, bool at_key) {
    void (*complain)(scene_tree *, const scene_node *, const char *, ...) =
        at_key ? brunt_tree_complain_key : brunt_tree_complain;
    if (!usable_name(name) && (at_key || !is_member(name))) {
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

// Whether a node holds a single value that is not empty; says so when it does not.
static bool check_scalar(scene_reader *reader, const scene_node *node, const scene_key *row) {
    if (node->kind == SCENE_SCALAR && (!node->plain || *node->text)) return true;
    char want[128];
    wanted(reader, row, want, sizeof want);
    brunt_tree_complain(reader->tree, node, "%s is given, %s is wanted", brunt_kind_name(node), want);
    return false;
}

// The number that the text begins with, and where its unit begins.
static bool read_value(scene_reader *reader, const scene_node *node, const scene_key *row, double *value,
                       const char **rest) {
    const char *text = node->text;
    while (*text == ' ') text++;
    const char *wrong = brunt_read_number(text, value, rest);
    if (wrong) {
        char want[128];
        wanted(reader, row, want, sizeof want);
        brunt_tree_complain(reader->tree, node, "'%.60s' is %s, %s is wanted%s%s%s", node->text, wrong, want,
                            row->words ? " (or the word '" : "", row->words ? row->words : "", row->words ? "')" : "");
        return false;
    }
    while (**rest == ' ' || **rest == '\t') (*rest)++;
    return true;
}

// Takes `value` from the unit that `rest` names, if any, to that of the row.
static bool convert_unit(scene_reader *reader, scene_node *node, const scene_key *row, const char *rest,
                         double *value) {
    size_t length = strlen(rest);
    while (length && (rest[length - 1] == ' ' || rest[length - 1] == '\n')) length--;
    char unit[160], why[320];
    snprintf(unit, sizeof unit, "%.*s", (int)length, rest);
    node->base = "1";
    if (!*unit) return true;
    bool converted = false;
    if (row->type == SCENE_INTEGER) {
        snprintf(why, sizeof why, "'%.60s' is not a whole number without unit", node->text);
    } else if (row->type == SCENE_ANY_UNIT) {
        char base[BRUNT_UNIT_LENGTH];
        converted = brunt_units_to_si(reader->units, unit, value, base, why, sizeof why);
        if (converted && !(node->base = brunt_tree_text(reader->tree, base, strlen(base)))) return false;
    } else {
        converted = brunt_units_convert(reader->units, unit, row->unit ? row->unit : "1", value, why, sizeof why);
    }
    if (!converted) brunt_tree_complain(reader->tree, node, "%s", why);
    return converted;
}

static bool check_range(scene_reader *reader, const scene_node *node, const scene_key *row, double value) {
    char want[128], why[320];
    if (row->type == SCENE_INTEGER && (value != floor(value) || fabs(value) > 9007199254740992.0)) {
        brunt_tree_complain(reader->tree, node, "'%.60s' is not a whole number", node->text);
        return false;
    }
    if (!within(row, value)) {
        describe_range(row, want, sizeof want);
        brunt_tree_complain(reader->tree, node, "'%.60s' is out of range, %s is wanted", node->text, want);
        return false;
    }
    if (!brunt_usable_number(value, row->min == 0 && row->min_open, why, sizeof why)) {
        brunt_tree_complain(reader->tree, node, "'%.60s' is %s", node->text, why);
        return false;
    }
    return true;
}

// One number with its unit. Writes to value[0] of the node.
static bool check_number(scene_reader *reader, scene_node *node, const scene_key *row) {
    node->row = row;
    node->good = false;
    if (!check_scalar(reader, node, row)) return false;
    if (row->words && row->type != SCENE_WORD && strcmp(node->text, row->words) == 0) {
        node->value[0] = INFINITY;
        return node->good = true;
    }
    double value;
    const char *rest;
    if (!read_value(reader, node, row, &value, &rest) || !convert_unit(reader, node, row, rest, &value) ||
        !check_range(reader, node, row, value))
        return false;
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
                            brunt_kind_name(node), wanted_count ? wanted_count : 3,
                            wanted_count == 2 ? "x, y" : "x, y, z", want);
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
                            brunt_kind_name(node));
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
                            node->kind == SCENE_LIST ? "an empty list" : brunt_kind_name(node), point);
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

void brunt_list_names(const char *const *names, int count, char *out, size_t size) {
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
    brunt_list_names(names, count, all, sizeof all);
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
        brunt_list_names(names, count, all, sizeof all);
        brunt_tree_complain(reader->tree, node, "%s is given, one of these is wanted: %s", brunt_kind_name(node), all);
        return;
    }
    if (row->words) {
        node->good = brunt_scene_word(row->words, node->text, &index);
        if (!node->good && row->former_words && brunt_scene_word(row->former_words, node->text, &index)) {
            brunt_scene_warn_at(reader, node, false, "'%s' is now '%s', this name goes with the next version",
                                node->text, names[index]);
            node->good = true;
        }
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
        brunt_tree_complain(reader->tree, node, "%s is given, %s is wanted", brunt_kind_name(node),
                            row->type == SCENE_TEXT ? "text" : "a name");
        return;
    }
    node->good = row->type == SCENE_TEXT || brunt_check_name(reader, node, node->text, false);
}

static void check_names(scene_reader *reader, scene_node *node, const scene_key *row) {
    if (node->kind != SCENE_LIST) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of names is wanted", brunt_kind_name(node));
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
                            node->kind == SCENE_LIST ? "an empty list" : brunt_kind_name(node), want);
        return;
    }
    node->good = true;
    for (scene_node *child = node->first; child; child = child->next) node->good &= check_number(reader, child, row);
}

// Which axes: value[c] is 1 for those that are meant.
static void check_axes(scene_reader *reader, scene_node *node) {
    static const char *const axes[3] = {"x", "y", "z"};
    int dimension = reader->dimension ? reader->dimension : 3;
    bool all = node->kind == SCENE_SCALAR && strcmp(node->text, "all") == 0;
    if (!all && (node->kind != SCENE_LIST || node->count == 0)) {
        brunt_tree_complain(reader->tree, node, "%s is given, a list of axes like [x, %s] or the word `all` is wanted",
                            node->kind == SCENE_LIST ? "an empty list" : brunt_kind_name(node), axes[dimension - 1]);
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
            brunt_tree_complain(reader->tree, child, "%s is given, one of the axes is wanted", brunt_kind_name(child));
        else if (axis < 0)
            complain_choice(reader, child, child->text, axes, dimension);
        else if (!child->good)
            brunt_tree_complain(reader->tree, child, "'%s' is there twice", child->text);
        else
            node->value[axis] = 1;
    }
}

void brunt_check_single_value(scene_reader *reader, scene_node *node, const scene_key *row) {
    switch (row->type) {
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
    case SCENE_WORD: check_word(reader, node, row); break;
    case SCENE_REALS: check_reals(reader, node, row); break;
    case SCENE_ANY: node->good = true; break;
    default: break; // groups, which scene_check.c looks into; parameters, which are no rows of their own
    }
}
