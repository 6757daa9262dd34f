// The plan as a graph for Graphviz: a cluster per loop, in it a cluster per stage, and an edge from the last writer of a
// component to each reader. Values of the previous iteration or step have dashed edges.
#include "plan_sheet.h"

#include <string.h>

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
        fprintf( out, ", measured %.1f %%", 100.0 * plan_sheet_fraction( sheet, pass ) );
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
