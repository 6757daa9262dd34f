/// Scenes of surfaces that touch: a cloth that folds over a moving ball, two balloons pressed together, ten
/// balloons in a box. All their numbers are here.
#pragma once

#include "bench_world.h"
#include "mesh.h"
#include "surface_implementation.h"

#include "contact/contact.h"
#include "wisp/shapes.h"

#define CONTACT_STEP ( 1.0f / 60.0f )
#define CONTACT_SUBSTEPS 10
#define CONTACT_SURFACES_MAX 10
#define CONTACT_GRAVITY 9.81f ///< m/s^2

#define FOLD_WIDTH 1.0f        ///< m, of the square cloth
#define FOLD_HEIGHT 0.6f       ///< m, where it begins to fall
#define FOLD_DENSITY 0.15f     ///< kg/m^2
#define FOLD_BEND 0.5f         ///< m/N, soft enough to fold over several times
#define FOLD_DAMPING 1.0f      ///< 1/s
#define FOLD_BALL_RADIUS 0.15f ///< m
#define FOLD_BALL_HEIGHT 0.3f  ///< m, of its centre
#define FOLD_SWING 0.15f       ///< m, how far the ball goes to each side
#define FOLD_SWING_X 3.0f      ///< rad/s
#define FOLD_SWING_Z 2.0f      ///< rad/s: another rate, so that the ball winds the cloth up

#define PRESS_RADIUS 0.15f ///< m, of a balloon at rest
#define PRESS_DENSITY 0.1f ///< kg/m^2
#define PRESS_FILL 1.2f    ///< of the rest volume: the skin is taut enough to stay so where it is flattened
#define PAIR_SKIN 200.0f   ///< N/m: soft, so that the wall between the two is wide
#define PAIR_DAMPING 4.0f  ///< 1/s
#define PAIR_OPEN 2.16f    ///< radii, of a plate from the middle at first ...
#define PAIR_CLOSED 1.5f   ///< ... and when it has come to rest
#define PAIR_CLOSING 60    ///< steps
#define STACK_COUNT 10
#define STACK_SKIN 400.0f  ///< N/m
#define STACK_DAMPING 1.0f ///< 1/s
#define STACK_BOX 0.33f    ///< m, half the width of the box: two balloons lie side by side

/// One way to keep surfaces apart.
typedef struct contact_way
{
    const char* name;
    bool is_off; ///< nothing is kept apart
    wisp_contact_primitives primitives;
    float spacing; ///< of samples, in thicknesses
    float margin;  ///< in thicknesses
    bool no_displacement_limit;
    wisp_pair_search search;
    /// Of the ball that it is measured over: what share of its pace is taken from it; 1: it rests, -1: twice as fast
    float ball_held;
} contact_way;

/// A mesh that takes part once or several times.
typedef struct contact_scene
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    float thickness; ///< m, what surfaces keep apart: a quarter of the mean edge
} contact_scene;

/// @param side vertices along an edge
wisp_status contact_make_cloth( int side, contact_scene* out, wisp_error* error );
/// @param level of the icosphere
wisp_status contact_make_balloon( int level, contact_scene* out, wisp_error* error );
void contact_scene_free( contact_scene* scene );

typedef struct contact_setting
{
    contact_way way;
    int workers;
    bool requests_stats; ///< of contact and of motion; without them a step is as a user has it
} contact_setting;

/// Position of a body after a number of steps, which may be fractional.
typedef wisp_vec3 contact_place_fn( int mover, float steps );

typedef struct contact_world
{
    wisp_world* world;
    wisp_entity surfaces[CONTACT_SURFACES_MAX];
    int surface_count;
    wisp_entity movers[2]; ///< bodies that are told where to go
    wisp_quat turns[2];    ///< how they stand
    int mover_count;
    contact_place_fn* place;    ///< of the movers
    float pace;                 ///< of the movers: their steps per step of the scene
    const contact_scene* scene; ///< the caller's, who keeps it until the world is gone
    int steps;
    int halted_at; ///< the step at which a surface left its bounds; 0: none did
} contact_world;

typedef wisp_status contact_enter_fn( const contact_scene* scene, const contact_setting* setting, contact_world* out,
                                      wisp_error* error );

contact_enter_fn contact_enter_fold;  ///< a cloth falls on a ball that swings, and from there to the ground
contact_enter_fn contact_enter_pair;  ///< two balloons between plates that close
contact_enter_fn contact_enter_stack; ///< STACK_COUNT balloons fall into a box
void contact_leave( contact_world* world );

/// One step. @param context the world, as a bench_variant has it
wisp_status contact_step( void* context, wisp_error* error );
contact_place_fn contact_ball_at;  ///< the ball's centre
contact_place_fn contact_plate_at; ///< a plate's surface; 0: the left one
/// Hash of the vertices of all surfaces.
wisp_status contact_hash( contact_world* world, uint64_t* hash, wisp_error* error );
/// The vertices of a surface in the user's order, valid until the next step.
wisp_status contact_points( contact_world* world, int surface, const wisp_vec3** points, wisp_error* error );
