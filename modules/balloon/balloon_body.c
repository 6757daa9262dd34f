// The balloon as a rigid body: mass, centre, inertia (balloon paper, eq. 16-17), and its spin by the torque (eq. 13-15).
#include "balloon_internal.h"

#include <math.h>
#include <string.h>

enum
{
    BODY_GRAIN = 2048, // particles a block: the unit of every sum
};

static void sum_moments( const wisp_kernels* kernels, const void* args, int begin, int end, double* sums )
{
    wisp_moments block;
    kernels->moments( args, begin, end, &block );
    memcpy( sums, &block, sizeof( block ) );
}

// Sum moments of all vertices about the first one of `previous`, [slot][4]. @return false: no memory, and the frame fails
static bool sum_all_moments( wisp_frame* frame, const wisp_span* span, const float* previous, wisp_moments* out )
{
    const wisp_moment_args args = { wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ), previous,
                                    wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
                                    wisp_v3_load( previous ) };
    const int vertices = wisp_frame_fabric( frame, span->entity )->vertex_count;
    const wisp_summation all = { sum_moments, &args, vertices, BODY_GRAIN, 1, sizeof( *out ) / sizeof( double ) };
    return wisp_frame_sum( frame, span, &all, &out->mass );
}

// Inverse of a symmetric matrix by its adjugate; zero where all mass lies on a line.
static void invert( const double i[6], double out[6] )
{
    const double xx = i[0], yy = i[1], zz = i[2], xy = i[3], xz = i[4], yz = i[5];
    double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    double determinant = xx * a + xy * b + xz * c, scale = xx + yy + zz;
    memset( out, 0, 6 * sizeof( double ) );
    if ( fabs( determinant ) > 1e-12 * scale * scale * scale )
    {
        out[0] = a / determinant;
        out[1] = ( xx * zz - xz * xz ) / determinant;
        out[2] = ( xx * yy - xy * xy ) / determinant;
        out[3] = b / determinant;
        out[4] = c / determinant;
        out[5] = ( xy * xz - xx * yz ) / determinant;
    }
}

static void finish( balloon_body* body, const wisp_moments* m, const float* origin )
{
    memset( body, 0, sizeof( *body ) );
    body->mass = m->mass;
    if ( !( m->mass > 0.0 ) )
    {
        return;
    }
    double c[3]; // centre from the first particle
    for ( int k = 0; k < 3; ++k )
    {
        c[k] = m->first[k] / m->mass;
        body->centre[k] = (double)origin[k] + c[k];
    }
    double xx = m->mixed[0][0] - m->mass * c[0] * c[0], yy = m->mixed[1][1] - m->mass * c[1] * c[1];
    double zz = m->mixed[2][2] - m->mass * c[2] * c[2];
    const double inertia[6] = { yy + zz,
                                xx + zz,
                                xx + yy,
                                -( m->mixed[0][1] - m->mass * c[0] * c[1] ),
                                -( m->mixed[0][2] - m->mass * c[0] * c[2] ),
                                -( m->mixed[1][2] - m->mass * c[1] * c[2] ) };
    invert( inertia, body->inverse_inertia );
    body->angular_momentum[0] = m->angular_momentum[0] - ( c[1] * m->momentum[2] - c[2] * m->momentum[1] );
    body->angular_momentum[1] = m->angular_momentum[1] - ( c[2] * m->momentum[0] - c[0] * m->momentum[2] );
    body->angular_momentum[2] = m->angular_momentum[2] - ( c[0] * m->momentum[1] - c[1] * m->momentum[0] );
}

void balloon_measure_body( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    wisp_moments sum;
    if ( sum_all_moments( frame, span, position, &sum ) )
    {
        finish( wisp_frame_column( frame, span->entity, state->body, 0 ), &sum, position );
    }
}

void balloon_spin_of( const balloon_body* body, const double torque[3], double out[3] )
{
    const double* i = body->inverse_inertia;
    out[0] = i[0] * torque[0] + i[3] * torque[1] + i[4] * torque[2];
    out[1] = i[3] * torque[0] + i[1] * torque[1] + i[5] * torque[2];
    out[2] = i[4] * torque[0] + i[5] * torque[1] + i[2] * torque[2];
}

// Eq. 13 with F = -mdot v n.
static void balloon_torque_of( const balloon_body* body, const balloon_outlet* outlet, double out[3] )
{
    double r[3], f[3];
    for ( int k = 0; k < 3; ++k )
    {
        r[k] = outlet->place[k] - body->centre[k];
        f[k] = -outlet->mass_flow * outlet->speed * outlet->normal[k];
    }
    out[0] = r[1] * f[2] - r[2] * f[1];
    out[1] = r[2] * f[0] - r[0] * f[2];
    out[2] = r[0] * f[1] - r[1] * f[0];
}

// Add D_omega x r to the velocities (eq. 14: D_omega = dt I^-1 tau), which adds exactly dt tau to the angular momentum.
void balloon_kick( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    wisp_turn_args args = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .rows = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .centre = { body->centre[0], body->centre[1], body->centre[2] },
    };
    double torque[3];
    balloon_torque_of( body, wisp_frame_column( frame, span->entity, state->outlet, 0 ), torque );
    balloon_spin_of( body, torque, args.angle );
    for ( int k = 0; k < 3; ++k )
    {
        args.angle[k] *= (double)wisp_frame_dt( frame, span->entity );
    }
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->turn( &args, s.begin, s.end );
}

// ---- angular momentum ----

// Keeps the angular momentum of the skin. Ordered projections turn a body a little, and always the same way, because their order
// is always the same. A stiff skin under pressure moves far in each substep, so the turns add up. Without this pass a ball of 258
// vertices at 1.8 times its volume spins with 40 rad/s after five seconds (10 substeps of 2 iterations), and faster with
// more substeps.
//
// With x the positions before the substep, p* the predicted ones and p = p* + D those after all projections, the angular
// momentum of v = (p - x) / dt about the centre is that of the prediction plus sum m (x - c) x D / dt. Turning p by the
// rotation -t with sum m (x - c) x (t x (p - c)) = sum m (x - c) x D removes exactly that.

enum
{
    TURN_GRAIN = 2048, // particles a block
};

// rad: projections that seem to turn a body by more have crushed it, and the equation of small turns is not theirs.
static const double TURN_MAX = 0.5;

static double determinant( const double a[3], const double b[3], const double c[3] )
{
    return a[0] * ( b[1] * c[2] - b[2] * c[1] ) + a[1] * ( b[2] * c[0] - b[0] * c[2] ) +
           a[2] * ( b[0] * c[1] - b[1] * c[0] );
}

// Solve sum m ( (x . p) t - p (x . t) ) = turn by Cramer's rule, everything about the centres. On the right is
// sum m x x D = sum m x x p - dt sum m x x v, because x x x is 0.
// @return false where all mass lies on a line, or the turn is not a small one
static bool find_turn( const wisp_moments* m, double dt, double angle[3] )
{
    double column[3][3], trace = 0.0, turn[3];
    for ( int k = 0; k < 3; ++k )
    {
        const int a = ( k + 1 ) % 3, b = ( k + 2 ) % 3;
        trace += m->mixed[k][k] - m->first[k] * m->previous[k] / m->mass;
        turn[k] = m->mixed[b][a] - m->mixed[a][b] - dt * m->angular_momentum[k];
    }
    for ( int b = 0; b < 3; ++b )
    {
        for ( int a = 0; a < 3; ++a )
        {
            column[b][a] = ( a == b ? trace : 0.0 ) - ( m->mixed[a][b] - m->first[a] * m->previous[b] / m->mass );
        }
    }
    double bottom = determinant( column[0], column[1], column[2] );
    if ( !( fabs( bottom ) > 1e-12 * fabs( trace * trace * trace ) ) )
    {
        return false;
    }
    angle[0] = determinant( turn, column[1], column[2] ) / bottom;
    angle[1] = determinant( column[0], turn, column[2] ) / bottom;
    angle[2] = determinant( column[0], column[1], turn ) / bottom;
    return angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2] <= TURN_MAX * TURN_MAX;
}

WISP_KERNEL_LOOP( turn_loop, turn_back, turn, wisp_turn_args, 1 )

// Run once a substep, after the last projection of the skin. A body with a pinned vertex is left alone.
void balloon_keep_angular( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    if ( span->iteration < wisp_frame_iterations( frame ) - 1 )
    {
        return;
    }
    const float* previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    wisp_moments m;
    double turn[3];
    if ( sum_all_moments( frame, span, previous, &m ) && m.pinned == 0.0 && m.mass > 0.0 &&
         find_turn( &m, (double)wisp_frame_dt( frame, span->entity ), turn ) )
    {
        turn_loop loop = { { .position = position, .rows = position }, wisp_frame_kernels( frame ) };
        for ( int k = 0; k < 3; ++k )
        {
            loop.args.angle[k] = -turn[k];
            loop.args.centre[k] = (double)previous[k] + m.first[k] / m.mass;
        }
        wisp_parallel_for( wisp_frame_parallel( frame, span ), wisp_frame_fabric( frame, span->entity )->vertex_count,
                           TURN_GRAIN, turn_back, &loop );
    }
}

// ---- statistics ----

// Statistics of a balloon, on request: pressures, volumes, the four forces (balloon paper, fig. 4), spin and orientation.

static void take_weight( wisp_frame* frame, const wisp_span* span, const balloon_state* state, double volume,
                         const balloon_body* body, wisp_balloon_stats* f )
{
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const wisp_vec3* g = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    const double down[3] = { g != NULL ? (double)g->x : 0.0, g != NULL ? (double)g->y : 0.0,
                             g != NULL ? (double)g->z : 0.0 };
    bool floats = wisp_frame_has( frame, span->entity, state->buoyancy );
    double lifted = floats ? volume * ( gas->air_density - gas->gas_density ) : 0.0;
    for ( int k = 0; k < 3; ++k )
    {
        f->gravity[k] = body->mass * down[k];
        f->buoyancy[k] = -lifted * down[k];
    }
}

static void take_jet( const balloon_outlet* outlet, const balloon_body* body, wisp_balloon_stats* f )
{
    f->outlet_speed = outlet->speed;
    f->mass_flow = outlet->mass_flow;
    f->gas_lost = outlet->gas_lost;
    f->jet_starts = outlet->jet_starts;
    for ( int k = 0; k < 3; ++k )
    {
        f->jet[k] = -outlet->mass_flow * outlet->speed * outlet->normal[k];
    }
    balloon_torque_of( body, outlet, f->torque );
}

// Eq. 15: q + dt/2 (0, omega) q, normalised.
static void turn( double q[4], const double w[3], double dt )
{
    double h = 0.5 * dt;
    double next[4] = {
        q[0] - h * ( w[0] * q[1] + w[1] * q[2] + w[2] * q[3] ),
        q[1] + h * ( w[0] * q[0] + w[1] * q[3] - w[2] * q[2] ),
        q[2] + h * ( w[1] * q[0] + w[2] * q[1] - w[0] * q[3] ),
        q[3] + h * ( w[2] * q[0] + w[0] * q[2] - w[1] * q[1] ),
    };
    double length = sqrt( next[0] * next[0] + next[1] * next[1] + next[2] * next[2] + next[3] * next[3] );
    for ( int k = 0; k < 4 && isfinite( length ); ++k ) // the state check restores particles, but not this
    {
        q[k] = next[k] / length;
    }
}

bool balloon_is_last_substep( wisp_frame* frame, const wisp_span* span )
{
    return span->substep + 1 == wisp_frame_substeps( frame, span->entity );
}

// Measure once a substep, so that the orientation follows. At the end of a step all values belong to its last substep, the only
// one whose drag is summed.
void balloon_take_stats( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const balloon_extent* extent = wisp_frame_column( frame, span->entity, state->extent, 0 );
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    const balloon_gauge* gauge = wisp_frame_column( frame, span->entity, state->gauge, 0 );
    const balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    wisp_balloon_stats* f = wisp_frame_column( frame, span->entity, state->stats, 0 );
    const wisp_vec3 o = wisp_frame_offset( frame, span->entity );
    double q[4] = { f->orientation[0], f->orientation[1], f->orientation[2], f->orientation[3] };
    q[0] = q[0] == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0 ? 1.0 : q[0];
    *f = ( wisp_balloon_stats ){
        .rest_volume = gas->rest_volume,
        .target_volume = gas->target_volume,
        .volume = extent->volume,
        .pressure = gauge->pressure,
        .centre = { body->centre[0] - (double)o.x, body->centre[1] - (double)o.y, body->centre[2] - (double)o.z },
    };
    take_weight( frame, span, state, extent->volume, body, f );
    if ( wisp_frame_has( frame, span->entity, state->air ) && balloon_is_last_substep( frame, span ) )
    {
        const wisp_vertex_drag_args args = balloon_drag_args( frame, span, state );
        wisp_frame_kernels( frame )->sum_vertex_drag( &args, 0, wisp_frame_fabric( frame, span->entity )->slot_count,
                                                      f->drag );
    }
    if ( outlet != NULL )
    {
        take_jet( outlet, body, f );
    }
    balloon_spin_of( body, body->angular_momentum, f->angular_velocity );
    turn( q, f->angular_velocity, (double)wisp_frame_dt( frame, span->entity ) );
    memcpy( f->orientation, q, sizeof( q ) );
}
