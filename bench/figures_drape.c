// Figures 8 to 11 of Noh and Jung: the cloth on the ball, of triangles and of quads.
#include "figures_drape.h"

#include <math.h>
#include <stdlib.h>

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

static wisp_status enter( drape_mesh* mesh, int vertices, wisp_error* error )
{
    wisp_status status = triangle_scene_make( vertices, &mesh->scene, error );
    status = status == WISP_OK ? drape_border_find( &mesh->scene.mesh, &mesh->border, error ) : status;
    mesh->rest.mesh = mesh->frames.mesh = mesh->sweep.mesh = &mesh->scene.mesh;
    return status;
}

static void leave( drape_mesh* mesh )
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

static void add_rows( figures_case* page, const drape_pair* pair )
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
    wisp_status status = enter( &pair->triangles, TRIANGLE_VERTICES, error );
    status = status == WISP_OK ? enter( &pair->quads, 0, error ) : status;
    status = status == WISP_OK ? run_triangles( page, &pair->triangles, error ) : status;
    status = status == WISP_OK ? run_quads( page, &pair->quads, error ) : status;
    if ( status == WISP_OK )
    {
        add_rows( page, pair );
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
    leave( &pair->triangles );
    leave( &pair->quads );
    free( pair );
    return status;
}
