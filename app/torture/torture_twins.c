// A scene run again in another way: with other workers, after a snapshot, at another size, elsewhere.
#include "torture_twins.h"

#include "torture_random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Longer runs find little more, and each twin costs as much as the run itself.
static const int TWIN_STEPS = 60;

static int twin_steps( const wisp_scene* scene )
{
    return scene->steps < TWIN_STEPS ? scene->steps : TWIN_STEPS;
}

wisp_status torture_read( const torture_subject* subject, wisp_scene* out, wisp_error* error )
{
    char* text = text_write( subject->tree, NULL );
    const wisp_status status = wisp_scene_parse( text, strlen( text ), subject->name, out, error );
    free( text );
    return status;
}

// ---- snapshots ----

// Make steps and keep the hash after each. @return steps that were made
static int hash_steps( scene_world* world, int steps, uint64_t* hashes )
{
    int made = 0;
    while ( made < steps && scene_world_step( world, NULL ) == WISP_OK )
    {
        hashes[made++] = wisp_world_hash( world->world );
    }
    return made;
}

// What a host keeps besides the world: where the scene's script is.
typedef struct script_place
{
    int next_step, next_command, next_event;
    void* pins;
} script_place;

static script_place save_place( const scene_world* world )
{
    const script_place out = { world->next_step, world->next_command, world->next_event,
                               text_alloc( scene_pins_state_size( world ) + 1 ) };
    scene_pins_save( world, out.pins );
    return out;
}

static void load_place( const script_place* place, scene_world* out )
{
    out->next_step = place->next_step;
    out->next_command = place->next_command;
    out->next_event = place->next_event;
    scene_pins_load( out, place->pins );
}

typedef struct snapshot_run
{
    scene_world worlds[2]; // the one that the snapshot comes from, and a new one
    script_place place;    // where the script was
    void* bytes;
    size_t size;
    uint64_t *expected, *found; // hashes of the steps that follow
    int half, left;
} snapshot_run;

static bool judge_restored( snapshot_run* run, int world, int expected, stability_verdict* out )
{
    scene_world* restored = &run->worlds[world];
    load_place( &run->place, restored );
    if ( wisp_world_restore( restored->world, run->bytes, run->size ) != WISP_OK )
    {
        *out = ( stability_verdict ){ .check = STABILITY_SNAPSHOT, .step = run->half, .severity = 1.0 };
        snprintf( out->message, sizeof out->message, "a snapshot after step %d is refused: %.200s", run->half,
                  wisp_world_message( restored->world ) );
        return false;
    }
    char how[80];
    snprintf( how, sizeof how, "in %s world that a snapshot after step %d was restored into",
              world == 0 ? "the same" : "a new", run->half );
    const int count = hash_steps( restored, run->left, run->found );
    return stability_compare_bits( run->expected, expected, run->found, count, STABILITY_SNAPSHOT, run->half, how,
                                   out );
}

// Both worlds have made a step, which compiles the plan.
static bool judge_snapshot_of( snapshot_run* run, stability_verdict* out )
{
    run->expected = text_alloc( (size_t)run->left * sizeof *run->expected );
    run->found = text_alloc( (size_t)run->left * sizeof *run->found );
    run->place = save_place( &run->worlds[0] );
    run->size = wisp_world_snapshot_size( run->worlds[0].world );
    run->bytes = text_alloc( run->size );
    bool holds = wisp_world_snapshot( run->worlds[0].world, run->bytes, run->size ) == WISP_OK;
    const int expected = hash_steps( &run->worlds[0], run->left, run->expected );
    for ( int world = 0; world < 2 && holds; ++world )
    {
        holds = judge_restored( run, world, expected, out );
    }
    free( run->bytes );
    free( run->place.pins );
    free( run->expected );
    free( run->found );
    return holds;
}

static bool judge_snapshot( const wisp_scene* scene, stability_verdict* out )
{
    const scene_world_options options = { .workers = 1, .isa = NULL, .is_quiet = true };
    const int steps = twin_steps( scene );
    torture_random random = torture_random_start( (uint64_t)scene->steps, (uint64_t)scene->substeps );
    snapshot_run run = { .half = steps > 1 ? torture_random_whole( &random, 1, steps - 1 ) : 0 };
    run.left = steps - run.half;
    if ( steps < 2 || scene_world_create( scene, &options, &run.worlds[0], NULL ) != WISP_OK )
    {
        return true;
    }
    bool holds = true;
    if ( scene_world_create( scene, &options, &run.worlds[1], NULL ) == WISP_OK )
    {
        bool has_stepped = scene_world_step( &run.worlds[1], NULL ) == WISP_OK;
        for ( int i = 0; i < run.half; ++i )
        {
            has_stepped = has_stepped && scene_world_step( &run.worlds[0], NULL ) == WISP_OK;
        }
        holds = !has_stepped || judge_snapshot_of( &run, out );
        scene_world_destroy( &run.worlds[1] );
    }
    scene_world_destroy( &run.worlds[0] );
    return holds;
}

// ---- another size, another place ----

bool torture_compare_traces( const stability_trace* trace, const stability_trace* twin, stability_check judge,
                             stability_verdict* out )
{
    // Crumpled cloth falls into other folds after any rounding: only a stretch that is of another order is another
    // motion.
    const double APART = 0.5, FACTOR = 3.0;
    const char* where = judge == STABILITY_SCALE ? "at another size" : "100 m away";
    stability_verdict other;
    if ( !stability_judge_trace( twin, STABILITY_ALL, NULL, &other ) )
    {
        *out = ( stability_verdict ){ .check = judge, .step = other.step, .severity = other.severity };
        snprintf( out->message, sizeof out->message, "%s: %.250s", where, other.message );
        return false;
    }
    for ( int body = 0; body < trace->body_count && stability_is_at_rest( trace ); ++body )
    {
        const stability_body *a = &trace->bodies[body], *b = &twin->bodies[body];
        const double larger = fmax( a->stretch, b->stretch ), smaller = fmin( a->stretch, b->stretch );
        if ( a->moves && a->softness < 1.0 && !stability_is_held( trace, body ) && larger > APART + FACTOR * smaller )
        {
            *out = ( stability_verdict ){ .check = judge,
                                          .step = trace->steps,
                                          .severity = larger / ( APART + FACTOR * smaller ) };
            snprintf( out->message, sizeof out->message,
                      "%s has an edge stretched by %.3g %% at the end, and by %.3g %% %s", a->name,
                      100.0 * a->stretch, 100.0 * b->stretch, where );
            return false;
        }
    }
    return true;
}

// Takes the tree, which is released.
static bool judge_alike( const torture_subject* subject, text_node* tree, const stability_trace* trace,
                         stability_check judge, stability_verdict* out )
{
    const torture_subject moved = { tree, subject->name };
    wisp_scene scene;
    wisp_error error = { 0 };
    stability_trace twin = { 0 };
    bool holds = true;
    // What is beyond a range at another size says nothing.
    if ( torture_read( &moved, &scene, &error ) == WISP_OK )
    {
        holds = stability_trace_run( &scene, &twin, &error ) != WISP_OK ||
                torture_compare_traces( trace, &twin, judge, out );
        stability_trace_release( &twin );
    }
    wisp_scene_release( &scene );
    text_release( tree );
    return holds;
}

bool torture_judge_twins( const torture_subject* subject, const stability_trace* trace, int twins,
                          stability_verdict* out )
{
    wisp_scene scene;
    wisp_error error = { 0 };
    if ( torture_read( subject, &scene, &error ) != WISP_OK )
    {
        return true;
    }
    bool holds = ( twins & TORTURE_TWIN_BITS ) == 0 || stability_judge_bits( &scene, twin_steps( &scene ), out );
    holds = holds && ( ( twins & TORTURE_TWIN_SNAPSHOT ) == 0 || judge_snapshot( &scene, out ) );
    wisp_scene_release( &scene );
    if ( holds && ( twins & TORTURE_TWIN_SCALE ) )
    {
        text_node* tree = text_copy( subject->tree );
        torture_scale( tree, trace->steps % 2 == 0 ? 10.0 : 0.1 );
        holds = judge_alike( subject, tree, trace, STABILITY_SCALE, out );
    }
    if ( holds && ( twins & TORTURE_TWIN_SHIFT ) )
    {
        text_node* tree = text_copy( subject->tree );
        torture_shift( tree, ( const double[] ){ 60.0, 0.0, 80.0 } );
        holds = judge_alike( subject, tree, trace, STABILITY_SHIFT, out );
    }
    return holds;
}
