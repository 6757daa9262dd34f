// Surfaces in worlds of their own.
#include "surfaces.h"

#include "collision/collision.h"
#include "oracle/balloon_oracle.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>

// ---- surfaces ----

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
    const bench_world_def def = { modules, generator->second == NULL ? 1 : 2, generator->workers, generator->substeps,
                                  generator->iterations };
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
    *implementation = ( surface_implementation ){ 0 };
}

wisp_status surface_implementation_step( void* context, wisp_error* error )
{
    surface_implementation* implementation = context;
    return bench_world_step( implementation->world, implementation->entity, implementation->generator.seconds,
                             &implementation->steps, &implementation->halted_at, error );
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

// ---- balloons ----

static const float FOUR_PI = 12.5663706f;

// ---- meshes ----

wisp_status balloon_mesh_sphere( int level, float radius, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    generator.level = level;
    generator.radius = radius;
    return wisp_mesh_generate( &generator, out, error );
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

// ---- readings of pressure ----

double balloon_stiffness_sum( const wisp_fabric* fabric, const wisp_balloon_def* def )
{
    double sum = 0.0;
    for ( int slot = 0; slot < fabric->link_order.slot_count; ++slot )
    {
        double rest = (double)fabric->link_rest[slot];
        double stiffness =
            (double)( wisp_fabric_link_kind( fabric, slot ) == 1 ? def->bend_link_stiffness : def->edge_stiffness );
        sum += stiffness * rest * rest;
    }
    return sum;
}

// Every link of the mesh is s times as long: sum(k l^2) (s - 1) / (3 V_rest s^2).
static double closed_form( const wisp_fabric* fabric, const wisp_balloon_def* def, const wisp_balloon_stats* seen )
{
    return balloon_oracle_true_scaled_pressure( balloon_stiffness_sum( fabric, def ), seen->rest_volume,
                                                cbrt( seen->volume / seen->rest_volume ) );
}

wisp_status balloon_read_all( surface_implementation* implementation, const balloon_setting* setting,
                              balloon_readings* out, wisp_error* error )
{
    wisp_balloon_stats seen = { 0 };
    wisp_status status = wisp_request_balloon_stats( implementation->world, implementation->entity, true );
    if ( status != WISP_OK )
    {
        return bench_world_fail( implementation->world, status, error );
    }
    status = surface_implementation_step( implementation, error );
    status = status == WISP_OK ? balloon_implementation_read( implementation, &seen, error ) : status;
    const double lacking = seen.target_volume - seen.volume;
    *out = ( balloon_readings ){
        .pressure = seen.pressure,
        .gas_law = (double)setting->def.atmospheric_pressure * lacking / seen.volume,
        .volume_error = -lacking / seen.target_volume,
        .closed_form = closed_form( implementation->fabric, &setting->def, &seen ),
    };
    return status;
}

// ---- the mesh ----

static wisp_status make_mesh( int vertices, triangle_scene* out, wisp_error* error )
{
    wisp_mesh_generator generator =
        wisp_default_mesh_generator( vertices > 0 ? WISP_MESH_DELAUNAY : WISP_MESH_PLANE_REGULAR );
    generator.vertex_count = vertices;
    generator.width = generator.depth = TRIANGLE_WIDTH;
    generator.columns = generator.rows = TRIANGLE_QUAD_SIDE;
    generator.spacing = TRIANGLE_WIDTH / ( TRIANGLE_QUAD_SIDE - 1 );
    wisp_status status = wisp_mesh_generate( &generator, &out->mesh, error );
    for ( int i = 0; status == WISP_OK && i < out->mesh.vertex_count; ++i )
    {
        out->mesh.points[i].y += TRIANGLE_HEIGHT;
    }
    return status;
}

wisp_status triangle_scene_make( int vertices, triangle_scene* out, wisp_error* error )
{
    *out = ( triangle_scene ){ .fabric = NULL };
    wisp_status status = make_mesh( vertices, out, error );
    if ( status == WISP_OK && vertices == 0 )
    {
        status = wisp_quad_pairs_make( TRIANGLE_QUAD_SIDE, TRIANGLE_QUAD_SIDE, &out->pairs, error );
    }
    status = status == WISP_OK ? surface_cook( &out->mesh, wisp_default_fabric_def(), &out->fabric, error ) : status;
    if ( status != WISP_OK )
    {
        triangle_scene_free( out );
    }
    return status;
}

void triangle_scene_free( triangle_scene* scene )
{
    wisp_fabric_release( scene->fabric );
    wisp_quad_pairs_release( &scene->pairs );
    wisp_mesh_release( &scene->mesh );
    *scene = ( triangle_scene ){ .fabric = NULL };
}

// ---- the world ----

triangle_setting triangle_default_setting( void )
{
    wisp_implicit_cloth_def cloth = wisp_default_implicit_cloth_def();
    cloth.stiffness_model = WISP_IMPLICIT_STIFFNESS_LINK;
    cloth.weights = WISP_IMPLICIT_WEIGHTS_EFFECTIVE;
    cloth.tolerance = 1e-4f;
    return ( triangle_setting ){
        .cloth = cloth,
        .seconds = 0.01f,
        .workers = 1,
        .has_ball = true,
        .gravity = { 0.0f, -TRIANGLE_GRAVITY, 0.0f },
    };
}

static wisp_status add_cloth( const triangle_scene* scene, const triangle_setting* setting,
                              surface_implementation* out )
{
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = scene->fabric;
    surface.points = setting->points;
    surface.area_density = TRIANGLE_DENSITY;
    surface.pins = setting->pins;
    surface.pin_count = setting->pin_count;
    surface.gravity = setting->gravity;
    wisp_implicit_cloth_def cloth = setting->cloth;
    cloth.stretch_pairs = scene->pairs.stretch;
    cloth.stretch_pair_count = scene->pairs.stretch_count;
    cloth.bend_pairs = scene->pairs.bend;
    cloth.bend_pair_count = scene->pairs.bend_count;
    wisp_status status = wisp_add_surface( out->world, &surface, &out->entity );
    status = status ? status : wisp_set_implicit_cloth( out->world, out->entity, &cloth );
    if ( status == WISP_OK && setting->requests_stats )
    {
        status = wisp_request_implicit_cloth_stats( out->world, out->entity, true );
    }
    return status ? status : wisp_request( out->world, out->entity, WISP_SURFACE_POINTS );
}

// Put the ball into an implementation's world, and let the implementation's surface collide with it.
static wisp_status triangle_add_ball( surface_implementation* implementation )
{
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = TRIANGLE_BALL_RADIUS;
    ball.pose.translation = ( wisp_vec3 ){ 0.0f, TRIANGLE_BALL_HEIGHT, 0.0f };
    ball.static_friction = TRIANGLE_STATIC_FRICTION;
    ball.kinetic_friction = TRIANGLE_KINETIC_FRICTION;
    wisp_collision_def collision = wisp_default_collision_def();
    collision.thickness = TRIANGLE_MARGIN;
    wisp_entity entity;
    wisp_status status = wisp_add_collider( implementation->world, &ball, &entity );
    return status ? status : wisp_set_collision( implementation->world, implementation->entity, &collision );
}

wisp_status triangle_enter( const triangle_scene* scene, const triangle_setting* setting, surface_implementation* out,
                            wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_collision_module, &wisp_implicit_cloth_module };
    *out = ( surface_implementation ){ .fabric = scene->fabric };
    out->generator = surface_default_generator( &wisp_implicit_cloth_module, scene->fabric );
    out->generator.gravity = setting->gravity;
    out->generator.seconds = setting->seconds;
    const bench_world_def def = { modules, WISP_COUNT( modules ), .workers = setting->workers };
    wisp_status status = bench_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_cloth( scene, setting, out );
    status = status == WISP_OK && setting->has_ball ? triangle_add_ball( out ) : status;
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}
