/// Table 1 of Kim 2026: measurements of each size, and the tables made from them.
#pragma once

#include "bench.h"
#include "bench_world.h"
#include "groom.h"
#include "stats.h"

#include "frozen_hair/frozen_hair.h"

#define PAPER_SIZES 6
#define PAPER_VARIANTS_MAX 2

/// Allowed difference of float from double, in roundings (FLT_EPSILON) of the farthest coordinate. Positions are sums
/// of coordinates, and four iterations pass errors on to neighbours; the engine stays below 10.
#define PAPER_TOLERATED_ROUNDINGS 32.0

/// One size of the table, measured.
typedef struct paper_line
{
    int strands, vertices;
    double source_ms, source_fps; ///< NaN for sizes that are not in the paper

    stats_summary ms[PAPER_VARIANTS_MAX]; ///< by worker count
    double fraction[3];                   ///< of the parallel variant's step: freeze, align, clump, remainder
    double neighbours;                    ///< per vertex
    double bytes;                         ///< per vertex, of the parallel variant's world
    double error[PAPER_VARIANTS_MAX];     ///< m, largest distance to the double oracle; NaN beyond its limit
    double tolerance;                     ///< m
    uint64_t hash;
} paper_line;

typedef struct paper_table
{
    int variant_count; ///< worker counts
    int workers[PAPER_VARIANTS_MAX];
    int oracle_vertices_max; ///< limit of the double oracle
    double clump_radius;     ///< m
    int size_count;          ///< a quick run leaves out the largest
    paper_line lines[PAPER_SIZES];
} paper_table;

/// The table, the fit, and the messages below them.
void paper_report( const paper_table* table, results* out );
