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
#include "rod_frames.h"

#include "strand_rows.h"

#include "wisp/module/sleep.h"

// Return the smallest rotation from the z axis to a direction.
wisp_quat strands_rotation_to( wisp_vec3 d )
{
    const double length = sqrt( (double)d.x * (double)d.x + (double)d.y * (double)d.y + (double)d.z * (double)d.z );
    if ( length == 0.0 || (double)d.z < -0.999999 * length )
    {
        return length == 0.0 ? ( wisp_quat ){ 0.0f, 0.0f, 0.0f, 1.0f } : ( wisp_quat ){ 1.0f, 0.0f, 0.0f, 0.0f };
    }
    const wisp_quat q = { -d.y, d.x, 0.0f, (float)( length + (double)d.z ) };
    return wisp_transform_make( q, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

wisp_quat strands_carry_frame( wisp_quat q, wisp_vec3 e )
{
    if ( wisp_v3_length( e ) == 0.0f )
    {
        return q;
    }
    const wisp_quat carried = wisp_quat_multiply( q, strands_rotation_to( wisp_quat_inverse_rotate( q, e ) ) );
    return wisp_transform_make( carried, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
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

void strands_lay_group( const wisp_strand_topology* t, const float* position, const float* clamp, const float* root,
                        const float* length, float twist, float* frame, int group )
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
                q = strands_carry_frame( q, wisp_v3_sub( to, strands_get( position, row, lane ) ) );
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
