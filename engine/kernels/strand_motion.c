// Time integration of strands, sixteen at a time: prediction, velocity, and what BDF2 looks back on.
#include "strand_history.h"

static const size_t STRIDE = 3 * WISP_LANES;

// Values shared by all rows of a substep, or of a group in it.
typedef struct motion_terms
{
    lane16 dt, inverse_dt;       // s, 1/s, of the implicit steps of free vertices
    lane16 whole, inverse_whole; // s, 1/s, of the substep, in which pinned vertices move
    lane16v gain;                // m/s, dt times acceleration, of free vertices
} motion_terms;

static motion_terms motion_terms_of( const wisp_strand_motion_args* args )
{
    const lane16 dt = lane16_set1( args->dt ), inverse = lane16_set1( 1.0f / args->dt );
    return ( motion_terms ){ dt, inverse, dt, inverse, lane16v_scale( lane16v_set1( args->acceleration ), dt ) };
}

// Finds the terms of a group whose strands have steps of their own.
static motion_terms own_terms( const wisp_strand_motion_args* args, int group )
{
    motion_terms terms = motion_terms_of( args );
    terms.dt = history16_dt( &args->history, args->group_row[group], args->dt );
    terms.inverse_dt = lane16_div( lane16_set1( 1.0f ), terms.dt );
    terms.gain = lane16v_scale( lane16v_set1( args->acceleration ), terms.dt );
    return terms;
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
                          lane16v_select( is_free, s.velocity, lane16v_scale( path, terms->inverse_whole ) ) };
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

// ---- history ----

// Ratio of the lengths of two substeps in a row, up to which the history of the first is scaled to the second.
static const float MAX_RATIO_ERROR = 0.01f;

// How the strands of a group look back.
typedef struct look_back
{
    lane16m is_second; // strands of second order
    lane16 fraction;   // of the last displacement, and of the last change of velocity
} look_back;

// Chooses the order of each strand of a group, and the length of its step.
static look_back choose_order( const wisp_strand_motion_args* args, int group )
{
    float* step = args->history.step + (size_t)args->group_row[group] * WISP_LANES;
    const lane16 past = lane16_load( step ), whole = lane16_set1( args->dt ), one = lane16_set1( 1.0f );
    const lane16 ratio = lane16_div( whole, past );
    const lane16m is_second = lane16_le( lane16_abs( lane16_sub( ratio, one ) ), lane16_set1( MAX_RATIO_ERROR ) );
    const lane16m is_new = lane16_eq( past, lane16_zero() );
    const lane16 by_euler = lane16_select( is_new, whole, lane16_neg( whole ) );
    lane16_store( step, lane16_select( is_second, lane16_set1( history16_short( args->dt ) ), by_euler ) );
    return ( look_back ){ is_second, lane16_mul( lane16_set1( 1.0f / 3.0f ), ratio ) };
}

static int count_lanes( lane16m lanes )
{
    int count = 0;
    for ( uint32_t bits = lane16m_bits( lanes ); bits != 0; bits &= bits - 1 )
    {
        count += 1;
    }
    return count;
}

// Keeps what the next substep can look back on.
// @return number of strands that made this one by Euler, without those that were new
static int end_order( const wisp_strand_motion_args* args, int group )
{
    const int first = args->group_row[group], last = args->group_row[group + 1];
    float* at = args->history.step + (size_t)first * WISP_LANES;
    const lane16 step = lane16_load( at ), whole = lane16_set1( args->dt ), zero = lane16_zero();
    lane16_store( at, lane16_select( lane16_lt( step, lane16_neg( whole ) ), step, whole ) );
    const lane16m by_euler = lane16_lt( step, zero );
    lane16m moves = lane16_lt( zero, zero );
    for ( int row = first; row < last && lane16m_any( by_euler ); ++row )
    {
        moves = lane16m_or( moves, is_free_row( args, row ) );
    }
    return count_lanes( lane16m_and( moves, by_euler ) );
}

// Finds how far the vertices of a row moved in a substep.
LANE_INLINE lane16v path_of_row( const wisp_strand_motion_args* args, const motion_terms* terms, int row,
                                 lane16v velocity )
{
    const lane16v none = { lane16_zero(), lane16_zero(), lane16_zero() };
    const lane16v shift = lane16v_load( args->history.displacement + (size_t)row * STRIDE );
    return lane16v_select( is_free_row( args, row ), lane16v_mul_add( shift, terms->dt, velocity ), none );
}

// Looks back on a substep in which a row moved by `path`: shifts its start, and extrapolates its velocity.
LANE_INLINE row_state extrapolate_row( const wisp_strand_motion_args* args, const look_back* back, int row,
                                       row_state s, lane16v path )
{
    const size_t at = (size_t)row * STRIDE;
    const lane16v none = { lane16_zero(), lane16_zero(), lane16_zero() };
    const lane16m moves = lane16m_and( back->is_second, is_free_row( args, row ) );
    const lane16v change = lane16v_sub( s.velocity, lane16v_load( args->history.before + at ) );
    const lane16v further = lane16v_mul_add( s.velocity, back->fraction, change );
    const lane16v shift = lane16v_select( moves, lane16v_scale( path, back->fraction ), none );
    const lane16v low = lane16v_add( s.low, shift );
    lane16v_store( args->history.before + at, s.velocity );
    lane16v_store( args->history.displacement + at, shift );
    lane16v_store( args->low + at, low );
    return ( row_state ){ s.position, low, lane16v_select( moves, further, s.velocity ) };
}

void KERNEL( strand_extrapolate )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    for ( int g = begin; g < end; ++g )
    {
        const look_back back = choose_order( &mine, g );
        for ( int row = mine.group_row[g]; row < mine.group_row[g + 1]; ++row )
        {
            const size_t at = (size_t)row * STRIDE;
            const row_state s = extrapolate_row( &mine, &back, row, load_row( &mine, row ),
                                                 lane16v_load( mine.history.displacement + at ) );
            lane16v_store( mine.velocity + at, s.velocity );
        }
    }
}

// ---- prediction ----

// What a prediction is told of the whole call, so that each kind is compiled apart.
typedef struct prediction_kind
{
    bool ends_substep; // the last substep is ended first
    bool is_predicted; // there are previous positions
    bool has_history;
} prediction_kind;

// Values shared by all rows of a group.
typedef struct group_terms
{
    motion_terms now;
    lane16v gain;        // m/s, of its strands
    motion_terms ending; // of the last substep, with history
    look_back back;      // from this substep on it
} group_terms;

// Ends the last substep of a row and looks back on it. The bits are those of strand_velocity and strand_extrapolate.
LANE_INLINE row_state look_back_row( const wisp_strand_motion_args* args, const group_terms* terms, int row )
{
    const size_t at = (size_t)row * STRIDE;
    const row_state s = end_row( args, &terms->ending, row, false );
    lane16v_store( args->position + at, s.position );
    return extrapolate_row( args, &terms->back, row, s, path_of_row( args, &terms->ending, row, s.velocity ) );
}

LANE_INLINE row_state begin_row( const wisp_strand_motion_args* args, const group_terms* terms, int row,
                                 prediction_kind kind )
{
    if ( kind.ends_substep == false )
    {
        return load_row( args, row );
    }
    return kind.has_history ? look_back_row( args, terms, row )
                            : advance_row( args, &terms->now, row, kind.is_predicted );
}

LANE_INLINE void predict_group( const wisp_strand_motion_args* args, const group_terms* terms, int g,
                                prediction_kind kind )
{
    const int first = args->group_row[g], last = args->group_row[g + 1];
    const lane16 minus_whole = lane16_neg( terms->now.whole );
    row_state s = begin_row( args, terms, first, kind );
    const lane16v start = s.position;
    s = prescribe_root( args, &terms->now, g, s );
    lane16v_store( args->low + (size_t)first * STRIDE, s.low );
    if ( kind.is_predicted == false )
    {
        lane16v_store( args->position + (size_t)first * STRIDE, s.position );
    }
    place16 p = predict_row( args, &terms->now, terms->gain, first, s, start, kind.is_predicted );
    for ( int row = first + 1; row < last; ++row )
    {
        s = begin_row( args, terms, row, kind );
        const place16 next = predict_row( args, &terms->now, terms->gain, row, s,
                                          lane16v_mul_add( s.position, minus_whole, s.velocity ), kind.is_predicted );
        lane16v_store( args->segment + (size_t)( row - 1 ) * STRIDE, place16_sub( &p, &next ) );
        p = next;
    }
}

// @return as strand_velocity
LANE_INLINE int predict_groups( const wisp_strand_motion_args* args, int begin, int end, prediction_kind kind )
{
    group_terms terms = { .now = motion_terms_of( args ) };
    int count = 0;
    for ( int g = begin; g < end; ++g )
    {
        if ( kind.has_history && kind.ends_substep )
        {
            terms.ending = own_terms( args, g );
            count += end_order( args, g );
            terms.back = choose_order( args, g );
        }
        if ( kind.has_history )
        {
            terms.now = own_terms( args, g );
        }
        terms.gain =
            args->acceleration_scale != NULL
                ? lane16v_scale( terms.now.gain, lane16_load( args->acceleration_scale + (size_t)g * WISP_LANES ) )
                : terms.now.gain;
        predict_group( args, &terms, g, kind );
    }
    return count;
}

void KERNEL( strand_predict )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    const bool has_history = mine.history.step != NULL;
    if ( mine.previous != NULL && has_history )
    {
        (void)predict_groups( &mine, begin, end, ( prediction_kind ){ .is_predicted = true, .has_history = true } );
    }
    else if ( mine.previous != NULL )
    {
        (void)predict_groups( &mine, begin, end, ( prediction_kind ){ .is_predicted = true } );
    }
    else if ( has_history )
    {
        (void)predict_groups( &mine, begin, end, ( prediction_kind ){ .has_history = true } );
    }
    else
    {
        (void)predict_groups( &mine, begin, end, ( prediction_kind ){ .has_history = false } );
    }
}

int KERNEL( strand_advance )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    if ( mine.previous != NULL )
    {
        const int count = KERNEL( strand_velocity )( args, begin, end );
        if ( mine.history.step != NULL )
        {
            KERNEL( strand_extrapolate )( args, begin, end );
        }
        KERNEL( strand_predict )( args, begin, end );
        return count;
    }
    if ( mine.history.step != NULL )
    {
        return predict_groups( &mine, begin, end, ( prediction_kind ){ .ends_substep = true, .has_history = true } );
    }
    return predict_groups( &mine, begin, end, ( prediction_kind ){ .ends_substep = true } );
}

// ---- end of a substep ----

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

// Takes what other passes did to positions. Strands that they moved begin again.
static void take_moves( const wisp_strand_motion_args* args, int group )
{
    const place_columns c = columns_of( args );
    const int first = args->group_row[group], last = args->group_row[group + 1];
    const lane16 dt = history16_dt( &args->history, args->group_row[group], args->dt );
    const lane16m moved = history16_find_moved( &c, first, last, dt );
    if ( lane16m_any( moved ) )
    {
        const restarted_columns out = { args->position, args->low, args->velocity };
        place16_take_all( &c, args->velocity, args->segment, first, last, dt, lane16_div( lane16_set1( 1.0f ), dt ) );
        history16_follow_all( &c, args->position, first, last, dt );
        history16_break( &args->history, &c, &out, first, last, args->dt, moved );
    }
}

// Ends a substep of a group, and keeps how far its vertices moved.
// @return as end_order
LANE_INLINE int end_group( const wisp_strand_motion_args* args, int group, bool is_predicted )
{
    if ( is_predicted )
    {
        take_moves( args, group );
    }
    const motion_terms terms = own_terms( args, group );
    for ( int row = args->group_row[group]; row < args->group_row[group + 1]; ++row )
    {
        const size_t at = (size_t)row * STRIDE;
        const row_state s = advance_row( args, &terms, row, is_predicted );
        lane16v_store( args->history.displacement + at, path_of_row( args, &terms, row, s.velocity ) );
        if ( is_predicted )
        {
            lane16v_store( args->velocity + at, s.velocity );
        }
    }
    return end_order( args, group );
}

int KERNEL( strand_velocity )( const wisp_strand_motion_args* args, int begin, int end )
{
    const wisp_strand_motion_args mine = *args;
    int count = 0;
    for ( int g = begin; g < end && mine.history.step != NULL; ++g )
    {
        count += mine.previous != NULL ? end_group( &mine, g, true ) : end_group( &mine, g, false );
    }
    if ( mine.history.step == NULL && mine.previous != NULL )
    {
        end_rows( &mine, begin, end, true );
    }
    else if ( mine.history.step == NULL )
    {
        end_rows( &mine, begin, end, false );
    }
    return count;
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
