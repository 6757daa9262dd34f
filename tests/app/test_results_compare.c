// What `wisp compare` says of two files, of which one is the other with known changes.
#include "unit.h"

#include "results_read.h"

#include <stdlib.h>
#include <unistd.h>

#define SAMPLES 40

// A file of one timed row with errors and a row without samples. @param factor of times @param error_m of the error
static void write_file( char* path, double factor, double error_m, uint64_t hash, const char* cpu )
{
    results all = { .machine = machine_describe( "avx2" ) };
    snprintf( all.machine.cpu, sizeof all.machine.cpu, "%s", cpu );
    results_row* row = results_add_row( &all, "flag", "run" );
    double samples[SAMPLES];
    for ( int i = 0; i < SAMPLES; ++i )
    {
        samples[i] = factor * ( 1.0 + 0.01 * ( i * 7 % 13 ) );
    }
    const stats_summary times = stats_summarise( samples, SAMPLES );
    results_put_times( row, &times );
    results_put( &row->size, "vertices", 100 );
    snprintf( row->error_reference, sizeof row->error_reference, "truth" );
    results_put( &row->error, "rms_m", error_m );
    row->hash = hash;
    row->has_hash = true;
    row = results_add_row( &all, "flag", "source" );
    row->ms_median = 5.0 * factor;
    row->steps = 1;
    const int file = mkstemp( path );
    assert_true( file >= 0 );
    close( file );
    assert_int_equal( results_write_file( &all, RESULTS_JSON, path, NULL ), WISP_OK );
    results_free( &all );
}

static void compare( double factor, double error_m, uint64_t hash, const char* cpu, double least, results* out )
{
    char before[] = "compare_before_XXXXXX", after[] = "compare_after_XXXXXX";
    write_file( before, 1.0, 0.01, 1, "A" );
    write_file( after, factor, error_m, hash, cpu );
    wisp_error error = { 0 };
    *out = ( results ){ 0 };
    assert_int_equal( results_compare( before, after, least, out, &error ), WISP_OK );
    assert_int_equal( out->row_count, 2 );
    remove( before );
    remove( after );
}

static double number( const results* out, int row, const char* name )
{
    const results_values* size = &out->rows[row].size;
    for ( int i = 0; i < size->count; ++i )
    {
        if ( strcmp( size->items[i].name, name ) == 0 )
        {
            return size->items[i].value;
        }
    }
    return NAN;
}

TEST( equal_files_have_no_difference )
{
    results out;
    compare( 1.0, 0.01, 1, "A", 0.25, &out );
    assert_true( number( &out, 0, "is_slower" ) == 0.0 && number( &out, 0, "is_faster" ) == 0.0 );
    assert_true( number( &out, 0, "bits_differ" ) == 0.0 );
    assert_int_equal( out.table_count, 1 ); // no number differs
    results_free( &out );
}

TEST( a_time_counts_if_it_is_large_and_certain )
{
    results out;
    compare( 1.5, 0.01, 1, "A", 0.25, &out );
    assert_true( number( &out, 0, "is_slower" ) == 1.0 && number( &out, 0, "p" ) < 0.01 );
    assert_true( number( &out, 1, "is_slower" ) == 1.0 ); // by its median alone
    results_free( &out );
    compare( 0.5, 0.01, 1, "A", 0.25, &out );
    assert_true( number( &out, 0, "is_faster" ) == 1.0 );
    results_free( &out );
    compare( 1.1, 0.01, 1, "A", 0.25, &out ); // certain and too small
    assert_true( number( &out, 0, "is_slower" ) == 0.0 && number( &out, 0, "p" ) < 0.01 );
    results_free( &out );
    compare( 1.002, 0.01, 1, "A", 0.001, &out ); // large enough and not certain
    assert_true( number( &out, 0, "is_slower" ) == 0.0 );
    results_free( &out );
}

TEST( times_of_another_processor_are_not_judged )
{
    results out;
    compare( 3.0, 0.01, 1, "B", 0.25, &out );
    assert_true( number( &out, 0, "is_slower" ) == 0.0 && number( &out, 0, "ratio" ) > 2.9 );
    assert_non_null( strstr( out.notes[0], "not judged" ) );
    results_free( &out );
}

TEST( errors_and_bits_are_compared_as_they_stand )
{
    results out;
    compare( 1.0, 0.0102, 2, "A", 0.25, &out );
    assert_true( number( &out, 0, "bits_differ" ) == 1.0 );
    assert_int_equal( out.table_count, 2 );
    assert_string_equal( results_cell( &out.tables[1], 1, 1 ), "error.rms_m" );
    assert_string_equal( results_cell( &out.tables[1], 1, 4 ), "+2.00 %" );
    results_free( &out );
}

TEST( a_file_that_is_none_is_named )
{
    char path[] = "compare_before_XXXXXX";
    write_file( path, 1.0, 0.01, 1, "A" );
    results out = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( results_compare( path, "no_such.json", 0.25, &out, &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "no_such.json" ) );
    results_free( &out );
    remove( path );
}
