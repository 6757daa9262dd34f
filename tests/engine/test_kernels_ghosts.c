// The table of values that ghosts share (Park and Kim 2024, eq. 4-5), for every instruction set: the range of the elastic
// weight where rounding could leave it, and the factor that a group has in common.
#include "kernels_fixture.h"

enum
{
    NODES = 64,
    STRIDE = 12,
    LANES = WISP_LANES,
};

// One group of sixteen targets, and its table.
typedef struct table_state
{
    _Alignas( 64 ) float position[NODES][3][LANES];
    _Alignas( 64 ) float velocity[NODES][3][LANES];
    _Alignas( 64 ) float before[NODES][3][LANES];
    _Alignas( 64 ) float cap[NODES][LANES];
    _Alignas( 64 ) float reach[NODES][LANES];
    _Alignas( 64 ) float table[LANES * NODES * STRIDE];
    _Alignas( 64 ) int32_t lane_count[LANES];
    _Alignas( 64 ) int32_t lane_node[LANES];
    int32_t group_row[2];
} table_state;

// Velocities that are multiples of those before: 0.1 .. 10 times as large, or reversed.
static void make_state( table_state* s, float direction )
{
    memset( s, 0, sizeof( *s ) );
    s->group_row[1] = NODES;
    for ( int lane = 0; lane < LANES; ++lane )
    {
        s->lane_count[lane] = NODES;
        s->lane_node[lane] = lane * NODES * STRIDE;
    }
    for ( int n = 0; n < NODES * LANES; ++n )
    {
        const int i = n / LANES, lane = n % LANES;
        const float scale = direction * test_random_float( n, 3, 0.1f, 10.0f );
        for ( int axis = 0; axis < 3; ++axis )
        {
            s->before[i][axis][lane] = test_random_float( n, axis, -2.0f, 2.0f );
            s->velocity[i][axis][lane] = scale * s->before[i][axis][lane];
        }
        s->cap[i][lane] = 0.02f;
        s->reach[i][lane] = test_random_float( n, 4, 0.0f, 0.5f );
    }
}

static void fill( const wisp_kernels* kernels, table_state* s )
{
    const wisp_strand_target_args args = {
        .group_row = s->group_row,
        .lane_count = s->lane_count,
        .lane_node = s->lane_node,
        .position = s->position[0][0],
        .rest = s->position[0][0],
        .velocity = s->velocity[0][0],
        .previous_velocity = s->before[0][0],
        .max_sway = s->cap[0],
        .reach = s->reach[0],
        .table = s->table,
        .stride = STRIDE,
        .is_elastic = true,
        .sway_time = 0.1f,
    };
    kernels->strand_target( &args, 0, 1 );
}

static const float* node_of( const table_state* s, int lane, int i )
{
    return s->table + ( lane * NODES + i ) * STRIDE;
}

// Without its clamp the cosine of parallel velocities is 1 + 1e-7 as often as not, and the weight leaves [0, 1].
TEST( the_elastic_weight_of_parallel_velocities_stays_between_0_and_1 )
{
    static table_state s;
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int n = 0; n < 2 * count; ++n )
    {
        const bool is_reversed = n % 2 == 1;
        const float expected = is_reversed ? 1.0f : 0.0f;
        make_state( &s, is_reversed ? -1.0f : 1.0f );
        fill( tables[n / 2], &s );
        for ( int k = LANES; k < NODES * LANES; ++k )
        {
            const float weight = node_of( &s, k % LANES, k / LANES )[3];
            assert_true( weight >= 0.0f && weight <= 1.0f );
            assert_near( (double)weight, (double)expected, 4e-7, "weight of node", k );
        }
    }
}

// The farthest ghost of a node sways by a segment where it would sway farther; where it would not, no bit changes.
TEST( the_factor_of_a_group_takes_its_farthest_ghost_to_the_limit )
{
    static table_state capped, free;
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int t = 0; t < count; ++t )
    {
        int cut = 0, kept = 0;
        make_state( &capped, -1.0f );
        for ( int n = 0; n < NODES * LANES; ++n )
        {
            // half of the nodes are slow enough
            for ( int axis = 0; axis < 3 && n % 2 == 0; ++axis )
            {
                capped.velocity[n / LANES][axis][n % LANES] *= 1e-3f;
            }
        }
        free = capped;
        for ( int n = 0; n < NODES * LANES; ++n )
        {
            free.cap[n / LANES][n % LANES] = 1e6f;
        }
        fill( tables[t], &capped );
        fill( tables[t], &free );
        for ( int n = LANES; n < NODES * LANES; ++n )
        {
            const float *a = node_of( &capped, n % LANES, n / LANES ), *b = node_of( &free, n % LANES, n / LANES );
            const double reach = (double)capped.reach[n / LANES][n % LANES];
            const double length = sqrt( (double)( b[4] * b[4] + b[5] * b[5] + b[6] * b[6] ) );
            const double now = sqrt( (double)( a[4] * a[4] + a[5] * a[5] + a[6] * a[6] ) );
            assert_true( a[3] == b[3] );
            if ( length * ( (double)b[3] + reach ) < 0.0199 )
            {
                assert_memory_equal( a + 4, b + 4, 3 * sizeof( float ) );
                kept += 1;
            }
            else if ( length * ( (double)b[3] + reach ) > 0.0201 )
            {
                assert_near( now * ( (double)a[3] + reach ), 0.02, 1e-8, "sway of node", n );
                cut += 1;
            }
        }
        assert_true( cut > 100 && kept > 100 );
    }
}
