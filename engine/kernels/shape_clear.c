// Which edges and triangles may meet shapes in closed form, in a step and in a substep: what their corners say, eight at a time.
//
// A particle is FAR from a shape, or clear of one that is blunt against the thickness; ON_FACE, above a face of a box; or NEAR. A
// primitive whose corners all agree on FAR or on one face meets nothing: no point of it is much nearer than its corners. FAR is also who
// is so if its primitives are small: IF_SMALL.
#include "shape_lanes.h"

enum
{
    FAR = 0,
    ON_FACE = 1, // and five more
    NEAR = 7,
    IF_SMALL = 8,
    BITS = 4,   // of a shape
    SHAPES = 8, // the last are seen together
    LARGE = 4,  // times `away`: who is not small, but no larger
};

// Of the path of a particle: no longer one is expected in the rest of the step.
static const float PACE = 2.0f;

// A particle is above a face if it is so in front of it, or anywhere by more than `beyond`: then it belongs to the face that it is farthest
// above. What is above one face with all corners is nowhere nearer than these.
LANE_INLINE lane8i face_of( const wisp_shape_lanes* s, lane8v e, lane8 room, lane8 least, lane8 beyond )
{
    lane8i face = lane8i_set1( NEAR );
    lane8 at[3], inside[3], above[3], most = beyond;
    for ( int k = 0; k < 3; ++k )
    {
        at[k] = lane8v_dot( load_vector( s->axis[k], true ), e );
        above[k] = lane8_sub( lane8_abs( at[k] ), load_row( s->size[k], true ) );
        inside[k] = lane8_add( above[k], room );
    }
    for ( int k = 0; k < 3; ++k )
    {
        const lane8m is_beside = lane8_ge( lane8_max( inside[( k + 1 ) % 3], inside[( k + 2 ) % 3] ), lane8_zero() ),
                     is_in_front = lane8m_and_not( lane8_gt( above[k], least ), is_beside ),
                     is_above = lane8m_or( is_in_front, lane8_gt( above[k], most ) );
        const lane8i number = lane8i_select( lane8_lt( at[k], lane8_zero() ), lane8i_set1( ON_FACE + 2 * k ),
                                             lane8i_set1( ON_FACE + 2 * k + 1 ) );
        face = lane8i_select( is_above, number, face );
        most = lane8_max( above[k], most );
    }
    return face;
}

// Bounds by how much a point of a primitive may be nearer than the corners, from which it is not farther away than this: as in
// bound_around(), since sqrt( x^2 - a^2 ) >= x - a^2 / x.
LANE_INLINE lane8 how_near( const wisp_shape_lanes* s, wisp_shape_kind kind, float away )
{
    const lane8 a = lane8_set1( away );
    return kind == WISP_SHAPE_BOX ? a : lane8_min( a, lane8_div( lane8_mul( a, a ), blunt_radius( s, kind ) ) );
}

// @param longest m, no path is longer in the rest of the step, or in the substep
LANE_INLINE lane8i word_of( const wisp_clear_args* args, const wisp_shape_lanes* s, wisp_shape_kind kind,
                            bool is_blunt, lane8v p, lane8 ahead, lane8 longest )
{
    const lane8v e = lane8v_sub( p, load_vector( s->at, true ) );
    const lane8 found = nearest_to( s, kind, true, e ).distance, h = load_row( s->thickness, true );
    // in the rest of the step the shape moves, and what is seen from it
    const lane8 moved = lane8_mul_add( load_row( s->rate, true ), lane8v_length( e ), load_row( s->shift, true ) );
    const lane8 twice = lane8_mul( lane8_set1( 2.002f ), moved ),
                less = lane8_add( args->place != NULL ? ahead : lane8_zero(),
                                  lane8_mul_add( lane8_set1( 5.0f ), longest, twice ) ),
                above = lane8_mul_add( h, lane8_set1( 1.01f * ( STOP + LEFT_TO_CORNERS ) ), less );
    const lane8 nearer = how_near( s, kind, args->away ), larger = how_near( s, kind, LARGE * args->away );
    const lane8 beyond = lane8_mul_add( h, lane8_set1( 2.002f ), less ),
                least = is_blunt ? above : lane8_add( beyond, nearer ), most = lane8_add( beyond, larger );
    const lane8i far = lane8i_set1( FAR );
    if ( kind == WISP_SHAPE_BOX )
    {
        return lane8i_select( lane8_gt( found, most ), far,
                              face_of( s, e, lane8_add( ahead, twice ), above, beyond ) );
    }
    const lane8i if_small = lane8i_select( lane8_gt( found, least ), lane8i_set1( IF_SMALL ), lane8i_set1( NEAR ) );
    return lane8i_select( lane8_gt( found, most ), far, if_small );
}

LANE_INLINE lane8i say( const wisp_clear_args* args, int i, lane8v p, lane8 ahead, lane8 longest )
{
    const wisp_shape_lanes* s = args->shapes + i;
    const bool is_blunt = args->blunt[i];
    switch ( s->kind )
    {
        case WISP_SHAPE_BOX:
            return word_of( args, s, WISP_SHAPE_BOX, false, p, ahead, longest );
        case WISP_SHAPE_SPHERE:
            return word_of( args, s, WISP_SHAPE_SPHERE, is_blunt, p, ahead, longest );
        case WISP_SHAPE_CAPSULE:
            return word_of( args, s, WISP_SHAPE_CAPSULE, is_blunt, p, ahead, longest );
        default:
            return word_of( args, s, WISP_SHAPE_TAPERED_CAPSULE, is_blunt, p, ahead, longest );
    }
}

void KERNEL( clear_particles )( const wisp_clear_args* args, int begin, int end )
{
    for ( int slot = begin; slot < end; slot += LANES )
    {
        const size_t quad = (size_t)slot * 4;
        lane8v p, old;
        lane8 none;
        lane8_load_xyzw_contiguous( args->position + quad, &p.x, &p.y, &p.z, &none );
        lane8_load_xyzw_contiguous( args->previous + quad, &old.x, &old.y, &old.z, &none );
        const lane8 ahead = lane8_mul_add( lane8v_length( lane8v_sub( p, old ) ), lane8_set1( args->ahead ),
                                           lane8_set1( args->room ) );
        const lane8 longest = args->place != NULL ? lane8_mul( lane8_set1( PACE / args->ahead ), ahead ) : ahead;
        if ( args->place != NULL )
        {
            lane8_store_xyzw_contiguous( args->place + quad, p.x, p.y, p.z, lane8_neg( ahead ) );
        }
        lane8i words = args->first > 0 ? lane8i_loadu( args->words + slot ) : lane8i_set1( 0 );
        for ( int i = 0; i < args->count; ++i )
        {
            const lane8i word = say( args, i, p, ahead, longest ),
                         is_own = lane8i_set1( args->first + i < SHAPES - 1 ? -1 : 0 );
            const lane8m is_far = lane8i_eq( lane8i_and( word, lane8i_set1( NEAR ) ), lane8i_set1( FAR ) );
            const lane8i seen =
                lane8i_select( is_far, word, lane8i_or( word, lane8i_xor( is_own, lane8i_set1( -1 ) ) ) );
            const int place = args->first + i < SHAPES ? args->first + i : SHAPES - 1;
            words = lane8i_or( words, lane8i_mul( lane8i_and( seen, lane8i_set1( NEAR | IF_SMALL ) ),
                                                  lane8i_set1( (int32_t)( 1u << BITS * place ) ) ) );
        }
        lane8i_storeu( args->words + slot, words );
    }
}

// Loads what the corners of primitives say. @param far receives bits of the shapes that the first is FAR from
// @param small receives bits of those of which one is so if they are small
// @return bits of the shapes on which they do not agree, or of which one is NEAR
LANE_INLINE lane8i disagree( const wisp_primitive_paths* args, const int32_t* numbers, int corner_count, lane8i* far,
                             lane8i* small )
{
    int32_t first[LANES], other[LANES], any[LANES];
    for ( int l = 0; l < LANES; ++l )
    {
        const int32_t* corners = args->corners + (size_t)numbers[l] * (size_t)corner_count;
        const int32_t a = args->words[corners[0]], b = args->words[corners[1]],
                      c = corner_count == 3 ? args->words[corners[2]] : b;
        first[l] = a;
        any[l] = a | b | c;
        other[l] = ( a ^ b ) | ( a ^ c );
    }
    const lane8i w = lane8i_loadu( first ), d = lane8i_loadu( other ), each = lane8i_set1( 0x11111111 );
    const lane8i w1 = lane8i_shift_right( w, 1 ), w2 = lane8i_shift_right( w, 2 ),
                 near = lane8i_and( w, lane8i_and( w1, w2 ) );
    const lane8i differ = lane8i_or( lane8i_or( d, lane8i_shift_right( d, 1 ) ), lane8i_shift_right( d, 2 ) );
    *far = lane8i_and( lane8i_xor( lane8i_or( w, lane8i_or( w1, w2 ) ), each ), each );
    *small = lane8i_and( lane8i_shift_right( lane8i_loadu( any ), 3 ), each );
    return lane8i_and( lane8i_or( near, differ ), each );
}

// Bounds the squared distance of points of primitives from their nearest corner. @param ahead receives how far corners may get
LANE_INLINE lane8 size_of( const wisp_primitive_paths* args, const int32_t* numbers, int corner_count, lane8* ahead )
{
    int32_t quads[3][LANES];
    find_quads( args->corners, corner_count, numbers, LANES, quads );
    lane8v p[3];
    *ahead = lane8_zero();
    for ( int k = 0; k < corner_count; ++k )
    {
        lane8 room;
        lane8_load_xyzw( args->place != NULL ? args->place : args->position, quads[k], &p[k].x, &p[k].y, &p[k].z,
                         &room );
        *ahead = args->place != NULL ? lane8_max( lane8_neg( room ), *ahead ) : *ahead;
    }
    return spread_of( p, corner_count );
}

LANE_INLINE lane8m is_within( lane8 squared, lane8 most )
{
    return lane8m_and( lane8_gt( most, lane8_zero() ), lane8_lt( squared, lane8_mul( most, most ) ) );
}

// Lists primitives that may meet something in the rest of the step: twice their number, and 1 if they may get large.
LANE_INLINE int list_near( const wisp_primitive_paths* args, int corner_count, int begin, int end, int32_t* near )
{
    int found = 0;
    for ( int i = begin; i < end; i += LANES )
    {
        int32_t numbers[LANES], packed[LANES];
        for ( int l = 0; l < LANES; ++l )
        {
            numbers[l] = i + l < end ? i + l : i;
        }
        lane8 ahead;
        lane8i far, small;
        const lane8i look = disagree( args, numbers, corner_count, &far, &small ), zero = lane8i_set1( 0 );
        const lane8 size = size_of( args, numbers, corner_count, &ahead ), twice = lane8_add( ahead, ahead );
        const lane8m is_small = is_within( size, lane8_sub( lane8_set1( args->away ), twice ) ),
                     is_bounded = is_within( size, lane8_sub( lane8_set1( LARGE * args->away ), twice ) );
        const lane8m is_sure = lane8m_or( lane8m_or( is_small, lane8i_eq( far, zero ) ),
                                          lane8m_and( is_bounded, lane8i_eq( small, zero ) ) ),
                     is_clear = lane8m_and( is_sure, lane8i_eq( look, zero ) );
        const lane8i number = lane8i_loadu( numbers ),
                     listed = lane8i_add( lane8i_add( number, number ),
                                          lane8i_select( is_bounded, zero, lane8i_set1( 1 ) ) );
        const uint32_t bits = lane8m_bits( lane8m_and_not( lane8m_first( end - i ), is_clear ) );
        const int n = lane8i_compress_store( packed, listed, bits );
        memcpy( near + found, packed, (size_t)n * sizeof( *near ) );
        found += n;
    }
    return found;
}

// Selects of those that are listed the ones that may meet something in the substep.
LANE_INLINE int select_near( const wisp_primitive_paths* args, int corner_count, const int32_t* listed, int count,
                             int32_t* near, int32_t* looks )
{
    int found = 0;
    for ( int i = 0; i < count; i += LANES )
    {
        int32_t numbers[LANES], large[LANES], packed[LANES];
        for ( int l = 0; l < LANES; ++l )
        {
            const int32_t one = listed[i + l < count ? i + l : i];
            numbers[l] = one >> 1;
            large[l] = -( one & 1 );
        }
        lane8i far, small;
        const lane8i zero = lane8i_set1( 0 ), differ = disagree( args, numbers, corner_count, &far, &small ),
                     look = lane8i_or( differ, lane8i_and( far, lane8i_loadu( large ) ) );
        lane8i all = lane8i_or( look, small );
        // of those that are not looked at anyway
        if ( lane8m_any( lane8m_and_not( lane8i_eq( look, zero ), lane8i_eq( all, zero ) ) ) )
        {
            lane8 ahead;
            const lane8m is_small =
                is_within( size_of( args, numbers, corner_count, &ahead ), lane8_set1( args->away ) );
            all = lane8i_select( is_small, look, all );
        }
        const uint32_t bits = lane8m_bits( lane8m_and_not( lane8m_first( count - i ), lane8i_eq( all, zero ) ) );
        if ( bits != 0 )
        {
            const int n = lane8i_compress_store( packed, lane8i_loadu( numbers ), bits );
            memcpy( near + found, packed, (size_t)n * sizeof( *near ) );
            lane8i_compress_store( packed, all, bits );
            memcpy( looks + found, packed, (size_t)n * sizeof( *looks ) );
            found += n;
        }
    }
    return found;
}

int KERNEL( list_near_primitives )( const wisp_primitive_paths* args, int begin, int end, int32_t* near )
{
    return args->corner_count == 2 ? list_near( args, 2, begin, end, near ) : list_near( args, 3, begin, end, near );
}

int KERNEL( select_near_primitives )( const wisp_primitive_paths* args, const int32_t* listed, int count,
                                      int32_t* near, int32_t* looks )
{
    return args->corner_count == 2 ? select_near( args, 2, listed, count, near, looks )
                                   : select_near( args, 3, listed, count, near, looks );
}
