// Reads a file of gmsh, section by section. The whole file is in memory; a count is believed only when the bytes for it
// are there.
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/error.h"
#include "io/file/input_file.h"
#include "io/mesh/gmsh_cursor.h"
#include "io/mesh/gmsh_file.h"
#include "io/mesh/gmsh_nodes.h"
#include "base/array.h"
#include "base/memory.h"

const gmsh_type gmsh_types[] = {
    [1] = {1, 2, "2-node lines"},         [2] = {2, 3, "3-node triangles"},     [3] = {2, 4, "4-node quadrangles"},
    [4] = {3, 4, "4-node tetrahedra"},    [5] = {3, 8, "8-node hexahedra"},     [6] = {3, 6, "6-node prisms"},
    [7] = {3, 5, "5-node pyramids"},      [8] = {1, 3, "3-node lines"},         [9] = {2, 6, "6-node triangles"},
    [10] = {2, 9, "9-node quadrangles"},  [11] = {3, 10, "10-node tetrahedra"}, [12] = {3, 27, "27-node hexahedra"},
    [13] = {3, 18, "18-node prisms"},     [14] = {3, 14, "14-node pyramids"},   [15] = {0, 1, "points"},
    [16] = {2, 8, "8-node quadrangles"},  [17] = {3, 20, "20-node hexahedra"},  [18] = {3, 15, "15-node prisms"},
    [19] = {3, 13, "13-node pyramids"},   [20] = {2, 9, "9-node triangles"},    [21] = {2, 10, "10-node triangles"},
    [22] = {2, 12, "12-node triangles"},  [23] = {2, 15, "15-node triangles"},  [24] = {2, 15, "15-node triangles"},
    [25] = {2, 21, "21-node triangles"},  [26] = {1, 4, "4-node lines"},        [27] = {1, 5, "5-node lines"},
    [28] = {1, 6, "6-node lines"},        [29] = {3, 20, "20-node tetrahedra"}, [30] = {3, 35, "35-node tetrahedra"},
    [31] = {3, 56, "56-node tetrahedra"},
};
_Static_assert(BRUNT_COUNT(gmsh_types) == GMSH_TYPE_LIMIT, "types up to the limit");

// Physical groups are searched one by one, for every run of elements.
enum { PHYSICAL_LIMIT = 4096 };

// Whether `array` has room for `more` elements after the `used` it keeps. False, with the status set: out of memory.
#define RESERVE(c, array, capacity, used, more)                                                                        \
    (!(c)->status && has_capacity((c), BRUNT_RESERVE_IN(array, capacity, (size_t)(used) + (more), (size_t)(used))))
static bool has_capacity(gmsh_cursor *c, int status) {
    if (status) gmsh_out_of_memory(c);
    return !status;
}

// ---------------------------------------------------------------------------------------------------- physical groups

static char *copy_text(const char *from, size_t length) {
    char *copy = brunt_alloc(length + 1);
    if (copy) memcpy(copy, from, length);
    return copy;
}

// Index of a physical group, which is made when it is new; -1 after an error.
static int32_t physical_index(gmsh_cursor *c, int dimension, int32_t tag) {
    gmsh_file *file = c->file;
    for (int32_t p = 0; p < file->physical_count; p++)
        if (file->physicals[p].tag == tag && file->physicals[p].dimension == dimension) return p;
    if (file->physical_count == PHYSICAL_LIMIT)
        gmsh_complain(c, c->at, "more than %d physical groups", (int)PHYSICAL_LIMIT);
    if (!RESERVE(c, file->physicals, file->physical_capacity, file->physical_count, 1)) return BRUNT_NONE;
    char number[16];
    int length = snprintf(number, sizeof number, "%d", (int)tag);
    gmsh_physical physical = {.dimension = dimension, .tag = tag, .name = copy_text(number, (size_t)length)};
    if (!physical.name) {
        gmsh_out_of_memory(c);
        return BRUNT_NONE;
    }
    file->physicals[file->physical_count] = physical;
    return file->physical_count++;
}

static void add_membership(gmsh_cursor *c, int32_t physical) {
    gmsh_file *file = c->file;
    if (physical < 0 || !RESERVE(c, file->memberships, file->membership_capacity, file->membership_count, 1)) return;
    file->memberships[file->membership_count++] = physical;
}

static void read_physical_names(gmsh_cursor *c) {
    int64_t count = gmsh_count(c, 8, 6, 1, "the number of physical names");
    gmsh_end_line(c);
    for (int64_t i = 0; i < count && !c->status; i++) {
        gmsh_begin_line(c);
        const char *line = c->at;
        int32_t dimension = gmsh_tag(c, "the dimension of a physical group"),
                tag = gmsh_tag(c, "the number of a physical group");
        if (c->status) return;
        const char *end = memchr(c->at, '\n', (size_t)(c->end - c->at));
        if (!end) end = c->end;
        const char *open = memchr(c->at, '"', (size_t)(end - c->at));
        const char *close = open ? memrchr(open + 1, '"', (size_t)(end - open - 1)) : NULL;
        if (dimension < 0 || dimension > 3)
            gmsh_complain(c, line, "a physical group of dimension %d", (int)dimension);
        else if (!close)
            gmsh_complain(c, line, "the name of physical group %d is not in quotes", (int)tag);
        else if (memchr(open, 0, (size_t)(close - open)))
            gmsh_complain(c, line, "the name of physical group %d holds a zero byte", (int)tag);
        if (c->status) return;
        int32_t known = c->file->physical_count, p = physical_index(c, dimension, tag);
        if (p >= 0 && p < known)
            gmsh_complain(c, line, "physical group %d of dimension %d has two names", (int)tag, (int)dimension);
        if (c->status) return;
        brunt_free(c->file->physicals[p].name);
        c->file->physicals[p].name = copy_text(open + 1, (size_t)(close - open - 1));
        if (!c->file->physicals[p].name) gmsh_out_of_memory(c);
        c->at = close + 1;
        gmsh_end_line(c);
    }
}

// ---------------------------------------------------------------------------------------------------- entities

static int by_entity(const void *a, const void *b) {
    const gmsh_entity *p = a, *q = b;
    if (p->dimension != q->dimension) return p->dimension - q->dimension;
    return (p->tag > q->tag) - (p->tag < q->tag);
}

// Entities are read as a stream of numbers: their lists may be long, and are broken into lines by some programs.
static int64_t list_length(gmsh_cursor *c, const char *what) {
    gmsh_begin_line(c);
    return gmsh_count(c, 8, 2, 4, what);
}

static void read_entity(gmsh_cursor *c, int dimension) {
    gmsh_file *file = c->file;
    gmsh_begin_line(c);
    gmsh_entity entity = {
        .dimension = dimension, .tag = gmsh_tag(c, "the tag of an entity"), .physical_first = file->membership_count};
    for (int i = 0; i < (dimension == 0 ? 3 : 6); i++) {
        gmsh_begin_line(c);
        gmsh_real(c, "a coordinate of an entity");
    }
    int64_t count = list_length(c, "the number of physical groups of an entity");
    for (int64_t i = 0; i < count && !c->status; i++) {
        gmsh_begin_line(c);
        int32_t tag = gmsh_tag(c, "the number of a physical group");
        if (c->status) return;
        // The sign says that elements are to be turned over in the group; the elements here are as they are.
        add_membership(c, physical_index(c, dimension, abs(tag)));
    }
    entity.physical_count = file->membership_count - entity.physical_first;
    int64_t bounds = dimension == 0 ? 0 : list_length(c, "the number of entities that bound an entity");
    for (int64_t i = 0; i < bounds && !c->status; i++) {
        gmsh_begin_line(c);
        gmsh_tag(c, "the tag of an entity");
    }
    if (!RESERVE(c, file->entities, file->entity_capacity, file->entity_count, 1)) return;
    file->entities[file->entity_count++] = entity;
}

static void read_entities(gmsh_cursor *c) {
    static const char *const what[4] = {"the number of points", "the number of curves", "the number of surfaces",
                                        "the number of volumes"};
    int64_t count[4];
    for (int d = 0; d < 4; d++) {
        gmsh_begin_line(c);
        count[d] = gmsh_count(c, 8, d ? 18 : 10, d ? 68 : 36, what[d]);
    }
    for (int d = 0; d < 4; d++)
        for (int64_t i = 0; i < count[d] && !c->status; i++) read_entity(c, d);
    if (!c->status && c->file->entity_count)
        qsort(c->file->entities, (size_t)c->file->entity_count, sizeof *c->file->entities, by_entity);
}

// ---------------------------------------------------------------------------------------------------- elements

// The type's table entry after a check; NULL after an error.
static const gmsh_type *element_type(gmsh_cursor *c, const char *at, int64_t type) {
    if (!c->status && (type < 1 || type >= GMSH_TYPE_LIMIT || !gmsh_types[type].nodes))
        gmsh_complain(c, at, "elements of type %lld, which is not known", (long long)type);
    return c->status ? NULL : &gmsh_types[type];
}

static gmsh_run *add_run(gmsh_cursor *c, int32_t type, int32_t physical_first, int32_t physical_count) {
    gmsh_file *file = c->file;
    if (!RESERVE(c, file->runs, file->run_capacity, file->run_count, 1)) return NULL;
    gmsh_run *run = &file->runs[file->run_count++];
    *run = (gmsh_run){.type = type,
                      .first = file->element_node_count,
                      .physical_first = physical_first,
                      .physical_count = physical_count};
    return run;
}

// The nodes of one element, after its number and tags. There must be room for them.
static void read_element_nodes(gmsh_cursor *c, int nodes, int bytes) {
    gmsh_file *file = c->file;
    for (int a = 0; a < nodes; a++) {
        const char *at = c->at;
        int64_t tag = gmsh_integer(c, bytes, "the number of a node");
        if (c->status) return;
        int32_t node = gmsh_find_node(file, tag);
        if (node < 0) gmsh_complain(c, at, "an element of node %lld, which $Nodes does not have", (long long)tag);
        file->element_nodes[file->element_node_count++] = node;
    }
    file->element_count++;
    gmsh_end_line(c);
}

static bool reserve_elements(gmsh_cursor *c, int64_t count, int nodes) {
    gmsh_file *file = c->file;
    return RESERVE(c, file->element_nodes, file->element_node_capacity, file->element_node_count,
                   (size_t)count * (size_t)nodes);
}

// The tags of one element: the first is its physical group, 0 for none.
static int32_t element_physical(gmsh_cursor *c, int64_t tags) {
    int32_t physical = 0;
    for (int64_t t = 0; t < tags && !c->status; t++) {
        int32_t tag = gmsh_tag(c, "a tag of an element");
        if (t == 0) physical = abs(tag);
    }
    return physical;
}

static void add_element_2(gmsh_cursor *c, int32_t type, int32_t tag) {
    gmsh_file *file = c->file;
    const gmsh_type *known = &gmsh_types[type];
    gmsh_run *run = file->run_count ? &file->runs[file->run_count - 1] : NULL;
    int32_t physical = tag ? physical_index(c, known->dimension, tag) : -1;
    if (c->status) return;
    int32_t of_run = run && run->physical_count ? file->memberships[run->physical_first] : -1;
    if (!run || run->type != type || of_run != physical) {
        int32_t first = file->membership_count;
        if (physical >= 0) add_membership(c, physical);
        run = c->status ? NULL : add_run(c, type, first, physical >= 0);
    }
    if (!run || !reserve_elements(c, 1, known->nodes)) return;
    run->count++;
    read_element_nodes(c, known->nodes, 4);
}

static void read_elements_2_text(gmsh_cursor *c, int64_t count) {
    for (int64_t i = 0; i < count && !c->status; i++) {
        gmsh_begin_line(c);
        gmsh_integer(c, 4, "the number of an element");
        const char *at = c->at;
        int64_t type = gmsh_integer(c, 4, "the type of an element");
        int64_t tags = gmsh_count(c, 4, 1, 4, "the number of tags of an element");
        if (!element_type(c, at, type)) return;
        int32_t physical = element_physical(c, tags);
        if (!c->status) add_element_2(c, (int32_t)type, physical);
    }
}

static void read_elements_2_binary(gmsh_cursor *c, int64_t count) {
    for (int64_t done = 0; done < count && !c->status;) {
        const char *at = c->at;
        int64_t type = gmsh_integer(c, 4, "the type of elements");
        int64_t follow = gmsh_count(c, 4, 1, 8, "the number of elements that follow");
        int64_t tags = gmsh_count(c, 4, 1, 4, "the number of tags of elements");
        if (!element_type(c, at, type)) return;
        if (follow == 0 || follow > count - done)
            gmsh_complain(c, at, "a block of %lld elements, where %lld are left of the %lld of $Elements",
                          (long long)follow, (long long)(count - done), (long long)count);
        for (int64_t i = 0; i < follow && !c->status; i++) {
            gmsh_integer(c, 4, "the number of an element");
            int32_t physical = element_physical(c, tags);
            if (!c->status) add_element_2(c, (int32_t)type, physical);
        }
        done += follow;
    }
}

static void read_elements_4(gmsh_cursor *c) {
    gmsh_file *file = c->file;
    int64_t blocks = gmsh_count(c, 8, 8, 20, "the number of blocks of elements");
    int64_t total = gmsh_count(c, 8, 4, 16, "the number of elements");
    gmsh_integer(c, 8, "the least element number");
    gmsh_integer(c, 8, "the greatest element number");
    gmsh_end_line(c);
    for (int64_t b = 0; b < blocks && !c->status; b++) {
        gmsh_begin_line(c);
        const char *at = c->at;
        gmsh_entity key = {.dimension = gmsh_tag(c, "the dimension of an entity"),
                           .tag = gmsh_tag(c, "the tag of an entity")};
        int32_t type = gmsh_tag(c, "the type of elements");
        int64_t count = gmsh_count(c, 8, 4, 16, "the number of elements of a block");
        gmsh_end_line(c);
        const gmsh_type *known = element_type(c, at, type);
        if (!known) return;
        if (known->dimension != key.dimension)
            gmsh_complain(c, at, "a block of %s of dimension %d", known->name, (int)key.dimension);
        if (count > total - file->element_count)
            gmsh_complain(c, at, "more elements than the %lld that $Elements begins with", (long long)total);
        // Every node takes 2 bytes of text, 8 of binary: what is allocated stays in proportion to the file.
        if ((uint64_t)count * (uint64_t)known->nodes > (size_t)(c->end - c->at) / (c->binary ? 8 : 2))
            gmsh_complain(c, at, "%lld %s, but only %zu bytes of the file follow", (long long)count, known->name,
                          (size_t)(c->end - c->at));
        const gmsh_entity *entity =
            file->entity_count ? bsearch(&key, file->entities, (size_t)file->entity_count, sizeof key, by_entity)
                               : NULL;
        if (!reserve_elements(c, count, known->nodes)) return;
        gmsh_run *run = add_run(c, type, entity ? entity->physical_first : 0, entity ? entity->physical_count : 0);
        if (!run) return;
        run->count = count;
        for (int64_t i = 0; i < count && !c->status; i++) {
            gmsh_begin_line(c);
            gmsh_integer(c, 8, "the number of an element");
            read_element_nodes(c, known->nodes, 8);
        }
    }
    if (file->element_count != total)
        gmsh_complain(c, c->at, "%lld elements instead of the %lld that $Elements begins with",
                      (long long)file->element_count, (long long)total);
}

// ---------------------------------------------------------------------------------------------------- sections

static bool starts_with(const gmsh_cursor *c, const char *text) {
    size_t length = strlen(text);
    return (size_t)(c->end - c->at) >= length && !memcmp(c->at, text, length);
}

static bool version_4(const gmsh_file *file) { return file->version[0] == '4'; }

// To the first byte after the line, which must have nothing more.
static void pass_line(gmsh_cursor *c) {
    gmsh_end_line(c);
    if (c->status) return;
    if (c->at < c->end && *c->at == '\n')
        c->at++;
    else
        gmsh_complain(c, c->at, "the file ends in %s", c->section);
}

static void read_format(gmsh_cursor *c) {
    gmsh_file *file = c->file;
    gmsh_begin_line(c);
    gmsh_word version = gmsh_next_word(c);
    bool known = version.length == 3 && (!memcmp(version.at, "2.2", 3) || !memcmp(version.at, "4.1", 3));
    if (version.length == 0) gmsh_complain(c, version.at, "the file ends where the version of its format is wanted");
    if (!known)
        gmsh_complain(c, version.at, "format %.*s: 4.1 and 2.2 are read (gmsh FILE -save -format msh41)",
                      version.length, version.at);
    const char *at = c->at;
    int32_t binary = gmsh_tag(c, "0 (text) or 1 (binary)"), size = gmsh_tag(c, "the size of numbers");
    if (binary != 0 && binary != 1) gmsh_complain(c, at, "file type %d, 0 (text) or 1 (binary) is wanted", (int)binary);
    if (size != 8) gmsh_complain(c, at, "numbers of %d bytes, 8 are wanted", (int)size);
    if (c->status) return;
    memcpy(file->version, version.at, 3);
    if (!binary) return;
    pass_line(c);
    file->binary = c->binary = true;
    at = c->at;
    int64_t one = gmsh_integer(c, 4, "the mark of the byte order");
    c->binary = false;
    if (one == 0x01000000)
        gmsh_complain(c, at,
                      "written with the other byte order: write it again on a machine like this one, or as text");
    if (one != 1) gmsh_complain(c, at, "the mark of the byte order is %lld, 1 is wanted", (long long)one);
}

static void read_nodes(gmsh_cursor *c) {
    if (version_4(c->file)) {
        gmsh_read_nodes_4(c);
    } else {
        c->binary = false; // the count is text in any case
        int64_t count = gmsh_count(c, 8, c->file->binary ? 28 : 7, 1, "the number of nodes");
        pass_line(c);
        c->file->node_count = (int32_t)count;
        c->binary = c->file->binary;
        gmsh_read_nodes_2(c);
    }
    gmsh_number_nodes(c);
}

static void read_elements(gmsh_cursor *c) {
    if (!c->file->node_tag) gmsh_complain(c, c->at, "$Elements before $Nodes");
    if (version_4(c->file)) {
        read_elements_4(c);
        return;
    }
    c->binary = false;
    int64_t count = gmsh_count(c, 8, c->file->binary ? 8 : 7, 1, "the number of elements");
    pass_line(c);
    c->binary = c->file->binary;
    if (c->binary)
        read_elements_2_binary(c, count);
    else
        read_elements_2_text(c, count);
}

typedef struct section {
    const char *name;
    void (*read)(gmsh_cursor *c);
    bool in_binary; // in binary files its numbers are
    char only;      // version, 0: both
} section;
static const section sections[] = {
    {"$MeshFormat", read_format, false, 0},  {"$PhysicalNames", read_physical_names, false, 0},
    {"$Entities", read_entities, true, '4'}, {"$Nodes", read_nodes, true, 0},
    {"$Elements", read_elements, true, 0},
};
enum { SECTIONS = sizeof sections / sizeof *sections };

static void close_section(gmsh_cursor *c, const char *name) {
    char closing[64];
    int length = snprintf(closing, sizeof closing, "$End%s", name + 1);
    c->binary = false;
    if (c->status) return;
    gmsh_skip_blank(c);
    const char *at = c->at;
    gmsh_word word = gmsh_next_word(c);
    if (word.length == length && !memcmp(word.at, closing, (size_t)length)) return;
    if (at == c->end)
        gmsh_complain(c, at, "the file ends where %s is wanted", closing);
    else if (c->file->binary)
        gmsh_complain(c, at, "%s is wanted here", closing);
    else
        gmsh_complain(c, at, "'%.*s' where %s is wanted", word.length < 40 ? word.length : 40, word.at, closing);
}

// Over a section that has nothing to say here, like $Comments, $Periodic, $NodeData.
static void pass_section(gmsh_cursor *c, gmsh_word name) {
    char closing[256];
    int length = snprintf(closing, sizeof closing, "\n$End%.*s", name.length - 1, name.at + 1);
    if (name.length > 12 && !memcmp(name.at, "$Partitioned", 12))
        gmsh_complain(c, name.at, "the mesh is cut into partitions: save it without them");
    if (c->status) return;
    const char *found = memmem(c->at, (size_t)(c->end - c->at), closing, (size_t)length);
    if (!found) {
        gmsh_complain(c, name.at, "%.*s is not closed", name.length, name.at);
        return;
    }
    c->at = found + length;
}

static void read_section(gmsh_cursor *c, bool seen[SECTIONS]) {
    gmsh_word name = gmsh_next_word(c);
    int s = 0;
    while (s < SECTIONS && !(strlen(sections[s].name) == (size_t)name.length &&
                             !memcmp(sections[s].name, name.at, (size_t)name.length)))
        s++;
    if (*name.at != '$' || name.length < 2 || starts_with(&(gmsh_cursor){.at = name.at, .end = c->end}, "$End")) {
        gmsh_complain(c, name.at, "'%.*s' where a section like $Nodes is wanted", name.length < 40 ? name.length : 40,
                      name.at);
    } else if (s == SECTIONS) {
        pass_section(c, name);
    } else if (s > 0 && !seen[0]) {
        gmsh_complain(c, name.at, "%s before $MeshFormat", sections[s].name);
    } else if (seen[s]) {
        gmsh_complain(c, name.at, "a second %s", sections[s].name);
    } else if (sections[s].only && sections[s].only != c->file->version[0]) {
        gmsh_complain(c, name.at, "%s in a file of format %s", sections[s].name, c->file->version);
    } else {
        seen[s] = true;
        c->section = sections[s].name;
        pass_line(c);
        c->binary = c->file->binary && sections[s].in_binary;
        if (!c->status) sections[s].read(c);
        close_section(c, sections[s].name);
    }
}

static int load(gmsh_file *file, brunt_error *error) {
    struct stat status;
    const char *why;
    FILE *stream = brunt_input_open(file->path, &why);
    if (!stream) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", file->path, why);
    int result = BRUNT_OK;
    if (fstat(fileno(stream), &status)) {
        result = brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot read the file: %s", file->path, strerror(errno));
    } else {
        file->size = (size_t)status.st_size;
        file->bytes = brunt_alloc(file->size + 1); // a 0 behind it stops strtod
        if (!file->bytes)
            result = brunt_fail(error, BRUNT_FAILED, "%s: no memory for its %zu bytes", file->path, file->size);
        else if (fread(file->bytes, 1, file->size, stream) != file->size)
            result = brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot read the file: %s", file->path,
                                ferror(stream) ? strerror(errno) : "it became shorter meanwhile");
    }
    fclose(stream);
    return result;
}

int gmsh_file_read(const char *path, gmsh_file *file, brunt_error *error) {
    *file = (gmsh_file){.path = path};
    int status = load(file, error);
    if (status) return status;
    gmsh_cursor c = {
        .file = file, .at = file->bytes, .end = file->bytes + file->size, .section = "the file", .error = error};
    bool seen[SECTIONS] = {false};
    if (file->size >= 3 && !memcmp(file->bytes, "\xEF\xBB\xBF", 3)) c.at += 3; // a byte order mark of UTF-8
    gmsh_skip_blank(&c);
    if (c.at == c.end || *c.at != '$')
        gmsh_complain(&c, c.at, "not a mesh of gmsh: it does not begin with $MeshFormat");
    while (!c.status && c.at < c.end) {
        read_section(&c, seen);
        if (!c.status) gmsh_skip_blank(&c);
    }
    for (int s = 0; s < SECTIONS && !c.status; s++)
        if (!seen[s] && (s == 0 || sections[s].read == read_nodes || sections[s].read == read_elements))
            gmsh_complain(&c, c.at, "the file ends without %s", sections[s].name);
    return c.status;
}

void gmsh_file_free(gmsh_file *file) {
    for (int32_t p = 0; p < file->physical_count; p++) brunt_free(file->physicals[p].name);
    brunt_free(file->physicals);
    brunt_free(file->memberships);
    brunt_free(file->entities);
    brunt_free(file->node_tag);
    brunt_free(file->x);
    brunt_free(file->node_of);
    brunt_free(file->numbered);
    brunt_free(file->runs);
    brunt_free(file->element_nodes);
    brunt_free(file->bytes);
    *file = (gmsh_file){0};
}
