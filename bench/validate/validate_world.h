/// A world of several bodies that a case steps, times and measures together.
#pragma once

#include "accuracy/accuracy.h"
#include "bench_world.h"

#include "wisp/wisp.h"

enum
{
    VALIDATE_MAX_BODIES = 64,
};

#define VALIDATE_STEP ( 1.0f / 60.0f ) // s

typedef struct validate_body
{
    wisp_entity entity;
    wisp_component points;
    int vertex_count;
} validate_body;

typedef struct validate_world
{
    wisp_world* world;
    validate_body bodies[VALIDATE_MAX_BODIES];
    int count, substeps, steps, halted_at;
} validate_world;

/// Steps of 1/60 s that a time takes, the last of which may end after it.
int validate_steps( double seconds );
/// @param out to be released, also after a failure
wisp_status validate_world_create( const bench_world_def* def, validate_world* out, wisp_error* error );
void validate_world_release( validate_world* world );
/// Count an entity of the world among its bodies, and request its points.
wisp_status validate_world_add( validate_world* world, wisp_entity entity, wisp_component points, int vertex_count );
/// Make steps of 1/60 s, whose times are kept.
wisp_status validate_world_step( validate_world* world, int steps, accuracy_run* out, wisp_error* error );
/// Read the points of a body, m, in the user's order, valid until the next step.
wisp_status validate_world_points( validate_world* world, int body, const wisp_vec3** out, wisp_error* error );
/// Request the motion of a body.
wisp_status validate_world_watch( validate_world* world, int body, wisp_error* error );
/// Read the motion of a body for which it was requested.
wisp_status validate_world_motion( validate_world* world, int body, wisp_motion_stats* out, wisp_error* error );
/// Hash the points of all bodies into that of the run, which may have had other worlds before, and keep what a step is
/// made of.
wisp_status validate_world_finish( validate_world* world, accuracy_run* out, wisp_error* error );
