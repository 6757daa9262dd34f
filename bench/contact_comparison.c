#include "contact_comparison.h"

#include <math.h>
#include <stdlib.h>

enum
{
    TURN_STEPS = 10, // steps are milliseconds: what the other worlds left in the caches is soon forgotten
};

// ---- figures ----

static wisp_status read_speed( contact_world* world, double* speed, wisp_error* error )
{
    *speed = 0.0;
    for ( int i = 0; i < world->surface_count; ++i )
    {
        wisp_motion_stats motion_stats;
        const wisp_status status = wisp_read_motion_stats( world->world, world->surfaces[i], &motion_stats );
        if ( status != WISP_OK )
        {
            return bench_world_fail( world->world, status, error );
        }
        *speed = fmax( *speed, motion_stats.speed_max );
    }
    return WISP_OK;
}

static wisp_status count_stats( contact_run* run, wisp_error* error )
{
    contact_tally* t = &run->tally;
    wisp_contact_stats f = { 0 };
    const wisp_status status = wisp_read_contact_stats( run->seen.world, &f );
    if ( status != WISP_OK )
    {
        return bench_world_fail( run->seen.world, status, error );
    }
    t->pairs += (double)f.candidates;
    t->contacts += f.contacts;
    t->searches += f.searches;
    t->intersections_last = f.intersections;
    t->max_intersections = f.intersections > t->max_intersections ? f.intersections : t->max_intersections;
    t->crossed_steps += f.intersections > 0 ? 1 : 0;
    t->min_gap = fminf( t->min_gap, f.min_gap );
    t->limited += f.displacement_limited;
    t->impulse = f.impulse;
    for ( int k = 0; k < 3; ++k )
    {
        t->unbalanced = fmax( t->unbalanced, fabs( f.net_impulse[k] ) );
    }
    return read_speed( &run->seen, &t->speed, error );
}

// ---- worlds ----

static wisp_status enter( const contact_comparison* comparison, const contact_way* way, contact_run* run,
                          wisp_error* error )
{
    *run = ( contact_run ){ .way = *way, .tally = { .min_gap = INFINITY } };
    contact_setting setting = { .way = *way };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < comparison->teams->count && status == WISP_OK; ++i )
    {
        setting.workers = comparison->teams->workers[i];
        status = comparison->enter( comparison->scene, &setting, &run->timed[i], error );
        run->ms[i] = calloc( (size_t)comparison->steps, sizeof( double ) );
        if ( status == WISP_OK && run->ms[i] == NULL )
        {
            status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
        }
    }
    setting.requests_stats = true;
    return status == WISP_OK ? comparison->enter( comparison->scene, &setting, &run->seen, error ) : status;
}

static void leave( contact_run* run )
{
    for ( int i = 0; i < CONTACT_TEAMS_MAX; ++i )
    {
        contact_leave( &run->timed[i] );
        free( run->ms[i] );
        run->ms[i] = NULL;
    }
    contact_leave( &run->seen );
}

// ---- turns ----

static wisp_status time_turn( contact_run* run, int team, int first, int last, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = first; s < last && status == WISP_OK; ++s )
    {
        const double begin = wisp_clock_seconds();
        status = contact_step( &run->timed[team], error );
        run->ms[team][s] = 1e3 * ( wisp_clock_seconds() - begin );
    }
    return status;
}

static wisp_status observe_turn( const contact_comparison* comparison, contact_run* run, int number, int first,
                                 int last, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = first; s < last && status == WISP_OK; ++s )
    {
        status = contact_step( &run->seen, error );
        status = status == WISP_OK ? count_stats( run, error ) : status;
        const bool is_due = comparison->observe != NULL &&
                            ( ( s + 1 ) % comparison->observe_every == 0 || s + 1 == comparison->steps );
        if ( status == WISP_OK && is_due )
        {
            status = comparison->observe( run, number, comparison->context, error );
        }
    }
    return status;
}

static wisp_status take_turn( const contact_comparison* comparison, contact_run* run, int number, int first,
                              wisp_error* error )
{
    const int last = first + TURN_STEPS < comparison->steps ? first + TURN_STEPS : comparison->steps;
    const double begin = wisp_clock_seconds();
    wisp_status status = WISP_OK;
    for ( int i = 0; i < comparison->teams->count && status == WISP_OK; ++i )
    {
        status = time_turn( run, i, first, last, error );
    }
    status = status == WISP_OK ? observe_turn( comparison, run, number, first, last, error ) : status;
    run->steps = last;
    run->seconds += wisp_clock_seconds() - begin;
    return status;
}

static wisp_status conclude( const contact_comparison* comparison, contact_run* run, wisp_error* error )
{
    wisp_status status = contact_hash( &run->seen, &run->hash, error );
    run->same_hash = true;
    run->tally.halted_at = run->seen.halted_at;
    for ( int i = 0; i < comparison->teams->count && status == WISP_OK; ++i )
    {
        uint64_t hash = 0;
        status = contact_hash( &run->timed[i], &hash, error );
        run->same_hash = run->same_hash && hash == run->hash;
        run->mean[i] = 0.0;
        for ( int s = 0; s < run->steps; ++s )
        {
            run->mean[i] += run->ms[i][s] / run->steps;
        }
        run->time[i] = stats_summarise( run->ms[i], run->steps );
        run->worst[i] = run->ms[i][run->steps - 1]; // they rise now
    }
    double* const means[] = { &run->tally.pairs, &run->tally.contacts, &run->tally.searches };
    for ( int k = 0; k < WISP_COUNT( means ); ++k )
    {
        *means[k] = run->way.is_off ? NAN : *means[k] / run->steps;
    }
    return status;
}

wisp_status contact_comparison_run( const contact_comparison* comparison, contact_run* runs, wisp_error* error )
{
    wisp_status status = WISP_OK;
    int entered = 0;
    for ( ; entered < comparison->way_count && status == WISP_OK; ++entered )
    {
        status = enter( comparison, comparison->ways + entered, runs + entered, error );
    }
    for ( int first = 0; first < comparison->steps && status == WISP_OK; first += TURN_STEPS )
    {
        bench_progress( comparison->options, comparison->begin + comparison->span * first / comparison->steps,
                        comparison->name );
        for ( int i = 0; i < comparison->way_count && status == WISP_OK; ++i )
        {
            const bool is_late = runs[i].seconds > comparison->seconds;
            status = is_late ? WISP_OK : take_turn( comparison, runs + i, i, first, error );
        }
    }
    for ( int i = 0; i < comparison->way_count && status == WISP_OK; ++i )
    {
        status = conclude( comparison, runs + i, error );
    }
    for ( int i = 0; i < entered; ++i )
    {
        leave( runs + i );
    }
    return status;
}

// ---- rows ----

void contact_comparison_add_rows( const contact_comparison* comparison, const contact_run* run, results* out )
{
    const contact_tally* t = &run->tally;
    for ( int i = 0; i < comparison->teams->count; ++i )
    {
        results_row* row = results_add_row( out, comparison->name, run->way.name );
        if ( row == NULL )
        {
            return;
        }
        results_put( &row->size, "vertices", comparison->scene->mesh.vertex_count );
        if ( run->way.is_off == false )
        {
            results_put( &row->size, "pairs", t->pairs );
            results_put( &row->size, "searches", t->searches );
        }
        row->workers = comparison->teams->workers[i];
        row->steps = run->steps;
        results_put_times( row, &run->time[i] );
        results_put( &row->stages, "mean", run->mean[i] );
        results_put( &row->stages, "worst", run->worst[i] );
        snprintf( row->error_reference, sizeof( row->error_reference ), "exact signs" );
        results_put( &row->error, "intersections_last", t->intersections_last );
        results_put( &row->error, "max_intersections", t->max_intersections );
        results_put( &row->error, "crossed_steps", t->crossed_steps );
        results_put( &row->error, "guarded", (double)t->limited );
        results_put( &row->error, "unbalanced_Ns", t->unbalanced );
        results_put( &row->error, "speed_m_s", t->speed );
        if ( isfinite( t->min_gap ) )
        {
            results_put( &row->error, "min_gap", (double)t->min_gap );
        }
        row->hash = run->hash;
        row->has_hash = true;
    }
}

int contact_comparison_begin_table( const contact_comparison* comparison, cells* header, const char* const* names,
                                    int name_count, const char* title, results* out )
{
    for ( int i = 0; i < comparison->teams->count; ++i )
    {
        cells_put( header, "ms median / mean / worst, %d w", comparison->teams->workers[i] );
    }
    for ( int i = 0; i < name_count; ++i )
    {
        cells_put( header, "%s", names[i] );
    }
    return cells_begin_table( header, title, out );
}

void contact_comparison_put_times( const contact_comparison* comparison, const contact_run* run, cells* row )
{
    for ( int i = 0; i < comparison->teams->count; ++i )
    {
        cells_put( row, "%.2f / %.2f / %.1f", run->time[i].median, run->mean[i], run->worst[i] );
    }
}

void contact_comparison_check( const contact_comparison* comparison, const contact_run* run, results* out )
{
    if ( run->same_hash == false )
    {
        results_add_failure( out, "%s, %s: the result depends on the number of workers, or on sampling.",
                             comparison->name, run->way.name );
    }
    if ( run->tally.halted_at > 0 )
    {
        results_add_failure( out, "%s, %s: a surface left its bounds at step %d.", comparison->name, run->way.name,
                             run->tally.halted_at );
    }
}
