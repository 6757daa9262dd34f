/// Strands in a cell: their start, their energy and their samples.
#pragma once

#include "bench_world.h"
#include "stability_starts.h"

#include "strands/strands.h"
#include "wisp/module/module.h"

#define STABILITY_STRANDS 8
#define STABILITY_VERTICES 16 ///< of a strand
#define STABILITY_POINTS ( STABILITY_STRANDS * STABILITY_VERTICES )
#define STABILITY_STRAND_SUBSTEPS 10

typedef struct stability_strands
{
    wisp_world* world;
    wisp_entity entity;
    wisp_strand_dynamics_def def;
    wisp_vec3 rest[STABILITY_POINTS], start[STABILITY_POINTS], seen[STABILITY_POINTS];
    float masses[STABILITY_POINTS];
    double size, seconds, substep;
    double compliance; ///< m/N of a segment; 0 with the direct solve
    bool is_curl;
    bool has_points;  ///< one strand is a point, and another has two segments without length
    wisp_entity body; ///< a collider, where there is one
    /// What the user does before a step, or null.
    wisp_status ( *drive )( struct stability_strands* strands, int frame );
} stability_strands;

/// @param modules of the world
wisp_status stability_strands_enter( stability_strands* s, const wisp_module* const* modules, int module_count,
                                     const stability_axes* axes, int workers, wisp_error* error );
double stability_strands_energy_limit( stability_strands* s );
wisp_status stability_strands_observe( void* context, int frame, stability_observation* out, wisp_error* error );
wisp_status stability_strands_step( void* context, int frame, wisp_error* error );
uint64_t stability_strands_hash( void* context );
void stability_strands_close( void* context );
/// Limits and functions of a trial of these strands.
stability_trial stability_strands_trial( stability_strands* s, const stability_axes* axes );

/// The solvers of strands by index: stability_strand_subjects() has them in this order.
enum
{
    STABILITY_ROD,
    STABILITY_CURL,
    STABILITY_DIRECT,
    STABILITY_STRAND_PBD,
    STABILITY_STRAND_XPBD,
    STABILITY_FOLLOW,
};

/// Dynamics of strands with this solver.
wisp_strand_dynamics_def stability_strand_def( int way, const stability_axes* axes );
