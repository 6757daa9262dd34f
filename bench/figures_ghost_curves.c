// The figures of Park and Kim 2024 about lines: the curves that draw strands, and ghosts with more vertices.
#include "figures_hair.h"

#include "oracle/guide_oracle.h"

#include <math.h>

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

static turns measure_curve_turns( const wisp_vec3* points, int count, double limit )
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

// In the order in which they are drawn and told, behind eq. 6 as printed.
static const wisp_curve_kind curve_kinds[] = { WISP_CURVE_BEZIER, WISP_CURVE_CATMULL_ROM };

typedef struct curve_stats
{
    turns line, printed, curve[WISP_COUNT( curve_kinds )];
    double ends; // m, largest distance of an end of a curve to that of its strand
} curve_stats;

typedef enum strand_form
{
    FORM_ZIGZAG,
    FORM_ARC,
    FORM_HELIX,
    FORM_COUNT,
} strand_form;

static const char* const form_names[FORM_COUNT] = { "zigzag", "arc", "helix" };

// Segments of 2 cm or so that turn by up to 78, 29 and 28 degrees.
static wisp_vec3 form_node( strand_form form, int i )
{
    const float angle = form == FORM_ARC ? 0.5f * (float)i : 0.8f * (float)i;
    switch ( form )
    {
        case FORM_ZIGZAG:
            return ( wisp_vec3 ){ i % 2 == 0 ? 0.0f : 0.015f, -0.02f * (float)i, 0.004f * (float)( i % 3 ) };
        case FORM_ARC:
            return ( wisp_vec3 ){ 0.04f * ( 1.0f - cosf( angle ) ), -0.04f * sinf( angle ), 0.0f };
        default:
            return ( wisp_vec3 ){ 0.015f * cosf( angle ), -0.015f * (float)i, 0.015f * sinf( angle ) };
    }
}

#define CURVE_NODES_MAX 10
#define CURVE_SAMPLES 8
#define CURVE_POINTS_MAX ( CURVE_SAMPLES * ( CURVE_NODES_MAX - 1 ) + 1 )

static void note_ends( const wisp_vec3* points, int count, const wisp_vec3* nodes, int node_count, curve_stats* f )
{
    f->ends = fmax( f->ends, tuft_length( tuft_minus( points[0], nodes[0] ) ) );
    f->ends = fmax( f->ends, tuft_length( tuft_minus( points[count - 1], nodes[node_count - 1] ) ) );
}

// Eq. 6 on groups that share their ends only, by the oracle. @return number of points
static int draw_printed( const wisp_vec3* nodes, int node_count, double limit, wisp_vec3* points, curve_stats* f )
{
    double3 wide[CURVE_NODES_MAX], controls[4 * CURVE_NODES_MAX], drawn[CURVE_POINTS_MAX];
    for ( int i = 0; i < node_count; ++i )
    {
        wide[i] = double3_widen( nodes[i] );
    }
    guide_oracle_curve_controls( wide, node_count, GUIDE_ORACLE_CURVE_GROUPS, controls );
    const int count = guide_oracle_draw( controls, guide_oracle_curve_count( node_count, GUIDE_ORACLE_CURVE_GROUPS ),
                                         CURVE_SAMPLES, false, drawn );
    for ( int i = 0; i < count; ++i )
    {
        points[i] = ( wisp_vec3 ){ (float)drawn[i].x, (float)drawn[i].y, (float)drawn[i].z };
    }
    f->printed = measure_curve_turns( points, count, limit );
    note_ends( points, count, nodes, node_count, f );
    return count;
}

static wisp_status draw_curve( wisp_world* world, wisp_entity strand, wisp_curve_kind kind, const wisp_vec3* nodes,
                               int node_count, double limit, turns* out, wisp_view* view, curve_stats* f,
                               wisp_error* error )
{
    wisp_curves_def def = wisp_default_curves_def();
    def.source = strand;
    def.kind = kind;
    def.samples = CURVE_SAMPLES;
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
    *out = measure_curve_turns( points, view->count, limit );
    note_ends( points, view->count, nodes, node_count, f );
    return WISP_OK;
}

static wisp_status draw_strand( const figures_case* page, figures_hair_album* album, strand_form form, int node_count,
                                curve_stats* f, wisp_error* error )
{
    static const wisp_vec3 printed_colour = { 0.75f, 0.05f, 0.05f };
    static const wisp_vec3 colours[] = { { 0.55f, 0.32f, 0.12f }, { 0.1f, 0.25f, 0.6f } };
    wisp_vec3 nodes[CURVE_NODES_MAX], printed[CURVE_POINTS_MAX];
    const int32_t offsets[2] = { 0, node_count };
    for ( int i = 0; i < node_count; ++i )
    {
        nodes[i] = form_node( form, i );
    }
    const turns all = measure_curve_turns( nodes, node_count, 0.0 );
    double limit = 0.5 * all.largest;
    f->line = measure_curve_turns( nodes, node_count, limit );

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
    figures_hair_begin( page, album, "%s, %d vertices", form_names[form], node_count );
    status = status == WISP_OK
                 ? figures_hair_add( page, album, nodes, 1, node_count, tuft_target_colour, 0.0005f, error )
                 : status;
    const int count = draw_printed( nodes, node_count, limit, printed, f );
    status = status == WISP_OK ? figures_hair_add( page, album, printed, 1, count, printed_colour, 0.0005f, error )
                               : status;
    for ( int k = 0; k < WISP_COUNT( curve_kinds ) && status == WISP_OK; ++k )
    {
        status = draw_curve( world, strand, curve_kinds[k], nodes, node_count, limit, &f->curve[k], &view, f, error );
        status = status == WISP_OK
                     ? figures_hair_add( page, album, view.data, 1, view.count, colours[k], 0.0005f, error )
                     : status;
    }
    wisp_world_destroy( world );
    return status;
}

// The largest turn at any drawn joint is lower with curves. As printed it is not: groups meet in the directions of the strand's own
// segments, so a joint turns as its vertex does, and by the turn of half a sample more on an arc.
static bool turns_less( const curve_stats* f )
{
    bool less = f->ends < TUFT_ROUNDING;
    for ( int k = 0; k < WISP_COUNT( curve_kinds ); ++k )
    {
        less = less && f->curve[k].largest < f->line.largest && f->curve[k].sharp < f->line.sharp;
    }
    return less;
}

wisp_status figures_ghost_curves( figures_case* page, wisp_error* error )
{
    static const int counts[] = { 4, 7, 10 };
    wisp_status status = WISP_OK;
    figures_hair_album album = { .count = 0 };
    curve_stats last[FORM_COUNT] = { { .ends = 0.0 } };
    bool meets_target = true;
    for ( int n = 0; n < FORM_COUNT * WISP_COUNT( counts ) && status == WISP_OK; ++n )
    {
        const strand_form form = (strand_form)( n / WISP_COUNT( counts ) );
        figures_hair_album none = { .count = 0 };
        curve_stats f = { .ends = 0.0 };
        const int count = counts[n % WISP_COUNT( counts )];
        const bool is_shown = form == FORM_ZIGZAG || count == counts[WISP_COUNT( counts ) - 1];
        status = draw_strand( page, is_shown ? &album : &none, form, count, &f, error );
        figures_hair_free( &none );
        meets_target = meets_target && turns_less( &f );
        last[form] = f;
    }
    if ( status == WISP_OK )
    {
        char text[FORM_COUNT][60];
        for ( int form = 0; form < FORM_COUNT; ++form )
        {
            const curve_stats* f = &last[form];
            snprintf( text[form], sizeof( text[form] ), "%s %.0f: %.0f, %.0f, %.0f", form_names[form],
                      f->line.largest, f->printed.largest, f->curve[0].largest, f->curve[1].largest );
        }
        figures_add(
            page, "Park and Kim 2024, Fig. 3",
            "zigzags, arcs and helices of 4, 7 and 10 vertices: segments, eq. 6 as printed, eq. 6 with shared "
            "tangents, Catmull-Rom",
            "with shared tangents and with Catmull-Rom the largest turn at any drawn joint is lower; ends "
            "coincide",
            meets_target, "largest turn of 10 vertices, degrees: %s; %s; %s", text[0], text[1], text[2] );
        status =
            figures_hair_write( page, &album, "guide_hair_3_curves",
                                "Park and Kim 2024, Fig. 3, segments (black), eq. 6 as printed (red), with shared "
                                "tangents (brown), Catmull-Rom (blue)",
                                error );
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
    for ( int g = 0; g < TUFT_GROUP; ++g )
    {
        largest = fmax( largest, measure_curve_turns( points + g * GHOST_NODES, GHOST_NODES, 0.0 ).largest );
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
    tuft_seen s = { .target = NULL };
    wisp_vec3 nearest[TUFT_GROUP * GHOST_NODES];
    double kinks[2] = { 0.0, 0.0 };
    bool refused = false;
    wisp_ghosts_def follow = tuft_without_weights();
    follow.resample = true;
    wisp_status status = tuft_make( TUFT_GROUP, GHOST_NODES, &t, error );
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
        if ( status == WISP_OK && step == TUFT_SHOT )
        {
            for ( int i = 0; i < TUFT_GROUP * GHOST_NODES; ++i )
            {
                nearest[i] = tuft_minus( nearest[i], s.target[0] );
            }
            figures_hair_begin( page, &album, "nearest vertex" );
            status =
                figures_hair_add( page, &album, nearest, TUFT_GROUP, GHOST_NODES, tuft_line_colour, 0.0005f, error );
            figures_hair_begin( page, &album, "by arc length" );
            const tuft_lines none = { .to_centre = false };
            status = status == WISP_OK ? tuft_take( page, &album, &t, &s, &none, error ) : status;
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
