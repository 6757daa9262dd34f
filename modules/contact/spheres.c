// Projection of spheres (position based dynamics). In: lists of pairs (sphere_grid.c). Out: moved points, shifts of recovery.
//
// A pair keeps its distance along the line between its spheres at the start of the substep, so a sphere that went through another is
// sent back. The distance is no more than it was at the start; recovery adds to it, and gives no velocity.
//
// All pairs are projected at once (Jacobi). Each point splits its mass among the pairs that press on it (mass splitting, Tonge et al. 2012):
// with n_k of them at point k, weights b_k and inverse masses w_k, a pair has l = C / sum n_k w_k b_k^2 over its points, and
// Dx_k = w_k b_k l n. Both spheres get the same push with opposite signs, so momentum is kept, and none is pushed too far.
#include "spheres.h"

#include "wisp/module/kernels.h"

#include <stdatomic.h>
#include <string.h>

// Pairs are projected that come within so many distances in a substep.
static const float NEAR_GAPS = 1.25f;

enum
{
    SWEEPS = 4,

};

typedef struct sphere_loop
{
    const contact_work* work;
    contact_contact_mesh* mesh;
    contact_spheres* spheres;
    wisp_point_pair_args args;
    float progress; // of the step, at the end of the substep, less a half
    _Atomic int count;
} sphere_loop;

// Return the recovery of all pairs in a substep, that of the slowest participant, in distances.
static float recovery_of( const contact_work* work )
{
    float speed = INFINITY;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_settings* settings = &work->participants[g].settings;
        speed = contact_smaller( speed, settings->max_push_out_speed / settings->thickness );
    }
    return speed * work->seconds;
}

static sphere_loop begin_loop( const contact_work* work, bool is_last )
{
    contact_spheres* s = work->contact_mesh->spheres;
    return ( sphere_loop ){
        .work = work,
        .mesh = work->contact_mesh,
        .spheres = s,
        .args = { .start = s->start,
                  .now = s->now,
                  .begin = s->begin,
                  .other_x4 = s->other_x4,
                  .gap = s->gap,
                  .recovery = is_last ? recovery_of( work ) : 0.0f,
                  .presses = s->presses,
                  .reach = NEAR_GAPS,
                  .near = s->near,
                  .near_count = s->near_count,
                  .count = s->count_of,
                  .push = s->push,
                  .shift = s->shift },
    };
}

// ---- the start of a substep ----

static void place_starts( void* context, int begin, int end, int worker )
{
    (void)worker;
    sphere_loop* loop = context;
    contact_spheres* s = loop->spheres;
    int outran = 0;
    for ( int i = begin; i < end; ++i )
    {
        float *now = s->now + (size_t)i * 4, squared = 0.0f;
        contact_place_sphere( s, loop->mesh->intersection_free, i, s->start + (size_t)i * 4 );
        s->start[(size_t)i * 4 + 3] = s->traits[i][2];
        contact_place_sphere( s, loop->mesh->now, i, now );
        for ( int k = 0; k < 3; ++k )
        {
            const float strays = now[k] - ( s->middle[i][k] + loop->progress * s->motion[i][k] );
            squared += strays * strays;
        }
        outran += i < s->count && squared > s->motion[i][3] * s->motion[i][3] ? 1 : 0;
    }
    if ( outran > 0 )
    {
        atomic_fetch_add( &loop->count, outran );
    }
}

static void find_near_packs( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    wisp_frame_kernels( loop->work->frame )->find_near_pairs( &loop->args, begin, end );
}

// Collect the packs with a near pair, and their points. Both spheres of a pair are in one.
static void collect_active( contact_spheres* s, int point_count )
{
    s->active_pack_count = s->active_point_count = 0;
    memset( s->is_active, 0, (size_t)point_count );
    for ( int pack = 0; pack < s->pack_count; ++pack )
    {
        s->active_packs[s->active_pack_count] = pack;
        s->active_pack_count += s->near_count[pack] > 0 ? 1 : 0;
        for ( int i = pack * CONTACT_SPHERE_PACK; s->near_count[pack] > 0 && i < ( pack + 1 ) * CONTACT_SPHERE_PACK;
              ++i )
        {
            for ( int k = 0; k < 3; ++k )
            {
                const int point = s->parents[i][k];
                s->active_points[s->active_point_count] = point;
                s->active_point_count += s->is_active[point] == 0 ? 1 : 0;
                s->is_active[point] = 1;
            }
        }
    }
}

void contact_begin_spheres( const contact_work* work )
{
    sphere_loop loop = begin_loop( work, false );
    contact_spheres* s = loop.spheres;
    s->done += 1;
    loop.progress = (float)s->done / (float)s->substeps - 0.5f;
    atomic_init( &loop.count, 0 );
    wisp_parallel_for( work->parallel, s->pack_count * CONTACT_SPHERE_PACK, CONTACT_POINT_GRAIN, place_starts,
                       &loop );
    wisp_parallel_for( work->parallel, s->pack_count, CONTACT_SPHERE_GRAIN, find_near_packs, &loop );
    collect_active( s, loop.mesh->point_count );
    work->memory->stats.outran += atomic_load( &loop.count );
}

// ---- projection ----

static void place_now( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    for ( int a = begin; a < end; ++a )
    {
        const int first = loop->spheres->active_packs[a] * CONTACT_SPHERE_PACK;
        for ( int i = first; i < first + CONTACT_SPHERE_PACK; ++i )
        {
            contact_place_sphere( loop->spheres, loop->mesh->now, i, loop->spheres->now + (size_t)i * 4 );
        }
    }
}

static void find_pressing( void* context, int begin, int end, int worker )
{
    (void)worker;
    sphere_loop* loop = context;
    bool any = false;
    for ( int a = begin; a < end; ++a )
    {
        const int pack = loop->spheres->active_packs[a];
        wisp_frame_kernels( loop->work->frame )->find_pressing_points( &loop->args, pack, pack + 1 );
        for ( int i = pack * CONTACT_SPHERE_PACK; i < ( pack + 1 ) * CONTACT_SPHERE_PACK; ++i )
        {
            any = any || loop->spheres->count_of[i] > 0.0f;
        }
    }
    if ( any )
    {
        atomic_store( &loop->count, 1 );
    }
}

static void split_masses( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    for ( int a = begin; a < end; ++a )
    {
        const int point = s->active_points[a];
        float pairs = 0.0f;
        for ( int i = s->share_begin[point]; i < s->share_begin[point + 1]; ++i )
        {
            const int sphere = s->shares[i].sphere;
            pairs += s->near_count[sphere / CONTACT_SPHERE_PACK] > 0 ? s->count_of[sphere] : 0.0f;
        }
        s->inverse_mass[point] = pairs * loop->mesh->now[(size_t)point * 4 + 3];
    }
}

static void weigh_spheres( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    for ( int a = begin; a < end; ++a )
    {
        const int first = s->active_packs[a] * CONTACT_SPHERE_PACK;
        for ( int i = first; i < first + CONTACT_SPHERE_PACK; ++i )
        {
            float sum = 0.0f;
            for ( int k = 0; k < 3; ++k )
            {
                sum += s->weights[i][k] * s->weights[i][k] * s->inverse_mass[s->parents[i][k]];
            }
            s->now[(size_t)i * 4 + 3] = sum;
        }
    }
}

static void push_packs( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    for ( int a = begin; a < end; ++a )
    {
        const int pack = loop->spheres->active_packs[a];
        wisp_frame_kernels( loop->work->frame )->push_points( &loop->args, pack, pack + 1 );
    }
}

static void move_shares( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    for ( int a = begin; a < end; ++a )
    {
        const int point = s->active_points[a];
        float *now = loop->mesh->now + (size_t)point * 4, *shift = loop->mesh->shift + (size_t)point * 4;
        float push[3] = { 0.0f, 0.0f, 0.0f }, recovered[3] = { 0.0f, 0.0f, 0.0f };
        if ( s->inverse_mass[point] == 0.0f )
        {
            continue;
        }
        for ( int i = s->share_begin[point]; i < s->share_begin[point + 1]; ++i )
        {
            const float fraction =
                s->near_count[s->shares[i].sphere / CONTACT_SPHERE_PACK] > 0 ? now[3] * s->shares[i].weight : 0.0f;
            for ( size_t k = 0, at = (size_t)s->shares[i].sphere * 4; k < 3; ++k )
            {
                push[k] += fraction * s->push[at + k];
                recovered[k] += fraction * s->shift[at + k];
            }
        }
        for ( int k = 0; k < 3; ++k )
        {
            now[k] += push[k] + recovered[k];
            shift[k] += recovered[k];
        }
    }
}

// ---- statistics ----

// Add the impulses of a sweep. Each pair is in the sums of both of its spheres.
static void add_impulses( const contact_work* work )
{
    const contact_spheres* s = work->contact_mesh->spheres;
    wisp_contact_stats* f = &work->memory->stats;
    double pairs = 0.0, sum = 0.0;
    for ( int i = 0; i < s->count; ++i )
    {
        if ( s->near_count[i / CONTACT_SPHERE_PACK] == 0 )
        {
            continue;
        }
        const float* push = s->push + (size_t)i * 4;
        double* impulse = work->participants[(int)s->rest[i][3]].impulse;
        for ( int k = 0; k < 3; ++k )
        {
            impulse[k] += (double)push[k] / (double)work->seconds;
        }
        sum += (double)push[3];
        pairs += (double)s->count_of[i];
    }
    f->contacts = (int)( 0.5 * pairs );
    f->impulse += 0.5 * sum / (double)work->seconds;
}

float contact_least_sphere_gap( const contact_work* work )
{
    sphere_loop loop = begin_loop( work, false );
    const contact_spheres* s = loop.spheres;
    float least = INFINITY;
    for ( int i = 0; i < s->count; ++i )
    {
        contact_place_sphere( s, loop.mesh->now, i, loop.spheres->now + (size_t)i * 4 );
    }
    for ( int i = 0; i < s->count; ++i )
    {
        const int pack = i / CONTACT_SPHERE_PACK;
        for ( int row = s->begin[pack]; row < s->begin[pack + 1]; ++row )
        {
            const size_t at = (size_t)row * CONTACT_SPHERE_PACK + (size_t)( i % CONTACT_SPHERE_PACK );
            if ( s->gap[at] > 0.0f )
            {
                const float distance = contact_distance( s->now + (size_t)i * 4, s->now + s->other_x4[at] );
                least = contact_smaller( least, distance / s->gap[at] );
            }
        }
    }
    return least;
}

// Project all pairs once. @return whether any presses
static bool sweep( const contact_work* work, bool recovers )
{
    sphere_loop loop = begin_loop( work, recovers );
    const int packs = loop.spheres->active_pack_count, points = loop.spheres->active_point_count;
    atomic_init( &loop.count, 0 );
    wisp_parallel_for( work->parallel, packs, CONTACT_SPHERE_GRAIN, place_now, &loop );
    wisp_parallel_for( work->parallel, packs, CONTACT_SPHERE_GRAIN, find_pressing, &loop );
    if ( atomic_load( &loop.count ) == 0 )
    {
        return false;
    }
    wisp_parallel_for( work->parallel, points, CONTACT_POINT_GRAIN, split_masses, &loop );
    wisp_parallel_for( work->parallel, packs, CONTACT_SPHERE_GRAIN, weigh_spheres, &loop );
    wisp_parallel_for( work->parallel, packs, CONTACT_SPHERE_GRAIN, push_packs, &loop );
    wisp_parallel_for( work->parallel, points, CONTACT_POINT_GRAIN, move_shares, &loop );
    if ( work->counts_impulses )
    {
        add_impulses( work );
    }
    return true;
}

void contact_push_spheres( const contact_work* work, bool is_last )
{
    work->memory->stats.contacts = 0;
    for ( int i = is_last ? 1 : 0; i < SWEEPS && sweep( work, false ); ++i )
    {
    }
    if ( is_last )
    {
        (void)sweep( work, true );
    }
}
