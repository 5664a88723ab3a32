// Reading a scene: the stages in their order, and the scene's life.
#include "io/scene/scene_reader.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/memory.h"
#include "io/file/input_file.h"

static void release_outputs(brunt_scene *scene) {
    brunt_world_def_free(&scene->world);
    brunt_free(scene->output.fields);
    brunt_free(scene->output.probes);
    for (int32_t m = 0; m < scene->measure_count; m++) brunt_free(scene->measures[m].curve.points);
    brunt_free(scene->measures);
}

void brunt_scene_free(brunt_scene *scene) {
    if (!scene) return;
    release_outputs(scene);
    free(scene->warnings);
    if (scene->resolved) {
        brunt_tree_free(scene->resolved);
        brunt_free(scene->resolved);
    }
    memset(scene, 0, sizeof *scene);
}

void brunt_scene_complain(const brunt_scene *scene, const char *message, FILE *out) {
    scene_tree tree = *(const scene_tree *)scene->resolved;
    tree.name = scene->source; // a scene may have been moved since it was read
    brunt_tree_say(&tree, brunt_tree_find(&tree, message), message, out);
}

// "dir/impact.yaml" is the scene "impact".
static void take_names(brunt_scene *scene, const char *path) {
    snprintf(scene->source, sizeof scene->source, "%s", path);
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path, *dot = strrchr(base, '.');
    size_t length = dot && dot != base ? (size_t)(dot - base) : strlen(base);
    if (length >= sizeof scene->name) length = sizeof scene->name - 1;
    memcpy(scene->name, base, length);
    scene->name[length] = 0;
}

// Warnings of mesh files and of the scene go to a text of the scene's own.
static bool start_warnings(scene_reader *reader, size_t *length) {
    reader->warnings = open_memstream(&reader->scene->warnings, length);
    return reader->warnings != NULL;
}

static void end_warnings(scene_reader *reader, const size_t *length) {
    fclose(reader->warnings);
    if (*length) return;
    free(reader->scene->warnings);
    reader->scene->warnings = NULL;
}

static void read_tree(scene_reader *reader, const char *text, size_t length, const char *const *sets, int set_count) {
    scene_tree *tree = reader->tree;
    tree->root = brunt_tree_parse(tree, text, length, NULL);
    if (!tree->root) return;
    if (tree->root->kind != SCENE_MAP) {
        brunt_tree_complain(tree, tree->root, "a scene is a map that starts with 'brunt: 1'");
        return;
    }
    if (brunt_tree_child(tree->root, "brunt_study")) {
        brunt_tree_complain(tree, tree->root, "this is a study, of which 'brunt study' makes runs; a scene is wanted");
        return;
    }
    for (int i = 0; i < set_count; i++) brunt_tree_set(tree, sets[i]);
    brunt_check_scene(reader);
    brunt_fill_world(reader);
    brunt_fill_output(reader);
    brunt_fill_measures(reader);
}

int brunt_scene_parse(const char *text, size_t length, const char *name, const char *const *sets, int set_count,
                      brunt_scene *scene, FILE *messages) {
    memset(scene, 0, sizeof *scene);
    take_names(scene, name);
    scene_tree *tree = brunt_alloc(sizeof *tree);
    brunt_units *units = brunt_units_open();
    scene->resolved = tree;
    int status = BRUNT_BAD_INPUT;
    size_t warned = 0;
    scene_reader reader = {.tree = tree, .units = units, .scene = scene};
    if (tree && units && start_warnings(&reader, &warned)) {
        *tree = (scene_tree){.format = &brunt_scene_format, .name = scene->source, .source = text, .length = length};
        read_tree(&reader, text, length, sets, set_count);
        end_warnings(&reader, &warned);
        if (tree->message_count == 0 && !tree->exhausted)
            status = BRUNT_OK;
        else
            brunt_tree_report(tree, messages);
        // The text belongs to the caller.
        tree->source = NULL;
        tree->length = 0;
    } else if (messages) {
        fprintf(messages, "%s: out of memory\n", name);
    }
    brunt_units_close(units);
    if (status != BRUNT_OK) brunt_scene_free(scene);
    return status;
}

int brunt_read_text(const char *path, char **out, size_t *size, FILE *messages) {
    const char *why;
    FILE *file = brunt_input_open(path, &why);
    size_t length = 0, capacity = 0;
    char *text = NULL;
    *out = NULL;
    *size = 0;
    bool failed = !file;
    while (!failed) {
        // One byte more than is accepted: the parser then says that the file is too large.
        if (BRUNT_RESERVE_IN(text, capacity, length + 65536, length)) {
            failed = true;
            why = strerror(ENOMEM);
            break;
        }
        size_t got = fread(text + length, 1, capacity - length, file);
        length += got;
        if (ferror(file)) failed = true, why = strerror(errno);
        if (got == 0 || length > SCENE_TEXT_LIMIT) break;
    }
    if (failed) {
        if (messages) fprintf(messages, "%s: cannot be read: %s\n", path, why);
        if (file) fclose(file);
        brunt_free(text);
        return BRUNT_IO_ERROR;
    }
    fclose(file);
    *out = text;
    *size = length;
    return BRUNT_OK;
}

int brunt_scene_read(const char *path, const char *const *sets, int set_count, brunt_scene *scene, FILE *messages) {
    memset(scene, 0, sizeof *scene);
    char *text;
    size_t length;
    int status = brunt_read_text(path, &text, &length, messages);
    if (status) return status;
    status = brunt_scene_parse(text, length, path, sets, set_count, scene, messages);
    brunt_free(text);
    return status;
}
