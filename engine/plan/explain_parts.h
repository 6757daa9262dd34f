/// Declarations shared by the files that explain a plan.
#pragma once

#include "plan.h"

#include "wisp/explain.h"

const char* explain_name( const wisp_registry* r, wisp_component c );
/// Append up to the capacity.
void explain_append( char* text, size_t size, const char* more );

/// List what requests the writes of a pass, component by component: the scene first, then readers in declaration
/// order.
/// @param out null to count only
/// @return number of reasons
int explain_find_reasons( const plan* p, const wisp_registry* r, const wisp_pass* pass, wisp_plan_reason* out );
/// Format the reasons.
void explain_reasons( wisp_plan_pass* p );

/// Find the first component that the pass requires and no entity has.
store_mask explain_missing( const wisp_registry* r, const wisp_pass* pass );
/// Find why a pass is absent, as state, list and text.
/// @param out has its own lists already
void explain_absence( const wisp_registry* r, const wisp_pass* pass, wisp_plan_pass* out );
