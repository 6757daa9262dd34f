/// Skeletons, skin weights and animations, as plain structs that any file format can fill.
///
/// The notions are those of glTF: joints with parents and local transforms at rest, inverse bind matrices, four joints and weights
/// per vertex, and tracks of keyframes for translation, rotation and scale of single joints.
#pragma once

#include "scene.h"

#include "wisp/skin.h"

#ifdef __cplusplus
extern "C"
{
#endif

#define WISP_SKELETON_MAX_JOINTS 4096
#define WISP_ANIMATION_MAX_KEYS 1048576

    /// A local transform: scale along the axes, then rotate, then translate.
    typedef struct wisp_joint_transform
    {
        wisp_quat rotation;    ///< unit
        wisp_vec3 translation; ///< m, from the parent's origin
        wisp_vec3 scale;       ///< 1, 1, 1 for none
    } wisp_joint_transform;

    typedef struct wisp_joint
    {
        char* name;                ///< null if it has none; belongs to the skeleton
        int32_t parent;            ///< below the own number; -1: none
        wisp_joint_transform rest; ///< relative to the parent, where no track moves it
        wisp_affine inverse_bind;  ///< from the space of the mesh to that of the joint in the bind pose; identity if
                                   ///< no vertex follows
    } wisp_joint;

    /// A hierarchy of joints, parents first. Zero-initialised is empty. Arrays are of malloc() and belong to the skeleton. Nodes of a
    /// file between joints, or above them, are joints that no vertex follows.
    typedef struct wisp_skeleton
    {
        int joint_count;
        wisp_joint* joints; ///< [joint_count]
    } wisp_skeleton;

    /// What binds the vertices of a mesh to a skeleton. Zero-initialised is empty. Arrays are of malloc().
    typedef struct wisp_skin_weights
    {
        int vertex_count;
        int32_t ( *joints )[WISP_SKIN_MAX_INFLUENCES]; ///< [vertex_count] numbers of joints of the skeleton
        float ( *weights )[WISP_SKIN_MAX_INFLUENCES];  ///< [vertex_count] >= 0, their sum above 0
    } wisp_skin_weights;

    typedef enum wisp_joint_property
    {
        WISP_JOINT_TRANSLATION, ///< three floats per value
        WISP_JOINT_ROTATION,    ///< four: x, y, z, w
        WISP_JOINT_SCALE,       ///< three
    } wisp_joint_property;

    typedef enum wisp_interpolation
    {
        WISP_INTERPOLATION_STEP, ///< the value of the keyframe before
        WISP_INTERPOLATION_LINEAR, ///< between the two keyframes; rotations along the shorter arc at uniform speed (slerp)
        WISP_INTERPOLATION_CUBIC, ///< Hermite, with the tangents of the keyframes; rotations are normalised
    } wisp_interpolation;

    /// Floats of a value.
    static inline int wisp_joint_property_width( wisp_joint_property property )
    {
        return property == WISP_JOINT_ROTATION ? 4 : 3;
    }

    /// Keyframes of one property of one joint. It replaces the value at rest. Before the first keyframe the value is that of the first,
    /// after the last that of the last.
    typedef struct wisp_animation_track
    {
        int32_t joint;
        wisp_joint_property property;
        wisp_interpolation interpolation;
        int key_count; ///< >= 1
        float* times;  ///< [key_count] s, ascending
        float* values; ///< [key_count][3 or 4]; cubic: [key_count][3][3 or 4], the tangent before, the value, the
                       ///< tangent after, in units per second
    } wisp_animation_track;

    /// A clip. Zero-initialised is empty. Arrays and the name are of malloc() and belong to it.
    typedef struct wisp_animation
    {
        char* name;     ///< null if it has none
        float duration; ///< s, > 0
        bool loops;     ///< time is taken modulo the duration; false: the last pose stays
        int track_count;
        wisp_animation_track* tracks; ///< [track_count] at most one per joint and property
    } wisp_animation;

    /// Null and zero structs are allowed; they are zero afterwards.
    void wisp_skeleton_release( wisp_skeleton* skeleton );
    void wisp_animation_release( wisp_animation* animation );

    /// @return the number of the joint with this name; -1 if there is none
    int wisp_skeleton_find( const wisp_skeleton* skeleton, const char* name );

    /// Check an animation of a skeleton: joints and properties exist, times ascend, numbers are finite, rotations are not zero, no
    /// property of a joint has two tracks.
    /// @return WISP_BAD_INPUT the message names the track and the keyframe; WISP_NO_MEMORY
    wisp_status wisp_animation_check( const wisp_animation* animation, const wisp_skeleton* skeleton,
                                      wisp_error* error );

    /// Give a track of values without tangents those of a smooth curve and make it cubic: the tangent at a keyframe is the slope
    /// between its two neighbours (Catmull and Rom 1974, for uneven times); at the ends of the track it is 0.
    /// Rotations are first turned to the same half of the quaternions as the keyframe before.
    /// @return WISP_NO_MEMORY, and the track is unchanged
    wisp_status wisp_animation_track_smooth( wisp_animation_track* track, wisp_error* error );

    /// A clip in a sequence.
    typedef struct wisp_clip
    {
        const wisp_animation* animation; ///< checked for the skeleton
        float begin, end;                ///< s, of its first keyframe and of its last one at most; end > begin
        float speed;                     ///< seconds of the clip per second, > 0
    } wisp_clip;

    /// Play clips one after the other: a clip that loops repeats until its end. Between the last keyframe of a clip and the first of the
    /// next one, joints move as between keyframes, along a smooth curve; before the first clip, from the pose at rest at 0 s.
    /// Tangents of a file are kept if there is one clip, at 0 s and at speed 1; else curves are those of
    /// wisp_animation_track_smooth().
    /// @param clips [count] one after the other in time; count >= 1
    /// @param out receives an animation that does not loop, or that of the only clip; to be released; empty on failure
    /// @return WISP_NO_MEMORY; WISP_BAD_INPUT more than WISP_ANIMATION_MAX_KEYS keyframes
    wisp_status wisp_animation_join( const wisp_clip* clips, int count, const wisp_skeleton* skeleton,
                                     wisp_animation* out, wisp_error* error );

    /// Sample a clip: the transforms of all joints at a time, in the space of the skeleton, for wisp_skin_pose_set(). The same call
    /// gives the same bits on every machine.
    /// @param animation checked for this skeleton; null: the pose at rest
    /// @param time s, finite
    /// @param joints [joint_count] output
    void wisp_skeleton_pose( const wisp_skeleton* skeleton, const wisp_animation* animation, float time,
                             wisp_affine* joints );

    /// Make the engine's skin of a mesh that a skeleton moves.
    /// @param points [weights->vertex_count] m, the bind pose
    /// @return as wisp_skin_create()
    wisp_status wisp_skeleton_skin( const wisp_skeleton* skeleton, const wisp_vec3* points,
                                    const wisp_skin_weights* weights, wisp_skin** out, wisp_error* error );

#ifdef __cplusplus
}
#endif

// ---- rig ----

#ifdef __cplusplus
extern "C"
{
#endif

    /// Zero-initialised is empty.
    typedef struct wisp_rig
    {
        wisp_skeleton skeleton;
        wisp_skin* skin;          ///< the vertices of the mesh in its bind pose, not scaled
        wisp_animation animation; ///< the clips of the scene, one after the other
    } wisp_rig;

    /// Null and zero are allowed; it is zero afterwards.
    void wisp_rig_release( wisp_rig* rig );

    /// Load the rig of a mesh, and join its clips.
    /// @param mesh a glTF file with or without a skin; without a skin, the mesh is rigid on its node
    /// @param animation which clips, and when; with `file` null the clips are those of the mesh's file
    /// @param duration s, until when the last clip repeats if it loops
    /// @param out to be released; empty on failure
    /// @return WISP_BAD_INPUT the mesh has no skeleton, there is no such clip (the message names those that there are), or a clip
    ///         does not fit the skeleton; WISP_IO_ERROR; WISP_NO_MEMORY
    wisp_status wisp_rig_load( const wisp_scene_mesh* mesh, const wisp_scene_animation* animation, float duration,
                               wisp_rig* out, wisp_error* error );

#ifdef __cplusplus
}
#endif
