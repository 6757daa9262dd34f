#include "plan_sheet.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_pass_times( plan_sheet* sheet, wisp_profile profile )
{
    sheet->dt += profile.seconds;
    for ( int i = 0; i < profile.count; ++i )
    {
        sheet->pass_seconds += profile.lines[i].seconds;
        for ( int k = 0; k < sheet->report->active_count; ++k )
        {
            const bool is_it = strcmp( sheet->report->passes[k].name, profile.lines[i].pass ) == 0;
            sheet->seconds[k] += is_it ? profile.lines[i].seconds : 0.0;
        }
    }
}

wisp_status plan_sheet_make( scene_world* world, int steps, plan_sheet* sheet, wisp_error* error )
{
    *sheet = ( plan_sheet ){ .scene = world->scene->name, .world = world };
    wisp_status status = wisp_world_explain( world->world, &sheet->report );
    if ( status != WISP_OK )
    {
        return wisp_fail( error, status, "%s: %s", sheet->scene, wisp_world_message( world->world ) );
    }
    sheet->seconds = calloc( (size_t)sheet->report->pass_count + 1, sizeof( double ) );
    if ( sheet->seconds == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "plan: out of memory for the times of the passes" );
    }
    const uint64_t plans = wisp_world_counter( world->world, WISP_COUNT_PLANS );
    while ( sheet->steps < steps && status == WISP_OK )
    {
        status = scene_world_step( world, error );
        if ( status == WISP_OK )
        {
            sheet->steps += 1;
            add_pass_times( sheet, wisp_world_profile( world->world ) );
        }
    }
    sheet->plan_changes = (int)( wisp_world_counter( world->world, WISP_COUNT_PLANS ) - plans );
    return status;
}

void plan_sheet_release( plan_sheet* sheet )
{
    wisp_plan_info_release( sheet->report );
    free( sheet->seconds );
    *sheet = ( plan_sheet ){ 0 };
}

// Fraction of a pass in the time of all passes, in [0, 1]; NaN if nothing was measured.
static double fraction_of_pass( const plan_sheet* sheet, int pass )
{
    return pass < sheet->report->active_count && sheet->pass_seconds > 0.0
               ? sheet->seconds[pass] / sheet->pass_seconds
               : (double)NAN;
}

// ---- text ----

// The plan for readers. The short form has one line per active pass and one per absent module; the verbose form adds
// the columns and cost of each pass, and every absent pass.

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
            snprintf( time, sizeof( time ), "%.1f", 100.0 * fraction_of_pass( sheet, i ) );
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
        fprintf( out, ", measured %.1f %%", 100.0 * fraction_of_pass( sheet, pass ) );
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
    for ( int i = 0; i < sheet->world->note_count; ++i )
    {
        fprintf( out, "note: %s\n", sheet->world->notes[i] );
    }
}

// ---- a graph ----

// The plan as a graph for Graphviz: a cluster per loop, in it a cluster per stage, and an edge from the last writer of a
// component to each reader. Values of the previous iteration or step have dashed edges.

// A quoted string of the DOT language, in which only the quote and the backslash are special.
static void print_escaped( FILE* out, const char* text )
{
    for ( ; *text; ++text )
    {
        if ( *text == '"' || *text == '\\' )
        {
            fputc( '\\', out );
        }
        fputc( *text == '\n' ? ' ' : *text, out );
    }
}

static void print_quoted( FILE* out, const char* text )
{
    fputc( '"', out );
    print_escaped( out, text );
    fputc( '"', out );
}

static void print_node( FILE* out, const plan_sheet* sheet, int pass )
{
    const wisp_plan_pass* p = sheet->report->passes + pass;
    fputs( "      ", out );
    print_quoted( out, p->name );
    fputs( " [label=\"", out );
    print_escaped( out, p->name );
    fprintf( out, "\\nwave %d%s%s%s, %d x %s in %d blocks\\npredicted %.1f %%", p->wave, p->is_fused ? ", fused" : "",
             p->fusion != NULL ? ", in " : "", p->fusion != NULL ? p->fusion : "", p->items, p->domain, p->blocks,
             100.0 * p->fraction );
    if ( sheet->pass_seconds > 0.0 )
    {
        fprintf( out, ", measured %.1f %%", 100.0 * fraction_of_pass( sheet, pass ) );
    }
    fputs( "\", tooltip=", out );
    print_quoted( out, p->because );
    fputs( "];\n", out );
}

// The passes of one stage in one loop. @return their number
static void print_stage( FILE* out, const plan_sheet* sheet, const char* loop, const char* stage, int* cluster )
{
    bool is_open = false;
    for ( int i = 0; i < sheet->report->active_count; ++i )
    {
        const wisp_plan_pass* p = sheet->report->passes + i;
        if ( strcmp( p->loop, loop ) != 0 || strcmp( p->stage, stage ) != 0 )
        {
            continue;
        }
        if ( is_open == false )
        {
            fprintf( out, "    subgraph cluster_%d {\n      label=\"%s\";\n", ( *cluster )++, stage );
            is_open = true;
        }
        print_node( out, sheet, i );
    }
    fputs( is_open ? "    }\n" : "", out );
}

// Passes are in the order of the plan, so those of a loop are neighbours.
static void print_loops( FILE* out, const plan_sheet* sheet )
{
    const wisp_plan_info* report = sheet->report;
    int cluster = 0;
    for ( int i = 0; i < report->active_count; ++i )
    {
        const char* loop = report->passes[i].loop;
        if ( i > 0 && strcmp( report->passes[i - 1].loop, loop ) == 0 )
        {
            continue;
        }
        fprintf( out, "  subgraph cluster_%d {\n    label=\"%s\";\n", cluster++, loop );
        for ( int k = i; k < report->active_count && strcmp( report->passes[k].loop, loop ) == 0; ++k )
        {
            bool is_first = true;
            for ( int before = i; before < k; ++before )
            {
                is_first = is_first && strcmp( report->passes[before].stage, report->passes[k].stage ) != 0;
            }
            if ( is_first )
            {
                print_stage( out, sheet, loop, report->passes[k].stage, &cluster );
            }
        }
        fputs( "  }\n", out );
    }
}

static bool lists( const char* const* names, const char* name )
{
    for ( int i = 0; names[i] != NULL; ++i )
    {
        if ( strcmp( names[i], name ) == 0 )
        {
            return true;
        }
    }
    return false;
}

// Find the writer of what a pass reads: the last one before it, else the last of all. @return -1: the scene supplies it
static int writer_of( const wisp_plan_info* report, int reader, const char* component )
{
    for ( int step = 1; step < report->active_count; ++step )
    {
        const int at = ( reader - step + report->active_count ) % report->active_count;
        const wisp_plan_pass* p = report->passes + at;
        if ( lists( p->writes, component ) || lists( p->foreign, component ) )
        {
            return at;
        }
    }
    return -1;
}

// One edge for all components that lead from one pass to another.
static void print_edge( FILE* out, const wisp_plan_info* report, int writer, int reader )
{
    const wisp_plan_pass* to = report->passes + reader;
    const char* separator = "";
    for ( int i = 0; to->reads[i] != NULL; ++i )
    {
        if ( writer_of( report, reader, to->reads[i] ) != writer )
        {
            continue;
        }
        if ( *separator == '\0' )
        {
            fputs( "  ", out );
            print_quoted( out, report->passes[writer].name );
            fputs( " -> ", out );
            print_quoted( out, to->name );
            fputs( " [label=\"", out );
        }
        fputs( separator, out );
        print_escaped( out, to->reads[i] );
        separator = "\\n";
    }
    if ( *separator != '\0' )
    {
        fputs( writer > reader ? "\", style=dashed, constraint=false];\n" : "\"];\n", out );
    }
}

static void print_absent( FILE* out, const wisp_plan_info* report )
{
    for ( int i = 0; i < report->module_count; ++i )
    {
        const wisp_plan_module* m = report->modules + i;
        if ( m->active_count == 0 )
        {
            fprintf( out, "  absent_%d [shape=note, style=dashed, label=\"", i );
            print_escaped( out, m->name );
            fputs( "\\n", out );
            print_escaped( out, m->because );
            fputs( "\"];\n", out );
        }
    }
}

void plan_sheet_dot( const plan_sheet* sheet, FILE* out )
{
    char title[256];
    wisp_plan_info_text( sheet->report, title, sizeof( title ) );
    fputs( "digraph wisp_plan {\n  graph [labelloc=t, fontname=\"sans-serif\", label=\"", out );
    print_escaped( out, sheet->scene );
    fputs( "\\n", out );
    print_escaped( out, title );
    fputs( "\"];\n  node [shape=box, fontname=\"sans-serif\"];\n  edge [fontname=\"sans-serif\", fontsize=10];\n",
           out );
    print_loops( out, sheet );
    for ( int reader = 0; reader < sheet->report->active_count; ++reader )
    {
        for ( int writer = 0; writer < sheet->report->active_count; ++writer )
        {
            print_edge( out, sheet->report, writer, reader );
        }
    }
    print_absent( out, sheet->report );
    fputs( "}\n", out );
}

// ---- JSON ----

// The plan for programs; docs/outputs.md explains each key. Unknown numbers are null.

static json_t* number_or_null( double value )
{
    return isfinite( value ) ? json_real( value ) : json_null();
}

static json_t* text_or_null( const char* value )
{
    return value != NULL ? json_string( value ) : json_null();
}

static json_t* list( const char* const* names )
{
    json_t* array = json_array();
    for ( int i = 0; names[i] != NULL; ++i )
    {
        json_array_append_new( array, json_string( names[i] ) );
    }
    return array;
}

static json_t* reasons( const wisp_plan_pass* p )
{
    json_t* array = json_array();
    for ( int i = 0; i < p->reason_count; ++i )
    {
        json_array_append_new( array, json_pack( "{s:s, s:o}", "component", p->reasons[i].component, "reader",
                                                 text_or_null( p->reasons[i].reader ) ) );
    }
    return array;
}

static json_t* json_of_place( const wisp_plan_pass* p )
{
    return p->state != WISP_PLAN_ACTIVE
               ? json_null()
               : json_pack( "{s:s, s:i, s:i, s:b, s:o, s:i, s:i, s:i, s:i, s:i, s:I}", "loop", p->loop, "wave",
                            p->wave, "node", p->node, "fused", p->is_fused, "fusion", text_or_null( p->fusion ),
                            "entities", p->entities, "items", p->items, "blocks", p->blocks, "runs", p->runs,
                            "fewest_runs", p->fewest_runs, "bytes", (json_int_t)p->bytes );
}

static json_t* pass_object( const plan_sheet* sheet, int i )
{
    static const char* const STATES[] = { "missing", "split", "excluded", "unrequested", "active" };
    const wisp_plan_pass* p = sheet->report->passes + i;
    const double fraction = fraction_of_pass( sheet, i );
    return json_pack( "{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:o}", "name",
                      p->name, "module", p->module, "state", STATES[p->state], "stage", p->stage, "domain", p->domain,
                      "place", json_of_place( p ), "requires", list( p->required ), "excludes", list( p->excluded ),
                      "reads", list( p->reads ), "writes", list( p->writes ), "foreign", list( p->foreign ),
                      "missing", list( p->missing ), "reasons", reasons( p ), "because", p->because,
                      "predicted_fraction", number_or_null( p->fraction ), "measured_fraction",
                      number_or_null( fraction ), "measured_ms_per_step",
                      number_or_null( isfinite( fraction ) ? 1e3 * sheet->seconds[i] / sheet->steps : (double)NAN ) );
}

static json_t* modules( const wisp_plan_info* report )
{
    json_t* array = json_array();
    for ( int i = 0; i < report->module_count; ++i )
    {
        const wisp_plan_module* m = report->modules + i;
        json_array_append_new( array, json_pack( "{s:s, s:b, s:i, s:i, s:o, s:o}", "name", m->name, "present",
                                                 m->active_count > 0, "passes", m->pass_count, "active",
                                                 m->active_count, "missing", text_or_null( m->missing ), "because",
                                                 text_or_null( m->active_count > 0 ? NULL : m->because ) ) );
    }
    return array;
}

static json_t* measured( const plan_sheet* sheet )
{
    const double steps = sheet->steps;
    return sheet->steps == 0
               ? json_null()
               : json_pack( "{s:i, s:i, s:o, s:o, s:i}", "steps", sheet->steps, "workers", 1, "ms_per_step",
                            number_or_null( 1e3 * sheet->dt / steps ), "ms_per_step_in_passes",
                            number_or_null( 1e3 * sheet->pass_seconds / steps ), "plan_changes",
                            sheet->plan_changes );
}

bool plan_sheet_json( const plan_sheet* sheet, FILE* out )
{
    const wisp_plan_info* report = sheet->report;
    char hash[24];
    snprintf( hash, sizeof( hash ), "%016llx", (unsigned long long)report->hash );
    json_t* passes = json_array();
    for ( int i = 0; i < report->pass_count; ++i )
    {
        json_array_append_new( passes, pass_object( sheet, i ) );
    }
    json_t* root =
        json_pack( "{s:i, s:s, s:s, s:i, s:i, s:i, s:i, s:i, s:o, s:o, s:o}", "wisp_plan", 2, "scene", sheet->scene,
                   "hash", hash, "active", report->active_count, "nodes", report->node_count, "waves",
                   report->wave_count, "substeps", report->substeps, "iterations", report->iterations, "passes",
                   passes, "modules", modules( report ), "measured", measured( sheet ) );
    char* written = root != NULL ? json_dumps( root, JSON_INDENT( 2 ) ) : NULL;
    if ( written != NULL )
    {
        fprintf( out, "%s\n", written );
    }
    free( written );
    json_decref( root );
    return written != NULL;
}
