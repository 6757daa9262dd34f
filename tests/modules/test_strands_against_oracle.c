// Moving strands in the engine, in single precision, compared with the oracle, in double, substep by substep: fifteen
// strands of 1, 2, 3, 9 and 20 vertices, crooked, curled and straight, that fill one group of lanes.
#include "strand_duel_fixture.h"

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

// ---- sensitivity of the comparison ----

// The comparison is meaningful only if it distinguishes a method from a similar one.
TEST( a_hundredth_of_gravity_or_stiffness_shows )
{
    const duel duels[] = {
        { "direct", WISP_STRAND_STRETCH_DIRECT, CHAIN },
        { "links, xpbd", WISP_STRAND_STRETCH_LINKS, LINKS, .solver = WISP_SOLVER_XPBD, .bend_compliance = 200.0f },
        { "straight", STRAIGHT },
        { "shape", CURLED, .rest = WISP_STRAND_REST_SHAPE, .rigidity = 2e-9f },
        { "balanced", CURLED, .rest = WISP_STRAND_REST_SAG_FREE, .rigidity = 2e-9f },
    };
    for ( int k = 0; k < WISP_COUNT( duels ); ++k )
    {
        const bool rod = duels[k].bend == WISP_STRAND_BEND_ROD;
        match* m = open_match( duels + k, SUBSTEPS, 0.2f );
        m->gravity = double3_scale( rod ? 1.0 : 1.01, m->gravity );
        for ( int n = 0; n < STRANDS; ++n )
        {
            for ( int i = 0; i < COUNTS[n]; ++i )
            {
                m->strand[n].stiffness[i] *= 1.01;
            }
        }
        step_both( m, 0 );
        int strand = -1, vertex = -1;
        const double most = apart( m, &strand, &vertex );
        assert_true( most > 4.0 * A_SUBSTEP * SUBSTEPS );
        close_match( m );
    }
}
