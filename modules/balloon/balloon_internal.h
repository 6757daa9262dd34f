/// State of a balloon: one component for each part that may be absent.
#pragma once

#include "balloon.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

/// R, J/(mol K)
#define BALLOON_GAS_CONSTANT 8.314462618

/// The gas. Doubles, because V_0 sums thousands of tiny changes.
typedef struct balloon_gas
{
    double rest_volume;              // V_rest, m^3
    double target_volume;            // V_0
    double min_volume;               // lower bound of V_0
    double atmosphere;               // Pa
    double gas_density, air_density; // kg/m^3 at atmospheric pressure
    double lambda;                   // of the volume constraint, in this substep
} balloon_gas;

/// Enclosed volume at the start of the substep.
typedef struct balloon_extent
{
    double volume; // m^3, at least 1e-3 V_rest
} balloon_extent;

/// P - P_atm, Pa
typedef struct balloon_gauge
{
    double pressure;
} balloon_gauge;

/// Mass, centre and inverse inertia of the particles that are not pinned (eq. 16-17), rebuilt every substep.
typedef struct balloon_body
{
    double mass, centre[3];
    double inverse_inertia[6]; // xx yy zz xy xz yz, 1/(kg m^2)
    double angular_momentum[3];
} balloon_body;

typedef struct balloon_outlet
{
    double area;      // m^2
    double speed;     // m/s, of this substep
    double mass_flow; // kg/s
    double normal[3]; // outward
    double place[3];  // m
    double gas_lost;  // kg
    int32_t jet_starts;
    int32_t count;
    int32_t slots[WISP_BALLOON_MAX_OUTLET];
    int32_t open;    // the user's valve
    int32_t running; // the jet
} balloon_outlet;

typedef struct balloon_air
{
    float half_density_drag; // 1/2 rho C_d, kg/m^3
} balloon_air;

typedef struct balloon_skin
{
    float edge_stiffness, bend_link_stiffness; // N/m, for tensions
} balloon_skin;

/// The components, a row each: X( member, "name", table, columns ).
#define BALLOON_COMPONENTS( X )                                                                                      \
    X( gas, "balloon.gas", ENTITY, WISP_COLUMN( balloon_gas, value, 1 ) ) /* marks a balloon */                      \
    X( skin, "balloon.skin", ENTITY, WISP_COLUMN( balloon_skin, value, 1 ) )                                         \
    X( inflation, "balloon.inflation", ENTITY, WISP_COLUMN( float, value, 1 ) ) /* m^3/s */                          \
    X( volume, "balloon.volume", ENTITY, WISP_COLUMN( float, value, 1 ) )       /* (0, 1]; below 0: xpbd */          \
    X( extent, "balloon.extent", ENTITY, WISP_COLUMN( balloon_extent, value, 1 ) )                                   \
    X( rings, "balloon.rings", PARTICLE,                                                                             \
       /* per particle: area vectors [slice][3][8], areas [slice][8] */ WISP_COLUMN( float, vectors, 3 ),            \
       WISP_COLUMN( float, areas, 1 ) )                                                                              \
    X( open_edge, "balloon.open_edge", PARTICLE,                                                                     \
       /* present if the mesh has holes; per particle: balloon_loops */ WISP_COLUMN( int32_t, vertex, 1 ),           \
       WISP_COLUMN( int32_t, size, 1 ) )                                                                             \
    X( gauge, "balloon.gauge", ENTITY, WISP_COLUMN( balloon_gauge, value, 1 ) )                                      \
    X( buoyancy, "balloon.buoyancy", ENTITY, WISP_NO_COLUMNS ) /* present if it acts */                              \
    X( air, "balloon.air", ENTITY, WISP_COLUMN( balloon_air, value, 1 ) )                                            \
    X( body, "balloon.body", ENTITY, WISP_COLUMN( balloon_body, value, 1 ) )                                         \
    X( outlet, "balloon.outlet", ENTITY, WISP_COLUMN( balloon_outlet, value, 1 ) )                                   \
    X( jet, "balloon.jet", ENTITY, WISP_NO_COLUMNS ) /* written by the outlet: there is a force */                   \
    X( stats, "balloon.stats", ENTITY, WISP_COLUMN( wisp_balloon_stats, value, 1 ) )

typedef struct balloon_state
{
    BALLOON_COMPONENTS( WISP_COMPONENT_MEMBER )
} balloon_state;

/// Loops of open edges, concatenated: vertices along the triangles of the skin, each loop from its lowest slot, loops in
/// the order of their first slots.
typedef struct balloon_loops
{
    const int32_t* vertex; // [count] slots
    const int32_t* size;   // [count] number of vertices at the first entry of a loop, else 0
    int count;             // capacity, not vertices
} balloon_loops;

// balloon_border.c
/// Name the first open edge in the error. Always WISP_BAD_INPUT on an open mesh.
wisp_status balloon_refuse_open( wisp_world* world, const wisp_fabric* f );
/// Check that open edges form simple loops. For a mesh without nonmanifold edges.
wisp_status balloon_check_border( wisp_world* world, const wisp_fabric* f );
/// @param vertex, size receive [slot_count]
void balloon_find_loops( const wisp_fabric* f, int32_t* vertex, int32_t* size );
/// Volume of the fans about the first particle, m^3. @param position [slot][stride]
double balloon_fan_volume( const balloon_loops* loops, const float* position, int stride );
/// Add the fans to the sums and gradients of ring_gradient. @param position [slot][4]
void balloon_add_fans( const balloon_loops* loops, const float* position, float* gradient, wisp_ring_sums* sums );

// balloon_gas.c
void balloon_measure( wisp_frame* frame, const wisp_span* span, void* user );
void balloon_inflate( wisp_frame* frame, const wisp_span* span, void* user );
void balloon_read_pressure( wisp_frame* frame, const wisp_span* span, void* user );
void balloon_project_volume( wisp_frame* frame, const wisp_span* span, void* user );

// balloon_body.c
void balloon_keep_angular( wisp_frame* frame, const wisp_span* span, void* user );

// balloon_gas.c
void balloon_drag( wisp_frame* frame, const wisp_span* span, void* user );
void balloon_float( wisp_frame* frame, const wisp_span* span, void* user );
/// Arguments of drag (balloon paper, eq. 11). The entity has air and rings.
wisp_vertex_drag_args balloon_drag_args( wisp_frame* frame, const wisp_span* span, const balloon_state* state );
/// Add a change of velocity to the particles of a block that are not pinned.
void balloon_push_all( wisp_frame* frame, const wisp_span* span, wisp_vec3 change );

void balloon_let_out( wisp_frame* frame, const wisp_span* span, void* user );
void balloon_jet( wisp_frame* frame, const wisp_span* span, void* user );

void balloon_measure_body( wisp_frame* frame, const wisp_span* span, void* user );
void balloon_kick( wisp_frame* frame, const wisp_span* span, void* user );
/// w = I^-1 t
void balloon_spin_of( const balloon_body* body, const double torque[3], double out[3] );

// balloon_body.c
bool balloon_is_last_substep( wisp_frame* frame, const wisp_span* span );
void balloon_take_stats( wisp_frame* frame, const wisp_span* span, void* user );
