#include "base/array.h"
#include "contact/methods/method.h"

#include <stdio.h>

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

static int act_averaged(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    brunt_augury_workspace *kept = work->memory;
    const int status = brunt_augury_surface(m, work->def->form == BRUNT_AUGURY_SMOOTH, &kept, error);
    work->memory = kept;
    return status;
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

// Constraints at facets, and those at planes, which any surface may meet: solved together.
static int act_at_facets(const brunt_contact_context *m, brunt_contact_work *work, brunt_error *error) {
    brunt_constraint_set *set = work->constraints;
    brunt_node_to_facet *facets = *work->node_to_facet;
    brunt_constraints_clear(set);
    for (int w = 0; w < m->wall_count; w++)
        if (m->walls[w].kind->meet_surface && m->walls[w].kind->meet_surface(m, &m->walls[w], facets, set, error))
            return BRUNT_FAILED;
    if (work->facets && brunt_node_to_facet_find(m, m->mpm, m->mpm_count, facets, set, error)) return BRUNT_FAILED;
    if (brunt_constraints_solve(set, work->sweeps, work->def->tolerance, m->threads, m->timer, error))
        return BRUNT_FAILED;
    brunt_node_to_facet_account_fixed(m, facets, set);
    brunt_node_to_facet_finish(m, m->mpm, facets, set);
    return BRUNT_OK;
}

#define METHOD(name) (1u << BRUNT_CONTACT_##name)
#define FORM(name) (1u << BRUNT_AUGURY_##name)

#define SELF(name) BRUNT_SELF_##name
#define EXPLICIT (1u << BRUNT_EXPLICIT)

// In the order in which they act. A method of one file has its row there.
#define ROWS(X)                                                                                                        \
    X(grid_velocity)                                                                                                   \
    X(point_touches)                                                                                                   \
    X(tied)                                                                                                            \
    X(published)                                                                                                       \
    X(averaged_surface)                                                                                                \
    X(surface_on_grid)                                                                                                 \
    X(barrier)                                                                                                         \
    X(node_to_facet)
#define DECLARE(name) extern const brunt_contact_row brunt_contact_##name;
ROWS(DECLARE)
#define ADDRESS(name) &brunt_contact_##name,
const brunt_contact_row *const brunt_contact_rows[] = {ROWS(ADDRESS)};

// clang-format off
const brunt_contact_row brunt_contact_grid_velocity = {"grid velocity", METHOD(MULTI_VELOCITY), 0, EXPLICIT, SELF(NONE), true, "a body of method mpm", points_alone, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
const brunt_contact_row brunt_contact_point_touches = {"point touches", METHOD(AUGURY), FORM(AFFINE), EXPLICIT, SELF(NONE), false, NULL, points_alone, NULL, NULL, NULL, NULL, NULL, NULL, NULL};
const brunt_contact_row brunt_contact_published = {"published", METHOD(AUGURY), FORM(PAPER), EXPLICIT, SELF(MEMBRANES), false, NULL, any_mesh, mark_all, act_published, NULL, free_augury, NULL, NULL, NULL};
const brunt_contact_row brunt_contact_averaged_surface = {"averaged surface", METHOD(AUGURY), FORM(SMOOTH) | FORM(SURFACE), EXPLICIT, SELF(MEMBRANES), false, NULL, any_mesh, NULL, act_averaged, NULL, free_augury, NULL, NULL, NULL};
const brunt_contact_row brunt_contact_surface_on_grid = {"surface on grid", METHOD(MULTI_VELOCITY), 0, EXPLICIT, SELF(NONE), true, NULL, mesh_and_points, brunt_surface_on_grid_near, act_on_grid, account_on_grid, free_on_grid, validate_on_grid, NULL, NULL};
const brunt_contact_row brunt_contact_node_to_facet = {"node to facet", METHOD(AUGURY), FORM(AFFINE), EXPLICIT, SELF(MEMBRANES), false, "a body of method fem or membrane", any_mesh, NULL, act_at_facets, NULL, NULL, NULL, NULL, NULL};
// clang-format on
const int brunt_contact_row_count = sizeof brunt_contact_rows / sizeof *brunt_contact_rows;
_Static_assert(sizeof brunt_contact_rows / sizeof *brunt_contact_rows <= (size_t)BRUNT_CONTACT_ROW_LIMIT,
               "more methods than a world keeps memory for");

#define ONE(name, word) +1
const int brunt_contact_method_count = BRUNT_CONTACT_METHODS(ONE);

static bool is_of(const brunt_contact_row *row, brunt_contact_method method) { return row->methods >> method & 1; }

bool brunt_contact_accepts(brunt_contact_method method, bool mesh_a, bool mesh_b) {
    bool accepts = method == BRUNT_CONTACT_NONE;
    for (int r = 0; r < brunt_contact_row_count; r++)
        accepts |= is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->accepts(mesh_a, mesh_b);
    return accepts;
}

unsigned brunt_contact_rows_of(brunt_contact_method method, brunt_augury_form form, bool mesh_a, bool mesh_b) {
    unsigned rows = 0;
    for (int r = 0; r < brunt_contact_row_count; r++) {
        const brunt_contact_row *row = brunt_contact_rows[r];
        const bool formed = !row->forms || row->forms >> form & 1;
        if (is_of(row, method) && formed && row->accepts(mesh_a, mesh_b)) rows |= 1u << r;
    }
    return rows;
}

brunt_contact_method brunt_contact_between_points(brunt_contact_method method, brunt_augury_form form, bool rings) {
    const bool touch = method != BRUNT_CONTACT_AUGURY || (!rings && brunt_contact_rows_of(method, form, false, false));
    if (touch && brunt_contact_accepts(method, false, false)) return method;
    for (int other = BRUNT_CONTACT_NONE + 1;; other++) // one of them always does: at the nodes of their grid
        if (other != (int)method && brunt_contact_accepts((brunt_contact_method)other, false, false))
            return (brunt_contact_method)other;
}

bool brunt_contact_at_nodes(brunt_contact_method method) {
    bool at_nodes = false;
    for (int r = 0; r < brunt_contact_row_count; r++)
        at_nodes |= is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->at_nodes;
    return at_nodes;
}

const char *brunt_contact_word(brunt_contact_method method) {
#define WORD(name, word) word,
    static const char *const words[] = {BRUNT_CONTACT_METHODS(WORD)};
    _Static_assert(BRUNT_COUNT(words) == BRUNT_CONTACT_METHODS(ONE), "a word for each method");
#undef WORD
    return words[method];
}

const char *brunt_contact_wants(brunt_contact_method method) {
    const char *wants = NULL;
    for (int r = 0; r < brunt_contact_row_count && !wants; r++)
        if (is_of(brunt_contact_rows[r], method)) wants = brunt_contact_rows[r]->wants;
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
        has |= is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->schemes >> scheme & 1;
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
        if (is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->self > self)
            self = brunt_contact_rows[r]->self;
    return self;
}

brunt_node_law *brunt_contact_node_law(brunt_contact_method method) {
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->at_node)
            return brunt_contact_rows[r]->at_node;
    return NULL;
}

brunt_gap_energy *brunt_contact_energy(brunt_contact_method method) {
    for (int r = 0; r < brunt_contact_row_count; r++)
        if (is_of(brunt_contact_rows[r], method) && brunt_contact_rows[r]->energy) return brunt_contact_rows[r]->energy;
    return NULL;
}

void brunt_contact_methods_validate(unsigned rows, void *const memory[]) {
    BRUNT_ASSERT(rows >> brunt_contact_row_count == 0);
    for (int r = 0; r < brunt_contact_row_count; r++) {
        const brunt_contact_row *row = brunt_contact_rows[r];
        BRUNT_ASSERT(!memory[r] || (rows >> r & 1 && row->free));
        if (memory[r] && row->validate) row->validate(memory[r]);
    }
}
