// Membranes: the step of a triangle against its oracle, forces against differences of the energy, momenta.
#include "kernels_fixture.h"

#include "membrane_oracle.h"

enum
{
    TRIANGLES = 256,
    CORNER_COUNT = 3 * TRIANGLES,
};

typedef struct membranes
{
    _Alignas( 64 ) float position[CORNER_COUNT][4];
    float stress[TRIANGLES / 8][3][8];
    float shape[TRIANGLES / 8][4][8];
    int32_t slot_x4[TRIANGLES / 8][3][8];
    double rest[TRIANGLES][3][3];
    float stiffness;
    bool tension_field;
    double virial;
} membranes;

static float* corner_of( membranes* m, int triangle, int k )
{
    return m->position[3 * triangle + k];
}

// The rest shape lies in the plane z = 0, with its first edge along x. Numbers are exactly those of the kernel.
static void make_shape( membranes* m, int triangle )
{
    const double a = (double)test_random_float( 1, 4 * triangle, 0.02f, 0.05f ),
                 b = (double)test_random_float( 1, 4 * triangle + 1, -0.02f, 0.06f ),
                 h = (double)test_random_float( 1, 4 * triangle + 2, 0.01f, 0.05f );
    const double shape[4] = { 1.0 / a, -b / ( a * h ), 1.0 / h, 0.5 * a * h };
    const double rest[3][3] = { { 0.0 }, { a }, { b, h } };
    memcpy( m->rest[triangle], rest, sizeof rest );
    for ( int i = 0; i < 4; ++i )
    {
        m->shape[triangle / 8][i][triangle % 8] = (float)shape[i];
    }
}

// Stretched, sheared and turned, by parts from nearly nothing to threefold.
static void put( membranes* m, int triangle, float least, float most )
{
    const double s1 = (double)test_random_float( 2, 8 * triangle, least, most ),
                 s2 = (double)test_random_float( 2, 8 * triangle + 1, least, most ),
                 shear = (double)test_random_float( 2, 8 * triangle + 2, -0.5f, 0.5f ),
                 turn = (double)test_random_float( 2, 8 * triangle + 3, 0.0f, 6.0f );
    for ( int k = 0; k < 3; ++k )
    {
        const double x = s1 * m->rest[triangle][k][0] + shear * m->rest[triangle][k][1],
                     y = s2 * m->rest[triangle][k][1];
        float* p = corner_of( m, triangle, k );
        p[0] = (float)( cos( turn ) * x );
        p[1] = (float)y;
        p[2] = (float)( 0.1 + sin( turn ) * x );
        p[3] = triangle % 5 == k ? 0.0f : test_random_float( 3, 3 * triangle + k, 500.0f, 3000.0f );
        m->slot_x4[triangle / 8][k][triangle % 8] = 4 * ( 3 * triangle + k );
    }
}

static void make_membranes( membranes* m, float stiffness, float least, float most )
{
    m->stiffness = stiffness;
    for ( int t = 0; t < TRIANGLES; ++t )
    {
        make_shape( m, t );
        put( m, t, least, most );
    }
}

static membranes* new_membranes( float least, float most )
{
    membranes* m = new_aligned( sizeof( membranes ) );
    make_membranes( m, 1e3f, least, most );
    return m;
}

static wisp_elastic_triangle_args args_of( membranes* m )
{
    return ( wisp_elastic_triangle_args ){
        .position = m->position[0],
        .slot_x4 = m->slot_x4[0][0],
        .shape = m->shape[0][0],
        .stiffness = m->stiffness,
        .dt2 = 1e-6f,
        .tension_field = m->tension_field,
    };
}

static membrane_oracle_triangle oracle_of( membranes* m, int t )
{
    membrane_oracle_triangle o = { .stiffness = (double)m->stiffness, .tension_field = m->tension_field };
    memcpy( o.rest, m->rest[t], sizeof o.rest );
    for ( int k = 0; k < 3; ++k )
    {
        for ( int i = 0; i < 3; ++i )
        {
            o.position[k][i] = (double)corner_of( m, t, k )[i];
        }
        o.inverse_mass[k] = (double)corner_of( m, t, k )[3];
    }
    return o;
}

// 10 N/m is soft: a substep changes little. 1e5 N/m is stiff: a substep brings a triangle to rest. At 1 N/m the moves
// are those of the forces.
static void fill_membranes( void* state, int variant )
{
    static const float CASES[][3] = {
        { 10.0f, 0.8f, 1.6f }, { 1e3f, 0.6f, 3.0f }, { 1e5f, 0.7f, 2.0f }, { 1.0f, 0.8f, 2.0f }
    };
    membranes* m = state;
    m->tension_field = variant % 2 == 1;
    make_membranes( m, CASES[variant / 2][0], CASES[variant / 2][1], CASES[variant / 2][2] );
}

static void run_project( const wisp_kernels* kernels, void* state, int begin, int end )
{
    membranes* m = state;
    const wisp_elastic_triangle_args args = args_of( m );
    m->virial = kernels->elastic_triangle_virial( &args, begin, end );
    kernels->elastic_triangle_project( &args, begin, end );
}

static void check_moves( membranes* before, membranes* m, int t, double forces[3][3] )
{
    double largest = 0.0;
    for ( int k = 0; k < 9; ++k )
    {
        largest = fmax( largest, fabs( forces[k / 3][k % 3] ) );
    }
    for ( int k = 0; k < 9; ++k )
    {
        const double w = (double)corner_of( m, t, k / 3 )[3];
        const double move = (double)corner_of( m, t, k / 3 )[k % 3] - (double)corner_of( before, t, k / 3 )[k % 3];
        // the step is implicit: stretches relax by a few percent of their strain in it
        assert_near( move, -1e-6 * w * forces[k / 3][k % 3], 0.1e-6 * w * largest + 1e-8, "move", 9 * t + k );
    }
}

static void check_momenta( membranes* before, membranes* m, int t )
{
    double3 momentum = { 0.0, 0.0, 0.0 }, moment = momentum;
    double size = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const float* p = corner_of( before, t, k );
        if ( p[3] == 0.0f )
        {
            return; // it is held
        }
        const double3 moved = double3_sub( double3_from( corner_of( m, t, k ) ), double3_from( p ) );
        const double3 d = double3_scale( 1.0 / (double)p[3], moved );
        momentum = double3_add( momentum, d );
        moment = double3_add( moment, double3_cross( double3_from( p ), d ) );
        size += fabs( d.x ) + fabs( d.y ) + fabs( d.z );
    }
    const double3 none = { 0.0, 0.0, 0.0 };
    assert_near3( momentum, none, 1e-5 * size + 1e-10, "momentum", t );
    assert_near3( moment, none, 1e-6 * size + 1e-11, "moment", t );
}

// 3 P V = J for a force that scales the triangle: the derivative of the energy by a common factor.
static void check_project( void* start, void* end )
{
    membranes *before = start, *m = end;
    double virial = 0.0;
    for ( int t = 0; t < TRIANGLES; ++t )
    {
        membrane_oracle_triangle o = oracle_of( before, t );
        double forces[3][3];
        membrane_oracle_forces( &o, forces );
        for ( int k = 0; k < 9; ++k )
        {
            virial += forces[k / 3][k % 3] * o.position[k / 3][k % 3];
        }
        membrane_oracle_project( &o, 1e-3 );
        for ( int k = 0; k < 9; ++k )
        {
            // 0.2 % of a move, and rounding
            const double from = (double)corner_of( before, t, k / 3 )[k % 3], to = o.position[k / 3][k % 3];
            assert_near( (double)corner_of( m, t, k / 3 )[k % 3], to, 2e-3 * fabs( to - from ) + 2e-8, "corner",
                         9 * t + k );
        }
        check_momenta( before, m, t );
        if ( m->stiffness == 1.0f )
        {
            check_moves( before, m, t, forces );
        }
    }
    assert_near( m->virial, virial, 1e-5 * fabs( virial ), "J", 0 );
}

TEST_KERNEL( a_projection_is_that_of_the_oracle_follows_from_the_energy_and_keeps_momenta, membranes, 8, 0, TRIANGLES,
             0, fill_membranes, run_project, check_project )

// T : U of a triangle, U the root of F'F.
static double work_of_stress( membranes* m, int t )
{
    double f[2][3], c[3];
    float( *shape )[8] = m->shape[t / 8];
    for ( int i = 0; i < 3; ++i )
    {
        const double e1 = (double)corner_of( m, t, 1 )[i] - (double)corner_of( m, t, 0 )[i],
                     e2 = (double)corner_of( m, t, 2 )[i] - (double)corner_of( m, t, 0 )[i];
        f[0][i] = (double)shape[0][t % 8] * e1;
        f[1][i] = (double)shape[1][t % 8] * e1 + (double)shape[2][t % 8] * e2;
    }
    for ( int k = 0; k < 3; ++k )
    {
        const double *a = f[k == 1], *b = f[k > 0]; // xx, yy, xy
        c[k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
    const double root = sqrt( c[0] * c[1] - c[2] * c[2] ), trace = sqrt( c[0] + c[1] + 2.0 * root );
    float( *stress )[8] = m->stress[t / 8];
    return ( (double)stress[0][t % 8] * ( c[0] + root ) + (double)stress[1][t % 8] * ( c[1] + root ) +
             2.0 * (double)stress[2][t % 8] * c[2] ) /
           trace;
}

// With the stress kept, more projections end at implicit Euler, whatever the mobility that each assumes: the stress is that of the
// energy where a triangle ends.
TEST( several_iterations_agree_on_the_stress )
{
    SCOPED( free_local ) membranes *m = new_membranes( 0.7f, 2.0f ), *last = new_membranes( 0.7f, 2.0f );
    wisp_elastic_triangle_args args = args_of( m );
    args.stress = m->stress[0][0];
    for ( int i = 0; i < 200; ++i )
    {
        memcpy( last->position, m->position, sizeof m->position );
        widest_table()->elastic_triangle_project( &args, 0, TRIANGLES );
    }
    for ( int t = 0; t < TRIANGLES; ++t )
    {
        for ( int k = 0; k < 9; ++k )
        {
            assert_near( (double)corner_of( m, t, k / 3 )[k % 3], (double)corner_of( last, t, k / 3 )[k % 3], 1e-7,
                         "settled", 9 * t + k );
        }
        const membrane_oracle_triangle o = oracle_of( m, t );
        double forces[3][3], expected = 0.0;
        membrane_oracle_forces( &o, forces );
        for ( int k = 0; k < 9; ++k )
        {
            expected += 1e-6 * forces[k / 3][k % 3] * o.position[k / 3][k % 3];
        }
        assert_near( work_of_stress( m, t ), expected, 5e-3 * fabs( expected ) + 1e-9, "work", t );
    }
}

// Flat to a line or a point, too thin at rest, or all pinned: nothing moves to NaN, and what is stretched is still drawn together.
TEST( degenerate_triangles_stay_finite )
{
    SCOPED( free_local ) membranes* m = new_membranes( 0.7f, 2.0f );
    for ( int k = 0; k < 3; ++k )
    {
        memset( corner_of( m, 0, k ), 0, 3 * sizeof( float ) );
        corner_of( m, 1, k )[0] = 0.03f * (float)k;
        corner_of( m, 1, k )[1] = corner_of( m, 1, k )[2] = 0.0f;
        corner_of( m, 2, k )[3] = 0.0f;
        corner_of( m, 3, k )[0] *= 1e4f;
    }
    for ( int i = 0; i < 4; ++i )
    {
        m->shape[0][i][4] = 0.0f;
    }
    // a sliver of a millimetre: b^2 is 1e13 1/m^2, and the square of its mobility overflows
    const float sliver[4] = { 1e3f, -1.5e6f, 3e6f, 1.5e-10f };
    for ( int i = 0; i < 4; ++i )
    {
        m->shape[0][i][5] = sliver[i];
        corner_of( m, 5, i % 3 )[3] = 1e7f;
    }
    for ( int field = 0; field < 2; ++field )
    {
        m->tension_field = field == 1;
        const wisp_elastic_triangle_args args = args_of( m );
        const float before = corner_of( m, 5, 2 )[1];
        widest_table()->elastic_triangle_project( &args, 0, 8 );
        assert_true( field == 1 || corner_of( m, 5, 2 )[1] < 0.9f * before );
        for ( int i = 0; i < 24; ++i )
        {
            assert_true( isfinite( m->position[i][0] ) && isfinite( m->position[i][1] ) &&
                         isfinite( m->position[i][2] ) );
        }
        assert_true( isfinite( widest_table()->elastic_triangle_virial( &args, 0, 8 ) ) );
    }
}

static void run_thrice( const wisp_kernels* kernels, void* state, int begin, int end )
{
    membranes* m = state;
    wisp_elastic_triangle_args args = args_of( m );
    args.stress = m->stress[0][0];
    for ( int i = 0; i < 3; ++i )
    {
        kernels->elastic_triangle_project( &args, begin, end );
    }
}

TEST_KERNEL( stress_is_kept_to_the_same_bits, membranes, 8, 0, TRIANGLES, 8, fill_membranes, run_thrice, NULL )
