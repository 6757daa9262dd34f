// Level spheres. In: positions and predicted motions at the first substep of a step, layers. Out: moved points, shifts of recovery.
//
// Which spheres may press on each other is found once per step: a pair is listed if the straight paths of both through the step come
// within their distance and a margin. Spheres lie in packs of sixteen along a curve through space; boxes around packs that overlap name
// the packs whose spheres are compared, in lanes. Neighbours in the mesh are left out. Lists depend on positions alone: a snapshot needs
// none.
//
// Each substep finds the listed pairs that come near in it. A pair keeps its distance along the line between its spheres at the start of the
// substep, so a sphere that went through another is sent back. The distance is no more than it was at the start; recovery adds to it, and
// gives no velocity.
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

enum
{
    PACK = CONTACT_SPHERE_PACK,
    GRAIN = 64, // packs, or pairs of packs, of a task
    SWEEPS = 8, // of a substep, at most
    MAX_HALVED = 12,
    MAX_PER_SPHERE = 256, // pairs before margins are halved
    MOST_STRAYED = 100,   // one in so many spheres before all are searched again
};

// Pairs are projected that come within so many distances in a substep.
static const float NEAR_GAPS = 1.25f;
// Pairs of one surface that are at rest within so many distances are neighbours: those of an edge are.
static const float NEIGHBOURS = 1.45f;
// How far a sphere may stray from its predicted motion, as a part of it.
static const float STRAY = 0.15f;

static const float WHOLE[3] = { 1.0f, 0.0f, 0.0f }; // weights of one point

static contact_spheres* spheres_of( const contact_work* work )
{
    return work->contact_mesh->spheres;
}

static wisp_status fail_memory( const contact_work* work, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d points in contact as spheres",
                      work->contact_mesh->point_count );
}

static int packs_of( int count )
{
    return ( count + PACK - 1 ) / PACK;
}

// ---- spheres of participants ----

static const wisp_samples* shared_layer( const contact_work* work, const contact_participant* participant )
{
    return participant->is_strands || participant->is_left_out
               ? NULL
               : wisp_frame_samples( work->frame, participant->entity );
}

typedef struct sphere_array
{
    void* at; // address of a pointer
    size_t bytes;
} sphere_array;

static bool reserve_all( const contact_work* work, wisp_buffer* buffers, const sphere_array* all, int count )
{
    bool enough = true;
    for ( int i = 0; i < count && enough; ++i )
    {
        enough = contact_reserve( work, buffers + i, all[i].bytes, all[i].at );
    }
    return enough;
}

static bool reserve_spheres( const contact_work* work, int count, bool has_layers )
{
    contact_spheres* s = spheres_of( work );
    const size_t packs = (size_t)packs_of( count ), n = (size_t)count, one = sizeof( float ),
                 points = (size_t)work->contact_mesh->point_count * one, of_layers = has_layers ? n : 0;
    const sphere_array all[] = {
        { &s->parents, of_layers * sizeof( *s->parents ) },
        { &s->weights, of_layers * sizeof( *s->weights ) },
        { &s->start, of_layers * 4 * one },
        { &s->now, of_layers * 4 * one },
        { &s->friction, n * one },
        { &s->cover, points },
        { &s->pairs_of, points },
        { &s->key, 2 * n * one },
        { &s->order, 2 * n * one },
        { &s->packs, packs * sizeof( *s->packs ) },
        { &s->boxes, packs * sizeof( *s->boxes ) },
        { &s->active, n * one },
        { &s->is_active, n },
    };
    const bool enough = reserve_all( work, s->buffers, all, WISP_COUNT( all ) );
    if ( has_layers == false )
    {
        s->parents = NULL;
        s->start = work->contact_mesh->intersection_free;
        s->now = work->contact_mesh->now;
    }
    s->count = enough ? count : 0;
    s->pack_count = packs_of( s->count );
    return enough;
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

// Find how far each point of a surface has to be kept from spheres so that they do not slip past it.
static void find_covers( const contact_work* work )
{
    const contact_contact_mesh* m = work->contact_mesh;
    float* cover = m->spheres->cover;
    memset( cover, 0, (size_t)m->point_count * sizeof( *cover ) );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        const float part = participant->is_strands ? 0.0f : CONTACT_COVER / participant->layer_parts;
        const int32_t* edge = m->edges + 2 * (size_t)participant->first_edge;
        for ( int e = 0; e < participant->edge_count && part > 0.0f; ++e, edge += 2 )
        {
            const float keeps =
                part * contact_distance( m->rest + (size_t)edge[0] * 4, m->rest + (size_t)edge[1] * 4 );
            cover[edge[0]] = contact_larger( cover[edge[0]], keeps );
            cover[edge[1]] = contact_larger( cover[edge[1]], keeps );
        }
    }
    m->spheres->largest_cover = 0.0f;
    for ( int i = 0; i < m->point_count; ++i )
    {
        m->spheres->largest_cover = contact_larger( m->spheres->largest_cover, cover[i] );
    }
}

// Make the points of all participants spheres, and behind them the points of their layers.
static bool place_layers( const contact_work* work )
{
    contact_spheres* s = spheres_of( work );
    const int points = work->contact_mesh->point_count;
    int total = points;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        contact_participant* participant = work->participants + g;
        const wisp_samples* layer = shared_layer( work, participant );
        const bool is_divided = layer != NULL && participant->edge_count > 0;
        total += layer != NULL ? layer->count : 0;
        participant->layer_parts =
            is_divided ? 1.0f + (float)layer->edge_count / (float)participant->edge_count : 1.0f;
    }
    if ( reserve_spheres( work, total, total > points ) == false )
    {
        return false;
    }
    for ( int i = 0; i < points && total > points; ++i )
    {
        put_sphere( s, i, i, ( const int32_t[3] ){ 0 }, WHOLE );
    }
    for ( int g = 0, at = points; g < work->participant_count && total > points; ++g )
    {
        const wisp_samples* layer = shared_layer( work, work->participants + g );
        for ( int i = 0; layer != NULL && i < layer->count; ++i )
        {
            put_sphere( s, at++, work->participants[g].first_point, layer->parents[i], layer->weights[i] );
        }
    }
    return true;
}

// The points of a sphere.
typedef struct sphere_parts
{
    int count;
    const int32_t* point;
    const float* weight;
} sphere_parts;

static inline sphere_parts parts_of( const contact_spheres* s, const int32_t* sphere )
{
    return s->parents == NULL ? ( sphere_parts ){ 1, sphere, WHOLE }
                              : ( sphere_parts ){ 3, s->parents[*sphere], s->weights[*sphere] };
}

// Compute the position of a sphere.
static void place_sphere( const sphere_parts* parts, const float* xyzw, float out[3] )
{
    const float* at = xyzw + (size_t)parts->point[0] * 4;
    memcpy( out, at, 3 * sizeof( *out ) );
    for ( int i = 1; i < parts->count; ++i )
    {
        const float* other = xyzw + (size_t)parts->point[i] * 4;
        for ( int k = 0; k < 3; ++k )
        {
            out[k] += parts->weight[i] * ( other[k] - at[k] );
        }
    }
}

typedef struct sphere_loop
{
    const contact_work* work;
    wisp_point_list_args list;
    wisp_point_pair_args pairs;
    void ( *run )( const wisp_point_list_args* args, int begin, int end ); // a kernel
    float progress; // of the step, at the end of the substep, less a half
    _Atomic int count;
} sphere_loop;

// Place spheres of layers, and give those that can move an inverse mass.
static void place_spheres( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_contact_mesh* m = loop->work->contact_mesh;
    const contact_spheres* s = m->spheres;
    for ( int i = begin; i < end; ++i )
    {
        const sphere_parts parts = parts_of( s, &i );
        float *now = s->now + (size_t)i * 4, w = 0.0f;
        for ( int k = 0; k < parts.count; ++k )
        {
            w += parts.weight[k] * m->now[(size_t)parts.point[k] * 4 + 3];
        }
        place_sphere( &parts, m->intersection_free, s->start + (size_t)i * 4 );
        place_sphere( &parts, m->now, now );
        now[3] = w;
    }
}

static void place_layer_spheres( sphere_loop* loop )
{
    const contact_spheres* s = spheres_of( loop->work );
    if ( s->parents != NULL )
    {
        wisp_parallel_for( loop->work->parallel, s->count, CONTACT_POINT_GRAIN, place_spheres, loop );
    }
}

// ---- packs ----

// Return the mean of a map over the points of a sphere: 1 without a map.
static float map_factor( const sphere_parts* parts, const contact_participant* participant, const float* map )
{
    float sum = map != NULL ? 0.0f : 1.0f;
    for ( int i = 0; i < parts->count && map != NULL; ++i )
    {
        sum += parts->weight[i] * map[parts->point[i] - participant->first_point];
    }
    return sum;
}

// Fill in what spheres keep during a step. Lanes behind the last sphere are copies of it.
static void fill_packs( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    const contact_contact_mesh* m = loop->work->contact_mesh;
    contact_spheres* s = m->spheres;
    for ( int at = begin; at < end; ++at )
    {
        const int32_t i = (int32_t)s->order[at < s->count ? at : s->count - 1];
        const sphere_parts parts = parts_of( s, &i );
        const contact_participant* participant = contact_participant_of( loop->work, parts.point[0] );
        wisp_point_pack* pack = s->packs + at / PACK;
        const int lane = at % PACK;
        float rest[3] = { 0.0f }, cover = 0.0f;
        if ( contact_may_meet( participant, participant ) ) // else all are neighbours
        {
            place_sphere( &parts, m->rest, rest );
        }
        for ( int k = 0; k < parts.count; ++k )
        {
            cover = contact_larger( cover, s->cover[parts.point[k]] );
        }
        for ( int k = 0; k < 3; ++k )
        {
            pack->rest[k][lane] = rest[k];
        }
        pack->half[lane] =
            0.5f * participant->settings.thickness * map_factor( &parts, participant, participant->thickness );
        pack->cover[lane] = cover;
        pack->group[lane] = m->rest[(size_t)parts.point[0] * 4 + 3];
        pack->point_x4[lane] = 4 * i;
        s->friction[i] =
            sqrtf( participant->settings.friction * map_factor( &parts, participant, participant->friction ) );
    }
}

// Put two zeros between the bits of a number below 256.
static uint32_t spread_bits( uint32_t x )
{
    x = ( x | x << 8 ) & 0xf00fu;
    x = ( x | x << 4 ) & 0xc30c3u;
    return ( x | x << 2 ) & 0x249249u;
}

// Sort the spheres along a curve through the 256 x 256 x 256 cells of a cube around all (Morton 1966), by two digits.
static void sort_spheres( const contact_spheres* s )
{
    enum
    {
        DIGIT_LENGTH = 12,
        PLACES = 1 << DIGIT_LENGTH,
    };
    const size_t n = (size_t)s->count;
    float lower[4] = { INFINITY, INFINITY, INFINITY }, upper[4] = { -INFINITY, -INFINITY, -INFINITY };
    for ( size_t i = 0; i < 4 * n; ++i )
    {
        lower[i % 4] = contact_smaller( s->start[i], lower[i % 4] );
        upper[i % 4] = contact_larger( s->start[i], upper[i % 4] );
    }
    const float size = contact_larger( contact_larger( upper[0] - lower[0], upper[1] - lower[1] ),
                                       contact_larger( upper[2] - lower[2], 1e-12f ) );
    for ( size_t i = 0; i < n; ++i )
    {
        s->key[i] = 0;
        s->order[i] = (uint32_t)i;
        for ( size_t k = 0; k < 3; ++k )
        {
            const float cell = 255.0f / size * ( s->start[4 * i + k] - lower[k] );
            s->key[i] = s->key[i] << 1 | spread_bits( cell > 0.0f ? (uint32_t)contact_smaller( cell, 255.0f ) : 0u );
        }
    }
    for ( int pass = 0; pass < 2; ++pass )
    {
        uint32_t place[PLACES + 1] = { 0 };
        const size_t from = pass == 0 ? 0 : n, to = n - from;
        for ( size_t i = from; i < from + n; ++i )
        {
            place[( s->key[i] >> pass * DIGIT_LENGTH & ( PLACES - 1 ) ) + 1] += 1;
        }
        for ( int d = 0; d < PLACES; ++d )
        {
            place[d + 1] += place[d];
        }
        for ( size_t i = from; i < from + n; ++i )
        {
            const size_t at = to + place[s->key[i] >> pass * DIGIT_LENGTH & ( PLACES - 1 )]++;
            s->key[at] = s->key[i];
            s->order[at] = s->order[i];
        }
    }
}

wisp_status contact_make_spheres( const contact_work* work, wisp_error* error )
{
    contact_spheres* s = spheres_of( work );
    sphere_loop loop = { .work = work };
    if ( place_layers( work ) == false )
    {
        return fail_memory( work, error );
    }
    if ( work->contact_mesh->is_listed == false || s->parents != NULL )
    {
        find_covers( work );
    }
    place_layer_spheres( &loop );
    sort_spheres( s );
    wisp_parallel_for( work->parallel, s->pack_count * PACK, CONTACT_POINT_GRAIN, fill_packs, &loop );
    return WISP_OK;
}

// ---- lists ----

static wisp_point_list_args list_args( const contact_work* work )
{
    const contact_spheres* s = spheres_of( work );
    return ( wisp_point_list_args ){ .packs = s->packs,
                                     .point_count = s->count,
                                     .start = s->start,
                                     .now = s->now,
                                     .boxes = s->boxes,
                                     .common = { s->common[0], s->common[1], s->common[2] },
                                     .substeps = (float)s->substeps,
                                     .stray_by_gap = 0.25f * work->settings->margin * s->margin,
                                     .stray_by_motion = STRAY * s->margin,
                                     .largest_cover = s->largest_cover,
                                     .neighbours = NEIGHBOURS,
                                     .first = s->first,
                                     .second = s->second,
                                     .found = s->found,
                                     .count = s->pair_count };
}

static void run_on_packs( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    loop->run( &loop->list, begin, end );
}

static bool reserve_sphere_pairs( const contact_work* work, contact_sphere_pairs* pairs, size_t count, bool are_near )
{
    const size_t n = ( count + PACK ) * sizeof( float );
    const sphere_array all[] = {
        { &pairs->point_x4[0], n },
        { &pairs->point_x4[1], n },
        { &pairs->gap, n },
        { &pairs->friction, n },
        { &pairs->found, ( count / PACK + 1 ) * sizeof( uint16_t ) },
        { &pairs->push, are_near ? 4 * n : 0 },
        { &pairs->shift, are_near ? 4 * n : 0 },
    };
    pairs->count = 0;
    return reserve_all( work, pairs->buffers, all, WISP_COUNT( all ) );
}

static void put_sphere_pair( contact_sphere_pairs* pairs, int32_t a_x4, int32_t b_x4, float gap, float friction )
{
    const int at = pairs->count++;
    pairs->point_x4[0][at] = a_x4;
    pairs->point_x4[1][at] = b_x4;
    pairs->gap[at] = gap;
    pairs->friction[at] = friction;
}

// Fill the last pack with pairs without a distance to keep.
static void end_pairs( contact_sphere_pairs* pairs )
{
    const int count = pairs->count;
    pairs->pack_count = packs_of( count );
    while ( pairs->count < pairs->pack_count * PACK )
    {
        put_sphere_pair( pairs, 0, 0, 0.0f, 0.0f );
    }
    pairs->count = count;
}

static void list_lane( const contact_work* work, const wisp_point_pack* a, int lane, const wisp_point_pack* b,
                       uint32_t bits )
{
    contact_spheres* s = spheres_of( work );
    const int one = a->point_x4[lane];
    const contact_participant* participant = work->participants + (int)a->group[lane];
    for ( ; bits != 0; bits &= bits - 1 )
    {
        const int to = __builtin_ctz( bits ), other = b->point_x4[to];
        const bool may_meet =
            a->group[lane] == b->group[to] || contact_may_meet( participant, work->participants + (int)b->group[to] );
        if ( may_meet && ( s->now[one + 3] > 0.0f || s->now[other + 3] > 0.0f ) )
        {
            const float gap =
                contact_larger( a->half[lane] + b->half[to], contact_larger( a->cover[lane], b->cover[to] ) );
            put_sphere_pair( &s->listed, one, other, gap, s->friction[one / 4] * s->friction[other / 4] );
        }
    }
}

// List the pairs of spheres of all packs whose boxes overlap. @return WISP_BAD_INPUT if there are too many
static wisp_status list_packs( sphere_loop* loop, wisp_error* error )
{
    const contact_work* work = loop->work;
    contact_spheres* s = spheres_of( work );
    const wisp_aabb_args args = { .boxes = s->boxes,
                                  .box_count = s->pack_count,
                                  .limit = (size_t)s->pack_count * MAX_PER_SPHERE,
                                  .kernels = wisp_frame_kernels( work->frame ) };
    WISP_TRY( wisp_aabb_pairs_find( &s->overlaps, work->parallel, &args, error ) );
    const size_t count = s->overlaps.pair_count + (size_t)s->pack_count;
    wisp_buffer* b = s->buffers + CONTACT_SPHERE_ARRAY_COUNT - 4;
    bool enough = contact_reserve( work, b, count * sizeof( int32_t ), (void**)&s->first ) &&
                  contact_reserve( work, b + 1, count * sizeof( int32_t ), (void**)&s->second ) &&
                  contact_reserve( work, b + 2, count * sizeof( int32_t ), (void**)&s->pair_count ) &&
                  contact_reserve( work, b + 3, count * sizeof( *s->found ), (void**)&s->found );
    size_t at = 0, found = 0;
    for ( int pack = 0; pack < s->pack_count && enough; ++pack )
    {
        s->second[at] = pack;
        for ( int i = s->overlaps.begin[pack]; i < s->overlaps.begin[pack + 1]; ++i )
        {
            s->first[at++] = pack;
            s->second[at] = s->overlaps.item[i];
        }
        s->first[at++] = pack;
    }
    loop->list = list_args( work );
    loop->run = wisp_frame_kernels( work->frame )->list_point_pairs;
    wisp_parallel_for( work->parallel, (int)at, GRAIN, run_on_packs, loop );
    for ( size_t i = 0; i < at; ++i )
    {
        found += (size_t)s->pair_count[i];
    }
    if ( found > (size_t)s->count * MAX_PER_SPHERE )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "spheres in contact: got %zu near pairs of %d spheres", found,
                          s->count );
    }
    enough = enough && reserve_sphere_pairs( work, &s->listed, found, false );
    for ( size_t i = 0; i < at && enough; ++i )
    {
        for ( int lane = 0; lane < PACK && s->pair_count[i] > 0; ++lane )
        {
            list_lane( work, s->packs + s->first[i], lane, s->packs + s->second[i], s->found[i][lane] );
        }
    }
    end_pairs( &s->listed );
    return enough ? WISP_OK : fail_memory( work, error );
}

// Find the mean motion of all points.
static void find_common_motion( const contact_work* work )
{
    const contact_contact_mesh* m = work->contact_mesh;
    const wisp_displacement_args args = { .before = m->intersection_free, .now = m->now };
    double sum[3];
    (void)wisp_frame_kernels( work->frame )->sum_displacements( &args, 0, m->point_count, sum );
    for ( int k = 0; k < 3; ++k )
    {
        m->spheres->common[k] = (float)( sum[k] * (double)m->spheres->substeps / (double)m->point_count );
    }
}

wisp_status contact_list_spheres( const contact_work* work, wisp_error* error )
{
    contact_spheres* s = spheres_of( work );
    sphere_loop loop = { .work = work };
    wisp_status status = WISP_BAD_INPUT;
    work->contact_mesh->broad_phase->searches += 1;
    s->substeps = work->substeps_left;
    s->done = 0;
    s->margin = 1.0f;
    find_common_motion( work );
    for ( int i = 0; i < MAX_HALVED && status == WISP_BAD_INPUT; ++i )
    {
        loop.list = list_args( work );
        loop.run = wisp_frame_kernels( work->frame )->predict_points;
        wisp_parallel_for( work->parallel, s->pack_count, GRAIN, run_on_packs, &loop );
        status = list_packs( &loop, error );
        s->margin *= 0.5f; // after more pairs than the limit
    }
    s->margin *= 2.0f;
    return status;
}

// ---- near pairs of a substep ----

static wisp_point_pair_args pair_args( const contact_spheres* s, const contact_sphere_pairs* pairs )
{
    return ( wisp_point_pair_args ){ .start = s->start,
                                     .now = s->now,
                                     .point_x4 = { pairs->point_x4[0], pairs->point_x4[1] },
                                     .gap = pairs->gap,
                                     .friction = pairs->friction,
                                     .reach = NEAR_GAPS,
                                     .found = pairs->found,
                                     .push = pairs->push,
                                     .shift = pairs->shift };
}

static void count_strayed( void* context, int begin, int end, int worker )
{
    (void)worker;
    sphere_loop* loop = context;
    const int strayed =
        wisp_frame_kernels( loop->work->frame )->count_strayed( &loop->list, loop->progress, begin, end );
    atomic_fetch_add( &loop->count, strayed );
}

static void find_near( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sphere_loop* loop = context;
    wisp_frame_kernels( loop->work->frame )->find_near_pairs( &loop->pairs, begin, end );
}

static void activate( contact_spheres* s, int sphere )
{
    s->active[s->active_count] = sphere; // one more is no harm
    s->active_count += s->is_active[sphere] == 0 ? 1 : 0;
    s->is_active[sphere] = 1;
}

wisp_status contact_begin_spheres( const contact_work* work, wisp_error* error )
{
    contact_spheres* s = spheres_of( work );
    const contact_sphere_pairs* listed = &s->listed;
    s->done += 1;
    sphere_loop loop = { .work = work,
                         .list = list_args( work ),
                         .progress = (float)s->done / (float)s->substeps - 0.5f };
    place_layer_spheres( &loop );
    atomic_init( &loop.count, 0 );
    wisp_parallel_for( work->parallel, s->pack_count, GRAIN, count_strayed, &loop );
    s->strayed = atomic_load( &loop.count );
    if ( s->strayed > s->count / MOST_STRAYED ) // as in an impact
    {
        WISP_TRY( contact_list_spheres( work, error ) );
        s->done = 1;
        s->strayed = 0;
    }
    loop.pairs = pair_args( s, listed );
    wisp_parallel_for( work->parallel, listed->pack_count, GRAIN, find_near, &loop );
    size_t count = 0;
    for ( int pack = 0; pack < listed->pack_count; ++pack )
    {
        count += (size_t)__builtin_popcount( listed->found[pack] );
    }
    if ( reserve_sphere_pairs( work, &s->near, count, true ) == false )
    {
        return fail_memory( work, error );
    }
    memset( s->is_active, 0, (size_t)s->count );
    s->active_count = 0;
    for ( int pack = 0; pack < listed->pack_count; ++pack )
    {
        for ( uint32_t bits = listed->found[pack]; bits != 0; bits &= bits - 1 )
        {
            const int pair = pack * PACK + __builtin_ctz( bits );
            const int32_t a = listed->point_x4[0][pair], b = listed->point_x4[1][pair];
            put_sphere_pair( &s->near, a, b, listed->gap[pair], listed->friction[pair] );
            activate( s, a / 4 );
            activate( s, b / 4 );
        }
    }
    end_pairs( &s->near );
    return WISP_OK;
}

// ---- projection ----

static void place_active( void* context, int begin, int end, int worker )
{
    const contact_spheres* s = spheres_of( ( (const sphere_loop*)context )->work );
    for ( int i = begin; i < end; ++i )
    {
        place_spheres( context, s->active[i], s->active[i] + 1, worker );
    }
}

static void find_pressing( void* context, int begin, int end, int worker )
{
    (void)worker;
    sphere_loop* loop = context;
    if ( wisp_frame_kernels( loop->work->frame )->push_points( &loop->pairs, begin, end ) )
    {
        atomic_store( &loop->count, 1 );
    }
}

// Count a pair at the points of one of its spheres.
static inline void count_pair( const contact_spheres* s, int32_t sphere )
{
    const sphere_parts parts = parts_of( s, &sphere );
    for ( int i = 0; i < parts.count; ++i )
    {
        s->pairs_of[parts.point[i]] += parts.weight[i] != 0.0f ? 1.0f : 0.0f;
    }
}

// Return the inverse mass of a sphere whose points split theirs among their pairs, 1/kg.
static inline float weigh_sphere( const contact_contact_mesh* m, int32_t sphere )
{
    const sphere_parts parts = parts_of( m->spheres, &sphere );
    float sum = 0.0f;
    for ( int i = 0; i < parts.count; ++i )
    {
        const int point = parts.point[i];
        sum += parts.weight[i] * parts.weight[i] * m->spheres->pairs_of[point] * m->now[(size_t)point * 4 + 3];
    }
    return sum;
}

// Move the points of a sphere. @param by kg m @param shift kg m, what gives no velocity; null: none
static inline void move_sphere( const contact_contact_mesh* m, int32_t sphere, float factor, const float* by,
                                const float* shift )
{
    const sphere_parts parts = parts_of( m->spheres, &sphere );
    for ( int i = 0; i < parts.count; ++i )
    {
        float* now = m->now + (size_t)parts.point[i] * 4;
        const float share = factor * parts.weight[i] * now[3];
        now[0] += share * by[0];
        now[1] += share * by[1];
        now[2] += share * by[2];
        for ( size_t k = 0; k < 3 && shift != NULL; ++k )
        {
            now[k] += share * shift[k];
            m->shift[(size_t)parts.point[i] * 4 + k] += share * shift[k];
        }
    }
}

static void add_impulse( const contact_work* work, int32_t a, int32_t b, float factor, const float* by )
{
    const sphere_parts one = parts_of( spheres_of( work ), &a ), other = parts_of( spheres_of( work ), &b );
    double *of_a = contact_participant_of( work, one.point[0] )->impulse,
           *of_b = contact_participant_of( work, other.point[0] )->impulse, squared = 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const double impulse = (double)( factor * by[k] ) / (double)work->seconds;
        of_a[k] += impulse;
        of_b[k] -= impulse;
        squared += impulse * impulse;
    }
    work->memory->stats.impulse += sqrt( squared );
}

// Project all near pairs once. @return whether any pressed
static bool sweep( sphere_loop* loop, float recovery )
{
    const contact_work* work = loop->work;
    const contact_contact_mesh* m = work->contact_mesh;
    const contact_spheres* s = m->spheres;
    const contact_sphere_pairs* near = &s->near;
    loop->pairs.recovery = recovery;
    atomic_store( &loop->count, 0 );
    if ( s->parents != NULL )
    {
        wisp_parallel_for( work->parallel, s->active_count, CONTACT_POINT_GRAIN, place_active, loop );
    }
    wisp_parallel_for( work->parallel, near->pack_count, GRAIN, find_pressing, loop );
    memset( s->pairs_of, 0, (size_t)m->point_count * sizeof( *s->pairs_of ) );
    int count = 0;
    for ( int pack = 0; pack < near->pack_count; ++pack )
    {
        for ( uint32_t bits = near->found[pack]; bits != 0; bits &= bits - 1, ++count )
        {
            const int pair = pack * PACK + __builtin_ctz( bits );
            count_pair( s, near->point_x4[0][pair] / 4 );
            count_pair( s, near->point_x4[1][pair] / 4 );
        }
    }
    for ( int pack = 0; pack < near->pack_count; ++pack )
    {
        for ( uint32_t bits = near->found[pack]; bits != 0; bits &= bits - 1 )
        {
            const int pair = pack * PACK + __builtin_ctz( bits );
            const int32_t a = near->point_x4[0][pair] / 4, b = near->point_x4[1][pair] / 4;
            const float w = weigh_sphere( m, a ) + weigh_sphere( m, b ), factor = w > 0.0f ? 1.0f / w : 0.0f;
            const float *by = near->push + (size_t)pair * 4,
                        *shift = recovery > 0.0f ? near->shift + (size_t)pair * 4 : NULL;
            move_sphere( m, a, factor, by, shift );
            move_sphere( m, b, -factor, by, shift );
            if ( work->counts_impulses )
            {
                add_impulse( work, a, b, factor, by );
            }
        }
    }
    work->memory->stats.contacts = work->counts_impulses && count > 0 ? count : work->memory->stats.contacts;
    return atomic_load( &loop->count ) != 0;
}

// What touches a body stays there: it is not pushed into the body, and holds what lies on it.
static void hold_points( const contact_work* work )
{
    const contact_spheres* s = spheres_of( work );
    for ( int a = 0; a < s->active_count; ++a )
    {
        const sphere_parts parts = parts_of( s, s->active + a );
        for ( int i = 0; i < parts.count; ++i )
        {
            const int point = parts.point[i];
            const contact_participant* participant = contact_participant_of( work, point );
            const bool is_held =
                participant->half_spaces != NULL && participant->half_spaces[point - participant->first_point] > 0;
            float* w = work->contact_mesh->now + (size_t)point * 4 + 3;
            work->contact_mesh->is_pushed[point] = 1;
            *w = is_held ? 0.0f : *w;
        }
    }
}

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

void contact_push_spheres( const contact_work* work, bool is_last )
{
    const contact_spheres* s = spheres_of( work );
    sphere_loop loop = { .work = work, .pairs = pair_args( s, &s->near ) };
    work->memory->stats.contacts = 0;
    atomic_init( &loop.count, 0 );
    memset( work->contact_mesh->is_pushed, 0, (size_t)work->contact_mesh->point_count );
    if ( s->near.pack_count > 0 )
    {
        hold_points( work );
        for ( int i = is_last ? 1 : 0; i < SWEEPS && sweep( &loop, 0.0f ); ++i )
        {
        }
        if ( is_last )
        {
            (void)sweep( &loop, recovery_of( work ) );
        }
    }
}

// A point of several spheres is copied several times: its shift is added once.
void contact_scatter_spheres( const contact_work* work, bool is_end )
{
    const contact_contact_mesh* m = work->contact_mesh;
    const contact_spheres* s = m->spheres;
    for ( int a = 0; a < s->active_count; ++a )
    {
        const sphere_parts parts = parts_of( s, s->active + a );
        for ( int i = 0; i < parts.count; ++i )
        {
            const int point = parts.point[i];
            const contact_participant* participant = contact_participant_of( work, point );
            const size_t from = (size_t)point * 4, to = (size_t)( point - participant->first_point ) * 4;
            if ( participant->is_strands == false && participant->halted == false && m->now[from + 3] > 0.0f )
            {
                memcpy( participant->position + to, m->now + from, 3 * sizeof( float ) );
                for ( size_t k = 0; k < 3 && is_end; ++k )
                {
                    participant->previous[to + k] += m->shift[from + k];
                    m->shift[from + k] = 0.0f;
                }
            }
        }
    }
}

float contact_least_sphere_gap( const contact_work* work )
{
    const contact_spheres* s = spheres_of( work );
    sphere_loop loop = { .work = work };
    place_layer_spheres( &loop );
    float least = INFINITY;
    for ( int pair = 0; pair < s->listed.count; ++pair )
    {
        const float distance =
            contact_distance( s->now + s->listed.point_x4[0][pair], s->now + s->listed.point_x4[1][pair] );
        least = contact_smaller( distance / s->listed.gap[pair], least );
    }
    return least;
}
