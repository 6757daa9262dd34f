// Strands against closed forms: the error of each setting beside its time.
#include "strands_bench.h"

#include <math.h>
#include <stdlib.h>

/// A way to solve, and whether its error is held to what is promised.
typedef struct closed_setting
{
    const char* name;
    wisp_strand_stretch stretch;
    int substeps;
    bool is_held;
} closed_setting;

// The promise holds for the direct solve at ten substeps and more; below that the table shows the price.
static const closed_setting closed_settings[] = {
    { "direct", WISP_STRAND_STRETCH_DIRECT, 1, false }, { "direct", WISP_STRAND_STRETCH_DIRECT, 4, false },
    { "direct", WISP_STRAND_STRETCH_DIRECT, 10, true }, { "direct", WISP_STRAND_STRETCH_DIRECT, 40, true },
    { "links", WISP_STRAND_STRETCH_LINKS, 10, false },  { "links", WISP_STRAND_STRETCH_LINKS, 40, false },
};

typedef struct measurement
{
    double value, reference; // of one figure, or of the worse of several
    double us;               // a step, median
    uint64_t laid;           // strands laid out from the root, over all steps
} measurement;

typedef struct closed_form
{
    const char* name;
    double parameter;
    double reference;
    double tolerance;
    bool direct_only; // links have no such figure
    wisp_status ( *run )( const strands_plan* plan, const struct closed_form* form, const closed_setting* setting,
                          measurement* out, wisp_error* error );
} closed_form;

// ---- running ----

#define STEPS_MAX 2000

/// One strand, its steps timed.
typedef struct closed_run
{
    strands_shape shape;
    strands_implementation implementation;
    double us[STEPS_MAX];
    int steps;
} closed_run;

static strands_generator default_generator( const closed_run* run, const closed_setting* setting )
{
    strands_generator generator = strands_default_generator( &run->shape );
    generator.dynamics.stretch = setting->stretch;
    generator.dynamics.bending = WISP_STRAND_BEND_NONE;
    generator.dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    generator.dynamics.clamped = false;
    generator.substeps = setting->substeps;
    return generator;
}

static wisp_status step( closed_run* run, const wisp_vec3** points, wisp_error* error )
{
    double start = wisp_clock_seconds();
    wisp_status status = strands_implementation_step( &run->implementation, error );
    if ( run->steps < STEPS_MAX )
    {
        run->us[run->steps++] = 1e6 * ( wisp_clock_seconds() - start );
    }
    return status == WISP_OK ? strands_implementation_points( &run->implementation, points, error ) : status;
}

static wisp_status settle( const strands_plan* plan, closed_run* run, const wisp_vec3** points, wisp_error* error )
{
    int steps = (int)( plan->settle_seconds / (double)STRANDS_STEP );
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && status == WISP_OK; ++s )
    {
        status = step( run, points, error );
    }
    return status;
}

static void finish( closed_run* run, measurement* out )
{
    out->us = stats_summarise( run->us, run->steps ).median;
    out->laid =
        run->implementation.world ? wisp_world_counter( run->implementation.world, WISP_COUNT_STRAND_RESET ) : 0;
    strands_implementation_destroy( &run->implementation );
    strands_shape_free( &run->shape );
}

static double radians( double degrees )
{
    return degrees * 3.14159265358979323846 / 180.0;
}

/// Times at which a value passes through 0, by straight lines between steps.
typedef struct intersections
{
    double last, time[3];
    double peak[2]; // the largest values between them
    int count;
} intersections;

static void feed( intersections* c, int step, double value )
{
    if ( c->count < 3 && step > 0 && ( c->last < 0.0 ) != ( value < 0.0 ) )
    {
        c->time[c->count++] = (double)STRANDS_STEP * ( step - 1 + c->last / ( c->last - value ) );
    }
    if ( c->count == 1 || c->count == 2 )
    {
        c->peak[c->count - 1] = fmax( c->peak[c->count - 1], fabs( value ) );
    }
    c->last = value;
}

#define SWING_STEPS_MAX 900

// Step until the value has come back to 0 from the same side: that is one period.
static wisp_status swing( closed_run* run, double ( *read )( const closed_run* run, const wisp_vec3* points ),
                          intersections* out, wisp_error* error )
{
    intersections c = { 0 };
    feed( &c, 0, read( run, run->shape.points ) );
    wisp_status status = WISP_OK;
    for ( int s = 1; s <= SWING_STEPS_MAX && c.count < 3 && status == WISP_OK; ++s )
    {
        const wisp_vec3* points = NULL;
        status = step( run, &points, error );
        if ( status == WISP_OK )
        {
            feed( &c, s, read( run, points ) );
        }
    }
    *out = c;
    return status;
}

static double period_of( const intersections* c )
{
    return c->count == 3 ? c->time[2] - c->time[0] : NAN;
}

// ---- pendulum ----

#define SWING_LENGTH 0.2 // m, as long as a hair

static double read_angle( const closed_run* run, const wisp_vec3* points )
{
    (void)run;
    return atan2( (double)points[1].x, -(double)points[1].y );
}

// T = 4 sqrt(L/g) K(sin(a/2)), the complete elliptic integral by the mean of arithmetic and geometric means.
static double pendulum_period( double amplitude )
{
    double a = 1.0, b = cos( 0.5 * amplitude );
    for ( int i = 0; i < 8; ++i )
    {
        double mean = 0.5 * ( a + b );
        b = sqrt( a * b );
        a = mean;
    }
    return 6.283185307179586 * sqrt( SWING_LENGTH / STRANDS_GRAVITY ) / a;
}

static wisp_status swing_pendulum( const closed_form* form, const closed_setting* setting, intersections* c,
                                   measurement* out, wisp_error* error )
{
    closed_run run = { .steps = 0 };
    double angle = radians( form->parameter );
    const wisp_vec3 direction = { (float)sin( angle ), (float)-cos( angle ), 0.0f };
    wisp_status status = strands_shape_make_straight( 2, direction, SWING_LENGTH, &run.shape, error );
    strands_generator generator = default_generator( &run, setting );
    generator.dynamics.vertex_mass = 1.0f;
    status = status == WISP_OK ? strands_implementation_create( &generator, &run.implementation, error ) : status;
    status = status == WISP_OK ? swing( &run, read_angle, c, error ) : status;
    finish( &run, out );
    return status;
}

// The period of the amplitude that it has, not of the one that it was let go from: what the solver takes away is the
// next figure.
static wisp_status run_pendulum( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                                 measurement* out, wisp_error* error )
{
    (void)plan;
    intersections c = { 0 };
    wisp_status status = swing_pendulum( form, setting, &c, out, error );
    out->value = period_of( &c );
    out->reference = pendulum_period( 0.5 * ( c.peak[0] + c.peak[1] ) );
    return status;
}

static wisp_status run_amplitude( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                                  measurement* out, wisp_error* error )
{
    (void)plan;
    intersections c = { 0 };
    wisp_status status = swing_pendulum( form, setting, &c, out, error );
    out->value = c.peak[1] / radians( 1.0 );
    out->reference = form->parameter;
    return status;
}

// ---- hanging chain ----

#define CHAIN_MASSES_MAX 32

// The shape of the slowest mode of n equal masses, by inverse iteration on the tridiagonal stiffness T_i / l.
static void chain_mode( int n, double* u )
{
    for ( int i = 0; i < n; ++i )
    {
        u[i] = i + 1.0;
    }
    for ( int iteration = 0; iteration < 60; ++iteration )
    {
        // Masses 1, link i above mass i pulls with n - i weights; u is the force, solved for the shape from the top:
        // the sum of forces below a link is its pull times its slope.
        double below = 0.0, slopes[CHAIN_MASSES_MAX];
        for ( int i = n - 1; i >= 0; --i )
        {
            below += u[i];
            slopes[i] = below / ( n - i );
        }
        double sum = 0.0;
        for ( int i = 0; i < n; ++i )
        {
            sum += slopes[i];
            u[i] = sum;
        }
        for ( int i = 0; i < n; ++i )
        {
            u[i] /= sum;
        }
    }
}

// Points at equal distances along x = 0 whose sideways displacement is given.
static void lay_mode( const double* sideways, double amplitude, double length, strands_shape* shape )
{
    double x = 0.0, y = 0.0;
    for ( int v = 1; v < shape->vertices; ++v )
    {
        double moved = amplitude * sideways[v], dx = moved - x;
        y -= sqrt( length * length - dx * dx );
        x = moved;
        shape->points[v] = ( wisp_vec3 ){ (float)x, (float)y, 0.0f };
    }
}

static double read_tip( const closed_run* run, const wisp_vec3* points )
{
    return (double)points[run->shape.vertices - 1].x;
}

#define CHAIN_AMPLITUDE 0.02 // of the length: the period of a pendulum of this swing is 3e-5 longer

static wisp_status run_chain( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                              measurement* out, wisp_error* error )
{
    (void)plan;
    closed_run run = { .steps = 0 };
    int n = (int)form->parameter;
    double mode[CHAIN_MASSES_MAX + 1] = { 0.0 };
    wisp_status status = strands_shape_create( 1, n + 1, &run.shape, error );
    if ( status == WISP_OK )
    {
        chain_mode( n, mode + 1 );
        lay_mode( mode, CHAIN_AMPLITUDE * SWING_LENGTH, SWING_LENGTH / n, &run.shape );
    }
    strands_generator generator = default_generator( &run, setting );
    generator.dynamics.vertex_mass = 1.0f;
    status = status == WISP_OK ? strands_implementation_create( &generator, &run.implementation, error ) : status;
    intersections c = { 0 };
    status = status == WISP_OK ? swing( &run, read_tip, &c, error ) : status;
    out->value = period_of( &c );
    out->reference = form->reference * sqrt( SWING_LENGTH / STRANDS_GRAVITY );
    finish( &run, out );
    return status;
}

// ---- tension ----

#define TENSION_VERTICES 20
// Rounding of positions over dt^2 is a force that differs from step to step; its mean does not matter.
#define TENSION_STEPS 60

static wisp_status add_tensions( closed_run* run, double* sums, wisp_error* error )
{
    const wisp_vec3* points = NULL;
    float tensions[TENSION_VERTICES];
    wisp_status status = step( run, &points, error );
    if ( status == WISP_OK )
    {
        status = wisp_read_strand_tension( run->implementation.world, run->implementation.entity, tensions );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( run->implementation.world, status, error );
    }
    for ( int s = 0; s < TENSION_VERTICES && status == WISP_OK; ++s )
    {
        sums[s] += (double)tensions[s] / TENSION_STEPS;
    }
    return status;
}

static wisp_status run_tension( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                                measurement* out, wisp_error* error )
{
    (void)plan;
    (void)form;
    closed_run run = { .steps = 0 };
    const wisp_vec3 down = { 0.0f, -1.0f, 0.0f };
    double tensions[TENSION_VERTICES] = { 0.0 };
    wisp_status status = strands_shape_make_straight( TENSION_VERTICES, down, SWING_LENGTH, &run.shape, error );
    strands_generator generator = default_generator( &run, setting );
    generator.dynamics.vertex_mass = 1.0f;
    status = status == WISP_OK ? strands_implementation_create( &generator, &run.implementation, error ) : status;
    for ( int s = 0; s < TENSION_STEPS && status == WISP_OK; ++s )
    {
        status = add_tensions( &run, tensions, error );
    }
    double worst = -1.0;
    for ( int s = 0; s + 1 < TENSION_VERTICES && status == WISP_OK; ++s )
    {
        // the masses of all vertices behind the segment hang on it
        double reference = STRANDS_GRAVITY * ( TENSION_VERTICES - 1 - s ),
               wrong = fabs( tensions[s] / reference - 1.0 );
        if ( !( wrong <= worst ) )
        {
            worst = wrong;
            out->value = tensions[s];
            out->reference = reference;
        }
    }
    finish( &run, out );
    return status;
}

// ---- catenary ----

#define CATENARY_SEGMENTS 64
#define CATENARY_SPAN 0.8 // m, of a chain of 1 m

// Two straight halves: half of the chain over half of the span, a right triangle.
static void lay_catenary( strands_shape* shape )
{
    double depth = sqrt( 0.25 - 0.25 * CATENARY_SPAN * CATENARY_SPAN );
    for ( int v = 0; v <= CATENARY_SEGMENTS; ++v )
    {
        double t = (double)v / CATENARY_SEGMENTS;
        shape->points[v] =
            ( wisp_vec3 ){ (float)( CATENARY_SPAN * t ), (float)( -2.0 * depth * fmin( t, 1.0 - t ) ), 0.0f };
    }
}

static wisp_status run_catenary( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                                 measurement* out, wisp_error* error )
{
    closed_run run = { .steps = 0 };
    static const int32_t pin = CATENARY_SEGMENTS;
    const wisp_vec3* points = NULL;
    wisp_status status = strands_shape_create( 1, CATENARY_SEGMENTS + 1, &run.shape, error );
    if ( status == WISP_OK )
    {
        lay_catenary( &run.shape );
    }
    strands_generator generator = default_generator( &run, setting );
    generator.dynamics.pins = &pin;
    generator.dynamics.pin_count = 1;
    generator.dynamics.damping = 4.0f;
    status = status == WISP_OK ? strands_implementation_create( &generator, &run.implementation, error ) : status;
    status = status == WISP_OK ? settle( plan, &run, &points, error ) : status;
    out->value = 0.0;
    for ( int v = 0; v <= CATENARY_SEGMENTS && status == WISP_OK; ++v )
    {
        out->value = fmax( out->value, -(double)points[v].y );
    }
    out->reference = form->reference;
    finish( &run, out );
    return status;
}

// ---- rods ----

#define ROD_VERTICES 64
#define ROD_LENGTH 0.2 // m, a hair of ordinary length and thickness; its stiffness follows from the form

static strands_generator rod_generator( const closed_run* run, const closed_setting* setting, double rigidity )
{
    strands_generator generator = default_generator( run, setting );
    double l = ROD_LENGTH / ( ROD_VERTICES - 1 );
    generator.dynamics.bending =
        setting->stretch == WISP_STRAND_STRETCH_DIRECT ? WISP_STRAND_BEND_ROD : WISP_STRAND_BEND_LINKS;
    generator.dynamics.bend_rigidity = (float)rigidity;

    // A distance over two segments resists in the fourth power of the angle: it stores what a rod does at one angle
    // only, here at the mean angle of a hair bent through a right angle.
    double angle = 1.5707963267948966 / ( ROD_VERTICES - 2 );
    generator.dynamics.bend_compliance = (float)( l * l * l * angle * angle / ( 16.0 * rigidity ) );
    generator.dynamics.clamped = true;
    return generator;
}

static wisp_status settle_elastica( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                                    wisp_vec3* tip, measurement* out, wisp_error* error )
{
    closed_run run = { .steps = 0 };
    const wisp_vec3 along = { 1.0f, 0.0f, 0.0f };
    const wisp_vec3* points = NULL;
    wisp_status status = strands_shape_make_straight( ROD_VERTICES, along, ROD_LENGTH, &run.shape, error );
    double weight = (double)wisp_default_strand_dynamics_def().line_density * STRANDS_GRAVITY;
    strands_generator generator =
        rod_generator( &run, setting, weight * ROD_LENGTH * ROD_LENGTH * ROD_LENGTH / form->parameter );
    generator.dynamics.damping = 6.0f;
    status = status == WISP_OK ? strands_implementation_create( &generator, &run.implementation, error ) : status;
    status = status == WISP_OK ? settle( plan, &run, &points, error ) : status;
    if ( status == WISP_OK )
    {
        *tip = points[ROD_VERTICES - 1];
    }
    out->reference = form->reference;
    finish( &run, out );
    return status;
}

static wisp_status run_drop( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                             measurement* out, wisp_error* error )
{
    wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
    wisp_status status = settle_elastica( plan, form, setting, &tip, out, error );
    out->value = -(double)tip.y / ROD_LENGTH;
    return status;
}

static wisp_status run_reach( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                              measurement* out, wisp_error* error )
{
    wisp_vec3 tip = { 0.0f, 0.0f, 0.0f };
    wisp_status status = settle_elastica( plan, form, setting, &tip, out, error );
    out->value = (double)tip.x / ROD_LENGTH;
    return status;
}

static double read_deflection( const closed_run* run, const wisp_vec3* points )
{
    // The clamp has the direction of the first segment as it was added; the tip swings about that line.
    const wisp_vec3* rest = run->shape.points;
    double slope = (double)rest[1].x / (double)rest[1].y;
    return (double)points[ROD_VERTICES - 1].x - slope * (double)points[ROD_VERTICES - 1].y;
}

static wisp_status run_cantilever( const strands_plan* plan, const closed_form* form, const closed_setting* setting,
                                   measurement* out, wisp_error* error )
{
    (void)plan;
    closed_run run = { .steps = 0 };
    double mode[ROD_VERTICES];
    const double b = 1.8751040687, sigma = 0.7340955138; // first mode of a clamped free rod
    for ( int v = 0; v < ROD_VERTICES; ++v )
    {
        double s = b * v / ( ROD_VERTICES - 1 );
        mode[v] = 0.5 * ( cosh( s ) - cos( s ) - sigma * ( sinh( s ) - sin( s ) ) );
    }
    wisp_status status = strands_shape_create( 1, ROD_VERTICES, &run.shape, error );
    if ( status == WISP_OK )
    {
        lay_mode( mode, 0.02 * ROD_LENGTH, ROD_LENGTH / ( ROD_VERTICES - 1 ), &run.shape );
    }
    double density = (double)wisp_default_strand_dynamics_def().line_density, length_2 = ROD_LENGTH * ROD_LENGTH;

    // as stiff as swings once in the wanted period
    double omega = 6.283185307179586 / form->parameter;
    double rigidity = density * length_2 * length_2 * omega * omega / ( 3.51602 * 3.51602 );
    strands_generator generator = rod_generator( &run, setting, rigidity );
    generator.dynamics.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    status = status == WISP_OK ? strands_implementation_create( &generator, &run.implementation, error ) : status;
    intersections c = { 0 };
    status = status == WISP_OK ? swing( &run, read_deflection, &c, error ) : status;
    out->value = 1.0 / period_of( &c );
    out->reference = 1.0 / form->parameter;
    finish( &run, out );
    return status;
}

// ---- the table ----

// Numbers of the closed forms, where they are not computed: chain T1 sqrt(g/L) by the roots of Laguerre
// polynomials, sag of a catenary of span 0.8 L, drop and reach of the heavy elastica.
static const closed_form forms[] = {
    { "pendulum, 10 degrees, s", 10.0, 0.0, 1e-3, false, run_pendulum },
    { "pendulum, 30 degrees, s", 30.0, 0.0, 1e-3, false, run_pendulum },
    { "pendulum, 60 degrees, s", 60.0, 0.0, 1e-3, false, run_pendulum },
    { "pendulum, 90 degrees, s", 90.0, 0.0, 1e-3, false, run_pendulum },
    { "pendulum from 90, after a swing, deg", 90.0, 0.0, INFINITY, false, run_amplitude },
    { "hanging chain, 2 masses, s", 2.0, 5.804906, 5e-3, false, run_chain },
    { "hanging chain, 10 masses, s", 10.0, 5.352609, 5e-3, false, run_chain },
    { "hanging chain, 32 masses, s", 32.0, 5.265950, 5e-3, false, run_chain },
    { "tension of a chain, worst, N", 0.0, 0.0, 1e-3, true, run_tension },
    { "sag of a catenary, m", 0.0, 0.26543751, 5e-3, false, run_catenary },
    { "elastica, G = 1, drop H/L", 1.0, 0.12347140, 2e-2, false, run_drop },
    { "elastica, G = 1, reach W/L", 1.0, 0.99124640, 2e-2, true, run_reach },
    { "elastica, G = 10, drop H/L", 10.0, 0.70019972, 2e-2, false, run_drop },
    { "elastica, G = 10, reach W/L", 10.0, 0.65635376, 2e-2, true, run_reach },
    { "elastica, G = 100, drop H/L", 100.0, 0.93752394, 2e-2, false, run_drop },
    { "elastica, G = 100, reach W/L", 100.0, 0.15922338, 2e-2, true, run_reach },
    { "cantilever, frequency, Hz", 1.0, 0.0, 2e-2, true, run_cantilever },
};

static void add_row( const closed_form* form, const closed_setting* setting, const measurement* m, double wrong,
                     results* out )
{
    results_row* row = results_add_row( out, "strands.closed", form->name );
    if ( row )
    {
        results_put( &row->size, "substeps", setting->substeps );
        results_put( &row->size, "direct", setting->stretch == WISP_STRAND_STRETCH_DIRECT ? 1.0 : 0.0 );
        row->workers = 1;
        row->ms_median = 1e-3 * m->us;
        snprintf( row->error_reference, sizeof( row->error_reference ), "closed form" );
        if ( isfinite( wrong ) )
        {
            results_put( &row->error, "relative", wrong );
        }
    }
}

static void add_line( const closed_form* form, const closed_setting* setting, const measurement* m, int table,
                      results* out )
{
    double wrong = m->value / m->reference - 1.0;
    cells row = { .count = 0 };
    cells_put( &row, "%s", form->name );
    cells_put( &row, "%s", setting->name );
    cells_put( &row, "%d", setting->substeps );
    cells_put_number( &row, m->reference, 6 );
    cells_put_number( &row, m->value, 6 );
    cells_put( &row, isfinite( wrong ) ? "%.4f" : "-", 100.0 * wrong );
    cells_put( &row, setting->is_held && isfinite( form->tolerance ) ? "%.1f" : "-", 100.0 * form->tolerance );
    cells_put_number( &row, m->us, 1 );
    cells_put( &row, "%llu", (unsigned long long)m->laid );
    cells_end_row( &row, table, out );
    add_row( form, setting, m, wrong, out );
    if ( setting->is_held && !( fabs( wrong ) <= form->tolerance ) )
    {
        results_add_failure( out, "%s, %s, %d substeps: %.4f %% from the closed form, more than %.1f %%.", form->name,
                             setting->name, setting->substeps, 100.0 * wrong, 100.0 * form->tolerance );
    }
}

wisp_status strands_closed_forms( const strands_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = { "form",    "solver",      "substeps",    "reference",    "measured",
                                          "error %", "tolerated %", "us per step", "strand resets" };
    int table =
        results_add_table( out, "Strands against closed forms, steps of 1/60 s", WISP_COUNT( header ), header );
    wisp_status status = WISP_OK;
    for ( int f = 0; f < WISP_COUNT( forms ) && status == WISP_OK; ++f )
    {
        for ( int s = 0; s < WISP_COUNT( closed_settings ) && status == WISP_OK; ++s )
        {
            const closed_setting* setting = &closed_settings[s];
            if ( forms[f].direct_only && setting->stretch != WISP_STRAND_STRETCH_DIRECT )
            {
                continue;
            }
            measurement m = { NAN, NAN, NAN, 0 };
            status = forms[f].run( plan, &forms[f], setting, &m, error );
            if ( status == WISP_OK )
            {
                add_line( &forms[f], setting, &m, table, out );
            }
        }
    }
    results_add_note(
        out,
        "Closed forms: a period is timed from one passage through the middle to the next from the same side, and "
        "compared at the amplitude it has by then. Pendulum, chains and rods are %.1f m long, the catenary 1 m.",
        SWING_LENGTH );
    results_add_note( out,
                      "Closed forms: `direct` bends as a rod of %d vertices. `links` are distances over two segments "
                      "without a clamp, with energy in the fourth power of the angle, so they follow no rod.",
                      ROD_VERTICES );
    results_add_note( out,
                      "Closed forms: a hair at rest had %.0f s to settle; the tension is the mean of 1 s. Reset: "
                      "strands too far from their lengths for the direct solve, over all steps.",
                      plan->settle_seconds );
    return status;
}
