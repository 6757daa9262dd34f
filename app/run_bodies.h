/// The bodies of a world as a recording has them: names and elements, colours and widths, and the points and values of
/// the present step.
#pragma once

#include "record.h"
#include "world_from_scene.h"

/// Values that a recording can hold.
enum
{
    RUN_VALUE_STRAIN = 1,
    RUN_VALUE_SPEED = 2,
    RUN_VALUE_COUNT = 2,
};

/// Name of the value with bit `1 << index`.
extern const char* const run_value_names[RUN_VALUE_COUNT];

/// All bodies except planes, which are infinite. Zero-initialised is empty.
typedef struct run_bodies
{
    int count;
    int* numbers;           ///< [count] of the bodies in the world
    wisp_record_body* list; ///< [count]
    wisp_vec3** points;     ///< [count] of the present step
    struct run_body_data* data;
} run_bodies;

/// Request the points of all bodies, list them, and prepare their values: those that the scene computes and those that
/// are asked for, which are requested too. Call before the first step.
/// @param has_values the recording holds values; false: they are left out
/// @param asked set of RUN_VALUE_..; each must exist in one body at least
/// @param out to be released, after a failure too
/// @return WISP_BAD_INPUT no body has the value that is asked for; WISP_NO_MEMORY
wisp_status run_bodies_open( scene_world* world, bool has_values, unsigned asked, run_bodies* out,
                             wisp_error* error );

/// Allocate room for the points of all bodies. @return null without memory
wisp_vec3** run_bodies_make_points( const run_bodies* bodies );
void run_bodies_free_points( const run_bodies* bodies, wisp_vec3** points );

/// Fill the points of the present step, and the values if they are needed.
wisp_status run_bodies_load( const run_bodies* bodies, const scene_world* world, bool with_values,
                             wisp_error* error );

void run_bodies_release( run_bodies* bodies );
