/// One HTML page of a check, with charts of before and after.
#pragma once

#include "gate_check.h"

/// The page: the verdict and what is worse in sentences, charts, tables. It needs no network and no script.
/// @param report of gate_report() for the same checks; charts and headlines are added to it
/// @return WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status gate_write_page( const wisp_suite* suite, const gate_row_check* checks, results* report, const char* path,
                             wisp_error* error );
