// Ask for an error and get a setting: how many substeps and iterations a hanging cloth needs to be right to two centimetres.
//
//     cc -std=c17 tune.c $(pkg-config --cflags --libs wisp) -o tune && ./tune
//
// Prints what was tried and what was chosen; exit status 0 if the error is met, 1 if not.
#include <wisp/cloth.h>
#include <wisp/fabric.h>
#include <wisp/generate.h>
#include <wisp/tune.h>
#include <wisp/wisp.h>

#include <stdio.h>

#define SIDE 13                         // vertices
#define SPACING ( 0.5f / ( SIDE - 1 ) ) // m: a square of half a metre

static wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
static int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
static const int32_t corners[2] = { 0, SIDE - 1 };

// From rough to fine.
static const double substeps[] = { 1, 2, 4, 8, 16, 32 };
static const double iterations[] = { 1, 2 };
static const wisp_tune_parameter parameters[] = {
    { "substeps", substeps, WISP_COUNT( substeps ), false },
    { "iterations", iterations, WISP_COUNT( iterations ), false },
};

static wisp_status add_cloth( wisp_world* world, wisp_fabric* fabric, wisp_entity* out )
{
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = fabric;
    surface.pins = corners;
    surface.pin_count = WISP_COUNT( corners );
    const wisp_cloth_def cloth = wisp_default_cloth_def();
    wisp_status status = wisp_add_surface( world, &surface, out );
    return status == WISP_OK ? wisp_set_cloth( world, *out, &cloth ) : status;
}

// Build the world of a configuration. Tuning requests the points, runs the world and destroys it.
static wisp_status build( void* user, const int* configuration, int substep_factor, wisp_tune_world* out,
                          wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_cloth_module };
    static wisp_tune_points compared;
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.workers = 1;
    def.substeps = (int)substeps[configuration[0]] * substep_factor;
    def.iterations = (int)iterations[configuration[1]];
    wisp_status status = wisp_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add_cloth( out->world, user, &compared.entity );
    if ( status != WISP_OK )
    {
        wisp_fail( error, status, "%s", wisp_world_message( out->world ) );
        wisp_world_destroy( out->world );
        return status;
    }
    compared.component = WISP_SURFACE_POINTS;
    out->points = &compared;
    out->point_count = 1;
    return WISP_OK;
}

static wisp_status tune( wisp_fabric* fabric, wisp_tune_result* out, wisp_error* error )
{
    wisp_tune_def args = wisp_default_tune_def();
    args.parameters = parameters;
    args.parameter_count = WISP_COUNT( parameters );
    args.error = 0.02; // m; or args.budget_ms
    wisp_tune_worlds_def worlds = wisp_default_tune_worlds_def();
    worlds.build = build;
    worlds.user = fabric;
    worlds.step_count = 30;
    return wisp_tune_worlds( &args, &worlds, out, error );
}

static void print( const wisp_tune_result* found )
{
    for ( int i = 0; i < found->trial_count; ++i )
    {
        const wisp_tune_trial* trial = &found->trials[i];
        printf( "%2.0f substeps, %1.0f iterations: %.4f ms, %.2f mm%s\n", substeps[trial->configuration[0]],
                iterations[trial->configuration[1]], trial->sample.ms, 1e3 * trial->sample.error,
                trial->is_pareto ? ", nothing beats it" : "" );
    }
    printf( "%s: %g substeps, %g iterations: %.4f ms a step, %.2f mm\n", found->meets_target ? "met" : "not met",
            found->values[0], found->values[1], found->achieved.ms, 1e3 * found->achieved.error );
}

int main( void )
{
    wisp_error error = { 0 };
    if ( wisp_generate_grid( SIDE, SIDE, SPACING, SPACING, points, &triangles[0][0], &error ) != WISP_OK )
    {
        printf( "%s\n", error.message );
        return 1;
    }
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.vertex_count = WISP_COUNT( points );
    def.triangles = &triangles[0][0];
    def.triangle_count = WISP_COUNT( triangles );
    def.attachments = corners;
    def.attachment_count = WISP_COUNT( corners );
    def.bend_links = true;
    wisp_fabric* fabric;
    wisp_tune_result found;
    if ( wisp_fabric_cook( &def, NULL, &fabric, &error ) != WISP_OK )
    {
        printf( "%s\n", error.message );
        return 1;
    }
    const wisp_status status = tune( fabric, &found, &error );
    wisp_fabric_release( fabric );
    if ( status != WISP_OK )
    {
        printf( "%s\n", error.message );
        return 1;
    }
    print( &found );
    const bool meets_target = found.meets_target && found.achieved.error <= 0.02;
    wisp_tune_release( &found );
    return meets_target ? 0 : 1;
}
