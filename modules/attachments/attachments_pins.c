// Pins on another surface. In: positions, velocities and targets of that surface at the start of a step. Out: targets of the
// pins (pass attachments.follow).
//
// With the corners a, b and c of the triangle at the end of the step, w the barycentric coordinates and R the rotation whose first
// axis is along b - a and whose third is the normal, a pin goes to w a + w b + w c + R offset. Both w and offset are those
// of the pin when it was attached. A triangle without area has no rotation: its pins keep their targets.
#include "attachments_state.h"

#include "wisp/module/sleep.h"

static const wisp_column_def PLACE_COLUMNS[] = { WISP_COLUMN( attachments_place, place, 1 ) };

static bool is_in_range( wisp_vec3 p )
{
    return fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f; // false for NaN
}

// ---- the pass ----

static void follow( const wisp_surface_motion* m, const wisp_fabric* fabric, const attachments_place* place,
                    float* target )
{
    const int32_t* slots = fabric->triangles + 3 * (size_t)place->at.triangle;
    wisp_triangle t;
    wisp_vec3 axes[3];
    for ( int k = 0; k < 3; ++k )
    {
        t.corner[k] = wisp_surface_motion_end( m, slots[k] );
    }
    if ( wisp_triangle_axes( &t, axes ) == false )
    {
        return;
    }
    wisp_vec3 p = wisp_triangle_point( &t, place->at.weights );
    p = wisp_v3_mul_add( p, place->offset.x, axes[0] );
    p = wisp_v3_mul_add( p, place->offset.y, axes[1] );
    p = wisp_v3_mul_add( p, place->offset.z, axes[2] );
    if ( is_in_range( p ) )
    {
        target[0] = p.x;
        target[1] = p.y;
        target[2] = p.z;
        target[3] = 1.0f;
    }
}

static void follow_all( wisp_frame* frame, const wisp_span* span, void* user )
{
    const attachments_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    attachments_place* place = wisp_frame_column( frame, span->entity, state->place, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    float* target = wisp_frame_column( frame, span->entity, WISP_PARTICLE_TARGET, 0 );
    const float seconds = wisp_frame_dt( frame, span->entity ) * (float)wisp_frame_substeps( frame, span->entity );
    wisp_entity of = { 0, 0 };
    wisp_surface_motion m = { 0 };
    for ( int slot = 0; slot < fabric->slot_count; ++slot )
    {
        if ( place[slot].to.index == 0 )
        {
            continue;
        }
        if ( position[(size_t)slot * 4 + 3] != 0.0f )
        {
            place[slot] = ( attachments_place ){ .to = { 0, 0 } }; // it was unpinned
            continue;
        }
        if ( wisp_entity_equal( of, place[slot].to ) == false )
        {
            of = place[slot].to;
            m = wisp_frame_surface_motion( frame, of, seconds );
        }
        follow( &m, wisp_frame_fabric( frame, of ), place + slot, target + (size_t)slot * 4 );
    }
}

// ---- attaching ----

static bool has_attached_pins( const attachments_state* state, wisp_world* world, wisp_entity surface )
{
    const attachments_place* place = wisp_world_column( world, surface, state->place, 0 );
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    for ( int slot = 0; place != NULL && slot < fabric->slot_count; ++slot )
    {
        if ( place[slot].to.index != 0 )
        {
            return true;
        }
    }
    return false;
}

static bool is_attached_to( const attachments_state* state, wisp_world* world, wisp_entity to )
{
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->place, &e ); )
    {
        const attachments_place* place = wisp_world_column( world, e, state->place, 0 );
        const int slots = wisp_world_fabric( world, e )->slot_count;
        for ( int slot = 0; slot < slots; ++slot )
        {
            if ( wisp_entity_equal( place[slot].to, to ) )
            {
                return true;
            }
        }
    }
    return false;
}

static wisp_status check_vertices( wisp_world* world, const wisp_fabric* fabric, const int32_t* vertices, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( vertices[i] < 0 || vertices[i] >= fabric->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT, "vertex %d: the surface has %d vertices", vertices[i],
                                    fabric->vertex_count );
        }
    }
    return WISP_OK;
}

static wisp_status check_pair( wisp_world* world, const attachments_state* state, wisp_entity surface,
                               wisp_entity to )
{
    if ( wisp_entity_equal( surface, to ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "attachments: entity %u cannot be attached to itself",
                                to.index );
    }
    if ( has_attached_pins( state, world, to ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "attachments: entity %u has attached pins itself", to.index );
    }
    if ( is_attached_to( state, world, surface ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "attachments: other pins are attached to entity %u",
                                surface.index );
    }
    return WISP_OK;
}

static void attach_all( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count, wisp_entity to,
                        wisp_collision_mesh* mesh, attachments_place* place )
{
    const wisp_fabric *mine = wisp_world_fabric( world, surface ), *theirs = wisp_world_fabric( world, to );
    const float* position = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    const float* particles = wisp_world_column( world, to, WISP_PARTICLE_POSITION, 0 );
    for ( int i = 0; i < count; ++i )
    {
        const int slot = mine->vertex_slot[vertices[i]];
        const wisp_vec3 pin = wisp_v3_load( position + (size_t)slot * 4 );
        const wisp_anchor at = wisp_find_anchor( mesh, pin );
        if ( at.triangle >= 0 )
        {
            wisp_vec3 r[3] = { { 0.0f, 0.0f, 0.0f } };
            const wisp_triangle t = wisp_triangle_of( theirs, particles, at.triangle );
            const wisp_vec3 away = wisp_v3_sub( pin, wisp_triangle_point( &t, at.weights ) );
            const bool is_framed = wisp_triangle_axes( &t, r );
            const wisp_vec3 inside = { wisp_v3_dot( away, r[0] ), wisp_v3_dot( away, r[1] ),
                                       wisp_v3_dot( away, r[2] ) };
            place[slot] = ( attachments_place ){ to, at, is_framed ? inside : away };
        }
    }
}

static wisp_status begin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count,
                          attachments_state** state )
{
    WISP_FIND_STATE( attachments_state, found, world, "attachments", &surface, WISP_IS_SURFACE );
    *state = found;
    WISP_TRY( wisp_world_check_list( world, "vertices", vertices, count ) );
    return check_vertices( world, wisp_world_fabric( world, surface ), vertices, count );
}

wisp_status wisp_attach_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count,
                              wisp_entity to )
{
    attachments_state* state;
    WISP_TRY( begin( world, surface, vertices, count, &state ) );
    WISP_TRY( wisp_world_check_entity( world, to ) );
    WISP_TRY( check_pair( world, state, surface, to ) );
    wisp_collision_mesh* mesh;
    WISP_TRY( wisp_world_build_mesh( world, to, &mesh ) );
    const wisp_component_use uses[] = { { WISP_PARTICLE_TARGET, true }, { state->place, true } };
    wisp_status status = wisp_world_set_components( world, surface, uses, WISP_COUNT( uses ) );
    status = status == WISP_OK ? wisp_pin( world, surface, vertices, count ) : status;
    status = status == WISP_OK ? wisp_world_request( world, to, WISP_PARTICLE_POSITION, true ) : status; // has it
    if ( status == WISP_OK )
    {
        wisp_world_tie( world, to, surface );
        attach_all( world, surface, vertices, count, to, mesh, wisp_world_column( world, surface, state->place, 0 ) );
    }
    wisp_collision_mesh_release( mesh );
    return status;
}

wisp_status wisp_detach_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count )
{
    attachments_state* state;
    WISP_TRY( begin( world, surface, vertices, count, &state ) );
    attachments_place* place = wisp_world_column( world, surface, state->place, 0 );
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    for ( int i = 0; place != NULL && i < count; ++i )
    {
        place[fabric->vertex_slot[vertices[i]]] = ( attachments_place ){ .to = { 0, 0 } };
    }
    return WISP_OK;
}

// ---- module ----

// Detach all pins that are attached to a surface.
static void entity_removed( void* memory, wisp_world* world, wisp_entity to )
{
    const attachments_state* state = memory;
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->place, &e ); )
    {
        attachments_place* place = wisp_world_column( world, e, state->place, 0 );
        const int slots = wisp_world_fabric( world, e )->slot_count;
        for ( int slot = 0; slot < slots; ++slot )
        {
            if ( wisp_entity_equal( place[slot].to, to ) )
            {
                place[slot] = ( attachments_place ){ .to = { 0, 0 } };
            }
        }
    }
}

// As wisp_sleep_hooks.surroundings: pins go along with surfaces that must sleep themselves.
static bool find_surroundings( const void* memory, wisp_world* world, wisp_entity entity,
                               const wisp_sleep_bounds* bounds, uint64_t* hash )
{
    (void)bounds;
    (void)hash;
    const attachments_state* state = memory;
    const attachments_place* place = wisp_world_rows( world, entity, state->place, 0 );
    const int count = place != NULL ? wisp_world_fabric( world, entity )->slot_count : 0;
    bool rests = true;
    for ( int slot = 0; slot < count && rests; ++slot )
    {
        const wisp_entity to = place[slot].to;
        rests = to.index == 0 || wisp_is_asleep( world, to ) || wisp_is_halted( world, to );
    }
    return rests;
}

static wisp_status declare( wisp_registry* r )
{
    attachments_state* state = wisp_declare_state( r, sizeof( attachments_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->registry = r;
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){ .removed = entity_removed,
                                  .sleep = &( wisp_sleep_hooks ){ .surroundings = find_surroundings } } );
    state->place = WISP_COMPONENT( r, "attachments.place", WISP_TABLE_PARTICLE, PLACE_COLUMNS );
    const wisp_index_range ranges[] = {
        { .component = state->place, .kind = WISP_INDEX_SURFACE },
        { .component = state->place,
          .offset = offsetof( attachments_place, at ),
          .count = 1,
          .kind = WISP_INDEX_TRIANGLE },
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    const wisp_pass passes[] = {
        {
            WISP_PASS( "attachments.follow", INPUT, ENTITY, follow_all ),
            .required = { state->place },
            .reads = { state->place, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_TARGET },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
    };
    return state->place != 0 ? wisp_declare_passes( r, passes, WISP_COUNT( passes ), state ) : WISP_BAD_INPUT;
}

const wisp_module wisp_attachments_module = { .name = "attachments", .declare = declare };
