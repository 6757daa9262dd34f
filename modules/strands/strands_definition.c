// Definition of the dynamics of strands. In: wisp_strand_dynamics_def. Out: the components whose presence decides
// which passes run, and their values.
#include "strand_passes.h"

#include "strand_rows.h"

#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

// ---- checks ----

// What a definition of strands must hold: ranges, what excludes what, lists.

// Largest EI' / EI. The flatness sqrt( 1 - EI / EI' ) is in single precision, and EI is what it leaves of EI': 0.05 % off at
// 1e4, 1 % at 1e5, nothing that is left, and rest shapes that are NaN, from 3e7 on.
#define MAX_EDGEWISE 1e5f

static wisp_status check_integrator( wisp_world* world, const wisp_strand_dynamics_def* d )
{
    if ( d->integrator == WISP_INTEGRATOR_BDF2 && d->stretch != WISP_STRAND_STRETCH_DIRECT )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got integrator bdf2 with stretch links, expected direct" );
    }
    return WISP_OK;
}

static wisp_status check_section( wisp_world* world, const wisp_strand_dynamics_def* d )
{
    const wisp_vec3 n = d->flat_normal;
    const bool is_flat = d->edgewise_rigidity > 0.0f;
    if ( is_flat && ( d->edgewise_rigidity < d->bend_rigidity || d->bend_rigidity <= 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got edgewise_rigidity %g with bend_rigidity %g, expected 0 or at least a "
                                "bend_rigidity above 0",
                                (double)d->edgewise_rigidity, (double)d->bend_rigidity );
    }
    if ( is_flat && d->edgewise_rigidity > MAX_EDGEWISE * d->bend_rigidity )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "strands: got edgewise_rigidity %g with bend_rigidity %g, expected at most %g times it",
            (double)d->edgewise_rigidity, (double)d->bend_rigidity, (double)MAX_EDGEWISE );
    }
    if ( is_flat && d->bending != WISP_STRAND_BEND_ROD )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got edgewise_rigidity %g with bending other than rod",
                                (double)d->edgewise_rigidity );
    }
    if ( is_flat == false && ( d->natural_twist != 0.0f || n.x != 0.0f || n.y != 0.0f || n.z != 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: natural_twist and flat_normal need an edgewise_rigidity above 0" );
    }
    return WISP_OK;
}

// Check what free roots and closed strands do without.
static wisp_status check_free( wisp_world* world, wisp_entity strands, const strands_state* s,
                               const wisp_strand_dynamics_def* d )
{
    const char* name = d->closed ? "closed" : "free_roots";
    const bool rod = d->bending == WISP_STRAND_BEND_ROD;
    if ( ( d->closed == false || rod == false ) && d->closing_twist != 0.0f )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: closing_twist needs closed and bending rod" );
    }
    if ( d->closed == false && d->free_roots == false )
    {
        return WISP_OK;
    }
    if ( rod && d->rest == WISP_STRAND_REST_SAG_FREE )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got %s with rest sag_free, expected shape or straight", name );
    }
    if ( d->closed && ( d->stretch != WISP_STRAND_STRETCH_DIRECT || d->bending == WISP_STRAND_BEND_LINKS ||
                        d->integrator != WISP_INTEGRATOR_EULER || d->edgewise_rigidity > 0.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: closed needs stretch direct, bending rod or none, integrator euler and no "
                                "edgewise_rigidity" );
    }
    if ( wisp_world_has( world, strands, s->anchor ) || wisp_world_has( world, strands, s->tips ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "strands: got %s for entity %u, whose roots are on a surface or whose tips are held",
                                name, strands.index );
    }
    return WISP_OK;
}

// Check that each strand is a loop whose segments have a length.
static wisp_status check_loops( wisp_world* world, wisp_entity strands )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        if ( t->lane_count[i] > 0 &&
             strands_is_loop( rest, t->group_row[i / WISP_LANES], t->lane_count[i], i % WISP_LANES ) == false )
        {
            return wisp_world_fail(
                world, WISP_BAD_INPUT,
                "strands: strand %d is no loop, closed needs at least four vertices and the last on "
                "the first",
                t->lane_strand[i] );
        }
    }
    return WISP_OK;
}

static wisp_status check_lists( wisp_world* world, const wisp_strand_topology* t, const wisp_strand_dynamics_def* d )
{
    for ( int v = 0; d->vertex_masses != NULL && v < t->vertex_count; ++v )
    {
        if ( !( d->vertex_masses[v] >= 1e-15f && d->vertex_masses[v] <= 1e12f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "strands: the mass of vertex %d is %g kg, it must be 1e-15 to 1e12", v,
                                    (double)d->vertex_masses[v] );
        }
    }
    if ( d->pin_count < 0 || ( d->pin_count > 0 && d->pins == NULL ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: %d pins without a list of them", d->pin_count );
    }
    for ( int k = 0; k < d->pin_count; ++k )
    {
        if ( d->pins[k] < 0 || d->pins[k] >= t->vertex_count )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "strands: pin %d is vertex %d, the strands have %d vertices", k, d->pins[k],
                                    t->vertex_count );
        }
    }
    return WISP_OK;
}

// Check a definition against its ranges, itself and the strands. @return WISP_BAD_INPUT, WISP_CONFLICT
static wisp_status strands_check_definition( wisp_world* world, wisp_entity strands, const strands_state* s,
                                             const wisp_strand_dynamics_def* d )
{
    WISP_TRY( check_integrator( world, d ) );
    WISP_TRY( check_section( world, d ) );
    WISP_TRY( check_free( world, strands, s, d ) );
    WISP_TRY( d->closed ? check_loops( world, strands ) : WISP_OK );
    return check_lists( world, wisp_world_strands( world, strands ), d );
}

// ---- state ----

// State check: an entity whose positions or velocities leave their bounds (or are NaN) is restored to its last valid
// state and halted. In: positions and velocities at the end of a step. Out: the copy of the last valid state, or the
// restored columns.

enum
{
    CHECK_GRAIN = 16, // groups per block
};

typedef struct check_loop
{
    const wisp_kernels* kernels;
    const int32_t* group_row;
    int32_t* in_bounds;
    float *position, *velocity;
    float *good_position, *good_velocity;
    _Atomic int first_bad; // lowest row out of bounds, or the number of rows
} check_loop;

static void check_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    check_loop* loop = context;
    const wisp_strand_bound_args args = { loop->position, loop->velocity, STRANDS_BOUND };
    int bad = INT_MAX;
    for ( int g = begin; g < end; ++g )
    {
        const int last = loop->group_row[g + 1];
        const int row = loop->in_bounds[g] != 0
                            ? last
                            : loop->kernels->strand_find_out_of_bounds( &args, loop->group_row[g], last );
        bad = row < last && row < bad ? row : bad;
        loop->in_bounds[g] = 0; // until the next step is checked
    }
    int lowest = atomic_load_explicit( &loop->first_bad, memory_order_relaxed );
    while ( bad < lowest && atomic_compare_exchange_weak( &loop->first_bad, &lowest, bad ) == false )
    {
    }
}

static void save_state( void* context, int begin, int end, int worker )
{
    (void)worker;
    check_loop* loop = context;
    const size_t first = strands_vector( loop->group_row[begin], 0 );
    const size_t bytes = ( strands_vector( loop->group_row[end], 0 ) - first ) * sizeof( float );
    memcpy( loop->good_position + first, loop->position + first, bytes );
    memcpy( loop->good_velocity + first, loop->velocity + first, bytes );
}

static bool is_in_bounds( wisp_vec3 p )
{
    return fabsf( p.x ) <= STRANDS_BOUND && fabsf( p.y ) <= STRANDS_BOUND && fabsf( p.z ) <= STRANDS_BOUND;
}

static void restore_state( wisp_frame* frame, wisp_entity entity, check_loop* loop, float* low, int row )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    int group = 0, lane = 0;
    while ( t->group_row[group + 1] <= row )
    {
        group += 1;
    }
    while ( lane + 1 < WISP_LANES && is_in_bounds( strands_get( loop->position, row, lane ) ) &&
            is_in_bounds( strands_get( loop->velocity, row, lane ) ) )
    {
        lane += 1;
    }
    const wisp_vec3 p = strands_get( loop->position, row, lane );
    char message[300];
    snprintf(
        message, sizeof( message ),
        "entity %u: strand %d, vertex %d left its bounds in step %llu at (%g, %g, %g); the entity is put back to "
        "the step before and halted",
        entity.index, t->lane_strand[group * WISP_LANES + lane], row - t->group_row[group],
        (unsigned long long)wisp_frame_step( frame ), (double)p.x, (double)p.y, (double)p.z );
    const size_t bytes = strands_vector( t->row_count, 0 ) * sizeof( float );
    memcpy( loop->position, loop->good_position, bytes );
    memcpy( loop->velocity, loop->good_velocity, bytes );
    memset( low, 0, bytes ); // may be NaN
    wisp_frame_halt( frame, entity, message );
}

// Clear what may be NaN, so that restored strands can move again.
static void restore_tension( wisp_frame* frame, wisp_entity entity, const strands_state* state )
{
    float* tension = wisp_frame_column( frame, entity, state->tension, 0 );
    memset( tension, 0, strands_scalar( wisp_frame_strands( frame, entity )->row_count, 0 ) * sizeof( float ) );
}

static void restore_frames( wisp_frame* frame, wisp_entity entity, const strands_state* state )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    const float* position = wisp_frame_column( frame, entity, WISP_STRAND_POSITION, 0 );
    const float* clamp = wisp_frame_column( frame, entity, state->clamp, 0 );
    const float* root = wisp_frame_column( frame, entity, WISP_STRAND_ROOT, 1 );
    const float* length = wisp_frame_column( frame, entity, WISP_STRAND_LENGTH, 0 );
    const strands_section* section = wisp_frame_column( frame, entity, state->section, 0 );
    const float twist = section != NULL ? section->twist : 0.0f;
    float* frames = wisp_frame_column( frame, entity, state->curve, 0 );
    for ( int g = 0; g < t->group_count; ++g )
    {
        strands_make_frames_of_group( t, position, clamp, root, length, twist, frames, g );
    }
}

static void restore_history( wisp_frame* frame, wisp_entity entity, const strands_state* state )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    for ( int k = 0; k < 2; ++k )
    {
        memset( wisp_frame_column( frame, entity, state->history, k ), 0,
                strands_vector( t->row_count, 0 ) * sizeof( float ) );
    }
    float* step = wisp_frame_column( frame, entity, state->history, 2 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        step[strands_scalar( t->group_row[i / WISP_LANES], i % WISP_LANES )] = -1.0f;
    }
}

// An entity that is halted is left out of later passes, so all is restored here.
static void restore( wisp_frame* frame, wisp_entity entity, const strands_state* state, check_loop* loop, int row )
{
    restore_state( frame, entity, loop, wisp_frame_column( frame, entity, state->low, 0 ), row );
    if ( wisp_frame_has( frame, entity, state->tension ) )
    {
        restore_tension( frame, entity, state );
    }
    if ( wisp_frame_has( frame, entity, state->curve ) )
    {
        restore_frames( frame, entity, state );
    }
    if ( wisp_frame_has( frame, entity, state->history ) )
    {
        restore_history( frame, entity, state );
    }
}

void strands_guard( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    check_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .group_row = t->group_row,
        .in_bounds = wisp_frame_column( frame, span->entity, state->in_bounds, 0 ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 ),
        .good_position = wisp_frame_column( frame, span->entity, state->good, 0 ),
        .good_velocity = wisp_frame_column( frame, span->entity, state->good, 1 ),
    };
    atomic_init( &loop.first_bad, t->row_count );
    wisp_parallel_for( parallel, t->group_count, CHECK_GRAIN, check_groups, &loop );
    const int bad = atomic_load( &loop.first_bad );
    if ( bad < t->row_count )
    {
        restore( frame, span->entity, state, &loop, bad );
    }
    else
    {
        wisp_parallel_for( parallel, t->group_count, CHECK_GRAIN, save_state, &loop );
    }
}

// ---- definition ----

static const wisp_field STRAND_DYNAMICS_FIELDS[] = {
    WISP_CHOICE( wisp_strand_dynamics_def, stretch, WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_STRETCH_COUNT ),
    WISP_WHOLE( wisp_strand_dynamics_def, stretch_passes, 8, 1, 16 ),
    WISP_NUMBER( wisp_strand_dynamics_def, stretch_tolerance, 1e-2, 1e-6, 1, NULL ),
    WISP_CHOICE( wisp_strand_dynamics_def, integrator, WISP_INTEGRATOR_EULER, WISP_INTEGRATOR_COUNT ),
    WISP_CHOICE( wisp_strand_dynamics_def, bending, WISP_STRAND_BEND_ROD, WISP_STRAND_BEND_COUNT ),
    WISP_NUMBER( wisp_strand_dynamics_def, bend_rigidity, 8e-9, 0, 1e12, "N m^2" ),
    WISP_NUMBER( wisp_strand_dynamics_def, twist_rigidity, 6e-9, 0, 1e12, "N m^2" ),
    WISP_NUMBER( wisp_strand_dynamics_def, edgewise_rigidity, 0, 0, 1e12, "N m^2" ),
    WISP_VECTOR( wisp_strand_dynamics_def, flat_normal, 0, 1e6, NULL, 0 ),
    WISP_NUMBER( wisp_strand_dynamics_def, natural_twist, 0, -1e5, 1e5, "rad/m" ),
    WISP_SWITCH( wisp_strand_dynamics_def, free_roots, false ),
    WISP_SWITCH( wisp_strand_dynamics_def, closed, false ),
    WISP_NUMBER( wisp_strand_dynamics_def, closing_twist, 0, -1e4, 1e4, "rad" ),
    WISP_NUMBER( wisp_strand_dynamics_def, bend_damping, 0, 0, 1e3, "s" ),
    WISP_CHOICE( wisp_strand_dynamics_def, rest, WISP_STRAND_REST_SAG_FREE, WISP_STRAND_REST_COUNT ),
    WISP_SWITCH( wisp_strand_dynamics_def, clamped, true ),
    WISP_CHOICE( wisp_strand_dynamics_def, solver, WISP_SOLVER_XPBD, WISP_SOLVER_COUNT ),
    WISP_NUMBER( wisp_strand_dynamics_def, stretch_compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_strand_dynamics_def, bend_compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_strand_dynamics_def, stretch_stiffness, 1, 0, 1, NULL ),
    WISP_NUMBER( wisp_strand_dynamics_def, bend_stiffness, 0.2, 0, 1, NULL ),
    WISP_NUMBER( wisp_strand_dynamics_def, line_density, 6.5e-6, 1e-12, 1e12, "kg/m" ),
    WISP_NUMBER_OR( wisp_strand_dynamics_def, vertex_mass, 0, 1e-15, 1e12, "kg" ),
    WISP_VECTOR( wisp_strand_dynamics_def, gravity, 0, 1e6, "m/s^2", 0, -9.81, 0 ),
    WISP_NUMBER( wisp_strand_dynamics_def, damping, 3, 0, 1e9, "1/s" ),
    WISP_VECTOR( wisp_strand_dynamics_def, wind, 0, 1e5, "m/s", 0 ),
    WISP_NUMBER( wisp_strand_dynamics_def, air_density, 1.204, 0, 1e6, "kg/m^3" ),
    WISP_NUMBER( wisp_strand_dynamics_def, drag_coefficient, 0, 0, 1e6, NULL ),
    WISP_NUMBER( wisp_strand_dynamics_def, diameter, 8e-5, 1e-12, 1e6, "m" ),
    WISP_NUMBER( wisp_strand_dynamics_def, teleport, 5, 1e-6, 1e12, NULL ),
};
WISP_DEFINE( strand_dynamics_def, "strands", STRAND_DYNAMICS_FIELDS )

wisp_status strands_find( wisp_world* world, wisp_entity strands, strands_state** state )
{
    WISP_FIND_STATE( strands_state, found, world, "strands", &strands, WISP_IS_STRANDS );
    *state = found;
    return wisp_world_has( world, strands, found->settings )
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "the strands of entity %u have no dynamics", strands.index );
}

// ---- components ----

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

static wisp_status update_components( wisp_world* world, wisp_entity strands, const strands_state* s,
                                      const wisp_strand_dynamics_def* d )
{
    const float* rest = wisp_world_column( world, strands, WISP_STRAND_REST, 0 );
    const bool anchored = wisp_world_has( world, strands, s->anchor );
    const bool holds = holds_vertices( wisp_world_strands( world, strands ), rest, d );
    const bool has_section = d->edgewise_rigidity > 0.0f;
    const bool direct = d->stretch == WISP_STRAND_STRETCH_DIRECT, rod = d->bending == WISP_STRAND_BEND_ROD;
    const bool links = d->stretch == WISP_STRAND_STRETCH_LINKS, bend_links = d->bending == WISP_STRAND_BEND_LINKS;
    const bool straight = d->rest == WISP_STRAND_REST_STRAIGHT, bdf2 = d->integrator == WISP_INTEGRATOR_BDF2;
    const bool curved =
        rod && ( straight == false || has_section || strands_guides_tips( world, strands, s ) || d->closed );
    const wisp_component_use all[] = {
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
        { s->curve, curved },
        { s->balance, curved },
    };
    return wisp_world_set_components( world, strands, all, WISP_COUNT( all ) );
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
    const int32_t xpbd = d->solver == WISP_SOLVER_XPBD ? 1 : 0;
    const bool is_airless = d->drag_coefficient == 0.0f || d->air_density == 0.0f;
    wisp_world_tell( world, strands, is_airless && ( d->wind.x != 0.0f || d->wind.y != 0.0f || d->wind.z != 0.0f ),
                     "'wind' has no effect without drag_coefficient and air_density" );
    WISP_FILL( world, strands, s->closed, strands_closed, d->closing_twist );
    WISP_FILL( world, strands, s->section, strands_section,
               (float)sqrt( 1.0 - (double)d->bend_rigidity / (double)d->edgewise_rigidity ), d->natural_twist,
               d->flat_normal );
    WISP_FILL( world, strands, s->damping, float, d->damping );
    WISP_FILL( world, strands, s->air, strands_air, d->wind,
               0.5f * d->air_density * d->drag_coefficient * d->diameter );
    WISP_FILL( world, strands, s->direct, strands_direct, d->stretch_passes, d->stretch_tolerance,
               d->bending == WISP_STRAND_BEND_ROD );
    WISP_FILL( world, strands, s->links, strands_link, xpbd, d->stretch_stiffness, d->stretch_compliance );
    WISP_FILL( world, strands, s->bend_links, strands_link, xpbd, d->bend_stiffness, d->bend_compliance );
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

void strands_make_frames( wisp_world* world, wisp_entity strands, const strands_state* s )
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
        strands_make_frames_of_group( t, position, clamp, root, length, twist, frame, g );
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
    WISP_FILL( world, strands, s->pins, int32_t, pins );
    strands_cook_links( world, strands, s );
    strands_cook_rods( world, strands, s );
    strands_cook_tips( world, strands, s );
    strands_reset_rest( world, strands, s );
    forget_history( world, strands, s );
}

// ---- the call of the host ----

wisp_status wisp_set_strand_dynamics( wisp_world* world, wisp_entity strands, const wisp_strand_dynamics_def* given )
{
    wisp_strand_dynamics_def values;
    const wisp_strand_dynamics_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &strands, &wisp_strand_dynamics_def_fields, &values, given ) );
    WISP_FIND_STATE( strands_state, s, world, "strands", &strands, WISP_IS_STRANDS );
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
        strands_make_frames( world, strands, s );
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
