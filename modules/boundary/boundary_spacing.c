// Local spacing (not in the boundary particle paper). An edge has one value, so that both of its sides agree. A triangle has the
// smallest of its three edges, so that the surface beside an edge is as dense as the edge.
#include "boundary_internal.h"

#include <float.h>
#include <math.h>

enum
{
    SPACING_GRAIN = 512, // elements a block
};

typedef struct spacing_loop
{
    const boundary_settings* settings;
    const boundary_layer* layer;
    const wisp_fabric* fabric;
    const float *position, *normal;
    float *edge, *triangle;
    wisp_vec3 eye; // m, in rows
} spacing_loop;

static wisp_vec3 load( const float* xyzw, int slot )
{
    const float* p = xyzw + (size_t)slot * 4;
    return ( wisp_vec3 ){ p[0], p[1], p[2] };
}

static float distance( wisp_vec3 a, wisp_vec3 b )
{
    const float x = b.x - a.x, y = b.y - a.y, z = b.z - a.z;
    return sqrtf( x * x + y * y + z * z );
}

// The angle between unit vectors in rad. Twice the arc tangent of half the difference over half the sum stays exact where they
// are nearly parallel. The C library's functions differ between machines, so the arc tangent is a polynomial: its
// argument is brought below tan( pi / 8 ), where the odd series up to t^15 is off by less than 2e-8.
static float angle_between( wisp_vec3 a, wisp_vec3 b )
{
    const wisp_vec3 minus = { -b.x, -b.y, -b.z };
    const float foreign = distance( a, b ), along = distance( a, minus );
    const float lower = foreign < along ? foreign : along, upper = foreign < along ? along : foreign;
    if ( !( upper > 0.0f ) )
    {
        return 0.0f;
    }
    float t = lower / upper, turned = 0.0f;
    if ( t > 0.41421356f )
    {
        t = ( t - 1.0f ) / ( t + 1.0f );
        turned = 0.78539816f;
    }
    const float s = t * t;
    const float series =
        1.0f + s * ( -1.0f / 3.0f +
                     s * ( 1.0f / 5.0f +
                           s * ( -1.0f / 7.0f +
                                 s * ( 1.0f / 9.0f +
                                       s * ( -1.0f / 11.0f + s * ( 1.0f / 13.0f - s * ( 1.0f / 15.0f ) ) ) ) ) ) );
    const float half = turned + t * series;
    return 2.0f * ( foreign < along ? half : 1.57079633f - half );
}

static float by_curvature( const spacing_loop* loop, int a, int b )
{
    const boundary_settings* s = loop->settings;
    return s->spacing /
           ( 1.0f + s->curvature_gain * angle_between( load( loop->normal, a ), load( loop->normal, b ) ) );
}

static float by_strain( const spacing_loop* loop, int a, int b )
{
    const boundary_settings* s = loop->settings;
    const float rest = distance( loop->fabric->rest[a], loop->fabric->rest[b] );
    const float now = distance( load( loop->position, a ), load( loop->position, b ) );
    const float change = rest > 0.0f ? fabsf( now / rest - 1.0f ) : 0.0f;
    return s->strain_gain > 0.0f ? s->spacing / ( 1.0f + s->strain_gain * change )
                                 : s->spacing * ( 1.0f - s->strain_gain * change );
}

static float by_distance( const spacing_loop* loop, int a, int b )
{
    const boundary_settings* s = loop->settings;
    const wisp_vec3 p = load( loop->position, a ), q = load( loop->position, b );
    const wisp_vec3 middle = { 0.5f * ( p.x + q.x ), 0.5f * ( p.y + q.y ), 0.5f * ( p.z + q.z ) };
    return s->eye_angle * distance( loop->eye, middle );
}

// NaN, from an end that is not finite, changes nothing: such an edge is not sampled.
static float finer( float queried, float spacing )
{
    return queried < spacing ? queried : spacing;
}

static void find_edge_spacing( void* context, int begin, int end, int worker )
{
    (void)worker;
    const spacing_loop* loop = context;
    const boundary_settings* s = loop->settings;
    for ( int e = begin; e < end; ++e )
    {
        const int a = loop->layer->edge_slots[2 * (size_t)e], b = loop->layer->edge_slots[2 * (size_t)e + 1];
        float queried = FLT_MAX;
        queried = s->curvature_gain > 0.0f ? finer( by_curvature( loop, a, b ), queried ) : queried;
        queried = s->strain_gain != 0.0f ? finer( by_strain( loop, a, b ), queried ) : queried;
        queried = s->eye_angle > 0.0f ? finer( by_distance( loop, a, b ), queried ) : queried;
        queried = queried > s->min_spacing ? queried : s->min_spacing;
        loop->edge[e] = queried < s->max_spacing ? queried : s->max_spacing;
    }
}

static void find_triangle_spacing( void* context, int begin, int end, int worker )
{
    (void)worker;
    const spacing_loop* loop = context;
    for ( int t = begin; t < end; ++t )
    {
        const int32_t* edges = loop->layer->triangle_edge + 3 * (size_t)t;
        loop->triangle[t] = finer( loop->edge[edges[0]], finer( loop->edge[edges[1]], loop->edge[edges[2]] ) );
    }
}

void boundary_find_spacing( wisp_frame* frame, const wisp_span* span, void* user )
{
    const boundary_state* state = user;
    const wisp_entity e = span->entity;
    spacing_loop loop = {
        .settings = wisp_frame_column( frame, e, state->settings, 0 ),
        .layer = boundary_find_layer( state, e ),
        .fabric = wisp_frame_fabric( frame, e ),
        .position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
        .normal = wisp_frame_column( frame, e, state->normals, 0 ),
        .edge = wisp_frame_column( frame, e, state->edges, BOUNDARY_SPACING ),
        .triangle = wisp_frame_column( frame, e, state->triangles, BOUNDARY_SPACING ),
    };
    loop.eye = wisp_to_rows( loop.settings->eye, wisp_frame_offset( frame, e ) );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    wisp_parallel_for( parallel, loop.layer->edge_count, SPACING_GRAIN, find_edge_spacing, &loop );
    wisp_parallel_for( parallel, loop.layer->triangle_count, SPACING_GRAIN, find_triangle_spacing, &loop );
}
