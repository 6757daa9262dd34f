// Moving strands in the engine, in single precision, compared with the oracle, in double, substep by substep: fifteen
// strands of 1, 2, 3, 9 and 20 vertices, crooked, curled and straight, that fill one group of lanes. Strands that integrate
// with BDF2: order, energy, and where a strand goes back to implicit Euler.
#include "strand_duel_fixture.h"
#include "strands_fixture.h"

// m. Positions are 0.125 m at most, so each is rounded by 4e-9 m; a vertex has about ten roundings per substep. The
// velocity keeps the error of a substep, so this is allowed once for each substep so far. The tolerance of a stiff
// comparison is larger: the solve of the rod amplifies errors of its right-hand side.
static const double A_SUBSTEP = 5e-8;

static void assert_together( match* m, int behind, double tolerance )
{
    int strand = -1, vertex = -1;
    const double most = apart( m, &strand, &vertex );
    if ( !( most <= tolerance ) )
    {
        fail_msg(
            "%s: vertex %d of strand %d (%d vertices) is %.3g m from the oracle behind %d substeps of %d a step, "
            "allowed %.3g",
            m->rules->name, vertex, strand, COUNTS[strand], most, behind, m->substeps, tolerance );
    }
}

// Once with one substep per step, compared after each; once with all substeps in one step, where the head is between
// its poses in all but the last.
static void run_duel( const duel* rules )
{
    const double ease = rules->ease > 0.0 ? rules->ease : 1.0;
    match* m = open_match( rules, 1, 0.2f );
    for ( int k = 0; k < SUBSTEPS; ++k )
    {
        step_both( m, k );
        assert_together( m, k + 1, ease * A_SUBSTEP * ( k + 1 ) );
    }
    close_match( m );
    m = open_match( rules, SUBSTEPS, 0.2f );
    step_both( m, 0 );
    assert_together( m, SUBSTEPS, ease * A_SUBSTEP * SUBSTEPS );
    close_match( m );
}

static void run_duels( const duel* duels, int count )
{
    for ( int k = 0; k < count; ++k )
    {
        run_duel( duels + k );
    }
}

// ---- lengths ----

#define CHAIN .bend = WISP_STRAND_BEND_NONE, .dt = SLOW
#define LINKS .bend = WISP_STRAND_BEND_LINKS, .dt = SLOW

TEST( direct_lengths_go_with_the_oracle )
{
    const duel duels[] = {
        { "direct", WISP_STRAND_STRETCH_DIRECT, CHAIN },
        { "direct, two iterations", WISP_STRAND_STRETCH_DIRECT, CHAIN, .iterations = 2 },
        { "direct, pinned", WISP_STRAND_STRETCH_DIRECT, CHAIN, .pinned = true },
        { "direct, carried, damped", WISP_STRAND_STRETCH_DIRECT, CHAIN, .carried = true, .damping = 20.0f },
        { "direct, carried, pinned, air", WISP_STRAND_STRETCH_DIRECT, CHAIN, .carried = true, .pinned = true,
          .drag = 1.0f },
        { "direct, damped, air", WISP_STRAND_STRETCH_DIRECT, CHAIN, .damping = 20.0f, .drag = 1.0f },
        { "direct, bend links", WISP_STRAND_STRETCH_DIRECT, LINKS, .solver = WISP_SOLVER_PBD },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

#define BDF2_CHAIN WISP_STRAND_STRETCH_DIRECT, .bend = WISP_STRAND_BEND_NONE, .dt = SLOW, .bdf2 = true

TEST( direct_lengths_of_second_order_go_with_the_oracle )
{
    const duel duels[] = {
        { "bdf2", BDF2_CHAIN },
        { "bdf2, two iterations", BDF2_CHAIN, .iterations = 2 },
        { "bdf2, pinned", BDF2_CHAIN, .pinned = true },
        { "bdf2, carried, damped", BDF2_CHAIN, .carried = true, .damping = 20.0f },
        { "bdf2, carried, pinned, air", BDF2_CHAIN, .carried = true, .pinned = true, .drag = 1.0f },
        { "bdf2, damped, air", BDF2_CHAIN, .damping = 20.0f, .drag = 1.0f },
        { "bdf2, pbd bend links", WISP_STRAND_STRETCH_DIRECT, LINKS, .solver = WISP_SOLVER_PBD, .bdf2 = true },
        { "bdf2, xpbd bend links", WISP_STRAND_STRETCH_DIRECT, LINKS, .solver = WISP_SOLVER_XPBD,
          .bend_compliance = 200.0f, .bdf2 = true },
        { "bdf2, xpbd bend links, two iterations", WISP_STRAND_STRETCH_DIRECT, LINKS, .solver = WISP_SOLVER_XPBD,
          .bend_compliance = 200.0f, .bdf2 = true, .iterations = 2 },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

TEST( links_go_with_the_oracle )
{
    const duel duels[] = {
        { "links, pbd", WISP_STRAND_STRETCH_LINKS, LINKS, .solver = WISP_SOLVER_PBD },
        { "links, pbd, four iterations", WISP_STRAND_STRETCH_LINKS, LINKS, .solver = WISP_SOLVER_PBD,
          .iterations = 4 },
        { "links, xpbd", WISP_STRAND_STRETCH_LINKS, LINKS, .solver = WISP_SOLVER_XPBD },
        { "links, xpbd, soft", WISP_STRAND_STRETCH_LINKS, LINKS, .solver = WISP_SOLVER_XPBD, .compliance = 20.0f,
          .bend_compliance = 200.0f },
        { "links, xpbd, soft, two iterations", WISP_STRAND_STRETCH_LINKS, LINKS, .solver = WISP_SOLVER_XPBD,
          .compliance = 20.0f, .bend_compliance = 200.0f, .iterations = 2 },
        { "links, xpbd, carried, pinned", WISP_STRAND_STRETCH_LINKS, LINKS, .solver = WISP_SOLVER_XPBD,
          .bend_compliance = 200.0f, .carried = true, .pinned = true, .damping = 10.0f },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

// ---- rods ----

#define STRAIGHT                                                                                                     \
    WISP_STRAND_STRETCH_DIRECT, .bend = WISP_STRAND_BEND_ROD, .rest = WISP_STRAND_REST_STRAIGHT, .dt = SLOW
#define CURLED WISP_STRAND_STRETCH_DIRECT, .bend = WISP_STRAND_BEND_ROD, .dt = FAST

TEST( elliptic_rods_go_with_the_oracle )
{
    const duel duels[] = {
        { "flat, straight", STRAIGHT, .edgewise = 4.0f },
        { "flat, straight, soft", STRAIGHT, .edgewise = 8.0f, .rigidity = 1e-10f },
        { "flat, straight, carried, bdf2", STRAIGHT, .edgewise = 4.0f, .carried = true, .bdf2 = true },
        { "flat, straight, bend damping", STRAIGHT, .edgewise = 4.0f, .bend_damping = 5e-3f, .carried = true },
        { "flat, shape", CURLED, .rest = WISP_STRAND_REST_SHAPE, .edgewise = 4.0f },
        { "flat, sag free", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .edgewise = 4.0f, .rigidity = 2.5e-10f },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

TEST( rods_with_held_tips_go_with_the_oracle )
{
    const duel duels[] = {
        { "pinned chain", WISP_STRAND_STRETCH_DIRECT, CHAIN, .rest = WISP_STRAND_REST_STRAIGHT,
          .tips = WISP_STRAND_TIP_PINNED },
        { "pinned, straight", STRAIGHT, .tips = WISP_STRAND_TIP_PINNED, .carried = true, .ease = 8.0 },
        { "guided, straight", STRAIGHT, .tips = WISP_STRAND_TIP_GUIDED, .carried = true },
        { "clamped, straight", STRAIGHT, .tips = WISP_STRAND_TIP_CLAMPED, .carried = true, .ease = 8.0 },
        { "clamped, shape", CURLED, .rest = WISP_STRAND_REST_SHAPE, .tips = WISP_STRAND_TIP_CLAMPED },
        { "guided, sag free, flat", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .tips = WISP_STRAND_TIP_GUIDED,
          .edgewise = 4.0f, .rigidity = 2.5e-10f },
        { "guided, shape, flat, bdf2", CURLED, .rest = WISP_STRAND_REST_SHAPE, .tips = WISP_STRAND_TIP_GUIDED,
          .edgewise = 4.0f, .bdf2 = true },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

TEST( straight_rods_go_with_the_oracle )
{
    const duel duels[] = {
        { "straight", STRAIGHT },
        { "straight, carried", STRAIGHT, .carried = true },
        { "straight, hinged", STRAIGHT, .hinged = true },
        { "straight, two iterations", STRAIGHT, .iterations = 2 },
        { "straight, soft", STRAIGHT, .rigidity = 1e-10f },
        { "straight, pinned, carried", STRAIGHT, .pinned = true, .carried = true },
        { "straight, damped, air", STRAIGHT, .damping = 20.0f, .drag = 1.0f },
        { "straight, bend damping", STRAIGHT, .bend_damping = 5e-3f, .carried = true },
        { "straight, stiff", STRAIGHT, .rigidity = 1e-6f, .ease = 4.0 },
        { "straight, lowered", STRAIGHT, .rigidity = 1e-3f, .ease = 40.0 },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

TEST( curled_rods_go_with_the_oracle )
{
    const duel duels[] = {
        { "shape", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f },
        { "shape, carried", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f, .carried = true },
        { "shape, carried, damped, air", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f, .carried = true,
          .damping = 20.0f, .drag = 1.0f },
        { "shape, bend damping", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f, .bend_damping = 1e-3f },
        { "shape, hinged", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f, .hinged = true },
        { "shape, lowered", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 1e-7f },
        { "shape, pinned", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f, .pinned = true },
        { "balanced", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 2e-9f },
        { "balanced, carried, damped", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 2e-9f, .carried = true,
          .damping = 20.0f },
        { "balanced, bend damping", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 1e-9f,
          .bend_damping = 5e-4f },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

TEST( rods_of_second_order_go_with_the_oracle )
{
    const duel duels[] = {
        { "bdf2, straight", STRAIGHT, .bdf2 = true },
        { "bdf2, straight, carried", STRAIGHT, .bdf2 = true, .carried = true },
        { "bdf2, straight, hinged", STRAIGHT, .bdf2 = true, .hinged = true },
        { "bdf2, straight, two iterations", STRAIGHT, .bdf2 = true, .iterations = 2 },
        { "bdf2, straight, pinned, carried", STRAIGHT, .bdf2 = true, .pinned = true, .carried = true },
        { "bdf2, straight, damped, air", STRAIGHT, .bdf2 = true, .damping = 20.0f, .drag = 1.0f },
        { "bdf2, straight, bend damping", STRAIGHT, .bdf2 = true, .bend_damping = 5e-3f, .carried = true },
        { "bdf2, straight, stiff", STRAIGHT, .bdf2 = true, .rigidity = 1e-6f, .ease = 4.0 },
        { "bdf2, straight, lowered", STRAIGHT, .bdf2 = true, .rigidity = 1e-3f, .ease = 40.0 },
        { "bdf2, shape", CURLED, .bdf2 = true, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f },
        { "bdf2, shape, carried, damped, air", CURLED, .bdf2 = true, .rest = WISP_STRAND_REST_SHAPE,
          .rigidity = 2e-9f, .carried = true, .damping = 20.0f, .drag = 1.0f },
        { "bdf2, shape, bend damping", CURLED, .bdf2 = true, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f,
          .bend_damping = 1e-3f },
        { "bdf2, shape, pinned", CURLED, .bdf2 = true, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f,
          .pinned = true },
        { "bdf2, balanced", CURLED, .bdf2 = true, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 2e-9f },
        { "bdf2, balanced, carried, damped", CURLED, .bdf2 = true, .rest = WISP_STRAND_REST_SAG_FREE,
          .rigidity = 2e-9f, .carried = true, .damping = 20.0f },
    };
    run_duels( duels, WISP_COUNT( duels ) );
}

typedef struct drift
{
    double engine, oracle; // m, the farthest of a vertex from where it was added
    int strands;           // that are stiff enough for their shape, and counted
} drift;

static drift drift_in_a_step( const duel* rules )
{
    drift d = { 0.0, 0.0, 0 };
    match* m = open_match( rules, SUBSTEPS, 0.0f );
    step_both( m, 0 );
    assert_together( m, SUBSTEPS, A_SUBSTEP * SUBSTEPS );
    const wisp_vec3* points = strand_points( m->s.world, m->e );
    for ( int n = 0, first = 0; n < STRANDS; first += COUNTS[n], ++n )
    {
        const bool holds = rules->rest != WISP_STRAND_REST_SAG_FREE || m->balanced[n] == 1.0;
        d.strands += holds ? 1 : 0;
        for ( int i = 0; i < COUNTS[n] && holds; ++i )
        {
            d.engine = fmax( d.engine, double3_distance( double3_widen( points[first + i] ), m->rest[n][i] ) );
            d.oracle = fmax( d.oracle, double3_distance( m->strand[n].position[i], m->rest[n][i] ) );
        }
    }
    close_match( m );
    return d;
}

TEST( a_step_from_balance_leaves_both_where_they_are )
{
    const duel balanced = { "balanced", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 2e-9f };
    const duel hair = { "balanced hair", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 8e-10f };
    const duel shape = { "shape", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f };
    const duel bdf2 = { "bdf2, balanced", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 2e-9f,
                        .bdf2 = true };
    const duel* const both[] = { &balanced, &hair, &bdf2 };
    for ( int k = 0; k < WISP_COUNT( both ); ++k )
    {
        const drift d = drift_in_a_step( both[k] );
        // the equilibrium is one of the substep too: rounding is what remains
        assert_true( d.engine < 1e-6 );
        assert_true( d.oracle < 1e-12 );
        assert_true( d.strands > STRANDS / 2 );
    }
    // without balance the same strands fall by about 36 g dt^2, which is 1e-4 m
    const drift d = drift_in_a_step( &shape );
    assert_true( d.engine > 5e-5 && d.oracle > 5e-5 );
}

// ---- second order ----

#define FRAME ( 1.0f / 60.0f )

static const double GRAVITY = 9.81;

enum
{
    HAIRS = 3,
    VERTICES = 20,
    POINTS = HAIRS * VERTICES,
};

static wisp_strand_dynamics_def chain_def( void )
{
    wisp_strand_dynamics_def def = undamped_hair();
    def.bending = WISP_STRAND_BEND_NONE;
    def.integrator = WISP_INTEGRATOR_BDF2;
    return def;
}

static wisp_entity add_chains( hosted* s, int substeps, float length, const wisp_strand_dynamics_def* def )
{
    open_strands( s, substeps, 1, 1 );
    return add_moving( s->world, HAIRS, VERTICES, straight_out, length, def );
}

static int euler_count( const hosted* s )
{
    return (int)wisp_world_counter( s->world, WISP_COUNT_FIRST_ORDER );
}

// ---- back to Euler ----

TEST( only_what_breaks_the_history_is_made_by_euler )
{
    hosted s;
    const wisp_strand_dynamics_def def = chain_def();
    open_strands( &s, 1, 1, 1 );
    const wisp_entity e = add_moving( s.world, HAIRS, VERTICES, straight_down, 0.3f, &def );
    strand_steps( s.world, 5, FRAME );
    assert_int_equal( euler_count( &s ), 0 ); // nor is the first substep counted

    // a long step keeps the length of substeps, steps that are longer for good do not
    strand_steps( s.world, 1, 10.0f * FRAME );
    assert_int_equal( euler_count( &s ), 0 );
    strand_steps( s.world, 50, 2.0f * FRAME );
    assert_int_equal( euler_count( &s ), HAIRS );

    // a jump of the head, beyond the teleport distance
    assert_int_equal(
        wisp_move_strand_head( s.world, e, head_at( 0.3f, ( wisp_vec3 ){ 0, 0, 1 }, ( wisp_vec3 ){ 3.0f, 0, 0 } ) ),
        WISP_OK );
    strand_steps( s.world, 4, FRAME );
    assert_int_equal( euler_count( &s ), 2 * HAIRS );

    // another definition begins anew
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_OK );
    strand_steps( s.world, 4, FRAME );
    assert_int_equal( euler_count( &s ), 2 * HAIRS );
    close_world( &s );
}

TEST( a_teleport_takes_the_history_along )
{
    static wisp_vec3 points[2][POINTS];
    const wisp_transform motion = head_at( 0.0f, ( wisp_vec3 ){ 0, 1, 0 }, ( wisp_vec3 ){ 0.5f, 0.25f, 0 } );
    for ( int k = 0; k < 2; ++k )
    {
        hosted s;
        const wisp_strand_dynamics_def def = chain_def();
        const wisp_entity e = add_chains( &s, 2, 0.3f, &def );
        strand_steps( s.world, 6, FRAME );
        assert_int_equal( k == 1 ? wisp_teleport( s.world, e, motion, true ) : WISP_OK, WISP_OK );
        strand_steps( s.world, 6, FRAME );
        assert_int_equal( euler_count( &s ), 0 );
        memcpy( points[k], strand_points( s.world, e ), sizeof( points[k] ) );
        close_world( &s );
    }
    for ( int v = 0; v < POINTS; ++v )
    {
        const wisp_vec3 p = points[0][v];
        // rounding of positions below 1 m, twelve substeps
        assert_true( vec_distance( points[1][v], ( wisp_vec3 ){ p.x + 0.5f, p.y + 0.25f, p.z } ) < 2e-6 );
    }
}

TEST( a_strand_that_is_put_to_rest_elsewhere_falls_from_rest )
{
    hosted s;
    const wisp_strand_dynamics_def def = chain_def();
    const wisp_entity e = add_chains( &s, 1, 0.3f, &def );
    strand_steps( s.world, 8, FRAME );
    const wisp_vec3 before = strand_points( s.world, e )[VERTICES - 1];
    assert_int_equal(
        wisp_teleport( s.world, e, head_at( 0.0f, ( wisp_vec3 ){ 0, 1, 0 }, ( wisp_vec3 ){ 1, 0, 0 } ), false ),
        WISP_OK );
    strand_steps( s.world, 1, FRAME );
    const wisp_vec3 p = strand_points( s.world, e )[VERTICES - 1];
    // no farther than a fall of a step
    assert_true( vec_distance( p, ( wisp_vec3 ){ before.x + 1.0f, before.y, before.z } ) <
                 GRAVITY * (double)( FRAME * FRAME ) );
    close_world( &s );
}

TEST( strands_that_are_reset_go_on_by_euler )
{
    hosted s;
    wisp_strand_dynamics_def def = chain_def();
    def.stretch_passes = 1;
    def.stretch_tolerance = 1e-6f;
    const wisp_entity e = add_chains( &s, 1, 0.3f, &def );
    strand_steps( s.world, 2, FRAME );
    float* velocity = wisp_world_column( s.world, e, WISP_STRAND_VELOCITY, 0 );
    velocity[( VERTICES - 1 ) * 3 * WISP_LANES] = 40.0f; // the tip of one strand
    const int before = (int)wisp_world_counter( s.world, WISP_COUNT_STRAND_RESET );
    strand_steps( s.world, 1, FRAME );
    assert_true( (int)wisp_world_counter( s.world, WISP_COUNT_STRAND_RESET ) > before );
    assert_true( euler_count( &s ) > 0 );
    close_world( &s );
}

TEST( halted_strands_go_on_without_their_history )
{
    hosted s;
    const wisp_strand_dynamics_def def = chain_def();
    open_strands( &s, 1, 1, 1 );
    const wisp_entity e = add_moving( s.world, HAIRS, VERTICES, straight_down, 0.3f, &def );
    strand_steps( s.world, 5, FRAME );
    static wisp_vec3 before[POINTS];
    memcpy( before, strand_points( s.world, e ), sizeof( before ) );
    float* velocity = wisp_world_column( s.world, e, WISP_STRAND_VELOCITY, 0 );
    velocity[4 * 3 * WISP_LANES + 1] = NAN;
    strand_steps( s.world, 1, FRAME );
    assert_true( wisp_is_halted( s.world, e ) );
    assert_memory_equal( strand_points( s.world, e ), before, sizeof( before ) );
    const int count = euler_count( &s );
    assert_int_equal( wisp_resume( s.world, e ), WISP_OK );
    strand_steps( s.world, 1, FRAME );
    assert_int_equal( euler_count( &s ), count + HAIRS );
    strand_steps( s.world, 10, FRAME );
    assert_int_equal( euler_count( &s ), count + HAIRS );
    assert_false( wisp_is_halted( s.world, e ) );
    close_world( &s );
}

// ---- refusals ----

TEST( bdf2_is_refused_without_direct_lengths )
{
    hosted s;
    wisp_strand_dynamics_def def = chain_def();
    const wisp_entity e = add_chains( &s, 1, 0.3f, &def );
    def.stretch = WISP_STRAND_STRETCH_LINKS;
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_BAD_INPUT );
    assert_string_equal( wisp_world_message( s.world ),
                         "strands: got integrator bdf2 with stretch links, expected direct" );
    def.stretch = WISP_STRAND_STRETCH_DIRECT;
    def.integrator = WISP_INTEGRATOR_COUNT;
    assert_int_equal( wisp_set_strand_dynamics( s.world, e, &def ), WISP_BAD_INPUT );
    assert_non_null( strstr( wisp_world_message( s.world ), "integrator" ) );
    close_world( &s );
}
