// Copies strands from lanes to the user's order, by transposing rows of eight lanes.
#include "kernel_isa.h"

enum
{
    EIGHT = 8,
};

// Copies floats [begin, end) of one strand.
static void unpack_lane( const float* from, float* to, int begin, int end )
{
    for ( int k = begin; k < end; ++k )
    {
        to[k] = from[(size_t)k * WISP_LANES];
    }
}

// Copies eight strands with equal numbers of vertices.
// @param to destination of each strand
static void unpack_eight( const float* from, float* const* to, int numbers )
{
    int k = 0;
    for ( ; k + EIGHT <= numbers; k += EIGHT )
    {
        lane8i rows[EIGHT];
        for ( int r = 0; r < EIGHT; ++r )
        {
            rows[r] = lane8_cast_int( lane8_load( from + (size_t)( k + r ) * WISP_LANES ) );
        }
        lane8i_transpose( rows );
        for ( int l = 0; l < EIGHT; ++l )
        {
            lane8_storeu( to[l] + k, lane8_cast_float( rows[l] ) );
        }
    }
    for ( int l = 0; l < EIGHT; ++l )
    {
        unpack_lane( from + l, to[l], k, numbers );
    }
}

static void unpack_half( const wisp_strand_unpack_args* args, int group, int first_lane )
{
    const float* from = args->position + (size_t)args->group_row[group] * 3 * WISP_LANES + (size_t)first_lane;
    const int32_t* strands = args->lane_strand + group * WISP_LANES + first_lane;
    const int32_t* counts = args->lane_count + group * WISP_LANES + first_lane;
    float* to[EIGHT];
    bool alike = true;
    for ( int l = 0; l < EIGHT; ++l )
    {
        to[l] = counts[l] > 0 ? args->points + 3 * (size_t)args->offsets[strands[l]] : NULL;
        alike = alike && counts[l] == counts[0];
    }
    if ( alike )
    {
        unpack_eight( from, to, 3 * counts[0] );
        return;
    }
    for ( int l = 0; l < EIGHT; ++l )
    {
        unpack_lane( from + l, to[l], 0, 3 * counts[l] );
    }
}

void KERNEL( strand_unpack )( const wisp_strand_unpack_args* args, int group_begin, int group_end )
{
    for ( int group = group_begin; group < group_end; ++group )
    {
        for ( int lane = 0; lane < WISP_LANES; lane += EIGHT )
        {
            unpack_half( args, group, lane );
        }
    }
}
