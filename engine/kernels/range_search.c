// Neighbours within a radius through the rows of a uniform grid: a row of cells is one contiguous run of slots, tested
// eight at a time. Neighbours come in the order of slots, that is by cell, then by the item's own number.
#include "kernel_isa.h"

// Eight queries while they are searched: what they ask, and a near and a shell list each.
typedef struct search_slice
{
    float x[WISP_SLICE], y[WISP_SLICE], z[WISP_SLICE];
    int32_t owner[WISP_SLICE];
    int cell[WISP_SLICE][3];
    int32_t *near[WISP_SLICE], *shell[WISP_SLICE];
    int near_count[WISP_SLICE], shell_count[WISP_SLICE]; // one beyond the limit says that there were more
    bool planar;                                         // all in the items' own plane
} search_slice;

// The same rounding as the grid's when it was built, so that an item is found in the cell it was put into.
static int cell_along( const wisp_range_search_job* job, float coordinate, int axis )
{
    int cell = (int)( ( coordinate - job->origin[axis] ) * job->inverse_cell );
    return cell < 0 ? 0 : ( cell >= job->dims[axis] ? job->dims[axis] - 1 : cell );
}

static int at_least( int a, int low )
{
    return a < low ? low : a;
}

static int at_most( int a, int high )
{
    return a > high ? high : a;
}

static void load_queries( const wisp_range_search_job* job, int slice, int count, search_slice* s )
{
    s->planar = job->planar;
    for ( int l = 0; l < count; ++l )
    {
        const float* q = job->quads + 4 * ( (size_t)slice * WISP_SLICE + (size_t)l );
        s->x[l] = q[0];
        s->y[l] = q[1];
        s->z[l] = q[2];
        s->planar = s->planar && q[2] == job->origin[2];
        memcpy( s->owner + l, q + 3, sizeof( int32_t ) );
        for ( int axis = 0; axis < 3; ++axis )
        {
            s->cell[l][axis] = cell_along( job, q[axis], axis );
        }
    }
}

// Slots [begin, end) against queries [first, last). Every vector is packed, hit or not: the branch would be a coin toss.
// `planar` is a constant where this is inlined.
LANE_INLINE void search_run( const wisp_range_search_job* job, search_slice* s, int first, int last, int begin,
                             int end, bool planar )
{
    const lane8 near2 = lane8_set1( job->near_radius * job->near_radius );
    const lane8 shell2 = lane8_set1( job->shell_radius * job->shell_radius );
    const int most = job->limit + 1;
    for ( int j = begin; j < end; j += WISP_SLICE )
    {
        lane8 x = lane8_loadu( job->x + j ), y = lane8_loadu( job->y + j ), z = lane8_loadu( job->z + j );
        lane8i owner = lane8i_loadu( job->owner + j );
        lane8i slot =
            job->rename != NULL ? lane8i_loadu( job->rename + j ) : lane8i_add( lane8i_set1( j ), lane8i_iota() );
        lane8m inside = lane8m_first( end - j );
        for ( int l = first; l < last; ++l )
        {
            lane8 dx = lane8_sub( x, lane8_set1( s->x[l] ) );
            lane8 dy = lane8_sub( y, lane8_set1( s->y[l] ) );
            lane8 d2 = lane8_mul_add( dy, dy, lane8_mul( dx, dx ) );
            if ( planar == false )
            {
                lane8 dz = lane8_sub( z, lane8_set1( s->z[l] ) );
                d2 = lane8_mul_add( dz, dz, d2 );
            }
            lane8m others = lane8m_and_not( inside, lane8i_eq( owner, lane8i_set1( s->owner[l] ) ) );
            lane8m near = lane8m_and( lane8_lt( d2, near2 ), others );
            lane8m shell = lane8m_and_not( lane8m_and( lane8_lt( d2, shell2 ), others ), near );
            int near_count = s->near_count[l], shell_count = s->shell_count[l];
            near_count += lane8i_compress_store( s->near[l] + near_count, slot, near );
            shell_count += lane8i_compress_store( s->shell[l] + shell_count, slot, shell );
            s->near_count[l] = at_most( near_count, most );
            s->shell_count[l] = at_most( shell_count, most );
        }
    }
}

// Cells to look at along one of the grid's axes, first and last.
typedef struct search_span
{
    int first, last;
} search_span;

static search_span span_along( const wisp_range_search_job* job, const int* cell, int axis )
{
    return ( search_span ){ at_least( cell[axis] - job->reach, 0 ),
                            at_most( cell[axis] + job->reach, job->dims[axis] - 1 ) };
}

// Queries of one cell look at the same rows. A row runs along the grid's fastest axis.
static void search_cell( const wisp_range_search_job* job, search_slice* s, int first, int last )
{
    const int* cell = s->cell[first];
    const search_span fast = span_along( job, cell, job->axis[0] );
    const search_span middle = span_along( job, cell, job->axis[1] );
    const search_span slow = span_along( job, cell, job->axis[2] );
    for ( int c = slow.first; c <= slow.last; ++c )
    {
        for ( int b = middle.first; b <= middle.last; ++b )
        {
            const int32_t* row = job->cell_begin + ( c * job->dims[job->axis[1]] + b ) * job->dims[job->axis[0]];
            int begin = row[fast.first], end = row[fast.last + 1];
            if ( s->planar )
            {
                search_run( job, s, first, last, begin, end, true );
            }
            else
            {
                search_run( job, s, first, last, begin, end, false );
            }
        }
    }
}

static void search_all( const wisp_range_search_job* job, search_slice* s, int count )
{
    for ( int first = 0, last; first < count; first = last )
    {
        last = first + 1;
        while ( last < count && memcmp( s->cell[first], s->cell[last], sizeof( s->cell[first] ) ) == 0 )
        {
            ++last;
        }
        search_cell( job, s, first, last );
    }
}

// Eight lists side by side, one a lane, as long as the longest; a lane's own number fills its end. Numbers are stored
// times four, so that a quad is addressed without a shift. @return that length
static int pack( int32_t* const lists[WISP_SLICE], int counts[WISP_SLICE], const int32_t pads[WISP_SLICE], int limit,
                 int32_t* packed )
{
    int longest = 0;
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        counts[l] = at_most( counts[l], limit );
        longest = at_least( longest, counts[l] );
    }
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        for ( int k = counts[l]; k < longest; k += WISP_SLICE )
        {
            lane8i_storeu( lists[l] + k, lane8i_set1( pads[l] ) );
        }
    }
    for ( int k = 0; k < longest; k += WISP_SLICE )
    {
        lane8i rows[WISP_SLICE];
        for ( int l = 0; l < WISP_SLICE; ++l )
        {
            rows[l] = lane8i_loadu( lists[l] + k );
        }
        lane8i_transpose( rows );
        for ( int l = 0; l < WISP_SLICE; ++l )
        {
            lane8i_storeu( packed + ( k + l ) * WISP_SLICE, lane8i_shift_left( rows[l], 2 ) );
        }
    }
    return longest;
}

void KERNEL( range_search )( const wisp_range_search_job* job, int slice, int count,
                             wisp_range_search_result* result )
{
    const int stride = job->limit + WISP_SEARCH_SLACK;
    search_slice s;
    int32_t pads[WISP_SLICE];
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        s.near[l] = result->scratch + l * stride;
        s.shell[l] = result->scratch + ( WISP_SLICE + l ) * stride;
        s.near_count[l] = s.shell_count[l] = 0;
        pads[l] = slice * WISP_SLICE + l;
    }
    load_queries( job, slice, count, &s );
    search_all( job, &s, count );
    for ( int l = 0; l < count; ++l )
    {
        result->capped += s.near_count[l] > job->limit || s.shell_count[l] > job->limit ? 1 : 0;
    }
    result->near_length = pack( s.near, s.near_count, pads, job->limit, result->near );
    result->shell_length = pack( s.shell, s.shell_count, pads, job->limit, result->shell );
}
