// YAML text to tree, through libfyaml's event interface.
//
// The events are taken rather than libfyaml's own document: aliases are then expanded under our budget, depth is cut
// where we say, and no stage of the library sees more than one event at a time. Text that is no text (binary, broken
// UTF-8) and tabs used as indentation are refused before it is called, with better messages than a scanner can give.
#include "io/scene/scene_keys.h"
#include "io/scene/scene_tree.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <libfyaml.h>

#include "base/memory.h"

typedef struct builder {
    scene_tree *tree;
    const char *option;
    scene_node *stack[SCENE_DEPTH_LIMIT]; // open maps and lists
    int depth;
    scene_node *root;
    struct {
        char *text;
        int line, column;
    } key[SCENE_DEPTH_LIMIT]; // of the value to come, per open map
    scene_node anchors;       // a map by name, of what has what an anchor names as its first
    int node_limit;           // values of the tree
    int line, column;         // of the last event that had a place
    int twice;                // messages about keys that are there twice, after which there is a tree yet
    bool stop;
} builder;

static void complain(builder *b, const char *message) {
    brunt_tree_complain_at(b->tree, b->option ? 0 : b->line, b->option ? 0 : b->column, b->option, "%s", message);
}

// Bytes of the UTF-8 character at p, 0 when it is not one that YAML text may hold.
static int character(const unsigned char *p, const unsigned char *end) {
    if (*p < 0x80) return *p >= 32 ? *p != 127 : *p == '\t' || *p == '\n' || *p == '\r';
    int length = *p >= 0xF0 ? 4 : *p >= 0xE0 ? 3 : *p >= 0xC2 ? 2 : 0;
    if (!length || *p > 0xF4 || end - p < length) return 0;
    for (int i = 1; i < length; i++)
        if ((p[i] & 0xC0) != 0x80) return 0;
    uint32_t code = length == 2   ? (p[0] & 0x1Fu) << 6 | (p[1] & 0x3Fu)
                    : length == 3 ? (p[0] & 0xFu) << 12 | (p[1] & 0x3Fu) << 6 | (p[2] & 0x3Fu)
                                  : (p[0] & 0x7u) << 18 | (p[1] & 0x3Fu) << 12 | (p[2] & 0x3Fu) << 6 | (p[3] & 0x3Fu);
    bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    bool surrogate = code >= 0xD800 && code < 0xE000;
    // C1 controls, and line separators and marks that would make our count of lines differ from the library's.
    bool refused = code < 0xA0 || code == 0x2028 || code == 0x2029 || code == 0xFEFF || code > 0x10FFFF;
    return overlong || surrogate || refused ? 0 : length;
}

static void complain_empty(builder *b) {
    char message[96];
    snprintf(message, sizeof message, "the file is empty: a %s starts with '%s'", b->tree->format->name,
             b->tree->format->first);
    complain(b, message);
}

// Text as far as it has been looked through.
typedef struct text_scan {
    const unsigned char *p, *end;
    bool indentation, tab; // in it; one was met there
    bool content;          // something that is no comment was met
    int nesting;           // an upper bound of the flow depth
} text_scan;

static void next_line(builder *b, text_scan *s) {
    b->line++;
    b->column = 1;
    s->indentation = true;
    s->tab = false;
    s->p++;
}

// Whether something other than a comment follows a tab in the indentation.
static bool indented_by_tab(const text_scan *s) {
    const unsigned char *q = s->p;
    while (q < s->end && (*q == ' ' || *q == '\t' || *q == '\r')) q++;
    return q < s->end && *q != '\n' && *q != '#';
}

// Brackets in a comment count for nothing.
static void pass_comment(builder *b, text_scan *s) {
    for (int bytes; s->p < s->end && *s->p != '\n' && (bytes = character(s->p, s->end)) != 0; s->p += bytes)
        b->column++;
}

// One character of a line, of so many bytes. False after a message.
static bool pass_character(builder *b, text_scan *s, int bytes) {
    const unsigned char c = *s->p;
    if (s->indentation && c == '\t' && !s->tab) {
        s->tab = true;
        if (indented_by_tab(s)) {
            complain(b, "a tab in the indentation: YAML is indented with spaces");
            return false;
        }
    }
    if (s->indentation && c == '#') {
        pass_comment(b, s);
        return true;
    }
    if (c != ' ' && c != '\t' && c != '\r') {
        s->indentation = false;
        s->content = true;
    }
    // The scanner keeps a record for each open bracket, and its time grows with them.
    if (c == '[' || c == '{') s->nesting++;
    if ((c == ']' || c == '}') && s->nesting > 0) s->nesting--;
    if (s->nesting > 4 * SCENE_DEPTH_LIMIT) {
        complain(b, "nested too deeply");
        return false;
    }
    s->p += bytes;
    b->column++;
    return true;
}

// False after one message when the text cannot be handed to the scanner.
static bool readable(builder *b, const char *text, size_t length) {
    const scene_format *format = b->tree->format;
    char message[96];
    text_scan s = {.p = (const unsigned char *)text, .end = (const unsigned char *)text + length, .indentation = true};
    b->line = b->column = 1;
    if (length > SCENE_TEXT_LIMIT) {
        snprintf(message, sizeof message, "the file is larger than %d MiB, too large for a %s", SCENE_TEXT_LIMIT >> 20,
                 format->name);
        complain(b, message);
        return false;
    }
    while (s.p < s.end) {
        int bytes = character(s.p, s.end);
        if (*s.p == '\r' && s.p + 1 < s.end && s.p[1] != '\n') bytes = 0; // old Macintosh line ends
        if (!bytes) {
            snprintf(message, sizeof message, "byte 0x%02X is not text: a %s is YAML in UTF-8", *s.p, format->name);
            complain(b, message);
            return false;
        }
        if (*s.p == '\n')
            next_line(b, &s);
        else if (!pass_character(b, &s, bytes))
            return false;
    }
    if (s.content) return true;
    b->line = b->column = 1;
    if (b->option)
        complain(b, "a value is wanted behind the '='");
    else
        complain_empty(b);
    return false;
}

// ---------------------------------------------------------------------------------------------------- events

static void take_place(builder *b, struct fy_event *event) {
    const struct fy_mark *mark = fy_event_start_mark(event);
    if (!mark) return;
    b->line = mark->line + 1;
    b->column = mark->column + 1;
    // The marks of aliases and quoted scalars stand behind their sign.
    bool signed_token = event->type == FYET_ALIAS;
    if (event->type == FYET_SCALAR) {
        enum fy_scalar_style style = fy_token_scalar_style(event->scalar.value);
        signed_token = style == FYSS_SINGLE_QUOTED || style == FYSS_DOUBLE_QUOTED;
    }
    if (signed_token && b->column > 1) b->column--;
}

static bool within_budget(builder *b) {
    if (b->tree->node_count < b->node_limit) return true;
    char message[96];
    snprintf(message, sizeof message, "more than %d values, with the aliases expanded", b->node_limit);
    complain(b, message);
    b->stop = true;
    return false;
}

static void complain_twice(builder *b, const scene_node *node, const scene_node *earlier) {
    const int before = b->tree->message_count;
    brunt_tree_complain_at(b->tree, b->option ? 0 : node->key_line, b->option ? 0 : node->key_column, b->option,
                           "the key '%.60s' is there twice, first on line %d", node->key, earlier->key_line);
    b->twice += b->tree->message_count - before;
}

// Puts a finished scalar, alias or opened container where it belongs: what takes its children. Of a key that is there
// twice the first is what is found by its name, and both are looked through; a section goes on with the first one.
static scene_node *place(builder *b, scene_node *node) {
    node->option = b->option;
    if (b->depth == 0) {
        b->root = node;
        return node;
    }
    scene_node *parent = b->stack[b->depth - 1];
    if (parent->kind == SCENE_MAP) {
        char *key = b->key[b->depth - 1].text;
        b->key[b->depth - 1].text = NULL;
        node->key = key;
        node->key_line = b->key[b->depth - 1].line;
        node->key_column = b->key[b->depth - 1].column;
        if (!b->option && (!node->line || node->kind == SCENE_MAP || node->kind == SCENE_LIST)) {
            // Block collections begin on the line below their key, empty values nowhere.
            if (!node->line) node->line = node->key_line, node->column = node->key_column;
        }
        scene_node *earlier = brunt_tree_child(parent, key);
        if (earlier) complain_twice(b, node, earlier);
        if (earlier && b->depth == 1 && node->kind == SCENE_MAP && earlier->kind == SCENE_MAP && !node->first)
            return earlier;
    }
    brunt_tree_append(parent, node);
    return node;
}

// An escape ("\\0") can make what no text of ours holds: it would end there.
static char *token_text(builder *b, struct fy_token *token) {
    size_t length = 0;
    const char *text = token ? fy_token_get_text(token, &length) : NULL;
    if (text && memchr(text, 0, length)) complain(b, "a NUL character (\\0) in text");
    return brunt_tree_text(b->tree, text ? text : "", text ? length : 0);
}

static bool key_is_due(const builder *b) {
    return b->depth > 0 && b->stack[b->depth - 1]->kind == SCENE_MAP && !b->key[b->depth - 1].text;
}

static void remember_anchor(builder *b, struct fy_token *token, scene_node *node) {
    if (!token) return;
    char *name = token_text(b, token);
    if (!name) return;
    scene_node *a = brunt_tree_child(&b->anchors, name);
    if (!a) { // else it names something else from now on
        a = brunt_tree_alloc(b->tree, sizeof *a);
        if (!a) return;
        *a = (scene_node){.key = name};
        brunt_tree_append(&b->anchors, a);
    }
    a->first = node;
}

static void refuse_tag(builder *b, struct fy_token *tag) {
    if (tag) complain(b, "tags (!...) are not used in scenes");
}

static void on_scalar(builder *b, struct fy_event *event) {
    refuse_tag(b, event->scalar.tag);
    char *text = token_text(b, event->scalar.value);
    if (!text || !within_budget(b)) return;
    if (key_is_due(b)) {
        if (strlen(text) > 200) {
            complain(b, "a key longer than 200 characters");
            b->stop = true;
            return;
        }
        if (event->scalar.anchor) complain(b, "an anchor (&) on a key");
        b->key[b->depth - 1].text = text;
        b->key[b->depth - 1].line = b->option ? 0 : b->line;
        b->key[b->depth - 1].column = b->option ? 0 : b->column;
        scene_node *map = b->stack[b->depth - 1];
        if (!map->line && !b->option) map->line = b->line, map->column = b->column;
        return;
    }
    scene_node *node = brunt_tree_node(b->tree, SCENE_SCALAR);
    if (!node) return;
    node->text = text;
    node->plain = fy_token_scalar_style(event->scalar.value) == FYSS_PLAIN;
    // An empty value has the place of whatever comes next; its key says more.
    if (!b->option && (*text || !node->plain)) node->line = b->line, node->column = b->column;
    remember_anchor(b, event->scalar.anchor, node);
    place(b, node);
}

static void on_open(builder *b, scene_kind kind, struct fy_token *name, struct fy_token *tag) {
    refuse_tag(b, tag);
    if (!within_budget(b)) return;
    if (key_is_due(b)) {
        complain(b, "a key must be a plain word");
        b->stop = true;
        return;
    }
    if (b->depth >= SCENE_DEPTH_LIMIT) {
        complain(b, "nested too deeply");
        b->stop = true;
        return;
    }
    scene_node *node = brunt_tree_node(b->tree, kind);
    if (!node) return;
    if (!b->option) node->line = b->line, node->column = b->column;
    node = place(b, node);
    remember_anchor(b, name, node);
    b->key[b->depth].text = NULL;
    b->stack[b->depth++] = node;
}

static scene_node *copy(builder *b, const scene_node *from, int depth) {
    if (b->stop || !within_budget(b)) return NULL;
    if (depth >= SCENE_DEPTH_LIMIT) {
        complain(b, "nested too deeply, with the aliases expanded");
        b->stop = true;
        return NULL;
    }
    scene_node *node = brunt_tree_node(b->tree, from->kind);
    if (!node) return NULL;
    node->text = from->text;
    node->plain = from->plain;
    node->line = from->line, node->column = from->column;
    node->key_line = from->key_line, node->key_column = from->key_column;
    node->option = from->option;
    for (const scene_node *child = from->first; child; child = child->next) {
        scene_node *twin = copy(b, child, depth + 1);
        if (!twin) return NULL;
        twin->key = child->key;
        brunt_tree_append(node, twin);
    }
    return node;
}

static void on_alias(builder *b, struct fy_event *event) {
    char *name = token_text(b, event->alias.anchor);
    if (!name) return;
    if (key_is_due(b)) {
        complain(b, "an alias (*) as a key");
        b->stop = true;
        return;
    }
    const scene_node *a = brunt_tree_child(&b->anchors, name);
    char message[160];
    bool inside = false;
    for (int i = 0; a && i < b->depth; i++) inside |= b->stack[i] == a->first;
    if (!a || inside) {
        snprintf(message, sizeof message,
                 a ? "the alias *%.60s stands inside of what it names" : "the alias *%.60s names no anchor above it",
                 name);
        complain(b, message);
        b->stop = true;
        return;
    }
    scene_node *node = copy(b, a->first, b->depth);
    if (node) place(b, node);
}

// ---------------------------------------------------------------------------------------------------- the parser

static void no_output(struct fy_diag *diag, void *user, const char *text, size_t length) {
    (void)diag, (void)user, (void)text, (void)length;
}

// The first thing the library complained about; what follows is mostly its consequence.
static void report_syntax(builder *b, struct fy_diag *diag) {
    void *iterator = NULL;
    struct fy_diag_error *error = fy_diag_errors_iterate(diag, &iterator);
    if (!error) {
        complain(b, "this is not YAML");
        return;
    }
    int line = error->line > 0 ? error->line : b->line, column = error->column > 0 ? error->column : b->column;
    brunt_tree_complain_at(b->tree, b->option ? 0 : line, b->option ? 0 : column, b->option, "not YAML: %s",
                           error->msg ? error->msg : "syntax error");
}

static void on_event(builder *b, struct fy_event *event, int *documents) {
    take_place(b, event);
    switch (event->type) {
    case FYET_DOCUMENT_START:
        if (++*documents > 1) {
            complain(b, "a second document starts here: one is wanted");
            b->stop = true;
        }
        break;
    case FYET_SCALAR: on_scalar(b, event); break;
    case FYET_ALIAS: on_alias(b, event); break;
    case FYET_MAPPING_START: on_open(b, SCENE_MAP, event->mapping_start.anchor, event->mapping_start.tag); break;
    case FYET_SEQUENCE_START: on_open(b, SCENE_LIST, event->sequence_start.anchor, event->sequence_start.tag); break;
    case FYET_MAPPING_END:
    case FYET_SEQUENCE_END:
        if (b->depth > 0) b->depth--;
        break;
    default: break;
    }
}

static const char byte_order_mark[] = "\xEF\xBB\xBF"; // of UTF-8: it may stand first, and says nothing

scene_node *brunt_tree_parse(scene_tree *tree, const char *text, size_t length, const char *option) {
    if (!option && length >= 3 && !memcmp(text, byte_order_mark, 3)) text += 3, length -= 3;
    builder b = {.tree = tree, .option = option, .anchors = {.kind = SCENE_MAP}, .line = 1, .column = 1};
    int messages = tree->message_count;
    if (!readable(&b, text, length)) return NULL;
    const int typed = tree->node_count + (int)(length / 2);
    b.node_limit = typed > SCENE_FEW_NODES ? typed : SCENE_FEW_NODES;
    b.line = b.column = 1;
    struct fy_diag_cfg diag_cfg;
    fy_diag_cfg_default(&diag_cfg);
    diag_cfg.fp = NULL;
    diag_cfg.output_fn = no_output;
    diag_cfg.colorize = false;
    struct fy_diag *diag = fy_diag_create(&diag_cfg);
    if (!diag) {
        tree->exhausted = true;
        return NULL;
    }
    fy_diag_set_collect_errors(diag, true);
    struct fy_parse_cfg cfg = {.flags = FYPCF_QUIET | FYPCF_COLLECT_DIAG | FYPCF_JSON_NONE | FYPCF_DEFAULT_VERSION_1_2,
                               .diag = diag};
    struct fy_parser *parser = fy_parser_create(&cfg);
    int documents = 0;
    bool ended = false;
    if (parser && fy_parser_set_string(parser, text, length) == 0) {
        while (!b.stop && !tree->exhausted && !ended) {
            struct fy_event *event = fy_parser_parse(parser);
            if (!event) break;
            ended = event->type == FYET_STREAM_END;
            on_event(&b, event, &documents);
            fy_parser_event_free(parser, event);
        }
        if (!b.stop && !tree->exhausted && (!ended || fy_parser_get_stream_error(parser))) report_syntax(&b, diag);
    } else {
        tree->exhausted = true;
    }
    if (parser) fy_parser_destroy(parser);
    fy_diag_destroy(diag);
    if (!b.root && tree->message_count == messages && !tree->exhausted) {
        b.line = b.column = 1;
        complain_empty(&b);
    }
    return tree->message_count == messages + b.twice && !tree->exhausted ? b.root : NULL;
}
