#include "cook_strands.h"

#include "alloc.h"

#include <string.h>

// Sorts strands by decreasing length with a stable counting sort. It costs O(strands + longest strand), and the
// longest strand has at most as many vertices as all together.
static bool sort_by_length( const wisp_allocator* allocator, const int32_t* offsets, int count, int longest,
                            int32_t* order )
{
    size_t bytes = ( (size_t)longest + 2 ) * sizeof( int32_t );
    int32_t* place = base_allocate( allocator, bytes, 64 );
    if ( place == NULL )
    {
        return false;
    }
    memset( place, 0, bytes );
    for ( int s = 0; s < count; ++s )
    {
        place[longest - ( offsets[s + 1] - offsets[s] ) + 1] += 1;
    }
    for ( int i = 0; i < longest; ++i )
    {
        place[i + 1] += place[i];
    }
    for ( int s = 0; s < count; ++s )
    {
        order[place[longest - ( offsets[s + 1] - offsets[s] )]++] = s;
    }
    base_release( allocator, place, bytes );
    return true;
}

static size_t padded( size_t bytes )
{
    return ( bytes + 63 ) & ~(size_t)63;
}

// Takes the next array from the block.
static int32_t* take_array( char** cursor, size_t count )
{
    int32_t* array = (int32_t*)(void*)*cursor;
    *cursor += padded( count * sizeof( int32_t ) );
    return array;
}

static void fill_lanes( wisp_strand_topology* t, const int32_t* offsets, const int32_t* order, int laned,
                        int32_t* group_row, int32_t* lane_strand, int32_t* lane_count )
{
    group_row[0] = 0;
    for ( int g = 0; g < t->group_count; ++g )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            int i = g * WISP_LANES + lane;
            lane_strand[i] = i < laned ? order[i] : -1;
            lane_count[i] = i < laned ? offsets[order[i] + 1] - offsets[order[i]] : 0;
        }
        // sorted by decreasing length, so lane 0 has the longest strand of a group
        group_row[g + 1] = group_row[g] + lane_count[g * WISP_LANES];
    }
    t->row_count = group_row[t->group_count];
}

cook_strands* cook_strands_create( const wisp_allocator* allocator, const int32_t* offsets, int strand_count,
                                   int dimension )
{
    int longest = 0, laned = 0;
    for ( int s = 0; s < strand_count; ++s )
    {
        int length = offsets[s + 1] - offsets[s];
        longest = length > longest ? length : longest;
        laned += length > 0 ? 1 : 0;
    }
    size_t group_count = ( (size_t)laned + WISP_LANES - 1 ) / WISP_LANES;
    size_t lanes = group_count * WISP_LANES, strands = (size_t)strand_count;
    size_t bytes = padded( sizeof( cook_strands ) ) + padded( ( strands + 1 ) * 4 ) +
                   padded( ( group_count + 1 ) * 4 ) + 2 * padded( lanes * 4 );
    cook_strands* cooked = base_allocate( allocator, bytes, 64 );
    int32_t* order = base_allocate( allocator, ( strands + 1 ) * sizeof( int32_t ), 64 );
    bool complete =
        cooked != NULL && order != NULL && sort_by_length( allocator, offsets, strand_count, longest, order );
    if ( complete )
    {
        memset( cooked, 0, bytes );
        *cooked = ( cook_strands ){ .allocator = allocator, .bytes = bytes, .instances = 1 };
        wisp_strand_topology* t = &cooked->topology;
        t->strand_count = strand_count;
        t->vertex_count = offsets[strand_count];
        t->group_count = (int)group_count;
        t->dimension = dimension;
        char* cursor = (char*)cooked + padded( sizeof( cook_strands ) );
        int32_t* own_offsets = take_array( &cursor, strands + 1 );
        int32_t* group_row = take_array( &cursor, group_count + 1 );
        int32_t* lane_strand = take_array( &cursor, lanes );
        int32_t* lane_count = take_array( &cursor, lanes );
        memcpy( own_offsets, offsets, ( strands + 1 ) * sizeof( int32_t ) );
        fill_lanes( t, own_offsets, order, laned, group_row, lane_strand, lane_count );
        t->offsets = own_offsets;
        t->group_row = group_row;
        t->lane_strand = lane_strand;
        t->lane_count = lane_count;
    }
    base_release( allocator, order, ( strands + 1 ) * sizeof( int32_t ) );
    if ( complete == false )
    {
        base_release( allocator, cooked, bytes );
        return NULL;
    }
    return cooked;
}

void cook_strands_retain( cook_strands* strands )
{
    strands->instances += 1;
}

void cook_strands_release( cook_strands* strands )
{
    if ( strands != NULL && --strands->instances == 0 )
    {
        base_release( strands->allocator, strands, strands->bytes );
    }
}

void cook_strands_pack( const wisp_strand_topology* t, const wisp_vec3* points, float* rows )
{
    for ( int g = 0; g < t->group_count; ++g )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            int strand = t->lane_strand[g * WISP_LANES + lane];
            int count = t->lane_count[g * WISP_LANES + lane];
            for ( int row = t->group_row[g]; row < t->group_row[g + 1]; ++row )
            {
                float* to = rows + (size_t)row * 3 * WISP_LANES + lane;
                int i = row - t->group_row[g];
                wisp_vec3 p = { 0.0f, 0.0f, 0.0f };
                if ( strand >= 0 )
                {
                    p = points[t->offsets[strand] + ( i < count ? i : count - 1 )];
                }
                to[0] = p.x;
                to[WISP_LANES] = p.y;
                to[2 * WISP_LANES] = p.z;
            }
        }
    }
}
