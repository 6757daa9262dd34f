// Energy of constraints. A projection moves two ends together by their error in one substep, like a spring of
// stiffness 1 / (wi + wj) h^2 in series with the compliance of the link. So a violated constraint stores C^2 / 2 over
// compliance + (wi + wj) h^2, for inextensible links too, and no more than that can become motion.
#include "stability_surface.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- entering ----

wisp_status stability_hanging_mesh( int side, float spacing, wisp_mesh* out, wisp_error* error )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PLANE_ALTERNATING );
    generator.columns = side;
    generator.rows = side;
    generator.spacing = spacing;
    wisp_status status = wisp_mesh_generate( &generator, out, error );
    const float top = status == WISP_OK ? out->points[0].z : 0.0f;
    for ( int i = 0; i < out->vertex_count; ++i )
    {
        out->points[i] = ( wisp_vec3 ){ out->points[i].x, top - out->points[i].z, 0.0f };
    }
    return status;
}

static bool is_pin( const surface_generator* generator, int vertex )
{
    bool found = false;
    for ( int i = 0; i < generator->pin_count; ++i )
    {
        found = found || generator->pins[i] == vertex;
    }
    return found;
}

// Pins keep their positions. An inverted body is reflected in the middle of its two points of suspension.
static void place( stability_surface* s, const surface_generator* generator, stability_start start )
{
    const stability_box box = stability_box_of( s->mesh.points, s->mesh.vertex_count );
    double origin[3] = { box.middle[0], generator->pin_count == 2 ? box.upper[1] : box.middle[1], box.middle[2] };
    stability_place( start, &box, origin, s->mesh.points, s->mesh.vertex_count, s->start );
    for ( int i = 0; i < s->mesh.vertex_count; ++i )
    {
        const wisp_vec3 p = is_pin( generator, i ) ? s->mesh.points[i] : s->start[i];
        s->start[i] = ( wisp_vec3 ){ p.x + s->at.x, p.y + s->at.y, p.z + s->at.z };
    }
    memcpy( s->seen, s->start, (size_t)s->mesh.vertex_count * sizeof( wisp_vec3 ) );
    s->size = box.size;
}

wisp_status stability_surface_enter( stability_surface* s, const wisp_fabric_def* def, surface_generator generator,
                                     const stability_axes* axes, wisp_error* error )
{
    const size_t bytes = (size_t)s->mesh.vertex_count * sizeof( wisp_vec3 );
    s->start = malloc( bytes );
    s->seen = malloc( bytes );
    if ( s->start == NULL || s->seen == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the start of a surface" );
    }
    place( s, &generator, axes->start );
    wisp_status status = surface_cook( &s->mesh, *def, &s->fabric, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    generator.fabric = s->fabric;
    generator.points = s->start;
    generator.seconds = axes->seconds;
    return surface_implementation_create( &generator, &s->implementation, error );
}

void stability_surface_close( void* context )
{
    stability_surface* s = context;
    if ( s->implementation.world != NULL )
    {
        surface_implementation_destroy( &s->implementation );
    }
    wisp_fabric_release( s->fabric );
    wisp_mesh_release( &s->mesh );
    free( s->start );
    free( s->seen );
    free( s );
}

// ---- masses ----

static float* positions( stability_surface* s )
{
    return wisp_world_column( s->implementation.world, s->implementation.entity, WISP_PARTICLE_POSITION, 0 );
}

void stability_surface_weigh( stability_surface* s, float ratio )
{
    const stability_box box = stability_box_of( s->mesh.points, s->mesh.vertex_count );
    float* x = positions( s );
    for ( int i = 0; i < s->mesh.vertex_count && ratio != 1.0f; ++i )
    {
        const double depth =
            ( box.upper[1] - (double)s->mesh.points[i].y ) / fmax( box.upper[1] - box.lower[1], 1e-30 );
        x[4 * (size_t)s->fabric->vertex_slot[i] + 3] *= (float)pow( (double)ratio, -depth );
    }
}

double stability_surface_weight( stability_surface* s )
{
    const float* x = positions( s );
    double mass = 0.0;
    for ( int i = 0; i < s->fabric->vertex_count; ++i )
    {
        mass += x[4 * i + 3] > 0.0f ? 1.0 / (double)x[4 * i + 3] : 0.0;
    }
    return mass * (double)STABILITY_GRAVITY;
}

// ---- energy ----

static double length_of( const float* a, const float* b )
{
    const double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1], z = (double)a[2] - (double)b[2];
    return sqrt( x * x + y * y + z * z );
}

static double substep_of( const stability_surface* s )
{
    return (double)s->implementation.generator.seconds / s->implementation.generator.substeps;
}

// @param softness 1/k, m/N, in series with the compliance of a substep
// @param min_length m, below which a link stores no more: a bend link gives way to its hinge in a sharp fold
static double link_energy( const float* a, const float* b, double rest, double min_length, double softness, double h,
                           bool only_pulls )
{
    const double error = fmax( length_of( a, b ), min_length ) - rest;
    const double whole = softness + ( (double)a[3] + (double)b[3] ) * h * h;
    return whole > 0.0 && ( error > 0.0 || only_pulls == false ) ? 0.5 * error * error / whole : 0.0;
}

static double energy_of_links( stability_surface* s, const float* x )
{
    wisp_world* world = s->implementation.world;
    const wisp_entity e = s->implementation.entity;
    const wisp_schedule* order = &s->fabric->link_order;
    const float* compliance = wisp_world_column( world, e, WISP_LINK_COMPLIANCE, 0 );
    const float* fraction = wisp_world_column( world, e, WISP_LINK_STIFFNESS, 0 );
    const bool folds = wisp_world_has( world, e, WISP_LINK_FOLDS );
    const double h = substep_of( s );
    double sum = 0.0;
    for ( int i = 0; i < order->slot_count && ( compliance != NULL || fraction != NULL ); ++i )
    {
        const float *a = x + s->fabric->link_a_x4[i], *b = x + s->fabric->link_b_x4[i];
        const double weight = ( (double)a[3] + (double)b[3] ) * h * h;
        // a fraction k of the error per substep corresponds to the compliance that leaves 1 - k of it
        const double soft =
            compliance != NULL ? (double)compliance[i] : weight * ( 1.0 / fmax( (double)fraction[i], 1e-6 ) - 1.0 );
        const double rest = (double)s->fabric->link_rest[i];
        const double min_length = folds && order->constraint[i] >= s->fabric->edge_count ? 0.5 * rest : 0.0;
        sum += order->constraint[i] >= 0 ? link_energy( a, b, rest, min_length, soft, h, false ) : 0.0;
    }
    return sum;
}

// Tethers and coarse links are inextensible and only pull.
static double energy_of_far_links( stability_surface* s, const float* x )
{
    const double h = substep_of( s );
    const wisp_fabric* f = s->fabric;
    const bool tethers = wisp_world_has( s->implementation.world, s->implementation.entity, WISP_SURFACE_TETHERS );
    const bool levels = wisp_world_has( s->implementation.world, s->implementation.entity, WISP_SURFACE_LEVELS );
    double sum = 0.0;
    for ( int i = 0; i < ( tethers ? f->tether_count * f->slot_count : 0 ); ++i )
    {
        sum += link_energy( x + f->tether_x4[i], x + 4 * (size_t)( i % f->slot_count ), (double)f->tether_rest[i],
                            0.0, 0.0, h, true );
    }
    for ( int k = 0; k < ( levels ? f->level_count : 0 ); ++k )
    {
        const wisp_fabric_level* level = f->levels + k;
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            sum += level->schedule.constraint[i] >= 0 ? link_energy( x + level->a_x4[i], x + level->b_x4[i],
                                                                     (double)level->rest[i], 0.0, 0.0, h, true )
                                                      : 0.0;
        }
    }
    return sum;
}

static double stored_energy( stability_surface* s, int frame, const float* x )
{
    return energy_of_links( s, x ) + energy_of_far_links( s, x ) +
           ( s->stored != NULL ? s->stored( s, frame ) : 0.0 );
}

double stability_surface_energy_limit( stability_surface* s )
{
    const double h = substep_of( s ), fall = (double)STABILITY_GRAVITY * h * h;
    return stability_surface_weight( s ) * ( 0.01 * s->size + fall ) + 0.01 * stored_energy( s, 0, positions( s ) );
}

// ---- samples ----

wisp_status stability_surface_step( void* context, int frame, wisp_error* error )
{
    stability_surface* s = context;
    const wisp_status status = s->drive != NULL ? s->drive( s, frame ) : WISP_OK;
    return status == WISP_OK ? surface_implementation_step( &s->implementation, error )
                             : bench_world_fail( s->implementation.world, status, error );
}

// No link carries more than the weight on a pin, and the addition by motion: v^2 / size is the centripetal
// acceleration. A sweep removes the addition of a substep only where a link is stretched by (wi + wj) h^2 of its
// load, a linear solve anywhere. A cloth stretched straight between two pins carries far more than its weight: a
// cable of stiffness EA and weight W without sag stretches by (1/24)^(1/3) (W / EA)^(2/3). The uppermost row of a
// cloth carries at most all of it.
static double cable_strain( stability_surface* s, double rest )
{
    const bool is_cable = s->is_solved && s->implementation.generator.pin_count == 2;
    return is_cable ? cbrt( 1.0 / 24.0 ) * pow( stability_surface_weight( s ) * s->compliance / rest, 2.0 / 3.0 )
                    : 0.0;
}

static void observe_links( stability_surface* s, const float* x, double speed, stability_observation* observation )
{
    const wisp_fabric* f = s->fabric;
    const double h = substep_of( s );
    const double load = stability_surface_weight( s ) / fmax( s->implementation.generator.pin_count, 1.0 ) *
                        ( 1.0 + 2.0 * speed * speed / ( (double)STABILITY_GRAVITY * s->size ) );
    observation->strain_limit = 1e-4;
    for ( int i = 0; i < f->edge_count; ++i )
    {
        const int a = f->edges[2 * i], b = f->edges[2 * i + 1];
        const double rest = stability_distance( f->rest[a], f->rest[b] );
        const double strain = length_of( x + 4 * (size_t)a, x + 4 * (size_t)b ) / rest - 1.0;
        const double solve_order = s->is_solved ? 0.0 : ( (double)x[4 * a + 3] + (double)x[4 * b + 3] ) * h * h;
        const double soft = s->compliance + solve_order;
        const double worst = s->slack && strain < 0.0 ? 0.0 : fabs( strain );
        // what a linear solve leaves of a substep's fall, by its tolerance, which is of the norm over all vertices
        const double left = s->is_solved ? 1e-4 * sqrt( f->vertex_count ) * (double)STABILITY_GRAVITY * h * h : 0.0;
        observation->strain_limit = fmax( observation->strain_limit, s->taut + ( soft * load + left ) / rest );
        observation->strain_limit = fmax( observation->strain_limit, cable_strain( s, rest ) );
        observation->strain =
            worst <= observation->strain || isnan( observation->strain ) ? observation->strain : worst;
    }
}

static double kinetic_energy( stability_surface* s, const float* x, const float* v )
{
    double sum = 0.0;
    for ( int i = 0; i < s->fabric->vertex_count; ++i )
    {
        const double vx = (double)v[4 * i], vy = (double)v[4 * i + 1], vz = (double)v[4 * i + 2];
        const double mass = x[4 * i + 3] > 0.0f ? 1.0 / (double)x[4 * i + 3] : 0.0;
        sum += mass * ( 0.5 * ( vx * vx + vy * vy + vz * vz ) + (double)STABILITY_GRAVITY * (double)x[4 * i + 1] );
    }
    return sum;
}

static bool all_finite( const float* x, const float* v, int count )
{
    bool finite = true;
    for ( int i = 0; i < count; ++i )
    {
        finite = finite && ( i % 4 == 3 || ( isfinite( x[i] ) && isfinite( v[i] ) ) );
    }
    return finite;
}

wisp_status stability_surface_observe( void* context, int frame, stability_observation* out, wisp_error* error )
{
    stability_surface* s = context;
    const wisp_vec3* points = s->start;
    wisp_status status = frame > 0 ? surface_implementation_points( &s->implementation, &points, error ) : WISP_OK;
    if ( status != WISP_OK )
    {
        return status;
    }
    const float* x = positions( s );
    const float* v =
        wisp_world_column( s->implementation.world, s->implementation.entity, WISP_PARTICLE_VELOCITY, 0 );
    *out = ( stability_observation ){ .is_finite = all_finite( x, v, 4 * s->fabric->vertex_count ) };
    out->is_halted = wisp_is_halted( s->implementation.world, s->implementation.entity );
    out->speed =
        stability_farthest( points, s->seen, s->fabric->vertex_count ) / (double)s->implementation.generator.seconds;
    memcpy( s->seen, points, (size_t)s->fabric->vertex_count * sizeof( wisp_vec3 ) );
    observe_links( s, x, out->speed, out );
    out->energy = kinetic_energy( s, x, v ) + stored_energy( s, frame, x );
    out->breach = frame > 0 && s->breach != NULL ? s->breach( s ) : 0.0;
    return WISP_OK;
}

uint64_t stability_surface_hash( void* context )
{
    stability_surface* s = context;
    uint64_t hash = 0;
    wisp_error error = { 0 };
    return surface_implementation_hash( &s->implementation, &hash, &error ) == WISP_OK ? hash : 0;
}

stability_trial stability_surface_trial( stability_surface* s, const stability_axes* axes )
{
    const double step = (double)axes->seconds;
    stability_trial trial = {
        .limits =
            stability_usual_limits( s->size, (double)axes->scale, step, step / s->implementation.generator.substeps ),
        .frame_count = stability_frames( stability_duration( (double)axes->scale ), step ),
        .context = s,
        .step = stability_surface_step,
        .observe = stability_surface_observe,
        .hash = stability_surface_hash,
        .world = s->implementation.world,
        .close = stability_surface_close,
    };
    trial.limits.energy = stability_surface_energy_limit( s );
    stability_observation observation = { 0 };
    observe_links( s, positions( s ), 0.0, &observation );
    trial.limits.jitter = observation.strain_limit < STABILITY_SOFT ? trial.limits.jitter : INFINITY;
    return trial;
}
