#include "collision_state.h"

wisp_status collision_find_state( wisp_world* world, collision_state** out )
{
    *out = wisp_world_module_state( world, "collision" );
    return *out != NULL
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "the module collision is not registered in this world" );
}
