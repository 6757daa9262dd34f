// `wisp bench cloth --compare` at very small sizes: its untrusted reference files, and the content of its tables.
#include "bench_tables.h"
#include "files.h"

#include "compare_bench.h"

static const bench_options quick = { .quick = true, .workers = 2 };

// ---- reference files ----

enum
{
    VERTICES = 5,
    OBSERVATIONS = 3,
};

static const char file_name[] = "test_bench_compare.reference";

typedef struct file_bytes
{
    unsigned char* bytes;
    size_t size;
} file_bytes;

static compare_reference small_reference( float* points )
{
    compare_reference reference = { .scenario = COMPARE_TAUT,
                                    .vertex_count = VERTICES,
                                    .observation_count = OBSERVATIONS,
                                    .mesh_hash = 0x0123456789abcdefull,
                                    .rate = 8000.0,
                                    .rest_rate = 400.0,
                                    .order = 2.0,
                                    .residual = 1e-11,
                                    .points = points };
    const compare_physics physics = compare_physics_of( COMPARE_TAUT );
    compare_reference_info( &physics, reference.info );
    for ( int i = 0; i < OBSERVATIONS * VERTICES * 3; ++i )
    {
        points[i] = 0.1f * (float)i - 1.0f;
    }
    for ( int k = 0; k < OBSERVATIONS; ++k )
    {
        reference.observations[k] = ( compare_reference_observation ){ .time = 0.05 * k,
                                                                       .observation = { 1.0, 0.1 * k, -2.0, k },
                                                                       .uncertainty = 1e-6 };
    }
    return reference;
}

static file_bytes written( const compare_reference* reference )
{
    wisp_error error = { 0 };
    file_bytes file = { .size = 0 };
    assert_ok( compare_reference_write( reference, file_name, &error ), error );
    file.bytes = read_bytes( file_name, &file.size );
    remove( file_name );
    return file;
}

static void expect_refused( const unsigned char* bytes, size_t size, const char* part )
{
    // a block of exactly this size, so that the sanitizer detects a byte that is read beyond it
    unsigned char* copy = checked_malloc( size > 0 ? size : 1 );
    memcpy( copy, bytes, size );
    compare_reference reference;
    wisp_error error = { 0 };
    assert_int_equal( compare_reference_parse( copy, size, "given.reference", &reference, &error ), WISP_BAD_INPUT );
    assert_null( reference.points );
    assert_ptr_equal( strstr( error.message, "given.reference: " ), error.message );
    assert_contains( error.message, part );
    free( copy );
}

static void a_reference_comes_back_as_it_was_written( void** state )
{
    (void)state;
    float points[OBSERVATIONS * VERTICES * 3];
    const compare_reference reference = small_reference( points );
    wisp_error error = { 0 };
    compare_reference back;
    assert_ok( compare_reference_write( &reference, file_name, &error ), error );
    assert_ok( compare_reference_read( file_name, &back, &error ), error );
    remove( file_name );
    assert_int_equal( back.scenario, reference.scenario );
    assert_int_equal( back.vertex_count, VERTICES );
    assert_int_equal( back.observation_count, OBSERVATIONS );
    assert_true( back.mesh_hash == reference.mesh_hash && back.rate == reference.rate &&
                 back.rest_rate == reference.rest_rate );
    assert_true( back.order == reference.order && back.residual == reference.residual );
    assert_memory_equal( back.info, reference.info, sizeof( reference.info ) );
    assert_memory_equal( back.observations, reference.observations, sizeof( reference.observations ) );
    assert_memory_equal( back.points, points, sizeof( points ) );
    compare_reference_free( &back );
}

static void a_reference_that_is_cut_off_anywhere_is_refused( void** state )
{
    (void)state;
    float points[OBSERVATIONS * VERTICES * 3];
    const compare_reference reference = small_reference( points );
    file_bytes file = written( &reference );
    assert_int_equal( file.size, 160 + OBSERVATIONS * ( 48 + 12 * VERTICES ) + 8 );
    for ( size_t size = 0; size < file.size; ++size )
    {
        expect_refused( file.bytes, size, size < 168 ? "too few for a reference" : "bytes, there are" );
    }
    free( file.bytes );
}

static void a_reference_with_a_wrong_byte_is_refused_wherever_it_is( void** state )
{
    (void)state;
    float points[OBSERVATIONS * VERTICES * 3];
    const compare_reference reference = small_reference( points );
    file_bytes file = written( &reference );
    for ( size_t at = 0; at < file.size; ++at )
    {
        const char* part = at < 8    ? "this is no reference file"
                           : at < 16 ? "are not known"
                           : at < 24 ? ""
                                     : "checksum";
        // the lowest bit of `scenario` gives another valid one
        part = at == 12 ? "checksum" : part;
        file.bytes[at] ^= 1u;
        expect_refused( file.bytes, file.size, part );
        file.bytes[at] ^= 1u;
    }
    free( file.bytes );
}

static void counts_that_are_out_of_range_or_not_those_of_the_file_are_refused( void** state )
{
    (void)state;
    static const struct
    {
        size_t at;
        unsigned char value[4];
        const char* part;
    } wrong[] = {
        { 16, { 0, 0, 0, 0 }, "0 vertices" },
        { 16, { 255, 255, 255, 255 }, "4294967295 vertices" },
        { 16, { 1, 0, 1, 0 }, "65537 vertices" },
        { 20, { 0, 0, 0, 0 }, "0 samples" },
        { 20, { 255, 255, 255, 127 }, "out of range" },
        { 16, { 6, 0, 0, 0 }, "3 samples of 6 vertices take" },
        { 20, { 4, 0, 0, 0 }, "4 samples of 5 vertices take" },
    };
    float points[OBSERVATIONS * VERTICES * 3];
    const compare_reference reference = small_reference( points );
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        file_bytes file = written( &reference );
        memcpy( file.bytes + wrong[i].at, wrong[i].value, 4 );
        expect_refused( file.bytes, file.size, wrong[i].part );
        free( file.bytes );
    }
}

static void numbers_that_no_cloth_has_are_refused_by_observation( void** state )
{
    (void)state;
    for ( int kind = 0; kind < 5; ++kind )
    {
        float points[OBSERVATIONS * VERTICES * 3];
        compare_reference reference = small_reference( points );
        points[VERTICES * 3 + 2] = kind == 0 ? NAN : kind == 1 ? INFINITY : kind == 2 ? -2e6f : 0.0f;
        reference.observations[1].observation.energy = kind == 3 ? (double)NAN : 0.0;
        reference.observations[1].time = kind == 4 ? 0.0 : 0.05;
        file_bytes file = written( &reference );
        expect_refused( file.bytes, file.size, "sample 1 has a number that is out of range" );
        free( file.bytes );
    }
}

static void a_reference_of_another_cloth_is_refused( void** state )
{
    (void)state;
    compare_scene scene;
    wisp_error error = { 0 };
    assert_ok( compare_scene_make( COMPARE_TAUT, 64, &scene, &error ), error );
    compare_reference reference = { .vertex_count = 64,
                                    .observation_count = scene.physics.observation_count + 1,
                                    .mesh_hash = scene.hash };
    compare_reference_info( &scene.physics, reference.info );
    assert_ok( compare_reference_check( &reference, &scene, "t", &error ), error );
    reference.info[0] *= 2.0;
    assert_int_equal( compare_reference_check( &reference, &scene, "t", &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "another material or scene than `taut`" ) );
    reference.info[0] *= 0.5;
    reference.mesh_hash ^= 1;
    assert_int_equal( compare_reference_check( &reference, &scene, "t", &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "another mesh, of 64 vertices" ) );
    compare_scene_free( &scene );
}

static void a_reference_that_is_not_there_is_a_message( void** state )
{
    (void)state;
    compare_plan plan = compare_default_plan( &quick );
    plan.folder = "no_such_folder";
    results all = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( compare_bench_run( &plan, &all, &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "no_such_folder/drape.reference: " ) );
    results_free( &all );
}

// ---- the comparison ----

static compare_plan small_plan( compare_scenario scenario )
{
    static const int rates[] = { 100, 200, 400 };
    compare_plan plan = compare_default_plan( &quick );
    plan.scenarios[0] = scenario;
    plan.scenario_count = 1;
    plan.variant_count = 0;
    compare_add_variant( &plan, ( compare_variant ){ .method = COMPARE_PBD, .substeps = 5, .stiffness = 1.0f } );
    compare_add_variant( &plan, ( compare_variant ){ .method = COMPARE_XPBD, .substeps = 5 } );
    compare_add_variant( &plan, ( compare_variant ){ .method = COMPARE_XPBD, .substeps = 20 } );
    for ( int i = 0; i < 2 * WISP_COUNT( rates ); ++i )
    {
        compare_add_variant( &plan, ( compare_variant ){ .method = COMPARE_IMPLICIT,
                                                         .rate = rates[i / 2],
                                                         .bdf2 = i % 2 == 1,
                                                         .tolerance = 1e-4f,
                                                         .repeats = 1 } );
    }
    return plan;
}

static double error_of( const results* all, const char* variant )
{
    for ( int r = 0; r < all->row_count; ++r )
    {
        if ( strcmp( all->rows[r].variant, variant ) == 0 )
        {
            return value_of( &all->rows[r].error, "path_rms_m" );
        }
    }
    fail_msg( "there is no row '%s'", variant );
    return NAN;
}

static results compared( const compare_plan* plan )
{
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( compare_bench_run( plan, &all, &error ), error );
    assert_false( all.failed );
    return all;
}

static void the_tables_are_whole( void** state )
{
    (void)state;
    compare_plan plan = small_plan( COMPARE_TAUT );
    plan.variants[1].has_rest = true;
    results all = compared( &plan );
    const results_table* table = find_table( &all, "Comparison `taut`: " );
    assert_int_equal( table->row_count, 1 + 1 + plan.variant_count );
    assert_int_equal( find_table( &all, "Comparison `taut`, at equal time" )->row_count, 1 + 4 );
    assert_int_equal( find_table( &all, "Comparison `taut`, at equal error" )->row_count, 1 + 4 );
    assert_int_equal( all.row_count, 2 * plan.variant_count );
    for ( int r = 0; r < all.row_count; ++r )
    {
        const results_row* row = &all.rows[r];
        assert_string_equal( row->name, "cloth.compare.taut" );
        assert_string_equal( row->variant, plan.variants[r / 2].name );
        assert_string_equal( row->error_reference, "Newton in double" );
        assert_int_equal( row->workers, plan.workers[r % 2] );
        assert_true( row->has_hash && row->ms_median > 0.0 && row->steps > 0 );
        const double path = value_of( &row->error, "path_rms_m" );
        assert_true( path > 0.0 && path <= value_of( &row->error, "worst_observation_rms_m" ) );
    }
    assert_true( value_of( &all.rows[2].error, "rest_strain" ) > 0.0 );
    results_free( &all );
}

// xpbd converges to the same model here, so no error has a floor.
static void errors_of_the_taut_cloth_fall_with_the_step( void** state )
{
    (void)state;
    const compare_plan plan = small_plan( COMPARE_TAUT );
    results all = compared( &plan );
    const double euler[] = { error_of( &all, "implicit 1/100, Euler, 0.0001, 1" ),
                             error_of( &all, "implicit 1/200, Euler, 0.0001, 1" ),
                             error_of( &all, "implicit 1/400, Euler, 0.0001, 1" ) };
    // at first order half the step is half the error in the end; here at most three quarters
    assert_true( euler[1] < 0.75 * euler[0] && euler[2] < 0.75 * euler[1] );
    assert_true( error_of( &all, "implicit 1/200, BDF2, 0.0001, 1" ) < 0.5 * euler[1] );
    assert_true( error_of( &all, "xpbd 20" ) < 0.5 * error_of( &all, "xpbd 5" ) );
    results_free( &all );
}

static void errors_of_the_draped_cloth_fall_with_the_step( void** state )
{
    (void)state;
    const compare_plan plan = small_plan( COMPARE_DRAPE );
    results all = compared( &plan );
    const double coarse = error_of( &all, "implicit 1/100, Euler, 0.0001, 1" );
    const double fine = error_of( &all, "implicit 1/400, Euler, 0.0001, 1" );
    // a quarter of the step; at first order that is a quarter of the error, before folds dominate
    assert_true( fine < 0.5 * coarse );
    results_free( &all );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_reference_comes_back_as_it_was_written ),
        cmocka_unit_test( a_reference_that_is_cut_off_anywhere_is_refused ),
        cmocka_unit_test( a_reference_with_a_wrong_byte_is_refused_wherever_it_is ),
        cmocka_unit_test( counts_that_are_out_of_range_or_not_those_of_the_file_are_refused ),
        cmocka_unit_test( numbers_that_no_cloth_has_are_refused_by_observation ),
        cmocka_unit_test( a_reference_of_another_cloth_is_refused ),
        cmocka_unit_test( a_reference_that_is_not_there_is_a_message ),
        cmocka_unit_test( the_tables_are_whole ),
        cmocka_unit_test( errors_of_the_taut_cloth_fall_with_the_step ),
        cmocka_unit_test( errors_of_the_draped_cloth_fall_with_the_step ),
    };
    return cmocka_run_group_tests_name( "bench compare", tests, NULL, NULL );
}
