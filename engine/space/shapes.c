#include "wisp/module/shapes.h"

#include "solid.h"
#include "wisp/module/taper.h"

static double clamp( double x, double lower, double upper )
{
    return x < lower ? lower : ( x > upper ? upper : x );
}

static bool is_finite( wisp_vec3 v )
{
    // the difference of infinity or NaN with itself is not zero
    return v.x - v.x == 0.0f && v.y - v.y == 0.0f && v.z - v.z == 0.0f;
}

static bool is_size( float size )
{
    return size >= 0.0f && size <= FLT_MAX;
}

static bool is_solid( const wisp_shape* shape )
{
    if ( shape == NULL )
    {
        return false;
    }
    const wisp_vec3 h = shape->half_extent;
    switch ( shape->kind )
    {
        case WISP_SHAPE_PLANE:
            return true;
        case WISP_SHAPE_SPHERE:
            return is_size( shape->radius );
        case WISP_SHAPE_CAPSULE:
            return is_size( shape->radius ) && is_size( shape->half_length );
        case WISP_SHAPE_BOX:
            return is_size( h.x ) && is_size( h.y ) && is_size( h.z );
        case WISP_SHAPE_TAPERED_CAPSULE:
            return is_size( shape->top_radius ) && is_size( shape->bottom_radius ) && is_size( shape->half_length );
        case WISP_SHAPE_CONVEX:
            return shape->convex != NULL;
        case WISP_SHAPE_HEIGHT_FIELD:
            return height_field_is_solid( &shape->height_field );
    }
    return false;
}

// ---- closest points ----

// Returns the surface around a point q, the centre of a sphere or the nearest point on the axis of a capsule.
static void closest_round( double3 p, double3 q, double radius, double3 fallback, wisp_surface_point* s )
{
    double3 away = double3_sub( p, q );
    double length = double3_length( away );
    double scale = length > 0.0 ? 1.0 / length : 0.0;
    double3 normal = length > 0.0 ? double3_scale( away, scale ) : fallback;
    s->point = double3_narrow( double3_mul_add( q, radius, normal ) );
    s->normal = double3_narrow( normal );
    s->distance = (float)( length - radius );
}

static void closest_tapered( double3 p, const wisp_shape* shape, wisp_surface_point* s )
{
    const wisp_taper t = wisp_taper_of( shape );
    const double y = clamp( p.y - t.slope * sqrt( p.x * p.x + p.z * p.z ), t.lower, t.upper );
    closest_round( p, ( double3 ){ 0.0, y, 0.0 }, t.middle - t.sine * y, ( double3 ){ t.cosine, t.sine, 0.0 }, s );
}

static double axis_of( double3 v, int axis )
{
    return axis == 0 ? v.x : ( axis == 1 ? v.y : v.z );
}

static double3 along( int axis, double value )
{
    return ( double3 ){ axis == 0 ? value : 0.0, axis == 1 ? value : 0.0, axis == 2 ? value : 0.0 };
}

// Returns the nearest face for a point inside or on the surface; the first of equals.
static void closest_inside_box( double3 p, double3 h, wisp_surface_point* s )
{
    int best = 0;
    double most = fabs( p.x ) - h.x;
    for ( int axis = 1; axis < 3; ++axis )
    {
        double depth = fabs( axis_of( p, axis ) ) - axis_of( h, axis );
        best = depth > most ? axis : best;
        most = depth > most ? depth : most;
    }
    double side = axis_of( p, best ) < 0.0 ? -1.0 : 1.0;
    double3 point = double3_mul_add( p, 1.0, along( best, side * axis_of( h, best ) - axis_of( p, best ) ) );
    s->point = double3_narrow( point );
    s->normal = double3_narrow( along( best, side ) );
    s->distance = (float)most;
}

static void closest_on_box( double3 p, double3 h, wisp_surface_point* s )
{
    double3 q = { clamp( p.x, -h.x, h.x ), clamp( p.y, -h.y, h.y ), clamp( p.z, -h.z, h.z ) };
    double3 away = double3_sub( p, q );
    double length = double3_length( away );
    if ( length == 0.0 )
    {
        closest_inside_box( p, h, s );
        return;
    }
    double scale = 1.0 / length;
    s->point = double3_narrow( q );
    s->normal = double3_narrow( double3_scale( away, scale ) );
    s->distance = (float)length;
}

static void closest_to( const wisp_shape* shape, double3 p, wisp_surface_point* surface )
{
    const double3 x = { 1.0, 0.0, 0.0 }, y = { 0.0, 1.0, 0.0 }, origin = { 0.0, 0.0, 0.0 };
    const double radius = (double)shape->radius, half = (double)shape->half_length;
    switch ( shape->kind )
    {
        case WISP_SHAPE_PLANE:
            *surface = ( wisp_surface_point ){ double3_narrow( ( double3 ){ p.x, 0.0, p.z } ), double3_narrow( y ),
                                               (float)p.y };
            break;
        case WISP_SHAPE_SPHERE:
            closest_round( p, origin, radius, y, surface );
            break;
        case WISP_SHAPE_CAPSULE:
            closest_round( p, ( double3 ){ 0.0, clamp( p.y, -half, half ), 0.0 }, radius, x, surface );
            break;
        case WISP_SHAPE_BOX:
            closest_on_box( p, double3_widen( shape->half_extent ), surface );
            break;
        case WISP_SHAPE_TAPERED_CAPSULE:
            closest_tapered( p, shape, surface );
            break;
        case WISP_SHAPE_CONVEX:
            convex_closest( shape->convex, p, surface );
            break;
        case WISP_SHAPE_HEIGHT_FIELD:
            height_field_closest( &shape->height_field, p, surface );
            break;
    }
}

bool wisp_shape_closest( const wisp_shape* shape, wisp_vec3 p, wisp_surface_point* surface )
{
    if ( surface == NULL )
    {
        return false;
    }
    if ( !is_finite( p ) || !is_solid( shape ) )
    {
        *surface = ( wisp_surface_point ){ .normal = { 0.0f, 1.0f, 0.0f }, .distance = INFINITY };
        return false;
    }
    closest_to( shape, double3_widen( p ), surface );
    return true;
}

// ---- paths ----

// Finds the first root of |from + t step|^2 = radius^2 at which the path enters. The point of closest approach is
// computed first, so that the discriminant is a difference of lengths, not of their fourth powers.
static double enter_round( double3 from, double3 step, double radius )
{
    double squared = double3_dot( step, step ), approach = -double3_dot( from, step );
    double outside = double3_dot( from, from ) - radius * radius;
    if ( !( squared > 0.0 ) || !( approach > 0.0 ) )
    {
        return SOLID_NEVER;
    }
    double3 nearest = double3_mul_add( from, approach / squared, step );
    double room = radius * radius - double3_dot( nearest, nearest );
    if ( room < 0.0 )
    {
        return SOLID_NEVER;
    }
    // the smaller root as c / (b + sqrt), without cancellation where the path begins close to the surface
    return ( outside > 0.0 ? outside : 0.0 ) / ( approach + sqrt( squared * room ) );
}

static double enter_plane( double3 from, double3 step )
{
    return step.y < 0.0 ? from.y / -step.y : SOLID_NEVER;
}

// Intersects the cylinder between the two caps and their spheres, and returns the earliest entry. The parts of the
// spheres inside the cylinder are entered later than the cylinder.
static double enter_capsule( double3 from, double3 step, double radius, double half )
{
    double time = enter_round( ( double3 ){ from.x, 0.0, from.z }, ( double3 ){ step.x, 0.0, step.z }, radius );
    bool is_beside = fabs( from.y ) <= half || from.x * from.x + from.z * from.z >= radius * radius;
    bool meets_side = is_beside && fabs( from.y + time * step.y ) <= half;
    double first = meets_side ? time : SOLID_NEVER;
    for ( int cap = -1; cap <= 1; cap += 2 )
    {
        double3 seen = { from.x, from.y - cap * half, from.z };
        time = enter_round( seen, step, radius );
        first = time < first ? time : first;
    }
    return first;
}

// Returns the earlier entry into the cone between the balls, where its normal meets an axis point between their centres.
//   f( t ) = cosine^2 rho^2 - ( middle - sine y )^2 = A t^2 + 2 B t + C
static double enter_cone( const wisp_taper* t, double3 from, double3 step )
{
    const double c = t->cosine * t->cosine, m = t->middle - t->sine * from.y, k = -t->sine * step.y;
    const double a = c * ( step.x * step.x + step.z * step.z ) - k * k;
    const double b = c * ( from.x * step.x + from.z * step.z ) - m * k;
    const double d = c * ( from.x * from.x + from.z * from.z ) - m * m, root = b * b - a * d;
    if ( !( root >= 0.0 ) )
    {
        return SOLID_NEVER;
    }
    // both roots without cancellation
    const double q = -( b + ( b < 0.0 ? -sqrt( root ) : sqrt( root ) ) );
    const double times[] = { a != 0.0 ? q / a : SOLID_NEVER, q != 0.0 ? d / q : SOLID_NEVER };
    double first = SOLID_NEVER;
    for ( int i = 0; i < 2; ++i )
    {
        const double3 at = double3_mul_add( from, times[i], step );
        const double rho = sqrt( at.x * at.x + at.z * at.z ), y = at.y - t->slope * rho;
        const double inwards = t->cosine * ( at.x * step.x + at.z * step.z ) + t->sine * rho * step.y;
        const bool enters = times[i] >= 0.0 && y >= t->lower && y <= t->upper && inwards < 0.0;
        // the other half of the double cone is no surface
        const bool is_outer = t->middle - t->sine * at.y >= 0.0;
        first = enters && is_outer && times[i] < first ? times[i] : first;
    }
    return first;
}

// The parts of the balls inside the hull are entered later than the hull.
static double enter_tapered( const wisp_shape* shape, double3 from, double3 step )
{
    const wisp_taper t = wisp_taper_of( shape );
    double first = t.lower < t.upper ? enter_cone( &t, from, step ) : SOLID_NEVER;
    const double ends[] = { t.lower, t.upper };
    for ( int cap = 0; cap < 2; ++cap )
    {
        const double3 seen = { from.x, from.y - ends[cap], from.z };
        const double time = enter_round( seen, step, t.middle - t.sine * ends[cap] );
        first = time < first ? time : first;
    }
    return first;
}

// Finds the slab that is entered last, before any slab is left.
// @param normal of the face, output
static double enter_box( double3 from, double3 step, double3 h, double3* normal )
{
    double enter = -1.0, leave = SOLID_NEVER;
    int axis = 0;
    for ( int k = 0; k < 3; ++k )
    {
        double a = axis_of( from, k ), d = axis_of( step, k ), size = axis_of( h, k );
        if ( d == 0.0 )
        {
            leave = fabs( a ) > size ? -1.0 : leave;
            continue;
        }
        double near = ( d > 0.0 ? -size - a : size - a ) / d, far = ( d > 0.0 ? size - a : -size - a ) / d;
        axis = near > enter ? k : axis;
        enter = near > enter ? near : enter;
        leave = far < leave ? far : leave;
    }
    *normal = along( axis, axis_of( step, axis ) > 0.0 ? -1.0 : 1.0 );
    return enter >= 0.0 && enter <= leave ? enter : SOLID_NEVER;
}

// Returns the surface at a time of the path, with the point projected onto the surface.
static void fill_hit( const wisp_shape* shape, double3 from, double3 step, double time, wisp_shape_hit* hit )
{
    wisp_surface_point surface;
    closest_to( shape, double3_mul_add( from, time, step ), &surface );
    *hit = ( wisp_shape_hit ){ surface.point, surface.normal, (float)time };
}

static double enter_time( const wisp_shape* shape, double3 from, double3 step, double3* normal )
{
    switch ( shape->kind )
    {
        case WISP_SHAPE_PLANE:
            return enter_plane( from, step );
        case WISP_SHAPE_SPHERE:
            return enter_round( from, step, (double)shape->radius );
        case WISP_SHAPE_CAPSULE:
            return enter_capsule( from, step, (double)shape->radius, (double)shape->half_length );
        case WISP_SHAPE_BOX:
            return enter_box( from, step, double3_widen( shape->half_extent ), normal );
        case WISP_SHAPE_TAPERED_CAPSULE:
            return enter_tapered( shape, from, step );
        case WISP_SHAPE_CONVEX:
            return convex_enter( shape->convex, from, step, normal );
        case WISP_SHAPE_HEIGHT_FIELD:
            return height_field_enter( &shape->height_field, from, step, normal );
    }
    return SOLID_NEVER;
}

bool wisp_shape_cast( const wisp_shape* shape, wisp_vec3 from, wisp_vec3 to, wisp_shape_hit* hit )
{
    if ( hit == NULL )
    {
        return false;
    }
    *hit = ( wisp_shape_hit ){ .normal = { 0.0f, 1.0f, 0.0f } };
    wisp_surface_point first, last;
    if ( !wisp_shape_closest( shape, from, &first ) || !wisp_shape_closest( shape, to, &last ) ||
         first.distance < 0.0f )
    {
        return false;
    }
    double3 a = double3_widen( from ), step = double3_sub( double3_widen( to ), a );
    double3 normal = { 0.0, 0.0, 0.0 }; // of the face, if the shape has faces
    double time = enter_time( shape, a, step, &normal );
    if ( time <= 1.0 )
    {
        fill_hit( shape, a, step, time, hit );
        if ( double3_dot( normal, normal ) > 0.0 )
        {
            // near an edge the closest point could be on another face
            hit->normal = double3_narrow( normal );
        }
        return true;
    }

    // the end is inside in floats, but rounding hid the entry, which is within rounding error of the end
    if ( last.distance < 0.0f )
    {
        *hit = ( wisp_shape_hit ){ last.point, last.normal, 1.0f };
        return true;
    }
    return false;
}
