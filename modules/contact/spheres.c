// Projection of spheres (position based dynamics). In: lists of pairs (below). Out: moved points, shifts of recovery.
//
// A pair keeps its distance along the line between its spheres at the start of the substep, so a sphere that went through another is
// sent back. The distance is no more than it was at the start; recovery adds to it, and gives no velocity.
//
// All pairs are projected at once (Jacobi). Each point splits its mass among the pairs that press on it (mass splitting, Tonge et al. 2012):
// with n_k of them at point k, weights b_k and inverse masses w_k, a pair has l = C / sum n_k w_k b_k^2 over its points, and
// Dx_k = w_k b_k l n. Both spheres get the same push with opposite signs, so momentum is kept, and none is pushed too far.
#include "spheres.h"

#include "broad_phase.h"

#include "wisp/module/kernels.h"
#include "wisp/samples.h"

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

// Which spheres may press on each other in a step. In: positions and predicted motions at its first substep, layers. Out: spheres, and for
// each one the list of others in rising order, sixteen lists side by side.
//
// A pair is listed if the straight paths of both through the step come within their distance and a margin: grids find overlaps of boxes
// around these paths. Neighbours in the mesh are left out. Lists depend on positions alone: a snapshot needs none.

enum
{
    MAX_PER_SPHERE = 256, // pairs before margins are halved
    MAX_HALVED = 12,
};

// Pairs of one surface that are at rest within so many distances are neighbours: those of an edge are.
static const float NEIGHBOURS = 1.3f;
// How far a sphere may stray from its predicted motion, as a part of it.
static const float STRAY = 0.25f;

static bool reserve_spheres( const contact_work* work, int count )
{
    contact_spheres* s = work->contact_mesh->spheres;
    const size_t packs = (size_t)( count + CONTACT_SPHERE_PACK - 1 ) / CONTACT_SPHERE_PACK,
                 n = packs * CONTACT_SPHERE_PACK, points = (size_t)work->contact_mesh->point_count;
    const size_t one = sizeof( float ), three = 3 * one, four = 4 * one;
    const struct
    {
        void* at;
        size_t bytes;
    } all[] = {
        { &s->parents, n * three },
        { &s->weights, n * three },
        { &s->rest, n * four },
        { &s->traits, n * four },
        { &s->motion, n * four },
        { &s->middle, n * three },
        { &s->boxes, n * sizeof( *s->boxes ) },
        { &s->start, n * four },
        { &s->now, n * four },
        { &s->own_x4, n * one },
        { &s->begin, ( packs + 1 ) * one },
        { &s->active.own_x4, n * one },
        { &s->active.begin, ( packs + 1 ) * one },
        { &s->active.count_of, n * one },
        { &s->active.push, n * four },
        { &s->active.shift, n * four },
        { &s->slot, n * one },
        { &s->cover, points * one },
        { &s->active_points, points * one },
        { &s->is_active, points },
        { &s->inverse_mass, points * one },
        { &s->share_begin, ( points + 2 ) * one },
        { &s->shares, 3 * n * sizeof( *s->shares ) },
    };
    bool enough = true;
    for ( int i = 0; i < WISP_COUNT( all ) && enough; ++i )
    {
        enough = contact_reserve( work, s->buffers + i, all[i].bytes, all[i].at );
    }
    s->count = enough ? count : 0;
    s->pack_count = enough ? (int)packs : 0;
    return enough;
}

// ---- spheres of participants ----

static const wisp_samples* shared_layer( const contact_work* work, const contact_participant* participant )
{
    return participant->is_strands || participant->is_left_out
               ? NULL
               : wisp_frame_samples( work->frame, participant->entity );
}

static void put_sphere( contact_spheres* s, int at, int first_point, const int32_t point_x4[3],
                        const float weights[3] )
{
    for ( int k = 0; k < 3; ++k )
    {
        s->parents[at][k] = first_point + point_x4[k] / 4;
        s->weights[at][k] = weights[k];
    }
}

static wisp_status make_spheres( const contact_work* work, wisp_error* error )
{
    static const float WHOLE[3] = { 1.0f, 0.0f, 0.0f };
    contact_spheres* s = work->contact_mesh->spheres;
    int total = 0;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const wisp_samples* layer = shared_layer( work, work->participants + g );
        total += work->participants[g].point_count + ( layer != NULL ? layer->count : 0 );
    }
    if ( reserve_spheres( work, total ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d spheres in contact", total );
    }
    for ( int g = 0, at = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        const wisp_samples* layer = shared_layer( work, participant );
        for ( int i = 0; i < participant->point_count; ++i )
        {
            put_sphere( s, at++, participant->first_point, ( const int32_t[3] ){ 4 * i, 4 * i, 4 * i }, WHOLE );
        }
        for ( int i = 0; layer != NULL && i < layer->count; ++i )
        {
            put_sphere( s, at++, participant->first_point, layer->parents[i], layer->weights[i] );
        }
        const bool is_divided = layer != NULL && participant->edge_count > 0;
        participant->layer_parts =
            is_divided ? 1.0f + (float)layer->edge_count / (float)participant->edge_count : 1.0f;
    }
    for ( int i = total; i < s->pack_count * CONTACT_SPHERE_PACK; ++i ) // they have no pairs
    {
        memcpy( s->parents[i], s->parents[total - 1], sizeof( *s->parents ) );
        memcpy( s->weights[i], s->weights[total - 1], sizeof( *s->weights ) );
    }
    return WISP_OK;
}

// Find how far each point of a surface has to be kept from spheres so that they do not slip past it.
static void find_covers( const contact_work* work )
{
    const contact_contact_mesh* m = work->contact_mesh;
    float* cover = m->spheres->cover;
    memset( cover, 0, (size_t)m->point_count * sizeof( *cover ) );
    for ( int e = 0; e < m->edge_count; ++e )
    {
        const int32_t* points = m->edges + 2 * (size_t)e;
        const float *p = m->rest + (size_t)points[0] * 4, *q = m->rest + (size_t)points[1] * 4;
        const contact_participant* participant = work->participants + (int)p[3];
        const float keeps =
            participant->is_strands ? 0.0f : CONTACT_COVER * contact_distance( p, q ) / participant->layer_parts;
        for ( int i = 0; i < 2; ++i )
        {
            cover[points[i]] = contact_larger( cover[points[i]], keeps );
        }
    }
}

static void share_points( contact_spheres* s, size_t points )
{
    // a counting sort: counts go two places ahead, so that filling leaves each start in place
    memset( s->share_begin, 0, ( points + 2 ) * sizeof( int32_t ) );
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int i = 0; i < 3 * s->count; ++i )
        {
            const int32_t point = s->parents[i / 3][i % 3];
            const float weight = s->weights[i / 3][i % 3];
            if ( weight != 0.0f && pass == 0 )
            {
                s->share_begin[point + 2] += 1;
            }
            else if ( weight != 0.0f )
            {
                s->shares[s->share_begin[point + 1]++] = ( contact_share ){ i / 3, weight };
            }
        }
        for ( size_t i = 0; i < points && pass == 0; ++i )
        {
            s->share_begin[i + 2] += s->share_begin[i + 1];
        }
    }
}

// ---- predicted motion ----

// Return the mean of a map over the parents of a sphere: 1 without a map.
static float map_factor( const contact_spheres* s, const contact_participant* participant, const float* map,
                         int sphere )
{
    float sum = map != NULL ? 0.0f : 1.0f;
    for ( int k = 0; k < 3 && map != NULL; ++k )
    {
        sum += s->weights[sphere][k] * map[s->parents[sphere][k] - participant->first_point];
    }
    return sum;
}

static void predict_spheres( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    const contact_contact_mesh* m = work->contact_mesh;
    contact_spheres* s = m->spheres;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t* p = s->parents[i];
        const contact_participant* participant = contact_participant_of( work, p[0] );
        const float thickness =
                        participant->settings.thickness * map_factor( s, participant, participant->thickness, i ),
                    friction =
                        participant->settings.friction * map_factor( s, participant, participant->friction, i ),
                    cover =
                        contact_larger( m->spheres->cover[p[0]], contact_larger( s->cover[p[1]], s->cover[p[2]] ) );
        float from[3], to[3], squared = 0.0f;
        s->own_x4[i] = 4 * i;
        contact_place_sphere( s, m->intersection_free, i, from );
        contact_place_sphere( s, m->now, i, to );
        contact_place_sphere( s, m->rest, i, s->rest[i] );
        s->rest[i][3] = m->rest[(size_t)p[0] * 4 + 3];
        for ( int k = 0; k < 3; ++k )
        {
            s->motion[i][k] = (float)s->substeps * ( to[k] - from[k] );
            s->middle[i][k] = from[k] + 0.5f * s->motion[i][k];
            const float own = s->motion[i][k] - s->common[k];
            squared += own * own;
        }
        const float keeps = contact_larger( thickness, cover ), length = sqrtf( squared );
        const bool is_fixed = m->now[(size_t)p[0] * 4 + 3] == 0.0f && m->now[(size_t)p[1] * 4 + 3] == 0.0f &&
                              m->now[(size_t)p[2] * 4 + 3] == 0.0f;
        const float traits[4] = { 0.5f * thickness, cover, sqrtf( friction ), is_fixed ? 1.0f : 0.0f };
        memcpy( s->traits[i], traits, sizeof( traits ) );
        s->motion[i][3] = s->margin * ( 0.25f * work->settings->margin * keeps + STRAY * length );
        const float reach = 0.5f * contact_larger( thickness, s->largest_cover ) + s->motion[i][3] + 0.5f * length;
        for ( int k = 0; k < 3; ++k )
        {
            s->boxes[i].lower[k] = s->middle[i][k] - reach;
            s->boxes[i].upper[k] = s->middle[i][k] + reach;
        }
    }
}

// Find the mean motion of all points in the step, and the largest cover.
static void find_common_motion( const contact_work* work )
{
    const contact_contact_mesh* m = work->contact_mesh;
    contact_spheres* s = m->spheres;
    double sum[3] = { 0.0, 0.0, 0.0 };
    s->largest_cover = 0.0f;
    for ( size_t i = 0; i < (size_t)m->point_count; ++i )
    {
        for ( size_t k = 0; k < 3; ++k )
        {
            sum[k] += (double)( m->now[4 * i + k] - m->intersection_free[4 * i + k] );
        }
        s->largest_cover = contact_larger( s->largest_cover, s->cover[i] );
    }
    for ( int k = 0; k < 3; ++k )
    {
        s->common[k] = (float)( sum[k] * (double)s->substeps / (double)m->point_count );
    }
}

// ---- lists ----

static float gap_of( const contact_spheres* s, int a, int b )
{
    return contact_larger( s->traits[a][0] + s->traits[b][0], contact_larger( s->traits[a][1], s->traits[b][1] ) );
}

// Return whether the straight paths of two spheres come within a distance, m.
static bool come_within( const contact_spheres* s, int a, int b, float within )
{
    float along = 0.0f, apart = -within * within, squared = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        const float d = s->middle[a][k] - s->middle[b][k], u = s->motion[a][k] - s->motion[b][k];
        apart += d * d;
        along += d * u;
        squared += u * u;
    }
    along = fabsf( along );
    // the nearest is inside of the paths, or at an end
    return 2.0f * along < squared ? apart * squared <= along * along : apart <= along - 0.25f * squared;
}

// Return whether two spheres that are near keep a distance.
static bool are_pair( const contact_work* work, int a, int b, float gap )
{
    const contact_spheres* s = work->contact_mesh->spheres;
    const contact_participant *one = work->participants + (int)s->rest[a][3],
                              *other = work->participants + (int)s->rest[b][3];
    return ( s->traits[a][3] == 0.0f || s->traits[b][3] == 0.0f ) && contact_may_meet( one, other ) &&
           ( one != other || contact_distance( s->rest[a], s->rest[b] ) > NEIGHBOURS * gap );
}

static int keep_listed( const void* context, int query, int32_t* items, int count )
{
    const contact_work* work = context;
    const contact_spheres* s = work->contact_mesh->spheres;
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t item = items[i];
        const float gap = gap_of( s, query, item );
        items[kept] = item;
        kept += come_within( s, query, item, gap + s->motion[query][3] + s->motion[item][3] ) &&
                        are_pair( work, query, item, gap )
                    ? 1
                    : 0;
    }
    return kept;
}

static void put_other( contact_spheres* s, int a, int b, float gap )
{
    const int row = s->begin[a / CONTACT_SPHERE_PACK] + s->slot[a]++;
    const size_t at = (size_t)row * CONTACT_SPHERE_PACK + (size_t)( a % CONTACT_SPHERE_PACK );
    s->other_x4[at] = 4 * b;
    s->gap[at] = gap;
}

// Put the lists of sixteen spheres side by side.
static wisp_status pack_lists( const contact_work* work, wisp_error* error )
{
    contact_spheres* s = work->contact_mesh->spheres;
    const wisp_aabb_pairs* found = &s->overlaps; // each at its lower sphere
    int32_t* count = s->slot;                    // unused until the first substep
    memset( count, 0, (size_t)s->pack_count * CONTACT_SPHERE_PACK * sizeof( *count ) );
    for ( int i = 0; i < found->query_count; ++i )
    {
        count[i] += found->begin[i + 1] - found->begin[i];
        for ( int k = found->begin[i]; k < found->begin[i + 1]; ++k )
        {
            count[found->item[k]] += 1;
        }
    }
    s->begin[0] = 0;
    for ( int pack = 0; pack < s->pack_count; ++pack )
    {
        int most = 0;
        for ( int i = pack * CONTACT_SPHERE_PACK; i < ( pack + 1 ) * CONTACT_SPHERE_PACK; ++i )
        {
            most = count[i] > most ? count[i] : most;
            count[i] = 0;
        }
        s->begin[pack + 1] = s->begin[pack] + most;
    }
    const size_t rows = (size_t)s->begin[s->pack_count], lanes = rows * CONTACT_SPHERE_PACK;
    wisp_buffer* b = s->buffers + CONTACT_SPHERE_ARRAY_COUNT - 3;
    if ( contact_reserve( work, b, lanes * sizeof( int32_t ), (void**)&s->other_x4 ) == false ||
         contact_reserve( work, b + 1, lanes * sizeof( float ), (void**)&s->gap ) == false ||
         contact_reserve( work, b + 2, rows * sizeof( uint16_t ), (void**)&s->is_near ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the pairs of %d spheres", s->count );
    }
    memset( s->other_x4, 0, lanes * sizeof( int32_t ) );
    memset( s->gap, 0, lanes * sizeof( float ) );
    for ( int i = 0; i < found->query_count; ++i )
    {
        for ( int k = found->begin[i]; k < found->begin[i + 1]; ++k )
        {
            const float gap = gap_of( s, i, found->item[k] );
            put_other( s, i, found->item[k], gap );
            put_other( s, found->item[k], i, gap );
        }
    }
    return WISP_OK;
}

wisp_status contact_list_spheres( const contact_work* work, wisp_error* error )
{
    contact_spheres* s = work->contact_mesh->spheres;
    wisp_status status = make_spheres( work, error );
    s->substeps = work->substeps_left;
    s->done = 0;
    work->contact_mesh->broad_phase->searches += 1;
    if ( status != WISP_OK )
    {
        return status;
    }
    find_covers( work );
    find_common_motion( work );
    share_points( s, (size_t)work->contact_mesh->point_count );
    status = WISP_BAD_INPUT;
    s->margin = 1.0f;
    for ( int i = 0; i < MAX_HALVED && status == WISP_BAD_INPUT; ++i )
    {
        wisp_parallel_for( work->parallel, s->pack_count * CONTACT_SPHERE_PACK, CONTACT_POINT_GRAIN, predict_spheres,
                           (void*)(uintptr_t)work );
        const wisp_aabb_args args = {
            .boxes = s->boxes,
            .box_count = s->count,
            .limit = (size_t)s->count * MAX_PER_SPHERE,
            .kernels = wisp_frame_kernels( work->frame ),
            .filter = keep_listed,
            .filter_context = work,
        };
        status = wisp_aabb_pairs_find( &s->overlaps, work->parallel, &args, error );
        s->margin *= 0.5f; // after more pairs than the limit
    }
    return status == WISP_OK ? pack_lists( work, error ) : status;
}
