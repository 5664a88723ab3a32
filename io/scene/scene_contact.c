// Contact of a scene: the method for all, for single pairs, and what goes with which bodies.
#include "base/array.h"
#include "io/scene/scene_crowd.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "contact/methods/method.h"
#include "world/named_pairs.h"

// A body, or the first of a crowd: all of one method; NULL: there is none.
static const brunt_body_def *first_named(const scene_reader *reader, const char *name) {
    int32_t first;
    return brunt_bodies_named(reader, name, &first) ? &reader->scene->world.bodies[first] : NULL;
}

static bool has_mesh(const scene_reader *reader, const char *name) {
    const brunt_body_def *body = first_named(reader, name);
    return body && body->method != BRUNT_MPM;
}

static void check_pair_method(scene_reader *reader, const scene_node *method, const brunt_pair_def *pair) {
    const bool known = first_named(reader, pair->a) && first_named(reader, pair->b), a = has_mesh(reader, pair->a),
               b = has_mesh(reader, pair->b);
    if (brunt_contact_accepts(pair->method, a, b) || (!known && brunt_contact_accepts(pair->method, true, true)))
        return;
    brunt_tree_complain(reader->tree, method, "%s wants %s, which '%s' and '%s' are not",
                        brunt_contact_word(pair->method), brunt_contact_wants(pair->method), pair->a, pair->b);
}

// A membrane folds onto itself, which not every method meets: `method` is NULL when it is that of all pairs.
static void check_self(scene_reader *reader, const scene_node *between, const scene_node *method,
                       const brunt_pair_def *pair) {
    const brunt_body_def *body = brunt_body_named(reader, pair->a);
    const brunt_contact_self self = brunt_contact_with_itself(pair->method);
    const char *word = brunt_contact_word(brunt_contact_of_self(reader->scene->world.scheme));
    if (!body || pair->method == BRUNT_CONTACT_NONE) return;
    if (self == BRUNT_SELF_MESHES) {
        if (body->method == BRUNT_MPM)
            brunt_tree_complain(reader->tree, between,
                                "contact of a body with itself wants its mesh, '%s' is of method mpm", pair->a);
        return;
    }
    if (brunt_scheme_minimises(reader->scene->world.scheme))
        brunt_tree_complain(reader->tree, method ? method : between,
                            "contact of a body with itself is by %s: method: %s is wanted", word, word);
    else if (body->method != BRUNT_MEMBRANE)
        brunt_tree_complain(reader->tree, between,
                            "contact of a body with itself is for membranes in explicit steps, '%s' is none", pair->a);
    else if (self == BRUNT_SELF_NONE)
        brunt_tree_complain(reader->tree, method ? method : between,
                            "contact of a membrane with itself is by %s: method: %s is wanted", word, word);
    else if (body->contact_thickness == 0)
        brunt_tree_complain(reader->tree, between,
                            "contact of a membrane with itself wants a contact_thickness above 0, '%s' has none",
                            pair->a);
}

// A body, or a crowd: all its members.
static void check_bodies(scene_reader *reader, const scene_node *node) {
    int32_t first;
    if (!node->good || !node->text || brunt_bodies_named(reader, node->text, &first) < 2)
        brunt_check_body_name(reader, node);
}

static void fill_pair(scene_reader *reader, scene_node *node, brunt_pair_def *pair) {
    brunt_contact_def *contact = &reader->scene->world.contact;
    if (node->kind != SCENE_MAP) return;
    char friction[32];
    brunt_format_number(contact->friction, friction);
    const scene_node *method = brunt_tree_child(node, "method");
    pair->method = (brunt_contact_method)(int)brunt_real_of(node, "method", contact->method);
    const bool tied = brunt_contact_node_law(pair->method) != NULL;
    scene_node *rubs = brunt_tree_child(node, "friction");
    if (!rubs) rubs = brunt_add_default(reader, node, "friction", tied ? "0" : friction);
    pair->friction = brunt_real_of(node, "friction", 0);
    pair->sides = (brunt_contact_sides)(int)brunt_real_of(node, "sides", BRUNT_SIDES_BOTH);
    if (tied && pair->friction > 0)
        brunt_tree_complain_key(reader->tree, rubs, "%s bodies do not slide on each other: there is no friction",
                                brunt_contact_word(pair->method));
    const scene_node *between = brunt_tree_child(node, "between");
    if (!between || !between->good) return;
    if (between->count != 2) {
        brunt_tree_complain(reader->tree, between, "%d names are given, the two bodies of the pair are wanted",
                            between->count);
        return;
    }
    check_bodies(reader, between->first);
    check_bodies(reader, between->last);
    brunt_copy_text(reader, between->first, pair->a, sizeof pair->a);
    brunt_copy_text(reader, between->last, pair->b, sizeof pair->b);
    int32_t first;
    if (strcmp(pair->a, pair->b) == 0 && brunt_bodies_named(reader, pair->a, &first) > 1)
        brunt_tree_complain(reader->tree, between, "members of a crowd meet by what contact says of all");
    else if (strcmp(pair->a, pair->b) == 0)
        check_self(reader, between, method, pair);
    else if (method && method->good)
        check_pair_method(reader, method, pair);
}

// Only meshes that meet at each other's facets have slaves.
static void check_sides(scene_reader *reader, const scene_node *node, const brunt_pair_def *pair) {
    const scene_node *sides = brunt_tree_child(node, "sides");
    const bool known = first_named(reader, pair->a) && first_named(reader, pair->b),
               meshes = has_mesh(reader, pair->a) && has_mesh(reader, pair->b);
    if (!sides || !sides->good || pair->sides == BRUNT_SIDES_BOTH) return;
    if (!strcmp(pair->a, pair->b))
        brunt_tree_complain(reader->tree, sides, "'%s' is both sides of contact with itself", pair->a);
    else if (!brunt_contact_has_sides(pair->method, reader->scene->world.contact.form) || (known && !meshes))
        brunt_tree_complain(reader->tree, sides, "only two meshes in contact by %s have slaves",
                            BRUNT_CONTACT_WITH_SIDES);
}

// How many pairs of bodies an entry is: a crowd stands for all its members.
static int64_t pairs_of(const scene_reader *reader, const scene_node *node) {
    const scene_node *between = node->kind == SCENE_MAP ? brunt_tree_child(node, "between") : NULL;
    int32_t first;
    if (!between || !between->good || between->count != 2 || !strcmp(between->first->text, between->last->text))
        return 1;
    const int64_t a = brunt_bodies_named(reader, between->first->text, &first),
                  b = brunt_bodies_named(reader, between->last->text, &first);
    return a * b > 1 ? a * b : 1;
}

// From the first of them, which has the names that were given, to as many.
static void spread_pairs(const scene_reader *reader, brunt_pair_def *pair) {
    const brunt_body_def *body = reader->scene->world.bodies;
    const brunt_pair_def given = *pair;
    int32_t first[2];
    const int32_t a = brunt_bodies_named(reader, given.a, &first[0]),
                  b = brunt_bodies_named(reader, given.b, &first[1]);
    for (int32_t i = 0; i < a; i++)
        for (int32_t k = 0; k < b; k++, pair++) {
            *pair = given;
            memcpy(pair->a, body[first[0] + i].name, sizeof pair->a);
            memcpy(pair->b, body[first[1] + k].name, sizeof pair->b);
        }
}

static void fill_pairs(scene_reader *reader, const scene_node *list) {
    enum { LIMIT = 4 * BRUNT_CROWD_LIMIT };
    brunt_contact_def *contact = &reader->scene->world.contact;
    int64_t all = 0;
    if (!list || list->kind != SCENE_LIST) return;
    for (const scene_node *child = list->first; child; child = child->next) all += pairs_of(reader, child);
    if (all > LIMIT) brunt_tree_complain_key(reader->tree, list, "more than %d pairs of bodies cannot be held", LIMIT);
    contact->pairs = all > LIMIT ? NULL : brunt_entries_for(reader, (int)all, sizeof *contact->pairs);
    if (!contact->pairs) return;
    for (scene_node *child = list->first; child; child = child->next) {
        const int64_t count = pairs_of(reader, child);
        fill_pair(reader, child, &contact->pairs[contact->pair_count]);
        if (count > 1) spread_pairs(reader, &contact->pairs[contact->pair_count]);
        contact->pair_count += (int32_t)count;
    }
}

static void check_twice(scene_reader *reader, const scene_node *list, const brunt_named_pairs *named) {
    const int count = reader->scene->world.contact.pair_count;
    bool *twice = brunt_entries_for(reader, count, sizeof *twice);
    for (int32_t q = 1; twice && q < named->count; q++)
        if (named->pair[q].a == named->pair[q - 1].a && named->pair[q].b == named->pair[q - 1].b)
            twice[named->pair[q].at] = true;
    int64_t at = 0;
    for (const scene_node *child = twice ? list->first : NULL; child; child = child->next) {
        bool again = false;
        for (int64_t end = at + pairs_of(reader, child); at < end && at < count; at++) again = again || twice[at];
        if (again) brunt_tree_complain(reader->tree, brunt_tree_child(child, "between"), "this pair is there twice");
    }
    brunt_free(twice);
}

// A method for all that two bodies cannot meet by: said once, with the first two it is wrong for. Bodies of material
// points find one of their own.
static void check_method(scene_reader *reader, const scene_node *method, const brunt_named_pairs *named) {
    const brunt_world_def *world = &reader->scene->world;
    const brunt_contact_method of_all = world->contact.method;
    const unsigned mixed = brunt_contact_accepts(of_all, false, true) ? 0 : 2,
                   meshes = brunt_contact_accepts(of_all, true, true) ? 0 : 4;
    brunt_named_pair first;
    if (brunt_first_usual_pair(world, named, mixed | meshes, &first, NULL)) reader->tree->exhausted = true;
    if (first.a == BRUNT_NONE) return;
    brunt_tree_complain(reader->tree, method,
                        "%s wants %s, which '%s' and '%s' are not: %s is wanted, or pairs with a method of their own",
                        brunt_contact_word(of_all), brunt_contact_wants(of_all), world->bodies[first.a].name,
                        world->bodies[first.b].name, brunt_contact_word(brunt_contact_default(world->scheme, true)));
}

static void check_pairs(scene_reader *reader, const scene_node *list, const scene_node *method) {
    brunt_named_pairs named;
    if (brunt_named_pairs_make(&named, &reader->scene->world, NULL)) reader->tree->exhausted = true;
    check_twice(reader, list, &named);
    if (method && method->good) check_method(reader, method, &named);
    brunt_named_pairs_free(&named);
}

// Whether all pairs but some, or some pairs, meet by a method of a row, which has bodies for it; or planes push by it.
static bool uses(const brunt_world_def *world, const brunt_contact_row *row) {
    const brunt_contact_def *contact = &world->contact;
    bool used = brunt_contact_is_of(row, contact->method), meshes = !(row->meets & BRUNT_MEET_ON_GRID), pushes = false;
    for (int i = 0; i < contact->pair_count; i++) used |= brunt_contact_is_of(row, contact->pairs[i].method);
    for (int i = 0; i < world->body_count; i++) meshes |= world->bodies[i].method != BRUNT_MPM;
    for (int i = 0; i < world->plane_count; i++) pushes |= world->planes[i].condition == BRUNT_SEPARATE;
    return (used && meshes) || (pushes && brunt_contact_pushes_planes(row, contact->method));
}

// Whether boundaries push material points and let go, in explicit steps: how they are stopped is asked there, too.
static bool points_meet_boundaries(const brunt_world_def *world) {
    bool points = false, pushes = false;
    for (int i = 0; i < world->body_count; i++) points |= world->bodies[i].method == BRUNT_MPM;
    for (int i = 0; i < world->plane_count; i++) pushes |= world->planes[i].condition == BRUNT_SEPARATE;
    for (int i = 0; i < world->surface_count; i++) pushes |= world->surfaces[i].condition == BRUNT_SEPARATE;
    return points && pushes && world->scheme == BRUNT_EXPLICIT;
}

static void refuse_key(scene_reader *reader, const scene_node *node, const char *key, const char *what,
                       const char *words) {
    char why[160];
    snprintf(why, sizeof why, "this belongs to %s: %s", what, words);
    brunt_refuse_key(reader, node, key, why);
}

// Whether a key goes with what is used, by the keys that rows of methods say they have; refused or noted where not.
static bool takes(scene_reader *reader, scene_node *node, const char *key) {
    const brunt_world_def *world = &reader->scene->world;
    const scene_node *form = brunt_tree_child(node, "form");
    const brunt_contact_row *first = NULL;
    bool used = !strcmp(key, "stop") && points_meet_boundaries(world), formed = used;
    unsigned forms = 0;
    for (int r = 0; r < brunt_contact_row_count; r++) {
        const brunt_contact_row *row = brunt_contact_rows[r];
        if (!(row->schemes >> world->scheme & 1) || !brunt_contact_has_key(row, key)) continue;
        if (!first) first = row;
        forms |= row->forms;
        used = used || uses(world, row);
        formed = formed || (uses(world, row) && brunt_contact_has_form(row, world->contact.form));
    }
    char words[96];
    brunt_augury_words_of(forms, words, sizeof words);
    if (!first)
        brunt_note_unused(reader, node, key);
    else if (!used)
        refuse_key(reader, node, key, "method",
                   brunt_contact_word((brunt_contact_method)__builtin_ctz(first->methods)));
    else if (!formed && form && form->good)
        refuse_key(reader, node, key, "form", words);
    return formed;
}

// A number of contact, or a word by its place, or its default, where it goes with what is used.
static double take(scene_reader *reader, scene_node *node, const char *key, double otherwise) {
    char path[40];
    snprintf(path, sizeof path, "contact.%s", key);
    if (!takes(reader, node, key)) return otherwise;
    const char *initial = brunt_scene_row(path)->initial;
    if (*initial && !brunt_tree_child(node, key)) brunt_add_default(reader, node, key, initial);
    return brunt_real_of(node, key, otherwise);
}

static void fill_keys(scene_reader *reader, scene_node *node) {
    brunt_contact_def *contact = &reader->scene->world.contact;
    contact->form = (brunt_augury_form)(int)take(reader, node, "form", contact->form);
    contact->cell = take(reader, node, "cell", 0);
    contact->transfer = take(reader, node, "transfer", 1) == 0 ? BRUNT_PIC : BRUNT_APIC;
    contact->tolerance = take(reader, node, "tolerance", contact->tolerance);
    contact->iterations = (int)take(reader, node, "iterations", -1);
    contact->touch = (brunt_touch_kind)(int)take(reader, node, "touch", contact->touch);
    contact->stop = (brunt_stop_kind)(int)take(reader, node, "stop", contact->stop);
    contact->distance = take(reader, node, "distance", 0);
    contact->stiffness = take(reader, node, "stiffness", 0);
    contact->penalty = take(reader, node, "penalty", 0);
    contact->slip_speed = take(reader, node, "slip_speed", 0);
    contact->slip_length = take(reader, node, "slip_length", 0);
    contact->surface = (brunt_surface_kind)(int)take(reader, node, "surface", contact->surface);
    contact->friction_iterations = (int)take(reader, node, "friction_iterations", 1);
}

// Bodies of material points that are to meet by a method with forms: not all have rows for them, or for rings.
static void check_touch(scene_reader *reader, const scene_node *method, brunt_contact_method of_them) {
    const brunt_world_def *world = &reader->scene->world;
    const unsigned forms = brunt_augury_forms_of_points(of_them);
    const brunt_contact_method instead =
        brunt_contact_between_points(of_them, world->contact.form, world->axisymmetric);
    char words[96];
    if (!forms || instead == of_them) return;
    brunt_augury_words_of(forms, words, sizeof words);
    if (world->axisymmetric)
        brunt_tree_complain(reader->tree, method,
                            "%s of two bodies of method mpm is not for axisymmetric scenes: %s is wanted",
                            brunt_contact_word(of_them), brunt_contact_word(instead));
    else
        brunt_tree_complain(reader->tree, method, "%s of two bodies of method mpm wants form: %s",
                            brunt_contact_word(of_them), words);
}

static void check_ways(scene_reader *reader, const scene_node *list) {
    const brunt_contact_def *contact = &reader->scene->world.contact;
    int64_t i = 0;
    for (scene_node *child = contact->pairs ? list->first : NULL; child;
         i += pairs_of(reader, child), child = child->next) {
        const brunt_pair_def *pair = &contact->pairs[i]; // the first of a crowd: all are of one method
        const brunt_body_def *a = brunt_body_named(reader, pair->a), *b = brunt_body_named(reader, pair->b);
        const scene_node *method = child->kind == SCENE_MAP ? brunt_tree_child(child, "method") : NULL;
        if (a && b && a != b && a->method == BRUNT_MPM && b->method == BRUNT_MPM && method && method->good)
            check_touch(reader, method, pair->method);
        if (child->kind == SCENE_MAP) check_sides(reader, child, pair);
    }
}

// Names may hold the hyphen that columns of pairs are joined by.
static void check_pair_columns(scene_reader *reader) {
    const brunt_world_def *world = &reader->scene->world;
    int32_t first[2], second[2];
    if (!brunt_pairs_of_one_name(world, first, second)) return;
    const brunt_body_def *body = world->bodies;
    if (!strcmp(body[first[0]].name, body[second[0]].name) && !strcmp(body[first[1]].name, body[second[1]].name))
        return; // a body that is there twice, which has been said
    const scene_node *all = brunt_tree_child(reader->tree->root, "bodies"),
                     *node = brunt_tree_child(all, body[second[0]].name);
    brunt_tree_complain_key(reader->tree, node ? node : all, // a member of a crowd has no key of its own
                            "the pair of '%s' and '%s' has the name of that of '%s' and '%s' in the history, "
                            "contact.%s-%s: another name is wanted",
                            body[second[0]].name, body[second[1]].name, body[first[0]].name, body[first[1]].name,
                            body[first[0]].name, body[first[1]].name);
}

void brunt_fill_contact(scene_reader *reader) {
    brunt_world_def *world = &reader->scene->world;
    brunt_contact_def *contact = &world->contact;
    scene_node *node = brunt_tree_child(reader->tree->root, "contact");
    if (!node || node->kind != SCENE_MAP) return;
    bool fem = false;
    for (int i = 0; i < world->body_count; i++) fem |= world->bodies[i].method != BRUNT_MPM;
    const scene_node *method = brunt_tree_child(node, "method");
    contact->method = brunt_contact_default(world->scheme, fem);
    // A default is not written down: each scheme takes its own, also of a resolved scene.
    contact->method = (brunt_contact_method)(int)brunt_real_of(node, "method", contact->method);
    contact->friction = brunt_real_of(node, "friction", 0);
    contact->allow_overlap = brunt_real_of(node, "initial_overlap", 0) == 1;
    fill_pairs(reader, brunt_tree_child(node, "pairs"));
    check_pairs(reader, brunt_tree_child(node, "pairs"), method);
    fill_keys(reader, node);
    if (!fem && world->body_count && method && method->good) check_touch(reader, method, contact->method);
    check_ways(reader, brunt_tree_child(node, "pairs"));
    check_pair_columns(reader);
}

static bool add_number(scene_reader *reader, scene_node *map, const char *key, double value) {
    char text[32];
    brunt_format_number(value, text);
    return brunt_tree_child(map, key) || brunt_add_default(reader, map, key, text);
}

int brunt_scene_take_values(const brunt_scene *scene, const brunt_world *world, brunt_error *error) {
    scene_tree *tree = scene->resolved;
    scene_node *contact = brunt_tree_child(tree->root, "contact");
    brunt_barrier_values v;
    if (!contact || contact->kind != SCENE_MAP || !brunt_world_barrier(world, &v)) return BRUNT_OK;
    scene_reader reader = {.tree = tree, .units = brunt_units_open(), .dimension = scene->world.dimension};
    const bool one = v.stiffness[0] == v.stiffness[1] && v.stiffness[0] > 0;
    const bool apart = v.distance > 0 && !(v.penalty[1] > 0); // a default of barriers: penalties beside them have none
    const bool added = reader.units && (!apart || add_number(&reader, contact, "distance", v.distance)) &&
                       (!one || add_number(&reader, contact, "stiffness", v.stiffness[0])) &&
                       (!(v.slip_speed > 0) || add_number(&reader, contact, "slip_speed", v.slip_speed));
    if (reader.units) brunt_units_close(reader.units);
    return added ? BRUNT_OK : brunt_fail(error, BRUNT_FAILED, "out of memory for the resolved scene");
}
