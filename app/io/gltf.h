/// glTF 2.0 (Khronos 2021) in: meshes, node hierarchy, skins and animations, of .glb and .gltf files. Materials, images,
/// cameras, lights and extras are skipped. Untrusted bytes: bounded and checked; every error names its element.
#pragma once

#include "io_file.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C"
{
#endif

/// Bytes of the longest JSON part that is read, and its deepest nesting.
#define GLTF_JSON_CAP ( (size_t)1 << 26 )
#define GLTF_DEPTH_CAP 64
/// Most nodes, meshes, skins and animations, each.
#define GLTF_ELEMENT_CAP 65536

    /// A node of the hierarchy with its local transform at rest.
    typedef struct gltf_node
    {
        char* name;            ///< "node 3" where the file gives none
        int parent;            ///< -1: none
        int mesh, skin;        ///< -1: none
        bool has_matrix;       ///< the file gives a matrix, which animations do not change
        double translation[3]; ///< m
        double rotation[4];    ///< unit quaternion x, y, z, w
        double scale[3];
        double matrix[12]; ///< rows of a 3 x 4 matrix, with has_matrix
        double* weights;   ///< [weight_count] of morph targets at rest; null: those of the mesh
        int weight_count;
    } gltf_node;

    /// All triangles of a mesh: its primitives joined.
    typedef struct gltf_mesh
    {
        char* name;                  ///< "mesh 3" where the file gives none
        wisp_mesh mesh;              ///< in the frame of the node, or the bind pose of a skin
        int32_t* joints;             ///< [vertex_count][4] indices into the joints of the skin; or null
        float* weights;              ///< [vertex_count][4] >= 0, of sum 1, largest first; or null
        int primitive_count;         ///< that were joined
        int skipped_count;           ///< primitives of points and lines
        int merged_count;            ///< vertices merged into an earlier one
        int dropped_influence_count; ///< vertices with more than four weights, of which the largest are kept
        int target_count;            ///< morph targets
        char** target_names;         ///< [target_count] "target 3" where the file gives none
        float* targets;              ///< [target_count][vertex_count][3] m, displacements at weight 1
        double* weights_at_rest;     ///< [target_count]
    } gltf_mesh;

    typedef struct gltf_skin
    {
        char* name;
        int joint_count;
        int32_t* joints;      ///< [joint_count] nodes
        double* inverse_bind; ///< [joint_count][12] rows of 3 x 4 matrices: from bind pose to joint
    } gltf_skin;

    typedef enum gltf_path
    {
        GLTF_TRANSLATION,
        GLTF_ROTATION,
        GLTF_SCALE,
        GLTF_WEIGHTS,
    } gltf_path;

    typedef enum gltf_interpolation
    {
        GLTF_STEP,
        GLTF_LINEAR,
        GLTF_CUBICSPLINE,
    } gltf_interpolation;

    /// Keys of a property of a node, or of the weights of its morph targets.
    typedef struct gltf_channel
    {
        int node, sampler;
        gltf_path path;
        gltf_interpolation interpolation;
        int width;     ///< numbers of a value
        int key_count; ///< >= 1
        double* times; ///< [key_count] s, >= 0, rising; of weights may be those of an earlier channel
        double*
            values; ///< [key_count][width]; of cubic splines [key_count][3][width]: in-tangent, value, out-tangent; likewise
    } gltf_channel;

    typedef struct gltf_animation
    {
        char* name;
        int channel_count;
        int skipped_count; ///< channels without a node, and those of weights of a node without morph targets
        gltf_channel* channels;
        int weights_count;
        gltf_channel* weights;
        double duration; ///< s, time of the last key
    } gltf_animation;

    /// A file. Zero-initialised is empty. Everything belongs to the model.
    typedef struct gltf_model
    {
        int node_count, mesh_count, skin_count, animation_count;
        gltf_node* nodes;
        int32_t* order; ///< [node_count] nodes, parents before children
        gltf_mesh* meshes;
        gltf_skin* skins;
        gltf_animation* animations;
        io_memory memory; ///< of all that is in it
    } gltf_model;

    /// Null and a zero model are allowed; the model is zero afterwards.
    void gltf_release( gltf_model* model );

    enum
    {
        GLTF_KEEP_SEAMS =
            1, ///< do not merge vertices; else vertices of exactly equal position and skin weights become
               ///< one, because files split them where normals or texture coordinates differ
    };

    /// Read a file. A .gltf may name buffers beside it, in its folder or below.
    /// @param out receives the model, to be released by the caller; empty on failure
    /// @return WISP_IO_ERROR; WISP_BAD_INPUT the message names the element; WISP_NO_MEMORY
    wisp_status gltf_read( const char* path, int flags, gltf_model* out, wisp_error* error );

    /// Read bytes. @param folder of other buffers, null: they are refused @param name of the file in messages
    wisp_status gltf_read_bytes( const void* bytes, size_t size, const char* folder, const char* name, int flags,
                                 gltf_model* out, wisp_error* error );

    /// Find the node with a mesh of this name: that of the node, else that of its mesh. Null: the only one.
    /// @return WISP_BAD_INPUT none or several; the message names those that there are
    wisp_status gltf_find_mesh( const gltf_model* model, const char* wanted, const char* name, int* node,
                                wisp_error* error );

    /// The triangles of a node in the frame of the model: placed by its hierarchy, or by its skin, at rest.
    /// @param out receives a copy, to be released; empty on failure
    wisp_status gltf_mesh_at_rest( const gltf_model* model, int node, const char* name, wisp_mesh* out,
                                   wisp_error* error );

    /// What a mesh looks like: at rest, at a time of an animation, or with one morph target alone.
    typedef struct gltf_moment
    {
        int animation; ///< -1: at rest
        double time;   ///< s; before the first key and after the last the pose stays
        int target;    ///< its weight is 1 and all others are 0; -1: weights at rest, or of the animation
    } gltf_moment;

    /// The triangles of a node at a moment: morphed, then placed as gltf_mesh_at_rest() does (glTF 2.0, section 3.7.2.2).
    wisp_status gltf_mesh_at( const gltf_model* model, int node, gltf_moment moment, const char* name, wisp_mesh* out,
                              wisp_error* error );

    /// Doubles of work for gltf_points_at().
    size_t gltf_points_work( const gltf_model* model, int node );

    /// The vertices alone; they may overflow. Does not allocate. @param work [gltf_points_work()] @param out [vertex_count] m
    void gltf_points_at( const gltf_model* model, int node, gltf_moment moment, double* work, wisp_vec3* out );

    /// Weights of the morph targets of a node. @param out [target_count of its mesh]
    void gltf_weights_at( const gltf_model* model, int node, gltf_moment moment, double* out );

    /// Find the time at which an animation has a morph target of a node alone, at weight 1, at a key. @return s; -1: never
    double gltf_target_time( const gltf_model* model, int node, int animation, int target );

    /// Whether a path ends in .glb or .gltf, maybe with # and a name behind.
    bool gltf_is_path( const char* path );

    /// Read a file and find one mesh. @param path of a file, and maybe # and the name of a node or mesh
    /// @param out receives the model, to be released; empty on failure @param node receives the node with the mesh
    wisp_status gltf_model_read( const char* path, gltf_model* out, int* node, wisp_error* error );

    /// Read a file and take one mesh. @param path of a file, and maybe # and the name of a node or mesh, and maybe @ and a
    /// time of the first animation in s, or the name of a morph target: `take.glb#cloth@1.5`, `take.glb#@frame_0002`
    /// @return also WISP_BAD_INPUT there is no animation, or no such morph target (the message names some)
    wisp_status gltf_mesh_read( const char* path, wisp_mesh* out, wisp_error* error );

    /// Doubles of work for gltf_pose(). @return node_count * 22
    size_t gltf_pose_work( const gltf_model* model );

    /// Pose a skin: global transform of each joint times its inverse bind matrix (glTF 2.0, section 3.7.3.3). Does not
    /// allocate; threads may share the model.
    /// @param animation -1: rest
    /// @param time s; before the first key of a channel and after the last its value stays
    /// @param work [gltf_pose_work()]
    /// @param matrices [joint_count][12] receives rows of 3 x 4 matrices in the frame of the model
    void gltf_pose( const gltf_model* model, int skin, int animation, double time, double* work, double* matrices );

    /// Global transforms of all nodes likewise. @param work as above @return [node_count][12] in `work`
    const double* gltf_pose_nodes( const gltf_model* model, int animation, double time, double* work );

    /// Find an animation. @return -1: none of this name
    int gltf_find_animation( const gltf_model* model, const char* animation );

    /// Print the text of `wisp info`: nodes with meshes, skins and animations, then each mesh as wisp_mesh_info().
    wisp_status gltf_info( FILE* out, const gltf_model* model, const char* name );

#ifdef __cplusplus
}
#endif
