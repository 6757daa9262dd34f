/// Skeletons and animations of glTF files in the form that all sources of them have, see skeleton.h.
#pragma once

#include "gltf.h"
#include "skeleton.h"

#ifdef __cplusplus
extern "C"
{
#endif

    /// All nodes of a model as joints, and the skin of the mesh of a node; a mesh without a skin is rigid on its node.
    /// @param name of the file in messages
    /// @param skeleton, skin to be released; empty on failure
    /// @return WISP_BAD_INPUT too many nodes, or a node whose matrix is not a scale and a rotation (the message names it);
    ///         WISP_NO_MEMORY
    wisp_status gltf_rig( const gltf_model* model, int node, const char* name, wisp_skeleton* skeleton,
                          wisp_skin** skin, wisp_error* error );

    /// An animation by its name.
    /// @param skeleton of gltf_rig(), maybe of another file: joints are then found by their names
    /// @param out to be released; empty on failure
    /// @return WISP_BAD_INPUT there is none of this name, or a joint is missing; WISP_NO_MEMORY
    wisp_status gltf_rig_animation( const gltf_model* model, const char* animation, const char* name,
                                    const wisp_skeleton* skeleton, wisp_animation* out, wisp_error* error );

#ifdef __cplusplus
}
#endif
