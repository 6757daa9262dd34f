/// Table 1 of Kim 2026: measurements of each size, and the tables made from them.
#pragma once

#include "bench_options.h"
#include "stats.h"

#define PAPER_SIZES 6
#define PAPER_VARIANTS_MAX 3

/// Allowed difference of float from double, in roundings (FLT_EPSILON) of the farthest coordinate. Positions are sums
/// of coordinates, and four iterations pass errors on to neighbours; scalar C and the engine stay below 10.
#define PAPER_TOLERATED_ROUNDINGS 32.0

/// One size of the table, measured.
typedef struct paper_line
{
    int strands, vertices;
    double source_ms, source_fps; ///< NaN for sizes that are not in the paper

    stats_summary ms[PAPER_VARIANTS_MAX]; ///< scalar C, then the engine
    double fraction[3];                   ///< of the parallel variant's step: freeze, align, clump, remainder
    double neighbours;                    ///< per vertex
    double bytes;                         ///< per vertex, of the parallel variant's world
    bool by_oracle;                       ///< errors are distances to the double oracle, else to scalar C
    double error[PAPER_VARIANTS_MAX];     ///< m, largest distance; NaN where a variant is the reference itself
    double tolerance;                     ///< m
    uint64_t hash;
    bool plain_once; ///< scalar C was timed a single time
} paper_line;

typedef struct paper_table
{
    int variant_count; ///< 2 with one worker, else 3
    int workers[PAPER_VARIANTS_MAX];
    int oracle_vertices_max; ///< limit of the double oracle
    double clump_radius;     ///< m
    int size_count;          ///< a quick run leaves out the largest
    paper_line lines[PAPER_SIZES];
} paper_table;

/// The table, the fit, and the messages below them.
void paper_report( const paper_table* table, results* out );
