// A small elastic scene in several dresses, for cost_count.sh to count the instructions of its steps: cost_scene DRESS
// STEPS. Valgrind begins to count after the first four steps, which make room for what the others use.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <valgrind/callgrind.h>

#include "brunt.h"

enum { BEFORE = 4 };

static brunt_material_def rubber(void) {
    return (brunt_material_def){
        .name = "rubber", .density = 1000, .strength = "neo-hookean", .strength_parameters = {1e6, 0.3}};
}

static brunt_body_def cube(const char *name, double x) {
    brunt_body_def b = brunt_body_def_default();
    snprintf(b.name, sizeof b.name, "%s", name);
    b.shape.kind = BRUNT_BOX;
    for (int a = 0; a < 3; a++) b.shape.min[a] = a ? 0 : x, b.shape.max[a] = (a ? 0 : x) + 0.8;
    b.wave_velocity[0] = 1;
    b.wave_vector[0] = 4, b.wave_phase = -4 * x;
    return b;
}

int main(int count, char **words) {
    if (count != 3) return 64;
    const char *dress = words[1];
    brunt_material_def materials[2] = {rubber(), rubber()};
    brunt_body_def bodies[2] = {cube("a", 0), cube("b", 0.83)};
    brunt_plane_def plane = brunt_plane_def_default();
    brunt_world_def def = brunt_world_def_default();
    def.cell = 0.1;
    def.end = 1e6;
    def.step = 5e-4; // the same for all
    def.threads = 1;
    def.energy_limit = INFINITY;
    def.contact.method = BRUNT_CONTACT_NONE;
    def.materials = materials, def.material_count = 1;
    def.bodies = bodies, def.body_count = 1;
    plane.normal[1] = 1, plane.point[1] = -5;
    if (!strcmp(dress, "plain")) {
    } else if (!strcmp(dress, "few")) { // 125 particles
        for (int a = 0; a < 3; a++) bodies[0].shape.max[a] = 0.25;
    } else if (!strcmp(dress, "hex8")) { // 1000 elements
        bodies[0].method = BRUNT_FEM;
        bodies[0].size = 0.08;
    } else if (!strcmp(dress, "tet4")) { // some 5000
        bodies[0].method = BRUNT_FEM, bodies[0].element = BRUNT_TET4;
        bodies[0].size = 0.08;
    } else if (!strcmp(dress, "flip") || !strcmp(dress, "pic")) {
        def.transfer = dress[0] == 'f' ? BRUNT_FLIP : BRUNT_PIC;
    } else if (!strcmp(dress, "apic_kept") || !strcmp(dress, "apic_0")) { // APIC that keeps a share, and none
        def.apic = dress[5] == 'k' ? 0.9 : 0;
    } else if (!strcmp(dress, "cubic")) {
        def.kernel = BRUNT_CUBIC;
    } else if (!strcmp(dress, "dim2")) { // 1600 particles
        def.dimension = 2, def.cell = 0.04;
        for (int b = 0; b < 2; b++) bodies[b].shape.min[2] = bodies[b].shape.max[2] = bodies[b].wave_velocity[2] = 0;
    } else if (!strcmp(dress, "contact")) { // asked for, but there is nothing to touch
        def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
        def.contact.friction = 0.4;
        def.contact.allow_overlap = true;
    } else if (!strcmp(dress, "options")) { // numbers of effects that are off, and a material that nothing is made of
        snprintf(materials[0].eos, sizeof materials[0].eos, "%s", "");
        materials[0].eos_parameters[0] = 3000;
        materials[0].viscosity_parameters[0] = 0.06;
        materials[1] = (brunt_material_def){
            .name = "copper", .density = 8960, .strength = "von-mises", .strength_parameters = {1e11, 0.3, 1e8}};
        def.material_count = 2;
        def.gravity_ramp = 1;
        def.flip = 0.5;
        bodies[0].temperature = 500;
    } else if (!strcmp(dress, "gravity")) {
        def.gravity[2] = -9.81;
    } else if (!strcmp(dress, "plastic")) {
        snprintf(materials[0].strength, sizeof materials[0].strength, "von-mises");
        materials[0].strength_parameters[2] = 1e4;
    } else if (!strcmp(dress, "wall")) {
        def.planes = &plane, def.plane_count = 1;
    } else if (!strncmp(dress, "floor_", 6)) { // points that fall on a plane, stopped within a step or by springs
        plane.point[1] = 0;
        for (int b = 0; b < 2; b++) bodies[b].velocity[1] = -1;
        def.planes = &plane, def.plane_count = 1;
        def.contact.stop = dress[6] == 's' ? BRUNT_STOP_SPRING : BRUNT_STOP_HARD;
    } else if (!strcmp(dress, "wall_spring")) {
        def.planes = &plane, def.plane_count = 1;
        def.contact.stop = BRUNT_STOP_SPRING;
    } else if (!strcmp(dress, "two")) { // two bodies that do not know of each other, and two that do
        def.body_count = 2;
    } else if (!strcmp(dress, "met")) {
        def.body_count = 2;
        def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
    } else if (!strcmp(dress, "apart") || !strcmp(dress, "far")) { // two that never meet, and may or may not
        bodies[1] = cube("b", 50);
        def.body_count = 2;
        if (!strcmp(dress, "far")) def.contact.method = BRUNT_CONTACT_MULTI_VELOCITY;
    } else if (!strcmp(dress, "erode")) { // a limit that is never reached
        bodies[0].erosion.strain = 1e9;
    } else if (!strncmp(dress, "hex8_", 5)) { // the same of meshes
        for (int b = 0; b < 2; b++) bodies[b].method = BRUNT_FEM, bodies[b].size = 0.08;
        const char *what = dress + 5;
        if (!strcmp(what, "wall") || !strcmp(what, "on_plane")) {
            if (what[0] == 'o') plane.point[1] = 0;
            def.planes = &plane, def.plane_count = 1;
        } else if (!strncmp(what, "met", 3)) { // a hundredth of an edge apart
            if (!strcmp(what, "met_lossy")) def.contact.touch = BRUNT_TOUCH_INELASTIC;
            bodies[1] = cube("b", 0.8008);
            bodies[1].method = BRUNT_FEM, bodies[1].size = 0.08;
            def.body_count = 2;
            def.contact.method = BRUNT_CONTACT_AUGURY;
        } else if (!strcmp(what, "apart") || !strncmp(what, "far", 3)) {
            bodies[1] = cube("b", 50);
            bodies[1].method = BRUNT_FEM, bodies[1].size = 0.08;
            def.body_count = 2;
            if (strcmp(what, "apart") != 0) def.contact.method = BRUNT_CONTACT_AUGURY;
            if (!strcmp(what, "far_lossy")) def.contact.touch = BRUNT_TOUCH_INELASTIC;
        } else if (!strcmp(what, "mixed") || !strcmp(what, "mixed_far")) { // a mesh and points
            bodies[1] = cube("b", 50);
            def.body_count = 2;
            if (!strcmp(what, "mixed_far")) def.contact.method = BRUNT_CONTACT_AUGURY;
        } else if (!strcmp(what, "erode")) {
            bodies[0].erosion.strain = 1e9;
        } else if (!strcmp(what, "soft")) { // no springs against hourglass modes
            bodies[0].hourglass_coefficient = 0;
        } else if (!strcmp(what, "viscous") || !strcmp(what, "inviscid")) {
            bodies[0].hourglass = BRUNT_HOURGLASS_VISCOUS;
            if (!strcmp(what, "inviscid")) bodies[0].hourglass_coefficient = 0;
        } else {
            return 64;
        }
    } else {
        return 64;
    }
    brunt_error error = {0};
    brunt_world *world = brunt_world_create(&def, &error);
    int status = world ? BRUNT_OK : error.code;
    for (int s = 0; s < BEFORE + atoi(words[2]) && !status; s++) {
        if (s == BEFORE) CALLGRIND_START_INSTRUMENTATION;
        status = brunt_world_step(world, INFINITY, &error);
    }
    CALLGRIND_STOP_INSTRUMENTATION;
    if (status) fprintf(stderr, "%s\n", error.message);
    brunt_world_destroy(world);
    return status;
}
