// The cases `paper` and `boundary` in quick runs: no check of them fails, and rows have what their tables in the documents are made
// of. A part of their checks.
#include "bench_tables.h"

#include "boundary_bench.h"

#include "bench.h"

static const bench_options quick = { .quick = true, .seconds = 0.01, .workers = 2 };

bench_case_fn boundary_bench, paper_bench;

static const results_row* row_with( const results* all, const char* variant )
{
    const results_row* found = NULL;
    for ( int i = 0; i < all->row_count; ++i )
    {
        found = strcmp( all->rows[i].variant, variant ) == 0 ? all->rows + i : found;
    }
    assert_non_null( found );
    return found;
}

static void run_quick( bench_case_fn* run, results* all )
{
    wisp_error error = { 0 };
    assert_ok( run( &quick, all, &error ), error );
    expect_good( all );
    assert_fits_terminal( all );
}

TEST( tables_of_the_papers_have_times_by_workers_errors_links_and_iterations )
{
    SCOPED( results_free ) results all = { .failed = false };
    run_quick( paper_bench, &all );
    assert_int_equal( count_rows( &all, "accuracy.frozen_hair", "500 strands" ), 2 );
    assert_int_equal( count_rows( &all, "accuracy.frozen_hair", "50000 strands" ), 0 );
    const results_table* times = find_table( &all, "Accuracy `frozen_hair`: frozen hair, Table 1" );
    const int smallest = row_of( times, "100 strands" );
    const double frames = strtod( named_cell( times, smallest, "FPS" ), NULL ),
                 ms = strtod( named_cell( times, smallest, "2 workers ms" ), NULL );
    assert_string_equal( named_cell( times, smallest, "paper, FPS" ), "147" );
    assert_true( fabs( frames * ms - 1e3 ) < 10.0 );
    const results_values* hair = &row_with( &all, "500 strands" )->error;
    assert_true( value_of( hair, "distance_to_the_oracle_um" ) < 1.0 &&
                 value_of( hair, "neighbours_per_vertex" ) > 10.0 );
    const results_row* quads = row_with( &all, "quads, 625 vertices, k_s 200" );
    assert_int_equal( count_rows( &all, "suite.triangle_cloth", quads->variant ), 2 );
    // 2400 first and 2160 second neighbours of 25 x 25
    assert_true( value_of( &quads->error, "links" ) == 4560.0 && value_of( &quads->error, "unsolved" ) == 0.0 );
    assert_true( value_of( &quads->error, "iterations_mean" ) > 1.0 );
    assert_true( value_of( &quads->error, "ns_per_vertex_and_iteration" ) > 0.0 && quads->ms_median > 0.0 );
    assert_true( has_note( &all, "with 2 workers is a line, R^2 above 0.98" ) );
}

TEST( rows_of_boundary_points_are_there_for_every_worker_count )
{
    SCOPED( results_free ) results all = { .failed = false };
    run_quick( boundary_bench, &all );
    assert_int_equal( count_rows( &all, "accuracy.boundary", "even, in place, d 0.2" ), 2 );
    assert_int_equal( count_rows( &all, "accuracy.boundary", "exact, resampled, d 0.05" ), 2 );
    const results_row* row = row_with( &all, "even, in place, d 0.05" );
    assert_true( row->has_hash && row->steps >= 3 && row->ms_p10 <= row->ms_median && row->ms_median <= row->ms_p90 );
    assert_true( value_of( &row->error, "points" ) == 26370.0 && value_of( &row->error, "edge_points" ) == 14730.0 );
}

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
