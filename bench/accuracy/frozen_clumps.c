// Clumping of frozen hair: the errors of a limited number of neighbours, of fewer and longer clumping steps, and the
// effect of the printed choices.
#include "frozen_clumps.h"
#include "scene_tools.h"

#include <math.h>
#include <stdlib.h>

#define RUN_COMMANDS 12
#define LIMIT_RADIUS 0.008f // m: about fifty neighbours per vertex
#define FLOW_RADIUS 0.008f  // m
#define FLOW_REACH 0.04f    // of the radius: the sum of all steps; with much more, vertices collide
#define MAX_FLOW_STEPS 16
#define STRANDS 80

typedef struct clump_way
{
    wisp_frozen_hair_def def;
    bool is_flow; // compared with many short steps; otherwise with the default shape
} clump_way;

#define WAYS_MAX 48

typedef struct clumps
{
    paper_scene scene;
    accuracy_reference reference;
    double* own; // [vertex_count][3] of the setting that runs, in double
    clump_way ways[WAYS_MAX];
} clumps;

// ---- measures ----

/// Root mean square and largest distance to a reference, m.
typedef struct clump_distance
{
    double rms, most;
} clump_distance;

static clump_distance distance_to( const double* reference, const wisp_vec3* points, int count )
{
    clump_distance d = { 0.0, 0.0 };
    for ( int i = 0; i < count; ++i )
    {
        const double x = (double)points[i].x - reference[3 * i], y = (double)points[i].y - reference[3 * i + 1],
                     z = (double)points[i].z - reference[3 * i + 2], squared = x * x + y * y + z * z;
        d.rms += squared / count;
        d.most = fmax( d.most, squared );
    }
    return ( clump_distance ){ sqrt( d.rms ), sqrt( d.most ) };
}

// ---- a run ----

enum
{
    FARTHEST,
    OWN_ORACLE,
    NEIGHBOURS,
    CAPPED,
    MEASURES,
};

static wisp_status measure_clumps( clumps* all, const clump_way* way, paper_world* world, const wisp_vec3* points,
                                   accuracy_run* out, wisp_error* error )
{
    const int count = all->scene.groom.vertex_count;
    wisp_frozen_hair_stats report = { 0 };
    wisp_status status = wisp_read_frozen_hair_stats( world->world, world->hair, &report );
    if ( status != WISP_OK )
    {
        return bench_world_fail( world->world, status, error );
    }
    const clump_distance d =
        distance_to( all->reference.numbers + ( way->is_flow ? 3 * (size_t)count : 0 ), points, count );
    out->error = 1e6 * d.rms;
    out->measures[FARTHEST] = 1e6 * d.most;
    out->measures[NEIGHBOURS] = (double)report.neighbours / count;
    out->measures[CAPPED] = 100.0 * (double)report.capped / ( (double)count * fmax( report.searches, 1.0 ) );
    status = paper_oracle_run( world->scene, 0, all->own, error );
    out->measures[OWN_ORACLE] = 1e6 * distance_to( all->own, points, count ).rms;
    return status;
}

// The same command repeatedly: between the first and the last nothing changes except the time.
static wisp_status run_clumps( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    clumps* all = context;
    const clump_way* way = &all->ways[setting];
    const paper_scene scene = { all->scene.groom, way->def, all->scene.extent };
    paper_world world = { 0 };
    const wisp_vec3* points = NULL;
    wisp_status status = paper_world_create( &scene, workers, &world, error );
    for ( int i = 0; i < RUN_COMMANDS && status == WISP_OK; ++i )
    {
        status = accuracy_time_step( paper_world_step, &world, out, error );
    }
    status = status == WISP_OK ? paper_world_replay( &world, 0, &points, &out->hash, error ) : status;
    status = status == WISP_OK && is_observed ? measure_clumps( all, way, &world, points, out, error ) : status;
    out->halted_at = 0; // it has no time, so nothing accumulates
    paper_world_destroy( &world );
    return status;
}

// ---- reference ----

wisp_status frozen_clumps_make( paper_scene* out, wisp_error* error )
{
    return paper_scene_make( STRANDS, out, error );
}

wisp_frozen_hair_def frozen_clumps_flow( const paper_scene* scene, int steps )
{
    wisp_frozen_hair_def def = scene->def;
    def.clump_radius = FLOW_RADIUS;
    def.gap = WISP_GAP_NONE; // the brake is random, and more steps would draw other numbers
    def.clump_iterations = steps;
    def.clump_step_length = FLOW_REACH * FLOW_RADIUS / (float)steps;
    def.max_neighbours = 4096;
    return def;
}

wisp_frozen_hair_def frozen_clumps_default( const paper_scene* scene )
{
    wisp_frozen_hair_def def = scene->def;
    def.clump_radius = LIMIT_RADIUS;
    return def;
}

accuracy_reference frozen_clumps_reference( const paper_scene* scene )
{
    const wisp_frozen_hair_def by_default = frozen_clumps_default( scene ), flow = frozen_clumps_flow( scene, 1 );
    accuracy_reference reference = { .scene = "frozen_clumps", .number_count = 2 * 3 * scene->groom.vertex_count };
    accuracy_reference_put( &reference, "vertices", scene->groom.vertex_count );
    accuracy_reference_put( &reference, "cursor x, m", (double)by_default.cursor.x );
    accuracy_reference_put( &reference, "cursor y, m", (double)by_default.cursor.y );
    accuracy_reference_put( &reference, "reach, m", (double)by_default.reach );
    accuracy_reference_put( &reference, "radius of the default, m", (double)by_default.clump_radius );
    accuracy_reference_put( &reference, "step of the default", (double)by_default.clump_step_length );
    accuracy_reference_put( &reference, "steps of the default", by_default.clump_iterations );
    accuracy_reference_put( &reference, "radius of the flow, m", (double)flow.clump_radius );
    accuracy_reference_put( &reference, "all steps of the flow, m", (double)flow.clump_step_length );
    accuracy_reference_put_start( &reference, scene->groom.points, scene->groom.vertex_count );
    return reference;
}

static wisp_status read_reference( clumps* all, wisp_error* error )
{
    const accuracy_reference requested = frozen_clumps_reference( &all->scene );
    all->own = malloc( 3 * (size_t)all->scene.groom.vertex_count * sizeof( double ) );
    return all->own ? accuracy_reference_read( accuracy_reference_folder(), &requested, &all->reference, error )
                    : wisp_fail( error, WISP_NO_MEMORY, "no memory for the reference of frozen hair" );
}

// ---- settings ----

static accuracy_setting* put_way( accuracy_scene* scene, const char* name, wisp_frozen_hair_def def, bool is_flow )
{
    clumps* all = scene->context;
    all->ways[scene->setting_count] = ( clump_way ){ def, is_flow };
    return accuracy_put_setting( scene, "%s", name );
}

static void put_limits( accuracy_scene* scene )
{
    const paper_scene* hair = &( (const clumps*)scene->context )->scene;
    char name[64];
    for ( int limit = 1; limit <= 64; limit *= 2 )
    {
        wisp_frozen_hair_def def = frozen_clumps_default( hair );
        def.max_neighbours = limit;
        snprintf( name, sizeof( name ), "at most %d neighbours", limit );
        accuracy_join_series( put_way( scene, name, def, false ), "neighbours", "1 / neighbours", 1.0 / limit, NAN );
    }
    put_way( scene, "all neighbours", frozen_clumps_default( hair ), false );
}

static void put_flow( accuracy_scene* scene )
{
    const paper_scene* hair = &( (const clumps*)scene->context )->scene;
    char name[64];
    for ( int steps = 1; steps <= MAX_FLOW_STEPS; steps *= 2 )
    {
        snprintf( name, sizeof( name ), "flow in %d steps", steps );
        accuracy_join_series( put_way( scene, name, frozen_clumps_flow( hair, steps ), true ), "flow", "1 / steps",
                              1.0 / steps, 1.0 );
    }
}

static void put_choices( accuracy_scene* scene )
{
    const paper_scene* hair = &( (const clumps*)scene->context )->scene;
    wisp_frozen_hair_def def = frozen_clumps_default( hair );
    def.clump_radius = 0.5f * LIMIT_RADIUS;
    put_way( scene, "half the radius", def, false );
    def.clump_radius = 1.5f * LIMIT_RADIUS;
    put_way( scene, "1.5 times the radius", def, false );
    def = frozen_clumps_default( hair );
    def.clump_iterations = 2;
    put_way( scene, "half the iterations", def, false );
    def = frozen_clumps_default( hair );
    def.clump_iterations = 8;
    put_way( scene, "twice the iterations", def, false );
    def = frozen_clumps_default( hair );
    def.clump = false;
    put_way( scene, "no clumps", def, false );
}

static void destroy_clumps( void* context )
{
    clumps* all = context;
    paper_scene_free( &all->scene );
    accuracy_reference_free( &all->reference );
    free( all->own );
    free( all );
}

wisp_status accuracy_frozen_clumps( const bench_options* options, double seconds, accuracy_scene* out,
                                    wisp_error* error )
{
    (void)options;
    (void)seconds; // its reference has this many strands
    clumps* all = calloc( 1, sizeof( clumps ) );
    *out = ( accuracy_scene ){
        .note = "the uncertainty is that of the flow, where vertices gain and lose neighbours; the reference of the "
                "appearance is exact up to rounding.",
        .error_name = "distance to the reference",
        .error_unit = "um",
        .ms_name = "command",
        .measure_names = { "farthest um", "to its own oracle um", "neighbours per vertex", "capped %" },
        .measure_count = MEASURES,
        .context = all,
        .run = run_clumps,
        .destroy = destroy_clumps,
    };
    if ( !all )
    {
        return accuracy_abandon( out, wisp_fail( error, WISP_NO_MEMORY, "no memory for frozen hair" ) );
    }
    wisp_status status = frozen_clumps_make( &all->scene, error );
    status = status == WISP_OK ? read_reference( all, error ) : status;
    status = status == WISP_OK ? accuracy_reserve_settings( out, WAYS_MAX, error ) : status;
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    accuracy_describe_reference( &all->reference, 1e6, out );
    put_limits( out );
    put_flow( out );
    put_choices( out );
    return WISP_OK;
}
