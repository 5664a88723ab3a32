// The cases of a study: which there are, and whether the scene of each can be run.
#include "io/study/study_cases.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/study/study_view.h"

enum { CASE_LIMIT = 10000 };

static bool next_case(const brunt_study *study, int32_t value[BRUNT_STUDY_AXES]) {
    for (int32_t a = study->axis_count - 1; a >= 0; a--) {
        if (++value[a] < study->axes[a].value_count) return true;
        value[a] = 0;
    }
    return false;
}

typedef struct skip_rule {
    int32_t value[BRUNT_STUDY_AXES]; // -1: any
} skip_rule;

static int32_t read_skips(study_reader *r, const scene_node *list, skip_rule **rules) {
    *rules = NULL;
    if (!list) return 0;
    if (list->kind != SCENE_LIST) {
        brunt_tree_complain(study_tree(r), list, "a list of maps from axes to labels is wanted");
        return 0;
    }
    *rules = study_entries(r, list->count, sizeof **rules);
    int32_t count = 0;
    for (const scene_node *child = *rules ? list->first : NULL; child; child = child->next) {
        skip_rule rule;
        for (int32_t a = 0; a < BRUNT_STUDY_AXES; a++) rule.value[a] = -1;
        bool good = child->kind == SCENE_MAP && child->count;
        if (!good) brunt_tree_complain(study_tree(r), child, "a map from axes to labels is wanted");
        for (const scene_node *entry = good ? child->first : NULL; entry; entry = entry->next) {
            int32_t a = study_axis_named(r, entry, entry->key, true), v = -1;
            if (a >= 0 && entry->kind == SCENE_SCALAR) v = study_value_labelled(r, entry, a, entry->text, false);
            if (entry->kind != SCENE_SCALAR) brunt_tree_complain(study_tree(r), entry, "one label is wanted");
            if (v < 0)
                good = false;
            else
                rule.value[a] = v;
        }
        if (good) (*rules)[count++] = rule;
    }
    return count;
}

static bool skipped(const brunt_study *study, const int32_t *value, const skip_rule *rules, int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        bool all = true;
        for (int32_t a = 0; a < study->axis_count; a++) all &= rules[i].value[a] < 0 || rules[i].value[a] == value[a];
        if (all) return true;
    }
    return false;
}

static bool same_line(const brunt_study *study, const int32_t *x, const int32_t *y) {
    for (int32_t a = 0; a < study->axis_count; a++)
        if (a != study->resolution && x[a] != y[a]) return false;
    return true;
}

// "APIC, quadratic"; a label that begins with a digit has its axis before it: "FLIP, order = 2".
static void name_line(const brunt_study *study, const brunt_study_case *c, char *out, size_t size) {
    size_t used = 0;
    for (int32_t a = 0; a < study->axis_count && used + 1 < size; a++) {
        if (a == study->resolution) continue;
        const char *label = study->axes[a].values[c->value[a]].label;
        bool bare = !isdigit((unsigned char)*label);
        int wrote = snprintf(out + used, size - used, "%s%s%s%s", used ? ", " : "", bare ? "" : study->axes[a].name,
                             bare ? "" : " = ", label);
        used += wrote > 0 ? (size_t)wrote : 0;
    }
}

static void add_case(brunt_study *study, const int32_t *value) {
    brunt_study_case *c = &study->cases[study->case_count++];
    memcpy(c->value, value, sizeof c->value);
    c->wall_median = c->wall_least = c->wall_greatest = NAN;
    for (int32_t m = 0; m < BRUNT_STUDY_MEASURES; m++) c->result[m] = c->expect[m] = c->error[m] = NAN;
    for (const brunt_study_case *other = study->cases; other < c; other++)
        if (same_line(study, other->value, value)) {
            c->line = other->line;
            return;
        }
    c->line = study->line_count++;
    name_line(study, c, study->lines[c->line].label, sizeof study->lines[c->line].label);
}

void study_make_cases(study_reader *r) {
    brunt_study *study = r->study;
    const scene_node *root = study_tree(r)->root;
    skip_rule *rules;
    int32_t rule_count = read_skips(r, brunt_tree_child(root, "skip"), &rules);
    double all = 1;
    for (int32_t a = 0; a < study->axis_count; a++) all *= study->axes[a].value_count;
    if (study->axis_count && all > CASE_LIMIT)
        brunt_tree_complain_key(study_tree(r), brunt_tree_child(root, "axes"), "%.0f cases, at most %d are wanted", all,
                                CASE_LIMIT);
    if (study->axis_count && all >= 1 && all <= CASE_LIMIT) {
        study->cases = study_entries(r, (int32_t)all, sizeof *study->cases);
        study->lines = study_entries(r, (int32_t)all, sizeof *study->lines);
        int32_t value[BRUNT_STUDY_AXES] = {0};
        bool more = study->cases && study->lines;
        for (; more; more = next_case(study, value))
            if (!skipped(study, value, rules, rule_count)) add_case(study, value);
        if (study->case_count < 2 && study_tree(r)->message_count == 0)
            brunt_tree_complain_key(study_tree(r), brunt_tree_child(root, "axes"),
                                    "%d case is left, at least two are wanted: an axis with two values",
                                    study->case_count);
    }
    for (int32_t c = 0; c < study->case_count; c++)
        study->cases[c].wall = study_entries(r, study->repeats, sizeof *study->cases[c].wall);
    brunt_free(rules);
}

void study_check_methods(study_reader *r) {
    const brunt_study *study = r->study;
    const scene_node *measures = brunt_tree_child(study_tree(r)->root, "measures");
    const char *names[CHOICE_LIMIT];
    int count = 0;
    for (int32_t l = 0; l < study->line_count && count < CHOICE_LIMIT; l++)
        if (*study->lines[l].label) names[count++] = study->lines[l].label;
    for (int32_t m = 0; m < study->measure_count; m++) {
        const char *of = study->measures[m].of;
        bool limit = study->measures[m].reference == BRUNT_REFERENCE_RICHARDSON;
        bool found = !*of || !(limit || study->measures[m].reference == BRUNT_REFERENCE_FINEST);
        for (int i = 0; i < count; i++) found |= strcmp(names[i], of) == 0;
        for (int32_t a = 0; a < study->axis_count; a++)
            for (int32_t v = 0; a != study->resolution && v < study->axes[a].value_count; v++)
                found |= strcmp(study->axes[a].values[v].label, of) == 0;
        if (found) continue;
        study_complain_choice(r, brunt_tree_child(brunt_tree_child(measures, study->measures[m].name), "of"), "method",
                              of, names, count, false);
    }
}

// ---------------------------------------------------------------------------------------------------- their scenes

static const scene_node *child_number(const scene_node *node, int32_t index) {
    const scene_node *child = node ? node->first : NULL;
    for (; child && index > 0; index--) child = child->next;
    return child;
}

// The value in the study file that brought a set.
static const scene_node *place_of(study_reader *r, study_origin origin) {
    const scene_node *root = study_tree(r)->root;
    if (origin.axis < 0) return child_number(brunt_tree_child(root, "set"), origin.set);
    const scene_node *value = child_number(r->values[origin.axis], origin.value);
    if (r->keyed[origin.axis] || !value) return value;
    const scene_node *entry = value->first;
    for (int32_t s = origin.set; entry; entry = entry->next) {
        if (study_key_is_special(entry->key)) continue;
        if (s-- == 0) break;
    }
    return entry ? entry : value;
}

// Where the scene of a case is named: the last axis that gives one, else the study's own.
static const scene_node *place_of_scene(study_reader *r, const brunt_study_case *c) {
    for (int32_t a = r->study->axis_count - 1; a >= 0; a--) {
        const scene_node *value = child_number(r->values[a], c->value[a]);
        if (!*r->study->axes[a].values[c->value[a]].scene) continue;
        const scene_node *own = r->keyed[a] ? NULL : brunt_tree_child(value, "scene");
        return own ? own : value;
    }
    const scene_node *scene = brunt_tree_child(study_tree(r)->root, "scene");
    return scene ? scene : study_tree(r)->root;
}

typedef struct seen_list {
    char *text[SCENE_MESSAGE_LIMIT];
    const scene_node *at[SCENE_MESSAGE_LIMIT];
    int count;
} seen_list;

// True once for each mistake at a place, whichever cases bring it again.
static bool first_time(study_reader *r, seen_list *seen, const scene_node *at, const char *text) {
    for (int i = 0; i < seen->count; i++)
        if (seen->at[i] == at && strcmp(seen->text[i], text) == 0) return false;
    if (seen->count >= SCENE_MESSAGE_LIMIT) return true;
    seen->text[seen->count] = brunt_tree_text(study_tree(r), text, strlen(text));
    if (!seen->text[seen->count]) return false;
    seen->at[seen->count++] = at;
    return true;
}

static void report_line(study_reader *r, const brunt_study_case *c, const study_job *job, seen_list *seen,
                        const char *line) {
    char label[320];
    brunt_study_case_label(r->study, c, label);
    for (int32_t s = 0; strncmp(line, "--set ", 6) == 0 && s < job->set_count; s++) {
        size_t length = strlen(job->sets[s]);
        if (strncmp(line + 6, job->sets[s], length) != 0 || strncmp(line + 6 + length, ": ", 2) != 0) continue;
        const scene_node *at = place_of(r, job->origins[s]);
        const char *text = line + 6 + length + 2;
        if (at && first_time(r, seen, at, text)) brunt_tree_complain(study_tree(r), at, "in the scene: %s", text);
        return;
    }
    const scene_node *at = place_of_scene(r, c);
    if (first_time(r, seen, at, line)) brunt_tree_complain(study_tree(r), at, "with %s: %s", label, line);
}

static void check_measures(study_reader *r, const brunt_study_case *c, const brunt_scene *scene, seen_list *seen) {
    const brunt_study *study = r->study;
    const scene_node *map = brunt_tree_child(study_tree(r)->root, "measures");
    const char *names[CHOICE_LIMIT];
    int count = 0;
    for (int32_t i = 0; i < scene->measure_count && count < CHOICE_LIMIT; i++) names[count++] = scene->measures[i].name;
    for (int32_t m = 0; m < study->measure_count; m++) {
        const brunt_study_measure *measure = &study->measures[m];
        const brunt_measure *found = NULL;
        for (int32_t i = 0; i < scene->measure_count; i++)
            if (strcmp(scene->measures[i].name, measure->name) == 0) found = &scene->measures[i];
        const scene_node *at = brunt_tree_child(map, measure->name);
        char what[1100], label[320];
        snprintf(what, sizeof what, "measure in %.1000s:", scene->source);
        if (!found) {
            if (first_time(r, seen, at, what)) study_complain_choice(r, at, what, measure->name, names, count, true);
        } else if (measure->reference == BRUNT_REFERENCE_NUMBER && isnan(measure->exact) && isnan(found->expect)) {
            brunt_study_case_label(study, c, label);
            if (first_time(r, seen, at, "expect"))
                brunt_tree_complain_key(study_tree(r), at,
                                        "with %s the scene expects nothing of it: a reference is wanted", label);
        }
    }
}

static void check_case(study_reader *r, const brunt_study_case *c, seen_list *seen) {
    study_job job;
    study_origin culprit;
    brunt_error error = {0};
    int status = brunt_study_job(r->study, c, &job, &culprit, &error);
    const scene_node *at = status == BRUNT_BAD_INPUT ? place_of(r, culprit) : NULL;
    if (at && first_time(r, seen, at, error.message)) brunt_tree_complain(study_tree(r), at, "%s", error.message);
    if (status == BRUNT_FAILED) study_tree(r)->exhausted = true;
    char *text = NULL;
    size_t length = 0;
    FILE *messages = status ? NULL : open_memstream(&text, &length);
    if (messages) {
        brunt_scene scene;
        int read = brunt_scene_read(job.scene, (const char *const *)job.sets, job.set_count, &scene, messages);
        fclose(messages);
        for (char *line = text ? strtok(text, "\n") : NULL; line && read; line = strtok(NULL, "\n"))
            if (*line != ' ') report_line(r, c, &job, seen, line); // indented: the line of the scene, and a caret
        if (!read) check_measures(r, c, &scene, seen);
        if (!read) brunt_scene_free(&scene);
    }
    free(text);
    brunt_study_job_free(&job);
}

void study_check_cases(study_reader *r) {
    const scene_node *root = study_tree(r)->root;
    for (int32_t c = 0; c < r->study->case_count; c++) {
        bool has_scene = *r->study->scene;
        for (int32_t a = 0; a < r->study->axis_count; a++)
            has_scene |= *r->study->axes[a].values[r->study->cases[c].value[a]].scene != 0;
        if (has_scene) continue;
        char label[320];
        brunt_study_case_label(r->study, &r->study->cases[c], label);
        brunt_tree_complain_key(study_tree(r), root, "'scene' is missing: with %s there is none", label);
        return;
    }
    seen_list *seen = brunt_tree_alloc(study_tree(r), sizeof *seen);
    if (!seen) return;
    seen->count = 0;
    for (int32_t c = 0; c < r->study->case_count; c++) check_case(r, &r->study->cases[c], seen);
}
