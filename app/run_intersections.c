#include "run_intersections.h"

#include <stdio.h>
#include <stdlib.h>

/// Intersections of some entities in the steps of a run.
typedef struct tally
{
    int first, second; ///< bodies of the scene's world; the same: of a body with itself
    int steps;         ///< that ended with any
    int most, most_at; ///< the most of a step, and that step, counted from 1
    int last, last_at; ///< of the last step that ended with any, and that step
} tally;

struct run_intersections
{
    scene_world* world;
    tally all;
    tally* pairs; ///< [pair_count] that ever intersected, in the order of that
    int pair_count, pair_room;
    int steps; ///< that were counted
};

// ---- reading ----

wisp_status run_intersections_open( scene_world* world, run_intersections** out, wisp_error* error )
{
    *out = NULL;
    if ( !world->scene->request_intersections )
    {
        return WISP_OK;
    }
    *out = calloc( 1, sizeof **out );
    if ( *out == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for intersections" );
    }
    ( *out )->world = world;
    return WISP_OK;
}

void run_intersections_close( run_intersections* intersections )
{
    if ( intersections != NULL )
    {
        free( intersections->pairs );
        free( intersections );
    }
}

static bool takes_part( const wisp_scene* scene, int body )
{
    return body < scene->strands_count ? scene->strands[body].has_contact
                                       : scene->surfaces[body - scene->strands_count].has_contact;
}

static void add_count( tally* t, int count, int step )
{
    t->steps += 1;
    t->most_at = count > t->most ? step : t->most_at;
    t->most = count > t->most ? count : t->most;
    t->last = count;
    t->last_at = step;
}

// Of two bodies; made if they have none yet. @return null without memory
static tally* find_tally( run_intersections* x, int first, int second )
{
    for ( int i = 0; i < x->pair_count; ++i )
    {
        if ( x->pairs[i].first == first && x->pairs[i].second == second )
        {
            return &x->pairs[i];
        }
    }
    if ( x->pair_count == x->pair_room )
    {
        const int room = 2 * x->pair_room + 8;
        tally* grown = realloc( x->pairs, (size_t)room * sizeof *grown );
        if ( grown == NULL )
        {
            return NULL;
        }
        x->pairs = grown;
        x->pair_room = room;
    }
    x->pairs[x->pair_count] = ( tally ){ .first = first, .second = second };
    return &x->pairs[x->pair_count++];
}

static wisp_status add_pair( run_intersections* x, int first, int second, int* left, wisp_error* error )
{
    wisp_world* world = x->world->world;
    int count = 0;
    const wisp_status status = wisp_read_contact_intersections( world, scene_world_entity( x->world, first ),
                                                                scene_world_entity( x->world, second ), &count );
    if ( status != WISP_OK || count == 0 )
    {
        return status == WISP_OK
                   ? WISP_OK
                   : wisp_fail( error, status, "%s: %s", x->world->scene->name, wisp_world_message( world ) );
    }
    tally* pair = find_tally( x, first, second );
    if ( pair == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for intersections" );
    }
    add_count( pair, count, x->world->next_step );
    *left -= count;
    return WISP_OK;
}

wisp_status run_intersections_step( run_intersections* x, wisp_error* error )
{
    wisp_contact_stats stats;
    // Without participants there are no statistics. The notes on contact say so.
    if ( x == NULL || wisp_read_contact_stats( x->world->world, &stats ) != WISP_OK || stats.intersections < 0 )
    {
        return WISP_OK;
    }
    x->steps += 1;
    if ( stats.intersections > 0 )
    {
        add_count( &x->all, stats.intersections, x->world->next_step );
    }
    const int body_count = scene_world_moving_count( x->world );
    int left = stats.intersections;
    wisp_status status = WISP_OK;
    for ( int a = 0; a < body_count && left > 0 && status == WISP_OK; ++a )
    {
        for ( int b = a; b < body_count && left > 0 && status == WISP_OK; ++b )
        {
            const bool are_in = takes_part( x->world->scene, a ) && takes_part( x->world->scene, b );
            status = are_in ? add_pair( x, a, b, &left, error ) : WISP_OK;
        }
    }
    return status;
}

// ---- the summary ----

static int last_of( const run_intersections* x, const tally* t )
{
    return t->last_at == x->world->next_step ? t->last : 0;
}

void run_intersections_put( const run_intersections* x, results_values* values )
{
    if ( x != NULL && x->steps > 0 )
    {
        results_put( values, "max_intersections", x->all.most );
        results_put( values, "steps_with_intersections", x->all.steps );
    }
}

void run_intersections_describe( const run_intersections* x, char* out, size_t size )
{
    if ( x == NULL || x->steps == 0 )
    {
        snprintf( out, size, "%s", "" );
    }
    else if ( x->all.steps == 0 )
    {
        snprintf( out, size, "none in %d steps", x->steps );
    }
    else
    {
        snprintf( out, size, "in %d of %d steps; at most %d, in step %d; %d at the end", x->all.steps, x->steps,
                  x->all.most, x->all.most_at, last_of( x, &x->all ) );
    }
}

void run_intersections_report( const run_intersections* x, results* out )
{
    if ( x == NULL || x->pair_count == 0 )
    {
        return;
    }
    const int table =
        results_add_table( out, "Intersections: edges through triangles at the end of a step", 6,
                           ( const char* const[] ){ "of", "with", "steps", "most", "in step", "at the end" } );
    for ( int i = 0; i < x->pair_count; ++i )
    {
        const tally* t = &x->pairs[i];
        char text[4][24];
        snprintf( text[0], sizeof text[0], "%d", t->steps );
        snprintf( text[1], sizeof text[1], "%d", t->most );
        snprintf( text[2], sizeof text[2], "%d", t->most_at );
        snprintf( text[3], sizeof text[3], "%d", last_of( x, t ) );
        const char* cells[] = { scene_world_body( x->world, t->first ).name,
                                t->first == t->second ? "itself" : scene_world_body( x->world, t->second ).name,
                                text[0],
                                text[1],
                                text[2],
                                text[3] };
        results_add_cells( out, table, cells );
    }
}
