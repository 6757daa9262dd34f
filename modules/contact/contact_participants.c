// Participants: which entities take part in contact, and how. In: wisp_contact_def. Out: components of the entity,
// its row in `guests`. All participants meet at one entity of their own, whose passes work on the contact mesh. It
// exists while there are any.
#include "contact_state.h"

#include <string.h>

static const wisp_field CONTACT_FIELDS[] = {
    WISP_NUMBER( wisp_contact_def, thickness, 0, 0, 1e6, "m" ),
    WISP_NUMBER( wisp_contact_def, friction, 0.3, 0, 1e6, NULL ),
    WISP_SWITCH( wisp_contact_def, self, true ),
    WISP_NUMBER( wisp_contact_def, max_push_out_speed, 0, 0, 1e6, "m/s" ),
    WISP_BITS( wisp_contact_def, layers, 1 ),
    WISP_BITS( wisp_contact_def, mask, -1 ),
    WISP_SWITCH( wisp_contact_def, enabled, true ),
    WISP_SWITCH( wisp_contact_def, between_strands, false ),
};
WISP_DEFINE( contact_def, "contact", CONTACT_FIELDS )

int contact_find_participant( const contact_state* state, wisp_entity entity )
{
    for ( int i = 0; i < state->participant_count; ++i )
    {
        if ( wisp_entity_equal( state->participants[i].entity, entity ) )
        {
            return i;
        }
    }
    return -1;
}

static bool has_strands( const contact_state* state )
{
    for ( int i = 0; i < state->participant_count; ++i )
    {
        if ( state->participants[i].is_strands )
        {
            return true;
        }
    }
    return false;
}

void contact_forget_participant( wisp_world* world, contact_state* state, int number )
{
    state->participant_count -= 1;
    memmove( state->participants + number, state->participants + number + 1,
             (size_t)( state->participant_count - number ) * sizeof( contact_participant ) );
    state->changed = true;
    if ( has_strands( state ) == false )
    {
        wisp_world_detach( world, state->mesh_entity, state->touches );
    }
    if ( state->participant_count == 0 )
    {
        const wisp_component_use none[] = { { state->result, 0 }, { state->stats, 0 }, { state->active, 0 } };
        (void)wisp_world_set_components( world, state->mesh_entity, none, WISP_COUNT( none ) ); // only frees memory
    }
}

// ---- settings ----

// A quarter of the mean length of edges or segments. A surface lies flat only with less than its shortest edge, unless
// that is a sliver of a fortieth of the mean.
static float default_thickness( wisp_rest_lengths lengths, bool is_surface )
{
    const float usual = lengths.mean > 0.0f ? 0.25f * lengths.mean : 1e-3f, least = 0.1f * usual;
    const float flat = is_surface && lengths.shortest > 0.0f ? 0.9f * lengths.shortest : usual;
    return flat >= usual ? usual : flat >= least ? flat : least;
}

// Fill in the defaults of a definition.
static contact_settings resolve( wisp_world* world, wisp_entity participant, const wisp_contact_def* d )
{
    const wisp_strand_topology* strands = wisp_world_strands( world, participant );
    const wisp_rest_lengths lengths = wisp_world_rest_lengths( world, participant );
    const float thickness = d->thickness > 0.0f ? d->thickness : default_thickness( lengths, strands == NULL );
    if ( strands == NULL && d->self && lengths.shortest > 0.0f && thickness > lengths.shortest )
    {
        wisp_world_warn( world,
                         "contact: entity %u: the thickness of %.3g m is above the shortest edge of %.3g m; around "
                         "shorter edges than it the surface keeps 0.9 of its distances at rest and bends stiffly",
                         participant.index, (double)thickness, (double)lengths.shortest );
    }
    return ( contact_settings ){
        .thickness = thickness,
        .friction = d->friction,
        .max_push_out_speed = d->max_push_out_speed > 0.0f ? d->max_push_out_speed : 10.0f * thickness,
        .layers = d->layers,
        .mask = d->mask,
        .self = strands == NULL      ? ( d->self ? 1 : 0 )
                : d->between_strands ? ( d->self ? 3 : 2 )
                                     : 0,
        .is_new = 1,
    };
}

// Return the largest distance that spheres keep so that no point slips between vertices, m.
static float sphere_spacing( wisp_world* world, wisp_entity participant )
{
    return wisp_world_strands( world, participant ) == NULL
               ? CONTACT_COVER * wisp_world_rest_lengths( world, participant ).longest
               : 0.0f;
}

static wisp_status check_participant( wisp_world* world, wisp_entity participant )
{
    if ( wisp_world_strands( world, participant ) == NULL )
    {
        return wisp_world_need_fabric( world, participant, WISP_FABRIC_EDGES );
    }
    return wisp_world_has( world, participant, WISP_STRAND_INVERSE_MASS ) &&
                   wisp_world_has( world, participant, WISP_STRAND_LENGTH )
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT,
                                  "contact: the strands of entity %u do not move: give them dynamics first",
                                  participant.index );
}

// ---- adding and removing ----

// Make sure that there is an entity whose passes work on the contact mesh.
static wisp_status add_mesh_entity( wisp_world* world, contact_state* state, bool strands )
{
    if ( wisp_is_alive( world, state->mesh_entity ) == false )
    {
        WISP_TRY( wisp_world_add_pairs( world, 0, &state->mesh_entity ) );
    }
    const wisp_component_use uses[] = {
        { state->active, true },
        { state->touches, strands || has_strands( state ) },
        { state->result, WISP_REQUESTED },
        { state->stats, state->requests_stats ? WISP_REQUESTED : 0 },
    };
    return wisp_world_set_components( world, state->mesh_entity, uses, WISP_COUNT( uses ) );
}

// Undo add_mesh_entity() after a failure, unless others take part.
static void remove_mesh_entity( wisp_world* world, contact_state* state )
{
    if ( has_strands( state ) == false && wisp_is_alive( world, state->mesh_entity ) )
    {
        wisp_world_detach( world, state->mesh_entity, state->touches );
    }
    if ( state->participant_count == 0 && wisp_is_alive( world, state->mesh_entity ) )
    {
        wisp_world_remove( world, state->mesh_entity );
    }
}

// Only attaching can fail.
static wisp_status mark_participant( wisp_world* world, const contact_state* state, wisp_entity participant,
                                     wisp_contact_level level )
{
    const wisp_component read = state->components.samples_read;
    if ( level != WISP_CONTACT_SPHERES || wisp_world_strands( world, participant ) != NULL )
    {
        return wisp_world_detach( world, participant, read );
    }
    return wisp_world_attach( world, participant, read );
}

wisp_status contact_mark_participants( wisp_world* world, const contact_state* state, wisp_contact_level level )
{
    wisp_status status = WISP_OK;
    int marked = 0;
    for ( ; marked < state->participant_count && status == WISP_OK; ++marked )
    {
        status = mark_participant( world, state, state->participants[marked].entity, level );
    }
    for ( int i = 0; i < marked && status != WISP_OK; ++i )
    {
        (void)mark_participant( world, state, state->participants[i].entity, state->world.level );
    }
    return status;
}

static wisp_status set_components( wisp_world* world, const contact_state* state, wisp_entity participant,
                                   bool is_used )
{
    const contact_components* c = &state->components;
    const bool is_strands = wisp_world_strands( world, participant ) != NULL;
    const int use = is_used ? WISP_USED | WISP_REQUESTED : 0;
    const wisp_component_use uses[] = {
        { is_strands ? c->strand_free : c->particle_free, use },
        { c->settings, is_used },
        { c->samples_read, is_used && is_strands == false && state->world.level == WISP_CONTACT_SPHERES },
        { is_strands ? WISP_STRAND_REACH : c->corrected, is_strands ? use : is_used },
    };
    return wisp_world_set_components( world, participant, uses, WISP_COUNT( uses ) );
}

static wisp_status add_participant( wisp_world* world, contact_state* state, wisp_entity participant )
{
    const bool strands = wisp_world_strands( world, participant ) != NULL;
    if ( wisp_world_reserve( world, (void**)&state->participants, &state->participant_capacity,
                             state->participant_count, sizeof( contact_participant ) ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for %d entities in contact",
                                state->participant_count + 1 );
    }
    WISP_TRY( set_components( world, state, participant, true ) );
    const wisp_status status = add_mesh_entity( world, state, strands );
    if ( status != WISP_OK )
    {
        (void)set_components( world, state, participant, false ); // only frees memory
        remove_mesh_entity( world, state );
        return status;
    }
    state->participants[state->participant_count++] =
        ( contact_participant ){ .entity = participant, .is_strands = strands };
    return WISP_OK;
}

static void remove_participant( wisp_world* world, contact_state* state, int number )
{
    const wisp_entity participant = state->participants[number].entity;
    contact_forget_participant( world, state, number );
    (void)set_components( world, state, participant, false ); // only frees memory
}

wisp_status wisp_set_contact( wisp_world* world, wisp_entity participant, const wisp_contact_def* given )
{
    wisp_contact_def values;
    const wisp_contact_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &participant, &wisp_contact_def_fields, &values, given ) );
    WISP_FIND_STATE( contact_state, state, world, "contact", &participant, WISP_IS_SURFACE | WISP_IS_STRANDS );
    WISP_TRY( check_participant( world, participant ) );
    int number = contact_find_participant( state, participant );
    if ( def->enabled == false )
    {
        if ( number >= 0 )
        {
            remove_participant( world, state, number );
        }
        return WISP_OK;
    }
    if ( def->self || def->mask != 0 ) // else its intersections are only counted
    {
        wisp_world_let_meet( world, participant );
    }
    WISP_TRY( number < 0 ? add_participant( world, state, participant ) : WISP_OK );
    contact_settings* settings = wisp_world_column( world, participant, state->components.settings, 0 );
    *settings = resolve( world, participant, def );
    number = number < 0 ? state->participant_count - 1 : number;
    state->participants[number].spacing = sphere_spacing( world, participant );
    state->changed = true;
    return WISP_OK;
}

wisp_status wisp_unset_contact( wisp_world* world, wisp_entity participant )
{
    WISP_FIND_STATE( contact_state, state, world, "contact", &participant, 0 );
    const int number = contact_find_participant( state, participant );
    if ( number >= 0 )
    {
        remove_participant( world, state, number );
    }
    return WISP_OK;
}
