#include "contact_internal.h"

#include <string.h>

static const uint32_t CONTACT_DEF_MADE = 0x434f4e54, CONTACT_SETTINGS_MADE = 0x434f4e53;

static const wisp_column_def SETTINGS_COLUMNS[] = { { "settings", sizeof( contact_settings ) } };
static const wisp_column_def PARTICLE_COLUMNS[] = { { "safe", 4 * sizeof( float ) } };
static const wisp_column_def STRAND_COLUMNS[] = { { "safe", 3 * WISP_LANES * sizeof( float ) } };
static const wisp_column_def MEMORY_COLUMNS[] = { { "memory", sizeof( contact_memory ) } };
static const wisp_column_def MARK_COLUMNS[] = { { "mark", sizeof( int32_t ) } };
static const wisp_column_def FIGURES_COLUMNS[] = { { "figures", sizeof( wisp_contact_figures ) } };

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

wisp_contact_settings wisp_default_contact_settings( void )
{
    return ( wisp_contact_settings ){ .margin = 1.0f, .guard = true, .made_by_default = CONTACT_SETTINGS_MADE };
}

// ---- what is declared ----

static void release_state( void* memory, const wisp_allocator* allocator )
{
    contact_state* state = memory;
    contact_release_soup( &state->soup, allocator );
    if ( state->guests != NULL )
    {
        allocator->release( allocator->user, state->guests, (size_t)state->guest_capacity * sizeof( contact_guest ) );
    }
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

// Only takes away, so it cannot fail.
static void forget_guest( wisp_world* world, contact_state* state, int number )
{
    state->guest_count -= 1;
    memmove( state->guests + number, state->guests + number + 1,
             (size_t)( state->guest_count - number ) * sizeof( contact_guest ) );
    state->changed = true;
    if ( has_strands( state ) == false )
    {
        wisp_world_detach( world, state->meeting, state->touches );
    }
    if ( state->guest_count == 0 )
    {
        wisp_unwant( world, state->meeting, state->result );
        wisp_unwant( world, state->meeting, state->figures );
        wisp_world_detach( world, state->meeting, state->active );
    }
}

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    contact_state* state = memory;
    const int number = contact_find_guest( state, entity );
    if ( number >= 0 )
    {
        forget_guest( world, state, number );
    }
}

static wisp_status declare_components( wisp_registry* r, contact_state* s )
{
    const struct
    {
        wisp_component* out;
        wisp_component_def def;
    } all[] = {
        { &s->settings, { "contact.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS, 1 } },
        { &s->particle_safe, { "contact.particles", WISP_TABLE_PARTICLE, PARTICLE_COLUMNS, 1 } },
        { &s->strand_safe, { "contact.strands", WISP_TABLE_STRAND_ROW, STRAND_COLUMNS, 1 } },
        { &s->active, { "contact.active", WISP_TABLE_ENTITY, MEMORY_COLUMNS, 1 } },
        { &s->touches, { "contact.touches_strands", WISP_TABLE_ENTITY, MARK_COLUMNS, 1 } },
        { &s->pairs, { "contact.pairs", WISP_TABLE_ENTITY, MARK_COLUMNS, 1 } },
        { &s->result, { "contact.result", WISP_TABLE_ENTITY, MARK_COLUMNS, 1 } },
        { &s->figures, { "contact.figures", WISP_TABLE_ENTITY, FIGURES_COLUMNS, 1 } },
    };
    for ( int i = 0; i < WISP_COUNT( all ); ++i )
    {
        *all[i].out = wisp_declare_component( r, &all[i].def );
    }
    return s->figures != 0 ? WISP_OK : WISP_BAD_INPUT;
}

// Passes come twice: where strands take part they wait for those of strands too, which then leave the loop over their
// own groups.
static wisp_status declare_passes( wisp_registry* r, contact_state* s, bool strands )
{
    const wisp_component beside = strands ? WISP_STRAND_POSITION : 0, before = strands ? WISP_STRAND_PREVIOUS : 0;
    const wisp_pass passes[] = {
        {
            .name = strands ? "contact.find_strands" : "contact.find",
            .stage = WISP_STAGE_CONTACT,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { s->active, strands ? s->touches : 0 },
            .lacks = { strands ? 0 : s->touches },
            .reads = { s->active },
            .writes = { s->pairs },
            .across = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, beside, before },
            .run = contact_find,
            .user = s,
        },
        {
            .name = strands ? "contact.push_strands" : "contact.push",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { s->active, strands ? s->touches : 0 },
            .lacks = { strands ? 0 : s->touches },
            .reads = { s->active, s->pairs },
            .writes = { s->result },
            .across = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, beside, before },
            .run = contact_project,
            .user = s,
        },
        {
            .name = strands ? "contact.keep_strands" : "contact.keep",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { s->settings, strands ? WISP_STRAND_WEIGHT : WISP_PARTICLE_MASS },
            .reads = { s->settings, strands ? WISP_STRAND_POSITION : WISP_PARTICLE_POSITION,
                       strands ? WISP_STRAND_PREVIOUS : WISP_PARTICLE_PREVIOUS },
            .writes = { strands ? s->strand_safe : s->particle_safe },
            .run = contact_keep,
            .user = s,
        },
        {
            .name = strands ? "contact.strand_figures" : "contact.figures",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { s->active, strands ? s->touches : 0 },
            .lacks = { strands ? 0 : s->touches },
            .reads = { s->active },
            .writes = { s->figures },
            .across = { WISP_PARTICLE_POSITION, beside },
            .run = contact_measure,
            .user = s,
        },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( passes ) && status == WISP_OK; ++i )
    {
        status = wisp_declare_pass( r, passes + i );
    }
    return status;
}

static wisp_status declare( wisp_registry* r )
{
    contact_state* state = wisp_declare_state( r, sizeof( contact_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->world = wisp_default_contact_settings();
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .release = release_state, .removed = entity_removed } );
    wisp_status status = declare_components( r, state );
    status = status == WISP_OK ? declare_passes( r, state, false ) : status;
    return status == WISP_OK ? declare_passes( r, state, true ) : status;
}

const wisp_module wisp_contact_module = { .name = "contact", .declare = declare };

// ---- settings of the world ----

static wisp_status find_state( wisp_world* world, contact_state** out )
{
    *out = wisp_world_module_state( world, "contact" );
    return *out != NULL
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "the module contact is not registered in this world" );
}

static wisp_status check_range( wisp_world* world, const char* name, float value, float low, float high )
{
    return value >= low && value <= high
               ? WISP_OK
               : wisp_world_fail( world, WISP_BAD_INPUT, "contact: %s is %g, it must be %g to %g", name,
                                  (double)value, (double)low, (double)high );
}

wisp_status wisp_set_contact_settings( wisp_world* world, const wisp_contact_settings* settings )
{
    WISP_ASSERT( settings->made_by_default == CONTACT_SETTINGS_MADE );
    contact_state* state;
    wisp_status status = find_state( world, &state );
    status = status == WISP_OK ? check_range( world, "margin", settings->margin, 0.01f, 100.0f ) : status;
    status =
        status == WISP_OK ? check_range( world, "sample_spacing", settings->sample_spacing, 0.0f, 1e6f ) : status;
    if ( status == WISP_OK && ( (unsigned)settings->features >= WISP_CONTACT_FEATURES_COUNT ||
                                (unsigned)settings->search >= WISP_PAIR_SEARCH_COUNT ) )
    {
        status = wisp_world_fail( world, WISP_BAD_INPUT, "contact: features %d or search %d is none that there is",
                                  (int)settings->features, (int)settings->search );
    }
    if ( status == WISP_OK )
    {
        state->world = *settings;
        state->changed = true;
    }
    return status;
}

// ---- guests ----

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
    wisp_status status = check_range( world, "thickness", d->thickness, 0.0f, 1e6f );
    status = status == WISP_OK ? check_range( world, "friction", d->friction, 0.0f, 1e6f ) : status;
    status = status == WISP_OK ? check_range( world, "recovery_speed", d->recovery_speed, 0.0f, 1e6f ) : status;
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

// The place where guests meet is an entity of its own, made with the first of them.
static wisp_status open_meeting( wisp_world* world, contact_state* state, bool strands )
{
    wisp_status status = WISP_OK;
    if ( wisp_is_alive( world, state->meeting ) == false )
    {
        status = wisp_world_add_plain( world, &state->meeting );
    }
    status = status == WISP_OK ? wisp_world_attach( world, state->meeting, state->active ) : status;
    status = status == WISP_OK && strands ? wisp_world_attach( world, state->meeting, state->touches ) : status;
    status = status == WISP_OK ? wisp_want( world, state->meeting, state->result ) : status;
    return status == WISP_OK && state->wants_figures ? wisp_want( world, state->meeting, state->figures ) : status;
}

// Where the first guest could not come in nobody meets; a meeting of others goes on as it was.
static void close_meeting( wisp_world* world, contact_state* state )
{
    if ( has_strands( state ) == false && wisp_is_alive( world, state->meeting ) )
    {
        wisp_world_detach( world, state->meeting, state->touches );
    }
    if ( state->guest_count == 0 && wisp_is_alive( world, state->meeting ) )
    {
        wisp_remove( world, state->meeting );
    }
}

static wisp_status dress_guest( wisp_world* world, contact_state* state, wisp_entity guest, wisp_component safe )
{
    wisp_status status = wisp_world_attach( world, guest, safe );
    status = status == WISP_OK ? wisp_world_attach( world, guest, state->settings ) : status;
    return status == WISP_OK ? wisp_want( world, guest, safe ) : status;
}

static wisp_status enter_guest( wisp_world* world, contact_state* state, wisp_entity guest )
{
    const bool strands = wisp_world_strands( world, guest ) != NULL;
    const wisp_component safe = strands ? state->strand_safe : state->particle_safe;
    if ( make_room( world, state ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "no memory for %d entities in contact",
                                state->guest_count + 1 );
    }
    wisp_status status = dress_guest( world, state, guest, safe );
    status = status == WISP_OK ? open_meeting( world, state, strands ) : status;
    if ( status != WISP_OK )
    {
        wisp_unwant( world, guest, safe );
        wisp_world_detach( world, guest, safe );
        wisp_world_detach( world, guest, state->settings );
        close_meeting( world, state );
        return status;
    }
    state->guests[state->guest_count++] = ( contact_guest ){ .entity = guest, .is_strands = strands };
    return WISP_OK;
}

static void leave_guest( wisp_world* world, contact_state* state, int number )
{
    const contact_guest guest = state->guests[number];
    const wisp_component safe = guest.is_strands ? state->strand_safe : state->particle_safe;
    forget_guest( world, state, number );
    wisp_unwant( world, guest.entity, safe );
    wisp_world_detach( world, guest.entity, state->settings );
    wisp_world_detach( world, guest.entity, safe );
}

wisp_status wisp_set_contact( wisp_world* world, wisp_entity guest, const wisp_contact_def* def )
{
    WISP_ASSERT( def->made_by_default == CONTACT_DEF_MADE );
    contact_state* state;
    wisp_status status = find_state( world, &state );
    status = status == WISP_OK ? check_guest( world, guest, def ) : status;
    const int number = status == WISP_OK ? contact_find_guest( state, guest ) : -1;
    if ( status == WISP_OK && def->enabled == false )
    {
        if ( number >= 0 )
        {
            leave_guest( world, state, number );
        }
        return WISP_OK;
    }
    status = status == WISP_OK && number < 0 ? enter_guest( world, state, guest ) : status;
    if ( status == WISP_OK )
    {
        contact_settings* settings = wisp_world_column( world, guest, state->settings, 0 );
        *settings = resolve( world, guest, def );
        state->changed = true;
    }
    return status;
}

wisp_status wisp_unset_contact( wisp_world* world, wisp_entity guest )
{
    contact_state* state;
    const wisp_status status = find_state( world, &state );
    const int number = status == WISP_OK ? contact_find_guest( state, guest ) : -1;
    if ( number >= 0 )
    {
        leave_guest( world, state, number );
    }
    return status;
}

// ---- figures ----

wisp_status wisp_want_contact_figures( wisp_world* world, bool wanted, bool count_crossings )
{
    contact_state* state;
    wisp_status status = find_state( world, &state );
    if ( status == WISP_OK && state->guest_count > 0 )
    {
        status = wanted ? wisp_want( world, state->meeting, state->figures )
                        : wisp_unwant( world, state->meeting, state->figures );
    }
    if ( status == WISP_OK )
    {
        state->wants_figures = wanted;
        state->counts_crossings = wanted && count_crossings;
    }
    return status;
}

static wisp_status find_figures( wisp_world* world, contact_state** state, const wisp_contact_figures** out )
{
    const wisp_status status = find_state( world, state );
    if ( status != WISP_OK )
    {
        return status;
    }
    *out =
        ( *state )->guest_count > 0 ? wisp_world_column( world, ( *state )->meeting, ( *state )->figures, 0 ) : NULL;
    return *out != NULL && ( *out )->guests > 0
               ? WISP_OK
               : wisp_world_fail(
                     world, WISP_CONFLICT,
                     "contact: no figures: nobody asked for them, nobody takes part, or no step was made" );
}

wisp_status wisp_read_contact_figures( wisp_world* world, wisp_contact_figures* out )
{
    contact_state* state;
    const wisp_contact_figures* figures;
    const wisp_status status = find_figures( world, &state, &figures );
    if ( status == WISP_OK )
    {
        *out = *figures;
        out->searches = state->soup.searches;
        const bool are_samples = state->world.features == WISP_CONTACT_SAMPLES;
        out->candidates = are_samples ? state->soup.candidate_count : state->soup.pairs[0].count;
    }
    return status;
}

wisp_status wisp_read_contact_impulse( wisp_world* world, wisp_entity guest, double out[3] )
{
    contact_state* state;
    const wisp_contact_figures* figures;
    const wisp_status status = find_figures( world, &state, &figures );
    const int number = status == WISP_OK ? contact_find_guest( state, guest ) : -1;
    if ( status == WISP_OK && number < 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "contact: entity %u takes no part", guest.index );
    }
    if ( status == WISP_OK )
    {
        memcpy( out, state->guests[number].impulse, sizeof( state->guests[number].impulse ) );
    }
    return status;
}
