#include "cloth_internal.h"

#include "wisp/module/vec.h"
#include <math.h>
#include <string.h>

CLOTH_COMPONENTS( WISP_COMPONENT_COLUMNS )

// ---- damping ----

// Damping that does not touch rigid motion (Mueller et al. 2007, section 3.5): it reduces the
// difference between a velocity and the rigid motion with the same momentum and angular momentum.

// What each velocity loses in this substep. @return null without memory
static const float* list_fractions( wisp_frame* frame, const wisp_span* span, float lost, const float* factor )
{
    const int count = wisp_frame_fabric( frame, span->entity )->slot_count;
    float* fractions =
        wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, (size_t)count * sizeof( float ) );
    if ( fractions == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the damping of %d particles", count );
        return NULL;
    }
    for ( int slot = 0; slot < count; ++slot )
    {
        const float own = lost * factor[slot];
        fractions[slot] = own / ( 1.0f + own );
    }
    return fractions;
}

static float lost_by( wisp_frame* frame, wisp_entity entity, const cloth_state* state )
{
    const float rate = *(float*)wisp_frame_column( frame, entity, state->damping, 0 );
    return rate * wisp_frame_dt( frame, entity );
}

static void cloth_damp( wisp_frame* frame, const wisp_span* span, void* user )
{
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const float lost = lost_by( frame, span->entity, state );
    wisp_rigid_args args = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .fraction = lost / ( 1.0f + lost ),
    };
    const float* factor = wisp_frame_column( frame, span->entity, WISP_MAP_INTERNAL_DAMPING, 0 );
    if ( factor != NULL )
    {
        args.fractions = list_fractions( frame, span, lost, factor );
        if ( args.fractions == NULL )
        {
            return;
        }
    }
    wisp_approach_rigid_motion( wisp_frame_kernels( frame ), wisp_frame_parallel( frame, span ), fabric, &args );
}

static bool cloth_damps_evenly( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)user;
    return wisp_frame_has( frame, entity, WISP_MAP_INTERNAL_DAMPING ) == false;
}

static void cloth_damp_crowd( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user )
{
    (void)span;
    wisp_rigid_args args[WISP_INSTANCE_LANES] = { { 0 } };
    for ( int lane = 0; lane < WISP_INSTANCE_LANES; ++lane )
    {
        const float lost = lost_by( frame, crowd->entities[lane], user );
        args[lane].fraction = lost / ( 1.0f + lost );
    }
    wisp_approach_rigid_motions( wisp_frame_kernels( frame ), crowd, args );
}

// ---- air ----

// Air on triangles: sums over strips, then a change of the velocities.

WISP_KERNEL_LOOP( air_loop, blow_slices, blow, wisp_strip_air_args, 1 )

static void sum_air( const void* context, int begin, int end )
{
    const air_loop* loop = context;
    loop->kernels->strip_air( &loop->args, begin, end );
}

// Zeros for sums of air. @return null without memory
static float* begin_sums( wisp_frame* frame, const wisp_span* span, int slot_count, size_t instances )
{
    const size_t bytes = (size_t)slot_count * 4 * instances * sizeof( float );
    float* sums = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, bytes );
    if ( sums == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the air on %d particles", slot_count );
        return NULL;
    }
    return memset( sums, 0, bytes );
}

static void cloth_blow( wisp_frame* frame, const wisp_span* span, void* user )
{
    enum
    {
        GRAIN = 64, // slices
    };
    const cloth_state* state = user;
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const cloth_air* air = wisp_frame_column( frame, span->entity, state->air, 0 );
    air_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                  .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
                  .sum = begin_sums( frame, span, fabric->slot_count, 1 ),
                  .strips = fabric->strips,
                  .wind = air->wind,
                  .density = air->density,
                  .drag = air->drag,
                  .lift = air->lift,
                  .dt = wisp_frame_dt( frame, span->entity ),
                  .drag_factor = wisp_frame_column( frame, span->entity, WISP_MAP_DRAG, 0 ),
                  .lift_factor = wisp_frame_column( frame, span->entity, WISP_MAP_LIFT, 0 ) },
    };
    if ( loop.args.sum != NULL )
    {
        wisp_run_schedule( parallel, &fabric->strips.order, sum_air, &loop );
        wisp_parallel_for( parallel, fabric->slot_count / WISP_FABRIC_LANES, GRAIN, blow_slices, &loop );
    }
}

static bool cloth_blows_evenly( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)user;
    return wisp_frame_has( frame, entity, WISP_MAP_DRAG ) == false &&
           wisp_frame_has( frame, entity, WISP_MAP_LIFT ) == false;
}

static void cloth_blow_crowd( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user )
{
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, crowd->entities[0] );
    wisp_instances_air_args args = { .sum = begin_sums( frame, span, fabric->slot_count, WISP_INSTANCE_LANES ),
                                     .strips = fabric->strips };
    if ( args.sum == NULL )
    {
        return;
    }
    for ( int lane = 0; lane < WISP_INSTANCE_LANES; ++lane )
    {
        const cloth_air* air = wisp_frame_column( frame, crowd->entities[lane], state->air, 0 );
        args.wind[lane] = air->wind.x;
        args.wind[WISP_INSTANCE_LANES + lane] = air->wind.y;
        args.wind[2 * WISP_INSTANCE_LANES + lane] = air->wind.z;
        args.density[lane] = air->density;
        args.drag[lane] = air->drag;
        args.lift[lane] = air->lift;
    }
    wisp_frame_kernels( frame )->instances_air( crowd->args, &args );
}

// ---- module ----

static const wisp_field CLOTH_FIELDS[] = {
    WISP_CHOICE( wisp_cloth_def, solver, WISP_SOLVER_XPBD, WISP_SOLVER_COUNT ),
    WISP_NUMBER( wisp_cloth_def, warp_compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_cloth_def, weft_compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_cloth_def, shear_compliance, 0, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_cloth_def, stretch_stiffness, 1, 0, 1, NULL ),
    WISP_NUMBER( wisp_cloth_def, shear_stiffness, 1, 0, 1, NULL ),
    WISP_VECTOR( wisp_cloth_def, warp, 1e-6, 1e6, NULL, 1 ),
    WISP_CHOICE( wisp_cloth_def, bending, WISP_CLOTH_BENDING_LINKS, WISP_CLOTH_BENDING_COUNT ),
    WISP_NUMBER( wisp_cloth_def, bend_stiffness, 0.2, 0, 1, NULL ),
    WISP_NUMBER( wisp_cloth_def, bend_compliance, 0.1, 0, 1e12, "m/N" ),
    WISP_NUMBER( wisp_cloth_def, bend_rigidity, 5e-6, 1e-12, 1e12, "N m" ),
    WISP_NUMBER( wisp_cloth_def, internal_damping, 3, 0, 1e9, "1/s" ),
    WISP_VECTOR( wisp_cloth_def, wind, 0, 1e5, "m/s", 0 ),
    WISP_NUMBER( wisp_cloth_def, air_density, 1.204, 0, 1e6, "kg/m^3" ),
    WISP_NUMBER( wisp_cloth_def, drag_coefficient, 0, 0, 1e6, NULL ),
    WISP_NUMBER( wisp_cloth_def, lift_coefficient, 0, 0, 1e6, NULL ),
    WISP_SWITCH( wisp_cloth_def, tethers, false ),
    WISP_NUMBER( wisp_cloth_def, tether_slack, 1, 1, 1e6, NULL ),
    WISP_WHOLE_OR( wisp_cloth_def, coarse_substeps, -1, 0, 64 ),
    WISP_WHOLE( wisp_cloth_def, coarse_passes, 10, 1, 64 ),
};
WISP_DEFINE( cloth_def, "cloth", CLOTH_FIELDS )

// ---- state ----

static size_t plate_bytes( const void* memory )
{
    const cloth_plate* mine = memory;
    return sizeof( *mine ) + wisp_plate_bytes( mine->plate );
}

// A plate is made of a fabric. Without memory for another one the surface no longer resists bending.
static wisp_status triangles_changed( void* memory, wisp_world* world, wisp_entity surface,
                                      const wisp_fabric* before )
{
    (void)before;
    const cloth_state* state = memory;
    const cloth_plate* mine = wisp_find_object( state->plates, surface );
    if ( mine == NULL )
    {
        return WISP_OK;
    }
    const bool by_angle = wisp_plate_get_turns( mine->plate ).begin != NULL;
    wisp_set_object( state->plates, surface, NULL );
    const wisp_status status = cloth_add_plate( world, state, surface, by_angle );
    if ( status != WISP_OK )
    {
        (void)wisp_world_detach( world, surface, state->bending );
    }
    return status;
}

static void declare_maps( wisp_registry* r, const cloth_state* state )
{
    wisp_declare_map( r, WISP_MAP_STRETCH_COMPLIANCE, WISP_LINK_COMPLIANCE, NULL );
    wisp_declare_map( r, WISP_MAP_STRETCH_STIFFNESS, WISP_LINK_STIFFNESS, NULL );
    wisp_declare_map( r, WISP_MAP_BEND_COMPLIANCE, WISP_LINK_COMPLIANCE, NULL );
    wisp_declare_map( r, WISP_MAP_BEND_STIFFNESS, WISP_LINK_STIFFNESS, NULL );
    wisp_declare_map( r, WISP_MAP_BEND_RIGIDITY, state->bending, NULL );
    wisp_declare_map( r, WISP_MAP_INTERNAL_DAMPING, state->damping, NULL );
    wisp_declare_map( r, WISP_MAP_DRAG, state->air, NULL );
    wisp_declare_map( r, WISP_MAP_LIFT, state->air, NULL );
}

static wisp_status declare( wisp_registry* r )
{
    cloth_state* s = wisp_declare_state( r, sizeof( cloth_state ) );
    if ( s == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .triangles_changed = triangles_changed } );
    s->plates = wisp_declare_objects( r, cloth_release_plate, plate_bytes );
    CLOTH_COMPONENTS( WISP_COMPONENT_DECLARE )
    declare_maps( r, s );
    const wisp_pass passes[] = {
        {
            WISP_PASS( "cloth.air", FORCE, ENTITY, cloth_blow ),
            .required = { s->air },
            .reads = { s->air, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
            .run_crowd = cloth_blow_crowd,
            .joins_crowd = cloth_blows_evenly,
            .fabric = WISP_FABRIC_STRIPS,
        },
        {
            WISP_PASS( "cloth.bending", FORCE, ENTITY, cloth_bend ),
            .required = { s->bending },
            .reads = { s->bending, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
            .detail = WISP_PASS_FINE,
        },
        {
            WISP_PASS( "cloth.damping", VELOCITY, ENTITY, cloth_damp ),
            .required = { s->damping },
            .reads = { s->damping, WISP_PARTICLE_POSITION, WISP_PARTICLE_VELOCITY },
            .writes = { WISP_PARTICLE_VELOCITY },
            .run_crowd = cloth_damp_crowd,
            .joins_crowd = cloth_damps_evenly,
            .detail = WISP_PASS_FINE,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), s );
}

const wisp_module wisp_cloth_module = { .name = "cloth", .declare = declare };

// ---- checks ----

// A membrane has no links, and so no sheets of links either.
static wisp_status check_membrane( wisp_world* world, wisp_entity surface, const wisp_cloth_def* d, bool is_membrane )
{
    const char* links = d->bending == WISP_CLOTH_BENDING_LINKS ? "bending by links" : "coarse sheets";
    return is_membrane && ( d->bending == WISP_CLOTH_BENDING_LINKS || d->coarse_substeps > 0 )
               ? wisp_world_fail( world, WISP_CONFLICT, "cloth: entity %u is a membrane, which has no %s",
                                  surface.index, links )
               : WISP_OK;
}

static wisp_status check_solver( wisp_world* world, const wisp_cloth_def* d )
{
    return d->coarse_substeps > 0 && d->solver == WISP_SOLVER_PBD
               ? wisp_world_fail( world, WISP_CONFLICT,
                                  "cloth: coarse_substeps: coarse sheets need the solver xpbd, got pbd" )
               : WISP_OK;
}

// Name what the fabric lacks when the cloth is set, not in a step.
static wisp_status check_fabric( wisp_world* world, const wisp_fabric* f, const wisp_cloth_def* d )
{
    const char* excluded = NULL;
    if ( d->bending == WISP_CLOTH_BENDING_LINKS && f->hinge_count > 0 && f->link_count == f->edge_count )
    {
        excluded = "bend links, which this bending model needs";
    }
    bool by_hinges = d->bending == WISP_CLOTH_BENDING_DIHEDRAL || d->bending == WISP_CLOTH_BENDING_ISOMETRIC;
    if ( by_hinges && f->hinge_count > 0 && f->hinge_order.slot_count == 0 )
    {
        excluded = "hinges, which this bending model needs";
    }
    if ( d->tethers && f->tether_count == 0 )
    {
        excluded = f->attachment_count > 0 ? "tethers" : "attachments, which tethers need";
    }
    if ( excluded != NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "cloth: the fabric was cooked without %s", excluded );
    }
    return WISP_OK;
}

static wisp_status check_alone( wisp_world* world, wisp_entity surface )
{
    return wisp_world_has( world, surface, WISP_PARTICLE_EXTERNAL_SOLVER )
               ? wisp_world_fail( world, WISP_CONFLICT, "cloth: entity %u already has another solver", surface.index )
               : WISP_OK;
}

// ---- components ----

// The components of the definition for which the fabric has rows. A mesh too small for a coarse sheet has none, and one
// without interior edges no hinges.
static wisp_status set_components( wisp_world* world, wisp_entity surface, const wisp_fabric* f,
                                   const wisp_cloth_def* d, const cloth_state* state )
{
    const bool pbd = d->solver == WISP_SOLVER_PBD, hinged = f->hinge_order.slot_count > 0;
    const bool dihedral = hinged && d->bending == WISP_CLOTH_BENDING_DIHEDRAL;
    const bool isometric = hinged && d->bending == WISP_CLOTH_BENDING_ISOMETRIC;
    const bool has_sheets = d->coarse_substeps > 0 && f->level_count > 0;
    const bool linked = wisp_world_has( world, surface, WISP_SURFACE_ELASTIC ) == false;
    float alike[2];
    const bool are_apart =
        cloth_find_alike( f, d, alike ) == false || wisp_world_has( world, surface, WISP_LINK_CONSTANT );
    const wisp_component_use all[] = {
        { state->air, d->drag_coefficient > 0.0f || d->lift_coefficient > 0.0f },
        { state->damping, d->internal_damping > 0.0f },
        { WISP_LINK_STIFFNESS, pbd && linked },
        { WISP_LINK_COMPLIANCE, pbd == false && linked },
        { WISP_LINK_OWN, linked && are_apart },
        { WISP_LINK_FOLDS, d->bending == WISP_CLOTH_BENDING_LINKS && f->link_count > f->edge_count },
        { WISP_HINGE_FOLDS, dihedral || isometric },
        { WISP_HINGE_REST, dihedral },
        { state->bending, ( dihedral || isometric ) && pbd == false },
        { WISP_HINGE_COTANGENT, isometric && pbd },
        { WISP_HINGE_STIFFNESS, ( dihedral || isometric ) && pbd },
        { WISP_SURFACE_TETHERS, d->tethers },
        { WISP_SURFACE_LEVELS, d->coarse_substeps > 0 },
        { WISP_LEVEL_MASS, has_sheets },
        { WISP_LEVEL_COMPLIANCE, has_sheets },
        { WISP_LEVEL_MOTION, has_sheets },
    };
    return wisp_world_set_components( world, surface, all, WISP_COUNT( all ) );
}

static void fill( wisp_world* world, wisp_entity surface, const wisp_cloth_def* d, const cloth_state* state )
{
    WISP_FILL( world, surface, state->air, cloth_air, d->wind, d->air_density, d->drag_coefficient,
               d->lift_coefficient );
    WISP_FILL( world, surface, state->damping, float, d->internal_damping );
    WISP_FILL( world, surface, state->bending, float, d->bend_rigidity );
    WISP_FILL( world, surface, WISP_LINK_FOLDS, float, d->bend_rigidity );
    WISP_FILL( world, surface, WISP_HINGE_FOLDS, float, d->bend_rigidity );
    WISP_FILL( world, surface, WISP_SURFACE_TETHERS, float, d->tether_slack );
    cloth_fill_links( world, surface, d );
    cloth_fill_levels( world, surface, d );
    if ( wisp_world_has( world, surface, WISP_HINGE_REST ) || wisp_world_has( world, surface, WISP_HINGE_COTANGENT ) )
    {
        cloth_fill_hinges( world, surface, d );
    }
    wisp_world_apply_maps( world, surface );
}

// ---- public functions ----

// Says what of a cloth that has asked for coarse sheets none carries.
static void warn_of_sheets( wisp_world* world, wisp_entity surface, const wisp_fabric* f )
{
    if ( f->level_count == 0 )
    {
        wisp_world_warn(
            world,
            "cloth: entity %u: coarse_substeps: the fabric has no coarse sheets. It was cooked without, or %d "
            "vertices are too few: about 600 are needed",
            surface.index, f->vertex_count );
    }
    else if ( f->levels[0].unlinked_count > 0 )
    {
        wisp_world_warn(
            world, "cloth: entity %u: %d of %d vertices are near no vertex of the coarse sheet and move on their own",
            surface.index, f->levels[0].unlinked_count, f->vertex_count );
    }
}

wisp_status wisp_set_cloth( wisp_world* world, wisp_entity surface, const wisp_cloth_def* given )
{
    wisp_cloth_def values;
    const wisp_cloth_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &surface, &wisp_cloth_def_fields, &values, given ) );
    WISP_FIND_STATE( cloth_state, state, world, "cloth", &surface, WISP_IS_SURFACE );
    WISP_TRY( check_alone( world, surface ) );
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const bool is_xpbd = def->solver == WISP_SOLVER_XPBD,
               is_membrane = wisp_world_has( world, surface, WISP_SURFACE_ELASTIC );
    if ( values.coarse_substeps < 0 )
    {
        values.coarse_substeps = f->level_count > 0 && is_membrane == false && is_xpbd ? 1 : 0;
    }
    WISP_TRY( check_solver( world, def ) );
    WISP_TRY( check_membrane( world, surface, def, is_membrane ) );
    WISP_TRY( check_fabric( world, f, def ) );
    const bool bends =
        f->hinge_order.slot_count > 0 && is_xpbd &&
        ( def->bending == WISP_CLOTH_BENDING_DIHEDRAL || def->bending == WISP_CLOTH_BENDING_ISOMETRIC );
    const bool had_sheets = wisp_world_has( world, surface, WISP_SURFACE_LEVELS );
    const bool keeps_plate = wisp_find_object( state->plates, surface ) != NULL;
    wisp_status status =
        bends ? cloth_add_plate( world, state, surface, def->bending == WISP_CLOTH_BENDING_DIHEDRAL ) : WISP_OK;
    status = status == WISP_OK ? set_components( world, surface, f, def, state ) : status;
    if ( status == WISP_OK ? bends == false : keeps_plate == false )
    {
        wisp_set_object( state->plates, surface, NULL );
    }
    WISP_TRY( status );
    fill( world, surface, def, state );
    const bool is_airless =
        ( def->drag_coefficient == 0.0f && def->lift_coefficient == 0.0f ) || def->air_density == 0.0f;
    wisp_world_tell( world, surface, is_airless && wisp_v3_length( def->wind ) > 0.0f,
                     "'wind' has no effect without drag_coefficient or lift_coefficient, and air_density" );
    if ( def->coarse_substeps > 0 && had_sheets == false )
    {
        warn_of_sheets( world, surface, f );
    }
    return WISP_OK;
}

wisp_status wisp_set_cloth_wind( wisp_world* world, wisp_entity surface, wisp_vec3 wind )
{
    WISP_FIND_STATE( cloth_state, state, world, "cloth", &surface, WISP_IS_SURFACE );
    WISP_TRY( wisp_world_check_values( world, &wisp_cloth_def_fields, "wind", &wind, 1, NULL ) );
    if ( wisp_world_has( world, surface, state->air ) == false )
    {
        const bool is_cloth = wisp_world_has( world, surface, WISP_LINK_COMPLIANCE ) ||
                              wisp_world_has( world, surface, WISP_LINK_STIFFNESS ) ||
                              wisp_world_has( world, surface, WISP_SURFACE_ELASTIC );
        if ( is_cloth == false )
        {
            return wisp_world_fail( world, WISP_CONFLICT, "cloth: entity %u is no cloth", surface.index );
        }
        const cloth_air air = { .density = wisp_default_cloth_def().air_density, .drag = 1.0f };
        WISP_TRY( wisp_world_set_row( world, surface, state->air, &air, sizeof( air ) ) );
    }
    cloth_air* air = wisp_world_column( world, surface, state->air, 0 );
    air->wind = wind;
    return WISP_OK;
}
