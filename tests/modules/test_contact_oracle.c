// Contact on its double-precision oracle. Lengths are of order 1 and masses between 0.1 and 10, so that about ten
// roundings add up to 1e-15; a tolerance of 1e-12 leaves room for amplification by a small denominator.
#include "oracle_support.h"

#include "oracle/contact_oracle.h"

static const uint64_t random_seed = 41;

static const double tolerance = 1e-12;

// ---- closest points ----

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

// The corners with a weight above zero, one bit each.
static int region_of( const double weights[3] )
{
    return ( weights[0] > 0.0 ? 1 : 0 ) + ( weights[1] > 0.0 ? 2 : 0 ) + ( weights[2] > 0.0 ? 4 : 0 );
}

static void a_point_finds_the_closest_of_a_triangle_in_all_seven_regions( void** state )
{
    (void)state;
    int seen[8] = { 0 };
    for ( int n = 0; n < 4000; ++n )
    {
        const couple c = random_couple( n, false );
        const contact_oracle_closest found = closest_of( &c );
        assert_closest( &c, &found );
        ++seen[region_of( found.b )];
    }
    for ( int region = 1; region < 8; ++region )
    {
        assert_true( seen[region] > 100 );
    }
}

static void segments_find_their_closest_points_in_all_nine_regions( void** state )
{
    (void)state;
    int seen[4][4] = { { 0 } };
    for ( int n = 0; n < 4000; ++n )
    {
        const couple c = random_couple( n, true );
        const contact_oracle_closest found = closest_of( &c );
        assert_closest( &c, &found );
        ++seen[region_of( found.a )][region_of( found.b )];
    }
    for ( int region = 0; region < 9; ++region )
    {
        assert_true( seen[1 + region / 3][1 + region % 3] > 50 );
    }
}

// No sample is closer, and one is nearly as close: samples are at most a step of the longest edge (below 4) away from
// any point of a hull.
static void no_sample_is_nearer( void** state )
{
    (void)state;
    enum
    {
        STEPS = 100,
    };
    for ( int n = 0; n < 60; ++n )
    {
        const couple c = random_couple( n, n % 2 == 0 );
        const contact_oracle_closest found = closest_of( &c );
        double nearest = 1e300;
        for ( int i = 0; i <= STEPS; ++i )
        {
            for ( int k = 0; k <= STEPS; ++k )
            {
                const double s = (double)i / STEPS, t = (double)k / STEPS;
                double3 a = c.a[0], b = double3_add_scaled( c.b[0], t, double3_sub( c.b[1], c.b[0] ) );
                if ( c.count_a == 2 )
                {
                    a = double3_add_scaled( a, s, double3_sub( c.a[1], c.a[0] ) );
                }
                else
                {
                    // s runs from the first edge to the third corner, so that the whole triangle is covered
                    b = double3_add_scaled( b, s, double3_sub( c.b[2], b ) );
                }
                nearest = fmin( nearest, double3_distance( a, b ) );
            }
        }
        assert_true( nearest >= found.distance - tolerance );
        assert_true( nearest <= found.distance + 4.0 / STEPS );
    }
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

static void what_is_flat_parallel_or_a_point_has_closest_points_too( void** state )
{
    (void)state;
    for ( int n = 0; n < 6000; ++n )
    {
        const couple c = degenerate_couple( n );
        const contact_oracle_closest found = closest_of( &c );
        assert_closest( &c, &found );
    }
}

static void closest_points_of_known_places( void** state )
{
    (void)state;
    const double3 t[3] = { { 0.0, 0.0, 0.0 }, { 4.0, 0.0, 0.0 }, { 0.0, 4.0, 0.0 } };
    const contact_oracle_closest above = contact_oracle_point_triangle( double3_make( 1.0, 1.0, 3.0 ), t );
    assert_close( above.distance, 3.0, tolerance );
    assert_close( above.normal.z, 1.0, tolerance );
    assert_close( above.b[0], 0.5, tolerance );
    const contact_oracle_closest within = contact_oracle_point_triangle( double3_make( 1.0, 1.0, 0.0 ), t );
    assert_close( within.distance, 0.0, 0.0 );
    assert_close( double3_length( within.normal ), 0.0, 0.0 );
    const double3 a[2] = { { -1.0, 0.0, 2.0 }, { 1.0, 0.0, 2.0 } }, b[2] = { { 0.0, -1.0, 0.0 }, { 0.0, 3.0, 0.0 } };
    const contact_oracle_closest crossed = contact_oracle_segments( a, b );
    assert_close( crossed.distance, 2.0, tolerance );
    assert_close( crossed.a[1], 0.5, tolerance );
    assert_close( crossed.b[1], 0.25, tolerance );
}

// ---- contact constraint ----

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

static void settle( scene* s, int rounds )
{
    for ( int round = 0; round < rounds; ++round )
    {
        contact_oracle_push( &s->contact, s->w, s->x );
        contact_oracle_rub( &s->contact, s->w, s->before, s->x );
    }
}

static double3 momentum_of( const scene* s, const double3* from )
{
    double3 sum = double3_make( 0.0, 0.0, 0.0 );
    for ( int i = 0; i < VERTICES; ++i )
    {
        sum = s->w[i] > 0.0 ? double3_add_scaled( sum, 1.0 / s->w[i], double3_sub( s->x[i], from[i] ) ) : sum;
    }
    return sum;
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

static void momentum_is_kept_by_pushing_and_rubbing( void** state )
{
    (void)state;
    int pushed = 0, rubbed = 0;
    for ( int n = 0; n < 3000; ++n )
    {
        scene s = random_scene( n );
        const double3 before = momentum_of( &s, s.before );
        settle( &s, 3 );
        assert_close( double3_distance( momentum_of( &s, s.before ), before ), 0.0, tolerance );
        pushed += s.contact.lambda > 0.0 ? 1 : 0;
        rubbed += double3_length( s.contact.rubbed ) > 0.0 ? 1 : 0;
    }
    assert_true( pushed > 500 && rubbed > 500 );
}

// The moment of a push is (yA - yB) x n lambda.
static void angular_momentum_is_kept_where_the_normal_joins_the_points( void** state )
{
    (void)state;
    int pushed = 0;
    for ( int n = 0; n < 3000; ++n )
    {
        scene s = random_scene( n );
        const double3 between =
            double3_sub( contact_oracle_point_of( &s.contact.a, s.x ), contact_oracle_point_of( &s.contact.b, s.x ) );
        s.contact.normal = double3_scale( 1.0 / double3_length( between ), between );
        s.contact.gap = random_between( n, 132, 0.5, 2.0 ) * double3_length( between );
        double3 at[VERTICES], moment = double3_make( 0.0, 0.0, 0.0 );
        memcpy( at, s.x, sizeof( at ) );
        pushed += contact_oracle_push( &s.contact, s.w, s.x ) > 0.0 ? 1 : 0;
        for ( int i = 0; i < VERTICES; ++i )
        {
            const double3 way = double3_sub( s.x[i], at[i] );
            moment = double3_add_scaled( moment, 1.0 / s.w[i], double3_cross( at[i], way ) );
        }
        assert_close( double3_length( moment ), 0.0, tolerance );
    }
    assert_true( pushed > 500 );
}

// A push is the nearest displacement, by mass, into the half space in which the points are apart, which contains the
// start of the substep; friction shortens the slip. Neither can lengthen the displacement.
static void energy_never_grows( void** state )
{
    (void)state;
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

static void one_push_leaves_the_gap_and_a_second_changes_nothing( void** state )
{
    (void)state;
    for ( int n = 0; n < 1000; ++n )
    {
        scene s = random_scene( n );
        const double value = contact_oracle_value( &s.contact, s.x );
        contact_oracle_push( &s.contact, s.w, s.x );
        assert_close( contact_oracle_value( &s.contact, s.x ), fmax( value, 0.0 ), tolerance );
        assert_close( contact_oracle_push( &s.contact, s.w, s.x ), 0.0, tolerance );
    }
}

// Other constraints may separate the two after a push: the push is then undone, and never becomes a pull.
static void what_was_pushed_too_far_is_given_back_and_no_more( void** state )
{
    (void)state;
    int given = 0;
    for ( int n = 0; n < 1000; ++n )
    {
        scene s = random_scene( n );
        const double pushed = contact_oracle_push( &s.contact, s.w, s.x );
        const double moved = random_between( n, 140, 0.0, 0.5 );
        for ( int i = 0; i < s.contact.a.count; ++i )
        {
            s.x[i] = double3_add_scaled( s.x[i], moved, s.contact.normal );
        }
        const double change = contact_oracle_push( &s.contact, s.w, s.x );
        const double mobility = contact_oracle_mobility( &s.contact, s.w );
        assert_close( change, -fmin( pushed, moved / mobility ), 10.0 * tolerance );
        assert_true( s.contact.lambda >= 0.0 );
        given += change < 0.0 ? 1 : 0;
    }
    assert_true( given > 200 );
}

// Two equal bodies collide head on at their contact distance.
static void equal_bodies_do_not_bounce( void** state )
{
    (void)state;
    scene s = { .w = { 0.5, 0.0, 0.0, 0.5, 0.0, 0.0 } };
    s.contact.a = ( contact_oracle_side ){ 1, { 0 }, { 1.0 } };
    s.contact.b = ( contact_oracle_side ){ 1, { 3 }, { 1.0 } };
    s.contact.normal = double3_make( 1.0, 0.0, 0.0 );
    s.contact.gap = 0.25;
    s.before[0] = double3_make( 0.25, 0.0, 0.0 );
    s.x[0] = double3_make( 0.15, 0.0, 0.0 );
    s.x[3] = double3_make( 0.3, 0.0, 0.0 );
    settle( &s, 1 );
    // both continue with the mean velocity, and lose the whole relative velocity
    assert_close( s.x[0].x - s.before[0].x, 0.1, tolerance );
    assert_close( s.x[3].x - s.before[3].x, 0.1, tolerance );
    assert_close( s.contact.lambda, 2.0 * 0.2, tolerance );
}

// Return whether a whole push would move a vertex by more than four times what the sides lack.
static bool has_long_lever( const scene* s )
{
    const contact_oracle_side* sides[2] = { &s->contact.a, &s->contact.b };
    double sum = 0.0, farthest = 0.0;
    for ( int k = 0; k < 2; ++k )
    {
        for ( int i = 0; i < sides[k]->count; ++i )
        {
            const double way = s->w[sides[k]->vertex[i]] * sides[k]->weight[i];
            sum += way * sides[k]->weight[i];
            farthest = fmax( farthest, fabs( way ) );
        }
    }
    return farthest > 4.0 * sum;
}

// Two corners of a triangle are pinned, and the contact is next to one of them.
static void no_point_moves_by_more_than_four_times_what_is_lacking( void** state )
{
    (void)state;
    scene s = { .w = { 0.0, 0.0, 2.0, 0.0, 0.0, 0.0 } };
    s.contact.a = ( contact_oracle_side ){ 3, { 0, 1, 2 }, { 0.9, 0.09, 0.01 } };
    s.contact.b = ( contact_oracle_side ){ 1, { 3 }, { 1.0 } };
    s.contact.normal = double3_make( 0.0, 1.0, 0.0 );
    s.contact.gap = 0.25;
    contact_oracle_push( &s.contact, s.w, s.x );
    assert_close( s.x[2].y, 4.0 * 0.25, tolerance );
}

static void what_is_pinned_pushes_and_is_not_pushed( void** state )
{
    (void)state;
    int pushed = 0;
    for ( int n = 0; n < 600; ++n )
    {
        scene s = random_scene( n );
        double3 at[VERTICES];
        memcpy( at, s.x, sizeof( at ) );
        memset( s.w + 3, 0, 3 * sizeof( s.w[0] ) );
        const double lacked = contact_oracle_value( &s.contact, s.x ) - tolerance;
        settle( &s, 2 );
        assert_memory_equal( s.x + 3, at + 3, 3 * sizeof( at[0] ) );
        pushed += s.contact.lambda > 0.0 ? 1 : 0;
        assert_true( contact_oracle_value( &s.contact, s.x ) >= ( has_long_lever( &s ) ? lacked : -tolerance ) );

        memset( s.w, 0, sizeof( s.w ) );
        memcpy( at, s.x, sizeof( at ) );
        settle( &s, 2 );
        assert_memory_equal( s.x, at, sizeof( at ) );
    }
    assert_true( pushed > 100 );
}

// ---- friction ----

static double3 slid( const scene* s )
{
    const double3 now =
        double3_sub( contact_oracle_point_of( &s->contact.a, s->x ), contact_oracle_point_of( &s->contact.b, s->x ) );
    const double3 then = double3_sub( contact_oracle_point_of( &s->contact.a, s->before ),
                                      contact_oracle_point_of( &s->contact.b, s->before ) );
    const double3 way = double3_sub( now, then );
    return double3_add_scaled( way, -double3_dot( way, s->contact.normal ), s->contact.normal );
}

// Within the cone nothing slides; on its border the remaining slip keeps its direction.
static void friction_holds_within_the_cone_and_slides_on_its_border( void** state )
{
    (void)state;
    int sticks = 0, slides = 0, free = 0;
    for ( int n = 0; n < 3000; ++n )
    {
        scene s = random_scene( n );
        const double3 way = slid( &s );
        settle( &s, 1 );
        const double rubbed = double3_length( s.contact.rubbed ), allowed = s.contact.friction * s.contact.lambda;
        const double requested = double3_length( way ) / contact_oracle_mobility( &s.contact, s.w );
        assert_close( double3_dot( s.contact.rubbed, s.contact.normal ), 0.0, tolerance );
        assert_close( rubbed, fmin( requested, allowed ), tolerance );
        const double left = requested > allowed ? 1.0 - allowed / requested : 0.0;
        assert_close( double3_distance( slid( &s ), double3_scale( left, way ) ), 0.0, tolerance );
        free += s.contact.lambda == 0.0 ? 1 : 0;
        sticks += s.contact.lambda > 0.0 && left == 0.0 ? 1 : 0;
        slides += s.contact.lambda > 0.0 && left > 0.0 ? 1 : 0;
    }
    assert_true( sticks > 200 && slides > 200 && free > 200 );
}

// Friction accumulated while they were pressed together is undone when they separate.
static void friction_goes_when_the_push_is_given_back( void** state )
{
    (void)state;
    int gone = 0;
    for ( int n = 0; n < 1000; ++n )
    {
        scene s = random_scene( n );
        settle( &s, 1 );
        gone += double3_length( s.contact.rubbed ) > 0.0 ? 1 : 0;
        for ( int i = 0; i < s.contact.a.count; ++i )
        {
            s.x[i] = double3_add_scaled( s.x[i], 10.0, s.contact.normal );
        }
        settle( &s, 1 );
        assert_close( s.contact.lambda, 0.0, 0.0 );
        assert_close( double3_length( s.contact.rubbed ), 0.0, 0.0 );
    }
    assert_true( gone > 200 );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_point_finds_the_closest_of_a_triangle_in_all_seven_regions ),
        cmocka_unit_test( segments_find_their_closest_points_in_all_nine_regions ),
        cmocka_unit_test( no_sample_is_nearer ),
        cmocka_unit_test( what_is_flat_parallel_or_a_point_has_closest_points_too ),
        cmocka_unit_test( closest_points_of_known_places ),
        cmocka_unit_test( momentum_is_kept_by_pushing_and_rubbing ),
        cmocka_unit_test( angular_momentum_is_kept_where_the_normal_joins_the_points ),
        cmocka_unit_test( energy_never_grows ),
        cmocka_unit_test( one_push_leaves_the_gap_and_a_second_changes_nothing ),
        cmocka_unit_test( what_was_pushed_too_far_is_given_back_and_no_more ),
        cmocka_unit_test( equal_bodies_do_not_bounce ),
        cmocka_unit_test( no_point_moves_by_more_than_four_times_what_is_lacking ),
        cmocka_unit_test( what_is_pinned_pushes_and_is_not_pushed ),
        cmocka_unit_test( friction_holds_within_the_cone_and_slides_on_its_border ),
        cmocka_unit_test( friction_goes_when_the_push_is_given_back ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
