#include "validate_settings.h"

#include "validate_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

wisp_status validate_make( const void* like, size_t size, accuracy_scene scene, accuracy_scene* out,
                           wisp_error* error )
{
    *out = scene;
    const wisp_status status = accuracy_begin_scene( out, size, VALIDATE_MAX_SETTINGS, error );
    if ( status == WISP_OK )
    {
        memcpy( out->context, like, size );
    }
    return status;
}

wisp_status validate_make_grid( const validate_grid* grid, accuracy_scene scene, accuracy_scene* out,
                                wisp_error* error )
{
    const validate_settings like = { .list = { { 0 } } };
    const wisp_status status = validate_make( &like, sizeof like, scene, out, error );
    if ( status == WISP_OK )
    {
        validate_put_grid( out, grid );
    }
    return status;
}

const validate_setting* validate_setting_of( const void* context, int setting )
{
    return ( (const validate_settings*)context )->list + setting;
}

static accuracy_setting* put( accuracy_scene* out, validate_setting setting, const char* name )
{
    validate_settings* settings = out->context;
    WISP_ASSERT( out->setting_count < VALIDATE_MAX_SETTINGS );
    settings->list[out->setting_count] = setting;
    return accuracy_put_setting( out, "%s, %d cells, %d substeps", name, setting.cells, setting.substeps );
}

void validate_put_cells( accuracy_scene* out, int solver, const char* name, const char* cell, const int* cells,
                         int count, int substeps )
{
    char series[64];
    snprintf( series, sizeof series, "%s by cells", name );
    for ( int i = 0; i < count; ++i )
    {
        accuracy_join_series( put( out, ( validate_setting ){ solver, cells[i], substeps }, name ), series, cell,
                              1.0 / cells[i], NAN );
    }
}

void validate_put_substeps( accuracy_scene* out, int solver, const char* name, int cells, const int* substeps,
                            int count )
{
    char series[64];
    snprintf( series, sizeof series, "%s by substeps", name );
    for ( int i = 0; i < count; ++i )
    {
        accuracy_join_series( put( out, ( validate_setting ){ solver, cells, substeps[i] }, name ), series,
                              "substep, s", (double)VALIDATE_STEP / substeps[i], NAN );
    }
}

void validate_put_grid( accuracy_scene* out, const validate_grid* grid )
{
    int fewer[8];
    WISP_ASSERT( grid->halvings <= WISP_COUNT( fewer ) );
    for ( int i = 0; i < grid->halvings; ++i )
    {
        fewer[i] = grid->substeps >> ( i + 1 );
    }
    for ( int i = 0; i < grid->solver_count; ++i )
    {
        const int solver = grid->solvers[i];
        const char* name = grid->names[solver];
        validate_put_cells( out, solver, name, "cell / L", grid->cells, grid->cell_count, grid->substeps );
        validate_put_substeps( out, solver, name, grid->middle, fewer, grid->halvings );
    }
}
