// Hashes of what the result of a run depends on.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "io/scene/scene.h"

// The hash with bytes, their number with them, or with those of a file, added.
uint64_t study_hash_bytes(uint64_t hash, const void *bytes, size_t length);
int study_hash_file(const char *path, uint64_t *hash, brunt_error *error);
// With the files of all meshes that a scene names.
int study_hash_meshes(const brunt_scene *scene, uint64_t *hash, brunt_error *error);
