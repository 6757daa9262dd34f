// Rods: stiffness, the matrix and its factors, twist in equilibrium, and a substep.
#include "strand_oracle_rod.h"

#include <string.h>

// ---- rest ----

// Shapes of rods at rest: as laid, straight, and in balance with gravity.

// Frames carried along the present shape from the clamp; twist is 0 everywhere.
static void lay_frames( strand_oracle* strand )
{
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_sub( strand->position[s + 1], strand->position[s] );
        strand->frame[s] = strand_oracle_carried( rod_frame_before( strand, s ), e );
        strand->rest_twist[s] = 0.0;
    }
    if ( strand->guided ) // held as it is
    {
        strand->frame[strand->count - 1] = strand->frame[strand->count - 2];
        strand->rest_twist[strand->count - 1] = 0.0;
        strand->rest[strand->count - 1] = rod_none;
    }
    strand->framed = true;
}

static double3 into_middle( const strand_oracle* strand, int i, double3 k )
{
    return strand_oracle_turned(
        quaternion_conjugate( rod_middle_frame( rod_frame_before( strand, i ), strand->frame[i] ) ), k );
}

void strand_oracle_rest_shape( strand_oracle* strand )
{
    lay_frames( strand );
    for ( int i = 0; i + 1 < strand->count; ++i )
    {
        strand->rest[i] = into_middle( strand, i, rod_measure( strand, strand->position, i ).bend );
    }
}

void strand_oracle_rest_straight( strand_oracle* strand )
{
    lay_frames( strand );
    memset( strand->rest, 0, sizeof( strand->rest ) );
    strand->framed = strand->guided || strand->flatness > 0.0;
}

// Values that the recursion from the tip passes to the previous segment.
typedef struct hanging
{
    double3 weight;       // N, W_s
    double3 moment;       // M_{s+1}
    double twist, load;   // T_{s+1}, b_{s+1}
    double3 twist_moment; // (T_{s+1} - r b_{s+1}) kb_{s+1}
    double3 turn;         // rad, sum of M / (EI / L) from the tip
    double largest_turn;  // rad
} hanging;

// With u = bend x z, b_s = M_s . u. M_s = A - l alpha t_s - (T_s + r b_s) kb_s / 2 and t_s . u = 0 make T_s and b_s
// linear equations.
static void balance_vertex( strand_oracle* strand, int s, hanging* h )
{
    const rod_vertex v = rod_measure( strand, strand->position, s );
    const double l = strand->length[s];
    const double3 t = rod_tangent( strand, strand->position, s );
    const double3 z =
        strand_oracle_turned( rod_middle_frame( rod_frame_before( strand, s ), strand->frame[s] ), rod_z );
    const double3 u = double3_cross( v.bend, z );
    double3 m = double3_add_scaled( double3_add_scaled( h->moment, l, h->weight ), -0.5, h->twist_moment );
    const double across = double3_dot( m, u ), along = double3_dot( v.kb, u ), own = 1.0 + 0.5 * v.ratio * along;
    double twist = 0.0;
    if ( strand->twist_stiffness[s] > 0.0 )
    {
        twist = h->twist - 0.5 * ( across / own + h->load );
        twist /= 1.0 - 0.25 * along / own;
    }
    const double load = ( across - 0.5 * twist * along ) / own;
    h->twist_moment = double3_scale( twist - v.ratio * load, v.kb );
    m = double3_add_scaled( m, -0.5 * ( twist + v.ratio * load ), v.kb );
    const double lean = double3_dot( t, z );
    const double alpha = lean > 1e-12 ? double3_dot( m, z ) / ( l * lean ) : 0.0;
    m = double3_add_scaled( m, -l * alpha, t );
    h->moment = m;
    h->twist = twist;
    h->load = double3_dot( m, u );

    const bool bends = strand->stiffness[s] > 0.0;
    // C_i of an elliptic section under M_i
    const double3 axis =
        strand_oracle_turned( rod_middle_frame( rod_frame_before( strand, s ), strand->frame[s] ), rod_x );
    const double flat = strand->flatness * strand->flatness;
    m = double3_add_scaled( m, flat / ( 1.0 - flat ) * double3_dot( m, axis ), axis );
    h->turn = bends ? double3_add_scaled( h->turn, 1.0 / strand->stiffness[s], m ) : h->turn;
    h->largest_turn = fmax( h->largest_turn, double3_length( h->turn ) );
    const double3 k = bends ? double3_add_scaled( v.bend, -1.0 / strand->stiffness[s], m ) : v.bend;
    strand->rest[s] = into_middle( strand, s, k );
    strand->rest_twist[s] = twist != 0.0 ? -2.0 * atan( 0.5 * twist / strand->twist_stiffness[s] ) : 0.0;
    strand->tension[s] = alpha;
}

// @return rad, the largest turn of the rest shape against the load between the tip and a vertex
static double balance( strand_oracle* strand, double3 gravity )
{
    hanging h = { .twist = 0.0 };
    lay_frames( strand );
    for ( int s = strand->count - 2; s >= 0; --s )
    {
        const bool is_held = strand->weight[s + 1] <= 0.0;
        h.weight = is_held ? rod_none : double3_add_scaled( h.weight, strand->mass[s + 1], gravity );
        balance_vertex( strand, s, &h );
    }
    strand->tension[strand->count - 1] = 0.0;
    return h.largest_turn;
}

double strand_oracle_balance_stably( strand_oracle* strand, double3 gravity, double max_turn )
{
    const double turn = balance( strand, gravity );
    const double fraction = turn > max_turn ? max_turn / turn : 1.0;
    if ( fraction < 1.0 )
    {
        balance( strand, double3_scale( fraction, gravity ) );
    }
    return fraction;
}

// ---- vertices ----

// Bending and twist at a vertex of a rod, its energy and gradient.

strand_oracle_quaternion rod_frame_before( const strand_oracle* strand, int i )
{
    const int before = i > 0 || strand->closed == false ? i - 1 : strand->count - 2;
    return before >= 0 ? strand->frame[before] : strand_oracle_product( strand->turn, strand->clamp );
}

double3 rod_tangent( const strand_oracle* strand, const double3* p, int s )
{
    s = s < 0 && strand->closed ? strand->count - 2 : s;
    if ( s < 0 )
    {
        return strand_oracle_turned( rod_frame_before( strand, 0 ), rod_z );
    }
    if ( s + 1 == strand->count )
    {
        return strand_oracle_turned( strand->frame[s], rod_z );
    }
    return double3_scale( 1.0 / strand->length[s], double3_sub( p[s + 1], p[s] ) );
}

static double3 unit_tangent( const strand_oracle* strand, const double3* p, int s )
{
    const double3 t = rod_tangent( strand, p, s );
    const double length = double3_length( t );
    s = s < 0 && strand->closed ? strand->count - 2 : s;
    return length > 1e-15 ? double3_scale( 1.0 / length, t ) : strand_oracle_turned( strand->frame[s], rod_z );
}

strand_oracle_quaternion rod_middle_frame( strand_oracle_quaternion a, strand_oracle_quaternion b )
{
    const double sign = quaternion_dot( a, b ) < 0.0 ? -1.0 : 1.0;
    const strand_oracle_quaternion sum = { a.x + sign * b.x, a.y + sign * b.y, a.z + sign * b.z, a.w + sign * b.w };
    return quaternion_normalised( sum, a );
}

// conj( q_{i-1} ) q_i, with the sign that makes it a small rotation.
static strand_oracle_quaternion relative_frame( strand_oracle_quaternion a, strand_oracle_quaternion b )
{
    const strand_oracle_quaternion r = strand_oracle_product( quaternion_conjugate( a ), b );
    return r.w < 0.0 ? ( strand_oracle_quaternion ){ -r.x, -r.y, -r.z, -r.w } : r;
}

static double curvature_denominator( double3 before, double3 behind )
{
    return fmax( 1.0 + double3_dot( before, behind ), 0.1 );
}

// w = f (2 - f): 1 up to a fold of a quarter of that at rest, and falling where the vertex folds further.
static void fade( const strand_oracle* strand, int i, rod_vertex* v )
{
    const double at_rest = 2.0 - 0.5 * double3_dot( strand->rest[i], strand->rest[i] );
    const double begin = 0.25 * fmax( 0.2, fmin( 1.0, at_rest ) );
    const double f = fmax( 0.1, fmin( 1.0, ( 1.0 + double3_dot( v->before, v->behind ) ) / begin ) );
    v->share = f * ( 2.0 - f );
    v->unfolding = 2.0 * ( 1.0 - f ) / begin;
}

rod_vertex rod_measure( const strand_oracle* strand, const double3* p, int i )
{
    rod_vertex v = { .bend = double3_sub( rod_tangent( strand, p, i ), rod_tangent( strand, p, i - 1 ) ) };
    if ( strand->framed == false )
    {
        return v;
    }
    const strand_oracle_quaternion a = rod_frame_before( strand, i ), b = strand->frame[i],
                                   middle = rod_middle_frame( a, b );
    const double3 before = unit_tangent( strand, p, i - 1 ), behind = unit_tangent( strand, p, i );
    v.before = before;
    v.behind = behind;
    fade( strand, i, &v );
    v.ratio = 0.5 * fabs( quaternion_dot( a, b ) ) / ( 1.0 + fabs( quaternion_dot( a, b ) ) );
    v.rest = double3_scale( v.share, strand_oracle_turned( middle, strand->rest[i] ) );
    v.turned = double3_cross( strand_oracle_turned( middle, rod_z ), v.rest );
    v.kb = double3_scale( 2.0 / curvature_denominator( before, behind ), double3_cross( before, behind ) );

    const strand_oracle_quaternion r = relative_frame( a, b );
    const double c = cos( 0.5 * strand->rest_twist[i] ), s = sin( 0.5 * strand->rest_twist[i] );
    const double z = r.z * c - r.w * s, w = r.w * c + r.z * s;
    v.twist = 2.0 * z / copysign( fmax( fabs( w ), 0.087 ), w );
    v.moment = v.share * strand->twist_stiffness[i] * v.twist;
    const double3 bend = double3_sub( behind, before );
    v.soft = double3_scale( strand->flatness * sqrt( v.share ), strand_oracle_turned( middle, rod_x ) );
    v.edge = double3_cross( strand_oracle_turned( middle, rod_z ), v.soft );
    v.across = double3_dot( double3_sub( bend, v.rest ), v.soft );
    v.along = double3_dot( bend, v.edge );
    v.load = -strand->stiffness[i] * ( double3_dot( bend, v.turned ) + v.across * v.along );
    const double slope = double3_dot( bend, v.rest ) + v.across * double3_dot( bend, v.soft ) - v.along * v.along;
    v.slope = 0.25 * strand->stiffness[i] * fmax( 0.0, slope );
    return v;
}

// A tip that is not guided neither bends nor twists.
static void rod_measure_all( const strand_oracle* strand, const double3* p, rod_vertex* v )
{
    v[strand->count - 1] = ( rod_vertex ){ .twist = 0.0 };
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        v[i] = rod_measure( strand, p, i );
    }
}

double strand_oracle_twist( const strand_oracle* strand, int vertex )
{
    const strand_oracle_quaternion r = relative_frame( rod_frame_before( strand, vertex ), strand->frame[vertex] );
    return 2.0 * atan2( r.z, r.w );
}

double strand_oracle_rod_energy( const strand_oracle* strand )
{
    double energy = 0.0;
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        const rod_vertex v = rod_measure( strand, strand->position, i );
        const double3 c = double3_sub( v.bend, v.rest );
        const double half = strand->framed ? 0.5 * ( strand_oracle_twist( strand, i ) - strand->rest_twist[i] ) : 0.0;
        const double across = double3_dot( c, v.soft );
        energy += 0.5 * strand->stiffness[i] * ( double3_dot( c, c ) - across * across );
        energy -= strand->framed ? 4.0 * v.share * strand->twist_stiffness[i] * log( fabs( cos( half ) ) ) : 0.0;
    }
    return energy;
}

// Twice what twist and rest curvature of a vertex add to the gradient by one of its segments, times its length:
// `side` is -1 before it and 1 behind it.
static double3 turning_of( const strand_oracle* strand, int i, const rod_vertex* v, double side )
{
    double3 sum = double3_scale( v->moment + side * v->ratio * v->load, v->kb );
    if ( v->unfolding > 0.0 )
    {
        const double3 bend = double3_sub( v->behind, v->before );
        double energy = strand->stiffness[i] * double3_dot( v->rest, double3_sub( v->rest, bend ) );
        energy += strand->stiffness[i] * v->across * ( double3_dot( v->rest, v->soft ) - 0.5 * v->across );
        energy += strand->twist_stiffness[i] > 0.0
                      ? 0.5 * v->moment * v->moment / ( v->share * strand->twist_stiffness[i] )
                      : 0.0;
        const double3 own = side < 0.0 ? v->before : v->behind, other = side < 0.0 ? v->behind : v->before;
        const double3 across = double3_add_scaled( other, -double3_dot( own, other ), own );
        sum = double3_add_scaled( sum, 2.0 * energy * v->unfolding / v->share, across );
    }
    return sum;
}

// M_i: bending against the part that an elliptic section leaves.
static double3 moment_of( const strand_oracle* strand, int i, const rod_vertex* v )
{
    const double3 c = double3_add_scaled( double3_sub( v->bend, v->rest ), -v->across, v->soft );
    return double3_scale( strand->stiffness[i], c );
}

// G_s = (M_s - M_{s+1} + (turning of s and of s + 1) / 2) / l_s by e_s; it pulls at both ends of the segment.
static void rod_gradient_of( const strand_oracle* strand, const rod_vertex* v, double3* gradient )
{
    gradient[0] = rod_none;
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const int next = strand->closed && s + 2 == strand->count ? 0 : s + 1;
        const rod_vertex *a = v + s, *b = v + next;
        const double3 ma = moment_of( strand, s, a ), mb = moment_of( strand, next, b );
        double3 turning = rod_none;
        if ( strand->framed )
        {
            turning = turning_of( strand, s, a, 1.0 );
            turning = next < rod_bending_count( strand ) ? double3_add( turning, turning_of( strand, next, b, -1.0 ) )
                                                         : turning;
        }
        const double3 sum = double3_add_scaled( double3_sub( ma, mb ), 0.5, turning );
        const double3 g = double3_scale( 1.0 / strand->length[s], sum );
        gradient[s] = double3_sub( gradient[s], g );
        gradient[s + 1] = g;
    }
    if ( strand->closed )
    {
        gradient[0] = double3_add( gradient[0], gradient[strand->count - 1] );
    }
}

void strand_oracle_rod_gradient( const strand_oracle* strand, double3* gradient )
{
    rod_vertex v[MAX_STRAND_ORACLE];
    rod_measure_all( strand, strand->position, v );
    rod_gradient_of( strand, v, gradient );
}

// ---- rods ----

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

// M + scale K, dense, [count][count] by rows; held vertices are rows and columns of zeros.
static void strand_oracle_rod_matrix( const strand_oracle* strand, double scale, double* matrix )
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
