#include "balloon_scene.h"

#include "program_data.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

static const float FOUR_PI = 12.5663706f;

// ---- meshes ----

wisp_status balloon_mesh_sphere( int level, float radius, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    generator.level = level;
    generator.radius = radius;
    return wisp_mesh_generate( &generator, out, error );
}

static void set_size( wisp_mesh* mesh, double area )
{
    double centre[3] = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        centre[0] += (double)mesh->points[i].x / mesh->vertex_count;
        centre[1] += (double)mesh->points[i].y / mesh->vertex_count;
        centre[2] += (double)mesh->points[i].z / mesh->vertex_count;
    }
    double requested = (double)( FOUR_PI * BALLOON_RADIUS * BALLOON_RADIUS );
    double scale = sqrt( requested / area );
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        wisp_vec3* p = &mesh->points[i];
        p->x = (float)( scale * ( (double)p->x - centre[0] ) );
        p->y = (float)( scale * ( (double)p->y - centre[1] ) );
        p->z = (float)( scale * ( (double)p->z - centre[2] ) );
    }
}

wisp_status balloon_mesh_figure( wisp_mesh* out, const char** name, wisp_error* error )
{
    wisp_error unread = { 0 };
    *name = "bunny";
    char path[1024];
    program_data_path( "bunny.obj", path, sizeof path );
    wisp_status status = wisp_mesh_read( path, out, &unread );
    if ( status == WISP_IO_ERROR )
    {
        wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PEAR );
        generator.level = 4;
        *name = "pear";
        status = wisp_mesh_generate( &generator, out, &unread );
    }
    wisp_mesh_diagnostics report;
    status = status == WISP_OK ? wisp_mesh_examine( out, &report, &unread ) : status;
    if ( status != WISP_OK )
    {
        return wisp_fail( error, status, "%s", unread.message );
    }
    set_size( out, report.area );
    return WISP_OK;
}

int balloon_mesh_extreme( const wisp_mesh* mesh, wisp_vec3 d )
{
    int best = 0;
    float most = -INFINITY;
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        wisp_vec3 p = mesh->points[i];
        float along = p.x * d.x + p.y * d.y + p.z * d.z;
        if ( along > most )
        {
            best = i;
            most = along;
        }
    }
    return best;
}

double balloon_distance( wisp_vec3 a, wisp_vec3 b )
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

int balloon_mesh_nearest( const wisp_mesh* mesh, wisp_vec3 at )
{
    int best = 0;
    for ( int i = 1; i < mesh->vertex_count; ++i )
    {
        best = balloon_distance( mesh->points[i], at ) < balloon_distance( mesh->points[best], at ) ? i : best;
    }
    return best;
}

double balloon_volume( const wisp_mesh* mesh, const wisp_vec3* points )
{
    double sum = 0.0;
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        wisp_vec3 a = points[mesh->triangles[3 * t]], b = points[mesh->triangles[3 * t + 1]],
                  c = points[mesh->triangles[3 * t + 2]];
        double bx = (double)b.x, by = (double)b.y, bz = (double)b.z;
        double cx = (double)c.x, cy = (double)c.y, cz = (double)c.z;
        sum += (double)a.x * ( by * cz - bz * cy ) + (double)a.y * ( bz * cx - bx * cz ) +
               (double)a.z * ( bx * cy - by * cx );
    }
    return sum / 6.0;
}

wisp_vec3* balloon_scaled_points( const wisp_mesh* mesh, double scale )
{
    wisp_vec3* points = malloc( (size_t)mesh->vertex_count * sizeof( *points ) );
    for ( int i = 0; i < mesh->vertex_count && points != NULL; ++i )
    {
        const wisp_vec3 p = mesh->points[i];
        points[i] = ( wisp_vec3 ){ (float)( scale * (double)p.x ), (float)( scale * (double)p.y ),
                                   (float)( scale * (double)p.z ) };
    }
    return points;
}

// ---- settings ----

balloon_setting balloon_default_setting( void )
{
    return ( balloon_setting ){
        .def = wisp_default_balloon_def(),
        .area_density = BALLOON_AREA_DENSITY,
        .gravity = { 0.0f, -9.8f, 0.0f },
        .substeps = BALLOON_SUBSTEPS,
        .iterations = BALLOON_ITERATIONS,
        .workers = 1,
        .seconds = BALLOON_STEP,
    };
}

balloon_setting balloon_setting_in_vacuum( void )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.buoyancy = false;
    setting.def.drag_coefficient = 0.0f;
    setting.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    return setting;
}

wisp_status balloon_cook( const wisp_mesh* mesh, const balloon_setting* setting, wisp_fabric** out,
                          wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.solve_order = setting->solve_order;
    return surface_cook( mesh, def, out, error );
}

wisp_status balloon_implementation_create( wisp_fabric* fabric, const balloon_setting* setting,
                                           surface_implementation* out, wisp_error* error )
{
    surface_generator generator = surface_default_generator( &wisp_balloon_module, fabric );
    generator.second = setting->membrane != NULL ? &wisp_membrane_module : NULL;
    generator.points = setting->points;
    generator.pins = setting->pins;
    generator.pin_count = setting->pin_count;
    generator.area_density = setting->area_density;
    generator.gravity = setting->gravity;
    generator.damping = setting->damping;
    generator.substeps = setting->substeps;
    generator.iterations = setting->iterations;
    generator.workers = setting->workers;
    generator.seconds = setting->seconds;
    wisp_status status = surface_implementation_create( &generator, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = setting->membrane != NULL ? wisp_set_membrane( out->world, out->entity, setting->membrane ) : status;
    status = status == WISP_OK ? wisp_set_balloon( out->world, out->entity, &setting->def ) : status;
    if ( status == WISP_OK )
    {
        status = wisp_request_balloon_stats( out->world, out->entity, true );
    }
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}

wisp_status balloon_implementation_read( surface_implementation* implementation, wisp_balloon_stats* out,
                                         wisp_error* error )
{
    wisp_status status = wisp_read_balloon_stats( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}
