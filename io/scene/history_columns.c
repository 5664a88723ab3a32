#include "io/scene/history_columns.h"

#include <stdbool.h>
#include <stddef.h>

#define IMPLICIT "time.scheme: implicit or static"
#define STATIC "time.scheme: static"
#define MOVES "not time.scheme: static"
#define SURFACE "a line or a mesh as boundary"
#define TOOL "a line or a mesh with mass"
#define BETWEEN "boundaries[].gas"

// clang-format off
const history_column brunt_column_table[] = {
    {"time", "s", "of the line: the end of its step", NULL},
    {"step", "1", "steps so far", NULL},
    {"dt", "s", "length of the last step", NULL},

    {"energy.kinetic", "J", "of all motion, in the middle of the last step (implicit: at its end), with the affine part of APIC; energies in 2D are those of a metre of thickness", NULL},
    {"energy.internal", "J", "stored by the materials of bodies; gases do their work from outside", NULL},
    {"energy.mechanical", "J", "kinetic + internal, both of the end of the step", NULL},
    {"energy.plastic", "J", "taken out by flow of material, so far", NULL},
    {"energy.hourglass", "J", "stored and taken out by the control of hourglass modes", NULL},
    {"energy.contact", "J", "taken out by touches, so far; implicit: what barriers and penalties have stored, which comes back", NULL},
    {"energy.contact_held", "J", "of energy.contact: what elastic touches will give back when they part", NULL},
    {"energy.friction", "J", "taken out by friction, so far", NULL},
    {"energy.viscosity", "J", "taken out by bulk and shear viscosity and damping, so far", NULL},
    {"energy.transfer", "J", "taken out by transfers between material points and the grid, so far; below 0: made", NULL},
    {"energy.eroded", "J", "kinetic and stored energy that left with what eroded, so far", NULL},
    {"energy.scheme", "J", "taken out by the integrator of implicit steps, so far", IMPLICIT},
    {"energy.heat", "J", "of energy.plastic: what has warmed the material", NULL},
    {"energy.external_work", "J", "done on the bodies by gravity, loads, boundaries and prescribed motion, so far", NULL},
    {"energy.initial", "J", "kinetic + internal at the start", NULL},
    {"energy.total", "J", "kinetic + internal + all that was taken out", NULL},
    {"energy.error", "J", "total - initial - external_work", NULL},
    {"energy.error_relative", "1", "energy.error over the most energy that the run has been given by now (summary.json: energy.reference)", NULL},

    {"momentum.linear_?", "kg m/s", "of all bodies", MOVES},
    {"momentum.angular_?", "kg m^2/s", "about the origin, with the spin of APIC; 2D: z alone", MOVES},
    {"momentum.linear_drift", "1", "size of its change since the start, impulses from outside taken off, over the sum of the sizes of what makes it up", MOVES},
    {"momentum.angular_drift", "1", "likewise", MOVES},

    {"newton.iterations", "1", "of the last step", IMPLICIT},
    {"newton.halvings", "1", "of its line searches", IMPLICIT},
    {"newton.linear_iterations", "1", "of its linear systems; of factorisations none", IMPLICIT},
    {"newton.cuts", "1", "how often it was taken anew, half as long", IMPLICIT},
    {"newton.residual", "m/s or 1", "greatest last correction; static: greatest share of forces left unbalanced", IMPLICIT},
    {"newton.least_gap", "m", "least distance of surfaces at the end of a step; none: nothing has been near", IMPLICIT},
    {"newton.least_part", "1", "least part of the distance at which surfaces know of each other, likewise", IMPLICIT},
    {"balance.body", "1", "what load steps leave unbalanced of the forces on bodies, over the sizes of these: of the body that balances least", STATIC},
    {"balance.all", "1", "of all bodies together", STATIC},
    {"links.count", "1", "pairs of bodies that push each other, with a barrier", STATIC},
    {"links.mean", "N", "mean of their normal forces", STATIC},
    {"links.sd", "N", "standard deviation of these", STATIC},
    {"links.greatest", "N", "greatest of these", STATIC},
    {"links.slipping", "1", "pairs that have come to 0.99 of Coulomb's bound", STATIC},

    {"body.*.mass", "kg", "what is left of the body; * a body, a crowd as one, or a member of it that a measure asks for", NULL},
    {"body.*.position_?", "m", "centre of mass", NULL},
    {"body.*.velocity_?", "m/s", "of the centre of mass", NULL},
    {"body.*.low_?", "m", "least coordinates of its nodes, or of its material points", NULL},
    {"body.*.high_?", "m", "greatest coordinates likewise", NULL},
    {"body.*.kinetic", "J", "its share of energy.kinetic", NULL},
    {"body.*.internal", "J", "its share of energy.internal", NULL},
    {"body.*.plastic", "J", "its share of energy.plastic", NULL},
    {"body.*.eroded", "1", "elements and material points that have left it", "erosion"},
    {"body.*.eroded_mass", "kg", "their mass, and that of nodes without elements", "erosion"},

    {"contact.*.force_?", "N", "on the second body of the pair (contact.a-b: on b; pairs are named in the alphabetical order of their bodies, whatever that of the scene is), mean over output.force_window; 2D: per metre of thickness", "contact"},
    {"contact.*.force", "N", "size of that", "contact"},
    {"contact.*.impulse_?", "N s", "since the start", "contact"},
    {"contact.*.area", "m^2 or m", "what touched in the last step (2D: its length); implicit: what is nearer than contact.distance", "contact"},
    {"wall.*.force_?", "N", "of the boundary on the bodies, mean over output.force_window", "boundaries"},
    {"wall.*.force", "N", "size of that", "boundaries"},
    {"wall.*.impulse_?", "N s", "since the start", "boundaries"},
    {"wall.*.moment_?", "N m", "about boundaries[].about, in the last step", SURFACE},
    {"wall.*.work", "J", "that its motion has done on the bodies, since the start", SURFACE},
    {"wall.*.drift", "m/s", "greatest rate at which material leaves what holds it", SURFACE},
    {"wall.*.active", "1", "pieces of it that hold something", SURFACE},
    {"wall.*.position_?", "m", "its centre of mass", TOOL},
    {"wall.*.velocity_?", "m/s", "of its centre of mass", TOOL},
    {"wall.*.spin_?", "rad/s", "its angular velocity", TOOL},
    {"wall.*.kinetic", "J", "of its motion", TOOL},
    {"wall.*.gravity_work", "J", "done on it by gravity, since the start", TOOL},
    {"gas.*.volume", "m^3", "that the gas fills", BETWEEN},
    {"gas.*.pressure", "Pa", "absolute", BETWEEN},
    {"gas.*.energy", "J", "internal energy of the gas", BETWEEN},
    {"gas.*.inflow", "J", "enthalpy that has flowed in, since the start", BETWEEN},

    {"probe.*", NULL, "the field of output.probes where the probe was at the start; of vectors and tensors a column a component (_x is .x here: probe.NAME.x, probe.NAME.xy); none: it has eroded", "output.probes"},
};
const int brunt_column_rows = sizeof brunt_column_table / sizeof *brunt_column_table;
// clang-format on

static bool is_like(const char *name, const char *pattern) {
    if (!*pattern) return !*name;
    if (*pattern == '*') return is_like(name, pattern + 1) || (*name && is_like(name + 1, pattern));
    if (*pattern == '?') return (*name == 'x' || *name == 'y' || *name == 'z') && is_like(name + 1, pattern + 1);
    return *name == *pattern && is_like(name + 1, pattern + 1);
}

const history_column *brunt_column_meaning(const char *name) {
    for (int i = 0; i < brunt_column_rows; i++)
        if (is_like(name, brunt_column_table[i].name)) return &brunt_column_table[i];
    return NULL;
}
