// The module: its component and its pass.
#include "attachments_state.h"

#include "wisp/module/sleep.h"

static const wisp_column_def PLACE_COLUMNS[] = { WISP_COLUMN( attachments_place, place, 1 ) };

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    attachments_forget( memory, world, entity );
}

static wisp_status triangles_changed( void* memory, wisp_world* world, wisp_entity surface,
                                      const wisp_fabric* before )
{
    attachments_follow_triangles( memory, world, surface, before );
    return WISP_OK;
}

// As wisp_sleep_hooks.surroundings: pins go along with surfaces that must sleep themselves.
static bool find_surroundings( const void* memory, wisp_world* world, wisp_entity entity,
                               const wisp_sleep_bounds* bounds, uint64_t* hash )
{
    (void)bounds;
    (void)hash;
    const attachments_state* state = memory;
    const attachments_place* place = wisp_world_rows( world, entity, state->place, 0 );
    const int count = place != NULL ? wisp_world_fabric( world, entity )->slot_count : 0;
    bool rests = true;
    for ( int slot = 0; slot < count && rests; ++slot )
    {
        const wisp_entity to = place[slot].to;
        rests = to.index == 0 || wisp_is_asleep( world, to ) || wisp_is_halted( world, to );
    }
    return rests;
}

static wisp_status declare( wisp_registry* r )
{
    attachments_state* state = wisp_declare_state( r, sizeof( attachments_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->registry = r;
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){ .removed = entity_removed,
                                  .triangles_changed = triangles_changed,
                                  .sleep = &( wisp_sleep_hooks ){ .surroundings = find_surroundings } } );
    state->place = WISP_COMPONENT( r, "attachments.place", WISP_TABLE_PARTICLE, PLACE_COLUMNS );
    const wisp_index_range ranges[] = {
        { .component = state->place, .kind = WISP_INDEX_SURFACE },
        { .component = state->place,
          .offset = offsetof( attachments_place, corner ),
          .count = 3,
          .kind = WISP_INDEX_SLOT },
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    const wisp_pass passes[] = {
        {
            WISP_PASS( "attachments.follow", INPUT, ENTITY, attachments_follow ),
            .required = { state->place },
            .reads = { state->place, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_TARGET },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
    };
    return state->place != 0 ? wisp_declare_passes( r, passes, WISP_COUNT( passes ), state ) : WISP_BAD_INPUT;
}

const wisp_module wisp_attachments_module = { .name = "attachments", .declare = declare };
