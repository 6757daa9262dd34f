/// A balloon without symmetry that is released, for the scenes `balloon_flight` and `balloon_meshes`: the body, a
/// flight, and the distance between two flights.
#pragma once

#include "accuracy_surface.h"
#include "accuracy_reference.h"

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
    int outlet;      ///< vertex, at the same position on every mesh
} flight_body;

/// Make an empty balloon and allocate `full`. @param level of the pear's icosphere
/// @param out to be given to flight_free_body() even after a failure
wisp_status flight_make_body( int level, flight_body* out, wisp_error* error );
/// Fill it and let it come to rest; `full` receives the positions.
wisp_status flight_fill_body( flight_body* body, int substeps, wisp_error* error );
void flight_free_body( flight_body* body );

/// Settings of a flight: in air, with an open outlet next to the centre.
balloon_setting flight_setting( int substeps, int iterations );

/// Release the balloon. @param path receives its positions; null: not sampled
wisp_status flight_fly( const flight_body* body, balloon_setting setting, int workers, accuracy_run* out,
                        flight_path* path, wisp_error* error );

// ---- the reference ----

enum
{
    FLIGHT_LEVEL = 1,           // 42 vertices: of the scene `balloon_flight`
    FLIGHT_FILL_SUBSTEPS = 640, // substeps of its filling
    FLIGHT_MESHES_LEVEL = 4,    // 2562 vertices: the reference of `balloon_meshes`
    FLIGHT_MESHES_FILL = 10,    // substeps of the filling of all of those
    FLIGHT_PACES = 2,           // of `balloon_meshes`
    FLIGHT_NUMBERS = 3 * FLIGHT_STEPS + 3,
};

/// Substeps of a flight of `balloon_meshes`.
extern const int flight_paces[FLIGHT_PACES];

// Scene, facts and size of a reference. A flight is FLIGHT_NUMBERS: [steps][3] m, the centre after every step; then
// final speed, spin and volume.

/// For `balloon_flight`: a flight, followed by [vertices][3] m, the start of the flights.
accuracy_reference flight_reference( const flight_body* body );
/// For `balloon_meshes`: one flight per number of substeps. @param finest the body of FLIGHT_MESHES_LEVEL
accuracy_reference flight_meshes_reference( const flight_body* finest );
void flight_put_path( const flight_path* path, double* numbers );
flight_path flight_take_path( const double* numbers );

/// Put the distance to the reference, in mm, and the measures below into a sampled run.
void flight_judge( const flight_path* path, const flight_path* reference, accuracy_run* out );
#define FLIGHT_MEASURES                                                                                              \
    {                                                                                                                \
        "speed m/s", "speed error %", "spin rad/s", "volume error %", "momentum not closed %"                        \
    }
#define FLIGHT_MEASURE_COUNT 5
