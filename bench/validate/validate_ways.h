/// Shared by the cases of validation: settings of solver, cells and substeps, and ladders that enclose a critical value.
#pragma once

#include "validate_bodies.h"

enum
{
    VALIDATE_MAX_WAYS = 64,
    VALIDATE_MAX_RUNGS = 31,
};

typedef struct validate_way
{
    validate_solver solver;
    int cells, substeps;
} validate_way;

/// Series in cells and in substeps, for each solver.
typedef struct validate_series
{
    const validate_solver* solvers;
    int solver_count;
    const int* cells; ///< [cell_count], with `substeps`
    int cell_count;
    int substeps;
    int fixed_cells; ///< with a half, a quarter and an eighth of the substeps
} validate_series;

/// Add the settings of series to a scene that has room for them, and note their ways by setting.
void validate_put_settings( accuracy_scene* scene, const validate_series* series, validate_way* ways );

/// Make steps of 1/60 s.
wisp_status validate_step_for( validate_bodies* bodies, double seconds, accuracy_run* out, wisp_error* error );

/// The slowest frequency of a cantilever without weight, rad/s (Euler and Bernoulli): 3.516 sqrt( EI / m L^4 ).
double validate_frequency( double load );

/// Values from 0.7 times the critical one to 1.3. @param out [count]
void validate_ladder( double critical, int count, double* out );
/// The value half way between the first rung that is over and the one below it. @return NaN: the first one is, or none
double validate_ladder_found( const bool* is_over, const double* rungs, int count );
/// Distance from the critical value in its parts. Beyond the ladder it is at least the half of the ladder, 0.3.
double validate_ladder_error( double found, double critical );
/// Half of the distance between two rungs in parts of the critical value.
double validate_ladder_doubt( int count );
