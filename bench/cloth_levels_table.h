/// The table of levels, tethers and sweeps: the same columns for cloth, irregular cloth and a balloon.
#pragma once

#include "cloth_bench.h"

#define LEVEL_LINES_MAX 12

typedef struct level_line
{
    const char* name;
    scenario_figures figures;
    double volume_error; ///< |V / V_0 - 1| at the end; NaN for cloth
} level_line;

typedef struct level_table
{
    level_line lines[LEVEL_LINES_MAX];
    int line_count;
    bool has_volume;
    const char* truth_name;   ///< null: no converged run
    double truth_energy_lost; ///< NaN: not known
} level_table;

void level_table_write( const cloth_plan* plan, const level_table* table, const char* title, results* out );
