/// Declarations shared by the files that compile a plan.
#pragma once

#include "plan.h"

// select.c

/// Select the passes of each entity, attach the rows that they need and make the arrays of fabrics that they read.
/// @return WISP_CONFLICT a request or a read without supplier; WISP_NO_MEMORY
wisp_status plan_select( plan* p, const wisp_registry* r, wisp_error* error );

/// Return the components that some passes read and write.
store_mask plan_used_by( const wisp_registry* r, store_mask passes );

/// Attach components that an entity does not have.
/// @return false: no memory
bool plan_attach_rows( plan* p, store* s, int slot, store_mask components );
/// Detach those of some components that passes needed, and no one else.
void plan_detach_rows( store* s, int slot, store_mask components );

// place.c

/// Order passes by stage, then data dependency, then declaration. @param order [PLAN_MAX_PASSES]
/// @return WISP_CONFLICT passes wait for each other
wisp_status plan_order( const wisp_registry* r, store_mask live, int* order, int* count, wisp_error* error );

/// Place ordered passes in nodes and waves, and fuse them.
void plan_place( plan* p, const wisp_registry* r, const int* order, int count );
