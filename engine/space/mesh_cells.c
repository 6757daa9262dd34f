#include "mesh_surface.h"

#include "alloc.h"
#include "mesh_search.h"

#include <math.h>
#include <string.h>

// Relative to the mesh's largest coordinate: more than the rounding of the place of a point among the cells.

enum
{
    WORD = 64,
    MAX_ACROSS = 128, // cells along an axis
    MIN_CAPACITY = 128,
    MAX_CAPACITY = 16384,
    CELL_GRAIN = 1024, // triangles per block
};

// Cells beside that of a point. Farther, a search costs less than to look at all cells.
static const float MAX_LOOK = 2.0f;

// ---- memory ----

static int capacity_of( const mesh_surface* s )
{
    const int words = s->triangle_count < MAX_CAPACITY / 2 ? 2 * s->triangle_count : MAX_CAPACITY;
    return words > MIN_CAPACITY ? words : MIN_CAPACITY;
}

size_t mesh_cells_bytes( const mesh_cells* cells )
{
    return 2 * (size_t)cells->capacity * sizeof( uint64_t );
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
    cells->taken = cells->outside + cells->capacity;
    mesh_cells_fill( cells, surface, NULL );
    return WISP_OK;
}

void mesh_cells_release( mesh_cells* cells, const mesh_surface* surface )
{
    base_release( &surface->allocator, cells->outside, mesh_cells_bytes( cells ) );
    *cells = ( mesh_cells ){ 0 };
}

void mesh_cells_empty( mesh_cells* cells )
{
    memset( cells->size, 0, sizeof( cells->size ) );
}

// ---- layout ----

// Lay cells around a box, with a border of one that the surface cannot reach and one more against rounding.
static int lay_out( mesh_cells* cells, const float lower[3], const float upper[3], float edge )
{
    cells->edge = edge;
    cells->inverse = 1.0f / edge;
    for ( int k = 0; k < 3; ++k )
    {
        cells->origin[k] = lower[k] - edge;
        cells->size[k] = (int)( ( upper[k] - lower[k] ) * cells->inverse ) + 3;
    }
    cells->words = ( cells->size[0] + WORD - 1 ) / WORD;
    return cells->words * cells->size[1] * cells->size[2];
}

// @return false if the mesh has no size
static bool choose_layout( mesh_cells* cells, const mesh_surface* s, float widening )
{
    float lower[3], upper[3], longest = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        lower[k] = s->lower[k] - widening;
        upper[k] = s->upper[k] + widening;
        longest = fmaxf( longest, upper[k] - lower[k] );
    }
    float edge = longest / (float)( MAX_ACROSS - 4 );
    if ( !( longest > 0.0f ) || !isfinite( 1.0f / edge ) )
    {
        return false;
    }
    while ( lay_out( cells, lower, upper, edge ) > cells->capacity )
    {
        edge *= 1.1f;
    }
    return true;
}

static int row_count( const mesh_cells* cells )
{
    return cells->size[1] * cells->size[2];
}

// ---- cells with a part of the surface ----

// A triangle over its motion: where its box is among the cells, and a slab around all its places.
typedef struct slab
{
    int first[3], last[3];
    float normal[3];    // of any length
    float lower, upper; // along it, relative to the origin of the cells; wider by half of a cell
} slab;

// Return the cell of a coordinate of the mesh, never in the border.
static int cell_at( const mesh_cells* cells, int axis, float x )
{
    const int cell = (int)( ( x - cells->origin[axis] ) * cells->inverse );
    const int last = cells->size[axis] - 2;
    return cell < 1 ? 1 : ( cell > last ? last : cell );
}

static void widen_slab( const mesh_cells* cells, const float* xyzw, const int32_t* number, slab* s )
{
    for ( int corner = 0; corner < 3; ++corner )
    {
        const float* p = xyzw + 4 * (size_t)number[corner];
        float along = 0.0f;
        for ( int k = 0; k < 3; ++k )
        {
            along += s->normal[k] * ( p[k] - cells->origin[k] );
        }
        s->lower = along < s->lower ? along : s->lower;
        s->upper = along > s->upper ? along : s->upper;
    }
}

// Place the box of a triangle. @return how many cells it meets
static int place_box( const mesh_cells* cells, const mesh_surface* surface, int32_t triangle, float widening,
                      slab* s )
{
    float lower[3], upper[3];
    int count = 1;
    mesh_surface_box( surface, triangle, lower, upper );
    for ( int k = 0; k < 3; ++k )
    {
        s->first[k] = cell_at( cells, k, lower[k] - widening );
        s->last[k] = cell_at( cells, k, upper[k] + widening );
        count *= s->last[k] - s->first[k] + 1;
    }
    return count;
}

static void place_slab( const mesh_cells* cells, const mesh_surface* surface, int32_t triangle, float widening,
                        slab* s )
{
    const int32_t* number = surface->triangles + 3 * (size_t)triangle;
    const float *a = surface->xyzw + 4 * (size_t)number[0], *b = surface->xyzw + 4 * (size_t)number[1],
                *c = surface->xyzw + 4 * (size_t)number[2];
    float out = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        const int i = ( k + 1 ) % 3, j = ( k + 2 ) % 3;
        s->normal[k] = ( ( b[i] - a[i] ) * ( c[j] - a[j] ) - ( b[j] - a[j] ) * ( c[i] - a[i] ) ) * cells->inverse *
                       cells->inverse;
        out += fabsf( s->normal[k] );
    }
    s->lower = INFINITY;
    s->upper = -INFINITY;
    widen_slab( cells, surface->xyzw, number, s );
    if ( surface->start != NULL )
    {
        widen_slab( cells, surface->start, number, s );
    }
    // half of a cell, and more than the rounding of a place among 128 cells
    const float wide = out * ( 0.51f * cells->edge + 4.0f * widening );
    s->lower -= wide;
    s->upper += wide;
}

// Triangles that take cells.
typedef struct taking
{
    mesh_cells* cells;
    const mesh_surface* surface;
    float widening; // m
} taking;

// NaN takes a cell.
static void take_slab( const mesh_cells* cells, const slab* s )
{
    const float* n = s->normal;
    for ( int z = s->first[2]; z <= s->last[2]; ++z )
    {
        for ( int y = s->first[1]; y <= s->last[1]; ++y )
        {
            uint64_t* row = cells->taken + (size_t)( z * cells->size[1] + y ) * (size_t)cells->words;
            const float beside = n[1] * ( (float)y + 0.5f ) + n[2] * ( (float)z + 0.5f );
            for ( int x = s->first[0]; x <= s->last[0]; )
            {
                uint64_t bits = 0;
                const int word = x / WORD;
                for ( ; x <= s->last[0] && x / WORD == word; ++x )
                {
                    const float along = ( n[0] * ( (float)x + 0.5f ) + beside ) * cells->edge;
                    const bool meets = !( along < s->lower ) && !( along > s->upper );
                    bits |= (uint64_t)meets << x % WORD;
                }
                // whose bits come first does not matter; most are set
                if ( ( bits & ~__atomic_load_n( row + word, __ATOMIC_RELAXED ) ) != 0 )
                {
                    __atomic_fetch_or( row + word, bits, __ATOMIC_RELAXED );
                }
            }
        }
    }
}

static void take_triangles( void* context, int begin, int end, int worker )
{
    enum
    {
        FEW = 4, // cells: a slab would cost more than it leaves out
    };
    (void)worker;
    const taking* all = context;
    for ( int32_t t = begin; t < end; ++t )
    {
        slab s = { .lower = -INFINITY, .upper = INFINITY };
        if ( place_box( all->cells, all->surface, t, all->widening, &s ) > FEW )
        {
            place_slab( all->cells, all->surface, t, all->widening, &s );
        }
        take_slab( all->cells, &s );
    }
}

// ---- cells outside ----

// Extend bits of a word to their neighbours in free cells, as far as they go (Kogge and Stone 1973).
static uint64_t spread_along( uint64_t seeds, uint64_t free )
{
    uint64_t up = seeds & free, down = up, free_up = free, free_down = free;
    for ( int step = 1; step < WORD; step *= 2 )
    {
        up |= free_up & up << step;
        free_up &= free_up << step;
        down |= free_down & down >> step;
        free_down &= free_down >> step;
    }
    return up | down;
}

// Spread to a row from its neighbours. @return whether anything changed
static bool spread_to( mesh_cells* cells, int row )
{
    const int words = cells->words, across = cells->size[1], y = row % across, rows = row_count( cells );
    const ptrdiff_t beside = words, above = (ptrdiff_t)words * across;
    uint64_t* outside = cells->outside + (size_t)row * (size_t)words;
    const uint64_t* taken = cells->taken + (size_t)row * (size_t)words;
    bool changed = false;
    for ( int i = 0; i < words; ++i, ++outside, ++taken )
    {
        if ( ( *outside | *taken ) == ~(uint64_t)0 )
        {
            continue;
        }
        uint64_t seeds = *outside;
        seeds |= y > 0 ? outside[-beside] : 0;
        seeds |= y + 1 < across ? outside[beside] : 0;
        seeds |= row >= across ? outside[-above] : 0;
        seeds |= row + across < rows ? outside[above] : 0;
        seeds |= i > 0 ? outside[-1] >> ( WORD - 1 ) : 0;
        seeds |= i + 1 < words ? outside[1] << ( WORD - 1 ) : 0;
        if ( ( seeds & ~*outside & ~*taken ) != 0 )
        {
            *outside = spread_along( seeds, ~*taken );
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
    for ( int row = 0; row < rows; ++row )
    {
        const int y = row % across, z = row / across;
        const bool is_border = y == 0 || z == 0 || y + 1 == across || z + 1 == cells->size[2];
        uint64_t* outside = cells->outside + (size_t)row * (size_t)cells->words;
        memset( outside, is_border ? 255 : 0, (size_t)cells->words * sizeof( uint64_t ) );
        outside[0] |= 1;
        outside[( cells->size[0] - 1 ) / WORD] |= (uint64_t)1 << ( cells->size[0] - 1 ) % WORD;
    }
    bool changed = true;
    for ( int i = 0; i < MAX_SWEEPS && changed; ++i )
    {
        changed = false;
        for ( int row = 0; row < rows; ++row )
        {
            changed = spread_to( cells, i % 2 == 0 ? row : rows - 1 - row ) || changed;
        }
    }
}

void mesh_cells_fill( mesh_cells* cells, const mesh_surface* surface, const wisp_parallel* parallel )
{
    const float widening = (float)( MESH_WIDENING * surface->largest + MIN_SEARCH_SLACK );
    if ( choose_layout( cells, surface, widening ) == false )
    {
        memset( cells->size, 0, sizeof( cells->size ) );
        return;
    }
    memset( cells->taken, 0, (size_t)row_count( cells ) * (size_t)cells->words * sizeof( uint64_t ) );
    const taking all = { cells, surface, widening };
    if ( parallel != NULL )
    {
        wisp_parallel_for( parallel, surface->triangle_count, CELL_GRAIN, take_triangles, (void*)&all );
    }
    else
    {
        take_triangles( (void*)&all, 0, surface->triangle_count, 0 );
    }
    find_outside( cells );
}

// Return bits from one to another one of a word; what is beyond its ends is left out.
static uint64_t bits_between( int first, int last )
{
    const uint64_t upto = last >= WORD - 1 ? ~(uint64_t)0 : ~( ~(uint64_t)0 << ( last + 1 ) );
    return first <= 0 ? upto : upto & ~(uint64_t)0 << first;
}

// Return whether a part of the surface may be in the cells from `first` to `last`.
static bool has_surface( const mesh_cells* cells, const int first[3], const int last[3] )
{
    const int begin = first[0] / WORD, end = last[0] / WORD;
    uint64_t taken = 0;
    for ( int word = begin; word <= end; ++word )
    {
        const uint64_t bits = bits_between( first[0] - word * WORD, last[0] - word * WORD );
        for ( int z = first[2]; z <= last[2]; ++z )
        {
            for ( int y = first[1]; y <= last[1]; ++y )
            {
                taken |= bits & cells->taken[( z * cells->size[1] + y ) * cells->words + word];
            }
        }
    }
    return taken != 0;
}

float mesh_cells_clearance( const mesh_cells* cells, wisp_vec3 point, float near )
{
    const float p[3] = { point.x, point.y, point.z };
    // wider by the rounding of a place among 128 cells
    const float wide = near * cells->inverse + 1e-4f;
    int at[3], first[3], last[3];
    bool is_within = true;
    for ( int k = 0; k < 3; ++k )
    {
        const float place = ( p[k] - cells->origin[k] ) * cells->inverse, end = (float)cells->size[k];
        if ( !( place + wide >= 0.0f && place - wide < end ) )
        {
            return cells->size[0] > 0 && place == place ? near : -1.0f;
        }
        is_within = is_within && place >= 0.0f && place < end;
        at[k] = (int)place;
        first[k] = place > wide ? (int)( place - wide ) : 0;
        last[k] = place + wide < end ? (int)( place + wide ) : cells->size[k] - 1;
    }
    if ( is_within )
    {
        const int row = at[2] * cells->size[1] + at[1];
        const uint64_t outside = cells->outside[row * cells->words + at[0] / WORD];
        if ( ( outside >> at[0] % WORD & 1 ) == 0 )
        {
            return -1.0f;
        }
    }
    return wide <= MAX_LOOK && has_surface( cells, first, last ) == false ? near : 0.0f;
}
