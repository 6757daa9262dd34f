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

enum
{
    SPHERE_GRAIN = 1024,
    PACK_GRAIN = 32,
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

// Return the recovery of all pairs in a substep: of the slowest participant, m.
static float recovery_of( const contact_work* work )
{
    float speed = INFINITY;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        speed = contact_smaller( speed, work->participants[g].settings.max_push_out_speed );
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
                  .rows = s->rows,
                  .other_x4 = s->other_x4,
                  .gap = s->gap,
                  .capacity = s->capacity,
                  .recovery = is_last ? recovery_of( work ) : 0.0f,
                  .presses = s->presses,
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
        float now[3], squared = 0.0f;
        contact_place_sphere( s, loop->mesh->intersection_free, i, s->start + (size_t)i * 4 );
        s->start[(size_t)i * 4 + 3] = s->traits[i][2];
        contact_place_sphere( s, loop->mesh->now, i, now );
        for ( int k = 0; k < 3; ++k )
        {
            const float strays = now[k] - ( s->middle[k][i] + loop->progress * s->motion[i][k] );
            squared += strays * strays;
        }
        outran += i < s->count && squared > s->motion[i][3] * s->motion[i][3] ? 1 : 0;
    }
    if ( outran > 0 )
    {
        atomic_fetch_add( &loop->count, outran );
    }
}

void contact_begin_spheres( const contact_work* work )
{
    sphere_loop loop = begin_loop( work, false );
    contact_spheres* s = loop.spheres;
    s->done += 1;
    loop.progress = (float)s->done / (float)s->substeps - 0.5f;
    atomic_init( &loop.count, 0 );
    wisp_parallel_for( work->parallel, s->pack_count * CONTACT_SPHERE_PACK, SPHERE_GRAIN, place_starts, &loop );
    work->memory->stats.outran += atomic_load( &loop.count );
}

// ---- projection ----

static void place_now( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        contact_place_sphere( loop->spheres, loop->mesh->now, i, loop->spheres->now + (size_t)i * 4 );
    }
}

static void find_pressing( void* context, int begin, int end, int worker )
{
    (void)worker;
    sphere_loop* loop = context;
    wisp_frame_kernels( loop->work->frame )->find_pressing_points( &loop->args, begin, end );
    for ( int i = begin * CONTACT_SPHERE_PACK; i < end * CONTACT_SPHERE_PACK; ++i )
    {
        if ( loop->spheres->count_of[i] > 0.0f )
        {
            atomic_store_explicit( &loop->count, 1, memory_order_relaxed );
            return;
        }
    }
}

static void split_masses( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    for ( int point = begin; point < end; ++point )
    {
        float pairs = 0.0f;
        for ( int i = s->share_begin[point]; i < s->share_begin[point + 1]; ++i )
        {
            pairs += s->count_of[s->shares[i].sphere];
        }
        s->inverse_mass[point] = pairs * loop->mesh->now[(size_t)point * 4 + 3];
    }
}

static void weigh_spheres( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    for ( int i = begin; i < end; ++i )
    {
        float sum = 0.0f;
        for ( int k = 0; k < 3; ++k )
        {
            sum += s->weights[i][k] * s->weights[i][k] * s->inverse_mass[s->parents[i][k]];
        }
        s->now[(size_t)i * 4 + 3] = sum;
    }
}

static void push_packs( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    wisp_frame_kernels( loop->work->frame )->push_points( &loop->args, begin, end );
}

static void move_shares( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    for ( int point = begin; point < end; ++point )
    {
        float *now = loop->mesh->now + (size_t)point * 4, *shift = loop->mesh->shift + (size_t)point * 4;
        float push[3] = { 0.0f, 0.0f, 0.0f }, recovered[3] = { 0.0f, 0.0f, 0.0f };
        if ( s->inverse_mass[point] == 0.0f )
        {
            continue;
        }
        for ( int i = s->share_begin[point]; i < s->share_begin[point + 1]; ++i )
        {
            const float fraction = now[3] * s->shares[i].weight;
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
    place_now( &loop, 0, s->count, 0 );
    for ( int i = 0; i < s->count; ++i )
    {
        const int pack = i / CONTACT_SPHERE_PACK;
        for ( int row = pack * s->capacity; row < pack * s->capacity + s->rows[pack]; ++row )
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

void contact_push_spheres( const contact_work* work, bool is_last )
{
    sphere_loop loop = begin_loop( work, is_last );
    const contact_spheres* s = loop.spheres;
    const int spheres = s->pack_count * CONTACT_SPHERE_PACK, points = loop.mesh->point_count;
    atomic_init( &loop.count, 0 );
    wisp_parallel_for( work->parallel, spheres, SPHERE_GRAIN, place_now, &loop );
    wisp_parallel_for( work->parallel, s->pack_count, PACK_GRAIN, find_pressing, &loop );
    work->memory->stats.contacts = 0;
    if ( atomic_load( &loop.count ) == 0 )
    {
        return;
    }
    wisp_parallel_for( work->parallel, points, SPHERE_GRAIN, split_masses, &loop );
    wisp_parallel_for( work->parallel, spheres, SPHERE_GRAIN, weigh_spheres, &loop );
    wisp_parallel_for( work->parallel, s->pack_count, PACK_GRAIN, push_packs, &loop );
    wisp_parallel_for( work->parallel, points, SPHERE_GRAIN, move_shares, &loop );
    if ( work->counts_impulses )
    {
        add_impulses( work );
    }
}
