// What finding pairs costs: the grid, Embree's tree and brute force on the same boxes, with the same answers.
#include "contact_bench.h"
#include "contact_probe.h"
#include "contact_query_input.h"
#include "bench_timing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    ROUNDS_MIN = 3,
    ROUNDS_MAX = 60,
    SAMPLE = 256, // queries that brute force answers for where there are too many of them
    SEARCHES = 3,
    IMPLEMENTATIONS = SEARCHES * CONTACT_TEAMS_MAX,
};

static const struct
{
    const char* name;
    wisp_pair_search search;
} searches[SEARCHES] = {
    { "grid", WISP_PAIR_SEARCH_GRID },
    { "tree", WISP_PAIR_SEARCH_TREE },
    { "brute force", WISP_PAIR_SEARCH_BRUTE },
};

typedef enum query_time
{
    BUILD, // the grid, which is built for each search; the tree from nothing
    REFIT, // the tree, when boxes have moved
    QUERY,
    QUERY_TIMES,
} query_time;

static const char* const time_names[QUERY_TIMES] = { "build", "refit", "query" };

/// One search method with a number of workers.
typedef struct query_implementation
{
    int search, team; // numbers
    const query_input_boxes* query_input;
    contact_probe probe;
    wisp_aabb_pairs pairs;
    double now[QUERY_TIMES]; // s, of the last round; NaN: does not happen
    double samples[QUERY_TIMES][ROUNDS_MAX];
    double middle[QUERY_TIMES], p10, p90; // s, medians; of queries the quantiles
    int rounds;
    bool same;
} query_implementation;

/// All implementations of one kind of boxes.
typedef struct query_contest
{
    const contact_plan* plan;
    query_input_source source;
    query_input_kind kind;
    query_input_boxes query_input;
    query_implementation implementations[IMPLEMENTATIONS];
    int count;
} query_contest;

// ---- a round ----

static wisp_aabb_args job_of( const query_input_boxes* query_input, int time, wisp_pair_search search )
{
    return ( wisp_aabb_args ){
        .queries = query_input->queries[time],
        .query_count = query_input->query_count,
        .boxes = query_input->boxes[time],
        .box_count = query_input->box_count,
        .search = search,
    };
}

// A tree is built again when the set of boxes changes: here when there is one more.
static wisp_status build_tree( query_implementation* e, const wisp_parallel* parallel, wisp_aabb_args args,
                               wisp_error* error )
{
    args.box_count -= 1;
    const wisp_status status = wisp_aabb_pairs_find( &e->pairs, parallel, &args, error );
    args.box_count += 1;
    return status == WISP_OK ? wisp_aabb_pairs_find( &e->pairs, parallel, &args, error ) : status;
}

static wisp_status search_round( void* context, const wisp_parallel* parallel, const wisp_kernels* kernels,
                                 wisp_error* error )
{
    query_implementation* e = context;
    const wisp_pair_search search = searches[e->search].search;
    wisp_aabb_args args = job_of( e->query_input, QUERY_INPUT_BEFORE, search );
    args.kernels = kernels;
    wisp_status status = WISP_OK;
    e->now[BUILD] = e->now[REFIT] = NAN;
    if ( search == WISP_PAIR_SEARCH_TREE )
    {
        status = build_tree( e, parallel, args, error );
        e->now[BUILD] = e->pairs.build_seconds;
    }
    const int refits = e->pairs.refit_count;
    args = job_of( e->query_input, QUERY_INPUT_AFTER, search );
    args.kernels = kernels;
    status = status == WISP_OK ? wisp_aabb_pairs_find( &e->pairs, parallel, &args, error ) : status;
    if ( search == WISP_PAIR_SEARCH_GRID )
    {
        e->now[BUILD] = e->pairs.build_seconds;
    }
    if ( e->pairs.refit_count > refits )
    {
        e->now[REFIT] = e->pairs.build_seconds;
    }
    e->now[QUERY] = e->pairs.query_seconds;
    return status;
}

static wisp_status step( void* context, wisp_error* error )
{
    query_implementation* e = context;
    return contact_probe_run( &e->probe, search_round, e, error );
}

static wisp_status keep_times( void* context )
{
    query_implementation* e = context;
    for ( int k = 0; k < QUERY_TIMES && e->rounds < ROUNDS_MAX; ++k )
    {
        e->samples[k][e->rounds] = e->now[k];
    }
    e->rounds += e->rounds < ROUNDS_MAX ? 1 : 0;
    return WISP_OK;
}

static void summarise( query_implementation* e )
{
    for ( int k = 0; k < QUERY_TIMES; ++k )
    {
        const bool happens = isfinite( e->now[k] );
        const stats_summary all = stats_summarise( e->samples[k], happens ? e->rounds : 0 );
        e->middle[k] = all.median;
        e->p10 = k == QUERY ? all.p10 : e->p10;
        e->p90 = k == QUERY ? all.p90 : e->p90;
    }
}

// ---- are they the same ----

static bool are_same( const wisp_aabb_pairs* a, const wisp_aabb_pairs* b )
{
    return a->query_count == b->query_count && a->pair_count == b->pair_count &&
           memcmp( a->begin, b->begin, ( (size_t)a->query_count + 1 ) * sizeof( int32_t ) ) == 0 &&
           ( a->pair_count == 0 || memcmp( a->item, b->item, a->pair_count * sizeof( int32_t ) ) == 0 );
}

/// Some queries, spread over all, and what brute force finds for them.
typedef struct query_sample
{
    const query_input_boxes* query_input;
    wisp_aabb boxes[SAMPLE];
    int query[SAMPLE], count;
    wisp_aabb_pairs pairs;
} query_sample;

static wisp_status ask_sample( void* context, const wisp_parallel* parallel, const wisp_kernels* kernels,
                               wisp_error* error )
{
    query_sample* s = context;
    wisp_aabb_args args = job_of( s->query_input, QUERY_INPUT_AFTER, WISP_PAIR_SEARCH_BRUTE );
    args.queries = s->boxes;
    args.query_count = s->count;
    args.kernels = kernels;
    return wisp_aabb_pairs_find( &s->pairs, parallel, &args, error );
}

// Where boxes ask each other, a pair is named by the lower one.
static bool has_sample( const wisp_aabb_pairs* all, const query_sample* s )
{
    const bool is_self = s->query_input->queries[QUERY_INPUT_AFTER] == NULL;
    bool same = true;
    for ( int i = 0; i < s->count && same; ++i )
    {
        int at = all->begin[s->query[i]];
        for ( int k = s->pairs.begin[i]; k < s->pairs.begin[i + 1] && same; ++k )
        {
            if ( is_self == false || s->pairs.item[k] > s->query[i] )
            {
                same = at < all->begin[s->query[i] + 1] && all->item[at] == s->pairs.item[k];
                ++at;
            }
        }
        same = same && at == all->begin[s->query[i] + 1];
    }
    return same;
}

static wisp_status compare( query_contest* c, wisp_error* error )
{
    query_sample* sample = calloc( 1, sizeof( query_sample ) );
    if ( sample == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d boxes", SAMPLE );
    }
    const wisp_aabb* queries = c->query_input.queries[QUERY_INPUT_AFTER] ? c->query_input.queries[QUERY_INPUT_AFTER]
                                                                         : c->query_input.boxes[QUERY_INPUT_AFTER];
    sample->query_input = &c->query_input;
    sample->count = c->query_input.query_count < SAMPLE ? c->query_input.query_count : SAMPLE;
    for ( int i = 0; i < sample->count; ++i )
    {
        sample->query[i] = (int)( (int64_t)c->query_input.query_count * i / sample->count );
        sample->boxes[i] = queries[sample->query[i]];
    }
    contact_probe* probe = &c->implementations[0].probe;
    const wisp_status status = contact_probe_run( probe, ask_sample, sample, error );
    for ( int i = 0; i < c->count && status == WISP_OK; ++i )
    {
        const wisp_aabb_pairs* pairs = &c->implementations[i].pairs;
        c->implementations[i].same = are_same( pairs, &c->implementations[0].pairs ) && has_sample( pairs, sample );
    }
    wisp_aabb_pairs_release( &sample->pairs, contact_probe_allocator( probe ) );
    free( sample );
    return status;
}

// ---- a contest ----

static double count_compared( const query_input_boxes* query_input )
{
    const double all = (double)query_input->query_count * query_input->box_count;
    return query_input->queries[0] != NULL ? all : 0.5 * all;
}

static wisp_status enter( query_contest* c, bench_variant* variants, wisp_error* error )
{
    const int count = count_compared( &c->query_input ) <= c->plan->max_brute ? SEARCHES : SEARCHES - 1;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count * c->plan->teams.count && status == WISP_OK; ++i )
    {
        query_implementation* e = c->implementations + i;
        *e = ( query_implementation ){ .search = i % count, .team = i / count, .query_input = &c->query_input };
        variants[i] =
            ( bench_variant ){ .name = searches[e->search].name, .step = step, .after = keep_times, .context = e };
        status = contact_probe_open( c->plan->teams.workers[e->team], &e->probe, error );
        c->count += status == WISP_OK ? 1 : 0;
    }
    return status;
}

static void leave( query_contest* c )
{
    for ( int i = 0; i < c->count; ++i )
    {
        query_implementation* e = c->implementations + i;
        wisp_aabb_pairs_release( &e->pairs, contact_probe_allocator( &e->probe ) );
        contact_probe_close( &e->probe );
    }
    c->count = 0;
    query_input_free_boxes( &c->query_input );
}

static void add_row( const query_contest* c, const query_implementation* e, results* out )
{
    char variant[64];
    snprintf( variant, sizeof( variant ), "%s, %s, %s", query_input_source_names[c->source],
              query_input_kind_names[c->kind], searches[e->search].name );
    results_row* row = results_add_row( out, "contact.queries", variant );
    if ( row == NULL )
    {
        return;
    }
    results_put( &row->size, "particles", c->query_input.particle_count );
    results_put( &row->size, "queries", c->query_input.query_count );
    results_put( &row->size, "boxes", c->query_input.box_count );
    results_put( &row->size, "pairs", (double)e->pairs.pair_count );
    row->workers = c->plan->teams.workers[e->team];
    row->steps = e->rounds;
    row->ms_median = 1e3 * e->middle[QUERY];
    row->ms_p10 = 1e3 * e->p10;
    row->ms_p90 = 1e3 * e->p90;
    for ( int k = 0; k < QUERY_TIMES; ++k )
    {
        if ( isfinite( e->middle[k] ) )
        {
            results_put( &row->stages, time_names[k], 1e3 * e->middle[k] );
        }
    }
}

static void add_line( const query_contest* c, const query_implementation* first, int table, results* out )
{
    const wisp_aabb_args free_choice = job_of( &c->query_input, QUERY_INPUT_AFTER, WISP_PAIR_SEARCH_AUTO );
    const int stride = c->count / c->plan->teams.count;
    const bool is_taken = wisp_aabb_pairs_choose( &free_choice ) == searches[first->search].search;
    bool same = true;
    cells row = { .count = 0 };
    cells_put( &row, "%s", query_input_source_names[c->source] );
    cells_put( &row, "%s", query_input_kind_names[c->kind] );
    cells_put( &row, "%d", c->query_input.query_count );
    cells_put( &row, "%d", c->query_input.box_count );
    cells_put( &row, "%s%s", searches[first->search].name, is_taken ? " (auto)" : "" );
    for ( int team = 0; team < c->plan->teams.count; ++team )
    {
        const query_implementation* e = first + team * stride;
        cells_put_number( &row, 1e3 * e->middle[BUILD], 3 );
        cells_put_number( &row, 1e3 * e->middle[REFIT], 3 );
        cells_put_number( &row, 1e3 * e->middle[QUERY], 3 );
        cells_put_number( &row, 1e9 * e->middle[QUERY] / c->query_input.query_count, 0 );
        same = same && e->same;
    }
    cells_put( &row, "%zu", first->pairs.pair_count );
    cells_put_number( &row, (double)first->pairs.tested / c->query_input.query_count, 1 );
    cells_put( &row, "%s", same ? "yes" : "NO" );
    cells_end_row( &row, table, out );
    if ( same == false )
    {
        results_add_failure( out, "Of %d %s of the %s the %s finds other pairs.", c->query_input.query_count,
                             query_input_kind_names[c->kind], query_input_source_names[c->source],
                             searches[first->search].name );
    }
}

static wisp_status run_contest( query_contest* c, const query_input_mesh* mesh, double seconds, int table,
                                results* out, wisp_error* error )
{
    bench_variant variants[IMPLEMENTATIONS] = { { 0 } };
    const bench_effort effort = { seconds, ROUNDS_MIN, ROUNDS_MAX };
    wisp_status status = query_input_make_boxes( mesh, c->kind, &c->query_input, error );
    status = status == WISP_OK ? enter( c, variants, error ) : status;
    if ( status == WISP_OK )
    {
        status = bench_interleave( variants, c->count, &effort, error );
        bench_free_samples( variants, c->count );
    }
    status = status == WISP_OK ? compare( c, error ) : status;
    for ( int i = 0; i < c->count && status == WISP_OK; ++i )
    {
        summarise( c->implementations + i );
        add_row( c, c->implementations + i, out );
    }
    for ( int i = 0; i < c->count / c->plan->teams.count && status == WISP_OK; ++i )
    {
        add_line( c, c->implementations + i, table, out );
    }
    leave( c );
    return status;
}

// ---- the table ----

static int begin_table( const contact_plan* plan, results* out )
{
    cells header = { .count = 0 };
    static const char* const first[] = { "source", "what", "queries", "boxes", "search" };
    static const char* const last[] = { "pairs", "visited", "same" };
    for ( int i = 0; i < WISP_COUNT( first ); ++i )
    {
        cells_put( &header, "%s", first[i] );
    }
    for ( int team = 0; team < plan->teams.count; ++team )
    {
        const int w = plan->teams.workers[team];
        cells_put( &header, "build ms, %d w", w );
        cells_put( &header, "refit ms, %d w", w );
        cells_put( &header, "query ms, %d w", w );
        cells_put( &header, "ns per query, %d w", w );
    }
    for ( int i = 0; i < WISP_COUNT( last ); ++i )
    {
        cells_put( &header, "%s", last[i] );
    }
    return cells_begin_table( &header, "Contact, queries: pairs of boxes as contact searches for them, medians",
                              out );
}

static wisp_status run_mesh( query_contest* c, int size, double seconds, int table, results* out, wisp_error* error )
{
    query_input_mesh mesh;
    wisp_status status = query_input_make_mesh( c->source, size, &mesh, error );
    for ( int kind = 0; kind < QUERY_INPUT_KINDS && status == WISP_OK; ++kind )
    {
        c->kind = (query_input_kind)kind;
        status = run_contest( c, &mesh, seconds / QUERY_INPUT_KINDS, table, out, error );
    }
    query_input_free_mesh( &mesh );
    return status;
}

wisp_status contact_queries( const contact_plan* plan, results* out, wisp_error* error )
{
    const int count = QUERY_INPUT_SOURCES * plan->size_count;
    query_contest* c = calloc( 1, sizeof( query_contest ) );
    if ( c == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
    }
    const int table = begin_table( plan, out );
    wisp_status status = WISP_OK;
    c->plan = plan;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        bench_progress( plan->options, 0.3 * i / count, "contact, queries" );
        c->source = (query_input_source)( i / plan->size_count );
        const int* sizes = c->source == QUERY_INPUT_SHEET ? plan->sheet_sides : plan->sphere_levels;
        status = run_mesh( c, sizes[i % plan->size_count], plan->query_seconds / count, table, out, error );
    }
    free( c );
    results_add_note(
        out,
        "Contact, queries: after boxes moved by their reach the tree is refitted; the grid is rebuilt for every "
        "search. Brute force runs up to %.0e comparisons. (auto): the default. visited: boxes per query.",
        plan->max_brute );
    results_add_note(
        out,
        "Contact, queries: same: the lists of all, with every worker count, agree to the last pair and in order, and "
        "with brute force for %d of the queries.",
        SAMPLE );
    return status;
}
