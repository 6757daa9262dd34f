// The command line of the built program: options as getopt_long() reads them, help, manual pages and completions, which
// come from the same tables.
#include "program_fixture.h"

static const char small_scene[] = "wisp: 1\n"
                                  "steps: 3\n"
                                  "surfaces:\n"
                                  "  - name: flag\n"
                                  "    generate: { shape: plane, columns: 5, rows: 5, spacing: 0.1 }\n"
                                  "    pins: [0, 4]\n"
                                  "    cloth: {}\n";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "flag.yaml", small_scene }, { "--odd.yaml", small_scene } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

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
    assert_usage( "render flag.yaml --fra 1 -o a.png", "got option '--fra', which can be --frame, --frames" );
}

TEST( what_follows_two_dashes_is_no_option )
{
    run_ok( "run --steps 2 -- --odd.yaml" );
    assert_non_null( strstr( result.out, "scene        --odd.yaml" ) );
    assert_usage( "run --steps 2 --odd.yaml", "got option '--odd.yaml', which does not exist" );
}

TEST( the_last_of_an_option_that_is_given_twice_counts )
{
    run_ok( "run flag.yaml --steps 1 --steps 3 --format csv --format text" );
    assert_non_null( strstr( result.out, "\nsteps        3 of " ) );
}

TEST( usage_errors_are_one_line_that_suggests_the_nearest )
{
    static const char* const commands[][2] = {
        { "run flag.yaml --stpes 2", "wisp run: got option '--stpes'; did you mean '--steps'?\n" },
        { "run flag.yaml --steps", "wisp run: --steps: got no value, expected N\n" },
        { "run flag.yaml -s", "wisp run: --steps: got no value, expected N\n" },
        { "bench --quick=yes", "wisp bench: --quick: got a value, expected none\n" },
        { "run flag.yaml -qx", "wisp run: got option '-q', which does not exist; 'wisp run --help' lists all\n" },
        { "--verbose", "wisp: got option '--verbose', which does not exist; 'wisp --help' lists all\n" },
        { "help rnu", "wisp: got command 'rnu'; did you mean 'run'?\n" },
        { "completion csh", "wisp completion: shell: got 'csh', expected bash\n" },
        { "gate check a.yaml b.yaml", "wisp gate: got a second suite 'b.yaml', expected one\n" },
    };
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        assert_usage( commands[i][0], "wisp" );
        assert_string_equal( result.err, commands[i][1] );
    }
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
    run_ok( "run -V" );
    assert_string_equal( result.out, "wisp " WISP_VERSION_STRING "\n" );
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

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
