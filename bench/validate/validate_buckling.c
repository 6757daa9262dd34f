// Twist that turns into bending: rings leave their plane, and rods under tension their line.
#include "validate_buckling.h"

#include "oracle/rod_theory.h"
#include "validate_rods.h"

#include <math.h>

enum
{
    TENSIONS = 2,
};

static const double PI = 3.14159265358979323846;

// ---- a ring ----

static const double RING_RIPPLE = 1e-3; // m, how far it starts out of its plane
static const double RING_SECONDS = 1.0; // near its twist it leaves by a factor of e in 0.07 s

// How thick a loop is across the plane of its area vector, m.
static double thickness_of( const wisp_vec3* p, int cells )
{
    double area[3] = { 0.0, 0.0, 0.0 }, low = INFINITY, high = -INFINITY;
    for ( int i = 0; i < cells; ++i )
    {
        const double a[3] = { (double)p[i].x, (double)p[i].y, (double)p[i].z };
        const double b[3] = { (double)p[i + 1].x, (double)p[i + 1].y, (double)p[i + 1].z };
        for ( int d = 0; d < 3; ++d )
        {
            area[d] += a[( d + 1 ) % 3] * b[( d + 2 ) % 3] - a[( d + 2 ) % 3] * b[( d + 1 ) % 3];
        }
    }
    const double whole = sqrt( area[0] * area[0] + area[1] * area[1] + area[2] * area[2] );
    for ( int i = 0; i < cells; ++i )
    {
        const double height =
            ( (double)p[i].x * area[0] + (double)p[i].y * area[1] + (double)p[i].z * area[2] ) / whole;
        low = fmin( low, height );
        high = fmax( high, height );
    }
    return high - low;
}

static wisp_status add_rings( validate_bodies* b, wisp_error* error )
{
    const int cells = b->def.cells;
    const double turn = 2.0 * PI / cells, radius = 0.5 / ( cells * sin( 0.5 * turn ) );
    wisp_vec3 points[VALIDATE_MAX_CELLS + 1];
    for ( int i = 0; i <= cells; ++i )
    {
        const double a = turn * ( i % cells );
        points[i] = ( wisp_vec3 ){ (float)( radius * cos( a ) ), (float)( radius * sin( a ) ),
                                   (float)( RING_RIPPLE * cos( 2.0 * a ) ) };
    }
    wisp_strand_dynamics_def dynamics = validate_rod_dynamics( 0 );
    dynamics.closed = true;
    dynamics.damping = 1.0f;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < VALIDATE_LADDER && status == WISP_OK; ++i )
    {
        dynamics.closing_twist = (float)( validate_rung( i, VALIDATE_LADDER ) * rod_ring_twist( 1.0 ) );
        status = validate_add_strands( b, 1, points, &dynamics, error );
    }
    return status;
}

// A ring that is lost folds over to an eight and passes through itself, after which it may be flat again: what
// counts is whether it ever was three times as thick as at first.
static wisp_status watch_rings( validate_bodies* b, bool* has_lost, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < VALIDATE_LADDER && status == WISP_OK; ++i )
    {
        const wisp_vec3* points = NULL;
        status = validate_world_points( &b->world, i, &points, error );
        has_lost[i] =
            has_lost[i] || ( status == WISP_OK && !( thickness_of( points, b->def.cells ) < 6.0 * RING_RIPPLE ) );
    }
    return status;
}

static wisp_status run_ring( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const validate_def def = validate_rod_def( validate_setting_of( context, setting ), VALIDATE_LADDER, workers );
    bool has_lost[VALIDATE_LADDER] = { false };
    validate_bodies bodies;
    wisp_status status = validate_open( &def, &bodies, error );
    status = status == WISP_OK ? add_rings( &bodies, error ) : status;
    for ( int i = 0; i < validate_steps( RING_SECONDS ) && status == WISP_OK; ++i )
    {
        status = validate_step( &bodies, 1, out, error );
        status = status == WISP_OK && is_observed ? watch_rings( &bodies, has_lost, error ) : status;
    }
    if ( status == WISP_OK && is_observed )
    {
        out->error = validate_measure_ladder( has_lost, VALIDATE_LADDER, rod_ring_twist( 1.0 ), out->measures );
    }
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
}

// ---- under tension ----

static const double TENSION[TENSIONS] = { 0.0, 20.0 };         // F L^2 / EI
static const double TIP_MASS = 0.2, ROD_MASS = 0.0128;         // kg
static const double TWIST_SECONDS = 1.0, DECIDE_SECONDS = 4.0; // a tip sways once in a second
static const double SIDE_WEIGHT = 2e-4, SIDE_LIMIT = 0.002;    // N of the tip, while it is turned; m

static double own_weight( double tension )
{
    return ROD_MASS / TIP_MASS * tension;
}

static double critical_moment( double tension )
{
    return rod_straight_moment( tension, own_weight( tension ) );
}

static wisp_vec3 pull_of( double tension, double aside )
{
    return ( wisp_vec3 ){ (float)( tension / TIP_MASS ), (float)( aside / TIP_MASS ), 0.0f };
}

static wisp_status add_tensioned( validate_bodies* b, int method, int body, wisp_error* error )
{
    float masses[VALIDATE_LADDER * ( VALIDATE_MAX_CELLS + 1 )];
    const int vertices = b->def.cells + 1;
    for ( int i = 0; i < VALIDATE_LADDER * vertices; ++i )
    {
        masses[i] = (float)( i % vertices + 1 < vertices ? ROD_MASS / b->def.cells : TIP_MASS );
    }
    wisp_strand_dynamics_def dynamics = validate_rod_dynamics( method );
    dynamics.vertex_masses = masses;
    dynamics.damping = 0.5f;
    dynamics.gravity = pull_of( TENSION[body], SIDE_WEIGHT );
    const wisp_status status = validate_add_straight( b, VALIDATE_LADDER, &dynamics, error );
    return status == WISP_OK ? validate_hold_tips( b, body, VALIDATE_LADDER, WISP_STRAND_TIP_GUIDED, error ) : status;
}

// Turn the tips in equal parts, with a small weight aside, and then take that away.
static wisp_status twist( validate_bodies* b, accuracy_run* out, wisp_error* error )
{
    const int steps = validate_steps( TWIST_SECONDS );
    wisp_status status = WISP_OK;
    for ( int k = 1; k <= steps && status == WISP_OK; ++k )
    {
        for ( int i = 0; i < TENSIONS * VALIDATE_LADDER && status == WISP_OK; ++i )
        {
            const int body = i / VALIDATE_LADDER, strand = i % VALIDATE_LADDER;
            const double angle = validate_rung( strand, VALIDATE_LADDER ) * critical_moment( TENSION[body] );
            status = validate_turn_tip( b, body, strand, angle * k / steps, 0.0, error );
        }
        status = status == WISP_OK ? validate_step( b, 1, out, error ) : status;
    }
    for ( int i = 0; i < TENSIONS && status == WISP_OK; ++i )
    {
        status = wisp_set_strand_gravity( b->world.world, b->world.bodies[i].entity, pull_of( TENSION[i], 0.0 ) );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
    }
    return status;
}

// A rod that whips may lose its twist and be straight again: what counts is whether it ever was as far aside, which
// those that come back never are, even with the weight.
static wisp_status watch_tensioned( validate_bodies* b, bool has_lost[TENSIONS][VALIDATE_LADDER], wisp_error* error )
{
    const int vertices = b->def.cells + 1;
    wisp_status status = WISP_OK;
    for ( int body = 0; body < TENSIONS && status == WISP_OK; ++body )
    {
        const wisp_vec3* points = NULL;
        status = validate_world_points( &b->world, body, &points, error );
        for ( int i = 0; i < VALIDATE_LADDER * vertices && status == WISP_OK; ++i )
        {
            has_lost[body][i / vertices] |= !( hypot( (double)points[i].y, (double)points[i].z ) < SIDE_LIMIT );
        }
    }
    return status;
}

static void measure_tensioned( const bool has_lost[TENSIONS][VALIDATE_LADDER], accuracy_run* out )
{
    out->error = 0.0;
    for ( int i = 0; i < TENSIONS; ++i )
    {
        const double error = validate_measure_ladder( has_lost[i], VALIDATE_LADDER, critical_moment( TENSION[i] ),
                                                      out->measures + 2 * i );
        out->error = fmax( out->error, error );
    }
}

static wisp_status run_twisted( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                                wisp_error* error )
{
    const validate_setting* way = validate_setting_of( context, setting );
    const validate_def def = validate_rod_def( way, TENSIONS, workers );
    bool has_lost[TENSIONS][VALIDATE_LADDER] = { { false } };
    validate_bodies bodies;
    wisp_status status = validate_open( &def, &bodies, error );
    for ( int i = 0; i < TENSIONS && status == WISP_OK; ++i )
    {
        status = add_tensioned( &bodies, way->solver, i, error );
    }
    status = status == WISP_OK ? twist( &bodies, out, error ) : status;
    for ( int i = 0; i < validate_steps( DECIDE_SECONDS ) && status == WISP_OK; ++i )
    {
        status = validate_step( &bodies, 1, out, error );
        status = status == WISP_OK && is_observed ? watch_tensioned( &bodies, has_lost, error ) : status;
    }
    if ( status == WISP_OK && is_observed )
    {
        measure_tensioned( (const bool( * )[VALIDATE_LADDER])has_lost, out );
    }
    status = status == WISP_OK ? validate_finish( &bodies, out, error ) : status;
    validate_release( &bodies );
    return status;
}

// ---- cases ----

wisp_status validate_ring( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const int cells[] = { 12, 24, 48 };
    const accuracy_scene scene = {
        .reference = "10.88 = 2 pi sqrt(3) EI / GJ (Michell 1889), for GJ = EI",
        .error_name = "distance of the critical twist",
        .error_unit = "%",
        .measure_names = { "measured twist, rad", "theory, rad" },
        .measure_count = 2,
        .uncertainty = validate_ladder_doubt( VALIDATE_LADDER ),
        .run = run_ring,
    };
    return validate_make_rods( scene, cells, WISP_COUNT( cells ), 1, 32, out, error );
}

wisp_status validate_twisted( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    static const int cells[] = { 8, 16, 32 };
    const accuracy_scene scene = {
        .reference = "M^2 / 4 EI = F + pi^2 EI / L^2 (Greenhill 1883); the larger of two distances",
        .error_name = "distance of the critical moment",
        .error_unit = "%",
        .measure_names = { "F = 0: measured M L / EI", "F = 0: theory", "F L^2 / EI = 20: measured M L / EI",
                           "F L^2 / EI = 20: theory" },
        .measure_count = 4,
        .uncertainty = validate_ladder_doubt( VALIDATE_LADDER ),
        .run = run_twisted,
    };
    return validate_make_rods( scene, cells, WISP_COUNT( cells ), 2, 64, out, error );
}
