/// What a scene animates: a mesh with its skeleton, weights and clips, of a glTF file.
#pragma once

#include "scene.h"
#include "skeleton.h"

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
