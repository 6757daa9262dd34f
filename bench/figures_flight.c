// Figures 4 to 6 and 8: what acts on a balloon, how it empties, and how long a step takes.
#include "figures_bench.h"

#include "oracle/balloon_oracle.h"

#include <math.h>
#include <stdlib.h>

// Of the edges of an emptied body. A scanned figure with thin ears keeps a few creases.
#define FLIGHT_STRAIN_LEFT 0.15

static double dot( const double a[3], const double b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double flight_length( const double a[3] )
{
    return sqrt( dot( a, a ) );
}

static double cosine( const double a[3], const double b[3] )
{
    double product = flight_length( a ) * flight_length( b );
    return product > 0.0 ? dot( a, b ) / product : 0.0;
}

#define OUTLET_RADIUS 0.02f // m

// An outlet at the vertex farthest along a direction, beside the centre of a body without symmetry.
static int give_outlet( const figures_case* page, balloon_setting* setting, wisp_vec3 direction )
{
    int vertex = balloon_mesh_extreme( &page->figure, direction );
    setting->def.outlet_count = 1;
    setting->def.outlet[0] = vertex;
    return vertex;
}

// A shut outlet of the vertices within 2 cm of the one that is nearest to a point: their common normal is steadier than that
// of a single vertex.
static void flight_give_outlet( const figures_case* page, wisp_vec3 at, balloon_setting* setting )
{
    const wisp_mesh* mesh = &page->figure;
    const int nearest = balloon_mesh_nearest( mesh, at );
    const wisp_vec3 centre = mesh->points[nearest];
    for ( int v = 0; v < mesh->vertex_count && setting->def.outlet_count < WISP_BALLOON_MAX_OUTLET; ++v )
    {
        if ( wisp_mesh_distance( mesh->points[v], centre ) <= (double)OUTLET_RADIUS )
        {
            setting->def.outlet[setting->def.outlet_count++] = v;
        }
    }
}

// A balloon of the scanned figure. Destroy the implementation and release the fabric, also on failure.
static wisp_status flight_enter( const figures_case* page, const balloon_setting* setting, wisp_fabric** fabric,
                                 surface_implementation* implementation, wisp_error* error )
{
    *implementation = ( surface_implementation ){ 0 };
    wisp_status status = balloon_cook( &page->figure, setting, fabric, error );
    status = status == WISP_OK ? balloon_implementation_create( *fabric, setting, implementation, error ) : status;
    if ( status == WISP_OK )
    {
        status = wisp_request( implementation->world, implementation->entity, WISP_MOTION_STATS );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
    }
    return status;
}

// @param out the statistics after the last step
static wisp_status flight_advance( surface_implementation* implementation, int steps, wisp_balloon_stats* out,
                                   wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && status == WISP_OK; ++s )
    {
        status = surface_implementation_step( implementation, error );
    }
    return status == WISP_OK ? balloon_implementation_read( implementation, out, error ) : status;
}

static wisp_status flight_open( surface_implementation* implementation, wisp_error* error )
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
    wisp_status status = flight_enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? flight_advance( &implementation, 30, &seen, error ) : status;
    status = status == WISP_OK ? flight_open( &implementation, error ) : status;
    const wisp_vec3 thrown = { 0.0f, 0.0f, 2.0f };
    if ( status == WISP_OK )
    {
        status = wisp_set_velocity( implementation.world, implementation.entity, thrown, ( wisp_vec3 ){ 0, 0, 0 } );
        status = status == WISP_OK ? flight_advance( &implementation, 1, &seen, error )
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
                     flight_length( seen.gravity ), flight_length( seen.buoyancy ), flight_length( seen.drag ),
                     flight_length( seen.jet ) );
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
    double strain; // of the edges, at the end
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
        status = flight_advance( implementation, 1, &seen, error );
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
        status = status == WISP_OK ? flight_open( implementation, error )
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
        status = flight_advance( implementation, 1, &seen, error );
        r->max_spin = fmax( r->max_spin, flight_length( seen.angular_velocity ) );
        is_running = r->steps == 0 || seen.mass_flow > 0.0;
        if ( status == WISP_OK && ( r->steps == 11 || r->steps == 23 ) )
        {
            status =
                figures_take( page, album, implementation, error, "%.2f s after release", ( r->steps + 1 ) / 60.0 );
        }
    }
    status = status == WISP_OK ? flight_advance( implementation, REST_STEPS, &seen, error ) : status;
    wisp_motion_stats motion = { 0 };
    if ( status == WISP_OK )
    {
        status = wisp_read_motion_stats( implementation->world, implementation->entity, &motion );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
    }
    r->strain = motion.strain_max;
    r->volume_end = seen.volume;
    r->pressure_end = seen.pressure;
    r->gas_lost = seen.gas_lost;
    r->gas_requested -= seen.target_volume;
    return status;
}

wisp_status figures_inflate_release( figures_case* page, wisp_error* error )
{
    figures_album album = { .mesh = &page->figure, .is_centred = true };
    balloon_setting setting = balloon_default_setting();
    const wisp_vec3 tail = { 1.0f, 0.5f, 0.2f };
    double rest = balloon_volume( &page->figure, page->figure.points );
    setting.def.inflation_rate = (float)( 0.5 * rest );
    setting.def.edge_stiffness = 1000.0f;
    setting.def.outlet_area = 5e-5f;
    setting.damping = 2.0f;
    flight_give_outlet( page, page->figure.points[balloon_mesh_extreme( &page->figure, tail )], &setting );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    release r = { 0 };
    wisp_status status = flight_enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? inflate( &implementation, &r, error ) : status;
    status = status == WISP_OK ? figures_take( page, &album, &implementation, error, "inflated" ) : status;
    status = status == WISP_OK ? let_go( page, &implementation, &album, &r, error ) : status;
    status = status == WISP_OK ? figures_take( page, &album, &implementation, error, "empty" ) : status;
    if ( status == WISP_OK )
    {
        double density = balloon_oracle_density( (double)setting.def.atmospheric_pressure, BALLOON_ORACLE_HELIUM,
                                                 (double)setting.def.temperature );
        figures_add( page, "F5", "inflated by half its volume in 1 s, then released",
                     "V rises, then falls; P - P_atm ends below 2 % of its largest; the body turns and is smooth "
                     "again, strain "
                     "below 0.15",
                     r.rose && r.max_volume > 1.2 * r.volume_rest && r.volume_end < 0.9 * r.max_volume &&
                         r.max_pressure > 1000.0 && r.pressure_end <= END_FRACTION * r.max_pressure &&
                         r.max_spin > 3.0 && r.strain < FLIGHT_STRAIN_LEFT,
                     "V / V_rest up to %.3f, then %.3f; P - P_atm from %.0f to %.1f Pa, jet of %.2f s; up to %.1f "
                     "rad/s; strain "
                     "%.3f",
                     r.max_volume / r.volume_rest, r.volume_end / r.volume_rest, r.max_pressure, r.pressure_end,
                     r.steps / 60.0, r.max_spin, r.strain );
        double wrong = fabs( r.gas_lost / ( density * r.gas_requested ) - 1.0 );
        figures_add( page, "F5", "gas that left the outlet against gas that is missing", "the same mass within 1e-6",
                     wrong < 1e-6, "%.4f g, %.1e apart", 1e3 * r.gas_lost, wrong );
        status = figures_write( page, &album, NULL, "f5_release", "F5, inflated and released; the camera goes along",
                                error );
    }
    figures_album_free( &album );
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

// ---- F6 ----

enum
{
    SPIN_STEPS = 18,
    SPIN_SETTINGS = 4,
};

typedef struct spin_run
{
    double spin, mass_flow; // rad/s and kg/s, largest
} spin_run;

// Add a point to each track: of the vertices that are farthest along four directions.
static wisp_status flight_track( const figures_case* page, surface_implementation* implementation,
                                 figures_tracks* tracks, int step, wisp_error* error )
{
    static const wisp_vec3 directions[FIGURES_TRACKS_MAX] = { { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { -1, 0, 0 } };
    const wisp_vec3* points;
    wisp_status status = surface_implementation_points( implementation, &points, error );
    for ( int tag = 0; tag < FIGURES_TRACKS_MAX && status == WISP_OK; ++tag )
    {
        int vertex = balloon_mesh_extreme( &page->figure, directions[tag] );
        tracks->points[tag * tracks->length + step] = points[vertex];
    }
    return status;
}

// Empty tracks of four vertices. Free out[0].points, also on failure.
// @param out receives [count]
// @param length points of a track
static wisp_status flight_tracks_make( int count, int length, float radius, figures_tracks* out, wisp_error* error )
{
    const size_t each = (size_t)FIGURES_TRACKS_MAX * (size_t)length;
    wisp_vec3* points = calloc( (size_t)count * each, sizeof( wisp_vec3 ) );
    for ( int i = 0; i < count; ++i )
    {
        out[i] = ( figures_tracks ){ points ? points + (size_t)i * each : NULL, FIGURES_TRACKS_MAX, length, radius };
    }
    return points ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for tracks" );
}

static wisp_status fly_spinning( figures_case* page, float area, figures_album* album, figures_tracks* tracks,
                                 spin_run* out, wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = 1.2f;
    setting.def.outlet_area = area;
    setting.damping = 5.0f;
    give_outlet( page, &setting, ( wisp_vec3 ){ 1.0f, 0.5f, 0.2f } );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    wisp_balloon_stats seen;
    wisp_status status = flight_enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? flight_advance( &implementation, 60, &seen, error ) : status;
    status = status == WISP_OK ? flight_open( &implementation, error ) : status;
    for ( int step = 0; step < SPIN_STEPS && status == WISP_OK; ++step )
    {
        status = flight_track( page, &implementation, tracks, step, error );
        status = status == WISP_OK ? flight_advance( &implementation, 1, &seen, error ) : status;
        out->spin = fmax( out->spin, flight_length( seen.angular_velocity ) );
        out->mass_flow = fmax( out->mass_flow, seen.mass_flow );
    }
    status = status == WISP_OK
                 ? figures_take( page, album, &implementation, error, "outlet %.1f cm2", 1e4 * (double)area )
                 : status;
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

wisp_status figures_spin( figures_case* page, wisp_error* error )
{
    static const float areas[SPIN_SETTINGS] = { 2e-5f, 4e-5f, 8e-5f, 1.6e-4f };
    spin_run runs[SPIN_SETTINGS] = { { 0.0, 0.0 } };
    figures_album album = { .mesh = &page->figure };
    figures_tracks tracks[SPIN_SETTINGS];
    wisp_status status = flight_tracks_make( SPIN_SETTINGS, SPIN_STEPS, 0.0015f, tracks, error );
    bool grows = true;
    for ( int i = 0; i < SPIN_SETTINGS && status == WISP_OK; ++i )
    {
        status = fly_spinning( page, areas[i], &album, &tracks[i], &runs[i], error );
        grows = grows && runs[i].spin > ( i > 0 ? 1.1 * runs[i - 1].spin : 0.0 ) &&
                runs[i].mass_flow > ( i > 0 ? runs[i - 1].mass_flow : 0.0 );
    }
    if ( status == WISP_OK )
    {
        figures_add( page, "F6", "outlet off centre, 0.2, 0.4, 0.8 and 1.6 cm2",
                     "a larger outflow spins faster, by a tenth at least", grows,
                     "%.2f, %.2f, %.2f, %.2f g/s; %.1f, %.1f, %.1f, %.1f rad/s in %.1f s", 1e3 * runs[0].mass_flow,
                     1e3 * runs[1].mass_flow, 1e3 * runs[2].mass_flow, 1e3 * runs[3].mass_flow, runs[0].spin,
                     runs[1].spin, runs[2].spin, runs[3].spin, SPIN_STEPS / 60.0 );
        status = figures_write( page, &album, tracks, "f6_tracks", "F6, tracks of four vertices after 0.3 s", error );
    }
    figures_album_free( &album );
    free( tracks[0].points );
    return status;
}

// ---- F8 ----

#define TIMED_STEPS 15

static wisp_status time_sphere( int level, double* vertices, double* ms, wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = 1.2f;
    setting.def.outlet_count = 1; // vertex 0
    setting.def.outlet_open = true;
    wisp_mesh mesh = { 0 };
    wisp_fabric* fabric = NULL;
    surface_implementation implementation = { 0 };
    double samples[TIMED_STEPS];
    wisp_status status = balloon_mesh_sphere( level, BALLOON_RADIUS, &mesh, error );
    status = status == WISP_OK ? balloon_cook( &mesh, &setting, &fabric, error ) : status;
    status = status == WISP_OK ? balloon_implementation_create( fabric, &setting, &implementation, error ) : status;
    for ( int s = -2; s < TIMED_STEPS && status == WISP_OK; ++s )
    {
        // one worker, so the time of the processor is that of the step without what else runs on the machine
        double start = machine_cpu_seconds();
        status = surface_implementation_step( &implementation, error );
        samples[s < 0 ? 0 : s] = 1e3 * ( machine_cpu_seconds() - start );
    }
    if ( status == WISP_OK )
    {
        *vertices = mesh.vertex_count;
        *ms = stats_summarise( samples, TIMED_STEPS ).minimum; // others on the machine only add to it
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
        const stats_line line = stats_fit_line( vertices, ms, SIZES );
        double log_vertices[SIZES], log_ms[SIZES];
        for ( int i = 0; i < SIZES; ++i )
        {
            log_vertices[i] = log( vertices[i] );
            log_ms[i] = log( ms[i] );
        }
        const double power = stats_fit_line( log_vertices, log_ms, SIZES ).slope, frame = 1e3 * (double)BALLOON_STEP;
        figures_add_known(
            page, "F8", "spheres of 642, 2 562, 10 242, 40 962 vertices, all forces and statistics, 1 worker",
            "near linear: time goes with vertices to the power 0.85 to 1.15, R^2 of the line above 0.98",
            power > 0.85 && power < 1.15 && line.r_squared > 0.98,
            "%.2f, %.2f, %.2f, %.2f ms; power %.3f, R^2 = %.4f", ms[0], ms[1], ms[2], ms[3], power, line.r_squared );
        figures_add_known( page, "F8", "the same, real time", "10 242 vertices within the step of 16.7 ms",
                           ms[2] < frame, "%.2f ms; by the line %.0f vertices fit into a step", ms[2],
                           ( frame - line.intercept ) / line.slope );
    }
    return status;
}

// ---- rise and reverse ----

// Figure 7: inflated in free air, then released suddenly.

enum
{
    RISE_STEPS = 60,
    RELEASE_STEPS = 120,
    RISE_FILLS = 3,
};

typedef struct rise_run
{
    double lift, weight;             // N
    double risen, highest, end;      // m, when it is released, at most and at the end
    double fall, spin;               // m/s downwards and rad/s, largest after the release
    double strain, strain_max, left; // of the edges: largest at the release, ever after it, and at the end
} rise_run;

static wisp_status step_and_track( const figures_case* page, surface_implementation* implementation, int step,
                                   figures_tracks* tracks, wisp_balloon_stats* seen, wisp_motion_stats* motion,
                                   wisp_error* error )
{
    wisp_status status = flight_advance( implementation, 1, seen, error );
    status = status == WISP_OK ? flight_track( page, implementation, tracks, step - 1, error ) : status;
    if ( status == WISP_OK )
    {
        status = wisp_read_motion_stats( implementation->world, implementation->entity, motion );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
    }
    return status;
}

static wisp_status fly_up( const figures_case* page, surface_implementation* implementation, float gas_ratio,
                           figures_album* album, figures_tracks* tracks, rise_run* out, wisp_error* error )
{
    wisp_balloon_stats seen = { 0 };
    wisp_motion_stats motion = { 0 };
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= RISE_STEPS + RELEASE_STEPS && status == WISP_OK; ++step )
    {
        if ( step == RISE_STEPS + 1 )
        {
            *out = ( rise_run ){ .lift = flight_length( seen.buoyancy ),
                                 .weight = flight_length( seen.gravity ),
                                 .risen = motion.centre[1],
                                 .highest = motion.centre[1],
                                 .strain = motion.strain_max };
            status = figures_take( page, album, implementation, error, "released" );
            status = status == WISP_OK ? flight_open( implementation, error ) : status;
        }
        status =
            status == WISP_OK ? step_and_track( page, implementation, step, tracks, &seen, &motion, error ) : status;
        status =
            status == WISP_OK && step == 1 ? figures_take( page, album, implementation, error, "start" ) : status;
        out->fall = fmax( out->fall, -motion.momentum[1] / motion.mass );
        out->spin = fmax( out->spin, flight_length( seen.angular_velocity ) );
        out->highest = fmax( out->highest, motion.centre[1] );
        out->strain_max = fmax( out->strain_max, motion.strain_max );
    }
    out->end = motion.centre[1];
    out->left = motion.strain_max;
    return status == WISP_OK ? figures_take( page, album, implementation, error, "fill %.1f: start, full, empty",
                                             (double)gas_ratio )
                             : status;
}

// A skin of 35 g/m^2, so that the empty body sinks, and 1000 N/m, so that the pressure of the fullest stays below 7.5 kPa, up
// to which Bernoulli's law holds. The jet is 0.5 cm^2.
static wisp_status rise( figures_case* page, float gas_ratio, figures_album* album, figures_tracks* tracks,
                         rise_run* out, wisp_error* error )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = gas_ratio;
    setting.def.edge_stiffness = 1000.0f;
    setting.def.outlet_area = 5e-5f;
    setting.area_density = 0.035f;
    setting.damping = 1.0f;
    // whose common normal does not flap as that of the tip of an ear does
    flight_give_outlet( page, ( wisp_vec3 ){ -0.07f, 0.2f, 0.01f }, &setting );
    wisp_fabric* fabric = NULL;
    surface_implementation implementation;
    wisp_status status = flight_enter( page, &setting, &fabric, &implementation, error );
    status = status == WISP_OK ? fly_up( page, &implementation, gas_ratio, album, tracks, out, error ) : status;
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    return status;
}

static void add_rise_rows( figures_case* page, const rise_run* runs )
{
    bool rises = true, reverses = true, grows = true, bounded = true;
    for ( int i = 0; i < RISE_FILLS; ++i )
    {
        const rise_run* r = runs + i;
        rises = rises && r->lift > r->weight && r->risen > ( i > 0 ? 1.1 * runs[i - 1].risen : 0.1 );
        reverses = reverses && r->highest < r->risen + 0.1 && r->end < r->highest - 0.1;
        grows = grows && r->fall > ( i > 0 ? 1.1 * runs[i - 1].fall : 0.5 ) &&
                r->spin > ( i > 0 ? 1.1 * runs[i - 1].spin : 0.0 );
        bounded = bounded && r->strain_max < 1.05 * r->strain && r->left < FLIGHT_STRAIN_LEFT;
    }
    figures_add(
        page, "F7", "1 s in free air at fills of 1.4, 1.7 and 2", "rises, since its lift is above its weight", rises,
        "lift / weight %.2f, %.2f, %.2f; rises %.2f, %.2f, %.2f m", runs[0].lift / runs[0].weight,
        runs[1].lift / runs[1].weight, runs[2].lift / runs[2].weight, runs[0].risen, runs[1].risen, runs[2].risen );
    figures_add( page, "F7", "an outlet in the head opens for 2 s",
                 "the path turns back within 0.1 m, and ends lower", reverses,
                 "highest %.2f, %.2f, %.2f m, at the end %.2f, %.2f, %.2f m", runs[0].highest, runs[1].highest,
                 runs[2].highest, runs[0].end, runs[1].end, runs[2].end );
    figures_add( page, "F7", "the same, fall and spin", "both grow with the fill, by a tenth at least", grows,
                 "%.2f, %.2f, %.2f m/s downwards; %.1f, %.1f, %.1f rad/s", runs[0].fall, runs[1].fall, runs[2].fall,
                 runs[0].spin, runs[1].spin, runs[2].spin );
    figures_add( page, "F7", "the same, skin", "never more strained than full, below 0.15 when empty", bounded,
                 "strain %.2f, %.2f, %.2f full, %.2f, %.2f, %.2f at most, %.3f, %.3f, %.3f empty", runs[0].strain,
                 runs[1].strain, runs[2].strain, runs[0].strain_max, runs[1].strain_max, runs[2].strain_max,
                 runs[0].left, runs[1].left, runs[2].left );
}

wisp_status figures_rise_and_reverse( figures_case* page, wisp_error* error )
{
    static const float fills[RISE_FILLS] = { 1.4f, 1.7f, 2.0f };
    rise_run runs[RISE_FILLS] = { { 0 } };
    figures_album album = { .mesh = &page->figure, .shots_per_picture = 3 };
    figures_tracks tracks[RISE_FILLS];
    wisp_status status = flight_tracks_make( RISE_FILLS, RISE_STEPS + RELEASE_STEPS, 0.004f, tracks, error );
    for ( int i = 0; i < RISE_FILLS && status == WISP_OK; ++i )
    {
        status = rise( page, fills[i], &album, &tracks[i], &runs[i], error );
    }
    if ( status == WISP_OK )
    {
        add_rise_rows( page, runs );
        status = figures_write( page, &album, tracks, "f7_release",
                                "F7, tracks of four vertices: 1 s up, then 2 s with an open outlet", error );
    }
    figures_album_free( &album );
    free( tracks[0].points );
    return status;
}
