// The reference of all keys, made from the table that parses them.
#include "io/scene/history_columns.h"
#include "io/scene/scene_reader.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

enum { WIDTH = 120, PATH_WIDTH = 35, KIND_WIDTH = 21, DEFAULT_WIDTH = 15, INDENT = 2 };

static const char example[] =
    "# A first scene: a copper ball hits a rigid floor at 100 m/s. Save it as ball.yaml, then: brunt run ball.yaml\n"
    "brunt: 1\n"
    "title: A copper ball hits the floor\n"
    "dimension: 3\n"
    "time: {end: 60 us}\n"
    "grid: {cell: 1 mm}\n"
    "materials:\n"
    "  copper: {model: von-mises, density: 8960 kg/m^3, E: 124 GPa, nu: 0.34, yield: 90 MPa, hardening: 300 MPa}\n"
    "bodies:\n"
    "  ball:\n"
    "    method: mpm                            # of elements: `method: fem`, with `element: hex8` and `size: 0.5 mm`\n"
    "    material: copper\n"
    "    shape: {sphere: {center: [0, 0, 6 mm], radius: 5 mm}}\n"
    "    velocity: [0, 0, -100 m/s]\n"
    "boundaries:\n"
    "  - {name: floor, plane: {point: [0, 0, 0], normal: [0, 0, 1]}, condition: separate, friction: 0.2}\n"
    "output: {every: 2 us, history: 0.2 us, fields: [velocity, von_mises, plastic_strain]}\n"
    "measures:\n"
    "  energy_kept: {energy: total, take: end, relative_to: initial, expect: 1, tolerance: 0.05}\n";

static const char study_example[] =
    "# The ball of `brunt keys` at four cells and with two transfers: which is how far from the finest, in what time?\n"
    "brunt_study: 1\n"
    "title: A copper ball, transfers\n"
    "scene: ball.yaml                           # from the folder of this file\n"
    "set: {output.every: none}\n"
    "axes:\n"
    "  transfer: {key: grid.transfer, values: {APIC: apic, FLIP: {flip: 0.99}}}\n"
    "  h: {key: grid.cell, values: [2 mm, 1.4 mm, 1 mm, 0.7 mm], role: resolution}\n"
    "measures:\n"
    "  energy_kept: {reference: finest, title: error of the energy}\n";

// ---------------------------------------------------------------------------------------------------- text

static void describe_kind(const scene_key *row, char *out, size_t size) {
    switch (row->type) {
    case SCENE_GROUP: snprintf(out, size, "map"); break;
    case SCENE_NAMED: snprintf(out, size, "map of names"); break;
    case SCENE_ENTRIES: snprintf(out, size, "list of maps"); break;
    case SCENE_REAL: snprintf(out, size, strcmp(row->unit, "1") == 0 ? "number" : "number [%s]", row->unit); break;
    case SCENE_ANY_UNIT: snprintf(out, size, "number, any unit"); break;
    case SCENE_INTEGER: snprintf(out, size, "whole number"); break;
    case SCENE_VECTOR:
    case SCENE_PARTIAL: snprintf(out, size, strcmp(row->unit, "1") == 0 ? "vector" : "vector [%s]", row->unit); break;
    case SCENE_TURN: snprintf(out, size, "vector or number [%s]", row->unit); break;
    case SCENE_POLYGON: snprintf(out, size, "list of [x, y] [%s]", row->unit); break;
    case SCENE_TABLE:
    case SCENE_CURVE: snprintf(out, size, "list of [t, number]"); break;
    case SCENE_PROFILE: snprintf(out, size, "list of [x, number]"); break;
    case SCENE_AXES: snprintf(out, size, "list of axes"); break;
    case SCENE_TEXT: snprintf(out, size, "text"); break;
    case SCENE_NAME: snprintf(out, size, "name"); break;
    case SCENE_NAMES: snprintf(out, size, "list of names"); break;
    case SCENE_WORD: snprintf(out, size, "word"); break;
    case SCENE_SHAPE: snprintf(out, size, "shape"); break;
    case SCENE_SHAPES: snprintf(out, size, "list of shapes"); break;
    case SCENE_PARAMETERS: snprintf(out, size, "numbers"); break;
    case SCENE_REALS:
        snprintf(out, size, strcmp(row->unit, "1") == 0 ? "list of numbers" : "list [%s]", row->unit);
        break;
    case SCENE_ANY: snprintf(out, size, "see meaning"); break;
    }
}

static void describe_bounds(double min, double max, bool min_open, bool max_open, char *out, size_t size) {
    char low[32] = "", high[32] = "";
    out[0] = 0;
    if (isfinite(min)) brunt_format_number(min, low);
    if (isfinite(max)) brunt_format_number(max, high);
    if (*low && *high && min == max) return;
    if (*low && *high)
        snprintf(out, size, "%s%s .. %s%s", min_open ? "> " : "", low, max_open ? "< " : "", high);
    else if (*low)
        snprintf(out, size, "%s %s", min_open ? ">" : ">=", low);
    else if (*high)
        snprintf(out, size, "%s %s", max_open ? "<" : "<=", high);
}

// Text in a column that begins at `column`, broken at blanks.
static void write_wrapped(FILE *out, const char *text, int column) {
    int at = column;
    while (*text) {
        int word = (int)strcspn(text, " ");
        if (at + word > WIDTH && at > column) {
            fprintf(out, "\n%*s", column, "");
            at = column;
        }
        fprintf(out, "%.*s", word, text);
        at += word;
        text += word;
        while (*text == ' ') text++;
        if (*text && at + 1 + (int)strcspn(text, " ") <= WIDTH) {
            fputc(' ', out);
            at++;
        } else if (*text) {
            at = WIDTH + 1;
        }
    }
    fputc('\n', out);
}

// A line of the reference. A column that is too long pushes what follows to the next line.
static void write_row(FILE *out, const char *path, const char *kind, const char *initial, const char *doc, int indent) {
    const char *cells[3] = {path, kind, initial};
    const int widths[3] = {PATH_WIDTH, KIND_WIDTH, DEFAULT_WIDTH};
    int at = indent, column = indent;
    fprintf(out, "%*s", indent, "");
    for (int c = 0; c < 3; c++) {
        if (at > column) fprintf(out, "\n%*s", column, ""), at = column;
        fprintf(out, "%s", cells[c]);
        at += (int)strlen(cells[c]);
        column += widths[c] - (c == 0 ? indent - INDENT : 0);
        if (at < column) fprintf(out, "%*s", column - at, ""), at = column;
        if (at == column && strlen(cells[c]) >= (size_t)widths[c]) at++;
    }
    if (at > column) fprintf(out, "\n%*s", column, "");
    write_wrapped(out, doc, column);
}

static void write_key(FILE *out, const scene_key *row) {
    char kind[64], initial[48], doc[1024], bounds[96], word[64];
    describe_kind(row, kind, sizeof kind);
    if (!row->initial)
        snprintf(initial, sizeof initial, "required");
    else if (!*row->initial)
        snprintf(initial, sizeof initial, "optional");
    else
        snprintf(initial, sizeof initial, "%s", row->initial);
    describe_bounds(row->min, row->max, row->min_open, row->max_open, bounds, sizeof bounds);
    size_t used = (size_t)snprintf(doc, sizeof doc, "%s", row->doc);
    if (row->type == SCENE_WORD && row->words) {
        used += (size_t)snprintf(doc + used, sizeof doc - used, ":");
        for (int i = 0; brunt_scene_word_at(row->words, i, word, sizeof word); i++)
            used += (size_t)snprintf(doc + used, sizeof doc - used, " %s%s", i ? "| " : "", word);
    } else if (row->words && !strstr(row->doc, row->words)) {
        used += (size_t)snprintf(doc + used, sizeof doc - used, "; or the word %s", row->words);
    }
    if (row->former) used += (size_t)snprintf(doc + used, sizeof doc - used, "; formerly %s", row->former);
    for (int i = 0; brunt_scene_word_at(row->former_words, i, word, sizeof word); i++)
        used += (size_t)snprintf(doc + used, sizeof doc - used, "%s%s", i ? ", " : "; formerly ", word);
    if (*bounds) used += (size_t)snprintf(doc + used, sizeof doc - used, " (%s)", bounds);
    if (row->dimension) snprintf(doc + used, sizeof doc - used, " [%dD only]", row->dimension);
    write_row(out, row->path, kind, initial, doc, INDENT);
}

static void write_model(FILE *out, const brunt_model *model) {
    fprintf(out, "\n%*s%-24s ", INDENT, "", model->name);
    write_wrapped(out, model->doc ? model->doc : "", INDENT + 25);
    for (int p = 0; p < model->parameter_count; p++) {
        const brunt_parameter *parameter = &model->parameters[p];
        char kind[64], initial[32] = "required", doc[512], bounds[96];
        snprintf(kind, sizeof kind, strcmp(parameter->unit, "1") == 0 ? "number" : "number [%s]", parameter->unit);
        if (isinf(parameter->initial))
            snprintf(initial, sizeof initial, "none");
        else if (!isnan(parameter->initial))
            brunt_format_number(parameter->initial, initial);
        describe_bounds(parameter->min, parameter->max, parameter->min_open, parameter->max_open, bounds,
                        sizeof bounds);
        snprintf(doc, sizeof doc, *bounds ? "%s (%s)" : "%s", parameter->doc, bounds);
        write_row(out, parameter->key, kind, initial, doc, INDENT + 4);
    }
}

static void write_models(FILE *out) {
    fprintf(out, "\nStrength models (materials.NAME.model) and their parameters, beside `model` and `density`:\n");
    for (int m = 0; m < brunt_strength_model_count; m++) write_model(out, brunt_strength_models[m]);
    fprintf(out, "\nEquations of state (materials.NAME.eos.model) and their parameters, beside `model`:\n");
    for (int m = 0; m < brunt_eos_model_count; m++) write_model(out, brunt_eos_models[m]);
    fprintf(out,
            "\nFailure models (materials.NAME.failure.model) and their parameters, beside `model` and `action`:\n");
    for (int m = 0; m < brunt_failure_model_count; m++) write_model(out, brunt_failure_models[m]);
    fprintf(out, "\nArtificial viscosity (materials.NAME.viscosity):\n");
    write_model(out, &brunt_bulk_viscosity);
}

static void write_presets(FILE *out) {
    fprintf(out, "\nMaterials of the library (materials.NAME.preset):\n");
    for (int p = 0; p < brunt_preset_count(); p++) {
        const brunt_preset_info info = brunt_preset(p);
        char doc[1024];
        snprintf(doc, sizeof doc, "%s (%s)", info.doc, info.source);
        fprintf(out, "\n%*s%-24s ", INDENT, "", info.name);
        write_wrapped(out, doc, INDENT + 25);
    }
}

static void write_columns(FILE *out) {
    fputs("\nhistory: columns of history.csv, which measures ask for by name (measures.NAME.history)\n"
          "* stands for a name, _x for _x, _y and _z. Columns: name, unit, meaning [which scenes have it; default: "
          "all].\n",
          out);
    for (int i = 0; i < brunt_column_rows; i++) {
        const history_column *c = &brunt_column_table[i];
        char name[64], doc[1024];
        snprintf(name, sizeof name, "%s", c->name);
        if (strchr(name, '?')) *strchr(name, '?') = 'x';
        snprintf(doc, sizeof doc, c->of ? "%s [%s]" : "%s", c->doc, c->of);
        fprintf(out, "%*s%-*s %-8s ", INDENT, "", PATH_WIDTH - 1, name, c->unit ? c->unit : "");
        write_wrapped(out, doc, INDENT + PATH_WIDTH + 9);
    }
}

static bool in_section(const scene_section *section, const scene_key *row) {
    size_t top = strcspn(row->path, ".[");
    for (const char *p = section->prefix; *p;) {
        size_t length = strcspn(p, " ");
        if (length == top && strncmp(p, row->path, top) == 0) return true;
        p += length;
        while (*p == ' ') p++;
    }
    return false;
}

static void write_section(FILE *out, const scene_section *section) {
    const scene_key *own = brunt_scene_row(section->prefix);
    fprintf(out, "\n%s: %s\n", section->name, section->doc ? section->doc : own ? own->doc : "");
    for (int i = 0; i < brunt_scene_table_count; i++)
        if (in_section(section, &brunt_scene_table[i])) write_key(out, &brunt_scene_table[i]);
    if (strcmp(section->name, "materials") == 0) write_models(out);
}

static void write_study(FILE *out) {
    fputs(study_example, out);
    fputs(
        "\nA path is what --set of brunt run takes: bodies.rod.size, boundaries[0].friction. Text that holds {NAME} of "
        "an\n"
        "axis gets the number of its value in SI, or its label; {NAME*2} and {NAME/2} twice and half of it. A body of\n"
        "another method is given as a whole, by an axis without key:\n"
        "  method: {values: {FEM: {}, MPM: {bodies.rod: {method: mpm, material: steel, shape: {...}, velocity: "
        "[...]}}}}\n"
        "Columns as of scenes.\n\nstudy: the file of brunt study\n",
        out);
    for (int i = 0; i < *brunt_study_format.row_count; i++) write_key(out, &brunt_study_format.rows[i]);
}

// A single key, or all that are below it.
static bool write_below(FILE *out, const char *path) {
    const size_t length = strlen(path);
    bool found = false;
    for (int i = 0; i < brunt_scene_table_count; i++) {
        const scene_key *row = &brunt_scene_table[i];
        if (strncmp(row->path, path, length) != 0 || !strchr(".[", row->path[length])) continue; // its end, too
        write_key(out, row);
        found = true;
    }
    return found;
}

bool brunt_scene_keys(const char *section, FILE *out) {
    bool found = false;
    if (section && strcmp(section, brunt_study_format.name) == 0) {
        write_study(out);
        return true;
    }
    if (!section) {
        fputs(example, out);
        fputs("\nValues take units (190 m/s, 12 mm, 22 deg, 20 degC); bare numbers are SI. Vectors have as many "
              "components as\n"
              "the scene has dimensions, each with its own unit if it likes. * stands for a name of your own, [] for "
              "an entry\n"
              "of a list. Unknown keys are errors. Columns: key, value, default, meaning (range).\n",
              out);
    }
    for (int i = 0; i < brunt_scene_section_count; i++) {
        const scene_section *s = &brunt_scene_sections[i];
        if (section && strcmp(section, s->name) != 0 && strcmp(section, s->prefix) != 0) continue;
        found = true;
        write_section(out, s);
    }
    if (strcmp(section ? section : "history", "history") == 0) write_columns(out), found = true;
    if (strcmp(section ? section : "presets", "presets") == 0) write_presets(out), found = true;
    if (found || write_below(out, section)) return true;
    const brunt_model *model = brunt_find_strength(section);
    if (!model) model = brunt_find_eos(section);
    if (!model) model = brunt_find_failure(section);
    if (!model && strcmp(section, "viscosity") == 0) model = &brunt_bulk_viscosity;
    if (model) write_model(out, model);
    return model != NULL;
}
