// Curves through strands as they start: before the first step no pass has drawn any. What a curve is stands in
// guide_hair.h; this is the same cubic, so that the first frame of a recording fits those that follow.
#include "groom_internal.h"
#include "scene.h"

#include "wisp/module/definition.h"

#include <math.h>

static wisp_vec3 mix( float a, wisp_vec3 p, float b, wisp_vec3 q )
{
    return ( wisp_vec3 ){ a * p.x + b * q.x, a * p.y + b * q.y, a * p.z + b * q.z };
}

/// Control points of a cubic in Bezier form.
typedef struct cubic
{
    wisp_vec3 control[4];
} cubic;

static wisp_vec3 cubic_at( const cubic* c, float t )
{
    float s = 1.0f - t;
    return mix( 1.0f, mix( s * s * s, c->control[0], 3.0f * s * s * t, c->control[1] ), 1.0f,
                mix( 3.0f * s * t * t, c->control[2], t * t * t, c->control[3] ) );
}

// Half the way between neighbours; one-sided at the ends.
static wisp_vec3 tangent( const wisp_vec3* points, int count, int k )
{
    int before = k > 0 ? k - 1 : 0, after = k < count - 1 ? k + 1 : count - 1;
    float fraction = 1.0f / (float)( after - before );
    return mix( fraction, points[after], -fraction, points[before] );
}

static cubic smooth_cubic( const wisp_vec3* points, int count, int k )
{
    const float third = 1.0f / 3.0f;
    return ( cubic ){ { points[k], mix( 1.0f, points[k], third, tangent( points, count, k ) ),
                        mix( 1.0f, points[k + 1], -third, tangent( points, count, k + 1 ) ), points[k + 1] } };
}

// Four vertices that share their ends; what is left over at the tip is a quadratic or a line.
static cubic group_cubic( const wisp_vec3* points, int count, int group )
{
    const wisp_vec3* p = points + 3 * group;
    const float third = 1.0f / 3.0f, rest = 2.0f / 3.0f;
    switch ( count - 1 - 3 * group )
    {
        case 1:
            return ( cubic ){ { p[0], mix( rest, p[0], third, p[1] ), mix( third, p[0], rest, p[1] ), p[1] } };
        case 2:
            return ( cubic ){ { p[0], mix( third, p[0], rest, p[1] ), mix( rest, p[1], third, p[2] ), p[2] } };
        default:
            return ( cubic ){ { p[0], p[1], p[2], p[3] } };
    }
}

// A point next to a joint on the line through it along a tangent, as far from it as before.
static wisp_vec3 onto_tangent( wisp_vec3 joint, wisp_vec3 p, wisp_vec3 tangent, float sign )
{
    const wisp_vec3 d = mix( 1.0f, p, -1.0f, joint );
    const float length = sqrtf( tangent.x * tangent.x + tangent.y * tangent.y + tangent.z * tangent.z );
    const float distance = sqrtf( d.x * d.x + d.y * d.y + d.z * d.z );
    return length > 0.0f ? mix( 1.0f, joint, sign * distance / length, tangent ) : p;
}

// The same fours with one tangent at a joint, along the vertices at both sides of it.
static cubic joined_cubic( const wisp_vec3* points, int count, int group )
{
    const wisp_vec3* p = points + 3 * group;
    cubic c = group_cubic( points, count, group );
    if ( group > 0 )
    {
        c.control[1] = onto_tangent( c.control[0], c.control[1], mix( 1.0f, p[1], -1.0f, p[-1] ), 1.0f );
    }
    if ( 3 * group + 4 < count )
    {
        c.control[2] = onto_tangent( c.control[3], c.control[2], mix( 1.0f, p[4], -1.0f, p[2] ), -1.0f );
    }
    return c;
}

static int cubic_count( wisp_curve_kind kind, int vertices )
{
    return vertices < 2 ? 0 : kind == WISP_CURVE_CATMULL_ROM ? vertices - 1 : ( vertices + 1 ) / 3;
}

static int sample_count( const wisp_curves_def* def, int vertices )
{
    int cubics = cubic_count( def->kind, vertices );
    return cubics > 0 ? cubics * def->samples + 1 : 0;
}

static void draw( const wisp_curves_def* def, const wisp_vec3* points, int count, wisp_vec3* out )
{
    int cubics = cubic_count( def->kind, count );
    for ( int n = 0; n < cubics; ++n )
    {
        const cubic c =
            def->kind == WISP_CURVE_BEZIER ? joined_cubic( points, count, n ) : smooth_cubic( points, count, n );
        for ( int k = n == 0 ? 0 : 1; k <= def->samples; ++k )
        {
            *out++ = cubic_at( &c, (float)k / (float)def->samples );
        }
    }
}

wisp_status wisp_scene_make_curves( const wisp_curves_def* def, const wisp_groom* source, wisp_groom* out,
                                    wisp_error* error )
{
    *out = ( wisp_groom ){ 0 };
    int64_t samples = 0;
    for ( int s = 0; s < source->strand_count; ++s )
    {
        samples += sample_count( def, source->offsets[s + 1] - source->offsets[s] );
    }
    if ( samples > WISP_GROOM_MAX_GENERATED )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "curves with %d samples per segment have %lld points, expected at most %d", def->samples,
                          (long long)samples, WISP_GROOM_MAX_GENERATED );
    }
    WISP_TRY( groom_allocate( out, source->strand_count, (int)samples, 0, "curves", error ) );
    int at = 0;
    for ( int s = 0; s < source->strand_count; ++s )
    {
        const int first = source->offsets[s], count = source->offsets[s + 1] - first;
        out->offsets[s] = at;
        draw( def, source->points + first, count, out->points + at );
        at += sample_count( def, count );
    }
    out->offsets[source->strand_count] = at;
    out->dimension = source->dimension;
    return WISP_OK;
}
