// One substep of a surface. What it starts with is prepared in implicit_setup.c, in this order.
#pragma once

#include "implicit_internal.h"

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
    implicit_tally* tallies; // [block]
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

/// Choose BDF2 or Euler by how stiff the links are for the length of the substep, and whether its energy is guarded.
void implicit_choose_integrator( wisp_frame* frame, const wisp_span* span, implicit_substep* s );
/// Set the weights of the substep before. @param w h / h_before; 0: Euler
void implicit_set_weights( implicit_substep* s, float h, float w );
void implicit_find_columns( wisp_frame* frame, const wisp_span* span, const implicit_state* state,
                            implicit_substep* s );
/// Take scratch memory for rows and blocks. @return false without memory
bool implicit_find_room( implicit_substep* s, int worker );
/// Set what the surface's damping leaves of a velocity.
void implicit_set_kept( wisp_frame* frame, const wisp_span* span, implicit_substep* s );
/// Bring the rows of bending up to date, if the material has them.
void implicit_set_plate( wisp_frame* frame, const wisp_span* span, implicit_substep* s );

/// Run over the slices of the surface, in its blocks.
static inline void implicit_for_slices( implicit_substep* s, wisp_range_fn* run )
{
    wisp_parallel_for( s->system.parallel, s->system.links->slice_count, s->system.grain, run, s );
}

// implicit_newton.c
/// Assemble forces and their derivatives where the solves have come to. @return links without direction
int implicit_assemble( implicit_substep* s, bool repeat );
/// Solve and move, until the substep is done.
void implicit_iterate( wisp_frame* frame, implicit_substep* s, implicit_tally* total );
