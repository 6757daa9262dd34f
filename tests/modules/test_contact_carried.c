// What a cut leaves a point: the rigid motion of its participant's pinned points, against double precision.
#include "contact_fixture.h"

#include "carried_motion.h"
#include "displacement_limit.h"
#include "predicted_motion.h"

enum
{
    POINTS = 9,
};

// A contact mesh of points alone, in one or two participants.
typedef struct carriage
{
    float now[POINTS * 4], start[POINTS * 4], carried[POINTS * 4];
    contact_motion motion;
    contact_limit limit;
    contact_contact_mesh mesh;
    contact_participant participants[2];
    contact_work work;
} carriage;

// Points at places that lie in no plane; none is pinned, none moves.
static void open_carriage( carriage* c )
{
    *c = ( carriage ){ 0 };
    for ( int i = 0; i < POINTS; ++i )
    {
        const float place[3] = { 0.1f * (float)( i % 3 ), 0.07f * (float)( i / 3 ) - 0.2f,
                                 0.03f * (float)( i * i % 7 ) };
        memcpy( c->start + (size_t)i * 4, place, sizeof( place ) );
        memcpy( c->now + (size_t)i * 4, place, sizeof( place ) );
        c->now[4 * i + 3] = 1.0f;
        c->carried[4 * i] = 7.0f; // of a substep before
    }
    c->limit.carried = c->carried;
    c->mesh = ( contact_contact_mesh ){ .point_count = POINTS, .now = c->now, .intersection_free = c->start };
    c->mesh.motion = &c->motion;
    c->mesh.limit = &c->limit;
    c->participants[0].point_count = POINTS;
    c->work = ( contact_work ){ .contact_mesh = &c->mesh, .participants = c->participants, .participant_count = 1 };
}

static void pin( carriage* c, int point )
{
    c->now[4 * point + 3] = 0.0f;
}

// The displacement of a rigid motion about the origin.
static void rigid( const double along[3], const double rotation[3], const float at[3], double out[3] )
{
    const double x = (double)at[0], y = (double)at[1], z = (double)at[2];
    out[0] = along[0] + rotation[1] * z - rotation[2] * y;
    out[1] = along[1] + rotation[2] * x - rotation[0] * z;
    out[2] = along[2] + rotation[0] * y - rotation[1] * x;
}

// Move a point by `part` of a rigid motion and by something across it.
static void move( carriage* c, int point, const double along[3], const double rotation[3], double part,
                  double across )
{
    double way[3];
    rigid( along, rotation, c->start + (size_t)point * 4, way );
    const double size = sqrt( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] ), wide = hypot( way[0], way[1] );
    const double side[3] = { way[1] / wide, -way[0] / wide, 0.0 };
    for ( int k = 0; k < 3; ++k )
    {
        c->now[4 * point + k] += (float)( part * way[k] + across * size * side[k] );
    }
}

static void assert_carried( const carriage* c, int point, const double along[3], const double rotation[3],
                            double part )
{
    double way[3];
    rigid( along, rotation, c->start + (size_t)point * 4, way );
    for ( int k = 0; k < 3; ++k )
    {
        if ( !( fabs( (double)c->carried[4 * point + k] - part * way[k] ) < 2e-7 ) )
        {
            fail_msg( "point %d axis %d: carried %.9g, not %.9g", point, k, (double)c->carried[4 * point + k],
                      part * way[k] );
        }
    }
}

static const double NOWHERE[3] = { 0.0, 0.0, 0.0 };
static const double ALONG[3] = { 0.004, -0.009, 0.002 }, ROTATION[3] = { 0.02, -0.03, 0.05 };

// Three points pinned, which move rigidly. The others go as far, farther, half as far, against it, and across it.
TEST( a_point_is_carried_as_far_as_it_goes_along )
{
    static const struct
    {
        double part, across, carried;
    } OTHERS[] = { { 1.0, 0.0, 1.0 }, { 2.5, 0.3, 1.0 },  { 0.5, 0.0, 0.5 },
                   { 0.5, 2.0, 0.5 }, { -1.0, 0.0, 0.0 }, { 0.0, 3.0, 0.0 } };
    carriage c;
    open_carriage( &c );
    for ( int i = 0; i < 3; ++i )
    {
        pin( &c, 3 * i );
        move( &c, 3 * i, ALONG, ROTATION, 1.0, 0.0 );
    }
    for ( int i = 0, other = 0; i < POINTS; ++i )
    {
        if ( i % 3 != 0 )
        {
            move( &c, i, ALONG, ROTATION, OTHERS[other].part, OTHERS[other].across );
            other += 1;
        }
    }
    contact_find_carried( &c.work );
    assert_true( c.limit.carries );
    for ( int i = 0, other = 0; i < POINTS; ++i )
    {
        assert_carried( &c, i, ALONG, ROTATION, i % 3 == 0 ? 0.0 : OTHERS[other].carried );
        other += i % 3 == 0 ? 0 : 1;
    }
}

// The mean of all points is not carried: it is added elsewhere.
TEST( the_common_displacement_is_left_out )
{
    const double common[3] = { 0.5, 0.25, -0.5 };
    carriage c;
    open_carriage( &c );
    for ( int i = 0; i < POINTS; ++i )
    {
        c.motion.common[i % 3] = (float)common[i % 3];
        move( &c, i, ALONG, ROTATION, 1.0, 0.0 );
        for ( int k = 0; k < 3; ++k )
        {
            c.now[4 * i + k] += (float)common[k];
        }
    }
    pin( &c, 2 );
    pin( &c, 4 );
    pin( &c, 6 );
    contact_find_carried( &c.work );
    for ( int k = 0; k < 3; ++k ) // rounding of the common displacement stays
    {
        double way[3];
        rigid( ALONG, ROTATION, c.start, way );
        assert_true( fabs( (double)c.carried[k] - way[k] ) < 1e-5 );
    }
}

// Pinned points on a line do not tell how they turn about it.
TEST( pins_on_a_line_do_not_turn_about_it )
{
    const double about_x[3] = { 0.0, 0.04, -0.03 };
    carriage c;
    open_carriage( &c );
    for ( int i = 0; i < POINTS; ++i )
    {
        for ( int k = 1; k < 3 && i < 3; ++k )
        {
            c.start[4 * i + k] = c.now[4 * i + k] = 0.0f; // the first three are on the axis x
        }
        move( &c, i, ALONG, about_x, 1.0, 0.0 );
        if ( i < 3 )
        {
            pin( &c, i );
        }
    }
    contact_find_carried( &c.work );
    for ( int i = 3; i < POINTS; ++i )
    {
        assert_carried( &c, i, ALONG, about_x, 1.0 );
    }
}

// One pinned point carries along, and does not turn.
TEST( one_pin_carries_without_turning )
{
    carriage c;
    open_carriage( &c );
    pin( &c, 5 );
    for ( int i = 0; i < POINTS; ++i )
    {
        move( &c, i, ALONG, NOWHERE, 1.0, 0.0 );
    }
    contact_find_carried( &c.work );
    for ( int i = 0; i < POINTS; ++i )
    {
        assert_carried( &c, i, ALONG, NOWHERE, i == 5 ? 0.0 : 1.0 );
    }
}

TEST( nothing_is_carried_without_pins_that_move )
{
    for ( int pins = 0; pins <= POINTS; pins += POINTS / 3 )
    {
        for ( int moves = 0; moves < 2; ++moves )
        {
            carriage c;
            open_carriage( &c );
            for ( int i = 0; i < POINTS; ++i )
            {
                const bool is_pin = i < pins;
                move( &c, i, ALONG, ROTATION, is_pin ? 0.0 : 1.0, 0.0 );
                if ( is_pin )
                {
                    pin( &c, i );
                }
                if ( moves == 1 && ( pins == 0 || pins == POINTS ) )
                {
                    move( &c, i, ALONG, ROTATION, 1.0, 0.0 );
                }
            }
            c.limit.carries = true;
            contact_find_carried( &c.work );
            assert_false( c.limit.carries );
        }
    }
}

// Each participant goes with its own pins.
TEST( participants_are_carried_apart )
{
    const double other[3] = { -0.01, 0.0, 0.02 };
    carriage c;
    open_carriage( &c );
    c.participants[0].point_count = 4;
    c.participants[1] = ( contact_participant ){ .first_point = 4, .point_count = 5 };
    c.work.participant_count = 2;
    for ( int i = 0; i < POINTS; ++i )
    {
        move( &c, i, i < 4 ? ALONG : other, NOWHERE, 1.0, 0.0 );
    }
    pin( &c, 1 );
    pin( &c, 8 );
    contact_find_carried( &c.work );
    for ( int i = 0; i < POINTS; ++i )
    {
        assert_carried( &c, i, i < 4 ? ALONG : other, NOWHERE, i == 1 || i == 8 ? 0.0 : 1.0 );
    }
}
