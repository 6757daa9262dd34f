// Components and passes, and the removal of entities.
#include "guide_internal.h"

#include <string.h>

// ---- memory ----

// Memory of one cooked thing, and a rest shape read into it.

void* guide_take( guide_memory* memory, size_t count, size_t element )
{
    WISP_ASSERT( memory->count < GUIDE_MAX_BLOCKS );
    const size_t bytes = ( count > 0 ? count : 1 ) * element;
    void* block = memory->allocator->allocate( memory->allocator->user, bytes, 64 );
    if ( block == NULL )
    {
        memory->failed = true;
        return NULL;
    }
    memset( block, 0, bytes );
    memory->blocks[memory->count] = block;
    memory->bytes[memory->count++] = bytes;
    return block;
}

void guide_give_back( guide_memory* memory )
{
    for ( int i = 0; i < memory->count; ++i )
    {
        memory->allocator->release( memory->allocator->user, memory->blocks[i], memory->bytes[i] );
    }
    memory->count = 0;
}

// Bytes of its blocks.
static size_t guide_memory_bytes( const guide_memory* memory )
{
    size_t bytes = 0;
    for ( int i = 0; i < memory->count; ++i )
    {
        bytes += memory->bytes[i];
    }
    return bytes;
}

bool guide_read_shape( wisp_world* world, wisp_entity strands, guide_memory* memory, guide_shape* shape )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* rows = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    shape->topology = t;
    shape->points = guide_take( memory, (size_t)t->vertex_count, sizeof( wisp_vec3 ) );
    for ( int lane = 0; lane < t->group_count * WISP_LANES && shape->points != NULL; ++lane )
    {
        const float* from = rows + (size_t)t->group_row[lane / WISP_LANES] * GUIDE_ROW + lane % WISP_LANES;
        for ( int i = 0; i < t->lane_count[lane]; ++i, from += GUIDE_ROW )
        {
            shape->points[t->offsets[t->lane_strand[lane]] + i] =
                ( wisp_vec3 ){ from[0], from[WISP_LANES], from[2 * WISP_LANES] };
        }
    }
    return shape->points != NULL;
}

// ---- state ----

// State of the module in one world: followers and drawings by their entity, and their removal.

const guide_follower* guide_active_follower( const guide_state* state, wisp_entity ghosts )
{
    const guide_follower* f = wisp_find_object( state->followers, ghosts );
    return f != NULL && f->targets.index != 0 ? f : NULL;
}

void guide_let_go( wisp_world* world, const guide_state* state, wisp_entity entity )
{
    bool followed = false, drawn = false;
    const guide_follower* f;
    for ( int place = 0; ( f = wisp_next_object( state->followers, &place ) ) != NULL; )
    {
        followed = followed || wisp_entity_equal( f->targets, entity );
    }
    const guide_drawing* d;
    for ( int place = 0; ( d = wisp_next_object( state->drawings, &place ) ) != NULL; )
    {
        drawn = drawn || wisp_entity_equal( d->source, entity );
    }
    if ( followed == false && wisp_world_has( world, entity, state->before ) )
    {
        wisp_world_detach( world, entity, state->table );
        wisp_world_detach( world, entity, state->before );
    }
    if ( drawn == false && wisp_world_has( world, entity, state->drawn ) )
    {
        wisp_world_detach( world, entity, state->drawn );
    }
}

// ---- module ----

GUIDE_COMPONENTS( WISP_COMPONENT_COLUMNS )

// ---- lists ----

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    guide_state* state = memory;
    const wisp_entity nothing = { 0, 0 };
    guide_follower* f;
    for ( int place = 0; ( f = wisp_next_object( state->followers, &place ) ) != NULL; )
    {
        f->targets = wisp_entity_equal( f->targets, entity ) ? nothing : f->targets;
    }
    guide_drawing* d;
    for ( int place = 0; ( d = wisp_next_object( state->drawings, &place ) ) != NULL; )
    {
        d->source = wisp_entity_equal( d->source, entity ) ? nothing : d->source;
    }
    // what ghosts and curves that go have followed is let go
    f = wisp_find_object( state->followers, entity );
    d = wisp_find_object( state->drawings, entity );
    const wisp_entity targets = f != NULL ? f->targets : nothing, source = d != NULL ? d->source : nothing;
    wisp_set_object( state->followers, entity, NULL );
    wisp_set_object( state->drawings, entity, NULL );
    guide_let_go( world, state, targets );
    guide_let_go( world, state, source );
}

// ---- declarations ----

static wisp_status declare_ghosts( wisp_registry* r, guide_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "guide_hair.targets", DERIVE, ENTITY, guide_run_targets ),
            .required = { s->before },
            .reads = { s->before, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { s->before, s->table },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            // Ghosts have the component of the table, so that the plan orders them after their targets. They do not
            // read their own place, but a pass that only writes it would come before the targets, which read it.
            WISP_PASS( "guide_hair.ghosts", DERIVE, STRAND_GROUP, guide_run_ghosts ),
            .required = { s->settings },
            .reads = { s->settings, s->table, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .detail = WISP_PASS_FINE,
            .should_run = guide_ghosts_are_due,
        },
        {
            WISP_PASS( "guide_hair.lengths", DERIVE, STRAND_GROUP, guide_run_lengths ),
            .required = { s->settings, s->repair },
            .reads = { s->settings, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .detail = WISP_PASS_FINE,
        },
        {
            WISP_PASS( "guide_hair.carried", DERIVE, STRAND_GROUP, guide_run_held ),
            .required = { s->settings, s->detail, s->held, s->carrier },
            .reads = { s->settings, s->detail, s->held, s->carrier, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .should_run = guide_held_is_due,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            // it reads columns that passes of a later stage write
            WISP_PASS( "guide_hair.carry", DERIVE, STRAND_GROUP, guide_run_update_poses ),
            .required = { s->settings },
            .reads = { s->settings, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSED },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "guide_hair.between", DERIVE, ENTITY, guide_run_between ),
            .required = { s->settings, s->between, s->interval },
            .reads = { s->settings, s->table, s->between, WISP_STRAND_POSITION },
            .writes = { s->between, s->interval },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .should_run = guide_between_is_due,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static wisp_status declare_curves( wisp_registry* r, guide_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "guide_hair.source", SHAPE, ENTITY, guide_run_source ),
            .required = { s->drawn },
            .reads = { s->drawn, WISP_STRAND_POSITION },
            .writes = { s->drawn },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = WISP_STRAND_POSITION,
        },
        {
            WISP_PASS( "guide_hair.curves", OBSERVE, ENTITY, guide_run_curves ),
            .required = { s->curves },
            .reads = { s->curves },
            .writes = { s->curves, WISP_STRAND_POSITION },
            .detail = WISP_PASS_WITHOUT_MOTION,
            .should_run = guide_curves_are_due,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static size_t follower_bytes( const void* memory )
{
    const guide_follower* f = memory;
    return sizeof( *f ) + guide_memory_bytes( &f->memory );
}

static size_t drawing_bytes( const void* memory )
{
    const guide_drawing* d = memory;
    return sizeof( *d ) + guide_memory_bytes( &d->memory );
}

static wisp_status declare( wisp_registry* r )
{
    guide_state* s = wisp_declare_state( r, sizeof( guide_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){ .removed = entity_removed,
                                  .detail = &( wisp_detail_hooks ){ .has_coarse = guide_has_coarse,
                                                                    .prepare = guide_prepare_detail,
                                                                    .changed = guide_detail_changed } } );
    s->followers = wisp_declare_objects( r, guide_follower_release, follower_bytes );
    s->drawings = wisp_declare_objects( r, guide_drawing_release, drawing_bytes );
    s->detail = wisp_detail_component( r );
    GUIDE_COMPONENTS( WISP_COMPONENT_DECLARE )
    wisp_declare_places( r, s->between, 0, WISP_PLACE_LANES );
    wisp_declare_places( r, s->between, 1, WISP_PLACE_LANES );
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->settings, guide_settings, is_elastic, 0, 1 ),
        { .component = s->carrier, .kind = WISP_INDEX_SAME },
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    wisp_status status = declare_ghosts( r, s );
    return status == WISP_OK ? declare_curves( r, s ) : status;
}

const wisp_module wisp_guide_hair_module = { .name = "guide_hair", .declare = declare };
