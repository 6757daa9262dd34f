// Rotation of whole strands about their roots towards a target, sixteen strands at once (Kim 2026, eq. 8-13).
//
// A strand can keep its turn: the vector to its target, not the rotation, so that each command computes eq. 11 again from the
// unturned shape. What a strand does then depends on the last command that reached it only, and no error adds up.
#include "kernel_isa.h"

#include "lane_trig.h"
#include "strand_frame.h"

// Rows of a group: one strand per lane; rows beyond the tip repeat the tip.
typedef struct align_group
{
    float* rows;
    int row_count;
    lane16i count; // vertices of each lane's strand
    lane16v root;
} align_group;

static const size_t STRIDE = 3 * WISP_LANES;

// With in_plane, z is depth, which turns nothing.
static lane16v without_depth( const wisp_strand_align_args* args, lane16v v )
{
    return ( lane16v ){ v.x, v.y, args->in_plane ? lane16_zero() : v.z };
}

static lane16v mean_of( const align_group* g, const float* rows )
{
    lane16v sum = lane16v_load( rows );
    for ( int i = 1; i < g->row_count; ++i )
    {
        lane16m inside = lane16i_lt( lane16i_set1( i ), g->count );
        lane16v p = lane16v_load( rows + (size_t)i * STRIDE );
        sum = lane16v_select( inside, lane16v_add( sum, p ), sum );
    }
    return lane16v_scale( sum, lane16_div( lane16_set1( 1.0f ), lane16_from_int( g->count ) ) );
}

// Computes the direction of eq. 8 of a shape of the group.
static lane16v direction_of( const align_group* g, const float* rows )
{
    return lane16v_sub( lane16v_load( rows + (size_t)( g->row_count - 1 ) * STRIDE ), mean_of( g, rows ) );
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

// ---- the turn of a strand ----

typedef struct align_turn
{
    lane16m turns; // lanes that turn at all
    lane16 angle;  // of the tip
    lane16v axis;
    lane16 intensity, last; // x of eq. 12, and its N - 1
} align_turn;

// A vector below this length has no direction: its strand does not turn.
static lane16m has_direction( lane16v v )
{
    return lane16_ge( lane16v_length( v ), lane16_set1( 1e-12f ) );
}

static align_turn turn_to( const wisp_strand_align_args* args, const align_group* g, lane16v u, lane16 intensity )
{
    align_turn t = { .intensity = intensity, .last = lane16_from_int( lane16i_sub( g->count, lane16i_set1( 1 ) ) ) };
    lane16v v = without_depth( args, direction_of( g, g->rows ) );
    u = without_depth( args, u );
    t.turns = lane16m_and( has_direction( v ), has_direction( u ) );
    rotation_between( args->dimension, v, u, &t.angle, &t.axis );
    return t;
}

// Computes the weight of eq. 12: x at the root, 1 at the tip.
static lane16 index_weight( const align_turn* turn, int i )
{
    lane16 one = lane16_set1( 1.0f );
    lane16 t = lane16_min( lane16_div( lane16_set1( (float)i ), turn->last ), one );
    return lane16_add( lane16_mul( t, lane16_sub( one, turn->intensity ) ), turn->intensity );
}

static lane16v turned_vertex( const wisp_strand_align_args* args, const align_group* g, const align_turn* turn,
                              int i )
{
    lane16v p = lane16v_load( g->rows + (size_t)i * STRIDE ), q = lane16v_sub( p, g->root );
    lane16 sine, cosine;
    lane16_sincos( lane16_mul( index_weight( turn, i ), turn->angle ), &sine, &cosine );
    lane16v turned = lane16v_add( g->root, lane16v_rotate( turn->axis, sine, cosine, q ) );
    turned.z = args->in_plane ? p.z : turned.z;
    return lane16v_select( turn->turns, turned, p );
}

// Selects strands inside the radius. Eq. 10 as printed tests the tip; `nearest` tests every vertex.
// @param turn of the strands before this command; null: none
static lane16m find_inside( const wisp_strand_align_args* args, const align_group* g, const align_turn* turn,
                            lane16v target )
{
    const int tip = g->row_count - 1;
    lane16 nearest = lane16_set1( FLT_MAX );
    for ( int i = args->nearest ? 0 : tip; i <= tip; ++i )
    {
        lane16v p =
            turn != NULL && i > 0 ? turned_vertex( args, g, turn, i ) : lane16v_load( g->rows + (size_t)i * STRIDE );
        lane16v d = without_depth( args, lane16v_sub( p, target ) );
        nearest = lane16_min( nearest, lane16v_dot( d, d ) );
    }
    lane16m inside = lane16_le( lane16_sqrt( nearest ), lane16_set1( args->radius ) );
    return lane16m_and( inside, lane16i_lt( lane16i_set1( 1 ), g->count ) );
}

// ---- turns that strands keep ----

// Rotates vectors of the rest shape along with the moved one: as the shape as a whole, then by the smallest rotation that
// takes the direction of the strand along.
// @param back rotate vectors of the moved shape to the rest shape
static lane16v rotate_with_strand( const wisp_strand_align_args* args, const align_group* g, int group, lane16v u,
                                   bool back )
{
    const size_t first = (size_t)args->group_row[group] * STRIDE;
    const frame16 turn = { lane16_set1( args->turn[0] ), lane16_set1( args->turn[1] ), lane16_set1( args->turn[2] ),
                           lane16_set1( args->turn[3] ) };
    const lane16 zero = lane16_zero();
    lane16v from = frame16_turn( turn, direction_of( g, args->rest + first ) );
    lane16v to = direction_of( g, args->moved + first ), axis;
    const lane16m known = lane16m_and( has_direction( from ), has_direction( to ) );
    const lane16v up = lane16v_set1( ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } );
    lane16 angle, sine, cosine;
    rotation_between( args->dimension, lane16v_select( known, from, up ), lane16v_select( known, to, up ), &angle,
                      &axis );
    lane16_sincos( angle, &sine, &cosine );
    if ( back )
    {
        const frame16 inverse = { lane16_neg( turn.x ), lane16_neg( turn.y ), lane16_neg( turn.z ), turn.w };
        return frame16_turn( inverse, lane16v_rotate( axis, lane16_sub( zero, sine ), cosine, u ) );
    }
    return lane16v_rotate( axis, sine, cosine, frame16_turn( turn, u ) );
}

static lane16v load_swept( const wisp_strand_align_args* args, const align_group* g, int group, lane16* intensity )
{
    const float* rows = args->swept + (size_t)group * 4 * WISP_LANES;
    lane16v u = lane16v_load( rows );
    *intensity = lane16_load( rows + 3 * WISP_LANES );
    return args->moved != NULL && lane16m_any( has_direction( u ) ) ? rotate_with_strand( args, g, group, u, false )
                                                                    : u;
}

static void store_swept( const wisp_strand_align_args* args, const align_group* g, int group, lane16m inside,
                         lane16v u, lane16 intensity )
{
    float* rows = args->swept + (size_t)group * 4 * WISP_LANES;
    u = args->moved != NULL ? rotate_with_strand( args, g, group, u, true ) : u;
    lane16v_store( rows, lane16v_select( inside, u, lane16v_load( rows ) ) );
    lane16_store( rows + 3 * WISP_LANES, lane16_select( inside, intensity, lane16_load( rows + 3 * WISP_LANES ) ) );
}

static void align_group_to( const wisp_strand_align_args* args, int group )
{
    align_group g = {
        .rows = args->position + (size_t)args->group_row[group] * STRIDE,
        .row_count = args->group_row[group + 1] - args->group_row[group],
        .count = lane16i_load( args->lane_count + group * WISP_LANES ),
    };
    g.root = lane16v_load( g.rows );

    // turns of commands before
    align_turn turn;
    lane16v u = lane16v_set1( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ), target = lane16v_set1( args->target );
    lane16 intensity = lane16_zero();
    bool is_turned = false;
    if ( args->swept != NULL )
    {
        u = load_swept( args, &g, group, &intensity );
        is_turned = lane16m_any( has_direction( u ) );
    }
    if ( is_turned )
    {
        turn = turn_to( args, &g, u, intensity );
    }

    // strands that this command reaches; one with its root at the target has no direction to turn to and keeps its turn
    lane16v to_target = without_depth( args, lane16v_sub( target, g.root ) );
    lane16m inside = find_inside( args, &g, is_turned ? &turn : NULL, target );
    inside = lane16m_and( inside, has_direction( to_target ) );
    if ( lane16m_any( inside ) )
    {
        lane16 wanted = lane16_load( args->intensity + group * WISP_LANES );
        u = lane16v_select( inside, to_target, u );
        intensity = lane16_select( inside, wanted, intensity );
        turn = turn_to( args, &g, u, intensity );
        is_turned = true;
        if ( args->swept != NULL )
        {
            store_swept( args, &g, group, inside, u, intensity );
        }
    }
    for ( int i = 1; i < g.row_count && is_turned; ++i )
    {
        lane16v_store( g.rows + (size_t)i * STRIDE, turned_vertex( args, &g, &turn, i ) );
    }
}

void KERNEL( strand_align )( const wisp_strand_align_args* args, int group_begin, int group_end )
{
    for ( int group = group_begin; group < group_end; ++group )
    {
        align_group_to( args, group );
    }
}
