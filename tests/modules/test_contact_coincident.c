// Sheets that start in exactly one plane part: each to the side that the triangles of the sheets before it face.
#include "contact_fixture.h"

enum
{
    SHEETS = 5,
};

static const float THICKNESS = 0.01f;

typedef struct plies
{
    double heights[SHEETS]; // m, of the middles
    double strain, min_gap;
    int intersections;
    uint64_t hash;
} plies;

static plies part( bool same, int pinned, int workers )
{
    static const int sides[SHEETS] = { 9, 12, 9, 7, 14 };
    hosted h;
    open_contact( &h, 10, 1, workers );
    const int32_t pin = 0;
    wisp_entity sheets[SHEETS];
    const wisp_contact_def contact = contact_of( THICKNESS );
    for ( int i = 0; i < SHEETS; ++i )
    {
        test_mesh mesh = level_sheet( same ? 9 : sides[i], 0.3f, ( wisp_vec3 ){ 0 } );
        sheets[i] = add_draping( h.world, &mesh, &pin, i == pinned ? 1 : 0, ( wisp_vec3 ){ 0 } );
        assert_status( h.world, wisp_set_damping( h.world, sheets[i], 10.0f ), WISP_OK );
        set_contact( h.world, sheets[i], &contact );
    }
    request_stats( h.world );
    run_steps( h.world, 120, FRAME );
    plies end = { .hash = wisp_world_hash( h.world ) };
    for ( int i = 0; i < SHEETS; ++i )
    {
        const wisp_motion_stats m = motion_stats_of( h.world, sheets[i] );
        end.strain = fmax( end.strain, m.strain_max );
        end.heights[i] = m.centre[1];
    }
    end.min_gap = (double)contact_stats( h.world ).min_gap;
    end.intersections = contact_stats( h.world ).intersections;
    close_world( &h );
    return end;
}

TEST( sheets_in_one_plane_part )
{
    for ( int k = 0; k < 4; ++k )
    {
        const plies end = part( k % 2 == 0, k < 2 ? -1 : SHEETS - 1, 2 );
        print_message( "           %s sheets, %s: smallest gap %.3f, strain %.4f, heights",
                       k % 2 == 0 ? "equal" : "unlike", k < 2 ? "free" : "the last one pinned", end.min_gap,
                       end.strain );
        for ( int i = 0; i < SHEETS; ++i )
        {
            print_message( " %.4f", end.heights[i] );
        }
        print_message( " m\n" );
        assert_int_equal( end.intersections, 0 );
        assert_true( end.min_gap > 0.8 );
        assert_true( end.strain < 0.05 );
        for ( int i = 1; i < SHEETS; ++i )
        {
            assert_true( end.heights[i] - end.heights[i - 1] > 0.8 * (double)THICKNESS );
        }
    }
}

TEST( they_part_to_the_same_bits_for_any_number_of_workers )
{
    const plies one = part( false, -1, 1 );
    assert_true( part( false, -1, 2 ).hash == one.hash );
    assert_true( part( false, -1, 5 ).hash == one.hash );
}
