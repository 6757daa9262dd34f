// `wisp sweep` in shares that are stopped and gone on with, and `wisp merge` of files that were changed; what both say is in
// transcripts/sweep.t.
#include "program_fixture.h"

#include <signal.h>
#include <sys/resource.h>
#include <time.h>

static const char sheet[] = "wisp: 1\n"
                            "steps: 2\n"
                            "surfaces:\n"
                            "  - name: sheet\n"
                            "    generate: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }\n"
                            "    pins: [0, 2]\n"
                            "    cloth: { warp_compliance: 1e-3, bending: none }\n";

// 13 x 8 x 3 rows, of which some are run by two shards, and a row of its own.
static const char suite[] = "wisp_suite: 1\n"
                            "title: sheets\n"
                            "reference: { file: sheet.yaml, set: { substeps: 40 }, check: { substeps: 20 } }\n"
                            "scenes:\n"
                            "  - file: sheet.yaml\n"
                            "    vary:\n"
                            "      surfaces[0].damping: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n"
                            "      surfaces[0].area_density: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]\n"
                            "    along: { substeps: [1, 2, 4] }\n"
                            "    order: 1\n"
                            "  - { file: sheet.yaml, name: alone }\n";

enum
{
    ITEMS = 13 * 8 * 3 + 1,
};

static char* read_whole( const char* path )
{
    static char text[2][1 << 20];
    static int turn;
    char* out = text[turn++ % 2];
    FILE* file = fopen( path, "r" );
    assert_non_null( file );
    out[fread( out, 1, sizeof text[0] - 1, file )] = '\0';
    fclose( file );
    return out;
}

// Put another text in place of the first one in a file.
static void change( const char* path, const char* from, const char* to )
{
    char* text = read_whole( path );
    char* at = strstr( text, from );
    assert_non_null( at );
    FILE* file = fopen( path, "w" );
    fprintf( file, "%.*s%s%s", (int)( at - text ), text, to, at + strlen( from ) );
    fclose( file );
}

static void sweep( const char* folder, int shards )
{
    for ( int i = 1; i <= shards; ++i )
    {
        char command[200];
        snprintf( command, sizeof command, "sweep suite.yaml -o %s --shard %d/%d", folder, i, shards );
        run_ok( command );
    }
}

static void copy_folder( const char* from, const char* to )
{
    char command[200];
    snprintf( command, sizeof command, "rm -rf %s && cp -r %s %s", to, from, to );
    assert_int_equal( system( command ), 0 );
}

// A row of a sweep has the error that the same row of a benchmark has.
TEST( errors_are_those_of_the_benchmark )
{
    write_text( "few.yaml", "wisp_suite: 1\n"
                            "reference: { file: sheet.yaml, set: { substeps: 40 }, check: { substeps: 20 } }\n"
                            "scenes: [ { file: sheet.yaml, along: { substeps: [1, 8] } } ]\n" );
    run_ok( "sweep few.yaml -o few" );
    run_ok( "merge few -f csv" );
    const char* merged = strdup( result.out );
    run_ok( "bench few.yaml --seconds 0.1 -f csv" );
    for ( int i = 0; i < 2; ++i )
    {
        char row[40], hash[20] = "", cell[20];
        snprintf( row, sizeof row, "substeps=%d", i == 0 ? 1 : 8 );
        const char *mine = strstr( merged, row ), *other = strstr( result.out, row );
        assert_true( mine != NULL && other != NULL );
        // a hash is the one cell of sixteen hexadecimal digits
        for ( const char* at = mine; *at != '\n' && hash[0] == '\0'; ++at )
        {
            if ( strspn( at, "0123456789abcdef" ) == 16 )
            {
                snprintf( hash, sizeof hash, "%.16s", at );
            }
        }
        snprintf( cell, sizeof cell, "%s", hash );
        const char* end = strchr( other, '\n' );
        const char* found = strstr( other, cell );
        assert_true( hash[0] != '\0' && found != NULL && found < end );
    }
    free( (char*)merged );
}

// ---- what is stopped goes on ----

static int line_number( const char* path )
{
    return exists( path ) ? line_count( read_whole( path ) ) : 0;
}

TEST( what_is_killed_loses_only_the_item_that_ran )
{
    char line[] = "sweep suite.yaml -o killed", *arguments[ARGUMENTS_MAX + 1];
    split( line, arguments );
    const pid_t child = fork();
    if ( child == 0 )
    {
        const int nothing = open( "/dev/null", O_WRONLY );
        become_program( arguments, nothing, nothing );
    }
    const char* part = "killed/part-0001-of-0001.jsonl";
    for ( int i = 0; i < 2000 && line_number( part ) < 20; ++i )
    {
        nanosleep( &( struct timespec ){ .tv_nsec = 1000000 }, NULL );
    }
    kill( child, SIGKILL );
    assert_int_equal( wait_for( child ), -1 );
    const int before = line_number( part );
    assert_true( before >= 20 );
    char lacks[80];
    snprintf( lacks, sizeof lacks, "shard 1 of 1 has %d of its %d items", before, ITEMS );
    assert_refused( "merge killed", lacks );
    // a line that was not written whole
    FILE* file = fopen( part, "a" );
    fputs( "{\"item\":7,\"ke", file );
    fclose( file );
    run_ok( "sweep suite.yaml -o killed" );
    char told[80];
    snprintf( told, sizeof told, "%d of %d items, %d from before", ITEMS, ITEMS, before );
    assert_true( strstr( result.err, told ) != NULL );
    assert_int_equal( line_number( part ), ITEMS );
    run_ok( "merge killed -o killed.txt" );
    sweep( "whole", 1 );
    run_ok( "merge whole -o whole.txt" );
    assert_string_equal( read_whole( "killed.txt" ), read_whole( "whole.txt" ) );
    // what is done stays as it is
    run_ok( "sweep suite.yaml -o killed" );
    assert_true( strstr( result.err, "313 from before" ) != NULL );
    assert_int_equal( line_number( part ), ITEMS );
}

TEST( a_full_disk_keeps_what_fitted )
{
    struct rlimit old, small = { 20000, 20000 };
    assert_int_equal( getrlimit( RLIMIT_FSIZE, &old ), 0 );
    small.rlim_max = old.rlim_max;
    signal( SIGXFSZ, SIG_IGN );
    run_ok( "sweep suite.yaml -o warm" ); // the reference is in the cache then
    assert_int_equal( setrlimit( RLIMIT_FSIZE, &small ), 0 );
    run( "sweep suite.yaml -o full" );
    setrlimit( RLIMIT_FSIZE, &old );
    assert_int_equal( result.status, 2 );
    assert_true( strstr( result.err, "full/part-0001-of-0001.jsonl: cannot be written: " ) != NULL );
    assert_true( strstr( result.err, "the same command goes on" ) != NULL );
    assert_true( line_number( "full/part-0001-of-0001.jsonl" ) > 5 );
    assert_refused( "merge full", "shard 1 of 1 has " );
    run_ok( "sweep suite.yaml -o full" );
    run_ok( "merge full -o full.txt" );
    run_ok( "merge warm -o warm.txt" );
    assert_string_equal( read_whole( "full.txt" ), read_whole( "warm.txt" ) );
}

// ---- what is not merged ----

TEST( a_merge_refuses_what_is_not_one_sweep )
{
    sweep( "good", 3 );
    static const struct
    {
        const char *from, *to, *named;
    } wrong[] = {
        { "\"version\":\"0", "\"version\":\"9", "jsonl:1: is of another version of Wisp than " },
        { "\"sweep\":\"", "\"sweep\":\"0000000000000000\",\"x\":\"", "jsonl:1: is of another suite than " },
        { "\"shards\":3", "\"shards\":4", "jsonl:1: is of another number of shards than " },
        { "\"reference\":", "\"reference\":\"x\",\"y\":", "jsonl:1: is of another reference than " },
        { "\"item\":", "\"idem\":", "jsonl:1: expected a row" },
        { "{\"item\":", "{\"item\":9999", "jsonl:1: expected a row" },
        { "{", "[", "jsonl:1: expected a row" },
    };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        copy_folder( "good", "bad" );
        change( "bad/part-0002-of-0003.jsonl", wrong[i].from, wrong[i].to );
        assert_refused( "merge bad", wrong[i].named );
    }
    copy_folder( "good", "bad" );
    assert_int_equal( remove( "bad/part-0003-of-0003.jsonl" ), 0 );
    assert_refused( "merge bad", "shard 3 of 3 is not there" );
    assert_int_equal( remove( "bad/part-0001-of-0003.jsonl" ), 0 );
    assert_refused( "merge bad", "shard 1 of 3 is not there, and 1 more" );
    // one file of all lines is as good as a file for each share
    copy_folder( "good", "bad" );
    assert_int_equal( system( "cat bad/*.jsonl >all && rm bad/*.jsonl && mv all bad/all.jsonl" ), 0 );
    run_ok( "merge bad -o bad.txt" );
    run_ok( "merge good -o good.txt" );
    assert_string_equal( read_whole( "bad.txt" ), read_whole( "good.txt" ) );
    assert_int_equal( mkdir( "empty", 0777 ), 0 );
    assert_refused( "merge empty", "has no part of a sweep" );
}

// Remove the line that begins at a place.
static void remove_line( const char* path, int number )
{
    char* text = read_whole( path );
    char* begin = text;
    for ( int i = 0; i < number; ++i )
    {
        begin = strchr( begin, '\n' ) + 1;
    }
    const char* end = strchr( begin, '\n' ) + 1;
    FILE* file = fopen( path, "w" );
    fprintf( file, "%.*s%s", (int)( begin - text ), text, end );
    fclose( file );
}

// The number of an item that two parts have, and its line in one of them.
static int find_run_twice( const char* one, const char* other, int* line )
{
    char* a = read_whole( one );
    const char* b = read_whole( other );
    *line = 0;
    for ( char* at = strtok( a, "\n" ); at != NULL; at = strtok( NULL, "\n" ), ++*line )
    {
        int item;
        char begin[40];
        if ( sscanf( at, "{\"item\":%d,", &item ) == 1 )
        {
            snprintf( begin, sizeof begin, "{\"item\":%d,", item );
            if ( strstr( b, begin ) != NULL )
            {
                return item;
            }
        }
    }
    fail_msg( "%s and %s have no item together", one, other );
    return -1;
}

TEST( items_that_are_missing_or_have_two_hashes_are_refused )
{
    sweep( "pair", 2 );
    int line;
    const int item = find_run_twice( "pair/part-0001-of-0002.jsonl", "pair/part-0002-of-0002.jsonl", &line );
    run_ok( "merge pair" );
    assert_true( strstr( result.err, "run by two shards, with the same bits" ) != NULL );
    for ( int i = 0; i < 2; ++i )
    {
        copy_folder( "pair", "bad" );
        remove_line( "bad/part-0001-of-0002.jsonl", i == 0 ? line : line == 0 ? 1 : 0 );
        assert_refused( "merge bad", "shard 1 of 2 has " );
    }
    copy_folder( "pair", "bad" );
    char from[64], named[64];
    const char* text = read_whole( "bad/part-0001-of-0002.jsonl" );
    snprintf( from, sizeof from, "{\"item\":%d,", item );
    const char* hash = strstr( strstr( text, from ), "\"hash\":\"" );
    snprintf( from, sizeof from, "%.24s", hash );
    snprintf( named, sizeof named, "item %d (", item );
    change( "bad/part-0001-of-0002.jsonl", from, "\"hash\":\"0123456789abcdef" );
    assert_refused( "merge bad", named );
    assert_true( strstr( result.err, "has other bits than the run by shard 1" ) != NULL );
    // what was wrong in one of two runs is wrong, and what could not be run in one of them is not
    copy_folder( "pair", "bad" );
    snprintf( from, sizeof from, "{\"item\":%d,", item );
    snprintf( named, sizeof named, "{\"failure\":\"other bits\",\"item\":%d,", item );
    change( "bad/part-0002-of-0002.jsonl", from, named );
    run( "merge bad" );
    assert_int_equal( result.status, 1 );
    assert_non_null( strstr( result.out, "other bits" ) );
}

// ---- times ----

TEST( times_come_from_exclusive_runs_and_processors_are_not_mixed )
{
    write_text( "few.yaml", "wisp_suite: 1\n"
                            "scenes: [ { file: sheet.yaml, along: { substeps: [1, 2, 3, 4, 5, 6] } } ]\n" );
    run_ok( "sweep few.yaml -o timed" );
    run_ok( "merge timed" );
    assert_null( strstr( result.out, "1 worker" ) );
    // what was not timed is run again, once
    run_ok( "sweep few.yaml -o timed --exclusive --workers 2" );
    assert_contains( result.err, "6 of 6 items\n" );
    run_ok( "sweep few.yaml -o timed --exclusive --workers 2" );
    assert_contains( result.err, "6 of 6 items, 6 from before" );
    assert_refused( "sweep few.yaml -o timed --exclusive --workers 3",
                    "jsonl:7: is of another number of workers than" );
    run_ok( "merge timed -f markdown" );
    assert_contains( result.out, "ms, 1 worker" );
    assert_contains( result.out, "ms, 2 workers" );
    assert_null( strstr( result.out, "processor" ) );
    run_ok( "merge timed -f csv" );
    assert_int_equal( line_count( result.out ), 1 + 6 * 2 ); // a row for each number of workers
    change( "timed/part-0001-of-0001.jsonl", "\"ms\":", "\"isa\":\"another\",\"ms\":" );
    char* text = read_whole( "timed/part-0001-of-0001.jsonl" );
    char* second = strstr( strstr( text, "\"isa\":\"another\"" ) + 10, "\"isa\":" );
    assert_non_null( second );
    memcpy( second, "\"ISA\"", 5 );
    write_text( "timed/part-0001-of-0001.jsonl", text );
    run_ok( "merge timed" );
    assert_contains( result.out, "processor" );
    assert_contains( result.out, ", another" );
    run_ok( "merge timed -f csv" );
    assert_int_equal( line_count( result.out ), 1 + 6 ); // rows have no times then
}

static int enter_folder( void** state )
{
    static const text_file files[] = { { "sheet.yaml", sheet }, { "suite.yaml", suite } };
    setenv( "WISP_CACHE", "cache", 1 );
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
