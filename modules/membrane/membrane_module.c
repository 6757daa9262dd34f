// Membranes: the triangles of each surface, the pass that projects them, and the calls of the host. Equations: the kernels of
// membranes in wisp/module/surface_kernels.h and docs/methods.md.
#include "membrane.h"

#include "wisp/module/components.h"
#include "wisp/module/elastic_triangles.h"
#include "wisp/module/module.h"

#include <string.h>

typedef struct membrane_state
{
    wisp_objects* meshes; // wisp_elastic_triangles
    bool has_iterations;
} membrane_state;

enum
{
    VIRIAL_GRAIN = 4096, // triangles a block: the unit of the sum
};

static const wisp_field MEMBRANE_FIELDS[] = {
    WISP_NUMBER( wisp_membrane_def, shear_modulus, 4e5, 1e-3, 1e12, "Pa" ),
    WISP_NUMBER( wisp_membrane_def, thickness, 2e-4, 1e-9, 1, "m" ),
    WISP_SWITCH( wisp_membrane_def, tension_field, false ),
};
WISP_DEFINE( membrane_def, "membrane", MEMBRANE_FIELDS )

// ---- state ----

static void release_mesh( void* mesh, const wisp_allocator* allocator )
{
    wisp_elastic_triangles_release( mesh, allocator );
}

static size_t mesh_bytes( const void* mesh )
{
    return wisp_elastic_triangles_bytes( mesh );
}

static wisp_status add_mesh( wisp_world* world, membrane_state* state, wisp_entity entity )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, entity );
    const wisp_allocator* allocator = wisp_world_allocator( world );
    wisp_elastic_triangles* mesh = NULL;
    if ( wisp_reserve_object( state->meshes, entity ) == false ||
         wisp_elastic_triangles_create( fabric, state->has_iterations, allocator, &mesh ) != WISP_OK )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "membrane: out of memory for %d triangles",
                                fabric->triangle_count );
    }
    wisp_set_object( state->meshes, entity, mesh );
    return WISP_OK;
}

// Without memory for the new triangles the surface is no membrane any more.
static wisp_status triangles_changed( void* memory, wisp_world* world, wisp_entity surface,
                                      const wisp_fabric* before )
{
    (void)before;
    membrane_state* state = memory;
    if ( wisp_find_object( state->meshes, surface ) == NULL )
    {
        return WISP_OK;
    }
    wisp_set_object( state->meshes, surface, NULL );
    const wisp_status status = add_mesh( world, state, surface );
    if ( status != WISP_OK )
    {
        (void)wisp_world_detach( world, surface, WISP_SURFACE_ELASTIC );
    }
    return status;
}

// ---- passes ----

typedef struct projection
{
    wisp_elastic_triangle_args args;
    const wisp_kernels* kernels;
    bool is_first; // iteration: the stress starts at 0
} projection;

static wisp_elastic_triangle_args find_args( wisp_frame* frame, const wisp_span* span,
                                             const wisp_elastic_triangles* mesh )
{
    wisp_elastic_triangle_args args = wisp_elastic_triangles_args( mesh );
    const float dt = wisp_frame_dt( frame, span->entity );
    args.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    args.stiffness = *(float*)wisp_frame_column( frame, span->entity, WISP_SURFACE_ELASTIC, 0 );
    args.tension_field = *(int32_t*)wisp_frame_column( frame, span->entity, WISP_SURFACE_ELASTIC, 1 ) != 0;
    args.dt2 = dt * dt;
    return args;
}

static void project_triangles( const void* context, int begin, int end )
{
    const projection* p = context;
    if ( p->is_first && p->args.stress != NULL )
    {
        memset( p->args.stress + 3 * (size_t)begin, 0, 3 * (size_t)( end - begin ) * sizeof( float ) );
    }
    p->kernels->elastic_triangle_project( &p->args, begin, end );
}

static void project( wisp_frame* frame, const wisp_span* span, void* user )
{
    const membrane_state* state = user;
    const wisp_elastic_triangles* mesh = wisp_find_object( state->meshes, span->entity );
    const projection p = { find_args( frame, span, mesh ), wisp_frame_kernels( frame ), span->iteration == 0 };
    wisp_run_schedule( wisp_frame_parallel( frame, span ), wisp_elastic_triangles_order( mesh ), project_triangles,
                       &p );
}

static void sum_tensions( const wisp_kernels* kernels, const void* args, int begin, int end, double* sums )
{
    *sums = kernels->elastic_triangle_virial( args, begin, end );
}

static void measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const membrane_state* state = user;
    const wisp_elastic_triangles* mesh = wisp_find_object( state->meshes, span->entity );
    const wisp_elastic_triangle_args args = find_args( frame, span, mesh );
    const int slots = wisp_elastic_triangles_order( mesh )->slot_count;
    const wisp_summation all = { sum_tensions, &args, slots, VIRIAL_GRAIN, 1, 1 };
    (void)wisp_frame_sum( frame, span, &all, wisp_frame_column( frame, span->entity, WISP_SURFACE_VIRIAL, 0 ) );
}

static wisp_status declare( wisp_registry* r )
{
    membrane_state* state = wisp_declare_state( r, sizeof( membrane_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_declare_hooks( r, &( wisp_state_hooks ){ .triangles_changed = triangles_changed } );
    state->meshes = wisp_declare_objects( r, release_mesh, mesh_bytes );
    state->has_iterations = wisp_registry_iterations( r ) > 1;
    for ( wisp_component map = WISP_MAP_STRETCH_COMPLIANCE; map <= WISP_MAP_STRETCH_STIFFNESS; ++map )
    {
        wisp_declare_map( r, map, WISP_SURFACE_ELASTIC, "a membrane has no links, and one thickness" );
    }
    const wisp_pass passes[] = {
        {
            WISP_PASS( "membrane.measure", FORCE, ENTITY, measure ),
            .required = { WISP_SURFACE_ELASTIC },
            .reads = { WISP_SURFACE_ELASTIC, WISP_PARTICLE_POSITION },
            .writes = { WISP_SURFACE_VIRIAL },
        },
        {
            WISP_PASS( "membrane.project", PROJECT, ENTITY, project ),
            .required = { WISP_SURFACE_ELASTIC },
            .reads = { WISP_SURFACE_ELASTIC, WISP_PARTICLE_POSITION },
            .writes = { WISP_PARTICLE_POSITION },
            .detail = WISP_PASS_FINE,
        },
    };
    return wisp_declare_passes( r, passes, WISP_COUNT( passes ), state );
}

const wisp_module wisp_membrane_module = { .name = "membrane", .declare = declare };

// ---- the call of the host ----

static wisp_status check( wisp_world* world, wisp_entity surface )
{
    if ( wisp_world_has( world, surface, WISP_PARTICLE_EXTERNAL_SOLVER ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "membrane: entity %u already has another solver",
                                surface.index );
    }
    if ( wisp_world_has( world, surface, WISP_LINK_STIFFNESS ) ||
         wisp_world_has( world, surface, WISP_LINK_COMPLIANCE ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "membrane: entity %u already has links: set the membrane before cloth or balloon",
                                surface.index );
    }
    return WISP_OK;
}

wisp_status wisp_set_membrane( wisp_world* world, wisp_entity surface, const wisp_membrane_def* given )
{
    wisp_membrane_def def;
    WISP_TRY( given != NULL ? wisp_world_begin_def( world, NULL, &wisp_membrane_def_fields, &def, given )
                            : wisp_world_begin( world ) );
    WISP_FIND_STATE( membrane_state, state, world, "membrane", &surface, WISP_IS_SURFACE );
    if ( given == NULL )
    {
        wisp_set_object( state->meshes, surface, NULL );
        return wisp_world_detach( world, surface, WISP_SURFACE_ELASTIC );
    }
    WISP_TRY( check( world, surface ) );
    WISP_TRY( wisp_find_object( state->meshes, surface ) == NULL ? add_mesh( world, state, surface ) : WISP_OK );
    const wisp_status status = wisp_world_attach( world, surface, WISP_SURFACE_ELASTIC );
    if ( status != WISP_OK )
    {
        wisp_set_object( state->meshes, surface, NULL );
        return status;
    }
    *(float*)wisp_world_column( world, surface, WISP_SURFACE_ELASTIC, 0 ) = def.shear_modulus * def.thickness;
    *(int32_t*)wisp_world_column( world, surface, WISP_SURFACE_ELASTIC, 1 ) = def.tension_field ? 1 : 0;
    return WISP_OK;
}
