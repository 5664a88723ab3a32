// Every key of a scene, one row each.
#include "io/scene/scene_keys.h"

#include "base/array.h"
#include "io/scene/scene.h"

#include <stdio.h>
#include <string.h>

#include "geometry/element_traits.h"
#include "io/scene/scene_rows.h"

// "none|...": each with a bar before it, less the first of these.
#define BAR(name, word) "|" word
#define CONTACT_WORDS (&(BRUNT_CONTACT_METHODS(BAR))[1])
#define FORM_WORDS (&(BRUNT_AUGURY_FORMS(BAR))[1])
#define CONDITION_WORDS (&(BRUNT_CONDITIONS(BAR))[1])

#define SIGNALS "end|initial|min|max|mean|slope|first_nonzero|last_nonzero|max_abs|period|rise"

// clang-format off
static const scene_key own_rows[] = {
    {"brunt", SCENE_INTEGER, NULL, REQUIRED, 1, 1, false, false, NULL, 0, false, "version of the scene format: 1"},
    {"title", SCENE_TEXT, NULL, "''", NONE, "one line on what the scene is"},
    {"dimension", SCENE_INTEGER, NULL, "3", 2, 3, false, false, NULL, 0, false, "3, or 2: plane strain of unit thickness"},

    {"axisymmetric", SCENE_WORD, NULL, "false", ANY, "false|true", 2, false, "true: x is the distance from an axis of revolution, y runs along it; bodies are full rings, and masses, forces and energies those of the whole circle"},

    {"time", SCENE_GROUP, NULL, REQUIRED, NONE, "how long, and in which steps"},
    {"time.end", SCENE_REAL, "s", OPTIONAL, POSITIVE, NULL, 0, false, "the run ends exactly there; must be given, but not with scheme static, whose pseudo-time ends at 1", .field = SCENE_FIELD(brunt_world_def, end)},
    {"time.scheme", SCENE_WORD, NULL, "explicit", ANY, "explicit|implicit|static", 0, false, "time integration: explicit, central differences; implicit, steps of any length that minimise an energy (wants step); static, load steps from one equilibrium to the next (wants steps), in a pseudo-time from 0 to 1 that stands for s wherever a time is said: tables go by it, and gravity, traction, displacement and rotation without a table or ramp grow in proportion to it. Keys of the other scheme are checked, said to be unused, and stay in the resolved scene, so that a scene which both can compute changes this key alone", .field = SCENE_FIELD(brunt_world_def, scheme)},
    {"time.cfl", SCENE_REAL, "1", "0.5", 0, 1, true, false, NULL, 0, true, "time step as a share of the stable one; default 0.4 with pic or flip and the quadratic kernel in 3D, where lone material points are unstable above, 0.9 when no body is of material points; of scheme explicit: implicit steps say so and leave it unused"},
    {"time.step", SCENE_REAL, "s", OPTIONAL, POSITIVE, NULL, 0, false, "fixed time step; scheme implicit: must be given; a step that does not converge is cut (newton.cut); scheme explicit: in place of cfl, where cfl is not given beside it", .field = SCENE_FIELD(brunt_world_def, step)},
    {"time.steps", SCENE_INTEGER, NULL, OPTIONAL, 1, 1000000, false, false, NULL, 0, false, "load steps of scheme static, which must be given; one that does not converge is cut (newton.cut); unused by others", .field = SCENE_FIELD(brunt_world_def, load_steps)},
    {"time.predictor", SCENE_WORD, NULL, "tangent", ANY, "tangent|none", 0, true, "where a load step of scheme static with prescribed motion begins: where the tangent at the last equilibrium takes what follows that motion (one more linear system), or where that was; where it ends is the same; unused by others"},
    {"time.least_step", SCENE_REAL, "s", OPTIONAL, POSITIVE, NULL, 0, false, "the run stops when the stable step falls below it (default: a millionth of the greatest step so far); of scheme explicit, unused by implicit steps", .field = SCENE_FIELD(brunt_world_def, least_step)},
    {"time.integrator", SCENE_WORD, NULL, "euler", ANY, "euler|newmark", 0, true, "of scheme implicit (unused by explicit steps): backward Euler, of first order, which damps what is faster than the step; Newmark with beta 1/4, of second order, which damps nothing"},
    {"time.energy_limit", SCENE_REAL, "1", "0.1", 0, INFINITY, true, true, "none", 0, false, "the run stops when the energy error passes this share of the most energy that it has been given by then: at the start, with the work done on it, or by all causes of work together, each by its amount; what it has (kinetic, internal) where that is more, up to ten times; never less than what rounding does; energy that transfers, or the integrator of implicit steps, have made counts likewise", .field = SCENE_FIELD(brunt_world_def, energy_limit)},

    {"newton", SCENE_GROUP, NULL, OPTIONAL, NONE, "Newton's method in steps of schemes implicit and static; unused by explicit ones"},
    {"newton.tolerance", SCENE_REAL, "1", "1e-6", 0, 1, true, true, NULL, 0, true, "implicit: a step has converged when its last correction moves no particle and no node of a mesh faster than this share of the slowest wave speed; static: when forces leave no more than this share of those that act unbalanced (sum of the sizes of what is left, over that of loads or reactions), and no more than a hundred times that share of those on any one body", .field = SCENE_FIELD(brunt_world_def, newton.tolerance)},
    {"newton.iterations", SCENE_INTEGER, NULL, "100", 1, 100000, false, false, NULL, 0, true, "most of a step", .field = SCENE_FIELD(brunt_world_def, newton.iterations)},
    {"newton.cut", SCENE_INTEGER, NULL, "6", 0, 40, false, false, NULL, 0, true, "most halvings of a step that does not converge (static: of a whole load step), or whose equilibrium is unstable; the run ends when that does not help", .field = SCENE_FIELD(brunt_world_def, newton.cut)},
    {"newton.solver", SCENE_WORD, NULL, "auto", ANY, "auto|direct|pcg|matrix-free", 0, true, "of the linear systems: by their size and c dt / h, by factorisation, by conjugate gradients with an incomplete factor, by conjugate gradients with products of bodies in place of their matrix, which take less memory and more iterations", .field = SCENE_FIELD(brunt_world_def, newton.solver)},
    {"newton.accuracy", SCENE_REAL, "1", "1e-3", 0, 1, true, true, NULL, 0, true, "of pcg and matrix-free: residual of a linear system over its right-hand side", .field = SCENE_FIELD(brunt_world_def, newton.accuracy)},

    {"grid", SCENE_GROUP, NULL, OPTIONAL, NONE, "the grid of the material points; it has no bounds; wanted when a body is of method mpm"},
    {"grid.cell", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 0, false, "edge of a cell; no body may be thinner (by more than a millionth, for decimals)", .field = SCENE_FIELD(brunt_world_def, cell)},
    {"grid.origin", SCENE_VECTOR, "m", "0", NONE, "a point where a grid node lies", .field = SCENE_FIELD(brunt_world_def, origin)},
    {"grid.kernel", SCENE_WORD, NULL, "quadratic", ANY, "linear|quadratic|cubic", 0, false, "B-spline that links particles to nodes; linear goes with flip, apic makes energy on it"},
    {"grid.cells", SCENE_WORD, NULL, "quads", ANY, "quads|triangles", 0, false, "2D with scheme implicit or static, kernel linear and transfer flip or pic: triangles, in two of which a diagonal cuts each cell; {mesh: FILE} takes those of a mesh, and `cell` is the length that spacing and pieces of lines go by"},
    {"grid.cells.mesh", SCENE_TEXT, NULL, OPTIONAL, NONE, "a gmsh file (.msh 2.2 or 4.1) with triangles; its path counts from the scene's folder; no material point may leave it"},
    {"grid.cells.unit", SCENE_REAL, "m", "1 m", POSITIVE, NULL, 0, false, "the length that 1 stands for in the file"},
    {"grid.transfer", SCENE_WORD, NULL, "apic", ANY, "pic|flip|apic", 0, false, "velocity transfer; {flip: SHARE} and {apic: SHARE} set the share of what is the particles' own that is kept; apic alone is {apic: 0}, flip alone {flip: 0.99}"},
    {"grid.transfer.flip", SCENE_REAL, "1", "0.99", 0, 1, false, false, NULL, 0, true, "share that is kept of a particle's own velocity, beside the grid's: what is left of it after the time cell / 2c, whatever the steps, c the wave speed of the undeformed material; of implicit steps, which are many of these, after each step"},
    {"grid.transfer.flip_per_step", SCENE_REAL, "1", OPTIONAL, 0, 1, false, false, NULL, 0, false, "what flip was: the share that each step keeps, explicit ones too; goes with the next version"},
    {"grid.transfer.apic", SCENE_REAL, "1", "0", 0, 0.98, false, false, NULL, 0, true, "share that is kept of what the grid does not see of a particle's velocity and affine field: what is left of it after the time cell / 2c, whatever the steps, c the wave speed of the undeformed material (0.9 for bodies that collide); above 0 explicit steps, kernel quadratic or cubic, cfl <= 0.9"},

    {"materials", SCENE_NAMED, NULL, REQUIRED, NONE, "materials by name"},
    {"materials.*.preset", SCENE_WORD, NULL, OPTIONAL, NONE, "a material of the library (brunt keys presets): what is not given beside it is taken from there, with another model only density, eos and viscosity; eos, failure and viscosity: none leave them out"},
    {"materials.*.model", SCENE_WORD, NULL, REQUIRED, NONE, "strength model"},
    {"materials.*.density", SCENE_REAL, "kg/m^3", REQUIRED, POSITIVE, NULL, 0, false, "density at the start"},
    {"materials.*.<parameter>", SCENE_PARAMETERS, NULL, OPTIONAL, NONE, "the parameters of the model, below"},
    {"materials.*.eos", SCENE_GROUP, NULL, OPTIONAL, NONE, "equation of state: gives the pressure in place of the model's own"},
    {"materials.*.eos.model", SCENE_WORD, NULL, REQUIRED, NONE, "equation of state"},
    {"materials.*.eos.<parameter>", SCENE_PARAMETERS, NULL, OPTIONAL, NONE, "the parameters of the equation of state, below"},
    {"materials.*.viscosity", SCENE_GROUP, NULL, OPTIONAL, NONE, "artificial bulk viscosity, for shocks; {} takes its defaults"},
    {"materials.*.viscosity.<parameter>", SCENE_PARAMETERS, NULL, OPTIONAL, NONE, "its parameters, below"},
    {"materials.*.failure", SCENE_GROUP, NULL, OPTIONAL, NONE, "damage and failure of a plastic material"},
    {"materials.*.failure.model", SCENE_WORD, NULL, REQUIRED, NONE, "failure model"},
    {"materials.*.failure.action", SCENE_WORD, NULL, "erode", ANY, "erode|soften", 0, false, "what has failed leaves its body, or stays without strength and tension (wants an eos)"},
    {"materials.*.failure.<parameter>", SCENE_PARAMETERS, NULL, OPTIONAL, NONE, "the parameters of the failure model, below; those that the strength model has too are taken from there when not given"},

    {"detonations", SCENE_ENTRIES, NULL, OPTIONAL, NONE, "where and when explosives are lit"},
    {"detonations[].point", SCENE_VECTOR, "m", REQUIRED, NONE, "where; the front runs from there with the detonation speed of the material"},
    {"detonations[].normal", SCENE_VECTOR, "1", OPTIONAL, NONE, "a plane through the point is lit instead, both ways along its normal"},
    {"detonations[].time", SCENE_REAL, "s", "0", NONE, "when"},
    {"detonations[].body", SCENE_NAME, NULL, OPTIONAL, NONE, "the one body that it lights (default: all explosives)"},

    {"bodies", SCENE_NAMED, NULL, REQUIRED, NONE, "bodies by name"},
    {"bodies.*.method", SCENE_WORD, NULL, REQUIRED, ANY, "mpm|fem|membrane", 0, false, "material points, finite elements, or a thin sheet of elements without bending stiffness (3D)"},
    {"bodies.*.material", SCENE_NAME, NULL, REQUIRED, NONE, "one of the materials"},
    {"bodies.*.shape", SCENE_SHAPE, NULL, OPTIONAL, NONE, "what is filled with particles or elements; not with mesh"},
    {"bodies.*.crowd", SCENE_GROUP, NULL, OPTIONAL, NONE, "instead of a shape: as many disks (2D) or balls (3D), each a body of its own; those of a crowd `grains` are called grains.1, grains.2, ..., and `grains` in contact.pairs stands for all of them"},
    {"bodies.*.crowd.lattice", SCENE_WORD, NULL, REQUIRED, ANY, "square|hex|random", 0, false, "in rows below each other (3D: also layers); in rows beside the gaps of those below (2D), where each second has one less; square, each shifted as far as its cell lets it. x grows first; the box about the lattice begins at 0, place moves it"},
    {"bodies.*.crowd.count", SCENE_VECTOR, "1", REQUIRED, ANY, NULL, 0, false, "members along x, y (and z)"},
    {"bodies.*.crowd.radius", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 0, false, "of a member"},
    {"bodies.*.crowd.radius_spread", SCENE_REAL, "1", "0", 0, 1, false, true, NULL, 0, false, "radii are drawn between radius (1 - it) and radius (1 + it), evenly; meshes are the same one, larger or smaller"},
    {"bodies.*.crowd.gap", SCENE_REAL, "m", "0", NOT_NEGATIVE, NULL, 0, false, "between the largest members that stand side by side, and half of it to the box about all"},
    {"bodies.*.random", SCENE_GROUP, NULL, OPTIONAL, NONE, "of a crowd: what is drawn for each member, by a hash (SplitMix64) of seed and number alone"},
    {"bodies.*.random.E", SCENE_GROUP, NULL, OPTIONAL, NONE, "Young's modulus, in place of the material's"},
    {"bodies.*.random.E.normal", SCENE_REALS, "Pa", OPTIONAL, ANY, NULL, 0, false, "[mean, standard deviation]; what is not between is drawn anew (default: even)"},
    {"bodies.*.random.E.between", SCENE_REALS, "Pa", REQUIRED, POSITIVE, NULL, 0, false, "[least, greatest]"},
    {"bodies.*.random.seed", SCENE_INTEGER, NULL, "1", 0, 9007199254740992.0, false, false, NULL, 0, false, "another one, other draws: of E, radii and places"},
    {"bodies.*.mesh", SCENE_TEXT, NULL, OPTIONAL, NONE, "fem, membrane: a gmsh file (.msh 2.2 or 4.1) instead of a shape; its path counts from the scene's folder", .only = SCENE_MESHES},
    {"bodies.*.mesh_unit", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "fem, membrane, with a mesh file: the length that 1 stands for in it, as 1 mm (default: 1 m)", .only = SCENE_MESHES},
    {"bodies.*.group", SCENE_TEXT, NULL, OPTIONAL, NONE, "fem, membrane: the physical group of the mesh file that is the body (default: the only one)", .only = SCENE_MESHES},
    {"bodies.*.element", SCENE_WORD, NULL, "hex8", ANY, BRUNT_ELEMENT_WORDS, 0, true, "fem, membrane, with a shape: kind of element (default in 2D and of membranes: quad4; membranes: quad4 or tri3)", .only = SCENE_MESHES},
    {"bodies.*.size", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "fem, membrane, with a shape (must be given): edge length of the elements; as long as the body at most (to a millionth, for decimals)", .only = SCENE_MESHES, .field = SCENE_FIELD(brunt_body_def, size)},
    {"bodies.*.grading", SCENE_GROUP, NULL, OPTIONAL, NONE, "fem, of a box: a factor on size along its axes, so that the mesh is fine where something happens", .only = SCENE_MESHES},
    {"bodies.*.grading.x", SCENE_PROFILE, "any", OPTIONAL, NONE, "[[15 mm, 1], [250 mm, 40]]: factor over the coordinate of the shape (before place), linear between, constant beyond"},
    {"bodies.*.grading.y", SCENE_PROFILE, "any", OPTIONAL, NONE, "likewise"},
    {"bodies.*.grading.z", SCENE_PROFILE, "any", OPTIONAL, ANY, NULL, 3, false, "likewise"},
    {"bodies.*.hourglass", SCENE_GROUP, NULL, OPTIONAL, NONE, "fem, membrane: control of the zero-energy modes of hex8 and quad4", .only = SCENE_MESHES},
    {"bodies.*.hourglass.form", SCENE_WORD, NULL, "stiffness", ANY, "stiffness|viscous", 0, false, "by springs or by dampers"},
    {"bodies.*.hourglass.coefficient", SCENE_REAL, "1", OPTIONAL, 0, 1, false, false, NULL, 0, false, "default 0.05 of stiffness (of lambda + 2 mu, at most of 7 mu), 0.1 of viscous"},
    {"bodies.*.thickness", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "membrane (must be given): of the sheet at the start", .only = SCENE_MEMBRANE, .field = SCENE_FIELD(brunt_body_def, thickness)},
    {"bodies.*.contact_thickness", SCENE_REAL, "m", OPTIONAL, NOT_NEGATIVE, NULL, 0, false, "membrane: contact keeps half of it between the middle surface and others (default: thickness); scheme implicit: not between its own sides", .only = SCENE_MEMBRANE, .field = SCENE_FIELD(brunt_body_def, contact_thickness)},
    {"bodies.*.tension_only", SCENE_WORD, NULL, "false", ANY, "false|true", 0, false, "membrane: true: it carries no compression but wrinkles (tension field)", .former = "slack", .only = SCENE_MEMBRANE, .field = SCENE_FIELD(brunt_body_def, tension_only)},
    {"bodies.*.faces", SCENE_NAMES, NULL, OPTIONAL, NONE, "membrane, with a shape: groups of the shape's boundary that are the sheet, as [zmin] of a box (default: all of it); where it is open its edge is the group border", .only = SCENE_MEMBRANE},
    {"bodies.*.lagrangian", SCENE_WORD, NULL, "updated", ANY, "updated|total", 0, false, "mpm: configuration of the grid; total: the undeformed one, so that the body does not come apart however far it is stretched; it meets meshes and planes only", .only = SCENE_MPM, .field = SCENE_FIELD(brunt_body_def, total_lagrangian)},
    {"bodies.*.erosion", SCENE_GROUP, NULL, OPTIONAL, NONE, "what takes elements or material points out of the body, beside failure of its material"},
    {"bodies.*.erosion.strain", SCENE_REAL, "1", OPTIONAL, POSITIVE, NULL, 0, false, "equivalent logarithmic strain (of its deviator) at which they go (default: none)", .field = SCENE_FIELD(brunt_body_def, erosion.strain)},
    {"bodies.*.erosion.step", SCENE_REAL, "s", OPTIONAL, POSITIVE, NULL, 0, false, "fem, membrane: elements go whose stable step falls below it (default: none)", .field = SCENE_FIELD(brunt_body_def, erosion.step)},
    {"bodies.*.erosion.inverted", SCENE_WORD, NULL, "error", ANY, "error|erode", 0, false, "what is turned inside out stops the run, or goes", .field = SCENE_FIELD(brunt_body_def, erosion.inverted)},
    {"bodies.*.erosion.debris", SCENE_WORD, NULL, "remove", ANY, "remove|keep", 0, false, "mass without elements leaves, with an account; or flies on: loose nodes as free particles in contact, material points without stress, which want transfer: {flip: 1} (apic stretches a lone one without end)", .field = SCENE_FIELD(brunt_body_def, erosion.keep)},
    SCENE_OF_KINDS("bodies.*"),
    {"bodies.*.mass_scaling", SCENE_REAL, "s", OPTIONAL, POSITIVE, NULL, 0, false, "fem, membrane: elements whose stable step is less are made denser until it is not (default: none are)", .only = SCENE_MESHES, .field = SCENE_FIELD(brunt_body_def, mass_scaling)},
    {"bodies.*.place", SCENE_ENTRIES, NULL, OPTIONAL, NONE, "moves of the shape or mesh, a turn or a shift each: one after the other, each of what those before have left; velocity and boundaries do not turn along"},
    {"bodies.*.place[].translate", SCENE_VECTOR, "m", OPTIONAL, NONE, "a shift"},
    {"bodies.*.place[].rotate", SCENE_GROUP, NULL, OPTIONAL, NONE, "a turn"},
    {"bodies.*.place[].rotate.axis", SCENE_VECTOR, "1", REQUIRED, ANY, NULL, 3, false, "direction of its axis"},
    {"bodies.*.place[].rotate.angle", SCENE_REAL, "rad", REQUIRED, NONE, "right-handed; in 2D counter-clockwise"},
    {"bodies.*.place[].rotate.about", SCENE_VECTOR, "m", "0", NONE, "a point of its axis, of the scene, not of the body"},
    {"bodies.*.particles_per_cell", SCENE_INTEGER, NULL, OPTIONAL, 1, 4096, false, false, NULL, 0, false, "mpm: a square in 2D (default 4), a cube in 3D (default 8); not with spacing", .only = SCENE_MPM, .field = SCENE_FIELD(brunt_body_def, particles_per_cell)},
    {"bodies.*.spacing", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "mpm: distance of particles; not with particles_per_cell", .only = SCENE_MPM, .field = SCENE_FIELD(brunt_body_def, spacing)},
    {"bodies.*.fill", SCENE_WORD, NULL, "regular", ANY, "regular|jittered|rings", 0, false, "mpm: lattice of particles, or one with random shifts; of a disk: rings about its centre, so that it is round", .only = SCENE_MPM, .field = SCENE_FIELD(brunt_body_def, fill)},
    {"bodies.*.jitter", SCENE_REAL, "1", "0.25", 0, 0.5, false, false, NULL, 0, true, "mpm: greatest shift, of the spacing; with fill: jittered", .only = SCENE_MPM},
    {"bodies.*.seed", SCENE_INTEGER, NULL, "1", 0, 9007199254740992.0, false, false, NULL, 0, true, "mpm: of the random shifts; with fill: jittered", .only = SCENE_MPM},
    {"bodies.*.velocity", SCENE_VECTOR, "m/s", "0", NONE, "at the start", .field = SCENE_FIELD(brunt_body_def, velocity)},
    {"bodies.*.spin", SCENE_GROUP, NULL, OPTIONAL, NONE, "a rotation at the start, added to the velocity"},
    {"bodies.*.spin.rate", SCENE_TURN, "rad/s", REQUIRED, NONE, "angular velocity: a vector, or a number about `axis` (2D: a number)"},
    {"bodies.*.spin.axis", SCENE_VECTOR, "1", OPTIONAL, ANY, NULL, 3, false, "direction of the axis, with a number as rate"},
    {"bodies.*.spin.about", SCENE_VECTOR, "m", "0", NONE, "a point of the axis", .field = SCENE_FIELD(brunt_body_def, spin_about)},
    {"bodies.*.wave", SCENE_GROUP, NULL, OPTIONAL, NONE, "a wave at the start, added to the velocity: velocity sin(wave_vector . x + phase)"},
    {"bodies.*.wave.velocity", SCENE_VECTOR, "m/s", REQUIRED, NONE, "amplitude", .field = SCENE_FIELD(brunt_body_def, wave_velocity)},
    {"bodies.*.wave.wave_vector", SCENE_VECTOR, "1/m", REQUIRED, NONE, "2 pi over the wave length, along the wave", .field = SCENE_FIELD(brunt_body_def, wave_vector)},
    {"bodies.*.wave.phase", SCENE_REAL, "rad", "0", NONE, "at the origin", .field = SCENE_FIELD(brunt_body_def, wave_phase)},
    {"bodies.*.temperature", SCENE_REAL, "K", "293.15", 0, INFINITY, true, true, NULL, 0, false, "at the start, for materials that know one", .field = SCENE_FIELD(brunt_body_def, temperature)},

    {"<shape>", SCENE_GROUP, NULL, OPTIONAL, NONE, "exactly one of the following"},
    {"<shape>.box", SCENE_GROUP, NULL, OPTIONAL, NONE, "a box along the axes"},
    {"<shape>.box.min", SCENE_VECTOR, "m", REQUIRED, NONE, "its lower corner"},
    {"<shape>.box.max", SCENE_VECTOR, "m", REQUIRED, NONE, "its upper corner"},
    {"<shape>.sphere", SCENE_GROUP, NULL, OPTIONAL, NONE, "a ball (a disk in 2D)"},
    {"<shape>.sphere.center", SCENE_VECTOR, "m", REQUIRED, NONE, "its centre"},
    {"<shape>.sphere.radius", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 0, false, "its radius"},
    {"<shape>.disk", SCENE_GROUP, NULL, OPTIONAL, ANY, NULL, 2, false, "a disk"},
    {"<shape>.disk.center", SCENE_VECTOR, "m", REQUIRED, ANY, NULL, 2, false, "its centre"},
    {"<shape>.disk.radius", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 2, false, "its radius"},
    {"<shape>.cylinder", SCENE_GROUP, NULL, OPTIONAL, ANY, NULL, 3, false, "a circular cylinder"},
    {"<shape>.cylinder.center", SCENE_VECTOR, "m", REQUIRED, ANY, NULL, 3, false, "centre of the end it starts from"},
    {"<shape>.cylinder.axis", SCENE_VECTOR, "1", REQUIRED, ANY, NULL, 3, false, "direction to its other end"},
    {"<shape>.cylinder.radius", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 3, false, "its radius"},
    {"<shape>.cylinder.length", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 3, false, "its length"},
    {"<shape>.tube", SCENE_GROUP, NULL, OPTIONAL, NONE, "a hollow circular cylinder (an annulus in 2D)", .former = "ring"},
    {"<shape>.tube.center", SCENE_VECTOR, "m", REQUIRED, NONE, "centre of the end it starts from (2D: its centre)"},
    {"<shape>.tube.axis", SCENE_VECTOR, "1", REQUIRED, ANY, NULL, 3, false, "direction to its other end"},
    {"<shape>.tube.inner_radius", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 0, false, "of the hole"},
    {"<shape>.tube.radius", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 0, false, "its outer radius"},
    {"<shape>.tube.length", SCENE_REAL, "m", REQUIRED, POSITIVE, NULL, 3, false, "its length"},
    {"<shape>.polygon", SCENE_GROUP, NULL, OPTIONAL, NONE, "a polygon in the x-y plane (3D: the prism above it)"},
    {"<shape>.polygon.points", SCENE_POLYGON, "m", REQUIRED, NONE, "its corners in turn, [[x, y], ...]; the last joins the first"},
    {"<shape>.polygon.min", SCENE_REAL, "m", REQUIRED, ANY, NULL, 3, false, "z of the prism's lower end"},
    {"<shape>.polygon.max", SCENE_REAL, "m", REQUIRED, ANY, NULL, 3, false, "z of its upper end"},
    {"<shape>.half-space", SCENE_GROUP, NULL, OPTIONAL, NONE, "all on one side of a plane; for cutting other shapes"},
    {"<shape>.half-space.point", SCENE_VECTOR, "m", REQUIRED, NONE, "a point of the plane"},
    {"<shape>.half-space.normal", SCENE_VECTOR, "1", REQUIRED, NONE, "pointing out of the shape"},
    {"<shape>.union", SCENE_SHAPES, NULL, OPTIONAL, NONE, "what is in any of a list of shapes"},
    {"<shape>.difference", SCENE_SHAPES, NULL, OPTIONAL, NONE, "the first of a list of shapes less all others"},
    {"<shape>.intersection", SCENE_SHAPES, NULL, OPTIONAL, NONE, "what is in all of a list of shapes"},

    {"contact", SCENE_GROUP, NULL, "{}", NONE, "contact between bodies"},
    {"contact.method", SCENE_WORD, NULL, "multi-velocity", ANY, CONTACT_WORDS, 0, true, "augury: bodies meet where their surfaces touch, two mpm bodies too, but for axisymmetric scenes and forms other than node_to_facet, where those meet by multi-velocity; multi-velocity also takes one of them with an mpm body; the default is augury when a body is of method fem or membrane; none: they pass through each other; tied: mpm bodies share one velocity where they share grid nodes, they neither part nor slide; barrier: of scheme implicit and its default, an energy keeps gaps open, with a fem or membrane body in each pair; penalty: of scheme static in two dimensions, fem bodies push each other where they overlap, by how deep, and planes fem and mpm bodies, of which each point is as wide as a circle of its area. A method that is given is kept to, or refused by a scheme that has not got it; for both schemes leave it out"},
    {"contact.friction", SCENE_REAL, "1", "0", NOT_NEGATIVE, NULL, 0, false, "Coulomb coefficient"},
    {"contact.form", SCENE_WORD, NULL, "node_to_facet", ANY, FORM_WORDS, 0, true, "of augury: velocity and gap from facing facets, from facets averaged on a grid, from averaged velocities and surfaces, or as published", .former_words = "affine|smooth|surface|paper"},
    {"contact.iterations", SCENE_INTEGER, NULL, OPTIONAL, 0, 1000, false, false, NULL, 0, false, "most sweeps of a step, see tolerance (default: augury 16, with membranes 64, forms averaged_facets and averaged_surface 4; of a mesh with material points at grid nodes 8); of form published its augury iterations (default 1)"},
    {"contact.tolerance", SCENE_REAL, "1", "0.01", 0, 1, false, true, NULL, 0, true, "of augury, form node_to_facet: sweeps end before iterations when the greatest correction of one is no more than this share of the first one's; what is left is met in the next step; 0: when nothing changes any more"},
    {"contact.touch", SCENE_WORD, NULL, "elastic", ANY, "elastic|inelastic", 0, true, "of augury, form node_to_facet: what stopping a node of a mesh takes (the half element behind it, a share of the energy of an impact that falls with the elements) is given back when it is released, or lost; where one of both bodies is a membrane it is lost"},
    {"contact.stop", SCENE_WORD, NULL, "hard", ANY, "hard|spring", 0, true, "how boundaries with condition separate, facets and, by augury, points of other bodies stop material points, explicit: within a step at zero gap, by which impacts lose a share of their energy that falls with the cell; or by springs, which give back what they took, and by which what is pressed stays in the other by about a cell times the strain that goes with the pressure (for presses: hard)"},
    {"contact.cell", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "of augury: edge of the contact grid (default: the mean edge of the surfaces; form published: twice that)"},
    {"contact.transfer", SCENE_WORD, NULL, "apic", ANY, "pic|apic", 0, true, "of augury, form published: velocity transfer to the contact grid"},
    {"contact.distance", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "of barrier and penalty: gaps beyond it know nothing of each other; bodies at rest keep most of it (default: a tenth of the shortest edge or spacing of particles in contact; of penalty nothing: surfaces push where they overlap)"},
    {"contact.stiffness", SCENE_REAL, "Pa", OPTIONAL, POSITIVE, NULL, 0, false, "of barrier: pressures of that size half close the gaps (default: a tenth of Young's modulus of the softest body in contact)"},
    {"contact.penalty", SCENE_REAL, "Pa/m", OPTIONAL, POSITIVE, NULL, 0, false, "of penalty: the pressure by how deep surfaces overlap (default: 20 E* / a of each pair, 1 / E* = the sum of (1 - nu^2) / E of both; a: half the length of a contact, the mean of all at the end of the first load step in which anything touches, no less than the shortest edge). Where bodies fit each other all round that is soft, as a is then much of what they are wide, and a greater one wants to be given"},
    {"contact.slip_speed", SCENE_REAL, "m/s", OPTIONAL, POSITIVE, NULL, 0, false, "of barrier: below it friction grows with the speed, and is less than Coulomb's; what sticks creeps no faster. It should be well below the speeds of sliding that friction matters at (default: 1e-5 of the slowest wave speed, centimetres a second in metal)"},
    {"contact.slip_length", SCENE_REAL, "m", OPTIONAL, POSITIVE, NULL, 0, false, "of barrier and penalty, static: surfaces that rub give by up to that along each other, then they slip; what they have given is kept from load step to load step (default: a hundredth of distance, of penalty without one a thousandth of the shortest edge)"},
    {"contact.surface", SCENE_WORD, NULL, "facets", ANY, "facets|arcs", 0, true, "of penalty: what surfaces of meshes are: the edges of their elements, which meet at nodes; or (2D, where all contact is by penalty) curves through the nodes, with three points between two of them that push as well: rims of disks are round, whatever their nodes stand opposite to. Edges that meet at more than 30 degrees, or of which one is more than twice as long as the other, keep their corner, and straight sides stay straight"},
    {"contact.friction_iterations", SCENE_INTEGER, NULL, "1", 1, 1000, false, false, NULL, 0, true, "of barrier: solutions of a step at most, friction being by the pressures of the one before (the first: of the step before); fewer where they no longer change. More where bodies press from the start, until the pressures change by less than a tenth from step to step"},
    {"contact.initial_overlap", SCENE_WORD, NULL, "error", ANY, "error|allow", 0, false, "bodies that overlap at the start, or lie behind a plane, line or mesh of condition separate: contact ends an approach, and what is in each other already may pass. Of meshes a fifth of an edge is let be"},
    {"contact.pairs", SCENE_ENTRIES, NULL, OPTIONAL, NONE, "pairs of bodies that differ from the above"},
    {"contact.pairs[].between", SCENE_NAMES, NULL, REQUIRED, NONE, "the two bodies, [a, b]; [a, a]: a membrane, with barriers any mesh, with itself, which it is not in contact with otherwise; its force in the history is 0, as both sides are of one body, its area is not"},
    {"contact.pairs[].method", SCENE_WORD, NULL, OPTIONAL, ANY, CONTACT_WORDS, 0, false, "default: that of contact"},
    {"contact.pairs[].friction", SCENE_REAL, "1", OPTIONAL, NOT_NEGATIVE, NULL, 0, false, "default: that of contact"},
    {"contact.pairs[].sides", SCENE_WORD, NULL, OPTIONAL, ANY, "both|slave", 0, false, "of two meshes by augury, form node_to_facet: whose nodes are held off the facets of the other; both (default), or slave: those of the first of `between` alone, at about half the cost. The first is to be the finer mesh, or the softer body: nodes of the second pass between its nodes. Edges that cross meet either way"},

    {"boundaries", SCENE_ENTRIES, NULL, OPTIONAL, NONE, "what acts on bodies from outside, each of one kind"},
    {"boundaries[].name", SCENE_NAME, NULL, OPTIONAL, NONE, "in the history; default: its kind and number, plane1, ..."},
    {"boundaries[].plane", SCENE_GROUP, NULL, OPTIONAL, NONE, "a wall; of it and the other kinds exactly one is wanted"},
    {"boundaries[].plane.point", SCENE_VECTOR, "m", REQUIRED, NONE, "a point of it"},
    {"boundaries[].plane.normal", SCENE_VECTOR, "1", REQUIRED, NONE, "pointing to the side the bodies are on"},
    {"boundaries[].condition", SCENE_WORD, NULL, OPTIONAL, ANY, CONDITION_WORDS, 0, false, "of a plane, a line or a mesh; symmetry: of a plane along the axes, for mpm on a grid line; slip of a line or mesh: in both directions, material does not leave it. Planes of condition stick or slip that stand still on a line of the grid hold mpm just there, by images (stick: of kernels quadratic and cubic, with nothing behind it at the start; slip: with no body on both sides of it); other such planes by the nodes at and behind them, in implicit and load steps as lines do", .only = SCENE_AT_PLANE | SCENE_AT_LINE},
    {"boundaries[].friction", SCENE_REAL, "1", "0", 0, INFINITY, false, true, NULL, 0, true, "Coulomb coefficient, with condition: separate", .only = SCENE_AT_PLANE | SCENE_AT_LINE},
    {"boundaries[].region", SCENE_SHAPE, NULL, OPTIONAL, NONE, "grid nodes in there are given a velocity, of several the last one's; it acts on bodies of method mpm. Before planes that hold by images (condition) they move those images; what is on such a plane rests across it, with condition stick at all"},
    {"boundaries[].place", SCENE_ENTRIES, NULL, OPTIONAL, NONE, "moves of the region, as for bodies", .only = SCENE_AT_REGION},
    {"boundaries[].place[].translate", SCENE_VECTOR, "m", OPTIONAL, NONE, "a shift"},
    {"boundaries[].place[].rotate", SCENE_GROUP, NULL, OPTIONAL, NONE, "a turn"},
    {"boundaries[].place[].rotate.axis", SCENE_VECTOR, "1", REQUIRED, ANY, NULL, 3, false, "direction of its axis"},
    {"boundaries[].place[].rotate.angle", SCENE_REAL, "rad", REQUIRED, NONE, "right-handed; in 2D counter-clockwise"},
    {"boundaries[].place[].rotate.about", SCENE_VECTOR, "m", "0", NONE, "a point of its axis"},
    {"boundaries[].velocity", SCENE_PARTIAL, "m/s", "0", ANY, NULL, 0, true, "of the wall, of the region (must be given), of the group or of the line or mesh; of region and group a component may be `free`", .only = SCENE_AT_PLANE | SCENE_AT_REGION | SCENE_AT_GROUP | SCENE_AT_LINE},
    {"boundaries[].from", SCENE_REAL, "s", "0", ANY, NULL, 0, true, "a region acts from then ...", .only = SCENE_AT_REGION},
    {"boundaries[].until", SCENE_REAL, "s", OPTIONAL, ANY, "none", 0, false, "... until then (default: for ever)", .only = SCENE_AT_REGION},
    {"boundaries[].line", SCENE_GROUP, NULL, OPTIONAL, ANY, NULL, 2, false, "holds material points that reach it, in implicit and load steps as means over pieces of it, in explicit ones each that touches it, and says by which force; its normal is to its left, where bodies are with condition separate"},
    {"boundaries[].line.points", SCENE_POLYGON, "m", REQUIRED, ANY, NULL, 2, false, "its corners in turn, [[x, y], ...], two at least"},
    {"boundaries[].line.closed", SCENE_WORD, NULL, "false", ANY, "false|true", 2, false, "whether the last joins the first"},
    {"boundaries[].mesh", SCENE_GROUP, NULL, OPTIONAL, ANY, NULL, 3, false, "the same of a surface of triangles and quadrangles; its normal is on the side from which the corners of its facets go round counter-clockwise, and bodies are there with condition separate; of schemes explicit and implicit"},
    {"boundaries[].mesh.file", SCENE_TEXT, NULL, REQUIRED, ANY, NULL, 3, false, "a gmsh file (.msh 2.2 or 4.1); its path counts from the scene's folder"},
    {"boundaries[].mesh.unit", SCENE_REAL, "m", "1 m", POSITIVE, NULL, 3, false, "the length that 1 stands for in the file"},
    {"boundaries[].mesh.group", SCENE_TEXT, NULL, OPTIONAL, ANY, NULL, 3, false, "the physical surface of the file (default: the only one)"},
    {"boundaries[].mesh.reversed", SCENE_WORD, NULL, "false", ANY, "false|true", 3, false, "true: its normal is on the other side"},
    {"boundaries[].piece", SCENE_REAL, "1", "1.5", POSITIVE, NULL, 0, false, "cells, about: length of the pieces of the line, edge of those of the mesh, each of which has one traction; shorter than 1 they ask for more than the grid can give", .only = SCENE_AT_LINE, .field = SCENE_FIELD(brunt_boundary_surface_def, piece)},
    {"boundaries[].particles_per_cell", SCENE_INTEGER, NULL, "4", 1, 1000, false, false, NULL, 0, false, "a cell of length: places of the line at which it sees the grid; of the mesh twice its square a cell of area, about, four times as many at most", .only = SCENE_AT_LINE, .field = SCENE_FIELD(brunt_boundary_surface_def, particles)},
    {"boundaries[].about", SCENE_VECTOR, "m", "0", ANY, NULL, 0, false, "a point, of the moment that the line or mesh exerts", .only = SCENE_AT_LINE, .field = SCENE_FIELD(brunt_boundary_surface_def, about)},
    {"boundaries[].mass", SCENE_REAL, "kg", OPTIONAL, POSITIVE, NULL, 0, true, "explicit: the line or mesh is a rigid tool that is free: gravity and what it touches move it, `velocity` is that at the start (2D: of a thickness of 1 m; rings: of the whole circle, it moves along the axis)", .only = SCENE_AT_LINE, .field = SCENE_FIELD(brunt_boundary_surface_def, mass)},
    {"boundaries[].inertia", SCENE_TURN, "kg m^2", OPTIONAL, NONE, "of a free tool about its centre of mass: a vector, about axes along x, y and z, which are its principal ones at the start, or a number for all three (2D: a number); without it the tool does not turn", .only = SCENE_AT_LINE},
    {"boundaries[].center", SCENE_VECTOR, "m", OPTIONAL, NONE, "centre of mass of a free tool at the start; wanted with inertia", .only = SCENE_AT_LINE},
    {"boundaries[].spin", SCENE_TURN, "rad/s", OPTIONAL, NONE, "angular velocity of a free tool at the start: a vector (2D: a number)", .only = SCENE_AT_LINE},
    {"boundaries[].group", SCENE_TEXT, NULL, OPTIONAL, NONE, "nodes of a body of method fem or membrane, with exactly one of fix, velocity, displacement, rotation, traction, pressure and gas: a physical group of its mesh file, or a part of its shape's surface (box: xmin ... zmax; cylinder, tube: start, end, side, inner, outer; all: surface; open edge of a membrane: border)"},
    {"boundaries[].fix", SCENE_AXES, NULL, OPTIONAL, NONE, "components of the group that do not move: [x, y, z], or `all`; of a node that several boundaries hold or move along an axis the first has it, and those after it do not act there, which is warned of where they differ", .only = SCENE_AT_GROUP},
    {"boundaries[].displacement", SCENE_PARTIAL, "m", OPTIONAL, NONE, "of the group, the line or the mesh, since the start; of the group a component may be `free`", .only = SCENE_AT_GROUP | SCENE_AT_LINE},
    {"boundaries[].rotation", SCENE_GROUP, NULL, OPTIONAL, NONE, "of the group, from where it was at the start; table is the factor of its angle. Components that a boundary before it prescribes stay that one's: what turns about z may be pressed along z. Of the line or mesh beside its displacement: in implicit and load steps no more than a quarter of a turn in each", .only = SCENE_AT_GROUP | SCENE_AT_LINE},
    {"boundaries[].rotation.angle", SCENE_REAL, "rad", REQUIRED, NONE, "right-handed; in 2D counter-clockwise"},
    {"boundaries[].rotation.axis", SCENE_VECTOR, "1", OPTIONAL, ANY, NULL, 3, false, "direction of its axis; in 2D there is but one"},
    {"boundaries[].rotation.about", SCENE_VECTOR, "m", "0", NONE, "a point of its axis"},
    {"boundaries[].traction", SCENE_VECTOR, "Pa", OPTIONAL, NONE, "on the undeformed area of the group's faces", .only = SCENE_AT_GROUP},
    {"boundaries[].pressure", SCENE_REAL, "Pa", OPTIONAL, NONE, "against the outward normal of the group's deformed faces", .only = SCENE_AT_GROUP},
    {"boundaries[].gas", SCENE_GROUP, NULL, OPTIONAL, NONE, "ideal gas of one pressure in the volume that the group's faces enclose, by themselves or with planes of symmetry x = 0, y = 0, z = 0; table is the factor of its inflow", .only = SCENE_AT_GROUP},
    {"boundaries[].gas.gamma", SCENE_REAL, "1", "1.4", 1, INFINITY, true, true, NULL, 0, false, "ratio of specific heats", .field = SCENE_FIELD(brunt_group_def, gas.gamma)},
    {"boundaries[].gas.pressure", SCENE_REAL, "Pa", REQUIRED, NOT_NEGATIVE, NULL, 0, false, "at the start, absolute", .field = SCENE_FIELD(brunt_group_def, gas.pressure)},
    {"boundaries[].gas.outside", SCENE_REAL, "Pa", REQUIRED, NOT_NEGATIVE, NULL, 0, false, "pressure on the other side, constant; 0 in vacuum", .field = SCENE_FIELD(brunt_group_def, gas.outside)},
    {"boundaries[].gas.volume", SCENE_REAL, "m^3", "0", NOT_NEGATIVE, NULL, 0, false, "of gas beside what the faces enclose, as in a vessel", .field = SCENE_FIELD(brunt_group_def, gas.volume)},
    {"boundaries[].gas.inflow", SCENE_REAL, "W", "0", NOT_NEGATIVE, NULL, 0, false, "enthalpy that flows in", .field = SCENE_FIELD(brunt_group_def, gas.inflow)},
    {"boundaries[].table", SCENE_TABLE, "s", OPTIONAL, NONE, "factor of the group's value, or of the line's or mesh's velocity, displacement and rotation, over time, [[0 s, 0], [1 ms, 1]]: linear between, constant outside (default: 1)", .only = SCENE_AT_GROUP | SCENE_AT_LINE},
    SCENE_OF_KINDS("boundaries[]"),
    {"boundaries[].body", SCENE_NAME, NULL, OPTIONAL, NONE, "the one body it acts on (default: all; of a group it must be given)"},

    {"loads", SCENE_GROUP, NULL, "{}", NONE, "forces on everything"},
    {"loads.gravity", SCENE_VECTOR, "m/s^2", "0", NONE, "acceleration", .field = SCENE_FIELD(brunt_world_def, gravity)},
    {"loads.gravity_ramp", SCENE_REAL, "s", "0", NOT_NEGATIVE, NULL, 0, false, "gravity grows from 0 to its value over this time", .field = SCENE_FIELD(brunt_world_def, gravity_ramp)},

    {"output", SCENE_GROUP, NULL, "{}", NONE, "what is written, and how often"},
    {"output.every", SCENE_REAL, "s", "0", 0, INFINITY, false, true, "none", 0, false, "time between pictures, to which steps are cut; 0: the first and the last; none: no pictures", .field = SCENE_FIELD(brunt_output_def, every)},
    {"output.history", SCENE_REAL, "s", "0", NOT_NEGATIVE, NULL, 0, false, "time between history lines, each of the first step at or after its time; 0: every step. Places, stress and stored energy are of the time of the line, velocities, momenta and kinetic energy of the middle of the step that ends there, of implicit steps of its end; forces are means (force_window)", .field = SCENE_FIELD(brunt_output_def, history)},
    {"output.force_window", SCENE_REAL, "s", "element", 0, INFINITY, false, true, "element", 0, false, "the time before a line over which forces of contacts and walls are means, where lines are closer than that; otherwise they are means since the line before, as with 0. element: of explicit steps four times what a wave takes through an element (mean edge) or a cell of the bodies in touch, of the slowest (of a boundary without `body` all that it can act on), mass scaling counted: without what a mesh rings with behind a front, and what first touch takes out of a layer of nodes within a step", .field = SCENE_FIELD(brunt_output_def, force_window)},
    {"output.checkpoint", SCENE_REAL, "s", "600", 0, INFINITY, false, true, "none", 0, false, "wall time between checkpoints; 0: with every picture; none: at the end and on signals", .field = SCENE_FIELD(brunt_output_def, checkpoint)},
    {"output.fields", SCENE_NAMES, NULL, "[default]", NONE, "fields in pictures; default: velocity, and of fem and membrane bodies displacement, stress, plastic_strain and what contact does, where there are"},
    {"output.precision", SCENE_WORD, NULL, "float32", ANY, "float32|float64", 0, false, "of numbers in pictures"},
    {"output.tractions", SCENE_WORD, NULL, "false", ANY, "false|true", 0, false, "2D, barriers and penalties: true: tractions.csv, at the end: along the rims of meshes in contact, of each node the pressure and the traction along the rim (which has the body to its left)", .field = SCENE_FIELD(brunt_output_def, tractions)},
    {"output.probes", SCENE_NAMED, NULL, OPTIONAL, NONE, "single particles, nodes or elements to follow in the history, by name"},
    {"output.probes.*.body", SCENE_NAME, NULL, REQUIRED, NONE, "its body"},
    {"output.probes.*.point", SCENE_VECTOR, "m", REQUIRED, NONE, "the particle, node or element (where the field lives) nearest to it at the start is followed"},
    {"output.probes.*.field", SCENE_NAME, NULL, REQUIRED, NONE, "what is recorded"},

    {"measures", SCENE_NAMED, NULL, OPTIONAL, NONE, "results by name, judged where a value is expected"},
    SCENE_OF_KINDS("measures.*"),
    {"measures.*.take", SCENE_WORD, NULL, "end", ANY, SIGNALS, 0, true, "how history is reduced over time; lines without a value, as the gap of what is near nothing, do not count, but for end and initial (period: mean time between rises through the middle of its range; rise: time at which it first passes half of its greatest value), a field over the body (min max mean max_abs; mean: of material points that are rings each by its volume at the start)"},
    {"measures.*.at", SCENE_WORD, NULL, OPTIONAL, ANY, SIGNALS, 0, false, "another name for take"},
    {"measures.*.curve", SCENE_CURVE, "any", OPTIONAL, NONE, "reference over time for the history, [[0 s, 0 m], [1 s, 2 m]], linear between: what is reduced (take: max_abs by default, max, min, mean, initial or end) is history less curve, after minus and relative_to, over the curve's range of values, from its first to its last time"},
    {"measures.*.from", SCENE_REAL, "s", OPTIONAL, NOT_NEGATIVE, NULL, 0, false, "of the history only from then ..."},
    {"measures.*.to", SCENE_REAL, "s", OPTIONAL, NOT_NEGATIVE, NULL, 0, false, "... to then"},
    {"measures.*.minus", SCENE_ANY_UNIT, "any", "0", NONE, "subtracted first, in the unit of what is taken"},
    {"measures.*.relative_to", SCENE_ANY_UNIT, "any", OPTIONAL, ANY, "initial", 0, false, "then divided by this, or by the first value of the history"},
    {"measures.*.expect", SCENE_ANY_UNIT, "any", OPTIONAL, NONE, "the value it should have; wants tolerance beside it"},
    {"measures.*.tolerance", SCENE_ANY_UNIT, "any", OPTIONAL, NOT_NEGATIVE, NULL, 0, false, "how far it may be off, relative to expect, which it wants beside it"},
    {"measures.*.tolerance_is", SCENE_WORD, NULL, "relative", ANY, "relative|absolute", 0, true, "absolute: the tolerance is in the value's own unit"},
    {"measures.*.unit", SCENE_TEXT, NULL, "''", NONE, "SI unit of the value, as printed (default: that of expect); that of what is taken (a column's, s for times, m, rad, a field's), by that of relative_to if it has one, which a wrong one does not pass for; of plane bodies also by a metre (N/m)"},
    {"measures.*.source", SCENE_TEXT, NULL, "''", NONE, "where the expected value is from"},
};

const scene_rows brunt_scene_own_rows = {own_rows, sizeof own_rows / sizeof *own_rows};

const scene_section brunt_scene_sections[] = {
    {"scene", "brunt title dimension axisymmetric", "the file as a whole"},
    {"time", "time", NULL}, {"newton", "newton", NULL}, {"grid", "grid", NULL}, {"materials", "materials", NULL}, {"bodies", "bodies", NULL},
    {"detonations", "detonations", NULL},
    {"shapes", "<shape>", "of a body (shape), of a prescribed motion (region)"},
    {"contact", "contact", NULL}, {"boundaries", "boundaries", NULL}, {"loads", "loads", NULL},
    {"output", "output", NULL}, {"measures", "measures", NULL},
};
const int brunt_scene_section_count = sizeof brunt_scene_sections / sizeof *brunt_scene_sections;
// clang-format on

const scene_key *brunt_format_row(const scene_format *format, const char *path) {
    for (int i = 0; i < *format->row_count; i++)
        if (strcmp(format->rows[i].path, path) == 0) return &format->rows[i];
    return NULL;
}

const scene_key *brunt_scene_row(const char *path) { return brunt_format_row(&brunt_scene_format, path); }

const char *brunt_scene_child_key(const scene_key *row, const char *parent) {
    size_t length = strlen(parent);
    const char *key = row->path;
    if (length) {
        if (strncmp(row->path, parent, length) != 0 || row->path[length] != '.') return NULL;
        key += length + 1;
    } else if (row->path[0] == '<') {
        return NULL;
    }
    return strpbrk(key, ".[") || strcmp(key, "*") == 0 ? NULL : key;
}

const brunt_model *const *brunt_scene_models(const char *path, int *count) {
    static const brunt_model *const viscosity[] = {&brunt_bulk_viscosity};
    if (strncmp(path, "materials.*.eos.", 16) == 0) {
        *count = brunt_eos_model_count;
        return brunt_eos_models;
    }
    if (strncmp(path, "materials.*.viscosity.", 22) == 0) {
        *count = BRUNT_COUNT(viscosity);
        return viscosity;
    }
    if (strncmp(path, "materials.*.failure.", 20) == 0) {
        *count = brunt_failure_model_count;
        return brunt_failure_models;
    }
    *count = brunt_strength_model_count;
    return brunt_strength_models;
}

bool brunt_scene_word_or_map(const scene_key *row) {
    return strcmp(row->path, "grid.transfer") == 0 || strcmp(row->path, "grid.cells") == 0;
}

const brunt_model *brunt_scene_model(const char *path, const char *name) {
    if (strncmp(path, "materials.*.eos.", 16) == 0) return brunt_find_eos(name);
    if (strncmp(path, "materials.*.failure.", 20) == 0) return brunt_find_failure(name);
    return brunt_find_strength(name);
}

int brunt_scene_word_count(const char *words) {
    int count = words != NULL;
    for (const char *c = words; c && *c; c++) count += *c == '|';
    return count;
}

bool brunt_scene_word_at(const char *words, int index, char *out, size_t size) {
    const char *p = words;
    for (; p && index > 0; index--) {
        p = strchr(p, '|');
        if (p) p++;
    }
    if (!p) return false;
    snprintf(out, size, "%.*s", (int)strcspn(p, "|"), p);
    return true;
}

static bool same_word(const char *a, const char *b) {
    for (; *a && *b; a++, b++)
        if (*a != *b && !((*a == '-' || *a == '_') && (*b == '-' || *b == '_'))) return false;
    return *a == *b;
}

bool brunt_scene_word(const char *words, const char *word, int *index) {
    char candidate[64];
    for (int i = 0; brunt_scene_word_at(words, i, candidate, sizeof candidate); i++) {
        if (!same_word(candidate, word)) continue;
        *index = i;
        return true;
    }
    return false;
}
