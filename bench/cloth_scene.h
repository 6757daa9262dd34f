/// The hanging cloth of the measurements of other engines: n x n vertices 0.05 m apart, horizontal at the start, two
/// corners of one side pinned, every edge a distance, every interior edge a link between its opposite vertices.
#pragma once

#include "plain/cloth_plain.h"
#include "surface_scenario.h"

#include "cloth/cloth.h"

#define CLOTH_SPACING 0.05f
#define CLOTH_BEND_STIFFNESS 0.2f
#define CLOTH_GRAVITY 9.81f
#define CLOTH_STEP ( 1.0f / 60.0f )

typedef struct cloth_scene
{
    int n;
    wisp_mesh mesh;
    int32_t pins[2];
} cloth_scene;

/// @param is_irregular shifted at random and Delaunay, else with alternating diagonals
wisp_status cloth_scene_make( int n, bool is_irregular, cloth_scene* out, wisp_error* error );
void cloth_scene_free( cloth_scene* scene );

/// A solver setting.
typedef struct cloth_setting
{
    int substeps, iterations;
} cloth_setting;

wisp_status cloth_cook( const cloth_scene* scene, wisp_fabric** out, wisp_error* error );
wisp_status cloth_implementation_create( const cloth_scene* scene, wisp_fabric* fabric, const cloth_setting* setting,
                                         int workers, surface_implementation* out, wisp_error* error );

// ---- the same cloth in double precision ----

/// Links in the order of the fabric, one after another: the engine's computation without its lanes, tiles and
/// roundings. It is the reference of one step.
typedef struct cloth_reference
{
    int slot_count, link_count;
    double ( *position )[3], ( *previous )[3], ( *velocity )[3]; ///< [slot_count]
    double* inverse_mass;
    int ( *links )[2];
    double *rest, *stiffness;
    const wisp_fabric* fabric;
} cloth_reference;

wisp_status cloth_reference_create( const cloth_scene* scene, const wisp_fabric* fabric, cloth_reference* out,
                                    wisp_error* error );
void cloth_reference_destroy( cloth_reference* reference );
void cloth_reference_step( cloth_reference* reference, int substeps );
/// Largest distance of a vertex to the reference's, m; NaN if a coordinate is.
double cloth_reference_distance( const cloth_reference* reference, const wisp_vec3* points );
