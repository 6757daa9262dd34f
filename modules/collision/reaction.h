// What contact gives to bodies: sums of impulses per body and part of a participant, where a part is a block of particles or a group
// of strands. Each part belongs to one worker at a time, so sums have a fixed order.
#pragma once

#include "collision_bodies.h"
#include "collision_vectors.h"

/// Return the sums of a part, [body], or null if no reaction is requested.
collision_impulse* collision_reaction_sums( wisp_frame* frame, wisp_entity participant, const collision_state* state,
                                            int part );

/// Add an impulse at x.
static inline void collision_add_at( double* sum, double jx, double jy, double jz, wisp_vec3 at )
{
    const double x = (double)at.x, y = (double)at.y, z = (double)at.z;
    sum[0] += jx;
    sum[1] += jy;
    sum[2] += jz;
    sum[3] += y * jz - z * jy;
    sum[4] += z * jx - x * jz;
    sum[5] += x * jy - y * jx;
}

/// Add the reaction to a change of position and of previous position, which gives a vertex the momentum m (dx - dx_previous) / h.
/// It acts at the previous position.
/// @param mass_over_dt kg/s
static inline void collision_add_reaction( double* sum, double mass_over_dt, wisp_vec3 from, wisp_vec3 previous_from,
                                           wisp_vec3 to, wisp_vec3 previous_to )
{
    const wisp_vec3 a = previous_from, b = previous_to;
    collision_add_at( sum, mass_over_dt * ( ( (double)from.x - (double)to.x ) - ( (double)a.x - (double)b.x ) ),
                      mass_over_dt * ( ( (double)from.y - (double)to.y ) - ( (double)a.y - (double)b.y ) ),
                      mass_over_dt * ( ( (double)from.z - (double)to.z ) - ( (double)a.z - (double)b.z ) ), b );
}

/// Add the reaction to a change of velocity of a vertex at x.
static inline void collision_add_impulse( double* sum, double mass, wisp_vec3 from, wisp_vec3 to, wisp_vec3 at )
{
    collision_add_at( sum, mass * ( (double)from.x - (double)to.x ), mass * ( (double)from.y - (double)to.y ),
                      mass * ( (double)from.z - (double)to.z ), at );
}

/// Note whether somebody asks for reactions, or a body has a mass.
void collision_note_reactions( wisp_world* world, collision_state* state );
/// Give the participants room for sums while a reaction is requested.
wisp_status collision_update_reactions( wisp_world* world, collision_state* state );
void collision_release_reactions( const wisp_allocator* allocator, collision_state* state );

// ---- bodies with a mass ----

/// Return the pose at a fraction of the step that a body has, `seconds` after its last substep, with the velocities it has.
wisp_transform collision_coupled_pose( const collision_collider* collider, const collision_coupled* coupled,
                                       float progress, float seconds );

/// What of a correction a vertex takes, along the normal and across it: the body takes the rest.
typedef struct collision_share
{
    float normal, tangential;
} collision_share;

/// Return the shares for a contact of body number `body` at a place in the rows of an entity; 1 of a body without a mass.
collision_share collision_share_of( wisp_frame* frame, const collision_state* state, int body, wisp_entity of,
                                    wisp_vec3 at, wisp_vec3 normal );
