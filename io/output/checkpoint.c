#include "io/output/checkpoint.h"

#include <libfyaml.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/file/hdf5_file.h"
#include "base/simd.h"
#include "base/memory.h"
#include "base/real.h"

enum { FORMAT = 2, DATASET_NAME = 128 };

void brunt_run_state_free(brunt_run_state *state) {
    brunt_free(state->picture_times);
    state->picture_times = NULL;
    state->picture_count = 0;
}

// ---------------------------------------------------------------------------------------------------- element types

typedef struct element_type {
    char letter;
    const char *name;
    size_t bytes;
    H5T_class_t class;
} element_type;

static const element_type element_types[] = {{'d', "double", 8, H5T_FLOAT},
                                             {'f', "float", 4, H5T_FLOAT},
                                             {'i', "int64", 8, H5T_INTEGER},
                                             {'b', "bytes", 1, H5T_INTEGER}};

static const element_type *find_type(char letter) {
    for (size_t t = 0; t < sizeof element_types / sizeof *element_types; t++)
        if (element_types[t].letter == letter) return &element_types[t];
    return NULL;
}

static hid_t file_type(char letter) {
    return letter == 'd'   ? H5T_IEEE_F64LE
           : letter == 'f' ? H5T_IEEE_F32LE
           : letter == 'i' ? H5T_STD_I64LE
                           : H5T_STD_U8LE;
}

static hid_t memory_type(char letter) {
    return letter == 'd'   ? H5T_NATIVE_DOUBLE
           : letter == 'f' ? H5T_NATIVE_FLOAT
           : letter == 'i' ? H5T_NATIVE_INT64
                           : H5T_NATIVE_UINT8;
}

// ---------------------------------------------------------------------------------------------------- taking

typedef struct taken_block {
    brunt_state_block info;
    void *values;
} taken_block;

struct brunt_checkpoint {
    brunt_run_state run;
    double time; // [s]
    int64_t step, particles, elements;
    int32_t count;
    taken_block block[];
};

brunt_checkpoint *brunt_checkpoint_take(brunt_world *world, const brunt_run_state *state, brunt_error *error) {
    const int32_t count = brunt_state_count(world);
    brunt_checkpoint *c = brunt_alloc(sizeof *c + sizeof *c->block * (size_t)count);
    bool fits = c != NULL;
    for (int32_t b = 0; b < count && fits; b++, c->count++) {
        taken_block *block = &c->block[b];
        block->info = brunt_state_info(world, b);
        const element_type *type = find_type(block->info.type);
        BRUNT_ASSERT(type);
        fits = (block->values = brunt_alloc(type->bytes * (size_t)block->info.count));
        if (fits) brunt_state_get(world, b, block->values);
    }
    if (!fits) {
        brunt_fail(error, BRUNT_FAILED, "out of memory for a checkpoint");
        brunt_checkpoint_release(c);
        return NULL;
    }
    c->run = *state;
    c->time = brunt_world_time(world), c->step = brunt_world_steps(world);
    c->particles = brunt_world_particles(world), c->elements = brunt_world_elements(world);
    return c;
}

void brunt_checkpoint_release(brunt_checkpoint *c) {
    for (int32_t b = 0; c && b < c->count; b++) brunt_free(c->block[b].values);
    brunt_free(c);
}

// ---------------------------------------------------------------------------------------------------- writing

// Each block is given back once HDF5 has it: in all there is little more than one copy of the state.
static int put_state(brunt_hdf5_maker *maker, brunt_checkpoint *c, const char *path, brunt_error *error) {
    for (int32_t b = 0; b < c->count; b++) {
        taken_block *block = &c->block[b];
        char name[DATASET_NAME];
        snprintf(name, sizeof name, "/state/%s", block->info.name);
        bool ok = brunt_hdf5_put(maker, name, file_type(block->info.type), memory_type(block->info.type),
                                 (hsize_t)block->info.count, block->values);
        brunt_free(block->values);
        block->values = NULL;
        if (!ok)
            return brunt_fail(error, BRUNT_FAILED, "%s: HDF5 could not store the block '%s'", path, block->info.name);
    }
    return BRUNT_OK;
}

static bool put_run_state(brunt_hdf5_maker *maker, const brunt_checkpoint *c, const char *scene_text) {
    const brunt_run_state *state = &c->run;
    const hid_t file = maker->file;
    return brunt_hdf5_put_text(file, "version", BRUNT_VERSION) &&
           brunt_hdf5_put_text(file, "precision", BRUNT_REAL_NAME) &&
           brunt_hdf5_put_integer(file, "lanes", BRUNT_LANES) &&
           brunt_hdf5_put_integer(file, "state_blocks", c->count) && brunt_hdf5_put_integer(file, "step", c->step) &&
           brunt_hdf5_put_integer(file, "particles", c->particles) &&
           brunt_hdf5_put_integer(file, "elements", c->elements) &&
           brunt_hdf5_put_integer(file, "history_lines", state->history_lines) &&
           brunt_hdf5_put_integer(file, "history_hash", (long long)state->history_hash) &&
           brunt_hdf5_put_integer(file, "mesh_hash", (long long)state->mesh_hash) &&
           brunt_hdf5_put_integer(file, "run", (long long)state->identity) &&
           brunt_hdf5_put_number(file, "time", c->time) &&
           brunt_hdf5_put_number(file, "wall_seconds", state->wall_seconds) &&
           brunt_hdf5_put_number(file, "cpu_seconds", state->cpu_seconds) &&
           brunt_hdf5_put_number(file, "step_seconds", state->step_seconds) &&
           brunt_hdf5_put_number(file, "output_seconds", state->output_seconds) &&
           brunt_hdf5_put_integer(file, "failed", state->failed) &&
           brunt_hdf5_put_integer(file, "withdrawn", state->withdrawn) &&
           brunt_hdf5_put_text(file, "reason", state->reason) &&
           brunt_hdf5_put(maker, "/picture_times", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, (hsize_t)state->picture_count,
                          state->picture_times) &&
           brunt_hdf5_put(maker, "/scene", H5T_STD_U8LE, H5T_NATIVE_UINT8, (hsize_t)strlen(scene_text), scene_text);
}

int brunt_checkpoint_put(brunt_checkpoint *c, const char *path, const char *backup, const char *scene_text,
                         brunt_error *error) {
    size_t expected = 65536 + strlen(scene_text) + sizeof(double) * (size_t)c->run.picture_count;
    for (int32_t b = 0; b < c->count; b++)
        expected += 4096 + (size_t)c->block[b].info.count * find_type(c->block[b].info.type)->bytes;
    hid_t file = brunt_hdf5_create(expected);
    if (file < 0) return brunt_fail(error, BRUNT_FAILED, "%s: HDF5 could not start the file", path);
    brunt_hdf5_maker maker;
    brunt_hdf5_maker_start(&maker, file);
    int status = put_state(&maker, c, path, error);
    if (!status && !put_run_state(&maker, c, scene_text))
        status = brunt_fail(error, BRUNT_FAILED, "%s: HDF5 could not put the file together", path);
    brunt_hdf5_maker_end(&maker);
    if (status) {
        H5Fclose(file);
        return status;
    }
    brunt_atomic_file out;
    status = brunt_hdf5_write(file, "checkpoint", FORMAT, path, &out, error);
    if (status) return status;
    // All of the new one is on the disk now: the old one may lose its name.
    status = brunt_keep_backup(path, backup, error);
    if (status) {
        brunt_atomic_abandon(&out);
        return status;
    }
    return brunt_atomic_rename(&out, error);
}

// ---------------------------------------------------------------------------------------------------- the scene

static void remove_key(struct fy_document *document, struct fy_node *map, const char *key) {
    // Looked up first: libfyaml frees the key it is given only when it finds it.
    if (fy_node_mapping_lookup_by_string(map, key, FY_NT))
        fy_node_free(fy_node_mapping_remove_by_key(map, fy_node_build_from_string(document, key, FY_NT)));
}

// A run may go on after its folder was moved: of a mesh file only its name counts, not the folders above it.
static void shorten_mesh(struct fy_document *document, struct fy_node *body) {
    struct fy_node *mesh = fy_node_is_mapping(body) ? fy_node_mapping_lookup_by_string(body, "mesh", FY_NT) : NULL;
    size_t length = 0;
    const char *text = mesh ? fy_node_get_scalar(mesh, &length) : NULL;
    if (!text) return;
    size_t start = length;
    while (start > 0 && text[start - 1] != '/') start--;
    struct fy_node *name = fy_node_create_scalar_copy(document, text + start, length - start);
    remove_key(document, body, "mesh");
    fy_node_mapping_append(body, fy_node_build_from_string(document, "mesh", FY_NT), name);
}

static void shorten_meshes(struct fy_document *document, struct fy_node *bodies) {
    if (!bodies || !fy_node_is_mapping(bodies)) return;
    void *at = NULL;
    for (struct fy_node_pair *pair; (pair = fy_node_mapping_iterate(bodies, &at));)
        shorten_mesh(document, fy_node_pair_value(pair));
}

static void remove_key_of(struct fy_document *document, struct fy_node *root, const char *section, const char *key) {
    struct fy_node *map = fy_node_mapping_lookup_by_string(root, section, FY_NT);
    if (map && fy_node_is_mapping(map)) remove_key(document, map, key);
}

// How implicit steps are solved, by which keys a step may be found that by others was not: what bodies are and what
// they store in a gap is not of it.
static void remove_solution(struct fy_document *document, struct fy_node *root) {
    size_t length = 0;
    struct fy_node *scheme = fy_node_by_path(root, "/time/scheme", FY_NT, FYNWF_DONT_FOLLOW);
    const char *text = scheme ? fy_node_get_scalar(scheme, &length) : NULL;
    if (!text || !strncmp(text, "explicit", length)) return;
    remove_key(document, root, "newton");
    if (strncmp(text, "implicit", length)) return;
    remove_key_of(document, root, "time", "step");
    remove_key_of(document, root, "contact", "slip_speed");
    remove_key_of(document, root, "contact", "friction_iterations");
}

// The scene less what may change between the legs of a run, as block YAML; NULL when it is not YAML. Freed with
// free().
static char *comparable(const char *text) {
    // Keys are not compared with each other: the text was written by this program, or has been read as a scene.
    struct fy_parse_cfg quiet = {.flags = FYPCF_QUIET | FYPCF_ALLOW_DUPLICATE_KEYS};
    struct fy_document *document = fy_document_build_from_string(&quiet, text, FY_NT);
    struct fy_node *root = document ? fy_document_root(document) : NULL;
    char *out = NULL;
    if (root && fy_node_is_mapping(root)) {
        static const char *const free_keys[] = {"output", "measures", "title"};
        for (size_t k = 0; k < sizeof free_keys / sizeof *free_keys; k++) remove_key(document, root, free_keys[k]);
        remove_key_of(document, root, "time", "end");
        remove_solution(document, root);
        shorten_meshes(document, fy_node_by_path(root, "/bodies", FY_NT, FYNWF_DONT_FOLLOW));
        out = fy_emit_document_to_string(document, FYECF_MODE_BLOCK | FYECF_WIDTH_INF);
    }
    fy_document_destroy(document);
    return out;
}

uint64_t brunt_checkpoint_identity(const char *scene_text, uint64_t mesh_hash) {
    char *text = comparable(scene_text);
    uint64_t hash = mesh_hash;
    for (const char *c = text ? text : scene_text; *c; c++) hash = brunt_hash_add(hash, (uint64_t)(unsigned char)*c);
    free(text);
    return hash;
}

// First line of `a` and of `b` that differ, trimmed.
static void first_difference(const char *a, const char *b, char line_a[160], char line_b[160]) {
    size_t start = 0, i = 0;
    for (; a[i] && a[i] == b[i]; i++)
        if (a[i] == '\n') start = i + 1;
    const char *const texts[] = {a + start, b + start};
    char *const lines[] = {line_a, line_b};
    for (int t = 0; t < 2; t++) {
        const char *from = texts[t] + strspn(texts[t], " ");
        size_t length = strcspn(from, "\n");
        snprintf(lines[t], 160, "%.*s", (int)(length < 150 ? length : 150), length ? from : "(nothing)");
    }
}

static int compare_scenes(const char *path, const char *stored, const char *wanted, brunt_error *error) {
    char *a = comparable(stored), *b = comparable(wanted);
    int status = BRUNT_OK;
    const char *was = a ? a : stored, *is = b ? b : wanted;
    if (strcmp(was, is)) {
        char line_a[160], line_b[160];
        first_difference(was, is, line_a, line_b);
        status =
            brunt_fail(error, BRUNT_BAD_INPUT,
                       "%s: made from another scene: '%s' in the checkpoint, '%s' in the scene (only time.end, output, "
                       "measures and title may change; of implicit steps also newton, time.step, contact.slip_speed "
                       "and contact.friction_iterations)",
                       path, line_a, line_b);
    }
    free(a);
    free(b);
    return status;
}

// ---------------------------------------------------------------------------------------------------- reading

// A whole dataset into new memory, with a zero after it. NULL when it is not there or of another type.
static void *read_dataset(hid_t file, const char *name, char letter, int64_t *count) {
    const element_type *wanted = find_type(letter);
    hid_t set = brunt_hdf5_dataset(file, name, wanted->class, wanted->bytes, count);
    if (set < 0) return NULL;
    void *values = brunt_alloc(wanted->bytes * ((size_t)*count + 1)); // no more than the file is large
    if (values && !brunt_hdf5_read(set, memory_type(letter), 0, *count, values)) {
        brunt_free(values);
        values = NULL;
    }
    H5Dclose(set);
    return values;
}

// What no run has written: counts and times below zero or not finite, pictures that go back in time.
static bool is_sound(const brunt_run_state *s) {
    const double numbers[] = {s->time, s->wall_seconds, s->step_seconds, s->output_seconds, s->cpu_seconds};
    bool sound = s->step >= 0 && s->history_lines >= 0;
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++) sound &= isfinite(numbers[n]) && numbers[n] >= 0;
    for (int64_t p = 0; p < s->picture_count; p++) sound &= s->picture_times[p] >= (p ? s->picture_times[p - 1] : 0);
    return sound;
}

static int read_run_state(hid_t file, const char *path, brunt_run_state *state, brunt_error *error) {
    long long step = 0, failed = 0, withdrawn = 0, mesh_hash = 0, lines = 0, hash = 0;
    memset(state, 0, sizeof *state);
    bool ok = brunt_hdf5_get_integer(file, "step", &step) && brunt_hdf5_get_integer(file, "failed", &failed) &&
              brunt_hdf5_get_integer(file, "history_lines", &lines) &&
              brunt_hdf5_get_integer(file, "history_hash", &hash) &&
              brunt_hdf5_get_number(file, "time", &state->time) &&
              brunt_hdf5_get_number(file, "wall_seconds", &state->wall_seconds) &&
              brunt_hdf5_get_number(file, "cpu_seconds", &state->cpu_seconds) &&
              brunt_hdf5_get_number(file, "step_seconds", &state->step_seconds) &&
              brunt_hdf5_get_number(file, "output_seconds", &state->output_seconds) &&
              brunt_hdf5_get_text(file, "reason", state->reason, sizeof state->reason);
    if (ok) state->picture_times = read_dataset(file, "/picture_times", 'd', &state->picture_count);
    if (!ok || !state->picture_times)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: the state of the run's outputs is missing", path);
    if (brunt_hdf5_get_integer(file, "mesh_hash", &mesh_hash)) state->mesh_hash = (uint64_t)mesh_hash;
    state->history_lines = lines;
    state->history_hash = (uint64_t)hash;
    state->step = step;
    state->failed = failed != 0;
    state->withdrawn = brunt_hdf5_get_integer(file, "withdrawn", &withdrawn) && withdrawn;
    return is_sound(state) ? BRUNT_OK
                           : brunt_fail(error, BRUNT_BAD_INPUT,
                                        "%s: the state of the run's outputs holds numbers that no run has", path);
}

static int check_header(hid_t file, const char *path, brunt_error *error) {
    char version[64], precision[16];
    long long width = 0;
    if (!brunt_hdf5_get_text(file, "version", version, sizeof version) ||
        !brunt_hdf5_get_text(file, "precision", precision, sizeof precision) ||
        !brunt_hdf5_get_integer(file, "lanes", &width))
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: version, precision and vector width are missing", path);
    if (strcmp(version, BRUNT_VERSION))
        return brunt_fail(error, BRUNT_BAD_INPUT,
                          "%s: written by brunt %s, this is brunt %s; the same version is wanted", path, version,
                          BRUNT_VERSION);
    if (width != BRUNT_LANES || strcmp(precision, BRUNT_REAL_NAME))
        return brunt_fail(
            error, BRUNT_BAD_INPUT,
            "%s: written by a build with %lld lane%s in %s; this one has %d in %s, which would give other bits", path,
            width, width == 1 ? "" : "s", precision, BRUNT_LANES, BRUNT_REAL_NAME);
    return BRUNT_OK;
}

static int restore_state(hid_t file, const char *path, brunt_world *world, brunt_error *error) {
    long long stored = -1;
    int32_t count = brunt_state_count(world);
    if (!brunt_hdf5_get_integer(file, "state_blocks", &stored) || stored != count)
        return brunt_fail(error, BRUNT_BAD_INPUT, "%s: holds %lld state blocks, this scene has %d", path, stored,
                          (int)count);
    for (int32_t b = 0; b < count; b++) {
        brunt_state_block block = brunt_state_info(world, b);
        char name[DATASET_NAME];
        snprintf(name, sizeof name, "/state/%s", block.name);
        int64_t found = 0;
        void *values = read_dataset(file, name, block.type, &found);
        if (!values)
            return brunt_fail(error, BRUNT_BAD_INPUT,
                              "%s: the state block '%s' is missing, of another type than %s, or cannot be read", path,
                              block.name, find_type(block.type)->name);
        // Whether that many are right is for the world to say: of what erodes there may be fewer.
        brunt_error refused;
        int status = brunt_state_set(world, b, values, found, &refused);
        brunt_free(values);
        if (status) return brunt_fail(error, status, "%s: %.900s", path, refused.message);
    }
    return brunt_state_done(world, error);
}

int brunt_checkpoint_read(const char *path, brunt_world *world, const char *scene_text, brunt_run_state *state,
                          brunt_error *error) {
    memset(state, 0, sizeof *state);
    hid_t file;
    int status = brunt_hdf5_open(path, "checkpoint", FORMAT, &file, error);
    if (status) return status;
    status = check_header(file, path, error);
    if (!status) status = read_run_state(file, path, state, error);
    if (!status && state->failed && !state->withdrawn)
        status = brunt_fail(error, BRUNT_BAD_INPUT,
                            "%s: written where the computation failed (%.600s); it can be looked at, not resumed: "
                            "put the checkpoint before it in its place",
                            path, state->reason);
    char *stored = NULL;
    int64_t length;
    if (!status) {
        stored = read_dataset(file, "/scene", 'b', &length);
        status = stored ? compare_scenes(path, stored, scene_text, error)
                        : brunt_fail(error, BRUNT_BAD_INPUT, "%s: holds no scene", path);
    }
    brunt_free(stored);
    if (!status) status = restore_state(file, path, world, error);
    H5Fclose(file);
    if (status) brunt_run_state_free(state);
    return status;
}

bool brunt_checkpoint_failed(const char *path) {
    hid_t file;
    long long failed = 0;
    if (brunt_hdf5_open(path, "checkpoint", FORMAT, &file, NULL)) return false;
    bool known = brunt_hdf5_get_integer(file, "failed", &failed);
    H5Fclose(file);
    return known && failed;
}

// ---------------------------------------------------------------------------------------------------- describing

typedef struct description {
    FILE *out;
    hid_t file; // how large it is, a group does not say
} description;

static herr_t describe_block(hid_t root, const char *name, const H5O_info_t *info, void *context) {
    const description *d = context;
    (void)root;
    if (info->type != H5O_TYPE_DATASET) return 0;
    char shown[DATASET_NAME + 1], path[DATASET_NAME + 2];
    snprintf(shown, sizeof shown, "%s", name);
    snprintf(path, sizeof path, "/%s", shown);
    brunt_hdf5_printable(shown);
    for (size_t t = 0; t < sizeof element_types / sizeof *element_types; t++) {
        int64_t count;
        hid_t set = brunt_hdf5_dataset(d->file, path, element_types[t].class, element_types[t].bytes, &count);
        if (set < 0) continue;
        H5Dclose(set);
        fprintf(d->out, "%-56s %12lld x %-6s %12lld bytes\n", shown, (long long)count, element_types[t].name,
                (long long)count * (long long)element_types[t].bytes);
        return 0;
    }
    fprintf(d->out, "%-56s no data that brunt reads\n", shown);
    return 0;
}

int brunt_checkpoint_describe(const char *path, FILE *out, brunt_error *error) {
    hid_t file;
    int status = brunt_hdf5_open(path, "checkpoint", FORMAT, &file, error);
    if (status) return status;
    char version[64], precision[16];
    long long particles = 0, elements = 0;
    brunt_run_state state;
    status = read_run_state(file, path, &state, error);
    if (!status && brunt_hdf5_get_text(file, "version", version, sizeof version) &&
        brunt_hdf5_get_text(file, "precision", precision, sizeof precision) &&
        brunt_hdf5_get_integer(file, "particles", &particles)) {
        if (!brunt_hdf5_get_integer(file, "elements", &elements)) elements = 0;
        fprintf(out, "checkpoint written by brunt %s in %s precision\n", version, precision);
        fprintf(out,
                "time       %.17g s\nstep       %lld\nparticles  %lld\nelements   %lld\npictures   %lld\nwall time  "
                "%.1f s so "
                "far\n",
                state.time, (long long)state.step, particles, elements, (long long)state.picture_count,
                state.wall_seconds);
        if (state.failed) fprintf(out, "FAILED     %s\n", state.reason);
        if (state.withdrawn) fprintf(out, "           the step has changed nothing: --resume goes on from here\n");
        description d = {out, file};
        if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, describe_block, &d, H5O_INFO_BASIC) < 0)
            status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: HDF5 cannot read the file", path);
    }
    brunt_run_state_free(&state);
    H5Fclose(file);
    return status;
}
