// brunt: explicit-dynamics contact engine. The public C interface.
//
// A world is made from a definition, stepped, read and destroyed. Definitions are plain structures: fill one with its
// default function first, so that a field added later keeps a sensible value. All quantities are SI. Nothing here
// prints or exits: what goes wrong comes back as a code and a brunt_error. Two worlds may live side by side.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BRUNT_VERSION "0.1.0"

// Numbers of a definition are at most so large [SI], so that their products are numbers as well; what must be above 0
// is at least so large, and nothing else but 0 is smaller than normal numbers are. INFINITY and NAN stand where it is
// said that they do.
#ifdef BRUNT_FLOAT
#define BRUNT_GREATEST_NUMBER 1e18
#define BRUNT_LEAST_NUMBER 1e-18
#define BRUNT_LEAST_NORMAL 1.2e-38
#else
#define BRUNT_GREATEST_NUMBER 1e30
#define BRUNT_LEAST_NUMBER 1e-30
#define BRUNT_LEAST_NORMAL 2.3e-308
#endif

// The engine is built for double or for float; the symbols differ, so that a mismatch fails to link.
#ifdef BRUNT_FLOAT
#define brunt_world_create brunt_world_create_float
#define brunt_world_step brunt_world_step_float
#endif

// ---------------------------------------------------------------------------------------------------- errors

enum { // also the exit codes of the program
    BRUNT_OK = 0,
    BRUNT_BAD_USAGE = 64, // command line
    BRUNT_BAD_INPUT = 65, // scene, mesh or checkpoint that is not acceptable
    BRUNT_FAILED = 70,    // the computation failed: body, id, place, time and reason say where and why
    BRUNT_IO_ERROR = 74,  // file system
    BRUNT_STOPPED = 75    // stopped by a signal; resume from the checkpoint
};

typedef struct brunt_error {
    int code;
    char message[1024]; // complete sentence, with the values that matter
    char body[64];      // for BRUNT_FAILED: body ...
    int64_t id;         // ... particle id (-1: none) ...
    double place[3];    // [m]
    double time;        // [s]
} brunt_error;

// ---------------------------------------------------------------------------------------------------- shapes

typedef enum brunt_shape_kind {
    BRUNT_BOX,        // min, max
    BRUNT_SPHERE,     // center, radius (a disk in two dimensions)
    BRUNT_CYLINDER,   // center of one end, axis, radius, length
    BRUNT_RING,       // like cylinder with inner_radius; in two dimensions an annulus (center, inner_radius, radius)
    BRUNT_PRISM,      // polygon (counter-clockwise or clockwise, in the x-y plane) between min[2] and max[2]; 2D: the
                      // polygon
    BRUNT_HALF_SPACE, // center: a point of the plane; axis: normal pointing out of the material
    BRUNT_UNION,
    BRUNT_DIFFERENCE,
    BRUNT_INTERSECTION // of the children; difference: the first less all others
} brunt_shape_kind;

typedef struct brunt_shape {
    brunt_shape_kind kind;
    double min[3], max[3];               // [m]
    double center[3], axis[3];           // [m], [-] (any length but 0)
    double radius, inner_radius, length; // [m]
    double (*points)[2];
    int32_t point_count; // owned
    struct brunt_shape *children;
    int32_t child_count; // owned
} brunt_shape;

// A rigid motion x -> rotation x + translation. Filled with the identity by brunt_placement_identity.
typedef struct brunt_placement {
    double rotation[9];
    double translation[3];
} brunt_placement;

brunt_placement brunt_placement_identity(void);
// Follow `first` by a shift [m], or by a turn of `angle` [rad] about the line through `about` along `axis`;
// an axis without direction gives NANs, which brunt_world_create refuses.
brunt_placement brunt_placement_translate(brunt_placement first, const double by[3]);
brunt_placement brunt_placement_rotate(brunt_placement first, const double axis[3], double angle,
                                       const double about[3]);

// Signed distance [m] of a point to the shape's surface, negative inside. Exact for primitives and outside corners of
// unions; a lower bound of its size inside differences and intersections.
double brunt_shape_distance(const brunt_shape *shape, int dimension, const double point[3]);
// Axis-aligned bounds [m]; false when the shape is unbounded (a half-space not cut by anything) or empty.
bool brunt_shape_bounds(const brunt_shape *shape, int dimension, double min[3], double max[3]);
void brunt_shape_free(brunt_shape *shape); // frees what the shape owns, not the shape itself

// ---------------------------------------------------------------------------------------------------- meshes

enum { BRUNT_NAME_LENGTH = 48, BRUNT_PARAMETER_LIMIT = 24 };

// Linear elements with one integration point, nodes in the order of VTK. Two-dimensional ones are in plane strain;
// those of membranes are sheets in three dimensions, in plane stress.
typedef enum brunt_element_kind {
    BRUNT_TET4,
    BRUNT_HEX8,
    BRUNT_TRI3,
    BRUNT_QUAD4,
    BRUNT_MEMBRANE_QUAD4,
    BRUNT_MEMBRANE_TRI3,
    BRUNT_ELEMENT_KINDS // how many
} brunt_element_kind;
enum { BRUNT_ELEMENT_NODES = 8 };                        // that an element has at most
const char *brunt_element_name(brunt_element_kind kind); // "tet4", "membrane_quad4", ...; "unknown"
int brunt_element_nodes(brunt_element_kind kind);        // this and the next are 0 of what is no kind
int brunt_element_dimension(brunt_element_kind kind);    // of the room its nodes are in: 3 for membranes
bool brunt_element_is_membrane(brunt_element_kind kind); // of membranes

// Nodes with a name: a boundary acts on them, and on the faces whose nodes are all among them.
typedef struct brunt_group {
    char name[BRUNT_NAME_LENGTH];
    int32_t *nodes, count;
} brunt_group; // ascending; owned by the mesh

typedef struct brunt_mesh {
    brunt_element_kind kind; // all elements are of one kind
    int32_t node_count;
    double (*nodes)[3];               // [m]; the third is 0 in two dimensions
    int32_t element_count, *elements; // brunt_element_nodes(kind) node numbers each, from 0
    brunt_group *groups;
    int32_t group_count;
} brunt_mesh;

// A function of time (or place): linear between points, held constant before the first and after the last; no points: 1
// always.
typedef struct brunt_curve {
    double (*points)[2];
    int32_t count;
} brunt_curve; // [s] (or [m]), [-]; ascending

// A structured mesh of a shape (not placed) with edges of about `size` [m]: box, sphere, cylinder, ring, prism with
// four corners; in two dimensions box, disk, annulus, quadrilateral. Boundary groups by shape: box xmin xmax ymin ymax
// zmin zmax; cylinder and ring start end side (ring: inner outer); prism side1 ... side4 (from corner i to the next)
// zmin zmax; sphere none; and `surface` for all. Intersections of one sphere (disk), cylinder or ring with boxes, or
// half-spaces along the axes, are its halves, quarters and eighths: cut through its centre along x, y, z, or across its
// axis (cuts may miss it, too); nodes lie exactly on the cuts, which are the groups xmin xmax ymin ymax zmin zmax.
// Intersections of boxes are boxes. BRUNT_BAD_INPUT for shapes that have no such mesh (union, difference, ...).
int brunt_mesh_shape(const brunt_shape *shape, int dimension, brunt_element_kind kind, double size, brunt_mesh *mesh,
                     brunt_error *error);
// The same of a box whose elements grow along the axes: grading[a] is the factor on `size` along axis a, over the
// coordinate [m].
int brunt_mesh_graded(const brunt_shape *box, int dimension, brunt_element_kind kind, double size,
                      const brunt_curve grading[3], brunt_mesh *mesh, brunt_error *error);
// The surface of such a mesh in three dimensions, as sheets (a membrane kind), seen counter-clockwise from outside: all
// of it, or the faces in the named boundary groups. Groups are kept, with the nodes that are left; `border` is added
// where the surface is open: the nodes of edges that only one element has. A flat sheet is one face of a box, a disk
// the start of a cylinder.
int brunt_mesh_surface(const brunt_shape *shape, brunt_element_kind kind, double size,
                       const char (*faces)[BRUNT_NAME_LENGTH], int32_t face_count, brunt_mesh *mesh,
                       brunt_error *error);

typedef struct brunt_mesh_quality {
    int32_t inverted, degenerate, duplicate_elements, duplicate_nodes, unreferenced; // how many ...
    int32_t first[5];                   // ... and the first of each (element or node number from 0), -1
    double volume, smallest, largest;   // [m^3] in all, of an element; 2D [m^2]
    double shortest_edge, longest_edge; // [m]
    double worst_shape;                 // [-] 1 for the regular element, 0 for a flat one (the least scaled Jacobian)
    int32_t worst;                      // element with it
} brunt_mesh_quality;
// Looks a mesh over. BRUNT_BAD_INPUT and a message with element numbers (from 1) when it cannot be computed with:
// inverted or flat elements, elements given twice. Duplicate (same place) and unreferenced nodes are only counted.
int brunt_mesh_check(const brunt_mesh *mesh, brunt_mesh_quality *quality, brunt_error *error);
void brunt_mesh_free(brunt_mesh *mesh); // what the mesh owns, not the mesh itself

// ---------------------------------------------------------------------------------------------------- definitions

// What becomes of material that a failure model has declared failed.
typedef enum brunt_failure_action {
    BRUNT_FAILURE_ERODE, // its element or material point leaves the body (default)
    BRUNT_FAILURE_SOFTEN // it stays, without strength and without tension; needs an equation of state
} brunt_failure_action;

typedef struct brunt_material_def {
    char name[BRUNT_NAME_LENGTH];
    double density;                                    // [kg/m^3] > 0
    char strength[BRUNT_NAME_LENGTH];                  // model name; `brunt keys materials` lists them
    double strength_parameters[BRUNT_PARAMETER_LIMIT]; // in the order of the model's parameter table
    char eos[BRUNT_NAME_LENGTH];                       // "" = none
    double eos_parameters[BRUNT_PARAMETER_LIMIT];
    bool bulk_viscosity;
    double viscosity_parameters[BRUNT_PARAMETER_LIMIT];
    char failure[BRUNT_NAME_LENGTH];                  // "" = none
    double failure_parameters[BRUNT_PARAMETER_LIMIT]; // NAN: of the strength model's parameter of the same name
    brunt_failure_action failure_action;
} brunt_material_def;

typedef enum brunt_method { BRUNT_MPM, BRUNT_FEM, BRUNT_MEMBRANE } brunt_method;
// Control of the zero-energy modes of one-point elements (Flanagan and Belytschko 1981), by a spring or a damper.
typedef enum brunt_hourglass { BRUNT_HOURGLASS_STIFFNESS, BRUNT_HOURGLASS_VISCOUS } brunt_hourglass;

// What takes elements or material points out of a body besides failure of its material, and what becomes of their mass.
typedef struct brunt_erosion_def {
    double strain; // [-] > 0: those whose equivalent total strain reaches it go (LS-DYNA's effective strain: sqrt(2/3
                   // e:e) of the deviator of the logarithmic strain); default INFINITY
    double step;   // [s] elements whose stable step falls below it go; default 0
    bool inverted; // those that turn inside out go; default false: an error that stops the run
    bool keep;     // what they were made of stays: nodes that no element has left go on as free particles in contact,
                   // material points as points without stress; default false: mass and momentum leave the world
} brunt_erosion_def;

typedef enum brunt_fill { BRUNT_FILL_REGULAR, BRUNT_FILL_JITTERED } brunt_fill;

typedef struct brunt_body_def {
    char name[BRUNT_NAME_LENGTH]; // unique; bodies are ordered by name, so the order in a file changes nothing
    int32_t material;             // index into the world's materials
    brunt_shape shape;            // owned by the definition
    brunt_placement place;
    brunt_method method; // default BRUNT_MPM
    // BRUNT_FEM and BRUNT_MEMBRANE: a given mesh, or one made of the shape (of its surface).
    brunt_mesh mesh;            // owned by the definition; node_count 0: made of the shape
    brunt_element_kind element; // of a mesh made of the shape
    double size;                // [m] edge length of a mesh made of the shape
    brunt_curve grading[3];     // of a box: factor on it along x, y, z, over the coordinate; owned by the definition
    brunt_hourglass hourglass;
    double hourglass_coefficient; // [-] 0..1; default 0.05 (stiffness) / 0.1 (viscous) as NAN; of lambda + 2 mu, but at
                                  // most of 7 mu
    brunt_erosion_def erosion;
    bool total_lagrangian; // BRUNT_MPM: kernels live in the undeformed configuration: no numerical fracture, however
                           // far it is stretched; contact with meshes and planes only; default false
    double mass_scaling;   // [s] elements whose stable step is less get density until it is not; 0 = none
    double damping;        // [1/s] >= 0: a force of -damping m v on each node; default 0
    // BRUNT_MEMBRANE
    double thickness;         // [m] > 0, of the undeformed sheet
    double contact_thickness; // [m] >= 0: contact keeps its middle surface half of it from others; NAN (default):
                              // thickness
    bool slack;               // bears no compression (tension field) instead of what its material says
    char (*faces)[BRUNT_NAME_LENGTH];
    int32_t face_count; // owned; groups of the shape's boundary to take, 0: all of it
    // Particles sit on a lattice fixed to the unplaced shape's bounding box, then move with the placement.
    int32_t particles_per_cell; // 2D: a square number, 3D: a cube; default 4 / 8
    double spacing;             // [m] lattice spacing; 0 = cell / (particles_per_cell)^(1/dimension)
    brunt_fill fill;
    double jitter; // [-] of the spacing, 0..0.5, for BRUNT_FILL_JITTERED
    uint64_t seed;
    double velocity[3];                // [m/s]
    double spin[3];                    // [rad/s] angular velocity about spin_about
    double spin_about[3];              // [m]
    double wave_velocity[3];           // [m/s] added as wave_velocity * sin(wave_vector . x + wave_phase)
    double wave_vector[3], wave_phase; // [1/m], [rad]
    double temperature;                // [K] initial, for thermal materials; default 293.15
} brunt_body_def;

typedef enum brunt_condition {
    BRUNT_STICK,    // all components follow the plane
    BRUNT_SLIP,     // normal component follows the plane, tangential free, never lets go
    BRUNT_SEPARATE, // like slip in compression, lets go in tension; with friction > 0 a Coulomb wall
    BRUNT_SYMMETRY  // mirror plane: axis-aligned and on a grid line
} brunt_condition;

typedef struct brunt_plane_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "plane1", ...
    double point[3], normal[3];   // [m], [-] pointing into the room the bodies are in
    brunt_condition condition;
    double friction;              // [-] Coulomb coefficient >= 0, for BRUNT_SEPARATE
    double velocity[3];           // [m/s] of a moving wall
    char body[BRUNT_NAME_LENGTH]; // the one body it acts on; "" = all
} brunt_plane_def;

// Grid nodes inside a region are given a velocity.
typedef struct brunt_region_def {
    char name[BRUNT_NAME_LENGTH];
    brunt_shape shape;
    brunt_placement place;        // owned by the definition
    bool component[3];            // which components are prescribed
    double velocity[3];           // [m/s]
    double start, end;            // [s] active in start <= t < end
    char body[BRUNT_NAME_LENGTH]; // "" = all
} brunt_region_def;

// Nodes of a finite-element body that are held, moved or loaded.
typedef enum brunt_group_action {
    BRUNT_GROUP_VELOCITY,     // components of `value` times the table are the velocity [m/s]; fixed: value 0
    BRUNT_GROUP_DISPLACEMENT, // ... are the displacement since the start [m]
    BRUNT_GROUP_TRACTION,     // value [Pa] times the table acts on the undeformed area of the group's faces
    BRUNT_GROUP_PRESSURE,     // value[0] [Pa] times the table acts against the outward normal of the deformed faces
    BRUNT_GROUP_GAS // the pressure of gas that the group's faces enclose, less that outside, acts along their normal
} brunt_group_action;
// Ideal gas of one pressure and temperature in an enclosed volume V: p = (gamma - 1) E / V, dE = -p dV + inflow dt.
typedef struct brunt_gas_def {
    double gamma;    // [-] > 1, ratio of specific heats; default 1.4
    double pressure; // [Pa] >= 0 at the start, absolute
    double outside;  // [Pa] >= 0, default 0
    double volume;   // [m^3] >= 0 of gas beside what the faces enclose (pipes, a vessel); default 0
    double inflow;   // [W] times the table: enthalpy that flows in; default 0
} brunt_gas_def;
typedef struct brunt_group_def {
    char name[BRUNT_NAME_LENGTH]; // of its column in the history; "" = "group1", ...
    char body[BRUNT_NAME_LENGTH], group[BRUNT_NAME_LENGTH];
    brunt_group_action action;
    bool component[3]; // velocity, displacement: which are prescribed
    double value[3];
    brunt_curve table; // owned by the definition
    brunt_gas_def gas;
} brunt_group_def;

// Where and when explosives are lit: at a point, or on a plane. Material at distance d burns from time + d / detonation
// speed on.
typedef struct brunt_detonation_def {
    double point[3], normal[3];   // [m]; [-] of a plane, 0: a point
    double time;                  // [s]
    char body[BRUNT_NAME_LENGTH]; // "" = all explosives
} brunt_detonation_def;

typedef enum brunt_kernel { BRUNT_LINEAR = 1, BRUNT_QUADRATIC = 2, BRUNT_CUBIC = 3 } brunt_kernel;
typedef enum brunt_transfer { BRUNT_PIC, BRUNT_FLIP, BRUNT_APIC } brunt_transfer;

// Tied: bodies of material points share one velocity field at the grid nodes that both reach, in both directions: they
// neither part nor slide (what material-point codes without contact do).
typedef enum brunt_contact_method {
    BRUNT_CONTACT_NONE,
    BRUNT_CONTACT_MULTI_VELOCITY,
    BRUNT_CONTACT_AUGURY,
    BRUNT_CONTACT_TIED
} brunt_contact_method;
// How augury makes the velocity that opposing bodies are to have where they meet.
typedef enum brunt_augury_form {
    BRUNT_AUGURY_AFFINE,  // velocity and gap from the same facing facet, extended affinely; reaction by the transpose
    BRUNT_AUGURY_SMOOTH,  // the same from facets averaged on the grid
    BRUNT_AUGURY_SURFACE, // velocities averaged on the grid, gap to the averaged facing surface
    BRUNT_AUGURY_PAPER    // grid transfers and augury iterations as published
} brunt_augury_form;

// Of two bodies; with both names the same, of a membrane with itself, which is not in contact unless it is asked for.
typedef struct brunt_pair_def {
    char a[BRUNT_NAME_LENGTH], b[BRUNT_NAME_LENGTH];
    brunt_contact_method method;
    double friction;
} brunt_pair_def;

typedef struct brunt_contact_def {
    brunt_contact_method method; // default: multi-velocity
    double friction;             // [-] >= 0
    brunt_augury_form form;      // of augury; default affine
    int iterations;   // most sweeps of a step, or N of the paper form; -1 = the method's own: augury 16 (64 where
                      // there are membranes), 4, 4, 1 by form; multi-velocity of a mesh with material points 8
    double tolerance; // [-] 0..1 (not 1): sweeps end when the greatest correction of one is no more than this share of
                      // the first one's; 0: when nothing changes, or by `iterations`; of form affine; default 0.01
    double cell;      // [m] of the contact grid; 0 = the mean surface edge (paper: twice that)
    brunt_transfer transfer; // of the paper form: BRUNT_PIC or BRUNT_APIC (default)
    bool allow_overlap; // accept bodies that overlap at the start (meshes: by more than a fifth of an edge), or lie
                        // behind a plane of condition separate; default false: an error
    brunt_pair_def *pairs;
    int32_t pair_count; // owned; overrides
} brunt_contact_def;

typedef struct brunt_world_def {
    int cookie;        // set by brunt_world_def_default
    int dimension;     // 3, or 2 = plane strain of unit thickness
    bool axisymmetric; // with dimension 2: x is the distance r >= 0 from the axis of revolution, y along it; bodies are
                       // whole rings: masses, forces and energies are those of the full circle; default false
    double cell;       // [m] > 0
    double origin[3];  // [m] where a grid node lies; default 0
    brunt_kernel kernel;     // default quadratic
    brunt_transfer transfer; // default APIC
    double flip;             // [-] for FLIP: share of the particle's own velocity kept, 0..1; default 0.99
    double cfl;          // [-] 0..1, of the stable step; default 0: with material points brunt_default_cfl, without 0.5
    double step;         // [s] fixed time step, 0 = from cfl
    double least_step;   // [s] the run stops, with the reason, when the stable step falls below it; default 0:
                         // when steps that follow it fall below a millionth of the greatest so far
    double end;          // [s] the step that would pass it is cut to end on it
    double energy_limit; // [-] of the energy `reference` (see brunt_energy); default 0.1; INFINITY = none
    int threads;         // 0 = all there are
    brunt_material_def *materials;
    int32_t material_count; // owned
    brunt_body_def *bodies;
    int32_t body_count; // owned
    brunt_plane_def *planes;
    int32_t plane_count; // owned
    brunt_region_def *regions;
    int32_t region_count; // owned
    brunt_group_def *groups;
    int32_t group_count; // owned
    brunt_detonation_def *detonations;
    int32_t detonation_count; // owned
    brunt_contact_def contact;
    double gravity[3];   // [m/s^2]
    double gravity_ramp; // [s] gravity grows linearly from 0 over this time; default 0
} brunt_world_def;

brunt_world_def brunt_world_def_default(void);
// The share of the stable step that is taken when none is given: 0.5, or less where material points alone in their
// cells would gain energy: 0.4 in three dimensions with the quadratic kernel and PIC or FLIP.
double brunt_default_cfl(int dimension, brunt_kernel kernel, brunt_transfer transfer);
brunt_body_def brunt_body_def_default(void);
brunt_plane_def brunt_plane_def_default(void);
brunt_region_def brunt_region_def_default(void);
brunt_group_def brunt_group_def_default(void);
// A material of a strength model, by name, with the model's defaults; parameters without one are NAN and must be set.
// An unknown model is refused by brunt_material_set and brunt_world_create.
brunt_material_def brunt_material_def_default(const char *name, const char *model);
// A material from the library, by name: `brunt keys presets` lists them with their sources. BRUNT_BAD_INPUT when there
// is none.
int brunt_material_preset(const char *preset, const char *name, brunt_material_def *def, brunt_error *error);
typedef struct brunt_preset_info {
    const char *name, *doc, *source;
} brunt_preset_info;
int32_t brunt_preset_count(void);
brunt_preset_info brunt_preset(int32_t index);
// Sets "density" or a parameter of the strength model by its key; "eos.<key>", "viscosity.<key>" and "failure.<key>"
// set those of the equation of state, the bulk viscosity and the failure model, and "eos", "failure" with the name as
// `text` (else NULL) and "viscosity" switch them on with their defaults; "failure.action" takes "erode" or "soften" as
// `text`. SI units. BRUNT_BAD_INPUT when there is no such key.
int brunt_material_set(brunt_material_def *def, const char *key, double value, const char *text, brunt_error *error);
// Zeroed memory for the arrays and shapes a definition owns, so that brunt_world_def_free can free them. NULL: out of
// memory.
void *brunt_def_alloc(size_t bytes);
void brunt_world_def_free(brunt_world_def *def); // frees all that the definition owns

// ---------------------------------------------------------------------------------------------------- the world

// Time is integrated by central differences, for all bodies: places, stress and stored energy are those of the world's
// time, velocities, momenta, kinetic energy, work and impulses those of the middle of the last step, up to which forces
// have acted; a force is an impulse over the time it acted, the mean of the steps before and after. Thrown bodies are
// at g t^2 / 2 exactly, with velocities g (t - dt / 2).
typedef struct brunt_world brunt_world;

// Fills the bodies and makes the plan. NULL and an error (BRUNT_BAD_INPUT) when the definition cannot be run, whatever
// is wrong with it: numbers, enumerators, counts and names in it are looked at first. The functions below want a world
// that has been made, and indices that are there.
brunt_world *brunt_world_create(const brunt_world_def *def, brunt_error *error);
void brunt_world_destroy(brunt_world *world);

// One time step. BRUNT_OK, or BRUNT_FAILED with where and why; the world then is as the failing step left it, to be
// looked at. `limit` [s]: a time that must be hit exactly (an output time), INFINITY for none.
int brunt_world_step(brunt_world *world, double limit, brunt_error *error);

double brunt_world_time(const brunt_world *world); // [s]
double brunt_world_end(const brunt_world *world);  // [s]
int64_t brunt_world_steps(const brunt_world *world);
double brunt_world_dt(const brunt_world *world); // [s] of the last step, or the first one to come
double brunt_world_dt_min(const brunt_world *world);
double brunt_world_dt_max(const brunt_world *world);
int brunt_world_dimension(const brunt_world *world);
int brunt_world_threads(const brunt_world *world);
int64_t brunt_world_particles(const brunt_world *world);
int64_t brunt_world_nodes(const brunt_world *world); // grid nodes alive in the last step, and nodes of meshes
int64_t brunt_world_elements(const brunt_world *world);

typedef struct brunt_energy { // [J]; in 2D per metre of thickness
    double kinetic;           // with the affine part of APIC; as velocities, of the middle of the last step
    double internal;          // stored
    double plastic, hourglass, contact, friction, viscosity, transfer,
        eroded;           // taken out, each by its cause; damping is viscosity;
                          // eroded: kinetic and stored energy that left with elements, nodes and material points
    double heat;          // of plastic: what has warmed the material; a part, no term of the sum
    double external_work; // done on the bodies by gravity, walls and prescribed motion
    double initial;       // kinetic + internal at the start
    double total;         // kinetic + internal + all that was taken out
    double error;         // total - initial - external_work
    double reference; // the most by now of: initial; initial + external_work; the work of each cause, summed by amount.
                      // What the run has (kinetic + internal) where that is more, up to ten times it. At least what
                      // rounding does
    double error_relative; // error / reference
} brunt_energy;

typedef struct brunt_momentum {
    double linear[3];  // [kg m/s]
    double angular[3]; // [kg m^2/s] about the origin, with the spin of APIC; 2D: the third component
    double linear_impulse[3], angular_impulse[3]; // external, so far, with what erosion took away (negative)
    double linear_drift, angular_drift;           // relative change since the start, external impulses taken off
    double linear_initial[3], angular_initial[3];
} brunt_momentum;

void brunt_world_energy(brunt_world *world, brunt_energy *energy);
void brunt_world_momentum(brunt_world *world, brunt_momentum *momentum);
// Hash of every state bit of every particle, independent of the order they lie in memory.
uint64_t brunt_world_hash(const brunt_world *world);

// Bodies, in order of name.
int32_t brunt_body_count(const brunt_world *world);
const char *brunt_body_name(const brunt_world *world, int32_t body);
const char *brunt_body_material(const brunt_world *world, int32_t body);
brunt_method brunt_body_method(const brunt_world *world, int32_t body);
int64_t brunt_body_particles(const brunt_world *world, int32_t body); // 0 of a finite-element body
int64_t brunt_body_nodes(const brunt_world *world, int32_t body);     // 0 of material points
int64_t brunt_body_elements(const brunt_world *world, int32_t body);
brunt_element_kind brunt_body_element(const brunt_world *world, int32_t body);
// brunt_element_nodes(kind) node numbers of every element, nodes numbered as in the mesh, elements in its order. Of a
// body that erodes, of the elements that are left: the field "element" says which those are. Nodes stay, with those
// that have left.
void brunt_body_connectivity(const brunt_world *world, int32_t body, int32_t *out);
typedef struct brunt_mesh_report {
    brunt_mesh_quality quality;
    double least_step, added_mass;
    int32_t scaled_elements;
} brunt_mesh_report;
// How good the mesh of a finite-element body is, and what mass scaling added [kg].
void brunt_body_mesh(const brunt_world *world, int32_t body, brunt_mesh_report *report);
typedef struct brunt_body_sums {
    double mass, momentum[3], centre[3], velocity[3], kinetic, internal, plastic;
    double low[3], high[3]; // [m] bounds of its nodes, or of its particles' centres
} brunt_body_sums;
void brunt_body_totals(brunt_world *world, int32_t body, brunt_body_sums *sums);

// What has left a body, or been freed of stress, since the start.
typedef struct brunt_eroded {
    int64_t elements, particles,
        nodes; // eroded elements and material points, nodes that left (or went on free, with `keep`)
    double mass, momentum[3], angular[3],
        energy; // that left the world [kg], [kg m/s], [kg m^2/s] about the origin, [J]
    int64_t failed, strained, short_step, inverted; // elements and points by cause
} brunt_eroded;
void brunt_body_eroded(const brunt_world *world, int32_t body, brunt_eroded *eroded);

// What can be read of a body, at its particles, or at its nodes and its elements: stored and derived fields alike
// ("velocity", "stress" = Cauchy, "pressure", "von_mises", "density", "plastic_strain", "temperature", "J", "volume",
// "id", ...).
typedef enum brunt_place { BRUNT_AT_PARTICLES, BRUNT_AT_NODES, BRUNT_AT_ELEMENTS } brunt_place;
typedef struct brunt_field_info {
    const char *name, *unit;
    int components;
    bool symmetric;
    brunt_place at;
} brunt_field_info;
int32_t brunt_body_field_count(const brunt_world *world, int32_t body);
brunt_field_info brunt_body_field(const brunt_world *world, int32_t body, int32_t field);
// -1 when the body has no such field.
int32_t brunt_body_find_field(const brunt_world *world, int32_t body, const char *name);
int64_t brunt_body_size(const brunt_world *world, int32_t body, brunt_place at); // particles, nodes or elements
// Writes brunt_body_size(at) x components doubles in the order of the ids (0 .. count-1 within the body). Vectors
// always have 3 components, symmetric tensors 6 (XX YY ZZ XY YZ XZ), matrices 9, whatever the dimension.
void brunt_body_read(brunt_world *world, int32_t body, int32_t field, double *out);

// Warnings about the scene: found when the world was made (contact grids too fine or too coarse, doubtful meshes), or
// in a step (fluids that have spread until cells are empty between their particles).
int32_t brunt_warning_count(const brunt_world *world);
const char *brunt_world_warning(const brunt_world *world, int32_t warning);

// Contact pairs and walls: force averaged over the last step [N] and impulse since the start [N s], on `b` / on the
// bodies.
typedef struct brunt_force {
    char name[2 * BRUNT_NAME_LENGTH + 2];
    double force[3], impulse[3];
    double normal_work, friction_work;
    double area; // [m^2] that touched in the last step; in plane strain [m]
} brunt_force;
// Scenes with more than 64 pairs have them all in one, named "all".
int32_t brunt_pair_count(const brunt_world *world);
void brunt_pair_force(const brunt_world *world, int32_t pair, brunt_force *force); // name "a-b", force on b
int32_t brunt_wall_count(const brunt_world *world);                                // planes, regions, then groups
void brunt_wall_force(const brunt_world *world, int32_t wall, brunt_force *force); // force on the bodies

// Gas in enclosed volumes.
typedef struct brunt_gas {
    char name[BRUNT_NAME_LENGTH];    // of its boundary
    double volume, pressure, energy; // [m^3], [Pa] absolute, [J]
    double inflow;                   // [J] so far
} brunt_gas;
int32_t brunt_gas_count(const brunt_world *world);
void brunt_world_gas(const brunt_world *world, int32_t index, brunt_gas *gas);

// ---------------------------------------------------------------------------------------------------- plan, profile,
// state

typedef struct brunt_effect {
    const char *name;
    bool on;
    const char *because;
} brunt_effect; // because: the key or the material model that asked for it
int32_t brunt_effect_count(const brunt_world *world);
brunt_effect brunt_world_effect(const brunt_world *world, int32_t effect);

// What a pass has cost so far. `units`: particles, nodes or elements it has gone over, all steps together; bytes and
// flops per unit are counted from the arrays and the arithmetic of its kernels (engine/scheme/work.c), 0 where they
// depend on what meets what.
typedef struct brunt_pass {
    const char *name;
    int64_t calls;
    double seconds;
    double thread_seconds[64];
    const char *unit;
    double units, bytes_per_unit, flops_per_unit;
} brunt_pass;
int32_t brunt_pass_count(const brunt_world *world);
brunt_pass brunt_world_pass(const brunt_world *world, int32_t pass); // passes the plan runs each step, in order
double brunt_world_step_seconds(
    const brunt_world *world); // [s] of the clock in brunt_world_step so far; the passes are its parts

// Told when a pass begins and ends and which thread worked when, by the thread that takes the step. `pass` counts as in
// brunt_world_pass; times are of the monotonic clock [s]. Any of the functions may be NULL. They must not touch the
// world.
typedef struct brunt_observer {
    void *context;
    void (*begin)(void *context, int32_t pass, double time);
    void (*thread)(void *context, int32_t pass, int32_t thread, double begin,
                   double end); // one parallel phase of the pass, after it; before `end`
    void (*end)(void *context, int32_t pass, double begin, double end);
} brunt_observer;
void brunt_world_observe(brunt_world *world, const brunt_observer *observer); // copied; NULL: none (default)

typedef struct brunt_array {
    char name[96];
    const char *unit;
    int components;
    size_t bytes;
} brunt_array;
int32_t brunt_array_count(const brunt_world *world);
brunt_array brunt_world_array(const brunt_world *world, int32_t array); // every array that grows with the scene

// All that a run needs to go on with the same bits, as named blocks of bytes: a checkpoint stores them, restore brings
// them back.
typedef struct brunt_state_block {
    char name[96]; // "bodies/rod/velocity", "world/ledger"
    char type;     // 'd' double, 'f' float, 'i' int64, 'b' bytes
    int64_t count; // elements
} brunt_state_block;
//
// At any moment brunt_state_get writes the `count` elements that brunt_state_info says then, and every set keeps what
// it does not name. The blocks of a body of particles list the same particles in the same order; only setting its ids
// (or the elements of a mesh that erodes) may change how many there are, so what it holds comes first: after fewer ids
// the first particles are left, after more the new ones are all 0. A set that is refused changes nothing. After ids,
// elements or a block "world/...", brunt_state_done must be called before the next step; after other fields alone it
// need not be.
int32_t brunt_state_count(brunt_world *world);
brunt_state_block brunt_state_info(brunt_world *world,
                                   int32_t block);                  // no name and no elements: there is no such block
void brunt_state_get(brunt_world *world, int32_t block, void *out); // `count` elements
int brunt_state_set(brunt_world *world, int32_t block, const void *in, int64_t count, brunt_error *error);
// Call after the last brunt_state_set: sorts and checks.
int brunt_state_done(brunt_world *world, brunt_error *error);

#ifdef __cplusplus
}
#endif
