// Rotation of whole strands about their roots towards a target, sixteen strands at once (Kim 2026, eq. 8-13).
#include "kernel_isa.h"

#include "lane_trig.h"

// Rows of a group: one strand per lane; rows beyond the tip repeat the tip.
typedef struct align_group
{
    float* rows;
    int row_count;
    lane16i count; // vertices of each lane's strand
    lane16v root, tip;
} align_group;

static const size_t STRIDE = 3 * WISP_LANES;

static lane16v mean_of( const align_group* g )
{
    lane16v sum = g->root;
    for ( int i = 1; i < g->row_count; ++i )
    {
        lane16m inside = lane16i_lt( lane16i_set1( i ), g->count );
        lane16v p = lane16v_load( g->rows + (size_t)i * STRIDE );
        sum = lane16v_select( inside, lane16v_add( sum, p ), sum );
    }
    return lane16v_scale( sum, lane16_div( lane16_set1( 1.0f ), lane16_from_int( g->count ) ) );
}

// Selects strands inside the radius. Eq. 10 as printed tests the tip; `nearest` tests every vertex.
static lane16m find_inside( const wisp_strand_align_args* args, const align_group* g, lane16v target )
{
    lane16v d = lane16v_sub( g->tip, target );
    lane16 nearest = lane16v_dot( d, d );
    for ( int i = 0; i < g->row_count && args->nearest; ++i )
    {
        d = lane16v_sub( lane16v_load( g->rows + (size_t)i * STRIDE ), target );
        nearest = lane16_min( nearest, lane16v_dot( d, d ) );
    }
    lane16m inside = lane16_le( lane16_sqrt( nearest ), lane16_set1( args->radius ) );
    return lane16m_and( inside, lane16i_lt( lane16i_set1( 1 ), g->count ) );
}

// Computes axis and angle of the rotation from v to u. Where the cross product is 0 (parallel or antiparallel), any
// perpendicular is used, as the angle is 0 or pi.
static void rotation_between( int dimension, lane16v v, lane16v u, lane16* angle, lane16v* axis )
{
    lane16v cross = lane16v_cross( v, u );
    lane16 sine = lane16v_length( cross );
    lane16 v_length = lane16v_length( v );
    lane16 scale = lane16_mul( v_length, lane16v_length( u ) );
    lane16m aligned = lane16_le( sine, lane16_mul( lane16_set1( 1e-6f ), scale ) );
    *angle = lane16_atan2( sine, lane16v_dot( v, u ) );
    *axis = lane16v_scale( cross, lane16_div( lane16_set1( 1.0f ), sine ) );
    if ( lane16m_any( aligned ) )
    {
        lane16v other = lane16v_set1( ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } ), unused;
        if ( dimension == 3 )
        {
            lane16v_basis( lane16v_scale( v, lane16_div( lane16_set1( 1.0f ), v_length ) ), &other, &unused );
        }
        *axis = lane16v_select( aligned, other, *axis );
    }
}

// Computes the weight of eq. 12: x at the root, 1 at the tip.
static lane16 index_weight( lane16 intensity, lane16 last, int i )
{
    lane16 one = lane16_set1( 1.0f );
    lane16 t = lane16_min( lane16_div( lane16_set1( (float)i ), last ), one );
    return lane16_add( lane16_mul( t, lane16_sub( one, intensity ) ), intensity );
}

static void turn_rows( const wisp_strand_align_args* args, const align_group* g, lane16 intensity, lane16m inside,
                       lane16 angle, lane16v axis )
{
    lane16 last = lane16_from_int( lane16i_sub( g->count, lane16i_set1( 1 ) ) );
    lane16 sine, cosine;
    lane16_sincos( angle, &sine, &cosine );
    for ( int i = 1; i < g->row_count; ++i )
    {
        float* row = g->rows + (size_t)i * STRIDE;
        lane16v p = lane16v_load( row ), q = lane16v_sub( p, g->root ), turned;
        lane16 w = index_weight( intensity, last, i );
        if ( args->chord )
        {
            // eq. 13 as printed: w R q + (1 - w) q
            lane16v whole = lane16v_rotate( axis, sine, cosine, q );
            turned = lane16v_mul_add( q, w, lane16v_sub( whole, q ) );
        }
        else
        {
            lane16_sincos( lane16_mul( w, angle ), &sine, &cosine );
            turned = lane16v_rotate( axis, sine, cosine, q );
        }
        lane16v_store( row, lane16v_select( inside, lane16v_add( g->root, turned ), p ) );
    }
}

static void align_group_to( const wisp_strand_align_args* args, int group )
{
    align_group g = {
        .rows = args->position + (size_t)args->group_row[group] * STRIDE,
        .row_count = args->group_row[group + 1] - args->group_row[group],
        .count = lane16i_load( args->lane_count + group * WISP_LANES ),
    };
    g.root = lane16v_load( g.rows );
    g.tip = lane16v_load( g.rows + (size_t)( g.row_count - 1 ) * STRIDE );
    lane16v target = lane16v_set1( args->target );
    lane16m inside = find_inside( args, &g, target );
    if ( lane16m_any( inside ) == false )
    {
        return;
    }
    lane16v v = lane16v_sub( g.tip, args->from_root ? g.root : mean_of( &g ) );
    lane16v u = lane16v_sub( target, g.root );

    // a strand without a direction, or with its root at the target, does not turn
    lane16 least = lane16_set1( 1e-12f );
    inside = lane16m_and( inside, lane16_ge( lane16v_length( v ), least ) );
    inside = lane16m_and( inside, lane16_ge( lane16v_length( u ), least ) );

    lane16 angle;
    lane16v axis;
    rotation_between( args->dimension, v, u, &angle, &axis );
    turn_rows( args, &g, lane16_load( args->intensity + group * WISP_LANES ), inside, angle, axis );
}

void KERNEL( strand_align )( const wisp_strand_align_args* args, int group_begin, int group_end )
{
    for ( int group = group_begin; group < group_end; ++group )
    {
        align_group_to( args, group );
    }
}
