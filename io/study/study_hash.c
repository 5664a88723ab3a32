#include "io/study/study_hash.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "io/file/input_file.h"
#include "io/file/atomic_file.h"
#include "io/scene/scene_reader.h"

uint64_t study_hash_bytes(uint64_t hash, const void *bytes, size_t length) {
    const unsigned char *p = bytes;
    uint64_t word;
    for (; length >= sizeof word; p += sizeof word, length -= sizeof word) {
        memcpy(&word, p, sizeof word);
        hash = brunt_hash_add(hash, word);
    }
    word = 0;
    memcpy(&word, p, length);
    return brunt_hash_add(brunt_hash_add(hash, word), length);
}

int study_hash_file(const char *path, uint64_t *hash, brunt_error *error) {
    unsigned char block[1 << 14];
    const char *why;
    FILE *file = brunt_input_open(path, &why);
    if (!file) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot be read: %s", path, why);
    for (size_t got; (got = fread(block, 1, sizeof block, file)) > 0;) *hash = study_hash_bytes(*hash, block, got);
    bool failed = ferror(file);
    fclose(file);
    return failed ? brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot be read", path) : BRUNT_OK;
}

int study_hash_meshes(const brunt_scene *scene, uint64_t *hash, brunt_error *error) {
    const scene_tree *tree = scene->resolved;
    const scene_node *bodies = brunt_tree_child(tree->root, "bodies");
    const char *slash = strrchr(scene->source, '/');
    int status = BRUNT_OK;
    for (const scene_node *body = bodies ? bodies->first : NULL; body && !status; body = body->next) {
        const char *mesh = brunt_text_of(body, "mesh", NULL);
        if (!mesh) continue;
        char path[BRUNT_PATH_LENGTH];
        int folder = slash && *mesh != '/' ? (int)(slash + 1 - scene->source) : 0;
        snprintf(path, sizeof path, "%.*s%s", folder, scene->source, mesh);
        status = study_hash_file(path, hash, error);
    }
    return status;
}
