// Strands as a body: positions, velocities and stored energy of vertices. Energies as for surfaces: a violated
// segment stores the energy that its projection can release.
#include "stability_strands.h"

#include "wisp/module/components.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LENGTH 0.1f   // m, of a strand
#define BETWEEN 0.01f // m, from root to root

// ---- entering ----

// Down from roots in two rows, straight or in two turns of a helix.
static void lay( stability_strands* s, float scale )
{
    for ( int i = 0; i < STABILITY_POINTS; ++i )
    {
        const int strand = i / STABILITY_VERTICES;
        const float t = (float)( i % STABILITY_VERTICES ) / ( STABILITY_VERTICES - 1 );
        const float radius = s->is_curl ? 0.1f * LENGTH : 0.0f, length = s->is_curl ? 0.6f * LENGTH : LENGTH;
        const float angle = 12.566f * t;
        s->rest[i] = ( wisp_vec3 ){ scale * ( BETWEEN * (float)( strand % 4 ) + radius * ( cosf( angle ) - 1.0f ) ),
                                    -scale * length * t,
                                    scale * ( BETWEEN * (float)( strand / 4 ) + radius * sinf( angle ) ) };
    }
}

// Strand 0 becomes a point; segments 4 and 5 of strand 1 lose their length.
static void collapse( stability_strands* s )
{
    wisp_vec3 *point = s->rest, *kinked = s->rest + STABILITY_VERTICES;
    for ( int i = 1; i < STABILITY_VERTICES; ++i )
    {
        point[i] = point[0];
    }
    kinked[5] = kinked[6] = kinked[4];
}

// Masses of strands of the same material, increasing to the tip.
static void weigh( stability_strands* s, const stability_axes* axes )
{
    const double segment = (double)LENGTH * (double)axes->scale / ( STABILITY_VERTICES - 1 );
    for ( int i = 0; i < STABILITY_POINTS; ++i )
    {
        const double depth = (double)( i % STABILITY_VERTICES ) / ( STABILITY_VERTICES - 1 );
        s->masses[i] = (float)( segment * (double)s->def.line_density * pow( (double)axes->mass_ratio, depth ) );
    }
}

static void place( stability_strands* s, stability_start start )
{
    const stability_box box = stability_box_of( s->rest, STABILITY_POINTS );
    const double origin[3] = { box.middle[0], box.upper[1], box.middle[2] };
    stability_place( start, &box, origin, s->rest, STABILITY_POINTS, s->start );
    for ( int i = 0; i < STABILITY_POINTS; i += STABILITY_VERTICES )
    {
        s->start[i] = s->rest[i];
    }
    memcpy( s->seen, s->start, sizeof( s->seen ) );
    s->size = box.size;
}

// Position of vertex i of the user in lanes: rows of x, y and z of sixteen strands.
static size_t in_lanes( const wisp_strand_topology* t, int vertex )
{
    const int strand = vertex / STABILITY_VERTICES;
    int lane = 0;
    while ( t->lane_strand[lane] != strand )
    {
        ++lane;
    }
    const int row = t->group_row[lane / WISP_LANES] + vertex % STABILITY_VERTICES;
    return (size_t)row * 3 * WISP_LANES + (size_t)( lane % WISP_LANES );
}

static void set_start( stability_strands* s )
{
    const wisp_strand_topology* t = wisp_world_strands( s->world, s->entity );
    float* x = wisp_world_column( s->world, s->entity, WISP_STRAND_POSITION, 0 );
    for ( int i = 0; i < STABILITY_POINTS; ++i )
    {
        float* to = x + in_lanes( t, i );
        to[0] = s->start[i].x;
        to[WISP_LANES] = s->start[i].y;
        to[2 * WISP_LANES] = s->start[i].z;
    }
}

static wisp_status add( stability_strands* s )
{
    int32_t offsets[STABILITY_STRANDS + 1];
    for ( int i = 0; i <= STABILITY_STRANDS; ++i )
    {
        offsets[i] = i * STABILITY_VERTICES;
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = s->rest;
    def.offsets = offsets;
    def.strand_count = STABILITY_STRANDS;
    wisp_status status = wisp_add_strands( s->world, &def, &s->entity );
    if ( status == WISP_OK )
    {
        s->def.vertex_masses = s->masses;
        status = wisp_set_strand_dynamics( s->world, s->entity, &s->def );
        s->def.vertex_masses = NULL;
    }
    return status == WISP_OK ? wisp_request( s->world, s->entity, WISP_STRAND_POINTS ) : status;
}

wisp_status stability_strands_enter( stability_strands* s, const wisp_module* const* modules, int module_count,
                                     const stability_axes* axes, int workers, wisp_error* error )
{
    wisp_world_def def = wisp_default_world_def();
    def.modules = modules;
    def.module_count = module_count;
    def.log = bench_world_drop_log;
    def.workers = workers;
    def.substeps = STABILITY_STRAND_SUBSTEPS;
    s->seconds = (double)axes->seconds;
    s->substep = s->seconds / STABILITY_STRAND_SUBSTEPS;
    lay( s, axes->scale );
    weigh( s, axes );
    if ( s->has_points )
    {
        collapse( s );
    }
    place( s, axes->start );
    wisp_status status = wisp_world_create( &def, &s->world, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = add( s );
    if ( status != WISP_OK )
    {
        return bench_world_fail( s->world, status, error );
    }
    set_start( s );
    return WISP_OK;
}

void stability_strands_close( void* context )
{
    stability_strands* s = context;
    wisp_world_destroy( s->world );
    free( s );
}

// ---- energy ----

typedef struct state
{
    wisp_vec3 x[STABILITY_POINTS], v[STABILITY_POINTS];
} state;

static wisp_vec3 read( const float* lanes )
{
    return ( wisp_vec3 ){ lanes[0], lanes[WISP_LANES], lanes[2 * WISP_LANES] };
}

static void read_state( stability_strands* s, state* out )
{
    const wisp_strand_topology* t = wisp_world_strands( s->world, s->entity );
    const float* x = wisp_world_column( s->world, s->entity, WISP_STRAND_POSITION, 0 );
    const float* v = wisp_world_column( s->world, s->entity, WISP_STRAND_VELOCITY, 0 );
    for ( int i = 0; i < STABILITY_POINTS; ++i )
    {
        out->x[i] = read( x + in_lanes( t, i ) );
        out->v[i] = read( v + in_lanes( t, i ) );
    }
}

static double weight_of( const stability_strands* s, int vertex )
{
    return vertex % STABILITY_VERTICES == 0 ? 0.0 : 1.0 / (double)s->masses[vertex];
}

// @param apart 1: the segments; 2: links over two of them
static double energy_of_links( const stability_strands* s, const state* now, int apart, double softness )
{
    double sum = 0.0;
    for ( int i = 0; i + apart < STABILITY_POINTS; ++i )
    {
        if ( i % STABILITY_VERTICES + apart < STABILITY_VERTICES )
        {
            const double error = stability_distance( now->x[i], now->x[i + apart] ) -
                                 stability_distance( s->rest[i], s->rest[i + apart] );
            const double h2 = s->substep * s->substep;
            sum += 0.5 * error * error / ( softness + ( weight_of( s, i ) + weight_of( s, i + apart ) ) * h2 );
        }
    }
    return sum;
}

static double turn_at( const wisp_vec3* x, const wisp_vec3* rest, int i )
{
    const double l = stability_distance( rest[i], rest[i - 1] ), m = stability_distance( rest[i + 1], rest[i] );
    const double d[3] = { (double)( x[i + 1].x - x[i].x ) / m - (double)( x[i].x - x[i - 1].x ) / l,
                          (double)( x[i + 1].y - x[i].y ) / m - (double)( x[i].y - x[i - 1].y ) / l,
                          (double)( x[i + 1].z - x[i].z ) / m - (double)( x[i].z - x[i - 1].z ) / l };
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

// Upper bound: EI / 2L |turn - rest turn|^2 is at most EI / L ( turn^2 + rest turn^2 ), with the largest EI of a
// substep. Energy stored in a rod later is not counted, so kinetic and potential energy must not exceed the initial
// total.
static double max_energy_of_rods( const stability_strands* s, const state* now )
{
    double sum = 0.0;
    for ( int i = 0; i + 1 < STABILITY_POINTS; ++i )
    {
        if ( i % STABILITY_VERTICES + 1 < STABILITY_VERTICES )
        {
            const double l = stability_distance( s->rest[i], s->rest[i + 1] );
            const double most = 6e4 * (double)s->masses[i] * l * l * l / ( s->substep * s->substep );
            const double rigidity = fmin( (double)s->def.bend_rigidity, most );
            // the clamp differs at most by the opposite direction, over half of the first segment
            sum += i % STABILITY_VERTICES == 0
                       ? rigidity / ( 0.5 * l ) * 0.5 * 4.0
                       : rigidity / l * ( turn_at( now->x, s->rest, i ) + turn_at( s->rest, s->rest, i ) );
        }
    }
    return sum;
}

static double stored_energy( const stability_strands* s, const state* now, int frame )
{
    const double h2 = s->substep * s->substep, w = 2.0 / (double)s->masses[STABILITY_VERTICES - 1];
    const bool is_pbd = s->def.solver == WISP_SOLVER_PBD;
    const double soft =
        is_pbd ? w * h2 * ( 1.0 / (double)s->def.bend_stiffness - 1.0 ) : (double)s->def.bend_compliance;
    double sum = energy_of_links( s, now, 1, s->compliance );
    sum += s->def.bending == WISP_STRAND_BEND_LINKS ? energy_of_links( s, now, 2, soft ) : 0.0;
    sum += s->def.bending == WISP_STRAND_BEND_ROD && frame == 0 ? max_energy_of_rods( s, now ) : 0.0;
    return sum;
}

static double mass_of( const stability_strands* s )
{
    double sum = 0.0;
    for ( int i = 0; i < STABILITY_POINTS; ++i )
    {
        sum += i % STABILITY_VERTICES > 0 ? (double)s->masses[i] : 0.0;
    }
    return sum;
}

// A follower that hangs at rest keeps a velocity of g h / (1 - share), which moves nothing: it is no motion.
double stability_strands_energy_limit( stability_strands* s )
{
    state now;
    read_state( s, &now );
    const double g = (double)STABILITY_GRAVITY, weight = mass_of( s ) * g;
    const double kept = g * s->substep / ( 1.0 - fmin( (double)s->def.leader_correction, 0.99 ) );
    const double follower = s->def.stretch == WISP_STRAND_STRETCH_FOLLOW ? 0.5 * mass_of( s ) * kept * kept : 0.0;
    return weight * ( 0.01 * s->size + g * s->substep * s->substep ) + 0.01 * stored_energy( s, &now, 0 ) + follower;
}

// ---- samples ----

wisp_status stability_strands_step( void* context, int frame, wisp_error* error )
{
    stability_strands* s = context;
    wisp_status status = s->drive != NULL ? s->drive( s, frame ) : WISP_OK;
    status = status == WISP_OK ? wisp_world_step( s->world, (float)s->seconds ) : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( s->world, status, error );
}

static double largest_of( wisp_vec3 p )
{
    return fmax( fabs( (double)p.x ), fmax( fabs( (double)p.y ), fabs( (double)p.z ) ) );
}

// A strand with the direct solve must have its lengths within the tolerance of a reset; a sweep of links leaves the
// load that a substep adds to the whole strand: its weight and the centripetal force.
static void observe_segments( const stability_strands* s, const state* now, stability_observation* observation )
{
    const double v = observation->speed, g = (double)STABILITY_GRAVITY;
    const double load = mass_of( s ) / STABILITY_STRANDS * ( g + 2.0 * v * v / s->size );
    const bool is_links = s->def.stretch == WISP_STRAND_STRETCH_LINKS;
    observation->strain_limit = is_links ? 1e-4 : s->def.stretch == WISP_STRAND_STRETCH_FOLLOW ? 1e-3 : 1e-2;
    for ( int i = 0; i + 1 < STABILITY_POINTS; ++i )
    {
        if ( i % STABILITY_VERTICES + 1 == STABILITY_VERTICES )
        {
            continue;
        }
        const double rest = stability_distance( s->rest[i], s->rest[i + 1] );
        const double strain = fabs( stability_distance( now->x[i], now->x[i + 1] ) / rest - 1.0 );
        const double sweep = ( weight_of( s, i ) + weight_of( s, i + 1 ) ) * s->substep * s->substep;
        const double rounding = 4.0 * (double)FLT_EPSILON * largest_of( now->x[i] ) / rest;
        const double allowed = is_links ? ( s->compliance + sweep ) * load / rest : 0.0;
        observation->strain_limit = fmax( observation->strain_limit, allowed + rounding );
        observation->strain =
            strain <= observation->strain || isnan( observation->strain ) ? observation->strain : strain;
    }
}

static double energy_of_motion( const stability_strands* s, const state* now )
{
    double sum = 0.0;
    for ( int i = 0; i < STABILITY_POINTS; ++i )
    {
        const wisp_vec3 v = now->v[i];
        const double mass = i % STABILITY_VERTICES > 0 ? (double)s->masses[i] : 0.0;
        const double square = (double)v.x * (double)v.x + (double)v.y * (double)v.y + (double)v.z * (double)v.z;
        sum += mass * ( 0.5 * square + (double)STABILITY_GRAVITY * (double)now->x[i].y );
    }
    return sum;
}

wisp_status stability_strands_observe( void* context, int frame, stability_observation* out, wisp_error* error )
{
    stability_strands* s = context;
    (void)error;
    state now;
    read_state( s, &now );
    *out = ( stability_observation ){ .is_finite = true, .is_halted = wisp_is_halted( s->world, s->entity ) };
    out->speed = frame > 0 ? stability_farthest( now.x, s->seen, STABILITY_POINTS ) / s->seconds : 0.0;
    memcpy( s->seen, now.x, sizeof( s->seen ) );
    observe_segments( s, &now, out );
    out->energy = energy_of_motion( s, &now ) + stored_energy( s, &now, frame );
    out->is_finite = isfinite( out->energy ) && isfinite( out->strain );
    return WISP_OK;
}

uint64_t stability_strands_hash( void* context )
{
    stability_strands* s = context;
    uint64_t hash = 0;
    return wisp_world_hash_column( s->world, s->entity, WISP_STRAND_POINTS, &hash ) == WISP_OK ? hash : 0;
}

stability_trial stability_strands_trial( stability_strands* s, const stability_axes* axes )
{
    stability_trial trial = {
        .limits = stability_usual_limits( s->size, (double)axes->scale, s->seconds, s->substep ),
        .frame_count = stability_frames( stability_duration( (double)axes->scale ), s->seconds ),
        .context = s,
        .step = stability_strands_step,
        .observe = stability_strands_observe,
        .hash = stability_strands_hash,
        .world = s->world,
        .close = stability_strands_close,
    };
    state now;
    stability_observation observation = { 0 };
    read_state( s, &now );
    observe_segments( s, &now, &observation );
    trial.limits.energy = stability_strands_energy_limit( s );
    trial.limits.jitter = observation.strain_limit < STABILITY_SOFT ? trial.limits.jitter : INFINITY;
    return trial;
}
