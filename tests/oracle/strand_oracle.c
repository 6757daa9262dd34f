#include "strand_oracle.h"

#include <stddef.h>
#include <string.h>

// A segment shorter than this, m, has no direction.
static const double min_length = 1e-15;

static double3 segment_of( const strand_oracle* strand, int s )
{
    return double3_sub( strand->position[s + 1], strand->position[s] );
}

// ---- a strand ----

static void measure_lengths( strand_oracle* strand )
{
    double whole = 0.0;
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        strand->length[s] = double3_length( segment_of( strand, s ) );
        whole += strand->length[s];
    }
    const double least = fmax( 1e-3 * whole / fmax( strand->count - 1, 1 ), 1e-6 );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        strand->length[s] = fmax( strand->length[s], least );
    }
}

bool strand_oracle_shape( strand_oracle* strand, const double3* points, int count )
{
    if ( count < 1 || count > MAX_STRAND_ORACLE )
    {
        return false;
    }
    *strand = ( strand_oracle ){ .count = count, .turn = { 0.0, 0.0, 0.0, 1.0 } };
    for ( int i = 0; i < count; ++i )
    {
        strand->position[i] = strand->previous[i] = points[i];
        strand->max_tension[i] = INFINITY;
    }
    measure_lengths( strand );

    double3 direction[MAX_STRAND_ORACLE];
    strand_oracle_directions( strand, direction );
    const double3 up = double3_make( 0.0, 0.0, 1.0 ), down = double3_make( 0.0, -1.0, 0.0 );
    strand->held_diagonal = 1.0;
    strand->clamp = strand_oracle_smallest( up, count > 1 ? direction[0] : down );
    for ( int s = 0; s + 1 < count; ++s )
    {
        strand->frame[s] = strand_oracle_carried( s > 0 ? strand->frame[s - 1] : strand->clamp, direction[s] );
    }
    return true;
}

void strand_oracle_weigh( strand_oracle* strand, double line_density, bool held )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        double before = i > 0 ? strand->length[i - 1] : 0.0;
        double behind = i + 1 < strand->count ? strand->length[i] : 0.0;
        double fraction = strand->count > 1 ? 0.5 * ( before + behind ) : 1e-3;
        strand->mass[i] = line_density * fraction;
        strand->weight[i] = held && i == 0 ? 0.0 : 1.0 / strand->mass[i];
    }
}

void strand_oracle_pin( strand_oracle* strand, int vertex )
{
    strand->weight[vertex] = 0.0;
}

// ---- motion ----

void strand_oracle_predict( strand_oracle* strand, const double3* root, double3 acceleration, double dt )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        const double3 p = strand->position[i];
        strand->previous[i] = p;
        if ( strand->weight[i] > 0.0 )
        {
            strand->velocity[i] = double3_add_scaled( strand->velocity[i], dt, acceleration );
            strand->position[i] = double3_add_scaled( p, dt, strand->velocity[i] );
        }
        else if ( i == 0 )
        {
            const double3 to = root != NULL ? *root : p;
            strand->velocity[i] = double3_scale( 1.0 / dt, double3_sub( to, p ) );
            strand->position[i] = to;
        }
        else
        {
            strand->previous[i] = double3_add_scaled( p, -dt, strand->velocity[i] );
        }
    }
}

void strand_oracle_velocity( strand_oracle* strand, double dt )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        const double3 predicted = double3_add_scaled( strand->previous[i], dt, strand->velocity[i] );
        if ( strand->weight[i] > 0.0 )
        {
            const double3 moved = double3_sub( strand->position[i], predicted );
            strand->velocity[i] = double3_add_scaled( strand->velocity[i], 1.0 / dt, moved );
        }
    }
}

void strand_oracle_damp( strand_oracle* strand, double keep, double3 linear, double3 angular, double3 centre )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        const double3 arm = double3_sub( strand->position[i], centre );
        const double3 rigid = double3_add( linear, double3_cross( angular, arm ) );
        if ( strand->weight[i] > 0.0 )
        {
            strand->velocity[i] = double3_add_scaled( rigid, keep, double3_sub( strand->velocity[i], rigid ) );
        }
    }
}

void strand_oracle_air( strand_oracle* strand, double3 wind, double drag, double dt )
{
    const int last = strand->count - 1;
    for ( int i = 0; i <= last; ++i )
    {
        const double3 from = strand->position[i > 0 ? i - 1 : i], to = strand->position[i < last ? i + 1 : i];
        const double3 along = double3_sub( to, from ), against = double3_sub( wind, strand->velocity[i] );
        const double squared = double3_dot( along, along );
        double3 across = against;
        if ( squared > min_length * min_length )
        {
            across = double3_add_scaled( against, -double3_dot( against, along ) / squared, along );
        }
        const double reach =
            0.5 * ( ( i > 0 ? strand->length[i - 1] : 0.0 ) + ( i < last ? strand->length[i] : 0.0 ) );
        const double a = drag * reach * double3_length( across ) * strand->weight[i] * dt;
        strand->velocity[i] = double3_add_scaled( strand->velocity[i], a / ( 1.0 + a ), across );
    }
}

// ---- lengths ----

void strand_oracle_directions( const strand_oracle* strand, double3* direction )
{
    double3 good = double3_make( 0.0, -1.0, 0.0 );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = segment_of( strand, s );
        const double length = double3_length( e );
        if ( length >= min_length && isfinite( length ) )
        {
            good = double3_scale( 1.0 / length, e );
        }
        direction[s] = good;
    }
}

double strand_oracle_strain( const strand_oracle* strand )
{
    double worst = 0.0;
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double strain = fabs( double3_length( segment_of( strand, s ) ) / strand->length[s] - 1.0 );
        worst = strain <= worst ? worst : strain; // a NaN is the worst
    }
    return worst;
}

// Gradients of the constraints by the vertex behind each segment, and the constraints.
static void measure_constraints( const strand_oracle* strand, strand_oracle_measure measure, double3* gradient,
                                 double* c )
{
    double3 direction[MAX_STRAND_ORACLE];
    strand_oracle_directions( strand, direction );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = segment_of( strand, s );
        const double l = strand->length[s];
        const bool square = measure == STRAND_ORACLE_SQUARE;
        gradient[s] = square ? e : direction[s];
        c[s] = square ? 0.5 * ( double3_dot( e, e ) - l * l ) : double3_length( e ) - l;
    }
}

// J W J^T dlambda = -C by elimination from the root and substitution from the tip.
static void solve_chain( const strand_oracle* strand, const double3* gradient, const double* c, double* lambda )
{
    double coupling[MAX_STRAND_ORACLE];
    const int segments = strand->count - 1;
    for ( int s = 0; s < segments; ++s )
    {
        const double* w = strand->weight + s;
        const double off = s > 0 ? -w[0] * double3_dot( gradient[s - 1], gradient[s] ) : 0.0;
        const double diagonal = strand->held_diagonal * ( w[0] + w[1] ) * double3_dot( gradient[s], gradient[s] );
        coupling[s] = lambda[s] = 0.0;
        double pivot = diagonal, right = -c[s];
        if ( s > 0 )
        {
            pivot -= off * off * coupling[s - 1];
            right -= off * lambda[s - 1];
        }
        if ( pivot > 1e-12 * diagonal && pivot > 1e-30 )
        {
            coupling[s] = 1.0 / pivot; // inverse pivots for now
            lambda[s] = right / pivot;
        }
    }
    for ( int s = segments - 2; s >= 0; --s )
    {
        const double off = -strand->weight[s + 1] * double3_dot( gradient[s], gradient[s + 1] );
        lambda[s] -= off * coupling[s] * lambda[s + 1];
    }
}

static void newton_pass( strand_oracle* strand, strand_oracle_measure measure, double dt )
{
    double3 gradient[MAX_STRAND_ORACLE];
    double c[MAX_STRAND_ORACLE], lambda[MAX_STRAND_ORACLE];
    measure_constraints( strand, measure, gradient, c );
    solve_chain( strand, gradient, c, lambda );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        strand->tension[s] -= lambda[s] * double3_length( gradient[s] ) / ( dt * dt );
        strand->position[s] = double3_add_scaled( strand->position[s], -strand->weight[s] * lambda[s], gradient[s] );
        strand->position[s + 1] =
            double3_add_scaled( strand->position[s + 1], strand->weight[s + 1] * lambda[s], gradient[s] );
    }
}

static bool is_held_beyond_its_root( const strand_oracle* strand )
{
    bool held = false;
    for ( int i = 1; i < strand->count; ++i )
    {
        held = held || strand->weight[i] <= 0.0;
    }
    return held;
}

static void lay_out( strand_oracle* strand, double dt )
{
    double3 direction[MAX_STRAND_ORACLE];
    double reach = 0.0;
    strand_oracle_directions( strand, direction );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        reach += strand->length[s];
    }
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        double3* put = &strand->position[s + 1];
        *put = double3_add_scaled( strand->position[s], strand->length[s], direction[s] );
        const double3 way = double3_sub( *put, strand->previous[s + 1] );
        const double length = double3_length( way ), predicted = dt * double3_length( strand->velocity[s + 1] );
        if ( !( length <= reach ) || predicted < length )
        {
            strand->previous[s + 1] = double3_add_scaled( *put, length <= reach ? -predicted / length : 0.0, way );
        }
        strand->tension[s] = 0.0;
    }
}

bool strand_oracle_stretch( strand_oracle* strand, strand_oracle_measure measure, int passes, double tolerance,
                            bool keeps_tension, double dt )
{
    for ( int s = 0; s < strand->count && keeps_tension == false; ++s )
    {
        strand->tension[s] = 0.0;
    }
    for ( int pass = 0; pass < passes; ++pass )
    {
        strand->closed ? strand_oracle_closed_pass( strand, dt ) : newton_pass( strand, measure, dt );
    }
    const bool lost = strand->closed == false && !( strand_oracle_strain( strand ) <= tolerance ) &&
                      is_held_beyond_its_root( strand ) == false;
    if ( lost )
    {
        lay_out( strand, dt );
    }
    return lost;
}

void strand_oracle_link( strand_oracle* strand, const double* rest, double* lambda, int stride,
                         strand_oracle_link_rule rule )
{
    const double alpha = rule.compliance * rule.inverse_dt2;
    for ( int a = 0; a + stride < strand->count; ++a )
    {
        const int b = a + stride;
        const double3 along = double3_sub( strand->position[b], strand->position[a] );
        const double length = double3_length( along ), weight = strand->weight[a] + strand->weight[b];
        if ( length < min_length || rest[a] < 0.0 || weight <= 0.0 )
        {
            continue;
        }
        const double error = length - rest[a];
        double change = -rule.stiffness * error / weight;
        if ( rule.inverse_dt2 > 0.0 )
        {
            const double before = lambda != NULL ? lambda[a] : 0.0;
            change = -( error + alpha * before ) / ( weight + alpha );
        }
        if ( lambda != NULL )
        {
            lambda[a] += change;
        }
        strand->position[a] = double3_add_scaled( strand->position[a], -strand->weight[a] * change / length, along );
        strand->position[b] = double3_add_scaled( strand->position[b], strand->weight[b] * change / length, along );
    }
}

// ---- a substep ----

strand_oracle_settings strand_oracle_default_settings( double dt )
{
    return ( strand_oracle_settings ){
        .lengths = STRAND_ORACLE_LENGTHS_DIRECT,
        .passes = 2,
        .tolerance = 1e-3,
        .iterations = 1,
        .along = { .stiffness = 1.0 },
        .bend = { .stiffness = 0.2 },
        .bending = STRAND_ORACLE_BENDING_NONE,
        .gravity = { 0.0, -9.81, 0.0 },
        .dt = dt,
    };
}

static void sweep_links( strand_oracle* strand, const strand_oracle_settings* settings )
{
    double two[MAX_STRAND_ORACLE];
    const bool bends = settings->bending == STRAND_ORACLE_BENDING_LINKS;
    const bool stretches = settings->lengths == STRAND_ORACLE_LENGTHS_LINKS;
    for ( int i = 0; i < strand->count; ++i )
    {
        two[i] = strand->length[i] + ( i + 2 < strand->count ? strand->length[i + 1] : 0.0 );
        strand->stretch_lambda[i] = strand->bend_lambda[i] = 0.0;
    }
    for ( int k = 0; k < settings->iterations; ++k )
    {
        if ( bends )
        {
            strand_oracle_link( strand, two, strand->bend_lambda, 2, settings->bend );
        }
        if ( stretches )
        {
            strand_oracle_link( strand, strand->length, strand->stretch_lambda, 1, settings->along );
        }
    }
}

// What follows the prediction of an implicit step of length dt.
static bool solve_step( strand_oracle* strand, const strand_oracle_settings* settings, double dt )
{
    const bool rod = settings->bending == STRAND_ORACLE_BENDING_ROD;
    bool laid = false;
    if ( rod && strand->closed == false )
    {
        strand_oracle_rod_factor( strand, settings->bend_damping, dt );
    }
    if ( rod )
    {
        strand_oracle_rod( strand, settings->bend_damping, dt, settings->looks_back ? &settings->gravity : NULL );
    }
    sweep_links( strand, settings );
    if ( settings->lengths == STRAND_ORACLE_LENGTHS_DIRECT )
    {
        laid = strand_oracle_stretch( strand, settings->measure, settings->passes, settings->tolerance, rod, dt );
    }
    strand_oracle_velocity( strand, dt );
    return laid;
}

bool strand_oracle_substep( strand_oracle* strand, const strand_oracle_settings* settings, const double3* root )
{
    const double3 none = { 0.0, 0.0, 0.0 };
    strand_oracle_damp( strand, 1.0 / ( 1.0 + settings->damping * settings->dt ), none, none, none );
    strand_oracle_predict( strand, root, settings->gravity, settings->dt );
    return solve_step( strand, settings, settings->dt );
}

// ---- BDF2 ----

static double3 four_minus_one( double3 now, double3 before )
{
    return double3_scale( 1.0 / 3.0, double3_sub( double3_scale( 4.0, now ), before ) );
}

void strand_oracle_extrapolate( strand_oracle* strand, strand_oracle_past* past, double3* start )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        const double3 p = strand->position[i], v = strand->velocity[i];
        start[i] = four_minus_one( p, past->position[i] );
        strand->velocity[i] = strand->weight[i] > 0.0 ? four_minus_one( v, past->velocity[i] ) : v;
        past->position[i] = p;
        past->velocity[i] = v;
    }
}

void strand_oracle_predict_bdf2( strand_oracle* strand, const double3* start, const double3* root,
                                 double3 acceleration, double dt )
{
    const double he = 2.0 / 3.0 * dt;
    for ( int i = 0; i < strand->count; ++i )
    {
        if ( strand->weight[i] > 0.0 )
        {
            strand->velocity[i] = double3_add_scaled( strand->velocity[i], he, acceleration );
            strand->position[i] = double3_add_scaled( start[i], he, strand->velocity[i] );
            strand->previous[i] = start[i];
            continue;
        }
        if ( i == 0 )
        {
            const double3 p = strand->position[i], to = root != NULL ? *root : p;
            strand->velocity[i] = double3_scale( 1.0 / dt, double3_sub( to, p ) );
            strand->position[i] = to;
        }
        strand->previous[i] = double3_add_scaled( strand->position[i], -he, strand->velocity[i] );
    }
}
