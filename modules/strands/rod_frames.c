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
// with z_i the middle frame's z axis and T = b = 0 behind the last segment. It is solved by one tridiagonal Newton
// step per substep, with EI / L_i max(0, (t_i - t_{i-1}) . k_i) / 4 for the second derivative of the bending in both
// segments and between them. Twist acts on the centre line too: its gradient with respect to e_s is (T_s kb_s +
// T_{s+1} kb_{s+1}) / (2 l_s), with kb_i = 2 t_{i-1} x t_i / (1 + t_{i-1} . t_i), on the right-hand side of the
// bending solve.
//
// k_i turns with its frame as a whole. So about 8 % of the force of a curl that is bent out of its plane is missing;
// forces in the plane, and all forces of straight rods, are complete (tests/oracle).
#include "rod_frames.h"

#include "strand_rows.h"

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
    if ( strands_norm( e ) == 0.0f )
    {
        return q;
    }
    const wisp_quat carried = strands_quat_multiply( q, strands_rotation_to( wisp_quat_inverse_rotate( q, e ) ) );
    return wisp_transform_make( carried, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

void strands_lay_group( const wisp_strand_topology* t, const float* position, const float* clamp, const float* root,
                        float* frame, int group )
{
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        wisp_quat q =
            strands_quat_multiply( strands_get_quat( root, group, lane ), strands_get_quat( clamp, group, lane ) );
        const int count = t->lane_count[group * WISP_LANES + lane];
        for ( int row = t->group_row[group]; row < t->group_row[group + 1]; ++row )
        {
            if ( row - t->group_row[group] + 1 < count )
            {
                const wisp_vec3 to = strands_get( position, row + 1, lane );
                q = strands_carry_frame( q, strands_sub( to, strands_get( position, row, lane ) ) );
            }
            strands_put_quat( frame, row, lane, q );
        }
    }
}
