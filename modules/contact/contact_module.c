// The module: components, passes, settings of a world, and what a host reads of them.
#include "contact_state.h"

#include "wisp/module/corrected.h"
#include "wisp/module/sampling.h"
#include "wisp/module/sleep.h"
#include "wisp/module/vec.h"

#include <string.h>

static const wisp_column_def SETTINGS_COLUMNS[] = { { "settings", sizeof( contact_settings ) } };
static const wisp_column_def PARTICLE_COLUMNS[] = {
    { "intersection_free", 4 * sizeof( float ) },
    { "load", sizeof( contact_load ) },
};
static const wisp_column_def STRAND_COLUMNS[] = { { "intersection_free", 3 * WISP_LANES * sizeof( float ) } };
static const wisp_column_def MEMORY_COLUMNS[] = { { "memory", sizeof( contact_memory ) } };
static const wisp_column_def MARK_COLUMNS[] = { { "mark", sizeof( int32_t ) } };
static const wisp_column_def STATS_COLUMNS[] = { { "figures", sizeof( wisp_contact_stats ) } };

static const wisp_field CONTACT_SETTINGS_FIELDS[] = {
    WISP_CHOICE( wisp_contact_settings, level, WISP_CONTACT_EXACT, WISP_CONTACT_LEVEL_COUNT ),
    WISP_NUMBER( wisp_contact_settings, margin, 1, 0.01, 100, NULL ),
};
WISP_DEFINE( contact_settings, "contact", CONTACT_SETTINGS_FIELDS )

// ---- declaration ----

static void release_buffers( wisp_buffer* buffers, int count, const wisp_allocator* allocator )
{
    for ( int i = 0; i < count; ++i )
    {
        wisp_buffer_release( buffers + i, allocator );
    }
}

// Stages that have an array of buffers.
#define CONTACT_BUFFERED_STAGES( X )                                                                                 \
    X( contact_mesh )                                                                                                \
    X( clusters )                                                                                                    \
    X( motion )                                                                                                      \
    X( bounds )                                                                                                      \
    X( spheres )                                                                                                     \
    X( spheres.listed )                                                                                              \
    X( spheres.near )                                                                                                \
    X( colouring )                                                                                                   \
    X( limit )

static void release_stages( contact_state* s, const wisp_allocator* allocator )
{
#define RELEASE( stage ) release_buffers( s->stage.buffers, WISP_COUNT( s->stage.buffers ), allocator );
    CONTACT_BUFFERED_STAGES( RELEASE )
#undef RELEASE
    wisp_buffer_release( &s->broad_phase.box_buffer, allocator );
    wisp_aabb_pairs_release( &s->broad_phase.overlaps, allocator );
    wisp_aabb_pairs_release( &s->spheres.overlaps, allocator );
    wisp_buffer_release( &s->intersections.buffer, allocator );
    wisp_intersections_release( &s->intersections.intersections, allocator );
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        wisp_buffer_release( &s->primitives.near[kind].buffer, allocator );
    }
    wisp_buffer_release( &s->constraints.row_buffer, allocator );
    wisp_buffer_release( &s->constraints.missed_buffer, allocator );
    wisp_buffer_release( &s->constraints.order_buffer, allocator );
    wisp_buffer_release( &s->colouring.point_buffer, allocator );
    wisp_buffer_release( &s->untangling.buffer, allocator );
}

static void release_state( void* memory, const wisp_allocator* allocator )
{
    contact_state* state = memory;
    release_stages( state, allocator );
    if ( state->participants != NULL )
    {
        allocator->release( allocator->user, state->participants,
                            (size_t)state->participant_capacity * sizeof( contact_participant ) );
    }
}

static size_t count_memory( const void* memory, size_t* outside )
{
    (void)outside;
    const contact_state* s = memory;
    const wisp_buffer single[] = { s->broad_phase.box_buffer,   s->intersections.buffer,
                                   s->constraints.row_buffer,   s->constraints.missed_buffer,
                                   s->constraints.order_buffer, s->colouring.point_buffer,
                                   s->untangling.buffer };
    size_t bytes = (size_t)s->participant_capacity * sizeof( contact_participant ) +
                   wisp_buffer_bytes( single, WISP_COUNT( single ) ) +
                   wisp_aabb_pairs_bytes( &s->broad_phase.overlaps ) + wisp_aabb_pairs_bytes( &s->spheres.overlaps ) +
                   wisp_intersections_bytes( &s->intersections.intersections );
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        bytes += s->primitives.near[kind].buffer.size;
    }
#define ADD( stage ) bytes += wisp_buffer_bytes( s->stage.buffers, WISP_COUNT( s->stage.buffers ) );
    CONTACT_BUFFERED_STAGES( ADD )
#undef ADD
    return bytes;
}

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    contact_state* state = memory;
    const int number = contact_find_participant( state, entity );
    if ( number >= 0 )
    {
        contact_forget_participant( world, state, number );
    }
}

// The contact mesh is made of the triangles of participants.
static wisp_status triangles_changed( void* memory, wisp_world* world, wisp_entity surface,
                                      const wisp_fabric* before )
{
    (void)before;
    contact_state* state = memory;
    (void)world;
    state->changed = state->changed || contact_find_participant( state, surface ) >= 0;
    return WISP_OK;
}

// Pairs that pressed on each other, with the entity whose passes work on all of them.
static void add_lines( const void* memory, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                       wisp_line_list* list )
{
    (void)world;
    const contact_state* state = memory;
    const contact_contact_mesh* s = &state->contact_mesh;
    const bool is_known = kind == WISP_LINES_CONTACTS && wisp_entity_equal( entity, state->mesh_entity ) &&
                          state->changed == false && s->is_listed && s->point_count > 0;
    for ( int r = 0; is_known && r < state->constraints.row_count; ++r )
    {
        const contact_row* row = state->constraints.rows + r;
        wisp_vec3 from = { 0.0f, 0.0f, 0.0f }; // on the second side
        for ( int i = row->split; i < CONTACT_MAX_POINTS; ++i )
        {
            from = wisp_v3_mul_add( from, -row->weight[i], wisp_v3_load( s->now + (size_t)row->point[i] * 4 ) );
        }
        if ( row->normal_impulse > 0.0f )
        {
            wisp_add_line( list, state->participants[0].entity, from,
                           wisp_v3_mul_add( from, row->requested, wisp_v3_load( row->normal ) ),
                           wisp_v3( 1.0f, 1.0f, 0.0f ) );
        }
    }
}

// As wisp_sleep_hooks.reach.
static float participant_reach( const void* memory, wisp_world* world, wisp_entity entity )
{
    const contact_state* state = memory;
    const contact_settings* settings = wisp_world_rows( world, entity, state->components.settings, 0 );
    return settings != NULL ? settings->thickness : -1.0f;
}

// As wisp_state_hooks.planned. A mask of nothing is one to count intersections with.
static void tell_of_lonely( const void* memory, wisp_world* world )
{
    const contact_state* s = memory;
    for ( int i = 0; i < s->participant_count; ++i )
    {
        const contact_participant* a = s->participants + i;
        const contact_settings* own = wisp_world_rows( world, a->entity, s->components.settings, 0 );
        bool meets = own->mask == 0 || ( own->self & 1 ) != 0;
        for ( int k = 0; k < s->participant_count && meets == false; ++k )
        {
            const contact_participant* b = s->participants + k;
            meets =
                k != i && contact_suit( a, own, b, wisp_world_rows( world, b->entity, s->components.settings, 0 ) );
        }
        wisp_world_tell( world, a->entity, meets == false,
                         "'contact' has no effect: it meets neither itself nor others" );
    }
}

static wisp_status declare_components( wisp_registry* r, contact_state* s )
{
    const struct
    {
        wisp_component* out;
        wisp_component_def def;
    } all[] = {
        { &s->components.settings, { "contact.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS, 1 } },
        { &s->components.samples_read, { WISP_SAMPLES_READ, WISP_TABLE_ENTITY, NULL, 0 } },
        { &s->components.corrected, { WISP_PARTICLE_CORRECTED, WISP_TABLE_ENTITY, NULL, 0 } },
        { &s->components.particle_free, { "contact.particles", WISP_TABLE_PARTICLE, PARTICLE_COLUMNS, 2 } },
        { &s->components.strand_free, { "contact.strands", WISP_TABLE_STRAND_ROW, STRAND_COLUMNS, 1 } },
        { &s->active, { "contact.active", WISP_TABLE_ENTITY, MEMORY_COLUMNS, 1 } },
        { &s->touches, { "contact.touches_strands", WISP_TABLE_ENTITY, MARK_COLUMNS, 1 } },
        { &s->reached, { "contact.reached", WISP_TABLE_ENTITY, MARK_COLUMNS, 1 } },
        { &s->pairs, { "contact.pairs", WISP_TABLE_ENTITY, MARK_COLUMNS, 1 } },
        { &s->result, { "contact.result", WISP_TABLE_ENTITY, MARK_COLUMNS, 1 } },
        { &s->stats, { "contact.stats", WISP_TABLE_ENTITY, STATS_COLUMNS, 1 } },
    };
    for ( int i = 0; i < WISP_COUNT( all ); ++i )
    {
        *all[i].out = wisp_declare_component( r, &all[i].def );
    }
    wisp_declare_places( r, s->components.particle_free, 0, WISP_PLACE_QUADS );
    wisp_declare_places( r, s->components.strand_free, 0, WISP_PLACE_LANES );
    wisp_declare_map( r, WISP_MAP_CONTACT_THICKNESS, s->components.settings, NULL );
    wisp_declare_map( r, WISP_MAP_CONTACT_FRICTION, s->components.settings, NULL );
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->components.settings, contact_settings, self, 0, 3 ),
        WISP_MEMBER_RANGE( s->components.settings, contact_settings, is_new, 0, 1 ),
        WISP_MEMBER_RANGE( s->components.settings, contact_settings, is_far, 0, 1 ),
        WISP_MEMBER_RANGE( s->active, contact_memory, tangled, 0, 1 ),
    };
    return s->stats != 0 ? wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) : WISP_BAD_INPUT;
}

// Return a pass over the participants, or, with strands, one that also waits for the passes of strands, which then leave their own
// loop over groups. @param half_spaces component of them where it reads them
static wisp_pass pass_of( contact_state* s, bool strands, const char* name, wisp_stage stage, wisp_pass_fn* run,
                          wisp_component half_spaces )
{
    return ( wisp_pass ){
        .name = name,
        .stage = stage,
        .domain = WISP_DOMAIN_ENTITY,
        .required = { s->active, strands ? s->touches : 0 },
        .excluded = { strands ? 0 : s->touches },
        .reads = { s->active },
        .foreign = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, strands ? WISP_STRAND_POSITION : half_spaces,
                     strands ? WISP_STRAND_PREVIOUS : 0, strands ? half_spaces : 0 }, // zeros last
        .among = s->components.settings,
        .spares = strands,
        .run = run,
    };
}

static wisp_status declare_passes( wisp_registry* r, contact_state* s, bool strands )
{
    const wisp_component half = WISP_PARTICLE_HALF_SPACES;
    wisp_pass passes[] = {
        pass_of( s, strands, strands ? "contact.reach_strands" : "contact.reach", WISP_STAGE_CONTACT, contact_reach,
                 0 ),
        pass_of( s, strands, strands ? "contact.find_strands" : "contact.find", WISP_STAGE_CONTACT, contact_find,
                 half ),
        pass_of( s, strands, strands ? "contact.push_strands" : "contact.push", WISP_STAGE_PROJECT, contact_project,
                 half ),
        {
            .name = strands ? "contact.keep_strands" : "contact.keep",
            .stage = WISP_STAGE_VELOCITY,
            .domain = WISP_DOMAIN_ENTITY,
            .required = { s->components.settings, strands ? WISP_STRAND_INVERSE_MASS : WISP_PARTICLE_MASS },
            .reads = { s->components.settings, strands ? WISP_STRAND_POSITION : WISP_PARTICLE_POSITION,
                       strands ? WISP_STRAND_PREVIOUS : WISP_PARTICLE_PREVIOUS },
            .writes = { strands ? s->components.strand_free : s->components.particle_free },
            .spares = strands,
            .run = contact_keep,
        },
        pass_of( s, strands, strands ? "contact.strand_stats" : "contact.stats", WISP_STAGE_OBSERVE, contact_measure,
                 0 ),
    };
    passes[0].writes[0] = passes[1].reads[1] = s->reached;
    passes[1].writes[0] = passes[2].reads[1] = s->pairs;
    passes[1].should_run = strands ? contact_join : NULL;
    passes[2].writes[0] = s->result;
    passes[4].writes[0] = s->stats;
    passes[4].foreign[1] = strands ? WISP_STRAND_POSITION : 0;
    passes[4].foreign[2] = passes[4].foreign[3] = 0;
    passes[4].spares = false;
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

// Declare a pass that limits displacements once more, after lengths and before velocities are computed.
static wisp_status declare_limit( wisp_registry* r, contact_state* s )
{
    wisp_pass pass = pass_of( s, true, "contact.limit_strands", WISP_STAGE_VELOCITY, contact_limit_strands, 0 );
    pass.writes[0] = s->result;
    return wisp_declare_passes( r, &pass, 1, s );
}

static wisp_status declare( wisp_registry* r )
{
    contact_state* state = wisp_declare_state( r, sizeof( contact_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->world = wisp_default_contact_settings();
    state->contact_mesh = ( contact_contact_mesh ){
        .clusters = &state->clusters,
        .motion = &state->motion,
        .bounds = &state->bounds,
        .broad_phase = &state->broad_phase,
        .intersections = &state->intersections,
        .primitives = &state->primitives,
        .constraints = &state->constraints,
        .spheres = &state->spheres,
        .colouring = &state->colouring,
        .limit = &state->limit,
        .untangling = &state->untangling,
    };
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .release = release_state,
                                                  .removed = entity_removed,
                                                  .triangles_changed = triangles_changed,
                                                  .planned = tell_of_lonely,
                                                  .memory = count_memory,
                                                  .lines = add_lines,
                                                  .sleep = &( wisp_sleep_hooks ){ .reach = participant_reach } } );
    wisp_status status = declare_components( r, state );
    status = status == WISP_OK ? declare_limit( r, state ) : status;
    status = status == WISP_OK ? declare_passes( r, state, false ) : status;
    return status == WISP_OK ? declare_passes( r, state, true ) : status;
}

const wisp_module wisp_contact_module = { .name = "contact", .declare = declare };

// ---- settings of the world ----

wisp_status wisp_set_contact_settings( wisp_world* world, const wisp_contact_settings* given )
{
    wisp_contact_settings values;
    const wisp_contact_settings* settings = &values;
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_contact_settings_fields, &values, given ) );
    WISP_FIND_STATE( contact_state, state, world, "contact", NULL, 0 );
    WISP_TRY( contact_mark_participants( world, state, settings->level ) );
    state->world = *settings;
    state->changed = true;
    return WISP_OK;
}

// ---- statistics ----

wisp_status wisp_request_contact_stats( wisp_world* world, bool requested, bool count_intersections )
{
    WISP_FIND_STATE( contact_state, state, world, "contact", NULL, 0 );
    WISP_TRY( state->participant_count > 0 ? wisp_world_request( world, state->mesh_entity, state->stats, requested )
                                           : WISP_OK );
    state->requests_stats = requested;
    state->counts_intersections = requested && count_intersections;
    return WISP_OK;
}

static wisp_status find_stats( wisp_world* world, contact_state** state, const wisp_contact_stats** out )
{
    WISP_FIND_STATE( contact_state, found, world, "contact", NULL, 0 );
    *state = found;
    *out = found->participant_count > 0 ? wisp_world_column( world, found->mesh_entity, found->stats, 0 ) : NULL;
    return *out != NULL && ( *out )->participants > 0
               ? WISP_OK
               : wisp_world_fail(
                     world, WISP_CONFLICT,
                     "contact: no statistics: they were not requested, no entity takes part, or no step was made" );
}

wisp_status wisp_read_contact_stats( wisp_world* world, wisp_contact_stats* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    contact_state* state;
    const wisp_contact_stats* stats;
    const wisp_status status = find_stats( world, &state, &stats );
    if ( status == WISP_OK )
    {
        *out = *stats;
        out->searches = state->broad_phase.searches;
        out->candidates =
            state->world.level == WISP_CONTACT_SPHERES ? state->spheres.listed.count : state->bounds.pairs.count;
    }
    return status;
}

static wisp_status find_participant( wisp_world* world, const contact_state* state, wisp_entity entity, int* out )
{
    *out = contact_find_participant( state, entity );
    return *out >= 0 ? WISP_OK
                     : wisp_world_fail( world, WISP_CONFLICT, "contact: entity %u takes no part", entity.index );
}

wisp_status wisp_read_contact_impulse( wisp_world* world, wisp_entity participant, double out[3] )
{
    WISP_TRY( wisp_world_begin_read( world, out, 3 * sizeof( *out ) ) );
    WISP_TRY( wisp_world_check_entity( world, participant ) );
    contact_state* state;
    const wisp_contact_stats* stats;
    int number;
    WISP_TRY( find_stats( world, &state, &stats ) );
    WISP_TRY( find_participant( world, state, participant, &number ) );
    memcpy( out, state->participants[number].impulse, sizeof( state->participants[number].impulse ) );
    return WISP_OK;
}

wisp_status wisp_read_contact_intersections( wisp_world* world, wisp_entity a, wisp_entity b, int* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    WISP_TRY( wisp_world_check_entity( world, a ) );
    WISP_TRY( wisp_world_check_entity( world, b ) );
    contact_state* state;
    const wisp_contact_stats* stats;
    int first, second;
    WISP_TRY( find_stats( world, &state, &stats ) );
    WISP_TRY( find_participant( world, state, a, &first ) );
    WISP_TRY( find_participant( world, state, b, &second ) );
    if ( stats->intersections < 0 || state->changed )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                stats->intersections < 0
                                    ? "contact: intersections were not counted in the last step"
                                    : "contact: participants have changed since intersections were counted" );
    }
    *out = contact_count_intersections( &state->contact_mesh, first, second );
    return WISP_OK;
}
