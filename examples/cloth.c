// A cloth that hangs from two corners in the wind: mesh, fabric, surface, cloth, steps, and what is read of them.
//
//     cc -std=c17 cloth.c $(pkg-config --cflags --libs wisp) -o cloth && ./cloth
//
// Prints a line a second; exit status 0 if all is as it should be, 1 if not.
#include <wisp/cloth.h>
#include <wisp/fabric.h>
#include <wisp/generate.h>
#include <wisp/wisp.h>

#include <stdio.h>

#define SIDE 33 // vertices
#define STEP ( 1.0f / 60.0f )
#define SPACING ( 1.0f / ( SIDE - 1 ) ) // m: a square of a metre

static wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
static int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
static const int32_t corners[2] = { 0, SIDE - 1 };

// Cook once, share as often as you like. The corners are where it hangs: the order begins there, and tethers reach there.
static wisp_status cook( wisp_fabric** out, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.vertex_count = WISP_COUNT( points );
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
        cloth.wind = ( wisp_vec3 ){ 0.0f, 0.0f, -2.0f };
        status = wisp_set_cloth( world, *out, &cloth );
    }
    // Asking creates the passes: without a request a step does nothing.
    if ( status == WISP_OK )
    {
        status = wisp_request( world, *out, WISP_SURFACE_POINTS );
    }
    return status == WISP_OK ? wisp_request( world, *out, WISP_MOTION_STATS ) : status;
}

static wisp_status run( wisp_world* world, wisp_entity cloth )
{
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= 180 && status == WISP_OK; ++step )
    {
        status = wisp_world_step( world, STEP );
        wisp_view view;
        wisp_motion_stats motion_stats;
        if ( step % 60 == 0 && status == WISP_OK &&
             wisp_world_view( world, cloth, WISP_SURFACE_POINTS, &view ) == WISP_OK &&
             wisp_read_motion_stats( world, cloth, &motion_stats ) == WISP_OK )
        {
            const wisp_vec3* last = (const wisp_vec3*)view.data + view.count - 1; // in our own order
            printf( "%d s: a free corner is at (%.2f, %.2f, %.2f), the largest strain is %.2f %%\n", step / 60,
                    (double)last->x, (double)last->y, (double)last->z, 100.0 * motion_stats.strain_max );
            status = motion_stats.strain_max < 0.1 && last->y < 0.0f ? WISP_OK : WISP_BAD_INPUT;
        }
    }
    return status;
}

int main( void )
{
    static const wisp_module* const modules[] = { &wisp_cloth_module };
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.substeps = 10; // ten substeps of one iteration: an order of magnitude less stretch than one of ten
    wisp_error error = { 0 };
    wisp_fabric* fabric;
    wisp_world* world;
    if ( wisp_generate_grid( SIDE, SIDE, SPACING, SPACING, points, &triangles[0][0], &error ) != WISP_OK ||
         cook( &fabric, &error ) != WISP_OK || wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        printf( "%s\n", error.message );
        return 1;
    }
    wisp_entity cloth;
    wisp_status status = add_cloth( world, fabric, &cloth );
    wisp_fabric_release( fabric ); // the surface has its own reference
    status = status == WISP_OK ? run( world, cloth ) : status;
    if ( status != WISP_OK )
    {
        printf( "not as it should be: %s\n", wisp_world_message( world ) );
    }
    wisp_world_destroy( world );
    return status == WISP_OK ? 0 : 1;
}
