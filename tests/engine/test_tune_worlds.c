// The search for a configuration of worlds: a small cloth that falls from two corners, and an independent check of
// the result.
#include "surface_fixture.h"

#include "wisp/tune.h"

#define SIDE 9
#define STEPS 64
#define OBSERVATIONS 4
#define TOO_MUCH 1e6f // m/s^2: a cloth without pins is beyond 1e6 m/s after 61 steps, where worlds halt it
#define STEP_SECONDS ( 1.0f / 60.0f )

static const double SUBSTEPS[] = { 1, 2, 4, 8 };
static const double ITERATIONS[] = { 1, 3 };
static const wisp_tune_parameter PARAMETERS[] = {
    { "substeps", SUBSTEPS, WISP_COUNT( SUBSTEPS ), false },
    { "iterations", ITERATIONS, WISP_COUNT( ITERATIONS ), false },
};

typedef struct cloth_host
{
    test_host memory; ///< of the search
    wisp_tune_points points;
    float gravity;        ///< m/s^2, downwards
    int more_at;          ///< substeps from which on the cloth has more vertices; 0: never
    int built, destroyed; ///< worlds
    int stepped;          ///< by the host's own steps
    int fail_at_substeps; ///< building this many fails; 0: none does
} cloth_host;

// ---- worlds ----

static wisp_world* make_world( int substeps, int iterations, int side, float gravity, wisp_entity* out )
{
    static const wisp_module* const modules[] = { &wisp_cloth_module };
    static test_log log;
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.workers = 1;
    def.substeps = substeps;
    def.iterations = iterations;
    def.log = test_log_write;
    def.log_user = &log;
    wisp_world* world;
    assert_int_equal( wisp_world_create( &def, &world, NULL ), WISP_OK );
    test_mesh mesh = test_plane( side, 0.05f );
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    const int32_t corners[2] = { 0, side - 1 };
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = corners;
    surface.pin_count = gravity < TOO_MUCH ? WISP_COUNT( corners ) : 0;
    *out = test_surface_of( world, &fabric, surface );
    test_mesh_free( &mesh );
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    assert_int_equal( wisp_set_cloth( world, *out, &cloth ), WISP_OK );
    assert_int_equal( wisp_set_gravity( world, *out, ( wisp_vec3 ){ 0.0f, -gravity, 0.0f } ), WISP_OK );
    return world;
}

static wisp_status build( void* user, const int* configuration, int factor, wisp_tune_world* out, wisp_error* error )
{
    cloth_host* host = user;
    const int substeps = (int)SUBSTEPS[configuration[0]];
    if ( substeps == host->fail_at_substeps && factor == 1 )
    {
        return wisp_fail( error, WISP_IO_ERROR, "the mesh is gone" );
    }
    const int side = host->more_at > 0 && substeps >= host->more_at ? SIDE + 1 : SIDE;
    const wisp_component component = host->points.component;
    host->points = ( wisp_tune_points ){ .component = component ? component : WISP_SURFACE_POINTS };
    out->world =
        make_world( substeps * factor, (int)ITERATIONS[configuration[1]], side, host->gravity, &host->points.entity );
    out->points = &host->points;
    out->point_count = 1;
    ++host->built;
    return WISP_OK;
}

static void destroy_world( void* user, wisp_tune_world* world )
{
    ++( (cloth_host*)user )->destroyed;
    wisp_world_destroy( world->world );
}

static wisp_tune_worlds_def worlds_def( cloth_host* host )
{
    wisp_tune_worlds_def def = wisp_default_tune_worlds_def();
    def.build = build;
    def.destroy = destroy_world;
    def.user = host;
    def.dt = STEP_SECONDS;
    def.step_count = STEPS;
    def.sample_count = OBSERVATIONS;
    def.reference_factor = 4;
    return def;
}

static wisp_tune_def job_of( cloth_host* host, double error, double budget_ms )
{
    wisp_tune_def args = wisp_default_tune_def();
    args.parameters = PARAMETERS;
    args.parameter_count = WISP_COUNT( PARAMETERS );
    args.error = error;
    args.budget_ms = budget_ms;
    args.repeats = 2;
    args.allocator = test_host_allocator( &host->memory );
    return args;
}

// ---- the check: both worlds side by side ----

static void measure_errors( const int* configuration, double* rms, double* largest )
{
    wisp_entity a, b;
    wisp_world* rough =
        make_world( (int)SUBSTEPS[configuration[0]], (int)ITERATIONS[configuration[1]], SIDE, 9.81f, &a );
    wisp_world* reference = make_world( 4 * 8, 3, SIDE, 9.81f, &b );
    assert_int_equal( wisp_request( rough, a, WISP_SURFACE_POINTS ), WISP_OK );
    assert_int_equal( wisp_request( reference, b, WISP_SURFACE_POINTS ), WISP_OK );
    double sum = 0.0, count = 0.0;
    *largest = 0.0;
    for ( int step = 1; step <= STEPS; ++step )
    {
        assert_int_equal( wisp_world_step( rough, STEP_SECONDS ), WISP_OK );
        assert_int_equal( wisp_world_step( reference, STEP_SECONDS ), WISP_OK );
        wisp_view x, y;
        assert_int_equal( wisp_world_view( rough, a, WISP_SURFACE_POINTS, &x ), WISP_OK );
        assert_int_equal( wisp_world_view( reference, b, WISP_SURFACE_POINTS, &y ), WISP_OK );
        for ( int v = 0; v < x.count && step % ( STEPS / OBSERVATIONS ) == 0; ++v )
        {
            const wisp_vec3 p = ( (const wisp_vec3*)x.data )[v], q = ( (const wisp_vec3*)y.data )[v];
            const double away[3] = { (double)p.x - (double)q.x, (double)p.y - (double)q.y,
                                     (double)p.z - (double)q.z };
            const double square = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
            sum += square;
            *largest = fmax( *largest, sqrt( square ) );
            count += 1.0;
        }
    }
    *rms = sqrt( sum / count );
    wisp_world_destroy( rough );
    wisp_world_destroy( reference );
}

static wisp_tune_result find( cloth_host* host, const wisp_tune_def* args )
{
    const wisp_tune_worlds_def def = worlds_def( host );
    wisp_tune_result found;
    wisp_error error = { 0 };
    assert_ok( wisp_tune_worlds( args, &def, &found, &error ), error );
    return found;
}

// ---- results ----

TEST( an_error_that_is_told_as_met_is_met_when_it_is_measured_apart )
{
    // The error of a configuration in the middle is a target that some meet and some miss.
    static const int middle[2] = { 2, 0 };
    double target, largest;
    measure_errors( middle, &target, &largest );
    assert_true( target > 1e-5 );
    cloth_host host = { .gravity = 9.81f };
    const wisp_tune_def args = job_of( &host, target * ( 1.0 + 1e-9 ), 0.0 );
    wisp_tune_result found = find( &host, &args );
    assert_true( found.meets_target );
    assert_false( found.stopped_early );
    assert_true( found.trial_count >= 3 );
    for ( int v = 0; v < found.trial_count; ++v )
    {
        double rms;
        measure_errors( found.trials[v].configuration, &rms, &largest );
        // The same sums in another order of operations, of the same bits of positions.
        assert_true( fabs( found.trials[v].sample.error / rms - 1.0 ) < 1e-9 );
        assert_true( fabs( found.trials[v].sample.largest / largest - 1.0 ) < 1e-9 );
        assert_true( found.trials[v].sample.ms > 0.0 );
    }
    assert_true( found.achieved.error <= args.error );
    assert_int_equal( host.built, found.run_count + 1 );
    assert_int_equal( host.destroyed, host.built );
    wisp_tune_release( &found );
    assert_host_memory_is_released( &host.memory );
}

TEST( a_generous_budget_gives_the_most_accurate_of_what_was_run )
{
    cloth_host host = { .gravity = 9.81f };
    const wisp_tune_def args = job_of( &host, 0.0, 1e6 );
    wisp_tune_result found = find( &host, &args );
    assert_true( found.meets_target );
    for ( int v = 0; v < found.trial_count; ++v )
    {
        assert_true( found.trials[v].sample.error >= found.achieved.error );
    }
    wisp_tune_release( &found );
}

static wisp_status own_step( void* user, wisp_tune_world* world, int step, wisp_error* error )
{
    cloth_host* host = user;
    host->stepped += step >= 0 && step < STEPS;
    return wisp_world_step( world->world, STEP_SECONDS ) == WISP_OK
               ? WISP_OK
               : wisp_fail( error, WISP_CONFLICT, "%s", wisp_world_message( world->world ) );
}

TEST( a_host_may_step_worlds_itself )
{
    cloth_host ours = { .gravity = 9.81f }, theirs = ours;
    wisp_tune_def args = job_of( &ours, 1e-9, 0.0 );
    wisp_tune_result plain = find( &ours, &args ), stepped;
    wisp_tune_worlds_def def = worlds_def( &theirs );
    def.step = own_step;
    assert_int_equal( wisp_tune_worlds( &args, &def, &stepped, NULL ), WISP_OK );
    assert_int_equal( theirs.stepped, STEPS * theirs.built );
    assert_true( plain.trials[0].sample.error == stepped.trials[0].sample.error );
    assert_false( plain.meets_target || stepped.meets_target );
    wisp_tune_release( &plain );
    wisp_tune_release( &stepped );
}

// ---- rejected input ----

static void assert_no_worlds( cloth_host* host, const wisp_tune_def* args, const wisp_tune_worlds_def* def,
                              wisp_status expected, const char* words )
{
    wisp_tune_result result = { .run_count = 77 };
    wisp_error error = { 0 };
    assert_int_equal( wisp_tune_worlds( args, def, &result, &error ), expected );
    assert_int_equal( result.run_count, 0 );
    assert_null( result.trials );
    assert_one_message( error.message );
    assert_contains( error.message, words );
    assert_int_equal( host->built, host->destroyed );
    assert_host_memory_is_released( &host->memory );
}

TEST( a_reference_that_halts_is_no_reference )
{
    cloth_host host = { .gravity = TOO_MUCH };
    const wisp_tune_def args = job_of( &host, 1e-3, 0.0 );
    const wisp_tune_worlds_def def = worlds_def( &host );
    assert_no_worlds( &host, &args, &def, WISP_CONFLICT, "the reference" );
    assert_int_equal( host.built, 1 );
}

TEST( worlds_of_different_points_are_not_compared )
{
    cloth_host host = { .gravity = 9.81f, .more_at = 8 };
    const wisp_tune_def args = job_of( &host, 1e-3, 0.0 );
    const wisp_tune_worlds_def def = worlds_def( &host );
    assert_no_worlds( &host, &args, &def, WISP_CONFLICT, "got a world of 100 points and one of 81" );
}

TEST( a_world_that_cannot_be_built_ends_the_search )
{
    cloth_host host = { .gravity = 9.81f, .fail_at_substeps = 8 };
    const wisp_tune_def args = job_of( &host, 1e-9, 0.0 );
    const wisp_tune_worlds_def def = worlds_def( &host );
    assert_no_worlds( &host, &args, &def, WISP_IO_ERROR, "the mesh is gone" );
    assert_true( host.built > 1 );
}

TEST( wrong_definitions_are_refused_before_anything_is_built )
{
    cloth_host host = { .gravity = 9.81f };
    const wisp_tune_def args = job_of( &host, 1e-3, 0.0 ), neither = job_of( &host, 0.0, 0.0 );
    const wisp_tune_worlds_def good = worlds_def( &host );
    wisp_tune_worlds_def none = good, still = good, blind = good, often = good, same = good;
    none.build = NULL;
    still.dt = 0.0f;
    blind.sample_count = 0;
    often.sample_count = STEPS + 1;
    same.reference_factor = 1;
    assert_no_worlds( &host, &neither, &good, WISP_BAD_INPUT, "expected one of them above 0" );
    assert_no_worlds( &host, &args, &none, WISP_BAD_INPUT, "expected a callback that builds" );
    assert_no_worlds( &host, &args, &still, WISP_BAD_INPUT, "dt: got 0" );
    assert_no_worlds( &host, &args, &blind, WISP_BAD_INPUT, "sample_count: got 0" );
    assert_no_worlds( &host, &args, &often, WISP_BAD_INPUT, "sample_count: got 65" );
    assert_no_worlds( &host, &args, &same, WISP_BAD_INPUT, "reference_factor: got 1" );
    assert_int_equal( host.built, 0 );
}

TEST( what_is_no_point_is_refused )
{
    cloth_host host = { .gravity = 9.81f, .points = { .component = WISP_SURFACE_NORMALS } };
    const wisp_tune_def args = job_of( &host, 1e-3, 0.0 );
    const wisp_tune_worlds_def def = worlds_def( &host );
    assert_no_worlds( &host, &args, &def, WISP_BAD_INPUT, "expected surface.points or strand.points" );
    host.points.component = WISP_STRAND_POINTS; // a cloth has none
    assert_no_worlds( &host, &args, &def, WISP_CONFLICT, "strand.points" );
}

TEST( memory_that_runs_out_is_told )
{
    for ( int refuse = 1; refuse <= 4; ++refuse )
    {
        cloth_host host = { .gravity = 9.81f, .memory = { .refuse = refuse } };
        const wisp_tune_def args = job_of( &host, 1.0, 0.0 );
        const wisp_tune_worlds_def def = worlds_def( &host );
        assert_no_worlds( &host, &args, &def, WISP_NO_MEMORY, "out of memory" );
    }
}
