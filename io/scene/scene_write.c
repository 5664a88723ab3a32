// The scene as resolved: the checked tree with its defaults, in SI and in the order of the table of keys.
#include "io/scene/scene_reader.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

// Names and words are plain; all other text is quoted.
static void write_text(FILE *out, const char *text) {
    bool plain = isalpha((unsigned char)*text);
    for (const char *c = text; *c; c++) plain &= isalnum((unsigned char)*c) || *c == '_' || *c == '-';
    static const char *const reserved[] = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"};
    for (size_t i = 0; i < sizeof reserved / sizeof *reserved; i++) plain &= strcasecmp(text, reserved[i]) != 0;
    if (plain) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (const char *c = text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fprintf(out, "\\%c", *c);
        else if (*c == '\n')
            fputs("\\n", out);
        else if ((unsigned char)*c < 32 || *c == 127)
            fprintf(out, "\\x%02X", (unsigned char)*c);
        else
            fputc(*c, out);
    }
    fputc('"', out);
}

static void write_number(FILE *out, double value) {
    char text[32];
    brunt_format_number(value, text);
    fputs(text, out);
}

static bool is_flow(const scene_node *node) {
    if (node->kind == SCENE_SCALAR) return true;
    if (node->first == NULL) return true;
    if (node->kind == SCENE_MAP) return false;
    for (const scene_node *child = node->first; child; child = child->next)
        if (child->kind == SCENE_MAP) return false;
    return true;
}

static void write_flow(FILE *out, const scene_node *node) {
    if (node->kind == SCENE_SCALAR) {
        if (node->number)
            write_number(out, node->value[0]);
        else if (node->row && node->row->type == SCENE_WORD && node->good)
            fputs(node->text, out); // one of ours: also true and false are read as words
        else
            write_text(out, node->text);
        return;
    }
    if (node->kind == SCENE_MAP) {
        fputs("{}", out);
        return;
    }
    fputc('[', out);
    for (const scene_node *child = node->first; child; child = child->next) {
        if (child != node->first) fputs(", ", out);
        write_flow(out, child);
    }
    fputc(']', out);
}

static void write_node(FILE *out, const scene_node *node, int indent, bool first_inline) {
    for (const scene_node *child = node->first; child; child = child->next) {
        if (!(first_inline && child == node->first)) fprintf(out, "%*s", indent, "");
        if (node->kind == SCENE_MAP) {
            write_text(out, child->key);
            fputc(':', out);
        } else {
            fputs("- ", out);
        }
        if (is_flow(child)) {
            if (node->kind == SCENE_MAP) fputc(' ', out);
            write_flow(out, child);
            fputc('\n', out);
        } else if (node->kind == SCENE_MAP) {
            fputc('\n', out);
            write_node(out, child, indent + 2, false);
        } else {
            write_node(out, child, indent + 2, true);
        }
    }
}

int brunt_scene_write(const brunt_scene *scene, FILE *out) {
    const scene_tree *tree = scene->resolved;
    if (!tree || !tree->root) return BRUNT_BAD_INPUT;
    write_node(out, tree->root, 0, false);
    return fflush(out) != 0 || ferror(out) ? BRUNT_IO_ERROR : BRUNT_OK;
}
