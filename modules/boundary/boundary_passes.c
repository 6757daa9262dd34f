// The passes of a step: vertex normals and points; and points at its start, for modules that read them.
#include "boundary_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- spacing ----

// Local spacing (not in the boundary particle paper). An edge has one value, so that both of its sides agree. A triangle has the
// smallest of its three edges, so that the surface beside an edge is as dense as the edge.

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
        .layer = wisp_find_object( state->layers, e ),
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

// ---- elements of a layer, in the numbers of the user ----

static int compare_pairs( const void* a, const void* b )
{
    const int32_t *p = a, *q = b;
    const int first = ( p[0] > q[0] ) - ( p[0] < q[0] );
    return first != 0 ? first : ( p[1] > q[1] ) - ( p[1] < q[1] );
}

static void name_edges( boundary_layer* layer, const wisp_fabric* fabric )
{
    for ( size_t e = 0; e < (size_t)layer->edge_count; ++e )
    {
        const int32_t a = fabric->slot_vertex[fabric->edges[2 * e]],
                      b = fabric->slot_vertex[fabric->edges[2 * e + 1]];
        layer->edges[2 * e] = a < b ? a : b;
        layer->edges[2 * e + 1] = a < b ? b : a;
    }
    if ( layer->edge_count > 0 )
    {
        qsort( layer->edges, (size_t)layer->edge_count, 2 * sizeof( int32_t ), compare_pairs );
    }
    for ( size_t i = 0; i < 2 * (size_t)layer->edge_count; ++i )
    {
        layer->edge_slots[i] = fabric->vertex_slot[layer->edges[i]];
    }
}

static int32_t find_edge( const boundary_layer* layer, int32_t a, int32_t b )
{
    const int32_t requested[2] = { a < b ? a : b, a < b ? b : a };
    const int32_t* found =
        bsearch( requested, layer->edges, (size_t)layer->edge_count, 2 * sizeof( int32_t ), compare_pairs );
    WISP_ASSERT( found != NULL );
    return (int32_t)( ( found - layer->edges ) / 2 );
}

static void name_triangle_edges( boundary_layer* layer, const wisp_fabric* fabric )
{
    for ( size_t side = 0; side < 3 * (size_t)layer->triangle_count; ++side )
    {
        const int32_t* slots = fabric->triangles + side / 3 * 3;
        layer->triangle_edge[side] =
            find_edge( layer, fabric->slot_vertex[slots[side % 3]], fabric->slot_vertex[slots[( side + 1 ) % 3]] );
    }
}

boundary_layer* boundary_layer_create( const wisp_allocator* allocator, const wisp_fabric* fabric,
                                       wisp_entity entity )
{
    const size_t edges = (size_t)fabric->edge_count * 2, sides = (size_t)fabric->triangle_count * 3;
    const size_t bytes = sizeof( boundary_layer ) + ( 2 * edges + sides ) * sizeof( int32_t );
    boundary_layer* layer = allocator->allocate( allocator->user, bytes, 64 );
    if ( layer == NULL )
    {
        return NULL;
    }
    int32_t* arrays = (int32_t*)( layer + 1 );
    *layer = ( boundary_layer ){
        .entity = entity,
        .edge_count = fabric->edge_count,
        .triangle_count = fabric->triangle_count,
        .edges = arrays,
        .edge_slots = arrays + edges,
        .triangle_edge = arrays + 2 * edges,
        .bytes = bytes,
    };
    name_edges( layer, fabric );
    name_triangle_edges( layer, fabric );
    return layer;
}

void boundary_layer_release( void* memory, const wisp_allocator* allocator )
{
    boundary_layer* layer = memory;
    if ( layer != NULL )
    {
        wisp_samples_release( &layer->samples, allocator );
        wisp_buffer_release( &layer->moved, allocator );
        allocator->release( allocator->user, layer, layer->bytes );
    }
}

// ---- passes ----

enum
{
    NORMAL_GRAIN = 16, // slices of eight slots a block: a triangle's normal costs a root and a quotient
};

typedef struct normal_loop
{
    const wisp_kernels* kernels;
    wisp_ring_args args;
    float* xyzw;
} normal_loop;

static void find_normals( void* context, int begin, int end, int worker )
{
    (void)worker;
    const normal_loop* loop = context;
    loop->kernels->ring_mean_normal( &loop->args, begin, end, loop->xyzw );
}

void boundary_find_normals( wisp_frame* frame, const wisp_span* span, void* user )
{
    const boundary_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    normal_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                  .ring_begin = fabric->ring_begin,
                  .ring_x4 = fabric->ring_x4 },
        .xyzw = wisp_frame_column( frame, span->entity, state->normals, 0 ),
    };
    wisp_parallel_for( wisp_frame_parallel( frame, span ), fabric->ring_slice_count, NORMAL_GRAIN, find_normals,
                       &loop );
}

void boundary_place_points( wisp_frame* frame, const wisp_span* span, void* user )
{
    const boundary_state* state = user;
    boundary_layer* layer = wisp_find_object( state->layers, span->entity );
    const wisp_entity e = span->entity;
    const boundary_settings* s = wisp_frame_column( frame, e, state->settings, 0 );
    const bool local = wisp_frame_has( frame, e, state->local );
    if ( layer->is_early )
    {
        wisp_samples_release( &layer->samples, wisp_parallel_allocator( wisp_frame_parallel( frame, span ) ) );
        layer->is_early = false;
    }
    const wisp_samples_args args = {
        .position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
        .normal = wisp_frame_column( frame, e, state->normals, 0 ),
        .edges = layer->edge_slots,
        .edge_count = layer->edge_count,
        .triangles = wisp_frame_fabric( frame, e )->triangles,
        .triangle_count = layer->triangle_count,
        .edge_spacing = local ? wisp_frame_column( frame, e, state->edges, BOUNDARY_SPACING ) : NULL,
        .triangle_spacing = local ? wisp_frame_column( frame, e, state->triangles, BOUNDARY_SPACING ) : NULL,
        .spacing = s->spacing,
        .policy = (wisp_spacing)s->policy,
        .rounding = (wisp_rounding)s->rounding,
        .hysteresis = s->hysteresis,
        .limit = s->limit,
        .edge_length = wisp_frame_column( frame, e, state->edges, BOUNDARY_EXTENT ),
        .edge_points = wisp_frame_column( frame, e, state->edges, BOUNDARY_POINTS ),
        .triangle_extent = wisp_frame_column( frame, e, state->triangles, BOUNDARY_EXTENT ),
        .triangle_axis = wisp_frame_column( frame, e, state->triangles, BOUNDARY_AXIS ),
        .triangle_points = wisp_frame_column( frame, e, state->triangles, BOUNDARY_POINTS ),
    };
    const wisp_status status = wisp_samples_update( &layer->samples, wisp_frame_parallel( frame, span ),
                                                    wisp_frame_kernels( frame ), &args );
    if ( status != WISP_OK )
    {
        wisp_frame_fail( frame, status, "boundary: out of memory for the %.0f points of entity %u",
                         layer->samples.requested, e.index );
    }
    layer->made = true;
}

// The points of the start of the step are a function of columns alone: the same after a restore, or after the host has moved the
// surface, and there in the first step.
void boundary_share_points( wisp_frame* frame, const wisp_span* span, void* user )
{
    const boundary_state* state = user;
    boundary_find_normals( frame, span, user );
    if ( wisp_frame_has( frame, span->entity, state->local ) )
    {
        boundary_find_spacing( frame, span, user );
    }
    boundary_place_points( frame, span, user );
}
