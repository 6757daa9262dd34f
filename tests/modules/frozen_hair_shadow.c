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

static void hold( hair_shadow* shadow, const char* stage, int iteration, const double3* expected,
                  const wisp_vec3* actual, const double* bound, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        double offset = double3_distance( expected[v], double3_widen( actual[v] ) );
        if ( !( offset <= bound[v] ) )
        {
            fail_msg( "%s %d: vertex %d is %.3g m off, %.3g are allowed", stage, iteration, v, offset, bound[v] );
        }
        shadow->offset = fmax( shadow->offset, offset );
        shadow->fraction = bound[v] > 0.0 ? fmax( shadow->fraction, offset / bound[v] ) : shadow->fraction;
    }
}

static wisp_vec3* copy_rest( const hair_groom* groom )
{
    wisp_vec3* points = checked_calloc( (size_t)groom->vertex_count + 1, sizeof( wisp_vec3 ) );
    memcpy( points, groom->points, (size_t)groom->vertex_count * sizeof( wisp_vec3 ) );
    return points;
}

// Compare one stage and continue: `current` becomes the engine's result.
static void advance( hair_shadow* shadow, const char* stage, int iteration, const double3* expected,
                     const double* bound, wisp_vec3** current, wisp_vec3* next, int count )
{
    hold( shadow, stage, iteration, expected, next, bound, count );
    free( *current );
    *current = next;
}

static void follow_clump( hair_shadow* shadow, const partial_run* run, hair_oracle* oracle, wisp_vec3** current )
{
    const int count = run->groom->vertex_count;
    wisp_frozen_hair_def part = *run->whole;
    SCOPED( free_local ) double3 *reference = hair_widen_all( *current, count ), *out = hair_new_points( count );
    SCOPED( free_local ) double* bound = checked_calloc( 3 * (size_t)count + 1, sizeof( double ) );
    double *in_bound = bound + count, *exact = in_bound + count;
    for ( int k = 0; k < run->whole->clump_iterations; ++k )
    {
        wisp_frozen_hair_stats report;
        part.clump_iterations = k + 1;
        wisp_vec3* next = run_partly( run, &part, &report );
        SCOPED( free_local ) double3* in = hair_widen_all( *current, count );
        assert_int_equal(
            frozen_oracle_clump_step( &oracle->hair, &oracle->options, k, reference, in, NULL, NULL, NULL, out ),
            WISP_OK );

        // A run of k + 1 iterations may add the neighbours of its k-th in another order than a run of k did.
        hair_bound_clump( oracle, k, reference, in, in_bound, bound );
        advance( shadow, "clump iteration", k, out, bound, current, next, count );
        hair_bound_clump( oracle, k, reference, in, exact, in_bound );
        for ( int v = 0; v < count; ++v )
        {
            in_bound[v] *= 2.0;
        }
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
    SCOPED( free_local ) double3 *base = hair_widen_all( current, count ), *out = hair_new_points( count );
    SCOPED( free_local ) double* bound = checked_calloc( (size_t)count + 1, sizeof( double ) );

    wisp_frozen_hair_def part = *def;
    part.align = part.clump = false;
    if ( def->freeze )
    {
        frozen_oracle_deform( &oracle.hair, &oracle.options, out );
        hair_bound_freeze( &oracle, base, bound );
        advance( &shadow, "freeze", 0, out, bound, &current, run_partly( &run, &part, NULL ), count );
    }
    part.align = def->align;
    if ( def->align )
    {
        SCOPED( free_local ) double3* in = hair_widen_all( current, count );
        frozen_oracle_align( &oracle.hair, &oracle.options, in, out );
        hair_bound_align( &oracle, in, bound );
        advance( &shadow, "align", 0, out, bound, &current, run_partly( &run, &part, NULL ), count );
    }
    if ( def->clump )
    {
        follow_clump( &shadow, &run, &oracle, &current );
    }
    SCOPED( free_local ) wisp_vec3* whole = run_partly( &run, def, NULL );
    assert_true( hair_same_bits( whole, current, count ) );
    return shadow;
}

// ---- the whole pipeline ----

static double3 shifted( double3 p, double amount, int trial, int v, int dimension )
{
    const wisp_random_key key = wisp_random_make_key( 31, 0, (uint64_t)trial );
    double3 d = { wisp_random_unit( key, (uint32_t)v, 0, 0 ) - 0.5, wisp_random_unit( key, (uint32_t)v, 1, 0 ) - 0.5,
                  dimension == 2 ? 0.0 : wisp_random_unit( key, (uint32_t)v, 2, 0 ) - 0.5 };
    return double3_add( p, double3_scale( 2.0 * amount, d ) );
}

static double largest( const double* values, int count )
{
    double most = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        most = fmax( most, values[i] );
    }
    return most;
}

static void run_after_freeze( const hair_oracle* oracle, const double3* p, double3* scratch, double3* out )
{
    size_t bytes = (size_t)oracle->vertex_count * sizeof( double3 );
    memcpy( scratch, p, bytes );
    if ( oracle->options.align )
    {
        frozen_oracle_align( &oracle->hair, &oracle->options, p, scratch );
    }
    memcpy( out, scratch, bytes );
    if ( oracle->options.clump )
    {
        assert_int_equal( frozen_oracle_clump( &oracle->hair, &oracle->options, scratch, NULL, out ), WISP_OK );
    }
}

void hair_compare_pipeline( const hair_groom* groom, const wisp_frozen_hair_def* def )
{
    const int count = groom->vertex_count;
    SCOPED( hair_oracle_destroy ) hair_oracle oracle = hair_oracle_create( groom, def, 0 );
    SCOPED( free_local )
    double3 *frozen = hair_widen_all( groom->points, count ), *scratch = hair_new_points( count );
    SCOPED( free_local )
    double3 *expected = hair_new_points( count ), *moved = hair_new_points( count ), *out = hair_new_points( count );
    SCOPED( free_local ) double* bound = checked_calloc( 2 * (size_t)count + 1, sizeof( double ) );
    const double* exact = bound + count;
    double amount = 0.0;
    if ( def->freeze )
    {
        frozen_oracle_deform( &oracle.hair, &oracle.options, frozen );
        hair_bound_freeze( &oracle, oracle.rest, bound );
        amount += largest( bound, count );
    }
    if ( def->align )
    {
        hair_bound_align( &oracle, frozen, bound );
        amount += largest( bound, count );
    }
    run_after_freeze( &oracle, frozen, scratch, expected );
    if ( def->clump )
    {
        hair_bound_clump( &oracle, 0, scratch, scratch, exact, bound );
        amount += largest( bound, count );
    }

    double tolerance = amount;
    for ( int trial = 0; trial < 4; ++trial )
    {
        for ( int v = 0; v < count; ++v )
        {
            moved[v] = shifted( frozen[v], amount, trial, v, groom->dimension );
        }
        run_after_freeze( &oracle, moved, scratch, out );
        for ( int v = 0; v < count; ++v )
        {
            tolerance = fmax( tolerance, double3_distance( out[v], expected[v] ) );
        }
    }
    SCOPED( free_local ) wisp_vec3* actual = hair_run( NULL, groom, def );
    double offset = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        double distance = double3_distance( expected[v], double3_widen( actual[v] ) );
        assert_true( isfinite( distance ) );
        offset = fmax( offset, distance );
    }
    print_message( "           pipeline: %.2g m off, %.2g allowed\n", offset, tolerance );
    assert_true( offset <= tolerance );
}
