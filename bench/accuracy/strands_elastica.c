// Rods of three lengths that bend under their own weight, against the heavy elastica. They fall from the horizontal,
// which is also the direction of their clamp, and come to rest at a shape that depends on vertices and substeps.
// Motion that remains then is jitter.
#include "elastica.h"
#include "scene_tools.h"
#include "strands_scene.h"

#include <math.h>
#include <stdlib.h>

// m, of the rods with G = 10: a hair of ordinary length and mass. All rods have its stiffness.
#define ROD_LENGTH 0.2
#define LOADS 3
#define ROD_DAMPING 9.0f
#define ROD_VERTICES_MAX 64
// By then the slowest swing is below rounding; the last steps show motion that does not decay.
#define REST_STEPS 180
#define JITTER_STEPS 30
#define FEWEST_RODS 12 // multiples of the loads
#define FEW_RODS 36
#define MANY_RODS 144
#define FEW_SECONDS 4.0
#define FULL_SECONDS 15.0

// G, proportional to the third power of the length.
static const double loads[LOADS] = { 1.0, 10.0, 100.0 };

typedef struct rod_way
{
    int vertices, substeps;
} rod_way;

#define WAYS_MAX 64

typedef struct rods
{
    int count;
    rod_way ways[WAYS_MAX];
} rods;

// ---- rods ----

static double length_of( int rod )
{
    return ROD_LENGTH * cbrt( loads[rod % LOADS] / 10.0 );
}

// Each in its own vertical plane. @param curve [vertices] of a rod of length 1
static void lay_rod( int rod, int vertices, double ( *curve )[2], wisp_vec3* points )
{
    const double plane = 2.399963229728653 * rod; // multiples of the golden angle never repeat
    for ( int v = 0; v < vertices; ++v )
    {
        const double aside = length_of( rod ) * curve[v][0], up = length_of( rod ) * curve[v][1];
        points[rod * vertices + v] =
            ( wisp_vec3 ){ (float)( aside * cos( plane ) ), (float)up, (float)( aside * sin( plane ) ) };
    }
}

static wisp_status make_rods( int count, int vertices, strands_shape* out, wisp_error* error )
{
    double straight[ROD_VERTICES_MAX][2];
    for ( int v = 0; v < vertices; ++v )
    {
        straight[v][0] = (double)v / ( vertices - 1 );
        straight[v][1] = 0.0;
    }
    const wisp_status status = strands_shape_create( count, vertices, out, error );
    for ( int rod = 0; rod < count && status == WISP_OK; ++rod )
    {
        lay_rod( rod, vertices, straight, out->points );
    }
    return status;
}

// A tenth of a second: only for sampled runs.
static wisp_status make_reference( int count, int vertices, strands_shape* out, wisp_error* error )
{
    double bent[LOADS][ROD_VERTICES_MAX][2];
    for ( int i = 0; i < LOADS; ++i )
    {
        elastica_lay( loads[i], vertices, bent[i] );
    }
    const wisp_status status = strands_shape_create( count, vertices, out, error );
    for ( int rod = 0; rod < count && status == WISP_OK; ++rod )
    {
        lay_rod( rod, vertices, bent[rod % LOADS], out->points );
    }
    return status;
}

static strands_generator make_generator( const rod_way* way, const strands_shape* shape, int workers,
                                         bool is_observed )
{
    strands_generator generator = strands_default_generator( shape );
    const double weight = (double)generator.dynamics.line_density * STRANDS_GRAVITY;
    const double rigidity = weight * ROD_LENGTH * ROD_LENGTH * ROD_LENGTH / 10.0;
    generator.dynamics.rest = WISP_STRAND_REST_STRAIGHT;
    generator.dynamics.bend_rigidity = (float)rigidity;
    generator.dynamics.damping = ROD_DAMPING;
    generator.substeps = way->substeps;
    generator.workers = workers;
    generator.has_motion_stats = is_observed;
    return generator;
}

// ---- a run ----

enum
{
    ERROR_OF_LOAD, // LOADS of them
    JITTER = ERROR_OF_LOAD + LOADS,
    STRETCH_MAX,
    MEASURES,
};

static wisp_status keep_jitter( strands_implementation* implementation, accuracy_run* out, wisp_error* error )
{
    wisp_motion_stats motion_stats = { 0 };
    const wisp_status status = wisp_read_motion_stats( implementation->world, implementation->entity, &motion_stats );
    out->measures[JITTER] = fmax( out->measures[JITTER], 1e6 * motion_stats.speed_max );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

// Root mean square distances in lengths of the rods.
static void measure_distance( const strands_shape* reference, const wisp_vec3* points, accuracy_run* out )
{
    double squares[LOADS] = { 0.0 }, all = 0.0;
    for ( int rod = 0; rod < reference->strand_count; ++rod )
    {
        const size_t first = (size_t)rod * (size_t)reference->vertices;
        const double off =
            strands_rms_distance( points + first, reference->points + first, reference->vertices ) / length_of( rod );
        squares[rod % LOADS] += off * off / ( reference->strand_count / LOADS );
        all += off * off / reference->strand_count;
    }
    for ( int i = 0; i < LOADS; ++i )
    {
        out->measures[ERROR_OF_LOAD + i] = 100.0 * sqrt( squares[i] );
    }
    out->error = 100.0 * sqrt( all );
}

static wisp_status judge( strands_implementation* implementation, const strands_shape* reference, accuracy_run* out,
                          wisp_error* error )
{
    const wisp_vec3* points = NULL;
    const wisp_status status = strands_implementation_points( implementation, &points, error );
    if ( status == WISP_OK )
    {
        measure_distance( reference, points, out );
        out->measures[STRETCH_MAX] = 100.0 * strands_measure_stretch( implementation->generator.shape, points ).max;
    }
    return status;
}

static wisp_status run_rods( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    const rods* all = context;
    const int vertices = all->ways[setting].vertices;
    strands_shape shape = { 0 }, reference = { 0 };
    strands_implementation implementation = { 0 };
    wisp_status status = make_rods( all->count, vertices, &shape, error );
    status = status == WISP_OK && is_observed ? make_reference( all->count, vertices, &reference, error ) : status;
    const strands_generator generator = make_generator( &all->ways[setting], &shape, workers, is_observed );
    status = status == WISP_OK ? strands_implementation_create( &generator, &implementation, error ) : status;
    out->measures[JITTER] = is_observed ? 0.0 : NAN;
    for ( int s = 1; s <= REST_STEPS && status == WISP_OK; ++s )
    {
        const bool is_due = is_observed && s > REST_STEPS - JITTER_STEPS;
        status = accuracy_time_step( strands_implementation_step, &implementation, out, error );
        status = status == WISP_OK && is_due ? keep_jitter( &implementation, out, error ) : status;
    }
    status = status == WISP_OK && is_observed ? judge( &implementation, &reference, out, error ) : status;
    status = status == WISP_OK ? strands_implementation_hash( &implementation, &out->hash, error ) : status;
    out->halted_at = implementation.halted_at;
    strands_implementation_destroy( &implementation );
    strands_shape_free( &shape );
    strands_shape_free( &reference );
    return status;
}

// ---- settings ----

static accuracy_setting* put_way( accuracy_scene* scene, rod_way way )
{
    rods* all = scene->context;
    all->ways[scene->setting_count] = way;
    return accuracy_put_setting( scene, "%d vertices, %d substeps", way.vertices, way.substeps );
}

static void put_vertices( accuracy_scene* scene )
{
    static const int tried[] = { 4, 8, 16, 32, 64 };
    for ( int i = 0; i < WISP_COUNT( tried ); ++i )
    {
        accuracy_join_series( put_way( scene, ( rod_way ){ tried[i], 10 } ), "vertices, 10 substeps",
                              "segment of the length", 1.0 / ( tried[i] - 1 ), 2.0 );
    }
}

// Substeps change the motion but not the shape at rest, so no order is expected.
static void put_substeps( accuracy_scene* scene, int vertices )
{
    static const int tried[] = { 1, 2, 4, 20 };
    char series[48];
    snprintf( series, sizeof( series ), "substeps, %d vertices", vertices );
    for ( int i = 0; i < WISP_COUNT( tried ); ++i )
    {
        accuracy_join_series( put_way( scene, ( rod_way ){ vertices, tried[i] } ), series, "substep, s",
                              (double)STRANDS_STEP / tried[i], NAN );
    }
}

wisp_status accuracy_strands_elastica( const bench_options* options, double seconds, accuracy_scene* out,
                                       wisp_error* error )
{
    (void)options;
    rods* all = calloc( 1, sizeof( rods ) );
    *out = ( accuracy_scene ){
        .reference =
            "closed form: the heavy elastica; root mean square over all vertices in units of length, after 3 s",
        .error_name = "distance to the elastica",
        .error_unit = "%",
        .measure_names = { "G = 1 %", "G = 10 %", "G = 100 %", "jitter um/s", "stretch max %" },
        .measure_count = MEASURES,
        .context = all,
        .run = run_rods,
        .destroy = free,
    };
    const wisp_status status = all ? accuracy_reserve_settings( out, WAYS_MAX, error )
                                   : wisp_fail( error, WISP_NO_MEMORY, "no memory for rods" );
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    all->count = seconds < FEW_SECONDS ? FEWEST_RODS : seconds < FULL_SECONDS ? FEW_RODS : MANY_RODS;
    put_vertices( out );
    put_substeps( out, 16 );
    put_substeps( out, 64 );
    return WISP_OK;
}
