// Moments of particles, small rotations, and the virial of links: every table gives the same bits, and they agree with a plain
// loop in doubles.
#include "kernels_fixture.h"

#include "double3.h"

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
