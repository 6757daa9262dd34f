// A host of every kind of build: cloth that hangs from two corners in the wind beside a ball, for a second. Prints the version
// and the hash of the world, which must be the same however the library was built and linked.
#include <wisp/cloth.h>
#include <wisp/collision.h>
#include <wisp/fabric.h>
#include <wisp/wisp.h>

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define SIDE 25 // vertices

static wisp_vec3 points[SIDE * SIDE];
static int32_t triangles[2 * ( SIDE - 1 ) * ( SIDE - 1 )][3];
static const int32_t corners[2] = { 0, SIDE - 1 };

// A square of a metre in the plane y = 0.
static void make_mesh( void )
{
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        points[v] = ( wisp_vec3 ){ (float)( v % SIDE ) / ( SIDE - 1 ), 0.0f, (float)( v / SIDE ) / ( SIDE - 1 ) };
    }
    for ( int32_t quad = 0; quad < ( SIDE - 1 ) * ( SIDE - 1 ); ++quad )
    {
        int32_t v = quad / ( SIDE - 1 ) * SIDE + quad % ( SIDE - 1 );
        memcpy( triangles[2 * quad], ( const int32_t[] ){ v, v + SIDE, v + 1 }, sizeof( triangles[0] ) );
        memcpy( triangles[2 * quad + 1], ( const int32_t[] ){ v + 1, v + SIDE, v + SIDE + 1 },
                sizeof( triangles[0] ) );
    }
}

static wisp_status cook( wisp_fabric** out, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.vertex_count = SIDE * SIDE;
    def.triangles = &triangles[0][0];
    def.triangle_count = WISP_COUNT( triangles );
    def.attachments = corners;
    def.attachment_count = WISP_COUNT( corners );
    def.tethers = true;
    return wisp_fabric_cook( &def, NULL, out, error );
}

static wisp_status add_cloth( wisp_world* world, wisp_fabric* fabric, wisp_entity* out )
{
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.pins = corners;
    surface.pin_count = WISP_COUNT( corners );
    wisp_status status = wisp_add_surface( world, &surface, out );
    if ( status == WISP_OK )
    {
        wisp_cloth_def cloth = wisp_default_cloth_def();
        cloth.tethers = true;
        cloth.drag_coefficient = 1.0f;
        cloth.wind = ( wisp_vec3 ){ 0.3f, 0.0f, -2.0f };
        status = wisp_set_cloth( world, *out, &cloth );
    }
    return status == WISP_OK ? wisp_set_gravity( world, *out, ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f } ) : status;
}

static wisp_status add_ball( wisp_world* world, wisp_entity cloth )
{
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.3f;
    ball.pose.translation = ( wisp_vec3 ){ 0.4f, -0.6f, 0.1f };
    wisp_entity added;
    wisp_status status = wisp_add_collider( world, &ball, &added );
    wisp_collision_def collision = wisp_default_collision_def();
    return status == WISP_OK ? wisp_set_collision( world, cloth, &collision ) : status;
}

int main( void )
{
    make_mesh();
    static const wisp_module* const modules[] = { &wisp_cloth_module, &wisp_collision_module };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.substeps = 8;
    wisp_error error = { 0 };
    wisp_fabric* fabric;
    wisp_world* world;
    if ( cook( &fabric, &error ) != WISP_OK || wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        printf( "%s\n", error.message );
        return 1;
    }
    wisp_entity cloth;
    wisp_status status = add_cloth( world, fabric, &cloth );
    wisp_fabric_release( fabric );
    status = status == WISP_OK ? add_ball( world, cloth ) : status;
    status = status == WISP_OK ? wisp_request( world, cloth, WISP_SURFACE_POINTS ) : status;
    for ( int step = 0; step < 60 && status == WISP_OK; ++step )
    {
        status = wisp_world_step( world, 1.0f / 60.0f );
    }
    if ( status != WISP_OK )
    {
        printf( "%s\n", wisp_world_message( world ) );
        return 1;
    }
    printf( "wisp " WISP_VERSION_STRING ", hash %016" PRIx64 "\n", wisp_world_hash( world ) );
    wisp_world_destroy( world );
    return 0;
}
