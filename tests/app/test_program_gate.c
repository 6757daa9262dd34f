// The program as a user meets it: wisp gate.
#include "program_fixture.h"

#include <jansson.h>

#define CLOTH( damping, columns )                                                                                    \
    "wisp: 1\n"                                                                                                      \
    "steps: 20\n"                                                                                                    \
    "surfaces:\n"                                                                                                    \
    "  - name: cloth\n"                                                                                              \
    "    generate: { shape: plane, columns: " columns ", rows: 9, spacing: 0.05 }\n"                                 \
    "    pins: [0, 4]\n"                                                                                             \
    "    damping: " damping "\n"                                                                                     \
    "    cloth: {}\n"

static const char suite[] =
    "wisp_suite: 1\n"
    "scenes:\n"
    "  - file: cloth.yaml\n"
    "    vary: { substeps: [4, 10], \"surfaces[*].cloth.bending\": [bend_links, none] }\n"
    "  - { file: cloth.yaml, name: short, steps: 5, set: { \"surfaces[cloth].damping\": 2 } }\n";

typedef struct bad_suite
{
    const char *text, *named;
} bad_suite;

static int enter_folder( void** state )
{
    static const text_file files[] = { { "cloth.yaml", CLOTH( "1", "9" ) }, { "suite.yaml", suite } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

// Each test begins with the same two files and no base.
static int fresh( void** state )
{
    (void)state;
    write_text( "cloth.yaml", CLOTH( "1", "9" ) );
    write_text( "suite.yaml", suite );
    unlink( "suite-base.json" );
    return 0;
}

TEST_WITH( what_did_not_change_passes, fresh, NULL )
{
    run_ok( "gate record suite.yaml --no-instructions -o base.json" );
    assert_contains( result.out, "recorded: 5 rows in base.json" );
    run_ok( "gate check suite.yaml --no-instructions --base base.json --junit gate.xml --strict" );
    assert_contains( result.out, "cloth: substeps=4, bending=bend_links" );
    assert_contains( result.out, "cloth: substeps=10, bending=none" );
    assert_contains( result.out, "pass: 5 rows, 5 the same\n" );
    size_t size;
    char* junit = read_bytes( "gate.xml", &size );
    assert_contains( junit, "tests=\"5\" failures=\"0\"" );
    free( junit );
}

// A base beside the suite is the default.
TEST_WITH( other_bits_without_a_worse_value_pass_unless_their_budget_is_0, fresh, NULL )
{
    run_ok( "gate record suite.yaml --no-instructions" );
    write_text( "cloth.yaml", CLOTH( "1.01", "9" ) );
    run_ok( "gate check suite.yaml --no-instructions" );
    assert_contains( result.out,
                     "pass: 5 rows, 1 the same, 4 moved\n" ); // the damping of `short` is its own
    write_text( "suite.yaml", "wisp_suite: 1\nbudgets: { hash: 0 }\nscenes: [{ file: cloth.yaml }]\n" );
    run_ok( "gate record suite.yaml --no-instructions" );
    run_ok( "gate check suite.yaml --no-instructions" );
    write_text( "cloth.yaml", CLOTH( "1", "9" ) );
    run( "gate check suite.yaml --no-instructions" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "FAILED: cloth: hash is " );
}

TEST_WITH( a_worse_value_is_status_1_with_a_sentence, fresh, NULL )
{
    run_ok( "gate record suite.yaml --no-instructions" );
    write_text( "cloth.yaml", CLOTH( "1", "17" ) );
    run( "gate check suite.yaml --no-instructions" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "short: bytes is " );
    assert_contains( result.out, "regression: 5 rows" );

    run_ok( "gate accept suite.yaml --no-instructions --reason finer" );
    run_ok( "gate check suite.yaml --no-instructions" );
    json_t* base = json_load_file( "suite-base.json", 0, NULL );
    const json_t* accepted = json_array_get( json_object_get( base, "accepted" ), 0 );
    assert_string_equal( json_string_value( json_object_get( accepted, "reason" ) ), "finer" );
    json_decref( base );
}

TEST_WITH( budgets_decide, fresh, NULL )
{
    run_ok( "gate record suite.yaml --no-instructions" );
    write_text( "cloth.yaml", CLOTH( "1", "10" ) );
    run( "gate check suite.yaml --no-instructions" );
    assert_int_equal( result.status, 1 );
    char wide[2000];
    snprintf( wide, sizeof wide, "budgets: { bytes: 100, stretch: 100, energy: 100 }\n%s", suite );
    write_text( "suite.yaml", wide );
    run_ok( "gate check suite.yaml --no-instructions" );
}

// A sheet that hangs still shows its material, as in the suite of docs/gate.md.
TEST_WITH( links_a_tenth_too_soft_are_worse, fresh, NULL )
{
    static const char soft[] =
        "wisp_suite: 1\nscenes: [{ file: cloth.yaml, set: { substeps: 20, \"surfaces[0].damping\": 5, "
        "\"surfaces[0].cloth\": { warp_compliance: %g, weft_compliance: %g, shear_compliance: %g, bending: none } } "
        "}]\n";
    for ( double compliance = 0.1; compliance < 0.115; compliance += 0.01 )
    {
        char text[400];
        snprintf( text, sizeof text, soft, compliance, compliance, compliance );
        write_text( "suite.yaml", text );
        run( compliance < 0.105 ? "gate record suite.yaml --no-instructions"
                                : "gate check suite.yaml --no-instructions" );
    }
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "stretch is " );
}

TEST_WITH( rows_that_only_one_side_has_are_told, fresh, NULL )
{
    run_ok( "gate record suite.yaml --no-instructions" );
    write_text( "suite.yaml", "wisp_suite: 1\nscenes: [{ file: cloth.yaml, vary: { substeps: [4, 6] } }]\n" );
    run_ok( "gate check suite.yaml --no-instructions" );
    assert_contains( result.out, "inconclusive: 2 rows" );
    assert_contains( result.out, "5 rows of the base are not in the suite any more" );
    run( "gate check suite.yaml --no-instructions --strict" );
    assert_int_equal( result.status, 1 );
}

// With a reference a row that is farther from it than before is worse.
TEST_WITH( errors_are_compared, fresh, NULL )
{
    static const char with[] =
        "reference: { set: { substeps: 40 }, check: { substeps: 20 } }\nwisp_suite: 1\nscenes: [{ file: cloth.yaml, "
        "set: { substeps: %d }, steps: 10 }]\nbudgets: { stretch: 100, energy: 100, bytes: 100 }\n";
    char text[400];
    setenv( "WISP_CACHE", "references", 1 );
    snprintf( text, sizeof text, with, 10 );
    write_text( "suite.yaml", text );
    run_ok( "gate record suite.yaml --no-instructions" );
    json_t* base = json_load_file( "suite-base.json", 0, NULL );
    const json_t* values = json_object_get( json_array_get( json_object_get( base, "rows" ), 0 ), "values" );
    const double error = json_number_value( json_object_get( values, "error" ) );
    assert_true( error > 1e-5 && error < 0.1 );
    json_decref( base );
    snprintf( text, sizeof text, with, 20 );
    write_text( "suite.yaml", text );
    run_ok( "gate check suite.yaml --no-instructions" );
    assert_contains( result.out, "; compared until 0.133 s, where two converged runs part\n" );
    snprintf( text, sizeof text, with, 4 );
    write_text( "suite.yaml", text );
    run( "gate check suite.yaml --no-instructions" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "error is " );
    unsetenv( "WISP_CACHE" );
}

// The rule and the way out, before anything runs.
TEST_WITH( rows_that_do_not_fit_the_reference_are_refused_at_once, fresh, NULL )
{
    static const bad_suite all[] = {
        { "along: { dt: [0.01, 0.02, 0.012] }", "a dt of 0.02 s or 0.01 s does" },
        { "set: { dt: 0.02, \"surfaces[0].name\": sheet }",
          "none of the reference is called 'sheet'; name it 'cloth'" },
    };
    setenv( "WISP_CACHE", "unused", 1 );
    for ( int i = 0; i < WISP_COUNT( all ); ++i )
    {
        char text[400];
        snprintf( text, sizeof text,
                  "wisp_suite: 1\nseconds: 0.1\nreference: { file: cloth.yaml, set: { substeps: 80, dt: 0.02 }, "
                  "check: { substeps: 40 } }\nscenes: [{ file: cloth.yaml, %s }]\n",
                  all[i].text );
        write_text( "suite.yaml", text );
        assert_refused( "gate record suite.yaml --no-instructions", all[i].named );
    }
    assert_int_equal( access( "unused", F_OK ), -1 );
    unsetenv( "WISP_CACHE" );
}

// Where valgrind is installed: the same counts in every run; one percent of instructions and five of cycles more are too much. A base
// that has cycles is compared with cycles, without being asked.
TEST_WITH( instructions_and_cycles_repeat, fresh, NULL )
{
    static const char* const names[] = { "instructions", "cycles" };
    write_text( "suite.yaml", "wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: 2 }]\n" );
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        run( i == 0 ? "gate record suite.yaml" : "gate record suite.yaml --cycles" );
        if ( result.status != 0 )
        {
            assert_contains( result.err, "valgrind" );
            SKIP( "valgrind is not here" );
        }
        run_ok( "gate check suite.yaml" );
        json_t* base = json_load_file( "suite-base.json", 0, NULL );
        json_t* values = json_object_get( json_array_get( json_object_get( base, "rows" ), 0 ), "values" );
        const json_int_t count = json_integer_value( json_object_get( values, names[i] ) );
        assert_true( count > 10000 && count >= json_integer_value( json_object_get( values, "instructions" ) ) );
        json_object_set_new( values, names[i], json_integer( count - count / ( i == 0 ? 100 : 20 ) ) );
        json_dump_file( base, "suite-base.json", 0 );
        json_decref( base );
        run( "gate check suite.yaml" );
        assert_int_equal( result.status, 1 );
        char told[40];
        snprintf( told, sizeof told, "%s is ", names[i] );
        assert_contains( result.out, told );
    }
    run_ok( "gate self-test suite.yaml --trials 1" );
    assert_contains( result.out, "0 %       +0.00 %" );
    assert_null( strstr( result.out, "5 %       +0.00 %" ) );
}

TEST_WITH( iterations_of_linear_solves_are_compared, fresh, NULL )
{
    write_text( "implicit.yaml",
                "wisp: 1\nsteps: 4\nsurfaces:\n  - name: a\n    generate: { shape: plane, columns: 9, "
                "rows: 9 }\n    pins: [0]\n    implicit: {}\n" );
    write_text( "suite.yaml", "wisp_suite: 1\nscenes: [{ file: implicit.yaml }, { file: cloth.yaml, steps: 2 }]\n" );
    run_ok( "gate record suite.yaml --no-instructions" );
    json_t* base = json_load_file( "suite-base.json", 0, NULL );
    json_t* rows = json_object_get( base, "rows" );
    json_t* values = json_object_get( json_array_get( rows, 0 ), "values" );
    const json_int_t count = json_integer_value( json_object_get( values, "solver_iterations" ) );
    assert_true( count >= 4 );
    assert_true( json_is_null(
        json_object_get( json_object_get( json_array_get( rows, 1 ), "values" ), "solver_iterations" ) ) );
    json_object_set_new( values, "solver_iterations", json_integer( count / 2 ) );
    json_dump_file( base, "suite-base.json", 0 );
    json_decref( base );
    run( "gate check suite.yaml" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "solver_iterations is " );
}

TEST_WITH( bad_suites_are_refused_in_a_sentence, fresh, NULL )
{
    static const bad_suite all[] = {
        { "", "suite.yaml" },
        { "scenes: []\n", "wisp_suite: 1" },
        { "wisp_suite: 2\nscenes: [{ file: cloth.yaml }]\n", "wisp_suite: 1" },
        { "wisp_suite: 1\nscenes: []\n", "at least one" },
        { "wisp_suite: 1\nscene: [{ file: cloth.yaml }]\n", "did you mean 'scenes'?" },
        { "wisp_suite: 1\nscenes: [{ file: none.yaml }]\n", "suite.yaml:2:18: none.yaml" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, varies: {} }]\n", "got key 'varies', expected one of file" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, vary: { substeps: [] } }]\n", "at least one" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, vary: { substeps: 4 } }]\n", "expected a list of values" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, set: { \"surfaces[7].damping\": 1 } }]\n", "names nothing" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, set: { substep: 1 } }]\n", "did you mean 'substeps'?" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, set: { substeps: -1 } }]\n", "substeps" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: 21 }]\n", "got 21 steps, the scene has 20" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: soon }]\n", "expected a number of steps" },
        { "wisp_suite: 1\nscenes: [{ file: cloth.yaml }, { file: cloth.yaml }]\n", "two rows are called 'cloth'" },
        { "wisp_suite: 1\nbudgets: { byte: 1 }\nscenes: [{ file: cloth.yaml }]\n", "did you mean 'bytes'?" },
        { "wisp_suite: 1\nbudgets: { bytes: -1 }\nscenes: [{ file: cloth.yaml }]\n", "expected a fraction" },
        { "wisp_suite: 1\nbudgets: { bytes: much }\nscenes: [{ file: cloth.yaml }]\n", "expected a fraction" },
    };
    for ( int i = 0; i < WISP_COUNT( all ); ++i )
    {
        write_text( "suite.yaml", all[i].text );
        assert_refused( "gate record suite.yaml --no-instructions", all[i].named );
        assert_int_equal( access( "suite-base.json", F_OK ), -1 );
    }
}

TEST_WITH( bad_bases_are_refused_and_stay, fresh, NULL )
{
    assert_refused( "gate check suite.yaml", "suite-base.json" );
    run_ok( "gate record suite.yaml --no-instructions" );
    size_t size;
    char* good = read_bytes( "suite-base.json", &size );
    good[size / 2] = '\0';
    write_text( "cut.json", good );
    assert_refused( "gate check suite.yaml --base cut.json", "cut.json" );
    assert_refused( "gate accept suite.yaml --no-instructions --reason x --base cut.json", "cut.json" );
    char* still = read_bytes( "cut.json", &size );
    assert_string_equal( still, good );
    free( still );
    free( good );
    write_text( "other.json", "{ \"wisp_gate\": 99 }" );
    assert_refused( "gate check suite.yaml --base other.json", "version 99" );
    write_text( "other.json", "{ \"wisp_gate\":4, \"suite\": \"suite\" }" );
    assert_refused( "gate check suite.yaml --base other.json", "the file was edited" );
    write_text( "other.json", "[]" );
    assert_refused( "gate check suite.yaml --base other.json", "expected a base file" );
    write_text( "another.yaml", suite );
    assert_refused( "gate check another.yaml --base suite-base.json", "of suite 'suite', not of 'another'" );
}

// A program that says it needs half as long; a half is far beyond the noise of any machine. Speed itself is not tested.
TEST_WITH( times_are_compared_with_another_program, fresh, NULL )
{
    char script[5000];
    snprintf( script, sizeof script,
              "#!/bin/sh\n'%s' \"$@\" | while read name version ns steps; do echo $name $version $((ns / 2)) $steps; "
              "done\n",
              program );
    write_text( "faster", script );
    assert_int_equal( chmod( "faster", 0755 ), 0 );
    write_text( "suite.yaml", "wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: 2 }]\n" );
    run( "gate check suite.yaml --paired ./faster" );
    assert_true( result.status == 1 || strstr( result.out, "not measurable" ) != NULL );
    assert_contains( result.out, "Time against the other program" );
    assert_refused( "gate check suite.yaml --paired /bin/true", "/bin/true: expected a Wisp" );
    assert_refused( "gate check suite.yaml --paired none", "none: expected a Wisp" );
    run_ok( "gate self-test suite.yaml --trials 1 --no-instructions" );
    assert_contains( result.out, "What the gate finds of itself" );
    assert_contains( result.out, "is slowed down" );
}

static void write_program( const char* name, const char* script )
{
    write_text( name, script );
    assert_int_equal( chmod( name, 0755 ), 0 );
}

TEST_WITH( programs_that_hang_or_make_other_steps_are_refused, fresh, NULL )
{
    write_text( "suite.yaml", "wisp_suite: 1\nscenes: [{ file: cloth.yaml, steps: 2 }]\n" );
    write_program( "hangs", "#!/bin/sh\nsleep 600\n" );
    assert_refused( "gate check suite.yaml --paired ./hangs --patience 0.2", "./hangs: gave no time of row 0" );
    write_program( "chatters", "#!/bin/sh\nwhile :; do echo yes; done\n" );
    assert_refused( "gate check suite.yaml --paired ./chatters", "./chatters: expected a Wisp" );
    write_program( "skips", "#!/bin/sh\nwhile read n; do echo wisp_gate_ns 2 1000000 1; done\n" );
    assert_refused( "gate check suite.yaml --paired ./skips", "./skips: made 1 steps of row 0" );
}

TEST_WITH( a_row_that_the_suite_lacks_is_refused, fresh, NULL )
{
    assert_refused( "gate step suite.yaml --row 5", "got row 5, the suite has 5" );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
