// Jitter of segment lengths and directions, sixteen strands at a time (Kim 2026, eq. 2-7).
//
//   l* = max( l0 (1 + eta / k_s), 0.05 l0 )               theta = theta_max xi / k_b
//   p'_i = p'_{i-1} + l* R( a_i, theta_i ) t_i            a_i = t_{i-1} x t_i, normalised
//
// Rotations act on directions of the base shape and are not chained, so the sweep keeps only the last tangent and
// the last output. The axis is perpendicular to the tangent, so R t = cos t + sin a x t is a unit vector.
#include "kernel_isa.h"

#include "lane_random.h"
#include "lane_trig.h"

// Values that are constant along a strand.
typedef struct jitter_lanes
{
    lane16i strand;
    lane16 stretch, bend; // 1 / k
} jitter_lanes;

// Returns the unit vector perpendicular to t that is nearest to the z axis, so that t bends along x and y alone. For a t in the
// plane it is exactly the z axis.
static lane16v upright_axis( lane16v t )
{
    const lane16 zero = lane16_zero();
    lane16v b1, b2;
    lane16v_basis( t, &b1, &b2 );
    const lane16 across = lane16_sqrt( lane16_mul_add( t.x, t.x, lane16_mul( t.y, t.y ) ) );
    const lane16 tilt = lane16_neg( lane16_div( t.z, across ) );
    lane16v axis = { lane16_mul( tilt, t.x ), lane16_mul( tilt, t.y ), across };
    axis = lane16v_select( lane16_gt( across, lane16_set1( 1e-6f ) ), axis, b1 );
    const lane16v z = { zero, zero, lane16_set1( 1.0f ) };
    return lane16v_select( lane16_eq( t.z, zero ), z, axis );
}

// Returns a unit vector perpendicular to t where the strand defines none: the z axis in the plane and near it with layers,
// otherwise a random one. It depends only on strand and vertex, so repeated calls agree.
static lane16v fallback_axis( const wisp_strand_jitter_args* args, const jitter_lanes* lanes, int vertex, lane16v t )
{
    if ( args->in_plane )
    {
        return upright_axis( t );
    }
    if ( args->dimension == 2 )
    {
        return lane16v_set1( ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } );
    }
    lane16 u = lane16_random_unit( args->axis_key, lanes->strand, lane16i_set1( vertex ), lane16i_set1( 0 ) );
    lane16 sine, cosine;
    lane16_sincos( lane16_mul( u, lane16_set1( 6.28318531f ) ), &sine, &cosine );
    lane16v b1, b2;
    lane16v_basis( t, &b1, &b2 );
    return lane16v_add( lane16v_scale( b1, cosine ), lane16v_scale( b2, sine ) );
}

static lane16v bend_axis( const wisp_strand_jitter_args* args, const jitter_lanes* lanes, int vertex, lane16v before,
                          lane16v t )
{
    // before x t = before x (t - before), with an exact difference for nearly parallel vectors
    lane16v c = lane16v_cross( before, lane16v_sub( t, before ) );
    lane16 length = lane16v_length( c );
    lane16m straight = lane16_lt( length, lane16_set1( 1e-8f ) );
    lane16v axis = lane16v_scale( c, lane16_div( lane16_set1( 1.0f ), length ) );
    if ( vertex == 1 || lane16m_any( straight ) )
    {
        lane16m missing = vertex == 1 ? lane16m_first( WISP_LANES ) : straight;
        axis = lane16v_select( missing, fallback_axis( args, lanes, vertex, t ), axis );
    }
    return axis;
}

static lane16 jittered_length( const wisp_strand_jitter_args* args, const jitter_lanes* lanes, int vertex,
                               lane16 rest )
{
    lane16 eta = lane16_random_signed( args->length_key, lanes->strand, lane16i_set1( vertex ), lane16i_set1( 0 ) );
    lane16 factor = lane16_mul_add( lanes->stretch, eta, lane16_set1( 1.0f ) );
    return lane16_mul( rest, lane16_max( factor, lane16_set1( 0.05f ) ) );
}

static void jitter_group( const wisp_strand_jitter_args* args, int group )
{
    const lane16 one = lane16_set1( 1.0f );
    const size_t stride = 3 * WISP_LANES;
    const int lane = group * WISP_LANES;
    jitter_lanes lanes = {
        .strand = lane16i_load( args->lane_strand + lane ),
        .stretch = lane16_div( one, lane16_load( args->stretch + lane ) ),
        .bend = lane16_div( one, lane16_load( args->bend + lane ) ),
    };
    lane16 angle_scale = lane16_mul( lane16_set1( args->angle_max ), lanes.bend );

    const float* rest = args->rest + (size_t)args->group_row[group] * stride;
    float* position = args->position + (size_t)args->group_row[group] * stride;
    int rows = args->group_row[group + 1] - args->group_row[group];
    lane16v base = lane16v_load( position ), shaped = base, rest_before = lane16v_load( rest );
    lane16v tangent = lane16v_set1( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );

    for ( int i = 1; i < rows; ++i )
    {
        position += stride;
        rest += stride;

        // segment of the base shape; one without length takes the previous tangent
        lane16v base_next = lane16v_load( position ), rest_next = lane16v_load( rest );
        lane16v d = lane16v_sub( base_next, base );
        lane16 length = lane16v_length( d );
        lane16m has_length = lane16_gt( length, lane16_set1( 1e-12f ) );
        lane16v unit = lane16v_scale( d, lane16_div( one, length ) );
        unit = lane16v_select( has_length, unit, tangent );

        // direction, rotated by a random angle
        lane16v axis = bend_axis( args, &lanes, i, tangent, unit );
        lane16 xi = lane16_random_signed( args->angle_key, lanes.strand, lane16i_set1( i ), lane16i_set1( 0 ) );
        lane16 sine, cosine;
        lane16_sincos( lane16_mul( angle_scale, xi ), &sine, &cosine );
        lane16v turned = lane16v_mul_add( lane16v_scale( unit, cosine ), sine, lane16v_cross( axis, unit ) );

        // length, random around the original
        lane16 target = jittered_length( args, &lanes, i, lane16v_length( lane16v_sub( rest_next, rest_before ) ) );
        shaped = lane16v_mul_add( shaped, target, turned );
        lane16v_store( position, shaped );
        base = base_next;
        rest_before = rest_next;
        tangent = unit;
    }
}

void KERNEL( strand_jitter )( const wisp_strand_jitter_args* args, int group_begin, int group_end )
{
    for ( int group = group_begin; group < group_end; ++group )
    {
        jitter_group( args, group );
    }
}
