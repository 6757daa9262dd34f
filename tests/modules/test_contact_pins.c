// Pinned surfaces that are moved into free ones: they push one sheet by up to two thicknesses
// per substep, and layers by a third of one.
#include "contact_fixture.h"

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
