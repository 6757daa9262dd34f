// Guides and ghosts against simulating all: what fewer guides miss on a head that is shaken, beside what fewer substeps of all
// strands miss for the same time.
#include "scene_tools.h"
#include "strands_head.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHAKE_STEPS 45
#define SHAKE_LOOK 5
#define SHAKE_LOOKS ( SHAKE_STEPS / SHAKE_LOOK )
#define SHAKE_VERTICES 20
#define TRUTH_SUBSTEPS 80
#define FEW_SIDE 12 // strands along an edge, multiples of 4
#define MANY_SIDE 24
#define FULL_SECONDS 15.0

typedef struct shake_way
{
    int ratio; // strands a guide; 0: all are simulated
    int targets, substeps;
    bool sways;
} shake_way;

#define WAYS_MAX 32
#define RATIOS 3

static const int ratios[RATIOS] = { 1, 4, 16 };

typedef struct shakes
{
    strands_shape hair, guides[RATIOS];
    wisp_vec3* path; // [SHAKE_LOOKS][vertex_count] of all strands with many substeps
    shake_way ways[WAYS_MAX];
} shakes;

// ---- heads ----

static const strands_shape* guides_of( const shakes* all, int ratio )
{
    const strands_shape* found = &all->guides[0];
    for ( int i = 0; i < RATIOS; ++i )
    {
        found = ratios[i] == ratio ? &all->guides[i] : found;
    }
    return found;
}

static hair_head_recipe make_recipe( const shakes* all, const shake_way* way, int workers )
{
    const bool has_ghosts = way->ratio > 0;
    hair_head_recipe recipe = hair_head_default_recipe( has_ghosts ? guides_of( all, way->ratio ) : &all->hair );
    recipe.ghosts = has_ghosts ? &all->hair : NULL;
    recipe.substeps = way->substeps;
    recipe.workers = workers;
    recipe.follow.target_count = way->targets;
    if ( !way->sways )
    {
        recipe.follow.elastic = WISP_GHOST_ELASTIC_OFF;
        recipe.follow.tip_gain = 0.0f;
        recipe.follow.centre_gain = 0.0f;
    }
    return recipe;
}

static wisp_status find_path( shakes* all, wisp_error* error )
{
    const shake_way way = { .targets = 1, .substeps = TRUTH_SUBSTEPS };
    const hair_head_recipe recipe = make_recipe( all, &way, 1 );
    const size_t count = (size_t)strands_shape_size( &all->hair );
    hair_head head = { 0 };
    all->path = malloc( SHAKE_LOOKS * count * sizeof( wisp_vec3 ) );
    wisp_status status = all->path
                             ? hair_head_create( &recipe, &head, error )
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for the path of %zu vertices", count );
    for ( int s = 1; s <= SHAKE_STEPS && status == WISP_OK; ++s )
    {
        const wisp_vec3* points = NULL;
        status = hair_head_step( &head, error );
        status = status == WISP_OK ? hair_head_points( &head, &points, error ) : status;
        if ( status == WISP_OK && s % SHAKE_LOOK == 0 )
        {
            memcpy( all->path + (size_t)( s / SHAKE_LOOK - 1 ) * count, points, count * sizeof( wisp_vec3 ) );
        }
    }
    hair_head_destroy( &head );
    return status;
}

// ---- a run ----

enum
{
    FARTHEST,
    STRETCH_MEAN,
    SIMULATED,
    MEASURES,
};

/// What looks come to.
typedef struct shake_tally
{
    double squares, farthest; // m^2, m
    double stretch;
} shake_tally;

static wisp_status look( const shakes* all, hair_head* head, shake_tally* tally, wisp_error* error )
{
    const int count = strands_shape_size( &all->hair );
    const wisp_vec3* truth = all->path + (size_t)( head->steps / SHAKE_LOOK - 1 ) * (size_t)count;
    const wisp_vec3* points = NULL;
    const wisp_status status = hair_head_points( head, &points, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const double distance = strands_rms_distance( points + i, truth + i, 1 );
        tally->squares += distance * distance / ( (double)count * SHAKE_LOOKS );
        tally->farthest = fmax( tally->farthest, distance );
    }
    tally->stretch += status == WISP_OK ? strands_measure_stretch( &all->hair, points ).mean / SHAKE_LOOKS : 0.0;
    return status;
}

static wisp_status run_shake( void* context, int setting, int workers, bool is_looked_at, accuracy_run* out,
                              wisp_error* error )
{
    const shakes* all = context;
    const hair_head_recipe recipe = make_recipe( all, &all->ways[setting], workers );
    shake_tally tally = { 0.0, 0.0, 0.0 };
    hair_head head = { 0 };
    wisp_status status = hair_head_create( &recipe, &head, error );
    for ( int s = 1; s <= SHAKE_STEPS && status == WISP_OK; ++s )
    {
        const bool is_due = is_looked_at && s % SHAKE_LOOK == 0;
        status = accuracy_time_step( hair_head_step, &head, out, error );
        status = status == WISP_OK && is_due ? look( all, &head, &tally, error ) : status;
        if ( status == WISP_OK && out->halted_at == 0 && wisp_is_halted( head.world, head.moving ) )
        {
            out->halted_at = s;
        }
    }
    status = status == WISP_OK ? hair_head_hash( &head, &out->hash, error ) : status;
    hair_head_destroy( &head );
    if ( status == WISP_OK && is_looked_at )
    {
        out->error = 1e3 * sqrt( tally.squares );
        out->measures[FARTHEST] = 1e3 * tally.farthest;
        out->measures[STRETCH_MEAN] = 100.0 * tally.stretch;
        out->measures[SIMULATED] = recipe.moving->strand_count;
    }
    return status;
}

// ---- settings ----

static accuracy_setting* put_way( accuracy_scene* scene, const char* name, shake_way way )
{
    shakes* all = scene->context;
    all->ways[scene->setting_count] = way;
    return accuracy_put_setting( scene, "%s, %d substeps", name, way.substeps );
}

static void put_all( accuracy_scene* scene )
{
    static const int tried[] = { 1, 2, 4, 10, 20 };
    for ( int i = 0; i < WISP_COUNT( tried ); ++i )
    {
        const shake_way way = { .targets = 1, .substeps = tried[i] };
        accuracy_join_series( put_way( scene, "all simulated", way ), "all simulated", "substep, s",
                              (double)STRANDS_STEP / tried[i], 1.0 );
    }
}

static void put_ratios( accuracy_scene* scene, const char* series, shake_way way )
{
    for ( int i = 0; i < RATIOS; ++i )
    {
        char name[48];
        way.ratio = ratios[i];
        snprintf( name, sizeof( name ), "1 : %d, %s", way.ratio, series );
        accuracy_setting* setting = put_way( scene, name, way );
        snprintf( name, sizeof( name ), "%s, %d substeps", series, way.substeps );
        accuracy_join_series( setting, name, "strands a guide", way.ratio, NAN );
        snprintf( setting->method, sizeof( setting->method ), "guides, %s", series );
    }
}

static void destroy_shakes( void* context )
{
    shakes* all = context;
    strands_shape_free( &all->hair );
    for ( int i = 0; i < RATIOS; ++i )
    {
        strands_shape_free( &all->guides[i] );
    }
    free( all->path );
    free( all );
}

wisp_status accuracy_strands_guides( const bench_options* options, double seconds, accuracy_scene* out,
                                     wisp_error* error )
{
    (void)options;
    const int side = seconds < FULL_SECONDS ? FEW_SIDE : MANY_SIDE;
    shakes* all = calloc( 1, sizeof( shakes ) );
    *out = ( accuracy_scene ){
        .error_name = "distance to all simulated",
        .error_unit = "mm",
        .measure_names = { "farthest mm", "stretch mean %", "simulated strands" },
        .measure_count = MEASURES,
        .context = all,
        .run = run_shake,
        .destroy = destroy_shakes,
    };
    snprintf( out->truth, sizeof( out->truth ),
              "all %d strands simulated with %d substeps; root mean square over all vertices and %d looks at a head "
              "that is shaken",
              side * side, TRUTH_SUBSTEPS, SHAKE_LOOKS );
    if ( !all )
    {
        return accuracy_abandon( out, wisp_fail( error, WISP_NO_MEMORY, "no memory for heads that are shaken" ) );
    }
    wisp_status status = hair_head_make_hair( side, SHAKE_VERTICES, &all->hair, error );
    for ( int i = 0; i < RATIOS && status == WISP_OK; ++i )
    {
        status = hair_head_make_guides( &all->hair, ratios[i], &all->guides[i], error );
    }
    status = status == WISP_OK ? find_path( all, error ) : status;
    status = status == WISP_OK ? accuracy_reserve_settings( out, WAYS_MAX, error ) : status;
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    put_all( out );
    put_ratios( out, "ghosts sway", ( shake_way ){ .targets = 1, .substeps = 10, .sways = true } );
    put_ratios( out, "ghosts as guides", ( shake_way ){ .targets = 1, .substeps = 10 } );
    put_ratios( out, "3 guides a ghost", ( shake_way ){ .targets = 3, .substeps = 10 } );
    put_ratios( out, "ghosts as guides", ( shake_way ){ .targets = 1, .substeps = 2 } );
    return WISP_OK;
}
