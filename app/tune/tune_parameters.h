/// Parameters to tune in a scene: fields that determine the accuracy of its solution, not its material.
#pragma once

#include "scene.h"
#include "scene_edit.h"
#include "tune_search.h"

// ---- fields: their location, reading and writing ----

/// Location of a field: the scene itself, or surfaces or strands of one kind.
typedef enum tune_place
{
    OF_SCENE,
    OF_XPBD_CLOTH,     ///< surfaces with `cloth` by xpbd, instances too
    OF_PINNED_CLOTH,   ///< surfaces with `cloth` that are pinned
    OF_IMPLICIT,       ///< surfaces with `implicit`
    OF_CONTACT,        ///< the scene itself, where something has `contact`
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
    size_t offset; ///< in the scene or the entry, of an int, of a float if it is_fraction, of a bool if it is_switch
    bool is_fraction, is_switch, is_unordered, is_falling;
    double candidates[TUNE_CANDIDATES_MAX]; ///< end with 0, unless it is full
    const char* const* words;               ///< of the values, from 0 on; null: numbers
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
    FIELD_LEVEL,
    FIELD_COUNT,
};

extern const tune_field tune_fields[FIELD_COUNT];

/// The scene's own value of a field. @return false: nothing has it
bool tune_field_own( const wisp_scene* scene, int which, double* out );

// ---- parameters ----

/// Parameters of a scene, for tune_find(). Must stay where it is: the parameters point into it.
typedef struct tune_parameters
{
    tune_parameter parameters[TUNE_MAX_PARAMETERS];
    int fields[TUNE_MAX_PARAMETERS]; // rows of tune_fields
    double values[TUNE_MAX_PARAMETERS][TUNE_MAX_VALUES];
    int count;
} tune_parameters;

/// @return WISP_BAD_INPUT nothing of the scene moves in time
wisp_status tune_parameters_find( const wisp_scene* scene, tune_parameters* out, wisp_error* error );

/// Set the values of a configuration in the scene. A parameter of surfaces or strands is set on all of them that have
/// it.
void tune_parameters_set( const tune_parameters* parameters, const int* configuration, wisp_scene* scene );

/// The changes of a scene's file that give it the values of a configuration.
/// @param scene as it was read @param out receives a block for free()
wisp_status tune_parameters_edits( const tune_parameters* parameters, const int* configuration,
                                   const wisp_scene* scene, wisp_scene_edit** out, int* count, wisp_error* error );

/// Write the scene of a file with the values of a configuration. @param to null: nothing, but the changes are checked
wisp_status tune_parameters_write( const tune_parameters* parameters, const int* configuration,
                                   const wisp_scene* scene, const char* from, const char* to, wisp_error* error );
/// The same of a text. @param out receives [size] bytes and a zero for free()
wisp_status tune_parameters_edit( const tune_parameters* parameters, const int* configuration,
                                  const wisp_scene* scene, const char* text, size_t text_size, char** out,
                                  size_t* size, wisp_error* error );

/// Whether a scene has the values of a configuration.
bool tune_parameters_agree( const tune_parameters* parameters, const int* configuration, const wisp_scene* scene );

/// A value for reports, as in the scene's file.
void tune_parameters_text( int field, double value, char* out, size_t size );
