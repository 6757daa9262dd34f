// Closed forms at rest: an elastic bar, a catenary, a clamped strip that bends.
#include "closed_forms.h"

#include <math.h>
#include <string.h>
#include <stdlib.h>

// Compliance of links that must not act, m/N.
#define SOFT 1e9f

// ---- the bar ----

#define BAR_SPACING 0.01
#define BAR_MASS 0.001      // kg per vertex
#define BAR_STIFFNESS 100.0 // N/m per link

// Two columns of links under their own weight, with gravity along the plane: link i of n carries all masses below it,
// so the bar is m g / k n (n + 1) / 2 longer. The diagonals are soft and links across carry nothing.
wisp_status closed_bar( closed_run* run, wisp_error* error )
{
    static const int32_t pins[] = { 0, 1 };
    const int cells = (int)run->first;
    const double weight = BAR_MASS * CLOSED_GRAVITY;
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    cloth.weft_compliance = (float)( 1.0 / BAR_STIFFNESS );
    cloth.shear_compliance = SOFT;
    surface_generator generator = closed_generator( run );
    if ( run->second > 0.0 )
    {
        generator.substeps = (int)run->second;
        generator.iterations = run->parameter;
    }
    generator.vertex_mass = (float)BAR_MASS;
    generator.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, (float)CLOSED_GRAVITY };
    generator.pins = pins;
    generator.pin_count = 2;
    // critical for the slowest mode, a quarter wave
    generator.damping = (float)( 2.0 * 1.5707963267948966 / cells * sqrt( BAR_STIFFNESS / BAR_MASS ) );
    closed_body body = { .fabric = NULL };
    const wisp_vec3* points = NULL;
    wisp_status status = surface_plane( 2, cells + 1, BAR_SPACING, &body.mesh, error );
    status = status == WISP_OK ? closed_enter( run, generator, &cloth, &body, error ) : status;
    status = status == WISP_OK ? closed_advance( run, &body, 40, NULL, error ) : status;
    status = status == WISP_OK ? surface_implementation_points( &body.implementation, &points, error ) : status;
    if ( status == WISP_OK )
    {
        const wisp_vec3* rest = body.mesh.points;
        const int left = 2 * cells, right = left + 1;
        run->measured =
            0.5 * ( (double)points[left].z - (double)rest[left].z + (double)points[right].z - (double)rest[right].z );
        run->reference = weight / BAR_STIFFNESS * 0.5 * cells * ( cells + 1 );
    }
    closed_leave( &body );
    return status;
}

// ---- the catenary ----

#define CATENARY_SPAN 0.8 // m, of a strip of 1 m

// Span and sag of a chain of n links of 1/n m between equal masses whose end links pull sideways with h, and with the
// weight of one mass as the unit of force.
static double chain_span( int n, double h, double* sag )
{
    double span = 0.0, height = 0.0, lowest = 0.0;
    for ( int i = 0; i < n; ++i )
    {
        const double below = i - 0.5 * ( n - 1 ), pull = hypot( h, below );
        span += h / pull / n;
        height += below / pull / n;
        lowest = fmin( lowest, height );
    }
    *sag = -lowest;
    return span;
}

// The more it is pulled, the wider it is.
static double chain_sag( int n, double span )
{
    double lower = 0.0, upper = 1e3 * n, sag = 0.0;
    for ( int i = 0; i < 100; ++i )
    {
        const double h = 0.5 * ( lower + upper );
        *( chain_span( n, h, &sag ) < span ? &lower : &upper ) = h;
    }
    return sag;
}

// Half of the strip over half of the span, a right triangle.
void closed_lay_halves( const wisp_mesh* mesh, int cells, double span, wisp_vec3* out )
{
    const double depth = sqrt( 0.25 - 0.25 * span * span );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const double t = (double)( v % ( cells + 1 ) ) / cells;
        out[v] = ( wisp_vec3 ){ (float)( span * ( t - 0.5 ) ), (float)( -2.0 * depth * fmin( t, 1.0 - t ) ),
                                mesh->points[v].z };
    }
}

wisp_status closed_catenary( closed_run* run, wisp_error* error )
{
    const int cells = (int)run->first;
    const int32_t pins[] = { 0, cells, cells + 1, 2 * cells + 1 };
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = WISP_CLOTH_BENDING_NONE;
    closed_body body = { .fabric = NULL };
    const wisp_vec3* points = NULL;
    wisp_status status = surface_plane( cells + 1, 2, 1.0 / cells, &body.mesh, error );
    wisp_vec3* start = malloc( 2 * (size_t)( cells + 1 ) * sizeof( wisp_vec3 ) );
    if ( status == WISP_OK && !start )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for a strip" );
    }
    if ( status == WISP_OK )
    {
        closed_lay_halves( &body.mesh, cells, CATENARY_SPAN, start );
        surface_generator generator = closed_generator( run );
        generator.points = start;
        generator.pins = pins;
        generator.pin_count = WISP_COUNT( pins );
        generator.damping = 12.0f;
        status = closed_enter( run, generator, &cloth, &body, error );
    }
    status = status == WISP_OK ? closed_advance( run, &body, 150, NULL, error ) : status;
    status = status == WISP_OK ? surface_implementation_points( &body.implementation, &points, error ) : status;
    for ( int v = 0; v <= cells && status == WISP_OK; ++v )
    {
        run->measured = fmax( run->measured, -(double)points[v].y );
    }
    run->reference = chain_sag( cells, CATENARY_SPAN );
    free( start );
    closed_leave( &body );
    return status;
}

// ---- the elastica ----

#define STRIP_LENGTH 0.1
#define STRIP_DENSITY 0.15

enum
{
    STRIP_ITERATIONS = 32,
    STRIP_SUBSTEPS = 32,
};

double closed_strip_cell( int cells )
{
    return STRIP_LENGTH / cells;
}

// A row of square cells with diagonals in turn. The first cell is pinned and rigid, and the strip begins where it ends.
static wisp_status make_strip( int cells, closed_body* out, wisp_error* error )
{
    const int columns = cells + 2;
    const double a = closed_strip_cell( cells );
    wisp_status status = surface_plane( columns, 2, a, &out->mesh, error );
    for ( int i = 0; i < columns && status == WISP_OK; ++i )
    {
        wisp_vec3* points = out->mesh.points;
        points[i] = ( wisp_vec3 ){ (float)( a * ( i - 1 ) ), 0.0f, 0.0f };
        points[columns + i] = ( wisp_vec3 ){ (float)( a * ( i - 1 ) ), 0.0f, (float)a };
    }
    for ( int i = 0; i + 1 < columns && status == WISP_OK; ++i )
    {
        const int p = i, q = i + 1, r = columns + i, s = r + 1;
        const int32_t falling[] = { p, r, s, p, s, q }, rising[] = { p, r, q, q, r, s };
        memcpy( out->mesh.triangles + WISP_COUNT( falling ) * i, i % 2 == 0 ? falling : rising, sizeof( falling ) );
    }
    return status;
}

// theta'' = -G ( 1 - s ) cos theta.
wisp_status closed_elastica( closed_run* run, wisp_error* error )
{
    const double load = run->first, slowest = 3.516 * sqrt( CLOSED_GRAVITY / ( load * STRIP_LENGTH ) );
    const int columns = run->parameter + 2;
    const int32_t pins[] = { 0, 1, columns, columns + 1 };
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.bending = WISP_CLOTH_BENDING_DIHEDRAL;
    cloth.bend_rigidity = (float)( STRIP_DENSITY * CLOSED_GRAVITY * pow( STRIP_LENGTH, 3.0 ) / load );
    surface_generator generator = closed_generator( run );
    generator.substeps = STRIP_SUBSTEPS;
    generator.iterations = STRIP_ITERATIONS;
    generator.pins = pins;
    generator.pin_count = WISP_COUNT( pins );
    generator.damping = (float)( 2.0 * slowest ); // critical damping; it has 20 time constants to settle
    closed_body body = { .fabric = NULL };
    const wisp_vec3* points = NULL;
    wisp_status status = make_strip( run->parameter, &body, error );
    status = status == WISP_OK ? closed_enter( run, generator, &cloth, &body, error ) : status;
    status = status == WISP_OK
                 ? closed_advance( run, &body, (int)( 20.0 / slowest / (double)ACCURACY_FRAME ), NULL, error )
                 : status;
    status = status == WISP_OK ? surface_implementation_points( &body.implementation, &points, error ) : status;
    if ( status == WISP_OK )
    {
        run->measured = -0.5 * ( (double)points[columns - 1].y + (double)points[2 * columns - 1].y ) / STRIP_LENGTH;
        run->reference = run->second;
    }
    closed_leave( &body );
    return status;
}
