// Figures 4 to 8: what acts on a balloon, and how it flies.
#include "figures_bench.h"

#include "oracle/balloon_oracle.h"

#include <math.h>
#include <stdlib.h>

static double dot( const double a[3], const double b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length( const double a[3] )
{
    return sqrt( dot( a, a ) );
}

static double cosine( const double a[3], const double b[3] )
{
    double product = length( a ) * length( b );
    return product > 0.0 ? dot( a, b ) / product : 0.0;
}

// An open outlet at the vertex farthest along a direction, beside the centre of a body without symmetry.
static int give_outlet( const figures_case* page, balloon_setting* setting, wisp_vec3 direction )
{
    int vertex = balloon_mesh_extreme( &page->figure, direction );
    setting->def.outlet_count = 1;
    setting->def.outlet[0] = vertex;
    return vertex;
}

static wisp_status enter( const figures_case* page, const balloon_setting* setting, wisp_fabric** fabric,
                          surface_implementation* implementation, wisp_error* error )
{
    *implementation = ( surface_implementation ){ 0 };
    wisp_status status = balloon_cook( &page->figure, setting, fabric, error );
    return status == WISP_OK ? balloon_implementation_create( *fabric, setting, implementation, error ) : status;
}

static wisp_status advance( surface_implementation* implementation, int steps, wisp_balloon_stats* out,
                            wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && status == WISP_OK; ++s )
    {
        status = surface_implementation_step( implementation, error );
    }
    return status == WISP_OK ? balloon_implementation_read( implementation, out, error ) : status;
}

static wisp_status open_outlet( surface_implementation* implementation, wisp_error* error )
{
    wisp_status status = wisp_open_balloon( implementation->world, implementation->entity, true );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

// ---- F4 ----

// Area-weighted normal of a vertex.
static void vertex_normal( const wisp_mesh* mesh, const wisp_vec3* points, int vertex, double out[3] )
{
    out[0] = out[1] = out[2] = 0.0;
    for ( int t = 0; t < mesh->triangle_count; ++t )
    {
        const int32_t* c = mesh->triangles + 3 * (size_t)t;
        if ( c[0] == vertex || c[1] == vertex || c[2] == vertex )
        {
            wisp_vec3 a = points[c[0]], b = points[c[1]], d = points[c[2]];
            double u[3] = { (double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z };
            double v[3] = { (double)d.x - (double)a.x, (double)d.y - (double)a.y, (double)d.z - (double)a.z };
            out[0] += u[1] * v[2] - u[2] * v[1];
            out[1] += u[2] * v[0] - u[0] * v[2];
            out[2] += u[0] * v[1] - u[1] * v[0];
        }
    }
}

// Mean velocity, weighted by area as the mass of the skin is.
static bool mean_velocity( surface_implementation* implementation, double out[3] )
{
    const wisp_fabric* f = implementation->fabric;
    wisp_vec3* v = malloc( (size_t)f->vertex_count * sizeof( wisp_vec3 ) );
    if ( !v )
    {
        return false;
    }
    surface_implementation_velocities( implementation, v );
    out[0] = out[1] = out[2] = 0.0;
    for ( int i = 0; i < f->vertex_count; ++i )
    {
        double area = (double)f->area[f->vertex_slot[i]];
        out[0] += area * (double)v[i].x;
        out[1] += area * (double)v[i].y;
        out[2] += area * (double)v[i].z;
    }
    free( v );
    return true;
}

wisp_status figures_four_forces( figures_case* page, wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = 1.2f;
    setting.damping = 10.0f;
    int vertex = give_outlet( page, &setting, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    wisp_balloon_stats seen;
    wisp_status status = enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? advance( &implementation, 30, &seen, error ) : status;
    status = status == WISP_OK ? open_outlet( &implementation, error ) : status;
    const wisp_vec3 thrown = { 0.0f, 0.0f, 2.0f };
    if ( status == WISP_OK )
    {
        status = wisp_set_velocity( implementation.world, implementation.entity, thrown, ( wisp_vec3 ){ 0, 0, 0 } );
        status = status == WISP_OK ? advance( &implementation, 1, &seen, error )
                                   : bench_world_fail( implementation.world, status, error );
    }
    const wisp_vec3* points = NULL;
    status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
    double along[3] = { 0.0, 0.0, 0.0 };
    if ( status == WISP_OK && !mean_velocity( &implementation, along ) )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for velocities" );
    }
    if ( status == WISP_OK )
    {
        const double down[3] = { 0, -1, 0 }, up[3] = { 0, 1, 0 };
        double normal[3];
        vertex_normal( &page->figure, points, vertex, normal );
        double c[4] = { cosine( seen.gravity, down ), cosine( seen.buoyancy, up ), -cosine( seen.drag, along ),
                        -cosine( seen.jet, normal ) };
        figures_add( page, "F4", "the body thrown at 2 m/s along z, outlet open: four forces",
                     "gravity down, buoyancy up, drag against v, jet along -n: cosines near 1",
                     c[0] > 0.9999 && c[1] > 0.9999 && c[2] > 0.95 && c[3] > 0.95,
                     "cosines %.4f %.4f %.4f %.4f; %.4f, %.4f, %.4f, %.4f N", c[0], c[1], c[2], c[3],
                     length( seen.gravity ), length( seen.buoyancy ), length( seen.drag ), length( seen.jet ) );
    }
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

// ---- F5 ----

#define INFLATE_STEPS 60
#define RELEASE_STEPS_MAX 1200
// The outlet stops when no gas is left above V_rest; the skin then comes to rest.
#define REST_STEPS 120
// Of the largest overpressure. A crumpled skin comes to rest near its rest shape and not in it, so a little tension
// stays however long one waits.
#define END_FRACTION 0.02

typedef struct release
{
    double volume_rest, max_volume, volume_end, max_pressure, pressure_end, max_spin, gas_lost, gas_requested;
    int steps;
    bool rose; // the volume never fell while gas came in
} release;

static wisp_status inflate( surface_implementation* implementation, release* r, wisp_error* error )
{
    wisp_balloon_stats seen;
    wisp_status status = WISP_OK;
    r->rose = true;
    for ( int s = 0; s < INFLATE_STEPS && status == WISP_OK; ++s )
    {
        status = advance( implementation, 1, &seen, error );
        if ( status == WISP_OK )
        {
            r->rose = r->rose && seen.volume >= r->max_volume;
            r->max_volume = fmax( r->max_volume, seen.volume );
            r->max_pressure = fmax( r->max_pressure, seen.pressure );
            r->volume_rest = seen.rest_volume;
            r->gas_requested = seen.target_volume;
        }
    }
    if ( status == WISP_OK )
    {
        status = wisp_set_balloon_inflation( implementation->world, implementation->entity, 0.0f );
        status = status == WISP_OK ? open_outlet( implementation, error )
                                   : bench_world_fail( implementation->world, status, error );
    }
    return status;
}

static wisp_status let_go( const figures_case* page, surface_implementation* implementation, figures_album* album,
                           release* r, wisp_error* error )
{
    wisp_balloon_stats seen = { 0 };
    wisp_status status = WISP_OK;
    bool is_running = true;
    for ( r->steps = 0; r->steps < RELEASE_STEPS_MAX && is_running && status == WISP_OK; ++r->steps )
    {
        status = advance( implementation, 1, &seen, error );
        r->max_spin = fmax( r->max_spin, length( seen.angular_velocity ) );
        is_running = r->steps == 0 || seen.mass_flow > 0.0;
        if ( status == WISP_OK && ( r->steps == 5 || r->steps == 15 ) )
        {
            status =
                figures_take( page, album, implementation, error, "%.2f s after release", ( r->steps + 1 ) / 60.0 );
        }
    }
    status = status == WISP_OK ? advance( implementation, REST_STEPS, &seen, error ) : status;
    r->volume_end = seen.volume;
    r->pressure_end = seen.pressure;
    r->gas_lost = seen.gas_lost;
    r->gas_requested -= seen.target_volume;
    return status;
}

wisp_status figures_inflate_release( figures_case* page, wisp_error* error )
{
    figures_album album = { .mesh = &page->figure };
    balloon_setting setting = balloon_default_setting();
    double rest = balloon_volume( &page->figure, page->figure.points );
    setting.def.inflation_rate = (float)( 0.5 * rest );
    setting.damping = 2.0f;
    give_outlet( page, &setting, ( wisp_vec3 ){ 1.0f, 0.5f, 0.2f } );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    release r = { 0 };
    wisp_status status = enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? inflate( &implementation, &r, error ) : status;
    status = status == WISP_OK ? figures_take( page, &album, &implementation, error, "inflated" ) : status;
    status = status == WISP_OK ? let_go( page, &implementation, &album, &r, error ) : status;
    status = status == WISP_OK ? figures_take( page, &album, &implementation, error, "empty" ) : status;
    if ( status == WISP_OK )
    {
        double density = balloon_oracle_density( (double)setting.def.atmospheric_pressure, BALLOON_ORACLE_HELIUM,
                                                 (double)setting.def.temperature );
        figures_add(
            page, "F5", "inflated by half its volume in 1 s, then released",
            "V rises, then falls; P - P_atm ends below 2 % of its largest; the body turns",
            r.rose && r.max_volume > 1.2 * r.volume_rest && r.volume_end < 0.9 * r.max_volume &&
                r.max_pressure > 1000.0 && r.pressure_end <= END_FRACTION * r.max_pressure && r.max_spin > 1.0,
            "V / V_rest up to %.3f, then %.3f; P - P_atm from %.0f to %.1f Pa, jet of %.2f s; up to %.1f rad/s",
            r.max_volume / r.volume_rest, r.volume_end / r.volume_rest, r.max_pressure, r.pressure_end,
            r.steps / 60.0, r.max_spin );
        double wrong = fabs( r.gas_lost / ( density * r.gas_requested ) - 1.0 );
        figures_add( page, "F5", "gas that left the outlet against gas that is missing", "the same mass within 1e-6",
                     wrong < 1e-6, "%.4f g, %.1e apart", 1e3 * r.gas_lost, wrong );
        status = figures_write( page, &album, NULL, "f5_release", "F5, inflated and released", error );
    }
    figures_album_free( &album );
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

// ---- F6 ----

#define TAGS 4
#define TRACK_STEPS 12

typedef struct spin_run
{
    double spin, mass_flow; // rad/s and kg/s, largest
} spin_run;

// Tags are the farthest vertices along four directions.
static wisp_status track( figures_case* page, surface_implementation* implementation, figures_tracks* tracks,
                          int step, wisp_error* error )
{
    static const wisp_vec3 directions[TAGS] = { { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { -1, 0, 0 } };
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    for ( int tag = 0; tag < TAGS && status == WISP_OK; ++tag )
    {
        int vertex = balloon_mesh_extreme( &page->figure, directions[tag] );
        tracks->points[tag * tracks->length + step] = points[vertex];
    }
    return status;
}

static wisp_status fly( figures_case* page, float area, figures_album* album, figures_tracks* tracks, spin_run* out,
                        wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = 1.2f;
    setting.def.outlet_area = area;
    setting.damping = 5.0f;
    give_outlet( page, &setting, ( wisp_vec3 ){ 1.0f, 0.5f, 0.2f } );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    wisp_balloon_stats seen;
    wisp_status status = enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? advance( &implementation, 60, &seen, error ) : status;
    status = status == WISP_OK ? open_outlet( &implementation, error ) : status;
    for ( int step = 0; step < TRACK_STEPS && status == WISP_OK; ++step )
    {
        status = track( page, &implementation, tracks, step, error );
        status = status == WISP_OK ? advance( &implementation, 1, &seen, error ) : status;
        out->spin = fmax( out->spin, length( seen.angular_velocity ) );
        out->mass_flow = fmax( out->mass_flow, seen.mass_flow );
    }
    status = status == WISP_OK
                 ? figures_take( page, album, &implementation, error, "after %.1f s", TRACK_STEPS / 60.0 )
                 : status;
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

wisp_status figures_spin( figures_case* page, wisp_error* error )
{
    static const float areas[] = { 2e-5f, 5e-5f, 1e-4f };
    spin_run runs[WISP_COUNT( areas )] = { { 0.0, 0.0 } };
    figures_tracks tracks = { .track_count = TAGS, .length = TRACK_STEPS };
    tracks.points = malloc( TAGS * TRACK_STEPS * sizeof( wisp_vec3 ) );
    wisp_status status = tracks.points ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for tracks" );
    for ( int i = 0; i < WISP_COUNT( areas ) && status == WISP_OK; ++i )
    {
        figures_album album = { .mesh = &page->figure };
        char name[32], caption[80];
        snprintf( name, sizeof( name ), "f6_tracks_%d", i + 1 );
        snprintf( caption, sizeof( caption ), "F6, tracks of four vertices, outlet of %.1f cm2",
                  1e4 * (double)areas[i] );
        status = fly( page, areas[i], &album, &tracks, &runs[i], error );
        status = status == WISP_OK ? figures_write( page, &album, &tracks, name, caption, error ) : status;
        figures_album_free( &album );
    }
    if ( status == WISP_OK )
    {
        bool grows = runs[0].spin < runs[1].spin && runs[1].spin < runs[2].spin &&
                     runs[0].mass_flow < runs[1].mass_flow && runs[1].mass_flow < runs[2].mass_flow;
        figures_add( page, "F6", "outlet off centre, 0.2, 0.5 and 1 cm2", "a larger outflow spins faster",
                     grows && runs[0].spin > 0.0, "%.2f, %.2f, %.2f g/s; %.1f, %.1f, %.1f rad/s in 0.2 s",
                     1e3 * runs[0].mass_flow, 1e3 * runs[1].mass_flow, 1e3 * runs[2].mass_flow, runs[0].spin,
                     runs[1].spin, runs[2].spin );
    }
    free( tracks.points );
    return status;
}

// ---- F7 ----

#define RISE_STEPS 60
#define FALL_STEPS 12

typedef struct rise_run
{
    double risen, fell;  // m, while shut and after opening
    double speed, spin;  // m/s downwards and rad/s, largest after opening
    double lift, weight; // N
} rise_run;

static wisp_status rise( figures_case* page, float gas_ratio, rise_run* out, wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = gas_ratio;
    setting.damping = 1.0f;
    give_outlet( page, &setting, ( wisp_vec3 ){ 0.3f, 1.0f, 0.0f } );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    wisp_balloon_stats seen = { 0 };
    wisp_status status = enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? advance( &implementation, RISE_STEPS, &seen, error ) : status;
    out->risen = seen.centre[1];
    out->lift = length( seen.buoyancy );
    out->weight = length( seen.gravity );
    status = status == WISP_OK ? open_outlet( &implementation, error ) : status;
    double highest = seen.centre[1], before = seen.centre[1];
    for ( int s = 0; s < FALL_STEPS && status == WISP_OK; ++s )
    {
        status = advance( &implementation, 1, &seen, error );
        out->speed = fmax( out->speed, ( before - seen.centre[1] ) / (double)BALLOON_STEP );
        out->spin = fmax( out->spin, length( seen.angular_velocity ) );
        highest = fmax( highest, seen.centre[1] );
        before = seen.centre[1];
    }
    out->fell = highest - seen.centre[1];
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

wisp_status figures_rise_and_reverse( figures_case* page, wisp_error* error )
{
    static const float fills[] = { 1.2f, 1.5f, 2.0f };
    rise_run runs[WISP_COUNT( fills )] = { { 0 } };
    wisp_status status = WISP_OK;
    bool all_rise = true, all_reverse = true;
    for ( int i = 0; i < WISP_COUNT( fills ) && status == WISP_OK; ++i )
    {
        status = rise( page, fills[i], &runs[i], error );
        all_rise = all_rise && ( runs[i].risen > 0.0 ) == ( runs[i].lift > runs[i].weight );
        all_reverse = all_reverse && runs[i].fell > 0.0;
    }
    if ( status != WISP_OK )
    {
        return status;
    }
    figures_add( page, "F7", "1 s in free air at fills of 1.2, 1.5 and 2", "rises if its weight is below its lift",
                 all_rise && runs[2].risen > runs[0].risen,
                 "lift / weight %.2f, %.2f, %.2f; rises %.2f, %.2f, %.2f m", runs[0].lift / runs[0].weight,
                 runs[1].lift / runs[1].weight, runs[2].lift / runs[2].weight, runs[0].risen, runs[1].risen,
                 runs[2].risen );
    figures_add(
        page, "F7", "an outlet near the top opens suddenly", "the path reverses; speed and spin grow with the fill",
        all_reverse && runs[0].speed < runs[1].speed && runs[1].speed < runs[2].speed &&
            runs[0].spin < runs[1].spin && runs[1].spin < runs[2].spin,
        "falls %.2f, %.2f, %.2f m in 0.2 s; %.1f, %.1f, %.1f m/s; %.1f, %.1f, %.1f rad/s", runs[0].fell, runs[1].fell,
        runs[2].fell, runs[0].speed, runs[1].speed, runs[2].speed, runs[0].spin, runs[1].spin, runs[2].spin );
    return WISP_OK;
}

// ---- F8 ----

#define TIMED_STEPS 15

static wisp_status time_sphere( int level, double* vertices, double* ms, wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = 1.2f;
    wisp_mesh mesh = { 0 };
    wisp_fabric* fabric = NULL;
    surface_implementation implementation = { 0 };
    double samples[TIMED_STEPS];
    wisp_status status = balloon_mesh_sphere( level, BALLOON_RADIUS, &mesh, error );
    status = status == WISP_OK ? balloon_cook( &mesh, &setting, &fabric, error ) : status;
    status = status == WISP_OK ? balloon_implementation_create( fabric, &setting, &implementation, error ) : status;
    for ( int s = -2; s < TIMED_STEPS && status == WISP_OK; ++s )
    {
        double start = wisp_clock_seconds();
        status = surface_implementation_step( &implementation, error );
        samples[s < 0 ? 0 : s] = 1e3 * ( wisp_clock_seconds() - start );
    }
    if ( status == WISP_OK )
    {
        *vertices = mesh.vertex_count;
        *ms = stats_summarise( samples, TIMED_STEPS ).median;
    }
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    wisp_mesh_release( &mesh );
    return status;
}

wisp_status figures_real_time( figures_case* page, wisp_error* error )
{
    enum
    {
        SIZES = 4,
        COARSEST = 3,
    };
    double vertices[SIZES] = { 0 }, ms[SIZES] = { 0 };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < SIZES && status == WISP_OK; ++i )
    {
        status = time_sphere( COARSEST + i, &vertices[i], &ms[i], error );
    }
    if ( status == WISP_OK )
    {
        // Whether it is real time is for the machine to say; that it grows with the vertices is not.
        stats_line line = stats_fit_line( vertices, ms, SIZES );
        figures_add( page, "F8",
                     "spheres of 642, 2 562, 10 242, 40 962 vertices, all forces and statistics, 1 worker",
                     "milliseconds per step, near linear: R^2 > 0.98", line.r_squared > 0.98,
                     "%.2f, %.2f, %.2f, %.2f ms; R^2 = %.4f", ms[0], ms[1], ms[2], ms[3], line.r_squared );
    }
    return status;
}
