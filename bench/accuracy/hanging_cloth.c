// A square of cloth held at two corners falls from the horizontal, on three meshes of the same sheet.
#include "accuracy_surface.h"
#include "hanging_cloth.h"

#include <math.h>
#include <stdlib.h>

#define WIDTH 1.6           // m
#define BEND_STIFFNESS 1e-4 // N m, of a bend link times its mesh's spacing squared
#define SETTINGS_MAX 48

enum
{
    FINEST = HANGING_CLOTH_MESHES - 1,
    MAX_SUBSTEPS = 40,
    SUBSTEPS_OF_MESHES = 160, // enough that the remaining error is that of the mesh
};

const int hanging_cloth_sizes[HANGING_CLOTH_MESHES] = { 9, 17, 33, 65 };

typedef struct hang_way
{
    int mesh; // of hanging_cloth_sizes
    wisp_solver solver;
    cloth_setting setting;
    wisp_fabric* fabric;
} hang_way;

typedef struct hang_scene
{
    cloth_scene meshes[HANGING_CLOTH_MESHES];
    accuracy_reference reference;
    hang_way ways[SETTINGS_MAX];
    int way_count;
} hang_scene;

// ---- the sheet ----

double hanging_cloth_spacing( int mesh )
{
    return WIDTH / ( hanging_cloth_sizes[mesh] - 1 );
}

double hanging_cloth_bend_compliance( int mesh )
{
    return hanging_cloth_spacing( mesh ) * hanging_cloth_spacing( mesh ) / BEND_STIFFNESS;
}

wisp_status hanging_cloth_make( int mesh, cloth_scene* out, wisp_error* error )
{
    const int n = hanging_cloth_sizes[mesh];
    *out = ( cloth_scene ){ .n = n, .pins = { 0, n - 1 } };
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = n;
    generator.rows = n;
    generator.spacing = (float)hanging_cloth_spacing( mesh );
    return wisp_mesh_generate( &generator, &out->mesh, error );
}

accuracy_reference hanging_cloth_reference( const cloth_scene* finest )
{
    accuracy_reference reference = { .scene = "hanging_cloth",
                                     .number_count = 3 * HANGING_CLOTH_OBSERVATIONS * HANGING_CLOTH_PLACES *
                                                     HANGING_CLOTH_PLACES };
    accuracy_reference_put( &reference, "vertices", finest->mesh.vertex_count );
    accuracy_reference_put( &reference, "width, m", WIDTH );
    accuracy_reference_put( &reference, "area density, kg/m2", (double)HANGING_CLOTH_DENSITY );
    accuracy_reference_put( &reference, "stiffness of an edge, N/m", HANGING_CLOTH_EDGE_STIFFNESS );
    accuracy_reference_put( &reference, "bending, m/N", hanging_cloth_bend_compliance( FINEST ) );
    accuracy_reference_put( &reference, "gravity, m/s2", (double)CLOTH_GRAVITY );
    accuracy_reference_put( &reference, "steps a second", 1.0 / (double)CLOTH_STEP );
    accuracy_reference_put( &reference, "steps between observations", HANGING_CLOTH_OBSERVATION_STEPS );
    accuracy_reference_put( &reference, "observations", HANGING_CLOTH_OBSERVATIONS );
    accuracy_reference_put_start( &reference, finest->mesh.points, finest->mesh.vertex_count );
    return reference;
}

static wisp_status read_reference( hang_scene* own, wisp_error* error )
{
    const accuracy_reference requested = hanging_cloth_reference( &own->meshes[FINEST] );
    return accuracy_reference_read( accuracy_reference_folder(), &requested, &own->reference, error );
}

// ---- a run ----

static wisp_status enter( const hang_scene* own, const hang_way* way, int workers, surface_implementation* out,
                          wisp_error* error )
{
    const cloth_scene* scene = &own->meshes[way->mesh];
    surface_generator generator = surface_default_generator( &wisp_cloth_module, way->fabric );
    generator.pins = scene->pins;
    generator.pin_count = WISP_COUNT( scene->pins );
    generator.area_density = HANGING_CLOTH_DENSITY;
    generator.gravity = ( wisp_vec3 ){ 0.0f, -CLOTH_GRAVITY, 0.0f };
    generator.substeps = way->setting.substeps;
    generator.iterations = way->setting.iterations;
    generator.workers = workers;
    wisp_status status = surface_implementation_create( &generator, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_cloth_def def = wisp_default_cloth_def();
    def.solver = way->solver;
    def.bending = way->solver == WISP_SOLVER_PBD ? WISP_CLOTH_BENDING_NONE : WISP_CLOTH_BENDING_LINKS;
    def.warp_compliance = def.weft_compliance = (float)( 1.0 / HANGING_CLOTH_EDGE_STIFFNESS );
    // the sum is isotropic: every edge has the same
    def.shear_compliance = (float)( 2.0 / HANGING_CLOTH_EDGE_STIFFNESS );
    def.bend_compliance = (float)hanging_cloth_bend_compliance( way->mesh );
    def.tethers = way->setting.tethers;
    def.level_passes = way->setting.levels ? 1 : 0;
    status = wisp_set_cloth( out->world, out->entity, &def );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}

// Mean square distance at the reference positions that the mesh contains, m^2.
static double square_distance( const hang_scene* own, int mesh, int observation, const wisp_vec3* points )
{
    const int side = HANGING_CLOTH_PLACES, n = hanging_cloth_sizes[mesh], places = n < side ? n : side;
    const int stride = ( n - 1 ) / ( places - 1 ), reference_stride = ( side - 1 ) / ( places - 1 );
    const double* reference = own->reference.numbers + (size_t)( 3 * observation * side * side );
    double sum = 0.0;
    for ( int i = 0; i < places * places; ++i )
    {
        const int row = i / places, column = i % places;
        const wisp_vec3 p = points[stride * ( row * n + column )];
        const double* q = reference + 3 * reference_stride * ( row * side + column );
        const double x = (double)p.x - q[0], y = (double)p.y - q[1], z = (double)p.z - q[2];
        sum += x * x + y * y + z * z;
    }
    return sum / ( places * places );
}

static wisp_status observe_path( const hang_scene* own, int mesh, int observation,
                                 surface_implementation* implementation, double* sum, wisp_error* error )
{
    const wisp_vec3* points;
    const wisp_status status = surface_implementation_points( implementation, &points, error );
    *sum += status == WISP_OK ? square_distance( own, mesh, observation, points ) : 0.0;
    return status;
}

static void measure( surface_implementation* implementation, double sum, accuracy_run* out )
{
    const surface_observation seen = surface_implementation_observe( implementation );
    out->error = 1e3 * sqrt( sum / HANGING_CLOTH_OBSERVATIONS );
    out->measures[0] = 1e2 * seen.stretch_max;
    out->measures[1] = 1e2 * seen.stretch_mean;
    out->measures[2] = seen.potential < 0.0 ? 1e2 * ( 1.0 + seen.kinetic / seen.potential ) : NAN;
}

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const hang_scene* own = context;
    const hang_way* way = &own->ways[setting];
    surface_implementation implementation;
    wisp_status status = enter( own, way, workers, &implementation, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    double sum = 0.0;
    for ( int step = 1; step <= HANGING_CLOTH_STEPS && status == WISP_OK; ++step )
    {
        status = accuracy_time_surface( &implementation, 1.0, out, error );
        if ( status == WISP_OK && is_observed && step % HANGING_CLOTH_OBSERVATION_STEPS == 0 )
        {
            status = observe_path( own, way->mesh, step / HANGING_CLOTH_OBSERVATION_STEPS - 1, &implementation, &sum,
                                   error );
        }
    }
    if ( status == WISP_OK && is_observed )
    {
        measure( &implementation, sum, out );
    }
    status = status == WISP_OK ? accuracy_end_surface( &implementation, out, error ) : status;
    surface_implementation_destroy( &implementation );
    return status;
}

// ---- settings ----

// "xpbd, tethers, levels"
static void name_kind( const hang_way* way, char* text, int size )
{
    const cloth_setting* s = &way->setting;
    snprintf( text, (size_t)size, "%s%s%s%s%s", way->solver == WISP_SOLVER_PBD ? "pbd" : "xpbd",
              s->iterations > 1 ? ", passes" : "", s->tethers ? ", tethers" : "", s->levels ? ", levels" : "",
              s->solve_order == WISP_SOLVE_ORDER_LIST ? ", list" : "" );
}

static accuracy_setting* add_way( accuracy_scene* scene, hang_way way )
{
    hang_scene* own = scene->context;
    WISP_ASSERT( own->way_count < SETTINGS_MAX );
    own->ways[own->way_count++] = way;
    const bool has_passes = way.setting.iterations > 1;
    const int count = has_passes ? way.setting.iterations : way.setting.substeps;
    const char* what = has_passes ? "pass" : "substep";
    const char* ending = count == 1 ? "" : has_passes ? "es" : "s";
    char kind[40];
    name_kind( &way, kind, sizeof( kind ) );
    return accuracy_put_setting( scene, "%s, n %d, %d %s%s", kind, hanging_cloth_sizes[way.mesh], count, what,
                                 ending );
}

// Substeps with one pass on a mesh.
static void add_substeps( accuracy_scene* scene, hang_way way, int most )
{
    static const int substeps[] = { 1, 2, 5, 10, 20, MAX_SUBSTEPS };
    char kind[40], series[64];
    name_kind( &way, kind, sizeof( kind ) );
    snprintf( series, sizeof( series ), "%s, n %d", kind, hanging_cloth_sizes[way.mesh] );
    for ( int i = 0; i < WISP_COUNT( substeps ) && substeps[i] <= most; ++i )
    {
        way.setting.substeps = substeps[i];
        // pbd and tethers are other models, which do not converge to the reference
        const bool converges = way.solver == WISP_SOLVER_XPBD && !way.setting.tethers;
        accuracy_join_series( add_way( scene, way ), series, "substep, s", (double)CLOTH_STEP / substeps[i],
                              converges ? 1.0 : NAN );
    }
}

static void add_passes( accuracy_scene* scene, hang_way way )
{
    static const int passes[] = { 2, 5, 10, 20, 40 };
    for ( int i = 0; i < WISP_COUNT( passes ); ++i )
    {
        way.setting.iterations = passes[i];
        accuracy_join_series( add_way( scene, way ), "xpbd, passes, n 65", "1 / passes", 1.0 / passes[i], NAN );
    }
}

static void add_meshes( accuracy_scene* scene, hang_way way )
{
    way.setting.substeps = SUBSTEPS_OF_MESHES;
    for ( way.mesh = 0; way.mesh < FINEST; ++way.mesh )
    {
        accuracy_join_series( add_way( scene, way ), "xpbd, mesh, 160 substeps", "spacing, m",
                              hanging_cloth_spacing( way.mesh ), NAN );
    }
}

static void add_ways( accuracy_scene* scene )
{
    const hang_way plain = { .solver = WISP_SOLVER_XPBD, .setting = { .substeps = 1, .iterations = 1 } };
    hang_way way = plain;
    for ( way.mesh = 1; way.mesh < HANGING_CLOTH_MESHES; ++way.mesh )
    {
        add_substeps( scene, way, MAX_SUBSTEPS );
    }
    add_meshes( scene, way );
    way.mesh = FINEST;
    add_passes( scene, way );
    way.setting.tethers = true;
    add_substeps( scene, way, MAX_SUBSTEPS / 2 );
    way.setting.levels = true;
    add_substeps( scene, way, MAX_SUBSTEPS / 2 );
    way.setting = plain.setting;
    way.setting.solve_order = WISP_SOLVE_ORDER_LIST;
    add_substeps( scene, way, MAX_SUBSTEPS / 2 );
    way.setting = plain.setting;
    way.solver = WISP_SOLVER_PBD;
    add_substeps( scene, way, MAX_SUBSTEPS );
}

static wisp_status cook_all( hang_scene* own, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < own->way_count && status == WISP_OK; ++i )
    {
        hang_way* way = &own->ways[i];
        status = cloth_cook( &own->meshes[way->mesh], &way->setting, &way->fabric, error );
    }
    return status;
}

static void destroy( void* context )
{
    hang_scene* own = context;
    for ( int i = 0; i < own->way_count; ++i )
    {
        wisp_fabric_release( own->ways[i].fabric );
    }
    for ( int i = 0; i < HANGING_CLOTH_MESHES; ++i )
    {
        cloth_scene_free( &own->meshes[i] );
    }
    accuracy_reference_free( &own->reference );
    free( own );
}

static wisp_status fill( accuracy_scene* out, wisp_error* error )
{
    hang_scene* own = out->context;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < HANGING_CLOTH_MESHES && status == WISP_OK; ++i )
    {
        status = hanging_cloth_make( i, &own->meshes[i], error );
    }
    if ( status == WISP_OK )
    {
        add_ways( out );
        status = cook_all( own, error );
    }
    return status == WISP_OK ? read_reference( own, error ) : status;
}

wisp_status accuracy_hanging_cloth( const bench_options* options, double seconds, accuracy_scene* out,
                                    wisp_error* error )
{
    (void)options;
    (void)seconds; // its meshes are its subject
    *out = ( accuracy_scene ){ .error_name = "RMS distance to the reference",
                               .error_unit = "mm",
                               .note = "n: vertices per side; the finest mesh is compared at every second one. "
                                       "Errors of a coarse mesh and of long substeps may cancel. Tethers, levels and "
                                       "pbd (stiffness 1, no bending) are other models and converge elsewhere.",
                               .measure_names = { "stretch max, %", "stretch mean, %", "energy lost, %" },
                               .measure_count = 3,
                               .settings = calloc( SETTINGS_MAX, sizeof( accuracy_setting ) ),
                               .context = calloc( 1, sizeof( hang_scene ) ),
                               .run = run,
                               .destroy = destroy };
    if ( !out->settings || !out->context )
    {
        free( out->settings );
        free( out->context );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a hanging cloth" );
    }
    hang_scene* own = out->context;
    const wisp_status status = fill( out, error );
    accuracy_describe_reference( &own->reference, 1e3, out );
    if ( status != WISP_OK )
    {
        destroy( out->context );
        free( out->settings );
    }
    return status;
}
