// Contact of surfaces, which corrects the positions that the solver leaves. In: positions after the correction, and the
// displacement that the solve gave. Out: velocities and the history of BDF2; for the correction, the half spaces outside bodies.
//
//   s = x_previous - x_start,   c = ( x - x_previous ) - ( way of the solve ),   v <- v + c / h
//   BDF2: v_before <- v_before + c / h,   x_before <- x_before + s
//
// s is what moved position and previous position alike (recovery, untangling), which gives no velocity. BDF2 must not extrapolate an
// impact, so it counts as having been there when the substep began. Corrections keep momentum, and so does this.
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
                *start = wisp_frame_column( frame, e, state->solved, 0 ),
                *way = wisp_frame_column( frame, e, state->solved, 1 );
    float *velocity = wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 ),
          *x_before = wisp_frame_column( frame, e, state->history, 0 ),
          *v_before = wisp_frame_column( frame, e, state->history, 1 );
    const float h = wisp_frame_dt( frame, e );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( size_t i = (size_t)s.begin * 4; i < (size_t)s.end * 4; ++i )
    {
        const size_t k = i % 4, at = i / 4 * 3 + k;
        if ( k == 3 || position[i / 4 * 4 + 3] == 0.0f )
        {
            continue;
        }
        const float correction = position[i] - previous[i] - way[at];
        velocity[i] += correction / h;
        if ( x_before != NULL )
        {
            x_before[i] += previous[i] - start[at];
            v_before[i] += correction / h;
        }
    }
}
