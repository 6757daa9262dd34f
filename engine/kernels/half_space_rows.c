// Half spaces that particles must stay in for a substep, from the planes in which they meet a body.
//
// With h the thickness, `start` the signed distance less h at the start of the substep and `now` the distance at its
// end, a particle that starts too near is moved out by the recovered depth, together with its previous position, so
// that the correction gives no velocity. While it is deep, its own outward motion gives none either.
#include "pose.h"

enum
{
    LANES = 8,
};

LANE_INLINE lane8v load_plane( const float* const from[3], int at )
{
    return ( lane8v ){ lane8_loadu( from[0] + at ), lane8_loadu( from[1] + at ), lane8_loadu( from[2] + at ) };
}

// Displacement of a particle and the gap that it must keep.
typedef struct push_out
{
    lane8 recovered; // m, of position and previous position
    lane8 absorbed;  // m, outward displacement that shall give no velocity
    lane8 gap;       // m
} push_out;

LANE_INLINE push_out find_push_out( const wisp_half_space_rows_args* args, lane8 now, lane8 start )
{
    const lane8 zero = lane8_zero(), h = lane8_set1( args->thickness );
    const lane8 outward = lane8_max( lane8_sub( lane8_sub( now, h ), start ), zero );
    const lane8 depth = lane8_sub( lane8_neg( start ), outward );
    const lane8 most = lane8_max( lane8_sub( lane8_set1( args->recovery ), outward ), zero );
    push_out out;
    out.recovered = lane8_select( lane8_lt( lane8_add( start, outward ), zero ), lane8_min( depth, most ), zero );
    out.absorbed = lane8_select( lane8_lt( start, lane8_set1( -args->shallow ) ), outward, zero );
    out.gap = lane8_select( lane8_lt( start, zero ), lane8_add( lane8_add( h, start ), out.recovered ), h );
    return out;
}

// Stores positions where one differs: adding zero changes the sign of a negative zero.
LANE_INLINE bool move_out( const wisp_half_space_rows_args* args, int at, lane8v normal, const push_out* out )
{
    lane8v p, previous;
    lane8 mass, none;
    lane8_load_xyzw( args->position, args->particle_x4 + at, &p.x, &p.y, &p.z, &mass );
    lane8_load_xyzw( args->previous, args->particle_x4 + at, &previous.x, &previous.y, &previous.z, &none );
    const lane8v moved = lane8v_mul_add( p, out->recovered, normal );
    const lane8v from = lane8v_mul_add( previous, lane8_add( out->recovered, out->absorbed ), normal );
    const lane8 each[6][2] = { { p.x, moved.x },       { p.y, moved.y },       { p.z, moved.z },
                               { previous.x, from.x }, { previous.y, from.y }, { previous.z, from.z } };
    lane8i changed = lane8i_set1( 0 );
    for ( int k = 0; k < 6; ++k )
    {
        changed = lane8i_or( changed, lane8i_xor( lane8_cast_int( each[k][0] ), lane8_cast_int( each[k][1] ) ) );
    }
    if ( lane8m_all( lane8i_eq( changed, lane8i_set1( 0 ) ) ) )
    {
        return false;
    }
    lane8_store_xyzw( args->position, args->particle_x4 + at, moved.x, moved.y, moved.z, mass );
    lane8_store_xyzw( args->previous, args->particle_x4 + at, from.x, from.y, from.z, none );
    return true;
}

bool KERNEL( half_space_rows )( const wisp_half_space_rows_args* args, int count )
{
    const wisp_half_space_rows_args mine = *args;
    const lane8 zero = lane8_zero();
    const bool is_still = memcmp( &mine.before, &mine.after, sizeof( wisp_transform ) ) == 0;
    const bool was_turned = pose_is_turned( mine.before.rotation ), is_turned = pose_is_turned( mine.after.rotation );
    bool any_moved = false;
    for ( int i = 0; i < count; i += LANES )
    {
        const lane8v local = load_plane( mine.point, i );
        const lane8v normal = pose_rotate_if( is_turned, mine.after.rotation, load_plane( mine.normal, i ) );
        const lane8v point = pose_to_world( mine.after, is_turned, local );
        const lane8v was = is_still ? point : pose_to_world( mine.before, was_turned, local );
        const lane8v motion = lane8v_sub( point, was );
        const push_out out = find_push_out( &mine, lane8_loadu( mine.now + i ), lane8_loadu( mine.start + i ) );
        any_moved = move_out( &mine, i, normal, &out ) || any_moved;

        const int32_t* row = mine.row_x16 + i;
        lane8_store_xyzw( mine.rows, row, point.x, point.y, point.z, normal.x );
        lane8_store_xyzw( mine.rows + 4, row, normal.y, normal.z, motion.x, motion.y );
        lane8_store_xyzw( mine.rows + 8, row, motion.z, out.gap, zero, zero );
        lane8_store_xyzw( mine.rows + 12, row, zero, zero, lane8_set1( mine.static_friction ),
                          lane8_set1( mine.kinetic_friction ) );
    }
    return any_moved;
}
