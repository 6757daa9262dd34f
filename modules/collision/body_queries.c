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
static bool is_inside( const collision_body* body, wisp_vec3 p )
{
    if ( body->double_sided || collision_box_distance( body, p ) > 0.0f )
    {
        return false;
    }
    const float side = p.y < body->centre.y ? -1.1f : 1.1f;
    const wisp_mesh_path way_out = { p, { p.x, body->centre.y + side * body->half.y, p.z } };
    wisp_mesh_hit hit;
    wisp_collision_mesh_cast( body->tree, &way_out, 1, &hit, NULL );
    return hit.triangle >= 0 && hit.side < 0.0f;
}

// Query within the radius first; only points deep inside need an unbounded query.
static void closest_on_mesh( const collision_body* body, const wisp_mesh_query* queries, int count,
                             wisp_surface_point* nearest, bool* found )
{
    enum
    {
        BATCH = 64,
    };
    wisp_mesh_nearest answers[BATCH];
    for ( int first = 0; first < count; first += BATCH )
    {
        int n = count - first < BATCH ? count - first : BATCH;
        wisp_collision_mesh_closest( body->tree, queries + first, n, answers, NULL );
        for ( int i = 0; i < n; ++i )
        {
            wisp_mesh_nearest* a = answers + i;
            const wisp_mesh_query anywhere = { queries[first + i].point, INFINITY };
            if ( a->triangle < 0 && is_inside( body, anywhere.point ) )
            {
                wisp_collision_mesh_closest( body->tree, &anywhere, 1, a, NULL );
            }
            found[first + i] = a->triangle >= 0;
            nearest[first + i] = ( wisp_surface_point ){ a->point, a->normal, a->distance };
            if ( body->double_sided )
            {
                turn_to_point( nearest + first + i );
            }
        }
    }
}

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

void collision_closest( const collision_body* body, const wisp_mesh_query* queries, int count,
                        wisp_surface_point* nearest, bool* found )
{
    if ( body->tree != NULL )
    {
        closest_on_mesh( body, queries, count, nearest, found );
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

bool collision_cast( const collision_body* body, wisp_vec3 from, wisp_vec3 to, wisp_surface_point* hit )
{
    if ( body->tree == NULL )
    {
        wisp_shape_hit h;
        bool meets = wisp_shape_cast( &body->shape, from, to, &h );
        *hit = meets ? ( wisp_surface_point ){ h.point, h.normal, 0.0f } : ( wisp_surface_point ){ 0 };
        return meets;
    }
    const wisp_mesh_path path = { from, to };
    wisp_mesh_hit h;
    wisp_collision_mesh_cast( body->tree, &path, 1, &h, NULL );
    *hit = ( wisp_surface_point ){ h.point, h.normal, 0.0f };
    return h.triangle >= 0 && ( body->double_sided || h.side > 0.0f );
}

float collision_exact_gap( const collision_view* view, wisp_vec3 from, float gap )
{
    const wisp_mesh_query query = { from, view->thickness };
    wisp_surface_point at_start;
    bool is_near;
    collision_closest( view->body, &query, 1, &at_start, &is_near );
    float exact = is_near ? at_start.distance - view->thickness : 0.0f;
    return exact > gap ? exact : gap;
}
