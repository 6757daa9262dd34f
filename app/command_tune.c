#include "commands.h"

#include "interruption.h"
#include "io_file.h"
#include "progress.h"
#include "results.h"
#include "tune_scene.h"

#include "wisp/module/definition.h"

#include <stdlib.h>
#include <string.h>

#define DEFAULT_LIMIT 300.0

// What is asked, and what of it is known.
typedef struct search
{
    tune_scene_def from;
    unsigned char* bytes; // that its text is in
    tune_scene scene;
    tune_scene_search_def def;
    suite_measurement measured; // of a run
    progress bar;
} search;

// ---- the report ----

// A row and a line per setting, the reference, the verdict.

static bool is_chosen( const tune_parameters* parameters, const tune_result* found, const tune_trial* trial )
{
    return memcmp( trial->configuration, found->configuration, (size_t)parameters->count * sizeof( int ) ) == 0;
}

static void name_setting( const tune_parameters* parameters, const int* configuration, char* out, size_t size )
{
    out[0] = '\0';
    for ( int k = 0; k < parameters->count; ++k )
    {
        char value[32];
        tune_parameters_text( parameters->fields[k], parameters->values[k][configuration[k]], value, sizeof value );
        const size_t length = strlen( out );
        snprintf( out + length, size - length, "%s%s: %s", k > 0 ? ", " : "", parameters->parameters[k].name, value );
    }
}

static void add_visit_row( results* out, const search* s, const tune_result* found, const tune_trial* trial )
{
    const tune_parameters* parameters = s->def.parameters;
    results_row* row = results_add_row( out, io_file_name( s->from.path ),
                                        is_chosen( parameters, found, trial ) ? "chosen" : "trial" );
    if ( !row )
    {
        return;
    }
    results_put( &row->size, "vertices", s->measured.vertices );
    for ( int k = 0; k < parameters->count; ++k )
    {
        results_put( &row->size, parameters->parameters[k].name, parameters->values[k][trial->configuration[k]] );
    }
    results_put( &row->size, "is_pareto", trial->is_pareto ? 1.0 : 0.0 );
    results_put( &row->size, "halted", trial->sample.is_halted ? 1.0 : 0.0 );
    row->workers = s->def.machine.workers;
    row->ms_median = trial->sample.ms;
    row->steps = s->measured.steps * trial->run_count;
    if ( !trial->sample.is_halted )
    {
        snprintf( row->error_reference, sizeof row->error_reference, "%s", s->scene.references.description );
        results_put( &row->error, "rms_m", trial->sample.error );
        results_put( &row->error, "largest_m", trial->sample.largest );
    }
}

static void add_visit_line( results* out, int table, const tune_parameters* parameters, const tune_result* found,
                            const tune_trial* trial )
{
    const tune_sample* sample = &trial->sample;
    results_cells cells = { .count = 0 };
    for ( int k = 0; k < parameters->count; ++k )
    {
        char value[32];
        tune_parameters_text( parameters->fields[k], parameters->values[k][trial->configuration[k]], value,
                              sizeof value );
        cells_put( &cells, "%s", value );
    }
    cells_put( &cells, sample->is_halted ? "%.4f\t-\t-" : "%.4f\t%.3e\t%.3e", sample->ms, sample->error,
               sample->largest );
    cells_put( &cells, "%s",
               is_chosen( parameters, found, trial ) ? "chosen"
               : sample->is_halted                   ? "halted"
               : trial->is_pareto                    ? "Pareto"
                                                     : "" );
    cells_end_row( &cells, table, out );
}

static int compare_visits( const void* a, const void* b )
{
    const tune_trial *x = a, *y = b;
    return ( x->sample.ms > y->sample.ms ) - ( x->sample.ms < y->sample.ms );
}

static void add_table( results* out, const tune_parameters* parameters, const tune_result* found )
{
    results_cells header = { .count = 0 };
    for ( int k = 0; k < parameters->count; ++k )
    {
        cells_put( &header, "%s", parameters->parameters[k].name );
    }
    cells_put( &header, "ms per step\terror (m)\tmax error (m)\tverdict" );
    const int table = cells_begin_table( &header, "Configurations, fastest first", out );
    for ( int v = 0; v < found->trial_count; ++v )
    {
        add_visit_line( out, table, parameters, found, &found->trials[v] );
    }
}

static void add_verdict( results* out, int table, const search* s, const tune_result* found )
{
    const suite_reference* reference = s->scene.reference;
    const tune_sample* achieved = &found->achieved;
    char setting[240], until[100];
    suite_horizon horizon = { 0 };
    suite_horizon_add( &horizon, reference->until, suite_reference_parts( reference ) );
    suite_horizon_text( &horizon, until, sizeof until );
    name_setting( s->def.parameters, found->configuration, setting, sizeof setting );
    results_add_line(
        out, table, s->def.error > 0.0 ? "target\t%s: error at most %g m%s" : "target\t%s: at most %g ms per step%s",
        found->meets_target ? "met" : "not met", s->def.error > 0.0 ? s->def.error : s->def.budget_ms, until );
    if ( achieved->is_halted )
    {
        results_add_line( out, table, "nearest\tnone: every configuration became unstable" );
    }
    else
    {
        results_add_line( out, table, "%s\t%s", found->meets_target ? "chosen" : "nearest", setting );
        results_add_line( out, table, "reached\t%.4f ms per step, error %.3e m, maximum %.3e m", achieved->ms,
                          achieved->error, achieved->largest );
    }
    results_add_line( out, table, "search\t%d run%s of %d configuration%s in %.1f s%s", found->run_count,
                      found->run_count == 1 ? "" : "s", found->trial_count, found->trial_count == 1 ? "" : "s",
                      found->seconds,
                      found->stopped_early ? "; stopped early by a limit, better ones may exist" : "" );
    results_add_line( out, table, "reference\t%s; uncertain by %.3g mm", s->scene.references.description,
                      1e3 * reference->doubt.distance );
    results_add_line( out, table, "error\troot mean square distance over %d vertices and %d times up to %.3g s",
                      s->measured.vertices, reference->frame_count, reference->until );
}

// @param found its visits are sorted by time
static void report_tuning( results* out, const search* s, tune_result* found )
{
    out->machine = machine_describe( s->measured.isa );
    out->is_result_first = true;
    qsort( found->trials, (size_t)found->trial_count, sizeof *found->trials, compare_visits );
    for ( int v = 0; v < found->trial_count; ++v )
    {
        add_visit_row( out, s, found, &found->trials[v] );
    }
    add_verdict( out, results_add_table( out, "", 2, ( const char* const[] ){ "", "" } ), s, found );
    add_table( out, s->def.parameters, found );
}

// ---- the command ----

typedef struct tune_options
{
    const char* scene;
    search search;
    results_format format;
    const char* output; ///< path of the tuned scene, or null
} tune_options;

// ---- the command line ----

static const option_row tune_rows[] = {
    OPTION_TITLE( "Target, one of:" ),
    { "error", 'e', "METRES", "Cheapest configuration with at most this error",
      OPTION_NUMBER( tune_options, search.def.error, 1e6 ) },
    { "budget", 'b', "MS", "Most accurate configuration within MS ms per step",
      OPTION_NUMBER( tune_options, search.def.budget_ms, 1e6 ) },
    OPTION_TITLE( "Search:" ),
    { "length", 0, "S", "Compare S seconds of motion; default: the scene, at most 1",
      OPTION_NUMBER( tune_options, search.from.length, 1e6 ) },
    { "limit", 0, "SECONDS", "Start no run after this time, default 300",
      OPTION_NUMBER( tune_options, search.def.limit, 1e9 ) },
    { "workers", 'w', "N", "Use N workers, 1 to 64; default: the scene's, or one per core",
      OPTION_WHOLE( tune_options, search.def.machine.workers, 1, WISP_MAX_WORKERS ) },
    OPTION_TITLE( "Output:" ),
    OPTION_RESULTS_FORMAT( tune_options, format ),
    { "output", 'o', "FILE", "Write the tuned scene to FILE; default: not written",
      OPTION_TEXT( tune_options, output, ".yaml" ) },
};

const command_text tune_text = {
    .name = "tune",
    .operands = "SCENE",
    .noun = "scene",
    .summary = "find the cheapest configuration within an error or time",
    .about = "Find the cheapest configuration of a scene within an error, or the most accurate\n"
             "one within a time.",
    .notes = "Tuned are, as far as the scene uses them: substeps and iterations; tethers of cloth\n"
             "and substeps of its coarse sheets; tolerance and Newton iterations of implicit cloth;\n"
             "stretch passes of strands. Configurations are timed on this machine, which should be\n"
             "idle.\n"
             "\n"
             "The error is that of 'wisp accuracy': a root mean square distance in metres from the\n"
             "same converged run, over all vertices and as long as two such runs do not part.\n"
             "\n"
             "--output writes the scene with the changed keys, and everything else as it was, if\n"
             "the target is met.",
    .examples = "wisp tune data/scenes/hanging_cloth.yaml --error 0.005\n"
                "wisp tune data/scenes/hanging_cloth.yaml --budget 2 -o data/scenes/tuned.yaml",
    .unmet = "no configuration meets the target",
    .rows = tune_rows,
    .row_count = WISP_COUNT( tune_rows ),
    .values = OPTION_INPUT( OPTION_TO_INPUT, tune_options, scene, ".yaml .yml .json" ),
};

static void check_tune_options( const options_state* o )
{
    const tune_options* options = o->input;
    if ( ( options->search.def.error > 0.0 ) == ( options->search.def.budget_ms > 0.0 ) )
    {
        options_fail( o, "expected one of --error and --budget" );
    }
}

// ---- the scene's file ----

static wisp_status count_file( void* user, const char* file, wisp_error* error )
{
    (void)file, (void)error;
    *(int*)user += 1;
    return WISP_OK;
}

static bool reads_files( const wisp_scene* scene )
{
    int count = 0;
    (void)wisp_scene_files( scene, count_file, &count, NULL );
    return count > 0;
}

// Fails before the search, which takes minutes, if the result could not be written. Every value of every parameter
// occurs in one of the tested configurations.
static wisp_status check_output( const tune_options* options, const tune_parameters* parameters,
                                 const wisp_scene* scene, wisp_error* error )
{
    const size_t length = io_folder_length( options->scene );
    if ( reads_files( scene ) && ( length != io_folder_length( options->output ) ||
                                   strncmp( options->scene, options->output, length ) != 0 ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: reads files of its folder, so the tuned scene %s must be in the same folder",
                          options->scene, options->output );
    }
    for ( int value = 0; value < TUNE_MAX_VALUES; ++value )
    {
        int configuration[TUNE_MAX_PARAMETERS], longest = 0;
        for ( int k = 0; k < parameters->count; ++k )
        {
            const int last = parameters->parameters[k].value_count - 1;
            configuration[k] = value < last ? value : last;
            longest = last > longest ? last : longest;
        }
        WISP_TRY( value <= longest
                      ? tune_parameters_write( parameters, configuration, scene, options->scene, NULL, error )
                      : WISP_OK );
    }
    return WISP_OK;
}

// Writes the scene and reads it again: the file must hold the chosen configuration.
static wisp_status write_scene( const tune_options* options, const tune_parameters* parameters,
                                const int* configuration, const wisp_scene* scene, wisp_error* error )
{
    wisp_status status =
        tune_parameters_write( parameters, configuration, scene, options->scene, options->output, error );
    wisp_scene written;
    if ( io_is_standard( options->output ) )
    {
        return status;
    }
    status = status == WISP_OK ? wisp_scene_read( options->output, &written, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( !tune_parameters_agree( parameters, configuration, &written ) )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: the written scene differs from the chosen configuration",
                            options->output );
    }
    wisp_scene_release( &written );
    return status;
}

// ---- the command ----

static bool show( void* user, int run_count, int max_runs )
{
    progress_show( user, (double)run_count / max_runs, "of the runs allowed" );
    return !interruption_came();
}

static wisp_status run_search( search* s, tune_result* out, wisp_error* error )
{
    s->def.progress = show, s->def.progress_user = &s->bar;
    progress_show( &s->bar, 0.0, "the reference" );
    const wisp_status status = tune_scene_open( &s->from, &s->scene, error );
    return status == WISP_OK ? tune_scene_search( &s->scene, &s->def, &s->measured, out, error ) : status;
}

static wisp_status tune( tune_options* options, results* out, bool* meets_target, wisp_error* error )
{
    tune_result found = { 0 };
    search* s = &options->search;
    const wisp_scene* scene = s->def.scene;
    const tune_parameters* parameters = s->def.parameters;
    WISP_TRY( options->output ? check_output( options, parameters, scene, error ) : WISP_OK );
    WISP_TRY( command_check_writable( options->output, error ) );
    s->bar = progress_begin();
    wisp_status status = run_search( s, &found, error );
    progress_end( &s->bar );
    if ( status == WISP_OK )
    {
        *meets_target = found.meets_target;
        report_tuning( out, s, &found );
        if ( interruption_came() )
        {
            results_add_note( out, "interrupted after %d runs: a better configuration may exist", found.run_count );
        }
    }
    if ( status == WISP_OK && options->output && found.meets_target )
    {
        status = write_scene( options, parameters, found.configuration, scene, error );
        results_add_note( out, "written: %s", options->output );
    }
    else if ( status == WISP_OK && options->output )
    {
        results_add_note( out, "not written: %s", options->output );
    }
    tune_release( &found );
    return status;
}

int command_tune( int argc, char** argv )
{
    tune_options options = { .search = { .def = { .limit = DEFAULT_LIMIT } } };
    search* s = &options.search;
    options_parse( &tune_text, check_tune_options, &options, argc, argv );
    wisp_error error = { 0 };
    wisp_scene scene = { 0 };
    wisp_status status = io_file_read( options.scene, 1 << 20, &s->bytes, &s->from.given.size, &error );
    s->from.path = options.scene;
    s->from.given.text = s->bytes ? (const char*)s->bytes : "";
    status = status == WISP_OK
                 ? wisp_scene_parse( s->from.given.text, s->from.given.size, s->from.path, &scene, &error )
                 : status;
    interruption_begin(); // before that there is nothing to keep
    tune_parameters parameters;
    status = status == WISP_OK ? tune_parameters_find( &scene, &parameters, &error ) : status;
    s->def.scene = &scene, s->def.parameters = &parameters;
    results out = { 0 };
    results_put_options( &out, argc, argv );
    bool meets_target = false;
    status = status == WISP_OK ? tune( &options, &out, &meets_target, &error ) : status;
    // A scene on standard output leaves the error stream for the report.
    const bool is_scene_shown = options.output != NULL && io_is_standard( options.output );
    status =
        status == WISP_OK ? results_write( &out, options.format, is_scene_shown ? stderr : stdout, &error ) : status;
    results_free( &out );
    tune_scene_close( &s->scene );
    wisp_scene_release( &scene );
    free( s->bytes );
    return status != WISP_OK ? command_fail( &error )
                             : interruption_status( meets_target ? STATUS_GOOD : STATUS_UNMET );
}
