// What frozen hair costs grows as the number of its vertices (Kim 2026, eq. 20): instructions, which `wisp gate` counts with
// valgrind and which repeat exactly. Time is fitted by `wisp bench paper`.
#include "program_fixture.h"

#include "stats.h"

#include <jansson.h>

enum
{
    SIZES = 4,
    PASSES = 3, // freeze, align, clump
};

// Roots 0.5 mm apart and a vertex each centimetre, as in the bench case "paper": a dozen neighbours each, at every size.
static const char scene[] =
    "wisp: 1\n"
    "steps: 1\n"
    "strands:\n"
    "  - name: hair\n"
    "    generate: { shape: wavy, dimension: 2, strands: 100, vertices: 20, length: 0.2, spacing: 0.0005 }\n"
    "    frozen_hair:\n"
    "      freeze: {}\n"
    "      align: { cursor: [1, -3, 0], reach: 10 }\n"
    "      clump: { radius: 0.0042 }\n"
    "    compute: [points]\n";

static const char suite[] = "wisp_suite: 1\n"
                            "scenes:\n"
                            "  - file: hair.yaml\n"
                            "    vary: { \"strands[hair].generate.strands\": [100, 200, 300, 500] }\n";

static const double vertices[SIZES] = { 2000.0, 4000.0, 6000.0,
                                        10000.0 }; // 100, 300 and 500 strands are those of table 1

static int enter_folder( void** state )
{
    static const text_file files[] = { { "hair.yaml", scene }, { "suite.yaml", suite } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

static void check_line( const char* what, const double* instructions )
{
    const stats_line line = stats_fit_line( vertices, instructions, SIZES );
    print_message( "           %-18s %6.0f instructions a vertex, R^2 = %.6f\n", what, line.slope, line.r_squared );

    // the paper's row demands 0.98, which time needs; counts have no noise, and a power of 1.5 has 0.992 here
    assert_true( line.r_squared > 0.999 );
    assert_true( line.slope > 10.0 );
}

TEST( instructions_grow_linearly_with_the_vertices )
{
    static const char* const names[PASSES] = { "frozen_hair.freeze", "frozen_hair.align", "frozen_hair.clump" };
    run( "gate record suite.yaml -o base.json" );
    if ( result.status != 0 )
    {
        assert_contains( result.err, "valgrind" );
        SKIP( "valgrind is not here" );
    }
    json_t* base = json_load_file( "base.json", 0, NULL );
    const json_t* rows = json_object_get( base, "rows" );
    assert_int_equal( json_array_size( rows ), SIZES );
    double all[SIZES], pass[PASSES][SIZES];
    for ( int n = 0; n < SIZES; ++n )
    {
        const json_t* row = json_array_get( rows, (size_t)n );
        all[n] = json_number_value( json_object_get( json_object_get( row, "values" ), "instructions" ) );
        for ( int i = 0; i < PASSES; ++i )
        {
            pass[i][n] = json_number_value( json_object_get( json_object_get( row, "passes" ), names[i] ) );
        }
    }
    json_decref( base );
    check_line( "a step", all );
    for ( int i = 0; i < PASSES; ++i )
    {
        check_line( names[i], pass[i] );
    }
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
