// Participants: which surfaces and strands collide, and how. In: wisp_collision_def. Out: components of the entity.
// Components of contact exist only while there is a body, so that without one the plan has no pass of this module.
#include "collision_state.h"

#include "collision_vectors.h"
#include "reaction.h"
#include "particle_contacts.h"

#include <string.h>

// ---- components ----

// Contacts are kept in a substep where somebody reads them afterwards, or they are not found in one sweep.
static bool stores_contacts( wisp_world* world, const collision_state* state, wisp_entity surface )
{
    const collision_settings* settings = wisp_world_column( world, surface, state->settings, 0 );
    return state->has_iterations || wisp_world_lets_meet( world, surface ) ||
           wisp_world_has( world, surface, state->all_features ) ||
           wisp_world_has( world, surface, WISP_MAP_COLLISION_THICKNESS ) ||
           wisp_world_has( world, surface, WISP_MAP_COLLISION_FRICTION ) || state->wants_reactions ||
           ( state->stored_layers & settings->mask ) != 0;
}

// A surface of an external solver has contact input in place of contacts. Its rows are cleared without a body,
// because no pass writes them then.
static wisp_status update_surface( wisp_world* world, const collision_state* state, wisp_entity participant,
                                   bool active, bool stats )
{
    const bool touches = active && wisp_world_has( world, participant, WISP_PARTICLE_EXTERNAL_SOLVER ) == false;
    const bool is_stored = touches && stores_contacts( world, state, participant );
    const bool is_all = touches && wisp_world_has( world, participant, state->all_features );
    const wisp_component_use uses[] = {
        { state->active, active },
        { WISP_PARTICLE_HALF_SPACES, is_stored },
        { state->tracked, is_stored && state->track_count > 0 },
        { state->bounce, is_stored && state->has_bouncy },
        { state->edge_contacts, is_all },
        { state->triangle_contacts, is_all },
        { state->clearance, is_all },
        { state->stats, stats ? WISP_REQUESTED : 0 },
    };
    const wisp_status status = wisp_world_set_components( world, participant, uses, WISP_COUNT( uses ) );
    int32_t* body = active ? NULL : wisp_world_column( world, participant, WISP_PARTICLE_CONTACTS, 0 );
    if ( body != NULL )
    {
        const int slots = wisp_world_fabric( world, participant )->slot_count;
        memset( body, 0, (size_t)slots * WISP_MAX_PARTICLE_CONTACTS * sizeof( int32_t ) );
    }
    return status;
}

// Whether the segments of strands that move meet a body.
static bool meets_segments( wisp_world* world, const collision_state* state, wisp_entity strands, int body )
{
    const collision_settings* settings = wisp_world_column( world, strands, state->settings, 0 );
    const collision_collider* collider = wisp_world_column( world, state->bodies[body].entity, state->collider, 0 );
    const bool is_all = wisp_world_has( world, strands, state->all_features );
    return ( collider->layers & settings->mask ) != 0 &&
           collision_meets_segments( state->bodies + body, settings->thickness + collider->thickness,
                                     is_all ? INFINITY : wisp_world_rest_lengths( world, strands ).longest );
}

static bool meets_any_segments( wisp_world* world, const collision_state* state, wisp_entity participant )
{
    bool any = false;
    for ( int i = 0; i < state->body_count && any == false; ++i )
    {
        any = meets_segments( world, state, participant, i );
    }
    return any;
}

// Strands that got dynamics since they were added change their component.
static wisp_status update_strands( wisp_world* world, const collision_state* state, wisp_entity participant,
                                   bool active, bool stats )
{
    const bool touches = active && wisp_world_has( world, participant, WISP_STRAND_INVERSE_MASS );
    const wisp_component_use uses[] = {
        { state->strand_contact, touches },
        { state->posed, active && touches == false },
        { state->strand_tracked, touches && state->track_count > 0 },
        { state->segment_contact, touches && meets_any_segments( world, state, participant ) },
        { state->stats, stats ? WISP_REQUESTED : 0 },
    };
    return wisp_world_set_components( world, participant, uses, WISP_COUNT( uses ) );
}

// Edges and corners of meshes are found once something collides with them.
static wisp_status prepare_meshes( wisp_world* world, const collision_state* state, wisp_entity participant )
{
    const bool is_surface = wisp_world_strands( world, participant ) == NULL;
    for ( int i = 0; i < state->body_count && state->has_trees; ++i )
    {
        wisp_error error = { 0 };
        wisp_collision_mesh* tree = state->bodies[i].tree;
        const bool is_wanted = is_surface ? wisp_world_has( world, participant, state->all_features )
                                          : meets_segments( world, state, participant, i );
        if ( is_wanted && tree != NULL && wisp_collision_mesh_prepare_features( tree, &error ) != WISP_OK )
        {
            return wisp_world_fail( world, error.status, "%s", error.message );
        }
    }
    return WISP_OK;
}

wisp_status collision_update_participant( wisp_world* world, const collision_state* state, wisp_entity participant )
{
    const collision_settings* settings = wisp_world_column( world, participant, state->settings, 0 );
    const bool active = state->body_count > 0 && settings->enabled != 0, stats = active && settings->stats != 0;
    WISP_TRY( active ? prepare_meshes( world, state, participant ) : WISP_OK );
    return wisp_world_strands( world, participant ) == NULL
               ? update_surface( world, state, participant, active, stats )
               : update_strands( world, state, participant, active, stats );
}

wisp_status collision_update_components( wisp_world* world, collision_state* state )
{
    wisp_status status = WISP_OK;
    collision_note_reactions( world, state );
    for ( wisp_entity e = { 0, 0 }; status == WISP_OK && collision_next_participant( state, &e ); )
    {
        status = collision_update_participant( world, state, e );
    }
    return status == WISP_OK ? collision_update_reactions( world, state ) : status;
}

wisp_status collision_update_for( wisp_world* world, collision_state* state, const collision_body* body )
{
    if ( state->body_count <= 1 || body->tree != NULL || body->restitution > 0.0f || body->is_coupled ||
         state->sums != NULL )
    {
        return collision_update_components( world, state );
    }
    for ( wisp_entity e = { 0, 0 }; state->has_strands && collision_next_participant( state, &e ); )
    {
        const wisp_component_use use = { state->segment_contact, meets_any_segments( world, state, e ) };
        const bool moves = wisp_world_has( world, e, state->strand_contact );
        WISP_TRY( moves ? wisp_world_set_components( world, e, &use, 1 ) : WISP_OK );
    }
    return WISP_OK;
}

// ---- definitions ----

static const wisp_field COLLISION_FIELDS[] = {
    WISP_NUMBER( wisp_collision_def, thickness, 0, 0, 1e6, "m" ),
    WISP_NUMBER( wisp_collision_def, friction_scale, 1, 0, 1e6, NULL ),
    WISP_NUMBER( wisp_collision_def, max_push_out_speed, 0, 0, 1e6, "m/s" ),
    WISP_BITS( wisp_collision_def, mask, -1 ),
    WISP_SWITCH( wisp_collision_def, enabled, true ),
    WISP_CHOICE( wisp_collision_def, features, WISP_COLLISION_VERTICES, WISP_COLLISION_FEATURES_COUNT ),
};
WISP_DEFINE( collision_def, "collision", COLLISION_FIELDS )

// Return the mean rest length of edges or segments, m; a millimetre where all are zero.
static float mean_length( wisp_world* world, wisp_entity participant )
{
    const float length = wisp_world_rest_lengths( world, participant ).mean;
    return length > 0.0f ? length : 1e-3f;
}

static collision_settings resolve( const wisp_collision_def* d, float edge, int32_t stats )
{
    return ( collision_settings ){
        .thickness = d->thickness > 0.0f ? d->thickness : 0.25f * edge,
        .friction = d->friction_scale,
        .max_push_out_speed = d->max_push_out_speed > 0.0f ? d->max_push_out_speed : 10.0f * edge,
        .mask = d->mask,
        .enabled = d->enabled ? 1 : 0,
        .stats = stats,
    };
}

// Strands with velocities need masses and lengths too, or contacts have nothing to act on.
static wisp_status check_motion( wisp_world* world, wisp_entity participant )
{
    return wisp_world_has( world, participant, WISP_STRAND_VELOCITY ) &&
                   ( wisp_world_has( world, participant, WISP_STRAND_INVERSE_MASS ) == false ||
                     wisp_world_has( world, participant, WISP_STRAND_LENGTH ) == false )
               ? wisp_world_fail( world, WISP_CONFLICT,
                                  "collision: the strands of entity %u do not move: give them dynamics first",
                                  participant.index )
               : WISP_OK;
}

static wisp_status check_features( wisp_world* world, wisp_entity participant, wisp_collision_features features )
{
    if ( features == WISP_COLLISION_ALL && wisp_world_has( world, participant, WISP_PARTICLE_EXTERNAL_SOLVER ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "collision: entity %u is moved by an external solver and collides by vertices alone",
                                participant.index );
    }
    return WISP_OK;
}

// Apply the settings of a participant. A mark for edges and triangles is there before what needs it, and goes after.
static wisp_status apply( wisp_world* world, collision_state* state, wisp_entity participant, bool all_features )
{
    wisp_status status = all_features ? wisp_world_attach( world, participant, state->all_features ) : WISP_OK;
    float* longest = wisp_world_column( world, participant, state->all_features, 4 );
    if ( longest != NULL )
    {
        *longest = 1.25f * wisp_world_rest_lengths( world, participant ).longest;
    }
    status = status == WISP_OK ? collision_update_participant( world, state, participant ) : status;
    status = status == WISP_OK ? collision_update_reactions( world, state ) : status;
    if ( status == WISP_OK && all_features == false && wisp_world_has( world, participant, state->all_features ) )
    {
        status = wisp_world_detach( world, participant, state->all_features );
        status =
            status == WISP_OK ? collision_update_participant( world, state, participant ) : status; // only detaches
    }
    return status;
}

wisp_status wisp_set_collision( wisp_world* world, wisp_entity participant, const wisp_collision_def* given )
{
    wisp_collision_def values;
    const wisp_collision_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &participant, &wisp_collision_def_fields, &values, given ) );
    WISP_FIND_STATE( collision_state, state, world, "collision", &participant, WISP_IS_SURFACE | WISP_IS_STRANDS );
    WISP_TRY( check_motion( world, participant ) );
    WISP_TRY( check_features( world, participant, def->features ) );
    const bool is_new = wisp_world_has( world, participant, state->settings ) == false;
    WISP_TRY( wisp_world_attach( world, participant, state->settings ) );
    state->has_strands = state->has_strands || wisp_world_strands( world, participant ) != NULL;
    collision_settings* settings = wisp_world_column( world, participant, state->settings, 0 );
    const collision_settings before = *settings;
    *settings = resolve( def, mean_length( world, participant ), before.stats );
    const bool was_all = wisp_world_has( world, participant, state->all_features );
    wisp_status status = apply( world, state, participant, def->features == WISP_COLLISION_ALL );
    if ( status != WISP_OK )
    {
        settings = wisp_world_column( world, participant, state->settings, 0 );
        *settings = before;
        if ( was_all == false )
        {
            wisp_world_detach( world, participant, state->all_features );
        }
        collision_update_participant( world, state, participant ); // only detaches, so it cannot fail
    }
    if ( status != WISP_OK && is_new )
    {
        wisp_world_detach( world, participant, state->settings );
    }
    return status;
}
