#include "tune_scene.h"

#include "io_file.h"
#include "stats.h"

#include <stdlib.h>
#include <string.h>

// ---- the reference ----

wisp_status tune_scene_open( const tune_scene_def* def, tune_scene* out, wisp_error* error )
{
    *out = ( tune_scene ){ .def = *def };
    const suite_of_scene_def suite = { .path = def->path,
                                       .file = io_file_name( def->path ),
                                       .length = def->length,
                                       .given = &out->def.given,
                                       .log = def->log,
                                       .log_user = def->log_user };
    char* text = NULL;
    wisp_status status = suite_of_scene( &suite, &text, error );
    status = status == WISP_OK ? suite_parse( text, strlen( text ), def->path, &out->def.given, &out->suite, error )
                               : status;
    free( text );
    status = status == WISP_OK ? suite_references_find( &out->suite, &out->references, error ) : status;
    out->references.observer = def->observer;
    return status == WISP_OK ? suite_reference_of( &out->references, 0, &out->reference, error ) : status;
}

void tune_scene_close( tune_scene* scene )
{
    suite_references_release( &scene->references );
    suite_release( &scene->suite );
}

// ---- a run ----

wisp_status tune_scene_run( const tune_scene* scene, const suite_given* given, const tune_machine* machine,
                            suite_measurement* measured, tune_sample* out, wisp_error* error )
{
    const suite_observer* observer = scene->def.observer;
    suite_row row;
    int steps = 0;
    double* ms = NULL;
    uint64_t hash;
    wisp_status status = suite_row_of( scene->suite.rows, given, &row, error );
    if ( status == WISP_OK && measured->steps == 0 )
    {
        status = suite_reference_run( scene->reference, &row, machine->isa, observer, measured, error );
    }
    status = status == WISP_OK
                 ? suite_time_row( &row, machine->workers, machine->isa, observer, &ms, &steps, &hash, error )
                 : status;
    *out = ( tune_sample ){ .ms = stats_summarise( ms, status == WISP_OK ? steps : 0 ).median,
                            .error = measured->values[SUITE_ERROR],
                            .largest = measured->compared.largest,
                            .is_halted = measured->values[SUITE_HALTED] > 0.0 };
    free( ms );
    free( row.text );
    return status;
}

// ---- the search ----

typedef struct scene_search
{
    const tune_scene* scene;
    const tune_scene_search_def* def;
    suite_measurement* all; // [TUNE_MAX_SETTINGS] runs of a configuration again repeat its time alone
    suite_measurement* last;
} scene_search;

static wisp_status run_configuration( void* user, const int* configuration, tune_sample* out, wisp_error* error )
{
    const scene_search* s = user;
    const tune_scene_def* from = &s->scene->def;
    const tune_parameters* parameters = s->def->parameters;
    char* text;
    suite_given edited = from->given;
    int place = 0;
    wisp_status status = tune_parameters_edit( parameters, configuration, s->def->scene, from->given.text,
                                               from->given.size, &text, &edited.size, error );
    edited.text = text;
    for ( int k = 0; k < parameters->count; ++k )
    {
        place = place * parameters->parameters[k].value_count + configuration[k];
    }
    status = status == WISP_OK ? tune_scene_run( s->scene, &edited, &s->def->machine, s->all + place, out, error )
                               : status;
    *s->last = s->all[place];
    free( text );
    return status;
}

wisp_status tune_scene_search( const tune_scene* scene, const tune_scene_search_def* def, suite_measurement* measured,
                               tune_result* out, wisp_error* error )
{
    scene_search s = { .scene = scene, .def = def, .last = measured };
    s.all = calloc( TUNE_MAX_SETTINGS, sizeof *s.all );
    tune_def job = { .repeats = 3 };
    job.parameters = def->parameters->parameters, job.parameter_count = def->parameters->count;
    job.error = def->error, job.budget_ms = def->budget_ms;
    job.max_runs = 200, job.max_seconds = def->limit;
    job.run = run_configuration, job.user = &s;
    job.progress = def->progress, job.progress_user = def->progress_user;
    const wisp_status status =
        s.all ? tune_find( &job, out, error )
              : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the search", scene->def.path );
    free( s.all );
    return status;
}
