// The case `effects`: each effect against itself, on and off, with every module registered and with only those in use.
#include "effects/effects_bench.h"

#include "bench_output.h"
#include "stats.h"
#include "bench.h"

#include <stdlib.h>
#include <string.h>

enum
{
    ON,             // every module is registered
    ON_USED,        // only those that the scene uses
    OFF,            // every module, and the effect is not requested
    NOT_REGISTERED, // the same without its module, and without all other unused ones
    WAYS,
};

static const char* const way_names[WAYS] = { "on", "on, used modules only", "off", "not registered" };

// One effect in all ways.
typedef struct contest
{
    const char* name; // of the effect
    effect_world* worlds[WAYS];
    bench_variant variants[WAYS];
    stats_summary ms[WAYS];
    uint64_t hash[WAYS];
    char plan[WAYS][EFFECT_PLAN_MAX];
    int passes[WAYS];
    size_t bytes[WAYS]; // apart from the registry
    int vertices;
} contest;

static wisp_status open_way( const effects_plan* plan, int effect, contest* c, int way, wisp_error* error )
{
    const effect_world_def def = {
        .all = plan->all,
        .chosen = &effect,
        .count = 1,
        .is_on = way == ON || way == ON_USED,
        .only_used = way == ON_USED || way == NOT_REGISTERED,
        .size = plan->size,
    };
    wisp_status status = effect_world_open( &def, &c->worlds[way], error );
    effect_world* world = c->worlds[way];
    for ( int i = 0; i < plan->steps && status == WISP_OK; ++i )
    {
        status = effect_world_step( world, error );
    }
    status = status == WISP_OK ? effect_world_hash( world, 0, c->hash + way, error ) : status;
    status = status == WISP_OK ? effect_world_plan( world, c->plan[way], c->passes + way, error ) : status;
    if ( status == WISP_OK )
    {
        c->bytes[way] = effect_world_bytes( world );
        c->vertices = scene_world_vertices( &world->world );
        c->variants[way] = ( bench_variant ){ .name = way_names[way], .step = effect_world_step, .context = world };
    }
    return status;
}

// ---- what must be equal ----

static void check_pair( const contest* c, int one, int other, results* out )
{
    const char* name = c->name;
    if ( strcmp( c->plan[one], c->plan[other] ) != 0 )
    {
        results_add_failure( out, "%s: the plans '%s' and '%s' differ: %s; %s", name, way_names[one],
                             way_names[other], c->plan[one], c->plan[other] );
    }
    if ( c->hash[one] != c->hash[other] )
    {
        results_add_failure( out, "%s: points differ between '%s' and '%s'", name, way_names[one], way_names[other] );
    }
    if ( c->bytes[one] != c->bytes[other] )
    {
        results_add_failure( out, "%s: %zu bytes beyond the registry '%s', %zu '%s'", name, c->bytes[one],
                             way_names[one], c->bytes[other], way_names[other] );
    }
}

static void check_contest( const contest* c, results* out )
{
    check_pair( c, ON, ON_USED, out );
    check_pair( c, OFF, NOT_REGISTERED, out );
    if ( strcmp( c->plan[ON], c->plan[OFF] ) == 0 )
    {
        results_add_failure( out, "%s: its plan is the same with the effect on and off", c->name );
    }
}

static bool is_same( const contest* c, int one, int other )
{
    return strcmp( c->plan[one], c->plan[other] ) == 0 && c->hash[one] == c->hash[other] &&
           c->bytes[one] == c->bytes[other];
}

// ---- tables ----

static int begin_effects_table( results* out )
{
    return results_begin_table(
        out, "Effects: an effect that is not requested costs nothing, one worker",
        "effect\tvertices\tpasses on / off\tms on\tms on, used\tms off\tms not registered\t"
        "off / not registered\tKiB on\tKiB off\tKiB not registered\tregistry KiB every / used\t"
        "same plan, bits, bytes" );
}

static void add_effect_row( const contest* c, int table, results* out )
{
    results_cells row = { 0 };
    cells_put( &row, "%s\t%d\t%d / %d", c->name, c->vertices, c->passes[ON], c->passes[OFF] );
    for ( int way = 0; way < WAYS; ++way )
    {
        cells_put( &row, "%.4f", c->ms[way].median );
    }
    cells_put( &row, "%.3f\t%.1f\t%.1f\t%.1f", c->ms[OFF].median / c->ms[NOT_REGISTERED].median,
               (double)c->bytes[ON] / 1024.0, (double)c->bytes[OFF] / 1024.0,
               (double)c->bytes[NOT_REGISTERED] / 1024.0 );
    cells_put_pair( &row, (double)c->worlds[OFF]->world.empty_bytes / 1024.0, 1,
                    (double)c->worlds[NOT_REGISTERED]->world.empty_bytes / 1024.0, 1 );
    cells_put( &row, "%s", is_same( c, ON, ON_USED ) && is_same( c, OFF, NOT_REGISTERED ) ? "yes" : "NO" );
    cells_end_row( &row, table, out );
}

static void add_rows_for_machines( const contest* c, results* out )
{
    for ( int way = 0; way < WAYS; ++way )
    {
        char variant[64];
        snprintf( variant, sizeof( variant ), "%s: %s", c->name, way_names[way] );
        results_row* row = results_add_row( out, "effects", variant );
        if ( row == NULL )
        {
            return;
        }
        results_put( &row->size, "vertices", c->vertices );
        results_put( &row->size, "passes", c->passes[way] );
        results_put( &row->size, "bytes", (double)c->bytes[way] );
        results_put( &row->size, "registry_bytes", (double)c->worlds[way]->world.empty_bytes );
        row->workers = 1;
        results_put_times( row, &c->ms[way] );
        row->hash = c->hash[way];
        row->has_hash = true;
    }
}

// ---- one effect after the other ----

static wisp_status run_contest( const effects_plan* plan, int effect, contest* c, wisp_error* error )
{
    const double seconds = plan->seconds / plan->all->count;
    wisp_status status = WISP_OK;
    for ( int way = 0; way < WAYS && status == WISP_OK; ++way )
    {
        status = open_way( plan, effect, c, way, error );
    }
    const bench_effort effort = { .seconds = seconds, .rounds_min = 3, .samples_max = plan->samples_max };
    status = status == WISP_OK ? bench_interleave( c->variants, WAYS, &effort, error ) : status;
    for ( int way = 0; way < WAYS && status == WISP_OK; ++way )
    {
        c->ms[way] = bench_summarise( &c->variants[way] );
    }
    return status;
}

static void end_contest( contest* c )
{
    bench_free_samples( c->variants, WAYS );
    for ( int way = 0; way < WAYS; ++way )
    {
        effect_world_close( c->worlds[way] );
    }
}

static void add_notes( results* out )
{
    results_add_note( out, "Effects: bytes are those beyond the registry, which holds the state of every registered "
                           "module. 'used' is the registry without modules that do not act." );
    results_add_note( out, "Effects: environment, frozen hair and strand appearance receive a new command before "
                           "every step; their times include it." );
    results_add_note(
        out,
        "Effects: times vary by chance on a shared machine. `./dev bench instructions` counts instructions: each "
        "effect, on and off, executes the same number with every module registered as with only the used ones." );
}

wisp_status effects_compare( const effects_plan* plan, results* out, wisp_error* error )
{
    const int count = plan->all->count;
    contest* c = malloc( sizeof( contest ) );
    if ( c == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory to compare effects" );
    }
    const int table = begin_effects_table( out );
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        *c = ( contest ){ .name = effects_name( plan->all, i ) };
        bench_progress( plan->options, (double)i / count, c->name );
        status = run_contest( plan, i, c, error );
        if ( status == WISP_OK )
        {
            check_contest( c, out );
            add_effect_row( c, table, out );
            add_rows_for_machines( c, out );
        }
        end_contest( c );
    }
    free( c );
    add_notes( out );
    return status;
}

bench_case_fn effects_bench;

wisp_status effects_bench( const bench_options* options, results* out, wisp_error* error )
{
    effects all;
    wisp_status status = effects_read( &all, error );
    const effects_plan plan = {
        .all = &all,
        .size = { .side = 32, .level = 3, .strands = 500 },
        .steps = 20,
        .seconds = 0.9 * bench_seconds( options ),
        .samples_max = options->quick ? 400 : 2000,
        .options = options,
    };
    status = status == WISP_OK ? effects_compare( &plan, out, error ) : status;
    effects_release( &all );
    return status;
}
