// The module: components, and the passes that depend on their presence.
#include "strand_passes.h"
#include "strands_state.h"

STRANDS_COMPONENTS( WISP_COMPONENT_COLUMNS )

// Declare the passes before the substeps: the head, and what depends on the length of a substep.
static wisp_status declare_input( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "strands.head", INPUT, ENTITY, strands_move_head ),
            .required = { s->settings, s->head },
            .reads = { s->settings, s->head },
            .writes = { s->head },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "strands.reach", INPUT, ENTITY, strands_find_reach ),
            .required = { s->settings, WISP_STRAND_REACH },
            .reads = { s->settings, WISP_STRAND_REACH, WISP_STRAND_LENGTH, WISP_STRAND_ROOT },
            .writes = { WISP_STRAND_REACH }, .foreign = { s->head }, // its own, if it has one
        },
        {
            WISP_PASS( "strands.tip_targets", INPUT, ENTITY, strands_move_tips ),
            .required = { s->tips },
            .reads = { s->tips },
            .writes = { s->tips },
        },
        {
            WISP_PASS( "strands.frame", INPUT, ENTITY, strands_move_frame ),
            .required = { s->settings, WISP_PARTICLE_FRAME },
            .reads = { WISP_PARTICLE_FRAME },
            .writes = { WISP_PARTICLE_FRAME },
        },
        {
            WISP_PASS( "strands.slow", INPUT, STRAND_GROUP, strands_slow ),
            .required = { wisp_detail_component( r ), s->settings },
            .reads = { wisp_detail_component( r ), WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_VELOCITY },
            .should_run = strands_slow_is_due,
        },
        {
            WISP_PASS( "strands.factor", INPUT, STRAND_GROUP, strands_factor ),
            .required = { s->settings, s->rod, s->clamp },
            .reads = { s->settings, s->clamp, WISP_STRAND_INVERSE_MASS, WISP_STRAND_LENGTH },
            .writes = { s->rod, s->clamp },
            .should_run = strands_factor_is_due,
        },
        {
            WISP_PASS( "strands.rest", INPUT, STRAND_GROUP, strands_balance_rest ),
            .required = { s->settings, s->curve, s->balance },
            .reads = { s->settings, s->rod, s->clamp, s->curve, s->balance, WISP_STRAND_REST,
                       WISP_STRAND_INVERSE_MASS, WISP_STRAND_LENGTH },
            .writes = { s->curve, s->balance },
            .should_run = strands_balance_is_due,
        },
        {
            WISP_PASS( "strands.grid", INPUT, ENTITY, strands_mix ),
            .required = { s->grid },
            .reads = { s->grid, WISP_STRAND_REST, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY,
                       WISP_STRAND_INVERSE_MASS },
            .writes = { s->grid, WISP_STRAND_VELOCITY },
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

// From here to the velocities all passes run over groups of strands and are always due, so that a group runs all of
// its substeps before the next one.
static wisp_status declare_roots( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "strands.carry", FORCE, STRAND_GROUP, strands_add_frame_motion ),
            .required = { s->settings, WISP_PARTICLE_FRAME },
            .reads = { WISP_PARTICLE_FRAME, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.teleport", FORCE, STRAND_GROUP, strands_jump ),
            .required = { s->head },
            .reads = { s->head, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "strands.teleport_frames", FORCE, STRAND_GROUP, strands_jump_frames ),
            .required = { s->head, s->curve },
            .reads = { s->head, s->curve },
            .writes = { s->curve },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "strands.roots", FORCE, STRAND_GROUP, strands_root ),
            .required = { s->head },
            .reads = { s->head, WISP_STRAND_REST },
            .writes = { WISP_STRAND_ROOT },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "strands.anchors", FORCE, STRAND_GROUP, strands_anchor ),
            .required = { s->settings, s->surface, s->anchor },
            .reads = { s->settings, s->surface, s->anchor, s->low, WISP_STRAND_ROOT, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_ROOT, s->anchor, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .follows = true, // its surface
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "strands.anchor_frames", FORCE, STRAND_GROUP, strands_anchor_frames ),
            .required = { s->anchor, s->curve },
            .reads = { s->anchor, s->curve },
            .writes = { s->curve },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "strands.pins", FORCE, STRAND_GROUP, strands_hold_pins ),
            .required = { s->pins },
            .reads = { s->pins, s->low, WISP_STRAND_REST, WISP_STRAND_INVERSE_MASS, WISP_STRAND_ROOT,
                       WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.tips", FORCE, STRAND_GROUP, strands_hold_tips ),
            .required = { s->tips },
            .reads = { s->tips, s->low, WISP_STRAND_REST, WISP_STRAND_ROOT, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.tip_frames", FORCE, STRAND_GROUP, strands_turn_tips ),
            .required = { s->tips, s->tip_rows, s->curve },
            .reads = { s->tips, s->curve, WISP_STRAND_ROOT },
            .writes = { s->tip_rows, s->curve },
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static wisp_status declare_forces( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "strands.extrapolate", FORCE, STRAND_GROUP, strands_extrapolate ),
            .required = { s->history },
            .reads = { s->history, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_VELOCITY },
            .writes = { s->history, s->low, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.damping", FORCE, STRAND_GROUP, strands_damp ),
            .required = { s->damping, s->head },
            .reads = { s->damping, s->head, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_INVERSE_MASS },
            .writes = { WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.damping_anchored", FORCE, STRAND_GROUP, strands_damp_anchored ),
            .required = { s->damping, s->anchor },
            .reads = { s->damping, WISP_STRAND_ROOT, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY,
                       WISP_STRAND_INVERSE_MASS },
            .writes = { WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.air", FORCE, STRAND_GROUP, strands_drag ),
            .required = { s->air },
            .reads = { s->air, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_INVERSE_MASS,
                       WISP_STRAND_LENGTH },
            .writes = { WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.predict", PREDICT, STRAND_GROUP, strands_predict ),
            .required = { s->settings, s->low },
            .reads = { s->settings, s->low, WISP_STRAND_ROOT, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_PREVIOUS },
        },
        {
            WISP_PASS( "strands.carry_pins", PREDICT, STRAND_GROUP, strands_subtract_frame_motion ),
            .required = { s->settings, WISP_PARTICLE_FRAME },
            .reads = { WISP_PARTICLE_FRAME, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_VELOCITY },
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

// Declare the rod twice: with rest curvature it has frames, a straight one has none. An entity has one of the two.
static wisp_status declare_rods( wisp_registry* r, strands_state* s )
{
    wisp_pass rod = {
        WISP_PASS( "strands.rod", PREDICT, STRAND_GROUP, strands_bend ),
        .required = { s->settings, s->rod, s->tension },
        .excluded = { s->curve },
        .reads = { s->settings, s->rod, s->clamp, s->tension, s->low, WISP_STRAND_ROOT, WISP_STRAND_INVERSE_MASS,
                   WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        .writes = { WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_PREVIOUS },
        .user = s,
    };
    const wisp_status status = wisp_declare_pass( r, &rod );
    rod.name = "strands.rod_curved";
    rod.required[3] = s->curve;
    rod.excluded[0] = 0;
    rod.reads[10] = s->curve;
    rod.reads[11] = s->balance;
    rod.writes[3] = s->curve;
    rod.writes[4] = s->tension;
    rod.run = strands_bend_curved;
    return status == WISP_OK ? wisp_declare_pass( r, &rod ) : status;
}

static wisp_status declare_lengths( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "strands.bend_links", PROJECT, STRAND_GROUP, strands_bend_link ),
            .required = { s->bend_links, s->bend_link },
            .reads = { s->bend_links, s->bend_link, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_PREVIOUS,
                       WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->bend_link, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.links", PROJECT, STRAND_GROUP, strands_link_rows ),
            .required = { s->links, s->stretch_link },
            .reads = { s->links, s->stretch_link, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_PREVIOUS,
                       WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->stretch_link, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.stretch", PROJECT, STRAND_GROUP, strands_stretch ),
            .required = { s->direct, s->tension },
            .reads = { s->direct, s->tension, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_LENGTH,
                       WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->tension, s->low, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.velocity", VELOCITY, STRAND_GROUP, strands_read_velocity ),
            .required = { s->settings },
            .reads = { s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_VELOCITY },
        },
        {
            WISP_PASS( "strands.max_speed", VELOCITY, STRAND_GROUP, strands_limit_speed ),
            .required = { s->settings, WISP_PARTICLE_MAX_SPEED },
            .reads = { WISP_PARTICLE_MAX_SPEED, WISP_STRAND_INVERSE_MASS, WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_VELOCITY },
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

// Declare the fused pass. With other kinds of lengths, contacts or more iterations the passes run one by one.
static wisp_status declare_substeps( wisp_registry* r, strands_state* s )
{
    const wisp_fusion join = {
        .name = "strands.substeps",
        .required = { "strands.predict", "strands.stretch", "strands.velocity" },
        .allowed = { "strands.teleport", "strands.teleport_frames", "strands.roots", "strands.anchors",
                     "strands.anchor_frames", "strands.pins", "strands.tips", "strands.tip_frames",
                     "strands.extrapolate", "strands.damping", "strands.damping_anchored", "strands.air",
                     "strands.rod", "strands.rod_curved", "strands.bend_links" },
        .run = strands_substeps,
        .user = s,
    };
    return wisp_declare_fusion( r, &join );
}

static wisp_status declare_guard( wisp_registry* r, strands_state* s )
{
    const wisp_pass pass = {
        WISP_PASS( "strands.state_check", CHECK, ENTITY, strands_guard ),
        .required = { s->good, s->in_bounds },
        .reads = { s->good, s->in_bounds, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        .writes = { s->good, s->in_bounds, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        .user = s,
    };
    return wisp_declare_pass( r, &pass );
}

static wisp_status declare_stats( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            WISP_PASS( "strands.motion_stats", OBSERVE, ENTITY, strands_compute_motion_stats ),
            .required = { s->settings },
            .reads = { s->settings, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_INVERSE_MASS,
                       WISP_STRAND_LENGTH },
            .writes = { WISP_MOTION_STATS },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            WISP_PASS( "strands.strain", OBSERVE, STRAND_GROUP, strands_scatter_strain ),
            .required = { s->settings },
            .reads = { WISP_STRAND_POSITION, WISP_STRAND_LENGTH },
            .writes = { WISP_POINT_STRAIN },
        },
        {
            WISP_PASS( "strands.speed", OBSERVE, STRAND_GROUP, strands_scatter_speed ),
            .required = { s->settings },
            .reads = { WISP_STRAND_VELOCITY },
            .writes = { WISP_POINT_SPEED },
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static wisp_status declare_indices( wisp_registry* r, const strands_state* s )
{
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->settings, strands_settings, rest, 0, WISP_STRAND_REST_COUNT - 1 ),
        WISP_MEMBER_RANGE( s->settings, strands_settings, clamped, 0, 1 ),
        WISP_MEMBER_RANGE( s->settings, strands_settings, is_free, 0, 1 ),
        WISP_MEMBER_RANGE( s->head, strands_head, jumped, 0, STRANDS_STOPPED ),
        WISP_MEMBER_RANGE( s->head, strands_head, is_still, 0, 1 ),
        WISP_MEMBER_RANGE( s->direct, strands_direct, passes, 1, 16 ),
        WISP_MEMBER_RANGE( s->direct, strands_direct, has_rod, 0, 1 ),
        WISP_MEMBER_RANGE( s->links, strands_link, xpbd, 0, 1 ),
        WISP_MEMBER_RANGE( s->bend_links, strands_link, xpbd, 0, 1 ),
        WISP_COLUMN_RANGE( s->pins, 0, 0, INT32_MAX ),
        WISP_COLUMN_RANGE( s->in_bounds, 0, 0, 1 ),
        WISP_COLUMN_RANGE( s->tips, 0, 0, WISP_STRAND_TIP_COUNT - 1 ),
        { .component = s->surface, .kind = WISP_INDEX_SURFACE },
        { .component = s->anchor, .kind = WISP_INDEX_TRIANGLE, .surface = s->surface },
    };
    return wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) );
}

static wisp_status declare( wisp_registry* r )
{
    strands_state* s = wisp_declare_state( r, sizeof( strands_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    s->registry = r;
    wisp_declare_hooks( r,
                        &( wisp_state_hooks ){ .removed = strands_entity_removed,
                                               .teleported = strands_teleported,
                                               .lines = strands_add_frames,
                                               .sleep = &( wisp_sleep_hooks ){ .surroundings = strands_surroundings,
                                                                               .rested = strands_rested } } );
    STRANDS_COMPONENTS( WISP_COMPONENT_DECLARE )
    wisp_declare_low( r, WISP_STRAND_POSITION, 0, s->low, 0 );
    wisp_declare_low( r, WISP_STRAND_ROOT, 0, WISP_STRAND_ROOT, 2 );
    wisp_declare_places( r, s->head, 0, WISP_PLACE_POSES );
    wisp_declare_places( r, s->good, 0, WISP_PLACE_LANES );
    wisp_declare_places( r, s->anchor, 3, WISP_PLACE_LANES );
    WISP_TRY( declare_indices( r, s ) );
    s->workspace = wisp_declare_workspace( r, strands_grid_workspace_size(), strands_grid_workspace_release,
                                           strands_grid_workspace_bytes );
    s->lent_rows = wisp_declare_workspace( r, strands_lent_rows_size(), NULL, NULL );
    if ( s->workspace < 0 || s->lent_rows < 0 )
    {
        return WISP_NO_MEMORY;
    }
    typedef wisp_status declare_fn( wisp_registry * registry, strands_state * state );
    // the order among equals: in PROJECT lengths come last
    static declare_fn* const ALL[] = { declare_input,   declare_roots,    declare_forces, declare_rods,
                                       declare_lengths, declare_substeps, declare_guard,  declare_stats };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( ALL ) && status == WISP_OK; ++i )
    {
        status = ALL[i]( r, s );
    }
    return status;
}

const wisp_module wisp_strands_module = { .name = "strands", .declare = declare };
