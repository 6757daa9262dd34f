// Which modules a scene uses. A module of modules.inc without a function here does not compile.
#include "world_from_scene_parts.h"

#include "create.h"

// Does one of the entries have a block? @param at of its switch in an entry of `size` bytes
static bool any_has( const void* entries, int count, size_t size, size_t at )
{
    bool any = false;
    for ( int i = 0; i < count; ++i )
    {
        any = any || *( (const bool*)entries + (size_t)i * size + at );
    }
    return any;
}

#define ANY_SURFACE( block )                                                                                         \
    any_has( scene->surfaces, scene->surface_count, sizeof( wisp_scene_surface ),                                    \
             offsetof( wisp_scene_surface, has_##block ) )
#define ANY_STRANDS( block )                                                                                         \
    any_has( scene->strands, scene->strands_count, sizeof( wisp_scene_strands ),                                     \
             offsetof( wisp_scene_strands, has_##block ) )

// At the start, or by an event.
static bool attaches_pins( const wisp_scene* scene )
{
    bool any = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        const wisp_scene_surface* s = &scene->surfaces[i];
        for ( int g = 0; g <= s->pin_group_count; ++g )
        {
            any = any || scene_pins_entry( s, g )->attached_to >= 0;
        }
    }
    for ( int i = 0; i < scene->event_count; ++i )
    {
        any = any || scene->events[i].attach_to >= 0 || scene->events[i].detach;
    }
    return any;
}

#define USES( module, condition )                                                                                    \
    static bool uses_##module( const wisp_scene* scene )                                                             \
    {                                                                                                                \
        return condition;                                                                                            \
    }
USES( attachments, attaches_pins( scene ) )
USES( balloon, ANY_SURFACE( balloon ) )
USES( boundary, ANY_SURFACE( boundary ) )
USES( environment, ANY_STRANDS( environment ) )
USES( cloth, ANY_SURFACE( cloth ) )
USES( membrane, ANY_SURFACE( membrane ) )
USES( motion_constraints, ANY_SURFACE( motion_constraints ) )
USES( seams, scene->seam_count > 0 )
USES( collision,
      scene->collider_count > 0 || ANY_SURFACE( collider ) || ANY_SURFACE( collision ) || ANY_STRANDS( collision ) )
USES( contact, scene->has_contact || ANY_SURFACE( contact ) || ANY_STRANDS( contact ) )
USES( frozen_hair, ANY_STRANDS( frozen_hair ) )
USES( guide_hair, ANY_STRANDS( ghosts ) )
USES( implicit_cloth, ANY_SURFACE( implicit ) )
USES( strand_appearance, ANY_STRANDS( appearance ) )
USES( strands, ANY_STRANDS( dynamics ) )
USES( tearing, ANY_SURFACE( tearing ) )
#undef USES

#define WISP_MODULE( name ) uses_##name,
static bool ( *const is_used[] )( const wisp_scene* ) = {
#include "modules.inc"
};
#undef WISP_MODULE

_Static_assert( WISP_COUNT( is_used ) <= SCENE_MAX_MODULES, "room for every module" );

int scene_world_used_modules( const wisp_scene* scene, const wisp_module** out )
{
    const wisp_module* const* all_modules = wisp_all_modules( NULL );
    int count = 0;
    for ( int i = 0; i < WISP_COUNT( is_used ); ++i )
    {
        if ( is_used[i]( scene ) )
        {
            out[count++] = all_modules[i];
        }
    }
    return count;
}
