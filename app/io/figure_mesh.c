// The zero level of a field as triangles: dual marching cubes (Nielson 2004). Each sheet of the surface in a cube has one vertex, so
// that edges have two triangles also where two sheets pass through one cube. Vertices are then spread evenly along the surface.
#include "figure_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    EDGES = 12,
    SMOOTHINGS = 20,
    FLIP_PASSES = 12,
};

// Corner x + 2 y + 4 z. Edge 4 a + u + 2 v runs along axis a, at the places u and v on the axes after it.
typedef struct net
{
    int nodes[3];
    size_t step[3]; // to the next node along an axis
    mesh_vector lower;
    double cell;
    float* value;            // [node]
    int32_t* first;          // [node] first vertex of the cube that begins there
    uint8_t* code;           // [node] corners of the cube that are inside
    int8_t part[256][EDGES]; // sheet of an edge, -1: not crossed
    int8_t part_count[256];
    mesh_vector* points;
    int point_count;
    int32_t ( *quads )[4];
    int quad_count;
} net;

static int edge_at( int axis, const int at[3] )
{
    return 4 * axis + at[( axis + 1 ) % 3] + 2 * at[( axis + 2 ) % 3];
}

static bool is_inside( int code, const int at[3] )
{
    return ( code >> ( at[0] + 2 * at[1] + 4 * at[2] ) & 1 ) != 0;
}

static void merge( int8_t* part, int a, int b )
{
    const int8_t from = part[a] > part[b] ? part[a] : part[b], to = part[a] > part[b] ? part[b] : part[a];
    for ( int e = 0; e < EDGES; ++e )
    {
        part[e] = part[e] == from ? to : part[e];
    }
}

// A face with two crossed edges joins them. One with four keeps its inside corners apart: both cubes decide alike.
static void join_face( int code, int axis, int side, int8_t* part )
{
    const int u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
    int crossed[4], count = 0;
    for ( int i = 0; i < 4; ++i )
    {
        int at[3] = { 0 };
        at[axis] = side;
        at[i < 2 ? v : u] = i & 1;
        const int e = edge_at( i < 2 ? u : v, at );
        if ( part[e] >= 0 )
        {
            crossed[count++] = e;
        }
    }
    if ( count == 2 )
    {
        merge( part, crossed[0], crossed[1] );
    }
    for ( int corner = 0; corner < 4 && count == 4; ++corner )
    {
        int at[3] = { 0 }, along_u[3] = { 0 }, along_v[3] = { 0 };
        at[axis] = along_u[axis] = along_v[axis] = side;
        at[u] = along_v[u] = corner & 1;
        at[v] = along_u[v] = corner >> 1;
        if ( is_inside( code, at ) )
        {
            merge( part, edge_at( u, along_u ), edge_at( v, along_v ) );
        }
    }
}

static void make_parts( net* n )
{
    for ( int code = 0; code < 256; ++code )
    {
        int8_t* part = n->part[code];
        for ( int e = 0; e < EDGES; ++e )
        {
            const int axis = e / 4;
            int a[3] = { 0 }, b[3];
            a[( axis + 1 ) % 3] = e & 1;
            a[( axis + 2 ) % 3] = e >> 1 & 1;
            memcpy( b, a, sizeof( b ) );
            b[axis] = 1;
            part[e] = (int8_t)( is_inside( code, a ) != is_inside( code, b ) ? e : -1 );
        }
        for ( int face = 0; face < 6; ++face )
        {
            join_face( code, face / 2, face & 1, part );
        }
        int8_t names[EDGES], count = 0;
        memset( names, -1, sizeof( names ) );
        for ( int e = 0; e < EDGES; ++e )
        {
            if ( part[e] >= 0 )
            {
                names[part[e]] = names[part[e]] >= 0 ? names[part[e]] : count++;
                part[e] = names[part[e]];
            }
        }
        n->part_count[code] = count;
    }
}

static mesh_vector node_point( const net* n, const int at[3] )
{
    return ( mesh_vector ){ n->lower.x + n->cell * at[0], n->lower.y + n->cell * at[1],
                            n->lower.z + n->cell * at[2] };
}

static size_t node_index( const net* n, const int at[3] )
{
    return (size_t)at[0] * n->step[0] + (size_t)at[1] * n->step[1] + (size_t)at[2] * n->step[2];
}

static void sample_nodes( net* n, figure_field* field, const void* context )
{
    int at[3];
    for ( at[2] = 0; at[2] < n->nodes[2]; ++at[2] )
    {
        for ( at[1] = 0; at[1] < n->nodes[1]; ++at[1] )
        {
            for ( at[0] = 0; at[0] < n->nodes[0]; ++at[0] )
            {
                n->value[node_index( n, at )] = (float)field( context, node_point( n, at ) ).distance;
            }
        }
    }
}

// Vertices of a cube: the mean of the crossings of each sheet.
static void put_cube( net* n, const int at[3], bool counts_only )
{
    const size_t node = node_index( n, at );
    int code = 0;
    for ( int c = 0; c < 8; ++c )
    {
        const size_t corner = node + (size_t)( c & 1 ) * n->step[0] + (size_t)( c >> 1 & 1 ) * n->step[1] +
                              (size_t)( c >> 2 ) * n->step[2];
        code |= ( n->value[corner] < 0.0f ? 1 : 0 ) << c;
    }
    n->code[node] = (uint8_t)code;
    n->first[node] = n->point_count;
    n->point_count += n->part_count[code];
    for ( int part = 0; part < n->part_count[code] && !counts_only; ++part )
    {
        mesh_vector sum = { 0 };
        int count = 0;
        for ( int e = 0; e < EDGES; ++e )
        {
            const int axis = e / 4;
            double place[3] = { 0.0 };
            place[( axis + 1 ) % 3] = e & 1;
            place[( axis + 2 ) % 3] = e >> 1 & 1;
            size_t from = node;
            for ( int k = 0; k < 3; ++k )
            {
                from += place[k] > 0.5 ? n->step[k] : 0;
            }
            const double a = (double)n->value[from], b = (double)n->value[from + n->step[axis]];
            place[axis] = n->part[code][e] >= 0 ? a / ( a - b ) : 0.0;
            const double used = n->part[code][e] == part ? 1.0 : 0.0;
            sum.x += used * place[0], sum.y += used * place[1], sum.z += used * place[2];
            count += used > 0.5 ? 1 : 0;
        }
        const mesh_vector p = node_point( n, at );
        n->points[n->first[node] + part] =
            ( mesh_vector ){ p.x + n->cell * sum.x / count, p.y + n->cell * sum.y / count,
                             p.z + n->cell * sum.z / count };
    }
}

// The quads around the edges that begin at a node and are crossed. The border of the grid is outside.
static void put_quads( net* n, const int at[3], bool counts_only )
{
    const size_t node = node_index( n, at );
    for ( int axis = 0; axis < 3; ++axis )
    {
        const int u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
        const bool a = n->value[node] < 0.0f,
                   b = at[axis] + 1 < n->nodes[axis] && n->value[node + n->step[axis]] < 0.0f;
        if ( a == b || at[u] == 0 || at[v] == 0 || at[axis] + 1 == n->nodes[axis] )
        {
            continue;
        }
        for ( int i = 0; i < 4 && !counts_only; ++i )
        {
            // around the edge: both lower, higher along u, both higher, higher along v; the other way where it leads inside
            const int turn = a ? i : 3 - i, du = turn == 0 || turn == 3 ? 1 : 0, dv = turn < 2 ? 1 : 0;
            const size_t cube = node - (size_t)du * n->step[u] - (size_t)dv * n->step[v];
            n->quads[n->quad_count][i] = n->first[cube] + n->part[n->code[cube]][4 * axis + du + 2 * dv];
        }
        n->quad_count += 1;
    }
}

static void walk_cubes( net* n, bool counts_only, void ( *put )( net*, const int*, bool ) )
{
    int at[3];
    for ( at[2] = 0; at[2] + 1 < n->nodes[2]; ++at[2] )
    {
        for ( at[1] = 0; at[1] + 1 < n->nodes[1]; ++at[1] )
        {
            for ( at[0] = 0; at[0] + 1 < n->nodes[0]; ++at[0] )
            {
                put( n, at, counts_only );
            }
        }
    }
}

// ---- even spacing ----

static mesh_vector along( mesh_vector a, double s, mesh_vector b )
{
    return ( mesh_vector ){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

// Newton's method along the gradient, at most a cell in all.
static mesh_vector project( const net* n, figure_field* field, const void* context, mesh_vector p )
{
    for ( int i = 0; i < 2; ++i )
    {
        const figure_sample s = field( context, p );
        const double squared = mesh_dot( s.gradient, s.gradient );
        double step = squared > 1e-6 ? -s.distance / squared : 0.0;
        const double most = 0.5 * n->cell / sqrt( squared > 1e-6 ? squared : 1.0 );
        step = step > most ? most : step < -most ? -most : step;
        p = along( p, step, s.gradient );
    }
    return p;
}

// Each vertex goes half the way to the mean of its neighbours, along the surface.
static void spread( net* n, figure_field* field, const void* context, mesh_vector* sum, int* count )
{
    memset( sum, 0, (size_t)n->point_count * sizeof *sum );
    memset( count, 0, (size_t)n->point_count * sizeof *count );
    for ( int q = 0; q < n->quad_count; ++q )
    {
        for ( int i = 0; i < 4; ++i )
        {
            const int32_t v = n->quads[q][i], after = n->quads[q][( i + 1 ) % 4], before = n->quads[q][( i + 3 ) % 4];
            sum[v] = along( along( sum[v], 1.0, n->points[after] ), 1.0, n->points[before] );
            count[v] += 2;
        }
    }
    for ( int v = 0; v < n->point_count; ++v )
    {
        const mesh_vector p = n->points[v], normal = field( context, p ).gradient;
        const double scale = 1.0 / count[v], squared = mesh_dot( normal, normal );
        mesh_vector move = { scale * sum[v].x - p.x, scale * sum[v].y - p.y, scale * sum[v].z - p.z };
        move = along( move, squared > 1e-6 ? -mesh_dot( move, normal ) / squared : 0.0, normal );
        n->points[v] = project( n, field, context, along( p, 0.5, move ) );
    }
}

static double squared_distance( const net* n, int32_t a, int32_t b )
{
    const mesh_vector d = along( n->points[a], -1.0, n->points[b] );
    return mesh_dot( d, d );
}

// The shorter diagonal splits a quad.
static void put_triangles( const net* n, wisp_mesh* out )
{
    for ( int v = 0; v < n->point_count; ++v )
    {
        out->points[v] = ( wisp_vec3 ){ (float)n->points[v].x, (float)n->points[v].y, (float)n->points[v].z };
    }
    for ( int q = 0; q < n->quad_count; ++q )
    {
        const int32_t* v = n->quads[q];
        const int k = squared_distance( n, v[0], v[2] ) <= squared_distance( n, v[1], v[3] ) ? 0 : 1;
        const int32_t two[6] = { v[k], v[k + 1], v[( k + 2 ) % 4], v[k], v[( k + 2 ) % 4], v[( k + 3 ) % 4] };
        memcpy( out->triangles + 6 * (size_t)q, two, sizeof( two ) );
    }
}

// ---- flips ----

// Cotangent of the angle at c in the triangle a b c.
static double cotangent( const wisp_mesh* m, int32_t a, int32_t b, int32_t c )
{
    const mesh_vector u = mesh_between( m->points[c], m->points[a] ), v = mesh_between( m->points[c], m->points[b] );
    const mesh_vector n = mesh_cross( u, v );
    return mesh_dot( u, v ) / sqrt( mesh_dot( n, n ) + 1e-30 );
}

static bool are_flat( const wisp_mesh* m, int32_t a, int32_t b, int32_t c, int32_t d )
{
    const mesh_vector ab = mesh_between( m->points[a], m->points[b] );
    const mesh_vector up = mesh_cross( ab, mesh_between( m->points[a], m->points[c] ) ),
                      down = mesh_cross( mesh_between( m->points[a], m->points[d] ), ab );
    const double dot = mesh_dot( up, down );
    return dot > 0.0 && dot * dot > 0.5 * mesh_dot( up, up ) * mesh_dot( down, down );
}

static bool has_edge( const wisp_mesh* m, const mesh_edges* edges, int32_t a, int32_t b )
{
    const int32_t low = a < b ? a : b, high = a < b ? b : a;
    int first = 0, last = edges->edge_count;
    while ( first < last )
    {
        const int middle = first + ( last - first ) / 2, half = edges->half[edges->starts[middle]];
        const int32_t from = mesh_from( m, half ), to = mesh_to( m, half );
        const int32_t l = from < to ? from : to, h = from < to ? to : from;
        if ( l == low && h == high )
        {
            return true;
        }
        *( l < low || ( l == low && h < high ) ? &first : &last ) =
            l < low || ( l == low && h < high ) ? middle + 1 : middle;
    }
    return false;
}

// One pass of Delaunay's criterion: an edge whose opposite angles sum to more than 180 degrees gives way to the other diagonal,
// where the surface is flat. Vertices are touched once, so that the table of edges stays true. @return how many were flipped
static int flip_edges( wisp_mesh* m, bool* touched, const mesh_edges* edges )
{
    int flips = 0;
    memset( touched, 0, (size_t)m->vertex_count * sizeof *touched );
    for ( int e = 0; e < edges->edge_count; ++e )
    {
        const int32_t one = edges->half[edges->starts[e]], other = edges->half[edges->starts[e] + 1];
        if ( edges->starts[e + 1] - edges->starts[e] != 2 || touched[m->triangles[one]] ||
             touched[m->triangles[other]] )
        {
            continue;
        }
        const int32_t a = mesh_from( m, one ), b = mesh_to( m, one ), c = mesh_to( m, mesh_next_half( one ) ),
                      d = mesh_to( m, mesh_next_half( other ) );
        if ( touched[c] || touched[d] || c == d || cotangent( m, a, b, c ) + cotangent( m, a, b, d ) > -1e-3 ||
             !are_flat( m, a, b, c, d ) || has_edge( m, edges, c, d ) )
        {
            continue;
        }
        const int32_t left[3] = { a, d, c }, right[3] = { d, b, c };
        memcpy( m->triangles + one / 3 * 3, left, sizeof( left ) );
        memcpy( m->triangles + other / 3 * 3, right, sizeof( right ) );
        touched[a] = touched[b] = touched[c] = touched[d] = true;
        flips += 1;
    }
    return flips;
}

static wisp_status make_delaunay( wisp_mesh* m, wisp_error* error )
{
    bool* touched = malloc( (size_t)m->vertex_count * sizeof *touched );
    wisp_status status = touched != NULL ? WISP_OK : WISP_NO_MEMORY;
    int flips = 1;
    for ( int pass = 0; pass < FLIP_PASSES && status == WISP_OK && flips > 0; ++pass )
    {
        mesh_edges edges;
        status = mesh_edges_build( m, &edges, error );
        if ( status == WISP_OK )
        {
            flips = flip_edges( m, touched, &edges );
            mesh_edges_release( &edges );
        }
    }
    free( touched );
    return status;
}

static wisp_status run( net* n, figure_field* field, const void* context, wisp_mesh* out, wisp_error* error )
{
    const wisp_status short_of_memory = wisp_fail( NULL, WISP_NO_MEMORY, "figure" );
    make_parts( n );
    sample_nodes( n, field, context );
    walk_cubes( n, true, put_cube );
    walk_cubes( n, true, put_quads );
    n->points = malloc( (size_t)n->point_count * sizeof *n->points );
    n->quads = malloc( (size_t)n->quad_count * sizeof *n->quads );
    mesh_vector* sum = malloc( (size_t)n->point_count * sizeof *sum );
    int* count = malloc( (size_t)n->point_count * sizeof *count );
    wisp_status status = n->points && n->quads && sum && count ? WISP_OK : short_of_memory;
    if ( status == WISP_OK )
    {
        status = mesh_allocate( out, n->point_count, 2 * n->quad_count, "figure", error );
    }
    if ( status == WISP_OK )
    {
        n->point_count = n->quad_count = 0;
        walk_cubes( n, false, put_cube );
        walk_cubes( n, false, put_quads );
        for ( int i = 0; i < SMOOTHINGS; ++i )
        {
            spread( n, field, context, sum, count );
        }
        put_triangles( n, out );
        status = make_delaunay( out, error );
    }
    free( sum );
    free( count );
    return status;
}

wisp_status figure_mesh( figure_field* field, const void* context, mesh_vector lower, mesh_vector upper, double cell,
                         wisp_mesh* out, wisp_error* error )
{
    *out = ( wisp_mesh ){ 0 };
    net n = { .lower = lower, .cell = cell };
    const double size[3] = { upper.x - lower.x, upper.y - lower.y, upper.z - lower.z };
    size_t count = 1;
    for ( int k = 0; k < 3; ++k )
    {
        n.nodes[k] = (int)( size[k] / cell ) + 2;
        n.step[k] = count;
        count *= (size_t)n.nodes[k];
    }
    n.value = malloc( count * sizeof *n.value );
    n.first = malloc( count * sizeof *n.first );
    n.code = calloc( count, sizeof *n.code );
    wisp_status status = WISP_NO_MEMORY;
    if ( n.value != NULL && n.first != NULL && n.code != NULL )
    {
        status = run( &n, field, context, out, error );
    }
    if ( status == WISP_NO_MEMORY )
    {
        wisp_fail( error, WISP_NO_MEMORY, "figure: out of memory for %zu cubes", count );
    }
    free( n.value );
    free( n.first );
    free( n.code );
    free( n.points );
    free( n.quads );
    return status;
}
