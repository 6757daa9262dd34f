// Reactions of bodies. In: sums of the parts of all participants (reaction.h). Out: wisp_reaction of each body that is asked for it.
// While none is, there are no sums, no columns and no pass.
#include "reaction.h"

#include "collision_passes.h"
#include "particle_contacts.h"

#include <string.h>

collision_impulse* collision_reaction_sums( wisp_frame* frame, wisp_entity participant, const collision_state* state,
                                            int part )
{
    const int32_t* first =
        state->sums != NULL ? wisp_frame_column( frame, participant, state->reaction_part, 0 ) : NULL;
    return first != NULL ? state->sums + (size_t)( *first + part ) * (size_t)state->body_count : NULL;
}

// ---- memory ----

static bool is_requested( wisp_world* world, const collision_state* state )
{
    for ( int i = 0; i < state->body_count; ++i )
    {
        if ( wisp_world_has( world, state->bodies[i].entity, state->reaction ) )
        {
            return true;
        }
    }
    return false;
}

static int count_parts( wisp_world* world, wisp_entity participant )
{
    const wisp_strand_topology* strands = wisp_world_strands( world, participant );
    return strands != NULL
               ? strands->group_count
               : ( wisp_world_fabric( world, participant )->slot_count + COLLISION_BLOCK - 1 ) / COLLISION_BLOCK;
}

// Sums that become fewer fit where they were, so removing a body or a participant cannot fail.
static wisp_status reserve( wisp_world* world, collision_state* state, size_t count )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    if ( count > state->sum_capacity )
    {
        collision_impulse* sums = allocator->allocate( allocator->user, count * sizeof( *sums ), 64 );
        if ( sums == NULL )
        {
            return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for the reactions of %d colliders",
                                    state->body_count );
        }
        collision_release_reactions( allocator, state );
        state->sums = sums;
        state->sum_capacity = count;
    }
    state->sum_count = count;
    if ( count > 0 )
    {
        memset( state->sums, 0, count * sizeof( *state->sums ) );
    }
    return WISP_OK;
}

void collision_release_reactions( const wisp_allocator* allocator, collision_state* state )
{
    if ( state->sums != NULL )
    {
        allocator->release( allocator->user, state->sums, state->sum_capacity * sizeof( *state->sums ) );
    }
    state->sums = NULL;
    state->sum_capacity = state->sum_count = 0;
}

static wisp_status update_participant( wisp_world* world, collision_state* state, wisp_entity participant,
                                       bool requested, int first )
{
    const bool counts = requested && ( wisp_world_has( world, participant, state->active ) ||
                                       wisp_world_has( world, participant, state->strand_contact ) );
    wisp_status status = counts ? wisp_world_attach( world, participant, state->reaction_part )
                                : wisp_world_detach( world, participant, state->reaction_part );
    const bool has_bodies = counts && wisp_world_has( world, participant, WISP_PARTICLE_HALF_SPACES );
    if ( status == WISP_OK )
    {
        status = has_bodies ? wisp_world_attach( world, participant, state->contact_body )
                            : wisp_world_detach( world, participant, state->contact_body );
    }
    if ( status == WISP_OK && counts )
    {
        *(int32_t*)wisp_world_column( world, participant, state->reaction_part, 0 ) = first;
    }
    return status;
}

wisp_status collision_update_reactions( wisp_world* world, collision_state* state )
{
    const bool requested = is_requested( world, state );
    if ( requested == false && state->sums == NULL )
    {
        return WISP_OK;
    }
    wisp_status status = WISP_OK;
    int parts = 0;
    for ( int i = 0; i < state->participant_count && status == WISP_OK; ++i )
    {
        status = update_participant( world, state, state->participants[i], requested, parts );
        parts += count_parts( world, state->participants[i] );
    }
    status =
        status == WISP_OK && requested ? reserve( world, state, (size_t)parts * (size_t)state->body_count ) : status;
    if ( requested == false )
    {
        collision_release_reactions( wisp_world_allocator( world ), state );
    }
    return status;
}

// ---- passes ----

// @return the place of a body in the list; the number of bodies if it is gone
static int find_named_body( const collision_state* state, int32_t name )
{
    int body = 0;
    while ( body < state->body_count && collision_body_name( state->bodies[body].entity ) != name )
    {
        body += 1;
    }
    return body;
}

void collision_gather_impulses( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const wisp_entity e = span->entity;
    int32_t( *name )[WISP_MAX_PARTICLE_CONTACTS] = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACT_IMPULSES, 0 );
    const wisp_vec3( *impulse )[WISP_MAX_PARTICLE_CONTACTS] =
        wisp_frame_column( frame, e, WISP_PARTICLE_CONTACT_IMPULSES, 1 );
    const wisp_vec3* point = wisp_frame_column( frame, e, WISP_PARTICLE_CONTACT_IMPULSES, 2 );
    const wisp_span s = wisp_frame_particles( frame, span );
    for ( int slot = s.begin; slot < s.end; ++slot )
    {
        collision_impulse* sums = collision_reaction_sums( frame, e, state, slot / COLLISION_BLOCK );
        for ( int i = 0; i < WISP_MAX_PARTICLE_CONTACTS && sums != NULL; ++i )
        {
            const int body = name[slot][i] != 0 ? find_named_body( state, name[slot][i] ) : state->body_count;
            if ( body < state->body_count )
            {
                const wisp_vec3 none = { 0.0f, 0.0f, 0.0f };
                collision_add_impulse( sums[body], 1.0, impulse[slot][i], none, point[slot] );
            }
            name[slot][i] = 0;
        }
    }
}

static void add_parts( wisp_frame* frame, const collision_state* state, wisp_entity participant, size_t body,
                       int parts, double* total )
{
    collision_impulse* sums = collision_reaction_sums( frame, participant, state, 0 );
    const bool counts = sums != NULL && wisp_frame_is_halted( frame, participant ) == false;
    const double before[3] = { total[0], total[1], total[2] };
    for ( int part = 0; part < parts && sums != NULL; ++part )
    {
        double* sum = sums[(size_t)part * (size_t)state->body_count + body];
        for ( int k = 0; k < 6; ++k )
        {
            total[k] += counts ? sum[k] : 0.0;
            sum[k] = 0.0;
        }
    }
    const wisp_vec3 by = wisp_frame_between( frame, participant, state->bodies[body].entity );
    const double arm[3] = { (double)by.x, (double)by.y, (double)by.z };
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        total[3 + k] += arm[a] * ( total[b] - before[b] ) - arm[b] * ( total[a] - before[a] );
    }
}

void collision_read_reactions( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    size_t body = 0;
    while ( wisp_entity_equal( state->bodies[body].entity, span->entity ) == false )
    {
        body += 1;
    }
    double total[6] = { 0.0 };
    for ( int i = 0; i < state->participant_count; ++i )
    {
        const wisp_entity participant = state->participants[i];
        const wisp_strand_topology* strands = wisp_frame_strands( frame, participant );
        const int parts =
            strands != NULL
                ? strands->group_count
                : ( wisp_frame_fabric( frame, participant )->slot_count + COLLISION_BLOCK - 1 ) / COLLISION_BLOCK;
        add_parts( frame, state, participant, body, parts, total );
    }
    const collision_collider* collider = wisp_frame_column( frame, span->entity, state->collider, 0 );
    const wisp_vec3 o = collider->to.translation;
    const double ox = (double)o.x, oy = (double)o.y, oz = (double)o.z;
    wisp_reaction* out = wisp_frame_column( frame, span->entity, state->reaction, 0 );
    *out = ( wisp_reaction ){
        { (float)total[0], (float)total[1], (float)total[2] },
        { (float)( total[3] - ( oy * total[2] - oz * total[1] ) ),
          (float)( total[4] - ( oz * total[0] - ox * total[2] ) ),
          (float)( total[5] - ( ox * total[1] - oy * total[0] ) ) },
    };
}

// ---- requests ----

static wisp_status find_collider( wisp_world* world, wisp_entity collider, collision_state** state )
{
    WISP_TRY( wisp_world_check_entity( world, collider ) );
    WISP_TRY( collision_find_state( world, state ) );
    return wisp_world_has( world, collider, ( *state )->collider )
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "entity %u is not a collider", collider.index );
}

static wisp_status give_up( wisp_world* world, collision_state* state, wisp_entity collider )
{
    WISP_TRY( wisp_world_cancel_request( world, collider, state->reaction ) );
    WISP_TRY( wisp_world_detach( world, collider, state->reaction ) );
    return collision_update_reactions( world, state );
}

wisp_status wisp_request_reaction( wisp_world* world, wisp_entity collider, bool requested )
{
    WISP_TRY( wisp_world_begin( world ) );
    collision_state* state;
    WISP_TRY( find_collider( world, collider, &state ) );
    if ( requested == false )
    {
        return give_up( world, state, collider );
    }
    if ( wisp_world_has( world, collider, state->reaction ) )
    {
        return WISP_OK;
    }
    wisp_status status = wisp_world_attach( world, collider, state->reaction );
    status = status == WISP_OK ? wisp_world_request( world, collider, state->reaction ) : status;
    status = status == WISP_OK ? collision_update_reactions( world, state ) : status;
    if ( status != WISP_OK )
    {
        give_up( world, state, collider );
    }
    return status;
}

wisp_status wisp_read_reaction( wisp_world* world, wisp_entity collider, wisp_reaction* out )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    *out = ( wisp_reaction ){ 0 };
    collision_state* state;
    WISP_TRY( find_collider( world, collider, &state ) );
    const wisp_reaction* reaction = wisp_world_column( world, collider, state->reaction, 0 );
    if ( reaction == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "collision: the reaction of entity %u was not requested with wisp_request_reaction",
                                collider.index );
    }
    *out = *reaction;
    return WISP_OK;
}
