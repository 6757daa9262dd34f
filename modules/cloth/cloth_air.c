// Air on triangles: drag along the relative wind and lift across it, by the area that a triangle turns to the wind.
//
// A triangle of area A with unit normal n and mean velocity v, u = wind - v, feels
//
//   F = 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') / |u| u ) ),   n' = n turned to the side u blows to,
//
// so that drag is 1/2 rho C_d A |u|^2 where the wind is square on, and lift is perpendicular to u. Each vertex takes
// a third of the forces of its triangles, gathered over its ring: no scatter, so the order of the sum is fixed.
#include "cloth_internal.h"

#include <math.h>

typedef struct air_loop
{
    const wisp_fabric* fabric;
    const float* position;
    const float* old_velocity; // of the beginning of the pass: neighbours must not see what was changed
    float* velocity;
    cloth_air air;
    float dt;
} air_loop;

static wisp_vec3 load( const float* quads, int slot )
{
    const float* q = quads + (size_t)slot * 4;
    return ( wisp_vec3 ){ q[0], q[1], q[2] };
}

static wisp_vec3 subtract( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static float dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static wisp_vec3 combine( float s, wisp_vec3 a, float t, wisp_vec3 b )
{
    return ( wisp_vec3 ){ s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z };
}

// Force on the triangle (slot, a, b), and how fast it takes the relative wind away: N and N s/m.
static wisp_vec3 triangle_force( const air_loop* loop, int slot, int a, int b, float* rate )
{
    const wisp_vec3 p = load( loop->position, slot );
    const wisp_vec3 e = subtract( load( loop->position, a ), p ), f = subtract( load( loop->position, b ), p );
    const wisp_vec3 cross = { e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x };
    float twice_area = sqrtf( dot( cross, cross ) );
    const wisp_vec3 v0 = load( loop->old_velocity, slot ), v1 = load( loop->old_velocity, a );
    const wisp_vec3 mean =
        combine( 1.0f / 3.0f, combine( 1.0f, v0, 1.0f, v1 ), 1.0f / 3.0f, load( loop->old_velocity, b ) );
    const wisp_vec3 u = subtract( loop->air.wind, mean );
    float speed = sqrtf( dot( u, u ) );
    *rate = 0.0f;
    if ( !( twice_area >= 1e-30f && speed >= 1e-30f ) )
    {
        return ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    }
    float facing = dot( u, cross ) / twice_area; // u . n, m/s
    float side = facing < 0.0f ? -1.0f : 1.0f;
    const wisp_vec3 n = combine( side / twice_area, cross, 0.0f, cross );
    float pressure = 0.25f * loop->air.density * twice_area * fabsf( facing ); // 1/2 rho A |u . n|
    const wisp_vec3 across = combine( speed, n, -fabsf( facing ) / speed, u );
    *rate = pressure * ( loop->air.drag + loop->air.lift );
    return combine( pressure * loop->air.drag, u, pressure * loop->air.lift, across );
}

// Explicit air can turn a light vertex round in one step; an implicit factor in the rate keeps it from passing the
// wind.
static void blow_slot( const air_loop* loop, int slot )
{
    const wisp_fabric* f = loop->fabric;
    float w = loop->position[(size_t)slot * 4 + 3];
    wisp_vec3 force = { 0.0f, 0.0f, 0.0f };
    float rate = 0.0f;
    for ( int e = f->ring_begin[slot / 8] + 1; e < f->ring_begin[slot / 8 + 1] && w > 0.0f; ++e )
    {
        int a = f->ring4[e - 1][slot % 8] / 4, b = f->ring4[e][slot % 8] / 4;
        if ( a != slot && b != slot )
        {
            float own = 0.0f;
            force = combine( 1.0f, force, 1.0f / 3.0f, triangle_force( loop, slot, a, b, &own ) );
            rate += own / 3.0f;
        }
    }
    float change = loop->dt * w / ( 1.0f + loop->dt * w * rate );
    float* v = loop->velocity + (size_t)slot * 4;
    const float* old = loop->old_velocity + (size_t)slot * 4;
    v[0] = old[0] + change * force.x;
    v[1] = old[1] + change * force.y;
    v[2] = old[2] + change * force.z;
}

static void blow_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const air_loop* loop = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        blow_slot( loop, slot );
    }
}

static void copy_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const air_loop* loop = context;
    float* copy = (float*)(void*)(uintptr_t)loop->old_velocity;
    for ( size_t i = (size_t)begin * 4; i < (size_t)end * 4; ++i )
    {
        copy[i] = loop->velocity[i];
    }
}

void cloth_blow( wisp_frame* frame, const wisp_span* span, void* user )
{
    enum
    {
        GRAIN = 512,
    };
    const cloth_state* state = user;
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const size_t bytes = (size_t)fabric->slot_count * 4 * sizeof( float );
    air_loop loop = {
        .fabric = fabric,
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .old_velocity = wisp_parallel_scratch( parallel, span->worker, bytes ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .air = *(cloth_air*)wisp_frame_column( frame, span->entity, state->air, 0 ),
        .dt = wisp_frame_seconds( frame ),
    };
    if ( loop.old_velocity == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "no memory for the air on %d particles", fabric->slot_count );
        return;
    }
    wisp_parallel_for( parallel, fabric->slot_count, GRAIN, copy_slots, &loop );
    wisp_parallel_for( parallel, fabric->vertex_count, GRAIN, blow_slots, &loop );
}
