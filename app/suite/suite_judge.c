// A row is run once for its trace, again from rest if it starts elsewhere, and again for its bits.
#include "suite_judge.h"

#include "text_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the same scene from rest ----

// A scaled rest shape stays what it is.
static void remove_starts( text_node* scene, const char* list )
{
    static const char* const keys[] = { "shape", "turns" };
    const text_node* bodies = text_find( scene, list );
    for ( int i = 0; bodies && i < bodies->count; ++i )
    {
        text_node* start = text_find( bodies->children[i], "start" );
        for ( int k = 0; start && k < WISP_COUNT( keys ); ++k )
        {
            text_remove_key( start, keys[k] );
        }
        if ( start && text_find( start, "shake" ) == NULL )
        {
            text_remove_key( start, "seed" );
        }
        if ( start && start->count == 0 )
        {
            text_remove_key( bodies->children[i], "start" );
        }
    }
}

// Rows that differ in their starts alone have the same key.
static uint64_t key_of( const suite_row* row )
{
    uint64_t key = 0xcbf29ce484222325u ^ (uint64_t)row->steps;
    text_node* tree = NULL;
    if ( text_parse( row->text, strlen( row->text ), row->path, &tree, NULL ) == WISP_OK )
    {
        remove_starts( tree, "surfaces" );
        remove_starts( tree, "strands" );
        char* text = text_write( tree, NULL );
        for ( const char* c = text; *c; ++c )
        {
            key = ( key ^ (unsigned char)*c ) * 0x100000001b3u;
        }
        free( text );
    }
    text_release( tree );
    return key;
}

static bool is_elsewhere( const wisp_scene_start* start )
{
    return start->shape != WISP_SCENE_START_REST ||
           start->file != NULL; // what is shaken a little may fall into other folds
}

static bool has_starts( const wisp_scene* scene )
{
    bool has = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        has = has || is_elsewhere( &scene->surfaces[i].start );
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        has = has || is_elsewhere( &scene->strands[i].start );
    }
    return has;
}

static void put_to_rest( wisp_scene_start* start )
{
    start->shape = WISP_SCENE_START_REST;
    start->file = NULL;
}

static struct suite_twin* find( const suite_twins* twins, uint64_t key )
{
    for ( int i = 0; i < twins->count; ++i )
    {
        if ( twins->list[i].key == key )
        {
            return &twins->list[i];
        }
    }
    return NULL;
}

static struct suite_twin* keep( suite_twins* twins, uint64_t key, const stability_trace* trace )
{
    if ( twins->count == twins->capacity )
    {
        twins->capacity = twins->capacity > 0 ? 2 * twins->capacity : 16;
        struct suite_twin* list = text_alloc( (size_t)twins->capacity * sizeof *list );
        memcpy( list, twins->list, (size_t)twins->count * sizeof *list * ( twins->list != NULL ) );
        free( twins->list );
        twins->list = list;
    }
    struct suite_twin* twin = &twins->list[twins->count++];
    *twin =
        ( struct suite_twin ){ key, text_alloc( (size_t)trace->body_count * sizeof( double ) ), trace->body_count };
    for ( int body = 0; body < trace->body_count; ++body )
    {
        twin->strains[body] = stability_sample_of( trace, trace->steps, body )->strain;
    }
    return twin;
}

void suite_twins_release( suite_twins* twins )
{
    for ( int i = 0; i < twins->count; ++i )
    {
        free( twins->list[i].strains );
    }
    free( twins->list );
    *twins = ( suite_twins ){ 0 };
}

static wisp_status read_scene( const suite_row* row, wisp_scene* out, wisp_error* error )
{
    const wisp_status status = suite_scene( row, out, error );
    out->steps = status == WISP_OK && row->steps > 0 ? row->steps : out->steps;
    return status;
}

static struct suite_twin* run_twin( const suite_row* row, uint64_t key, suite_twins* twins )
{
    wisp_scene scene;
    stability_trace trace;
    struct suite_twin* twin = NULL;
    if ( read_scene( row, &scene, NULL ) != WISP_OK )
    {
        return NULL;
    }
    for ( int i = 0; i < scene.surface_count; ++i )
    {
        put_to_rest( &scene.surfaces[i].start );
    }
    for ( int i = 0; i < scene.strands_count; ++i )
    {
        put_to_rest( &scene.strands[i].start );
    }
    if ( stability_trace_run( &scene, &trace, NULL ) == WISP_OK )
    {
        twin = keep( twins, key, &trace );
    }
    stability_trace_release( &trace );
    wisp_scene_release( &scene );
    return twin;
}

// What starts elsewhere must reach about the state of the same scene from rest: twice its strain, or 1 %.
static void limit_strain( const suite_row* row, const wisp_scene* scene, suite_twins* twins, stability_trace* trace )
{
    const double FACTOR = 2.0, LEAST = 0.01;
    const uint64_t key = key_of( row );
    const struct suite_twin* twin = find( twins, key );
    if ( !has_starts( scene ) )
    {
        twin = twin ? twin : keep( twins, key, trace );
        return;
    }
    twin = twin ? twin : run_twin( row, key, twins );
    for ( int body = 0; twin && body < trace->body_count; ++body )
    {
        trace->bodies[body].twin = fmax( FACTOR * twin->strains[body], LEAST );
    }
}

// ---- a row ----

static void refuse( const suite_row* row, const char* message, suite_outcome* out )
{
    out->is_refused = true;
    out->verdict.check = row->is_refused ? STABILITY_HOLDS : STABILITY_REFUSED;
    snprintf( out->verdict.message, sizeof out->verdict.message, "%.310s", message );
}

static void judge_trace( const suite_row* row, const wisp_scene* scene, stability_trace* trace, suite_outcome* out )
{
    out->figures = stability_figures_of( trace, &row->limits );
    out->without_limit = stability_without_limit( &out->figures, row->checks );
    out->steps = trace->steps;
    out->hash = trace->hash;
    out->depth = trace->depth;
    out->resets = trace->resets;
    out->not_converged = trace->not_converged;
    out->degenerate = trace->degenerate;
    const bool holds = stability_judge_trace( trace, row->checks | STABILITY_CLOSE, &row->limits, &out->verdict );
    if ( row->is_refused )
    {
        out->verdict =
            ( stability_verdict ){ .check = STABILITY_REFUSED, .severity = 1.0, .message = "it is not refused" };
    }
    else if ( holds && ( row->checks & stability_bit( STABILITY_BITS ) ) )
    {
        stability_judge_bits( scene, scene->steps, &out->verdict );
    }
}

wisp_status suite_judge_row( const suite_row* row, suite_twins* twins, suite_outcome* out, wisp_error* error )
{
    *out = ( suite_outcome ){ .verdict = { .check = STABILITY_HOLDS } };
    if ( row->refusal[0] )
    {
        refuse( row, row->refusal, out );
        return WISP_OK;
    }
    wisp_scene scene;
    wisp_error inner = { 0 };
    wisp_status status = read_scene( row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    stability_trace trace;
    status = stability_trace_run( &scene, &trace, &inner );
    if ( status == WISP_OK )
    {
        limit_strain( row, &scene, twins, &trace );
        judge_trace( row, &scene, &trace, out );
    }
    else if ( status == WISP_BAD_INPUT || status == WISP_CONFLICT )
    {
        refuse( row, inner.message, out );
        status = WISP_OK;
    }
    else
    {
        wisp_fail( error, status, "%s", inner.message );
    }
    stability_trace_release( &trace );
    wisp_scene_release( &scene );
    return status;
}

bool suite_is_as_known( const suite_row* row, const suite_outcome* outcome )
{
    return row->known == (int)outcome->verdict.check;
}
