// Smooth curves through the vertices of strands, one strand per lane. A segment of a curve blends four points. Each
// sample is one row, so all lanes share the blending weights.
#include "kernel_isa.h"

// Blends the four points of a segment. A joint belongs to the segment before it.
typedef struct segment16
{
    lane16v p[4];
} segment16;

// Access to vertices of the strands of a group; indices beyond the ends are clamped.
typedef struct curve_source
{
    const float* from;
    const int32_t *at, *count; // of the group's lanes
    bool in_step;              // lanes are one group of the source with equal lengths, so no gather is needed
    lane16i last;              // number of vertices less one
} curve_source;

static curve_source source_of( const wisp_strand_curve_args* args, int group )
{
    const int32_t* at = args->lane_row + group * WISP_LANES;
    const int32_t* count = args->lane_vertices + group * WISP_LANES;
    curve_source s = { args->from, at, count, at[0] % WISP_LANES == 0, lane16i_loadu( count ) };
    for ( int lane = 1; lane < WISP_LANES; ++lane )
    {
        s.in_step = s.in_step && at[lane] == at[0] + lane && count[lane] == count[0];
    }
    s.last = lane16i_sub( s.last, lane16i_set1( 1 ) );
    return s;
}

static lane16v vertex( const curve_source* s, int i )
{
    i = i < 0 ? 0 : i;
    if ( s->in_step )
    {
        const int last = s->count[0] - 1;
        return lane16v_load( s->from + s->at[0] + (size_t)( i < last ? i : last ) * 3 * WISP_LANES );
    }
    float rows[3 * WISP_LANES] __attribute__( ( aligned( 64 ) ) );
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        const int last = s->count[lane] - 1, row = i < last ? i : last;
        const float* p = s->from + s->at[lane] + (ptrdiff_t)( row > 0 ? row : 0 ) * 3 * WISP_LANES;
        for ( int axis = 0; axis < 3; ++axis )
        {
            rows[axis * WISP_LANES + lane] = s->count[lane] > 0 ? p[axis * WISP_LANES] : 0.0f;
        }
    }
    return lane16v_load( rows );
}

// Computes a + fraction (b - a), which is exactly a if both are equal.
static lane16v between( lane16v a, lane16v b, float fraction )
{
    return lane16v_mul_add( a, lane16_set1( fraction ), lane16v_sub( b, a ) );
}

// Evaluates groups of four vertices that share their ends. Where fewer are left, a line or a quadratic is written
// as a cubic.
static segment16 shared_ends( const curve_source* s, int segment )
{
    const int first = 3 * segment;
    segment16 c = { { vertex( s, first ), vertex( s, first + 1 ), vertex( s, first + 2 ), vertex( s, first + 3 ) } };
    const lane16i left = lane16i_sub( s->last, lane16i_set1( first ) );
    const lane16m line = lane16i_lt( left, lane16i_set1( 2 ) ), quadratic = lane16i_eq( left, lane16i_set1( 2 ) );
    if ( lane16m_any( lane16m_or( line, quadratic ) ) )
    {
        // beyond a lane's last vertex, all four are that vertex
        const lane16v middle = c.p[1], end = c.p[3];
        c.p[1] = lane16v_select( quadratic, between( c.p[0], middle, 2.0f / 3.0f ), c.p[1] );
        c.p[2] = lane16v_select( quadratic, between( middle, end, 1.0f / 3.0f ), c.p[2] );
        c.p[1] = lane16v_select( line, between( c.p[0], end, 1.0f / 3.0f ), c.p[1] );
        c.p[2] = lane16v_select( line, between( c.p[0], end, 2.0f / 3.0f ), c.p[2] );
    }
    return c;
}

// Moves a point p next to a joint onto the line through it along `tangent`, at the distance that it has. Without a direction it
// stays.
static lane16v onto_tangent( lane16v joint, lane16v p, lane16v tangent, float sign, lane16m where )
{
    const lane16 length = lane16v_length( tangent ), distance = lane16v_length( lane16v_sub( p, joint ) );
    const lane16m directed = lane16m_and( where, lane16_lt( lane16_zero(), length ) );
    const lane16 factor = lane16_div( lane16_mul( lane16_set1( sign ), distance ), length );
    return lane16v_select( directed, lane16v_mul_add( joint, factor, tangent ), p );
}

// Evaluates groups of four vertices whose joints have one tangent, along the vertices at both sides of a joint.
static segment16 shared_tangents( const curve_source* s, int segment )
{
    const int first = 3 * segment, end = first + 3;
    segment16 c = shared_ends( s, segment );
    if ( segment > 0 )
    {
        const lane16v along = lane16v_sub( vertex( s, first + 1 ), vertex( s, first - 1 ) );
        c.p[1] = onto_tangent( c.p[0], c.p[1], along, 1.0f, lane16i_lt( lane16i_set1( first ), s->last ) );
    }
    const lane16m goes_on = lane16i_lt( lane16i_set1( end ), s->last );
    if ( lane16m_any( goes_on ) )
    {
        const lane16v along = lane16v_sub( vertex( s, end + 1 ), vertex( s, end - 1 ) );
        c.p[2] = onto_tangent( c.p[3], c.p[2], along, -1.0f, goes_on );
    }
    return c;
}

// Evaluates one segment between two vertices and their neighbours. Beyond an end the strand is extended straight,
// so the tangent there is the one-sided difference.
static segment16 neighbours( const curve_source* s, int segment )
{
    const lane16 two = lane16_set1( 2.0f );
    segment16 c = { { vertex( s, segment - 1 ), vertex( s, segment ), vertex( s, segment + 1 ),
                      vertex( s, segment + 2 ) } };
    if ( segment == 0 )
    {
        c.p[0] = lane16v_sub( lane16v_scale( c.p[1], two ), c.p[2] );
    }
    const lane16m at_end = lane16i_lt( s->last, lane16i_set1( segment + 2 ) );
    if ( lane16m_any( at_end ) )
    {
        c.p[3] = lane16v_select( at_end, lane16v_sub( lane16v_scale( c.p[2], two ), c.p[1] ), c.p[3] );
    }
    return c;
}

static void draw_segment( const wisp_strand_curve_args* args, segment16 c, float* to, int samples )
{
    for ( int k = 0; k < samples; ++k )
    {
        const float* weight = args->weight + 4 * (size_t)k;
        lane16v sum = lane16v_scale( c.p[0], lane16_set1( weight[0] ) );
        for ( int n = 1; n < 4; ++n )
        {
            sum = lane16v_mul_add( sum, lane16_set1( weight[n] ), c.p[n] );
        }
        lane16v_store( to + (size_t)k * 3 * WISP_LANES, sum );
    }
}

void KERNEL( strand_curve )( const wisp_strand_curve_args* args, int begin, int end )
{
    for ( int group = begin; group < end; ++group )
    {
        const curve_source source = source_of( args, group );
        const int row_count = args->group_row[group + 1] - args->group_row[group];
        float* to = args->to + (size_t)args->group_row[group] * 3 * WISP_LANES;
        lane16v_store( to, vertex( &source, 0 ) );
        for ( int segment = 0; 1 + segment * args->samples < row_count; ++segment )
        {
            const segment16 c =
                args->shares_ends ? shared_tangents( &source, segment ) : neighbours( &source, segment );
            draw_segment( args, c, to + ( 1 + (size_t)segment * (size_t)args->samples ) * 3 * WISP_LANES,
                          args->samples );
        }
    }
}
