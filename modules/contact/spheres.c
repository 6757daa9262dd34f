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
    SWEEPS = 8,

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

static sphere_loop begin_loop( const contact_work* work )
{
    return ( sphere_loop ){ .work = work, .mesh = work->contact_mesh, .spheres = work->contact_mesh->spheres };
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

// Give the spheres with near pairs their slots. @return the rows of their packs
static int choose_active( contact_spheres* s, int point_count )
{
    contact_near_spheres* near = &s->active;
    int counts[CONTACT_SPHERE_PACK], most = 0;
    near->count = s->active_point_count = near->begin[0] = 0;
    memset( s->is_active, 0, (size_t)point_count );
    for ( int pack = 0; pack < s->pack_count; ++pack )
    {
        memset( counts, 0, sizeof( counts ) );
        for ( int row = s->begin[pack]; row < s->begin[pack + 1]; ++row )
        {
            for ( uint32_t bits = s->is_near[row], lane = 0; bits != 0; bits >>= 1, ++lane )
            {
                counts[lane] += (int)( bits & 1 );
            }
        }
        for ( int i = pack * CONTACT_SPHERE_PACK; i < ( pack + 1 ) * CONTACT_SPHERE_PACK; ++i )
        {
            const int count = counts[i % CONTACT_SPHERE_PACK];
            s->slot[i] = count > 0 ? near->count : -1;
            for ( int k = 0; k < 3 && count > 0; ++k )
            {
                const int point = s->parents[i][k];
                s->active_points[s->active_point_count] = point;
                s->active_point_count += s->is_active[point] == 0 ? 1 : 0;
                s->is_active[point] = 1;
            }
            if ( count > 0 )
            {
                most = near->count % CONTACT_SPHERE_PACK == 0 || count > most ? count : most;
                near->own_x4[near->count++] = 4 * i;
                near->begin[( near->count - 1 ) / CONTACT_SPHERE_PACK + 1] =
                    near->begin[( near->count - 1 ) / CONTACT_SPHERE_PACK] + most;
            }
        }
    }
    near->pack_count = ( near->count + CONTACT_SPHERE_PACK - 1 ) / CONTACT_SPHERE_PACK;
    for ( int slot = near->count; slot < near->pack_count * CONTACT_SPHERE_PACK; ++slot )
    {
        near->own_x4[slot] = near->own_x4[near->count - 1];
    }
    return near->begin[near->pack_count];
}

// Copy near pairs to the slots of their spheres.
static void fill_active( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    const contact_near_spheres* near = &s->active;
    for ( int i = begin * CONTACT_SPHERE_PACK; i < end * CONTACT_SPHERE_PACK; ++i )
    {
        const int slot = s->slot[i], pack = i / CONTACT_SPHERE_PACK, lane = i % CONTACT_SPHERE_PACK;
        int to = slot >= 0 ? near->begin[slot / CONTACT_SPHERE_PACK] : 0;
        for ( int row = s->begin[pack]; row < s->begin[pack + 1] && slot >= 0; ++row )
        {
            if ( ( s->is_near[row] >> lane & 1 ) != 0 )
            {
                const size_t from = (size_t)row * CONTACT_SPHERE_PACK + (size_t)lane,
                             at = (size_t)to * CONTACT_SPHERE_PACK + (size_t)( slot % CONTACT_SPHERE_PACK );
                near->other_x4[at] = s->other_x4[from];
                near->gap[at] = s->gap[from];
                to += 1;
            }
        }
    }
}

wisp_status contact_begin_spheres( const contact_work* work, wisp_error* error )
{
    sphere_loop loop = begin_loop( work );
    contact_spheres* s = loop.spheres;
    s->done += 1;
    loop.progress = (float)s->done / (float)s->substeps - 0.5f;
    loop.args = ( wisp_point_pair_args ){ .start = s->start,
                                          .now = s->now,
                                          .own_x4 = s->own_x4,
                                          .begin = s->begin,
                                          .other_x4 = s->other_x4,
                                          .gap = s->gap,
                                          .reach = NEAR_GAPS,
                                          .found = s->is_near };
    atomic_init( &loop.count, 0 );
    wisp_parallel_for( work->parallel, s->pack_count * CONTACT_SPHERE_PACK, CONTACT_POINT_GRAIN, place_starts,
                       &loop );
    wisp_parallel_for( work->parallel, s->pack_count, CONTACT_SPHERE_GRAIN, find_near_packs, &loop );
    s->strayed = atomic_load( &loop.count );
    const size_t rows = (size_t)choose_active( s, loop.mesh->point_count ), lanes = rows * CONTACT_SPHERE_PACK;
    wisp_buffer* b = s->buffers + CONTACT_SPHERE_ARRAY_COUNT - 6;
    if ( contact_reserve( work, b, lanes * sizeof( int32_t ), (void**)&s->active.other_x4 ) == false ||
         contact_reserve( work, b + 1, lanes * sizeof( float ), (void**)&s->active.gap ) == false ||
         contact_reserve( work, b + 2, rows * sizeof( uint16_t ), (void**)&s->active.presses ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the near pairs of %d spheres", s->count );
    }
    memset( s->active.other_x4, 0, lanes * sizeof( int32_t ) );
    memset( s->active.gap, 0, lanes * sizeof( float ) );
    wisp_parallel_for( work->parallel, s->pack_count, CONTACT_SPHERE_GRAIN, fill_active, &loop );
    return WISP_OK;
}

// ---- projection ----

static void place_now( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        const int at = loop->spheres->active.own_x4[slot];
        contact_place_sphere( loop->spheres, loop->mesh->now, at / 4, loop->spheres->now + at );
    }
}

static void find_pressing( void* context, int begin, int end, int worker )
{
    (void)worker;
    sphere_loop* loop = context;
    wisp_frame_kernels( loop->work->frame )->find_pressing_points( &loop->args, begin, end );
    bool any = false;
    for ( int row = loop->args.begin[begin]; row < loop->args.begin[end]; ++row )
    {
        any = any || loop->args.found[row] != 0;
    }
    if ( any )
    {
        atomic_store( &loop->count, 1 );
    }
}

// What touches a body stays there: it is not pushed into the body, and holds what lies on it.
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
            const int slot = s->slot[s->shares[i].sphere];
            pairs += slot >= 0 ? s->active.count_of[slot] : 0.0f;
        }
        const contact_participant* participant = contact_participant_of( loop->work, point );
        const bool is_held =
            participant->half_spaces != NULL && participant->half_spaces[point - participant->first_point] > 0;
        s->inverse_mass[point] = is_held ? 0.0f : pairs * loop->mesh->now[(size_t)point * 4 + 3];
    }
}

static void weigh_spheres( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_spheres* s = loop->spheres;
    for ( int slot = begin; slot < end; ++slot )
    {
        const int i = s->active.own_x4[slot] / 4;
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
    for ( int a = begin; a < end; ++a )
    {
        const int point = s->active_points[a];
        float *now = loop->mesh->now + (size_t)point * 4, *shift = loop->mesh->shift + (size_t)point * 4;
        for ( int i = s->share_begin[point]; i < s->share_begin[point + 1] && s->inverse_mass[point] > 0.0f; ++i )
        {
            const int slot = s->slot[s->shares[i].sphere];
            const float fraction = now[3] * s->shares[i].weight;
            for ( size_t k = 0, at = (size_t)( slot >= 0 ? slot : 0 ) * 4; k < 3 && slot >= 0; ++k )
            {
                now[k] += fraction * ( s->active.push[at + k] + s->active.shift[at + k] );
                shift[k] += fraction * s->active.shift[at + k];
            }
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
    for ( int slot = 0; slot < s->active.count; ++slot )
    {
        const float* push = s->active.push + (size_t)slot * 4;
        double* impulse = work->participants[(int)s->rest[s->active.own_x4[slot] / 4][3]].impulse;
        for ( int k = 0; k < 3; ++k )
        {
            impulse[k] += (double)push[k] / (double)work->seconds;
        }
        sum += (double)push[3];
        pairs += (double)s->active.count_of[slot];
    }
    f->contacts = (int)( 0.5 * pairs );
    f->impulse += 0.5 * sum / (double)work->seconds;
}

float contact_least_sphere_gap( const contact_work* work )
{
    const contact_contact_mesh* m = work->contact_mesh;
    const contact_spheres* s = m->spheres;
    float least = INFINITY;
    for ( int i = 0; i < s->count; ++i )
    {
        contact_place_sphere( s, m->now, i, s->now + (size_t)i * 4 );
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
static bool sweep( const contact_work* work, float recovery )
{
    sphere_loop loop = begin_loop( work );
    const contact_spheres* s = loop.spheres;
    const contact_near_spheres* near = &s->active;
    loop.args = ( wisp_point_pair_args ){ .start = s->start,
                                          .now = s->now,
                                          .own_x4 = near->own_x4,
                                          .begin = near->begin,
                                          .other_x4 = near->other_x4,
                                          .gap = near->gap,
                                          .recovery = recovery,
                                          .found = near->presses,
                                          .count = near->count_of,
                                          .push = near->push,
                                          .shift = near->shift };
    atomic_init( &loop.count, 0 );
    wisp_parallel_for( work->parallel, near->count, CONTACT_POINT_GRAIN, place_now, &loop );
    wisp_parallel_for( work->parallel, near->pack_count, CONTACT_SPHERE_GRAIN, find_pressing, &loop );
    if ( atomic_load( &loop.count ) == 0 )
    {
        return false;
    }
    wisp_parallel_for( work->parallel, s->active_point_count, CONTACT_POINT_GRAIN, split_masses, &loop );
    wisp_parallel_for( work->parallel, near->count, CONTACT_POINT_GRAIN, weigh_spheres, &loop );
    wisp_parallel_for( work->parallel, near->pack_count, CONTACT_SPHERE_GRAIN, push_packs, &loop );
    wisp_parallel_for( work->parallel, s->active_point_count, CONTACT_POINT_GRAIN, move_shares, &loop );
    if ( work->counts_impulses )
    {
        add_impulses( work );
    }
    return true;
}

void contact_push_spheres( const contact_work* work, bool is_last )
{
    work->memory->stats.contacts = 0;
    for ( int i = is_last ? 1 : 0; i < SWEEPS && sweep( work, 0.0f ); ++i )
    {
    }
    if ( is_last )
    {
        (void)sweep( work, recovery_of( work ) );
    }
}
