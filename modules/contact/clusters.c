// Clusters: the contact mesh cut into groups of eight triangles (of eight segments of a strand), so that culling and
// bounds work on pairs of clusters. In: rest positions. Out: packs of eight primitives, lists of points, owners of
// each point. Triangles are cut by recursive bisection at the median of the widest axis, as in a bounding volume
// hierarchy; meshoptimizer calls such groups clusters.
#include "clusters.h"

#include <string.h>

enum
{
    CLUSTER_PRIMITIVES = 8, // triangles, or segments, or points without either
    CLUSTER_POINTS = 3 * CLUSTER_PRIMITIVES,
};

// What the loops of this file share.
typedef struct cutting
{
    const contact_work* work;
    contact_contact_mesh* contact_mesh;
    int32_t* cluster_of[3]; // [point], [edge], [triangle]; -1: none yet
    int32_t* order;         // [triangle] those of a cluster are contiguous
    float ( *middle )[3];   // [triangle] three times its centre, at rest
    int cluster_count;
} cutting;

static const int32_t* points_of( const contact_contact_mesh* s, int kind, const int32_t* primitive )
{
    return kind == 0   ? primitive
           : kind == 1 ? s->edges + 2 * (size_t)*primitive
                       : s->triangles + 3 * (size_t)*primitive;
}

// ---- triangles ----

static int widest_axis( const cutting* c, int begin, int end )
{
    float width[3];
    for ( int k = 0; k < 3; ++k )
    {
        float lower = INFINITY, upper = -INFINITY;
        for ( int i = begin; i < end; ++i )
        {
            lower = contact_smaller( lower, c->middle[c->order[i]][k] );
            upper = contact_larger( upper, c->middle[c->order[i]][k] );
        }
        width[k] = upper - lower;
    }
    const int first = width[1] > width[0] ? 1 : 0;
    return width[2] > width[first] ? 2 : first;
}

// Compare centres along an axis. Equal ones go by index, so that the cut is unique.
static bool is_before( const cutting* c, int axis, int32_t a, int32_t b )
{
    const float p = c->middle[a][axis], q = c->middle[b][axis];
    return p < q || ( p == q && a < b );
}

// Partition a range so that the smaller triangles come first, in any order (quickselect, Hoare 1961).
static void partition( const cutting* c, int axis, int begin, int middle, int end )
{
    int32_t* order = c->order;
    while ( end - begin > 1 )
    {
        const int32_t pivot = order[begin + ( end - begin ) / 2];
        int i = begin, k = end - 1;
        while ( i <= k )
        {
            for ( ; is_before( c, axis, order[i], pivot ); ++i )
            {
            }
            for ( ; is_before( c, axis, pivot, order[k] ); --k )
            {
            }
            if ( i <= k )
            {
                const int32_t moved = order[i];
                order[i++] = order[k];
                order[k--] = moved;
            }
        }
        if ( middle > k && middle < i )
        {
            return;
        }
        begin = middle >= i ? i : begin;
        end = middle >= i ? end : k + 1;
    }
}

// Bisect at a whole number of clusters, so that all but one are full.
static void cut_triangles( cutting* c, int begin, int end )
{
    const int count = end - begin;
    if ( count <= CLUSTER_PRIMITIVES )
    {
        for ( int i = begin; i < end; ++i )
        {
            c->cluster_of[2][c->order[i]] = c->cluster_count;
        }
        c->cluster_count += 1;
        return;
    }
    const int clusters = ( count + CLUSTER_PRIMITIVES - 1 ) / CLUSTER_PRIMITIVES,
              middle = begin + clusters / 2 * CLUSTER_PRIMITIVES;
    partition( c, widest_axis( c, begin, end ), begin, middle, end );
    cut_triangles( c, begin, middle );
    cut_triangles( c, middle, end );
}

static void order_triangles( cutting* c, const contact_participant* participant )
{
    const contact_contact_mesh* s = c->contact_mesh;
    for ( int t = participant->first_triangle; t < participant->first_triangle + participant->triangle_count; ++t )
    {
        c->order[t] = t;
        for ( size_t k = 0; k < 3; ++k )
        {
            c->middle[t][k] = 0.0f;
            for ( size_t i = 0; i < 3; ++i )
            {
                c->middle[t][k] += s->rest[(size_t)s->triangles[3 * (size_t)t + i] * 4 + k];
            }
        }
    }
}

// ---- points and edges ----

// Assign points and edges to the first triangle that has them, and to its cluster.
static void assign_corners( cutting* c, const contact_participant* participant )
{
    const contact_contact_mesh* s = c->contact_mesh;
    uint8_t *owns = s->clusters->triangle_owns, *edge_owns = s->clusters->edge_owns;
    for ( int t = participant->first_triangle; t < participant->first_triangle + participant->triangle_count; ++t )
    {
        const int32_t* corner = s->triangles + 3 * (size_t)t;
        for ( int i = 0; i < 3; ++i )
        {
            const int a = corner[i], b = corner[( i + 1 ) % 3];
            const int edge = contact_find_edge( s, participant, a < b ? a : b, a < b ? b : a );
            const int corner_bit = c->cluster_of[0][a] < 0 ? 1 : 0, edge_bit = c->cluster_of[1][edge] < 0 ? 1 : 0;
            owns[t] |= (uint8_t)( corner_bit << ( 3 + i ) | edge_bit << ( i + 2 ) % 3 );
            edge_owns[edge] |= (uint8_t)( CONTACT_HAS_TRIANGLE | corner_bit << ( a < b ? 0 : 1 ) );
            c->cluster_of[0][a] = c->cluster_of[0][a] < 0 ? c->cluster_of[2][t] : c->cluster_of[0][a];
            c->cluster_of[1][edge] = c->cluster_of[1][edge] < 0 ? c->cluster_of[2][t] : c->cluster_of[1][edge];
        }
    }
}

// Cut edges without a triangle into runs of connected segments, and collect the points that are left.
static void cut_strands( cutting* c, const contact_participant* participant )
{
    const contact_contact_mesh* s = c->contact_mesh;
    int taken = CLUSTER_PRIMITIVES, last = -1;
    for ( int e = participant->first_edge; e < participant->first_edge + participant->edge_count; ++e )
    {
        const int32_t* points = s->edges + 2 * (size_t)e;
        if ( c->cluster_of[1][e] >= 0 )
        {
            continue;
        }
        const bool goes_on = taken < CLUSTER_PRIMITIVES && points[0] == last;
        taken = goes_on ? taken + 1 : 1;
        c->cluster_count += goes_on ? 0 : 1;
        c->cluster_of[1][e] = c->cluster_count - 1;
        for ( int i = 0; i < 2; ++i )
        {
            int32_t* of = c->cluster_of[0] + points[i];
            s->clusters->edge_owns[e] |= (uint8_t)( *of < 0 ? 1 << i : 0 );
            *of = *of < 0 ? c->cluster_count - 1 : *of;
        }
        last = points[1];
    }
    taken = CLUSTER_PRIMITIVES;
    for ( int p = participant->first_point; p < participant->first_point + participant->point_count; ++p )
    {
        if ( c->cluster_of[0][p] < 0 )
        {
            taken = taken < CLUSTER_PRIMITIVES ? taken + 1 : 1;
            c->cluster_count += taken == 1 ? 1 : 0;
            c->cluster_of[0][p] = c->cluster_count - 1;
        }
    }
}

// ---- packs and lists ----

// Count the primitives of each cluster, first one by one, then as packs of eight. @return the number of their rows
static int count_rows( const cutting* c, const int counts[3] )
{
    contact_contact_mesh* s = c->contact_mesh;
    contact_clusters* k = s->clusters;
    int rows = 0;
    memset( k->items, 0, (size_t)k->count * sizeof( *k->items ) );
    for ( int kind = 0; kind < 3; ++kind )
    {
        for ( int i = 0; i < counts[kind]; ++i )
        {
            contact_cluster* cluster = k->items + c->cluster_of[kind][i];
            cluster->rows[kind] += 1;
            cluster->participant = (int32_t)s->rest[(size_t)points_of( s, kind, &i )[0] * 4 + 3];
        }
    }
    for ( int p = 0; p < k->count; ++p )
    {
        contact_cluster* cluster = k->items + p;
        for ( int kind = 0; kind < 3; ++kind )
        {
            cluster->kind_row[kind] = rows;
            cluster->rows[kind] = ( cluster->rows[kind] + WISP_SLICE - 1 ) / WISP_SLICE;
            rows += contact_pack_rows( kind ) * cluster->rows[kind];
        }
    }
    return rows;
}

static void add_primitive( contact_contact_mesh* s, const contact_cluster* cluster, int kind, int32_t primitive )
{
    int32_t( *row )[WISP_SLICE] = s->clusters->packs + cluster->kind_row[kind];
    const int32_t* points = points_of( s, kind, &primitive );
    int lane = 0;
    while ( row[0][lane] >= 0 )
    {
        row += lane == WISP_SLICE - 1 ? contact_pack_rows( kind ) : 0;
        lane = ( lane + 1 ) % WISP_SLICE;
    }
    row[0][lane] = primitive;
    for ( int k = 0; k <= kind && kind > 0; ++k )
    {
        row[1 + k][lane] = 4 * points[k];
        for ( int other = 1; other < WISP_SLICE && lane == 0; ++other )
        {
            row[1 + k][other] = 0; // while it is empty
        }
    }
}

// List the points of a cluster, padded to a multiple of eight. @return how many
static int list_points( const contact_contact_mesh* s, const contact_cluster* cluster, int32_t* point_x4 )
{
    int count = 0;
    for ( int kind = 0; kind < 3; ++kind )
    {
        const int corners = kind + 1;
        for ( int i = 0; i < corners * WISP_SLICE * cluster->rows[kind]; ++i )
        {
            const int32_t* item =
                s->clusters
                    ->packs[cluster->kind_row[kind] + i / ( corners * WISP_SLICE ) * contact_pack_rows( kind )] +
                i % WISP_SLICE;
            const int32_t point = *item < 0 ? -1 : 4 * points_of( s, kind, item )[i / WISP_SLICE % corners];
            int at = 0;
            for ( ; at < count && point_x4[at] != point; ++at )
            {
            }
            if ( at == count && point >= 0 )
            {
                point_x4[count++] = point;
            }
        }
    }
    for ( ; count % WISP_SLICE != 0; ++count )
    {
        point_x4[count] = point_x4[count - 1];
    }
    return count;
}

// List the clusters of each point.
static bool list_owners( const cutting* c )
{
    contact_contact_mesh* s = c->contact_mesh;
    contact_clusters* k = s->clusters;
    const size_t points = (size_t)s->point_count, number = sizeof( int32_t );
    bool enough = contact_reserve( c->work, k->buffers + CONTACT_CLUSTER_OWNERS_BEGIN, ( points + 2 ) * number,
                                   (void**)&k->owners_begin );
    if ( enough == false )
    {
        return false;
    }
    // a counting sort: counts go two places ahead, so that filling leaves each start in place
    int32_t* begin = k->owners_begin;
    memset( begin, 0, ( points + 2 ) * number );
    for ( int pass = 0; pass < 2 && enough; ++pass )
    {
        for ( int p = 0; p < k->count; ++p )
        {
            const int32_t* point_x4 = k->points + k->items[p].first_point;
            for ( int i = 0; i < k->items[p].point_count && ( i == 0 || point_x4[i] != point_x4[i - 1] ); ++i )
            {
                if ( pass == 0 )
                {
                    begin[point_x4[i] / 4 + 2] += 1;
                }
                else
                {
                    k->owners[begin[point_x4[i] / 4 + 1]++] = p;
                }
            }
        }
        for ( size_t i = 0; i < points && pass == 0; ++i )
        {
            begin[i + 2] += begin[i + 1];
        }
        enough = pass > 0 || contact_reserve( c->work, k->buffers + CONTACT_CLUSTER_OWNERS,
                                              (size_t)begin[points + 1] * number, (void**)&k->owners );
    }
    return enough;
}

static bool fill_clusters( const cutting* c, const int counts[3] )
{
    contact_contact_mesh* s = c->contact_mesh;
    contact_clusters* k = s->clusters;
    k->count = c->cluster_count;
    if ( contact_reserve( c->work, k->buffers + CONTACT_CLUSTER_ITEMS, (size_t)k->count * sizeof( *k->items ),
                          (void**)&k->items ) == false )
    {
        return false;
    }
    const size_t rows = (size_t)count_rows( c, counts );
    if ( contact_reserve( c->work, k->buffers + CONTACT_CLUSTER_PACKS, rows * sizeof( *k->packs ),
                          (void**)&k->packs ) == false ||
         contact_reserve( c->work, k->buffers + CONTACT_CLUSTER_POINTS,
                          (size_t)k->count * CLUSTER_POINTS * sizeof( int32_t ), (void**)&k->points ) == false )
    {
        return false;
    }
    memset( k->packs, -1, rows * sizeof( *k->packs ) );
    for ( int kind = 0; kind < 3; ++kind )
    {
        for ( int i = 0; i < counts[kind]; ++i )
        {
            add_primitive( s, k->items + c->cluster_of[kind][i], kind, i );
        }
    }
    for ( int p = 0; p < k->count; ++p )
    {
        k->items[p].first_point = CLUSTER_POINTS * p;
        k->items[p].point_count = list_points( s, k->items + p, k->points + CLUSTER_POINTS * (size_t)p );
    }
    return list_owners( c );
}

bool contact_make_clusters( const contact_work* work )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_clusters* k = s->clusters;
    const int counts[3] = { s->point_count, s->edge_count, s->triangle_count };
    const size_t triangles = (size_t)counts[2], numbers = (size_t)counts[1] + 2 * triangles + 1;
    cutting c = { .work = work, .contact_mesh = s };
    int32_t* scratch = wisp_parallel_scratch( work->parallel, work->worker,
                                              numbers * sizeof( int32_t ) + triangles * sizeof( *c.middle ) );
    wisp_buffer* b = k->buffers;
    if ( scratch == NULL ||
         contact_reserve( work, b + CONTACT_CLUSTER_OF_POINT, (size_t)counts[0] * sizeof( int32_t ),
                          (void**)&k->of_point ) == false ||
         contact_reserve( work, b + CONTACT_CLUSTER_EDGE_OWNS, (size_t)counts[1], (void**)&k->edge_owns ) == false ||
         contact_reserve( work, b + CONTACT_CLUSTER_TRIANGLE_OWNS, triangles, (void**)&k->triangle_owns ) == false )
    {
        return false;
    }
    memset( k->edge_owns, 0, (size_t)counts[1] );
    memset( k->triangle_owns, 0, triangles );
    c.cluster_of[0] = k->of_point;
    c.cluster_of[1] = scratch;
    c.cluster_of[2] = scratch + counts[1];
    c.order = c.cluster_of[2] + triangles;
    c.middle = ( float( * )[3] )(void*)( c.order + triangles );
    memset( k->of_point, -1, (size_t)counts[0] * sizeof( int32_t ) );
    memset( scratch, -1, numbers * sizeof( int32_t ) );
    for ( int g = 0; g < work->participant_count; ++g )
    {
        const contact_participant* participant = work->participants + g;
        order_triangles( &c, participant );
        if ( participant->triangle_count > 0 )
        {
            cut_triangles( &c, participant->first_triangle,
                           participant->first_triangle + participant->triangle_count );
        }
        assign_corners( &c, participant );
        cut_strands( &c, participant );
    }
    return fill_clusters( &c, counts );
}

// ---- culling geometry ----

wisp_aabb contact_box_around( const contact_work* work, const contact_cluster* cluster )
{
    const contact_contact_mesh* s = work->contact_mesh;
    float lower[4], upper[4];
    wisp_aabb box;
    wisp_frame_kernels( work->frame )
        ->xyzw_range( s->intersection_free, NULL, s->clusters->points + cluster->first_point, cluster->point_count,
                      lower, upper );
    memcpy( box.lower, lower, sizeof( box.lower ) );
    memcpy( box.upper, upper, sizeof( box.upper ) );
    return box;
}

// Sum the normals of the triangles of a cluster; zero without any.
static void sum_normals( const contact_cluster* cluster, contact_placed* placed )
{
    const wisp_primitive_pack* row = contact_packs_of( placed, cluster, 2 );
    memset( placed->normal, 0, sizeof( placed->normal ) );
    for ( int lane = 0; lane < WISP_SLICE && cluster->rows[2] > 0 && row->item[lane] >= 0; ++lane )
    {
        for ( int k = 0; k < 3; ++k )
        {
            placed->normal[k] += row->normal[k][lane];
        }
    }
}

// Copy the rows of a pack. An empty lane has the first point.
static void copy_pack( int32_t ( *row )[WISP_SLICE], int kind, wisp_primitive_pack* to )
{
    memcpy( to->item, row[0], sizeof( to->item ) );
    for ( int lane = 0; lane < WISP_SLICE && kind == 0; ++lane )
    {
        to->point_x4[0][lane] = row[0][lane] > 0 ? 4 * row[0][lane] : 0;
    }
    if ( kind > 0 )
    {
        memcpy( to->point_x4, row[1], sizeof( to->point_x4 ) );
    }
    if ( kind > 1 )
    {
        memcpy( to->third_x4, row[3], sizeof( to->third_x4 ) );
    }
}

void contact_place_cluster( const contact_work* work, int cluster, contact_placed* to )
{
    const contact_clusters* c = work->contact_mesh->clusters;
    const contact_cluster* from = c->items + cluster;
    const wisp_kernels* kernels = wisp_frame_kernels( work->frame );
    to->box = contact_box_around( work, from );
    for ( int kind = 0, first = 0; kind < 3; first += from->rows[kind++] )
    {
        for ( int i = 0; i < from->rows[kind]; ++i )
        {
            copy_pack( c->packs + from->kind_row[kind] + contact_pack_rows( kind ) * i, kind, to->packs + first + i );
        }
        kernels->place_primitives( work->contact_mesh->intersection_free, to->packs, kind + 1, first,
                                   first + from->rows[kind] );
    }
    sum_normals( from, to );
}

bool contact_clusters_may_meet( const contact_work* work, int a, int b )
{
    const contact_cluster* clusters = work->contact_mesh->clusters->items;
    return contact_may_meet( work->participants + clusters[a].participant,
                             work->participants + clusters[b].participant );
}
