#include "cloth_plain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A directed side of a triangle and the vertex opposite to it.
typedef struct side
{
    int lower, upper; // of the edge
    int opposite;
    int order; // in the direction of its triangle
} side;

static int by_edge( const void* left, const void* right )
{
    const side *a = left, *b = right;
    if ( a->lower != b->lower )
    {
        return a->lower < b->lower ? -1 : 1;
    }
    if ( a->upper != b->upper )
    {
        return a->upper < b->upper ? -1 : 1;
    }
    return a->order < b->order ? -1 : 1;
}

static int by_order( const void* left, const void* right )
{
    const side *a = left, *b = right;
    return a->order < b->order ? -1 : ( a->order > b->order ? 1 : 0 );
}

static float distance( wisp_vec3 a, wisp_vec3 b )
{
    float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrtf( x * x + y * y + z * z );
}

static void add_link( plain_cloth* cloth, int a, int b, float stiffness )
{
    float rest = distance( cloth->position[a], cloth->position[b] );
    cloth->links[cloth->link_count++] = ( plain_link ){ a, b, rest, stiffness };
}

// Each edge once, in the order of the triangles; `pairs` gets the opposite vertices of edges with two triangles.
static void collect_links( plain_cloth* cloth, side* sides, int side_count, float bend_stiffness )
{
    qsort( sides, (size_t)side_count, sizeof( side ), by_edge );
    side* edges = sides + side_count; // memory for both lists after the sides
    int edge_count = 0;
    side* pairs = edges + side_count;
    int pair_count = 0;
    for ( int i = 0, next; i < side_count; i = next )
    {
        for ( next = i + 1;
              next < side_count && sides[next].lower == sides[i].lower && sides[next].upper == sides[i].upper; )
        {
            ++next;
        }
        edges[edge_count++] = sides[i];
        if ( next == i + 2 && sides[i].opposite != sides[i + 1].opposite )
        {
            pairs[pair_count++] = ( side ){ sides[i].opposite, sides[i + 1].opposite, 0, sides[i].order };
        }
    }
    qsort( edges, (size_t)edge_count, sizeof( side ), by_order );
    qsort( pairs, (size_t)pair_count, sizeof( side ), by_order );
    for ( int i = 0; i < edge_count; ++i )
    {
        add_link( cloth, edges[i].lower, edges[i].upper, 1.0f );
    }
    cloth->edge_count = cloth->link_count;
    for ( int i = 0; i < pair_count; ++i )
    {
        add_link( cloth, pairs[i].lower, pairs[i].upper, bend_stiffness );
    }
}

bool plain_cloth_create( plain_cloth* cloth, const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                         int triangle_count, float mass, float bend_stiffness )
{
    size_t vertices = (size_t)vertex_count, sides_count = 3 * (size_t)triangle_count;
    *cloth = ( plain_cloth ){
        .vertex_count = vertex_count,
        .position = calloc( vertices, sizeof( wisp_vec3 ) ),
        .previous = calloc( vertices, sizeof( wisp_vec3 ) ),
        .velocity = calloc( vertices, sizeof( wisp_vec3 ) ),
        .inverse_mass = calloc( vertices, sizeof( float ) ),
        .links = calloc( 2 * sides_count, sizeof( plain_link ) ),
        .gravity = { 0.0f, -9.81f, 0.0f },
        .substeps = 1,
        .passes = 1,
    };
    side* sides = calloc( 3 * sides_count, sizeof( side ) );
    bool complete =
        cloth->position && cloth->previous && cloth->velocity && cloth->inverse_mass && cloth->links && sides;
    for ( int v = 0; v < vertex_count && complete; ++v )
    {
        cloth->position[v] = points[v];
        cloth->inverse_mass[v] = 1.0f / mass;
    }
    for ( int t = 0; t < triangle_count && complete; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            int a = triangles[3 * t + k], b = triangles[3 * t + ( k + 1 ) % 3];
            sides[3 * t + k] = ( side ){ a < b ? a : b, a < b ? b : a, triangles[3 * t + ( k + 2 ) % 3], 3 * t + k };
        }
    }
    if ( complete )
    {
        collect_links( cloth, sides, (int)sides_count, bend_stiffness );
    }
    free( sides );
    if ( complete == false )
    {
        plain_cloth_destroy( cloth );
    }
    return complete;
}

void plain_cloth_destroy( plain_cloth* cloth )
{
    free( cloth->position );
    free( cloth->previous );
    free( cloth->velocity );
    free( cloth->inverse_mass );
    free( cloth->links );
    *cloth = ( plain_cloth ){ 0 };
}

void plain_cloth_pin( plain_cloth* cloth, int vertex )
{
    cloth->inverse_mass[vertex] = 0.0f;
}

void plain_cloth_project( plain_cloth* cloth )
{
    for ( int i = 0; i < cloth->link_count; ++i )
    {
        const plain_link* link = &cloth->links[i];
        wisp_vec3 *a = &cloth->position[link->a], *b = &cloth->position[link->b];
        float wa = cloth->inverse_mass[link->a], wb = cloth->inverse_mass[link->b];
        float x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
        float length = sqrtf( x * x + y * y + z * z );
        float weight = length * ( wa + wb );
        if ( weight == 0.0f )
        {
            continue;
        }
        float s = link->stiffness * ( length - link->rest ) / weight;
        a->x -= wa * s * x;
        a->y -= wa * s * y;
        a->z -= wa * s * z;
        b->x += wb * s * x;
        b->y += wb * s * y;
        b->z += wb * s * z;
    }
}

static void predict( plain_cloth* cloth, float dt )
{
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        wisp_vec3 *p = &cloth->position[v], *u = &cloth->velocity[v];
        cloth->previous[v] = *p;
        if ( cloth->inverse_mass[v] > 0.0f )
        {
            u->x += dt * cloth->gravity.x;
            u->y += dt * cloth->gravity.y;
            u->z += dt * cloth->gravity.z;
            p->x += dt * u->x;
            p->y += dt * u->y;
            p->z += dt * u->z;
        }
    }
}

static void read_velocity( plain_cloth* cloth, float dt )
{
    for ( int v = 0; v < cloth->vertex_count; ++v )
    {
        wisp_vec3 p = cloth->position[v], q = cloth->previous[v];
        cloth->velocity[v] = ( wisp_vec3 ){ ( p.x - q.x ) / dt, ( p.y - q.y ) / dt, ( p.z - q.z ) / dt };
    }
}

void plain_cloth_step( plain_cloth* cloth, float seconds )
{
    float dt = seconds / (float)cloth->substeps;
    for ( int substep = 0; substep < cloth->substeps; ++substep )
    {
        predict( cloth, dt );
        for ( int pass = 0; pass < cloth->passes; ++pass )
        {
            plain_cloth_project( cloth );
        }
        read_velocity( cloth, dt );
    }
}
