// Frozen hair that clumps, by its oracle with all neighbours: the default settings, which have no substeps to
// converge in, and a flow in many short steps of clumping.
#include "accuracy_references.h"
#include "converge.h"

#include "accuracy/frozen_clumps.h"

#include <stdio.h>

enum
{
    STEPS = 128, // of clumping
};

#define TOLERANCE 3e-5 // m

// The flow comes first here, because it converges.
static wisp_status flow( void* context, int steps, double* numbers, wisp_error* error )
{
    paper_scene scene = *(const paper_scene*)context;
    scene.def = frozen_clumps_flow( context, steps );
    return paper_oracle_run( &scene, 0, numbers, error );
}

static wisp_status add_default( const paper_scene* hair, accuracy_reference* out, wisp_error* error )
{
    const int half = out->number_count / 2;
    paper_scene scene = *hair;
    scene.def = frozen_clumps_default( hair );
    for ( int i = 0; i < half; ++i )
    {
        out->numbers[half + i] = out->numbers[i];
    }
    return paper_oracle_run( &scene, 0, out->numbers, error );
}

wisp_status reference_of_frozen_clumps( accuracy_reference* out, wisp_error* error )
{
    paper_scene hair;
    wisp_status status = frozen_clumps_make( &hair, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    *out = frozen_clumps_reference( &hair );
    const converge_plan plan = { .run = flow,
                                 .context = &hair,
                                 .unit = "short steps of clumping",
                                 .substeps = STEPS,
                                 .compared = out->number_count / 2,
                                 .dimension = 3,
                                 .converging = out->number_count / 2,
                                 .tolerance = TOLERANCE };
    snprintf( out->reference, sizeof( out->reference ),
              "the method in double precision with all neighbours; the flow" );
    snprintf( out->solver, sizeof( out->solver ),
              "neighbours by brute force (tests/oracle/frozen_hair_oracle.h); substeps are the flow's steps of "
              "clumping" );
    snprintf( out->precision, sizeof( out->precision ), "double" );
    snprintf( out->layout, sizeof( out->layout ),
              "float64 [%d vertices][x, y, z], m, of the default clumps, which is exact; then the same of the flow",
              hair.groom.vertex_count );
    status = converge( &plan, out, error );
    status = status == WISP_OK ? add_default( &hair, out, error ) : status;
    paper_scene_free( &hair );
    return status;
}
