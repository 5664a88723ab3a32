// The hash of the state that a run of the program has left.
#pragma once

#include "tests/support/small_program.h"

#include <jansson.h>

static inline uint64_t hash_of(const char *folder) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s/summary.json", small_folder, folder);
    json_t *summary = json_load_file(path, 0, NULL);
    const uint64_t hash = strtoull(json_string_value(json_object_get(summary, "state_hash")), NULL, 16);
    json_decref(summary);
    return hash;
}
