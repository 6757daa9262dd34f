/// Rods that are bent and twisted in space: set-ups of their cases. A length is 1 m, EI = GJ = 1 N m^2 if a case
/// does not change it, and what is shown has no unit.
#pragma once

#include "validate_bodies.h"
#include "validate_ladder.h"
#include "validate_settings.h"

/// Methods of rods.
enum
{
    VALIDATE_ROD_EULER,
    VALIDATE_ROD_BDF2,
    VALIDATE_ROD_METHODS,
};

/// Straight without load, 1 kg/m, no gravity.
wisp_strand_dynamics_def validate_rod_dynamics( int method );
/// @param count of bodies
validate_def validate_rod_def( const validate_setting* way, int count, int workers );
/// Add a body of straight rods along x, all of them in one place. @param count at most VALIDATE_LADDER
wisp_status validate_add_straight( validate_bodies* bodies, int count, const wisp_strand_dynamics_def* dynamics,
                                   wisp_error* error );
wisp_status validate_hold_tips( validate_bodies* bodies, int body, int count, wisp_strand_tip hold,
                                wisp_error* error );
/// Turn a tip about x, and bring it nearer, by the next step, from where it was at first. @param nearer m
wisp_status validate_turn_tip( validate_bodies* bodies, int body, int strand, double angle, double nearer,
                               wisp_error* error );
/// Make a case. @param cells [3 or more], the third of which has a series by substeps
/// @param method_count 1: without BDF2
wisp_status validate_make_rods( accuracy_scene scene, const int* cells, int cell_count, int method_count,
                                int substeps, accuracy_scene* out, wisp_error* error );
