// The module: components and the pass.
#include "seams_state.h"

static const wisp_column_def SETTINGS_COLUMNS[] = { SEAM_SETTINGS( WISP_COLUMN_DEF ) };
static const wisp_column_def PAIRS_COLUMNS[] = { SEAM_PAIRS( WISP_COLUMN_DEF ) };
static const wisp_column_def MARK_COLUMNS[] = { { "mark", sizeof( int32_t ) } };

static void release_state( void* memory, const wisp_allocator* allocator )
{
    seams_state* state = memory;
    for ( int i = 0; i < state->count; ++i )
    {
        seams_release_pairs( allocator, state->seams + i );
    }
    wisp_release( allocator, state->seams, (size_t)state->capacity * sizeof( seam_topology ) );
}

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    seams_forget( memory, world, entity );
}

static size_t count_memory( const void* memory, size_t* outside )
{
    (void)outside;
    const seams_state* state = memory;
    size_t bytes = (size_t)state->capacity * sizeof( seam_topology );
    for ( int i = 0; i < state->count; ++i )
    {
        bytes += 2 * (size_t)state->seams[i].pair_count * sizeof( int32_t );
    }
    return bytes;
}

static wisp_status declare( wisp_registry* r )
{
    seams_state* state = wisp_declare_state( r, sizeof( seams_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){ .release = release_state, .removed = entity_removed, .memory = count_memory } );
    const wisp_component_def sewn = { "seams.sewn", WISP_TABLE_ENTITY, NULL, 0 };
    state->settings = WISP_COMPONENT( r, "seams.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS );
    state->pairs = WISP_COMPONENT( r, "seams.pairs", WISP_TABLE_PAIR, PAIRS_COLUMNS );
    state->sewn = wisp_declare_component( r, &sewn );
    state->active = WISP_COMPONENT( r, "seams.active", WISP_TABLE_ENTITY, MARK_COLUMNS );
    state->result = WISP_COMPONENT( r, "seams.result", WISP_TABLE_ENTITY, MARK_COLUMNS );
    const wisp_index_range broken = WISP_COLUMN_RANGE( state->pairs, 2, 0, 1 );
    WISP_TRY( wisp_declare_indices( r, &broken, 1 ) );
    const wisp_pass passes[] = {
        {
            .name = "seams.project",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->active },
            .reads = { state->active },
            .writes = { state->result },
            .foreign = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .among = state->sewn,
            .run = seams_project,
        },
    };
    return state->result != 0 ? wisp_declare_passes( r, passes, WISP_COUNT( passes ), state ) : WISP_BAD_INPUT;
}

const wisp_module wisp_seams_module = { .name = "seams", .declare = declare };
