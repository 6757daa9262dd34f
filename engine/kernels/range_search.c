// Neighbours within a radius through the rows of a uniform grid: a row of cells along x is one contiguous run of slots,
// tested eight at a time. Neighbours come in the order of slots, that is by cell, then by the item's own number.
#include "kernel_isa.h"

typedef struct search_query
{
    float x, y, z;
    int32_t owner;
} search_query;

static search_query load_query( const wisp_range_search_job* job, int query )
{
    search_query q;
    memcpy( &q, job->quads + 4 * (size_t)query, sizeof( q ) );
    return q;
}

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

// Appends the slots of [begin, end) within the radius; may write eight past the limit.
static int search_run( const wisp_range_search_job* job, const search_query* q, int begin, int end, int found,
                       int32_t* list )
{
    const lane8 px = lane8_set1( q->x ), py = lane8_set1( q->y ), pz = lane8_set1( q->z );
    const lane8 radius2 = lane8_set1( job->radius * job->radius );
    const lane8i owner = lane8i_set1( q->owner );
    for ( int j = begin; j < end && found <= job->limit; j += 8 )
    {
        lane8 dx = lane8_sub( lane8_loadu( job->x + j ), px );
        lane8 dy = lane8_sub( lane8_loadu( job->y + j ), py );
        lane8 dz = lane8_sub( lane8_loadu( job->z + j ), pz );
        lane8 d2 = lane8_mul_add( dz, dz, lane8_mul_add( dy, dy, lane8_mul( dx, dx ) ) );
        lane8m near = lane8m_and( lane8_lt( d2, radius2 ), lane8m_first( end - j ) );
        near = lane8m_and_not( near, lane8i_eq( lane8i_loadu( job->owner + j ), owner ) );
        if ( lane8m_any( near ) )
        {
            lane8i slot = job->rename != NULL ? lane8i_loadu( job->rename + j )
                                              : lane8i_add( lane8i_set1( j ), lane8i_iota() );
            found += lane8i_compress_store( list + found, slot, near );
        }
    }
    return found;
}

static int search_one( const wisp_range_search_job* job, int query, int32_t* list )
{
    const search_query q = load_query( job, query );
    const int cx = cell_along( job, q.x, 0 ), cy = cell_along( job, q.y, 1 ), cz = cell_along( job, q.z, 2 );
    const int x0 = at_least( cx - job->reach, 0 ), x1 = at_most( cx + job->reach, job->dims[0] - 1 );
    const int y0 = at_least( cy - job->reach, 0 ), y1 = at_most( cy + job->reach, job->dims[1] - 1 );
    const int z0 = at_least( cz - job->reach, 0 ), z1 = at_most( cz + job->reach, job->dims[2] - 1 );
    int found = 0;
    for ( int z = z0; z <= z1; ++z )
    {
        for ( int y = y0; y <= y1; ++y )
        {
            const int32_t* row = job->cell_begin + ( z * job->dims[1] + y ) * job->dims[0];
            found = search_run( job, &q, row[x0], row[x1 + 1], found, list );
        }
    }
    return found;
}

int KERNEL( range_search )( const wisp_range_search_job* job, int slice, int count, int32_t* packed, int32_t* lists,
                            int* capped )
{
    const int stride = job->limit + WISP_SLICE;
    int found[WISP_SLICE] = { 0 }, longest = 0;
    for ( int l = 0; l < count; ++l )
    {
        found[l] = search_one( job, slice * WISP_SLICE + l, lists + l * stride );
        *capped += found[l] > job->limit ? 1 : 0;
        found[l] = at_most( found[l], job->limit );
        longest = at_least( longest, found[l] );
    }
    for ( int l = 0; l < WISP_SLICE; ++l )
    {
        const int32_t* list = lists + l * stride;
        const int32_t pad = slice * WISP_SLICE + ( l < count ? l : 0 );
        for ( int k = 0; k < longest; ++k )
        {
            packed[k * WISP_SLICE + l] = k < found[l] ? list[k] : pad;
        }
    }
    return longest;
}
