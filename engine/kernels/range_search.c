// Neighbours within a radius through the rows of a uniform grid. A row of cells is one contiguous run of slots,
// tested eight at a time. Neighbours are found in slot order: by cell, then by item index.
#include "kernel_isa.h"

static int at_least( int a, int lower )
{
    return a < lower ? lower : a;
}

static int at_most( int a, int upper )
{
    return a > upper ? upper : a;
}

// Eight queries during a search: positions, owners and the ends of their lists.
typedef struct search_slice
{
    float x[WISP_SLICE], y[WISP_SLICE], z[WISP_SLICE];
    int32_t owner[WISP_SLICE];
    int32_t cell[3][WISP_SLICE]; // along axis[0], axis[1], axis[2]
    int32_t *near[WISP_SLICE], *skin[WISP_SLICE];
    int32_t *max_near[WISP_SLICE], *skin_most[WISP_SLICE];
    float within; // m, maximum of the radii
    bool planar;  // all items and queries are in one plane
} search_slice;

// Computes the cell of a query with the same rounding as the grid, so that an item is found in its own cell. Clamps
// before the conversion to an integer.
static lane8i cell_along( const wisp_range_search_args* args, const lane8 place[3], int axis )
{
    lane8 along = lane8_mul( lane8_sub( place[axis], lane8_set1( args->origin[axis] ) ),
                             lane8_set1( args->inverse_cell[axis] ) );
    along = lane8_min( lane8_max( along, lane8_zero() ), lane8_set1( (float)( args->dims[axis] - 1 ) ) );
    return lane8_truncate( along );
}

static void load_queries( const wisp_range_search_args* args, int slice, int count, search_slice* s )
{
    // unused lanes repeat the first query
    const float* xyzw = args->xyzw + 4 * (size_t)slice * WISP_SLICE;
    _Alignas( 32 ) float whole[WISP_SLICE][4];
    for ( int l = 0; l < WISP_SLICE && count < WISP_SLICE; ++l )
    {
        memcpy( whole[l], l < count ? xyzw + 4 * l : xyzw, sizeof( whole[l] ) );
    }
    lane8 place[3], owner;
    lane8_load_xyzw_contiguous( count < WISP_SLICE ? whole[0] : xyzw, place, place + 1, place + 2, &owner );
    lane8_storeu( s->x, place[0] );
    lane8_storeu( s->y, place[1] );
    lane8_storeu( s->z, place[2] );
    lane8i_storeu( s->owner, lane8_cast_int( owner ) );
    for ( int rank = 0; rank < 3; ++rank )
    {
        lane8i_storeu( s->cell[rank], cell_along( args, place, args->axis[rank] ) );
    }
    s->planar = args->planar && lane8m_all( lane8_eq( place[2], lane8_set1( args->origin[2] ) ) );
    s->within = args->skin_radius > args->near_radius ? args->skin_radius : args->near_radius;
}

// Options of the search of a run of slots, constants after inlining.
typedef struct search_law
{
    bool planar;
    bool bounded; // a list may reach the limit
} search_law;

enum
{
    RUN_EIGHTS = 4, // maximum number of vectors of slots that are searched together
};

// Tests some vectors of slots from `begin` against queries [first, last); `inside` masks the last vector. The
// number of vectors is a constant after inlining: runs are short, and the end of a loop would be mispredicted.
// Every vector is packed, even without a hit, because that branch would be unpredictable too.
LANE_INLINE void search_eights( const wisp_range_search_args* args, search_slice* s, int first, int last, int begin,
                                int eights, lane8m inside, search_law law )
{
    const lane8 near2 = lane8_set1( args->near_radius * args->near_radius );
    const lane8 within2 = lane8_set1( s->within * s->within );
    const float *x = args->x + begin, *y = args->y + begin, *z = args->z + begin;
    const int32_t* owner = args->owner + begin;
    const lane8i slot_x4 = lane8i_shift_left( lane8i_add( lane8i_set1( begin ), lane8i_iota() ), 2 );
    for ( int l = first; l < last; ++l )
    {
        const lane8 px = lane8_set1( s->x[l] ), py = lane8_set1( s->y[l] ), pz = lane8_set1( s->z[l] );
        const lane8i own = lane8i_set1( s->owner[l] );
        int32_t *near_end = s->near[l], *skin_end = s->skin[l];
        for ( int e = 0; e < eights; ++e )
        {
            const int j = e * WISP_SLICE;
            lane8 dx = lane8_sub( lane8_loadu( x + j ), px ), dy = lane8_sub( lane8_loadu( y + j ), py );
            lane8 d2 = lane8_mul_add( dy, dy, lane8_mul( dx, dx ) );
            if ( law.planar == false )
            {
                lane8 dz = lane8_sub( lane8_loadu( z + j ), pz );
                d2 = lane8_mul_add( dz, dz, d2 );
            }
            lane8m same = lane8i_eq( lane8i_loadu( owner + j ), own );
            lane8m within = lane8m_and_not( lane8_lt( d2, within2 ), same );
            lane8m near = lane8m_and_not( lane8_lt( d2, near2 ), same );
            if ( e == eights - 1 )
            {
                within = lane8m_and( within, inside );
                near = lane8m_and( near, inside );
            }
            uint32_t near_bits = lane8m_bits( near ), skin_bits = lane8m_bits( within ) ^ near_bits;
            lane8i found_x4 = lane8i_add( slot_x4, lane8i_set1( 4 * j ) );
            near_end += lane8i_compress_store( near_end, found_x4, near_bits );
            skin_end += lane8i_compress_store( skin_end, found_x4, skin_bits );
            if ( law.bounded )
            {
                near_end = near_end < s->max_near[l] ? near_end : s->max_near[l];
                skin_end = skin_end < s->skin_most[l] ? skin_end : s->skin_most[l];
            }
        }
        s->near[l] = near_end;
        s->skin[l] = skin_end;
    }
}

// Tests slots [begin, end) against queries [first, last).
LANE_INLINE void search_run( const wisp_range_search_args* args, search_slice* s, int first, int last, int begin,
                             int end, search_law law )
{
    const lane8m all = lane8m_first( WISP_SLICE );
    for ( ; end - begin > RUN_EIGHTS * WISP_SLICE; begin += RUN_EIGHTS * WISP_SLICE )
    {
        search_eights( args, s, first, last, begin, RUN_EIGHTS, all, law );
    }
    const int eights = ( end - begin + WISP_SLICE - 1 ) / WISP_SLICE;
    const lane8m inside = lane8m_first( end - begin - ( eights - 1 ) * WISP_SLICE );
    switch ( eights )
    {
        case 1:
            search_eights( args, s, first, last, begin, 1, inside, law );
            break;
        case 2:
            search_eights( args, s, first, last, begin, 2, inside, law );
            break;
        case 3:
            search_eights( args, s, first, last, begin, 3, inside, law );
            break;
        case RUN_EIGHTS:
            search_eights( args, s, first, last, begin, RUN_EIGHTS, inside, law );
            break;
        default: // empty run
            break;
    }
}

// Searches rows that queries [first, last) share. A row runs along the fastest axis of the grid; cells from
// `lowest` to `highest` are searched, extended by the reach.
typedef struct search_group
{
    int first, last;
    int lowest, highest;
} search_group;

// Groups neighbouring queries in a row while the shared run of slots is not much longer than the run of each query.
static search_group find_group( const wisp_range_search_args* args, const search_slice* s, int first, int count )
{
    const int32_t *fast = s->cell[0], *middle = s->cell[1], *slow = s->cell[2];
    search_group g = { first, first + 1, fast[first], fast[first] };
    for ( ; g.last < count; ++g.last )
    {
        int lowest = at_most( fast[g.last], g.lowest ), highest = at_least( fast[g.last], g.highest );
        if ( middle[g.last] != middle[first] || slow[g.last] != slow[first] ||
             highest - lowest > 2 * args->cell_reach[0] )
        {
            break;
        }
        g.lowest = lowest;
        g.highest = highest;
    }
    return g;
}

// Returns the first and last cell to search along one axis of the grid.
typedef struct search_span
{
    int first, last;
} search_span;

static search_span reach_from( const wisp_range_search_args* args, int rank, int lowest, int highest )
{
    const int reach = args->cell_reach[rank], dims = args->dims[args->axis[rank]];
    return ( search_span ){ at_least( lowest - reach, 0 ), at_most( highest + reach, dims - 1 ) };
}

static void search_rows( const wisp_range_search_args* args, search_slice* s, search_group g )
{
    const search_span fast = reach_from( args, 0, g.lowest, g.highest );
    const search_span middle = reach_from( args, 1, s->cell[1][g.first], s->cell[1][g.first] );
    const search_span slow = reach_from( args, 2, s->cell[2][g.first], s->cell[2][g.first] );
    const int length = args->dims[args->axis[0]], rows = args->dims[args->axis[1]];
    int left = args->limit; // no list can reach the limit before this many slots were tested
    for ( int c = slow.first; c <= slow.last; ++c )
    {
        const int32_t* row = args->cell_begin + ( c * rows + middle.first ) * length;
        for ( int b = middle.first; b <= middle.last; ++b, row += length )
        {
            int begin = row[fast.first], end = row[fast.last + 1];
            left = at_least( left - ( end - begin ), -1 );
            if ( s->planar && left >= 0 )
            {
                search_run( args, s, g.first, g.last, begin, end, ( search_law ){ true, false } );
            }
            else if ( s->planar )
            {
                search_run( args, s, g.first, g.last, begin, end, ( search_law ){ true, true } );
            }
            else
            {
                search_run( args, s, g.first, g.last, begin, end, ( search_law ){ false, true } );
            }
        }
    }
}

// Sets the length of each list of a slice, and the maximum.
static void count_found( const search_slice* s, int limit, wisp_range_search_result* result )
{
    const int stride = 2 * limit + WISP_SEARCH_PADDING, skin_stride = limit + WISP_SEARCH_PADDING;
    int capped = 0, near_length = 0, length = 0;
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        int near = (int)( s->near[l] - result->lists ) - l * stride;
        int skin = (int)( s->skin[l] - result->skin ) - l * skin_stride;
        capped += near > limit || skin > limit ? 1 : 0;
        near = at_most( near, limit );
        result->near_count[l] = near;
        result->count[l] = near + at_most( skin, limit );
        near_length = at_least( near_length, near );
        length = at_least( length, result->count[l] );
    }
    result->capped += capped;
    result->near_length = near_length;
    result->length = length;
}

// Appends the skin to the near neighbours, in groups of eight.
static void append_skin( int limit, wisp_range_search_result* result )
{
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        int32_t* out = result->lists + l * ( 2 * limit + WISP_SEARCH_PADDING ) + result->near_count[l];
        const int32_t* skin = result->skin + l * ( limit + WISP_SEARCH_PADDING );
        const int count = result->count[l] - result->near_count[l];
        int k = 0;
        do
        {
            lane8i_storeu( out + k, lane8i_loadu( skin + k ) );
            k += WISP_SLICE;
        } while ( k < count );
    }
}

void KERNEL( range_search )( const wisp_range_search_args* args, int slice, int count,
                             wisp_range_search_result* result )
{
    const int limit = args->limit, stride = 2 * limit + WISP_SEARCH_PADDING,
              skin_stride = limit + WISP_SEARCH_PADDING;
    search_slice s;
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        s.near[l] = result->lists + l * stride;
        s.skin[l] = result->skin + l * skin_stride;
        // one entry beyond the limit marks an overflow
        s.max_near[l] = s.near[l] + limit + 1;
        s.skin_most[l] = s.skin[l] + limit + 1;
    }
    load_queries( args, slice, count, &s );
    for ( search_group g = { 0, 0, 0, 0 }; g.last < count; )
    {
        g = find_group( args, &s, g.last, count );
        search_rows( args, &s, g );
    }
    count_found( &s, limit, result );
    append_skin( limit, result );
}

static void rename_all( const int32_t* rename, int32_t* list, int count )
{
    for ( int k = 0; k < count; ++k )
    {
        list[k] = 4 * rename[list[k] / 4];
    }
}

// Loads eight entries of a list, with the query's own slot beyond its end.
LANE_INLINE lane8i load_padded( const int32_t* list, int k, int count, int own4 )
{
    lane8m inside = lane8m_first( count - k );
    return lane8i_select( inside, lane8i_loadu( list + k ), lane8i_set1( own4 ) );
}

void KERNEL( interleave )( int32_t* lists, int stride, const int* counts, int slice, const int32_t* rename,
                           int32_t* packed )
{
    int longest = 0;
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        longest = at_least( longest, counts[l] );
        if ( rename != NULL )
        {
            rename_all( rename, lists + l * stride, counts[l] );
        }
    }
    for ( int k = 0; k < longest; k += WISP_SLICE )
    {
        lane8i rows[WISP_SLICE];
        for ( int l = 0; l < WISP_SLICE; ++l )
        {
            rows[l] = load_padded( lists + l * stride, k, counts[l], 4 * ( slice * WISP_SLICE + l ) );
        }
        lane8i_transpose( rows );
        for ( int l = 0; l < at_most( longest - k, WISP_SLICE ); ++l )
        {
            lane8i_storeu( packed + ( k + l ) * WISP_SLICE, rows[l] );
        }
    }
}
