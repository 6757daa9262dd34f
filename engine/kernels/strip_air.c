// Air on triangles: drag along the relative wind and lift perpendicular to it, proportional to the projected area. A
// triangle of area A with unit normal n and mean velocity v, u = wind - v, has the force
//
//   F = 1/2 rho A |u . n| ( C_d u + C_l ( |u| n' - (u . n') / |u| u ) ),   n' = n or -n, with u . n' >= 0,
//
// so drag is 1/2 rho C_d A |u|^2 if u is along n, and lift is perpendicular to u. Each vertex has a third of it. Eight
// strips of triangles are walked side by side: a step reads one vertex, and writes the sum of the one that leaves.
#include "kernel_isa.h"

#define LANE_P lane8
#include "air_text.h"
#undef LANE_P

#define LANE_P lane16
#include "air_text.h"
#undef LANE_P

// A corner of the next triangle of a strip.
typedef struct air_corner
{
    lane8v point, velocity;
    lane8 drag, lift; // a third of the coefficients, if they differ between vertices
    lane8_air_sum sum;
} air_corner;

LANE_INLINE lane8m mask_of( unsigned bits )
{
    static const int32_t each[8] = { 1, 2, 4, 8, 16, 32, 64, 128 };
    const lane8i bit = lane8i_loadu( each );
    return lane8i_eq( lane8i_and( lane8i_set1( (int32_t)bits ), bit ), bit );
}

LANE_INLINE lane8 load_factors( const float* factor, const int32_t* slot_x4, float coefficient )
{
    float each[8];
    for ( int l = 0; l < 8; ++l )
    {
        each[l] = factor != NULL ? factor[slot_x4[l] / 4] : 1.0f;
    }
    return lane8_mul( lane8_loadu( each ), lane8_set1( coefficient / 3.0f ) );
}

LANE_INLINE air_corner load_corner( const wisp_strip_air_args* args, int step, bool mapped )
{
    const int32_t* slot_x4 = args->strips.next_x4[step];
    air_corner c;
    lane8_load_xyz( args->position, slot_x4, &c.point.x, &c.point.y, &c.point.z );
    lane8_load_xyz( args->velocity, slot_x4, &c.velocity.x, &c.velocity.y, &c.velocity.z );
    if ( mapped )
    {
        c.drag = load_factors( args->drag_factor, slot_x4, args->drag );
        c.lift = load_factors( args->lift_factor, slot_x4, args->lift );
    }
    return c;
}

LANE_INLINE air_corner select_corner( lane8m m, const air_corner* a, const air_corner* b, bool mapped )
{
    air_corner c;
    c.point = lane8v_select( m, a->point, b->point );
    c.velocity = lane8v_select( m, a->velocity, b->velocity );
    c.sum.force = lane8v_select( m, a->sum.force, b->sum.force );
    c.sum.rate = lane8_select( m, a->sum.rate, b->sum.rate );
    if ( mapped )
    {
        c.drag = lane8_select( m, a->drag, b->drag );
        c.lift = lane8_select( m, a->lift, b->lift );
    }
    return c;
}

// @param mapped vertices have factors of the coefficients; a triangle has the mean of its corners
LANE_INLINE void walk_strips( const wisp_strip_air_args mine, int begin, int end, bool lifts, bool mapped )
{
    const lane8v nothing = { lane8_zero(), lane8_zero(), lane8_zero() };
    const lane8v wind_x3 = lane8v_scale( lane8v_set1( mine.wind ), lane8_set1( 3.0f ) );
    lane8 drag = lane8_set1( mine.drag ), lift = lane8_set1( mine.lift );
    air_corner a = { nothing, nothing, lane8_zero(), lane8_zero(), { nothing, lane8_zero() } }, b = a;
    for ( int step = begin; step < end; ++step )
    {
        const unsigned flags = mine.strips.flags[step];
        air_corner c = load_corner( &mine, step, mapped );
        const lane8v u = lane8v_sub( lane8v_sub( lane8v_sub( wind_x3, a.velocity ), b.velocity ), c.velocity );
        const lane8v across = lane8v_cross( lane8v_sub( b.point, a.point ), lane8v_sub( c.point, a.point ) );
        if ( mapped )
        {
            drag = lane8_add( lane8_add( a.drag, b.drag ), c.drag );
            lift = lane8_add( lane8_add( a.lift, b.lift ), c.lift );
        }
        c.sum = lane8_triangle_air( lane8v_select( mask_of( flags & 255 ), across, nothing ), u, drag, lift, lifts );
        a.sum = lane8_add_air( a.sum, c.sum );
        b.sum = lane8_add_air( b.sum, c.sum );
        const lane8m first_stays = mask_of( flags >> 8 );
        lane8 leaving[4] = { lane8_select( first_stays, b.sum.force.x, a.sum.force.x ),
                             lane8_select( first_stays, b.sum.force.y, a.sum.force.y ),
                             lane8_select( first_stays, b.sum.force.z, a.sum.force.z ),
                             lane8_select( first_stays, b.sum.rate, a.sum.rate ) };
        lane8_transpose_quads( leaving );
        lane8_add_quads( mine.sum, mine.strips.leaving_x4[step], leaving );
        a = select_corner( first_stays, &a, &b, mapped );
        b = c;
    }
}

void KERNEL( strip_air )( const wisp_strip_air_args* args, int begin, int end )
{
    if ( args->drag_factor != NULL || args->lift_factor != NULL )
    {
        walk_strips( *args, begin, end, true, true );
    }
    else if ( args->lift > 0.0f )
    {
        walk_strips( *args, begin, end, true, false );
    }
    else
    {
        walk_strips( *args, begin, end, false, false );
    }
}

void KERNEL( blow )( const wisp_strip_air_args* args, int begin, int end )
{
    const lane8 dt = lane8_set1( args->dt ), density = lane8_set1( args->density );
    const lane8m every = lane8_le( dt, dt );
    const bool lifts = args->lift > 0.0f;
    for ( size_t at = (size_t)begin * 32; at < (size_t)end * 32; at += 32 )
    {
        lane8v point, old;
        lane8 weight, rest;
        lane8_air_sum sum;
        lane8_load_xyzw_contiguous( args->position + at, &point.x, &point.y, &point.z, &weight );
        lane8_load_xyzw_contiguous( args->velocity + at, &old.x, &old.y, &old.z, &rest );
        lane8_load_xyzw_contiguous( args->sum + at, &sum.force.x, &sum.force.y, &sum.force.z, &sum.rate );
        const lane8v blown = lane8_blow( lane8v_set1( args->wind ), density, old, weight, dt, &sum, lifts, every );
        lane8_store_xyzw_contiguous( args->velocity + at, blown.x, blown.y, blown.z, rest );
    }
}

// ---- instances side by side ----

enum
{
    LANES = WISP_INSTANCE_LANES,
    ROW = 4 * LANES,
    VECTOR = 3 * LANES,
};

LANE_INLINE lane16_air_sum load_sum( const float* from )
{
    return ( lane16_air_sum ){ lane16v_load( from ), lane16_load( from + VECTOR ) };
}

LANE_INLINE void store_sum( float* to, lane16_air_sum a )
{
    lane16v_store( to, a.force );
    lane16_store( to + VECTOR, a.rate );
}

// One of the eight strips that a fabric has side by side: its triangles are in the same order for instances.
typedef struct instance_strip
{
    _Alignas( 64 ) float sum[3][ROW];
    int32_t slot[3]; // of the corners of the next triangle
    int a, b, free;
} instance_strip;

LANE_INLINE void walk_instances( const wisp_instances_air_args* air, const wisp_instances_args* args, lane16v wind,
                                 bool lifts )
{
    const lane16v wind_x3 = lane16v_scale( wind, lane16_set1( 3.0f ) );
    const lane16_air_sum nothing = { { lane16_zero(), lane16_zero(), lane16_zero() }, lane16_zero() };
    instance_strip strips[8];
    for ( int l = 0; l < 8; ++l )
    {
        strips[l].slot[0] = strips[l].slot[1] = args->slot_count - 1;
        strips[l].a = 0, strips[l].b = 1, strips[l].free = 2;
        store_sum( strips[l].sum[0], nothing );
        store_sum( strips[l].sum[1], nothing );
    }
    for ( int at = 0; at < 8 * air->strips.order.slot_count; ++at )
    {
        const int step = at / 8, l = at % 8;
        instance_strip* s = strips + l;
        const int a = s->a, b = s->b, c = s->free;
        s->slot[c] = air->strips.next_x4[step][l] / 4;
        lane16_air_sum own = nothing;
        if ( ( air->strips.flags[step] >> l & 1 ) != 0 )
        {
            const float *p = args->position, *v = args->velocity;
            const size_t i = (size_t)s->slot[a], j = (size_t)s->slot[b], k = (size_t)s->slot[c];
            const lane16v u = lane16v_sub(
                lane16v_sub( lane16v_sub( wind_x3, lane16v_load( v + i * VECTOR ) ), lane16v_load( v + j * VECTOR ) ),
                lane16v_load( v + k * VECTOR ) );
            const lane16v first = lane16v_load( p + i * ROW );
            const lane16v across = lane16v_cross( lane16v_sub( lane16v_load( p + j * ROW ), first ),
                                                  lane16v_sub( lane16v_load( p + k * ROW ), first ) );
            own = lane16_triangle_air( across, u, lane16_loadu( air->drag ), lane16_loadu( air->lift ), lifts );
            store_sum( s->sum[a], lane16_add_air( load_sum( s->sum[a] ), own ) );
            store_sum( s->sum[b], lane16_add_air( load_sum( s->sum[b] ), own ) );
        }
        store_sum( s->sum[c], own );
        const bool first_stays = ( air->strips.flags[step] >> ( 8 + l ) & 1 ) != 0;
        s->free = first_stays ? b : a;
        s->a = first_stays ? a : b;
        s->b = c;
        float* to = air->sum + (size_t)( air->strips.leaving_x4[step][l] / 4 ) * ROW;
        store_sum( to, lane16_add_air( load_sum( to ), load_sum( s->sum[s->free] ) ) );
    }
}

void KERNEL( instances_air )( const wisp_instances_args* args, const wisp_instances_air_args* air )
{
    const lane16 dt = lane16_set1( args->dt );
    const lane16m lifting = lane16_lt( lane16_zero(), lane16_loadu( air->lift ) );
    const bool lifts = lane16m_any( lifting );
    const lane16v wind = { lane16_loadu( air->wind ), lane16_loadu( air->wind + LANES ),
                           lane16_loadu( air->wind + 2 * LANES ) };
    lifts ? walk_instances( air, args, wind, true ) : walk_instances( air, args, wind, false );
    for ( size_t slot = 0; slot < (size_t)args->slot_count; ++slot )
    {
        const lane16_air_sum sum = load_sum( air->sum + slot * ROW );
        const lane16v old = lane16v_load( args->velocity + slot * VECTOR );
        const lane16 weight = lane16_load( args->position + slot * ROW + 3 * LANES );
        lane16v_store( args->velocity + slot * VECTOR,
                       lane16_blow( wind, lane16_loadu( air->density ), old, weight, dt, &sum, lifts, lifting ) );
    }
}
