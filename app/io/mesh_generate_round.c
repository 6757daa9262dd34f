// Round shapes: subdivided icosahedra, and those of the engine around the axis y.
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

#include "wisp/generate.h"
#include "wisp/module/definition.h"

static const char NAME[] = "mesh generator";

// ---- from the icosahedron --------------------------------------------------------------------------------------

enum
{
    ICO_VERTICES = 12,
    ICO_TRIANGLES = 20,
};

// Directions in double precision: rounded ones would drift from level to level.
typedef struct ico
{
    mesh_vector* directions;
    wisp_mesh mesh; // triangles and counts, without points
} ico;

static mesh_vector unit( mesh_vector v )
{
    double length = sqrt( mesh_dot( v, v ) );
    return ( mesh_vector ){ v.x / length, v.y / length, v.z / length };
}

static void put_icosahedron( ico* s )
{
    const double g = 0.5 + 0.5 * sqrt( 5.0 );
    const mesh_vector corners[ICO_VERTICES] = {
        { -1, g, 0 },  { 1, g, 0 },  { -1, -g, 0 }, { 1, -g, 0 }, { 0, -1, g },  { 0, 1, g },
        { 0, -1, -g }, { 0, 1, -g }, { g, 0, -1 },  { g, 0, 1 },  { -g, 0, -1 }, { -g, 0, 1 },
    };
    static const int32_t faces[3 * ICO_TRIANGLES] = {
        0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
        3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1,
    };
    for ( int v = 0; v < ICO_VERTICES; ++v )
    {
        s->directions[v] = unit( corners[v] );
    }
    for ( int c = 0; c < 3 * ICO_TRIANGLES; ++c )
    {
        s->mesh.triangles[c] = faces[c];
    }
    s->mesh.vertex_count = ICO_VERTICES;
    s->mesh.triangle_count = ICO_TRIANGLES;
}

// A new vertex in the middle of each edge, numbered after the old ones in the order of edges.
static void put_middles( ico* s, const mesh_edges* edges, int32_t* middle )
{
    for ( int e = 0; e < edges->edge_count; ++e )
    {
        int32_t half = edges->half[edges->starts[e]], v = s->mesh.vertex_count + e;
        mesh_vector a = s->directions[mesh_from( &s->mesh, half )], b = s->directions[mesh_to( &s->mesh, half )];
        s->directions[v] = unit( ( mesh_vector ){ a.x + b.x, a.y + b.y, a.z + b.z } );
        for ( int i = edges->starts[e]; i < edges->starts[e + 1]; ++i )
        {
            middle[edges->half[i]] = v;
        }
    }
    s->mesh.vertex_count += edges->edge_count;
}

// Replace each triangle by four. From the last to the first, so that none is overwritten before it is read.
static void split_triangles( ico* s, const int32_t* middle )
{
    for ( int t = s->mesh.triangle_count - 1; t >= 0; --t )
    {
        const int32_t* old = s->mesh.triangles + 3 * t;
        int32_t a = old[0], b = old[1], c = old[2];
        int32_t ab = middle[3 * t], bc = middle[3 * t + 1], ca = middle[3 * t + 2];
        const int32_t four[] = { a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca };
        for ( int i = 0; i < 12; ++i )
        {
            s->mesh.triangles[12 * t + i] = four[i];
        }
    }
    s->mesh.triangle_count *= 4;
}

static wisp_status subdivide( ico* s, wisp_error* error )
{
    mesh_edges edges;
    io_memory scratch = { 0 };
    wisp_status status = mesh_edges_build( &s->mesh, &scratch, &edges, error );
    int32_t* middle = io_get( &scratch, (size_t)edges.half_count * sizeof *middle );
    if ( status == WISP_OK && middle == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "mesh generator: out of memory for %d edges", edges.edge_count );
    }
    if ( status == WISP_OK )
    {
        put_middles( s, &edges, middle );
        split_triangles( s, middle );
    }
    io_release( &scratch );
    return status;
}

// Narrow above, bent along x, flattened along z. y grows with y, and in each slice of constant y, x grows with x and
// z with z, so that the surface has no intersections; of all symmetries only the mirror z = 0 remains.
static mesh_vector shape_pear( mesh_vector d )
{
    double taper = 0.85 - 0.35 * d.y + 0.1 * d.x;
    return ( mesh_vector ){ taper * d.x + 0.25 * d.y * d.y, 1.3 * d.y, 0.8 * ( 0.85 - 0.35 * d.y ) * d.z };
}

static void put_points( const ico* s, const wisp_mesh_generator* r, wisp_mesh* out )
{
    for ( int v = 0; v < out->vertex_count; ++v )
    {
        mesh_vector d = r->shape == WISP_MESH_PEAR ? shape_pear( s->directions[v] ) : s->directions[v];
        double radius = (double)r->radius;
        out->points[v] = ( wisp_vec3 ){ (float)( radius * d.x ), (float)( radius * d.y ), (float)( radius * d.z ) };
    }
}

wisp_status mesh_generate_icosphere( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    int quadrupled = 1 << 2 * r->level;
    int vertex_count = 10 * quadrupled + 2;
    WISP_TRY( mesh_allocate( out, vertex_count, ICO_TRIANGLES * quadrupled, NAME, error ) );
    wisp_status status = WISP_OK;
    ico s = { malloc( (size_t)vertex_count * sizeof *s.directions ), { .triangles = out->triangles } };
    if ( s.directions == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "mesh generator: out of memory for %d vertices", vertex_count );
    }
    else
    {
        put_icosahedron( &s );
    }
    for ( int level = 0; status == WISP_OK && level < r->level; ++level )
    {
        status = subdivide( &s, error );
    }
    if ( status == WISP_OK )
    {
        put_points( &s, r, out );
    }
    else
    {
        wisp_mesh_release( out );
    }
    free( s.directions );
    return status;
}

// ---- around an axis --------------------------------------------------------------------------------------------

// A cylinder becomes the frustum of a cone.
static void taper( const wisp_mesh_generator* r, wisp_mesh* mesh )
{
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        wisp_vec3* p = &mesh->points[v];
        const float up = p->y / r->length + 0.5f, ratio = r->lower_radius / r->radius;
        const float factor = ratio + up * ( 1.0f - ratio );
        *p = ( wisp_vec3 ){ factor * p->x, p->y, factor * p->z };
    }
}

wisp_status mesh_generate_turned( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    const int n = r->segments, rings = r->rings, parts = r->length_segments;
    switch ( r->shape )
    {
        case WISP_MESH_TORUS:
            WISP_TRY( mesh_allocate( out, WISP_TORUS_VERTICES( n, rings ), WISP_TORUS_TRIANGLES( n, rings ), NAME,
                                     error ) );
            return wisp_generate_torus( n, rings, r->radius, r->tube_radius, out->points, out->triangles, error );
        case WISP_MESH_TUBE:
            WISP_TRY( mesh_allocate( out, WISP_CYLINDER_VERTICES( n, parts ), WISP_CYLINDER_TRIANGLES( n, parts ),
                                     NAME, error ) );
            WISP_TRY( wisp_generate_cylinder( n, parts, r->radius, r->length, out->points, out->triangles, error ) );
            if ( r->lower_radius > 0.0f )
            {
                taper( r, out );
            }
            return WISP_OK;
        case WISP_MESH_CAPSULE:
            WISP_TRY( mesh_allocate( out, WISP_CAPSULE_VERTICES( n, rings, parts ),
                                     WISP_CAPSULE_TRIANGLES( n, rings, parts ), NAME, error ) );
            return wisp_generate_capsule( n, rings, parts, r->radius, r->length, out->points, out->triangles, error );
        default:
            WISP_TRY( mesh_allocate( out, WISP_SPHERE_VERTICES( n, rings ), WISP_SPHERE_TRIANGLES( n, rings ), NAME,
                                     error ) );
            return wisp_generate_sphere( n, rings, r->radius, out->points, out->triangles, error );
    }
}
