#include "boundary_oracle.h"

#include <stdlib.h>
#include <string.h>

int boundary_oracle_gust( const balloon_mesh* mesh, const double* w, double3 gust, bool per_face, double3* v,
                          int* hits )
{
    int total = 0;
    memset( hits, 0, (size_t)mesh->vertex_count * sizeof( int ) );
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int* c = mesh->triangles + 3 * t;
        const double3* x = mesh->positions;
        const double3 n = boundary_oracle_face_normal( ( const double3[3] ){ x[c[0]], x[c[1]], x[c[2]] } );
        for ( int k = 0; k < 3 && double3_dot( n, gust ) < 0.0; ++k )
        {
            if ( w[c[k]] > 0.0 && ( per_face || hits[c[k]] == 0 ) )
            {
                v[c[k]] = double3_add( v[c[k]], gust );
                hits[c[k]] += 1;
                total += 1;
            }
        }
    }
    return total;
}

bool boundary_oracle_sphere( balloon_mesh* mesh, int slices, int stacks, double radius )
{
    const double pi = 3.14159265358979323846;
    const int rings = stacks - 1, south = slices * rings + 1;
    *mesh = ( balloon_mesh ){ .vertex_count = slices * rings + 2, .triangle_count = 2 * slices * rings };
    mesh->positions = calloc( (size_t)mesh->vertex_count, sizeof( double3 ) );
    mesh->triangles = calloc( 3 * (size_t)mesh->triangle_count, sizeof( int ) );
    if ( mesh->positions == NULL || mesh->triangles == NULL )
    {
        balloon_mesh_destroy( mesh );
        return false;
    }
    mesh->positions[0] = double3_make( 0.0, radius, 0.0 );
    mesh->positions[south] = double3_make( 0.0, -radius, 0.0 );
    int* out = mesh->triangles;
    for ( int n = 0; n < slices * rings; ++n )
    {
        // ring r, slice s; `east` is the next on the ring, `below` the ring or the pole further south
        const int r = n / slices, s = n % slices, east = 1 + r * slices + ( s + 1 ) % slices, here = 1 + n;
        const double polar = pi * ( r + 1 ) / stacks, around = 2.0 * pi * s / slices;
        mesh->positions[here] = double3_make( radius * sin( polar ) * cos( around ), radius * cos( polar ),
                                              -radius * sin( polar ) * sin( around ) );
        const bool first = r == 0, last = r == rings - 1;
        const int below = last ? south : here + slices, below_east = last ? south : east + slices;
        const int corner[6] = { here, below, east, east, below, below_east };
        memcpy( out, corner, 3 * sizeof( int ) );
        out += 3;
        if ( !last )
        {
            memcpy( out, corner + 3, 3 * sizeof( int ) );
            out += 3;
        }
        if ( first )
        {
            const int cap[3] = { 0, here, east };
            memcpy( out, cap, sizeof( cap ) );
            out += 3;
        }
    }
    return true;
}
