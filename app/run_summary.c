#include "run_summary.h"

#include "io_file.h"
#include "results.h"
#include "stats.h"
#include "wisp/wisp.h"
#include "world_from_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- memory ----

// Passes below this are combined into one line of the text; so are parts of memory, and those that are not in use.
static const double SMALL_PERCENT = 1.0;

static const char* const KINDS[] = {
    [WISP_MEMORY_ENGINE] = "engine",
    [WISP_MEMORY_MODULE] = "module",
    [WISP_MEMORY_COMPONENT] = "component",
    [WISP_MEMORY_OUTSIDE] = "outside the world",
};

// @return null without memory
static wisp_memory_part* list_parts( const wisp_world* world, int* count, double* sum )
{
    *count = wisp_world_memory_parts( world, NULL, 0 );
    wisp_memory_part* parts = calloc( (size_t)*count, sizeof *parts );
    *sum = 0.0;
    if ( parts )
    {
        wisp_world_memory_parts( world, parts, *count );
        for ( int i = 0; i < *count; ++i )
        {
            *sum += (double)parts[i].capacity;
        }
    }
    return parts;
}

static void add_memory_line( results* out, int table, const char* name, const char* kind, double bytes,
                             double percent, int vertices )
{
    results_add_line( out, table, "%s\t%s\t%.1f\t%.1f\t%.1f", name, kind, bytes / 1024.0,
                      vertices > 0 ? bytes / vertices : 0.0, percent );
}

// A table of the parts of a world's memory, of fabrics, and of Embree.
static void report_memory( const wisp_world* world, int vertices, results* out )
{
    double sum, small = 0.0;
    int count, small_count = 0;
    wisp_memory_part* parts = list_parts( world, &count, &sum );
    if ( parts == NULL )
    {
        return;
    }
    const int table = results_begin_table( out, "Memory by part (allocated, with fabrics and Embree)",
                                           "part\tof\tKiB\tbytes / vertex\t%" );
    for ( int i = 0; i < count; ++i )
    {
        const double bytes = (double)parts[i].capacity, percent = 100.0 * bytes / sum;
        // a module without entities has a state all the same
        if ( percent < SMALL_PERCENT || parts[i].bytes == 0 )
        {
            small += bytes;
            ++small_count;
            continue;
        }
        add_memory_line( out, table, parts[i].name, KINDS[parts[i].kind], bytes, percent, vertices );
    }
    if ( small_count > 0 )
    {
        char name[48];
        snprintf( name, sizeof name, "other (%d part%s)", small_count, small_count == 1 ? "" : "s" );
        add_memory_line( out, table, name, "", small, 100.0 * small / sum, vertices );
    }
    free( parts );
}

// Sums by kind, for machines.
static void put_memory( const wisp_world* world, results_values* out )
{
    static const char* const names[] = { "engine_bytes", "module_bytes", "component_bytes", "outside_bytes" };
    double bytes[WISP_COUNT( names )] = { 0 }, sum;
    int count;
    wisp_memory_part* parts = list_parts( world, &count, &sum );
    for ( int i = 0; parts && i < count; ++i )
    {
        bytes[parts[i].kind] += (double)parts[i].capacity;
    }
    for ( int i = 0; parts && i < WISP_COUNT( names ); ++i )
    {
        results_put( out, names[i], bytes[i] );
    }
    free( parts );
}

// ---- motion ----

// Motion of bodies at the end of a run: statistics that the scene requests, and stretch, which shows whether the substeps suffice.

// ---- statistics ----

static bool has_motion_stats( const scene_world* world, int body )
{
    const wisp_scene* scene = world->scene;
    return body < scene->strands_count ? scene->strands[body].request_motion_stats
                                       : scene->surfaces[body - scene->strands_count].request_motion_stats;
}

// One line per surface or groom whose motion_stats the scene computes: mass, energy, stretch and speed.
static void add_motion_table( const scene_world* world, results* out )
{
    int table = -1;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        wisp_motion_stats m;
        wisp_error error;
        if ( has_motion_stats( world, body ) == false ||
             scene_world_motion_stats( world, body, &m, &error ) != WISP_OK )
        {
            continue;
        }
        if ( table < 0 )
        {
            table = results_begin_table(
                out, "Motion at the end",
                "body\tmass kg\tkinetic J\tpotential J\tstrain % mean\t% max\tspeed m/s\tvolume m3" );
        }
        results_add_line( out, table, "%s\t%.4g\t%.4g\t%.4g\t%.4g\t%.4g\t%.4g\t%.4g",
                          scene_world_body( world, body ).name, m.mass, m.kinetic_energy, m.potential_energy,
                          100.0 * m.strain_mean, 100.0 * m.strain_max, m.speed_max, m.volume );
    }
}

// ---- level of detail ----

static bool has_event( const wisp_scene* scene, int body )
{
    bool found = false;
    for ( int i = 0; i < scene->event_count; ++i )
    {
        const wisp_scene_event* e = &scene->events[i];
        const int of = e->strands >= 0 ? e->strands : scene->strands_count + e->surface;
        found = found || ( e->has_detail && of == body );
    }
    return found;
}

// One line per body whose level of detail the scene sets: where it is at the end, and its substeps there.
static void add_detail_table( const scene_world* world, results* out )
{
    static const char* const LEVELS[WISP_DETAIL_COUNT] = { "full", "fewer substeps", "coarse", "nothing" };
    const wisp_scene* scene = world->scene;
    int table = -1;
    for ( int body = 0; body < scene->strands_count + scene->surface_count; ++body )
    {
        const int surface = body - scene->strands_count;
        const bool is_set = surface < 0 ? scene->strands[body].has_detail : scene->surfaces[surface].has_detail;
        if ( is_set == false && has_event( scene, body ) == false )
        {
            continue;
        }
        if ( table < 0 )
        {
            table = results_begin_table( out, "Level of detail at the end", "body\tlevel\tsubsteps" );
        }
        const wisp_entity entity = scene_world_entity( world, body );
        int substeps;
        const bool is_known = wisp_read_substeps( world->world, entity, &substeps ) == WISP_OK;
        results_add_line( out, table, "%s\t%s\t%d",
                          surface < 0 ? scene->strands[body].name : scene->surfaces[surface].name,
                          LEVELS[wisp_detail_of( world->world, entity )], is_known ? substeps : 0 );
    }
}

// ---- stretch ----

typedef struct stretch_sums
{
    double stretch; // of all edges that are longer than at rest
    int count;      // of all edges
} stretch_sums;

static void add_edge( stretch_sums* sums, const wisp_vec3* now, const wisp_vec3* rest, int a, int b )
{
    const double length = wisp_mesh_distance( rest[a], rest[b] );
    sums->stretch += length > 0.0 ? fmax( wisp_mesh_distance( now[a], now[b] ) / length - 1.0, 0.0 ) : 0.0;
    sums->count += 1;
}

// Inner edges of a surface count twice.
static double stretch_of( const scene_body* body, const wisp_vec3* now, const wisp_vec3* rest )
{
    stretch_sums sums = { 0.0, 0 };
    for ( int i = 0; i < 3 * body->triangle_count; ++i )
    {
        const int first = i - i % 3;
        add_edge( &sums, now, rest, body->triangles[i], body->triangles[first + ( i + 1 ) % 3] );
    }
    for ( int s = 0; s < body->strand_count; ++s )
    {
        for ( int v = body->offsets[s] + 1; v < body->offsets[s + 1]; ++v )
        {
            add_edge( &sums, now, rest, v - 1, v );
        }
    }
    return sums.count > 0 ? sums.stretch / sums.count : 0.0;
}

// Return the rest shape of a body that keeps its lengths by projection or by springs; null of others.
static const wisp_vec3* rest_of( const scene_world* world, int body )
{
    const wisp_scene* scene = world->scene;
    if ( body < scene->strands_count )
    {
        return scene->strands[body].has_dynamics ? world->grooms[body].points : NULL;
    }
    const int surface = body - scene->strands_count;
    const wisp_scene_surface* entry = scene->surfaces + surface;
    const bool keeps_lengths = ( entry->has_cloth && !entry->has_membrane ) || entry->has_implicit;
    return keeps_lengths ? world->surfaces[surface].mesh.points : NULL;
}

// Return the mean stretch from what the scene computes, its points or its statistics; 0 if it computes neither.
static double find_stretch( const scene_world* world, int b, const scene_body* body )
{
    const wisp_vec3* rest = rest_of( world, b );
    wisp_vec3* now = rest != NULL ? calloc( (size_t)body->vertex_count + 1, sizeof( *now ) ) : NULL;
    wisp_error error;
    wisp_motion_stats m;
    double stretch = 0.0;
    if ( now != NULL && scene_world_points( world, b, now, &error ) == WISP_OK )
    {
        stretch = stretch_of( body, now, rest );
    }
    else if ( now != NULL && has_motion_stats( world, b ) &&
              scene_world_motion_stats( world, b, &m, &error ) == WISP_OK )
    {
        stretch = m.strain_mean;
    }
    free( now );
    return stretch;
}

static void add_hold_note( const scene_world* world, int b, const char* name, results* out )
{
    wisp_strand_hold hold;
    if ( scene_world_strand_hold( world, b, &hold, NULL ) == WISP_OK && hold.sagging > 0 )
    {
        results_add_note( out,
                          "%s: %d strands are too soft for their shape and sag; the softest holds it up to %.3g m, "
                          "or with bend_rigidity: %.2g",
                          name, (int)hold.sagging, (double)hold.max_length, (double)hold.bend_rigidity );
    }
}

// Cloth that hangs from pins is kept short by tethers whatever its mesh. Substeps do not help where triangles get coarse away from pins.
static bool can_have_tethers( const wisp_scene* scene, int body )
{
    const wisp_scene_surface* surface =
        body >= scene->strands_count ? scene->surfaces + ( body - scene->strands_count ) : NULL;
    return surface != NULL && surface->has_cloth && surface->cloth.tethers == false && wisp_scene_has_pins( surface );
}

// A note for each body whose segments or edges are longer than at rest by more than a tenth in the mean.
static void add_motion_warnings( const scene_world* world, results* out )
{
    const double TOO_LONG = 0.1;
    for ( int b = 0; b < scene_world_moving_count( world ); ++b )
    {
        const scene_body body = scene_world_body( world, b );
        add_hold_note( world, b, body.name, out );
        const double stretch = find_stretch( world, b, &body );
        if ( stretch > TOO_LONG && can_have_tethers( world->scene, b ) )
        {
            results_add_note( out, "%s is stretched by %.0f %%; tethers: true of its cloth keeps lengths", body.name,
                              100.0 * stretch );
        }
        else if ( stretch > TOO_LONG )
        {
            results_add_note( out, "%s is stretched by %.0f %%; more than %d substeps keep lengths better", body.name,
                              100.0 * stretch, scene_world_substeps( world, b ) );
        }
    }
}

// ---- the summary ----

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

// On a quiet machine workers have processors for longer, as a part of the wall time.
static const double IDLE_LEAST = 0.8;

static void add_run_times( results* out, int table, const scene_world* world, const run_record* record,
                           stats_summary times )
{
    if ( record->steps < record->all_steps )
    {
        results_add_line( out, table, "interrupted\tat step %d of %d", record->steps, record->all_steps );
    }
    if ( record->steps == 0 )
    {
        results_add_line( out, table, "steps\tnone: the files hold the rest shape" );
        return;
    }
    const double wall = 1e-3 * sum( record->ms, record->steps );
    const double simulated = wisp_scene_step_time( world->scene, record->steps );
    results_add_line( out, table, "steps\t%d of %.4g ms: %.4g s simulated in %.3g s", record->steps,
                      1e3 * (double)world->scene->dt, simulated, wall );
    results_add_line( out, table, "ms per step\tmedian %.4f, p10 %.4f, p90 %.4f, max %.4f", times.median, times.p10,
                      times.p90, record->ms[record->steps - 1] );
    const int workers = wisp_world_workers( world->world );
    const double busy = times.cpu_fraction / workers;
    char processors[80] = "";
    if ( busy < IDLE_LEAST )
    {
        snprintf( processors, sizeof processors, ", which had processors for %.0f %% of the time", 100.0 * busy );
    }
    results_add_line( out, table, "speed\t%.3g x real time with %d worker%s%s", simulated / wall, workers,
                      workers == 1 ? "" : "s", processors );
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
    results_add_line( out, table, "size\t%s%d vertices, %.2f MB, %.1f bytes per vertex", count, vertices, bytes / 1e6,
                      vertices > 0 ? bytes / vertices : 0.0 );
}

static void add_files( results* out, int table, const wisp_scene* scene, const run_record* record,
                       const run_recorder_def* def, run_recorder_counts counts )
{
    for ( int i = 0; i < scene->output_count; ++i )
    {
        results_add_line( out, table, "%s\t%s", record->steps < record->all_steps ? "not written" : "written",
                          scene->outputs[i].file );
    }
    if ( def->record )
    {
        results_add_line( out, table, "recorded\t%s: %d frames", counts.files, counts.written );
    }
    if ( def->track_count > 0 )
    {
        results_add_line( out, table, "tracked\t%s: %d vertices over %d frames", def->track_file, def->track_count,
                          counts.written );
    }
    if ( def->verify )
    {
        results_add_line( out, table, "verified\t%s: %d frames, every bit equal", def->verify, counts.verified );
    }
    if ( counts.unreached > 0 )
    {
        results_add_line( out, table, "not verified\t%s: %d frames after the last step", def->verify,
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
            results_add_line( out, table, "seam\t%s: %d of %d pairs broken", entry->name,
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
            results_add_line( out, table, "tears\t%s: %d vertices split, %d of %d spare ones left",
                              world->scene->surfaces[i].name, stats.split_count, stats.spare_count, s->spare_count );
        }
    }
}

// A table without a title is a list of labels and values.
static void add_head( results* out, const scene_world* world, const run_record* record, stats_summary times,
                      const run_recorder_def* def, run_recorder_counts counts )
{
    char intersections[120];
    const int table = results_begin_table( out, "", "\t" );
    results_add_line( out, table, "scene\t%s", world->scene->name );
    add_run_times( out, table, world, record, times );
    add_sizes( out, table, world );
    if ( record->steps > 0 && record->profile.pass_count == 0 )
    {
        results_add_line( out, table, "computed\tnothing, since the scene requests nothing (key `compute`)" );
    }
    add_seams( out, table, world );
    add_tears( out, table, world );
    run_contact_describe( record->contact, intersections, sizeof intersections );
    if ( intersections[0] != '\0' )
    {
        results_add_line( out, table, "intersections\t%s", intersections );
    }
    add_files( out, table, world->scene, record, def, counts );
    results_add_line( out, table, "hash\t%016llx", (unsigned long long)wisp_world_hash( world->world ) );
}

// ---- passes ----

// Means, not medians: they add up to the time of the run, also where a pass has work in a few steps only.
static void add_pass_table( results* out, const run_record* record )
{
    const int table =
        results_begin_table( out, "Time per step by pass (mean, and percent of the run)", "pass\titems\tms\t%" );
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
        results_add_line( out, table, "%s\t%d\t%.4f\t%.1f", pass->name, pass->items, ms / record->steps, percent );
    }
    if ( small_count > 0 )
    {
        results_add_line( out, table, "other (%d pass%s)\t\t%.4f\t%.1f", small_count, small_count == 1 ? "" : "es",
                          small_ms / record->steps, whole_ms > 0.0 ? 100.0 * small_ms / whole_ms : 0.0 );
    }
}

// ---- counters ----

// Counters of a run in which nothing went wrong.
static bool is_usual( wisp_counter counter )
{
    return counter == WISP_COUNT_PLANS || counter == WISP_COUNT_NEIGHBOURS || counter == WISP_COUNT_SEARCHES ||
           counter == WISP_COUNT_FIRST_ORDER;
}

// @param is_brief notes of what went wrong, in place of the table
static void add_counters( results* out, const wisp_world* world, bool is_brief )
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
        [WISP_COUNT_INDEFINITE] = "solves that met negative curvature and stopped",
        [WISP_COUNT_DEGENERATE_LINK] = "links between coincident vertices: no direction, no force",
        [WISP_COUNT_STIFFNESS_CLAMPED] = "substeps with links too stiff for floats: stiffness was lowered",
        [WISP_COUNT_FIRST_ORDER] = "substeps of BDF2 (of cloth, of each strand) that were made by implicit Euler",
        [WISP_COUNT_GRAVITY_SCALED] = "strands with reduced gravity: substeps too long to hold their shape",
        [WISP_COUNT_SAGGING] = "strands too soft to hold their shape under gravity: they sag",
        [WISP_COUNT_STRETCHED] =
            "strands over 5 % too long in a step: links need stretch: direct, contact more substeps",
        [WISP_COUNT_SPEED_LIMITED] = "velocities of vertices scaled down to the largest speed, in each substep",
        [WISP_COUNT_MANY_SOLVES] = "substeps of implicit cloth with over three solves: more substeps cost less",
        [WISP_COUNT_SPLIT_VERTICES] = "vertices that tearing has split",
        [WISP_COUNT_CUT_STEPS] = "steps longer than eight usual ones: the rest of their time was left out",
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
        if ( is_brief )
        {
            if ( !is_usual( (wisp_counter)i ) )
            {
                results_add_note( out, "%s: %llu %s", wisp_counter_name( (wisp_counter)i ), (unsigned long long)count,
                                  MEANINGS[i] );
            }
            continue;
        }
        if ( table < 0 )
        {
            table = results_begin_table( out, "Counters that are not zero", "counter\tvalue\tmeaning" );
        }
        results_add_line( out, table, "%s\t%llu\t%s", wisp_counter_name( (wisp_counter)i ), (unsigned long long)count,
                          MEANINGS[i] );
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

static void add_run_row( results* out, const scene_world* world, run_record* record, stats_summary times )
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
    put_memory( world->world, &row->size );
    run_contact_put( record->contact, &row->size );
}

void run_summarise( const scene_world* world, run_record* record, const run_recorder_def* recorder,
                    run_recorder_counts counts, bool is_brief, results* out )
{
    out->machine = machine_describe( wisp_world_isa( world->world ) );
    out->is_result_first = true;
    stats_summary times = stats_summarise( record->ms, record->steps );
    times.cpu_fraction = 1e3 * record->cpu_seconds / sum( record->ms, record->steps );
    add_run_row( out, world, record, times );
    add_head( out, world, record, times, recorder, counts );
    out->is_brief = is_brief;
    if ( record->steps > 0 )
    {
        add_motion_table( world, out );
        add_detail_table( world, out );
        run_contact_report( record->contact, out );
        if ( record->profile.pass_count > 0 )
        {
            add_pass_table( out, record );
        }
        report_memory( world->world, scene_world_vertices( world ), out );
        add_motion_warnings( world, out );
    }
    add_counters( out, world->world, is_brief );
    for ( int i = 0; i < world->note_count; ++i )
    {
        results_add_note( out, "%s", world->notes[i] );
    }
    add_command_note( out, world );
    add_solver_notes( out, world );
    run_contact_report_steps( record->contact, out );
}
