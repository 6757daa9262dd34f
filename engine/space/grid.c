#include "wisp/module/space.h"

#include "alloc.h"

#include <string.h>

enum
{
    GRID_GRAIN = 1024,          // items per block
    GRID_CELLS_PER_ITEM = 4,    // more cells would be empty and cost more to clear than they save
    GRID_CELLS_ALONG = 1 << 24, // maximum number of cells along an axis, which floats represent exactly
    GRID_PADDING = 16,          // slots after the last one that a wide load may read
};

bool wisp_buffer_reserve( wisp_buffer* buffer, const wisp_allocator* allocator, size_t bytes )
{
    // reserve more, for the next frame
    return bytes <= buffer->size || base_buffer_reserve( allocator, buffer, bytes + bytes / 4 );
}

void wisp_buffer_release( wisp_buffer* buffer, const wisp_allocator* allocator )
{
    base_buffer_release( allocator, buffer );
}

size_t wisp_buffer_bytes( const wisp_buffer* buffers, int count )
{
    size_t bytes = 0;
    for ( int i = 0; i < count; ++i )
    {
        bytes += buffers[i].size;
    }
    return bytes;
}

size_t wisp_grid_bytes( const wisp_grid* grid )
{
    return wisp_buffer_bytes( grid->buffers, WISP_COUNT( grid->buffers ) );
}

void wisp_grid_release( wisp_grid* grid, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( grid->buffers ); ++i )
    {
        wisp_buffer_release( grid->buffers + i, allocator );
    }
    *grid = ( wisp_grid ){ 0 };
}

// Bounds of items. The fourth component is the owner's bits and has no meaning.
typedef struct grid_bounds
{
    float lower[4], upper[4];
} grid_bounds;

// Data shared by the loops of a build.
typedef struct grid_build
{
    wisp_grid* grid;
    const float* xyzw;
    grid_bounds* bounds; // [block]
    int32_t* cell_of;    // [item]
    int32_t* begin;      // [cell + 1]
    int32_t* item;       // [slot]
    float *x, *y, *z;
    int32_t* owner;
} grid_build;

static void widen( grid_bounds* bounds, const float* lower, const float* upper )
{
    for ( int axis = 0; axis < 4; ++axis )
    {
        bounds->lower[axis] = lower[axis] < bounds->lower[axis] ? lower[axis] : bounds->lower[axis];
        bounds->upper[axis] = upper[axis] > bounds->upper[axis] ? upper[axis] : bounds->upper[axis];
    }
}

static void find_bounds( void* context, int begin, int end, int worker )
{
    (void)worker;
    const grid_build* b = context;
    const float* q = b->xyzw + 4 * (size_t)begin;
    grid_bounds bounds;
    memcpy( bounds.lower, q, sizeof( bounds.lower ) );
    memcpy( bounds.upper, q, sizeof( bounds.upper ) );
    for ( int i = begin + 1; i < end; ++i )
    {
        q += 4;
        widen( &bounds, q, q );
    }
    b->bounds[begin / GRID_GRAIN] = bounds;
}

static grid_bounds join_bounds( const grid_bounds* bounds, int count )
{
    grid_bounds all = bounds[0];
    for ( int i = 1; i < count; ++i )
    {
        widen( &all, bounds[i].lower, bounds[i].upper );
    }
    return all;
}

// Sorts axes by number of cells, fewest first but axes with one cell last; ties in the order x, y, z.
static void order_axes( wisp_grid* grid )
{
    int rank[3];
    for ( int a = 0; a < 3; ++a )
    {
        grid->axis[a] = a;
        rank[a] = grid->dims[a] > 1 ? grid->dims[a] : INT32_MAX;
    }
    for ( int i = 0; i < 3; ++i )
    {
        for ( int k = 0; k < 2; ++k )
        {
            int a = grid->axis[k], b = grid->axis[k + 1];
            bool wrong = rank[b] < rank[a];
            grid->axis[k] = wrong ? b : a;
            grid->axis[k + 1] = wrong ? a : b;
        }
    }
}

// Splits cells along the fastest axis.
static void cut_cells( wisp_grid* grid, grid_bounds bounds, int fine, double most )
{
    const int fastest = grid->axis[0];
    const double rows = (double)grid->dims[grid->axis[1]] * (double)grid->dims[grid->axis[2]];
    double extent = (double)bounds.upper[fastest] - (double)bounds.lower[fastest], dims;
    for ( ;; --fine )
    {
        dims = 1.0 + (double)(int64_t)( extent * (double)fine / (double)grid->cell );
        if ( fine == 1 || ( rows * dims <= most && dims <= GRID_CELLS_ALONG ) )
        {
            break;
        }
    }
    grid->subdivisions = fine;
    grid->dims[fastest] = (int)dims;
    for ( int axis = 0; axis < 3; ++axis )
    {
        grid->inverse_cell[axis] = 1.0f / grid->cell;
    }
    grid->inverse_cell[fastest] = (float)fine / grid->cell;
}

// Widens cells in steps of a quarter until their number is within the limits of memory and floats.
static void choose_cells( wisp_grid* grid, grid_bounds bounds, float cell, int fine )
{
    // subtracting the origin and dividing have a rounding error below 3 units in the last place of the extent
    double max_extent = 0.0;
    for ( int axis = 0; axis < 3; ++axis )
    {
        double extent = (double)bounds.upper[axis] - (double)bounds.lower[axis];
        max_extent = extent > max_extent ? extent : max_extent;
    }
    grid->rounding_margin = (float)( 4e-7 * max_extent );
    cell = ( cell + grid->rounding_margin ) * 1.000001f;

    const double most = (double)GRID_CELLS_PER_ITEM * grid->count + 64.0;
    const float requested = cell;
    double dims[3];
    for ( ;; cell *= 1.25f )
    {
        double cells = 1.0, along = 0.0;
        for ( int axis = 0; axis < 3; ++axis )
        {
            double extent = (double)bounds.upper[axis] - (double)bounds.lower[axis];
            dims[axis] = 1.0 + (double)(int64_t)( extent / (double)cell );
            cells *= dims[axis];
            along = dims[axis] > along ? dims[axis] : along;
        }
        if ( cells <= most && along <= GRID_CELLS_ALONG )
        {
            break;
        }
    }
    for ( int axis = 0; axis < 3; ++axis )
    {
        grid->origin[axis] = bounds.lower[axis];
        grid->dims[axis] = (int)dims[axis];
    }
    grid->cell = cell;
    grid->is_widened = cell > 1.5f * requested;
    grid->planar = bounds.lower[2] == bounds.upper[2];
    order_axes( grid );
    cut_cells( grid, bounds, fine, most );
}

// Computes the cell of an item with the same rounding as the search, so that an item is found in its own cell.
// Clamps before the conversion to an integer, which is equivalent and vectorises.
static void find_cells( void* context, int begin, int end, int worker )
{
    (void)worker;
    const grid_build* b = context;
    const wisp_grid* g = b->grid;
    const int to_middle = g->dims[g->axis[0]], to_slow = to_middle * g->dims[g->axis[1]];
    int stride[4] = { 0 };
    stride[g->axis[0]] = 1;
    stride[g->axis[1]] = to_middle;
    stride[g->axis[2]] = to_slow;
    const float origin[4] = { g->origin[0], g->origin[1], g->origin[2], 0.0f };
    const float scale[4] = { g->inverse_cell[0], g->inverse_cell[1], g->inverse_cell[2], 0.0f };
    const float last[4] = { (float)( g->dims[0] - 1 ), (float)( g->dims[1] - 1 ), (float)( g->dims[2] - 1 ), 0.0f };
    for ( int i = begin; i < end; ++i )
    {
        const float* q = b->xyzw + 4 * (size_t)i;
        int cell[4];
        for ( int axis = 0; axis < 4; ++axis )
        {
            float along = ( q[axis] - origin[axis] ) * scale[axis];
            along = along > 0.0f ? along : 0.0f;
            cell[axis] = (int)( along < last[axis] ? along : last[axis] );
        }
        b->cell_of[i] = cell[0] * stride[0] + cell[1] * stride[1] + cell[2] * stride[2];
    }
}

// Sorts items by cell with a stable counting sort. Runs on one worker: it moves four bytes per item.
static void sort_items( grid_build* b, int cells )
{
    const int count = b->grid->count;
    memset( b->begin, 0, ( (size_t)cells + 1 ) * sizeof( int32_t ) );
    for ( int i = 0; i < count; ++i )
    {
        b->begin[b->cell_of[i] + 1] += 1;
    }
    for ( int c = 0; c < cells; ++c )
    {
        b->begin[c + 1] += b->begin[c];
    }
    for ( int i = 0; i < count; ++i )
    {
        b->item[b->begin[b->cell_of[i]]++] = i;
    }
    // each begin has advanced to the end of its cell, which is the begin of the next one
    memmove( b->begin + 1, b->begin, (size_t)cells * sizeof( int32_t ) );
    b->begin[0] = 0;
}

static void copy_slots( void* context, int begin, int end, int worker )
{
    (void)worker;
    const grid_build* b = context;
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* q = b->xyzw + 4 * (size_t)b->item[slot];
        b->x[slot] = q[0];
        b->y[slot] = q[1];
        b->z[slot] = q[2];
        memcpy( b->owner + slot, q + 3, sizeof( int32_t ) );
    }
}

static bool reserve_items( grid_build* b, const wisp_allocator* allocator )
{
    wisp_grid* g = b->grid;
    size_t count = (size_t)g->count, slots = ( count + GRID_PADDING + 15 ) & ~(size_t)15;
    size_t blocks = count / GRID_GRAIN + 1;
    if ( wisp_buffer_reserve( g->buffers + 0, allocator, 5 * slots * 4 ) == false ||
         wisp_buffer_reserve( g->buffers + 1, allocator, count * 4 ) == false ||
         wisp_buffer_reserve( g->buffers + 2, allocator, blocks * sizeof( grid_bounds ) ) == false )
    {
        return false;
    }
    b->item = g->buffers[0].data;
    b->x = (float*)( b->item + slots );
    b->y = b->x + slots;
    b->z = b->y + slots;
    b->owner = (int32_t*)( b->z + slots );
    b->cell_of = g->buffers[1].data;
    b->bounds = g->buffers[2].data;

    // wide loads mask slots after the last one, but these must be initialised
    for ( size_t i = count; i < slots; ++i )
    {
        b->item[i] = b->owner[i] = 0;
        b->x[i] = b->y[i] = b->z[i] = 0.0f;
    }
    return true;
}

wisp_status wisp_grid_build( wisp_grid* grid, const wisp_parallel* parallel, const float* xyzw, int count, float cell,
                             int fine )
{
    WISP_ASSERT( cell > 0.0f && fine > 0 && count >= 0 );
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    grid_build b = { .grid = grid, .xyzw = xyzw };
    grid->count = count;
    if ( reserve_items( &b, allocator ) == false )
    {
        return WISP_NO_MEMORY;
    }
    grid_bounds bounds = { { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } };
    if ( count > 0 )
    {
        wisp_parallel_for( parallel, count, GRID_GRAIN, find_bounds, &b );
        bounds = join_bounds( b.bounds, ( count + GRID_GRAIN - 1 ) / GRID_GRAIN );
    }
    choose_cells( grid, bounds, cell, fine );
    int cells = grid->dims[0] * grid->dims[1] * grid->dims[2];
    if ( wisp_buffer_reserve( grid->buffers + 3, allocator, ( (size_t)cells + 1 ) * sizeof( int32_t ) ) == false )
    {
        return WISP_NO_MEMORY;
    }
    b.begin = grid->buffers[3].data;
    wisp_parallel_for( parallel, count, GRID_GRAIN, find_cells, &b );
    sort_items( &b, cells );
    wisp_parallel_for( parallel, count, GRID_GRAIN, copy_slots, &b );
    grid->cell_begin = b.begin;
    grid->item = b.item;
    grid->x = b.x;
    grid->y = b.y;
    grid->z = b.z;
    grid->owner = b.owner;
    return WISP_OK;
}
