// The module: components, passes, state.
#include "collision_bodies.h"
#include "collision_participants.h"
#include "collision_passes.h"
#include "collision_surface.h"
#include "near_bodies.h"
#include "primitive_contacts.h"
#include "reaction.h"

#define COLLISION_SETTINGS_COLUMNS( X ) X( collision_settings, settings, 1 )
#define COLLISION_ACTIVE_COLUMNS( X ) X( int32_t, active, 1 ) /* there is a body, and it is enabled */
#define COLLISION_STRAND_CONTACT_COLUMNS( X )                                                                        \
    X( float, pushed, 16 )   /* m, normal correction of this substep; below 0: of the last one */                    \
    X( float, depth, 16 )    /* m, depth that a vertex may keep in this iteration */                                 \
    X( float, left, 16 )     /* m, depth that it kept */                                                             \
    X( float, friction, 48 ) /* m, sum of what friction removed in this substep */                                   \
    X( float, body, 16 )     /* number of the body that pushed; -1: several */                                       \
    X( float, last, 16 )     /* m, pushed in the last substep */
#define COLLISION_SEGMENT_CONTACT_COLUMNS( X )                                                                       \
    COLLISION_STRAND_CONTACT_COLUMNS( X )                                                                            \
    X( float, turn, 16 )                                       /* m, push of the last iteration */
#define COLLISION_CARRIED_COLUMNS( X ) X( uint32_t, moved, 1 ) /* a bit for each lane of the row, in this step */
#define COLLISION_STATS_COLUMNS( X ) X( wisp_collision_stats, stats, 1 )
#define COLLISION_COLLIDER_COLUMNS( X ) X( collision_collider, collider, 1 )
#define COLLISION_MOTION_COLUMNS( X ) X( wisp_transform, target, 1 ) /* at the end of the next step */

#define COLLISION_TRACKED_COLUMNS( X )                                                                               \
    X( int32_t, triangle, COLLISION_TRACKS ) /* that was closest, of each body that is tracked; -1: none was near */ \
    X( float, free,                                                                                                  \
       COLLISION_TRACKS ) /* m, at least the distance of `origin` from the body to the end of the step */            \
    X( wisp_vec3, origin, COLLISION_TRACKS ) /* m, in the frame of the body: where this was found */
#define COLLISION_STRAND_TRACKED_COLUMNS( X )                                                                        \
    X( int32_t, triangle, 16 * COLLISION_TRACKS ) /* [body][lane] */                                                 \
    X( float, free, 16 * COLLISION_TRACKS )                                                                          \
    X( float, origin, 48 * COLLISION_TRACKS )                    /* [body][x, y, z][lane] */
#define COLLISION_FOLLOWER_COLUMNS( X ) X( int32_t, follows, 1 ) /* the body is a surface */
#define COLLISION_REACTION_COLUMNS( X ) X( wisp_reaction, reaction, 1 )
#define COLLISION_COUPLED_COLUMNS( X ) X( collision_coupled, coupled, 1 )
#define COLLISION_REACTION_PART_COLUMNS( X ) X( int32_t, first, 1 )
#define COLLISION_CONTACT_BODY_COLUMNS( X ) X( int32_t, body, WISP_COLLISION_CONTACTS )
#define COLLISION_BOUNCE_COLUMNS( X ) X( float, bounce, WISP_COLLISION_CONTACTS )

#define COLLISION_ALL_FEATURES_COLUMNS( X )                                                                          \
    X( int32_t, active_edges, 1 ) /* those with contacts in this substep */                                          \
    X( int32_t, active_triangles, 1 )                                                                                \
    X( int32_t, near_edges, 1 ) /* those that may have some in this step */                                          \
    X( int32_t, near_triangles, 1 )                                                                                  \
    X( float, longest, 1 ) /* m, somewhat more than the longest edge at rest */
#define COLLISION_PRIMITIVE_CONTACT_COLUMNS( X )                                                                     \
    X( int32_t, found, 1 )  /* contacts, those left out included */                                                  \
    X( int32_t, active, 1 ) /* a list: those with contacts */                                                        \
    X( int32_t, near, 1 )   /* a list: those that may have some in this step */                                      \
    X( collision_primitive_contact, contacts, COLLISION_PRIMITIVE_CONTACTS )

#define COLLISION_CLEARANCE_COLUMNS( X )                                                                             \
    X( int32_t, words, 1 ) /* as in wisp_clear_args */                                                               \
    X( float, place, 4 )

static const wisp_column_def SETTINGS_COLUMNS[] = { COLLISION_SETTINGS_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def ACTIVE_COLUMNS[] = { COLLISION_ACTIVE_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def STRAND_CONTACT_COLUMNS[] = { COLLISION_STRAND_CONTACT_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def SEGMENT_CONTACT_COLUMNS[] = { COLLISION_SEGMENT_CONTACT_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def CARRIED_COLUMNS[] = { COLLISION_CARRIED_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def STATS_COLUMNS[] = { COLLISION_STATS_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def COLLIDER_COLUMNS[] = { COLLISION_COLLIDER_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def MOTION_COLUMNS[] = { COLLISION_MOTION_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def TRACKED_COLUMNS[] = { COLLISION_TRACKED_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def STRAND_TRACKED_COLUMNS[] = { COLLISION_STRAND_TRACKED_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def FOLLOWER_COLUMNS[] = { COLLISION_FOLLOWER_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def REACTION_COLUMNS[] = { COLLISION_REACTION_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def COUPLED_COLUMNS[] = { COLLISION_COUPLED_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def REACTION_PART_COLUMNS[] = { COLLISION_REACTION_PART_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def CONTACT_BODY_COLUMNS[] = { COLLISION_CONTACT_BODY_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def ALL_FEATURES_COLUMNS[] = { COLLISION_ALL_FEATURES_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def PRIMITIVE_CONTACT_COLUMNS[] = { COLLISION_PRIMITIVE_CONTACT_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def CLEARANCE_COLUMNS[] = { COLLISION_CLEARANCE_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def BOUNCE_COLUMNS[] = { COLLISION_BOUNCE_COLUMNS( WISP_COLUMN_DEF ) };

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
    wisp_release( allocator, state->participants, (size_t)state->participant_capacity * sizeof( wisp_entity ) );
}

// With the last body all participants lose their contacts, and the plan its passes. This only detaches, so it cannot
// fail.
static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    collision_state* state = memory;
    collision_forget_surface( state, entity );
    collision_body body;
    if ( collision_forget_participant( state, entity ) == false &&
         collision_forget_body( state, wisp_world_allocator( world ), entity, &body ) )
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
        for ( int i = 0; i < s->participant_count && is_met == false; ++i )
        {
            const wisp_entity e = s->participants[i];
            const collision_settings* settings = wisp_world_rows( world, e, s->settings, 0 );
            is_met = settings->enabled != 0 && ( settings->mask & own->layers ) != 0 &&
                     ( body->follows == false || e.index != body->surface.index );
        }
        wisp_world_tell( world, body->follows ? body->surface : body->entity, is_met == false,
                         "nothing collides with this collider: no 'collision' has one of its layers" );
    }
}

static wisp_status declare_components( wisp_registry* r, collision_state* state )
{
    state->settings = WISP_COMPONENT( r, "collision.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS );
    wisp_declare_map( r, WISP_MAP_COLLISION_THICKNESS, state->settings, NULL );
    wisp_declare_map( r, WISP_MAP_COLLISION_FRICTION, state->settings, NULL );
    state->active = WISP_COMPONENT( r, "collision.active", WISP_TABLE_ENTITY, ACTIVE_COLUMNS );
    state->strand_contact =
        WISP_COMPONENT( r, "collision.strand_contact", WISP_TABLE_STRAND_ROW, STRAND_CONTACT_COLUMNS );
    state->segment_contact =
        WISP_COMPONENT( r, "collision.segment_contact", WISP_TABLE_STRAND_ROW, SEGMENT_CONTACT_COLUMNS );
    state->carried = WISP_COMPONENT( r, "collision.carried", WISP_TABLE_STRAND_ROW, CARRIED_COLUMNS );
    state->stats = WISP_COMPONENT( r, "collision.stats", WISP_TABLE_ENTITY, STATS_COLUMNS );
    state->collider = WISP_COMPONENT( r, "collision.collider", WISP_TABLE_ENTITY, COLLIDER_COLUMNS );
    state->motion = WISP_COMPONENT( r, "collision.motion", WISP_TABLE_ENTITY, MOTION_COLUMNS );
    state->follower = WISP_COMPONENT( r, "collision.follower", WISP_TABLE_ENTITY, FOLLOWER_COLUMNS );
    state->tracked = WISP_COMPONENT( r, "collision.tracked", WISP_TABLE_PARTICLE, TRACKED_COLUMNS );
    state->strand_tracked =
        WISP_COMPONENT( r, "collision.strand_tracked", WISP_TABLE_STRAND_ROW, STRAND_TRACKED_COLUMNS );
    state->reaction = WISP_COMPONENT( r, "collision.reaction", WISP_TABLE_ENTITY, REACTION_COLUMNS );
    state->coupled = WISP_COMPONENT( r, "collision.coupled", WISP_TABLE_ENTITY, COUPLED_COLUMNS );
    state->reaction_part = WISP_COMPONENT( r, "collision.reaction_part", WISP_TABLE_ENTITY, REACTION_PART_COLUMNS );
    state->contact_body = WISP_COMPONENT( r, "collision.contact_body", WISP_TABLE_PARTICLE, CONTACT_BODY_COLUMNS );
    state->bounce = WISP_COMPONENT( r, "collision.bounce", WISP_TABLE_PARTICLE, BOUNCE_COLUMNS );
    state->all_features = WISP_COMPONENT( r, "collision.all_features", WISP_TABLE_ENTITY, ALL_FEATURES_COLUMNS );
    state->edge_contacts = WISP_COMPONENT( r, "collision.edge_contacts", WISP_TABLE_EDGE, PRIMITIVE_CONTACT_COLUMNS );
    state->triangle_contacts =
        WISP_COMPONENT( r, "collision.triangle_contacts", WISP_TABLE_TRIANGLE, PRIMITIVE_CONTACT_COLUMNS );
    state->clearance = WISP_COMPONENT( r, "collision.clearance", WISP_TABLE_PARTICLE, CLEARANCE_COLUMNS );
    return state->clearance != 0 ? WISP_OK : WISP_BAD_INPUT;
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
        { .component = s->edge_contacts, .column = 2, .kind = WISP_INDEX_ROW, .table = WISP_TABLE_EDGE },
        { .component = s->triangle_contacts, .column = 1, .kind = WISP_INDEX_ROW, .table = WISP_TABLE_TRIANGLE },
        { .component = s->triangle_contacts, .column = 2, .kind = WISP_INDEX_ROW, .table = WISP_TABLE_TRIANGLE },
    };
    return wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) );
}

static wisp_status declare_passes( wisp_registry* r, collision_state* state )
{
    const wisp_pass contact_input = {
        .name = "collision.contact_input",
        .stage = WISP_STAGE_FORCE,
        .domain = WISP_DOMAIN_PARTICLE_BLOCK,
        .required = { state->settings, state->active, WISP_PARTICLE_EXTERNAL_SOLVER, WISP_PARTICLE_CONTACTS },
        .excluded = { state->reaction_part },
        .reads = { state->settings, state->active, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
        .writes = { WISP_PARTICLE_CONTACTS },
        .run = collision_sense,
    };
    wisp_pass reacting_input = contact_input;
    reacting_input.name = "collision.reacting_input";
    reacting_input.required[4] = state->reaction_part;
    reacting_input.excluded[0] = 0;
    reacting_input.reads[4] = WISP_PARTICLE_CONTACT_IMPULSES; // which its next substep finds empty again
    const wisp_pass passes[] = {
        {
            .name = "collision.carry",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->motion, state->collider },
            .reads = { state->motion, state->collider },
            .writes = { state->collider },
            .run = collision_carry,
        },
        {
            .name = "collision.follow",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->follower },
            .writes = { state->follower },
            .run = collision_follow,
        },
        {
            .name = "collision.find",
            .stage = WISP_STAGE_CONTACT,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .required = { state->settings, WISP_PARTICLE_HALF_SPACES },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .run = collision_find,
        },
        {
            .name = "collision.find_primitives",
            .stage = WISP_STAGE_CONTACT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->settings, state->edge_contacts },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, WISP_PARTICLE_HALF_SPACES },
            .writes = { state->edge_contacts, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .run = collision_find_primitives,
            .fabric = WISP_FABRIC_EDGES,
        },
        {
            .name = "collision.share",
            .stage = WISP_STAGE_CONTACT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->collider, state->coupled },
            .reads = { state->collider },
            .writes = { state->coupled },
            .foreign = { WISP_PARTICLE_POSITION, WISP_PARTICLE_HALF_SPACES, state->edge_contacts },
            .among = state->settings,
            .run = collision_share_contacts,
        },
        {
            .name = "collision.project",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .required = { state->settings, WISP_PARTICLE_HALF_SPACES },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION },
            .run = collision_project,
        },
        {
            .name = "collision.keep_outside",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .required = { state->settings, state->active },
            .excluded = { WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, state->active, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .run = collision_keep_outside,
            .run_crowd = collision_keep_crowd_outside,
        },
        {
            .name = "collision.project_primitives",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->settings, state->edge_contacts },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->settings, state->edge_contacts, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { state->edge_contacts, WISP_PARTICLE_POSITION },
            .run = collision_project_primitives,
        },
        {
            .name = "collision.restitution",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .required = { state->settings, WISP_PARTICLE_HALF_SPACES, state->bounce },
            .excluded = { WISP_PARTICLE_EXTERNAL_SOLVER },
            .reads = { state->bounce, WISP_PARTICLE_HALF_SPACES, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
            .run = collision_bounce_off,
        },
        {
            .name = "collision.gather_impulses",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .required = { state->reaction_part, WISP_PARTICLE_EXTERNAL_SOLVER, WISP_PARTICLE_CONTACTS },
            .writes = { WISP_PARTICLE_CONTACT_IMPULSES },
            .run = collision_gather_impulses,
        },
        {
            .name = "collision.couple",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->collider, state->coupled },
            .reads = { state->collider, state->coupled },
            .writes = { state->coupled },
            .foreign = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_HALF_SPACES,
                         WISP_PARTICLE_CONTACTS, WISP_PARTICLE_CONTACT_IMPULSES },
            .among = state->settings,
            .run = collision_couple,
        },
        {
            .name = "collision.reaction",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->collider, state->reaction },
            .reads = { state->collider },
            .writes = { state->reaction },
            .run = collision_read_reactions,
        },
        {
            .name = "collision.stats",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->settings, state->active },
            .reads = { state->settings, state->active, WISP_PARTICLE_POSITION },
            .writes = { state->stats },
            .run = collision_measure,
        },
        contact_input,
        reacting_input,
        {
            .name = "collision.strands",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_PREVIOUS },
            .writes = { state->strand_contact, WISP_STRAND_POSITION, WISP_STRAND_PREVIOUS },
            .run = collision_touch_strands,
        },
        {
            .name = "collision.settle_strands",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_PREVIOUS, WISP_STRAND_VELOCITY },
            .writes = { state->strand_contact, WISP_STRAND_POSITION, WISP_STRAND_PREVIOUS, WISP_STRAND_VELOCITY },
            .run = collision_settle_strands,
        },
        {
            .name = "collision.strand_stats",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION },
            .writes = { state->stats },
            .run = collision_measure_strands,
        },
        {
            // It reads positions, so it runs after passes that start an appearance without reading them. Among passes
            // that read them too, the order of modules decides.
            .name = "collision.carried",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { state->settings, state->carried },
            .reads = { state->settings, state->carried, WISP_STRAND_POSITION },
            .writes = { state->carried, WISP_STRAND_POSITION },
            .run = collision_keep_out,
        },
        {
            .name = "collision.carried_stats",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { state->settings, state->carried },
            .reads = { state->settings, state->carried, WISP_STRAND_POSITION },
            .writes = { state->stats },
            .run = collision_measure_carried,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), state );
}

static size_t count_memory( const void* memory, size_t* outside )
{
    const collision_state* state = memory;
    size_t bytes = (size_t)state->body_capacity * sizeof( collision_body ) +
                   (size_t)state->participant_capacity * sizeof( wisp_entity ) +
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
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .release = release_state,
                                                  .removed = entity_removed,
                                                  .teleported = entity_teleported,
                                                  .planning = collision_plan,
                                                  .planned = tell_of_bodies,
                                                  .begun = collision_list_near,
                                                  .memory = count_memory,
                                                  .lines = collision_add_lines } );
    wisp_declare_sleep( r, &( wisp_sleep_hooks ){ .surroundings = collision_surroundings } );
    state->has_iterations = wisp_registry_iterations( r ) > 1;
    WISP_TRY( declare_components( r, state ) );
    WISP_TRY( declare_indices( r, state ) );
    return declare_passes( r, state );
}

const wisp_module wisp_collision_module = { .name = "collision", .declare = declare };
