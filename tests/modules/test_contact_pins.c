// Contact and pins. Pinned surfaces that are moved into free ones push one sheet by up to two thicknesses per substep, and
// layers by a third of one. A correction next to what is pinned is a lever, whose long end is a corner of a triangle that
// nothing holds. A cut leaves a point the rigid motion of its participant's pinned points, against double precision.
#include "contact_fixture.h"

#include "displacement_limit.h"
#include "predicted_motion.h"

// ---- moved ----

enum
{
    PLATE_SIDE = 9,
    PINS = PLATE_SIDE * PLATE_SIDE,
    LAYERS = 3,
};

static const float THICKNESS = 0.01f;

typedef struct push
{
    hosted h;
    wisp_entity plate, sheets[LAYERS];
    wisp_vec3 start[PINS];
    int32_t pins[PINS];
    int sheet_count;
    double height; // m, of the plate
} push;

// A plate of half a metre below free sheets, the lowest 10 cm above it.
static void open_push( push* p, int sheet_count )
{
    open_contact( &p->h, 8, 1, 1 );
    p->sheet_count = sheet_count;
    p->height = 0.0;
    test_mesh mesh = level_sheet( PLATE_SIDE, 0.48f, ( wisp_vec3 ){ 0 } );
    memcpy( p->start, mesh.points, sizeof( p->start ) );
    for ( int i = 0; i < PINS; ++i )
    {
        p->pins[i] = i;
    }
    p->plate = add_draping( p->h.world, &mesh, p->pins, PINS, ( wisp_vec3 ){ 0 } );
    const wisp_contact_def contact = contact_of( THICKNESS );
    set_contact( p->h.world, p->plate, &contact );
    for ( int i = 0; i < sheet_count; ++i )
    {
        test_mesh sheet =
            level_sheet( 17, 0.7f, ( wisp_vec3 ){ 0.013f, 0.1f + 0.012f * (float)i, 0.007f * (float)i } );
        p->sheets[i] = add_draping( p->h.world, &sheet, NULL, 0, ( wisp_vec3 ){ 0 } );
        set_contact( p->h.world, p->sheets[i], &contact );
    }
}

static void raise_plate( push* p, double speed, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        p->height += speed * (double)FRAME;
        wisp_vec3 targets[PINS];
        for ( int v = 0; v < PINS; ++v )
        {
            targets[v] = p->start[v];
            targets[v].y = (float)p->height;
        }
        assert_status( p->h.world, wisp_move_pins( p->h.world, p->plate, p->pins, targets, PINS ), WISP_OK );
        run_steps( p->h.world, 1, FRAME );
        wisp_entity all[LAYERS + 1] = { p->plate };
        memcpy( all + 1, p->sheets, sizeof( p->sheets ) );
        assert_int_equal( count_all_passing( p->h.world, all, p->sheet_count + 1 ), 0 );
    }
}

// No vertex above the middle of the plate is below it, and no sheet below the one under it.
static void assert_above( push* p )
{
    double below = p->height;
    for ( int i = 0; i < p->sheet_count; ++i )
    {
        for ( int v = 0; v < 17 * 17; ++v )
        {
            const float* at = place_of( p->h.world, p->sheets[i], v );
            assert_true( fabs( (double)at[0] ) > 0.2 || fabs( (double)at[2] ) > 0.2 || (double)at[1] > p->height );
        }
        const double mean = mean_of( p->h.world, p->sheets[i], 1 );
        assert_true( mean > below );
        below = mean;
        assert_false( wisp_is_halted( p->h.world, p->sheets[i] ) );
        assert_true( motion_stats_of( p->h.world, p->sheets[i] ).strain_max < 0.1 );
    }
}

TEST( a_plate_pushes_a_sheet_up_to_two_thicknesses_a_substep )
{
    const double speeds[] = { 1.0, 2.0, 3.5, 5.0, 7.0, 10.0 }; // 10 m/s: 21 mm per substep
    for ( int k = 0; k < WISP_COUNT( speeds ); ++k )
    {
        push p;
        open_push( &p, 1 );
        raise_plate( &p, speeds[k], 60 );
        assert_above( &p );
        close_world( &p.h );
    }
}

TEST( a_push_goes_on_through_layers )
{
    push p;
    open_push( &p, LAYERS );
    raise_plate( &p, 1.5, 60 ); // 3 mm per substep
    assert_above( &p );
    close_world( &p.h );
}

// ---- levers ----

// A triangle whose side is pinned, and whose third corner nothing holds. A point meets it so near to the side that the corner has a part of
// `weight` in the contact.
typedef struct lever
{
    hosted h;
    wisp_entity held, other;
    wisp_vec3 side[2], point[3];
} lever;

static void open_lever( lever* l, float weight, float height, bool is_pinned, float density )
{
    open_contact( &l->h, 4, 1, 1 );
    const int32_t pins[] = { 0, 1, 2 };
    const lever places = { .side = { { -0.5f, 0.0f, 0.0f }, { 0.5f, 0.0f, 0.0f } },
                           .point = { { 0.0f, height, weight },
                                      { 0.1f, 2.0f * height, weight - 0.1f },
                                      { -0.1f, 2.0f * height, weight - 0.1f } } };
    memcpy( l->side, places.side, sizeof( l->side ) );
    memcpy( l->point, places.point, sizeof( l->point ) );
    test_mesh mesh = triangle_mesh( l->side[0], l->side[1], ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } );
    l->held = add_mesh( l->h.world, &mesh, pins, 2, 0.15f );
    mesh = triangle_mesh( l->point[0], l->point[1], l->point[2] );
    l->other = add_mesh( l->h.world, &mesh, pins, is_pinned ? 3 : 0, density );
    const wisp_contact_def contact = contact_of( THICKNESS );
    set_contact( l->h.world, l->held, &contact );
    set_contact( l->h.world, l->other, &contact );
}

// Move pins down by a millimetre per step. @return m/s, the largest speed of the corner
static double press( lever* l, wisp_entity pinned, const wisp_vec3* from, int count )
{
    const int32_t pins[] = { 0, 1, 2 };
    double fastest = 0.0;
    for ( int i = 1; i <= 20; ++i )
    {
        wisp_vec3 to[3];
        for ( int k = 0; k < count; ++k )
        {
            to[k] = ( wisp_vec3 ){ from[k].x, from[k].y - 0.001f * (float)i, from[k].z };
        }
        assert_status( l->h.world, wisp_move_pins( l->h.world, pinned, pins, to, count ), WISP_OK );
        run_steps( l->h.world, 1, FRAME );
        const float* v = velocity_of( l->h.world, l->held, 2 );
        assert_false( wisp_is_halted( l->h.world, l->held ) );
        fastest = fmax( fastest, sqrt( (double)( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] ) ) );
    }
    return fastest;
}

// m/s. Pins that go down at 0.06 m/s, and a lever of four, make about 12 at most; without its bound the lever makes from 60 to 6000.
static const double TOO_FAST = 20.0;

static const float WEIGHTS[] = { 0.1f, 0.03f, 0.01f, 1e-3f, 1e-5f };

TEST( a_corner_is_not_thrown_by_a_point_that_is_pressed_on_its_pinned_side )
{
    for ( int i = 0; i < WISP_COUNT( WEIGHTS ); ++i )
    {
        lever l;
        open_lever( &l, WEIGHTS[i], 1.2f * THICKNESS, true, 0.15f );
        assert_true( press( &l, l.other, l.point, 3 ) < TOO_FAST );
        close_world( &l.h );
    }
}

TEST( a_corner_is_not_thrown_where_its_pinned_side_is_pressed_on_what_lies_on_the_ground )
{
    for ( int i = 0; i < WISP_COUNT( WEIGHTS ); ++i )
    {
        lever l;
        open_lever( &l, WEIGHTS[i], -1.2f * THICKNESS, false, 1000.0f );
        add_floor( l.h.world, ( wisp_vec3 ){ 0.0f, -2.4f * THICKNESS - 1e-4f, 0.0f },
                   ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        SET( l.h.world, l.other, collision, d.thickness = 1e-4f );
        assert_status( l.h.world, wisp_set_gravity( l.h.world, l.other, EARTH ), WISP_OK );
        assert_true( press( &l, l.held, l.side, 2 ) < TOO_FAST );
        close_world( &l.h );
    }
}

// ---- carried ----

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
