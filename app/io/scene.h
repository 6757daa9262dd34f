/// Scenes: a YAML (or JSON) file with strands, surfaces and colliders, their effects, events, and what to compute and
/// write.
/// docs/scenes.md describes the format. A scene is untrusted: bounded, checked, and refused with one message such as
/// `scene.yaml:12:7: strands[0].frozen_hair.clump.radius: got 'ten', expected a number`.
#pragma once

#include "attachments/attachments.h"
#include "balloon/balloon.h"
#include "boundary/boundary.h"
#include "environment/environment.h"
#include "cloth/cloth.h"
#include "collision/collision.h"
#include "contact/contact.h"
#include "frozen_hair/frozen_hair.h"
#include "guide_hair/guide_hair.h"
#include "implicit_cloth/implicit_cloth.h"
#include "motion_constraints/motion_constraints.h"
#include "membrane/membrane.h"
#include "tearing/tearing.h"
#include "seams/seams.h"
#include "strand_appearance/strand_appearance.h"
#include "strands/strands.h"

#include "groom.h"
#include "mesh.h"
#include "wisp/fabric.h"
#include "wisp/moving_frame.h"
#include "wisp/skin.h"
#include "wisp/detail.h"
#include "wisp/sleep.h"

#ifdef __cplusplus
extern "C"
{
#endif

#define WISP_SCENE_VERSION 1
#define WISP_SCENE_MAX_STRANDS 10000 ///< entries of the list `strands`
#define WISP_SCENE_MAX_SURFACES 10000
#define WISP_SCENE_MAX_COLLIDERS 10000
#define WISP_SCENE_MAX_SEAMS 10000
#define WISP_SCENE_MAX_VERTICES ( 1 << 24 ) ///< of all surfaces together
#define WISP_SCENE_MAX_PIN_GROUPS 256       ///< of a surface
#define WISP_SCENE_MAX_NAME 64              ///< letters of a name
#define WISP_SCENE_MAX_DT_FACTORS 64

    /// A pose at a time. Of pins: how far they are from where they started; of colliders and heads: where they are.
    typedef struct wisp_scene_pose
    {
        float time; ///< s
        wisp_transform pose;
        bool jump; ///< the pose is reached at once, by a teleport, before the first step that starts then or later
    } wisp_scene_pose;

    typedef struct wisp_scene_path
    {
        const wisp_scene_pose* poses; ///< [count] times rise
        int count;
    } wisp_scene_path;

    /// A mesh or strands that a host has in memory, in place of a file.
    typedef struct wisp_scene_arrays
    {
        const char* file;        ///< what entries name as their file, relative to the scene's folder as they do
        const wisp_vec3* points; ///< [point_count] m
        int point_count;
        const int32_t* triangles; ///< [triangle_count][3] of a mesh; null: strands
        int triangle_count;
        const int32_t* offsets; ///< [strand_count + 1] of strands
        int strand_count;
    } wisp_scene_arrays;

    // ---- strands ----

    /// Strands to be made around those of another entry, which is read or made itself.
    typedef struct wisp_scene_scatter
    {
        int around;    ///< index into the scene's strands, lower than its own
        int count;     ///< strands around each, >= 1
        float radius;  ///< m: offsets are uniform in a disc across the direction in which the root grows
        uint64_t seed; ///< of the offsets
    } wisp_scene_scatter;

    /// Where a surface or strands start away from its placed rest shape. Pinned vertices, and roots, are only scaled.
    typedef enum wisp_scene_start_shape
    {
        WISP_SCENE_START_REST,
        WISP_SCENE_START_RANDOM,     ///< every vertex at random in a cube as wide as it is, about its centre
        WISP_SCENE_START_PLANE,      ///< in the level plane through its centre
        WISP_SCENE_START_POINT,      ///< at its centre
        WISP_SCENE_START_INSIDE_OUT, ///< reflected in its centre; with pins, in the point at their height above it
        WISP_SCENE_START_TWISTED,    ///< turned about the vertical, from nothing at the top to `turns` at the bottom
    } wisp_scene_start_shape;

    typedef struct wisp_scene_start
    {
        wisp_scene_start_shape shape;
        wisp_vec3 scale; ///< along x, y and z about its centre, before the shape; default 1
        float turns;
        uint64_t seed;    ///< of random places and of shaking
        float shake;      ///< m, the largest displacement of a vertex along each axis, at random, after the shape
        const char* file; ///< of a surface: mesh with its vertices before scale and shape; null: the rest shape
        const wisp_scene_arrays* arrays; ///< a host has it in memory: the file is not read
    } wisp_scene_start;

    /// Entries that one entry becomes, in a grid: number k stands in row k / columns and column k % columns.
    typedef struct wisp_scene_copies
    {
        int count;         ///< >= 1, with the entry itself
        int columns;       ///< 0: the root of count, rounded up
        wisp_vec3 spacing; ///< m, from a column to the next along x, from a row to the next along y and z
    } wisp_scene_copies;

    /// One entry of `strands`. Texts and arrays belong to the scene; the definitions point at them.
    typedef struct wisp_scene_strands
    {
        const char* name; ///< unique in the scene
        int line, column; ///< of the entry, for messages about it that come later

        // Where they come from: one of these.
        const char* file; ///< where to read the strands, already relative to the scene's folder; or null
        const wisp_scene_arrays* arrays; ///< a host has them in memory: the file is not read
        bool is_generated;               ///< `recipe` tells how to make them
        bool is_scattered;               ///< `scatter` does
        bool is_curves;                  ///< `curves` does: smooth curves through the strands of another entry
        wisp_groom_generator generator;  ///< the defaults if not made
        wisp_scene_scatter scatter;      ///< around none (-1) if not scattered
        wisp_curves_def curves;          ///< without a source
        int curves_of; ///< index into the scene's strands, of those the curves run through; -1: none

        float scale; ///< > 0, about the groom's own origin, before the pose
        wisp_transform pose;
        wisp_scene_copies
            copies; ///< those are entries of their own at the end of the list, whose copies are not to be made

        bool has_frozen_hair, has_environment, has_appearance;
        bool has_cursor;                  ///< `frozen_hair.align` gives one
        wisp_frozen_hair_def frozen_hair; ///< the defaults without a stage if the scene has none
        wisp_environment_def environment;
        wisp_strand_appearance_def appearance;

        int stretch_count; ///< length of frozen_hair.strand_stretch_stiffness, 0 if that is null; must be the number
        int bend_count;    ///< of strands, which is known here, and checked, only if they are made
        int intensity_count; ///< so for strand_bend_stiffness and strand_intensity

        bool has_dynamics, has_grid, has_collision, has_head, has_head_pivot, has_tips;
        wisp_strand_dynamics_def dynamics; ///< the defaults under the scene's gravity if there are none
        int substeps;                      ///< in a step of usual length; 0: those of the scene
        int mass_count;                    ///< length of dynamics.vertex_masses, 0 if that is null
        float mass_ratio;                  ///< factor of masses at tips, rising evenly in powers from 1 at roots
        bool has_start;
        wisp_scene_start start;
        wisp_strand_grid_def grid;
        wisp_collision_def collision;
        bool has_contact;
        wisp_contact_def contact;
        bool has_sleep;
        wisp_sleep_def sleep;
        bool has_detail;
        wisp_detail_def detail;
        wisp_scene_path head;
        wisp_vec3 head_pivot; ///< m, where the head stands at the start, not turned; unless given, the pose's place
        bool has_frame, has_frame_pivot;
        wisp_moving_frame_def frame; ///< its pose is the identity at the pivot
        wisp_scene_path frame_path;  ///< how far it is from where it starts; empty: it goes with the head
        wisp_vec3 frame_pivot;       ///< m, where it stands at the start; unless given, the pivot of the head
        float max_speed;             ///< m/s; infinite: no limit
        wisp_strand_tip tips_hold;   ///< of every tip, with has_tips
        wisp_scene_path tips_path;   ///< how far tips are from rest, relative to the head
        float tips_release;          ///< s, time at which they are released; infinite: never
        int on_surface;              ///< index into the scene's surfaces, of the one that roots are on; -1: none

        bool has_ghosts;
        wisp_ghosts_def ghosts; ///< without targets
        int targets;            ///< index into the scene's strands, of those that ghosts follow; -1: none

        bool request_points, request_width, request_colour; ///< points also if an output writes them
        bool has_compute; ///< it is written; else points are requested of strands that are shown
        bool request_strain, request_speed, request_motion_stats;
        bool request_contacts; ///< figures of the collision
        bool is_shown;         ///< in pictures: as written, else unless ghosts follow them or curves run through them
        bool has_show;         ///< it is written
    } wisp_scene_strands;

    // ---- surfaces ----

    /// Where a mesh comes from, and what is done to it before it is used.
    typedef struct wisp_scene_mesh
    {
        const char* file;                ///< already relative to the scene's folder; null if made
        const wisp_scene_arrays* arrays; ///< a host has it in memory: the file is not read
        bool is_generated;               ///< `recipe` tells how to make it
        wisp_mesh_generator generator;   ///< the defaults if not made
        int repairs;                     ///< WISP_MESH_DROP_DEGENERATES ... or-ed; 0: none
        float weld_distance;             ///< m, before the scale; 0: as wisp_mesh_repair()
        int demands;                     ///< WISP_MESH_CLOSED ... or-ed, of the repaired mesh; 0: none
        float scale;                     ///< > 0, about the mesh's own origin
    } wisp_scene_mesh;

    /// A filling at a time.
    typedef struct wisp_scene_gas_ratio_keyframe
    {
        float time;      ///< s
        float gas_ratio; ///< V_0 / V_rest
    } wisp_scene_gas_ratio_keyframe;

    typedef struct wisp_scene_box
    {
        wisp_vec3 lower, upper; ///< m, low <= high
    } wisp_scene_box;

    /// Vertices of a surface that are held, move and are released together.
    typedef struct wisp_scene_pins
    {
        const char* name; ///< null: the surface's own
        int line, column;
        const int32_t* vertices; ///< [vertex_count] numbers as the file or the recipe has them
        int vertex_count;
        const wisp_scene_box* boxes; ///< [box_count] whatever starts inside is pinned
        int box_count;
        const wisp_vec3* nearest; ///< [nearest_count] the vertex that starts nearest to each is pinned
        int nearest_count;
        wisp_scene_path path; ///< how far they are from where they started
        bool has_pivot;
        wisp_vec3 pivot;  ///< m, what path turns about; without it: the middle of these pins
        int attached_to;  ///< index of the surface that they are attached to, -1: none
        bool starts_free; ///< nothing holds them until an event does
    } wisp_scene_pins;

    /// What a map takes of a colour.
    typedef enum wisp_scene_map_channel
    {
        WISP_SCENE_MAP_MEAN, ///< of red, green and blue
        WISP_SCENE_MAP_RED,
        WISP_SCENE_MAP_GREEN,
        WISP_SCENE_MAP_BLUE,
    } wisp_scene_map_channel;

    /// Values of a parameter that differ from vertex to vertex: from a file of numbers, from an image by the coordinates of the
    /// surface, or from the colours of its vertices. 0 in the file is `from`, and 1 is `to`.
    typedef struct wisp_scene_map
    {
        wisp_component map; ///< WISP_MAP_..., see maps.h
        const char* file;   ///< PNG by its extension, else text; null: the colours of the vertices of the mesh
        wisp_scene_map_channel channel; ///< of an image or of colours
        float from, to;
        float constant;     ///< of the effect; the map has the values over it
        float lower, upper; ///< of the values
        int line, column;
        char path[64]; ///< of the key, for messages
    } wisp_scene_map;

#define WISP_SCENE_MAP_TEARING ( (wisp_component)UINT16_MAX ) ///< a map of the strength in `tearing`
#define WISP_SCENE_MAX_MAPS 17

    /// Whether a map is an image by its extension.
    WISP_API bool wisp_scene_map_is_image( const wisp_scene_map* map );

    /// Read the numbers of a map that is a text file.
    /// @param out [count] as in the file
    /// @return WISP_BAD_INPUT a word is no finite number (the message has its line), or another count (it has both);
    ///         WISP_IO_ERROR; WISP_NO_MEMORY
    WISP_API wisp_status wisp_scene_map_numbers( const wisp_scene_map* map, int count, float* out,
                                                 wisp_error* error );

    /// When a clip of an animation is played.
    typedef struct wisp_scene_clip
    {
        const char* name;
        float time;  ///< s, when it begins
        float speed; ///< s/s
        bool loop;   ///< it repeats until the next clip; false: its last pose stays
    } wisp_scene_clip;

    /// Clips that move a mesh with a skeleton.
    typedef struct wisp_scene_animation
    {
        const char* file;             ///< of the clips, already relative to the scene's folder; null: the mesh's
        const wisp_scene_clip* clips; ///< [clip_count] times rise, each more than `blend` after the one before
        int clip_count;
        float blend; ///< s, from the end of a clip to the next
        wisp_skin_method method;
    } wisp_scene_animation;

    /// One entry of `surfaces`. Texts and arrays belong to the scene.
    typedef struct wisp_scene_surface
    {
        const char* name; ///< unique among strands, surfaces, colliders and seams
        int line, column; ///< of the entry, for messages about it that come later

        wisp_scene_mesh mesh;     ///< of an instance nothing but the defaults
        int instance_of;          ///< index of the surface whose fabric this one shares, lower than its own; -1: none
        wisp_transform pose;      ///< where the scaled mesh starts
        wisp_scene_copies copies; ///< those are instances of this one at the end of the list
        bool has_start;
        wisp_scene_start start;

        float area_density, vertex_mass; ///< as in wisp_surface_def
        float mass_ratio; ///< factor of masses at the lowest vertex of the placed rest shape, from 1 at the highest

        wisp_scene_pins pins;        ///< of the surface's own keys; may hold nothing
        wisp_scene_pins* pin_groups; ///< [pin_group_count] no vertex is in two of them, or in one and in `pins`
        int pin_group_count;

        bool
            has_animation; ///< pins and motion targets follow it; without an effect that moves it every vertex is pinned
        wisp_scene_animation animation;

        bool has_motion_constraints;
        wisp_motion_constraints_def motion_constraints; ///< without arrays
        wisp_scene_path target_path;                    ///< how far the targets are from where the vertices start
        bool has_target_pivot;
        wisp_vec3 target_pivot; ///< m, what target_path turns about; without it: the centre of the vertices
        bool has_membrane;      ///< its own skin, and that of the balloon
        wisp_membrane_def membrane;
        bool has_tearing;
        wisp_tearing_def tearing; ///< without factors
        int max_new_vertices;     ///< spare vertices of the mesh; -1: a quarter of its vertices, at least 64
        bool has_frame;
        wisp_moving_frame_def frame; ///< its pose is the identity at the pivot
        wisp_scene_path frame_path;  ///< how far it is from where it starts
        bool has_frame_pivot;
        wisp_vec3 frame_pivot; ///< m, where the frame stands at the start; without it: the centre of the vertices
        float max_speed;       ///< m/s; infinite: none
        bool has_sleep;
        wisp_sleep_def sleep;
        bool has_detail;
        wisp_detail_def detail;

        wisp_vec3 velocity, angular_velocity;
        wisp_vec3 gravity; ///< the scene's unless the surface has its own
        float damping;
        float strain_limit[2]; ///< 0 and infinity: none
        int substeps;          ///< in a step of usual length; 0: those of the scene

        wisp_scene_map* maps; ///< [map_count]
        int map_count;

        bool has_cloth, has_balloon, has_implicit; ///< one of them at most
        wisp_cloth_def cloth;                      ///< the defaults if the scene has none
        wisp_balloon_def balloon;
        wisp_implicit_cloth_def implicit; ///< without pairs
        bool has_quad_links;              ///< its pairs are those of wisp_quad_pairs_make() for the recipe's plane
        bool has_outlet_nearest;
        wisp_vec3 outlet_nearest; ///< m, where the mesh starts
        float outlet_radius;      ///< m; besides the nearest vertex, those within it belong to the outlet
        const wisp_scene_gas_ratio_keyframe* gas_ratio_keyframes; ///< [gas_ratio_keyframe_count] times rise
        int gas_ratio_keyframe_count;

        wisp_solve_order solve_order;
        int tile_size;
        bool has_collision;
        wisp_collision_def collision;
        bool has_collider; ///< others collide with it
        wisp_collider_def collider;
        bool has_contact, has_boundary;
        wisp_contact_def contact;
        wisp_boundary_def boundary;

        bool request_points; ///< also if an output writes them
        bool has_compute;    ///< it is written; else points are requested
        bool request_normals, request_strain, request_speed, request_motion_stats;
        bool request_stats;    ///< of the balloon, or of the implicit cloth
        bool request_contacts; ///< figures of the collision
    } wisp_scene_surface;

    // ---- colliders ----

    /// One entry of `colliders`.
    typedef struct wisp_scene_collider
    {
        const char* name;
        int line, column;
        wisp_collider_def def;    ///< without the arrays of a mesh
        wisp_scene_mesh mesh;     ///< of a mesh, or of a convex body
        wisp_scene_path path;     ///< where it is
        wisp_scene_copies copies; ///< those are entries of their own at the end of the list
        bool request_reaction;    ///< what participants give it
    } wisp_scene_collider;

    // ---- seams ----

    /// One entry of `seams`.
    typedef struct wisp_scene_seam
    {
        const char* name;
        int line, column;
        int surfaces[2];      ///< indices into the scene's surfaces
        const int32_t* pairs; ///< [pair_count][2] numbers of vertices as the files or the recipes have them
        int pair_count;       ///< 0: those within a distance
        wisp_seam_def def;    ///< without surfaces and pairs
    } wisp_scene_seam;

    // ---- what happens when ----

    /// The user points at a place before a step, or changes parameters.
    typedef struct wisp_scene_hair_event
    {
        int step;    ///< in [0, steps)
        int strands; ///< index into the scene's strands
        bool has_cursor, begin_stroke;
        wisp_vec3 cursor;
        bool changes; ///< parameters differ from those of the entry before

        /// Of this entry or of one before it; without, the number is that of the strands.
        bool has_intensity, has_reach, has_stretch_stiffness, has_bend_stiffness, has_clump_radius;
        float intensity, stretch_stiffness, bend_stiffness;
        float reach, clump_radius; ///< m
        int line, column;          ///< of the entry, for messages
    } wisp_scene_hair_event;

    /// What is done to a surface, or to strands, before a step.
    typedef struct wisp_scene_event
    {
        int step;    ///< in [0, steps)
        int strands; ///< index into the scene's strands, -1: it is a surface's
        int surface; ///< index into the scene's surfaces, -1: it is that of strands, which know wind and detail alone
        bool has_gas_ratio, has_inflation_rate, has_open, has_wind, has_velocity, has_angular_velocity, has_gust,
            has_teleport, has_detail;
        float gas_ratio;
        float inflation_rate; ///< m^3/s
        bool open;
        wisp_vec3 wind;                       ///< m/s
        wisp_vec3 velocity, angular_velocity; ///< a zero vector where only the other one is written
        wisp_vec3 gust;                       ///< m/s
        bool gust_per_triangle;               ///< a vertex gets it once for each triangle that it meets
        wisp_vec3 teleport;                   ///< m, displacement
        wisp_detail detail;                   ///< level of detail
        int pin_group;                        ///< index into the surface's groups whose pins it changes, -1: all pins
        bool release, hold, detach; ///< lets pins go; holds them where they are; detaches them from their surface
        int attach_to;              ///< index of the surface that pins are attached to, -1: none
        int line, column;           ///< of the entry, for messages
    } wisp_scene_event;

    typedef struct wisp_scene_output
    {
        int strands;      ///< index into the scene's strands, -1: a surface is written
        int surface;      ///< index into the scene's surfaces, -1: strands are written
        const char* file; ///< as written; ends in .hair, .usda or .obj for strands, in .obj or .ply for surfaces
        int line, column;
    } wisp_scene_output;

    typedef struct wisp_scene
    {
        const char* name;        ///< of the file, as messages show it
        float dt;                ///< s, of a step; see wisp_scene_step_length()
        const float* dt_factors; ///< [dt_factor_count] factors of the steps in turn, over and over; null: all are 1
        int dt_factor_count;
        int steps;
        int frames_per_step; ///< that `wisp run` records, 1: no frames between steps
        int substeps, iterations;
        int workers; ///< 0 is one a core

        wisp_vec3 gravity; ///< m/s^2, of surfaces and of strands that move
        double origin
            [3]; ///< m, in the world, multiples of 8: all places of the scene are relative to it. 0 unless the first
                 ///< surface, or else the first strands, is placed more than 16 m away along an axis

        bool has_contact;
        wisp_contact_settings
            contact;                ///< how the contacts of all participants are found; the defaults if not written
        bool request_contact_stats; ///< of all participants together
        bool request_intersections; ///< and how many there are at the end of each step

        wisp_scene_strands* strands; ///< [strands_count], in the order of the file
        int strands_count;
        wisp_scene_surface* surfaces; ///< [surface_count], in the order of the file
        int surface_count;
        wisp_scene_collider* colliders; ///< [collider_count], in the order of the file
        int collider_count;
        wisp_scene_seam* seams; ///< [seam_count], in the order of the file
        int seam_count;
        wisp_scene_hair_event* commands; ///< [command_count], by step, and by strands within a step
        int command_count;
        wisp_scene_event* events; ///< [event_count], by step, and by strands and surface within a step
        int event_count;
        wisp_scene_output* outputs; ///< [output_count], in the order of the file
        int output_count;

        void* blocks; ///< memory of everything above
    } wisp_scene;

    /// Read a scene from a file.
    /// @param out receives the scene; all zero on failure
    /// @return WISP_BAD_INPUT the file is not a scene; WISP_IO_ERROR it cannot be read; WISP_NO_MEMORY
    WISP_API wisp_status wisp_scene_read( const char* path, wisp_scene* out, wisp_error* error );

    /// Read a scene from memory.
    /// @param text UTF-8, need not end in a zero
    /// @param name what messages call it, and whose folder relative files are in
    WISP_API wisp_status wisp_scene_parse( const char* text, size_t size, const char* name, wisp_scene* out,
                                           wisp_error* error );

    /// Have the entries that name certain files take arrays in their place.
    /// @param name of the scene, as it was read
    /// @param arrays [count] copied as pointers: they must outlive the scene. Checked when a world is made, as files are
    /// @return WISP_BAD_INPUT no entry names the file; WISP_NO_MEMORY
    WISP_API wisp_status wisp_scene_set_arrays( wisp_scene* scene, const wisp_scene_arrays* arrays, int count,
                                                wisp_error* error );

    /// Call a function for each file that a scene names, relative to the folder of the scene or the working directory as it is
    /// to be opened: without the name of a mesh behind #. Ends at the first failure.
    WISP_API wisp_status wisp_scene_files( const wisp_scene* scene,
                                           wisp_status ( *each )( void* user, const char* file, wisp_error* error ),
                                           void* user, wisp_error* error );

    /// @param step >= 0, counted from 0 @return s, its length
    WISP_API float wisp_scene_step_length( const wisp_scene* scene, int step );
    /// Multiply all substeps, those of entities too.
    WISP_API void wisp_scene_refine( wisp_scene* scene, int factor );
    /// Return the most substeps that an entity has of its own; 0: none has.
    WISP_API int wisp_scene_own_substeps( const wisp_scene* scene );
    /// @return s, where a step begins: the sum of the lengths before it
    WISP_API double wisp_scene_step_time( const wisp_scene* scene, int step );
    /// @return the first step that begins at a time or after it; may be beyond the last step
    WISP_API double wisp_scene_step_at( const wisp_scene* scene, float time );

    /// Make the strands of a scattered entry around those of its source, target after target. Each is its target moved by
    /// an offset; in two dimensions offsets lie in the plane.
    /// @param out receives the groom, to be released; empty on failure
    /// @return WISP_BAD_INPUT more than WISP_GROOM_MAX_GENERATED vertices; WISP_NO_MEMORY
    WISP_API wisp_status wisp_scene_make_scatter( const wisp_scene_scatter* scatter, const wisp_groom* source,
                                                  wisp_groom* out, wisp_error* error );

    /// Curves through strands as these start; a strand of one vertex has none.
    /// @param out receives the groom, to be released; empty on failure
    /// @return WISP_BAD_INPUT more than WISP_GROOM_MAX_GENERATED points; WISP_NO_MEMORY
    WISP_API wisp_status wisp_scene_make_curves( const wisp_curves_def* def, const wisp_groom* source,
                                                 wisp_groom* out, wisp_error* error );

    /// @return whether an animation moves every vertex of a surface, as of the skin of a character: nothing is solved for it
    bool wisp_scene_is_driven( const wisp_scene_surface* surface );

    /// @return whether a surface starts with pins of its own keys or of a group; those of an animation do not count
    WISP_API bool wisp_scene_has_pins( const wisp_scene_surface* surface );

    /// Null and a zero scene are allowed.
    WISP_API void wisp_scene_release( wisp_scene* scene );

#ifdef __cplusplus
}
#endif
