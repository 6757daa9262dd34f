/// Declarations shared by the files of coarse sheets.
#pragma once

#include "wisp/module/module.h"

enum
{
    LEVELS_RESTARTED, ///< masses have to be found
    LEVELS_FIRST,     ///< the next substep of the coarsest sheet is Euler's
    LEVELS_MOVING,
};

/// Columns of surface.levels.
typedef struct levels_columns
{
    int32_t *substeps, *passes, *state, *pins;
    float *forced, *drift;
} levels_columns;

/// A pinned vertex of the surface between rows of a sheet.
typedef struct levels_pin
{
    int32_t row_x4[WISP_FABRIC_PARENTS];
    float weight[WISP_FABRIC_PARENTS];
    float scale;             ///< kg, 1 / sum of weight^2 inverse mass
    float from[3], moved[3]; ///< m, the point when the substep begins, and how far it moves in the substep
} levels_pin;

/// A sheet whose links are projected.
typedef struct levels_sheet
{
    const wisp_fabric_level* level;
    const wisp_parallel* parallel;
    const wisp_kernels* kernels;
    wisp_level_link_args links;
    const levels_pin* pins;
    int pin_count;
    float pin_fraction; ///< of the substep of the surface that ends now
} levels_sheet;

/// Find the lengths below which links push, for a sheet that has been predicted.
void levels_find_band( levels_sheet* sheet );
/// Project all links from multipliers of 0, and pins after each pass. @param dt s
void levels_project( levels_sheet* sheet, float dt, int passes );

/// The coarsest sheet in a substep of the surface.
typedef struct levels_carrier
{
    levels_sheet sheet;
    /// Rows. position: in: where the substep begins; out: where the sheet ends it. acceleration: by the forces on the surface. velocity: in: of the
    /// surface, before its forces; out: of the sheet. target: where the surface has been predicted.
    wisp_level_rows_args rows;
    float dt; ///< s, of the surface
    levels_columns columns;
} levels_carrier;

/// Move the coarsest sheet by its substeps. @return false, and nothing has moved, if a link is torn
bool levels_move_carrier( levels_carrier* carrier );
