#include "implicit_internal.h"

#include "wisp/module/sleep.h"
#include <string.h>

IMPLICIT_COMPONENTS( WISP_COMPONENT_COLUMNS )

// ---- statistics ----

// Energies of the links, on request: plain loops in double precision, in a fixed order.

static const double PI = 3.14159265358979323846;

// sinc u = y on [0, pi] by Newton's method.
static double arc_angle( double y )
{
    double u = fmin( sqrt( 6.0 * fmax( 0.0, 1.0 - y ) ), PI );
    for ( int i = 0; i < 20 && u > 1e-6; ++i )
    {
        const double sine = sin( u ), slope = ( cos( u ) - sine / u ) / u, change = ( sine / u - y ) / slope;
        u = fmin( fmax( u - change, 1e-6 ), PI );
        if ( fabs( change ) < 1e-13 )
        {
            break;
        }
    }
    return u;
}

// f_b L^2 / k_b (Noh and Jung, eq. 11).
static double arc_load( double y )
{
    const double u = arc_angle( y );
    return u < 1e-2 ? -12.0 - 7.2 * ( 1.0 - y ) : 4.0 * u * u / ( cos( u ) - sin( u ) / u );
}

// y = 1 + q F(y). The iteration from y = 1 converges to the first intersection, since q F' < 1 up to it.
double implicit_ramp_end( double load, double ramp, double rest )
{
    if ( !( load > 0.0 && ramp > 0.0 && rest > 0.0 ) )
    {
        return 1.0;
    }
    const double q = load / ( ramp * rest );
    double y = 1.0;
    for ( int i = 0; i < 200; ++i )
    {
        const double next = 1.0 + q * arc_load( y ), change = next - y;
        y = next;
        if ( !( y > 0.0 ) )
        {
            return 0.0;
        }
        if ( fabs( change ) < 1e-13 )
        {
            break;
        }
    }
    return y;
}

// The potential of eq. 12: the integral of the force from the rest length down. Along the arc it is a difference of
// 1/2 k_b L kappa^2 = 2 k_b / L u^2.
static double bend_energy( double load, double ramp, double rest, double length )
{
    if ( !( length < rest ) || load <= 0.0 )
    {
        return 0.0;
    }
    const double y = length / rest, meets = implicit_ramp_end( load, ramp, rest );
    const double straight = fmin( 1.0 - y, 1.0 - meets ) * rest;
    const double energy = 0.5 * ramp * straight * straight;
    if ( y >= meets )
    {
        return energy;
    }
    const double from = arc_angle( meets ), to = arc_angle( y );
    return energy + 2.0 * load * rest * ( to * to - from * from );
}

static double row_distance( const float* position, const implicit_links* links, int row, int other )
{
    const float *p = position + (size_t)links->row_slot[row] * 4, *q = position + (size_t)links->row_slot[other] * 4;
    const double d[3] = { (double)q[0] - (double)p[0], (double)q[1] - (double)p[1], (double)q[2] - (double)p[2] };
    return sqrt( d[0] * d[0] + d[1] * d[1] + d[2] * d[2] );
}

// Each link is listed at both ends, and counts at the lower row.
static void add_entry( const implicit_links* links, const float* position, float stiffest, int slice, int entry,
                       bool bends, wisp_implicit_cloth_stats* out )
{
    const float most = stiffest > 0.0f ? stiffest : INFINITY;
    for ( int lane = 0; lane < WISP_SLICE; ++lane )
    {
        const int row = slice * WISP_SLICE + lane, other = links->springs.other_x4[entry][lane] / 4;
        if ( other <= row )
        {
            continue;
        }
        const double length = row_distance( position, links, row, other );
        const double rest = (double)links->springs.rest[entry][lane],
                     load = (double)links->springs.stiffness[entry][lane];
        const double ramp = (double)fminf( links->springs.ramp_stiffness[entry][lane], most );
        const double over = fmax( 0.0, length - rest );
        out->stretch_energy += bends ? 0.0 : 0.5 * fmin( load, (double)most ) * over * over;
        out->bend_energy += bends ? bend_energy( load, ramp, rest, length ) : 0.0;
    }
}

// 1/2 D x' Q x, as a sum over pairs.
static double plate_energy( const implicit_links* links, const float* position )
{
    const wisp_plate_rows rows = wisp_plate_get_rows( links->plate );
    double sum = 0.0;
    for ( int row = 0; row < links->row_count; ++row )
    {
        for ( int entry = rows.begin[row / WISP_SLICE]; entry < rows.begin[row / WISP_SLICE + 1]; ++entry )
        {
            const int other = rows.other_x4[entry][row % WISP_SLICE] / 4;
            if ( other > row )
            {
                const double length = row_distance( position, links, row, other );
                sum += (double)rows.weight[entry][row % WISP_SLICE] * length * length;
            }
        }
    }
    return 0.5 * (double)links->rigidity * sum;
}

static void implicit_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const implicit_state* state = user;
    const implicit_links* links = wisp_find_object( state->links, span->entity );
    const implicit_counts* counts = wisp_frame_column( frame, span->entity, state->counts, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    wisp_implicit_cloth_stats stats = {
        .iterations = counts->iterations,
        .residual = counts->residual,
        .newton_iterations = counts->repeats,
        .stretch_links = links->stretch_count,
        .bend_links = links->bend_count,
        .max_neighbours = links->max_neighbours,
        .sticking = counts->sticking,
        .sliding = counts->sliding,
        .landing = counts->landing,
        .released = counts->released,
        .newton_residual = (double)counts->newton_residual,
    };
    for ( int slice = 0; slice < links->slice_count; ++slice )
    {
        const int32_t* parts = links->springs.begin + 2 * (size_t)slice;
        for ( int entry = parts[0]; entry < parts[2]; ++entry )
        {
            add_entry( links, position, counts->stiffest, slice, entry, entry >= parts[1], &stats );
        }
    }
    stats.bend_energy += links->plate != NULL ? plate_energy( links, position ) : 0.0;
    *(wisp_implicit_cloth_stats*)wisp_frame_column( frame, span->entity, state->stats, 0 ) = stats;
}

// ---- module ----

static const wisp_field IMPLICIT_CLOTH_FIELDS[] = {
    WISP_CHOICE( wisp_implicit_cloth_def, stiffness_model, WISP_IMPLICIT_STIFFNESS_MATERIAL,
                 WISP_IMPLICIT_STIFFNESS_COUNT ),
    WISP_NUMBER( wisp_implicit_cloth_def, stretch_stiffness, 200, 0, 1e9, "N/m" ),
    WISP_NUMBER( wisp_implicit_cloth_def, bend_stiffness, 1e-6, 0, 1e9, "N m^2" ),
    WISP_NUMBER( wisp_implicit_cloth_def, bend_rigidity, 5e-5, 0, 1e9, "N m" ),
    WISP_NUMBER( wisp_implicit_cloth_def, compression_stiffness, 0, 0, 1e9, "N/m" ),
    WISP_NUMBER( wisp_implicit_cloth_def, link_damping, 0.02, 0, 1e9, "N s/m" ),
    WISP_CHOICE( wisp_implicit_cloth_def, weights, WISP_IMPLICIT_WEIGHTS_NONE, WISP_IMPLICIT_WEIGHTS_COUNT ),
    WISP_CHOICE( wisp_implicit_cloth_def, integrator, WISP_INTEGRATOR_EULER, WISP_INTEGRATOR_COUNT ),
    WISP_WHOLE( wisp_implicit_cloth_def, newton_iterations, 1, 1, 64 ),
    WISP_WHOLE( wisp_implicit_cloth_def, max_newton_iterations, 16, 1, 64 ),
    WISP_NUMBER( wisp_implicit_cloth_def, tolerance, 1e-2, 1e-7, 0.1, NULL ),
    WISP_WHOLE( wisp_implicit_cloth_def, max_iterations, 0, 0, 1000000 ),
};
WISP_DEFINE( implicit_cloth_def, "implicit cloth", IMPLICIT_CLOTH_FIELDS )

// ---- state ----

static wisp_status entity_teleported( void* memory, wisp_world* world, wisp_entity entity,
                                      const wisp_teleport_motion* teleport, bool* is_moved )
{
    (void)is_moved;
    const implicit_state* state = memory;
    implicit_material* material = wisp_world_column( world, entity, state->material, 0 );
    if ( material != NULL )
    {
        const int slots = wisp_world_fabric( world, entity )->slot_count;
        wisp_teleport_rows( teleport, NULL, wisp_world_column( world, entity, state->history, 1 ), slots, 4 );
        wisp_teleport_rows( teleport, NULL, wisp_world_column( world, entity, state->change, 0 ), slots, 3 );
        // The two substeps before differ by a velocity that has become zero: BDF2 starts again.
        material->before = teleport->keep_velocity ? material->before : 0.0f;
    }
    return WISP_OK;
}

// As wisp_sleep_hooks.rested: BDF2 starts again, so that what was kept of the substep before is not read.
static void entity_rested( const void* memory, wisp_world* world, wisp_entity entity )
{
    const implicit_state* state = memory;
    implicit_material* material = wisp_world_column( world, entity, state->material, 0 );
    if ( material != NULL )
    {
        material->before = 0.0f;
    }
}

static size_t links_bytes( const void* memory )
{
    const implicit_links* links = memory;
    return links->bytes + wisp_plate_bytes( links->plate );
}

static wisp_status declare_passes( wisp_registry* r, implicit_state* state )
{
    const wisp_pass step = {
        WISP_PASS( "implicit_cloth.step", PREDICT, ENTITY, implicit_step ),
        .required = { state->material, WISP_PARTICLE_EXTERNAL_SOLVER, WISP_PARTICLE_CONTACTS, state->contact },
        .excluded = { state->corrected },
        .reads = { state->material, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_CONTACTS,
                   state->contact },
        .writes = { WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY, WISP_PARTICLE_CONTACTS, state->contact,
                    state->material, state->counts },
    };
    wisp_pass corrected_step = step;
    corrected_step.name = "implicit_cloth.step_before_contact";
    corrected_step.required[4] = state->corrected;
    corrected_step.excluded[0] = 0;
    corrected_step.writes[6] = WISP_PARTICLE_PREVIOUS;
    corrected_step.writes[7] = WISP_PARTICLE_HALF_SPACES;
    corrected_step.writes[8] = state->solved;
    const wisp_pass passes[] = {
        step,
        corrected_step,
        {
            WISP_PASS( "implicit_cloth.take_correction", VELOCITY, ENTITY, implicit_take_correction ),
            .required = { state->material, state->corrected },
            .reads = { WISP_PARTICLE_POSITION, WISP_PARTICLE_PREVIOUS, state->solved },
            // changed, not replaced: listed so because the largest speed limits the result
            .writes = { WISP_PARTICLE_VELOCITY },
        },
        {
            WISP_PASS( "implicit_cloth.stats", OBSERVE, ENTITY, implicit_measure ),
            .required = { state->material, state->counts },
            .reads = { state->counts, WISP_PARTICLE_POSITION },
            .writes = { state->stats },
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), state );
}

static wisp_status declare( wisp_registry* r )
{
    implicit_state* s = wisp_declare_state( r, sizeof( implicit_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .teleported = entity_teleported,
                                                  .sleep = &( wisp_sleep_hooks ){ .rested = entity_rested } } );
    s->links = wisp_declare_objects( r, implicit_links_release, links_bytes );
    IMPLICIT_COMPONENTS( WISP_COMPONENT_DECLARE )
    wisp_declare_places( r, s->history, 0, WISP_PLACE_QUADS );
    const wisp_index_range ranges[] = {
        WISP_MEMBER_RANGE( s->material, implicit_material, bdf2, 0, 1 ),
        WISP_MEMBER_RANGE( s->material, implicit_material, newton_iterations, 1, 64 ),
        WISP_MEMBER_RANGE( s->material, implicit_material, max_newton_iterations, 1, 64 ),
        WISP_MEMBER_RANGE( s->material, implicit_material, max_iterations, 0, 1000000 ),
        WISP_MEMBER_RANGE( s->material, implicit_material, requests_stats, 0, 1 ),
        WISP_MEMBER_RANGE( s->contact, implicit_contact, slides, 0, 1 ),
        WISP_MEMBER_RANGE( s->contact, implicit_contact, landed, 0, 1 ),
    };
    WISP_TRY( wisp_declare_indices( r, ranges, WISP_COUNT( ranges ) ) );
    return declare_passes( r, s );
}

const wisp_module wisp_implicit_cloth_module = { .name = "implicit_cloth", .declare = declare };

// ---- checks ----

static wisp_status check_pairs( wisp_world* world, const wisp_implicit_cloth_def* d )
{
    const bool given = d->stretch_pair_count > 0 || d->bend_pair_count > 0;
    if ( given && d->stiffness_model == WISP_IMPLICIT_STIFFNESS_MATERIAL )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "implicit cloth: explicit pairs have no area, expected stiffness per link" );
    }
    return WISP_OK;
}

// Refuse a surface that another solver moves.
static wisp_status check_alone( wisp_world* world, wisp_entity surface, const implicit_state* state )
{
    const wisp_component others[] = { WISP_LINK_STIFFNESS,  WISP_LINK_COMPLIANCE, WISP_HINGE_STIFFNESS,
                                      WISP_SURFACE_TETHERS, WISP_SURFACE_LEVELS,  WISP_LINK_LIMIT,
                                      WISP_SURFACE_ELASTIC };
    for ( int i = 0; i < WISP_COUNT( others ); ++i )
    {
        if ( wisp_world_has( world, surface, others[i] ) )
        {
            return wisp_world_fail(
                world, WISP_CONFLICT,
                "implicit cloth: entity %u already has constraints: it is a cloth, a balloon, a membrane, or has "
                "strain limits",
                surface.index );
        }
    }
    if ( wisp_world_has( world, surface, WISP_PARTICLE_EXTERNAL_SOLVER ) &&
         wisp_world_has( world, surface, state->material ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "implicit cloth: entity %u already has another solver",
                                surface.index );
    }
    return WISP_OK;
}

// ---- components ----

static wisp_status set_components( wisp_world* world, wisp_entity surface, const implicit_state* state,
                                   const wisp_implicit_cloth_def* d )
{
    const wisp_component_use all[] = {
        { state->material, true },
        { state->counts, true },
        { WISP_PARTICLE_EXTERNAL_SOLVER, true },
        { WISP_PARTICLE_CONTACTS, true },
        { state->contact, true },
        { state->change, true },
        { state->history, d->integrator == WISP_INTEGRATOR_BDF2 },
    };
    return wisp_world_set_components( world, surface, all, WISP_COUNT( all ) );
}

static void fill( wisp_world* world, wisp_entity surface, const implicit_state* state,
                  const wisp_implicit_cloth_def* d )
{
    implicit_material* m = wisp_world_column( world, surface, state->material, 0 );
    *m = ( implicit_material ){
        .bdf2 = d->integrator == WISP_INTEGRATOR_BDF2,
        .newton_iterations = d->newton_iterations,
        .max_newton_iterations = d->max_newton_iterations,
        .max_iterations = d->max_iterations,
        .requests_stats = m->requests_stats,
        .tolerance = d->tolerance,
    };
    *(int32_t*)wisp_world_column( world, surface, WISP_PARTICLE_EXTERNAL_SOLVER, 0 ) = 1;
}

// ---- public functions ----

wisp_status wisp_set_implicit_cloth( wisp_world* world, wisp_entity surface, const wisp_implicit_cloth_def* given )
{
    wisp_implicit_cloth_def values;
    const wisp_implicit_cloth_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &surface, &wisp_implicit_cloth_def_fields, &values, given ) );
    WISP_FIND_STATE( implicit_state, state, world, "implicit_cloth", &surface, WISP_IS_SURFACE );
    WISP_TRY( check_pairs( world, def ) );
    WISP_TRY( check_alone( world, surface, state ) );
    if ( wisp_reserve_object( state->links, surface ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for another implicit cloth" );
    }
    implicit_links* links = NULL;
    wisp_status status = implicit_links_create( world, surface, def, &links );
    status = status == WISP_OK ? set_components( world, surface, state, def ) : status;
    if ( status != WISP_OK )
    {
        implicit_links_release( links, wisp_world_allocator( world ) );
        return status;
    }
    wisp_set_object( state->links, surface, links );
    fill( world, surface, state, def );
    return WISP_OK;
}

static wisp_status find_cloth( wisp_world* world, wisp_entity surface, implicit_state** out )
{
    WISP_FIND_STATE( implicit_state, state, world, "implicit_cloth", &surface, WISP_IS_SURFACE );
    *out = state;
    return wisp_world_has( world, surface, state->material )
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "entity %u: is not an implicit cloth", surface.index );
}

wisp_status wisp_request_implicit_cloth_stats( wisp_world* world, wisp_entity surface, bool requested )
{
    implicit_state* state;
    WISP_TRY( find_cloth( world, surface, &state ) );
    WISP_TRY( wisp_world_request( world, surface, state->stats, requested ) );
    implicit_material* m = wisp_world_column( world, surface, state->material, 0 );
    m->requests_stats = requested ? 1 : 0;
    return WISP_OK;
}

wisp_status wisp_read_implicit_cloth_stats( wisp_world* world, wisp_entity surface, wisp_implicit_cloth_stats* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    implicit_state* state;
    WISP_TRY( find_cloth( world, surface, &state ) );
    const wisp_implicit_cloth_stats* stats = wisp_world_column( world, surface, state->stats, 0 );
    if ( stats == NULL || stats->newton_iterations == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "entity %u: has no statistics of implicit cloth, request them before a step",
                                surface.index );
    }
    *out = *stats;
    return WISP_OK;
}
