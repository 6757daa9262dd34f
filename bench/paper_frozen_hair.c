// Table 1 of Kim 2026: frozen hair by number of strands, with the double oracle as the reference.
#include "accuracy/scene_tools.h"
#include "bench_output.h"
#include "bench_world.h"
#include "groom.h"

#include "frozen_hair/frozen_hair.h"
#include "oracle/frozen_hair_oracle.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// A flat wavy groom at a fixed density of strands, and the parameters of the command.
typedef struct paper_scene
{
    wisp_groom groom;
    wisp_frozen_hair_def def;
    double extent; // m, the farthest coordinate: float rounding grows with it
} paper_scene;

// The engine on the scene.
typedef struct paper_world
{
    const paper_scene* scene;
    wisp_world* world;
    wisp_entity hair;
} paper_world;

// Together these give every vertex about a dozen neighbours, at any number of strands: a root every half millimetre
// and a vertex every centimetre along a strand.
#define PAPER_VERTICES 20
#define PAPER_SPACING 0.0005f
#define PAPER_LENGTH 0.2f
#define PAPER_CLUMP_RADIUS 0.0042f

static double farthest_coordinate( const wisp_groom* groom )
{
    double farthest = 0.0;
    for ( int i = 0; i < groom->vertex_count; ++i )
    {
        farthest = fmax( farthest, fabs( (double)groom->points[i].x ) );
        farthest = fmax( farthest, fabs( (double)groom->points[i].y ) );
    }
    return farthest;
}

static wisp_status paper_scene_make( int strand_count, paper_scene* out, wisp_error* error )
{
    *out = ( paper_scene ){ .def = wisp_default_frozen_hair_def() };
    wisp_groom_generator generator = wisp_default_groom_generator( WISP_GROOM_WAVY, 2 );
    generator.strand_count = strand_count;
    generator.vertices_per_strand = PAPER_VERTICES;
    generator.length = PAPER_LENGTH;
    generator.spacing = PAPER_SPACING;
    generator.thickness = 0.0f;
    wisp_status status = wisp_groom_generate( &generator, &out->groom, error );
    if ( status != WISP_OK )
    {
        return status;
    }

    // Far away and below: every strand turns, neighbouring ones by almost the same angle, so the density stays.
    float width = PAPER_SPACING * (float)strand_count;
    out->def.cursor = ( wisp_vec3 ){ 3.0f * width, -10.0f * width, 0.0f };
    out->def.reach = 20.0f * width + 1.0f;
    out->def.clump_radius = PAPER_CLUMP_RADIUS;
    out->extent = farthest_coordinate( &out->groom );
    return WISP_OK;
}

static void paper_scene_free( paper_scene* scene )
{
    wisp_groom_release( &scene->groom );
}

// ---- the engine ----

static void paper_world_destroy( paper_world* implementation )
{
    wisp_world_destroy( implementation->world );
    *implementation = ( paper_world ){ 0 };
}

static wisp_status paper_world_create( const paper_scene* scene, int workers, paper_world* out, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_frozen_hair_module };
    *out = ( paper_world ){ .scene = scene };
    const bench_world_def def = { modules, WISP_COUNT( modules ), .workers = workers };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = scene->groom.points;
    strands.offsets = scene->groom.offsets;
    strands.strand_count = scene->groom.strand_count;
    strands.dimension = 2;
    status = wisp_add_strands( out->world, &strands, &out->hair );
    if ( status == WISP_OK )
    {
        status = wisp_set_frozen_hair( out->world, out->hair, &scene->def );
    }
    if ( status == WISP_OK )
    {
        status = wisp_request( out->world, out->hair, WISP_STRAND_POINTS );
    }
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        paper_world_destroy( out );
    }
    return status;
}

// One command and one step; points are in the user's order because they are requested.
static wisp_status paper_world_step( void* context, wisp_error* error )
{
    paper_world* implementation = context;
    wisp_status status =
        wisp_command_frozen_hair( implementation->world, implementation->hair, implementation->scene->def.cursor );
    if ( status == WISP_OK )
    {
        status = wisp_world_step( implementation->world, 1.0f / 60.0f );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

// Run a given event. @param points receives [vertex_count], owned by the world, valid until its next step
static wisp_status paper_world_replay( paper_world* implementation, uint64_t event, const wisp_vec3** points,
                                       uint64_t* hash, wisp_error* error )
{
    wisp_status status = wisp_replay_frozen_hair( implementation->world, implementation->hair,
                                                  implementation->scene->def.cursor, event );
    if ( status == WISP_OK )
    {
        status = wisp_world_step( implementation->world, 1.0f / 60.0f );
    }
    if ( status != WISP_OK )
    {
        return bench_world_fail( implementation->world, status, error );
    }
    status = bench_world_hash( implementation->world, implementation->hair, WISP_STRAND_POINTS, hash, error );
    return status == WISP_OK ? bench_world_points( implementation->world, implementation->hair, WISP_STRAND_POINTS,
                                                   implementation->scene->groom.vertex_count, points, error )
                             : status;
}

// ---- the oracle ----

static float or_default( float value, float fallback )
{
    return value < 0.0f ? fallback : value;
}

static frozen_oracle_options oracle_options( const wisp_frozen_hair_def* def, uint64_t event )
{
    frozen_oracle_options options = frozen_oracle_default_options();
    options.theta_max = (double)def->max_bend_angle;
    options.cursor = ( double3 ){ (double)def->cursor.x, (double)def->cursor.y, (double)def->cursor.z };
    options.cursor_radius = (double)def->reach;
    options.clump_radius = (double)def->clump_radius;
    options.clump_iterations = def->clump_iterations;
    options.clump_step = (double)or_default( def->clump_step_length, 0.1f * def->clump_radius );
    options.min_distance = (double)or_default( def->min_distance, 0.02f * def->clump_radius );
    options.lambda_min = (double)def->min_lambda;
    options.gap = (frozen_oracle_gap)def->gap; // both list them in the same order
    options.clump = def->clump;
    options.dimension = 2;
    options.seed = def->seed;
    options.event = event;
    return options;
}

// The scene in double precision, by brute force. @param out [vertex_count][3]
static wisp_status paper_oracle_run( const paper_scene* scene, uint64_t event, double* out, wisp_error* error )
{
    const wisp_groom* groom = &scene->groom;
    size_t vertices = (size_t)groom->vertex_count, strands = (size_t)groom->strand_count;
    double3* rest = malloc( 2 * vertices * sizeof( double3 ) );
    double* parameters = malloc( 3 * strands * sizeof( double ) );
    wisp_status status = WISP_NO_MEMORY;
    if ( rest && parameters )
    {
        double3* points = rest + vertices;
        for ( size_t i = 0; i < vertices; ++i )
        {
            wisp_vec3 p = groom->points[i];
            rest[i] = ( double3 ){ (double)p.x, (double)p.y, (double)p.z };
        }
        for ( size_t s = 0; s < strands; ++s )
        {
            parameters[s] = (double)scene->def.stretch_stiffness;
            parameters[strands + s] = (double)scene->def.bend_stiffness;
            parameters[2 * strands + s] = (double)scene->def.intensity;
        }
        const frozen_oracle_hair hair = {
            .strand_count = groom->strand_count,
            .offsets = groom->offsets,
            .rest = rest,
            .stretch_stiffness = parameters,
            .bend_stiffness = parameters + strands,
            .intensity = parameters + 2 * strands,
        };
        const frozen_oracle_options options = oracle_options( &scene->def, event );
        status = frozen_oracle_run( &hair, &options, NULL, points );
        for ( size_t i = 0; i < vertices && status == WISP_OK; ++i )
        {
            out[3 * i + 0] = points[i].x;
            out[3 * i + 1] = points[i].y;
            out[3 * i + 2] = points[i].z;
        }
    }
    else
    {
        wisp_fail( error, status, "no memory for the oracle of %d strands", groom->strand_count );
    }
    free( rest );
    free( parameters );
    return status;
}

// ---- runs ----

enum
{
    COMPARED_EVENT = 7, // all worker counts are compared at it, whatever the events of their timed steps
    // The oracle tests all pairs: 10 000 vertices take it seconds, a million would take it days.
    ORACLE_VERTICES_MAX = 10000,
    STEPS_MIN = 6,
    STEPS_MAX = 200,
};

// Allowed difference of float from double, in roundings of the farthest coordinate. Positions are sums of coordinates, and
// four iterations pass errors on to neighbours; the engine stays below 10.
static const double TOLERATED_ROUNDINGS = 32.0;
static const double LEAST_NEIGHBOURS = 10.0; // a vertex, at every size
static const int strand_counts[] = { 100, 300, 500, 2000, 10000, 50000 };
static const double paper_ms[WISP_COUNT( strand_counts )] = { 6.8, 16.5, 28.7 };

static double largest_distance( const paper_scene* scene, const wisp_vec3* points, const double* reference )
{
    double largest = 0.0;
    for ( int i = 0; i < scene->groom.vertex_count; ++i )
    {
        const double x = (double)points[i].x - reference[3 * i], y = (double)points[i].y - reference[3 * i + 1],
                     z = (double)points[i].z - reference[3 * i + 2], distance = sqrt( x * x + y * y + z * z );
        // Not fmax, which would ignore a NaN.
        largest = distance <= largest ? largest : distance;
    }
    return largest;
}

static wisp_status find_error( const paper_scene* scene, const wisp_vec3* points, accuracy_run* out,
                               wisp_error* error )
{
    const double tolerance = TOLERATED_ROUNDINGS * (double)FLT_EPSILON * scene->extent;
    double* reference = malloc( 3 * (size_t)scene->groom.vertex_count * sizeof( double ) );
    wisp_status status = reference != NULL ? paper_oracle_run( scene, COMPARED_EVENT, reference, error )
                                           : wisp_fail( error, WISP_NO_MEMORY, "no memory for the oracle's points" );
    if ( status == WISP_OK )
    {
        const double distance = largest_distance( scene, points, reference );
        out->error = 1e6 * distance;
        status = distance <= tolerance ? WISP_OK
                                       : wisp_fail( error, WISP_CONFLICT,
                                                    "%d strands: %.3g m from the double oracle, tolerated are %.3g m",
                                                    scene->groom.strand_count, distance, tolerance );
    }
    free( reference );
    return status;
}

static wisp_status judge( paper_world* w, const wisp_vec3* points, accuracy_run* out, wisp_error* error )
{
    const wisp_groom* groom = &w->scene->groom;
    wisp_frozen_hair_stats stats;
    const wisp_status status = wisp_read_frozen_hair_stats( w->world, w->hair, &stats );
    if ( status != WISP_OK )
    {
        return bench_world_fail( w->world, status, error );
    }
    out->measures[0] = (double)stats.neighbours / groom->vertex_count;
    if ( stats.capped > 0 || out->measures[0] < LEAST_NEIGHBOURS )
    {
        return wisp_fail(
            error, WISP_CONFLICT,
            "%d strands have %.1f neighbours per vertex, expected at least %.0f; %llu vertices ran into the limit",
            groom->strand_count, out->measures[0], LEAST_NEIGHBOURS, (unsigned long long)stats.capped );
    }
    return groom->vertex_count <= ORACLE_VERTICES_MAX ? find_error( w->scene, points, out, error ) : WISP_OK;
}

static wisp_status time_commands( paper_world* w, bool is_observed, accuracy_run* out, wisp_error* error )
{
    const int many = 100000 / w->scene->groom.strand_count;
    const int steps = is_observed || many < STEPS_MIN ? STEPS_MIN : many > STEPS_MAX ? STEPS_MAX : many;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        status = accuracy_time_step( paper_world_step, w, out, error );
        status = status == WISP_OK ? profile_samples_add( &out->profile, wisp_world_profile( w->world ) ) : status;
    }
    out->work = ( accuracy_work ){ .strands = w->scene->groom.strand_count,
                                   .vertices = w->scene->groom.vertex_count,
                                   .bytes = (double)wisp_world_memory( w->world ) };
    return status;
}

static wisp_status run_hair( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    (void)context;
    paper_scene scene;
    paper_world w = { .world = NULL };
    const wisp_vec3* points = NULL;
    uint64_t again = 0;
    wisp_status status = paper_scene_make( strand_counts[setting], &scene, error );
    status = status == WISP_OK ? paper_world_create( &scene, workers, &w, error ) : status;
    status = status == WISP_OK ? paper_world_replay( &w, COMPARED_EVENT, &points, &out->hash, error ) : status;
    status = status == WISP_OK && is_observed ? judge( &w, points, out, error ) : status;
    status = status == WISP_OK ? time_commands( &w, is_observed, out, error ) : status;
    // After other commands the same event from rest must still give the same bits.
    status = status == WISP_OK ? paper_world_replay( &w, COMPARED_EVENT, &points, &again, error ) : status;
    if ( status == WISP_OK && again != out->hash )
    {
        status = wisp_fail(
            error, WISP_CONFLICT, "%d strands: event %d gave hash %016llx, and %016llx after other events",
            strand_counts[setting], COMPARED_EVENT, (unsigned long long)out->hash, (unsigned long long)again );
    }
    paper_world_destroy( &w );
    paper_scene_free( &scene );
    return status;
}

// ---- the case ----

static wisp_status make_hair( const void* subject, const bench_options* options, double seconds, accuracy_scene* out,
                              wisp_error* error )
{
    (void)subject;
    (void)seconds;
    *out = ( accuracy_scene ){
        .reference = "the double oracle, which tests all pairs, up to 10 000 vertices",
        .error_name = "distance to the oracle",
        .error_unit = "um",
        .measure_names = { "neighbours per vertex" },
        .measure_count = 1,
        .has_no_rivals = true,
        .paper_ms = paper_ms,
        .note = "20 vertices per strand, all stages, a command in each step, points in the user's order; clump "
                "radius 4.2 mm. At most 32 float roundings of the farthest coordinate are allowed. Kim 2026 has "
                "0.91 ms + 2.74 ms per 1000 vertices, on a machine that is not named: compare slopes. A quick run "
                "leaves 50 000 strands out.",
        .run = run_hair,
    };
    const int count = WISP_COUNT( strand_counts ) - ( options->quick ? 1 : 0 );
    const wisp_status status = accuracy_reserve_settings( out, count, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        accuracy_put_setting( out, "%d strands", strand_counts[i] );
    }
    return status;
}

// That cost is linear is counted in instructions by tests; how times grow depends on what else runs.
static void claim_line( const results* all, int first_row, int workers, results* out )
{
    double thousands[WISP_COUNT( strand_counts )], ms[WISP_COUNT( strand_counts )];
    int count = 0;
    for ( int i = first_row; i < all->row_count && count < WISP_COUNT( strand_counts ); ++i )
    {
        if ( all->rows[i].workers == workers )
        {
            thousands[count] = 1e-3 * rows_vertices( &all->rows[i] );
            ms[count++] = all->rows[i].ms_median;
        }
    }
    const stats_line line = stats_fit_line( thousands, ms, count );
    char claim[200];
    snprintf(
        claim, sizeof claim,
        "Kim 2026, eq. 20: time against vertices with %d %s is a line, R^2 above 0.98; %.3f ms + %.4f ms per 1000",
        workers, bench_workers_word( workers ), line.intercept, line.slope );
    results_add_claim( out, line.r_squared > 0.98, claim, line.r_squared, "" );
}

wisp_status paper_frozen_hair( const bench_options* options, results* out, wisp_error* error )
{
    const accuracy_entry entry = { "frozen_hair", "frozen hair, Table 1 of Kim 2026", make_hair, NULL, NULL };
    const int first_row = out->row_count;
    const wisp_status status = accuracy_bench_run( &entry, 1, bench_seconds( options ), options, out, error );
    for ( int workers = 1; workers <= options->workers && status == WISP_OK;
          workers += options->workers > 1 ? options->workers - 1 : 1 )
    {
        claim_line( out, first_row, workers, out );
    }
    return status;
}
