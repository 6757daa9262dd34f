// Interaction of strands: velocity and density on a grid, once per step (Petrovic, Henne and Anderson 2005). In:
// positions, velocities, masses. Out: velocities. Corners of cells gather from the vertices around them in the order
// of the grid, so that sums do not depend on the workers. A vertex takes from the eight corners of its cell with the
// same weights, which keeps the momentum that friction exchanges.
#include "strand_passes.h"

#include "strand_rows.h"

#include "wisp/module/space.h"

#include <string.h>

enum
{
    GRAIN = 256, // cells or corners per block
};

typedef struct grid_workspace
{
    wisp_grid grid;
    wisp_buffer xyzw;    // [item][4] x, y, z, 0
    wisp_buffer entries; // [item] index in a column of scalars
    wisp_buffer corners; // grid_corner
} grid_workspace;

// Sums at a corner of cells.
typedef struct grid_corner
{
    double mass, momentum[3]; // kg, kg m/s
} grid_corner;

size_t strands_grid_workspace_size( void )
{
    return sizeof( grid_workspace );
}

size_t strands_grid_workspace_bytes( const void* memory )
{
    const grid_workspace* w = memory;
    return wisp_grid_bytes( &w->grid ) + w->xyzw.size + w->entries.size + w->corners.size;
}

void strands_grid_workspace_release( void* memory, const wisp_allocator* allocator )
{
    grid_workspace* w = memory;
    wisp_grid_release( &w->grid, allocator );
    wisp_buffer_release( &w->xyzw, allocator );
    wisp_buffer_release( &w->entries, allocator );
    wisp_buffer_release( &w->corners, allocator );
}

// ---- items: free vertices ----

static int gather_items( const wisp_strand_topology* t, const float* position, const float* weight, float* xyzw,
                         int32_t* entries )
{
    int count = 0;
    for ( int row = 0; row < t->row_count; ++row )
    {
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            const size_t at = strands_scalar( row, lane );
            if ( weight[at] > 0.0f )
            {
                const wisp_vec3 p = strands_get( position, row, lane );
                const float quad[4] = { p.x, p.y, p.z, 0.0f };
                memcpy( xyzw + (size_t)count * 4, quad, sizeof( quad ) );
                entries[count++] = (int32_t)at;
            }
        }
    }
    return count;
}

static bool reserve_items( grid_workspace* w, const wisp_allocator* allocator, int row_count )
{
    const size_t most = (size_t)row_count * WISP_LANES;
    return wisp_buffer_reserve( &w->xyzw, allocator, most * 4 * sizeof( float ) ) &&
           wisp_buffer_reserve( &w->entries, allocator, most * sizeof( int32_t ) );
}

// ---- loops ----

typedef struct grid_loop
{
    const wisp_grid* grid;
    const int32_t* entries;
    const float* weight;
    float* velocity;              // null: at rest
    float *displacement, *before; // history; null: none
    float dt;                     // s, of a substep
    grid_corner* corners;
    int nodes[3];
    double inverse_volume;       // 1/m^3
    float friction;              // fraction, in this step
    float push;                  // m/s where the density is twice that at rest
    double inverse_rest_density; // m^3/kg
} grid_loop;

static int cell_number( const wisp_grid* g, const int cell[3] )
{
    const int* axis = g->axis;
    return ( cell[axis[2]] * g->dims[axis[1]] + cell[axis[1]] ) * g->dims[axis[0]] + cell[axis[0]];
}

// Compute the position of an item within its cell, each coordinate in [0, 1].
static void place_in( const wisp_grid* g, int slot, const int cell[3], double out[3] )
{
    const float p[3] = { g->x[slot], g->y[slot], g->z[slot] };
    for ( int k = 0; k < 3; ++k )
    {
        const double u = ( (double)p[k] - (double)g->origin[k] ) / (double)g->cell - (double)cell[k];
        out[k] = fmin( fmax( u, 0.0 ), 1.0 );
    }
}

// Return the trilinear weight of a cell's corner. Bit k of the corner is its side along axis k.
static double fraction_along( const double place[3], int corner )
{
    double fraction = 1.0;
    for ( int k = 0; k < 3; ++k )
    {
        fraction *= ( corner >> k & 1 ) != 0 ? place[k] : 1.0 - place[k];
    }
    return fraction;
}

static size_t velocity_at( int32_t entry )
{
    return strands_vector( entry / WISP_LANES, entry % WISP_LANES );
}

static void gather_cell( const grid_loop* loop, const int cell[3], int corner, grid_corner* sum )
{
    const wisp_grid* g = loop->grid;
    const int number = cell_number( g, cell );
    for ( int slot = g->cell_begin[number]; slot < g->cell_begin[number + 1]; ++slot )
    {
        double place[3];
        place_in( g, slot, cell, place );
        const int32_t entry = loop->entries[g->item[slot]];
        const double mass = fraction_along( place, corner ) / (double)loop->weight[entry];
        sum->mass += mass;
        for ( int k = 0; k < 3 && loop->velocity != NULL; ++k )
        {
            sum->momentum[k] += mass * (double)loop->velocity[velocity_at( entry ) + (size_t)k * WISP_LANES];
        }
    }
}

static void gather_corners( void* context, int begin, int end, int worker )
{
    (void)worker;
    grid_loop* loop = context;
    for ( int n = begin; n < end; ++n )
    {
        const int at[3] = { n % loop->nodes[0], n / loop->nodes[0] % loop->nodes[1],
                            n / loop->nodes[0] / loop->nodes[1] };
        grid_corner sum = { 0 };
        for ( int corner = 0; corner < 8; ++corner )
        {
            const int cell[3] = { at[0] - ( corner & 1 ), at[1] - ( corner >> 1 & 1 ), at[2] - ( corner >> 2 & 1 ) };
            bool inside = true;
            for ( int k = 0; k < 3; ++k )
            {
                inside = inside && cell[k] >= 0 && cell[k] < loop->grid->dims[k];
            }
            if ( inside )
            {
                gather_cell( loop, cell, corner, &sum );
            }
        }
        loop->corners[n] = sum;
    }
}

// Interpolated velocity, density and its gradient.
typedef struct grid_sample
{
    double velocity[3], density, gradient[3];
} grid_sample;

static const grid_corner* corner_of( const grid_loop* loop, const int cell[3], int corner )
{
    const int x = cell[0] + ( corner & 1 ), y = cell[1] + ( corner >> 1 & 1 ), z = cell[2] + ( corner >> 2 & 1 );
    return loop->corners + ( z * loop->nodes[1] + y ) * loop->nodes[0] + x;
}

static grid_sample sample( const grid_loop* loop, const int cell[3], const double place[3] )
{
    grid_sample out = { .density = 0.0 };
    for ( int corner = 0; corner < 8; ++corner )
    {
        const grid_corner* c = corner_of( loop, cell, corner );
        const double fraction = fraction_along( place, corner ), density = c->mass * loop->inverse_volume;
        out.density += fraction * density;
        for ( int k = 0; k < 3; ++k )
        {
            out.velocity[k] += c->mass > 0.0 ? fraction * c->momentum[k] / c->mass : 0.0;
            double slope = ( corner >> k & 1 ) != 0 ? 1.0 : -1.0;
            for ( int other = 1; other < 3; ++other )
            {
                const int a = ( k + other ) % 3;
                slope *= ( corner >> a & 1 ) != 0 ? place[a] : 1.0 - place[a];
            }
            out.gradient[k] += slope * density;
        }
    }
    return out;
}

// Change the velocity of a vertex. Its history changes as if it had always moved so, since only what is new in a
// substep may be extrapolated.
static void mix_vertex( const grid_loop* loop, int32_t entry, const grid_sample* s )
{
    const size_t at = velocity_at( entry );
    const double steep =
        sqrt( s->gradient[0] * s->gradient[0] + s->gradient[1] * s->gradient[1] + s->gradient[2] * s->gradient[2] );
    const double excess = fmax( s->density * loop->inverse_rest_density - 1.0, 0.0 );
    const double push = steep > 0.0 ? (double)loop->push * excess / steep : 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        const size_t lane = at + (size_t)k * WISP_LANES;
        const float before = loop->velocity[lane];
        const double own = (double)before;
        loop->velocity[lane] =
            (float)( own + (double)loop->friction * ( s->velocity[k] - own ) - push * s->gradient[k] );
        if ( loop->before != NULL )
        {
            const float change = loop->velocity[lane] - before;
            loop->before[lane] += change;
            loop->displacement[lane] += loop->dt * change;
        }
    }
}

static void cell_of( const wisp_grid* g, int number, int cell[3] )
{
    const int* axis = g->axis;
    cell[axis[0]] = number % g->dims[axis[0]];
    cell[axis[1]] = number / g->dims[axis[0]] % g->dims[axis[1]];
    cell[axis[2]] = number / g->dims[axis[0]] / g->dims[axis[1]];
}

static void mix_cells( void* context, int begin, int end, int worker )
{
    (void)worker;
    const grid_loop* loop = context;
    const wisp_grid* g = loop->grid;
    for ( int number = begin; number < end; ++number )
    {
        int cell[3];
        cell_of( g, number, cell );
        for ( int slot = g->cell_begin[number]; slot < g->cell_begin[number + 1]; ++slot )
        {
            double place[3];
            place_in( g, slot, cell, place );
            const grid_sample s = sample( loop, cell, place );
            mix_vertex( loop, loop->entries[g->item[slot]], &s );
        }
    }
}

// Return the mean density, weighted by mass.
static double mean_density( const grid_loop* loop )
{
    const wisp_grid* g = loop->grid;
    double mass = 0.0, sum = 0.0;
    for ( int number = 0; number < g->dims[0] * g->dims[1] * g->dims[2]; ++number )
    {
        int cell[3];
        cell_of( g, number, cell );
        for ( int slot = g->cell_begin[number]; slot < g->cell_begin[number + 1]; ++slot )
        {
            double place[3];
            place_in( g, slot, cell, place );
            const double own = 1.0 / (double)loop->weight[loop->entries[g->item[slot]]];
            mass += own;
            sum += own * sample( loop, cell, place ).density;
        }
    }
    return mass > 0.0 ? sum / mass : 0.0;
}

// ---- the pass ----

// Sort vertices into cells and gather at the corners. @return false without memory, or without a free vertex
static bool fill( wisp_frame* frame, const wisp_span* span, grid_workspace* w, const float* position, float cell,
                  grid_loop* loop )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    wisp_status status = reserve_items( w, allocator, t->row_count ) ? WISP_OK : WISP_NO_MEMORY;
    const int count =
        status == WISP_OK ? gather_items( t, position, loop->weight, w->xyzw.data, w->entries.data ) : 0;
    if ( status == WISP_OK && count > 0 )
    {
        status = wisp_grid_build( &w->grid, parallel, w->xyzw.data, count, cell, 1 );
    }
    int nodes = 1;
    for ( int k = 0; k < 3; ++k )
    {
        loop->nodes[k] = w->grid.dims[k] + 1;
        nodes *= loop->nodes[k];
    }
    if ( status == WISP_OK && count > 0 )
    {
        const bool room = wisp_buffer_reserve( &w->corners, allocator, (size_t)nodes * sizeof( grid_corner ) );
        status = room ? WISP_OK : WISP_NO_MEMORY;
    }
    if ( status != WISP_OK )
    {
        wisp_frame_fail( frame, status, "out of memory for a grid of %d strands", t->strand_count );
        return false;
    }
    if ( count == 0 )
    {
        return false;
    }
    wisp_frame_count( frame, WISP_COUNT_COARSE_GRIDS, w->grid.is_widened ? 1 : 0 );
    loop->grid = &w->grid;
    loop->entries = w->entries.data;
    loop->corners = w->corners.data;
    loop->inverse_volume = 1.0 / ( (double)w->grid.cell * (double)w->grid.cell * (double)w->grid.cell );
    wisp_parallel_for( parallel, nodes, GRAIN, gather_corners, loop );
    return true;
}

void strands_mix( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    strands_grid* settings = wisp_frame_column( frame, span->entity, state->grid, 0 );
    grid_workspace* w = wisp_frame_workspace( frame, state->workspace, span->worker );
    const float seconds = wisp_frame_dt( frame, span->entity ) * (float)wisp_frame_substeps( frame, span->entity );
    grid_loop loop = {
        .weight = wisp_frame_column( frame, span->entity, WISP_STRAND_INVERSE_MASS, 0 ),
        .friction = 1.0f - powf( 1.0f - settings->friction, 60.0f * seconds ),
        .push = settings->repulsion * seconds,
    };
    // the density at rest is computed in the first step
    if ( settings->repulsion > 0.0f && settings->rest_density == 0.0f &&
         fill( frame, span, w, wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 ), settings->cell,
               &loop ) )
    {
        settings->rest_density = (float)mean_density( &loop );
    }
    loop.inverse_rest_density = settings->rest_density > 0.0f ? 1.0 / (double)settings->rest_density : 0.0;
    loop.velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    if ( wisp_frame_has( frame, span->entity, state->history ) )
    {
        loop.displacement = wisp_frame_column( frame, span->entity, state->history, 0 );
        loop.before = wisp_frame_column( frame, span->entity, state->history, 1 );
        loop.dt = wisp_frame_dt( frame, span->entity );
    }
    if ( fill( frame, span, w, wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ), settings->cell,
               &loop ) )
    {
        const int cells = w->grid.dims[0] * w->grid.dims[1] * w->grid.dims[2];
        wisp_parallel_for( wisp_frame_parallel( frame, span ), cells, GRAIN, mix_cells, &loop );
    }
}

// ---- definition ----

static const wisp_field STRAND_GRID_FIELDS[] = {
    WISP_SWITCH( wisp_strand_grid_def, enabled, true ),
    WISP_NUMBER( wisp_strand_grid_def, cell_size, 0, 0, 1e6, "m" ),
    WISP_NUMBER( wisp_strand_grid_def, friction, 0.1, 0, 1, NULL ),
    WISP_NUMBER( wisp_strand_grid_def, repulsion, 0, 0, 1e6, "m/s^2" ),
};
WISP_DEFINE( strand_grid_def, "strand grid", STRAND_GRID_FIELDS )

// Return twice the mean segment, m; a millimetre if all segments have no length.
static float cell_for( const strands_rows* rows )
{
    const wisp_strand_topology* t = rows->topology;
    double sum = 0.0;
    int count = 0;
    for ( size_t i = 0; i < (size_t)t->row_count * WISP_LANES; ++i )
    {
        sum += (double)rows->length[i];
        count += rows->length[i] > 0.0f ? 1 : 0;
    }
    return count > 0 ? (float)( 2.0 * sum / count ) : 1e-3f;
}

wisp_status wisp_set_strand_grid( wisp_world* world, wisp_entity strands, const wisp_strand_grid_def* given )
{
    wisp_strand_grid_def values;
    const wisp_strand_grid_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &strands, &wisp_strand_grid_def_fields, &values, given ) );
    strands_state* state;
    WISP_TRY( strands_find( world, strands, &state ) );
    const strands_rows rows = strands_rows_of( world, strands );
    const strands_grid grid = { .cell = def->cell_size > 0.0f ? def->cell_size : cell_for( &rows ),
                                .friction = def->friction,
                                .repulsion = def->repulsion };
    wisp_world_tell( world, strands, def->enabled && def->friction == 0.0f && def->repulsion == 0.0f,
                     "'grid' has no effect without friction or repulsion" );
    return wisp_world_set_row( world, strands, state->grid, def->enabled ? &grid : NULL, sizeof( grid ) );
}
