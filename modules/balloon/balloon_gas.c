// Volume, gas and pressure (balloon paper, eq. 7-9).
#include "balloon_internal.h"

#include <math.h>

enum
{
    RING_GRAIN = 64,    // slices of eight vertices a block: the unit of every sum
    SMALL_SLICES = 320, // about 5 000 triangles: below it a second worker costs more than it gives
};

static void sum_gradients( const wisp_kernels* kernels, const void* args, int begin, int end, double* sums )
{
    wisp_ring_sums s;
    kernels->ring_gradient( args, begin, end, &s );
    sums[0] = s.volume, sums[1] = s.weighted;
}

static wisp_ring_sums sum_rings( wisp_frame* frame, const wisp_span* span, float* gradient, float* area )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    const wisp_ring_args args = { .position = position,
                                  .ring_begin = fabric->ring_begin,
                                  .ring_x4 = fabric->ring_x4,
                                  .origin = wisp_v3_load( position ),
                                  .gradient = gradient,
                                  .area = area };
    const int slices = fabric->ring_slice_count;
    const wisp_summation all = {
        sum_gradients, &args, slices, RING_GRAIN, slices < SMALL_SLICES ? SMALL_SLICES : 2, 2
    };
    double sums[2];
    (void)wisp_frame_sum( frame, span, &all, sums );
    return ( wisp_ring_sums ){ sums[0], sums[1] };
}

// @return false: the mesh is closed
static bool find_border( wisp_frame* frame, const wisp_span* span, const balloon_state* state, balloon_loops* out )
{
    *out = ( balloon_loops ){ wisp_frame_column( frame, span->entity, state->open_edge, 0 ),
                              wisp_frame_column( frame, span->entity, state->open_edge, 1 ),
                              wisp_frame_fabric( frame, span->entity )->slot_count };
    return out->vertex != NULL;
}

// Eq. 9 needs a volume above zero, even after a collapse. NaN stays NaN: it starts no jet, so no gas is lost before the state
// check restores the particles.
static double usable_volume( double volume, const balloon_gas* gas )
{
    double least = 1e-3 * gas->rest_volume;
    return volume < least ? least : volume;
}

// An open outlet needs the gas of every substep, statistics that of the last one.
static bool is_told( wisp_frame* frame, const wisp_span* span, const balloon_state* state )
{
    const balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    return ( outlet != NULL && outlet->open != 0 ) || balloon_is_last_substep( frame, span );
}

void balloon_measure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    if ( is_told( frame, span, state ) == false && wisp_frame_has( frame, span->entity, state->air ) == false &&
         wisp_frame_has( frame, span->entity, state->buoyancy ) == false )
    {
        return;
    }
    balloon_extent* extent = wisp_frame_column( frame, span->entity, state->extent, 0 );
    float* vectors = wisp_frame_column( frame, span->entity, state->rings, 0 );
    float* areas = wisp_frame_column( frame, span->entity, state->rings, 1 );
    double volume = sum_rings( frame, span, vectors, areas ).volume;
    balloon_loops open_edge;
    if ( find_border( frame, span, state, &open_edge ) )
    {
        volume +=
            balloon_fan_volume( &open_edge, wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ), 4 );
    }
    extent->volume = usable_volume( volume, gas );
}

void balloon_inflate( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    float rate = *(float*)wisp_frame_column( frame, span->entity, state->inflation, 0 );
    double grown = gas->target_volume + (double)rate * (double)wisp_frame_dt( frame, span->entity );
    gas->target_volume = fmax( grown, gas->min_volume );
}

// ---- pressure ----

enum
{
    LINK_GRAIN = 4096,
};

// Links with the stiffness of a skin.
typedef struct skin_links
{
    wisp_link_args args;
    balloon_skin skin;
} skin_links;

// sum T l with T = k (l - d): links at rest add nothing, slack ones pull inwards like pressure from outside.
static void sum_tensions( const wisp_kernels* kernels, const void* args, int begin, int end, double* sums )
{
    const skin_links* links = args;
    *sums =
        kernels->link_virial( &links->args, links->skin.edge_stiffness, links->skin.bend_link_stiffness, begin, end );
}

// J, of all links
static double sum_links( wisp_frame* frame, const wisp_span* span, const balloon_state* state )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const skin_links links = {
        .args = { .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
                  .a_x4 = fabric->link_a_x4,
                  .b_x4 = fabric->link_b_x4,
                  .rest = fabric->link_rest,
                  .bends = fabric->link_bends },
        .skin = *(balloon_skin*)wisp_frame_column( frame, span->entity, state->skin, 0 ),
    };
    const wisp_summation all = { sum_tensions, &links, fabric->link_order.slot_count, LINK_GRAIN, 1, 1 };
    double sum;
    (void)wisp_frame_sum( frame, span, &all, &sum );
    return sum;
}

// 3 (P - P_atm) V = sum T l at equilibrium, or that of a membrane; a slack skin holds no pressure.
static double virial_pressure( wisp_frame* frame, const wisp_span* span, const balloon_state* state, double volume )
{
    const double* of_membrane = wisp_frame_column( frame, span->entity, WISP_SURFACE_VIRIAL, 0 );
    return fmax( 0.0, ( of_membrane != NULL ? *of_membrane : sum_links( frame, span, state ) ) / ( 3.0 * volume ) );
}

void balloon_read_pressure( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_extent* extent = wisp_frame_column( frame, span->entity, state->extent, 0 );
    balloon_gauge* gauge = wisp_frame_column( frame, span->entity, state->gauge, 0 );
    if ( is_told( frame, span, state ) )
    {
        gauge->pressure = virial_pressure( frame, span, state, extent->volume );
    }
}

// ---- the constraint ----

WISP_KERNEL_LOOP( push_loop, push_slices, push, wisp_push_args, 1 )

// Change of lambda for C = V - V_0: a part k of the error, as printed, or the gas's compliance V_0 / P_atm.
static double change_of_lambda( balloon_gas* gas, float fraction, wisp_ring_sums sums, double dt )
{
    double error = sums.volume - gas->target_volume;
    if ( !( sums.weighted > 0.0 && isfinite( error ) && isfinite( sums.weighted ) ) )
    {
        return 0.0; // all pinned, collapsed to a point, or not finite, which the state check repairs
    }
    if ( fraction >= 0.0f )
    {
        return -(double)fraction * error / sums.weighted;
    }
    double alpha = gas->target_volume / gas->atmosphere / ( dt * dt );
    return -( error + alpha * gas->lambda ) / ( sums.weighted + alpha );
}

void balloon_project_volume( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    float fraction = *(float*)wisp_frame_column( frame, span->entity, state->volume, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    size_t bytes = (size_t)fabric->slot_count * 3 * sizeof( float );
    float* gradient = wisp_parallel_scratch( parallel, span->worker, bytes );
    if ( gradient == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the volume of %d vertices", fabric->vertex_count );
        return;
    }
    gas->lambda = span->iteration == 0 ? 0.0 : gas->lambda;
    wisp_ring_sums sums = sum_rings( frame, span, gradient, NULL );
    balloon_loops open_edge;
    if ( find_border( frame, span, state, &open_edge ) )
    {
        balloon_add_fans( &open_edge, position, gradient, &sums );
    }
    double dt = (double)wisp_frame_dt( frame, span->entity ), change = change_of_lambda( gas, fraction, sums, dt );
    gas->lambda += change;
    push_loop loop = {
        { position, gradient, (float)change },
        wisp_frame_kernels( frame ),
    };
    int grain = fabric->ring_slice_count < SMALL_SLICES ? SMALL_SLICES : 4 * RING_GRAIN;
    wisp_parallel_for( parallel, fabric->ring_slice_count, grain, push_slices, &loop );
}

// ---- outlet ----

// The outlet: mass flow and thrust (balloon paper, eq. 12).

// A jet ends at 1e-4 P_atm and starts again above 5e-4, because noise of the solver in the pressure would make it chatter.
static const double CLOSE_AT = 1e-4, OPEN_AT = 5e-4;

// The area vectors of the outlet's vertices give its normal. @return false if they cancel
static bool aim( const float* position, const float* vectors, balloon_outlet* outlet )
{
    double normal[3] = { 0 }, place[3] = { 0 };
    for ( int i = 0; i < outlet->count; ++i )
    {
        int slot = outlet->slots[i];
        for ( int k = 0; k < 3; ++k )
        {
            normal[k] += (double)vectors[(size_t)( slot / 8 ) * 24 + (size_t)( 8 * k + slot % 8 )];
            place[k] += (double)position[(size_t)slot * 4 + (size_t)k] / outlet->count;
        }
    }
    double length = sqrt( normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2] );
    for ( int k = 0; k < 3; ++k )
    {
        outlet->normal[k] = length > 0.0 ? normal[k] / length : 0.0;
        outlet->place[k] = place[k];
    }
    return length > 0.0;
}

// Let out gas, at most what V_0 has above its minimum. The thrust follows from the actual flow.
static void flow( balloon_outlet* outlet, balloon_gas* gas, double pressure, double dt )
{
    outlet->speed = sqrt( 2.0 * fmax( 0.0, pressure ) / gas->gas_density );
    double requested = gas->gas_density * outlet->area * outlet->speed;
    double most = gas->gas_density * fmax( 0.0, gas->target_volume - gas->min_volume ) / dt;
    outlet->mass_flow = fmin( requested, most );
    gas->target_volume -= outlet->mass_flow / gas->gas_density * dt;
    outlet->gas_lost += outlet->mass_flow * dt;
}

void balloon_let_out( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const balloon_gauge* gauge = wisp_frame_column( frame, span->entity, state->gauge, 0 );
    const float* vectors = wisp_frame_column( frame, span->entity, state->rings, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    double fraction = gauge->pressure / gas->atmosphere;
    bool runs = outlet->open != 0 && fraction > ( outlet->running != 0 ? CLOSE_AT : OPEN_AT );
    outlet->jet_starts += runs && outlet->running == 0 ? 1 : 0;
    outlet->running = runs ? 1 : 0;
    outlet->speed = outlet->mass_flow = 0.0;
    if ( runs && aim( position, vectors, outlet ) )
    {
        flow( outlet, gas, gauge->pressure, (double)wisp_frame_dt( frame, span->entity ) );
    }
}

// Apply the linear part F = -mdot v n, shared by mass. The spin pass applies the angular part.
void balloon_jet( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_outlet* outlet = wisp_frame_column( frame, span->entity, state->outlet, 0 );
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    if ( outlet->mass_flow == 0.0 || body->mass == 0.0 )
    {
        return;
    }
    double factor = -outlet->mass_flow * outlet->speed / body->mass * (double)wisp_frame_dt( frame, span->entity );
    balloon_push_all( frame, span,
                      ( wisp_vec3 ){ (float)( factor * outlet->normal[0] ), (float)( factor * outlet->normal[1] ),
                                     (float)( factor * outlet->normal[2] ) } );
}

// ---- air ----

// Air around the skin: buoyancy (balloon paper, eq. 10) and drag (eq. 11).

wisp_vertex_drag_args balloon_drag_args( wisp_frame* frame, const wisp_span* span, const balloon_state* state )
{
    const balloon_air* air = wisp_frame_column( frame, span->entity, state->air, 0 );
    return ( wisp_vertex_drag_args ){
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .vectors = wisp_frame_column( frame, span->entity, state->rings, 0 ),
        .areas = wisp_frame_column( frame, span->entity, state->rings, 1 ),
        .half_density_drag = air->half_density_drag,
        .dt = wisp_frame_dt( frame, span->entity ),
    };
}

void balloon_drag( wisp_frame* frame, const wisp_span* span, void* user )
{
    const wisp_vertex_drag_args args = balloon_drag_args( frame, span, user );
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->vertex_drag( &args, s.begin, s.end );
}

void balloon_push_all( wisp_frame* frame, const wisp_span* span, wisp_vec3 change )
{
    const wisp_particle_args args = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .acceleration = change,
        .dt = 1.0f,
    };
    const wisp_span s = wisp_frame_particles( frame, span );
    wisp_frame_kernels( frame )->accelerate( &args, s.begin, s.end );
}

// Share buoyancy by mass, which gives no torque. The difference of densities contains the weight of the gas.
void balloon_float( wisp_frame* frame, const wisp_span* span, void* user )
{
    const balloon_state* state = user;
    const balloon_gas* gas = wisp_frame_column( frame, span->entity, state->gas, 0 );
    const balloon_extent* extent = wisp_frame_column( frame, span->entity, state->extent, 0 );
    const balloon_body* body = wisp_frame_column( frame, span->entity, state->body, 0 );
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    double lifted = extent->volume * ( gas->air_density - gas->gas_density ); // kg
    float fraction =
        body->mass > 0.0 ? (float)( -lifted / body->mass * (double)wisp_frame_dt( frame, span->entity ) ) : 0.0f;
    balloon_push_all( frame, span,
                      ( wisp_vec3 ){ fraction * gravity->x, fraction * gravity->y, fraction * gravity->z } );
}
