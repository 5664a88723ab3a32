// Boundaries of a scene: which kind each is, and what all have. Their own keys are read in boundary_KEY.c.
#include "boundary/kinds.h"
#include "io/scene/scene_boundary.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void brunt_fill_body_of(scene_reader *reader, const scene_node *node, char name[BRUNT_NAME_LENGTH]) {
    const scene_node *body = brunt_tree_child(node, "body");
    brunt_check_body_name(reader, body);
    brunt_copy_text(reader, body, name, BRUNT_NAME_LENGTH);
}

bool brunt_acts_on_particles(const scene_reader *reader, const char *name) {
    const brunt_world_def *world = &reader->scene->world;
    const brunt_body_def *body = brunt_body_named(reader, name);
    if (*name) return !body || body->method == BRUNT_MPM;
    bool any = world->body_count == 0;
    for (int i = 0; i < world->body_count && !any; i++) any = world->bodies[i].method == BRUNT_MPM;
    return any;
}

void brunt_fill_partial(scene_reader *reader, const scene_node *node, bool component[3], double value[3]) {
    bool any = false;
    for (int c = 0; c < 3; c++) {
        component[c] = c < reader->dimension && node && node->good && !node->free[c];
        value[c] = component[c] ? node->value[c] : 0;
        any |= component[c];
    }
    if (node && node->good && !any && reader->dimension)
        brunt_tree_complain(reader->tree, node, "all components are free: nothing would be prescribed");
}

typedef struct wall_name {
    const scene_node *node;
    int number; // in the list
} wall_name;

static int compare_wall_names(const void *a, const void *b) {
    const wall_name *p = a, *q = b;
    const int order = strcmp(p->node->text, q->node->text);
    return order ? order : (p->number > q->number) - (p->number < q->number);
}

static void check_boundary_names(scene_reader *reader, const scene_node *list) {
    wall_name *all = brunt_entries_for(reader, list->count, sizeof *all);
    int count = 0, number = 0;
    for (const scene_node *wall = all ? list->first : NULL; wall; wall = wall->next, number++)
        if (*brunt_text_of(wall, "name", "")) all[count++] = (wall_name){brunt_tree_child(wall, "name"), number};
    if (count) qsort(all, (size_t)count, sizeof *all, compare_wall_names);
    for (int i = 1; i < count; i++)
        if (!strcmp(all[i - 1].node->text, all[i].node->text))
            brunt_tree_complain(reader->tree, all[i].node, "the name '%s' is there twice", all[i].node->text);
    brunt_free(all);
}

static void fill_name(scene_reader *reader, scene_node *node, const char *kind, int number, char *name) {
    char automatic[32];
    snprintf(automatic, sizeof automatic, "%s%d", kind, number);
    if (!brunt_tree_child(node, "name")) brunt_add_default(reader, node, "name", automatic);
    brunt_copy_text(reader, brunt_tree_child(node, "name"), name, BRUNT_NAME_LENGTH);
}

// A kind of boundary: the key that says it is one, and its reader.
typedef struct boundary_reader {
    const char *key;
    void (*read)(scene_reader *reader, scene_node *node);
} boundary_reader;

#define READER(NAME, kind, type, word, what)                                                                           \
    static void read_##kind(scene_reader *reader, scene_node *node) {                                                  \
        brunt_world_def *world = &reader->scene->world;                                                                \
        type##_def *def = &world->kind##s[world->kind##_count++];                                                      \
        *def = type##_def_default();                                                                                   \
        fill_name(reader, node, word, world->kind##_count, def->name);                                                 \
        brunt_fill_fields(reader, node, "boundaries[]", SCENE_AT_##NAME, def);                                         \
        brunt_fill_##kind(reader, node, def);                                                                          \
    }
BRUNT_BOUNDARY_KINDS(READER)

// What holds material points is a line or a mesh.
static void read_mesh(scene_reader *reader, scene_node *node) {
    fill_name(reader, node, "mesh", reader->scene->world.surface_count + 1,
              reader->scene->world.surfaces[reader->scene->world.surface_count].name);
    read_surface(reader, node);
}

#define ROW(NAME, kind, type, word, what) {word, read_##kind},
static const boundary_reader readers[] = {BRUNT_BOUNDARY_KINDS(ROW){"mesh", read_mesh}};
enum { READERS = sizeof readers / sizeof *readers };

// Of a kind that lists its keys. They say which number they fill; shapes and tables are read here.
static void read_listed(scene_reader *reader, scene_node *node, const brunt_boundary_kind *kind, int32_t number) {
    brunt_world_def *world = &reader->scene->world;
    brunt_boundary_def *def = &world->boundaries[world->boundary_count++];
    const scene_node *body = brunt_tree_child(node, "body");
    snprintf(def->kind, sizeof def->kind, "%s", kind->word);
    fill_name(reader, node, kind->word, number, def->name);
    brunt_fill_fields(reader, node, "boundaries[]", SCENE_AT_LISTED, def);
    const scene_node *group = brunt_tree_child(node, kind->word);
    for (int k = 0; k < kind->key_count; k++) {
        const scene_node *value = brunt_tree_child(group, kind->keys[k].in_scene.key);
        if (kind->keys[k].is == BRUNT_VALUE_SHAPE) brunt_fill_shape_def(reader, value, &def->shape);
        if (kind->keys[k].is == BRUNT_VALUE_TABLE) brunt_fill_table(reader, value, &def->table);
    }
    brunt_fill_body_of(reader, node, def->body);
    if (!brunt_acts_on_particles(reader, def->body))
        brunt_tree_complain_key(reader->tree, body ? body : group, "a %s acts on the grid, %s of method mpm",
                                kind->word, body ? "this body is not" : "no body is");
}

// `numbers`: of each kind that lists its keys, how many there have been.
static void read_boundary(scene_reader *reader, scene_node *node, int32_t *numbers) {
    const boundary_reader *found = NULL;
    const brunt_boundary_kind *listed = NULL;
    const char *keys[32];
    int count = 0, key_count = 0, k_listed = 0;
    for (int k = 0; k < READERS; k++) {
        keys[key_count++] = readers[k].key;
        if (brunt_tree_child(node, readers[k].key)) found = &readers[k], count++;
    }
    for (int k = 0; k < brunt_boundary_kind_count; k++) {
        const brunt_boundary_kind *kind = brunt_boundary_kinds[k];
        if (!kind->keys) continue;
        if (key_count < (int)(sizeof keys / sizeof *keys)) keys[key_count++] = kind->word;
        if (brunt_tree_child(node, kind->word)) listed = kind, k_listed = k, count++;
    }
    char names[400] = "";
    BRUNT_LIST_NAMES(names, (size_t)key_count, keys[i]);
    if (count != 1)
        brunt_tree_complain(reader->tree, node, "exactly one of %s is wanted", names);
    else if (listed)
        read_listed(reader, node, listed, ++numbers[k_listed]);
    else
        found->read(reader, node);
}

void brunt_fill_boundaries(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    const scene_node *list = brunt_tree_child(reader->tree->root, "boundaries");
    const int count = brunt_children_of(list, SCENE_LIST);
#define ENTRIES(NAME, kind, type, word, what)                                                                          \
    if (!(world->kind##s = brunt_entries_for(reader, count, sizeof *world->kind##s))) return;
    BRUNT_BOUNDARY_KINDS(ENTRIES)
#undef ENTRIES
    if (!(world->boundaries = brunt_entries_for(reader, count, sizeof *world->boundaries))) return;
    int32_t *numbers = brunt_entries_for(reader, brunt_boundary_kind_count, sizeof *numbers);
    for (scene_node *node = numbers ? list->first : NULL; node; node = node->next)
        if (node->kind == SCENE_MAP) read_boundary(reader, node, numbers);
    brunt_free(numbers);
    check_boundary_names(reader, list);
}
