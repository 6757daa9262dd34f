// Which spheres may press on each other in a step. In: positions and predicted motions at its first substep, layers. Out: spheres in the
// order of the cells of a uniform grid, and for each sphere the list of others.
//
// A pair is listed if the straight paths of both through the step come within their distance and a margin. Cells hold the middles of
// those paths. Neighbours in the mesh are left out. Lists depend on positions alone: a snapshot needs none.
#include "spheres.h"

#include "broad_phase.h"

#include "wisp/samples.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    CELL_BITS = 11, // of a cell that spheres are sorted by
    CELL_DIGITS = 1 << CELL_BITS,
    MAX_CELLS = 1 << 30,
    RUNS = 9, // of cells around one: three along the first axis follow each other
    GRID_GRAIN = 512,
    LIST_PACKS = 16,
    LEAST_ROWS = 16,
    MOST_ROWS = 256, // of a pack; what does not fit is counted
};

// Pairs of one surface that are at rest within so many distances are neighbours.
static const float NEIGHBOURS = 1.6f;
// How far a sphere may stray from its predicted motion, as a part of it, and of that the most, in distances.
static const float STRAY = 0.25f, MOST_MOTION = 2.0f;

// ---- memory ----

static bool reserve_spheres( const contact_work* work, int count )
{
    contact_spheres* s = work->contact_mesh->spheres;
    const size_t packs = (size_t)( count + CONTACT_SPHERE_PACK - 1 ) / CONTACT_SPHERE_PACK,
                 n = packs * CONTACT_SPHERE_PACK, points = (size_t)work->contact_mesh->point_count;
    const struct
    {
        void** at;
        size_t bytes;
    } all[] = {
        { (void**)&s->parents, n * sizeof( *s->parents ) },
        { (void**)&s->weights, n * sizeof( *s->weights ) },
        { (void**)&s->rest, n * sizeof( *s->rest ) },
        { (void**)&s->traits, n * sizeof( *s->traits ) },
        { (void**)&s->motion, n * sizeof( *s->motion ) },
        { (void**)&s->middle[0], n * sizeof( float ) },
        { (void**)&s->middle[1], n * sizeof( float ) },
        { (void**)&s->middle[2], n * sizeof( float ) },
        { (void**)&s->start, n * 4 * sizeof( float ) },
        { (void**)&s->now, n * 4 * sizeof( float ) },
        { (void**)&s->push, n * 4 * sizeof( float ) },
        { (void**)&s->shift, n * 4 * sizeof( float ) },
        { (void**)&s->count_of, n * sizeof( float ) },
        { (void**)&s->rows, packs * sizeof( int32_t ) },
        { (void**)&s->inverse_mass, points * sizeof( float ) },
        { (void**)&s->share_begin, ( points + 2 ) * sizeof( int32_t ) },
        { (void**)&s->shares, 3 * n * sizeof( *s->shares ) },
        { (void**)&s->cell, n * sizeof( uint32_t ) },
        { (void**)&s->spare_cell, n * sizeof( uint32_t ) },
        { (void**)&s->order, n * sizeof( int32_t ) },
        { (void**)&s->spare_order, n * sizeof( int32_t ) },
        { (void**)&s->from_parents, n * sizeof( *s->from_parents ) },
        { (void**)&s->from_weights, n * sizeof( *s->from_weights ) },
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

// Rows of all packs: indices, gaps and bits in one piece.
static bool reserve_rows( const contact_work* work, int capacity )
{
    contact_spheres* s = work->contact_mesh->spheres;
    const size_t rows = (size_t)s->pack_count * (size_t)capacity, lanes = rows * CONTACT_SPHERE_PACK;
    s->capacity = capacity;
    if ( contact_reserve( work, s->buffers + CONTACT_SPHERE_ARRAY_COUNT - 1,
                          lanes * ( sizeof( int32_t ) + sizeof( float ) ) + rows * sizeof( uint16_t ),
                          (void**)&s->other_x4 ) == false )
    {
        return false;
    }
    s->gap = (float*)(void*)( s->other_x4 + lanes );
    s->presses = (uint16_t*)(void*)( s->gap + lanes );
    return true;
}

// ---- spheres of participants ----

static const wisp_samples* sphere_layer( const contact_work* work, const contact_participant* participant )
{
    return participant->is_strands || participant->is_left_out
               ? NULL
               : wisp_frame_samples( work->frame, participant->entity );
}

static void fill_participant( const contact_work* work, const contact_participant* participant, int at )
{
    static const float WHOLE[3] = { 1.0f, 0.0f, 0.0f };
    contact_spheres* s = work->contact_mesh->spheres;
    const wisp_samples* layer = sphere_layer( work, participant );
    for ( int i = 0; i < participant->point_count; ++i, ++at )
    {
        for ( int k = 0; k < 3; ++k )
        {
            s->from_parents[at][k] = participant->first_point + i;
        }
        memcpy( s->from_weights[at], WHOLE, sizeof( WHOLE ) );
    }
    for ( int i = 0; layer != NULL && i < layer->count; ++i, ++at )
    {
        for ( int k = 0; k < 3; ++k )
        {
            s->from_parents[at][k] = participant->first_point + layer->parents[i][k] / 4;
        }
        memcpy( s->from_weights[at], layer->weights[i], sizeof( *s->from_weights ) );
    }
}

static wisp_status make_spheres( const contact_work* work, wisp_error* error )
{
    int total = 0;
    for ( int pass = 0; pass < 2; ++pass )
    {
        if ( pass == 1 && reserve_spheres( work, total ) == false )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d spheres in contact", total );
        }
        total = 0;
        for ( int g = 0; g < work->participant_count; ++g )
        {
            contact_participant* participant = work->participants + g;
            const wisp_samples* layer = sphere_layer( work, participant );
            if ( pass == 1 )
            {
                fill_participant( work, participant, total );
                // between two vertices of an edge are the points of the layer on it
                const float parts = layer != NULL && participant->edge_count > 0
                                        ? 1.0f + (float)layer->edge_count / (float)participant->edge_count
                                        : 1.0f;
                participant->sphere_distance = participant->cover / parts;
            }
            total += participant->point_count + ( layer != NULL ? layer->count : 0 );
        }
    }
    return WISP_OK;
}

// ---- predicted motion ----

static void mean( const float* xyzw, const int32_t parents[3], const float weights[3], float out[3] )
{
    for ( size_t k = 0; k < 3; ++k )
    {
        const float o = xyzw[(size_t)parents[0] * 4 + k];
        out[k] = o + weights[1] * ( xyzw[(size_t)parents[1] * 4 + k] - o ) +
                 weights[2] * ( xyzw[(size_t)parents[2] * 4 + k] - o );
    }
}

void contact_place_sphere( const contact_spheres* s, const float* xyzw, int sphere, float out[3] )
{
    mean( xyzw, s->parents[sphere], s->weights[sphere], out );
}

static void find_common_motion( const contact_work* work )
{
    const contact_contact_mesh* m = work->contact_mesh;
    double sum[3] = { 0.0, 0.0, 0.0 };
    for ( size_t i = 0; i < (size_t)m->point_count * 4; ++i )
    {
        if ( i % 4 < 3 )
        {
            sum[i % 4] += (double)( m->now[i] - m->intersection_free[i] );
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        m->spheres->common[k] = (float)( sum[k] * (double)m->spheres->substeps / (double)m->point_count );
    }
}

// Predict the motion of a sphere in the step. @param middle m, of its path @return m, its length relative to the mean motion
static float predict( const contact_work* work, const int32_t parents[3], const float weights[3], float motion[3],
                      float middle[3] )
{
    const contact_contact_mesh* m = work->contact_mesh;
    float from[3], to[3], squared = 0.0f;
    mean( m->intersection_free, parents, weights, from );
    mean( m->now, parents, weights, to );
    for ( int k = 0; k < 3; ++k )
    {
        motion[k] = (float)m->spheres->substeps * ( to[k] - from[k] );
        middle[k] = from[k] + 0.5f * motion[k];
        const float own = motion[k] - m->spheres->common[k];
        squared += own * own;
    }
    return contact_smaller( sqrtf( squared ), MOST_MOTION * m->spheres->largest );
}

// ---- cells ----

typedef struct grid
{
    float lower[3], size; // m
    float radius;         // m, of the search around a sphere: cells are as large
    int count[3];
} grid;

// Choose cells as large as any pair may be apart in the middle of its paths.
static void choose_cells( const contact_work* work, grid* g )
{
    contact_spheres* s = work->contact_mesh->spheres;
    float upper[3] = { -INFINITY, -INFINITY, -INFINITY }, longest = 0.0f;
    g->lower[0] = g->lower[1] = g->lower[2] = INFINITY;
    for ( int i = 0; i < s->count; ++i )
    {
        float motion[3], *middle = s->now + (size_t)i * 4; // unused until the first substep
        const float length = predict( work, s->from_parents[i], s->from_weights[i], motion, middle );
        longest = contact_larger( longest, length );
        for ( int k = 0; k < 3; ++k )
        {
            g->lower[k] = contact_smaller( middle[k], g->lower[k] );
            upper[k] = contact_larger( middle[k], upper[k] );
        }
    }
    g->radius = 1.001f * ( ( 1.0f + work->settings->margin ) * s->largest + ( 1.0f + 2.0f * STRAY ) * longest );
    g->size = g->radius;
    for ( double cells = 2.0 * MAX_CELLS; cells > (double)MAX_CELLS; g->size *= 2.0f )
    {
        cells = 1.0;
        for ( int k = 0; k < 3; ++k )
        {
            const float along = contact_smaller( floorf( ( upper[k] - g->lower[k] ) / g->size ), 1e9f );
            g->count[k] = (int)contact_larger( along, 0.0f ) + 3; // with a border
            cells *= (double)g->count[k];
        }
        if ( cells <= (double)MAX_CELLS )
        {
            break;
        }
    }
    s->cells[0] = g->count[0];
    s->cells[1] = g->count[1];
}

static uint32_t cell_of( const grid* g, const float at[3] )
{
    int cell[3];
    for ( int k = 0; k < 3; ++k )
    {
        const float along = ( at[k] - g->lower[k] ) / g->size;
        cell[k] = 1 + (int)contact_smaller( contact_larger( along, 0.0f ), (float)( g->count[k] - 3 ) );
    }
    return (uint32_t)( ( cell[2] * g->count[1] + cell[1] ) * g->count[0] + cell[0] );
}

// Sort spheres by their cell; those of one cell stay in their order.
static void sort_by_cell( contact_spheres* s, uint32_t cells )
{
    for ( int shift = 0; cells >> shift > 0; shift += CELL_BITS )
    {
        int32_t begin[CELL_DIGITS + 1] = { 0 };
        for ( int i = 0; i < s->count; ++i )
        {
            begin[( s->cell[i] >> shift ) % CELL_DIGITS + 1] += 1;
        }
        for ( int digit = 0; digit < CELL_DIGITS; ++digit )
        {
            begin[digit + 1] += begin[digit];
        }
        for ( int i = 0; i < s->count; ++i )
        {
            const int to = begin[( s->cell[i] >> shift ) % CELL_DIGITS]++;
            s->spare_cell[to] = s->cell[i];
            s->spare_order[to] = s->order[i];
        }
        uint32_t* cell = s->cell;
        int32_t* order = s->order;
        s->cell = s->spare_cell;
        s->order = s->spare_order;
        s->spare_cell = cell;
        s->spare_order = order;
    }
}

// ---- spheres in their order ----

static float sphere_factor( const contact_participant* participant, const float* map, const int32_t parents[3],
                            const float weights[3] )
{
    float sum = map != NULL ? 0.0f : 1.0f;
    for ( int k = 0; k < 3 && map != NULL; ++k )
    {
        sum += weights[k] * map[parents[k] - participant->first_point];
    }
    return sum;
}

static void fill_spheres( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    const contact_contact_mesh* m = work->contact_mesh;
    contact_spheres* s = m->spheres;
    for ( int i = begin; i < end; ++i )
    {
        const int from = s->order[i < s->count ? i : s->count - 1]; // the last pack is filled up with the last sphere
        int32_t* parents = s->parents[i];
        float middle[3];
        memcpy( parents, s->from_parents[from], sizeof( *s->parents ) );
        memcpy( s->weights[i], s->from_weights[from], sizeof( *s->weights ) );
        const float length = predict( work, parents, s->weights[i], s->motion[i], middle );
        const contact_participant* participant = contact_participant_of( work, parents[0] );
        mean( m->rest, parents, s->weights[i], s->rest[i] );
        s->rest[i][3] = m->rest[(size_t)parents[0] * 4 + 3];
        const float thickness = participant->settings.thickness *
                                sphere_factor( participant, participant->thickness, parents, s->weights[i] );
        s->traits[i][0] = 0.5f * thickness;
        s->traits[i][1] = participant->sphere_distance;
        s->traits[i][2] = sqrtf( participant->settings.friction *
                                 sphere_factor( participant, participant->friction, parents, s->weights[i] ) );
        s->motion[i][3] = 0.5f * work->settings->margin * contact_larger( thickness, participant->sphere_distance ) +
                          STRAY * length;
        for ( int k = 0; k < 3; ++k )
        {
            s->middle[k][i] = middle[k];
        }
    }
}

static void share_points( const contact_work* work )
{
    contact_spheres* s = work->contact_mesh->spheres;
    const size_t points = (size_t)work->contact_mesh->point_count;
    // a counting sort: counts go two places ahead, so that filling leaves each start in place
    memset( s->share_begin, 0, ( points + 2 ) * sizeof( int32_t ) );
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int i = 0; i < s->count; ++i )
        {
            for ( int k = 0; k < 3; ++k )
            {
                if ( s->weights[i][k] != 0.0f && pass == 0 )
                {
                    s->share_begin[s->parents[i][k] + 2] += 1;
                }
                else if ( s->weights[i][k] != 0.0f )
                {
                    s->shares[s->share_begin[s->parents[i][k] + 1]++] = ( contact_share ){ i, s->weights[i][k] };
                }
            }
        }
        for ( size_t i = 0; i < points && pass == 0; ++i )
        {
            s->share_begin[i + 2] += s->share_begin[i + 1];
        }
    }
}

// ---- lists ----

typedef struct sphere_list
{
    const contact_work* work;
    float radius;
    _Atomic int longest;  // rows that a pack needs
    _Atomic int left_out; // spheres with more pairs than there are rows
    _Atomic int64_t candidates;
    _Atomic bool is_out_of_memory;
} sphere_list;

static bool is_sphere_fixed( const contact_contact_mesh* m, int sphere )
{
    const int32_t* p = m->spheres->parents[sphere];
    return m->now[(size_t)p[0] * 4 + 3] == 0.0f && m->now[(size_t)p[1] * 4 + 3] == 0.0f &&
           m->now[(size_t)p[2] * 4 + 3] == 0.0f;
}

// Return the distance that two spheres keep, m; 0 if they are no pair.
static float gap_of( const contact_work* work, int a, int b )
{
    const contact_spheres* s = work->contact_mesh->spheres;
    const contact_participant *one = work->participants + (int)s->rest[a][3],
                              *other = work->participants + (int)s->rest[b][3];
    const float gap =
        contact_larger( s->traits[a][0] + s->traits[b][0], contact_larger( s->traits[a][1], s->traits[b][1] ) );
    const bool is_pair =
        contact_may_meet( one, other ) &&
        ( one != other || contact_distance( s->rest[a], s->rest[b] ) > NEIGHBOURS * gap ) &&
        ( is_sphere_fixed( work->contact_mesh, a ) && is_sphere_fixed( work->contact_mesh, b ) ) == false;
    return is_pair ? gap : 0.0f;
}

// Return whether the straight paths of two spheres come within a distance, m.
static bool come_within( const contact_spheres* s, int a, int b, float within )
{
    float d[3], u[3], along = 0.0f, squared = 0.0f, least = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        d[k] = s->middle[k][a] - s->middle[k][b];
        u[k] = s->motion[a][k] - s->motion[b][k];
        along -= d[k] * u[k];
        squared += u[k] * u[k];
    }
    const float time =
        squared > 0.0f ? contact_smaller( contact_larger( along / squared, -0.5f ), 0.5f ) : 0.0f; // 0: the middle
    for ( int k = 0; k < 3; ++k )
    {
        const float x = d[k] + time * u[k];
        least += x * x;
    }
    return least <= within * within;
}

// Cells around that of a sphere, as runs of spheres. Both ends only move forward from sphere to sphere.
typedef struct runs
{
    int begin[RUNS], end[RUNS];
} runs;

static int skip_to( const contact_spheres* s, int at, int64_t cell )
{
    int upper = s->count, step = 1;
    while ( at + step < s->count && (int64_t)s->cell[at + step] < cell )
    {
        at += step;
        step *= 2;
    }
    upper = at + step < upper ? at + step : upper;
    while ( at < upper )
    {
        const int middle = at + ( upper - at ) / 2;
        const bool is_before = (int64_t)s->cell[middle] < cell;
        at = is_before ? middle + 1 : at;
        upper = is_before ? upper : middle;
    }
    return at;
}

static void find_runs( const contact_spheres* s, int sphere, runs* r )
{
    for ( int i = 0; i < RUNS; ++i )
    {
        const int64_t middle = (int64_t)s->cell[sphere] +
                               ( (int64_t)( i / 3 - 1 ) * s->cells[1] + ( i % 3 - 1 ) ) * (int64_t)s->cells[0];
        r->begin[i] = skip_to( s, r->begin[i], middle - 1 );
        r->end[i] = skip_to( s, r->end[i] > r->begin[i] ? r->end[i] : r->begin[i], middle + 2 );
    }
}

// List the pairs of a sphere in its lane. @param near [count] scratch @return how many there are
static int list_pairs( const sphere_list* loop, int sphere, const runs* r, int32_t* near )
{
    const contact_work* work = loop->work;
    contact_spheres* s = work->contact_mesh->spheres;
    const wisp_points_within_args args = {
        .x = s->middle[0],
        .y = s->middle[1],
        .z = s->middle[2],
        .at = { s->middle[0][sphere], s->middle[1][sphere], s->middle[2][sphere] },
        .radius = loop->radius,
    };
    const size_t lane = (size_t)sphere % CONTACT_SPHERE_PACK,
                 first = (size_t)( sphere / CONTACT_SPHERE_PACK ) * (size_t)s->capacity;
    int found = 0;
    for ( int i = 0; i < RUNS; ++i )
    {
        const int count =
            wisp_frame_kernels( work->frame )->find_points_within( &args, r->begin[i], r->end[i], near );
        for ( int n = 0; n < count; ++n )
        {
            const int other = near[n];
            const float gap = other != sphere ? gap_of( work, sphere, other ) : 0.0f;
            const float within = gap + s->motion[sphere][3] + s->motion[other][3];
            if ( gap > 0.0f && come_within( s, sphere, other, within ) )
            {
                const size_t at = ( first + (size_t)found ) * CONTACT_SPHERE_PACK + lane;
                if ( found < s->capacity )
                {
                    s->other_x4[at] = 4 * other;
                    s->gap[at] = gap;
                }
                found += 1;
            }
        }
    }
    return found;
}

static void list_packs( void* context, int begin, int end, int worker )
{
    sphere_list* loop = context;
    contact_spheres* s = loop->work->contact_mesh->spheres;
    int32_t* near = wisp_parallel_scratch( loop->work->parallel, worker, ( (size_t)s->count + 8 ) * sizeof( *near ) );
    if ( near == NULL )
    {
        atomic_store( &loop->is_out_of_memory, true );
        return;
    }
    runs r = { { 0 }, { 0 } };
    int64_t candidates = 0;
    int longest = 0;
    for ( int pack = begin; pack < end; ++pack )
    {
        int found[CONTACT_SPHERE_PACK], most = 0;
        for ( int lane = 0; lane < CONTACT_SPHERE_PACK; ++lane )
        {
            const int sphere = pack * CONTACT_SPHERE_PACK + lane;
            found[lane] = 0;
            if ( sphere < s->count )
            {
                if ( sphere == begin * CONTACT_SPHERE_PACK || s->cell[sphere] != s->cell[sphere - 1] )
                {
                    find_runs( s, sphere, &r );
                }
                found[lane] = list_pairs( loop, sphere, &r, near );
            }
            longest = found[lane] > longest ? found[lane] : longest;
            if ( found[lane] > s->capacity )
            {
                atomic_fetch_add( &loop->left_out, 1 );
            }
            found[lane] = found[lane] < s->capacity ? found[lane] : s->capacity;
            most = found[lane] > most ? found[lane] : most;
            candidates += found[lane];
        }
        s->rows[pack] = most;
        for ( int lane = 0; lane < CONTACT_SPHERE_PACK; ++lane )
        {
            for ( int row = found[lane]; row < most; ++row )
            {
                const size_t at =
                    ( (size_t)pack * (size_t)s->capacity + (size_t)row ) * CONTACT_SPHERE_PACK + (size_t)lane;
                s->other_x4[at] = 0;
                s->gap[at] = 0.0f;
            }
        }
    }
    atomic_fetch_add( &loop->candidates, candidates );
    int seen = atomic_load( &loop->longest );
    while ( seen < longest && atomic_compare_exchange_weak( &loop->longest, &seen, longest ) == false )
    {
    }
}

static wisp_status list_all( const contact_work* work, const grid* g, wisp_error* error )
{
    contact_spheres* s = work->contact_mesh->spheres;
    sphere_list loop = { .work = work, .radius = g->radius };
    atomic_init( &loop.longest, 0 );
    atomic_init( &loop.is_out_of_memory, false );
    for ( int capacity = s->capacity > LEAST_ROWS ? s->capacity : LEAST_ROWS;; )
    {
        atomic_init( &loop.left_out, 0 );
        atomic_init( &loop.candidates, 0 );
        if ( reserve_rows( work, capacity ) )
        {
            wisp_parallel_for( work->parallel, s->pack_count, LIST_PACKS, list_packs, &loop );
        }
        if ( s->capacity != capacity || atomic_load( &loop.is_out_of_memory ) || s->other_x4 == NULL )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the pairs of %d spheres", s->count );
        }
        const int longest = atomic_load( &loop.longest );
        if ( longest <= capacity || capacity == MOST_ROWS )
        {
            break;
        }
        for ( ; capacity < longest && capacity < MOST_ROWS; capacity *= 2 )
        {
        }
    }
    s->candidates = atomic_load( &loop.candidates );
    work->memory->stats.outran += atomic_load( &loop.left_out );
    return WISP_OK;
}

wisp_status contact_list_spheres( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* m = work->contact_mesh;
    contact_spheres* s = m->spheres;
    const wisp_status status = make_spheres( work, error );
    if ( status != WISP_OK || s->count == 0 )
    {
        return status;
    }
    s->substeps = work->substeps_left;
    m->broad_phase->searches += 1;
    s->done = 0;
    s->largest = 0.0f;
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        s->largest =
            contact_larger( s->largest, contact_larger( participant->settings.thickness, participant->cover ) );
    }
    find_common_motion( work );
    grid g;
    choose_cells( work, &g );
    for ( int i = 0; i < s->count; ++i )
    {
        s->cell[i] = cell_of( &g, s->now + (size_t)i * 4 );
        s->order[i] = i;
    }
    sort_by_cell( s, (uint32_t)g.count[0] * (uint32_t)g.count[1] * (uint32_t)g.count[2] );
    wisp_parallel_for( work->parallel, s->pack_count * CONTACT_SPHERE_PACK, GRID_GRAIN, fill_spheres,
                       (void*)(uintptr_t)work );
    share_points( work );
    return list_all( work, &g, error );
}
