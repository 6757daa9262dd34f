// Triangles with a strain energy, eight triangles at a time. The triangles of a group share no particle.
//
// A triangle takes the step of implicit Euler of its own energy: it moves from F to the F' that minimises |F' - F|^2 / (2 m) +
// h^2 E( F' ), m the largest mobility of F, which depends on the masses. F' has the principal directions of F, so that is a problem
// of two stretches, and a convex one. Its solution never oversteps, however stiff the material or long the substep.
#include "kernel_isa.h"

#include "lane_double_vec.h"

enum
{
    CORNERS = 3,
    NEWTON_STEPS = 4,
};

// Below it a stretch has no direction, in which its triangle could be opened again.
#define SMALLEST_STRETCH 1e-6f
// A step of Newton's method never goes below this part of a stretch.
#define LEAST_PART 0.3f

typedef struct triangle
{
    lane8v point[CORNERS];
    lane8 weight[CORNERS]; // inverse masses
    lane8 b11, b12, b22, area;
    lane8m usable;
} triangle;

typedef struct gradient
{
    lane8v f1, f2;
} gradient;

// A symmetric matrix by its principal values and their axes (x, y) and (-y, x).
typedef struct principal
{
    lane8 s1, s2, x, y;
} principal;

typedef struct symmetric
{
    lane8 xx, yy, xy;
} symmetric;

LANE_INLINE triangle load_triangle( const wisp_elastic_triangle_args* args, int index )
{
    triangle t;
    const float* shape = args->shape + 4 * (size_t)index;
    for ( int k = 0; k < CORNERS; ++k )
    {
        const int32_t* slot_x4 = args->slot_x4 + CORNERS * (size_t)index + 8 * k;
        lane8_load_xyzw( args->position, slot_x4, &t.point[k].x, &t.point[k].y, &t.point[k].z, &t.weight[k] );
    }
    t.b11 = lane8_loadu( shape );
    t.b12 = lane8_loadu( shape + 8 );
    t.b22 = lane8_loadu( shape + 16 );
    t.area = lane8_loadu( shape + 24 );
    t.usable = lane8_gt( t.area, lane8_zero() );
    return t;
}

LANE_INLINE gradient measure_gradient( const triangle* t )
{
    const lane8v e1 = lane8v_sub( t->point[1], t->point[0] ), e2 = lane8v_sub( t->point[2], t->point[0] );
    return ( gradient ){ lane8v_scale( e1, t->b11 ), lane8v_mul_add( lane8v_scale( e1, t->b12 ), t->b22, e2 ) };
}

// The largest eigenvalue of sum w D D', D the derivatives of F by a corner, 1/(kg m^2).
LANE_INLINE lane8 largest_mobility( const triangle* t )
{
    const lane8 half = lane8_set1( 0.5f ), both = lane8_add( t->b12, t->b22 );
    const lane8 of_x = lane8_mul( t->b11, t->b11 );
    const lane8 xx = lane8_mul( lane8_add( t->weight[0], t->weight[1] ), of_x );
    const lane8 xy = lane8_mul( t->b11, lane8_mul_add( t->weight[0], both, lane8_mul( t->weight[1], t->b12 ) ) );
    const lane8 yy = lane8_mul_add( lane8_mul( t->weight[0], both ), both,
                                    lane8_mul_add( lane8_mul( t->weight[1], t->b12 ), t->b12,
                                                   lane8_mul( lane8_mul( t->weight[2], t->b22 ), t->b22 ) ) );
    const lane8 mean = lane8_mul( half, lane8_add( xx, yy ) ), apart = lane8_mul( half, lane8_sub( xx, yy ) );
    const lane8 exact = lane8_add( mean, lane8_sqrt( lane8_mul_add( apart, apart, lane8_mul( xy, xy ) ) ) );
    // the squares of a tiny triangle would overflow; the sum of both eigenvalues is a bound
    return lane8_select( lane8_lt( mean, lane8_set1( 1e18f ) ), exact, lane8_add( xx, yy ) );
}

LANE_INLINE principal find_principal( symmetric m )
{
    const lane8 half = lane8_set1( 0.5f ), one = lane8_set1( 1.0f ), zero = lane8_zero();
    const lane8 mean = lane8_mul( half, lane8_add( m.xx, m.yy ) ), apart = lane8_mul( half, lane8_sub( m.xx, m.yy ) );
    const lane8 radius = lane8_sqrt( lane8_mul_add( apart, apart, lane8_mul( m.xy, m.xy ) ) );
    const lane8m turned = lane8_gt( radius, lane8_mul( lane8_set1( FLT_EPSILON ), lane8_abs( mean ) ) );
    const lane8 divisor = lane8_select( turned, radius, one );
    const lane8 cosine = lane8_select( turned, lane8_min( lane8_div( lane8_abs( apart ), divisor ), one ), one );
    const lane8 large = lane8_sqrt( lane8_mul( half, lane8_add( one, cosine ) ) );
    const lane8 small =
        lane8_select( turned, lane8_div( lane8_mul( half, m.xy ), lane8_mul( divisor, large ) ), zero );
    const lane8m along_x = lane8_ge( apart, zero );
    return ( principal ){
        .s1 = lane8_add( mean, radius ),
        .s2 = lane8_sub( mean, radius ),
        .x = lane8_select( along_x, large, small ),
        .y = lane8_select( along_x, small, large ),
    };
}

LANE_INLINE symmetric compose( lane8 s1, lane8 s2, lane8 x, lane8 y )
{
    return ( symmetric ){
        .xx = lane8_mul_add( lane8_mul( s1, x ), x, lane8_mul( lane8_mul( s2, y ), y ) ),
        .yy = lane8_mul_add( lane8_mul( s1, y ), y, lane8_mul( lane8_mul( s2, x ), x ) ),
        .xy = lane8_mul( lane8_sub( s1, s2 ), lane8_mul( x, y ) ),
    };
}

// F = R U: the stretches of U by the eigenvalues of F'F, and the columns of R. The smaller stretch is the area of f1 and f2 over the
// larger one, which keeps its digits.
typedef struct polar
{
    principal stretch;
    gradient rotation;
} polar;

LANE_INLINE polar decompose( const gradient* f )
{
    const lane8 one = lane8_set1( 1.0f ), smallest = lane8_set1( SMALLEST_STRETCH );
    const lane8v across = lane8v_cross( f->f1, f->f2 );
    principal s = find_principal( ( symmetric ){
        lane8v_dot( f->f1, f->f1 ),
        lane8v_dot( f->f2, f->f2 ),
        lane8v_dot( f->f1, f->f2 ),
    } );
    s.s1 = lane8_max( lane8_sqrt( s.s1 ), smallest );
    s.s2 = lane8_div( lane8_sqrt( lane8v_dot( across, across ) ), s.s1 );
    const lane8m has_second = lane8_gt( s.s2, smallest );
    s.s2 = lane8_max( s.s2, smallest );
    const lane8v n1 =
        lane8v_scale( lane8v_mul_add( lane8v_scale( f->f1, s.x ), s.y, f->f2 ), lane8_div( one, s.s1 ) );
    const lane8v n2 = lane8v_scale( lane8v_mul_add( lane8v_scale( f->f2, s.x ), lane8_neg( s.y ), f->f1 ),
                                    lane8_select( has_second, lane8_div( one, s.s2 ), lane8_zero() ) );
    return ( polar ){
        .stretch = s,
        .rotation = { lane8v_mul_add( lane8v_scale( n1, s.x ), lane8_neg( s.y ), n2 ),
                      lane8v_mul_add( lane8v_scale( n1, s.y ), s.x, n2 ) },
    };
}

// ---- the energy of two stretches: its derivatives over A G ----

typedef struct tension
{
    lane8 p1, p2; // dE/ds
} tension;

// Newton's method for s' + c p( s' ) = s, from a stretch between s and rest. Compression grows without bound, so a flat triangle
// starts about where it can be.
LANE_INLINE lane8 begin_newton( lane8 s, lane8 c )
{
    const lane8 one = lane8_set1( 1.0f );
    return lane8_max( lane8_div( lane8_add( s, c ), lane8_add( one, c ) ),
                      lane8_sqrt( lane8_sqrt( lane8_min( c, one ) ) ) );
}

LANE_INLINE lane8 step_newton( lane8 s, lane8 step )
{
    return lane8_max( lane8_sub( s, step ), lane8_mul( s, lane8_set1( LEAST_PART ) ) );
}

// p of the solution is ( s - s' ) / c, and the derivative there. The first is exact where c is large, the second where it is small.
LANE_INLINE lane8 choose_tension( lane8 s, lane8 solution, lane8 c, lane8 derivative )
{
    const lane8m stiff = lane8_gt( c, lane8_set1( 1.0f ) );
    return lane8_select( stiff, lane8_div( lane8_sub( s, solution ), lane8_select( stiff, c, lane8_set1( 1.0f ) ) ),
                         derivative );
}

// Pulled one way only, so that the width follows: p = s - 1 / s^2; 0 where it is not pulled.
LANE_INLINE lane8 relax_wrinkled( lane8 s, lane8 c )
{
    const lane8 one = lane8_set1( 1.0f ), two = lane8_set1( 2.0f );
    lane8 a = begin_newton( s, c );
    for ( int step = 0; step < NEWTON_STEPS; ++step )
    {
        const lane8 inverse = lane8_div( one, a ), squared = lane8_mul( inverse, inverse );
        const lane8 error = lane8_mul_add( c, lane8_sub( a, squared ), lane8_sub( a, s ) );
        const lane8 slope = lane8_mul_add( c, lane8_mul_add( two, lane8_mul( squared, inverse ), one ), one );
        a = step_newton( a, lane8_div( error, slope ) );
    }
    const lane8 inverse = lane8_div( one, a );
    const lane8 p = choose_tension( s, a, c, lane8_sub( a, lane8_mul( inverse, inverse ) ) );
    return lane8_select( lane8_gt( s, one ), p, lane8_zero() );
}

LANE_INLINE tension relax( const principal* s, lane8 c, bool tension_field )
{
    const lane8 one = lane8_set1( 1.0f ), two = lane8_set1( 2.0f ), three = lane8_set1( 3.0f );
    lane8 a = begin_newton( s->s1, c ), b = begin_newton( s->s2, c );
    tension t;
    for ( int step = 0;; ++step )
    {
        const lane8 i1 = lane8_div( one, a ), i2 = lane8_div( one, b );
        const lane8 thickness = lane8_mul( i1, i2 ), squared = lane8_mul( thickness, thickness );
        t.p1 = lane8_sub( a, lane8_mul( squared, i1 ) );
        t.p2 = lane8_sub( b, lane8_mul( squared, i2 ) );
        if ( step == NEWTON_STEPS )
        {
            break;
        }
        const lane8 e1 = lane8_mul_add( c, t.p1, lane8_sub( a, s->s1 ) );
        const lane8 e2 = lane8_mul_add( c, t.p2, lane8_sub( b, s->s2 ) );
        const lane8 curved = lane8_mul( three, squared );
        const lane8 h11 = lane8_mul_add( c, lane8_mul_add( curved, lane8_mul( i1, i1 ), one ), one );
        const lane8 h22 = lane8_mul_add( c, lane8_mul_add( curved, lane8_mul( i2, i2 ), one ), one );
        const lane8 h12 = lane8_mul( c, lane8_mul( two, lane8_mul( squared, thickness ) ) );
        const lane8 per_det = lane8_div( one, lane8_sub( lane8_mul( h11, h22 ), lane8_mul( h12, h12 ) ) );
        a = step_newton( a, lane8_mul( per_det, lane8_sub( lane8_mul( e1, h22 ), lane8_mul( e2, h12 ) ) ) );
        b = step_newton( b, lane8_mul( per_det, lane8_sub( lane8_mul( e2, h11 ), lane8_mul( e1, h12 ) ) ) );
    }
    t.p1 = choose_tension( s->s1, a, c, t.p1 );
    t.p2 = choose_tension( s->s2, b, c, t.p2 );
    if ( tension_field )
    {
        // The energy is convex: where this solution is taut, it is the solution. Narrower than it becomes by itself when it is pulled
        // one way, a triangle wrinkles.
        const lane8m wrinkles = lane8_lt( lane8_mul( a, lane8_mul( b, b ) ), one );
        t.p1 = lane8_select( wrinkles, relax_wrinkled( s->s1, c ), t.p1 );
        t.p2 = lane8_select( wrinkles, lane8_zero(), t.p2 );
    }
    return t;
}

// ---- the kernels ----

// Replaces the stress of the substep. @return by how much it changes
LANE_INLINE symmetric change_stress( float* stress, symmetric now )
{
    if ( stress == NULL )
    {
        return now;
    }
    const symmetric before = { lane8_load( stress ), lane8_load( stress + 8 ), lane8_load( stress + 16 ) };
    lane8_store( stress, now.xx );
    lane8_store( stress + 8, now.yy );
    lane8_store( stress + 16, now.xy );
    return ( symmetric ){ lane8_sub( now.xx, before.xx ), lane8_sub( now.yy, before.yy ),
                          lane8_sub( now.xy, before.xy ) };
}

LANE_INLINE void move_corners( const wisp_elastic_triangle_args* args, int index, const triangle* t,
                               const gradient* change )
{
    // derivatives of f1 and f2 by the corners
    const lane8 by1[CORNERS] = { lane8_neg( t->b11 ), t->b11, lane8_zero() };
    const lane8 by2[CORNERS] = { lane8_neg( lane8_add( t->b12, t->b22 ) ), t->b12, t->b22 };
    for ( int k = 0; k < CORNERS; ++k )
    {
        const int32_t* slot_x4 = args->slot_x4 + CORNERS * (size_t)index + 8 * k;
        const lane8v impulse = lane8v_mul_add( lane8v_scale( change->f1, by1[k] ), by2[k], change->f2 );
        const lane8v moved = lane8v_mul_add( t->point[k], lane8_neg( t->weight[k] ), impulse );
        lane8_store_xyzw( args->position, slot_x4, moved.x, moved.y, moved.z, t->weight[k] );
    }
}

// The stretches that the triangle would have without its own stress.
LANE_INLINE principal without_stress( const principal* s, const float* stress, lane8 mobility )
{
    if ( stress == NULL )
    {
        return *s;
    }
    const symmetric u = compose( s->s1, s->s2, s->x, s->y );
    return find_principal( ( symmetric ){ lane8_mul_add( mobility, lane8_load( stress ), u.xx ),
                                          lane8_mul_add( mobility, lane8_load( stress + 8 ), u.yy ),
                                          lane8_mul_add( mobility, lane8_load( stress + 16 ), u.xy ) } );
}

// The stress turns with the triangle, like the multiplier of a link.
LANE_INLINE gradient rotate_stress( const gradient* r, symmetric m )
{
    return ( gradient ){ lane8v_mul_add( lane8v_scale( r->f1, m.xx ), m.xy, r->f2 ),
                         lane8v_mul_add( lane8v_scale( r->f1, m.xy ), m.yy, r->f2 ) };
}

void KERNEL( elastic_triangle_project )( const wisp_elastic_triangle_args* args, int begin, int end )
{
    const wisp_elastic_triangle_args mine = *args;
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f ), rate = lane8_set1( mine.stiffness * mine.dt2 );
    for ( int index = begin; index < end; index += 8 )
    {
        float* stress = mine.stress != NULL ? mine.stress + 3 * (size_t)index : NULL;
        const triangle t = load_triangle( &mine, index );
        const lane8 mobility = largest_mobility( &t );
        const lane8m moves = lane8m_and( t.usable, lane8_gt( mobility, lane8_set1( FLT_MIN ) ) );
        const gradient f = measure_gradient( &t );
        const polar here = decompose( &f );
        const principal free = without_stress( &here.stretch, stress, mobility );
        const lane8 strength = lane8_mul( rate, t.area ); // h^2 A G, kg m^2
        const lane8 c = lane8_select( moves, lane8_mul( strength, mobility ), one );
        const tension p = relax( &free, c, mine.tension_field );
        const lane8 q1 = lane8_select( moves, lane8_mul( strength, p.p1 ), zero );
        const lane8 q2 = lane8_select( moves, lane8_mul( strength, p.p2 ), zero );
        const symmetric change = change_stress( stress, compose( q1, q2, free.x, free.y ) );
        const gradient impulse = rotate_stress( &here.rotation, change );
        move_corners( &mine, index, &t, &impulse );
    }
}

// ---- the virial ----

// F : dE/dF over A G, from the two invariants of F'F; doubles, because a small strain is a difference of large numbers.
LANE_INLINE lane8d virial_of( const gradient* f, lane8m usable, bool tension_field )
{
    const lane8d zero = lane8d_set1( 0.0 ), one = lane8d_set1( 1.0 ), half = lane8d_set1( 0.5 );
    const lane8d ones = lane8d_widen( lane8_select( usable, lane8_set1( 1.0f ), lane8_zero() ) );
    const lane8dv f1 = lane8dv_widen( f->f1 ), f2 = lane8dv_widen( f->f2 );
    const lane8d l1 = lane8dv_length( f1 ), l2 = lane8dv_length( f2 ),
                 area = lane8dv_length( lane8dv_cross( f1, f2 ) );
    const lane8d trace = lane8d_add( lane8d_mul( l1, l1 ), lane8d_mul( l2, l2 ) ), det = lane8d_mul( area, area );
    const lane8dm opened = lane8d_lt( lane8d_set1( 1e-24 ), det );
    const lane8d twice = lane8d_div( lane8d_set1( 2.0 ), lane8d_select( opened, det, one ) );
    lane8d sum = lane8d_select( opened, lane8d_sub( trace, twice ), zero );
    if ( tension_field )
    {
        const lane8d mean = lane8d_mul( half, trace );
        const lane8d apart = lane8d_sub( lane8d_mul( mean, mean ), det );
        const lane8d larger =
            lane8d_add( mean, lane8d_sqrt( lane8d_select( lane8d_lt( zero, apart ), apart, zero ) ) );
        const lane8dm pulled = lane8d_lt( one, larger );
        const lane8d s1 = lane8d_sqrt( lane8d_select( pulled, larger, one ) );
        const lane8d alone =
            lane8d_select( pulled, lane8d_sub( larger, lane8d_div( one, s1 ) ), zero ); // s1 p1 = s1^2 - 1 / s1
        // s1 s2^2 = det / s1
        sum = lane8d_select( lane8d_lt( det, s1 ), alone, sum );
    }
    return lane8d_mul( sum, ones );
}

double KERNEL( elastic_triangle_virial )( const wisp_elastic_triangle_args* args, int begin, int end )
{
    const wisp_elastic_triangle_args mine = *args;
    const double stiffness = (double)mine.stiffness;
    lane8d sum = lane8d_set1( 0.0 );
    for ( int index = begin; index < end; index += 8 )
    {
        const triangle t = load_triangle( &mine, index );
        const gradient f = measure_gradient( &t );
        const lane8d area = lane8d_widen( t.area );
        sum = lane8d_add( sum, lane8d_mul( area, virial_of( &f, t.usable, mine.tension_field ) ) );
    }
    return stiffness * lane8d_sum_ordered( sum );
}
