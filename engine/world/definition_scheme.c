// What goes with explicit steps alone, and with implicit ones: all that a definition asks for and its scheme has not.
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "boundary/kinds.h"
#include "contact/methods/method.h"
#include "contact/planes/condition.h"
#include "materials/material.h"
#include "mpm/courant.h"
#include "world/named_pairs.h"

typedef struct refusals {
    brunt_refusal_fn *refuse;
    void *context;
    char owner[96]; // what the path begins with
} refusals;

static void say(const refusals *r, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));
static void say(const refusals *r, const char *key, const char *format, ...) {
    char path[160], reason[240];
    snprintf(path, sizeof path, "%s%s", r->owner, key);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, sizeof reason, format, arguments);
    va_end(arguments);
    r->refuse(r->context, path, reason);
}

static void set_owner(refusals *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void set_owner(refusals *r, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(r->owner, sizeof r->owner, format, arguments);
    va_end(arguments);
}

#define EXPLICIT_ONLY BRUNT_EXPLICIT_ONLY

// ------------------------------------------------------------------------------------------ implicit steps

static void look_at_time(const brunt_world_def *def, refusals *r) {
    set_owner(r, "time");
    if (sizeof(real) != sizeof(double))
        say(r, ".scheme", "%s: this program computes in single precision, %s steps want double",
            def->scheme == BRUNT_STATIC ? "static" : "implicit", def->scheme == BRUNT_STATIC ? "load" : "implicit");
    if (def->scheme == BRUNT_STATIC) {
        if (def->load_steps < 1) say(r, ".steps", "load steps are as many as are given: steps is wanted, 1 or more");
    } else if (!(def->step > 0)) {
        say(r, ".step", "implicit steps are of a length that is given: step is missing");
    }
    if (def->cfl > 0) say(r, ".cfl", EXPLICIT_ONLY);
    if (def->least_step > 0) say(r, ".least_step", EXPLICIT_ONLY);
    r->owner[0] = 0;
    if (def->axisymmetric) say(r, "axisymmetric", EXPLICIT_ONLY ": implicit steps know no rings");
    if (def->detonation_count) say(r, "detonations", EXPLICIT_ONLY);
}

static void say_no_potential(const refusals *r, const char *key, const brunt_model *model) {
    if (model->no_potential)
        say(r, key, "%s", model->no_potential);
    else
        say(r, key, "'%s' has no potential for implicit steps", model->name);
}

static void look_at_material(const brunt_world_def *def, const brunt_body_def *body, refusals *r) {
    if (body->material < 0 || body->material >= def->material_count) return; // another mistake
    const brunt_material_def *material = &def->materials[body->material];
    set_owner(r, "materials.%s", material->name);
    const brunt_model *strength = brunt_find_strength(material->strength), *eos = brunt_find_eos(material->eos);
    if (strength && !strength->potential && !strength->differences) say_no_potential(r, ".model", strength);
    if (eos && !eos->potential && !eos->differences) say_no_potential(r, ".eos.model", eos);
    if (material->bulk_viscosity) say(r, ".viscosity", EXPLICIT_ONLY ": implicit steps need no bulk viscosity");
    if (material->failure[0]) say(r, ".failure", EXPLICIT_ONLY ": failure: none leaves out that of a preset");
}

// Conjugate gradients are for the symmetric matrices of potentials.
static void look_at_solver(const brunt_world_def *def, refusals *r) {
    for (int32_t b = 0; b < def->body_count && brunt_solver_iterates(def->newton.solver); b++) {
        const int32_t m = def->bodies[b].material;
        if (m < 0 || m >= def->material_count) continue;
        const brunt_model *strength = brunt_find_strength(def->materials[m].strength),
                          *eos = brunt_find_eos(def->materials[m].eos);
        if (!(strength && !strength->potential) && !(eos && !eos->potential)) continue;
        set_owner(r, "newton");
        say(r, ".solver", "%s wants symmetric matrices, and material '%s' has others: auto or direct is wanted",
            def->newton.solver == BRUNT_SOLVER_PCG ? "pcg" : "matrix-free", def->materials[m].name);
        return;
    }
}

static void look_at_body(const brunt_body_def *body, refusals *r) {
    set_owner(r, "bodies.%s", body->name);
    const brunt_erosion_def *erosion = &body->erosion;
    if (isfinite(erosion->strain) || erosion->step > 0 || erosion->inverted || erosion->keep)
        say(r, ".erosion", EXPLICIT_ONLY);
    for (int k = 0; k < brunt_body_number_count; k++) {
        const brunt_body_number *row = &brunt_body_numbers[k];
        if (row->explicit_only && *brunt_body_number_in(body, row) > 0)
            say(r, row->key, EXPLICIT_ONLY "%s", row->explicit_only);
    }
    if (body->total_lagrangian) say(r, ".lagrangian", "total: " EXPLICIT_ONLY);
    if (body->method == BRUNT_FEM && body->hourglass == BRUNT_HOURGLASS_VISCOUS)
        say(r, ".hourglass.form", "viscous: " EXPLICIT_ONLY ", stiffness is wanted");
}

// A boundary's name is where it stands in its file; without one it is counted, which is its place if all are planes.
static void name_boundary(refusals *r, int32_t index, const char *name) {
    if (name[0])
        set_owner(r, "boundaries (%s)", name);
    else
        set_owner(r, "boundaries[%d]", index);
}

static void look_at_boundaries(const brunt_world_def *def, refusals *r) {
    for (brunt_boundary_entry e = {.w = -1}; brunt_boundary_entry_next(def, &e);) {
        const brunt_boundary_kind *kind = e.kind;
        const char *key = "", *reason = kind->refusal ? kind->refusal(def, e.entry, &key) : NULL;
        if (!reason && brunt_scheme_minimises(def->scheme) && kind->hold_grid && !kind->hold_at)
            reason = EXPLICIT_ONLY; // which no row needs to say: its function is not there
        name_boundary(r, e.w, kind->name(e.entry));
        if (reason) say(r, key, "%s", reason);
    }
}

// The first two bodies of points that meet by a method that wants something else: by that of all, or one of their own.
static int find_points(const brunt_world_def *def, brunt_named_pair *first, brunt_error *error) {
    const brunt_contact_def *contact = &def->contact;
    brunt_named_pairs named;
    int status = brunt_named_pairs_make(&named, def, error);
    const unsigned points = brunt_contact_accepts(contact->method, false, false) ? 0 : 1;
    if (!status) status = brunt_first_usual_pair(def, &named, points, first, error);
    for (int32_t q = 0; !status && q < named.count; q++) {
        const brunt_named_pair *p = &named.pair[q];
        const bool last = q + 1 == named.count || p[1].a != p->a || p[1].b != p->b;
        if (first->a != BRUNT_NONE && (p->a > first->a || (p->a == first->a && p->b >= first->b))) break;
        if (!last || p->a == p->b || def->bodies[p->a].method != BRUNT_MPM || def->bodies[p->b].method != BRUNT_MPM ||
            brunt_contact_accepts(contact->pairs[p->at].method, false, false))
            continue;
        *first = *p;
        break;
    }
    brunt_named_pairs_free(&named);
    return status;
}

// Bodies of material points have no surface that particles of others could be kept from.
static void look_at_points(const brunt_world_def *def, refusals *r) {
    brunt_named_pair p = {BRUNT_NONE, BRUNT_NONE, BRUNT_NONE};
    brunt_error error;
    if (find_points(def, &p, &error)) {
        set_owner(r, "contact");
        say(r, ".pairs", "%s", error.message);
    }
    if (p.a == BRUNT_NONE) return;
    const brunt_body_def *a = &def->bodies[p.a], *b = &def->bodies[p.b];
    const brunt_contact_method method = p.at == BRUNT_NONE ? def->contact.method : def->contact.pairs[p.at].method;
    set_owner(r, "bodies.%s", b->name);
    say(r, ".method",
        "%s wants %s, neither '%s' nor '%s' is: each has a grid of its own and no surface; method: fem is "
        "wanted for one, or contact tied or none, for all or in pairs",
        brunt_contact_word(method), brunt_contact_wants(method), a->name, b->name);
}

static void look_at_contact(const brunt_world_def *def, refusals *r) {
    const brunt_contact_def *contact = &def->contact;
    set_owner(r, "contact");
    if (contact->allow_overlap)
        say(r, ".initial_overlap", "allow: " EXPLICIT_ONLY ", %s",
            brunt_contact_overlaps(contact->method) ? "penalties push apart what overlaps at the start without it"
                                                    : "barriers keep gaps open");
    look_at_points(def, r);
}

// Triangles are linear, and lie as their diagonals and their mesh have them: nothing is the mirror image of anything.
static void look_at_cells(const brunt_world_def *def, refusals *r) {
    if (def->cells == BRUNT_QUADS) return;
    set_owner(r, "grid");
    if (!brunt_scheme_minimises(def->scheme))
        say(r, ".cells", "triangles are for time.scheme: implicit and static; explicit steps go with quads");
    if (def->dimension != 2) say(r, ".cells", "triangles are for two dimensions; in three there are quads alone");
    if (def->kernel != BRUNT_LINEAR) say(r, ".kernel", "triangles are linear: kernel: linear is wanted");
    if (def->transfer == BRUNT_APIC && def->scheme == BRUNT_IMPLICIT)
        say(r, ".transfer", "apic: on triangles there are flip and pic");
    for (brunt_boundary_entry e = {.w = -1}; brunt_boundary_entry_next(def, &e);) {
        if (!e.kind->is_plane || !brunt_conditions[((const brunt_plane_def *)e.entry)->condition].symmetry) continue;
        name_boundary(r, e.w, e.kind->name(e.entry));
        say(r, ".condition",
            "a plane of symmetry mirrors cells, which triangles do not bear: a line with condition: "
            "slip is wanted");
    }
}

// APIC that keeps a share. Implicit steps take many h / 2c, which leave nothing of it.
static void look_at_share(const brunt_world_def *def, refusals *r) {
    if (def->transfer != BRUNT_APIC || !(def->apic > 0)) return;
    set_owner(r, "grid.transfer");
    if (brunt_scheme_minimises(def->scheme))
        say(r, ".apic", EXPLICIT_ONLY ": over longer ones nothing of a share is left; apic or {apic: 0} is wanted");
    if (def->kernel == BRUNT_LINEAR)
        say(r, ".apic", "with kernel linear apic makes energy: kernel quadratic or cubic is wanted for a share");
    set_owner(r, "time");
    if (def->scheme == BRUNT_EXPLICIT && def->cfl > BRUNT_SHARE_CFL)
        say(r, ".cfl", "%g: with a share in grid.transfer.apic at most %g is wanted, beyond it energy is made",
            def->cfl, BRUNT_SHARE_CFL);
}

static void look_at_implicit(const brunt_world_def *def, refusals *r) {
    look_at_solver(def, r);
    look_at_time(def, r);
    for (int32_t i = 0; i < def->body_count; i++) {
        look_at_material(def, &def->bodies[i], r);
        look_at_body(&def->bodies[i], r);
    }
}

// ------------------------------------------------------------------------------------------ load steps

#define NOT_STATIC BRUNT_NOT_STATIC

static bool moves(const double v[3]) { return v[0] != 0 || v[1] != 0 || v[2] != 0; }

// What flows has no equilibrium but at rest under its own weight, and of those there are many. Whether one is stable
// the matrix of a potential says.
static void look_at_equilibrium(const brunt_world_def *def, const brunt_body_def *body, refusals *r) {
    if (body->material < 0 || body->material >= def->material_count) return; // another mistake
    const brunt_material_def *material = &def->materials[body->material];
    const brunt_model *strength = brunt_find_strength(material->strength);
    set_owner(r, "materials.%s", material->name);
    if (!strength || strength->fluid || strength->shear_viscous)
        say(r, ".model", NOT_STATIC ": nothing keeps the shape of a fluid, it has no equilibrium to be found");
    const brunt_model *eos = brunt_find_eos(material->eos);
    if (strength && !strength->potential && strength->differences)
        say(r, ".model", NOT_STATIC ": '%s' has no potential to tell stable equilibria by", strength->name);
    if (eos && !eos->potential && eos->differences)
        say(r, ".eos.model", NOT_STATIC ": '%s' has no potential to tell stable equilibria by", eos->name);
}

static void look_at_friction(const brunt_world_def *def, refusals *r) {
    static const char *const why = BRUNT_FRICTION_NOT_STATIC;
    const brunt_contact_def *contact = &def->contact;
    if (brunt_friction_in_load_steps(def)) return;
    set_owner(r, "contact");
    if (contact->friction > 0) say(r, ".friction", "%s", why);
    for (int32_t q = 0; q < contact->pair_count; q++) {
        set_owner(r, "contact.pairs[%d]", q);
        if (contact->pairs[q].friction > 0) say(r, ".friction", "%s", why);
    }
}

static void look_at_static(const brunt_world_def *def, refusals *r) {
    for (int32_t i = 0; i < def->body_count; i++) {
        const brunt_body_def *body = &def->bodies[i];
        look_at_equilibrium(def, body, r);
        set_owner(r, "bodies.%s", body->name);
        if (body->method == BRUNT_MEMBRANE)
            say(r, ".method", NOT_STATIC ": nothing keeps the shape of a membrane before it is drawn");
        if (moves(body->velocity)) say(r, ".velocity", NOT_STATIC ": in load steps nothing moves");
        if (moves(body->wave_velocity)) say(r, ".wave.velocity", NOT_STATIC ": in load steps nothing moves");
        if (body->damping > 0) say(r, ".damping", NOT_STATIC ": in load steps nothing moves");
        if (moves(body->spin)) say(r, ".spin", NOT_STATIC ": in load steps nothing moves");
    }
    look_at_friction(def, r);
}

// ------------------------------------------------------------------------------------------ both

// Methods of contact that a scheme has not got.
static void look_at_method(brunt_contact_method method, const brunt_world_def *def, const refusals *r) {
    const brunt_scheme scheme = def->scheme;
    static const char own[] = "where no method is given each scheme takes its own";
    char words[80];
    if (brunt_contact_of_scheme(method, scheme)) {
        if (brunt_contact_is_planar(method) && def->dimension != 2)
            say(r, ".method", "%s: of two dimensions alone; in three %s is wanted", brunt_contact_word(method),
                brunt_contact_word(brunt_contact_default(scheme, true)));
        return;
    }
    const char *of = brunt_contact_of_scheme(method, BRUNT_EXPLICIT)   ? "explicit"
                     : brunt_contact_of_scheme(method, BRUNT_IMPLICIT) ? "implicit"
                                                                       : "static";
    brunt_contact_words_of(scheme, words, sizeof words);
    if (brunt_scheme_minimises(scheme))
        say(r, ".method", "%s: this belongs to time.scheme: %s, %s is wanted; %s", brunt_contact_word(method), of,
            words, own);
    else
        say(r, ".method", "%s: this belongs to time.scheme: %s; %s", brunt_contact_word(method), of, own);
}

static void look_at_methods(const brunt_world_def *def, refusals *r) {
    const brunt_contact_def *contact = &def->contact;
    set_owner(r, "contact");
    if (def->body_count > 1 || def->scheme == BRUNT_EXPLICIT || brunt_contact_is_planar(contact->method))
        look_at_method(contact->method, def, r);
    for (int32_t q = 0; q < contact->pair_count; q++) {
        set_owner(r, "contact.pairs[%d]", q);
        look_at_method(contact->pairs[q].method, def, r);
    }
}

static bool keeps_apart(brunt_contact_method method) {
    return brunt_contact_energy(method) && !brunt_contact_overlaps(method);
}

// Round rims have gaps with a sign; how far a barrier's step may go is known of facets alone.
static void look_at_surface(const brunt_world_def *def, refusals *r) {
    static const char wanted[] = "is by facets, and contact.surface: arcs by penalty alone";
    const brunt_contact_def *contact = &def->contact;
    if (contact->surface != BRUNT_SURFACE_ARCS) return;
    set_owner(r, "contact");
    if (def->dimension != 2) say(r, ".surface", "arcs are rims of two dimensions; in three facets is wanted");
    if (!brunt_contact_overlaps(contact->method) && contact->method != BRUNT_CONTACT_NONE)
        say(r, ".surface", "arcs: method %s of all other bodies %s", brunt_contact_word(contact->method), wanted);
    for (int32_t q = 0; q < contact->pair_count; q++) {
        set_owner(r, "contact.pairs[%d]", q);
        if (keeps_apart(contact->pairs[q].method))
            say(r, ".method", "%s %s", brunt_contact_word(contact->pairs[q].method), wanted);
    }
}

void brunt_scheme_refusals(const brunt_world_def *def, brunt_refusal_fn *refuse, void *context) {
    refusals r = {.refuse = refuse, .context = context, .owner = ""};
    const bool minimises = brunt_scheme_minimises(def->scheme);
    if (def->scheme == BRUNT_STATIC) look_at_static(def, &r);
    if (minimises) look_at_implicit(def, &r);
    look_at_cells(def, &r);
    look_at_share(def, &r);
    look_at_boundaries(def, &r);
    look_at_methods(def, &r);
    if (minimises) look_at_contact(def, &r);
    look_at_surface(def, &r);
}
