// Levels of detail that solve less: fewer substeps, against worlds with so many; coarse sheets alone, against prolongation in double precision.
#include "detail_fixture.h"

// ---- fewer substeps ----

static uint64_t run_effect( effect_setup* setup, int substeps, wisp_detail level, int workers )
{
    hosted h;
    open_levels( &h, substeps, workers );
    const wisp_entity other = add_effect( h.world, hair_of_rods ), e = add_effect( h.world, setup );
    if ( level != WISP_DETAIL_FULL )
    {
        set_level( h.world, e, level ); // before the first step, so nothing is blended
    }
    run_steps( h.world, 40, FRAME );
    const uint64_t hash = hash_of( h.world, e, points_of( h.world, e ) );
    assert_true( hash_of( h.world, other, WISP_STRAND_POINTS ) != 0 );
    close_world( &h );
    return hash;
}

static void with_fewer_substeps_an_entity_moves_as_in_a_world_that_makes_so_many( void** state )
{
    (void)state;
    effect_setup* const setups[] = { cloth_of_links, dihedral_cloth, implicit_cloth,
                                     balloon,        hair_of_links,  hair_of_rods };
    for ( int i = 0; i < WISP_COUNT( setups ); ++i )
    {
        const uint64_t expected = run_effect( setups[i], 3, WISP_DETAIL_FULL, 1 );
        assert_true( run_effect( setups[i], 12, WISP_DETAIL_FEWER_SUBSTEPS, 1 + i % 3 ) == expected );
        assert_true( run_effect( setups[i], 12, WISP_DETAIL_FULL, 1 ) != expected );
        assert_true( run_effect( setups[i], 10, WISP_DETAIL_FEWER_SUBSTEPS, 1 ) == expected ); // 10 / 4 is rounded up
    }
}

// Run through a change of the level. Substeps go from one number to another in equal parts.
static void check_ramp( wisp_world* world, wisp_entity e, wisp_detail level, int from, int to )
{
    set_level( world, e, level );
    for ( int i = 1; i <= 15; ++i )
    {
        assert_true( wisp_is_detail_blending( world, e ) );
        run_steps( world, 1, FRAME );
        assert_int_equal( substeps_of( world, e ), from + ( to - from ) * i / 15 );
    }
    assert_false( wisp_is_detail_blending( world, e ) );
}

static void substeps_change_step_by_step( void** state )
{
    (void)state;
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, false ), other = add_sheet( h.world, false );
    run_steps( h.world, 1, FRAME );
    check_ramp( h.world, e, WISP_DETAIL_FEWER_SUBSTEPS, 10, 3 );
    assert_int_equal( substeps_of( h.world, other ), 10 );
    check_ramp( h.world, e, WISP_DETAIL_FULL, 3, 10 );
    // an entity that asks for more than the world: 40, and a quarter of them
    assert_status( h.world, wisp_set_substeps( h.world, e, 37 ), WISP_OK );
    run_steps( h.world, 1, FRAME );
    assert_int_equal( substeps_of( h.world, e ), 40 );
    set_level( h.world, e, WISP_DETAIL_FEWER_SUBSTEPS );
    run_steps( h.world, 15, FRAME );
    assert_int_equal( substeps_of( h.world, e ), 10 );
    close_world( &h );
}

// Steps of any length cover all of the time: a body in free fall is where it would be.
static void fewer_substeps_cover_all_of_the_time( void** state )
{
    (void)state;
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, false ), other = add_sheet( h.world, false );
    const int32_t pins[2] = { 0, SIDE - 1 };
    const wisp_entity both[2] = { e, other };
    for ( int k = 0; k < 2; ++k )
    {
        assert_status( h.world, wisp_unpin( h.world, both[k], pins, 2 ), WISP_OK );
        assert_status( h.world, wisp_set_damping( h.world, both[k], 0.0f ), WISP_OK );
        assert_status( h.world, wisp_set_gravity( h.world, both[k], ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), WISP_OK );
        assert_status( h.world,
                       wisp_set_velocity( h.world, both[k], ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f },
                                          ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ),
                       WISP_OK );
    }
    set_level( h.world, e, WISP_DETAIL_FEWER_SUBSTEPS );
    const float dts[] = { 0.016f, 0.016f, 0.021f, 0.009f, 0.033f, 0.017f, 0.0031f, 0.02f, 0.016f };
    for ( int i = 0; i < 5 * WISP_COUNT( dts ); ++i )
    {
        run_steps( h.world, 1, dts[i % WISP_COUNT( dts )] );
        int count;
        const wisp_vec3 a = points_now( h.world, e, &count )[40], b = points_now( h.world, other, &count )[40];
        assert_float_equal( a.x, b.x, 1e-5f );
    }
    close_world( &h );
}

// ---- coarse sheets alone ----

// Where the finest sheet takes a vertex, in double precision.
static void prolonged( const wisp_fabric* f, const float* position, int slot, double out[3] )
{
    const wisp_fabric_level* level = f->levels;
    out[0] = out[1] = out[2] = 0.0;
    for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
    {
        const size_t at = (size_t)( ( slot / 8 * WISP_FABRIC_PARENTS + k ) * 8 + slot % 8 );
        const float* parent = position + level->slot_x4[level->parent_x4[at] / 4];
        for ( int c = 0; c < 3; ++c )
        {
            out[c] += (double)level->weight[at] * (double)parent[c];
        }
    }
}

static double largest_offset( wisp_world* world, wisp_entity e )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    const float* position = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    double most = 0.0;
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        double on[3], square = 0.0;
        prolonged( f, position, slot, on );
        for ( int c = 0; c < 3 && f->slot_vertex[slot] >= 0 && position[4 * slot + 3] > 0.0f; ++c )
        {
            const double d = (double)position[4 * slot + c] - on[c];
            square += d * d;
        }
        most = square > most ? square : most;
    }
    return sqrt( most );
}

static double rms_distance( wisp_world* world, wisp_entity a, wisp_entity b )
{
    int count;
    const wisp_vec3 *p = points_now( world, a, &count ), *q = points_now( world, b, &count );
    double sum = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        const double d = (double)distance( p[v], q[v] );
        sum += d * d;
    }
    return sqrt( sum / count );
}

static void coarse_sheets_alone_carry_a_surface( void** state )
{
    (void)state;
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true ), full = add_sheet( h.world, true );
    assert_true( wisp_world_fabric( h.world, e )->level_count > 0 );
    run_steps( h.world, 20, FRAME );
    assert_true( largest_offset( h.world, e ) > 1e-3 ); // wrinkles
    set_level( h.world, e, WISP_DETAIL_COARSE );
    double before = largest_offset( h.world, e );
    const double first = before;
    for ( int i = 0; i < 60; ++i )
    {
        run_steps( h.world, 1, FRAME );
        const double now = largest_offset( h.world, e );
        assert_true( now <= before + 1e-6 ); // rounding
        assert_true( i > 0 || now > 0.5 * before );
        before = now;
        assert_true( i >= 30 || rms_distance( h.world, e, full ) < 0.05 );
    }
    assert_true( before < 0.05 * first );
    // the passes of the other sheet alone: ten substeps of it
    assert_int_equal( items_of( h.world, "links.xpbd" ), 10 );
    assert_int_equal( items_of( h.world, "surface.levels" ), 10 + 3 );
    close_world( &h );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( with_fewer_substeps_an_entity_moves_as_in_a_world_that_makes_so_many ),
        cmocka_unit_test( substeps_change_step_by_step ),
        cmocka_unit_test( fewer_substeps_cover_all_of_the_time ),
        cmocka_unit_test( coarse_sheets_alone_carry_a_surface ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
