#include "strand_oracle.h"

#include "strand_oracle_rod.h"

#include <stddef.h>
#include <string.h>

// ---- closed rods ----

// Closed strands: systems around the loop, written down entry by entry and solved dense.

// Solve a dense system by elimination with row pivoting. @param matrix [n][n] by rows, destroyed
// @param right [n][columns], replaced by the solution
static void strand_oracle_solve( int n, double* matrix, int columns, double* right )
{
    for ( int k = 0; k < n; ++k )
    {
        int best = k;
        for ( int i = k + 1; i < n; ++i )
        {
            best = fabs( matrix[i * n + k] ) > fabs( matrix[best * n + k] ) ? i : best;
        }
        for ( int j = 0; j < n; ++j )
        {
            const double swapped = matrix[k * n + j];
            matrix[k * n + j] = matrix[best * n + j];
            matrix[best * n + j] = swapped;
        }
        for ( int j = 0; j < columns; ++j )
        {
            const double swapped = right[k * columns + j];
            right[k * columns + j] = right[best * columns + j];
            right[best * columns + j] = swapped;
        }
        for ( int i = k + 1; i < n; ++i )
        {
            const double ratio = matrix[i * n + k] / matrix[k * n + k];
            for ( int j = k; j < n; ++j )
            {
                matrix[i * n + j] -= ratio * matrix[k * n + j];
            }
            for ( int j = 0; j < columns; ++j )
            {
                right[i * columns + j] -= ratio * right[k * columns + j];
            }
        }
    }
    for ( int k = n - 1; k >= 0; --k )
    {
        for ( int c = 0; c < columns; ++c )
        {
            for ( int j = k + 1; j < n; ++j )
            {
                right[k * columns + c] -= matrix[k * n + j] * right[j * columns + c];
            }
            right[k * columns + c] /= matrix[k * n + k];
        }
    }
}

// A Newton pass of lengths around a closed strand, dense.
static void strand_oracle_closed_pass( strand_oracle* strand, double dt )
{
    const int n = strand->count - 1;
    double matrix[MAX_STRAND_ORACLE * MAX_STRAND_ORACLE] = { 0.0 }, lambda[MAX_STRAND_ORACLE];
    double3 e[MAX_STRAND_ORACLE];
    for ( int s = 0; s < n; ++s )
    {
        e[s] = double3_sub( strand->position[( s + 1 ) % n], strand->position[s] );
        lambda[s] = -0.5 * ( double3_dot( e[s], e[s] ) - strand->length[s] * strand->length[s] );
    }
    for ( int s = 0; s < n; ++s )
    {
        const int next = ( s + 1 ) % n;
        const double off = -strand->weight[next] * double3_dot( e[s], e[next] );
        matrix[s * n + s] +=
            ( strand->weight[s] + strand->weight[next] ) * double3_dot( e[s], e[s] ) * strand->held_diagonal;
        matrix[s * n + next] += off;
        matrix[next * n + s] += off;
    }
    strand_oracle_solve( n, matrix, 1, lambda );
    for ( int s = 0; s < n; ++s )
    {
        const int next = ( s + 1 ) % n;
        strand->tension[s] -= lambda[s] * double3_length( e[s] ) / ( dt * dt );
        strand->position[s] = double3_add_scaled( strand->position[s], -strand->weight[s] * lambda[s], e[s] );
        strand->position[next] = double3_add_scaled( strand->position[next], strand->weight[next] * lambda[s], e[s] );
    }
    strand->position[n] = strand->position[0];
}

void strand_oracle_close( strand_oracle* strand, double angle )
{
    const int n = strand->count - 1;
    double whole = 0.0;
    strand->closed = strand->framed = true;
    strand->held_diagonal = 1.0 + 1e-5;
    strand->weight[0] = strand->weight[n] = 1.0 / ( strand->mass[0] + strand->mass[n] );
    strand->mass[0] = strand->mass[n] = strand->mass[0] + strand->mass[n];
    for ( int s = 0; s < n; ++s )
    {
        whole += strand->length[s];
    }
    strand->stiffness[0] *= strand->length[0] / ( strand->length[0] + strand->length[n - 1] ); // L_0 was half of l_0
    strand->twist_stiffness[0] *= strand->length[0] / ( strand->length[0] + strand->length[n - 1] );
    const double carried = strand_oracle_twist( strand, 0 );
    for ( int i = 0; i < n; ++i )
    {
        const double reach = 0.5 * ( strand->length[i] + strand->length[( i + n - 1 ) % n] );
        strand->rest_twist[i] = ( i > 0 ? 0.0 : carried ) - angle * reach / whole;
    }
}

void strand_oracle_closed_move( strand_oracle* strand, double scale, double3* right )
{
    const int n = strand->count - 1;
    double matrix[MAX_STRAND_ORACLE * MAX_STRAND_ORACLE] = { 0.0 }, x[3 * MAX_STRAND_ORACLE];
    for ( int i = 0; i < n; ++i )
    {
        const int at[3] = { ( i + n - 1 ) % n, i, ( i + 1 ) % n };
        const double before = 1.0 / strand->length[at[0]], behind = 1.0 / strand->length[i];
        const double c[3] = { before, -before - behind, behind };
        for ( int a = 0; a < 3; ++a )
        {
            for ( int b = 0; b < 3; ++b )
            {
                matrix[at[a] * n + at[b]] += scale * strand->stiffness[i] * c[a] * c[b];
            }
        }
    }
    for ( int i = 0; i < n; ++i )
    {
        const bool is_held = strand->weight[i] <= 0.0;
        matrix[i * n + i] += is_held ? 0.0 : 1.0 / strand->weight[i];
        for ( int j = 0; j < n && is_held; ++j )
        {
            matrix[i * n + j] = matrix[j * n + i] = i == j ? 1.0 : 0.0;
        }
        x[3 * i] = is_held ? 0.0 : right[i].x;
        x[3 * i + 1] = is_held ? 0.0 : right[i].y;
        x[3 * i + 2] = is_held ? 0.0 : right[i].z;
    }
    strand_oracle_solve( n, matrix, 3, x );
    for ( int i = 0; i < n; ++i )
    {
        strand->position[i] =
            double3_add( strand->position[i], double3_make( x[3 * i], x[3 * i + 1], x[3 * i + 2] ) );
    }
    strand->position[n] = strand->position[0];
}

void rod_closed_turns( const strand_oracle* strand, const rod_vertex* v, double* turn )
{
    const int n = strand->count - 1;
    double matrix[MAX_STRAND_ORACLE * MAX_STRAND_ORACLE] = { 0.0 };
    for ( int s = 0; s < n; ++s )
    {
        const int next = ( s + 1 ) % n, before = ( s + n - 1 ) % n;
        const double own = strand->twist_stiffness[s], behind = strand->twist_stiffness[next];
        matrix[s * n + s] += ( own + v[s].slope + behind + v[next].slope ) * ( 1.0 + 1e-5 );
        matrix[s * n + before] += v[s].slope - own;
        matrix[s * n + next] += v[next].slope - behind;
        turn[s] = -( v[s].moment - v[next].moment + 0.5 * ( v[s].load + v[next].load ) );
    }
    strand_oracle_solve( n, matrix, 1, turn );
}

void rod_closed_rate( const strand_oracle* strand, const double3* way, double3* gradient )
{
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        const int n = strand->count - 1, at[3] = { ( i + n - 1 ) % n, i, ( i + 1 ) % n };
        const double a = 1.0 / strand->length[at[0]], b = 1.0 / strand->length[i], c[3] = { a, -a - b, b };
        double3 change = rod_none;
        for ( int k = 0; k < 3; ++k )
        {
            change = double3_add_scaled( change, c[k], way[at[k]] );
        }
        for ( int k = 0; k < 3; ++k )
        {
            gradient[at[k]] = double3_add_scaled( gradient[at[k]], strand->stiffness[i] * c[k], change );
        }
    }
}

// ---- frames ----

// Rotations and transported frames.

strand_oracle_quaternion strand_oracle_product( strand_oracle_quaternion a, strand_oracle_quaternion b )
{
    const double3 u = { a.x, a.y, a.z }, v = { b.x, b.y, b.z };
    const double3 sum = double3_add_scaled( double3_add_scaled( double3_cross( u, v ), a.w, v ), b.w, u );
    return ( strand_oracle_quaternion ){ sum.x, sum.y, sum.z, a.w * b.w - double3_dot( u, v ) };
}

double3 strand_oracle_turned( strand_oracle_quaternion q, double3 v )
{
    const double3 u = { q.x, q.y, q.z };
    const double3 across = double3_scale( 2.0, double3_cross( u, v ) );
    return double3_add( double3_add_scaled( v, q.w, across ), double3_cross( u, across ) );
}

// The smallest rotation that takes one unit vector to another. Opposite vectors turn about an axis across the first,
// closest to the coordinate axis along which the first is shortest.
static strand_oracle_quaternion strand_oracle_smallest( double3 from, double3 to )
{
    const strand_oracle_quaternion none = { 0.0, 0.0, 0.0, 1.0 };
    const double3 axis = double3_cross( from, to );
    const double cosine = double3_dot( from, to );
    if ( 1.0 + cosine > 1e-12 )
    {
        return quaternion_normalised( ( strand_oracle_quaternion ){ axis.x, axis.y, axis.z, 1.0 + cosine }, none );
    }
    const bool min_x_is = fabs( from.x ) <= fabs( from.y ) && fabs( from.x ) <= fabs( from.z );
    const bool min_y_is = fabs( from.y ) <= fabs( from.z );
    const double3 across =
        double3_make( min_x_is ? 1.0 : 0.0, !min_x_is && min_y_is ? 1.0 : 0.0, !min_x_is && !min_y_is ? 1.0 : 0.0 );
    const double3 turn = double3_add_scaled( across, -double3_dot( across, from ), from );
    return quaternion_normalised( ( strand_oracle_quaternion ){ turn.x, turn.y, turn.z, 0.0 }, none );
}

strand_oracle_quaternion strand_oracle_carried( strand_oracle_quaternion frame, double3 e )
{
    const double length = double3_length( e );
    if ( !( length > 1e-15 ) )
    {
        return frame;
    }
    const double3 z = strand_oracle_turned( frame, rod_z );
    const strand_oracle_quaternion swing = strand_oracle_smallest( z, double3_scale( 1.0 / length, e ) );
    return quaternion_normalised( strand_oracle_product( swing, frame ), frame );
}

// ---- strands ----

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

// Largest |l/l_0 - 1| of the segments.
static double strand_oracle_strain( const strand_oracle* strand )
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
