// Rods, part of strand_rod.c: frames, vertices that fold back, and the twist in equilibrium.
#pragma once

#include "strand_rod_rows.h"

// ---- frames and twist ----

static frame16 clamp_frame( const wisp_strand_rod_args* args, int group )
{
    return frame16_multiply( frame16_load( args->root + (size_t)group * QUATERNION ),
                             frame16_load( args->clamp + (size_t)group * QUATERNION ) );
}

// Returns the frame of the segment before vertex 0: the clamp, of a closed strand its last segment.
static frame16 frame_before_root( const wisp_strand_rod_args* args, int group, int first, int last )
{
    frame16 q = clamp_frame( args, group );
    for ( int row = first; row + 1 < last && args->response != NULL; ++row )
    {
        q = frame16_select( loop16_ends( args->inverse_length, row ),
                            frame16_load( args->frame + (size_t)row * QUATERNION ), q );
    }
    return q;
}

// Transports a segment's frame to its current direction; a segment without length keeps its frame.
static frame16 transport_frame( const wisp_strand_rod_args* args, int row, lane16v e )
{
    const frame16 q = frame16_load( args->frame + (size_t)row * QUATERNION );
    const lane16 squared = lane16v_dot( e, e );
    lane16m has_length = lane16_lt( lane16_set1( 1e-30f ), squared );
    if ( args->tip != NULL ) // the frame of a tip is given
    {
        has_length = lane16m_and( has_length, lane16_lt( lane16_zero(), lanes_of( args->inverse_length, row ) ) );
    }
    return frame16_select( has_length, frame16_transport( q, e, lane16_sqrt( squared ) ), q );
}

// ---- vertices that fold back ----

// A vertex fades where its fold 1 + t_{i-1} . t_i is below this fraction of that at rest, which is taken as 1 at
// most and so much at least; no further than to the last of these fractions of where it begins.
#define FADE_BEGIN 0.25f
#define MIN_FOLD_AT_REST 0.2f
#define MIN_FADE 0.1f

// The share w_i of rest curvature and twist that a vertex keeps, and its derivative by the fold.
typedef struct fading
{
    lane16 share, slope;
} fading;

LANE_INLINE lane16m is_folded( lane16 fold )
{
    return lane16_lt( fold, lane16_set1( FADE_BEGIN ) );
}

// Computes w = f (2 - f), where f falls from 1 to 0 as the vertex folds back.
static fading fade_vertex( const wisp_strand_rod_args* args, int row, lane16 fold )
{
    const lane16 one = lane16_set1( 1.0f ), two = lane16_set1( 2.0f );
    const lane16v rest = lane16v_load( args->rest + (size_t)row * STRIDE );
    const lane16 at_rest = lane16_sub( two, lane16_mul( lane16_set1( 0.5f ), lane16v_dot( rest, rest ) ) );
    const lane16 bound = lane16_max( lane16_set1( MIN_FOLD_AT_REST ), lane16_min( one, at_rest ) );
    const lane16 inverse = lane16_div( lane16_set1( 1.0f / FADE_BEGIN ), bound );
    const lane16 f = lane16_max( lane16_set1( MIN_FADE ), lane16_min( one, lane16_mul( fold, inverse ) ) );
    return ( fading ){ lane16_mul( f, lane16_sub( two, f ) ),
                       lane16_mul( lane16_mul( two, inverse ), lane16_sub( one, f ) ) };
}

// What a vertex adds to the gradients by its two segments.
typedef struct turning
{
    lane16v before, behind;
} turning;

// Adds what a vertex gains by unfolding: the energy changes with w too.
// @param section scratch of the row's section, null: circular
static turning unfold_vertex( const wisp_strand_rod_args* args, int row, frame16 before, frame16 behind,
                              lane16 moment, const float* at, const float* section, turning sum )
{
    const lane16 one = lane16_set1( 1.0f ), half = lane16_set1( 0.5f );
    const lane16v a = direction_of_frame( before ), b = direction_of_frame( behind );
    const lane16 cosine = lane16v_dot( a, b );
    const fading fade = fade_vertex( args, row, lane16_add( one, cosine ) );
    const lane16 relative = lane16_div( fade.slope, fade.share );
    const lane16v k = lane16v_load( at + REST_VECTOR );
    const lane16v less = lane16v_sub( k, lane16v_sub( b, a ) ); // -C_i
    lane16 gain = lane16v_dot( k, less );
    if ( section != NULL )
    {
        const lane16v soft = lane16v_load( section + SOFT );
        const lane16 own = lane16v_dot( less, soft );
        const lane16 changed = lane16_add( lane16v_dot( k, soft ), lane16_mul( half, own ) );
        gain = lane16_sub( gain, lane16_mul( own, changed ) );
    }
    const lane16 bend = lane16_mul( lanes_of( args->stiffness, row ), gain );
    const lane16 rigidity = lane16_max( lanes_of( args->twist_stiffness, row ), lane16_set1( 1e-30f ) );
    const lane16 twist =
        lane16_div( lane16_mul( half, lane16_mul( moment, moment ) ), lane16_mul( rigidity, fade.share ) );
    const lane16 pull = lane16_mul( lane16_add( relative, relative ), lane16_add( bend, twist ) );
    return ( turning ){ lane16v_mul_add( sum.before, pull, lane16v_sub( b, lane16v_scale( a, cosine ) ) ),
                        lane16v_mul_add( sum.behind, pull, lane16v_sub( a, lane16v_scale( b, cosine ) ) ) };
}

// ---- twist ----

// Measures vertex i between two frames: rest vector, twist moment, and the load and slope of bending on the twist.
// Directions have length 1, whatever the lengths of segments.
// @param section scratch of the row's section, null: circular
// @return whether the vertex of any lane folds back
LANE_INLINE bool measure_vertex( const wisp_strand_rod_args* args, int row, frame16 a, frame16 b, lane16v from,
                                 lane16v to, float* out, float* section )
{
    const lane16v bend = lane16v_sub( to, from );
    const lane16 zero = lane16_zero(), two = lane16_set1( 2.0f );
    const lane16m opposed = lane16_lt( frame16_dot( a, b ), zero );
    b = frame16_select( opposed, frame16_scale( b, lane16_set1( -1.0f ) ), b );
    const lane16 rw = frame16_dot( a, b );
    // |a + b|^2 = 2 + 2 a.b, and both are in one hemisphere, so it is at least 2
    const frame16 middle = frame16_add( a, b );
    const lane16 shrink = lane16_div( lane16_set1( 0.5f ), lane16_add( lane16_set1( 1.0f ), rw ) );
    const lane16 fold = lane16_add( lane16_set1( 1.0f ), lane16v_dot( from, to ) );
    const bool folds = lane16m_any( is_folded( fold ) );
    lane16v rest = lane16v_scale( lane16v_load( args->rest + (size_t)row * STRIDE ), shrink );
    lane16 rigidity = lanes_of( args->twist_stiffness, row ), flatness = lane16_set1( args->flatness );
    if ( folds )
    {
        const fading fade = fade_vertex( args, row, fold );
        rest = lane16v_scale( rest, fade.share );
        rigidity = lane16_mul( rigidity, fade.share );
        flatness = lane16_mul( flatness, lane16_sqrt( fade.share ) );
    }
    const lane16v k = frame16_turn( middle, rest );
    const lane16v turned = lane16v_scale( lane16v_cross( frame16_z( middle ), k ), shrink );

    // z component of conj( a ) b, less the rest twist
    const lane16 rz = lane16_add( lane16_sub( lane16_mul( a.w, b.z ), lane16_mul( a.z, b.w ) ),
                                  lane16_sub( lane16_mul( a.y, b.x ), lane16_mul( a.x, b.y ) ) );
    const float* rest_twist = args->rest_twist + (size_t)row * 2 * WISP_LANES;
    const lane16 c = lane16_load( rest_twist ), s = lane16_load( rest_twist + WISP_LANES );
    const lane16 z = lane16_sub( lane16_mul( rz, c ), lane16_mul( rw, s ) );
    const lane16 w = lane16_add( lane16_mul( rw, c ), lane16_mul( rz, s ) );
    // the tangent diverges at half a turn, so it is clamped at a twist of 170 degrees
    const lane16 whole = lane16_max( lane16_abs( w ), lane16_set1( 0.087f ) );
    const lane16 sign = lane16_select( lane16_lt( w, zero ), lane16_set1( -2.0f ), two );
    const lane16 twist = lane16_div( lane16_mul( sign, z ), whole );

    // the binormal diverges where a strand folds back, so it is clamped at 154 degrees
    const lane16 fraction = lane16_div( two, lane16_max( fold, lane16_set1( 0.1f ) ) );
    lane16v_store( out + BINORMAL, lane16v_scale( lane16v_cross( from, to ), fraction ) );

    const lane16 stiffness = lanes_of( args->stiffness, row );
    lane16v_store( out + REST_VECTOR, k );
    lane16v_store( out + TURNED, turned );
    lane16_store( out + MOMENT, lane16_mul( rigidity, twist ) );
    lane16_store( out + RATIO, lane16_mul( rw, shrink ) );
    lane16 load = lane16v_dot( bend, turned ), slope = lane16v_dot( bend, k );
    if ( section != NULL )
    {
        const lane16v along = { lane16_mul( flatness, shrink ), zero, zero };
        const lane16v soft = frame16_turn( middle, along );
        const lane16v edge = lane16v_scale( lane16v_cross( frame16_z( middle ), soft ), shrink );
        const lane16 own = lane16v_dot( lane16v_sub( bend, k ), soft ), across = lane16v_dot( bend, edge );
        load = lane16_mul_add( own, across, load );
        slope = lane16_sub( lane16_mul_add( own, lane16v_dot( bend, soft ), slope ), lane16_mul( across, across ) );
        lane16v_store( section + SOFT, soft );
        lane16v_store( section + EDGE, edge );
        lane16_store( section + ACROSS, own );
        lane16_store( section + ALONG, across );
    }
    lane16_store( out + LOAD, lane16_neg( lane16_mul( stiffness, load ) ) );
    lane16_store( out + SLOPE,
                  lane16_mul( lane16_set1( 0.25f ), lane16_mul( stiffness, lane16_max( zero, slope ) ) ) );
    return folds;
}

// Transports frames before vertices are measured. Frames depend only on their own segment, so more of them run in
// parallel.
static void transport_frames( const wisp_strand_rod_args* args, lane16 back, int first, int last )
{
    for ( int row = first; row + 1 < last; ++row )
    {
        const lane16v along = lane16v_scale( unaccelerated( args, row, back ), lane16_set1( -1.0f ) );
        frame16_store( args->frame + (size_t)row * QUATERNION, transport_frame( args, row, along ) );
    }
}

// @return whether any vertex folds back
static bool measure_frames( const wisp_strand_rod_args* args, const step_lanes* step, int group, int first, int last )
{
    bool folds = false;
    const lane16 back = acceleration_offset( args, step, group );
    transport_frames( args, back, first, last );
    frame16 before = frame_before_root( args, group, first, last );
    lane16v t_before = frame16_z( before );
    float* out = args->scratch;
    for ( int row = first; row < bending_end( args, last ); ++row, out += ROW )
    {
        const frame16 q = frame16_load( args->frame + (size_t)row * QUATERNION );
        const lane16v t = frame16_z( q );
        const bool folded = args->flatness > 0.0f ? measure_vertex( args, row, before, q, t_before, t, out,
                                                                    section_of( args, row, first ) )
                                                  : measure_vertex( args, row, before, q, t_before, t, out, NULL );
        folds = folded || folds;
        before = q;
        t_before = t;
    }
    return folds;
}

// Assembles one Newton step of T_s - T_{s+1} + (b_s + b_{s+1}) / 2 = 0 over the rotations of the segments; the
// clamp is fixed.
static void balance_twist( const wisp_strand_rod_args* args, int first, int last )
{
    const lane16 zero = lane16_zero(), half = lane16_set1( 0.5f ), one = lane16_set1( 1.0f );
    const lane16 least = lane16_set1( 1e-30f );
    lane16 coupling = zero, eliminated = zero;
    for ( int row = first; row + 1 < last; ++row )
    {
        float* at = args->scratch + (size_t)( row - first ) * ROW;
        lane16 moment = zero, load = zero, twist = zero, slope = zero;
        if ( row + 1 < bending_end( args, last ) )
        {
            moment = lane16_load( at + ROW + MOMENT );
            load = lane16_load( at + ROW + LOAD );
            twist = lanes_of( args->twist_stiffness, row + 1 );
            slope = lane16_load( at + ROW + SLOPE );
        }
        const lane16 own_twist = lanes_of( args->twist_stiffness, row ), own_slope = lane16_load( at + SLOPE );
        const lane16 out_of_balance = lane16_add( lane16_sub( lane16_load( at + MOMENT ), moment ),
                                                  lane16_mul( half, lane16_add( lane16_load( at + LOAD ), load ) ) );
        const lane16 off = lane16_sub( own_slope, own_twist ); // coupling to the previous segment; none to the clamp
        const lane16 pivot = lane16_sub( lane16_add( lane16_add( own_twist, own_slope ), lane16_add( twist, slope ) ),
                                         row > first ? lane16_mul( off, coupling ) : zero );
        lane16m turns = lane16_lt( least, pivot );
        if ( args->tip != NULL ) // the frame of a tip is given
        {
            turns = lane16m_and( turns, lane16_lt( zero, lanes_of( args->inverse_length, row ) ) );
        }
        const lane16 inverse = lane16_select( turns, lane16_div( one, pivot ), zero );
        eliminated = lane16_mul(
            lane16_neg( lane16_add( out_of_balance, row > first ? lane16_mul( off, eliminated ) : zero ) ), inverse );
        coupling = lane16_mul( lane16_sub( slope, twist ), inverse );
        lane16_store( at + TURN, eliminated );
        lane16_store( at + COUPLING, coupling );
    }
}

// Substitutes back from the tip, and segments rotate about themselves.
// @return lanes whose strand comes to balance
static lane16m turn_segments( const wisp_strand_rod_args* args, int first, int last )
{
    const lane16 half = lane16_set1( 0.5f );
    const lane16 most = lane16_set1( 1.0f );
    lane16 behind = lane16_zero();
    lane16m balanced = lane16_le( behind, most );
    for ( int row = last - 2; row >= first; --row )
    {
        float* at = args->scratch + (size_t)( row - first ) * ROW;
        lane16 turn = lane16_sub( lane16_load( at + TURN ), lane16_mul( lane16_load( at + COUPLING ), behind ) );
        behind = turn;
        balanced = lane16m_and( balanced, lane16_le( lane16_abs( turn ), most ) );
        turn = lane16_max( lane16_neg( most ), lane16_min( most, turn ) ); // at most one radian per substep; NaN
                                                                           // becomes one
        if ( args->tip != NULL )
        {
            turn = lane16_select( lane16_lt( lane16_zero(), lanes_of( args->inverse_length, row ) ), turn,
                                  lane16_zero() ); // NaN turns no tip
        }
        lane16_store( at + TURN, turn );
        // multiply by ( 0, 0, tan, 1 ); the next transport normalises
        const lane16 s = lane16_mul( half, turn );
        float* frame = args->frame + (size_t)row * QUATERNION;
        const frame16 q = frame16_load( frame );
        frame16_store( frame, ( frame16 ){ lane16_mul_add( s, q.y, q.x ), lane16_sub( q.y, lane16_mul( s, q.x ) ),
                                           lane16_mul_add( s, q.w, q.z ), lane16_sub( q.w, lane16_mul( s, q.z ) ) } );
    }
    return balanced;
}

// Returns how far the last segment of a closed strand turned.
static lane16 turn_of_joint( const wisp_strand_rod_args* args, int first, int last )
{
    lane16 turn = lane16_zero();
    for ( int row = first; row + 1 < last; ++row )
    {
        const float* at = args->scratch + (size_t)( row - first ) * ROW;
        turn = lane16_select( loop16_ends( args->inverse_length, row ), lane16_load( at + TURN ), turn );
    }
    return turn;
}

// Rotates the soft axis about the middle tangent, to first order and without changing its length.
LANE_INLINE void turn_section( float* section, lane16 turn )
{
    const lane16 one = lane16_set1( 1.0f );
    const lane16 shorter = lane16_div( one, lane16_sqrt( lane16_mul_add( turn, turn, one ) ) );
    const lane16v soft = lane16v_mul_add( lane16v_load( section + SOFT ), turn, lane16v_load( section + EDGE ) );
    const lane16 across = lane16_mul_add( turn, lane16_load( section + ALONG ), lane16_load( section + ACROSS ) );
    lane16v_store( section + SOFT, lane16v_scale( soft, shorter ) );
    lane16_store( section + ACROSS, lane16_mul( across, shorter ) );
}

// Rotates what was measured with the segments, and computes what twist and rest curvature add to the gradients. Where
// the turns were limited, twist is not in balance yet: its moment is what the limit left over, and would throw the
// strand about, so it has none in this substep.
static void turn_vertices( const wisp_strand_rod_args* args, int group, int first, int last, lane16m balanced,
                           bool folds )
{
    const lane16 zero = lane16_zero(), half = lane16_set1( 0.5f ), four = lane16_set1( 4.0f );
    lane16 before = args->response != NULL ? turn_of_joint( args, first, last ) : zero;
    lane16v behind = { zero, zero, zero }, joint = behind;
    float* at = args->scratch;
    for ( int row = first; row < bending_end( args, last ); ++row, at += ROW )
    {
        const lane16 turn = row + 1 < last ? lane16_load( at + TURN ) : zero;
        const lane16 middle = lane16_mul( half, lane16_add( before, turn ) );
        float* section = args->flatness > 0.0f ? section_of( args, row, first ) : NULL;
        if ( section != NULL )
        {
            turn_section( section, middle );
        }
        lane16v_store( at + REST_VECTOR,
                       lane16v_mul_add( lane16v_load( at + REST_VECTOR ), middle, lane16v_load( at + TURNED ) ) );
        const lane16 twisted = lane16_mul( lanes_of( args->twist_stiffness, row ), lane16_sub( turn, before ) );
        const lane16 moment = lane16_select( balanced, lane16_add( lane16_load( at + MOMENT ), twisted ), zero );
        const lane16 load =
            lane16_mul_add( lane16_mul( four, middle ), lane16_load( at + SLOPE ), lane16_load( at + LOAD ) );
        const lane16 lateral = lane16_mul( lane16_load( at + RATIO ), load );
        const lane16v binormal = lane16v_load( at + BINORMAL );
        turning own = { lane16v_scale( binormal, lane16_sub( moment, lateral ) ),
                        lane16v_scale( binormal, lane16_add( moment, lateral ) ) };
        if ( folds )
        {
            const float* frame = args->frame + (size_t)row * QUATERNION;
            own = unfold_vertex( args, row,
                                 row > first ? frame16_load( frame - QUATERNION )
                                             : frame_before_root( args, group, first, last ),
                                 frame16_load( frame ), moment, at, section, own );
        }
        if ( row > first )
        {
            lane16v_store( at - ROW + TURNING, lane16v_add( behind, own.before ) );
        }
        joint = row > first ? joint : own.before;
        behind = own.behind;
        before = turn;
    }
    lane16v_store( at - ROW + TURNING, behind );
    for ( int row = first; row + 1 < last && args->response != NULL; ++row )
    {
        float* out = args->scratch + (size_t)( row - first ) * ROW + TURNING;
        const lane16v own = lane16v_load( out );
        lane16v_store( out,
                       lane16v_select( loop16_ends( args->inverse_length, row ), lane16v_add( own, joint ), own ) );
    }
}
