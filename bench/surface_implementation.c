#include "surface_implementation.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>

surface_generator surface_default_generator( const wisp_module* module, wisp_fabric* fabric )
{
    return ( surface_generator ){
        .module = module,
        .fabric = fabric,
        .area_density = 0.15f,
        .substeps = 1,
        .iterations = 1,
        .workers = 1,
        .seconds = 1.0f / 60.0f,
    };
}

wisp_status surface_cook( const wisp_mesh* mesh, wisp_fabric_def def, wisp_fabric** out, wisp_error* error )
{
    def.points = mesh->points;
    def.triangles = mesh->triangles;
    def.vertex_count = mesh->vertex_count;
    def.triangle_count = mesh->triangle_count;
    return wisp_fabric_cook( &def, NULL, out, error );
}

wisp_status surface_plane( int columns, int rows, double spacing, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR );
    generator.columns = columns;
    generator.rows = rows;
    generator.spacing = (float)spacing;
    return wisp_mesh_generate( &generator, out, error );
}

// ---- a world ----

static wisp_status add_surface( const surface_generator* generator, surface_implementation* implementation )
{
    wisp_surface_def def = wisp_default_surface_def();
    def.fabric = generator->fabric;
    def.points = generator->points;
    def.area_density = generator->area_density;
    def.vertex_mass = generator->vertex_mass;
    def.pins = generator->pins;
    def.pin_count = generator->pin_count;
    def.gravity = generator->gravity;
    wisp_status status = wisp_add_surface( implementation->world, &def, &implementation->entity );
    if ( status == WISP_OK )
    {
        status = wisp_set_damping( implementation->world, implementation->entity, generator->damping );
    }
    if ( status == WISP_OK )
    {
        status = wisp_request( implementation->world, implementation->entity, WISP_SURFACE_POINTS );
    }
    return status;
}

wisp_status surface_implementation_create( const surface_generator* generator, surface_implementation* out,
                                           wisp_error* error )
{
    *out = ( surface_implementation ){ .fabric = generator->fabric, .generator = *generator };
    const wisp_module* const modules[] = { generator->module, generator->second };
    const bench_world_def def = { modules, generator->second == NULL ? 1 : 2, generator->workers,
                                  generator->substeps, generator->iterations };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_surface( generator, out );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}

void surface_implementation_destroy( surface_implementation* implementation )
{
    wisp_world_destroy( implementation->world );
    profile_samples_free( &implementation->profile );
    *implementation = ( surface_implementation ){ 0 };
}

wisp_status surface_implementation_step( void* context, wisp_error* error )
{
    surface_implementation* implementation = context;
    return bench_world_step( implementation->world, implementation->entity, implementation->generator.seconds,
                             &implementation->steps, &implementation->halted_at, error );
}

wisp_status surface_implementation_keep_profile( void* context )
{
    surface_implementation* implementation = context;
    return profile_samples_add( &implementation->profile, wisp_world_profile( implementation->world ) );
}

// ---- what it shows ----

wisp_status surface_implementation_hash( surface_implementation* implementation, uint64_t* hash, wisp_error* error )
{
    return bench_world_hash( implementation->world, implementation->entity, WISP_SURFACE_POINTS, hash, error );
}

wisp_status surface_implementation_points( surface_implementation* implementation, const wisp_vec3** points,
                                           wisp_error* error )
{
    return bench_world_points( implementation->world, implementation->entity, WISP_SURFACE_POINTS,
                               implementation->fabric->vertex_count, points, error );
}

void surface_implementation_velocities( surface_implementation* implementation, wisp_vec3* out )
{
    const float* v = wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_VELOCITY, 0 );
    for ( int i = 0; i < implementation->fabric->vertex_count; ++i )
    {
        const float* row = v + 4 * (size_t)implementation->fabric->vertex_slot[i];
        out[i] = ( wisp_vec3 ){ row[0], row[1], row[2] };
    }
}

static double edge_length( const float* a, const float* b )
{
    double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1], z = (double)a[2] - (double)b[2];
    return sqrt( x * x + y * y + z * z );
}

static void observe_edges( const wisp_fabric* fabric, const float* position, surface_observation* observation )
{
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        size_t a = (size_t)fabric->edges[2 * e], b = (size_t)fabric->edges[2 * e + 1];
        double rest = edge_length( &fabric->rest[a].x, &fabric->rest[b].x );
        double stretch = fabs( edge_length( position + 4 * a, position + 4 * b ) / rest - 1.0 );

        // Not fmax: that would step over a NaN.
        observation->stretch_max = stretch <= observation->stretch_max ? observation->stretch_max : stretch;
        sum += stretch;
    }
    observation->stretch_mean = fabric->edge_count > 0 ? sum / fabric->edge_count : 0.0;
}

surface_observation surface_implementation_observe( surface_implementation* implementation )
{
    const wisp_fabric* fabric = implementation->fabric;
    const wisp_vec3 g = implementation->generator.gravity;
    const float* x = wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_POSITION, 0 );
    const float* v = wisp_world_column( implementation->world, implementation->entity, WISP_PARTICLE_VELOCITY, 0 );
    surface_observation observation = { .is_finite = true };
    observe_edges( fabric, x, &observation );
    for ( int i = 0; i < fabric->vertex_count; ++i )
    {
        const float *p = x + 4 * (size_t)i, *u = v + 4 * (size_t)i;
        if ( p[3] > 0.0f )
        {
            double mass = 1.0 / (double)p[3];
            const wisp_vec3 rest = fabric->rest[i];
            observation.kinetic +=
                0.5 * mass *
                ( (double)u[0] * (double)u[0] + (double)u[1] * (double)u[1] + (double)u[2] * (double)u[2] );
            observation.potential -= mass * ( (double)g.x * ( (double)p[0] - (double)rest.x ) +
                                              (double)g.y * ( (double)p[1] - (double)rest.y ) +
                                              (double)g.z * ( (double)p[2] - (double)rest.z ) );
        }
    }
    observation.is_finite = isfinite( observation.stretch_max ) && isfinite( observation.stretch_mean ) &&
                            isfinite( observation.kinetic ) && isfinite( observation.potential );
    return observation;
}
