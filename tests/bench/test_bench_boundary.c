// The case `boundary` at very small sizes: its checks hold, its tables have the columns of the contract, and errors
// are detected.
#include "bench_tables.h"

#include "boundary_bench.h"
#include "boundary_cover.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

static const bench_options quick = { .quick = true, .workers = 2 };

static boundary_plan small_plan( void )
{
    return ( boundary_plan ){
        .spacings = { 0.2f, 0.1f },
        .spacing_count = 2,
        .segments = { 8, 15 },
        .sphere_count = 2,
        .pulse_steps = LAYER_PERIOD,
        .settle_steps = 60,
        .hang_seconds = 0.2,
        .workers = { 1, 2 },
        .worker_count = 2,
        .picture_side = 40,
        .options = &quick,
    };
}

TEST( no_check_of_the_case_fails )
{
    const results* all = *state;
    expect_good( all );
    assert_fits_terminal( all );
    assert_column( find_table( all, "Inflation" ), "met", "yes" );
    assert_column( find_table( all, "Volume" ), "met", "yes" );
    assert_column( find_table( all, "Edge points" ), "met", "yes" );
    assert_column( find_table( all, "Inner points" ), "met", "yes" );
    assert_column( find_table( all, "Normals" ), "met", "yes" );
    assert_column( find_table( all, "Coverage against cost" ), "met", "yes" );
}

TEST( counts_stand_beside_those_of_the_contract )
{
    const results_table* table = find_table( *state, "Points of the reference sphere" );
    assert_int_equal( table->row_count, 1 + 2 * LAYER_LAWS );
    assert_column( table, "exact", "yes" );
    assert_column( table, "same", "yes" );
    const int edge = column_of( table, "edge" ), inner = column_of( table, "inner" ), by = column_of( table, "by" );
    // table of the README of the boundary particle paper: 0.2 even and exact, then 0.1
    assert_string_equal( cell( table, 1, edge ), "930" );
    assert_string_equal( cell( table, 2, edge ), "3360" );
    assert_string_equal( cell( table, 1 + LAYER_LAWS, edge ), "5160" );
    assert_string_equal( cell( table, 1 + LAYER_LAWS, inner ), "300" );
    assert_string_equal( cell( table, 2 + LAYER_LAWS, inner ), "3480" );
    assert_string_equal( cell( table, 2 + LAYER_LAWS, by ), "contract" );
    assert_string_equal( cell( table, LAYER_LAWS, by ), "oracle" );
}

TEST( edges_have_a_line_a_law )
{
    const results_table* table = find_table( *state, "Edge points" );
    assert_int_equal( table->row_count, 1 + LAYER_LAWS );
    assert_string_equal( cell( table, 1, 6 ), "0, 0, 0, 1, 2" );
    assert_string_equal( cell( table, 2, 6 ), "0, 0, 1, 1, 3" );
}

TEST( a_pulse_changes_more_than_standing_still_and_less_than_everything )
{
    const results_table* table = find_table( *state, "Pulsating radius" );
    const int changed = column_of( table, "in case B, %" );
    assert_string_equal( cell( table, 1, 0 ), "still" );
    assert_string_equal( cell( table, 1, changed ), "0.00" );
    assert_string_equal( cell( table, 2, 0 ), "all resampled" );
    assert_string_equal( cell( table, 2, changed ), "100.00" );
    double fraction = 0.0;
    assert_int_equal( sscanf( cell( table, 9, changed ), "%lf", &fraction ), 1 ); // 10 %, no hysteresis
    assert_true( fraction > 0.0 && fraction < 100.0 );
    // without hysteresis a layer is a function of the positions, which are those of the start again
    const int hash = column_of( table, "hash" );
    assert_string_equal( cell( table, 9, hash ), cell( table, 1, hash ) );
}

TEST( long_steps_and_strong_gravity_have_a_line_each_and_a_layer_changes_nothing )
{
    const results_table* table = find_table( *state, "Long steps" );
    assert_int_equal( table->row_count, 1 + 15 );
    assert_column( table, "finite", "yes" );
    assert_column( table, "same without a layer", "yes" );
}

TEST( rows_for_machines_are_there_for_every_worker_count )
{
    const results* all = *state;
    assert_int_equal( count_rows( all, "boundary", "even, in place" ), 2 * 2 );
    assert_int_equal( count_rows( all, "boundary", "exact, resampled" ), 2 * 2 );
    assert_int_equal( count_rows( all, "boundary", "inflate 1-2-1" ), 1 );
    assert_int_equal( count_rows( all, "boundary", "normals" ), 2 );
    assert_int_equal( count_rows( all, "boundary", "hang" ), 15 );
    assert_int_equal( count_rows( all, "boundary", "pulse" ), 9 );
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

typedef struct one_layer
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    layer_implementation implementation;
    wisp_boundary_def def;
} one_layer;

// With 11 slices no edge is a whole number of tenths of a metre long; with 10 some are, up to rounding.
static one_layer open_layer( float spacing )
{
    wisp_error error = { 0 };
    one_layer l = { .def = layer_def( &layer_laws[0], spacing ) };
    assert_ok( layer_sphere( 11, 1.0f, &l.mesh, &error ), error );
    assert_ok( layer_cook( &l.mesh, &l.fabric, &error ), error );
    assert_ok( layer_enter( l.fabric, &l.def, 1, &l.implementation, &error ), error );
    assert_ok( layer_step( &l.implementation, &error ), error );
    return l;
}

static void close_layer( one_layer* l )
{
    surface_implementation_destroy( &l->implementation.surface );
    wisp_fabric_release( l->fabric );
    wisp_mesh_release( &l->mesh );
}

static layer_check check_of( one_layer* l, const wisp_boundary_def* def )
{
    wisp_error error = { 0 };
    layer_check check;
    assert_ok( layer_compare( &l->implementation.surface, &l->mesh, def, &check, &error ), error );
    return check;
}

TEST( points_that_are_not_on_the_surface_or_not_as_many_are_seen )
{
    one_layer l = open_layer( 0.1f );
    layer_check check = check_of( &l, &l.def );
    assert_true( check.inner_points > 0 );
    assert_true( layer_check_is_met( &check ) );

    const wisp_boundary_def finer = layer_def( &layer_laws[0], 0.09f );
    check = check_of( &l, &finer );
    assert_false( layer_check_is_met( &check ) );
    assert_true( isinf( check.farthest ) );

    // a vertex that moves after the step leaves its points behind; a move this small changes no count
    float* x = wisp_world_column( l.implementation.surface.world, l.implementation.surface.entity,
                                  WISP_PARTICLE_POSITION, 0 );
    x[4 * (size_t)l.fabric->vertex_slot[l.mesh.vertex_count / 2]] += 1e-4f;
    check = check_of( &l, &l.def );
    assert_false( layer_check_is_met( &check ) );
    assert_true( check.farthest > 1e-6 && check.farthest < 1e-3 );
    close_layer( &l );
}

TEST( resampling_is_of_all_elements_and_gives_the_same_points )
{
    wisp_error error = { 0 };
    one_layer l = open_layer( 0.1f );
    wisp_boundary_view view;
    wisp_boundary_stats stats;
    assert_int_equal( layer_read( &l.implementation.surface, &view, &error ), WISP_OK );
    const uint64_t hash = layer_hash( &view );
    for ( int is_resampled = 0; is_resampled < 2; ++is_resampled )
    {
        l.implementation.is_resampled = is_resampled == 1;
        assert_int_equal( layer_step( &l.implementation, &error ), WISP_OK );
        assert_int_equal( layer_read( &l.implementation.surface, &view, &error ), WISP_OK );
        assert_int_equal( layer_read_stats( &l.implementation.surface, &stats, &error ), WISP_OK );
        assert_int_equal( stats.changed_elements, is_resampled == 1 ? stats.elements : 0 );
        assert_true( layer_hash( &view ) == hash );
    }
    close_layer( &l );
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
    assert_int_equal( layer_find_edge( &view, 2, 1 ), 2 );
}

TEST( pictures_are_written_where_there_is_a_folder )
{
    static const char* const names[] = { "./boundary_body.png", "./boundary_inflation.png",
                                         "./boundary_spacing.png" };
    bench_options options = quick;
    boundary_plan plan = small_plan();
    results all = { 0 };
    wisp_error error = { 0 };
    plan.options = &options;
    assert_int_equal( boundary_pictures( &plan, &all, &error ), WISP_OK );
    assert_int_equal( all.note_count, 0 );
    options.pictures = ".";
    assert_ok( boundary_pictures( &plan, &all, &error ), error );
    assert_int_equal( all.note_count, 3 );
    for ( int i = 0; i < 3; ++i )
    {
        assert_int_equal( remove( names[i] ), 0 );
    }
    options.pictures = "no such folder";
    assert_int_equal( boundary_pictures( &plan, &all, &error ), WISP_IO_ERROR );
    results_free( &all );
}

TEST( the_sizes_of_the_case_are_those_of_the_contract )
{
    const boundary_plan plan = boundary_default_plan( &quick );
    assert_int_equal( plan.spacing_count, 5 );
    assert_true( plan.spacings[3] == 0.025f && plan.spacings[4] == 0.0125f );
    assert_int_equal( plan.pulse_steps % LAYER_PERIOD, 0 );
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
