// The displacement limit: what is hurled does not pass, and nothing but the limit prevents it.
#include "contact_fixture.h"

typedef struct hurled
{
    int intersections; // edges through triangles, largest of all steps
    float min_gap;     // thicknesses, smallest of all steps
} hurled;

// Hurl three tilted sheets onto a plate that is pinned, by a few thicknesses per substep.
static hurled hurl( float speed, bool displacement_limit )
{
    hosted h;
    open_contact( &h, 10, 1, 1 );
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.displacement_limit = displacement_limit;
    assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
    const wisp_contact_def def = contact_of( 0.01f );
    wisp_entity all[4];
    for ( int i = 0; i < 4; ++i )
    {
        test_mesh mesh = level_sheet( i == 0 ? 15 : 11, i == 0 ? 0.7f : 0.5f, ( wisp_vec3 ){ 0, 0, 0 } );
        for ( int v = 0; v < mesh.vertex_count && i > 0; ++v )
        {
            const wisp_vec3 p = mesh.points[v];
            const float angle = 0.5f * (float)i;
            mesh.points[v] = ( wisp_vec3 ){ p.x * cosf( angle ), 0.4f * (float)i + p.x * sinf( angle ), p.z };
        }
        all[i] =
            i == 0 ? add_pinned( h.world, &mesh ) : add_draping( h.world, &mesh, NULL, 0, ( wisp_vec3 ){ 0, 0, 0 } );
        set_contact( h.world, all[i], &def );
        if ( i > 0 )
        {
            assert_status( h.world,
                           wisp_set_velocity( h.world, all[i], ( wisp_vec3 ){ 0, -speed, 0 }, ( wisp_vec3 ){ 0 } ),
                           WISP_OK );
        }
    }
    request_stats( h.world );
    hurled out = { 0, INFINITY };
    for ( int i = 0; i < 20; ++i )
    {
        assert_status( h.world, wisp_world_step( h.world, FRAME ), WISP_OK );
        const wisp_contact_stats stats = contact_stats( h.world );
        out.intersections = stats.intersections > out.intersections ? stats.intersections : out.intersections;
        out.min_gap = fminf( out.min_gap, stats.min_gap );
    }
    assert_int_equal( count_all_passing( h.world, all, 4 ), contact_stats( h.world ).intersections );
    close_world( &h );
    return out;
}

// The limit keeps a tenth of the thickness, and there is nothing else that would: without it the sheets pass.
static void sheets_hurled_onto_a_plate_need_the_displacement_limit( void** state )
{
    (void)state;
    const float speeds[] = { 20.0f, 60.0f }; // m/s: 3 and 10 thicknesses per substep
    for ( int k = 0; k < WISP_COUNT( speeds ); ++k )
    {
        const hurled limited = hurl( speeds[k], true ), unlimited = hurl( speeds[k], false );
        assert_int_equal( limited.intersections, 0 );
        if ( !( limited.min_gap >= 0.09f ) || !( unlimited.intersections > 20 ) )
        {
            fail_msg( "%g m/s: with the limit a gap of %.3g thicknesses, without it %d intersections",
                      (double)speeds[k], (double)limited.min_gap, unlimited.intersections );
        }
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( sheets_hurled_onto_a_plate_need_the_displacement_limit ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
