/// What the files that explain a plan share.
#pragma once

#include "plan.h"

#include "wisp/explain.h"

const char* explain_name( const wisp_registry* r, wisp_component c );
/// Append what there is room for.
void explain_append( char* text, size_t size, const char* more );

/// Who wants what a pass writes, a component after the other: the scene first, then readers in the order of declaration.
/// @param out null only counts @return how many
int explain_find_reasons( const plan* p, const wisp_registry* r, const wisp_pass* pass, wisp_plan_reason* out );
/// The reasons in words.
void explain_reasons( wisp_plan_pass* p );

/// What the pass needs and no entity was given.
store_mask explain_missing( const wisp_registry* r, const wisp_pass* pass );
/// What keeps a pass away, as state, list and words. @param out has its own lists already
void explain_absence( const wisp_registry* r, const wisp_pass* pass, wisp_plan_pass* out );
