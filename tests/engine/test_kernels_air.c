// Air on the triangles around vertices: every table gives the same bits, which agree with double precision.
#include "kernels_fixture.h"

#include "double3.h"

enum
{
    SLOTS = 64,
    RING = 7, // entries of a slice
};

typedef struct air_scene
{
    _Alignas( 64 ) float position[SLOTS][4];
    _Alignas( 64 ) float old_velocity[SLOTS][4];
    _Alignas( 64 ) float velocity[SLOTS][4];
    int32_t ring_begin[SLOTS / 8 + 1];
    int32_t ring_x4[SLOTS / 8 * RING][8];
    float lift;
} air_scene;

static air_scene* new_scene( void )
{
    air_scene* s = checked_calloc( 1, sizeof( air_scene ) );
    s->lift = 0.4f;
    for ( int v = 0; v < SLOTS; ++v )
    {
        for ( int k = 0; k < 3; ++k )
        {
            s->position[v][k] = test_random_float( v, k, -1.0f, 1.0f );
            s->old_velocity[v][k] = test_random_float( v, 3 + k, -5.0f, 5.0f );
        }
        s->position[v][3] = v % 5 == 0 ? 0.0f : test_random_float( v, 7, 10.0f, 2000.0f ); // 1/kg; some are pinned
        s->old_velocity[v][3] = (float)v;
    }
    memcpy( s->position[7], s->position[6], 3 * sizeof( float ) ); // triangles without area
    for ( int slice = 0; slice < SLOTS / 8; ++slice )
    {
        s->ring_begin[slice + 1] = ( slice + 1 ) * RING;
        for ( int e = 0; e < RING; ++e )
        {
            for ( int lane = 0; lane < 8; ++lane )
            {
                // every third fan is short: its own slot pads
                const int own = slice * 8 + lane, other = ( own + 1 + e * 7 % 5 + e ) % SLOTS;
                s->ring_x4[slice * RING + e][lane] = 4 * ( own % 3 == 0 && e > 3 ? own : other );
            }
        }
    }
    return s;
}

static wisp_ring_air_args job_of( air_scene* s )
{
    return ( wisp_ring_air_args ){
        .position = s->position[0],
        .old_velocity = s->old_velocity[0],
        .velocity = s->velocity[0],
        .ring_begin = s->ring_begin,
        .ring_x4 = (const int32_t( * )[8])s->ring_x4,
        .wind = { 3.0f, -1.0f, 0.5f },
        .density = 1.2f,
        .drag = 1.1f,
        .lift = s->lift,
        .dt = 1.0f / 600.0f,
    };
}

static void run( const wisp_kernels* kernels, air_scene* s )
{
    const wisp_ring_air_args args = job_of( s );
    kernels->ring_air( &args, 0, SLOTS / 8 );
}

static void make_strange( air_scene* s )
{
    s->position[20][0] = NAN;
    s->position[21][1] = INFINITY;
    s->position[22][2] = -INFINITY;
    s->position[23][0] = 1e30f;
    s->old_velocity[26][1] = INFINITY;
}

TEST( every_table_gives_the_same_bits )
{
    const wisp_kernels* tables[MAX_TABLES];
    const int count = usable_tables( tables );
    for ( int variant = 0; variant < 4; ++variant )
    {
        air_scene* found[MAX_TABLES];
        for ( int t = 0; t < count; ++t )
        {
            found[t] = new_scene();
            found[t]->lift = variant < 2 ? 0.4f : 0.0f;
            if ( variant % 2 == 1 )
            {
                make_strange( found[t] );
            }
            run( tables[t], found[t] );
            assert_memory_equal( found[t]->velocity, found[0]->velocity, sizeof( found[t]->velocity ) );
        }
        for ( int t = 0; t < count; ++t )
        {
            free( found[t] );
        }
    }
}

// ---- against double precision ----

static double3 combine( double s, double3 a, double t, double3 b )
{
    return double3_add_scaled( double3_scale( s, a ), t, b );
}

// F = 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') / |u| u ) ). @param lift receives the second term
static double3 triangle_force( const wisp_ring_air_args* args, air_scene* s, const int slots[3], double* rate,
                               double3* lift )
{
    const double3 p = double3_from( s->position[slots[0]] );
    const double3 e = combine( 1.0, double3_from( s->position[slots[1]] ), -1.0, p );
    const double3 f = combine( 1.0, double3_from( s->position[slots[2]] ), -1.0, p ), normal = double3_cross( e, f );
    double3 u = double3_widen( args->wind );
    for ( int k = 0; k < 3; ++k )
    {
        u = combine( 1.0, u, -1.0 / 3.0, double3_from( s->old_velocity[slots[k]] ) );
    }
    const double area = 0.5 * double3_length( normal ), speed = double3_length( u );
    *rate = 0.0;
    *lift = ( double3 ){ 0.0, 0.0, 0.0 };
    if ( area == 0.0 )
    {
        return ( double3 ){ 0.0, 0.0, 0.0 };
    }
    const double facing = double3_dot( u, normal ) / ( 2.0 * area );
    const double3 n = combine( ( facing < 0.0 ? -1.0 : 1.0 ) / ( 2.0 * area ), normal, 0.0, normal );
    const double pressure = 0.5 * (double)args->density * area * fabs( facing );
    const double3 foreign = combine( speed, n, -double3_dot( u, n ) / speed, u );
    *rate = pressure * ( (double)args->drag + (double)args->lift );
    *lift = double3_scale( pressure * (double)args->lift, foreign );
    return combine( pressure * (double)args->drag, u, 1.0, *lift );
}

static void compare_with_formula( float lift_coefficient )
{
    air_scene* s = new_scene();
    s->lift = lift_coefficient;
    const wisp_ring_air_args args = job_of( s );
    run( widest_table(), s );
    for ( int v = 0; v < SLOTS; ++v )
    {
        double3 force = { 0.0, 0.0, 0.0 }, lift = force;
        double rate = 0.0;
        for ( int e = 1; e < RING; ++e )
        {
            double own;
            double3 own_lift;
            const int slots[3] = { v, s->ring_x4[v / 8 * RING + e - 1][v % 8] / 4,
                                   s->ring_x4[v / 8 * RING + e][v % 8] / 4 };
            force = combine( 1.0, force, 1.0 / 3.0, triangle_force( &args, s, slots, &own, &own_lift ) );
            lift = combine( 1.0, lift, 1.0 / 3.0, own_lift );
            rate += own / 3.0;
        }
        const double w = (double)s->position[v][3], dt = (double)args.dt, change = dt * w / ( 1.0 + dt * w * rate );
        // lift turns the relative wind: the square of its step is taken out of the speed again
        const double3 wind = double3_widen( args.wind );
        const double3 blown = combine( 1.0, double3_from( s->old_velocity[v] ), change, force );
        const double3 relative = combine( 1.0, blown, -1.0, wind );
        const double square = double3_dot( relative, relative );
        const double left = fmax( square - change * change * double3_dot( lift, lift ), 0.0 );
        const double3 expected =
            w > 0.0 ? combine( 1.0, wind, sqrt( left / square ), relative ) : double3_from( s->old_velocity[v] );
        // forces of a few newtons on as little as half a gram are reduced by the implicit rate: the result is below
        // the speeds of wind and vertices, and so is its rounding, about thirty times
        const double tolerance = 30.0 * 10.0 * (double)FLT_EPSILON;
        assert_near( (double)s->velocity[v][0], expected.x, tolerance, "velocity along x of slot", v );
        assert_near( (double)s->velocity[v][1], expected.y, tolerance, "velocity along y of slot", v );
        assert_near( (double)s->velocity[v][2], expected.z, tolerance, "velocity along z of slot", v );
        assert_true( s->velocity[v][3] == (float)v );
    }
    free( s );
}

TEST( a_vertex_takes_a_third_of_the_air_on_its_triangles )
{
    compare_with_formula( 0.4f );
    compare_with_formula( 0.0f ); // drag alone takes no root
}

TEST( what_is_pinned_keeps_its_velocity )
{
    air_scene* s = new_scene();
    make_strange( s );
    run( widest_table(), s );
    for ( int v = 0; v < SLOTS; v += 5 )
    {
        assert_memory_equal( s->velocity[v], s->old_velocity[v], sizeof( s->velocity[v] ) );
    }
    free( s );
}

TEST( a_corner_that_is_not_finite_spoils_no_neighbour )
{
    air_scene* s = new_scene();
    make_strange( s );
    run( widest_table(), s );
    for ( int v = 0; v < SLOTS; ++v )
    {
        assert_true( v == 26 || ( isfinite( s->velocity[v][0] ) && isfinite( s->velocity[v][1] ) &&
                                  isfinite( s->velocity[v][2] ) ) );
    }
    free( s );
}
