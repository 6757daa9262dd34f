// The linear system of closed rods. In: lengths, masses, rigidity, length of a substep. Out: stiffness per vertex, and
// factors of M + dt^2 K for the kernel strand_rod.
//
// A ring of n vertices has n segments; the vertex of row n is that of row 0 again. M + (dt^2 + damping dt) K couples each
// vertex to two neighbours on either side, all around. Without the vertices 0 and 1 what is left, F, has two bands, as that
// of an open rod. With B its columns to those two, D the block of the two,
//
//   Z = F^-1 B,   S = D - B^T Z,   x_01 = S^-1 (r_01 - Z^T r),   x = F^-1 r - Z x_01
//
// Z is kept, and S^-1 in its rows 0 and 1. F is that of a rod that is clamped at both ends, S is as definite as the whole
// (Schur complement).
#include "closed_rods.h"

// A strand that is closed.
typedef struct ring
{
    const closed_factor_args* args;
    int row, lane;
    int n; // vertices and segments
} ring;

static int around( const ring* r, int i )
{
    return i < 0 ? i + r->n : i >= r->n ? i - r->n : i;
}

static double length_at( const ring* r, int s )
{
    return (double)r->args->rows->length[strands_scalar( r->row + around( r, s ), r->lane )];
}

// Return the mass of a vertex; 0 if it is pinned.
static double ring_mass_at( const ring* r, int i )
{
    const double w = (double)r->args->rows->weight[strands_scalar( r->row + around( r, i ), r->lane )];
    return w > 0.0 ? 1.0 / w : 0.0;
}

static wisp_vec3 direction_at( const ring* r, int s )
{
    const int row = r->row + around( r, s );
    const wisp_vec3 e = wisp_v3_sub( strands_get( r->args->rows->rest, row + 1, r->lane ),
                                     strands_get( r->args->rows->rest, row, r->lane ) );
    const float scale = 1.0f / (float)length_at( r, s );
    return ( wisp_vec3 ){ scale * e.x, scale * e.y, scale * e.z };
}

static double turn_at( const ring* r, int i )
{
    return (double)wisp_v3_length( wisp_v3_sub( direction_at( r, i ), direction_at( r, i - 1 ) ) );
}

static double ring_stiffness( const ring* r, int i )
{
    const strands_settings* settings = r->args->settings;
    double mass = 0.0, turn = 0.0;
    int masses = 0;
    for ( int k = i - 1; k <= i + 1; ++k )
    {
        const double m = ring_mass_at( r, k );
        mass += m;
        masses += m > 0.0 ? 1 : 0;
        turn = fmax( turn, turn_at( r, around( r, k ) ) );
    }
    const double step = r->args->dt * ( r->args->dt + (double)settings->bend_damping );
    const double before = length_at( r, i - 1 ), behind = length_at( r, i ), l = fmin( before, behind );
    const double bound = fmin( STRANDS_MAX_STIFFNESS, STRANDS_MAX_CURLED / fmax( turn * turn * turn * turn, 1e-12 ) );
    const double most = bound * ( masses > 0 ? mass / masses : 0.0 ) * l * l * l / step;
    return fmin( (double)settings->bend_rigidity, most ) / ( 0.5 * ( before + behind ) );
}

// Return the coefficient of vertex i in C_k: t_k - t_{k-1} over the vertices k - 1, k, k + 1.
static double coefficient( const ring* r, int k, int i )
{
    const double before = 1.0 / length_at( r, k - 1 ), behind = 1.0 / length_at( r, k );
    const int place = around( r, i - k + ( i < k ? r->n : 0 ) );
    return place == 0 ? -( before + behind ) : place == 1 ? behind : place == r->n - 1 ? before : 0.0;
}

// Return an entry of M + (dt^2 + damping dt) K; 0 in rows and columns of pinned vertices.
static double entry( const ring* r, int i, int j )
{
    const double step = r->args->dt * ( r->args->dt + (double)r->args->settings->bend_damping );
    double sum = i == j ? ring_mass_at( r, i ) : 0.0;
    if ( ring_mass_at( r, i ) == 0.0 || ring_mass_at( r, j ) == 0.0 )
    {
        return 0.0;
    }
    for ( int k = i - 1; k <= i + 1; ++k )
    {
        const int at = around( r, k );
        const double stiffness = (double)r->args->stiffness[strands_scalar( r->row + at, r->lane )];
        sum += step * stiffness * coefficient( r, at, i ) * coefficient( r, at, j );
    }
    return sum;
}

static void put_ring_factor( const ring* r, int i, double inverse, double first, double second )
{
    strands_put( r->args->factor, r->row + i, r->lane, ( wisp_vec3 ){ (float)inverse, (float)first, (float)second } );
}

static float* response_at( const ring* r, int i )
{
    return r->args->response + (size_t)( r->row + i ) * 2 * WISP_LANES + r->lane;
}

// A row of L D L^T, and of two right-hand sides.
typedef struct ring_band
{
    double pivot, first, second; // D(i), L(i, i-1), L(i, i-2)
    double right[2];
} ring_band;

// Factor F, and eliminate B.
static void factor_interior( const ring* r )
{
    const ring_band none = { .pivot = 1.0 };
    ring_band before = none, first = none;
    for ( int i = 2; i < r->n; ++i )
    {
        ring_band l = none;
        if ( ring_mass_at( r, i ) > 0.0 )
        {
            l.second = i > 3 ? entry( r, i, i - 2 ) / first.pivot : 0.0;
            l.first = i > 2 ? ( entry( r, i, i - 1 ) - l.second * first.pivot * before.first ) / before.pivot : 0.0;
            l.pivot = entry( r, i, i ) - l.first * l.first * before.pivot - l.second * l.second * first.pivot;
            for ( int b = 0; b < 2; ++b )
            {
                l.right[b] = entry( r, i, b ) - l.first * before.right[b] - l.second * first.right[b];
            }
            put_ring_factor( r, i, 1.0 / l.pivot, l.first, l.second );
        }
        else
        {
            put_ring_factor( r, i, 0.0, 0.0, 0.0 );
        }
        r->args->work[2 * i] = l.right[0] / l.pivot;
        r->args->work[2 * i + 1] = l.right[1] / l.pivot;
        first = before;
        before = l;
    }
}

// Substitute back: work is Z.
static void substitute_interior( const ring* r )
{
    double* z = r->args->work;
    for ( int i = r->n - 1; i >= 2; --i )
    {
        for ( int k = 1; k <= 2 && i + k < r->n; ++k )
        {
            const wisp_vec3 f = strands_get( r->args->factor, r->row + i + k, r->lane );
            const double l = (double)( k == 1 ? f.y : f.z );
            z[2 * i] -= l * z[2 * ( i + k )];
            z[2 * i + 1] -= l * z[2 * ( i + k ) + 1];
        }
        response_at( r, i )[0] = (float)z[2 * i];
        response_at( r, i )[WISP_LANES] = (float)z[2 * i + 1];
    }
}

// Invert S. A vertex that is pinned has no row in it.
static void factor_joint( const ring* r )
{
    double s[3] = { entry( r, 0, 0 ), entry( r, 0, 1 ), entry( r, 1, 1 ) };
    for ( int i = 2; i < r->n; ++i )
    {
        const double* z = r->args->work + 2 * (size_t)i;
        s[0] -= entry( r, i, 0 ) * z[0];
        s[1] -= entry( r, i, 0 ) * z[1];
        s[2] -= entry( r, i, 1 ) * z[1];
    }
    const bool moves[2] = { ring_mass_at( r, 0 ) > 0.0, ring_mass_at( r, 1 ) > 0.0 };
    double inverse[3] = { moves[0] ? 1.0 / s[0] : 0.0, 0.0, moves[1] ? 1.0 / s[2] : 0.0 };
    if ( moves[0] && moves[1] )
    {
        const double determinant = s[0] * s[2] - s[1] * s[1];
        inverse[0] = s[2] / determinant;
        inverse[1] = -s[1] / determinant;
        inverse[2] = s[0] / determinant;
    }
    for ( int i = 0; i < 2; ++i )
    {
        response_at( r, i )[0] = (float)inverse[i];
        response_at( r, i )[WISP_LANES] = (float)inverse[i + 1];
        put_ring_factor( r, i, 0.0, 0.0, 0.0 );
    }
    put_ring_factor( r, r->n, 0.0, 0.0, 0.0 );
}

void strands_factor_closed( const closed_factor_args* args, int row, int count, int lane )
{
    const ring r = { args, row, lane, count - 1 };
    for ( int i = 0; i < r.n; ++i )
    {
        args->stiffness[strands_scalar( row + i, lane )] = (float)ring_stiffness( &r, i );
    }
    args->stiffness[strands_scalar( row + r.n, lane )] = 0.0f;
    factor_interior( &r );
    substitute_interior( &r );
    factor_joint( &r );
}
