// Contact of surfaces, which corrects the positions that the solver leaves. In: positions after the correction, and the
// displacement that the solve gave. Out: velocities and the history of BDF2; for the correction, the half spaces outside bodies.
//
//   c = ( x - x_previous ) - h-displacement of the solve,   v <- v + c / h
//
// What moves position and previous position alike (recovery, untangling) gives no velocity.
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

// BDF2 must not extrapolate an impact: along the correction the particle counts as having come with its new velocity.
static void settle( const float correction[3], float h, const float* x, const float* v, float* x_before,
                    float* v_before )
{
    float squared = 0.0f, way = 0.0f, speed = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        squared += correction[k] * correction[k];
        way += correction[k] * ( x[k] - h * v[k] - x_before[k] );
        speed += correction[k] * ( v[k] - v_before[k] );
    }
    for ( int k = 0; k < 3 && squared > 0.0f; ++k )
    {
        x_before[k] += way / squared * correction[k];
        v_before[k] += speed / squared * correction[k];
    }
}

void implicit_take_correction( wisp_frame* frame, const wisp_span* span, void* user )
{
    const implicit_state* state = user;
    const wisp_entity e = span->entity;
    const float *position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 ),
                *previous = wisp_frame_column( frame, e, WISP_PARTICLE_PREVIOUS, 0 ),
                *solved = wisp_frame_column( frame, e, state->solved, 0 );
    float *velocity = wisp_frame_column( frame, e, WISP_PARTICLE_VELOCITY, 0 ),
          *x_before = wisp_frame_column( frame, e, state->history, 0 ),
          *v_before = wisp_frame_column( frame, e, state->history, 1 );
    const float h = wisp_frame_dt( frame, e );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( size_t slot = (size_t)s.begin; slot < (size_t)s.end; ++slot )
    {
        const float *x = position + 4 * slot, *p = previous + 4 * slot, *way = solved + 3 * slot;
        const float correction[3] = { x[0] - p[0] - way[0], x[1] - p[1] - way[1], x[2] - p[2] - way[2] };
        const bool is_corrected = correction[0] != 0.0f || correction[1] != 0.0f || correction[2] != 0.0f;
        if ( x[3] == 0.0f || is_corrected == false )
        {
            continue;
        }
        for ( size_t k = 0; k < 3; ++k )
        {
            velocity[4 * slot + k] += correction[k] / h;
        }
        if ( x_before != NULL )
        {
            settle( correction, h, x, velocity + 4 * slot, x_before + 4 * slot, v_before + 4 * slot );
        }
    }
}
