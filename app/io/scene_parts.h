/// The tables and the readers that they name. Private to this folder.
#pragma once

#include "scene_schema.h"

extern const scene_block SCENE_BLOCK_OF_ALL;   // over wisp_scene
extern const scene_block SCENE_STRANDS_BLOCK;  // over wisp_scene_strands
extern const scene_block SCENE_GENERATE_BLOCK; // over wisp_groom_generator
extern const scene_block SCENE_SCATTER_BLOCK, SCENE_CURVES_BLOCK, SCENE_DYNAMICS_BLOCK, SCENE_HEAD_BLOCK,
    SCENE_TIPS_BLOCK, SCENE_STRAND_FRAME_BLOCK, SCENE_GRID_BLOCK, SCENE_GHOSTS_BLOCK, SCENE_STRAND_COLLISION_BLOCK,
    SCENE_STRAND_CONTACT_BLOCK;                                     // over wisp_scene_strands
extern const scene_block SCENE_COMMAND_BLOCK;                       // over wisp_scene_hair_event
extern const scene_block SCENE_EVENT_BLOCK;                         // over scene_event
extern const scene_block SCENE_OUTPUT_BLOCK;                        // over wisp_scene_output
extern const scene_block SCENE_SURFACE_BLOCK;                       // over wisp_scene_surface
extern const scene_block SCENE_BOUNDARY_BLOCK, SCENE_CONTACT_BLOCK; // over wisp_scene_surface
extern const scene_block SCENE_MOTION_CONSTRAINTS_BLOCK, SCENE_TEARING_BLOCK, SCENE_MEMBRANE_BLOCK, SCENE_FRAME_BLOCK,
    SCENE_SURFACE_SLEEP_BLOCK, SCENE_SURFACE_DETAIL_BLOCK;                      // over wisp_scene_surface
extern const scene_block SCENE_STRANDS_SLEEP_BLOCK, SCENE_STRANDS_DETAIL_BLOCK; // over wisp_scene_strands
extern const scene_block SCENE_SURFACE_COLLIDER_BLOCK;                          // likewise
extern const scene_block SCENE_ANIMATION_BLOCK;                                 // likewise
extern const scene_block SCENE_CLIP_BLOCK;                                      // over wisp_scene_clip
extern const scene_block SCENE_WORLD_CONTACT_BLOCK;                             // over wisp_scene
extern const scene_block SCENE_SEAM_BLOCK;                                      // over wisp_scene_seam
extern const scene_block SCENE_BOX_BLOCK;                                       // over wisp_scene_box
extern const scene_block SCENE_PIN_GROUP_BLOCK;                                 // over wisp_scene_pins

extern const scene_block SCENE_MESH_BLOCKS[WISP_MESH_SHAPE_COUNT];      // over wisp_mesh_generator
extern const scene_block SCENE_COLLIDER_BLOCKS[WISP_COLLIDER_COUNT];    // over wisp_scene_collider
extern const scene_block SCENE_PIN_POSE_BLOCK, SCENE_POSITION_BLOCK;    // over wisp_scene_pose
extern const scene_block SCENE_ROTATION_BLOCK;                          // over what scene_mesh.c makes a rotation of
extern const scene_choice SCENE_STRANDS_WORDS[], SCENE_SURFACE_WORDS[]; // of `compute`
extern const scene_choice SCENE_REPAIR_WORDS[], SCENE_REQUIRE_WORDS[];

// Readers that fill what they are pointed at.
scene_read_fn scene_read_name, scene_read_file;      // const char*
scene_read_fn scene_read_later_name;                 // nothing: a name that is looked up once all are known
scene_read_fn scene_read_rotation;                   // wisp_quat
scene_read_fn scene_read_mesh_generate;              // wisp_scene_mesh
scene_read_fn scene_read_repair, scene_read_require; // int, flags of mesh.h
scene_read_fn scene_read_pin_path;                   // wisp_scene_path
scene_read_fn scene_read_layers;                     // uint32_t, a bit a layer
scene_read_fn scene_read_strain_limit;               // float[2]
scene_read_fn scene_read_tile_size;                  // int

// Readers of the scene's lists; they are pointed at the wisp_scene.
scene_read_fn scene_read_dt_factors, scene_read_strands, scene_read_surfaces, scene_read_colliders, scene_read_seams,
    scene_read_commands, scene_read_events, scene_read_outputs, scene_read_contact;

// Readers of an entry's values; they are pointed at the entry.
scene_read_fn scene_read_generate, scene_read_curve, scene_read_request; // wisp_scene_strands
scene_read_fn scene_read_strand_pins, scene_read_vertex_masses, scene_read_head_path,
    scene_read_tips_path;                                                  // wisp_scene_strands
scene_read_fn scene_read_pins, scene_read_pin_box, scene_read_pin_nearest; // wisp_scene_pins
scene_read_fn scene_read_pin_groups, scene_read_surface_request, scene_read_outlet,
    scene_read_gas_ratio_keyframes;                                              // wisp_scene_surface
scene_read_fn scene_read_collider_path, scene_read_friction, scene_read_heights; // wisp_scene_collider
scene_read_fn scene_read_collider_request;                                       // bool

/// An entry of `events` before its time has become a step.
typedef struct scene_event
{
    wisp_scene_event event;
    bool has_step, has_time, has_gust_per_triangle;
    float time;            // s
    const char* pin_group; // null: all pins
} scene_event;

/// What entries are before a key is read. Strands have no stage of frozen hair.
wisp_scene scene_defaults( void );
wisp_scene_strands scene_default_strands( wisp_vec3 gravity );
wisp_scene_surface scene_default_surface( wisp_vec3 gravity );
wisp_scene_collider scene_default_collider( void );
wisp_scene_seam scene_default_seam( void );

/// scene_mesh.c: a distance to weld needs the repair. @param node of a surface or a collider
wisp_status scene_check_weld( scene_reader* reader, const scene_node* node, const wisp_scene_mesh* mesh );

/// A path of poses { time, position, rotation }. @param start the first pose's rotation unless it has its own
wisp_status scene_read_positions( scene_reader* reader, const scene_node* node, wisp_quat start,
                                  wisp_scene_path* path );

/// scene_seams.c: what the layer of a surface must be besides what its table says.
wisp_status scene_check_boundary( scene_reader* reader, const scene_node* node, const wisp_scene_surface* surface );

/// scene_surface_held.c: what motion constraints and the frame of a surface must be besides what their tables say.
wisp_status scene_check_held( scene_reader* reader, const scene_node* node, const wisp_scene_surface* surface );

/// scene_animation.c: what an animation must be besides what its table says.
wisp_status scene_check_animation( scene_reader* reader, const scene_node* node, const wisp_scene_surface* surface );
wisp_scene_clip scene_default_clip( void );

/// scene_motion.c: what an entry of strands must be besides what its tables say.
wisp_status scene_check_strands( scene_reader* reader, const scene_node* node, const wisp_scene_strands* strands );
/// Find the strands that entries of strands name.
wisp_status scene_bind_strands( scene_reader* reader, const scene_node* root );
/// Find the surfaces that entries of strands name, and those that pins are attached to.
wisp_status scene_bind_to_surfaces( scene_reader* reader, const scene_node* root );

/// scene_surface_pins.c: find the surfaces that pins of one surface are attached to.
wisp_status scene_bind_attachments( scene_reader* reader, const scene_node* entry, int surface );
wisp_scene_pins scene_default_pins( void );
/// @return whether a group of pins has keyframes
bool scene_moves_groups( const wisp_scene_surface* surface );
/// A list of vertices of the mesh that is read, reader->mesh. @param out [count of the node]
wisp_status scene_read_vertices( scene_reader* reader, const scene_node* node, int32_t* out );

/// scene_copies.c: make entries of the copies that entries ask for, after all others, whose numbers stay. To be called once all
/// names are bound.
wisp_status scene_make_copies( scene_reader* reader );

// scene_origin.c
/// Find where the scene is, and make places relative to it. Before copies are made, which share arrays.
void scene_find_origin( wisp_scene* scene );

/// Vertices of strands that are generated.
int64_t scene_made_vertices( const wisp_scene_strands* strands );

/// Vertices that a recipe makes.
int64_t scene_generator_vertices( const wisp_mesh_generator* generator );

/// Entries that may be named by those that follow. To be called once for each list, in the order of scene_named.
/// @param entries [count] each begins as scene_entry does
wisp_status scene_register( scene_reader* reader, scene_named what, const void* entries, size_t size, int count );

/// What all entries with a name begin with.
typedef struct scene_entry
{
    const char* name;
    int line, column;
} scene_entry;

/// The registered entry of a name; null: there is none.
const scene_name* scene_find_name( const scene_reader* reader, const char* text );
/// The number of the entry that a value names.
wisp_status scene_read_named( scene_reader* reader, const scene_node* node, scene_named what, int* index );

/// A list of entries: refuse another value, or too many, and take zeroed memory for them.
/// @param items receives null if the list is empty
wisp_status scene_begin_list( scene_reader* reader, const scene_node* node, const char* what, int most, size_t size,
                              void** items );

/// Read the items of a list one after the other, each with its number in the path, until one is refused.
typedef wisp_status scene_item_fn( scene_reader* reader, const scene_node* item, int index, void* context );
wisp_status scene_read_items( scene_reader* reader, const scene_node* list, scene_item_fn* read, void* context );
/// @param out [list->count]
wisp_status scene_read_numbers( scene_reader* reader, const scene_node* list, const scene_field* field, float* out );

/// Refuse the time of a keyframe that is not after that of the one before.
wisp_status scene_check_rises( scene_reader* reader, const scene_node* node, float before, float time );

/// scene_map.c: a map instead of a number; the number becomes its largest value. @param base a wisp_scene_surface
wisp_status scene_read_map( scene_reader* r, const scene_node* node, const scene_field* field, void* base );
