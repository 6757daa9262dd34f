#include "stability_judges.h"

#include "text_tree.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

const char* const stability_check_names[STABILITY_CHECK_COUNT] = {
    "crash",  "time",     "refused",  "status",      "finite",        "halted", "energy",
    "strain", "recovery", "speed",    "penetration", "intersections", "rest",   "near",
    "same",   "bits",     "snapshot", "scale",       "shift"
};

__attribute__( ( format( printf, 5, 6 ) ) ) static bool break_it( stability_verdict* out, stability_check judge,
                                                                  int step, double severity, const char* format, ... )
{
    out->check = judge;
    out->step = step;
    out->severity = severity;
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( out->message, sizeof out->message, format, arguments );
    va_end( arguments );
    return false;
}

// ---- every step ----

bool stability_judge_status( const stability_trace* trace, stability_verdict* out )
{
    return trace->status == WISP_OK || break_it( out, STABILITY_STATUS, trace->steps + 1, 1.0, "step %d failed: %s",
                                                 trace->steps + 1, trace->message );
}

bool stability_judge_finite( const stability_trace* trace, stability_verdict* out )
{
    for ( int row = 0; row <= trace->steps; ++row )
    {
        for ( int body = 0; body < trace->body_count; ++body )
        {
            if ( !stability_sample_of( trace, row, body )->is_finite )
            {
                return break_it( out, STABILITY_FINITE, row, 1.0, "%s is not finite at %.3g s",
                                 trace->bodies[body].name, trace->times[row] );
            }
        }
    }
    return true;
}

// The speed before tells what led to it.
bool stability_judge_halted( const stability_trace* trace, stability_verdict* out )
{
    for ( int body = 0; body < trace->body_count; ++body )
    {
        if ( !trace->bodies[body].is_halted )
        {
            continue;
        }
        double speed = 0.0;
        int fastest = 0;
        for ( int row = 0; row <= trace->steps; ++row )
        {
            const double now = stability_sample_of( trace, row, body )->speed;
            fastest = now > speed ? row : fastest;
            speed = fmax( speed, now );
        }
        return break_it( out, STABILITY_HALTED, fastest, 1.0,
                         "%s was halted; it was fastest at %.3g s, with %.3g m/s", trace->bodies[body].name,
                         trace->times[fastest], speed );
    }
    return true;
}

// ---- energy ----

static double distance_of( const double a[3], const double b[3] )
{
    return sqrt( ( a[0] - b[0] ) * ( a[0] - b[0] ) + ( a[1] - b[1] ) * ( a[1] - b[1] ) +
                 ( a[2] - b[2] ) * ( a[2] - b[2] ) );
}

// What gravity gives is in the potential energy. A pin, collider or event of speed V leaves what it meets with 2 V at
// most, and lifts it along its path. Wind of speed W drags a body along with up to W, and a part that lags behind it
// may be thrown to 2 W; where it carries the body, its force works along the way. So do buoyancy and jet. Gas and
// bent hair set free what they store. What starts inside a collider, or too near to something else, is lifted out of
// it: no farther than everything together is large. Corrections may round up: one percent of what the motion holds.
static double energy_budget( const stability_trace* trace, int row )
{
    const double ROUNDING = 0.01, DRIVEN = 2.0, FLUTTER = 2.0;
    const stability_inputs* in = &trace->inputs;
    double budget = in->gas + in->rods;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        const stability_body* b = &trace->bodies[body];
        const stability_sample *s = stability_sample_of( trace, row, body ),
                               *first = stability_sample_of( trace, 0, body );
        const double way = b->moves ? distance_of( s->centre, b->start ) : 0.0;
        const double thrown = pow( DRIVEN * in->speed, 2.0 ) + pow( FLUTTER * in->wind, 2.0 );
        budget += 0.5 * b->mass * thrown + b->mass * b->gravity * ( in->path + trace->extent );
        budget += ( in->lift + in->drag ) * way;
        budget += ROUNDING * ( first->kinetic + fabs( first->potential ) + fabs( s->potential ) );
    }
    return budget;
}

static double whole_energy( const stability_trace* trace, int row )
{
    double sum = 0.0;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        const stability_sample* s = stability_sample_of( trace, row, body );
        sum += s->kinetic + s->potential;
    }
    return sum;
}

static int fastest_body( const stability_trace* trace, int row )
{
    int fastest = 0;
    for ( int body = 1; body < trace->body_count; ++body )
    {
        const bool is_faster =
            stability_sample_of( trace, row, body )->speed > stability_sample_of( trace, row, fastest )->speed;
        fastest = is_faster ? body : fastest;
    }
    return fastest;
}

bool stability_judge_energy( const stability_trace* trace, stability_verdict* out )
{
    const double start = whole_energy( trace, 0 );
    for ( int row = 1; row <= trace->steps && !trace->inputs.gains_energy; ++row )
    {
        const double gain = whole_energy( trace, row ) - start, budget = energy_budget( trace, row );
        if ( gain > budget )
        {
            const int body = fastest_body( trace, row );
            return break_it( out, STABILITY_ENERGY, row, gain / budget,
                             "energy is %.3g J above the start at %.3g s, and inputs explain %.3g J; %s has %.3g m/s",
                             gain, trace->times[row], budget, trace->bodies[body].name,
                             stability_sample_of( trace, row, body )->speed );
        }
    }
    return true;
}

// ---- at rest ----

// Inputs are at rest since this time at the end of a run. Solvers that need longer than a second to bring back
// lengths or to push out what is inside are too slow for what is shown.
static const double SETTLING = 1.0; // s

bool stability_is_at_rest( const stability_trace* trace )
{
    return trace->steps > 0 && trace->times[trace->steps] - trace->inputs.last >= SETTLING;
}

// Pins, colliders and heads that moved may hold a body stretched, or inside of something. So may a collider that it
// starts in.
bool stability_is_held( const stability_trace* trace, int body )
{
    const stability_body* b = &trace->bodies[body];
    return ( b->is_pinned && trace->inputs.moves_pins ) || b->starts_inside;
}

bool stability_judge_strain( const stability_trace* trace, stability_verdict* out )
{
    const double FREE = 0.5;     // folds and contacts keep single edges long; half is far beyond what is seen of them
    const double FACTOR = 3.0;   // of the stretch that weight explains: it is an estimate
    const double TOO_SOFT = 1.0; // a body that its weight stretches to twice its length says nothing
    for ( int body = 0; body < trace->body_count && stability_is_at_rest( trace ); ++body )
    {
        const stability_body* b = &trace->bodies[body];
        // the softness is of equal masses
        const double softness =
            b->is_uneven ? fmax( b->softness, stability_sample_of( trace, trace->steps, body )->reach ) : b->softness;
        const double limit = FREE + FACTOR * softness;
        if ( b->moves && softness < TOO_SOFT && !stability_is_held( trace, body ) && b->stretch > limit )
        {
            return break_it( out, STABILITY_STRAIN, trace->steps, b->stretch / limit,
                             "%s has an edge stretched by %.3g %% at the end, and its weight explains %.3g %%",
                             b->name, 100.0 * b->stretch, 100.0 * softness );
        }
    }
    return true;
}

bool stability_judge_penetration( const stability_trace* trace, stability_verdict* out )
{
    const double SMALL = 0.01; // of the body: depths that nobody sees, of colliders without a thickness
    for ( int body = 0;
          body < trace->body_count && stability_is_at_rest( trace ) && !trace->inputs.has_colliders_close; ++body )
    {
        const stability_body* b = &trace->bodies[body];
        const stability_sample* s = stability_sample_of( trace, trace->steps, body );
        // Below the surface of the collider, by more than the distance that is to be kept from it.
        const double depth = s->penetration - s->thickness;
        const double limit = fmax( s->thickness, SMALL * b->size );
        if ( b->moves && !b->is_carried && !stability_is_held( trace, body ) && depth > limit )
        {
            return break_it( out, STABILITY_PENETRATION, trace->steps, depth / limit,
                             "%s is %.3g mm inside a collider at the end, with a thickness of %.3g mm", b->name,
                             1e3 * depth, 1e3 * s->thickness );
        }
    }
    return true;
}

bool stability_judge_intersections( const stability_trace* trace, stability_verdict* out )
{
    const int most = trace->intersections_most > trace->intersections_after ? trace->intersections_most
                                                                            : trace->intersections_after;
    const bool came = trace->intersections_before == 0 && most > 0;
    if ( came && stability_is_at_rest( trace ) && !trace->inputs.moves_pins && !trace->inputs.may_intersect )
    {
        return break_it( out, STABILITY_INTERSECTIONS, trace->steps, most,
                         "%d edges pass through triangles at the end, none did at the start", most );
    }
    return true;
}

// ---- motion that does not die ----

// Rows of the last part of a run, from a time on.
static int row_at( const stability_trace* trace, double time )
{
    int row = 0;
    while ( row < trace->steps && trace->times[row] < time )
    {
        ++row;
    }
    return row;
}

// @param travels by where vertices are after steps, not by their velocities
static double speed_between( const stability_trace* trace, int body, int from, int to, bool travels )
{
    double speed = 0.0;
    for ( int row = from; row <= to; ++row )
    {
        const stability_sample* sample = stability_sample_of( trace, row, body );
        speed = fmax( speed, travels ? sample->travel : sample->speed );
    }
    return speed;
}

// Bodies touch and carry each other: the least damped one keeps the others in motion.
static double least_damping( const stability_trace* trace )
{
    double damping = INFINITY;
    for ( int body = 0; body < trace->body_count; ++body )
    {
        damping = trace->bodies[body].moves ? fmin( damping, trace->bodies[body].damping ) : damping;
    }
    return damping;
}

// A body that falls, slides or swings goes somewhere: only one that is fast and stays where it is trembles.
static bool judge_body_at_rest( const stability_trace* trace, int body, stability_verdict* out )
{
    const double WINDOW = 0.5;    // s
    const double SLOW = 0.01;     // of the speed of a fall through the body's own size
    const double UNSEEN = 0.01;   // m/s
    const double ROUNDINGS = 4.0; // bits: far from the origin a vertex at rest moves by single ones
    const double DAMPED = 3.0;    // rates times time that damp a motion to a twentieth
    const double FAST = 10.0,
                 GONE = 5.0;   // times the speed that is slow; rates times time after which nothing is left
    const double TRAVEL = 0.2; // part of the way of the fastest vertex that the centre goes
    const stability_body* b = &trace->bodies[body];
    const double end = trace->times[trace->steps], begin = trace->inputs.last + SETTLING;
    const int early = row_at( trace, begin ), early_end = row_at( trace, begin + WINDOW ),
              late = row_at( trace, end - WINDOW );
    const double elapsed = end - WINDOW - begin;
    if ( !b->moves || b->starts_inside || elapsed < WINDOW || least_damping( trace ) * elapsed < DAMPED )
    {
        return true;
    }
    const double before = speed_between( trace, body, early, early_end, false ),
                 after = speed_between( trace, body, late, trace->steps, false );
    const double slow = SLOW * sqrt( fmax( b->gravity, 1.0 ) * b->size ) + ROUNDINGS * trace->rounding;
    const double limit = fmax( UNSEEN, slow );
    const double way = distance_of( stability_sample_of( trace, late, body )->centre,
                                    stability_sample_of( trace, trace->steps, body )->centre );
    const bool grows = after > limit && after >= before;
    const bool lasts = after > FAST * limit && after > 0.5 * before && least_damping( trace ) * elapsed > GONE;
    if ( ( grows || lasts ) && way < TRAVEL * after * WINDOW )
    {
        return break_it(
            out, STABILITY_REST, trace->steps, after / limit,
            "%s moves with %.3g m/s at the end, %.3g s after all inputs rest, and with %.3g m/s %.3g s before",
            b->name, after, end - trace->inputs.last, before, elapsed );
    }
    return true;
}

bool stability_judge_rest( const stability_trace* trace, stability_verdict* out )
{
    // What starts through each other pushes for ever, and the order of the list gains energy: both are documented.
    const bool is_excused = trace->inputs.gains_energy || trace->intersections_before > 0;
    bool holds = true;
    for ( int body = 0; body < trace->body_count && holds && stability_is_at_rest( trace ) && !is_excused; ++body )
    {
        holds = judge_body_at_rest( trace, body, out );
    }
    return holds;
}

// ---- figures and their limits ----

static bool is_within( double value, double limit )
{
    return isinf( limit ) || value <= limit; // NaN is not
}

static bool judge_figures( const stability_trace* trace, const stability_figures* f, stability_check check,
                           stability_verdict* out )
{
    switch ( check )
    {
        case STABILITY_ENERGY:
            return is_within( f->energy, f->energy_limit ) ||
                   break_it( out, check, f->energy_row, f->energy / f->energy_limit,
                             "energy is %.3g J above that when inputs came to rest, and %.3g J are allowed",
                             f->energy, f->energy_limit );
        case STABILITY_STRAIN:
            return is_within( f->strain, f->strain_limit ) ||
                   break_it( out, check, trace->steps, f->strain / f->strain_limit,
                             "%s has an edge %.3g %% off its length at the end, and %.3g %% are allowed",
                             trace->bodies[f->strain_body].name, 100.0 * f->strain, 100.0 * f->strain_limit );
        case STABILITY_RECOVERY:
            return is_within( f->recovery, f->recovery_limit ) ||
                   break_it(
                       out, check, f->recovery_row, f->recovery / f->recovery_limit,
                       "%s has an edge beyond its limit until %.3g s after all inputs rest, and %.3g s are allowed",
                       trace->bodies[f->recovery_body].name, f->recovery, f->recovery_limit );
        case STABILITY_SPEED:
            return is_within( f->speed, f->speed_limit ) ||
                   break_it( out, check, f->speed_row, f->speed / f->speed_limit,
                             "a vertex moves with %.3g m/s, and inputs explain %.3g m/s", f->speed, f->speed_limit );
        case STABILITY_REST:
            return is_within( f->rest, f->rest_limit ) ||
                   break_it( out, check, trace->steps, f->rest / f->rest_limit,
                             "%s moves with %.3g m/s in the last twentieth of the run, and %.3g m/s are allowed",
                             trace->bodies[f->rest_body].name, f->rest, f->rest_limit );
        default:
            return true;
    }
}

bool stability_judge_trace( const stability_trace* trace, unsigned checks, const stability_limits* limits,
                            stability_verdict* out )
{
    static stability_judge_fn* const judges[STABILITY_CHECK_COUNT] = {
        [STABILITY_STATUS] = stability_judge_status,
        [STABILITY_FINITE] = stability_judge_finite,
        [STABILITY_HALTED] = stability_judge_halted,
        [STABILITY_ENERGY] = stability_judge_energy,
        [STABILITY_STRAIN] = stability_judge_strain,
        [STABILITY_PENETRATION] = stability_judge_penetration,
        [STABILITY_INTERSECTIONS] = stability_judge_intersections,
        [STABILITY_REST] = stability_judge_rest,
    };
    *out = ( stability_verdict ){ .check = STABILITY_HOLDS };
    const stability_figures figures = stability_figures_of( trace, limits );
    for ( int i = 0; i < STABILITY_CHECK_COUNT; ++i )
    {
        const bool is_meant = ( checks & stability_bit( (stability_check)i ) ) != 0;
        if ( is_meant &&
             ( ( judges[i] && !judges[i]( trace, out ) ) ||
               ( ( checks & STABILITY_CLOSE ) && !judge_figures( trace, &figures, (stability_check)i, out ) ) ) )
        {
            return false;
        }
    }
    return limits == NULL || ( checks & stability_bit( STABILITY_NEAR ) ) == 0 ||
           stability_judge_near( trace, limits, out );
}

// ---- figures next to close limits ----

// Figures of a run next to their limits. bench/stability/README.md explains each limit; the judges above have coarser ones, which
// hold for more scenes.

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
    const double time = end_of( trace ) - trace->times[begin];
    return !trace->bodies[body].is_pinned &&
           distance_of( a, b ) > PART * stability_sample_of( trace, trace->steps, body )->travel * time;
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

static void put_rest( const stability_trace* trace, stability_figures* out )
{
    const int begin = first_of_last_part( trace );
    const bool is_excused = trace->inputs.gains_energy || trace->inputs.works || trace->intersections_before > 0;
    for ( int body = 0; body < trace->body_count && !is_excused && elapsed_of( trace ) >= SETTLING; ++body )
    {
        const double speed = speed_between( trace, body, begin, trace->steps, true ),
                     limit = rest_limit( trace, body );
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
static void put_what_is_shown( const stability_trace* trace, int begin, stability_figures* out )
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
        const double rest = speed_between( trace, body, last_part, trace->steps, true );
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
    put_what_is_shown( trace, begin >= 0 ? begin : 0, &out );
    if ( limits != NULL )
    {
        out.strain_limit = given( limits->strain, out.strain_limit );
        out.energy_limit = given( limits->energy, out.energy_limit );
        out.speed_limit = given( limits->speed, out.speed_limit );
        out.rest_limit = given( limits->rest, out.rest_limit );
    }
    return out;
}

// ---- bits ----

// The same scene with other numbers of workers and other instruction sets.

bool stability_compare_bits( const uint64_t* expected, int expected_count, const uint64_t* found, int found_count,
                             stability_check judge, int first, const char* how, stability_verdict* out )
{
    int same = 0;
    while ( same < expected_count && same < found_count && expected[same] == found[same] )
    {
        ++same;
    }
    if ( same == expected_count && same == found_count )
    {
        return true;
    }
    *out = ( stability_verdict ){ .check = judge, .step = first + same + 1, .severity = 1.0 };
    snprintf( out->message, sizeof out->message, "step %d has other bits %s", first + same + 1, how );
    return false;
}

int stability_hash_steps( scene_world* world, int steps, uint64_t* hashes )
{
    int made = 0;
    while ( made < steps && scene_world_step( world, NULL ) == WISP_OK )
    {
        hashes[made++] = wisp_world_hash( world->world );
    }
    return made;
}

// @return steps that were made; -1 if the scene or its instruction set is refused
static int hash_scene( const wisp_scene* scene, const scene_world_options* options, int steps, uint64_t* hashes )
{
    scene_world world;
    const wisp_status status = scene_world_create( scene, options, &world, NULL );
    const int made = status == WISP_OK          ? stability_hash_steps( &world, steps, hashes )
                     : status == WISP_BAD_INPUT ? -1
                                                : 0;
    scene_world_destroy( &world );
    return made;
}

// Instruction sets that the build leaves out are not compared.
bool stability_judge_bits( const wisp_scene* scene, int steps, stability_verdict* out )
{
    static const struct
    {
        int workers;
        const char *isa, *how;
    } places[] = { { 2, "baseline", "with 2 workers than with one" },
                   { 5, "avx2", "with 5 workers and AVX2 than with one and without" },
                   { 1, "avx512", "with AVX-512 than without" } };
    uint64_t *expected = text_alloc( (size_t)steps * sizeof *expected ),
             *found = text_alloc( (size_t)steps * sizeof *found );
    const scene_world_options plain = { .workers = 1, .isa = "baseline", .is_quiet = true };
    const int made = hash_scene( scene, &plain, steps, expected );
    bool holds = true;
    for ( int i = 0; i < WISP_COUNT( places ) && holds; ++i )
    {
        const scene_world_options options = { .workers = places[i].workers, .isa = places[i].isa, .is_quiet = true };
        const int count = hash_scene( scene, &options, steps, found );
        holds = count < 0 ||
                stability_compare_bits( expected, made, found, count, STABILITY_BITS, 0, places[i].how, out );
    }
    free( expected );
    free( found );
    return holds;
}
