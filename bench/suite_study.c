// Suites: those of a case, what is sampled of their rows, and a suite as a scene of the driver of `accuracy`.
#include "suite_study.h"

#include "accuracy/accuracy.h"
#include "accuracy/scene_tools.h"
#include "program_data.h"
#include "suite_motion.h"
#include "surfaces.h"

#include "oracle/balloon_oracle.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- suites of a case ----

static int is_suite( const struct dirent* entry )
{
    const char* dot = strrchr( entry->d_name, '.' );
    return dot && strcmp( dot, ".yaml" ) == 0;
}

wisp_status suite_bench_names( const char* folder, const char* const* names, int count, double seconds,
                               const bench_options* options, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    bench_options each = *options;
    each.seconds = seconds / count;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        char inner[128], path[1024];
        snprintf( inner, sizeof inner, "suites/%s/%s.yaml", folder, names[i] );
        program_data_path( inner, path, sizeof path );
        status = suite_bench( path, &each, out, error );
    }
    return status;
}

wisp_status suite_bench_folder( const char* folder, double seconds, const bench_options* options, results* out,
                                wisp_error* error )
{
    char inner[128], path[1024], file[1300];
    struct dirent** entries = NULL;
    snprintf( inner, sizeof inner, "suites/%s", folder );
    program_data_path( inner, path, sizeof path );
    const int count = scandir( path, &entries, is_suite, alphasort );
    wisp_status status = count > 0 ? WISP_OK
                                   : wisp_fail( error, WISP_IO_ERROR, "%s: no suites are there: %s", path,
                                                count < 0 ? strerror( errno ) : "the folder has none" );
    for ( int i = 0; i < count; ++i )
    {
        bench_options each = *options;
        each.seconds = seconds / count;
        snprintf( file, sizeof file, "%s/%s", path, entries[i]->d_name );
        status = status == WISP_OK ? suite_bench( file, &each, out, error ) : status;
        free( entries[i] );
    }
    free( entries );
    return status;
}

// ---- samples ----

// What the tables of a suite have beside times and errors, gathered from a sampled run.

// Values of a row. The first ones are in the table of settings, those from SAMPLE_CONTACT_FIRST on in a table of contact.
typedef enum suite_sample
{
    SAMPLE_STRETCH_MAX,
    SAMPLE_STRETCH_MEAN,
    SAMPLE_ENERGY,
    SAMPLE_ENERGY_RISEN,
    SAMPLE_ENERGY_LOST,
    SAMPLE_SPEED,
    SAMPLE_PENETRATION,
    SAMPLE_RESETS,
    SAMPLE_ERROR_FIRST, // at suite_moments, one after another
    SAMPLE_ERROR_LAST = SAMPLE_ERROR_FIRST + SUITE_MOMENT_COUNT - 1,
    SAMPLE_LARGEST_DISTANCE,
    SAMPLE_DETAIL,
    SAMPLE_ENERGY_COMPARED,
    SAMPLE_LATE_HEIGHT,
    SAMPLE_LATE_ENERGY,
    SAMPLE_LATE_STRETCH,
    SAMPLE_LATE_DETAIL,
    SAMPLE_ITERATIONS,
    SAMPLE_FIRST_ORDER,
    SAMPLE_NOT_CONVERGED,
    SAMPLE_VOLUME_ERROR,
    SAMPLE_PRESSURE,
    SAMPLE_EVEN_PRESSURE,
    SAMPLE_INTERSECTIONS,
    SAMPLE_INTERSECTIONS_DRIVEN,
    SAMPLE_MEMORY,
    SAMPLE_CANDIDATES,
    SAMPLE_CONTACT_FIRST = SAMPLE_CANDIDATES,
    SAMPLE_CONTACTS,
    SAMPLE_SEARCHES,
    SAMPLE_INTERSECTIONS_MAX,
    SAMPLE_INTERSECTED_STEPS,
    SAMPLE_MIN_GAP,
    SAMPLE_LIMITED,
    SAMPLE_IMPULSE,
    SAMPLE_NET_IMPULSE,
    SAMPLE_FORCE,
    SAMPLE_OVERLAP,
    SAMPLE_OVERLAP_MAX,
    SAMPLE_MISSED,
    SAMPLE_WALL_RADIUS,
    SAMPLE_WALL_UNEVENNESS,
    SAMPLE_COUNT,
} suite_sample;

extern const char* const suite_sample_names[SAMPLE_COUNT];

typedef struct suite_sampler
{
    int last_step; // of the run
    bool has_contact, has_overlap;
    double stretch_max, stretch_mean; // the largest, and the mean of steps
    double energy_first, energy;      // J, after the first and the last step
    double energy_most;               // J, after any step
    double potential_first, potential;
    double speed; // m/s, of the fastest vertex after the last step
    double candidates, contacts, searches, limited, impulse, net_impulse, force, min_gap;
    int intersections_max, intersected_steps, contact_steps;
    int intersections_driven; // after the last step
    suite_overlap overlap;
    double overlap_max, missed_max;               // m, fraction
    double iterations;                            // of conjugate gradients
    double first_order;                           // substeps
    double volume_error, pressure, even_pressure; // of the first balloon: fraction, Pa, Pa
    int steps;
} suite_sampler;

enum
{
    OVERLAP_EVERY = 10, // steps: to find overlap takes as long as some steps
};

const char* const suite_sample_names[SAMPLE_COUNT] = {
    [SAMPLE_STRETCH_MAX] = "stretch max, %",
    [SAMPLE_STRETCH_MEAN] = "stretch mean, %",
    [SAMPLE_ENERGY] = "energy gained, mJ",
    [SAMPLE_ENERGY_RISEN] = "energy risen, mJ",
    [SAMPLE_ENERGY_LOST] = "energy lost, % of released",
    [SAMPLE_SPEED] = "speed, m/s",
    [SAMPLE_PENETRATION] = "penetration, mm",
    [SAMPLE_RESETS] = "strand resets",
    [SAMPLE_ERROR_FIRST] = "error at 0.5 s, mm",
    [SAMPLE_ERROR_FIRST + 1] = "error at 1 s, mm",
    [SAMPLE_ERROR_LAST] = "error at 2 s, mm",
    [SAMPLE_LARGEST_DISTANCE] = "largest distance, mm",
    [SAMPLE_DETAIL] = "detail",
    [SAMPLE_ENERGY_COMPARED] = "energy against the reference, % of released",
    [SAMPLE_LATE_HEIGHT] = "late height, mm",
    [SAMPLE_LATE_ENERGY] = "late energy, % of released",
    [SAMPLE_LATE_STRETCH] = "late stretch, %",
    [SAMPLE_LATE_DETAIL] = "late detail",
    [SAMPLE_ITERATIONS] = "linear iterations",
    [SAMPLE_FIRST_ORDER] = "left to euler",
    [SAMPLE_NOT_CONVERGED] = "not converged",
    [SAMPLE_VOLUME_ERROR] = "volume error, %",
    [SAMPLE_PRESSURE] = "pressure, Pa",
    [SAMPLE_EVEN_PRESSURE] = "pressure if scaled evenly, Pa",
    [SAMPLE_INTERSECTIONS] = "intersections",
    [SAMPLE_INTERSECTIONS_DRIVEN] = "intersections with driven surfaces",
    [SAMPLE_MEMORY] = "memory, KiB",
    [SAMPLE_CANDIDATES] = "pairs",
    [SAMPLE_CONTACTS] = "contacts",
    [SAMPLE_SEARCHES] = "searches",
    [SAMPLE_INTERSECTIONS_MAX] = "max intersections",
    [SAMPLE_INTERSECTED_STEPS] = "steps with intersections",
    [SAMPLE_MIN_GAP] = "min gap / thickness",
    [SAMPLE_LIMITED] = "limited displacements",
    [SAMPLE_IMPULSE] = "impulse, N s",
    [SAMPLE_NET_IMPULSE] = "net impulse, N s",
    [SAMPLE_FORCE] = "largest force, N",
    [SAMPLE_OVERLAP] = "overlap at the end, mm",
    [SAMPLE_OVERLAP_MAX] = "max overlap, mm",
    [SAMPLE_MISSED] = "missed vertices, %",
    [SAMPLE_WALL_RADIUS] = "wall radius, mm",
    [SAMPLE_WALL_UNEVENNESS] = "wall unevenness, mm",
};

// Mark the samples that a scene can have.
static void suite_samples_of( const wisp_scene* scene, bool has[SAMPLE_COUNT] )
{
    int balloons = 0;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        has[SAMPLE_STRETCH_MAX] = true;
        has[SAMPLE_PENETRATION] = has[SAMPLE_PENETRATION] || scene->surfaces[i].has_collision;
        has[SAMPLE_INTERSECTIONS] = has[SAMPLE_INTERSECTIONS] || scene->surfaces[i].has_contact;
        has[SAMPLE_ITERATIONS] = has[SAMPLE_ITERATIONS] || scene->surfaces[i].has_implicit;
        balloons += scene->surfaces[i].has_balloon ? 1 : 0;
    }
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        has[SAMPLE_STRETCH_MAX] = has[SAMPLE_STRETCH_MAX] || scene->strands[i].has_dynamics;
        has[SAMPLE_PENETRATION] = has[SAMPLE_PENETRATION] || scene->strands[i].has_collision;
        has[SAMPLE_RESETS] = has[SAMPLE_RESETS] || scene->strands[i].has_dynamics;
        has[SAMPLE_FIRST_ORDER] =
            has[SAMPLE_FIRST_ORDER] || scene->strands[i].dynamics.integrator == WISP_INTEGRATOR_BDF2;
        has[SAMPLE_CANDIDATES] = has[SAMPLE_CANDIDATES] || scene->strands[i].has_contact;
    }
    has[SAMPLE_STRETCH_MEAN] = has[SAMPLE_ENERGY] = has[SAMPLE_ENERGY_RISEN] = has[SAMPLE_ENERGY_LOST] =
        has[SAMPLE_SPEED] = has[SAMPLE_STRETCH_MAX];
    has[SAMPLE_VOLUME_ERROR] = has[SAMPLE_PRESSURE] = has[SAMPLE_EVEN_PRESSURE] =
        has[SAMPLE_VOLUME_ERROR] || balloons > 0;
    has[SAMPLE_NOT_CONVERGED] = has[SAMPLE_ITERATIONS];
    has[SAMPLE_FIRST_ORDER] = has[SAMPLE_FIRST_ORDER] || has[SAMPLE_ITERATIONS];
    for ( int i = 0; i < scene->surface_count && has[SAMPLE_INTERSECTIONS]; ++i )
    {
        has[SAMPLE_INTERSECTIONS_DRIVEN] =
            has[SAMPLE_INTERSECTIONS_DRIVEN] || wisp_scene_is_driven( &scene->surfaces[i] );
    }
    has[SAMPLE_MEMORY] = true;
    has[SAMPLE_CANDIDATES] = has[SAMPLE_CANDIDATES] || has[SAMPLE_INTERSECTIONS];
    for ( int i = SAMPLE_CANDIDATES; i <= SAMPLE_FORCE; ++i )
    {
        has[i] = has[SAMPLE_CANDIDATES];
    }
    has[SAMPLE_OVERLAP] = has[SAMPLE_OVERLAP_MAX] = has[SAMPLE_MISSED] = has[SAMPLE_OVERLAP] || balloons > 1;
    has[SAMPLE_WALL_RADIUS] = has[SAMPLE_WALL_UNEVENNESS] = has[SAMPLE_WALL_RADIUS] || balloons == 2;
}

static void sample_motion( suite_sampler* s, const scene_world* world )
{
    double energy = 0.0, potential = 0.0, stretch = 0.0;
    s->speed = 0.0;
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        wisp_motion_stats m;
        if ( suite_motion_stats( world, body, &m ) )
        {
            energy += m.kinetic_energy + m.potential_energy;
            potential += m.potential_energy;
            stretch = fmax( stretch, m.strain_mean );
            s->stretch_max = fmax( s->stretch_max, m.strain_max );
            s->speed = fmax( s->speed, m.speed_max );
        }
    }
    s->energy = energy;
    s->potential = potential;
    s->energy_most = s->steps == 0 ? energy : fmax( s->energy_most, energy );
    s->energy_first = s->steps == 0 ? energy : s->energy_first;
    s->potential_first = s->steps == 0 ? potential : s->potential_first;
    s->stretch_mean += ( stretch - s->stretch_mean ) / ++s->steps;
}

// Solves of implicit cloth, and gas, from the first step on.
static void request_effects( const scene_world* world )
{
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        if ( world->scene->surfaces[i].has_implicit )
        {
            (void)wisp_request_implicit_cloth_stats( world->world, world->surfaces[i].entity, true );
        }
        if ( world->scene->surfaces[i].has_balloon )
        {
            (void)wisp_request_balloon_stats( world->world, world->surfaces[i].entity, true );
        }
    }
}

// Of the first balloon. A mesh whose links all have the same strain has a pressure in closed form, which a sphere comes near.
static void sample_gas( suite_sampler* s, const scene_world* world )
{
    wisp_balloon_stats stats;
    int i = 0;
    while ( i < world->scene->surface_count && !world->scene->surfaces[i].has_balloon )
    {
        ++i;
    }
    if ( i < world->scene->surface_count &&
         wisp_read_balloon_stats( world->world, world->surfaces[i].entity, &stats ) == WISP_OK )
    {
        const double stiffness =
            balloon_stiffness_sum( world->surfaces[i].fabric, &world->scene->surfaces[i].balloon );
        s->volume_error = stats.volume / stats.target_volume - 1.0;
        s->pressure = stats.pressure;
        s->even_pressure = balloon_oracle_true_scaled_pressure( stiffness, stats.rest_volume,
                                                                cbrt( stats.volume / stats.rest_volume ) );
    }
}

static void sample_solves( suite_sampler* s, const scene_world* world )
{
    wisp_implicit_cloth_stats stats;
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        if ( world->scene->surfaces[i].has_implicit &&
             wisp_read_implicit_cloth_stats( world->world, world->surfaces[i].entity, &stats ) == WISP_OK )
        {
            s->iterations += stats.iterations;
        }
    }
    s->first_order = (double)wisp_world_counter( world->world, WISP_COUNT_FIRST_ORDER );
}

static double largest_impulse( const scene_world* world )
{
    double most = 0.0, impulse[3];
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        if ( wisp_read_contact_impulse( world->world, world->surfaces[i].entity, impulse ) == WISP_OK )
        {
            most = fmax( most, sqrt( impulse[0] * impulse[0] + impulse[1] * impulse[1] + impulse[2] * impulse[2] ) );
        }
    }
    return most;
}

// Edges of what is simulated through triangles of what an animation moves, and the other way round.
static int count_driven_intersections( const scene_world* world )
{
    const wisp_scene* scene = world->scene;
    int sum = 0;
    for ( int a = 0; a < scene->surface_count; ++a )
    {
        for ( int b = 0; b < scene->surface_count && wisp_scene_is_driven( &scene->surfaces[a] ); ++b )
        {
            int count = 0;
            const bool is_pair = !wisp_scene_is_driven( &scene->surfaces[b] );
            const wisp_entity one = world->surfaces[a].entity, other = world->surfaces[b].entity;
            sum +=
                is_pair && wisp_read_contact_intersections( world->world, one, other, &count ) == WISP_OK ? count : 0;
        }
    }
    return sum;
}

static void sample_contact( suite_sampler* s, const scene_world* world )
{
    wisp_contact_stats c;
    if ( wisp_read_contact_stats( world->world, &c ) != WISP_OK )
    {
        return;
    }
    s->min_gap = s->contact_steps == 0 ? INFINITY : s->min_gap;
    s->candidates += (double)c.candidates;
    s->contacts += c.contacts;
    s->searches += c.searches;
    s->limited += c.displacement_limited;
    s->intersections_max = c.intersections > s->intersections_max ? c.intersections : s->intersections_max;
    s->intersected_steps += c.intersections > 0 ? 1 : 0;
    s->min_gap = fmin( s->min_gap, (double)c.min_gap );
    s->impulse = c.impulse;
    s->force = largest_impulse( world ) / (double)wisp_scene_step_length( world->scene, world->next_step - 1 );
    for ( int k = 0; k < 3; ++k )
    {
        s->net_impulse = fmax( s->net_impulse, fabs( c.net_impulse[k] ) );
    }
    s->intersections_driven = world->next_step == s->last_step ? count_driven_intersections( world ) : 0;
    ++s->contact_steps;
}

// Tell it of a run's start and steps. @param user the sampler
static wisp_status suite_sampler_observe( void* user, const scene_world* world, wisp_error* error )
{
    suite_sampler* s = user;
    const int step = world->next_step;
    if ( step == 0 )
    {
        request_effects( world );
        return WISP_OK;
    }
    sample_motion( s, world );
    sample_solves( s, world );
    if ( s->has_contact )
    {
        sample_contact( s, world );
    }
    if ( step == s->last_step )
    {
        sample_gas( s, world );
    }
    if ( s->has_overlap == false || ( step % OVERLAP_EVERY != 0 && step != s->last_step ) )
    {
        return WISP_OK;
    }
    const wisp_status status = suite_overlap_find( world, &s->overlap, error );
    s->overlap_max = fmax( s->overlap_max, s->overlap.depth );
    s->missed_max = fmax( s->missed_max, s->overlap.missed );
    return status;
}

// The samples of a comparison with a reference, in their units. @param out [SAMPLE_COUNT] others stay as they are
static void suite_sampler_comparison( const suite_comparison* compared, double* out )
{
    for ( int i = 0; i < SUITE_MOMENT_COUNT; ++i )
    {
        out[SAMPLE_ERROR_FIRST + i] = 1e3 * compared->at[i];
    }
    out[SAMPLE_LARGEST_DISTANCE] = 1e3 * compared->largest;
    out[SAMPLE_DETAIL] = compared->detail;
    out[SAMPLE_ENERGY_COMPARED] = 100.0 * compared->energy;
    out[SAMPLE_LATE_HEIGHT] = 1e3 * compared->late_height;
    out[SAMPLE_LATE_ENERGY] = 100.0 * compared->late_energy;
    out[SAMPLE_LATE_STRETCH] = 100.0 * compared->late_stretch;
    out[SAMPLE_LATE_DETAIL] = compared->late_detail;
}

// @param out [SAMPLE_COUNT] NaN: the run does not have it
static void suite_sampler_values( const suite_sampler* s, const suite_measurement* measured, double* out )
{
    const bool meets = s->contact_steps > 0 && s->candidates > 0.0;
    const double released = s->potential_first - s->potential, risen = s->energy_most - s->energy_first;
    const double per_step = meets ? 1.0 / s->contact_steps : NAN;
    const double all[SAMPLE_COUNT] = {
        [SAMPLE_STRETCH_MAX] = 100.0 * s->stretch_max,
        [SAMPLE_STRETCH_MEAN] = 100.0 * s->stretch_mean,
        [SAMPLE_ENERGY] = 1e3 * ( s->energy - s->energy_first ),
        [SAMPLE_ENERGY_RISEN] = 1e3 * risen,
        [SAMPLE_ENERGY_LOST] = released > risen ? 100.0 * ( s->energy_first - s->energy ) / released : NAN,
        [SAMPLE_SPEED] = s->speed,
        [SAMPLE_PENETRATION] = 1e3 * measured->values[SUITE_PENETRATION],
        [SAMPLE_RESETS] = measured->values[SUITE_RESETS],
        [SAMPLE_ITERATIONS] = s->iterations,
        [SAMPLE_FIRST_ORDER] = s->first_order,
        [SAMPLE_NOT_CONVERGED] = measured->values[SUITE_NOT_CONVERGED],
        [SAMPLE_VOLUME_ERROR] = 100.0 * s->volume_error,
        [SAMPLE_PRESSURE] = s->pressure,
        [SAMPLE_EVEN_PRESSURE] = s->even_pressure,
        [SAMPLE_INTERSECTIONS] = measured->values[SUITE_INTERSECTIONS],
        [SAMPLE_INTERSECTIONS_DRIVEN] = s->contact_steps > 0 ? (double)s->intersections_driven : NAN,
        [SAMPLE_MEMORY] = measured->values[SUITE_BYTES] / 1024.0,
        [SAMPLE_CANDIDATES] = s->candidates * per_step,
        [SAMPLE_CONTACTS] = s->contacts * per_step,
        [SAMPLE_SEARCHES] = s->searches * per_step,
        [SAMPLE_INTERSECTIONS_MAX] = s->contact_steps > 0 ? (double)s->intersections_max : NAN,
        [SAMPLE_INTERSECTED_STEPS] = s->contact_steps > 0 ? (double)s->intersected_steps : NAN,
        [SAMPLE_MIN_GAP] = meets ? s->min_gap : NAN,
        [SAMPLE_LIMITED] = s->limited,
        [SAMPLE_IMPULSE] = s->impulse,
        [SAMPLE_NET_IMPULSE] = s->net_impulse,
        [SAMPLE_FORCE] = s->force,
        [SAMPLE_OVERLAP] = 1e3 * s->overlap.depth,
        [SAMPLE_OVERLAP_MAX] = 1e3 * s->overlap_max,
        [SAMPLE_MISSED] = 100.0 * s->missed_max,
        [SAMPLE_WALL_RADIUS] = meets ? 1e3 * s->overlap.wall_radius : NAN,
        [SAMPLE_WALL_UNEVENNESS] = meets ? 1e3 * s->overlap.wall_unevenness : NAN,
    };
    for ( int i = 0; i < SAMPLE_COUNT; ++i )
    {
        out[i] = all[i];
    }
    suite_sampler_comparison( &measured->compared, out );
}

// ---- a scene of accuracy ----

typedef struct study
{
    const wisp_suite* suite;
    suite_references references;
    double ( *doubts )[ACCURACY_MEASURES_MAX]; // [references.count] of the measures of the scene
    double* dt;                                // [rows] s
    int* steps;                                // [rows] that are made
    double longest_dt;
    bool measures[SAMPLE_COUNT]; // a suite has those columns that one of its scenes can have
    char note[480];
    bool is_quick; // rows that are left out need no reference
} study;

// ---- a sampled run ----

static void keep_measures( const study* own, const suite_sampler* s, const suite_measurement* measured,
                           accuracy_run* out )
{
    double all[SAMPLE_COUNT];
    int count = 0;
    suite_sampler_values( s, measured, all );
    for ( int m = 0; m < SAMPLE_COUNT; ++m )
    {
        if ( own->measures[m] )
        {
            out->measures[count++] = all[m];
        }
    }
    out->hash = measured->hash;
    out->halted_at = measured->values[SUITE_HALTED] > 0.0 ? measured->steps : 0;
}

static wisp_status observe_row( study* own, int row, accuracy_run* out, wisp_error* error )
{
    const suite_row* r = own->suite->rows + row;
    suite_sampler s = {
        .last_step = own->steps[row],
        .has_contact = own->measures[SAMPLE_CANDIDATES],
        .has_overlap = own->measures[SAMPLE_OVERLAP],
    };
    const suite_observer observer = { suite_sampler_observe, &s, s.has_contact };
    suite_measurement measured;
    const suite_reference* reference;
    wisp_status status = suite_reference_of( &own->references, row, &reference, error );
    status = status == WISP_OK ? suite_reference_run( reference, r, NULL, &observer, &measured, error ) : status;
    if ( status == WISP_OK )
    {
        keep_measures( own, &s, &measured, out );
        out->error = own->suite->compares_overlap && s.has_overlap ? 1e3 * s.overlap_max : out->error;
        out->error = reference->exists && out->halted_at == 0 ? 1e3 * measured.values[SUITE_ERROR] : out->error;
    }
    return status;
}

// ---- a timed run ----

static wisp_status observe_step( void* user, const scene_world* world, wisp_error* error )
{
    (void)error;
    accuracy_run* out = user;
    out->work = ( accuracy_work ){
        .strands = scene_world_strands( world ),
        .vertices = scene_world_vertices( world ),
        .substeps = world->scene->substeps,
        .bytes = (double)scene_world_bytes( world ),
    };
    out->halted_at = wisp_world_counter( world->world, WISP_COUNT_HALTED ) > 0 ? world->next_step : 0;
    return profile_samples_add( &out->profile, wisp_world_profile( world->world ) );
}

static wisp_status time_row( const study* own, int row, int workers, accuracy_run* out, wisp_error* error )
{
    const suite_observer observer = { .observe = observe_step, .user = out };
    const double scale = own->longest_dt / own->dt[row];
    double* ms = NULL;
    int steps = 0;
    wisp_status status =
        suite_time_row( own->suite->rows + row, workers, NULL, &observer, &ms, &steps, &out->hash, error );
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        status = accuracy_keep_ms( out, scale * ms[i] );
    }
    free( ms );
    return status;
}

static wisp_status run_row( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                            wisp_error* error )
{
    return is_observed ? observe_row( context, setting, out, error )
                       : time_row( context, setting, workers, out, error );
}

// ---- settings ----

static void destroy( void* context )
{
    study* own = context;
    suite_references_release( &own->references );
    free( own->doubts );
    free( own->dt );
    free( own->steps );
    free( own );
}

// Columns that the scene of a row can have.
static wisp_status look_at_row( study* own, int row, wisp_error* error )
{
    wisp_scene scene;
    const wisp_status status = suite_scene( own->suite->rows + row, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int round = scene.dt_factor_count > 0 ? scene.dt_factor_count : 1;
    own->dt[row] = wisp_scene_step_time( &scene, round ) / round;
    own->longest_dt = fmax( own->longest_dt, own->dt[row] );
    own->steps[row] = scene.steps;
    suite_samples_of( &scene, own->measures );
    wisp_scene_release( &scene );
    return WISP_OK;
}

// A number that grows with accuracy goes to 0 as its reciprocal.
static double parameter_of( const study* own, int row, char* name, size_t size )
{
    const suite_row* r = own->suite->rows + row;
    const char* dot = strrchr( r->along, '.' );
    const char* field = dot ? dot + 1 : r->along;
    if ( strcmp( r->along, "substeps" ) == 0 )
    {
        snprintf( name, size, "substep, s" );
        return own->dt[row] / r->along_value;
    }
    const bool grows = suite_error_grows( r->along );
    snprintf( name, size, grows ? "%s" : "1 / %s", field );
    return grows ? r->along_value : 1.0 / r->along_value;
}

// What all rows of one reference vary to: the parts of their variants that are the same.
static void name_group( const study* own, int row, char* out, size_t size )
{
    const suite_row* r = own->suite->rows + row;
    snprintf( out, size, "%s", r->name );
    for ( const char* part = r->variant; *part; )
    {
        const int length = (int)strcspn( part, "," );
        char text[SUITE_MAX_VARIANT];
        snprintf( text, sizeof text, "%.*s", length, part );
        bool is_common = true;
        for ( int i = 0; i < own->suite->row_count && is_common; ++i )
        {
            is_common = own->references.of_row[i] != own->references.of_row[row] ||
                        strcmp( own->suite->rows[i].name, r->name ) != 0 ||
                        strstr( own->suite->rows[i].variant, text );
        }
        const size_t used = strlen( out );
        snprintf( out + used, size - used, "%s%s", is_common ? ", " : "", is_common ? text : "" );
        part += length;
        part += strspn( part, ", " );
    }
}

static wisp_status add_setting( study* own, int row, accuracy_scene* out, wisp_error* error )
{
    const suite_row* r = own->suite->rows + row;
    const suite_reference* reference;
    char name[SUITE_MAX_NAME + 8];
    accuracy_setting* setting = accuracy_put_setting( out, "%s%s%s", r->name, r->variant[0] ? ", " : "", r->variant );
    if ( r->series[0] != '\0' )
    {
        const double parameter = parameter_of( own, row, name, sizeof name );
        accuracy_join_series( setting, r->series, name, parameter, r->order );
    }
    if ( own->is_quick && r->is_slow )
    {
        return WISP_OK;
    }
    const wisp_status status = suite_reference_of( &own->references, row, &reference, error );
    if ( status == WISP_OK && reference->exists )
    {
        setting->group = own->references.of_row[row];
        setting->doubt = 1e3 * fmax( reference->doubt.distance, 0.0 );
        setting->until = reference->until;
        setting->is_cut = suite_reference_parts( reference );
        setting->measure_doubts = own->doubts[setting->group];
        out->uncertainty = fmax( out->uncertainty, setting->doubt );
        if ( out->group_count > 1 )
        {
            name_group( own, row, setting->method, sizeof setting->method );
        }
    }
    return status;
}

// Samples of a comparison that a reference can have, and their doubts.
static void look_at_reference( study* own, const suite_reference* reference, double doubts[SAMPLE_COUNT] )
{
    for ( int m = 0; m < SAMPLE_COUNT; ++m )
    {
        doubts[m] = NAN;
    }
    if ( !reference->exists || reference->is_start )
    {
        return;
    }
    suite_sampler_comparison( &reference->doubt, doubts );
    own->measures[SAMPLE_LARGEST_DISTANCE] = true;
    for ( int m = SAMPLE_ERROR_FIRST; m <= SAMPLE_LATE_DETAIL; ++m )
    {
        own->measures[m] = own->measures[m] || isfinite( doubts[m] );
    }
    // these are near 1, and no errors that could be below a doubt
    doubts[SAMPLE_DETAIL] = doubts[SAMPLE_LATE_DETAIL] = NAN;
}

static void describe_suite( study* own, accuracy_scene* out )
{
    const bool is_compared = own->references.description[0] != '\0';
    bool is_uniform = true;
    for ( int i = 0; i < own->suite->row_count; ++i )
    {
        is_uniform = is_uniform && own->dt[i] == own->longest_dt;
    }
    if ( !is_uniform )
    {
        snprintf( out->ms_name, sizeof out->ms_name, "%.4g s of motion", own->longest_dt );
    }
    out->note = own->suite->note;
    out->has_no_rivals = !is_compared && !own->suite->compares_overlap;
    if ( own->suite->compares_overlap )
    {
        snprintf(
            out->reference, sizeof out->reference,
            "balloons keep their thickness from each other; by signed distances, which contact has no part in" );
        snprintf( out->error_name, sizeof out->error_name, "overlap at most" );
    }
    else if ( is_compared )
    {
        snprintf( out->reference, sizeof out->reference, "%s", own->references.description );
        snprintf( out->error_name, sizeof out->error_name, "%s",
                  own->suite->compares_start ? "RMS drift from the start" : "RMS distance to the reference" );
    }
    snprintf( out->error_unit, sizeof out->error_unit, "%s",
              is_compared || own->suite->compares_overlap ? "mm" : "" );
}

// Motion that parts is a note of its scene.
static void note_chaos( study* own, const suite_reference* reference, accuracy_scene* out )
{
    if ( isfinite( reference->parts_at ) && out->group_count > 0 )
    {
        snprintf( own->note, sizeof own->note,
                  "each scene is compared up to the time in `until`. After that two runs that should have converged "
                  "are more than 1 %% of their size apart, and distances are chance: `late` columns compare means" );
    }
    else if ( isfinite( reference->parts_at ) )
    {
        const bool is_cut = reference->until < reference->parts_at;
        snprintf( own->note, sizeof own->note,
                  is_cut ? "motion is compared up to %.3g s. After that two runs that should have converged are "
                           "more than 1 %% of their size apart, and distances are chance: `late` columns compare "
                           "means"
                         : "two runs that should have converged are more than 1 %% of their size apart from %.3g "
                           "s on: the reference is too coarse for errors to say much",
                  is_cut ? reference->until : reference->parts_at );
    }
    out->chaos = own->note[0] ? own->note : NULL;
}

// References of all rows, the columns that any of them can have, and their doubts.
static wisp_status make_references( study* own, accuracy_scene* out, wisp_error* error )
{
    double( *all )[SAMPLE_COUNT] = calloc( (size_t)own->references.count, sizeof *all );
    own->doubts = calloc( (size_t)own->references.count, sizeof *own->doubts );
    wisp_status status = all && own->doubts ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "no memory for a suite" );
    for ( int i = 0; i < own->suite->row_count && status == WISP_OK; ++i )
    {
        const int group = own->references.of_row[i];
        const suite_reference* reference;
        const bool is_new = !own->references.is_made[group],
                   is_left_out = own->is_quick && own->suite->rows[i].is_slow;
        status = is_left_out ? WISP_OK : suite_reference_of( &own->references, i, &reference, error );
        if ( status == WISP_OK && is_new && !is_left_out )
        {
            look_at_reference( own, reference, all[group] );
            note_chaos( own, reference, out );
            ++out->group_count;
        }
    }
    for ( int m = 0; m < SAMPLE_COUNT && status == WISP_OK; ++m )
    {
        for ( int g = 0; g < own->references.count && own->measures[m]; ++g )
        {
            own->doubts[g][out->measure_count] = isfinite( all[g][m] ) ? fabs( all[g][m] ) : 0.0;
            out->measure_doubts[out->measure_count] =
                fmax( out->measure_doubts[out->measure_count], own->doubts[g][out->measure_count] );
        }
        if ( own->measures[m] )
        {
            out->measure_names[out->measure_count++] = suite_sample_names[m];
            out->contact_measures += m >= SAMPLE_CONTACT_FIRST ? 1 : 0;
        }
    }
    free( all );
    return status;
}

static wisp_status fill( study* own, accuracy_scene* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < own->suite->row_count && status == WISP_OK; ++i )
    {
        status = look_at_row( own, i, error );
    }
    status = status == WISP_OK ? suite_references_find( own->suite, &own->references, error ) : status;
    describe_suite( own, out );
    status = status == WISP_OK ? make_references( own, out, error ) : status;
    for ( int i = 0; i < own->suite->row_count && status == WISP_OK; ++i )
    {
        status = add_setting( own, i, out, error );
    }
    return status;
}

wisp_status suite_study_make( const wisp_suite* suite, const bench_options* options, accuracy_scene* out,
                              wisp_error* error )
{
    study* own = calloc( 1, sizeof *own );
    *out = ( accuracy_scene ){ .context = own, .run = run_row, .destroy = destroy };
    if ( own == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a suite" );
    }
    own->suite = suite;
    own->is_quick = options->quick;
    own->dt = calloc( (size_t)suite->row_count, sizeof *own->dt );
    own->steps = calloc( (size_t)suite->row_count, sizeof *own->steps );
    wisp_status status = own->dt && own->steps ? accuracy_reserve_settings( out, suite->row_count, error )
                                               : wisp_fail( error, WISP_NO_MEMORY, "no memory for a suite" );
    status = status == WISP_OK ? fill( own, out, error ) : status;
    return status == WISP_OK ? WISP_OK : accuracy_abandon( out, status );
}
