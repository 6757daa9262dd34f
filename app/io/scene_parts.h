/// The tables of scene_tables.c and the readers that they name. Private to this room.
#pragma once

#include "scene_schema.h"

extern const scene_block SCENE_BLOCK_OF_ALL;  // over wisp_scene
extern const scene_block SCENE_STRANDS_BLOCK; // over wisp_scene_strands
extern const scene_block SCENE_MAKE_BLOCK;    // over wisp_groom_recipe
extern const scene_block SCENE_COMMAND_BLOCK; // over wisp_scene_command
extern const scene_block SCENE_OUTPUT_BLOCK;  // over wisp_scene_output

// scene_strands.c; the base is the wisp_scene, or the wisp_scene_strands
scene_read_fn scene_read_strands;
scene_read_fn scene_read_name, scene_read_strands_file, scene_read_make, scene_read_curve, scene_read_want;

// scene.c; the base is the wisp_scene, the wisp_scene_command or the wisp_scene_output
scene_read_fn scene_read_version, scene_read_commands, scene_read_outputs;
scene_read_fn scene_read_command_strands, scene_read_output_strands, scene_read_output_file;
