// Two discs of foil, joined at the rim and filled: the shape of a Mylar balloon.
#include "validate_balloons.h"

#include "accuracy/accuracy_surface.h"
#include "balloon_scene.h"
#include "oracle/balloon_theory.h"
#include "validate_foil.h"

#include "wisp/module/random.h"

#include <math.h>

enum
{
    MAX_SETTINGS = 48,
    STEPS = 180, // 3 s
    USUAL_SUBSTEPS = 40,
    USUAL_RINGS = 12,
};

// Without gravity and air only p a / k and the substep in sqrt( rho a / p ) count, which is 0.2 s here.
#define RADIUS 0.2        // m, a
#define PRESSURE 5.0      // Pa
#define AREA_DENSITY 1.0f // kg/m^2
#define SOFTNESS 1e-3     // p a / k
#define DAMPING 5.0f      // 1/s
#define REST_HEIGHT 1e-3  // of a pole over the rim, in a: the rest shape needs a volume
#define START_HEIGHT 0.1  // the same at the start. A high lens has longer meridians than the foil and collapses first
#define SHAKE 1e-3        // largest displacement of a vertex at the start, in a: a symmetric foil would not buckle
#define GAS_VOLUMES 10.0  // of the gas at the pressure of the atmosphere, in those of the Mylar balloon

static const double PI = 3.14159265358979323846;

// What keeps the foil from stretching.
typedef enum skin
{
    SKIN_LIMIT,      // weak springs and a strain limit, so edges get shorter freely
    SKIN_LINKS,      // springs, which resist compression too: the mesh crumples
    SKIN_BEND_LINKS, // the same, and springs across the edges, a hundredth as stiff
    SKIN_RIGID,      // links of position-based dynamics with stiffness 1
    SKIN_FIELD,      // a membrane that wrinkles within its triangles; k is 3 G
    SKIN_COUNT,
} skin;

static const char* const skin_names[SKIN_COUNT] = { "strain limit", "xpbd links", "xpbd links and bend links",
                                                    "pbd links", "membrane with tension field" };
static const char* const mesh_names[VALIDATE_FOIL_COUNT] = { "even mesh", "spokes" };

typedef struct way
{
    skin skin;
    validate_foil_mesh mesh;
    int rings, substeps;
    double softness, pressure; // p a / k; Pa
} way;

// ---- a run ----

static validate_foil foil_with( const way* w, double height )
{
    return ( validate_foil ){ w->mesh, w->rings, RADIUS, height * RADIUS };
}

static double foil_volume( double radius )
{
    return balloon_theory_mylar_shape().volume * radius * radius * radius;
}

// The gas presses with P_atm ( V_0 - V ) / V_0. With V_0 ten times V that is nearly constant, whatever the volume: a mesh too coarse for
// the shape is not squeezed.
static balloon_setting setting_of( const way* w, double rest_volume, int workers )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    wisp_balloon_def* def = &setting.def;
    const double stiffness = w->pressure * RADIUS / w->softness;
    def->atmospheric_pressure = (float)( w->pressure / ( 1.0 - 1.0 / GAS_VOLUMES ) );
    def->gas_ratio = (float)( GAS_VOLUMES * foil_volume( RADIUS ) / rest_volume );
    def->edge_stiffness = (float)stiffness;
    def->bend_link_stiffness = (float)( 0.01 * stiffness );
    def->solver = w->skin == SKIN_RIGID ? WISP_SOLVER_PBD : WISP_SOLVER_XPBD;
    def->stretch_stiffness = 1.0f;
    setting.area_density = AREA_DENSITY;
    setting.damping = DAMPING;
    setting.substeps = w->substeps;
    setting.iterations = 1;
    setting.workers = workers;
    setting.seconds = ACCURACY_FRAME;
    return setting;
}

static wisp_membrane_def membrane_of( const way* w )
{
    wisp_membrane_def def = wisp_default_membrane_def();
    def.shear_modulus = (float)( w->pressure * RADIUS / w->softness / 3.0 ) / def.thickness;
    def.tension_field = true;
    return def;
}

// Half of the width between two upright planes that touch the foil, the mean of all directions: a rim has wrinkles, and its vertices need
// not lie on the equator.
static double equator_radius( const wisp_vec3* points, int count )
{
    enum
    {
        DIRECTIONS = 90,
    };
    double sum = 0.0;
    for ( int i = 0; i < DIRECTIONS; ++i )
    {
        const double angle = 2.0 * PI * i / DIRECTIONS, c = cos( angle ), s = sin( angle );
        double most = 0.0;
        for ( int k = 0; k < count; ++k )
        {
            most = fmax( most, c * (double)points[k].x + s * (double)points[k].z );
        }
        sum += most / DIRECTIONS;
    }
    return sum;
}

static wisp_status measure( surface_implementation* foil, const way* w, const wisp_mesh* mesh, accuracy_run* out,
                            wisp_error* error )
{
    const wisp_vec3* points = NULL;
    const wisp_status status = surface_implementation_points( foil, &points, error );
    if ( status == WISP_OK )
    {
        const balloon_theory_mylar exact = balloon_theory_mylar_shape();
        const double volume = balloon_volume( mesh, points ) / ( RADIUS * RADIUS * RADIUS );
        const validate_foil foil_of = foil_with( w, REST_HEIGHT );
        const double thick = balloon_distance( points[0], points[validate_foil_pole( &foil_of )] ) / RADIUS;
        const double radius = equator_radius( points, mesh->vertex_count ) / RADIUS;
        const double parts[] = { radius / exact.radius - 1.0, thick / exact.thickness - 1.0,
                                 volume / exact.volume - 1.0 };
        double sum = 0.0;
        for ( int i = 0; i < WISP_COUNT( parts ); ++i )
        {
            out->measures[i] = 100.0 * parts[i];
            sum += parts[i] * parts[i] / WISP_COUNT( parts );
        }
        out->measures[3] = radius;
        out->measures[4] = thick;
        out->measures[5] = volume;
        out->error = 100.0 * sqrt( sum );
    }
    return status;
}

static wisp_status run_foil( const way* w, const wisp_mesh* rest, const wisp_mesh* start, int workers,
                             bool is_observed, accuracy_run* out, wisp_error* error )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.bend_links = w->skin == SKIN_BEND_LINKS;
    balloon_setting setting = setting_of( w, balloon_volume( rest, rest->points ), workers );
    setting.points = start->points;
    const wisp_membrane_def membrane = membrane_of( w );
    setting.membrane = w->skin == SKIN_FIELD ? &membrane : NULL;
    wisp_fabric* fabric = NULL;
    surface_implementation foil = { 0 };
    wisp_status status = surface_cook( rest, def, &fabric, error );
    status = status == WISP_OK ? balloon_implementation_create( fabric, &setting, &foil, error ) : status;
    if ( status == WISP_OK && w->skin == SKIN_LIMIT )
    {
        status = wisp_set_strain_limit( foil.world, foil.entity, 0.0f, 1.0f );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( foil.world, status, error );
    }
    status = status == WISP_OK ? accuracy_step_surface( &foil, STEPS, out, error ) : status;
    status = status == WISP_OK ? accuracy_end_surface( &foil, out, error ) : status;
    status = status == WISP_OK && is_observed && out->halted_at == 0 ? measure( &foil, w, rest, out, error ) : status;
    surface_implementation_destroy( &foil );
    wisp_fabric_release( fabric );
    return status;
}

static void shake( wisp_mesh* mesh )
{
    const wisp_random_key key = wisp_random_make_key( 1, 0, 0 );
    for ( int i = 0; i < mesh->vertex_count; ++i )
    {
        float* const axes[] = { &mesh->points[i].x, &mesh->points[i].y, &mesh->points[i].z };
        for ( int k = 0; k < 3; ++k )
        {
            *axes[k] +=
                (float)( SHAKE * RADIUS * ( 2.0 * wisp_random_unit( key, (uint32_t)i, (uint32_t)k, 0 ) - 1.0 ) );
        }
    }
}

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const way* w = (const way*)context + setting;
    const validate_foil flat = foil_with( w, REST_HEIGHT ), lens = foil_with( w, START_HEIGHT );
    wisp_mesh rest = { 0 }, start = { 0 };
    wisp_status status = validate_foil_make( &flat, &rest, error );
    status = status == WISP_OK ? validate_foil_make( &lens, &start, error ) : status;
    if ( status == WISP_OK )
    {
        shake( &start );
        status = run_foil( w, &rest, &start, workers, is_observed, out, error );
    }
    wisp_mesh_release( &rest );
    wisp_mesh_release( &start );
    return status;
}

// ---- settings ----

// Weak springs that only keep the slack parts in order.
static double usual_softness( skin s )
{
    return s == SKIN_LIMIT ? 100.0 : SOFTNESS;
}

static void put( accuracy_scene* out, way w, const char* by, const char* parameter_name, double parameter )
{
    char series[96];
    snprintf( series, sizeof series, "%s, %s, by %s", skin_names[w.skin], mesh_names[w.mesh], by );
    ( (way*)out->context )[out->setting_count] = w;
    accuracy_setting* setting =
        accuracy_put_setting( out, "%s, %s, %d rings, %d substeps, p a / k = %g, %g Pa", skin_names[w.skin],
                              mesh_names[w.mesh], w.rings, w.substeps, w.softness, w.pressure );
    accuracy_join_series( setting, by[0] != '\0' ? series : "", parameter_name, parameter, NAN );
}

static void put_rings( accuracy_scene* out, skin s, validate_foil_mesh mesh, const int* rings, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        put( out, ( way ){ s, mesh, rings[i], USUAL_SUBSTEPS, usual_softness( s ), PRESSURE }, "rings", "ring / a",
             1.0 / rings[i] );
    }
}

// Neither pressure nor stiffness matters. Four times the pressure is the same motion twice as fast, so as accurate as half
// the substeps.
static void put_checks( accuracy_scene* out )
{
    const double usual = usual_softness( SKIN_LIMIT ), softness[] = { 1e-2, 1e-4 };
    way firmer = { SKIN_LIMIT, VALIDATE_FOIL_SPOKES, USUAL_RINGS, USUAL_SUBSTEPS, 0.1 * usual, PRESSURE };
    way fuller = { SKIN_LIMIT, VALIDATE_FOIL_SPOKES, USUAL_RINGS, USUAL_SUBSTEPS, usual, 4.0 * PRESSURE };
    put( out, firmer, "", "", NAN );
    put( out, fuller, "", "", NAN );
    for ( int i = 0; i < WISP_COUNT( softness ); ++i )
    {
        put( out, ( way ){ SKIN_LINKS, VALIDATE_FOIL_SPOKES, 8, USUAL_SUBSTEPS, softness[i], PRESSURE }, "softness",
             "p a / k", softness[i] );
    }
}

static void put_settings( accuracy_scene* out )
{
    static const int fine[] = { 4, 6, 8, 12 }, rings[] = { 4, 6, 8, 16, 24 }, substeps[] = { 10, 20, 80 };
    put_rings( out, SKIN_LIMIT, VALIDATE_FOIL_SPOKES, fine, WISP_COUNT( fine ) );
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        put( out,
             ( way ){ SKIN_LIMIT, VALIDATE_FOIL_SPOKES, USUAL_RINGS, substeps[i], usual_softness( SKIN_LIMIT ),
                      PRESSURE },
             "substeps", "substep, s", (double)ACCURACY_FRAME / substeps[i] );
    }
    put_rings( out, SKIN_FIELD, VALIDATE_FOIL_SPOKES, rings, 4 );
    put_rings( out, SKIN_FIELD, VALIDATE_FOIL_EVEN, rings, 4 );
    put_rings( out, SKIN_LIMIT, VALIDATE_FOIL_EVEN, rings, 4 );
    put_rings( out, SKIN_LINKS, VALIDATE_FOIL_SPOKES, rings, 5 );
    put_rings( out, SKIN_LINKS, VALIDATE_FOIL_EVEN, rings, 5 );
    put_rings( out, SKIN_BEND_LINKS, VALIDATE_FOIL_SPOKES, rings, 4 );
    put_rings( out, SKIN_RIGID, VALIDATE_FOIL_SPOKES, rings, 4 );
    put_checks( out );
}

wisp_status validate_mylar( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)options;
    (void)seconds;
    *out = ( accuracy_scene ){
        .reference = "the Mylar balloon: radius 0.7627 a, thickness 0.9139 a, volume 1.2185 a^3; after 3 s",
        .note =
            "the error is the root mean square of those of radius, thickness and volume. The gas has ten times the "
            "volume of the balloon, so its pressure hardly changes. Springs that resist compression lock before the "
            "foil is full, and where depends on the start.",
        .error_name = "error of the three sizes",
        .error_unit = "%",
        .measure_names = { "radius error %", "thickness error %", "volume error %", "radius / a", "thickness / a",
                           "volume / a^3" },
        .measure_count = 6,
        .run = run,
    };
    const wisp_status status = accuracy_begin_scene( out, MAX_SETTINGS * sizeof( way ), MAX_SETTINGS, error );
    if ( status == WISP_OK )
    {
        put_settings( out );
    }
    return status;
}
