// Access to columns of strands, which are rows of sixteen lanes, and small vectors and quaternions.
#pragma once

#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/vec.h"

#include <math.h>

/// Columns that cooking and measuring need, between steps or in a pass.
typedef struct strands_rows
{
    const wisp_strand_topology* topology;
    const float* rest;   // [row][3][16]
    const float* weight; // [row][16]
    const float* length; // [row][16]
} strands_rows;

static inline size_t strands_scalar( int row, int lane )
{
    return (size_t)row * WISP_LANES + (size_t)lane;
}

static inline size_t strands_vector( int row, int lane )
{
    return (size_t)row * 3 * WISP_LANES + (size_t)lane;
}

static inline size_t strands_quat( int row, int lane )
{
    return (size_t)row * 4 * WISP_LANES + (size_t)lane;
}

static inline wisp_vec3 strands_get( const float* rows, int row, int lane )
{
    const float* p = rows + strands_vector( row, lane );
    return ( wisp_vec3 ){ p[0], p[WISP_LANES], p[2 * WISP_LANES] };
}

static inline void strands_put( float* rows, int row, int lane, wisp_vec3 v )
{
    float* p = rows + strands_vector( row, lane );
    p[0] = v.x;
    p[WISP_LANES] = v.y;
    p[2 * WISP_LANES] = v.z;
}

static inline wisp_quat strands_get_quat( const float* rows, int row, int lane )
{
    const float* q = rows + strands_quat( row, lane );
    return ( wisp_quat ){ q[0], q[WISP_LANES], q[2 * WISP_LANES], q[3 * WISP_LANES] };
}

static inline void strands_put_quat( float* rows, int row, int lane, wisp_quat q )
{
    float* p = rows + strands_quat( row, lane );
    p[0] = q.x;
    p[WISP_LANES] = q.y;
    p[2 * WISP_LANES] = q.z;
    p[3 * WISP_LANES] = q.w;
}

static inline wisp_quat strands_quat_inverse( wisp_quat q )
{
    return ( wisp_quat ){ -q.x, -q.y, -q.z, q.w };
}

/// Return what does not fit the rounded sum of a and b, exactly (Knuth's two-sum).
static inline float strands_low( float a, float b, float sum )
{
    const float of_b = sum - a;
    return ( a - ( sum - of_b ) ) + ( b - of_b );
}

static inline wisp_vec3 strands_low_vector( wisp_vec3 a, wisp_vec3 b, wisp_vec3 sum )
{
    return ( wisp_vec3 ){ strands_low( a.x, b.x, sum.x ), strands_low( a.y, b.y, sum.y ),
                          strands_low( a.z, b.z, sum.z ) };
}

/// Put a vertex at `from` + `arm`, with the velocity that it has there.
static inline void strands_put_held( float* position, float* low, float* velocity, int row, int lane, wisp_vec3 from,
                                     wisp_vec3 arm, float inverse_dt )
{
    const wisp_vec3 to = wisp_v3_add( from, arm ), to_low = strands_low_vector( from, arm, to );
    const wisp_vec3 displacement = wisp_v3_add( wisp_v3_sub( to, strands_get( position, row, lane ) ),
                                                wisp_v3_sub( to_low, strands_get( low, row, lane ) ) );
    strands_put(
        velocity, row, lane,
        ( wisp_vec3 ){ inverse_dt * displacement.x, inverse_dt * displacement.y, inverse_dt * displacement.z } );
    strands_put( position, row, lane, to );
    strands_put( low, row, lane, to_low );
}

static inline strands_rows strands_rows_of( wisp_world* world, wisp_entity strands )
{
    return ( strands_rows ){
        .topology = wisp_world_strands( world, strands ),
        .rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 ),
        .weight = wisp_world_column( world, strands, WISP_STRAND_INVERSE_MASS, 0 ),
        .length = wisp_world_column( world, strands, WISP_STRAND_LENGTH, 0 ),
    };
}

static inline strands_rows strands_rows_in( wisp_frame* frame, wisp_entity strands )
{
    return ( strands_rows ){
        .topology = wisp_frame_strands( frame, strands ),
        .rest = wisp_frame_column( frame, strands, WISP_STRAND_REST, 0 ),
        .weight = wisp_frame_column( frame, strands, WISP_STRAND_INVERSE_MASS, 0 ),
        .length = wisp_frame_column( frame, strands, WISP_STRAND_LENGTH, 0 ),
    };
}
