// Effect of coarse levels, tethers and the solve order on error and time.
#include "cloth_levels_table.h"

#include <math.h>

// "From 4" and "from 8": the finest coarse level keeps every fourth or eighth vertex of a row instead of every second
// one.
static const cloth_setting settings[] = {
    { "10", 10, 1, false, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "10, list sweep", 10, 1, false, false, WISP_SOLVE_ORDER_LIST, 0 },
    { "40", 40, 1, false, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "1", 1, 1, false, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "1 + tethers", 1, 1, true, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "1 + levels", 1, 1, false, true, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "1 + levels from 4", 1, 1, false, true, WISP_SOLVE_ORDER_COLOUR, 2 },
    { "1 + levels from 8", 1, 1, false, true, WISP_SOLVE_ORDER_COLOUR, 3 },
    { "1 x 2 + tethers", 1, 2, true, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "2 + tethers", 2, 1, true, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "2 + levels", 2, 1, false, true, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "3 + tethers", 3, 1, true, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "5 + tethers", 5, 1, true, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "10 + tethers", 10, 1, true, false, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "1 + levels + tethers", 1, 1, true, true, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "1 + levels from 4 + tethers", 1, 1, true, true, WISP_SOLVE_ORDER_COLOUR, 2 },
    { "1 + levels from 8 + tethers", 1, 1, true, true, WISP_SOLVE_ORDER_COLOUR, 3 },
    { "2 + levels + tethers", 2, 1, true, true, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "3 + levels + tethers", 3, 1, true, true, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "10 + levels + tethers", 10, 1, true, true, WISP_SOLVE_ORDER_COLOUR, 0 },
    { "2 + levels + tethers, list", 2, 1, true, true, WISP_SOLVE_ORDER_LIST, 0 },
};

// The first setting; the converged run has sixteen times its substeps.
#define PLAIN_SETTING 0

static wisp_status run_setting( const cloth_plan* plan, const cloth_scene* scene, const cloth_setting* setting,
                                const char* mesh_name, const path_record* reference, level_table* table, results* out,
                                wisp_error* error )
{
    surface_implementation implementations[SCENARIO_IMPLEMENTATIONS_MAX] = { { 0 } };
    wisp_fabric* fabric = NULL;
    level_line* line = &table->lines[table->line_count++];
    *line = ( level_line ){ .name = setting->name, .volume_error = NAN };
    wisp_status status = cloth_cook( scene, setting, &fabric, error );
    for ( int e = 0; e < plan->worker_count && status == WISP_OK; ++e )
    {
        status =
            cloth_implementation_create( scene, fabric, setting, NULL, plan->workers[e], &implementations[e], error );
    }
    if ( status == WISP_OK )
    {
        status = scenario_run( implementations, plan->worker_count, &plan->scenario, reference, NULL, &line->stats,
                               error );
    }
    if ( status == WISP_OK )
    {
        char what[100], name[64];
        snprintf( what, sizeof( what ), "%s %d, %s", mesh_name, scene->n, setting->name );
        snprintf( name, sizeof( name ), "cloth.levels.%s", mesh_name );
        scenario_check_hashes( implementations, plan->worker_count, line->stats.hash, what, out );
        scenario_add_rows( implementations, plan->worker_count, &line->stats, name, setting->name,
                           table->reference_name ? table->reference_name : "rest lengths", out );
    }
    for ( int e = 0; e < plan->worker_count; ++e )
    {
        surface_implementation_destroy( &implementations[e] );
    }
    wisp_fabric_release( fabric );
    return status;
}

static wisp_status find_reference( const cloth_plan* plan, const cloth_scene* scene, path_record* record,
                                   level_table* table, wisp_error* error )
{
    wisp_fabric* fabric = NULL;
    cloth_reference reference;
    wisp_status status = cloth_cook( scene, &settings[PLAIN_SETTING], &fabric, error );
    if ( status == WISP_OK )
    {
        status = path_record_create( scene->mesh.vertex_count, scenario_path_observations( &plan->scenario ), record,
                                     error );
    }
    if ( status == WISP_OK )
    {
        status = cloth_reference_create( scene, fabric, &reference, error );
    }
    if ( status == WISP_OK )
    {
        cloth_reference_run( &reference, plan->reference_factor * settings[PLAIN_SETTING].substeps, &plan->scenario,
                             record, &table->reference_energy_lost );
        cloth_reference_destroy( &reference );
    }
    wisp_fabric_release( fabric );
    return status;
}

// The cheapest line with at most the stretch of NvCloth with ten passes, with its time and its loss of energy.
static void claim_equal_error( const cloth_plan* plan, const level_table* table, int n, results* out )
{
    const int e = plan->worker_count - 1;
    const level_line* best = NULL;
    cloth_peer peer;
    if ( !cloth_find_peer( n, &peer ) )
    {
        return;
    }
    for ( int i = 0; i < table->line_count; ++i )
    {
        const scenario_stats* f = &table->lines[i].stats;
        const bool meets = 100.0 * f->stretch_mean <= peer.stretch_mean && 100.0 * f->stretch_max <= peer.stretch_max;
        const bool is_faster = best == NULL || f->ms[e].median < best->stats.ms[e].median;
        best = meets && f->halted_at == 0 && is_faster ? &table->lines[i] : best;
    }
    if ( best == NULL )
    {
        results_add_note( out, "n = %d: no setting stretches as little as NvCloth with ten passes.", n );
        return;
    }
    const scenario_stats *f = &best->stats, *plain = &table->lines[PLAIN_SETTING].stats;
    char claim[400];
    snprintf( claim, sizeof( claim ),
              "n = %d, 12 times faster than NvCloth (%.3f ms, stretch %.0f / %.2f %%, reference machine) for no more "
              "stretch: %s, %d %s, %.4f ms, %.1f / %.2f %%, energy lost %.1f %%, path error %.2f m; ten substeps "
              "alone %.1f %%, %.2f m",
              n, peer.ms, peer.stretch_max, peer.stretch_mean, best->name, plan->workers[e],
              bench_workers_word( plan->workers[e] ), f->ms[e].median, 100.0 * f->stretch_max,
              100.0 * f->stretch_mean, 100.0 * f->energy_lost, f->path, 100.0 * plain->energy_lost, plain->path );
    results_add_claim( out, peer.ms >= 12.0 * f->ms[e].median, claim, peer.ms / f->ms[e].median, " times" );
}

static wisp_status levels_of( const cloth_plan* plan, int n, bool is_irregular, results* out, wisp_error* error )
{
    const char* mesh_name = is_irregular ? "irregular" : "grid";
    cloth_scene scene = { 0 };
    path_record reference = { 0 };
    level_table table = { .reference_energy_lost = NAN };
    const int first_row = out->row_count;
    char reference_name[40], name[64];
    snprintf( reference_name, sizeof( reference_name ), "%d in double",
              plan->reference_factor * settings[PLAIN_SETTING].substeps );
    wisp_status status = cloth_scene_make( n, is_irregular, &scene, error );
    bool has_reference = n * n <= plan->reference_vertices_max;
    if ( status == WISP_OK && has_reference )
    {
        status = find_reference( plan, &scene, &reference, &table, error );
        table.reference_name = reference_name;
    }
    for ( int i = 0; i < WISP_COUNT( settings ) && status == WISP_OK; ++i )
    {
        status = run_setting( plan, &scene, &settings[i], mesh_name, has_reference ? &reference : NULL, &table, out,
                              error );
    }
    if ( status == WISP_OK )
    {
        char title[160];
        snprintf( title, sizeof( title ), "Levels and tethers, %s, n = %d: substeps of one pass, 60 + 100 steps",
                  is_irregular ? "irregular mesh" : "alternating diagonals", n );
        level_table_write( plan, &table, title, out );
        snprintf( name, sizeof( name ), "cloth.levels.%s", mesh_name );
        snprintf( title, sizeof( title ), "%s of %d x %d", is_irregular ? "irregular mesh" : "cloth", n, n );
        level_table_charts( plan, &table, name, first_row, title, out );
        if ( !is_irregular )
        {
            claim_equal_error( plan, &table, n, out );
        }
    }
    path_record_destroy( &reference );
    cloth_scene_free( &scene );
    return status;
}

wisp_status cloth_levels( const cloth_plan* plan, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < plan->level_count && status == WISP_OK; ++i )
    {
        status = levels_of( plan, plan->level_sizes[i], false, out, error );
    }
    if ( status == WISP_OK && plan->irregular_size > 0 )
    {
        status = levels_of( plan, plan->irregular_size, true, out, error );
    }
    results_add_note( out, "Levels and tethers: path error and lost energy cover the fall only, because folds are "
                           "chaotic. The scene has no damping, so lost energy is the solver's; fewer substeps lose "
                           "more. `front`: no other line is both faster and more accurate." );
    results_add_note(
        out,
        "Levels and tethers: path error is the root mean square distance of all vertices to the reference, which has "
        "%d times the substeps of the first line, in double precision and in the order of the same fabric.",
        plan->reference_factor );
    return status;
}
