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
    int32_t *substeps, *passes, *state;
} levels_columns;

/// A sheet whose links are projected.
typedef struct levels_sheet
{
    const wisp_fabric_level* level;
    const wisp_parallel* parallel;
    const wisp_kernels* kernels;
    wisp_level_link_args links;
} levels_sheet;

/// Find the lengths below which links push, for the sheet and the particles where they are.
void levels_find_band( const levels_sheet* sheet );
/// Project all links from multipliers of 0. @param dt s
void levels_project( levels_sheet* sheet, float dt, int passes );

/// The coarsest sheet in a substep of the surface.
typedef struct levels_carrier
{
    levels_sheet sheet;        ///< position: in: where the substep begins; out: where the sheet ends it
    const float* target;       ///< [row][4] m, where the surface has been predicted; pinned rows end there
    const float* acceleration; ///< [row][4] m/s^2, by the forces on the surface
    float* velocity;           ///< [row][4] m/s, in: of the surface, before its forces; out: of the sheet
    float* start;              ///< [row][4] m, of a substep of the sheet
    float *change, *lag;       ///< [row][4] history
    float dt;                  ///< s, of the surface
    levels_columns columns;
} levels_carrier;

/// Move the coarsest sheet by its substeps. @return false, and nothing has moved, if a link is torn
bool levels_move_carrier( levels_carrier* carrier );
