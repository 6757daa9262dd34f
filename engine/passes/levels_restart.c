// Coarse sheets that begin: their masses, velocities and pins.
#include "levels.h"

#include "wisp/module/components.h"

#include <string.h>

// Adds the masses of the next finer rows to those that carry them.
static void add_masses( const wisp_fabric_level* level, const double* finer, double* mass )
{
    memset( mass, 0, (size_t)level->row_count * sizeof( double ) );
    for ( int row = 0; row < level->finer_row_count; ++row )
    {
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            const size_t at = levels_parent_at( row, k );
            mass[level->parent_x4[at] / 4] += (double)level->weight[at] * finer[row];
        }
    }
}

// Finds the inverse masses of all levels. A coarse vertex is pinned where the surface is.
static bool find_masses( wisp_frame* frame, const wisp_span* span )
{
    const wisp_fabric* f = wisp_frame_fabric( frame, span->entity );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* inverse_mass = wisp_frame_column( frame, span->entity, WISP_LEVEL_MASS, 0 );
    const size_t room = ( (size_t)f->slot_count + (size_t)f->levels[0].row_count ) * sizeof( double );
    double* finer = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, room );
    if ( finer == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the coarse sheets of %d particles",
                         f->slot_count );
        return false;
    }
    double* mass = finer + f->slot_count;
    for ( int slot = 0; slot < f->slot_count; ++slot )
    {
        const double w = (double)position[4 * slot + 3];
        finer[slot] = w > 0.0 ? 1.0 / w : 0.0;
    }
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* level = f->levels + l;
        add_masses( level, finer, mass );
        for ( int row = 0; row < level->row_count; ++row )
        {
            const bool moves =
                row < level->vertex_count && position[level->slot_x4[row] + 3] > 0.0f && mass[row] > 0.0;
            finer[row] = moves ? mass[row] : 0.0;
            inverse_mass[level->first_row + row] = moves ? (float)( 1.0 / mass[row] ) : 0.0f;
        }
    }
    return true;
}

bool levels_have_restarted( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)user;
    return *levels_columns_of( frame, entity ).state == LEVELS_RESTARTED;
}

// @return the most pins between rows that a level has
static int count_pins( const levels_surface* s )
{
    int most = 0;
    for ( int l = 0; l < s->fabric->level_count; ++l )
    {
        const int count = levels_find_pins( s, l, NULL, 0 );
        most = count > most ? count : most;
    }
    return most;
}

void levels_restart( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const levels_columns columns = levels_columns_of( frame, span->entity );
    const wisp_fabric* f = wisp_frame_fabric( frame, span->entity );
    if ( find_masses( frame, span ) )
    {
        const float* velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
        levels_gather_rows( levels_coarsest( f ), velocity,
                            wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 0 ) );
        levels_gather_rows( levels_coarsest( f ), velocity,
                            wisp_frame_column( frame, span->entity, WISP_LEVEL_MOTION, 4 ) );
        const levels_surface surface = levels_surface_of( frame, span->entity );
        levels_find_mean( surface.position + 3, 4, velocity, f->slot_count, columns.drift );
        *columns.pins = count_pins( &surface );
        *columns.state = LEVELS_FIRST;
    }
}
