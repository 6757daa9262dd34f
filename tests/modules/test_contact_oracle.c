// The oracle of contact is sound: nearest points, energy. Momentum and friction hold the engine in test_contact.c. Lengths are of order 1 and masses
// between 0.1 and 10, so that about ten roundings add up to 1e-15; a tolerance of 1e-12 leaves room for amplification by a small
// denominator.
#include "oracle_support.h"

#include "oracle/contact_oracle.h"

static const uint64_t random_seed = 41;

static const double tolerance = 1e-12;

// Two simplices of at most three corners.
typedef struct couple
{
    double3 a[3], b[3];
    int count_a, count_b;
} couple;

static contact_oracle_closest closest_of( const couple* c )
{
    return c->count_a == 1 ? contact_oracle_point_triangle( c->a[0], c->b ) : contact_oracle_segments( c->a, c->b );
}

static void assert_is_of( const double weights[3], const double3* corners, int count, double3 point )
{
    double sum = 0.0;
    double3 there = double3_make( 0.0, 0.0, 0.0 );
    for ( int i = 0; i < 3; ++i )
    {
        assert_true( weights[i] >= 0.0 && ( i < count || weights[i] == 0.0 ) );
        sum += weights[i];
        there = i < count ? double3_add_scaled( there, weights[i], corners[i] ) : there;
    }
    assert_close( sum, 1.0, tolerance );
    assert_close( double3_distance( there, point ), 0.0, tolerance );
}

// The conditions of Karush, Kuhn and Tucker for two convex hulls: the points are in the hulls, and the slab between
// them, perpendicular to the connecting line, has all corners of A on one side and all of B on the other. No points
// of the hulls can then be closer than the width of the slab. A hundred times the tolerance, because corners are up
// to several lengths from the closest points, which amplifies an error of the normal.
static void assert_closest( const couple* c, const contact_oracle_closest* found )
{
    assert_is_of( found->a, c->a, c->count_a, found->on_a );
    assert_is_of( found->b, c->b, c->count_b, found->on_b );
    assert_close( double3_distance( found->on_a, found->on_b ), found->distance, tolerance );
    if ( found->distance < 1e-9 )
    {
        return; // intersecting hulls have no slab, and no points are closer than coincident ones
    }
    assert_close( double3_length( found->normal ), 1.0, tolerance );
    assert_close( double3_dot( found->normal, double3_sub( found->on_a, found->on_b ) ), found->distance, tolerance );
    for ( int i = 0; i < c->count_a; ++i )
    {
        for ( int j = 0; j < c->count_b; ++j )
        {
            const double apart = double3_dot( found->normal, double3_sub( c->a[i], c->b[j] ) );
            assert_true( apart >= found->distance - 100.0 * tolerance / fmin( 1.0, found->distance ) );
        }
    }
}

static couple random_couple( int n, bool segments )
{
    couple c = { .count_a = segments ? 2 : 1, .count_b = segments ? 2 : 3 };
    for ( int i = 0; i < 3; ++i )
    {
        c.a[i] = random_vector( n, i );
        c.b[i] = random_vector( n, 3 + i );
    }
    return c;
}

// A triangle that is a line or a point, segments that are parallel, in a row, or points.
static couple degenerate_couple( int n )
{
    couple c = random_couple( n, n % 6 >= 2 );
    const double3 way = double3_sub( c.b[1], c.b[0] );
    switch ( n % 6 )
    {
        case 0: // a line
            c.b[2] = double3_add_scaled( c.b[0], random_between( n, 90, -2.0, 2.0 ), way );
            break;
        case 1: // a point, or a line of two corners
            c.b[1] = c.b[0];
            c.b[2] = n % 12 < 6 ? c.b[0] : c.b[2];
            break;
        case 2: // parallel
            c.a[1] = double3_add_scaled( c.a[0], random_between( n, 90, -2.0, 2.0 ), way );
            break;
        case 3: // nearly parallel
            c.a[1] = double3_add_scaled( double3_add_scaled( c.a[0], random_between( n, 90, -2.0, 2.0 ), way ), 1e-9,
                                         random_vector( n, 31 ) );
            break;
        case 4: // without length
            c.a[1] = c.a[0];
            c.b[1] = n % 12 < 6 ? c.b[0] : c.b[1];
            break;
        default: // collinear
            c.a[0] = double3_add_scaled( c.b[0], random_between( n, 90, -2.0, 2.0 ), way );
            c.a[1] = double3_add_scaled( c.b[0], random_between( n, 91, -2.0, 2.0 ), way );
            break;
    }
    return c;
}

TEST( closest_points_have_a_slab_between_their_hulls )
{
    for ( int n = 0; n < 4000; ++n )
    {
        const couple some = random_couple( n, n % 2 == 0 ), flat = degenerate_couple( n );
        const contact_oracle_closest of_some = closest_of( &some ), of_flat = closest_of( &flat );
        assert_closest( &some, &of_some );
        assert_closest( &flat, &of_flat );
    }
}

enum
{
    VERTICES = 6,
};

// A contact of random weights in the middle of its substep: apart at its start, too close now.
typedef struct scene
{
    double w[VERTICES];
    double3 before[VERTICES], x[VERTICES];
    contact_oracle_contact contact;
} scene;

static contact_oracle_side random_side( int n, int at, int first )
{
    contact_oracle_side side = { .count = 1 + n % 3 };
    double sum = 0.0;
    for ( int i = 0; i < side.count; ++i )
    {
        side.vertex[i] = first + i;
        side.weight[i] = random_between( n, at + i, 0.01, 1.0 );
        sum += side.weight[i];
    }
    for ( int i = 0; i < side.count; ++i )
    {
        side.weight[i] /= sum;
    }
    return side;
}

static scene random_scene( int n )
{
    scene s = { .contact = { .a = random_side( n, 100, 0 ), .b = random_side( n / 3, 110, 3 ) } };
    for ( int i = 0; i < VERTICES; ++i )
    {
        s.w[i] = pow( 10.0, random_between( n, 120 + i, -1.0, 1.0 ) );
        s.before[i] = random_vector( n, 20 + i );
        s.x[i] = double3_add_scaled( s.before[i], 0.5, random_vector( n, 10 + i ) );
    }
    const double3 apart = double3_sub( contact_oracle_point_of( &s.contact.a, s.before ),
                                       contact_oracle_point_of( &s.contact.b, s.before ) );
    s.contact.normal = double3_scale( 1.0 / double3_length( apart ), apart );
    s.contact.gap = double3_length( apart ) * random_between( n, 130, 0.5, 1.0 );
    s.contact.friction = random_between( n, 131, 0.0, 4.0 );
    return s;
}

// Twice the energy of the displacements in the substep, times its time squared.
static double energy_of( const scene* s )
{
    double sum = 0.0;
    for ( int i = 0; i < VERTICES; ++i )
    {
        const double3 way = double3_sub( s->x[i], s->before[i] );
        sum += s->w[i] > 0.0 ? double3_dot( way, way ) / s->w[i] : 0.0;
    }
    return sum;
}

// A push is the nearest displacement, by mass, into the half space in which the points are apart, which contains the
// start of the substep; friction shortens the slip. Neither can lengthen the displacement.
TEST( energy_never_grows )
{
    int lost = 0;
    for ( int n = 0; n < 3000; ++n )
    {
        scene s = random_scene( n );
        assert_true( contact_oracle_value( &s.contact, s.before ) >= 0.0 );
        const double first = energy_of( &s );
        double last = first;
        for ( int round = 0; round < 4; ++round )
        {
            contact_oracle_push( &s.contact, s.w, s.x );
            const double pushed = energy_of( &s );
            assert_true( pushed <= last * ( 1.0 + tolerance ) );
            contact_oracle_rub( &s.contact, s.w, s.before, s.x );
            last = energy_of( &s );
            assert_true( last <= pushed * ( 1.0 + tolerance ) );
        }
        lost += last < 0.99 * first ? 1 : 0;
    }
    assert_true( lost > 500 );
}
