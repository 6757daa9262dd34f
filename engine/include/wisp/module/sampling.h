/// Sampling of a triangle mesh with points: the functions behind wisp/samples.h.
#pragma once

#include "wisp/module/kernels.h"
#include "wisp/module/space.h"
#include "wisp/samples.h"

WISP_BEGIN_C

/// Marks surfaces whose points another module reads in the substeps (wisp_frame_samples). The reader attaches it, and the module
/// that shares points brings them up to date before the substeps. A component of WISP_TABLE_ENTITY without columns.
#define WISP_SAMPLES_READ "surface.samples_read"

/// What to sample and how. The arrays stay the caller's.
typedef struct wisp_samples_args
{
    const float* position; ///< [slot][4] m; 16-byte aligned
    const float* normal;   ///< [slot][4] unit vertex normals, 0 where there is none; null: points get no normals
    const int32_t* edges;  ///< [edge_count][2] slots, from the end that positions are counted from
    int edge_count;
    const int32_t* triangles; ///< [triangle_count][3] slots
    int triangle_count;
    const float* edge_spacing;     ///< [edge_count] m, > 0; null: `spacing` for all
    const float* triangle_spacing; ///< [triangle_count] m; null: `spacing` for all
    float spacing;                 ///< m, > 0, finite
    wisp_spacing policy;
    wisp_rounding rounding;
    /// Counts stay while lengths are within this many spacings of where they would change; 0: exact comparison. All counts of a
    /// triangle are computed again when its axis or one of them changes.
    float hysteresis;
    int limit; ///< most points, >= 0; beyond it the old points stay, and `refused` is set

    // State kept from call to call, owned by the caller: zero at the first call. It may be put back to that of an
    // earlier call at any time; points are those that belong to it. Lengths are over the spacing.
    float* edge_length;   ///< [edge_count] that the count was made from; 0 without hysteresis, which needs no memory
    int32_t* edge_points; ///< [edge_count]
    float* triangle_extent; ///< [triangle_count][2] base and height that counts were made from; 0 without hysteresis
    int32_t* triangle_axis; ///< [triangle_count] local edge that lines are parallel to
    int32_t* triangle_points; ///< [triangle_count]
} wisp_samples_args;

/// Count, scan, fill, place (boundary particle paper, sections 2 to 5). Lengths are measured in double precision. Lines of a triangle
/// run from the first corner of its axis to the second; the lowest of equally short sides is the axis.
/// @param args edges and triangles must be those of the call before if their counts are the same: release before others take their
///        place. After a change of anything else all is sampled again
/// @return WISP_NO_MEMORY: points are those of the last call
WISP_API wisp_status wisp_samples_update( wisp_samples* samples, const wisp_parallel* parallel,
                                          const wisp_kernels* kernels, const wisp_samples_args* args );
WISP_API void wisp_samples_release( wisp_samples* samples, const wisp_allocator* allocator );
/// @return bytes that it holds
WISP_API size_t wisp_samples_bytes( const wisp_samples* samples );

WISP_END_C
