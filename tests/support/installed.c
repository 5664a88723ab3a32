// A user's program: built by tests/support/install.sh against the installed library, with what pkg-config says and
// nothing else. A block flies freely; momentum, time and energy must be as they were given.
#include <brunt.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define EXPECT(condition)                                                                                              \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "installed.c:%d: %s does not hold\n", __LINE__, #condition);                               \
            return 1;                                                                                                  \
        }                                                                                                              \
    } while (0)

int main(void) {
    brunt_world_def def = brunt_world_def_default();
    brunt_error error = {0};
    def.dimension = 2, def.cell = 0.1, def.end = 1, def.threads = 1;
    def.materials = brunt_def_alloc(sizeof *def.materials), def.material_count = 1;
    def.bodies = brunt_def_alloc(sizeof *def.bodies), def.body_count = 1;
    EXPECT(def.materials && def.bodies);
    brunt_material_def *rubber = def.materials;
    *rubber = brunt_material_def_default("rubber", "neo-hookean");
    EXPECT(brunt_material_set(rubber, "density", 1000, NULL, &error) == BRUNT_OK);
    EXPECT(brunt_material_set(rubber, "E", 1e6, NULL, &error) == BRUNT_OK);
    EXPECT(brunt_material_set(rubber, "nu", 0.3, NULL, &error) == BRUNT_OK);
    EXPECT(brunt_material_set(rubber, "yield", 1e6, NULL, &error) == BRUNT_BAD_INPUT);
    brunt_body_def *block = def.bodies;
    *block = brunt_body_def_default();
    strcpy(block->name, "block");
    block->shape.kind = BRUNT_BOX, block->shape.max[0] = 1, block->shape.max[1] = 0.5, block->velocity[0] = 3;

    brunt_world *world = brunt_world_create(&def, &error);
    if (!world) fprintf(stderr, "%s\n", error.message);
    EXPECT(world);
    EXPECT(brunt_world_particles(world) == 200);
    for (int step = 0; step < 20; step++) EXPECT(brunt_world_step(world, INFINITY, &error) == BRUNT_OK);
    brunt_body_sums sums;
    brunt_body_totals(world, 0, &sums);
    EXPECT(fabs(sums.mass - 500) < 1e-2);
    EXPECT(fabs(sums.momentum[0] - 1500) < 1e-2);
    EXPECT(fabs(sums.centre[0] - (0.5 + 3 * brunt_world_time(world))) < 1e-5);
    brunt_world_destroy(world);

    rubber->density = -1;
    EXPECT(!brunt_world_create(&def, &error) && error.code == BRUNT_BAD_INPUT);
    brunt_world_def_free(&def);
    puts("installed library works, version " BRUNT_VERSION);
    return 0;
}
