// Queries on bodies. In: points or paths in the frame of a body. Out: closest points and first hits. Closed forms are
// answered by wisp/module/shapes.h, meshes by a tree (wisp/module/collision_mesh.h).
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
    return collision_larger( 0.0f, collision_larger( lower - other_high, other_low - upper ) );
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
        apart( lower.x, upper.x, collision_smaller( a.x, b.x ), collision_larger( a.x, b.x ) ),
        apart( lower.y, upper.y, collision_smaller( a.y, b.y ), collision_larger( a.y, b.y ) ),
        apart( lower.z, upper.z, collision_smaller( a.z, b.z ), collision_larger( a.z, b.z ) ),
    };
    return wisp_v3_length( d ) - view->body->ball_radius;
}

// Cast a ray out of the box: from inside, the first triangle is hit from behind. A ray costs a tenth of an unbounded
// closest point query.
static bool is_inside( const collision_body* body, wisp_vec3 p, float time )
{
    if ( body->double_sided || wisp_collision_mesh_clearance( body->tree, p, 0.0f ) >= 0.0f ||
         collision_box_distance( body, p ) > 0.0f )
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

// Say how far to search for a vertex, and from where on it is of no use. Of a solid body whoever is not known to be outside gets an
// answer wherever the surface is, because that tells the side. @return false if a cell has the answer
static bool prepare_search( const collision_view* view, const collision_tracked_query* q, int32_t seed,
                            collision_track* track, wisp_mesh_approach* approach )
{
    const float near = q->near + q->ahead;
    const float clear = wisp_collision_mesh_clearance( view->body->tree, q->point, near );
    *approach = ( wisp_mesh_approach ){ { q->point, q->radius + q->ahead, view->end }, near, seed };
    if ( clear == near )
    {
        *track = ( collision_track ){ -1, clear, q->point };
        return false;
    }
    if ( clear < 0.0f && view->body->double_sided == false )
    {
        approach->query.radius = approach->near = INFINITY;
    }
    return true;
}

// Answer for a vertex whose search or track has ended.
static bool take_tracked( const collision_view* view, const wisp_mesh_nearest* a, float radius,
                          wisp_surface_point* nearest, wisp_vec3* motion )
{
    if ( a->triangle < 0 || a->distance > radius )
    {
        return false;
    }
    take_answer( view, a, nearest, motion );
    return true;
}

// Search for the triangle of a vertex. @return whether one is within the radius of the search
static bool search_track( const collision_view* view, const collision_tracked_query* q, int32_t seed,
                          collision_track* track )
{
    wisp_mesh_approach approach;
    if ( prepare_search( view, q, seed, track, &approach ) == false )
    {
        return false;
    }
    wisp_collision_mesh_approach( view->body->tree, &approach, 1, &track->triangle, &track->free );
    track->origin = q->point;
    return track->triangle >= 0;
}

// What was searched is answered as what is tracked, so that bits do not depend on when a vertex was searched.
void collision_track_closest( const wisp_kernels* kernels, const collision_view* view,
                              const collision_tracked_query* queries, collision_track* tracks, int count,
                              bool is_first, const int32_t* seeds, wisp_surface_point* nearest, bool* found,
                              wisp_vec3* motion )
{
    wisp_mesh_query near[WISP_PARTICLE_BLOCK];
    int32_t triangles[WISP_PARTICLE_BLOCK], vertices[WISP_PARTICLE_BLOCK], seed = -1;
    wisp_mesh_nearest answers[WISP_PARTICLE_BLOCK];
    int n = 0;
    for ( int i = 0; i < count; ++i )
    {
        const collision_tracked_query* q = queries + i;
        collision_track* track = tracks + i;
        found[i] = false;
        motion[i] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
        if ( is_first == false && collision_is_free( track, q->point, q->near ) )
        {
            continue;
        }
        // a rigid mesh answers the same from any seed, so what the last step has left may be read
        const bool has_left = is_first && view->body->follows == false && track->triangle >= 0;
        const int32_t from = has_left ? track->triangle : seeds != NULL ? seeds[i] : seed;
        if ( ( is_first == false && track->triangle >= 0 ) || search_track( view, q, from, track ) )
        {
            near[n] = ( wisp_mesh_query ){ .point = q->point, .radius = INFINITY, .time = view->end };
            triangles[n] = seed = track->triangle;
            vertices[n++] = i;
        }
    }
    if ( n > 0 )
    {
        wisp_collision_mesh_track( view->body->tree, kernels, near, triangles, n, answers );
    }
    for ( int k = 0; k < n; ++k )
    {
        const int i = vertices[k];
        // whoever is inside is pushed out in each substep, however far from the surface
        const bool is_inside = answers[k].distance < 0.0f && view->body->double_sided == false;
        tracks[i].triangle = answers[k].triangle;
        tracks[i].free = is_inside ? 0.0f : tracks[i].free;
        found[i] = take_tracked( view, answers + k, queries[i].radius, nearest + i, motion + i );
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
static void move_hit( const collision_view* view, const wisp_mesh_hit* h, wisp_surface_point* hit, wisp_vec3* motion )
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
        move_hit( view, &h, hit, motion );
    }
    return true;
}

// From a triangle that is near the answer one search is enough, wherever the point is.
static bool find_at_start( const collision_view* view, wisp_vec3 from, int32_t seed, float* distance )
{
    if ( seed < 0 )
    {
        const wisp_mesh_query query = { .point = from, .radius = view->thickness, .time = view->begin };
        wisp_surface_point at_start;
        bool is_near;
        collision_closest( view, &query, 1, &at_start, &is_near, NULL );
        *distance = at_start.distance;
        return is_near;
    }
    const wisp_mesh_approach approach = { { from, INFINITY, view->begin }, INFINITY, seed };
    int32_t triangle;
    float clearance;
    wisp_collision_mesh_approach( view->body->tree, &approach, 1, &triangle, &clearance );
    if ( triangle < 0 )
    {
        return false;
    }
    wisp_mesh_nearest a;
    wisp_collision_mesh_track( view->body->tree, NULL, &approach.query, &triangle, 1, &a );
    *distance = view->body->double_sided ? fabsf( a.distance ) : a.distance;
    return *distance <= view->thickness;
}

float collision_exact_gap( const collision_view* view, wisp_vec3 from, int32_t seed, float gap )
{
    float distance;
    const float exact = find_at_start( view, from, seed, &distance ) ? distance - view->thickness : 0.0f;
    return exact > gap ? exact : gap;
}
