#include "contact_state.h"

wisp_status contact_find_state( wisp_world* world, contact_state** out )
{
    *out = wisp_world_module_state( world, "contact" );
    return *out != NULL
               ? WISP_OK
               : wisp_world_fail( world, WISP_CONFLICT, "the module contact is not registered in this world" );
}
