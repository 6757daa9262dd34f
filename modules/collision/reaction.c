// Reactions of bodies. In: sums of the parts of all participants (reaction.h). Out: wisp_reaction of each body that is asked for it.
// While none is, there are no sums, no columns and no pass.
#include "reaction.h"

#include "collision_state.h"
#include "particle_contacts.h"
#include "primitive_contacts.h"

#include <string.h>

collision_impulse* collision_reaction_sums( wisp_frame* frame, wisp_entity participant, const collision_state* state,
                                            int part )
{
    const int32_t* first =
        state->sums != NULL ? wisp_frame_column( frame, participant, state->reaction_part, 0 ) : NULL;
    return first != NULL ? state->sums + (size_t)( *first + part ) * (size_t)state->body_count : NULL;
}

// ---- memory ----

void collision_note_reactions( wisp_world* world, collision_state* state )
{
    state->wants_reactions = state->coupled_count > 0;
    for ( int i = 0; i < state->body_count && state->wants_reactions == false; ++i )
    {
        state->wants_reactions = wisp_world_has( world, state->bodies[i].entity, state->reaction );
    }
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
    wisp_release( allocator, state->sums, state->sum_capacity * sizeof( *state->sums ) );
    state->sums = NULL;
    state->sum_capacity = state->sum_count = 0;
}

static wisp_status update_participant( wisp_world* world, collision_state* state, wisp_entity participant,
                                       bool requested, int first )
{
    const bool counts = requested && ( wisp_world_has( world, participant, state->active ) ||
                                       wisp_world_has( world, participant, state->strand_contact ) );
    const wisp_component_use uses[] = {
        { state->reaction_part, counts },
        { state->contact_body, counts && wisp_world_has( world, participant, WISP_PARTICLE_HALF_SPACES ) },
    };
    WISP_TRY( wisp_world_set_components( world, participant, uses, WISP_COUNT( uses ) ) );
    WISP_FILL( world, participant, state->reaction_part, int32_t, first );
    return WISP_OK;
}

wisp_status collision_update_reactions( wisp_world* world, collision_state* state )
{
    const bool requested = state->wants_reactions;
    if ( requested == false && state->sums == NULL )
    {
        return WISP_OK;
    }
    wisp_status status = WISP_OK;
    int parts = 0;
    for ( wisp_entity e = { 0, 0 }; status == WISP_OK && collision_next_participant( state, &e ); )
    {
        status = update_participant( world, state, e, requested, parts );
        parts += count_parts( world, e );
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

static size_t place_of_body( const collision_state* state, wisp_entity entity )
{
    size_t body = 0;
    while ( wisp_entity_equal( state->bodies[body].entity, entity ) == false )
    {
        body += 1;
    }
    return body;
}

// Add what some participants gave to a body, surfaces or strands, and empty their sums.
static void add_participants( wisp_frame* frame, const collision_state* state, size_t body, bool surfaces,
                              bool strands, double* total )
{
    for ( wisp_entity participant = { 0, 0 }; collision_next_participant( state, &participant ); )
    {
        const wisp_strand_topology* topology = wisp_frame_strands( frame, participant );
        if ( topology != NULL ? strands : surfaces )
        {
            const int parts =
                topology != NULL
                    ? topology->group_count
                    : ( wisp_frame_fabric( frame, participant )->slot_count + COLLISION_BLOCK - 1 ) / COLLISION_BLOCK;
            add_parts( frame, state, participant, body, parts, total );
        }
    }
}

// Move the torque of an impulse from the origin of the world to a point.
static void move_torque( double* total, wisp_vec3 to )
{
    const double x = (double)to.x, y = (double)to.y, z = (double)to.z;
    total[3] -= y * total[2] - z * total[1];
    total[4] -= z * total[0] - x * total[2];
    total[5] -= x * total[1] - y * total[0];
}

void collision_read_reactions( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    double total[6] = { 0.0 };
    collision_coupled* coupled = wisp_frame_column( frame, span->entity, state->coupled, 0 );
    collision_collider* collider = wisp_frame_column( frame, span->entity, state->collider, 0 );
    add_participants( frame, state, place_of_body( state, span->entity ), coupled == NULL, true, total );
    if ( coupled != NULL )
    {
        collider->to = collision_coupled_pose( collider, coupled, 1.0f, 0.0f );
        *(wisp_transform*)wisp_frame_column( frame, span->entity, state->motion, 0 ) = collider->to;
    }
    move_torque( total, collider->to.translation );
    for ( int k = 0; k < 6 && coupled != NULL; ++k )
    {
        total[k] += coupled->impulse[k];
    }
    wisp_reaction* out = wisp_frame_column( frame, span->entity, state->reaction, 0 );
    *out = ( wisp_reaction ){
        { (float)total[0], (float)total[1], (float)total[2] },
        { (float)total[3], (float)total[4], (float)total[5] },
        collider->to,
    };
}

// ---- bodies with a mass ----

// The first order of the exponential of half the rotation; it is given unit length.
static wisp_quat turn_with( wisp_quat q, wisp_vec3 spin, float seconds )
{
    const float half = 0.5f * seconds;
    return wisp_quat_multiply( ( wisp_quat ){ half * spin.x, half * spin.y, half * spin.z, 1.0f }, q );
}

wisp_transform collision_coupled_pose( const collision_collider* collider, const collision_coupled* coupled,
                                       float progress, float seconds )
{
    const wisp_transform host = wisp_transform_interpolate( collider->from, collider->to, progress );
    const wisp_vec3 moved = wisp_v3_mul_add( coupled->shift, seconds, coupled->velocity );
    const wisp_quat turn = turn_with( coupled->turn, coupled->spin, seconds );
    return wisp_transform_make( wisp_quat_multiply( turn, host.rotation ),
                                wisp_v3_mul_add( host.translation, 1.0f, moved ) );
}

static wisp_vec3 turned_by_torque( const collision_coupled* coupled, wisp_quat pose, wisp_vec3 torque )
{
    const wisp_vec3 t = wisp_quat_inverse_rotate( pose, torque ), inverse = coupled->inverse_inertia;
    return wisp_quat_rotate( pose, ( wisp_vec3 ){ t.x * inverse.x, t.y * inverse.y, t.z * inverse.z } );
}

void collision_couple( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    collision_coupled* c = wisp_frame_column( frame, span->entity, state->coupled, 0 );
    const collision_collider* collider = wisp_frame_column( frame, span->entity, state->collider, 0 );
    const float dt = wisp_frame_dt( frame, span->entity );
    const float progress = wisp_frame_progress( frame, span->entity, span->substep + 1 );
    const wisp_transform met = collision_coupled_pose( collider, c, progress, dt );
    double got[6] = { 0.0 };
    add_participants( frame, state, place_of_body( state, span->entity ), true, false, got );
    move_torque( got, met.translation );
    for ( int k = 0; k < 6; ++k )
    {
        c->impulse[k] += got[k];
    }
    const wisp_vec3 impulse = { (float)got[0], (float)got[1], (float)got[2] },
                    torque = { (float)got[3], (float)got[4], (float)got[5] };
    c->velocity = wisp_v3_mul_add( c->velocity, c->inverse_mass, impulse );
    c->spin = wisp_v3_mul_add( c->spin, 1.0f, turned_by_torque( c, met.rotation, torque ) );
    // with the velocity after the impulse
    c->shift = wisp_v3_mul_add( c->shift, dt, c->velocity );
    c->turn = wisp_transform_make( turn_with( c->turn, c->spin, dt ), c->shift ).rotation;
    c->before = collision_coupled_pose( collider, c, progress, 0.0f );
    c->done = span->substep + 1;
}

// Does a contact count as one that the body may meet in the substep?
static bool is_close( const collision_contact* c, wisp_vec3 p )
{
    return wisp_v3_dot( wisp_v3_load( c->normal ), wisp_v3_sub( p, wisp_v3_load( c->point ) ) ) < 2.0f * c->gap;
}

static double vertices_near( wisp_frame* frame, const collision_state* state, wisp_entity e, int32_t body )
{
    const float* position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 );
    const int32_t* count = wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 0 );
    collision_contact( *contact )[WISP_COLLISION_CONTACTS] =
        wisp_frame_column( frame, e, WISP_PARTICLE_HALF_SPACES, 2 );
    int32_t( *of )[WISP_COLLISION_CONTACTS] = wisp_frame_column( frame, e, state->contact_body, 0 );
    const int slots = of != NULL ? wisp_frame_fabric( frame, e )->slot_count : 0;
    double mass = 0.0;
    for ( int slot = 0; slot < slots; ++slot )
    {
        for ( int i = 0; i < count[slot] && i < WISP_COLLISION_CONTACTS; ++i )
        {
            const float* p = position + (size_t)slot * 4;
            const bool counts =
                of[slot][i] == body && p[3] > 0.0f && is_close( contact[slot] + i, wisp_v3_load( p ) );
            mass += counts ? 1.0 / (double)p[3] : 0.0;
        }
    }
    return mass;
}

// A vertex has three edges and two triangles in the mean.
static double primitives_near( wisp_frame* frame, const collision_state* state, wisp_entity e, int32_t body )
{
    const float* position = wisp_frame_column( frame, e, WISP_PARTICLE_POSITION, 0 );
    double mass = 0.0;
    for ( int corner_count = 2; corner_count <= 3; ++corner_count )
    {
        const collision_primitives p = collision_primitives_of( frame, e, state, corner_count );
        for ( int a = 0; p.found != NULL && a < *p.active_count; ++a )
        {
            const int primitive = p.active[a];
            for ( int i = 0; i < collision_contacts_of( &p, primitive ); ++i )
            {
                const collision_primitive_contact* c = p.contacts[primitive] + i;
                for ( int k = 0; k < corner_count && c->body == body; ++k )
                {
                    const float w = position[(size_t)p.corners[primitive * corner_count + k] * 4 + 3];
                    mass += w > 0.0f ? (double)c->weights[k] / ( 3.0 * (double)w ) : 0.0;
                }
            }
        }
    }
    return mass;
}

void collision_share_contacts( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const int32_t body = (int32_t)place_of_body( state, span->entity );
    double mass = 0.0;
    for ( wisp_entity e = { 0, 0 }; collision_next_participant( state, &e ); )
    {
        if ( wisp_frame_strands( frame, e ) == NULL )
        {
            mass += vertices_near( frame, state, e, body ) + primitives_near( frame, state, e, body );
        }
    }
    ( (collision_coupled*)wisp_frame_column( frame, span->entity, state->coupled, 0 ) )->load = (float)mass;
    for ( wisp_entity e = { 0, 0 }; collision_next_participant( state, &e ); )
    {
        if ( wisp_frame_strands( frame, e ) == NULL )
        {
            collision_unload( frame, state, e, body );
        }
    }
}

collision_share collision_share_of( wisp_frame* frame, const collision_state* state, int body, wisp_entity of,
                                    wisp_vec3 at, wisp_vec3 normal )
{
    if ( state->bodies[body].is_coupled == false )
    {
        return ( collision_share ){ 1.0f, 1.0f };
    }
    const collision_coupled* c = wisp_frame_column( frame, state->bodies[body].entity, state->coupled, 0 );
    const wisp_vec3 by = wisp_frame_between( frame, state->bodies[body].entity, of ),
                    r = wisp_v3_sub( at, wisp_to_rows( c->before.translation, by ) );
    const wisp_vec3 arm = { r.y * normal.z - r.z * normal.y, r.z * normal.x - r.x * normal.z,
                            r.x * normal.y - r.y * normal.x };
    const float turns = wisp_v3_dot( arm, turned_by_torque( c, c->before.rotation, arm ) );
    return ( collision_share ){ 1.0f / ( 1.0f + c->load * ( c->inverse_mass + turns ) ),
                                1.0f /
                                    ( 1.0f + c->load * ( c->inverse_mass + c->most_turns * wisp_v3_dot( r, r ) ) ) };
}

// ---- requests ----

static wisp_status find_collider( wisp_world* world, wisp_entity collider, collision_state** state )
{
    WISP_FIND_STATE( collision_state, found, world, "collision", &collider, 0 );
    *state = found;
    return wisp_world_has( world, collider, found->collider )
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "entity %u is not a collider", collider.index );
}

static wisp_status give_up( wisp_world* world, collision_state* state, wisp_entity collider )
{
    if ( wisp_world_has( world, collider, state->coupled ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "collision: entity %u has a mass, which needs its reaction",
                                collider.index );
    }
    WISP_TRY( wisp_world_detach( world, collider, state->reaction ) );
    collision_note_reactions( world, state );
    return collision_update_reactions( world, state );
}

wisp_status wisp_request_reaction( wisp_world* world, wisp_entity collider, bool requested )
{
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
    const wisp_component_use use = { state->reaction, WISP_USED | WISP_REQUESTED };
    WISP_TRY( wisp_world_set_components( world, collider, &use, 1 ) );
    collision_note_reactions( world, state );
    const wisp_status status = collision_update_reactions( world, state );
    if ( status != WISP_OK )
    {
        give_up( world, state, collider );
    }
    return status;
}

wisp_status wisp_read_reaction( wisp_world* world, wisp_entity collider, wisp_reaction* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
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
