/// The cloth of a plan, folding by several ways.
#pragma once

#include "contact_bench.h"

typedef void contact_write_fn( const contact_comparison* comparison, const contact_run* runs, results* out );

/// Fold the cloth of a plan by all ways of a comparison, and write what came of it.
/// @param comparison without scene and steps
wisp_status contact_comparison_fold( const contact_plan* plan, contact_comparison comparison, contact_write_fn* write,
                                     results* out, wisp_error* error );
