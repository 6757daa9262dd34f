#include "tune_report.h"

#include "io_file.h"

#include <stdlib.h>
#include <string.h>

static bool is_chosen( const tune_parameters* parameters, const wisp_tune_result* found,
                       const wisp_tune_trial* trial )
{
    return memcmp( trial->configuration, found->configuration, (size_t)parameters->count * sizeof( int ) ) == 0;
}

static void name_setting( const tune_parameters* parameters, const int* configuration, char* out, size_t size )
{
    out[0] = '\0';
    for ( int k = 0; k < parameters->count; ++k )
    {
        char value[32];
        tune_parameters_text( parameters, k, parameters->values[k][configuration[k]], value, sizeof value );
        const size_t length = strlen( out );
        snprintf( out + length, size - length, "%s%s: %s", k > 0 ? ", " : "", parameters->parameters[k].name, value );
    }
}

static void add_row( results* out, const tune_scene_def* def, const tune_scene_info* info,
                     const wisp_tune_result* found, const wisp_tune_trial* trial )
{
    results_row* row = results_add_row( out, io_file_name( def->scene->name ),
                                        is_chosen( def->parameters, found, trial ) ? "chosen" : "trial" );
    if ( !row )
    {
        return;
    }
    results_put( &row->size, "points", info->points );
    for ( int k = 0; k < def->parameters->count; ++k )
    {
        results_put( &row->size, def->parameters->parameters[k].name,
                     def->parameters->values[k][trial->configuration[k]] );
    }
    results_put( &row->size, "is_pareto", trial->is_pareto ? 1.0 : 0.0 );
    results_put( &row->size, "halted", trial->sample.is_halted ? 1.0 : 0.0 );
    row->workers = info->workers;
    row->ms_median = trial->sample.ms;
    row->steps = info->steps * trial->run_count;
    if ( !trial->sample.is_halted )
    {
        snprintf( row->error_reference, sizeof row->error_reference, "reference: %d times the finest substeps",
                  TUNE_REFERENCE_FACTOR );
        results_put( &row->error, "rms_m", trial->sample.error );
        results_put( &row->error, "largest_m", trial->sample.largest );
    }
}

static void add_line( results* out, int table, const tune_parameters* parameters, const wisp_tune_result* found,
                      const wisp_tune_trial* trial )
{
    char texts[WISP_TUNE_MAX_PARAMETERS + 4][32];
    const char* cells[WISP_TUNE_MAX_PARAMETERS + 4];
    for ( int i = 0; i < parameters->count + 4; ++i )
    {
        cells[i] = texts[i];
    }
    for ( int k = 0; k < parameters->count; ++k )
    {
        tune_parameters_text( parameters, k, parameters->values[k][trial->configuration[k]], texts[k],
                              sizeof texts[k] );
    }
    const bool halted = trial->sample.is_halted;
    snprintf( texts[parameters->count], sizeof texts[0], "%.4f", trial->sample.ms );
    snprintf( texts[parameters->count + 1], sizeof texts[0], halted ? "-" : "%.3e", trial->sample.error );
    snprintf( texts[parameters->count + 2], sizeof texts[0], halted ? "-" : "%.3e", trial->sample.largest );
    snprintf( texts[parameters->count + 3], sizeof texts[0], "%s",
              is_chosen( parameters, found, trial ) ? "chosen"
              : halted                              ? "halted"
              : trial->is_pareto                    ? "Pareto"
                                                    : "" );
    results_add_cells( out, table, cells );
}

static int compare_visits( const void* a, const void* b )
{
    const wisp_tune_trial *x = a, *y = b;
    return ( x->sample.ms > y->sample.ms ) - ( x->sample.ms < y->sample.ms );
}

static void add_table( results* out, const tune_scene_def* def, const wisp_tune_result* found )
{
    const tune_parameters* parameters = def->parameters;
    const char* header[WISP_TUNE_MAX_PARAMETERS + 4];
    for ( int k = 0; k < parameters->count; ++k )
    {
        header[k] = parameters->parameters[k].name;
    }
    header[parameters->count] = "ms per step";
    header[parameters->count + 1] = "error (m)";
    header[parameters->count + 2] = "max error (m)";
    header[parameters->count + 3] = "verdict";
    const int table = results_add_table( out, "Configurations, fastest first", parameters->count + 4, header );
    for ( int v = 0; v < found->trial_count; ++v )
    {
        add_line( out, table, parameters, found, &found->trials[v] );
    }
}

static void add_reference( results* out, int table, const tune_scene_def* def, const tune_scene_info* info )
{
    int finest[WISP_TUNE_MAX_PARAMETERS];
    for ( int k = 0; k < def->parameters->count; ++k )
    {
        finest[k] = def->parameters->parameters[k].value_count - 1;
    }
    char setting[240], text[320];
    name_setting( def->parameters, finest, setting, sizeof setting );
    snprintf( text, sizeof text, "%s; %d times the substeps", setting, TUNE_REFERENCE_FACTOR );
    results_add_cells( out, table, ( const char* const[] ){ "reference", text } );
    snprintf( text, sizeof text, "root mean square distance over %d points and %d steps of %g s", info->points,
              info->steps, (double)def->scene->dt );
    results_add_cells( out, table, ( const char* const[] ){ "error", text } );
}

static void add_verdict( results* out, int table, const tune_scene_def* def, const wisp_tune_result* found )
{
    char setting[240], text[320], target[60];
    name_setting( def->parameters, found->configuration, setting, sizeof setting );
    if ( def->error > 0.0 )
    {
        snprintf( target, sizeof target, "error at most %g m", def->error );
    }
    else
    {
        snprintf( target, sizeof target, "at most %g ms per step", def->budget_ms );
    }
    snprintf( text, sizeof text, "%s: %s", found->meets_target ? "met" : "not met", target );
    results_add_cells( out, table, ( const char* const[] ){ "target", text } );
    if ( found->achieved.is_halted )
    {
        results_add_cells( out, table,
                           ( const char* const[] ){ "nearest", "none: every configuration became unstable" } );
        return;
    }
    results_add_cells( out, table, ( const char* const[] ){ found->meets_target ? "chosen" : "nearest", setting } );
    snprintf( text, sizeof text, "%.4f ms per step, error %.3e m, maximum %.3e m", found->achieved.ms,
              found->achieved.error, found->achieved.largest );
    results_add_cells( out, table, ( const char* const[] ){ "reached", text } );
}

static void add_search( results* out, int table, const wisp_tune_result* found )
{
    char text[160];
    snprintf( text, sizeof text, "%d run%s of %d configuration%s in %.1f s%s", found->run_count,
              found->run_count == 1 ? "" : "s", found->trial_count, found->trial_count == 1 ? "" : "s",
              found->seconds, found->stopped_early ? "; stopped early by a limit, better ones may exist" : "" );
    results_add_cells( out, table, ( const char* const[] ){ "search", text } );
}

void tune_report( results* out, const tune_scene_def* def, const tune_scene_info* info, wisp_tune_result* found )
{
    out->machine = machine_describe( info->isa );
    out->is_result_first = true;
    qsort( found->trials, (size_t)found->trial_count, sizeof *found->trials, compare_visits );
    for ( int v = 0; v < found->trial_count; ++v )
    {
        add_row( out, def, info, found, &found->trials[v] );
    }
    const int head = results_add_table( out, "", 2, ( const char* const[] ){ "", "" } );
    add_verdict( out, head, def, found );
    add_search( out, head, found );
    add_reference( out, head, def, info );
    add_table( out, def, found );
}
