// The flag of data/scenes/flag.yaml in its first wind, without its mast, on half as fine a mesh and of a softer cloth, whose path
// converges with fewer substeps.
#include "accuracy_surface.h"
#include "flag_in_wind.h"

#include <math.h>
#include <stdlib.h>

#define SPACING 0.03f
#define COMPLIANCE 1e-3f // m/N, of every edge

enum
{
    SUBSTEPS_MOST = 20,
    SETTINGS_MAX = 32,
};

typedef struct flag_way
{
    int substeps, iterations;
    wisp_cloth_bending bending;
    bool has_tethers; // and levels, as the scene has them
} flag_way;

/// What a run is compared by.
typedef struct flag_figures
{
    double squares;                            // m^2, of the distances of all looks
    double kinetic, stretch_mean, stretch_max; // averages
} flag_figures;

typedef struct flag_scene
{
    flag_body body;
    accuracy_truth truth;
    flag_way ways[SETTINGS_MAX];
    int way_count;
} flag_scene;

// ---- the flag ----

// Upright, its mast at x = 0, the rows one below another.
wisp_status flag_make( flag_body* out, wisp_error* error )
{
    wisp_mesh_recipe recipe = wisp_default_mesh_recipe( WISP_MESH_PLANE_ALTERNATING );
    recipe.columns = FLAG_COLUMNS;
    recipe.rows = FLAG_ROWS;
    recipe.spacing = SPACING;
    *out = ( flag_body ){ .fabric = NULL };
    wisp_status status = wisp_mesh_make( &recipe, &out->mesh, error );
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
    // the sum makes it isotropic: every edge has the same
    def.shear_compliance = 2.0f * COMPLIANCE;
    def.bending = WISP_CLOTH_BENDING_DIHEDRAL;
    def.bend_rigidity = 2e-5f;
    def.damping = 1.0f;
    def.wind = ( wisp_vec3 ){ 4.0f, 0.0f, 0.5f };
    def.drag = 0.2f;
    def.lift = 1.2f;
    return def;
}

accuracy_truth flag_truth( const flag_body* body )
{
    const wisp_cloth_def def = flag_cloth();
    accuracy_truth truth = { .scene = "flag", .number_count = FLAG_PATH + 1 };
    accuracy_truth_put( &truth, "vertices", body->mesh.vertex_count );
    accuracy_truth_put( &truth, "area density, kg/m2", (double)FLAG_DENSITY );
    accuracy_truth_put( &truth, "compliance of an edge, m/N", (double)def.warp_compliance );
    accuracy_truth_put( &truth, "rigidity of bending, N m", (double)def.bend_rigidity );
    accuracy_truth_put( &truth, "damping, 1/s", (double)def.damping );
    accuracy_truth_put( &truth, "wind along x, m/s", (double)def.wind.x );
    accuracy_truth_put( &truth, "wind along z, m/s", (double)def.wind.z );
    accuracy_truth_put( &truth, "air, kg/m3", (double)def.air_density );
    accuracy_truth_put( &truth, "drag", (double)def.drag );
    accuracy_truth_put( &truth, "lift", (double)def.lift );
    accuracy_truth_put( &truth, "gravity, m/s2", (double)FLAG_GRAVITY );
    accuracy_truth_put( &truth, "steps a second", 1.0 / (double)ACCURACY_FRAME );
    accuracy_truth_put( &truth, "steps between looks", FLAG_LOOK_STEPS );
    accuracy_truth_put( &truth, "looks", FLAG_LOOKS );
    accuracy_truth_put_start( &truth, body->mesh.points, body->mesh.vertex_count );
    return truth;
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

static wisp_status enter( const flag_scene* own, const flag_way* way, int workers, surface_entrant* out,
                          wisp_error* error )
{
    surface_recipe recipe = surface_default_recipe( &wisp_cloth_module, own->body.fabric );
    recipe.pins = own->body.pins;
    recipe.pin_count = FLAG_ROWS;
    recipe.area_density = FLAG_DENSITY;
    recipe.gravity = ( wisp_vec3 ){ 0.0f, -FLAG_GRAVITY, 0.0f };
    recipe.substeps = way->substeps;
    recipe.iterations = way->iterations;
    recipe.workers = workers;
    wisp_status status = surface_entrant_create( &recipe, out, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const wisp_cloth_def def = cloth_of( way );
    status = wisp_set_cloth( out->world, out->entity, &def );
    if ( status != WISP_OK )
    {
        bench_world_fail( out->world, status, error );
        surface_entrant_destroy( out );
    }
    return status;
}

// ---- a run ----

static wisp_status look_at_path( const flag_scene* own, surface_entrant* entrant, int look, flag_figures* figures,
                                 wisp_error* error )
{
    const wisp_vec3* points;
    const double* truth = own->truth.numbers + (size_t)( 3 * look * FLAG_VERTICES );
    const wisp_status status = surface_entrant_points( entrant, &points, error );
    for ( int i = 0; i < FLAG_VERTICES && status == WISP_OK; ++i, truth += 3 )
    {
        const double x = (double)points[i].x - truth[0], y = (double)points[i].y - truth[1],
                     z = (double)points[i].z - truth[2];
        figures->squares += x * x + y * y + z * z;
    }
    return status;
}

static wisp_status look( const flag_scene* own, surface_entrant* entrant, int step, flag_figures* figures,
                         wisp_error* error )
{
    if ( step <= FLAG_EARLY_STEPS )
    {
        return step % FLAG_LOOK_STEPS == 0 ? look_at_path( own, entrant, step / FLAG_LOOK_STEPS - 1, figures, error )
                                           : WISP_OK;
    }
    const surface_look seen = surface_entrant_look( entrant );
    figures->kinetic += seen.kinetic / ( FLAG_STEPS - FLAG_EARLY_STEPS );
    figures->stretch_mean += seen.stretch_mean / ( FLAG_STEPS - FLAG_EARLY_STEPS );
    figures->stretch_max += seen.stretch_max / ( FLAG_STEPS - FLAG_EARLY_STEPS );
    return WISP_OK;
}

static void measure( const flag_scene* own, const flag_figures* figures, accuracy_run* out )
{
    out->error = 1e3 * sqrt( figures->squares / ( FLAG_LOOKS * FLAG_VERTICES ) );
    out->measures[0] = 1e2 * ( figures->kinetic / own->truth.numbers[FLAG_PATH] - 1.0 );
    out->measures[1] = 1e2 * figures->stretch_max;
    out->measures[2] = 1e2 * figures->stretch_mean;
}

static wisp_status run( void* context, int setting, int workers, bool is_looked_at, accuracy_run* out,
                        wisp_error* error )
{
    const flag_scene* own = context;
    flag_figures figures = { .squares = 0.0 };
    surface_entrant entrant;
    wisp_status status = enter( own, &own->ways[setting], workers, &entrant, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int step = 1; step <= FLAG_STEPS && status == WISP_OK; ++step )
    {
        status = accuracy_time_surface( &entrant, 1.0, out, error );
        status = status == WISP_OK && is_looked_at ? look( own, &entrant, step, &figures, error ) : status;
    }
    if ( status == WISP_OK && is_looked_at )
    {
        measure( own, &figures, out );
    }
    status = status == WISP_OK ? accuracy_end_surface( &entrant, out, error ) : status;
    surface_entrant_destroy( &entrant );
    return status;
}

// ---- settings ----

static void add_substeps( accuracy_scene* scene, flag_way way, const char* series )
{
    static const int substeps[] = { 1, 2, 5, 10, SUBSTEPS_MOST };
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
    // as data/scenes/flag.yaml has it, but for its substeps
    way.iterations = 2;
    add_substeps( scene, way, "dihedral, tethers, levels, 2 passes" );
}

static void destroy( void* context )
{
    flag_scene* own = context;
    flag_free( &own->body );
    accuracy_truth_free( &own->truth );
    free( own );
}

wisp_status accuracy_flag( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    *out = ( accuracy_scene ){ .error_name = "RMS distance to the truth",
                               .error_unit = "mm",
                               .note = "flapping is chaotic: the error is of the path in the first 0.2 s, before it; "
                                       "energy and stretch are averages from "
                                       "0.2 to 1 s, of which the energy's still differ by tens of percent between "
                                       "converged runs. Bending is by the angle or isometric, "
                                       "of the same rigidity. Tethers and levels are another model, which stays away "
                                       "from the truth however short "
                                       "a substep is.",
                               .measure_names = { "kinetic energy against the truth's, %", "stretch max, %",
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
    const accuracy_truth wanted = flag_truth( &own->body );
    status = status == WISP_OK ? accuracy_truth_read( accuracy_truth_folder(), &wanted, &own->truth, error ) : status;
    if ( status != WISP_OK )
    {
        destroy( own );
        free( out->settings );
        return status;
    }
    accuracy_describe_truth( &own->truth, 1e3, out );
    add_ways( out );
    return WISP_OK;
}
