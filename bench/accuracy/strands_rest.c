// Hair that starts at rest should stay there without jitter. The error of a setting is the change of its shape, and
// its motion at the end.
#include "scene_tools.h"
#include "strands_head.h"

#include <math.h>
#include <stdlib.h>

#define REST_STEPS 120
#define JITTER_STEPS 30   // the last ones
#define REST_DAMPING 1.0f // 1/s
#define WAVE_VERTICES 24
#define CURL_HEIGHT 0.16  // m
#define CURL_RADIUS 0.005 // m
#define CURL_PITCH 0.02   // m per turn
#define FEWEST_STRANDS_SIDE 4
#define FEW_STRANDS_SIDE 8
#define MANY_STRANDS_SIDE 16
#define FEW_SECONDS 4.0
#define FULL_SECONDS 15.0

typedef enum rest_hair
{
    REST_WAVES,
    REST_CURLS_32, // vertices
    REST_CURLS_48,
    REST_CURLS_96,
    REST_HAIRS,
} rest_hair;

typedef struct rest_way
{
    rest_hair hair;
    wisp_strand_rest rest;
    int substeps;
} rest_way;

#define WAYS_MAX 64

typedef struct rests
{
    strands_shape hair[REST_HAIRS];
    rest_way ways[WAYS_MAX];
} rests;

// ---- hair ----

// Hanging helices, each turned by a different angle. Hanging hair is in stable balance if it is stiff enough for its
// curls.
static wisp_status make_curls( int strand_count, int vertices, strands_shape* out, wisp_error* error )
{
    const wisp_status status = strands_shape_create( strand_count, vertices, out, error );
    for ( int i = 0; i < strand_count * vertices && status == WISP_OK; ++i )
    {
        const int strand = i / vertices;
        const double down = CURL_HEIGHT * ( i % vertices ) / ( vertices - 1 );
        const double angle = 6.283185307179586 * down / CURL_PITCH + 2.399963229728653 * strand;
        out->points[i] = ( wisp_vec3 ){ (float)( CURL_RADIUS * cos( angle ) ), (float)-down,
                                        (float)( CURL_RADIUS * sin( angle ) ) };
    }
    return status;
}

static strands_generator make_generator( const rests* all, const rest_way* way, int workers, bool is_observed )
{
    strands_generator generator = strands_default_generator( &all->hair[way->hair] );
    generator.dynamics.rest = way->rest;
    generator.dynamics.damping = REST_DAMPING;
    generator.substeps = way->substeps;
    generator.workers = workers;
    generator.has_motion_stats = is_observed;
    return generator;
}

// ---- a run ----

enum
{
    FARTHEST,
    JITTER,
    STRETCH_MAX,
    LAID_OUT,
    MEASURES,
};

static wisp_status keep_jitter( strands_implementation* implementation, accuracy_run* out, wisp_error* error )
{
    wisp_motion_stats motion_stats = { 0 };
    const wisp_status status = wisp_read_motion_stats( implementation->world, implementation->entity, &motion_stats );
    out->measures[JITTER] = fmax( out->measures[JITTER], 1e3 * motion_stats.speed_max );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

static wisp_status judge( strands_implementation* implementation, accuracy_run* out, wisp_error* error )
{
    const strands_shape* shape = implementation->generator.shape;
    const int count = strands_shape_size( shape );
    const wisp_vec3* points = NULL;
    const wisp_status status = strands_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    out->error = 1e3 * strands_rms_distance( points, shape->points, count );
    out->measures[FARTHEST] = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        const double distance = 1e3 * strands_rms_distance( points + i, shape->points + i, 1 );
        out->measures[FARTHEST] = fmax( out->measures[FARTHEST], distance );
    }
    out->measures[STRETCH_MAX] = 100.0 * strands_measure_stretch( shape, points ).max;
    out->measures[LAID_OUT] =
        (double)wisp_world_counter( implementation->world, WISP_COUNT_STRAND_RESET ) / shape->strand_count;
    return WISP_OK;
}

static wisp_status run_rest( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const rests* all = context;
    const strands_generator generator = make_generator( all, &all->ways[setting], workers, is_observed );
    strands_implementation implementation = { 0 };
    wisp_status status = strands_implementation_create( &generator, &implementation, error );
    out->measures[JITTER] = is_observed ? 0.0 : NAN;
    for ( int s = 1; s <= REST_STEPS && status == WISP_OK; ++s )
    {
        const bool is_due = is_observed && s > REST_STEPS - JITTER_STEPS;
        status = accuracy_time_step( strands_implementation_step, &implementation, out, error );
        status = status == WISP_OK && is_due ? keep_jitter( &implementation, out, error ) : status;
    }
    status = status == WISP_OK && is_observed ? judge( &implementation, out, error ) : status;
    status = status == WISP_OK ? strands_implementation_hash( &implementation, &out->hash, error ) : status;
    out->halted_at = implementation.halted_at;
    strands_implementation_destroy( &implementation );
    return status;
}

// ---- settings ----

static accuracy_setting* put_way( accuracy_scene* scene, const char* name, rest_way way )
{
    rests* all = scene->context;
    all->ways[scene->setting_count] = way;
    return accuracy_put_setting( scene, "%s, %d substeps", name, way.substeps );
}

// Nothing should move, so no order is expected.
static void put_substeps( accuracy_scene* scene, const char* name, rest_hair hair )
{
    static const int tried[] = { 1, 2, 4, 8, 16, 32 };
    for ( int i = 0; i < WISP_COUNT( tried ); ++i )
    {
        const rest_way way = { hair, WISP_STRAND_REST_SAG_FREE, tried[i] };
        accuracy_join_series( put_way( scene, name, way ), name, "substep, s", (double)STRANDS_STEP / tried[i], NAN );
    }
    const rest_way sagging = { hair, WISP_STRAND_REST_SHAPE, 16 };
    char sags[48];
    snprintf( sags, sizeof( sags ), "%s, not balanced", name );
    put_way( scene, sags, sagging );
}

static void destroy_rests( void* context )
{
    rests* all = context;
    for ( int i = 0; i < REST_HAIRS; ++i )
    {
        strands_shape_free( &all->hair[i] );
    }
    free( all );
}

// A scene without settings and without hair.
static wisp_status begin( accuracy_scene* out, wisp_error* error )
{
    rests* all = calloc( 1, sizeof( rests ) );
    *out = ( accuracy_scene ){
        .reference = "the given shape, about 20 cm long; root mean square over all vertices after 2 s",
        .error_name = "drift from the start",
        .error_unit = "mm",
        .measure_names = { "farthest mm", "jitter mm/s", "stretch max %", "resets per strand" },
        .measure_count = MEASURES,
        .context = all,
        .run = run_rest,
        .destroy = destroy_rests,
    };
    return all ? accuracy_reserve_settings( out, WAYS_MAX, error )
               : wisp_fail( error, WISP_NO_MEMORY, "no memory for hair at rest" );
}

static int side_for( double seconds )
{
    return seconds < FEW_SECONDS    ? FEWEST_STRANDS_SIDE
           : seconds < FULL_SECONDS ? FEW_STRANDS_SIDE
                                    : MANY_STRANDS_SIDE;
}

wisp_status accuracy_strands_rest( const bench_options* options, double seconds, accuracy_scene* out,
                                   wisp_error* error )
{
    (void)options;
    wisp_status status = begin( out, error );
    rests* all = out->context;
    status = status == WISP_OK
                 ? hair_head_make_hair( side_for( seconds ), WAVE_VERTICES, &all->hair[REST_WAVES], error )
                 : status;
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    put_substeps( out, "waves", REST_WAVES );
    return WISP_OK;
}

wisp_status accuracy_strands_curls( const bench_options* options, double seconds, accuracy_scene* out,
                                    wisp_error* error )
{
    (void)options;
    static const int vertices[] = { 32, 48, 96 };
    wisp_status status = begin( out, error );
    rests* all = out->context;
    for ( int i = 0; i < WISP_COUNT( vertices ) && status == WISP_OK; ++i )
    {
        const int strands = side_for( seconds ) * side_for( seconds );
        status = make_curls( strands, vertices[i], &all->hair[REST_CURLS_32 + i], error );
    }
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    put_substeps( out, "32 vertices", REST_CURLS_32 );
    put_substeps( out, "48 vertices", REST_CURLS_48 );
    put_substeps( out, "96 vertices", REST_CURLS_96 );
    return WISP_OK;
}
