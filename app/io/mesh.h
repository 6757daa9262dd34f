/// Triangle meshes of the user: vertices and triangles in the order of the file, never reordered. Reading, writing,
/// generating, examining, repairing and describing them.
///
///     format  read  write  what it is
///     .obj    yes   yes    Wavefront OBJ: positions, faces, colours and texture coordinates; all else is skipped
///     .ply    yes   yes    Stanford PLY: text, little-endian and big-endian in, little-endian out; the same contents
///
/// Files are untrusted bytes: memory is allocated only after the file is known to be long enough to fill it. Readers
/// reject malformed, out-of-range and non-finite values. A well-formed mesh with defects (holes, reversed triangles,
/// triangles without area) is accepted, so that wisp_mesh_examine() can report them.
#pragma once

#include <math.h>
#include <stdio.h>

#include "wisp/base.h"

#ifdef __cplusplus
extern "C"
{
#endif

    /// A triangle mesh. Zero-initialised is empty. Arrays belong to the mesh.
    typedef struct wisp_mesh
    {
        wisp_vec3* points;  ///< [vertex_count] m, finite
        int32_t* triangles; ///< [triangle_count][3] indices into points, counter-clockwise seen from outside
        int vertex_count;
        int triangle_count;
        wisp_vec3* colours; ///< [vertex_count] red, green, blue as in the file, usually 0..1; finite; or null
        float* uvs;         ///< [vertex_count][2] texture coordinates, (0, 0) at the lower left; finite; or null
        int colour_missing_count; ///< vertices whose colour the file lacks, while others have one: they are white
        int uv_missing_count;     ///< vertices whose coordinates the file lacks, while others have some: (0, 0)
        int uv_seam_count;        ///< vertices with several coordinates in the file, of which the first are kept
    } wisp_mesh;

    /// Null and a zero mesh are allowed; the mesh is zero afterwards.
    WISP_API void wisp_mesh_release( wisp_mesh* mesh );

    /// Distance of two points, m. In double precision, since that of two finite floats may overflow a float.
    static inline double wisp_mesh_distance( wisp_vec3 a, wisp_vec3 b )
    {
        const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
        return sqrt( x * x + y * y + z * z );
    }

/// Bytes of the longest file that is read.
#define WISP_MESH_FILE_CAP ( (size_t)1 << 31 )

/// Limit of vertices and triangles of a mesh that is read or generated.
#define WISP_MESH_VERTEX_CAP ( 1 << 26 )
#define WISP_MESH_TRIANGLE_CAP ( 1 << 27 )

/// Limit of corners of a polygon in a file.
#define WISP_MESH_CORNER_CAP 65536

    // ---- files ----

    /// Read a file; its name decides on the format.
    /// @param out receives the mesh, to be released by the caller; empty on failure
    /// @return WISP_IO_ERROR an error of the operating system; WISP_BAD_INPUT the message names the file, and the
    ///        line,
    ///         byte, vertex or face; WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_read( const char* path, wisp_mesh* out, wisp_error* error );

    /// Read the bytes of an OBJ file. A `v` line has 3, 4, 6 or 7 numbers: the first three are the position, and of
    /// 6 or 7 the last three the colour. Face corners are v, v/t, v//n or v/t/n; negative ones count backwards from
    /// the last vertex before the line. A polygon is cut into a fan around its first corner, which is right for convex
    /// ones. A vertex keeps the first texture coordinates of its corners; an index without a `vt` line gives none.
    /// Normal indices are only checked for syntax. Every other line is skipped.
    /// @param name of the file in messages
    WISP_API wisp_status wisp_mesh_read_obj( const void* bytes, size_t size, const char* name, wisp_mesh* out,
                                             wisp_error* error );

    /// Read the bytes of a PLY file: x, y, z of `vertex` and the list vertex_indices or vertex_index of `face`, of
    /// any type; if there, red, green, blue of `vertex` (integers are 0..255, of 16 bits without sign 0..65535) and s, t
    /// or u, v or texture_u, texture_v. Other elements and properties are skipped. In text, a row is a line. Polygons
    /// are cut into fans as in OBJ. Only white space may follow the last element.
    /// @param name of the file in messages
    WISP_API wisp_status wisp_mesh_read_ply( const void* bytes, size_t size, const char* name, wisp_mesh* out,
                                             wisp_error* error );

    /// Make a mesh of arrays, checked as those of files are, without colours and texture coordinates.
    /// @param points [vertex_count] m @param triangles [triangle_count][3]
    /// @param name of the mesh in messages
    /// @param out receives a copy, to be released by the caller; empty on failure
    /// @return WISP_BAD_INPUT the mesh is empty, a coordinate is not finite or a corner is out of range; WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_of_arrays( const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                                              int triangle_count, const char* name, wisp_mesh* out,
                                              wisp_error* error );

    /// Write a file in the format of its extension: OBJ with nine digits, which restore every
    /// float bit for bit, or little-endian PLY, whose colours are bytes if that loses nothing, else floats. The old
    /// file, if there is one, is replaced only when the new one is complete.
    /// @return WISP_BAD_INPUT the mesh is malformed or not finite, or the extension is unknown; WISP_IO_ERROR;
    ///         WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_write( const char* path, const wisp_mesh* mesh, wisp_error* error );

    // ---- points on a mesh ----

    /// Points on the edges of a mesh and inside its triangles.
    typedef struct wisp_mesh_layer
    {
        const wisp_vec3* normals; ///< [vertex_count] of the mesh; unit, or zero where there is none
        const int32_t* edges;     ///< [edge_count][2] vertices
        int edge_count;
        const float* points;        ///< [point_count][4] m; the fourth is the element as int bits: an edge, or
                                    ///< edge_count + a triangle
        const float* point_normals; ///< [point_count][4] unit; the fourth is not read
        int point_count;
    } wisp_mesh_layer;

    /// Write a mesh with points on it as little-endian PLY: the vertices, then the points, each with its normal (nx,
    /// ny, nz) and the number of its element, which is -1 for a vertex; the triangles; the edges as vertex1 and
    /// vertex2. Reading it gives a mesh with unreferenced vertices.
    /// @return as wisp_mesh_write(); also WISP_BAD_INPUT an invalid point, normal or element (the message names it)
    ///         names it)
    WISP_API wisp_status wisp_mesh_write_layer( const char* path, const wisp_mesh* mesh, const wisp_mesh_layer* layer,
                                                wisp_error* error );

    // ---- generators ----

    typedef enum wisp_mesh_shape
    {
        WISP_MESH_PLANE_REGULAR,     ///< every diagonal from (i, j) to (i + 1, j + 1)
        WISP_MESH_PLANE_ALTERNATING, ///< the same where i + j is even, the other diagonal where it is odd
        WISP_MESH_PLANE_IRREGULAR,   ///< shifted at random, then Delaunay
        WISP_MESH_DELAUNAY,          ///< a rectangle by wisp_mesh_generate_flat(): no rows, varying valences
        WISP_MESH_GARMENT,           ///< the front panel of a shirt likewise, denser at armholes and neckline
        WISP_MESH_ICOSPHERE,         ///< 10 * 4^level + 2 vertices
        WISP_MESH_UV_SPHERE,
        WISP_MESH_TORUS,
        WISP_MESH_CAPSULE, ///< a cylinder along y between two half spheres
        WISP_MESH_TUBE,    ///< a cylinder along y without ends
        WISP_MESH_PEAR,    ///< closed, genus 0, a single mirror symmetry: an icosphere tapered, bent and flattened
        WISP_MESH_SHAPE_COUNT
    } wisp_mesh_shape;

    /// A mesh to generate. Fill from wisp_default_mesh_generator().
    typedef struct wisp_mesh_generator
    {
        wisp_mesh_shape shape;
        int columns;         ///< >= 2, vertices of a plane along x
        int rows;            ///< >= 2, vertices of a plane along z; vertex (i, j) has the number j * columns + i
        int vertex_count;    ///< irregular plane: how many in all, spread over the rows, each at least 2; 0 is
                             ///< columns * rows; Delaunay rectangle (>= 4) and garment (>= 64): how many in all
        int level;           ///< 0..10, of icosphere and pear
        int segments;        ///< >= 3, around the axis y of the round shapes
        int rings;           ///< from pole to pole of a UV sphere (>= 2), from pole to cylinder of a capsule (>= 1),
                             ///< around the tube of a torus (>= 3)
        int length_segments; ///< >= 1, along the cylinder of capsule and tube
        float spacing;       ///< m, > 0, between the vertices of a plane
        float jitter;        ///< 0..0.2, irregular plane: farthest shift in x and in z, in spacings
        float radius;      ///< m, > 0, of sphere, capsule and tube, of a torus's centre line, of the pear's icosphere
        float tube_radius; ///< m, > 0 and < radius, of a torus
        float lower_radius; ///< m, of a tube at its lower end; 0: as `radius`
        float length;       ///< m, > 0, of the cylinder of capsule and tube
        float width;        ///< m, > 0, of Delaunay rectangle and garment along x
        float depth;        ///< m, > 0, of the same along z, within a thousandth and a thousand times of the width
        uint64_t seed;      ///< of the shifts, and of the vertices inside Delaunay rectangle and garment
    } wisp_mesh_generator;

    /// Planes of 32 x 32 vertices 2 cm apart; round shapes of radius 0.5 m with some thousand triangles; Delaunay
    /// pieces of 958 vertices in a square of 1 m x 1 m or a shirt of 0.55 m x 0.7 m.
    WISP_API wisp_mesh_generator wisp_default_mesh_generator( wisp_mesh_shape shape );

    /// Generate a mesh around the origin. Planes are in y = 0 with normals along +y; closed shapes and the tube have
    /// outward normals. The same definition gives the same bits on every machine.
    /// @return WISP_BAD_INPUT the message names the invalid value; WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_generate( const wisp_mesh_generator* generator, wisp_mesh* out,
                                             wisp_error* error );

    /// A corner of a flat piece, and the straight edge from there to the next one.
    typedef struct wisp_mesh_corner
    {
        float x, z;    ///< m
        float density; ///< 1..16, factor of the density of vertices on the edge
    } wisp_mesh_corner;

    /// Generate a flat piece of any outline in y = 0 with normals along +y, with exactly this number of vertices:
    /// evenly along the border and at random, well spaced, inside, joined by a Delaunay triangulation within the
    /// border. The border comes first, corner 0 being vertex 0; the inside follows along Hilbert's curve. If the
    /// densities require more border vertices than there are vertices, all edges get fewer. The same call gives the
    /// same bits on every machine.
    /// @param corners [corner_count] counter-clockwise seen from above, where +y points at the viewer, x to the
    ///                right and z down; without intersections or contact with itself
    /// @param corner_count >= 3
    /// @param vertex_count >= corner_count
    /// @return WISP_BAD_INPUT the message names the corner, or the value; WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_generate_flat( const wisp_mesh_corner* corners, int corner_count, int vertex_count,
                                                  uint64_t seed, wisp_mesh* out, wisp_error* error );

    // ---- pairs ----

    /// Pairs of vertices of a grid whose vertex (i, j) has the number j * columns + i, as in a plane: each pair once.
    typedef struct wisp_quad_pairs
    {
        int32_t* stretch; ///< [stretch_count][2] first neighbours: horizontal, vertical and on both diagonals
        int32_t* bend;    ///< [bend_count][2] second neighbours: two apart in the same directions
        int stretch_count;
        int bend_count; ///< 0 where both sides have two vertices
    } wisp_quad_pairs;

    /// The links of cloth made of quads (Choi and Ko), for example of a plane as a grid of vertices without its
    /// triangles.
    /// @param columns, rows each >= 2, at most WISP_MESH_VERTEX_CAP vertices
    /// @param out receives the pairs, to be released; empty on failure
    /// @return WISP_BAD_INPUT too few or too many vertices; WISP_NO_MEMORY
    WISP_API wisp_status wisp_quad_pairs_make( int columns, int rows, wisp_quad_pairs* out, wisp_error* error );

    /// Null and zero pairs are allowed; the struct is zero afterwards.
    WISP_API void wisp_quad_pairs_release( wisp_quad_pairs* pairs );

    // ---- the doctor ----

/// Limit of elements of one kind that a report lists; the others are counted.
#define WISP_MESH_LISTED 8

    /// One kind of defect. `first` and `second` are: of an edge its two vertices; of a duplicate the triangle and the
    /// earlier one that it repeats; of a vertex its index and the number of its fans; else the index and 0.
    typedef struct wisp_mesh_finding
    {
        int count;
        int first[WISP_MESH_LISTED];
        int second[WISP_MESH_LISTED];
    } wisp_mesh_finding;

    /// Triangles connected by edges.
    typedef struct wisp_mesh_component
    {
        int first_triangle; ///< the lowest number
        int triangle_count;
        bool closed;     ///< every edge has an even number of triangles, at least two
        bool consistent; ///< equal numbers of triangles in both directions along each edge of two or more
        double area;     ///< m^2
        double volume;   ///< m^3, negative inside out; 0 unless closed and consistent
    } wisp_mesh_component;

    typedef struct wisp_mesh_diagnostics
    {
        int vertex_count, triangle_count, edge_count;
        int euler_characteristic; ///< vertices in use - edges + triangles: sphere 2, torus 0, disc 1
        int open_loop_count;      ///< connected components of the open edges
        int component_count;
        wisp_mesh_component components[WISP_MESH_LISTED]; ///< the first ones
        bool closed;                                      ///< all shells are
        double area, volume;                              ///< sums over all shells
        wisp_vec3 lowest, highest;                        ///< bounds of all vertices, m
        double min_edge, edge_mean, max_edge;             ///< m, lengths of edges

        bool has_colours, has_uvs;
        wisp_vec3 lowest_colour, highest_colour; ///< of each channel
        float lowest_uv[2], highest_uv[2];
        int colour_missing_count, uv_missing_count, uv_seam_count; ///< as in wisp_mesh

        wisp_mesh_finding open_edges;           ///< edges of one triangle
        wisp_mesh_finding windings;             ///< edges whose two triangles run along them the same way
        wisp_mesh_finding inside_out;           ///< closed consistent shells of negative volume
        wisp_mesh_finding nonmanifold_edges;    ///< edges of three or more triangles
        wisp_mesh_finding nonmanifold_vertices; ///< vertices where more than one fan of triangles meets
        wisp_mesh_finding duplicates;           ///< triangles with the vertices of an earlier one, in any order
        wisp_mesh_finding degenerates;          ///< triangles with a repeated vertex or without area
        wisp_mesh_finding unreferenced;         ///< unreferenced vertices
    } wisp_mesh_diagnostics;

/// A triangle has no area when its height is at most this fraction of its longest edge, the size of float rounding.
#define WISP_MESH_FLAT 1e-7

    /// Examine a mesh. Triangles with a repeated vertex count as degenerate and as nothing else. Time is linear in
    /// the number of elements, also for hostile meshes.
    /// @return WISP_BAD_INPUT the mesh is malformed (an index out of range) or not finite, the message names the
    ///        element; WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_examine( const wisp_mesh* mesh, wisp_mesh_diagnostics* report, wisp_error* error );

    /// Demands on a mesh, or-ed.
    enum
    {
        WISP_MESH_CLOSED = 1,
        WISP_MESH_ORIENTED = 2, ///< consistent winding, no shell inside out
        WISP_MESH_MANIFOLD = 4, ///< no edge of three triangles, no vertex of two fans
        WISP_MESH_CLEAN = 8,    ///< no duplicate, degenerate or unreferenced element
        WISP_MESH_ONE_COMPONENT = 16,
    };

    /// Reject a mesh that does not meet the demands.
    /// @param name of the mesh in messages
    /// @return WISP_BAD_INPUT the message names the first element with a defect
    WISP_API wisp_status wisp_mesh_require( const wisp_mesh_diagnostics* report, int demands, const char* name,
                                            wisp_error* error );

    /// Permitted repairs of wisp_mesh_repair(), or-ed. Done in this order: weld, degenerates, duplicates, winding, flip,
    /// unreferenced.
    enum
    {
        WISP_MESH_DROP_DEGENERATES = 1,
        WISP_MESH_DROP_DUPLICATES = 2, ///< the first of equals stays
        WISP_MESH_TURN_TRIANGLES =
            4, ///< flood fill over edges of two triangles; closed pieces then look outwards, open
               ///< ones keep the winding that most of their triangles have
        WISP_MESH_DROP_UNREFERENCED = 8,
        WISP_MESH_REPAIR_ALL = 15,
        WISP_MESH_WELD = 16, ///< merge vertices near an earlier one into it, and remove the triangles that collapse
        WISP_MESH_FLIP = 32, ///< turn all triangles, so that the mesh is inside out
    };

/// Distance of WISP_MESH_WELD unless another is given, in longest sides of the bounds.
#define WISP_MESH_WELD_FRACTION 1e-5

    /// The repairs that were done. Release with wisp_mesh_repairs_release().
    typedef struct wisp_mesh_repairs
    {
        int degenerates_dropped;
        int duplicates_dropped;
        int triangles_turned;
        int unreferenced_dropped;
        int32_t* kept; ///< [kept_count] original index of each vertex that is kept, ascending
        int kept_count;
        int vertices_welded;   ///< merged into an earlier one
        int collapsed_dropped; ///< triangles of which two corners were merged
        int triangles_flipped; ///< by WISP_MESH_FLIP
        int32_t* became;    ///< [original_count] index in the repaired mesh of each original vertex, of a merged one
                            ///< that of the vertex it became; -1: it was removed
        int original_count; ///< vertices before the repair
    } wisp_mesh_repairs;

    /// Null and zero repairs are allowed; the struct is zero afterwards.
    WISP_API void wisp_mesh_repairs_release( wisp_mesh_repairs* repairs );

    /// Repair a mesh in place. The remaining elements keep their order. Removing a triangle without area may open a
    /// border: examine again.
    /// @param weld_distance m, of WISP_MESH_WELD, at least a billionth of the longest side of the bounds; 0:
    ///        WISP_MESH_WELD_FRACTION of it. A vertex within it of an earlier one that stays becomes the lowest of those, with its
    ///        position, colour and texture coordinates; vertices that stay do not move. Time is n log n for n vertices.
    /// @param repairs receives the repairs; empty on failure
    /// @return WISP_BAD_INPUT malformed, or with WISP_MESH_TURN_TRIANGLES one-sided like a Moebius strip (the message
    ///        names the edge where the flood meets itself), or nothing would be left; WISP_NO_MEMORY; the mesh is
    ///        unchanged
    WISP_API wisp_status wisp_mesh_repair( wisp_mesh* mesh, int what, float weld_distance, wisp_mesh_repairs* repairs,
                                           wisp_error* error );

    /// Count the vertices that WISP_MESH_WELD merges into others: those of a renderer are split along seams, and what looks
    /// joined is open. @return WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_count_near( const wisp_mesh* mesh, int* out, wisp_error* error );

    // ---- text ----

    /// Print a message for each repair that was done, or one that none was needed.
    WISP_API void wisp_mesh_print_repairs( FILE* out, const wisp_mesh_repairs* repairs, const char* name );

    /// Examine and print.
    /// @return WISP_BAD_INPUT the mesh is malformed or not finite, which is then the only thing printed;
    ///         WISP_NO_MEMORY
    WISP_API wisp_status wisp_mesh_info( FILE* out, const wisp_mesh* mesh, const char* name );

#ifdef __cplusplus
}
#endif
