// The output of `wisp bench accuracy`, whose path is the first argument, is the same in every run except for its
// times: errors, measures and hashes do not depend on the date, the duration and the number of workers.
#include "../app/program_fixture.h"

#include <jansson.h>

// A cheap scene.
#define RUN "bench " WISP_SOURCE_ROOT "/data/suites/accuracy/strands_rest.yaml --seconds 2 --format json "

// The only keys of a row that depend on the date, and on the number of runs within the time.
static const char* const time_keys[] = { "ms_median", "ms_p10", "ms_p90",     "fps",
                                         "stages",    "steps",  "samples_ms", "cpu_fraction" };

static json_t* results_of( const char* command, const char* path )
{
    char words[256];
    json_error_t cause;
    snprintf( words, sizeof( words ), "%s --output %s", command, path );
    run_ok( words );
    json_t* root = json_load_file( path, JSON_REJECT_DUPLICATES, &cause );
    if ( !root )
    {
        fail_msg( "%s:%d: %s", path, cause.line, cause.text );
    }
    return root;
}

// A row as text, without its times.
static char* row_text( const json_t* row )
{
    json_t* copy = json_deep_copy( row );
    for ( int i = 0; i < WISP_COUNT( time_keys ); ++i )
    {
        // a row without one of them has another schema, and this test would overlook something
        assert_int_equal( json_object_del( copy, time_keys[i] ), 0 );
    }
    // workers have memory of their own
    json_object_del( json_object_get( copy, "error" ), "memory_KiB" );
    json_object_del( json_object_get( copy, "size" ), "bytes" );
    char* text = json_dumps( copy, JSON_SORT_KEYS | JSON_REAL_PRECISION( 17 ) );
    json_decref( copy );
    assert_non_null( text );
    return text;
}

static void expect_same_row( const json_t* a, const json_t* b )
{
    char *one = row_text( a ), *other = row_text( b );
    assert_string_equal( one, other );
    free( one );
    free( other );
}

static const json_t* rows_of( const json_t* root )
{
    const json_t* rows = json_object_get( root, "rows" );
    assert_true( json_array_size( rows ) >= 12 );
    return rows;
}

/// Three runs: briefly and long enough for several rounds with two workers, and briefly with one.
static struct
{
    json_t *first, *longer, *alone;
} seen;

static int run_all( void** state )
{
    const int status = enter_new_folder( state );
    seen.first = results_of( RUN "--seconds 0.01 --workers 2", "first.json" );
    seen.longer = results_of( RUN "--seconds 3 --workers 2", "longer.json" );
    seen.alone = results_of( RUN "--seconds 0.01 --workers 1", "alone.json" );
    return status;
}

static int forget_all( void** state )
{
    json_decref( seen.first );
    json_decref( seen.longer );
    json_decref( seen.alone );
    return leave_folder( state );
}

TEST( two_runs_differ_in_times_alone )
{
    const json_t *a = rows_of( seen.first ), *b = rows_of( seen.longer );
    assert_int_equal( json_array_size( a ), json_array_size( b ) );
    for ( size_t i = 0; i < json_array_size( a ); ++i )
    {
        expect_same_row( json_array_get( a, i ), json_array_get( b, i ) );
    }
}

TEST( workers_change_nothing_but_times )
{
    const json_t *a = rows_of( seen.first ), *b = rows_of( seen.alone );
    assert_int_equal( json_array_size( a ), 2 * json_array_size( b ) );
    for ( size_t i = 0; i < json_array_size( b ); ++i )
    {
        // the rows of a setting are consecutive, by workers
        json_t* of_two = json_array_get( a, 2 * i + 1 );
        expect_same_row( json_array_get( a, 2 * i ), json_array_get( b, i ) );
        assert_int_equal( json_integer_value( json_object_get( of_two, "workers" ) ), 2 );
        json_object_set_new( of_two, "workers", json_integer( 1 ) );
        expect_same_row( of_two, json_array_get( b, i ) );
    }
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( run_all, forget_all )
