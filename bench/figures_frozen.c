// The figures of Kim 2026: frozen hair in the plane, red at the root and blue at the tip as in the source.
#include "bench_world.h"
#include "figures_hair.h"
#include "frozen_hair.h"
#include "groom.h"
#include "oracle/frozen_hair_oracle.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum
{
    VERTICES = 20, // of a strand, from Table 1
    PATH = 40,     // commands of a stroke
    CIRCLE = 49,   // points of the circle of reach
};

static const wisp_vec3 frozen_root_colour = { 0.80f, 0.03f, 0.03f }, frozen_tip_colour = { 0.03f, 0.06f, 0.80f };
static const wisp_vec3 cursor_colour = { 0.02f, 0.02f, 0.02f };
static const float HAIR_RADIUS = 6e-4f, CURSOR_RADIUS = 8e-4f; // m
static const double DEGREE = 3.14159265358979323846 / 180.0;

// Strands in the plane, and a world in which they freeze.
typedef struct frozen_plane
{
    wisp_groom groom;
    wisp_world* world;
    wisp_entity hair;
    const wisp_vec3* points; ///< of the last step
    wisp_vec3* printed;      ///< points of the oracle
} frozen_plane;

static void plane_free( frozen_plane* f )
{
    if ( f->world )
    {
        wisp_world_destroy( f->world );
    }
    wisp_groom_release( &f->groom );
    free( f->printed );
    *f = ( frozen_plane ){ .world = NULL };
}

static wisp_status plane_step( frozen_plane* f, wisp_error* error )
{
    const wisp_status status = wisp_world_step( f->world, 1.0f / 60.0f );
    return status == WISP_OK
               ? bench_world_points( f->world, f->hair, WISP_STRAND_POINTS, f->groom.vertex_count, &f->points, error )
               : bench_world_fail( f->world, status, error );
}

static wisp_status plane_make( wisp_groom_shape shape, int strands, float spacing, const wisp_frozen_hair_def* def,
                               frozen_plane* f, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_frozen_hair_module };
    const bench_world_def world = { modules, WISP_COUNT( modules ), .workers = 1 };
    wisp_groom_generator generator = wisp_default_groom_generator( shape, 2 );
    *f = ( frozen_plane ){ .world = NULL };
    generator.strand_count = strands;
    generator.vertices_per_strand = VERTICES;
    generator.length = 0.14f;
    generator.length_variation = 0.0f;
    generator.spacing = spacing;
    wisp_status status = wisp_groom_generate( &generator, &f->groom, error );
    status = status == WISP_OK ? bench_world_create( &world, &f->world, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_strands_def added = wisp_default_strands_def();
    added.points = f->groom.points;
    added.offsets = f->groom.offsets;
    added.strand_count = strands;
    added.dimension = 2;
    status = wisp_add_strands( f->world, &added, &f->hair );
    status = status == WISP_OK ? wisp_set_frozen_hair( f->world, f->hair, def ) : status;
    status = status == WISP_OK ? wisp_request( f->world, f->hair, WISP_STRAND_POINTS ) : status;
    return status == WISP_OK ? plane_step( f, error ) : bench_world_fail( f->world, status, error );
}

static wisp_status take( const figures_case* page, figures_hair_album* album, const wisp_vec3* points, int strands,
                         wisp_error* error )
{
    return figures_hair_add_blended( page, album, points, strands, VERTICES, frozen_root_colour, frozen_tip_colour,
                                     HAIR_RADIUS, error );
}

static double angle_between( wisp_vec3 a, wisp_vec3 b )
{
    return atan2( (double)a.x * (double)b.y - (double)a.y * (double)b.x,
                  (double)a.x * (double)b.x + (double)a.y * (double)b.y );
}

static wisp_vec3 from_to( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ b.x - a.x, b.y - a.y, b.z - a.z };
}

// ---- Fig. 1 ----

// A cursor that goes from left to right below the tips and rises on its way.
static wisp_vec3 cursor_at( int command )
{
    const float s = (float)command / (float)( PATH - 1 );
    return ( wisp_vec3 ){ -0.16f + 0.36f * s, -0.15f + 0.11f * s * s, 0.0f };
}

static wisp_status take_cursor( const figures_case* page, figures_hair_album* album, float reach, wisp_error* error )
{
    wisp_vec3 path[PATH], circle[CIRCLE];
    for ( int i = 0; i < PATH; ++i )
    {
        path[i] = cursor_at( i );
    }
    for ( int i = 0; i < CIRCLE; ++i )
    {
        const double angle = 360.0 * DEGREE * i / ( CIRCLE - 1 );
        const wisp_vec3 c = path[PATH - 1];
        circle[i] = ( wisp_vec3 ){ c.x + reach * (float)cos( angle ), c.y + reach * (float)sin( angle ), 0.0f };
    }
    const wisp_status status = figures_hair_add( page, album, path, 1, PATH, cursor_colour, CURSOR_RADIUS, error );
    return status == WISP_OK ? figures_hair_add( page, album, circle, 1, CIRCLE, cursor_colour, CURSOR_RADIUS, error )
                             : status;
}

static wisp_status sweep( frozen_plane* f, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int n = 0; n < PATH && status == WISP_OK; ++n )
    {
        status = wisp_command_frozen_hair( f->world, f->hair, cursor_at( n ) );
        status = status == WISP_OK ? plane_step( f, error ) : bench_world_fail( f->world, status, error );
    }
    return status;
}

// Turns of vertices about their root, in parts of the turn of the tip, for straight strands that only align.
typedef struct turn_stats
{
    double first, bend; // mean of the vertex after the root; largest distance from eq. 12
    int swept;
} turn_stats;

static turn_stats measure_turns( const frozen_plane* f, double intensity )
{
    turn_stats t = { .first = 0.0 };
    for ( int s = 0; s < f->groom.strand_count; ++s )
    {
        const wisp_vec3 *rest = f->groom.points + s * VERTICES, *now = f->points + s * VERTICES;
        const double tip =
            angle_between( from_to( rest[0], rest[VERTICES - 1] ), from_to( now[0], now[VERTICES - 1] ) );
        if ( fabs( tip ) < 5.0 * DEGREE )
        {
            continue;
        }
        for ( int i = 1; i < VERTICES; ++i )
        {
            const double turn = angle_between( from_to( rest[0], rest[i] ), from_to( now[0], now[i] ) ) / tip;
            const double w = intensity + ( 1.0 - intensity ) * i / ( VERTICES - 1 );
            t.bend = fmax( t.bend, fabs( turn - w ) );
            t.first += i == 1 ? turn : 0.0;
        }
        t.swept += 1;
    }
    t.first /= t.swept > 0 ? t.swept : 1;
    return t;
}

wisp_status figures_frozen_intensity( figures_case* page, wisp_error* error )
{
    static const float intensities[] = { 0.8f, 0.2f };
    figures_hair_album album = { .count = 0, .is_flat = true };
    turn_stats turns[2] = { { .first = 0.0 } };
    wisp_status status = WISP_OK;
    for ( int n = 0; n < 4 && status == WISP_OK; ++n )
    {
        // in the picture strands freeze, too; turns are those of eq. 12 without noise
        frozen_plane f;
        wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
        def.base = WISP_FROZEN_BASE_STROKE;
        def.freeze = n < 2;
        def.clump = false;
        def.reach = 0.05f;
        def.intensity = intensities[n % 2];
        status = plane_make( WISP_GROOM_STRAIGHT, 80, 0.004f, &def, &f, error );
        if ( n == 0 && status == WISP_OK )
        {
            figures_hair_begin( page, &album, "original" );
            status = take( page, &album, f.groom.points, f.groom.strand_count, error );
        }
        status = status == WISP_OK ? sweep( &f, error ) : status;
        if ( n < 2 && status == WISP_OK )
        {
            figures_hair_begin( page, &album, "intensity %.1f", (double)intensities[n] );
            status = take( page, &album, f.points, f.groom.strand_count, error );
            status = status == WISP_OK ? take_cursor( page, &album, def.reach, error ) : status;
        }
        else if ( status == WISP_OK )
        {
            turns[n % 2] = measure_turns( &f, (double)def.intensity );
        }
        plane_free( &f );
    }
    if ( status == WISP_OK )
    {
        // at the root 19 / 20 of the rest comes later; floats of 7 mm round a turn by 1e-4 of it
        const double expected[] = { 0.8 + 0.2 / 19.0, 0.2 + 0.8 / 19.0 };
        const bool is_met = turns[0].bend < 2e-3 && turns[1].bend < 2e-3 && turns[0].swept > 40 &&
                            fabs( turns[0].first - expected[0] ) < 1e-3 &&
                            fabs( turns[1].first - expected[1] ) < 1e-3;
        figures_add(
            page, "Kim 2026, Fig. 1", "a stroke of 40 commands on 80 strands, intensity 0.8 and 0.2",
            "0.8: the whole strand turns; 0.2: a curve; vertex 1 turns by 0.811 and 0.242 of the tip's turn, "
            "linear from there",
            is_met, "%.3f and %.3f; at most %.0e from linear; %d and %d strands", turns[0].first, turns[1].first,
            fmax( turns[0].bend, turns[1].bend ), turns[0].swept, turns[1].swept );
        status =
            figures_hair_write( page, &album, "frozen_hair_1_intensity",
                                "Kim 2026, Fig. 1: one cursor path (black, with its reach at the end), red at the "
                                "root and blue at the tip",
                                error );
    }
    figures_hair_free( &album );
    return status;
}

// ---- Fig. 2 ----

typedef struct noise_stats
{
    double bend, spread; // degrees, mean change of the turning angle; standard deviation of relative lengths
} noise_stats;

static double turning( const wisp_vec3* p )
{
    return angle_between( from_to( p[0], p[1] ), from_to( p[1], p[2] ) );
}

static double length_of( wisp_vec3 v )
{
    return hypot( (double)v.x, (double)v.y );
}

static noise_stats measure_noise( const frozen_plane* f )
{
    double bend = 0.0, square = 0.0;
    for ( int v = 0; v < f->groom.vertex_count; ++v )
    {
        const wisp_vec3 *rest = f->groom.points + v, *now = f->points + v;
        if ( v % VERTICES > 0 )
        {
            const double change = length_of( from_to( now[-1], now[0] ) ) / length_of( from_to( rest[-1], rest[0] ) );
            square += ( change - 1.0 ) * ( change - 1.0 );
        }
        if ( v % VERTICES > 1 )
        {
            bend += fabs( remainder( turning( now - 2 ) - turning( rest - 2 ), 360.0 * DEGREE ) );
        }
    }
    const double strands = f->groom.strand_count;
    return ( noise_stats ){ bend / DEGREE / ( strands * ( VERTICES - 2 ) ),
                            sqrt( square / ( strands * ( VERTICES - 1 ) ) ) };
}

wisp_status figures_frozen_stiffness( figures_case* page, wisp_error* error )
{
    static const float stiffness[] = { 7.0f, 3.0f };
    figures_hair_album album = { .count = 0, .is_flat = true };
    noise_stats noise[2] = { { .bend = 0.0 } };
    wisp_status status = WISP_OK;
    for ( int n = 0; n < 2 && status == WISP_OK; ++n )
    {
        frozen_plane f;
        wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
        def.align = def.clump = false;
        def.stretch_stiffness = def.bend_stiffness = stiffness[n];
        status = plane_make( WISP_GROOM_WAVY, 1000, 0.006f, &def, &f, error );
        if ( n == 0 && status == WISP_OK )
        {
            figures_hair_begin( page, &album, "original" );
            status = take( page, &album, f.groom.points, 40, error );
        }
        if ( status == WISP_OK )
        {
            noise[n] = measure_noise( &f );
            figures_hair_begin( page, &album, "stiffness %.0f", (double)stiffness[n] );
            status = take( page, &album, f.points, 40, error );
        }
        plane_free( &f );
    }
    if ( status == WISP_OK )
    {
        // 3 sigma of 18 000 bends, neighbours correlated by 0.1, and of 19 000 lengths
        const bool is_met = fabs( noise[0].bend - 4.29 ) < 0.08 && fabs( noise[1].bend - 10.0 ) < 0.18 &&
                            fabs( noise[0].spread - 0.0825 ) < 0.001 && fabs( noise[1].spread - 0.1925 ) < 0.002;
        figures_add( page, "Kim 2026, Fig. 2", "1000 wavy strands, stiffness 7 and 3",
                     "bends change by 4.29 and 10.0 degrees in the mean, lengths spread by 8.2 and 19.2 %", is_met,
                     "%.2f and %.2f degrees, %.2f and %.2f %%", noise[0].bend, noise[1].bend, 100.0 * noise[0].spread,
                     100.0 * noise[1].spread );
        status =
            figures_hair_write( page, &album, "frozen_hair_2_stiffness",
                                "Kim 2026, Fig. 2: stiffness 7 is less wavy than 3, and both more than the original, "
                                "as eq. 4 to 7 can only add noise",
                                error );
    }
    figures_hair_free( &album );
    return status;
}

// ---- Fig. 3 ----

typedef struct clump_stats
{
    int locks;  // sets of strands that run side by side
    double gap; // m, mean distance of a vertex to the nearest one of another strand
} clump_stats;

static double nearest_vertex( wisp_vec3 p, const wisp_vec3* strand )
{
    double nearest = HUGE_VAL;
    for ( int i = 0; i < VERTICES; ++i )
    {
        nearest = fmin( nearest, length_of( from_to( p, strand[i] ) ) );
    }
    return nearest;
}

// Most of the vertices of either strand are nearer to the other one than half of the distance of neighbouring roots.
static bool run_together( const wisp_vec3* a, const wisp_vec3* b, double spacing )
{
    int near_a = 0, near_b = 0;
    for ( int i = 1; i < VERTICES; ++i )
    {
        near_a += nearest_vertex( a[i], b ) < spacing / 2.0;
        near_b += nearest_vertex( b[i], a ) < spacing / 2.0;
    }
    return 2 * near_a > VERTICES - 1 && 2 * near_b > VERTICES - 1;
}

static clump_stats measure_clumps( const frozen_plane* f, double spacing, int* lock )
{
    clump_stats c = { .locks = f->groom.strand_count };
    for ( int s = 0; s < f->groom.strand_count; ++s )
    {
        const wisp_vec3* strand = f->points + s * VERTICES;
        lock[s] = s;
        for ( int q = 0; q < s; ++q )
        {
            if ( lock[q] != lock[s] && run_together( strand, f->points + q * VERTICES, spacing ) )
            {
                const int from = lock[q], to = lock[s];
                for ( int k = 0; k <= s; ++k )
                {
                    lock[k] = lock[k] == from ? to : lock[k];
                }
                c.locks -= 1;
            }
        }
        for ( int i = 1; i < VERTICES; ++i )
        {
            double nearest = HUGE_VAL;
            for ( int q = 0; q < f->groom.strand_count; ++q )
            {
                nearest = q == s ? nearest : fmin( nearest, nearest_vertex( strand[i], f->points + q * VERTICES ) );
            }
            c.gap += nearest / ( f->groom.strand_count * ( VERTICES - 1 ) );
        }
    }
    return c;
}

// One of the rules of Fig. 3, on aligned strands.
typedef struct clump_rule
{
    const char* label;
    bool clumps, is_printed;
    wisp_gap gap;
} clump_rule;

static const clump_rule rules[] = {
    { "aligned", false, false, WISP_GAP_NONE },
    { "wet: no gap", true, false, WISP_GAP_NONE },
    { "printed: signed gap", true, true, WISP_GAP_ABSOLUTE },
    { "prose: absolute gap", true, false, WISP_GAP_ABSOLUTE },
};

enum
{
    RULES = 4,
    CLUMPED = 100,     // strands that are counted
    DRAWN = 24,        // strands of the picture
    CLUMP_ROUNDS = 16, // iterations: the more, the stronger the clumps (section III.4)
};

// A far cursor, which turns all strands by nearly the same angle: their density stays.
static wisp_frozen_hair_def clump_def( const clump_rule* rule )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.cursor = ( wisp_vec3 ){ 1.0f, -2.0f, 0.0f };
    def.reach = 10.0f;
    def.gap = rule->gap;
    def.clump_iterations = CLUMP_ROUNDS;
    return def;
}

// Eq. 14 to 19 with the gap as printed, by the oracle, on strands that the engine has aligned.
static wisp_status print_clumps( frozen_plane* f, const wisp_frozen_hair_def* def, wisp_error* error )
{
    const size_t count = (size_t)f->groom.vertex_count;
    double3* wide = calloc( 2 * count, sizeof( double3 ) );
    f->printed = calloc( count, sizeof( wisp_vec3 ) );
    if ( !wide || !f->printed )
    {
        free( wide );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d printed strands", f->groom.strand_count );
    }
    for ( size_t v = 0; v < count; ++v )
    {
        wide[v] = double3_widen( f->points[v] );
    }
    const frozen_oracle_hair hair = { .strand_count = f->groom.strand_count,
                                      .offsets = f->groom.offsets,
                                      .rest = wide };
    frozen_oracle_options options = frozen_oracle_default_options();
    options.clump_iterations = def->clump_iterations;
    options.gap = FROZEN_ORACLE_GAP_SIGNED;
    options.dimension = 2;
    options.seed = def->seed;
    const wisp_status status = frozen_oracle_clump( &hair, &options, wide, NULL, wide + count );
    for ( size_t v = 0; v < count; ++v )
    {
        f->printed[v] = ( wisp_vec3 ){ (float)wide[count + v].x, (float)wide[count + v].y, 0.0f };
    }
    f->points = f->printed;
    free( wide );
    return status == WISP_OK ? WISP_OK : wisp_fail( error, status, "the oracle has no memory for its neighbours" );
}

static wisp_status clump_by( const clump_rule* rule, int strands, float spacing, frozen_plane* f, wisp_error* error )
{
    wisp_frozen_hair_def def = clump_def( rule );
    def.clump = rule->clumps && !rule->is_printed;
    const wisp_status status = plane_make( WISP_GROOM_STRAIGHT, strands, spacing, &def, f, error );
    return status == WISP_OK && rule->is_printed ? print_clumps( f, &def, error ) : status;
}

// @param spacing m, between roots, in clump radii of 1 cm @param c [RULES] receives what was counted
static wisp_status count_clumps( float spacing, clump_stats* c, wisp_error* error )
{
    int lock[CLUMPED];
    wisp_status status = WISP_OK;
    for ( int n = 0; n < RULES && status == WISP_OK; ++n )
    {
        frozen_plane f;
        status = clump_by( &rules[n], CLUMPED, spacing, &f, error );
        if ( status == WISP_OK )
        {
            c[n] = measure_clumps( &f, (double)spacing, lock );
        }
        plane_free( &f );
    }
    return status;
}

static wisp_status draw_clumps( figures_case* page, float spacing, wisp_error* error )
{
    figures_hair_album album = { .count = 0, .is_flat = true };
    wisp_status status = WISP_OK;
    for ( int n = 0; n < RULES && status == WISP_OK; ++n )
    {
        frozen_plane f;
        int lock[DRAWN];
        status = clump_by( &rules[n], DRAWN, spacing, &f, error );
        if ( n == 0 && status == WISP_OK )
        {
            figures_hair_begin( page, &album, "original" );
            status = take( page, &album, f.groom.points, DRAWN, error );
        }
        if ( status == WISP_OK )
        {
            const clump_stats c = measure_clumps( &f, (double)spacing, lock );
            figures_hair_begin( page, &album, "%s, %.1f mm", rules[n].label, 1e3 * c.gap );
            status = take( page, &album, f.points, DRAWN, error );
        }
        plane_free( &f );
    }
    if ( status == WISP_OK )
    {
        status =
            figures_hair_write( page, &album, "frozen_hair_3_clumps",
                                "Kim 2026, Fig. 3: strands that were aligned, then clumped by 16 iterations, with "
                                "roots 0.7 of the clump radius apart; numbers are mean distances to the next strand",
                                error );
    }
    figures_hair_free( &album );
    return status;
}

// The paper names no density: that of table 1, and sparser ones.
wisp_status figures_frozen_clumps( figures_case* page, wisp_error* error )
{
    static const float spacings[] = { 0.0012f, 0.002f, 0.004f };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( spacings ) && status == WISP_OK; ++i )
    {
        char experiment[96];
        clump_stats c[RULES] = { { .locks = 0 } };
        status = count_clumps( spacings[i], c, error );
        const bool forms_locks =
            4 * c[1].locks < 3 * c[0].locks && 4 * c[2].locks < 3 * c[0].locks && 4 * c[3].locks < 3 * c[0].locks;
        const bool keeps_gaps = c[0].gap > c[3].gap && c[3].gap > c[2].gap && c[2].gap > c[1].gap;
        snprintf( experiment, sizeof experiment, "%d aligned strands, roots %.2f h apart, clumped by three rules",
                  CLUMPED, 100.0 * (double)spacings[i] );
        if ( status == WISP_OK )
        {
            figures_add(
                page, "Kim 2026, Fig. 3", experiment,
                "under each rule a quarter fewer locks of strands than before; gaps: absolute > signed > none",
                forms_locks && keeps_gaps,
                "%d locks before, %d, %d and %d; gaps of %.2f mm before, %.2f, %.2f and %.2f", c[0].locks, c[3].locks,
                c[2].locks, c[1].locks, 1e3 * c[0].gap, 1e3 * c[3].gap, 1e3 * c[2].gap, 1e3 * c[1].gap );
        }
    }
    return status == WISP_OK ? draw_clumps( page, 0.007f, error ) : status;
}

// ---- pictures of hair ----

#define HAIR_PIXELS 480

void figures_hair_begin( const figures_case* page, figures_hair_album* album, const char* format, ... )
{
    if ( !page->pictures || album->count == FIGURES_HAIR_SHOTS_MAX )
    {
        return;
    }
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( album->labels[album->count], sizeof( album->labels[0] ), format, arguments );
    va_end( arguments );
    ++album->count;
}

wisp_status figures_hair_add( const figures_case* page, figures_hair_album* album, const wisp_vec3* points,
                              int strand_count, int vertices, wisp_vec3 colour, float radius, wisp_error* error )
{
    int shot = album->count - 1;
    if ( !page->pictures || shot < 0 || album->layer_count[shot] == FIGURES_HAIR_LAYERS_MAX )
    {
        return WISP_OK;
    }
    figures_hair_layer* layer = &album->layers[shot][album->layer_count[shot]++];
    size_t bytes = (size_t)strand_count * (size_t)vertices * sizeof( wisp_vec3 );
    *layer = ( figures_hair_layer ){
        .points = malloc( bytes ),
        .offsets = malloc( ( (size_t)strand_count + 1 ) * sizeof( int32_t ) ),
        .strand_count = strand_count,
        .colour = colour,
        .radius = radius,
    };
    if ( !layer->points || !layer->offsets )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
    }
    memcpy( layer->points, points, bytes );
    for ( int s = 0; s <= strand_count; ++s )
    {
        layer->offsets[s] = s * vertices;
    }
    return WISP_OK;
}

static float blend( float a, float b, float t )
{
    return a + ( b - a ) * t;
}

wisp_status figures_hair_add_blended( const figures_case* page, figures_hair_album* album, const wisp_vec3* points,
                                      int strand_count, int vertices, wisp_vec3 root_colour, wisp_vec3 tip_colour,
                                      float radius, wisp_error* error )
{
    const int shot = album->count - 1;
    const int layers = page->pictures && shot >= 0 ? album->layer_count[shot] : FIGURES_HAIR_LAYERS_MAX;
    wisp_status status = figures_hair_add( page, album, points, strand_count, vertices, root_colour, radius, error );
    if ( status != WISP_OK || layers == FIGURES_HAIR_LAYERS_MAX )
    {
        return status;
    }
    wisp_vec3* colours = malloc( (size_t)strand_count * (size_t)vertices * sizeof( wisp_vec3 ) );
    for ( int i = 0; i < strand_count * vertices && colours; ++i )
    {
        const float t = vertices > 1 ? (float)( i % vertices ) / (float)( vertices - 1 ) : 0.0f;
        colours[i] = ( wisp_vec3 ){ blend( root_colour.x, tip_colour.x, t ), blend( root_colour.y, tip_colour.y, t ),
                                    blend( root_colour.z, tip_colour.z, t ) };
    }
    album->layers[shot][layers].colours = colours;
    return colours ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a picture" );
}

void figures_hair_free( figures_hair_album* album )
{
    for ( int shot = 0; shot < album->count; ++shot )
    {
        for ( int i = 0; i < album->layer_count[shot]; ++i )
        {
            free( album->layers[shot][i].points );
            free( album->layers[shot][i].offsets );
            free( album->layers[shot][i].colours );
        }
    }
    *album = ( figures_hair_album ){ .count = 0 };
}

static void set_hair_scene( const figures_hair_album* album, int shot, render_curves* curves, render_scene* scene )
{
    for ( int i = 0; i < album->layer_count[shot]; ++i )
    {
        const figures_hair_layer* layer = &album->layers[shot][i];
        curves[i] = render_default_curves();
        curves[i].points = layer->points;
        curves[i].offsets = layer->offsets;
        curves[i].strand_count = layer->strand_count;
        curves[i].colour = layer->colour;
        curves[i].colours = layer->colours;
        curves[i].radius = layer->radius;
        curves[i].is_hair = album->is_flat && layer->colours;
    }
    *scene = render_default_scene();
    scene->curves = curves;
    scene->curves_count = album->layer_count[shot];
    if ( album->is_flat )
    {
        scene->background_top = scene->background_bottom = ( wisp_vec3 ){ 1.0f, 1.0f, 1.0f };
    }
}

static wisp_status shot_bounds( const figures_hair_album* album, int shot, render_bounds* bounds, wisp_error* error )
{
    render_curves curves[FIGURES_HAIR_LAYERS_MAX];
    render_scene scene;
    *bounds = ( render_bounds ){ .is_filled = false };
    set_hair_scene( album, shot, curves, &scene );
    return render_scene_bounds( &scene, bounds, error );
}

static wisp_vec3 half_sum( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ 0.5f * ( a.x + b.x ), 0.5f * ( a.y + b.y ), 0.5f * ( a.z + b.z ) };
}

// All shots have one scale, so that they can be compared. Hair in the plane is seen from one place; other shots, which swing
// or differ in size, each have their own in the middle.
static wisp_status find_hair_camera( const figures_hair_album* album, int shot, render_camera* camera,
                                     wisp_error* error )
{
    render_bounds all = { .is_filled = false }, own, other;
    wisp_vec3 half = { 0.0f, 0.0f, 0.0f }; // of the largest
    wisp_status status = shot_bounds( album, shot, &own, error );
    for ( int i = 0; i < album->count && status == WISP_OK; ++i )
    {
        status = shot_bounds( album, i, &other, error );
        const wisp_vec3 low = other.lower, high = other.upper;
        half = ( wisp_vec3 ){ fmaxf( half.x, 0.5f * ( high.x - low.x ) ), fmaxf( half.y, 0.5f * ( high.y - low.y ) ),
                              fmaxf( half.z, 0.5f * ( high.z - low.z ) ) };
        all = render_bounds_union( all, other );
    }
    render_view view = render_default_view();
    const wisp_vec3 middle = half_sum( own.lower, own.upper );
    const render_bounds box = { { middle.x - half.x, middle.y - half.y, middle.z - half.z },
                                { middle.x + half.x, middle.y + half.y, middle.z + half.z },
                                own.is_filled };
    if ( album->is_flat )
    {
        view.azimuth_degrees = view.elevation_degrees = 0.0f;
    }
    return status == WISP_OK ? render_frame_camera( album->is_flat ? &all : &box, &view, 1.0f, camera, error )
                             : status;
}

static wisp_status draw( const figures_hair_album* album, picture_sheet* sheet, wisp_error* error )
{
    render_options options = render_default_options();
    options.width = HAIR_PIXELS;
    options.height = HAIR_PIXELS;
    options.threads = 2;
    wisp_status status = WISP_OK;
    for ( int shot = 0; shot < album->count && status == WISP_OK; ++shot )
    {
        render_camera camera;
        render_curves curves[FIGURES_HAIR_LAYERS_MAX];
        render_scene scene;
        set_hair_scene( album, shot, curves, &scene );
        status = find_hair_camera( album, shot, &camera, error );
        status =
            status == WISP_OK ? render_picture( &scene, &camera, &options, &sheet->pictures[shot], error ) : status;
        sheet->labels[shot] = album->labels[shot];
        sheet->count = shot + 1;
    }
    return status;
}

wisp_status figures_hair_write( figures_case* page, const figures_hair_album* album, const char* name,
                                const char* caption, wisp_error* error )
{
    if ( !page->pictures || album->count == 0 )
    {
        return WISP_OK;
    }
    picture_sheet sheet = { .count = 0 };
    const wisp_status status = draw( album, &sheet, error );
    return picture_sheet_finish( &sheet, status, page->pictures, name, caption, page->out, error );
}
