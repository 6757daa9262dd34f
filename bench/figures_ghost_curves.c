// The figures of Park and Kim 2024 about lines: the curves that draw strands, and ghosts with more vertices.
#include "figures_tuft.h"

#include <math.h>

#define GROUP 4
#define SHOT_STEP 25

// ---- turns ----

static double turn( wisp_vec3 a, wisp_vec3 b, wisp_vec3 c )
{
    const wisp_vec3 u = tuft_minus( b, a ), v = tuft_minus( c, b );
    double product = tuft_length( u ) * tuft_length( v );
    double cosine = product > 0.0 ? tuft_dot( u, v ) / product : 1.0;
    return acos( fmin( fmax( cosine, -1.0 ), 1.0 ) ) * 57.29577951308232;
}

typedef struct turns
{
    double largest; // degrees
    int sharp;      // above a limit
} turns;

static turns measure_turns( const wisp_vec3* points, int count, double limit )
{
    turns t = { 0.0, 0 };
    for ( int i = 1; i + 1 < count; ++i )
    {
        double angle = turn( points[i - 1], points[i], points[i + 1] );
        t.largest = fmax( t.largest, angle );
        t.sharp += angle > limit ? 1 : 0;
    }
    return t;
}

// ---- Fig. 3 ----

typedef struct curve_stats
{
    turns line, bezier, spline;
    double ends; // m, largest distance of an end of a curve to that of its strand
} curve_stats;

#define CURVE_NODES_MAX 10

static wisp_status draw_curve( wisp_world* world, wisp_entity strand, wisp_curve_kind kind, const wisp_vec3* nodes,
                               int node_count, double limit, turns* out, wisp_view* view, curve_stats* f,
                               wisp_error* error )
{
    wisp_curves_def def = wisp_default_curves_def();
    def.source = strand;
    def.kind = kind;
    wisp_entity curve = { 0 };
    wisp_status status = wisp_add_curves( world, &def, &curve );
    status = status == WISP_OK ? wisp_request( world, curve, WISP_STRAND_POINTS ) : status;
    status = status == WISP_OK ? wisp_world_step( world, STRANDS_STEP ) : status;
    status = status == WISP_OK ? wisp_world_view( world, curve, WISP_STRAND_POINTS, view ) : status;
    if ( status != WISP_OK )
    {
        return bench_world_fail( world, status, error );
    }
    const wisp_vec3* points = view->data;
    *out = measure_turns( points, view->count, limit );
    f->ends = fmax( f->ends, tuft_length( tuft_minus( points[0], nodes[0] ) ) );
    f->ends = fmax( f->ends, tuft_length( tuft_minus( points[view->count - 1], nodes[node_count - 1] ) ) );
    return WISP_OK;
}

static wisp_status draw_strand( const figures_case* page, figures_hair_album* album, int node_count, curve_stats* f,
                                wisp_error* error )
{
    wisp_vec3 nodes[CURVE_NODES_MAX];
    const int32_t offsets[2] = { 0, node_count };
    for ( int i = 0; i < node_count; ++i )
    {
        nodes[i] = ( wisp_vec3 ){ i % 2 == 0 ? 0.0f : 0.015f, -0.02f * (float)i, 0.004f * (float)( i % 3 ) };
    }
    const turns all = measure_turns( nodes, node_count, 0.0 );
    double limit = 0.5 * all.largest;
    f->line = measure_turns( nodes, node_count, limit );

    const wisp_module* const modules[] = { &wisp_strands_module, &wisp_guide_hair_module };
    const bench_world_def def = { modules, WISP_COUNT( modules ), .workers = 1 };
    wisp_world* world = NULL;
    wisp_status status = bench_world_create( &def, &world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = nodes;
    strands.offsets = offsets;
    strands.strand_count = 1;
    wisp_entity strand;
    wisp_view view = { 0 };
    status = wisp_add_strands( world, &strands, &strand );
    status = status == WISP_OK ? WISP_OK : bench_world_fail( world, status, error );
    figures_hair_begin( page, album, "%d vertices", node_count );
    status = status == WISP_OK
                 ? figures_hair_add( page, album, nodes, 1, node_count, tuft_target_colour, 0.0005f, error )
                 : status;
    static const wisp_curve_kind kinds[] = { WISP_CURVE_BEZIER, WISP_CURVE_CATMULL_ROM };
    for ( int k = 0; k < WISP_COUNT( kinds ) && status == WISP_OK; ++k )
    {
        turns* out = kinds[k] == WISP_CURVE_BEZIER ? &f->bezier : &f->spline;
        status = draw_curve( world, strand, kinds[k], nodes, node_count, limit, out, &view, f, error );
        status = status == WISP_OK ? figures_hair_add( page, album, view.data, 1, view.count,
                                                       k == 0 ? tuft_line_colour : tuft_ghost_colour, 0.0005f, error )
                                   : status;
    }
    wisp_world_destroy( world );
    return status;
}

wisp_status figures_ghost_curves( figures_case* page, wisp_error* error )
{
    static const int counts[] = { 4, 7, 10 };
    figures_hair_album album = { .count = 0 };
    curve_stats f[WISP_COUNT( counts )] = { { .ends = 0.0 } };
    wisp_status status = WISP_OK;
    bool meets_target = true;
    for ( int i = 0; i < WISP_COUNT( counts ) && status == WISP_OK; ++i )
    {
        status = draw_strand( page, &album, counts[i], &f[i], error );

        // Pieces of eq. 6 meet in the direction of the strand's own segments, so a joint turns as its vertex does.
        meets_target = meets_target && f[i].bezier.sharp < f[i].line.sharp &&
                       f[i].bezier.largest < f[i].line.largest + 0.1 && f[i].spline.largest < f[i].line.largest &&
                       f[i].ends < TUFT_ROUNDING;
    }
    if ( status == WISP_OK )
    {
        figures_add(
            page, "Park and Kim 2024, Fig. 3",
            "zigzags of 4, 7 and 10 vertices, drawn by segments, eq. 6 and Catmull-Rom",
            "fewer sharp turns, the largest of eq. 6 at its joints only; ends coincide",
            meets_target && f[0].bezier.largest < f[0].line.largest,
            "sharp turns %d/%d/%d, %d/%d/%d, %d/%d/%d; largest %.0f/%.0f/%.0f, %.0f/%.0f/%.0f, %.0f/%.0f/%.0f "
            "degrees",
            f[0].line.sharp, f[0].bezier.sharp, f[0].spline.sharp, f[1].line.sharp, f[1].bezier.sharp,
            f[1].spline.sharp, f[2].line.sharp, f[2].bezier.sharp, f[2].spline.sharp, f[0].line.largest,
            f[0].bezier.largest, f[0].spline.largest, f[1].line.largest, f[1].bezier.largest, f[1].spline.largest,
            f[2].line.largest, f[2].bezier.largest, f[2].spline.largest );
        status = figures_hair_write( page, &album, "guide_hair_3_curves",
                                     "Park and Kim 2024, Fig. 3, segments, eq. 6 and Catmull-Rom", error );
    }
    figures_hair_free( &album );
    return status;
}

// ---- pairing of unequal vertex counts ----

#define GHOST_NODES ( 2 * TUFT_NODES )

// Pairing of Park and Kim 2024: a ghost's vertex goes where the nearest vertex of the target at rest goes.
static void pair_nearest( const tuft* t, const wisp_vec3* target, wisp_vec3* out )
{
    for ( int i = 0; i < strands_shape_size( &t->ghosts ); ++i )
    {
        wisp_vec3 rest = t->ghosts.points[i];
        int nearest = 0;
        for ( int node = 1; node < TUFT_NODES; ++node )
        {
            bool is_nearer = tuft_length( tuft_minus( rest, t->target.points[node] ) ) <
                             tuft_length( tuft_minus( rest, t->target.points[nearest] ) );
            nearest = is_nearer ? node : nearest;
        }
        wisp_vec3 moved = tuft_minus( target[nearest], t->target.points[nearest] );
        out[i] = ( wisp_vec3 ){ rest.x + moved.x, rest.y + moved.y, rest.z + moved.z };
    }
}

static double sharpest( const wisp_vec3* points )
{
    double largest = 0.0;
    for ( int g = 0; g < GROUP; ++g )
    {
        largest = fmax( largest, measure_turns( points + g * GHOST_NODES, GHOST_NODES, 0.0 ).largest );
    }
    return largest;
}

// Is a pairing by vertex refused where there are more vertices than the target has?
static wisp_status is_refused( tuft* t, bool* out, wisp_error* error )
{
    hair_head refused = { 0 };
    hair_head_generator generator = hair_head_default_generator( &t->target );
    wisp_error said = { 0 };
    generator.ghosts = &t->ghosts;
    wisp_status status = hair_head_create( &generator, &refused, &said );
    *out = status == WISP_BAD_INPUT;
    hair_head_destroy( &refused );
    return status == WISP_OK || status == WISP_BAD_INPUT ? WISP_OK : wisp_fail( error, status, "%s", said.message );
}

wisp_status figures_ghost_pairing( figures_case* page, wisp_error* error )
{
    figures_hair_album album = { .count = 0 };
    tuft t = { .target = { 0 } };
    seen s = { .target = NULL };
    wisp_vec3 nearest[GROUP * GHOST_NODES];
    double kinks[2] = { 0.0, 0.0 };
    bool refused = false;
    wisp_ghosts_def follow = tuft_without_weights();
    follow.resample = true;
    follow.frame = WISP_GHOST_FRAME_OFF; // as in Park and Kim 2024
    wisp_status status = tuft_make( GROUP, GHOST_NODES, &t, error );
    status = status == WISP_OK ? is_refused( &t, &refused, error ) : status;
    status = status == WISP_OK ? tuft_enter( &t, &follow, error ) : status;
    for ( int step = 1; step <= TUFT_STEPS && status == WISP_OK; ++step )
    {
        status = tuft_advance( &t, &s, error );
        if ( status == WISP_OK )
        {
            pair_nearest( &t, s.target, nearest );
            kinks[0] = fmax( kinks[0], sharpest( nearest ) );
            kinks[1] = fmax( kinks[1], sharpest( s.swaying ) );
        }
        if ( status == WISP_OK && step == SHOT_STEP )
        {
            figures_hair_begin( page, &album, "nearest vertex" );
            status = figures_hair_add( page, &album, nearest, GROUP, GHOST_NODES, tuft_line_colour, 0.0005f, error );
            figures_hair_begin( page, &album, "by arc length" );
            status = status == WISP_OK ? tuft_take( page, &album, &t, &s, error ) : status;
        }
    }
    if ( status == WISP_OK )
    {
        figures_add( page, "Pairing (extension)",
                     "ghosts of 20 vertices about a target of 10, by the nearest vertex and by arc length",
                     "refused without pairing by arc length; nearest pairing has kinks, arc length has none",
                     refused && kinks[1] < 0.7 * kinks[0], "%s; largest turn %.1f and %.1f degrees",
                     refused ? "refused" : "NOT refused", kinks[0], kinks[1] );
        status =
            figures_hair_write( page, &album, "guide_hair_pairing",
                                "Pairing of unequal vertex counts (extension, not in Park and Kim 2024)", error );
    }
    figures_hair_free( &album );
    tuft_free( &t );
    return status;
}
