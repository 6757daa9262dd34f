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

static wisp_status set_components( wisp_world* world, const tearing_state* state, wisp_entity surface, bool tears )
{
    const wisp_component_use uses[] = { { state->strength, tears },
                                        { state->limit, tears },
                                        { WISP_LINK_LAMBDA, tears },
                                        { state->settings, tears },
                                        { state->result, tears ? WISP_REQUESTED : 0 } };
    return wisp_world_set_components( world, surface, uses, WISP_COUNT( uses ) );
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

static wisp_status set_tearing( wisp_world* world, tearing_state* state, wisp_entity surface,
                                const wisp_tearing_def* d )
{
    WISP_TRY( tearing_check( world, surface ) );
    WISP_TRY( check_values( world, wisp_world_fabric( world, surface ), d ) );
    WISP_TRY( wisp_world_need_fabric( world, surface, WISP_FABRIC_EDGES | WISP_FABRIC_HINGES ) );
    WISP_TRY( set_components( world, state, surface, true ) );
    fill( world, state, surface, d );
    return WISP_OK;
}

wisp_status wisp_set_tearing( wisp_world* world, wisp_entity surface, const wisp_tearing_def* given )
{
    wisp_tearing_def def;
    WISP_TRY( given != NULL ? wisp_world_begin_def( world, NULL, &wisp_tearing_def_fields, &def, given )
                            : wisp_world_begin( world ) );
    WISP_FIND_STATE( tearing_state, state, world, "tearing", &surface, WISP_IS_SURFACE );
    if ( given == NULL || isinf( def.strength ) )
    {
        if ( given != NULL )
        {
            WISP_TRY( check_values( world, wisp_world_fabric( world, surface ), &def ) );
            wisp_world_tell( world, surface, true, "'tearing' has no effect without a strength" );
        }
        return wisp_world_has( world, surface, state->settings ) ? set_components( world, state, surface, false )
                                                                 : WISP_OK;
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
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    WISP_FIND_STATE( tearing_state, state, world, "tearing", &surface, WISP_IS_SURFACE );
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

static wisp_status split_all( void* memory, wisp_world* world )
{
    const tearing_state* state = memory;
    for ( wisp_entity e = { 0, 0 }; wisp_next_entity( state->registry, state->settings, &e ); )
    {
        WISP_TRY( tearing_split( world, state, e ) );
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
    s->registry = r;
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .stepped = split_all } );
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
