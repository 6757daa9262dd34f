// Triangle meshes for queries: surface, search and results.
#include "collision_mesh_embree.h"
#include "mesh_bvh.h"
#include "mesh_surface.h"

#include "alloc.h"

#include "wisp/module/definition.h"
#include "wisp/module/vec.h"

struct wisp_collision_mesh
{
    mesh_surface surface;
    embree_tree* embree;    ///< of a rigid mesh, null without Embree
    mesh_bvh bvh;           ///< of a mesh that deforms, and of any without Embree; else zero
    mesh_cells cells;       ///< known to be outside
    mesh_features features; ///< zero until they are prepared
    bool deforms;
    int open_edge_count, flat_triangle_count;
};

// ---- creation ----

static bool has_bvh( const wisp_collision_mesh* tree )
{
    return tree->bvh.surface != NULL;
}

wisp_status wisp_collision_mesh_create( const wisp_collision_mesh_def* def, const wisp_allocator* allocator,
                                        wisp_collision_mesh** out, wisp_error* error )
{
    *out = NULL;
    mesh_surface surface = { 0 };
    WISP_TRY( mesh_surface_build( &surface, def, allocator, error ) );
    wisp_collision_mesh* tree = base_allocate( &surface.allocator, sizeof( *tree ), BASE_BUFFER_ALIGNMENT );
    if ( tree == NULL )
    {
        mesh_surface_release( &surface );
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a mesh collider" );
    }
    *tree = ( wisp_collision_mesh ){ .surface = surface, .deforms = def->deforms };
    wisp_status status = def->deforms || embree_tree_exists() == false
                             ? mesh_bvh_build( &tree->bvh, &tree->surface, error )
                             : embree_tree_create( &tree->surface, def, &tree->embree, error );
    status = status == WISP_OK ? mesh_cells_create( &tree->cells, &tree->surface, error ) : status;
    if ( status != WISP_OK )
    {
        wisp_collision_mesh_release( tree );
        return status;
    }
    tree->open_edge_count = mesh_surface_count_open_edges( &tree->surface );
    tree->flat_triangle_count = mesh_surface_count_flat_triangles( &tree->surface );
    *out = tree;
    return WISP_OK;
}

void wisp_collision_mesh_release( wisp_collision_mesh* tree )
{
    if ( tree == NULL )
    {
        return;
    }
    wisp_allocator allocator = tree->surface.allocator;
    embree_tree_release( tree->embree );
    mesh_bvh_release( &tree->bvh );
    mesh_cells_release( &tree->cells, &tree->surface );
    mesh_features_release( &tree->features, &tree->surface );
    mesh_surface_release( &tree->surface );
    base_release( &allocator, tree, sizeof( *tree ) );
}

size_t wisp_collision_mesh_bytes( const wisp_collision_mesh* tree )
{
    return sizeof( *tree ) + tree->surface.bytes + mesh_features_bytes( &tree->features, &tree->surface ) +
           mesh_cells_bytes( &tree->cells ) +
           ( has_bvh( tree ) ? mesh_bvh_bytes( &tree->bvh ) : embree_tree_bytes( tree->embree ) );
}

size_t wisp_collision_mesh_outside_bytes( const wisp_collision_mesh* tree )
{
    return tree->embree != NULL ? embree_tree_outside_bytes( tree->embree ) : 0;
}

wisp_collision_mesh_stats wisp_collision_mesh_get_stats( const wisp_collision_mesh* tree )
{
    return ( wisp_collision_mesh_stats ){ .open_edge_count = tree->open_edge_count,
                                          .flat_triangle_count = tree->flat_triangle_count,
                                          .triangle_count = tree->surface.triangle_count,
                                          .refit_count = tree->bvh.refit_count };
}

// ---- updates ----

wisp_status wisp_collision_mesh_update( wisp_collision_mesh* tree, const wisp_vec3* start, const wisp_vec3* end,
                                        const wisp_parallel* parallel, wisp_error* error )
{
    if ( !tree->deforms )
    {
        return wisp_fail( error, WISP_CONFLICT, "mesh collider: is rigid, so its points cannot move" );
    }
    WISP_TRY( mesh_surface_check_points( end, tree->surface.point_count, error ) );
    if ( start != NULL )
    {
        WISP_TRY( mesh_surface_check_points( start, tree->surface.point_count, error ) );
    }
    mesh_surface_set_points( &tree->surface, start != NULL ? start : end, end );
    mesh_bvh_refit( &tree->bvh, parallel );
    mesh_cells_empty( &tree->cells );
    return WISP_OK;
}

void wisp_collision_mesh_fill_cells( wisp_collision_mesh* tree, const wisp_parallel* parallel )
{
    mesh_cells_fill( &tree->cells, &tree->surface, parallel );
}

wisp_mesh_place wisp_collision_mesh_place( const wisp_collision_mesh* tree, int32_t triangle, const float weights[3],
                                           float time )
{
    const triangle_corners t = mesh_surface_triangle( &tree->surface, triangle, (double)time );
    double3 point = { 0.0, 0.0, 0.0 };
    for ( int k = 0; k < 3; ++k )
    {
        point = double3_mul_add( point, (double)weights[k], t.at[k] );
    }
    return ( wisp_mesh_place ){ double3_narrow( point ),
                                double3_narrow( double3_unit_or_zero( triangle_normal( &t ) ) ) };
}

wisp_vec3 wisp_collision_mesh_motion( const wisp_collision_mesh* tree, int32_t triangle, const float weights[3],
                                      float begin, float end )
{
    const mesh_surface* s = &tree->surface;
    float displacement[3] = { 0.0f, 0.0f, 0.0f };
    for ( int corner = 0; corner < 3 && s->start != NULL; ++corner )
    {
        const size_t quad = 4 * (size_t)s->triangles[3 * (size_t)triangle + (size_t)corner];
        for ( size_t k = 0; k < 3; ++k )
        {
            displacement[k] += weights[corner] * ( s->xyzw[quad + k] - s->start[quad + k] );
        }
    }
    const float fraction = end - begin;
    return ( wisp_vec3 ){ fraction * displacement[0], fraction * displacement[1], fraction * displacement[2] };
}

// ---- edges and corners ----

wisp_status wisp_collision_mesh_prepare_features( wisp_collision_mesh* tree, wisp_error* error )
{
    return tree->features.candidates != NULL
               ? WISP_OK
               : mesh_features_build( &tree->features, &tree->surface, has_bvh( tree ) == false, error );
}

int wisp_collision_mesh_find_features( const wisp_collision_mesh* tree, const float lower[3], const float upper[3],
                                       bool corners, int32_t* features, int capacity )
{
    const mesh_bvh* boxes = has_bvh( tree ) ? &tree->bvh : &tree->features.boxes;
    return tree->features.candidates == NULL
               ? 0
               : mesh_features_find( &tree->features, boxes, lower, upper, corners, features, capacity );
}

wisp_mesh_feature wisp_collision_mesh_feature( const wisp_collision_mesh* tree, int32_t feature, bool is_corner,
                                               float begin, float end )
{
    return mesh_features_place( &tree->surface, feature, is_corner, begin, end );
}

wisp_mesh_sides wisp_collision_mesh_sides( const wisp_collision_mesh* tree, int32_t feature, bool is_corner,
                                           float time )
{
    return mesh_features_sides( &tree->surface, feature, is_corner, (double)time );
}

// ---- queries ----

static bool is_reachable( wisp_vec3 p )
{
    const float r = WISP_COLLISION_MESH_REACH; // false for NaN
    return fabsf( p.x ) <= r && fabsf( p.y ) <= r && fabsf( p.z ) <= r;
}

static void add_work( wisp_collision_mesh_query_stats* sum, const wisp_collision_mesh_query_stats* work )
{
    if ( sum != NULL )
    {
        sum->queried += work->queried;
        sum->answered += work->answered;
        sum->refused += work->refused;
        sum->tested += work->tested;
    }
}

static void search_closest( const wisp_collision_mesh* tree, mesh_closest* search )
{
    if ( has_bvh( tree ) )
    {
        mesh_bvh_find_closest( &tree->bvh, search );
    }
    else
    {
        embree_tree_find_closest( tree->embree, search );
    }
}

static bool find_closest( const wisp_collision_mesh* tree, const wisp_mesh_query* query, wisp_mesh_nearest* out,
                          uint64_t* tested )
{
    mesh_closest search = mesh_closest_begin( &tree->surface, query );
    search_closest( tree, &search );
    *tested += search.tested;
    if ( search.triangle >= 0 )
    {
        mesh_surface_describe( &tree->surface, search.triangle, search.time, &search.best, search.point, out );
    }
    return search.triangle >= 0;
}

void wisp_collision_mesh_closest( wisp_collision_mesh* tree, const wisp_mesh_query* queries, int count,
                                  wisp_mesh_nearest* nearest, wisp_collision_mesh_query_stats* sum )
{
    wisp_collision_mesh_query_stats work = { .queried = (uint64_t)( count > 0 ? count : 0 ) };
    for ( int i = 0; i < count; ++i )
    {
        nearest[i] = ( wisp_mesh_nearest ){ .triangle = -1 };
        if ( !is_reachable( queries[i].point ) || !( queries[i].radius >= 0.0f ) )
        {
            ++work.refused;
            continue;
        }
        work.answered += find_closest( tree, queries + i, nearest + i, &work.tested ) ? 1 : 0;
    }
    add_work( sum, &work );
}

float wisp_collision_mesh_clearance( const wisp_collision_mesh* tree, wisp_vec3 point, float near )
{
    return mesh_cells_clearance( &tree->cells, point, near );
}

// Rigid meshes do not move in their own frame, so the distance is what stays clear.
static float approach( const wisp_collision_mesh* tree, const wisp_mesh_approach* a, mesh_closest* search )
{
    if ( a->seed >= 0 && a->seed < tree->surface.triangle_count )
    {
        mesh_closest_propose( search, a->seed );
    }
    if ( tree->deforms )
    {
        return mesh_bvh_find_approach( &tree->bvh, search, a->near );
    }
    search_closest( tree, search );
    return (float)( sqrt( search->best.squared ) * ( 1.0 - SEARCH_SLACK ) );
}

void wisp_collision_mesh_approach( const wisp_collision_mesh* tree, const wisp_mesh_approach* approaches, int count,
                                   int32_t* triangles, float* clearance )
{
    for ( int i = 0; i < count; ++i )
    {
        const wisp_mesh_query* query = &approaches[i].query;
        triangles[i] = -1;
        clearance[i] = 0.0f;
        if ( is_reachable( query->point ) && query->radius >= 0.0f )
        {
            mesh_closest search = mesh_closest_begin( &tree->surface, query );
            clearance[i] = approach( tree, approaches + i, &search );
            triangles[i] = search.triangle;
        }
    }
}

// Propose the triangles that share the edge or the corner that is closest. @return whether one is better
static bool propose_neighbours( mesh_closest* search )
{
    const mesh_surface* s = search->surface;
    const int32_t before = search->triangle, hub = search->best.first, rim = search->best.second;
    for ( int32_t k = hub >= 0 ? s->ring_begin[hub] : 0; hub >= 0 && k < s->ring_begin[hub + 1]; ++k )
    {
        const int32_t* corner = s->triangles + 3 * (size_t)s->ring[k];
        if ( s->ring[k] != before && ( rim < 0 || corner[0] == rim || corner[1] == rim || corner[2] == rim ) )
        {
            mesh_closest_propose( search, s->ring[k] );
        }
    }
    return search->triangle != before;
}

enum
{
    TRACKED = 64,
};

// Points and the triangles that are tracked, as the kernel of closest points takes them.
typedef struct tracked_faces
{
    _Alignas( 16 ) float rows[TRACKED][4][4]; // m: the point and the three corners
    int32_t row_x4[4][TRACKED];
    float distance[TRACKED], weight[TRACKED / WISP_SLICE][4][8], normal[TRACKED / WISP_SLICE][3][8];
} tracked_faces;

static void place_corners( const mesh_surface* s, int32_t triangle, float time, float ( *rows )[4] )
{
    const int32_t* number = s->triangles + 3 * (size_t)triangle;
    for ( int k = 0; k < 3; ++k )
    {
        const size_t quad = 4 * (size_t)number[k];
        memcpy( rows[k], s->xyzw + quad, sizeof( rows[k] ) );
        for ( size_t c = 0; s->start != NULL && time < 1.0f && c < 4; ++c )
        {
            rows[k][c] = ( 1.0f - time ) * s->start[quad + c] + time * s->xyzw[quad + c];
        }
    }
}

// Answer for a point above the inside of its triangle, not on the border, which neighbours share.
static void describe_face( const tracked_faces* f, int i, int32_t triangle, wisp_mesh_nearest* out )
{
    const float inside = 1e-5f; // more than the rounding of a weight
    const int group = i / WISP_SLICE, lane = i % WISP_SLICE;
    const float distance = f->distance[i];
    const float weight[3] = { -f->weight[group][1][lane], -f->weight[group][2][lane], -f->weight[group][3][lane] };
    if ( !( weight[0] > inside && weight[1] > inside && weight[2] > inside && distance > 0.0f ) )
    {
        return;
    }
    const wisp_vec3 p = wisp_v3_load( f->rows[i][0] ), a = wisp_v3_load( f->rows[i][1] ),
                    n = { f->normal[group][0][lane], f->normal[group][1][lane], f->normal[group][2][lane] };
    const wisp_vec3 out_of = wisp_v3_cross( wisp_v3_sub( wisp_v3_load( f->rows[i][2] ), a ),
                                            wisp_v3_sub( wisp_v3_load( f->rows[i][3] ), a ) );
    const float side = wisp_v3_dot( n, out_of ) < 0.0f ? -1.0f : 1.0f;
    *out = ( wisp_mesh_nearest ){ .triangle = triangle,
                                  .distance = side * distance,
                                  .point = wisp_v3_mul_add( p, -distance, n ),
                                  .normal = { side * n.x, side * n.y, side * n.z },
                                  .weights = { weight[0], weight[1], weight[2] } };
}

// Test the triangles themselves, eight at a time: most points stay above the inside of theirs.
static void track_faces( const mesh_surface* s, const wisp_kernels* kernels, const wisp_mesh_query* queries,
                         const int32_t* triangles, int count, wisp_mesh_nearest* nearest )
{
    tracked_faces f;
    const int groups = ( count + WISP_SLICE - 1 ) / WISP_SLICE;
    for ( int i = 0; i < WISP_SLICE * groups; ++i )
    {
        const int from = i < count ? i : 0; // the last group is padded
        memcpy( f.rows[i][0], &queries[from].point, sizeof( queries[from].point ) );
        place_corners( s, triangles[from], queries[from].time, f.rows[i] + 1 );
        for ( int k = 0; k < 4; ++k )
        {
            f.row_x4[k][i] = 16 * i + 4 * k;
        }
    }
    const wisp_closest_args args = { .xyzw = f.rows[0][0],
                                     .point_x4 = { f.row_x4[0], f.row_x4[1], f.row_x4[2], f.row_x4[3] },
                                     .distance = f.distance,
                                     .weight = f.weight,
                                     .normal = f.normal };
    kernels->closest_triangle( &args, 0, groups );
    for ( int i = 0; i < count; ++i )
    {
        describe_face( &f, i, triangles[i], nearest + i );
    }
}

// Go to neighbours that are closer, until none is.
static void track_neighbours( const mesh_surface* s, const wisp_mesh_query* query, int32_t triangle,
                              wisp_mesh_nearest* nearest )
{
    if ( !is_reachable( query->point ) || !( query->radius >= 0.0f ) )
    {
        return;
    }
    wisp_mesh_query anywhere = *query;
    anywhere.radius = INFINITY;
    mesh_closest search = mesh_closest_begin( s, &anywhere );
    mesh_closest_propose( &search, triangle );
    while ( propose_neighbours( &search ) )
    {
    }
    mesh_surface_describe( s, search.triangle, search.time, &search.best, search.point, nearest );
}

void wisp_collision_mesh_track( const wisp_collision_mesh* tree, const wisp_kernels* kernels,
                                const wisp_mesh_query* queries, const int32_t* triangles, int count,
                                wisp_mesh_nearest* nearest )
{
    for ( int i = 0; i < count; ++i )
    {
        nearest[i] = ( wisp_mesh_nearest ){ .triangle = -1 };
    }
    for ( int first = 0; kernels != NULL && first < count; first += TRACKED )
    {
        const int n = count - first < TRACKED ? count - first : TRACKED;
        track_faces( &tree->surface, kernels, queries + first, triangles + first, n, nearest + first );
    }
    for ( int i = 0; i < count; ++i )
    {
        if ( nearest[i].triangle < 0 )
        {
            track_neighbours( &tree->surface, queries + i, triangles[i], nearest + i );
        }
    }
}

static void describe_intersection( const mesh_cast* search, wisp_mesh_hit* hit )
{
    const triangle_intersection* c = &search->best;
    const double when = search->begin_time + c->time * ( search->end_time - search->begin_time );
    triangle_corners t = mesh_surface_triangle( search->surface, search->triangle, when );
    double3 normal = double3_unit_or_zero( triangle_normal( &t ) );
    double side = c->from_front ? 1.0 : -1.0;
    *hit = ( wisp_mesh_hit ){
        .triangle = search->triangle,
        .time = (float)c->time,
        .side = (float)side,
        .point = double3_narrow( double3_mul_add( search->from, c->time, double3_sub( search->to, search->from ) ) ),
        .normal = double3_narrow( double3_scale( normal, side ) ),
        .weights = { (float)c->weights[0], (float)c->weights[1], (float)c->weights[2] },
    };
}

static bool find_intersection( const wisp_collision_mesh* tree, const wisp_mesh_path* path, wisp_mesh_hit* hit,
                               wisp_collision_mesh_query_stats* work )
{
    mesh_cast search = mesh_cast_begin( &tree->surface, path );
    if ( has_bvh( tree ) )
    {
        mesh_bvh_find_intersection( &tree->bvh, &search );
    }
    else if ( !embree_tree_find_intersection( tree->embree, &search ) )
    {
        ++work->refused;
    }
    work->tested += search.tested;
    if ( search.triangle >= 0 )
    {
        describe_intersection( &search, hit );
    }
    return search.triangle >= 0;
}

static bool has_length( const wisp_mesh_path* path )
{
    return path->from.x != path->to.x || path->from.y != path->to.y || path->from.z != path->to.z;
}

void wisp_collision_mesh_cast( wisp_collision_mesh* tree, const wisp_mesh_path* paths, int count, wisp_mesh_hit* hits,
                               wisp_collision_mesh_query_stats* sum )
{
    wisp_collision_mesh_query_stats work = { .queried = (uint64_t)( count > 0 ? count : 0 ) };
    for ( int i = 0; i < count; ++i )
    {
        hits[i] = ( wisp_mesh_hit ){ .triangle = -1 };
        if ( !is_reachable( paths[i].from ) || !is_reachable( paths[i].to ) )
        {
            ++work.refused;
        }
        else if ( has_length( paths + i ) || paths[i].begin_time != paths[i].end_time )
        {
            work.answered += find_intersection( tree, paths + i, hits + i, &work ) ? 1 : 0;
        }
    }
    add_work( sum, &work );
}
