// Contact and pins. Pinned surfaces that are moved into free ones push one sheet by up to two thicknesses per substep, and
// layers by a third of one. A correction next to what is pinned is a lever, whose long end is a corner of a triangle that
// nothing holds.
#include "contact_fixture.h"

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
