#include "figures_tuft.h"

#include <math.h>
#include <stdlib.h>

const wisp_vec3 tuft_target_colour = { 0.08f, 0.05f, 0.03f };
const wisp_vec3 tuft_ghost_colour = { 0.55f, 0.32f, 0.12f };
const wisp_vec3 tuft_line_colour = { 0.75f, 0.05f, 0.05f };

wisp_vec3 tuft_minus( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

double tuft_dot( wisp_vec3 a, wisp_vec3 b )
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
}

double tuft_length( wisp_vec3 a )
{
    return sqrt( tuft_dot( a, a ) );
}

static wisp_vec3 target_point( int node, int nodes )
{
    float s = (float)node / (float)( nodes - 1 );
    return ( wisp_vec3 ){ 0.1f + 0.12f * s - 0.05f * s * s, 0.05f - 0.12f * s * s, 0.02f * s };
}

wisp_status tuft_make( int ghost_count, int ghost_nodes, tuft* t, wisp_error* error )
{
    wisp_status status = strands_shape_create( 1, TUFT_NODES, &t->target, error );
    status = status == WISP_OK ? strands_shape_create( ghost_count, ghost_nodes, &t->ghosts, error ) : status;
    for ( int node = 0; node < TUFT_NODES && status == WISP_OK; ++node )
    {
        t->target.points[node] = target_point( node, TUFT_NODES );
    }
    for ( int i = 0; i < ghost_count * ghost_nodes && status == WISP_OK; ++i )
    {
        int ghost = i / ghost_nodes, node = i % ghost_nodes;
        float angle = 2.4f * (float)ghost, s = (float)node / (float)( ghost_nodes - 1 );
        float radius = 0.004f * (float)( ghost + 1 ) * ( 1.0f + s );
        wisp_vec3 p = target_point( node, ghost_nodes );
        t->ghosts.points[i] = ( wisp_vec3 ){ p.x + radius * sinf( angle ), p.y, p.z + radius * cosf( angle ) };
    }
    return status;
}

void tuft_free( tuft* t )
{
    hair_head_destroy( &t->swaying );
    hair_head_destroy( &t->plain );
    strands_shape_free( &t->target );
    strands_shape_free( &t->ghosts );
}

wisp_ghosts_def tuft_without_weights( void )
{
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.elastic = WISP_GHOST_ELASTIC_OFF;
    def.tip_gain = 0.0f;
    def.centre_gain = 0.0f;
    return def;
}

wisp_status tuft_enter( tuft* t, const wisp_ghosts_def* follow, wisp_error* error )
{
    hair_head_generator generator = hair_head_default_generator( &t->target );
    generator.ghosts = &t->ghosts;
    generator.shows_moving = true;
    generator.follow = *follow;
    wisp_status status = hair_head_create( &generator, &t->swaying, error );
    generator.follow = tuft_without_weights();
    generator.follow.resample = follow->resample;
    return status == WISP_OK ? hair_head_create( &generator, &t->plain, error ) : status;
}

wisp_status tuft_advance( tuft* t, seen* s, wisp_error* error )
{
    for ( int i = 0; i < TUFT_NODES; ++i )
    {
        s->before[i] = s->now[i];
    }
    wisp_status status = hair_head_step( &t->swaying, error );
    status = status == WISP_OK ? hair_head_step( &t->plain, error ) : status;
    status = status == WISP_OK ? hair_head_points( &t->swaying, &s->swaying, error ) : status;
    status = status == WISP_OK ? hair_head_points( &t->plain, &s->base, error ) : status;
    status = status == WISP_OK ? hair_head_moving_points( &t->swaying, &s->target, error ) : status;
    if ( status == WISP_OK )
    {
        hair_head_moving_velocities( &t->swaying, s->now );
    }
    return status;
}

wisp_vec3 tuft_mean( const wisp_vec3* points, int ghost_count, int node )
{
    double sum[3] = { 0.0, 0.0, 0.0 };
    for ( int g = 0; g < ghost_count; ++g )
    {
        wisp_vec3 p = points[g * TUFT_NODES + node];
        sum[0] += (double)p.x;
        sum[1] += (double)p.y;
        sum[2] += (double)p.z;
    }
    return ( wisp_vec3 ){ (float)( sum[0] / ghost_count ), (float)( sum[1] / ghost_count ),
                          (float)( sum[2] / ghost_count ) };
}

#define LINE_RADIUS 0.0004f

static wisp_vec3 plus( wisp_vec3 a, float factor, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x + factor * b.x, a.y + factor * b.y, a.z + factor * b.z };
}

// Ends of the lines of a shot, and of its bar. @return how many lines
static int collect_lines( const tuft* t, const seen* s, const tuft_lines* lines, wisp_vec3* out )
{
    const float times = lines->magnified > 0.0f ? lines->magnified : 1.0f;
    int count = 0;
    for ( int i = 0; i < strands_shape_size( &t->ghosts ); ++i )
    {
        const wisp_vec3 end = lines->to_centre ? tuft_mean( s->swaying, t->ghosts.strand_count, i % TUFT_NODES )
                                               : plus( s->base[i], times, tuft_minus( s->swaying[i], s->base[i] ) );
        const wisp_vec3 begin = lines->to_centre ? s->swaying[i] : s->base[i];
        if ( tuft_length( tuft_minus( end, begin ) ) > (double)LINE_RADIUS )
        {
            out[2 * count] = begin;
            out[2 * count++ + 1] = end;
        }
    }
    if ( lines->bar > 0.0f )
    {
        const wisp_vec3 under = { 0.0f, -0.02f, 0.0f }, along = { times * lines->bar, 0.0f, 0.0f };
        out[2 * count] = plus( s->target[0], 1.0f, under );
        out[2 * count + 1] = plus( out[2 * count], 1.0f, along );
        count += 1;
    }
    return count;
}

// Add a layer as seen from a point that moves with the head, so that shots of all times fill their pictures.
static wisp_status add_from( const figures_case* page, figures_hair_album* album, wisp_vec3 from,
                             const wisp_vec3* points, int strands, int vertices, wisp_vec3 colour, float radius,
                             wisp_error* error )
{
    wisp_vec3* moved = malloc( (size_t)strands * (size_t)vertices * sizeof( wisp_vec3 ) );
    if ( !moved )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture of ghosts" );
    }
    for ( int i = 0; i < strands * vertices; ++i )
    {
        moved[i] = tuft_minus( points[i], from );
    }
    const wisp_status status = figures_hair_add( page, album, moved, strands, vertices, colour, radius, error );
    free( moved );
    return status;
}

wisp_status tuft_take( const figures_case* page, figures_hair_album* album, const tuft* t, const seen* s,
                       const tuft_lines* lines, wisp_error* error )
{
    const wisp_vec3 root = s->target[0];
    wisp_vec3* ends = malloc( 2 * ( (size_t)strands_shape_size( &t->ghosts ) + 1 ) * sizeof( wisp_vec3 ) );
    if ( !ends )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for difference lines" );
    }
    wisp_status status =
        add_from( page, album, root, s->target, 1, t->target.vertices, tuft_target_colour, 0.0008f, error );
    status = status == WISP_OK ? add_from( page, album, root, s->swaying, t->ghosts.strand_count, t->ghosts.vertices,
                                           tuft_ghost_colour, 0.0005f, error )
                               : status;
    const int count = collect_lines( t, s, lines, ends );
    if ( status == WISP_OK && count > 0 )
    {
        status = add_from( page, album, root, ends, count, 2, tuft_line_colour, LINE_RADIUS, error );
    }
    free( ends );
    return status;
}
