#include "validate_ways.h"

#include "accuracy/scene_tools.h"

#include <math.h>

static const double SECONDS = 1.0 / 60.0;
static const double HALF_LADDER = 0.3;

static void put_setting( accuracy_scene* scene, validate_way way, const char* series, const char* parameter,
                         double value, validate_way* ways )
{
    ways[scene->setting_count] = way;
    accuracy_join_series( accuracy_put_setting( scene, "%s, %d cells, %d substeps", validate_solver_names[way.solver],
                                                way.cells, way.substeps ),
                          series, parameter, value, NAN );
}

void validate_put_settings( accuracy_scene* scene, const validate_series* series, validate_way* ways )
{
    for ( int s = 0; s < series->solver_count; ++s )
    {
        const validate_solver solver = series->solvers[s];
        char name[64];
        snprintf( name, sizeof name, "%s by cells", validate_solver_names[solver] );
        for ( int i = 0; i < series->cell_count; ++i )
        {
            const int cells = series->cells[i];
            put_setting( scene, ( validate_way ){ solver, cells, series->substeps }, name, "cell / L", 1.0 / cells,
                         ways );
        }
        snprintf( name, sizeof name, "%s by substeps", validate_solver_names[solver] );
        for ( int k = 2; k <= 8; k *= 2 )
        {
            const int fewer = series->substeps / k;
            put_setting( scene, ( validate_way ){ solver, series->fixed_cells, fewer }, name, "substep, s",
                         SECONDS / fewer, ways );
        }
    }
}

wisp_status validate_step_for( validate_bodies* bodies, double seconds, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < (int)ceil( seconds / SECONDS ) && status == WISP_OK; ++i )
    {
        status = validate_step( bodies, out, error );
    }
    return status;
}

double validate_frequency( double load )
{
    return 3.516 * sqrt( VALIDATE_GRAVITY / ( load * VALIDATE_LENGTH ) );
}

void validate_ladder( double critical, int count, double* out )
{
    for ( int i = 0; i < count; ++i )
    {
        out[i] = critical * ( 1.0 - HALF_LADDER + 2.0 * HALF_LADDER * i / ( count - 1 ) );
    }
}

double validate_ladder_found( const bool* is_over, const double* rungs, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( is_over[i] )
        {
            return i > 0 ? 0.5 * ( rungs[i - 1] + rungs[i] ) : NAN;
        }
    }
    return NAN;
}

double validate_ladder_error( double found, double critical )
{
    return isnan( found ) ? HALF_LADDER : fabs( found / critical - 1.0 );
}

double validate_ladder_doubt( int count )
{
    return HALF_LADDER / ( count - 1 );
}
