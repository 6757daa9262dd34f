#include "mesh_cells.h"

#include "alloc.h"
#include "mesh_search.h"

#include <math.h>
#include <string.h>

// Relative to the mesh's largest coordinate: more than the rounding of the place of a point among the cells.
static const double WIDENING = 4e-6;

// ---- memory ----

// About as many cells along an axis as triangles, with a border on both sides.
static int capacity_of( const mesh_surface* s )
{
    const int across = (int)( 2.0 * sqrt( (double)s->triangle_count ) ) + 4;
    return across < MESH_CELLS_MAX ? across : MESH_CELLS_MAX;
}

static size_t set_bytes( const mesh_cells* cells )
{
    return (size_t)cells->capacity * (size_t)cells->capacity * sizeof( uint64_t );
}

size_t mesh_cells_bytes( const mesh_cells* cells )
{
    return 3 * set_bytes( cells );
}

wisp_status mesh_cells_create( mesh_cells* cells, const mesh_surface* surface, wisp_error* error )
{
    *cells = ( mesh_cells ){ .capacity = capacity_of( surface ) };
    cells->outside = base_allocate( &surface->allocator, mesh_cells_bytes( cells ), BASE_BUFFER_ALIGNMENT );
    if ( cells->outside == NULL )
    {
        *cells = ( mesh_cells ){ 0 };
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for a mesh collider of %d triangles",
                          surface->triangle_count );
    }
    const size_t words = (size_t)cells->capacity * (size_t)cells->capacity;
    cells->apart = cells->outside + words;
    cells->taken = cells->apart + words;
    mesh_cells_fill( cells, surface );
    return WISP_OK;
}

void mesh_cells_release( mesh_cells* cells, const mesh_surface* surface )
{
    base_release( &surface->allocator, cells->outside, mesh_cells_bytes( cells ) );
    *cells = ( mesh_cells ){ 0 };
}

// ---- cells with a part of the surface ----

static int row_count( const mesh_cells* cells )
{
    return cells->size[1] * cells->size[2];
}

// Lay cells around the mesh, with a border of one that the surface cannot reach. @return false if it has no size
static bool lay_out( mesh_cells* cells, const mesh_surface* s, float widening )
{
    float longest = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        longest = fmaxf( longest, s->upper[k] - s->lower[k] + 2.0f * widening );
    }
    // two of border, and one more against rounding
    cells->edge = longest / (float)( cells->capacity - 3 );
    cells->inverse = 1.0f / cells->edge;
    for ( int k = 0; k < 3; ++k )
    {
        const float extent = s->upper[k] - s->lower[k] + 2.0f * widening;
        cells->origin[k] = s->lower[k] - widening - cells->edge;
        cells->size[k] = (int)( extent * cells->inverse ) + 3;
        cells->size[k] = cells->size[k] < cells->capacity ? cells->size[k] : cells->capacity;
    }
    return longest > 0.0f && isfinite( cells->inverse );
}

// Return the cell of a coordinate of the mesh, never in the border.
static int cell_at( const mesh_cells* cells, int axis, float x )
{
    const int cell = (int)( ( x - cells->origin[axis] ) * cells->inverse );
    const int last = cells->size[axis] - 2;
    return cell < 1 ? 1 : ( cell > last ? last : cell );
}

static void take_triangles( mesh_cells* cells, const mesh_surface* s, float widening )
{
    for ( int32_t t = 0; t < s->triangle_count; ++t )
    {
        float lower[3], upper[3];
        int first[3], last[3];
        mesh_surface_box( s, t, lower, upper );
        for ( int k = 0; k < 3; ++k )
        {
            first[k] = cell_at( cells, k, lower[k] - widening );
            last[k] = cell_at( cells, k, upper[k] + widening );
        }
        const uint64_t bits = ( ~(uint64_t)0 >> ( 63 - ( last[0] - first[0] ) ) ) << first[0];
        for ( int z = first[2]; z <= last[2]; ++z )
        {
            for ( int y = first[1]; y <= last[1]; ++y )
            {
                cells->taken[z * cells->size[1] + y] |= bits;
            }
        }
    }
}

// ---- cells outside ----

// Extend bits of a row to their neighbours in free cells, as far as they go (Kogge and Stone 1973).
static uint64_t spread_along( uint64_t seeds, uint64_t free )
{
    uint64_t up = seeds & free, down = up, free_up = free, free_down = free;
    for ( int step = 1; step < 64; step *= 2 )
    {
        up |= free_up & up << step;
        free_up &= free_up << step;
        down |= free_down & down >> step;
        free_down &= free_down >> step;
    }
    return up | down;
}

// Spread from a row to the next ones in an order. @return whether anything changed
static bool sweep( mesh_cells* cells, bool forward )
{
    const int rows = row_count( cells ), across = cells->size[1];
    bool changed = false;
    for ( int i = 0; i < rows; ++i )
    {
        const int row = forward ? i : rows - 1 - i, y = row % across;
        const uint64_t before = cells->outside[row];
        uint64_t seeds = before;
        seeds |= y > 0 ? cells->outside[row - 1] : 0;
        seeds |= y + 1 < across ? cells->outside[row + 1] : 0;
        seeds |= row >= across ? cells->outside[row - across] : 0;
        seeds |= row + across < rows ? cells->outside[row + across] : 0;
        if ( ( seeds & ~before & ~cells->taken[row] ) != 0 )
        {
            cells->outside[row] = spread_along( seeds, ~cells->taken[row] );
            changed = true;
        }
    }
    return changed;
}

// What winds more is left as not known.
static void find_outside( mesh_cells* cells )
{
    enum
    {
        MAX_SWEEPS = 32,
    };
    const int rows = row_count( cells ), across = cells->size[1];
    const uint64_t ends = (uint64_t)1 | (uint64_t)1 << ( cells->size[0] - 1 );
    for ( int row = 0; row < rows; ++row )
    {
        const int y = row % across, z = row / across;
        const bool is_border = y == 0 || z == 0 || y + 1 == across || z + 1 == cells->size[2];
        cells->outside[row] = is_border ? ~(uint64_t)0 : spread_along( ends, ~cells->taken[row] );
    }
    for ( int i = 0; i < MAX_SWEEPS && sweep( cells, i % 2 == 0 ); ++i )
    {
    }
}

static uint64_t widen_along( uint64_t row )
{
    return row | row << 1 | row >> 1;
}

// A cell is apart if none of the 27 cells around it is taken.
static void find_apart( mesh_cells* cells )
{
    const int across = cells->size[1];
    for ( int z = 0; z < cells->size[2]; ++z )
    {
        for ( int y = 0; y < across; ++y )
        {
            uint64_t near = 0;
            for ( int b = z > 0 ? z - 1 : 0; b <= z + 1 && b < cells->size[2]; ++b )
            {
                for ( int a = y > 0 ? y - 1 : 0; a <= y + 1 && a < across; ++a )
                {
                    near |= cells->taken[b * across + a];
                }
            }
            cells->apart[z * across + y] = ~widen_along( near );
        }
    }
}

void mesh_cells_fill( mesh_cells* cells, const mesh_surface* surface )
{
    const float widening = (float)( WIDENING * surface->largest + MIN_SEARCH_SLACK );
    if ( lay_out( cells, surface, widening ) == false )
    {
        memset( cells->size, 0, sizeof( cells->size ) );
        return;
    }
    memset( cells->taken, 0, (size_t)row_count( cells ) * sizeof( uint64_t ) );
    take_triangles( cells, surface, widening );
    find_outside( cells );
    find_apart( cells );
}

float mesh_cells_clearance( const mesh_cells* cells, wisp_vec3 point )
{
    const float x = ( point.x - cells->origin[0] ) * cells->inverse,
                y = ( point.y - cells->origin[1] ) * cells->inverse,
                z = ( point.z - cells->origin[2] ) * cells->inverse;
    const float sure = 0.999f * cells->edge; // less the rounding of the place of a point
    const bool is_within = x >= 0.0f && y >= 0.0f && z >= 0.0f && x < (float)cells->size[0] &&
                           y < (float)cells->size[1] && z < (float)cells->size[2];
    if ( is_within == false )
    {
        return cells->size[0] > 0 && x == x && y == y && z == z ? sure : -1.0f;
    }
    const int row = (int)z * cells->size[1] + (int)y;
    if ( ( cells->outside[row] >> (int)x & 1 ) == 0 )
    {
        return -1.0f;
    }
    return ( cells->apart[row] >> (int)x & 1 ) != 0 ? sure : 0.0f;
}
