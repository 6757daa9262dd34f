/// Skinning: points that follow bones. A skin holds the points of a mesh in its bind pose and the bones of each; it is
/// immutable, shared, and independent of any world. A pose holds the bones at one time.
///
///     wisp_skin_def def = wisp_default_skin_def();
///     def.points = points, def.bones = bones, def.weights = weights, def.point_count = point_count;
///     def.inverse_bind = inverse_bind, def.bone_count = bone_count;
///     wisp_skin* skin;
///     wisp_status status = wisp_skin_create( &def, NULL, &skin, &error ); // error.message names a wrong vertex or bone
///     wisp_skin_pose pose = { 0 };
///     wisp_compose_bones( bone_count, parents, local, model, &error );
///     wisp_skin_points( skin, &pose, WISP_SKIN_DUAL_QUATERNION, model, points_now, &error );
///     ...
///     wisp_skin_pose_release( &pose, NULL );
///     wisp_skin_release( skin );
///
/// Results are the same bits on every instruction set.
#pragma once

#include "wisp/shapes.h"

WISP_BEGIN_C

/// Most bones that a point follows.
#define WISP_SKIN_MAX_INFLUENCES 4
#define WISP_SKIN_MAX_BONES 65536
/// Points of a group.
#define WISP_SKIN_LANES 8

// ---- transforms ----

/// An affine transform: a point p goes to (m[r][0] p.x + m[r][1] p.y + m[r][2] p.z + m[r][3]) for the rows r = x, y, z. A column-major
/// matrix of 16 floats, as in glTF, has m[r][c] at 4 c + r.
typedef struct wisp_affine
{
    float m[3][4];
} wisp_affine;

/// The identity.
WISP_API wisp_affine wisp_affine_identity( void );
/// Scale along the axes, then rotate, then translate.
/// @param pose of unit rotation, see wisp_transform_make()
WISP_API wisp_affine wisp_affine_from_transform( wisp_transform pose, wisp_vec3 scale );
/// @return the transform that applies b, then a; computed in double, rounded once
WISP_API wisp_affine wisp_affine_multiply( const wisp_affine* a, const wisp_affine* b );
// ---- skins ----

/// A skin to make. Fill from wisp_default_skin_def(). Need not outlive the call.
typedef struct wisp_skin_def
{
    uint32_t size;           ///< bytes; set by wisp_default_skin_def()
    const wisp_vec3* points; ///< [point_count] m, the bind pose; finite, within 1e6 m of the origin
    const int32_t (
        *bones )[WISP_SKIN_MAX_INFLUENCES]; ///< [point_count] bones of a point; not read where the weight is 0
    const float (
        *weights )[WISP_SKIN_MAX_INFLUENCES]; ///< [point_count] >= 0; need not sum to 1, are divided by their sum
    int point_count;                          ///< 0 .. 2^26
    int bone_count;                           ///< 1 .. WISP_SKIN_MAX_BONES
    const wisp_affine*
        inverse_bind; ///< [bone_count] from the space of the points to that of the bone in the bind pose; finite; null:
                      ///< identities
} wisp_skin_def;

WISP_DEFINITION( skin_def );

typedef struct wisp_skin
{
    int point_count, bone_count;
    /// Points in groups of WISP_SKIN_LANES, sorted by the number of bones that they follow, then by number. Groups
    /// influence_begin[k] .. influence_begin[k + 1] follow k + 1 bones. The last point of a number of bones pads its last group.
    int group_count;
    int influence_begin[WISP_SKIN_MAX_INFLUENCES + 1];
    const int32_t* point;                               ///< [slot_count] the user's point
    const float* xyz;                                   ///< [group][3][8] m
    const int32_t ( *bones )[WISP_SKIN_MAX_INFLUENCES]; ///< [slot_count] bones, by weight in descending order
    const float ( *weights )[WISP_SKIN_MAX_INFLUENCES]; ///< [slot_count] sum to 1
    const wisp_affine* inverse_bind;                    ///< [bone_count], null: identities
} wisp_skin;

/// Make a skin. Copies what it needs. Influences without weight are dropped, those of one bone are added up.
/// @param allocator null: the C library; it must outlive the skin
/// @param out receives the skin, null on failure
/// @return WISP_BAD_INPUT a point or weight is not finite, a weight is negative, the weights of a point sum to 0, a bone is out of
///         range, an inverse bind transform is not finite (the message names vertex or bone), WISP_ISA names no instruction set;
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_skin_create( const wisp_skin_def* def, const wisp_allocator* allocator, wisp_skin** out,
                                       wisp_error* error );
/// Free a skin. Null is allowed.
WISP_API void wisp_skin_release( wisp_skin* skin );

// ---- poses ----

typedef enum wisp_skin_method
{
    /// The weighted mean of where each bone takes the point (Magnenat-Thalmann, Laperriere, Thalmann 1988). Volume is lost at
    /// strongly bent or twisted joints: a twist of 180 degrees between two equal weights collapses to a point.
    WISP_SKIN_LINEAR = 0,
    /// The normalised weighted mean of unit dual quaternions (Kavan, Collins, Zara, O'Sullivan 2008, eq. 17-19): rigid motions only,
    /// and the mean is rigid too, so that joints keep their girth, but bulge when they bend.
    WISP_SKIN_DUAL_QUATERNION = 1,
    WISP_SKIN_METHOD_COUNT = 2,
} wisp_skin_method;

/// A bone times its inverse bind transform may differ from a rigid motion by this much in products of its axes.
#define WISP_SKIN_RIGID_TOLERANCE 1e-4f

/// Bones at one time, prepared for a method. Zero-initialised is empty; keeps its memory between uses.
typedef struct wisp_skin_pose
{
    wisp_skin_method method;
    int bone_count;
    const float*
        rows; ///< [bone_count][16] linear: three rows of the matrix, then zeros; dual quaternions: real part x, y, z, w,
              ///< dual part likewise, then zeros
    wisp_buffer buffer;
} wisp_skin_pose;

/// Prepare bones: multiply each by its inverse bind transform.
/// @param bones [skin->bone_count] from the space of the bone to that of the output
/// @param allocator null: the C library. Allocates only when the skin has more bones than any before
/// @return WISP_BAD_INPUT a matrix is not finite, or for dual quaternions not a rotation with a translation once it is multiplied by
///         its inverse bind transform (the message names the bone), or an unknown method; WISP_NO_MEMORY. The pose is unchanged then
WISP_API wisp_status wisp_skin_pose_set( wisp_skin_pose* pose, const wisp_skin* skin, wisp_skin_method method,
                                         const wisp_affine* bones, const wisp_allocator* allocator,
                                         wisp_error* error );
WISP_API void wisp_skin_pose_release( wisp_skin_pose* pose, const wisp_allocator* allocator );

/// Prepare bones and compute all points on the calling thread.
/// @param pose keeps its memory between calls, of the C library
/// @param out [point_count] m, in the user's order; unchanged on failure
/// @return as wisp_skin_pose_set()
WISP_API wisp_status wisp_skin_points( const wisp_skin* skin, wisp_skin_pose* pose, wisp_skin_method method,
                                       const wisp_affine* bones, wisp_vec3* out, wisp_error* error );

WISP_END_C
