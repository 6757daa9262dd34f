// Two discs of foil, joined at the rim and filled: the shape of a Mylar balloon.
#include "validate/validate.h"

#include "accuracy/scene_tools.h"
#include "surfaces.h"
#include "validate/validate_balloons.h"
#include "validate/validate_bodies.h"

#include "oracle/balloon_meshes.h"
#include "wisp/module/random.h"

#include <math.h>
#include <stdlib.h>

// ---- discs of foil ----

static int ring_count( const validate_foil* foil, int ring )
{
    return ring == 0 ? 1 : 6 * ( foil->mesh == VALIDATE_FOIL_EVEN ? ring : foil->rings );
}

// Vertices of a disc within a ring.
static int inside_count( const validate_foil* foil, int ring )
{
    int sum = 0;
    for ( int i = 0; i < ring; ++i )
    {
        sum += ring_count( foil, i );
    }
    return sum;
}

int validate_foil_pole( const validate_foil* foil )
{
    return inside_count( foil, foil->rings );
}

int validate_foil_rim( const validate_foil* foil )
{
    return 2 * inside_count( foil, foil->rings );
}

static int vertex_on_ring( const validate_foil* foil, int side, int ring, int k )
{
    const int place = inside_count( foil, ring ) + k % ring_count( foil, ring );
    return place + ( ring == foil->rings || side == 1 ? inside_count( foil, foil->rings ) : 0 );
}

static void put_points( const validate_foil* foil, wisp_vec3* out )
{
    for ( int side = 0; side < 2; ++side )
    {
        for ( int ring = 0; ring <= foil->rings; ++ring )
        {
            const double part = (double)ring / foil->rings, up = foil->height * ( 1.0 - part * part );
            for ( int k = 0; k < ring_count( foil, ring ); ++k )
            {
                const double angle = 2.0 * VALIDATE_PI * k / ring_count( foil, ring );
                out[vertex_on_ring( foil, side, ring, k )] =
                    ( wisp_vec3 ){ (float)( foil->radius * part * cos( angle ) ), (float)( side == 0 ? up : -up ),
                                   (float)( foil->radius * part * sin( angle ) ) };
            }
        }
    }
}

// The discs look outwards: the upper one against the sense of the angle, which runs from +x to +z.
static int32_t* put_triangle( int32_t* out, int side, int a, int b, int c )
{
    out[0] = a;
    out[1] = side == 0 ? c : b;
    out[2] = side == 0 ? b : c;
    return out + 3;
}

// Between two rings a sixth has one vertex more outside than inside.
static int32_t* put_even_ring( const validate_foil* foil, int side, int ring, int32_t* out )
{
    for ( int k = 0; k < 6 * ( ring + 1 ); ++k )
    {
        const int place = k % ( ring + 1 ), inner = k / ( ring + 1 ) * ring + place;
        const int a = vertex_on_ring( foil, side, ring, inner ), b = vertex_on_ring( foil, side, ring + 1, k ),
                  c = vertex_on_ring( foil, side, ring + 1, k + 1 );
        out = put_triangle( out, side, a, b, c );
        if ( place < ring )
        {
            out = put_triangle( out, side, a, c, vertex_on_ring( foil, side, ring, inner + 1 ) );
        }
    }
    return out;
}

// Diagonals in turn, so that the mesh has no sense of rotation.
static int32_t* put_spoke_ring( const validate_foil* foil, int side, int ring, int32_t* out )
{
    for ( int k = 0; k < ring_count( foil, ring + 1 ); ++k )
    {
        const int a = vertex_on_ring( foil, side, ring, k ), b = vertex_on_ring( foil, side, ring + 1, k ),
                  c = vertex_on_ring( foil, side, ring + 1, k + 1 ), d = vertex_on_ring( foil, side, ring, k + 1 );
        const bool is_even = ( ring + k ) % 2 == 0;
        out = put_triangle( out, side, a, b, is_even || ring == 0 ? c : d );
        if ( ring > 0 )
        {
            out = put_triangle( out, side, is_even ? a : b, c, d );
        }
    }
    return out;
}

wisp_status validate_foil_make( const validate_foil* foil, wisp_mesh* out, wisp_error* error )
{
    const int vertex_count = validate_foil_rim( foil ) + ring_count( foil, foil->rings );
    const int triangle_count = 2 * ( vertex_count - 2 ); // of a closed mesh without handles (Euler)
    wisp_vec3* points = malloc( (size_t)vertex_count * sizeof( *points ) );
    int32_t* triangles = malloc( (size_t)triangle_count * 3 * sizeof( *triangles ) );
    wisp_status status = points != NULL && triangles != NULL
                             ? WISP_OK
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for a foil of %d rings", foil->rings );
    if ( status == WISP_OK )
    {
        put_points( foil, points );
        int32_t* end = triangles;
        for ( int i = 0; i < 2 * foil->rings; ++i )
        {
            end = ( foil->mesh == VALIDATE_FOIL_EVEN ? put_even_ring : put_spoke_ring )( foil, i % 2, i / 2, end );
        }
        status = wisp_mesh_of_arrays( points, vertex_count, triangles, triangle_count, "foil", out, error );
    }
    free( points );
    free( triangles );
    return status;
}

// ---- the case ----

enum
{
    FOIL_STEPS = 180, // 3 s
    FOIL_SUBSTEPS = 40,
    FOIL_RINGS = 12,
};

// Without gravity and air only p a / k and the substep in sqrt( rho a / p ) count, which is 0.2 s here.
#define FOIL_RADIUS 0.2   // m, a
#define FOIL_PRESSURE 5.0 // Pa
#define FOIL_DENSITY 1.0f // kg/m^2
#define SOFTNESS 1e-3     // p a / k
#define FOIL_DAMPING 5.0f // 1/s
#define REST_HEIGHT 1e-3  // of a pole over the rim, in a: the rest shape needs a volume
#define START_HEIGHT 0.1  // the same at the start. A high lens has longer meridians than the foil and collapses first
#define SHAKE 1e-3        // largest displacement of a vertex at the start, in a: a symmetric foil would not buckle
#define GAS_VOLUMES 10.0  // of the gas at the pressure of the atmosphere, in those of the Mylar balloon

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
static const char* const foil_names[VALIDATE_FOIL_COUNT] = { "even mesh", "spokes" };

typedef struct foil_way
{
    skin skin;
    validate_foil_mesh mesh;
    int rings, substeps;
    double softness, pressure; // p a / k; Pa
} foil_way;

// ---- a run ----

static validate_foil foil_with( const foil_way* w, double height )
{
    return ( validate_foil ){ w->mesh, w->rings, FOIL_RADIUS, height * FOIL_RADIUS };
}

static double foil_volume( double radius )
{
    return balloon_theory_mylar_shape().volume * radius * radius * radius;
}

// The gas presses with P_atm ( V_0 - V ) / V_0. With V_0 ten times V that is nearly constant, whatever the volume: a mesh too coarse for
// the shape is not squeezed.
static balloon_setting setting_of( const foil_way* w, double rest_volume, int workers )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    wisp_balloon_def* def = &setting.def;
    const double stiffness = w->pressure * FOIL_RADIUS / w->softness;
    def->atmospheric_pressure = (float)( w->pressure / ( 1.0 - 1.0 / GAS_VOLUMES ) );
    def->gas_ratio = (float)( GAS_VOLUMES * foil_volume( FOIL_RADIUS ) / rest_volume );
    def->edge_stiffness = (float)stiffness;
    def->bend_link_stiffness = (float)( 0.01 * stiffness );
    def->solver = w->skin == SKIN_RIGID ? WISP_SOLVER_PBD : WISP_SOLVER_XPBD;
    def->stretch_stiffness = 1.0f;
    setting.area_density = FOIL_DENSITY;
    setting.damping = FOIL_DAMPING;
    setting.substeps = w->substeps;
    setting.iterations = 1;
    setting.workers = workers;
    setting.seconds = ACCURACY_FRAME;
    return setting;
}

static wisp_membrane_def membrane_of( const foil_way* w )
{
    wisp_membrane_def def = wisp_default_membrane_def();
    def.shear_modulus = (float)( w->pressure * FOIL_RADIUS / w->softness / 3.0 ) / def.thickness;
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
        const double angle = 2.0 * VALIDATE_PI * i / DIRECTIONS, c = cos( angle ), s = sin( angle );
        double most = 0.0;
        for ( int k = 0; k < count; ++k )
        {
            most = fmax( most, c * (double)points[k].x + s * (double)points[k].z );
        }
        sum += most / DIRECTIONS;
    }
    return sum;
}

static wisp_status measure_foil( surface_implementation* foil, const foil_way* w, const wisp_mesh* mesh,
                                 accuracy_run* out, wisp_error* error )
{
    const wisp_vec3* points = NULL;
    const wisp_status status = surface_implementation_points( foil, &points, error );
    if ( status == WISP_OK )
    {
        const balloon_theory_mylar exact = balloon_theory_mylar_shape();
        const double volume = balloon_volume( mesh, points ) / ( FOIL_RADIUS * FOIL_RADIUS * FOIL_RADIUS );
        const validate_foil foil_of = foil_with( w, REST_HEIGHT );
        const double thick = wisp_mesh_distance( points[0], points[validate_foil_pole( &foil_of )] ) / FOIL_RADIUS;
        const double radius = equator_radius( points, mesh->vertex_count ) / FOIL_RADIUS;
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

static wisp_status run_foil( const foil_way* w, const wisp_mesh* rest, const wisp_mesh* start, int workers,
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
    status = status == WISP_OK ? accuracy_step_surface( &foil, FOIL_STEPS, out, error ) : status;
    status = status == WISP_OK ? accuracy_end_surface( &foil, out, error ) : status;
    status =
        status == WISP_OK && is_observed && out->halted_at == 0 ? measure_foil( &foil, w, rest, out, error ) : status;
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
                (float)( SHAKE * FOIL_RADIUS * ( 2.0 * wisp_random_unit( key, (uint32_t)i, (uint32_t)k, 0 ) - 1.0 ) );
        }
    }
}

static wisp_status run_mylar( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                              wisp_error* error )
{
    const foil_way* w = (const foil_way*)validate_own( context ) + setting;
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

static void put_foil( accuracy_scene* out, foil_way w, const char* by, const char* parameter_name, double parameter )
{
    char series[96];
    snprintf( series, sizeof series, "%s, %s, by %s", skin_names[w.skin], foil_names[w.mesh], by );
    ( (foil_way*)validate_own( out->context ) )[out->setting_count] = w;
    accuracy_setting* setting =
        accuracy_put_setting( out, "%s, %s, %d rings, %d substeps, p a / k = %g, %g Pa", skin_names[w.skin],
                              foil_names[w.mesh], w.rings, w.substeps, w.softness, w.pressure );
    accuracy_join_series( setting, by[0] != '\0' ? series : "", parameter_name, parameter, NAN );
}

static void put_rings( accuracy_scene* out, skin s, validate_foil_mesh mesh, const int* rings, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        put_foil( out, ( foil_way ){ s, mesh, rings[i], FOIL_SUBSTEPS, usual_softness( s ), FOIL_PRESSURE }, "rings",
                  "ring / a", 1.0 / rings[i] );
    }
}

// Neither pressure nor stiffness matters. Four times the pressure is the same motion twice as fast, so as accurate as half
// the substeps.
static void put_checks( accuracy_scene* out )
{
    const double usual = usual_softness( SKIN_LIMIT ), softness[] = { 1e-2, 1e-4 };
    foil_way firmer = { SKIN_LIMIT, VALIDATE_FOIL_SPOKES, FOIL_RINGS, FOIL_SUBSTEPS, 0.1 * usual, FOIL_PRESSURE };
    foil_way fuller = { SKIN_LIMIT, VALIDATE_FOIL_SPOKES, FOIL_RINGS, FOIL_SUBSTEPS, usual, 4.0 * FOIL_PRESSURE };
    put_foil( out, firmer, "", "", NAN );
    put_foil( out, fuller, "", "", NAN );
    for ( int i = 0; i < WISP_COUNT( softness ); ++i )
    {
        put_foil( out, ( foil_way ){ SKIN_LINKS, VALIDATE_FOIL_SPOKES, 8, FOIL_SUBSTEPS, softness[i], FOIL_PRESSURE },
                  "softness", "p a / k", softness[i] );
    }
}

static void put_foils( accuracy_scene* out )
{
    static const int fine[] = { 4, 6, 8, 12 }, rings[] = { 4, 6, 8, 16, 24 }, substeps[] = { 10, 20, 80 };
    put_rings( out, SKIN_LIMIT, VALIDATE_FOIL_SPOKES, fine, WISP_COUNT( fine ) );
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        put_foil( out,
                  ( foil_way ){ SKIN_LIMIT, VALIDATE_FOIL_SPOKES, FOIL_RINGS, substeps[i],
                                usual_softness( SKIN_LIMIT ), FOIL_PRESSURE },
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

const validate_case validate_mylar = {
    .name = "mylar",
    .title = "two discs of foil, joined at the rim and filled",
    .scene = { .reference = "the Mylar balloon: radius 0.7627 a, thickness 0.9139 a, volume 1.2185 a^3; after 3 s",
               .note = "the error is the root mean square of those of radius, thickness and volume. The gas has ten "
                       "times the "
                       "volume of the balloon, so its pressure hardly changes. Springs that resist compression lock "
                       "before the "
                       "foil is full, and where depends on the start.",
               .error_name = "error of the three sizes",
               .error_unit = "%",
               .measure_names = { "radius error %", "thickness error %", "volume error %", "radius / a",
                                  "thickness / a", "volume / a^3" },
               .measure_count = 6,
               .run = run_mylar },
    .own_size = VALIDATE_MAX_SETTINGS * sizeof( foil_way ),
    .put = put_foils,
};
