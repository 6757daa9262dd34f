// "-" as a file: standard input where the program reads, standard output where it writes.
#include "program_fixture.h"

#include <jansson.h>

static const char small_scene[] = "wisp: 1\n"
                                  "steps: 3\n"
                                  "surfaces:\n"
                                  "  - name: flag\n"
                                  "    file: square.obj\n"
                                  "    pins: [0]\n"
                                  "    cloth: {}\n";
static const char square[] = "# two triangles\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "flag.yaml", small_scene },
                                       { "square.obj", square },
                                       { "wrong.yaml", "wisp: 1\nstepz: 3\n" } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

/// Run the program with a file as its standard input, through a pipe that cannot be rewound.
static void run_with_input( const char* file, const char* command )
{
    size_t size;
    char* bytes = read_bytes( file, &size );
    int ends[2];
    assert_int_equal( pipe( ends ), 0 );
    const pid_t writer = fork();
    if ( writer == 0 )
    {
        close( ends[0] );
        for ( size_t done = 0; done < size; )
        {
            const ssize_t count = write( ends[1], bytes + done, size - done );
            if ( count <= 0 )
            {
                _exit( 1 );
            }
            done += (size_t)count;
        }
        _exit( 0 );
    }
    close( ends[1] );
    const int before = dup( STDIN_FILENO );
    dup2( ends[0], STDIN_FILENO );
    close( ends[0] );
    run( command );
    dup2( before, STDIN_FILENO );
    close( before );
    waitpid( writer, NULL, 0 );
    free( bytes );
}

static void assert_reads( const char* file, const char* command, const char* expected )
{
    run_with_input( file, command );
    if ( result.status != 0 || !strstr( result.out, expected ) )
    {
        fail_msg( "'%s' < %s ended with %d and said: %s%s", command, file, result.status, result.out, result.err );
    }
}

TEST( a_scene_comes_from_standard_input_with_files_of_the_current_folder )
{
    assert_reads( "flag.yaml", "run -", "scene        standard input\nsteps        3 of " );
    assert_reads( "flag.yaml", "plan -", " passes in " );
    assert_reads( "flag.yaml", "info -", "standard input: scene, " );
}

TEST( every_kind_of_file_is_told_by_its_first_bytes )
{
    run_ok( "run flag.yaml --record flag.wisp --format json --output result.json" );
    run_ok( "run flag.yaml --record flag.pc2 -o summary.txt" );
    assert_reads( "square.obj", "info -", "standard input: open mesh" );
    assert_reads( "flag.wisp", "info -", "standard input: recording of 4 frames" );
    assert_reads( "flag.pc2", "info -", "standard input: point cache" );
    assert_reads( "result.json", "info -", "standard input: results, 1 rows" );
    assert_reads( "result.json", "compare result.json -", "rows: 1; " );
}

TEST( an_error_in_standard_input_has_its_line )
{
    run_with_input( "wrong.yaml", "run -" );
    assert_int_equal( result.status, 2 );
    assert_non_null( strstr( result.err, "wisp: standard input:2:1: unknown key 'stepz', did you mean 'steps'?" ) );
    write_text( "nothing", "" );
    run_with_input( "nothing", "run -" );
    assert_int_equal( result.status, 2 );
    assert_non_null( strstr( result.err, "wisp: standard input: got an empty file" ) );
}

// The cap of the reader holds, not the room on the disk.
TEST( standard_input_without_an_end_is_refused )
{
    const int before = dup( STDIN_FILENO ), zeros = open( "/dev/zero", O_RDONLY );
    assert_true( zeros >= 0 );
    dup2( zeros, STDIN_FILENO );
    close( zeros );
    run( "run -" );
    const bool is_refused = result.status == 2 && strstr( result.err, "wisp: standard input: expected at most " );
    run( "info -" );
    dup2( before, STDIN_FILENO );
    close( before );
    assert_true( is_refused );
    assert_int_equal( result.status, 2 );
    assert_non_null( strstr( result.err, "wisp: standard input: unknown kind of file" ) );
}

TEST( a_picture_goes_to_standard_output_and_its_line_to_the_error_stream )
{
    run_ok( "render square.obj -o - --size 32x24" );
    assert_memory_equal( result.out, "\x89PNG\r\n\x1a\n", 8 );
    assert_non_null( strstr( result.err, "-: 32 x 24 pixels, " ) );
    assert_usage( "render flag.yaml -o - --frames 0:", "expected a file name for several pictures" );
}

TEST( a_tuned_scene_goes_to_standard_output_and_the_report_to_the_error_stream )
{
    run_with_input( "flag.yaml", "tune - --error 1 -o -" );
    assert_int_equal( result.status, 0 );
    assert_memory_equal( result.out, "wisp: 1\n", 8 );
    assert_non_null( strstr( result.err, "target" ) );
}

TEST( results_go_to_standard_output )
{
    run_ok( "run flag.yaml -o - --format json" );
    json_t* root = json_loads( result.out, JSON_REJECT_DUPLICATES, NULL );
    assert_non_null( root );
    json_decref( root );
}

TEST( a_second_file_for_standard_output_is_wrong_usage )
{
    assert_usage( "run flag.yaml --record -", "--record: got '-', expected a file: standard output has the results" );
    assert_usage( "gate check suite.yaml --html -", "--html: got '-', expected a file" );
    assert_usage( "gate check -", "suite: got '-', expected a file: other processes read it too" );
    assert_usage( "bench cloth --report -", "--report and --output both write to '-'" );
    assert_usage( "accuracy flag.yaml --report - --output -", "--report and --output both write to '-'" );
}

// A terminal shows a mess, and may take it for commands.
TEST( a_picture_is_not_written_to_a_terminal )
{
    int near_end, far_end;
    if ( openpty( &near_end, &far_end, NULL, NULL, NULL ) != 0 )
    {
        SKIP( "there are no terminals here" );
    }
    FILE* err = tmpfile();
    const pid_t child = fork();
    if ( child == 0 )
    {
        char* arguments[] = { program, "render", "square.obj", "-o", "-", NULL };
        become_program( arguments, far_end, fileno( err ) );
    }
    result.status = wait_for( child );
    read_back( err, result.err );
    close( near_end );
    close( far_end );
    assert_int_equal( result.status, 64 );
    assert_non_null( strstr( result.err, "standard output is a terminal" ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
