// Queries on bodies. In: points or paths in the frame of a body. Out: closest points and first hits. Closed forms are
// answered by wisp/shapes.h, meshes by a tree or voxels (wisp/module/collision_mesh.h), which give the same bits.
#include "body_queries.h"

#include <string.h>

// Both sides of a sheet are outside: the normal points to the side of the query.
static void turn_to_point( wisp_surface_point* nearest )
{
    if ( nearest->distance < 0.0f )
    {
        nearest->distance = -nearest->distance;
        nearest->normal = ( wisp_vec3 ){ -nearest->normal.x, -nearest->normal.y, -nearest->normal.z };
    }
}

static float apart( float lower, float upper, float other_low, float other_high )
{
    return fmaxf( 0.0f, fmaxf( lower - other_high, other_low - upper ) );
}

float collision_ball_distance( const collision_view* view, wisp_vec3 lower, wisp_vec3 upper )
{
    // in the frame of a turning body a fixed point moves along a chord, which may cut through the ball
    if ( memcmp( &view->before.rotation, &view->after.rotation, sizeof( wisp_quat ) ) != 0 )
    {
        return 0.0f;
    }
    const wisp_vec3 a = wisp_transform_to_world( view->before, view->body->centre );
    const wisp_vec3 b = wisp_transform_to_world( view->after, view->body->centre );
    const wisp_vec3 d = {
        apart( lower.x, upper.x, fminf( a.x, b.x ), fmaxf( a.x, b.x ) ),
        apart( lower.y, upper.y, fminf( a.y, b.y ), fmaxf( a.y, b.y ) ),
        apart( lower.z, upper.z, fminf( a.z, b.z ), fmaxf( a.z, b.z ) ),
    };
    return collision_length( d ) - view->body->ball_radius;
}

// Cast a ray out of the box: from inside, the first triangle is hit from behind. A ray costs a tenth of an unbounded
// closest point query.
static bool is_inside( const collision_body* body, wisp_vec3 p, float time )
{
    if ( body->double_sided || collision_box_distance( body, p ) > 0.0f )
    {
        return false;
    }
    const float side = p.y < body->centre.y ? -1.1f : 1.1f;
    const wisp_mesh_path way_out = {
        .from = p, .to = { p.x, body->centre.y + side * body->half.y, p.z }, .begin_time = time, .end_time = time
    };
    wisp_mesh_hit hit;
    wisp_collision_mesh_cast( body->tree, &way_out, 1, &hit, NULL );
    return hit.triangle >= 0 && hit.side < 0.0f;
}

// Take over the answer to a query.
static void take_answer( const collision_view* view, const wisp_mesh_nearest* a, wisp_surface_point* nearest,
                         wisp_vec3* motion )
{
    *nearest = ( wisp_surface_point ){ a->point, a->normal, a->distance };
    if ( view->body->double_sided )
    {
        turn_to_point( nearest );
    }
    if ( motion != NULL && view->body->follows )
    {
        *motion = wisp_collision_mesh_motion( view->body->tree, a->triangle, a->weights, view->begin, view->end );
    }
}

enum
{
    BATCH = 64,
};

// Query within the radius first; only points deep inside need an unbounded query.
static void search_mesh( const collision_body* body, const wisp_mesh_query* queries, int count,
                         wisp_mesh_nearest* answers )
{
    wisp_collision_mesh_closest( body->tree, queries, count, answers, NULL );
    for ( int i = 0; i < count; ++i )
    {
        wisp_mesh_query anywhere = queries[i];
        anywhere.radius = INFINITY;
        if ( answers[i].triangle < 0 && is_inside( body, anywhere.point, anywhere.time ) )
        {
            wisp_collision_mesh_closest( body->tree, &anywhere, 1, answers + i, NULL );
        }
    }
}

static void closest_on_mesh( const collision_view* view, const wisp_mesh_query* queries, int count,
                             wisp_surface_point* nearest, bool* found, wisp_vec3* motion )
{
    wisp_mesh_nearest answers[BATCH];
    for ( int first = 0; first < count; first += BATCH )
    {
        int n = count - first < BATCH ? count - first : BATCH;
        search_mesh( view->body, queries + first, n, answers );
        for ( int i = 0; i < n; ++i )
        {
            found[first + i] = answers[i].triangle >= 0;
            if ( found[first + i] )
            {
                take_answer( view, answers + i, nearest + first + i, motion != NULL ? motion + first + i : NULL );
            }
        }
    }
}

// ---- tracking ----

// Tell how a vertex gets its answer: 0 it is far, 1 it is tracked, 2 the body is searched.
static int choose_way( const collision_track* track, float radius, float path, bool is_first )
{
    if ( is_first )
    {
        return 2;
    }
    *track->free -= path;
    if ( *track->free > radius )
    {
        return 0;
    }
    return *track->triangle >= 0 ? 1 : 2;
}

void collision_track_closest( const collision_view* view, const wisp_mesh_query* queries, const float* path,
                              collision_track* tracks, int count, bool is_first, int substeps_left,
                              wisp_surface_point* nearest, bool* found, wisp_vec3* motion )
{
    wisp_mesh_query batch[2][BATCH];
    wisp_mesh_nearest answers[2][BATCH];
    int32_t triangles[BATCH];
    for ( int first = 0; first < count; first += BATCH )
    {
        const int n = count - first < BATCH ? count - first : BATCH;
        int number[2][BATCH], counts[2] = { 0, 0 };
        for ( int i = first; i < first + n; ++i )
        {
            found[i] = false;
            motion[i] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
            const int way = choose_way( tracks + i, queries[i].radius, path[i], is_first );
            if ( way > 0 )
            {
                const int at = counts[way - 1]++;
                triangles[at] = way == 1 ? *tracks[i].triangle : triangles[at];
                number[way - 1][at] = i;
                batch[way - 1][at] = queries[i];
                batch[way - 1][at].radius += way == 2 ? path[i] * (float)substeps_left : 0.0f;
            }
        }
        wisp_collision_mesh_track( view->body->tree, batch[0], triangles, counts[0], answers[0] );
        search_mesh( view->body, batch[1], counts[1], answers[1] );
        for ( int way = 0; way < 2; ++way )
        {
            for ( int k = 0; k < counts[way]; ++k )
            {
                const wisp_mesh_nearest* a = &answers[way][k];
                const int i = number[way][k];
                *tracks[i].triangle = a->triangle;
                *tracks[i].free = a->triangle < 0 ? batch[way][k].radius : fabsf( a->distance );
                found[i] = a->triangle >= 0 && a->distance <= queries[i].radius;
                if ( found[i] )
                {
                    take_answer( view, a, nearest + i, motion + i );
                }
            }
        }
    }
}

// ---- all bodies ----

// As wisp_shape_closest(), but without a call per point, because most points are above a ground plane.
static void closest_on_plane( const wisp_mesh_query* queries, int count, wisp_surface_point* nearest, bool* found )
{
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 p = queries[i].point;
        nearest[i] = ( wisp_surface_point ){ { p.x, 0.0f, p.z }, { 0.0f, 1.0f, 0.0f }, p.y };
        found[i] = isfinite( p.x ) && isfinite( p.y ) && isfinite( p.z ) && p.y <= queries[i].radius;
    }
}

void collision_closest( const collision_view* view, const wisp_mesh_query* queries, int count,
                        wisp_surface_point* nearest, bool* found, wisp_vec3* motion )
{
    const collision_body* body = view->body;
    if ( motion != NULL )
    {
        memset( motion, 0, (size_t)count * sizeof( *motion ) );
    }
    if ( body->tree != NULL )
    {
        closest_on_mesh( view, queries, count, nearest, found, motion );
        return;
    }
    if ( body->shape.kind == WISP_SHAPE_PLANE )
    {
        closest_on_plane( queries, count, nearest, found );
        return;
    }
    const bool is_ground = body->shape.kind == WISP_SHAPE_HEIGHT_FIELD;
    for ( int i = 0; i < count; ++i )
    {
        // above all heights
        if ( is_ground && queries[i].point.y - body->centre.y > queries[i].radius )
        {
            found[i] = false;
            continue;
        }
        found[i] = wisp_shape_closest( &body->shape, queries[i].point, nearest + i ) &&
                   nearest[i].distance <= queries[i].radius;
    }
}

static bool cast_shape( const collision_body* body, wisp_vec3 from, wisp_vec3 to, wisp_surface_point* hit )
{
    wisp_shape_hit h;
    bool meets = wisp_shape_cast( &body->shape, from, to, &h );
    *hit = meets ? ( wisp_surface_point ){ h.point, h.normal, 0.0f } : ( wisp_surface_point ){ 0 };
    return meets;
}

// The plane where a path meets a surface goes along with it to the end of the substep.
static void carry_hit( const collision_view* view, const wisp_mesh_hit* h, wisp_surface_point* hit,
                       wisp_vec3* motion )
{
    const wisp_mesh_place place = wisp_collision_mesh_place( view->body->tree, h->triangle, h->weights, view->end );
    const wisp_vec3 n = place.normal;
    hit->point = place.point;
    hit->normal = ( wisp_vec3 ){ h->side * n.x, h->side * n.y, h->side * n.z };
    *motion = wisp_collision_mesh_motion( view->body->tree, h->triangle, h->weights, view->begin, view->end );
}

bool collision_cast( const collision_view* view, wisp_vec3 from, wisp_vec3 to, wisp_surface_point* hit,
                     wisp_vec3* motion )
{
    const collision_body* body = view->body;
    *motion = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    if ( body->tree == NULL )
    {
        return cast_shape( body, from, to, hit );
    }
    const wisp_mesh_path path = { .from = from, .to = to, .begin_time = view->begin, .end_time = view->end };
    wisp_mesh_hit h;
    wisp_collision_mesh_cast( body->tree, &path, 1, &h, NULL );
    *hit = ( wisp_surface_point ){ h.point, h.normal, 0.0f };
    if ( h.triangle < 0 || ( body->double_sided == false && h.side <= 0.0f ) )
    {
        return false;
    }
    if ( body->follows )
    {
        carry_hit( view, &h, hit, motion );
    }
    return true;
}

float collision_exact_gap( const collision_view* view, wisp_vec3 from, float gap )
{
    const wisp_mesh_query query = { .point = from, .radius = view->thickness, .time = view->begin };
    wisp_surface_point at_start;
    bool is_near;
    collision_closest( view, &query, 1, &at_start, &is_near, NULL );
    float exact = is_near ? at_start.distance - view->thickness : 0.0f;
    return exact > gap ? exact : gap;
}
