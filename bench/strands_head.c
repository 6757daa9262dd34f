#include "strands_head.h"

#include "wisp/module/module.h"

#include <math.h>

#define HEAD_RADIUS 0.1f // m
#define HAIR_LENGTH 0.2f // m, of the longest
#define WAVE 0.006f      // m

// ---- hair ----

// A number in [0, 1) that belongs to a strand.
static float chance( int strand, int which )
{
    uint32_t x = 2654435761u * (uint32_t)( 4 * strand + which + 1 );
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    x ^= x >> 16;
    return (float)( x >> 8 ) * 0x1p-24f;
}

// Off the head along the normal of the root and down, with a small wave whose phase is the strand's own: hair that hangs
// is in stable balance, so what moves it is the head.
static void grow( int strand, wisp_vec3 normal, int vertices, wisp_vec3* points )
{
    float length = HAIR_LENGTH * ( 0.85f + 0.15f * chance( strand, 0 ) );
    float phase = 6.2831853f * chance( strand, 1 );
    for ( int v = 0; v < vertices; ++v )
    {
        float s = (float)v / (float)( vertices - 1 );
        float out = HEAD_RADIUS + length * ( 0.3f * s - 0.15f * s * s ), down = length * 0.85f * s, wave = WAVE * s;
        points[v] = ( wisp_vec3 ){ out * normal.x + wave * sinf( 9.0f * s + phase ), out * normal.y - down,
                                   out * normal.z + wave * cosf( 9.0f * s + phase ) };
    }
}

wisp_status hair_head_make_hair( int side, int vertices, strands_shape* out, wisp_error* error )
{
    wisp_status status = strands_shape_create( side * side, vertices, out, error );
    for ( int s = 0; s < side * side && status == WISP_OK; ++s )
    {
        // rows and columns are heights and directions on the side of a sphere
        float around = 3.0f * ( ( (float)( s % side ) + 0.5f ) / (float)side - 0.5f );
        float above = 0.7f * ( (float)( s / side ) + 0.5f ) / (float)side;
        const wisp_vec3 normal = { cosf( above ) * sinf( around ), sinf( above ), cosf( above ) * cosf( around ) };
        grow( s, normal, vertices, out->points + (size_t)s * (size_t)vertices );
    }
    return status;
}

wisp_status hair_head_make_guides( const strands_shape* hair, int ratio, strands_shape* out, wisp_error* error )
{
    int side = (int)lround( sqrt( (double)hair->strand_count ) ), edge = (int)lround( sqrt( (double)ratio ) );
    int blocks = side / edge;
    wisp_status status = strands_shape_create( blocks * blocks, hair->vertices, out, error );
    for ( int g = 0; g < blocks * blocks && status == WISP_OK; ++g )
    {
        for ( int v = 0; v < hair->vertices; ++v )
        {
            double sum[3] = { 0.0, 0.0, 0.0 };
            for ( int k = 0; k < edge * edge; ++k )
            {
                int strand = ( g / blocks * edge + k / edge ) * side + g % blocks * edge + k % edge;
                wisp_vec3 p = hair->points[(size_t)strand * (size_t)hair->vertices + (size_t)v];
                sum[0] += (double)p.x;
                sum[1] += (double)p.y;
                sum[2] += (double)p.z;
            }
            double fraction = 1.0 / ( edge * edge );
            out->points[(size_t)g * (size_t)hair->vertices + (size_t)v] =
                ( wisp_vec3 ){ (float)( fraction * sum[0] ), (float)( fraction * sum[1] ),
                               (float)( fraction * sum[2] ) };
        }
    }
    return status;
}

// ---- worlds ----

hair_head_generator hair_head_default_generator( const strands_shape* moving )
{
    return ( hair_head_generator ){
        .moving = moving,
        .follow = wisp_default_ghosts_def(),
        .dynamics = wisp_default_strand_dynamics_def(),
        .substeps = 10,
        .workers = 1,
    };
}

static wisp_status add( wisp_world* world, const strands_shape* shape, wisp_entity* out )
{
    wisp_strands_def def = wisp_default_strands_def();
    def.points = shape->points;
    def.offsets = shape->offsets;
    def.strand_count = shape->strand_count;
    return wisp_add_strands( world, &def, out );
}

static wisp_status add_all( hair_head* head )
{
    wisp_status status = add( head->world, head->generator.moving, &head->moving );
    if ( status == WISP_OK )
    {
        status = wisp_set_strand_dynamics( head->world, head->moving, &head->generator.dynamics );
    }
    if ( status == WISP_OK && head->generator.ghosts )
    {
        status = add( head->world, head->generator.ghosts, &head->ghosts );
        head->generator.follow.targets = head->moving;
        status = status == WISP_OK ? wisp_set_ghosts( head->world, head->ghosts, &head->generator.follow ) : status;
        status = status == WISP_OK ? wisp_request( head->world, head->ghosts, WISP_STRAND_POINTS ) : status;
    }
    if ( status == WISP_OK && ( !head->generator.ghosts || head->generator.shows_moving ) )
    {
        status = wisp_request( head->world, head->moving, WISP_STRAND_POINTS );
    }
    return status;
}

wisp_status hair_head_create( const hair_head_generator* generator, hair_head* out, wisp_error* error )
{
    const wisp_module* modules[] = { &wisp_strands_module, &wisp_guide_hair_module };
    *out = ( hair_head ){ .generator = *generator };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.log = bench_world_drop_log;
    def.workers = generator->workers;
    def.substeps = generator->substeps;
    wisp_status status = wisp_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_all( out );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        hair_head_destroy( out );
    }
    return status;
}

void hair_head_destroy( hair_head* head )
{
    wisp_world_destroy( head->world );
    profile_samples_free( &head->profile );
    *head = ( hair_head ){ 0 };
}

wisp_transform hair_head_pose( double seconds )
{
    // The ramp keeps the first step from being a blow.
    double ramp = fmin( seconds / 0.25, 1.0 );
    double sway = 0.04 * ramp * sin( 9.42477796 * seconds ), turn = 0.35 * ramp * sin( 7.0 * seconds );
    const wisp_quat rotation = { 0.0f, (float)sin( 0.5 * turn ), 0.0f, (float)cos( 0.5 * turn ) };
    const wisp_vec3 translation = { (float)sway, 0.0f, 0.0f };
    return wisp_transform_make( rotation, translation );
}

wisp_status hair_head_step_to( hair_head* head, wisp_transform pose, wisp_error* error )
{
    wisp_status status = wisp_move_strand_head( head->world, head->moving, pose );
    status = status == WISP_OK ? wisp_world_step( head->world, STRANDS_STEP ) : status;
    ++head->steps;
    return status == WISP_OK ? WISP_OK : bench_world_fail( head->world, status, error );
}

wisp_status hair_head_step( void* context, wisp_error* error )
{
    hair_head* head = context;
    return hair_head_step_to( head, hair_head_pose( (double)STRANDS_STEP * ( head->steps + 1 ) ), error );
}

wisp_status hair_head_keep_profile( void* context )
{
    hair_head* head = context;
    return profile_samples_add( &head->profile, wisp_world_profile( head->world ) );
}

// ---- what it shows ----

wisp_status hair_head_points( hair_head* head, const wisp_vec3** points, wisp_error* error )
{
    if ( head->generator.ghosts == NULL )
    {
        return hair_head_moving_points( head, points, error );
    }
    return bench_world_points( head->world, head->ghosts, WISP_STRAND_POINTS,
                               strands_shape_size( head->generator.ghosts ), points, error );
}

wisp_status hair_head_moving_points( hair_head* head, const wisp_vec3** points, wisp_error* error )
{
    return bench_world_points( head->world, head->moving, WISP_STRAND_POINTS,
                               strands_shape_size( head->generator.moving ), points, error );
}

void hair_head_moving_velocities( hair_head* head, wisp_vec3* out )
{
    const wisp_strand_topology* t = wisp_world_strands( head->world, head->moving );
    const float* velocity = wisp_world_column( head->world, head->moving, WISP_STRAND_VELOCITY, 0 );
    for ( int group = 0; group < t->group_count; ++group )
    {
        for ( int lane = 0; lane < 16; ++lane )
        {
            int strand = t->lane_strand[16 * group + lane];
            for ( int v = 0; v < t->lane_count[16 * group + lane]; ++v )
            {
                const float* row = velocity + 48 * (size_t)( t->group_row[group] + v ) + lane;
                out[t->offsets[strand] + v] = ( wisp_vec3 ){ row[0], row[16], row[32] };
            }
        }
    }
}

wisp_status hair_head_hash( hair_head* head, uint64_t* hash, wisp_error* error )
{
    wisp_entity seen = head->generator.ghosts ? head->ghosts : head->moving;
    return bench_world_hash( head->world, seen, WISP_STRAND_POINTS, hash, error );
}
