/// Shared by the files that make a world of a scene, and private to them.
#pragma once

#include "world_from_scene.h"

// ---- messages ----

/// Hand a message to the world's log, or print it to stderr. @param world may be null: stderr
void scene_tell( const scene_world* world, wisp_log_level level, const char* message );

/// What the fabric of a surface that is no instance is cooked from: all that its instances need. (world_from_scene_surfaces.c)
wisp_fabric_def scene_fabric_def( const scene_world* world, int surface, const wisp_vec3* rest );
/// Keep a line for those who ask for notes, and log it as a warning. (scene_notes.c)
void scene_note( scene_world* world, const char* line );
/// Note a warning of the world, an entity by the name of its entry. (scene_notes.c)
void scene_note_warning( scene_world* world, const char* message );
/// Note what of a scene that was built has no effect. (scene_notes.c)
void scene_find_notes( scene_world* world );

// ---- errors that name the scene's line ----

/// @param what the kind of entry, such as "surface"
wisp_status scene_fail_at( const wisp_scene* scene, int line, int column, const char* what, const char* name,
                           wisp_status status, const char* message, wisp_error* error );
/// The same of an entry of `surfaces`, `strands` or `colliders`, by its number.
#define SCENE_FAIL_AT( scene, list, i, what, ... )                                                                   \
    scene_fail_at( scene, ( scene )->list[i].line, ( scene )->list[i].column, what, ( scene )->list[i].name,         \
                   __VA_ARGS__ )
/// The message is the last one of the world.
wisp_status scene_fail_at_line( const scene_world* world, int line, int column, wisp_status status,
                                wisp_error* error );

// ---- strands ----

/// Add the effects and requests of strands.
wisp_status scene_strands_dress( scene_world* world, int strands );
/// Where the frame of strands starts, m.
wisp_vec3 scene_strand_frame_pivot( const wisp_scene_strands* entry );
/// Add dynamics, ghosts and curves. Call after all other entries are added.
wisp_status scene_motion_set( scene_world* world, wisp_error* error );

// ---- surfaces and colliders ----

/// Set the maps of a surface that was added. @param of_mass only that of area density, else all others
wisp_status scene_maps_set( scene_world* world, int surface, bool of_mass, wisp_error* error );

/// Add all surfaces, then all colliders.
wisp_status scene_surfaces_add( scene_world* world, wisp_error* error );
/// Move the vertices of a placed surface to those of the file that its entry starts as, if it has one.
/// @param repairs of the mesh that it has, or of its source: a start file may have the vertices before them
wisp_status scene_start_load( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                              scene_world_surface* out, wisp_error* error );
/// Move the vertices of a placed surface to where its entry has them start.
void scene_start_place( const wisp_scene_surface* entry, scene_world_surface* surface );
/// Let the masses of a surface that was added grow downwards, as its entry says.
void scene_surface_weigh( const wisp_scene_surface* entry, const scene_world_surface* surface, wisp_world* world );
/// Masses that grow along strands. @param out [vertex_count] kg
void scene_strands_weigh( const wisp_scene_strands* entry, const wisp_groom* groom, float* out );
/// Move the vertices of strands with dynamics to where their entry has them start, in the world and in the groom.
void scene_strands_start( const wisp_scene_strands* entry, wisp_world* world, wisp_entity entity, wisp_groom* groom );
void scene_surfaces_release( scene_world* world );
/// Attach implicit cloth to a surface as its entry says, or restart it. On failure the message is the last one of the world.
wisp_status scene_implicit_set( scene_world* world, int surface );
/// Attach motion constraints, the frame and the largest speed of a surface as its entry says. On failure the message is the last one of
/// the world.
wisp_status scene_held_set( scene_world* world, int surface );
/// Add spare vertices to a mesh that was loaded, where its surface or an instance of it tears.
wisp_status scene_tearing_reserve( const wisp_scene* scene, int surface, scene_world_surface* out,
                                   wisp_error* error );
/// Give an instance that tears triangles of its own.
wisp_status scene_tearing_prepare( scene_world* world, int surface, wisp_error* error );
/// Let a surface tear as its entry says. On failure the message is the last one of the world.
/// @param factors [vertex_count] of the strength; null: 1
wisp_status scene_tearing_set( scene_world* world, int surface, const float* factors );
/// Read the triangles of surfaces that have torn in the last step.
wisp_status scene_tearing_follow( scene_world* world, wisp_error* error );
/// Pairs of a seam as numbered in the meshes. @param pairs [pair_count][2]
wisp_status scene_seam_pairs( const scene_world* world, const wisp_scene_seam* entry, int32_t* pairs,
                              wisp_error* error );
/// Sew surfaces together. Call after all of them are added.
wisp_status scene_seams_add( scene_world* world, wisp_error* error );
wisp_status scene_colliders_add( scene_world* world, wisp_error* error );

/// Load the animation of a placed surface, if its entry has one, and move its mesh to the first pose.
wisp_status scene_animation_load( const wisp_scene* scene, int surface, scene_world_surface* out, wisp_error* error );
/// Null is allowed.
void scene_animation_release( scene_animation* animation );

/// Every group of vertices that a surface's entry pins. The mesh is the initial one.
/// @param repairs of the mesh; zero if there were none
wisp_status scene_pins_find( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                             scene_world_surface* out, wisp_error* error );
/// The entry of a surface's group. @param group 0: the surface's own pins
const wisp_scene_pins* scene_pins_entry( const wisp_scene_surface* entry, int group );
/// The balloon of a surface with the vertices of its outlet found.
wisp_status scene_outlet_find( const wisp_scene* scene, int surface, const wisp_mesh_repairs* repairs,
                               const wisp_mesh* mesh, wisp_balloon_def* out, wisp_error* error );

// ---- before a step ----

/// Write the call that attaches a group of pins to a surface, if there is one, and make it.
void scene_tell_attachment( scene_world* world, int surface, int group, int to );
wisp_status scene_attach_pins( scene_world* world, int surface, int group, int to );

/// Hold the tips of all strands of an entry in one way.
wisp_status scene_hold_tips( scene_world* world, int strands, wisp_strand_tip hold );

wisp_status scene_events_play( scene_world* world, wisp_error* error );
