// Components and passes of balloons, and calls of the host.
#include "balloon_internal.h"

#include "wisp/module/sleep.h"

#include <math.h>

BALLOON_COMPONENTS( WISP_COMPONENT_COLUMNS )

// ---- components and passes ----

static wisp_status declare_components( wisp_registry* r, balloon_state* s )
{
    BALLOON_COMPONENTS( WISP_COMPONENT_DECLARE )
    const wisp_index_range ranges[] = {
        { .component = s->open_edge, .kind = WISP_INDEX_SAME },
        { .component = s->open_edge, .column = 1, .kind = WISP_INDEX_SAME },
        { .component = s->outlet,
          .offset = offsetof( balloon_outlet, slots ),
          .count = WISP_BALLOON_MAX_OUTLET,
          .kind = WISP_INDEX_ROW,
          .table = WISP_TABLE_PARTICLE },
        WISP_MEMBER_RANGE( s->outlet, balloon_outlet, count, 0, WISP_BALLOON_MAX_OUTLET ),
        WISP_MEMBER_RANGE( s->outlet, balloon_outlet, jet_starts, 0, INT32_MAX ),
        WISP_MEMBER_RANGE( s->outlet, balloon_outlet, open, 0, 1 ),
        WISP_MEMBER_RANGE( s->outlet, balloon_outlet, running, 0, 1 ),
    };
    return wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) );
}

// In order: geometry, control, pressure and outlet, then the passes that change velocities. Statistics and drag come before all
// passes that change velocities, because both depend on the velocity at the start of the substep. No pass reads or writes the
// open edges as a component, because a closed mesh has none.
static wisp_status declare_passes( wisp_registry* r, balloon_state* s )
{
    const wisp_component x = WISP_PARTICLE_POSITION, v = WISP_PARTICLE_VELOCITY, g = WISP_PARTICLE_GRAVITY;
    const wisp_pass passes[] = {
        { .name = "balloon.measure",
          .stage = WISP_STAGE_FORCE,
          .required = { s->gas },
          .reads = { x, s->gas },
          .writes = { s->rings, s->extent },
          .run = balloon_measure },
        { .name = "balloon.body",
          .stage = WISP_STAGE_FORCE,
          .required = { s->gas },
          .reads = { x, v },
          .writes = { s->body },
          .run = balloon_measure_body },
        { .name = "balloon.inflate",
          .stage = WISP_STAGE_FORCE,
          .required = { s->inflation },
          .reads = { s->inflation, s->gas },
          .writes = { s->gas },
          .run = balloon_inflate },
        { .name = "balloon.pressure",
          .stage = WISP_STAGE_FORCE,
          .required = { s->gas },
          .excluded = { WISP_SURFACE_ELASTIC },
          .reads = { x, s->extent, s->skin },
          .writes = { s->gauge },
          .run = balloon_read_pressure },
        { .name = "balloon.membrane_pressure",
          .stage = WISP_STAGE_FORCE,
          .required = { s->gas, WISP_SURFACE_ELASTIC },
          .reads = { s->extent, WISP_SURFACE_VIRIAL },
          .writes = { s->gauge },
          .run = balloon_read_pressure },
        { .name = "balloon.outlet",
          .stage = WISP_STAGE_FORCE,
          .required = { s->outlet },
          .reads = { x, s->gas, s->gauge, s->rings, s->outlet },
          .writes = { s->outlet, s->gas, s->jet },
          .run = balloon_let_out },
        { .name = "balloon.stats",
          .stage = WISP_STAGE_FORCE,
          .required = { s->gas },
          .reads = { x, v, s->gas, s->extent, s->rings, s->gauge, s->body },
          .writes = { s->stats },
          .run = balloon_take_stats },
        {
            WISP_PASS( "balloon.drag", FORCE, PARTICLE_BLOCK, balloon_drag ),
            .required = { s->air },
            .reads = { x, v, s->air, s->rings },
            .writes = { v },
        },
        {
            WISP_PASS( "balloon.buoyancy", FORCE, PARTICLE_BLOCK, balloon_float ),
            .required = { s->buoyancy, g },
            .reads = { x, v, g, s->gas, s->extent, s->body },
            .writes = { v },
        },
        {
            WISP_PASS( "balloon.jet", FORCE, PARTICLE_BLOCK, balloon_jet ),
            .required = { s->outlet },
            .reads = { x, v, s->jet, s->outlet, s->body },
            .writes = { v },
        },
        {
            WISP_PASS( "balloon.spin", FORCE, PARTICLE_BLOCK, balloon_kick ),
            .required = { s->outlet },
            .reads = { x, v, s->jet, s->outlet, s->body },
            .writes = { v },
        },
        { .name = "balloon.volume",
          .stage = WISP_STAGE_PROJECT,
          .required = { s->gas, s->volume },
          .reads = { x, s->gas, s->volume },
          .writes = { x, s->gas },
          .run = balloon_project_volume },
        { .name = "balloon.angular",
          .stage = WISP_STAGE_PROJECT,
          .required = { s->gas },
          .reads = { x, v, WISP_PARTICLE_PREVIOUS },
          .writes = { x },
          .run = balloon_keep_angular },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

// As wisp_sleep_hooks.surroundings: a balloon that is filled, or whose outlet is open, changes by itself.
static bool find_surroundings( const void* memory, wisp_world* world, wisp_entity entity,
                               const wisp_sleep_bounds* bounds, uint64_t* hash )
{
    (void)bounds;
    (void)hash;
    const balloon_state* state = memory;
    const float* rate = wisp_world_rows( world, entity, state->inflation, 0 );
    const balloon_outlet* outlet = wisp_world_rows( world, entity, state->outlet, 0 );
    return ( rate == NULL || *rate == 0.0f ) && ( outlet == NULL || outlet->open == 0 );
}

static wisp_status declare( wisp_registry* r )
{
    balloon_state* state = wisp_declare_state( r, sizeof( balloon_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){ .sleep = &( wisp_sleep_hooks ){ .surroundings = find_surroundings } } );
    WISP_TRY( declare_components( r, state ) );
    for ( wisp_component map = WISP_MAP_STRETCH_COMPLIANCE; map <= WISP_MAP_BEND_STIFFNESS; ++map )
    {
        wisp_declare_map( r, map, state->skin,
                          "the skin of a balloon has one stiffness, which its pressure is read from" );
    }
    return declare_passes( r, state );
}

const wisp_module wisp_balloon_module = { .name = "balloon", .declare = declare };

// ---- public functions ----

static wisp_status find_balloon( wisp_world* world, wisp_entity balloon, const balloon_state** out )
{
    WISP_FIND_STATE( const balloon_state, state, world, "balloon", &balloon, WISP_IS_SURFACE );
    *out = state;
    return wisp_world_has( world, balloon, state->gas )
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "entity %u: is not a balloon", balloon.index );
}

wisp_status wisp_set_balloon_gas_ratio( wisp_world* world, wisp_entity balloon, float fill_fraction )
{
    const balloon_state* state;
    WISP_TRY( find_balloon( world, balloon, &state ) );
    balloon_gas* gas = wisp_world_column( world, balloon, state->gas, 0 );
    double least = gas->min_volume / gas->rest_volume;
    if ( !( (double)fill_fraction >= least * ( 1.0 - 1e-6 ) && fill_fraction <= 1e6f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "balloon: gas_ratio: got %g, expected %g to 1e6",
                                (double)fill_fraction, least );
    }
    gas->target_volume = fmax( (double)fill_fraction * gas->rest_volume, gas->min_volume );
    return WISP_OK;
}

wisp_status wisp_set_balloon_inflation( wisp_world* world, wisp_entity balloon, float rate )
{
    const balloon_state* state;
    WISP_TRY( find_balloon( world, balloon, &state ) );
    WISP_TRY( wisp_world_check_values( world, &wisp_balloon_def_fields, "inflation_rate", &rate, 1, NULL ) );
    return wisp_world_set_row( world, balloon, state->inflation, rate != 0.0f ? &rate : NULL, sizeof( rate ) );
}

wisp_status wisp_open_balloon( wisp_world* world, wisp_entity balloon, bool open )
{
    const balloon_state* state;
    WISP_TRY( find_balloon( world, balloon, &state ) );
    balloon_outlet* outlet = wisp_world_column( world, balloon, state->outlet, 0 );
    if ( outlet == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "balloon: entity %u has no outlet", balloon.index );
    }
    outlet->open = open ? 1 : 0;
    return WISP_OK;
}

wisp_status wisp_request_balloon_stats( wisp_world* world, wisp_entity balloon, bool requested )
{
    const balloon_state* state;
    WISP_TRY( find_balloon( world, balloon, &state ) );
    return wisp_world_request( world, balloon, state->stats, requested );
}

wisp_status wisp_read_balloon_stats( wisp_world* world, wisp_entity balloon, wisp_balloon_stats* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    const balloon_state* state;
    WISP_TRY( find_balloon( world, balloon, &state ) );
    const wisp_balloon_stats* stats = wisp_world_column( world, balloon, state->stats, 0 );
    if ( stats == NULL || stats->rest_volume == 0.0 )
    {
        return wisp_world_fail(
            world, WISP_CONFLICT,
            "balloon: entity %u has no statistics: request them with wisp_request_balloon_stats, then step",
            balloon.index );
    }
    *out = *stats;
    return WISP_OK;
}
