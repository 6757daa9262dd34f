// Signals that end the built program: what was done until then is in whole files, nothing else is left behind, and no
// process goes on.
#include "program_fixture.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/prctl.h>
#include <time.h>

#define SECONDS_MAX 30

static const char endless_scene[] = "wisp: 1\n"
                                    "steps: 1000000\n"
                                    "surfaces:\n"
                                    "  - name: flag\n"
                                    "    generate: { shape: plane, columns: 17, rows: 17, spacing: 0.05 }\n"
                                    "    pins: [0, 16]\n"
                                    "    cloth: {}\n"
                                    "output:\n"
                                    "  - { surface: flag, file: end.obj }\n";
static const char viewer[] = "<script type=\"application/json\" id=\"wisp-data\">null</script>";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "endless.yaml", endless_scene }, { "viewer.html", viewer } };
    signal( SIGINT, SIG_DFL );          // a shell ignores it for what it starts in the background
    prctl( PR_SET_CHILD_SUBREAPER, 1 ); // children of a program that has ended come to us
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

// ---- a run that is ended ----

static void pause_ms( long ms )
{
    nanosleep( &( struct timespec ){ .tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000 }, NULL );
}

typedef struct started
{
    pid_t pid;
    FILE *out, *err;
} started;

static started start( const char* command )
{
    char line[1024], *arguments[ARGUMENTS_MAX + 1];
    snprintf( line, sizeof( line ), "%s", command );
    split( line, arguments );
    started s = { .out = tmpfile(), .err = tmpfile() };
    assert_true( s.out && s.err );
    s.pid = fork();
    if ( s.pid == 0 )
    {
        become_program( arguments, fileno( s.out ), fileno( s.err ) );
    }
    return s;
}

/// Wait for the end. @return the signal that ended it, or 0
static int finish( const started* s )
{
    int status = 0;
    double waited = 0.0;
    while ( waitpid( s->pid, &status, WNOHANG ) == 0 )
    {
        pause_ms( 10 );
        waited += 0.01;
        if ( waited > SECONDS_MAX )
        {
            kill( s->pid, SIGKILL );
            fail_msg( "the program did not end" );
        }
    }
    read_back( s->out, result.out );
    read_back( s->err, result.err );
    result.status = WIFEXITED( status ) ? WEXITSTATUS( status ) : -1;
    return WIFSIGNALED( status ) ? WTERMSIG( status ) : 0;
}

static void wait_for_file( const char* path, long size )
{
    struct stat info;
    for ( int i = 0; i < 100 * SECONDS_MAX; ++i )
    {
        if ( stat( path, &info ) == 0 && info.st_size >= size )
        {
            return;
        }
        pause_ms( 10 );
    }
    fail_msg( "%s: was not written", path );
}

static void assert_ended_with( int status )
{
    if ( result.status != status )
    {
        fail_msg( "ended with %d, expected %d, and said: %s%s", result.status, status, result.out, result.err );
    }
}

// Hidden files are those that the program writes until they are whole.
static void assert_nothing_is_hidden( void )
{
    DIR* folder = opendir( "." );
    assert_non_null( folder );
    for ( struct dirent* entry = readdir( folder ); entry; entry = readdir( folder ) )
    {
        if ( entry->d_name[0] == '.' && strcmp( entry->d_name, "." ) != 0 && strcmp( entry->d_name, ".." ) != 0 )
        {
            fail_msg( "%s was left behind", entry->d_name );
        }
    }
    closedir( folder );
}

static void assert_no_process_is_left( void )
{
    pause_ms( 100 );
    int status;
    pid_t orphan;
    while ( ( orphan = waitpid( -1, &status, WNOHANG ) ) > 0 ) // ended with its parent
    {
    }
    if ( orphan == 0 )
    {
        fail_msg( "a process goes on" );
    }
    assert_int_equal( errno, ECHILD );
}

// ---- runs ----

TEST( an_interrupted_run_leaves_whole_files_and_its_summary )
{
    const started s = start( "run endless.yaml --record run.wisp --track flag:3 --track-file track.csv" );
    wait_for_file( "run.wisp", 50000 );
    kill( s.pid, SIGINT );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 130 );
    int steps = 0;
    assert_non_null( strstr( result.out, "\ninterrupted  at step " ) );
    assert_int_equal( sscanf( strstr( result.out, "at step " ), "at step %d of 1000000", &steps ), 1 );
    assert_non_null( strstr( result.out, "\nnot written  end.obj\n" ) );
    assert_non_null( strstr( result.out, "\nhash " ) );
    assert_string_equal( result.err, "" );
    assert_false( exists( "end.obj" ) );
    assert_nothing_is_hidden();

    run_ok( "info run.wisp" );
    char expected[64];
    snprintf( expected, sizeof expected, "recording of %d frames", steps + 1 );
    assert_non_null( strstr( result.out, expected ) );
    assert_non_null( strstr( result.out, "no defects" ) );
    size_t size;
    char* track = read_bytes( "track.csv", &size );
    assert_int_equal( line_count( track ), steps + 2 ); // the header and the start
    free( track );
    char command[80];
    snprintf( command, sizeof command, "run endless.yaml --steps %d --verify run.wisp", steps );
    run_ok( command ); // the frames are those of a run that was not interrupted
}

TEST( sigterm_is_answered_in_the_same_way )
{
    const started s =
        start( "run endless.yaml --record term.pc2 --track flag:1 --track-file term.csv -o term.json -f json" );
    pause_ms( 500 );
    kill( s.pid, SIGTERM );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 143 );
    assert_nothing_is_hidden();
    run_ok( "info term.pc2" );
    run_ok( "info term.json" );
    assert_non_null( strstr( result.out, "results, 1 rows" ) );
}

TEST( a_second_signal_ends_the_program_at_once )
{
    // nobody reads the summary, so that the program waits after the first signal
    assert_int_equal( mkfifo( "nobody", 0600 ), 0 );
    const started s = start( "run endless.yaml -o nobody" );
    pause_ms( 300 );
    kill( s.pid, SIGINT );
    pause_ms( 300 );
    assert_int_equal( waitpid( s.pid, NULL, WNOHANG ), 0 );
    kill( s.pid, SIGINT );
    assert_int_equal( finish( &s ), SIGINT );
}

TEST( a_killed_run_leaves_no_half_of_a_file )
{
    const int nameless = open( ".", O_TMPFILE | O_WRONLY, 0600 );
    if ( nameless < 0 )
    {
        SKIP( "this file system has no files without a name" );
    }
    close( nameless );
    const started s = start( "run endless.yaml --record killed.usda" );
    pause_ms( 500 );
    kill( s.pid, SIGKILL );
    assert_int_equal( finish( &s ), SIGKILL );
    assert_false( exists( "killed.usda" ) );
    assert_nothing_is_hidden();
}

TEST( a_reader_that_leaves_early_costs_no_file )
{
    char line[4400];
    int status;
    snprintf( line, sizeof line, "'%s' run endless.yaml --steps 20 --record early.wisp | true", program );
    status = system( line );
    assert_true( status == 0 );
    run_ok( "info early.wisp" );
    assert_non_null( strstr( result.out, "recording of 21 frames" ) );
    snprintf( line, sizeof line, "'%s' info --keys | head -n 1 >first.txt", program );
    status = system( line );
    assert_true( status == 0 );
    assert_nothing_is_hidden();
}

// ---- other long work ----

TEST( pictures_that_are_whole_are_kept )
{
    const started s = start( "render endless.yaml --frames 0:2000:1 --size 64x48 -o film.png" );
    wait_for_file( "film_0002.png", 1 );
    kill( s.pid, SIGINT );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 130 );
    assert_non_null( strstr( result.out, "film_0001.png: the first of " ) );
    assert_non_null( strstr( result.out, "interrupted at picture " ) );
    size_t size;
    unsigned char* bytes = read_bytes( "film_0002.png", &size );
    assert_memory_equal( bytes + size - 8, "IEND", 4 );
    free( bytes );
    assert_nothing_is_hidden();
}

TEST( a_picture_that_is_not_whole_is_not_written )
{
    const started s = start( "render endless.yaml --frame 0 --size 4000x3000 --samples 4096 -o huge.png" );
    pause_ms( 500 );
    kill( s.pid, SIGINT );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 130 );
    assert_false( exists( "huge.png" ) );
    assert_nothing_is_hidden();
}

TEST( a_page_has_the_hashes_until_then )
{
    setenv( "WISP_DATA", ".", 1 );
    const started s = start( "view endless.yaml --steps 1000000 -o page.html" );
    unsetenv( "WISP_DATA" );
    pause_ms( 700 );
    kill( s.pid, SIGTERM );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 143 );
    assert_non_null( strstr( result.err, "wisp: interrupted at step " ) );
    size_t size;
    SCOPED( free_local ) char* page = read_bytes( "page.html", &size );
    assert_non_null( strstr( page, "\"hashes\":{\"every\":60" ) );
}

TEST( a_search_that_has_only_begun_has_nothing_to_keep )
{
    const started s = start( "tune endless.yaml --error 0.001 --length 100 -o tuned.yaml" );
    pause_ms( 400 );
    kill( s.pid, SIGINT );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 130 );
    assert_string_equal( result.err, "wisp: interrupted by Ctrl-C\n" );
    assert_false( exists( "tuned.yaml" ) );
}

TEST( a_benchmark_writes_what_it_has )
{
    const started s = start( "bench balloon --quick --output bench.json --format json --report bench.html" );
    pause_ms( 1500 );
    kill( s.pid, SIGINT );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 130 );
    run_ok( "info bench.json" );
    static char page[1 << 20];
    read_text( "bench.html", page, sizeof page );
    assert_non_null( strstr( page, "interrupted: " ) );
    assert_non_null( strstr( page, "</html>" ) );
    assert_nothing_is_hidden();
}

// ---- other processes ----

TEST( processes_of_the_torture_end_with_it )
{
    const started s = start( "torture --limit 1000 endless.yaml" );
    pause_ms( 1500 );
    kill( s.pid, SIGTERM );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 143 );
    assert_non_null( strstr( result.out, "interrupted  after " ) );
    assert_no_process_is_left();
    const started killed = start( "torture --limit 1000 endless.yaml" );
    pause_ms( 1500 );
    kill( killed.pid, SIGKILL );
    assert_int_equal( finish( &killed ), SIGKILL );
    assert_no_process_is_left();
}

TEST( a_gate_that_counts_instructions_stops_valgrind )
{
    if ( system( "valgrind --version >/dev/null 2>&1" ) != 0 )
    {
        SKIP( "valgrind is not here" );
    }
    write_text( "base.json", "as it was" );
    write_text( "short.yaml",
                "wisp: 1\nsteps: 1500\nsurfaces:\n  - name: flag\n"
                "    generate: { shape: plane, columns: 17, rows: 17, spacing: 0.05 }\n    cloth: {}\n" );
    write_text( "suite.yaml", "wisp_suite: 1\nscenes:\n  - { file: short.yaml }\n" );
    const started s = start( "gate record suite.yaml -o base.json" );
    pause_ms( 4000 );
    kill( s.pid, SIGTERM );
    assert_int_equal( finish( &s ), 0 );
    assert_ended_with( 143 );
    assert_string_equal( result.err, "wisp: interrupted after 0 of 1 rows: base.json is as it was\n" );
    char text[32];
    read_text( "base.json", text, sizeof text );
    assert_string_equal( text, "as it was" );
    assert_no_process_is_left();
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
