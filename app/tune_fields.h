/// Fields of a scene that determine the accuracy of its solution, not its material: their location, reading and
/// writing.
#pragma once

#include "scene.h"

/// Location of a field: the scene itself, or surfaces or strands of one kind.
typedef enum tune_place
{
    OF_SCENE,
    OF_XPBD_CLOTH,     ///< surfaces with `cloth` by xpbd, instances too
    OF_PINNED_CLOTH,   ///< surfaces with `cloth` that are pinned
    OF_IMPLICIT,       ///< surfaces with `implicit`
    OF_DIRECT_STRANDS, ///< strands with `dynamics` that keep their length by the direct solve
} tune_place;

#define TUNE_CANDIDATES_MAX 6

/// One row per parameter. Values go from coarse to fine; the scene's own value is added. Approximations that help a
/// coarse setting, and that a fine one does not need, have no order: the last value, 0, turns them off, as in the
/// reference.
typedef struct tune_field
{
    const char* name;
    const char* list; ///< of the scene's entries that have it; null: the scene itself
    const char* block;
    const char* key;
    tune_place place;
    bool is_unordered, is_falling;
    double candidates[TUNE_CANDIDATES_MAX]; ///< end with 0, unless it is full
} tune_field;

enum
{
    FIELD_SUBSTEPS,
    FIELD_ITERATIONS,
    FIELD_TETHERS,
    FIELD_COARSE,
    FIELD_TOLERANCE,
    FIELD_REPEATS,
    FIELD_PASSES,
    FIELD_COUNT,
};

extern const tune_field tune_fields[FIELD_COUNT];

/// Length of the list that contains a field's entries; the scene itself is one entry.
int tune_field_entries( const wisp_scene* scene, int which );
/// Whether an entry of the list has the field.
bool tune_field_is_in( const wisp_scene* scene, int which, int entry );
double tune_field_value( const wisp_scene* scene, int which, int entry );
void tune_field_set( wisp_scene* scene, int which, int entry, double value );
/// The scene's own value of a field. @return false: nothing has it
bool tune_field_own( const wisp_scene* scene, int which, double* out );
