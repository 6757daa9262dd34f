/// The parts of the scene `closed_forms`: experiments with a closed form each, on cloth, balloons and planes.
#pragma once

#include "accuracy_surface.h"

#include "balloon_scene.h"
#include "cloth/cloth.h"

#define CLOSED_GRAVITY 9.81

/// A setting while it runs, and its results.
typedef struct closed_run
{
    double first, second; ///< parameters of the form: an angle, a time ...
    int parameter;        ///< substeps of a frame, or the fineness of a mesh
    int workers;
    bool is_observed;
    accuracy_run* out;
    double measured, reference; ///< SI
    double scale;               ///< the error is relative to this; 0: to the reference
    double momentum_error;      ///< relative; NaN: not measured
    double strain;              ///< largest; NaN: not measured
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

/// A cloth in its own world.
typedef struct closed_body
{
    wisp_mesh mesh; ///< made by the form
    wisp_fabric* fabric;
    surface_implementation implementation;
} closed_body;

/// Lay a strip of length 1 m and one row of cells in two straight halves between supports that are `span` m apart, along x.
void closed_lay_halves( const wisp_mesh* mesh, int cells, double span, wisp_vec3* out );
/// The recipe of a run whose parameter is substeps. The fabric is filled in when it enters.
surface_generator closed_generator( const closed_run* run );
/// Cook the mesh and add it to a world as a cloth. Call closed_leave() even after a failure.
wisp_status closed_enter( const closed_run* run, surface_generator generator, const wisp_cloth_def* cloth,
                          closed_body* body, wisp_error* error );
/// Step, then take the hash; strain and quality if requested. @param quality may be null
wisp_status closed_advance( closed_run* run, closed_body* body, int steps, wisp_motion_stats* motion_stats,
                            wisp_error* error );
void closed_leave( closed_body* body );
