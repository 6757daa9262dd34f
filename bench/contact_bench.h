/// The case `contact`: what accuracy costs, and how balloons press on each other
/// (extensions, not in the papers).
#pragma once

#include "bench_options.h"
#include "cells.h"

#define CONTACT_TEAMS_MAX 2

/// Worker counts that are timed.
typedef struct contact_teams
{
    int workers[CONTACT_TEAMS_MAX], count;
} contact_teams;

/// Sizes and steps. contact_default_plan() has those of the case; tests have smaller ones.
typedef struct contact_plan
{
    double suite_seconds;                           ///< about how long times of the suites are taken
    int picture_side, picture_level, picture_steps; ///< of what pictures show
    int picture_pixels;
    contact_teams teams;
    const bench_options* options; ///< for progress and pictures
} contact_plan;

contact_plan contact_default_plan( const bench_options* options );

/// All tables of a plan.
wisp_status contact_bench_run( const contact_plan* plan, results* out, wisp_error* error );

typedef wisp_status contact_fn( const contact_plan* plan, results* out, wisp_error* error );

contact_fn contact_suites;   ///< those of data/suites/contact: the cost of accuracy and of motion, pressed balloons
contact_fn contact_pictures; ///< of their scenes, if there is a folder for it

/// Fail where rows of the suites are not what contact promises. @param first_row of the suites
void contact_check_suites( int first_row, results* out );
