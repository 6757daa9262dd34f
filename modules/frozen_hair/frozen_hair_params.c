// Parameters: defaults, ranges, columns.
#include "frozen_hair_state.h"

#include <math.h>
#include <string.h>

// A length of -1 is by the radius, or no limit.
static const wisp_field FROZEN_HAIR_FIELDS[] = {
    WISP_SWITCH( wisp_frozen_hair_def, freeze, true ),
    WISP_SWITCH( wisp_frozen_hair_def, align, true ),
    WISP_SWITCH( wisp_frozen_hair_def, clump, true ),
    WISP_SEED( wisp_frozen_hair_def, seed, 1 ),
    WISP_CHOICE( wisp_frozen_hair_def, base, WISP_FROZEN_BASE_REST, WISP_FROZEN_BASE_COUNT ),
    WISP_CHOICE( wisp_frozen_hair_def, update_on, WISP_FROZEN_UPDATE_HAIR_EVENT, WISP_FROZEN_UPDATE_COUNT ),
    WISP_NUMBER( wisp_frozen_hair_def, stretch_stiffness, 7, 1e-3, 1e12, NULL ),
    WISP_NUMBER( wisp_frozen_hair_def, bend_stiffness, 7, 1e-3, 1e12, NULL ),
    WISP_NUMBER( wisp_frozen_hair_def, max_bend_angle, 0.785398163, 0, 3.14159265358979, "rad" ),
    WISP_NUMBER( wisp_frozen_hair_def, intensity, 0.8, 0, 1, NULL ),
    WISP_POINT( wisp_frozen_hair_def, cursor, -1e6, 1e6, "m", 0 ),
    WISP_NUMBER( wisp_frozen_hair_def, reach, 0.15, 0, 1e7, "m" ),
    WISP_SWITCH( wisp_frozen_hair_def, reach_nearest, false ),
    WISP_NUMBER( wisp_frozen_hair_def, clump_radius, 0.01, 1e-6, 1e6, "m" ),
    WISP_WHOLE( wisp_frozen_hair_def, clump_iterations, 4, 0, 1000 ),
    WISP_NUMBER_OR( wisp_frozen_hair_def, clump_step_length, -1, 0, 1e3, "m" ),
    WISP_CHOICE( wisp_frozen_hair_def, gap, WISP_GAP_ABSOLUTE, WISP_GAP_COUNT ),
    WISP_NUMBER_OR( wisp_frozen_hair_def, min_distance, -1, 0, 1e6, "m" ),
    WISP_NUMBER( wisp_frozen_hair_def, min_lambda, 0, 0, 1, NULL ),
    WISP_WHOLE( wisp_frozen_hair_def, max_neighbours, 256, 1, 4096 ),
    WISP_NUMBER_OR( wisp_frozen_hair_def, max_depth_change, -1, 0, 1e6, "m" ),
};
WISP_DEFINE( frozen_hair_def, "frozen hair", FROZEN_HAIR_FIELDS )

// ---- ranges ----

static wisp_status check_strands( wisp_world* world, const wisp_frozen_hair_def* d, int count )
{
    const wisp_fields* f = &wisp_frozen_hair_def_fields;
    WISP_TRY(
        wisp_world_check_values( world, f, "stretch_stiffness", d->strand_stretch_stiffness, count, "strand" ) );
    WISP_TRY( wisp_world_check_values( world, f, "bend_stiffness", d->strand_bend_stiffness, count, "strand" ) );
    return wisp_world_check_values( world, f, "intensity", d->strand_intensity, count, "strand" );
}

// ---- into columns ----

// Write one number for all strands, or one per strand. Lanes without a strand get the common number, which is in range.
static void fill_lanes( const wisp_strand_topology* t, float common, const float* own, float* lanes )
{
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        int strand = t->lane_strand[i];
        lanes[i] = own != NULL && strand >= 0 ? own[strand] : common;
    }
}

static wisp_status attach_all( wisp_world* world, wisp_entity entity, const frozen_state* s,
                               const wisp_frozen_hair_def* d )
{
    const wisp_component_use uses[] = {
        { s->settings, true },
        { s->event, true },
        { s->report, true },
        { s->freeze, d->freeze },
        { s->align, d->align },
        { s->intensity, d->align },
        { s->stroke, d->base == WISP_FROZEN_BASE_STROKE },
        { s->swept, d->base == WISP_FROZEN_BASE_STROKE && d->align },
        { s->clump, d->clump && d->clump_iterations > 0 },
        { s->depth, d->max_depth_change >= 0.0f },
        { WISP_STRAND_STIFFNESS, true }, // the last: without freeze it stays, because another module may drive it
    };
    return wisp_world_set_components( world, entity, uses, WISP_COUNT( uses ) - ( d->freeze ? 0 : 1 ) );
}

static void write_stages( wisp_world* world, wisp_entity entity, const frozen_state* s,
                          const wisp_frozen_hair_def* d )
{
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    WISP_FILL( world, entity, s->freeze, frozen_freeze, d->max_bend_angle );
    WISP_FILL( world, entity, s->align, frozen_align, d->reach, d->reach_nearest );
    WISP_FILL( world, entity, s->depth, frozen_depth, d->max_depth_change );
    WISP_FILL( world, entity, s->clump, frozen_clump, .radius = d->clump_radius,
               .step = d->clump_step_length == -1.0f ? 0.1f * d->clump_radius : d->clump_step_length,
               .distance_min = d->min_distance == -1.0f ? 0.02f * d->clump_radius : d->min_distance,
               .lambda_min = d->min_lambda, .iterations = d->clump_iterations,
               .brakes = d->gap == WISP_GAP_ABSOLUTE ? 1 : 0, .neighbour_limit = d->max_neighbours );
    if ( d->freeze )
    {
        fill_lanes( t, d->stretch_stiffness, d->strand_stretch_stiffness,
                    wisp_world_column( world, entity, WISP_STRAND_STIFFNESS, 0 ) );
        fill_lanes( t, d->bend_stiffness, d->strand_bend_stiffness,
                    wisp_world_column( world, entity, WISP_STRAND_STIFFNESS, 1 ) );
    }
    if ( d->align )
    {
        fill_lanes( t, d->intensity, d->strand_intensity, wisp_world_column( world, entity, s->intensity, 0 ) );
    }
}

// Strands are as at rest until a command reaches them. Without base stroke there is nothing to begin.
static void begin_stroke( wisp_world* world, wisp_entity entity, const frozen_state* s, uint64_t number )
{
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    float* swept = wisp_world_column( world, entity, s->swept, 0 );
    WISP_FILL( world, entity, s->stroke, frozen_stroke, .number = number, .turn = { 0.0f, 0.0f, 0.0f, 1.0f } );
    if ( swept != NULL )
    {
        memset( swept, 0, (size_t)t->group_count * 4 * WISP_LANES * sizeof( float ) );
    }
}

wisp_status wisp_set_frozen_hair( wisp_world* world, wisp_entity strands, const wisp_frozen_hair_def* given )
{
    wisp_frozen_hair_def values;
    const wisp_frozen_hair_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &strands, &wisp_frozen_hair_def_fields, &values, given ) );
    WISP_FIND_STATE( const frozen_state, s, world, "frozen_hair", &strands, WISP_IS_STRANDS );
    const bool goes_on = wisp_world_has( world, strands, s->stroke );
    WISP_TRY( check_strands( world, def, wisp_world_strands( world, strands )->strand_count ) );
    WISP_TRY( attach_all( world, strands, s, def ) );
    frozen_settings* settings = wisp_world_column( world, strands, s->settings, 0 );
    *settings = ( frozen_settings ){
        .seed = def->seed,
        .base = (int32_t)def->base,
        .event = (int32_t)def->update_on,
        .pending = 1,
        .next = settings->next,
        .cursor = { def->cursor.x, def->cursor.y, def->cursor.z },
    };
    write_stages( world, strands, s, def );
    wisp_world_tell( world, strands, ( def->freeze || def->align || def->clump ) == false,
                     "'frozen_hair' has no effect without freeze, align or clump" );
    if ( def->base == WISP_FROZEN_BASE_STROKE && goes_on == false )
    {
        begin_stroke( world, strands, s, settings->next );
    }
    return WISP_OK;
}

// ---- commands and reports ----

static wisp_status find_settings( wisp_world* world, wisp_entity strands, const frozen_state** state,
                                  frozen_settings** out )
{
    WISP_FIND_STATE( const frozen_state, s, world, "frozen_hair", &strands, 0 );
    *state = s;
    *out = wisp_world_column( world, strands, s->settings, 0 );
    return *out != NULL ? WISP_OK
                        : wisp_world_fail( world, WISP_CONFLICT, "entity %u: has no frozen hair", strands.index );
}

static wisp_status point_at( wisp_world* world, wisp_entity strands, wisp_vec3 cursor, const uint64_t* event )
{
    const frozen_state* s;
    frozen_settings* settings;
    WISP_TRY( find_settings( world, strands, &s, &settings ) );
    if ( !( fabsf( cursor.x ) <= 1e6f && fabsf( cursor.y ) <= 1e6f && fabsf( cursor.z ) <= 1e6f ) )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "frozen hair: cursor: got (%g, %g, %g), expected finite coordinates within 1e6 m of the origin",
            (double)cursor.x, (double)cursor.y, (double)cursor.z );
    }
    settings->cursor[0] = cursor.x;
    settings->cursor[1] = cursor.y;
    settings->cursor[2] = cursor.z;
    settings->pending = 1;
    settings->points = 1;
    if ( event != NULL )
    {
        settings->next = *event;
        begin_stroke( world, strands, s, *event );
    }
    return WISP_OK;
}

wisp_status wisp_command_frozen_hair( wisp_world* world, wisp_entity strands, wisp_vec3 cursor )
{
    return point_at( world, strands, cursor, NULL );
}

wisp_status wisp_begin_frozen_hair_stroke( wisp_world* world, wisp_entity strands )
{
    const frozen_state* s;
    frozen_settings* settings;
    WISP_TRY( find_settings( world, strands, &s, &settings ) );
    if ( settings->base != WISP_FROZEN_BASE_STROKE )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "entity %u: the base of its frozen hair is not 'stroke'",
                                strands.index );
    }
    begin_stroke( world, strands, s, settings->next );
    settings->pending = 1;
    return WISP_OK;
}

wisp_status wisp_replay_frozen_hair( wisp_world* world, wisp_entity strands, wisp_vec3 cursor, uint64_t event )
{
    return point_at( world, strands, cursor, &event );
}

wisp_status wisp_read_frozen_hair_stats( wisp_world* world, wisp_entity strands, wisp_frozen_hair_stats* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    const frozen_state* s;
    frozen_settings* settings;
    WISP_TRY( find_settings( world, strands, &s, &settings ) );
    *out = *(const wisp_frozen_hair_stats*)wisp_world_column( world, strands, s->report, 0 );
    return WISP_OK;
}
