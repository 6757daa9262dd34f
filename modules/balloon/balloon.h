/// Balloon: a closed elastic skin filled with gas that floats, jets, spins and shrinks. The method is the balloon paper of
/// docs/methods.md. The module has the links of the skin too, so a surface is either a balloon or a cloth.
///
///     wisp_balloon_def balloon = wisp_default_balloon_def();
///     balloon.gas_ratio = 1.2f;                                  // 1.2 times the rest volume of helium at 1 atm
///     wisp_set_balloon( world, surface, &balloon );              // the fabric must be closed and have bend links
///     wisp_request_balloon_stats( world, surface, true );
///     wisp_world_step( world, dt );
///     wisp_balloon_stats stats;
///     wisp_read_balloon_stats( world, surface, &stats );         // volume, pressure, forces
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_balloon_module;

#define WISP_BALLOON_MAX_OUTLET 64

/// Skin, gas, air and outlet of a balloon. Fill from wisp_default_balloon_def(). Copied.
typedef struct wisp_balloon_def
{
    uint32_t size; ///< bytes; set by wisp_default_balloon_def()
    wisp_solver
        solver; ///< of the skin, default xpbd. The skin is links, or a membrane that was set before (membrane.h)
    float edge_stiffness;      ///< N/m, > 0, default 2000: of the edges (xpbd), and of the virial pressure
    float bend_link_stiffness; ///< N/m, > 0, default 20: the same for bend links
    float stretch_stiffness;   ///< pbd, in [0, 1], default 0.9
    float bend_stiffness;      ///< pbd, in [0, 1], default 0.1

    wisp_solver volume;     ///< solver of the volume, default xpbd: a gas of compliance V_0 / P_atm
    float volume_stiffness; ///< pbd, in (0, 1], default 1
    float gas_ratio;      ///< V_0 / V_rest at the start, >= min_gas_ratio, default 1; V_0: volume of the gas at P_atm
    float inflation_rate; ///< m^3/s of gas at atmospheric pressure, negative deflates; default 0
    float min_gas_ratio;  ///< V_0 never falls below this times V_rest, in [0.001, 1], default 1: the skin is slack

    float atmospheric_pressure; ///< Pa, default 101325
    float temperature;          ///< K, default 293.15
    float gas_molar_mass;       ///< kg/mol, default 4.0026e-3, helium
    float air_molar_mass;       ///< kg/mol, default 28.9647e-3

    bool buoyancy;          ///< default true; opposes the gravity of the surface, which must be set
    float drag_coefficient; ///< C_d, >= 0, default 0.5; 0: no drag and no pass

    int outlet_count; ///< vertices of the outlet, 0: no outlet, no jet, no spin; default 0
    int32_t outlet
        [WISP_BALLOON_MAX_OUTLET]; ///< vertices in the user's order; the jet acts at their mean, along the sum of their
                                   ///< area vectors
    float outlet_area;             ///< m^2, > 0, default 1e-4
    bool outlet_open;              ///< state of the valve, default false
    /// Default false: an open mesh is refused. True: each hole is closed by a virtual fan about the mean of its open edges, for
    /// the volume only; a fan has no mass, links, normal or drag.
    bool allow_open;
} wisp_balloon_def;

WISP_DEFINITION( balloon_def );

/// Make a surface a balloon, or replace its definition. Gas lost or added so far is reset.
/// @return WISP_CONFLICT the module is not registered or the entity is not a surface; WISP_BAD_INPUT a value is out of
///         range, or the mesh has open edges (with allow_open: open edges that form no simple loop), nonmanifold edges,
///         several components or no volume (the message says which); WISP_NO_MEMORY
/// @note Bend links are projected only if the fabric has them.
WISP_API wisp_status wisp_set_balloon( wisp_world* world, wisp_entity surface, const wisp_balloon_def* def );

/// Set the amount of gas. Takes effect with the next step, like the two functions below.
/// @param gas_ratio V_0 / V_rest, >= min_gas_ratio
WISP_API wisp_status wisp_set_balloon_gas_ratio( wisp_world* world, wisp_entity balloon, float gas_ratio );
/// Set the inflation rate. @param rate m^3/s at atmospheric pressure
WISP_API wisp_status wisp_set_balloon_inflation( wisp_world* world, wisp_entity balloon, float rate );
WISP_API wisp_status wisp_open_balloon( wisp_world* world, wisp_entity balloon, bool open );

/// Statistics after a step (balloon paper, fig. 4-7): forces of the last substep, and the body at its start.
typedef struct wisp_balloon_stats
{
    double rest_volume;   ///< V_rest, m^3
    double target_volume; ///< V_0, m^3
    double volume;        ///< V, m^3, at least 1e-3 V_rest
    double pressure;      ///< P - P_atm that the tensions of the skin hold, Pa: sum T l / (3 V)
    double outlet_speed;  ///< m/s, 0 when no jet runs
    double mass_flow;     ///< kg/s
    double gas_lost;      ///< kg, since the balloon was set
    double gravity[3], buoyancy[3], drag[3], jet[3]; ///< N
    double torque[3];                                ///< N m, of the jet about the centre of mass
    double angular_velocity[3];                      ///< rad/s, I^-1 L
    double orientation[4]; ///< unit quaternion w, x, y, z, rotated by that velocity since statistics were requested
    double centre[3];      ///< m
    double jet_starts;     ///< how often the jet started
} wisp_balloon_stats;

/// Request statistics. Their passes exist from the next step on. @param requested false cancels the request
WISP_API wisp_status wisp_request_balloon_stats( wisp_world* world, wisp_entity balloon, bool requested );
/// @return WISP_CONFLICT statistics were not requested, or no step was made since
WISP_API wisp_status wisp_read_balloon_stats( wisp_world* world, wisp_entity balloon, wisp_balloon_stats* out );

WISP_END_C
