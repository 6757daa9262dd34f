/// Contact of surfaces and strands in plain double precision: the closest points of a vertex and a triangle and of
/// two edges with the weights of their corners, and the constraint and friction between two weighted points.
///
///   yA = sum_i a_i x_i,  yB = sum_j b_j x_j,  S = sum_i w_i a_i^2 + sum_j w_j b_j^2
///   C = n . (yA - yB) - gap
///   lambda' = max( 0, lambda - C / S ),  D = lambda' - lambda,  Dx_i = +w_i a_i n D,  Dx_j = -w_j b_j n D
///
/// lambda is 0 at the start of a substep and accumulates the normal correction, kg m; divided by the time of a
/// substep it is an impulse. Friction has the same form across n, limited to Coulomb's cone:
///
///   d = (I - n n^T) ( (yA - yB) now - (yA - yB) at the start of the substep )
///   rubbed' = the nearest to (rubbed - d / S) that is no longer than mu lambda,
///   Dx_i = +w_i a_i (rubbed' - rubbed),  Dx_j = -w_j b_j (rubbed' - rubbed)
///
/// w in 1/kg, 0 pins a vertex. Weights of a side sum to one, so both constraints keep momentum; the first keeps
/// angular momentum where n is along yA - yB, the second where yA = yB.
#pragma once

#include "double3.h"

#include "wisp/module/shapes.h"
#include <stdbool.h>

/// Closest points of two simplices, A and B.
typedef struct contact_oracle_closest
{
    double a[3], b[3];  ///< weights of the corners, not negative, sum 1; 0 beyond the last corner
    double3 on_a, on_b; ///< the points themselves
    double distance;    ///< m
    double3 normal;     ///< unit, from B to A; zero where the points coincide
} contact_oracle_closest;

/// A is the point, B the triangle; the closest point of a flat triangle is on an edge or a corner.
contact_oracle_closest contact_oracle_point_triangle( double3 point, const double3 triangle[3] );

/// A and B are segments, which may be parallel (one of the closest pairs at an end is chosen) or have no length.
contact_oracle_closest contact_oracle_segments( const double3 a[2], const double3 b[2] );

/// A point interpolated from up to three vertices.
typedef struct contact_oracle_side
{
    int count;
    int vertex[3];
    double weight[3]; ///< sum 1
} contact_oracle_side;

double3 contact_oracle_point_of( const contact_oracle_side* side, const double3* x );

typedef struct contact_oracle_contact
{
    contact_oracle_side a, b; ///< no vertex is on both sides
    double3 normal;           ///< unit, from B to A
    double gap;               ///< m, distance to maintain
    double friction;          ///< mu, >= 0
    double lambda;            ///< kg m, >= 0
    double3 rubbed;           ///< kg m, across the normal
} contact_oracle_contact;

/// C, m: negative when the points are too close.
double contact_oracle_value( const contact_oracle_contact* contact, const double3* x );

/// Push apart, or undo an earlier push that was too large. @return the change of lambda, 0 when all vertices are
/// pinned
double contact_oracle_push( contact_oracle_contact* contact, const double* w, double3* x );

/// Apply friction. @param before positions at the start of the substep @return the change of `rubbed`
double3 contact_oracle_rub( contact_oracle_contact* contact, const double* w, const double3* before, double3* x );

// ---- mesh gap oracle ----

/// Distance of the closest points of two segments, m.
double mesh_gap_oracle_segments( const double3 a[2], const double3 b[2] );
/// Distance of a point from a triangle, m.
double mesh_gap_oracle_triangle( const double3 t[3], double3 p );

// ---- deepest oracle ----

/// A body in its own frame. A convex polyhedron is given by the triangles of its hull.
typedef struct deepest_oracle_body
{
    wisp_shape_kind kind;
    double radius, half_length, top_radius, bottom_radius;
    double3 half_extent;
    const wisp_vec3* points;  // of a hull
    const int32_t* triangles; // [triangle_count][3] counter-clockwise seen from outside
    int triangle_count;
} deepest_oracle_body;

/// Take over the sizes of a shape that is no convex polyhedron.
deepest_oracle_body deepest_oracle_body_of( const wisp_shape* shape );

/// Signed distance of a point from a body, m; negative inside.
double deepest_oracle_distance( const deepest_oracle_body* body, double3 p );

/// Smallest signed distance of the points of a segment (2 corners) or a triangle (3 corners), m.
/// @param weights receives the weights of the corners of that point; may be null
double deepest_oracle_find( const deepest_oracle_body* body, const double3* corners, int corner_count,
                            double weights[3] );
