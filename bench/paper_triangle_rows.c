// The tables of the triangle cloth: Table 1 of Noh and Jung, triangles against quads, growth with the mesh.
#include "paper_triangle.h"

#include "rows_chart.h"

#include <math.h>
#include <string.h>

// Targets of this table.
#define SOURCE_RATIO 1.28         // per particle: 1.058 ms of triangles over 0.826 ms of quads
#define CLAIM_LARGE 10000         // from this many vertices on, an iteration costs at most ...
#define CLAIM_ITERATION_NS 20.0   // ... with 1 worker, per vertex
#define CLAIM_ITERATION_NS_2 12.0 // ... with 2
#define CLAIM_GROWTH 0.5          // iterations grow at most with this power of the vertex count

static int links_of( const triangle_line* line )
{
    return line->stretch_links + line->bend_links;
}

static const char* mesh_of( const triangle_line* line )
{
    return line->drop->vertices > 0 ? "triangles" : "quads";
}

// ---- Table 1 ----

static int begin_table( const triangle_plan* plan, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "mesh" );
    cells_put( &row, "vertices" );
    cells_put( &row, "links" );
    cells_put( &row, "k_s N/m" );
    cells_put( &row, "steps" );
    cells_put( &row, "Noh and Jung s per frame" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%d %s ms mean", plan->workers[w], bench_workers_word( plan->workers[w] ) );
        cells_put( &row, "%d %s ms median", plan->workers[w], bench_workers_word( plan->workers[w] ) );
    }
    cells_put( &row, "speedup over Noh and Jung" );
    cells_put( &row, "iterations, mean / max" );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put( &row, "%d %s ns per vertex, iteration", plan->workers[w], bench_workers_word( plan->workers[w] ) );
    }
    cells_put( &row, "us per vertex" );
    cells_put( &row, "ns per link" );
    cells_put( &row, "contacts at the end" );
    cells_put( &row, "unsolved / indefinite" );
    cells_put( &row, "hash" );
    return cells_begin_table( &row,
                              "Triangle cloth, Noh and Jung, Table 1: 1 m x 1 m falls onto a ball, whole step with "
                              "collision, dt 0.01 s, one solve",
                              out );
}

static void add_line( const triangle_plan* plan, const triangle_line* line, int table, results* out )
{
    cells row = { .count = 0 };
    cells_put( &row, "%s", mesh_of( line ) );
    cells_put( &row, "%d", line->vertices );
    cells_put( &row, "%d", links_of( line ) );
    cells_put_number( &row, (double)line->drop->stretch_stiffness, 0 );
    cells_put( &row, "%d", line->drop->steps );
    cells_put_number( &row, 1e-3 * line->drop->source_ms, 3 );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put_number( &row, line->mean_ms[w], 3 );
        cells_put_number( &row, line->ms[w].median, 3 );
    }
    cells_put_number( &row, line->drop->source_ms / line->mean_ms[0], 0 );
    cells_put( &row, "%.1f / %d", line->iterations_mean, line->max_iterations );
    for ( int w = 0; w < plan->worker_count; ++w )
    {
        cells_put_number( &row, line->iteration_ns[w], 1 );
    }
    cells_put_number( &row, 1e3 * line->mean_ms[0] / line->vertices, 3 );
    cells_put_number( &row, 1e6 * line->mean_ms[0] / links_of( line ), 1 );
    cells_put( &row, "%d", line->contacts );
    cells_put( &row, "%llu / %llu", (unsigned long long)line->unsolved, (unsigned long long)line->indefinite );
    cells_put_hash( &row, line->hash );
    cells_end_row( &row, table, out );
}

// ---- triangles and quads ----

static const triangle_line* find_quads( const triangle_plan* plan, const triangle_line* lines,
                                        const triangle_line* triangles )
{
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        const bool is_same = lines[i].drop->stretch_stiffness == triangles->drop->stretch_stiffness;
        if ( lines[i].drop->vertices == 0 && lines[i].drop->is_timed && is_same )
        {
            return &lines[i];
        }
    }
    return NULL;
}

static void add_ratio( const triangle_plan* plan, const triangle_line* triangles, const triangle_line* quads, int w,
                       int table, results* out )
{
    const double a = triangles->mean_ms[w], b = quads->mean_ms[w];
    const double a_vertex = 1e3 * a / triangles->vertices, b_vertex = 1e3 * b / quads->vertices;
    const double a_link = 1e6 * a / links_of( triangles ), b_link = 1e6 * b / links_of( quads );
    const double source_a = triangles->drop->source_ms / triangles->vertices;
    const double source_b = quads->drop->source_ms / quads->vertices;
    cells row = { .count = 0 };
    cells_put_number( &row, (double)triangles->drop->stretch_stiffness, 0 );
    cells_put( &row, "%d", plan->workers[w] );
    cells_put_pair( &row, a_vertex, 3, b_vertex, 3 );
    cells_put_number( &row, a_vertex / b_vertex, 2 );
    cells_put_number( &row, source_a / source_b, 2 );
    cells_put_pair( &row, a_link, 1, b_link, 1 );
    cells_put_number( &row, a_link / b_link, 2 );
    cells_put_pair( &row, (double)links_of( triangles ) / triangles->vertices, 1,
                    (double)links_of( quads ) / quads->vertices, 1 );
    cells_put_pair( &row, triangles->iterations_mean, 1, quads->iterations_mean, 1 );
    cells_end_row( &row, table, out );
}

static void add_ratios( const triangle_plan* plan, const triangle_line* lines, results* out )
{
    static const char* const names[] = {
        "k_s N/m",     "workers", "us per vertex",    "ratio",     "ratio, Noh and Jung",
        "ns per link", "ratio",   "links per vertex", "iterations"
    };
    cells header = { .count = 0 };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    const int table = cells_begin_table( &header, "Triangles / quads: mean time of a step over the whole run", out );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        const triangle_line* line = &lines[i];
        const bool is_source = line->drop->vertices > 0 && isfinite( line->drop->source_ms ) && line->drop->is_timed;
        const triangle_line* quads = is_source ? find_quads( plan, lines, line ) : NULL;
        for ( int w = 0; w < plan->worker_count && quads; ++w )
        {
            add_ratio( plan, line, quads, w, table, out );
        }
    }
}

// ---- growth ----

// iterations = c vertices^slope, by least squares of logarithms.
static stats_line fit_growth( const triangle_plan* plan, const triangle_line* lines )
{
    double x[TRIANGLE_ROWS_MAX], y[TRIANGLE_ROWS_MAX];
    int count = 0;
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        if ( lines[i].drop->grows )
        {
            x[count] = log( lines[i].vertices );
            y[count++] = log( lines[i].growth_mean );
        }
    }
    return stats_fit_line( x, y, count );
}

static void add_growth_line( const triangle_line* first, const triangle_line* before, const triangle_line* line,
                             int table, results* out )
{
    const double grown = line->growth_mean / first->growth_mean;
    const double root = sqrt( (double)line->vertices / first->vertices );
    cells row = { .count = 0 };
    cells_put( &row, "%d", line->vertices );
    cells_put_number( &row, line->growth_mean, 1 );
    cells_put_number( &row, grown, 2 );
    cells_put_number( &row, root, 2 );
    cells_put_number( &row, grown / root, 2 );
    cells_put_number( &row,
                      before ? log( line->growth_mean / before->growth_mean ) /
                                   log( (double)line->vertices / before->vertices )
                             : NAN,
                      3 );
    cells_end_row( &row, table, out );
}

static void add_growth( const triangle_plan* plan, const triangle_line* lines, results* out )
{
    char title[160];
    snprintf( title, sizeof( title ),
              "Growth of conjugate gradients at fixed material: iterations per step, steps %d to %d of the fall",
              plan->touch_step + 1, plan->touch_step + plan->growth_steps );
    static const char* const names[] = { "vertices",     "iterations", "iterations / first",
                                         "sqrt of size", "of that",    "exponent here" };
    cells header = { .count = 0 };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        cells_put( &header, "%s", names[i] );
    }
    const int table = cells_begin_table( &header, title, out );
    const triangle_line *first = NULL, *before = NULL;
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        if ( lines[i].drop->grows )
        {
            first = first ? first : &lines[i];
            add_growth_line( first, before, &lines[i], table, out );
            before = &lines[i];
        }
    }
    const stats_line fit = fit_growth( plan, lines );
    char claim[160];
    snprintf( claim, sizeof( claim ),
              "iterations of conjugate gradients grow no faster than vertices^%.1f (exponent fitted with R^2 = %.4f)",
              CLAIM_GROWTH, fit.r_squared );
    results_add_claim( out, fit.slope <= CLAIM_GROWTH, claim, fit.slope, "" );
    results_row* row = results_add_row( out, "paper.triangle_growth", "exponent" );
    if ( row )
    {
        results_put( &row->size, "exponent", fit.slope );
        results_put( &row->size, "r_squared", fit.r_squared );
    }
}

// ---- the messages ----

static void claim_iterations( const triangle_plan* plan, const triangle_line* line, results* out )
{
    for ( int w = 0; w < plan->worker_count && line->vertices >= CLAIM_LARGE; ++w )
    {
        const double most = plan->workers[w] == 1   ? CLAIM_ITERATION_NS
                            : plan->workers[w] == 2 ? CLAIM_ITERATION_NS_2
                                                    : NAN;
        if ( isfinite( most ) && line->drop->is_timed )
        {
            char claim[160];
            snprintf( claim, sizeof( claim ), "%d vertices, %d %s: an iteration costs at most %.0f ns per vertex",
                      line->vertices, plan->workers[w], bench_workers_word( plan->workers[w] ), most );
            results_add_claim( out, line->iteration_ns[w] <= most, claim, line->iteration_ns[w], " ns" );
        }
    }
}

static void add_reading( const triangle_plan* plan, const triangle_line* lines, results* out )
{
    results_add_note( out,
                      "Noh and Jung: Core 2 Duo without a clock rate; masses, lengths, ball and solver are not "
                      "given. Per step of 0.01 s with collision: 1.014 s for 958 particles, 0.516 s for 625. Compare "
                      "the ratio per particle, %.2f, not absolute times.",
                      SOURCE_RATIO );
    results_add_note( out, "Wisp: 0.2 kg/m^2, k_b 1e-6 N m^2, k_d 0.02 N s/m, ball of radius 0.25 m, margin 5 mm, "
                           "friction 0.3 and 0.2, tolerance 1e-4, one substep, steps from the start of the fall." );
    results_add_note(
        out, "Times are of all steps; us per vertex, ns per link and speedup over Noh and Jung are means with 1 "
             "worker. Iterations come from a separate run with statistics, whose hash must be the same." );
    results_add_note( out, "ns per vertex and iteration: the whole solver pass with assembly; the median over steps "
                           "with at least a quarter of the most iterations." );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        if ( lines[i].unsolved + lines[i].indefinite > 0 )
        {
            results_add_note( out,
                              "%d vertices, k_s %.0f: %llu solves ended unconverged, %llu met negative curvature.",
                              lines[i].vertices, (double)lines[i].drop->stretch_stiffness,
                              (unsigned long long)lines[i].unsolved, (unsigned long long)lines[i].indefinite );
        }
    }
}

static double mean_ms_of( const results_row* row )
{
    // Noh and Jung state one time, the mean.
    return strcmp( row->variant, "source" ) == 0 ? row->ms_median : rows_size( row, "ms_mean" );
}

static void add_chart( results* out )
{
    rows_chart_add( &( rows_chart ){ .name = "paper.triangle_cloth",
                                     .also = "stretch_stiffness",
                                     .also_unit = "N/m",
                                     .title = "Triangle cloth that falls onto a ball: time against size",
                                     .x_label = "vertices",
                                     .y_label = "ms per step, mean",
                                     .x = rows_vertices,
                                     .y = mean_ms_of },
                    out );
}

void triangle_report( const triangle_plan* plan, const triangle_line* lines, results* out )
{
    const int table = begin_table( plan, out );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        if ( lines[i].drop->is_timed )
        {
            add_line( plan, &lines[i], table, out );
        }
    }
    add_ratios( plan, lines, out );
    add_growth( plan, lines, out );
    for ( int i = 0; i < plan->drop_count; ++i )
    {
        claim_iterations( plan, &lines[i], out );
    }
    add_chart( out );
    add_reading( plan, lines, out );
}
