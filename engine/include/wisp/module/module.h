/// For modules: a module declares what it stores, reads and writes, and never depends on other modules.
#pragma once

#include "wisp/fabric.h"
#include "wisp/lines.h"
#include "wisp/module/definition.h"
#include "wisp/module/detail.h"
#include "wisp/module/jobs.h"
#include "wisp/module/kernels.h"
#include "wisp/module/vec.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

typedef struct wisp_frame wisp_frame;
typedef struct wisp_registry wisp_registry;

/// Rows of one kind. An entity owns a contiguous range of rows in each table.
typedef enum wisp_table
{
    WISP_TABLE_ENTITY = 0,        ///< one row an entity
    WISP_TABLE_STRAND_GROUP = 1,  ///< sixteen strands, lane = strand
    WISP_TABLE_STRAND_ROW = 2,    ///< one vertex of each of a group's sixteen strands
    WISP_TABLE_POINT = 3,         ///< one vertex in the user's order
    WISP_TABLE_PARTICLE = 4,      ///< one slot of a fabric: vertices in its order, then what pads; a multiple of 8
    WISP_TABLE_LINK = 5,          ///< one slot of a fabric's schedule of links; a multiple of 8
    WISP_TABLE_HINGE = 6,         ///< one slot of a fabric's schedule of hinges; a multiple of 8
    WISP_TABLE_EDGE = 7,          ///< one edge of a surface, each once, in an order that its users agree on
    WISP_TABLE_TRIANGLE = 8,      ///< one triangle of a surface, in the user's order
    WISP_TABLE_LEVEL_ROW = 9,     ///< one row of a fabric's coarse sheets, from fine to coarse; a multiple of 8
    WISP_TABLE_LEVEL_LINK = 10,   ///< one slot of the schedules of their links; a multiple of 8
    WISP_TABLE_COARSEST_ROW = 11, ///< one row of the coarsest sheet; a multiple of 8
    WISP_TABLE_PAIR = 12,         ///< one pair of vertices that are joined, in an order of the module
    WISP_TABLE_COUNT = 13,
} wisp_table;

/// One column: an array of row_size bytes a row, 64-byte aligned.
typedef struct wisp_column_def
{
    const char* name;
    uint32_t row_size; ///< bytes, a multiple of 4, without padding inside
} wisp_column_def;

/// Descriptor of a column, alone and as a line X( type, name, count ) of a column list.
#define WISP_COLUMN( type, name, count )                                                                             \
    {                                                                                                                \
#name, (uint32_t)( sizeof( type ) * ( count ) )                                                              \
    }
#define WISP_COLUMN_DEF( type, name, count ) WISP_COLUMN( type, name, count ),

/// A named set of columns of one table. Columns are allocated only once an entity has the component.
typedef struct wisp_component_def
{
    const char* name; ///< "room.noun", unique; a static string
    wisp_table table;
    const wisp_column_def* columns; ///< static
    int column_count;
} wisp_component_def;

/// Declare a component, or find it: two modules that need the same one meet here.
/// @return 0 when the registry is full or the same name is declared with another shape (the world says so)
WISP_API wisp_component wisp_declare_component( wisp_registry* registry, const wisp_component_def* def );
/// The same with all columns of a static array.
#define WISP_COMPONENT( registry, name, table, columns )                                                             \
    wisp_declare_component( registry, &( wisp_component_def ){ name, table, columns, WISP_COUNT( columns ) } )

/// A list of the components of a module has a row each: X( member, "room.noun", TABLE, columns... ). It makes the members of the state, the
/// columns, and the declarations of a registry `r` into a state `s`.
#define WISP_NO_COLUMNS                                                                                              \
    {                                                                                                                \
        NULL, 0                                                                                                      \
    } // of a mark
#define WISP_COMPONENT_MEMBER( member, name, table, ... ) wisp_component member;
#define WISP_COMPONENT_COLUMNS( member, name, table, ... )                                                           \
    static const wisp_column_def member##_columns[] = { __VA_ARGS__ };
#define WISP_COMPONENT_DECLARE( member, name, table, ... )                                                           \
    s->member = wisp_declare_component(                                                                              \
        r, &( wisp_component_def ){ name, WISP_TABLE_##table, member##_columns,                                      \
                                    member##_columns[0].row_size > 0 ? WISP_COUNT( member##_columns ) : 0 } );

/// What integers of a column may be.
typedef enum wisp_index_kind
{
    WISP_INDEX_NUMBER = 0,  ///< lowest .. highest
    WISP_INDEX_ROW = 1,     ///< lowest .. the last row of the entity in `table`
    WISP_INDEX_COUNT = 2,   ///< lowest .. the number of its rows there
    WISP_INDEX_SURFACE = 3, ///< a wisp_entity: null, or another surface
    WISP_INDEX_TRIANGLE =
        4, ///< of the surface in the first row of `surface`, or where that is 0 in this row; any if it is null
    WISP_INDEX_SAME = 5, ///< what the world has: fixed when the component was attached
} wisp_index_kind;

/// Integers that are used as indices, counts or enumerators. Snapshots are untrusted: wisp_world_restore() refuses one with
/// another value before anything changes.
typedef struct wisp_index_range
{
    wisp_component component;
    int column;
    size_t offset; ///< bytes from the start of a row
    int count;     ///< integers from there; 0: all to the end of the row
    wisp_index_kind kind;
    int32_t lowest, highest;
    wisp_table table;
    wisp_component surface; ///< a component of entities whose first column is a wisp_entity
} wisp_index_range;

/// The range of a member of the rows of a component, whose first column is this structure.
#define WISP_MEMBER_RANGE( id, type, member, low, high )                                                             \
    {                                                                                                                \
        .component = ( id ), .offset = offsetof( type, member ),                                                     \
        .count = (int)( sizeof( ( (type*)0 )->member ) / sizeof( int32_t ) ), .lowest = ( low ), .highest = ( high ) \
    }
/// The range of all integers of a column.
#define WISP_COLUMN_RANGE( id, number, low, high )                                                                   \
    {                                                                                                                \
        .component = ( id ), .column = ( number ), .lowest = ( low ), .highest = ( high )                            \
    }

/// Declare ranges of components that were declared before. @return WISP_BAD_INPUT the registry is full
WISP_API wisp_status wisp_declare_indices( wisp_registry* registry, const wisp_index_range* ranges, int count );

/// Order of a step. Substep and iteration are loops that vanish when nothing is in them.
typedef enum wisp_stage
{
    WISP_STAGE_INPUT = 0, ///< kinematic targets, parameters
    WISP_STAGE_FORCE = 1, ///< substep loop from here ...
    WISP_STAGE_PREDICT = 2,
    WISP_STAGE_CONTACT = 3,
    WISP_STAGE_PROJECT = 4,  ///< iteration loop
    WISP_STAGE_VELOCITY = 5, ///< ... to here
    WISP_STAGE_CHECK = 6,    ///< state checks; later stages see only what they let through or restored
    WISP_STAGE_DERIVE = 7,   ///< normals, samples, curves
    WISP_STAGE_SHAPE = 8,    ///< appearance without time
    WISP_STAGE_OBSERVE = 9,  ///< quality figures, output in the user's order
    WISP_STAGE_COUNT = 10,
} wisp_stage;

/// What a pass runs over.
typedef enum wisp_domain
{
    WISP_DOMAIN_ENTITY = 0, ///< called once an entity; may use wisp_frame_parallel()
    WISP_DOMAIN_STRAND_GROUP =
        1, ///< called for ranges of groups; touches only its own groups, so neighbours fuse, and
           ///< passes of the substep loop run all substeps of a block before the next block
    WISP_DOMAIN_PARTICLE_BLOCK =
        2, ///< called for ranges of blocks of WISP_PARTICLE_BLOCK particles; touches only its own
} wisp_domain;

/// Particles of a block; the last block of an entity may have fewer.
#define WISP_PARTICLE_BLOCK 256

/// A range of items of one entity on one worker. Item numbers start at 0 in each entity.
typedef struct wisp_span
{
    wisp_entity entity;
    int begin, end;
    int worker;
    int substep, iteration; ///< of the step and of the substep, from 0; behind their loops the last ones
} wisp_span;

typedef void wisp_pass_fn( wisp_frame* frame, const wisp_span* span, void* user );

#define WISP_MAX_USES 12
#define WISP_MAX_FUSED 16

typedef struct wisp_pass
{
    const char* name; ///< "module.verb", unique; a static string
    wisp_stage stage;
    wisp_domain domain;
    wisp_component required[WISP_MAX_USES]; ///< zero-terminated: the entity must have all, or the pass does not exist
    wisp_component
        excluded[WISP_MAX_USES];         ///< zero-terminated: the entity must have none, or the pass does not exist
    wisp_component reads[WISP_MAX_USES]; ///< zero-terminated: the entity has it or another pass writes it
    /// Zero-terminated: one must be requested or read by another pass, or the pass does not exist. All are attached to the entity. A
    /// component that the pass changes only where the entity has it is not listed: what is listed has to order the pass among
    /// those that use it, as the velocities do for the history of a strand.
    wisp_component writes[WISP_MAX_USES];
    /// Zero-terminated: components of other entities that the pass reads and writes. They put it in its place among the
    /// passes of those entities, and neither make passes exist nor supply anything. In the substep loop they also decide
    /// which entities share substeps (wisp_set_substeps).
    wisp_component foreign[WISP_MAX_USES];
    wisp_pass_fn* run;
    /// 0, or: run only if this component's rows were written since the pass last ran on the entity.
    wisp_component on_change;
    wisp_component among; ///< entities whose components are foreign have this one; 0: they may be any
    bool follows;         ///< it reads an entity that it does not list, and in a substep waits for that one
    bool spares;          ///< it does nothing to an entity that is apart (wisp_frame_is_apart())
    /// Null, or returns whether the pass has to run on the entity in this step. Called on the calling thread when all passes
    /// before it have run.
    bool ( *should_run )( wisp_frame* frame, wisp_entity entity, void* user );
    /// Null, or runs the pass for a crowd (instances.h), in the substep of a span whose entity is left open, with the bits of `run`.
    void ( *run_crowd )( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user );
    /// Null, or returns whether the entity can run in a crowd in this step.
    bool ( *joins_crowd )( wisp_frame* frame, wisp_entity entity, void* user );
    void* user;
    int grain;       ///< items per block, 0: default of the domain
    unsigned fabric; ///< wisp_fabric_arrays that it reads of the entity's fabric, or-ed; they are there when it runs
    unsigned detail; ///< wisp_pass_detail or-ed: at which detail it runs (module/detail.h); 0: where the entity moves
} wisp_pass;

/// What every row of a table of passes has: WISP_PASS( "module.verb", INPUT, ENTITY, run ), with a stage and a domain by their last words.
#define WISP_PASS( text, at, over, function )                                                                        \
    .name = ( text ), .stage = WISP_STAGE_##at, .domain = WISP_DOMAIN_##over, .run = ( function )

/// Declare passes in this order; the first failure ends it. @param user of every pass that has none
WISP_API wisp_status wisp_declare_passes( wisp_registry* registry, const wisp_pass* passes, int count, void* user );
static inline wisp_status wisp_declare_pass( wisp_registry* registry, const wisp_pass* pass )
{
    return wisp_declare_passes( registry, pass, 1, NULL );
}

/// Substeps [span->substep, substep_end) of a span of items.
typedef void wisp_fused_fn( wisp_frame* frame, const wisp_span* span, int substep_end, void* user );

/// Passes of groups of strands that can run together, all substeps of some groups in one go: in less time, and bit for bit
/// what the passes give one after another.
typedef struct wisp_fusion
{
    const char* name;                     ///< "module.noun"; a static string
    const char* required[WISP_MAX_FUSED]; ///< names of passes, null-terminated: the entity must have all
    const char* allowed[WISP_MAX_FUSED]; ///< the same: it may have them; with any other pass the passes are not fused
    wisp_fused_fn* run;
    void* user;
} wisp_fusion;

/// Declare passes, declared before, that can run together. They are fused in steps of one iteration per substep; one substep of
/// some blocks runs pass by pass, to measure their times.
WISP_API wisp_status wisp_declare_fusion( wisp_registry* registry, const wisp_fusion* join );

/// Passes that can run for several entities of one fabric side by side, in less time, and bit for bit what they give entity by
/// entity. Small entities that share nothing with others in the substep loop run so, in steps of one iteration per substep. All
/// substeps run in one go if entities have no other passes. Otherwise one pass can run side by side in each substep, between
/// passes that run entity by entity. Callbacks are called on any worker, for several groups at a time, and may touch only the
/// entities that they are given.
typedef struct wisp_batch
{
    const char* name;                     ///< "module.noun"; a static string
    const char* required[WISP_MAX_FUSED]; ///< names of passes, null-terminated: entities must have all
    /// The same: they may have them, all of them the same ones, and no others but those with `run_crowd`.
    const char* allowed[WISP_MAX_FUSED];
    const char* pass; ///< of the required ones, that can run side by side among any others; null: none
    int lanes;        ///< entities at once, at most WISP_MAX_BATCH
    /// Can the entity run beside the first one, in this step? Called for the first one too.
    bool ( *can_join )( wisp_frame* frame, wisp_entity first, wisp_entity entity, void* user );
    /// @param seconds [required, then allowed passes] 0; receives how the time divides
    /// @return bits of entities that are left as they were, and have to run alone
    uint32_t ( *run )( wisp_frame* frame, const wisp_entity* entities, int count, int worker, double* seconds,
                       void* user );
    /// Run `pass` in the substep of a span, whose entity is left open. @return as run
    uint32_t ( *run_pass )( wisp_frame* frame, const wisp_entity* entities, int count, const wisp_span* span,
                            void* user );
    void* user;
} wisp_batch;

#define WISP_MAX_BATCH 16

/// Run the passes with `run_crowd` of a stage for a crowd. @param span null only looks for them @return there are some
WISP_API bool wisp_frame_run_crowd( wisp_frame* frame, wisp_stage stage, const wisp_crowd* crowd,
                                    const wisp_span* span );

/// Declare passes, declared before, that can run side by side.
WISP_API wisp_status wisp_declare_batch( wisp_registry* registry, const wisp_batch* batch );

/// How places stand in the rows of a column.
typedef enum wisp_place_shape
{
    WISP_PLACE_QUADS = 0,  ///< [row][4]: x, y, z and a number
    WISP_PLACE_EIGHTS = 1, ///< [row / 8][3][8]
    WISP_PLACE_LANES = 2,  ///< [row][n][3][WISP_LANES] of strands
    WISP_PLACE_POSES = 3,  ///< three wisp_transform at the start of a row, or as many as fill it
} wisp_place_shape;

/// Say that a column holds places. They go along when an entity gets another origin of its rows (wisp_frame_offset()).
WISP_API void wisp_declare_places( wisp_registry* registry, wisp_component component, int column,
                                   wisp_place_shape shape );

/// Say which column of floats of the same shape holds what does not fit the digits of declared places. With another origin it is divided
/// anew.
WISP_API void wisp_declare_low( wisp_registry* registry, wisp_component component, int column, wisp_component low,
                                int low_column );

/// Say what a map (maps.h) does on surfaces with a component. A map that no such row allows is refused.
/// @param refusal null: the map acts on surfaces that have the component; else it is refused on them, with this message
WISP_API void wisp_declare_map( wisp_registry* registry, wisp_component map, wisp_component component,
                                const char* refusal );

/// Memory of a module in one world, zeroed, alive as long as the world. Call once in declare().
/// @return null without memory
WISP_API void* wisp_declare_state( wisp_registry* registry, size_t size );

/// A rigid motion that takes an entity from where it is to another place at once.
typedef struct wisp_teleport_motion
{
    wisp_transform motion;
    bool keep_velocity; ///< velocities turn with the motion; false: they become zero
    wisp_vec3 far;      ///< m, of the way: what the origin of the rows goes, of which `motion` is the rest
} wisp_teleport_motion;

/// What a module keeps of entities beside their rows, one object each. The engine frees them with their entities.
typedef struct wisp_objects wisp_objects;
/// Declare objects of the module. @param bytes of the allocator, which an object holds @return null, with the registry's error
WISP_API wisp_objects* wisp_declare_objects( wisp_registry* registry,
                                             void ( *release )( void* object, const wisp_allocator* allocator ),
                                             size_t ( *bytes )( const void* object ) );
/// @return the object of an entity; null: it has none
WISP_API void* wisp_find_object( const wisp_objects* objects, wisp_entity entity );
/// Make room for the object of an entity. @return false without memory
WISP_API bool wisp_reserve_object( wisp_objects* objects, wisp_entity entity );
/// Give an entity another object, for which there is room, or null: the one that it had is freed. Between steps.
WISP_API void wisp_set_object( wisp_objects* objects, wisp_entity entity, void* object );
/// Walk all objects, by the index of their entities. @param place 0 before the first one @return null behind the last one
WISP_API void* wisp_next_object( const wisp_objects* objects, int* place );

/// Go on to the next entity that has a component, by index. Where a module keeps nothing else of its entities, this is its list of them.
/// @param entity null before the first one @return false behind the last one
WISP_API bool wisp_next_entity( const wisp_registry* registry, wisp_component component, wisp_entity* entity );

typedef struct wisp_line_list wisp_line_list;
/// Add a line between two points in the rows of an entity.
WISP_API void wisp_add_line( wisp_line_list* list, wisp_entity entity, wisp_vec3 from, wisp_vec3 to,
                             wisp_vec3 colour );

/// What a state must hear of. Zero-initialised members are never called.
typedef struct wisp_state_hooks
{
    /// The world ends: free what the state points to. Entities are gone or about to go.
    void ( *release )( void* state, const wisp_allocator* allocator );
    /// An entity is about to be removed; it and its components are still there. Other entities may lose components here,
    /// nothing else of the world may change.
    void ( *removed )( void* state, wisp_world* world, wisp_entity entity );
    /// An entity is teleported: move the module's own columns of it, and what goes along. The engine moves shared columns
    /// (positions, velocities, roots, points) of surfaces and of what a module says it moves, after this call.
    /// @param is_moved set it if the entity is one that this module moves
    wisp_status ( *teleported )( void* state, wisp_world* world, wisp_entity entity,
                                 const wisp_teleport_motion* teleport, bool* is_moved );
    /// The triangles of a surface have changed (wisp_world_change_triangles()): make anew what was made of them.
    /// @param before the fabric that it had; a triangle is the same one in both, with its corners in the same order
    wisp_status ( *triangles_changed )( void* state, wisp_world* world, wisp_entity surface,
                                        const wisp_fabric* before );
    /// A step has run all of its passes. Entities and their topology may change here, and what the host must not do in a step may
    /// not be called.
    wisp_status ( *stepped )( void* state, wisp_world* world );
    /// Passes of the stage INPUT have run, substeps begin. On the calling thread; may write nothing but the state itself.
    void ( *begun )( void* state, wisp_frame* frame, const wisp_allocator* allocator );
    /// The plan is about to be made anew: attach and detach what depends on components of other modules.
    wisp_status ( *planning )( void* state, wisp_world* world );
    /// The plan was made anew: tell what now has no effect (wisp_world_tell()).
    void ( *planned )( const void* state, wisp_world* world );
    /// Count what the state points to, for wisp_world_memory_parts().
    /// @param outside add bytes to it that are not of the world's allocator, such as those of Embree
    /// @return bytes of the world's allocator, without the state itself
    size_t ( *memory )( const void* state, size_t* outside );
    /// Add lines of an entity for wisp_debug_lines(), from what is stored. Nothing of the world may change.
    void ( *lines )( const void* state, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                     wisp_line_list* list );
    const struct wisp_sleep_hooks* sleep;   ///< wisp/module/sleep.h; copied
    const struct wisp_detail_hooks* detail; ///< wisp/module/detail.h; copied
} wisp_state_hooks;

/// Give the module's state its hooks. Call once in declare(), behind wisp_declare_state().
WISP_API void wisp_declare_hooks( wisp_registry* registry, const wisp_state_hooks* hooks );

/// @return iterations per substep of the world, >= 1: a pass that needs rows only with several does not read them with one
WISP_API int wisp_registry_iterations( const wisp_registry* registry );

/// Warm memory that is no state: one zeroed block a worker, kept from step to step, outside snapshots and hashes.
/// @param release frees what the block points to; may be null
/// @param memory returns the bytes of what it points to; may be null
/// @return a number for wisp_frame_workspace(), -1 without memory
WISP_API int wisp_declare_workspace( wisp_registry* registry, size_t size,
                                     void ( *release )( void* workspace, const wisp_allocator* allocator ),
                                     size_t ( *memory )( const void* workspace ) );

/// A module is one static constant.
struct wisp_module
{
    const char* name;
    wisp_status ( *declare )( wisp_registry* registry ); ///< components and passes, touches no scene data
};

/// Topology of strands: immutable, cooked once, shared by every instance. Lane order puts strands of equal length
/// side by side; the arrays lead back to the user's order.
typedef struct wisp_strand_topology
{
    int strand_count, vertex_count, group_count, row_count;
    int dimension;
    const int32_t* offsets;     ///< [strand_count + 1] first vertex of a strand, the user's order
    const int32_t* group_row;   ///< [group_count + 1] first row of a group
    const int32_t* lane_strand; ///< [group_count][16] the user's strand, -1 in an empty lane
    const int32_t* lane_count;  ///< [group_count][16] vertices, 0 in an empty lane
} wisp_strand_topology;

// ---- inside a pass ----

/// First row of the entity's range in a column; null if the component has no rows.
WISP_API void* wisp_frame_column( wisp_frame* frame, wisp_entity entity, wisp_component component, int column );
WISP_API bool wisp_frame_has( wisp_frame* frame, wisp_entity entity, wisp_component component );
WISP_API const wisp_strand_topology* wisp_frame_strands( wisp_frame* frame, wisp_entity entity );
WISP_API const wisp_fabric* wisp_frame_fabric( wisp_frame* frame, wisp_entity entity );
/// Coordinates in rows are relative to a place near the entity, which changes only between steps, by whole metres.
/// @return m, to be added to the host's coordinates of an entity to get those of its rows
WISP_API wisp_vec3 wisp_frame_offset( wisp_frame* frame, wisp_entity entity );
/// @return m, to be added to coordinates in rows of one entity to get those in rows of another; zero where they touch
WISP_API wisp_vec3 wisp_frame_between( wisp_frame* frame, wisp_entity from, wisp_entity to );
/// Points that a module shares of a surface, as they were at the start of the step if the surface has the component
/// WISP_SAMPLES_READ (sampling.h). @return null if no module does
WISP_API const struct wisp_samples* wisp_frame_samples( wisp_frame* frame, wisp_entity surface );
/// The particles [begin, end) of a span of particle blocks.
WISP_API wisp_span wisp_frame_particles( wisp_frame* frame, const wisp_span* span );
/// Length of a substep of an entity, s.
WISP_API float wisp_frame_dt( const wisp_frame* frame, wisp_entity entity );
/// Substeps of an entity in this step. Which one runs is in the span.
WISP_API int wisp_frame_substeps( const wisp_frame* frame, wisp_entity entity );
/// Fraction of the path of a kinematic object, from where the last step left it to its target, after some substeps of an
/// entity. It ends below 1 if the step is no whole number of substeps; the next step begins there.
WISP_API float wisp_frame_progress( const wisp_frame* frame, wisp_entity entity, int substeps );
/// Fraction of the rest of that path that a substep of an entity covers; 1 in the last one of an even step.
WISP_API float wisp_frame_progress_left( const wisp_frame* frame, wisp_entity entity, int substep );
/// @return where the step before left what moved from one pose to another
WISP_API wisp_transform wisp_frame_reached( const wisp_frame* frame, wisp_transform from, wisp_transform to );
/// Find what carries an entity with a moving frame (moving_frame.h) in a substep: the motion of the frame that it does not feel.
/// @param turn receives the rotation of the motion
/// @return false if there is none in this step
WISP_API bool wisp_frame_find_motion( wisp_frame* frame, const wisp_span* span, wisp_frame_motion_args* args,
                                      wisp_quat* turn );
/// Move the frame of an entity to the pose that it has been given for this step.
WISP_API void wisp_frame_update_pose( wisp_frame* frame, wisp_entity entity );
/// Does the entity run its substeps on its own in this step, as if passes that spare it did not exist? It does if strand.reach says so.
WISP_API bool wisp_frame_is_apart( const wisp_frame* frame, wisp_entity entity );
/// End that: bring the entity to where the others are. Only from wisp_pass.should_run of a pass in stages FORCE to CONTACT.
WISP_API void wisp_frame_join( wisp_frame* frame, wisp_entity entity );
/// Iterations of a substep.
WISP_API int wisp_frame_iterations( const wisp_frame* frame );
/// Run the projections of a range of groups of strands once more, lengths last. Thread-safe for groups apart.
WISP_API void wisp_frame_project_again( wisp_frame* frame, const wisp_span* groups );
/// Is the entity left out of passes?
WISP_API bool wisp_frame_is_halted( wisp_frame* frame, wisp_entity entity );
/// A surface at the start of a step, and where its particles go in it by themselves.
typedef struct wisp_surface_motion
{
    const float *position, *velocity, *target; ///< [slot][4]; the latter two may be null
    float seconds;                             ///< of the step
} wisp_surface_motion;
/// @param surface an entity with particles @param seconds of the step @return its rows, which last as long as the step
WISP_API wisp_surface_motion wisp_frame_surface_motion( wisp_frame* frame, wisp_entity surface, float seconds );
/// @return where a particle is at the end of the step: a pinned one at its target
static inline wisp_vec3 wisp_surface_motion_end( const wisp_surface_motion* m, int32_t slot )
{
    const size_t quad = (size_t)slot * 4;
    const wisp_vec3 at = wisp_v3_load( m->position + quad );
    if ( m->position[quad + 3] > 0.0f )
    {
        return m->velocity != NULL ? wisp_v3_mul_add( at, m->seconds, wisp_v3_load( m->velocity + quad ) ) : at;
    }
    return m->target != NULL && m->target[quad + 3] != 0.0f ? wisp_v3_load( m->target + quad ) : at;
}
/// Leave the entity out of every pass from the next step on; the world counts it and logs the message. Thread-safe.
WISP_API void wisp_frame_halt( wisp_frame* frame, wisp_entity entity, const char* message );
WISP_API const wisp_kernels* wisp_frame_kernels( wisp_frame* frame );
/// All workers in an entity pass that runs alone; only the calling worker where many small entities share a wave.
WISP_API const wisp_parallel* wisp_frame_parallel( wisp_frame* frame, const wisp_span* span );
WISP_API void* wisp_frame_workspace( wisp_frame* frame, int workspace, int worker );
/// Steps finished before this one.
WISP_API uint64_t wisp_frame_step( wisp_frame* frame );
/// Run a schedule: tile colours one after another, the tiles of a colour in parallel.
/// @param run called on one worker for a range: groups of eight constraints [begin, end)
WISP_API void wisp_run_schedule( const wisp_parallel* parallel, const wisp_schedule* schedule,
                                 void ( *run )( const void* args, int begin, int end ), const void* args );
/// A sum over items: blocks in parallel, added in their order, so that bits do not depend on the workers.
typedef struct wisp_summation
{
    /// Find the sums of a block of items [begin, end). @param sums [sum_count] receives them
    void ( *run )( const wisp_kernels* kernels, const void* args, int begin, int end, double* sums );
    const void* args;
    int item_count, grain; ///< items, and those of a block
    int together;          ///< blocks that a worker takes at once, >= 1
    int sum_count;
} wisp_summation;
/// @param sums [sum_count] receives 0 of no items @return false: no memory, and the frame fails
WISP_API bool wisp_frame_sum( wisp_frame* frame, const wisp_span* span, const wisp_summation* sum, double* sums );
/// Bring velocities nearer to the rigid motion with their momentum and angular momentum, or to rest where a vertex is pinned.
/// @param args position, velocity, and fraction or fractions
WISP_API void wisp_approach_rigid_motion( const wisp_kernels* kernels, const wisp_parallel* parallel,
                                          const wisp_fabric* fabric, const wisp_rigid_args* args );
/// The same for a crowd. @param args [lane]
WISP_API void wisp_approach_rigid_motions( const wisp_kernels* kernels, const wisp_crowd* crowd,
                                           wisp_rigid_args* args );
/// A callback of wisp_parallel_for() that runs a kernel over its items, `size` rows each. Its context has the kernels, and arguments.
#define WISP_KERNEL_RANGE( loop_type, function, kernel, arguments, size )                                            \
    static void function( void* context, int begin, int end, int worker )                                            \
    {                                                                                                                \
        (void)worker;                                                                                                \
        const loop_type* loop = context;                                                                             \
        loop->kernels->kernel( &loop->arguments, (size)*begin, (size)*end );                                         \
    }
/// The same with a context of its own.
#define WISP_KERNEL_LOOP( loop_type, function, kernel, type, size )                                                  \
    typedef struct loop_type                                                                                         \
    {                                                                                                                \
        type args;                                                                                                   \
        const wisp_kernels* kernels;                                                                                 \
    } loop_type;                                                                                                     \
    WISP_KERNEL_RANGE( loop_type, function, kernel, args, size )

/// Report a failure from inside a pass; the step returns one of them and finishes its other passes. Thread-safe.
WISP_API void wisp_frame_fail( wisp_frame* frame, wisp_status status, const char* format, ... ) WISP_PRINTF( 3, 4 );
/// Add to a counter of the world. Thread-safe; sums are order-free.
WISP_API void wisp_frame_count( wisp_frame* frame, wisp_counter counter, uint64_t amount );

// ---- between steps, for a module's public functions ----

/// Release memory of a module. Null is ignored.
static inline void wisp_release( const wisp_allocator* allocator, void* memory, size_t bytes )
{
    if ( memory != NULL )
    {
        allocator->release( allocator->user, memory, bytes );
    }
}

/// Begin a call of the host, before anything else: the message of the world becomes empty.
/// @return WISP_BAD_INPUT the world is null; WISP_CONFLICT a step of it runs: the call comes from a callback or from another thread
WISP_API wisp_status wisp_world_begin( wisp_world* world );
/// Begin a call that is given a definition: read it and check all its ranges, as wisp_def_read() does.
/// @param entity that it is for, which must live; null: for none @param def receives it
WISP_API wisp_status wisp_world_begin_def( wisp_world* world, const wisp_entity* entity, const wisp_fields* fields,
                                           void* def, const void* given );
/// Check values that take the place of one of a definition.
/// @param values one of the type of the member, or [count] floats; null: there are none
/// @param of what has one each, such as "vertex"; null: there is one alone
/// @return WISP_BAD_INPUT, "subject: name of vertex 5: got value, expected range"
WISP_API wisp_status wisp_world_check_values( wisp_world* world, const wisp_fields* fields, const char* name,
                                              const void* values, int count, const char* of );
/// The same for a call about an entity, with or without those before it.
/// @return WISP_STALE_ID the entity was removed or never existed, with a message
WISP_API wisp_status wisp_world_check_entity( wisp_world* world, wisp_entity entity );
/// @return WISP_BAD_INPUT the pointer is null; the message has its name
WISP_API wisp_status wisp_world_check_pointer( wisp_world* world, const char* name, const void* pointer );
/// @return WISP_BAD_INPUT the count is negative, or above 0 with a null list; the message has the name of the list
WISP_API wisp_status wisp_world_check_list( wisp_world* world, const char* name, const void* list, int count );
/// As wisp_remove(), wisp_request() and wisp_cancel_request(), inside a call: the message of the world stays.
WISP_API void wisp_world_remove( wisp_world* world, wisp_entity entity );
WISP_API wisp_status wisp_world_request( wisp_world* world, wisp_entity entity, wisp_component component,
                                         bool is_requested );

/// Add an entity that is neither strands nor a surface: it has rows in WISP_TABLE_ENTITY, and in WISP_TABLE_PAIR, for what a module
/// attaches. @param pair_count at least 0 @param out receives the entity, null on failure
WISP_API wisp_status wisp_world_add_pairs( wisp_world* world, int pair_count, wisp_entity* out );
/// The host's memory, as the world counts it. Valid as long as the world.
WISP_API const wisp_allocator* wisp_world_allocator( wisp_world* world );
/// State of a module in this world. @return null when the module is not registered
WISP_API void* wisp_world_module_state( wisp_world* world, const char* module );
/// What an entity is to be for a call, or-ed; 0: anything alive.
enum
{
    WISP_IS_SURFACE = 1,
    WISP_IS_STRANDS = 2,
};
/// Begin a call that needs a module: it is registered, and the entity, or null, is alive and one of these.
/// @param state receives the module's state @return WISP_CONFLICT, WISP_STALE_ID, with a message
WISP_API wisp_status wisp_world_find_state( wisp_world* world, const char* module, const wisp_entity* entity,
                                            unsigned kinds, void** state );
/// The same in a function that returns the status: declares the state.
#define WISP_FIND_STATE( type, state, world, module, entity, kinds )                                                 \
    void* state##_found;                                                                                             \
    WISP_TRY( wisp_world_find_state( world, module, entity, kinds, &state##_found ) );                               \
    type* const state = state##_found
/// Begin a call that fills a structure: it is not null, and zero until the call succeeds.
WISP_API wisp_status wisp_world_begin_read( wisp_world* world, void* out, size_t size );
/// Run the function of a pass on one entity between steps, on the calling thread: for what a view shows before the first step. Compiles
/// the plan if needed. @return what the function reported by wisp_frame_fail(), or as wisp_world_explain()
WISP_API wisp_status wisp_world_run( wisp_world* world, wisp_entity entity, wisp_pass_fn* run, void* user );
/// Let other modules read the points that one keeps on a surface.
/// @param samples must live until they are withdrawn by null, or the surface is removed
WISP_API void wisp_world_share_samples( wisp_world* world, wisp_entity surface, const struct wisp_samples* samples );
/// As wisp_frame_offset() and wisp_frame_between(), between steps.
WISP_API wisp_vec3 wisp_world_offset( const wisp_world* world, wisp_entity entity );
WISP_API wisp_vec3 wisp_world_between( const wisp_world* world, wisp_entity from, wisp_entity to );
/// Return coordinates of the host in rows, with the offset of their entity.
static inline wisp_vec3 wisp_to_rows( wisp_vec3 p, wisp_vec3 offset )
{
    const bool is_offset = offset.x != 0.0f || offset.y != 0.0f || offset.z != 0.0f; // -0 stays -0 without
    wisp_vec3 moved = { p.x + offset.x, p.y + offset.y, p.z + offset.z };
    return is_offset ? moved : p;
}
/// The same of a pose, normalised.
static inline wisp_transform wisp_pose_to_rows( wisp_transform pose, wisp_vec3 offset )
{
    return wisp_transform_make( pose.rotation, wisp_to_rows( pose.translation, offset ) );
}
/// Give two entities, one of which reads rows of the other, one origin of their rows from now on.
WISP_API void wisp_world_tie( wisp_world* world, wisp_entity a, wisp_entity b );
/// Give an entity and what comes near it one origin of their rows, because it may touch them. Others are left out of its passes.
WISP_API void wisp_world_let_meet( wisp_world* world, wisp_entity entity );
WISP_API bool wisp_world_lets_meet( const wisp_world* world, wisp_entity entity );
/// Have the arrays of a lean fabric that a function between steps reads; passes name theirs in wisp_pass.fabric.
/// @param arrays wisp_fabric_arrays or-ed @return WISP_NO_MEMORY, with a message
WISP_API wisp_status wisp_world_need_fabric( wisp_world* world, wisp_entity surface, unsigned arrays );
/// Give an entity a component: rows are zeroed. Nothing happens if it has it already.
WISP_API wisp_status wisp_world_attach( wisp_world* world, wisp_entity entity, wisp_component component );
WISP_API wisp_status wisp_world_detach( wisp_world* world, wisp_entity entity, wisp_component component );
WISP_API bool wisp_world_has( const wisp_world* world, wisp_entity entity, wisp_component component );

/// Whether an entity is to have a component.
enum
{
    WISP_USED = 1,      ///< or true: attached
    WISP_REQUESTED = 2, ///< its passes run
};
typedef struct wisp_component_use
{
    wisp_component component;
    int use; ///< or-ed; 0: the entity is to lack it
} wisp_component_use;

/// Attach and request what is used, then detach the rest. Without memory nothing changes.
WISP_API wisp_status wisp_world_set_components( wisp_world* world, wisp_entity entity, const wisp_component_use* all,
                                                int count );
/// Give an entity a component with a first row, or null: take it away. @param row values of its first column, size bytes
WISP_API wisp_status wisp_world_set_row( wisp_world* world, wisp_entity entity, wisp_component component,
                                         const void* row, size_t size );
/// Fill the first row of a component, if the entity has it: WISP_FILL( world, entity, component, type, members... ).
#define WISP_FILL( world, entity, component, type, ... )                                                             \
    do                                                                                                               \
    {                                                                                                                \
        type* const row_ = wisp_world_column( world, entity, component, 0 );                                         \
        if ( row_ != NULL )                                                                                          \
        {                                                                                                            \
            *row_ = ( type ){ __VA_ARGS__ };                                                                         \
        }                                                                                                            \
    } while ( 0 )
/// Coarse sheets of a surface forget how it moved and find their masses again, before the next step. Call it where a module
/// changes masses, pins or velocities from outside a step. A surface without coarse sheets is left as it is.
WISP_API void wisp_world_restart_levels( wisp_world* world, wisp_entity surface );
/// Multiply coefficients of links, hinges and coarse sheets by the maps of a surface. Call it when a module has filled
/// those columns with constants. A surface without maps is left as it is.
WISP_API void wisp_world_apply_maps( wisp_world* world, wisp_entity surface );
/// As wisp_frame_column, to read or write; counts as a change. @return null also for a stale entity
WISP_API void* wisp_world_column( wisp_world* world, wisp_entity entity, wisp_component component, int column );
WISP_API const wisp_strand_topology* wisp_world_strands( wisp_world* world, wisp_entity entity );
WISP_API const wisp_fabric* wisp_world_fabric( wisp_world* world, wisp_entity entity );

typedef struct wisp_rest_lengths
{
    float mean, shortest, longest; ///< m, 0 without an edge or segment of a length above 0, which are not counted
} wisp_rest_lengths;

/// Measure the edges of a surface, whose fabric must have them, or the segments of strands.
WISP_API wisp_rest_lengths wisp_world_rest_lengths( wisp_world* world, wisp_entity entity );

/// Give a surface other triangles, as many as it has, between steps or in wisp_state_hooks.stepped. It gets a fabric of its own, in
/// which vertices keep their slots; what is stored of edges, links and hinges goes along. Masses follow the areas. Coarse sheets and
/// tethers are not made again, so the surface must have none.
/// @param triangles [triangle_count][3] slots: an edge of a triangle that is new is an edge of the old mesh between the parents of
///        its ends
/// @param parents [slot_count] a slot that was in no triangle is a copy of its parent from now on; all others are their own parents
/// @return WISP_NO_MEMORY: nothing changed, unless a module lacks memory for what it makes anew
WISP_API wisp_status wisp_world_change_triangles( wisp_world* world, wisp_entity surface, const int32_t* triangles,
                                                  const int32_t* parents );

/// Move rows of points, and of velocities: [row_count][row_floats], x y z first; what is behind them stays. Either may be null.
WISP_API void wisp_teleport_rows( const wisp_teleport_motion* teleport, float* points, float* velocities,
                                  int row_count, int row_floats );
/// The same for rows of strands, [row_count][3][WISP_LANES].
WISP_API void wisp_teleport_lanes( const wisp_teleport_motion* teleport, float* points, float* velocities,
                                   int row_count );
/// @return the pose that a body has after the teleport
WISP_API wisp_transform wisp_teleport_pose( const wisp_teleport_motion* teleport, wisp_transform pose );
/// Move the shared columns of an entity that goes along with another one.
WISP_API void wisp_world_move_columns( wisp_world* world, wisp_entity entity, const wisp_teleport_motion* teleport );
/// Room for another element behind `count` of a list that belongs to the module's state.
/// @param capacity elements that there is room for, 0 with a null array; doubles @return false without memory
WISP_API bool wisp_world_reserve( wisp_world* world, void** array, int* capacity, int count, size_t element_size );

/// Keep a message for wisp_world_message(), hand it to the log of the host if there is one, and return the status.
WISP_API wisp_status wisp_world_fail( wisp_world* world, wisp_status status, const char* format, ... )
    WISP_PRINTF( 3, 4 );
/// Log a warning: what was asked for is done, but not in full.
WISP_API void wisp_world_warn( wisp_world* world, const char* format, ... ) WISP_PRINTF( 2, 3 );
/// Warn that a setting has no effect: once for an entity and a sentence, and of 32 at most.
/// @param sentence static
WISP_API void wisp_world_tell( wisp_world* world, wisp_entity entity, bool is_so, const char* sentence );

WISP_END_C
