#include "base/array.h"
#include "contact/methods/method.h"
#include "contact/planes/condition.h"

#include <stdio.h>
#include <string.h>

static bool points_alone(bool a, bool b) { return !a && !b; }
static bool mesh_and_points(bool a, bool b) { return a != b; }
static bool any_mesh(bool a, bool b) { return a || b; }

// The published form acts on every surface, touched or not.
static void mark_all(const brunt_contact_context *m) {
    for (int k = 0; k < m->surface->fem_count; k++) m->surface->active[k] = true;
}

static int act_published(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    brunt_augury_workspace *kept = work->memory;
    const int status = brunt_augury_paper(m, work->def->transfer, &kept, error);
    work->memory = kept;
    return status;
}

static int act_averaged(const brunt_contact_context *m, brunt_contact_work *work, bool facets, brunt_error *error) {
    brunt_augury_workspace *kept = work->memory;
    const int status = brunt_augury_surface(m, facets, &kept, error);
    work->memory = kept;
    return status;
}

static int act_averaged_facets(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    return act_averaged(m, work, true, error);
}

static int act_averaged_surface(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    return act_averaged(m, work, false, error);
}

static void free_augury(void *memory) { brunt_augury_workspace_free(memory); }

static int act_on_grid(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    brunt_surface_on_grid *kept = work->memory;
    const int status = brunt_surface_on_grid_meet(m, work->grid_sweeps, &kept, error);
    work->memory = kept;
    return status;
}

static void account_on_grid(const brunt_contact_context *m, const brunt_contact_work *work) {
    brunt_surface_on_grid_finish(m, work->memory);
}

static void free_on_grid(void *memory) { brunt_surface_on_grid_free(memory); }
static void validate_on_grid(const void *memory) { brunt_surface_on_grid_validate(memory); }

// Those planes that hold nodes come before those that push them: what is held is not free to be pushed or rubbed.
static int meet_planes(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    for (int pushing = 0; pushing < 2; pushing++)
        for (int w = 0; w < m->boundary_count; w++) {
            brunt_boundary *b = &m->boundaries[w];
            if (b->kind->meet_surface && brunt_boundary_pushes(b) == pushing &&
                b->kind->meet_surface(m, b, *work->node_to_facet, work->constraints, error))
                return BRUNT_FAILED;
        }
    return BRUNT_OK;
}

// Constraints at facets, and those at planes, which any surface may meet: solved together.
static int act_at_facets(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    brunt_constraint_set *set = work->constraints;
    brunt_node_to_facet *facets = *work->node_to_facet;
    brunt_constraints_clear(set);
    set->gives_back = work->def->touch == BRUNT_TOUCH_ELASTIC;
    set->kick = m->kick;
    set->negligible = BRUNT_NEGLIGIBLE * m->surface->mean_edge / m->dt;
    set->leap = BRUNT_LEAP * m->surface->mean_edge / m->dt;
    set->shallow = BRUNT_SHALLOW * m->surface->mean_edge;
    if (set->gives_back && brunt_node_touches_make(facets, m->surface->node_count, error)) return BRUNT_FAILED;
    if (meet_planes(m, work, error)) return BRUNT_FAILED;
    if (work->facets && brunt_node_to_facet_find(m, m->mpm, m->mpm_count, facets, set, error)) return BRUNT_FAILED;
    if (brunt_constraints_solve(set, work->sweeps, work->def->tolerance, m->threads, m->timer, error))
        return BRUNT_FAILED;
    brunt_node_to_facet_account_fixed(m, facets, set);
    brunt_node_to_facet_finish(m, m->mpm, facets, set);
    return BRUNT_OK;
}

#define METHOD(name) (1u << BRUNT_CONTACT_##name)
#define FORM(name) (1u << BRUNT_AUGURY_##name)
#define EXPLICIT (1u << BRUNT_EXPLICIT)

// In the order in which they act. A method of one file has its row there.
#define ROWS(X)                                                                                                        \
    X(grid_velocity)                                                                                                   \
    X(point_touches)                                                                                                   \
    X(tied)                                                                                                            \
    X(published)                                                                                                       \
    X(averaged_facets)                                                                                                 \
    X(averaged_surface)                                                                                                \
    X(surface_on_grid)                                                                                                 \
    X(barrier)                                                                                                         \
    X(penalty)                                                                                                         \
    X(node_to_facet)
#define DECLARE(name) extern const brunt_contact_row brunt_contact_##name;
ROWS(DECLARE)
#define ADDRESS(name) &brunt_contact_##name,
const brunt_contact_row *const brunt_contact_rows[] = {ROWS(ADDRESS)};

const brunt_contact_row brunt_contact_grid_velocity = {
    .name = "grid velocity",
    .methods = METHOD(MULTI_VELOCITY),
    .schemes = EXPLICIT,
    .meets = BRUNT_MEET_AT_NODES,
    .wants = "a body of method mpm",
    .accepts = points_alone,
};
const brunt_contact_row brunt_contact_point_touches = {
    .name = "point touches",
    .methods = METHOD(AUGURY),
    .forms = FORM(NODE_TO_FACET),
    .schemes = EXPLICIT,
    .meets = BRUNT_MEET_AT_PARTICLES,
    .keys = "form cell tolerance iterations stop",
    .never_axisymmetric = true,
    .accepts = points_alone,
};
const brunt_contact_row brunt_contact_published = {
    .name = "published",
    .methods = METHOD(AUGURY),
    .forms = FORM(PUBLISHED),
    .schemes = EXPLICIT,
    .meets = BRUNT_MEET_AT_FACETS,
    .keys = "form cell transfer iterations",
    .self = BRUNT_SELF_MEMBRANES,
    .affine = true,
    .sweeps = 1,
    .cell_factor = 2,
    .look = 1.6,
    .accepts = any_mesh,
    .near = mark_all,
    .act = act_published,
    .free = free_augury,
};
#define AVERAGED(form)                                                                                                 \
    .methods = METHOD(AUGURY), .forms = FORM(form), .schemes = EXPLICIT, .meets = BRUNT_MEET_AT_FACETS,                \
    .keys = "form cell iterations", .self = BRUNT_SELF_MEMBRANES, .sweeps = 4, .cell_factor = 1, .look = 1.6,          \
    .accepts = any_mesh, .free = free_augury
const brunt_contact_row brunt_contact_averaged_facets = {
    AVERAGED(AVERAGED_FACETS),
    .name = "averaged facets",
    .act = act_averaged_facets,
};
const brunt_contact_row brunt_contact_averaged_surface = {
    AVERAGED(AVERAGED_SURFACE),
    .name = "averaged surface",
    .act = act_averaged_surface,
};
const brunt_contact_row brunt_contact_surface_on_grid = {
    .name = "surface on grid",
    .methods = METHOD(MULTI_VELOCITY),
    .schemes = EXPLICIT,
    .meets = BRUNT_MEET_ON_GRID,
    .keys = "iterations",
    .accepts = mesh_and_points,
    .near = brunt_surface_on_grid_near,
    .act = act_on_grid,
    .account = account_on_grid,
    .free = free_on_grid,
    .validate = validate_on_grid,
};
// A membrane between two blocks is light between heavy ones: each sweep passes on the share of its mass in theirs. At a
// twentieth, 16 sweeps let the nodes of blocks that meet at a tenth of their wave speed through its middle; 64 leave a
// hundredth of its thickness. Sweeps end earlier where there is nothing to do.
const brunt_contact_row brunt_contact_node_to_facet = {
    .name = "node to facet",
    .methods = METHOD(AUGURY),
    .forms = FORM(NODE_TO_FACET),
    .schemes = EXPLICIT,
    .meets = BRUNT_MEET_AT_FACETS,
    .keys = "form cell tolerance iterations touch stop",
    .self = BRUNT_SELF_MEMBRANES,
    .sides = true,
    .knows_membranes = true,
    .planes = true,
    .near_alone = true,
    .sweeps = 16,
    .membrane_sweeps = 64,
    .cell_factor = 1,
    .wants = "a body of method fem or membrane",
    .accepts = any_mesh,
    .act = act_at_facets,
};

const int brunt_contact_row_count = sizeof brunt_contact_rows / sizeof *brunt_contact_rows;
_Static_assert(sizeof brunt_contact_rows / sizeof *brunt_contact_rows <= (size_t)BRUNT_CONTACT_ROW_LIMIT,
               "more methods than a world keeps memory for");

#define ONE(name, word) +1
const int brunt_contact_method_count = BRUNT_CONTACT_METHODS(ONE);
const int brunt_augury_form_count = BRUNT_AUGURY_FORMS(ONE);

bool brunt_contact_is_of(const brunt_contact_row *row, brunt_contact_method method) {
    return row->methods >> method & 1;
}

bool brunt_contact_has_form(const brunt_contact_row *row, brunt_augury_form form) {
    return !row->forms || row->forms >> form & 1;
}

bool brunt_contact_has_sides(brunt_contact_method method, brunt_augury_form form) {
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (brunt_contact_rows[r]->sides && brunt_contact_is_of(brunt_contact_rows[r], method) &&
            brunt_contact_has_form(brunt_contact_rows[r], form))
            return true;
    return false;
}

bool brunt_contact_has_key(const brunt_contact_row *row, const char *key) {
    const size_t length = strlen(key);
    for (const char *at = row->keys; at; at = strchr(at, ' ')) {
        at += *at == ' ';
        if (strncmp(at, key, length) == 0 && (at[length] == ' ' || !at[length])) return true;
    }
    return false;
}

bool brunt_contact_accepts(brunt_contact_method method, bool mesh_a, bool mesh_b) {
    bool accepts = method == BRUNT_CONTACT_NONE;
    for (int r = 0; r < brunt_contact_row_count; r++)
        accepts |= brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->accepts(mesh_a, mesh_b);
    return accepts;
}

unsigned brunt_contact_rows_of(brunt_contact_method method, brunt_augury_form form, bool mesh_a, bool mesh_b) {
    unsigned rows = 0;
    for (int r = 0; r < brunt_contact_row_count; r++) {
        const brunt_contact_row *row = brunt_contact_rows[r];
        if (brunt_contact_is_of(row, method) && brunt_contact_has_form(row, form) && row->accepts(mesh_a, mesh_b))
            rows |= 1u << r;
    }
    return rows;
}

unsigned brunt_contact_places_of(unsigned rows) {
    unsigned places = 0;
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (rows >> r & 1) places |= brunt_contact_rows[r]->meets;
    return places;
}

const brunt_contact_row *brunt_contact_row_at(unsigned rows, brunt_contact_place place) {
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (rows >> r & 1 && brunt_contact_rows[r]->meets & place) return brunt_contact_rows[r];
    return NULL;
}

brunt_contact_method brunt_contact_between_points(brunt_contact_method method, brunt_augury_form form,
                                                  bool axisymmetric) {
    bool meet = method == BRUNT_CONTACT_NONE;
    const unsigned rows = brunt_contact_rows_of(method, form, false, false);
    for (int r = 0; r < brunt_contact_row_count; r++)
        meet |= rows >> r & 1 && !(axisymmetric && brunt_contact_rows[r]->never_axisymmetric);
    if (meet) return method;
    for (int other = BRUNT_CONTACT_NONE + 1;; other++) // one of them always does: at the nodes of their grid
        if (other != (int)method && brunt_contact_accepts((brunt_contact_method)other, false, false))
            return (brunt_contact_method)other;
}

const char *brunt_augury_form_word(brunt_augury_form form) {
#define WORD(name, word) word,
    static const char *const words[] = {BRUNT_AUGURY_FORMS(WORD)};
    return words[form];
}

void brunt_augury_words_of(unsigned forms, char *out, size_t size) {
    size_t used = 0;
    *out = 0;
    for (int f = 0; f < brunt_augury_form_count && used < size; f++)
        if (forms >> f & 1)
            used += (size_t)snprintf(out + used, size - used, "%s%s", used ? " or " : "",
                                     brunt_augury_form_word((brunt_augury_form)f));
}

unsigned brunt_augury_forms_of_points(brunt_contact_method method) {
    unsigned forms = 0;
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->accepts(false, false))
            forms |= brunt_contact_rows[r]->forms;
    return forms;
}

unsigned brunt_augury_forms_of_membranes(void) {
    unsigned forms = 0;
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (brunt_contact_rows[r]->knows_membranes) forms |= brunt_contact_rows[r]->forms;
    return forms;
}

const char *brunt_contact_word(brunt_contact_method method) {
    static const char *const words[] = {BRUNT_CONTACT_METHODS(WORD)};
    _Static_assert(BRUNT_COUNT(words) == BRUNT_CONTACT_METHODS(ONE), "a word for each method");
#undef WORD
    return words[method];
}

const char *brunt_contact_wants(brunt_contact_method method) {
    const char *wants = NULL;
    for (int r = 0; r < brunt_contact_row_count && !wants; r++)
        if (brunt_contact_is_of(brunt_contact_rows[r], method)) wants = brunt_contact_rows[r]->wants;
    return wants ? wants : "other bodies";
}

brunt_contact_method brunt_contact_default(brunt_scheme scheme, bool meshes) {
    const bool mesh = meshes || brunt_scheme_minimises(scheme);
    const brunt_contact_row *const *row = brunt_contact_rows;
    while (!((*row)->schemes >> scheme & 1) || !(*row)->accepts(mesh, mesh)) row++;
    return (brunt_contact_method)__builtin_ctz((*row)->methods);
}

bool brunt_contact_of_scheme(brunt_contact_method method, brunt_scheme scheme) {
    bool has = method == BRUNT_CONTACT_NONE;
    for (int r = 0; r < brunt_contact_row_count; r++)
        has |= brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->schemes >> scheme & 1;
    return has;
}

void brunt_contact_words_of(brunt_scheme scheme, char *out, size_t size) {
    size_t used = 0;
    for (int method = brunt_contact_method_count - 1; method >= 0 && used < size; method--)
        if (brunt_contact_of_scheme((brunt_contact_method)method, scheme))
            used += (size_t)snprintf(out + used, size - used, "%s%s",
                                     used == 0                     ? ""
                                     : method > BRUNT_CONTACT_NONE ? ", "
                                                                   : " or ",
                                     brunt_contact_word((brunt_contact_method)method));
}

brunt_contact_self brunt_contact_with_itself(brunt_contact_method method) {
    brunt_contact_self self = BRUNT_SELF_NONE;
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->self > self)
            self = brunt_contact_rows[r]->self;
    return self;
}

brunt_contact_method brunt_contact_of_self(brunt_scheme scheme) {
    const brunt_contact_row *const *row = brunt_contact_rows;
    while (!((*row)->schemes >> scheme & 1) || !(*row)->self) row++;
    return (brunt_contact_method)__builtin_ctz((*row)->methods);
}

brunt_node_law *brunt_contact_node_law(brunt_contact_method method) {
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->at_node)
            return brunt_contact_rows[r]->at_node;
    return NULL;
}

brunt_gap_energy *brunt_contact_energy(brunt_contact_method method) {
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->energy)
            return brunt_contact_rows[r]->energy;
    return NULL;
}

bool brunt_contact_pushes_planes(const brunt_contact_row *row, brunt_contact_method method) {
    return brunt_contact_energy(method) ? row->energy && brunt_contact_is_of(row, method)
                                        : row->energy == brunt_barrier_at;
}

bool brunt_contact_overlaps(brunt_contact_method method) {
    bool overlaps = false;
    for (int r = 0; r < brunt_contact_row_count; r++)
        overlaps |= brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->overlaps;
    return overlaps;
}

bool brunt_contact_is_planar(brunt_contact_method method) {
    bool planar = false;
    for (int r = 0; r < brunt_contact_row_count; r++)
        planar |= brunt_contact_is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->planar;
    return planar;
}

void brunt_contact_methods_validate(unsigned rows, void *const memory[]) {
    BRUNT_ASSERT(rows >> brunt_contact_row_count == 0);
    for (int r = 0; r < brunt_contact_row_count; r++) {
        const brunt_contact_row *row = brunt_contact_rows[r];
        BRUNT_ASSERT(!memory[r] || (rows >> r & 1 && row->free));
        if (memory[r] && row->validate) row->validate(memory[r]);
    }
}
