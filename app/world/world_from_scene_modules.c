// Which modules a scene uses. A module of modules.inc without a function here does not compile.
#include "world_from_scene_parts.h"

#include "create.h"

static bool any_surface( const wisp_scene* scene, bool ( *has )( const wisp_scene_surface* ) )
{
    bool any = false;
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        any = any || has( &scene->surfaces[i] );
    }
    return any;
}

static bool any_strands( const wisp_scene* scene, bool ( *has )( const wisp_scene_strands* ) )
{
    bool any = false;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        any = any || has( &scene->strands[i] );
    }
    return any;
}

#define BLOCK_OF( kind, block )                                                                                      \
    static bool kind##_##block( const wisp_scene_##kind* of )                                                        \
    {                                                                                                                \
        return of->has_##block;                                                                                      \
    }
BLOCK_OF( surface, balloon )
BLOCK_OF( surface, boundary )
BLOCK_OF( surface, cloth )
BLOCK_OF( surface, collider )
BLOCK_OF( surface, collision )
BLOCK_OF( surface, contact )
BLOCK_OF( surface, implicit )
BLOCK_OF( surface, membrane )
BLOCK_OF( surface, motion_constraints )
BLOCK_OF( surface, tearing )
BLOCK_OF( strands, appearance )
BLOCK_OF( strands, collision )
BLOCK_OF( strands, contact )
BLOCK_OF( strands, dynamics )
BLOCK_OF( strands, environment )
BLOCK_OF( strands, frozen_hair )
BLOCK_OF( strands, ghosts )
#undef BLOCK_OF

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
USES( balloon, any_surface( scene, surface_balloon ) )
USES( boundary, any_surface( scene, surface_boundary ) )
USES( environment, any_strands( scene, strands_environment ) )
USES( cloth, any_surface( scene, surface_cloth ) )
USES( membrane, any_surface( scene, surface_membrane ) )
USES( motion_constraints, any_surface( scene, surface_motion_constraints ) )
USES( seams, scene->seam_count > 0 )
USES( collision, scene->collider_count > 0 || any_surface( scene, surface_collider ) ||
                     any_surface( scene, surface_collision ) || any_strands( scene, strands_collision ) )
USES( contact, scene->has_contact || any_surface( scene, surface_contact ) || any_strands( scene, strands_contact ) )
USES( frozen_hair, any_strands( scene, strands_frozen_hair ) )
USES( guide_hair, any_strands( scene, strands_ghosts ) )
USES( implicit_cloth, any_surface( scene, surface_implicit ) )
USES( strand_appearance, any_strands( scene, strands_appearance ) )
USES( strands, any_strands( scene, strands_dynamics ) )
USES( tearing, any_surface( scene, surface_tearing ) )
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
