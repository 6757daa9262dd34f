/// Output of `wisp plan`: the plan of a scene as the engine explains it, and the times of its first steps. Each
/// output format has a file of its own.
#pragma once

#include "wisp/explain.h"
#include "world_from_scene.h"

#include <stdio.h>

typedef struct plan_sheet
{
    const char* scene; ///< its file
    const scene_world* world;
    wisp_plan_info* report; ///< of the start
    int steps;              ///< number of steps; 0: nothing is measured
    int plan_changes;       ///< number of changes of the plan within these steps
    double* seconds;        ///< [report->pass_count] of all steps together
    double pass_seconds;    ///< of all passes, including later ones
    double dt;              ///< of whole steps
} plan_sheet;

/// Explain the plan, then make steps. @param sheet to be released, also after a failure, before the world
wisp_status plan_sheet_make( scene_world* world, int steps, plan_sheet* sheet, wisp_error* error );
void plan_sheet_release( plan_sheet* sheet );

/// @param is_verbose also what each pass reads, writes and costs, and every absent pass
void plan_sheet_text( const plan_sheet* sheet, bool is_verbose, FILE* out );
void plan_sheet_dot( const plan_sheet* sheet, FILE* out );
/// @return false without memory
bool plan_sheet_json( const plan_sheet* sheet, FILE* out );
