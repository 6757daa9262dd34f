// The drawn form of strands: how thick they are, and how hair bends between its points.
#include "curves.h"

#include "vec.h"
#include "wisp/module/random.h"

#include <math.h>

// Curves bend between their points, so hair is drawn with more pieces than it has segments.
int curves_pieces( const render_curves* curves )
{
    const int pieces = 4;
    return curves->is_hair && curves->offsets[curves->strand_count] <= INT32_MAX / pieces ? pieces : 1;
}

// The least radius that is seen at a vertex.
static float seen_radius( const trace_widening* widening, const render_curves* curves, int vertex )
{
    return widening->radius_fraction * v3_length( v3_sub( curves->points[vertex], widening->eye ) );
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
    return v3_normalize_or( v3_sub( curves->points[behind], curves->points[before] ), up );
}

// Hermite's curve with tangents as long as the segment: it never swings out, however unequal neighbours are.
static wisp_vec3 point_between( const render_curves* curves, int strand, int vertex, float t )
{
    wisp_vec3 a = curves->points[vertex], b = curves->points[vertex + 1];
    float length = v3_length( v3_sub( b, a ) );
    float s = 1.0f - t;
    wisp_vec3 sum = v3_scale( a, s * s * ( 1.0f + 2.0f * t ) );
    sum = v3_mul_add( sum, t * t * ( 1.0f + 2.0f * s ), b );
    sum = v3_mul_add( sum, length * s * s * t, trace_tangent( curves, strand, vertex ) );
    return v3_mul_add( sum, -length * t * t * s, trace_tangent( curves, strand, vertex + 1 ) );
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

void curves_fill( const render_curves* curves, const trace_widening* widening, float* points )
{
    const int pieces = curves_pieces( curves );
    for ( int s = 0; s < curves->strand_count; ++s )
    {
        fill_strand( curves, widening, s, pieces, points );
    }
}
