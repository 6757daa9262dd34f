// Piles of sheets on a floor: bodies win over contact, heavy layers do not crush light ones, and their weight reaches the
// friction below.
#include "contact_fixture.h"

enum
{
    SIDE = 9, // vertices of a sheet
    MAX_SHEETS = 10,
    SECONDS = 3,
};

static const float THICKNESS = 0.01f; // m
static const float SPACING = 0.05f;   // m; sheets keep a quarter of it from the floor

// m, between the means of two sheets: their turned corners hang over and down.
static const double MEAN_GAP = 0.009;

typedef struct pile
{
    hosted h;
    wisp_entity sheets[MAX_SHEETS];
    int count;
} pile;

static void add_sheet( pile* p, float density, wisp_vec3 gravity, float friction )
{
    const int number = p->count++;
    test_mesh mesh = test_plane( SIDE, SPACING );
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        // Meshes that lie on each other vertex by vertex would be a special case.
        const float angle = 0.37f * (float)number, x = mesh.points[v].x - 0.2f, z = mesh.points[v].z - 0.2f;
        mesh.points[v] = ( wisp_vec3 ){ x * cosf( angle ) - z * sinf( angle ), 0.014f + 0.012f * (float)number,
                                        x * sinf( angle ) + z * cosf( angle ) };
    }
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = density;
    const wisp_entity e = p->sheets[number] = test_surface_of( p->h.world, &fabric, surface );
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_contact_def contact = contact_of( THICKNESS );
    contact.friction = friction;
    assert_status( p->h.world, wisp_set_cloth( p->h.world, e, &cloth ), WISP_OK );
    assert_status( p->h.world, wisp_set_gravity( p->h.world, e, gravity ), WISP_OK );
    assert_status( p->h.world, wisp_set_damping( p->h.world, e, 0.5f ), WISP_OK );
    assert_status( p->h.world, wisp_request( p->h.world, e, WISP_MOTION_STATS ), WISP_OK );
    set_collision( p->h.world, e );
    assert_status( p->h.world, wisp_request_collision_stats( p->h.world, e, true ), WISP_OK );
    set_contact( p->h.world, e, &contact );
    test_mesh_free( &mesh );
}

// A pile whose layers have these densities, the lowest first. @param slope tangent of the angle of the floor
static void open_pile( pile* p, const float* densities, int count, float slope, float friction, int workers )
{
    *p = ( pile ){ .count = 0 };
    open_contact( &p->h, 10, 1, workers );
    const float along = 9.81f / sqrtf( 1.0f + slope * slope );
    add_floor( p->h.world, ( wisp_vec3 ){ 0, 0, 0 }, ( wisp_vec3 ){ 0, 1, 0 } );
    for ( int i = 0; i < count; ++i )
    {
        add_sheet( p, densities[i], ( wisp_vec3 ){ along * slope, -along, 0 }, friction );
    }
    request_stats( p->h.world );
}

static void run_pile( pile* p, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        assert_status( p->h.world, wisp_world_step( p->h.world, FRAME ), WISP_OK );
    }
}

// m, how far the sheet is inside what it keeps from the floor.
static double depth_of( pile* p, int sheet )
{
    wisp_collision_stats stats;
    assert_status( p->h.world, wisp_read_collision_stats( p->h.world, p->sheets[sheet], &stats ), WISP_OK );
    return (double)stats.penetration;
}

TEST( a_heavy_sheet_does_not_push_a_light_one_into_the_floor )
{
    const float ratios[] = { 1.0f, 100.0f, 1e4f };
    for ( int k = 0; k < WISP_COUNT( ratios ); ++k )
    {
        const float densities[] = { 0.1f, 0.1f * ratios[k] };
        pile p;
        open_pile( &p, densities, 2, 0.0f, 0.3f, 1 );
        double deepest = 0.0;
        for ( int i = 0; i < 60 * SECONDS; ++i )
        {
            run_pile( &p, 1 );
            deepest = fmax( deepest, depth_of( &p, 0 ) );
        }
        const double gap = mean_of( p.h.world, p.sheets[1], 1 ) - mean_of( p.h.world, p.sheets[0], 1 );
        const double speed = motion_stats_of( p.h.world, p.sheets[1] ).speed_max;
        if ( !( deepest < 0.1 * (double)THICKNESS && gap > MEAN_GAP && speed < 0.01 ) )
        {
            fail_msg( "ratio %g: %.3g m inside the floor, %.3g m apart, %.3g m/s after %d s", (double)ratios[k],
                      deepest, gap, speed, SECONDS );
        }
        assert_int_equal( contact_stats( p.h.world ).intersections, 0 );
        close_world( &p.h );
    }
}

TEST( ten_sheets_keep_their_thickness )
{
    const float densities[MAX_SHEETS] = { 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f, 0.2f };
    pile p;
    open_pile( &p, densities, MAX_SHEETS, 0.0f, 0.3f, 2 );
    run_pile( &p, 60 * SECONDS );
    assert_true( depth_of( &p, 0 ) < 0.1 * (double)THICKNESS );
    for ( int i = 1; i < MAX_SHEETS; ++i )
    {
        const double gap = mean_of( p.h.world, p.sheets[i], 1 ) - mean_of( p.h.world, p.sheets[i - 1], 1 );
        if ( !( gap > MEAN_GAP ) )
        {
            fail_msg( "sheet %d is %.3g m above the one below", i, gap );
        }
    }
    const wisp_contact_stats stats = contact_stats( p.h.world );
    assert_true( stats.min_gap > 0.8f );
    assert_int_equal( stats.intersections, 0 );
    close_world( &p.h );
}

// The light sheet has friction 0.5 with the floor only under the weight of the heavy one, which pulls it down the slope.
TEST( the_weight_above_holds_the_lowest_layer_on_a_slope )
{
    const float densities[] = { 0.1f, 10.0f };
    pile p;
    open_pile( &p, densities, 2, 0.4f, 0.8f, 1 );
    run_pile( &p, 60 );
    const double before[2] = { mean_of( p.h.world, p.sheets[0], 0 ), mean_of( p.h.world, p.sheets[1], 0 ) };
    run_pile( &p, 150 );
    const double lower = mean_of( p.h.world, p.sheets[0], 0 ) - before[0],
                 upper = mean_of( p.h.world, p.sheets[1], 0 ) - before[1];
    if ( !( fabs( lower ) < 2e-3 && fabs( upper ) < 2e-3 ) )
    {
        fail_msg( "in 2.5 s the lower sheet slid by %.3g m, the upper one by %.3g m", lower, upper );
    }
    close_world( &p.h );
}

// On a slope above the angle of friction of the floor, the pile slides as the law of Coulomb says: a = g (sin - mu cos).
TEST( a_pile_slides_where_friction_is_too_low )
{
    const float densities[] = { 0.1f, 10.0f };
    pile p;
    open_pile( &p, densities, 2, 0.8f, 2.0f, 1 );
    run_pile( &p, 30 );
    const double cosine = 1.0 / sqrt( 1.0 + 0.64 ), start = motion_stats_of( p.h.world, p.sheets[1] ).momentum[0];
    run_pile( &p, 30 );
    const wisp_motion_stats stats = motion_stats_of( p.h.world, p.sheets[1] );
    const double gained = ( stats.momentum[0] - start ) / stats.mass;
    // Between 0.5 and 1 s, with damping of 0.5 1/s.
    const double expected = 9.81 * cosine * ( 0.8 - 0.5 ) * ( exp( -0.25 ) - exp( -0.5 ) ) / 0.5;
    assert_near( gained, expected, 0.05 * expected );
    close_world( &p.h );
}

// Snapshots hold the loads, and blocks of rows do not depend on workers.
TEST( piles_do_not_depend_on_workers_or_snapshots )
{
    const float densities[] = { 0.1f, 1.0f, 0.2f };
    uint64_t hashes[3];
    const int workers[] = { 1, 2, 5 };
    for ( int k = 0; k < WISP_COUNT( workers ); ++k )
    {
        pile p;
        open_pile( &p, densities, 3, 0.2f, 0.5f, workers[k] );
        run_pile( &p, 40 );
        const size_t size = wisp_world_snapshot_size( p.h.world );
        void* bytes = checked_malloc( size );
        assert_status( p.h.world, wisp_world_snapshot( p.h.world, bytes, size ), WISP_OK );
        run_pile( &p, 20 );
        hashes[k] = wisp_world_hash( p.h.world );
        assert_status( p.h.world, wisp_world_restore( p.h.world, bytes, size ), WISP_OK );
        run_pile( &p, 20 );
        assert_true( wisp_world_hash( p.h.world ) == hashes[k] );
        free( bytes );
        close_world( &p.h );
    }
    assert_true( hashes[0] == hashes[1] && hashes[1] == hashes[2] );
}
