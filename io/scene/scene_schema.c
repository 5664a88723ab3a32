// The JSON Schema of scenes, made from the table that parses them.
#include "io/scene/scene_reader.h"

#include <string.h>

static void json_text(FILE *out, const char *text) {
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\') fputc('\\', out);
        fputc(*c, out);
    }
    fputc('"', out);
}

static void schema_value(FILE *out, const scene_key *row, const char *now);

typedef struct listing {
    FILE *out;
    bool comma;
} listing;

static void schema_key(listing *list, const char *key) {
    if (list->comma) fputs(",\n", list->out);
    list->comma = true;
    json_text(list->out, key);
    fputs(": ", list->out);
}

static bool first_of_its_name(const brunt_model *const *models, int m, int p) {
    for (int i = 0; i < m; i++)
        for (int q = 0; q < models[i]->parameter_count; q++)
            if (strcmp(models[i]->parameters[q].key, models[m]->parameters[p].key) == 0) return false;
    return true;
}

static void schema_group(FILE *out, const char *pattern) {
    listing list = {out, false};
    fputs("\"type\": \"object\", \"additionalProperties\": false,\n\"properties\": {\n", out);
    for (int i = 0; i < brunt_scene_table_count; i++) {
        const scene_key *row = &brunt_scene_table[i];
        const char *key = brunt_scene_child_key(row, pattern);
        if (!key) continue;
        if (row->type != SCENE_PARAMETERS) {
            schema_key(&list, key);
            schema_value(out, row, NULL);
            if (row->former) {
                schema_key(&list, row->former);
                schema_value(out, row, key);
            }
            continue;
        }
        int count;
        const brunt_model *const *models = brunt_scene_models(row->path, &count);
        for (int m = 0; m < count; m++)
            for (int p = 0; p < models[m]->parameter_count; p++) {
                const brunt_parameter *parameter = &models[m]->parameters[p];
                if (!first_of_its_name(models, m, p)) continue;
                schema_key(&list, parameter->key);
                fputs("{\"$ref\": \"#/$defs/number\", \"description\": ", out);
                char doc[512];
                snprintf(doc, sizeof doc, "%s: %s [%s]", models[m]->name, parameter->doc, parameter->unit);
                json_text(out, doc);
                fputc('}', out);
            }
    }
    fputs("}", out);
    bool any = false;
    for (int i = 0; i < brunt_scene_table_count; i++) {
        const scene_key *row = &brunt_scene_table[i];
        const char *key = brunt_scene_child_key(row, pattern);
        // What exists in one dimension only cannot be required here.
        if (!key || row->initial || row->dimension) continue;
        fputs(any ? ", " : ",\n\"required\": [", out);
        any = true;
        json_text(out, key);
    }
    if (any) fputc(']', out);
}

// YAML makes truth values of these words.
static bool is_truth(const char *word) { return strcmp(word, "true") == 0 || strcmp(word, "false") == 0; }

static void schema_words(FILE *out, const scene_key *row) {
    fputs("\"enum\": [", out);
    char word[64];
    if (row->words) {
        for (int i = 0; brunt_scene_word_at(row->words, i, word, sizeof word); i++) {
            if (i) fputs(", ", out);
            if (is_truth(word))
                fputs(word, out);
            else
                json_text(out, word);
        }
        for (int i = 0; brunt_scene_word_at(row->former_words, i, word, sizeof word); i++) {
            fputs(", ", out);
            json_text(out, word);
        }
    } else {
        int count;
        const brunt_model *const *models = brunt_scene_models(
            strstr(row->path, ".eos.") ? "materials.*.eos.<parameter>" : "materials.*.<parameter>", &count);
        for (int m = 0; m < count; m++) {
            if (m) fputs(", ", out);
            json_text(out, models[m]->name);
        }
    }
    fputc(']', out);
}

// The default of a key, where it has one.
static void schema_default(FILE *out, const scene_key *row) {
    if (!row->initial || !*row->initial) return;
    fputs(", \"default\": ", out);
    const char *rest;
    double value;
    if (strcmp(row->initial, "{}") == 0)
        fputs("{}", out);
    else if (row->type == SCENE_VECTOR || row->type == SCENE_PARTIAL)
        fputs("[0, 0, 0]", out);
    else if (row->type == SCENE_NAMES)
        fprintf(out, "[\"%.*s\"]", (int)strlen(row->initial) - 2, row->initial + 1);
    else if (!brunt_read_number(row->initial, &value, &rest) && !*rest)
        fputs(row->initial, out);
    else if (is_truth(row->initial))
        fputs(row->initial, out);
    else
        json_text(out, strcmp(row->initial, "''") == 0 ? "" : row->initial);
}

static void schema_names(FILE *out, const scene_key *row) {
    char pattern[128];
    snprintf(pattern, sizeof pattern, "%s.*", row->path);
    fputs("\"type\": \"object\", \"propertyNames\": {\"pattern\": \"^[A-Za-z0-9_-]{1,47}$\"}, "
          "\"additionalProperties\": {",
          out);
    schema_group(out, pattern);
    fputc('}', out);
}

static void schema_entries(FILE *out, const scene_key *row) {
    char pattern[128];
    snprintf(pattern, sizeof pattern, "%s[]", row->path);
    fputs("\"type\": \"array\", \"items\": {", out);
    schema_group(out, pattern);
    fputc('}', out);
}

// A word, or where a word may be a map with a value of its own, either.
static void schema_choice(FILE *out, const scene_key *row) {
    const bool map = brunt_scene_word_or_map(row);
    if (map) fputs("\"anyOf\": [{", out);
    schema_words(out, row);
    if (!map) return;
    fputs("}, {", out);
    schema_group(out, row->path);
    fputs("}]", out);
}

static void schema_type(FILE *out, const scene_key *row) {
    switch (row->type) {
    case SCENE_GROUP: schema_group(out, row->path); break;
    case SCENE_NAMED: schema_names(out, row); break;
    case SCENE_ENTRIES: schema_entries(out, row); break;
    case SCENE_REAL:
    case SCENE_ANY_UNIT: fputs("\"$ref\": \"#/$defs/number\"", out); break;
    case SCENE_INTEGER:
        fprintf(out, "\"type\": \"integer\", \"minimum\": %.0f, \"maximum\": %.0f", row->min, row->max);
        break;
    case SCENE_VECTOR:
    case SCENE_PARTIAL: fputs("\"$ref\": \"#/$defs/vector\"", out); break;
    case SCENE_TURN: fputs("\"anyOf\": [{\"$ref\": \"#/$defs/number\"}, {\"$ref\": \"#/$defs/vector\"}]", out); break;
    case SCENE_POLYGON:
        fprintf(out, "\"type\": \"array\", \"minItems\": %d, \"items\": {\"$ref\": \"#/$defs/vector\"}",
                strstr(row->path, "polygon") ? 3 : 2);
        break;
    case SCENE_TABLE:
    case SCENE_PROFILE:
    case SCENE_CURVE:
        fputs(
            "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, "
            "\"items\": {\"$ref\": \"#/$defs/number\"}}",
            out);
        break;
    case SCENE_AXES:
        fputs("\"anyOf\": [{\"const\": \"all\"}, {\"type\": \"array\", \"minItems\": 1, \"uniqueItems\": true, "
              "\"items\": {\"enum\": [\"x\", \"y\", \"z\"]}}]",
              out);
        break;
    case SCENE_TEXT: fputs("\"type\": [\"string\", \"number\"]", out); break;
    case SCENE_NAME: fputs("\"type\": [\"string\", \"number\"]", out); break;
    case SCENE_NAMES:
        fputs("\"type\": \"array\", \"uniqueItems\": true, \"items\": {\"type\": \"string\"}", out);
        break;
    case SCENE_WORD: schema_choice(out, row); break;
    case SCENE_SHAPE: fputs("\"$ref\": \"#/$defs/shape\"", out); break;
    case SCENE_SHAPES:
        fputs("\"type\": \"array\", \"minItems\": 1, \"items\": {\"$ref\": \"#/$defs/shape\"}", out);
        break;
    case SCENE_REALS: fputs("\"type\": \"array\", \"items\": {\"$ref\": \"#/$defs/number\"}", out); break;
    case SCENE_ANY: fputs("\"type\": [\"object\", \"array\", \"string\", \"number\"]", out); break;
    case SCENE_PARAMETERS: break;
    }
}

// `now`: the row in its former spelling, and what it is called today.
static void schema_value(FILE *out, const scene_key *row, const char *now) {
    fputs("{\"description\": ", out);
    char doc[512];
    if (now)
        snprintf(doc, sizeof doc, "now %s", now);
    else if (row->unit && strcmp(row->unit, "1") != 0)
        snprintf(doc, sizeof doc, "%s [%s]", row->doc, row->unit);
    else
        snprintf(doc, sizeof doc, "%s", row->doc);
    json_text(out, doc);
    if (now) fputs(", \"deprecated\": true", out);
    schema_default(out, row);
    fputs(", ", out);
    schema_type(out, row);
    fputc('}', out);
}

void brunt_scene_schema(FILE *out) {
    fputs("{\n\"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n\"title\": \"brunt scene\",\n"
          "\"$defs\": {\n\"number\": {\"type\": [\"number\", \"string\"]},\n"
          "\"vector\": {\"type\": \"array\", \"minItems\": 2, \"maxItems\": 3, \"items\": {\"$ref\": "
          "\"#/$defs/number\"}},\n"
          "\"shape\": {\"minProperties\": 1, \"maxProperties\": 1, ",
          out);
    schema_group(out, "<shape>");
    fputs("}\n},\n", out);
    schema_group(out, "");
    fputs("\n}\n", out);
}
