// Queries on bodies, the same for closed forms and meshes, in the frame of the body.
#pragma once

#include "collision_bodies.h"
#include "collision_vectors.h"

/// Fraction of the thickness: a start that is less deep counts as on the surface.
static const float COLLISION_SHALLOW = 0.1f;
/// Of the path that a point had in the first substep: how far it may get in later ones.
static const float COLLISION_MARGIN = 1.25f;
/// Weight of a corner below which a point of a triangle is on its border.
static const float COLLISION_BORDER = 0.01f;

enum
{
    COLLISION_CHUNK = WISP_PARTICLE_BLOCK, ///< particles that are projected together
    COLLISION_SWEEPS = 4,                  ///< over several contacts of a particle
    COLLISION_ADVANCES = 16,               ///< of the conservative advancement
    COLLISION_ROW = 3 * WISP_LANES,        ///< floats of a row of vertices of a group of strands
};

/// Return a lower bound of the distance in the substep of a box in the world from the ball around the body, m; 0 for
/// a body that turns.
float collision_ball_distance( const collision_view* view, wisp_vec3 lower, wisp_vec3 upper );

/// Find the closest surface point of each query. `found` is false where nothing is within the radius, or the point is
/// not finite. Inside a body there always is one. A sheet has its normal towards the point and no negative distance.
/// @param motion [count] m, of the point in the frame of the body during the substep: zero of a rigid body. May be null
void collision_closest( const collision_view* view, const wisp_mesh_query* queries, int count,
                        wisp_surface_point* nearest, bool* found, wisp_vec3* motion );

/// Write a closed form in the substep into a lane. @param recovery m, by which what starts too near is moved out
void collision_set_shape( wisp_shape_lanes* s, int lane, const collision_view* view, float recovery );

/// What a vertex keeps of a body that is tracked.
typedef struct collision_track
{
    int32_t triangle; // that was closest; -1: none was near
    float free;       // m, at least the distance of `origin` from the body from then to the end of the step
    wisp_vec3 origin; // in the frame of the body, where this was found
} collision_track;

/// Return whether a vertex has stayed away from the body since it was searched.
static inline bool collision_is_free( const collision_track* track, wisp_vec3 point, float near )
{
    return track->free - wisp_v3_length( wisp_v3_sub( point, track->origin ) ) > near;
}

/// A query of a vertex that is tracked.
typedef struct collision_tracked_query
{
    wisp_vec3 point;
    float radius; // m, within which a surface counts
    float near;   // m, of which it comes this near to `point` in the substep
    float ahead;  // m, how far the vertex may get in later substeps: if it gets farther, it is searched again
} collision_tracked_query;

/// As collision_closest(), of vertices that keep a track of the body. In the first substep of a step the surface is searched, as
/// far as the vertex may get in the step. Later vertices that are still far are left out, and others are tracked.
/// @param tracks [count] as they were left; in the first substep only a seed is taken from them, whatever it is
/// @param seeds [count] a triangle where the search of a vertex may begin, or -1; null: where that of the vertex before ended
/// @param count at most WISP_PARTICLE_BLOCK
void collision_track_closest( const wisp_kernels* kernels, const collision_view* view,
                              const collision_tracked_query* queries, collision_track* tracks, int count,
                              bool is_first, const int32_t* seeds, wisp_surface_point* nearest, bool* found,
                              wisp_vec3* motion );

/// Find the first time in the substep at which a path enters the body, or passes the sheet from either side. The plane of a
/// surface is that at the end of the substep. @param motion m, as above @return whether it does
bool collision_cast( const collision_view* view, wisp_vec3 from, wisp_vec3 to, wisp_surface_point* hit,
                     wisp_vec3* motion );

/// Return the signed distance of a point at the start of the substep less the thickness, but no less than `gap`, m.
/// @param seed a triangle near it, or -1
float collision_exact_gap( const collision_view* view, wisp_vec3 from, int32_t seed, float gap );

/// Return the signed distance of the start of a path from a plane, less the thickness.
static inline float collision_plane_gap( const collision_view* view, const wisp_surface_point* plane, wisp_vec3 from )
{
    return wisp_v3_dot( plane->normal, wisp_v3_sub( from, plane->point ) ) - view->thickness;
}

/// Return the signed distance at the start of a path whose end meets a plane, less the thickness. Near the surface
/// the plane is good enough. Farther away the surface may be curved between start and end, so the closest point is
/// queried. @param motion of the plane in the substep, m @param seed a triangle near it, or -1
static inline float collision_start_gap( const collision_view* view, const wisp_surface_point* plane, wisp_vec3 from,
                                         wisp_vec3 motion, bool swept, int32_t seed )
{
    const float gap = collision_plane_gap( view, plane, wisp_v3_mul_add( from, 1.0f, motion ) );
    const bool is_exact = swept || gap >= -COLLISION_SHALLOW * view->thickness;
    return is_exact ? gap : collision_exact_gap( view, from, seed, gap );
}

static inline float collision_outside( float distance, float half )
{
    return collision_larger( fabsf( distance ) - half, 0.0f );
}

/// Return the distance of a point from the box around the body, m; 0 inside.
static inline float collision_box_distance( const collision_body* body, wisp_vec3 p )
{
    const wisp_vec3 d = wisp_v3_sub( p, body->centre ), half = body->half;
    return wisp_v3_length( ( wisp_vec3 ){ collision_outside( d.x, half.x ), collision_outside( d.y, half.y ),
                                          collision_outside( d.z, half.z ) } );
}
