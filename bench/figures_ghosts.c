// The figures of Park and Kim 2024 about ghosts: how they stand around their targets and how they sway.
#include "figures_hair.h"

#include "wisp/module/vec.h"

#include <math.h>
#include <stdlib.h>

// ---- tufts ----

const wisp_vec3 tuft_target_colour = { 0.08f, 0.05f, 0.03f };
const wisp_vec3 tuft_ghost_colour = { 0.55f, 0.32f, 0.12f };
const wisp_vec3 tuft_line_colour = { 0.75f, 0.05f, 0.05f };

wisp_vec3 tuft_minus( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

double tuft_dot( wisp_vec3 a, wisp_vec3 b )
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
}

double tuft_length( wisp_vec3 a )
{
    return sqrt( tuft_dot( a, a ) );
}

static wisp_vec3 target_point( int node, int nodes )
{
    float s = (float)node / (float)( nodes - 1 );
    return ( wisp_vec3 ){ 0.1f + 0.12f * s - 0.05f * s * s, 0.05f - 0.12f * s * s, 0.02f * s };
}

wisp_status tuft_make( int ghost_count, int ghost_nodes, tuft* t, wisp_error* error )
{
    wisp_status status = strands_shape_create( 1, TUFT_NODES, &t->target, error );
    status = status == WISP_OK ? strands_shape_create( ghost_count, ghost_nodes, &t->ghosts, error ) : status;
    for ( int node = 0; node < TUFT_NODES && status == WISP_OK; ++node )
    {
        t->target.points[node] = target_point( node, TUFT_NODES );
    }
    for ( int i = 0; i < ghost_count * ghost_nodes && status == WISP_OK; ++i )
    {
        int ghost = i / ghost_nodes, node = i % ghost_nodes;
        float angle = 2.4f * (float)ghost, s = (float)node / (float)( ghost_nodes - 1 );
        float radius = 0.004f * (float)( ghost + 1 ) * ( 1.0f + s );
        wisp_vec3 p = target_point( node, ghost_nodes );
        t->ghosts.points[i] = ( wisp_vec3 ){ p.x + radius * sinf( angle ), p.y, p.z + radius * cosf( angle ) };
    }
    return status;
}

void tuft_free( tuft* t )
{
    hair_head_destroy( &t->swaying );
    hair_head_destroy( &t->plain );
    strands_shape_free( &t->target );
    strands_shape_free( &t->ghosts );
}

wisp_ghosts_def tuft_without_weights( void )
{
    wisp_ghosts_def def = wisp_default_ghosts_def();
    def.elastic = WISP_GHOST_ELASTIC_OFF;
    def.tip_gain = 0.0f;
    def.centre_gain = 0.0f;
    return def;
}

wisp_status tuft_enter( tuft* t, const wisp_ghosts_def* follow, wisp_error* error )
{
    hair_head_generator generator = hair_head_default_generator( &t->target );
    generator.ghosts = &t->ghosts;
    generator.shows_moving = true;
    generator.follow = *follow;
    wisp_status status = hair_head_create( &generator, &t->swaying, error );
    generator.follow = tuft_without_weights();
    generator.follow.resample = follow->resample;
    return status == WISP_OK ? hair_head_create( &generator, &t->plain, error ) : status;
}

wisp_status tuft_advance( tuft* t, tuft_seen* s, wisp_error* error )
{
    for ( int i = 0; i < TUFT_NODES; ++i )
    {
        s->before[i] = s->now[i];
    }
    wisp_status status = hair_head_step( &t->swaying, error );
    status = status == WISP_OK ? hair_head_step( &t->plain, error ) : status;
    status = status == WISP_OK ? hair_head_points( &t->swaying, &s->swaying, error ) : status;
    status = status == WISP_OK ? hair_head_points( &t->plain, &s->base, error ) : status;
    status = status == WISP_OK ? hair_head_moving_points( &t->swaying, &s->target, error ) : status;
    if ( status == WISP_OK )
    {
        hair_head_moving_velocities( &t->swaying, s->now );
    }
    return status;
}

// Mean of the ghosts of the one target at a node. @param points [ghost_count][TUFT_NODES] m
static wisp_vec3 tuft_mean( const wisp_vec3* points, int ghost_count, int node )
{
    double sum[3] = { 0.0, 0.0, 0.0 };
    for ( int g = 0; g < ghost_count; ++g )
    {
        wisp_vec3 p = points[g * TUFT_NODES + node];
        sum[0] += (double)p.x;
        sum[1] += (double)p.y;
        sum[2] += (double)p.z;
    }
    return ( wisp_vec3 ){ (float)( sum[0] / ghost_count ), (float)( sum[1] / ghost_count ),
                          (float)( sum[2] / ghost_count ) };
}

#define LINE_RADIUS 0.0004f

// Ends of the lines of a shot, and of its bar. @return how many lines
static int collect_lines( const tuft* t, const tuft_seen* s, const tuft_lines* lines, wisp_vec3* out )
{
    const float times = lines->magnified > 0.0f ? lines->magnified : 1.0f;
    int count = 0;
    for ( int i = 0; i < strands_shape_size( &t->ghosts ); ++i )
    {
        const wisp_vec3 end = lines->to_centre
                                  ? tuft_mean( s->swaying, t->ghosts.strand_count, i % TUFT_NODES )
                                  : wisp_v3_mul_add( s->base[i], times, tuft_minus( s->swaying[i], s->base[i] ) );
        const wisp_vec3 begin = lines->to_centre ? s->swaying[i] : s->base[i];
        if ( tuft_length( tuft_minus( end, begin ) ) > (double)LINE_RADIUS )
        {
            out[2 * count] = begin;
            out[2 * count++ + 1] = end;
        }
    }
    if ( lines->bar > 0.0f )
    {
        const wisp_vec3 under = { 0.0f, -0.02f, 0.0f }, along = { times * lines->bar, 0.0f, 0.0f };
        out[2 * count] = wisp_v3_mul_add( s->target[0], 1.0f, under );
        out[2 * count + 1] = wisp_v3_mul_add( out[2 * count], 1.0f, along );
        count += 1;
    }
    return count;
}

// Add a layer as seen from a point that moves with the head, so that shots of all times fill their pictures.
static wisp_status add_from( const figures_case* page, figures_hair_album* album, wisp_vec3 from,
                             const wisp_vec3* points, int strands, int vertices, wisp_vec3 colour, float radius,
                             wisp_error* error )
{
    wisp_vec3* moved = malloc( (size_t)strands * (size_t)vertices * sizeof( wisp_vec3 ) );
    if ( !moved )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture of ghosts" );
    }
    for ( int i = 0; i < strands * vertices; ++i )
    {
        moved[i] = tuft_minus( points[i], from );
    }
    const wisp_status status = figures_hair_add( page, album, moved, strands, vertices, colour, radius, error );
    free( moved );
    return status;
}

wisp_status tuft_take( const figures_case* page, figures_hair_album* album, const tuft* t, const tuft_seen* s,
                       const tuft_lines* lines, wisp_error* error )
{
    const wisp_vec3 root = s->target[0];
    wisp_vec3* ends = malloc( 2 * ( (size_t)strands_shape_size( &t->ghosts ) + 1 ) * sizeof( wisp_vec3 ) );
    if ( !ends )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for difference lines" );
    }
    wisp_status status =
        add_from( page, album, root, s->target, 1, t->target.vertices, tuft_target_colour, 0.0008f, error );
    status = status == WISP_OK ? add_from( page, album, root, s->swaying, t->ghosts.strand_count, t->ghosts.vertices,
                                           tuft_ghost_colour, 0.0005f, error )
                               : status;
    const int count = collect_lines( t, s, lines, ends );
    if ( status == WISP_OK && count > 0 )
    {
        status = add_from( page, album, root, ends, count, 2, tuft_line_colour, LINE_RADIUS, error );
    }
    free( ends );
    return status;
}

// ---- figures 1 and 2 ----

#define GHOSTS_MAX 5
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
        tuft_seen s = { .target = NULL };
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
            if ( step == TUFT_SHOT && status == WISP_OK )
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

static void measure_sway( const tuft_seen* s, sway_stats* f )
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
    tuft_seen s = { .target = NULL };
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

typedef struct group_stats
{
    double apart;       // m, largest difference of displacement within the group
    double spread;      // m^2, mean over nodes and steps
    int ordered, pairs; // ghosts in the order of their distance from the centre
    int samples;
} group_stats;

static void measure_group( const tuft_seen* s, group_stats* f )
{
    for ( int node = 1; node < TUFT_NODES; ++node )
    {
        double moved[TUFT_GROUP], far[TUFT_GROUP];
        const wisp_vec3 centre = tuft_mean( s->base, TUFT_GROUP, node );
        wisp_vec3 first = { 0.0f, 0.0f, 0.0f };
        for ( int g = 0; g < TUFT_GROUP; ++g )
        {
            wisp_vec3 d = tuft_minus( s->swaying[g * TUFT_NODES + node], s->base[g * TUFT_NODES + node] );
            first = g == 0 ? d : first;
            moved[g] = tuft_length( d );
            far[g] = tuft_length( tuft_minus( s->base[g * TUFT_NODES + node], centre ) );
            f->apart = fmax( f->apart, tuft_length( tuft_minus( d, first ) ) );
        }
        f->spread += spread_of_group( s->swaying, TUFT_GROUP, node );
        ++f->samples;
        if ( tuft_length( s->now[node] ) < MIN_SPEED )
        {
            continue;
        }
        for ( int a = 0; a < TUFT_GROUP; ++a )
        {
            for ( int b = 0; b < TUFT_GROUP; ++b )
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
    tuft_seen s = { .target = NULL };
    wisp_ghosts_def follow = tuft_without_weights();
    follow.elastic = WISP_GHOST_ELASTIC_CHANGE;
    follow.centre_gain = centre_gain;
    wisp_status status = tuft_make( TUFT_GROUP, TUFT_NODES, &t, error );
    status = status == WISP_OK ? tuft_enter( &t, &follow, error ) : status;
    for ( int step = 1; step <= TUFT_STEPS && status == WISP_OK; ++step )
    {
        status = tuft_advance( &t, &s, error );
        if ( status == WISP_OK )
        {
            measure_group( &s, f );
        }
        if ( status == WISP_OK && step == TUFT_SHOT )
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
        tuft_seen s = { .target = NULL };
        wisp_ghosts_def follow = tuft_without_weights();
        follow.spread = requested[i];
        status = tuft_make( TUFT_GROUP, TUFT_NODES, &t, error );
        status = status == WISP_OK ? tuft_enter( &t, &follow, error ) : status;
        for ( int step = 1; step <= TUFT_SHOT && status == WISP_OK; ++step )
        {
            status = tuft_advance( &t, &s, error );
        }
        for ( int node = 1; node < TUFT_NODES && status == WISP_OK; ++node )
        {
            double now = spread_of_group( s.swaying, TUFT_GROUP, node );
            double rest = spread_of_group( t.ghosts.points, TUFT_GROUP, node );
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
