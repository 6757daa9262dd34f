// Cloth carried by coarse sheets, against the oracle in double precision, and what changes it from outside. Closed forms are in
// tests/claims.
#include "cloth_fixture.h"

#include "oracle/coarse_oracle.h"

// A level sheet of n x n vertices, its side a metre, held at two corners.
typedef struct sheet_setting
{
    int n, substeps, coarse_substeps;
    bool is_free;
    float compliance;
} sheet_setting;

static wisp_entity add_sheet( hosted* h, const sheet_setting* s )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( s->n, 1.0f / (float)( s->n - 1 ) );
    const int32_t pins[2] = { 0, s->n - 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = false;
    fabric.coarse_sheets = true;
    fabric.attachments = pins;
    fabric.attachment_count = s->is_free ? 0 : 2;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = 0.2f;
    surface.pins = pins;
    surface.pin_count = s->is_free ? 0 : 2;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    cloth.warp_compliance = cloth.weft_compliance = s->compliance;
    cloth.shear_compliance = 2.0f * s->compliance;
    cloth.coarse_substeps = s->coarse_substeps;
    return add_cloth( h->world, &fabric, surface, &cloth, EARTH );
}

static const float* positions_of( wisp_world* world, wisp_entity e )
{
    return wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
}

// ---- the oracle ----

// Two levels with one substep of the sheet in each of two, and with two in one; a step so long that it limits the history; pins that
// are no attachments of the fabric, so they are between the rows of the sheets; and substeps so short that sheets relax less.
TEST( a_step_is_that_of_the_oracle )
{
    const sheet_setting settings[] = { { 53, 2, 1, false, 1e-3f },
                                       { 53, 1, 2, false, 1e-3f },
                                       { 53, 1, 2, false, 1e-3f },
                                       { 53, 1, 2, true, 1e-3f },
                                       { 53, 5, 1, false, 1e-3f } };
    const double dts[] = { 1.0 / 60.0, 1.0 / 60.0, 1.0 / 20.0, 1.0 / 60.0, 1.0 / 60.0 };
    const int steps[] = { 12, 12, 4, 6, 6 };
    const int32_t between[] = { 1, 5 * 53 + 18, 5 * 53 + 19, 27 * 53 + 40 };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        SCOPED( close_world ) hosted h;
        open_world( &h, settings[i].substeps, 1 );
        wisp_entity e = add_sheet( &h, &settings[i] );
        const wisp_fabric* f = wisp_world_fabric( h.world, e );
        assert_int_equal( f->level_count, 2 );
        if ( settings[i].is_free )
        {
            assert_status( h.world, wisp_pin( h.world, e, between, WISP_COUNT( between ) ), WISP_OK );
        }
        SCOPED( coarse_oracle_free ) coarse_oracle oracle;
        coarse_oracle_make( f, positions_of( h.world, e ), &oracle );
        oracle.gravity = double3_widen( EARTH );
        oracle.compliance = (double)settings[i].compliance;
        oracle.substeps = settings[i].coarse_substeps;
        double worst = 0.0;
        for ( int step = 0; step < steps[i]; ++step )
        {
            run_steps( h.world, 1, (float)dts[i] );
            for ( int k = 0; k < settings[i].substeps; ++k )
            {
                coarse_oracle_step( &oracle, dts[i] / settings[i].substeps );
            }
            const float* position = positions_of( h.world, e );
            for ( int slot = 0; slot < f->vertex_count; ++slot )
            {
                const double3 d = double3_sub( double3_from( position + 4 * slot ), oracle.x[slot] );
                worst = fmax( worst, double3_length( d ) );
            }
        }
        print_message( "           %d x %d: %.2g m from the oracle after %d steps\n", settings[i].substeps,
                       settings[i].coarse_substeps, worst, steps[i] );

        // it has fallen by 0.2 m; without the limit, the last one would be millimetres off
        assert_true( worst < 1e-5 );
    }
}

// ---- what acts on a cloth ----

// What changes a sheet from outside: it goes on from there, without a jump of its own.
TEST( teleports_velocities_pins_and_other_steps_leave_no_kick )
{
    const sheet_setting carried = { 33, 1, 2, true, 1e-4f };
    SCOPED( close_world ) hosted h;
    open_world( &h, 1, 1 );
    wisp_entity e = add_sheet( &h, &carried );
    assert_status( h.world, wisp_set_gravity( h.world, e, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), WISP_OK );
    run_steps( h.world, 10, 1.0f / 60.0f );
    assert_status( h.world, wisp_set_velocity( h.world, e, ( wisp_vec3 ){ 1.0f, 2.0f, 0.0f }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    run_steps( h.world, 30, 1.0f / 60.0f );
    run_steps( h.world, 30, 1.0f / 120.0f );
    const wisp_vec3 p = point_of( h.world, e, 7 );
    assert_true( fabs( (double)p.x - 7.0 / 32.0 - 0.75 ) < 1e-4 && fabs( (double)p.y - 1.5 ) < 1e-4 );
    wisp_transform motion = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 100.0f, 0.0f, 0.0f } };
    assert_status( h.world, wisp_teleport( h.world, e, motion, true ), WISP_OK );
    run_steps( h.world, 60, 1.0f / 60.0f );
    assert_true( fabs( (double)point_of( h.world, e, 7 ).x - 7.0 / 32.0 - 101.75 ) < 1e-3 );
    const int32_t pin = 0;
    assert_status( h.world, wisp_pin( h.world, e, &pin, 1 ), WISP_OK );
    run_steps( h.world, 60, 1.0f / 60.0f );
    assert_status( h.world, wisp_unpin( h.world, e, &pin, 1 ), WISP_OK );
    run_steps( h.world, 60, 1.0f / 60.0f );
    assert_true( is_finite( h.world, e ) );
    assert_true( (double)motion_stats_of( h.world, e ).speed_max < 10.0 );
}
