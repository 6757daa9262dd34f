#include "surface_entrant.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <string.h>

surface_recipe surface_default_recipe( const wisp_module* module, wisp_fabric* fabric )
{
    return ( surface_recipe ){
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

// ---- a world ----

static wisp_status add_surface( const surface_recipe* recipe, surface_entrant* entrant )
{
    wisp_surface_def def = wisp_default_surface_def();
    def.fabric = recipe->fabric;
    def.points = recipe->points;
    def.area_density = recipe->area_density;
    def.vertex_mass = recipe->vertex_mass;
    def.pins = recipe->pins;
    def.pin_count = recipe->pin_count;
    wisp_status status = wisp_add_surface( entrant->world, &def, &entrant->entity );
    if ( status == WISP_OK )
    {
        status = wisp_set_gravity( entrant->world, entrant->entity, recipe->gravity );
    }
    if ( status == WISP_OK )
    {
        status = wisp_set_damping( entrant->world, entrant->entity, recipe->damping );
    }
    if ( status == WISP_OK )
    {
        status = wisp_want( entrant->world, entrant->entity, WISP_SURFACE_POINTS );
    }
    return status;
}

wisp_status surface_entrant_create( const surface_recipe* recipe, surface_entrant* out, wisp_error* error )
{
    *out = ( surface_entrant ){ .fabric = recipe->fabric, .recipe = *recipe };
    const wisp_module* const modules[] = { recipe->module, recipe->second, recipe->third };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = recipe->second == NULL ? 1 : recipe->third == NULL ? 2 : 3;
    def.log = bench_world_drop_log;
    def.workers = recipe->workers;
    def.substeps = recipe->substeps;
    def.iterations = recipe->iterations;
    wisp_status status = wisp_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_surface( recipe, out );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_entrant_destroy( out );
    }
    return status;
}

void surface_entrant_destroy( surface_entrant* entrant )
{
    wisp_world_destroy( entrant->world );
    profile_samples_free( &entrant->profile );
    *entrant = ( surface_entrant ){ 0 };
}

wisp_status surface_entrant_step( void* context, wisp_error* error )
{
    surface_entrant* entrant = context;
    return bench_world_step( entrant->world, entrant->entity, entrant->recipe.seconds, &entrant->steps,
                             &entrant->halted_at, error );
}

wisp_status surface_entrant_keep_profile( void* context )
{
    surface_entrant* entrant = context;
    return profile_samples_add( &entrant->profile, wisp_world_profile( entrant->world ) );
}

// ---- what it shows ----

wisp_status surface_entrant_hash( surface_entrant* entrant, uint64_t* hash, wisp_error* error )
{
    return bench_world_hash( entrant->world, entrant->entity, WISP_SURFACE_POINTS, hash, error );
}

wisp_status surface_entrant_points( surface_entrant* entrant, const wisp_vec3** points, wisp_error* error )
{
    return bench_world_points( entrant->world, entrant->entity, WISP_SURFACE_POINTS, entrant->fabric->vertex_count,
                               points, error );
}

void surface_entrant_velocities( surface_entrant* entrant, wisp_vec3* out )
{
    const float* v = wisp_world_column( entrant->world, entrant->entity, WISP_PARTICLE_VELOCITY, 0 );
    for ( int i = 0; i < entrant->fabric->vertex_count; ++i )
    {
        const float* row = v + 4 * (size_t)entrant->fabric->vertex_slot[i];
        out[i] = ( wisp_vec3 ){ row[0], row[1], row[2] };
    }
}

double surface_entrant_pass_ms( surface_entrant* entrant, const char* beginning )
{
    double sum = 0.0;
    for ( int i = 0; i < entrant->profile.pass_count; ++i )
    {
        if ( strncmp( entrant->profile.passes[i].name, beginning, strlen( beginning ) ) == 0 )
        {
            sum += 1e3 * profile_samples_median( &entrant->profile, i );
        }
    }
    return sum;
}

static double edge_length( const float* a, const float* b )
{
    double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1], z = (double)a[2] - (double)b[2];
    return sqrt( x * x + y * y + z * z );
}

static void look_at_edges( const wisp_fabric* fabric, const float* position, surface_look* look )
{
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        size_t a = (size_t)fabric->edges[2 * e], b = (size_t)fabric->edges[2 * e + 1];
        double rest = edge_length( &fabric->rest[a].x, &fabric->rest[b].x );
        double stretch = fabs( edge_length( position + 4 * a, position + 4 * b ) / rest - 1.0 );

        // Not fmax: that would step over a NaN.
        look->stretch_max = stretch <= look->stretch_max ? look->stretch_max : stretch;
        sum += stretch;
    }
    look->stretch_mean = fabric->edge_count > 0 ? sum / fabric->edge_count : 0.0;
}

surface_look surface_entrant_look( surface_entrant* entrant )
{
    const wisp_fabric* fabric = entrant->fabric;
    const wisp_vec3 g = entrant->recipe.gravity;
    const float* x = wisp_world_column( entrant->world, entrant->entity, WISP_PARTICLE_POSITION, 0 );
    const float* v = wisp_world_column( entrant->world, entrant->entity, WISP_PARTICLE_VELOCITY, 0 );
    surface_look look = { .is_finite = true };
    look_at_edges( fabric, x, &look );
    for ( int i = 0; i < fabric->vertex_count; ++i )
    {
        const float *p = x + 4 * (size_t)i, *u = v + 4 * (size_t)i;
        if ( p[3] > 0.0f )
        {
            double mass = 1.0 / (double)p[3];
            const wisp_vec3 rest = fabric->rest[i];
            look.kinetic +=
                0.5 * mass *
                ( (double)u[0] * (double)u[0] + (double)u[1] * (double)u[1] + (double)u[2] * (double)u[2] );
            look.potential -= mass * ( (double)g.x * ( (double)p[0] - (double)rest.x ) +
                                       (double)g.y * ( (double)p[1] - (double)rest.y ) +
                                       (double)g.z * ( (double)p[2] - (double)rest.z ) );
        }
    }
    look.is_finite = isfinite( look.stretch_max ) && isfinite( look.stretch_mean ) && isfinite( look.kinetic ) &&
                     isfinite( look.potential );
    return look;
}
