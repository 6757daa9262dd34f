// Every format of the results is read back: a reader must find the measured values. What `wisp compare` says of two files,
// of which one is the other with known changes.
#include "unit.h"

#include "results.h"
#include "results_read.h"

#include <jansson.h>
#include <unistd.h>

// ---- results with every difficulty of a format ----

static void fill( results* all )
{
    *all = ( results ){ .machine = machine_describe( "avx2" ) };
    results_row* row = results_add_row( all, "paper", "source" );
    results_put( &row->size, "strands", 100 );
    row->ms_median = 6.8;

    row = results_add_row( all, "comma, \"quote\"", "wisp" );
    results_put( &row->size, "strands", 500 );
    results_put( &row->size, "bytes_a_vertex", 566.25 );
    row->workers = 2;
    double samples[] = { 0.75, 0.5, 1.25, 0.625, 1.0 };
    stats_summary times = stats_summarise( samples, 5 );
    times.cpu_fraction = 2.0;
    results_put_times( row, &times );
    results_put( &row->stages, "frozen_hair.freeze", 0.25 );
    results_put( &row->stages, "frozen_hair.clump", 0.5 );
    snprintf( row->error_reference, sizeof( row->error_reference ), "oracle" );
    results_put( &row->error, "max_m", 1.5e-7 );
    row->hash = 0xfedcba9876543210u;
    row->has_hash = true;

    int table = results_add_table( all, "A title", 3, ( const char* const[] ){ "who", "ms", "note" } );
    results_add_cells( all, table, ( const char* const[] ){ "wisp", "0.75", "a|b" } );
    results_add_cells( all, table, ( const char* const[] ){ "a longer name", "-", "" } );
    results_add_note( all, "%d notes", 1 );
}

/// A format as text, to be freed.
static char* written( const results* all, results_format format )
{
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    wisp_error error = { 0 };
    assert_non_null( stream );
    assert_int_equal( results_write( all, format, stream, &error ), WISP_OK );
    fclose( stream );
    return text;
}

static char* written_example( results_format format )
{
    SCOPED( results_free ) results all;
    fill( &all );
    char* text = written( &all, format );
    return text;
}

static json_t* parsed( results_format format )
{
    SCOPED( free_local ) char* text = written_example( format );
    json_error_t error;
    json_t* root = json_loads( text, JSON_REJECT_DUPLICATES, &error );
    assert_non_null( root );
    return root;
}

// ---- JSON ----

TEST( json_has_the_keys_of_its_schema )
{
    json_t* root = parsed( RESULTS_JSON );
    assert_int_equal( json_integer_value( json_object_get( root, "wisp_results" ) ), 2 );
    static const char* const machine[] = { "cpu", "cores", "memory_bytes", "os", "isa", "cpu_flags" };
    static const char* const build[] = { "version", "commit", "compiler", "flags", "type" };
    static const char* const row_keys[] = { "case",   "variant", "size",       "workers",     "ms_median",
                                            "ms_p10", "ms_p90",  "fps",        "steps",       "stages",
                                            "error",  "hash",    "samples_ms", "cpu_fraction" };
    for ( int i = 0; i < WISP_COUNT( machine ); ++i )
    {
        assert_non_null( json_object_get( json_object_get( root, "machine" ), machine[i] ) );
    }
    for ( int i = 0; i < WISP_COUNT( build ); ++i )
    {
        assert_non_null( json_object_get( json_object_get( root, "build" ), build[i] ) );
    }
    json_t* rows = json_object_get( root, "rows" );
    assert_int_equal( json_array_size( rows ), 2 );
    for ( size_t r = 0; r < 2; ++r )
    {
        json_t* row = json_array_get( rows, r );
        assert_int_equal( json_object_size( row ), WISP_COUNT( row_keys ) );
        for ( int i = 0; i < WISP_COUNT( row_keys ); ++i )
        {
            assert_non_null( json_object_get( row, row_keys[i] ) );
        }
    }
    json_decref( root );
}

TEST( a_list_of_numbers_is_one_line_of_json )
{
    SCOPED( results_free ) results all;
    fill( &all );
    results_add_note( &all, "a \"quoted [1,2]\" note" );
    SCOPED( free_local ) char* text = written( &all, RESULTS_JSON );
    assert_contains( text, "\"samples_ms\": [0.75, 0.5, 1.25, 0.625, 1.0],\n" );
    assert_contains( text, "\"a \\\"quoted [1,2]\\\" note\"\n" );
}

TEST( json_keeps_every_number_of_a_row )
{
    json_t* root = parsed( RESULTS_JSON );
    json_t* row = json_array_get( json_object_get( root, "rows" ), 1 );
    assert_string_equal( json_string_value( json_object_get( row, "case" ) ), "comma, \"quote\"" );
    assert_true( json_number_value( json_object_get( row, "ms_median" ) ) == 0.75 );
    assert_int_equal( json_integer_value( json_object_get( row, "workers" ) ), 2 );
    assert_int_equal( json_integer_value( json_object_get( row, "steps" ) ), 5 );
    json_t* samples = json_object_get( row, "samples_ms" );
    assert_int_equal( json_array_size( samples ), 5 );
    assert_true( json_number_value( json_array_get( samples, 2 ) ) == 1.25 ); // in the order of measurement
    assert_true( json_number_value( json_object_get( row, "cpu_fraction" ) ) == 2.0 );
    assert_true( json_number_value( json_object_get( json_object_get( row, "size" ), "bytes_a_vertex" ) ) == 566.25 );
    assert_true( json_number_value( json_object_get( json_object_get( row, "stages" ), "frozen_hair.clump" ) ) ==
                 0.5 );
    json_t* error = json_object_get( row, "error" );
    assert_true( json_number_value( json_object_get( error, "max_m" ) ) == 1.5e-7 );
    assert_string_equal( json_string_value( json_object_get( error, "against" ) ), "oracle" );
    // a hash has a bit more than a JSON integer
    assert_string_equal( json_string_value( json_object_get( row, "hash" ) ), "fedcba9876543210" );
    json_decref( root );
}

TEST( json_says_null_where_nothing_is_known )
{
    json_t* root = parsed( RESULTS_JSON );
    json_t* row = json_array_get( json_object_get( root, "rows" ), 0 );
    assert_true( json_is_null( json_object_get( row, "ms_p10" ) ) );
    assert_true( json_is_null( json_object_get( row, "error" ) ) );
    assert_true( json_is_null( json_object_get( row, "hash" ) ) );
    json_decref( root );
}

TEST( text_that_is_not_utf8_does_not_break_json )
{
    SCOPED( results_free ) results all = { 0 };
    results_add_row( &all, "\xff\xfe", "run" );
    all.machine = machine_describe( "baseline" );
    SCOPED( free_local ) char* text = written( &all, RESULTS_JSON );
    json_t* root = json_loads( text, 0, NULL );
    assert_non_null( root );
    json_decref( root );
}

// ---- CSV ----

#define CSV_COLUMNS 32

/// Split one line of RFC 4180 in place. @return the number of fields
static int split_csv( char* line, char* fields[CSV_COLUMNS] )
{
    int count = 0;
    for ( char* at = line; at && count < CSV_COLUMNS; )
    {
        char* to = at;
        fields[count++] = to;
        bool quoted = *at == '"';
        at += quoted;
        while ( *at && ( quoted || *at != ',' ) )
        {
            if ( quoted && at[0] == '"' && at[1] != '"' )
            {
                quoted = false;
                ++at;
                continue;
            }
            at += quoted && at[0] == '"';
            *to++ = *at++;
        }
        bool more = *at == ',';
        *to = '\0';
        at = more ? at + 1 : NULL;
    }
    return count;
}

static const char* csv_field( char* header[CSV_COLUMNS], char* row[CSV_COLUMNS], int count, const char* name )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( header[i], name ) == 0 )
        {
            return row[i];
        }
    }
    fail_msg( "no column %s", name );
    return "";
}

TEST( csv_has_one_line_a_row_and_the_same_columns_in_each )
{
    SCOPED( free_local ) char* text = written_example( RESULTS_CSV );
    char *lines[4] = { NULL }, *header[CSV_COLUMNS], *source[CSV_COLUMNS], *wisp[CSV_COLUMNS];
    int line_count = 0;
    for ( char* line = text; *line && line_count < 4; ++line_count )
    {
        char* end = strstr( line, "\r\n" );
        assert_non_null( end );
        *end = '\0';
        lines[line_count] = line;
        line = end + 2;
    }
    assert_int_equal( line_count, 3 );
    int columns = split_csv( lines[0], header );
    assert_int_equal( split_csv( lines[1], source ), columns );
    assert_int_equal( split_csv( lines[2], wisp ), columns );

    assert_string_equal( csv_field( header, wisp, columns, "case" ), "comma, \"quote\"" );
    assert_string_equal( csv_field( header, wisp, columns, "variant" ), "wisp" );
    assert_string_equal( csv_field( header, wisp, columns, "hash" ), "fedcba9876543210" );
    assert_true( fabs( strtod( csv_field( header, wisp, columns, "ms_p90" ), NULL ) - 1.15 ) < 1e-9 );
    assert_true( strtod( csv_field( header, wisp, columns, "size.bytes_a_vertex" ), NULL ) == 566.25 );
    assert_true( strtod( csv_field( header, wisp, columns, "stages.frozen_hair.clump" ), NULL ) == 0.5 );
    assert_true( strtod( csv_field( header, wisp, columns, "error.max_m" ), NULL ) == 1.5e-7 );
    // what a row does not have is an empty field
    assert_string_equal( csv_field( header, source, columns, "ms_p10" ), "" );
    assert_string_equal( csv_field( header, source, columns, "size.bytes_a_vertex" ), "" );
    assert_true( strtod( csv_field( header, source, columns, "ms_median" ), NULL ) == 6.8 );
}

// ---- text and Markdown ----

TEST( text_aligns_numbers_to_the_right_and_names_to_the_left )
{
    SCOPED( free_local ) char* text = written_example( RESULTS_TEXT );
    assert_non_null( strstr( text, "\nwho              ms  note\n" ) );
    assert_non_null( strstr( text, "\nwisp           0.75  a|b\n" ) );
    assert_non_null( strstr( text, "\na longer name     -\n" ) );
    assert_non_null( strstr( text, "\n1 notes\n" ) );
    assert_null( strchr( text, '\033' ) );
}

TEST( markdown_escapes_the_bar_that_would_end_a_cell )
{
    SCOPED( free_local ) char* text = written_example( RESULTS_MARKDOWN );
    assert_non_null( strstr( text, "\n| who | ms | note |\n|---|---:|---|\n" ) );
    assert_non_null( strstr( text, "| wisp | 0.75 | a\\|b |\n" ) );
    assert_non_null( strstr( text, "\n- 1 notes\n" ) );
}

// ---- failures ----

TEST( a_failure_marks_the_results_and_says_so )
{
    SCOPED( results_free ) results all = { 0 };
    assert_false( all.failed );
    results_add_failure( &all, "hash %d", 3 );
    assert_true( all.failed );
    assert_string_equal( all.notes[0], "FAILED: hash 3" );
}

TEST( a_full_disk_is_an_error_in_every_format )
{
    if ( access( "/dev/full", W_OK ) != 0 )
    {
        SKIP( "there is no /dev/full" );
    }
    SCOPED( results_free ) results all;
    fill( &all );
    for ( int format = 0; format < RESULTS_FORMAT_COUNT; ++format )
    {
        wisp_error error = { 0 };
        assert_int_equal( results_write_file( &all, (results_format)format, "/dev/full", &error ), WISP_IO_ERROR );
        assert_true( strlen( error.message ) > 0 );
    }
}

TEST( a_folder_that_is_not_there_is_an_error_that_names_the_file )
{
    results all = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( results_write_file( &all, RESULTS_TEXT, "no such folder/out.txt", &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "no such folder/out.txt" ) );
}

// ---- reading our own JSON ----

/// info_results() on a text. @return its status
static wisp_status info_on( const char* text, wisp_error* error )
{
    char path[] = "test_results_XXXXXX";
    int file = mkstemp( path );
    assert_true( file >= 0 );
    assert_int_equal( write( file, text, strlen( text ) ), (ssize_t)strlen( text ) );
    close( file );
    FILE* nowhere = fopen( "/dev/null", "w" );
    assert_non_null( nowhere );
    wisp_status status = info_results( path, nowhere, error );
    fclose( nowhere );
    remove( path );
    return status;
}

TEST( info_accepts_what_the_writer_writes )
{
    SCOPED( free_local ) char* text = written_example( RESULTS_JSON );
    wisp_error error = { 0 };
    assert_true( info_is_results( text, strlen( text ) ) );
    assert_int_equal( info_on( text, &error ), WISP_OK );
}

TEST( info_names_what_is_wrong_with_a_result )
{
#define HEAD "{\"wisp_results\":1,\"machine\":{},\"build\":{},\"rows\":["
#define ROW( median, workers, hash )                                                                                 \
    "{\"case\":\"a\",\"variant\":\"b\",\"size\":{},\"workers\":" workers ",\"ms_median\":" median                    \
    ",\"ms_p10\":null,\"ms_p90\":null,\"fps\":null,\"steps\":1,\"stages\":{},\"error\":null,\"hash\":" hash "}"
    static const struct
    {
        const char *text, *named;
    } wrong[] = {
        { "", "1:0" },
        { "{\"wisp_results\":1,", "1:1" },
        { "[]", "wisp_results" },
        { "{\"wisp_results\":3,\"machine\":{},\"build\":{},\"rows\":[]}", "wisp_results" },
        { "{\"wisp_results\":1,\"build\":{},\"rows\":[]}", "machine" },
        { "{\"wisp_results\":1,\"machine\":{},\"build\":{}}", "rows" },
        { HEAD "3]}", "rows[0]" },
        { HEAD "{}]}", "rows[0].case" },
        { HEAD ROW( "\"fast\"", "1", "null" ) "]}", "rows[0].ms_median" },
        { HEAD ROW( "-1", "1", "null" ) "]}", "rows[0].ms_median" },
        { HEAD ROW( "1", "1", "null" ) "," ROW( "1", "1.5", "null" ) "]}", "rows[1].workers" },
        { HEAD ROW( "1", "1", "\"xyz\"" ) "]}", "rows[0].hash" },
        { HEAD ROW( "1", "1", "null,\"samples_ms\":[1,-1]" ) "]}", "rows[0].samples_ms" },
        { HEAD ROW( "1", "1", "null" ) "],\"rows\":[]}", "duplicate" },
    };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        wisp_error error = { 0 };
        assert_int_equal( info_on( wrong[i].text, &error ), WISP_BAD_INPUT );
        assert_non_null( strstr( error.message, wrong[i].named ) );
    }
    wisp_error error = { 0 };
    assert_int_equal( info_on( HEAD ROW( "1", "1", "null" ) "]}", &error ), WISP_OK );
}

// ---- comparison of two files ----

#define SAMPLES 40

// A file of one timed row with errors and a row without samples. @param factor of times @param error_m of the error
static void write_file( char* path, double factor, double error_m, uint64_t hash, const char* cpu )
{
    SCOPED( results_free ) results all = { .machine = machine_describe( "avx2" ) };
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
    SCOPED( results_free ) results out;
    compare( 1.0, 0.01, 1, "A", 0.25, &out );
    assert_true( number( &out, 0, "is_slower" ) == 0.0 && number( &out, 0, "is_faster" ) == 0.0 );
    assert_true( number( &out, 0, "bits_differ" ) == 0.0 );
    assert_int_equal( out.table_count, 1 ); // no number differs
}

TEST( a_time_counts_if_it_is_large_and_certain )
{
    SCOPED( results_free ) results out;
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
}

TEST( times_of_another_processor_are_not_judged )
{
    SCOPED( results_free ) results out;
    compare( 3.0, 0.01, 1, "B", 0.25, &out );
    assert_true( number( &out, 0, "is_slower" ) == 0.0 && number( &out, 0, "ratio" ) > 2.9 );
    assert_non_null( strstr( out.notes[0], "not judged" ) );
}

TEST( errors_and_bits_are_compared_as_they_stand )
{
    SCOPED( results_free ) results out;
    compare( 1.0, 0.0102, 2, "A", 0.25, &out );
    assert_true( number( &out, 0, "bits_differ" ) == 1.0 );
    assert_int_equal( out.table_count, 2 );
    assert_string_equal( results_cell( &out.tables[1], 1, 1 ), "error.rms_m" );
    assert_string_equal( results_cell( &out.tables[1], 1, 4 ), "+2.00 %" );
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
