/// What tables and charts share: names of times, errors and worker counts, digits, and which settings belong together.
#pragma once

#include "accuracy.h"
#include "cells.h"

/// What a time is of: "step", "frame of 1/60 s".
/// "Accuracy", or "Suite" where errors are not measured.
const char* accuracy_kind( const accuracy_scene* scene );
const char* accuracy_ms_name( const accuracy_scene* scene );
/// "distance to the reference, mm"
void accuracy_error_label( const accuracy_scene* scene, char* text, int size );
/// "2 workers"
void accuracy_workers_label( int workers, char* text, int size );
/// Format a number with the given significant digits, without an exponent as long as that is readable; "-" if it is
/// not finite.
void accuracy_put_digits( cells* row, double value, int digits );
/// Whether an error is below the doubt of its reference, so that its value says nothing. 0: there is no doubt
bool accuracy_is_below( double error, double doubt );
/// The same for an error: the word `below` where it is.
void accuracy_put_error( cells* row, double error, double doubt, int digits );
/// Settings that are one candidate: their method, or series, or name.
const char* accuracy_method_of( const accuracy_setting* setting );
/// The first setting of its series; false for one of no series.
bool accuracy_begins_series( const accuracy_scene* scene, int setting );
