// Through the public interface nothing that is wrong crashes, prints or stops the process: it comes back as
// BRUNT_BAD_INPUT with a message that names it. And what is set of a state, in part or in any order, stays what
// brunt_state_info says.
#include <fcntl.h>
#include <unistd.h>

#include "tests/support/hard_world.h"
#include "tests/support/suite.h"

// ------------------------------------------------------------------------------------------ definitions

enum { OFF_END = 0x41 };

// As they were made: what a test spoils is put back before it is freed.
static brunt_world_def made;
static brunt_body_def made_bodies[DEF_CAPACITY];
static brunt_group_def made_groups[2];

static void release(void) {
    memcpy(made.bodies, made_bodies, sizeof made_bodies);
    memcpy(made.groups, made_groups, sizeof made_groups);
    brunt_world_def_free(&made);
}

// One of everything: particles and a mesh that touch, a membrane under gas, planes, a region, groups, a pair.
static brunt_world_def everything(void) {
    brunt_world_def def = def_begin(3, 0.25);
    def.regions = brunt_def_alloc(2 * sizeof *def.regions);
    def.groups = brunt_def_alloc(3 * sizeof *def.groups);
    def.detonations = brunt_def_alloc(sizeof *def.detonations);
    def.contact.pairs = brunt_def_alloc(2 * sizeof *def.contact.pairs);
    def.contact.method = BRUNT_CONTACT_AUGURY;
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "points", XYZ(0, 0, 0), XYZ(0.5, 0.5, 0.5));
    brunt_body_def *mesh = def_box(&def, "mesh", XYZ(0, 0, 1), XYZ(0.5, 0.5, 1.5));
    mesh->method = BRUNT_FEM, mesh->element = BRUNT_HEX8, mesh->size = 0.25;
    brunt_body_def *bag = def_box(&def, "bag", XYZ(2, 0, 0), XYZ(2.5, 0.5, 0.5));
    bag->method = BRUNT_MEMBRANE, bag->element = BRUNT_MEMBRANE_QUAD4, bag->size = 0.25, bag->thickness = 0.01;
    brunt_body_def *given = def_body(&def, "given");
    brunt_error error = {0};
    brunt_shape box = {.kind = BRUNT_BOX, .min = {0, 0, 3}, .max = {0.5, 0.5, 3.5}};
    given->method = BRUNT_FEM;
    ck_assert_int_eq(brunt_mesh_shape(&box, 3, BRUNT_TET4, 0.25, &given->mesh, &error), BRUNT_OK);
    def_plane(&def, XYZ(0, 0, -1), XYZ(0, 0, 1), BRUNT_SEPARATE, 0.1);
    brunt_region_def *region = &def.regions[def.region_count++];
    *region = brunt_region_def_default();
    region->shape = (brunt_shape){.kind = BRUNT_SPHERE, .radius = 0.1};
    for (int g = 0; g < 2; g++) {
        brunt_group_def *group = &def.groups[def.group_count++];
        *group = brunt_group_def_default();
        strcpy(group->body, g ? "bag" : "mesh"), strcpy(group->group, g ? "surface" : "zmax");
        if (g) group->action = BRUNT_GROUP_GAS, group->gas.pressure = 1e5, group->gas.outside = 1e5;
    }
    brunt_pair_def *pair = &def.contact.pairs[def.contact.pair_count++];
    strcpy(pair->a, "points"), strcpy(pair->b, "mesh");
    pair->method = BRUNT_CONTACT_AUGURY, pair->friction = 0.2;
    made = def;
    memcpy(made_bodies, def.bodies, sizeof made_bodies);
    memcpy(made_groups, def.groups, sizeof made_groups);
    return def;
}

// Nothing may be written by the library: its two outputs go to a file while it is called.
static int outputs[2], aside = -1;
static void listen(void) {
    char name[] = "/tmp/brunt_api_XXXXXX";
    aside = mkstemp(name);
    unlink(name);
    fflush(stdout), fflush(stderr);
    for (int o = 0; o < 2; o++) outputs[o] = dup(o + 1), dup2(aside, o + 1);
}
static void heard_nothing(void) {
    fflush(stdout), fflush(stderr);
    const off_t said = lseek(aside, 0, SEEK_END);
    for (int o = 0; o < 2; o++) dup2(outputs[o], o + 1), close(outputs[o]);
    close(aside);
    ck_assert_msg(said == 0, "the library printed %lld bytes", (long long)said);
}

static void expect_refused(const brunt_world_def *def, const char *message) {
    brunt_error error = {0};
    listen();
    brunt_world *world = brunt_world_create(def, &error), *again = brunt_world_create(def, NULL);
    heard_nothing();
    ck_assert_msg(!world && !again, "a world was made where '%s' is wanted", message);
    ck_assert_msg(error.code == BRUNT_BAD_INPUT && strstr(error.message, message), "%d: '%s' where '%s' is wanted",
                  error.code, error.message, message);
}

#define REFUSED(change, message)                                                                                       \
    do {                                                                                                               \
        brunt_world_def def = everything();                                                                            \
        brunt_body_def *points = &def.bodies[0], *mesh = &def.bodies[1], *bag = &def.bodies[2],                        \
                       *given = &def.bodies[3];                                                                        \
        brunt_group_def *held = &def.groups[0], *gas = &def.groups[1];                                                 \
        (void)points, (void)mesh, (void)bag, (void)given, (void)held, (void)gas;                                       \
        change;                                                                                                        \
        expect_refused(&def, message);                                                                                 \
        release();                                                                                                     \
    } while (0)

START_TEST(one_of_everything_is_good) {
    brunt_world_def def = everything();
    brunt_world *world = world_from(&def);
    world_steps(world, 3);
    brunt_world_destroy(world);
    release();
}
END_TEST

START_TEST(nothing_at_all) {
    brunt_error error = {0};
    listen();
    ck_assert_ptr_null(brunt_world_create(NULL, &error));
    ck_assert_int_eq(error.code, BRUNT_BAD_INPUT);
    ck_assert_ptr_null(brunt_world_create(NULL, NULL));
    const brunt_world_def zero = {0};
    ck_assert_ptr_null(brunt_world_create(&zero, &error));
    brunt_world_destroy(NULL);
    ck_assert_int_eq(brunt_world_step(NULL, INFINITY, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_world_step(NULL, INFINITY, NULL), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_state_count(NULL), 0);
    ck_assert_int_eq(brunt_state_set(NULL, 0, NULL, 0, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_state_done(NULL, &error), BRUNT_BAD_INPUT);
    brunt_material_def material = brunt_material_def_default(NULL, NULL);
    ck_assert_int_eq(brunt_material_set(&material, NULL, 1, NULL, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_material_set(NULL, "density", 1, NULL, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_material_set(&material, "eos", 1, NULL, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_material_set(&material, "failure", 1, NULL, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_material_set(&material, "", 1, NULL, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_material_preset(NULL, "a", &material, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_material_preset("steel-4340", NULL, &material, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_material_preset("steel-4340", "a", NULL, &error), BRUNT_BAD_INPUT);
    memset(material.strength, OFF_END, sizeof material.strength);
    ck_assert_int_eq(brunt_material_set(&material, "E", 1, NULL, &error), BRUNT_BAD_INPUT);
    heard_nothing();
}
END_TEST

START_TEST(counts_and_arrays) {
    REFUSED(def.body_count = -1, "bodies: there are -1");
    REFUSED(def.material_count = -5, "materials: there are -5");
    REFUSED(def.plane_count = INT32_MIN, "boundaries: planes: there are");
    REFUSED(def.region_count = -1, "boundaries: regions: there are -1");
    REFUSED(def.group_count = -1, "boundaries: groups: there are -1");
    REFUSED(def.detonation_count = -1, "detonations: there are -1");
    REFUSED(def.contact.pair_count = -1, "contact.pairs: there are -1");
    REFUSED(def.bodies = NULL, "no array of them");
    REFUSED(def.materials = NULL, "no array of them");
    REFUSED(def.planes = NULL, "no array of them");
    REFUSED(def.contact.pairs = NULL, "no array of them");
    REFUSED(points->material = -1, "there is no material -1");
    REFUSED(points->material = 1, "there is no material 1");
    REFUSED(bag->face_count = 1, "no array of them");
    REFUSED(bag->face_count = -1, "there are -1");
    REFUSED(held->table.count = 2, "no array of them");
    REFUSED(mesh->grading[1].count = 3, "no array of them");
    REFUSED(points->particles_per_cell = -8, "particles_per_cell: -8");
    REFUSED(def.threads = -1, "threads: -1");
    REFUSED(def.contact.iterations = -2, "contact.iterations: -2");
    REFUSED(def.dimension = 4, "dimension: 4");
}
END_TEST

START_TEST(enumerators) {
    REFUSED(def.kernel = (brunt_kernel)4, "grid.kernel");
    REFUSED(def.kernel = (brunt_kernel)0, "grid.kernel");
    REFUSED(def.transfer = (brunt_transfer)3, "grid.transfer");
    REFUSED(def.apic = -0.01, "grid.transfer.apic: -0.01 is not between 0 and 0.98");
    REFUSED(def.apic = 0.981, "grid.transfer.apic: 0.981 is not between 0 and 0.98");
    REFUSED((def.apic = 0.5, def.kernel = BRUNT_LINEAR), "grid.transfer.apic: with kernel linear");
    REFUSED((def.apic = 0.5, def.cfl = 0.91), "time.cfl: 0.91");
    REFUSED(def.contact.method = (brunt_contact_method)6, "contact.method: there is no choice 6");
    REFUSED(def.scheme = (brunt_scheme)3, "time.scheme: there is no choice 3");
    REFUSED(def.contact.method = (brunt_contact_method)-1, "contact.method: there is no choice -1");
    REFUSED(def.contact.form = (brunt_augury_form)4, "contact.form: there is no choice 4");
    REFUSED(def.contact.transfer = (brunt_transfer)77, "contact.transfer: there is no choice 77");
    REFUSED(def.contact.pairs[0].method = (brunt_contact_method)9, "contact.pairs[0].method: there is no choice 9");
    REFUSED(points->method = (brunt_method)3, "bodies.points.method: there is no choice 3");
    REFUSED(points->fill = (brunt_fill)3, "bodies.points.fill: there is no choice 3");
    REFUSED(points->shape.kind = (brunt_shape_kind)9, "bodies.points.shape: there is no choice 9");
    REFUSED(mesh->element = (brunt_element_kind)6, "bodies.mesh.element: there is no choice 6");
    REFUSED(mesh->hourglass = (brunt_hourglass)2, "bodies.mesh.hourglass: there is no choice 2");
    REFUSED(mesh->element = BRUNT_QUAD4, "of 2 dimensions");
    REFUSED(mesh->element = BRUNT_MEMBRANE_QUAD4, "are membranes");
    REFUSED(bag->element = BRUNT_HEX8, "are not membranes");
    REFUSED(given->mesh.kind = (brunt_element_kind)99, "bodies.given.mesh: kind: there is no choice 99");
    REFUSED(def.materials[0].failure_action = (brunt_failure_action)2, "failure.action: there is no choice 2");
    REFUSED(def.planes[0].condition = (brunt_condition)4, "condition: there is no choice 4");
    REFUSED(held->action = (brunt_group_action)6, "action: there is no choice 6");
    ck_assert_str_eq(brunt_element_name((brunt_element_kind)6), "unknown");
    ck_assert_int_eq(brunt_element_nodes((brunt_element_kind)-1) + brunt_element_dimension((brunt_element_kind)6), 0);
    ck_assert(!brunt_element_is_membrane((brunt_element_kind)100));
    brunt_mesh mesh;
    brunt_error error = {0};
    brunt_shape box = {.kind = BRUNT_BOX, .max = {1, 1, 1}}, none = {.kind = (brunt_shape_kind)20};
    ck_assert_int_eq(brunt_mesh_shape(&box, 3, (brunt_element_kind)6, 0.5, &mesh, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_mesh_surface(&box, (brunt_element_kind)6, 0.5, NULL, 0, &mesh, &error), BRUNT_BAD_INPUT);
    ck_assert_int_eq(brunt_mesh_shape(&none, 3, BRUNT_HEX8, 0.5, &mesh, &error), BRUNT_BAD_INPUT);
}
END_TEST

START_TEST(names_without_end) {
#define NAME(field, message) REFUSED(memset(field, OFF_END, sizeof field), message)
    NAME(points->name, "bodies[0]: a name of more than 47 bytes");
    NAME(def.materials[0].name, "materials[0]: a name");
    NAME(def.materials[0].strength, "materials[0]: a name");
    NAME(def.materials[0].eos, "materials[0]: a name");
    NAME(def.materials[0].failure, "materials[0]: a name");
    NAME(def.planes[0].name, "boundaries[0]: a name");
    NAME(def.planes[0].body, "boundaries[0]: a name");
    NAME(def.regions[0].name, "boundaries[1]: a name");
    NAME(def.regions[0].body, "boundaries[1]: a name");
    NAME(held->name, "boundaries[2]: a name");
    NAME(held->body, "boundaries[2]: a name");
    NAME(gas->group, "boundaries[3]: a name");
    NAME(def.contact.pairs[0].a, "contact.pairs[0]: a name");
    NAME(def.contact.pairs[0].b, "contact.pairs[0]: a name");
    NAME(given->mesh.groups[0].name, "groups[0]: a name");
    REFUSED(points->name[0] = 0, "has no name");
    REFUSED(strcpy(points->name, "mesh"), "two bodies have this name");
    REFUSED(strcpy(held->name, "group4"), "have the same name 'group4'");
    REFUSED((strcpy(points->name, "a-b"), strcpy(mesh->name, "c"), strcpy(bag->name, "a"), strcpy(given->name, "b-c")),
            "contact: the pair of");
}
END_TEST

START_TEST(numbers) {
    static const double none[] = {NAN, INFINITY, -INFINITY, 1e155, -1e300, 1.1 * BRUNT_GREATEST_NUMBER};
    for (int n = 0; n < 6; n++) {
        const double v = none[n];
        REFUSED(def.cell = v, "grid.cell");
        REFUSED(def.origin[2] = v, "grid.origin");
        REFUSED(def.flip = v, "grid.transfer.flip");
        REFUSED(def.apic = v, "grid.transfer.apic");
        REFUSED(def.cfl = v, "time.cfl");
        REFUSED(def.step = v, "time.step");
        REFUSED(def.least_step = v, "time.least_step");
        REFUSED(def.end = v, "time.end");
        REFUSED(def.gravity[0] = v, "loads.gravity");
        REFUSED(def.gravity_ramp = v, "loads.gravity_ramp");
        REFUSED(def.contact.friction = v, "contact.friction");
        REFUSED(def.contact.tolerance = v, "contact.tolerance");
        REFUSED(def.contact.cell = v, "contact.cell");
        REFUSED(def.contact.pairs[0].friction = v, "contact.pairs[0].friction");
        REFUSED(def.materials[0].density = v, "density");
        REFUSED(def.materials[0].strength_parameters[0] = v, "materials.material1.E");
        REFUSED(points->shape.min[0] = v, "bodies.points.shape");
        REFUSED(points->place.translation[1] = v, "bodies.points.place");
        REFUSED(points->place.rotation[4] = v, "bodies.points.place");
        REFUSED(points->velocity[2] = v, "bodies.points.velocity");
        REFUSED(points->spin[0] = v, "bodies.points.spin");
        REFUSED(points->spin_about[0] = v, "bodies.points.spin_about");
        REFUSED(points->wave_velocity[0] = v, "bodies.points.wave_velocity");
        REFUSED(points->wave_vector[0] = v, "bodies.points.wave_vector");
        REFUSED(points->wave_phase = v, "bodies.points.wave_phase");
        REFUSED(points->temperature = v, "bodies.points.temperature");
        REFUSED(points->spacing = v, "bodies.points.spacing");
        REFUSED(points->jitter = v, "bodies.points.jitter");
        REFUSED(mesh->size = v, "bodies.mesh.size");
        REFUSED(mesh->mass_scaling = v, "bodies.mesh.mass_scaling");
        REFUSED(mesh->damping = v, "bodies.mesh.damping");
        REFUSED(mesh->erosion.step = v, "bodies.mesh.erosion.step");
        REFUSED(bag->thickness = v, "bodies.bag.thickness");
        REFUSED(given->mesh.nodes[5][1] = v, "node 6 ");
        REFUSED(def.planes[0].point[0] = v, "boundaries[0].plane.point");
        REFUSED(def.planes[0].normal[0] = v, "boundaries[0].plane.normal");
        REFUSED(def.planes[0].friction = v, "boundaries[0].plane.friction");
        REFUSED(def.planes[0].velocity[1] = v, "boundaries[0].plane.velocity");
        REFUSED(def.regions[0].velocity[0] = v, "boundaries[1].region.velocity");
        REFUSED(def.regions[0].shape.radius = v, "boundaries[1].region.shape");
        REFUSED(held->value[0] = v, "boundaries[2].group.value");
        REFUSED(gas->gas.gamma = v, "boundaries[3].group.gas.gamma");
        REFUSED(gas->gas.pressure = v, "boundaries[3].group.gas.pressure");
        REFUSED(gas->gas.outside = v, "boundaries[3].group.gas.outside");
        REFUSED(gas->gas.volume = v, "boundaries[3].group.gas.volume");
        REFUSED(gas->gas.inflow = v, "boundaries[3].group.gas.inflow");
        if (isinf(v) || isnan(v)) continue;
        REFUSED(mesh->erosion.strain = v, "bodies.mesh.erosion.strain");
        REFUSED(mesh->hourglass_coefficient = v, "bodies.mesh.hourglass_coefficient");
        REFUSED(bag->contact_thickness = v, "bodies.bag.contact_thickness");
        REFUSED(def.regions[0].start = v, "boundaries[1].region.start");
    }
    REFUSED(def.end = BRUNT_LEAST_NUMBER / 10, "time.end");
    REFUSED(points->velocity[0] = BRUNT_LEAST_NORMAL / 1e4, "bodies.points.velocity");
    REFUSED(points->place.rotation[0] = 0, "this is no rotation");
    REFUSED(points->place = brunt_placement_rotate(points->place, XYZ(0, 0, 0), 1, XYZ(0, 0, 0)),
            "bodies.points.place");
}
END_TEST

START_TEST(meshes) {
    REFUSED(given->mesh.elements[3] = -1, "element 1 is given with node numbers that the mesh does not have");
    REFUSED(given->mesh.elements[4] = given->mesh.node_count, "element 2 is given with node numbers");
    REFUSED(given->mesh.elements[1] = given->mesh.elements[0], "element 1 is flat");
    REFUSED(memcpy(given->mesh.elements + 4, given->mesh.elements, 4 * sizeof(int32_t)), "twice");
    REFUSED(given->mesh.node_count = -1, "bodies.given.mesh: nodes: there are -1");
    REFUSED(given->mesh.element_count = -1, "bodies.given.mesh: elements: there are -1");
    REFUSED(given->mesh.element_count = 0, "at least one element is wanted");
    REFUSED(given->mesh.nodes = NULL, "no array of them");
    REFUSED(given->mesh.elements = NULL, "no array of them");
    REFUSED(given->mesh.groups = NULL, "no array of them");
    REFUSED(given->mesh.groups[0].count = -3, "there are -3");
    REFUSED(given->mesh.groups[0].nodes[0] = -1, "group 'xmin' has node -1");
    REFUSED(given->mesh.groups[0].nodes[1] = given->mesh.node_count, "group 'xmin' has node");
    REFUSED(given->mesh.groups[0].nodes[1] = given->mesh.groups[0].nodes[0], "nodes must ascend, each once");
    REFUSED(given->mesh.kind = BRUNT_TRI3, "bodies.given");
    REFUSED(given->mesh.kind = BRUNT_MEMBRANE_QUAD4, "bodies.given");
}
END_TEST

START_TEST(shapes) {
    REFUSED(points->shape.kind = BRUNT_UNION, "of nothing");
    REFUSED((points->shape.kind = BRUNT_DIFFERENCE, points->shape.child_count = 2), "no array of them");
    REFUSED((points->shape.kind = BRUNT_INTERSECTION, points->shape.child_count = -2), "there are -2");
    REFUSED(points->shape.kind = BRUNT_HALF_SPACE, "no direction");
    REFUSED(points->shape.kind = BRUNT_SPHERE, "radius: 0 is not above 0");
    REFUSED(points->shape.kind = BRUNT_PRISM, "a polygon of 0 corners");
    REFUSED((points->shape.kind = BRUNT_PRISM, points->shape.point_count = 3), "no array of them");
    REFUSED((points->shape.kind = BRUNT_CYLINDER, points->shape.radius = points->shape.length = 1), "no direction");
    brunt_shape loop = {.kind = BRUNT_UNION, .child_count = 1};
    loop.children = &loop; // without an end
    REFUSED((points->shape = loop), "deep");
}
END_TEST

// ------------------------------------------------------------------------------------------ state

static int32_t block_of(brunt_world *world, const char *name) {
    for (int32_t b = 0; b < brunt_state_count(world); b++)
        if (!strcmp(brunt_state_info(world, b).name, name)) return b;
    ck_abort_msg("there is no block %s", name);
    return -1;
}

// Every block as it is said to be: what lies behind it must be left alone.
static void check_sizes(brunt_world *world) {
    for (int32_t b = 0; b < brunt_state_count(world); b++) {
        const brunt_state_block block = brunt_state_info(world, b);
        const size_t bytes = (size_t)block.count * (block.type == 'f' ? 4 : block.type == 'b' ? 1 : 8);
        unsigned char *data = malloc(bytes + 64); // to the byte under the sanitizer, and by the mark without
        memset(data + bytes, 0x5A, 64);
        brunt_state_get(world, b, data);
        for (int k = 0; k < 64; k++)
            ck_assert_msg(data[bytes + (size_t)k] == 0x5A, "%s goes past its %lld elements", block.name,
                          (long long)block.count);
        free(data);
    }
}

static brunt_world *eroding_world(void) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    brunt_body_def *a = def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.53, 0.5, 0));
    a->erosion.strain = 10; // it may lose some
    brunt_body_def *b = def_box(&def, "b", XYZ(2, 0, 0), XYZ(2.3, 0.3, 0));
    b->method = BRUNT_FEM, b->element = BRUNT_QUAD4, b->size = 0.1, b->erosion.strain = 10;
    def_velocity(a, 0.3, 0.1, 0);
    brunt_world *world = world_take(&def);
    world_steps(world, 20); // sorted: its particles lie with gaps
    return world;
}

// In the middle of a restore, and after a part of one.
START_TEST(sizes_hold_between_sets) {
    brunt_world *world = eroding_world();
    brunt_error error = {0};
    check_sizes(world);
    const int32_t ids = block_of(world, "bodies/a/id"), place = block_of(world, "bodies/a/position");
    const int64_t all = brunt_state_info(world, ids).count, kept = all - 5;
    int64_t *id = malloc((size_t)all * sizeof *id);
    real *x = malloc((size_t)all * 2 * sizeof *x), *y = malloc((size_t)all * 2 * sizeof *y);
    brunt_state_get(world, ids, id);
    brunt_state_get(world, place, x);
    ck_assert_int_eq(brunt_state_set(world, ids, id, kept, &error), BRUNT_OK);
    ck_assert_int_eq(brunt_state_info(world, place).count, 2 * kept);
    check_sizes(world);
    brunt_state_get(world, place, y); // those that are left are where they were
    for (int64_t i = 0; i < kept; i++) ck_assert(y[i] == x[i] && y[kept + i] == x[all + i]);
    ck_assert_int_eq(brunt_state_done(world, &error), BRUNT_OK);
    check_sizes(world);
    ck_assert_int_eq(brunt_body_particles(world, 0), kept);
    world_steps(world, 5);
    check_sizes(world);
    // More again than there are: the new ones have nothing yet.
    ck_assert_int_eq(brunt_state_set(world, ids, id, all, &error), BRUNT_OK);
    check_sizes(world);
    ck_assert_int_eq(brunt_state_set(world, place, x, 2 * all, &error), BRUNT_OK);
    brunt_state_get(world, place, y);
    ck_assert_int_eq(memcmp(x, y, (size_t)all * 2 * sizeof *x), 0);
    free(id), free(x), free(y);
    brunt_world_destroy(world);
}
END_TEST

// A field alone is set where its particles lie, whether they lie with gaps or not, and the rest stays.
START_TEST(a_field_alone_is_set) {
    brunt_world *world = eroding_world();
    brunt_error error = {0};
    const int32_t place = block_of(world, "bodies/a/position"), speed = block_of(world, "bodies/a/velocity");
    const int64_t count = brunt_state_info(world, place).count;
    real *x = malloc((size_t)count * sizeof *x), *y = malloc((size_t)count * sizeof *y),
         *v = malloc((size_t)count * sizeof *v);
    brunt_state_get(world, speed, v);
    brunt_state_get(world, place, x);
    for (int64_t i = 0; i < count; i++) x[i] += (real)0.125;
    ck_assert_int_eq(brunt_state_set(world, place, x, count, &error), BRUNT_OK);
    for (int done = 0; done < 2; done++) {
        check_sizes(world);
        brunt_state_get(world, place, y);
        ck_assert_int_eq(memcmp(x, y, (size_t)count * sizeof *x), 0);
        brunt_state_get(world, speed, y);
        ck_assert_int_eq(memcmp(v, y, (size_t)count * sizeof *v), 0);
        if (!done) ck_assert_int_eq(brunt_state_done(world, &error), BRUNT_OK);
        if (!done) brunt_state_get(world, place, x), brunt_state_get(world, speed, v); // sorted by place
    }
    world_steps(world, 3);
    free(x), free(y), free(v);
    brunt_world_destroy(world);
}
END_TEST

START_TEST(bad_sets_change_nothing) {
    brunt_world *world = eroding_world();
    brunt_error error = {0};
    const uint64_t hash = brunt_world_hash(world);
    const int32_t ids = block_of(world, "bodies/a/id"), place = block_of(world, "bodies/a/position"),
                  count = brunt_state_count(world);
    const int64_t all = brunt_state_info(world, ids).count;
    int64_t *id = malloc((size_t)(all + 1) * sizeof *id);
    brunt_state_get(world, ids, id);
    listen();
    const int64_t keep = id[7];
    static const int64_t wrong[] = {-1, INT64_MIN, INT64_MAX, 1000000};
    int bad = 0;
    for (int k = 0; k < 4; k++) {
        id[7] = wrong[k];
        bad += brunt_state_set(world, ids, id, all, &error) == BRUNT_BAD_INPUT;
    }
    id[7] = id[6];
    bad += brunt_state_set(world, ids, id, all, &error) == BRUNT_BAD_INPUT;
    id[7] = keep;
    bad += brunt_state_set(world, ids, id, all + 1, &error) == BRUNT_BAD_INPUT;
    bad += brunt_state_set(world, ids, id, -1, &error) == BRUNT_BAD_INPUT;
    bad += brunt_state_set(world, ids, NULL, all, &error) == BRUNT_BAD_INPUT;
    bad += brunt_state_set(world, place, id, all, &error) == BRUNT_BAD_INPUT;
    bad += brunt_state_set(world, -1, id, all, &error) == BRUNT_BAD_INPUT;
    bad += brunt_state_set(world, count, id, all, &error) == BRUNT_BAD_INPUT;
    const brunt_state_block past = brunt_state_info(world, count), before = brunt_state_info(world, -1);
    brunt_state_get(world, count, NULL);
    brunt_state_get(world, -1, NULL);
    heard_nothing();
    ck_assert_int_eq(bad, 11);
    ck_assert(past.count == 0 && !past.name[0] && before.count == 0 && !before.name[0]);
    ck_assert(brunt_world_hash(world) == hash);
    world_steps(world, 2);
    free(id);
    brunt_world_destroy(world);
}
END_TEST

// A step that is not to be taken is refused as often as it is asked for.
START_TEST(steps_past_the_end) {
    brunt_world_def def = def_begin(2, 0.1);
    def_material(&def, "neo-hookean", 1000, 1e6, 0.3);
    def_box(&def, "a", XYZ(0, 0, 0), XYZ(0.5, 0.5, 0));
    def.end = 1e-4;
    brunt_world *world = world_take(&def);
    brunt_error error = {0};
    world_until(world, 1e-4);
    listen();
    for (int k = 0; k < 3; k++) {
        ck_assert_int_eq(brunt_world_step(world, INFINITY, &error), BRUNT_FAILED);
        ck_assert(strstr(error.message, "the end has been reached"));
    }
    heard_nothing();
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("errors of the interface");
    ADD(one_of_everything_is_good);
    ADD(nothing_at_all);
    ADD(counts_and_arrays);
    ADD(enumerators);
    ADD(names_without_end);
    ADD(numbers);
    ADD(meshes);
    ADD(shapes);
    ADD(sizes_hold_between_sets);
    ADD(a_field_alone_is_set);
    ADD(bad_sets_change_nothing);
    ADD(steps_past_the_end);
    return suite_main(suite);
}
