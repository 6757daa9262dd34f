// Motion constraints, carried particles and largest speeds: every table gives the same bits, and positions are those of the oracle.
#include "kernels_fixture.h"

#include "motion_oracle.h"

enum
{
    COUNT = 512,
    KINDS = 12, // what answers (pbd, hard, compliant, with multipliers), by what is behind (nothing, planes, spheres)
};

typedef struct crowd
{
    _Alignas( 64 ) float position[COUNT][4];
    _Alignas( 64 ) float velocity[COUNT][4], bound[COUNT][4];
    _Alignas( 64 ) float target[3 * COUNT], displacement[3 * COUNT], next[3 * COUNT];
    _Alignas( 64 ) float normal[3 * COUNT], change[3 * COUNT], next_normal[3 * COUNT];
    _Alignas( 64 ) float max_distance[COUNT], backstop_distance[COUNT], curvature[COUNT], lambda[2 * COUNT];
} crowd;

static size_t row_of( int slot )
{
    return 24 * (size_t)( slot / 8 ) + (size_t)( slot % 8 );
}

static float pick( int i, int k, float a, float b )
{
    return test_random_float( i, k, a, b );
}

// Particles around targets at distances of the order of their limits: inside, outside, at the target, pinned, free.
static void fill( crowd* c, int kind )
{
    memset( c, 0, sizeof( *c ) );
    for ( int i = 0; i < COUNT; ++i )
    {
        const size_t row = row_of( i );
        const float spread = i % 64 < 16 ? 0.02f : 0.3f; // some groups are well inside
        for ( int k = 0; k < 3; ++k )
        {
            c->next[row + 8 * (size_t)k] = pick( i, k, -2.0f, 2.0f );
            c->target[row + 8 * (size_t)k] = c->next[row + 8 * (size_t)k] + pick( i, 3 + k, -0.05f, 0.05f );
            c->next_normal[row + 8 * (size_t)k] = pick( i, 6 + k, -1.0f, 1.0f );
            c->normal[row + 8 * (size_t)k] = c->next_normal[row + 8 * (size_t)k] + pick( i, 9 + k, -0.1f, 0.1f );
            c->position[i][k] = c->target[row + 8 * (size_t)k] + pick( i, 12 + k, -spread, spread );
            c->velocity[i][k] = pick( i, 20 + k, -1.0f, 1.0f );
        }
        c->position[i][3] = i % 7 == 3 ? 0.0f : pick( i, 15, 0.5f, 100.0f );
        c->max_distance[i] = i % 64 < 16   ? 0.2f
                             : i % 11 == 0 ? 0.0f
                             : i % 11 == 1 ? INFINITY
                                           : pick( i, 16, 0.05f, 0.4f );
        c->backstop_distance[i] = i % 64 < 16  ? 0.3f
                                  : i % 5 == 0 ? INFINITY
                                  : i % 5 == 1 ? 0.0f
                                               : pick( i, 17, 0.0f, 0.2f );
        c->curvature[i] = kind / 4 == 2 ? 1.0f / pick( i, 18, 0.3f, 2.0f ) : 0.0f;
    }
}

static wisp_motion_constraint_args args_of( crowd* c, int kind, float left )
{
    wisp_motion_constraint_args args = {
        .position = c->position[0],
        .bound = c->bound[0],
        .target = c->target,
        .displacement = c->displacement,
        .max_distance = c->max_distance,
        .left = left,
        .distance = { kind % 4 == 0 ? 0.25f : 1.0f, kind % 4 >= 2 ? 20.0f : 0.0f },
        .backstop = { kind % 4 == 0 ? 0.5f : 1.0f, kind % 4 >= 2 ? 5.0f : 0.0f },
        .lambda = kind % 4 == 3 ? c->lambda : NULL,
    };
    if ( kind / 4 > 0 )
    {
        args.normal = c->normal;
        args.normal_change = c->change;
        args.backstop_distance = c->backstop_distance;
        args.curvature = c->curvature;
    }
    return args;
}

static void begin_step( const wisp_kernels* kernels, crowd* c, int kind )
{
    const bool behind = kind / 4 > 0;
    const wisp_motion_target_args args = {
        .target = c->target,
        .displacement = c->displacement,
        .next = c->next,
        .normal = behind ? c->normal : NULL,
        .normal_change = behind ? c->change : NULL,
        .next_normal = behind ? c->next_normal : NULL,
        .max_distance = c->max_distance,
        .backstop_distance = behind ? c->backstop_distance : NULL,
        .bound = c->bound[0],
    };
    kernels->motion_targets( &args, 0, COUNT );
}

TEST( every_table_gives_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    static crowd found, expected;
    for ( int i = 0; i < KINDS * count; ++i )
    {
        const int kind = i % KINDS;
        const wisp_kernels* pair[2] = { tables[i / KINDS], tables[0] };
        crowd* crowds[2] = { &found, &expected };
        for ( int k = 0; k < 2; ++k )
        {
            fill( crowds[k], kind );
            begin_step( pair[k], crowds[k], kind );
            for ( int pass = 0; pass < 3; ++pass )
            {
                wisp_motion_constraint_args args = args_of( crowds[k], kind, 0.5f * (float)( 2 - pass ) );
                args.velocity = crowds[k]->velocity[0];
                args.inverse_dt = 60.0f;
                pair[k]->motion_constraint( &args, 8, COUNT );
            }
            const wisp_carry_args carried = { { -0.02f, -0.2f, 0.1f, 0.2f, -0.03f, 0.01f, -0.1f, 0.02f, -0.01f },
                                              { 1.0f, 2.0f, 3.0f },
                                              { 0.1f, 0.0f, -0.1f } };
            pair[k]->carry_points( &carried, crowds[k]->position[0], 8, COUNT );
            pair[k]->carry_vectors( &carried, crowds[k]->velocity[0], 8, COUNT );
            crowds[k]->lambda[0] = (float)pair[k]->limit_speed( crowds[k]->velocity[0], 0.75f, 0, COUNT );
        }
        assert_memory_equal( &found, &expected, sizeof( found ) );
        assert_true( found.lambda[0] > 10.0f );
    }
}

static double3 vector_at( const float* end, const float* change, int slot, double left )
{
    const size_t r = row_of( slot );
    return ( double3 ){ (double)end[r] - left * (double)change[r], (double)end[r + 8] - left * (double)change[r + 8],
                        (double)end[r + 16] - left * (double)change[r + 16] };
}

// Two iterations in the middle of a step. Groups that are well inside, and lanes that are free, keep their bits.
TEST( positions_are_those_of_the_oracle )
{
    const wisp_kernels* kernels = widest_table();
    static crowd c, start;
    for ( int kind = 0; kind < KINDS; ++kind )
    {
        fill( &c, kind );
        begin_step( kernels, &c, kind );
        start = c;
        const wisp_motion_constraint_args args = args_of( &c, kind, 0.25f );
        kernels->motion_constraint( &args, 0, COUNT );
        kernels->motion_constraint( &args, 0, COUNT );
        int moved = 0, kept = 0;
        for ( int i = 0; i < COUNT; ++i )
        {
            motion_oracle m = {
                .target = vector_at( c.target, c.displacement, i, 0.25 ),
                .max_distance = (double)c.max_distance[i],
                .normal = kind / 4 > 0 ? vector_at( c.normal, c.change, i, 0.25 ) : ( double3 ){ 0.0, 0.0, 0.0 },
                .backstop_distance = (double)c.backstop_distance[i],
                .backstop_radius = kind / 4 == 2 ? 1.0 / (double)c.curvature[i] : (double)INFINITY,
                .stiffness = { (double)args.distance.stiffness, (double)args.backstop.stiffness },
                .alpha = { (double)args.distance.compliance, (double)args.backstop.compliance },
            };
            const float* p = start.position[i];
            double3 x = { (double)p[0], (double)p[1], (double)p[2] };
            x = motion_oracle_project( &m, x, (double)p[3], kind % 4 == 3 );
            x = motion_oracle_project( &m, x, (double)p[3], kind % 4 == 3 );
            const double expected[3] = { x.x, x.y, x.z };
            for ( int k = 0; k < 3; ++k )
            {
                // coordinates of 2 m, a handful of operations in floats
                assert_near( (double)c.position[i][k], expected[k], 2e-6, "coordinate of", 100 * kind + i );
            }
            const bool same = memcmp( p, c.position[i], sizeof( c.position[i] ) ) == 0;
            moved += same ? 0 : 1;
            kept += same ? 1 : 0;
        }
        assert_true( moved > 150 );
        assert_true( kept > 100 );
    }
}

// The cube in which a group is left out lies within what is allowed, wherever the target is in the step.
TEST( a_group_that_is_left_out_is_within_its_limits )
{
    static crowd c;
    int left_out = 0;
    for ( int kind = 1; kind < KINDS; kind += 4 )
    {
        fill( &c, kind );
        begin_step( widest_table(), &c, kind );
        for ( int i = 0; i < COUNT; ++i )
        {
            const double h = (double)c.bound[i][3];
            for ( int corner = 0; h >= 0.0 && corner < 8 * 5; ++corner )
            {
                const double left = 0.25 * (double)( corner / 8 );
                motion_oracle m = {
                    .target = vector_at( c.target, c.displacement, i, left ),
                    .max_distance = (double)c.max_distance[i],
                    .normal = kind / 4 > 0 ? vector_at( c.normal, c.change, i, left ) : ( double3 ){ 0.0, 0.0, 0.0 },
                    .backstop_distance = (double)c.backstop_distance[i],
                    .backstop_radius = kind / 4 == 2 ? 1.0 / (double)c.curvature[i] : (double)INFINITY,
                    .stiffness = { 1.0, 1.0 },
                };
                const double3 x = { (double)c.bound[i][0] + ( corner & 1 ? h : -h ),
                                    (double)c.bound[i][1] + ( corner & 2 ? h : -h ),
                                    (double)c.bound[i][2] + ( corner & 4 ? h : -h ) };
                const double3 to = motion_oracle_project( &m, x, 1.0, false );
                assert_true( to.x == x.x && to.y == x.y && to.z == x.z );
                left_out += 1;
            }
        }
    }
    assert_true( left_out > 3 * 40 * 100 );
}

TEST( a_speed_above_the_largest_one_is_scaled_to_it )
{
    _Alignas(
        64 ) float v[16][4] = { { 3.0f, 0.0f, 4.0f, 0.0f }, { 0.3f, 0.0f, 0.4f, 0.0f }, { 0.0f, -2.0f, 0.0f, 0.0f } };
    const float slow[4] = { 0.3f, 0.0f, 0.4f, 0.0f };
    assert_int_equal( widest_table()->limit_speed( v[0], 1.0f, 0, 16 ), 2 );
    assert_near( (double)v[0][0], 0.6, 1e-7, "x", 0 );
    assert_near( (double)v[0][2], 0.8, 1e-7, "z", 0 );
    assert_memory_equal( v[1], slow, sizeof( slow ) );
    assert_near( (double)v[2][1], -1.0, 0.0, "y", 2 );
}
