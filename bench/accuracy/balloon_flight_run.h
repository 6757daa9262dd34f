/// A balloon without symmetry that is released, for the scene `balloon_flight`: the body, a flight of the engine, one of
/// the oracle, and the distance between two flights.
#pragma once

#include "accuracy_surface.h"

#include "balloon_scene.h"

#define FLIGHT_STEPS 20
#define FLIGHT_FILL 1.2f

/// Positions of a balloon after every step.
typedef struct flight_path
{
    double centre[FLIGHT_STEPS + 1][3]; ///< m
    double speed, spin, volume;         ///< at the end: m/s, rad/s, m^3
    double impulse_missing;             ///< N s, between the momentum and the integral of the forces
    double impulse;                     ///< N s, largest change of momentum
} flight_path;

/// Root mean square over the steps, m.
double flight_distance( const flight_path* a, const flight_path* b );

typedef struct flight_body
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3* full; ///< [vertex_count] start of the flights: at rest and filled
    int outlet;      ///< vertex
} flight_body;

/// Make a balloon, fill it and let it come to rest.
/// @param out to be given to flight_free_body() even after a failure
wisp_status flight_make_body( flight_body* out, wisp_error* error );
void flight_free_body( flight_body* body );

/// Settings of a flight: in air, with an open outlet next to the centre.
balloon_setting flight_setting( int substeps, int iterations );

/// Release the balloon. @param path receives its positions; null: not sampled
wisp_status flight_fly( const flight_body* body, balloon_setting setting, int workers, accuracy_run* out,
                        flight_path* path, wisp_error* error );

/// The same flight in double precision, by the oracle, with one iteration of each substep.
wisp_status flight_fly_oracle( const flight_body* body, int substeps, flight_path* path, wisp_error* error );

/// Put the distance to the reference, in mm, and the measures below into a sampled run.
void flight_judge( const flight_path* path, const flight_path* reference, accuracy_run* out );
#define FLIGHT_MEASURES                                                                                              \
    {                                                                                                                \
        "speed m/s", "speed error %", "spin rad/s", "volume error %", "momentum not closed %"                        \
    }
#define FLIGHT_MEASURE_COUNT 5
