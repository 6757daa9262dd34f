#include "run_summary.h"

#include "io_file.h"
#include "run_memory.h"
#include "run_motion.h"
#include "stats.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SMALL_PERCENT 1.0 // passes below this are combined into one line of the text

// ---- the result ----

static double sum( const double* values, int count )
{
    double all = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        all += values[i];
    }
    return all;
}

static void add_head_line( results* out, int table, const char* label, const char* format, ... )
    __attribute__( ( format( printf, 4, 5 ) ) );

static void add_head_line( results* out, int table, const char* label, const char* format, ... )
{
    char value[320];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( value, sizeof( value ), format, arguments );
    va_end( arguments );
    results_add_cells( out, table, ( const char* const[] ){ label, value } );
}

static void add_times( results* out, int table, const scene_world* world, const run_record* record,
                       stats_summary times )
{
    if ( record->steps < record->all_steps )
    {
        add_head_line( out, table, "interrupted", "at step %d of %d", record->steps, record->all_steps );
    }
    if ( record->steps == 0 )
    {
        add_head_line( out, table, "steps", "none: the files hold the rest shape" );
        return;
    }
    const double wall = 1e-3 * sum( record->ms, record->steps );
    const double simulated = wisp_scene_step_time( world->scene, record->steps );
    add_head_line( out, table, "steps", "%d of %.4g ms: %.4g s simulated in %.3g s", record->steps,
                   1e3 * (double)world->scene->dt, simulated, wall );
    add_head_line( out, table, "ms per step", "median %.4f, p10 %.4f, p90 %.4f, max %.4f", times.median, times.p10,
                   times.p90, record->ms[record->steps - 1] );
    const int workers = wisp_world_workers( world->world );
    add_head_line( out, table, "speed", "%.3g x real time with %d worker%s", simulated / wall, workers,
                   workers == 1 ? "" : "s" );
}

static void add_sizes( results* out, int table, const scene_world* world )
{
    const int vertices = scene_world_vertices( world ), strands = scene_world_strands( world );
    const double bytes = (double)wisp_world_memory( world->world );
    char count[40] = "";
    if ( strands > 0 )
    {
        snprintf( count, sizeof( count ), "%d strands, ", strands );
    }
    add_head_line( out, table, "size", "%s%d vertices, %.2f MB, %.1f bytes per vertex", count, vertices, bytes / 1e6,
                   vertices > 0 ? bytes / vertices : 0.0 );
}

static void add_files( results* out, int table, const wisp_scene* scene, const run_record* record,
                       const run_recorder_def* def, run_recorder_counts counts )
{
    for ( int i = 0; i < scene->output_count; ++i )
    {
        add_head_line( out, table, record->steps < record->all_steps ? "not written" : "written", "%s",
                       scene->outputs[i].file );
    }
    if ( def->record )
    {
        add_head_line( out, table, "recorded", "%s: %d frames", def->record, counts.written );
    }
    if ( def->track_count > 0 )
    {
        add_head_line( out, table, "tracked", "%s: %d vertices over %d frames", def->track_file, def->track_count,
                       counts.written );
    }
    if ( def->verify )
    {
        add_head_line( out, table, "verified", "%s: %d frames, every bit equal", def->verify, counts.verified );
    }
    if ( counts.unreached > 0 )
    {
        add_head_line( out, table, "not verified", "%s: %d frames after the last step", def->verify,
                       counts.unreached );
    }
}

// Seams that can break.
static void add_seams( results* out, int table, const scene_world* world )
{
    for ( int i = 0; i < world->scene->seam_count; ++i )
    {
        const wisp_scene_seam* entry = &world->scene->seams[i];
        if ( entry->def.strength < INFINITY )
        {
            add_head_line( out, table, "seam", "%s: %d of %d pairs broken", entry->name,
                           wisp_count_broken_seam_pairs( world->world, world->seams[i] ),
                           wisp_count_seam_pairs( world->world, world->seams[i] ) );
        }
    }
}

// Surfaces that can tear.
static void add_tears( results* out, int table, const scene_world* world )
{
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        const scene_world_surface* s = &world->surfaces[i];
        wisp_tearing_stats stats;
        if ( world->scene->surfaces[i].has_tearing &&
             wisp_read_tearing_stats( world->world, s->entity, &stats ) == WISP_OK )
        {
            add_head_line( out, table, "tears", "%s: %d vertices split, %d of %d spare ones left",
                           world->scene->surfaces[i].name, stats.split_count, stats.spare_count, s->spare_count );
        }
    }
}

// A table without a title is a list of labels and values.
static void add_head( results* out, const scene_world* world, const run_record* record, stats_summary times,
                      const run_recorder_def* def, run_recorder_counts counts )
{
    char intersections[120];
    const int table = results_add_table( out, "", 2, ( const char* const[] ){ "", "" } );
    add_head_line( out, table, "scene", "%s", world->scene->name );
    add_times( out, table, world, record, times );
    add_sizes( out, table, world );
    if ( record->steps > 0 && record->profile.pass_count == 0 )
    {
        add_head_line( out, table, "computed", "nothing, since the scene requests nothing (key `compute`)" );
    }
    add_seams( out, table, world );
    add_tears( out, table, world );
    run_intersections_describe( record->intersections, intersections, sizeof intersections );
    if ( intersections[0] != '\0' )
    {
        add_head_line( out, table, "intersections", "%s", intersections );
    }
    add_files( out, table, world->scene, record, def, counts );
    add_head_line( out, table, "hash", "%016llx", (unsigned long long)wisp_world_hash( world->world ) );
}

// ---- passes ----

static void add_pass( results* out, int table, const char* name, const char* items, double ms, double percent )
{
    char time[24], part[16];
    snprintf( time, sizeof( time ), "%.4f", ms );
    snprintf( part, sizeof( part ), "%.1f", percent );
    results_add_cells( out, table, ( const char* const[] ){ name, items, time, part } );
}

// Means, not medians: they add up to the time of the run, also where a pass has work in a few steps only.
static void add_pass_table( results* out, const run_record* record )
{
    const char* const header[] = { "pass", "items", "ms", "%" };
    const int table = results_add_table( out, "Time per step by pass (mean, and percent of the run)", 4, header );
    const double whole_ms = sum( record->ms, record->steps );
    double small_ms = 0.0;
    int small_count = 0;
    for ( int i = 0; i < record->profile.pass_count; ++i )
    {
        const profile_pass* pass = &record->profile.passes[i];
        const double ms = 1e3 * sum( pass->seconds, pass->count );
        const double percent = whole_ms > 0.0 ? 100.0 * ms / whole_ms : 0.0;
        if ( percent < SMALL_PERCENT )
        {
            small_ms += ms;
            ++small_count;
            continue;
        }
        char items[16];
        snprintf( items, sizeof( items ), "%d", pass->items );
        add_pass( out, table, pass->name, items, ms / record->steps, percent );
    }
    if ( small_count > 0 )
    {
        char name[48];
        snprintf( name, sizeof( name ), "other (%d pass%s)", small_count, small_count == 1 ? "" : "es" );
        add_pass( out, table, name, "", small_ms / record->steps,
                  whole_ms > 0.0 ? 100.0 * small_ms / whole_ms : 0.0 );
    }
}

// ---- counters ----

static void add_counter_table( results* out, const wisp_world* world )
{
    // The number of steps is a line of the result. A plan is compiled at the start of every run.
    static const char* const MEANINGS[WISP_COUNTER_COUNT] = {
        [WISP_COUNT_PLANS] = "frame plans compiled: one at the start and one after each change",
        [WISP_COUNT_NEIGHBOURS] = "neighbours found by the last search of each command",
        [WISP_COUNT_CAPPED] = "neighbour queries cut at their limit: farther vertices were left out",
        [WISP_COUNT_COARSE_GRIDS] = "search grids with widened cells, because the scene is sparse",
        [WISP_COUNT_SEARCHES] = "neighbour searches",
        [WISP_COUNT_HALTED] = "entities put back to their last finite state and stopped",
        [WISP_COUNT_STRAND_RESET] = "strands put back to their rest lengths, too far off to be solved",
        [WISP_COUNT_NOT_CONVERGED] = "solves that reached the iteration limit before the tolerance",
        [WISP_COUNT_INDEFINITE] = "solves that met negative curvature and were made again",
        [WISP_COUNT_DEGENERATE_LINK] = "links between coincident vertices: no direction, no force",
        [WISP_COUNT_STIFFNESS_CLAMPED] = "substeps with links too stiff for floats: stiffness was lowered",
        [WISP_COUNT_FIRST_ORDER] = "substeps of BDF2 (of cloth, of each strand) that were made by implicit Euler",
        [WISP_COUNT_GRAVITY_SCALED] = "strands with reduced gravity: substeps too long for their curls",
        [WISP_COUNT_SAGGING] = "strands too soft to hold their shape under gravity: they sag",
        [WISP_COUNT_STRETCHED] = "strands over 5 % too long in a step: use stretch: direct",
        [WISP_COUNT_SPEED_LIMITED] = "velocities of vertices scaled down to the largest speed, in each substep",
        [WISP_COUNT_SPLIT_VERTICES] = "vertices that tearing has split",
    };
    int table = -1;
    for ( int i = 0; i < WISP_COUNTER_COUNT; ++i )
    {
        const uint64_t count = wisp_world_counter( world, (wisp_counter)i );
        const uint64_t usual = i == WISP_COUNT_PLANS ? 1 : 0;
        if ( count <= usual || MEANINGS[i] == NULL )
        {
            continue;
        }
        if ( table < 0 )
        {
            table = results_add_table( out, "Counters that are not zero", 3,
                                       ( const char* const[] ){ "counter", "value", "meaning" } );
        }
        char value[24];
        snprintf( value, sizeof( value ), "%llu", (unsigned long long)count );
        results_add_cells( out, table,
                           ( const char* const[] ){ wisp_counter_name( (wisp_counter)i ), value, MEANINGS[i] } );
    }
}

// ---- notes ----

// Of surfaces whose statistics the scene requests.
static void add_solver_notes( results* out, const scene_world* world )
{
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        const wisp_scene_surface* entry = &world->scene->surfaces[i];
        wisp_implicit_cloth_stats f;
        if ( entry->has_implicit && entry->request_stats &&
             wisp_read_implicit_cloth_stats( world->world, world->surfaces[i].entity, &f ) == WISP_OK )
        {
            results_add_note( out, "%s, last substep: %d iterations, residual %.1e", entry->name, f.iterations,
                              (double)f.residual );
            results_add_note( out, "%s, contact: %d vertices stick, %d slide, %d land", entry->name, f.sticking,
                              f.sliding, f.landing );
            results_add_note( out, "%s, energy: stretch %.3e J, bending %.3e J", entry->name, f.stretch_energy,
                              f.bend_energy );
        }
    }
}

static void add_command_note( results* out, const scene_world* world )
{
    const int count = world->scene->command_count;
    if ( world->next_command < count )
    {
        results_add_note( out, "commands: %d of %d are scheduled after the last step and had no effect",
                          count - world->next_command, count );
    }
}

// ---- the row for machines ----

static void add_row( results* out, const scene_world* world, run_record* record, stats_summary times )
{
    results_row* row = results_add_row( out, io_file_name( world->scene->name ), "run" );
    if ( !row )
    {
        return;
    }
    int vertices = scene_world_vertices( world );
    results_put( &row->size, "strands", scene_world_strands( world ) );
    results_put( &row->size, "vertices", vertices );
    if ( vertices > 0 )
    {
        results_put( &row->size, "bytes_a_vertex", (double)wisp_world_memory( world->world ) / vertices );
    }
    row->workers = wisp_world_workers( world->world );
    results_put_times( row, &times );
    for ( int i = 0; i < record->profile.pass_count; ++i )
    {
        results_put( &row->stages, record->profile.passes[i].name,
                     1e3 * profile_samples_median( &record->profile, i ) );
    }
    row->hash = wisp_world_hash( world->world );
    row->has_hash = true;
    run_memory_put( world->world, &row->size );
    run_layers_put( record->layers, &row->size );
    run_collision_put( record->collision, &row->size );
    run_intersections_put( record->intersections, &row->size );
}

void run_summarise( const scene_world* world, run_record* record, const run_recorder_def* recorder,
                    run_recorder_counts counts, results* out )
{
    out->machine = machine_describe( wisp_world_isa( world->world ) );
    out->is_result_first = true;
    stats_summary times = stats_summarise( record->ms, record->steps );
    times.cpu_fraction = 1e3 * record->cpu_seconds / sum( record->ms, record->steps );
    add_row( out, world, record, times );
    add_head( out, world, record, times, recorder, counts );
    if ( record->steps > 0 )
    {
        run_motion_add_table( world, out );
        run_motion_add_detail( world, out );
        run_collision_report( record->collision, out );
        run_intersections_report( record->intersections, out );
        if ( record->profile.pass_count > 0 )
        {
            add_pass_table( out, record );
        }
        run_memory_report( world->world, scene_world_vertices( world ), out );
        run_motion_add_warnings( world, out );
    }
    add_counter_table( out, world->world );
    add_command_note( out, world );
    add_solver_notes( out, world );
    run_layers_report( record->layers, out );
}
