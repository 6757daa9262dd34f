// Time integration of strands, sixteen at a time: prediction, velocity, damping towards a rigid motion, air.
#include "strand_place.h"

static const size_t STRIDE = 3 * WISP_LANES;

// Values shared by all rows of a substep.
typedef struct motion_terms
{
    lane16 dt, inverse_dt; // s, 1/s
    lane16v gain;          // m/s, dt times acceleration, of free vertices
} motion_terms;

static motion_terms motion_terms_of( const wisp_strand_motion_args* args )
{
    const lane16 dt = lane16_set1( args->dt );
    return ( motion_terms ){ dt, lane16_set1( 1.0f / args->dt ),
                             lane16v_scale( lane16v_set1( args->acceleration ), dt ) };
}

LANE_INLINE lane16m is_free_row( const wisp_strand_motion_args* args, int row )
{
    return lane16_lt( lane16_zero(), lane16_load( args->inverse_mass + (size_t)row * WISP_LANES ) );
}

LANE_INLINE place_columns columns_of( const wisp_strand_motion_args* args )
{
    return ( place_columns ){ args->position, args->previous, args->low, args->velocity, args->inverse_mass };
}

// A row between two substeps.
typedef struct row_state
{
    lane16v position, low, velocity;
} row_state;

LANE_INLINE row_state load_row( const wisp_strand_motion_args* args, int row )
{
    const size_t at = (size_t)row * STRIDE;
    return ( row_state ){ lane16v_load( args->position + at ), lane16v_load( args->low + at ),
                          lane16v_load( args->velocity + at ) };
}

// Ends the substep of a row: velocities take corrections of positions by other passes, or positions follow velocities
// if there were none.
LANE_INLINE row_state end_row( const wisp_strand_motion_args* args, const motion_terms* terms, int row,
                               bool is_predicted )
{
    const place_columns c = columns_of( args );
    place16 p = place16_load( &c, row, terms->dt, is_predicted );
    if ( is_predicted )
    {
        const lane16v correction = place16_correction( &c, row, &p );
        p.velocity = lane16v_mul_add( p.velocity, terms->inverse_dt, correction );
        p.moved = place16_moved( p.low, p.velocity, p.inverse_mass, terms->dt );
    }
    const lane16v end =
        is_predicted ? lane16v_load( args->position + (size_t)row * STRIDE ) : lane16v_add( p.start, p.moved );
    return ( row_state ){ end, place16_remainder( p.start, p.moved, end ), p.velocity };
}

// Puts a pinned root where it is prescribed to be, with the velocity that takes it there.
LANE_INLINE row_state prescribe_root( const wisp_strand_motion_args* args, const motion_terms* terms, int group,
                                      row_state s )
{
    if ( args->root == NULL )
    {
        const lane16 zero = lane16_zero();
        const lane16v none = { zero, zero, zero };
        const lane16m is_free = is_free_row( args, args->group_row[group] );
        return ( row_state ){ s.position, s.low, lane16v_select( is_free, s.velocity, none ) };
    }
    const lane16m is_free = is_free_row( args, args->group_row[group] );
    const lane16v root = lane16v_load( args->root + (size_t)group * STRIDE );
    const lane16v low = lane16v_load( args->root_low + (size_t)group * STRIDE );
    const lane16v path = lane16v_add( lane16v_sub( root, s.position ), lane16v_sub( low, s.low ) );
    return ( row_state ){ lane16v_select( is_free, s.position, root ), lane16v_select( is_free, s.low, low ),
                          lane16v_select( is_free, s.velocity, lane16v_scale( path, terms->inverse_dt ) ) };
}

// Predicts a row. Pinned vertices are at their end positions; their velocity gives their start.
// @param start of pinned vertices
// @return where the vertices are at the end of the substep
LANE_INLINE place16 predict_row( const wisp_strand_motion_args* args, const motion_terms* terms, lane16v gain,
                                 int row, row_state s, lane16v start, bool is_predicted )
{
    const size_t at = (size_t)row * STRIDE;
    const lane16 zero = lane16_zero();
    const lane16v none = { zero, zero, zero };
    const lane16 w = lane16_load( args->inverse_mass + (size_t)row * WISP_LANES );
    const lane16m is_free = lane16_lt( zero, w );
    const lane16v velocity = lane16v_add( s.velocity, lane16v_select( is_free, gain, none ) );
    const place16 p = { s.position, place16_moved( s.low, velocity, w, terms->dt ), s.low, velocity, w };
    lane16v_store( args->velocity + at, velocity );
    lane16_store( args->speed + (size_t)row * WISP_LANES, lane16v_dot( velocity, velocity ) );
    if ( is_predicted )
    {
        lane16v_store( args->previous + at, lane16v_select( is_free, s.position, start ) );
        lane16v_store( args->position + at, lane16v_add( p.start, p.moved ) );
    }
    return p;
}

// Ends the last substep of a row, and keeps what the prediction does not.
LANE_INLINE row_state advance_row( const wisp_strand_motion_args* args, const motion_terms* terms, int row,
                                   bool is_predicted )
{
    const row_state s = end_row( args, terms, row, is_predicted );
    lane16v_store( args->low + (size_t)row * STRIDE, s.low );
    if ( is_predicted == false )
    {
        lane16v_store( args->position + (size_t)row * STRIDE, s.position );
    }
    return s;
}

// What a prediction is told of the whole call, so that each kind is compiled apart.
typedef struct prediction_kind
{
    bool ends_substep; // the last substep is ended first
    bool is_predicted; // there are previous positions
} prediction_kind;

LANE_INLINE row_state begin_row( const wisp_strand_motion_args* args, const motion_terms* terms, int row,
                                 prediction_kind kind )
{
    return kind.ends_substep ? advance_row( args, terms, row, kind.is_predicted ) : load_row( args, row );
}

LANE_INLINE void predict_group( const wisp_strand_motion_args* args, const motion_terms* terms, lane16v gain, int g,
                                prediction_kind kind )
{
    const int first = args->group_row[g], last = args->group_row[g + 1];
    const lane16 minus_dt = lane16_neg( terms->dt );
    row_state s = begin_row( args, terms, first, kind );
    const lane16v start = s.position;
    s = prescribe_root( args, terms, g, s );
    lane16v_store( args->low + (size_t)first * STRIDE, s.low );
    if ( kind.is_predicted == false )
    {
        lane16v_store( args->position + (size_t)first * STRIDE, s.position );
    }
    place16 p = predict_row( args, terms, gain, first, s, start, kind.is_predicted );
    for ( int row = first + 1; row < last; ++row )
    {
        s = begin_row( args, terms, row, kind );
        const place16 next = predict_row( args, terms, gain, row, s,
                                          lane16v_mul_add( s.position, minus_dt, s.velocity ), kind.is_predicted );
        lane16v_store( args->segment + (size_t)( row - 1 ) * STRIDE, place16_sub( &p, &next ) );
        p = next;
    }
}

LANE_INLINE void predict_groups( const wisp_strand_motion_args* args, int begin, int end, prediction_kind kind )
{
    const motion_terms terms = motion_terms_of( args );
    for ( int g = begin; g < end; ++g )
    {
        const lane16v gain =
            args->acceleration_scale != NULL
                ? lane16v_scale( terms.gain, lane16_load( args->acceleration_scale + (size_t)g * WISP_LANES ) )
                : terms.gain;
        predict_group( args, &terms, gain, g, kind );
    }
}

LANE_INLINE void predict_all( const wisp_strand_motion_args* args, int begin, int end, bool ends_substep )
{
    if ( args->previous != NULL )
    {
        predict_groups( args, begin, end, ( prediction_kind ){ ends_substep, true } );
    }
    else
    {
        predict_groups( args, begin, end, ( prediction_kind ){ ends_substep, false } );
    }
}

void KERNEL( strand_predict )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    predict_all( &mine, begin, end, false );
}

void KERNEL( strand_advance )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    predict_all( &mine, begin, end, true );
}

LANE_INLINE void end_rows( const wisp_strand_motion_args* args, int begin, int end, bool is_predicted )
{
    const motion_terms terms = motion_terms_of( args );
    for ( int row = args->group_row[begin]; row < args->group_row[end]; ++row )
    {
        const row_state s = advance_row( args, &terms, row, is_predicted );
        if ( is_predicted )
        {
            lane16v_store( args->velocity + (size_t)row * STRIDE, s.velocity );
        }
    }
}

void KERNEL( strand_velocity )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    if ( mine.previous != NULL )
    {
        end_rows( &mine, begin, end, true );
    }
    else
    {
        end_rows( &mine, begin, end, false );
    }
}

LANE_INLINE lane16m is_within( const float* row, lane16 bound )
{
    const lane16v v = lane16v_load( row );
    return lane16m_and( lane16m_and( lane16_le( lane16_abs( v.x ), bound ), lane16_le( lane16_abs( v.y ), bound ) ),
                        lane16_le( lane16_abs( v.z ), bound ) );
}

int KERNEL( strand_find_out_of_bounds )( const wisp_strand_bound_args* args, int begin, int end )
{
    const wisp_strand_bound_args mine = *args;
    const lane16 bound = lane16_set1( mine.bound );
    for ( int row = begin; row < end; ++row )
    {
        const size_t at = (size_t)row * STRIDE;
        const lane16m within =
            lane16m_and( is_within( mine.position + at, bound ), is_within( mine.velocity + at, bound ) );
        if ( lane16m_all( within ) == false )
        {
            return row;
        }
    }
    return end;
}

void KERNEL( strand_damp )( const wisp_strand_damp_args* args, int begin, int end )
{
    const wisp_strand_damp_args mine = *args;
    const lane16v linear = lane16v_set1( mine.linear ), angular = lane16v_set1( mine.angular );
    const lane16v centre = lane16v_set1( mine.centre );
    const lane16 keep = lane16_set1( mine.retained_fraction );
    for ( int row = mine.group_row[begin]; row < mine.group_row[end]; ++row )
    {
        const size_t at = (size_t)row * STRIDE;
        const lane16v v = lane16v_load( mine.velocity + at );
        const lane16v arm = lane16v_sub( lane16v_load( mine.position + at ), centre );
        const lane16v rigid = lane16v_add( linear, lane16v_cross( angular, arm ) );
        const lane16v damped = lane16v_mul_add( rigid, keep, lane16v_sub( v, rigid ) );
        const lane16m is_free =
            lane16_lt( lane16_zero(), lane16_load( mine.inverse_mass + (size_t)row * WISP_LANES ) );
        lane16v_store( mine.velocity + at, lane16v_select( is_free, damped, v ) );
    }
}

// Applies drag to half of the two segments at a vertex, in the direction from neighbour to neighbour. With a = drag
// L |u| w dt of the normal wind u, the vertex gains a / (1 + a) of u, however strong the wind.
void KERNEL( strand_air )( const wisp_strand_air_args* args, int begin, int end )
{
    const wisp_strand_air_args mine = *args;
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f ), tiny = lane16_set1( 1e-30f );
    const lane16 half_drag_dt = lane16_set1( 0.5f * mine.drag * mine.dt );
    const lane16v wind = lane16v_set1( mine.wind );
    for ( int g = begin; g < end; ++g )
    {
        const int first = mine.group_row[g], last = mine.group_row[g + 1] - 1;
        lane16 length_before = zero;
        for ( int row = first; row <= last; ++row )
        {
            const size_t at = (size_t)row * STRIDE, lanes = (size_t)row * WISP_LANES;
            const lane16 length = lane16_load( mine.length + lanes );
            const lane16v from = lane16v_load( mine.position + ( row > first ? at - STRIDE : at ) );
            const lane16v to = lane16v_load( mine.position + ( row < last ? at + STRIDE : at ) );
            const lane16v own = lane16v_load( mine.position + at );
            const lane16v along = lane16v_sub( lane16v_select( lane16_lt( zero, length ), to, own ), from );
            const lane16v v = lane16v_load( mine.velocity + at ), u = lane16v_sub( wind, v );
            const lane16 fraction =
                lane16_div( lane16v_dot( u, along ), lane16_max( lane16v_dot( along, along ), tiny ) );
            const lane16v across = lane16v_sub( u, lane16v_scale( along, fraction ) );
            const lane16 reach = lane16_mul( half_drag_dt, lane16_add( length_before, length ) );
            const lane16 weight = lane16_load( mine.inverse_mass + lanes );
            const lane16 a = lane16_mul( lane16_mul( reach, weight ), lane16v_length( across ) );
            lane16v_store( mine.velocity + at, lane16v_mul_add( v, lane16_div( a, lane16_add( one, a ) ), across ) );
            length_before = length;
        }
    }
}
