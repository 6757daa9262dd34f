// Bending across interior edges, eight hinges at a time. The hinges of a group share no particle.
#include "kernel_isa.h"
#include "lane_trig.h"

// Squared gradients below this fraction of the largest are ignored.
#define MIN_LEVER 1e-6f
// A projection turns a hinge by at most this, in rad. Its vertices move along tangents, so a turn of a quarter lengthens the
// triangles by 3 %, and half a turn threefold: tiny stiff meshes would gain energy without bound.
#define MAX_TURN 0.25f
// Hinges that may turn a vertex in a flattened triangle at the same time.
#define AT_ONCE 8.0f

enum
{
    END_I, // ends of the edge
    END_J,
    OPPOSITE_K, // in the triangle (i, j, k)
    OPPOSITE_L, // in the triangle (j, i, l)
    CORNERS,
};

typedef struct corners
{
    lane8v point[CORNERS];
    lane8 weight[CORNERS]; // inverse masses
} corners;

LANE_INLINE corners load_corners( const float* position, const int32_t* slots_x4, int hinge )
{
    corners c;
    for ( int k = 0; k < CORNERS; ++k )
    {
        const int32_t* slot_x4 = slots_x4 + (size_t)hinge * CORNERS + 8 * k;
        lane8_load_xyzw( position, slot_x4, &c.point[k].x, &c.point[k].y, &c.point[k].z, &c.weight[k] );
    }
    return c;
}

LANE_INLINE void move_corners( const wisp_hinge_args* args, int hinge, const corners* c,
                               const lane8v gradient[CORNERS], lane8 step )
{
    for ( int k = 0; k < CORNERS; ++k )
    {
        const int32_t* slot_x4 = args->slot_x4 + (size_t)hinge * CORNERS + 8 * k;
        lane8v moved = lane8v_mul_add( c->point[k], lane8_mul( c->weight[k], step ), gradient[k] );
        lane8_store_xyzw( args->position, slot_x4, moved.x, moved.y, moved.z, c->weight[k] );
    }
}

// Computes the change of lambda for a constraint C with sum of w |gradient|^2: -k C / sum in pbd, -(C + a lambda) /
// (sum + a) in xpbd. Never more than `largest`; 0 where the hinge is not usable.
LANE_INLINE lane8 change_of_lambda( const wisp_hinge_args* args, int hinge, lane8 error, lane8 sum, lane8 largest,
                                    lane8m usable )
{
    usable = lane8m_and( usable, lane8_ge( sum, lane8_set1( FLT_MIN ) ) );
    if ( args->stiffness != NULL )
    {
        error = lane8_mul( error, lane8_loadu( args->stiffness + hinge ) );
    }
    else
    {
        lane8 alpha = lane8_mul( lane8_loadu( args->compliance + hinge ), lane8_set1( args->inverse_dt2 ) );
        sum = lane8_add( sum, alpha );
        error = args->lambda != NULL ? lane8_mul_add( alpha, lane8_loadu( args->lambda + hinge ), error ) : error;
    }
    lane8 change = lane8_neg( lane8_div( error, lane8_select( usable, sum, lane8_set1( 1.0f ) ) ) );
    change = lane8_max( lane8_min( change, largest ), lane8_neg( largest ) );
    change = lane8_select( usable, change, lane8_zero() );
    if ( args->stiffness == NULL && args->lambda != NULL )
    {
        lane8_storeu( args->lambda + hinge, lane8_add( lane8_loadu( args->lambda + hinge ), change ) );
    }
    return change;
}

LANE_INLINE lane8 weighted_square( const corners* c, const lane8v gradient[CORNERS] )
{
    lane8 sum = lane8_zero();
    for ( int k = 0; k < CORNERS; ++k )
    {
        sum = lane8_mul_add( c->weight[k], lane8v_dot( gradient[k], gradient[k] ), sum );
    }
    return sum;
}

// Wraps an angle to [-pi, pi], from at most a turn outside, as the difference of two angles is.
LANE_INLINE lane8 wrap_angle( lane8 angle )
{
    const lane8 pi = lane8_set1( 3.14159265f ), turn = lane8_set1( 6.28318531f );
    angle = lane8_select( lane8_gt( angle, pi ), lane8_sub( angle, turn ), angle );
    return lane8_select( lane8_lt( angle, lane8_neg( pi ) ), lane8_add( angle, turn ), angle );
}

// Minimum squared length of an edge, and of a triangle's height over an edge, in m^2. Below it their gradients are
// rounding errors, and their squares could overflow.
#define SMALLEST_SQUARE 1e-30f

// Area vectors of the two triangles, and their position relative to the edge.
typedef struct fold
{
    lane8v n1, n2;        // twice the area vectors of (i, j, k) and (j, i, l), m^2
    lane8 n1n1, n2n2;     // their squared lengths, 1 where not usable
    lane8 length;         // of the edge, m
    lane8 foot_k, foot_l; // projection of the opposite vertices on the edge: 0 at i, 1 at j
    lane8 angle;          // rad
    lane8m usable;
} fold;

// Computes the geometry of a hinge. With n1 = e x ki and n2 = li x e, n2 x n1 = e (li . n1), so the sine needs no
// third cross product.
LANE_INLINE fold measure_fold( const corners* c )
{
    const lane8 one = lane8_set1( 1.0f ), smallest = lane8_set1( SMALLEST_SQUARE ), tiny = lane8_set1( FLT_MIN );
    lane8v edge = lane8v_sub( c->point[END_J], c->point[END_I] );
    lane8v ki = lane8v_sub( c->point[OPPOSITE_K], c->point[END_I] );
    lane8v li = lane8v_sub( c->point[OPPOSITE_L], c->point[END_I] );
    fold f = { .n1 = lane8v_cross( edge, ki ), .n2 = lane8v_cross( li, edge ) };
    lane8 ee = lane8v_dot( edge, edge ), n1n1 = lane8v_dot( f.n1, f.n1 ), n2n2 = lane8v_dot( f.n2, f.n2 );
    lane8 least = lane8_mul_add( smallest, ee, tiny );
    f.usable = lane8m_and( lane8_ge( ee, smallest ), lane8m_and( lane8_ge( n1n1, least ), lane8_ge( n2n2, least ) ) );
    ee = lane8_select( f.usable, ee, one );
    f.n1n1 = lane8_select( f.usable, n1n1, one );
    f.n2n2 = lane8_select( f.usable, n2n2, one );
    f.length = lane8_sqrt( ee );
    lane8 per_ee = lane8_div( one, ee );
    f.foot_k = lane8_mul( lane8v_dot( ki, edge ), per_ee );
    f.foot_l = lane8_mul( lane8v_dot( li, edge ), per_ee );
    f.angle = lane8_atan2( lane8_mul( f.length, lane8v_dot( li, f.n1 ) ), lane8v_dot( f.n1, f.n2 ) );
    return f;
}

// Gradients of the angle of Bridson, Marino and Fedkiw 2003: an opposite vertex has 1 / height along its normal, and the ends
// balance forces and torques. Gradients are finite for a flat hinge. @return squared gradients of the opposite vertices
LANE_INLINE lane8 angle_gradients( const fold* f, lane8v gradient[CORNERS] )
{
    const lane8 one = lane8_set1( 1.0f );
    const lane8v of_k = lane8v_scale( f->n1, lane8_div( f->length, f->n1n1 ) );
    const lane8v of_l = lane8v_scale( f->n2, lane8_div( f->length, f->n2n2 ) );
    gradient[END_I] =
        lane8v_mul_add( lane8v_scale( of_k, lane8_sub( f->foot_k, one ) ), lane8_sub( f->foot_l, one ), of_l );
    gradient[END_J] = lane8v_mul_add( lane8v_scale( of_k, lane8_neg( f->foot_k ) ), lane8_neg( f->foot_l ), of_l );
    gradient[OPPOSITE_K] = of_k;
    gradient[OPPOSITE_L] = of_l;
    return lane8_add( lane8v_dot( of_k, of_k ), lane8v_dot( of_l, of_l ) );
}

// Projects the angle between the normals, positive where the opposite vertices lie on the side to which the normals
// point.
void KERNEL( hinge_dihedral )( const wisp_hinge_args* args, int begin, int end )
{
    const lane8 one = lane8_set1( 1.0f );
    for ( int hinge = begin; hinge < end; hinge += 8 )
    {
        corners c = load_corners( args->position, args->slot_x4, hinge );
        fold f = measure_fold( &c );
        if ( lane8m_any( f.usable ) == false )
        {
            continue;
        }
        lane8v gradient[CORNERS];
        const lane8 steep = angle_gradients( &f, gradient );
        lane8 error = wrap_angle( lane8_sub( f.angle, lane8_loadu( args->rest + hinge ) ) );
        // Where free corners have no lever arm on the angle, such as one free corner while the others are pinned in
        // a line, gradient and sum are rounding errors. Their quotient would move the corner arbitrarily far.
        lane8 sum = weighted_square( &c, gradient );
        lane8 weights = lane8_add( lane8_add( c.weight[0], c.weight[1] ), lane8_add( c.weight[2], c.weight[3] ) );
        lane8m levered = lane8_ge( sum, lane8_mul( lane8_set1( MIN_LEVER ), lane8_mul( weights, steep ) ) );
        lane8 largest = lane8_div( lane8_set1( MAX_TURN ), lane8_select( levered, sum, one ) );
        lane8 step = change_of_lambda( args, hinge, error, sum, largest, lane8m_and( f.usable, levered ) );
        move_corners( args, hinge, &c, gradient, step );
    }
}

// ---- moments of angles (wisp/module/plate.h) ----

// The weights of the own angles of eight hinges. A row that pads with its own hinge has 0 there.
// Not inlined, because what is hardly ever called would take registers of the loop.
__attribute__( ( noinline ) ) static void add_own_weights( const wisp_plate_turns* turns, int group, float own[8] )
{
    for ( int entry = turns->begin[group]; entry < turns->begin[group + 1]; ++entry )
    {
        for ( int lane = 0; lane < 8; ++lane )
        {
            const bool is_own =
                ( turns->near != NULL ? turns->near[entry][lane] : turns->other[entry][lane] ) == 8 * group + lane;
            own[lane] += is_own ? turns->weight[entry][lane] : 0.0f;
        }
    }
}

// Measures angles beyond their rest angles, and moments over lengths of edges for a unit of the moment. A moment along the exact
// gradient keeps linear and angular momentum whatever its size, so where a triangle has lost its height the moment is what gives
// way: as in xpbd, with the part of A = r K w |gradient|^2 that the matrix does not have.
void KERNEL( plate_measure_angles )( const wisp_plate_angle_args* args, int begin, int end )
{
    const wisp_plate_angle_args mine = *args;
    const lane8 one = lane8_set1( 1.0f ), at_once = lane8_set1( AT_ONCE * mine.rate );
    for ( int hinge = begin; hinge < end; hinge += 8 )
    {
        corners c = load_corners( mine.position, mine.slot_x4, hinge );
        fold f = measure_fold( &c );
        const lane8 angle = wrap_angle( lane8_sub( f.angle, lane8_loadu( mine.rest + hinge ) ) );
        const lane8 ee = lane8_mul( f.length, f.length ), steepest = lane8_loadu( mine.turns.steepest + hinge );
        const lane8 steep = lane8_add( lane8_div( ee, f.n1n1 ), lane8_div( ee, f.n2n2 ) );
        lane8 divisor = f.length;
        if ( lane8m_any( lane8_lt( steepest, steep ) ) ) // hardly ever
        {
            lane8v gradient[CORNERS];
            angle_gradients( &f, gradient );
            const lane8 beyond = lane8_max( lane8_sub( one, lane8_div( steepest, steep ) ), lane8_zero() );
            float own[8] = { 0.0f };
            add_own_weights( &args->turns, hinge / 8, own );
            const lane8 stiff = lane8_mul( at_once, lane8_loadu( own ) );
            const lane8 more = lane8_mul( lane8_mul( stiff, weighted_square( &c, gradient ) ), beyond );
            divisor = lane8_mul( divisor, lane8_add( one, more ) );
        }
        lane8_storeu( mine.angle + hinge, lane8_select( f.usable, angle, lane8_zero() ) );
        lane8_storeu( mine.moment + hinge, lane8_select( f.usable, lane8_div( one, divisor ), lane8_zero() ) );
    }
}

LANE_INLINE lane8 gather( const float* from, const int32_t* index )
{
    float number[8];
    for ( int lane = 0; lane < 8; ++lane )
    {
        number[lane] = from[index[lane]];
    }
    return lane8_loadu( number );
}

LANE_INLINE lane8 gather_near( const float* from, const uint16_t* index )
{
    float number[8];
    for ( int lane = 0; lane < 8; ++lane )
    {
        number[lane] = from[index[lane]];
    }
    return lane8_loadu( number );
}

// Computes K J of a group of hinges.
LANE_INLINE lane8 couple( const wisp_plate_turns* turns, const float* angle, int group, bool is_near )
{
    lane8 sum = lane8_zero();
    for ( int entry = turns->begin[group]; entry < turns->begin[group + 1]; ++entry )
    {
        const lane8 other = is_near ? gather_near( angle, turns->near[entry] ) : gather( angle, turns->other[entry] );
        sum = lane8_mul_add( lane8_loadu( turns->weight[entry] ), other, sum );
    }
    return sum;
}

void KERNEL( plate_couple_angles )( const wisp_plate_angle_args* args, int begin, int end )
{
    const wisp_plate_angle_args mine = *args;
    const lane8 rate = lane8_set1( -mine.rate );
    for ( int group = begin / 8; group < end / 8; ++group )
    {
        const lane8 moment = mine.turns.near != NULL ? couple( &mine.turns, mine.angle, group, true )
                                                     : couple( &mine.turns, mine.angle, group, false );
        float* out = mine.moment + 8 * (size_t)group;
        lane8_storeu( out, lane8_mul( lane8_mul( rate, moment ), lane8_loadu( out ) ) );
    }
}

// Adds vectors to rows of four floats, so that only they are transposed.
LANE_INLINE void add_to_rows( float* xyzw, const int32_t* slot_x4, lane8v v )
{
    lane8 add[4] = { v.x, v.y, v.z, lane8_zero() }, row[4];
    int32_t at_x4[8]; // a copy, which stores to rows cannot change
    for ( int l = 0; l < 8; ++l )
    {
        at_x4[l] = slot_x4[l];
    }
    lane8_transpose_quads( add );
    lane8_load_quads( xyzw, at_x4, row );
    for ( int r = 0; r < 4; ++r )
    {
        row[r] = lane8_add( row[r], add[r] );
    }
    lane8_store_quads( xyzw, at_x4, row );
}

// Adds the impulses of moments, triangle by triangle. All act along its normal n: with m the moments over the lengths of the edges
// opposite to a, b and c, corner a has |bc|^2 m_a - ca . cb m_b - ba . bc m_c times n / |n|^2.
void KERNEL( plate_add_moments )( const wisp_plate_angle_args* args, int begin, int end )
{
    const wisp_plate_angle_args mine = *args;
    for ( int triangle = begin; triangle < end; triangle += 8 )
    {
        const int32_t* corner_x4 = mine.turns.corner_x4 + 3 * (size_t)triangle;
        const int32_t* moment_of = mine.turns.moment_of + 3 * (size_t)triangle;
        lane8v p[3];
        lane8 m[3];
        for ( int k = 0; k < 3; ++k )
        {
            lane8_load_xyz( mine.position, corner_x4 + 8 * k, &p[k].x, &p[k].y, &p[k].z );
            m[k] = gather( mine.moment, moment_of + 8 * k );
        }
        const lane8v ab = lane8v_sub( p[1], p[0] ), ac = lane8v_sub( p[2], p[0] ), bc = lane8v_sub( p[2], p[1] );
        const lane8v normal = lane8v_cross( ab, ac );
        const lane8 square = lane8_max( lane8v_dot( normal, normal ), lane8_set1( FLT_MIN ) );
        const lane8 of_a = lane8_mul( lane8v_dot( ab, ac ), lane8_sub( m[1], m[2] ) );
        const lane8 of_b = lane8_mul( lane8v_dot( ab, bc ), lane8_sub( m[0], m[2] ) );
        const lane8 of_c = lane8_mul( lane8v_dot( ac, bc ), lane8_sub( m[0], m[1] ) );
        const lane8v along = lane8v_scale( normal, lane8_div( lane8_set1( 1.0f ), square ) );
        add_to_rows( mine.impulse, corner_x4, lane8v_scale( along, lane8_sub( of_c, of_b ) ) );
        add_to_rows( mine.impulse, corner_x4 + 8, lane8v_scale( along, lane8_sub( of_a, of_c ) ) );
        add_to_rows( mine.impulse, corner_x4 + 16, lane8v_scale( along, lane8_sub( of_b, of_a ) ) );
    }
}

// ---- quadratic bending of isometric surfaces (Bergou et al. 2006) ----

// Inverse masses of eight particles from their rows.
LANE_INLINE lane8 last_of_rows( const lane8 row[4] )
{
    lane8 q[4] = { row[0], row[1], row[2], row[3] };
    lane8_transpose_quads( q );
    return q[3];
}

// Adds c ( x - origin ) to y, all as rows.
LANE_INLINE void add_bent( lane8 y[4], lane8 c, const lane8 x[4], const lane8 origin[4] )
{
    const lane8 spread[4] = { lane8_spread_first( c ), lane8_spread_second( c ), lane8_spread_third( c ),
                              lane8_spread_last( c ) };
    for ( int r = 0; r < 4; ++r )
    {
        y[r] = lane8_mul_add( spread[r], lane8_sub( x[r], origin[r] ), y[r] );
    }
}

// Projects the energy 1/2 |y|^2 / A with y = sum c_i x_i, a constraint C = |y| / sqrt( A ) with gradients
// c_i y / ( |y| sqrt( A ) ). Area and length cancel: x_i -= k w_i c_i y / sum of w c^2. Particles stay rows of four
// floats, as those of links do.
void KERNEL( hinge_isometric )( const wisp_hinge_args* args, int begin, int end )
{
    const wisp_hinge_args mine = *args;
    const lane8 one = lane8_set1( 1.0f ), zero = lane8_zero();
    for ( int hinge = begin; hinge < end; hinge += 8 )
    {
        const int32_t* slot_x4 = mine.slot_x4 + (size_t)hinge * CORNERS;
        lane8 x[CORNERS][4], c[CORNERS], weighted[CORNERS], sum = zero;
        for ( int k = 0; k < CORNERS; ++k )
        {
            lane8_load_quads( mine.position, slot_x4 + 8 * k, x[k] );
            c[k] = lane8_loadu( mine.rest + (size_t)hinge * CORNERS + 8 * k );
            weighted[k] = lane8_mul( last_of_rows( x[k] ), c[k] );
            sum = lane8_mul_add( weighted[k], c[k], sum );
        }
        // c sum to 0, so differences from one corner reduce rounding far from the origin
        lane8 y[4] = { zero, zero, zero, zero };
        for ( int k = 1; k < CORNERS; ++k )
        {
            add_bent( y, c[k], x[k], x[END_I] );
        }
        const lane8m usable = lane8_ge( sum, lane8_set1( FLT_MIN ) );
        lane8 step = lane8_div( lane8_loadu( mine.stiffness + hinge ), lane8_select( usable, sum, one ) );
        step = lane8_select( usable, step, zero );
        for ( int k = 0; k < CORNERS; ++k )
        {
            lane8 move[4];
            lane8_spread_xyz( lane8_mul( weighted[k], step ), move );
            for ( int r = 0; r < 4; ++r )
            {
                x[k][r] = lane8_sub( x[k][r], lane8_mul( move[r], y[r] ) );
            }
            lane8_store_quads( mine.position, slot_x4 + 8 * k, x[k] );
        }
    }
}

// ---- sharp folds ----

// Finds hinges whose opposite vertices are nearer than half their distance at rest. Only differences are transposed.
void KERNEL( hinge_find_folds )( const wisp_fold_args* args, int begin, int end )
{
    const wisp_fold_args mine = *args;
    const lane8 four = lane8_set1( 4.0f );
    for ( int hinge = begin; hinge < end; hinge += 8 )
    {
        const int32_t* slot_x4 = mine.slot_x4 + (size_t)hinge * CORNERS;
        lane8 k[4], l[4];
        lane8_load_quads( mine.position, slot_x4 + 8 * OPPOSITE_K, k );
        lane8_load_quads( mine.position, slot_x4 + 8 * OPPOSITE_L, l );
        for ( int r = 0; r < 4; ++r )
        {
            l[r] = lane8_sub( l[r], k[r] );
        }
        lane8_transpose_quads( l );
        const lane8v between = { l[0], l[1], l[2] };
        const lane8 square = lane8_mul( four, lane8v_dot( between, between ) );
        mine.folded[hinge / 8] = (uint8_t)lane8m_bits( lane8_lt( square, lane8_loadu( mine.span2 + hinge ) ) );
    }
}
