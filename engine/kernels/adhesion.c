// Pairwise adhesion with a gap-keeping brake, eight vertices at once (Kim 2026, eq. 14-19).
//
//   f_i = sum g(r) (q - p_i) / r,  g(r) = (1 - r/h)^2        Dp_i = sigma f_i, limited by the guard
//   delta_i = sum g(r0) min( |r1 - r0| / h, 1 ) / sum g(r0)
//   p_i <- p_i + lambda_i Dp_i,  lambda = (1 - delta) zeta + delta floor
//
// Each lane is one vertex and adds its neighbours in list order, so sums equal those of a scalar loop. Padding and
// pairs beyond h add exactly 0. A pair at distance 0 has no direction and is skipped.
#include "kernel_isa.h"

#include "lane_random.h"

// Loads neighbours. `planar` is a constant after inlining; with z = 0 the compiler removes the work for z.
LANE_INLINE lane8v load_entry( const float* xyzw, const int32_t* entries, bool planar )
{
    lane8v q;
    lane8_load_xyz( xyzw, entries, &q.x, &q.y, &q.z );
    q.z = planar ? lane8_zero() : q.z;
    return q;
}

// Computes |d|^2. In the plane, z would add a zero that the compiler cannot remove, because its sign may matter.
LANE_INLINE lane8 squared_length( lane8v d, bool planar )
{
    return planar ? lane8_add( lane8_mul( d.x, d.x ), lane8_mul( d.y, d.y ) ) : lane8v_dot( d, d );
}

LANE_INLINE lane8v load_slice( const float* xyzw, int slice )
{
    static const int32_t own[WISP_SLICE] = { 0, 4, 8, 12, 16, 20, 24, 28 };
    return load_entry( xyzw + (size_t)slice * WISP_SLICE * 4, own, false );
}

static void store_slice( float* xyzw, int slice, lane8v p )
{
    lane8_store_xyzw_contiguous( xyzw + (size_t)slice * WISP_SLICE * 4, p.x, p.y, p.z, lane8_zero() );
}

// Computes g(r) of eq. 14, which is 0 for r >= h.
LANE_INLINE lane8 kernel_weight( lane8 r, lane8 inverse_h )
{
    lane8 u = lane8_max( lane8_sub( lane8_set1( 1.0f ), lane8_mul( r, inverse_h ) ), lane8_zero() );
    return lane8_mul( u, u );
}

static float max_length( lane8 squared )
{
    float lanes[WISP_SLICE], most = 0.0f;
    lane8_storeu( lanes, squared );
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        most = lanes[l] > most ? lanes[l] : most;
    }
    float length;
    lane8_storeu( lanes, lane8_sqrt( lane8_set1( most ) ) );
    length = lanes[0];
    return length;
}

// Limits a move to half of the distance between the nearest neighbour and r_min, so no pair gets closer than r_min.
static lane8v guarded( const wisp_adhesion_args* args, lane8v move, lane8 nearest )
{
    lane8 room = lane8_mul( lane8_sub( nearest, lane8_set1( args->distance_min ) ), lane8_set1( 0.5f ) );
    room = lane8_max( room, lane8_zero() );
    lane8 length = lane8v_length( move );
    lane8m too_far = lane8_gt( length, room );
    lane8 scale = lane8_select( too_far, lane8_div( room, length ), lane8_set1( 1.0f ) );
    return lane8v_scale( move, scale );
}

// Sums over the lists of one slice.
typedef struct attract_sums
{
    lane8v force;
    lane8 nearest, weights;
    int near;
} attract_sums;

// Options of the first sweep, constants after inlining.
typedef struct attract_law
{
    bool planar, measuring;
} attract_law;

// Replaces a distance that has no direction; larger than any radius.
static const float NO_DISTANCE = 3e38f;

LANE_INLINE attract_sums attract_list( const wisp_adhesion_args* args, const wisp_neighbour_list* list, int slice,
                                       lane8v p, attract_law law, attract_sums sums )
{
    const lane8 h = lane8_set1( args->radius ), inverse_h = lane8_set1( 1.0f / args->radius );
    const lane8 zero = lane8_zero(), no_distance = lane8_set1( NO_DISTANCE );
    const size_t first = (size_t)list->begin[slice] * WISP_SLICE;
    const int length = list->length[slice];
    const int32_t* entries = list->entries + first;
    const float* current = args->current;
    float* distances = law.measuring ? args->pairs->distance + first : NULL;
    for ( int k = 0; k < length; ++k )
    {
        lane8v d = lane8v_sub( load_entry( current, entries + k * WISP_SLICE, law.planar ), p );
        lane8 r = lane8_sqrt( squared_length( d, law.planar ) );
        r = lane8_select( lane8_eq( r, zero ), no_distance, r );
        lane8 weight = kernel_weight( r, inverse_h );
        lane8 pull = lane8_div( weight, r );
        sums.force.x = lane8_mul_add( d.x, pull, sums.force.x );
        sums.force.y = lane8_mul_add( d.y, pull, sums.force.y );
        sums.force.z = law.planar ? zero : lane8_mul_add( d.z, pull, sums.force.z );
        // neighbours beyond h need no test: if none is nearer, the force is 0 and nothing is limited
        sums.nearest = lane8_min( sums.nearest, r );
        if ( law.measuring )
        {
            lane8_store( distances + k * WISP_SLICE, r );
            sums.weights = lane8_add( sums.weights, weight );
            sums.near += __builtin_popcount( lane8m_bits( lane8_lt( r, h ) ) );
        }
    }
    return sums;
}

// Marks vertices that have moved farther than the search margin. Returns the maximum squared distance moved since
// the search.
LANE_INLINE lane8 check_margin( const wisp_adhesion_args* args, int slice, lane8v p, lane8 most )
{
    lane8v d = lane8v_sub( p, load_slice( args->search_position, slice ) );
    lane8 moved = lane8v_dot( d, d );
    args->needs_search[slice] =
        (uint8_t)lane8m_bits( lane8_gt( moved, lane8_set1( args->search_margin * args->search_margin ) ) );
    return lane8_max( most, moved );
}

LANE_INLINE float attract_slices( const wisp_adhesion_args* args, int slice_first, int slice_last, attract_law law )
{
    const lane8 step = lane8_set1( args->step ), zero = lane8_zero();
    lane8 most = zero;
    for ( int slice = slice_first; slice < slice_last; ++slice )
    {
        lane8v p = load_slice( args->current, slice );
        p.z = law.planar ? zero : p.z;
        attract_sums sums = { { zero, zero, zero }, lane8_set1( NO_DISTANCE ), zero, 0 };
        for ( int i = 0; i < args->attracting_count; ++i )
        {
            sums = attract_list( args, args->attracting + i, slice, p, law, sums );
        }
        if ( law.measuring )
        {
            lane8_store( args->pairs->weight_sum + (size_t)slice * WISP_SLICE, sums.weights );
            args->pairs->near[slice] = sums.near;
        }
        sums.force.z = args->in_plane ? zero : sums.force.z;
        lane8v move = guarded( args, lane8v_scale( sums.force, step ), sums.nearest );

        // roots do not move
        lane8m moves = lane8i_lt( lane8i_set1( 0 ), lane8i_loadu( args->vertex + slice * WISP_SLICE ) );
        move = lane8v_select( moves, move, ( lane8v ){ zero, zero, zero } );
        lane8v tentative = lane8v_add( p, move );
        lane8v_store( args->displacement + (size_t)slice * 3 * WISP_SLICE, move );
        store_slice( args->tentative, slice, tentative );
        most = args->brakes ? most : check_margin( args, slice, tentative, most );
    }
    return max_length( most );
}

LANE_INLINE float attract_in( const wisp_adhesion_args* args, int slice_first, int slice_last, bool planar )
{
    return args->stores_pairs ? attract_slices( args, slice_first, slice_last, ( attract_law ){ planar, true } )
                              : attract_slices( args, slice_first, slice_last, ( attract_law ){ planar, false } );
}

float KERNEL( adhesion_attract )( const wisp_adhesion_args* args, int slice_first, int slice_last )
{
    return args->planar ? attract_in( args, slice_first, slice_last, true )
                        : attract_in( args, slice_first, slice_last, false );
}

// Computes delta of eq. 17, a weighted mean over the reference neighbours. `planar` is a constant after inlining.
LANE_INLINE lane8 change_fraction( const wisp_adhesion_args* args, int slice, bool planar )
{
    const lane8 inverse_h = lane8_set1( 1.0f / args->radius ), zero = lane8_zero(), one = lane8_set1( 1.0f );
    const wisp_neighbour_list* list = &args->reference;
    const size_t first = (size_t)list->begin[slice] * WISP_SLICE;
    const int32_t* entries = list->entries + first;
    const float* distances = args->pairs->distance + first;
    const lane8 weights = lane8_load( args->pairs->weight_sum + (size_t)slice * WISP_SLICE );
    lane8v moved = load_slice( args->tentative, slice );
    moved.z = planar ? zero : moved.z;
    lane8 changes = zero;
    for ( int k = 0; k < list->length[slice]; ++k )
    {
        lane8v d = lane8v_sub( load_entry( args->tentative, entries + k * WISP_SLICE, planar ), moved );
        lane8 r1 = lane8_sqrt( squared_length( d, planar ) ), r0 = lane8_load( distances + k * WISP_SLICE );
        lane8 change = lane8_abs( lane8_mul( lane8_sub( r1, r0 ), inverse_h ) );
        changes = lane8_mul_add( kernel_weight( r0, inverse_h ), lane8_min( change, one ), changes );
    }
    return lane8_select( lane8_gt( weights, zero ), lane8_div( changes, weights ), zero );
}

LANE_INLINE float brake_slices( const wisp_adhesion_args* args, int slice_first, int slice_last, bool planar )
{
    const lane8 floor = lane8_set1( args->lambda_min );
    lane8 most = lane8_zero();
    for ( int slice = slice_first; slice < slice_last; ++slice )
    {
        lane8 delta = change_fraction( args, slice, planar );
        lane8 zeta = lane8_random_unit( args->key, lane8i_loadu( args->owner + slice * WISP_SLICE ),
                                        lane8i_loadu( args->vertex + slice * WISP_SLICE ),
                                        lane8i_set1( (int32_t)args->iteration ) );
        lane8 rest = lane8_sub( lane8_set1( 1.0f ), delta );
        lane8 lambda = lane8_mul_add( rest, zeta, lane8_mul( delta, floor ) );
        lane8v move = lane8v_scale( lane8v_load( args->displacement + (size_t)slice * 3 * WISP_SLICE ), lambda );
        lane8v next = lane8v_add( load_slice( args->current, slice ), move );
        store_slice( args->next, slice, next );
        most = check_margin( args, slice, next, most );
    }
    return max_length( most );
}

float KERNEL( adhesion_brake )( const wisp_adhesion_args* args, int slice_first, int slice_last )
{
    return args->planar ? brake_slices( args, slice_first, slice_last, true )
                        : brake_slices( args, slice_first, slice_last, false );
}
