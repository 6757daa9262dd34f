/// Shared by the tests of guide hair: a scene of targets and ghosts around them, its motion, comparisons.
#pragma once

#include "oracle_support.h"

#include "oracle/guide_oracle.h"

static const uint64_t random_seed = 31;

enum
{
    NODES = 10,
    MAX_TARGETS = 6,
    MAX_GHOSTS = 40,
};

static const double3 zero = { 0.0, 0.0, 0.0 };
static const double segment = 0.02; // m, of every target

static inline void assert_at( double3 a, double3 b, double tolerance )
{
    assert_close( double3_distance( a, b ), 0.0, tolerance );
}

// A row of targets, each with the same number of ghosts around it, and the simulated motion of those targets.
typedef struct scene
{
    int target_count, ghost_count;
    double3 target[MAX_TARGETS * NODES]; // rest
    double3 ghost[MAX_GHOSTS * NODES];   // rest
    double3 x[MAX_TARGETS * NODES], v[MAX_TARGETS * NODES];
    double w[NODES];
    double time;
} scene;

// Ghosts are at increasing distances from their target, so that no two are equally far from the centre.
static inline scene make_scene( int target_count, int ghosts_a_target )
{
    scene s = { .target_count = target_count, .ghost_count = target_count * ghosts_a_target };
    for ( int n = 0; n < target_count * NODES; ++n )
    {
        int a = n / NODES, i = n % NODES;
        double lean = 0.3 * i / NODES;
        double3 way = double3_make( sin( lean ), -cos( lean ), 0.0 );
        s.target[n] = i == 0 ? double3_make( 0.05 * a, 1.0, 0.0 )
                             : double3_add( s.target[n - 1], double3_scale( segment, way ) );
        s.x[n] = s.target[n];
        s.w[i] = i == 0 ? 0.0 : 1e4;
    }
    for ( int n = 0; n < s.ghost_count * NODES; ++n )
    {
        int g = n / NODES, i = n % NODES, a = g / ghosts_a_target, l = g % ghosts_a_target;
        double radius = 0.003 + 0.002 * l, angle = 2.4 * l;
        double3 around = double3_make( radius * cos( angle ), 0.0, radius * sin( angle ) );
        s.ghost[n] = double3_add( s.target[a * NODES + i],
                                  double3_add( around, double3_scale( 2e-4, random_vector( g, i ) ) ) );
    }
    return s;
}

// One frame of all targets; the head moves 8 cm to the left and right, once in a second and a half.
static inline void swing( scene* s, int iterations )
{
    constraint_oracle_skips skips = { 0 };
    s->time += 1.0 / 60.0;
    for ( int a = 0; a < s->target_count; ++a )
    {
        double3 root = double3_add( s->target[a * NODES], double3_make( 0.08 * sin( 4.2 * s->time ), 0.0, 0.0 ) );
        guide_oracle_strand strand = { NODES, s->target + a * NODES, s->w, 1.0 / 60.0, 4, iterations,
                                       0.2,   { 0.0, -9.8, 0.0 },    root };
        assert_true( guide_oracle_strand_step( &strand, s->x + a * NODES, s->v + a * NODES, &skips ) > 0 );
    }
}

static inline void step( guide_oracle* hair, const double3* x, const double3* v )
{
    guide_oracle_motion motion = { x, v, NULL };
    guide_oracle_step( hair, &motion );
}

// Eq. 1 in the other order: every pair's distance first, minima afterwards.
static inline double brute_distance( const double3* detail, int detail_nodes, const double3* guide, int guide_nodes )
{
    double table[32][32], sum = 0.0;
    for ( int n = 0; n < detail_nodes * guide_nodes; ++n )
    {
        double length = double3_distance( detail[n / guide_nodes], guide[n % guide_nodes] );
        table[n / guide_nodes][n % guide_nodes] = length;
    }
    for ( int k = 0; k < detail_nodes; ++k )
    {
        double least = table[k][0];
        for ( int i = 1; i < guide_nodes; ++i )
        {
            least = table[k][i] < least ? table[k][i] : least;
        }
        sum += least * least;
    }
    return sum;
}
