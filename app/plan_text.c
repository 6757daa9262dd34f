// The plan for readers. The short form has one line per active pass and one per absent module; the verbose form adds
// the columns and cost of each pass, and every absent pass.
#include "plan_sheet.h"

#include <string.h>

// Runs per step: of all entities, or of the one with the fewest and the one with the most.
static void runs_text( const wisp_plan_pass* p, char* out, size_t size )
{
    if ( p->fewest_runs == p->runs )
    {
        snprintf( out, size, "%d", p->runs );
    }
    else
    {
        snprintf( out, size, "%d-%d", p->fewest_runs, p->runs );
    }
}

// ---- the short form ----

static bool is_reader( const wisp_plan_pass* p, const char* name )
{
    for ( int i = 0; i < p->reason_count; ++i )
    {
        if ( p->reasons[i].reader != NULL && strcmp( p->reasons[i].reader, name ) == 0 )
        {
            return true;
        }
    }
    return false;
}

// The reason why a pass is active: a request of the scene, or the next reader in plan order and the number of others.
static void short_reason( const wisp_plan_info* report, int pass, char* out, size_t size )
{
    const wisp_plan_pass* p = report->passes + pass;
    int readers = 0;
    const char* next = "nothing";
    for ( int i = 0; i < p->reason_count; ++i )
    {
        if ( p->reasons[i].reader == NULL )
        {
            snprintf( out, size, "requested by the scene" );
            return;
        }
    }
    for ( int step = report->active_count - 1; step > 0; --step )
    {
        const char* name = report->passes[( pass + step ) % report->active_count].name;
        const bool reads = is_reader( p, name );
        readers += reads ? 1 : 0;
        next = reads ? name : next;
    }
    const int others = readers - 1;
    snprintf( out, size, others > 0 ? "read by %s, %d more" : "read by %s", next, others );
}

static int name_width( const wisp_plan_info* report )
{
    int width = 4;
    for ( int i = 0; i < report->active_count; ++i )
    {
        const int length = (int)strlen( report->passes[i].name );
        width = length > width ? length : width;
    }
    return width;
}

static void print_short( FILE* out, const plan_sheet* sheet )
{
    const wisp_plan_info* report = sheet->report;
    const int width = name_width( report );
    if ( report->active_count == 0 )
    {
        fputs( "no active pass: the scene requests nothing\n", out );
        return;
    }
    fprintf( out, "%-8s %-*s entities  runs traffic%% time%%  why\n", "stage", width, "pass" );
    for ( int i = 0; i < report->active_count; ++i )
    {
        const wisp_plan_pass* p = report->passes + i;
        char reason[160], time[16] = "-", runs[32];
        short_reason( report, i, reason, sizeof( reason ) );
        if ( sheet->pass_seconds > 0.0 )
        {
            snprintf( time, sizeof( time ), "%.1f", 100.0 * plan_sheet_fraction( sheet, i ) );
        }
        runs_text( p, runs, sizeof( runs ) );
        fprintf( out, "%-8s %-*s %8d %5s %8.1f %5s  %s\n", p->stage, width, p->name, p->entities, runs,
                 100.0 * p->fraction, time, reason );
    }
}

// ---- the verbose form ----

static void print_list( FILE* out, const char* word, const char* const* names )
{
    for ( int i = 0; names[i] != NULL; ++i )
    {
        fprintf( out, "%s%s", i == 0 ? word : ", ", names[i] );
    }
}

static void print_uses( FILE* out, const wisp_plan_pass* p )
{
    fprintf( out, "      stage %s", p->stage );
    print_list( out, "; requires ", p->required );
    print_list( out, "; excludes ", p->excluded );
    print_list( out, "; reads ", p->reads );
    print_list( out, "; writes ", p->writes );
    print_list( out, "; of other entities ", p->foreign );
    fputc( '\n', out );
}

static void print_cost( FILE* out, const plan_sheet* sheet, int pass )
{
    const wisp_plan_pass* p = sheet->report->passes + pass;
    char runs[32];
    runs_text( p, runs, sizeof( runs ) );
    fprintf( out, "      %s run%s per step; %d entit%s, %d items (%s) in %d block%s; predicted %.1f %%", runs,
             p->runs == 1 ? "" : "s", p->entities, p->entities == 1 ? "y" : "ies", p->items, p->domain, p->blocks,
             p->blocks == 1 ? "" : "s", 100.0 * p->fraction );
    if ( sheet->pass_seconds > 0.0 )
    {
        fprintf( out, ", measured %.1f %%", 100.0 * plan_sheet_fraction( sheet, pass ) );
    }
    fputc( '\n', out );
}

static void print_verbose( FILE* out, const plan_sheet* sheet )
{
    char line[512];
    for ( int i = 0; i < sheet->report->pass_count; ++i )
    {
        wisp_plan_pass_text( sheet->report->passes + i, line, sizeof( line ) );
        fprintf( out, "%s\n", line );
        if ( sheet->report->passes[i].state == WISP_PLAN_ACTIVE )
        {
            print_uses( out, sheet->report->passes + i );
            print_cost( out, sheet, i );
        }
    }
}

// ---- both forms ----

static void print_modules( FILE* out, const wisp_plan_info* report, bool is_verbose )
{
    fputs( is_verbose ? "\nmodules\n" : "\nabsent modules\n", out );
    for ( int i = 0; i < report->module_count; ++i )
    {
        const wisp_plan_module* m = report->modules + i;
        if ( m->active_count == 0 )
        {
            fprintf( out, "  %-18s %s%s\n", m->name, is_verbose ? "absent: " : "", m->because );
        }
        else if ( is_verbose )
        {
            fprintf( out, "  %-18s %d of %d passes\n", m->name, m->active_count, m->pass_count );
        }
    }
}

static void print_steps( FILE* out, const plan_sheet* sheet )
{
    fputc( '\n', out );
    if ( sheet->steps == 0 )
    {
        fputs( "nothing was measured: --steps 0\n", out );
        return;
    }
    const double outside = sheet->dt - sheet->pass_seconds;
    fprintf( out, "measured on one worker: %d steps of %.4f ms, %.4f ms of each outside of passes\n", sheet->steps,
             1e3 * sheet->dt / sheet->steps, 1e3 * outside / sheet->steps );
    if ( sheet->plan_changes > 0 )
    {
        fprintf( out, "the plan changed %d time%s within these steps; shown is the plan of the start\n",
                 sheet->plan_changes, sheet->plan_changes == 1 ? "" : "s" );
    }
}

void plan_sheet_text( const plan_sheet* sheet, bool is_verbose, FILE* out )
{
    char line[512];
    wisp_plan_info_text( sheet->report, line, sizeof( line ) );
    fprintf( out, "%s\n\n", line );
    if ( is_verbose )
    {
        print_verbose( out, sheet );
    }
    else
    {
        print_short( out, sheet );
    }
    print_modules( out, sheet->report, is_verbose );
    print_steps( out, sheet );
}
