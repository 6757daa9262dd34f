#include "suite_compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Recordings keep times as multiples of a step in single precision.
static const double SAME_MOMENT = 1e-5; // s

// ---- detail ----

// Sums over the triangles around a vertex.
typedef struct vertex_fan
{
    double sum[3];    // of the next corners
    double normal[3]; // twice the area
    int64_t turn;     // numbers of the next corners less those of the corners before
    int count;
} vertex_fan;

static void add_triangle( const wisp_vec3* points, const int32_t* corners, vertex_fan* fans )
{
    double p[3][3];
    for ( int k = 0; k < 3; ++k )
    {
        const wisp_vec3 v = points[corners[k]];
        p[k][0] = (double)v.x;
        p[k][1] = (double)v.y;
        p[k][2] = (double)v.z;
    }
    double normal[3];
    for ( int i = 0; i < 3; ++i )
    {
        const int j = ( i + 1 ) % 3, k = ( i + 2 ) % 3;
        normal[i] = ( p[1][j] - p[0][j] ) * ( p[2][k] - p[0][k] ) - ( p[1][k] - p[0][k] ) * ( p[2][j] - p[0][j] );
    }
    for ( int k = 0; k < 3; ++k )
    {
        vertex_fan* fan = &fans[corners[k]];
        const int next = ( k + 1 ) % 3;
        for ( int i = 0; i < 3; ++i )
        {
            fan->sum[i] += p[next][i];
            fan->normal[i] += normal[i];
        }
        fan->turn += (int64_t)corners[next] - corners[( k + 2 ) % 3];
        ++fan->count;
    }
}

// The squared normal part of a vertex's Laplacian. Around an inner vertex every neighbour is once the next corner of a triangle and once
// the one before, so both sums of their numbers are the same; around one of the border they are not.
static double square_of( const vertex_fan* fan, wisp_vec3 point )
{
    const double p[3] = { (double)point.x, (double)point.y, (double)point.z };
    double along = 0.0, length = 0.0;
    if ( fan->count == 0 || fan->turn != 0 )
    {
        return 0.0;
    }
    for ( int i = 0; i < 3; ++i )
    {
        along += ( fan->sum[i] / fan->count - p[i] ) * fan->normal[i];
        length += fan->normal[i] * fan->normal[i];
    }
    return length > 0.0 ? along * along / length : 0.0;
}

// @param fans [vertices of the body] buffer
static double curvature_of( const wisp_record_body* body, const wisp_vec3* points, vertex_fan* fans )
{
    double sum = 0.0;
    memset( fans, 0, (size_t)body->vertex_count * sizeof *fans );
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        add_triangle( points, body->triangles + 3 * (size_t)t, fans );
    }
    for ( int i = 0; i < body->vertex_count; ++i )
    {
        sum += square_of( fans + i, points[i] );
    }
    return sum;
}

static bool is_same_mesh( const wisp_record_body* a, const wisp_record_body* b )
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           ( a->triangle_count == 0 ||
             memcmp( a->triangles, b->triangles, 3 * (size_t)a->triangle_count * sizeof *a->triangles ) == 0 );
}

static double sum_curvature( const suite_motion* motion, int frame_count, vertex_fan* fans )
{
    const size_t n = (size_t)suite_motion_points( motion );
    double sum = 0.0;
    for ( int frame = 0; frame < frame_count; ++frame )
    {
        for ( int b = 0; b < motion->body_count; ++b )
        {
            sum += curvature_of( &motion->bodies[b], motion->points + (size_t)frame * n + motion->first[b], fans );
        }
    }
    return sum;
}

double suite_detail( const suite_motion* motion, const suite_motion* reference, int frame_count )
{
    bool is_same = motion->body_count == reference->body_count;
    for ( int b = 0; b < motion->body_count && is_same; ++b )
    {
        is_same = is_same_mesh( &motion->bodies[b], &reference->bodies[b] );
    }
    const size_t n = (size_t)suite_motion_points( motion ) + 1;
    vertex_fan* fans = is_same ? malloc( n * sizeof *fans ) : NULL;
    const double sum = fans ? sum_curvature( reference, frame_count, fans ) : 0.0;
    const double detail = sum > 0.0 ? sqrt( sum_curvature( motion, frame_count, fans ) / sum ) : NAN;
    free( fans );
    return detail;
}

// ---- energy ----

static double total( const suite_motion* motion, int frame )
{
    return (double)motion->energies[frame].x + (double)motion->energies[frame].y;
}

// In parts of what the reference has released since the first frame.
static double compare_energy( const suite_motion* motion, const suite_motion* reference, int last )
{
    const double released = (double)reference->energies[0].y - (double)reference->energies[last].y;
    return released > 0.0 ? ( total( motion, last ) - total( reference, last ) ) / released : NAN;
}

// ---- all ----

static int frame_at( const suite_motion* motion, double moment, int frame_count )
{
    for ( int frame = 0; frame < frame_count; ++frame )
    {
        if ( fabs( motion->times[frame] - moment ) <= SAME_MOMENT )
        {
            return frame;
        }
    }
    return -1;
}

wisp_status suite_compare( const suite_motion* motion, const suite_motion* reference, int frame_count,
                           const char* name, suite_comparison* out, wisp_error* error )
{
    suite_match match = { 0 };
    *out = suite_not_compared;
    const wisp_status status = suite_match_motions( motion, reference, name, &match, error );
    if ( status == WISP_OK )
    {
        out->distance = suite_distance( &match, motion, reference, 0, frame_count, &out->largest );
        out->detail = suite_detail( motion, reference, frame_count );
        out->energy = compare_energy( motion, reference, frame_count - 1 );
    }
    for ( int i = 0; i < SUITE_MOMENT_COUNT && status == WISP_OK; ++i )
    {
        const int frame = frame_at( reference, suite_moments[i], frame_count );
        out->at[i] = frame >= 0 ? suite_distance( &match, motion, reference, frame, 1, NULL ) : NAN;
    }
    suite_match_release( &match );
    return status;
}
