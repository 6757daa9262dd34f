// Rods whose ends are brought nearer and turned: they give way in one place, and form a loop at last.
#include "validate_writhe.h"

#include "oracle/rod_theory.h"
#include "validate_rods.h"

#include <math.h>

enum
{
    WRITHES = 3,
};

static const double PI = 3.14159265358979323846;
static const double SHORTENING = 0.1;                      // of the length
static const double ANGLE[WRITHES] = { 60.0, 66.0, 72.0 }; // degrees, where it is largest
static const double LOOP = 95.0;                           // degrees, beyond those of the last balance: 92.9
// A rod so soft that steps of 1/60 s show how a loop forms. Its length is 1 m.
static const double RIGIDITY = 0.015625; // EI = GJ, N m^2
static const double BRING_SECONDS = 10.0, REST_SECONDS = 4.0;

static rod_writhe writhe_of( int i )
{
    return rod_writhe_of( ANGLE[i] * PI / 180.0, SHORTENING, 1.0 );
}

// ---- both ----

static wisp_status add_rods( validate_bodies* b, int method, int count, wisp_error* error )
{
    wisp_strand_dynamics_def dynamics = validate_rod_dynamics( method );
    dynamics.bend_rigidity = dynamics.twist_rigidity = (float)RIGIDITY;
    dynamics.damping = 2.5f;
    dynamics.gravity = ( wisp_vec3 ){ 0.0f, 0.0015f, 0.0f }; // against tensions of 6 N and more: 3e-5 of the length
    const wisp_status status = validate_add_straight( b, count, &dynamics, error );
    return status == WISP_OK ? validate_hold_tips( b, 0, count, WISP_STRAND_TIP_CLAMPED, error ) : status;
}

// Bring the tips nearer and turn them at once, in the fraction of a whole.
static wisp_status bring( validate_bodies* b, const double* rotations, int count, double fraction, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = validate_turn_tip( b, 0, i, rotations[i] * fraction, SHORTENING * fraction, error );
    }
    return status;
}

// The largest angle between a segment and the line of the ends.
static double largest_angle( const wisp_vec3* points, int cells )
{
    double most = 0.0;
    for ( int i = 0; i < cells; ++i )
    {
        const wisp_vec3 p = points[i], q = points[i + 1];
        const double x = (double)q.x - (double)p.x, y = (double)q.y - (double)p.y, z = (double)q.z - (double)p.z;
        most = fmax( most, atan2( hypot( y, z ), x ) );
    }
    return most;
}

// Rods with an angle that no balance has.
static wisp_status watch( validate_bodies* b, int count, bool* has_looped, wisp_error* error )
{
    const wisp_vec3* points = NULL;
    const wisp_status status = validate_world_points( &b->world, 0, &points, error );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const double angle = largest_angle( points + i * ( b->def.cells + 1 ), b->def.cells );
        has_looped[i] = has_looped[i] || !( angle < LOOP * PI / 180.0 );
    }
    return status;
}

// Bring the rods of a case to their rotations, and wait.
// @param has_looped [count] rods that ever did; null: not wanted
static wisp_status wind( validate_bodies* b, const double* rotations, int count, bool* has_looped, accuracy_run* out,
                         wisp_error* error )
{
    const int bring_steps = validate_steps( BRING_SECONDS ), steps = bring_steps + validate_steps( REST_SECONDS );
    wisp_status status = WISP_OK;
    for ( int k = 1; k <= steps && status == WISP_OK; ++k )
    {
        status = k <= bring_steps ? bring( b, rotations, count, (double)k / bring_steps, error ) : WISP_OK;
        status = status == WISP_OK ? validate_step( b, 1, out, error ) : status;
        status = status == WISP_OK && has_looped != NULL ? watch( b, count, has_looped, error ) : status;
    }
    return status;
}

// ---- a shape ----

static wisp_status measure_writhes( validate_bodies* b, accuracy_run* out, wisp_error* error )
{
    const int vertices = b->def.cells + 1;
    float tensions[WRITHES * ( VALIDATE_MAX_CELLS + 1 )];
    const wisp_vec3* points = NULL;
    wisp_status status = validate_world_points( &b->world, 0, &points, error );
    if ( status == WISP_OK )
    {
        status = wisp_read_strand_tension( b->world.world, b->world.bodies[0].entity, tensions );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
    }
    double sum = 0.0;
    for ( int i = 0; i < WRITHES && status == WISP_OK; ++i )
    {
        const rod_writhe exact = writhe_of( i );
        const double angle = largest_angle( points + i * vertices, b->def.cells ) / ( ANGLE[i] * PI / 180.0 ) - 1.0;
        const double tension =
            (double)tensions[i * vertices + b->def.cells / 16] / ( RIGIDITY * exact.tension ) - 1.0;
        out->measures[2 * i] = 100.0 * angle;
        out->measures[2 * i + 1] = 100.0 * tension;
        sum += angle * angle;
    }
    out->error = 100.0 * sqrt( sum / WRITHES );
    return status;
}

static wisp_status run_writhe( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                               wisp_error* error )
{
    const validate_setting* way = validate_setting_of( context, setting );
    const validate_def def = validate_rod_def( way, 1, workers );
    double rotations[WRITHES];
    for ( int i = 0; i < WRITHES; ++i )
    {
        rotations[i] = writhe_of( i ).rotation;
    }
    validate_bodies bodies;
    wisp_status status = validate_open( &def, &bodies, error );
    status = status == WISP_OK ? add_rods( &bodies, way->solver, WRITHES, error ) : status;
    status = status == WISP_OK ? wind( &bodies, rotations, WRITHES, NULL, out, error ) : status;
    status = status == WISP_OK && is_observed ? measure_writhes( &bodies, out, error ) : status;
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
}

// ---- a loop ----

static wisp_status run_loop( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const validate_setting* way = validate_setting_of( context, setting );
    const validate_def def = validate_rod_def( way, 1, workers );
    const double limit = rod_writhe_limit( SHORTENING, 1.0 ).rotation;
    bool has_looped[VALIDATE_LADDER] = { false };
    double rotations[VALIDATE_LADDER];
    for ( int i = 0; i < VALIDATE_LADDER; ++i )
    {
        rotations[i] = validate_rung( i, VALIDATE_LADDER ) * limit;
    }
    validate_bodies bodies;
    wisp_status status = validate_open( &def, &bodies, error );
    status = status == WISP_OK ? add_rods( &bodies, way->solver, VALIDATE_LADDER, error ) : status;
    status = status == WISP_OK
                 ? wind( &bodies, rotations, VALIDATE_LADDER, is_observed ? has_looped : NULL, out, error )
                 : status;
    if ( status == WISP_OK && is_observed )
    {
        out->error = validate_measure_ladder( has_looped, VALIDATE_LADDER, limit, out->measures );
    }
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
}

// ---- cases ----

wisp_status validate_writhe( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const int cells[] = { 32, 64, 96, 128 };
    const accuracy_scene scene = {
        .reference = "localised buckling of a long rod (Coyne 1990); root mean square over three twists",
        .error_name = "distance of the largest angle",
        .error_unit = "%",
        .measure_names = { "60 deg: angle, %", "60 deg: tension, %", "66 deg: angle, %", "66 deg: tension, %",
                           "72 deg: angle, %", "72 deg: tension, %" },
        .measure_count = 2 * WRITHES,
        .run = run_writhe,
    };
    return validate_make_rods( scene, cells, WISP_COUNT( cells ), 2, 16, out, error );
}

wisp_status validate_loop( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const int cells[] = { 48, 64, 96, 128 };
    const accuracy_scene scene = {
        .reference = "largest rotation that has a balance without contact (van der Heijden and Thompson 2000)",
        .error_name = "distance of the critical rotation",
        .error_unit = "%",
        .measure_names = { "measured rotation, rad", "theory, rad" },
        .measure_count = 2,
        .uncertainty = validate_ladder_doubt( VALIDATE_LADDER ),
        .run = run_loop,
    };
    return validate_make_rods( scene, cells, WISP_COUNT( cells ), 1, 16, out, error );
}
