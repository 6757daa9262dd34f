// Strands: an entry before its keys are read, and the list of them.
#include "scene_parts.h"
#include "scene_start.h"

#include <math.h>

wisp_scene_strands scene_default_strands( wisp_vec3 gravity )
{
    wisp_scene_strands strands = {
        .generator = wisp_default_groom_generator( WISP_GROOM_STRAIGHT, 3 ),
        .scatter = { .around = -1, .count = 4, .seed = 1 },
        .curves = wisp_default_curves_def(),
        .curves_of = -1,
        .scale = 1.0f,
        .copies = { .count = 1 },
        .start = scene_default_start(),
        .mass_ratio = 1.0f,
        .pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } },
        .frozen_hair = wisp_default_frozen_hair_def(),
        .environment = wisp_default_environment_def(),
        .appearance = wisp_default_strand_appearance_def(),
        .dynamics = wisp_default_strand_dynamics_def(),
        .grid = wisp_default_strand_grid_def(),
        .collision = wisp_default_collision_def(),
        .contact = wisp_default_contact_def(),
        .sleep = wisp_default_sleep_def(),
        .frame = wisp_default_moving_frame_def(),
        .max_speed = INFINITY,
        .detail = wisp_default_detail_def(),
        .tips_hold = WISP_STRAND_TIP_CLAMPED,
        .tips_release = INFINITY,
        .on_surface = -1,
        .ghosts = wisp_default_ghosts_def(),
        .targets = -1,
        .is_shown = true,
    };
    strands.dynamics.gravity = gravity;
    // A stage runs if its key is there, not by default.
    strands.frozen_hair.freeze = strands.frozen_hair.align = strands.frozen_hair.clump = false;
    return strands;
}

static wisp_status read_entry( scene_reader* r, const scene_node* node, int index, void* context )
{
    wisp_scene* scene = context;
    wisp_scene_strands* strands = &scene->strands[index];
    scene->strands_count = index + 1;
    *strands = scene_default_strands( r->scene->gravity );
    strands->line = node->line;
    strands->column = node->column;
    // Ghosts move in every step, so frozen hair on them follows in every step.
    if ( scene_child( r, node, "ghosts" ) )
    {
        strands->frozen_hair.update_on = WISP_FROZEN_UPDATE_FRAME;
    }
    strands->has_collision = r->body_count > 0;
    wisp_status status = scene_read_block( r, node, &SCENE_STRANDS_BLOCK, strands );
    if ( strands->has_dynamics == false && scene_child( r, node, "collision" ) == NULL )
    {
        strands->has_collision = false;
    }
    return status ? status : scene_check_strands( r, node, strands );
}

wisp_status scene_read_strands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene* scene = base;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of strands", WISP_SCENE_MAX_STRANDS, sizeof *scene->strands, &items );
    if ( status || !items )
    {
        return status;
    }
    scene->strands = items;
    status = scene_read_items( r, node, read_entry, scene );
    return status ? status
                  : scene_register( r, SCENE_STRANDS, scene->strands, sizeof *scene->strands, scene->strands_count );
}
