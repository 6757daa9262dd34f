// Cloth carried by coarse sheets: against the oracle in double precision, against converged motion and closed forms, at rest, and with
// everything else that acts on a cloth. Closed forms of cloth without sheets are in tests/claims.
#include "cloth_fixture.h"

#include "oracle/coarse_oracle.h"

// A level sheet of n x n vertices, its side a metre, held at two corners.
typedef struct sheet_setting
{
    int n, substeps, coarse_substeps;
    bool is_free;
    float compliance, damping;
    bool bends; // by links
} sheet_setting;

static wisp_entity add_sheet( hosted* h, const sheet_setting* s )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( s->n, 1.0f / (float)( s->n - 1 ) );
    const int32_t pins[2] = { 0, s->n - 1 };
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = s->bends;
    fabric.coarse_sheets = true;
    fabric.attachments = pins;
    fabric.attachment_count = s->is_free ? 0 : 2;
    wisp_surface_def surface = support_weightless_surface_def();
    surface.area_density = 0.2f;
    surface.pins = pins;
    surface.pin_count = s->is_free ? 0 : 2;
    wisp_cloth_def cloth = undamped_cloth();
    cloth.bending = s->bends ? WISP_CLOTH_BENDING_LINKS : WISP_CLOTH_BENDING_NONE;
    cloth.warp_compliance = cloth.weft_compliance = s->compliance;
    cloth.shear_compliance = 2.0f * s->compliance;
    cloth.coarse_substeps = s->coarse_substeps;
    wisp_entity e = add_cloth( h->world, &fabric, surface, &cloth, EARTH );
    assert_status( h->world, wisp_set_damping( h->world, e, s->damping ), WISP_OK );
    return e;
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
    const sheet_setting settings[] = { { 53, 2, 1, false, 1e-3f, 0.0f, false },
                                       { 53, 1, 2, false, 1e-3f, 0.0f, false },
                                       { 53, 1, 2, false, 1e-3f, 0.0f, false },
                                       { 53, 1, 2, true, 1e-3f, 0.0f, false },
                                       { 53, 5, 1, false, 1e-3f, 0.0f, false } };
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

// ---- accuracy ----

static wisp_vec3* run_for( const sheet_setting* s, int steps, int* count )
{
    SCOPED( close_world ) hosted h;
    open_world( &h, s->substeps, 1 );
    wisp_entity e = add_sheet( &h, s );
    run_steps( h.world, steps, 1.0f / 60.0f );
    const wisp_view view = view_of( h.world, e, WISP_SURFACE_POINTS );
    wisp_vec3* points = checked_calloc( (size_t)view.count, sizeof( wisp_vec3 ) );
    memcpy( points, view.data, (size_t)view.count * sizeof( wisp_vec3 ) );
    *count = (int)view.count;
    return points;
}

static double distance_of( const sheet_setting* s, const wisp_vec3* reference, int steps )
{
    int count;
    SCOPED( free_local ) wisp_vec3* points = run_for( s, steps, &count );
    double sum = 0.0;
    for ( int v = 0; v < count; ++v )
    {
        const double d = vec_distance( points[v], reference[v] );
        sum += d * d;
    }
    return sqrt( sum / count );
}

TEST( one_substep_is_nearer_to_the_converged_motion_than_forty )
{
    const sheet_setting converged = { 65, 320, 0, false, 1e-3f, 0.0f, false },
                        forty = { 65, 40, 0, false, 1e-3f, 0.0f, false };
    const sheet_setting carried = { 65, 1, 2, false, 1e-3f, 0.0f, false },
                        twice = { 65, 2, 1, false, 1e-3f, 0.0f, false };
    int count;
    SCOPED( free_local ) wisp_vec3* reference = run_for( &converged, 20, &count );
    const double plain = distance_of( &forty, reference, 20 ), one = distance_of( &carried, reference, 20 ),
                 two = distance_of( &twice, reference, 20 );
    print_message( "           40 plain substeps %.1f mm, 1 x 2 %.1f mm, 2 x 1 %.1f mm\n", 1e3 * plain, 1e3 * one,
                   1e3 * two );
    assert_true( one < 0.5 * plain && two < 0.5 * plain );
}

// Without links that act, second order is exact for a constant acceleration.
TEST( a_sheet_that_falls_freely_follows_the_parabola )
{
    for ( int coarse = 1; coarse <= 4; coarse *= 2 )
    {
        const sheet_setting falling = { 33, 1, coarse, true, 1e-3f, 0.0f, false };
        SCOPED( close_world ) hosted h;
        open_world( &h, 1, 1 );
        wisp_entity e = add_sheet( &h, &falling );
        run_steps( h.world, 60, 1.0f / 60.0f );
        const double fallen = -(double)point_of( h.world, e, 33 * 16 + 16 ).y;
        print_message( "           %d: fallen by %.4f m after 1 s, and 4.905 expected\n", coarse, fallen );
        assert_true( fabs( fallen - 4.905 ) < 1e-3 );
        assert_true( fabs( (double)velocity_of( h.world, e, 5 )[1] + 9.81 ) < 0.01 );
    }
}

// Sheets let it drift with 0.1 m/s, and took 5 % of what gravity gave it.
TEST( a_free_sheet_that_shakes_keeps_its_momentum )
{
    for ( int substeps = 1; substeps <= 10; substeps += 9 )
    {
        const sheet_setting flying = { 33, substeps, 1, true, 0.0f, 0.0f, true };
        hosted h;
        open_world( &h, substeps, 1 );
        wisp_entity e = add_sheet( &h, &flying );
        for ( int32_t v = 0; v < 33 * 33; ++v )
        {
            const wisp_vec3 u = { 0.5f * sinf( 5.0f * (float)v ), sinf( 0.3f * (float)v ),
                                  0.5f * cosf( 7.0f * (float)v ) };
            assert_status( h.world, wisp_set_vertex_velocities( h.world, e, &v, &u, 1 ), WISP_OK );
        }
        run_steps( h.world, 1, 1.0f / 60.0f );
        const wisp_motion_stats before = motion_stats_of( h.world, e );
        run_steps( h.world, 60, 1.0f / 60.0f );
        const wisp_motion_stats after = motion_stats_of( h.world, e );
        for ( int k = 0; k < 3; ++k )
        {
            const double change = ( after.momentum[k] - before.momentum[k] ) / after.mass;
            const double way = after.centre[k] - before.centre[k] - before.momentum[k] / before.mass;
            print_message( "           %d: %.2g m/s, %.2g m\n", substeps, change, way );
            assert_near( change, k == 1 ? -9.81 : 0.0, 3e-3 ); // rounding of floats at 10 m/s
            assert_near( way, k == 1 ? -4.905 : 0.0, 3e-3 );
        }
        close_world( &h );
    }
}

// ---- energy ----

static double energy_of( wisp_world* world, wisp_entity e )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    const float *p = positions_of( world, e ), *v = wisp_world_column( world, e, WISP_PARTICLE_VELOCITY, 0 );
    double sum = 0.0;
    for ( int i = 0; i < 4 * f->vertex_count; i += 4 )
    {
        const double mass = p[i + 3] > 0.0f ? 1.0 / (double)p[i + 3] : 0.0;
        const double squared =
            (double)( v[i] * v[i] ) + (double)( v[i + 1] * v[i + 1] ) + (double)( v[i + 2] * v[i + 2] );
        sum += mass * ( 0.5 * squared + 9.81 * (double)p[i + 1] );
    }
    return sum;
}

TEST( a_swing_of_fifteen_seconds_gains_no_energy )
{
    const sheet_setting settings[] = { { 33, 1, 2, false, 1e-3f, 0.0f, false },
                                       { 33, 2, 1, false, 0.0f, 0.0f, false } };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        SCOPED( close_world ) hosted h;
        open_world( &h, settings[i].substeps, 1 );
        wisp_entity e = add_sheet( &h, &settings[i] );
        const double start = energy_of( h.world, e );
        double most = start;
        for ( int step = 0; step < 900; ++step )
        {
            run_steps( h.world, 1, 1.0f / 60.0f );
            most = fmax( most, energy_of( h.world, e ) );
        }
        assert_true( most <= start + 0.002 ); // 0.2 kg fall by 0.5 m: 1 J
        assert_false( wisp_is_halted( h.world, e ) );
    }
}

// What second order adds to free corners alone made them flutter with 1 m/s in short substeps, and whole corrections inextensible
// ones with several.
TEST( corners_do_not_flutter_in_short_substeps )
{
    const int substeps[] = { 2, 5 };
    const float compliance[] = { 1e-5f, 0.0f };
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        const sheet_setting carried = { .n = 33,
                                        .substeps = substeps[i],
                                        .coarse_substeps = 1,
                                        .compliance = compliance[i],
                                        .damping = 4.0f,
                                        .bends = true };
        hosted h;
        open_world( &h, carried.substeps, 1 );
        wisp_entity e = add_sheet( &h, &carried );
        run_steps( h.world, 1600, 1.0f / 240.0f );
        double fastest = 0.0;
        for ( int step = 0; step < 200; ++step )
        {
            run_steps( h.world, 1, 1.0f / 240.0f );
            fastest = fmax( fastest, (double)motion_stats_of( h.world, e ).speed_max );
        }
        print_message( "           %.2g m/s\n", fastest );
        assert_true( fastest < 0.3 );
        close_world( &h );
    }
}

// ---- what acts on a cloth ----

TEST( pins_that_move_take_the_sheet_along )
{
    const sheet_setting carried = { 33, 1, 2, false, 1e-4f, 2.0f, false };
    SCOPED( close_world ) hosted h;
    open_world( &h, 1, 1 );
    wisp_entity e = add_sheet( &h, &carried );
    const int32_t pins[2] = { 0, 32 };
    run_steps( h.world, 120, 1.0f / 60.0f );
    for ( int step = 0; step < 120; ++step )
    {
        const float x = 0.02f * (float)( step + 1 );
        const wisp_vec3 targets[2] = { { x, 0.0f, 0.0f }, { x + 1.0f, 0.0f, 0.0f } };
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        run_steps( h.world, 1, 1.0f / 60.0f );
        assert_true( fabsf( point_of( h.world, e, 0 ).x - x ) < 1e-5f );
    }
    const wisp_vec3 tip = point_of( h.world, e, 32 * 33 + 16 );
    assert_true( tip.x > 1.2f && tip.y < -0.5f );
    assert_true( (double)motion_stats_of( h.world, e ).strain_mean < 0.02 );
}

// Pins that no row of a coarse sheet stands on, as copies of a fabric have: the sheet is held by them, and moves with them.
TEST( pins_between_rows_hold_the_sheet )
{
    const sheet_setting carried = { 49, 1, 2, true, 1e-4f, 2.0f, false };
    const int32_t pins[2] = { 12 * 49 + 13, 12 * 49 + 35 };
    SCOPED( close_world ) hosted h;
    open_world( &h, 1, 1 );
    wisp_entity e = add_sheet( &h, &carried );
    assert_status( h.world, wisp_pin( h.world, e, pins, 2 ), WISP_OK );
    wisp_vec3 targets[2] = { point_of( h.world, e, pins[0] ), point_of( h.world, e, pins[1] ) };
    for ( int step = 0; step < 240; ++step )
    {
        targets[0].x += step < 60 ? 0.02f : 0.0f;
        targets[1].x += step < 60 ? 0.02f : 0.0f;
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        run_steps( h.world, 1, 1.0f / 60.0f );
        // the pins start with a jerk
        assert_true( step < 20 || (double)motion_stats_of( h.world, e ).strain_mean < 0.03 );
    }
    const wisp_motion_stats rest = motion_stats_of( h.world, e );
    print_message( "           at rest: %.2g m/s, strain %.3f %%\n", (double)rest.speed_max,
                   100.0 * (double)rest.strain_mean );
    assert_true( (double)rest.speed_max < 0.4 && (double)rest.strain_mean < 0.02 );
}

// What changes a sheet from outside: it goes on from there, without a jump of its own.
TEST( teleports_velocities_pins_and_other_steps_leave_no_kick )
{
    const sheet_setting carried = { 33, 1, 2, true, 1e-4f, 0.0f, false };
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
