// The case `boundary` at very small sizes: its checks hold, its tables have the columns of the contract, and errors
// are detected.
#include "bench_tables.h"

#include "boundary_bench.h"

static const bench_options quick = { .quick = true, .workers = 2 };

static boundary_plan small_plan( void )
{
    return ( boundary_plan ){
        .spacings = { 0.2f, 0.1f },
        .spacing_count = 2,
        .workers = { 1, 2 },
        .worker_count = 2,
        .options = &quick,
    };
}

TEST( no_check_of_the_case_fails )
{
    const results* all = *state;
    expect_good( all );
    assert_fits_terminal( all );
    assert_column( find_table( all, "Coverage against cost" ), "met", "yes" );
}

TEST( rows_for_machines_are_there_for_every_worker_count )
{
    const results* all = *state;
    assert_int_equal( count_rows( all, "boundary", "even, in place" ), 2 * 2 );
    assert_int_equal( count_rows( all, "boundary", "exact, resampled" ), 2 * 2 );
    for ( int i = 0; i < all->row_count; ++i )
    {
        const results_row* row = all->rows + i;
        if ( strcmp( row->variant, "even, in place" ) == 0 )
        {
            assert_true( row->ms_median > 0.0 && row->ms_p10 <= row->ms_median && row->ms_median <= row->ms_p90 );
            assert_true( row->has_hash && row->steps >= 3 );
        }
    }
}

// ---- parts of the checks ----

TEST( the_cover_of_a_triangle_without_points_is_its_own )
{
    wisp_vec3 points[] = { { 0.0f, 0.0f, 0.0f }, { 3.0f, 0.0f, 0.0f }, { 0.0f, 4.0f, 0.0f } };
    int32_t triangles[] = { 0, 1, 2 };
    const wisp_mesh mesh = { .points = points, .triangles = triangles, .vertex_count = 3, .triangle_count = 1 };
    static const int32_t edges[] = { 0, 1, 0, 2, 1, 2 };
    static const int32_t begin[5] = { 0 };
    const wisp_samples none = { .begin = begin };
    const wisp_boundary_view view = { .samples = &none, .edge_count = 3, .edges = edges };
    layer_cover cover;
    assert_int_equal( layer_find_cover( &view, &mesh, &cover, NULL ), WISP_OK );
    assert_true( fabs( cover.gap - 5.0 ) < 1e-6 );
    assert_true( fabs( cover.reach - 2.5 ) < 1e-6 ); // the middle of the longest side, equally far from all corners
}

TEST( the_sizes_of_the_case_are_those_of_the_contract )
{
    const boundary_plan plan = boundary_default_plan( &quick );
    assert_int_equal( plan.spacing_count, 5 );
    assert_true( plan.spacings[3] == 0.025f && plan.spacings[4] == 0.0125f );
    assert_int_equal( plan.worker_count, 2 );
}

static int make_results( void** state )
{
    static results all;
    wisp_error error = { 0 };
    const boundary_plan plan = small_plan();
    if ( boundary_bench_run( &plan, &all, &error ) != WISP_OK )
    {
        print_message( "%s\n", error.message );
        return -1;
    }
    *state = &all;
    return 0;
}

TEST_GROUP( make_results, free_results )
