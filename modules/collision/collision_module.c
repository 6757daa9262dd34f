// The module: components, passes, state.
#include "collision_bodies.h"
#include "collision_state.h"
#include "near_bodies.h"
#include "primitive_contacts.h"
#include "reaction.h"

COLLISION_COMPONENTS( WISP_COMPONENT_COLUMNS )

// ---- declaration ----

static void release_state( void* memory, const wisp_allocator* allocator )
{
    collision_state* state = memory;
    for ( int i = 0; i < state->body_count; ++i )
    {
        collision_release_body( allocator, state->bodies + i );
    }
    collision_release_reactions( allocator, state );
    collision_release_near( state, allocator );
    wisp_release( allocator, state->bodies, (size_t)state->body_capacity * sizeof( collision_body ) );
}

// With the last body all participants lose their contacts, and the plan its passes. This only detaches, so it cannot
// fail.
static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    collision_state* state = memory;
    collision_forget_surface( state, entity );
    collision_body body;
    if ( collision_forget_body( state, wisp_world_allocator( world ), entity, &body ) )
    {
        collision_update_for( world, state, &body );
    }
}

static wisp_status entity_teleported( void* memory, wisp_world* world, wisp_entity entity,
                                      const wisp_teleport_motion* teleport, bool* is_moved )
{
    const collision_state* state = memory;
    collision_collider* collider = wisp_world_column( world, entity, state->collider, 0 );
    wisp_transform* target = wisp_world_column( world, entity, state->motion, 0 );
    if ( collider != NULL && wisp_world_has( world, entity, state->follower ) == false )
    {
        collider->from = wisp_teleport_pose( teleport, collider->from );
        collider->to = wisp_teleport_pose( teleport, collider->to );
        *is_moved = true;
    }
    if ( target != NULL )
    {
        *target = wisp_teleport_pose( teleport, *target );
    }
    collision_coupled* coupled = wisp_world_column( world, entity, state->coupled, 0 );
    if ( coupled != NULL )
    {
        coupled->before = wisp_teleport_pose( teleport, coupled->before );
    }
    return WISP_OK;
}

// Whether contacts are stored depends on what other modules have attached.
static wisp_status collision_plan( void* memory, wisp_world* world )
{
    return collision_update_components( world, memory );
}

// As wisp_state_hooks.planned. A body without layers is one to be met later.
static void tell_of_bodies( const void* memory, wisp_world* world )
{
    const collision_state* s = memory;
    for ( int b = 0; b < s->body_count; ++b )
    {
        const collision_body* body = s->bodies + b;
        const collision_collider* own = wisp_world_rows( world, body->entity, s->collider, 0 );
        bool is_met = own->layers == 0;
        for ( wisp_entity e = { 0, 0 }; is_met == false && collision_next_participant( s, &e ); )
        {
            const collision_settings* settings = wisp_world_rows( world, e, s->settings, 0 );
            is_met = settings->enabled != 0 && ( settings->mask & own->layers ) != 0 &&
                     ( body->follows == false || e.index != body->surface.index );
        }
        wisp_world_tell( world, body->follows ? body->surface : body->entity, is_met == false,
                         "nothing collides with this collider: no 'collision' has one of its layers" );
    }
}

static wisp_status declare_components( wisp_registry* r, collision_state* s )
{
    COLLISION_COMPONENTS( WISP_COMPONENT_DECLARE )
    wisp_declare_map( r, WISP_MAP_COLLISION_THICKNESS, s->settings, NULL );
    wisp_declare_map( r, WISP_MAP_COLLISION_FRICTION, s->settings, NULL );
    return s->clearance != 0 ? WISP_OK : WISP_BAD_INPUT;
}

// Contacts and tracks of a substep are written before they are read, and may name bodies that are gone, but never a negative place.
static wisp_status declare_indices( wisp_registry* r, const collision_state* s )
{
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->settings, collision_settings, enabled, 0, 1 ),
        WISP_MEMBER_RANGE( s->settings, collision_settings, stats, 0, 1 ),
        WISP_COLUMN_RANGE( s->active, 0, 0, 1 ),
        WISP_COLUMN_RANGE( s->follower, 0, 0, 1 ),
        WISP_COLUMN_RANGE( s->tracked, 0, -1, INT32_MAX ),
        WISP_COLUMN_RANGE( s->strand_tracked, 0, -1, INT32_MAX ),
        WISP_COLUMN_RANGE( s->contact_body, 0, 0, INT32_MAX ),
        WISP_COLUMN_RANGE( s->edge_contacts, 0, 0, INT32_MAX ),
        WISP_COLUMN_RANGE( s->triangle_contacts, 0, 0, INT32_MAX ),
        { .component = s->reaction_part, .kind = WISP_INDEX_SAME },
        { .component = s->all_features, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_EDGE },
        { .component = s->all_features, .column = 1, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_TRIANGLE },
        { .component = s->all_features, .column = 2, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_EDGE },
        { .component = s->all_features, .column = 3, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_TRIANGLE },
        { .component = s->edge_contacts, .column = 1, .kind = WISP_INDEX_ROW, .table = WISP_TABLE_EDGE },
        WISP_COLUMN_RANGE( s->edge_contacts, 2, 0, INT32_MAX ),
        { .component = s->triangle_contacts, .column = 1, .kind = WISP_INDEX_ROW, .table = WISP_TABLE_TRIANGLE },
        WISP_COLUMN_RANGE( s->triangle_contacts, 2, 0, INT32_MAX ),
    };
    return wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) );
}

static wisp_status declare_passes( wisp_registry* r, collision_state* state )
{
    const wisp_pass contact_input = {
        WISP_PASS( "collision.contact_input", FORCE, PARTICLE_BLOCK, collision_sense ),
        .required = { state->settings, state->active, WISP_PARTICLE_EXTERNAL_SOLVER, WISP_PARTICLE_CONTACTS },
        .excluded = { state->reaction_part },
        .reads = { state->settings, state->active, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
        .writes = { WISP_PARTICLE_CONTACTS },
    };
    wisp_pass reacting_input = contact_input;
    reacting_input.name = "collision.reacting_input";
    reacting_input.required[4] = state->reaction_part;
    reacting_input.excluded[0] = 0;
    reacting_input.reads[4] = WISP_PARTICLE_CONTACT_IMPULSES; // which its next substep finds empty again
    const wisp_pass passes[] = {
        {
            WISP_PASS( "collision.carry", INPUT, ENTITY, collision_update_poses ),
            .required = { state->motion, state->collider },
            .reads = { state->motion, state->collider },
            .writes = { state->collider },
        },
        {
            WISP_PASS( "collision.follow", INPUT, ENTITY, collision_follow ),
            .required = { state->follower },
            .writes = { state->follower },
        },
        {
            WISP_PASS( "collision.find", CONTACT, PARTICLE_BLOCK, collision_find ),
            .required = { state->settings, WISP_PARTICLE_HALF_SPACES },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
        },
        {
            WISP_PASS( "collision.find_primitives", CONTACT, ENTITY, collision_find_primitives ),
            .required = { state->settings, state->edge_contacts },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_HALF_SPACES },
            .writes = { state->edge_contacts, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .fabric = WISP_FABRIC_EDGES,
        },
        {
            WISP_PASS( "collision.share", CONTACT, ENTITY, collision_share_contacts ),
            .required = { state->collider, state->coupled },
            .reads = { state->collider },
            .writes = { state->coupled },
            .foreign = { WISP_PARTICLE_POSITION, WISP_PARTICLE_HALF_SPACES, state->edge_contacts },
            .among = state->settings,
        },
        {
            WISP_PASS( "collision.project", PROJECT, PARTICLE_BLOCK, collision_project ),
            .required = { state->settings, WISP_PARTICLE_HALF_SPACES },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION },
        },
        {
            WISP_PASS( "collision.keep_outside", PROJECT, PARTICLE_BLOCK, collision_keep_outside ),
            .required = { state->settings, state->active },
            .excluded = { WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, state->active, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .run_crowd = collision_keep_crowd_outside,
        },
        {
            WISP_PASS( "collision.project_primitives", PROJECT, ENTITY, collision_project_primitives ),
            .required = { state->settings, state->edge_contacts },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, state->edge_contacts, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { state->edge_contacts, WISP_PARTICLE_POSITION },
        },
        {
            WISP_PASS( "collision.restitution", VELOCITY, PARTICLE_BLOCK, collision_bounce_off ),
            .required = { state->settings, WISP_PARTICLE_HALF_SPACES, state->bounce },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->bounce, WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
        },
        {
            WISP_PASS( "collision.gather_impulses", VELOCITY, PARTICLE_BLOCK, collision_gather_impulses ),
            .required = { state->reaction_part, WISP_PARTICLE_EXTERNAL_SOLVER, WISP_PARTICLE_CONTACTS },
            .writes = { WISP_PARTICLE_CONTACT_IMPULSES },
        },
        {
            WISP_PASS( "collision.couple", VELOCITY, ENTITY, collision_couple ),
            .required = { state->collider, state->coupled },
            .reads = { state->collider, state->coupled },
            .writes = { state->coupled },
            .foreign = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_HALF_SPACES,
                         WISP_PARTICLE_CONTACTS, WISP_PARTICLE_CONTACT_IMPULSES },
            .among = state->settings,
        },
        {
            WISP_PASS( "collision.reaction", OBSERVE, ENTITY, collision_read_reactions ),
            .required = { state->collider, state->reaction },
            .reads = { state->collider },
            .writes = { state->reaction },
        },
        {
            WISP_PASS( "collision.stats", OBSERVE, ENTITY, collision_measure ),
            .required = { state->settings, state->active },
            .reads = { state->settings, state->active, WISP_PARTICLE_POSITION },
            .writes = { state->stats },
        },
        contact_input,
        reacting_input,
        {
            WISP_PASS( "collision.strands", PROJECT, STRAND_GROUP, collision_touch_strands ),
            .required = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_PREVIOUS },
            .writes = { state->strand_contact, WISP_STRAND_POSITION, WISP_STRAND_PREVIOUS },
        },
        {
            WISP_PASS( "collision.settle_strands", VELOCITY, STRAND_GROUP, collision_part_strands ),
            .required = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_PREVIOUS, WISP_STRAND_VELOCITY },
            .writes = { state->strand_contact, WISP_STRAND_POSITION, WISP_STRAND_PREVIOUS, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "collision.strand_stats", OBSERVE, ENTITY, collision_measure_strands ),
            .required = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION },
            .writes = { state->stats },
        },
        {
            // It reads positions, so it runs after passes that start an appearance without reading them. Among passes
            // that read them too, the order of modules decides.
            WISP_PASS( "collision.carried", SHAPE, STRAND_GROUP, collision_keep_out ),
            .required = { state->settings, state->posed },
            .reads = { state->settings, state->posed, WISP_STRAND_POSITION },
            .writes = { state->posed, WISP_STRAND_POSITION },
        },
        {
            WISP_PASS( "collision.carried_stats", OBSERVE, ENTITY, collision_measure_posed ),
            .required = { state->settings, state->posed },
            .reads = { state->settings, state->posed, WISP_STRAND_POSITION },
            .writes = { state->stats },
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), state );
}

static size_t count_memory( const void* memory, size_t* outside )
{
    const collision_state* state = memory;
    size_t bytes = (size_t)state->body_capacity * sizeof( collision_body ) +
                   state->sum_capacity * sizeof( collision_impulse ) + collision_near_bytes( state );
    for ( int i = 0; i < state->body_count; ++i )
    {
        const wisp_collision_mesh* mesh = state->bodies[i].tree;
        const size_t elsewhere = mesh != NULL ? wisp_collision_mesh_outside_bytes( mesh ) : 0;
        bytes += mesh != NULL ? wisp_collision_mesh_bytes( mesh ) - elsewhere : 0;
        *outside += elsewhere;
        bytes += collision_body_bytes( state->bodies + i );
    }
    return bytes;
}

static wisp_status declare( wisp_registry* r )
{
    collision_state* state = wisp_declare_state( r, sizeof( collision_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){ .release = release_state,
                                  .removed = entity_removed,
                                  .teleported = entity_teleported,
                                  .planning = collision_plan,
                                  .planned = tell_of_bodies,
                                  .begun = collision_list_near,
                                  .memory = count_memory,
                                  .lines = collision_add_lines,
                                  .sleep = &( wisp_sleep_hooks ){ .surroundings = collision_surroundings } } );
    state->registry = r;
    state->has_iterations = wisp_registry_iterations( r ) > 1;
    WISP_TRY( declare_components( r, state ) );
    WISP_TRY( declare_indices( r, state ) );
    return declare_passes( r, state );
}

const wisp_module wisp_collision_module = { .name = "collision", .declare = declare };
