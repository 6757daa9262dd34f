// The linear system of rods: bending energy and its factors. In: lengths, masses, rigidity, length of a substep. Out:
// stiffness per vertex, clamps, and the factors of M + dt^2 K for the kernel strand_rod.
//
// Segment s runs from vertex s to s + 1, e_s = p_{s+1} - p_s, t_s = e_s / l_s with the rest length l_s. Vertex i
// bends with
//
//   E_i = EI / (2 L_i) |C_i|^2,   C_i = t_i - t_{i-1} - k_i,   L_i = (l_{i-1} + l_i) / 2
//
// |t_i - t_{i-1}| = 2 sin(angle / 2): the energy of a rod up to the fourth power of the angle. Segment -1 is the
// clamp, with the direction of growth and no position. Vertex 0 has L_0 = l_0 / 2: half of the first segment bends
// from the clamp itself. A hinged root has stiffness 0 there. While k_i stays, E is quadratic and x, y, z do not mix:
// K = B^T D B is the same for all three, and M + dt^2 K = L D L^T has two bands below the diagonal. Rows and columns
// of pinned vertices are zero. `bend_damping` beta adds beta K dp/dt, implicit as well: (M + (dt^2 + beta dt) K) x =
// -dt^2 dE/dp - beta dt K (p* - p), with the clamp at rest.
//
// EI / L_i is lowered, never raised, so that
//
//   dt^2 EI / (m l^3) <= 6e4                             single precision solves no stiffer system
//   dt^2 EI / (m l^3) |t_i - t_{i-1}|^4 <= 0.08          curled rods only
//
// The second is dt^2 EI curvature^4 / line density: the square of the substep times the frequency of a ring of that
// curvature. Frames turn one substep late, and above about 0.1 that is unstable. A hair of 80 um with curls of 1 cm
// needs 16 substeps of 1/60 s for its full stiffness, tighter curls more; with fewer substeps it is softer.

#include "strand_rows.h"
#include "strand_passes.h"

#include "wisp/module/sleep.h"
#include <float.h>

// ---- frames ----

// Frames of rods (after the discrete elastic rods of Bergou et al. 2008 and 2010). In: positions, clamps, rotations
// of roots. Out: a quaternion q_s per segment s, whose z axis is along the segment; q_{-1} is the clamp, the rotation
// of the root times its rest frame.
//
// In each substep the kernel strand_rod turns q_s by the smallest rotation that takes its z axis to the direction
// that the segment has without forces, p* - dt^2 g: parallel transport in time. At rest that is no rotation. Rest
// vectors, moments of twist and tension use the same positions; bending uses p*. The rest vector k_i is stored in the
// middle frame of vertex i, the normalised sum of q_{i-1} and q_i (with the sign that brings them together).
//
// The twist of vertex i is that of r = conj(q_{i-1}) q_i about z, m_i = 2 atan2(r_z, r_w), less its rest value. With
// c, s the cosine and sine of half the rest twist,
//
//   z' = r_z c - r_w s,  w' = r_w c + r_z s,  m_i - mrest_i ~ 2 z' / w',  T_i = GJ / L_i (m_i - mrest_i)
//
// The twist is quasi-static: to first order turning segment s about itself changes no energy,
//
//   T_s - T_{s+1} + (b_s + b_{s+1}) / 2 = 0,   b_i = -EI / L_i (t_i - t_{i-1}) . (z_i x k_i)
//
// with z_i the middle frame's z axis and T = b = 0 behind the last segment of a strand with a free tip. It is solved by one tridiagonal Newton
// step per substep, with EI / L_i max(0, (t_i - t_{i-1}) . k_i) / 4 for the second derivative of the bending in
// both segments and between them. A segment turns by a radian at most. A strand that reaches that is not in
// balance, and its T_i would be what the limit left over, so they are 0 in that substep.
//
// Twist and the turning of k_i with its frames act on the centre line: the gradient with respect to e_s is
//
//   G_s = (M_s - M_{s+1} + ((T_s + r_s b_s) kb_s + (T_{s+1} - r_{s+1} b_{s+1}) kb_{s+1}) / 2) / l_s
//   kb_i = 2 t_{i-1} x t_i / (1 + t_{i-1} . t_i)
//   r_i = tan(a_i / 4) / (2 tan(a_i / 2)) = c / (2 + 2 c),  c = cos(a_i / 2)
//
// with a_i the angle between t_{i-1} and t_i. A frame that is carried along with its segment turns about axes
// across it; the middle frame turns by the mean of its two, and by tan(a / 4) of their difference about the third
// axis. That gives r_i, exactly where vertices are not twisted (tests/oracle). All of it is the gradient of one
// energy. Without r_i forces of rest curvature do work on a closed path, and hair that is soft or not clamped
// whirls for ever.
//
// T_i, b_i and kb_i are angles, so they take unit directions, also of segments that are not at their length: links
// leave segments several times too long, and the product of two such lengths has no bound.
//
// An elliptic section bends across its flat side with EI and edgewise with EI' >= EI. Its x axis is across the flat side,
// and m_i is that of the middle frame (after Bergou et al. 2008, section 4.2, with diagonal B). With C_i = t_i - t_{i-1}
// - k_i and the stiffness EI' / L_i,
//
//   E_i = EI' / (2 L_i) (|C_i|^2 - (C_i . s_i)^2),   s_i = sqrt(1 - EI / EI') m_i
//   M_i = EI' / L_i (C_i - (C_i . s_i) s_i)
//   b_i = -EI' / L_i ((t_i - t_{i-1}) . (z_i x k_i) + (C_i . s_i) (t_i - t_{i-1}) . (z_i x s_i))
//
// and the second derivative of E_i by the rotation about z_i is EI' / L_i ((t_i - t_{i-1}) . k_i + (C_i . s_i) (t_i -
// t_{i-1}) . s_i - ((t_i - t_{i-1}) . (z_i x s_i))^2). All else is as for a circle, with b_i in place of its own. The
// implicit matrix has EI', which no direction exceeds, so that it stays one for x, y and z: equilibria are exact, but a
// mode of frequency w across the flat side is slowed as if its mass were larger by dt^2 w^2 (EI' / EI - 1).
//
// A tip whose direction is held has a frame behind the last segment, and vertex n bends and twists between that segment and
// this frame with L_n = l_{n-1} / 2. Its frame does not turn, and its twist is put in as that of a clamp is.
//
// Where a vertex folds back, k_i and twist have no direction: a small circle about that pose changes both by any
// amount. So E_i and the energy of twist have w k_i, sqrt(w) s_i and w GJ, w = f (2 - f). f falls from 1, where 1 + t_{i-1} .
// t_i is a quarter of what it is at rest (at 139 degrees for rest shapes that turn by less than 90), to 0 at 180
// degrees. The derivative of w acts on the centre line too.

// Return the smallest rotation from the z axis to a direction.
static wisp_quat strands_rotation_to( wisp_vec3 d )
{
    const double length = sqrt( (double)d.x * (double)d.x + (double)d.y * (double)d.y + (double)d.z * (double)d.z );
    if ( length == 0.0 || (double)d.z < -0.999999 * length )
    {
        return length == 0.0 ? ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f } : ( wisp_quat ){ 1.0f, 0.0f, 0.0f, 0.0f };
    }
    const wisp_quat q = { -d.y, d.x, 0.0f, (float)( length + (double)d.z ) };
    return wisp_transform_make( q, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

wisp_quat strands_transport_frame( wisp_quat q, wisp_vec3 e )
{
    if ( wisp_v3_length( e ) == 0.0f )
    {
        return q;
    }
    const wisp_quat transported = wisp_quat_multiply( q, strands_rotation_to( wisp_quat_inverse_rotate( q, e ) ) );
    return wisp_transform_make( transported, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

wisp_quat strands_twist_frame( wisp_quat q, double angle )
{
    const wisp_quat turn = { 0.0f, 0.0f, (float)sin( 0.5 * angle ), (float)cos( 0.5 * angle ) };
    return angle == 0.0 ? q : wisp_quat_multiply( q, turn );
}

double strands_natural_twist( const float* length, int row, int i, int count, int lane, double twist )
{
    const double before = i > 0 ? (double)length[strands_scalar( row + i - 1, lane )] : 0.0;
    const double behind = i + 1 < count ? (double)length[strands_scalar( row + i, lane )] : 0.0;
    return 0.5 * twist * ( before + behind );
}

void strands_make_frames_of_group( const wisp_strand_topology* t, const float* position, const float* clamp,
                                   const float* root, const float* length, float twist, float* frame, int group )
{
    const int first = t->group_row[group];
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        wisp_quat q =
            wisp_quat_multiply( strands_get_quat( root, group, lane ), strands_get_quat( clamp, group, lane ) );
        const int count = t->lane_count[group * WISP_LANES + lane];
        for ( int row = first; row < t->group_row[group + 1]; ++row )
        {
            if ( row - first + 1 < count )
            {
                const wisp_vec3 to = strands_get( position, row + 1, lane );
                q = strands_transport_frame( q, wisp_v3_sub( to, strands_get( position, row, lane ) ) );
                q = strands_twist_frame(
                    q, strands_natural_twist( length, first, row - first, count, lane, (double)twist ) );
            }
            strands_put_quat( frame, row, lane, q );
        }
    }
}

void strands_add_frames( const void* state, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                         wisp_line_list* list )
{
    const strands_state* s = state;
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    const float* position = wisp_world_rows( world, entity, WISP_STRAND_POSITION, 0 );
    const float* root = wisp_world_rows( world, entity, WISP_STRAND_ROOT, 1 );
    const float* clamp = wisp_world_rows( world, entity, s->clamp, 0 );
    const float* frame = wisp_world_rows( world, entity, s->curve, 0 );
    for ( int i = 0; kind == WISP_LINES_FRAMES && clamp != NULL && i < WISP_LANES * t->group_count; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES, first = t->group_row[group];
        for ( int k = 0; k + 1 < t->lane_count[i] && ( k == 0 || frame != NULL ); ++k )
        {
            const wisp_vec3 at = strands_get( position, first + k, lane );
            const float size =
                0.5f * wisp_v3_length( wisp_v3_sub( strands_get( position, first + k + 1, lane ), at ) );
            const wisp_quat q = frame != NULL ? strands_get_quat( frame, first + k, lane )
                                              : wisp_quat_multiply( strands_get_quat( root, group, lane ),
                                                                    strands_get_quat( clamp, group, lane ) );
            for ( int axis = 0; axis < 2; ++axis ) // the first one red, the second one green
            {
                const wisp_vec3 unit = wisp_v3( axis == 0 ? 1.0f : 0.0f, axis == 0 ? 0.0f : 1.0f, 0.0f );
                wisp_add_line( list, entity, at, wisp_v3_mul_add( at, size, wisp_quat_rotate( q, unit ) ), unit );
            }
        }
    }
}

// ---- closed rods ----

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

// Compute EI / L_i, the factors and the response of the joint of a strand.
// @param row its first @param count vertices, the last of which is the first
static void strands_factor_closed( const closed_factor_args* args, int row, int count, int lane )
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

// ---- factors ----

// Return the clamp: the direction of growth is that of the first segment with a length.
static wisp_quat clamp_of( const float* rest, int row, int count, int lane )
{
    for ( int i = 0; i + 1 < count; ++i )
    {
        const wisp_vec3 e = wisp_v3_sub( strands_get( rest, row + i + 1, lane ), strands_get( rest, row + i, lane ) );
        if ( wisp_v3_length( e ) > 0.0f )
        {
            return strands_rotation_to( e );
        }
    }
    return ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f };
}

// Turn a clamp about its growth so that its x axis is across the flat side of the section.
static wisp_quat turn_section( wisp_quat clamp, wisp_vec3 normal )
{
    const wisp_vec3 local = wisp_quat_inverse_rotate( clamp, normal );
    const double x = (double)local.x, y = (double)local.y;
    return x * x + y * y > 1e-12 * (double)( wisp_v3_length( local ) * wisp_v3_length( local ) )
               ? strands_twist_frame( clamp, atan2( y, x ) )
               : clamp;
}

// Bound the tension that a substep starts with. A strand that hangs still bears at most its weight, between two pins
// at most four times that. A body may push more tension into it, which carried into the next substep would throw the
// strand off the body.
static void cook_max_tension( const strands_rows* rows, double gravity, int row, int count, int lane, float* most )
{
    double whole = 0.0, behind = 0.0;
    bool is_held = false;
    for ( int i = 1; i < count; ++i )
    {
        const double w = (double)rows->weight[strands_scalar( row + i, lane )];
        whole += w > 0.0 ? 1.0 / w : 0.0;
        is_held = is_held || w == 0.0;
    }
    for ( int i = count - 1; i > 0; --i )
    {
        const double w = (double)rows->weight[strands_scalar( row + i, lane )];
        behind += w > 0.0 ? 1.0 / w : 0.0;
        most[strands_scalar( row + i - 1, lane )] = (float)( gravity * ( is_held ? 4.0 * whole : behind ) );
    }
}

void strands_cook_rods( wisp_world* world, wisp_entity strands, const strands_state* state )
{
    const strands_rows rows = strands_rows_of( world, strands );
    const strands_settings* settings = wisp_world_column( world, strands, state->settings, 0 );
    float* most = wisp_world_column( world, strands, state->rod, 3 );
    const wisp_strand_topology* t = rows.topology;
    float* inverse = wisp_world_column( world, strands, state->rod, 0 );
    float* clamp = wisp_world_column( world, strands, state->clamp, 0 );
    float* factored = wisp_world_column( world, strands, state->clamp, 1 );
    const strands_section* section = wisp_world_column( world, strands, state->section, 0 );
    if ( inverse == NULL )
    {
        return;
    }
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES; ++i )
    {
        inverse[i] = rows.length[i] > 0.0f ? 1.0f / rows.length[i] : 0.0f;
    }
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES;
        const wisp_quat q = clamp_of( rows.rest, t->group_row[group], t->lane_count[i], lane );
        strands_put_quat( clamp, group, lane, section != NULL ? turn_section( q, section->normal ) : q );
        cook_max_tension( &rows, (double)wisp_v3_length( settings->gravity ), t->group_row[group], t->lane_count[i],
                          lane, most );
        factored[group] = 0.0f;
    }
    // a curled rod starts with the tension of its balance, which is constant
    const bool has_balance =
        settings->rest != WISP_STRAND_REST_STRAIGHT && wisp_world_has( world, strands, state->curve );
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES && has_balance; ++i )
    {
        most[i] = FLT_MAX;
    }
}

void strands_refactor( wisp_world* world, wisp_entity strands, const strands_state* state, int lane )
{
    const strands_rows rows = strands_rows_of( world, strands );
    const strands_settings* settings = wisp_world_column( world, strands, state->settings, 0 );
    float* most = wisp_world_column( world, strands, state->rod, 3 );
    float* factored = wisp_world_column( world, strands, state->clamp, 1 );
    const bool has_balance =
        settings->rest != WISP_STRAND_REST_STRAIGHT && wisp_world_has( world, strands, state->curve );
    const int row = rows.topology->group_row[lane / WISP_LANES], count = rows.topology->lane_count[lane];
    if ( factored == NULL )
    {
        return;
    }
    factored[0] = 0.0f; // the pass looks at the first group and computes all
    cook_max_tension( &rows, (double)wisp_v3_length( settings->gravity ), row, count, lane % WISP_LANES, most );
    for ( int i = row; i < row + count && has_balance; ++i )
    {
        most[strands_scalar( i, lane % WISP_LANES )] = FLT_MAX;
    }
}

// ---- factors ----

// A row of L D L^T.
typedef struct band
{
    double pivot, first, second; // D(i), L(i, i-1), L(i, i-2)
} band;

typedef struct factor_args
{
    const strands_rows* rows;
    const strands_settings* settings;
    float *stiffness, *factor;
    double dt;           // s, of a substep, which stiffness must suit
    double step;         // s, of the implicit step of these factors
    bool curled;         // with rest curvature
    const int32_t* hold; // [group][16] wisp_strand_tip; null: tips are free
} factor_args;

// Rows of a strand.
typedef struct rod_strand
{
    int row, count, lane;
    bool is_held;   // its tip is
    bool is_guided; // the direction of the tip is held, so that it bends too
} rod_strand;

static int hold_of( const factor_args* args, int group, int lane )
{
    return args->hold != NULL ? args->hold[group * WISP_LANES + lane] : WISP_STRAND_TIP_FREE;
}

static rod_strand rows_of( const factor_args* args, int group, int lane )
{
    const wisp_strand_topology* t = args->rows->topology;
    const int hold = hold_of( args, group, lane );
    return ( rod_strand ){ .row = t->group_row[group],
                           .count = t->lane_count[group * WISP_LANES + lane],
                           .lane = lane,
                           .is_held = hold != WISP_STRAND_TIP_FREE,
                           .is_guided = ( hold & WISP_STRAND_TIP_GUIDED ) != 0 };
}

// Return the number of vertices from the root on that may bend.
static int bending_count( const rod_strand* strand )
{
    return strand->is_guided ? strand->count : strand->count - 1;
}

static double mass_at( const strands_rows* rows, int row, int lane )
{
    const double w = (double)rows->weight[strands_scalar( row, lane )];
    return w > 0.0 ? 1.0 / w : 0.0;
}

static double length_at_row( const strands_rows* rows, int row, int lane )
{
    return (double)rows->length[strands_scalar( row, lane )];
}

double strands_bend_length( const strands_rows* rows, int row, int i, int lane )
{
    const double behind = length_at_row( rows, row + i, lane );
    return 0.5 * ( ( i > 0 ? length_at_row( rows, row + i - 1, lane ) : 0.0 ) + behind );
}

// Return |t_i - t_{i-1}| of the rest shape; 0 at the ends.
static double turn_at_rest( const strands_rows* rows, int row, int i, int count, int lane )
{
    if ( i < 1 || i + 1 >= count )
    {
        return 0.0;
    }
    const wisp_vec3 a =
        wisp_v3_sub( strands_get( rows->rest, row + i, lane ), strands_get( rows->rest, row + i - 1, lane ) );
    const wisp_vec3 b =
        wisp_v3_sub( strands_get( rows->rest, row + i + 1, lane ), strands_get( rows->rest, row + i, lane ) );
    const float s = 1.0f / (float)length_at_row( rows, row + i - 1, lane ),
                t = 1.0f / (float)length_at_row( rows, row + i, lane );
    return (double)wisp_v3_length( ( wisp_vec3 ){ t * b.x - s * a.x, t * b.y - s * a.y, t * b.z - s * a.z } );
}

double strands_sharpest_turn( const strands_rows* rows, int row, int i, int count, int lane )
{
    double turn = 0.0;
    for ( int k = i - 1; k <= i + 1; ++k )
    {
        turn = fmax( turn, turn_at_rest( rows, row, k, count, lane ) );
    }
    return turn;
}

bool strands_is_curl( double turn )
{
    return turn * turn * turn * turn * STRANDS_MAX_STIFFNESS > STRANDS_MAX_CURLED;
}

// A straight rod that is held in a curled shape, as a loop is, needs the bound of curls too.
static double max_stiffness( const factor_args* args, const rod_strand* strand, int i )
{
    const int row = strand->row, count = strand->count, lane = strand->lane;
    const double turn =
        args->curled || strand->is_held ? strands_sharpest_turn( args->rows, row, i, count, lane ) : 0.0;
    return fmin( STRANDS_MAX_STIFFNESS, STRANDS_MAX_CURLED / fmax( turn * turn * turn * turn, 1e-12 ) );
}

// Return EI / L_i of a vertex, lowered to what can be solved.
static double stiffness_of( const factor_args* args, const rod_strand* strand, int i )
{
    const int row = strand->row, count = strand->count, lane = strand->lane;
    if ( i >= bending_count( strand ) || ( i == 0 && args->settings->clamped == 0 ) )
    {
        return 0.0;
    }
    const double own = i + 1 < count ? length_at_row( args->rows, row + i, lane ) : 0.0;
    const double before = i > 0 ? length_at_row( args->rows, row + i - 1, lane ) : own;
    const double behind = i + 1 < count ? own : before;
    double mass = 0.0;
    int masses = 0;
    for ( int k = i > 0 ? i - 1 : 0; k <= i + 1 && k < count; ++k )
    {
        const double m = mass_at( args->rows, row + k, lane );
        mass += m;
        masses += m > 0.0 ? 1 : 0;
    }
    const double step = args->dt * ( args->dt + (double)args->settings->bend_damping );
    const double l = fmin( before, behind ), mean = masses > 0 ? mass / masses : 0.0;
    const double most = max_stiffness( args, strand, i ) * mean * l * l * l / step;
    const double reach = strands_bend_length( args->rows, row, i, lane );
    return reach > 0.0 ? fmin( (double)args->settings->bend_rigidity, most ) / reach : 0.0;
}

// Return the entries (i, i), (i, i-1), (i, i-2) of M + (dt^2 + damping dt) K. Vertex k bends with coefficients c over
// k-1, k, k+1.
static band row_of_system( const factor_args* args, const rod_strand* strand, int i )
{
    const int row = strand->row, count = strand->count, lane = strand->lane;
    const double step = args->step * ( args->step + (double)args->settings->bend_damping );
    band out = { mass_at( args->rows, row + i, lane ), 0.0, 0.0 };
    for ( int k = i > 0 ? i - 1 : 0; k <= i + 1 && k < bending_count( strand ); ++k )
    {
        const double stiffness = step * (double)args->stiffness[strands_scalar( row + k, lane )];
        const double behind = k + 1 < count ? 1.0 / length_at_row( args->rows, row + k, lane ) : 0.0;
        const double before = k > 0 ? 1.0 / length_at_row( args->rows, row + k - 1, lane ) : 0.0;
        const double c[3] = { before, -( before + behind ), behind }; // of k-1, k, k+1
        const int own = i - k + 1;
        out.pivot += stiffness * c[own] * c[own];
        out.first += own > 0 ? stiffness * c[own] * c[own - 1] : 0.0;
        out.second += own > 1 ? stiffness * c[own] * c[own - 2] : 0.0;
    }
    const bool pinned_before = i < 1 || mass_at( args->rows, row + i - 1, lane ) == 0.0;
    const bool pinned_first = i < 2 || mass_at( args->rows, row + i - 2, lane ) == 0.0;
    out.first = pinned_before ? 0.0 : out.first;
    out.second = pinned_first ? 0.0 : out.second;
    return out;
}

static void put_factor( const factor_args* args, int row, int lane, double inverse, double first, double second )
{
    strands_put( args->factor, row, lane, ( wisp_vec3 ){ (float)inverse, (float)first, (float)second } );
}

static void stiffen_strand( const factor_args* args, const rod_strand* strand )
{
    for ( int i = 0; i < strand->count; ++i )
    {
        args->stiffness[strands_scalar( strand->row + i, strand->lane )] = (float)stiffness_of( args, strand, i );
    }
}

// Bound the tension of a strand whose tip is held, which may be more than its weight. A tension of EI / l^2 bends segments
// less than their stiffness straightens them, so it may come from the substep before, up to half of the bound of curls. Beyond
// that it may be four times the weight, as between two pins, and at most an eighth of m l / dt^2. Both together stay below a
// third of m l / dt^2: at 0.6, light hair whose clamped tips were moved whipped for ever in 10 substeps, and did so without twist.
static void bound_held_tension( const factor_args* args, const rod_strand* strand, float* most )
{
    const double gravity = (double)wisp_v3_length( args->settings->gravity );
    double whole = 0.0;
    for ( int i = 1; i < strand->count; ++i )
    {
        whole += mass_at( args->rows, strand->row + i, strand->lane );
    }
    for ( int i = 0; i + 1 < strand->count; ++i )
    {
        const size_t at = strands_scalar( strand->row + i, strand->lane );
        const double l = length_at_row( args->rows, strand->row + i, strand->lane );
        const double a = mass_at( args->rows, strand->row + i, strand->lane ),
                     b = mass_at( args->rows, strand->row + i + 1, strand->lane );
        const double mass = a > 0.0 && b > 0.0 ? fmin( a, b ) : fmax( a, b );
        const double reach = strands_bend_length( args->rows, strand->row, i, strand->lane );
        const double loose = fmin( 4.0 * gravity * whole, 0.125 * mass * l / ( args->dt * args->dt ) );
        const double rigidity = (double)args->stiffness[at] * reach;
        const double bent =
            fmin( rigidity / ( l * l ), sqrt( 0.25 * STRANDS_MAX_CURLED * rigidity * mass / l ) / args->dt );
        most[at] = (float)( loose + bent );
    }
}

static void factor_strand( const factor_args* args, const rod_strand* strand )
{
    const int row = strand->row, count = strand->count, lane = strand->lane;
    band before = { 1.0, 0.0, 0.0 }, first = before;
    for ( int i = 0; i < count; ++i )
    {
        if ( mass_at( args->rows, row + i, lane ) == 0.0 )
        {
            put_factor( args, row + i, lane, 0.0, 0.0, 0.0 );
            first = before;
            before = ( band ){ 1.0, 0.0, 0.0 };
            continue;
        }
        const band a = row_of_system( args, strand, i );
        band l = { 0.0, 0.0, a.second / first.pivot };
        l.first = ( a.first - l.second * first.pivot * before.first ) / before.pivot;
        l.pivot = a.pivot - l.first * l.first * before.pivot - l.second * l.second * first.pivot;
        put_factor( args, row + i, lane, 1.0 / l.pivot, l.first, l.second );
        first = before;
        before = l;
    }
}

bool strands_factor_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    const strands_state* state = user;
    const float* factored = wisp_frame_column( frame, entity, state->clamp, 1 );
    return wisp_frame_strands( frame, entity )->group_count > 0 && factored[0] != wisp_frame_dt( frame, entity );
}

static void factor_group( const factor_args* args, int group )
{
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        const rod_strand strand = rows_of( args, group, lane );
        factor_strand( args, &strand );
    }
}

static void factor_closed_groups( wisp_frame* frame, const wisp_span* span, const factor_args* args, float* response,
                                  float* most )
{
    enum
    {
        WORK = 2 * sizeof( double ) / sizeof( float ), // per row
    };
    const closed_factor_args closed = { args->rows,
                                        args->settings,
                                        args->stiffness,
                                        args->factor,
                                        response,
                                        args->dt,
                                        (double*)(void*)strands_scratch( frame, span, WORK ) };
    for ( int i = span->begin * WISP_LANES; closed.work != NULL && i < span->end * WISP_LANES; ++i )
    {
        const rod_strand strand = rows_of( args, i / WISP_LANES, i % WISP_LANES );
        if ( strand.count > 0 )
        {
            strands_factor_closed( &closed, strand.row, strand.count, strand.lane );
        }
        if ( strand.count > 0 && args->curled == false )
        {
            bound_held_tension( args, &strand, most );
        }
    }
}

void strands_factor( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_rows rows = strands_rows_in( frame, span->entity );
    const double dt = (double)wisp_frame_dt( frame, span->entity );
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const bool has_history = wisp_frame_has( frame, span->entity, state->history );
    const bool has_curve = wisp_frame_has( frame, span->entity, state->curve );
    float* most = wisp_frame_column( frame, span->entity, state->rod, 3 );
    const factor_args args = {
        .rows = &rows,
        .settings = settings,
        .stiffness = wisp_frame_column( frame, span->entity, state->rod, 1 ),
        .factor = wisp_frame_column( frame, span->entity, state->rod, 2 ),
        .dt = dt,
        .step = has_history ? 2.0 / 3.0 * dt : dt,
        .curled = has_curve && settings->rest != WISP_STRAND_REST_STRAIGHT,
        .hold = wisp_frame_column( frame, span->entity, state->tips, 0 ),
    };
    factor_args first_order = args;
    first_order.step = dt;
    first_order.factor = has_history ? wisp_frame_column( frame, span->entity, state->history, 3 ) : NULL;
    float* factored = wisp_frame_column( frame, span->entity, state->clamp, 1 );
    if ( wisp_frame_has( frame, span->entity, state->response ) )
    {
        factor_closed_groups( frame, span, &args, wisp_frame_column( frame, span->entity, state->response, 0 ),
                              most );
    }
    for ( int g = span->begin; g < span->end && wisp_frame_has( frame, span->entity, state->response ) == false; ++g )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            const rod_strand strand = rows_of( &args, g, lane );
            stiffen_strand( &args, &strand );
            if ( hold_of( &args, g, lane ) != WISP_STRAND_TIP_FREE && args.curled == false )
            {
                bound_held_tension( &args, &strand, most );
            }
        }
        factor_group( &args, g );
        if ( has_history )
        {
            factor_group( &first_order, g );
        }
    }
    for ( int g = span->begin; g < span->end; ++g )
    {
        factored[g] = wisp_frame_dt( frame, span->entity );
    }
}
