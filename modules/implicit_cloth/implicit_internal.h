/// Components, links and the system of a substep.
#pragma once

#include "implicit_cloth.h"

#include "wisp/module/components.h"
#include "wisp/module/corrected.h"
#include "wisp/module/module.h"
#include "wisp/module/plate.h"
#include <math.h>

/// Material of a surface, without its links. A row of the entity.
typedef struct implicit_material
{
    int32_t bdf2, newton_iterations, max_newton_iterations, max_iterations, requests_stats;
    float tolerance;
    float before; ///< s, length of the last substep; 0: none
    float gained; ///< J, energy above the least of the last thousand substeps
} implicit_material;

/// Counters of the last substep. A row of the entity.
typedef struct implicit_counts
{
    int32_t iterations, repeats;
    float residual, newton_residual;
    int32_t sticking, sliding, landing, released;
    float stiffest; ///< N/m, limit that links were lowered to; 0: none
} implicit_counts;

/// Links of a surface in rows of their own, and the way between rows and the fabric's slots. One block of memory.
typedef struct implicit_links
{
    int row_count; ///< vertices, padded to a multiple of 8
    int slice_count;
    int stretch_count, bend_count, max_neighbours;
    int32_t* row_slot; ///< [row_count] slot of the fabric, -1 pads
    float* fraction;   ///< [row_count] what part of a vertex's mass its row has: 1 over the weight of its forces
    float stiffest;    ///< N/m, k or c of the stiffest link
    wisp_spring_links springs;
    wisp_plate* plate; ///< bending of a material; null: none
    float rigidity;    ///< N m, of the plate
    size_t bytes;
} implicit_links;

/// The components, a row each: X( member, "name", table, columns ).
#define IMPLICIT_COMPONENTS( X )                                                                                     \
    X( material, "implicit_cloth.material", ENTITY, WISP_COLUMN( implicit_material, material, 1 ) )                  \
    X( counts, "implicit_cloth.tally", ENTITY, WISP_COLUMN( implicit_counts, counts, 1 ) )                           \
    X( contact, "implicit_cloth.contact", PARTICLE, WISP_COLUMN( implicit_contact, contact, 1 ) )                    \
    X( change, "implicit_cloth.change", PARTICLE,                                                                    \
       WISP_COLUMN( float, change, 3 ) ) /* m/s, by the last solve, to start from */                                 \
    X( history, "implicit_cloth.history", PARTICLE,                                                                  \
       /* of the substep before, for BDF2 */ WISP_COLUMN( float, position, 4 ),                                      \
       /* m, when the substep before began; inverse mass */ WISP_COLUMN( float, velocity, 4 ) /* m/s */ )            \
    X( corrected, WISP_PARTICLE_CORRECTED, ENTITY, WISP_NO_COLUMNS ) /* contact corrects positions after a solve */  \
    X( solved, "implicit_cloth.solved", PARTICLE, WISP_COLUMN( float, way, 3 ) ) /* m, displacement by the solve */  \
    X( stats, "implicit_cloth.stats", ENTITY, WISP_COLUMN( wisp_implicit_cloth_stats, stats, 1 ) )

typedef struct implicit_state
{
    IMPLICIT_COMPONENTS( WISP_COMPONENT_MEMBER )
    wisp_objects* links; ///< implicit_links
} implicit_state;

/// Contacts of a particle from substep to substep.
typedef struct implicit_contact
{
    int32_t body[WISP_MAX_PARTICLE_CONTACTS]; ///< that holds it or that it landed on; 0: none
    float
        pressed[WISP_MAX_PARTICLE_CONTACTS]; ///< kg m/s, impulse along the normal of the last solve, below 0: a pull
    float rubbed;                            ///< kg m/s, impulse across
    int32_t slides, landed;
} implicit_contact;

/// One substep of a surface: its state in rows, and the linear system, all in scratch memory.
typedef struct implicit_system
{
    const implicit_links* links;
    const implicit_material* material;
    const wisp_kernels* kernels;
    const wisp_parallel* parallel;
    wisp_spring_args spring;
    wisp_conjugate_args conjugate;
    int grain, block_count;              ///< blocks of slices, the same for any number of workers
    double* sums;                        ///< [block_count]
    float ( *requested )[3][WISP_SLICE]; ///< [slice] kg m/s, the right side that the last solve began with
    int limit;                           ///< iterations of a solve
    bool guessed;                        ///< conjugate.direction is not zero
    double looseness;                    ///< 0 .. 1, of repeated solves: 0 where links are very stiff
    double first;                        ///< square of the residual at which the first solve of a substep ended
    double floor;                        ///< kg m^2/s^2, residual that is rounding
    float *place, *start;                ///< [row][4] m, x^; m/s, v^: where the substep's velocities act on and begin
    float* goal;                         ///< [row][4] m/s, prescribed velocity of a held row; fourth number 1: held
    float* rubbing;                      ///< [row][4] kg m/s, impulse of sliding friction
    float* filter_floats;                ///< the filter of conjugate, to be written
    uint8_t* filtered;                   ///< [slice], as that of conjugate, to be written
} implicit_system;

/// Input of contact, by slot.
typedef struct implicit_contact_input
{
    const int32_t* body; ///< [slot][WISP_MAX_PARTICLE_CONTACTS], these four as in particle.contacts
    const float *plane, *motion, *friction; ///< [slot][WISP_MAX_PARTICLE_CONTACTS][4], [4], [3]
    implicit_contact* contact;              ///< [slot]
    const float *position, *velocity;       ///< [slot][4] when the substep begins
    const float* target;                    ///< [slot][4] of pins; null: they stay
    float seconds;                          ///< h, of the substep
    float hysteresis;                       ///< m/s: pull per mass that does not release
    float target_fraction;                  ///< of the way to a target, in this substep
} implicit_contact_input;

/// Squared sine of the angle between two normals of a row below which they count as one.
#define IMPLICIT_SAME_NORMALS 1e-6f

/// What contact gives to bodies in a substep: the columns of particle.contact_impulses. Null: nobody asks.
typedef struct implicit_given
{
    int32_t* body;
    float *impulse, *point;
    float per_solve; ///< h over the time of the equations: impulses of a solve are of the latter
} implicit_given;

/// Outcome of a solve.
typedef struct implicit_outcome
{
    int iterations;
    float residual; ///< relative to that of zero change
    bool unsolved, indefinite;
} implicit_outcome;

/// Motion of a substep, of which gain is asked.
typedef struct implicit_motion
{
    const implicit_system* system;
    const float *from, *point; ///< [row][4] m, where it began and ends
    const float* velocity;     ///< [row][4] m/s, at its end
    const float* before;       ///< [slot][4] m/s, at its beginning
    const float* weight;       ///< [slot][4] 1/kg, the fourth number; 0: pinned
    wisp_vec3 gravity;
    float seconds; ///< h, of the substep
} implicit_motion;

/// What a motion adds to the energy.
typedef struct implicit_gain
{
    double gain;     ///< J, without the work of gravity and contact
    double energy;   ///< J, kinetic and of links, at the end
    double rounding; ///< J, energy that positions do not resolve
} implicit_gain;

// ---- implicit_cloth_module.c ----

// ---- implicit_links.c ----

/// Cook the links of a surface. @param out receives them, null on failure
wisp_status implicit_links_create( wisp_world* world, wisp_entity surface, const wisp_implicit_cloth_def* def,
                                   implicit_links** out );
/// Null is allowed.
void implicit_links_release( void* links, const wisp_allocator* allocator );

// ---- implicit_contact.c ----

/// Set filter, goal and friction of a row for this substep. Needs its place and start.
void implicit_touch_row( const implicit_system* system, const implicit_contact_input* contact_input, int row,
                         implicit_counts* counts );
/// Store the contact impulse of a row, which the last solve left.
void implicit_press_row( const implicit_system* system, const implicit_contact_input* contact_input, int row );
/// BDF2: set the history of a slot in contact. All are [3] and may change; x and v are new.
void implicit_apply_contact_correction( const implicit_contact_input* contact_input, int slot, float* x, float* v,
                                        float* x_before, float* v_before );

/// Impulse of contact on a row, kg m/s: J = -(1 - S) r of the last solve.
wisp_vec3 implicit_impulse( const implicit_system* system, int row );

// ---- implicit_newton.c ----

/// @param sums [block], receives the parts
implicit_gain implicit_find_gain( const implicit_motion* motion, implicit_gain* sums );
/// Energy above the least of recent substeps, after another. @param gained before it
double implicit_add_gain( double gained, const implicit_gain* gain );
/// Whether that is too much. @param gained with this substep
bool implicit_gains( double gained, const implicit_gain* gain );

// ---- implicit_cloth_module.c ----

/// Length, over that at rest, at which the ramp of eq. 12 meets the arc; 0: nowhere.
double implicit_ramp_end( double load, double ramp, double rest );

// ---- passes ----

void implicit_step( wisp_frame* frame, const wisp_span* span, void* user );
void implicit_take_correction( wisp_frame* frame, const wisp_span* span, void* user );

// ---- implicit pairs ----

/// From a mesh to linked pairs: intermediate data of cooking.

/// Two linked slots, a < b.
typedef struct implicit_pair
{
    int32_t a, b;
    float area;                          ///< m^2, of the triangles at the edge, or at the diagonal
    float rest;                          ///< m
    float load, ramp, ramp_end, damping; ///< as in wisp_spring_links
} implicit_pair;

typedef struct implicit_cook
{
    wisp_world* world;
    const wisp_allocator* allocator;
    const wisp_fabric* fabric;
    implicit_pair *stretch, *bend; ///< sorted
    int stretch_count, bend_count;
    int32_t* neighbours; ///< [vertex_count] |N| by slot
    int max_neighbours;
    void* blocks[16];
    size_t bytes[16];
    int block_count;
} implicit_cook;

void implicit_cook_release( implicit_cook* cook );

// ---- implicit substep ----

// One substep of a surface. What it starts with is prepared in implicit_step.c, in this order.

// The surface's columns, all by slot.
typedef struct implicit_columns
{
    float *position, *velocity;
    float* change;                            // [slot][3] m/s, of the substep before: solves start from it
    float *before_position, *before_velocity; // [slot][4]; null: Euler
    int32_t* body;                            // of particle.contacts
    float* previous;                          // [slot][4] m; null: no contact of surfaces, nor what follows
    float* solved;                            // [slot][3] m, way of the substep
    int32_t* half_space_count;                // [slot]
    float ( *half_space_rows )[16];           // [slot][WISP_MAX_HALF_SPACES]
    implicit_given given;                     // to bodies
} implicit_columns;

typedef struct implicit_substep
{
    implicit_system system;
    implicit_contact_input contact_input;
    implicit_columns columns;
    wisp_vec3 gravity;
    float kept;              // of a velocity, by the surface's damping
    float moved;             // share of a solve's answer that is gone
    float recent, older;     // weights of the substep before in x^ and v^: ( recent a - older b )
    float *point, *velocity; // [row][4] where forces are evaluated, and the corresponding velocity
    implicit_counts* counts; // [block]
    int* undirected;         // [block]
    double* motion;          // [block] kg m^2/s^2, sum of m v^2
    bool* guesses;           // [block] a guess is not 0
    float* worst;            // [block] m/s, of the nonlinear step
    float* from;             // [row][4] m, where a guarded substep began
    implicit_contact* held;  // [row] of the substep before; null: not guarded
    implicit_gain* gains;    // [block]
    double gained;           // J, of the material
    bool stiff;              // one linear solve may gain energy
    bool guarded;            // it may not, and is made again as a stiff one if it does
    bool extrapolates;       // BDF2
    bool is_second;          // the substep is made again, by Euler
} implicit_substep;

/// Run over the slices of the surface, in its blocks.
static inline void implicit_for_slices( implicit_substep* s, wisp_range_fn* run )
{
    wisp_parallel_for( s->system.parallel, s->system.links->slice_count, s->system.grain, run, s );
}

// implicit_newton.c
/// Assemble forces and their derivatives where the solves have come to. @return links without direction
int implicit_assemble( implicit_substep* s, bool repeat );
/// Solve and move, until the substep is done.
void implicit_iterate( wisp_frame* frame, implicit_substep* s, implicit_counts* total );
