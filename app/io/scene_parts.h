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

extern const scene_block SCENE_MESH_BLOCKS[WISP_MESH_SHAPE_COUNT];   // over wisp_mesh_generator
extern const scene_block SCENE_COLLIDER_BLOCKS[WISP_COLLIDER_COUNT]; // over wisp_scene_collider
extern const scene_block SCENE_PIN_POSE_BLOCK, SCENE_POSITION_BLOCK; // over wisp_scene_pose
extern const scene_block SCENE_ROTATION_BLOCK;                       // over what scene_mesh.c makes a rotation of
extern const scene_choice SCENE_REPAIR_WORDS[], SCENE_REQUIRE_WORDS[];
extern const int SCENE_REPAIR_BITS[], SCENE_REQUIRE_BITS[]; // flags of mesh.h

// Lists of the scene, of entries and of their values.
extern const scene_list SCENE_STRANDS_LIST, SCENE_SURFACES_LIST, SCENE_COLLIDERS_LIST, SCENE_SEAMS_LIST,
    SCENE_COMMANDS_LIST, SCENE_EVENTS_LIST;
extern const scene_list SCENE_STRAND_PINS, SCENE_VERTEX_MASSES;                                // of strands
extern const scene_list SCENE_VERTICES, SCENE_PIN_BOXES, SCENE_PIN_PLACES, SCENE_PIN_GROUPS;   // of a surface
extern const scene_list SCENE_PIN_PATH, SCENE_HEAD_PATH, SCENE_TIPS_PATH, SCENE_COLLIDER_PATH; // in a wisp_scene_path

// Readers that fill what they are pointed at.
scene_read_fn scene_read_name, scene_read_file; // const char*
scene_read_fn scene_read_later_name;            // nothing: a name that is looked up once all are known
scene_read_fn scene_read_rotation;              // wisp_quat
scene_read_fn scene_read_mesh_generate;         // wisp_scene_mesh
scene_read_fn scene_read_layers;                // uint32_t, a bit a layer
scene_read_fn scene_read_strain_limit;          // float[2]
scene_read_fn scene_read_tile_size;             // int

// Readers that are pointed at the scene or the entry.
scene_read_fn scene_read_contact;                    // wisp_scene
scene_read_fn scene_read_generate, scene_read_curve; // wisp_scene_strands
scene_read_fn scene_read_outlet;                     // wisp_scene_surface

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
wisp_status scene_check_weld( scene_reader* reader, const text_node* node, const wisp_scene_mesh* mesh );

/// scene_seams.c: what the layer of a surface must be besides what its table says.
wisp_status scene_check_boundary( scene_reader* reader, const text_node* node, const wisp_scene_surface* surface );

/// scene_surface_held.c: what motion constraints and the frame of a surface must be besides what their tables say.
wisp_status scene_check_held( scene_reader* reader, const text_node* node, const wisp_scene_surface* surface );

/// scene_animation.c: what an animation must be besides what its table says.
wisp_status scene_check_animation( scene_reader* reader, const text_node* node, const wisp_scene_surface* surface );
wisp_scene_clip scene_default_clip( void );

/// scene_motion.c: what an entry of strands must be besides what its tables say.
wisp_status scene_check_strands( scene_reader* reader, const text_node* node, const wisp_scene_strands* strands );
/// Find the strands that entries of strands name.
wisp_status scene_bind_strands( scene_reader* reader, const text_node* root );
/// Find the surfaces that entries of strands name, and those that pins are attached to.
wisp_status scene_bind_to_surfaces( scene_reader* reader, const text_node* root );

/// scene_surface_pins.c: find the surfaces that pins of one surface are attached to.
wisp_status scene_bind_attachments( scene_reader* reader, const text_node* entry, int surface, void* none );
wisp_scene_pins scene_default_pins( void );
/// @return whether a group of pins has keyframes
bool scene_moves_groups( const wisp_scene_surface* surface );
/// A list of vertices of the surface that is read. @param out [count of the node]
wisp_status scene_read_vertices( scene_reader* reader, const text_node* node, int32_t* out );

/// scene_copies.c: make entries of the copies that entries ask for, after all others, whose numbers stay. To be called once all
/// names are bound.
wisp_status scene_make_copies( scene_reader* reader );

/// Find where the scene is, and make places relative to it. Before copies are made, which share arrays.
void scene_find_origin( wisp_scene* scene );

/// Vertices of strands that are generated.
int64_t scene_made_vertices( const wisp_scene_strands* strands );

/// Vertices that a recipe makes.
int64_t scene_generator_vertices( const wisp_mesh_generator* generator );

/// Vertices of a surface that is made, 0 of another one.
int64_t scene_surface_vertices( const wisp_scene* scene, int surface );

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
wisp_status scene_read_named( scene_reader* reader, const text_node* node, scene_named what, int* index );

/// Read the items of a list one after the other, each with its number in the path, until one is refused.
wisp_status scene_read_items( scene_reader* reader, const text_node* list, scene_item_fn* read, void* context );
/// @param out [list->count]
wisp_status scene_read_numbers( scene_reader* reader, const text_node* list, const scene_field* field, float* out );

/// Refuse a vertex that is not there, if it is known how many there are. @param of the name of their body, or null
wisp_status scene_check_vertex( scene_reader* reader, const text_node* node, int vertex, bool is_known, int64_t count,
                                const char* of );

/// Refuse keyframes that jump. @param why such as SCENE_JUMPS
wisp_status scene_refuse_jumps( scene_reader* reader, const text_node* node, const wisp_scene_path* path,
                                const char* why );
#define SCENE_JUMPS "only keyframes of pins, colliders and heads can jump"

/// Refuse the time of a keyframe that is not after that of the one before.
wisp_status scene_check_rises( scene_reader* reader, const text_node* node, float before, float time );

/// scene_map.c: a map instead of a number; the number becomes its largest value. @param base a wisp_scene_surface
wisp_status scene_read_map( scene_reader* r, const text_node* node, const scene_field* field, void* base );
