/// A surface in a cell: its start, its energy and what it shows.
#pragma once

#include "stability_starts.h"
#include "surface_implementation.h"

typedef struct stability_surface
{
    surface_implementation implementation;
    wisp_mesh mesh;
    wisp_fabric* fabric;
    wisp_vec3 *start, *seen; ///< [vertex_count] in the user's order: at first, and in the lastn observation
    double size;             ///< m
    double compliance;       ///< m/N of a link, where the constraints do not hold it themselves
    bool is_solved;          ///< by linear solves, which leave nothing to the next substep
    bool slack;              ///< too short is no strain: links only pull
    wisp_vec3 at;            ///< m, added to where it starts; pins are there, too
    int tile_size;
    /// What the user does before a step, or null.
    wisp_status ( *drive )( struct stability_surface* surface, int frame );
    /// How far something is where it must not be, or null.
    double ( *breach )( struct stability_surface* surface );
    wisp_entity body; ///< a collider, where there is one
    double taut;      ///< strain at rest of a skin that gas stretches
    bool is_pbd;      ///< constraints give way by their share alone
    /// What is stored beside links and height, J; may be null.
    double ( *stored )( struct stability_surface* surface, int frame );
} stability_surface;

/// A square of vertices that hangs in the plane z = 0 from its first row, whose corners are the pins.
wisp_status stability_hanging_mesh( int side, float spacing, wisp_mesh* out, wisp_error* error );

/// Cook the mesh, place vertices that are not pinned, and make the world.
/// @param recipe what there is beside the effect, without fabric and points
wisp_status stability_surface_enter( stability_surface* surface, const wisp_fabric_def* def,
                                     surface_generator generator, const stability_axes* axes, wisp_error* error );
void stability_surface_close( void* context );
/// Masses that grow downwards from 1 to `ratio` times what they are.
void stability_surface_weigh( stability_surface* surface, float ratio );
/// Weight of all that is not pinned, N.
double stability_surface_weight( stability_surface* surface );
/// Energy limit of a surface as it is now: a hundredth of what gravity can give, of what is stored, and what a fall
/// within one substep cannot tell.
double stability_surface_energy_limit( stability_surface* surface );

wisp_status stability_surface_step( void* context, int frame, wisp_error* error );
wisp_status stability_surface_observe( void* context, int frame, stability_observation* out, wisp_error* error );
uint64_t stability_surface_hash( void* context );
/// Limits and functions of a trial of this surface.
stability_trial stability_surface_trial( stability_surface* surface, const stability_axes* axes );
