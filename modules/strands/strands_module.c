// The module: components, and the passes that depend on their presence.
#include "strand_passes.h"
#include "rod_factors.h"
#include "strands_state.h"

#define STRANDS_LIST( member, name, table, columns )                                                                 \
    static const wisp_column_def member##_columns[] = { columns( WISP_COLUMN_DEF ) };
STRANDS_COMPONENTS( STRANDS_LIST )
#undef STRANDS_LIST

// Declare the passes before the substeps: the head, and what depends on the length of a substep.
static wisp_status declare_input( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            .name = "strands.head",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->settings, s->head },
            .reads = { s->settings, s->head },
            .writes = { s->head },
            .run = strands_move_head,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            .name = "strands.reach",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->settings, WISP_STRAND_REACH },
            .reads = { s->settings, WISP_STRAND_REACH, WISP_STRAND_LENGTH, WISP_STRAND_ROOT },
            .writes = { WISP_STRAND_REACH },
            .foreign = { s->head }, // its own, if it has one
            .run = strands_find_reach,
        },
        {
            .name = "strands.tip_targets",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->tips },
            .reads = { s->tips },
            .writes = { s->tips },
            .run = strands_move_tips,
        },
        {
            .name = "strands.frame",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->settings, WISP_PARTICLE_FRAME },
            .reads = { WISP_PARTICLE_FRAME },
            .writes = { WISP_PARTICLE_FRAME },
            .run = strands_move_frame,
        },
        {
            .name = "strands.slow",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { wisp_detail_component( r ), s->settings },
            .reads = { wisp_detail_component( r ), WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_VELOCITY },
            .run = strands_slow,
            .should_run = strands_slow_is_due,
        },
        {
            .name = "strands.factor",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, s->rod, s->clamp },
            .reads = { s->settings, s->clamp, WISP_STRAND_INVERSE_MASS, WISP_STRAND_LENGTH },
            .writes = { s->rod, s->clamp },
            .run = strands_factor,
            .should_run = strands_factor_is_due,
        },
        {
            .name = "strands.rest",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, s->curve, s->balance },
            .reads = { s->settings, s->rod, s->clamp, s->curve, s->balance, WISP_STRAND_REST,
                       WISP_STRAND_INVERSE_MASS, WISP_STRAND_LENGTH },
            .writes = { s->curve, s->balance },
            .run = strands_balance_rest,
            .should_run = strands_balance_is_due,
        },
        {
            .name = "strands.grid",
            .stage = WISP_STAGE_INPUT,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->grid },
            .reads = { s->grid, WISP_STRAND_REST, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY,
                       WISP_STRAND_INVERSE_MASS },
            .writes = { s->grid, WISP_STRAND_VELOCITY },
            .run = strands_mix,
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
            .name = "strands.carry",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, WISP_PARTICLE_FRAME },
            .reads = { WISP_PARTICLE_FRAME, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_VELOCITY },
            .run = strands_carry,
        },
        {
            .name = "strands.teleport",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->head },
            .reads = { s->head, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .run = strands_jump,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            .name = "strands.teleport_frames",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->head, s->curve },
            .reads = { s->head, s->curve },
            .writes = { s->curve },
            .run = strands_jump_frames,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            .name = "strands.roots",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->head },
            .reads = { s->head, WISP_STRAND_REST },
            .writes = { WISP_STRAND_ROOT },
            .run = strands_root,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            .name = "strands.anchors",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, s->surface, s->anchor },
            .reads = { s->settings, s->surface, s->anchor, s->low, WISP_STRAND_ROOT, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_ROOT, s->anchor, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .follows = true, // its surface
            .run = strands_anchor,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            .name = "strands.anchor_frames",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->anchor, s->curve },
            .reads = { s->anchor, s->curve },
            .writes = { s->curve },
            .run = strands_anchor_frames,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            .name = "strands.pins",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->pins },
            .reads = { s->pins, s->low, WISP_STRAND_REST, WISP_STRAND_INVERSE_MASS, WISP_STRAND_ROOT,
                       WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .run = strands_hold_pins,
        },
        {
            .name = "strands.tips",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->tips },
            .reads = { s->tips, s->low, WISP_STRAND_REST, WISP_STRAND_ROOT, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .run = strands_hold_tips,
        },
        {
            .name = "strands.tip_frames",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->tips, s->tip_rows, s->curve },
            .reads = { s->tips, s->curve, WISP_STRAND_ROOT },
            .writes = { s->tip_rows, s->curve },
            .run = strands_turn_tips,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static wisp_status declare_forces( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            .name = "strands.extrapolate",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->history },
            .reads = { s->history, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_VELOCITY },
            .writes = { s->history, s->low, WISP_STRAND_VELOCITY },
            .run = strands_extrapolate,
        },
        {
            .name = "strands.damping",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->damping, s->head },
            .reads = { s->damping, s->head, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_INVERSE_MASS },
            .writes = { WISP_STRAND_VELOCITY },
            .run = strands_damp,
        },
        {
            .name = "strands.damping_anchored",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->damping, s->anchor },
            .reads = { s->damping, WISP_STRAND_ROOT, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY,
                       WISP_STRAND_INVERSE_MASS },
            .writes = { WISP_STRAND_VELOCITY },
            .run = strands_damp_anchored,
        },
        {
            .name = "strands.air",
            .stage = WISP_STAGE_FORCE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->air },
            .reads = { s->air, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_INVERSE_MASS,
                       WISP_STRAND_LENGTH },
            .writes = { WISP_STRAND_VELOCITY },
            .run = strands_drag,
        },
        {
            .name = "strands.predict",
            .stage = WISP_STAGE_PREDICT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, s->low },
            .reads = { s->settings, s->low, WISP_STRAND_ROOT, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_PREVIOUS },
            .run = strands_predict,
        },
        {
            .name = "strands.carry_pins",
            .stage = WISP_STAGE_PREDICT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, WISP_PARTICLE_FRAME },
            .reads = { WISP_PARTICLE_FRAME, WISP_STRAND_INVERSE_MASS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_VELOCITY },
            .run = strands_carry_pins,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

// Declare the rod twice: with rest curvature it has frames, a straight one has none. An entity has one of the two.
static wisp_status declare_rods( wisp_registry* r, strands_state* s )
{
    wisp_pass rod = {
        .name = "strands.rod",
        .stage = WISP_STAGE_PREDICT,
        .domain = WISP_DOMAIN_STRAND_GROUP,
        .required = { s->settings, s->rod, s->tension },
        .excluded = { s->curve },
        .reads = { s->settings, s->rod, s->clamp, s->tension, s->low, WISP_STRAND_ROOT, WISP_STRAND_INVERSE_MASS,
                   WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        .writes = { WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_PREVIOUS },
        .run = strands_bend,
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
            .name = "strands.bend_links",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->bend_links, s->bend_link },
            .reads = { s->bend_links, s->bend_link, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_PREVIOUS,
                       WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->bend_link, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .run = strands_bend_link,
        },
        {
            .name = "strands.links",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->links, s->stretch_link },
            .reads = { s->links, s->stretch_link, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_PREVIOUS,
                       WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->stretch_link, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .run = strands_link_rows,
        },
        {
            .name = "strands.stretch",
            .stage = WISP_STAGE_PROJECT,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->direct, s->tension },
            .reads = { s->direct, s->tension, s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_LENGTH,
                       WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .writes = { s->tension, s->low, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
            .run = strands_stretch,
        },
        {
            .name = "strands.velocity",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings },
            .reads = { s->low, WISP_STRAND_INVERSE_MASS, WISP_STRAND_PREVIOUS, WISP_STRAND_POSITION,
                       WISP_STRAND_VELOCITY },
            .writes = { s->low, WISP_STRAND_VELOCITY },
            .run = strands_read_velocity,
        },
        {
            .name = "strands.max_speed",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings, WISP_PARTICLE_MAX_SPEED },
            .reads = { WISP_PARTICLE_MAX_SPEED, WISP_STRAND_INVERSE_MASS, WISP_STRAND_VELOCITY },
            .writes = { WISP_STRAND_VELOCITY },
            .run = strands_limit_speed,
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
        .name = "strands.state_check",
        .stage = WISP_STAGE_CHECK,
        .domain = WISP_DOMAIN_ENTITY,
        .required = { s->good, s->in_bounds },
        .reads = { s->good, s->in_bounds, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        .writes = { s->good, s->in_bounds, s->low, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY },
        .run = strands_guard,
        .user = s,
    };
    return wisp_declare_pass( r, &pass );
}

static wisp_status declare_stats( wisp_registry* r, strands_state* s )
{
    const wisp_pass passes[] = {
        {
            .name = "strands.motion_stats",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->settings },
            .reads = { s->settings, WISP_STRAND_POSITION, WISP_STRAND_VELOCITY, WISP_STRAND_INVERSE_MASS,
                       WISP_STRAND_LENGTH },
            .writes = { WISP_MOTION_STATS },
            .run = strands_compute_motion_stats,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
        {
            .name = "strands.strain",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings },
            .reads = { WISP_STRAND_POSITION, WISP_STRAND_LENGTH },
            .writes = { WISP_POINT_STRAIN },
            .run = strands_scatter_strain,
        },
        {
            .name = "strands.speed",
            .stage = WISP_STAGE_OBSERVE,
            .domain = WISP_DOMAIN_STRAND_GROUP,
            .required = { s->settings },
            .reads = { WISP_STRAND_VELOCITY },
            .writes = { WISP_POINT_SPEED },
            .run = strands_scatter_speed,
            .detail = WISP_PASS_WITHOUT_MOTION,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

static void release_state( void* memory, const wisp_allocator* allocator )
{
    strands_state* s = memory;
    wisp_release( allocator, s->rooted, (size_t)s->rooted_capacity * sizeof( wisp_entity ) );
}

static size_t count_memory( const void* memory, size_t* outside )
{
    (void)outside;
    return (size_t)( (const strands_state*)memory )->rooted_capacity * sizeof( wisp_entity );
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
        { .component = s->anchor, .kind = WISP_INDEX_SLOT, .surface = s->surface },
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
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .release = release_state,
                                                  .removed = strands_entity_removed,
                                                  .teleported = strands_teleported,
                                                  .triangles_changed = strands_triangles_changed,
                                                  .memory = count_memory,
                                                  .lines = strands_add_frames } );
    wisp_declare_sleep( r, &( wisp_sleep_hooks ){ .surroundings = strands_surroundings, .rested = strands_rested } );
#define STRANDS_DECLARE( member, name, table, columns )                                                              \
    s->member = wisp_declare_component(                                                                              \
        r, &( wisp_component_def ){ name, table, member##_columns, WISP_COUNT( member##_columns ) } );
    STRANDS_COMPONENTS( STRANDS_DECLARE )
#undef STRANDS_DECLARE
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
