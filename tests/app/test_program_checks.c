// The program as a user meets it: suites whose rows have checks.
#include "program_fixture.h"

#define SHEET                                                                                                        \
    "wisp: 1\n"                                                                                                      \
    "steps: 300\n"                                                                                                   \
    "gravity: [0, -9.81, 0]\n"                                                                                       \
    "surfaces:\n"                                                                                                    \
    "  - name: sheet\n"                                                                                              \
    "    generate: { shape: alternating_plane, columns: 12, rows: 12, spacing: 0.05 }\n"                             \
    "    transform: { rotate: { axis: [1, 0, 0], degrees: 90 } }\n"                                                  \
    "    pins: [0, 11]\n"                                                                                            \
    "    damping: 4\n"                                                                                               \
    "    cloth: { bending: isometric }\n"

#define SUITE( lines ) "wisp_suite: 1\n" lines

// Heavy at the bottom, the sheet gains energy: one sweep of its links cannot carry it.
#define HEAVY "set: { \"surfaces[0].mass_ratio\": 1e3 }"

static const char holds[] = SUITE( "checks: all\n"
                                   "scenes: [{ file: sheet.yaml }, { file: sheet.yaml, name: wrong, expect: refused, "
                                   "set: { \"surfaces[0].area_density\": -1 } }]\n" );
static const char breaks[] =
    SUITE( "checks: [energy]\n"
           "scenes: [{ file: sheet.yaml }, { file: sheet.yaml, name: heavy, " HEAVY " }]\n" );
static const char known[] = SUITE( "checks: [energy]\n"
                                   "known: { heavy: energy }\n"
                                   "scenes: [{ file: sheet.yaml, name: heavy, " HEAVY " }]\n" );
static const char mended[] = SUITE( "checks: [finite, energy]\n"
                                    "known: { sheet: energy }\n"
                                    "scenes: [{ file: sheet.yaml }]\n" );
static const char sweeps[] = SUITE( "checks: [finite]\n"
                                    "seconds: 0.1\n"
                                    "axes: { dt: { short: { dt: 0.01 }, long: { dt: 0.05, seconds: 0.2 } }, size: { "
                                    "small: { \"surfaces[0].generate.spacing\": 0.01 } } }\n"
                                    "quick: [base]\n"
                                    "long: [\"sheet: long\"]\n"
                                    "scenes: [{ file: sheet.yaml, sweep: [dt, size], pairs: [dt, size] }]\n" );
static const char differs[] = SUITE( "checks: [finite]\n"
                                     "seconds: 0.5\n"
                                     "scenes: [{ file: sheet.yaml, agree: 0.01, vary: { held: { both: {}, one: { "
                                     "\"surfaces[0].pins\": [0] } } } }]\n" );

// In wind nothing is at rest, so that no limit is known but that of the user.
static const char windy[] = SUITE(
    "seconds: 0.5\n"
    "scenes: [{ file: sheet.yaml, checks: [strain, rest], set: { \"surfaces[0].cloth.wind\": [3, 0, 0], "
    "\"surfaces[0].cloth.drag_coefficient\": 1 } }, { file: sheet.yaml, name: mine, checks: [{ strain: 1e-4 }, { "
    "speed: 50 }], set: { \"surfaces[0].cloth.wind\": [3, 0, 0], \"surfaces[0].cloth.drag_coefficient\": 1 } }]\n" );

static int enter_folder( void** state )
{
    static const text_file files[] = { { "sheet.yaml", SHEET },     { "holds.yaml", holds },
                                       { "breaks.yaml", breaks },   { "known.yaml", known },
                                       { "mended.yaml", mended },   { "sweeps.yaml", sweeps },
                                       { "differs.yaml", differs }, { "windy.yaml", windy } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

TEST( rows_that_hold_are_status_0 )
{
    run_ok( "bench holds.yaml" );
    assert_contains( result.out, "2 cells: 1 hold" );
    assert_contains( result.out, "refused, as expected" );
}

TEST( a_row_that_breaks_is_status_1_and_a_sentence )
{
    run( "bench breaks.yaml" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "FAILED: stability, heavy: breaks energy: energy is " );
    assert_contains( result.out, "2 cells: 1 hold" );
}

TEST( what_is_known_to_break_passes_until_it_holds )
{
    run_ok( "bench known.yaml" );
    assert_contains( result.out, "1 break as known" );
    run( "bench mended.yaml" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "sheet: holds now; remove it from what is known to break" );
}

TEST( a_sweep_has_each_value_alone_and_pairs_and_leaves_out_what_is_not_due )
{
    run_ok( "bench sweeps.yaml" );
    assert_contains( result.out, "sheet: short, small" );
    assert_contains( result.out, "sweeps: 5 cells: 5 hold" ); // base, short, small, two pairs
    run_ok( "bench sweeps.yaml --long" );
    assert_contains( result.out, "sweeps: 6 cells: 6 hold" );
    run_ok( "bench sweeps.yaml --quick" );
    assert_contains( result.out, "sweeps: 1 cells: 1 hold" );
}

TEST( rows_that_must_agree_and_differ_fail )
{
    run( "bench differs.yaml" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "sheet: rows differ by " );
}

TEST( a_check_without_a_limit_says_so_and_takes_that_of_the_user )
{
    run( "bench windy.yaml" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "strain rest" );
    assert_contains( result.out, "in 1 cells no limit is known" );
    assert_contains( result.out, "FAILED: stability, mine: breaks strain: " );
    assert_contains( result.out, "and 0.01 % are allowed" );
}

TEST( wrong_words_name_their_place )
{
    static const struct
    {
        const char *text, *message;
    } cases[] = {
        { SUITE( "checks: [enrgy]\nscenes: [{ file: sheet.yaml }]\n" ),
          "wrong.yaml:2:10: got check 'enrgy'; did you mean 'energy'?" },
        { SUITE( "checks: some\nscenes: [{ file: sheet.yaml }]\n" ), "wrong.yaml:2:9: expected checks: all" },
        { SUITE( "checks: [{ strain: -1 }]\nscenes: [{ file: sheet.yaml }]\n" ),
          "wrong.yaml:2:20: expected a limit above 0" },
        { SUITE( "checks: [{ bits: 1 }]\nscenes: [{ file: sheet.yaml }]\n" ),
          "wrong.yaml:2:10: expected a check and its limit" },
        { SUITE( "checks: all\nknown: { other: rest }\nscenes: [{ file: sheet.yaml }]\n" ),
          "wrong.yaml:3:10: no row is called 'other'" },
        { SUITE( "checks: [finite]\nknown: { sheet: rest }\nscenes: [{ file: sheet.yaml }]\n" ),
          "which is none of its checks" },
        { SUITE( "checks: all\nscenes: [{ file: sheet.yaml, expect: luck }]\n" ),
          "wrong.yaml:3:38: expected expect: refused" },
        { SUITE( "checks: all\nscenes: [{ file: sheet.yaml, sweep: [dt] }]\n" ),
          "wrong.yaml:3:38: axes has no 'dt'" },
        { SUITE( "checks: all\naxes: { dt: [1] }\nscenes: [{ file: sheet.yaml }]\n" ), "expected axes, such as" },
        { SUITE( "checks: all\nquick: [none]\nscenes: [{ file: sheet.yaml }]\n" ), "no row is called 'none'" },
        { SUITE( "check: all\nscenes: [{ file: sheet.yaml }]\n" ), "did you mean 'checks'?" },
        { SUITE( "checks: all\nscenes: [{ file: sheet.yaml, agree: 2 }]\n" ), "expected a part of the size" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        write_text( "wrong.yaml", cases[i].text );
        assert_refused( "bench wrong.yaml", cases[i].message );
    }
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
