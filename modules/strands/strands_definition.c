// Definition of the dynamics of strands. In: wisp_strand_dynamics_def. Out: the components whose presence decides
// which passes run, and their values.
#include "strands_definition.h"

#include "masses_lengths.h"
#include "rod_factors.h"
#include "rod_frames.h"
#include "strand_rows.h"
#include "strand_tips.h"

#include <string.h>

void wisp_init_strand_dynamics_def( wisp_strand_dynamics_def* def, size_t size )
{
    const wisp_strand_dynamics_def values = {
        .stretch = WISP_STRAND_STRETCH_DIRECT,
        .stretch_passes = 8,
        .stretch_tolerance = 1e-2f,
        .bending = WISP_STRAND_BEND_ROD,
        .bend_rigidity = 8e-9f,
        .twist_rigidity = 6e-9f,
        .rest = WISP_STRAND_REST_SAG_FREE,
        .clamped = true,
        .solver = WISP_SOLVER_XPBD,
        .stretch_stiffness = 1.0f,
        .bend_stiffness = 0.2f,
        .line_density = 6.5e-6f,
        .gravity = { 0.0f, -9.81f, 0.0f },
        .damping = 3.0f,
        .air_density = 1.204f,
        .diameter = 8e-5f,
        .teleport = 5.0f,
    };
    wisp_def_init( def, size, &values, sizeof( values ) );
}

static wisp_status find_strands( wisp_world* world, wisp_entity strands, strands_state** state )
{
    *state = wisp_world_module_state( world, "strands" );
    if ( *state == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "the module strands is not registered in this world" );
    }
    if ( wisp_world_strands( world, strands ) == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "entity %u has no strands", strands.index );
    }
    return WISP_OK;
}

wisp_status strands_find( wisp_world* world, wisp_entity strands, strands_state** state )
{
    const wisp_status status = find_strands( world, strands, state );
    if ( status == WISP_OK && wisp_world_has( world, strands, ( *state )->settings ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "the strands of entity %u have no dynamics", strands.index );
    }
    return status;
}

// ---- components ----

typedef struct requested_component
{
    wisp_component component;
    bool requested;
} requested_component;

enum
{
    COMPONENT_COUNT = 25,
};

// Return whether vertices behind a root may be pinned: by a pin, or because a strand has no length.
static bool holds_vertices( const wisp_strand_topology* t, const float* rest, const wisp_strand_dynamics_def* d )
{
    bool holds = d->pin_count > 0;
    for ( int i = 0; i < t->group_count * WISP_LANES && holds == false; ++i )
    {
        const int row = t->group_row[i / WISP_LANES], lane = i % WISP_LANES;
        float whole = 0.0f;
        for ( int v = 1; v < t->lane_count[i]; ++v )
        {
            whole +=
                wisp_v3_length( wisp_v3_sub( strands_get( rest, row + v, lane ), strands_get( rest, row, lane ) ) );
        }
        holds = t->lane_count[i] > 1 && whole == 0.0f;
    }
    return holds;
}

static void list_components( const strands_state* s, const wisp_strand_dynamics_def* d, bool anchored, bool holds,
                             bool guides, requested_component all[COMPONENT_COUNT] )
{
    const bool has_section = d->edgewise_rigidity > 0.0f;
    const bool direct = d->stretch == WISP_STRAND_STRETCH_DIRECT, rod = d->bending == WISP_STRAND_BEND_ROD;
    const bool links = d->stretch == WISP_STRAND_STRETCH_LINKS, bend_links = d->bending == WISP_STRAND_BEND_LINKS;
    const bool straight = d->rest == WISP_STRAND_REST_STRAIGHT, bdf2 = d->integrator == WISP_INTEGRATOR_BDF2;
    const requested_component list[COMPONENT_COUNT] = {
        { WISP_STRAND_VELOCITY, true },
        { WISP_STRAND_INVERSE_MASS, true },
        { WISP_STRAND_LENGTH, true },
        { WISP_STRAND_ROOT, true },
        { s->low, true },
        { s->settings, true },
        { s->good, true },
        { s->in_bounds, true },
        { s->head, anchored == false },
        { s->damping, d->damping > 0.0f },
        { s->air, d->drag_coefficient > 0.0f },
        { s->pins, holds },
        { s->direct, direct },
        { s->tension, direct || rod },
        { s->links, links },
        { s->stretch_link, links },
        { s->bend_links, bend_links },
        { s->bend_link, bend_links },
        { s->history, bdf2 },
        { s->rod, rod },
        { s->clamp, rod },
        { s->section, has_section },
        { s->closed, d->closed },
        { s->response, d->closed && rod },
        { s->curve, rod && ( straight == false || has_section || guides || d->closed ) },
    };
    memcpy( all, list, sizeof( list ) );
}

// Attach missing components before detaching others, so that without memory nothing changes.
static wisp_status update_components( wisp_world* world, wisp_entity strands, const strands_state* s,
                                      const wisp_strand_dynamics_def* d )
{
    requested_component all[COMPONENT_COUNT + 1];
    bool came[COMPONENT_COUNT + 1] = { false };
    const float* rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    list_components( s, d, wisp_world_has( world, strands, s->anchor ),
                     holds_vertices( wisp_world_strands( world, strands ), rest, d ),
                     strands_guides_tips( world, strands, s ), all );
    all[COMPONENT_COUNT] = ( requested_component ){ s->balance, all[COMPONENT_COUNT - 1].requested };
    wisp_status status = WISP_OK;
    for ( int i = 0; i <= COMPONENT_COUNT && status == WISP_OK; ++i )
    {
        if ( all[i].requested && wisp_world_has( world, strands, all[i].component ) == false )
        {
            status = wisp_world_attach( world, strands, all[i].component );
            came[i] = status == WISP_OK;
        }
    }
    for ( int i = 0; i <= COMPONENT_COUNT; ++i )
    {
        if ( status == WISP_OK ? all[i].requested == false : came[i] )
        {
            (void)wisp_world_detach( world, strands, all[i].component ); // frees memory, so it cannot fail
        }
    }
    return status;
}

// ---- values ----

static void fill_settings( wisp_world* world, wisp_entity strands, const strands_state* s,
                           const wisp_strand_dynamics_def* d )
{
    const strands_rows rows = strands_rows_of( world, strands );
    const float longest = strands_longest( &rows );
    strands_settings* settings = wisp_world_column( world, strands, s->settings, 0 );
    *settings = ( strands_settings ){
        .gravity = d->gravity,
        .bend_rigidity = fmaxf( d->bend_rigidity, d->edgewise_rigidity ),
        .twist_rigidity = d->twist_rigidity,
        .bend_damping = d->bend_damping,
        .teleport = longest > 0.0f ? d->teleport * longest : INFINITY, // strands without length only follow
        .rest = (int32_t)d->rest,
        .clamped = d->clamped && d->free_roots == false && d->closed == false ? 1 : 0,
        .is_free = d->free_roots || d->closed ? 1 : 0,
    };
}

static void fill_materials( wisp_world* world, wisp_entity strands, const strands_state* s,
                            const wisp_strand_dynamics_def* d )
{
    float* damping = wisp_world_column( world, strands, s->damping, 0 );
    strands_air* air = wisp_world_column( world, strands, s->air, 0 );
    strands_direct* direct = wisp_world_column( world, strands, s->direct, 0 );
    strands_link* links = wisp_world_column( world, strands, s->links, 0 );
    strands_link* bend_links = wisp_world_column( world, strands, s->bend_links, 0 );
    strands_section* section = wisp_world_column( world, strands, s->section, 0 );
    strands_closed* closed = wisp_world_column( world, strands, s->closed, 0 );
    const int32_t xpbd = d->solver == WISP_SOLVER_XPBD ? 1 : 0;
    const bool is_airless = d->drag_coefficient == 0.0f || d->air_density == 0.0f;
    wisp_world_tell( world, strands, is_airless && ( d->wind.x != 0.0f || d->wind.y != 0.0f || d->wind.z != 0.0f ),
                     "'wind' has no effect without drag_coefficient and air_density" );
    if ( closed != NULL )
    {
        *closed = ( strands_closed ){ d->closing_twist };
    }
    if ( section != NULL )
    {
        const double ratio = (double)d->bend_rigidity / (double)d->edgewise_rigidity;
        *section = ( strands_section ){ (float)sqrt( 1.0 - ratio ), d->natural_twist, d->flat_normal };
    }
    if ( damping != NULL )
    {
        *damping = d->damping;
    }
    if ( air != NULL )
    {
        *air = ( strands_air ){ d->wind, 0.5f * d->air_density * d->drag_coefficient * d->diameter };
    }
    if ( direct != NULL )
    {
        *direct = ( strands_direct ){ d->stretch_passes, d->stretch_tolerance, d->bending == WISP_STRAND_BEND_ROD };
    }
    if ( links != NULL )
    {
        *links = ( strands_link ){ xpbd, d->stretch_stiffness, d->stretch_compliance };
    }
    if ( bend_links != NULL )
    {
        *bend_links = ( strands_link ){ xpbd, d->bend_stiffness, d->bend_compliance };
    }
}

// Put the last vertex of each loop exactly on its first: it is the same one.
static void join_ends( wisp_world* world, wisp_entity strands )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    float* rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int first = t->group_row[i / WISP_LANES], lane = i % WISP_LANES;
        if ( t->lane_count[i] > 0 )
        {
            strands_put( rest, first + t->lane_count[i] - 1, lane, strands_get( rest, first, lane ) );
        }
    }
}

// Set positions to the rest shape, with the head at its first pose.
static void set_rest_shape( wisp_world* world, wisp_entity strands, const strands_state* s )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const size_t bytes = (size_t)t->row_count * 3 * WISP_LANES * sizeof( float );
    const float* rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    float* root = wisp_world_column( world, strands, WISP_STRAND_ROOT, 0 );
    float* rotation = wisp_world_column( world, strands, WISP_STRAND_ROOT, 1 );
    strands_head* head = wisp_world_column( world, strands, s->head, 0 );
    const wisp_transform origin = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    memcpy( wisp_world_column( world, strands, WISP_STRAND_POSITION, 0 ), rest, bytes );
    memcpy( wisp_world_column( world, strands, s->good, 0 ), rest, bytes );
    *head = ( strands_head ){ .from = origin, .to = origin, .target = origin };
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES;
        strands_put( root, group, lane, strands_get( rest, t->group_row[group], lane ) );
        strands_put_quat( rotation, group, lane, origin.rotation );
    }
    const wisp_vec3 offset = wisp_world_offset( world, strands );
    if ( offset.x != 0.0f || offset.y != 0.0f || offset.z != 0.0f )
    {
        const wisp_teleport_motion rows = { .motion = { origin.rotation, offset }, .keep_velocity = true };
        wisp_teleport_lanes( &rows, wisp_world_column( world, strands, WISP_STRAND_POSITION, 0 ), NULL,
                             t->row_count );
        wisp_teleport_lanes( &rows, wisp_world_column( world, strands, s->good, 0 ), NULL, t->row_count );
        wisp_teleport_lanes( &rows, root, NULL, t->group_count );
        *head = ( strands_head ){ .from = rows.motion, .to = rows.motion, .target = rows.motion };
    }
}

void strands_lay_frames( wisp_world* world, wisp_entity strands, const strands_state* s )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* position = wisp_world_column( world, strands, WISP_STRAND_POSITION, 0 );
    const float* clamp = wisp_world_column( world, strands, s->clamp, 0 );
    const float* root = wisp_world_column( world, strands, WISP_STRAND_ROOT, 1 );
    const float* length = wisp_world_column( world, strands, WISP_STRAND_LENGTH, 0 );
    const strands_section* section = wisp_world_column( world, strands, s->section, 0 );
    const float twist = section != NULL ? section->twist : 0.0f;
    float* frame = wisp_world_column( world, strands, s->curve, 0 );
    for ( int g = 0; g < t->group_count; ++g )
    {
        strands_lay_group( t, position, clamp, root, length, twist, frame, g );
    }
}

void strands_reset_rest( wisp_world* world, wisp_entity strands, const strands_state* s )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    float* balanced = wisp_world_column( world, strands, s->balance, 0 );
    for ( int g = 0; balanced != NULL && g < t->group_count; ++g )
    {
        balanced[g] = 0.0f;
    }
}

// Strands of another definition have no substep to look back on.
static void forget_history( wisp_world* world, wisp_entity strands, const strands_state* s )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    float* step = wisp_world_column( world, strands, s->history, 2 );
    if ( step != NULL )
    {
        memset( step, 0, (size_t)t->row_count * WISP_LANES * sizeof( float ) );
    }
}

// Compute everything that follows from the definition alone, for new and for moving strands.
static void cook( wisp_world* world, wisp_entity strands, const strands_state* s, const wisp_strand_dynamics_def* d )
{
    const int pins = strands_cook_masses( world, strands, d );
    fill_settings( world, strands, s, d );
    fill_materials( world, strands, s, d );
    int32_t* held = wisp_world_column( world, strands, s->pins, 0 );
    if ( held != NULL )
    {
        *held = pins;
    }
    strands_cook_links( world, strands, s );
    strands_cook_rods( world, strands, s );
    strands_cook_tips( world, strands, s );
    strands_reset_rest( world, strands, s );
    forget_history( world, strands, s );
}

// ---- the call of the host ----

wisp_status wisp_set_strand_dynamics( wisp_world* world, wisp_entity strands, const wisp_strand_dynamics_def* given )
{
    wisp_strand_dynamics_def values = wisp_default_strand_dynamics_def();
    const wisp_strand_dynamics_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, "wisp_default_strand_dynamics_def", &values, given ) );
    WISP_TRY( wisp_world_check_entity( world, strands ) );
    strands_state* s;
    WISP_TRY( find_strands( world, strands, &s ) );
    WISP_TRY( strands_check_definition( world, strands, s, def ) );
    const bool is_new = wisp_world_has( world, strands, s->settings ) == false;
    const bool direct = def->stretch == WISP_STRAND_STRETCH_DIRECT;
    const bool had_frames = wisp_world_has( world, strands, s->curve );
    const bool had_section = wisp_world_has( world, strands, s->section );
    WISP_TRY( update_components( world, strands, s, def ) );
    if ( def->closed )
    {
        join_ends( world, strands );
    }
    cook( world, strands, s, def );
    if ( is_new )
    {
        set_rest_shape( world, strands, s );
    }
    // another section has other axes
    const bool has_axes = had_section || wisp_world_has( world, strands, s->section );
    if ( ( had_frames == false || has_axes ) && wisp_world_has( world, strands, s->curve ) )
    {
        strands_lay_frames( world, strands, s );
    }
    float* tension = wisp_world_column( world, strands, s->tension, 0 );
    if ( direct == false && tension != NULL )
    {
        // tensions are not solved any more, and a rod must not apply old ones
        const size_t rows = (size_t)wisp_world_strands( world, strands )->row_count;
        memset( tension, 0, rows * WISP_LANES * sizeof( float ) );
    }
    return WISP_OK;
}
