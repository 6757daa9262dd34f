// A change of the level of detail neither jumps nor throws.
#include "detail_fixture.h"

typedef struct peaks
{
    float moved, changed; // m, largest displacement of a vertex in a step, and change of it from step to step
} peaks;

// Run to a change, and through it.
static peaks run_through( effect_setup* setup, wisp_detail from, wisp_detail to, int at )
{
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = setup != NULL ? add_effect( h.world, setup ) : add_sheet( h.world, true );
    wisp_detail_def def = wisp_default_detail_def();
    def.level = from;
    assert_status( h.world, wisp_set_detail( h.world, e, &def ), WISP_OK );
    run_steps( h.world, at, FRAME );
    float last = step_and_measure( h.world, e );
    def.level = to;
    assert_status( h.world, wisp_set_detail( h.world, e, &def ), WISP_OK );
    peaks p = { 0.0f, 0.0f };
    for ( int i = 0; i < 24; ++i )
    {
        const float moved = step_and_measure( h.world, e );
        assert_true( isfinite( moved ) );
        p.moved = fmaxf( p.moved, moved );
        p.changed = fmaxf( p.changed, fabsf( moved - last ) );
        last = moved;
    }
    close_world( &h );
    return p;
}

// A change makes no vertex much faster than it is at either level, nor changes its speed much more from one step to the next, besides
// slowing it down within the steps of the blend. A balloon that rests breathes by less than a hundredth of its radius in a step.
static void check_change( effect_setup* setup, wisp_detail from, wisp_detail to, int at )
{
    const peaks p = run_through( setup, from, to, at ), a = run_through( setup, from, from, at ),
                b = run_through( setup, to, to, at );
    const float moved = fmaxf( a.moved, b.moved ), changed = fmaxf( a.changed, b.changed );
    const float slows = to == WISP_DETAIL_NOTHING ? moved / 7.5f : 0.0f;
    const float starts = from == WISP_DETAIL_NOTHING ? 0.003f : 0.0f; // gravity, in a step
    if ( p.moved > 1.3f * moved + 0.002f || p.changed > 1.5f * changed + slows + starts + 0.002f )
    {
        fail_msg(
            "from %d to %d after %d steps: a vertex moves by %g m in a step and that changes by %g m; without a "
            "change by %g m and %g m",
            (int)from, (int)to, at, (double)p.moved, (double)p.changed, (double)moved, (double)changed );
    }
}

static void a_change_neither_jumps_nor_throws( void** state )
{
    (void)state;
    effect_setup* const setups[] = { NULL, cloth_of_links, implicit_cloth, hair_of_links, hair_of_rods, balloon };
    for ( int i = 0; i < 16 * WISP_COUNT( setups ); ++i )
    {
        const wisp_detail from = (wisp_detail)( i / 4 % 4 ), to = (wisp_detail)( i % 4 );
        const bool has_coarse = setups[i / 16] == NULL;
        const bool is_change =
            from != to && ( has_coarse || ( from != WISP_DETAIL_COARSE && to != WISP_DETAIL_COARSE ) );
        // what was never solved starts where the others began
        const bool has_peer = from != WISP_DETAIL_NOTHING;
        if ( is_change && has_peer )
        {
            check_change( setups[i / 16], from, to, 24 );
        }
    }
    check_change( NULL, WISP_DETAIL_FULL, WISP_DETAIL_COARSE, 46 );
    check_change( NULL, WISP_DETAIL_COARSE, WISP_DETAIL_FULL, 46 );
    check_change( NULL, WISP_DETAIL_FEWER_SUBSTEPS, WISP_DETAIL_FULL, 78 );
}

// In the last steps before nothing is solved it moves by little, while it would still fall.
static void what_comes_to_rest_becomes_slower( void** state )
{
    (void)state;
    effect_setup* const setups[] = { NULL, cloth_of_links, implicit_cloth, hair_of_links };
    for ( int k = 0; k < WISP_COUNT( setups ); ++k )
    {
        hosted h;
        open_levels( &h, 10, 1 );
        wisp_entity e[2];
        for ( int i = 0; i < 2; ++i )
        {
            e[i] = setups[k] != NULL ? add_effect( h.world, setups[k] ) : add_sheet( h.world, true );
        }
        run_steps( h.world, 4, FRAME );
        set_level( h.world, e[1], WISP_DETAIL_NOTHING );
        run_steps( h.world, 12, FRAME );
        int count;
        wisp_vec3* before = copy_points( h.world, e[0], &count );
        const float slow = step_and_measure( h.world, e[1] );
        const wisp_vec3* now = points_now( h.world, e[0], &count );
        float fast = 0.0f;
        for ( int v = 0; v < count; ++v )
        {
            fast = fmaxf( fast, distance( now[v], before[v] ) );
        }
        assert_true( slow < 0.5f * fast );
        run_steps( h.world, 2, FRAME );
        assert_float_equal( step_and_measure( h.world, e[1] ), 0.0f, 0.0f );
        free( before );
        close_world( &h );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_change_neither_jumps_nor_throws ),
        cmocka_unit_test( what_comes_to_rest_becomes_slower ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
