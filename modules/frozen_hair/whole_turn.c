// How strands that another module moves are turned as a whole: the rotation that takes their roots at rest closest to where
// they are now, in the sense of least squares (Horn 1987, "Closed-form solution of absolute orientation using unit
// quaternions"). A single strand cannot tell how it is turned about itself, the roots of all on a head can.
#include "frozen_hair_state.h"

#include <math.h>
#include <string.h>

enum
{
    SWEEPS = 12, // of Jacobi's method, which converges quadratically: a 4 x 4 matrix takes six at most
};

typedef struct roots
{
    const wisp_strand_topology* t;
    const float *rest, *moved; // [row][3][16] m
} roots;

// @return false: the lane has no strand
static bool root_at( const roots* r, int lane, double rest[3], double moved[3] )
{
    const size_t at = (size_t)r->t->group_row[lane / WISP_LANES] * 3 * WISP_LANES + (size_t)( lane % WISP_LANES );
    for ( int k = 0; k < 3 && r->t->lane_count[lane] > 0; ++k )
    {
        rest[k] = (double)r->rest[at + (size_t)k * WISP_LANES];
        moved[k] = (double)r->moved[at + (size_t)k * WISP_LANES];
    }
    return r->t->lane_count[lane] > 0;
}

// Sums products of coordinates at rest and now, both from the mean root.
static void correlate( const roots* r, double sum[3][3] )
{
    const int lanes = r->t->group_count * WISP_LANES;
    double a[3], b[3], mean_a[3] = { 0 }, mean_b[3] = { 0 }, count = 0.0;
    for ( int lane = 0; lane < lanes; ++lane )
    {
        const bool is_there = root_at( r, lane, a, b );
        count += is_there;
        for ( int k = 0; k < 3 && is_there; ++k )
        {
            mean_a[k] += a[k];
            mean_b[k] += b[k];
        }
    }
    memset( sum, 0, 9 * sizeof( double ) );
    for ( int lane = 0; lane < lanes; ++lane )
    {
        const bool is_there = root_at( r, lane, a, b );
        for ( int k = 0; k < 9 && is_there; ++k )
        {
            sum[k / 3][k % 3] += ( a[k / 3] - mean_a[k / 3] / count ) * ( b[k % 3] - mean_b[k % 3] / count );
        }
    }
}

// Diagonalises a symmetric matrix by Jacobi rotations. @param v receives eigenvectors in its columns
static void diagonalise( double n[4][4], double v[4][4] )
{
    for ( int k = 0; k < 16; ++k )
    {
        v[k / 4][k % 4] = k / 4 == k % 4 ? 1.0 : 0.0;
    }
    for ( int k = 0; k < SWEEPS * 16; ++k )
    {
        const int p = k / 4 % 4, q = k % 4;
        if ( p >= q || n[p][q] == 0.0 )
        {
            continue;
        }
        const double theta = ( n[q][q] - n[p][p] ) / ( 2.0 * n[p][q] );
        const double t = ( theta < 0.0 ? -1.0 : 1.0 ) / ( fabs( theta ) + sqrt( theta * theta + 1.0 ) );
        const double c = 1.0 / sqrt( t * t + 1.0 ), s = t * c;
        for ( int i = 0; i < 4; ++i )
        {
            const double x = n[i][p], y = n[i][q], vx = v[i][p], vy = v[i][q];
            n[i][p] = c * x - s * y;
            n[i][q] = s * x + c * y;
            v[i][p] = c * vx - s * vy;
            v[i][q] = s * vx + c * vy;
        }
        for ( int i = 0; i < 4; ++i )
        {
            const double x = n[p][i], y = n[q][i];
            n[p][i] = c * x - s * y;
            n[q][i] = s * x + c * y;
        }
        n[p][q] = n[q][p] = 0.0;
    }
}

// Finds the best rotation. Where several are equally good, as with roots on a line, it is the smallest of them.
static void best_turn( double n[4][4], float turn[4] )
{
    double v[4][4], largest = -HUGE_VAL, scale = 0.0;
    diagonalise( n, v );
    for ( int k = 0; k < 4; ++k )
    {
        largest = fmax( largest, n[k][k] );
        scale = fmax( scale, fabs( n[k][k] ) );
    }

    // the projection of no rotation, or of half a turn about z, y or x, on the rotations that are equally good
    double q[4] = { 1.0, 0.0, 0.0, 0.0 }, length = 0.0;
    for ( int axis = 0; axis < 4 && length < 1e-6; ++axis )
    {
        const int from = ( 4 - axis ) % 4; // w, z, y, x
        memset( q, 0, sizeof( q ) );
        for ( int k = 0; k < 16; ++k )
        {
            const int column = k / 4, i = k % 4;
            q[i] += n[column][column] >= largest - 1e-9 * scale ? v[from][column] * v[i][column] : 0.0;
        }
        length = sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
    }
    turn[0] = (float)( q[1] / length );
    turn[1] = (float)( q[2] / length );
    turn[2] = (float)( q[3] / length );
    turn[3] = (float)( q[0] / length );
}

void frozen_find_turn( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    frozen_stroke* stroke = wisp_frame_column( frame, span->entity, state->stroke, 0 );
    const roots r = { wisp_frame_strands( frame, span->entity ),
                      wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 ),
                      wisp_frame_column( frame, span->entity, WISP_STRAND_POSED, 0 ) };
    if ( r.moved == NULL )
    {
        return;
    }
    double s[3][3];
    correlate( &r, s );
    double n[4][4] = {
        { s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0] },
        { s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2] },
        { s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1] },
        { s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1] },
    };
    best_turn( n, stroke->turn );
}
