// Tearing: the calls of the host. In: wisp_tearing_def. Out: components of a surface, and its place in the list.

#include "tearing_state.h"

#include <math.h>
#include <string.h>

TEARING_COMPONENTS( WISP_COMPONENT_COLUMNS )

static const wisp_field TEARING_FIELDS[] = {
    WISP_NUMBER( wisp_tearing_def, strength, INFINITY, 1e-6, INFINITY, "N/m" ),
    WISP_WHOLE( wisp_tearing_def, max_splits, 64, 1, TEARING_MAX_SPLITS ),
};
WISP_DEFINE( tearing_def, "tearing", TEARING_FIELDS )

// ---- checks ----

static wisp_status check_values( wisp_world* world, const wisp_fabric* f, const wisp_tearing_def* d )
{
    for ( int v = 0; d->factors != NULL && v < f->vertex_count; ++v )
    {
        if ( !( d->factors[v] >= 1e-6f && d->factors[v] <= 1e6f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "tearing: factors: vertex %d: got %g, expected 1e-06 to 1e+06", v,
                                    (double)d->factors[v] );
        }
    }
    return WISP_OK;
}

// What holds topology or rows of vertices that a split would not keep right, by the beginning of a component's name.
static const char* const REFUSED[][2] = {
    { "link.stiffness", "moves by pbd, whose links have no forces" },
    { "particle.external_solver", "moves by a solver of velocities" },
    { "surface.levels", "has coarse sheets" },
    { "surface.tethers", "has tethers" },
    { "motion_constraints.", "has motion constraints" },
    { "boundary.", "has boundary particles" },
    { "balloon.", "is a balloon" },
};

static const char* find_refusal( wisp_world* world, wisp_entity surface )
{
    for ( wisp_component c = 1; strcmp( wisp_world_component_name( world, c ), "unknown" ) != 0; ++c )
    {
        for ( int i = 0; i < WISP_COUNT( REFUSED ) && wisp_world_has( world, surface, c ); ++i )
        {
            if ( strncmp( wisp_world_component_name( world, c ), REFUSED[i][0], strlen( REFUSED[i][0] ) ) == 0 )
            {
                return REFUSED[i][1];
            }
        }
    }
    return NULL;
}

// Check that a surface can tear. (tearing_definition.c)
static wisp_status tearing_check( wisp_world* world, wisp_entity surface )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const float* vertex_mass = wisp_world_column( world, surface, WISP_PARTICLE_MASS, 1 );
    const char* refusal = find_refusal( world, surface );
    refusal = refusal != NULL ? refusal
              : wisp_world_has( world, surface, WISP_LINK_COMPLIANCE ) == false
                  ? "is no cloth yet: call wisp_set_cloth() first"
              : *vertex_mass > 0.0f           ? "has vertex_mass, and tearing needs area_density"
              : f->nonmanifold_edge_count > 0 ? "has edges of more than two triangles, or of triangles that face "
                                                "opposite ways"
                                              : NULL;
    return refusal == NULL ? WISP_OK
                           : wisp_world_fail( world, WISP_CONFLICT, "tearing: entity %u %s", surface.index, refusal );
}

// ---- setting ----

// Take a surface off the list. (tearing_definition.c)
static void tearing_forget( tearing_state* state, wisp_entity surface )
{
    for ( int i = 0; i < state->count; ++i )
    {
        if ( wisp_entity_equal( state->surfaces[i], surface ) )
        {
            state->count -= 1;
            memmove( state->surfaces + i, state->surfaces + i + 1,
                     (size_t)( state->count - i ) * sizeof( wisp_entity ) );
            return;
        }
    }
}

static void remove_tearing( wisp_world* world, tearing_state* state, wisp_entity surface )
{
    const wisp_component own[] = { state->settings, state->strength, state->limit, WISP_LINK_LAMBDA };
    wisp_world_cancel_request( world, surface, state->result );
    for ( int i = 0; i < WISP_COUNT( own ); ++i )
    {
        wisp_world_detach( world, surface, own[i] );
    }
    tearing_forget( state, surface );
}

static wisp_status attach_all( wisp_world* world, const tearing_state* state, wisp_entity surface )
{
    WISP_TRY( wisp_world_need_fabric( world, surface, WISP_FABRIC_EDGES | WISP_FABRIC_HINGES ) );
    WISP_TRY( wisp_world_attach( world, surface, state->strength ) );
    WISP_TRY( wisp_world_attach( world, surface, state->limit ) );
    WISP_TRY( wisp_world_attach( world, surface, WISP_LINK_LAMBDA ) );
    WISP_TRY( wisp_world_attach( world, surface, state->settings ) );
    return wisp_world_request( world, surface, state->result );
}

static void fill( wisp_world* world, const tearing_state* state, wisp_entity surface, const wisp_tearing_def* d )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    tearing_settings* settings = wisp_world_column( world, surface, state->settings, 0 );
    float* strength = wisp_world_column( world, surface, state->strength, 0 );
    settings->max_splits = d->max_splits;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const int a = f->slot_vertex[f->edges[2 * (size_t)e]], b = f->slot_vertex[f->edges[2 * (size_t)e + 1]];
        strength[e] = d->factors != NULL ? 0.5f * ( d->factors[a] + d->factors[b] ) * d->strength : d->strength;
    }
    tearing_fill_limits( world, state, surface );
}

static bool is_listed( const tearing_state* state, wisp_entity surface )
{
    bool found = false;
    for ( int i = 0; i < state->count && found == false; ++i )
    {
        found = wisp_entity_equal( state->surfaces[i], surface );
    }
    return found;
}

static wisp_status set_tearing( wisp_world* world, tearing_state* state, wisp_entity surface,
                                const wisp_tearing_def* d )
{
    WISP_TRY( tearing_check( world, surface ) );
    WISP_TRY( check_values( world, wisp_world_fabric( world, surface ), d ) );
    const bool is_new = is_listed( state, surface ) == false;
    if ( is_new && wisp_world_reserve( world, (void**)&state->surfaces, &state->capacity, state->count,
                                       sizeof( wisp_entity ) ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "tearing: out of memory for %d surfaces", state->count + 1 );
    }
    const wisp_status status = attach_all( world, state, surface );
    if ( status != WISP_OK )
    {
        if ( is_new )
        {
            remove_tearing( world, state, surface );
        }
        return status;
    }
    if ( is_new )
    {
        state->surfaces[state->count++] = surface;
    }
    fill( world, state, surface, d );
    return WISP_OK;
}

wisp_status wisp_set_tearing( wisp_world* world, wisp_entity surface, const wisp_tearing_def* given )
{
    wisp_tearing_def def;
    WISP_TRY( given != NULL ? wisp_world_begin_def( world, NULL, &wisp_tearing_def_fields, &def, given )
                            : wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_entity( world, surface ) );
    void* state;
    WISP_TRY( wisp_world_surface_state( world, "tearing", surface, &state ) );
    if ( given == NULL || isinf( def.strength ) )
    {
        if ( given != NULL )
        {
            WISP_TRY( check_values( world, wisp_world_fabric( world, surface ), &def ) );
            wisp_world_tell( world, surface, true, "'tearing' has no effect without a strength" );
        }
        if ( is_listed( state, surface ) )
        {
            remove_tearing( world, state, surface );
        }
        return WISP_OK;
    }
    return set_tearing( world, state, surface, &def );
}

// ---- reading ----

static int count_spares( const wisp_fabric* f )
{
    int count = 0;
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        count += f->area[slot] == 0.0f ? 1 : 0;
    }
    return count;
}

wisp_status wisp_read_tearing_stats( wisp_world* world, wisp_entity surface, wisp_tearing_stats* out )
{
    WISP_TRY( wisp_world_begin( world ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    *out = ( wisp_tearing_stats ){ 0 };
    WISP_TRY( wisp_world_check_entity( world, surface ) );
    void* memory;
    WISP_TRY( wisp_world_surface_state( world, "tearing", surface, &memory ) );
    const tearing_state* state = memory;
    const tearing_settings* settings = wisp_world_column( world, surface, state->settings, 0 );
    const tearing_result* result = wisp_world_column( world, surface, state->result, 0 );
    if ( settings == NULL || result == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "tearing: entity %u does not tear", surface.index );
    }
    *out = ( wisp_tearing_stats ){ .split_count = settings->split_count,
                                   .spare_count = count_spares( wisp_world_fabric( world, surface ) ),
                                   .over_count = result->over_count,
                                   .max_load = result->max_load };
    return WISP_OK;
}

// ---- module ----

// The module: its components, its pass and its hooks.

static void release_state( void* memory, const wisp_allocator* allocator )
{
    tearing_state* state = memory;
    wisp_release( allocator, state->surfaces, (size_t)state->capacity * sizeof( wisp_entity ) );
}

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    (void)world;
    tearing_forget( memory, entity );
}

static size_t count_memory( const void* memory, size_t* outside )
{
    (void)outside;
    return (size_t)( (const tearing_state*)memory )->capacity * sizeof( wisp_entity );
}

// Surfaces split in the order in which they were set.
static wisp_status split_all( void* memory, wisp_world* world )
{
    const tearing_state* state = memory;
    for ( int i = 0; i < state->count; ++i )
    {
        WISP_TRY( tearing_split( world, state, state->surfaces[i] ) );
    }
    return WISP_OK;
}

static wisp_status declare( wisp_registry* r )
{
    tearing_state* s = wisp_declare_state( r, sizeof( tearing_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks(
        r, &( wisp_state_hooks ){
               .release = release_state, .removed = entity_removed, .stepped = split_all, .memory = count_memory } );
    TEARING_COMPONENTS( WISP_COMPONENT_DECLARE )
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->settings, tearing_settings, max_splits, 1, TEARING_MAX_SPLITS ),
        WISP_MEMBER_RANGE( s->settings, tearing_settings, split_count, 0, INT32_MAX ),
        WISP_MEMBER_RANGE( s->result, tearing_result, is_new, 0, 1 ),
        { .component = s->result, .count = 1, .kind = WISP_INDEX_COUNT, .table = WISP_TABLE_LINK },
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    const wisp_pass pass = {
        WISP_PASS( "tearing.measure", CHECK, ENTITY, tearing_measure ),
        .required = { s->settings, WISP_LINK_COMPLIANCE },
        .reads = { s->settings, s->limit, WISP_LINK_LAMBDA, WISP_PARTICLE_POSITION },
        .writes = { s->result },
    };
    return s->result != 0 ? wisp_declare_passes( r, &pass, 1, s ) : WISP_BAD_INPUT;
}

const wisp_module wisp_tearing_module = { .name = "tearing", .declare = declare };
