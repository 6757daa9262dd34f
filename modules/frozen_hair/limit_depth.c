// 2.5D: how far freezing may move vertices along z, which is depth. A vertex beyond the limit is brought back to it, and its
// segment keeps its length, which is that of eq. 3, by more or less of its x and y. The rest of the strand follows by the
// same shift, so strands that stay within the limit keep their bits.
#include "frozen_hair_state.h"

#include <math.h>

static const size_t ROW = (size_t)3 * WISP_LANES;

static float within( float z, float centre, float limit )
{
    const float low = centre - limit, high = centre + limit;
    return z < low ? low : z > high ? high : z;
}

// Factor for x and y of a segment whose z became `dz`. One that is steeper than its length allows, or has no x and y, is as
// long as its depth.
static float stretch_in_plane( float dx, float dy, float dz_before, float dz )
{
    const float across = dx * dx + dy * dy;
    const float wanted = across + dz_before * dz_before - dz * dz;
    return across > 1e-24f && wanted > 0.0f ? sqrtf( wanted / across ) : 0.0f;
}

// @param base, rows [row_count][3][16] m, of one lane
static void limit_strand( const float* base, float* rows, int row_count, float limit )
{
    float before[3] = { rows[0], rows[WISP_LANES], rows[2 * WISP_LANES] }, shift[2] = { 0.0f, 0.0f };
    float z_before = before[2];
    for ( int i = 1; i < row_count; ++i )
    {
        base += ROW;
        rows += ROW;
        const float p[3] = { rows[0], rows[WISP_LANES], rows[2 * WISP_LANES] };
        const float z = within( p[2], base[2 * WISP_LANES], limit );
        const float dx = p[0] - before[0], dy = p[1] - before[1], dz = z - z_before, dz_frozen = p[2] - before[2];
        if ( dz != dz_frozen )
        {
            const float more = stretch_in_plane( dx, dy, dz_frozen, dz ) - 1.0f;
            shift[0] += more * dx;
            shift[1] += more * dy;
        }
        rows[0] = p[0] + shift[0];
        rows[WISP_LANES] = p[1] + shift[1];
        rows[2 * WISP_LANES] = z;
        z_before = z;
        before[0] = p[0];
        before[1] = p[1];
        before[2] = p[2];
    }
}

void frozen_limit_depth( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const frozen_depth* depth = wisp_frame_column( frame, span->entity, state->depth, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const bool posed = wisp_frame_has( frame, span->entity, WISP_STRAND_POSED );
    const float* base = wisp_frame_column( frame, span->entity, posed ? WISP_STRAND_POSED : WISP_STRAND_REST, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    for ( int group = span->begin; group < span->end; ++group )
    {
        const size_t first = (size_t)t->group_row[group] * ROW;
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            limit_strand( base + first + lane, position + first + lane, t->group_row[group + 1] - t->group_row[group],
                          depth->max_change );
        }
    }
}
