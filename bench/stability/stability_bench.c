// The case `stability`: the suites of data/suites/stability, and a comparison that no suite can say.
#include "stability_bench.h"

#include "program_data.h"
#include "stability_suite.h"

#include "wisp/explain.h"

#include <math.h>
#include <string.h>

// ---- costs ----

#define STEPS 60

// A hanging cloth, and others that share its fabric.
static const char* const scene_head = "wisp: 1\n"
                                      "steps: 60\n"
                                      "surfaces:\n"
                                      "  - name: cloth\n"
                                      "    generate: { shape: alternating_plane, columns: 12, rows: 12 }\n"
                                      "    pins: [0, 11]\n"
                                      "    cloth: {}\n";

typedef struct costs
{
    uint64_t hash; ///< of the first cloth
    size_t bytes;
    int passes;
} costs;

static wisp_status run_copies( int more, costs* out, wisp_error* error )
{
    char text[1000];
    snprintf( text, sizeof text, "%s", scene_head );
    for ( int i = 0; i < more; ++i )
    {
        const size_t used = strlen( text );
        snprintf( text + used, sizeof text - used, "  - { name: copy%d, instance_of: cloth, cloth: {} }\n", i );
    }
    wisp_scene scene;
    scene_world world;
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    wisp_status status = wisp_scene_parse( text, strlen( text ), "costs", &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = scene_world_create( &scene, &options, &world, error );
    if ( status == WISP_OK )
    {
        for ( int i = 0; i < STEPS && status == WISP_OK; ++i )
        {
            status = scene_world_step( &world, error );
        }
        (void)wisp_world_hash_column( world.world, world.surfaces[0].entity, WISP_SURFACE_POINTS, &out->hash );
        out->bytes = wisp_world_memory( world.world );
        out->passes = wisp_world_plan_passes( world.world );
        scene_world_destroy( &world );
    }
    wisp_scene_release( &scene );
    return status;
}

// A second cloth changes no bit of the first, adds no pass, and only its own memory.
static wisp_status costs_add_up( stability_tally* tally, results* out, wisp_error* error )
{
    costs c[3] = { { 0 } };
    wisp_status status = WISP_OK;
    for ( int more = 0; more < 3 && status == WISP_OK; ++more )
    {
        status = run_copies( more, &c[more], error );
    }
    const double first = (double)c[1].bytes - (double)c[0].bytes, second = (double)c[2].bytes - (double)c[1].bytes;
    const bool holds =
        c[0].hash == c[1].hash && c[0].hash == c[2].hash && c[0].passes == c[2].passes && second <= 1.05 * first;
    suite_outcome outcome = { .verdict = { .check = holds ? STABILITY_HOLDS : STABILITY_BITS },
                              .steps = STEPS,
                              .hash = c[0].hash };
    snprintf( outcome.verdict.message, sizeof outcome.verdict.message,
              "%d passes with one and %d with three, %.0f and %.0f bytes more", c[0].passes, c[2].passes, first,
              second );
    if ( status == WISP_OK )
    {
        const int table = stability_begin_table( "Stability, costs", out );
        stability_add( table, "failure 7: costs add up", &outcome, STABILITY_HOLDS, tally, out );
        results_add_note( out, "stability, failure 7: costs add up: %s", outcome.verdict.message );
    }
    return status;
}

// ---- the case ----

wisp_status stability_bench( const bench_options* options, results* out, wisp_error* error )
{
    static const char* const suites[] = { "cloth", "balloons", "strands",   "drives",
                                          "near",  "meshes",   "followers", "failures" };
    stability_tally tally = { 0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( suites ) && status == WISP_OK; ++i )
    {
        char inner[64], path[1024];
        wisp_suite suite;
        snprintf( inner, sizeof inner, "suites/stability/%s.yaml", suites[i] );
        program_data_path( inner, path, sizeof path );
        status = suite_read( path, &suite, error );
        status = status == WISP_OK ? stability_bench_suite( &suite, options, &tally, out, error ) : status;
        suite_release( &suite );
    }
    status = status == WISP_OK ? costs_add_up( &tally, out, error ) : status;
    stability_note( &tally, "stability", out );
    return status;
}
