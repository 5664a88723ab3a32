// What is read of a body is what it has: stress, its measures, volume and density of any state, at elements and points.
#include "tests/support/def_world.h"

#include "world/world.h"

typedef struct sort {
    int dimension;
    brunt_element_kind kind; // BRUNT_ELEMENT_KINDS: material points
    bool rings;
} sort;
static const sort sorts[] = {{2, BRUNT_QUAD4, false},         {3, BRUNT_HEX8, false},
                             {2, BRUNT_TRI3, true},           {3, BRUNT_MEMBRANE_QUAD4, false},
                             {2, BRUNT_ELEMENT_KINDS, false}, {3, BRUNT_ELEMENT_KINDS, false},
                             {2, BRUNT_ELEMENT_KINDS, true}};
static const double DENSITY = 1000, THICKNESS = 0.01;

static brunt_world *world_of(const sort *of) {
    const bool sheet = of->kind == BRUNT_MEMBRANE_QUAD4, points = of->kind == BRUNT_ELEMENT_KINDS;
    brunt_world_def def = def_begin(of->dimension, points ? 0.5 : 0);
    def_material(&def, "neo-hookean", DENSITY, 1e6, 0.3);
    def.axisymmetric = of->rings;
    brunt_body_def *body = def_box(&def, "block", XYZ(1, 0, 0), XYZ(2, 1, sheet ? 0.1 : 1));
    if (!points) body->method = sheet ? BRUNT_MEMBRANE : BRUNT_FEM, body->element = of->kind, body->size = 0.5;
    if (!sheet) return world_take(&def);
    body->thickness = THICKNESS;
    body->faces = brunt_alloc(sizeof *body->faces), body->face_count = 1;
    snprintf(body->faces[0], sizeof body->faces[0], "zmin");
    return world_take(&def);
}

// Arrays of the body: F, stress and volume at the start, and of a membrane the stretch across.
typedef struct arrays {
    real *const *F, *const *tau, *volume, *across;
    int point_dim;
    int64_t slots;
} arrays;

static arrays arrays_of(brunt_world *world) {
    if (world->bodies.mpm_count) {
        brunt_particles *p = &world->bodies.mpm[0].particles;
        return (arrays){brunt_field(p, BRUNT_FIELD_deformation_gradient),
                        brunt_field(p, BRUNT_FIELD_kirchhoff_stress),
                        brunt_field(p, BRUNT_FIELD_reference_volume)[0],
                        NULL,
                        p->point_dim,
                        p->slots};
    }
    brunt_fem_body *fem = &world->bodies.fem[0];
    return (arrays){brunt_element_scalars(fem, BRUNT_ELEMENT_deformation_gradient),
                    brunt_element_scalars(fem, BRUNT_ELEMENT_kirchhoff_stress),
                    brunt_element_scalars(fem, BRUNT_ELEMENT_reference_volume)[0],
                    fem->traits->membrane ? brunt_element_scalars(fem, BRUNT_ELEMENT_thickness_stretch)[0] : NULL,
                    fem->point_dim,
                    fem->slots};
}

static void near(double found, double wanted, double size, const char *what) {
    ck_assert_msg(fabs(found - wanted) <= TOLERANCE(1e-13, 1e-5) * size, "%s: %.17g, wanted %.17g", what, found,
                  wanted);
}

// The first value of a scalar field, or all of the first item of another.
static void first_of(brunt_world *world, const char *name, int count, double *out) {
    double *all = world_field(world, 0, name);
    memcpy(out, all, (size_t)count * sizeof *out);
    free(all);
}

START_TEST(fields_follow_from_the_state) {
    static const double F3[9] = {1.1, 0.2, -0.1, 0.05, 0.9, 0.15, -0.2, 0.1, 1.2},
                        stress[6] = {3e4, -5e4, 7e4, 2e4, -4e4, 6e4};
    const sort *of = &sorts[_i];
    brunt_world *world = world_of(of);
    const arrays a = arrays_of(world);
    const int dim = a.point_dim, symmetric = dim == 3 ? 6 : 4;
    const bool sheet = a.across != NULL;
    double F[9] = {0}, sigma[6] = {0}, start = (double)a.volume[0];
    F[8] = sheet ? 0.8 : 1;
    for (int r = 0; r < dim; r++)
        for (int c = 0; c < dim; c++) F[3 * r + c] = of->rings && (r == 2) != (c == 2) ? 0 : F3[3 * r + c];
    if (sheet) F[3] = F[1]; // its stretch
    const double J =
        F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
    for (int64_t s = 0; s < a.slots; s++) {
        for (int r = 0; r < dim; r++)
            for (int c = 0; c < dim; c++) a.F[r * dim + c][s] = (real)F[3 * r + c];
        for (int c = 0; c < symmetric; c++) a.tau[c][s] = (real)stress[c];
        if (sheet) a.across[s] = (real)F[8];
    }
    for (int c = 0; c < symmetric; c++) sigma[c] = stress[c] / J;
    double got[9];
    first_of(world, "J", 1, got), near(got[0], J, J, "J");
    first_of(world, "volume", 1, got), near(got[0], J * start, J * start, "volume");
    first_of(world, "density", 1, got), near(got[0], DENSITY / J, DENSITY, "density");
    first_of(world, "deformation_gradient", 9, got);
    for (int c = 0; c < 9; c++) near(got[c], F[c], 1, "F");
    if (sheet) first_of(world, "thickness", 1, got), near(got[0], THICKNESS * F[8], THICKNESS, "thickness");
    double mean = 0, square = 0, measured[6];
    first_of(world, "stress", 6, measured);
    for (int c = 0; c < 6 && !sheet; c++) near(measured[c], sigma[c], 1e5, "stress"); // a sheet's is turned into space
    for (int c = 0; c < 3; c++) mean += measured[c] / 3;
    for (int c = 0; c < 6; c++) square += (c < 3 ? 1 : 2) * pow(measured[c] - (c < 3 ? mean : 0), 2);
    first_of(world, "pressure", 1, got), near(got[0], -mean, 1e5, "pressure");
    first_of(world, "von_mises", 1, got), near(got[0], sqrt(1.5 * square), 1e5, "von_mises");
    brunt_world_destroy(world);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("fields");
    ADD_LOOP(fields_follow_from_the_state, (int)(sizeof sorts / sizeof *sorts));
    return suite_main(suite);
}
