// Strands released horizontally: the cost of each way to keep their lengths, and its effect on the fall.
#include "scene_tools.h"
#include "strands_swing.h"

#include <math.h>
#include <stdlib.h>

#define FALL_STEPS 60
#define FALL_OBSERVATION 5
// Below this time in seconds fewer strands fall; strands do not touch, so the statistics stay the same.
#define FULL_SECONDS 15.0
#define MANY_STRANDS 1024
#define FEW_STRANDS 256
// A hair of 80 um diameter and a modulus of 4 GPa: the stiffness of a segment that stretches.
#define HAIR_STRETCH 20.1 // N

typedef struct fall_way
{
    strands_setting solve;
    wisp_solver solver;
    int sweeps;
} fall_way;

/// A method with the substeps and sweeps to try.
typedef struct fall_family
{
    const char* name;
    wisp_strand_stretch stretch;
    wisp_solver solver;
    int passes;
    double order; // in the substep
} fall_family;

// Follow the leader converges to another motion however short the substep, so no order is expected.
static const fall_family families[] = {
    { "direct", WISP_STRAND_STRETCH_DIRECT, WISP_SOLVER_XPBD, 8, 1.0 },
    { "direct, 1 Newton pass", WISP_STRAND_STRETCH_DIRECT, WISP_SOLVER_XPBD, 1, 1.0 },
    { "pbd, 1 sweep", WISP_STRAND_STRETCH_LINKS, WISP_SOLVER_PBD, 1, 1.0 },
    { "xpbd, 1 sweep", WISP_STRAND_STRETCH_LINKS, WISP_SOLVER_XPBD, 1, 1.0 },
    { "follow the leader", WISP_STRAND_STRETCH_FOLLOW, WISP_SOLVER_XPBD, 1, NAN },
};

static const int substeps_tried[] = { 1, 2, 4, 10, 20, 40 };

/// Sweeps at a fixed number of substeps.
typedef struct fall_sweeps
{
    const char* name;
    wisp_solver solver;
    int substeps;
    int first, last; // each twice the previous one
} fall_sweeps;

static const fall_sweeps sweeps_tried[] = {
    { "pbd, 1 substep", WISP_SOLVER_PBD, 1, 2, 128 },
    { "xpbd, 10 substeps", WISP_SOLVER_XPBD, 10, 2, 16 },
};

#define WAYS_MAX 64

typedef struct fall
{
    strands_shape shape;
    wisp_vec3* reference; // [vertex_count] after STRANDS_REFERENCE_STEPS
    fall_way ways[WAYS_MAX];
} fall;

static strands_generator make_generator( const fall* f, const fall_way* way, int workers, bool is_observed )
{
    strands_generator generator = strands_default_generator( &f->shape );
    generator.dynamics = strands_setting_dynamics( &way->solve );
    generator.dynamics.solver = way->solver;
    generator.dynamics.stretch_compliance = (float)( (double)STRANDS_SPACING / HAIR_STRETCH );
    generator.substeps = way->solve.substeps;
    generator.iterations = way->sweeps;
    generator.workers = workers;
    generator.has_motion_stats = is_observed;
    return generator;
}

// ---- reference ----

accuracy_reference strands_swing_reference( void )
{
    accuracy_reference reference = { .scene = "strands_swing", .number_count = 2 * STRANDS_VERTICES };
    accuracy_reference_put( &reference, "vertices", STRANDS_VERTICES );
    accuracy_reference_put( &reference, "segment, m", (double)STRANDS_SPACING );
    accuracy_reference_put( &reference, "gravity, m/s2", STRANDS_GRAVITY );
    accuracy_reference_put( &reference, "steps a second", 1.0 / (double)STRANDS_STEP );
    accuracy_reference_put( &reference, "steps", STRANDS_REFERENCE_STEPS );
    return reference;
}

// Every strand in its initial direction.
static wisp_status lay_reference( fall* f, const double* numbers, wisp_error* error )
{
    f->reference = malloc( (size_t)strands_shape_size( &f->shape ) * sizeof( wisp_vec3 ) );
    if ( !f->reference )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a converged run" );
    }
    const double length = (double)STRANDS_SPACING * ( STRANDS_VERTICES - 1 );
    for ( int i = 0; i < strands_shape_size( &f->shape ); ++i )
    {
        const int v = i % STRANDS_VERTICES, tip = i - v + STRANDS_VERTICES - 1;
        const double along = numbers[2 * v] / length, up = numbers[2 * v + 1];
        f->reference[i] = ( wisp_vec3 ){ (float)( along * (double)f->shape.points[tip].x ), (float)up,
                                         (float)( along * (double)f->shape.points[tip].z ) };
    }
    return WISP_OK;
}

static wisp_status read_reference( fall* f, accuracy_scene* out, wisp_error* error )
{
    const accuracy_reference requested = strands_swing_reference();
    accuracy_reference reference;
    wisp_status status = accuracy_reference_read( accuracy_reference_folder(), &requested, &reference, error );
    if ( status == WISP_OK )
    {
        accuracy_describe_reference( &reference, 1e3, out );
        status = lay_reference( f, reference.numbers, error );
        accuracy_reference_free( &reference );
    }
    return status;
}

// ---- a run ----

enum
{
    STRETCH_MAX,
    STRETCH_MEAN,
    ENERGY_DRIFT,
    LAID_OUT,
    MEASURES,
};

// Released energy is the work of gravity so far; the strands start at rest at height 0, so their energy was 0.
static wisp_status observe_energy( const strands_implementation* implementation, accuracy_run* out,
                                   wisp_error* error )
{
    wisp_motion_stats motion_stats = { 0 };
    const wisp_status status = wisp_read_motion_stats( implementation->world, implementation->entity, &motion_stats );
    out->measures[ENERGY_DRIFT] =
        100.0 * ( motion_stats.kinetic_energy + motion_stats.potential_energy ) / -motion_stats.potential_energy;
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

static wisp_status observe( const fall* f, strands_implementation* implementation, accuracy_run* out,
                            wisp_error* error )
{
    const wisp_vec3* points = NULL;
    wisp_status status = strands_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const strands_stretch stretch = strands_measure_stretch( &f->shape, points );
    out->measures[STRETCH_MAX] = fmax( out->measures[STRETCH_MAX], 100.0 * stretch.max );
    out->measures[STRETCH_MEAN] += 100.0 * stretch.mean * FALL_OBSERVATION / FALL_STEPS;
    if ( implementation->steps == STRANDS_REFERENCE_STEPS )
    {
        out->error = 1e3 * strands_rms_distance( points, f->reference, strands_shape_size( &f->shape ) );
    }
    return observe_energy( implementation, out, error );
}

static wisp_status run_fall( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                             wisp_error* error )
{
    fall* f = context;
    const strands_generator generator = make_generator( f, &f->ways[setting], workers, is_observed );
    strands_implementation implementation = { 0 };
    out->measures[STRETCH_MAX] = out->measures[STRETCH_MEAN] = 0.0;
    wisp_status status = strands_implementation_create( &generator, &implementation, error );
    for ( int s = 1; s <= FALL_STEPS && status == WISP_OK; ++s )
    {
        status = accuracy_time_step( strands_implementation_step, &implementation, out, error );
        const bool is_due = is_observed && s % FALL_OBSERVATION == 0;
        status = status == WISP_OK && is_due ? observe( f, &implementation, out, error ) : status;
    }
    status = status == WISP_OK ? strands_implementation_hash( &implementation, &out->hash, error ) : status;
    out->halted_at = implementation.halted_at;
    if ( status == WISP_OK )
    {
        out->measures[LAID_OUT] =
            (double)wisp_world_counter( implementation.world, WISP_COUNT_STRAND_RESET ) / f->shape.strand_count;
    }
    strands_implementation_destroy( &implementation );
    return status;
}

// ---- settings ----

static void put_substeps( accuracy_scene* scene, const fall_family* family )
{
    fall* f = scene->context;
    for ( int i = 0; i < WISP_COUNT( substeps_tried ); ++i )
    {
        const int substeps = substeps_tried[i];
        f->ways[scene->setting_count] = ( fall_way ){
            { family->name, family->stretch, WISP_STRAND_BEND_NONE, family->passes, substeps }, family->solver, 1
        };
        accuracy_join_series( accuracy_put_setting( scene, "%s, %d substeps", family->name, substeps ), family->name,
                              "substep, s", (double)STRANDS_STEP / substeps, family->order );
    }
}

static void put_sweeps( accuracy_scene* scene, const fall_sweeps* tried )
{
    fall* f = scene->context;
    for ( int sweeps = tried->first; sweeps <= tried->last; sweeps *= 2 )
    {
        f->ways[scene->setting_count] =
            ( fall_way ){ { tried->name, WISP_STRAND_STRETCH_LINKS, WISP_STRAND_BEND_NONE, 1, tried->substeps },
                          tried->solver,
                          sweeps };
        accuracy_join_series( accuracy_put_setting( scene, "%s, %d sweeps", tried->name, sweeps ), tried->name,
                              "1 / sweeps", 1.0 / sweeps, NAN );
    }
}

static void destroy_fall( void* context )
{
    fall* f = context;
    strands_shape_free( &f->shape );
    free( f->reference );
    free( f );
}

wisp_status accuracy_strands_swing( const bench_options* options, double seconds, accuracy_scene* out,
                                    wisp_error* error )
{
    (void)options;
    fall* f = calloc( 1, sizeof( fall ) );
    *out = ( accuracy_scene ){
        .error_name = "distance to the reference",
        .error_unit = "mm",
        .measure_names = { "stretch max %", "stretch mean %", "energy drift %", "resets per strand" },
        .measure_count = MEASURES,
        .context = f,
        .run = run_fall,
        .destroy = destroy_fall,
    };
    if ( !f )
    {
        return accuracy_abandon( out, wisp_fail( error, WISP_NO_MEMORY, "no memory for strands that fall" ) );
    }
    wisp_status status =
        strands_shape_make_horizontal( seconds < FULL_SECONDS ? FEW_STRANDS : MANY_STRANDS, &f->shape, error );
    status = status == WISP_OK ? read_reference( f, out, error ) : status;
    status = status == WISP_OK ? accuracy_reserve_settings( out, WAYS_MAX, error ) : status;
    if ( status != WISP_OK )
    {
        return accuracy_abandon( out, status );
    }
    for ( int i = 0; i < WISP_COUNT( families ); ++i )
    {
        put_substeps( out, &families[i] );
    }
    for ( int i = 0; i < WISP_COUNT( sweeps_tried ); ++i )
    {
        put_sweeps( out, &sweeps_tried[i] );
    }
    return WISP_OK;
}
