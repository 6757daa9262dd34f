// A sheet held at two corners falls: its links one after another in double precision, one pass per substep.
#include "accuracy_references.h"
#include "converge.h"

#include "accuracy/hanging_cloth.h"

#include <stdio.h>

enum
{
    FINEST = HANGING_CLOTH_MESHES - 1,
    SUBSTEPS = 5120, // of each 1/60 s
};

#define TOLERANCE 5e-4 // m

typedef struct hanging_run
{
    cloth_scene scene;
    wisp_fabric* fabric;
} hanging_run;

static void keep( const hanging_run* own, const path_record* record, double* numbers )
{
    const int side = HANGING_CLOTH_PLACES, n = own->scene.n, stride = ( n - 1 ) / ( side - 1 );
    for ( int i = 0; i < HANGING_CLOTH_OBSERVATIONS * side * side; ++i )
    {
        const int observation = i / ( side * side ), row = i / side % side, column = i % side;
        const double* p = record->points + 3 * ( observation * n * n + stride * ( row * n + column ) );
        for ( int k = 0; k < 3; ++k )
        {
            *numbers++ = p[k];
        }
    }
}

static wisp_status run( void* context, int substeps, double* numbers, wisp_error* error )
{
    static const scenario_plan fall = { .warm_steps = HANGING_CLOTH_STEPS,
                                        .turn_steps = HANGING_CLOTH_OBSERVATION_STEPS };
    const hanging_run* own = context;
    path_record record = { 0 };
    cloth_reference cloth;
    wisp_status status =
        path_record_create( own->scene.mesh.vertex_count, scenario_path_observations( &fall ), &record, error );
    status = status == WISP_OK ? cloth_reference_create( &own->scene, own->fabric, &cloth, error ) : status;
    if ( status == WISP_OK )
    {
        double energy_lost;
        cloth_reference_soften( &cloth, 1.0 / HANGING_CLOTH_EDGE_STIFFNESS, hanging_cloth_bend_compliance( FINEST ),
                                (double)HANGING_CLOTH_DENSITY );
        cloth_reference_run( &cloth, substeps, &fall, &record, &energy_lost );
        keep( own, &record, numbers );
        cloth_reference_destroy( &cloth );
    }
    path_record_destroy( &record );
    return status;
}

wisp_status reference_of_hanging_cloth( accuracy_reference* out, wisp_error* error )
{
    static const cloth_setting plain = { .substeps = 1, .iterations = 1, .solve_order = WISP_SOLVE_ORDER_COLOUR };
    hanging_run own = { .fabric = NULL };
    wisp_status status = hanging_cloth_make( FINEST, &own.scene, error );
    status = status == WISP_OK ? cloth_cook( &own.scene, &plain, &own.fabric, error ) : status;
    if ( status == WISP_OK )
    {
        *out = hanging_cloth_reference( &own.scene );
        const converge_plan plan = { .run = run,
                                     .context = &own,
                                     .unit = "substeps",
                                     .substeps = SUBSTEPS,
                                     .compared = out->number_count,
                                     .dimension = 3,
                                     .converging = out->number_count,
                                     .tolerance = TOLERANCE };
        snprintf( out->reference, sizeof( out->reference ),
                  "the same sheet of %d x %d vertices by xpbd of one pass in double precision, at %d observations "
                  "within 0.4 s",
                  own.scene.n, own.scene.n, HANGING_CLOTH_OBSERVATIONS );
        snprintf(
            out->solver, sizeof( out->solver ),
            "xpbd, one pass a substep, links one after another (bench/cloth_reference.c); substeps are of 1/60 s" );
        snprintf( out->precision, sizeof( out->precision ), "double" );
        snprintf( out->layout, sizeof( out->layout ),
                  "float64 [%d observations][%d rows][%d columns][x, y, z], m: every second vertex of a side",
                  HANGING_CLOTH_OBSERVATIONS, HANGING_CLOTH_PLACES, HANGING_CLOTH_PLACES );
        status = converge( &plan, out, error );
    }
    wisp_fabric_release( own.fabric );
    cloth_scene_free( &own.scene );
    return status;
}
