#include "validate_rods.h"

#include <math.h>

wisp_strand_dynamics_def validate_rod_dynamics( int method )
{
    wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
    def.rest = WISP_STRAND_REST_STRAIGHT;
    def.bend_rigidity = def.twist_rigidity = 1.0f;
    def.line_density = 1.0f; // kg/m
    def.integrator = method == VALIDATE_ROD_BDF2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    return def;
}

validate_def validate_rod_def( const validate_setting* way, int count, int workers )
{
    return ( validate_def ){
        .solver = VALIDATE_ROD,
        .cells = way->cells,
        .substeps = way->substeps,
        .workers = workers,
        .count = count,
    };
}

wisp_status validate_add_straight( validate_bodies* b, int count, const wisp_strand_dynamics_def* dynamics,
                                   wisp_error* error )
{
    wisp_vec3 points[VALIDATE_LADDER * ( VALIDATE_MAX_CELLS + 1 )];
    const int vertices = b->def.cells + 1;
    for ( int i = 0; i < count * vertices; ++i )
    {
        points[i] = ( wisp_vec3 ){ (float)( i % vertices ) / (float)b->def.cells, 0.0f, 0.0f };
    }
    return validate_add_strands( b, count, points, dynamics, error );
}

wisp_status validate_turn_tip( validate_bodies* b, int body, int strand, double angle, double nearer,
                               wisp_error* error )
{
    const wisp_transform pose = { { (float)sin( 0.5 * angle ), 0.0f, 0.0f, (float)cos( 0.5 * angle ) },
                                  { (float)-nearer, 0.0f, 0.0f } };
    const wisp_status status = wisp_move_strand_tip( b->world.world, b->world.bodies[body].entity, strand, pose );
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

wisp_status validate_hold_tips( validate_bodies* b, int body, int count, wisp_strand_tip hold, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        status = wisp_hold_strand_tip( b->world.world, b->world.bodies[body].entity, i, hold );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( b->world.world, status, error );
}

wisp_status validate_make_rods( accuracy_scene scene, const int* cells, int cell_count, int method_count,
                                int substeps, accuracy_scene* out, wisp_error* error )
{
    static const char* const names[VALIDATE_ROD_METHODS] = { "rod", "rod bdf2" };
    static const int methods[VALIDATE_ROD_METHODS] = { VALIDATE_ROD_EULER, VALIDATE_ROD_BDF2 };
    const validate_grid grid = {
        .names = names,
        .solvers = methods,
        .solver_count = method_count,
        .cells = cells,
        .cell_count = cell_count,
        .middle = cells[2],
        .substeps = substeps,
        .halvings = 3,
    };
    return validate_make_grid( &grid, scene, out, error );
}
