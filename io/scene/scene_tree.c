// The tree, its arena, its messages and the overrides. scene_yaml.c fills it from text.
#include "io/scene/scene_tree.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"

typedef struct block {
    struct block *next;
    char bytes[];
} block;

void *brunt_tree_alloc(scene_tree *tree, size_t bytes) {
    bytes = (bytes + 15) / 16 * 16;
    if (!tree->blocks || tree->size - tree->used < bytes) {
        size_t size = bytes > 65536 ? bytes : 65536;
        block *fresh = brunt_alloc(sizeof *fresh + size);
        if (!fresh) {
            tree->exhausted = true;
            return NULL;
        }
        fresh->next = tree->blocks;
        tree->blocks = fresh;
        tree->used = 0;
        tree->size = size;
    }
    void *memory = ((block *)tree->blocks)->bytes + tree->used;
    tree->used += bytes;
    return memory;
}

char *brunt_tree_text(scene_tree *tree, const char *text, size_t length) {
    char *copy = brunt_tree_alloc(tree, length + 1);
    if (!copy) return NULL;
    if (length) memcpy(copy, text, length);
    copy[length] = 0;
    return copy;
}

void brunt_tree_free(scene_tree *tree) {
    for (block *b = tree->blocks, *next; b; b = next) {
        next = b->next;
        brunt_free(b);
    }
    memset(tree, 0, sizeof *tree);
}

scene_node *brunt_tree_node(scene_tree *tree, scene_kind kind) {
    scene_node *node = brunt_tree_alloc(tree, sizeof *node);
    if (!node) return NULL;
    memset(node, 0, sizeof *node);
    node->kind = kind;
    node->plain = true;
    tree->node_count++;
    return node;
}

// Where in a map's index the child of a key is, or would be.
static scene_node **slot_of(scene_node *map, const char *key, size_t length) {
    uint64_t hash = length;
    for (size_t i = 0; i < length; i++) hash = brunt_hash_add(hash, (unsigned char)key[i]);
    scene_node **at = &map->index;
    for (; *at && (strncmp((*at)->key, key, length) || (*at)->key[length]); hash <<= 1) at = &(*at)->branch[hash >> 63];
    return at;
}

scene_node *brunt_tree_child(const scene_node *map, const char *key) {
    return !map || map->kind != SCENE_MAP ? NULL : *slot_of((scene_node *)map, key, strlen(key));
}

// Of two of one key the first counts.
static void enter(scene_node *map, scene_node *child) {
    if (map->kind != SCENE_MAP) return;
    child->branch[0] = child->branch[1] = NULL;
    scene_node **at = slot_of(map, child->key, strlen(child->key));
    if (!*at) *at = child;
}

static void enter_all(scene_node *map) {
    map->index = NULL;
    for (scene_node *child = map->first; child; child = child->next) enter(map, child);
}

void brunt_tree_append(scene_node *parent, scene_node *child) {
    child->parent = parent;
    child->next = NULL;
    if (parent->last)
        parent->last->next = child;
    else
        parent->first = child;
    parent->last = child;
    child->rank = parent->count++;
    enter(parent, child);
}

void brunt_tree_remove(scene_node *child) {
    scene_node *parent = child->parent, *before = NULL;
    for (scene_node *node = parent->first; node != child; node = node->next) before = node;
    if (before)
        before->next = child->next;
    else
        parent->first = child->next;
    for (scene_node *node = child->next; node; node = node->next) node->rank--;
    if (parent->last == child) parent->last = before;
    parent->count--;
    child->parent = NULL;
    child->next = NULL;
    enter_all(parent);
}

void brunt_tree_rename(scene_node *child, char *key) {
    child->key = key;
    enter_all(child->parent);
}

void brunt_tree_path(const scene_node *node, char *out, size_t size) {
    const scene_node *up[SCENE_DEPTH_LIMIT + 4];
    int depth = 0;
    for (; node && node->parent && depth < SCENE_DEPTH_LIMIT + 4; node = node->parent) up[depth++] = node;
    size_t used = 0;
    out[0] = 0;
    while (depth-- > 0 && used + 1 < size) {
        int wrote;
        if (up[depth]->key) {
            wrote = snprintf(out + used, size - used, "%s%.60s", used ? "." : "", up[depth]->key);
        } else {
            wrote = snprintf(out + used, size - used, "[%d]", up[depth]->rank);
        }
        used += wrote > 0 ? (size_t)wrote : 0;
    }
}

static bool is_called(const scene_node *entry, const char *name, size_t length) {
    char number[24];
    const scene_node *named = brunt_tree_child(entry, "name");
    const bool by_number = isdigit((unsigned char)*name);
    if (by_number) snprintf(number, sizeof number, "%d", entry->rank);
    const char *texts[] = {by_number ? number : NULL, named ? named->text : NULL};
    for (int t = 0; t < 2; t++)
        if (texts[t] && strlen(texts[t]) == length && !strncmp(texts[t], name, length)) return true;
    return false;
}

// From the one behind the last that was found on, and about.
static const scene_node *entry_at(scene_tree *tree, const scene_node *list, const char *name, size_t length) {
    const scene_node *entry = tree->found && tree->found->parent == list ? tree->found->next : NULL;
    for (int i = 0; i < list->count; i++, entry = entry->next) {
        if (!entry) entry = list->first;
        if (is_called(entry, name, length)) return tree->found = entry;
    }
    return NULL;
}

const scene_node *brunt_tree_find(scene_tree *tree, const char *message) {
    const scene_node *node = tree->root, *next = node;
    for (const char *p = message; next && *p;) {
        const bool entry = *p == '[' || !strncmp(p, " (", 2);
        if (entry || *p == '.') p += *p == ' ' ? 2 : 1;
        const size_t length = strcspn(p, entry ? "])" : ".[: ");
        char key[128];
        if (!length || length >= sizeof key) break;
        snprintf(key, sizeof key, "%.*s", (int)length, p);
        next = !entry && node->kind == SCENE_MAP   ? brunt_tree_child(node, key)
               : entry && node->kind == SCENE_LIST ? entry_at(tree, node, key, length)
                                                   : NULL;
        if (next) node = next;
        p += length + (entry && p[length]);
        if (*p == ':' || (*p == ' ' && p[1] != '(')) break;
    }
    return node;
}

// ---------------------------------------------------------------------------------------------------- messages

static void add_message(scene_tree *tree, int line, int column, const char *option, const char *path,
                        const char *format, va_list arguments) {
    char text[2048];
    size_t used = 0;
    if (path && *path) used = (size_t)snprintf(text, sizeof text, "%.400s: ", path);
    vsnprintf(text + used, sizeof text - used, format, arguments);
    // What the user typed is quoted in messages: control bytes in it must not reach a terminal.
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) *c = '?';
    for (scene_message *m = tree->messages; m; m = m->next)
        if (m->line == line && m->column == column && m->option == option && strcmp(m->text, text) == 0) return;
    tree->message_count++;
    if (tree->message_count > SCENE_MESSAGE_LIMIT) return;
    scene_message *message = brunt_tree_alloc(tree, sizeof *message);
    if (!message) return;
    message->text = brunt_tree_text(tree, text, strlen(text));
    if (!message->text) return;
    message->line = line;
    message->column = column;
    message->option = option;
    message->serial = tree->message_count;
    message->next = tree->messages;
    tree->messages = message;
}

void brunt_tree_complain_at(scene_tree *tree, int line, int column, const char *option, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    add_message(tree, line, column, option, NULL, format, arguments);
    va_end(arguments);
}

// A default has no place of its own: the nearest thing around it that the user typed has.
static const scene_node *typed(const scene_node *node) {
    while (node->parent && !node->line && !node->option) node = node->parent;
    return node;
}

void brunt_tree_say(const scene_tree *tree, const scene_node *node, const char *message, FILE *out) {
    const scene_node *at = typed(node);
    const bool by_key = at->key_line && (at != node || at->kind != SCENE_SCALAR);
    if (at->option)
        fprintf(out, "--set %s: %s\n", at->option, message);
    else if (at->parent && at->line)
        fprintf(out, "%s:%d:%d: %s\n", tree->name, by_key ? at->key_line : at->line,
                by_key ? at->key_column : at->column, message);
    else
        fprintf(out, "%s: %s\n", tree->name, message);
}

void brunt_tree_complain(scene_tree *tree, const scene_node *node, const char *format, ...) {
    char path[512];
    brunt_tree_path(node, path, sizeof path);
    const scene_node *at = typed(node);
    bool by_key = at != node && at->key_line;
    va_list arguments;
    va_start(arguments, format);
    add_message(tree, by_key ? at->key_line : at->line, by_key ? at->key_column : at->column, at->option, path, format,
                arguments);
    va_end(arguments);
}

void brunt_tree_complain_key(scene_tree *tree, const scene_node *node, const char *format, ...) {
    char path[512];
    brunt_tree_path(node, path, sizeof path);
    const scene_node *at = typed(node);
    bool by_key = at->key_line != 0;
    va_list arguments;
    va_start(arguments, format);
    add_message(tree, by_key ? at->key_line : at->line, by_key ? at->key_column : at->column, at->option, path, format,
                arguments);
    va_end(arguments);
}

// Overrides come after the file, as on the command line.
static int by_place(const void *a, const void *b) {
    const scene_message *x = *(scene_message *const *)a, *y = *(scene_message *const *)b;
    if (!x->option != !y->option) return x->option ? 1 : -1;
    if (!x->option && x->line != y->line) return x->line < y->line ? -1 : 1;
    if (!x->option && x->column != y->column) return x->column < y->column ? -1 : 1;
    return x->serial - y->serial;
}

// Where a line of the source begins, from an earlier one on.
typedef struct source_line {
    const char *start;
    int number;
} source_line;

static source_line first_line(const scene_tree *tree) {
    const bool mark = tree->length >= 3 && !memcmp(tree->source, "\xEF\xBB\xBF", 3); // it has no column
    return (source_line){tree->source + (mark ? 3 : 0), 1};
}

// The line and a caret under its column. Long lines are cut around the column; columns count characters, not bytes.
static void excerpt(const scene_tree *tree, source_line *from, int line, int column, FILE *out) {
    const char *end = tree->source + tree->length, *p;
    for (p = from->start; from->number < line && p < end; p++)
        if (*p == '\n') from->number++;
    from->start = p;
    if (p >= end) return;
    enum { WIDTH = 100 };
    int first = column > WIDTH - 20 ? column - (WIDTH - 20) : 1, at = 0;
    char text[4 * WIDTH + 8];
    size_t used = 0;
    for (; p < end && *p != '\n' && *p != '\r'; p++) {
        if (((unsigned char)*p & 0xC0) != 0x80) at++;
        if (at < first) continue;
        if (at >= first + WIDTH || used + 1 >= sizeof text) break;
        unsigned char c = (unsigned char)*p;
        text[used++] = c == '\t' ? ' ' : c < 32 || c == 127 ? '?' : (char)c;
    }
    if (used == 0) return;
    fprintf(out, "    %.*s\n    %*s^\n", (int)used, text, column - first, "");
}

void brunt_tree_report(scene_tree *tree, FILE *out) {
    if (!out) return;
    scene_message *sorted[SCENE_MESSAGE_LIMIT];
    size_t count = 0;
    for (scene_message *m = tree->messages; m && count < SCENE_MESSAGE_LIMIT; m = m->next) sorted[count++] = m;
    qsort(sorted, count, sizeof *sorted, by_place);
    source_line at = first_line(tree);
    for (size_t i = 0; i < count; i++) {
        const scene_message *m = sorted[i];
        if (m->option) {
            fprintf(out, "--set %s: %s\n", m->option, m->text);
        } else if (m->line) {
            fprintf(out, "%s:%d:%d: %s\n", tree->name, m->line, m->column, m->text);
            excerpt(tree, &at, m->line, m->column, out);
        } else {
            fprintf(out, "%s: %s\n", tree->name, m->text);
        }
    }
    if (tree->message_count > SCENE_MESSAGE_LIMIT)
        fprintf(out, "%s: and %d more mistakes\n", tree->name, tree->message_count - SCENE_MESSAGE_LIMIT);
    if (tree->exhausted) fprintf(out, "%s: out of memory\n", tree->name);
}

// ---------------------------------------------------------------------------------------------------- overrides

// One step of a path: a key, or an index for `[2]` and for `.2` in a list. Returns what is behind it, NULL when
// malformed.
static const char *path_step(const char *p, const char *end, const char **word, size_t *length) {
    bool bracket = *p == '[';
    if (bracket) p++;
    *word = p;
    while (p < end && *p != '.' && *p != '[' && *p != ']') p++;
    *length = (size_t)(p - *word);
    if (*length == 0) return NULL;
    if (bracket) {
        if (p >= end || *p != ']') return NULL;
        p++;
    } else if (p < end && *p == ']') {
        return NULL;
    }
    if (p < end && *p == '.') {
        p++;
        if (p >= end) return NULL;
    } else if (p < end && *p != '[') {
        return NULL;
    }
    return p;
}

// The child that a step names. `missing`: a list's index may be its length, a map's key may be new.
static scene_node *step_into(scene_tree *tree, scene_node *node, const char *word, size_t length, const char *option,
                             bool *missing) {
    char path[300];
    brunt_tree_path(node, path, sizeof path);
    *missing = false;
    if (node->kind == SCENE_SCALAR) {
        brunt_tree_complain_at(tree, 0, 0, option, "%s is a single value, it has no '%.*s'", path, (int)length, word);
        return NULL;
    }
    if (node->kind == SCENE_MAP) {
        scene_node *child = *slot_of(node, word, length);
        *missing = !child;
        return child;
    }
    int index = 0;
    for (size_t i = 0; i < length; i++) {
        if (!isdigit((unsigned char)word[i]) || i > 6) {
            brunt_tree_complain_at(tree, 0, 0, option,
                                   "%s is a list, a number from 0 to %d is wanted instead of '%.*s'", path,
                                   node->count ? node->count - 1 : 0, (int)length, word);
            return NULL;
        }
        index = 10 * index + (word[i] - '0');
    }
    scene_node *child = node->first;
    for (int i = 0; child && i < index; i++) child = child->next;
    if (!child && index == node->count) {
        *missing = true;
    } else if (!child) {
        brunt_tree_complain_at(tree, 0, 0, option, "%s has %d entries, there is none at [%d]", path, node->count,
                               index);
    }
    return child;
}

static void replace(scene_node *old, scene_node *fresh) {
    scene_node *parent = old->parent;
    fresh->parent = parent;
    fresh->next = old->next;
    fresh->rank = old->rank;
    if (parent->first == old) {
        parent->first = fresh;
    } else {
        scene_node *before = parent->first;
        while (before->next != old) before = before->next;
        before->next = fresh;
    }
    if (parent->last == old) parent->last = fresh;
    enter_all(parent);
}

void brunt_tree_set(scene_tree *tree, const char *option) {
    const char *equals = strchr(option, '=');
    if (!equals || equals == option) {
        brunt_tree_complain_at(tree, 0, 0, option, "path.to.key=value is wanted");
        return;
    }
    if (strlen(option) > 4096) {
        brunt_tree_complain_at(tree, 0, 0, "(...)", "an override longer than 4096 characters");
        return;
    }
    // Parsed at column 0 of a document of its own; messages name the option.
    scene_node *value = brunt_tree_parse(tree, equals + 1, strlen(equals + 1), option);
    if (!value) return;
    scene_node *node = tree->root;
    const char *p = option, *word;
    size_t length;
    for (int depth = 0; depth < SCENE_DEPTH_LIMIT / 2; depth++) {
        p = path_step(p, equals, &word, &length);
        if (!p) break;
        bool missing;
        scene_node *child = step_into(tree, node, word, length, option, &missing);
        if (!child && !missing) return;
        bool last = p == equals;
        if (last || !child) {
            scene_node *fresh = last ? value : brunt_tree_node(tree, SCENE_MAP);
            if (!fresh) return;
            fresh->option = option;
            if (node->kind == SCENE_MAP && !(fresh->key = brunt_tree_text(tree, word, length))) return;
            if (child)
                replace(child, fresh);
            else
                brunt_tree_append(node, fresh);
            child = fresh;
        }
        if (last) return;
        node = child;
    }
    brunt_tree_complain_at(tree, 0, 0, option,
                           "'%.*s' is not a path like bodies.rod.velocity or boundaries[0].friction",
                           (int)(equals - option), option);
}
