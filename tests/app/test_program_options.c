// The command line of the built program: options as getopt_long() reads them, help, manual pages and completions, which come
// from the same tables. "-" as a file: standard input where the program reads, standard output where it writes.
#include "program_fixture.h"

#include <jansson.h>

static const char small_scene[] = "wisp: 1\n"
                                  "steps: 3\n"
                                  "surfaces:\n"
                                  "  - name: flag\n"
                                  "    generate: { shape: plane, columns: 5, rows: 5, spacing: 0.1 }\n"
                                  "    pins: [0, 4]\n"
                                  "    cloth: {}\n";

// ---- options ----

TEST( long_options_can_be_abbreviated_and_joined_to_their_value )
{
    static const char* const commands[] = { "run flag.yaml --steps 2",  "run flag.yaml --steps=2",
                                            "run --st 2 flag.yaml",     "run --ste=2 flag.yaml",
                                            "run -s2 flag.yaml",        "run -s 2 flag.yaml",
                                            "run flag.yaml --step 2 --" };
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        run_ok( commands[i] );
        assert_non_null( strstr( result.out, "\nsteps        2 of " ) );
    }
}

TEST( what_follows_two_dashes_is_no_option )
{
    run_ok( "run --steps 2 -- --odd.yaml" );
    assert_non_null( strstr( result.out, "scene        --odd.yaml" ) );
}

TEST( the_last_of_an_option_that_is_given_twice_counts )
{
    run_ok( "run flag.yaml --steps 1 --steps 3 --format csv --format text" );
    assert_non_null( strstr( result.out, "\nsteps        3 of " ) );
}

// Each with its whole message, its exit status, nothing on standard output and no file.
TEST( commands_are_refused_as_the_transcript_says )
{
    size_t size;
    SCOPED( free_local ) char* transcript = read_bytes( WISP_SOURCE_ROOT "/tests/app/refusals.t", &size );
    assert_true( mkdir( "empty", 0700 ) == 0 && chdir( "empty" ) == 0 );
    int count = 0;
    for ( const char* at = strstr( transcript, "$ wisp" ); at != NULL; at = strstr( at, "$ wisp" ) )
    {
        static char said[OUTPUT_MAX + 20];
        char command[200];
        at += strlen( "$ wisp" );
        const int length = (int)strcspn( at, "\n" );
        snprintf( command, sizeof command, "%.*s", length, at );
        run( command );
        snprintf( said, sizeof said, "\n%s[%d]\n", result.err, result.status );
        if ( result.out[0] || result.status == 0 || strncmp( at + length, said, strlen( said ) ) != 0 )
        {
            fail_msg( "wisp%s says: %s%s", command, result.out, said );
        }
        ++count;
    }
    assert_true( count > 100 );
    assert_true( chdir( ".." ) == 0 && rmdir( "empty" ) == 0 );
}

// ---- help ----

TEST( help_is_the_same_in_every_way_that_it_is_asked_for )
{
    static const char* const verbs[] = { "run",  "render",   "view",    "info", "plan",    "tune",
                                         "gate", "accuracy", "torture", "help", "compare", "bench" };
    static char expected[OUTPUT_MAX];
    for ( int i = 0; i < WISP_COUNT( verbs ); ++i )
    {
        static const char* const ways[] = { "help %s", "%s --help", "%s -h", "%s -?", "%s --he" };
        for ( int k = 0; k < WISP_COUNT( ways ); ++k )
        {
            char command[64];
            snprintf( command, sizeof command, ways[k], verbs[i] );
            run_ok( command );
            assert_string_equal( result.err, "" );
            if ( k == 0 )
            {
                strcpy( expected, result.out );
            }
            assert_string_equal( result.out, expected );
        }
    }
    run_ok( "help" );
    strcpy( expected, result.out );
    run_ok( "--help" );
    assert_string_equal( result.out, expected );
    run_ok( "--version" );
    strcpy( expected, result.out );
    run_ok( "run -V" );
    assert_string_equal( result.out, expected );
}

// Call a function with each long option in a help text.
static int each_option( const char* help, void ( *found )( const char* name ) )
{
    int count = 0;
    for ( const char* line = help; line; line = strchr( line + 1, '\n' ) )
    {
        char name[64];
        if ( sscanf( line, "\n  -%*c, --%63[a-z-]", name ) == 1 || sscanf( line, "\n      --%63[a-z-]", name ) == 1 )
        {
            found( name );
            ++count;
        }
    }
    return count;
}

static char manual[OUTPUT_MAX], bash[OUTPUT_MAX], verb[32];

static void assert_is_everywhere( const char* name )
{
    char word[160], escaped[128] = "";
    for ( const char* c = name; *c; ++c )
    {
        const size_t used = strlen( escaped );
        snprintf( escaped + used, sizeof escaped - used, *c == '-' ? "\\-" : "%c", *c );
    }
    snprintf( word, sizeof word, "\\fB\\-\\-%s\\fR", escaped );
    assert_non_null( strstr( manual, word ) );
    snprintf( word, sizeof word, "--%s", name );
    assert_non_null( strstr( bash, word ) );
}

TEST( every_option_in_help_is_in_the_manual_and_in_completions )
{
    static const char* const verbs[] = { "run",     "render",   "view", "info",    "plan", "tune",      "bench",
                                         "torture", "accuracy", "gate", "compare", "help", "completion" };
    run_ok( "completion bash" );
    strcpy( bash, result.out );
    int count = 0;
    for ( int i = 0; i < WISP_COUNT( verbs ); ++i )
    {
        char command[64];
        snprintf( verb, sizeof verb, "%s", verbs[i] );
        snprintf( command, sizeof command, "help --man %s", verb );
        run_ok( command );
        strcpy( manual, result.out );
        snprintf( command, sizeof command, "help %s", verb );
        run_ok( command );
        count += each_option( result.out, assert_is_everywhere );
    }
    assert_true( count > 100 ); // 13 commands, of which each has at least three
}

TEST( the_manual_of_the_program_names_every_command )
{
    run_ok( "help --man" );
    strcpy( manual, result.out );
    assert_non_null( strstr( manual, ".TH wisp 1 " ) );
    run_ok( "help" );
    const char* line = strstr( result.out, "Commands:\n" );
    assert_non_null( line );
    int count = 0;
    char name[32], expected[64];
    for ( line = strchr( line, '\n' ); sscanf( line, "\n  %31[a-z]", name ) == 1; line = strchr( line + 1, '\n' ) )
    {
        snprintf( expected, sizeof expected, "\\fBwisp\\-%s\\fR(1)", name );
        assert_non_null( strstr( manual, expected ) );
        ++count;
    }
    assert_int_equal( count, 16 );
}

// ---- streams ----

static const char square_scene[] = "wisp: 1\n"
                                   "steps: 3\n"
                                   "surfaces:\n"
                                   "  - name: flag\n"
                                   "    file: square.obj\n"
                                   "    pins: [0]\n"
                                   "    cloth: {}\n";
static const char square[] = "# two triangles\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 1 3 4\n";

/// Run the program with a file as its standard input, through a pipe that cannot be rewound.
static void run_with_input( const char* file, const char* command )
{
    size_t size;
    SCOPED( free_local ) char* bytes = read_bytes( file, &size );
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
    assert_reads( "square.yaml", "run -", "scene        standard input\nsteps        3 of " );
    assert_reads( "square.yaml", "plan -", " passes in " );
    assert_reads( "square.yaml", "info -", "standard input: scene, " );
}

TEST( every_kind_of_file_is_told_by_its_first_bytes )
{
    run_ok( "run square.yaml --record flag.wisp --format json --output result.json" );
    run_ok( "run square.yaml --record flag.pc2 -o summary.txt" );
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
}

TEST( a_tuned_scene_goes_to_standard_output_and_the_report_to_the_error_stream )
{
    run_with_input( "square.yaml", "tune - --error 1 -o -" );
    assert_int_equal( result.status, 0 );
    assert_memory_equal( result.out, "wisp: 1\n", 8 );
    assert_non_null( strstr( result.err, "target" ) );
}

TEST( results_go_to_standard_output )
{
    run_ok( "run square.yaml -o - --format json" );
    json_t* root = json_loads( result.out, JSON_REJECT_DUPLICATES, NULL );
    assert_non_null( root );
    json_decref( root );
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

static int enter_folder( void** state )
{
    static const text_file files[] = { { "flag.yaml", small_scene },
                                       { "--odd.yaml", small_scene },
                                       { "square.yaml", square_scene },
                                       { "square.obj", square },
                                       { "wrong.yaml", "wisp: 1\nstepz: 3\n" } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
