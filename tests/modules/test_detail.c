// Level of detail: what runs at each level, against worlds with fewer substeps and prolongation in double precision; and that a change
// neither jumps nor throws.
#include "detail_fixture.h"
#include "saved_world.h"

// ---- fewer substeps ----

static int substeps_of( wisp_world* world, wisp_entity e )
{
    int substeps;
    assert_status( world, wisp_read_substeps( world, e, &substeps ), WISP_OK );
    return substeps;
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

TEST( coarse_sheets_alone_carry_a_surface )
{
    SCOPED( close_world ) hosted h;
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
}

// ---- changes ----

typedef struct peaks
{
    float moved, changed; // m, largest displacement of a vertex in a step, and change of it from step to step
} peaks;

// Run to a change, and through it.
static peaks run_through( effect_setup* setup, wisp_detail from, wisp_detail to, int at )
{
    SCOPED( close_world ) hosted h;
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

TEST( a_change_neither_jumps_nor_throws )
{
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

// ---- snapshots ----

TEST( a_snapshot_holds_the_level_and_its_change )
{
    SCOPED( close_world ) hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, false );
    set_level( h.world, e, WISP_DETAIL_FEWER_SUBSTEPS );
    run_steps( h.world, 2, FRAME );
    set_level( h.world, e, WISP_DETAIL_FULL );
    run_steps( h.world, 1, FRAME );
    const uint64_t plans = wisp_world_counter( h.world, WISP_COUNT_PLANS );
    run_steps( h.world, 4, FRAME );
    assert_int_equal( substeps_of( h.world, e ), 3 + 7 * 5 / 15 );
    assert_int_equal( wisp_world_counter( h.world, WISP_COUNT_PLANS ), plans ); // other substeps, the same plan
    const saved_world saved = save_world( h.world );
    set_level( h.world, e, WISP_DETAIL_NOTHING );
    run_steps( h.world, 20, FRAME );
    assert_int_equal( substeps_of( h.world, e ), 1 );
    assert_status( h.world, wisp_world_restore( h.world, saved.bytes, saved.size ), WISP_OK );
    free( saved.bytes );
    assert_int_equal( wisp_detail_of( h.world, e ), WISP_DETAIL_FULL );
    assert_true( is_blending( h.world, e ) );
    assert_int_equal( substeps_of( h.world, e ), 3 + 7 * 5 / 15 );
}

TEST( a_damaged_row_is_refused )
{
    SCOPED( close_world ) hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    set_level( h.world, e, WISP_DETAIL_NOTHING );
    run_steps( h.world, 2, FRAME );
    const wisp_component component = wisp_world_find_component( h.world, "detail.state" );
    const int32_t damages[][2] = { { 0, 99 }, { 1, -1 }, { 2, 4 },  { 3, 0 },
                                   { 4, -7 }, { 5, -1 }, { 6, -1 }, { 7, -1 } }; // a field, and its value
    for ( int i = 0; i < WISP_COUNT( damages ); ++i )
    {
        int32_t* field = (int32_t*)wisp_world_column( h.world, e, component, 0 ) + damages[i][0];
        const int32_t was = *field;
        *field = damages[i][1];
        const saved_world saved = save_world( h.world );
        *field = was;
        assert_status( h.world, wisp_world_restore( h.world, saved.bytes, saved.size ), WISP_BAD_INPUT );
        free( saved.bytes );
        assert_int_equal( wisp_detail_of( h.world, e ), WISP_DETAIL_NOTHING );
        run_steps( h.world, 1, FRAME );
    }
}

// A change that is set again with fewer steps ends with them, and a snapshot of it is one that a world could have left.
TEST( a_change_that_is_set_again_with_fewer_steps_ends_earlier )
{
    SCOPED( close_world ) hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    run_steps( h.world, 5, FRAME );
    set_level( h.world, e, WISP_DETAIL_FEWER_SUBSTEPS );
    run_steps( h.world, 10, FRAME );
    assert_true( is_blending( h.world, e ) );
    set_level_at_once( h.world, e, WISP_DETAIL_FEWER_SUBSTEPS );
    assert_false( is_blending( h.world, e ) );
    const saved_world saved = save_world( h.world );
    assert_status( h.world, wisp_world_restore( h.world, saved.bytes, saved.size ), WISP_OK );
    free( saved.bytes );
    assert_int_equal( wisp_detail_of( h.world, e ), WISP_DETAIL_FEWER_SUBSTEPS );
}

// ---- refusals ----

TEST( what_has_no_detail_is_refused )
{
    SCOPED( close_world ) hosted h;
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
    assert_int_equal( wisp_set_detail( h.world, ( wisp_entity ){ 99, 1 }, NULL ), WISP_BAD_INPUT );
    assert_true( wisp_world_hash( h.world ) == before );
    assert_int_equal( wisp_detail_of( NULL, e ), WISP_DETAIL_FULL );
    assert_int_equal( wisp_detail_of( h.world, ( wisp_entity ){ 99, 1 } ), WISP_DETAIL_FULL );
    set_level( h.world, e, WISP_DETAIL_NOTHING );
    assert_int_equal( wisp_detail_of( h.world, e ), WISP_DETAIL_NOTHING );
}
