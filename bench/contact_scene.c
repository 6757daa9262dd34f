#include "contact_scene.h"

#include "balloon_scene.h"

#include "cloth/cloth.h"
#include "collision/collision.h"
#include "wisp/fabric.h"

#include <math.h>
#include <stdlib.h>

// ---- meshes ----

static float quarter_of_mean_edge( const wisp_fabric* fabric )
{
    double sum = 0.0;
    for ( int e = 0; e < fabric->edge_count; ++e )
    {
        const wisp_vec3 a = fabric->rest[fabric->edges[2 * e]], b = fabric->rest[fabric->edges[2 * e + 1]];
        const double x = (double)( a.x - b.x ), y = (double)( a.y - b.y ), z = (double)( a.z - b.z );
        sum += sqrt( x * x + y * y + z * z );
    }
    return (float)( 0.25 * sum / fabric->edge_count );
}

static wisp_status cook( wisp_status status, contact_scene* out, wisp_error* error )
{
    status = status == WISP_OK ? surface_cook( &out->mesh, wisp_default_fabric_def(), &out->fabric, error ) : status;
    if ( status != WISP_OK )
    {
        contact_scene_free( out );
        return status;
    }
    out->thickness = quarter_of_mean_edge( out->fabric );
    return WISP_OK;
}

wisp_status contact_make_cloth( int side, contact_scene* out, wisp_error* error )
{
    *out = ( contact_scene ){ .fabric = NULL };
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = generator.rows = side;
    generator.spacing = FOLD_WIDTH / (float)( side - 1 );
    const wisp_status status = wisp_mesh_generate( &generator, &out->mesh, error );
    for ( int v = 0; v < out->mesh.vertex_count; ++v )
    {
        out->mesh.points[v].y += FOLD_HEIGHT;
    }
    return cook( status, out, error );
}

wisp_status contact_make_balloon( int level, contact_scene* out, wisp_error* error )
{
    *out = ( contact_scene ){ .fabric = NULL };
    return cook( balloon_mesh_sphere( level, PRESS_RADIUS, &out->mesh, error ), out, error );
}

void contact_scene_free( contact_scene* scene )
{
    wisp_fabric_release( scene->fabric );
    wisp_mesh_release( &scene->mesh );
    *scene = ( contact_scene ){ .fabric = NULL };
}

// ---- worlds ----

static wisp_status open_world( const contact_scene* scene, const contact_setting* setting, const wisp_module* effect,
                               contact_world* out, wisp_error* error )
{
    // without contact and without samples the module is not needed
    const bool has_contact = setting->way.is_off == false || setting->requests_stats;
    const wisp_module* const modules[] = { effect, &wisp_collision_module, &wisp_contact_module };
    *out = ( contact_world ){ .scene = scene, .pace = 1.0f - setting->way.ball_held };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = has_contact ? 3 : 2;
    def.log = bench_world_drop_log;
    def.workers = setting->workers;
    def.substeps = CONTACT_SUBSTEPS;
    wisp_status status = wisp_world_create( &def, &out->world, error );
    if ( status != WISP_OK || setting->way.is_off )
    {
        return status;
    }
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.primitives = setting->way.primitives;
    settings.search = setting->way.search;
    settings.particle_spacing = setting->way.spacing * scene->thickness;
    settings.margin = setting->way.margin;
    settings.displacement_limit = setting->way.no_displacement_limit == false;
    status = wisp_set_contact_settings( out->world, &settings );
    return status == WISP_OK ? WISP_OK : bench_world_fail( out->world, status, error );
}

// A participant that collides with nothing still counts intersections.
static wisp_status enter_contact( const contact_setting* setting, contact_world* out, wisp_entity surface )
{
    wisp_contact_def def = wisp_default_contact_def();
    def.thickness = out->scene->thickness;
    if ( setting->way.is_off )
    {
        def.self = false;
        def.mask = 0;
    }
    wisp_status status = WISP_OK;
    if ( setting->way.is_off == false || setting->requests_stats )
    {
        status = wisp_set_contact( out->world, surface, &def );
    }
    if ( status == WISP_OK && setting->requests_stats )
    {
        status = wisp_request( out->world, surface, WISP_MOTION_STATS );
    }
    return status ? status : wisp_request( out->world, surface, WISP_SURFACE_POINTS );
}

// @param points [vertex_count] where it starts; null: at rest
static wisp_status add_surface( contact_world* out, const wisp_vec3* points, float density, wisp_vec3 gravity,
                                wisp_entity* surface )
{
    wisp_surface_def def = wisp_default_surface_def();
    def.fabric = out->scene->fabric;
    def.points = points;
    def.area_density = density;
    wisp_status status = wisp_add_surface( out->world, &def, surface );
    if ( status == WISP_OK )
    {
        out->surfaces[out->surface_count++] = *surface;
        status = wisp_set_gravity( out->world, *surface, gravity );
    }
    return status;
}

static wisp_status finish( contact_world* out, const contact_setting* setting, wisp_status status, wisp_error* error )
{
    if ( status == WISP_OK && setting->requests_stats )
    {
        status = wisp_request_contact_stats( out->world, true, true );
    }
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        contact_leave( out );
    }
    return status;
}

void contact_leave( contact_world* world )
{
    wisp_world_destroy( world->world );
    *world = ( contact_world ){ .world = NULL };
}

// ---- bodies ----

static wisp_status add_plane( contact_world* out, wisp_transform pose, wisp_entity* plane )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_PLANE;
    def.pose = pose;
    return wisp_add_collider( out->world, &def, plane );
}

static void keep_mover( contact_world* out, wisp_entity body, wisp_quat turn )
{
    out->movers[out->mover_count] = body;
    out->turns[out->mover_count] = turn;
    ++out->mover_count;
}

// ---- the cloth ----

wisp_vec3 contact_ball_at( int mover, float steps )
{
    (void)mover;
    const float t = CONTACT_STEP * steps;
    return ( wisp_vec3 ){ FOLD_SWING * ( 0.3f + sinf( FOLD_SWING_X * t ) ), FOLD_BALL_HEIGHT,
                          FOLD_SWING * ( 0.1f + sinf( FOLD_SWING_Z * t ) ) };
}

static wisp_status add_ball_and_ground( contact_world* out )
{
    wisp_entity body, plane;
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = FOLD_BALL_RADIUS;
    ball.pose.translation = contact_ball_at( 0, 0.0f );
    out->place = contact_ball_at;
    const wisp_status status = wisp_add_collider( out->world, &ball, &body );
    if ( status == WISP_OK )
    {
        keep_mover( out, body, ball.pose.rotation );
    }
    const wisp_transform ground = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    return status ? status : add_plane( out, ground, &plane );
}

static wisp_status add_cloth( const contact_setting* setting, contact_world* out )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_collision_def collision = wisp_default_collision_def();
    cloth.bend_compliance = FOLD_BEND;
    cloth.internal_damping = FOLD_DAMPING;
    wisp_entity surface;
    wisp_status status =
        add_surface( out, NULL, FOLD_DENSITY, ( wisp_vec3 ){ 0.0f, -CONTACT_GRAVITY, 0.0f }, &surface );
    status = status ? status : wisp_set_cloth( out->world, surface, &cloth );
    status = status ? status : add_ball_and_ground( out );
    status = status ? status : wisp_set_collision( out->world, surface, &collision );
    return status ? status : enter_contact( setting, out, surface );
}

wisp_status contact_enter_fold( const contact_scene* scene, const contact_setting* setting, contact_world* out,
                                wisp_error* error )
{
    const wisp_status status = open_world( scene, setting, &wisp_cloth_module, out, error );
    if ( status != WISP_OK )
    {
        contact_leave( out );
        return status;
    }
    return finish( out, setting, add_cloth( setting, out ), error );
}

// ---- balloons ----

/// A balloon of a scene.
typedef struct balloon_place
{
    wisp_vec3 centre, gravity;
    float skin;    // N/m
    float damping; // 1/s
} balloon_place;

static wisp_status place_balloon( const contact_setting* setting, const balloon_place* place, wisp_vec3* points,
                                  contact_world* out )
{
    const wisp_mesh* mesh = &out->scene->mesh;
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 p = mesh->points[v], c = place->centre;
        points[v] = ( wisp_vec3 ){ p.x + c.x, p.y + c.y, p.z + c.z };
    }
    wisp_balloon_def balloon = wisp_default_balloon_def();
    balloon.gas_ratio = PRESS_FILL;
    balloon.buoyancy = false;
    balloon.edge_stiffness = place->skin;
    wisp_collision_def collision = wisp_default_collision_def();
    wisp_entity surface;
    wisp_status status = add_surface( out, points, PRESS_DENSITY, place->gravity, &surface );
    status = status ? status : wisp_set_balloon( out->world, surface, &balloon );
    status = status ? status : wisp_set_damping( out->world, surface, place->damping );
    status = status ? status : wisp_set_collision( out->world, surface, &collision );
    return status ? status : enter_contact( setting, out, surface );
}

static wisp_status add_balloons( const contact_setting* setting, const balloon_place* places, int count,
                                 contact_world* out )
{
    wisp_status status = WISP_OK;
    wisp_vec3* points = malloc( (size_t)out->scene->mesh.vertex_count * sizeof( wisp_vec3 ) );
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = points ? place_balloon( setting, places + i, points, out ) : WISP_NO_MEMORY;
    }
    free( points );
    return status;
}

wisp_vec3 contact_plate_at( int mover, float steps )
{
    const float fraction = fminf( steps / (float)PAIR_CLOSING, 1.0f );
    const float from_middle = PRESS_RADIUS * ( PAIR_OPEN + fraction * ( PAIR_CLOSED - PAIR_OPEN ) );
    return ( wisp_vec3 ){ mover == 0 ? -from_middle : from_middle, 0.0f, 0.0f };
}

// Half spaces whose normals point along x and against it.
static wisp_status add_plates( contact_world* out )
{
    const float h = sqrtf( 0.5f );
    const wisp_quat turns[2] = { { 0.0f, 0.0f, -h, h }, { 0.0f, 0.0f, h, h } };
    wisp_status status = WISP_OK;
    out->place = contact_plate_at;
    for ( int i = 0; i < 2 && status == WISP_OK; ++i )
    {
        wisp_entity plate;
        status = add_plane( out, ( wisp_transform ){ turns[i], contact_plate_at( i, 0.0f ) }, &plate );
        if ( status == WISP_OK )
        {
            keep_mover( out, plate, turns[i] );
        }
    }
    return status;
}

wisp_status contact_enter_pair( const contact_scene* scene, const contact_setting* setting, contact_world* out,
                                wisp_error* error )
{
    wisp_status status = open_world( scene, setting, &wisp_balloon_module, out, error );
    if ( status != WISP_OK )
    {
        contact_leave( out );
        return status;
    }
    balloon_place places[2];
    for ( int i = 0; i < 2; ++i )
    {
        const float apart = 1.08f * PRESS_RADIUS;
        places[i] = ( balloon_place ){
            .centre = { i == 0 ? -apart : apart, 0.0f, 0.0f },
            .skin = PAIR_SKIN,
            .damping = PAIR_DAMPING,
        };
    }
    status = add_plates( out );
    return finish( out, setting, status ? status : add_balloons( setting, places, 2, out ), error );
}

// Five half spaces that are open at the top.
static wisp_status add_box( contact_world* out )
{
    const float h = sqrtf( 0.5f );
    const wisp_transform walls[] = {
        { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } }, { { 0.0f, 0.0f, -h, h }, { -STACK_BOX, 0.0f, 0.0f } },
        { { 0.0f, 0.0f, h, h }, { STACK_BOX, 0.0f, 0.0f } },  { { h, 0.0f, 0.0f, h }, { 0.0f, 0.0f, -STACK_BOX } },
        { { -h, 0.0f, 0.0f, h }, { 0.0f, 0.0f, STACK_BOX } },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( walls ) && status == WISP_OK; ++i )
    {
        wisp_entity wall;
        status = add_plane( out, walls[i], &wall );
    }
    return status;
}

// Four in a layer, each layer a little aside of the one below, so that none balances on another's top.
static wisp_vec3 stack_centre( int balloon )
{
    const int layer = balloon / 4, corner = balloon % 4;
    const float aside = 0.04f * PRESS_RADIUS * (float)( layer % 2 * 2 - 1 ), apart = 1.08f * PRESS_RADIUS;
    return ( wisp_vec3 ){ ( corner % 2 == 0 ? -apart : apart ) + aside, PRESS_RADIUS * ( 1.1f + 2.2f * (float)layer ),
                          ( corner / 2 == 0 ? -apart : apart ) - aside };
}

wisp_status contact_enter_stack( const contact_scene* scene, const contact_setting* setting, contact_world* out,
                                 wisp_error* error )
{
    wisp_status status = open_world( scene, setting, &wisp_balloon_module, out, error );
    if ( status != WISP_OK )
    {
        contact_leave( out );
        return status;
    }
    balloon_place places[STACK_COUNT];
    for ( int i = 0; i < STACK_COUNT; ++i )
    {
        places[i] = ( balloon_place ){
            .centre = stack_centre( i ),
            .gravity = { 0.0f, -CONTACT_GRAVITY, 0.0f },
            .skin = STACK_SKIN,
            .damping = STACK_DAMPING,
        };
    }
    status = add_box( out );
    return finish( out, setting, status ? status : add_balloons( setting, places, STACK_COUNT, out ), error );
}

// ---- steps ----

wisp_status contact_step( void* context, wisp_error* error )
{
    contact_world* w = context;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < w->mover_count && status == WISP_OK; ++i )
    {
        const wisp_transform pose = { w->turns[i], w->place( i, w->pace * (float)( w->steps + 1 ) ) };
        status = wisp_move_collider( w->world, w->movers[i], pose );
    }
    status = status ? status : wisp_world_step( w->world, CONTACT_STEP );
    if ( status != WISP_OK )
    {
        return bench_world_fail( w->world, status, error );
    }
    ++w->steps;
    for ( int i = 0; i < w->surface_count && w->halted_at == 0; ++i )
    {
        w->halted_at = wisp_is_halted( w->world, w->surfaces[i] ) ? w->steps : 0;
    }
    return WISP_OK;
}

wisp_status contact_hash( contact_world* world, uint64_t* hash, wisp_error* error )
{
    *hash = 0;
    for ( int i = 0; i < world->surface_count; ++i )
    {
        uint64_t one;
        const wisp_status status =
            bench_world_hash( world->world, world->surfaces[i], WISP_SURFACE_POINTS, &one, error );
        if ( status != WISP_OK )
        {
            return status;
        }
        *hash = *hash * 0x100000001b3u + one; // their order counts, too
    }
    return WISP_OK;
}

wisp_status contact_points( contact_world* world, int surface, const wisp_vec3** points, wisp_error* error )
{
    return bench_world_points( world->world, world->surfaces[surface], WISP_SURFACE_POINTS,
                               world->scene->fabric->vertex_count, points, error );
}
