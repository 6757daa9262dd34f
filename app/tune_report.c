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
                                        is_chosen( def->knobs, found, visit ) ? "chosen" : "tried" );
    if ( !row )
    {
        return;
    }
    results_put( &row->size, "points", facts->points );
    for ( int k = 0; k < def->knobs->count; ++k )
    {
        results_put( &row->size, def->knobs->knobs[k].name, def->knobs->values[k][visit->choice[k]] );
    }
    results_put( &row->size, "front", visit->is_front ? 1.0 : 0.0 );
    results_put( &row->size, "halted", visit->sample.is_halted ? 1.0 : 0.0 );
    row->workers = facts->workers;
    row->ms_median = visit->sample.ms;
    row->steps = facts->steps * visit->run_count;
    if ( !visit->sample.is_halted )
    {
        snprintf( row->error_reference, sizeof row->error_reference, "%d times the finest substeps",
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
              : visit->is_front                ? "front"
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
    header[knobs->count] = "ms a step";
    header[knobs->count + 1] = "error m";
    header[knobs->count + 2] = "largest m";
    header[knobs->count + 3] = "verdict";
    const int table = results_add_table( out, "Settings that were run, the fastest first", knobs->count + 4, header );
    for ( int v = 0; v < found->visit_count; ++v )
    {
        add_line( out, table, knobs, found, &found->visits[v] );
    }
}

static void add_truth_note( results* out, const tune_scene_def* def, const tune_scene_facts* facts )
{
    int finest[WISP_TUNE_MAX_KNOBS];
    for ( int k = 0; k < def->knobs->count; ++k )
    {
        finest[k] = def->knobs->knobs[k].value_count - 1;
    }
    char setting[240];
    name_setting( def->knobs, finest, setting, sizeof setting );
    results_add_note(
        out,
        "Errors are root mean squares of distances over %d points and %d steps of %g s, against the setting "
        "%s with %d times these substeps.",
        facts->points, facts->steps, (double)def->scene->step_seconds, setting, TUNE_TRUTH_FACTOR );
}

static void add_verdict( results* out, const tune_scene_def* def, const wisp_tune_result* found )
{
    char setting[240], target[60];
    name_setting( def->knobs, found->choice, setting, sizeof setting );
    if ( def->error > 0.0 )
    {
        snprintf( target, sizeof target, "an error of %g m", def->error );
    }
    else
    {
        snprintf( target, sizeof target, "%g ms a step", def->budget_ms );
    }
    if ( found->achieved.is_halted )
    {
        results_add_failure( out, "Not met: %s; every setting that was run left its bounds.", target );
    }
    else if ( !found->is_met )
    {
        results_add_failure( out, "Not met: %s; nearest comes %s, with %.4f ms a step and an error of %.3e m.",
                             target, setting, found->achieved.ms, found->achieved.error );
    }
    else
    {
        results_add_note( out, "Met: %s, by %s, with %.4f ms a step and an error of %.3e m (largest %.3e m).", target,
                          setting, found->achieved.ms, found->achieved.error, found->achieved.largest );
    }
    results_add_note( out, "%d runs of %d settings in %.1f s%s.", found->run_count, found->visit_count,
                      found->seconds, found->is_cut ? ", ended by a limit: there may be better ones" : "" );
}

void tune_report( results* out, const tune_scene_def* def, const tune_scene_facts* facts, wisp_tune_result* found )
{
    out->machine = machine_describe( facts->isa );
    qsort( found->visits, (size_t)found->visit_count, sizeof *found->visits, compare_visits );
    for ( int v = 0; v < found->visit_count; ++v )
    {
        add_row( out, def, facts, found, &found->visits[v] );
    }
    add_table( out, def, found );
    add_truth_note( out, def, facts );
    add_verdict( out, def, found );
}
