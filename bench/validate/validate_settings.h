/// Settings of a case: solver x cells x substeps, in series of cells and of substeps.
#pragma once

#include "accuracy/scene_tools.h"

enum
{
    VALIDATE_MAX_SETTINGS = 64,
};

typedef struct validate_setting
{
    int solver, cells, substeps;
} validate_setting;

/// The settings of a scene, in its order. The context of every case begins with them.
typedef struct validate_settings
{
    validate_setting list[VALIDATE_MAX_SETTINGS];
} validate_settings;

/// Make a scene whose context is a copy of `like`, without settings yet. It is freed with the scene.
/// @param like [size] begins with validate_settings
wisp_status validate_make( const void* like, size_t size, accuracy_scene scene, accuracy_scene* out,
                           wisp_error* error );
/// Add a series in cells, with the same substeps. @param cell what 1 / cells is: "cell / L"
void validate_put_cells( accuracy_scene* out, int solver, const char* name, const char* cell, const int* cells,
                         int count, int substeps );
/// Add a series in substeps of 1/60 s, with the same cells.
void validate_put_substeps( accuracy_scene* out, int solver, const char* name, int cells, const int* substeps,
                            int count );
