// Outputs of a surface: vertices and normals in the user's order, strain and speed for colouring, statistics.
#include "passes.h"

#include "wisp/module/double3.h"
#include "wisp/module/components.h"

#include <string.h>

static const float* position_of( wisp_frame* frame, const wisp_span* span )
{
    return wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
}

static void hand_out_points( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const float* position = position_of( frame, span );
    wisp_vec3* points = wisp_frame_column( frame, span->entity, WISP_SURFACE_POINTS, 0 );
    const wisp_span s = wisp_frame_particles( frame, span );
    const wisp_vec3 o = wisp_frame_offset( frame, span->entity );
    int end = s.end < fabric->vertex_count ? s.end : fabric->vertex_count;
    for ( int slot = s.begin; slot < end; ++slot )
    {
        const float* p = position + (size_t)slot * 4;
        points[fabric->slot_vertex[slot]] = ( wisp_vec3 ){ p[0] - o.x, p[1] - o.y, p[2] - o.z };
    }
}

static void hand_out_speed( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    float* speed = wisp_frame_column( frame, span->entity, WISP_POINT_SPEED, 0 );
    const wisp_span s = wisp_frame_particles( frame, span );
    int end = s.end < fabric->vertex_count ? s.end : fabric->vertex_count;
    for ( int slot = s.begin; slot < end; ++slot )
    {
        const float* v = velocity + (size_t)slot * 4;
        speed[fabric->slot_vertex[slot]] = sqrtf( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] );
    }
}

// ---- outputs that use neighbours ----

enum
{
    SLICE_GRAIN = 64, // slices of eight slots per block
};

typedef struct ring_loop
{
    const wisp_fabric* fabric;
    const wisp_kernels* kernels;
    const float* position;
    wisp_vec3* normals;
    float* strain;
} ring_loop;

static void hand_out_slice_normals( void* context, int begin, int end, int worker )
{
    (void)worker;
    const ring_loop* loop = context;
    for ( int slice = begin; slice < end; ++slice )
    {
        _Alignas( 64 ) float normal[3][8];
        wisp_ring_args args = {
            .position = loop->position,
            .ring_begin = loop->fabric->ring_begin,
            .ring_x4 = loop->fabric->ring_x4,
            .gradient = normal[0],
            .first_slice = slice,
        };
        loop->kernels->ring_normal( &args, slice, slice + 1 );
        for ( int lane = 0; lane < 8; ++lane )
        {
            int vertex = loop->fabric->slot_vertex[slice * 8 + lane];
            if ( vertex >= 0 )
            {
                loop->normals[vertex] = ( wisp_vec3 ){ normal[0][lane], normal[1][lane], normal[2][lane] };
            }
        }
    }
}

static void hand_out_normals( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    ring_loop loop = {
        .fabric = wisp_frame_fabric( frame, span->entity ),
        .kernels = wisp_frame_kernels( frame ),
        .position = position_of( frame, span ),
        .normals = wisp_frame_column( frame, span->entity, WISP_SURFACE_NORMALS, 0 ),
    };
    wisp_parallel_for( wisp_frame_parallel( frame, span ), loop.fabric->ring_slice_count, SLICE_GRAIN,
                       hand_out_slice_normals, &loop );
}

// Return the strain of the edge at a slot of links; 0 of a bend link, and of what pads.
static float edge_strain( const wisp_fabric* f, const float* position, int slot )
{
    const float *p = position + f->link_a_x4[slot], *q = position + f->link_b_x4[slot], rest = f->link_rest[slot];
    const bool is_edge = wisp_fabric_link_kind( f, slot ) == 0 && rest > 0.0f;
    return is_edge ? fabsf( wisp_v3_length( wisp_v3_sub( wisp_v3_load( p ), wisp_v3_load( q ) ) ) / rest - 1.0f )
                   : 0.0f;
}

// Raises the maximum strain of the edges at each vertex.
static void raise_strains( const void* context, int begin, int end )
{
    const ring_loop* loop = context;
    const wisp_fabric* f = loop->fabric;
    for ( int slot = begin; slot < end; ++slot )
    {
        const float strain = edge_strain( f, loop->position, slot );
        if ( strain > 0.0f )
        {
            float* a = loop->strain + f->slot_vertex[f->link_a_x4[slot] / 4];
            float* b = loop->strain + f->slot_vertex[f->link_b_x4[slot] / 4];
            *a = strain > *a ? strain : *a;
            *b = strain > *b ? strain : *b;
        }
    }
}

static void hand_out_strain( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const ring_loop loop = {
        .fabric = wisp_frame_fabric( frame, span->entity ),
        .position = position_of( frame, span ),
        .strain = wisp_frame_column( frame, span->entity, WISP_POINT_STRAIN, 0 ),
    };
    memset( loop.strain, 0, (size_t)loop.fabric->vertex_count * sizeof( float ) );
    wisp_run_schedule( wisp_frame_parallel( frame, span ), &loop.fabric->link_order, raise_strains, &loop );
}

// ---- statistics ----

static void sum_speeds( const wisp_fabric* f, const float* position, const float* velocity, wisp_motion_stats* q )
{
    double speed2 = 0.0;
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        const float *v = velocity + (size_t)slot * 4, weight = position[(size_t)slot * 4 + 3];
        const double v2 = (double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2];
        speed2 = v2 > speed2 ? v2 : speed2;
        q->kinetic_energy += weight > 0.0f ? 0.5 * v2 / (double)weight : 0.0;
    }
    q->speed_max = sqrt( speed2 );
}

// Moments about the first vertex, which reduces rounding far from the origin.
static void sum_momenta( const wisp_kernels* kernels, const wisp_fabric* f, const float* position,
                         const float* velocity, wisp_motion_stats* q )
{
    const wisp_moment_args args = { position, position, velocity, { position[0], position[1], position[2] } };
    wisp_moments m;
    kernels->moments( &args, 0, f->vertex_count, &m );
    q->mass = m.mass;
    double c[3];
    for ( int k = 0; k < 3; ++k )
    {
        c[k] = m.mass > 0.0 ? m.first[k] / m.mass : 0.0;
        q->centre[k] = m.mass > 0.0 ? (double)position[k] + c[k] : 0.0;
        q->momentum[k] = m.momentum[k];
    }
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        q->angular_momentum[k] = m.angular_momentum[k] - ( c[a] * m.momentum[b] - c[b] * m.momentum[a] );
    }
}

// Computes the volume relative to the first vertex, to reduce rounding far from the origin.
static double sum_volume( const wisp_fabric* f, const float* position )
{
    double volume = 0.0;
    const double3 o = double3_from( position );
    for ( const int32_t* v = f->triangles; v < f->triangles + 3 * (size_t)f->triangle_count; v += 3 )
    {
        const double3 a = double3_sub( double3_from( position + 4 * (size_t)v[0] ), o ),
                      b = double3_sub( double3_from( position + 4 * (size_t)v[1] ), o ),
                      c = double3_sub( double3_from( position + 4 * (size_t)v[2] ), o );
        volume += double3_dot( a, double3_cross( b, c ) );
    }
    return volume / 6.0;
}

static void take_motion_stats( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const float* position = position_of( frame, span );
    const float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    wisp_motion_stats* out = wisp_frame_column( frame, span->entity, WISP_MOTION_STATS, 0 );
    wisp_motion_stats q = { 0 };
    sum_speeds( fabric, position, velocity, &q );
    if ( fabric->vertex_count > 0 )
    {
        sum_momenta( kernels, fabric, position, velocity, &q );
        q.volume = sum_volume( fabric, position );
    }
    const wisp_link_args links = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                                   .a_x4 = fabric->link_a_x4,
                                   .b_x4 = fabric->link_b_x4,
                                   .rest = fabric->link_rest,
                                   .bends = fabric->link_bends };
    float strain;
    q.strain_mean = kernels->link_strain( &links, 0, fabric->link_order.slot_count, &strain ) /
                    ( fabric->edge_count > 0 ? fabric->edge_count : 1 );
    q.strain_max = (double)strain;
    const wisp_vec3 o = wisp_frame_offset( frame, span->entity );
    q.centre[0] -= (double)o.x;
    q.centre[1] -= (double)o.y;
    q.centre[2] -= (double)o.z;
    const double3 g = gravity != NULL ? double3_widen( *gravity ) : ( double3 ){ 0.0, 0.0, 0.0 };
    q.potential_energy = -q.mass * ( g.x * q.centre[0] + g.y * q.centre[1] + g.z * q.centre[2] );
    *out = q;
}

wisp_status passes_declare_surface( wisp_registry* registry )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "surface.points", OBSERVE, PARTICLE_BLOCK, hand_out_points ),
            .required = { WISP_PARTICLE_POSITION },
            .reads = { WISP_PARTICLE_POSITION },
            .writes = { WISP_SURFACE_POINTS },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "surface.speed", OBSERVE, PARTICLE_BLOCK, hand_out_speed ),
            .required = { WISP_PARTICLE_VELOCITY },
            .reads = { WISP_PARTICLE_VELOCITY },
            .writes = { WISP_POINT_SPEED },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "surface.normals", OBSERVE, ENTITY, hand_out_normals ),
            .required = { WISP_PARTICLE_POSITION },
            .reads = { WISP_PARTICLE_POSITION },
            .writes = { WISP_SURFACE_NORMALS },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .fabric = WISP_FABRIC_RINGS,
        },
        {
            WISP_PASS( "surface.strain", OBSERVE, ENTITY, hand_out_strain ),
            .required = { WISP_PARTICLE_POSITION },
            .reads = { WISP_PARTICLE_POSITION },
            .writes = { WISP_POINT_STRAIN },
        },
        {
            WISP_PASS( "entity.motion_stats", OBSERVE, ENTITY, take_motion_stats ),
            .required = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .reads = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_MOTION_STATS },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
    };
    return wisp_declare_passes( registry, passes, WISP_COUNT( passes ), NULL );
}
