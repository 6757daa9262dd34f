// Contact of surfaces, which corrects the positions that the solver leaves. In: positions after the correction, and the
// displacement that the solve gave. Out: velocities; for the correction, the half spaces outside bodies.
//
//   c = ( x - x_previous ) - ( way of the solve ),   v <- v + c / h
//
// What moves position and previous position alike (recovery, untangling) gives no velocity. After a correction BDF2 starts again
// with a substep of Euler: it would extrapolate the impact, and a particle at rest would keep half the velocity g h.
#include "implicit_internal.h"

#include <string.h>

// ---- half spaces ----

// The body of a row ends where the particle is, or half a margin in front of the body if it is farther: where one lands.
int32_t implicit_fill_half_spaces( const implicit_contact_input* f, int slot, const float* from, const float* x,
                                   float ( *rows )[16] )
{
    int32_t count = 0;
    for ( int place = 0; place < WISP_MAX_PARTICLE_CONTACTS; ++place )
    {
        const size_t at = (size_t)slot * WISP_MAX_PARTICLE_CONTACTS + (size_t)place;
        if ( f->body[at] == 0 )
        {
            continue;
        }
        const float *plane = f->plane + 4 * at, *motion = f->motion + 4 * at, *friction = f->friction + 3 * at;
        float* row = rows[count++];
        memset( row, 0, 16 * sizeof( float ) );
        float gap = plane[3];
        for ( int k = 0; k < 3; ++k )
        {
            const float carried = f->seconds * motion[k];
            gap += plane[k] * ( x[k] - from[k] - carried );
            row[k] = x[k];
            row[3 + k] = plane[k];
            row[6 + k] = carried;
        }
        row[9] = fminf( gap, 0.5f * motion[3] ) - gap;
        row[14] = friction[0];
        row[15] = friction[1];
    }
    return count;
}

// ---- velocities ----

void implicit_take_correction( wisp_frame* frame, const wisp_span* span, void* user )
{
    const implicit_state* state = user;
    const wisp_entity e = span->entity;
    const float *position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
                *previous = wisp_frame_column( frame, e, WISP_PARTICLE_PREVIOUS, 0 ),
                *way = wisp_frame_column( frame, e, state->solved, 0 );
    float* velocity = wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 );
    const float h = wisp_frame_dt( frame, e );
    const size_t slots = (size_t)wisp_frame_fabric( frame, e )->slot_count;
    bool is_corrected = false;
    for ( size_t i = 0; i < slots * 4; ++i )
    {
        const float correction =
            i % 4 < 3 && position[i | 3] > 0.0f ? position[i] - previous[i] - way[i / 4 * 3 + i % 4] : 0.0f;
        velocity[i] += correction / h;
        is_corrected = is_corrected || correction != 0.0f;
    }
    implicit_material* material = wisp_frame_column( frame, e, state->material, 0 );
    if ( is_corrected && material->bdf2 != 0 )
    {
        material->before = 0.0f;
        wisp_frame_count( frame, WISP_COUNT_FIRST_ORDER, 1 );
    }
}
