// The deepest point of a segment or a triangle in a convex body.
//
// The signed distance of a convex body is a convex function, outside and inside. So its tangent plane at any point, which the
// normal gives, is nowhere above it, and a minimum along a line is bracketed by two tangents (cutting planes; Kelley 1960, "The
// cutting-plane method for solving convex programs"). Where they meet is a lower bound and the next point. The
// search ends when the least distance found is within the tolerance of the bound, so the error is known.
//
// A triangle is searched along one side for the best of the segments parallel to the opposite one. Between the two tangents
// of a segment lies one that is level along it; it bounds the distance of all points, so it is the tangent of the outer search
// even where the distance has a kink. (Macklin et al. 2020, "Local optimization for robust signed distance field collision",
// use Frank-Wolfe or projected gradients for distances that are not convex.)
#include "primitive_contacts.h"

#include "wisp/base.h"

enum
{
    CUTS = 12,
};

// A point of a line with a plane below the distance: f( x ) >= bound + normal ( x - here ).
typedef struct tangent
{
    float at;    // parameter on the line
    float bound; // m
    wisp_vec3 normal;
    float slope;                // m, along the whole line
    wisp_surface_point surface; // of the best point
    float inner;                // of a triangle: where the best point is on its segment
} tangent;

typedef struct line
{
    const wisp_shape* shape;
    wisp_vec3 from, along;
    // of a triangle: the segment at t goes from `from + t along` by t `across`
    wisp_vec3 across;
    float tolerance;
} line;

static wisp_vec3 blend( wisp_vec3 a, wisp_vec3 b, float s )
{
    return ( wisp_vec3 ){ a.x + s * ( b.x - a.x ), a.y + s * ( b.y - a.y ), a.z + s * ( b.z - a.z ) };
}

static bool evaluate( const line* l, float at, tangent* out )
{
    out->at = at;
    out->inner = 0.0f;
    if ( wisp_shape_closest( l->shape, wisp_v3_mul_add( l->from, at, l->along ), &out->surface ) == false )
    {
        return false;
    }
    out->bound = out->surface.distance;
    out->normal = out->surface.normal;
    out->slope = wisp_v3_dot( out->normal, l->along );
    return true;
}

// Find where two tangents meet, which is below all between. @return a place there that is not close to their points
static float meeting_point( const tangent* a, const tangent* b, float* bound )
{
    const float width = b->at - a->at, fall = a->slope - b->slope;
    const float t = fall < 0.0f ? ( b->bound - a->bound - b->slope * width ) / fall : 0.5f * width;
    const float least = 0.02f * width;
    *bound = a->bound + a->slope * t;
    return a->at + collision_larger( least, collision_smaller( width - least, t ) );
}

typedef bool evaluate_fn( const line* l, float at, tangent* out );

// Find the minimum on [0, 1]. Out: the best point, and a plane below the distance that is level along the line or rises from its
// end into it.
static bool minimise( const line* l, evaluate_fn* evaluate_at, tangent* out )
{
    tangent a, b;
    if ( evaluate_at( l, 0.0f, &a ) == false || evaluate_at( l, 1.0f, &b ) == false )
    {
        return false;
    }
    if ( a.slope >= 0.0f || b.slope <= 0.0f )
    {
        *out = a.slope >= 0.0f ? a : b;
        return true;
    }
    tangent best = a.surface.distance <= b.surface.distance ? a : b;
    for ( int cut = 0; cut < CUTS; ++cut )
    {
        float bound;
        const float at = meeting_point( &a, &b, &bound );
        if ( best.surface.distance - bound <= l->tolerance )
        {
            break;
        }
        tangent next;
        if ( evaluate_at( l, at, &next ) == false )
        {
            return false;
        }
        best = next.surface.distance < best.surface.distance ? next : best;
        *( next.slope < 0.0f ? &a : &b ) = next;
        if ( next.slope == 0.0f )
        {
            a = b = best = next;
            break;
        }
    }
    // the level plane between both tangents
    *out = best;
    if ( a.at < b.at )
    {
        const float share = a.slope / ( a.slope - b.slope );
        const wisp_vec3 n = blend( a.normal, b.normal, share );
        const float level = ( 1.0f - share ) * ( a.bound + a.slope * ( best.at - a.at ) ) +
                            share * ( b.bound + b.slope * ( best.at - b.at ) );
        out->normal = n;
        out->bound = collision_smaller( level, best.surface.distance );
    }
    else
    {
        out->normal = best.normal;
        out->bound = best.bound;
    }
    return true;
}

// The best point of the segment of a triangle at a fraction of its height.
static bool minimise_across( const line* l, float at, tangent* out )
{
    if ( at == 0.0f )
    {
        // the apex: the way down is the steeper of both sides
        const bool found = evaluate( l, 0.0f, out );
        const float side = wisp_v3_dot( out->normal, l->across );
        out->slope += side < 0.0f ? side : 0.0f;
        out->inner = side < 0.0f ? 1.0f : 0.0f;
        return found;
    }
    const line segment = { l->shape,
                           wisp_v3_mul_add( l->from, at, l->along ),
                           { at * l->across.x, at * l->across.y, at * l->across.z },
                           { 0.0f, 0.0f, 0.0f },
                           0.5f * l->tolerance };
    if ( minimise( &segment, evaluate, out ) == false )
    {
        return false;
    }
    out->inner = out->at;
    out->at = at;
    out->slope = wisp_v3_dot( out->normal, wisp_v3_mul_add( l->along, out->inner, l->across ) );
    return true;
}

float collision_bound_deepest( const wisp_shape* shape, const wisp_vec3* corners, int corner_count, float* corner )
{
    float bound = -INFINITY;
    *corner = INFINITY;
    for ( int k = 0; k < corner_count; ++k )
    {
        wisp_surface_point s;
        if ( wisp_shape_closest( shape, corners[k], &s ) == false )
        {
            return -INFINITY;
        }
        float fall = 0.0f;
        for ( int j = 0; j < corner_count; ++j )
        {
            fall = collision_smaller( fall, wisp_v3_dot( s.normal, wisp_v3_sub( corners[j], corners[k] ) ) );
        }
        bound = collision_larger( bound, s.distance + fall );
        *corner = collision_smaller( *corner, s.distance );
    }
    return bound;
}

bool collision_find_deepest( const wisp_shape* shape, const wisp_vec3* corners, int corner_count, float tolerance,
                             collision_deepest* out )
{
    tangent best;
    const line l = { shape, corners[0], wisp_v3_sub( corners[1], corners[0] ),
                     corner_count == 3 ? wisp_v3_sub( corners[2], corners[1] ) : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f },
                     tolerance };
    const bool is_triangle = corner_count == 3;
    if ( minimise( &l, is_triangle ? minimise_across : evaluate, &best ) == false )
    {
        return false;
    }
    out->weights[0] = 1.0f - best.at;
    out->weights[1] = is_triangle ? best.at * ( 1.0f - best.inner ) : best.at;
    out->weights[2] = is_triangle ? best.at * best.inner : 0.0f;
    out->surface = best.surface;
    return true;
}
