/// What bindings to other languages share: scenes and their parameters, worlds, values, input, snapshots, accuracy, recorders. Handles
/// are opaque, arguments are plain, and nothing is printed: messages go to the log of the options. web/ and python/ build on it.
///
/// python/build_extension.py hands the declarations of this file to cffi. So it has no preprocessor but the includes, and no types that
/// build_extension.py does not know.
#pragma once

#include "world_from_scene.h"
#include "tune_search.h"

// ---- scenes ----

/// The text of a scene, what was read of it, and the parameters of its accuracy, which are those of `wisp tune`.
typedef struct binding_scene binding_scene;

/// Read a scene from memory.
/// @param name what messages call it, and whose folder relative files are in
/// @param arrays [array_count] meshes and strands in place of files; copied. May be null with a count of 0
/// @return as wisp_scene_parse() and wisp_scene_set_arrays()
wisp_status binding_scene_parse( const char* text, size_t size, const char* name, const wisp_scene_arrays* arrays,
                                 int array_count, binding_scene** out, wisp_error* error );
/// Read a scene from a file. @return as wisp_scene_read()
wisp_status binding_scene_read( const char* path, binding_scene** out, wisp_error* error );
/// Worlds that were made of it stay valid. Null is allowed.
void binding_scene_close( binding_scene* scene );

/// The text as it was read. @param size receives bytes
const char* binding_scene_text( const binding_scene* scene, size_t* size );
/// s, of a step
double binding_scene_dt( const binding_scene* scene );
/// Steps of the scene's own run.
int binding_scene_steps( const binding_scene* scene );
/// @param out [3] m/s^2
void binding_scene_gravity( const binding_scene* scene, float* out );

/// 0 where nothing moves in time.
int binding_parameter_count( const binding_scene* scene );
const char* binding_parameter_name( const binding_scene* scene, int parameter );
bool binding_parameter_is_unordered( const binding_scene* scene, int parameter );
/// @param out [16] @return how many values there are
int binding_parameter_values( const binding_scene* scene, int parameter, double* out );
/// The scene's own value.
double binding_parameter_value( const binding_scene* scene, int parameter );
/// The text of the scene with other parameters, where every other byte stays, and other values of any fields, which comments do not survive.
/// @param values [parameter count] of the parameters
/// @param fields a mapping of paths, as suites have them, and values, in YAML or JSON; `null` removes a field. May be null
/// @param out receives a block for binding_free() @return WISP_BAD_INPUT a path names nothing of the scene
wisp_status binding_scene_edit( const binding_scene* scene, const double* values, const char* fields, char** out,
                                size_t* size, wisp_error* error );
/// The parameters that a search has found, from a file to a file.
/// @param configuration [parameter count] index of a value for each
wisp_status binding_scene_edit_file( const binding_scene* scene, const char* from, const int* configuration,
                                     const char* to, wisp_error* error );
void binding_free( void* block );

// ---- worlds ----

/// A world and the scene that it was made of.
typedef struct binding_world binding_world;

typedef struct binding_options
{
    int workers;          ///< 0: those of the scene
    const char* isa;      ///< null: the best available
    int reference_factor; ///< 0: the scene as it is; else its converged run, with that multiple of the finest substeps
    bool is_quiet;        ///< no warnings
    wisp_log_fn* log;     ///< receives warnings and late errors on the calling thread; null: stderr
    void* log_user;
} binding_options;

/// Make a world, with the points of all shown bodies requested.
/// @param scene may be closed afterwards
wisp_status binding_world_open( const binding_scene* scene, const binding_options* options, binding_world** out,
                                wisp_error* error );
/// Null is allowed.
void binding_world_close( binding_world* world );

/// Make a step of the scene, with its events.
wisp_status binding_world_step( binding_world* world, wisp_error* error );
/// Advance by the time of a frame, as wisp_world_advance() does, in steps of the scene with its events.
/// @param seconds since the last call, >= 0
/// @return also WISP_CONFLICT the scene has dt_factors
wisp_status binding_world_advance( binding_world* world, float seconds, wisp_error* error );
int binding_world_step_count( const binding_world* world );
/// s
double binding_world_time( const binding_world* world );
/// As `wisp run` prints it.
uint64_t binding_world_hash( const binding_world* world );
int binding_world_workers( const binding_world* world );
const char* binding_world_isa( const binding_world* world );
/// Write the files of the scene's `output`.
wisp_status binding_world_write_outputs( binding_world* world, wisp_error* error );

// ---- bodies: strands, surfaces, colliders ----

int binding_body_count( const binding_world* world );
const char* binding_body_name( const binding_world* world, int body );
/// A scene_body_kind.
int binding_body_kind( const binding_world* world, int body );
int binding_body_vertices( const binding_world* world, int body );
/// [3 * triangle count], null for strands; until the world is closed. Those of a body that tears change in steps.
const int32_t* binding_body_triangles( const binding_world* world, int body );
bool binding_body_tears( const binding_world* world, int body );
int binding_body_triangle_count( const binding_world* world, int body );
/// [strands + 1], null for others; until the world is closed
const int32_t* binding_body_offsets( const binding_world* world, int body );
int binding_body_strands( const binding_world* world, int body );
/// Whether pictures show a body, so that its points can be read.
bool binding_body_is_shown( const binding_world* world, int body );
/// Whether a body was halted since its state was not finite or left its bounds. Colliders never are.
bool binding_body_is_halted( const binding_world* world, int body );
wisp_status binding_body_resume( binding_world* world, int body, wisp_error* error );

// ---- values: a scene_request each ----

/// Whether a body can have a value.
bool binding_body_has( const binding_world* world, int body, int value );
/// Whether the scene computes a value itself, so that requesting it changes nothing.
bool binding_body_computes( const binding_world* world, int body, int value );
/// Have a value computed from the next step on. What the scene does not compute becomes part of the hash.
wisp_status binding_request( binding_world* world, int body, int value, wisp_error* error );
/// Floats of a vertex: 3 or 1.
int binding_value_width( int value );
/// Whether the engine has memory of a value, which each step writes: not before the first step, not of colliders, and not of points
/// that binding_world_advance() has interpolated.
bool binding_value_is_live( const binding_world* world, int body, int value );
/// A live value where the engine keeps it. In a world of a scene no entity is added or removed, so it stays there, and each
/// step writes it, until the world is closed.
/// @param out receives [vertices][width]
/// @return WISP_CONFLICT it is not live, or not requested
wisp_status binding_value_view( const binding_world* world, int body, int value, const float** out,
                                wisp_error* error );
/// A value as it is now: before the first step the start positions, and zeros.
/// @param out [vertices][width]
wisp_status binding_value_copy( const binding_world* world, int body, int value, float* out, wisp_error* error );
/// @return WISP_CONFLICT unless requested and a step was made
wisp_status binding_motion_stats( const binding_world* world, int body, wisp_motion_stats* out, wisp_error* error );

// ---- costs ----

/// s, of the last step
double binding_step_seconds( const binding_world* world );
int binding_profile_count( const binding_world* world );
const char* binding_profile_pass( const binding_world* world, int line );
double binding_profile_seconds( const binding_world* world, int line );
int binding_counter_count( void );
const char* binding_counter_name( int counter );
uint64_t binding_counter( const binding_world* world, int counter );
/// Of the world and of the fabrics of its surfaces.
size_t binding_memory_bytes( const binding_world* world );
/// @param out [capacity] @return the number of parts, which may exceed `capacity`
int binding_memory_parts( const binding_world* world, wisp_memory_part* out, int capacity );

// ---- input, from the next step on ----

/// Take hold of a vertex: of a surface it is pinned, of strands their head comes along. Again: no change.
wisp_status binding_grab( binding_world* world, int body, int vertex, wisp_error* error );
/// Have a held vertex reach a place at the end of the next step. @param x, y, z m
wisp_status binding_drag( binding_world* world, int body, int vertex, float x, float y, float z, wisp_error* error );
wisp_status binding_let_go( binding_world* world, int body, int vertex, wisp_error* error );

/// Pin vertices of a surface where they are. @param vertices [count]
wisp_status binding_pin( binding_world* world, int body, const int32_t* vertices, int count, wisp_error* error );
/// Release pinned vertices of a surface.
wisp_status binding_unpin( binding_world* world, int body, const int32_t* vertices, int count, wisp_error* error );
/// Have pinned vertices reach their targets at the end of the next step. @param targets [count][3] m
/// @return also WISP_CONFLICT the scene's keyframes move the pins
wisp_status binding_move_pins( binding_world* world, int body, const int32_t* vertices, const float* targets,
                               int count, wisp_error* error );

wisp_status binding_move_collider( binding_world* world, int body, float x, float y, float z, wisp_error* error );
/// Where a collider's own origin is. @param out [3] m
wisp_status binding_collider_place( const binding_world* world, int body, float* out, wisp_error* error );
wisp_status binding_set_gravity( binding_world* world, float x, float y, float z, wisp_error* error );
/// @param felt receives how many entities feel it
wisp_status binding_set_wind( binding_world* world, float x, float y, float z, int* felt, wisp_error* error );

// ---- frozen hair under a brush ----

typedef struct binding_hair
{
    float intensity, reach, stretch_stiffness, bend_stiffness, clump_radius;
    bool freezes, aligns, clumps;
    float temperature_celsius, wetness; ///< of the scene's climate or the default one
} binding_hair;

bool binding_hair_is_frozen( const binding_world* world, int body );
wisp_status binding_hair_read( binding_world* world, int body, binding_hair* out, wisp_error* error );
/// Other parameters from the next step on. One number replaces a value for each strand. Only the parameters are read.
wisp_status binding_hair_set( binding_world* world, int body, const binding_hair* hair, wisp_error* error );
/// The next step updates the strands. The scene's own events that are still to come are over: they would take the brush out of
/// the user's hand. @param x, y, z m
wisp_status binding_hair_command( binding_world* world, int body, float x, float y, float z, wisp_error* error );
/// Forget the alignment of all strands, and draw new random numbers at the next step.
wisp_status binding_hair_begin_stroke( binding_world* world, int body, wisp_error* error );
/// The stiffness of strands in a climate, by the scene's curve or the default one.
wisp_status binding_hair_climate_stiffness( binding_world* world, int body, float temperature, float wetness,
                                            double* out, wisp_error* error );

// ---- snapshots ----

/// Compile the plan, which adds the columns that steps fill, and tell the bytes of a snapshot.
wisp_status binding_snapshot_prepare( binding_world* world, size_t* size, wisp_error* error );
/// @param size at least that of binding_snapshot_prepare()
wisp_status binding_snapshot( const binding_world* world, void* out, size_t size, wisp_error* error );
/// @return WISP_BAD_INPUT the bytes are no snapshot of this world, or it has other components since then; nothing has changed then
wisp_status binding_restore( binding_world* world, const void* bytes, size_t size, wisp_error* error );

// ---- what accuracy costs ----

/// The converged run of a scene, which `wisp accuracy`, `wisp tune` and suites made of the scene have too.
typedef struct binding_reference binding_reference;

typedef struct binding_tune_def
{
    double error, budget_ms; ///< m, ms; one of them, the other 0
    double limit;            ///< s of wall time
    int workers;             ///< 0: those of the scene
    const char* isa;         ///< null: the best available
    bool ( *progress )( void* user, int run_count,
                        int max_runs ); ///< after every run; null: not. False ends the search
    void* user;
} binding_tune_def;

typedef struct binding_reference_info
{
    double doubt; ///< m, how far a coarser converged run is from it
    double until; ///< s, how long motion is compared
    bool parts;   ///< no longer because two converged runs part then
} binding_reference_info;

/// Read the reference of a scene, or make it.
/// @param scene must stay open until the reference is closed
/// @param length s of motion that is compared; 0: the scene, at most 1 s
/// @param go_on called after every step of all runs; null: not. False fails the call
/// @param log receives warnings on the calling thread; null: stderr
wisp_status binding_reference_open( const binding_scene* scene, double length, bool ( *go_on )( void ),
                                    wisp_log_fn* log, binding_reference** out, binding_reference_info* info,
                                    wisp_error* error );
/// Null is allowed.
void binding_reference_close( binding_reference* reference );
/// Run and time a scene of the same bodies. @param workers, isa as in binding_tune_def
wisp_status binding_reference_measure( const binding_reference* reference, const binding_scene* scene, int workers,
                                       const char* isa, tune_sample* out, wisp_error* error );
/// Find the cheapest parameters of the scene within an error, or the most accurate ones within a time.
/// @param out to be released with tune_release()
wisp_status binding_tune( const binding_reference* reference, const binding_tune_def* def, tune_result* out,
                          wisp_error* error );

// ---- recorders ----

typedef struct binding_recorder binding_recorder;

/// Record all bodies but planes from now on. Requests their points. The extension of the path selects the format (record.h).
/// @param every steps between two frames, >= 1
/// @param world must stay open until the recorder is closed
wisp_status binding_recorder_open( binding_world* world, const char* path, int every, binding_recorder** out,
                                   wisp_error* error );
/// Write a frame, if the step that was made last has one. Call once before the first step, and after each.
wisp_status binding_recorder_step( binding_recorder* recorder, wisp_error* error );
int binding_recorder_frames( const binding_recorder* recorder );
/// Finish the files, after any failure too. Null is allowed.
wisp_status binding_recorder_close( binding_recorder* recorder, wisp_error* error );

// ---- recordings ----

/// A .wisp file and the frame of it that was read last.
typedef struct binding_recording binding_recording;

/// @return as wisp_recording_open(); also WISP_BAD_INPUT it has no whole frame
wisp_status binding_recording_open( const char* path, binding_recording** out, wisp_error* error );
/// @param bytes [size] must stay until the recording is closed @param name for messages
wisp_status binding_recording_open_memory( const void* bytes, size_t size, const char* name, binding_recording** out,
                                           wisp_error* error );
/// Null is allowed.
void binding_recording_close( binding_recording* recording );
int binding_recording_frames( const binding_recording* recording );
/// False: the file was cut off.
bool binding_recording_is_complete( const binding_recording* recording );
/// s, between two frames
double binding_recording_dt( const binding_recording* recording );
/// Read a frame, whose time, hash and points are then those of the recording.
wisp_status binding_recording_seek( binding_recording* recording, int frame, wisp_error* error );
double binding_recording_time( const binding_recording* recording );
/// Of the run after this frame; 0 if the file has none.
uint64_t binding_recording_hash( const binding_recording* recording );
int binding_recording_bodies( const binding_recording* recording );
const char* binding_recording_name( const binding_recording* recording, int body );
int binding_recording_vertices( const binding_recording* recording, int body );
const int32_t* binding_recording_triangles( const binding_recording* recording, int body );
/// Whether triangles are those of the frame that was sought last.
bool binding_recording_tears( const binding_recording* recording, int body );
int binding_recording_triangle_count( const binding_recording* recording, int body );
const int32_t* binding_recording_offsets( const binding_recording* recording, int body );
int binding_recording_strands( const binding_recording* recording, int body );
/// m, [vertices][3], until the recording is closed
const float* binding_recording_points( const binding_recording* recording, int body );
