// Displacements in a substep, and the predicted motion of clusters. In: intersection-free and current positions. Out:
// for each point its displacement and a tolerance, for each cluster the range of its displacements, its predicted
// motion and its deviation.
//
// - A point's tolerance is a quarter of its displacement relative to the mean, and a twentieth of the thickness.
//   Points that leave it are marked missed. Which pairs become constraints follows from this alone, so searches do
//   not change results.
// - A search assumes that each cluster goes on for five substeps as it does, within a margin. It holds as long as no
//   deviation exceeds its margin (as in a Verlet list).
#include "predicted_motion.h"

#include "clusters.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    CLUSTER_GRAIN = 256,
};

// Longer displacements are numerical failures, as NaN is.
static const float FARTHEST = 1e6f; // m
// Projections change the displacement that was predicted: tolerance as a fraction of it, and of the thickness. A
// missed point has a small tolerance around where it went, so that a cut of a rounding error does not mark it again.
static const float SPARE = 0.25f, SPARE_THICKNESS = 0.05f, SPARE_MISSED = 0.01f;
// Margin of a cluster, as a multiple of its deviation in one substep.
static const float MARGIN_SUBSTEPS = 4.0f;

typedef struct way_loop
{
    const contact_work* work;
    contact_contact_mesh* contact_mesh;
    double ( *sums )[3]; // [block]
    _Atomic bool has_fixed;
    float drifts;        // 1 while clusters are predicted to drift, else 0
    bool is_expected;    // predicted, else measured
    _Atomic int reached; // contact_reached
} way_loop;

bool contact_reserve_motion( const contact_work* work )
{
    contact_motion* m = work->contact_mesh->motion;
    const size_t points = (size_t)work->contact_mesh->point_count,
                 count = (size_t)work->contact_mesh->clusters->count;
    wisp_buffer* b = m->buffers;
    const bool enough = contact_reserve( work, b++, points * 4 * sizeof( float ), (void**)&m->ahead ) &&
                        contact_reserve( work, b++, points, (void**)&m->is_missed ) &&
                        contact_reserve( work, b++, count * sizeof( *m->ways ), (void**)&m->ways ) &&
                        contact_reserve( work, b++, count * sizeof( *m->gone ), (void**)&m->gone ) &&
                        contact_reserve( work, b++, count * sizeof( *m->predicted ), (void**)&m->predicted ) &&
                        contact_reserve( work, b++, count, (void**)&m->cluster_is_missed );
    if ( enough )
    {
        memset( m->predicted, 0, count * sizeof( *m->predicted ) );
        memset( m->gone, 0, count * sizeof( *m->gone ) );
    }
    return enough;
}

static void sum_displacements( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    const wisp_displacement_args args = { .before = loop->contact_mesh->intersection_free,
                                          .now = loop->contact_mesh->now };
    if ( wisp_frame_kernels( loop->work->frame )
             ->sum_displacements( &args, begin, end, loop->sums[begin / CONTACT_POINT_GRAIN] ) )
    {
        atomic_store( &loop->has_fixed, true );
    }
}

// Return whether a body touches a point. Where displacements are cut, points go on with the common one, which must not carry them
// into a body.
static bool touches_body( const contact_work* work )
{
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        for ( int i = 0; i < participant->point_count && participant->half_spaces != NULL; ++i )
        {
            if ( participant->half_spaces[i] > 0 )
            {
                return true;
            }
        }
    }
    return false;
}

static void find_common( way_loop* loop )
{
    const contact_work* work = loop->work;
    contact_contact_mesh* s = work->contact_mesh;
    const int blocks = ( s->point_count + CONTACT_POINT_GRAIN - 1 ) / CONTACT_POINT_GRAIN;
    memset( s->motion->common, 0, sizeof( s->motion->common ) );
    loop->sums = wisp_parallel_scratch( work->parallel, work->worker, (size_t)blocks * sizeof( *loop->sums ) );
    if ( loop->sums == NULL )
    {
        return; // a mean of 0 is valid too and only costs time
    }
    atomic_init( &loop->has_fixed, touches_body( work ) );
    wisp_parallel_for( work->parallel, s->point_count, CONTACT_POINT_GRAIN, sum_displacements, loop );
    for ( int k = 0; k < 3 && atomic_load( &loop->has_fixed ) == false; ++k )
    {
        double sum = 0.0;
        for ( int b = 0; b < blocks; ++b )
        {
            sum += loop->sums[b][k];
        }
        s->motion->common[k] = (float)( sum / ( s->point_count > 0 ? s->point_count : 1 ) );
    }
}

static void raise_to( _Atomic int* reached, int value )
{
    int seen = atomic_load_explicit( reached, memory_order_relaxed );
    while ( seen < value && atomic_compare_exchange_weak( reached, &seen, value ) == false )
    {
    }
}

static float length_of( float x, float y, float z )
{
    const float length = sqrtf( x * x + y * y + z * z );
    return length < FARTHEST ? length : 0.0f;
}

static void measure_way( contact_contact_mesh* s, int point )
{
    float* ahead = s->motion->ahead + (size_t)point * 4;
    const float *now = s->now + (size_t)point * 4, *intersection_free = s->intersection_free + (size_t)point * 4;
    const float way[3] = { now[0] - intersection_free[0], now[1] - intersection_free[1],
                           now[2] - intersection_free[2] };
    const bool is_missed = length_of( way[0] - ahead[0], way[1] - ahead[1], way[2] - ahead[2] ) > ahead[3];
    if ( is_missed )
    {
        memcpy( ahead, way, sizeof( way ) );
        ahead[3] = SPARE_MISSED * s->min_thickness;
        s->motion->is_missed[point] = 1;
    }
}

// Predict displacements and tolerances, or measure which points left theirs.
static void find_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    contact_contact_mesh* s = loop->contact_mesh;
    const wisp_kernels* kernels = wisp_frame_kernels( loop->work->frame );
    const wisp_displacement_args args = {
        .before = s->intersection_free,
        .now = s->now,
        .common_displacement = { s->motion->common[0], s->motion->common[1], s->motion->common[2] },
        .relative_margin = SPARE,
        .margin = SPARE_THICKNESS * s->min_thickness,
        .displacement = s->motion->ahead,
    };
    if ( loop->is_expected )
    {
        kernels->measure_displacements( &args, begin, end );
        memset( s->motion->is_missed + begin, 0, (size_t)( end - begin ) );
        return;
    }
    const bool is_missed = kernels->exceeds_prediction( &args, begin, end );
    for ( int p = begin; p < end && is_missed; ++p )
    {
        measure_way( s, p );
    }
    if ( is_missed )
    {
        raise_to( &loop->reached, CONTACT_ELSEWHERE );
    }
}

// ---- displacements of clusters ----

// @param spare m, tolerance of all points
static contact_way middle_of( const float lower[4], const float upper[4], float spare )
{
    contact_way way;
    float squared = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        const float wide = upper[k] - lower[k];
        way.middle[k] = 0.5f * ( lower[k] + upper[k] );
        squared += wide * wide;
    }
    way.spread = 0.50001f * sqrtf( squared ) + spare;
    return way;
}

static contact_way expected_way_of( const contact_work* work, const contact_cluster* cluster )
{
    const contact_contact_mesh* s = work->contact_mesh;
    float lower[4], upper[4];
    wisp_frame_kernels( work->frame )
        ->xyzw_range( s->motion->ahead, NULL, s->clusters->points + cluster->first_point, cluster->point_count, lower,
                      upper );
    return middle_of( lower, upper, contact_larger( upper[3], 0.0f ) );
}

static contact_way gone_way_of( const contact_work* work, const contact_cluster* cluster )
{
    const contact_contact_mesh* s = work->contact_mesh;
    float lower[4], upper[4];
    wisp_frame_kernels( work->frame )
        ->xyzw_range( s->now, s->intersection_free, s->clusters->points + cluster->first_point, cluster->point_count,
                      lower, upper );
    return middle_of( lower, upper, 0.0f );
}

float contact_length_of_way( const contact_contact_mesh* s, const contact_way* way )
{
    const float *m = way->middle, *c = s->motion->common;
    return length_of( m[0] - c[0], m[1] - c[1], m[2] - c[2] ) + way->spread;
}

static bool exceeds_margin( const contact_contact_mesh* s, int cluster )
{
    const contact_predicted_motion* predicted = s->motion->predicted + cluster;
    return predicted->deviation + contact_length_of_way( s, s->motion->ways + cluster ) > predicted->margin;
}

static void expect_cluster_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    way_loop* loop = context;
    contact_contact_mesh* s = loop->contact_mesh;
    bool is_beyond = false;
    memset( s->motion->cluster_is_missed + begin, 0, (size_t)( end - begin ) );
    for ( int p = begin; p < end; ++p )
    {
        s->motion->ways[p] = expected_way_of( loop->work, s->clusters->items + p );
        is_beyond = exceeds_margin( s, p ) || is_beyond;
    }
    if ( is_beyond )
    {
        raise_to( &loop->reached, CONTACT_BEYOND );
    }
}

// Update the clusters of missed points. Margins are tested for all clusters, because the mean displacement changed.
static void find_missed_clusters( way_loop* loop )
{
    contact_contact_mesh* s = loop->contact_mesh;
    bool is_beyond = false;
    for ( int point = 0; point < s->point_count; ++point )
    {
        for ( int i = s->clusters->owners_begin[point];
              s->motion->is_missed[point] != 0 && i < s->clusters->owners_begin[point + 1]; ++i )
        {
            s->motion->cluster_is_missed[s->clusters->owners[i]] = 1;
        }
    }
    for ( int p = 0; p < s->clusters->count; ++p )
    {
        if ( s->motion->cluster_is_missed[p] != 0 )
        {
            s->motion->ways[p] = expected_way_of( loop->work, s->clusters->items + p );
        }
        is_beyond = exceeds_margin( s, p ) || is_beyond;
    }
    if ( is_beyond )
    {
        raise_to( &loop->reached, CONTACT_BEYOND );
    }
}

static contact_reached measure_displacements( const contact_work* work, bool is_expected )
{
    contact_contact_mesh* s = work->contact_mesh;
    way_loop loop = { .work = work, .contact_mesh = s, .is_expected = is_expected };
    atomic_init( &loop.reached, CONTACT_WITHIN );
    find_common( &loop );
    wisp_parallel_for( work->parallel, s->point_count, CONTACT_POINT_GRAIN, find_ways, &loop );
    if ( is_expected )
    {
        wisp_parallel_for( work->parallel, s->clusters->count, CLUSTER_GRAIN, expect_cluster_ways, &loop );
    }
    else if ( atomic_load( &loop.reached ) != CONTACT_WITHIN )
    {
        find_missed_clusters( &loop );
    }
    return (contact_reached)atomic_load( &loop.reached );
}

contact_reached contact_expect_ways( const contact_work* work )
{
    work->contact_mesh->motion->reach = INFINITY;
    return measure_displacements( work, true );
}

static void shorten_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const way_loop* loop = context;
    const contact_motion* m = loop->contact_mesh->motion;
    for ( int i = begin; i < end; ++i )
    {
        float *ahead = m->ahead + (size_t)i * 4, way[3];
        for ( int k = 0; k < 3; ++k )
        {
            way[k] = ahead[k] - m->common[k];
        }
        const float length = sqrtf( way[0] * way[0] + way[1] * way[1] + way[2] * way[2] );
        const float most = SPARE * m->reach + SPARE_THICKNESS * loop->contact_mesh->min_thickness;
        for ( int k = 0; k < 3 && length > m->reach && loop->contact_mesh->now[(size_t)i * 4 + 3] > 0.0f; ++k )
        {
            ahead[k] = m->common[k] + way[k] * ( m->reach / length );
            ahead[3] = contact_smaller( ahead[3], most );
        }
    }
}

void contact_shorten_ways( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    way_loop loop = { .work = work, .contact_mesh = s };
    atomic_init( &loop.reached, CONTACT_WITHIN );
    wisp_parallel_for( work->parallel, s->point_count, CONTACT_POINT_GRAIN, shorten_ways, &loop );
    wisp_parallel_for( work->parallel, s->clusters->count, CLUSTER_GRAIN, expect_cluster_ways, &loop );
}

contact_reached contact_measure_ways( const contact_work* work )
{
    return measure_displacements( work, false );
}

// ---- predicted motion ----

// Return the margin of a cluster with such displacements.
static float margin_for( const contact_work* work, const contact_way* way )
{
    const float margin = work->settings->margin * work->contact_mesh->min_thickness;
    const float length = contact_length_of_way( work->contact_mesh, way );
    return length + contact_larger( margin, MARGIN_SUBSTEPS * way->spread );
}

static void predict_clusters( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    const contact_contact_mesh* s = work->contact_mesh;
    for ( int p = begin; p < end; ++p )
    {
        const contact_way* way = s->motion->ways + p;
        contact_predicted_motion* predicted = s->motion->predicted + p;
        for ( int k = 0; k < 3; ++k )
        {
            predicted->displacement[k] = way->middle[k] - s->motion->common[k];
        }
        predicted->margin = margin_for( work, way );
        predicted->deviation = 0.0f;
    }
}

void contact_predict_motion( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    s->motion->substeps = 0;
    wisp_parallel_for( work->parallel, s->clusters->count, CLUSTER_GRAIN, predict_clusters, (void*)(uintptr_t)work );
}

static void add_deviation( void* context, int begin, int end, int worker )
{
    (void)worker;
    const way_loop* loop = context;
    contact_contact_mesh* s = loop->contact_mesh;
    for ( int p = begin; p < end; ++p )
    {
        contact_predicted_motion* predicted = s->motion->predicted + p;
        s->motion->gone[p] = gone_way_of( loop->work, s->clusters->items + p );
        contact_way deviation = s->motion->gone[p];
        for ( int k = 0; k < 3; ++k )
        {
            deviation.middle[k] -= loop->drifts * predicted->displacement[k];
        }
        predicted->deviation += contact_length_of_way( s, &deviation );
    }
}

void contact_add_deviation( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    way_loop loop = { .work = work, .contact_mesh = s };
    loop.drifts = s->motion->substeps < CONTACT_SUBSTEPS_AHEAD ? 1.0f : 0.0f;
    wisp_parallel_for( work->parallel, s->clusters->count, CLUSTER_GRAIN, add_deviation, &loop );
    s->motion->substeps += 1;
}
