// The scalar C implicit cloth before its first step: springs of a mesh, rows of the matrix, masses, memory.
#include "implicit_cloth_plain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static wisp_vec3 difference( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static float length( wisp_vec3 a )
{
    return sqrtf( a.x * a.x + a.y * a.y + a.z * a.z );
}

// ---- springs of a mesh ----

typedef struct side
{
    int a, b; // of the edge, a < b
    int opposite;
} side;

typedef struct pair
{
    int a, b;
} pair;

static int by_edge( const void* left, const void* right )
{
    const side *p = left, *q = right;
    return p->a != q->a ? p->a - q->a : p->b != q->b ? p->b - q->b : p->opposite - q->opposite;
}

static int by_ends( const void* left, const void* right )
{
    const pair *p = left, *q = right;
    return p->a != q->a ? p->a - q->a : p->b - q->b;
}

static int keep_different( pair* pairs, int count )
{
    int kept = 0;
    qsort( pairs, (size_t)count, sizeof( pair ), by_ends );
    for ( int i = 0; i < count; ++i )
    {
        if ( kept == 0 || by_ends( &pairs[kept - 1], &pairs[i] ) != 0 )
        {
            pairs[kept++] = pairs[i];
        }
    }
    return kept;
}

// Every two triangles of an edge have a diagonal across it.
static int list_diagonals( const side* sides, int side_count, pair* out )
{
    int count = 0;
    for ( int i = 0; i < side_count; ++i )
    {
        for ( int k = i + 1; k < side_count && sides[k].a == sides[i].a && sides[k].b == sides[i].b; ++k )
        {
            int p = sides[i].opposite, q = sides[k].opposite;
            if ( p != q )
            {
                if ( out )
                {
                    out[count] = ( pair ){ p < q ? p : q, p < q ? q : p };
                }
                ++count;
            }
        }
    }
    return count;
}

static void add_springs( plain_implicit_cloth* cloth, const pair* pairs, int count, bool bends )
{
    for ( int i = 0; i < count; ++i )
    {
        wisp_vec3 d = difference( cloth->position[pairs[i].b], cloth->position[pairs[i].a] );
        cloth->springs[cloth->spring_count++] =
            ( plain_spring ){ .a = pairs[i].a, .b = pairs[i].b, .bends = bends, .rest = length( d ) };
    }
}

static bool make_springs( plain_implicit_cloth* cloth, const int32_t* triangles, int triangle_count )
{
    int side_count = 3 * triangle_count;
    side* sides = malloc( (size_t)side_count * sizeof( side ) );
    pair* edges = malloc( (size_t)side_count * sizeof( pair ) );
    pair* diagonals = NULL;
    bool complete = sides && edges;
    for ( int i = 0; i < side_count && complete; ++i )
    {
        const int32_t* t = triangles + 3 * ( i / 3 );
        int a = t[i % 3], b = t[( i + 1 ) % 3];
        sides[i] = ( side ){ a < b ? a : b, a < b ? b : a, t[( i + 2 ) % 3] };
        edges[i] = ( pair ){ sides[i].a, sides[i].b };
    }
    if ( complete )
    {
        qsort( sides, (size_t)side_count, sizeof( side ), by_edge );
        int edge_count = keep_different( edges, side_count );
        int diagonal_count = list_diagonals( sides, side_count, NULL );
        diagonals = malloc( ( (size_t)diagonal_count + 1 ) * sizeof( pair ) );
        cloth->springs = malloc( ( (size_t)edge_count + (size_t)diagonal_count ) * sizeof( plain_spring ) );
        complete = diagonals && cloth->springs;
        if ( complete )
        {
            list_diagonals( sides, side_count, diagonals );
            add_springs( cloth, edges, edge_count, false );
            add_springs( cloth, diagonals, keep_different( diagonals, diagonal_count ), true );
            cloth->edge_count = edge_count;
        }
    }
    free( sides );
    free( edges );
    free( diagonals );
    return complete;
}

// ---- rows of the matrix ----

static int find_block( const plain_implicit_cloth* cloth, int row, int column )
{
    int k = cloth->row_begin[row];
    while ( cloth->column[k] != column )
    {
        ++k;
    }
    return k;
}

static bool make_rows( plain_implicit_cloth* cloth )
{
    int place_count = cloth->vertex_count + 2 * cloth->spring_count;
    pair* places = malloc( (size_t)place_count * sizeof( pair ) );
    if ( !places )
    {
        return false;
    }
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        places[v] = ( pair ){ v, v };
    }
    for ( int i = 0; i < cloth->spring_count; ++i )
    {
        const plain_spring* s = &cloth->springs[i];
        places[cloth->vertex_count + 2 * i] = ( pair ){ s->a, s->b };
        places[cloth->vertex_count + 2 * i + 1] = ( pair ){ s->b, s->a };
    }
    place_count = keep_different( places, place_count );
    cloth->column = malloc( (size_t)place_count * sizeof( int ) );
    cloth->block = malloc( (size_t)place_count * sizeof( plain_block ) );
    bool complete = cloth->column && cloth->block;
    for ( int k = 0; k < place_count && complete; ++k )
    {
        cloth->column[k] = places[k].b;
        cloth->row_begin[places[k].a + 1] = k + 1;
        if ( places[k].a == places[k].b )
        {
            cloth->diagonal[places[k].a] = k;
        }
    }
    for ( int i = 0; i < cloth->spring_count && complete; ++i )
    {
        plain_spring* s = &cloth->springs[i];
        s->to_a_of_b = find_block( cloth, s->a, s->b );
        s->to_b_of_a = find_block( cloth, s->b, s->a );
    }
    free( places );
    return complete;
}

static int neighbours_of( const plain_implicit_cloth* cloth, int vertex )
{
    return cloth->row_begin[vertex + 1] - cloth->row_begin[vertex] - 1;
}

// A third of the mass of its triangles, times the relative number of neighbours of a vertex.
static void make_masses( plain_implicit_cloth* cloth, const int32_t* triangles, int triangle_count )
{
    for ( int t = 0; t < triangle_count; ++t )
    {
        const int32_t* c = triangles + 3 * t;
        wisp_vec3 p = difference( cloth->position[c[1]], cloth->position[c[0]] );
        wisp_vec3 q = difference( cloth->position[c[2]], cloth->position[c[0]] );
        wisp_vec3 n = { p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x };
        for ( int k = 0; k < 3; ++k )
        {
            cloth->mass[c[k]] += cloth->material.area_density * length( n ) / 6.0f;
        }
    }
    int most = 1;
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        most = neighbours_of( cloth, v ) > most ? neighbours_of( cloth, v ) : most;
    }
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        cloth->mass[v] *= (float)neighbours_of( cloth, v ) / (float)most;
    }
}

bool plain_implicit_cloth_create( plain_implicit_cloth* cloth, const wisp_vec3* points, int vertex_count,
                                  const int32_t* triangles, int triangle_count,
                                  const plain_implicit_material* material )
{
    enum
    {
        VECTORS = 8,
    };
    size_t n = (size_t)vertex_count;
    *cloth = ( plain_implicit_cloth ){
        .material = *material,
        .vertex_count = vertex_count,
        .vectors = calloc( VECTORS * n, sizeof( wisp_vec3 ) ),
        .mass = calloc( n, sizeof( float ) ),
        .pinned = calloc( n, sizeof( bool ) ),
        .row_begin = calloc( n + 1, sizeof( int ) ),
        .diagonal = calloc( n, sizeof( int ) ),
        .inverse = calloc( n, sizeof( plain_block ) ),
    };
    bool complete =
        cloth->vectors && cloth->mass && cloth->pinned && cloth->row_begin && cloth->diagonal && cloth->inverse;
    wisp_vec3** const vectors[VECTORS] = { &cloth->position, &cloth->velocity,  &cloth->change,  &cloth->right,
                                           &cloth->residual, &cloth->direction, &cloth->product, &cloth->search };
    for ( int i = 0; i < VECTORS && complete; ++i )
    {
        *vectors[i] = cloth->vectors + (size_t)i * n;
    }
    if ( complete )
    {
        memcpy( cloth->position, points, n * sizeof( wisp_vec3 ) );
        complete = make_springs( cloth, triangles, triangle_count ) && make_rows( cloth );
    }
    if ( complete )
    {
        make_masses( cloth, triangles, triangle_count );
    }
    else
    {
        plain_implicit_cloth_destroy( cloth );
    }
    return complete;
}

void plain_implicit_cloth_destroy( plain_implicit_cloth* cloth )
{
    free( cloth->vectors );
    free( cloth->mass );
    free( cloth->pinned );
    free( cloth->springs );
    free( cloth->row_begin );
    free( cloth->column );
    free( cloth->diagonal );
    free( cloth->block );
    free( cloth->inverse );
    *cloth = ( plain_implicit_cloth ){ 0 };
}

void plain_implicit_cloth_pin( plain_implicit_cloth* cloth, int vertex )
{
    cloth->pinned[vertex] = true;
    cloth->velocity[vertex] = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
}
