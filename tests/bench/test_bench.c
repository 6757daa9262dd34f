// The runner: variants take turns, warm-up steps are not samples, and failures end the run.
#include "bench_tables.h"
#include "bench.h"

typedef struct step_log
{
    char order[4096]; ///< one letter per step, in the order of the steps
    int count;
} step_log;

/// A variant that takes a given time and can fail.
typedef struct pretender
{
    step_log* log;
    char letter;
    double seconds;
    int fails_at; ///< number of the step that fails, from 1; 0: none
    int steps, afters;
} pretender;

static wisp_status pretend( void* context, wisp_error* error )
{
    pretender* p = context;
    if ( p->log->count < WISP_COUNT( p->log->order ) - 1 )
    {
        p->log->order[p->log->count++] = p->letter;
    }
    double end = wisp_clock_seconds() + p->seconds;
    while ( wisp_clock_seconds() < end )
    {
        // A step of that duration.
    }
    return ++p->steps == p->fails_at ? wisp_fail( error, WISP_CONFLICT, "step %d", p->steps ) : WISP_OK;
}

static wisp_status count_after( void* context )
{
    ++( (pretender*)context )->afters;
    return WISP_OK;
}

static bench_variant variant_of( pretender* p )
{
    return ( bench_variant ){ .step = pretend, .after = count_after, .context = p };
}

TEST( long_steps_alternate_one_by_one )
{
    step_log log = { .count = 0 };
    pretender a = { &log, 'A', 0.03, 0, 0, 0 }, b = { &log, 'B', 0.03, 0, 0, 0 };
    bench_variant variants[] = { variant_of( &a ), variant_of( &b ) };
    const bench_effort effort = { .seconds = 10.0, .rounds_min = 1, .samples_max = 3 };
    wisp_error error = { 0 };
    assert_int_equal( bench_interleave( variants, 2, &effort, &error ), WISP_OK );

    // two warm-up steps each, then turns of one step
    assert_string_equal( log.order, "AABB"
                                    "ABABAB" );
    assert_int_equal( variants[0].sample_count, 3 );
    assert_int_equal( a.afters, 3 );
    assert_true( variants[1].samples[0] >= 30.0 );
    bench_free_samples( variants, 2 );
}

TEST( short_steps_have_longer_turns_whose_first_step_does_not_count )
{
    step_log log = { .count = 0 };
    pretender a = { &log, 'A', 0.0, 0, 0, 0 }, b = { &log, 'B', 0.0, 0, 0, 0 };
    bench_variant variants[] = { variant_of( &a ), variant_of( &b ) };

    // given, not measured, so that a busy machine cannot make the steps look long
    variants[0].warm_ms = variants[1].warm_ms = 0.01;
    const bench_effort effort = { .seconds = 10.0, .rounds_min = 1, .samples_max = 20 };
    wisp_error error = { 0 };
    assert_int_equal( bench_interleave( variants, 2, &effort, &error ), WISP_OK );

    assert_int_equal( variants[0].sample_count, 20 );
    assert_int_equal( variants[1].sample_count, 20 );
    assert_int_equal( a.steps, 1 + 20 );
    assert_string_equal( log.order, "AAAAAAAAAAAAAAAAAAAAA"
                                    "BBBBBBBBBBBBBBBBBBBBB" );
    bench_free_samples( variants, 2 );
}

TEST( a_variant_that_is_warm_already_is_not_warmed_up )
{
    step_log log = { .count = 0 };
    pretender a = { &log, 'A', 0.0, 0, 0, 0 };
    bench_variant variant = variant_of( &a );
    variant.warm_ms = 1000.0;
    const bench_effort effort = { .seconds = 10.0, .rounds_min = 1, .samples_max = 2 };
    wisp_error error = { 0 };
    assert_int_equal( bench_interleave( &variant, 1, &effort, &error ), WISP_OK );

    assert_string_equal( log.order, "AA" );
    bench_free_samples( &variant, 1 );
}

TEST( the_time_ends_the_run_after_the_least_number_of_rounds )
{
    step_log log = { .count = 0 };
    pretender a = { &log, 'A', 0.011, 0, 0, 0 };
    bench_variant variant = variant_of( &a );
    const bench_effort effort = { .seconds = 0.0, .rounds_min = 2, .samples_max = 100 };
    wisp_error error = { 0 };
    assert_int_equal( bench_interleave( &variant, 1, &effort, &error ), WISP_OK );

    assert_int_equal( variant.sample_count, 2 );
    bench_free_samples( &variant, 1 );
}

TEST( a_step_that_fails_ends_the_run_with_its_message )
{
    step_log log = { .count = 0 };
    pretender a = { &log, 'A', 0.0, 0, 0, 0 }, b = { &log, 'B', 0.0, 5, 0, 0 };
    bench_variant variants[] = { variant_of( &a ), variant_of( &b ) };
    const bench_effort effort = { .seconds = 10.0, .rounds_min = 1, .samples_max = 100 };
    wisp_error error = { 0 };
    assert_int_equal( bench_interleave( variants, 2, &effort, &error ), WISP_CONFLICT );

    assert_string_equal( error.message, "step 5" );
    bench_free_samples( variants, 2 );
}

TEST( every_case_has_a_name_of_its_own_and_a_purpose )
{
    int count;
    const bench_case* cases = bench_cases( &count );
    assert_true( count > 0 );
    for ( int i = 0; i < count; ++i )
    {
        assert_true( cases[i].name[0] && cases[i].purpose[0] && cases[i].run );
        for ( int k = 0; k < i; ++k )
        {
            assert_string_not_equal( cases[i].name, cases[k].name );
        }
    }
}

TEST( quick_is_shorter_unless_the_user_says_how_long )
{
    bench_options options = bench_default_options();
    double full = bench_seconds( &options );
    options.quick = true;
    assert_true( bench_seconds( &options ) <= 20.0 && bench_seconds( &options ) < full );
    options.seconds = 3.0;
    assert_true( bench_seconds( &options ) == 3.0 );
}

// ---- tables on a terminal ----

static char* text_of( const results_table* table )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    assert_non_null( stream );
    results_write_text_table( table, stream );
    fclose( stream );
    return text;
}

static int count_parts( const char* text, const char* what )
{
    int count = 0;
    for ( size_t i = 0; text[i] != '\0'; ++i )
    {
        count += strncmp( text + i, what, strlen( what ) ) == 0 ? 1 : 0;
    }
    return count;
}

TEST( a_table_of_many_columns_is_split_and_repeats_what_tells_its_rows_apart )
{
    enum
    {
        COLUMNS = 20,
    };
    results all = { 0 };
    const char* header[COLUMNS] = { "size", "solver" };
    const char* cells[COLUMNS] = { "10", "direct" };
    for ( int i = 2; i < COLUMNS; ++i )
    {
        header[i] = "ms";
        cells[i] = "1";
    }
    const int table = results_add_table( &all, "A wide table", COLUMNS, header );
    results_add_cells( &all, table, cells );
    cells[1] = "links";
    results_add_cells( &all, table, cells );
    char* text = text_of( &all.tables[table] );

    // two columns identify the rows and leave room for six others
    assert_int_equal( count_parts( text, "A wide table" ), 3 );
    assert_int_equal( count_parts( text, "size  solver" ), 3 );
    assert_int_equal( count_parts( text, "ms" ), COLUMNS - 2 );
    free( text );
    results_free( &all );
}

TEST( long_cells_go_on_in_the_next_line )
{
    results all = { 0 };
    char words[400] = "";
    for ( int i = 0; i < 60; ++i )
    {
        strcat( words, "word " );
    }
    const int table = results_add_table( &all, words, 3, ( const char* const[] ){ "one", "two", words } );
    results_add_cells( &all, table, ( const char* const[] ){ words, words, "3" } );
    assert_fits_terminal( &all );
    char* text = text_of( &all.tables[table] );
    // the title is cut at 160 characters; every word of the heading and of both cells remains
    assert_int_equal( count_parts( text, "word" ), 32 + 3 * 60 );
    free( text );
    results_free( &all );
}

TEST( hashes_and_quantiles_are_left_to_formats_for_programs )
{
    results all = { 0 };
    const char* const header[] = { "size", "ms", "p10 .. p90", "hash" };
    const int table = results_add_table( &all, "A table", WISP_COUNT( header ), header );
    results_add_cells( &all, table, ( const char* const[] ){ "10", "1", "0 .. 2", "0123456789abcdef" } );
    char* text = text_of( &all.tables[table] );
    assert_non_null( strstr( text, "\nsize  ms\n--------\n  10   1\n" ) );
    free( text );
    results_free( &all );
}
