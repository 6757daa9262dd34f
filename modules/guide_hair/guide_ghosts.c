// Definition of ghosts: defaults, ranges, which strands may follow which.
#include "guide_internal.h"

void wisp_init_ghosts_def( wisp_ghosts_def* def, size_t size )
{
    const wisp_ghosts_def values = {
        .target_count = 1,
        .elastic = WISP_GHOST_ELASTIC_CHANGE,
        .tip_gain = 0.5f,
        .centre_gain = 0.5f,
        .spread = 1.0f,
    };
    wisp_def_init( def, size, &values, sizeof( values ) );
}

// ---- checks ----

static wisp_status check_def( wisp_world* world, const wisp_ghosts_def* d )
{
    const wisp_number_range ranges[] = {
        { "target_count", (float)d->target_count, 1.0f, (float)WISP_MAX_GHOST_TARGETS },
        { "elastic", (float)d->elastic, 0.0f, (float)( WISP_GHOST_ELASTIC_COUNT - 1 ) },
        { "tip_gain", d->tip_gain, 0.0f, 1e3f },
        { "centre_gain", d->centre_gain, 0.0f, 1e3f },
        { "time", d->time, 0.0f, 1e3f },
        { "spread", d->spread, 1e-6f, 1e6f },
    };
    return wisp_world_check_ranges( world, "ghosts", ranges, WISP_COUNT( ranges ) );
}

static wisp_status check_strands( wisp_world* world, wisp_entity entity, const char* what )
{
    if ( wisp_is_alive( world, entity ) == false )
    {
        return wisp_world_fail( world, entity.index == 0 ? WISP_CONFLICT : WISP_STALE_ID,
                                "ghosts: entity %u of %s does not exist or was removed", entity.index, what );
    }
    if ( wisp_world_strands( world, entity ) == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u of %s has no strands", entity.index, what );
    }
    return WISP_OK;
}

// Refuse ghosts of ghosts: tables are filled before ghosts are placed, so they would follow a step late.
static wisp_status check_roles( wisp_world* world, const guide_state* s, wisp_entity ghosts, wisp_entity targets )
{
    if ( wisp_entity_equal( ghosts, targets ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u cannot follow itself", ghosts.index );
    }
    if ( wisp_world_strands( world, targets )->vertex_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: targets: entity %u has no vertices", targets.index );
    }
    if ( wisp_world_has( world, ghosts, WISP_STRAND_VELOCITY ) || wisp_world_has( world, ghosts, s->curves ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u has a solver of its own", ghosts.index );
    }
    if ( wisp_world_has( world, targets, s->settings ) || wisp_world_has( world, targets, s->curves ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: targets: entity %u are ghosts themselves",
                                targets.index );
    }
    if ( wisp_world_has( world, ghosts, s->before ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u is the target of other ghosts",
                                ghosts.index );
    }
    return WISP_OK;
}

static wisp_status check( wisp_world* world, const guide_state* s, wisp_entity ghosts, const wisp_ghosts_def* def )
{
    if ( s == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "module guide_hair: not registered in this world" );
    }
    wisp_status status = check_def( world, def );
    status = status == WISP_OK ? check_strands( world, ghosts, "the ghosts" ) : status;
    status = status == WISP_OK ? check_strands( world, def->targets, "the targets" ) : status;
    return status == WISP_OK ? check_roles( world, s, ghosts, def->targets ) : status;
}

// ---- following ----

// Request the passes that advance state, even if no output is requested. The rows exist, so this needs no memory.
static wisp_status keep_running( wisp_world* world, const guide_state* s, wisp_entity ghosts,
                                 const wisp_ghosts_def* def )
{
    const struct
    {
        wisp_component component;
        bool on;
    } parts[] = { { s->between, def->between }, { s->interval, def->between } };
    wisp_status status = wisp_world_request( world, def->targets, s->table );
    for ( int i = 0; i < WISP_COUNT( parts ) && status == WISP_OK; ++i )
    {
        if ( parts[i].on )
        {
            status = wisp_world_request( world, ghosts, parts[i].component );
        }
        else if ( wisp_world_has( world, ghosts, parts[i].component ) )
        {
            wisp_world_cancel_request( world, ghosts, parts[i].component );
            wisp_world_detach( world, ghosts, parts[i].component );
        }
    }
    return status;
}

static wisp_status attach_all( wisp_world* world, const guide_state* s, wisp_entity ghosts,
                               const wisp_ghosts_def* def )
{
    const struct
    {
        wisp_entity entity;
        wisp_component component;
        bool on;
    } parts[] = {
        { ghosts, s->settings, true },
        { ghosts, s->table, true },
        { ghosts, s->repair, def->repair_length },
        { ghosts, s->between, def->between },
        { ghosts, s->interval, def->between },
        { def->targets, s->before, true },
        { def->targets, s->table, true },
    };
    bool had[WISP_COUNT( parts )];
    for ( int i = 0; i < WISP_COUNT( parts ); ++i )
    {
        had[i] = wisp_world_has( world, parts[i].entity, parts[i].component );
    }
    for ( int i = 0; i < WISP_COUNT( parts ); ++i )
    {
        const wisp_status status =
            parts[i].on ? wisp_world_attach( world, parts[i].entity, parts[i].component ) : WISP_OK;
        for ( int k = 0; status != WISP_OK && k < i; ++k )
        {
            if ( parts[k].on && had[k] == false )
            {
                wisp_world_detach( world, parts[k].entity, parts[k].component );
            }
        }
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    if ( def->repair_length == false )
    {
        wisp_world_detach( world, ghosts, s->repair );
    }
    wisp_world_tie( world, def->targets, ghosts );
    return keep_running( world, s, ghosts, def );
}

// Replace the follower that the ghosts had.
static void install( wisp_world* world, guide_state* s, guide_follower* follower )
{
    for ( int i = 0; i < s->follower_count; ++i )
    {
        guide_follower* old = s->followers[i];
        if ( wisp_entity_equal( old->ghosts, follower->ghosts ) )
        {
            const wisp_entity targets = old->targets;
            s->followers[i] = follower;
            guide_follower_release( old );
            guide_let_go( world, s, targets );
            return;
        }
    }
    s->followers[s->follower_count++] = follower;
}

wisp_status wisp_set_ghosts( wisp_world* world, wisp_entity ghosts, const wisp_ghosts_def* given )
{
    wisp_ghosts_def values = wisp_default_ghosts_def();
    const wisp_ghosts_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, "wisp_default_ghosts_def", &values, given ) );
    WISP_TRY( wisp_world_check_entity( world, ghosts ) );
    guide_state* s = wisp_world_module_state( world, "guide_hair" );
    WISP_TRY( check( world, s, ghosts, def ) );
    if ( wisp_world_reserve( world, (void**)&s->followers, &s->follower_capacity, s->follower_count,
                             sizeof( *s->followers ) ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d entities of ghosts",
                                s->follower_count + 1 );
    }
    guide_follower* follower;
    wisp_status status = guide_cook( world, ghosts, def, &follower );
    status = status == WISP_OK ? attach_all( world, s, ghosts, def ) : status;
    if ( status != WISP_OK )
    {
        guide_follower_release( follower );
        return status;
    }
    install( world, s, follower );
    guide_settings* settings = wisp_world_column( world, ghosts, s->settings, 0 );
    *settings = ( guide_settings ){
        .time = def->time,
        .tip_gain = def->tip_gain,
        .is_elastic = def->elastic == WISP_GHOST_ELASTIC_CHANGE ? 1 : 0,
    };
    if ( def->between )
    {
        guide_begin_between( world, s, follower );
    }
    return wisp_world_has( world, ghosts, s->detail ) ? guide_prepare_detail( s, world, ghosts ) : WISP_OK;
}
