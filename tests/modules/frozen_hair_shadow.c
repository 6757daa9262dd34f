#include "frozen_hair_shadow.h"

// The engine's result for the groom with some stages on, after earlier commands with all of them.
typedef struct partial_run
{
    const hair_host* host;
    const hair_groom* groom;
    const wisp_frozen_hair_def* whole;
    int commands;
} partial_run;

static wisp_vec3* run_partly( const partial_run* run, const wisp_frozen_hair_def* part,
                              wisp_frozen_hair_stats* report )
{
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( run->host );
    wisp_entity entity = hair_add( world, run->groom );
    for ( int i = 0; i < run->commands; ++i )
    {
        hair_set( world, entity, run->whole );
        hair_step( world );
    }
    // without a stage there is no command, and the shape is that of the earlier ones; a command starts from rest
    hair_set( world, entity, part );
    hair_step( world );
    wisp_vec3* points = hair_points( world, entity, run->groom->vertex_count );
    if ( report != NULL )
    {
        *report = hair_stats( world, entity );
    }
    return points;
}

// Coordinates and lengths round some times in a step, each by u of the largest coordinate. Stretched strands are long.
static const double ALIGN_ROUNDINGS = 64.0, CLUMP_ROUNDINGS = 8.0;

// An angle rounds by u of the largest that can be drawn.
static double freeze_roundings( const hair_oracle* oracle )
{
    double softest = INFINITY;
    for ( int s = 0; s < oracle->hair.strand_count; ++s )
    {
        softest = fmin( softest, oracle->hair.bend_stiffness[s] );
    }
    return 64.0 + 8.0 * oracle->options.theta_max / softest;
}

static double rounding_of( double roundings, const double3* points, int count )
{
    double most = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        most = fmax( most, double3_length( points[v] ) );
    }
    return roundings * HAIR_ROUNDING * most;
}

// @param spread of each vertex, besides rounding; may be null
static void hold( hair_shadow* shadow, const char* stage, int iteration, const double3* expected,
                  const wisp_vec3* actual, double roundings, const double* spread, int count )
{
    const double rounding = rounding_of( roundings, expected, count );
    for ( int v = 0; v < count; ++v )
    {
        const double offset = double3_distance( expected[v], double3_widen( actual[v] ) ),
                     allowed = rounding + ( spread != NULL ? spread[v] : 0.0 );
        if ( !( offset <= allowed ) )
        {
            fail_msg( "%s %d: vertex %d is %.3g m off, %.3g are allowed", stage, iteration, v, offset, allowed );
        }
        shadow->offset = fmax( shadow->offset, offset );
        shadow->fraction = allowed > 0.0 ? fmax( shadow->fraction, offset / allowed ) : shadow->fraction;
    }
}

static wisp_vec3* copy_rest( const hair_groom* groom )
{
    wisp_vec3* points = checked_calloc( (size_t)groom->vertex_count + 1, sizeof( wisp_vec3 ) );
    memcpy( points, groom->points, (size_t)groom->vertex_count * sizeof( wisp_vec3 ) );
    return points;
}

// Compare one stage and continue: `current` becomes the engine's result.
static void advance( hair_shadow* shadow, const char* stage, double roundings, const double3* expected,
                     wisp_vec3** current, wisp_vec3* next, int count )
{
    hold( shadow, stage, 0, expected, next, roundings, NULL, count );
    free( *current );
    *current = next;
}

static double3 shifted( double3 p, double amount, int trial, int v, int dimension )
{
    const wisp_random_key key = wisp_random_make_key( 31, 0, (uint64_t)trial );
    double3 d = { wisp_random_unit( key, (uint32_t)v, 0, 0 ) - 0.5, wisp_random_unit( key, (uint32_t)v, 1, 0 ) - 0.5,
                  dimension == 2 ? 0.0 : wisp_random_unit( key, (uint32_t)v, 2, 0 ) - 0.5 };
    return double3_add( p, double3_scale( 2.0 * amount, d ) );
}

// How far the oracle's step takes each vertex when its input is moved by rounding: the largest of four random moves.
static void find_spread( const hair_oracle* oracle, int iteration, const double3* reference, const double3* in,
                         const double3* out, double* spread )
{
    const int count = oracle->vertex_count;
    const double amount = rounding_of( CLUMP_ROUNDINGS, in, count );
    SCOPED( free_local ) double3 *moved = hair_new_points( count ), *other = hair_new_points( count );
    memset( spread, 0, (size_t)count * sizeof( double ) );
    for ( int trial = 0; trial < 4; ++trial )
    {
        for ( int v = 0; v < count; ++v )
        {
            moved[v] = shifted( in[v], amount, trial, v, oracle->options.dimension );
        }
        assert_int_equal( frozen_oracle_clump_step( &oracle->hair, &oracle->options, iteration, reference, moved,
                                                    NULL, NULL, NULL, other ),
                          WISP_OK );
        for ( int v = 0; v < count; ++v )
        {
            spread[v] = fmax( spread[v], double3_distance( other[v], out[v] ) );
        }
    }
}

static void follow_clump( hair_shadow* shadow, const partial_run* run, hair_oracle* oracle, wisp_vec3** current )
{
    const int count = run->groom->vertex_count;
    wisp_frozen_hair_def part = *run->whole;
    SCOPED( free_local ) double3 *reference = hair_widen_all( *current, count ), *out = hair_new_points( count );
    SCOPED( free_local ) double* spread = checked_calloc( (size_t)count + 1, sizeof( double ) );
    for ( int k = 0; k < run->whole->clump_iterations; ++k )
    {
        wisp_frozen_hair_stats report;
        part.clump_iterations = k + 1;
        wisp_vec3* next = run_partly( run, &part, &report );
        SCOPED( free_local ) double3* in = hair_widen_all( *current, count );
        assert_int_equal(
            frozen_oracle_clump_step( &oracle->hair, &oracle->options, k, reference, in, NULL, NULL, NULL, out ),
            WISP_OK );
        // a run of k + 1 iterations may add the neighbours of its k-th in another order than a run of k did
        find_spread( oracle, k, reference, in, out, spread );
        hold( shadow, "clump iteration", k, out, next, CLUMP_ROUNDINGS, spread, count );
        free( *current );
        *current = next;
        shadow->neighbours = report.neighbours;
        shadow->capped = report.capped;
        shadow->searches = report.searches;
        shadow->late = report.missed;
    }
}

hair_shadow hair_follow( const hair_host* host, const hair_groom* groom, const wisp_frozen_hair_def* def,
                         int commands )
{
    const partial_run run = { host, groom, def, commands };
    const int count = groom->vertex_count;
    hair_shadow shadow = { 0 };
    SCOPED( hair_oracle_destroy ) hair_oracle oracle = hair_oracle_create( groom, def, (uint64_t)commands );
    SCOPED( free_local ) wisp_vec3* current = copy_rest( groom );
    SCOPED( free_local ) double3* out = hair_new_points( count );

    wisp_frozen_hair_def part = *def;
    part.align = part.clump = false;
    if ( def->freeze )
    {
        frozen_oracle_deform( &oracle.hair, &oracle.options, out );
        advance( &shadow, "freeze", freeze_roundings( &oracle ), out, &current, run_partly( &run, &part, NULL ),
                 count );
    }
    part.align = def->align;
    if ( def->align )
    {
        SCOPED( free_local ) double3* in = hair_widen_all( current, count );
        frozen_oracle_align( &oracle.hair, &oracle.options, in, out );
        advance( &shadow, "align", ALIGN_ROUNDINGS, out, &current, run_partly( &run, &part, NULL ), count );
    }
    if ( def->clump )
    {
        follow_clump( &shadow, &run, &oracle, &current );
    }
    SCOPED( free_local ) wisp_vec3* whole = run_partly( &run, def, NULL );
    assert_true( hair_same_bits( whole, current, count ) );
    return shadow;
}
