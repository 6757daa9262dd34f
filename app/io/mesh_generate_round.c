// Round shapes: subdivided icosahedra, and profiles swept around the axis y.
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

#include "trig.h"

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
    wisp_status status = mesh_edges_build( &s->mesh, &edges, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    int32_t* middle = malloc( (size_t)edges.half_count * sizeof *middle );
    if ( middle != NULL )
    {
        put_middles( s, &edges, middle );
        split_triangles( s, middle );
    }
    else
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "mesh generator: out of memory for %d edges", edges.edge_count );
    }
    free( middle );
    mesh_edges_release( &edges );
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
    wisp_status status = mesh_allocate( out, vertex_count, ICO_TRIANGLES * quadrupled, "mesh generator", error );
    if ( status != WISP_OK )
    {
        return status;
    }
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

// Rings of vertices from above to below.
typedef struct profile
{
    int ring_count;
    bool has_poles; // a vertex above the first ring and one below the last
    bool is_cyclic; // the last ring is the first one's neighbour
} profile;

typedef struct profile_point
{
    double out, up; // m, from the axis and along it
} profile_point;

// Cosine and sine of part / whole of a turn, 0 <= part <= whole: exact at the quarters, equal where symmetry requires
// it, on the unit circle to double precision.
static void turn( int part, int whole, double* cosine, double* sine )
{
    // Down to an eighth of a turn in whole numbers, so that opposite and mirrored points are so exactly.
    int64_t quarters = 4 * (int64_t)part, quarter = quarters / whole, rest = quarters % whole;
    bool mirrored = 2 * rest > whole;
    int64_t small = mirrored ? whole - rest : rest;
    float s, c;
    trig_sincos( (float)( 1.5707963267948966 * (double)small / (double)whole ), &s, &c );
    // The engine's sine is exact to seven digits; the circle needs sixteen.
    double length = sqrt( (double)c * (double)c + (double)s * (double)s );
    double x = ( mirrored ? (double)s : (double)c ) / length, y = ( mirrored ? (double)c : (double)s ) / length;
    if ( 2 * small == whole )
    {
        x = y = sqrt( 0.5 );
    }
    switch ( quarter & 3 )
    {
        case 0:
            *cosine = x, *sine = y;
            break;
        case 1:
            *cosine = -y, *sine = x;
            break;
        case 2:
            *cosine = -x, *sine = -y;
            break;
        default:
            *cosine = y, *sine = -x;
            break;
    }
}

static profile profile_of( const wisp_mesh_generator* r )
{
    switch ( r->shape )
    {
        case WISP_MESH_TORUS:
            return ( profile ){ r->rings, false, true };
        case WISP_MESH_TUBE:
            return ( profile ){ r->length_segments + 1, false, false };
        case WISP_MESH_CAPSULE:
            return ( profile ){ 2 * r->rings + r->length_segments - 1, true, false };
        default:
            return ( profile ){ r->rings - 1, true, false };
    }
}

// Point k of the quarter of a circle that leads down from the pole, of `rings` parts.
static profile_point cap_point( const wisp_mesh_generator* r, int k )
{
    double cosine, sine;
    turn( k, 4 * r->rings, &cosine, &sine );
    return ( profile_point ){ (double)r->radius * sine, (double)r->radius * cosine };
}

// Ring k, the first one below the pole being 0 where there is a pole.
static profile_point ring_point( const wisp_mesh_generator* r, int k )
{
    double radius = (double)r->radius, half = 0.5 * (double)r->length;
    double cosine, sine;
    int below = k - ( r->rings - 1 + r->length_segments ); // of a capsule: counts from the lower end of the cylinder
    switch ( r->shape )
    {
        case WISP_MESH_TORUS:
            turn( k, r->rings, &cosine, &sine );
            return ( profile_point ){ radius + (double)r->tube_radius * cosine, -(double)r->tube_radius * sine };
        case WISP_MESH_TUBE:
            return ( profile_point ){ radius, half - (double)r->length * k / r->length_segments };
        case WISP_MESH_CAPSULE:
            if ( k < r->rings )
            {
                profile_point p = cap_point( r, k + 1 );
                return ( profile_point ){ p.out, half + p.up };
            }
            if ( below >= 0 )
            {
                profile_point p = cap_point( r, r->rings - below );
                return ( profile_point ){ p.out, -half - p.up };
            }
            return ( profile_point ){ radius, half - (double)r->length * ( k - r->rings + 1 ) / r->length_segments };
        default:
            turn( k + 1, 2 * r->rings, &cosine, &sine );
            return ( profile_point ){ radius * sine, radius * cosine };
    }
}

static void put_rings( const wisp_mesh_generator* r, const profile* p, wisp_vec3* points )
{
    double top = (double)r->radius + ( r->shape == WISP_MESH_CAPSULE ? 0.5 * (double)r->length : 0.0 );
    wisp_vec3* ring = points + p->has_poles;
    for ( int k = 0; k < p->ring_count; ++k, ring += r->segments )
    {
        profile_point at = ring_point( r, k );
        for ( int i = 0; i < r->segments; ++i )
        {
            double cosine, sine;
            turn( i, r->segments, &cosine, &sine );
            ring[i] = ( wisp_vec3 ){ (float)( at.out * cosine ), (float)at.up, (float)( -at.out * sine ) };
        }
    }
    if ( p->has_poles )
    {
        points[0] = ( wisp_vec3 ){ 0.0f, (float)top, 0.0f };
        *ring = ( wisp_vec3 ){ 0.0f, (float)-top, 0.0f };
    }
}

static int32_t* put_triangle( int32_t* t, int32_t a, int32_t b, int32_t c )
{
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return t + 3;
}

static void put_bands( const wisp_mesh_generator* r, const profile* p, int32_t* t )
{
    int n = r->segments, base = p->has_poles;
    int last = base + n * p->ring_count;
    for ( int i = 0; p->has_poles && i < n; ++i )
    {
        t = put_triangle( t, 0, base + i, base + ( i + 1 ) % n );
    }
    int bands = p->is_cyclic ? p->ring_count : p->ring_count - 1;
    for ( int k = 0; k < bands; ++k )
    {
        int above = base + k * n, below = base + ( k + 1 ) % p->ring_count * n;
        for ( int i = 0; i < n; ++i )
        {
            int next = ( i + 1 ) % n;
            t = put_triangle( t, above + i, below + i, below + next );
            t = put_triangle( t, above + i, below + next, above + next );
        }
    }
    for ( int i = 0; p->has_poles && i < n; ++i )
    {
        t = put_triangle( t, last, last - n + ( i + 1 ) % n, last - n + i );
    }
}

wisp_status mesh_generate_turned( const wisp_mesh_generator* r, wisp_mesh* out, wisp_error* error )
{
    profile p = profile_of( r );
    int bands = p.is_cyclic || p.has_poles ? p.ring_count : p.ring_count - 1;
    int vertex_count = r->segments * p.ring_count + 2 * p.has_poles;
    wisp_status status = mesh_allocate( out, vertex_count, 2 * r->segments * bands, "mesh generator", error );
    if ( status == WISP_OK )
    {
        put_rings( r, &p, out->points );
        put_bands( r, &p, out->triangles );
    }
    return status;
}
