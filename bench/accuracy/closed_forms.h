/// The parts of the scene `closed_forms`: experiments that each have a closed form (references: closed forms), on
/// cloth, balloons and what they slide on.
#pragma once

#include "accuracy_surface.h"

#include "balloon_scene.h"
#include "cloth/cloth.h"

#define CLOSED_GRAVITY 9.81

/// A setting while it runs, and what it showed.
typedef struct closed_run
{
    double first, second; ///< what the form says of itself: an angle, a time ...
    int parameter;        ///< substeps of a frame, or the fineness of a mesh
    int workers;
    bool is_looked_at;
    accuracy_run* out;
    double measured, reference; ///< SI
    double scale;               ///< what the error is a share of, if not of the reference; 0: of the reference
    double momentum_error;      ///< share; NaN: it is no part of this
    double strain;              ///< largest; NaN likewise
} closed_run;

typedef wisp_status closed_fn( closed_run* run, wisp_error* error );

closed_fn closed_fall;  ///< first: s. How far a cloth that was thrown falls
closed_fn closed_spin;  ///< first: s. Angular momentum that a spinning cloth in free flight keeps
closed_fn closed_plate; ///< first: s. Speed of a plate that falls broadside through air
closed_fn closed_slide; ///< first: degrees, second: mu. How far a cloth slides down an incline in 0.5 s
closed_fn
    closed_bar; ///< first: cells, second: substeps if the parameter is iterations. Length that a strip gains by its weight
closed_fn closed_catenary; ///< first: cells. Sag of an inextensible strip
closed_fn closed_elastica; ///< first: load G. Drop of a clamped strip that bends; parameter: cells
closed_fn closed_lift;     ///< buoyancy of a sphere of helium; parameter: level
closed_fn closed_sphere;   ///< pressure of a sphere stretched by first; parameter: level
closed_fn closed_emptying; ///< first: s. Gas that leaves through an outlet

/// Edge of the clamped strip's triangles, m.
double closed_strip_cell( int cells );
/// Edge of the sphere's mesh, m; 1 is its radius. Halves with each level.
double closed_sphere_edge( int level );

/// A cloth in a world of its own.
typedef struct closed_body
{
    wisp_mesh mesh; ///< made by the form
    wisp_fabric* fabric;
    surface_implementation implementation;
} closed_body;

/// A plane of the recipe's rows and columns about the origin.
wisp_status closed_make_plane( int columns, int rows, double spacing, closed_body* out, wisp_error* error );
/// The recipe of a run whose parameter is substeps. The fabric is filled in when it enters.
surface_generator closed_generator( const closed_run* run );
/// Cook the mesh and put it into a world as a cloth. Whatever fails, closed_leave() is to be called.
wisp_status closed_enter( const closed_run* run, surface_generator generator, const wisp_cloth_def* cloth,
                          closed_body* body, wisp_error* error );
/// Step, then take the hash; strain and quality if requested. @param quality may be null
wisp_status closed_advance( closed_run* run, closed_body* body, int steps, wisp_motion_stats* motion_stats,
                            wisp_error* error );
void closed_leave( closed_body* body );
