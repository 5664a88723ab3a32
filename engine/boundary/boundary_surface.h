// Lines and surfaces anywhere in the grid of implicit material points, that hold what of them they reach.
//
// A line is cut into pieces of equal length, a surface into pieces of about equal area, each with one traction [Pa],
// which is an unknown of the step: the mean of the condition over the piece holds. Pieces are of the boundary, whatever
// the grid; shorter than about a cell they ask for more than the grid can give. A piece sees the grid by its boundary
// particles.
#pragma once

#include "base/messages.h"
#include "body/bodies.h"
#include "boundary/facets.h"
#include "boundary/tool.h"
#include "contact/planes/boundary.h"

typedef struct brunt_boundary_particle {
    double x[3], normal[3]; // [m] at the start; [-], of length 1
    double tangent[2][3];   // [-] across the normal and each other; the second of surfaces only
    double weight;          // [m^2] its part of the boundary, in plane strain [m]
    double back;            // [m] how far behind it the surface is once more, the other way round; INFINITY: it is not
    int32_t piece;
} brunt_boundary_particle;

// How a surface that turns does so over an implicit step.
typedef struct brunt_boundary_turned {
    brunt_placement now, then;         // at its start and its end
    double angle;                      // [rad] between
    double D[9], e[3];                 // a place x that goes with it goes by D x + e [m]
    brunt_boundary_particle *particle; // where and along what it asks (boundary_turn.c); NULL: it does not turn
    double (*goes)[3];                 // [m] their ways
    double low[3], high[3], farthest;  // [m] box around them, the longest of their ways
} brunt_boundary_turned;

// Of a plane that holds material points by pieces: those that there are.
typedef struct brunt_boundary_window {
    double piece;     // [m] edge of a piece
    int each;         // boundary particles along it; 0: it is no plane
    int32_t count[2]; // pieces along the tangents
    double at[2];     // the first of them, counted from the plane's point. They last
    double tangent[2][3];
} brunt_boundary_window;

// A material point that a surface meets in an explicit step.
typedef struct brunt_touching {
    int32_t constraint, particle; // of the set of the body; the boundary particle that is nearest
} brunt_touching;

typedef struct brunt_boundary_surface {
    brunt_boundary_surface_def def; // without points and facets, with a table of its own
    brunt_boundary *boundary;       // its name, and where its impulses are recorded
    brunt_boundary_particle *particle;
    int32_t particle_count, pieces;             // particles of a piece follow each other
    int32_t *first;                             // pieces + 1: of its particles
    double low[3], high[3], cell;               // [m] box around the particles; of the grid
    uint64_t *key;                              // the cells that have particles, ascending
    int32_t *cell_first, *cell_particle, cells; // the particles of each
    // Of each body of material points and piece: multipliers at the end of the last step [Pa], along the piece's
    // directions. They last.
    double *traction;
    int32_t bodies;
    brunt_boundary_turned turned;
    brunt_boundary_window window;
    // Of the last step.
    int32_t active; // pieces that hold something
    double drift;   // [m/s] greatest rate, as mean of a piece, at which what is held leaves its place
    // Of explicit steps.
    brunt_facets facets;
    brunt_tool tool;   // free, if it has a mass
    double lever;      // [m] farthest place of it from what it turns about
    double speed[3];   // [m/s] the first: the greatest that it ever has, of a free tool that it has
    double (*rate)[2]; // of each piece: sum of the rates at which its points leave [m/s], how many
    brunt_touching *touching;
    size_t touching_capacity;
    int32_t touching_count;
} brunt_boundary_surface;

typedef struct brunt_boundary_surfaces {
    brunt_boundary_surface *surface;
    int count;
    double (*frame)[9]; // of each body of material points: how its particles' own boxes were turned at the start
} brunt_boundary_surfaces;

// After the bodies are made; `boundaries`: all of them. Planes that hold by pieces follow the surfaces. BRUNT_OK, or
// what is wrong.
int brunt_boundary_surfaces_make(brunt_boundary_surfaces *surfaces, const brunt_world_def *def,
                                 const brunt_bodies *bodies, brunt_boundary *boundaries, brunt_error *error);
void brunt_boundary_surfaces_free(brunt_boundary_surfaces *surfaces);
// Aborts where pieces, particles and cells do not belong to each other, or a traction is no number.
void brunt_boundary_surfaces_validate(const brunt_boundary_surfaces *surfaces, const brunt_bodies *bodies);
size_t brunt_boundary_surfaces_bytes(const brunt_boundary_surfaces *surfaces);
// Components of its traction that are unknowns: all of stick, one of slip and of separate, all of that with friction.
int brunt_boundary_surface_rows(const brunt_boundary_surface *surface, int dim);
// The direction of a row of its traction at a boundary particle.
void brunt_boundary_surface_direction(const brunt_boundary_surface *surface, const brunt_boundary_particle *particle,
                                      int row, double out[3]);
// How far it has gone since the start [m]; where it is by then, if it turns as well.
void brunt_boundary_surface_way(const brunt_boundary_surface *surface, double time, double way[3]);
brunt_placement brunt_boundary_surface_place(const brunt_boundary_surface *surface, double time);
// The cell at these coordinates, counted from `low`; BRUNT_NONE: it has no particles.
int32_t brunt_boundary_surface_cell(const brunt_boundary_surface *surface, const int32_t at[3]);
// Whether it holds a body of material points.
bool brunt_boundary_surface_acts(const brunt_boundary_surface *surface, const brunt_body *body);
// A boundary particle as it is in the step: of what turns another one.
const brunt_boundary_particle *brunt_boundary_surface_particle(const brunt_boundary_surface *surface, int32_t b);
// What lasts from step to step.
int64_t brunt_boundary_surfaces_state_count(const brunt_boundary_surfaces *surfaces);
double *brunt_boundary_surfaces_state_get(const brunt_boundary_surfaces *surfaces, double *out);
const double *brunt_boundary_surfaces_state_set(brunt_boundary_surfaces *surfaces, const double *in);

// --- boundary_window.c: planes
// Definition, pieces and particles of a surface that has nothing but its boundary, a plane, and the cell. BRUNT_OK, or
// what is wrong.
int brunt_boundary_window_make(brunt_boundary_surface *surface, const brunt_bodies *bodies, int dim,
                               brunt_error *error);
// Before a step: the pieces there are go along with the bodies; nothing of what is no plane. BRUNT_OK, or BRUNT_FAILED:
// they have spread too far, or out of memory.
int brunt_boundary_window_follow(brunt_boundary_surface *surface, const brunt_bodies *bodies, int dim,
                                 brunt_error *error);
// Adds how far the pieces have gone on along the plane [m].
void brunt_boundary_window_way(const brunt_boundary_surface *surface, double way[3]);

// --- boundary_turn.c: implicit steps of a surface that turns
// Room for it, and how it is at the start of the run; nothing for what does not turn. BRUNT_OK, or BRUNT_FAILED: out of
// memory.
int brunt_boundary_turned_make(brunt_boundary_surface *surface, brunt_error *error);
void brunt_boundary_turned_free(brunt_boundary_turned *turned);
// As it goes within a step.
void brunt_boundary_surface_turn(brunt_boundary_surface *surface, double time, double dt);
// Whether by more than a quarter of a turn, which its particles' ways do not tell.
bool brunt_boundary_surface_turns_far(const brunt_boundary_surface *surface);
// The way of a place that goes with it [m]; where a place is on the surface as it was given.
void brunt_boundary_surface_goes(const brunt_boundary_surface *surface, const double x[3], double way[3]);
void brunt_boundary_surface_back(const brunt_boundary_surface *surface, const double x[3], double out[3]);
// What was kept of a piece's traction as it is where the step begins, and back from where it ends [Pa]; of what does
// not turn the same.
void brunt_boundary_surface_bring(const brunt_boundary_surface *surface, const double kept[3], double traction[3]);
void brunt_boundary_surface_keep(const brunt_boundary_surface *surface, const double traction[3], double kept[3]);

// --- surface_points.c: explicit steps
// The facets of a surface that has all else, and how fast it is at most. BRUNT_OK, or BRUNT_FAILED: out of memory.
int brunt_boundary_surface_points(brunt_boundary_surface *surface, const brunt_boundary_surface_def *def,
                                  const brunt_world_def *world, brunt_error *error);
// Takes the speed of a free tool as it is.
void brunt_boundary_surface_hurry(brunt_boundary_surface *surface);
// Before a step: nothing is held, gravity acts on free tools over `kick`; after it: they have gone their way.
void brunt_boundary_surfaces_open(brunt_boundary_surfaces *surfaces, const double gravity[3], double kick);
void brunt_boundary_surfaces_close(brunt_boundary_surfaces *surfaces, double dt);
// What a kind of boundary is asked for (contact/planes/boundary.h).
const double *brunt_boundary_surface_speed(const brunt_boundary *boundary);
int brunt_boundary_surface_meet(const brunt_contact_context *m, brunt_boundary *boundary, brunt_body *body,
                                brunt_particle_dofs *dofs, brunt_constraint_set *set, brunt_error *error);
void brunt_boundary_surface_met(const brunt_contact_context *m, brunt_boundary *boundary, const brunt_body *body,
                                const brunt_constraint_set *set);

// --- boundary_extent.c
// Where a body is within a step.
typedef struct brunt_boundary_bounds {
    double low[3], high[3]; // [m] of its points, at the start of the step and at its end
    double extent;          // [m] how far from there its points may meet something, at most
    int dim;
} brunt_boundary_bounds;

// When a body is looked at: how far the surface has gone, and how far it goes over the step [m], which takes dt [s]; of
// what turns 0, that is in `turned`.
typedef struct brunt_boundary_extent {
    double way[3], step[3], dt;
    const double *frame; // of the body
    const double *moved; // [m] how far each of its slots goes, all components; NULL: as far as its velocity takes it
} brunt_boundary_extent;
// How far the body is from each boundary particle, along its normal [m]: the own boxes of its material points reach it.
// 0 where they do; of a surface that they can leave also what they come to within the step; INFINITY elsewhere. `gap`
// holds the nearest so far, and INFINITY before the first body. Whether a material point goes through the surface
// within the step, by a way that is given, and ends where it is not pushed out any more.
bool brunt_boundary_surface_extent(const brunt_boundary_surface *surface, brunt_body *body,
                                   const brunt_boundary_extent *extent, double *gap);
// `moved` as above. Surfaces that are far from a body's bounds need not look at it.
void brunt_boundary_body_bounds(brunt_body *body, double dt, const double *moved, brunt_boundary_bounds *bounds);
bool brunt_boundary_surface_far(const brunt_boundary_surface *surface, const brunt_boundary_bounds *bounds,
                                const brunt_boundary_extent *extent);
// Finds how far behind the particles of a surface that lets go its other side is, if it is within a cell.
void brunt_boundary_surface_backs(brunt_boundary_surface *surface);
// Before the first step: whether a body that a surface lets go is behind it, where nothing could hold it, or on both of
// its sides, unless that `may_pass`. BRUNT_OK, or BRUNT_BAD_INPUT.
int brunt_boundary_surfaces_sides(const brunt_boundary_surfaces *surfaces, const brunt_bodies *bodies, bool may_pass,
                                  brunt_error *error);
