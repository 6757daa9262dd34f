// The flag of data/scenes/flag.yaml in its first wind, without its mast, on a mesh half as fine and with a softer
// cloth, so that its path converges with fewer substeps.
#include "accuracy_surface.h"
#include "flag_in_wind.h"

#include <math.h>
#include <stdlib.h>

#define SPACING 0.03f
#define COMPLIANCE 1e-3f // m/N, of every edge

enum
{
    MAX_SUBSTEPS = 20,
    SETTINGS_MAX = 32,
};

typedef struct flag_way
{
    int substeps, iterations;
    wisp_cloth_bending bending;
    bool has_tethers; // and levels, as in the scene
} flag_way;

/// Values by which a run is compared.
typedef struct flag_stats
{
    double squares;                            // m^2, of the distances of all samples
    double kinetic, stretch_mean, stretch_max; // averages
} flag_stats;

typedef struct flag_scene
{
    flag_body body;
    accuracy_reference reference;
    flag_way ways[SETTINGS_MAX];
    int way_count;
} flag_scene;

// ---- the flag ----

// Upright, its mast at x = 0, the rows one below another.
wisp_status flag_make( flag_body* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = FLAG_COLUMNS;
    generator.rows = FLAG_ROWS;
    generator.spacing = SPACING;
    *out = ( flag_body ){ .fabric = NULL };
    wisp_status status = wisp_mesh_generate( &generator, &out->mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int i = 0; i < out->mesh.vertex_count; ++i )
    {
        const wisp_vec3 p = out->mesh.points[i];
        out->mesh.points[i] = ( wisp_vec3 ){ p.x + 0.5f * SPACING * ( FLAG_COLUMNS - 1 ), -p.z, 0.0f };
    }
    for ( int row = 0; row < FLAG_ROWS; ++row )
    {
        out->pins[row] = row * FLAG_COLUMNS;
    }
    wisp_fabric_def def = wisp_default_fabric_def();
    def.attachments = out->pins;
    def.attachment_count = FLAG_ROWS;
    def.hinges = true;
    def.tethers = true;
    def.levels = 3;
    return surface_cook( &out->mesh, def, &out->fabric, error );
}

void flag_free( flag_body* body )
{
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
}

wisp_cloth_def flag_cloth( void )
{
    wisp_cloth_def def = wisp_default_cloth_def();
    def.warp_compliance = def.weft_compliance = COMPLIANCE;
    // the sum is isotropic: every edge has the same
    def.shear_compliance = 2.0f * COMPLIANCE;
    def.bending = WISP_CLOTH_BENDING_DIHEDRAL;
    def.bend_rigidity = 2e-5f;
    def.internal_damping = 1.0f;
    def.wind = ( wisp_vec3 ){ 4.0f, 0.0f, 0.5f };
    def.drag_coefficient = 0.2f;
    def.lift_coefficient = 1.2f;
    return def;
}

accuracy_reference flag_reference( const flag_body* body )
{
    const wisp_cloth_def def = flag_cloth();
    accuracy_reference reference = { .scene = "flag", .number_count = FLAG_PATH + 1 };
    accuracy_reference_put( &reference, "vertices", body->mesh.vertex_count );
    accuracy_reference_put( &reference, "area density, kg/m2", (double)FLAG_DENSITY );
    accuracy_reference_put( &reference, "compliance of an edge, m/N", (double)def.warp_compliance );
    accuracy_reference_put( &reference, "rigidity of bending, N m", (double)def.bend_rigidity );
    accuracy_reference_put( &reference, "damping, 1/s", (double)def.internal_damping );
    accuracy_reference_put( &reference, "wind along x, m/s", (double)def.wind.x );
    accuracy_reference_put( &reference, "wind along z, m/s", (double)def.wind.z );
    accuracy_reference_put( &reference, "air, kg/m3", (double)def.air_density );
    accuracy_reference_put( &reference, "drag", (double)def.drag_coefficient );
    accuracy_reference_put( &reference, "lift", (double)def.lift_coefficient );
    accuracy_reference_put( &reference, "gravity, m/s2", (double)FLAG_GRAVITY );
    accuracy_reference_put( &reference, "steps a second", 1.0 / (double)ACCURACY_FRAME );
    accuracy_reference_put( &reference, "steps between observations", FLAG_OBSERVATION_STEPS );
    accuracy_reference_put( &reference, "observations", FLAG_OBSERVATIONS );
    accuracy_reference_put_start( &reference, body->mesh.points, body->mesh.vertex_count );
    return reference;
}

static wisp_cloth_def cloth_of( const flag_way* way )
{
    wisp_cloth_def def = flag_cloth();
    def.bending = way->bending;
    def.tethers = way->has_tethers;
    def.tether_slack = 1.02f;
    def.level_passes = way->has_tethers ? 1 : 0;
    return def;
}

static wisp_status enter( const flag_scene* own, const flag_way* way, int workers, surface_implementation* out,
                          wisp_error* error )
{
    surface_generator generator = surface_default_generator( &wisp_cloth_module, own->body.fabric );
    generator.pins = own->body.pins;
    generator.pin_count = FLAG_ROWS;
    generator.area_density = FLAG_DENSITY;
    generator.gravity = ( wisp_vec3 ){ 0.0f, -FLAG_GRAVITY, 0.0f };
    generator.substeps = way->substeps;
    generator.iterations = way->iterations;
    generator.workers = workers;
    wisp_status status = surface_implementation_create( &generator, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_cloth_def def = cloth_of( way );
    status = wisp_set_cloth( out->world, out->entity, &def );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_implementation_destroy( out );
    }
    return status;
}

// ---- a run ----

static wisp_status observe_path( const flag_scene* own, surface_implementation* implementation, int observation,
                                 flag_stats* stats, wisp_error* error )
{
    const wisp_vec3* points;
    const double* reference = own->reference.numbers + (size_t)( 3 * observation * FLAG_VERTICES );
    const wisp_status status = surface_implementation_points( implementation, &points, error );
    for ( int i = 0; i < FLAG_VERTICES && status == WISP_OK; ++i, reference += 3 )
    {
        const double x = (double)points[i].x - reference[0], y = (double)points[i].y - reference[1],
                     z = (double)points[i].z - reference[2];
        stats->squares += x * x + y * y + z * z;
    }
    return status;
}

static wisp_status observe( const flag_scene* own, surface_implementation* implementation, int step,
                            flag_stats* stats, wisp_error* error )
{
    if ( step <= FLAG_EARLY_STEPS )
    {
        return step % FLAG_OBSERVATION_STEPS == 0
                   ? observe_path( own, implementation, step / FLAG_OBSERVATION_STEPS - 1, stats, error )
                   : WISP_OK;
    }
    const surface_observation seen = surface_implementation_observe( implementation );
    stats->kinetic += seen.kinetic / ( FLAG_STEPS - FLAG_EARLY_STEPS );
    stats->stretch_mean += seen.stretch_mean / ( FLAG_STEPS - FLAG_EARLY_STEPS );
    stats->stretch_max += seen.stretch_max / ( FLAG_STEPS - FLAG_EARLY_STEPS );
    return WISP_OK;
}

static void measure( const flag_scene* own, const flag_stats* stats, accuracy_run* out )
{
    out->error = 1e3 * sqrt( stats->squares / ( FLAG_OBSERVATIONS * FLAG_VERTICES ) );
    out->measures[0] = 1e2 * ( stats->kinetic / own->reference.numbers[FLAG_PATH] - 1.0 );
    out->measures[1] = 1e2 * stats->stretch_max;
    out->measures[2] = 1e2 * stats->stretch_mean;
}

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const flag_scene* own = context;
    flag_stats stats = { .squares = 0.0 };
    surface_implementation implementation;
    wisp_status status = enter( own, &own->ways[setting], workers, &implementation, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int step = 1; step <= FLAG_STEPS && status == WISP_OK; ++step )
    {
        status = accuracy_time_surface( &implementation, 1.0, out, error );
        status = status == WISP_OK && is_observed ? observe( own, &implementation, step, &stats, error ) : status;
    }
    if ( status == WISP_OK && is_observed )
    {
        measure( own, &stats, out );
    }
    status = status == WISP_OK ? accuracy_end_surface( &implementation, out, error ) : status;
    surface_implementation_destroy( &implementation );
    return status;
}

// ---- settings ----

static void add_substeps( accuracy_scene* scene, flag_way way, const char* series )
{
    static const int substeps[] = { 1, 2, 5, 10, MAX_SUBSTEPS };
    flag_scene* own = scene->context;
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        WISP_ASSERT( own->way_count < SETTINGS_MAX );
        way.substeps = substeps[i];
        own->ways[own->way_count++] = way;
        accuracy_setting* setting =
            accuracy_put_setting( scene, "%s, %d substep%s", series, substeps[i], substeps[i] > 1 ? "s" : "" );
        accuracy_join_series( setting, series, "substep, s", 1.0 / 60.0 / substeps[i], way.has_tethers ? NAN : 1.0 );
    }
}

static void add_ways( accuracy_scene* scene )
{
    const flag_way plain = { .iterations = 1, .bending = WISP_CLOTH_BENDING_DIHEDRAL };
    flag_way way = plain;
    add_substeps( scene, way, "dihedral" );
    way.iterations = 2;
    add_substeps( scene, way, "dihedral, 2 passes" );
    way = plain;
    way.bending = WISP_CLOTH_BENDING_ISOMETRIC;
    add_substeps( scene, way, "isometric" );
    way = plain;
    way.has_tethers = true;
    add_substeps( scene, way, "dihedral, tethers, levels" );
    // as in data/scenes/flag.yaml, except for its substeps
    way.iterations = 2;
    add_substeps( scene, way, "dihedral, tethers, levels, 2 passes" );
}

static void destroy( void* context )
{
    flag_scene* own = context;
    flag_free( &own->body );
    accuracy_reference_free( &own->reference );
    free( own );
}

wisp_status accuracy_flag( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    *out = ( accuracy_scene ){ .error_name = "RMS distance to the reference",
                               .error_unit = "mm",
                               .note = "flapping is chaotic, so the path error covers the first 0.2 s only; energy "
                                       "and stretch are means from 0.2 to 1 s. Energy differs by tens of percent "
                                       "between converged runs. Tethers and levels are other models.",
                               .measure_names = { "kinetic energy against the reference's, %", "stretch max, %",
                                                  "stretch mean, %" },
                               .measure_count = 3,
                               .settings = calloc( SETTINGS_MAX, sizeof( accuracy_setting ) ),
                               .context = calloc( 1, sizeof( flag_scene ) ),
                               .run = run,
                               .destroy = destroy };
    if ( !out->settings || !out->context )
    {
        free( out->settings );
        free( out->context );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a flag" );
    }
    flag_scene* own = out->context;
    wisp_status status = flag_make( &own->body, error );
    const accuracy_reference requested = flag_reference( &own->body );
    status = status == WISP_OK
                 ? accuracy_reference_read( accuracy_reference_folder(), &requested, &own->reference, error )
                 : status;
    if ( status != WISP_OK )
    {
        destroy( own );
        free( out->settings );
        return status;
    }
    accuracy_describe_reference( &own->reference, 1e3, out );
    add_ways( out );
    return WISP_OK;
}
