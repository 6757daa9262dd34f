/// Shared by the tests of the engine's balloon: a scene, its flight in a separate world, and the double-precision
/// oracle with exactly the engine's floats.
#pragma once

#include "support.h"

#include "balloon.h"
#include "oracle/balloon_meshes.h"
#include "oracle/balloon_oracle.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

/// A balloon and its world. All zero: no pins, no gravity, no damping.
typedef struct balloon_scene
{
    const balloon_mesh* mesh; ///< in double, rounded once to the engine's floats
    double scale;             ///< initial scale of the rest shape
    wisp_vec3 place;          ///< m, initial centre
    float area_density;       ///< kg/m^2
    wisp_vec3 gravity;        ///< m/s^2
    float damping;            ///< 1/s
    const int32_t* pins;
    int pin_count;
    bool bend_links;
    wisp_balloon_def def;
    float dt; ///< s per step
    int substeps, iterations;
    int workers;
    const char* isa;
    wisp_parallel_for_fn* parallel_for; ///< loop of the host; null: none
    void* parallel_for_user;
    wisp_allocator allocator;
} balloon_scene;

/// The balloon of the paper in a vacuum: 0.02 kg/m^2, steps of 1/60 s, 10 substeps of 2 iterations, no gravity,
/// buoyancy or drag, statistics requested.
balloon_scene balloon_scene_of( const balloon_mesh* mesh );
/// The same in air under 9.8 m/s^2.
balloon_scene balloon_scene_in_air( const balloon_mesh* mesh );
/// With an outlet at one vertex, open or shut.
void balloon_scene_give_outlet( balloon_scene* scene, int vertex, bool open );
/// With a shut outlet of all vertices within a distance of one, in the mesh's order.
void balloon_scene_give_outlet_around( balloon_scene* scene, int vertex, double radius );

balloon_mesh balloon_sphere( int level, double radius );
/// An asymmetric body of about 0.15 m.
balloon_mesh balloon_pear( int level );

typedef struct balloon_flight
{
    wisp_world* world;
    wisp_entity entity;
    const balloon_scene* scene;
} balloon_flight;

/// A world with this module alone and a silent log. @param scene its host; may be null
wisp_world* balloon_world_create( const balloon_scene* scene );
/// Add the mesh of the scene as a surface, not yet a balloon.
wisp_entity balloon_surface_add( wisp_world* world, const balloon_scene* scene );
/// Add it as a balloon, with statistics of balloon and surface requested.
wisp_entity balloon_add( wisp_world* world, const balloon_scene* scene );

/// The flight of a scene, which must outlive it.
balloon_flight balloon_start( const balloon_scene* scene );
void balloon_end( balloon_flight* flight );
void balloon_steps( const balloon_flight* flight, int steps );
wisp_balloon_stats balloon_read( const balloon_flight* flight );
wisp_motion_stats balloon_motion_stats( const balloon_flight* flight );
double3 balloon_momentum( const balloon_flight* flight );
double3 balloon_angular_momentum( const balloon_flight* flight );
double3 balloon_from( const double v[3] );

/// The engine's own column, indexed by slot: [slot][4].
float* balloon_positions( const balloon_flight* flight );
float* balloon_velocities( const balloon_flight* flight );
/// Set velocities of up to `speed` per coordinate, the same in every run.
void balloon_stir( const balloon_flight* flight, float speed );
void balloon_throw( const balloon_flight* flight, wisp_vec3 velocity );

/// True if every position and velocity is finite and the balloon is not halted.
bool balloon_is_finite( const balloon_flight* flight );
uint64_t balloon_hash( const balloon_flight* flight );

/// The oracle's order of projection.
typedef enum balloon_order
{
    BALLOON_ORDER_ENGINE, ///< link by link in the engine's schedule; edges and bend links need the same stiffness
    BALLOON_ORDER_PARTED, ///< all edges, then all bend links, each in the engine's order
} balloon_order;

/// The oracle in the state of a flight: its floats widened, masses, velocities, rest lengths, pins and gas. Pinned
/// vertices have no mass in it, because the engine distributes forces among free vertices. Vertices are slots.
balloon_oracle balloon_oracle_of( const balloon_flight* flight, balloon_order order );
/// Largest distance between a vertex of the engine and the same of the oracle, m.
double balloon_distance( const balloon_flight* flight, const balloon_oracle* oracle );

/// Fails unless |actual - expected| <= tolerance; a NaN fails.
void balloon_assert_close( double actual, double expected, double tolerance );
/// The same for the relative difference.
void balloon_assert_fraction( double actual, double expected, double tolerance );
