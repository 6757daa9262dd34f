// Neighbours of elements. Everything is sorted by counting: time is linear in the number of elements, also for a
// hostile mesh, and equals keep their order.
#include "mesh_internal.h"

#include "io_bytes.h"
#include "io_file.h"
#include "mesh.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- quads ----

// Pairs of neighbours of a grid of vertices, for cloth that is made of quads.

void wisp_quad_pairs_release( wisp_quad_pairs* pairs )
{
    if ( pairs )
    {
        free( pairs->stretch );
        free( pairs->bend );
        *pairs = ( wisp_quad_pairs ){ 0 };
    }
}

// Every pair once: from each vertex to the right, down, and down both diagonals.
static int put_pairs( int columns, int rows, int apart, int32_t* pairs )
{
    const int steps[][2] = { { apart, 0 }, { 0, apart }, { apart, apart }, { -apart, apart } };
    int count = 0;
    for ( int j = 0; j < rows; ++j )
    {
        for ( int i = 0; i < columns; ++i )
        {
            for ( int s = 0; s < WISP_COUNT( steps ); ++s )
            {
                int x = i + steps[s][0], y = j + steps[s][1];
                if ( x >= 0 && x < columns && y < rows )
                {
                    pairs[2 * (size_t)count] = j * columns + i;
                    pairs[2 * (size_t)count + 1] = y * columns + x;
                    ++count;
                }
            }
        }
    }
    return count;
}

static size_t count_pairs( int columns, int rows, int apart )
{
    size_t c = (size_t)columns, r = (size_t)rows;
    size_t across = columns > apart ? c - (size_t)apart : 0, down = rows > apart ? r - (size_t)apart : 0;
    return across * r + c * down + 2 * across * down;
}

wisp_status wisp_quad_pairs_make( int columns, int rows, wisp_quad_pairs* out, wisp_error* error )
{
    *out = ( wisp_quad_pairs ){ 0 };
    if ( columns < 2 || rows < 2 || (int64_t)columns * rows > WISP_MESH_VERTEX_CAP )
    {
        return wisp_fail(
            error, WISP_BAD_INPUT,
            "quad pairs: got %d columns times %d rows, expected at least 2 each and a product of at most %d", columns,
            rows, WISP_MESH_VERTEX_CAP );
    }
    const size_t stretch = count_pairs( columns, rows, 1 ), bend = count_pairs( columns, rows, 2 );
    out->stretch = malloc( stretch * 2 * sizeof( int32_t ) );
    out->bend = malloc( bend * 2 * sizeof( int32_t ) + 1 );
    if ( !out->stretch || !out->bend )
    {
        wisp_quad_pairs_release( out );
        return wisp_fail( error, WISP_NO_MEMORY, "quad pairs: out of memory for %zu pairs", stretch + bend );
    }
    out->stretch_count = put_pairs( columns, rows, 1, out->stretch );
    out->bend_count = put_pairs( columns, rows, 2, out->bend );
    return WISP_OK;
}

// ---- layers ----

// Writes a mesh with points on its edges and inside its triangles as PLY, which has room for normals and element
// numbers, and which readers of plain meshes can still read.

enum
{
    VERTEX_ROW = 28, // six floats and an int
    EDGE_ROW = 8,
};

// ---- checks ----------------------------------------------------------------------------------------------------

static int element_of( const wisp_mesh_layer* layer, int point )
{
    int32_t element;
    memcpy( &element, layer->points + 4 * (size_t)point + 3, sizeof element );
    return element;
}

static bool is_finite( const float* three )
{
    return isfinite( three[0] ) && isfinite( three[1] ) && isfinite( three[2] );
}

static wisp_status check_points( const wisp_mesh* mesh, const wisp_mesh_layer* layer, const char* name,
                                 wisp_error* error )
{
    const int64_t elements = (int64_t)layer->edge_count + mesh->triangle_count;
    for ( int i = 0; i < layer->point_count; ++i )
    {
        const size_t at = 4 * (size_t)i;
        if ( !is_finite( layer->points + at ) || !is_finite( layer->point_normals + at ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: the %s of point %d is not finite", name,
                              is_finite( layer->points + at ) ? "normal" : "place", i );
        }
        const int element = element_of( layer, i );
        if ( element < 0 || element >= elements )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: point %d is on element %d of %lld", name, i, element,
                              (long long)elements );
        }
    }
    return WISP_OK;
}

static wisp_status check_layer( const wisp_mesh* mesh, const wisp_mesh_layer* layer, const char* name,
                                wisp_error* error )
{
    if ( layer->point_count < 0 || layer->edge_count < 0 ||
         (int64_t)mesh->vertex_count + layer->point_count > WISP_MESH_VERTEX_CAP )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: %d vertices and %d points are more than the %d that are read back", name,
                          mesh->vertex_count, layer->point_count, WISP_MESH_VERTEX_CAP );
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 n = layer->normals[v];
        if ( !is_finite( ( const float[] ){ n.x, n.y, n.z } ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: the normal of vertex %d is not finite", name, v );
        }
    }
    for ( size_t k = 0; k < 2 * (size_t)layer->edge_count; ++k )
    {
        if ( layer->edges[k] < 0 || layer->edges[k] >= mesh->vertex_count )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: edge %zu: got vertex %d, expected 0 .. %d", name, k / 2,
                              (int)layer->edges[k], mesh->vertex_count - 1 );
        }
    }
    return check_points( mesh, layer, name, error );
}

// ---- rows ------------------------------------------------------------------------------------------------------

static void put_row( FILE* out, const float* place, const float* normal, int element )
{
    unsigned char row[VERTEX_ROW];
    for ( int k = 0; k < 3; ++k )
    {
        io_put_float( row + 4 * k, place[k] );
        io_put_float( row + 12 + 4 * k, normal[k] );
    }
    io_put_u32( row + 24, (uint32_t)element );
    fwrite( row, 1, sizeof row, out );
}

static void put_layer( FILE* out, const wisp_mesh* mesh, const wisp_mesh_layer* layer )
{
    fprintf( out,
             "ply\nformat binary_little_endian 1.0\ncomment Wisp %s, metres\n"
             "comment %d vertices, then %d points on elements: edges first, then triangles\n"
             "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
             "property float nx\nproperty float ny\nproperty float nz\nproperty int element\n"
             "element face %d\nproperty list uchar int vertex_indices\n"
             "element edge %d\nproperty int vertex1\nproperty int vertex2\nend_header\n",
             WISP_VERSION_STRING, mesh->vertex_count, layer->point_count, mesh->vertex_count + layer->point_count,
             mesh->triangle_count, layer->edge_count );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 p = mesh->points[v], n = layer->normals[v];
        put_row( out, ( const float[] ){ p.x, p.y, p.z }, ( const float[] ){ n.x, n.y, n.z }, -1 );
    }
    for ( int i = 0; i < layer->point_count; ++i )
    {
        const size_t at = 4 * (size_t)i;
        put_row( out, layer->points + at, layer->point_normals + at, element_of( layer, i ) );
    }
    mesh_put_triangles( out, mesh );
    for ( int e = 0; e < layer->edge_count; ++e )
    {
        unsigned char row[EDGE_ROW];
        const int32_t* edge = layer->edges + 2 * (size_t)e;
        io_put_u32( row, (uint32_t)edge[0] );
        io_put_u32( row + 4, (uint32_t)edge[1] );
        fwrite( row, 1, sizeof row, out );
    }
}

wisp_status wisp_mesh_write_layer( const char* path, const wisp_mesh* mesh, const wisp_mesh_layer* layer,
                                   wisp_error* error )
{
    const char* name = io_short_name( path );
    io_output output;
    WISP_TRY( mesh_check( mesh, name, error ) );
    WISP_TRY( check_layer( mesh, layer, name, error ) );
    WISP_TRY( io_output_open( path, &output, error ) );
    put_layer( output.stream, mesh, layer );
    return io_output_commit( &output, error );
}

// ---- edges ----

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

wisp_status mesh_edges_build( const wisp_mesh* mesh, io_memory* memory, mesh_edges* edges, wisp_error* error )
{
    const size_t size = (size_t)mesh->triangle_count * 3 * sizeof( int32_t );
    io_memory scratch = { 0 };
    *edges = ( mesh_edges ){ .half = io_get( memory, size ), .starts = io_get( memory, size + sizeof( int32_t ) ) };
    const edge_work work = { io_get( &scratch, size ), io_get( &scratch, size ), io_get( &scratch, size ),
                             io_get( &scratch, ( (size_t)mesh->vertex_count + 1 ) * sizeof( int32_t ) ) };
    const bool has_all = !memory->is_short && !scratch.is_short;
    if ( has_all )
    {
        edges->half_count = list_halves( mesh, edges->half, &work );
        sort_by_key( edges->half, work.spare, edges->half_count, work.high, mesh->vertex_count, work.first );
        sort_by_key( work.spare, edges->half, edges->half_count, work.low, mesh->vertex_count, work.first );
        find_runs( edges, &work );
    }
    io_release( &scratch );
    return has_all ? WISP_OK
                   : wisp_fail( error, WISP_NO_MEMORY, "out of memory for the edges of %d triangles",
                                mesh->triangle_count );
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
        if ( !mesh_names_twice( mesh, t ) && ( skip == NULL || !skip[t] ) )
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
    const size_t size = (size_t)mesh->triangle_count * sizeof( int32_t );
    io_memory scratch = { 0 };
    const duplicate_work work = { { io_get( &scratch, size ), io_get( &scratch, size ), io_get( &scratch, size ) },
                                  io_get( &scratch, size ),
                                  io_get( &scratch, size ),
                                  io_get( &scratch, ( (size_t)mesh->vertex_count + 1 ) * sizeof( int32_t ) ) };
    const bool has_all = !scratch.is_short;
    if ( has_all )
    {
        find_equals( mesh, skip, first_of, &work );
    }
    io_release( &scratch );
    return has_all
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "out of memory to compare %d triangles", mesh->triangle_count );
}

// ---- sets ------------------------------------------------------------------------------------------------------

int32_t* mesh_sets_make( io_memory* memory, int count )
{
    int32_t* sets = io_get( memory, (size_t)count * sizeof *sets );
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
