// The plan for people: the engine's line of a pass, and below it what the pass works on and what that costs.
#include "plan_sheet.h"

static void print_list( FILE* out, const char* word, const char* const* names )
{
    for ( int i = 0; names[i] != NULL; ++i )
    {
        fprintf( out, "%s%s", i == 0 ? word : ", ", names[i] );
    }
}

static void print_uses( FILE* out, const wisp_plan_pass* p )
{
    fprintf( out, "      stage %s;", p->stage );
    print_list( out, " needs ", p->needs );
    print_list( out, p->needs[0] != NULL ? "; lacks " : " lacks ", p->lacks );
    print_list( out, p->needs[0] != NULL || p->lacks[0] != NULL ? "; reads " : " reads ", p->reads );
    print_list( out, p->reads[0] != NULL ? "; writes " : " writes ", p->writes );
    print_list( out, "; of others ", p->across );
    fputc( '\n', out );
}

static void print_cost( FILE* out, const plan_sheet* sheet, int pass )
{
    const wisp_plan_pass* p = sheet->report->passes + pass;
    fprintf( out, "      %d x a step; entities %d, items (%s) %d, blocks %d; predicted %.1f %%", p->runs, p->entities,
             p->domain, p->items, p->blocks, 100.0 * p->share );
    if ( sheet->pass_seconds > 0.0 )
    {
        fprintf( out, ", measured %.1f %%", 100.0 * plan_sheet_share( sheet, pass ) );
    }
    fputc( '\n', out );
}

static void print_modules( FILE* out, const wisp_plan_report* report )
{
    fputs( "modules\n", out );
    for ( int i = 0; i < report->module_count; ++i )
    {
        const wisp_plan_module* m = report->modules + i;
        if ( m->kept_count > 0 )
        {
            fprintf( out, "  %-19s %d of %d passes\n", m->name, m->kept_count, m->pass_count );
        }
        else
        {
            fprintf( out, "  %-19s absent from the plan: %s\n", m->name, m->because );
        }
    }
}

static void print_steps( FILE* out, const plan_sheet* sheet )
{
    if ( sheet->steps == 0 )
    {
        fputs( "nothing is measured: no step was made\n", out );
        return;
    }
    const double outside = sheet->step_seconds - sheet->pass_seconds;
    fprintf( out, "measured on one worker: %d steps of %.4f ms, of which %.4f ms are not in a pass\n", sheet->steps,
             1e3 * sheet->step_seconds / sheet->steps, 1e3 * outside / sheet->steps );
    if ( sheet->plan_changes > 0 )
    {
        fprintf( out, "the plan changed %d times within these steps; what is told is that of the start\n",
                 sheet->plan_changes );
    }
}

void plan_sheet_text( const plan_sheet* sheet, FILE* out )
{
    char line[512];
    wisp_plan_report_text( sheet->report, line, sizeof( line ) );
    fprintf( out, "%s\n", line );
    for ( int i = 0; i < sheet->report->pass_count; ++i )
    {
        wisp_plan_pass_text( sheet->report->passes + i, line, sizeof( line ) );
        fprintf( out, "%s\n", line );
        if ( sheet->report->passes[i].state == WISP_PLAN_KEPT )
        {
            print_uses( out, sheet->report->passes + i );
            print_cost( out, sheet, i );
        }
    }
    print_modules( out, sheet->report );
    print_steps( out, sheet );
}
