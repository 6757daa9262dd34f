/// Private to the oracles of rods: their frames and what a vertex of them has.
#pragma once

#include "strand_oracle.h"

#include <stddef.h>

static const double3 rod_none = { 0.0, 0.0, 0.0 };
static const double3 rod_x = { 1.0, 0.0, 0.0 };
static const double3 rod_z = { 0.0, 0.0, 1.0 };

static inline strand_oracle_quaternion quaternion_conjugate( strand_oracle_quaternion q )
{
    return ( strand_oracle_quaternion ){ -q.x, -q.y, -q.z, q.w };
}

static inline double quaternion_dot( strand_oracle_quaternion a, strand_oracle_quaternion b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

static inline strand_oracle_quaternion quaternion_normalised( strand_oracle_quaternion q,
                                                              strand_oracle_quaternion otherwise )
{
    const double length = sqrt( quaternion_dot( q, q ) );
    if ( !( length > 1e-15 ) )
    {
        return otherwise;
    }
    return ( strand_oracle_quaternion ){ q.x / length, q.y / length, q.z / length, q.w / length };
}

// Number of vertices from the root on that may bend.
static inline int rod_bending_count( const strand_oracle* strand )
{
    return strand->guided ? strand->count : strand->count - 1;
}

typedef struct rod_vertex
{
    double3 bend;   // t_i - t_{i-1}
    double3 rest;   // w_i k_i in the world
    double3 turned; // z_i x w_i k_i
    double3 kb;
    double3 before, behind;  // unit directions of the two segments
    double share, unfolding; // w_i and its derivative by 1 + t_{i-1} . t_i
    double ratio;            // tan( angle / 4 ) / tan( angle / 2 ) / 2
    double twist;            // m_i less its rest value, as 2 z' / w'
    double moment;           // T_i
    double load;             // b_i
    double slope;            // derivative of the bending by a turn of one of its two segments
    double3 soft, edge;      // s_i, and z_i x s_i
    double across, along;    // C_i . s_i, and (t_i - t_{i-1}) . (z_i x s_i)
} rod_vertex;

// ---- strand_oracle_rod.c ----

strand_oracle_quaternion rod_frame_before( const strand_oracle* strand, int i );
strand_oracle_quaternion rod_middle_frame( strand_oracle_quaternion a, strand_oracle_quaternion b );

// Not of length 1: divided by the length at rest.
double3 rod_tangent( const strand_oracle* strand, const double3* p, int s );

rod_vertex rod_measure( const strand_oracle* strand, const double3* p, int i );

// ---- strand_oracle.c ----

// The turns of all segments about themselves, around. The diagonal has the factor 1 + 1e-5, because a strand may turn about itself as a
// whole.
void rod_closed_turns( const strand_oracle* strand, const rod_vertex* v, double* turn );

// Adds K `way` to the gradient of each vertex.
void rod_closed_rate( const strand_oracle* strand, const double3* way, double3* gradient );
