// Kernels of sums over particles: moments, small rotations, and the virial of links; their rigid motion, to which velocities
// go by the given fraction of their difference; displacements, deviations and separation bounds. Every table gives the
// same bits, and results agree with plain loops in doubles.
#include "kernels_fixture.h"

#include "double3.h"

// ---- moments ----

enum
{
    SLOTS = 608,
    COUNT = 603, // slots from here on pad
    LINKS = 400,
    EDGES = 250,
    KINDS = 3,
};

typedef struct body_of_particles
{
    _Alignas( 64 ) float position[SLOTS][4], previous[SLOTS][4], velocity[SLOTS][4];
    int32_t a_x4[LINKS], b_x4[LINKS], constraint[LINKS];
    float rest[LINKS];
} body_of_particles;

// Near the world's origin, far from it, or far from it with pinned particles. Positions are a step apart.
static body_of_particles* new_body( int kind )
{
    body_of_particles* b = checked_calloc( 1, sizeof( *b ) );
    const float far = kind > 0 ? 300.0f : 0.0f;
    for ( int i = 0; i < SLOTS; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            b->previous[i][k] = far * (float)( 1 - k ) + test_random_float( i, k, -1.0f, 1.0f );
            b->velocity[i][k] = i < COUNT ? test_random_float( i, 3 + k, -5.0f, 5.0f ) : 0.0f;
            b->position[i][k] = b->previous[i][k] + test_random_float( i, 6 + k, -0.01f, 0.01f );
        }
        const bool pinned = i >= COUNT || ( kind == 2 && i % 7 == 3 );
        b->position[i][3] = b->previous[i][3] = pinned ? 0.0f : test_random_float( i, 9, 0.5f, 2000.0f );
    }
    for ( int i = 0; i < LINKS; ++i )
    {
        const bool pads = i % 50 == 49;
        b->constraint[i] = pads ? -1 : ( i * 7 ) % LINKS;
        b->a_x4[i] = 4 * ( pads ? SLOTS - 1 : i );
        b->b_x4[i] = 4 * ( pads ? SLOTS - 1 : ( i * 5 + 1 ) % COUNT );
        b->rest[i] = pads ? 0.0f : test_random_float( i, 10, 0.1f, 1.5f );
    }
    return b;
}

static wisp_moment_args moment_args( const body_of_particles* b )
{
    return ( wisp_moment_args ){ .position = b->position[0],
                                 .previous = b->previous[0],
                                 .velocity = b->velocity[0],
                                 .origin = { b->previous[0][0], b->previous[0][1], b->previous[0][2] } };
}

static wisp_link_args link_args_of( body_of_particles* b )
{
    return ( wisp_link_args ){ .position = b->position[0],
                               .a_x4 = b->a_x4,
                               .b_x4 = b->b_x4,
                               .rest = b->rest,
                               .constraint = b->constraint,
                               .edge_count = EDGES };
}

static wisp_turn_args turn_args( const body_of_particles* b, float* rows )
{
    const float* first = b->previous[0];
    return ( wisp_turn_args ){ .position = b->position[0],
                               .rows = rows,
                               .angle = { 0.3e-3, -0.2e-3, 1e-3 },
                               .centre = { (double)first[0] + 0.1, (double)first[1], (double)first[2] - 0.2 } };
}

TEST( every_table_gives_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < KINDS * count; ++i )
    {
        body_of_particles *found = new_body( i % KINDS ), *expected = new_body( i % KINDS );
        wisp_moments sums[2][2];
        double virial[2];
        const wisp_kernels* kernels[2] = { tables[i / KINDS], tables[0] };
        for ( int k = 0; k < 2; ++k )
        {
            body_of_particles* b = k == 0 ? found : expected;
            wisp_moment_args moments = moment_args( b );
            const wisp_link_args links = link_args_of( b );
            const wisp_turn_args speeds = turn_args( b, b->velocity[0] ), places = turn_args( b, b->position[0] );
            kernels[k]->moments( &moments, 8, COUNT, &sums[k][0] );
            moments.previous = moments.position;
            kernels[k]->moments( &moments, 8, COUNT, &sums[k][1] );
            virial[k] = kernels[k]->link_virial( &links, 2000.0f, 20.0f, 8, LINKS );
            kernels[k]->turn( &speeds, 8, COUNT );
            kernels[k]->turn( &places, 8, COUNT );
        }
        assert_memory_equal( sums[0], sums[1], sizeof( sums[0] ) );
        assert_memory_equal( virial, virial + 1, sizeof( double ) );
        assert_memory_equal( found->position, expected->position, sizeof( found->position ) );
        assert_memory_equal( found->velocity, expected->velocity, sizeof( found->velocity ) );
        free( found );
        free( expected );
    }
}

enum
{
    SUMS = sizeof( wisp_moments ) / sizeof( double ),
};

// Add the terms of one particle, and their absolute values.
static void add_terms( const wisp_moment_args* args, int slot, double sums[SUMS], double sizes[SUMS] )
{
    const double w = (double)args->position[4 * slot + 3], mass = w > 0.0 ? 1.0 / w : 0.0;
    const double3 origin = double3_widen( args->origin );
    const double3 at = double3_sub( double3_from( args->position + 4 * slot ), origin );
    const double3 was = double3_sub( double3_from( args->previous + 4 * slot ), origin );
    const double3 v = double3_from( args->velocity + 4 * slot ), spin = double3_cross( was, v );
    const double p[3] = { at.x, at.y, at.z }, x[3] = { was.x, was.y, was.z }, u[3] = { v.x, v.y, v.z };
    const double l[3] = { spin.x, spin.y, spin.z };
    wisp_moments m = { .mass = mass, .pinned = w > 0.0 ? 0.0 : 1.0 };
    for ( int a = 0; a < 3; ++a )
    {
        m.first[a] = mass * p[a];
        m.previous[a] = mass * x[a];
        m.momentum[a] = mass * u[a];
        m.angular_momentum[a] = mass * l[a];
        for ( int b = 0; b < 3; ++b )
        {
            m.mixed[a][b] = mass * p[a] * x[b];
        }
    }
    for ( int k = 0; k < SUMS; ++k )
    {
        sums[k] += ( &m.mass )[k];
        sizes[k] += fabs( ( &m.mass )[k] );
    }
}

TEST( moments_are_those_of_a_plain_loop )
{
    const int ranges[][2] = { { 0, COUNT }, { 16, COUNT }, { 8, 64 }, { 600, COUNT }, { 0, 0 } };
    for ( int i = 0; i < 2 * KINDS * WISP_COUNT( ranges ); ++i )
    {
        body_of_particles* b = new_body( i % KINDS );
        wisp_moment_args args = moment_args( b );
        const int* range = ranges[i / KINDS / 2];
        args.previous = i / KINDS % 2 == 0 ? args.previous : args.position;
        wisp_moments found;
        double sums[SUMS] = { 0.0 }, sizes[SUMS] = { 0.0 };
        for ( int slot = range[0]; slot < range[1]; ++slot )
        {
            add_terms( &args, slot, sums, sizes );
        }
        widest_table()->moments( &args, range[0], range[1], &found );
        for ( int k = 0; k < SUMS; ++k )
        {
            // another order of as many terms; products of a cross product may be larger than their difference
            assert_near( ( &found.mass )[k], sums[k], 1e-13 * ( sizes[k] + sizes[0] ), "moment", k );
        }
        assert_true( found.pinned == sums[1] );
        free( b );
    }
}

// A rotation of all positions adds angle x (p - c) to each, rounded once, and leaves the rest alone.
TEST( a_turn_moves_what_is_not_pinned )
{
    for ( int i = 0; i < 2 * KINDS; ++i )
    {
        body_of_particles *b = new_body( i % KINDS ), *before = new_body( i % KINDS );
        float( *rows )[4] = i < KINDS ? b->velocity : b->position;
        float( *old )[4] = i < KINDS ? before->velocity : before->position;
        const wisp_turn_args args = turn_args( b, rows[0] );
        const double3 angle = { args.angle[0], args.angle[1], args.angle[2] },
                      centre = { args.centre[0], args.centre[1], args.centre[2] };
        widest_table()->turn( &args, 16, COUNT );
        for ( int slot = 0; slot < SLOTS; ++slot )
        {
            const bool turns = slot >= 16 && before->position[slot][3] > 0.0f;
            const double3 r = double3_sub( double3_from( before->position[slot] ), centre );
            const double3 to = double3_add( double3_from( old[slot] ), double3_cross( angle, r ) );
            const float expected[4] = { turns ? (float)to.x : old[slot][0], turns ? (float)to.y : old[slot][1],
                                        turns ? (float)to.z : old[slot][2], old[slot][3] };
            assert_memory_equal( rows[slot], expected, sizeof( expected ) );
        }
        free( b );
        free( before );
    }
}

TEST( the_virial_is_that_of_a_plain_loop )
{
    for ( int kind = 0; kind < KINDS; ++kind )
    {
        body_of_particles* b = new_body( kind );
        const wisp_link_args args = link_args_of( b );
        double sum = 0.0, size = 0.0;
        for ( int i = 8; i < LINKS; ++i )
        {
            const double3 d = double3_sub( double3_from( args.position + args.a_x4[i] ),
                                           double3_from( args.position + args.b_x4[i] ) );
            const double length = double3_length( d ), stiffness = b->constraint[i] < EDGES ? 2000.0 : 20.0;
            sum += b->constraint[i] >= 0 ? stiffness * ( length - (double)b->rest[i] ) * length : 0.0;
            size += stiffness * ( length + (double)b->rest[i] ) * length;
        }
        assert_near( widest_table()->link_virial( &args, 2000.0f, 20.0f, 8, LINKS ), sum, (double)FLT_EPSILON * size,
                     "virial", kind );
        assert_true( widest_table()->link_virial( &args, 2000.0f, 20.0f, 8, 8 ) == 0.0 );
        free( b );
    }
}

// ---- rigid motion ----

enum
{
    CROWD = 600, // more than two blocks of the sums
    CROWD_KINDS = 5,
};

typedef struct crowd
{
    _Alignas( 64 ) float position[CROWD][4], velocity[CROWD][4];
    wisp_rigid_args args;
} crowd;

// Near the world's origin or far from it, slow or fast, spread out or along a line, or so heavy that squares
// overflow.
static crowd make_crowd( int kind )
{
    crowd c = { .args = { .origin = { 0.0f, 0.0f, 0.0f } } };
    const float far = kind == 1 ? 300.0f : 0.0f, fast = kind == 2 ? 200.0f : 0.0f;
    for ( int i = 0; i < CROWD; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float along = test_random_float( i, 9, -1.0f, 1.0f ) * (float)( k + 1 );
            c.position[i][k] = far + ( kind == 3 ? along : test_random_float( i, k, -1.0f, 1.0f ) );
            c.velocity[i][k] = fast + test_random_float( i, 3 + k, -1.0f, 1.0f );
        }
        c.position[i][3] =
            i % 7 == 3 ? 0.0f : test_random_float( i, 6, 0.5f, 100.0f ) * ( kind == 4 ? 1e-35f : 1.0f );
    }
    c.args.origin = ( wisp_vec3 ){ c.position[1][0], c.position[1][1], c.position[1][2] };
    c.args.linear_velocity = ( wisp_vec3 ){ c.velocity[1][0], c.velocity[1][1], c.velocity[1][2] };
    c.args.inverse_mass = kind == 4 ? 1e-35f : 4.0f;
    c.args.angular_velocity = ( wisp_vec3 ){ 0.5f, -2.0f, 1.25f };
    c.args.fraction = 0.375f;
    return c;
}

static wisp_rigid_args rigid_job_of( crowd* c )
{
    wisp_rigid_args args = c->args;
    args.position = c->position[0];
    args.velocity = c->velocity[0];
    return args;
}

TEST( every_table_gives_the_same_bits_of_rigid_motions )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < CROWD_KINDS * count; ++i )
    {
        crowd found = make_crowd( i % CROWD_KINDS ), expected = make_crowd( i % CROWD_KINDS );
        const wisp_rigid_args one = rigid_job_of( &found ), other = rigid_job_of( &expected );
        wisp_rigid_sums sums, expected_sums;
        tables[i / CROWD_KINDS]->rigid_sums( &one, 8, CROWD, &sums );
        tables[0]->rigid_sums( &other, 8, CROWD, &expected_sums );
        tables[i / CROWD_KINDS]->rigid_approach( &one, 8, CROWD );
        tables[0]->rigid_approach( &other, 8, CROWD );
        assert_memory_equal( &sums, &expected_sums, sizeof( sums ) );
        assert_memory_equal( found.velocity, expected.velocity, sizeof( found.velocity ) );
    }
}

// Sums, and those of the absolute values of their terms.
static void add_rigid_terms( const crowd* c, int i, double sums[16], double sizes[16] )
{
    const float *p = c->position[i], *v = c->velocity[i];
    const wisp_vec3 o = c->args.origin, d = c->args.linear_velocity;
    const double mass = p[3] > 0.0f ? (double)c->args.inverse_mass / (double)p[3] : 0.0;
    const double r[3] = { (double)p[0] - (double)o.x, (double)p[1] - (double)o.y, (double)p[2] - (double)o.z },
                 u[3] = { (double)v[0] - (double)d.x, (double)v[1] - (double)d.y, (double)v[2] - (double)d.z };
    double terms[16] = { 1.0, r[0], r[1], r[2], u[0], u[1], u[2] };
    double most[16] = { 1.0 };
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        terms[7 + k] = r[a] * u[b] - r[b] * u[a];
        terms[10 + k] = r[k] * r[k];
        terms[13 + k] = k == 0 ? r[0] * r[1] : r[k - 1] * r[2];
        most[7 + k] = fabs( r[a] * u[b] ) + fabs( r[b] * u[a] );
    }
    for ( int k = 0; k < 16; ++k )
    {
        sums[k] += mass * terms[k];
        sizes[k] += mass * fmax( most[k], fabs( terms[k] ) );
    }
}

TEST( sums_are_those_of_all_that_move )
{
    for ( int kind = 0; kind < CROWD_KINDS; ++kind )
    {
        crowd c = make_crowd( kind );
        const wisp_rigid_args args = rigid_job_of( &c );
        wisp_rigid_sums found;
        double sums[16] = { 0.0 }, sizes[16] = { 0.0 }, numbers[16];
        for ( int i = 16; i < CROWD - 8; ++i )
        {
            add_rigid_terms( &c, i, sums, sizes );
        }
        widest_table()->rigid_sums( &args, 16, CROWD - 8, &found );
        memcpy( numbers, &found, sizeof( numbers ) );
        for ( int k = 0; k < 16; ++k )
        {
            // a product of three numbers, and 32 terms to a sum
            assert_near( numbers[k], sums[k], 4.0 * (double)FLT_EPSILON * sizes[k], "sum", 16 * kind + k );
        }
        widest_table()->rigid_sums( &args, 16, 16, &found );
        assert_true( found.mass == 0.0 && found.yz == 0.0 );
    }
}

TEST( velocities_go_their_share_of_the_way )
{
    for ( int kind = 0; kind < CROWD_KINDS; ++kind )
    {
        crowd c = make_crowd( kind ), before = make_crowd( kind );
        const wisp_rigid_args args = rigid_job_of( &c );
        widest_table()->rigid_approach( &args, 16, CROWD - 8 );
        for ( int i = 0; i < CROWD; ++i )
        {
            const bool goes = i >= 16 && i < CROWD - 8 && c.position[i][3] > 0.0f;
            const float* p = c.position[i];
            const wisp_vec3 o = args.origin, w = args.angular_velocity, d = args.linear_velocity;
            const double r[3] = { (double)p[0] - (double)o.x, (double)p[1] - (double)o.y,
                                  (double)p[2] - (double)o.z };
            const double rigid[3] = { (double)d.x + (double)w.y * r[2] - (double)w.z * r[1],
                                      (double)d.y + (double)w.z * r[0] - (double)w.x * r[2],
                                      (double)d.z + (double)w.x * r[1] - (double)w.y * r[0] };
            for ( int k = 0; k < 3; ++k )
            {
                const double v = (double)before.velocity[i][k];
                const double there = v + (double)args.fraction * ( rigid[k] - v );
                assert_near( (double)c.velocity[i][k], goes ? there : v,
                             goes ? 4.0 * (double)FLT_EPSILON * ( 8.0 + fabs( v ) ) : 0.0, "velocity", 3 * i + k );
            }
            assert_true( c.velocity[i][3] == 0.0f );
        }
    }
}

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
