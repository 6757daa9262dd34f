#include "balloon_meshes.h"

#include "constraint_oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- theory ----

static const double PI = 3.14159265358979323846;

// ---- two discs ----

// Euler's beta function.
static double beta( double p, double q )
{
    return tgamma( p ) * tgamma( q ) / tgamma( p + q );
}

// With t = x / r and u = t^4, the integral of t^n / sqrt( 1 - t^4 ) from 0 to 1 is B( ( n + 1 ) / 4, 1/2 ) / 4. n = 0 is the length of a
// meridian in r, n = 2 its height, and n = 4 the volume in 2 pi r^3 (both halves, by parts).
static double meridian_integral( int n )
{
    return 0.25 * beta( 0.25 * ( n + 1 ), 0.5 );
}

balloon_theory_mylar balloon_theory_mylar_shape( void )
{
    const double r = 1.0 / meridian_integral( 0 );
    return ( balloon_theory_mylar ){ .radius = r,
                                     .thickness = 2.0 * r * meridian_integral( 2 ),
                                     .volume = 2.0 * PI * r * r * r * meridian_integral( 4 ) };
}

// ---- a sphere of springs ----

double balloon_theory_sphere_pressure( const balloon_theory_sphere* sphere, double scale )
{
    const double stiffness = sphere->edge_stiffness + 3.0 * sphere->bend_link_stiffness;
    const double tension = sqrt( 3.0 ) * stiffness * ( scale - 1.0 ) / scale;
    return 2.0 * tension / ( scale * sphere->radius );
}

// The skin holds more the larger it is, up to s = 2, and the gas presses less.
double balloon_theory_sphere_scale( const balloon_theory_sphere* sphere )
{
    double lower = 1.0, upper = cbrt( sphere->gas_ratio );
    for ( int i = 0; i < 60; ++i )
    {
        const double s = 0.5 * ( lower + upper );
        const double gas = sphere->atmosphere * ( sphere->gas_ratio / ( s * s * s ) - 1.0 );
        *( balloon_theory_sphere_pressure( sphere, s ) < gas ? &lower : &upper ) = s;
    }
    return lower;
}

// ---- a jet ----

// With V = to + ( from - to ) u^2 both integrands stay finite where the pressure ends. Midpoints, because it is 0 there.
balloon_theory_flow balloon_theory_empty( const balloon_theory_jet* jet, double from, double to )
{
    enum
    {
        POINTS = 4000,
    };
    balloon_theory_flow flow = { 0.0, 0.0 };
    for ( int i = 0; i < POINTS; ++i )
    {
        const double u = ( i + 0.5 ) / POINTS, volume = to + ( from - to ) * u * u;
        const double part = 2.0 * ( from - to ) * u / POINTS; // dV
        const double speed = sqrt( 2.0 * fmax( 0.0, jet->pressure( jet->context, volume ) ) / jet->density );
        flow.speed += jet->density / jet->mass * speed * part;
        flow.seconds += part / ( jet->area * speed );
    }
    return flow;
}

// ---- flight ----

double balloon_theory_drag_factor( balloon_theory_drag law )
{
    // With dA = 2 pi R^2 dc, c the cosine: the integrals of max( 0, c ), |c| and c from -1 to 1, and of c^2, the part of a force
    // along the normal that is against v.
    static const double factors[BALLOON_THEORY_DRAG_COUNT] = { 1.0, 2.0, 0.0, 4.0 / 3.0 };
    return factors[law];
}

double balloon_theory_terminal_speed( double force, double air_density, double coefficient, double radius )
{
    return sqrt( 2.0 * force / ( air_density * coefficient * PI * radius * radius ) );
}

// ---- meshes ----

static const double pi = 3.14159265358979323846;

static bool allocate( balloon_mesh* mesh, int vertex_count, int triangle_count )
{
    balloon_mesh made = { .vertex_count = vertex_count, .triangle_count = triangle_count };
    made.positions = calloc( (size_t)vertex_count, sizeof( double3 ) );
    made.triangles = calloc( 3 * (size_t)triangle_count, sizeof( int ) );
    if ( made.positions == NULL || made.triangles == NULL )
    {
        balloon_mesh_destroy( &made );
        return false;
    }
    *mesh = made;
    return true;
}

static bool from_lists( balloon_mesh* mesh, int vertex_count, const double3* positions, double scale,
                        int triangle_count, const int* triangles )
{
    if ( !allocate( mesh, vertex_count, triangle_count ) )
    {
        return false;
    }
    for ( int i = 0; i < vertex_count; ++i )
    {
        mesh->positions[i] = double3_scale( scale, positions[i] );
    }
    memcpy( mesh->triangles, triangles, 3 * (size_t)triangle_count * sizeof( int ) );
    return true;
}

void balloon_mesh_destroy( balloon_mesh* mesh )
{
    free( mesh->positions );
    free( mesh->triangles );
    *mesh = ( balloon_mesh ){ 0 };
}

bool balloon_mesh_two_triangles( balloon_mesh* mesh, double edge )
{
    double h = 0.5 * sqrt( 3.0 );
    const double3 positions[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, h, 0 }, { 0.5, -h, 0 } };
    const int triangles[] = { 0, 1, 2, 1, 0, 3 };
    return from_lists( mesh, 4, positions, edge, 2, triangles );
}

bool balloon_mesh_cube( balloon_mesh* mesh, double edge )
{
    const double3 positions[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 },
                                  { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 } };
    const int triangles[] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                              1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7 };
    return from_lists( mesh, 8, positions, edge, 12, triangles );
}

static bool icosahedron( balloon_mesh* mesh, double radius )
{
    double g = 0.5 * ( 1.0 + sqrt( 5.0 ) );
    const double3 positions[] = { { -1, g, 0 }, { 1, g, 0 }, { -1, -g, 0 }, { 1, -g, 0 },
                                  { 0, -1, g }, { 0, 1, g }, { 0, -1, -g }, { 0, 1, -g },
                                  { g, 0, -1 }, { g, 0, 1 }, { -g, 0, -1 }, { -g, 0, 1 } };
    const int triangles[] = { 0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                              4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                              6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1 };
    return from_lists( mesh, 12, positions, radius / sqrt( 1.0 + g * g ), 20, triangles );
}

// Every triangle becomes four; the midpoint of edge e becomes vertex vertex_count + e, pushed out to the sphere.
static bool refine( balloon_mesh* mesh, double radius )
{
    balloon_mesh_topology topology;
    if ( !balloon_mesh_build_topology( mesh, &topology ) )
    {
        return false;
    }
    balloon_mesh fine;
    bool made = allocate( &fine, mesh->vertex_count + topology.edge_count, 4 * mesh->triangle_count );
    if ( made )
    {
        memcpy( fine.positions, mesh->positions, (size_t)mesh->vertex_count * sizeof( double3 ) );
        for ( int e = 0; e < topology.edge_count; ++e )
        {
            double3 sum = double3_add( mesh->positions[topology.edges[e].a], mesh->positions[topology.edges[e].b] );
            fine.positions[mesh->vertex_count + e] = double3_scale( radius / double3_length( sum ), sum );
        }
        for ( int t = 0; t < mesh->triangle_count; ++t )
        {
            const int* c = mesh->triangles + 3 * t;
            const int* edge = topology.triangle_edge + 3 * t;
            int m[3] = { mesh->vertex_count + edge[0], mesh->vertex_count + edge[1], mesh->vertex_count + edge[2] };
            const int four[12] = { c[0], m[0], m[2], c[1], m[1], m[0], c[2], m[2], m[1], m[0], m[1], m[2] };
            memcpy( fine.triangles + 12 * t, four, sizeof( four ) );
        }
        balloon_mesh_destroy( mesh );
        *mesh = fine;
    }
    balloon_mesh_destroy_topology( &topology );
    return made;
}

bool balloon_mesh_icosphere( balloon_mesh* mesh, int level, double radius )
{
    balloon_mesh made;
    if ( !icosahedron( &made, radius ) )
    {
        return false;
    }
    for ( int n = 0; n < level; ++n )
    {
        if ( !refine( &made, radius ) )
        {
            balloon_mesh_destroy( &made );
            return false;
        }
    }
    *mesh = made;
    return true;
}

bool balloon_mesh_pear( balloon_mesh* mesh, int level, double radius )
{
    if ( !balloon_mesh_icosphere( mesh, level, 1.0 ) )
    {
        return false;
    }
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        double3 p = mesh->positions[i];
        double swell = 1.0 + 0.25 * p.y + 0.15 * p.x * p.y + 0.1 * p.z - 0.1 * p.x * p.z;
        mesh->positions[i] = double3_scale( radius * swell, double3_make( 1.2 * p.x, p.y, 0.8 * p.z + 0.1 * p.x ) );
    }
    return true;
}

bool balloon_mesh_torus( balloon_mesh* mesh, int around, int across, double radius, double tube )
{
    if ( !allocate( mesh, around * across, 2 * around * across ) )
    {
        return false;
    }
    for ( int i = 0; i < around; ++i )
    {
        for ( int j = 0; j < across; ++j )
        {
            double a = 2.0 * pi * i / around, b = 2.0 * pi * j / across, r = radius + tube * cos( b );
            int next_i = ( i + 1 ) % around * across, next_j = ( j + 1 ) % across, at = i * across;
            mesh->positions[at + j] = double3_make( r * cos( a ), tube * sin( b ), r * sin( a ) );
            const int two[6] = { at + j, at + next_j, next_i + j, next_i + j, at + next_j, next_i + next_j };
            memcpy( mesh->triangles + 6 * ( at + j ), two, sizeof( two ) );
        }
    }
    return true;
}

bool balloon_mesh_join( balloon_mesh* mesh, const balloon_mesh* a, const balloon_mesh* b, double3 move_b )
{
    if ( !allocate( mesh, a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count ) )
    {
        return false;
    }
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        int j = i - a->vertex_count;
        mesh->positions[i] = j < 0 ? a->positions[i] : double3_add( b->positions[j], move_b );
    }
    for ( int n = 0; n < 3 * mesh->triangle_count; ++n )
    {
        int k = n - 3 * a->triangle_count;
        mesh->triangles[n] = k < 0 ? a->triangles[n] : b->triangles[k] + a->vertex_count;
    }
    return true;
}

int balloon_mesh_farthest( const balloon_mesh* mesh, double3 direction )
{
    int farthest = 0;
    for ( int i = 1; i < mesh->vertex_count; ++i )
    {
        double here = double3_dot( mesh->positions[i], direction );
        farthest = here > double3_dot( mesh->positions[farthest], direction ) ? i : farthest;
    }
    return farthest;
}

// Topology of a mesh.

typedef struct half_edge
{
    int lower, upper, triangle, corner;
} half_edge;

static int compare_half_edges( const void* left, const void* right )
{
    const half_edge *a = left, *b = right;
    if ( a->lower != b->lower )
    {
        return a->lower < b->lower ? -1 : 1;
    }
    if ( a->upper != b->upper )
    {
        return a->upper < b->upper ? -1 : 1;
    }
    return a->triangle != b->triangle ? ( a->triangle < b->triangle ? -1 : 1 ) : a->corner - b->corner;
}

static half_edge half_edge_of( const balloon_mesh* mesh, int triangle, int corner )
{
    int from = mesh->triangles[3 * triangle + corner], to = mesh->triangles[3 * triangle + ( corner + 1 ) % 3];
    half_edge half = { from < to ? from : to, from < to ? to : from, triangle, corner };
    return half;
}

static void add_use( const balloon_mesh* mesh, half_edge half, balloon_mesh_edge* edge )
{
    if ( edge->uses < 2 )
    {
        edge->triangle[edge->uses] = half.triangle;
        edge->opposite[edge->uses] = mesh->triangles[3 * half.triangle + ( half.corner + 2 ) % 3];
    }
    edge->uses += 1;
}

bool balloon_mesh_build_topology( const balloon_mesh* mesh, balloon_mesh_topology* topology )
{
    size_t count = 3 * (size_t)mesh->triangle_count;
    half_edge* halves = calloc( count + 1, sizeof( half_edge ) );
    balloon_mesh_topology made = { .edges = calloc( count + 1, sizeof( balloon_mesh_edge ) ),
                                   .triangle_edge = calloc( count + 1, sizeof( int ) ) };
    if ( halves == NULL || made.edges == NULL || made.triangle_edge == NULL )
    {
        free( halves );
        balloon_mesh_destroy_topology( &made );
        return false;
    }
    for ( int n = 0; n < 3 * mesh->triangle_count; ++n )
    {
        halves[n] = half_edge_of( mesh, n / 3, n % 3 );
    }
    qsort( halves, count, sizeof( half_edge ), compare_half_edges );
    for ( size_t n = 0; n < count; ++n )
    {
        half_edge half = halves[n];
        if ( n == 0 || half.lower != halves[n - 1].lower || half.upper != halves[n - 1].upper )
        {
            made.edges[made.edge_count++] = ( balloon_mesh_edge ){
                .a = half.lower, .b = half.upper, .triangle = { -1, -1 }, .opposite = { -1, -1 }
            };
        }
        add_use( mesh, half, made.edges + made.edge_count - 1 );
        made.triangle_edge[3 * half.triangle + half.corner] = made.edge_count - 1;
    }
    free( halves );
    for ( int e = 0; e < made.edge_count; ++e )
    {
        made.border_count += made.edges[e].uses == 1 ? 1 : 0;
    }
    *topology = made;
    return true;
}

void balloon_mesh_destroy_topology( balloon_mesh_topology* topology )
{
    free( topology->edges );
    free( topology->triangle_edge );
    *topology = ( balloon_mesh_topology ){ 0 };
}

int balloon_mesh_structural_pairs( const balloon_mesh_topology* topology, int* pairs )
{
    for ( int e = 0; e < topology->edge_count; ++e )
    {
        pairs[2 * e] = topology->edges[e].a;
        pairs[2 * e + 1] = topology->edges[e].b;
    }
    return topology->edge_count;
}

int balloon_mesh_bend_pairs( const balloon_mesh_topology* topology, int* pairs )
{
    int count = 0;
    for ( int e = 0; e < topology->edge_count; ++e )
    {
        if ( topology->edges[e].uses == 2 )
        {
            pairs[2 * count] = topology->edges[e].opposite[0];
            pairs[2 * count + 1] = topology->edges[e].opposite[1];
            count += 1;
        }
    }
    return count;
}

// next[v] is the vertex after v on the border, against the direction of the triangle at the border edge.
static bool link_border( const balloon_mesh* mesh, const balloon_mesh_topology* topology, int* next )
{
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        next[v] = -1;
    }
    for ( int n = 0; n < 3 * mesh->triangle_count; ++n )
    {
        int from = mesh->triangles[n], to = mesh->triangles[n - n % 3 + ( n + 1 ) % 3];
        if ( topology->edges[topology->triangle_edge[n]].uses == 1 )
        {
            if ( next[to] >= 0 )
            {
                return false;
            }
            next[to] = from;
        }
    }
    return true;
}

static bool cap_loop( const balloon_mesh* mesh, int start, int* next, double* volume )
{
    double3 origin = mesh->positions[mesh->triangles[0]], middle = { 0.0, 0.0, 0.0 };
    int count = 0;
    for ( int v = start; count == 0 || v != start; v = next[v], ++count )
    {
        if ( next[v] < 0 || count > mesh->vertex_count )
        {
            return false;
        }
        middle = double3_add( middle, double3_sub( mesh->positions[v], origin ) );
    }
    middle = double3_scale( 1.0 / count, middle );
    for ( int v = start; next[v] >= 0; )
    {
        int after = next[v];
        double3 a = double3_sub( mesh->positions[v], origin ), b = double3_sub( mesh->positions[after], origin );
        *volume += double3_dot( double3_cross( a, b ), middle ) / 6.0;
        next[v] = -1;
        v = after;
    }
    return true;
}

bool balloon_mesh_capped_volume( const balloon_mesh* mesh, double* volume )
{
    balloon_mesh_topology topology;
    if ( !balloon_mesh_build_topology( mesh, &topology ) )
    {
        return false;
    }
    int* next = calloc( (size_t)mesh->vertex_count + 1, sizeof( int ) );
    bool sound = next != NULL && link_border( mesh, &topology, next );
    *volume = constraint_oracle_volume( mesh->positions, mesh->triangles, mesh->triangle_count );
    for ( int v = 0; sound && v < mesh->vertex_count; ++v )
    {
        sound = next[v] < 0 || cap_loop( mesh, v, next, volume );
    }
    free( next );
    balloon_mesh_destroy_topology( &topology );
    return sound;
}

// Assign a hub to every vertex of the loop that begins at a vertex, and compute the hub's position.
// @return false when the border does not return to its start
static bool add_hub( balloon_mesh* capped, const int* next, int start, int vertex_count, int* hub )
{
    int at = capped->vertex_count, count = 0;
    double3 sum = { 0.0, 0.0, 0.0 }, origin = capped->positions[start];
    for ( int v = start; count == 0 || v != start; v = next[v], ++count )
    {
        if ( next[v] < 0 || count > vertex_count )
        {
            return false;
        }
        sum = double3_add( sum, double3_sub( capped->positions[v], origin ) );
        hub[v] = at;
    }
    capped->positions[at] = double3_add( origin, double3_scale( 1.0 / count, sum ) );
    capped->vertex_count += 1;
    return true;
}

// next[v] follows the border against its triangles, so v, next[v], hub is a triangle that runs with them.
static bool add_fans( const balloon_mesh* mesh, const int* next, balloon_mesh* capped, int* hub )
{
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        hub[v] = -1;
    }
    bool sound = true;
    for ( int v = 0; v < mesh->vertex_count && sound; ++v )
    {
        sound = next[v] < 0 || hub[v] >= 0 || add_hub( capped, next, v, mesh->vertex_count, hub );
    }
    for ( int v = 0; v < mesh->vertex_count && sound; ++v )
    {
        if ( next[v] >= 0 )
        {
            int* corner = capped->triangles + 3 * capped->triangle_count++;
            corner[0] = v;
            corner[1] = next[v];
            corner[2] = hub[v];
        }
    }
    return sound;
}

bool balloon_mesh_cap( const balloon_mesh* mesh, balloon_mesh* capped, int* hub )
{
    balloon_mesh_topology topology;
    if ( !balloon_mesh_build_topology( mesh, &topology ) )
    {
        return false;
    }
    size_t n = (size_t)mesh->vertex_count, m = 3 * (size_t)mesh->triangle_count;
    size_t borders = (size_t)topology.border_count; // upper bound of hubs, exact number of triangles
    *capped = ( balloon_mesh ){ .vertex_count = mesh->vertex_count, .triangle_count = mesh->triangle_count };
    capped->positions = calloc( n + borders + 1, sizeof( double3 ) );
    capped->triangles = calloc( m + 3 * borders + 1, sizeof( int ) );
    int* next = calloc( n + 1, sizeof( int ) );
    bool sound = capped->positions != NULL && capped->triangles != NULL && next != NULL;
    if ( sound )
    {
        memcpy( capped->positions, mesh->positions, n * sizeof( double3 ) );
        memcpy( capped->triangles, mesh->triangles, m * sizeof( int ) );
        sound = link_border( mesh, &topology, next ) && add_fans( mesh, next, capped, hub );
    }
    if ( !sound )
    {
        balloon_mesh_destroy( capped );
    }
    free( next );
    balloon_mesh_destroy_topology( &topology );
    return sound;
}
