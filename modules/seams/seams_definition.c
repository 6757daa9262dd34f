// Seams: the calls of the host. In: wisp_seam_def. Out: an entity with rows of pairs, and its place in the list.
#include "seams_state.h"

#include <math.h>
#include <string.h>

SEAMS_COMPONENTS( WISP_COMPONENT_COLUMNS )

static const wisp_field SEAM_FIELDS[] = {
    WISP_NUMBER( wisp_seam_def, within, 0, 0, 1e6, "m" ),
    WISP_NUMBER( wisp_seam_def, distance, 0, 0, 1e6, "m" ),
    WISP_NUMBER( wisp_seam_def, closing_speed, 1, 1e-9, INFINITY, "m/s" ),
    WISP_NUMBER( wisp_seam_def, compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_seam_def, strength, INFINITY, 1e-12, INFINITY, "N" ),
};
WISP_DEFINE( seam_def, "seams", SEAM_FIELDS )

static bool joins( const seam_topology* s, wisp_entity surface )
{
    return wisp_entity_equal( s->a, surface ) || wisp_entity_equal( s->b, surface );
}

static bool is_sewn( const seams_state* state, wisp_entity surface )
{
    const seam_topology* s;
    bool found = false;
    for ( int place = 0; ( s = wisp_next_object( state->seams, &place ) ) != NULL; )
    {
        found = found || joins( s, surface );
    }
    return found;
}

// ---- adding ----

static wisp_status check_def( wisp_world* world, const wisp_seam_def* d )
{
    if ( d->within > 0.0f )
    {
        return d->pair_count != 0 ? wisp_world_fail( world, WISP_BAD_INPUT,
                                                     "seams: got %d pairs and within %g m, expected one of the two",
                                                     d->pair_count, (double)d->within )
               : wisp_entity_equal( d->a, d->b )
                   ? wisp_world_fail(
                         world, WISP_CONFLICT,
                         "seams: within: got entity %u twice; a surface that is sewn to itself needs pairs",
                         d->a.index )
                   : WISP_OK;
    }
    WISP_TRY( wisp_world_check_list( world, "pairs", d->pairs, d->pair_count ) );
    return d->pair_count > 0 && d->pair_count <= INT32_MAX / 4
               ? WISP_OK
               : wisp_world_fail( world, WISP_BAD_INPUT, "seams: got %d pairs, expected 1 to %d", d->pair_count,
                                  INT32_MAX / 4 );
}

// Have the entity whose pass projects all seams.
static wisp_status have_hub( wisp_world* world, seams_state* state )
{
    if ( wisp_is_alive( world, state->hub ) == false )
    {
        WISP_TRY( wisp_world_add_pairs( world, 0, &state->hub ) );
    }
    WISP_TRY( wisp_world_attach( world, state->hub, state->active ) );
    return wisp_world_request( world, state->hub, state->result, true );
}

// Undo what a failed call did to surfaces and hub, as far as no other seam needs it.
static void tidy( wisp_world* world, seams_state* state, const wisp_entity surfaces[2] )
{
    for ( int k = 0; k < 2; ++k )
    {
        if ( wisp_is_alive( world, surfaces[k] ) && is_sewn( state, surfaces[k] ) == false )
        {
            wisp_world_detach( world, surfaces[k], state->sewn );
        }
    }
    const seam_topology* s;
    bool is_needed = false;
    for ( int place = 0; ( s = wisp_next_object( state->seams, &place ) ) != NULL; )
    {
        is_needed = is_needed || s->a.index != 0;
    }
    if ( is_needed == false && wisp_is_alive( world, state->hub ) )
    {
        wisp_world_request( world, state->hub, state->result, false );
        wisp_world_detach( world, state->hub, state->active );
    }
}

static wisp_status attach_all( wisp_world* world, seams_state* state, seam_topology* s )
{
    WISP_TRY( wisp_world_add_pairs( world, s->pair_count, &s->entity ) );
    if ( wisp_reserve_object( state->seams, s->entity ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for another seam" );
    }
    WISP_TRY( wisp_world_attach( world, s->entity, state->settings ) );
    WISP_TRY( wisp_world_attach( world, s->entity, state->pairs ) );
    wisp_world_tie( world, s->a, s->b );
    WISP_TRY( wisp_world_attach( world, s->a, state->sewn ) );
    WISP_TRY( wisp_world_attach( world, s->b, state->sewn ) );
    // positions and velocities are there from the start, but a surface that nobody looks at makes no passes without a request
    WISP_TRY( wisp_world_request( world, s->a, WISP_PARTICLE_POSITION, true ) );
    WISP_TRY( wisp_world_request( world, s->b, WISP_PARTICLE_POSITION, true ) );
    return have_hub( world, state );
}

// @param d receives the difference from the vertex of b to that of a @return its length, m
static float opening_of( wisp_world* world, const seam_topology* s, int row, float d[3] )
{
    const float* a = (const float*)wisp_world_column( world, s->a, WISP_PARTICLE_POSITION, 0 ) + s->ends_x4[2 * row];
    const float* b =
        (const float*)wisp_world_column( world, s->b, WISP_PARTICLE_POSITION, 0 ) + s->ends_x4[2 * row + 1];
    for ( int k = 0; k < 3; ++k )
    {
        d[k] = a[k] - b[k];
    }
    return sqrtf( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
}

static void fill( wisp_world* world, const seams_state* state, const seam_topology* s, const wisp_seam_def* def )
{
    seam_settings* settings = wisp_world_column( world, s->entity, state->settings, 0 );
    float* rest = wisp_world_column( world, s->entity, state->pairs, 0 );
    *settings = ( seam_settings ){ .distance = def->distance,
                                   .closing_speed = def->closing_speed,
                                   .compliance = def->compliance,
                                   .strength = def->strength };
    for ( int row = 0; row < s->pair_count; ++row )
    {
        float d[3];
        rest[row] = opening_of( world, s, row, d );
    }
}

// Neither vertex of such a pair moves by the seam.
static void warn_of_pins( wisp_world* world, const seam_topology* s )
{
    const float *a = wisp_world_column( world, s->a, WISP_PARTICLE_POSITION, 0 ),
                *b = wisp_world_column( world, s->b, WISP_PARTICLE_POSITION, 0 );
    int count = 0, first = 0;
    for ( int row = s->pair_count - 1; row >= 0; --row )
    {
        const bool is_pinned = a[s->ends_x4[2 * row] + 3] == 0.0f && b[s->ends_x4[2 * row + 1] + 3] == 0.0f;
        count += is_pinned ? 1 : 0;
        first = is_pinned ? row : first;
    }
    if ( count > 0 )
    {
        wisp_world_warn( world,
                         "seams: %d of %d pairs of entity %u join two pinned vertices, which the seam does not move, "
                         "the first vertex %d of a and %d of b",
                         count, s->pair_count, s->entity.index,
                         wisp_world_fabric( world, s->a )->slot_vertex[s->ends_x4[2 * first] / 4],
                         wisp_world_fabric( world, s->b )->slot_vertex[s->ends_x4[2 * first + 1] / 4] );
    }
}

static wisp_status begin( wisp_world* world, const wisp_seam_def* given, wisp_seam_def* def, seams_state** state )
{
    WISP_TRY( wisp_world_begin_def( world, NULL, &wisp_seam_def_fields, def, given ) );
    void* found;
    WISP_TRY( wisp_world_find_state( world, "seams", &def->a, WISP_IS_SURFACE, &found ) );
    WISP_TRY( wisp_world_find_state( world, "seams", &def->b, WISP_IS_SURFACE, &found ) );
    *state = found;
    return check_def( world, def );
}

wisp_status wisp_add_seam( wisp_world* world, const wisp_seam_def* given, wisp_entity* out )
{
    wisp_seam_def def = wisp_default_seam_def();
    seams_state* state;
    if ( out != NULL )
    {
        *out = ( wisp_entity ){ 0, 0 };
    }
    WISP_TRY( begin( world, given, &def, &state ) );
    WISP_TRY( wisp_world_check_pointer( world, "out", out ) );
    seam_topology* s;
    WISP_TRY( seams_cook_pairs( world, &def, &s ) );
    const wisp_status status = attach_all( world, state, s );
    if ( status != WISP_OK )
    {
        int place = 0;
        wisp_world_remove( world, s->entity );
        tidy( world, state, ( const wisp_entity[2] ){ def.a, def.b } );
        if ( wisp_next_object( state->seams, &place ) == NULL && wisp_is_alive( world, state->hub ) )
        {
            wisp_world_remove( world, state->hub );
        }
        wisp_release( wisp_world_allocator( world ), s, seams_bytes( s ) );
        return status;
    }
    fill( world, state, s, &def );
    warn_of_pins( world, s );
    wisp_set_object( state->seams, s->entity, s );
    *out = s->entity;
    return WISP_OK;
}

// ---- reading ----

static seam_topology* whole_seam( wisp_world* world, wisp_entity entity, seams_state** state )
{
    *state = world != NULL ? wisp_world_module_state( world, "seams" ) : NULL;
    seam_topology* s = *state != NULL ? wisp_find_object( ( *state )->seams, entity ) : NULL;
    return s != NULL && s->a.index != 0 ? s : NULL;
}

int wisp_count_seam_pairs( wisp_world* world, wisp_entity entity )
{
    seams_state* state;
    const seam_topology* s = whole_seam( world, entity, &state );
    return s != NULL ? s->pair_count : 0;
}

int wisp_count_broken_seam_pairs( wisp_world* world, wisp_entity entity )
{
    seams_state* state;
    const seam_topology* s = whole_seam( world, entity, &state );
    const int32_t* broken = s != NULL ? wisp_world_column( world, entity, state->pairs, 2 ) : NULL;
    int count = 0;
    for ( int row = 0; broken != NULL && row < s->pair_count; ++row )
    {
        count += broken[row];
    }
    return count;
}

// ---- module ----

// The module: components and the pass.

static void entity_removed( void* memory, wisp_world* world, wisp_entity entity )
{
    seams_state* state = memory;
    seam_topology* s;
    for ( int place = 0; ( s = wisp_next_object( state->seams, &place ) ) != NULL; )
    {
        const wisp_entity surfaces[2] = { s->a, s->b };
        if ( wisp_entity_equal( s->entity, entity ) || joins( s, entity ) )
        {
            s->a = s->b = ( wisp_entity ){ 0, 0 };
            tidy( world, state, surfaces );
        }
    }
}

static void release_seam( void* seam, const wisp_allocator* allocator )
{
    wisp_release( allocator, seam, seams_bytes( seam ) );
}

static wisp_status declare( wisp_registry* r )
{
    seams_state* s = wisp_declare_state( r, sizeof( seams_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .removed = entity_removed } );
    s->seams = wisp_declare_objects( r, release_seam, seams_bytes );
    SEAMS_COMPONENTS( WISP_COMPONENT_DECLARE )
    const wisp_index_range broken = WISP_COLUMN_RANGE( s->pairs, 2, 0, 1 );
    WISP_TRY( wisp_declare_indices( r, &broken, 1 ) );
    const wisp_pass passes[] = {
        {
            WISP_PASS( "seams.project", PROJECT, ENTITY, seams_project ),
            .required = { s->active },
            .reads = { s->active },
            .writes = { s->result },
            .foreign = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .among = s->sewn,
        },
    };
    return s->result != 0 ? wisp_declare_passes( r, passes, WISP_COUNT( passes ), s ) : WISP_BAD_INPUT;
}

const wisp_module wisp_seams_module = { .name = "seams", .declare = declare };
