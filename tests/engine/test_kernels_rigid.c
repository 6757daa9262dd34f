// The rigid motion of particles: every table gives the same bits, sums are compared with double precision, and
// velocities change by the given fraction of their difference.
#include "kernels_fixture.h"

enum
{
    COUNT = 600, // more than two blocks of the sums
    KINDS = 5,
};

typedef struct crowd
{
    _Alignas( 64 ) float position[COUNT][4], velocity[COUNT][4];
    wisp_rigid_args args;
} crowd;

// Near the world's origin or far from it, slow or fast, spread out or along a line, or so heavy that squares
// overflow.
static crowd make_crowd( int kind )
{
    crowd c = { .args = { .origin = { 0.0f, 0.0f, 0.0f } } };
    const float far = kind == 1 ? 300.0f : 0.0f, fast = kind == 2 ? 200.0f : 0.0f;
    for ( int i = 0; i < COUNT; ++i )
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

static wisp_rigid_args job_of( crowd* c )
{
    wisp_rigid_args args = c->args;
    args.position = c->position[0];
    args.velocity = c->velocity[0];
    return args;
}

TEST( every_table_gives_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int i = 0; i < KINDS * count; ++i )
    {
        crowd found = make_crowd( i % KINDS ), expected = make_crowd( i % KINDS );
        const wisp_rigid_args one = job_of( &found ), other = job_of( &expected );
        wisp_rigid_sums sums, expected_sums;
        tables[i / KINDS]->rigid_sums( &one, 8, COUNT, &sums );
        tables[0]->rigid_sums( &other, 8, COUNT, &expected_sums );
        tables[i / KINDS]->rigid_approach( &one, 8, COUNT );
        tables[0]->rigid_approach( &other, 8, COUNT );
        assert_memory_equal( &sums, &expected_sums, sizeof( sums ) );
        assert_memory_equal( found.velocity, expected.velocity, sizeof( found.velocity ) );
    }
}

// Sums, and those of the absolute values of their terms.
static void add_terms( const crowd* c, int i, double sums[16], double sizes[16] )
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
    for ( int kind = 0; kind < KINDS; ++kind )
    {
        crowd c = make_crowd( kind );
        const wisp_rigid_args args = job_of( &c );
        wisp_rigid_sums found;
        double sums[16] = { 0.0 }, sizes[16] = { 0.0 }, numbers[16];
        for ( int i = 16; i < COUNT - 8; ++i )
        {
            add_terms( &c, i, sums, sizes );
        }
        widest_table()->rigid_sums( &args, 16, COUNT - 8, &found );
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
    for ( int kind = 0; kind < KINDS; ++kind )
    {
        crowd c = make_crowd( kind ), before = make_crowd( kind );
        const wisp_rigid_args args = job_of( &c );
        widest_table()->rigid_approach( &args, 16, COUNT - 8 );
        for ( int i = 0; i < COUNT; ++i )
        {
            const bool goes = i >= 16 && i < COUNT - 8 && c.position[i][3] > 0.0f;
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
