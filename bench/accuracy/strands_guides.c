// Guides and ghosts against simulating all strands: the error of fewer guides on a shaken head, next to that of fewer
// substeps of all strands for the same time.
#include "scene_tools.h"
#include "strands_guides.h"

#include <math.h>
#include <stdlib.h>

typedef struct shake_way
{
    int ratio; // strands per guide; 0: all are simulated
    int targets, substeps;
    bool sways;
} shake_way;

#define WAYS_MAX 32
#define RATIOS 3

static const int ratios[RATIOS] = { 1, 4, 16 };

typedef struct shakes
{
    strands_shape hair, guides[RATIOS];
    accuracy_reference reference; // of all strands
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

static hair_head_generator make_generator( const shakes* all, const shake_way* way, int workers )
{
    const bool has_ghosts = way->ratio > 0;
    hair_head_generator generator =
        hair_head_default_generator( has_ghosts ? guides_of( all, way->ratio ) : &all->hair );
    generator.ghosts = has_ghosts ? &all->hair : NULL;
    generator.substeps = way->substeps;
    generator.workers = workers;
    generator.follow.target_count = way->targets;
    if ( !way->sways )
    {
        generator.follow.elastic = WISP_GHOST_ELASTIC_OFF;
        generator.follow.tip_gain = 0.0f;
        generator.follow.centre_gain = 0.0f;
    }
    return generator;
}

// ---- reference ----

wisp_status shake_make_hair( strands_shape* out, wisp_error* error )
{
    return hair_head_make_hair( SHAKE_SIDE, SHAKE_VERTICES, out, error );
}

int shake_seen_vertex( int place )
{
    return SHAKE_STRIDE * ( place / SHAKE_SEEN_VERTICES ) * SHAKE_VERTICES + 2 * ( place % SHAKE_SEEN_VERTICES ) + 1;
}

accuracy_reference strands_guides_reference( const strands_shape* hair )
{
    const wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    accuracy_reference reference = { .scene = "strands_guides",
                                     .number_count = 3 * SHAKE_OBSERVATIONS * SHAKE_SEEN * SHAKE_SEEN_VERTICES };
    const wisp_transform turned = hair_head_pose( 0.5 );
    accuracy_reference_put( &reference, "strands", hair->strand_count );
    accuracy_reference_put( &reference, "vertices a strand", hair->vertices );
    accuracy_reference_put( &reference, "line density, kg/m", (double)def.line_density );
    accuracy_reference_put( &reference, "rigidity of bending, N m2", (double)def.bend_rigidity );
    accuracy_reference_put( &reference, "rigidity of twist, N m2", (double)def.twist_rigidity );
    accuracy_reference_put( &reference, "damping, 1/s", (double)def.damping );
    accuracy_reference_put( &reference, "gravity, m/s2", -(double)def.gravity.y );
    accuracy_reference_put( &reference, "steps a second", 1.0 / (double)STRANDS_STEP );
    accuracy_reference_put( &reference, "steps between observations", SHAKE_OBSERVATION );
    accuracy_reference_put( &reference, "observations", SHAKE_OBSERVATIONS );
    accuracy_reference_put( &reference, "head after 0.5 s, m", (double)turned.translation.x );
    accuracy_reference_put( &reference, "head after 0.5 s, half sine", (double)turned.rotation.y );
    accuracy_reference_put_start( &reference, hair->points, strands_shape_size( hair ) );
    return reference;
}

// ---- a run ----

enum
{
    FARTHEST,
    STRETCH_MEAN,
    SIMULATED,
    MEASURES,
};

/// Sums over the samples.
typedef struct shake_tally
{
    double squares, farthest; // m^2, m
    double stretch;
} shake_tally;

static wisp_status observe( const shakes* all, hair_head* head, shake_tally* tally, wisp_error* error )
{
    const int count = SHAKE_SEEN * SHAKE_SEEN_VERTICES;
    const double* reference =
        all->reference.numbers + (size_t)( 3 * ( head->steps / SHAKE_OBSERVATION - 1 ) * count );
    const wisp_vec3* points = NULL;
    const wisp_status status = hair_head_points( head, &points, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i, reference += 3 )
    {
        const wisp_vec3 p = points[shake_seen_vertex( i )];
        const double x = (double)p.x - reference[0], y = (double)p.y - reference[1], z = (double)p.z - reference[2];
        const double squared = x * x + y * y + z * z;
        tally->squares += squared / ( (double)count * SHAKE_OBSERVATIONS );
        tally->farthest = fmax( tally->farthest, sqrt( squared ) );
    }
    tally->stretch +=
        status == WISP_OK ? strands_measure_stretch( &all->hair, points ).mean / SHAKE_OBSERVATIONS : 0.0;
    return status;
}

static wisp_status run_shake( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                              wisp_error* error )
{
    const shakes* all = context;
    const hair_head_generator generator = make_generator( all, &all->ways[setting], workers );
    shake_tally tally = { 0.0, 0.0, 0.0 };
    hair_head head = { 0 };
    wisp_status status = hair_head_create( &generator, &head, error );
    for ( int s = 1; s <= SHAKE_STEPS && status == WISP_OK; ++s )
    {
        const bool is_due = is_observed && s % SHAKE_OBSERVATION == 0;
        status = accuracy_time_step( hair_head_step, &head, out, error );
        status = status == WISP_OK && is_due ? observe( all, &head, &tally, error ) : status;
        if ( status == WISP_OK && out->halted_at == 0 && wisp_is_halted( head.world, head.moving ) )
        {
            out->halted_at = s;
        }
    }
    status = status == WISP_OK ? hair_head_hash( &head, &out->hash, error ) : status;
    hair_head_destroy( &head );
    if ( status == WISP_OK && is_observed )
    {
        out->error = 1e3 * sqrt( tally.squares );
        out->measures[FARTHEST] = 1e3 * tally.farthest;
        out->measures[STRETCH_MEAN] = 100.0 * tally.stretch;
        out->measures[SIMULATED] = generator.moving->strand_count;
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
        accuracy_join_series( setting, name, "strands per guide", way.ratio, NAN );
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
    accuracy_reference_free( &all->reference );
    free( all );
}

wisp_status accuracy_strands_guides( const bench_options* options, double seconds, accuracy_scene* out,
                                     wisp_error* error )
{
    (void)options;
    (void)seconds; // its reference has this many strands
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
    if ( !all )
    {
        return accuracy_abandon( out, wisp_fail( error, WISP_NO_MEMORY, "no memory for heads that are shaken" ) );
    }
    wisp_status status = shake_make_hair( &all->hair, error );
    for ( int i = 0; i < RATIOS && status == WISP_OK; ++i )
    {
        status = hair_head_make_guides( &all->hair, ratios[i], &all->guides[i], error );
    }
    const accuracy_reference requested =
        status == WISP_OK ? strands_guides_reference( &all->hair ) : ( accuracy_reference ){ 0 };
    status = status == WISP_OK
                 ? accuracy_reference_read( accuracy_reference_folder(), &requested, &all->reference, error )
                 : status;
    status = status == WISP_OK ? accuracy_reserve_settings( out, WAYS_MAX, error ) : status;
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    accuracy_describe_reference( &all->reference, 1e3, out );
    put_all( out );
    put_ratios( out, "ghosts sway", ( shake_way ){ .targets = 1, .substeps = 10, .sways = true } );
    put_ratios( out, "ghosts as guides", ( shake_way ){ .targets = 1, .substeps = 10 } );
    put_ratios( out, "3 guides a ghost", ( shake_way ){ .targets = 3, .substeps = 10 } );
    put_ratios( out, "ghosts as guides", ( shake_way ){ .targets = 1, .substeps = 2 } );
    return WISP_OK;
}
