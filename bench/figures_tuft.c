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
    def.capped = false;
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
    generator.follow.frame = follow->frame;
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

wisp_status tuft_take( const figures_case* page, figures_hair_album* album, const tuft* t, const seen* s,
                       wisp_error* error )
{
    int count = strands_shape_size( &t->ghosts );
    wisp_vec3* lines = malloc( 2 * (size_t)count * sizeof( wisp_vec3 ) );
    if ( !lines )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for difference lines" );
    }
    for ( int i = 0; i < count; ++i )
    {
        lines[2 * i] = s->base[i];

        // A curve without length has no direction to be drawn along.
        lines[2 * i + 1] = s->swaying[i];
        lines[2 * i + 1].y += 1e-5f;
    }
    wisp_status status =
        figures_hair_add( page, album, s->target, 1, t->target.vertices, tuft_target_colour, 0.0008f, error );
    status = status == WISP_OK ? figures_hair_add( page, album, s->swaying, t->ghosts.strand_count,
                                                   t->ghosts.vertices, tuft_ghost_colour, 0.0005f, error )
                               : status;
    status = status == WISP_OK ? figures_hair_add( page, album, lines, count, 2, tuft_line_colour, 0.0004f, error )
                               : status;
    free( lines );
    return status;
}
