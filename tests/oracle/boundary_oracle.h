/// Boundary particles in plain double precision: a layer of points on a triangle mesh, on its edges and inside its
/// triangles, and the balloon of position based dynamics that carries it.
///
/// Sections are those of the README "Position Based Dynamics Cloth Balloons with Boundary
/// Particles", as docs/methods.md resolves what it leaves open or misprints. SI units. Nothing
/// here is optimised.
#pragma once

#include "balloon_meshes.h"
#include "constraint_oracle.h"
#include "wisp/base.h"

// ---- switches ----

/// How points are placed on an edge or a line.
typedef enum boundary_oracle_policy
{
    BOUNDARY_ORACLE_EVEN,  ///< n equal parts, points between them, as the program does (default)
    BOUNDARY_ORACLE_EXACT, ///< i d from the first end, i = 1..n, none on the second end, as the README prints
    BOUNDARY_ORACLE_POLICY_COUNT,
} boundary_oracle_policy;

/// How L / d is rounded to n.
typedef enum boundary_oracle_rounding
{
    BOUNDARY_ORACLE_DOWN,    ///< floor, as printed (default)
    BOUNDARY_ORACLE_NEAREST, ///< halves round up
    BOUNDARY_ORACLE_UP,      ///< no gap of even spacing is above d
    BOUNDARY_ORACLE_ROUNDING_COUNT,
} boundary_oracle_rounding;

/// What an inner normal is interpolated from.
typedef enum boundary_oracle_normals
{
    BOUNDARY_ORACLE_BARYCENTRIC, ///< the three vertex normals by the three weights (default)
    BOUNDARY_ORACLE_SCANLINE,    ///< interpolated twice: at the two ends of the line, then between those
} boundary_oracle_normals;

// ---- counts and places on an edge or a line ----

/// round( length / d ), >= 0.
int boundary_oracle_count( double length, double d, boundary_oracle_rounding rounding );

/// Hysteresis: true if a count may stay, because length / d is within `hysteresis` of the interval with that count.
bool boundary_oracle_may_stay( int count, double length, double d, boundary_oracle_rounding rounding,
                               double hysteresis );

/// Number of points for a count: even n - 1, exact those of i = 1..n with i d < length - 1e-6 d; never negative.
int boundary_oracle_points( int n, double length, double d, boundary_oracle_policy policy );

/// Position of point i as a fraction of the length: i / n, or i d / length.
double boundary_oracle_fraction( int i, int n, double length, double d, boundary_oracle_policy policy );

// ---- lines inside a triangle ----

/// The shortest edge of a triangle and its height.
typedef struct boundary_oracle_axis
{
    int edge;       ///< local: from corner `edge` to the next one; the lowest of equals
    int a, b, c;    ///< local corners: ends of that edge in the triangle's order, and the one across
    double base;    ///< |b - a|, m
    double height;  ///< h, m; 0 when the base has no length
    double3 along;  ///< s = (b - a) / |b - a|, 0 without a length
    double3 foot;   ///< f, below c on the line of the base
    double3 upward; ///< u / |u|, 0 without a height
} boundary_oracle_axis;

/// Axis and height: u = (c - a) - ((c - a).s) s, h = |u|.
boundary_oracle_axis boundary_oracle_axis_of( const double3 corner[3] );

/// The same on a given edge.
boundary_oracle_axis boundary_oracle_axis_on( const double3 corner[3], int edge );

/// The height as printed: dot( s, a ), which depends on the origin.
double boundary_oracle_height_printed( const boundary_oracle_axis* axis, const double3 corner[3] );

/// Length of line k of nt, m: base (1 - q), where q is its fraction of the height.
double boundary_oracle_line_length( double base, double q );

/// Weights of the point at fraction r of the line at fraction q: (1 - q)(1 - r) on a, (1 - q) r on b, q on c.
/// @param weight receives them in the triangle's own order of corners
void boundary_oracle_weights( const boundary_oracle_axis* axis, double q, double r, double weight[3] );

/// Barycentric weights of a place from areas of sub-triangles, the printed form of the same. @return false without area
bool boundary_oracle_weights_by_area( const double3 corner[3], double3 y, double weight[3] );

// ---- normals ----

/// Unit vertex normals: the normalised mean of the unit normals of incident faces. A face without area, or with a
/// corner that is not finite, adds nothing. A vertex without faces, or whose normals cancel (below 1e-12), has 0.
void boundary_oracle_vertex_normals( const double3* x, int vertex_count, const int* triangles, int triangle_count,
                                     double3* normal );

/// v / |v|, and 0 where |v| < 1e-12.
double3 boundary_oracle_unit( double3 v );

/// Unit normal of a face, 0 when it has no area or is not finite.
double3 boundary_oracle_face_normal( const double3 corner[3] );

/// Edge normal: normalize( (1 - tau) N0 + tau N1 ), 0 where the sum is below 1e-12.
double3 boundary_oracle_edge_normal( double3 n0, double3 n1, double tau );

/// Inner normal by the weights, or along the line; 0 where a sum is below 1e-12.
double3 boundary_oracle_inner_normal( const double3 normal[3], const boundary_oracle_axis* axis, double q, double r,
                                      boundary_oracle_normals mode );

// ---- local spacing, one value per edge ----

/// A gain or an angle of 0 disables its criterion.
typedef struct boundary_oracle_criteria
{
    double least, most;    ///< m
    double curvature_gain; ///< 1/rad: d / (1 + gain angle)
    double strain_gain;    ///< d / (1 + gain |l/l0 - 1|), or d (1 + |gain| |l/l0 - 1|) when it is negative
    double eye_angle;      ///< rad, that the spacing spans at the edge's middle
    double3 eye;           ///< m
} boundary_oracle_criteria;

/// By curvature. @param n0, n1 unit vertex normals of the ends
double boundary_oracle_spacing_by_curvature( double d, double gain, double3 n0, double3 n1 );
/// By strain. @param rest m; without a rest length there is no strain
double boundary_oracle_spacing_by_strain( double d, double gain, double length, double rest );
/// By distance from the eye.
double boundary_oracle_spacing_by_distance( double3 eye, double3 middle, double eye_angle );
/// clamp( the smallest spacing of all criteria, least, most ); d without a criterion.
double boundary_oracle_local_spacing( const boundary_oracle_criteria* criteria, double d, double3 p0, double3 p1,
                                      double3 n0, double3 n1, double rest );
/// Spacing of a triangle: the smallest of its three edges, so that its inside is as fine as its border.
double boundary_oracle_triangle_spacing( const double edge_spacing[3] );

// ---- contact of a boundary point ----

/// The point y = sum b_i x_i against the plane y.n = offset, C = y.n - offset, acting where C < 0:
/// Dx_i = -C w_i b_i n / (sum w_j b_j^2 + W).
/// @param plane_w W, 1/kg, inverse mass of the plane's body; 0: fixed
/// @param plane_move receives W C / (sum + W), m along n, by which the plane moves; may be null
/// @return whether it acted: false where C >= 0 or nothing can move
bool boundary_oracle_contact( int count, double3* x, const double* w, const double* b, double3 unit_normal,
                              double offset, double plane_w, double* plane_move );

// ---- the layer ----

/// Start from boundary_oracle_default_options().
typedef struct boundary_oracle_options
{
    double spacing; ///< d, m, > 0, finite; default 0.1
    boundary_oracle_policy policy;
    boundary_oracle_rounding rounding;
    boundary_oracle_normals normals;
    /// Hysteresis as a fraction of the spacing, in [0, 0.5]. The counts of a triangle are kept together or not at
    /// all. Lines without points do not count, except the lowest one, which must not grow beyond the interval.
    /// Default 0: exact comparison
    double hysteresis;
    double cap;                     ///< points at most, estimated as sum( L / d ) + Area / d^2; default 4e6
    const double* edge_spacing;     ///< [edge_count] m, owned by the caller; null: `spacing` for all
    const double* triangle_spacing; ///< [triangle_count] m
} boundary_oracle_options;

/// One boundary particle. (element, line, step) identifies it; the rest follows from the positions of its parents.
typedef struct boundary_oracle_point
{
    int element;      ///< an edge, or edge_count + a triangle
    int line, step;   ///< k and j from 1; an edge's line is 0
    int parent[3];    ///< vertices; the third of an edge's point is its first
    double weight[3]; ///< b; the third of an edge's point is 0
    double3 y, normal;
} boundary_oracle_point;

/// The counts that an element keeps between updates.
typedef struct boundary_oracle_memory
{
    bool sampled;   ///< false: never, or it was skipped
    int axis;       ///< of a triangle, the local edge
    int line_count; ///< nt of a triangle, 1 of an edge
    int* counts;    ///< [line_count] n_e of an edge, ns of lines 1..nt
    int* points;    ///< [line_count] number of points for those counts
} boundary_oracle_memory;

typedef struct boundary_oracle_layer
{
    boundary_oracle_options options;
    int vertex_count, triangle_count, edge_count, element_count;
    int* triangles;
    balloon_mesh_topology topology; ///< E: unique undirected edges, lower index first, rising
    double3* vertex_normal;         ///< N
    double3* element_normal;        ///< normalised mean of unit face normals: of the triangle, or of those at an edge
    boundary_oracle_memory* memory; ///< [element_count]
    bool* changed;                  ///< [element_count] resampled in the last update: case B
    boundary_oracle_point* points;  ///< edges by id, then triangles by id, then (line, step)
    int point_count, edge_point_count;
    int changed_elements;
    int skipped_elements; ///< with a corner that is not finite
    int fallback_normals; ///< cancelled, and replaced
    bool refused;         ///< the limit was reached: points are those of the previous counts
    double requested;     ///< the estimate
} boundary_oracle_layer;

/// @return WISP_NO_MEMORY: nothing needs to be destroyed
wisp_status boundary_oracle_create( const balloon_mesh* mesh, const boundary_oracle_options* options,
                                    boundary_oracle_layer* out, wisp_error* error );
void boundary_oracle_destroy( boundary_oracle_layer* layer );

/// Update element by element. Where counts are the same, positions and normals are refreshed; elsewhere points are
/// dropped and sampled again. Options may be changed between updates.
/// @return false when memory ran out; the layer is then unchanged, except for vertex normals
bool boundary_oracle_update( boundary_oracle_layer* layer, const double3* x );

// ---- the sample program ----

/// The wind key: every face whose normal is against the gust passes it to its three vertices, m/s, independent of dt.
/// As printed (`per_face`), a vertex receives it once per such face; as resolved, once. Vertices of inverse mass w = 0 stay.
/// @param v [vertex_count] m/s, changed. @param hits [vertex_count] times that a vertex received it. @return their sum
int boundary_oracle_gust( const balloon_mesh* mesh, const double* w, double3 gust, bool per_face, double3* v,
                          int* hits );

/// Poles on the y axis, triangles counter-clockwise seen from outside: slices (stacks - 1) + 2 vertices.
/// @return false when memory runs out
bool boundary_oracle_sphere( balloon_mesh* mesh, int slices, int stacks, double radius );
