// Rods: stiffness, the matrix and its factors, twist in equilibrium, and a substep.
#include "strand_oracle_rod.h"

#include <string.h>

// ---- stiffness ----

void strand_oracle_stiffen( strand_oracle* strand, double bend_rigidity, double twist_rigidity, bool clamped,
                            double dt )
{
    const double* l = strand->length;
    const double* w = strand->weight;
    for ( int i = 0; i < strand->count; ++i )
    {
        strand->stiffness[i] = strand->twist_stiffness[i] = 0.0;
        if ( i >= rod_bending_count( strand ) || ( i == 0 && clamped == false ) )
        {
            continue;
        }
        const bool is_tip = i + 1 == strand->count;
        const double reach = 0.5 * ( ( i > 0 ? l[i - 1] : 0.0 ) + ( is_tip ? 0.0 : l[i] ) );
        const double shorter = is_tip ? l[i - 1] : i > 0 ? fmin( l[i - 1], l[i] ) : l[i];
        const double lightest = fmax( fmax( i > 0 ? w[i - 1] : 0.0, w[i] ), is_tip ? 0.0 : w[i + 1] );
        strand->stiffness[i] = bend_rigidity / reach;
        strand->twist_stiffness[i] = twist_rigidity / reach;
        if ( dt * lightest > 0.0 )
        {
            strand->stiffness[i] = fmin( strand->stiffness[i], 6e4 * shorter * shorter / ( dt * dt * lightest ) );
        }
    }
}

// ---- M + scale K ----

// C_i as a combination of p_{i-1}, p_i, p_{i+1}; the first is absent at the clamp, the last at a tip.
static void coefficients( const strand_oracle* strand, int i, double c[3] )
{
    c[2] = i + 1 < strand->count ? 1.0 / strand->length[i] : 0.0;
    c[0] = i > 0 ? 1.0 / strand->length[i - 1] : 0.0;
    c[1] = -c[0] - c[2];
}

void strand_oracle_rod_matrix( const strand_oracle* strand, double scale, double* matrix )
{
    const int n = strand->count;
    memset( matrix, 0, sizeof( double ) * (size_t)n * (size_t)n );
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        double c[3];
        coefficients( strand, i, c );
        const int end = i + 1 < n ? 3 : 2;
        for ( int a = i > 0 ? 0 : 1; a < end; ++a )
        {
            for ( int b = i > 0 ? 0 : 1; b < end; ++b )
            {
                matrix[( i - 1 + a ) * n + i - 1 + b] += scale * strand->stiffness[i] * c[a] * c[b];
            }
        }
    }
    for ( int i = 0; i < n; ++i )
    {
        matrix[i * n + i] += strand->weight[i] > 0.0 ? 1.0 / strand->weight[i] : 0.0;
        for ( int j = 0; j < n && strand->weight[i] <= 0.0; ++j )
        {
            matrix[i * n + j] = matrix[j * n + i] = 0.0;
        }
    }
}

void strand_oracle_rod_factor( strand_oracle* strand, double damping, double dt )
{
    const int n = strand->count;
    double matrix[MAX_STRAND_ORACLE * MAX_STRAND_ORACLE], pivot[MAX_STRAND_ORACLE];
    strand_oracle_rod_matrix( strand, dt * dt + damping * dt, matrix );
    for ( int i = 0; i < n; ++i )
    {
        double* row = strand->factor[i];
        const double a1 = i > 0 ? matrix[i * n + i - 1] : 0.0, a2 = i > 1 ? matrix[i * n + i - 2] : 0.0;
        const double* before = i > 0 ? strand->factor[i - 1] : row;
        const double* before2 = i > 1 ? strand->factor[i - 2] : row;
        row[2] = i > 1 ? a2 * before2[0] : 0.0;
        row[1] = i > 0 ? ( a1 - ( i > 1 ? row[2] * pivot[i - 2] * before[1] : 0.0 ) ) * before[0] : 0.0;
        pivot[i] = matrix[i * n + i] - ( i > 0 ? row[1] * row[1] * pivot[i - 1] : 0.0 ) -
                   ( i > 1 ? row[2] * row[2] * pivot[i - 2] : 0.0 );
        row[0] = strand->weight[i] > 0.0 && pivot[i] > 0.0 ? 1.0 / pivot[i] : 0.0;
    }
}

// ---- twist ----

static double out_of_balance( const rod_vertex* v, int s )
{
    return v[s].moment - v[s + 1].moment + 0.5 * ( v[s].load + v[s + 1].load );
}

// One Newton step for the turns of all segments about themselves: elimination from the root, substitution from the
// tip.
static void solve_turns( const strand_oracle* strand, const rod_vertex* v, double* turn )
{
    double inverse[MAX_STRAND_ORACLE], off[MAX_STRAND_ORACLE];
    const int segments = strand->count - 1;
    if ( strand->closed )
    {
        rod_closed_turns( strand, v, turn );
        return;
    }
    for ( int s = 0; s < segments; ++s )
    {
        const double own = strand->twist_stiffness[s], behind = strand->twist_stiffness[s + 1];
        const double diagonal = own + v[s].slope + behind + v[s + 1].slope;
        double pivot = diagonal, right = -out_of_balance( v, s );
        off[s] = v[s].slope - own; // to the segment before
        if ( s > 0 )
        {
            pivot -= off[s] * off[s] * inverse[s - 1];
            right -= off[s] * turn[s - 1];
        }
        inverse[s] = pivot > 1e-12 * diagonal && pivot > 1e-30 ? 1.0 / pivot : 0.0;
        turn[s] = right * inverse[s];
    }
    for ( int s = segments - 2; s >= 0; --s )
    {
        turn[s] -= off[s + 1] * inverse[s] * turn[s + 1];
    }
}

static void balance_twist( strand_oracle* strand, rod_vertex* v )
{
    double turn[MAX_STRAND_ORACLE];
    bool is_balanced = true;
    solve_turns( strand, v, turn );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        is_balanced = is_balanced && fabs( turn[s] ) <= 1.0;
    }
    turn[strand->count - 1] = 0.0; // of a tip
    const double end = strand->closed ? fmax( -1.0, fmin( 1.0, turn[strand->count - 2] ) ) : 0.0;
    for ( int s = 0; s < rod_bending_count( strand ); ++s )
    {
        turn[s] = fmax( -1.0, fmin( 1.0, turn[s] ) );
        const strand_oracle_quaternion about_itself = { 0.0, 0.0, 0.5 * turn[s], 1.0 };
        strand->frame[s] =
            quaternion_normalised( strand_oracle_product( strand->frame[s], about_itself ), strand->frame[s] );
        const double before = s > 0 ? turn[s - 1] : end;
        const double angle = 0.5 * ( before + turn[s] ), shorter = 1.0 / sqrt( 1.0 + angle * angle );
        v[s].soft = double3_scale( shorter, double3_add_scaled( v[s].soft, angle, v[s].edge ) );
        v[s].across = shorter * ( v[s].across + angle * v[s].along );
        v[s].rest = double3_add_scaled( v[s].rest, 0.5 * ( before + turn[s] ), v[s].turned );
        v[s].moment += strand->twist_stiffness[s] * ( turn[s] - before );
        v[s].moment = is_balanced ? v[s].moment : 0.0; // the limit left the rest of it over
        v[s].load += 2.0 * ( before + turn[s] ) * v[s].slope;
    }
}

// ---- a substep ----

// Along the segments at `place`.
static void pull( strand_oracle* strand, const double3* place, double dt )
{
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        strand->tension[s] = fmax( -strand->max_tension[s], fmin( strand->max_tension[s], strand->tension[s] ) );
    }
    for ( int i = 0; i < strand->count; ++i )
    {
        double3 force = rod_none;
        if ( i + 1 < strand->count )
        {
            force = double3_add_scaled( force, strand->tension[i], rod_tangent( strand, place, i ) );
        }
        if ( i > 0 || strand->closed )
        {
            const int before = i > 0 ? i - 1 : strand->count - 2;
            force = double3_add_scaled( force, -strand->tension[before], rod_tangent( strand, place, before ) );
        }
        strand->position[i] = double3_add_scaled( strand->position[i], dt * dt * strand->weight[i], force );
    }
}

// K (p* - p): the change of the bending at each vertex since the start of the substep. The clamp counts as resting.
static void rate_gradient( const strand_oracle* strand, const rod_vertex* v, double3* gradient )
{
    double3 way[MAX_STRAND_ORACLE];
    for ( int i = 0; i < strand->count; ++i )
    {
        way[i] = double3_sub( strand->position[i], strand->previous[i] );
        gradient[i] = rod_none;
    }
    if ( strand->closed )
    {
        rod_closed_rate( strand, way, gradient );
        return;
    }
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        double c[3];
        coefficients( strand, i, c );
        const int end = i + 1 < strand->count ? 3 : 2;
        double3 change = double3_scale( c[1], way[i] );
        change = end == 3 ? double3_add_scaled( change, c[2], way[i + 1] ) : change;
        change = i > 0 ? double3_add_scaled( change, c[0], way[i - 1] ) : change;
        change = double3_add_scaled( change, -double3_dot( change, v[i].soft ), v[i].soft );
        for ( int a = i > 0 ? 0 : 1; a < end; ++a )
        {
            gradient[i - 1 + a] = double3_add_scaled( gradient[i - 1 + a], strand->stiffness[i] * c[a], change );
        }
    }
}

static void solve_and_move( strand_oracle* strand, double3* x )
{
    const int n = strand->count;
    for ( int i = 0; i < n; ++i )
    {
        x[i] = i > 0 ? double3_add_scaled( x[i], -strand->factor[i][1], x[i - 1] ) : x[i];
        x[i] = i > 1 ? double3_add_scaled( x[i], -strand->factor[i][2], x[i - 2] ) : x[i];
    }
    for ( int i = n - 1; i >= 0; --i )
    {
        x[i] = double3_scale( strand->factor[i][0], x[i] );
        x[i] = i + 1 < n ? double3_add_scaled( x[i], -strand->factor[i + 1][1], x[i + 1] ) : x[i];
        x[i] = i + 2 < n ? double3_add_scaled( x[i], -strand->factor[i + 2][2], x[i + 2] ) : x[i];
        strand->position[i] = double3_add( strand->position[i], x[i] );
    }
}

// Frames are carried to the segments at `place`, where twist is measured and balanced. Bending is evaluated at p*,
// because only that is solved for.
static void measure_rod( strand_oracle* strand, const double3* place, rod_vertex* v )
{
    for ( int s = 0; s + 1 < strand->count && strand->framed; ++s )
    {
        strand->frame[s] = strand_oracle_carried( strand->frame[s], double3_sub( place[s + 1], place[s] ) );
    }
    rod_measure_all( strand, place, v );
    if ( strand->framed )
    {
        balance_twist( strand, v );
    }
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        v[i].bend =
            double3_sub( rod_tangent( strand, strand->position, i ), rod_tangent( strand, strand->position, i - 1 ) );
    }
}

void strand_oracle_rod( strand_oracle* strand, double damping, double dt, const double3* acceleration )
{
    rod_vertex v[MAX_STRAND_ORACLE];
    double3 place[MAX_STRAND_ORACLE], right[MAX_STRAND_ORACLE], rate[MAX_STRAND_ORACLE];
    if ( strand->count < 2 )
    {
        return;
    }
    for ( int i = 0; i < strand->count; ++i )
    {
        const bool gained = acceleration != NULL && strand->weight[i] > 0.0;
        place[i] = gained ? double3_add_scaled( strand->position[i], -dt * dt, *acceleration ) : strand->position[i];
    }
    pull( strand, place, dt );
    strand->position[strand->count - 1] = strand->position[strand->closed ? 0 : strand->count - 1];
    measure_rod( strand, acceleration != NULL ? place : strand->position, v );
    rod_gradient_of( strand, v, right );
    rate_gradient( strand, v, rate );
    for ( int i = 0; i < strand->count; ++i )
    {
        right[i] = double3_add_scaled( double3_scale( -dt * dt, right[i] ), -damping * dt, rate[i] );
    }
    if ( strand->closed )
    {
        strand_oracle_closed_move( strand, dt * dt + damping * dt, right );
        return;
    }
    solve_and_move( strand, right );
}
