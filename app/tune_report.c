#include "tune_report.h"

#include <stdlib.h>
#include <string.h>

static const char* last_part( const char* path )
{
    const char* slash = strrchr( path, '/' );
    return slash ? slash + 1 : path;
}

static bool is_chosen( const tune_knobs* knobs, const wisp_tune_result* found, const wisp_tune_visit* visit )
{
    return memcmp( visit->choice, found->choice, (size_t)knobs->count * sizeof( int ) ) == 0;
}

static void name_setting( const tune_knobs* knobs, const int* choice, char* out, size_t size )
{
    out[0] = '\0';
    for ( int k = 0; k < knobs->count; ++k )
    {
        char value[32];
        tune_knobs_text( knobs, k, knobs->values[k][choice[k]], value, sizeof value );
        const size_t length = strlen( out );
        snprintf( out + length, size - length, "%s%s: %s", k > 0 ? ", " : "", knobs->knobs[k].name, value );
    }
}

static void add_row( results* out, const tune_scene_def* def, const tune_scene_facts* facts,
                     const wisp_tune_result* found, const wisp_tune_visit* visit )
{
    results_row* row = results_add_row( out, last_part( def->scene->name ),
                                        is_chosen( def->knobs, found, visit ) ? "chosen" : "trial" );
    if ( !row )
    {
        return;
    }
    results_put( &row->size, "points", facts->points );
    for ( int k = 0; k < def->knobs->count; ++k )
    {
        results_put( &row->size, def->knobs->knobs[k].name, def->knobs->values[k][visit->choice[k]] );
    }
    results_put( &row->size, "is_pareto", visit->is_front ? 1.0 : 0.0 );
    results_put( &row->size, "halted", visit->sample.is_halted ? 1.0 : 0.0 );
    row->workers = facts->workers;
    row->ms_median = visit->sample.ms;
    row->steps = facts->steps * visit->run_count;
    if ( !visit->sample.is_halted )
    {
        snprintf( row->error_reference, sizeof row->error_reference, "reference: %d times the finest substeps",
                  TUNE_TRUTH_FACTOR );
        results_put( &row->error, "rms_m", visit->sample.error );
        results_put( &row->error, "largest_m", visit->sample.largest );
    }
}

static void add_line( results* out, int table, const tune_knobs* knobs, const wisp_tune_result* found,
                      const wisp_tune_visit* visit )
{
    char texts[WISP_TUNE_MAX_KNOBS + 4][32];
    const char* cells[WISP_TUNE_MAX_KNOBS + 4];
    for ( int i = 0; i < knobs->count + 4; ++i )
    {
        cells[i] = texts[i];
    }
    for ( int k = 0; k < knobs->count; ++k )
    {
        tune_knobs_text( knobs, k, knobs->values[k][visit->choice[k]], texts[k], sizeof texts[k] );
    }
    const bool halted = visit->sample.is_halted;
    snprintf( texts[knobs->count], sizeof texts[0], "%.4f", visit->sample.ms );
    snprintf( texts[knobs->count + 1], sizeof texts[0], halted ? "-" : "%.3e", visit->sample.error );
    snprintf( texts[knobs->count + 2], sizeof texts[0], halted ? "-" : "%.3e", visit->sample.largest );
    snprintf( texts[knobs->count + 3], sizeof texts[0], "%s",
              is_chosen( knobs, found, visit ) ? "chosen"
              : halted                         ? "halted"
              : visit->is_front                ? "Pareto"
                                               : "" );
    results_add_cells( out, table, cells );
}

static int compare_visits( const void* a, const void* b )
{
    const wisp_tune_visit *x = a, *y = b;
    return ( x->sample.ms > y->sample.ms ) - ( x->sample.ms < y->sample.ms );
}

static void add_table( results* out, const tune_scene_def* def, const wisp_tune_result* found )
{
    const tune_knobs* knobs = def->knobs;
    const char* header[WISP_TUNE_MAX_KNOBS + 4];
    for ( int k = 0; k < knobs->count; ++k )
    {
        header[k] = knobs->knobs[k].name;
    }
    header[knobs->count] = "ms per step";
    header[knobs->count + 1] = "error (m)";
    header[knobs->count + 2] = "max error (m)";
    header[knobs->count + 3] = "verdict";
    const int table = results_add_table( out, "Configurations, fastest first", knobs->count + 4, header );
    for ( int v = 0; v < found->visit_count; ++v )
    {
        add_line( out, table, knobs, found, &found->visits[v] );
    }
}

static void add_reference( results* out, int table, const tune_scene_def* def, const tune_scene_facts* facts )
{
    int finest[WISP_TUNE_MAX_KNOBS];
    for ( int k = 0; k < def->knobs->count; ++k )
    {
        finest[k] = def->knobs->knobs[k].value_count - 1;
    }
    char setting[240], text[320];
    name_setting( def->knobs, finest, setting, sizeof setting );
    snprintf( text, sizeof text, "%s; %d times the substeps", setting, TUNE_TRUTH_FACTOR );
    results_add_cells( out, table, ( const char* const[] ){ "reference", text } );
    snprintf( text, sizeof text, "root mean square distance over %d points and %d steps of %g s", facts->points,
              facts->steps, (double)def->scene->step_seconds );
    results_add_cells( out, table, ( const char* const[] ){ "error", text } );
}

static void add_verdict( results* out, int table, const tune_scene_def* def, const wisp_tune_result* found )
{
    char setting[240], text[320], target[60];
    name_setting( def->knobs, found->choice, setting, sizeof setting );
    if ( def->error > 0.0 )
    {
        snprintf( target, sizeof target, "error at most %g m", def->error );
    }
    else
    {
        snprintf( target, sizeof target, "at most %g ms per step", def->budget_ms );
    }
    snprintf( text, sizeof text, "%s: %s", found->is_met ? "met" : "not met", target );
    results_add_cells( out, table, ( const char* const[] ){ "target", text } );
    if ( found->achieved.is_halted )
    {
        results_add_cells( out, table,
                           ( const char* const[] ){ "nearest", "none: every configuration became unstable" } );
        return;
    }
    results_add_cells( out, table, ( const char* const[] ){ found->is_met ? "chosen" : "nearest", setting } );
    snprintf( text, sizeof text, "%.4f ms per step, error %.3e m, maximum %.3e m", found->achieved.ms,
              found->achieved.error, found->achieved.largest );
    results_add_cells( out, table, ( const char* const[] ){ "reached", text } );
}

static void add_search( results* out, int table, const wisp_tune_result* found )
{
    char text[160];
    snprintf( text, sizeof text, "%d run%s of %d configuration%s in %.1f s%s", found->run_count,
              found->run_count == 1 ? "" : "s", found->visit_count, found->visit_count == 1 ? "" : "s",
              found->seconds, found->is_cut ? "; stopped early by a limit, better ones may exist" : "" );
    results_add_cells( out, table, ( const char* const[] ){ "search", text } );
}

void tune_report( results* out, const tune_scene_def* def, const tune_scene_facts* facts, wisp_tune_result* found )
{
    out->machine = machine_describe( facts->isa );
    out->is_result_first = true;
    qsort( found->visits, (size_t)found->visit_count, sizeof *found->visits, compare_visits );
    for ( int v = 0; v < found->visit_count; ++v )
    {
        add_row( out, def, facts, found, &found->visits[v] );
    }
    const int head = results_add_table( out, "", 2, ( const char* const[] ){ "", "" } );
    add_verdict( out, head, def, found );
    add_search( out, head, found );
    add_reference( out, head, def, facts );
    add_table( out, def, found );
}
