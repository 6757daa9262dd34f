// Levels of detail: their names, and which an entry can have.
#include "scene_detail.h"

#include "scene_parts.h"

const scene_choice SCENE_DETAIL_LEVELS[] = {
    { "full", "everything" },
    { "fewer_substeps", "everything, in fewer and longer substeps" },
    { "coarse", "coarse sheets alone; of ghosts, a rigid motion with the roots of what they follow" },
    { "nothing", "a rigid motion with the pins or the frame, of strands with the roots" },
    { 0 },
};

wisp_status scene_check_surface_detail( scene_reader* r, const scene_node* node, const wisp_scene_surface* s,
                                        wisp_detail level )
{
    const bool is_known = s->instance_of < 0; // else the engine finds out
    return level != WISP_DETAIL_COARSE || !is_known || ( s->has_cloth && s->cloth.coarse_substeps != 0 )
               ? WISP_OK
               : scene_refuse_node( r, node,
                                    "'coarse' needs coarse sheets, but the surface '%s' has no cloth.coarse_substeps",
                                    s->name );
}

wisp_status scene_check_strands_detail( scene_reader* r, const scene_node* node, const wisp_scene_strands* s,
                                        wisp_detail level )
{
    if ( !s->has_dynamics && !s->has_ghosts )
    {
        return scene_refuse_node( r, node, "'detail' needs the key 'dynamics' or 'ghosts'" );
    }
    return level != WISP_DETAIL_COARSE || s->has_ghosts
               ? WISP_OK
               : scene_refuse_node( r, node, "'coarse' needs ghosts, but the strands '%s' have no key 'ghosts'",
                                    s->name );
}
