// What the stages of reading a study share. Private to study_read.c and study_cases.c.
#pragma once

#include "io/scene/scene_reader.h"
#include "io/study/study_reader.h"

enum { CHOICE_LIMIT = 64 };

typedef struct study_reader {
    scene_reader base; // tree and units
    brunt_study *study;
    const scene_node *values[BRUNT_STUDY_AXES]; // list or map that the values of an axis are the children of
    bool keyed[BRUNT_STUDY_AXES];               // key or keys are given: a value is what they take
    bool used[BRUNT_STUDY_AXES];                // some text holds its placeholder
} study_reader;

// The tree of the file.
scene_tree *study_tree(study_reader *r);
// An array that is never empty; NULL: out of memory.
void *study_entries(study_reader *r, int32_t count, size_t size);
// Says that there is no `what` of a name, with the nearest name or all; at the key or the value.
void study_complain_choice(study_reader *r, const scene_node *node, const char *what, const char *name,
                           const char *const *names, int count, bool key);
// Index of an axis, of a value of axis `a`; -1 after a message.
int32_t study_axis_named(study_reader *r, const scene_node *node, const char *name, bool key);
int32_t study_value_labelled(study_reader *r, const scene_node *node, int32_t a, const char *label, bool key);
// Keys of an axis' value that are no path in the scene.
bool study_key_is_special(const char *path);

// All combinations of the axes' values that are not skipped.
void study_make_cases(study_reader *r);
// The methods that measures refer to.
void study_check_methods(study_reader *r);
// Reads the scene of every case.
void study_check_cases(study_reader *r);
