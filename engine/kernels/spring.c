// Springs of a triangle mesh as rows of links: forces, derivatives and a matrix-free product (Noh and Jung, eq.
// 5-17). The product over one-ring slices was measured to be a third faster than stored blocks.
//
// A link between i and j adds K2 I + e e' to A_ii and its negative to A_ij, with e along the link and |e|^2 = K1 -
// K2. That is four numbers instead of nine, the same for both ends except for the sign of e.
//
// Last, vectors of filtered conjugate gradients (Baraff and Witkin 1998; Noh and Jung, section 4). Sums over a range are sums of
// blocks, in order: ranges cut at the same places give the same bits for any number of workers.
#include "kernel_isa.h"

enum
{
    BLOCK = 64, // slices summed in floats before they go into a double
};

// Compressive load of an arc over its chord (Noh and Jung, eq. 11). F(y) = 4 u^2 / ( cos u - y ), y = sin u / u,
// has a pole at the minimum y = -0.217. Multiplied by s = sqrt( y + 0.217 ) it is smooth. This polynomial in s,
// fitted at Chebyshev nodes, approximates F s within 3e-9 and F' within 6e-7 on [0, 1].
static const float ARC_POLE = 0.217233628f, ARC_MIDDLE = 0.784683199f, ARC_SCALE = 3.1387328f;
static const float ARC[9] = {
    -15.327869f,    2.48091183f,      -0.471176067f,   0.095088968f,     -0.0198170092f,
    0.00419485958f, -0.000902768393f, 0.000220892204f, -4.91110683e-05f,
};

typedef struct arc_load
{
    lane8 load, slope; // F and dF/dy
} arc_load;

LANE_INLINE arc_load load_arc( lane8 y )
{
    const lane8 s = lane8_sqrt( lane8_add( y, lane8_set1( ARC_POLE ) ) );
    const lane8 t = lane8_mul( lane8_sub( s, lane8_set1( ARC_MIDDLE ) ), lane8_set1( ARC_SCALE ) );
    lane8 p = lane8_set1( ARC[8] ), dp = lane8_zero();
    for ( int i = 7; i >= 0; --i )
    {
        dp = lane8_mul_add( dp, t, p );
        p = lane8_mul_add( p, t, lane8_set1( ARC[i] ) );
    }
    const lane8 inverse = lane8_div( lane8_set1( 1.0f ), s );
    const lane8 load = lane8_mul( p, inverse );
    const lane8 along = lane8_sub( lane8_mul( dp, lane8_set1( ARC_SCALE ) ), load ); // s dF/ds
    return ( arc_load ){ load, lane8_mul( lane8_mul( along, lane8_set1( 0.5f ) ), lane8_mul( inverse, inverse ) ) };
}

// u^2, which is the energy of an arc over twice k_b / L, less than the angle itself singular: ( 1 - y ) times a polynomial in t
// above, whose fit is within 3e-7 of 6 to 10.
static const float ARC_ENERGY[8] = {
    7.53407001f,   -1.85604596f,    0.385601968f,   -0.0758782998f,
    0.0145638995f, -0.00276953797f, 0.00056620792f, -0.000108395383f,
};

LANE_INLINE lane8 square_arc_angle( lane8 y )
{
    const lane8 s = lane8_sqrt( lane8_add( y, lane8_set1( ARC_POLE ) ) );
    const lane8 t = lane8_mul( lane8_sub( s, lane8_set1( ARC_MIDDLE ) ), lane8_set1( ARC_SCALE ) );
    lane8 p = lane8_set1( ARC_ENERGY[7] );
    for ( int i = 6; i >= 0; --i )
    {
        p = lane8_mul_add( p, t, lane8_set1( ARC_ENERGY[i] ) );
    }
    return lane8_mul( p, lane8_sub( lane8_set1( 1.0f ), y ) );
}

// ---- assembly ----

typedef struct row_lanes
{
    lane8v point, velocity, place;
    lane8v force;     // N
    lane8v drag;      // kg m/s
    lane8 matrix[6];  // sum over links, kg: xx, xy, xz, yy, yz, zz
    lane8 undirected; // number of links without a direction
} row_lanes;

typedef struct link_lanes
{
    lane8v direction; // unit, towards the other end; 0 if there is none
    lane8v closing;   // velocity of the row less velocity of the other end
    lane8 length, inverse_length, rest, load;
    lane8m directed;
} link_lanes;

LANE_INLINE link_lanes load_link( const wisp_spring_args* args, row_lanes* row, int entry )
{
    const int32_t* other_x4 = args->links.other_x4[entry];
    lane8v other_point, moves;
    lane8_load_xyz( args->position, other_x4, &other_point.x, &other_point.y, &other_point.z );
    lane8_load_xyz( args->velocity, other_x4, &moves.x, &moves.y, &moves.z );
    lane8v across = lane8v_sub( other_point, row->point );
    const lane8v closing = lane8v_sub( row->velocity, moves );
    if ( args->base_position != NULL )
    {
        lane8v from;
        lane8_load_xyz( args->base_position, other_x4, &from.x, &from.y, &from.z );
        across = lane8v_mul_add( lane8v_sub( from, row->place ), lane8_set1( -args->dt ), closing );
    }
    const lane8 one = lane8_set1( 1.0f ), squared = lane8v_dot( across, across );
    link_lanes l = { .closing = closing };
    l.directed = lane8_ge( squared, lane8_set1( FLT_MIN ) );
    l.length = lane8_sqrt( squared );
    l.inverse_length = lane8_div( one, lane8_select( l.directed, l.length, one ) );
    l.direction = lane8v_scale( across, lane8_select( l.directed, l.inverse_length, lane8_zero() ) );
    l.rest = lane8_load( args->links.rest[entry] );
    l.load = lane8_load( args->links.stiffness[entry] );
    const lane8m lost = lane8m_and_not( lane8_gt( l.rest, lane8_zero() ), l.directed );
    row->undirected = lane8_add( row->undirected, lane8_select( lost, one, lane8_zero() ) );
    return l;
}

// Terms that a link adds to its row: force along the link in N, stiffness along and across it in N/m.
LANE_INLINE void add_link( const wisp_spring_args* args, row_lanes* row, int entry, const link_lanes* l, lane8 pull,
                           lane8 along, lane8 across )
{
    const lane8 h = lane8_set1( args->dt ), h2 = lane8_mul( h, h );
    const lane8 damping = lane8_mul( h, lane8_load( args->links.damping[entry] ) );
    const lane8 k1 = lane8_mul_add( h2, along, damping ), k2 = lane8_mul_add( h2, across, damping );
    const lane8 root = lane8_sqrt( lane8_max( lane8_sub( k1, k2 ), lane8_zero() ) );
    const lane8v e = lane8v_scale( l->direction, root );
    lane8_store( args->axis[entry][0], e.x );
    lane8_store( args->axis[entry][1], e.y );
    lane8_store( args->axis[entry][2], e.z );
    lane8_store( args->axis[entry][3], k2 );
    row->force = lane8v_mul_add( row->force, pull, l->direction );

    // the first solve is at v, with all of A; a repeat has the stiffness in its forces and adds only the damping
    lane8v drag = lane8v_scale( l->closing, args->is_repeat ? damping : k2 );
    if ( args->is_repeat == false )
    {
        drag = lane8v_mul_add( drag, lane8v_dot( e, l->closing ), e );
    }
    row->drag = lane8v_sub( row->drag, drag );

    row->matrix[0] = lane8_add( row->matrix[0], lane8_mul_add( e.x, e.x, k2 ) );
    row->matrix[1] = lane8_mul_add( e.x, e.y, row->matrix[1] );
    row->matrix[2] = lane8_mul_add( e.x, e.z, row->matrix[2] );
    row->matrix[3] = lane8_add( row->matrix[3], lane8_mul_add( e.y, e.y, k2 ) );
    row->matrix[4] = lane8_mul_add( e.y, e.z, row->matrix[4] );
    row->matrix[5] = lane8_add( row->matrix[5], lane8_mul_add( e.z, e.z, k2 ) );
}

// Clamps stiffness to the maximum of this substep; the material of the links stays unchanged.
LANE_INLINE lane8 clamp_stiffness( const wisp_spring_args* args, lane8 stiffness )
{
    return lane8_min( stiffness, lane8_set1( args->max_stiffness > 0.0f ? args->max_stiffness : FLT_MAX ) );
}

// Adds tension, only above the rest length (Noh and Jung, eq. 6 and 8).
LANE_INLINE void stretch( const wisp_spring_args* args, row_lanes* row, int entry )
{
    const link_lanes l = load_link( args, row, entry );
    const lane8m taut = lane8m_and( lane8_ge( l.length, l.rest ), l.directed );
    const lane8 stiffness = clamp_stiffness( args, l.load ), zero = lane8_zero();
    const lane8 near = lane8_mul( l.rest, lane8_set1( 1.0f - args->compression_margin ) );
    const lane8m resists = lane8m_and( lane8_ge( l.length, near ), l.directed );
    const lane8 along = lane8_select( resists, stiffness, zero );
    const lane8 pull = lane8_mul( lane8_select( taut, stiffness, zero ), lane8_sub( l.length, l.rest ) );
    add_link( args, row, entry, &l, pull, along, lane8_mul( pull, l.inverse_length ) );
}

// Adds compression, only below the rest length: the load of an arc, blended in by a ramp (Noh and Jung, eq. 11-13). The
// negative term of eq. 13 is dropped, so that the matrix stays positive definite.
LANE_INLINE void bend( const wisp_spring_args* args, row_lanes* row, int entry )
{
    const link_lanes l = load_link( args, row, entry );
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f );
    const lane8m slack = lane8m_and( lane8_lt( l.length, l.rest ), l.directed );
    const lane8 inverse_rest = lane8_div( one, lane8_select( slack, l.rest, one ) );
    const arc_load arc = load_arc( lane8_min( lane8_mul( l.length, inverse_rest ), one ) );
    const lane8 ramp = clamp_stiffness( args, lane8_load( args->links.ramp_stiffness[entry] ) );
    const lane8 buckled = lane8_mul( l.load, arc.load ), straight = lane8_mul( ramp, lane8_sub( l.length, l.rest ) );
    const lane8m ramps = lane8_lt( buckled, straight );
    const lane8 pull = lane8_select( slack, lane8_select( ramps, straight, buckled ), zero );
    const lane8 slope = lane8_mul( lane8_mul( l.load, inverse_rest ), arc.slope );
    const lane8 along = lane8_select( slack, lane8_select( ramps, ramp, slope ), zero );
    add_link( args, row, entry, &l, pull, along, zero );
}

// Adds bending, D Q x, whose derivative is constant and the same in every direction.
LANE_INLINE void add_plate( const wisp_spring_args* args, row_lanes* row, int slice )
{
    const lane8 h = lane8_set1( args->dt ), rigidity = lane8_set1( args->rigidity );
    const lane8 h2 = lane8_mul( h, h ), none = lane8_zero();
    for ( int entry = args->plate.begin[slice]; entry < args->plate.begin[slice + 1]; ++entry )
    {
        const int32_t* other_x4 = args->plate.other_x4[entry];
        lane8v point, moves;
        lane8_load_xyz( args->position, other_x4, &point.x, &point.y, &point.z );
        lane8_load_xyz( args->velocity, other_x4, &moves.x, &moves.y, &moves.z );
        lane8v apart = lane8v_sub( row->point, point );
        const lane8v parting = lane8v_sub( row->velocity, moves );
        if ( args->base_position != NULL )
        {
            lane8v from;
            lane8_load_xyz( args->base_position, other_x4, &from.x, &from.y, &from.z );
            apart = lane8v_mul_add( lane8v_sub( row->place, from ), h, parting );
        }
        const lane8 stiffness = lane8_mul( rigidity, lane8_loadu( args->plate.weight[entry] ) );
        const lane8 kept = lane8_mul( h2, stiffness );
        row->force = lane8v_mul_add( row->force, lane8_neg( stiffness ), apart );
        row->drag = lane8v_mul_add( row->drag, args->is_repeat ? none : lane8_neg( kept ), parting );
        row->matrix[0] = lane8_add( row->matrix[0], kept );
        row->matrix[3] = lane8_add( row->matrix[3], kept );
        row->matrix[5] = lane8_add( row->matrix[5], kept );
    }
}

// Inverts a symmetric matrix by L D L'. `least` is its isotropic part and a lower bound of the pivots. Next to a
// stiff link that part is lost by rounding, and without the bound the inverse would not be positive definite.
LANE_INLINE void invert( const lane8 matrix[6], lane8 least, float out[6][8] )
{
    const lane8 one = lane8_set1( 1.0f );
    const lane8 first = lane8_div( one, lane8_max( matrix[0], least ) );
    const lane8 yx = lane8_mul( matrix[1], first ), zx = lane8_mul( matrix[2], first );
    const lane8 second = lane8_div( one, lane8_max( lane8_sub( matrix[3], lane8_mul( yx, matrix[1] ) ), least ) );
    const lane8 mixed = lane8_sub( matrix[4], lane8_mul( yx, matrix[2] ) ), zy = lane8_mul( mixed, second );
    const lane8 rest = lane8_sub( lane8_sub( matrix[5], lane8_mul( zx, matrix[2] ) ), lane8_mul( zy, mixed ) );
    const lane8 third = lane8_div( one, lane8_max( rest, least ) );
    const lane8 back = lane8_sub( lane8_mul( yx, zy ), zx ); // entry z, x of the inverse of L
    lane8_store( out[5], third );
    lane8_store( out[4], lane8_neg( lane8_mul( zy, third ) ) );
    lane8_store( out[2], lane8_mul( back, third ) );
    lane8_store( out[3], lane8_mul_add( lane8_mul( zy, zy ), third, second ) );
    lane8_store( out[1], lane8_neg( lane8_mul_add( lane8_mul( back, zy ), third, lane8_mul( yx, second ) ) ) );
    const lane8 two = lane8_mul_add( lane8_mul( yx, yx ), second, first );
    lane8_store( out[0], lane8_mul_add( lane8_mul( back, back ), third, two ) );
}

LANE_INLINE void finish_row( const wisp_spring_args* args, row_lanes* row, int slice, lane8 mass )
{
    lane8v rhs = lane8v_mul_add( row->drag, lane8_set1( args->dt ), row->force );
    if ( args->is_repeat )
    {
        lane8v start;
        lane8 unused;
        lane8_load_xyzw_contiguous( args->start_velocity + (size_t)slice * 32, &start.x, &start.y, &start.z,
                                    &unused );
        rhs = lane8v_mul_add( rhs, mass, lane8v_sub( start, row->velocity ) );
    }
    lane8v_store( args->rhs[slice][0], rhs );
    row->matrix[0] = lane8_add( row->matrix[0], mass );
    row->matrix[3] = lane8_add( row->matrix[3], mass );
    row->matrix[5] = lane8_add( row->matrix[5], mass );
    invert( row->matrix, mass, args->inverse[slice] );
}

int KERNEL( spring_assemble )( const wisp_spring_args* args, int begin, int end )
{
    int undirected = 0;
    for ( int slice = begin; slice < end; ++slice )
    {
        const lane8 zero = lane8_zero();
        const lane8v none = { zero, zero, zero };
        row_lanes row = { .force = none, .drag = none, .undirected = zero };
        lane8 mass, unused;
        for ( int i = 0; i < 6; ++i )
        {
            row.matrix[i] = zero;
        }
        lane8_load_xyzw_contiguous( args->position + (size_t)slice * 32, &row.point.x, &row.point.y, &row.point.z,
                                    &mass );
        lane8_load_xyzw_contiguous( args->velocity + (size_t)slice * 32, &row.velocity.x, &row.velocity.y,
                                    &row.velocity.z, &unused );
        row.place = row.point;
        if ( args->base_position != NULL )
        {
            lane8_load_xyzw_contiguous( args->base_position + (size_t)slice * 32, &row.place.x, &row.place.y,
                                        &row.place.z, &unused );
        }
        const int32_t* parts = args->links.begin + 2 * (size_t)slice;
        for ( int entry = parts[0]; entry < parts[1]; ++entry )
        {
            stretch( args, &row, entry );
        }
        for ( int entry = parts[1]; entry < parts[2]; ++entry )
        {
            bend( args, &row, entry );
        }
        if ( args->plate.begin != NULL )
        {
            add_plate( args, &row, slice );
        }
        finish_row( args, &row, slice, mass );
        undirected += (int)lane8_sum_ordered( row.undirected );
    }
    return undirected;
}

// ---- potential ----

// What a row and its links have before and after a motion.
typedef struct gain_lanes
{
    lane8v before, after; // m, of the row
    lane8 gain, stored;   // J
} gain_lanes;

typedef struct span_lanes
{
    lane8 before, after; // m, lengths of a link
} span_lanes;

LANE_INLINE span_lanes load_spans( const wisp_spring_args* args, const gain_lanes* row, const int32_t* other_x4 )
{
    lane8v before, after;
    lane8_load_xyz( args->base_position, other_x4, &before.x, &before.y, &before.z );
    lane8_load_xyz( args->position, other_x4, &after.x, &after.y, &after.z );
    before = lane8v_sub( before, row->before );
    after = lane8v_sub( after, row->after );
    return ( span_lanes ){ lane8_sqrt( lane8v_dot( before, before ) ), lane8_sqrt( lane8v_dot( after, after ) ) };
}

// 1/2 k ( after^2 - before^2 )
LANE_INLINE void add_squares( gain_lanes* row, lane8 stiffness, lane8 before, lane8 after )
{
    const lane8 half = lane8_mul( lane8_set1( 0.5f ), stiffness );
    const lane8 change = lane8_mul( lane8_sub( after, before ), lane8_add( after, before ) );
    row->gain = lane8_mul_add( half, change, row->gain );
    row->stored = lane8_mul_add( half, lane8_mul( after, after ), row->stored );
}

LANE_INLINE void gain_stretch( const wisp_spring_args* args, gain_lanes* row, int entry )
{
    const span_lanes l = load_spans( args, row, args->links.other_x4[entry] );
    const lane8 zero = lane8_zero(), rest = lane8_load( args->links.rest[entry] );
    add_squares( row, lane8_load( args->links.stiffness[entry] ), lane8_max( lane8_sub( l.before, rest ), zero ),
                 lane8_max( lane8_sub( l.after, rest ), zero ) );
}

// The integral of eq. 12: along the ramp as far as where it meets the arc, then 2 k_b / L ( u^2 - u_meet^2 ).
LANE_INLINE void gain_bend( const wisp_spring_args* args, gain_lanes* row, int entry )
{
    const span_lanes l = load_spans( args, row, args->links.other_x4[entry] );
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f ), rest = lane8_load( args->links.rest[entry] );
    const lane8 meets = lane8_load( args->links.ramp_end[entry] );
    const lane8 inverse_rest = lane8_div( one, lane8_select( lane8_gt( rest, zero ), rest, one ) );
    const lane8 ramp_length = lane8_mul( rest, lane8_sub( one, meets ) );
    const lane8 before = lane8_max( lane8_sub( rest, l.before ), zero );
    const lane8 after = lane8_max( lane8_sub( rest, l.after ), zero );
    add_squares( row, lane8_load( args->links.ramp_stiffness[entry] ), lane8_min( before, ramp_length ),
                 lane8_min( after, ramp_length ) );
    const lane8 scale = lane8_mul( lane8_add( rest, rest ), lane8_load( args->links.stiffness[entry] ) );
    const lane8 from = square_arc_angle( lane8_min( lane8_mul( l.before, inverse_rest ), meets ) );
    const lane8 to = square_arc_angle( lane8_min( lane8_mul( l.after, inverse_rest ), meets ) );
    row->gain = lane8_mul_add( scale, lane8_sub( to, from ), row->gain );
    row->stored = lane8_mul_add( scale, lane8_sub( to, square_arc_angle( meets ) ), row->stored );
}

// 1/2 D x' Q x is a square: its change is that of x times the mean force.
LANE_INLINE lane8 gain_plate( const wisp_spring_args* args, const gain_lanes* row, int slice )
{
    lane8v force = { lane8_zero(), lane8_zero(), lane8_zero() };
    const lane8v own = lane8v_add( row->before, row->after );
    for ( int entry = args->plate.begin[slice]; entry < args->plate.begin[slice + 1]; ++entry )
    {
        lane8v before, after;
        lane8_load_xyz( args->base_position, args->plate.other_x4[entry], &before.x, &before.y, &before.z );
        lane8_load_xyz( args->position, args->plate.other_x4[entry], &after.x, &after.y, &after.z );
        force = lane8v_mul_add( force, lane8_loadu( args->plate.weight[entry] ),
                                lane8v_sub( own, lane8v_add( before, after ) ) );
    }
    return lane8_mul( lane8_set1( args->rigidity ), lane8v_dot( lane8v_sub( row->after, row->before ), force ) );
}

wisp_spring_gain KERNEL( spring_gain )( const wisp_spring_args* args, int begin, int end )
{
    wisp_spring_gain sum = { 0.0, 0.0 };
    for ( int slice = begin; slice < end; ++slice )
    {
        gain_lanes row = { .gain = lane8_zero(), .stored = lane8_zero() };
        lane8 unused;
        lane8_load_xyzw_contiguous( args->base_position + (size_t)slice * 32, &row.before.x, &row.before.y,
                                    &row.before.z, &unused );
        lane8_load_xyzw_contiguous( args->position + (size_t)slice * 32, &row.after.x, &row.after.y, &row.after.z,
                                    &unused );
        const int32_t* parts = args->links.begin + 2 * (size_t)slice;
        for ( int entry = parts[0]; entry < parts[1]; ++entry )
        {
            gain_stretch( args, &row, entry );
        }
        for ( int entry = parts[1]; entry < parts[2]; ++entry )
        {
            gain_bend( args, &row, entry );
        }
        if ( args->plate.begin != NULL )
        {
            row.gain = lane8_add( row.gain, gain_plate( args, &row, slice ) );
        }
        // either end has half of a link
        sum.gain += 0.5 * (double)lane8_sum_ordered( row.gain );
        sum.stored += 0.5 * (double)lane8_sum_ordered( row.stored );
    }
    return sum;
}

// ---- matrix product ----

LANE_INLINE lane8v plate_product( const wisp_conjugate_args* args, int slice, lane8v own )
{
    lane8v sum = { lane8_zero(), lane8_zero(), lane8_zero() };
    for ( int entry = args->plate.begin[slice]; entry < args->plate.begin[slice + 1]; ++entry )
    {
        lane8v other;
        lane8_load_xyz( args->direction, args->plate.other_x4[entry], &other.x, &other.y, &other.z );
        sum = lane8v_mul_add( sum, lane8_loadu( args->plate.weight[entry] ), lane8v_sub( own, other ) );
    }
    return lane8v_scale( sum, lane8_set1( args->plate_rate ) );
}

double KERNEL( spring_product )( const wisp_conjugate_args* args, int begin, int end )
{
    double sum = 0.0;
    for ( int block = begin; block < end; block += BLOCK )
    {
        lane8 dot = lane8_zero();
        for ( int slice = block; slice < end && slice < block + BLOCK; ++slice )
        {
            lane8v own;
            lane8 mass;
            lane8_load_xyzw_contiguous( args->direction + (size_t)slice * 32, &own.x, &own.y, &own.z, &mass );
            lane8v product = lane8v_scale( own, mass );
            const int last = args->links.begin[2 * (size_t)slice + 2];
            for ( int entry = args->links.begin[2 * (size_t)slice]; entry < last; ++entry )
            {
                lane8v other;
                lane8_load_xyz( args->direction, args->links.other_x4[entry], &other.x, &other.y, &other.z );
                const lane8v u = lane8v_sub( own, other ), e = lane8v_load( args->axis[entry][0] );
                product = lane8v_mul_add( product, lane8_load( args->axis[entry][3] ), u );
                product = lane8v_mul_add( product, lane8v_dot( e, u ), e );
            }
            if ( args->plate.begin != NULL )
            {
                product = lane8v_add( product, plate_product( args, slice, own ) );
            }
            lane8v_store( args->product[slice][0], product );
            dot = lane8_add( dot, lane8v_dot( own, product ) );
        }
        sum += (double)lane8_sum_ordered( dot );
    }
    return sum;
}

LANE_INLINE lane8v multiply( const float matrix[6][8], lane8v v )
{
    const lane8 xx = lane8_load( matrix[0] ), xy = lane8_load( matrix[1] ), xz = lane8_load( matrix[2] );
    const lane8 yy = lane8_load( matrix[3] ), yz = lane8_load( matrix[4] ), zz = lane8_load( matrix[5] );
    return ( lane8v ){
        lane8_mul_add( xz, v.z, lane8_mul_add( xy, v.y, lane8_mul( xx, v.x ) ) ),
        lane8_mul_add( yz, v.z, lane8_mul_add( yy, v.y, lane8_mul( xy, v.x ) ) ),
        lane8_mul_add( zz, v.z, lane8_mul_add( yz, v.y, lane8_mul( xz, v.x ) ) ),
    };
}

double KERNEL( conjugate_advance )( const wisp_conjugate_args* args, float step, int begin, int end )
{
    const lane8 a = lane8_set1( step );
    double sum = 0.0;
    for ( int block = begin; block < end; block += BLOCK )
    {
        lane8 dot = lane8_zero();
        for ( int slice = block; slice < end && slice < block + BLOCK; ++slice )
        {
            const lane8v q = lane8v_scale( lane8v_load( args->product[slice][0] ), a );
            lane8v r = lane8v_sub( lane8v_load( args->residual[slice][0] ), q );
            lane8v_store( args->residual[slice][0], r );
            const bool filtered = args->filtered[slice] != 0;
            r = filtered ? multiply( args->filter[slice], r ) : r;
            lane8v s = multiply( args->inverse[slice], r );
            s = filtered ? multiply( args->filter[slice], s ) : s;
            lane8v_store( args->search[slice][0], s );
            dot = lane8_add( dot, lane8v_dot( r, s ) );
        }
        sum += (double)lane8_sum_ordered( dot );
    }
    return sum;
}

// Updates the solution in this loop, where the direction is in registers: large cloths are bound by memory.
void KERNEL( conjugate_update )( const wisp_conjugate_args* args, float step, float fraction, int begin, int end )
{
    const lane8 a = lane8_set1( step ), b = lane8_set1( fraction );
    for ( int slice = begin; slice < end; ++slice )
    {
        float* xyzw = args->direction + (size_t)slice * 32;
        lane8v c;
        lane8 mass;
        lane8_load_xyzw_contiguous( xyzw, &c.x, &c.y, &c.z, &mass );
        lane8v_store( args->solution[slice][0], lane8v_mul_add( lane8v_load( args->solution[slice][0] ), a, c ) );
        c = lane8v_mul_add( lane8v_load( args->search[slice][0] ), b, c );
        lane8_store_xyzw_contiguous( xyzw, c.x, c.y, c.z, mass );
    }
}
