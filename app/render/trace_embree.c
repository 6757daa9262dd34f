#include "trace.h"

#include "embree_compat.h"
#include "wisp/module/definition.h"
#include "wisp/module/vec.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- the drawn form of strands ----

// The drawn form of strands: how thick they are, and how hair bends between its points.

// Curves bend between their points, so hair is drawn with more pieces than it has segments.
static int curves_pieces( const render_curves* curves )
{
    const int pieces = 4;
    return curves->is_hair && curves->offsets[curves->strand_count] <= INT32_MAX / pieces ? pieces : 1;
}

// The least radius that is seen at a vertex.
static float seen_radius( const trace_widening* widening, const render_curves* curves, int vertex )
{
    return widening->radius_fraction * wisp_v3_length( wisp_v3_sub( curves->points[vertex], widening->eye ) );
}

float trace_radius( const trace_widening* widening, const render_curves* curves, int vertex )
{
    float radius = curves->radii != NULL ? curves->radii[vertex] : curves->radius;
    return fmaxf( radius, seen_radius( widening, curves, vertex ) );
}

// Hair that has one radius is pointed, as far as that is seen; each strand is a little thicker or thinner than the next.
static float drawn_radius( const trace_widening* widening, const render_curves* curves, int strand, int vertex )
{
    if ( !curves->is_hair )
    {
        return trace_radius( widening, curves, vertex );
    }
    float along = (float)( vertex - curves->offsets[strand] ) /
                  (float)( curves->offsets[strand + 1] - 1 - curves->offsets[strand] );
    float radius = curves->radii != NULL ? curves->radii[vertex] : curves->radius * ( 1.0f - 0.6f * along * along );
    wisp_random_key key = wisp_random_make_key( 0, 0, 1 );
    float fraction = 0.75f + 0.5f * wisp_random_unit_float( key, (uint32_t)strand, 0, 0 );
    return fraction * fmaxf( radius, seen_radius( widening, curves, vertex ) );
}

wisp_vec3 trace_tangent( const render_curves* curves, int strand, int vertex )
{
    const wisp_vec3 up = { 0.0f, 1.0f, 0.0f };
    int before = vertex > curves->offsets[strand] ? vertex - 1 : vertex;
    int behind = vertex + 1 < curves->offsets[strand + 1] ? vertex + 1 : vertex;
    return wisp_v3_normalize_or( wisp_v3_sub( curves->points[behind], curves->points[before] ), up );
}

// Hermite's curve with tangents as long as the segment: it never swings out, however unequal neighbours are.
static wisp_vec3 point_between( const render_curves* curves, int strand, int vertex, float t )
{
    wisp_vec3 a = curves->points[vertex], b = curves->points[vertex + 1];
    float length = wisp_v3_length( wisp_v3_sub( b, a ) );
    float s = 1.0f - t;
    wisp_vec3 sum = wisp_v3_scale( a, s * s * ( 1.0f + 2.0f * t ) );
    sum = wisp_v3_mul_add( sum, t * t * ( 1.0f + 2.0f * s ), b );
    sum = wisp_v3_mul_add( sum, length * s * s * t, trace_tangent( curves, strand, vertex ) );
    return wisp_v3_mul_add( sum, -length * t * t * s, trace_tangent( curves, strand, vertex + 1 ) );
}

static void put_vertex( float* out, wisp_vec3 point, float radius )
{
    out[0] = point.x;
    out[1] = point.y;
    out[2] = point.z;
    out[3] = radius;
}

// Vertex v of the curves is vertex v * pieces of the buffer, and the points between it and the next follow it.
static void fill_strand( const render_curves* curves, const trace_widening* widening, int strand, int pieces,
                         float* points )
{
    int last = curves->offsets[strand + 1] - 1;
    for ( int v = curves->offsets[strand]; v <= last; ++v )
    {
        float radius = last > curves->offsets[strand] ? drawn_radius( widening, curves, strand, v ) : 0.0f;
        float next = v < last ? drawn_radius( widening, curves, strand, v + 1 ) : radius;
        float* out = points + 4 * (size_t)v * (size_t)pieces;
        put_vertex( out, curves->points[v], radius );
        for ( int k = 1; k < pieces; ++k )
        {
            float t = (float)k / (float)pieces;
            wisp_vec3 point = v < last ? point_between( curves, strand, v, t ) : curves->points[v];
            put_vertex( out + 4 * k, point, radius + t * ( next - radius ) );
        }
    }
}

// Points of the pieces. Vertex v is point v * pieces, and the points between it and the next vertex follow it.
// @param points [vertex count * pieces][4]: x, y, z, radius
static void curves_fill( const render_curves* curves, const trace_widening* widening, float* points )
{
    const int pieces = curves_pieces( curves );
    for ( int s = 0; s < curves->strand_count; ++s )
    {
        fill_strand( curves, widening, s, pieces, points );
    }
}

// ---- trees and rays ----

// The only file that uses Embree.

// Embree's own limit is 1.8e18; every distance of a scene that was checked lies far below.
#define FARTHEST 1e18f

struct trace_tree
{
    RTCDevice device;
    RTCScene scene;
    int mesh_count, curves_count;
    const unsigned** segments; // [curves_count] first vertex of each segment, in Embree's own index buffers
    int* pieces;               // [curves_count] straight pieces of a segment
    wisp_vec3 cut_normal;      // bodies are there where cut_normal . p <= cut_offset; zero: everywhere
    float cut_offset;
    enum RTCError reason; // of the first error since the device was made
    char words[200];      // with Embree's message
};

// Embree keeps an error per thread until it is queried; only the callback receives all of them.
static void remember_error( void* user, enum RTCError code, const char* words )
{
    trace_tree* tree = user;
    if ( tree->reason == RTC_ERROR_NONE )
    {
        tree->reason = code;
        snprintf( tree->words, sizeof( tree->words ), "%s", words != NULL ? words : "" );
    }
}

static wisp_status embree_fault( const trace_tree* tree, wisp_error* error )
{
    if ( tree->reason == RTC_ERROR_NONE )
    {
        return WISP_OK;
    }
    if ( tree->reason == RTC_ERROR_OUT_OF_MEMORY )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "picture: out of memory for the trees of the ray tracer" );
    }
    return wisp_fail( error, WISP_CONFLICT, "picture: the ray tracer refuses with error %d: %s", (int)tree->reason,
                      tree->words );
}

// ---- geometry --------------------------------------------------------------------------------------------------

// Buffers are Embree's own, which pads them: it reads a vertex of three floats as sixteen bytes, the last one too.
static void* new_buffer( RTCGeometry geometry, enum RTCBufferType type, enum RTCFormat format, size_t stride,
                         size_t count )
{
    return rtcSetNewGeometryBuffer( geometry, type, 0, format, stride, count );
}

// Takes ownership of the geometry, also after a failure.
static void attach( trace_tree* tree, RTCGeometry geometry, int body )
{
    embree_show_always( geometry );
    rtcCommitGeometry( geometry );
    rtcAttachGeometryByID( tree->scene, geometry, (unsigned)body );
    rtcReleaseGeometry( geometry );
}

static wisp_status add_mesh( trace_tree* tree, const render_mesh* mesh, int body, wisp_error* error )
{
    if ( mesh->triangle_count == 0 )
    {
        return WISP_OK;
    }
    RTCGeometry geometry = rtcNewGeometry( tree->device, RTC_GEOMETRY_TYPE_TRIANGLE );
    if ( geometry == NULL )
    {
        return embree_fault( tree, error );
    }
    size_t vertices = (size_t)mesh->vertex_count, triangles = (size_t)mesh->triangle_count;
    void* points = new_buffer( geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof( wisp_vec3 ), vertices );
    void* indices =
        new_buffer( geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 3 * sizeof( uint32_t ), triangles );
    if ( points != NULL && indices != NULL )
    {
        memcpy( points, mesh->points, vertices * sizeof( wisp_vec3 ) );
        memcpy( indices, mesh->triangles, triangles * 3 * sizeof( uint32_t ) );
        attach( tree, geometry, body );
    }
    else
    {
        rtcReleaseGeometry( geometry );
    }
    return embree_fault( tree, error );
}

static size_t count_segments( const render_curves* curves )
{
    size_t count = 0;
    for ( int s = 0; s < curves->strand_count; ++s )
    {
        int vertices = curves->offsets[s + 1] - curves->offsets[s];
        count += vertices > 1 ? (size_t)( vertices - 1 ) : 0;
    }
    return count;
}

typedef struct curve_buffers
{
    float* points;    // x, y, z, radius
    unsigned* first;  // vertex of each segment
    uint8_t* borders; // which ends of a segment have a neighbour, so that joints are round and ends are not doubled
} curve_buffers;

// The cone around a piece that is far shorter than its radius has an axis of rounding errors, and is hit metres away.
static bool is_drawn( const curve_buffers* buffers, int piece )
{
    const float* a = buffers->points + 4 * (size_t)piece;
    const float* b = a + 4;
    const wisp_vec3 along = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    return wisp_v3_length( along ) > 1e-2f * fmaxf( a[3], b[3] );
}

// Pieces that are not drawn are another one drawn twice, since the buffers have a place for each.
// @return false if none is drawn
static bool fill_curves( const render_curves* curves, const trace_widening* widening, int pieces,
                         const curve_buffers* out )
{
    curves_fill( curves, widening, out->points );
    size_t k = 0, undrawn = 0; // of them, those before the first that is drawn
    for ( int s = 0; s < curves->strand_count; ++s )
    {
        int begin = curves->offsets[s] * pieces, last = ( curves->offsets[s + 1] - 1 ) * pieces;
        for ( int v = begin; v < last; ++v, ++k )
        {
            bool has_left = v > begin && is_drawn( out, v - 1 ), has_right = v + 1 < last && is_drawn( out, v + 1 );
            unsigned left = has_left ? RTC_CURVE_FLAG_NEIGHBOR_LEFT : 0u;
            unsigned right = has_right ? RTC_CURVE_FLAG_NEIGHBOR_RIGHT : 0u;
            bool is_known = is_drawn( out, v );
            out->first[k] = is_known || k == undrawn ? (unsigned)v : out->first[k - 1];
            out->borders[k] = is_known || k == undrawn ? (uint8_t)( left | right ) : out->borders[k - 1];
            undrawn += !is_known && k == undrawn;
        }
    }
    for ( size_t i = 0; i < undrawn && undrawn < k; ++i )
    {
        out->first[i] = out->first[undrawn];
        out->borders[i] = out->borders[undrawn];
    }
    return undrawn < k;
}

static wisp_status add_curves( trace_tree* tree, const render_curves* curves, int number,
                               const trace_widening* widening, wisp_error* error )
{
    int pieces = curves_pieces( curves );
    size_t segments = count_segments( curves ) * (size_t)pieces;
    if ( segments == 0 )
    {
        return WISP_OK;
    }
    RTCGeometry geometry = rtcNewGeometry( tree->device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE );
    if ( geometry == NULL )
    {
        return embree_fault( tree, error );
    }
    size_t vertices = (size_t)curves->offsets[curves->strand_count] * (size_t)pieces;
    curve_buffers buffers = {
        new_buffer( geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4 * sizeof( float ), vertices ),
        new_buffer( geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, sizeof( unsigned ), segments ),
        new_buffer( geometry, RTC_BUFFER_TYPE_FLAGS, RTC_FORMAT_UCHAR, sizeof( uint8_t ), segments ),
    };
    if ( buffers.points != NULL && buffers.first != NULL && buffers.borders != NULL )
    {
        tree->segments[number] = buffers.first;
        tree->pieces[number] = pieces;
        if ( fill_curves( curves, widening, pieces, &buffers ) )
        {
            attach( tree, geometry, tree->mesh_count + number );
        }
        else
        {
            rtcReleaseGeometry( geometry );
        }
    }
    else
    {
        rtcReleaseGeometry( geometry );
    }
    return embree_fault( tree, error );
}

static wisp_status add_points( trace_tree* tree, const render_points* points, int body, wisp_error* error )
{
    if ( points->count == 0 )
    {
        return WISP_OK;
    }
    RTCGeometry geometry = rtcNewGeometry( tree->device, RTC_GEOMETRY_TYPE_SPHERE_POINT );
    if ( geometry == NULL )
    {
        return embree_fault( tree, error );
    }
    float* balls =
        new_buffer( geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4 * sizeof( float ), (size_t)points->count );
    if ( balls == NULL )
    {
        rtcReleaseGeometry( geometry );
        return embree_fault( tree, error );
    }
    for ( int i = 0; i < points->count; ++i )
    {
        float* ball = balls + 4 * (size_t)i;
        ball[0] = points->points[i].x;
        ball[1] = points->points[i].y;
        ball[2] = points->points[i].z;
        ball[3] = points->radius;
    }
    attach( tree, geometry, body );
    return embree_fault( tree, error );
}

// ---- the tree --------------------------------------------------------------------------------------------------

// One thread builds: trees that several threads build may differ, and so would the hits where two surfaces meet.
static wisp_status open_device( trace_tree* tree, wisp_error* error )
{
    tree->device = rtcNewDevice( "threads=1" );
    if ( tree->device == NULL )
    {
        return wisp_fail( error, WISP_CONFLICT, "picture: the ray tracer does not start, error %d",
                          (int)rtcGetDeviceError( NULL ) );
    }
    rtcSetDeviceErrorFunction( tree->device, remember_error, tree );
    tree->scene = rtcNewScene( tree->device );
    if ( tree->scene != NULL )
    {
        // Robust: without it rays slip through between two triangles that share an edge.
        rtcSetSceneFlags( tree->scene, RTC_SCENE_FLAG_ROBUST );
        rtcSetSceneBuildQuality( tree->scene, RTC_BUILD_QUALITY_MEDIUM );
    }
    return embree_fault( tree, error );
}

static wisp_status fill( trace_tree* tree, const render_scene* scene, const trace_widening* widening,
                         wisp_error* error )
{
    WISP_TRY( open_device( tree, error ) );
    for ( int i = 0; i < scene->mesh_count; ++i )
    {
        WISP_TRY( add_mesh( tree, &scene->meshes[i], i, error ) );
    }
    for ( int i = 0; i < scene->curves_count; ++i )
    {
        WISP_TRY( add_curves( tree, &scene->curves[i], i, widening, error ) );
    }
    for ( int i = 0; i < scene->points_count; ++i )
    {
        WISP_TRY( add_points( tree, &scene->points[i], scene->mesh_count + scene->curves_count + i, error ) );
    }
    rtcCommitScene( tree->scene );
    return embree_fault( tree, error );
}

wisp_status trace_build( const render_scene* scene, const trace_widening* widening, trace_tree** out,
                         wisp_error* error )
{
    trace_tree* tree = calloc( 1, sizeof( trace_tree ) );
    const unsigned** segments = calloc( (size_t)scene->curves_count + 1, sizeof( *segments ) );
    int* pieces = calloc( (size_t)scene->curves_count + 1, sizeof( *pieces ) );
    if ( tree == NULL || segments == NULL || pieces == NULL )
    {
        free( tree );
        free( segments );
        free( pieces );
        return wisp_fail( error, WISP_NO_MEMORY, "picture: out of memory for %d bodies",
                          scene->mesh_count + scene->curves_count + scene->points_count );
    }
    tree->segments = segments;
    tree->pieces = pieces;
    float steep = wisp_v3_length( scene->cut_normal );
    if ( steep > 0.0f )
    {
        tree->cut_normal = wisp_v3_scale( scene->cut_normal, 1.0f / steep );
        tree->cut_offset = scene->cut_offset / steep;
    }
    tree->mesh_count = scene->mesh_count;
    tree->curves_count = scene->curves_count;
    wisp_status status = fill( tree, scene, widening, error );
    if ( status != WISP_OK )
    {
        trace_release( tree );
        return status;
    }
    *out = tree;
    return WISP_OK;
}

void trace_release( trace_tree* tree )
{
    if ( tree == NULL )
    {
        return;
    }
    if ( tree->scene != NULL )
    {
        rtcReleaseScene( tree->scene );
    }
    if ( tree->device != NULL )
    {
        rtcReleaseDevice( tree->device );
    }
    free( tree->segments );
    free( tree->pieces );
    free( tree );
}

// ---- rays ------------------------------------------------------------------------------------------------------

static bool is_within( wisp_vec3 v, float limit )
{
    return fabsf( v.x ) <= limit && fabsf( v.y ) <= limit && fabsf( v.z ) <= limit;
}

// Written so that NaN fails.
static bool is_a_ray( const trace_ray* ray )
{
    return is_within( ray->origin, FARTHEST ) && is_within( ray->direction, 2.0f ) && ray->far > 0.0f;
}

// The part of a ray that is on the drawn side of the cut.
static bool keep_uncut( const trace_tree* tree, struct RTCRay* ray )
{
    wisp_vec3 origin = { ray->org_x, ray->org_y, ray->org_z }, direction = { ray->dir_x, ray->dir_y, ray->dir_z };
    float outside = wisp_v3_dot( tree->cut_normal, origin ) - tree->cut_offset;
    float rise = wisp_v3_dot( tree->cut_normal, direction );
    if ( rise == 0.0f )
    {
        return outside <= 0.0f || wisp_v3_dot( tree->cut_normal, tree->cut_normal ) == 0.0f;
    }
    float crossing = -outside / rise;
    ray->tfar = rise > 0.0f ? fminf( ray->tfar, crossing ) : ray->tfar;
    ray->tnear = rise < 0.0f ? fmaxf( ray->tnear, crossing ) : ray->tnear;
    return ray->tnear < ray->tfar && ray->tnear <= FARTHEST;
}

// @return false if nothing can be on the ray
static bool embree_ray( const trace_tree* tree, const trace_ray* ray, struct RTCRay* out )
{
    if ( !is_a_ray( ray ) )
    {
        return false;
    }
    *out = ( struct RTCRay ){
        .org_x = ray->origin.x,
        .org_y = ray->origin.y,
        .org_z = ray->origin.z,
        .dir_x = ray->direction.x,
        .dir_y = ray->direction.y,
        .dir_z = ray->direction.z,
        .tfar = ray->far,
        .mask = 0xFFFFFFFFu,
    };
    return keep_uncut( tree, out );
}

// Hair has several pieces to a segment: back to the segment and the place along it.
static void place_on_segment( const trace_tree* tree, trace_hit* hit )
{
    int number = hit->body - tree->mesh_count;
    if ( number >= 0 && number < tree->curves_count )
    {
        int piece = (int)tree->segments[number][hit->primitive], pieces = tree->pieces[number];
        hit->primitive = piece / pieces;
        hit->u = ( (float)( piece % pieces ) + hit->u ) / (float)pieces;
    }
}

bool trace_nearest( const trace_tree* tree, const trace_ray* ray, trace_hit* hit )
{
    struct RTCRayHit found;
    if ( !embree_ray( tree, ray, &found.ray ) )
    {
        return false;
    }
    found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect( tree->scene, &found );
    if ( found.hit.geomID == RTC_INVALID_GEOMETRY_ID )
    {
        return false;
    }
    *hit = ( trace_hit ){
        .distance = found.ray.tfar,
        .body = (int)found.hit.geomID,
        .primitive = (int)found.hit.primID,
        .u = found.hit.u,
        .v = found.hit.v,
        .normal = wisp_v3_normalize_or( ( wisp_vec3 ){ found.hit.Ng_x, found.hit.Ng_y, found.hit.Ng_z },
                                        wisp_v3_scale( ray->direction, -1.0f ) ),
    };
    place_on_segment( tree, hit );
    return true;
}

bool trace_blocked( const trace_tree* tree, const trace_ray* ray )
{
    struct RTCRay shadow;
    if ( !embree_ray( tree, ray, &shadow ) )
    {
        return false;
    }
    embree_occluded( tree->scene, &shadow );
    return shadow.tfar < 0.0f;
}
