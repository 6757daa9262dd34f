// The figures of Park and Kim 2024 about ghosts: how they stand around their targets and how they sway.
#include "figures_tuft.h"

#include <math.h>

#define GHOSTS_MAX 5
#define SHOT_STEP 25
// Difference lines are a few millimetres long at most: how many times they are drawn, and the difference of the bar, m.
#define SWAY_MAGNIFIED 10.0f
#define SWAY_BAR 0.001f
#define GROUP_MAGNIFIED 2.0f
#define GROUP_BAR 0.01f
// Below this speed a direction means nothing, m/s.
#define MIN_SPEED 0.05

static double spread_of_group( const wisp_vec3* points, int ghost_count, int node )
{
    double sum = 0.0;
    const wisp_vec3 c = tuft_mean( points, ghost_count, node );
    for ( int g = 0; g < ghost_count; ++g )
    {
        const wisp_vec3 d = tuft_minus( points[g * TUFT_NODES + node], c );
        sum += tuft_dot( d, d );
    }
    return sum;
}

// ---- Fig. 1 ----

wisp_status figures_ghost_centre( figures_case* page, wisp_error* error )
{
    figures_hair_album album = { .count = 0 };
    double worst = 0.0;
    wisp_status status = WISP_OK;
    for ( int ghosts = 3; ghosts <= GHOSTS_MAX && status == WISP_OK; ++ghosts )
    {
        tuft t = { .target = { 0 } };
        seen s = { .target = NULL };
        const wisp_ghosts_def follow = tuft_without_weights();
        status = tuft_make( ghosts, TUFT_NODES, &t, error );
        status = status == WISP_OK ? tuft_enter( &t, &follow, error ) : status;
        for ( int step = 1; step <= TUFT_STEPS && status == WISP_OK; ++step )
        {
            status = tuft_advance( &t, &s, error );
            for ( int node = 0; node < TUFT_NODES && status == WISP_OK; ++node )
            {
                double off = tuft_length( tuft_minus( tuft_mean( s.swaying, ghosts, node ), s.target[node] ) );
                worst = off <= worst ? worst : off;
            }
            if ( step == SHOT_STEP && status == WISP_OK )
            {
                const tuft_lines spokes = { .to_centre = true };
                figures_hair_begin( page, &album, "%d ghosts, lines to their mean", ghosts );
                status = tuft_take( page, &album, &t, &s, &spokes, error );
            }
        }
        tuft_free( &t );
    }
    if ( status == WISP_OK )
    {
        figures_add( page, "Park and Kim 2024, Fig. 1",
                     "one target with 3, 4 and 5 ghosts, no weights, 60 steps of a shaken head",
                     "the mean of the ghosts is the target at every node, to float rounding", worst < TUFT_ROUNDING,
                     "at most %.1e m apart", worst );
        status = figures_hair_write( page, &album, "guide_hair_1_centre",
                                     "Park and Kim 2024, Fig. 1, ghosts about their target", error );
    }
    figures_hair_free( &album );
    return status;
}

// ---- Fig. 2a ----

typedef struct sway_stats
{
    double root, rest;             // m: largest displacement of a root, and of anything before the head moves
    double steady, turning, wrong; // mean |y - b| / (tau |v|) by the change of direction; largest distance to W
    int steady_count, turning_count;
} sway_stats;

static void measure_sway( const seen* s, sway_stats* f )
{
    for ( int node = 0; node < TUFT_NODES; ++node )
    {
        double moved = tuft_length( tuft_minus( s->swaying[node], s->base[node] ) );
        double speed = tuft_length( s->now[node] ), before = tuft_length( s->before[node] );
        f->root = node == 0 && moved > f->root ? moved : f->root;
        if ( node == 0 || speed < MIN_SPEED || before < MIN_SPEED )
        {
            continue;
        }
        double cosine = tuft_dot( s->now[node], s->before[node] ) / ( speed * before );
        double fraction = moved / ( (double)STRANDS_STEP * speed );
        f->wrong = fmax( f->wrong, fabs( fraction - ( 0.5 - 0.5 * cosine ) ) );
        bool is_turning = cosine < 0.866;
        f->turning += is_turning ? fraction : 0.0;
        f->turning_count += is_turning ? 1 : 0;
        f->steady += is_turning ? 0.0 : fraction;
        f->steady_count += is_turning ? 0 : 1;
    }
}

// Before the head moves nothing does: a pose that is the rest pose.
static wisp_status rest_once( tuft* t, sway_stats* f, wisp_error* error )
{
    const wisp_transform still = hair_head_pose( 0.0 );
    const wisp_vec3 *a = NULL, *b = NULL;
    wisp_status status = hair_head_step_to( &t->swaying, still, error );
    status = status == WISP_OK ? hair_head_step_to( &t->plain, still, error ) : status;
    status = status == WISP_OK ? hair_head_points( &t->swaying, &a, error ) : status;
    status = status == WISP_OK ? hair_head_points( &t->plain, &b, error ) : status;
    for ( int i = 0; i < strands_shape_size( &t->ghosts ) && status == WISP_OK; ++i )
    {
        f->rest = fmax( f->rest, tuft_length( tuft_minus( a[i], b[i] ) ) );
    }
    return status;
}

wisp_status figures_ghost_sway( figures_case* page, wisp_error* error )
{
    figures_hair_album album = { .count = 0 };
    tuft t = { .target = { 0 } };
    seen s = { .target = NULL };
    sway_stats f = { .root = 0.0 };
    wisp_ghosts_def follow = tuft_without_weights();
    follow.elastic = WISP_GHOST_ELASTIC_CHANGE;
    wisp_status status = tuft_make( 1, TUFT_NODES, &t, error );
    status = status == WISP_OK ? tuft_enter( &t, &follow, error ) : status;
    status = status == WISP_OK ? rest_once( &t, &f, error ) : status;
    for ( int step = 1; step <= TUFT_STEPS && status == WISP_OK; ++step )
    {
        status = tuft_advance( &t, &s, error );
        if ( status == WISP_OK && step > 1 )
        {
            measure_sway( &s, &f );
        }
        if ( status == WISP_OK && step % 12 == 0 )
        {
            const tuft_lines lines = { .magnified = SWAY_MAGNIFIED, .bar = SWAY_BAR };
            figures_hair_begin( page, &album, "%.2f s, bar %.0f mm of y - b", step / 60.0, 1e3 * (double)SWAY_BAR );
            status = tuft_take( page, &album, &t, &s, &lines, error );
        }
    }
    if ( status == WISP_OK )
    {
        double steady = f.steady / fmax( f.steady_count, 1.0 ), turning = f.turning / fmax( f.turning_count, 1.0 );

        // a displacement of dt |v| > 0.8 mm is known to 3e-7 m
        double tolerance = 2.0 * TUFT_ROUNDING / ( (double)STRANDS_STEP * MIN_SPEED );
        figures_add(
            page, "Park and Kim 2024, Fig. 2a",
            "1:1, head swung from side to side, without and with the elastic weight",
            "y - b is zero at rest and at the root; over tau |v| it rises with the change of velocity",
            f.root == 0.0 && f.rest < TUFT_ROUNDING && turning > 2.0 * steady && f.wrong < tolerance &&
                f.turning_count > 0,
            "%.0e m at rest, %.0e at the root; %.3f where v turns by less than 30 degrees, %.3f where by more; "
            "at most %.1e from 0.5 - 0.5 cos",
            f.rest, f.root, steady, turning, f.wrong );
        status = figures_hair_write( page, &album, "guide_hair_2a_sway",
                                     "Park and Kim 2024, Fig. 2a, difference lines of a lone ghost", error );
    }
    figures_hair_free( &album );
    tuft_free( &t );
    return status;
}

// ---- Fig. 2b and 2c ----

#define GROUP 4

typedef struct group_stats
{
    double apart;       // m, largest difference of displacement within the group
    double spread;      // m^2, mean over nodes and steps
    int ordered, pairs; // ghosts in the order of their distance from the centre
    int samples;
} group_stats;

static void measure_group( const seen* s, group_stats* f )
{
    for ( int node = 1; node < TUFT_NODES; ++node )
    {
        double moved[GROUP], far[GROUP];
        const wisp_vec3 centre = tuft_mean( s->base, GROUP, node );
        wisp_vec3 first = { 0.0f, 0.0f, 0.0f };
        for ( int g = 0; g < GROUP; ++g )
        {
            wisp_vec3 d = tuft_minus( s->swaying[g * TUFT_NODES + node], s->base[g * TUFT_NODES + node] );
            first = g == 0 ? d : first;
            moved[g] = tuft_length( d );
            far[g] = tuft_length( tuft_minus( s->base[g * TUFT_NODES + node], centre ) );
            f->apart = fmax( f->apart, tuft_length( tuft_minus( d, first ) ) );
        }
        f->spread += spread_of_group( s->swaying, GROUP, node );
        ++f->samples;
        if ( tuft_length( s->now[node] ) < MIN_SPEED )
        {
            continue;
        }
        for ( int a = 0; a < GROUP; ++a )
        {
            for ( int b = 0; b < GROUP; ++b )
            {
                bool is_pair = far[a] > 1.05 * far[b]; // nearly equal distances say nothing
                f->pairs += is_pair ? 1 : 0;
                f->ordered += is_pair && moved[a] > moved[b] ? 1 : 0;
            }
        }
    }
}

static wisp_status run_group( const figures_case* page, figures_hair_album* album, float centre_gain, group_stats* f,
                              wisp_error* error )
{
    tuft t = { .target = { 0 } };
    seen s = { .target = NULL };
    wisp_ghosts_def follow = tuft_without_weights();
    follow.elastic = WISP_GHOST_ELASTIC_CHANGE;
    follow.centre_gain = centre_gain;
    wisp_status status = tuft_make( GROUP, TUFT_NODES, &t, error );
    status = status == WISP_OK ? tuft_enter( &t, &follow, error ) : status;
    for ( int step = 1; step <= TUFT_STEPS && status == WISP_OK; ++step )
    {
        status = tuft_advance( &t, &s, error );
        if ( status == WISP_OK )
        {
            measure_group( &s, f );
        }
        if ( status == WISP_OK && step == SHOT_STEP )
        {
            const tuft_lines lines = { .magnified = GROUP_MAGNIFIED, .bar = GROUP_BAR };
            figures_hair_begin( page, album, "k_com %.1f, bar %.0f mm of y - b", (double)centre_gain,
                                1e3 * (double)GROUP_BAR );
            status = tuft_take( page, album, &t, &s, &lines, error );
        }
    }
    f->spread /= f->samples > 0 ? f->samples : 1;
    tuft_free( &t );
    return status;
}

wisp_status figures_ghost_block( figures_case* page, wisp_error* error )
{
    figures_hair_album album = { .count = 0 };
    group_stats f = { .apart = 0.0 };
    wisp_status status = run_group( page, &album, 0.0f, &f, error );
    if ( status == WISP_OK )
    {
        figures_add( page, "Park and Kim 2024, Fig. 2b", "1:4, the elastic weight alone",
                     "all four ghosts are displaced alike: the block problem", f.apart < 2.0 * TUFT_ROUNDING,
                     "displacements at most %.1e m apart", f.apart );
        status = figures_hair_write( page, &album, "guide_hair_2b_block",
                                     "Park and Kim 2024, Fig. 2b, a group that moves as a block", error );
    }
    figures_hair_free( &album );
    return status;
}

wisp_status figures_ghost_apart( figures_case* page, wisp_error* error )
{
    static const float gains[] = { 0.0f, 0.5f, 1.0f };
    figures_hair_album album = { .count = 0 };
    group_stats f[WISP_COUNT( gains )] = { { .apart = 0.0 } };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( gains ) && status == WISP_OK; ++i )
    {
        status = run_group( page, &album, gains[i], &f[i], error );
    }
    if ( status == WISP_OK )
    {
        double half = 100.0 * f[1].ordered / fmax( f[1].pairs, 1.0 );
        double whole = 100.0 * f[2].ordered / fmax( f[2].pairs, 1.0 );
        figures_add( page, "Park and Kim 2024, Fig. 2c", "1:4, weight of the centre 0, 0.5 and 1",
                     "far ghosts sway more than near ones; the spread V is above that of W alone",
                     f[1].pairs > 0 && f[1].ordered == f[1].pairs && f[2].ordered == f[2].pairs &&
                         f[2].spread > f[1].spread && f[1].spread > f[0].spread,
                     "%.1f and %.1f %% of pairs in order; V %.4f, %.4f, %.4f cm2; up to %.2f and %.2f mm apart", half,
                     whole, 1e4 * f[0].spread, 1e4 * f[1].spread, 1e4 * f[2].spread, 1e3 * f[1].apart,
                     1e3 * f[2].apart );
        status = figures_hair_write( page, &album, "guide_hair_2c_centre",
                                     "Park and Kim 2024, Fig. 2c, a group that sways apart", error );
    }
    figures_hair_free( &album );
    return status;
}

// ---- spread of a group ----

wisp_status figures_ghost_spread( figures_case* page, wisp_error* error )
{
    static const float requested[] = { 0.25f, 1.0f, 2.5f };
    figures_hair_album album = { .count = 0 };
    double worst = 0.0, ratio[WISP_COUNT( requested )] = { 0.0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( requested ) && status == WISP_OK; ++i )
    {
        tuft t = { .target = { 0 } };
        seen s = { .target = NULL };
        wisp_ghosts_def follow = tuft_without_weights();
        follow.spread = requested[i];
        status = tuft_make( GROUP, TUFT_NODES, &t, error );
        status = status == WISP_OK ? tuft_enter( &t, &follow, error ) : status;
        for ( int step = 1; step <= SHOT_STEP && status == WISP_OK; ++step )
        {
            status = tuft_advance( &t, &s, error );
        }
        for ( int node = 1; node < TUFT_NODES && status == WISP_OK; ++node )
        {
            double now = spread_of_group( s.swaying, GROUP, node );
            double rest = spread_of_group( t.ghosts.points, GROUP, node );
            ratio[i] += now / rest / ( TUFT_NODES - 1 );
            worst = fmax( worst, fabs( now / rest / (double)requested[i] - 1.0 ) );
        }
        if ( status == WISP_OK )
        {
            const tuft_lines spokes = { .to_centre = true };
            figures_hair_begin( page, &album, "V / v0 = %.2f", (double)requested[i] );
            status = tuft_take( page, &album, &t, &s, &spokes, error );
        }
        tuft_free( &t );
    }
    if ( status == WISP_OK )
    {
        // offsets of 4 mm at 0.4 m are known to 1e-5 of themselves
        figures_add( page, "Spread (extension)", "spread control, Vbar / v_0 of 0.25, 1 and 2.5",
                     "V is Vbar at every node", worst < 1e-3, "V / v_0 = %.4f, %.4f, %.4f; error at most %.1e",
                     ratio[0], ratio[1], ratio[2], worst );
        status = figures_hair_write( page, &album, "guide_hair_spread",
                                     "Spread of a group (extension, not in Park and Kim 2024)", error );
    }
    figures_hair_free( &album );
    return status;
}
