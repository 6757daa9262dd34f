// Level of detail: bits, snapshots, refusals.
#include "detail_fixture.h"

// ---- bits ----

enum
{
    MEMBERS = 4,
};

// Levels change all the time, in the middle of changes too.
static uint64_t run_bits( int workers, const char* isa, int snapshot_at )
{
    hosted h = { 0 };
    h.def = hosted_def( &h );
    h.def.modules = EFFECTS;
    h.def.module_count = WISP_COUNT( EFFECTS );
    h.def.workers = workers;
    h.def.isa = isa;
    assert_int_equal( wisp_world_create( &h.def, &h.world, NULL ), WISP_OK );
    const wisp_entity all[MEMBERS] = { add_sheet( h.world, true ), add_effect( h.world, cloth_of_links ),
                                       add_effect( h.world, hair_of_rods ), add_effect( h.world, balloon ) };
    for ( int step = 0; step < 90; ++step )
    {
        const int which = step % 9 == 0 ? step / 9 % MEMBERS : -1;
        if ( which >= 0 )
        {
            set_level( h.world, all[which], (wisp_detail)( which == 0 ? 2 - step / 36 : step / 9 % 2 == 0 ? 3 : 1 ) );
        }
        run_steps( h.world, 1, step % 7 == 3 ? 1.4f * FRAME : FRAME );
        if ( step == snapshot_at )
        {
            const saved_world saved = save_world( h.world );
            set_level( h.world, all[0], WISP_DETAIL_NOTHING );
            run_steps( h.world, 20, FRAME );
            assert_status( h.world, wisp_world_restore( h.world, saved.bytes, saved.size ), WISP_OK );
            free( saved.bytes );
            // steps are numbered on, which no state depends on
        }
    }
    const uint64_t hash = wisp_world_hash( h.world );
    close_world( &h );
    return hash;
}

static void bits_do_not_depend_on_workers_instruction_sets_nor_snapshots( void** state )
{
    (void)state;
    const uint64_t expected = run_bits( 1, "baseline", -1 );
    for ( int workers = 2; workers <= 5; ++workers )
    {
        assert_true( run_bits( workers, workers % 2 == 0 ? "avx2" : "avx512", -1 ) == expected );
    }
    for ( int step = 3; step < 90; step += 20 )
    {
        assert_true( run_bits( 1, "avx2", step ) == expected );
    }
}

static void a_snapshot_holds_the_level_and_its_change( void** state )
{
    (void)state;
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, false );
    set_level( h.world, e, WISP_DETAIL_FEWER_SUBSTEPS );
    run_steps( h.world, 2, FRAME );
    set_level( h.world, e, WISP_DETAIL_FULL );
    run_steps( h.world, 5, FRAME );
    assert_int_equal( substeps_of( h.world, e ), 3 + 7 * 5 / 15 );
    const saved_world saved = save_world( h.world );
    set_level( h.world, e, WISP_DETAIL_NOTHING );
    run_steps( h.world, 20, FRAME );
    assert_int_equal( substeps_of( h.world, e ), 1 );
    assert_status( h.world, wisp_world_restore( h.world, saved.bytes, saved.size ), WISP_OK );
    free( saved.bytes );
    assert_int_equal( wisp_detail_of( h.world, e ), WISP_DETAIL_FULL );
    assert_true( wisp_is_detail_blending( h.world, e ) );
    assert_int_equal( substeps_of( h.world, e ), 3 + 7 * 5 / 15 );
    close_world( &h );
}

static void full_detail_has_the_bits_of_none( void** state )
{
    (void)state;
    uint64_t hashes[2];
    for ( int k = 0; k < 2; ++k )
    {
        hosted h;
        open_levels( &h, 10, 1 );
        const wisp_entity e = add_sheet( h.world, true );
        if ( k == 1 )
        {
            set_level( h.world, e, WISP_DETAIL_FULL );
        }
        run_steps( h.world, 30, FRAME );
        assert_int_equal( count_passes_named( h.world, "detail.move" ), k );
        hashes[k] = hash_of( h.world, e, WISP_SURFACE_POINTS );
        close_world( &h );
    }
    assert_true( hashes[0] == hashes[1] );
}

// ---- refusals ----

static void what_has_no_detail_is_refused( void** state )
{
    (void)state;
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, false ), strands = add_effect( h.world, hair_of_rods );
    wisp_collider_def ball_def = wisp_default_collider_def();
    ball_def.radius = 0.1f;
    wisp_entity ball;
    assert_status( h.world, wisp_add_collider( h.world, &ball_def, &ball ), WISP_OK );
    const uint64_t before = wisp_world_hash( h.world );
    wisp_detail_def def = wisp_default_detail_def();
    assert_int_equal( def.level, WISP_DETAIL_FULL );
    assert_int_equal( def.substep_divisor, 4 );
    assert_int_equal( def.blend_steps, 15 );
    expect_refusal( h.world, wisp_set_detail( h.world, ball, &def ), WISP_CONFLICT,
                    "is neither a surface nor strands" );
    def.level = WISP_DETAIL_COARSE;
    expect_refusal( h.world, wisp_set_detail( h.world, e, &def ), WISP_CONFLICT,
                    "level coarse of entity 1: expected a surface with coarse sheets" );
    expect_refusal( h.world, wisp_set_detail( h.world, strands, &def ), WISP_CONFLICT, "strands that follow others" );
    def.level = (wisp_detail)4;
    expect_refusal( h.world, wisp_set_detail( h.world, e, &def ), WISP_BAD_INPUT, "level: got 4" );
    def = wisp_default_detail_def();
    def.substep_divisor = 0;
    expect_refusal( h.world, wisp_set_detail( h.world, e, &def ), WISP_BAD_INPUT, "substep_divisor: got 0" );
    def = wisp_default_detail_def();
    def.blend_steps = -1;
    expect_refusal( h.world, wisp_set_detail( h.world, e, &def ), WISP_BAD_INPUT, "blend_steps: got -1" );
    assert_int_equal( wisp_set_detail( h.world, ( wisp_entity ){ 99, 1 }, NULL ), WISP_BAD_INPUT );
    assert_true( wisp_world_hash( h.world ) == before );
    assert_int_equal( wisp_detail_of( NULL, e ), WISP_DETAIL_FULL );
    assert_int_equal( wisp_detail_of( h.world, ( wisp_entity ){ 99, 1 } ), WISP_DETAIL_FULL );
    assert_false( wisp_is_detail_blending( NULL, e ) );
    set_level( h.world, e, WISP_DETAIL_NOTHING );
    assert_int_equal( wisp_detail_of( h.world, e ), WISP_DETAIL_NOTHING );
    close_world( &h );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( bits_do_not_depend_on_workers_instruction_sets_nor_snapshots ),
        cmocka_unit_test( a_snapshot_holds_the_level_and_its_change ),
        cmocka_unit_test( full_detail_has_the_bits_of_none ),
        cmocka_unit_test( what_has_no_detail_is_refused ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
