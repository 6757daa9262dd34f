/// The table of levels, tethers and sweeps: the same columns for cloth, irregular cloth and a balloon.
#pragma once

#include "cloth_bench.h"

#define LEVEL_LINES_MAX 24

typedef struct level_line
{
    const char* name;
    scenario_stats stats;
    double volume_error; ///< |V / V_0 - 1| at the end
} level_line;

typedef struct level_table
{
    level_line lines[LEVEL_LINES_MAX];
    int line_count;
    const char* reference_name; ///< of the converged run
} level_table;

void level_table_write( const cloth_plan* plan, const level_table* table, const char* title, results* out );
/// Chart of error against time with the last worker count, with the front marked.
/// @param rows name of the rows, which have been added since first_row @param where the mesh, for the titles
void level_table_chart( const cloth_plan* plan, const char* rows, int first_row, const char* where, results* out );
