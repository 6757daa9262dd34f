/// Small meshes for the tests of cloth and balloons, made from scratch, and the topology of a mesh: its edges and its
/// bend pairs. Triangles are counter-clockwise seen from outside.
#pragma once

#include "double3.h"

#include <stdbool.h>

typedef struct balloon_mesh
{
    int vertex_count, triangle_count;
    double3* positions; ///< [vertex_count], m
    int* triangles;     ///< [3 * triangle_count]
} balloon_mesh;

// Functions that make meshes. Each returns false when memory runs out; then nothing needs to be destroyed.

bool balloon_mesh_two_triangles( balloon_mesh* mesh, double edge ); ///< open, equilateral, flat, share the edge 0 1
bool balloon_mesh_cube( balloon_mesh* mesh, double edge );          ///< twelve triangles, a corner at the origin

/// 20 * 4^level triangles, vertices on the sphere.
bool balloon_mesh_icosphere( balloon_mesh* mesh, int level, double radius );

/// An icosphere drawn out to one side and dented: closed, genus 0, no symmetry. Replaces the scanned figure of the
/// paper.
bool balloon_mesh_pear( balloon_mesh* mesh, int level, double radius );

/// A torus about the y axis, genus 1: around * across * 2 triangles.
bool balloon_mesh_torus( balloon_mesh* mesh, int around, int across, double radius, double tube );

/// Both meshes in one, the second moved.
bool balloon_mesh_join( balloon_mesh* mesh, const balloon_mesh* a, const balloon_mesh* b, double3 move_b );

void balloon_mesh_destroy( balloon_mesh* mesh );

/// Find the vertex farthest along a direction. Ties go to the lowest index.
int balloon_mesh_farthest( const balloon_mesh* mesh, double3 direction );

/// One edge and the vertices opposite to it.
typedef struct balloon_mesh_edge
{
    int a, b;        ///< a < b
    int uses;        ///< triangles at the edge: 1 open edge, 2 interior, more than 2 non-manifold
    int triangle[2]; ///< the first two, in ascending order; -1 when there is none
    int opposite[2]; ///< their third vertices; -1 when there is none
} balloon_mesh_edge;

/// The edges of a mesh in ascending order of (a, b), and how many are open.
typedef struct balloon_mesh_topology
{
    int edge_count;
    balloon_mesh_edge* edges;
    int* triangle_edge; ///< [3 * triangle_count], the edge from corner k to k + 1
    int border_count;   ///< edges with one triangle: the mesh is open
} balloon_mesh_topology;

/// @return false when memory runs out; then nothing needs to be destroyed
bool balloon_mesh_build_topology( const balloon_mesh* mesh, balloon_mesh_topology* topology );

void balloon_mesh_destroy_topology( balloon_mesh_topology* topology );

/// Structural springs: every edge once.
/// @param pairs receives [2 * edge_count]
/// @return number of pairs
int balloon_mesh_structural_pairs( const balloon_mesh_topology* topology, int* pairs );

/// Bend springs: the two vertices across every edge of exactly two faces (from the faces, not from common
/// neighbours).
/// @param pairs receives at most [2 * edge_count]
/// @return number of pairs
int balloon_mesh_bend_pairs( const balloon_mesh_topology* topology, int* pairs );

/// Close every hole with a fan of real triangles around a new vertex at the mean of its border (`allow_open`). New
/// vertices and triangles follow the old ones.
/// @param hub receives [vertex_count of the open mesh] the new vertex of the border that the vertex is on, -1
///        elsewhere
/// @return false when a border is not a set of simple loops, or when memory runs out; then nothing needs to be destroyed
bool balloon_mesh_cap( const balloon_mesh* mesh, balloon_mesh* capped, int* hub );

/// Volume with every hole closed by a fan around the mean of its border vertices (`allow_open`).
/// @return false when a border is not a set of simple loops, or when memory runs out
bool balloon_mesh_capped_volume( const balloon_mesh* mesh, double* volume );

// ---- balloon theory ----

// ---- two discs, joined at the rim and filled ----

/// Two flat discs that bend freely and wrinkle but do not stretch, filled: meridians keep their length a, and
/// z'(x) = -x^2 / sqrt( r^4 - x^4 ) (Paulsen 1994, "What is the shape of a Mylar balloon?"; Mladenov and Oprea 2003).
typedef struct balloon_theory_mylar
{
    double radius;    ///< r / a, of the equator
    double thickness; ///< 2 z(0) / a, between the poles
    double volume;    ///< V / a^3
} balloon_theory_mylar;

balloon_theory_mylar balloon_theory_mylar_shape( void );

// ---- a sphere of springs, filled with an ideal gas ----

/// Links of an even triangle mesh on a sphere, each with tension k (l - d). The skin has the tension
/// sqrt(3) k e / (1 + e) per length, and p = 2 sigma / R (Laplace 1806). Links across edges are sqrt(3) times as long as
/// edges, so they count three times.
typedef struct balloon_theory_sphere
{
    double radius;                ///< m, at rest
    double edge_stiffness;        ///< N/m
    double bend_link_stiffness;   ///< N/m
    double atmosphere, gas_ratio; ///< Pa; V_0 / V_rest, V_0 the volume of the gas at that pressure
} balloon_theory_sphere;

/// @param scale s, of lengths, from the rest shape @return Pa above the atmosphere
double balloon_theory_sphere_pressure( const balloon_theory_sphere* sphere, double scale );
/// The scale s at which the skin holds the pressure of p V = P_atm V_0 (Boyle 1662). gas_ratio >= 1
double balloon_theory_sphere_scale( const balloon_theory_sphere* sphere );

// ---- a jet ----

/// Pressure above the atmosphere, Pa, when the gas has a volume at the pressure of the atmosphere, m^3.
typedef double balloon_theory_pressure( const void* context, double gas_volume );

typedef struct balloon_theory_jet
{
    balloon_theory_pressure* pressure; ///< 0 where the skin is slack
    const void* context;
    double density; ///< kg/m^3, of the gas
    double mass;    ///< kg, of the skin
    double area;    ///< m^2, of the outlet
} balloon_theory_jet;

/// What a jet does while the gas falls from one volume to another: it leaves with v_e = sqrt( 2 p / rho ) (Torricelli 1643, Bernoulli 1738), so
/// dV_0/dt = -A v_e and m dv/dt = rho A v_e^2.
typedef struct balloon_theory_flow
{
    double
        speed; ///< m/s, which the skin gains: rho / m times the integral of v_e over the volume. The area drops out
    double seconds; ///< the integral of 1 / ( A v_e )
} balloon_theory_flow;

balloon_theory_flow balloon_theory_empty( const balloon_theory_jet* jet, double from, double to );

// ---- flight ----

/// How drag depends on the angle between velocity and normal.
typedef enum balloon_theory_drag
{
    BALLOON_THEORY_DRAG_MAX,    ///< against v, max( 0, cos )
    BALLOON_THEORY_DRAG_ABS,    ///< against v, |cos|
    BALLOON_THEORY_DRAG_SIGNED, ///< against v, cos
    BALLOON_THEORY_DRAG_NORMAL, ///< along the normal, cos
    BALLOON_THEORY_DRAG_COUNT,
} balloon_theory_drag;

/// The integral of the law over a sphere in parts of pi R^2: by how much it multiplies the coefficient of drag.
double balloon_theory_drag_factor( balloon_theory_drag law );
/// Speed at which drag 1/2 rho C pi R^2 v^2 (Newton 1687) balances a force. @param coefficient C, with the factor of the law
double balloon_theory_terminal_speed( double force, double air_density, double coefficient, double radius );
