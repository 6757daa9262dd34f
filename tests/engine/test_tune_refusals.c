// Invalid input of the search for a configuration, and its end after a failure of the host or of memory.
#include "tune_fixture.h"

static void assert_no_search( searched* args, wisp_status expected, const char* words )
{
    args->args.parameters = args->args.parameters ? args->args.parameters : args->parameters;
    wisp_tune_result result = { .run_count = 77 };
    wisp_error error = { 0 };
    assert_int_equal( wisp_tune( &args->args, &result, &error ), expected );
    assert_int_equal( result.run_count, 0 );
    assert_null( result.trials );
    assert_contains( error.message, words );
}

TEST( bad_targets_are_refused )
{
    static const double targets[][2] = { { 0, 0 }, { 1, 1 }, { -1, 0 }, { 0, -1 }, { 1, -1 } };
    surface s = make_surface( 1, 2, 2, 2 );
    for ( int i = 0; i < WISP_COUNT( targets ); ++i )
    {
        searched args = search_of( &s, targets[i][0], targets[i][1] );
        assert_no_search( &args, WISP_BAD_INPUT, "expected one of them above 0 and the other 0" );
    }
    searched nan = search_of( &s, NAN, 0.0 ), infinite = search_of( &s, 0.0, INFINITY );
    assert_no_search( &nan, WISP_BAD_INPUT, "error, budget_ms: got nan" );
    assert_no_search( &infinite, WISP_BAD_INPUT, "and inf, expected" );
    assert_int_equal( s.run_count, 0 );
}

TEST( bad_parameters_are_refused )
{
    surface s = make_surface( 1, 2, 2, 2 );
    searched none = search_of( &s, 1, 0 ), nine = none, nameless = none, empty = none, many = none, absent = none;
    none.args.parameter_count = 0;
    assert_no_search( &none, WISP_BAD_INPUT, "got 0 parameters" );
    nine.args.parameter_count = 9;
    assert_no_search( &nine, WISP_BAD_INPUT, "got 9 parameters" );
    nameless.parameters[1].name = "";
    assert_no_search( &nameless, WISP_BAD_INPUT, "parameter 1: got no name" );
    empty.parameters[2].value_count = 0;
    assert_no_search( &empty, WISP_BAD_INPUT, "parameter 'third': got 0 values" );
    absent.parameters[0].values = NULL;
    assert_no_search( &absent, WISP_BAD_INPUT, "parameter 'substeps': got 0 values" );
    wisp_tune_parameter wide[4] = {
        { "a", VALUES, 16, false }, { "b", VALUES, 16, false }, { "c", VALUES, 16, false }, { "d", VALUES, 2, false }
    };
    many.args.parameters = wide;
    many.args.parameter_count = 4;
    assert_no_search( &many, WISP_BAD_INPUT, "8192 configurations" );
    assert_int_equal( s.run_count, 0 );
}

TEST( bad_limits_are_refused )
{
    surface s = make_surface( 1, 2, 2, 2 );
    searched runs = search_of( &s, 1, 0 ), seconds = runs, repeats = runs, callback = runs, allocator = runs;
    runs.args.max_runs = 0;
    assert_no_search( &runs, WISP_BAD_INPUT, "max_runs, max_seconds: got 0 and" );
    seconds.args.max_seconds = NAN;
    assert_no_search( &seconds, WISP_BAD_INPUT, "and nan, expected" );
    repeats.args.repeats = 100;
    assert_no_search( &repeats, WISP_BAD_INPUT, "repeats: got 100" );
    callback.args.run = NULL;
    assert_no_search( &callback, WISP_BAD_INPUT, "expected a callback" );
    test_host host = { 0 };
    allocator.args.allocator = test_host_allocator( &host );
    allocator.args.allocator.release = NULL;
    assert_no_search( &allocator, WISP_BAD_INPUT, "allocator" );
}

TEST( a_run_that_fails_ends_the_search_with_its_message )
{
    for ( int run = 1; run <= 6; ++run )
    {
        surface s = make_surface( 5, 6, 5, 4 );
        s.fail_at = run;
        searched args = search_of( &s, between( s.error, size_of( &s ), 0.4 ), 0.0 );
        assert_no_search( &args, WISP_IO_ERROR, "the host has lost its disk" );
        assert_int_equal( s.run_count, run );
    }
}

TEST( a_sample_that_is_no_number_is_refused )
{
    static const double wrong[] = { NAN, INFINITY, -1.0 };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        surface time = make_surface( 5, 1, 1, 1 ), error = time;
        time.ms[0] = wrong[i];
        error.error[0] = wrong[i];
        searched first = search_of( &time, 1, 0 ), second = search_of( &error, 1, 0 );
        assert_no_search( &first, WISP_BAD_INPUT, "run 1, with 'substeps' at 1" );
        assert_no_search( &second, WISP_BAD_INPUT, "expected finite numbers of at least 0" );
    }
}

TEST( memory_that_runs_out_is_told_and_all_comes_back )
{
    for ( int refuse = 0; refuse <= 2; ++refuse )
    {
        test_host host = { .refuse = refuse };
        surface s = make_surface( 5, 3, 3, 3 );
        searched args = search_of( &s, 0.05, 0.0 );
        args.args.allocator = test_host_allocator( &host );
        if ( refuse > 0 )
        {
            assert_no_search( &args, WISP_NO_MEMORY, "out of memory" );
        }
        else
        {
            wisp_tune_result found = find( &args );
            wisp_tune_release( &found );
            wisp_tune_release( &found );
            assert_int_equal( host.queried, 2 );
        }
        assert_int_equal( host.blocks, 0 );
        assert_int_equal( host.faults, 0 );
    }
    wisp_tune_release( NULL );
}
