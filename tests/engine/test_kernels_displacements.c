// Kernels of displacements: every table gives the same bits, and lengths, deviations and separation bounds are
// compared with double precision.
#include "kernels_fixture.h"

enum
{
    POINTS = 40,
    SIDES = 24,
    PAIRS = 56,
    SEEDS = 40,
};

static const double ROUNDING = 4.0 * (double)FLT_EPSILON;

// From -1 to 1, the same for the same numbers.
static float chance( int seed, int number )
{
    uint32_t h = (uint32_t)seed * 2654435761u + (uint32_t)number * 40503u + 12345u;
    h ^= h >> 15;
    h *= 2246822519u;
    h ^= h >> 13;
    h *= 3266489917u;
    h ^= h >> 16;
    return (float)( (double)h / 2147483648.0 - 1.0 );
}

static double length( double x, double y, double z )
{
    return sqrt( x * x + y * y + z * z );
}

// ---- displacements of points ----

// Room for groups of eight, followed by guard values that must not change.
typedef struct walk
{
    _Alignas( 64 ) float before[POINTS + 8][4], now[POINTS + 8][4], way[POINTS + 8][4];
    float common[3];
} walk;

static walk make_walk( int seed )
{
    walk w;
    for ( int i = 0; i < POINTS + 8; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            w.before[i][k] = chance( seed, 8 * i + k );
            w.now[i][k] = w.before[i][k] + 0.1f * chance( seed, 8 * i + k + 4 );
            w.way[i][k] = -7.0f;
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        w.common[k] = 0.05f * chance( seed, 5000 + k );
    }
    return w;
}

static wisp_displacement_args job_of( walk* w )
{
    return ( wisp_displacement_args ){
        .before = w->before[0],
        .now = w->now[0],
        .common_displacement = { w->common[0], w->common[1], w->common[2] },
        .relative_margin = 0.25f,
        .margin = 0.01f,
        .displacement = w->way[0],
    };
}

static void take( const wisp_kernels* kernels, walk* w, int begin, int end )
{
    const wisp_displacement_args args = job_of( w );
    kernels->measure_displacements( &args, begin, end );
}

static double spare_of( const walk* w, int i )
{
    const float *p = w->now[i], *q = w->before[i], *c = w->common;
    const double beside =
        length( (double)p[0] - (double)q[0] - (double)c[0], (double)p[1] - (double)q[1] - (double)c[1],
                (double)p[2] - (double)q[2] - (double)c[2] );
    return 0.25 * beside + (double)0.01f;
}

TEST( a_way_leads_from_before_to_now_give_or_take_a_share_of_it )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < SEEDS * count; ++i )
    {
        walk found = make_walk( i % SEEDS ), expected = make_walk( i % SEEDS );
        take( tables[i / SEEDS], &found, 8, POINTS );
        take( tables[0], &expected, 8, POINTS );
        assert_memory_equal( &found, &expected, sizeof( found ) );
        for ( int p = 0; p < POINTS + 8; ++p )
        {
            const bool is_queried = p >= 8 && p < POINTS;
            for ( int k = 0; k < 3; ++k )
            {
                assert_true( found.way[p][k] == ( is_queried ? found.now[p][k] - found.before[p][k] : -7.0f ) );
            }
            assert_near( (double)found.way[p][3], is_queried ? spare_of( &found, p ) : -7.0, 4.0 * ROUNDING,
                         "spare of", p );
        }
    }
}

// The sum over [8, 8 + count), and whether one is fixed; with an invalid number inside the range, and beyond its end.
static void check_sum( const wisp_kernels* kernels, int seed, int count, bool has_fixed )
{
    static const float WRONG[] = { NAN, INFINITY, -INFINITY, 3e38f, -1.1e6f };
    walk w = make_walk( seed );
    w.now[8 + seed % count][3] = has_fixed ? 0.0f : w.now[8 + seed % count][3];
    w.now[8 + count][0] = 1e5f;
    w.now[8 + count][3] = 0.0f;
    w.now[10][seed % 3] = seed % 2 == 0 ? WRONG[seed / 2 % WISP_COUNT( WRONG )] : w.now[10][seed % 3];
    double found[3], expected[3] = { 0.0, 0.0, 0.0 };
    for ( int i = 8; i < 8 + count; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float way = w.now[i][k] - w.before[i][k];
            expected[k] += fabsf( way ) < 1e6f ? (double)way : 0.0;
        }
    }
    const wisp_displacement_args args = job_of( &w );
    assert_true( kernels->sum_displacements( &args, 8, 8 + count, found ) == has_fixed );
    for ( int k = 0; k < 3; ++k )
    {
        assert_near( found[k], expected[k], ROUNDING, "sum of ways, seed", seed );
    }
}

TEST( ways_are_summed_and_who_is_fixed_is_seen )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < SEEDS * count; ++i )
    {
        check_sum( tables[i / SEEDS], i % SEEDS, 3 + i % SEEDS % 29, i % 3 == 0 );
    }
}

TEST( what_is_too_long_or_no_number_adds_nothing )
{
    const float wrong[] = { NAN, INFINITY, -INFINITY, 3e38f, 1.1e6f };
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < WISP_COUNT( wrong ) * 3 * count; ++i )
    {
        walk w = make_walk( i );
        w.now[11][i / WISP_COUNT( wrong ) % 3] = wrong[i % WISP_COUNT( wrong )];
        take( tables[i / WISP_COUNT( wrong ) / 3], &w, 0, POINTS );
        assert_true( w.way[11][3] == 0.01f );
        assert_near( (double)w.way[12][3], spare_of( &w, 12 ), 4.0 * ROUNDING, "spare beside what is wrong", i );
    }
}

// All points keep their displacements except one, which deviates by this multiple of its limit.
static bool leaves( const wisp_kernels* kernels, int seed, int point, float times, int end )
{
    walk w = make_walk( seed );
    take( kernels, &w, 0, POINTS + 8 );
    const float most = w.way[point][3];
    w.now[point][seed % 3] += times * most;
    const wisp_displacement_args args = job_of( &w );
    return kernels->exceeds_prediction( &args, 0, end );
}

TEST( who_goes_farther_from_its_way_than_it_may_leaves_it )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int t = 0; t < count; ++t )
    {
        for ( int p = 0; p < POINTS; ++p )
        {
            assert_false( leaves( tables[t], p, p, 0.0f, POINTS ) );
            assert_false( leaves( tables[t], p, p, 0.999f, POINTS ) );
            assert_true( leaves( tables[t], p, p, 1.001f, POINTS ) );
            assert_true( leaves( tables[t], p, p, -1.001f, p + 1 ) );
            assert_false( leaves( tables[t], p, p, 1.001f, p ) ); // beyond the end
            assert_false( leaves( tables[t], p, p, NAN, POINTS ) );
        }
    }
}

// ---- separation bounds ----

typedef struct standing
{
    _Alignas( 64 ) float gone[SIDES][4], ways[SIDES][4];
    int32_t first[PAIRS], second[PAIRS], due[PAIRS];
    float slack[PAIRS];
    int due_count;
} standing;

static standing make_standing( int seed )
{
    standing s;
    for ( int i = 0; i < SIDES; ++i )
    {
        for ( int k = 0; k < 4; ++k )
        {
            s.gone[i][k] = 0.1f * chance( seed, 8 * i + k );
            s.ways[i][k] = 0.1f * chance( seed, 8 * i + k + 4 );
        }
        s.gone[i][3] = fabsf( s.gone[i][3] );
        s.ways[i][3] = fabsf( s.ways[i][3] );
    }
    for ( int i = 0; i < PAIRS; ++i )
    {
        s.first[i] = ( 7 * i + seed ) % SIDES;
        s.second[i] = ( 5 * i + 3 * seed + i / SIDES ) % SIDES;
        s.slack[i] = 0.4f + 0.4f * chance( seed, 1000 + i );
        s.due[i] = -7;
    }
    return s;
}

static double closing_of( const float* a, const float* b )
{
    return length( (double)a[0] - (double)b[0], (double)a[1] - (double)b[1], (double)a[2] - (double)b[2] ) +
           (double)a[3] + (double)b[3];
}

static void count_slack( const wisp_kernels* kernels, standing* s, bool is_gone, int begin, int end )
{
    const wisp_separation_args args = {
        .moved = is_gone ? s->gone[0] : NULL,
        .predicted = s->ways[0],
        .first = s->first,
        .second = s->second,
        .separation_bound = s->slack,
        .active = s->due,
    };
    s->due_count = kernels->find_active_pairs( &args, begin, end );
}

// The bound is lowered by at least the approach of the sides, and hardly more; a pair with less than the possible
// approach is active.
static void check_pair( const standing* before, const standing* found, int pair, bool is_gone, int* next )
{
    const int a = before->first[pair], b = before->second[pair];
    const double left =
        (double)before->slack[pair] - ( is_gone ? closing_of( before->gone[a], before->gone[b] ) : 0.0 );
    assert_true( (double)found->slack[pair] <= left + ( is_gone ? 0.0 : ROUNDING ) );
    assert_near( (double)found->slack[pair], left, is_gone ? 2e-4 : 0.0, "slack of pair", pair );
    const bool is_due = found->due[*next] == pair;
    const double over = (double)found->slack[pair] - closing_of( before->ways[a], before->ways[b] );
    assert_true( is_due ? over < 2e-4 : over > 0.0 );
    *next += is_due ? 1 : 0;
}

TEST( pairs_are_due_that_may_use_up_their_slack )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    int due = 0;
    for ( int i = 0; i < 2 * SEEDS * count; ++i )
    {
        const int seed = i / 2 % SEEDS, end = PAIRS - seed % 8;
        const bool is_gone = i % 2 == 0;
        const standing before = make_standing( seed );
        standing found = before, expected = before;
        count_slack( tables[i / 2 / SEEDS], &found, is_gone, 8, end );
        count_slack( tables[0], &expected, is_gone, 8, end );
        assert_int_equal( found.due_count, expected.due_count );
        assert_memory_equal( found.slack, expected.slack, (size_t)end * sizeof( float ) );
        assert_memory_equal( found.due + 8, expected.due + 8, (size_t)found.due_count * sizeof( int32_t ) );
        assert_memory_equal( found.slack, before.slack, 8 * sizeof( float ) );
        found.due[8 + found.due_count] = -1; // more may follow them
        int next = 8;
        for ( int pair = 8; pair < end; ++pair )
        {
            check_pair( &before, &found, pair, is_gone, &next );
        }
        assert_int_equal( next - 8, found.due_count );
        due += found.due_count;
    }
    assert_in_range( due, SEEDS * count * 10, 2 * SEEDS * count * ( PAIRS - 16 ) ); // some are, and not all
}

TEST( who_has_a_slack_or_a_way_that_is_no_number_is_due )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < 5 * count; ++i )
    {
        standing s = make_standing( 1 );
        for ( int pair = 0; pair < PAIRS; ++pair )
        {
            s.slack[pair] = 100.0f;
            s.first[pair] = pair % 7;
            s.second[pair] = 8 + pair % 5;
        }
        s.slack[19] = i % 5 == 0 ? NAN : ( i % 5 == 1 ? -INFINITY : 100.0f );
        s.first[19] = SIDES - 1; // of no other pair
        s.ways[SIDES - 1][2] = i % 5 == 2 ? NAN : 0.0f;
        s.ways[SIDES - 1][3] = i % 5 == 3 ? INFINITY : 0.0f;
        s.gone[SIDES - 1][0] = i % 5 == 4 ? NAN : 0.0f;
        count_slack( tables[i / 5], &s, true, 0, PAIRS - 3 );
        assert_int_equal( s.due_count, 1 );
        assert_int_equal( s.due[0], 19 );
        count_slack( tables[i / 5], &s, true, 0, 19 ); // it is beyond the end, but in the same group of eight
        assert_int_equal( s.due_count, 0 );
    }
}
