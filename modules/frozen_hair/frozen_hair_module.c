#include "frozen_hair_state.h"

#include <string.h>

static size_t row_floats( const wisp_strand_topology* t, int group )
{
    return (size_t)t->group_row[group] * 3 * WISP_LANES;
}

// ---- command: the event of this step ----

static bool command_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    const frozen_state* state = user;
    const frozen_settings* settings = wisp_frame_column( frame, entity, state->settings, 0 );
    return settings->pending != 0 || settings->event == WISP_FROZEN_UPDATE_FRAME;
}

static void command( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    frozen_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    frozen_event* event = wisp_frame_column( frame, span->entity, state->event, 0 );
    wisp_frozen_hair_stats* report = wisp_frame_column( frame, span->entity, state->report, 0 );
    const frozen_stroke* stroke = wisp_frame_column( frame, span->entity, state->stroke, 0 );
    event->number = stroke != NULL ? stroke->number : settings->next;
    event->points = stroke == NULL || settings->points != 0;
    memcpy( event->cursor, settings->cursor, sizeof( event->cursor ) );
    *report = ( wisp_frozen_hair_stats ){ .event = settings->next };
    settings->next += 1;
    settings->pending = 0;
    settings->points = 0;
}

// ---- start: from the rest shape, or from the moved shape ----

static void start( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const bool posed = wisp_frame_has( frame, span->entity, WISP_STRAND_POSED );
    const wisp_component base = posed ? WISP_STRAND_POSED : WISP_STRAND_REST;
    const float* from = wisp_frame_column( frame, span->entity, base, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    size_t begin = row_floats( t, span->begin ), end = row_floats( t, span->end );
    memcpy( position + begin, from + begin, ( end - begin ) * sizeof( float ) );
}

// ---- freeze: eq. 2-7 ----

static void freeze( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const frozen_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const frozen_event* event = wisp_frame_column( frame, span->entity, state->event, 0 );
    const frozen_freeze* f = wisp_frame_column( frame, span->entity, state->freeze, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_strand_jitter_args args = {
        .group_row = t->group_row,
        .lane_strand = t->lane_strand,
        .rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .stretch = wisp_frame_column( frame, span->entity, WISP_STRAND_STIFFNESS, 0 ),
        .bend = wisp_frame_column( frame, span->entity, WISP_STRAND_STIFFNESS, 1 ),
        .length_key = wisp_random_make_key( settings->seed, FROZEN_STREAM_LENGTH, event->number ),
        .angle_key = wisp_random_make_key( settings->seed, FROZEN_STREAM_ANGLE, event->number ),
        .axis_key = wisp_random_make_key( settings->seed, FROZEN_STREAM_AXIS, 0 ),
        .angle_max = f->bend_angle_max,
        .dimension = t->dimension,
        .in_plane = wisp_frame_has( frame, span->entity, state->depth ),
    };
    wisp_frame_kernels( frame )->strand_jitter( &args, span->begin, span->end );
}

// ---- align: eq. 8-13; with base stroke, strands keep their turns ----

static void align( wisp_frame* frame, const wisp_span* span, void* user )
{
    const frozen_state* state = user;
    const frozen_event* event = wisp_frame_column( frame, span->entity, state->event, 0 );
    const frozen_align* a = wisp_frame_column( frame, span->entity, state->align, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_vec3 cursor = { event->cursor[0], event->cursor[1], event->cursor[2] };
    const bool in_plane = t->dimension == 2 || wisp_frame_has( frame, span->entity, state->depth );
    wisp_strand_align_args args = {
        .group_row = t->group_row,
        .lane_count = t->lane_count,
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .intensity = wisp_frame_column( frame, span->entity, state->intensity, 0 ),
        .target = wisp_to_rows( cursor, wisp_frame_offset( frame, span->entity ) ),
        .radius = event->points ? a->reach : -1.0f,
        .nearest = a->reach_nearest != 0,
        .dimension = in_plane ? 2 : 3,
        .in_plane = in_plane,
        .swept = wisp_frame_column( frame, span->entity, state->swept, 0 ),
    };
    if ( args.swept != NULL && wisp_frame_has( frame, span->entity, WISP_STRAND_POSED ) )
    {
        const frozen_stroke* stroke = wisp_frame_column( frame, span->entity, state->stroke, 0 );
        args.rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 );
        args.moved = wisp_frame_column( frame, span->entity, WISP_STRAND_POSED, 0 );
        memcpy( args.turn, stroke->turn, sizeof( args.turn ) );
    }
    wisp_frame_kernels( frame )->strand_align( &args, span->begin, span->end );
}

// ---- declaration ----

#define FROZEN_LIST( member, name, table, columns )                                                                  \
    static const wisp_column_def member##_columns[] = { columns( WISP_COLUMN_DEF ) };
FROZEN_COMPONENTS( FROZEN_LIST )
#undef FROZEN_LIST

static wisp_status declare_stages( wisp_registry* r, frozen_state* s )
{
    const wisp_pass passes[] = {
        {
            .name = "frozen_hair.command",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->settings },
            .reads = { s->settings },
            .writes = { s->event },
            .run = command,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .should_run = command_is_due,
        },
        {
            .name = "frozen_hair.start",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, WISP_STRAND_REST },
            .reads = { s->event, WISP_STRAND_REST },
            .writes = { WISP_STRAND_POSITION },
            .run = start,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            .name = "frozen_hair.freeze",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->freeze },
            .reads = { s->event, WISP_STRAND_STIFFNESS, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .run = freeze,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            .name = "frozen_hair.depth",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->freeze, s->depth },
            .reads = { s->event, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .run = frozen_limit_depth,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            .name = "frozen_hair.align",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->align },
            .excluded = { s->swept },
            .reads = { s->event, s->intensity, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION },
            .run = align,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            // It reads the moved shape too, where there is one. Positions put it behind the start, which waits for what moves it.
            .name = "frozen_hair.turn",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->align, s->swept },
            .reads = { s->event, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { s->stroke },
            .run = frozen_find_turn,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            .name = "frozen_hair.stroke",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->align, s->swept },
            .reads = { s->event, s->stroke, s->intensity, WISP_STRAND_REST, WISP_STRAND_POSITION },
            .writes = { s->swept, WISP_STRAND_POSITION },
            .run = align,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
        {
            .name = "frozen_hair.clump",
            .stage = WISP_STAGE_SHAPE,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->clump },
            .reads = { s->event, WISP_STRAND_POSITION },
            .writes = { WISP_STRAND_POSITION, s->report },
            .run = frozen_clump_run,
            .detail = WISP_PASS_WITHOUT_MOTION,
            .on_change = s->event,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static wisp_status declare( wisp_registry* r )
{
    frozen_state* s = wisp_declare_state( r, sizeof( frozen_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
#define FROZEN_DECLARE( member, name, table, columns )                                                               \
    s->member = wisp_declare_component(                                                                              \
        r, &( wisp_component_def ){ name, table, member##_columns, WISP_COUNT( member##_columns ) } );
    FROZEN_COMPONENTS( FROZEN_DECLARE )
#undef FROZEN_DECLARE
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->settings, frozen_settings, base, 0, WISP_FROZEN_BASE_COUNT - 1 ),
        WISP_MEMBER_RANGE( s->settings, frozen_settings, event, 0, WISP_FROZEN_UPDATE_COUNT - 1 ),
        WISP_MEMBER_RANGE( s->settings, frozen_settings, pending, 0, 1 ),
        WISP_MEMBER_RANGE( s->settings, frozen_settings, points, 0, 1 ),
        WISP_MEMBER_RANGE( s->event, frozen_event, points, 0, 1 ),
        WISP_MEMBER_RANGE( s->align, frozen_align, reach_nearest, 0, 1 ),
        WISP_MEMBER_RANGE( s->clump, frozen_clump, iterations, 0, 1000 ),
        WISP_MEMBER_RANGE( s->clump, frozen_clump, brakes, 0, 1 ),
        WISP_MEMBER_RANGE( s->clump, frozen_clump, neighbour_limit, 1, 4096 ),
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    s->workspace = wisp_declare_workspace( r, frozen_clump_workspace_size(), frozen_clump_workspace_release,
                                           frozen_clump_workspace_bytes );
    return s->workspace < 0 ? WISP_NO_MEMORY : declare_stages( r, s );
}

const wisp_module wisp_frozen_hair_module = { .name = "frozen_hair", .declare = declare };
