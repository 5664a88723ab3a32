// Two bodies that meet obliquely do the same in a mirror, with axes that change places, turned, and with the two in the
// other order: whatever faces, nodes and particles are numbered by then.
#include "tests/support/reflected.h"

enum { STEPS = 12 };

typedef struct meeting {
    brunt_method method[2];
    brunt_contact_method contact;
    double slack;                // how far rounding may bring them apart, of what there is
    double low[2][AXES], length; // [m] corners, and of the second one's edge along x
} meeting;

#define AT_ODDS {{-1.0031, -0.4533, -0.5527}, {0.0213, -0.3137, -0.4071}}, 1
// So that quadrilaterals are bent where two edges meet.
#define IN_LINE {{-1, -0.45, -0.55}, {0.02, -0.3, -0.4}}, 0.98

// Where directions are searched to 1e-8 of a distance, the last step of the search may be one more.
static const meeting meetings[] = {
    {{BRUNT_FEM, BRUNT_FEM}, BRUNT_CONTACT_AUGURY, 1e-10, AT_ODDS},
    {{BRUNT_FEM, BRUNT_FEM}, BRUNT_CONTACT_AUGURY, 1e-10, IN_LINE},
    {{BRUNT_MPM, BRUNT_FEM}, BRUNT_CONTACT_AUGURY, 1e-10, AT_ODDS},
    {{BRUNT_FEM, BRUNT_MPM}, BRUNT_CONTACT_AUGURY, 1e-10, AT_ODDS},
    {{BRUNT_MPM, BRUNT_MPM}, BRUNT_CONTACT_AUGURY, 1e-10, AT_ODDS},
    {{BRUNT_MPM, BRUNT_MPM}, BRUNT_CONTACT_MULTI_VELOCITY, 1e-7, AT_ODDS},
    {{BRUNT_MPM, BRUNT_FEM}, BRUNT_CONTACT_MULTI_VELOCITY, 1e-10, AT_ODDS},
};
enum { MEETINGS = sizeof meetings / sizeof *meetings };

static void def_block(brunt_world_def *def, const reflection *r, const meeting *m, bool second) {
    static const double fast[2][AXES] = {{30, 6, -4}, {-20, -3, 5}};
    const double *low = m->low[second];
    double from[AXES], to[AXES], high[AXES], v[AXES], ends[2][AXES];
    for (int a = 0; a < AXES; a++) high[a] = low[a] + (second && a == 0 ? m->length : 1);
    reflect(r, low, from), reflect(r, high, to), reflect(r, fast[second], v);
    for (int a = 0; a < AXES; a++) ends[0][a] = fmin(from[a], to[a]), ends[1][a] = fmax(from[a], to[a]);
    brunt_body_def *b = def_box(def, second != r->swap ? "b" : "a", ends[0], ends[1]);
    b->method = m->method[second];
    if (b->method == BRUNT_FEM) b->element = BRUNT_HEX8, b->size = second ? 0.2 : 0.25;
    def_velocity(b, v[0], v[1], v[2]);
}

static brunt_world *meet(const meeting *m, const reflection *r) {
    brunt_world_def def = def_begin(3, 0.2);
    def_material(&def, "neo-hookean", 1000, 1e7, 0.3);
    if (m->method[0] == m->method[1] && m->method[0] == BRUNT_FEM) def.cfl = 0.9;
    def.contact.method = m->contact, def.contact.friction = 0.3;
    for (int k = 0; k < 2; k++) {
        const bool second = k != (int)r->swap;
        def_block(&def, r, m, second);
    }
    return world_take(&def);
}

START_TEST(a_mirror_changes_nothing) {
    const meeting *m = &meetings[_i];
    outcome as[STEPS];
    brunt_world *world = meet(m, &plain);
    const double energy = world_energy(world).initial, momentum = 3e4; // of a body at 30 m/s
    for (int k = 0; k < STEPS; k++) world_until(world, 1e-3 * (k + 1)), as[k] = outcome_of(world, &plain);
    ck_assert_double_gt(as[STEPS - 1].energy[2], 0.01 * energy); // they have met
    ck_assert_double_gt(as[STEPS - 1].energy[3], 1e-3 * energy); // and rubbed
    brunt_world_destroy(world);
    for (int i = 0; i < REFLECTIONS; i++) {
        double most = 0;
        world = meet(m, &reflections[i]);
        for (int k = 0; k < STEPS; k++) {
            world_until(world, 1e-3 * (k + 1));
            const outcome now = outcome_of(world, &reflections[i]);
            most = fmax(most, greatest_between(&now, &as[k], energy, momentum));
        }
        brunt_world_destroy(world);
        printf("  %d, %s: differs by %.1e\n", _i, reflections[i].name, most);
        ck_assert_double_le(most, sizeof(real) == sizeof(double) ? m->slack : 2e-2);
    }
}
END_TEST

int main(void) {
    Suite *suite = suite_create("reflections");
    ADD_LOOP(a_mirror_changes_nothing, MEETINGS);
    return suite_main(suite);
}
