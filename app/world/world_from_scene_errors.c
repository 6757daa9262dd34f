// Errors that name the scene's line.
#include "world_from_scene_parts.h"

wisp_status scene_fail_at( const wisp_scene* scene, int line, int column, const char* what, const char* name,
                           wisp_status status, const char* message, wisp_error* error )
{
    return wisp_fail( error, status, "%s:%d:%d: %s '%s': %s", scene->name, line, column, what, name, message );
}

wisp_status scene_fail_at_strands( const wisp_scene* scene, int strands, wisp_status status, const char* message,
                                   wisp_error* error )
{
    const wisp_scene_strands* entry = &scene->strands[strands];
    return scene_fail_at( scene, entry->line, entry->column, "strands", entry->name, status, message, error );
}

wisp_status scene_fail_at_line( const scene_world* world, int line, int column, wisp_status status,
                                wisp_error* error )
{
    return wisp_fail( error, status, "%s:%d:%d: %s", world->scene->name, line, column,
                      wisp_world_message( world->world ) );
}
