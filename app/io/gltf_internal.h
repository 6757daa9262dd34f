/// Private to the glTF files.
#pragma once

#include "gltf.h"
#include "skeleton.h"

#ifdef __cplusplus
extern "C"
{
#endif

    /// gltf_parse.cc, through tinygltf: bytes that gltf.c has checked become a model whose numbers are
    /// within their arrays and finite.
    /// @param folder of other buffers, null: refused
    wisp_status gltf_parse( const void* bytes, size_t size, bool is_binary, const char* folder, const char* name,
                            gltf_model* out, wisp_error* error );

    /// Bytes of a component type of accessors; 0: it is not read.
    size_t gltf_component_size( int type );

    /// A component of such a type. @param is_normalized integers become -1 .. 1 or 0 .. 1
    double gltf_component( const unsigned char* at, int type, bool is_normalized );

    /// Scale a rotation to length 1. @return false: it is zero
    bool gltf_normalize( double q[4] );

    /// Whether a required extension changes nothing that is read.
    bool gltf_is_harmless( const char* extension );

    /// Whether a path is that of an image.
    bool gltf_is_image( const char* path );

    /// Read a buffer in a folder or below. @return WISP_BAD_INPUT it is elsewhere, or too long; WISP_IO_ERROR
    wisp_status gltf_read_beside( const char* folder, const char* path, unsigned char** bytes, size_t* size,
                                  wisp_error* error );

    /// gltf.c: merge vertices of exactly equal position, joints and weights; the first stays.
    wisp_status gltf_merge_seams( gltf_mesh* mesh, const char* name, wisp_error* error );

    /// The value of a channel at a time. @param out [channel->width]
    void gltf_sample( const gltf_channel* channel, double time, double* out );

    /// product = a * b, rows of 3 x 4 matrices.
    void gltf_multiply( const double a[12], const double b[12], double product[12] );

#ifdef __cplusplus
}
#endif

// ---- gltf rig ----

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
