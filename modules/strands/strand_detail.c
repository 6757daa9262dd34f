// Strands come to rest relative to their roots. In and out: velocities. That of a root is what took it to where it is.
#include "strand_passes.h"

#include "strand_rows.h"

bool strands_slow_is_due( wisp_frame* frame, wisp_entity strands, void* user )
{
    (void)user;
    return wisp_frame_detail( frame, strands ).keep < 1.0f;
}

void strands_slow( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    const float keep = wisp_frame_detail( frame, span->entity ).keep;
    for ( int g = span->begin; g < span->end; ++g )
    {
        const float* root = velocity + strands_vector( t->group_row[g], 0 );
        for ( int row = t->group_row[g] + 1; row < t->group_row[g + 1]; ++row )
        {
            float* v = velocity + strands_vector( row, 0 );
            for ( int i = 0; i < 3 * WISP_LANES; ++i )
            {
                v[i] = root[i] + keep * ( v[i] - root[i] );
            }
        }
    }
}
