// A scene run again in another way: with other workers, after a snapshot, at another size, elsewhere.
#include "torture_judges.h"

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

// ---- bits ----

// Run steps and keep the hash after each. @return steps that were made
static int hash_steps( const wisp_scene* scene, const scene_world_options* options, int steps, uint64_t* hashes )
{
    scene_world world;
    int made = 0;
    if ( scene_world_create( scene, options, &world, NULL ) != WISP_OK )
    {
        return 0;
    }
    while ( made < steps && scene_world_step( &world, NULL ) == WISP_OK )
    {
        hashes[made++] = wisp_world_hash( world.world );
    }
    scene_world_destroy( &world );
    return made;
}

static bool judge_bits( const wisp_scene* scene, torture_verdict* out )
{
    static const struct
    {
        int workers;
        const char* isa;
    } places[] = { { 2, "baseline" }, { 5, "avx2" }, { 1, "avx512" } };
    const int steps = twin_steps( scene );
    uint64_t *expected = torture_alloc( (size_t)steps * sizeof *expected ), *found = torture_alloc( (size_t)steps * sizeof *found );
    const scene_world_options plain = { 1, "baseline", true };
    const int made = hash_steps( scene, &plain, steps, expected );
    bool holds = true;
    for ( int i = 0; i < WISP_COUNT( places ) && holds; ++i )
    {
        const scene_world_options options = { places[i].workers, places[i].isa, true };
        const int count = hash_steps( scene, &options, steps, found );
        int same = 0;
        while ( same < made && same < count && expected[same] == found[same] )
        {
            ++same;
        }
        holds = same == made && count == made;
        if ( !holds )
        {
            *out = ( torture_verdict ){ .judge = TORTURE_BITS, .step = same + 1, .severity = 1.0 };
            snprintf( out->message, sizeof out->message, "step %d has other bits with %d workers and %s than with one and baseline", same + 1, places[i].workers, places[i].isa );
        }
    }
    free( expected );
    free( found );
    return holds;
}

// ---- snapshots ----

// What a host keeps besides the world: where the scene's script is.
static void copy_place( const scene_world* from, scene_world* to )
{
    to->next_step = from->next_step;
    to->next_command = from->next_command;
    to->next_event = from->next_event;
    for ( int i = 0; i < from->scene->surface_count; ++i )
    {
        to->surfaces[i].is_released = from->surfaces[i].is_released;
    }
}

static uint64_t run_on( scene_world* world, int steps )
{
    for ( int i = 0; i < steps && scene_world_step( world, NULL ) == WISP_OK; ++i )
    {
    }
    return wisp_world_hash( world->world );
}

// Into the world that it came from, and into a new one, whose plan is compiled by a step.
static bool judge_snapshot( const wisp_scene* scene, torture_verdict* out )
{
    const scene_world_options options = { 1, NULL, true };
    const int steps = twin_steps( scene );
    torture_random random = torture_random_start( (uint64_t)scene->steps, (uint64_t)scene->substeps );
    const int half = steps > 1 ? torture_random_whole( &random, 1, steps - 1 ) : 0;
    scene_world worlds[2], before = { .scene = scene };
    if ( steps < 2 || scene_world_create( scene, &options, &worlds[0], NULL ) != WISP_OK )
    {
        return true;
    }
    bool holds = scene_world_create( scene, &options, &worlds[1], NULL ) == WISP_OK;
    before.surfaces = torture_alloc( (size_t)scene->surface_count * sizeof *before.surfaces );
    (void)run_on( &worlds[0], half );
    (void)run_on( &worlds[1], 1 );
    copy_place( &worlds[0], &before );
    const size_t size = wisp_world_snapshot_size( worlds[0].world );
    void* bytes = torture_alloc( size );
    holds = wisp_world_snapshot( worlds[0].world, bytes, size ) == WISP_OK;
    const uint64_t expected = run_on( &worlds[0], steps - half );
    for ( int i = 0; i < 2 && holds; ++i )
    {
        copy_place( &before, &worlds[i] );
        const wisp_status status = wisp_world_restore( worlds[i].world, bytes, size );
        const char* where = i == 0 ? "the same world" : "a new world";
        holds = status == WISP_OK && run_on( &worlds[i], steps - half ) == expected;
        if ( !holds )
        {
            *out = ( torture_verdict ){ .judge = TORTURE_SNAPSHOT, .step = half, .severity = 1.0 };
            snprintf( out->message, sizeof out->message, "a snapshot after step %d %s %s%s", half,
                      status == WISP_OK ? "goes on to other bits in" : "is refused by", where, status == WISP_OK ? "" : wisp_world_message( worlds[i].world ) );
        }
    }
    free( bytes );
    free( before.surfaces );
    scene_world_destroy( &worlds[0] );
    scene_world_destroy( &worlds[1] );
    return holds;
}

// ---- another size, another place ----

bool torture_compare_traces( const torture_trace* trace, const torture_trace* twin, torture_judge judge, torture_verdict* out )
{
    // Crumpled cloth falls into other folds after any rounding: only a stretch that is of another order is another motion.
    const double APART = 0.5, FACTOR = 3.0;
    const char* where = judge == TORTURE_SCALE ? "at another size" : "100 m away";
    torture_verdict other;
    if ( !torture_judge_trace( twin, &other ) )
    {
        *out = ( torture_verdict ){ .judge = judge, .step = other.step, .severity = other.severity };
        snprintf( out->message, sizeof out->message, "%s: %.250s", where, other.message );
        return false;
    }
    for ( int body = 0; body < trace->body_count && torture_is_at_rest( trace ); ++body )
    {
        const torture_body *a = &trace->bodies[body], *b = &twin->bodies[body];
        const double larger = fmax( a->stretch, b->stretch ), smaller = fmin( a->stretch, b->stretch );
        if ( a->moves && a->softness < 1.0 && !torture_is_held( trace, body ) && larger > APART + FACTOR * smaller )
        {
            *out = ( torture_verdict ){ .judge = judge, .step = trace->steps, .severity = larger / ( APART + FACTOR * smaller ) };
            snprintf( out->message, sizeof out->message, "%s has an edge stretched by %.3g %% at the end, and by %.3g %% %s", a->name, 100.0 * a->stretch,
                      100.0 * b->stretch, where );
            return false;
        }
    }
    return true;
}

// Takes the tree, which is released.
static bool judge_alike( const torture_subject* subject, torture_node* tree, const torture_trace* trace, torture_judge judge, torture_verdict* out )
{
    const torture_subject moved = { tree, subject->name };
    wisp_scene scene;
    wisp_error error = { 0 };
    torture_trace twin = { 0 };
    bool holds = true;
    // What is beyond a range at another size says nothing.
    if ( torture_read( &moved, &scene, &error ) == WISP_OK )
    {
        holds = torture_trace_run( &scene, &twin, &error ) != WISP_OK || torture_compare_traces( trace, &twin, judge, out );
        torture_trace_release( &twin );
    }
    wisp_scene_release( &scene );
    torture_release( tree );
    return holds;
}

bool torture_judge_twins( const torture_subject* subject, const torture_trace* trace, int twins, torture_verdict* out )
{
    wisp_scene scene;
    wisp_error error = { 0 };
    if ( torture_read( subject, &scene, &error ) != WISP_OK )
    {
        return true;
    }
    bool holds = ( twins & TORTURE_TWIN_BITS ) == 0 || judge_bits( &scene, out );
    holds = holds && ( ( twins & TORTURE_TWIN_SNAPSHOT ) == 0 || judge_snapshot( &scene, out ) );
    wisp_scene_release( &scene );
    if ( holds && ( twins & TORTURE_TWIN_SCALE ) )
    {
        torture_node* tree = torture_copy( subject->tree );
        torture_scale( tree, trace->steps % 2 == 0 ? 10.0 : 0.1 );
        holds = judge_alike( subject, tree, trace, TORTURE_SCALE, out );
    }
    if ( holds && ( twins & TORTURE_TWIN_SHIFT ) )
    {
        torture_node* tree = torture_copy( subject->tree );
        torture_shift( tree, ( const double[] ){ 60.0, 0.0, 80.0 } );
        holds = judge_alike( subject, tree, trace, TORTURE_SHIFT, out );
    }
    return holds;
}
