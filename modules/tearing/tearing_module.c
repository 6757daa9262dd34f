// The module: its components, its pass and its hooks.
#include "tearing_state.h"

static const wisp_column_def SETTINGS_COLUMNS[] = { TEARING_SETTINGS( WISP_COLUMN_DEF ) };
static const wisp_column_def STRENGTH_COLUMNS[] = { TEARING_STRENGTH( WISP_COLUMN_DEF ) };
static const wisp_column_def LIMIT_COLUMNS[] = { TEARING_LIMIT( WISP_COLUMN_DEF ) };
static const wisp_column_def RESULT_COLUMNS[] = { TEARING_RESULT( WISP_COLUMN_DEF ) };

static void release_state( void* memory, const wisp_allocator* allocator )
{
    tearing_state* state = memory;
    wisp_release( allocator, state->surfaces, (size_t)state->capacity * sizeof( wisp_entity ) );
}

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    (void)world;
    tearing_forget( memory, entity );
}

static size_t count_memory( const void* memory, size_t* outside )
{
    (void)outside;
    return (size_t)( (const tearing_state*)memory )->capacity * sizeof( wisp_entity );
}

// Surfaces split in the order in which they were set.
static wisp_status split_all( void* memory, wisp_world* world )
{
    const tearing_state* state = memory;
    for ( int i = 0; i < state->count; ++i )
    {
        WISP_TRY( tearing_split( world, state, state->surfaces[i] ) );
    }
    return WISP_OK;
}

static wisp_status declare( wisp_registry* r )
{
    tearing_state* state = wisp_declare_state( r, sizeof( tearing_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){
               .release = release_state, .removed = entity_removed, .stepped = split_all, .memory = count_memory } );
    state->settings = WISP_COMPONENT( r, "tearing.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS );
    state->strength = WISP_COMPONENT( r, "tearing.strength", WISP_TABLE_EDGE, STRENGTH_COLUMNS );
    state->limit = WISP_COMPONENT( r, "tearing.limit", WISP_TABLE_LINK, LIMIT_COLUMNS );
    state->result = WISP_COMPONENT( r, "tearing.result", WISP_TABLE_ENTITY, RESULT_COLUMNS );
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( state->settings, tearing_settings, max_splits, 1, TEARING_MAX_SPLITS ),
        WISP_MEMBER_RANGE( state->settings, tearing_settings, split_count, 0, INT32_MAX ),
        WISP_MEMBER_RANGE( state->result, tearing_result, is_new, 0, 1 ),
        { .component = state->result, .count = 1, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_LINK },
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    const wisp_pass pass = {
        .name = "tearing.measure",
        .stage = WISP_STAGE_CHECK,
        .domain = WISP_DOMAIN_ENTITY,
        .required = { state->settings, WISP_LINK_COMPLIANCE },
        .reads = { state->settings, state->limit, WISP_LINK_LAMBDA, WISP_PARTICLE_POSITION },
        .writes = { state->result },
        .run = tearing_measure,
    };
    return state->result != 0 ? wisp_declare_passes( r, &pass, 1, state ) : WISP_BAD_INPUT;
}

const wisp_module wisp_tearing_module = { .name = "tearing", .declare = declare };
