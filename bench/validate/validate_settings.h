/// Settings of a case: solver x cells x substeps, in series of cells and of substeps.
#pragma once

#include "accuracy/scene_tools.h"

enum
{
    VALIDATE_MAX_SETTINGS = 64,
};

typedef struct validate_setting
{
    int solver, cells, substeps; ///< solver: a number of the case
} validate_setting;

/// The settings of a scene, in its order. The context of every case that is made here begins with them.
typedef struct validate_settings
{
    validate_setting list[VALIDATE_MAX_SETTINGS];
} validate_settings;

/// Series in cells and in substeps for each of several solvers.
typedef struct validate_grid
{
    const char* const* names; ///< of solvers, by their numbers
    const int* solvers;       ///< [solver_count]
    int solver_count;
    const int* cells; ///< [cell_count] of a length, with all substeps
    int cell_count;
    int substeps; ///< all, and those of the series by substeps: halved again and again
    int halvings;
    int middle; ///< cells of the series by substeps
} validate_grid;

/// Make a scene whose context is a copy of `like`, without settings yet. It is freed with the scene.
/// @param like [size] begins with validate_settings
wisp_status validate_make( const void* like, size_t size, accuracy_scene scene, accuracy_scene* out,
                           wisp_error* error );
/// Make a scene whose context is its settings alone, those of a grid.
wisp_status validate_make_grid( const validate_grid* grid, accuracy_scene scene, accuracy_scene* out,
                                wisp_error* error );
/// A setting of a context.
const validate_setting* validate_setting_of( const void* context, int setting );
/// Add a series in cells, with the same substeps. @param cell what 1 / cells is: "cell / L"
void validate_put_cells( accuracy_scene* out, int solver, const char* name, const char* cell, const int* cells,
                         int count, int substeps );
/// Add a series in substeps of 1/60 s, with the same cells.
void validate_put_substeps( accuracy_scene* out, int solver, const char* name, int cells, const int* substeps,
                            int count );
void validate_put_grid( accuracy_scene* out, const validate_grid* grid );
