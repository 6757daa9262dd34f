// Strands out of their lanes into the user's order. Three numbers a vertex, each read once: nothing here to vectorise.
#include "kernel_isa.h"

static void unpack_lane( const wisp_strand_unpack_job* job, int group, int lane )
{
    const float* from = job->position + (size_t)job->group_row[group] * 3 * WISP_LANES + (size_t)lane;
    int strand = job->lane_strand[group * WISP_LANES + lane];
    int count = job->lane_count[group * WISP_LANES + lane];
    float* to = count > 0 ? job->points + 3 * (size_t)job->offsets[strand] : NULL;
    for ( int i = 0; i < count; ++i )
    {
        to[0] = from[0];
        to[1] = from[WISP_LANES];
        to[2] = from[2 * WISP_LANES];
        to += 3;
        from += 3 * WISP_LANES;
    }
}

void KERNEL( strand_unpack )( const wisp_strand_unpack_job* job, int group_begin, int group_end )
{
    for ( int group = group_begin; group < group_end; ++group )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            unpack_lane( job, group, lane );
        }
    }
}
