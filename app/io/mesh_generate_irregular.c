// The irregular plane: rows of points, shifted at random, joined row by row, and then flipped until it is Delaunay
// (Lawson 1977): no vertex is inside the circle around a neighbour's triangle. The outline is a rectangle, so the
// property for neighbours implies it for all.
#include "mesh_internal.h"

#include "wisp/module/definition.h"
#include "wisp/module/random.h"
#include <math.h>
#include <stdlib.h>

// ---- Delaunay ----

// Generators of flat pieces with a Delaunay triangulation: their outlines.

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

// ---- irregular ----

enum
{
    RANDOM_STREAM = 0x6d657368, // any number that no other stream of the program uses
    DRAW_X = 0,
    DRAW_Z = 1,
    NO_TWIN = -1,
};

// A circle that misses a point by less than this, as a part of its size, counts as passing through it: a square would
// flip forever otherwise.
static const double ON_CIRCLE = 1e-9;

// ---- points ----------------------------------------------------------------------------------------------------

// Start of row j; the remainder is distributed over whole rows as evenly as integers allow.
static int row_start( const wisp_mesh_generator* r, int total, int j )
{
    return (int)( (int64_t)total * j / r->rows );
}

static float shift( const wisp_mesh_generator* r, wisp_random_key key, int v, uint32_t axis )
{
    return r->jitter * ( 2.0f * wisp_random_unit_float( key, (uint32_t)v, axis, 0 ) - 1.0f );
}

// Points of the border move along it and corners do not move.
static void put_points( const wisp_mesh_generator* r, wisp_mesh* out )
{
    wisp_random_key key = wisp_random_make_key( r->seed, RANDOM_STREAM, 0 );
    double width = ( r->columns - 1 ) * (double)r->spacing, depth = ( r->rows - 1 ) * (double)r->spacing;
    for ( int j = 0; j < r->rows; ++j )
    {
        int begin = row_start( r, out->vertex_count, j ), count = row_start( r, out->vertex_count, j + 1 ) - begin;
        for ( int i = 0; i < count; ++i )
        {
            bool side = i == 0 || i == count - 1, end = j == 0 || j == r->rows - 1;
            double x = i + ( side ? 0.0 : (double)shift( r, key, begin + i, DRAW_X ) );
            double z = j + ( end ? 0.0 : (double)shift( r, key, begin + i, DRAW_Z ) );
            out->points[begin + i] = ( wisp_vec3 ){
                .x = (float)( width * ( x / ( count - 1 ) - 0.5 ) ),
                .z = (float)( depth * ( z / ( r->rows - 1 ) - 0.5 ) ),
            };
        }
    }
}

// ---- the first triangles ---------------------------------------------------------------------------------------

// Between two rows, always with the steeper of the two next edges: with shifts of a fifth no triangle can be reversed
// then.
static int32_t* join_rows( const wisp_vec3* points, int p, int p_end, int q, int q_end, int32_t* t )
{
    while ( p < p_end || q < q_end )
    {
        double along = p < p_end ? fabs( (double)points[p + 1].x - (double)points[q].x ) : HUGE_VAL;
        double across = q < q_end ? fabs( (double)points[q + 1].x - (double)points[p].x ) : HUGE_VAL;
        t[0] = p;
        t[1] = q;
        t[2] = along < across ? ++p : ++q;
        t += 3;
    }
    return t;
}

static void put_triangles( const wisp_mesh_generator* r, wisp_mesh* out )
{
    int32_t* t = out->triangles;
    for ( int j = 0; j + 1 < r->rows; ++j )
    {
        int p = row_start( r, out->vertex_count, j ), q = row_start( r, out->vertex_count, j + 1 );
        int end = row_start( r, out->vertex_count, j + 2 );
        t = join_rows( out->points, p, q - 1, q, end - 1, t );
    }
}

// ---- flips -----------------------------------------------------------------------------------------------------

typedef struct flips
{
    wisp_mesh* mesh;
    int32_t* twin;  // [3 * triangle_count] the half-edge across, NO_TWIN on the border
    int32_t* stack; // half-edges whose neighbourhood changed
    bool* waiting;  // [3 * triangle_count] lies on the stack
    int stack_count;
} flips;

static void push( flips* f, int32_t half )
{
    if ( half != NO_TWIN && !f->waiting[half] )
    {
        f->waiting[half] = true;
        f->stack[f->stack_count++] = half;
    }
}

// Whether d lies inside the circle around a, b, c, which run counter-clockwise seen from above.
static bool is_inside_circle( const wisp_vec3* points, int32_t a, int32_t b, int32_t c, int32_t d )
{
    const int32_t corner[] = { a, b, c };
    double u[3], v[3], square[3], largest = 0.0;
    for ( int i = 0; i < 3; ++i )
    {
        mesh_vector from = mesh_between( points[d], points[corner[i]] );
        u[i] = from.z;
        v[i] = from.x;
        square[i] = u[i] * u[i] + v[i] * v[i];
        largest = fmax( largest, square[i] );
    }
    double determinant = square[0] * ( u[1] * v[2] - u[2] * v[1] ) + square[1] * ( u[2] * v[0] - u[0] * v[2] ) +
                         square[2] * ( u[0] * v[1] - u[1] * v[0] );
    return determinant > ON_CIRCLE * largest * largest;
}

static void join_halves( flips* f, int32_t half, int32_t twin )
{
    f->twin[half] = twin;
    if ( twin != NO_TWIN )
    {
        f->twin[twin] = half;
    }
    push( f, half );
}

// Flip the edge a-b of the triangles a b c and b a d to c-d.
static void flip( flips* f, int32_t half, int32_t twin )
{
    int32_t* corners = f->mesh->triangles;
    int32_t bc = mesh_next_half( half ), ca = mesh_next_half( bc );
    int32_t ad = mesh_next_half( twin ), db = mesh_next_half( ad );
    int32_t a = corners[half], b = corners[twin], c = corners[ca], d = corners[db];
    int32_t beyond_bc = f->twin[bc], beyond_ca = f->twin[ca], beyond_ad = f->twin[ad], beyond_db = f->twin[db];
    int32_t t = half - half % 3, s = twin - twin % 3;
    corners[t] = c;
    corners[t + 1] = a;
    corners[t + 2] = d;
    corners[s] = d;
    corners[s + 1] = b;
    corners[s + 2] = c;
    join_halves( f, t, beyond_ca );
    join_halves( f, t + 1, beyond_ad );
    join_halves( f, s, beyond_db );
    join_halves( f, s + 1, beyond_bc );
    f->twin[t + 2] = s + 2;
    f->twin[s + 2] = t + 2;
}

static void find_twins( flips* f, const mesh_edges* edges )
{
    for ( int e = 0; e < edges->edge_count; ++e )
    {
        int begin = edges->starts[e];
        bool is_border = edges->starts[e + 1] - begin == 1;
        int32_t half = edges->half[begin], other = is_border ? NO_TWIN : edges->half[begin + 1];
        join_halves( f, half, other );
    }
}

// Every flip increases the smallest angles, so the loop ends.
static void flip_all( flips* f )
{
    while ( f->stack_count > 0 )
    {
        int32_t half = f->stack[--f->stack_count];
        f->waiting[half] = false;
        int32_t twin = f->twin[half];
        if ( twin == NO_TWIN )
        {
            continue;
        }
        const int32_t* corners = f->mesh->triangles;
        int32_t c = corners[mesh_next_half( mesh_next_half( half ) )];
        int32_t d = corners[mesh_next_half( mesh_next_half( twin ) )];
        if ( is_inside_circle( f->mesh->points, corners[half], corners[twin], c, d ) )
        {
            flip( f, half, twin );
        }
    }
}

static wisp_status make_delaunay( wisp_mesh* mesh, wisp_error* error )
{
    const size_t halves = 3 * (size_t)mesh->triangle_count;
    io_memory scratch = { 0 };
    mesh_edges edges;
    flips f = { .mesh = mesh,
                .twin = io_get( &scratch, halves * sizeof *f.twin ),
                .stack = io_get( &scratch, halves * sizeof *f.stack ),
                .waiting = io_get( &scratch, halves * sizeof *f.waiting ) };
    const wisp_status status =
        scratch.is_short ? wisp_fail( error, WISP_NO_MEMORY, "mesh generator: out of memory to flip %d triangles",
                                      mesh->triangle_count )
                         : mesh_edges_build( mesh, &scratch, &edges, error );
    if ( status == WISP_OK )
    {
        find_twins( &f, &edges );
        flip_all( &f );
    }
    io_release( &scratch );
    return status;
}

wisp_status mesh_generate_irregular( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    int total = r->vertex_count != 0 ? r->vertex_count : r->columns * r->rows;
    int first = row_start( r, total, 1 ), last = total - row_start( r, total, r->rows - 1 );
    // Two rows of p and q points have p + q - 2 triangles between them.
    int triangle_count = 2 * total - first - last - 2 * ( r->rows - 1 );
    wisp_status status = mesh_allocate( out, total, triangle_count, "mesh generator", error );
    if ( status == WISP_OK )
    {
        put_points( r, out );
        put_triangles( r, out );
        status = make_delaunay( out, error );
    }
    if ( status != WISP_OK )
    {
        wisp_mesh_release( out );
    }
    return status;
}
