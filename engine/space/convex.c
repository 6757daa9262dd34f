// Convex polyhedra. In: points. Out: triangles of their hull with planes; closest points; entries of paths.
//
// - The hull grows point by point: a point outside of some triangles replaces them by the triangles between their horizon and the
//   point (incremental hull; de Berg et al. 2008, chapter 11). At the end all points are compared with all planes.
// - Inside, the closest point is on the plane with the largest signed distance. Outside, it is the closest of the triangles
//   whose planes the point is in front of; a triangle farther than the best one by its plane alone is skipped. That is exact on
//   faces, edges and vertices, and a body of a dozen faces costs a dozen planes.
#include "solid.h"

#include "alloc.h"

#include <string.h>

typedef struct convex_face
{
    double3 normal;
    double offset; // m, of the plane along the normal
    double3 corner[3];
} convex_face;

struct wisp_convex
{
    wisp_allocator allocator;
    size_t bytes;
    double tolerance; // m
    int face_count;
    convex_face* faces;
    int32_t ( *triangles )[3];
};

// ---- hull ----

typedef struct hull
{
    const wisp_vec3* points;
    int count, triangle_count, capacity;
    int32_t ( *triangles )[3];
    int32_t ( *edges )[2]; // of the triangles that a point sees
    double tolerance;
} hull;

static convex_face face_of( const wisp_vec3* points, const int32_t t[3] )
{
    convex_face f;
    for ( int k = 0; k < 3; ++k )
    {
        f.corner[k] = double3_widen( points[t[k]] );
    }
    f.normal = double3_unit_or_zero(
        double3_cross( double3_sub( f.corner[1], f.corner[0] ), double3_sub( f.corner[2], f.corner[0] ) ) );
    f.offset = double3_dot( f.normal, f.corner[0] );
    return f;
}

static double in_front( const convex_face* f, double3 p )
{
    return double3_dot( f->normal, p ) - f->offset;
}

// Finds the point farthest from a point, a line or a plane, by how many are given.
static int farthest( const hull* h, const int32_t* given, int count, double* distance )
{
    const double3 a = double3_widen( h->points[given[0]] );
    const double3 b = double3_widen( h->points[given[count > 1 ? 1 : 0]] );
    const double3 c = double3_widen( h->points[given[count > 2 ? 2 : 0]] );
    const double3 line = double3_unit_or_zero( double3_sub( b, a ) );
    const double3 normal = double3_unit_or_zero( double3_cross( line, double3_sub( c, a ) ) );
    int best = 0;
    *distance = -1.0;
    for ( int i = 0; i < h->count; ++i )
    {
        const double3 d = double3_sub( double3_widen( h->points[i] ), a );
        const double far = count == 1   ? double3_length( d )
                           : count == 2 ? double3_length( double3_mul_add( d, -double3_dot( d, line ), line ) )
                                        : fabs( double3_dot( d, normal ) );
        best = far > *distance ? i : best;
        *distance = far > *distance ? far : *distance;
    }
    return best;
}

// Starts with a tetrahedron. @return false if all points are in a plane
static bool begin_hull( hull* h )
{
    int32_t v[4] = { 0 };
    double distance;
    v[0] = farthest( h, v, 1, &distance );
    for ( int i = 1; i < 4; ++i )
    {
        v[i] = farthest( h, v, i, &distance );
        h->tolerance = i == 1 ? 1e-6 * distance : h->tolerance;
        if ( !( distance > 2.0 * h->tolerance ) )
        {
            return false;
        }
    }
    const convex_face base = face_of( h->points, v );
    const bool is_above = in_front( &base, double3_widen( h->points[v[3]] ) ) > 0.0;
    const int32_t b = is_above ? v[2] : v[1], c = is_above ? v[1] : v[2];
    const int32_t all[4][3] = { { v[0], b, c }, { v[0], v[3], b }, { b, v[3], c }, { c, v[3], v[0] } };
    memcpy( h->triangles, all, sizeof( all ) );
    h->triangle_count = 4;
    return true;
}

// Removes the triangles that see the point, and collects their edges.
static int remove_visible( hull* h, double3 p )
{
    int kept = 0, edges = 0;
    for ( int t = 0; t < h->triangle_count; ++t )
    {
        const int32_t v[3] = { h->triangles[t][0], h->triangles[t][1], h->triangles[t][2] };
        const convex_face f = face_of( h->points, v );
        if ( in_front( &f, p ) > h->tolerance )
        {
            for ( int k = 0; k < 3; ++k, ++edges )
            {
                h->edges[edges][0] = v[k];
                h->edges[edges][1] = v[( k + 1 ) % 3];
            }
            continue;
        }
        memcpy( h->triangles[kept++], v, sizeof( v ) );
    }
    h->triangle_count = kept;
    return edges;
}

static void add_point( hull* h, int point )
{
    const int edges = remove_visible( h, double3_widen( h->points[point] ) );
    for ( int e = 0; e < edges; ++e )
    {
        bool is_inner = false;
        for ( int o = 0; o < edges; ++o )
        {
            is_inner |= h->edges[e][0] == h->edges[o][1] && h->edges[e][1] == h->edges[o][0];
        }
        if ( is_inner == false && h->triangle_count < h->capacity )
        {
            const int32_t t[3] = { h->edges[e][0], h->edges[e][1], point };
            memcpy( h->triangles[h->triangle_count++], t, sizeof( t ) );
        }
    }
}

// The hull holds all points, and each edge is in two triangles.
static bool is_hull( const hull* h )
{
    for ( int t = 0; t < h->triangle_count; ++t )
    {
        const convex_face f = face_of( h->points, h->triangles[t] );
        for ( int i = 0; i < h->count; ++i )
        {
            if ( in_front( &f, double3_widen( h->points[i] ) ) > 4.0 * h->tolerance )
            {
                return false;
            }
        }
        for ( int k = 0; k < 3; ++k )
        {
            int twins = 0;
            for ( int o = 0; o < 3 * h->triangle_count; ++o )
            {
                const int32_t *other = h->triangles[o / 3], begin = other[o % 3], end = other[( o + 1 ) % 3];
                twins += begin == h->triangles[t][( k + 1 ) % 3] && end == h->triangles[t][k] ? 1 : 0;
            }
            if ( twins != 1 )
            {
                return false;
            }
        }
    }
    return h->triangle_count >= 4;
}

static wisp_status make_hull( hull* h, wisp_error* error )
{
    if ( begin_hull( h ) == false )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "convex: the %d points lie in a plane, so nothing is inside",
                          h->count );
    }
    for ( int i = 0; i < h->count; ++i )
    {
        add_point( h, i );
    }
    return is_hull( h )
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT,
                            "convex: no hull of the %d points is known to a millionth of their extent", h->count );
}

static wisp_status copy_hull( const hull* h, const wisp_allocator* allocator, wisp_convex** out, wisp_error* error )
{
    const size_t n = (size_t)h->triangle_count;
    const size_t bytes = sizeof( wisp_convex ) + n * ( sizeof( convex_face ) + sizeof( int32_t[3] ) );
    wisp_convex* convex = base_allocate( allocator, bytes, BASE_BUFFER_ALIGNMENT );
    if ( convex == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "convex: out of memory for %d triangles", h->triangle_count );
    }
    *convex = ( wisp_convex ){ allocator != NULL ? *allocator : ( wisp_allocator ){ 0 },
                               bytes,
                               h->tolerance,
                               h->triangle_count,
                               (convex_face*)( convex + 1 ),
                               NULL };
    convex->triangles = ( int32_t( * )[3] )( convex->faces + n );
    for ( size_t t = 0; t < n; ++t )
    {
        convex->faces[t] = face_of( h->points, h->triangles[t] );
        memcpy( convex->triangles[t], h->triangles[t], sizeof( int32_t[3] ) );
    }
    *out = convex;
    return WISP_OK;
}

wisp_status wisp_convex_create( const wisp_vec3* points, int count, const wisp_allocator* allocator,
                                wisp_convex** out, wisp_error* error )
{
    *out = NULL;
    if ( points == NULL || count < 4 || count > WISP_CONVEX_MAX_POINTS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "convex: got %d points, expected 4 to %d",
                          points != NULL ? count : 0, WISP_CONVEX_MAX_POINTS );
    }
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 p = points[i];
        if ( !( fabsf( p.x ) <= 1e9f && fabsf( p.y ) <= 1e9f && fabsf( p.z ) <= 1e9f ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "convex: point %d, (%g, %g, %g), is not within 1e9 m of 0", i,
                              (double)p.x, (double)p.y, (double)p.z );
        }
    }
    hull h = { .points = points, .count = count, .capacity = 4 * count };
    const size_t triangles = (size_t)h.capacity * sizeof( int32_t[3] ),
                 edges = 6 * (size_t)h.capacity * sizeof( int32_t );
    char* scratch = base_allocate( allocator, triangles + edges, BASE_BUFFER_ALIGNMENT );
    if ( scratch == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "convex: out of memory for %d points", count );
    }
    h.triangles = (int32_t( * )[3])scratch;
    h.edges = ( int32_t( * )[2] )( scratch + triangles );
    wisp_status status = make_hull( &h, error );
    status = status == WISP_OK ? copy_hull( &h, allocator, out, error ) : status;
    base_release( allocator, scratch, triangles + edges );
    return status;
}

void wisp_convex_release( wisp_convex* convex )
{
    if ( convex != NULL )
    {
        const wisp_allocator allocator = convex->allocator;
        base_release( &allocator, convex, convex->bytes );
    }
}

size_t wisp_convex_bytes( const wisp_convex* convex )
{
    return convex != NULL ? convex->bytes : 0;
}

int wisp_convex_triangles( const wisp_convex* convex, const int32_t** triangles )
{
    *triangles = convex->triangles[0];
    return convex->face_count;
}

wisp_vec3 wisp_convex_corner( const wisp_convex* convex, int triangle, int corner )
{
    return double3_narrow( convex->faces[triangle].corner[corner] );
}

// ---- closest points ----

double3 closest_on_triangle( double3 p, double3 a, double3 b, double3 c )
{
    const double3 ab = double3_sub( b, a ), ac = double3_sub( c, a ), ap = double3_sub( p, a );
    const double d1 = double3_dot( ab, ap ), d2 = double3_dot( ac, ap );
    if ( d1 <= 0.0 && d2 <= 0.0 )
    {
        return a;
    }
    const double3 bp = double3_sub( p, b );
    const double d3 = double3_dot( ab, bp ), d4 = double3_dot( ac, bp );
    if ( d3 >= 0.0 && d4 <= d3 )
    {
        return b;
    }
    const double vc = d1 * d4 - d3 * d2;
    if ( vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 )
    {
        return double3_mul_add( a, d1 / ( d1 - d3 ), ab );
    }
    const double3 cp = double3_sub( p, c );
    const double d5 = double3_dot( ab, cp ), d6 = double3_dot( ac, cp );
    if ( d6 >= 0.0 && d5 <= d6 )
    {
        return c;
    }
    const double vb = d5 * d2 - d1 * d6;
    if ( vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 )
    {
        return double3_mul_add( a, d2 / ( d2 - d6 ), ac );
    }
    const double va = d3 * d6 - d5 * d4;
    if ( va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 )
    {
        return double3_mul_add( b, ( d4 - d3 ) / ( ( d4 - d3 ) + ( d5 - d6 ) ), double3_sub( c, b ) );
    }
    const double scale = 1.0 / ( va + vb + vc );
    return double3_mul_add( double3_mul_add( a, vb * scale, ab ), vc * scale, ac );
}

void convex_closest( const wisp_convex* convex, double3 p, wisp_surface_point* s )
{
    int deepest = 0;
    double most = -INFINITY;
    for ( int f = 0; f < convex->face_count; ++f )
    {
        const double distance = in_front( convex->faces + f, p );
        deepest = distance > most ? f : deepest;
        most = distance > most ? distance : most;
    }
    const double3 normal = convex->faces[deepest].normal;
    // inside, or so near to the surface that a difference of points has no direction
    if ( most <= 1e-3 * convex->tolerance )
    {
        *s = ( wisp_surface_point ){ double3_narrow( double3_mul_add( p, -most, normal ) ), double3_narrow( normal ),
                                     (float)most };
        if ( most <= 0.0 )
        {
            return;
        }
    }
    double least = INFINITY;
    double3 nearest = p;
    for ( int f = 0; f < convex->face_count; ++f )
    {
        const convex_face* face = convex->faces + f;
        const double apart = in_front( face, p );
        if ( apart > 0.0 && apart * apart < least )
        {
            const double3 q = closest_on_triangle( p, face->corner[0], face->corner[1], face->corner[2] );
            const double3 d = double3_sub( p, q );
            const double squared = double3_dot( d, d );
            nearest = squared < least ? q : nearest;
            least = squared < least ? squared : least;
        }
    }
    const double distance = sqrt( least );
    if ( distance > 1e-3 * convex->tolerance )
    {
        *s = ( wisp_surface_point ){ double3_narrow( nearest ),
                                     double3_narrow( double3_scale( double3_sub( p, nearest ), 1.0 / distance ) ),
                                     (float)distance };
    }
}

// ---- paths ----

// Finds the plane that is entered last, before any is left.
double convex_enter( const wisp_convex* convex, double3 from, double3 step, double3* normal )
{
    double enter = -1.0, leave = SOLID_NEVER;
    for ( int f = 0; f < convex->face_count; ++f )
    {
        const convex_face* face = convex->faces + f;
        const double distance = in_front( face, from ), speed = double3_dot( face->normal, step );
        if ( speed == 0.0 )
        {
            leave = distance > 0.0 ? -1.0 : leave;
            continue;
        }
        const double time = -distance / speed;
        if ( speed < 0.0 && time > enter )
        {
            enter = time;
            *normal = face->normal;
        }
        leave = speed > 0.0 && time < leave ? time : leave;
    }
    return enter >= 0.0 && enter <= leave ? enter : SOLID_NEVER;
}
