#include "run_collision.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct body_record
{
    int body;                           ///< of the scene's world
    int step;                           ///< of `deepest`, counted from 1; 0: nothing was too near to a collider
    wisp_collision_stats deepest, last; ///< of the run; of the last step
} body_record;

/// What participants give to a collider.
typedef struct reaction_record
{
    int collider;
    double impulse[3]; ///< N s, of the run
    double largest;    ///< N, of a step: impulse over its length
    int step;          ///< of the largest, counted from 1; 0: there was none
} reaction_record;

struct run_collision
{
    scene_world* world;
    body_record* bodies; ///< [count]
    int count;
    reaction_record* reactions; ///< [reaction_count]
    int reaction_count;
    double seconds; ///< that were simulated
};

// ---- reading ----

static bool is_requested( const wisp_scene* scene, int body )
{
    return body < scene->strands_count ? scene->strands[body].request_contacts
                                       : scene->surfaces[body - scene->strands_count].request_contacts;
}

wisp_status run_collision_open( scene_world* world, run_collision** out, wisp_error* error )
{
    *out = NULL;
    const int body_count = scene_world_moving_count( world ), collider_count = world->scene->collider_count;
    run_collision* c = calloc( 1, sizeof *c );
    body_record* bodies = calloc( (size_t)body_count + 1, sizeof *bodies );
    reaction_record* reactions = calloc( (size_t)collider_count + 1, sizeof *reactions );
    int count = 0, reaction_count = 0;
    for ( int i = 0; i < collider_count && reactions != NULL; ++i )
    {
        if ( world->scene->colliders[i].request_reaction )
        {
            reactions[reaction_count++] = ( reaction_record ){ .collider = i };
        }
    }
    for ( int body = 0; body < body_count && bodies != NULL; ++body )
    {
        if ( is_requested( world->scene, body ) )
        {
            bodies[count++] = ( body_record ){ .body = body };
        }
    }
    if ( c == NULL || bodies == NULL || reactions == NULL || count + reaction_count == 0 )
    {
        const bool is_refused = c == NULL || bodies == NULL || reactions == NULL;
        free( c );
        free( bodies );
        free( reactions );
        return is_refused ? wisp_fail( error, WISP_NO_MEMORY, "run: out of memory for collision statistics" )
                          : WISP_OK;
    }
    *c = ( run_collision ){ world, bodies, count, reactions, reaction_count, 0.0 };
    *out = c;
    return WISP_OK;
}

static wisp_status add_reactions( run_collision* c, wisp_error* error )
{
    const scene_world* world = c->world;
    const double seconds = (double)wisp_scene_step_length( world->scene, world->next_step - 1 );
    c->seconds += seconds;
    for ( int i = 0; i < c->reaction_count; ++i )
    {
        reaction_record* r = &c->reactions[i];
        wisp_reaction now;
        const wisp_status status = wisp_read_reaction( world->world, world->colliders[r->collider].entity, &now );
        if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "%s: %s", world->scene->name, wisp_world_message( world->world ) );
        }
        const double p[3] = { (double)now.impulse.x, (double)now.impulse.y, (double)now.impulse.z };
        const double force = sqrt( p[0] * p[0] + p[1] * p[1] + p[2] * p[2] ) / seconds;
        for ( int k = 0; k < 3; ++k )
        {
            r->impulse[k] += p[k];
        }
        r->step = force > r->largest ? world->next_step : r->step;
        r->largest = fmax( r->largest, force );
    }
    return WISP_OK;
}

wisp_status run_collision_step( run_collision* collision, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; collision != NULL && i < collision->count && status == WISP_OK; ++i )
    {
        body_record* b = &collision->bodies[i];
        status = scene_world_collision_stats( collision->world, b->body, &b->last, error );
        if ( status == WISP_OK && b->last.vertex >= 0 &&
             ( b->step == 0 || b->last.penetration > b->deepest.penetration ) )
        {
            b->deepest = b->last;
            b->step = collision->world->next_step;
        }
    }
    return status == WISP_OK && collision != NULL ? add_reactions( collision, error ) : status;
}

void run_collision_close( run_collision* collision )
{
    if ( collision != NULL )
    {
        free( collision->bodies );
        free( collision->reactions );
        free( collision );
    }
}

// ---- the summary ----

void run_collision_put( const run_collision* collision, results_values* values )
{
    float deepest = 0.0f;
    for ( int i = 0; collision != NULL && i < collision->count; ++i )
    {
        const body_record* b = &collision->bodies[i];
        deepest = b->step > 0 && b->deepest.penetration > deepest ? b->deepest.penetration : deepest;
    }
    if ( collision != NULL && collision->count > 0 )
    {
        results_put( values, "collision_penetration", (double)deepest );
    }
}

// Vertices keep the thickness; those of an implicit cloth may be within it, and their penetration is below the surface.
static double depth_below_surface( const run_collision* collision, const body_record* b )
{
    const int surface = b->body - collision->world->scene->strands_count;
    const bool is_implicit = surface >= 0 && collision->world->scene->surfaces[surface].has_implicit;
    return (double)b->deepest.penetration - ( is_implicit ? 0.0 : (double)b->deepest.thickness );
}

static void add_body( const run_collision* collision, const body_record* b, int table, results* out )
{
    char text[6][24];
    snprintf( text[0], sizeof text[0], "%.4g", 1e3 * (double)b->deepest.penetration );
    snprintf( text[1], sizeof text[1], "%.4g", 1e3 * (double)b->deepest.thickness );
    snprintf( text[2], sizeof text[2], "%d", b->deepest.vertex );
    snprintf( text[3], sizeof text[3], "%d", b->step );
    snprintf( text[4], sizeof text[4], "%.4g", b->last.vertex >= 0 ? 1e3 * (double)b->last.penetration : 0.0 );
    snprintf( text[5], sizeof text[5], "%d", b->last.contacts );
    const char* cells[] = { scene_world_body( collision->world, b->body ).name,
                            text[0],
                            b->step > 0 ? text[1] : "",
                            b->step > 0 ? text[2] : "",
                            b->step > 0 ? text[3] : "",
                            text[4],
                            text[5] };
    results_add_cells( out, table, cells );
}

static void report_reactions( const run_collision* c, results* out )
{
    const int table = results_add_table(
        out, "Reaction of colliders, mean force of the run and largest of a step", 6,
        ( const char* const[] ){ "collider", "mean x N", "mean y N", "mean z N", "largest N", "step" } );
    for ( int i = 0; i < c->reaction_count; ++i )
    {
        const reaction_record* r = &c->reactions[i];
        char text[5][24];
        for ( int k = 0; k < 3; ++k )
        {
            snprintf( text[k], sizeof text[k], "%.4g", r->impulse[k] / c->seconds );
        }
        snprintf( text[3], sizeof text[3], "%.4g", r->largest );
        snprintf( text[4], sizeof text[4], "%d", r->step );
        const char* cells[] = { c->world->scene->colliders[r->collider].name,
                                text[0],
                                text[1],
                                text[2],
                                text[3],
                                r->step > 0 ? text[4] : "" };
        results_add_cells( out, table, cells );
    }
}

void run_collision_report( const run_collision* collision, results* out )
{
    if ( collision != NULL && collision->reaction_count > 0 )
    {
        report_reactions( collision, out );
    }
    if ( collision == NULL || collision->count == 0 )
    {
        return;
    }
    const int table = results_add_table(
        out, "Penetration into the thickness, deepest of the run and at the end", 7,
        ( const char* const[] ){ "body", "deepest mm", "thickness mm", "vertex", "step", "end mm", "contacts" } );
    for ( int i = 0; i < collision->count; ++i )
    {
        const body_record* b = &collision->bodies[i];
        add_body( collision, b, table, out );
        const double below = depth_below_surface( collision, b );
        if ( b->step > 0 && below > 0.0 )
        {
            results_add_note( out, "%s: vertex %d was %.3g mm below the surface of a collider in step %d",
                              scene_world_body( collision->world, b->body ).name, b->deepest.vertex, 1e3 * below,
                              b->step );
        }
    }
}
