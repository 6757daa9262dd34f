// The oracle of moving strands is sound: momentum, energy, the gradient of a rod's energy. Closed forms hold the engine in tests/claims/strands.yaml, and the engine is held to this oracle in
// test_strands_against_oracle.c.
#include "oracle_support.h"

#include "oracle/strand_oracle.h"

static const uint64_t random_seed = 41;

static const double line_density = 6.5e-6; // kg/m, a hair
static const double3 zero = { 0.0, 0.0, 0.0 };

// A crooked one with the density of a hair.
static strand_oracle new_crooked( int key, int count, bool held )
{
    strand_oracle strand;
    double3 points[MAX_STRAND_ORACLE];
    for ( int i = 0; i < count; ++i )
    {
        const double3 line = double3_make( 0.3 * i / count, 0.05 * i / count, -0.1 * i / count );
        points[i] = double3_add( line, double3_scale( 0.01, random_vector( key, i ) ) );
    }
    assert_true( strand_oracle_shape( &strand, points, count ) );
    strand_oracle_weigh( &strand, line_density, held );
    return strand;
}

static strand_oracle new_straight( int count, double length, bool held )
{
    strand_oracle strand;
    double3 points[MAX_STRAND_ORACLE];
    for ( int i = 0; i < count; ++i )
    {
        points[i] = double3_make( length * i / ( count - 1 ), 0.0, 0.0 );
    }
    assert_true( strand_oracle_shape( &strand, points, count ) );
    strand_oracle_weigh( &strand, line_density, held );
    strand_oracle_rest_straight( &strand );
    return strand;
}

// A curl of the given turns that hangs down.
static strand_oracle new_curl( int count, double turns, bool held )
{
    strand_oracle strand;
    double3 points[MAX_STRAND_ORACLE];
    for ( int i = 0; i < count; ++i )
    {
        const double fraction = i / ( count - 1.0 ), angle = 2.0 * pi * turns * fraction;
        points[i] = double3_make( 0.02 * cos( angle ), -0.04 * turns * fraction, 0.02 * sin( angle ) );
    }
    assert_true( strand_oracle_shape( &strand, points, count ) );
    strand_oracle_weigh( &strand, line_density, held );
    return strand;
}

static double3 momentum( const strand_oracle* strand )
{
    double3 sum = zero;
    for ( int i = 0; i < strand->count; ++i )
    {
        sum = double3_add_scaled( sum, strand->mass[i], strand->velocity[i] );
    }
    return sum;
}

static strand_oracle_settings floating_settings( double dt )
{
    strand_oracle_settings settings = strand_oracle_default_settings( dt );
    settings.gravity = zero;
    settings.passes = 8; // a strand that is reset does not keep its momentum: here none is
    settings.along.compliance = settings.bend.compliance = 1e-3;
    return settings;
}

// ---- conserved quantities ----

static void assert_momentum_kept( strand_oracle* strand, const strand_oracle_settings* settings )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        strand->velocity[i] = double3_add_scaled( double3_make( 0.05, 0.0, 0.0 ), 0.02, random_vector( 40, i ) );
    }
    const double3 start = momentum( strand );
    for ( int k = 0; k < 300; ++k )
    {
        assert_false( strand_oracle_substep( strand, settings, NULL ) );
    }
    // a substep rounds positions of 0.1 m to 1e-17 m, which is 1e-14 m/s; 300 of them, of 0.05 m/s
    assert_close( double3_distance( momentum( strand ), start ) / double3_length( start ), 0.0, 1e-11 );
}

TEST( the_momentum_of_a_free_strand_is_constant )
{
    const double dt = 1.0 / 600.0;
    for ( int k = 0; k < 3; ++k ) // direct, pbd, xpbd
    {
        strand_oracle strand = new_crooked( 2, 24, false );
        strand_oracle_settings settings = floating_settings( dt );
        settings.lengths = k == 0 ? STRAND_ORACLE_LENGTHS_DIRECT : STRAND_ORACLE_LENGTHS_LINKS;
        settings.bending = k == 0 ? STRAND_ORACLE_BENDING_NONE : STRAND_ORACLE_BENDING_LINKS;
        settings.along.inverse_dt2 = settings.bend.inverse_dt2 = k == 2 ? 1.0 / ( dt * dt ) : 0.0;
        assert_momentum_kept( &strand, &settings );
    }
    strand_oracle curl = new_curl( 24, 2.0, false );
    strand_oracle_stiffen( &curl, 8e-9, 6e-9, false, dt );
    strand_oracle_rest_shape( &curl );
    strand_oracle_settings settings = floating_settings( dt );
    settings.bending = STRAND_ORACLE_BENDING_ROD;
    assert_momentum_kept( &curl, &settings );
}

// ---- energy and its gradient ----

static void carry_frames( strand_oracle* strand )
{
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_sub( strand->position[s + 1], strand->position[s] );
        strand->frame[s] = strand_oracle_carried( strand->frame[s], e );
    }
}

// Displaced at random, with rest lengths; frames are carried along.
static void deform( strand_oracle* strand, int key, double by )
{
    double3 direction[MAX_STRAND_ORACLE];
    for ( int i = 1; i < strand->count; ++i )
    {
        strand->position[i] = double3_add( strand->position[i], double3_scale( by, random_vector( key, i ) ) );
    }
    strand_oracle_directions( strand, direction );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_scale( strand->length[s], direction[s] );
        strand->position[s + 1] = double3_add( strand->position[s], e );
    }
    carry_frames( strand );
}

// The rod's twist alone, iterated until it converges: nothing moves, because everything is held.
static void settle_twist( strand_oracle* strand )
{
    strand_oracle held = *strand;
    memset( held.weight, 0, sizeof( held.weight ) );
    memset( held.tension, 0, sizeof( held.tension ) );
    strand_oracle_rod_factor( &held, 0.0, 1e-3 );
    for ( int k = 0; k < 60; ++k )
    {
        strand_oracle_rod( &held, 0.0, 1e-3, NULL );
    }
    memcpy( strand->frame, held.frame, sizeof( held.frame ) );
}

static double energy_at( const strand_oracle* strand, int vertex, int axis, double h )
{
    strand_oracle moved = *strand;
    double* coordinate[3] = { &moved.position[vertex].x, &moved.position[vertex].y, &moved.position[vertex].z };
    *coordinate[axis] += h;
    carry_frames( &moved );
    return strand_oracle_rod_energy( &moved );
}

// Largest difference between the rod's gradient and central differences, of the largest component.
static double gradient_error( const strand_oracle* strand )
{
    double3 gradient[MAX_STRAND_ORACLE];
    double worst = 0.0, most = 0.0;
    strand_oracle_rod_gradient( strand, gradient );
    for ( int i = 1; i < strand->count; ++i )
    {
        const double g[3] = { gradient[i].x, gradient[i].y, gradient[i].z };
        for ( int axis = 0; axis < 3; ++axis )
        {
            // h^2 / l^2 of truncation and 1e-16 l / h of rounding are both below 1e-9 at l = 1 cm
            const double h = 1e-7;
            const double slope = ( energy_at( strand, i, axis, h ) - energy_at( strand, i, axis, -h ) ) / ( 2.0 * h );
            worst = fmax( worst, fabs( slope - g[axis] ) );
            most = fmax( most, fabs( g[axis] ) );
        }
    }
    assert_true( most > 0.0 );
    return worst / most;
}

// Where no bend twists: a plane curve with a rest curvature in its plane, and a rod that is straight at rest, bent and twisted.
TEST( the_gradient_is_that_of_the_energy_where_no_bend_twists )
{
    strand_oracle plane = new_straight( 12, 0.12, true );
    strand_oracle_stiffen( &plane, 1e-7, 7e-8, true, 0.0 );
    for ( int i = 1; i < 12; ++i )
    {
        plane.position[i].y = 0.004 * i * i / 11.0;
    }
    deform( &plane, 30, 0.0 );
    strand_oracle_rest_shape( &plane );
    for ( int i = 1; i < 12; ++i )
    {
        plane.position[i].y += 0.01 * random_between( 31, i, -1.0, 1.0 );
    }
    deform( &plane, 32, 0.0 );
    assert_true( gradient_error( &plane ) < 1e-6 );

    strand_oracle twisted = new_straight( 12, 0.12, true );
    strand_oracle_stiffen( &twisted, 1e-7, 7e-8, true, 0.0 );
    twisted.framed = true;
    deform( &twisted, 33, 0.005 );
    for ( int s = 0; s < 11; ++s )
    {
        const double half = 0.5 * random_between( 34, s, -0.5, 0.5 );
        const strand_oracle_quaternion turn = { 0.0, 0.0, sin( half ), cos( half ) };
        twisted.frame[s] = strand_oracle_product( twisted.frame[s], turn );
    }
    assert_true( gradient_error( &twisted ) < 1e-6 );
}

// Rest curvature and the axes of an elliptic section turn with their frames, which is exact where no vertex is twisted. The twist
// that holds the balance here leaves out a part of second order.
TEST( the_gradient_of_a_curl_leaves_out_a_thousandth )
{
    for ( int elliptic = 0; elliptic < 2; ++elliptic )
    {
        strand_oracle strand = new_curl( 12, 1.5, true );
        strand.flatness = elliptic == 1 ? 0.8 : 0.0;
        strand.guided = elliptic == 1;
        strand_oracle_stiffen( &strand, 1e-6, 7.5e-7, true, 0.0 );
        strand_oracle_rest_shape( &strand );
        deform( &strand, 35, 0.003 );
        settle_twist( &strand );
        assert_true( gradient_error( &strand ) < ( elliptic == 1 ? 2e-3 : 1e-3 ) );
    }
}
