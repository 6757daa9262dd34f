// Strands around other strands: each is its target moved by an offset, uniform in a disc across the root's direction.
#include "groom_internal.h"
#include "scene.h"

#include <math.h>

#include "trig.h"
#include "wisp/module/definition.h"
#include "wisp/module/random.h"

static const float TWO_PI = 6.28318531f;

enum
{
    RANDOM_STREAM = 0x73636174, // any number that no other stream of the program has
    DRAW_DISTANCE = 0,
    DRAW_TURN = 1,
};

// Where a strand sets out: along its first segment that has a length; upwards if none has one.
static wisp_vec3 root_direction( const wisp_vec3* points, int count )
{
    for ( int v = 1; v < count; ++v )
    {
        wisp_vec3 d = { points[v].x - points[0].x, points[v].y - points[0].y, points[v].z - points[0].z };
        float length = sqrtf( d.x * d.x + d.y * d.y + d.z * d.z );
        if ( length > 0.0f )
        {
            return ( wisp_vec3 ){ d.x / length, d.y / length, d.z / length };
        }
    }
    return ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f };
}

// A unit vector across another (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"), and the third one.
static void across( wisp_vec3 n, wisp_vec3* a, wisp_vec3* b )
{
    float sign = copysignf( 1.0f, n.z );
    float s = -1.0f / ( sign + n.z ), t = n.x * n.y * s;
    *a = ( wisp_vec3 ){ 1.0f + sign * n.x * n.x * s, sign * t, -sign * n.x };
    *b = ( wisp_vec3 ){ t, sign + n.y * n.y * s, -n.y };
}

// Areas are equal where the square of the distance is uniform. In the plane a disc is a line across the root.
static wisp_vec3 draw_offset( const wisp_scene_scatter* scatter, wisp_random_key key, int target, int k,
                              wisp_vec3 direction, int dimension )
{
    float u = wisp_random_unit_float( key, (uint32_t)target, (uint32_t)k, DRAW_DISTANCE );
    if ( dimension == 2 )
    {
        float aside = scatter->radius * ( 2.0f * u - 1.0f );
        return ( wisp_vec3 ){ aside * direction.y, -aside * direction.x, 0.0f };
    }
    float turn = wisp_random_unit_float( key, (uint32_t)target, (uint32_t)k, DRAW_TURN );
    float distance = scatter->radius * sqrtf( u ), sine, cosine;
    trig_sincos( TWO_PI * turn, &sine, &cosine );
    float p = distance * cosine, q = distance * sine;
    wisp_vec3 a, b;
    across( direction, &a, &b );
    return ( wisp_vec3 ){ p * a.x + q * b.x, p * a.y + q * b.y, p * a.z + q * b.z };
}

// Makes the strands around one target, from vertex `at` on. @return the vertex after the last one
static int scatter_around( const wisp_scene_scatter* scatter, wisp_random_key key, const wisp_groom* source,
                           int target, int at, wisp_groom* out )
{
    const int first = source->offsets[target], count = source->offsets[target + 1] - first;
    const wisp_vec3* points = source->points + first;
    const wisp_vec3 direction = root_direction( points, count );
    for ( int k = 0; k < scatter->count; ++k )
    {
        wisp_vec3 offset = draw_offset( scatter, key, target, k, direction, source->dimension );
        out->offsets[target * scatter->count + k] = at;
        for ( int v = 0; v < count; ++v, ++at )
        {
            out->points[at] = ( wisp_vec3 ){ points[v].x + offset.x, points[v].y + offset.y, points[v].z + offset.z };
            if ( out->thickness )
            {
                out->thickness[at] = source->thickness[first + v];
            }
            if ( out->colour )
            {
                out->colour[at] = source->colour[first + v];
            }
        }
    }
    return at;
}

wisp_status wisp_scene_make_scatter( const wisp_scene_scatter* scatter, const wisp_groom* source, wisp_groom* out,
                                     wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    const int64_t strands = (int64_t)source->strand_count * scatter->count;
    const int64_t vertices = (int64_t)source->vertex_count * scatter->count;
    if ( strands > WISP_GROOM_MAX_GENERATED || vertices > WISP_GROOM_MAX_GENERATED )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%d strands around each of %d have %lld vertices, expected at most %d", scatter->count,
                          source->strand_count, (long long)vertices, WISP_GROOM_MAX_GENERATED );
    }
    int columns = ( source->thickness ? GROOM_THICKNESS : 0 ) | ( source->colour ? GROOM_COLOUR : 0 );
    WISP_TRY( groom_allocate( out, (int)strands, (int)vertices, columns, "scatter", error ) );
    const wisp_random_key key = wisp_random_make_key( scatter->seed, RANDOM_STREAM, 0 );
    int at = 0;
    for ( int target = 0; target < source->strand_count; ++target )
    {
        at = scatter_around( scatter, key, source, target, at, out );
    }
    out->offsets[strands] = at;
    out->dimension = source->dimension;
    return WISP_OK;
}
