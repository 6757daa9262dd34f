// Repairs, on a copy: the mesh changes only when everything has succeeded.
#include "mesh_internal.h"

#include "wisp/module/definition.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- welding ----

// Welding: vertices nearer than a distance to an earlier one become that one. An earlier one that stays is never moved or
// merged, so that chains of near vertices do not drift together, and vertices that stay are farther apart than the distance.

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
    io_bounds bounds = { .filled = false };
    io_extend_bounds( &bounds, mesh->points, mesh->vertex_count );
    const mesh_vector size = mesh_between( bounds.least, bounds.most );
    *lowest = bounds.least;
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
    io_memory scratch = { 0 };
    grid.cells = io_get( &scratch, count * sizeof *grid.cells );
    grid.cell_of = io_get( &scratch, count * sizeof *grid.cell_of );
    grid.newest = io_get( &scratch, count * sizeof *grid.newest );
    grid.before = io_get( &scratch, count * sizeof *grid.before );
    const bool has_all = !scratch.is_short;
    if ( has_all )
    {
        fill_cells( &grid, lowest );
        find_all( &grid, became );
    }
    io_release( &scratch );
    return has_all ? WISP_OK
                   : wisp_fail( error, WISP_NO_MEMORY, "out of memory to weld %d vertices", mesh->vertex_count );
}

// ---- repair ----

enum
{
    UNSEEN = -1,
};

// ---- welding ---------------------------------------------------------------------------------------------------

// The first coordinates of a vertex stay, as where a file is read.
static void count_seams( wisp_mesh* mesh, const int32_t* became )
{
    for ( int v = 0; mesh->uvs != NULL && v < mesh->vertex_count; ++v )
    {
        const float *mine = mesh->uvs + 2 * (size_t)v, *kept = mesh->uvs + 2 * (size_t)became[v];
        mesh->uv_seam_count += mine[0] != kept[0] || mine[1] != kept[1];
    }
}

// Corners name the vertices that stay. Triangles that collapse go; those that named a vertex twice before are another repair.
static wisp_status weld( wisp_mesh* mesh, float distance, wisp_mesh_repairs* repairs, wisp_error* error )
{
    WISP_TRY( mesh_weld_find( mesh, distance, repairs->became, error ) );
    const int count = mesh->triangle_count;
    count_seams( mesh, repairs->became );
    mesh->triangle_count = 0;
    for ( int t = 0; t < count; ++t )
    {
        const int32_t* from = mesh->triangles + 3 * (size_t)t;
        int32_t* to = mesh->triangles + 3 * (size_t)mesh->triangle_count;
        const bool was_twice = mesh_names_twice( mesh, t );
        for ( int k = 0; k < 3; ++k )
        {
            to[k] = repairs->became[from[k]];
        }
        const bool collapsed = !was_twice && mesh_names_twice( mesh, mesh->triangle_count );
        repairs->collapsed_dropped += collapsed;
        mesh->triangle_count += !collapsed;
    }
    return mesh->triangle_count > 0
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "mesh: the repair removes all %d triangles", count );
}

// ---- dropping triangles ----------------------------------------------------------------------------------------

// Without the first repair a triangle with a repeated vertex stays; it is no duplicate of anything.
static wisp_status drop_triangles( wisp_mesh* mesh, int what, io_memory* scratch, wisp_mesh_repairs* repairs,
                                   wisp_error* error )
{
    const size_t count = (size_t)mesh->triangle_count;
    bool* drop = io_get( scratch, count * sizeof *drop );
    int32_t* first_of = io_get( scratch, count * sizeof *first_of );
    if ( scratch->is_short )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to repair %d triangles", mesh->triangle_count );
    }
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        drop[t] = ( what & WISP_MESH_DROP_DEGENERATES ) != 0 && mesh_is_degenerate( mesh, t );
        repairs->degenerates_dropped += drop[t];
        first_of[t] = t;
    }
    WISP_TRY( ( what & WISP_MESH_DROP_DUPLICATES ) != 0 ? mesh_find_duplicates( mesh, drop, first_of, error )
                                                        : WISP_OK );
    int kept = 0;
    for ( size_t t = 0; t < count; ++t )
    {
        const bool is_duplicate = first_of[t] != (int32_t)t;
        repairs->duplicates_dropped += is_duplicate;
        memmove( mesh->triangles + 3 * kept, mesh->triangles + 3 * t, 3 * sizeof( int32_t ) );
        kept += !drop[t] && !is_duplicate;
    }
    mesh->triangle_count = kept;
    return kept > 0 ? WISP_OK
                    : wisp_fail( error, WISP_BAD_INPUT, "mesh: the repair removes all %zu triangles", count );
}

// ---- turning triangles -----------------------------------------------------------------------------------------

typedef struct flood
{
    wisp_mesh* mesh;
    mesh_edges edges;
    int32_t* twin;      // [3 * triangle_count] the half-edge across an edge of two triangles, else UNSEEN
    int32_t* primitive; // [triangle_count] first triangle of the piece that it belongs to
    int32_t* queue;     // [triangle_count] triangles, piece after piece
    bool* turned;       // [triangle_count] relative to its input winding
    bool* open;         // [triangle_count] of a piece's first triangle: its edges do not close it
    bool* odd;          // [triangle_count] scratch
} flood;

static void find_twins( flood* f )
{
    const mesh_edges* edges = &f->edges;
    for ( int h = 0; h < 3 * f->mesh->triangle_count; ++h )
    {
        f->twin[h] = UNSEEN;
    }
    for ( int e = 0; e < edges->edge_count; ++e )
    {
        int begin = edges->starts[e];
        if ( edges->starts[e + 1] - begin == 2 )
        {
            f->twin[edges->half[begin]] = edges->half[begin + 1];
            f->twin[edges->half[begin + 1]] = edges->half[begin];
        }
    }
}

// Propagates the winding of triangle t over its edge. Two neighbours agree when they run along their edge in opposite
// directions, or when one of them will be turned and they run in the same direction.
static wisp_status carry_over( flood* f, int32_t half, int* queued, wisp_error* error )
{
    int t = half / 3;
    int32_t twin = f->twin[half];
    if ( twin == UNSEEN )
    {
        return WISP_OK;
    }
    int other = twin / 3;
    bool same_way = mesh_from( f->mesh, half ) == mesh_from( f->mesh, twin );
    bool turn = f->turned[t] != same_way;
    if ( f->primitive[other] == UNSEEN )
    {
        f->primitive[other] = f->primitive[t];
        f->turned[other] = turn;
        f->queue[( *queued )++] = other;
    }
    else if ( f->turned[other] != turn )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "mesh: one-sided: triangles %d and %d cannot agree along the edge of vertices %d and %d", t,
                          other, mesh_from( f->mesh, half ), mesh_to( f->mesh, half ) );
    }
    return WISP_OK;
}

// One piece, from its lowest triangle on. Its triangles end up in queue[begin .. *queued - 1].
static wisp_status fill_primitive( flood* f, int first, int* queued, wisp_error* error )
{
    int begin = *queued;
    f->primitive[first] = first;
    f->queue[( *queued )++] = first;
    for ( int q = begin; q < *queued; ++q )
    {
        for ( int k = 0; k < 3; ++k )
        {
            WISP_TRY( carry_over( f, 3 * f->queue[q] + k, queued, error ) );
        }
    }
    return WISP_OK;
}

// A piece is closed when each edge has an even number of triangles, and an even number of the piece's own: two cubes
// that share an edge are two closed pieces.
static void find_open_primitives( flood* f )
{
    const mesh_edges* edges = &f->edges;
    for ( int e = 0; e < edges->edge_count; ++e )
    {
        int begin = edges->starts[e], end = edges->starts[e + 1];
        for ( int i = begin; i < end; ++i )
        {
            bool* odd = &f->odd[f->primitive[edges->half[i] / 3]];
            *odd = !*odd;
        }
        for ( int i = begin; i < end; ++i )
        {
            int32_t primitive = f->primitive[edges->half[i] / 3];
            f->open[primitive] = f->open[primitive] || f->odd[primitive];
        }
        for ( int i = begin; i < end; ++i )
        {
            f->odd[f->primitive[edges->half[i] / 3]] = false;
        }
    }
}

// Six times the volume of a piece once its triangles are turned.
static double signed_volume( const flood* f, int begin, int end )
{
    const wisp_vec3* points = f->mesh->points;
    wisp_vec3 tip = points[f->mesh->triangles[3 * f->queue[begin]]];
    double sum = 0.0;
    for ( int q = begin; q < end; ++q )
    {
        const int32_t* c = f->mesh->triangles + 3 * f->queue[q];
        mesh_vector a = mesh_between( tip, points[c[0]] );
        mesh_vector normal =
            mesh_cross( mesh_between( points[c[0]], points[c[1]] ), mesh_between( points[c[0]], points[c[2]] ) );
        sum += mesh_dot( a, normal ) * ( f->turned[f->queue[q]] ? -1.0 : 1.0 );
    }
    return sum;
}

// Choice of the winding of a piece: outwards if it is closed, else the one that turns fewer triangles.
static void choose_side( flood* f, int begin, int end )
{
    int turned = 0;
    for ( int q = begin; q < end; ++q )
    {
        turned += f->turned[f->queue[q]];
    }
    bool wrong = f->open[f->queue[begin]] ? 2 * (int64_t)turned > end - begin : signed_volume( f, begin, end ) < 0.0;
    for ( int q = begin; wrong && q < end; ++q )
    {
        f->turned[f->queue[q]] = !f->turned[f->queue[q]];
    }
}

static wisp_status fill( flood* f, wisp_error* error )
{
    find_twins( f );
    int queued = 0;
    for ( int t = 0; t < f->mesh->triangle_count; ++t )
    {
        f->primitive[t] = UNSEEN;
    }
    for ( int t = 0; t < f->mesh->triangle_count; ++t )
    {
        WISP_TRY( f->primitive[t] == UNSEEN ? fill_primitive( f, t, &queued, error ) : WISP_OK );
    }
    find_open_primitives( f );
    for ( int begin = 0, end = 0; begin < queued; begin = end )
    {
        int32_t primitive = f->primitive[f->queue[begin]];
        while ( end < queued && f->primitive[f->queue[end]] == primitive )
        {
            ++end;
        }
        choose_side( f, begin, end );
    }
    return WISP_OK;
}

// The first corner stays, so that a turned triangle still begins with the same vertex.
static void turn( wisp_mesh* mesh, int t )
{
    int32_t* c = mesh->triangles + 3 * (size_t)t;
    const int32_t second = c[1];
    c[1] = c[2];
    c[2] = second;
}

static void turn_triangles( flood* f, wisp_mesh_repairs* repairs )
{
    for ( int t = 0; t < f->mesh->triangle_count; ++t )
    {
        if ( f->turned[t] )
        {
            turn( f->mesh, t );
            ++repairs->triangles_turned;
        }
    }
}

static void flip( wisp_mesh* mesh, wisp_mesh_repairs* repairs )
{
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        turn( mesh, t );
    }
    repairs->triangles_flipped = mesh->triangle_count;
}

static wisp_status repair_winding( wisp_mesh* mesh, io_memory* scratch, wisp_mesh_repairs* repairs,
                                   wisp_error* error )
{
    const size_t count = (size_t)mesh->triangle_count;
    flood f = { .mesh = mesh,
                .twin = io_get( scratch, 3 * count * sizeof *f.twin ),
                .primitive = io_get( scratch, count * sizeof *f.primitive ),
                .queue = io_get( scratch, count * sizeof *f.queue ),
                .turned = io_get( scratch, count * sizeof *f.turned ),
                .open = io_get( scratch, count * sizeof *f.open ),
                .odd = io_get( scratch, count * sizeof *f.odd ) };
    if ( scratch->is_short )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to repair %d triangles", mesh->triangle_count );
    }
    WISP_TRY( mesh_edges_build( mesh, scratch, &f.edges, error ) );
    WISP_TRY( fill( &f, error ) );
    turn_triangles( &f, repairs );
    return WISP_OK;
}

// ---- dropping vertices -----------------------------------------------------------------------------------------

// Fills repairs->kept; new_number[v] is the new index of a vertex, or UNSEEN. A merged vertex is none of its own.
static void number_vertices( const wisp_mesh* mesh, int what, int32_t* new_number, wisp_mesh_repairs* repairs )
{
    const bool keep_all = ( what & WISP_MESH_DROP_UNREFERENCED ) == 0;
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        new_number[v] = keep_all && repairs->became[v] == v ? v : UNSEEN;
        repairs->vertices_welded += repairs->became[v] != v;
    }
    for ( int c = 0; c < 3 * mesh->triangle_count; ++c )
    {
        new_number[mesh->triangles[c]] = mesh->triangles[c];
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        if ( new_number[v] != UNSEEN )
        {
            repairs->kept[repairs->kept_count] = v;
            new_number[v] = repairs->kept_count++;
        }
    }
    repairs->unreferenced_dropped = mesh->vertex_count - repairs->kept_count - repairs->vertices_welded;
}

static wisp_status drop_vertices( wisp_mesh* mesh, int what, io_memory* scratch, wisp_mesh_repairs* repairs,
                                  wisp_error* error )
{
    const size_t size = (size_t)mesh->vertex_count * sizeof( int32_t );
    int32_t* new_number = io_get( scratch, size );
    repairs->kept = malloc( size );
    if ( new_number == NULL || repairs->kept == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to number %d vertices", mesh->vertex_count );
    }
    number_vertices( mesh, what, new_number, repairs );
    for ( int c = 0; c < 3 * mesh->triangle_count; ++c )
    {
        mesh->triangles[c] = new_number[mesh->triangles[c]];
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        repairs->became[v] = new_number[repairs->became[v]];
    }
    for ( int v = 0; v < repairs->kept_count; ++v )
    {
        const int32_t from = repairs->kept[v];
        mesh->points[v] = mesh->points[from];
        if ( mesh->colours != NULL )
        {
            mesh->colours[v] = mesh->colours[from];
        }
        if ( mesh->uvs != NULL )
        {
            memmove( mesh->uvs + 2 * (size_t)v, mesh->uvs + 2 * (size_t)from, 2 * sizeof *mesh->uvs );
        }
    }
    mesh->vertex_count = repairs->kept_count;
    return WISP_OK;
}

// ---- repair ----------------------------------------------------------------------------------------------------

void wisp_mesh_repairs_release( wisp_mesh_repairs* repairs )
{
    if ( repairs != NULL )
    {
        free( repairs->kept );
        free( repairs->became );
        *repairs = ( wisp_mesh_repairs ){ 0 };
    }
}

static wisp_status repair_copy( wisp_mesh* mesh, int what, float weld_distance, io_memory* scratch,
                                wisp_mesh_repairs* repairs, wisp_error* error )
{
    repairs->original_count = mesh->vertex_count;
    repairs->became = malloc( (size_t)mesh->vertex_count * sizeof *repairs->became );
    if ( repairs->became == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to number %d vertices", mesh->vertex_count );
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        repairs->became[v] = v;
    }
    WISP_TRY( ( what & WISP_MESH_WELD ) != 0 ? weld( mesh, weld_distance, repairs, error ) : WISP_OK );
    WISP_TRY( drop_triangles( mesh, what, scratch, repairs, error ) );
    WISP_TRY( ( what & WISP_MESH_TURN_TRIANGLES ) != 0 ? repair_winding( mesh, scratch, repairs, error ) : WISP_OK );
    if ( ( what & WISP_MESH_FLIP ) != 0 )
    {
        flip( mesh, repairs );
    }
    return drop_vertices( mesh, what, scratch, repairs, error );
}

wisp_status wisp_mesh_repair( wisp_mesh* mesh, int what, float weld_distance, wisp_mesh_repairs* repairs,
                              wisp_error* error )
{
    *repairs = ( wisp_mesh_repairs ){ 0 };
    wisp_mesh copy = { 0 };
    io_memory scratch = { 0 };
    WISP_TRY( mesh_check( mesh, "mesh", error ) );
    if ( !( weld_distance >= 0.0f && isfinite( weld_distance ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "mesh: got %g m as the distance to weld, expected 0 or more",
                          (double)weld_distance );
    }
    WISP_TRY( mesh_copy( mesh, &copy, "mesh", error ) );
    const wisp_status status = repair_copy( &copy, what, weld_distance, &scratch, repairs, error );
    if ( status == WISP_OK )
    {
        const wisp_mesh old = *mesh;
        *mesh = copy;
        copy = old;
    }
    else
    {
        wisp_mesh_repairs_release( repairs );
    }
    io_release( &scratch );
    wisp_mesh_release( &copy );
    return status;
}
