// Level of detail: what was set of each entity becomes what a step runs. In: rows of "detail.state". Out: store_entity.detail, by which the
// plan chooses passes and substeps.
//
// A change is part of the state: its rows are advanced once per step, before the plan, so a snapshot goes on in the middle of one.
#include "world.h"

#include "alloc.h"

#include "wisp/module/components.h"
#include <string.h>

// ---- blend ----

static const wisp_component BLENDED[] = { WISP_STRAND_POINTS, WISP_SURFACE_POINTS };

static size_t column_bytes( const wisp_world* world )
{
    return (size_t)world->store.row_count[WISP_TABLE_POINT] * sizeof( wisp_vec3 );
}

bool world_keep_points( wisp_world* world )
{
    world_blend* blend = &world->blend;
    const size_t bytes = column_bytes( world );
    if ( base_buffer_reserve( &world->allocator, &blend->previous, WISP_COUNT( BLENDED ) * bytes ) == false ||
         base_buffer_reserve( &world->allocator, &blend->points, WISP_COUNT( BLENDED ) * bytes ) == false )
    {
        return false;
    }
    for ( int k = 0; k < WISP_COUNT( BLENDED ); ++k )
    {
        const void* column = world->store.components[BLENDED[k]].columns[0];
        if ( column != NULL && bytes > 0 )
        {
            memcpy( (char*)blend->previous.data + (size_t)k * bytes, column, bytes );
        }
    }
    blend->structure = world->store.structure;
    return true;
}

static bool is_kept( const wisp_world* world )
{
    return world->blend.points.data != NULL && world->blend.structure == world->store.structure;
}

void world_blend_points( wisp_world* world, float weight )
{
    if ( is_kept( world ) == false )
    {
        return;
    }
    world_blend* blend = &world->blend;
    const size_t floats = column_bytes( world ) / sizeof( float );
    for ( int k = 0; k < WISP_COUNT( BLENDED ); ++k )
    {
        const float* column = world->store.components[BLENDED[k]].columns[0];
        const float* previous = (const float*)blend->previous.data + (size_t)k * floats;
        float* points = (float*)blend->points.data + (size_t)k * floats;
        for ( size_t i = 0; i < floats && column != NULL; ++i )
        {
            points[i] = previous[i] + weight * ( column[i] - previous[i] );
        }
    }
    blend->is_shown = true;
}

void* world_kept_rows( wisp_world* world, const store_entity* e, wisp_component component )
{
    for ( int k = 0; k < WISP_COUNT( BLENDED ) && is_kept( world ); ++k )
    {
        if ( BLENDED[k] == component )
        {
            return (char*)world->blend.previous.data + (size_t)k * column_bytes( world ) +
                   (size_t)e->rows[WISP_TABLE_POINT].begin * sizeof( wisp_vec3 );
        }
    }
    return NULL;
}

const void* world_blended_rows( const wisp_world* world, const store_entity* e, wisp_component component )
{
    for ( int k = 0; k < WISP_COUNT( BLENDED ); ++k )
    {
        if ( BLENDED[k] == component && world->blend.is_shown && is_kept( world ) )
        {
            return (const char*)world->blend.points.data + (size_t)k * column_bytes( world ) +
                   (size_t)e->rows[WISP_TABLE_POINT].begin * sizeof( wisp_vec3 );
        }
    }
    return NULL;
}

// ---- detail ----

static const wisp_field DETAIL_FIELDS[] = {
    WISP_CHOICE( wisp_detail_def, level, WISP_DETAIL_FULL, WISP_DETAIL_COUNT ),
    WISP_WHOLE( wisp_detail_def, substep_divisor, 4, 1, WORLD_MAX_SUBSTEPS ),
    WISP_WHOLE( wisp_detail_def, blend_steps, 15, 0, WORLD_MAX_SUBSTEPS ),
};
WISP_DEFINE( detail_def, "detail", DETAIL_FIELDS )

static passes_detail* state_of( const wisp_world* world, const store_entity* e )
{
    return e->alive ? store_column( &world->store, e, world->registry.detail, 0 ) : NULL;
}

// ---- steps ----

// Substeps that an entity asks for, as the plan rounds them.
static int asked_substeps( const wisp_world* world, const store_entity* e )
{
    const int usual = plan_usual_substeps( &world->registry );
    return e->substeps > usual ? ( ( e->substeps - 1 ) / usual + 1 ) * usual : usual;
}

static int substeps_at( const passes_detail* d, int level, int asked )
{
    return level == WISP_DETAIL_FULL ? asked : ( asked - 1 ) / d->divisor + 1;
}

// Substeps come and go one by one: shorter ones are stiffer, so what is stretched would shorten at once, and what is blown up shrink.
static void advance_substeps( passes_detail* d, int asked )
{
    if ( d->active != WISP_DETAIL_NOTHING && d->active == d->level )
    {
        const int goal = substeps_at( d, d->active, asked ), of = d->of_substeps > 0 ? d->of_substeps : asked;
        const bool blends = d->elapsed < d->blend_steps;
        d->substeps = blends ? of + (int)( (int64_t)( goal - of ) * d->elapsed / d->blend_steps ) : goal;
    }
}

// Advance a row by a step. @return whether its level changes
static bool advance( const wisp_world* world, const store_entity* e, passes_detail* d )
{
    const bool comes_to_rest = d->level == WISP_DETAIL_NOTHING && d->elapsed < d->blend_steps;
    const bool changes = d->active != d->level && comes_to_rest == false;
    d->active = changes ? d->level : d->active;
    d->elapsed += d->elapsed < d->blend_steps ? 1 : 0;
    advance_substeps( d, asked_substeps( world, e ) );
    return changes;
}

static wisp_detail_frame frame_of( const passes_detail* d, int asked )
{
    const int left = d->blend_steps - d->elapsed;
    const bool comes_to_rest = d->level == WISP_DETAIL_NOTHING && d->active != d->level;
    const int limit = d->active == WISP_DETAIL_NOTHING ? 1 : d->substeps;
    return ( wisp_detail_frame ){
        .level = (wisp_detail)d->active,
        .from = (wisp_detail)d->from,
        .max_substeps = limit < asked ? limit : 0,
        .blend_steps = d->blend_steps,
        .blend = d->blend_steps > 0 ? (float)d->elapsed / (float)d->blend_steps : 1.0f,
        .keep = comes_to_rest ? (float)left / (float)( left + 1 ) : 1.0f,
    };
}

// Rows that were advanced become what the plan and the passes see.
static void show( wisp_world* world, store_entity* e, const passes_detail* d )
{
    const wisp_detail_frame detail = frame_of( d, asked_substeps( world, e ) );
    world->plan_is_stale = world->plan_is_stale || detail.level != e->detail.level;
    world->rates_are_stale = world->rates_are_stale || detail.max_substeps != e->detail.max_substeps;
    e->detail = detail;
}

static bool is_used( const wisp_world* world )
{
    return world->store.components[world->registry.detail].entity_count > 0;
}

void world_detail_show( wisp_world* world, bool of_next_step )
{
    for ( int slot = 0; slot < world->store.entity_count && is_used( world ); ++slot )
    {
        store_entity* e = world->store.entities + slot;
        const passes_detail* d = state_of( world, e );
        if ( d != NULL )
        {
            passes_detail next = *d;
            (void)( of_next_step && advance( world, e, &next ) );
            show( world, e, &next );
        }
    }
}

void world_detail_begin( wisp_world* world )
{
    for ( int slot = 0; slot < world->store.entity_count && is_used( world ); ++slot )
    {
        store_entity* e = world->store.entities + slot;
        const wisp_entity entity = store_handle( &world->store, slot );
        passes_detail* d = state_of( world, e );
        const wisp_detail from = d != NULL ? (wisp_detail)d->active : WISP_DETAIL_FULL;
        if ( d == NULL || advance( world, e, d ) == false )
        {
            continue;
        }
        if ( d->active == WISP_DETAIL_NOTHING )
        {
            world_forget_velocities( world, e );
            plan_registry_rested( &world->registry, world, entity );
        }
        plan_registry_detail_changed( &world->registry, world, entity, from, (wisp_detail)d->active );
    }
}

void world_detail_from_rows( wisp_world* world )
{
    for ( int slot = 0; slot < world->store.entity_count; ++slot )
    {
        store_entity* e = world->store.entities + slot;
        passes_detail* d = state_of( world, e );
        if ( d != NULL )
        {
            d->elapsed = d->elapsed < d->blend_steps ? d->elapsed : d->blend_steps;
            show( world, e, d );
        }
    }
}

// ---- calls of the host ----

static bool has_coarse( const wisp_world* world, wisp_entity entity )
{
    return wisp_world_has( world, entity, WISP_SURFACE_LEVELS ) ||
           plan_registry_has_coarse( &world->registry, world, entity );
}

static wisp_status check_detail( wisp_world* world, wisp_entity entity, const wisp_detail_def* def )
{
    const store_entity* e = store_find( &world->store, entity );
    if ( e->fabric == NULL && e->strands == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "detail: entity %u is neither a surface nor strands",
                                entity.index );
    }
    return def->level != WISP_DETAIL_COARSE || has_coarse( world, entity )
               ? WISP_OK
               : wisp_world_fail(
                     world, WISP_CONFLICT,
                     "detail: level coarse of entity %u: expected a surface with coarse sheets, or strands "
                     "that follow others",
                     entity.index );
}

static void set_level( const wisp_world* world, const store_entity* e, passes_detail* d, const wisp_detail_def* def )
{
    const bool is_before_steps = world->frame.step == 0;
    d->divisor = def->substep_divisor;
    d->blend_steps = def->blend_steps;
    d->elapsed = d->elapsed < d->blend_steps ? d->elapsed : d->blend_steps;
    if ( d->level != (int32_t)def->level || is_before_steps )
    {
        // strands that come back from a rigid motion go on coming back
        const bool returns = e->strands != NULL && d->from >= WISP_DETAIL_COARSE && d->active < WISP_DETAIL_COARSE &&
                             def->level < WISP_DETAIL_COARSE && is_before_steps == false;
        d->from = returns ? d->from : d->active;
        d->level = (int32_t)def->level;
        d->elapsed = is_before_steps ? d->blend_steps : returns ? d->elapsed : 0;
        d->of_substeps = d->substeps;
    }
}

wisp_status wisp_set_detail( wisp_world* world, wisp_entity entity, const wisp_detail_def* given )
{
    wisp_detail_def def;
    WISP_TRY( wisp_world_begin_def( world, &entity, &wisp_detail_def_fields, &def, given ) );
    WISP_TRY( check_detail( world, entity, &def ) );
    const bool is_new = wisp_world_has( world, entity, world->registry.detail ) == false;
    WISP_TRY( wisp_world_attach( world, entity, world->registry.detail ) );
    const wisp_status status = is_new ? plan_registry_prepare_detail( &world->registry, world, entity ) : WISP_OK;
    if ( status != WISP_OK )
    {
        wisp_world_detach( world, entity, world->registry.detail );
        return status;
    }
    const store_entity* e = store_find( &world->store, entity );
    set_level( world, e, state_of( world, e ), &def );
    return WISP_OK;
}

wisp_detail wisp_detail_of( const wisp_world* world, wisp_entity entity )
{
    const store_entity* e = world != NULL ? store_find( &world->store, entity ) : NULL;
    const passes_detail* d = e != NULL ? state_of( world, e ) : NULL;
    return d != NULL ? (wisp_detail)d->level : WISP_DETAIL_FULL;
}
