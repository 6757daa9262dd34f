/// Wisp: position-based simulation of thin things. Worlds, entities, requests, steps and views.
///
/// Units are SI. Worlds are opaque and independent of each other; there are no globals. No function is thread-safe on
/// the same world; different worlds may be used on different threads. A failed call changes nothing (but see wisp_world_step()), and prints nothing unless the
/// host gave a log. Null pointers, removed entities and definitions that no function has filled are WISP_BAD_INPUT or
/// WISP_STALE_ID. A call during a step of the same world, from a callback or another thread, is WISP_CONFLICT.
///
///     const wisp_module* const modules[] = { &wisp_cloth_module };
///     wisp_world_def def = wisp_default_world_def();
///     def.modules = modules, def.module_count = 1, def.substeps = 10;
///     wisp_world* world;
///     wisp_world_create( &def, &world, NULL );
///
///     wisp_surface_def surface = wisp_default_surface_def();     // fabric from wisp_fabric_cook(), see fabric.h
///     surface.fabric = fabric, surface.pins = corners, surface.pin_count = 2;
///     wisp_entity cloth;
///     wisp_add_surface( world, &surface, &cloth );
///     wisp_set_cloth( world, cloth, &material );                 // an effect, see cloth.h
///     wisp_request( world, cloth, WISP_SURFACE_POINTS );         // a request creates the passes that answer it
///
///     wisp_view view;
///     wisp_world_step( world, 1.0f / 60.0f );
///     wisp_world_view( world, cloth, WISP_SURFACE_POINTS, &view );
#pragma once

#include "wisp/base.h"
#include "wisp/shapes.h"

WISP_BEGIN_C

typedef struct wisp_world wisp_world;
typedef struct wisp_module wisp_module;
/// Number of a component; 0 is null. The end of this file lists those of every world.
typedef uint16_t wisp_component;

// ---- worlds ----

/// How to create a world. Fill from wisp_default_world_def(). Copied; need not outlive the call (the modules must).
typedef struct wisp_world_def
{
    uint32_t size; ///< bytes; set by wisp_default_world_def()
    const wisp_module* const*
        modules;              ///< [module_count]; passes that the plan cannot order otherwise run in this order
    int module_count;         ///< default 0
    wisp_allocator allocator; ///< default: the C library
    wisp_log_fn* log;         ///< default null: warnings go to stderr, failed calls only to wisp_world_message()
    void* log_user;           ///< passed to log
    wisp_parallel_for_fn* parallel_for; ///< one call per wave of passes; default null: the engine's own threads
    void* parallel_for_user;            ///< passed to parallel_for
    int workers;                        ///< 1 .. WISP_MAX_WORKERS; default 0: one per core. 1 never starts a thread
    const char*
        isa; ///< "baseline", "avx2" or "avx512" limits the instruction set; default null: the environment variable
             ///< WISP_ISA, else the best that the processor supports
    int substeps;   ///< per step of usual length, 1 .. 1000000, default 10; see wisp_world_step()
    int iterations; ///< per substep, 1 .. 1000000, default 1
    int longest_step; ///< usual steps that one step simulates, 1 .. 1000, default 8: the rest of a longer one is left out
} wisp_world_def;

WISP_DEFINITION( world_def );

/// Create a world.
/// @param out receives the world, null on failure
/// @param error receives the message on failure, since there is no world yet to hold it; may be null
/// @return WISP_BAD_INPUT a worker count, isa or module is not usable; WISP_NO_MEMORY
WISP_API wisp_status wisp_world_create( const wisp_world_def* def, wisp_world** out, wisp_error* error );
/// Destroy a world and everything in it. Null is allowed. During a step of the world, from a callback or another thread, nothing
/// happens but a warning.
WISP_API void wisp_world_destroy( wisp_world* world );

/// @return the message of the last call on this world; empty if it did not fail. Owned by the world. Of a null world and during a
///         step it says so
WISP_API const char* wisp_world_message( const wisp_world* world );

// ---- surfaces: the particles of a triangle mesh ----

/// Particles of a triangle mesh. Fill from wisp_default_surface_def(). Copied; need not outlive the call.
typedef struct wisp_surface_def
{
    uint32_t size;              ///< bytes; set by wisp_default_surface_def()
    struct wisp_fabric* fabric; ///< cooked (fabric.h); the world takes a reference of its own
    const wisp_vec3* points; ///< [vertex_count] m, start positions in the user's order; default null: the rest shape
    float area_density;      ///< kg/m^2, > 0, default 0.15
    float vertex_mass;       ///< kg; above 0 it is the mass of every vertex, whatever its area; default 0
    const int32_t* pins;     ///< [pin_count] vertices that move only by wisp_move_pins(), the user's order
    int pin_count;           ///< default 0
    int spare_count;         ///< last vertices that are in no triangle on purpose: effects may take them; default 0
    wisp_vec3 gravity;       ///< m/s^2, default (0, -9.81, 0), as for strands; zero: none, and no pass
} wisp_surface_def;

WISP_DEFINITION( surface_def );

/// Add the particles of a mesh. Effects give them a material; without an effect they only fly.
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT a coordinate is not finite or beyond 1e6 m, a mass is not above 0, or a pin is out of range (the
///         message names the vertex); WISP_NO_MEMORY
/// @note A vertex without triangles has no area. Unless vertex_mass is given it is pinned, and a log line says so.
WISP_API wisp_status wisp_add_surface( wisp_world* world, const wisp_surface_def* def, wisp_entity* out );

/// Read the triangles of a surface, which change where it tears.
/// @param out [count][3] vertices in the user's order, triangles in theirs
/// @return WISP_BAD_INPUT `count` is not the number of triangles; WISP_CONFLICT the entity is not a surface; WISP_STALE_ID
WISP_API wisp_status wisp_read_triangles( wisp_world* world, wisp_entity surface, int32_t* out, int count );
/// Pin vertices where they are.
/// @param vertices [count] in the user's order
WISP_API wisp_status wisp_pin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count );
/// Release pinned vertices. They get back the mass that their area gives them, and start at rest.
/// @param vertices [count] in the user's order
WISP_API wisp_status wisp_unpin( wisp_world* world, wisp_entity surface, const int32_t* vertices, int count );
/// Move pinned vertices so that they reach the targets at the end of the next step, in a straight line.
/// @param vertices [count] in the user's order
/// @param targets [count] m
/// @return WISP_BAD_INPUT a vertex is not pinned, or a target is not finite
WISP_API wisp_status wisp_move_pins( wisp_world* world, wisp_entity surface, const int32_t* vertices,
                                     const wisp_vec3* targets, int count );
/// Change the gravity of a surface. Strands have wisp_set_strand_gravity().
/// @param gravity m/s^2; zero removes gravity and its pass
WISP_API wisp_status wisp_set_gravity( wisp_world* world, wisp_entity surface, wisp_vec3 gravity );
/// Set the damping of all velocities of a surface.
/// @param rate 1/s, >= 0; 0 removes the pass
WISP_API wisp_status wisp_set_damping( wisp_world* world, wisp_entity surface, float rate );
/// Keep the length of every edge between two fractions of its rest length.
/// @param minimum in [0, 1]
/// @param maximum >= 1; a minimum of 0 with an infinite maximum removes the pass
WISP_API wisp_status wisp_set_strain_limit( wisp_world* world, wisp_entity surface, float minimum, float maximum );
/// Set the velocities of all vertices to those of a rigid motion about the centre of mass.
/// @param linear m/s @param angular rad/s
WISP_API wisp_status wisp_set_velocity( wisp_world* world, wisp_entity surface, wisp_vec3 linear, wisp_vec3 angular );
/// Set the velocities of chosen vertices, such as those that were just unpinned: wisp_unpin() leaves them at rest, however their
/// targets moved. Pinned vertices stay at rest.
/// @param vertices [count] in the user's order
/// @param velocities [count] m/s
/// @return WISP_BAD_INPUT a vertex is out of range, or a velocity is not finite or above 1e6 m/s, and none is changed;
///         WISP_CONFLICT the entity is not a surface; WISP_STALE_ID
WISP_API wisp_status wisp_set_vertex_velocities( wisp_world* world, wisp_entity surface, const int32_t* vertices,
                                                 const wisp_vec3* velocities, int count );
/// Add a velocity to the vertices of all triangles whose normal is against it, as a sudden gust does: a sheet is hit on its
/// front alone. It is added once, at once, whatever the step, the mass and the area. Pinned vertices stay. Steady air is the
/// wind of cloth and strands.
/// @param gust m/s, at most 1e6; zero does nothing
/// @param per_triangle false: a vertex gets the gust once; true: once for each such triangle around it, as in the boundary
///        particle paper's program, so that another mesh is blown away at another speed
/// @return WISP_BAD_INPUT a coordinate is not finite or too large, or a vertex would be faster than 1e6 m/s, and none is
///         changed; WISP_CONFLICT the entity is not a surface; WISP_NO_MEMORY
WISP_API wisp_status wisp_apply_gust( wisp_world* world, wisp_entity surface, wisp_vec3 gust, bool per_triangle );

/// How constraints respond to an error. Chosen per entity, so that one scene can compare both.
typedef enum wisp_solver
{
    WISP_SOLVER_XPBD =
        0, ///< compliance in SI units: once converged, the result does not depend on iterations or the step
           ///< (Macklin, Mueller and Chentanez 2016)
    WISP_SOLVER_PBD =
        1, ///< stiffness in [0, 1], the fraction of an error that one projection removes (Mueller et al. 2007)
    WISP_SOLVER_COUNT = 2,
} wisp_solver;

/// Integration of time.
typedef enum wisp_integrator
{
    WISP_INTEGRATOR_EULER = 0, ///< implicit Euler: first order, damps motion
    WISP_INTEGRATOR_BDF2 =
        1, ///< second order, from the last two substeps. A substep goes back to Euler where that would gain
           ///< energy (WISP_COUNT_FIRST_ORDER)
    WISP_INTEGRATOR_COUNT = 2,
} wisp_integrator;

// ---- strands: polylines ----

/// Strands, made from a set of polylines. Fill from wisp_default_strands_def(). Copied; need not outlive the call.
typedef struct wisp_strands_def
{
    uint32_t size;           ///< bytes; set by wisp_default_strands_def()
    const wisp_vec3* points; ///< [offsets[strand_count]] m, root first; finite, no coordinate beyond 1e6
    const int32_t*
        offsets;      ///< [strand_count + 1] first vertex of each strand, ascending from 0; a strand may be empty
    int strand_count; ///< >= 0
    int dimension;    ///< 2 (every z must be 0) or 3; default 3
} wisp_strands_def;

WISP_DEFINITION( strands_def );

/// Add strands. Effects make them move, follow others or change their appearance.
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT offsets descend, or a coordinate is not finite (the message names strand and vertex);
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_add_strands( wisp_world* world, const wisp_strands_def* def, wisp_entity* out );

// ---- entities of any kind ----

/// Add an entity that shares topology, masses and gravity of another one and starts at its rest shape, without its effects.
/// @param pose takes the rest shape to where the instance starts; null: it starts there. The rest shape of a surface is that of its
///             fabric. That of strands, whose roots are held in it, goes along, and an instance of the instance starts from it
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT a vertex would be beyond 1e6 m, the rotation is zero or not finite, or strands of dimension 2 would leave
///         their plane; WISP_CONFLICT it is neither a surface nor strands; WISP_STALE_ID; WISP_NO_MEMORY
WISP_API wisp_status wisp_add_instance( wisp_world* world, wisp_entity source, const wisp_transform* pose,
                                        wisp_entity* out );
/// Remove an entity and its components.
WISP_API wisp_status wisp_remove( wisp_world* world, wisp_entity entity );
/// Move an entity at once, as a rigid body: it meets nothing on the way, and no velocity comes of it. For surfaces with their
/// pins, strands with their head, and colliders; strands that are rooted in a surface go along with it, ghosts and curves with
/// what they follow.
/// @param motion takes points from where they are to their new places: rotation about the origin, then translation
/// @param keep_velocity velocities turn with the rotation; false: they become zero. Colliders have none
/// @return WISP_BAD_INPUT a place would be beyond 1e6 m, or the rotation is zero or not finite; WISP_CONFLICT strands that are
///         rooted in a surface, that follow others or that do not move; WISP_STALE_ID. Nothing changes then
WISP_API wisp_status wisp_teleport( wisp_world* world, wisp_entity entity, wisp_transform motion,
                                    bool keep_velocity );
/// Put an entity to a place in the world: its coordinates, given and read, are relative to it from now on and stay as they are. Far
/// from the place that they are relative to, floats have few digits: 2 mm at 20 km. Give an entity that is far away coordinates
/// near 0 and its place here: cloth at a distance then moves bit for bit as near it. Whatever the place, an entity that moves away is
/// simulated relative to where it is. Strands, what follows them and the surface that they are rooted in have one place.
/// @param origin m, finite; default 0
WISP_API wisp_status wisp_set_origin( wisp_world* world, wisp_entity entity, const double origin[3] );
/// Read the place in the world that views and coordinates of an entity are relative to.
/// @param out m
WISP_API wisp_status wisp_read_origin( wisp_world* world, wisp_entity entity, double out[3] );
/// @return false if the entity was removed or never existed
WISP_API bool wisp_is_alive( const wisp_world* world, wisp_entity entity );

/// @return true if the entity has strands; false also if it was removed
WISP_API bool wisp_has_strands( const wisp_world* world, wisp_entity entity );

/// @return true if the entity was halted: its state was not finite or left its bounds, was restored to the last valid
///         one, and passes leave the entity out since then
WISP_API bool wisp_is_halted( const wisp_world* world, wisp_entity entity );
/// Let passes run on a halted entity again.
WISP_API wisp_status wisp_resume( wisp_world* world, wisp_entity entity );

/// Set the substeps of an entity in a step of usual length, so that hair with ten and cloth with one can share a world. They are
/// rounded up to a multiple of those of the world, which has the fewest. Entities with contact all have those of the one with the
/// most; if strands that are rooted in a surface are among them, so has all that moves. No snapshot holds the number.
/// @param substeps 0 .. 1000000; 0 and the default: those of the world
WISP_API wisp_status wisp_set_substeps( wisp_world* world, wisp_entity entity, int substeps );
/// Tell how many substeps an entity makes in a step of usual length. Compiles the plan if needed.
/// @return WISP_STALE_ID, or as wisp_world_explain()
WISP_API wisp_status wisp_read_substeps( wisp_world* world, wisp_entity entity, int* out );

// ---- requests, steps, views ----

/// Request a component of an entity. The passes that compute it exist from the next step on. A step without requests does
/// nothing. Statistics of an effect have a function of their own, wisp_request_<effect>_stats().
WISP_API wisp_status wisp_request( wisp_world* world, wisp_entity entity, wisp_component component );
/// Cancel a request. Passes that no other request requires vanish.
WISP_API wisp_status wisp_cancel_request( wisp_world* world, wisp_entity entity, wisp_component component );

/// Simulate one step. The plan is compiled first if components or requests changed.
///
/// Substeps have a constant length: that of the usual step over `substeps`, whatever one step's length. A step of another length
/// has as many of them as fit. What is left, less than a substep of the world, is simulated with the next step, so the state may
/// lag by it, and a step shorter than it changes nothing. The usual step is the first; or 1/60 s after a load screen, a first step of
/// more than 1/4 s, until a shorter one or a second as long comes. Of the first ten steps, two more of another length change it. If
/// steps change for good (those that agree within a fifth outnumber others by 30, short ones counting less), substeps follow: longer
/// at once, shorter by 0.2 % per step, since a sudden change would set cloth at rest in motion.
/// A step of several usual ones is made as so many, towards the same targets, up to `longest_step`. The time beyond is left out and the
/// step counted (WISP_COUNT_CUT_STEPS); pins and colliders go their whole way in what is left, so teleport what they should not throw.
/// @param dt s, > 0
/// @return WISP_CONFLICT a pass reads a component that nothing writes (the message names both); WISP_NO_MEMORY. A step that fails and is
///         counted (WISP_COUNT_STEPS) has begun: a pass has failed, and the others have run; one that is not has changed nothing
WISP_API wisp_status wisp_world_step( wisp_world* world, float dt );

/// Called before each step of wisp_world_advance(), to move pins, colliders and heads to where they are at its end.
typedef void wisp_before_step_fn( void* user, wisp_world* world );

/// Advance by the time of a frame, in steps of constant length: the recommended way when frames take uneven time. Time that
/// is no whole step is kept for the next call. Afterwards views of WISP_SURFACE_POINTS and WISP_STRAND_POINTS are
/// interpolated between the last two steps, so they are smooth and one step late; other views are of the last step.
/// @param seconds since the last call, >= 0. Beyond eight steps the rest is left out and the call counted
///        (WISP_COUNT_CUT_STEPS), so that a slow host does not fall ever further behind
/// @param dt s, > 0, of a step
/// @param before_step may be null
/// @return that of the step that failed; the steps before it were made, and it and those behind it are due in the next call
WISP_API wisp_status wisp_world_advance( wisp_world* world, float seconds, float dt, wisp_before_step_fn* before_step,
                                         void* user );

/// A column of an entity in the user's order. Valid until the next call that changes the world.
typedef struct wisp_view
{
    const void* data; ///< the first row
    int count;        ///< rows
    size_t stride;    ///< bytes from row to row
} wisp_view;

/// View a component of the last step.
/// @param component point.*, strand.points, surface.points or surface.normals: those are in the user's order
/// @return WISP_CONFLICT the component was not requested, or is not in the user's order
WISP_API wisp_status wisp_world_view( wisp_world* world, wisp_entity entity, wisp_component component,
                                      wisp_view* out );

/// Motion of a surface, or of strands that move, at the end of a step. Sums are in double and in a fixed order.
typedef struct wisp_motion_stats
{
    double mass;                ///< kg, of the vertices that are not pinned
    double centre[3];           ///< m, of that mass
    double momentum[3];         ///< kg m/s
    double angular_momentum[3]; ///< kg m^2/s about the centre
    double kinetic_energy;      ///< J
    double potential_energy;    ///< J, of the gravity that acts on the entity; 0 at the origin
    double volume;              ///< m^3, signed. Of an open mesh: of the cone to the first vertex. Of strands: 0
    double strain_max;          ///< largest |l/l0 - 1| of the edges or segments
    double strain_mean;         ///< mean |l/l0 - 1| of the edges or segments
    double speed_max;           ///< m/s
} wisp_motion_stats;

/// @return WISP_CONFLICT WISP_MOTION_STATS was not requested, or no step was made since
WISP_API wisp_status wisp_read_motion_stats( wisp_world* world, wisp_entity entity, wisp_motion_stats* out );

// ---- what a step cost, and what went wrong ----

/// One pass in the profile. Times are of the last step. A fused pass is timed on samples of its items and scaled to the
/// measured time of its node.
typedef struct wisp_profile_line
{
    const char* pass; ///< "module.verb"
    double seconds;   ///< wall time
    int items;        ///< groups, blocks or entities that it ran over
} wisp_profile_line;

typedef struct wisp_profile
{
    const wisp_profile_line* lines; ///< [count] in plan order; owned by the world, valid until the next step
    int count;
    double seconds; ///< wall time of the whole step
} wisp_profile;

/// The profile of the last step, always recorded.
WISP_API wisp_profile wisp_world_profile( const wisp_world* world );

/// Counts of numerical failures, limits reached and work done since the world was created.
typedef enum wisp_counter
{
    WISP_COUNT_STEPS = 0,         ///< steps
    WISP_COUNT_PLANS = 1,         ///< compilations of the plan
    WISP_COUNT_NEIGHBOURS = 2,    ///< neighbours within the radius at the last search of each entity
    WISP_COUNT_CAPPED = 3,        ///< queries that reached the neighbour limit
    WISP_COUNT_COARSE_GRIDS = 4,  ///< grids with widened cells, because the scene is too sparse for its radius
    WISP_COUNT_SEARCHES = 5,      ///< neighbour searches
    WISP_COUNT_HALTED = 6,        ///< entities restored to their last valid state and halted
    WISP_COUNT_STRAND_RESET = 7,  ///< strands too far from their rest lengths to be solved, reset from the root
    WISP_COUNT_NOT_CONVERGED = 8, ///< linear solves that reached their iteration limit
    WISP_COUNT_INDEFINITE = 9,    ///< linear solves that met negative curvature and stopped
    WISP_COUNT_DEGENERATE_LINK =
        10, ///< links between coincident vertices, which have no direction, at each projection
    WISP_COUNT_STIFFNESS_CLAMPED = 11, ///< substeps whose links were too stiff for single precision and were softened
    WISP_COUNT_FIRST_ORDER = 12, ///< substeps of BDF2 made by implicit Euler instead: of a cloth, of each strand
    WISP_COUNT_GRAVITY_SCALED =
        13,                  ///< strands that feel part of gravity, because substeps are too long to hold their shape
    WISP_COUNT_SAGGING = 14, ///< strands too soft to hold their shape under gravity, which sag
    WISP_COUNT_STRETCHED =
        15, ///< strands of inextensible links that end a step more than 5 % too long, in each step: too few
            ///< sweeps for their masses; and those of exact lengths with a segment that contact has left so
    WISP_COUNT_SPEED_LIMITED =
        16, ///< velocities of vertices above the largest speed, scaled down to it, in each substep
    WISP_COUNT_SPLIT_VERTICES = 17, ///< vertices of surfaces that became two
    WISP_COUNT_CUT_STEPS = 18,      ///< steps, or calls of wisp_world_advance(), too long to be simulated as a whole
    WISP_COUNT_MANY_SOLVES = 19,    ///< substeps of a linear solver that took more than three solves
    WISP_COUNTER_COUNT = 20,
} wisp_counter;

WISP_API uint64_t wisp_world_counter( const wisp_world* world, wisp_counter counter );
/// @return a static string such as "halted entities"
WISP_API const char* wisp_counter_name( wisp_counter counter );

/// @return bytes that the world holds now: columns, topology and buffers
WISP_API size_t wisp_world_memory( const wisp_world* world );

/// What a part of a world's memory is.
typedef enum wisp_memory_kind
{
    WISP_MEMORY_ENGINE = 0, ///< the world itself, entities, topology of strands, plan, scratch of the workers
    WISP_MEMORY_MODULE =
        1, ///< state of a module and what that keeps: lists of contacts, colliders, followers, plates
    WISP_MEMORY_COMPONENT = 2, ///< columns of a component
    WISP_MEMORY_OUTSIDE =
        3, ///< not in wisp_world_memory(): fabrics, which have allocators of their own, and trees of Embree
} wisp_memory_kind;

typedef struct wisp_memory_part
{
    const char* name; ///< static, or of a component or module: "particle.position", "contact", "scratch"
    wisp_memory_kind kind;
    size_t bytes;    ///< in use: of components the rows of entities that have it, of modules what they keep for those
    size_t capacity; ///< allocated. Over all parts but WISP_MEMORY_OUTSIDE the sum is wisp_world_memory()
} wisp_memory_part;

/// Tell where the memory of a world goes. Parts without bytes are left out.
/// @param out [capacity] receives the parts, in the order of their kinds; may be null with capacity 0
/// @return the number of parts, which may exceed `capacity`
WISP_API int wisp_world_memory_parts( const wisp_world* world, wisp_memory_part* out, int capacity );
/// @return the number of workers
WISP_API int wisp_world_workers( const wisp_world* world );
/// @return the instruction set in use: "baseline", "avx2" or "avx512"
WISP_API const char* wisp_world_isa( const wisp_world* world );

/// Print the plan: every pass with its reason, every absent one with the component that is missing. Compiles the plan if
/// needed. wisp_world_explain() in explain.h returns the same, and more, as data.
/// @param write receives one line at a time, without a newline
WISP_API wisp_status wisp_world_plan( wisp_world* world, void ( *write )( void* user, const char* line ),
                                      void* user );
/// @return the number of passes of the plan; -1 if it cannot be compiled
WISP_API int wisp_world_plan_passes( wisp_world* world );

// ---- hashes and snapshots ----

/// @return a 64-bit hash of the whole state. Compiling the plan, in a step or a snapshot, adds the columns that passes write
WISP_API uint64_t wisp_world_hash( const wisp_world* world );
/// Hash one column of an entity in the user's order.
WISP_API wisp_status wisp_world_hash_column( wisp_world* world, wisp_entity entity, wisp_component component,
                                             uint64_t* out );

/// @return bytes that wisp_world_snapshot() writes now; 0 if the plan cannot be compiled, which it is first
WISP_API size_t wisp_world_snapshot_size( wisp_world* world );
/// Write all columns of all entities, except those that have no meaning between steps.
/// @param size of `out`
/// @return WISP_BAD_INPUT `out` has fewer bytes than wisp_world_snapshot_size(), and stays as it is
WISP_API wisp_status wisp_world_snapshot( wisp_world* world, void* out, size_t size );
/// Restore the columns. The world must hold the same entities with the same components and shapes.
/// @return WISP_BAD_INPUT the bytes are not a snapshot of this world, or an index in them is out of range; nothing changes then
WISP_API wisp_status wisp_world_restore( wisp_world* world, const void* bytes, size_t size );

// ---- components ----

/// Find a component by its name, such as "point.strain": those of every world, and those that a module of the world declares.
/// @return 0 if there is none, with a message
WISP_API wisp_component wisp_world_find_component( wisp_world* world, const char* name );
/// @return the name of a component, "unknown" if there is none. Owned by the world
WISP_API const char* wisp_world_component_name( const wisp_world* world, wisp_component component );

/// Components that exist in every world. Hosts request those with a comment; the others belong to modules and are described
/// in module/components.h, whose order this is.
enum
{
    WISP_STRAND_REST = 1,
    WISP_STRAND_POSITION = 2,
    WISP_STRAND_STIFFNESS = 3,
    WISP_STRAND_VELOCITY = 4,
    WISP_STRAND_PREVIOUS = 5,
    WISP_STRAND_INVERSE_MASS = 6,
    WISP_STRAND_LENGTH = 7,
    WISP_STRAND_ROOT = 8,
    WISP_STRAND_POSED = 9,   ///< rest shape after motion, before effects on the appearance
    WISP_STRAND_POINTS = 10, ///< wisp_vec3, m: vertices of strands in the user's order
    WISP_POINT_WIDTH = 11,   ///< float, m: diameter of a strand at a vertex
    WISP_POINT_COLOUR = 12,  ///< wisp_vec3: linear red, green, blue in [0, 1]
    WISP_PARTICLE_POSITION = 13,
    WISP_PARTICLE_VELOCITY = 14,
    WISP_PARTICLE_PREVIOUS = 15,
    WISP_PARTICLE_TARGET = 16,
    WISP_LINK_OWN = 17,
    WISP_PARTICLE_MASS = 18,
    WISP_PARTICLE_GRAVITY = 19,
    WISP_PARTICLE_DAMPING = 20,
    WISP_PARTICLE_EXTERNAL_SOLVER = 21,
    WISP_PARTICLE_CONTACTS = 22,
    WISP_PARTICLE_HALF_SPACES = 23,
    WISP_LINK_STIFFNESS = 24,
    WISP_LINK_COMPLIANCE = 25,
    WISP_LINK_LAMBDA = 26,
    WISP_LINK_LIMIT = 27,
    WISP_LINK_FOLDS = 28,
    WISP_HINGE_REST = 29,
    WISP_HINGE_COTANGENT = 30,
    WISP_HINGE_STIFFNESS = 31,
    WISP_HINGE_FOLDS = 32,
    WISP_SURFACE_TETHERS = 33,
    WISP_SURFACE_LEVELS = 34,
    WISP_LEVEL_MASS = 35,
    WISP_LEVEL_COMPLIANCE = 36,
    WISP_LEVEL_MOTION = 37,
    WISP_SURFACE_POINTS = 38,  ///< wisp_vec3, m: vertices of a mesh in the user's order
    WISP_SURFACE_NORMALS = 39, ///< wisp_vec3: unit normals in the user's order, 0 where they cancel
    WISP_POINT_STRAIN = 40,    ///< float: largest |l/l0 - 1| of the edges or segments at a vertex
    WISP_POINT_SPEED = 41,     ///< float, m/s
    WISP_MOTION_STATS = 42,    ///< read with wisp_read_motion_stats()
    WISP_PARTICLE_FRAME = 43,
    WISP_PARTICLE_UNCARRIED = 44,
    WISP_PARTICLE_MAX_SPEED = 45,
    WISP_MAP_AREA_DENSITY = 46, ///< maps are set with wisp_set_map(), see maps.h
    WISP_MAP_STRETCH_COMPLIANCE = 47,
    WISP_MAP_STRETCH_STIFFNESS = 48,
    WISP_MAP_BEND_COMPLIANCE = 49,
    WISP_MAP_BEND_STIFFNESS = 50,
    WISP_MAP_BEND_RIGIDITY = 51,
    WISP_MAP_DAMPING = 52,
    WISP_MAP_INTERNAL_DAMPING = 53,
    WISP_MAP_DRAG = 54,
    WISP_MAP_LIFT = 55,
    WISP_LINK_CONSTANT = 56,
    WISP_HINGE_CONSTANT = 57,
    WISP_LEVEL_CONSTANT = 58,
    WISP_MAP_COLLISION_THICKNESS = 59,
    WISP_MAP_COLLISION_FRICTION = 60,
    WISP_MAP_CONTACT_THICKNESS = 61,
    WISP_MAP_CONTACT_FRICTION = 62,
    WISP_PARTICLE_CONTACT_IMPULSES = 63,
    WISP_SURFACE_ELASTIC = 64,
    WISP_SURFACE_VIRIAL = 65,
    WISP_STRAND_REACH = 66,
    WISP_SHARED_COMPONENT_COUNT = 67,
};

WISP_END_C
