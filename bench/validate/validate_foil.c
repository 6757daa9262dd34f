#include "validate_foil.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

static int ring_count( const validate_foil* foil, int ring )
{
    return ring == 0 ? 1 : 6 * ( foil->mesh == VALIDATE_FOIL_EVEN ? ring : foil->rings );
}

// Vertices of a disc within a ring.
static int inside_count( const validate_foil* foil, int ring )
{
    int sum = 0;
    for ( int i = 0; i < ring; ++i )
    {
        sum += ring_count( foil, i );
    }
    return sum;
}

int validate_foil_pole( const validate_foil* foil )
{
    return inside_count( foil, foil->rings );
}

int validate_foil_rim( const validate_foil* foil )
{
    return 2 * inside_count( foil, foil->rings );
}

static int vertex_of( const validate_foil* foil, int side, int ring, int k )
{
    const int place = inside_count( foil, ring ) + k % ring_count( foil, ring );
    return place + ( ring == foil->rings || side == 1 ? inside_count( foil, foil->rings ) : 0 );
}

static void put_points( const validate_foil* foil, wisp_vec3* out )
{
    for ( int side = 0; side < 2; ++side )
    {
        for ( int ring = 0; ring <= foil->rings; ++ring )
        {
            const double part = (double)ring / foil->rings, up = foil->height * ( 1.0 - part * part );
            for ( int k = 0; k < ring_count( foil, ring ); ++k )
            {
                const double angle = 2.0 * PI * k / ring_count( foil, ring );
                out[vertex_of( foil, side, ring, k )] =
                    ( wisp_vec3 ){ (float)( foil->radius * part * cos( angle ) ), (float)( side == 0 ? up : -up ),
                                   (float)( foil->radius * part * sin( angle ) ) };
            }
        }
    }
}

// The discs look outwards: the upper one against the sense of the angle, which runs from +x to +z.
static int32_t* put_triangle( int32_t* out, int side, int a, int b, int c )
{
    out[0] = a;
    out[1] = side == 0 ? c : b;
    out[2] = side == 0 ? b : c;
    return out + 3;
}

// Between two rings a sixth has one vertex more outside than inside.
static int32_t* put_even_ring( const validate_foil* foil, int side, int ring, int32_t* out )
{
    for ( int k = 0; k < 6 * ( ring + 1 ); ++k )
    {
        const int place = k % ( ring + 1 ), inner = k / ( ring + 1 ) * ring + place;
        const int a = vertex_of( foil, side, ring, inner ), b = vertex_of( foil, side, ring + 1, k ),
                  c = vertex_of( foil, side, ring + 1, k + 1 );
        out = put_triangle( out, side, a, b, c );
        if ( place < ring )
        {
            out = put_triangle( out, side, a, c, vertex_of( foil, side, ring, inner + 1 ) );
        }
    }
    return out;
}

// Diagonals in turn, so that the mesh has no sense of rotation.
static int32_t* put_spoke_ring( const validate_foil* foil, int side, int ring, int32_t* out )
{
    for ( int k = 0; k < ring_count( foil, ring + 1 ); ++k )
    {
        const int a = vertex_of( foil, side, ring, k ), b = vertex_of( foil, side, ring + 1, k ),
                  c = vertex_of( foil, side, ring + 1, k + 1 ), d = vertex_of( foil, side, ring, k + 1 );
        const bool is_even = ( ring + k ) % 2 == 0;
        out = put_triangle( out, side, a, b, is_even || ring == 0 ? c : d );
        if ( ring > 0 )
        {
            out = put_triangle( out, side, is_even ? a : b, c, d );
        }
    }
    return out;
}

wisp_status validate_foil_make( const validate_foil* foil, wisp_mesh* out, wisp_error* error )
{
    const int vertex_count = validate_foil_rim( foil ) + ring_count( foil, foil->rings );
    const int triangle_count = 2 * ( vertex_count - 2 ); // of a closed mesh without handles (Euler)
    wisp_vec3* points = malloc( (size_t)vertex_count * sizeof( *points ) );
    int32_t* triangles = malloc( (size_t)triangle_count * 3 * sizeof( *triangles ) );
    wisp_status status = points != NULL && triangles != NULL
                             ? WISP_OK
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for a foil of %d rings", foil->rings );
    if ( status == WISP_OK )
    {
        put_points( foil, points );
        int32_t* end = triangles;
        for ( int i = 0; i < 2 * foil->rings; ++i )
        {
            end = ( foil->mesh == VALIDATE_FOIL_EVEN ? put_even_ring : put_spoke_ring )( foil, i % 2, i / 2, end );
        }
        status = wisp_mesh_of_arrays( points, vertex_count, triangles, triangle_count, "foil", out, error );
    }
    free( points );
    free( triangles );
    return status;
}
