#include "collision_internal.h"

#include <math.h>
#include <string.h>

static const uint32_t COLLISION_DEF_MADE = 0x434f4c53;

#define COLLISION_SETTINGS_COLUMNS( X ) X( collision_settings, settings, 1 )
#define COLLISION_CONTACT_COLUMNS( X )                                                                               \
    X( int32_t, count, 1 ) /* contacts met; so many or WISP_COLLISION_CONTACTS are kept */                           \
    X( float, found, 4 )   /* m, where they were looked for, and how far from there nothing else is met */           \
    X( collision_contact, contact, WISP_COLLISION_CONTACTS )
#define COLLISION_ACTIVE_COLUMNS( X ) X( int32_t, active, 1 ) /* there is a body, and it is enabled */
#define COLLISION_STRAND_CONTACT_COLUMNS( X )                                                                        \
    X( float, pushed, 16 ) /* m, by bodies in this substep */                                                        \
    X( float, depth, 16 )  /* m, how much nearer than the thickness a vertex may be in this iteration */             \
    X( float, left, 16 )   /* m, how much nearer it was let be */
#define COLLISION_CARRIED_COLUMNS( X ) X( uint32_t, moved, 1 ) /* a bit for each lane of the row, in this step */
#define COLLISION_FIGURES_COLUMNS( X ) X( wisp_collision_figures, figures, 1 )
#define COLLISION_COLLIDER_COLUMNS( X ) X( collision_collider, collider, 1 )
#define COLLISION_MOTION_COLUMNS( X ) X( wisp_rigid, target, 1 ) /* at the end of the next step */

static const wisp_column_def SETTINGS_COLUMNS[] = { COLLISION_SETTINGS_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def CONTACT_COLUMNS[] = { COLLISION_CONTACT_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def ACTIVE_COLUMNS[] = { COLLISION_ACTIVE_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def STRAND_CONTACT_COLUMNS[] = { COLLISION_STRAND_CONTACT_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def CARRIED_COLUMNS[] = { COLLISION_CARRIED_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def FIGURES_COLUMNS[] = { COLLISION_FIGURES_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def COLLIDER_COLUMNS[] = { COLLISION_COLLIDER_COLUMNS( WISP_COLUMN_DEF ) };
static const wisp_column_def MOTION_COLUMNS[] = { COLLISION_MOTION_COLUMNS( WISP_COLUMN_DEF ) };

// ---- what is declared ----

static void release_state( void* memory, const wisp_allocator* allocator )
{
    collision_state* state = memory;
    for ( int i = 0; i < state->body_count; ++i )
    {
        wisp_mesh_tree_release( state->bodies[i].tree );
    }
    if ( state->bodies != NULL )
    {
        allocator->release( allocator->user, state->bodies, (size_t)state->body_capacity * sizeof( collision_body ) );
    }
    if ( state->guests != NULL )
    {
        allocator->release( allocator->user, state->guests, (size_t)state->guest_capacity * sizeof( wisp_entity ) );
    }
}

static bool is_same( wisp_entity a, wisp_entity b )
{
    return a.index == b.index && a.generation == b.generation;
}

static bool forget_guest( collision_state* state, wisp_entity guest )
{
    for ( int i = 0; i < state->guest_count; ++i )
    {
        if ( is_same( state->guests[i], guest ) )
        {
            state->guest_count -= 1;
            memmove( state->guests + i, state->guests + i + 1,
                     (size_t)( state->guest_count - i ) * sizeof( wisp_entity ) );
            return true;
        }
    }
    return false;
}

// With the last body everybody loses the contacts, and so the plan its passes. That only takes away, so it cannot
// fail.
static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    collision_state* state = memory;
    if ( forget_guest( state, entity ) == false && collision_forget_body( state, entity ) )
    {
        collision_dress_guests( world, state );
    }
}

static wisp_status declare_components( wisp_registry* r, collision_state* state )
{
    const wisp_component_def settings = { "collision.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS, 1 };
    const wisp_component_def contact = { "collision.contact", WISP_TABLE_PARTICLE, CONTACT_COLUMNS,
                                         WISP_COUNT( CONTACT_COLUMNS ) };
    const wisp_component_def active = { "collision.active", WISP_TABLE_ENTITY, ACTIVE_COLUMNS, 1 };
    const wisp_component_def strand_contact = { "collision.strand_contact", WISP_TABLE_STRAND_ROW,
                                                STRAND_CONTACT_COLUMNS, WISP_COUNT( STRAND_CONTACT_COLUMNS ) };
    const wisp_component_def carried = { "collision.carried", WISP_TABLE_STRAND_ROW, CARRIED_COLUMNS, 1 };
    const wisp_component_def figures = { "collision.figures", WISP_TABLE_ENTITY, FIGURES_COLUMNS, 1 };
    const wisp_component_def collider = { "collision.collider", WISP_TABLE_ENTITY, COLLIDER_COLUMNS, 1 };
    const wisp_component_def motion = { "collision.motion", WISP_TABLE_ENTITY, MOTION_COLUMNS, 1 };
    state->settings = wisp_declare_component( r, &settings );
    state->contact = wisp_declare_component( r, &contact );
    state->active = wisp_declare_component( r, &active );
    state->strand_contact = wisp_declare_component( r, &strand_contact );
    state->carried = wisp_declare_component( r, &carried );
    state->figures = wisp_declare_component( r, &figures );
    state->collider = wisp_declare_component( r, &collider );
    state->motion = wisp_declare_component( r, &motion );
    return state->motion != 0 ? WISP_OK : WISP_BAD_INPUT;
}

static wisp_status declare_passes( wisp_registry* r, collision_state* state )
{
    const wisp_pass passes[] = {
        {
            .name = "collision.carry",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { state->motion, state->collider },
            .reads = { state->motion, state->collider },
            .writes = { state->collider },
            .run = collision_carry,
            .user = state,
        },
        {
            .name = "collision.find",
            .stage = WISP_STAGE_CONTACT,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .needs = { state->settings, state->contact },
            .lacks = { WISP_PARTICLE_SOLVED },
            .reads = { state->settings, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { state->contact, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .run = collision_find,
            .user = state,
        },
        {
            .name = "collision.project",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .needs = { state->settings, state->contact },
            .lacks = { WISP_PARTICLE_SOLVED },
            .reads = { state->settings, state->contact, WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS },
            .writes = { state->contact, WISP_PARTICLE_POSITION },
            .run = collision_project,
            .user = state,
        },
        {
            .name = "collision.figures",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { state->settings, state->contact },
            .lacks = { WISP_PARTICLE_SOLVED },
            .reads = { state->settings, state->contact, WISP_PARTICLE_POSITION },
            .writes = { state->figures },
            .run = collision_measure,
            .user = state,
        },
        {
            .name = "collision.sense",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_PARTICLE_BLOCK,
            .needs = { state->settings, state->active, WISP_PARTICLE_SOLVED, WISP_PARTICLE_TOUCH },
            .reads = { state->settings, state->active, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_TOUCH },
            .run = collision_sense,
            .user = state,
        },
        {
            .name = "collision.touch_figures",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { state->settings, state->active, WISP_PARTICLE_SOLVED },
            .reads = { state->settings, state->active, WISP_PARTICLE_POSITION },
            .writes = { state->figures },
            .run = collision_measure_touch,
            .user = state,
        },
        {
            .name = "collision.strands",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .needs = { state->settings, state->strand_contact, WISP_STRAND_WEIGHT },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_WEIGHT, WISP_STRAND_POSITION,
                       WISP_STRAND_PREVIOUS },
            .writes = { state->strand_contact, WISP_STRAND_POSITION, WISP_STRAND_PREVIOUS },
            .run = collision_touch_strands,
            .user = state,
        },
        {
            .name = "collision.strand_figures",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { state->settings, state->strand_contact, WISP_STRAND_WEIGHT },
            .reads = { state->settings, state->strand_contact, WISP_STRAND_WEIGHT, WISP_STRAND_POSITION },
            .writes = { state->figures },
            .run = collision_measure_strands,
            .user = state,
        },
        {
            // It reads the place and says so, which puts it behind what begins an appearance without reading it; what
            // goes on from there is an equal, for which the order of the modules decides.
            .name = "collision.carried",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .needs = { state->settings, state->carried },
            .reads = { state->settings, state->carried, WISP_STRAND_POSITION },
            .writes = { state->carried, WISP_STRAND_POSITION },
            .run = collision_keep_out,
            .user = state,
        },
        {
            .name = "collision.carried_figures",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .needs = { state->settings, state->carried },
            .reads = { state->settings, state->carried, WISP_STRAND_POSITION },
            .writes = { state->figures },
            .run = collision_measure_carried,
            .user = state,
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
    collision_state* state = wisp_declare_state( r, sizeof( collision_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .release = release_state, .removed = entity_removed } );
    wisp_status status = declare_components( r, state );
    return status == WISP_OK ? declare_passes( r, state ) : status;
}

const wisp_module wisp_collision_module = { .name = "collision", .declare = declare };

// ---- what the files of this folder share ----

wisp_status collision_find_state( wisp_world* world, collision_state** out )
{
    *out = wisp_world_module_state( world, "collision" );
    return *out != NULL
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "the module collision is not registered in this world" );
}

bool collision_reserve( wisp_world* world, void** array, int* capacity, int count, size_t element )
{
    if ( count < *capacity )
    {
        return true;
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    int more = *capacity > 0 ? 2 * *capacity : 4;
    void* grown = allocator->allocate( allocator->user, (size_t)more * element, 64 );
    if ( grown == NULL )
    {
        return false;
    }
    if ( *array != NULL )
    {
        memcpy( grown, *array, (size_t)count * element );
        allocator->release( allocator->user, *array, (size_t)*capacity * element );
    }
    *array = grown;
    *capacity = more;
    return true;
}

// Who solves for velocities senses bodies and has no use for contacts. What was sensed is not true for ever: without a
// body nobody writes it anew.
static wisp_status dress_surface( wisp_world* world, const collision_state* state, wisp_entity guest, bool active )
{
    const bool touches = active && wisp_world_has( world, guest, WISP_PARTICLE_SOLVED ) == false;
    wisp_status status =
        active ? wisp_world_attach( world, guest, state->active ) : wisp_world_detach( world, guest, state->active );
    if ( status == WISP_OK )
    {
        status = touches ? wisp_world_attach( world, guest, state->contact )
                         : wisp_world_detach( world, guest, state->contact );
    }
    int32_t* body = active ? NULL : wisp_world_column( world, guest, WISP_PARTICLE_TOUCH, 0 );
    if ( body != NULL )
    {
        const int slots = wisp_world_fabric( world, guest )->slot_count;
        memset( body, 0, (size_t)slots * WISP_TOUCHES * sizeof( int32_t ) );
    }
    return status;
}

// Strands that were carried when they came and have dynamics now change their dress.
static wisp_status dress_strands( wisp_world* world, const collision_state* state, wisp_entity guest, bool active )
{
    const bool moves = wisp_world_has( world, guest, WISP_STRAND_WEIGHT );
    const wisp_component contact = moves ? state->strand_contact : state->carried;
    const wisp_status status =
        active ? wisp_world_attach( world, guest, contact ) : wisp_world_detach( world, guest, contact );
    if ( status == WISP_OK && moves && wisp_world_has( world, guest, state->carried ) )
    {
        return wisp_world_detach( world, guest, state->carried );
    }
    return status;
}

static wisp_status dress( wisp_world* world, const collision_state* state, wisp_entity guest )
{
    const collision_settings* settings = wisp_world_column( world, guest, state->settings, 0 );
    const bool active = state->body_count > 0 && settings->enabled != 0, figures = active && settings->figures != 0;
    wisp_status status = WISP_OK;
    if ( figures == false )
    {
        status = wisp_unwant( world, guest, state->figures );
    }
    if ( status == WISP_OK )
    {
        status = wisp_world_strands( world, guest ) == NULL ? dress_surface( world, state, guest, active )
                                                            : dress_strands( world, state, guest, active );
    }
    return status == WISP_OK && figures ? wisp_want( world, guest, state->figures ) : status;
}

wisp_status collision_dress_guests( wisp_world* world, collision_state* state )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < state->guest_count && status == WISP_OK; ++i )
    {
        status = dress( world, state, state->guests[i] );
    }
    return status;
}

// ---- surfaces and strands ----

wisp_collision_def wisp_default_collision_def( void )
{
    return ( wisp_collision_def ){
        .friction = 1.0f,
        .mask = UINT32_MAX,
        .enabled = true,
        .made_by_default = COLLISION_DEF_MADE,
    };
}

static wisp_status check_def( wisp_world* world, const wisp_collision_def* d )
{
    const struct
    {
        const char* name;
        float value;
    } ranges[] = {
        { "thickness", d->thickness },
        { "friction", d->friction },
        { "recovery_speed", d->recovery_speed },
    };
    for ( int i = 0; i < WISP_COUNT( ranges ); ++i )
    {
        if ( !( ranges[i].value >= 0.0f && ranges[i].value <= 1e6f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "collision: %s is %g, it must be 0 to 1e6", ranges[i].name,
                                    (double)ranges[i].value );
        }
    }
    return WISP_OK;
}

// The one length that a surface has of its own.
static float mean_edge( const wisp_fabric* fabric )
{
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        const wisp_vec3 a = fabric->rest[fabric->edges[2 * e]], b = fabric->rest[fabric->edges[2 * e + 1]];
        sum += (double)collision_length( collision_sub( a, b ) );
    }
    return sum > 0.0 ? (float)( sum / fabric->edge_count ) : 0.0f;
}

static float mean_rest_segment( const wisp_strand_topology* strands, const float* rest )
{
    double sum = 0.0;
    int count = 0;
    for ( int lane = 0; lane < strands->group_count * WISP_LANES; ++lane )
    {
        const float* x = rest + (size_t)strands->group_row[lane / WISP_LANES] * 3 * WISP_LANES + lane % WISP_LANES;
        for ( int i = 1; i < strands->lane_count[lane]; ++i )
        {
            const wisp_vec3 last = collision_load_lane( x + (size_t)( i - 1 ) * 3 * WISP_LANES );
            const wisp_vec3 here = collision_load_lane( x + (size_t)i * 3 * WISP_LANES );
            const float length = collision_length( collision_sub( here, last ) );
            sum += (double)length;
            count += length > 0.0f ? 1 : 0;
        }
    }
    return count > 0 ? (float)( sum / count ) : 0.0f;
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

// Where no edge has a length it is a millimetre.
static float own_length( wisp_world* world, wisp_entity guest )
{
    const wisp_strand_topology* strands = wisp_world_strands( world, guest );
    float length;
    if ( strands == NULL )
    {
        length = mean_edge( wisp_world_fabric( world, guest ) );
    }
    else if ( wisp_world_has( world, guest, WISP_STRAND_LENGTH ) )
    {
        length = mean_segment( strands, wisp_world_column( world, guest, WISP_STRAND_LENGTH, 0 ) );
    }
    else
    {
        length = mean_rest_segment( strands, wisp_world_column( world, guest, WISP_STRAND_REST, 0 ) );
    }
    return length > 0.0f ? length : 1e-3f;
}

static collision_settings resolve( const wisp_collision_def* d, float edge, int32_t figures )
{
    return ( collision_settings ){
        .thickness = d->thickness > 0.0f ? d->thickness : 0.25f * edge,
        .friction = d->friction,
        .recovery_speed = d->recovery_speed > 0.0f ? d->recovery_speed : 10.0f * edge,
        .mask = d->mask,
        .enabled = d->enabled ? 1 : 0,
        .figures = figures,
    };
}

// Who is new to collision, on the list and with settings that are still zero.
static wisp_status enter_guest( wisp_world* world, collision_state* state, wisp_entity guest )
{
    if ( collision_reserve( world, (void**)&state->guests, &state->guest_capacity, state->guest_count,
                            sizeof( wisp_entity ) ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "no memory for %d entities that collide",
                                state->guest_count + 1 );
    }
    wisp_status status = wisp_world_attach( world, guest, state->settings );
    if ( status == WISP_OK )
    {
        state->guests[state->guest_count++] = guest;
    }
    return status;
}

// Strands with a velocity must have the rest of what moves them, or there is nothing that contacts could be written to.
static wisp_status find_guest( wisp_world* world, wisp_entity guest, collision_state** state )
{
    if ( wisp_world_strands( world, guest ) == NULL )
    {
        void* found;
        wisp_status status = wisp_world_surface_state( world, "collision", guest, &found );
        *state = found;
        return status;
    }
    wisp_status status = collision_find_state( world, state );
    if ( status == WISP_OK && wisp_world_has( world, guest, WISP_STRAND_VELOCITY ) &&
         ( wisp_world_has( world, guest, WISP_STRAND_WEIGHT ) == false ||
           wisp_world_has( world, guest, WISP_STRAND_LENGTH ) == false ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "collision: the strands of entity %u do not move: give them dynamics first",
                                guest.index );
    }
    return status;
}

wisp_status wisp_set_collision( wisp_world* world, wisp_entity guest, const wisp_collision_def* def )
{
    WISP_ASSERT( def->made_by_default == COLLISION_DEF_MADE );
    collision_state* state;
    wisp_status status = find_guest( world, guest, &state );
    status = status == WISP_OK ? check_def( world, def ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    const bool is_new = wisp_world_has( world, guest, state->settings ) == false;
    status = is_new ? enter_guest( world, state, guest ) : WISP_OK;
    if ( status != WISP_OK )
    {
        return status;
    }
    collision_settings* settings = wisp_world_column( world, guest, state->settings, 0 );
    const collision_settings before = *settings;
    *settings = resolve( def, own_length( world, guest ), before.figures );
    status = dress( world, state, guest );
    if ( status != WISP_OK )
    {
        *settings = before;
        dress( world, state, guest ); // only takes away: what it was dressed in is there already
    }
    if ( status != WISP_OK && is_new )
    {
        forget_guest( state, guest );
        wisp_world_detach( world, guest, state->settings );
    }
    return status;
}
