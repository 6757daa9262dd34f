// Generators of flat pieces with a Delaunay triangulation: their outlines.
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

enum
{
    MIN_BENDS = 4, // straight segments of a curve of the garment
    MAX_BENDS = 256,
    CURVES = 4,
    STRAIGHT_CORNERS = 5,
};

// ---- a rectangle -----------------------------------------------------------------------------------------------

static wisp_status make_rectangle( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    float x = 0.5f * r->width, z = 0.5f * r->depth;
    const wisp_mesh_corner corners[] = { { -x, -z, 1.0f }, { -x, z, 1.0f }, { x, z, 1.0f }, { x, -z, 1.0f } };
    return wisp_mesh_generate_flat( corners, WISP_COUNT( corners ), r->vertex_count, r->seed, out, error );
}

// ---- a garment -------------------------------------------------------------------------------------------------

// The front panel of a shirt as drawn on paper, in fractions of its width and its length, from the hem's middle: only
// the right half, the left one is its mirror image. Its curves are Bezier curves.
typedef struct pattern_point
{
    double x, up;
} pattern_point;

static const pattern_point HEM = { 0.5, 0.0 };
static const pattern_point ARMHOLE[] = { { 0.5, 0.62 }, { 0.36, 0.64 }, { 0.33, 0.8 }, { 0.38, 0.95 } };
static const pattern_point NECKLINE[] = { { 0.16, 1.0 }, { 0.15, 0.9 }, { 0.08, 0.86 }, { 0.0, 0.86 } };
static const float ARMHOLE_DENSITY = 2.5f, NECKLINE_DENSITY = 3.0f, SHOULDER_DENSITY = 1.5f;

static pattern_point on_curve( const pattern_point* p, double t )
{
    double s = 1.0 - t;
    double a = s * s * s, b = 3.0 * s * s * t, c = 3.0 * s * t * t, d = t * t * t;
    return ( pattern_point ){ a * p[0].x + b * p[1].x + c * p[2].x + d * p[3].x,
                              a * p[0].up + b * p[1].up + c * p[2].up + d * p[3].up };
}

// The paper's upper edge points towards -z, so that counter-clockwise on paper is counter-clockwise seen from above.
static wisp_mesh_corner lay( const wisp_mesh_generator* r, pattern_point p, float density )
{
    return ( wisp_mesh_corner ){ .x = (float)( p.x * (double)r->width ),
                                 .z = (float)( ( 0.5 - p.up ) * (double)r->depth ),
                                 .density = density };
}

// From the right end of the hem up to the middle of the neckline. @return number of corners
static int put_right_half( const wisp_mesh_generator* r, int bends, wisp_mesh_corner* corners )
{
    int count = 0;
    corners[count++] = lay( r, HEM, 1.0f );
    for ( int i = 0; i < bends; ++i )
    {
        corners[count++] = lay( r, on_curve( ARMHOLE, (double)i / bends ), ARMHOLE_DENSITY );
    }
    corners[count++] = lay( r, ARMHOLE[3], SHOULDER_DENSITY );
    for ( int i = 0; i <= bends; ++i )
    {
        corners[count++] = lay( r, on_curve( NECKLINE, (double)i / bends ), NECKLINE_DENSITY );
    }
    return count;
}

// The way back: an edge of the left half has the density of its mirror image, which begins at the corner before.
static int put_left_half( wisp_mesh_corner* corners, int right_count )
{
    int count = right_count;
    for ( int i = right_count - 2; i >= 0; --i )
    {
        corners[count] = corners[i];
        corners[count].x = -corners[i].x;
        corners[count++].density = i > 0 ? corners[i - 1].density : 1.0f;
    }
    return count;
}

static wisp_status make_garment( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    // About three vertices per bend, whatever their number: the finer the mesh, the rounder its curves.
    int bends = (int)fmin( fmax( sqrt( (double)r->vertex_count ) / 3.0, MIN_BENDS ), MAX_BENDS );
    wisp_mesh_corner corners[CURVES * MAX_BENDS + STRAIGHT_CORNERS];
    int count = put_left_half( corners, put_right_half( r, bends, corners ) );
    return wisp_mesh_generate_flat( corners, count, r->vertex_count, r->seed, out, error );
}

wisp_status mesh_generate_delaunay( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    return r->shape == WISP_MESH_GARMENT ? make_garment( r, out, error ) : make_rectangle( r, out, error );
}
