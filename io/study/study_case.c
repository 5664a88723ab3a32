// What a case of a study comes to: the scene, the program and the sets, with placeholders and factors put in.
#include "io/study/study_reader.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "io/scene/scene_reader.h"

char *brunt_study_copy(const char *text) {
    char *copy = text ? brunt_alloc(strlen(text) + 1) : NULL;
    if (copy) memcpy(copy, text, strlen(text) + 1);
    return copy;
}

// ---------------------------------------------------------------------------------------------------- placeholders

static size_t name_length(const char *text) {
    size_t n = 0;
    while (isalnum((unsigned char)text[n]) || text[n] == '_' || text[n] == '-') n++;
    return n;
}

int32_t brunt_study_placeholder(const brunt_study *study, const char *text, double *factor, const char **rest,
                                bool *unknown) {
    *factor = 1;
    *unknown = false;
    size_t length = *text == '{' ? name_length(text + 1) : 0;
    if (length == 0) return BRUNT_NONE;
    const char *p = text + 1 + length;
    if (*p == '*' || *p == '/') {
        bool divide = *p == '/';
        if (brunt_read_number(p + 1, factor, &p) || (divide && *factor == 0)) return BRUNT_NONE;
        if (divide) *factor = 1 / *factor;
    }
    if (*p != '}') return BRUNT_NONE;
    *rest = p + 1;
    for (int32_t a = 0; a < study->axis_count; a++)
        if (strlen(study->axes[a].name) == length && memcmp(study->axes[a].name, text + 1, length) == 0) return a;
    *unknown = true;
    return BRUNT_NONE;
}

static void expand(const brunt_study *study, const brunt_study_case *c, const char *text, FILE *out) {
    while (*text) {
        double factor;
        const char *rest;
        bool unknown;
        int32_t a = *text == '{' ? brunt_study_placeholder(study, text, &factor, &rest, &unknown) : BRUNT_NONE;
        if (a < 0) {
            fputc(*text++, out);
            continue;
        }
        const brunt_study_value *value = &study->axes[a].values[c->value[a]];
        char number[32];
        if (isfinite(value->number)) brunt_format_number(value->number * factor, number);
        fputs(isfinite(value->number) ? number : value->label, out);
        text = rest;
    }
}

// NULL when there is no memory.
static char *expanded(const brunt_study *study, const brunt_study_case *c, const char *text) {
    char *result = NULL, *copy;
    size_t length;
    FILE *out = open_memstream(&result, &length);
    if (!out) return NULL;
    expand(study, c, text, out);
    copy = fclose(out) == 0 ? brunt_study_copy(result) : NULL;
    free(result);
    return copy;
}

static bool expand_path(const brunt_study *study, const brunt_study_case *c, const char *text, char out[1024]) {
    char *path = expanded(study, c, text);
    bool good = path && snprintf(out, 1024, "%s", path) < 1024;
    brunt_free(path);
    return good;
}

// ---------------------------------------------------------------------------------------------------- factors

// The value of a checked scene at a path, NULL: there is none.
static const scene_node *value_at(const scene_node *node, const char *path) {
    char key[256];
    while (node && *path) {
        size_t length = strcspn(path, ".[]");
        if (length == 0 || length >= sizeof key) return NULL;
        memcpy(key, path, length);
        key[length] = 0;
        if (node->kind == SCENE_MAP) {
            node = brunt_tree_child(node, key);
        } else {
            const scene_node *child = node->first;
            for (int i = atoi(key); child && i > 0; i--) child = child->next;
            node = child;
        }
        path += length;
        while (*path == '.' || *path == '[' || *path == ']') path++;
    }
    return node;
}

// False when it is not all numbers.
static bool write_scaled(FILE *out, const scene_node *node, double factor) {
    if (node->kind == SCENE_MAP) return false;
    if (node->kind == SCENE_SCALAR) {
        char text[32];
        if (!node->number) return false;
        brunt_format_number(node->value[0] * factor, text);
        fputs(text, out);
        return true;
    }
    bool good = node->count > 0;
    fputc('[', out);
    for (const scene_node *child = node->first; child; child = child->next) {
        if (child != node->first) fputs(", ", out);
        good &= write_scaled(out, child, factor);
    }
    fputc(']', out);
    return good;
}

// "path*=0.5" becomes "path=<half of what the scene has there>".
static int scale_set(const brunt_scene *scene, char **set, brunt_error *error) {
    char *mark = strstr(*set, "*="), *result = NULL, *copy = NULL;
    size_t length;
    double factor = strtod(mark + 2, NULL);
    *mark = 0;
    const scene_node *node = value_at(((const scene_tree *)scene->resolved)->root, *set);
    FILE *out = open_memstream(&result, &length);
    if (!out) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    fprintf(out, "%s=", *set);
    bool good = node && write_scaled(out, node, factor);
    if (fclose(out) == 0 && good) copy = brunt_study_copy(result);
    free(result);
    if (!good)
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          node ? "%s is no number in %s: it cannot be scaled" : "there is no %s in %s to be scaled",
                          *set, scene->source);
    if (!copy) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    brunt_free(*set);
    *set = copy;
    return BRUNT_OK;
}

static bool is_scaled(const char *set) {
    const char *equals = strchr(set, '=');
    return equals && equals > set && equals[-1] == '*';
}

// Reads the scene with the plain sets, and makes plain ones of the others.
static int put_factors_in(study_job *job, study_origin *culprit, brunt_error *error) {
    const char **plain = brunt_alloc((size_t)(job->set_count + 1) * sizeof *plain);
    if (!plain) return brunt_fail(error, BRUNT_FAILED, "out of memory");
    int32_t count = 0;
    for (int32_t s = 0; s < job->set_count; s++)
        if (!is_scaled(job->sets[s])) plain[count++] = job->sets[s];
    brunt_scene scene;
    int status = BRUNT_OK;
    bool readable = count == job->set_count || brunt_scene_read(job->scene, plain, count, &scene, NULL) == BRUNT_OK;
    for (int32_t s = 0; s < job->set_count && count < job->set_count && readable && !status; s++) {
        if (!is_scaled(job->sets[s])) continue;
        *culprit = job->origins[s];
        status = scale_set(&scene, &job->sets[s], error);
    }
    if (count < job->set_count && readable) brunt_scene_free(&scene);
    // A scene with mistakes in it: what is left of the sets is enough to find them.
    if (!readable) {
        int32_t kept = 0;
        for (int32_t s = 0; s < job->set_count; s++) {
            if (is_scaled(job->sets[s])) {
                brunt_free(job->sets[s]);
            } else {
                job->sets[kept] = job->sets[s];
                job->origins[kept++] = job->origins[s];
            }
        }
        job->set_count = kept;
    }
    brunt_free(plain);
    return status;
}

// ---------------------------------------------------------------------------------------------------- the job

static bool add_sets(const brunt_study *study, const brunt_study_case *c, char *const *sets, int32_t count,
                     int32_t axis, study_job *job) {
    for (int32_t s = 0; s < count; s++) {
        char *set = expanded(study, c, sets[s]);
        if (!set) return false;
        job->sets[job->set_count] = set;
        job->origins[job->set_count++] = (study_origin){axis, axis < 0 ? 0 : c->value[axis], s};
    }
    return true;
}

int brunt_study_job(const brunt_study *study, const brunt_study_case *c, study_job *job, study_origin *culprit,
                    brunt_error *error) {
    *job = (study_job){.threads = study->threads};
    *culprit = (study_origin){.axis = -1};
    const char *scene = study->scene, *program = "";
    int32_t count = study->set_count;
    for (int32_t a = 0; a < study->axis_count; a++) {
        const brunt_study_value *value = &study->axes[a].values[c->value[a]];
        count += value->set_count;
        if (*value->scene) scene = value->scene;
        if (*value->program) program = value->program;
        if (value->threads) job->threads = value->threads;
    }
    job->sets = brunt_alloc((size_t)(count + 1) * sizeof *job->sets);
    job->origins = brunt_alloc((size_t)(count + 1) * sizeof *job->origins);
    bool good = job->sets && job->origins && expand_path(study, c, scene, job->scene) &&
                expand_path(study, c, program, job->program) &&
                add_sets(study, c, study->sets, study->set_count, -1, job);
    for (int32_t a = 0; good && a < study->axis_count; a++) {
        const brunt_study_value *value = &study->axes[a].values[c->value[a]];
        good = add_sets(study, c, value->sets, value->set_count, a, job);
    }
    return good ? put_factors_in(job, culprit, error) : brunt_fail(error, BRUNT_FAILED, "out of memory");
}

void brunt_study_job_free(study_job *job) {
    for (int32_t s = 0; job->sets && s < job->set_count; s++) brunt_free(job->sets[s]);
    brunt_free(job->sets);
    brunt_free(job->origins);
    memset(job, 0, sizeof *job);
}
