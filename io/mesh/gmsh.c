// From a file of gmsh to the mesh of one body: which elements, which nodes, which groups.
#include "io/mesh/gmsh.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "io/mesh/gmsh_file.h"
#include "base/memory.h"
#include "base/text.h"
#include "geometry/element_traits.h"

// A mesh of two dimensions may be out of the plane by this share of its extent: rounding of the program that made it.
static const double plane_tolerance = 1e-9;

// ---------------------------------------------------------------------------------------------------- sentences

typedef struct sentence {
    char text[900];
    size_t length;
} sentence;

static void __attribute__((format(printf, 2, 3))) add(sentence *s, const char *format, ...) {
    if (s->length >= sizeof s->text) return;
    va_list arguments;
    va_start(arguments, format);
    s->length += (size_t)vsnprintf(s->text + s->length, sizeof s->text - s->length, format, arguments);
    va_end(arguments);
}

// ---------------------------------------------------------------------------------------------------- groups

static bool is_member(const gmsh_file *file, const gmsh_run *run, const bool *wanted) {
    for (int32_t p = 0; p < run->physical_count; p++)
        if (wanted[file->memberships[run->physical_first + p]]) return true;
    return false;
}

static int64_t count_members(const gmsh_file *file, int32_t physical) {
    int64_t count = 0;
    for (int32_t r = 0; r < file->run_count; r++)
        for (int32_t p = 0; p < file->runs[r].physical_count; p++)
            if (file->memberships[file->runs[r].physical_first + p] == physical) {
                count += file->runs[r].count;
                break;
            }
    return count;
}

// "'rod' (3D, 120 elements), 'wall' (2D, 8 elements)"; of all dimensions, or one.
static void list_groups(const gmsh_file *file, int dimension, sentence *s) {
    enum { SHOWN = 12 };
    int32_t shown = 0, all = 0;
    for (int32_t p = 0; p < file->physical_count; p++) {
        const gmsh_physical *group = &file->physicals[p];
        if (dimension >= 0 && group->dimension != dimension) continue;
        if (all++ >= SHOWN) continue;
        add(s, "%s'%.40s' (%dD, %lld elements)", shown++ ? ", " : "", group->name, (int)group->dimension,
            (long long)count_members(file, p));
    }
    if (all > SHOWN) add(s, " and %d more", (int)(all - SHOWN));
    if (!all) add(s, "none");
}

static int fail_missing(const gmsh_file *file, const char *group, int dimension, brunt_error *error) {
    const char **names = brunt_alloc((size_t)(file->physical_count + 1) * sizeof *names);
    sentence s = {.length = 0};
    add(&s, "%s: no physical group '%.60s' of dimension %d", file->path, group, dimension);
    if (names) {
        int count = 0;
        for (int32_t p = 0; p < file->physical_count; p++)
            if (file->physicals[p].dimension == dimension) names[count++] = file->physicals[p].name;
        const char *nearest = brunt_nearest_name(group, names, count);
        if (nearest) add(&s, ", did you mean '%.60s'?", nearest);
    }
    add(&s, "%s", names && s.text[s.length - 1] == '?' ? " There are: " : "; there are: ");
    list_groups(file, -1, &s);
    brunt_free(names);
    return brunt_fail(error, BRUNT_BAD_INPUT, "%s", s.text);
}

// ---------------------------------------------------------------------------------------------------- which elements

// What is made into a mesh: runs of elements of the dimension, of the wanted physical groups or all.
typedef struct selection {
    const gmsh_file *file;
    int dimension;
    bool membrane;    // a surface in three dimensions
    const char *what; // "sheet": it is, for messages
    bool all;
    bool *wanted; // of each physical group
    const char *name;
} selection;

static bool selects(const selection *s, const gmsh_run *run) {
    return gmsh_types[run->type].dimension == s->dimension && (s->all || is_member(s->file, run, s->wanted));
}

static int select_all(selection *s, brunt_error *error) {
    const gmsh_file *file = s->file;
    int32_t groups = 0;
    for (int32_t p = 0; p < file->physical_count; p++) groups += file->physicals[p].dimension == s->dimension;
    for (int32_t r = 0; r < file->run_count; r++)
        if (gmsh_types[file->runs[r].type].dimension > s->dimension)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              s->membrane
                                  ? "%s: has elements of dimension %d (%s): which physical group of dimension %d is "
                                    "the %s?"
                                  : "%s: has elements of dimension %d (%s), the scene is of dimension %d",
                              file->path, gmsh_types[file->runs[r].type].dimension, gmsh_types[file->runs[r].type].name,
                              s->dimension, s->what);
    if (groups <= 1) {
        s->all = true;
        return BRUNT_OK;
    }
    sentence text = {.length = 0};
    add(&text, "%s: which physical group is the %s? There are: ", file->path, s->what);
    list_groups(file, s->dimension, &text);
    return brunt_fail(error, BRUNT_BAD_INPUT, "%s", text.text);
}

static int select_group(selection *s, brunt_error *error) {
    bool found = false;
    for (int32_t p = 0; p < s->file->physical_count; p++) {
        const gmsh_physical *group = &s->file->physicals[p];
        s->wanted[p] = group->dimension == s->dimension && !strcmp(group->name, s->name);
        found |= s->wanted[p];
    }
    return found ? BRUNT_OK : fail_missing(s->file, s->name, s->dimension, error);
}

// The one kind of all selected elements, and how many.
static int find_kind(const selection *s, brunt_element_kind *kind, int64_t *count, brunt_error *error) {
    int64_t counts[GMSH_TYPE_LIMIT] = {0};
    int types = 0, last = 0, fitting = 0;
    *count = 0;
    for (int32_t r = 0; r < s->file->run_count; r++)
        if (selects(s, &s->file->runs[r])) counts[s->file->runs[r].type] += s->file->runs[r].count;
    for (int t = 0; t < GMSH_TYPE_LIMIT; t++) {
        if (!counts[t]) continue;
        types++, last = t;
        *count += counts[t];
        const brunt_element_kind found = brunt_element_of_gmsh(t); // both have the nodes in the same order
        if (found < BRUNT_ELEMENT_KINDS) *kind = found, fitting++;
    }
    const char *path = s->file->path;
    if (!types && s->all)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: has no elements of dimension %d", path, s->dimension);
    if (!types) return brunt_fail(error, BRUNT_BAD_INPUT, "%s: physical group '%.60s' has no elements", path, s->name);
    if (types == 1 && fitting == 1 && *count <= INT32_MAX) return BRUNT_OK;
    if (types == 1 && fitting == 1)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: %lld elements, fewer than 2^31 are wanted", path,
                          (long long)*count);
    sentence text = {.length = 0};
    add(&text, "%s: %s%.60s%s has ", path, s->all ? "the mesh" : "physical group '", s->all ? "" : s->name,
        s->all ? "" : "'");
    for (int t = 0, shown = 0; t < GMSH_TYPE_LIMIT; t++)
        if (counts[t])
            add(&text, "%s%lld %s",
                !shown++    ? ""
                : t == last ? " and "
                            : ", ",
                (long long)counts[t], gmsh_types[t].name);
    add(&text, ": a body has elements of one kind, %s",
        s->dimension == 3 ? "4-node tetrahedra or 8-node hexahedra" : "3-node triangles or 4-node quadrangles");
    return brunt_fail(error, BRUNT_BAD_INPUT, "%s", text.text);
}

// ---------------------------------------------------------------------------------------------------- nodes and
// elements

static int fail_memory(const gmsh_file *file, brunt_error *error) {
    return brunt_fail(error, BRUNT_FAILED, "%s: no memory for this mesh", file->path);
}

// Gives the nodes of the selected elements their numbers, in the order of the file; -1 for the others.
static int32_t number_nodes(const selection *s, int32_t *number) {
    const gmsh_file *file = s->file;
    memset(number, 0xff, (size_t)file->node_count * sizeof *number);
    for (int32_t r = 0; r < file->run_count; r++) {
        const gmsh_run *run = &file->runs[r];
        size_t nodes = (size_t)run->count * (size_t)gmsh_types[run->type].nodes;
        if (!selects(s, run)) continue;
        for (size_t i = 0; i < nodes; i++) number[file->element_nodes[run->first + i]] = 0;
    }
    int32_t count = 0;
    for (int32_t n = 0; n < file->node_count; n++)
        if (number[n] == 0) number[n] = count++;
    return count;
}

// Places of the nodes that have numbers.
static void fill_nodes(const gmsh_file *file, const int32_t *number, double (*nodes)[3]) {
    for (int32_t n = 0; n < file->node_count; n++)
        if (number[n] >= 0) memcpy(nodes[number[n]], file->x[n], sizeof *nodes);
}

static int fill_mesh(const selection *s, const int32_t *number, int32_t nodes, int64_t elements, brunt_mesh *mesh,
                     brunt_error *error) {
    const gmsh_file *file = s->file;
    size_t per_element = (size_t)brunt_element_nodes(mesh->kind), filled = 0;
    mesh->nodes = brunt_alloc((size_t)nodes * sizeof *mesh->nodes);
    mesh->elements = brunt_alloc((size_t)elements * per_element * sizeof *mesh->elements);
    if (!mesh->nodes || !mesh->elements) return fail_memory(file, error);
    mesh->node_count = nodes;
    mesh->element_count = (int32_t)elements;
    fill_nodes(file, number, mesh->nodes);
    for (int32_t r = 0; r < file->run_count; r++) {
        const gmsh_run *run = &file->runs[r];
        if (!selects(s, run)) continue;
        for (size_t i = 0; i < (size_t)run->count * per_element; i++)
            mesh->elements[filled++] = number[file->element_nodes[run->first + i]];
    }
    return BRUNT_OK;
}

// Turns a body over whose every element is inside out.
static bool turn_over(brunt_mesh *mesh) {
    const brunt_element_traits *element = brunt_element_traits_of(mesh->kind);
    const int nodes = element->nodes;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double x[BRUNT_ELEMENT_NODES][3];
        for (int a = 0; a < nodes; a++)
            memcpy(x[a], mesh->nodes[mesh->elements[(size_t)e * (size_t)nodes + (size_t)a]], sizeof x[a]);
        if (!(brunt_element_volume(element, (const double(*)[3])x) < 0)) return false;
    }
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int32_t *node = mesh->elements + (size_t)e * (size_t)nodes;
        for (int i = 0; i < 2; i++) {
            int a = element->shape->swap[i][0], b = element->shape->swap[i][1];
            int32_t keep = node[a];
            node[a] = node[b];
            node[b] = keep;
        }
    }
    return true;
}

static int flatten(const gmsh_file *file, brunt_mesh *mesh, brunt_error *error) {
    double least[2] = {INFINITY, INFINITY}, most[2] = {-INFINITY, -INFINITY};
    for (int32_t n = 0; n < mesh->node_count; n++)
        for (int d = 0; d < 2; d++)
            least[d] = fmin(least[d], mesh->nodes[n][d]), most[d] = fmax(most[d], mesh->nodes[n][d]);
    double tolerance = plane_tolerance * hypot(most[0] - least[0], most[1] - least[1]);
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (!(fabs(mesh->nodes[n][2]) <= tolerance))
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "%s: a node at (%g, %g, %g): a mesh of two dimensions lies in the plane z = 0",
                              file->path, mesh->nodes[n][0], mesh->nodes[n][1], mesh->nodes[n][2]);
        mesh->nodes[n][2] = 0;
    }
    return BRUNT_OK;
}

// ---------------------------------------------------------------------------------------------------- groups of the
// mesh

// Marks the body's nodes that elements of a physical group have; returns how many.
static int32_t mark_group(const gmsh_file *file, const bool *wanted, const int32_t *number, int32_t nodes,
                          bool *marked) {
    int32_t count = 0;
    memset(marked, 0, (size_t)nodes * sizeof *marked);
    for (int32_t r = 0; r < file->run_count; r++) {
        const gmsh_run *run = &file->runs[r];
        if (!is_member(file, run, wanted)) continue;
        for (size_t i = 0; i < (size_t)run->count * (size_t)gmsh_types[run->type].nodes; i++) {
            int32_t n = number[file->element_nodes[run->first + i]];
            if (n < 0 || marked[n]) continue;
            marked[n] = true;
            count++;
        }
    }
    return count;
}

static bool known_group(const brunt_mesh *mesh, const char *name) {
    for (int32_t g = 0; g < mesh->group_count; g++)
        if (!strcmp(mesh->groups[g].name, name)) return true;
    return false;
}

static void warn(FILE *warnings, const gmsh_file *file, const char *format, ...) __attribute__((format(printf, 3, 4)));
static void warn(FILE *warnings, const gmsh_file *file, const char *format, ...) {
    if (!warnings) return;
    va_list arguments;
    va_start(arguments, format);
    fprintf(warnings, "%s: ", file->path);
    vfprintf(warnings, format, arguments);
    fputc('\n', warnings);
    va_end(arguments);
}

// What making the groups of a mesh needs, beside the group.
typedef struct group_maker {
    const gmsh_file *file;
    const int32_t *number; // of the mesh, of each node of the file
    brunt_mesh *mesh;
    bool *wanted, *marked; // physical groups of one name; nodes of it
    FILE *warnings;
} group_maker;

// One group of the mesh from all physical groups of a dimension with the name of `physical`.
static int add_group(group_maker *m, int32_t physical, brunt_error *error) {
    const gmsh_file *file = m->file;
    brunt_mesh *mesh = m->mesh;
    bool *wanted = m->wanted, *marked = m->marked;
    const gmsh_physical *group = &file->physicals[physical];
    for (int32_t p = 0; p < file->physical_count; p++)
        wanted[p] = file->physicals[p].dimension == group->dimension && !strcmp(file->physicals[p].name, group->name);
    for (int32_t p = 0; p < physical; p++)
        if (wanted[p]) return BRUNT_OK; // made with that one
    int32_t count = mark_group(file, wanted, m->number, mesh->node_count, marked);
    if (!count) return BRUNT_OK;
    if (strlen(group->name) >= BRUNT_NAME_LENGTH) {
        warn(m->warnings, file, "physical group '%.60s' is left out: its name is longer than %d bytes", group->name,
             BRUNT_NAME_LENGTH - 1);
        return BRUNT_OK;
    }
    if (known_group(mesh, group->name)) {
        warn(m->warnings, file,
             "physical group '%s' of dimension %d is left out: there is one of a higher dimension with that name",
             group->name, (int)group->dimension);
        return BRUNT_OK;
    }
    brunt_group *made = &mesh->groups[mesh->group_count];
    made->nodes = brunt_alloc((size_t)count * sizeof *made->nodes);
    if (!made->nodes) return fail_memory(file, error);
    mesh->group_count++;
    memcpy(made->name, group->name, strlen(group->name) + 1);
    for (int32_t n = 0; n < mesh->node_count; n++)
        if (marked[n]) made->nodes[made->count++] = n;
    return BRUNT_OK;
}

// All nodes of a sheet, as meshes made of shapes have them.
static int add_surface(const gmsh_file *file, brunt_mesh *mesh, brunt_error *error) {
    static const char name[] = "surface";
    brunt_group *group = &mesh->groups[mesh->group_count];
    if (known_group(mesh, name)) return BRUNT_OK;
    group->nodes = brunt_alloc((size_t)mesh->node_count * sizeof *group->nodes);
    if (!group->nodes) return fail_memory(file, error);
    mesh->group_count++;
    memcpy(group->name, name, sizeof name);
    for (int32_t n = 0; n < mesh->node_count; n++) group->nodes[group->count++] = n;
    return BRUNT_OK;
}

// From physical groups of lower dimension; of a sheet those of its own as well: what loads it acts on its elements.
static int add_groups(const selection *s, const int32_t *number, brunt_mesh *mesh, FILE *warnings, brunt_error *error) {
    const gmsh_file *file = s->file;
    group_maker m = {.file = file, .number = number, .mesh = mesh, .warnings = warnings};
    m.wanted = brunt_alloc((size_t)file->physical_count + 1);
    m.marked = brunt_alloc((size_t)mesh->node_count);
    mesh->groups = brunt_alloc((size_t)(file->physical_count + 1) * sizeof *mesh->groups);
    int status = m.wanted && m.marked && mesh->groups ? BRUNT_OK : fail_memory(file, error);
    for (int d = s->membrane ? s->dimension : s->dimension - 1; d >= 0; d--)
        for (int32_t p = 0; p < file->physical_count && !status; p++)
            if (file->physicals[p].dimension == d) status = add_group(&m, p, error);
    if (s->membrane && !status) status = add_surface(file, mesh, error);
    brunt_free(m.wanted);
    brunt_free(m.marked);
    return status;
}

// ---------------------------------------------------------------------------------------------------- a body

// Nodes that belong to no element of the dimension or, beside a sheet, a higher one, of this body or another.
static int32_t count_unused(const selection *s, int32_t *number) {
    int32_t unused = 0;
    memset(number, 0, (size_t)s->file->node_count * sizeof *number);
    for (int32_t r = 0; r < s->file->run_count; r++) {
        const gmsh_run *run = &s->file->runs[r];
        const int dimension = gmsh_types[run->type].dimension;
        if (dimension != s->dimension && !(s->membrane && dimension > s->dimension)) continue;
        for (size_t i = 0; i < (size_t)run->count * (size_t)gmsh_types[run->type].nodes; i++)
            number[s->file->element_nodes[run->first + i]] = 1;
    }
    for (int32_t n = 0; n < s->file->node_count; n++) unused += !number[n];
    return unused;
}

static int make_body(selection *s, brunt_mesh *mesh, FILE *warnings, brunt_error *error) {
    const gmsh_file *file = s->file;
    int64_t elements = 0;
    int32_t *number = NULL;
    s->wanted = brunt_alloc((size_t)file->physical_count + 1);
    int status = !s->wanted ? fail_memory(file, error) : *s->name ? select_group(s, error) : select_all(s, error);
    if (!status) status = find_kind(s, &mesh->kind, &elements, error);
    if (!status) {
        number = brunt_alloc((size_t)file->node_count * sizeof *number);
        if (!number) status = fail_memory(file, error);
    }
    if (!status && warnings) {
        int32_t unused = count_unused(s, number);
        if (unused)
            warn(warnings, file, "%d of its nodes belong to no element of dimension %d and are left out", (int)unused,
                 s->dimension);
    }
    if (!status) status = fill_mesh(s, number, number_nodes(s, number), elements, mesh, error);
    if (!status && s->dimension == 2 && !s->membrane) status = flatten(file, mesh, error);
    if (!status && !s->membrane && turn_over(mesh))
        warn(warnings, file, "all %lld elements were inside out and have been turned over", (long long)elements);
    if (!status) status = add_groups(s, number, mesh, warnings, error);
    if (s->membrane) mesh->kind = brunt_element_as_membrane(mesh->kind);
    brunt_free(number);
    brunt_free(s->wanted);
    if (status) brunt_mesh_free(mesh);
    return status;
}

static int read_body(const char *path, const char *group, int dimension, bool membrane, brunt_mesh *mesh,
                     FILE *warnings, brunt_error *error) {
    *mesh = (brunt_mesh){0};
    gmsh_file file;
    int status = gmsh_file_read(path, &file, error);
    selection s = {.file = &file,
                   .dimension = dimension,
                   .membrane = membrane,
                   .what = membrane ? "sheet" : "body",
                   .name = group ? group : ""};
    if (!status) status = make_body(&s, mesh, warnings, error);
    gmsh_file_free(&file);
    return status;
}

int brunt_gmsh_read(const char *path, const char *group, int dimension, brunt_mesh *mesh, FILE *warnings,
                    brunt_error *error) {
    BRUNT_ASSERT(dimension == 2 || dimension == 3);
    return read_body(path, group, dimension, false, mesh, warnings, error);
}

int brunt_gmsh_read_membrane(const char *path, const char *group, brunt_mesh *mesh, FILE *warnings,
                             brunt_error *error) {
    return read_body(path, group, 2, true, mesh, warnings, error);
}

// ---------------------------------------------------------------------------------------------------- facets

// How many facets there are; of other elements than triangles and quadrangles, what they are.
static int count_facets(const selection *s, int64_t *count, brunt_error *error) {
    const char *path = s->file->path;
    *count = 0;
    for (int32_t r = 0; r < s->file->run_count; r++) {
        const gmsh_run *run = &s->file->runs[r];
        const gmsh_type *type = &gmsh_types[run->type];
        if (!selects(s, run) || !run->count) continue;
        if (type->nodes != 3 && type->nodes != 4)
            return brunt_fail(error, BRUNT_BAD_INPUT, "%s: has %s: facets are 3-node triangles and 4-node quadrangles",
                              path, type->name);
        *count += run->count;
    }
    if (*count > 0 && *count <= INT32_MAX / 2) return BRUNT_OK;
    if (*count)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: %lld facets, fewer than 2^30 are wanted", path,
                          (long long)*count);
    return s->all ? brunt_fail(error, BRUNT_BAD_INPUT, "%s: has no triangles and no quadrangles", path)
                  : brunt_fail(error, BRUNT_BAD_INPUT, "%s: physical group '%.60s' has no triangles and no quadrangles",
                               path, s->name);
}

static void fill_corners(const selection *s, const int32_t *number, int32_t (*corners)[4]) {
    int32_t filled = 0;
    for (int32_t r = 0; r < s->file->run_count; r++) {
        const gmsh_run *run = &s->file->runs[r];
        const int nodes = gmsh_types[run->type].nodes;
        if (!selects(s, run)) continue;
        for (int64_t e = 0; e < run->count; e++, filled++)
            for (int k = 0; k < 4; k++)
                corners[filled][k] =
                    k < nodes ? number[s->file->element_nodes[run->first + (size_t)(e * nodes + k)]] : -1;
    }
}

static int make_facets(selection *s, brunt_gmsh_facets *facets, brunt_error *error) {
    const gmsh_file *file = s->file;
    int32_t *number = brunt_alloc((size_t)file->node_count * sizeof *number + 1);
    int64_t count;
    s->wanted = brunt_alloc((size_t)file->physical_count + 1);
    int status = !s->wanted || !number ? fail_memory(file, error)
                 : *s->name            ? select_group(s, error)
                                       : select_all(s, error);
    if (!status) status = count_facets(s, &count, error);
    if (!status) {
        facets->point_count = number_nodes(s, number), facets->count = (int32_t)count;
        facets->points = brunt_alloc((size_t)facets->point_count * sizeof *facets->points);
        facets->corners = brunt_alloc((size_t)count * sizeof *facets->corners);
        if (!facets->points || !facets->corners) status = fail_memory(file, error);
    }
    if (!status) fill_nodes(file, number, facets->points), fill_corners(s, number, facets->corners);
    brunt_free(number), brunt_free(s->wanted);
    return status;
}

int brunt_gmsh_read_facets(const char *path, const char *group, brunt_gmsh_facets *facets, brunt_error *error) {
    *facets = (brunt_gmsh_facets){.count = 0};
    gmsh_file file;
    int status = gmsh_file_read(path, &file, error);
    selection s = {.file = &file, .dimension = 2, .membrane = true, .what = "surface", .name = group ? group : ""};
    if (!status) status = make_facets(&s, facets, error);
    gmsh_file_free(&file);
    if (!status) return BRUNT_OK;
    brunt_free(facets->points), brunt_free(facets->corners);
    *facets = (brunt_gmsh_facets){.count = 0};
    return status;
}

// ---------------------------------------------------------------------------------------------------- in words

static void describe_body(const gmsh_file *file, const char *name, int dimension, bool membrane, FILE *out) {
    brunt_mesh mesh = {0};
    brunt_mesh_quality q;
    brunt_error error = {0};
    selection s = {.file = file, .dimension = dimension, .membrane = membrane, .what = "body", .name = name};
    int status = make_body(&s, &mesh, NULL, &error);
    if (!status) status = brunt_mesh_check(&mesh, &q, &error);
    if (status) {
        fprintf(out, "body '%s'  cannot be computed with: %s\n", name, error.message);
    } else {
        fprintf(out, "body '%s'  %d nodes, %d %s elements, %s %.6g %s\n", name, (int)mesh.node_count,
                (int)mesh.element_count, brunt_element_name(mesh.kind), dimension == 3 ? "volume" : "area", q.volume,
                dimension == 3 ? "m^3" : "m^2");
        fprintf(out, "  edges %.4g to %.4g m, worst shape %.3g (element %d; 1 is regular, 0 flat)\n", q.shortest_edge,
                q.longest_edge, q.worst_shape, (int)(q.worst + 1));
        if (q.duplicate_nodes)
            fprintf(out, "  %d nodes at the place of another: parts that are not joined?\n", (int)q.duplicate_nodes);
    }
    brunt_mesh_free(&mesh);
}

static int describe_elements(const gmsh_file *file, FILE *out) {
    int64_t counts[GMSH_TYPE_LIMIT] = {0};
    int highest = 0;
    for (int32_t r = 0; r < file->run_count; r++) counts[file->runs[r].type] += file->runs[r].count;
    for (int t = 0; t < GMSH_TYPE_LIMIT; t++) {
        if (!counts[t]) continue;
        fprintf(out, "elements   %lld %s\n", (long long)counts[t], gmsh_types[t].name);
        if (gmsh_types[t].dimension > highest) highest = gmsh_types[t].dimension;
    }
    return highest;
}

int brunt_gmsh_describe(const char *path, FILE *out, brunt_error *error) {
    gmsh_file file;
    int status = gmsh_file_read(path, &file, error);
    if (!status) {
        double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
        for (int32_t n = 0; n < file.node_count; n++)
            for (int d = 0; d < 3; d++) least[d] = fmin(least[d], file.x[n][d]), most[d] = fmax(most[d], file.x[n][d]);
        fprintf(out, "mesh of gmsh, format %s, %s\n", file.version, file.binary ? "binary" : "text");
        fprintf(out, "nodes      %d\n", (int)file.node_count);
        int highest = describe_elements(&file, out), bodies = 0;
        const double tolerance = plane_tolerance * hypot(most[0] - least[0], most[1] - least[1]);
        const bool membrane = highest == 2 && file.node_count && !(fmax(fabs(least[2]), fabs(most[2])) <= tolerance);
        if (file.node_count)
            fprintf(out, "bounds     (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g) m\n", least[0], least[1], least[2],
                    most[0], most[1], most[2]);
        for (int32_t p = 0; p < file.physical_count; p++)
            fprintf(out, "group      '%s', dimension %d, %lld elements\n", file.physicals[p].name,
                    (int)file.physicals[p].dimension, (long long)count_members(&file, p));
        for (int32_t p = 0; p < file.physical_count && highest >= 2; p++) {
            if (file.physicals[p].dimension != highest) continue;
            describe_body(&file, file.physicals[p].name, highest, membrane, out);
            bodies++;
        }
        if (!bodies && highest >= 2) describe_body(&file, "", highest, membrane, out);
    }
    gmsh_file_free(&file);
    return status;
}
