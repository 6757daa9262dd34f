/// Shared by the commands of the program wisp-bench: `wisp bench`, `accuracy`, `sweep` and `merge`.
#pragma once

#include "results.h"
#include "wisp/base.h"

/// `wisp accuracy`. @return exit status
int bench_accuracy( int argc, char** argv );
/// `wisp sweep`. @return exit status
int bench_sweep( int argc, char** argv );
/// `wisp validate`. @return exit status
int bench_validate( int argc, char** argv );
/// `wisp merge`. @return exit status
int bench_merge( int argc, char** argv );

/// @return whether a report and results, which are to go to standard output if it is null, have one file
bool bench_writes_twice( const char* report, const char* output );
/// @return WISP_OK in place of the status of an interruption, which becomes a note
wisp_status bench_keep_interrupted( results* out, wisp_status status );

/// The machine, with the instruction set of the engine's kernels.
wisp_status bench_describe_machine( machine_info* out, wisp_error* error );
