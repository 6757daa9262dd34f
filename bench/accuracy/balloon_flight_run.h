/// A balloon without symmetry that is let go, as the scenes `balloon_flight` and `balloon_meshes` have it: the body, a flight, and
/// how far two flights are from each other.
#pragma once

#include "accuracy_surface.h"

#include "balloon_scene.h"

#define FLIGHT_STEPS 20
#define FLIGHT_FILL 1.2f

/// Where a balloon was, after every step.
typedef struct flight_path
{
    double centre[FLIGHT_STEPS + 1][3]; ///< m
    double speed, spin, volume;         ///< in the end: m/s, rad/s, m^3
    double impulse_missing;             ///< N s, between the momentum and the integral of the forces
    double impulse;                     ///< N s, largest change of momentum
} flight_path;

/// Root mean square over the steps, m.
double flight_distance( const flight_path* a, const flight_path* b );

typedef struct flight_body
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3* full; ///< [vertex_count] where flights begin: at rest and filled
    int outlet;      ///< vertex, the same place on every mesh
} flight_body;

/// @param level of the pear's icosphere @param fill_substeps with which it is filled
/// @param out also after a failure to be given to flight_free_body()
wisp_status flight_make_body( int level, int fill_substeps, flight_body* out, wisp_error* error );
void flight_free_body( flight_body* body );

/// In air, with an open outlet beside the centre.
balloon_setting flight_setting( int substeps, int iterations );

/// Let it go. @param path receives where it was, null: nobody looks
wisp_status flight_fly( const flight_body* body, balloon_setting setting, int workers, accuracy_run* out,
                        flight_path* path, wisp_error* error );

/// Put the distance to the truth, in mm, and the measures below into a run that was looked at.
void flight_judge( const flight_path* path, const flight_path* truth, accuracy_run* out );
#define FLIGHT_MEASURES                                                                                              \
    {                                                                                                                \
        "speed m/s", "speed error %", "spin rad/s", "volume error %", "momentum not closed %"                        \
    }
#define FLIGHT_MEASURE_COUNT 5
