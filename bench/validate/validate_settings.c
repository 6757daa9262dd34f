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
