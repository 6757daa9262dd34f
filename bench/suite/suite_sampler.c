#include "suite_sampler.h"

#include "balloon_readings.h"
#include "oracle/balloon_oracle.h"

#include <math.h>

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

void suite_samples_of( const wisp_scene* scene, bool has[SAMPLE_COUNT] )
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
        has[SAMPLE_INTERSECTIONS_DRIVEN] = has[SAMPLE_INTERSECTIONS_DRIVEN] || scene_is_driven( &scene->surfaces[i] );
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
        for ( int b = 0; b < scene->surface_count && scene_is_driven( &scene->surfaces[a] ); ++b )
        {
            int count = 0;
            const bool is_pair = !scene_is_driven( &scene->surfaces[b] );
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

wisp_status suite_sampler_observe( void* user, const scene_world* world, wisp_error* error )
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

void suite_sampler_comparison( const suite_comparison* compared, double* out )
{
    for ( int i = 0; i < SUITE_MOMENT_COUNT; ++i )
    {
        out[SAMPLE_ERROR_FIRST + i] = 1e3 * compared->at[i];
    }
    out[SAMPLE_LARGEST_DISTANCE] = 1e3 * compared->largest;
    out[SAMPLE_DETAIL] = compared->detail;
    out[SAMPLE_ENERGY_COMPARED] = 100.0 * compared->energy;
}

void suite_sampler_values( const suite_sampler* s, const suite_measurement* measured, double* out )
{
    const bool meets = s->contact_steps > 0 && s->candidates > 0.0;
    const double released = s->potential_first - s->potential;
    const double per_step = meets ? 1.0 / s->contact_steps : NAN;
    const double all[SAMPLE_COUNT] = {
        [SAMPLE_STRETCH_MAX] = 100.0 * s->stretch_max,
        [SAMPLE_STRETCH_MEAN] = 100.0 * s->stretch_mean,
        [SAMPLE_ENERGY] = 1e3 * ( s->energy - s->energy_first ),
        [SAMPLE_ENERGY_RISEN] = 1e3 * ( s->energy_most - s->energy_first ),
        [SAMPLE_ENERGY_LOST] = released > 0.0 ? 100.0 * ( s->energy_first - s->energy ) / released : NAN,
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
