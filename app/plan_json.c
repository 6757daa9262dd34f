// The plan for programs; docs/outputs.md explains each key. Unknown numbers are null.
#include "plan_sheet.h"

#include <jansson.h>
#include <math.h>

static json_t* number( double value )
{
    return isfinite( value ) ? json_real( value ) : json_null();
}

static json_t* text( const char* value )
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
                                                 text( p->reasons[i].reader ) ) );
    }
    return array;
}

static json_t* place( const wisp_plan_pass* p )
{
    return p->state != WISP_PLAN_ACTIVE
               ? json_null()
               : json_pack( "{s:s, s:i, s:i, s:b, s:o, s:i, s:i, s:i, s:i, s:i, s:I}", "loop", p->loop, "wave",
                            p->wave, "node", p->node, "fused", p->is_fused, "fusion", text( p->fusion ), "entities",
                            p->entities, "items", p->items, "blocks", p->blocks, "runs", p->runs, "fewest_runs",
                            p->fewest_runs, "bytes", (json_int_t)p->bytes );
}

static json_t* pass_object( const plan_sheet* sheet, int i )
{
    static const char* const STATES[] = { "missing", "split", "excluded", "unrequested", "active" };
    const wisp_plan_pass* p = sheet->report->passes + i;
    const double fraction = plan_sheet_fraction( sheet, i );
    return json_pack( "{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:o}", "name",
                      p->name, "module", p->module, "state", STATES[p->state], "stage", p->stage, "domain", p->domain,
                      "place", place( p ), "requires", list( p->required ), "excludes", list( p->excluded ), "reads",
                      list( p->reads ), "writes", list( p->writes ), "foreign", list( p->foreign ), "missing",
                      list( p->missing ), "reasons", reasons( p ), "because", p->because, "predicted_fraction",
                      number( p->fraction ), "measured_fraction", number( fraction ), "measured_ms_per_step",
                      number( isfinite( fraction ) ? 1e3 * sheet->seconds[i] / sheet->steps : (double)NAN ) );
}

static json_t* modules( const wisp_plan_info* report )
{
    json_t* array = json_array();
    for ( int i = 0; i < report->module_count; ++i )
    {
        const wisp_plan_module* m = report->modules + i;
        json_array_append_new( array, json_pack( "{s:s, s:b, s:i, s:i, s:o, s:o}", "name", m->name, "present",
                                                 m->active_count > 0, "passes", m->pass_count, "active",
                                                 m->active_count, "missing", text( m->missing ), "because",
                                                 text( m->active_count > 0 ? NULL : m->because ) ) );
    }
    return array;
}

static json_t* measured( const plan_sheet* sheet )
{
    const double steps = sheet->steps;
    return sheet->steps == 0
               ? json_null()
               : json_pack( "{s:i, s:i, s:o, s:o, s:i}", "steps", sheet->steps, "workers", 1, "ms_per_step",
                            number( 1e3 * sheet->dt / steps ), "ms_per_step_in_passes",
                            number( 1e3 * sheet->pass_seconds / steps ), "plan_changes", sheet->plan_changes );
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
