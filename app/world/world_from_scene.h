/// From a scene, which is data, to a running world: grooms and meshes read or generated, effects attached, requests,
/// hair events and events.
#pragma once

#include "groom.h"
#include "io_file.h"
#include "mesh.h"
#include "scene.h"
#include "wisp/fabric.h"
#include "wisp/wisp.h"

#include <stdio.h>

enum
{
    SCENE_MAX_MODULES = 32,
    SCENE_MAX_NOTES = 64,
    SCENE_NOTE_SIZE = 300,
};

/// Options of the command line that override the scene.
typedef struct scene_world_options
{
    int workers;      ///< 0: that of the scene
    const char* isa;  ///< null: the best available
    bool is_quiet;    ///< print no warnings, because the first of several worlds of one scene has printed them
    wisp_log_fn* log; ///< receives warnings and late errors on the calling thread; null: they go to stderr
    void* log_user;
    const wisp_allocator* allocator; ///< of the world; null: the C library
    bool only_used_modules;          ///< register those that the scene uses, not all of modules.inc
} scene_world_options;

typedef struct scene_animation scene_animation;

/// Pins of a surface that are held, move and are released together.
typedef struct scene_world_pins
{
    int32_t* vertices;  ///< [count] ascending
    wisp_vec3* starts;  ///< [count] m, where keyframes move them from; null: no keyframes, or those of an animation
    wisp_vec3* targets; ///< [count] buffer for their targets; null unless they move
    int count;
    wisp_vec3 pivot; ///< m, of their keyframes
    bool is_held;    ///< no event has released them since they were held
} scene_world_pins;

/// A surface of the scene in the world.
typedef struct scene_world_surface
{
    wisp_entity entity;
    wisp_fabric* fabric; ///< of this surface or of the one it is an instance of; a reference of its own
    wisp_mesh
        mesh; ///< initial mesh, with its present triangles; without triangles for an instance that does not tear
    wisp_mesh_repairs repairs; ///< repairs of the mesh; empty for an instance
    int32_t* pins;             ///< [pin_count] every vertex that the scene pins at the start, ascending
    int pin_count;
    scene_world_pins* groups; ///< [group_count] the surface's own pins, then the scene's groups
    int group_count;
    int spare_count;                     ///< last vertices of the mesh, which are in no triangle until it tears
    int split_count;                     ///< vertices that tearing had split when the triangles were read
    wisp_vec3 target_pivot, frame_pivot; ///< m, of the keyframes of motion targets and of the frame
    wisp_vec3* motion_targets;           ///< [vertex_count] buffer; null unless they move
    scene_animation* animation;          ///< null: none
    io_memory memory;                    ///< of pins, groups, targets and the animation
} scene_world_surface;

/// A collider of the scene in the world.
typedef struct scene_world_collider
{
    wisp_entity entity;
    wisp_mesh mesh;      ///< in its own frame: of a mesh collider itself, of a shape for pictures
    wisp_transform pose; ///< after the last step
} scene_world_collider;

typedef struct scene_world
{
    const wisp_scene* scene; ///< must outlive this
    wisp_world* world;
    wisp_entity* entities;           ///< [strands_count] also of ghosts and curves
    wisp_groom* grooms;              ///< [strands_count] the rest shape; an output's shape once outputs were written
    scene_world_surface* surfaces;   ///< [surface_count]
    scene_world_collider* colliders; ///< [collider_count]
    wisp_entity* seams;              ///< [seam_count]
    wisp_vec3* head_offsets;         ///< [strands_count] m, how far a user has dragged each head; null: none
    FILE* calls;                     ///< receives the calls before steps, as C; null: nothing does
    int last_call;                   ///< step of the last of them, -1: none yet
    int next_step;
    int next_command;
    int next_event;
    int module_count; ///< that are registered
    size_t
        empty_bytes; ///< of the world before anything was added: modules' states and workspaces, and the world itself
    bool is_quiet;
    wisp_log_fn* log;
    void* log_user;
    char ( *notes )
        [SCENE_NOTE_SIZE]; ///< [note_count] what has no effect or another one than it looks, and warnings, a line each
    int note_count;
    io_memory memory;     ///< of all lists but the notes
    char late_error[500]; ///< logged as an error by a call that continued; printed after the call
} scene_world;

/// Modules that act in a scene. @param out [SCENE_MAX_MODULES] @return their number
int scene_world_used_modules( const wisp_scene* scene, const wisp_module** out );

/// @param out zero on failure; must stay where it is, because the world's log points at it
/// @return the error; the message names the line of the scene if the cause is there
wisp_status scene_world_create( const wisp_scene* scene, const scene_world_options* options, scene_world* out,
                                wisp_error* error );

/// @return the group of a surface that holds a vertex now, -1: none
int scene_pins_holding( const scene_world_surface* surface, int32_t vertex );
/// What a host saves of the pins besides the world: which groups are held, and where keyframes move them from.
size_t scene_pins_state_size( const scene_world* world );
/// @param out [scene_pins_state_size()] bytes
void scene_pins_save( const scene_world* world, void* out );
void scene_pins_load( scene_world* world, const void* bytes );

/// Apply the events of the next step, then run it.
wisp_status scene_world_step( scene_world* world, wisp_error* error );

/// Advance by the time of a frame as wisp_world_advance() does, in steps of the scene with their events. Afterwards points are
/// interpolated between the last two steps.
/// @param seconds since the last call, >= 0
/// @return also WISP_CONFLICT the scene has dt_factors
wisp_status scene_world_advance( scene_world* world, float seconds, wisp_error* error );

/// Change parameters as a hair event does: a number stands for all strands, also where the scene has a list.
void scene_hair_event_apply( const wisp_scene_hair_event* event, wisp_frozen_hair_def* def );

/// Write the files of the scene's `output`, with width and colour where they are requested.
wisp_status scene_world_write_outputs( scene_world* world, wisp_error* error );

/// Read or generate a groom of the scene, and check it against the entry.
/// @param out to be released; empty on failure
wisp_status scene_groom( const wisp_scene* scene, int strands, wisp_groom* out, wisp_error* error );

/// The same with a source that exists already: the groom that the entry is scattered around, or that its curves follow.
/// @param source null if the entry needs none
wisp_status scene_groom_of( const wisp_scene* scene, int strands, const wisp_groom* source, wisp_groom* out,
                            wisp_error* error );
/// Find the entry whose groom another one needs. @return an index into the scene's strands, -1: none
int scene_groom_source( const wisp_scene* scene, int strands );

/// Read or generate the mesh of a surface, repair it as the scene says, and place it. Repairs are reported on stderr.
/// @param out to be released; empty on failure
wisp_status scene_surface_mesh( const wisp_scene* scene, int surface, wisp_mesh* out, wisp_error* error );

/// Have a scene compute the points of all bodies.
void scene_request_points( wisp_scene* scene );
/// The same, and the statistics that each can have. Statistics change no bit.
void scene_request_statistics( wisp_scene* scene );
/// Have a scene count intersections after every step. Surfaces without contact have theirs counted too, and meet nothing; implicit
/// cloth without contact is left out. No bit changes.
void scene_request_intersections( wisp_scene* scene );
/// Whether a surface takes part in contact.
bool scene_has_contact( const wisp_scene* scene );

/// Of strands and surfaces together.
int scene_world_vertices( const scene_world* world );
int scene_world_strands( const scene_world* world );

/// Bytes of the world and of the fabrics of its surfaces, each once.
size_t scene_world_bytes( const scene_world* world );

void scene_world_destroy( scene_world* world );

// ---- bodies for recordings and pictures ----

typedef enum scene_body_kind
{
    SCENE_BODY_STRANDS,
    SCENE_BODY_CLOTH,    ///< a surface that is not a balloon
    SCENE_BODY_BALLOON,  ///<
    SCENE_BODY_COLLIDER, ///< a rigid mesh
    SCENE_BODY_PLANE,    ///< an infinite collider; its mesh is a square of 2 m around its position
} scene_body_kind;

/// Arrays belong to the scene_world and stay as they are until it is destroyed.
typedef struct scene_body
{
    const char* name; ///< unique among all bodies
    scene_body_kind kind;
    int vertex_count;
    const int32_t* triangles; ///< [triangle_count][3], counter-clockwise seen from outside; null for strands
    int triangle_count;
    bool tears;             ///< vertices in the list of triangles change in steps
    bool is_led;            ///< a surface that nothing solves: it is drawn as what it is to others, a solid body
    const int32_t* offsets; ///< [strand_count + 1] of strands; else null
    int strand_count;
} scene_body;

/// Bodies are numbered: strands, then surfaces, then colliders, each in the order of the scene.
int scene_world_body_count( const scene_world* world );
/// Number of bodies that are not colliders: the first ones.
int scene_world_moving_count( const scene_world* world );
scene_body scene_world_body( const scene_world* world, int body );
/// Return the entity of a body that moves.
wisp_entity scene_world_entity( const scene_world* world, int body );
/// Return the substeps that a body that moves makes in a step of usual length. The world's plan is compiled if needed.
int scene_world_substeps( const scene_world* world, int body );

/// Values that can be requested of a body from the next step on.
typedef enum scene_request
{
    SCENE_REQUEST_POINTS,       ///< strands and surfaces
    SCENE_REQUEST_STRAIN,       ///< surfaces, strands with dynamics
    SCENE_REQUEST_SPEED,        ///< surfaces, strands with dynamics
    SCENE_REQUEST_WIDTH,        ///< strands with an appearance
    SCENE_REQUEST_COLOUR,       ///< strands with an appearance
    SCENE_REQUEST_MOTION_STATS, ///< surfaces, strands with dynamics
    SCENE_REQUEST_NORMALS       ///< surfaces
} scene_request;

/// Whether a body can have a value.
bool scene_world_has( const scene_world* world, int body, scene_request request );
/// Add a request to those of the scene. A second equal one changes nothing, and colliders need none: their points are known.
/// @return WISP_BAD_INPUT the body does not have it (the message names the body)
wisp_status scene_world_request( scene_world* world, int body, scene_request request, wisp_error* error );

/// Request the points of all bodies that are shown, for those who draw them in each frame.
wisp_status scene_world_request_shown( scene_world* world, wisp_error* error );
/// Whether pictures show a body: strands that others follow are hidden unless the scene says otherwise.
bool scene_world_is_shown( const scene_world* world, int body );

/// View a requested value where the engine keeps it: valid until the next call that changes the world.
/// @return WISP_BAD_INPUT the body does not have it; WISP_CONFLICT it is not requested, or no step was made
wisp_status scene_world_view( const scene_world* world, int body, scene_request request, wisp_view* out,
                              wisp_error* error );

/// Positions of the vertices. Before the first step: the initial ones. A collider: at its pose of the last step.
/// @param out [vertex_count]
/// @return WISP_CONFLICT a step was made and the points are not requested
wisp_status scene_world_points( const scene_world* world, int body, wisp_vec3* out, wisp_error* error );

/// A number per vertex. @param request strain, speed (zero before the first step) or width @param out [vertex_count]
wisp_status scene_world_numbers( const scene_world* world, int body, scene_request request, float* out,
                                 wisp_error* error );

/// The first map of a surface that has one, as its source has it: 0 to 1 of an image. @param out [vertex_count]
wisp_status scene_world_map( const scene_world* world, int surface, float* out, wisp_error* error );

/// Unit normal of every vertex of a surface. Before the first step: zero.
/// @param out [vertex_count]
wisp_status scene_world_normals( const scene_world* world, int body, wisp_vec3* out, wisp_error* error );

/// The boundary particles of a surface with a layer of them, after the last step.
/// @param surface index into the scene's surfaces
/// @return WISP_CONFLICT it has none, or no step was made
wisp_status scene_world_layer( const scene_world* world, int surface, wisp_boundary_view* out, wisp_error* error );

/// Colour of every vertex of strands. @param out [vertex_count] linear RGB
wisp_status scene_world_colours( const scene_world* world, int body, wisp_vec3* out, wisp_error* error );

/// Statistics of a surface or of moving strands. @return WISP_CONFLICT unless requested and a step was made
wisp_status scene_world_motion_stats( const scene_world* world, int body, wisp_motion_stats* out, wisp_error* error );

/// How far strands hold their shape, as of the last step. @return WISP_CONFLICT unless they are rods that move
wisp_status scene_world_strand_hold( const scene_world* world, int body, wisp_strand_hold* out, wisp_error* error );

/// Collision of a surface or of strands. @return WISP_CONFLICT unless the scene computes collision_stats
wisp_status scene_world_collision_stats( const scene_world* world, int body, wisp_collision_stats* out,
                                         wisp_error* error );

/// Simulated time of all steps so far, s.
double scene_world_time( const scene_world* world );

/// Return the linear colour of the next body of a scene, the same in pictures and recordings.
/// @param cloths, balloons 0 before the first; they are counted
wisp_vec3 scene_body_colour( scene_body_kind kind, int* cloths, int* balloons );

// ---- what a user does to a world while it runs: takes hold of a vertex, moves a collider, changes gravity and wind ----

// All of it acts from the next step on, and equal calls before equal steps give equal bits.

/// A vertex that a user holds.
typedef struct scene_hold
{
    int body, vertex;
    bool was_pinned; ///< of a surface: the scene pins the vertex too
    wisp_vec3 from;  ///< of strands: where the vertex was; m
    wisp_vec3 head;  ///< of strands: how far the head had been dragged then; m
} scene_hold;

/// Take hold of a vertex: of a surface it is pinned; of strands their head comes along.
/// @return WISP_BAD_INPUT no such body or vertex; WISP_CONFLICT the body is not free to be dragged (the message says why)
wisp_status scene_world_grab( scene_world* world, int body, int vertex, scene_hold* out, wisp_error* error );
/// Have a held vertex reach a place at the end of the next step. @param target m
wisp_status scene_world_drag( scene_world* world, const scene_hold* hold, wisp_vec3 target, wisp_error* error );
/// Free a vertex, unless the scene pins it. A head stays where it is.
wisp_status scene_world_let_go( scene_world* world, const scene_hold* hold, wisp_error* error );

/// Have a collider reach a place at the end of the next step, with the rotation that it has. @param place m, of its own origin
/// @return WISP_BAD_INPUT no such body; WISP_CONFLICT it is no collider, or keyframes move it
wisp_status scene_world_move_collider( scene_world* world, int body, wisp_vec3 place, wisp_error* error );

/// Set the gravity of all that moves. @param gravity m/s^2
wisp_status scene_world_set_gravity( scene_world* world, wisp_vec3 gravity, wisp_error* error );
/// Set the wind of all that feels air: cloth, and strands with drag. Cloth without air gets drag with its first wind.
/// @param wind m/s @param felt receives how many entities feel it
wisp_status scene_world_set_wind( scene_world* world, wisp_vec3 wind, int* felt, wisp_error* error );
