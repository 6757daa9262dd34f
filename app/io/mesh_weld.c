// Welding: vertices nearer than a distance to an earlier one become that one. An earlier one that stays is never moved or
// merged, so that chains of near vertices do not drift together, and vertices that stay are farther apart than the distance.
#include "mesh_internal.h"

#include <math.h>
#include <stdlib.h>

#include "io_file.h"

// A cube as wide as the distance. Few vertices that stay fit into one, so the search below is short for any mesh.
typedef struct weld_cell
{
    double x, y, z; // whole numbers
    int32_t vertex;
} weld_cell;

typedef struct weld_grid
{
    const wisp_mesh* mesh;
    double distance;
    int cell_count;
    weld_cell* cells; // [cell_count] those with vertices, by x, then y, then z
    int32_t* cell_of; // [vertex_count]
    int32_t* newest;  // [cell_count] last vertex that stays in a cell, -1: none
    int32_t* before;  // [vertex_count] the one before it in its cell
} weld_grid;

static int compare_places( const weld_cell* a, const weld_cell* b )
{
    return a->x != b->x   ? ( a->x > b->x ) - ( a->x < b->x )
           : a->y != b->y ? ( a->y > b->y ) - ( a->y < b->y )
                          : ( a->z > b->z ) - ( a->z < b->z );
}

static int compare_cells( const void* a, const void* b )
{
    const weld_cell *p = a, *q = b;
    const int order = compare_places( p, q );
    return order != 0 ? order : ( p->vertex > q->vertex ) - ( p->vertex < q->vertex );
}

// The longest side of the bounds, m.
static double measure( const wisp_mesh* mesh, wisp_vec3* lowest )
{
    wisp_vec3 low = mesh->points[0], high = low;
    for ( int v = 1; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 p = mesh->points[v];
        low = ( wisp_vec3 ){ fminf( low.x, p.x ), fminf( low.y, p.y ), fminf( low.z, p.z ) };
        high = ( wisp_vec3 ){ fmaxf( high.x, p.x ), fmaxf( high.y, p.y ), fmaxf( high.z, p.z ) };
    }
    const mesh_vector size = mesh_between( low, high );
    *lowest = low;
    return fmax( size.x, fmax( size.y, size.z ) );
}

static void fill_cells( weld_grid* grid, wisp_vec3 lowest )
{
    const int count = grid->mesh->vertex_count;
    for ( int v = 0; v < count; ++v )
    {
        const mesh_vector p = mesh_between( lowest, grid->mesh->points[v] );
        grid->cells[v] = ( weld_cell ){ floor( p.x / grid->distance ), floor( p.y / grid->distance ),
                                        floor( p.z / grid->distance ), v };
    }
    qsort( grid->cells, (size_t)count, sizeof *grid->cells, compare_cells );
    for ( int i = 0; i < count; ++i )
    {
        const int32_t vertex = grid->cells[i].vertex;
        const bool is_new =
            grid->cell_count == 0 || compare_places( &grid->cells[grid->cell_count - 1], &grid->cells[i] ) != 0;
        grid->cells[grid->cell_count] = is_new ? grid->cells[i] : grid->cells[grid->cell_count];
        grid->cell_count += is_new;
        grid->cell_of[vertex] = grid->cell_count - 1;
        grid->newest[grid->cell_count - 1] = -1;
    }
}

// @return the first cell that is not before a place
static int find_cell( const weld_grid* grid, const weld_cell* place )
{
    int begin = 0, end = grid->cell_count;
    while ( begin < end )
    {
        const int middle = begin + ( end - begin ) / 2;
        if ( compare_places( &grid->cells[middle], place ) < 0 )
        {
            begin = middle + 1;
        }
        else
        {
            end = middle;
        }
    }
    return begin;
}

// @return the lowest vertex that stays within the distance of vertex v, -1: none
static int32_t find_near( const weld_grid* grid, int v )
{
    const weld_cell home = grid->cells[grid->cell_of[v]];
    int32_t found = -1;
    for ( int k = 0; k < 9; ++k )
    {
        // Three cells along z stand side by side.
        const weld_cell first = { home.x + k / 3 - 1, home.y + k % 3 - 1, home.z - 1.0, 0 };
        for ( int c = find_cell( grid, &first ); c < grid->cell_count && grid->cells[c].x == first.x &&
                                                 grid->cells[c].y == first.y && grid->cells[c].z <= home.z + 1.0;
              ++c )
        {
            for ( int32_t other = grid->newest[c]; other >= 0; other = grid->before[other] )
            {
                const mesh_vector d = mesh_between( grid->mesh->points[v], grid->mesh->points[other] );
                const bool is_near = mesh_dot( d, d ) <= grid->distance * grid->distance;
                found = is_near && ( found < 0 || other < found ) ? other : found;
            }
        }
    }
    return found;
}

static void find_all( weld_grid* grid, int32_t* became )
{
    for ( int v = 0; v < grid->mesh->vertex_count; ++v )
    {
        const int32_t near = find_near( grid, v );
        became[v] = near >= 0 ? near : v;
        if ( near < 0 )
        {
            grid->before[v] = grid->newest[grid->cell_of[v]];
            grid->newest[grid->cell_of[v]] = v;
        }
    }
}

wisp_status mesh_weld_find( const wisp_mesh* mesh, float distance, int32_t* became, wisp_error* error )
{
    wisp_vec3 lowest;
    const double size = measure( mesh, &lowest );
    const size_t count = (size_t)mesh->vertex_count;
    weld_grid grid = { .mesh = mesh,
                       .distance = distance > 0.0f ? (double)distance : WISP_MESH_WELD_FRACTION * size };
    // All in one place: the grid needs a width.
    grid.distance = grid.distance > 0.0 ? grid.distance : 1.0;
    if ( grid.distance < 1e-9 * size )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "mesh: got %g m as the distance to weld, expected at least a billionth of its size, %g m",
                          (double)distance, 1e-9 * size );
    }
    grid.cells = malloc( count * sizeof *grid.cells );
    grid.cell_of = malloc( count * sizeof *grid.cell_of );
    grid.newest = malloc( count * sizeof *grid.newest );
    grid.before = malloc( count * sizeof *grid.before );
    wisp_status status = WISP_OK;
    if ( grid.cells == NULL || grid.cell_of == NULL || grid.newest == NULL || grid.before == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "out of memory to weld %d vertices", mesh->vertex_count );
    }
    else
    {
        fill_cells( &grid, lowest );
        find_all( &grid, became );
    }
    free( grid.cells );
    free( grid.cell_of );
    free( grid.newest );
    free( grid.before );
    return status;
}
