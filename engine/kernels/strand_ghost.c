// Strands that follow others (Park and Kim 2024, eq. 4-5). Values shared by all ghosts of a target are computed
// once per node and stored as rows of four floats. A ghost then reads two or three rows and its own offset, and is
// bound by memory.
#include "strand_frame.h"

enum
{
    STRIDE = 12, // floats per node of the table
    BLENDED_STRIDE = 16,
};

static const float SLOW_SPEED = 1e-6f; // m/s, minimum speed of a velocity with a direction

// ---- change of velocity ----

// Computes the elastic weight of a target with velocity v now and `before` one step earlier.
#define DEFINE_ELASTIC( P, PV )                                                                                      \
    LANE_INLINE P P##_elastic( bool is_elastic, PV v, PV before )                                                    \
    {                                                                                                                \
        const P half = P##_set1( 0.5f ), one = P##_set1( 1.0f ), slow = P##_set1( SLOW_SPEED );                      \
        const P product = P##v_dot( v, before );                                                                     \
        if ( !is_elastic )                                                                                           \
        {                                                                                                            \
            return P##_zero();                                                                                       \
        }                                                                                                            \
        const P speed = P##v_length( v ), speed0 = P##v_length( before );                                            \
        const P##m directed = P##m_and( P##_ge( speed, slow ), P##_ge( speed0, slow ) );                             \
        const P ratio = P##_div( product, P##_mul( speed, speed0 ) );                                                \
        const P cosine = P##_max( P##_min( ratio, one ), P##_set1( -1.0f ) );                                        \
        return P##_select( directed, P##_sub( half, P##_mul( half, cosine ) ), P##_zero() );                         \
    }

DEFINE_ELASTIC( lane8, lane8v )
DEFINE_ELASTIC( lane16, lane16v )

// ---- targets ----

// Returns the coordinate axis with the smallest component of a unit vector, which is not parallel to it.
static lane16v min_axis( lane16v v )
{
    const lane16 x = lane16_abs( v.x ), y = lane16_abs( v.y ), z = lane16_abs( v.z );
    const lane16m is_x = lane16m_and( lane16_le( x, y ), lane16_le( x, z ) );
    const lane16m is_y = lane16m_and_not( lane16_le( y, z ), is_x );
    const lane16 one = lane16_set1( 1.0f ), zero = lane16_zero();
    const lane16m is_z = lane16m_not( lane16m_or( is_x, is_y ) );
    return ( lane16v ){ lane16_select( is_x, one, zero ), lane16_select( is_y, one, zero ),
                        lane16_select( is_z, one, zero ) };
}

// Multiplies q by the smallest rotation from `from` to `to`. Opposite directions rotate by half a turn about a
// perpendicular; a vector without length causes no rotation.
static frame16 transport( frame16 q, lane16v from, lane16v to )
{
    const lane16 one = lane16_set1( 1.0f ), zero = lane16_zero();
    const lane16 from_length = lane16v_length( from ), to_length = lane16v_length( to );
    const lane16m directed = lane16m_and( lane16_lt( zero, from_length ), lane16_lt( zero, to_length ) );
    const lane16v a = lane16v_scale( from, lane16_div( one, from_length ) );
    const lane16v b = lane16v_scale( to, lane16_div( one, to_length ) );
    const lane16v axis = lane16v_cross( a, b );
    frame16 swing = { axis.x, axis.y, axis.z, lane16_add( one, lane16v_dot( a, b ) ) };
    const lane16m opposite =
        lane16m_and( directed, lane16m_and( lane16_lt( lane16v_dot( axis, axis ), lane16_set1( 1e-12f ) ),
                                            lane16_lt( swing.w, one ) ) );
    if ( lane16m_any( opposite ) )
    {
        const lane16v least = min_axis( a );
        const lane16v across = lane16v_sub( least, lane16v_scale( a, lane16v_dot( least, a ) ) );
        swing = frame16_select( opposite, ( frame16 ){ across.x, across.y, across.z, zero }, swing );
    }
    const frame16 none = { zero, zero, zero, one };
    const frame16 turn = frame16_select( directed, frame16_normalise( swing, none ), none );
    return frame16_normalise( frame16_multiply( turn, q ), q );
}

// Rows of a group, read in order.
typedef struct target_rows
{
    const float *position, *rest, *velocity, *before, *cap, *reach;
    lane16v last, last_rest; // of the previous row
    frame16 frame;
} target_rows;

static target_rows begin_rows( const wisp_strand_target_args* args, int group )
{
    const size_t row = (size_t)args->group_row[group], triple = row * 3 * WISP_LANES;
    const lane16 zero = lane16_zero();
    target_rows r = {
        .position = args->position + triple,
        .rest = args->rest + triple,
        .velocity = args->velocity != NULL ? args->velocity + triple : NULL,
        .before = args->previous_velocity != NULL ? args->previous_velocity + triple : NULL,
        .cap = args->max_sway + row * WISP_LANES,
        .reach = args->reach + row * WISP_LANES,
        .frame = { zero, zero, zero, lane16_set1( 1.0f ) },
    };
    if ( args->root != NULL )
    {
        r.frame = frame16_load( args->root + (size_t)group * 4 * WISP_LANES );
    }
    return r;
}

// Computes the factor that keeps the sway of all ghosts between the centre and the farthest within the cap. One factor
// for all of them keeps the ratios of their sways; a clamp of each would make them equal.
#define DEFINE_GROUP_FACTOR( P )                                                                                     \
    LANE_INLINE P P##_group_factor( P shared, P reach, P sway_length, P cap )                                        \
    {                                                                                                                \
        const P largest = P##_max( P##_abs( shared ), P##_abs( P##_add( shared, reach ) ) );                         \
        const P longest = P##_mul( sway_length, largest );                                                           \
        return P##_select( P##_lt( cap, longest ), P##_div( cap, longest ), P##_set1( 1.0f ) );                      \
    }

DEFINE_GROUP_FACTOR( lane8 )
DEFINE_GROUP_FACTOR( lane16 )

// Computes the values of one node per lane, in the layout of wisp_strand_target_args.
static void node_numbers( const wisp_strand_target_args* args, target_rows* r, int i, lane16 tip, lane16 numbers[] )
{
    const size_t triple = (size_t)i * 3 * WISP_LANES;
    const lane16 zero = lane16_zero();
    const lane16v x = lane16v_load( r->position + triple ), rest = lane16v_load( r->rest + triple );
    lane16v v = { zero, zero, zero };
    if ( r->velocity != NULL && i > 0 )
    {
        v = lane16v_load( r->velocity + triple );
    }
    const lane16v before = r->before != NULL && i > 0 ? lane16v_load( r->before + triple ) : v;
    if ( i > 0 )
    {
        r->frame = transport( r->frame, frame16_turn( r->frame, lane16v_sub( rest, r->last_rest ) ),
                              lane16v_sub( x, r->last ) );
    }
    r->last = x;
    r->last_rest = rest;

    const lane16 cap = lane16_load( r->cap + (size_t)i * WISP_LANES );
    const lane16 reach = lane16_load( r->reach + (size_t)i * WISP_LANES );
    lane16v sway = args->is_blended ? v : lane16v_scale( v, lane16_set1( args->sway_time ) );
    if ( args->is_blended == false )
    {
        tip = lane16_add( lane16_elastic( args->is_elastic, v, before ), tip );
        sway = lane16v_scale( sway, lane16_group_factor( tip, reach, lane16v_length( sway ), cap ) );
    }
    const lane16 all[BLENDED_STRIDE] = { x.x,      x.y,      x.z,        tip,        sway.x,     sway.y,
                                         sway.z,   cap,      r->frame.x, r->frame.y, r->frame.z, r->frame.w,
                                         before.x, before.y, before.z,   reach };
    for ( int k = 0; k < args->stride; ++k )
    {
        numbers[k] = all[k];
    }
}

// Stores nodes; lanes beyond their tip have none.
static void store_node( const wisp_strand_target_args* args, int group, int i, bool everywhere,
                        const lane16 numbers[] )
{
    float block[BLENDED_STRIDE][WISP_LANES] __attribute__( ( aligned( 64 ) ) );
    int32_t at[WISP_LANES];
    for ( int k = 0; k < args->stride; ++k )
    {
        lane16_store( block[k], numbers[k] );
    }
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        at[lane] = args->lane_node[group * WISP_LANES + lane] + i * args->stride;
    }
    for ( int half = 0; half < WISP_LANES && everywhere; half += 8 )
    {
        for ( int k = 0; k < args->stride; k += 4 )
        {
            lane8_store_xyzw( args->table + k, at + half, lane8_load( block[k] + half ),
                              lane8_load( block[k + 1] + half ), lane8_load( block[k + 2] + half ),
                              lane8_load( block[k + 3] + half ) );
        }
    }
    for ( int lane = 0; lane < WISP_LANES && everywhere == false; ++lane )
    {
        for ( int k = 0; k < args->stride && i < args->lane_count[group * WISP_LANES + lane]; ++k )
        {
            args->table[at[lane] + k] = block[k][lane];
        }
    }
}

void KERNEL( strand_target )( const wisp_strand_target_args* args, int begin, int end )
{
    for ( int group = begin; group < end; ++group )
    {
        target_rows rows = begin_rows( args, group );
        const lane16i count = lane16i_load( args->lane_count + group * WISP_LANES );
        const lane16 last =
            lane16_max( lane16_from_int( lane16i_sub( count, lane16i_set1( 1 ) ) ), lane16_set1( 1 ) );
        const int row_count = args->group_row[group + 1] - args->group_row[group];
        for ( int i = 0; i < row_count; ++i )
        {
            lane16 numbers[BLENDED_STRIDE];
            const lane16 tip = lane16_div( lane16_set1( args->tip_gain * (float)i ), last );
            node_numbers( args, &rows, i, tip, numbers );
            store_node( args, group, i, lane16m_all( lane16i_lt( lane16i_set1( i ), count ) ), numbers );
        }
    }
}

// ---- ghosts ----

// Position of eight lanes in the table, row by row. Beyond its tip a lane stays there.
typedef struct quad_walk
{
    int32_t at[8];
    lane8i next, last, stride;
} quad_walk;

LANE_INLINE quad_walk begin_walk( const int32_t* node, const int32_t* count, int stride )
{
    const lane8i one = lane8i_set1( 1 ), zero = lane8i_set1( 0 ), step = lane8i_set1( stride );
    const lane8i first = lane8i_loadu( node ), behind = lane8i_sub( lane8i_loadu( count ), one );
    const lane8i steps = lane8i_select( lane8i_lt( behind, zero ), zero, behind );
    return ( quad_walk ){ .next = first, .last = lane8i_add( first, lane8i_mul( steps, step ) ), .stride = step };
}

LANE_INLINE void walk( quad_walk* w )
{
    lane8i_storeu( w->at, w->next );
    const lane8i following = lane8i_add( w->next, w->stride );
    w->next = lane8i_select( lane8i_lt( w->last, following ), w->last, following );
}

LANE_INLINE lane8v load_offset( const float* rows )
{
    return ( lane8v ){ lane8_load( rows ), lane8_load( rows + WISP_LANES ), lane8_load( rows + 2 * WISP_LANES ) };
}

LANE_INLINE void store_place( float* rows, lane8v y )
{
    lane8_store( rows, y.x );
    lane8_store( rows + WISP_LANES, y.y );
    lane8_store( rows + 2 * WISP_LANES, y.z );
}

// Rotates v by the quaternion in the third row of each lane's node.
LANE_INLINE lane8v turn_by_node( const float* table, const int32_t* at, lane8v v )
{
    lane8 x, y, z, w;
    lane8_load_xyzw( table + 8, at, &x, &y, &z, &w );
    const lane8v axis = { x, y, z };
    const lane8v t = lane8v_scale( lane8v_cross( axis, v ), lane8_set1( 2.0f ) );
    return lane8v_add( lane8v_mul_add( v, w, t ), lane8v_cross( axis, t ) );
}

// Computes y = x + R o + weight sway with the weight shared + scale |o|.
LANE_INLINE void ghost_rows( const wisp_strand_ghost_args mine, int group )
{
    const int lanes = group * WISP_LANES, row_count = mine.group_row[group + 1] - mine.group_row[group];
    const float* offset = mine.offset + (size_t)mine.group_row[group] * 3 * WISP_LANES;
    float* to = mine.points + (size_t)mine.group_row[group] * 3 * WISP_LANES;
    quad_walk walks[2];
    lane8 scale[2];
    for ( int half = 0; half < 2; ++half )
    {
        walks[half] = begin_walk( mine.lane_node + lanes + 8 * half, mine.lane_count + lanes + 8 * half, STRIDE );
        scale[half] = lane8_loadu( mine.centre_scale + lanes + 8 * half );
    }
    for ( int i = 0; i < row_count; ++i )
    {
        for ( int half = 0; half < 2; ++half )
        {
            const size_t row = (size_t)i * 3 * WISP_LANES + (size_t)half * 8;
            quad_walk* w = walks + half;
            lane8v x, sway;
            lane8 shared, unused;
            walk( w );
            lane8_load_xyzw( mine.table, w->at, &x.x, &x.y, &x.z, &shared );
            lane8_load_xyzw( mine.table + 4, w->at, &sway.x, &sway.y, &sway.z, &unused );
            const lane8v o = load_offset( offset + row );
            const lane8 weight = lane8_mul_add( scale[half], lane8v_length( o ), shared );
            const lane8v b = lane8v_add( x, turn_by_node( mine.table, w->at, o ) );
            store_place( to + row, lane8v_mul_add( b, weight, sway ) );
        }
    }
}

void KERNEL( strand_ghost )( const wisp_strand_ghost_args* args, int begin, int end )
{
    for ( int group = begin; group < end; ++group )
    {
        ghost_rows( *args, group );
    }
}

// ---- ghosts of several targets ----

// Blended values of the targets of eight ghosts, for one row.
typedef struct blended
{
    lane8v base, velocity, before;
    lane8 tip, cap, reach; // of the first target only
} blended;

static blended blend_row( const wisp_strand_ghost_args* args, int lane, quad_walk* walks, const float* offset )
{
    const lane8 zero = lane8_zero();
    const lane8v none = { zero, zero, zero };
    blended sum = { none, none, none, zero, zero, zero };
    for ( int k = 0; k < args->target_count; ++k )
    {
        lane8v x, v, before;
        lane8 tip, cap, reach;
        walk( walks + k );
        lane8_load_xyzw( args->table, walks[k].at, &x.x, &x.y, &x.z, &tip );
        lane8_load_xyzw( args->table + 4, walks[k].at, &v.x, &v.y, &v.z, &cap );
        lane8_load_xyzw( args->table + 12, walks[k].at, &before.x, &before.y, &before.z, &reach );
        const lane8 fraction = lane8_loadu( args->lane_fraction + lane + k * WISP_LANES );
        const lane8v o = load_offset( offset + (size_t)k * 3 * WISP_LANES );
        const lane8v place = lane8v_add( x, turn_by_node( args->table, walks[k].at, o ) );
        sum.base = lane8v_mul_add( sum.base, fraction, place );
        sum.velocity = lane8v_mul_add( sum.velocity, fraction, v );
        sum.before = lane8v_mul_add( sum.before, fraction, before );
        sum.tip = k == 0 ? tip : sum.tip;
        sum.cap = k == 0 ? cap : sum.cap;
        sum.reach = k == 0 ? reach : sum.reach;
    }
    return sum;
}

static void blend_half( const wisp_strand_ghost_args* args, int group, int half )
{
    const int links = args->target_count, first = group * WISP_LANES + half;
    const int row_count = args->group_row[group + 1] - args->group_row[group];
    const size_t from = (size_t)args->group_row[group] * (size_t)links * 3 * WISP_LANES + (size_t)half;
    const size_t to = (size_t)args->group_row[group] * 3 * WISP_LANES + (size_t)half;
    quad_walk walks[WISP_MAX_GHOST_TARGETS];
    for ( int k = 0; k < links; ++k )
    {
        const int32_t* node = args->lane_node + ( group * links + k ) * WISP_LANES + half;
        walks[k] = begin_walk( node, args->lane_count + first, BLENDED_STRIDE );
    }
    const lane8 scale = lane8_loadu( args->centre_scale + first );
    for ( int i = 0; i < row_count; ++i )
    {
        const float* offset = args->offset + from + (size_t)i * (size_t)links * 3 * WISP_LANES;
        blended b = blend_row( args, group * links * WISP_LANES + half, walks, offset );
        const lane8 elastic = lane8_elastic( args->is_elastic, b.velocity, b.before );
        const lane8 centre = lane8_mul( scale, lane8v_length( load_offset( offset ) ) );
        const lane8 shared = lane8_add( elastic, b.tip );
        const lane8v sway = lane8v_scale( b.velocity, lane8_set1( args->sway_time ) );
        const lane8 factor = lane8_group_factor( shared, b.reach, lane8v_length( sway ), b.cap );
        store_place( args->points + to + (size_t)i * 3 * WISP_LANES,
                     lane8v_mul_add( b.base, lane8_add( shared, centre ), lane8v_scale( sway, factor ) ) );
    }
}

void KERNEL( strand_ghost_blend )( const wisp_strand_ghost_args* args, int begin, int end )
{
    for ( int group = begin; group < end; ++group )
    {
        blend_half( args, group, 0 );
        blend_half( args, group, 8 );
    }
}
