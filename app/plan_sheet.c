#include "plan_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_times( plan_sheet* sheet, wisp_profile profile )
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
    *sheet = ( plan_sheet ){ .scene = world->scene->name };
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
            add_times( sheet, wisp_world_profile( world->world ) );
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

double plan_sheet_fraction( const plan_sheet* sheet, int pass )
{
    return pass < sheet->report->active_count && sheet->pass_seconds > 0.0
               ? sheet->seconds[pass] / sheet->pass_seconds
               : (double)NAN;
}
