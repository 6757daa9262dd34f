// The pass. In: predicted positions of the surfaces. Out: positions with seams, which pairs broke.
//
// With d = x_a - x_b, n = d / |d|, L the distance that the pair holds now, w inverse masses, a = compliance / dt^2 and p the impulse
// that the vertex of `a` has received in the substep (Macklin, Mueller, Chentanez 2016, eq. 17-18):
//
//   L > 0:  dp = -( |d| - L + a n.p ) / ( w_a + w_b + a ) n
//   L = 0:  dp = -( d + a p ) / ( w_a + w_b + a )            in which no direction has to be divided by |d|
//   x_a += w_a dp,  x_b -= w_b dp
//
// The force of a pair is p / dt^2. Seams are projected in the order in which they were added, each colour by colour, so results do not
// depend on the number of workers. A solver of velocities has moved its particles already: what moves them on is added
// to their velocities.
#include "seams_state.h"

#include <math.h>

enum
{
    PAIR_GRAIN = 512, // pairs per block
};

// m^2: pairs farther apart, and those whose distance is not finite, are left alone. The engine halts the surface that strayed, and the
// other one does not see its numbers.
static const float FARTHEST2 = 1e12f;

// One of the two surfaces.
typedef struct seam_side
{
    float* position; // [slot][4]
    float* velocity; // [slot][4] of a surface that a solver of velocities has moved; null otherwise
    float mobility;  // 0: the surface is halted
} seam_side;

typedef struct seam_loop
{
    seam_side side[2];
    const int32_t* ends_x4;
    float *rest, *impulse;
    int32_t* broken;
    seam_settings settings;
    float alpha;      // m^2/(N s^2)
    float inverse_dt; // 1/s
    float closing;    // m, in the substep
    bool is_first;
    int first_row; // of the colour
} seam_loop;

static void move_end( const seam_side* side, int32_t x4, const float change[3], float weight, float inverse_dt )
{
    for ( int k = 0; k < 3; ++k )
    {
        side->position[x4 + k] += weight * change[k];
        if ( side->velocity != NULL )
        {
            side->velocity[x4 + k] += weight * change[k] * inverse_dt;
        }
    }
}

// Bring the distance that a pair holds nearer to that of the seam.
static float approach( float rest, float distance, float step )
{
    return rest > distance ? fmaxf( rest - step, distance ) : fminf( rest + step, distance );
}

static float dot( const float* a, const float* b )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void project_pair( const seam_loop* loop, int row )
{
    const int32_t a = loop->ends_x4[2 * row], b = loop->ends_x4[2 * row + 1];
    const float *xa = loop->side[0].position + a, *xb = loop->side[1].position + b;
    const float wa = loop->side[0].mobility * xa[3], wb = loop->side[1].mobility * xb[3], rest = loop->rest[row];
    const float d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] }, length2 = dot( d, d );
    float* p = loop->impulse + 3 * (size_t)row;
    if ( wa + wb == 0.0f || !( length2 <= FARTHEST2 ) || ( rest > 0.0f && length2 == 0.0f ) )
    {
        return; // the last: it has no direction
    }
    const float scale = -1.0f / ( wa + wb + loop->alpha );
    float change[3];
    if ( rest > 0.0f )
    {
        const float length = sqrtf( length2 );
        const float excess = length - rest + loop->alpha * dot( d, p ) / length;
        for ( int k = 0; k < 3; ++k )
        {
            change[k] = scale * excess * ( d[k] / length );
        }
    }
    else
    {
        for ( int k = 0; k < 3; ++k )
        {
            change[k] = scale * ( d[k] + loop->alpha * p[k] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        p[k] += change[k];
    }
    move_end( loop->side, a, change, wa, loop->inverse_dt );
    move_end( loop->side + 1, b, change, -wb, loop->inverse_dt );
}

float seams_pull( const float impulse[3], const float d[3], float rest, float inverse_dt2 )
{
    const float force = sqrtf( dot( impulse, impulse ) ) * inverse_dt2;
    return rest > 0.0f && dot( impulse, d ) > 0.0f ? -force : force;
}

static float pull_of( const seam_loop* loop, int row )
{
    const float *xa = loop->side[0].position + loop->ends_x4[2 * row],
                *xb = loop->side[1].position + loop->ends_x4[2 * row + 1];
    const float d[3] = { xa[0] - xb[0], xa[1] - xb[1], xa[2] - xb[2] };
    return seams_pull( loop->impulse + 3 * (size_t)row, d, loop->rest[row], loop->settings.inverse_dt2 );
}

static void project_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const seam_loop* loop = context;
    for ( int row = loop->first_row + begin; row < loop->first_row + end; ++row )
    {
        if ( loop->broken[row] != 0 )
        {
            continue;
        }
        if ( loop->is_first )
        {
            loop->rest[row] = approach( loop->rest[row], loop->settings.distance, loop->closing );
            loop->impulse[3 * row] = loop->impulse[3 * row + 1] = loop->impulse[3 * row + 2] = 0.0f;
        }
        project_pair( loop, row );
    }
}

// Break the pairs that are pulled by more than the strength.
static void break_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const seam_loop* loop = context;
    for ( int row = begin; row < end; ++row )
    {
        if ( loop->broken[row] == 0 && pull_of( loop, row ) > loop->settings.strength )
        {
            loop->broken[row] = 1;
            loop->impulse[3 * row] = loop->impulse[3 * row + 1] = loop->impulse[3 * row + 2] = 0.0f;
        }
    }
}

static seam_side open_side( wisp_frame* frame, wisp_entity surface )
{
    const bool is_halted = wisp_frame_is_halted( frame, surface );
    const bool is_external = is_halted == false && wisp_frame_has( frame, surface, WISP_PARTICLE_EXTERNAL_SOLVER );
    return ( seam_side ){
        .position = wisp_frame_column( frame, surface, WISP_PARTICLE_POSITION, 0 ),
        .velocity = is_external ? wisp_frame_column( frame, surface, WISP_PARTICLE_VELOCITY, 0 ) : NULL,
        .mobility = is_halted ? 0.0f : 1.0f,
    };
}

static void project_seam( wisp_frame* frame, const wisp_span* span, const seams_state* state, const seam_topology* s )
{
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    seam_settings* settings = wisp_frame_column( frame, s->entity, state->settings, 0 );
    const float dt = wisp_frame_dt( frame, span->entity ), inverse_dt = 1.0f / dt;
    settings->inverse_dt2 = inverse_dt * inverse_dt;
    seam_loop loop = {
        .side = { open_side( frame, s->a ), open_side( frame, s->b ) },
        .ends_x4 = s->ends_x4,
        .rest = wisp_frame_column( frame, s->entity, state->pairs, 0 ),
        .impulse = wisp_frame_column( frame, s->entity, state->pairs, 1 ),
        .broken = wisp_frame_column( frame, s->entity, state->pairs, 2 ),
        .settings = *settings,
        .alpha = settings->compliance * settings->inverse_dt2,
        .inverse_dt = inverse_dt,
        .closing = settings->closing_speed * dt,
        .is_first = span->iteration == 0,
    };
    for ( int c = 0; c < s->colour_count; ++c )
    {
        const int count = s->colour_begin[c + 1] - s->colour_begin[c];
        loop.first_row = s->colour_begin[c];
        wisp_parallel_for( parallel, count, c == SEAM_COLOURS - 1 ? count : PAIR_GRAIN, project_rows, &loop );
    }
    if ( settings->strength < INFINITY && span->iteration + 1 == wisp_frame_iterations( frame ) )
    {
        wisp_parallel_for( parallel, s->pair_count, PAIR_GRAIN, break_rows, &loop );
    }
}

void seams_project( wisp_frame* frame, const wisp_span* span, void* user )
{
    const seams_state* state = user;
    for ( int i = 0; i < state->count; ++i )
    {
        if ( state->seams[i].a.index != 0 )
        {
            project_seam( frame, span, state, state->seams + i );
        }
    }
}
