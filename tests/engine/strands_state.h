/// Groups of strands of many lengths, and all arrays that the arguments of strand kernels point to.
#pragma once

#include "kernels_fixture.h"

enum
{
    STRAND_GROUPS = 8,
    // vertices of each group's longest strands: equal in pairs, and different
    STRAND_ROWS = 3 + 20 + 20 + 9 + 1 + 1 + 2 + 2,
};

typedef struct strands_state
{
    _Alignas( 64 ) float position[STRAND_ROWS][3][16];
    float previous[STRAND_ROWS][3][16], velocity[STRAND_ROWS][3][16], low[STRAND_ROWS][3][16],
        segment[STRAND_ROWS][3][16];
    float speed[STRAND_ROWS][16];
    float weight[STRAND_ROWS][16], length[STRAND_ROWS][16], tension[STRAND_ROWS][16];
    float max_tension[STRAND_ROWS][16];
    float rest2[STRAND_ROWS][16], lambda[STRAND_ROWS][16]; // of links two apart
    float inverse_length[STRAND_ROWS][16], stiffness[STRAND_ROWS][16], factor[STRAND_ROWS][3][16];
    float frame[STRAND_ROWS][4][16], rest[STRAND_ROWS][3][16], rest_twist[STRAND_ROWS][2][16];
    float twist_stiffness[STRAND_ROWS][16];
    float root[STRAND_GROUPS][3][16], root_low[STRAND_GROUPS][3][16], turn[STRAND_GROUPS][4][16],
        clamp[STRAND_GROUPS][4][16];
    float fraction[STRAND_GROUPS][16];
    float displacement[STRAND_ROWS][3][16], before[STRAND_ROWS][3][16], step[STRAND_ROWS][16];
    float first_order_factor[STRAND_ROWS][3][16];
    float scratch[20 * WISP_STRAND_SCRATCH];
    int32_t group_row[STRAND_GROUPS + 1];
    int count[STRAND_GROUPS][16]; // vertices of a lane's strand
    bool has_history;
} strands_state;

static inline float strand_random( int row, int lane, int what, float lower, float upper )
{
    return test_random_float( row * 16 + lane, what, lower, upper );
}

// A frame whose z axis points along e.
static inline void strand_frame( float ( *frame )[16], int lane, const float e[3] )
{
    const double length = sqrt( (double)( e[0] * e[0] + e[1] * e[1] + e[2] * e[2] ) );
    const double t[3] = { e[0] / length, e[1] / length, e[2] / length };
    const double norm = sqrt( 2.0 * ( 1.0 + t[2] ) );
    frame[0][lane] = (float)( -t[1] / norm );
    frame[1][lane] = (float)( t[0] / norm );
    frame[2][lane] = 0.0f;
    frame[3][lane] = (float)( ( 1.0 + t[2] ) / norm );
}

// The start of a substep of 1/600 s that ends at the positions, and the segments there.
static inline void find_start( strands_state* s )
{
    for ( int i = 0; i < STRAND_ROWS * 48; ++i )
    {
        const int row = i / 48, k = i / 16 % 3, lane = i % 16;
        const float path = s->weight[row][lane] > 0.0f ? s->velocity[row][k][lane] / 600.0f : 0.0f;
        const float v = s->velocity[row][k][lane];
        s->speed[row][lane] = ( k > 0 ? s->speed[row][lane] : 0.0f ) + v * v;
        s->previous[row][k][lane] = s->position[row][k][lane] - path;
        if ( row > 0 )
        {
            s->segment[row - 1][k][lane] = s->position[row - 1][k][lane] - s->position[row][k][lane];
        }
    }
}

// Strands of about 5 mm a segment that wander upward; lane l of a group lacks l / 4 vertices of the longest.
static inline void make_strands( strands_state* s )
{
    static const int LONGEST[STRAND_GROUPS] = { 3, 20, 20, 9, 1, 1, 2, 2 };
    memset( s, 0, sizeof( *s ) );
    for ( int g = 0; g < STRAND_GROUPS; ++g )
    {
        s->group_row[g + 1] = s->group_row[g] + LONGEST[g];
        for ( int lane = 0; lane < 16; ++lane )
        {
            s->count[g][lane] = LONGEST[g] - lane / 4 > 0 ? LONGEST[g] - lane / 4 : ( lane == 15 ? 0 : 1 );
            s->turn[g][3][lane] = s->clamp[g][3][lane] = 1.0f;
            s->fraction[g][lane] = strand_random( g, lane, 18, 0.2f, 1.0f );
            float at[3] = { 0.02f * (float)lane, 0.01f * (float)g, 0.0f };
            for ( int row = s->group_row[g]; row < s->group_row[g + 1]; ++row )
            {
                const int i = row - s->group_row[g], left = s->count[g][lane] - 1 - i;
                const float step[3] = { strand_random( row, lane, 0, -2e-3f, 2e-3f ),
                                        strand_random( row, lane, 1, -2e-3f, 2e-3f ), 4.5e-3f };
                for ( int k = 0; k < 3; ++k )
                {
                    s->position[row][k][lane] = s->count[g][lane] > 0 ? at[k] : 0.0f;
                    s->root[g][k][lane] =
                        i == 0 ? at[k] + strand_random( row, lane, 2 + k, 0.0f, 1e-3f ) : s->root[g][k][lane];
                    s->velocity[row][k][lane] =
                        left >= 0 && i > 0 ? strand_random( row, lane, 5 + k, -1.0f, 1.0f ) : 0.0f;
                    at[k] += left > 0 ? step[k] : 0.0f;
                }
                s->weight[row][lane] = i > 0 && left >= 0 ? strand_random( row, lane, 8, 1e7f, 3e7f ) : 0.0f;
                s->length[row][lane] = left > 0 ? strand_random( row, lane, 9, 4e-3f, 6e-3f ) : 0.0f;
                s->inverse_length[row][lane] = left > 0 ? 1.0f / s->length[row][lane] : 0.0f;
                s->rest2[row][lane] = left > 1 ? strand_random( row, lane, 10, 8e-3f, 1.1e-2f ) : -1.0f;
                s->lambda[row][lane] = strand_random( row, lane, 11, -1e-9f, 1e-9f );
                s->tension[row][lane] = left > 0 ? strand_random( row, lane, 12, -1e-5f, 1e-4f ) : 0.0f;
                s->max_tension[row][lane] = 6e-5f;
                s->stiffness[row][lane] = left > 0 ? strand_random( row, lane, 13, 1e-6f, 3e-6f ) : 0.0f;
                s->twist_stiffness[row][lane] = left > 0 ? 0.7f * s->stiffness[row][lane] : 0.0f;
                s->factor[row][0][lane] = 0.1f * s->weight[row][lane];
                s->factor[row][1][lane] = left >= 0 && i > 1 ? strand_random( row, lane, 14, -0.5f, 0.1f ) : 0.0f;
                s->factor[row][2][lane] = left >= 0 && i > 2 ? strand_random( row, lane, 15, 0.0f, 0.2f ) : 0.0f;
                strand_frame( s->frame[row], lane, step );
                s->rest_twist[row][0][lane] = 0.8f;
                s->rest_twist[row][1][lane] = 0.6f;
                for ( int k = 0; k < 2; ++k )
                {
                    s->rest[row][k][lane] = left > 0 ? strand_random( row, lane, 16 + k, -0.3f, 0.3f ) : 0.0f;
                }
            }
        }
    }
    find_start( s );
}

// What BDF2 looks back on after a substep of 1/600 s: of half of the strands nothing, or what was lost.
static inline void make_history( strands_state* s )
{
    s->has_history = true;
    for ( int i = 0; i < STRAND_ROWS * 48; ++i )
    {
        const int row = i / 48, k = i / 16 % 3, lane = i % 16;
        const float v = s->velocity[row][k][lane];
        s->before[row][k][lane] = 0.9f * v;
        s->displacement[row][k][lane] = s->weight[row][lane] > 0.0f ? v / 600.0f : 0.0f;
        s->step[row][lane] = lane % 4 == 3 ? -1.0f : lane % 4 == 2 ? 0.0f : 1.0f / 600.0f;
        s->first_order_factor[row][k][lane] = 1.1f * s->factor[row][k][lane];
    }
}

static inline wisp_strand_history history_of( strands_state* s )
{
    return s->has_history ? ( wisp_strand_history ){ s->displacement[0][0], s->before[0][0], s->step[0] }
                          : ( wisp_strand_history ){ .step = NULL };
}

static inline wisp_strand_motion_args motion_args( strands_state* s, float dt )
{
    return ( wisp_strand_motion_args ){ .group_row = s->group_row,
                                        .position = s->position[0][0],
                                        .previous = s->previous[0][0],
                                        .speed = s->speed[0],
                                        .segment = s->segment[0][0],
                                        .low = s->low[0][0],
                                        .velocity = s->velocity[0][0],
                                        .inverse_mass = s->weight[0],
                                        .root = s->root[0][0],
                                        .root_low = s->root_low[0][0],
                                        .acceleration = { 0.5f, -9.81f, 0.25f },
                                        .acceleration_scale = s->fraction[0],
                                        .dt = dt,
                                        .history = history_of( s ) };
}

static inline wisp_strand_stretch_args stretch_args( strands_state* s, float dt, int passes )
{
    return ( wisp_strand_stretch_args ){ .group_row = s->group_row,
                                         .position = s->position[0][0],
                                         .inverse_mass = s->weight[0],
                                         .length = s->length[0],
                                         .tension = s->tension[0],
                                         .accumulates_tension = true,
                                         .iterations = passes,
                                         .tolerance = 1e-3f,
                                         .previous = s->previous[0][0],
                                         .low = s->low[0][0],
                                         .speed = s->speed[0],
                                         .segment = s->segment[0][0],
                                         .velocity = s->velocity[0][0],
                                         .dt = dt,
                                         .scratch = s->scratch,
                                         .history = history_of( s ) };
}

static inline wisp_strand_link_args strand_links( strands_state* s, int stride, bool pbd )
{
    return ( wisp_strand_link_args ){ .group_row = s->group_row,
                                      .position = s->position[0][0],
                                      .previous = s->previous[0][0],
                                      .low = s->low[0][0],
                                      .velocity = s->velocity[0][0],
                                      .inverse_mass = s->weight[0],
                                      .rest = stride == 1 ? s->length[0] : s->rest2[0],
                                      .lambda = pbd ? NULL : s->lambda[0],
                                      .stride = stride,
                                      .stiffness = 0.7f,
                                      .compliance = 1e-3f,
                                      .inverse_dt2 = pbd ? 0.0f : 1e4f,
                                      .dt = 1.0f / 600.0f,
                                      .segment = s->segment[0][0],
                                      .history = history_of( s ) };
}

static inline wisp_strand_rod_args rod_args( strands_state* s, float dt, bool curved, float damping )
{
    return ( wisp_strand_rod_args ){ .group_row = s->group_row,
                                     .position = s->position[0][0],
                                     .previous = s->previous[0][0],
                                     .low = s->low[0][0],
                                     .segment = s->segment[0][0],
                                     .velocity = s->velocity[0][0],
                                     .inverse_mass = s->weight[0],
                                     .inverse_length = s->inverse_length[0],
                                     .stiffness = s->stiffness[0],
                                     .factor = s->factor[0][0],
                                     .tension = s->tension[0],
                                     .max_tension = s->max_tension[0],
                                     .acceleration = { 0.5f, -9.81f, 0.25f },
                                     .acceleration_scale = s->fraction[0],
                                     .root = s->turn[0][0],
                                     .clamp = s->clamp[0][0],
                                     .frame = curved ? s->frame[0][0] : NULL,
                                     .rest = s->rest[0][0],
                                     .rest_twist = s->rest_twist[0][0],
                                     .twist_stiffness = s->twist_stiffness[0],
                                     .damping = damping,
                                     .dt = dt,
                                     .scratch = s->scratch,
                                     .first_order_factor = s->first_order_factor[0][0],
                                     .history = history_of( s ) };
}
