// tune.c in C++: the substeps that a hanging cloth needs to be right to two centimetres.
//
//     c++ -std=c++17 tune.cpp $(pkg-config --cflags --libs wisp) -o tune && ./tune
//
// Prints what was tried and what was chosen; exit status 0 if the error is met, 1 if not.
#include <wisp/generate.h>
#include <wisp/tune.h>
#include <wisp/wisp.hpp>

#include <cstdio>

namespace
{

constexpr int SIDE = 13; // vertices
constexpr float SPACING = 0.5f / ( SIDE - 1 );

wisp_vec3 points[WISP_GRID_VERTICES( SIDE, SIDE )];
int32_t triangles[WISP_GRID_TRIANGLES( SIDE, SIDE )][3];
const int32_t corners[2] = { 0, SIDE - 1 };

const double substeps[] = { 1, 2, 4, 8, 16, 32 }; // from coarse to fine
const wisp_tune_parameter parameters[] = { { "substeps", substeps, WISP_COUNT( substeps ), false } };

// Build the world of a configuration. Tuning owns it: it requests the points, runs the world and destroys it.
wisp_status build( void* user, const int* configuration, int substep_factor, wisp_tune_world* out, wisp_error* error )
{
    (void)user;
    static wisp_tune_points compared;
    wisp_world_def def = wisp_default_world_def();
    def.modules = wisp_all_modules( &def.module_count );
    def.workers = 1;
    def.substeps = static_cast<int>( substeps[configuration[0]] ) * substep_factor;
    wisp_status status = wisp_world_create( &def, &out->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_create_cloth_def cloth = wisp_default_create_cloth_def();
    cloth.points = points;
    cloth.vertex_count = WISP_COUNT( points );
    cloth.triangles = &triangles[0][0];
    cloth.triangle_count = WISP_COUNT( triangles );
    cloth.pins = corners;
    cloth.pin_count = WISP_COUNT( corners );
    status = wisp_create_cloth( out->world, &cloth, &compared.entity );
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

} // namespace

int main()
{
    wisp::error error;
    wisp_tune_def args = wisp_default_tune_def();
    args.parameters = parameters;
    args.parameter_count = WISP_COUNT( parameters );
    args.error = 0.02; // m; or args.budget_ms
    wisp_tune_worlds_def worlds = wisp_default_tune_worlds_def();
    worlds.build = build;
    worlds.step_count = 30;
    wisp_tune_result found;
    if ( wisp_generate_grid( SIDE, SIDE, SPACING, SPACING, points, &triangles[0][0], &error ) != WISP_OK ||
         wisp_tune_worlds( &args, &worlds, &found, &error ) != WISP_OK )
    {
        std::printf( "%s\n", error.message );
        return 1;
    }
    for ( const wisp_tune_trial& trial :
          wisp::span<const wisp_tune_trial>( found.trials, static_cast<std::size_t>( found.trial_count ) ) )
    {
        std::printf( "%2.0f substeps: %.4f ms, %.2f mm\n", substeps[trial.configuration[0]], trial.sample.ms,
                     1e3 * trial.sample.error );
    }
    const bool is_met = found.meets_target && found.achieved.error <= 0.02;
    std::printf( "%s: %g substeps: %.4f ms per step, %.2f mm\n", is_met ? "met" : "not met", found.values[0],
                 found.achieved.ms, 1e3 * found.achieved.error );
    wisp_tune_release( &found );
    return is_met ? 0 : 1;
}
