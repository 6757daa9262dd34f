// Neighbours of elements. Everything is sorted by counting: time is linear in the number of elements, also for a
// hostile mesh, and equals keep their order.
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

// ---- triangles -------------------------------------------------------------------------------------------------

mesh_vector mesh_between( wisp_vec3 from, wisp_vec3 to )
{
    return ( mesh_vector ){ (double)to.x - (double)from.x, (double)to.y - (double)from.y,
                            (double)to.z - (double)from.z };
}

mesh_vector mesh_cross( mesh_vector a, mesh_vector b )
{
    return ( mesh_vector ){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

double mesh_dot( mesh_vector a, mesh_vector b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

bool mesh_names_twice( const wisp_mesh* mesh, int t )
{
    const int32_t* c = mesh->triangles + 3 * t;
    return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

bool mesh_is_degenerate( const wisp_mesh* mesh, int t )
{
    const int32_t* c = mesh->triangles + 3 * t;
    mesh_vector ab = mesh_between( mesh->points[c[0]], mesh->points[c[1]] );
    mesh_vector ac = mesh_between( mesh->points[c[0]], mesh->points[c[2]] );
    mesh_vector bc = mesh_between( mesh->points[c[1]], mesh->points[c[2]] );
    mesh_vector normal = mesh_cross( ab, ac );
    double longest = fmax( fmax( mesh_dot( ab, ab ), mesh_dot( ac, ac ) ), mesh_dot( bc, bc ) );
    // The normal's length is the longest edge times the height on it.
    return mesh_names_twice( mesh, t ) || sqrt( mesh_dot( normal, normal ) ) <= WISP_MESH_FLAT * longest;
}

// ---- sorting by counting ---------------------------------------------------------------------------------------

// Items in the order of their keys; equals keep their order. `first` has room for key_count + 1.
static void sort_by_key( const int32_t* in, int32_t* out, int count, const int32_t* key_of, int key_count,
                         int32_t* first )
{
    for ( int k = 0; k <= key_count; ++k )
    {
        first[k] = 0;
    }
    for ( int i = 0; i < count; ++i )
    {
        ++first[key_of[in[i]] + 1];
    }
    for ( int k = 0; k < key_count; ++k )
    {
        first[k + 1] += first[k];
    }
    for ( int i = 0; i < count; ++i )
    {
        out[first[key_of[in[i]]]++] = in[i];
    }
}

static int32_t lower( int32_t a, int32_t b )
{
    return a < b ? a : b;
}

static int32_t higher( int32_t a, int32_t b )
{
    return a > b ? a : b;
}

// ---- edges -----------------------------------------------------------------------------------------------------

typedef struct edge_work
{
    int32_t *low, *high; // vertices of each half-edge
    int32_t *spare, *first;
} edge_work;

static int list_halves( const wisp_mesh* mesh, int32_t* half, const edge_work* work )
{
    int count = 0;
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        for ( int k = 0; k < 3 && !mesh_names_twice( mesh, t ); ++k )
        {
            int32_t h = 3 * t + k, a = mesh_from( mesh, h ), b = mesh_to( mesh, h );
            work->low[h] = lower( a, b );
            work->high[h] = higher( a, b );
            half[count++] = h;
        }
    }
    return count;
}

static void find_runs( mesh_edges* edges, const edge_work* work )
{
    for ( int i = 0; i < edges->half_count; ++i )
    {
        int32_t h = edges->half[i], before = i > 0 ? edges->half[i - 1] : h;
        if ( i == 0 || work->low[h] != work->low[before] || work->high[h] != work->high[before] )
        {
            edges->starts[edges->edge_count++] = i;
        }
    }
    edges->starts[edges->edge_count] = edges->half_count;
}

wisp_status mesh_edges_build( const wisp_mesh* mesh, mesh_edges* edges, wisp_error* error )
{
    size_t halves = (size_t)mesh->triangle_count * 3, size = halves * sizeof( int32_t );
    *edges =
        ( mesh_edges ){ .half = calloc( halves, sizeof( int32_t ) ), .starts = malloc( size + sizeof( int32_t ) ) };
    edge_work work = { calloc( halves, sizeof( int32_t ) ), calloc( halves, sizeof( int32_t ) ), malloc( size ),
                       malloc( ( (size_t)mesh->vertex_count + 1 ) * sizeof( int32_t ) ) };
    wisp_status status = WISP_OK;
    if ( edges->half == NULL || edges->starts == NULL || work.low == NULL || work.high == NULL ||
         work.spare == NULL || work.first == NULL )
    {
        mesh_edges_release( edges );
        status =
            wisp_fail( error, WISP_NO_MEMORY, "out of memory for the edges of %d triangles", mesh->triangle_count );
    }
    else
    {
        edges->half_count = list_halves( mesh, edges->half, &work );
        sort_by_key( edges->half, work.spare, edges->half_count, work.high, mesh->vertex_count, work.first );
        sort_by_key( work.spare, edges->half, edges->half_count, work.low, mesh->vertex_count, work.first );
        find_runs( edges, &work );
    }
    free( work.low );
    free( work.high );
    free( work.spare );
    free( work.first );
    return status;
}

void mesh_edges_release( mesh_edges* edges )
{
    free( edges->half );
    free( edges->starts );
    *edges = ( mesh_edges ){ 0 };
}

// ---- duplicates ------------------------------------------------------------------------------------------------

typedef struct duplicate_work
{
    int32_t* corner[3]; // vertices of each triangle, rising
    int32_t *order, *spare, *first;
} duplicate_work;

static void sort_corners( const wisp_mesh* mesh, const duplicate_work* work )
{
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* c = mesh->triangles + 3 * t;
        int32_t low = lower( lower( c[0], c[1] ), c[2] ), high = higher( higher( c[0], c[1] ), c[2] );
        work->corner[0][t] = low;
        work->corner[1][t] = lower( higher( c[0], c[1] ), higher( lower( c[0], c[1] ), c[2] ) );
        work->corner[2][t] = high;
    }
}

static void find_equals( const wisp_mesh* mesh, const bool* skip, int32_t* first_of, const duplicate_work* work )
{
    int count = 0;
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        first_of[t] = t;
        if ( skip == NULL || !skip[t] )
        {
            work->order[count++] = t;
        }
    }
    sort_corners( mesh, work );
    int keys = mesh->vertex_count;
    sort_by_key( work->order, work->spare, count, work->corner[2], keys, work->first );
    sort_by_key( work->spare, work->order, count, work->corner[1], keys, work->first );
    sort_by_key( work->order, work->spare, count, work->corner[0], keys, work->first );
    for ( int i = 1; i < count; ++i )
    {
        int32_t t = work->spare[i], before = work->spare[i - 1];
        if ( work->corner[0][t] == work->corner[0][before] && work->corner[1][t] == work->corner[1][before] &&
             work->corner[2][t] == work->corner[2][before] )
        {
            first_of[t] = first_of[before];
        }
    }
}

wisp_status mesh_find_duplicates( const wisp_mesh* mesh, const bool* skip, int32_t* first_of, wisp_error* error )
{
    size_t triangles = (size_t)mesh->triangle_count;
    int32_t* block = calloc( triangles, 5 * sizeof *block );
    int32_t* first = malloc( ( (size_t)mesh->vertex_count + 1 ) * sizeof *first );
    wisp_status status = WISP_OK;
    if ( block == NULL || first == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "out of memory to compare %d triangles", mesh->triangle_count );
    }
    else
    {
        duplicate_work work = {
            { block, block + triangles, block + 2 * triangles }, block + 3 * triangles, block + 4 * triangles, first
        };
        find_equals( mesh, skip, first_of, &work );
    }
    free( block );
    free( first );
    return status;
}

// ---- sets ------------------------------------------------------------------------------------------------------

int32_t* mesh_sets_make( int count )
{
    int32_t* sets = malloc( (size_t)count * sizeof *sets );
    for ( int i = 0; sets != NULL && i < count; ++i )
    {
        sets[i] = i;
    }
    return sets;
}

// Every step of the walk shortens the path for the next one.
int32_t mesh_sets_find( int32_t* sets, int32_t member )
{
    while ( sets[member] != member )
    {
        sets[member] = sets[sets[member]];
        member = sets[member];
    }
    return member;
}

void mesh_sets_merge( int32_t* sets, int32_t a, int32_t b )
{
    int32_t left = mesh_sets_find( sets, a ), right = mesh_sets_find( sets, b );
    sets[higher( left, right )] = lower( left, right );
}
