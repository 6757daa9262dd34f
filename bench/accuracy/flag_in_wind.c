// The flag of data/scenes/flag.yaml in its first wind, without its mast, on half as fine a mesh and of a softer cloth, whose path
// converges with fewer substeps.
#include "accuracy_surface.h"

#include "cloth/cloth.h"
#include "mesh.h"

#include <math.h>
#include <stdlib.h>

#define SPACING 0.03f
#define COMPLIANCE 1e-3f // m/N, of every edge
#define DENSITY 0.12f    // kg/m^2
#define GRAVITY 9.81f

enum
{
    COLUMNS = 31,
    ROWS = 21,
    VERTICES = COLUMNS * ROWS,
    SUBSTEPS_MOST = 20,
    TRUTH_SUBSTEPS = 16 * SUBSTEPS_MOST,
    EARLY_STEPS = 12, // 0.2 s: flapping is chaotic, so the path is compared only before it
    LOOK_STEPS = 2,
    LOOK_COUNT = EARLY_STEPS / LOOK_STEPS,
    STEPS = 60, // averages are of the steps behind the early ones
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
    wisp_vec3* path;                           // [LOOK_COUNT][VERTICES]
    double kinetic, stretch_mean, stretch_max; // averages
} flag_figures;

typedef struct flag_scene
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    int32_t pins[ROWS];
    flag_figures truth;
    double doubt; // m, root mean square distance to half as many substeps
    flag_way ways[SETTINGS_MAX];
    int way_count;
} flag_scene;

// ---- the flag ----

// Upright, its mast at x = 0, the rows one below another.
static wisp_status make_flag( flag_scene* own, wisp_error* error )
{
    wisp_mesh_recipe recipe = wisp_default_mesh_recipe( WISP_MESH_PLANE_ALTERNATING );
    recipe.columns = COLUMNS;
    recipe.rows = ROWS;
    recipe.spacing = SPACING;
    wisp_status status = wisp_mesh_make( &recipe, &own->mesh, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int i = 0; i < own->mesh.vertex_count; ++i )
    {
        const wisp_vec3 p = own->mesh.points[i];
        own->mesh.points[i] = ( wisp_vec3 ){ p.x + 0.5f * SPACING * ( COLUMNS - 1 ), -p.z, 0.0f };
    }
    for ( int row = 0; row < ROWS; ++row )
    {
        own->pins[row] = row * COLUMNS;
    }
    wisp_fabric_def def = wisp_default_fabric_def();
    def.attachments = own->pins;
    def.attachment_count = ROWS;
    def.hinges = true;
    def.tethers = true;
    def.levels = 3;
    return surface_cook( &own->mesh, def, &own->fabric, error );
}

static wisp_cloth_def cloth_of( const flag_way* way )
{
    wisp_cloth_def def = wisp_default_cloth_def();
    def.warp_compliance = def.weft_compliance = COMPLIANCE;
    // the sum makes it isotropic: every edge has the same
    def.shear_compliance = 2.0f * COMPLIANCE;
    def.bending = way->bending;
    def.bend_rigidity = 2e-5f;
    def.damping = 1.0f;
    def.wind = ( wisp_vec3 ){ 4.0f, 0.0f, 0.5f };
    def.drag = 0.2f;
    def.lift = 1.2f;
    def.tethers = way->has_tethers;
    def.tether_slack = 1.02f;
    def.level_passes = way->has_tethers ? 1 : 0;
    return def;
}

static wisp_status enter( const flag_scene* own, const flag_way* way, int workers, surface_entrant* out,
                          wisp_error* error )
{
    surface_recipe recipe = surface_default_recipe( &wisp_cloth_module, own->fabric );
    recipe.pins = own->pins;
    recipe.pin_count = ROWS;
    recipe.area_density = DENSITY;
    recipe.gravity = ( wisp_vec3 ){ 0.0f, -GRAVITY, 0.0f };
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
        surface_entrant_fail( out, status, error );
        surface_entrant_destroy( out );
    }
    return status;
}

// ---- what is looked at ----

static wisp_status make_figures( flag_figures* out, wisp_error* error )
{
    *out = ( flag_figures ){ .path = calloc( (size_t)LOOK_COUNT * VERTICES, sizeof( wisp_vec3 ) ) };
    return out->path ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for the path of a flag" );
}

static double distance_between( const flag_figures* a, const flag_figures* b )
{
    double sum = 0.0;
    for ( int i = 0; i < LOOK_COUNT * VERTICES; ++i )
    {
        const wisp_vec3 p = a->path[i], q = b->path[i];
        const double x = (double)p.x - (double)q.x, y = (double)p.y - (double)q.y, z = (double)p.z - (double)q.z;
        sum += x * x + y * y + z * z;
    }
    return sqrt( sum / ( LOOK_COUNT * VERTICES ) );
}

static wisp_status look( surface_entrant* entrant, int step, flag_figures* figures, wisp_error* error )
{
    if ( step > EARLY_STEPS )
    {
        const surface_look seen = surface_entrant_look( entrant );
        figures->kinetic += seen.kinetic / ( STEPS - EARLY_STEPS );
        figures->stretch_mean += seen.stretch_mean / ( STEPS - EARLY_STEPS );
        figures->stretch_max += seen.stretch_max / ( STEPS - EARLY_STEPS );
        return WISP_OK;
    }
    if ( step % LOOK_STEPS != 0 )
    {
        return WISP_OK;
    }
    const wisp_vec3* points;
    const wisp_status status = surface_entrant_points( entrant, &points, error );
    for ( int i = 0; status == WISP_OK && i < VERTICES; ++i )
    {
        figures->path[( step / LOOK_STEPS - 1 ) * VERTICES + i] = points[i];
    }
    return status;
}

// @param figures null: nobody looks
static wisp_status flap( const flag_scene* own, const flag_way* way, int workers, int steps, flag_figures* figures,
                         accuracy_run* out, wisp_error* error )
{
    surface_entrant entrant;
    wisp_status status = enter( own, way, workers, &entrant, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int step = 1; step <= steps && status == WISP_OK; ++step )
    {
        status = accuracy_time_surface( &entrant, 1.0, out, error );
        status = status == WISP_OK && figures ? look( &entrant, step, figures, error ) : status;
    }
    status = status == WISP_OK ? accuracy_end_surface( &entrant, out, error ) : status;
    surface_entrant_destroy( &entrant );
    return status;
}

static wisp_status run( void* context, int setting, int workers, bool is_looked_at, accuracy_run* out,
                        wisp_error* error )
{
    const flag_scene* own = context;
    const flag_way* way = &own->ways[setting];
    if ( !is_looked_at )
    {
        return flap( own, way, workers, STEPS, NULL, out, error );
    }
    flag_figures figures;
    wisp_status status = make_figures( &figures, error );
    status = status == WISP_OK ? flap( own, way, workers, STEPS, &figures, out, error ) : status;
    if ( status == WISP_OK )
    {
        out->error = 1e3 * distance_between( &figures, &own->truth );
        out->measures[0] = 1e2 * ( figures.kinetic / own->truth.kinetic - 1.0 );
        out->measures[1] = 1e2 * figures.stretch_max;
        out->measures[2] = 1e2 * figures.stretch_mean;
    }
    free( figures.path );
    return status;
}

// ---- the truth ----

static wisp_status find_truth( flag_scene* own, int workers, wisp_error* error )
{
    flag_way way = { .substeps = TRUTH_SUBSTEPS, .iterations = 1, .bending = WISP_CLOTH_BENDING_DIHEDRAL };
    flag_figures half = { .path = NULL };
    accuracy_run times = { .ms = NULL };
    wisp_status status = make_figures( &own->truth, error );
    status = status == WISP_OK ? make_figures( &half, error ) : status;
    status = status == WISP_OK ? flap( own, &way, workers, STEPS, &own->truth, &times, error ) : status;
    way.substeps /= 2;
    status = status == WISP_OK ? flap( own, &way, workers, EARLY_STEPS, &half, &times, error ) : status;
    if ( status == WISP_OK && times.halted_at > 0 )
    {
        status = wisp_fail( error, WISP_CONFLICT, "the truth of the flag was halted at step %d", times.halted_at );
    }
    own->doubt = status == WISP_OK ? distance_between( &own->truth, &half ) : NAN;
    free( half.path );
    free( times.ms );
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
    wisp_fabric_release( own->fabric );
    wisp_mesh_release( &own->mesh );
    free( own->truth.path );
    free( own );
}

wisp_status accuracy_flag( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
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
    snprintf( out->truth, sizeof( out->truth ),
              "the same flag with %d substeps of one pass, 16 times the most, at %d looks within %.1f s",
              TRUTH_SUBSTEPS, LOOK_COUNT, EARLY_STEPS / 60.0 );
    if ( !out->settings || !out->context )
    {
        free( out->settings );
        free( out->context );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a flag" );
    }
    flag_scene* own = out->context;
    wisp_status status = make_flag( own, error );
    status = status == WISP_OK ? find_truth( own, options->workers, error ) : status;
    if ( status != WISP_OK )
    {
        destroy( own );
        free( out->settings );
        return status;
    }
    out->doubt = 1e3 * own->doubt;
    add_ways( out );
    return WISP_OK;
}
