// Figures 8 to 11 of Noh and Jung: the cloth on the ball, of triangles and of quads.
#include "figures_drape.h"

#include "bench_output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- observations ----

// A cloth is at rest when this share of the largest kinetic energy is left ...
#define DRAPE_REST 1e-4
#define DRAPE_REST_SECONDS 15.0 // ... after so long
// Largest allowed depth of a vertex in the ball, m.
#define DRAPE_DEPTH 1e-3

// The border of a mesh with one: its vertices one after another.
typedef struct drape_border
{
    int32_t* vertices; // [count]
    double* places;    // [count] share of the border's length at rest, rising from 0
    int count;
} drape_border;

typedef struct drape_observation
{
    double kinetic;           // J
    double gap, gap_between;  // m, least distance from the ball's surface: of vertices, of the middles of edges
    double strain;            // largest of the links that stretch, 0 if none is longer than at rest
    double hem_mean, min_hem; // m, height of the border
    int folds;                // round the border: where it stands out farthest from the ball's axis
    bool is_finite;
} drape_observation;

#define DRAPE_SHOTS_MAX 8

// Sample a frame, and keep it in an album unless that is null.
typedef struct drape_shot
{
    int frame; // from 1
    figures_album* album;
} drape_shot;

typedef struct drape_plan
{
    const triangle_scene* scene;
    const drape_border* border;
    float stiffness; // N/m
    float seconds;   // a step
    int steps;
    drape_shot shots[DRAPE_SHOTS_MAX]; // frames rise; those behind the last step are not taken
    int shot_count;
} drape_plan;

typedef struct drape_result
{
    drape_observation shots[DRAPE_SHOTS_MAX];
    int frames[DRAPE_SHOTS_MAX];
    int contacts[DRAPE_SHOTS_MAX]; // vertices that the ball holds
    int shot_count;                // that were taken
    drape_observation end;         // after DRAPE_REST_SECONDS, or at the last step if that is earlier
    double max_kinetic;            // J
    double min_gap;                // m
    double iterations;             // a step, mean
    double ms;                     // a step, mean
    bool is_finite;                // always was
} drape_result;

// ---- the border ----

static void drape_border_free( drape_border* border )
{
    free( border->vertices );
    free( border->places );
    *border = ( drape_border ){ .count = 0 };
}

// A half edge whose twin no triangle has leads along the border. @param next [vertex_count], -1: not on it
static wisp_status follow_border( const wisp_mesh* mesh, int32_t* next, wisp_error* error )
{
    const int corner_count = 3 * mesh->triangle_count;
    int32_t( *half )[2] = malloc( (size_t)corner_count * sizeof( *half ) );
    int32_t* begin = calloc( (size_t)mesh->vertex_count + 2, sizeof( int32_t ) );
    if ( half == NULL || begin == NULL )
    {
        free( half );
        free( begin );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the border of a mesh" );
    }

    // half edges by the vertex they begin at
    for ( int c = 0; c < corner_count; ++c )
    {
        ++begin[mesh->triangles[c] + 2];
    }
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        begin[v + 2] += begin[v + 1];
    }
    for ( int c = 0; c < corner_count; ++c )
    {
        int32_t from = mesh->triangles[c], to = mesh->triangles[c % 3 == 2 ? c - 2 : c + 1];
        int32_t* row = half[begin[from + 1]++];
        row[0] = from;
        row[1] = to;
    }

    for ( int i = 0; i < corner_count; ++i )
    {
        bool has_twin = false;
        for ( int k = begin[half[i][1]]; k < begin[half[i][1] + 1]; ++k )
        {
            has_twin = has_twin || half[k][1] == half[i][0];
        }
        if ( !has_twin )
        {
            next[half[i][0]] = half[i][1];
        }
    }
    free( half );
    free( begin );
    return WISP_OK;
}

static void walk( const wisp_mesh* mesh, const int32_t* next, drape_border* out )
{
    int first = 0;
    while ( first < mesh->vertex_count && next[first] < 0 )
    {
        ++first;
    }
    double length = 0.0;
    for ( int v = first; v < mesh->vertex_count && v >= 0 && out->count < mesh->vertex_count; )
    {
        out->places[out->count] = length;
        out->vertices[out->count++] = v;
        length += next[v] >= 0 ? wisp_mesh_distance( mesh->points[v], mesh->points[next[v]] ) : 0.0;
        v = next[v] == first ? -1 : next[v];
    }
    for ( int i = 0; i < out->count; ++i )
    {
        out->places[i] /= length;
    }
}

static wisp_status drape_border_find( const wisp_mesh* mesh, drape_border* out, wisp_error* error )
{
    size_t count = (size_t)mesh->vertex_count;
    *out = ( drape_border ){ .vertices = malloc( count * sizeof( int32_t ) ),
                             .places = malloc( count * sizeof( double ) ) };
    int32_t* next = malloc( count * sizeof( int32_t ) );
    wisp_status status = WISP_OK;
    if ( out->vertices == NULL || out->places == NULL || next == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the border of a mesh" );
    }
    else
    {
        memset( next, -1, count * sizeof( int32_t ) );
        status = follow_border( mesh, next, error );
    }
    if ( status == WISP_OK )
    {
        walk( mesh, next, out );
    }
    else
    {
        drape_border_free( out );
    }
    free( next );
    return status;
}

// ---- folds ----

enum
{
    PLACES = 240, // round the border
    WINDOW = 5,   // places that one is smoothed over, each way: 18 cm of 4 m
};

// What stands out less is a ripple, m. Edges are 4 cm long.
static const double FOLD_HEIGHT = 0.01;

// How far from the ball's axis the border is, at places that are evenly apart at rest.
static void sample_border( const drape_border* border, const wisp_vec3* points, double* radius )
{
    for ( int i = 0, k = 0; i < PLACES; ++i )
    {
        double place = (double)i / PLACES;
        while ( k + 1 < border->count && border->places[k + 1] <= place )
        {
            ++k;
        }
        double from = border->places[k], to = k + 1 < border->count ? border->places[k + 1] : 1.0;
        double fraction = ( place - from ) / ( to - from );
        const wisp_vec3 a = points[border->vertices[k]], b = points[border->vertices[( k + 1 ) % border->count]];
        radius[i] = hypot( ( 1.0 - fraction ) * (double)a.x + fraction * (double)b.x,
                           ( 1.0 - fraction ) * (double)a.z + fraction * (double)b.z );
    }
}

static void smooth( const double* in, double* out )
{
    for ( int i = 0; i < PLACES; ++i )
    {
        double sum = 0.0;
        for ( int k = -WINDOW; k <= WINDOW; ++k )
        {
            sum += in[( i + k + PLACES ) % PLACES];
        }
        out[i] = sum / ( 2 * WINDOW + 1 );
    }
}

// Maxima from which it falls by a fold's height on both sides: round from the lowest place, where a rise must begin.
static int count_folds( const drape_border* border, const wisp_vec3* points )
{
    double radius[PLACES], even[PLACES];
    sample_border( border, points, radius );
    smooth( radius, even );
    int first = 0;
    for ( int i = 1; i < PLACES; ++i )
    {
        first = even[i] < even[first] ? i : first;
    }
    int folds = 0;
    bool rises = true;
    double extreme = even[first];
    for ( int i = 1; i <= PLACES; ++i )
    {
        double value = even[( first + i ) % PLACES], turned = rises ? extreme - value : value - extreme;
        if ( rises ? value > extreme : value < extreme )
        {
            extreme = value;
        }
        else if ( turned > FOLD_HEIGHT )
        {
            folds += rises ? 1 : 0;
            rises = !rises;
            extreme = value;
        }
    }
    return folds;
}

// ---- an observation ----

static double gap_of( double x, double y, double z )
{
    y -= (double)TRIANGLE_BALL_HEIGHT;
    return sqrt( x * x + y * y + z * z ) - (double)TRIANGLE_BALL_RADIUS;
}

// What a step needs: kinetic energy and gap.
static wisp_status drape_glance( surface_implementation* implementation, drape_observation* out, wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    surface_observation observation = surface_implementation_observe( implementation );
    *out =
        ( drape_observation ){ .kinetic = observation.kinetic, .gap = INFINITY, .is_finite = observation.is_finite };
    for ( int i = 0; i < implementation->fabric->vertex_count; ++i )
    {
        out->gap = fmin( out->gap, gap_of( (double)points[i].x, (double)points[i].y, (double)points[i].z ) );
    }
    return WISP_OK;
}

static void observe_edge( const triangle_scene* scene, const wisp_vec3* points, int32_t i, int32_t k,
                          drape_observation* out )
{
    const wisp_vec3 a = points[i], b = points[k];
    double rest = wisp_mesh_distance( scene->mesh.points[i], scene->mesh.points[k] );
    out->strain = fmax( out->strain, wisp_mesh_distance( a, b ) / rest - 1.0 );
    out->gap_between =
        fmin( out->gap_between, gap_of( 0.5 * ( (double)a.x + (double)b.x ), 0.5 * ( (double)a.y + (double)b.y ),
                                        0.5 * ( (double)a.z + (double)b.z ) ) );
}

static void observe_folded_edges( const triangle_scene* scene, const wisp_vec3* points, drape_observation* out )
{
    const wisp_fabric* fabric = scene->fabric;
    out->gap_between = INFINITY;
    for ( int e = 0; e < scene->pairs.stretch_count; ++e )
    {
        observe_edge( scene, points, scene->pairs.stretch[2 * e], scene->pairs.stretch[2 * e + 1], out );
    }
    for ( int e = 0; e < fabric->edge_count && scene->pairs.stretch_count == 0; ++e )
    {
        observe_edge( scene, points, fabric->slot_vertex[fabric->edges[2 * e]],
                      fabric->slot_vertex[fabric->edges[2 * e + 1]], out );
    }
}

// All of it.
static wisp_status drape_observe( const triangle_scene* scene, const drape_border* border,
                                  surface_implementation* implementation, drape_observation* out, wisp_error* error )
{
    const wisp_vec3* points;
    wisp_status status = drape_glance( implementation, out, error );
    status = status == WISP_OK ? surface_implementation_points( implementation, &points, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    observe_folded_edges( scene, points, out );
    out->min_hem = INFINITY;
    for ( int i = 0; i < border->count; ++i )
    {
        double height = (double)points[border->vertices[i]].y;
        out->hem_mean += height / border->count;
        out->min_hem = fmin( out->min_hem, height );
    }
    out->folds = count_folds( border, points );
    return WISP_OK;
}

// ---- runs ----

static wisp_status take_shot( const figures_case* page, const drape_plan* plan,
                              surface_implementation* implementation, const wisp_implicit_cloth_stats* seen,
                              drape_result* out, wisp_error* error )
{
    const drape_shot* shot = &plan->shots[out->shot_count];
    out->frames[out->shot_count] = shot->frame;
    out->contacts[out->shot_count] = seen->sticking + seen->sliding + seen->landing;
    wisp_status status =
        drape_observe( plan->scene, plan->border, implementation, &out->shots[out->shot_count], error );
    ++out->shot_count;
    if ( status == WISP_OK && shot->album != NULL )
    {
        status = figures_take( page, shot->album, implementation, error, "k %.0f, frame %d", (double)plan->stiffness,
                               shot->frame );
    }
    return status;
}

static wisp_status drop( const figures_case* page, const drape_plan* plan, surface_implementation* implementation,
                         drape_result* out, wisp_error* error )
{
    const int rest = (int)lrint( fmin( plan->steps, DRAPE_REST_SECONDS / (double)plan->seconds ) );
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= plan->steps && status == WISP_OK; ++step )
    {
        wisp_implicit_cloth_stats seen;
        drape_observation observation;
        const double begin = wisp_clock_seconds();
        status = surface_implementation_step( implementation, error );
        out->ms += 1e3 * ( wisp_clock_seconds() - begin ) / plan->steps;
        status = status == WISP_OK ? drape_glance( implementation, &observation, error ) : status;
        if ( status == WISP_OK &&
             wisp_read_implicit_cloth_stats( implementation->world, implementation->entity, &seen ) != WISP_OK )
        {
            status = bench_world_fail( implementation->world, WISP_CONFLICT, error );
        }
        if ( status != WISP_OK )
        {
            return status;
        }
        out->max_kinetic = fmax( out->max_kinetic, observation.kinetic );
        out->min_gap = fmin( out->min_gap, observation.gap );
        out->iterations += (double)seen.iterations / plan->steps;
        out->is_finite = out->is_finite && observation.is_finite && implementation->halted_at == 0;
        if ( step == rest )
        {
            status = drape_observe( plan->scene, plan->border, implementation, &out->end, error );
        }
        while ( status == WISP_OK && out->shot_count < plan->shot_count &&
                plan->shots[out->shot_count].frame == step )
        {
            status = take_shot( page, plan, implementation, &seen, out, error );
        }
    }
    return status;
}

// Drop it onto the ball.
static wisp_status drape_run( const figures_case* page, const drape_plan* plan, drape_result* out, wisp_error* error )
{
    *out = ( drape_result ){ .min_gap = INFINITY, .is_finite = true };
    triangle_setting setting = triangle_default_setting();
    setting.cloth.stretch_stiffness = plan->stiffness;
    setting.seconds = plan->seconds;
    setting.requests_stats = true;
    surface_implementation implementation;
    wisp_status status = triangle_enter( plan->scene, &setting, &implementation, error );
    if ( status == WISP_OK )
    {
        status = drop( page, plan, &implementation, out, error );
        surface_implementation_destroy( &implementation );
    }
    return status;
}

static bool drape_is_at_rest( const drape_result* run )
{
    return run->is_finite && run->end.kinetic < DRAPE_REST * run->max_kinetic;
}

// ---- tables ----

static void put_shape( results_cells* row, const drape_observation* observation )
{
    cells_put( row, "%.3f\t%.3f\t%.2f\t%.4f\t%.4f\t%d", 1e3 * observation->gap, 1e3 * observation->gap_between,
               100.0 * observation->strain, observation->hem_mean, observation->min_hem, observation->folds );
}

// What the words of the tables below mean.
static void drape_add_terms( figures_case* page )
{
    results_add_note( page->out,
                      "Cloth on a ball: 1 m x 1 m, 0.2 kg/m2, falls 0.15 m onto a ball of 0.25 m at height 0.6 m." );
    results_add_note(
        page->out,
        "Cloth on a ball: k_b 1e-6 N m2, k_d 0.02 N s/m, margin 5 mm, friction 0.3 and 0.2, no self-collision.%s",
        page->quick ? " A quick run ends after frame 480, long steps after 6 s, and has fewer stiffnesses and steps."
                    : "" );
    results_add_note(
        page->out,
        "phi: least distance of a vertex from the ball's surface, negative inside; between: of edge midpoints. edge: "
        "the longest, against its rest length. hem: mean and least height of the border." );
    results_add_note( page->out,
                      "folds: maxima of the border's distance from the ball's axis, 1 cm above their surroundings, "
                      "after a mean over 18 cm. ms per step: the mean of one run alone, not timed in turns." );
}

// A line for each of the first shots of a run.
static void drape_add_sequence( figures_case* page, const char* title, int shot_count, const drape_result* run )
{
    int table = results_begin_table(
        page->out, title,
        "frame\tkinetic J\tof the largest\theld\tphi mm\tbetween mm\tedge %\them m\tlowest m\tfolds" );
    for ( int i = 0; i < shot_count; ++i )
    {
        const drape_observation* observation = &run->shots[i];
        results_cells row = { .count = 0 };
        cells_put( &row, "%d\t%.2e\t%.1e\t%d", run->frames[i], observation->kinetic,
                   observation->kinetic / run->max_kinetic, run->contacts[i] );
        put_shape( &row, observation );
        cells_end_row( &row, table, page->out );
    }
}

// A line a run; what was not run is left out. @param stiffnesses [count]
static void drape_add_runs( figures_case* page, const char* title, const float* stiffnesses, int count,
                            const drape_result* runs )
{
    int table = results_begin_table( page->out, title,
                                     "k N/m\tenergy left\tleast phi mm\tphi mm\tbetween mm\tedge %\them m\tlowest "
                                     "m\tfolds\titerations\tms per step" );
    for ( int i = 0; i < count; ++i )
    {
        if ( runs[i].iterations > 0.0 )
        {
            results_cells row = { .count = 0 };
            cells_put( &row, "%.0f\t%.1e\t%.3f", (double)stiffnesses[i], runs[i].end.kinetic / runs[i].max_kinetic,
                       1e3 * runs[i].min_gap );
            put_shape( &row, &runs[i].end );
            cells_put( &row, "%.1f\t%.2f", runs[i].iterations, runs[i].ms );
            cells_end_row( &row, table, page->out );
        }
    }
}

// ---- long steps ----

#define STEP_STIFFNESS 350.0f
#define QUICK_SECONDS 6

wisp_status figures_drape_steps( figures_case* page, wisp_error* error )
{
    static const int rates[] = { 100, 60, 30 };
    const int seconds = page->quick ? QUICK_SECONDS : (int)DRAPE_REST_SECONDS;
    triangle_scene scene;
    drape_border border = { .count = 0 };
    wisp_status status = triangle_scene_make( TRIANGLE_VERTICES, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = drape_border_find( &scene.mesh, &border, error );
    int table = results_begin_table( page->out, "The stiffest cloth, k 350 N/m, on the ball in long steps",
                                     "step s\titerations\tenergy left\tleast phi mm\tphi mm\tbetween mm\tedge %\them "
                                     "m\tlowest m\tfolds\tms per step" );
    for ( int i = page->quick ? WISP_COUNT( rates ) - 1 : 0; i < WISP_COUNT( rates ) && status == WISP_OK; ++i )
    {
        drape_result run;
        const drape_plan plan = {
            .scene = &scene,
            .border = &border,
            .stiffness = STEP_STIFFNESS,
            .seconds = 1.0f / (float)rates[i],
            .steps = seconds * rates[i],
        };
        status = drape_run( page, &plan, &run, error );
        if ( status != WISP_OK )
        {
            break;
        }
        const double left = run.end.kinetic / run.max_kinetic;
        results_cells row = { .count = 0 };
        cells_put( &row, "1/%d\t%.1f\t%.1e\t%.3f", rates[i], run.iterations, left, 1e3 * run.min_gap );
        put_shape( &row, &run.end );
        cells_put( &row, "%.2f", run.ms );
        cells_end_row( &row, table, page->out );
        char experiment[80], expected[120];
        snprintf( experiment, sizeof( experiment ), "958 vertices, k 350 N/m, steps of 1/%d s", rates[i] );
        snprintf( expected, sizeof( expected ),
                  "finite; kinetic energy after %d s below 1e-4 of its largest; no vertex ever deeper than 1 mm",
                  seconds );
        figures_add( page, "Long steps", experiment, expected, drape_is_at_rest( &run ) && run.min_gap > -DRAPE_DEPTH,
                     "%.1e left, phi at least %.2f mm, %.0f iterations per step", left, 1e3 * run.min_gap,
                     run.iterations );
    }
    drape_border_free( &border );
    triangle_scene_free( &scene );
    return status;
}

// ---- figures 8 to 11 ----

#define FRAME 0.01f      // s
#define FRAMES_REST 1500 // DRAPE_REST_SECONDS
// Most of the fall and of the settling; what is left of a run is slow.
#define FRAMES_QUICK 480
#define SEQUENCE_COUNT 5
// Hem and folds of the quad mesh should be so near to those of the triangle mesh.
#define QUAD_AIM 0.1
#define QUARTERS 4 // of a square on a ball

// The frames of Noh and Jung.
static const int sequence[SEQUENCE_COUNT] = { 1, 480, 961, 1201, 1440 };

enum
{
    SOFT = 1, // those of the figures
    FIRM = 3,
    STIFFNESS_COUNT = 7,
};
static const float stiffnesses[STIFFNESS_COUNT] = { 50.0f, 100.0f, 150.0f, 200.0f, 250.0f, 300.0f, 350.0f };

typedef struct drape_mesh
{
    triangle_scene scene;
    drape_border border;
    figures_album rest, frames, sweep;
    drape_result runs[STIFFNESS_COUNT];
} drape_mesh;

typedef struct drape_pair
{
    drape_mesh triangles, quads;
} drape_pair;

// ---- the runs ----

static void add_shot( drape_plan* plan, int frame, figures_album* album )
{
    if ( frame <= plan->steps )
    {
        plan->shots[plan->shot_count++] = ( drape_shot ){ frame, album };
    }
}

// @param figure_frame in which Noh and Jung show it; 0: none
static wisp_status run_one( const figures_case* page, drape_mesh* mesh, int which, bool has_sequence,
                            int figure_frame, wisp_error* error )
{
    const int last = figure_frame > FRAMES_REST ? figure_frame : FRAMES_REST;
    drape_plan plan = {
        .scene = &mesh->scene,
        .border = &mesh->border,
        .stiffness = stiffnesses[which],
        .seconds = FRAME,
        .steps = page->quick ? FRAMES_QUICK : last,
    };
    for ( int i = 0; i < SEQUENCE_COUNT && has_sequence; ++i )
    {
        add_shot( &plan, sequence[i], &mesh->frames );
    }
    if ( figure_frame > 0 )
    {
        add_shot( &plan, page->quick ? FRAMES_QUICK : figure_frame, &mesh->rest );
    }
    if ( mesh->scene.pairs.stretch_count == 0 )
    {
        add_shot( &plan, page->quick ? FRAMES_QUICK : FRAMES_REST, &mesh->sweep );
    }
    return drape_run( page, &plan, &mesh->runs[which], error );
}

static wisp_status run_triangles( const figures_case* page, drape_mesh* mesh, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < STIFFNESS_COUNT && status == WISP_OK; ++i )
    {
        if ( !page->quick || i == SOFT || i == FIRM )
        {
            const int frame = i == SOFT ? 1500 : i == FIRM ? 1320 : 0;
            status = run_one( page, mesh, i, i == SOFT, frame, error );
        }
    }
    return status;
}

static wisp_status run_quads( const figures_case* page, drape_mesh* mesh, wisp_error* error )
{
    wisp_status status = run_one( page, mesh, FIRM, true, 1560, error );
    return status == WISP_OK && !page->quick ? run_one( page, mesh, SOFT, false, 1500, error ) : status;
}

// ---- rows ----

static double left( const drape_result* run )
{
    return run->end.kinetic / run->max_kinetic;
}

static void add_rest_row( figures_case* page, const char* id, const char* mesh, int which, const drape_result* run )
{
    char experiment[160];
    snprintf( experiment, sizeof( experiment ), "%s dropped on a ball, k %.0f N/m, after %.3g s", mesh,
              (double)stiffnesses[which], page->quick ? FRAMES_QUICK * (double)FRAME : DRAPE_REST_SECONDS );
    figures_add( page, id, experiment,
                 "at rest (kinetic energy below 1e-4 of its largest), no vertex ever deeper than 1 mm",
                 drape_is_at_rest( run ) && run->min_gap > -DRAPE_DEPTH,
                 "%.1e left; phi at least %.2f mm, at rest %.2f (edge midpoints %.2f); longest edge +%.1f %%; hem at "
                 "%.3f m, lowest %.3f; %.0f iterations per step",
                 left( run ), 1e3 * run->min_gap, 1e3 * run->end.gap, 1e3 * run->end.gap_between,
                 100.0 * run->end.strain, run->end.hem_mean, run->end.min_hem, run->iterations );
}

// Does every value fall below the one before? @return the number of the first that does not; count if all do
static int first_rise( const double* values, int count )
{
    int i = 1;
    while ( i < count && values[i] < values[i - 1] )
    {
        ++i;
    }
    return i;
}

static void add_stiffness_rows( figures_case* page, const drape_result* runs )
{
    double strain[STIFFNESS_COUNT];
    int which[STIFFNESS_COUNT], count = 0;
    bool all_rest = true;
    for ( int i = 0; i < STIFFNESS_COUNT; ++i )
    {
        if ( runs[i].iterations > 0.0 )
        {
            strain[count] = runs[i].end.strain;
            which[count++] = i;
            all_rest = all_rest && drape_is_at_rest( &runs[i] ) && runs[i].min_gap > -DRAPE_DEPTH;
        }
    }
    const drape_result *soft = &runs[which[0]], *firm = &runs[which[count - 1]];
    const int rise = first_rise( strain, count );
    char where[80] = "at every step";
    if ( rise < count )
    {
        snprintf( where, sizeof( where ), "but not from %.0f to %.0f N/m", (double)stiffnesses[which[rise - 1]],
                  (double)stiffnesses[which[rise]] );
    }
    char experiment[80];
    snprintf( experiment, sizeof( experiment ), "the same, k from %.0f to %.0f N/m in %d runs",
              (double)stiffnesses[which[0]], (double)stiffnesses[which[count - 1]], count );
    figures_add( page, "Noh and Jung, Fig. 8", experiment,
                 "all come to rest outside; the softer cloth has longer edges and a lower hem",
                 all_rest && firm->end.strain < soft->end.strain && soft->end.hem_mean < firm->end.hem_mean,
                 "longest edge +%.1f to +%.1f %%, falling %s; hem at %.4f to %.4f m", 100.0 * soft->end.strain,
                 100.0 * firm->end.strain, where, soft->end.hem_mean, firm->end.hem_mean );
}

// A quick run ends before the later frames.
static int sequence_count( const figures_case* page )
{
    int count = 0;
    while ( count < SEQUENCE_COUNT && !( page->quick && sequence[count] > FRAMES_QUICK ) )
    {
        ++count;
    }
    return count;
}

static void add_sequence_row( figures_case* page, const char* id, const char* mesh, const drape_result* run )
{
    const int last = sequence_count( page ) - 1;
    const double fraction = run->shots[last].kinetic / run->max_kinetic;
    figures_add( page, id, mesh,
                 "falls, touches, drapes, settles: kinetic energy below 1e-4 of its largest in the last",
                 run->contacts[0] == 0 && run->contacts[last] > 0 && fraction < DRAPE_REST,
                 "at frame %d %.1e of %.3f J; %d vertices held, hem from %.3f to %.3f m", run->frames[last], fraction,
                 run->max_kinetic, run->contacts[last], run->shots[0].hem_mean, run->shots[last].hem_mean );
}

static double apart( double a, double b )
{
    return a / b - 1.0;
}

// How far the hem came down is compared, not its height, of which most is where the ball happens to be.
static void add_quad_row( figures_case* page, int which, const drape_result* triangles, const drape_result* quads )
{
    const double start = (double)TRIANGLE_HEIGHT;
    const double height = apart( quads->end.hem_mean, triangles->end.hem_mean );
    const double fall = apart( start - quads->end.hem_mean, start - triangles->end.hem_mean );
    const double lowest = apart( start - quads->end.min_hem, start - triangles->end.min_hem );
    char experiment[80];
    snprintf( experiment, sizeof( experiment ), "quads against triangles, k %.0f N/m", (double)stiffnesses[which] );
    figures_add( page, "Noh and Jung, Fig. 10", experiment,
                 "the hem within 10 %: its height, and the way it came down",
                 fabs( height ) < QUAD_AIM && fabs( fall ) < QUAD_AIM && fabs( lowest ) < QUAD_AIM,
                 "mean height %+.1f %%; way down of the mean %+.1f %%, of the lowest %+.1f %%", 100.0 * height,
                 100.0 * fall, 100.0 * lowest );
    // Quads above the ball have its fourfold symmetry, and so have their folds; those of the irregular mesh can be any number.
    const int more = quads->end.folds - triangles->end.folds;
    figures_add( page, "Noh and Jung, Fig. 10", experiment,
                 "folds of quads in fours; as many as of triangles, but for one in each quarter",
                 quads->end.folds > 0 && quads->end.folds % QUARTERS == 0 && abs( more ) <= QUARTERS,
                 "%d folds of quads, %d of triangles, %+.0f %%: the aim of 10 %% is %s", quads->end.folds,
                 triangles->end.folds, 100.0 * apart( quads->end.folds, triangles->end.folds ),
                 abs( more ) <= QUAD_AIM * triangles->end.folds ? "met" : "not met" );
}

// ---- the page ----

static wisp_status enter_drape( drape_mesh* mesh, int vertices, wisp_error* error )
{
    wisp_status status = triangle_scene_make( vertices, &mesh->scene, error );
    status = status == WISP_OK ? drape_border_find( &mesh->scene.mesh, &mesh->border, error ) : status;
    mesh->rest.mesh = mesh->frames.mesh = mesh->sweep.mesh = &mesh->scene.mesh;
    return status;
}

static void leave_drape( drape_mesh* mesh )
{
    figures_album_free( &mesh->rest );
    figures_album_free( &mesh->frames );
    figures_album_free( &mesh->sweep );
    drape_border_free( &mesh->border );
    triangle_scene_free( &mesh->scene );
}

static wisp_status write_pictures( figures_case* page, const drape_pair* pair, wisp_error* error )
{
    const struct
    {
        const figures_album* album;
        const char *name, *caption;
    } sheets[] = {
        { &pair->triangles.rest, "tri8_rest", "Noh and Jung, Fig. 8, 958 vertices of triangles at rest" },
        { &pair->triangles.sweep, "tri8_sweep", "Noh and Jung 8, stiffness of 50 to 350 N/m" },
        { &pair->triangles.frames, "tri9_frames", "Noh and Jung 9, frames of triangles" },
        { &pair->quads.rest, "tri10_rest", "Noh and Jung, Fig. 10, 25 x 25 vertices of quads at rest" },
        { &pair->quads.frames, "tri11_frames", "Noh and Jung 11, frames of quads" },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( sheets ) && status == WISP_OK; ++i )
    {
        status = drape_write( page, sheets[i].album, true, sheets[i].name, sheets[i].caption, error );
    }
    return status;
}

static void add_drape_rows( figures_case* page, const drape_pair* pair )
{
    const drape_result *triangles = pair->triangles.runs, *quads = pair->quads.runs;
    add_rest_row( page, "Noh and Jung, Fig. 8", "958 vertices of triangles", FIRM, &triangles[FIRM] );
    add_rest_row( page, "Noh and Jung, Fig. 8", "958 vertices of triangles", SOFT, &triangles[SOFT] );
    add_stiffness_rows( page, triangles );
    add_sequence_row( page, "Noh and Jung, Fig. 9", "frames of triangles, k 100 N/m", &triangles[SOFT] );
    add_rest_row( page, "Noh and Jung, Fig. 10", "25 x 25 vertices of quads", FIRM, &quads[FIRM] );
    add_quad_row( page, FIRM, &triangles[FIRM], &quads[FIRM] );
    if ( !page->quick )
    {
        add_rest_row( page, "Noh and Jung, Fig. 10", "25 x 25 vertices of quads", SOFT, &quads[SOFT] );
        add_quad_row( page, SOFT, &triangles[SOFT], &quads[SOFT] );
    }
    add_sequence_row( page, "Noh and Jung, Fig. 11", "frames of quads, k 200 N/m", &quads[FIRM] );
}

wisp_status figures_drape( figures_case* page, wisp_error* error )
{
    drape_pair* pair = calloc( 1, sizeof( drape_pair ) );
    if ( pair == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth on a ball" );
    }
    wisp_status status = enter_drape( &pair->triangles, TRIANGLE_VERTICES, error );
    status = status == WISP_OK ? enter_drape( &pair->quads, 0, error ) : status;
    status = status == WISP_OK ? run_triangles( page, &pair->triangles, error ) : status;
    status = status == WISP_OK ? run_quads( page, &pair->quads, error ) : status;
    if ( status == WISP_OK )
    {
        add_drape_rows( page, pair );
        drape_add_sequence( page, "Noh and Jung 9: triangles, k 100 N/m", sequence_count( page ),
                            &pair->triangles.runs[SOFT] );
        drape_add_sequence( page, "Noh and Jung 11: quads, k 200 N/m", sequence_count( page ),
                            &pair->quads.runs[FIRM] );
        drape_add_runs( page, "Noh and Jung, Fig. 8: 958 vertices of triangles on the ball", stiffnesses,
                        STIFFNESS_COUNT, pair->triangles.runs );
        drape_add_runs( page, "Noh and Jung, Fig. 10: 25 x 25 vertices of quads on the ball", stiffnesses,
                        STIFFNESS_COUNT, pair->quads.runs );
        drape_add_terms( page );
        status = write_pictures( page, pair, error );
    }
    leave_drape( &pair->triangles );
    leave_drape( &pair->quads );
    free( pair );
    return status;
}
