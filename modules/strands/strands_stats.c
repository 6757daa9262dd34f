// Statistics: masses, momenta, energies, strains and speeds at the end of a step. Sums are in double precision over
// fixed blocks of groups, so that they do not depend on the workers.
#include "strand_passes.h"

#include "strand_rows.h"

enum
{
    MOTION_STATS_BLOCKS = 64, // of groups, each with its own sum
};

typedef struct strand_sums
{
    double mass, moment[3], momentum[3], angular[3]; // about the first vertex
    double kinetic, strain, strain_max, speed2;
    int segments;
} strand_sums;

typedef struct motion_stats_loop
{
    const wisp_strand_topology* topology;
    const float *position, *velocity, *weight, *length;
    int ends;         // 1: the last vertex is the first
    double origin[3]; // m, against cancellation far from the origin
    int groups;       // per block
    strand_sums sums[MOTION_STATS_BLOCKS];
} motion_stats_loop;

static float strain_of( const float* position, const float* length, int row, int lane )
{
    const float rest = length[strands_scalar( row, lane )];
    const float now =
        wisp_v3_length( wisp_v3_sub( strands_get( position, row + 1, lane ), strands_get( position, row, lane ) ) );
    return rest > 0.0f ? fabsf( now / rest - 1.0f ) : 0.0f;
}

static void add_vertex( const motion_stats_loop* loop, strand_sums* sums, int row, int lane )
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
    motion_stats_loop* loop = context;
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
                if ( v + loop->ends < t->lane_count[i] )
                {
                    add_vertex( loop, sums, row, lane );
                }
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

static strand_sums gather( const motion_stats_loop* loop, int blocks )
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

static wisp_motion_stats motion_stats_of( const strand_sums* s, const double origin[3], wisp_vec3 gravity )
{
    wisp_motion_stats q = {
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

void strands_compute_motion_stats( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_motion_stats* out = wisp_frame_column( frame, span->entity, WISP_MOTION_STATS, 0 );
    motion_stats_loop loop = {
        .topology = t,
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 ),
        .weight = wisp_frame_column( frame, span->entity, WISP_STRAND_INVERSE_MASS, 0 ),
        .length = wisp_frame_column( frame, span->entity, WISP_STRAND_LENGTH, 0 ),
        .ends = wisp_frame_has( frame, span->entity, state->closed ) ? 1 : 0,
        .groups = ( t->group_count + MOTION_STATS_BLOCKS - 1 ) / MOTION_STATS_BLOCKS,
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
    const wisp_vec3 o = wisp_frame_offset( frame, span->entity );
    const double origin[3] = { loop.origin[0] - (double)o.x, loop.origin[1] - (double)o.y,
                               loop.origin[2] - (double)o.z };
    *out = motion_stats_of( &sums, origin, settings->gravity );
}

void strands_scatter_strain( wisp_frame* frame, const wisp_span* span, void* user )
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

void strands_scatter_speed( wisp_frame* frame, const wisp_span* span, void* user )
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
                wisp_v3_length( strands_get( velocity, t->group_row[i / WISP_LANES] + v, i % WISP_LANES ) );
        }
    }
}
