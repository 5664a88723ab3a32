// A YAML document as a bounded tree with places, and the list of mistakes found in it. Private to the readers of scenes
// and studies.
//
// libfyaml scans and parses; the tree is our own, made from its events, so that depth, size and aliases are bounded
// before anything is built, and so that overrides and defaults are put in like what the user typed.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct scene_key;
struct scene_format;

typedef enum scene_kind { SCENE_SCALAR, SCENE_MAP, SCENE_LIST } scene_kind;

enum {
    SCENE_DEPTH_LIMIT = 40,
    SCENE_FEW_NODES = 100000,    // values that any file may have with all aliases expanded, see brunt_tree_parse
    SCENE_TEXT_LIMIT = 64 << 20, // [bytes]
    SCENE_MESSAGE_LIMIT = 200
};

typedef struct scene_node {
    scene_kind kind;
    char *key;        // in a map; NULL in a list
    char *text;       // of a scalar
    bool plain;       // not quoted
    int line, column; // from 1; 0: a default
    int key_line, key_column;
    const char *option; // the override it came from, NULL: the file
    struct scene_node *parent, *first, *last, *next;
    int count; // children
    int rank;  // among those of its parent
    // Of a map its children by the bits of a hash of their keys, so that one of thousands is found at once.
    struct scene_node *index, *branch[2];
    // What checking leaves:
    const struct scene_key *row;
    int order;        // in the resolved scene
    bool good;        // its value was accepted and lies in value[]
    bool number;      // written as a number
    int components;   // of a vector
    bool free[3];     // vector components without a value
    double value[3];  // SI
    const char *base; // of a number with any unit: the SI base units it came in, "1" for none
} scene_node;

typedef struct scene_message {
    int line, column, serial;
    const char *option;
    char *text;
    struct scene_message *next;
} scene_message;

typedef struct scene_tree {
    void *blocks; // arena
    size_t used, size;
    bool exhausted; // out of memory
    scene_node *root;
    int node_count;
    scene_message *messages;
    int message_count;
    const struct scene_format *format; // what it is to be
    const char *name;                  // of the file, for messages
    const char *source;                // its text; valid while it is read
    size_t length;
    const scene_node *found; // the last entry of a list that a message named: the next one is mostly behind it
} scene_tree;

// Memory that lives as long as the tree. NULL and `exhausted` when there is none.
void *brunt_tree_alloc(scene_tree *tree, size_t bytes);
char *brunt_tree_text(scene_tree *tree, const char *text, size_t length);
void brunt_tree_free(scene_tree *tree); // all that the tree owns

// Parses one document. `option` NULL: the file's own text; else an override's value. NULL after a message. Values that
// are typed take two bytes at least: there are no more of them, or aliases make them, which may do so up to
// SCENE_FEW_NODES.
scene_node *brunt_tree_parse(scene_tree *tree, const char *text, size_t length, const char *option);
// Applies "path.to.key=value".
void brunt_tree_set(scene_tree *tree, const char *option);

scene_node *brunt_tree_node(scene_tree *tree, scene_kind kind);
scene_node *brunt_tree_child(const scene_node *map, const char *key); // NULL: not there
void brunt_tree_append(scene_node *parent, scene_node *child);
void brunt_tree_remove(scene_node *child);
void brunt_tree_rename(scene_node *child, char *key);
// "bodies.rod.place[1].rotate"
void brunt_tree_path(const scene_node *node, char *out, size_t size);

// The node deepest on the path that a message begins with, "boundaries (rim).gas: ..." being that of the entry named
// rim.
const scene_node *brunt_tree_find(scene_tree *tree, const char *message);
// Prints a message with the place of a node: of a scalar or an entry of a list its own, else of its key.
void brunt_tree_say(const scene_tree *tree, const scene_node *node, const char *message, FILE *out);

// A mistake at a line and column, at a value, or at its key.
void brunt_tree_complain_at(scene_tree *tree, int line, int column, const char *option, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
void brunt_tree_complain(scene_tree *tree, const scene_node *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void brunt_tree_complain_key(scene_tree *tree, const scene_node *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// All mistakes in the order of their lines, with the line they are in.
void brunt_tree_report(scene_tree *tree, FILE *out);
