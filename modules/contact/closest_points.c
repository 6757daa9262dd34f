// Closest points of a point and a triangle, or of two edges, eight pairs per kernel call. In: positions and the
// points of pairs. Out: distances, barycentric weights of the closest points, and the unit vector between them. The
// kernels closest_triangle and closest_segments do the work (engine/kernels).
#include "closest_points.h"

const float* contact_measure_pieces( const contact_work* work, const float* quads, contact_pieces* pieces, int count,
                                     float ( *weight )[4][WISP_SLICE], float ( *normal )[3][WISP_SLICE] )
{
    const int groups = ( count + WISP_SLICE - 1 ) / WISP_SLICE;
    // lanes without a pair repeat the last pair
    for ( int i = count; i < groups * WISP_SLICE; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            pieces->point4[k][i] = pieces->point4[k][count - 1];
        }
    }
    const wisp_closest_job job = {
        .quads = quads,
        .point4 = { pieces->point4[0], pieces->point4[1], pieces->point4[2], pieces->point4[3] },
        .distance = pieces->distance,
        .weight = weight,
        .normal = normal,
    };
    const wisp_kernels* kernels = wisp_frame_kernels( work->frame );
    ( pieces->are_edges ? kernels->closest_segments : kernels->closest_triangle )( &job, 0, groups );
    return pieces->distance;
}
