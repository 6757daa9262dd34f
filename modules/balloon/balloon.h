/// Balloon: a closed elastic skin filled with gas that floats, jets, spins and shrinks (balloon paper, docs/methods.md; what it
/// leaves open is a switch here). The skin's links come from here too, so a surface is a balloon or a cloth, not both.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_balloon_module;

/// Where the inner pressure is read. Equal at equilibrium and many substeps; far apart before.
typedef enum wisp_balloon_pressure
{
    WISP_BALLOON_PRESSURE_VIRIAL,     ///< from the skin's tensions: sum T l / (3 V), smooth and hardly mesh dependent
    WISP_BALLOON_PRESSURE_MULTIPLIER, ///< lambda / dt^2 of the volume constraint
    WISP_BALLOON_PRESSURE_GAS,        ///< P_atm V_0 / V, as printed: 1 % of volume is 1013 Pa
    WISP_BALLOON_PRESSURE_COUNT,
} wisp_balloon_pressure;

/// How Eq. 11 weighs the angle between motion and normal.
typedef enum wisp_balloon_drag
{
    WISP_BALLOON_DRAG_MAX,    ///< max( 0, cos ): the textbook drag of a closed body
    WISP_BALLOON_DRAG_ABS,    ///< |cos|: twice the frontal area
    WISP_BALLOON_DRAG_SIGNED, ///< cos, as printed: nothing on a closed rigid body
    WISP_BALLOON_DRAG_NORMAL, ///< along the normal: 4/3 of the frontal area on a sphere
    WISP_BALLOON_DRAG_COUNT,
} wisp_balloon_drag;

typedef enum wisp_balloon_spin
{
    WISP_BALLOON_SPIN_VELOCITY, ///< the torque's increment D_omega x r is added to velocities
    WISP_BALLOON_SPIN_POSITION, ///< an angular velocity is kept apart and turns positions, as printed
    WISP_BALLOON_SPIN_NONE,     ///< no torque, no pass
    WISP_BALLOON_SPIN_COUNT,
} wisp_balloon_spin;

#define WISP_BALLOON_MAX_OUTLET 64

/// Fill from wisp_default_balloon_def(). Copied.
typedef struct wisp_balloon_def
{
    wisp_solver solver;        ///< of the skin, default xpbd
    float edge_stiffness;      ///< N/m, > 0, default 2000: of structural edges (xpbd), and of the virial reading
    float bend_link_stiffness; ///< N/m, > 0, default 20: the same of the links across edges
    float stretch_stiffness;   ///< pbd, in [0, 1], default 0.9
    float bend_stiffness;      ///< pbd, in [0, 1], default 0.1

    wisp_solver volume;     ///< how the volume is held, default xpbd: a gas of compliance V_0 / P_atm
    float volume_stiffness; ///< pbd, in (0, 1], default 1
    float gas_ratio;      ///< V_0 / V_rest at the start, >= min_gas_ratio, default 1; V_0: volume of the gas at P_atm
    float inflation_rate; ///< m^3/s of gas at atmospheric pressure, negative lets it out; default 0
    float min_gas_ratio;  ///< V_0 never falls below this times V_rest, in [0.001, 1], default 1: the skin is slack

    float atmospheric_pressure;     ///< Pa, default 101325
    float temperature;              ///< K, default 293.15
    float gas_molar_mass;           ///< kg/mol, default 4.0026e-3, helium
    float air_molar_mass;           ///< kg/mol, default 28.9647e-3
    wisp_balloon_pressure pressure; ///< default virial

    bool buoyancy;                ///< default true; acts against the surface's gravity, so it needs one
    float drag_coefficient;       ///< C_d, >= 0, default 0.5; 0: no drag and no pass
    wisp_balloon_drag drag_model; ///< default max

    int outlet_count;                        ///< vertices of the outlet, 0: no outlet, no jet, no spin; default 0
    int32_t outlet[WISP_BALLOON_MAX_OUTLET]; ///< the user's vertices; their area vectors give its normal
    float outlet_area;                       ///< m^2, > 0, default 1e-4
    bool outlet_open;                        ///< the valve, default false
    wisp_balloon_spin spin;                  ///< default kick
    bool
        keep_angular_momentum; ///< default true: projections of a free skin do not turn it. False as in the paper: it spins
                               ///< up without a torque, and faster with more substeps
    /// Default false: an open mesh is refused. True: each hole is closed by a virtual fan about the mean of its border, for
    /// the volume alone; a fan has no mass, no links, no normal and no drag.
    bool allow_open;
    uint32_t cookie;
} wisp_balloon_def;

WISP_API wisp_balloon_def wisp_default_balloon_def( void );

/// Make a surface a balloon, or change the balloon it is; what the gas did so far is forgotten.
/// @return WISP_CONFLICT the module is not registered or the entity is not a surface; WISP_BAD_INPUT a value is out of
///         range, or the mesh has a border (without allow_open; with it, one that is no simple loop), nonmanifold edges,
///         several shells or encloses no volume (the message says which); WISP_NO_MEMORY
/// @note links across edges are projected only if the fabric has bend links
WISP_API wisp_status wisp_set_balloon( wisp_world* world, wisp_entity surface, const wisp_balloon_def* def );

/// Control while it runs; each takes effect with the next step.
/// @param fill V_0 / V_rest, >= min_gas_ratio
WISP_API wisp_status wisp_set_balloon_gas_ratio( wisp_world* world, wisp_entity balloon, float gas_ratio );
/// @param rate m^3/s at atmospheric pressure
WISP_API wisp_status wisp_set_balloon_inflation( wisp_world* world, wisp_entity balloon, float rate );
WISP_API wisp_status wisp_open_balloon( wisp_world* world, wisp_entity balloon, bool open );

/// What a balloon shows after a step (balloon paper, fig. 4-7): the last substep's forces, and the body at its start.
typedef struct wisp_balloon_stats
{
    double rest_volume;                              ///< V_rest, m^3
    double target_volume;                            ///< V_0, m^3
    double volume;                                   ///< V, m^3, at least 1e-3 V_rest
    double pressure;                                 ///< P - P_atm as it was read, Pa
    double outlet_speed;                             ///< m/s, 0 when no jet runs
    double mass_flow;                                ///< kg/s
    double gas_lost;                                 ///< kg, since the balloon was set
    double gravity[3], buoyancy[3], drag[3], jet[3]; ///< N
    double torque[3];                                ///< N m, of the jet about the centre of mass
    double angular_velocity[3];                      ///< rad/s, I^-1 L
    double orientation[4]; ///< unit quaternion w, x, y, z, turned by that velocity since figures were asked for
    double centre[3];      ///< m
    double jet_starts;     ///< how often the jet came on
} wisp_balloon_stats;

/// Ask for figures; their passes exist from the next step on. @param wanted false ends it
WISP_API wisp_status wisp_request_balloon_stats( wisp_world* world, wisp_entity balloon, bool requested );
/// @return WISP_CONFLICT unless figures are wanted and a step was made since
WISP_API wisp_status wisp_read_balloon_stats( wisp_world* world, wisp_entity balloon, wisp_balloon_stats* out );

WISP_END_C
