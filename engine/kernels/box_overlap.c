// Overlap of boxes, eight at a time, and sorting of short lists.
#include "kernel_isa.h"

enum
{
    MAX_EIGHTS = WISP_MAX_SHARED_AABBS / WISP_SLICE,
    MAX_SLICES = 4,
};

// Tests a few groups of eight slots for overlap with a query. Comparing and packing are two loops: the chain from a
// comparison to a packed list is longer than the processor's reorder window.
LANE_INLINE void compare( const wisp_aabb_stream* s, const float* box, int32_t above, const int32_t* eights,
                          int count, lane8m* hits )
{
    const float *low_x = s->lower[0], *low_y = s->lower[1], *low_z = s->lower[2];
    const float *high_x = s->upper[0], *high_y = s->upper[1], *high_z = s->upper[2];
    const lane8 from_x = lane8_set1( box[0] ), from_y = lane8_set1( box[1] ), from_z = lane8_set1( box[2] );
    const lane8 to_x = lane8_set1( box[3] ), to_y = lane8_set1( box[4] ), to_z = lane8_set1( box[5] );
    const lane8i least = lane8i_set1( above );
    for ( int k = 0; k < count; ++k )
    {
        const int j = eights[k];
        lane8m x =
            lane8m_and( lane8_ge( to_x, lane8_loadu( low_x + j ) ), lane8_le( from_x, lane8_loadu( high_x + j ) ) );
        lane8m y =
            lane8m_and( lane8_ge( to_y, lane8_loadu( low_y + j ) ), lane8_le( from_y, lane8_loadu( high_y + j ) ) );
        lane8m z =
            lane8m_and( lane8_ge( to_z, lane8_loadu( low_z + j ) ), lane8_le( from_z, lane8_loadu( high_z + j ) ) );
        lane8m is_requested = lane8i_lt( least, lane8i_loadu( s->item + j ) );
        hits[k] = lane8m_and( lane8m_and( x, y ), lane8m_and( z, is_requested ) );
    }
}

// Pack every group of eight, even without a hit: the branch would be unpredictable.
LANE_INLINE int32_t* pack( const int32_t* item, const int32_t* eights, int count, const lane8m* hits, int32_t* found )
{
    for ( int k = 0; k < count; ++k )
    {
        found += lane8i_compress_store( found, lane8i_loadu( item + eights[k] ), lane8m_bits( hits[k] ) );
    }
    return found;
}

static void test_eights( const wisp_aabb_stream* stream, const int32_t* eights, int count, wisp_aabb_group* group )
{
    lane8m hits[MAX_EIGHTS];
    for ( int l = 0; l < group->count; ++l )
    {
        group->found[l] = l > 0 ? group->found[l - 1] + group->found_count[l - 1] + WISP_SLICE : group->found[0];
        compare( stream, group->box[l], group->above[l], eights, count, hits );
        int32_t* end = pack( stream->item, eights, count, hits, group->found[l] + group->found_count[l] );
        group->found_count[l] = (int)( end - group->found[l] );
    }
}

void KERNEL( box_overlap )( const wisp_aabb_stream* stream, const int32_t* runs, int run_count,
                            wisp_aabb_group* group )
{
    int32_t eights[MAX_EIGHTS];
    int count = 0;
    for ( int r = 0; r < run_count; ++r )
    {
        for ( int slot = runs[2 * r]; slot < runs[2 * r + 1]; slot += WISP_SLICE )
        {
            if ( count == MAX_EIGHTS )
            {
                test_eights( stream, eights, count, group );
                count = 0;
            }
            eights[count++] = slot;
        }
    }
    test_eights( stream, eights, count, group );
}

// Places each number at the count of smaller ones. Numbers are below 2^31, so the sign of a difference compares
// them. `slices` is a constant after inlining. Padding is larger than all items and is written past the end of the
// list.
LANE_INLINE void order_slices( const int32_t* items, int slices, int32_t* out )
{
    int32_t place[MAX_SLICES * WISP_SLICE];
    lane8i mine[MAX_SLICES], sum[MAX_SLICES];
    for ( int i = 0; i < slices; ++i )
    {
        mine[i] = lane8i_loadu( items + WISP_SLICE * i );
        sum[i] = lane8i_set1( 0 );
    }
    for ( int k = 0; k < WISP_SLICE * slices; ++k )
    {
        const lane8i other = lane8i_set1( items[k] );
        for ( int i = 0; i < slices; ++i )
        {
            sum[i] = lane8i_add( sum[i], lane8i_shift_right( lane8i_sub( other, mine[i] ), 31 ) );
        }
    }
    for ( int i = 0; i < slices; ++i )
    {
        lane8i_storeu( place + WISP_SLICE * i, sum[i] );
    }
    for ( int i = 0; i < WISP_SLICE * slices; ++i )
    {
        out[place[i]] = items[i];
    }
}

static void order_many( const int32_t* items, int count, int32_t* out )
{
    int32_t place[WISP_SLICE];
    for ( int i = 0; i < count; i += WISP_SLICE )
    {
        const lane8i mine = lane8i_loadu( items + i );
        lane8i sum = lane8i_set1( 0 );
        for ( int k = 0; k < count; ++k )
        {
            sum = lane8i_add( sum, lane8i_shift_right( lane8i_sub( lane8i_set1( items[k] ), mine ), 31 ) );
        }
        lane8i_storeu( place, sum );
        for ( int l = 0; l < WISP_SLICE; ++l )
        {
            out[place[l]] = items[i + l];
        }
    }
}

void KERNEL( sort_items )( int32_t* items, int count, int32_t* out )
{
    lane8i_storeu( items + count, lane8i_set1( INT32_MAX ) );
    switch ( ( count + WISP_SLICE - 1 ) / WISP_SLICE )
    {
        case 0:
            break;
        case 1:
            order_slices( items, 1, out );
            break;
        case 2:
            order_slices( items, 2, out );
            break;
        case 3:
            order_slices( items, 3, out );
            break;
        case 4:
            order_slices( items, 4, out );
            break;
        default:
            order_many( items, count, out );
            break;
    }
}
