// Keys that fill one field: which, and for which kinds of bodies and boundaries, stands in the table of keys.
#include "io/scene/scene_reader.h"

#include <string.h>

static const struct {
    unsigned kind;
    const char *name;
} kinds[] = {{SCENE_MPM, "method: mpm"},
             {SCENE_MESHES, "method: fem or membrane"},
             {SCENE_FEM, "method: fem"},
             {SCENE_MEMBRANE, "method: membrane"},
#define AT(NAME, kind, type, word, what) {SCENE_AT_##NAME, what},
             BRUNT_BOUNDARY_KINDS(AT)};
#undef AT

// "a plane or a line".
static void name_kinds(unsigned set, char *out, size_t size) {
    size_t used = 0;
    *out = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds && set && used < size; i++) {
        if ((kinds[i].kind & set) != kinds[i].kind) continue;
        set &= ~kinds[i].kind;
        used += (size_t)snprintf(out + used, size - used, "%s%s", !used ? "" : set ? ", " : " or ", kinds[i].name);
    }
}

// The part of a row's path below `path`, through groups alone; NULL: it is not below it.
static const char *path_below(const scene_key *row, const char *path) {
    const size_t length = strlen(path);
    if (strncmp(row->path, path, length) != 0 || row->path[length] != '.') return NULL;
    const char *rest = row->path + length + 1;
    return strpbrk(rest, "[*<") ? NULL : rest;
}

// The value at a path of groups, NULL: it is not there.
static scene_node *value_below(scene_node *map, const char *path) {
    char key[64];
    for (size_t length; map && map->kind == SCENE_MAP; path += length + 1) {
        length = strcspn(path, ".");
        if (length >= sizeof key) return NULL;
        memcpy(key, path, length);
        key[length] = 0;
        map = brunt_tree_child(map, key);
        if (!path[length]) return map;
    }
    return NULL;
}

// Whether the keys of the group that a path begins with are for this kind.
static bool group_is_for(const scene_format *format, const char *path, const char *rest, unsigned kind) {
    char group[128];
    if (!strchr(rest, '.')) return true;
    snprintf(group, sizeof group, "%s.%.*s", path, (int)strcspn(rest, "."), rest);
    const scene_key *row = brunt_format_row(format, group);
    return !row || !row->only || (row->only & kind);
}

static void store(const scene_node *node, const scene_field *field, void *object) {
    void *to = (char *)object + field->offset;
    switch (field->store) {
    case STORE_NOT: break;
    case STORE_REAL: *(double *)to = node->value[0]; break;
    case STORE_INTEGER: *(int32_t *)to = (int32_t)node->value[0]; break;
    case STORE_CHOICE: *(uint32_t *)to = (uint32_t)node->value[0]; break;
    case STORE_FLAG: *(bool *)to = node->value[0] != 0; break;
    case STORE_VECTOR:
        for (int c = 0; c < 3; c++) ((double *)to)[c] = node->value[c];
        break;
    }
}

void brunt_fill_fields(scene_reader *reader, scene_node *map, const char *path, unsigned kind, void *object) {
    const scene_format *format = reader->tree->format;
    for (int i = 0; i < *format->row_count; i++) {
        const scene_key *row = &format->rows[i];
        const char *rest = path_below(row, path);
        if (!rest || (row->dimension && reader->dimension && row->dimension != reader->dimension)) continue;
        if (!group_is_for(format, path, rest, kind)) continue;
        scene_node *node = value_below(map, rest);
        if (row->only && !(row->only & kind)) {
            char names[160];
            name_kinds(row->only, names, sizeof names);
            if (node) brunt_tree_complain_key(reader->tree, node, "this belongs to %s", names);
            continue;
        }
        if (!node && row->only && !row->depends && row->initial && *row->initial)
            node = brunt_add_default(reader, map, rest, row->initial);
        if (node && node->good) store(node, &row->field, object);
    }
}
