// Contacts of the edges of a surface with the edges of a mesh, and of its triangles with the corners of a mesh. With those of its vertices
// with the faces of the mesh (contact_generation.c) they are all ways in which two triangle meshes touch first.
//
// - Boxes of the whole step of a mesh find what is near the path of a primitive (wisp/module/collision_mesh.h). Only what sticks out is
//   tested: an edge in a plane or a valley touches nothing that its faces do not.
// - As for convex bodies, conservative advancement (primitive_contacts.c) finds where a path first comes nearer than a tenth of the thickness, here
//   with the distance of both primitives. The normal of the half space is the direction from one to the other there. It
//   needs no inside: the primitive stays on the side that it comes from.
// - Closed meshes touch from outside alone: a normal against that of the faces around the edge is that of the far side, and is left out.
// - A closest point at a corner of the surface, or on the border of a triangle, belongs to the contacts of those.
#include "primitive_contacts.h"
#include "wisp/module/double3.h"

#include <math.h>

enum
{
    NEAR = 128, // features near the path of a primitive
};

// Fractions of the thickness, as in primitive_contacts.c, and the distance of two contacts that count as one.
static const double FEATURE_STOP = 0.1, SAME = 0.05;
static const float FEATURE_LEFT_TO_CORNERS = 0.05f;
static const float ALIKE = 0.7f; // cosine of two normals of one side

// ---- distances ----

static double unit( double x )
{
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x; // 0 for NaN is not needed: paths are finite
}

// The closest points p + s u and q + t v of two segments (Ericson 2005, "Real-time collision detection", 5.1.9).
static double closest_of_segments( double3 p, double3 u, double3 q, double3 v, double* s, double* t )
{
    const double3 r = double3_sub( p, q );
    const double a = double3_dot( u, u ), e = double3_dot( v, v ), f = double3_dot( v, r ), c = double3_dot( u, r ),
                 b = double3_dot( u, v );
    const double area = a * e - b * b;
    *s = a > 0.0 && area > 1e-12 * a * e ? unit( ( b * f - c * e ) / area ) : 0.0;
    *t = e > 0.0 ? ( b * *s + f ) / e : 0.0;
    if ( e <= 0.0 || *t < 0.0 || *t > 1.0 )
    {
        *t = unit( *t );
        *s = a > 0.0 ? unit( ( b * *t - c ) / a ) : 0.0;
    }
    const double3 away = double3_sub( double3_mul_add( p, *s, u ), double3_mul_add( q, *t, v ) );
    return double3_length( away );
}

// The closest point of a triangle: within it, else on the nearest side.
static double closest_of_triangle( const double3 corners[3], double3 p, double weights[3] )
{
    const double3 u = double3_sub( corners[1], corners[0] ), v = double3_sub( corners[2], corners[0] ),
                  r = double3_sub( p, corners[0] );
    const double a = double3_dot( u, u ), b = double3_dot( u, v ), c = double3_dot( v, v ), d = double3_dot( u, r ),
                 e = double3_dot( v, r );
    const double area = a * c - b * b, s = c * d - b * e, t = a * e - b * d;
    if ( area > 0.0 && s >= 0.0 && t >= 0.0 && s + t <= area )
    {
        weights[1] = s / area;
        weights[2] = t / area;
        weights[0] = 1.0 - weights[1] - weights[2];
        const double3 away =
            double3_sub( r, double3_mul_add( ( double3 ){ weights[1] * u.x, weights[1] * u.y, weights[1] * u.z },
                                             weights[2], v ) );
        return double3_length( away );
    }
    double least = INFINITY;
    for ( int k = 0; k < 3; ++k )
    {
        const int next = k < 2 ? k + 1 : 0;
        double at, none;
        const double distance = closest_of_segments( corners[k], double3_sub( corners[next], corners[k] ), p,
                                                     ( double3 ){ 0.0, 0.0, 0.0 }, &at, &none );
        if ( distance < least )
        {
            least = distance;
            weights[0] = weights[1] = weights[2] = 0.0;
            weights[k] = 1.0 - at;
            weights[next] = at;
        }
    }
    return least;
}

double collision_closest_feature( const wisp_vec3* corners, int count, const wisp_vec3 ends[2], float* weights,
                                  float* along )
{
    const double3 q = double3_widen( ends[0] );
    double w[3] = { 0.0, 0.0, 0.0 }, t = 0.0, distance;
    if ( count == 2 )
    {
        const double3 p = double3_widen( corners[0] );
        distance = closest_of_segments( p, double3_sub( double3_widen( corners[1] ), p ), q,
                                        double3_sub( double3_widen( ends[1] ), q ), &w[1], &t );
        w[0] = 1.0 - w[1];
    }
    else
    {
        const double3 at[3] = { double3_widen( corners[0] ), double3_widen( corners[1] ),
                                double3_widen( corners[2] ) };
        distance = closest_of_triangle( at, q, w );
    }
    for ( int k = 0; k < 3; ++k )
    {
        weights[k] = (float)w[k];
    }
    *along = (float)t;
    return distance;
}

// ---- a primitive and a feature ----

// Closest points at a time of the substep.
typedef struct approach
{
    double time, distance;
    float weights[3], along;
    wisp_vec3 normal; // from the feature to the primitive; zero where they cross
} approach;

static wisp_vec3 between( wisp_vec3 a, wisp_vec3 b, float s )
{
    return wisp_v3_mul_add( a, s, wisp_v3_sub( b, a ) );
}

static void measure_approach( const primitive_path* path, const wisp_mesh_feature* f, double time, approach* out )
{
    wisp_vec3 corners[3], ends[2];
    for ( int k = 0; k < path->corner_count; ++k )
    {
        corners[k] = between( path->from[k], path->to[k], (float)time );
    }
    for ( int k = 0; k < 2; ++k )
    {
        ends[k] = between( f->from[k], f->to[k], (float)time );
    }
    out->time = time;
    out->distance = collision_closest_feature( corners, path->corner_count, ends, out->weights, &out->along );
}

static void find_normal( const primitive_path* path, const wisp_mesh_feature* f, approach* a )
{
    wisp_vec3 p = { 0.0f, 0.0f, 0.0f };
    const float time = (float)a->time;
    for ( int k = 0; k < path->corner_count; ++k )
    {
        p = wisp_v3_mul_add( p, a->weights[k], between( path->from[k], path->to[k], time ) );
    }
    const wisp_vec3 q =
        between( between( f->from[0], f->to[0], time ), between( f->from[1], f->to[1], time ), a->along );
    const wisp_vec3 away = wisp_v3_sub( p, q );
    const float length = wisp_v3_length( away );
    a->normal = length > 0.0f ? ( wisp_vec3 ){ away.x / length, away.y / length, away.z / length }
                              : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
}

static double feature_displacement( const wisp_mesh_feature* f )
{
    return (double)collision_larger( wisp_v3_length( wisp_v3_sub( f->to[0], f->from[0] ) ),
                                     wisp_v3_length( wisp_v3_sub( f->to[1], f->from[1] ) ) );
}

// Find where a path is stopped, or its end if that is near. The distance changes by no more than what both move.
// @return false: neither
static bool find_approach( const collision_view* view, const primitive_path* path, const wisp_mesh_feature* f,
                           approach* out )
{
    const double stop = FEATURE_STOP * (double)view->thickness;
    const double displacement = (double)path->displacement + feature_displacement( f );
    measure_approach( path, f, 1.0, out );
    if ( out->distance > 2.0 * (double)view->thickness + displacement )
    {
        return false;
    }
    if ( out->distance - displacement <= stop )
    {
        measure_approach( path, f, 0.0, out );
    }
    for ( int i = 0; i < COLLISION_ADVANCES && out->time < 1.0 && out->distance > stop; ++i )
    {
        // not quite, so that rounding does not carry it through
        const double next = out->time + ( out->distance - 0.5 * stop ) / fmax( displacement, 1e-30 );
        measure_approach( path, f, next < 1.0 ? next : 1.0, out );
    }
    find_normal( path, f, out );
    return true;
}

static bool is_approach_on_border( const primitive_path* path, const approach* a )
{
    bool any = false;
    for ( int k = 0; k < path->corner_count; ++k )
    {
        any = any || a->weights[k] < COLLISION_BORDER;
    }
    return any;
}

// Whether a feature sticks out to the side that a primitive comes from. What is closed has one side.
static bool faces( const collision_body* body, const wisp_mesh_sides* f, wisp_vec3 normal )
{
    const float side = wisp_v3_dot( normal, f->normal );
    return body->double_sided ? ( side >= 0.0f ? f->in_front : f->behind ) : side > 0.0f && f->in_front;
}

// At the end of a path, what is no deeper than a corner that has a contact with the same side is left to that contact.
static bool is_left_to_corner( const collision_view* view, const primitive_path* path, const approach* a )
{
    bool any = false;
    const float left = FEATURE_LEFT_TO_CORNERS * view->thickness;
    for ( int k = 0; k < path->plane_count; ++k )
    {
        any = any || ( wisp_v3_dot( a->normal, path->normals[k] ) > ALIKE &&
                       (float)a->distance >= path->distances[k] - left );
    }
    return any && a->time >= 1.0;
}

// ---- a primitive and a mesh ----

static bool is_before( const approach* a, const approach* b )
{
    return a->time < b->time || ( a->time == b->time && a->distance < b->distance );
}

// Edges that share a corner of the mesh, and meet there, are one contact.
static bool is_same( const collision_view* view, const collision_meeting* a, const collision_meeting* b )
{
    const float within = (float)SAME * view->thickness;
    return wisp_v3_length( wisp_v3_sub( a->deepest.surface.point, b->deepest.surface.point ) ) < within &&
           wisp_v3_dot( a->deepest.surface.normal, b->deepest.surface.normal ) > 0.99f;
}

static collision_meeting meeting_of( const wisp_mesh_feature* f, const approach* a )
{
    const wisp_vec3 point = between( f->to[0], f->to[1], a->along );
    return ( collision_meeting ){
        .deepest = { .weights = { a->weights[0], a->weights[1], a->weights[2] },
                     .surface = { point, a->normal, (float)a->distance } },
        .motion = wisp_v3_sub( point, between( f->from[0], f->from[1], a->along ) ),
    };
}

static void box_of_path( const collision_view* view, const primitive_path* path, float lower[3], float upper[3] )
{
    wisp_vec3 low = path->from[0], high = low;
    for ( int k = 0; k < path->corner_count; ++k )
    {
        collision_widen( &low, &high, path->from[k] );
        collision_widen( &low, &high, path->to[k] );
    }
    const float more = 2.0f * view->thickness;
    const float lows[3] = { low.x, low.y, low.z }, highs[3] = { high.x, high.y, high.z };
    for ( int k = 0; k < 3; ++k )
    {
        lower[k] = lows[k] - more;
        upper[k] = highs[k] + more;
    }
}

static bool overlaps( const wisp_mesh_feature* f, const float lower[3], const float upper[3] )
{
    wisp_vec3 low = f->from[0], high = low;
    collision_widen( &low, &high, f->from[1] );
    collision_widen( &low, &high, f->to[0] );
    collision_widen( &low, &high, f->to[1] );
    return low.x <= upper[0] && low.y <= upper[1] && low.z <= upper[2] && high.x >= lower[0] && high.y >= lower[1] &&
           high.z >= lower[2];
}

int collision_meet_features( const collision_view* view, const primitive_path* path, collision_meeting* out )
{
    float lower[3], upper[3];
    int32_t near[NEAR];
    approach best[COLLISION_PRIMITIVE_CONTACTS];
    int found = 0;
    const bool is_corner = path->corner_count == 3;
    const wisp_collision_mesh* mesh = view->body->tree; // null: a height field
    const wisp_height_field* field = &view->body->shape.height_field;
    box_of_path( view, path, lower, upper );
    const int count = mesh != NULL ? wisp_collision_mesh_find_features( mesh, lower, upper, is_corner, near, NEAR )
                                   : wisp_height_field_find_features( field, lower, upper, is_corner, near, NEAR );
    for ( int i = 0; i < count; ++i )
    {
        const wisp_mesh_feature f =
            mesh != NULL ? wisp_collision_mesh_feature( mesh, near[i], is_corner, view->begin, view->end )
                         : wisp_height_field_feature( field, near[i] );
        approach a;
        if ( overlaps( &f, lower, upper ) == false || find_approach( view, path, &f, &a ) == false ||
             is_approach_on_border( path, &a ) || is_left_to_corner( view, path, &a ) )
        {
            continue;
        }
        const wisp_mesh_sides sides = mesh != NULL ? wisp_collision_mesh_sides( mesh, near[i], is_corner, view->end )
                                                   : wisp_height_field_sides( field, near[i] );
        if ( faces( view->body, &sides, a.normal ) == false )
        {
            continue;
        }
        const collision_meeting meeting = meeting_of( &f, &a );
        int at = 0, same = 0;
        while ( same < found && is_same( view, &out[same], &meeting ) == false )
        {
            ++same;
        }
        if ( same < found )
        {
            continue;
        }
        while ( at < found && is_before( &a, &best[at] ) == false )
        {
            ++at;
        }
        found += found < COLLISION_PRIMITIVE_CONTACTS ? 1 : 0;
        for ( int k = found - 1; k > at; --k )
        {
            best[k] = best[k - 1];
            out[k] = out[k - 1];
        }
        if ( at < found )
        {
            best[at] = a;
            out[at] = meeting;
        }
    }
    return found;
}
