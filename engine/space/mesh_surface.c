#include "mesh_surface.h"

#include "alloc.h"
#include "trig.h"

#include "wisp/module/definition.h"

#include <string.h>

// ---- checks ----

static bool is_within_reach( float x )
{
    return x >= -WISP_COLLISION_MESH_REACH && x <= WISP_COLLISION_MESH_REACH; // false for NaN
}

wisp_status mesh_surface_check_points( const wisp_vec3* points, int count, wisp_error* error )
{
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 p = points[i];
        if ( !is_within_reach( p.x ) || !is_within_reach( p.y ) || !is_within_reach( p.z ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "mesh point %d: got (%g, %g, %g), expected finite coordinates within %g m", i,
                              (double)p.x, (double)p.y, (double)p.z, (double)WISP_COLLISION_MESH_REACH );
        }
    }
    return WISP_OK;
}

static wisp_status check_def( const wisp_collision_mesh_def* def, wisp_error* error )
{
    if ( def->point_count < 1 || def->triangle_count < 1 || def->points == NULL || def->triangles == NULL )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT, "mesh collider: got %d points and %d triangles, expected at least one triangle",
            def->points == NULL ? 0 : def->point_count, def->triangles == NULL ? 0 : def->triangle_count );
    }
    // ring entries are indexed by int32_t
    if ( def->triangle_count > INT32_MAX / 3 - 2 || def->point_count > INT32_MAX / 4 - 1 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "mesh collider: got %d points and %d triangles, which is too large",
                          def->point_count, def->triangle_count );
    }
    for ( int k = 0; k < 3 * def->triangle_count; ++k )
    {
        int32_t number = def->triangles[k];
        if ( number < 0 || number >= def->point_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT,
                              "corner %d of triangle %d: got point %d, but the mesh has %d points", k % 3, k / 3,
                              (int)number, def->point_count );
        }
    }
    return mesh_surface_check_points( def->points, def->point_count, error );
}

// ---- construction ----

static size_t size_of( int count, size_t size )
{
    return (size_t)count * size;
}

// Memory blocks of a surface, listed once for reserve, release and their total.
#define SURFACE_BLOCKS( X )                                                                                          \
    X( xyzw, size_of( s->point_count, 4 * sizeof( float ) ) )                                                        \
    X( triangles, size_of( 3 * s->triangle_count, sizeof( int32_t ) ) )                                              \
    X( ring_begin, size_of( s->point_count + 1, sizeof( int32_t ) ) )                                                \
    X( ring, size_of( 3 * s->triangle_count, sizeof( int32_t ) ) )

static size_t normals_size( const mesh_surface* s )
{
    return size_of( s->point_count, sizeof( wisp_vec3 ) );
}

void mesh_surface_release( mesh_surface* s )
{
#define RELEASE( block, size ) base_release( &s->allocator, s->block, size );
    SURFACE_BLOCKS( RELEASE )
#undef RELEASE
    base_release( &s->allocator, s->corner_normals, normals_size( s ) );
    base_release( &s->allocator, s->start, size_of( s->point_count, 4 * sizeof( float ) ) );
    *s = ( mesh_surface ){ 0 };
}

static bool reserve( mesh_surface* s, bool deforms )
{
    bool enough = true;
#define RESERVE( block, size )                                                                                       \
    s->block = base_allocate( &s->allocator, size, BASE_BUFFER_ALIGNMENT );                                          \
    enough = enough && s->block != NULL;                                                                             \
    s->bytes += size;
    SURFACE_BLOCKS( RESERVE )
#undef RESERVE
    if ( deforms )
    {
        const size_t size = size_of( s->point_count, 4 * sizeof( float ) );
        s->start = base_allocate( &s->allocator, size, BASE_BUFFER_ALIGNMENT );
        enough = enough && s->start != NULL;
        s->bytes += size;
    }
    else
    {
        s->corner_normals = base_allocate( &s->allocator, normals_size( s ), BASE_BUFFER_ALIGNMENT );
        enough = enough && s->corner_normals != NULL;
        s->bytes += normals_size( s );
    }
    return enough;
}

// Lists triangles by point with a counting sort. Triangles are visited in order, so rings are in increasing order.
static void build_rings( mesh_surface* s )
{
    memset( s->ring_begin, 0, size_of( s->point_count + 1, sizeof( int32_t ) ) );
    for ( int k = 0; k < 3 * s->triangle_count; ++k )
    {
        s->ring_begin[s->triangles[k] + 1] += 1;
    }
    for ( int v = 0; v < s->point_count; ++v )
    {
        s->ring_begin[v + 1] += s->ring_begin[v];
    }
    for ( int k = 0; k < 3 * s->triangle_count; ++k )
    {
        s->ring[s->ring_begin[s->triangles[k]]++] = k / 3;
    }
    // each begin has advanced to the end of its ring, which is the begin of the next one
    memmove( s->ring_begin + 1, s->ring_begin, size_of( s->point_count, sizeof( int32_t ) ) );
    s->ring_begin[0] = 0;
}

static void widen_extent( mesh_surface* s, const float* xyzw )
{
    for ( int k = 0; k < 3; ++k )
    {
        float lower = s->lower[k], upper = s->upper[k];
        for ( int i = 0; i < s->point_count; ++i )
        {
            float c = xyzw[4 * (size_t)i + (size_t)k];
            lower = c < lower ? c : lower;
            upper = c > upper ? c : upper;
        }
        s->lower[k] = lower;
        s->upper[k] = upper;
        s->largest = fmax( s->largest, fmax( fabs( (double)lower ), fabs( (double)upper ) ) );
    }
}

static void fill_quads( float* xyzw, const wisp_vec3* points, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        float* quad = xyzw + 4 * (size_t)i;
        quad[0] = points[i].x;
        quad[1] = points[i].y;
        quad[2] = points[i].z;
        quad[3] = 0.0f;
    }
}

static void find_extent( mesh_surface* s )
{
    memcpy( s->lower, s->xyzw, sizeof( s->lower ) );
    memcpy( s->upper, s->xyzw, sizeof( s->upper ) );
    s->largest = 0.0;
    widen_extent( s, s->xyzw );
    if ( s->start != NULL )
    {
        widen_extent( s, s->start );
    }
}

void mesh_surface_set_points( mesh_surface* s, const wisp_vec3* start, const wisp_vec3* end )
{
    fill_quads( s->xyzw, end, s->point_count );
    if ( s->start != NULL )
    {
        fill_quads( s->start, start, s->point_count );
    }
    find_extent( s );
}

static void widen_box( const float* xyzw, const int32_t* number, float lower[3], float upper[3] )
{
    for ( int corner = 0; corner < 3; ++corner )
    {
        const float* p = xyzw + 4 * (size_t)number[corner];
        for ( int k = 0; k < 3; ++k )
        {
            lower[k] = p[k] < lower[k] ? p[k] : lower[k];
            upper[k] = p[k] > upper[k] ? p[k] : upper[k];
        }
    }
}

void mesh_surface_box( const mesh_surface* s, int32_t triangle, float lower[3], float upper[3] )
{
    const int32_t* number = s->triangles + 3 * (size_t)triangle;
    memcpy( lower, s->xyzw + 4 * (size_t)number[0], 3 * sizeof( float ) );
    memcpy( upper, lower, 3 * sizeof( float ) );
    widen_box( s->xyzw, number, lower, upper );
    if ( s->start != NULL )
    {
        widen_box( s->start, number, lower, upper );
    }
}

static double3 find_corner_normal( const mesh_surface* s, int32_t point, double time );

wisp_status mesh_surface_build( mesh_surface* s, const wisp_collision_mesh_def* def, const wisp_allocator* allocator,
                                wisp_error* error )
{
    *s = ( mesh_surface ){ 0 };
    WISP_TRY( check_def( def, error ) );
    s->allocator = allocator != NULL ? *allocator : ( wisp_allocator ){ 0 };
    s->point_count = def->point_count;
    s->triangle_count = def->triangle_count;
    if ( !reserve( s, def->deforms ) )
    {
        mesh_surface_release( s );
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a mesh collider of %d triangles",
                          def->triangle_count );
    }
    mesh_surface_set_points( s, def->points, def->points );
    memcpy( s->triangles, def->triangles, size_of( 3 * s->triangle_count, sizeof( int32_t ) ) );
    build_rings( s );
    for ( int v = 0; v < s->point_count && s->corner_normals != NULL; ++v )
    {
        s->corner_normals[v] = double3_narrow( find_corner_normal( s, v, 1.0 ) );
    }
    return WISP_OK;
}

// ---- surface normals ----

// Computes the angle of a triangle at one of its points, by an arc tangent with the same bits on every machine.
static double angle_at( const triangle_corners* t, int32_t point )
{
    int i = t->number[0] == point ? 0 : ( t->number[1] == point ? 1 : 2 );
    double3 a = double3_unit_or_zero( double3_sub( t->at[( i + 1 ) % 3], t->at[i] ) );
    double3 b = double3_unit_or_zero( double3_sub( t->at[( i + 2 ) % 3], t->at[i] ) );
    double3 n = double3_cross( a, b );
    return (double)trig_atan2( (float)double3_length( n ), (float)double3_dot( a, b ) );
}

static double3 find_corner_normal( const mesh_surface* s, int32_t point, double time )
{
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int32_t k = s->ring_begin[point]; k < s->ring_begin[point + 1]; ++k )
    {
        triangle_corners t = mesh_surface_triangle( s, s->ring[k], time );
        double3 normal = double3_unit_or_zero( triangle_normal( &t ) );
        sum = double3_mul_add( sum, angle_at( &t, point ), normal );
    }
    // rounded to float in either case, so that rigid and deforming meshes agree
    wisp_vec3 rounded = double3_narrow( double3_unit_or_zero( sum ) );
    return double3_widen( rounded );
}

static bool has_point( const int32_t* corners, int32_t point )
{
    return corners[0] == point || corners[1] == point || corners[2] == point;
}

// Sums over the triangles of an edge, in their order. The smaller ring is searched, as both contain the same
// triangles.
static double3 find_edge_normal( const mesh_surface* s, int32_t u, int32_t v, double time )
{
    int32_t size_u = s->ring_begin[u + 1] - s->ring_begin[u], size_v = s->ring_begin[v + 1] - s->ring_begin[v];
    int32_t hub = size_u <= size_v ? u : v, rim = size_u <= size_v ? v : u;
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int32_t k = s->ring_begin[hub]; k < s->ring_begin[hub + 1]; ++k )
    {
        if ( has_point( s->triangles + 3 * (size_t)s->ring[k], rim ) )
        {
            triangle_corners t = mesh_surface_triangle( s, s->ring[k], time );
            sum = double3_mul_add( sum, 1.0, double3_unit_or_zero( triangle_normal( &t ) ) );
        }
    }
    return double3_unit_or_zero( sum );
}

static double3 find_pseudonormal( const mesh_surface* s, int32_t triangle, double time,
                                  const triangle_nearest* nearest )
{
    if ( nearest->first < 0 )
    {
        triangle_corners t = mesh_surface_triangle( s, triangle, time );
        return double3_unit_or_zero( triangle_normal( &t ) );
    }
    if ( nearest->second >= 0 )
    {
        return find_edge_normal( s, nearest->first, nearest->second, time );
    }
    return mesh_surface_corner_normal( s, nearest->first, time );
}

double3 mesh_surface_corner_normal( const mesh_surface* s, int32_t point, double time )
{
    return s->corner_normals != NULL ? double3_widen( s->corner_normals[point] )
                                     : find_corner_normal( s, point, time );
}

// Minimum distance from an edge or a corner, relative to coordinates, that gives a direction. Below it the
// direction is rounding error.
static const double TOO_CLOSE = 1e-12;

static double largest_of( double3 v )
{
    return fmax( fabs( v.x ), fmax( fabs( v.y ), fabs( v.z ) ) );
}

void mesh_surface_describe( const mesh_surface* s, int32_t triangle, double time, const triangle_nearest* nearest,
                            double3 p, wisp_mesh_nearest* out )
{
    double3 normal = find_pseudonormal( s, triangle, time, nearest ), away = double3_sub( p, nearest->point );
    double sign = double3_dot( away, normal ) < 0.0 ? -1.0 : 1.0, distance = sqrt( nearest->squared );
    bool is_face = nearest->first < 0;
    if ( !is_face && distance > TOO_CLOSE * fmax( largest_of( p ), largest_of( nearest->point ) ) )
    {
        normal = double3_scale( away, sign / distance );
    }
    // all incident triangles have no area: use a fixed direction
    if ( double3_dot( normal, normal ) == 0.0 )
    {
        normal.y = 1.0;
    }
    *out = ( wisp_mesh_nearest ){
        .triangle = triangle,
        .distance = (float)( sign * distance ),
        .point = double3_narrow( nearest->point ),
        .normal = double3_narrow( normal ),
        .weights = { (float)nearest->weights[0], (float)nearest->weights[1], (float)nearest->weights[2] },
    };
}

// ---- warnings ----

// Tests whether the edge u -> v belongs to this triangle only, and v -> u to exactly one other.
static bool is_closed_edge( const mesh_surface* s, int32_t u, int32_t v )
{
    int32_t size_u = s->ring_begin[u + 1] - s->ring_begin[u], size_v = s->ring_begin[v + 1] - s->ring_begin[v];
    int32_t hub = size_u <= size_v ? u : v;
    int along = 0, against = 0;
    for ( int32_t k = s->ring_begin[hub]; k < s->ring_begin[hub + 1]; ++k )
    {
        const int32_t* c = s->triangles + 3 * (size_t)s->ring[k];
        for ( int i = 0; i < 3; ++i )
        {
            along += c[i] == u && c[( i + 1 ) % 3] == v ? 1 : 0;
            against += c[i] == v && c[( i + 1 ) % 3] == u ? 1 : 0;
        }
    }
    return along == 1 && against == 1;
}

int mesh_surface_count_open_edges( const mesh_surface* s )
{
    int count = 0;
    for ( int k = 0; k < 3 * s->triangle_count; ++k )
    {
        int32_t u = s->triangles[k], v = s->triangles[k % 3 == 2 ? k - 2 : k + 1];
        count += u == v || is_closed_edge( s, u, v ) ? 0 : 1;
    }
    return count;
}

int mesh_surface_count_flat_triangles( const mesh_surface* s )
{
    int count = 0;
    for ( int32_t k = 0; k < s->triangle_count; ++k )
    {
        triangle_corners t = triangle_load( s->xyzw, s->triangles, k );
        double3 normal = triangle_normal( &t );
        count += double3_dot( normal, normal ) == 0.0 ? 1 : 0;
    }
    return count;
}
