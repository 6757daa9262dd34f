// Participants: which entities take part in contact, and how. In: wisp_contact_def. Out: components of the entity,
// its row in `guests`. All participants meet at one entity of their own, whose passes work on the contact mesh. It
// exists while there are any.
#include "contact_state.h"

#include <string.h>

static const uint32_t CONTACT_DEF_MADE = 0x434f4e54;

wisp_contact_def wisp_default_contact_def( void )
{
    return ( wisp_contact_def ){
        .friction = 0.3f,
        .self = true,
        .layers = 1,
        .mask = UINT32_MAX,
        .enabled = true,
        .made_by_default = CONTACT_DEF_MADE,
    };
}

int contact_find_guest( const contact_state* state, wisp_entity entity )
{
    for ( int i = 0; i < state->guest_count; ++i )
    {
        const wisp_entity e = state->guests[i].entity;
        if ( e.index == entity.index && e.generation == entity.generation )
        {
            return i;
        }
    }
    return -1;
}

static bool has_strands( const contact_state* state )
{
    for ( int i = 0; i < state->guest_count; ++i )
    {
        if ( state->guests[i].is_strands )
        {
            return true;
        }
    }
    return false;
}

void contact_forget_guest( wisp_world* world, contact_state* state, int number )
{
    state->guest_count -= 1;
    memmove( state->guests + number, state->guests + number + 1,
             (size_t)( state->guest_count - number ) * sizeof( contact_guest ) );
    state->changed = true;
    if ( has_strands( state ) == false )
    {
        wisp_world_detach( world, state->mesh_entity, state->touches );
    }
    if ( state->guest_count == 0 )
    {
        wisp_unwant( world, state->mesh_entity, state->result );
        wisp_unwant( world, state->mesh_entity, state->figures );
        wisp_world_detach( world, state->mesh_entity, state->active );
    }
}

// ---- settings ----

static float mean_edge( const wisp_fabric* fabric )
{
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        const wisp_vec3 a = fabric->rest[fabric->edges[2 * e]], b = fabric->rest[fabric->edges[2 * e + 1]];
        const double x = (double)( a.x - b.x ), y = (double)( a.y - b.y ), z = (double)( a.z - b.z );
        sum += sqrt( x * x + y * y + z * z );
    }
    return sum > 0.0 ? (float)( sum / fabric->edge_count ) : 0.0f;
}

static float mean_segment( const wisp_strand_topology* strands, const float* length )
{
    double sum = 0.0;
    int count = 0;
    for ( size_t i = 0; i < (size_t)strands->row_count * WISP_LANES; ++i )
    {
        sum += (double)length[i];
        count += length[i] > 0.0f ? 1 : 0;
    }
    return count > 0 ? (float)( sum / count ) : 0.0f;
}

// Fill in the defaults of a definition.
static contact_settings resolve( wisp_world* world, wisp_entity guest, const wisp_contact_def* d )
{
    const wisp_strand_topology* strands = wisp_world_strands( world, guest );
    const float edge = strands != NULL
                           ? mean_segment( strands, wisp_world_column( world, guest, WISP_STRAND_LENGTH, 0 ) )
                           : mean_edge( wisp_world_fabric( world, guest ) );
    const float thickness = d->thickness > 0.0f ? d->thickness : ( edge > 0.0f ? 0.25f * edge : 1e-3f );
    return ( contact_settings ){
        .thickness = thickness,
        .friction = d->friction,
        .recovery_speed = d->recovery_speed > 0.0f ? d->recovery_speed : 10.0f * thickness,
        .layers = d->layers,
        .mask = d->mask,
        .self = d->self && strands == NULL ? 1 : 0,
        .is_new = 1,
    };
}

static wisp_status check_guest( wisp_world* world, wisp_entity guest, const wisp_contact_def* d )
{
    wisp_status status = contact_check_range( world, "thickness", d->thickness, 0.0f, 1e6f );
    status = status == WISP_OK ? contact_check_range( world, "friction", d->friction, 0.0f, 1e6f ) : status;
    status =
        status == WISP_OK ? contact_check_range( world, "recovery_speed", d->recovery_speed, 0.0f, 1e6f ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( wisp_world_strands( world, guest ) == NULL )
    {
        void* state;
        status = wisp_world_surface_state( world, "contact", guest, &state );
        return status == WISP_OK && wisp_world_has( world, guest, WISP_PARTICLE_SOLVED )
                   ? wisp_world_fail(
                         world, WISP_CONFLICT,
                         "contact: another module solves for the velocities of entity %u, so it cannot be "
                         "pushed by other surfaces",
                         guest.index )
                   : status;
    }
    return wisp_world_has( world, guest, WISP_STRAND_WEIGHT ) && wisp_world_has( world, guest, WISP_STRAND_LENGTH )
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT,
                                  "contact: the strands of entity %u do not move: give them dynamics first",
                                  guest.index );
}

// ---- adding and removing ----

static bool make_room( wisp_world* world, contact_state* state )
{
    if ( state->guest_count < state->guest_capacity )
    {
        return true;
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const int more = state->guest_capacity > 0 ? 2 * state->guest_capacity : 8;
    contact_guest* grown = allocator->allocate( allocator->user, (size_t)more * sizeof( contact_guest ), 64 );
    if ( grown == NULL )
    {
        return false;
    }
    if ( state->guests != NULL )
    {
        memcpy( grown, state->guests, (size_t)state->guest_count * sizeof( contact_guest ) );
        allocator->release( allocator->user, state->guests, (size_t)state->guest_capacity * sizeof( contact_guest ) );
    }
    state->guests = grown;
    state->guest_capacity = more;
    return true;
}

// Make sure that there is an entity whose passes work on the contact mesh.
static wisp_status add_mesh_entity( wisp_world* world, contact_state* state, bool strands )
{
    wisp_status status = WISP_OK;
    if ( wisp_is_alive( world, state->mesh_entity ) == false )
    {
        status = wisp_world_add_plain( world, &state->mesh_entity );
    }
    status = status == WISP_OK ? wisp_world_attach( world, state->mesh_entity, state->active ) : status;
    status = status == WISP_OK && strands ? wisp_world_attach( world, state->mesh_entity, state->touches ) : status;
    status = status == WISP_OK ? wisp_want( world, state->mesh_entity, state->result ) : status;
    return status == WISP_OK && state->wants_figures ? wisp_want( world, state->mesh_entity, state->figures )
                                                     : status;
}

// Undo add_mesh_entity() after a failure, unless others take part.
static void remove_mesh_entity( wisp_world* world, contact_state* state )
{
    if ( has_strands( state ) == false && wisp_is_alive( world, state->mesh_entity ) )
    {
        wisp_world_detach( world, state->mesh_entity, state->touches );
    }
    if ( state->guest_count == 0 && wisp_is_alive( world, state->mesh_entity ) )
    {
        wisp_remove( world, state->mesh_entity );
    }
}

static wisp_status attach_components( wisp_world* world, contact_state* state, wisp_entity guest,
                                      wisp_component positions )
{
    wisp_status status = wisp_world_attach( world, guest, positions );
    status = status == WISP_OK ? wisp_world_attach( world, guest, state->components.settings ) : status;
    return status == WISP_OK ? wisp_want( world, guest, positions ) : status;
}

static wisp_status add_guest( wisp_world* world, contact_state* state, wisp_entity guest )
{
    const bool strands = wisp_world_strands( world, guest ) != NULL;
    const wisp_component positions = strands ? state->components.strand_free : state->components.particle_free;
    if ( make_room( world, state ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "no memory for %d entities in contact",
                                state->guest_count + 1 );
    }
    wisp_status status = attach_components( world, state, guest, positions );
    status = status == WISP_OK ? add_mesh_entity( world, state, strands ) : status;
    if ( status != WISP_OK )
    {
        wisp_unwant( world, guest, positions );
        wisp_world_detach( world, guest, positions );
        wisp_world_detach( world, guest, state->components.settings );
        remove_mesh_entity( world, state );
        return status;
    }
    state->guests[state->guest_count++] = ( contact_guest ){ .entity = guest, .is_strands = strands };
    return WISP_OK;
}

static void remove_guest( wisp_world* world, contact_state* state, int number )
{
    const contact_guest guest = state->guests[number];
    const wisp_component positions =
        guest.is_strands ? state->components.strand_free : state->components.particle_free;
    contact_forget_guest( world, state, number );
    wisp_unwant( world, guest.entity, positions );
    wisp_world_detach( world, guest.entity, state->components.settings );
    wisp_world_detach( world, guest.entity, positions );
}

wisp_status wisp_set_contact( wisp_world* world, wisp_entity guest, const wisp_contact_def* def )
{
    WISP_ASSERT( def->made_by_default == CONTACT_DEF_MADE );
    contact_state* state;
    wisp_status status = contact_find_state( world, &state );
    status = status == WISP_OK ? check_guest( world, guest, def ) : status;
    const int number = status == WISP_OK ? contact_find_guest( state, guest ) : -1;
    if ( status == WISP_OK && def->enabled == false )
    {
        if ( number >= 0 )
        {
            remove_guest( world, state, number );
        }
        return WISP_OK;
    }
    status = status == WISP_OK && number < 0 ? add_guest( world, state, guest ) : status;
    if ( status == WISP_OK )
    {
        contact_settings* settings = wisp_world_column( world, guest, state->components.settings, 0 );
        *settings = resolve( world, guest, def );
        state->changed = true;
    }
    return status;
}

wisp_status wisp_unset_contact( wisp_world* world, wisp_entity guest )
{
    contact_state* state;
    const wisp_status status = contact_find_state( world, &state );
    const int number = status == WISP_OK ? contact_find_guest( state, guest ) : -1;
    if ( number >= 0 )
    {
        remove_guest( world, state, number );
    }
    return status;
}
