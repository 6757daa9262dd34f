// Figures of a run next to their limits. bench/stability/README.md explains each limit; app/stability/stability_judges.c has
// coarser ones, which hold for more scenes.
#include "stability_judges.h"

#include <float.h>
#include <math.h>

// Inputs are at rest since this time at the end of a run.
static const double SETTLING = 1.0; // s

// ---- when ----

// The first row from which on nothing moves, blows, or fills any more; -1: none.
static int row_of_rest( const stability_trace* trace )
{
    const double dt = trace->steps > 0 ? trace->times[1] - trace->times[0] : 0.0;
    for ( int row = 0; row <= trace->steps; ++row )
    {
        if ( trace->times[row] >= trace->inputs.last - 1e-3 * dt )
        {
            return trace->inputs.has_events && row < trace->steps ? row + 1 : row;
        }
    }
    return -1;
}

static double end_of( const stability_trace* trace )
{
    return trace->times[trace->steps];
}

static double elapsed_of( const stability_trace* trace )
{
    return end_of( trace ) - trace->inputs.last;
}

// A body swings with the period of a pendulum of its size, and two of them must have passed.
static bool has_swung( const stability_trace* trace, const stability_body* b )
{
    const double PERIODS = 2.0, FULL_TURN = 6.283185307179586;
    return elapsed_of( trace ) >= PERIODS * FULL_TURN * sqrt( b->extent / fmax( b->gravity, 1e-30 ) );
}

// A pendulum of rate w under a damping c decays with c / 2, and creeps with w^2 / c where that is slower.
static bool has_settled( const stability_trace* trace, const stability_body* b, double damping )
{
    const double RATES = 6.0; // a hundredth of what a fall through its own size leaves, and a quarter of it
    const double creep = b->gravity / fmax( b->extent * damping, 1e-30 );
    return fmin( 0.5 * damping, creep ) * elapsed_of( trace ) >= RATES;
}

static double least_damping( const stability_trace* trace )
{
    double damping = INFINITY;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        damping = trace->bodies[body].moves ? fmin( damping, trace->bodies[body].damping ) : damping;
    }
    return damping;
}

// ---- strain, and when it came back ----

// Pins and heads move as a whole, and stretch nothing: only what a collider or a pinned neighbour presses on at the end
// may be held.
static bool is_pressed( const stability_trace* trace, int body )
{
    const stability_body* b = &trace->bodies[body];
    const bool touches = stability_sample_of( trace, trace->steps, body )->contacts > 0 || b->has_contact;
    return b->starts_inside || ( b->is_pinned && trace->inputs.moves_pins && touches );
}

static double reach_of( const stability_trace* trace, int row, int body )
{
    return fmin( stability_sample_of( trace, row, body )->reach, trace->bodies[body].twin );
}

static void put_strain( const stability_trace* trace, stability_figures* out )
{
    for ( int body = 0; body < trace->body_count && elapsed_of( trace ) >= SETTLING; ++body )
    {
        const double strain = stability_sample_of( trace, trace->steps, body )->strain,
                     limit = reach_of( trace, trace->steps, body );
        const bool is_judged = trace->bodies[body].moves && !is_pressed( trace, body ) && isfinite( limit );
        if ( is_judged && ( out->strain_body < 0 || strain / limit > out->strain / out->strain_limit ) )
        {
            out->strain = strain;
            out->strain_limit = limit;
            out->strain_body = body;
        }
    }
}

// The last time at which a body was longer than its limit, which must be within three fifths of the time.
static void put_recovery( const stability_trace* trace, stability_figures* out )
{
    const double MOST = 0.6; // of the time without inputs
    for ( int body = 0; body < trace->body_count && elapsed_of( trace ) >= SETTLING; ++body )
    {
        const stability_body* b = &trace->bodies[body];
        int last = 0;
        for ( int row = 1; row <= trace->steps && b->moves && !is_pressed( trace, body ); ++row )
        {
            const bool is_beyond =
                !( stability_sample_of( trace, row, body )->strain <= reach_of( trace, row, body ) );
            last = is_beyond ? row : last;
        }
        const double late = trace->times[last] - trace->inputs.last;
        if ( last > 0 && late > out->recovery )
        {
            out->recovery = late;
            out->recovery_row = last;
            out->recovery_body = body;
        }
        out->recovery_limit =
            has_swung( trace, b ) ? fmin( out->recovery_limit, MOST * elapsed_of( trace ) ) : out->recovery_limit;
    }
}

// ---- energy ----

static double sum_of( const stability_trace* trace, int row, bool is_bent )
{
    double sum = 0.0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        const stability_sample* s = stability_sample_of( trace, row, body );
        sum += trace->bodies[body].moves ? s->energy + ( is_bent ? s->bent : 0.0 ) : 0.0;
    }
    return sum;
}

// A hundredth of what gravity can give and of what is stored, and what a fall within a substep cannot tell.
static double energy_limit( const stability_trace* trace )
{
    const double PART = 0.01;
    double limit = 0.0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        const stability_body* b = &trace->bodies[body];
        const stability_sample* s = stability_sample_of( trace, 0, body );
        const double fall = b->gravity * b->shortest * b->shortest;
        limit += b->moves ? b->mass * b->gravity * ( PART * b->extent + fall ) + PART * ( s->stored + s->bent ) : 0.0;
    }
    return limit;
}

static bool is_energy_known( const stability_trace* trace )
{
    bool is_known = !trace->inputs.gains_energy && !trace->inputs.works && !trace->inputs.is_uneven &&
                    trace->intersections_before <= 0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        is_known = is_known && !trace->bodies[body].starts_inside;
    }
    return is_known;
}

static void find_energy( const stability_trace* trace, int begin, stability_figures* out )
{
    const double start = sum_of( trace, begin, true );
    for ( int row = begin + 1; row <= trace->steps; ++row )
    {
        const double rise = sum_of( trace, row, false ) - start;
        out->energy_row = rise > out->energy ? row : out->energy_row;
        out->energy = fmax( out->energy, rise );
    }
}

static void put_energy( const stability_trace* trace, int begin, stability_figures* out )
{
    const double limit = energy_limit( trace );
    if ( isfinite( sum_of( trace, begin, true ) ) && isfinite( limit ) && is_energy_known( trace ) )
    {
        out->energy_limit = limit;
        find_energy( trace, begin, out );
    }
}

// ---- speed ----

static void find_speed( const stability_trace* trace, stability_figures* out )
{
    for ( int row = 1; row <= trace->steps; ++row )
    {
        for ( int body = 0; body < trace->body_count; ++body )
        {
            const double travel = stability_sample_of( trace, row, body )->travel;
            out->speed_row = travel > out->speed ? row : out->speed_row;
            out->speed = fmax( out->speed, travel );
        }
    }
}

// An elastic hit by what moves gives twice its speed; taut links of a chain add once more. So does a fall.
static void put_speed( const stability_trace* trace, stability_figures* out )
{
    const double FACTOR = 4.0, GRAVITY = 9.81;
    bool is_judged = trace->inputs.speed > 0.0 && isfinite( trace->inputs.last ) && !trace->inputs.works;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        is_judged = is_judged && !trace->bodies[body].starts_away && !trace->bodies[body].starts_inside;
    }
    const double fall = sqrt( 2.0 * GRAVITY * ( trace->extent + trace->inputs.path ) );
    out->speed_limit = is_judged ? FACTOR * fmax( trace->inputs.speed, fall ) : INFINITY;
    if ( is_judged )
    {
        find_speed( trace, out );
    }
}

// ---- rest ----

// What falls or slides goes somewhere, and only what holds it can stop that.
static bool goes_away( const stability_trace* trace, int body, int begin )
{
    const double PART = 0.5; // of the way of the fastest vertex that the centre goes
    const double *a = stability_sample_of( trace, begin, body )->centre,
                 *b = stability_sample_of( trace, trace->steps, body )->centre;
    const double way = sqrt( ( a[0] - b[0] ) * ( a[0] - b[0] ) + ( a[1] - b[1] ) * ( a[1] - b[1] ) +
                             ( a[2] - b[2] ) * ( a[2] - b[2] ) );
    const double time = end_of( trace ) - trace->times[begin];
    return !trace->bodies[body].is_pinned &&
           way > PART * stability_sample_of( trace, trace->steps, body )->travel * time;
}

// Bodies that are stretched to four times their length bounce longer than a run.
static bool must_rest( const stability_trace* trace, int body )
{
    const double SOFT = 4.0;
    const stability_body* b = &trace->bodies[body];
    const double damping = b->moves ? b->damping : least_damping( trace );
    return !b->starts_inside && isfinite( damping ) && has_swung( trace, b ) && has_settled( trace, b, damping ) &&
           !( b->moves && stability_sample_of( trace, 0, body )->reach >= SOFT );
}

// A hundredth of the speed of a fall through its own size, or what a coordinate is rounded by in a substep.
static double rest_limit( const stability_trace* trace, int body )
{
    const double PART = 0.01, ROUNDINGS = 8.0;
    const stability_body* b = &trace->bodies[body];
    const double coordinate = stability_sample_of( trace, trace->steps, body )->coordinate;
    const double rounding = ROUNDINGS * (double)FLT_EPSILON * fmax( b->extent, coordinate ) / b->shortest;
    return fmax( PART * sqrt( fmax( b->gravity, 1.0 ) * b->extent ), rounding );
}

static int first_of_last_part( const stability_trace* trace )
{
    const double LAST = 0.05; // part of the run
    int begin = trace->steps;
    while ( begin > 0 && trace->times[begin - 1] >= ( 1.0 - LAST ) * end_of( trace ) * ( 1.0 - 1e-9 ) )
    {
        --begin;
    }
    return begin;
}

static double travel_between( const stability_trace* trace, int body, int from, int to )
{
    double speed = 0.0;
    for ( int row = from; row <= to; ++row )
    {
        speed = fmax( speed, stability_sample_of( trace, row, body )->travel );
    }
    return speed;
}

static void put_rest( const stability_trace* trace, stability_figures* out )
{
    const int begin = first_of_last_part( trace );
    const bool is_excused = trace->inputs.gains_energy || trace->inputs.works || trace->intersections_before > 0;
    for ( int body = 0; body < trace->body_count && !is_excused && elapsed_of( trace ) >= SETTLING; ++body )
    {
        const double speed = travel_between( trace, body, begin, trace->steps ), limit = rest_limit( trace, body );
        if ( must_rest( trace, body ) && !goes_away( trace, body, begin ) &&
             ( out->rest_body < 0 || speed / limit > out->rest / out->rest_limit ) )
        {
            out->rest = speed;
            out->rest_limit = limit;
            out->rest_body = body;
        }
    }
}

// ---- without a limit ----

// What a run shows where none of its limits is known, for users who have one of their own.
static void measure( const stability_trace* trace, int begin, stability_figures* out )
{
    const int last_part = first_of_last_part( trace );
    const bool has_strain = out->strain_body >= 0, has_rest = out->rest_body >= 0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        const double strain = stability_sample_of( trace, trace->steps, body )->strain;
        if ( !has_strain && trace->bodies[body].moves && !( strain < out->strain ) )
        {
            out->strain = strain;
            out->strain_body = body;
        }
        const double rest = travel_between( trace, body, last_part, trace->steps );
        if ( !has_rest && !( rest < out->rest ) )
        {
            out->rest = rest;
            out->rest_body = body;
        }
    }
    if ( isinf( out->energy_limit ) )
    {
        find_energy( trace, begin, out );
    }
    if ( isinf( out->speed_limit ) )
    {
        find_speed( trace, out );
    }
}

static double given( double limit, double found )
{
    return limit > 0.0 ? limit : found;
}

unsigned stability_without_limit( const stability_figures* figures, unsigned checks )
{
    const struct
    {
        stability_check check;
        double limit;
    } all[] = { { STABILITY_ENERGY, figures->energy_limit },
                { STABILITY_STRAIN, figures->strain_limit },
                { STABILITY_REST, figures->rest_limit } };
    unsigned without = 0;
    for ( int i = 0; i < WISP_COUNT( all ); ++i )
    {
        without |= isinf( all[i].limit ) ? checks & stability_bit( all[i].check ) : 0;
    }
    return without;
}

stability_figures stability_figures_of( const stability_trace* trace, const stability_limits* limits )
{
    stability_figures out = { .strain_limit = INFINITY,
                              .recovery_limit = INFINITY,
                              .energy_limit = INFINITY,
                              .speed_limit = INFINITY,
                              .rest_limit = INFINITY,
                              .strain_body = -1,
                              .rest_body = -1 };
    const int begin = row_of_rest( trace );
    put_speed( trace, &out );
    if ( begin >= 0 )
    {
        put_strain( trace, &out );
        put_recovery( trace, &out );
        put_energy( trace, begin, &out );
        put_rest( trace, &out );
    }
    measure( trace, begin >= 0 ? begin : 0, &out );
    if ( limits != NULL )
    {
        out.strain_limit = given( limits->strain, out.strain_limit );
        out.energy_limit = given( limits->energy, out.energy_limit );
        out.speed_limit = given( limits->speed, out.speed_limit );
        out.rest_limit = given( limits->rest, out.rest_limit );
    }
    return out;
}
