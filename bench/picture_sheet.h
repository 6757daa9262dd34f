/// Pictures side by side in one PNG, linked from the results.
#pragma once

#include "render.h"
#include "results.h"

#define PICTURE_SHEET_MAX 8

/// Zero-initialised is empty.
typedef struct picture_sheet
{
    image pictures[PICTURE_SHEET_MAX];
    const char* labels[PICTURE_SHEET_MAX]; ///< owned by the caller
    int count;
    int columns; ///< 0: all in one row
} picture_sheet;

/// Shots that one camera sees, so that they can be compared.
typedef struct picture_shots
{
    /// The scene of a shot, valid until the next call.
    const render_scene* ( *scene )( void* context, int shot );
    void* context;
    int count;
    render_view view;
    int width, height; ///< pixels
    int samples;       ///< of a pixel; 0: the default
} picture_shots;

/// @param labels of the first shot; each further one is `label_distance` bytes behind. The caller keeps them
wisp_status picture_sheet_draw( const picture_shots* shots, const char* labels, size_t label_distance,
                                picture_sheet* sheet, wisp_error* error );

/// FOLDER/<name>.png. @return WISP_BAD_INPUT the folder's name is too long
wisp_status picture_path( const char* folder, const char* name, char* out, size_t size, wisp_error* error );

/// Write the sheet as FOLDER/<name>.png and link it with its caption; release the pictures in any case.
/// @param drawn the status of drawing; nothing is written unless it is WISP_OK
wisp_status picture_sheet_finish( picture_sheet* sheet, wisp_status drawn, const char* folder, const char* name,
                                  const char* caption, results* out, wisp_error* error );
