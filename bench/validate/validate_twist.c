// Rods that give way to twist.
#include "validate/validate.h"

#include "validate/validate_bodies.h"

#include "oracle/slender_theory.h"

#include <math.h>

// ---- rods in space ----

// Rods that are bent and twisted in space: set-ups of their cases. A length is 1 m, EI = GJ = 1 N m^2 if a case
// does not change it, and what is shown has no unit.

// Methods of rods.
enum
{
    VALIDATE_ROD_EULER,
    VALIDATE_ROD_BDF2,
    VALIDATE_ROD_METHODS,
};

// Straight without load, 1 kg/m, no gravity.
static wisp_strand_dynamics_def validate_rod_dynamics( int method )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.damping = 0.0f;
    def.rest = WISP_STRAND_REST_STRAIGHT;
    def.bend_rigidity = def.twist_rigidity = 1.0f;
    def.line_density = 1.0f; // kg/m
    def.integrator = method == VALIDATE_ROD_BDF2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    return def;
}

static const char* const rod_names[VALIDATE_ROD_METHODS] = { "rod", "rod bdf2" };

// Add a body of straight rods along x, all of them in one place. @param count at most VALIDATE_LADDER
static wisp_status validate_add_straight( validate_bodies* b, int count, const wisp_strand_dynamics_def* dynamics,
                                          wisp_error* error )
{
    wisp_vec3 points[VALIDATE_LADDER * ( VALIDATE_MAX_CELLS + 1 )];
    const int vertices = b->def.cells + 1;
    for ( int i = 0; i < count * vertices; ++i )
    {
        points[i] = ( wisp_vec3 ){ (float)( i % vertices ) / (float)b->def.cells, 0.0f, 0.0f };
    }
    return validate_add_strands( b, count, points, dynamics, error );
}

// Turn a tip about x, and bring it nearer, by the next step, from where it was at first. @param nearer m
static wisp_status validate_turn_tip( validate_bodies* b, int body, int strand, double angle, double nearer,
                                      wisp_error* error )
{
    const wisp_transform pose = { { (float)sin( 0.5 * angle ), 0.0f, 0.0f, (float)cos( 0.5 * angle ) },
                                  { (float)-nearer, 0.0f, 0.0f } };
    const wisp_status status = wisp_move_strand_tip( b->world.world, b->world.bodies[body].entity, strand, pose );
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

static wisp_status validate_hold_tips( validate_bodies* b, int body, int count, wisp_strand_tip hold,
                                       wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = wisp_hold_strand_tip( b->world.world, b->world.bodies[body].entity, i, hold );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

// ---- twist that turns into bending ----

// Twist that turns into bending: rings leave their plane, and rods under tension their line.

enum
{
    TENSIONS = 2,
};

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
    const double turn = 2.0 * VALIDATE_PI / cells, radius = 0.5 / ( cells * sin( 0.5 * turn ) );
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
    for ( int i = 0; i < VALIDATE_LADDER; ++i )
    {
        dynamics.closing_twist = (float)( validate_rung( i, VALIDATE_LADDER ) * rod_ring_twist( 1.0 ) );
        WISP_TRY( validate_add_strands( b, 1, points, &dynamics, error ) );
    }
    return WISP_OK;
}

// A ring that is lost folds over to an eight and passes through itself, after which it may be flat again: what
// counts is whether it ever was three times as thick as at first.
static wisp_status watch_rings( validate_bodies* b, bool* has_lost, wisp_error* error )
{
    for ( int i = 0; i < VALIDATE_LADDER && b->world.is_observed; ++i )
    {
        const wisp_vec3* points = NULL;
        WISP_TRY( validate_world_points( &b->world, i, &points, error ) );
        has_lost[i] = has_lost[i] || !( thickness_of( points, b->def.cells ) < 6.0 * RING_RIPPLE );
    }
    return WISP_OK;
}

static wisp_status play_ring( validate_bodies* b, wisp_error* error )
{
    bool has_lost[VALIDATE_LADDER] = { false };
    WISP_TRY( validate_open( b, error ) );
    WISP_TRY( add_rings( b, error ) );
    for ( int i = 0; i < validate_steps( RING_SECONDS ); ++i )
    {
        WISP_TRY( validate_step( b, 1, error ) );
        WISP_TRY( watch_rings( b, has_lost, error ) );
    }
    validate_judge_ladder( b, has_lost, VALIDATE_LADDER, rod_ring_twist( 1.0 ) );
    return WISP_OK;
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

static wisp_status add_tensioned( validate_bodies* b, int body, wisp_error* error )
{
    float masses[VALIDATE_LADDER * ( VALIDATE_MAX_CELLS + 1 )];
    const int vertices = b->def.cells + 1;
    for ( int i = 0; i < VALIDATE_LADDER * vertices; ++i )
    {
        masses[i] = (float)( i % vertices + 1 < vertices ? ROD_MASS / b->def.cells : TIP_MASS );
    }
    wisp_strand_dynamics_def dynamics = validate_rod_dynamics( b->method );
    dynamics.vertex_masses = masses;
    dynamics.damping = 0.5f;
    dynamics.gravity = pull_of( TENSION[body], SIDE_WEIGHT );
    const wisp_status status = validate_add_straight( b, VALIDATE_LADDER, &dynamics, error );
    return status == WISP_OK ? validate_hold_tips( b, body, VALIDATE_LADDER, WISP_STRAND_TIP_GUIDED, error ) : status;
}

// Turn the tips in equal parts, with a small weight aside, and then take that away.
static wisp_status twist( validate_bodies* b, wisp_error* error )
{
    const int steps = validate_steps( TWIST_SECONDS );
    for ( int k = 1; k <= steps; ++k )
    {
        for ( int i = 0; i < TENSIONS * VALIDATE_LADDER; ++i )
        {
            const int body = i / VALIDATE_LADDER, strand = i % VALIDATE_LADDER;
            const double angle = validate_rung( strand, VALIDATE_LADDER ) * critical_moment( TENSION[body] );
            WISP_TRY( validate_turn_tip( b, body, strand, angle * k / steps, 0.0, error ) );
        }
        WISP_TRY( validate_step( b, 1, error ) );
    }
    wisp_status status = WISP_OK;
    for ( int i = 0; i < TENSIONS && status == WISP_OK; ++i )
    {
        status = wisp_set_strand_gravity( b->world.world, b->world.bodies[i].entity, pull_of( TENSION[i], 0.0 ) );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

// A rod that whips may lose its twist and be straight again: what counts is whether it ever was as far aside, which
// those that come back never are, even with the weight.
static wisp_status watch_tensioned( validate_bodies* b, bool has_lost[TENSIONS][VALIDATE_LADDER], wisp_error* error )
{
    const int vertices = b->def.cells + 1;
    for ( int body = 0; body < TENSIONS && b->world.is_observed; ++body )
    {
        const wisp_vec3* points = NULL;
        WISP_TRY( validate_world_points( &b->world, body, &points, error ) );
        for ( int i = 0; i < VALIDATE_LADDER * vertices; ++i )
        {
            has_lost[body][i / vertices] |= !( hypot( (double)points[i].y, (double)points[i].z ) < SIDE_LIMIT );
        }
    }
    return WISP_OK;
}

static wisp_status play_twisted( validate_bodies* b, wisp_error* error )
{
    bool has_lost[TENSIONS][VALIDATE_LADDER] = { { false } };
    double errors[TENSIONS];
    WISP_TRY( validate_open( b, error ) );
    for ( int i = 0; i < TENSIONS; ++i )
    {
        WISP_TRY( add_tensioned( b, i, error ) );
    }
    WISP_TRY( twist( b, error ) );
    for ( int i = 0; i < validate_steps( DECIDE_SECONDS ); ++i )
    {
        WISP_TRY( validate_step( b, 1, error ) );
        WISP_TRY( watch_tensioned( b, has_lost, error ) );
    }
    for ( int i = 0; i < TENSIONS && b->world.is_observed; ++i )
    {
        errors[i] = validate_measure_ladder( has_lost[i], VALIDATE_LADDER, critical_moment( TENSION[i] ),
                                             b->world.run->measures + 2 * i );
        b->world.run->error = fmax( errors[0], errors[i] );
    }
    return WISP_OK;
}

// ---- cases ----

const validate_case validate_ring = {
    .name = "ring",
    .title = "twisted rings leave their plane",
    .scene = { .reference = "10.88 = 2 pi sqrt(3) EI / GJ (Michell 1889), for GJ = EI",
               .error_name = "distance of the critical twist",
               .error_unit = "%",
               .measure_names = { "measured twist, rad", "theory, rad" },
               .measure_count = 2 },
    .rungs = VALIDATE_LADDER,
    .grid = { rod_names, 1 << VALIDATE_ROD_EULER, .cells = { 12, 24, 48 }, .substeps = 32, .middle = 48,
              .fewer = { 16, 8, 4 } },
    .play = play_ring,
};

const validate_case validate_twisted = {
    .name = "twisted",
    .title = "rods under tension give way to twist",
    .scene = { .reference = "M^2 / 4 EI = F + pi^2 EI / L^2 (Greenhill 1883); the larger of two distances",
               .error_name = "distance of the critical moment",
               .error_unit = "%",
               .measure_names = { "F = 0: measured M L / EI", "F = 0: theory", "F L^2 / EI = 20: measured M L / EI",
                                  "F L^2 / EI = 20: theory" },
               .measure_count = 4 },
    .rungs = VALIDATE_LADDER,
    .grid = { rod_names, 1 << VALIDATE_ROD_EULER | 1 << VALIDATE_ROD_BDF2, .cells = { 8, 16, 32 }, .substeps = 64,
              .middle = 32, .fewer = { 32, 16, 8 } },
    .play = play_twisted,
};

// ---- writhe ----

// Rods whose ends are brought nearer and turned: they give way in one place, and form a loop at last.

enum
{
    WRITHES = 3,
};

static const double SHORTENING = 0.1;                      // of the length
static const double ANGLE[WRITHES] = { 60.0, 66.0, 72.0 }; // degrees, where it is largest
static const double LOOP = 95.0;                           // degrees, beyond those of the last balance: 92.9
// A rod so soft that steps of 1/60 s show how a loop forms. Its length is 1 m.
static const double RIGIDITY = 0.015625; // EI = GJ, N m^2
static const double BRING_SECONDS = 10.0, REST_SECONDS = 4.0;

static rod_writhe writhe_of( int i )
{
    return rod_writhe_of( ANGLE[i] * VALIDATE_PI / 180.0, SHORTENING, 1.0 );
}

// ---- both ----

static wisp_status add_writhing( validate_bodies* b, int count, wisp_error* error )
{
    wisp_strand_dynamics_def dynamics = validate_rod_dynamics( b->method );
    dynamics.bend_rigidity = dynamics.twist_rigidity = (float)RIGIDITY;
    dynamics.damping = 2.5f;
    dynamics.gravity = ( wisp_vec3 ){ 0.0f, 0.0015f, 0.0f }; // against tensions of 6 N and more: 3e-5 of the length
    const wisp_status status = validate_add_straight( b, count, &dynamics, error );
    return status == WISP_OK ? validate_hold_tips( b, 0, count, WISP_STRAND_TIP_CLAMPED, error ) : status;
}

// Bring the tips nearer and turn them at once, in the fraction of a whole.
static wisp_status bring( validate_bodies* b, const double* rotations, int count, double fraction, wisp_error* error )
{
    for ( int i = 0; i < count; ++i )
    {
        WISP_TRY( validate_turn_tip( b, 0, i, rotations[i] * fraction, SHORTENING * fraction, error ) );
    }
    return WISP_OK;
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
        has_looped[i] = has_looped[i] || !( angle < LOOP * VALIDATE_PI / 180.0 );
    }
    return status;
}

// Add rods, bring them to their rotations, and wait.
// @param has_looped [count] rods that ever did; null: not wanted
static wisp_status wind( validate_bodies* b, const double* rotations, int count, bool* has_looped, wisp_error* error )
{
    const int bring_steps = validate_steps( BRING_SECONDS ), steps = bring_steps + validate_steps( REST_SECONDS );
    WISP_TRY( validate_open( b, error ) );
    WISP_TRY( add_writhing( b, count, error ) );
    for ( int k = 1; k <= steps; ++k )
    {
        WISP_TRY( k <= bring_steps ? bring( b, rotations, count, (double)k / bring_steps, error ) : WISP_OK );
        WISP_TRY( validate_step( b, 1, error ) );
        WISP_TRY( has_looped != NULL ? watch( b, count, has_looped, error ) : WISP_OK );
    }
    return WISP_OK;
}

// ---- a shape ----

static wisp_status measure_writhes( validate_bodies* b, wisp_error* error )
{
    const int vertices = b->def.cells + 1;
    float tensions[WRITHES * ( VALIDATE_MAX_CELLS + 1 )];
    const wisp_vec3* points = NULL;
    accuracy_run* out = b->world.run;
    WISP_TRY( validate_world_points( &b->world, 0, &points, error ) );
    const wisp_status status = wisp_read_strand_tension( b->world.world, b->world.bodies[0].entity, tensions );
    double sum = 0.0;
    for ( int i = 0; i < WRITHES && status == WISP_OK; ++i )
    {
        const rod_writhe exact = writhe_of( i );
        const double angle =
            largest_angle( points + i * vertices, b->def.cells ) / ( ANGLE[i] * VALIDATE_PI / 180.0 ) - 1.0;
        const double tension =
            (double)tensions[i * vertices + b->def.cells / 16] / ( RIGIDITY * exact.tension ) - 1.0;
        out->measures[2 * i] = 100.0 * angle;
        out->measures[2 * i + 1] = 100.0 * tension;
        sum += angle * angle;
    }
    out->error = 100.0 * sqrt( sum / WRITHES );
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

static wisp_status play_writhe( validate_bodies* b, wisp_error* error )
{
    double rotations[WRITHES];
    for ( int i = 0; i < WRITHES; ++i )
    {
        rotations[i] = writhe_of( i ).rotation;
    }
    WISP_TRY( wind( b, rotations, WRITHES, NULL, error ) );
    return b->world.is_observed ? measure_writhes( b, error ) : WISP_OK;
}

// ---- a loop ----

static wisp_status play_loop( validate_bodies* b, wisp_error* error )
{
    const double limit = rod_writhe_limit( SHORTENING, 1.0 ).rotation;
    bool has_looped[VALIDATE_LADDER] = { false };
    double rotations[VALIDATE_LADDER];
    for ( int i = 0; i < VALIDATE_LADDER; ++i )
    {
        rotations[i] = validate_rung( i, VALIDATE_LADDER ) * limit;
    }
    WISP_TRY( wind( b, rotations, VALIDATE_LADDER, b->world.is_observed ? has_looped : NULL, error ) );
    validate_judge_ladder( b, has_looped, VALIDATE_LADDER, limit );
    return WISP_OK;
}

// ---- cases ----

const validate_case validate_writhe = {
    .name = "writhe",
    .title = "rods that gave way to twist, in one place",
    .scene = { .reference = "localised buckling of a long rod (Coyne 1990); root mean square over three twists",
               .error_name = "distance of the largest angle",
               .error_unit = "%",
               .measure_names = { "60 deg: angle, %", "60 deg: tension, %", "66 deg: angle, %", "66 deg: tension, %",
                                  "72 deg: angle, %", "72 deg: tension, %" },
               .measure_count = 2 * WRITHES },
    .grid = { rod_names, 1 << VALIDATE_ROD_EULER | 1 << VALIDATE_ROD_BDF2, .cells = { 32, 64, 96, 128 },
              .substeps = 16, .middle = 96, .fewer = { 8, 4, 2 } },
    .play = play_writhe,
};

const validate_case validate_loop = {
    .name = "loop",
    .title = "rods that are twisted on form a loop",
    .scene = { .reference = "largest rotation that has a balance without contact (van der Heijden and Thompson 2000)",
               .error_name = "distance of the critical rotation",
               .error_unit = "%",
               .measure_names = { "measured rotation, rad", "theory, rad" },
               .measure_count = 2 },
    .rungs = VALIDATE_LADDER,
    .grid = { rod_names, 1 << VALIDATE_ROD_EULER, .cells = { 48, 64, 96, 128 }, .substeps = 16, .middle = 96,
              .fewer = { 8, 4, 2 } },
    .play = play_loop,
};
