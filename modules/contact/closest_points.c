// Closest points of a point and a triangle, or of two edges, eight pairs per kernel call. In: positions and the
// points of pairs. Out: distances, barycentric weights of the closest points, and the unit vector between them. The
// kernels closest_triangle and closest_segments do the work (engine/kernels).
#include "closest_points.h"

const float* contact_measure_primitives( const contact_work* work, const float* xyzw, contact_primitives* primitives,
                                         int count, float ( *weight )[4][WISP_SLICE],
                                         float ( *normal )[3][WISP_SLICE] )
{
    const int groups = ( count + WISP_SLICE - 1 ) / WISP_SLICE;
    // lanes without a pair repeat the last pair
    for ( int i = count; i < groups * WISP_SLICE; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            primitives->point_x4[k][i] = primitives->point_x4[k][count - 1];
        }
    }
    const wisp_closest_args args = {
        .xyzw = xyzw,
        .point_x4 = { primitives->point_x4[0], primitives->point_x4[1], primitives->point_x4[2],
                      primitives->point_x4[3] },
        .distance = primitives->distance,
        .weight = weight,
        .normal = normal,
    };
    const wisp_kernels* kernels = wisp_frame_kernels( work->frame );
    ( primitives->are_edges ? kernels->closest_segments : kernels->closest_triangle )( &args, 0, groups );
    return primitives->distance;
}
