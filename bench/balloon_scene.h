/// Balloons for measurements: spheres of any fineness and a scanned figure, with the outlet and gas of an experiment.
#pragma once

#include "surface_implementation.h"

#include "balloon/balloon.h"
#include "membrane/membrane.h"

#define BALLOON_RADIUS 0.15f
#define BALLOON_AREA_DENSITY 0.02f
#define BALLOON_STEP ( 1.0f / 60.0f )
#define BALLOON_SUBSTEPS 10
#define BALLOON_ITERATIONS 2

/// 10 * 4^level + 2 vertices about the origin.
wisp_status balloon_mesh_sphere( int level, float radius, wisp_mesh* out, wisp_error* error );

/// The Stanford bunny of data/, moved to the origin and scaled to the area of the default sphere; if the file is
/// missing, an asymmetric closed body of about as many vertices.
/// @param name receives "bunny" or "pear", static
wisp_status balloon_mesh_figure( wisp_mesh* out, const char** name, wisp_error* error );

/// The vertex farthest along a direction; ties go to the lowest index.
int balloon_mesh_extreme( const wisp_mesh* mesh, wisp_vec3 direction );

/// The vertex nearest to a point; ties go to the lowest index.
int balloon_mesh_nearest( const wisp_mesh* mesh, wisp_vec3 at );
double balloon_distance( wisp_vec3 a, wisp_vec3 b );

/// Parameters of an experiment, apart from the mesh. Start from balloon_default_setting().
typedef struct balloon_setting
{
    wisp_balloon_def def;
    const wisp_membrane_def* membrane; ///< the skin instead of links; null: links
    const wisp_vec3* points;           ///< [vertex_count] where the vertices start; null: the rest shape
    float area_density;                ///< kg/m^2
    wisp_vec3 gravity;                 ///< m/s^2
    float damping;                     ///< 1/s
    wisp_solve_order solve_order;
    const int32_t* pins;
    int pin_count;
    int substeps, iterations, workers;
    float seconds; ///< per step
} balloon_setting;

/// In still air at rest: 9.8 m/s^2, buoyancy, drag; 10 substeps of two iterations, steps of 1/60 s.
balloon_setting balloon_default_setting( void );
/// In a vacuum without gravity: nothing but skin and gas.
balloon_setting balloon_setting_in_vacuum( void );

wisp_status balloon_cook( const wisp_mesh* mesh, const balloon_setting* setting, wisp_fabric** out,
                          wisp_error* error );
/// A balloon with statistics requested.
wisp_status balloon_implementation_create( wisp_fabric* fabric, const balloon_setting* setting,
                                           surface_implementation* out, wisp_error* error );
wisp_status balloon_implementation_read( surface_implementation* implementation, wisp_balloon_stats* out,
                                         wisp_error* error );

/// Volume of a closed mesh, m^3.
double balloon_volume( const wisp_mesh* mesh, const wisp_vec3* points );
/// The vertices of a mesh, scaled from the origin. @return [vertex_count], for free(); null: no memory
wisp_vec3* balloon_scaled_points( const wisp_mesh* mesh, double scale );
