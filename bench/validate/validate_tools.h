/// Shared by cases: settings in series, and ladders of loads.
#pragma once

#include "accuracy/accuracy.h"

enum
{
    VALIDATE_MAX_SETTINGS = 64,
    VALIDATE_LADDER = 31, ///< loads, from 0.7 times the critical one to 1.3
};

#define VALIDATE_RUNG 0.01              // half of the distance between two loads, in critical ones
#define VALIDATE_SECONDS ( 1.0 / 60.0 ) // of a step

/// A setting.
typedef struct validate_way
{
    int method, cells, substeps; ///< method: a number of the case
} validate_way;

/// Settings of methods: each in a series by cells, and in one by substeps.
typedef struct validate_grid
{
    const char* const* names; ///< of methods, by their numbers
    const int* methods;       ///< [method_count]
    int method_count;
    const int* cells; ///< [cell_count], each with all substeps
    int cell_count;
    int middle;   ///< cells of the series by substeps
    int substeps; ///< halved again and again
    int halvings;
} validate_grid;

/// Put the settings of a grid into a scene with room for them. @param ways [VALIDATE_MAX_SETTINGS] by setting
void validate_put_settings( const validate_grid* grid, validate_way* ways, accuracy_scene* out );

/// Make a scene with a context of its own and room for settings.
/// @param like [size] bytes that the context starts as
wisp_status validate_make( const accuracy_scene* scene, const void* like, size_t size, accuracy_scene* out,
                           wisp_error* error );

/// Make a case whose context is its settings alone.
wisp_status validate_make_grid( const accuracy_scene* scene, const validate_grid* grid, accuracy_scene* out,
                                wisp_error* error );
/// A setting of such a case.
const validate_way* validate_way_of( const void* context, int setting );

/// A load of a ladder, in critical ones.
double validate_rung( int i );
/// Measure the load at which bodies give way: between the first that does and the one before. NaN: none gives way,
/// or the first one does.
/// @param has_lost [VALIDATE_LADDER] by rung @param measures that load, and the critical one
/// @return their distance, in percent of the critical one. Beyond the ladder it is at least the ladder's half
double validate_measure_ladder( const bool* has_lost, double critical, double measures[2] );
