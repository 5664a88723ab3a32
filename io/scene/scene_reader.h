// What the stages of reading a scene share. Private to the scene reader.
//
// 1. scene_yaml.c   text to tree          2. scene_tree.c   overrides
// 3. scene_check.c  tree against the table of keys: kinds, words, units, ranges, unknown and missing keys, defaults
// 4. scene_parse.c, scene_shape.c, scene_body.c, scene_contact.c, scene_boundary.c, scene_scheme.c, scene_measure.c
// meaning: structures are filled, and what two keys say together is checked
#pragma once

#include "io/scene/scene.h"
#include "io/scene/scene_keys.h"
#include "io/scene/scene_tree.h"
#include "io/scene/units.h"

typedef struct scene_reader {
    scene_tree *tree;
    brunt_units *units;
    int dimension; // 0 when the file's is unusable
    brunt_scene *scene;
    FILE *warnings;                      // of the scene, one a line
    const struct scene_columns *columns; // of the history, while measures are filled
} scene_reader;

// Before it, scene_preset.c puts the keys of materials of the library in.
void brunt_expand_presets(scene_reader *reader);
// Stage 3. Afterwards every accepted value is `good`, and every key that has a default is there.
void brunt_check_scene(scene_reader *reader);
void brunt_check_keys(scene_reader *reader); // the same for a file of any format, without what is particular to scenes
// The text of a file, to be given back with brunt_free. BRUNT_IO_ERROR after a message.
int brunt_read_text(const char *path, char **text, size_t *length, FILE *messages);
// Adds a key that is not there, as if the user had typed its value; returns it.
scene_node *brunt_add_default(scene_reader *reader, scene_node *map, const char *key, const char *text);
// Parameters of a model, in its own order; true when all of them are good.
bool brunt_read_parameters(const scene_node *map, const brunt_model *model, double *parameters);

// Accepted values of a map; the fallback when there is none.
double brunt_real_of(const scene_node *map, const char *key, double fallback);
const char *brunt_text_of(const scene_node *map, const char *key, const char *fallback);
bool brunt_vector_of(const scene_node *map, const char *key, double out[3]); // false: not there, `out` is left

// Fills the fields of `object` that the keys below a path ("bodies.*") say they fill, from a map of theirs; keys for
// other kinds are refused, and keys for this one get their defaults. 0: there are no kinds.
void brunt_fill_fields(scene_reader *reader, scene_node *map, const char *path, unsigned kind, void *object);

// Stage 4. World and output are filled in this order.
void brunt_fill_shape_def(scene_reader *reader, const scene_node *node, brunt_shape *shape);
brunt_placement brunt_fill_placement(scene_reader *reader, const scene_node *list);
void brunt_fill_bodies(scene_reader *reader);
void brunt_fill_contact(scene_reader *reader);
void brunt_fill_boundaries(scene_reader *reader);
void brunt_fill_scheme(scene_reader *reader);
void brunt_check_scheme(scene_reader *reader);
// Says that a key, if it is there, is of the other scheme: it has been checked, stays in the resolved scene, and does
// nothing.
void brunt_note_unused(scene_reader *reader, const scene_node *map, const char *key);
void brunt_fill_world(scene_reader *reader); // calls the five above
void brunt_fill_output(scene_reader *reader);
void brunt_fill_measures(scene_reader *reader);
// Once all bodies are filled; NULL: there is none.
const brunt_body_def *brunt_body_named(const scene_reader *reader, const char *name);
// Says when `node` names no body.
void brunt_check_body_name(scene_reader *reader, const scene_node *node);
// Copies text that must fit, or says that it is too long.
void brunt_copy_text(scene_reader *reader, const scene_node *node, char *out, size_t size);
int brunt_children_of(const scene_node *node, scene_kind kind); // 0 when it is of another kind
// An array for as many entries as a map or list has; NULL for none, or when there is no memory.
void *brunt_entries_for(scene_reader *reader, int count, size_t size);
enum { BRUNT_SCENE_PATH = 4096 };
// A path counts from the folder of the scene; the resolved scene, which lies elsewhere, has the whole path. Whether
// there is a file to read.
bool brunt_find_mesh(scene_reader *reader, scene_node *node, char path[BRUNT_SCENE_PATH]);
// Places of a file in metres, by the length that `key` says 1 stands for in it.
void brunt_scale_places(const scene_node *node, const char *key, double (*places)[3], int32_t count);
bool brunt_nonzero(const double v[3]);
// Says that `node` names nothing in the section `parent`, with the nearest name or all there are.
void brunt_complain_name(scene_reader *reader, const scene_node *node, const char *what, const char *parent);
// Says `why` at a key that is there but must not be.
void brunt_refuse_key(scene_reader *reader, const scene_node *node, const char *key, const char *why);
// A doubt about an acceptable scene, of the place of a key or a value: "file:line:column: path: ...".
void brunt_scene_warn_at(scene_reader *reader, const scene_node *node, bool at_key, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
// One about the scene as a whole.
void brunt_scene_warn(scene_reader *reader, const char *format, ...) __attribute__((format(printf, 2, 3)));
