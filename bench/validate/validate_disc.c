#include "validate_disc.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

enum
{
    MAX_CIRCLES = 34,
    PIXELS = 1024, // along a side of the shadow
};

static const double TWO_PI = 6.283185307179586;

// ---- the mesh ----

// Circles from the inside, with their vertices one after another.
typedef struct disc_circles
{
    int count;
    int first[MAX_CIRCLES + 1];
    double radius[MAX_CIRCLES], phase[MAX_CIRCLES]; // the phase in parts of a cell
} disc_circles;

static disc_circles lay_circles( double clamp, double border, int cells, double turn )
{
    const double cell = ( border - clamp ) / cells;
    disc_circles c = { .count = cells + 2 };
    for ( int k = 0; k < c.count; ++k )
    {
        // multiples of the golden ratio are spread evenly and repeat nothing
        const double phase = turn * ( k + 1 ) * 0.6180339887498949;
        c.radius[k] = clamp + cell * ( k - 1 );
        c.phase[k] = phase - floor( phase );
        c.first[k + 1] = c.first[k] + (int)lrint( TWO_PI * c.radius[k] / cell );
    }
    return c;
}

static int size_of( const disc_circles* c, int k )
{
    return c->first[k + 1] - c->first[k];
}

// Of vertex i of a circle, which may go round more than once, in turns.
static double angle_of( const disc_circles* c, int k, int i )
{
    return ( i + c->phase[k] ) / size_of( c, k );
}

static int vertex_of( const disc_circles* c, int k, int i )
{
    return c->first[k] + i % size_of( c, k );
}

// Triangles between circle k and the next: advance on the circle whose next vertex comes first.
static int zip( const disc_circles* c, int k, int32_t* triangles )
{
    const int inner = size_of( c, k ), outer = size_of( c, k + 1 );
    int count = 0;
    for ( int i = 0, j = 0; i < inner || j < outer; ++count )
    {
        const bool is_outer = i == inner || ( j < outer && angle_of( c, k + 1, j + 1 ) < angle_of( c, k, i + 1 ) );
        int32_t* t = triangles + 3 * count;
        t[0] = vertex_of( c, k, i );
        t[1] = vertex_of( c, k + 1, j );
        t[2] = is_outer ? vertex_of( c, k + 1, j + 1 ) : vertex_of( c, k, i + 1 );
        i += is_outer ? 0 : 1;
        j += is_outer ? 1 : 0;
    }
    return count;
}

wisp_status disc_mesh( double clamp, double border, int cells, double turn, wisp_mesh* out, int* pin_count,
                       wisp_error* error )
{
    const disc_circles c = lay_circles( clamp, border, cells, turn );
    const int vertices = c.first[c.count];
    *out = ( wisp_mesh ){ .vertex_count = vertices };
    out->points = malloc( (size_t)vertices * sizeof( wisp_vec3 ) );
    out->triangles = malloc( (size_t)vertices * 6 * sizeof( int32_t ) );
    if ( !out->points || !out->triangles )
    {
        wisp_mesh_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a specimen" );
    }
    for ( int k = 0; k < c.count; ++k )
    {
        for ( int i = 0; i < size_of( &c, k ); ++i )
        {
            const double angle = TWO_PI * angle_of( &c, k, i );
            out->points[c.first[k] + i] =
                ( wisp_vec3 ){ (float)( c.radius[k] * cos( angle ) ), 0.0f, (float)( -c.radius[k] * sin( angle ) ) };
        }
    }
    for ( int k = 0; k + 1 < c.count; ++k )
    {
        out->triangle_count += zip( &c, k, out->triangles + 3 * out->triangle_count );
    }
    *pin_count = c.first[2];
    return WISP_OK;
}

// ---- the shadow ----

// Pixels of a square about the axis; a pixel is in shadow if its middle is.
typedef struct shadow
{
    unsigned char* dark; // [PIXELS][PIXELS]
    double pixel;        // m
} shadow;

static double middle_of( const shadow* s, int pixel )
{
    return s->pixel * ( pixel + 0.5 - 0.5 * PIXELS );
}

static int pixel_of( const shadow* s, double at )
{
    const double pixel = floor( at / s->pixel + 0.5 * PIXELS );
    return (int)fmin( fmax( pixel, 0.0 ), PIXELS - 1.0 );
}

// Twice the area of a triangle of the plane.
static double turn_of( const double a[2], const double b[2], double x, double z )
{
    return ( b[0] - a[0] ) * ( z - a[1] ) - ( b[1] - a[1] ) * ( x - a[0] );
}

static void darken( shadow* s, const double a[2], const double b[2], const double c[2] )
{
    const int left = pixel_of( s, fmin( a[0], fmin( b[0], c[0] ) ) ),
              right = pixel_of( s, fmax( a[0], fmax( b[0], c[0] ) ) ),
              low = pixel_of( s, fmin( a[1], fmin( b[1], c[1] ) ) ),
              high = pixel_of( s, fmax( a[1], fmax( b[1], c[1] ) ) );
    for ( int i = low; i <= high; ++i )
    {
        for ( int j = left; j <= right; ++j )
        {
            const double x = middle_of( s, j ), z = middle_of( s, i );
            const double u = turn_of( a, b, x, z ), v = turn_of( b, c, x, z ), w = turn_of( c, a, x, z );
            // inside, whichever side is up
            if ( ( u >= 0.0 && v >= 0.0 && w >= 0.0 ) || ( u <= 0.0 && v <= 0.0 && w <= 0.0 ) )
            {
                s->dark[i * PIXELS + j] = 1;
            }
        }
    }
}

double disc_shadow( const wisp_mesh* mesh, const wisp_vec3* points, double disc, double border )
{
    shadow s = { calloc( (size_t)PIXELS * PIXELS, 1 ), 2.2 * border / PIXELS };
    if ( s.dark == NULL )
    {
        return -1.0;
    }
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        double corners[3][2];
        for ( int k = 0; k < 3; ++k )
        {
            const wisp_vec3 p = points[mesh->triangles[3 * t + k]];
            corners[k][0] = (double)p.x;
            corners[k][1] = (double)p.z;
        }
        darken( &s, corners[0], corners[1], corners[2] );
    }
    double area = 0.0;
    for ( int i = 0; i < PIXELS * PIXELS; ++i )
    {
        const double r = hypot( middle_of( &s, i % PIXELS ), middle_of( &s, i / PIXELS ) );
        area += s.dark[i] && r > disc ? s.pixel * s.pixel : 0.0;
    }
    free( s.dark );
    return area;
}
