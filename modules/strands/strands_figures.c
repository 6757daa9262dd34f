// The guard, and figures: sums in double over fixed blocks of groups, so that no worker count changes them.
#include "strands_internal.h"

#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum
{
    GUARD_GRAIN = 16,    // groups a block
    QUALITY_BLOCKS = 64, // of groups, each a sum
};

// ---- the guard ----

typedef struct guard_loop
{
    const wisp_kernels* kernels;
    const int32_t* group_row;
    int32_t* seen;
    float *position, *velocity;
    float *good_position, *good_velocity;
    _Atomic int first_bad; // lowest row that left the bounds, INT_MAX if none did
} guard_loop;

static void look( void* context, int begin, int end, int worker )
{
    (void)worker;
    guard_loop* loop = context;
    const wisp_strand_bound_job job = { loop->position, loop->velocity, STRANDS_BOUND };
    int bad = INT_MAX;
    for ( int g = begin; g < end; ++g )
    {
        const int last = loop->group_row[g + 1];
        const int row =
            loop->seen[g] != 0 ? last : loop->kernels->strand_first_beyond( &job, loop->group_row[g], last );
        bad = row < last && row < bad ? row : bad;
        loop->seen[g] = 0; // until somebody has seen the next step
    }
    int lowest = atomic_load_explicit( &loop->first_bad, memory_order_relaxed );
    while ( bad < lowest && atomic_compare_exchange_weak( &loop->first_bad, &lowest, bad ) == false )
    {
    }
}

static void keep( void* context, int begin, int end, int worker )
{
    (void)worker;
    guard_loop* loop = context;
    const size_t first = strands_vector( loop->group_row[begin], 0 );
    const size_t bytes = ( strands_vector( loop->group_row[end], 0 ) - first ) * sizeof( float );
    memcpy( loop->good_position + first, loop->position + first, bytes );
    memcpy( loop->good_velocity + first, loop->velocity + first, bytes );
}

static bool is_place( wisp_vec3 p )
{
    return fabsf( p.x ) <= STRANDS_BOUND && fabsf( p.y ) <= STRANDS_BOUND && fabsf( p.z ) <= STRANDS_BOUND;
}

static void put_back( wisp_frame* frame, wisp_entity entity, guard_loop* loop, int row )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    int group = 0, lane = 0;
    while ( t->group_row[group + 1] <= row )
    {
        group += 1;
    }
    while ( lane + 1 < WISP_LANES && is_place( strands_get( loop->position, row, lane ) ) &&
            is_place( strands_get( loop->velocity, row, lane ) ) )
    {
        lane += 1;
    }
    const wisp_vec3 p = strands_get( loop->position, row, lane );
    char sentence[300];
    snprintf(
        sentence, sizeof( sentence ),
        "entity %u: strand %d, vertex %d left its bounds in step %llu at (%g, %g, %g); the entity is put back to "
        "the step before and halted",
        entity.index, t->lane_strand[group * WISP_LANES + lane], row - t->group_row[group],
        (unsigned long long)wisp_frame_step( frame ), (double)p.x, (double)p.y, (double)p.z );
    const size_t bytes = strands_vector( t->row_count, 0 ) * sizeof( float );
    memcpy( loop->position, loop->good_position, bytes );
    memcpy( loop->velocity, loop->good_velocity, bytes );
    wisp_frame_halt( frame, entity, sentence );
}

void strands_guard( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    int32_t* fault = wisp_frame_column( frame, span->entity, state->fault, 0 );
    guard_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .group_row = t->group_row,
        .seen = wisp_frame_column( frame, span->entity, state->seen, 0 ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 ),
        .good_position = wisp_frame_column( frame, span->entity, state->good, 0 ),
        .good_velocity = wisp_frame_column( frame, span->entity, state->good, 1 ),
    };
    atomic_init( &loop.first_bad, t->row_count );
    wisp_parallel_for( parallel, t->group_count, GUARD_GRAIN, look, &loop );
    const int bad = atomic_load( &loop.first_bad );
    *fault = bad < t->row_count ? 1 : 0;
    if ( *fault != 0 )
    {
        put_back( frame, span->entity, &loop, bad );
    }
    else
    {
        wisp_parallel_for( parallel, t->group_count, GUARD_GRAIN, keep, &loop );
    }
}

bool strands_is_faulty( wisp_frame* frame, wisp_entity entity, void* user )
{
    const strands_state* state = user;
    const int32_t* fault = wisp_frame_column( frame, entity, state->fault, 0 );
    return *fault != 0;
}

// What was NaN with the positions begins anew, so that strands that are let go again can move.
void strands_mend_tension( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const int32_t* group_row = wisp_frame_strands( frame, span->entity )->group_row;
    float* tension = wisp_frame_column( frame, span->entity, state->tension, 0 );
    const size_t begin = strands_scalar( group_row[span->begin], 0 );
    memset( tension + begin, 0, ( strands_scalar( group_row[span->end], 0 ) - begin ) * sizeof( float ) );
}

void strands_mend_frames( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    const float* clamp = wisp_frame_column( frame, span->entity, state->clamp, 0 );
    const float* root = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 1 );
    float* frames = wisp_frame_column( frame, span->entity, state->curve, 0 );
    for ( int g = span->begin; g < span->end; ++g )
    {
        strands_lay_group( t, position, clamp, root, frames, g );
    }
}

// ---- figures ----

typedef struct strand_sums
{
    double mass, moment[3], momentum[3], angular[3]; // about the first vertex
    double kinetic, strain, strain_max, speed2;
    int segments;
} strand_sums;

typedef struct quality_loop
{
    const wisp_strand_topology* topology;
    const float *position, *velocity, *weight, *length;
    double origin[3]; // m, keeps digits far away from the world's
    int groups;       // a block
    strand_sums sums[QUALITY_BLOCKS];
} quality_loop;

static float strain_of( const float* position, const float* length, int row, int lane )
{
    const float rest = length[strands_scalar( row, lane )];
    const float now =
        strands_norm( strands_sub( strands_get( position, row + 1, lane ), strands_get( position, row, lane ) ) );
    return rest > 0.0f ? fabsf( now / rest - 1.0f ) : 0.0f;
}

static void add_vertex( const quality_loop* loop, strand_sums* sums, int row, int lane )
{
    const wisp_vec3 at = strands_get( loop->position, row, lane ), moves = strands_get( loop->velocity, row, lane );
    const double p[3] = { (double)at.x - loop->origin[0], (double)at.y - loop->origin[1],
                          (double)at.z - loop->origin[2] };
    const double v[3] = { (double)moves.x, (double)moves.y, (double)moves.z };
    const double weight = (double)loop->weight[strands_scalar( row, lane )];
    const double mass = weight > 0.0 ? 1.0 / weight : 0.0;
    const double speed2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    sums->mass += mass;
    sums->kinetic += 0.5 * mass * speed2;
    sums->speed2 = speed2 > sums->speed2 ? speed2 : sums->speed2;
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        sums->moment[k] += mass * p[k];
        sums->momentum[k] += mass * v[k];
        sums->angular[k] += mass * ( p[a] * v[b] - p[b] * v[a] );
    }
}

static void add_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    quality_loop* loop = context;
    const wisp_strand_topology* t = loop->topology;
    for ( int block = begin; block < end; ++block )
    {
        strand_sums* sums = loop->sums + block;
        const int last =
            ( block + 1 ) * loop->groups < t->group_count ? ( block + 1 ) * loop->groups : t->group_count;
        for ( int i = block * loop->groups * WISP_LANES; i < last * WISP_LANES; ++i )
        {
            for ( int v = 0; v < t->lane_count[i]; ++v )
            {
                const int row = t->group_row[i / WISP_LANES] + v, lane = i % WISP_LANES;
                add_vertex( loop, sums, row, lane );
                if ( v + 1 < t->lane_count[i] )
                {
                    const double strain = (double)strain_of( loop->position, loop->length, row, lane );
                    sums->strain += strain;
                    sums->strain_max = strain > sums->strain_max ? strain : sums->strain_max;
                    sums->segments += 1;
                }
            }
        }
    }
}

static strand_sums gather( const quality_loop* loop, int blocks )
{
    strand_sums all = { 0 };
    for ( int block = 0; block < blocks; ++block )
    {
        const strand_sums* s = loop->sums + block;
        all.mass += s->mass;
        all.kinetic += s->kinetic;
        all.strain += s->strain;
        all.segments += s->segments;
        all.strain_max = s->strain_max > all.strain_max ? s->strain_max : all.strain_max;
        all.speed2 = s->speed2 > all.speed2 ? s->speed2 : all.speed2;
        for ( int k = 0; k < 3; ++k )
        {
            all.moment[k] += s->moment[k];
            all.momentum[k] += s->momentum[k];
            all.angular[k] += s->angular[k];
        }
    }
    return all;
}

static wisp_quality quality_of( const strand_sums* s, const double origin[3], wisp_vec3 gravity )
{
    wisp_quality q = {
        .mass = s->mass,
        .kinetic_energy = s->kinetic,
        .strain_max = s->strain_max,
        .strain_mean = s->strain / ( s->segments > 0 ? s->segments : 1 ),
        .speed_max = sqrt( s->speed2 ),
    };
    const double pull[3] = { (double)gravity.x, (double)gravity.y, (double)gravity.z };
    double arm[3];
    for ( int k = 0; k < 3; ++k )
    {
        arm[k] = s->mass > 0.0 ? s->moment[k] / s->mass : 0.0;
        q.centre[k] = s->mass > 0.0 ? origin[k] + arm[k] : 0.0;
        q.momentum[k] = s->momentum[k];
        q.potential_energy -= s->mass * pull[k] * q.centre[k];
    }
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        q.angular_momentum[k] = s->angular[k] - ( arm[a] * s->momentum[b] - arm[b] * s->momentum[a] );
    }
    return q;
}

void strands_take_quality( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_quality* out = wisp_frame_column( frame, span->entity, WISP_QUALITY, 0 );
    quality_loop loop = {
        .topology = t,
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 ),
        .weight = wisp_frame_column( frame, span->entity, WISP_STRAND_WEIGHT, 0 ),
        .length = wisp_frame_column( frame, span->entity, WISP_STRAND_LENGTH, 0 ),
        .groups = ( t->group_count + QUALITY_BLOCKS - 1 ) / QUALITY_BLOCKS,
    };
    if ( t->group_count > 0 )
    {
        const wisp_vec3 first = strands_get( loop.position, 0, 0 );
        loop.origin[0] = (double)first.x;
        loop.origin[1] = (double)first.y;
        loop.origin[2] = (double)first.z;
    }
    const int blocks = loop.groups > 0 ? ( t->group_count + loop.groups - 1 ) / loop.groups : 0;
    wisp_parallel_for( wisp_frame_parallel( frame, span ), blocks, 1, add_block, &loop );
    const strand_sums sums = gather( &loop, blocks );
    *out = quality_of( &sums, loop.origin, settings->gravity );
}

void strands_hand_out_strain( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    const float* length = wisp_frame_column( frame, span->entity, WISP_STRAND_LENGTH, 0 );
    float* strain = wisp_frame_column( frame, span->entity, WISP_POINT_STRAIN, 0 );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        float before = 0.0f;
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            const int row = t->group_row[i / WISP_LANES] + v;
            const float behind = v + 1 < t->lane_count[i] ? strain_of( position, length, row, i % WISP_LANES ) : 0.0f;
            strain[t->offsets[t->lane_strand[i]] + v] = fmaxf( before, behind );
            before = behind;
        }
    }
}

void strands_hand_out_speed( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    float* speed = wisp_frame_column( frame, span->entity, WISP_POINT_SPEED, 0 );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            speed[t->offsets[t->lane_strand[i]] + v] =
                strands_norm( strands_get( velocity, t->group_row[i / WISP_LANES] + v, i % WISP_LANES ) );
        }
    }
}
