/// Wisp: position-based simulation of thin things. The public face: worlds, entities, steps, views.
///
/// Units are SI. Worlds are opaque and independent; there are no globals. No function is thread-safe on the same
/// world; different worlds may be used from different threads. A failed call changes nothing.
#pragma once

#include "wisp/base.h"
#include "wisp/jobs.h"

WISP_BEGIN_C

typedef struct wisp_world wisp_world;
typedef struct wisp_module wisp_module;
/// Number of a component; 0 is null.
typedef uint16_t wisp_component;

/// Components that exist in every world, in the order of components.h.
enum
{
    WISP_STRAND_REST = 1,
    WISP_STRAND_POSITION,
    WISP_STRAND_STIFFNESS,
    WISP_STRAND_VELOCITY,
    WISP_STRAND_PREVIOUS,
    WISP_STRAND_INVERSE_MASS,
    WISP_STRAND_LENGTH,
    WISP_STRAND_ROOT,
    WISP_STRAND_POSED,
    WISP_STRAND_POINTS, ///< vertices in the user's order: what a renderer wants
    WISP_POINT_WIDTH,
    WISP_POINT_COLOUR,
    WISP_PARTICLE_POSITION,
    WISP_PARTICLE_VELOCITY,
    WISP_PARTICLE_PREVIOUS,
    WISP_PARTICLE_TARGET,
    WISP_PARTICLE_LAST_VALID,
    WISP_PARTICLE_MASS,
    WISP_PARTICLE_GRAVITY,
    WISP_PARTICLE_DAMPING,
    WISP_PARTICLE_EXTERNAL_SOLVER,
    WISP_PARTICLE_CONTACTS,
    WISP_LINK_STIFFNESS,
    WISP_LINK_COMPLIANCE,
    WISP_LINK_LIMIT,
    WISP_HINGE_REST,
    WISP_HINGE_COTANGENT,
    WISP_HINGE_STIFFNESS,
    WISP_HINGE_COMPLIANCE,
    WISP_SURFACE_TETHERS,
    WISP_SURFACE_LEVELS,
    WISP_SURFACE_POINTS,  ///< vertices in the user's order: what a renderer wants
    WISP_SURFACE_NORMALS, ///< unit normals in the user's order
    WISP_POINT_STRAIN,    ///< largest strain of the edges at a vertex, for colouring
    WISP_POINT_SPEED,     ///< m/s, for colouring
    WISP_MOTION_STATS,    ///< read with wisp_read_motion_stats()
    WISP_SHARED_COMPONENT_COUNT,
};

/// How to make a world. Fill from wisp_default_world_def(). Copied; may die after the call (modules must stay).
typedef struct wisp_world_def
{
    const wisp_module* const* modules; ///< [module_count]; order of equals in the plan
    int module_count;
    wisp_allocator allocator; ///< default: the C library
    wisp_log_fn* log;         ///< default null: warnings and errors go to stderr
    void* log_user;
    wisp_parallel_for_fn* parallel_for; ///< default null: the engine's own workers
    void* parallel_for_user;
    int workers;     ///< 1 .. WISP_MAX_WORKERS; default 0: one a core. 1 never starts a thread
    const char* isa; ///< "baseline", "avx2" or "avx512" caps the instruction set; default null: WISP_ISA in the
                     ///< environment, else the best the processor has
    int substeps;    ///< >= 1, default 1
    int iterations;  ///< >= 1, default 1
    uint32_t cookie; ///< set by wisp_default_world_def(), asserted on use
} wisp_world_def;

WISP_API wisp_world_def wisp_default_world_def( void );

/// @param out receives the world, null on failure
/// @return WISP_BAD_INPUT a worker count, isa or module is not usable; WISP_NO_MEMORY.
///         There is no world to ask yet, so the message goes to `error` (may be null)
WISP_API wisp_status wisp_world_create( const wisp_world_def* def, wisp_world** out, wisp_error* error );
/// Null is allowed.
WISP_API void wisp_world_destroy( wisp_world* world );

/// The message of the last call on this world that failed; empty if none did. Owned by the world.
WISP_API const char* wisp_world_message( const wisp_world* world );

/// Strands, cooked once from a set of polylines. Fill from wisp_default_strands_def(). Copied; may die after the call.
typedef struct wisp_strands_def
{
    const wisp_vec3* points; ///< [offsets[strand_count]], m; finite, no coordinate beyond 1e6
    const int32_t* offsets;  ///< [strand_count + 1] first vertex of each strand, rising from 0; a strand may be empty
    int strand_count;        ///< >= 0
    int dimension;           ///< 2 (every z must be 0) or 3; default 3
    uint32_t cookie;
} wisp_strands_def;

WISP_API wisp_strands_def wisp_default_strands_def( void );

/// Add strands. @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT offsets fall, or a coordinate is not finite (the message names strand and vertex);
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_add_strands( wisp_world* world, const wisp_strands_def* def, wisp_entity* out );

/// How constraints answer, chosen per entity so that one scene can compare them.
typedef enum wisp_solver
{
    WISP_SOLVER_XPBD, ///< a compliance in SI units: the answer does not depend on iterations or the step (once converged)
    WISP_SOLVER_PBD, ///< a stiffness in [0, 1]: the share of an error taken away at once, as in Mueller et al. 2007
    WISP_SOLVER_COUNT,
} wisp_solver;

/// Particles of a triangle mesh. Fill from wisp_default_surface_def(). Copied; may die after the call.
typedef struct wisp_surface_def
{
    struct wisp_fabric* fabric; ///< cooked (fabric.h); the world takes a reference of its own
    const wisp_vec3* points; ///< [vertex_count] m, where the vertices start, the user's order; null: the rest shape
    float area_density;      ///< kg/m^2, > 0, default 0.15
    float vertex_mass;       ///< kg; above 0 every vertex weighs so much, whatever its area; default 0
    const int32_t* pins;     ///< [pin_count] vertices that move only as they are told, the user's order
    int pin_count;
    uint32_t cookie;
} wisp_surface_def;

WISP_API wisp_surface_def wisp_default_surface_def( void );

/// Add the particles of a mesh. Effects give them a material; without one they only fly.
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT a coordinate is not finite or beyond 1e6 m, a mass is not above 0, a pin is out of range (the
///         message names the vertex); WISP_NO_MEMORY
/// @note A vertex without triangles has no area: unless vertex_mass is given it is pinned, and a log line says so
WISP_API wisp_status wisp_add_surface( wisp_world* world, const wisp_surface_def* def, wisp_entity* out );

/// Hold vertices where they are from now on.
/// @param vertices [count] the user's numbers
WISP_API wisp_status wisp_pin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count );
/// Let vertices go: they get the mass back that their area gives them.
WISP_API wisp_status wisp_unpin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count );
/// Carry pinned vertices so that they are at the targets at the end of the next step, in a straight line.
/// @param targets [count] m
/// @return WISP_BAD_INPUT a vertex is not pinned, or a target is not finite
WISP_API wisp_status wisp_move_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices,
                                     const wisp_vec3* targets, int count );
/// @param gravity m/s^2; a zero vector takes it away, and its pass with it. Surfaces start without gravity
WISP_API wisp_status wisp_set_gravity( wisp_world* world, wisp_entity surface, wisp_vec3 gravity );
/// @param rate 1/s, >= 0: how fast all velocity dies away; 0 takes the pass away
WISP_API wisp_status wisp_set_damping( wisp_world* world, wisp_entity surface, float rate );
/// Keep every edge between two lengths, given as shares of its rest length. @param minimum in [0, 1] @param maximum >= 1;
/// 0 and infinity take the pass away
WISP_API wisp_status wisp_set_strain_limit( wisp_world* world, wisp_entity surface, float minimum, float maximum );
/// Set the velocity of all vertices to that of a rigid motion about the centre of mass.
/// @param linear m/s @param angular rad/s
WISP_API wisp_status wisp_set_velocity( wisp_world* world, wisp_entity surface, wisp_vec3 linear, wisp_vec3 angular );

/// Figures of a surface, or of strands that move, at the end of a step. Sums are in double and in a fixed order.
typedef struct wisp_motion_stats
{
    double mass;                ///< kg, of the vertices that are not pinned
    double centre[3];           ///< m, of that mass
    double momentum[3];         ///< kg m/s
    double angular_momentum[3]; ///< kg m^2/s about the centre
    double kinetic_energy;      ///< J
    double potential_energy;    ///< J, of the gravity that acts on it; 0 at the origin
    double volume;      ///< m^3, signed; of a mesh with a border: of the cone to the first vertex; 0 of strands
    double strain_max;  ///< largest |l/l0 - 1| of the edges or segments
    double strain_mean; ///< mean |l/l0 - 1| of the edges or segments
    double speed_max;   ///< m/s
} wisp_motion_stats;

/// @return WISP_CONFLICT unless WISP_MOTION_STATS is wanted and a step was made since
WISP_API wisp_status wisp_read_motion_stats( wisp_world* world, wisp_entity entity, wisp_motion_stats* out );

/// An entity whose state stopped being finite, or left its bounds, was put back to its last good state and takes no part
/// in steps any more.
WISP_API bool wisp_is_halted( const wisp_world* world, wisp_entity entity );
/// Let a halted entity take part again.
WISP_API wisp_status wisp_resume( wisp_world* world, wisp_entity entity );

/// Add an entity that shares the topology of another and starts at its rest shape.
WISP_API wisp_status wisp_add_instance( wisp_world* world, wisp_entity source, wisp_entity* out );

WISP_API wisp_status wisp_remove( wisp_world* world, wisp_entity entity );
WISP_API bool wisp_is_alive( const wisp_world* world, wisp_entity entity );

/// Ask for a component of an entity: asking creates the passes that answer it, from the next step on.
WISP_API wisp_status wisp_request( wisp_world* world, wisp_entity entity, wisp_component component );
WISP_API wisp_status wisp_cancel_request( wisp_world* world, wisp_entity entity, wisp_component component );

/// One step. The plan is recompiled first if components or requests changed.
/// @param seconds > 0
/// @return WISP_CONFLICT a pass reads what nobody supplies (the message names both); WISP_NO_MEMORY
WISP_API wisp_status wisp_world_step( wisp_world* world, float seconds );

/// A column of an entity in the user's order. Valid until the next call that changes the world.
typedef struct wisp_view
{
    const void* data;
    int count;     ///< rows
    size_t stride; ///< bytes from row to row
} wisp_view;

/// @return WISP_CONFLICT if nobody wants it or it is not in the user's order (only point.*, strand.points, surface.points and surface.normals are)
WISP_API wisp_status wisp_world_view( wisp_world* world, wisp_entity entity, wisp_component component,
                                      wisp_view* out );

/// One line a pass, always on. Times are of the last step; a fused pass is timed on samples of its items and scaled
/// to the measured time of its node.
typedef struct wisp_profile_line
{
    const char* pass;
    double seconds; ///< wall time
    int items;      ///< groups or entities it ran over
} wisp_profile_line;

typedef struct wisp_profile
{
    const wisp_profile_line* lines; ///< [count], plan order; owned by the world, valid until the next step
    int count;
    double seconds; ///< the whole step
} wisp_profile;

WISP_API wisp_profile wisp_world_profile( const wisp_world* world );

/// Numbers that went wrong or ran into a cap since the world was made, and the work that was asked for.
typedef enum wisp_counter
{
    WISP_COUNT_STEPS,
    WISP_COUNT_PLANS,           ///< how often the plan was compiled
    WISP_COUNT_NEIGHBOURS,      ///< neighbours found within the radius, at the last search of each command
    WISP_COUNT_CAPPED,          ///< queries that ran into the neighbour limit
    WISP_COUNT_COARSE_GRIDS,    ///< grids whose cells were widened because the scene is too sparse for its radius
    WISP_COUNT_SEARCHES,        ///< neighbour searches
    WISP_COUNT_HALTED,          ///< entities put back to their last good state and halted
    WISP_COUNT_STRAND_RESET,    ///< strands too far from their rest lengths to be solved for, laid out from the root
    WISP_COUNT_NOT_CONVERGED,   ///< linear solves that ended at their limit of iterations
    WISP_COUNT_INDEFINITE,      ///< linear solves that met negative curvature
    WISP_COUNT_DEGENERATE_LINK, ///< links between coincident vertices, which pull nowhere, each time they were met
    WISP_COUNT_STIFFNESS_CLAMPED, ///< substeps whose links were too stiff for floats to solve for, and were lowered
    WISP_COUNT_FIRST_ORDER,       ///< substeps that BDF2 left to implicit Euler
    WISP_COUNT_GRAVITY_SCALED, ///< strands that feel a share of their weight only: a substep holds no more in their curls
    WISP_COUNTER_COUNT,
} wisp_counter;

WISP_API uint64_t wisp_world_counter( const wisp_world* world, wisp_counter counter );
WISP_API const char* wisp_counter_name( wisp_counter counter );

/// Bytes the world holds now, columns, topology and warm buffers together.
WISP_API size_t wisp_world_memory( const wisp_world* world );
/// Workers, and the instruction set in use.
WISP_API int wisp_world_workers( const wisp_world* world );
WISP_API const char* wisp_world_isa( const wisp_world* world );

/// The plan as text: every pass with its reason, every absent one with what it lacks. Compiles it if needed.
/// wisp_world_explain() in explain.h gives the same, and more, as data.
/// @param write receives one line without a newline at a time
WISP_API wisp_status wisp_world_plan( wisp_world* world, void ( *write )( void* user, const char* line ),
                                      void* user );
/// Number of passes of the compiled plan; -1 if it cannot be compiled.
WISP_API int wisp_world_plan_passes( wisp_world* world );

/// 64-bit hash of an entity's column in the user's order, or of the entire state if entity is null.
WISP_API uint64_t wisp_world_hash( const wisp_world* world );
WISP_API wisp_status wisp_world_hash_column( wisp_world* world, wisp_entity entity, wisp_component component,
                                             uint64_t* out );

/// Bytes that wisp_world_snapshot() writes now.
WISP_API size_t wisp_world_snapshot_size( const wisp_world* world );
/// Write all columns of all entities, but for what means nothing between steps. @param size at least wisp_world_snapshot_size()
WISP_API wisp_status wisp_world_snapshot( const wisp_world* world, void* out, size_t size );
/// Put the columns back. The world must hold the same entities with the same components and shapes.
/// @return WISP_BAD_INPUT the bytes are not a snapshot of this world (checked before anything is changed)
WISP_API wisp_status wisp_world_restore( wisp_world* world, const void* bytes, size_t size );

WISP_END_C
