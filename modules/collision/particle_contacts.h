// Contacts of particles, and blocks of particles that are culled together.
#pragma once

#include "collision_maps.h"

enum
{
    COLLISION_BLOCK = WISP_PARTICLE_BLOCK,
    COLLISION_GROUP = 8,                                  // slots that are gathered together
    COLLISION_PADDED = COLLISION_BLOCK + COLLISION_GROUP, // arrays that kernels compress into
};

_Static_assert( COLLISION_BLOCK == COLLISION_GROUP * WISP_BATCH_GROUPS, "a bit for each group of a block" );

/// A half space that a particle must stay in for a substep, and the accumulated corrections. A row of the kernel
/// half_space.
typedef struct collision_contact
{
    float point[3];                 // m, on the body, at the end of the substep
    float normal[3];                // unit, away from the body
    float motion[3];                // m, displacement of the body's surface in the substep
    float gap;                      // m, to keep along the normal
    float normal_correction;        // m, accumulated, >= 0: the normal impulse
    float tangential_correction[3]; // m, accumulated: the friction impulse
    float static_friction, kinetic_friction;
} collision_contact;

/// A block of particles as arrays of coordinates, for kernels that cull. Particle i is lane i % 8 of group i / 8.
typedef struct collision_block
{
    int begin, end;                     // slots
    int count;                          // of particles in groups; 0 if none moves
    int32_t slot[WISP_BATCH_GROUPS];    // the first of each group
    uint8_t moving[WISP_BATCH_GROUPS];  // a bit for each particle that moves and is finite
    uint8_t pinned[WISP_BATCH_GROUPS];  // a bit for each that is finite and does not move
    float now[3][COLLISION_BLOCK];      // m, in the world
    float old[3][COLLISION_BLOCK];      // m, in the world, at the start of the substep
    wisp_vec3 lower, upper;             // m, of all paths, before a body moved anything
    float clear[COLLISION_BLOCK];       // m, within this distance there is no body without a contact
    float free_radius[COLLISION_BLOCK]; // m, within which no body finds the particle in this step
    bool is_last;                       // no other body follows, so nobody reads new positions
    int met;                            // bodies that have given contacts
    float thickness[COLLISION_BLOCK][WISP_COLLISION_CONTACTS]; // m, of each contact
    float was[2][COLLISION_BLOCK][4];                          // positions and previous ones before a body moved them
    // seen from one body, in its frame
    int candidate_count;
    int32_t candidates[COLLISION_PADDED];                     // in the block: those that may be within reach
    float from[3][COLLISION_PADDED], to[3][COLLISION_PADDED]; // of each candidate
    float path[COLLISION_PADDED], reach[COLLISION_PADDED];    // m, of each candidate
} collision_block;

/// Columns of the participant whose contacts are found.
typedef struct collision_find_args
{
    const wisp_kernels* kernels;
    float *position, *previous; // [slot][4]
    int32_t* count;             // [slot] contacts found
    float* found;               // [slot][4] m, where they were found; the distance that is clear. Where a group is
                                // settled, minus the free radius
    collision_contact ( *contact )[WISP_COLLISION_CONTACTS];
    int32_t ( *tracked )[COLLISION_TRACKS]; // [slot] closest triangles; null if no body is tracked
    float ( *free )[COLLISION_TRACKS];      // [slot] m, at least the distance of `origin` from the body
    wisp_vec3 ( *origin )[COLLISION_TRACKS];
    int substeps_left; // of the step, behind this one
    bool is_first;     // substep of the step: nothing is tracked yet
    float recovery;    // m, in this substep
    // for reactions and restitution, else null
    const collision_state* state;
    int32_t ( *contact_body )[WISP_COLLISION_CONTACTS];
    collision_impulse* sums; // [body] of the block
    float ( *bounce )[WISP_COLLISION_CONTACTS];
    const float* velocity; // [slot][4] m/s, with the gravity of the substep
    wisp_vec3 gravity;     // m/s^2
    float dt;              // s
    collision_maps maps;
    bool can_squeeze;  // there are several bodies
    uint32_t left_out; // bits of groups of a block that are not searched
    bool has_settled;  // groups of an earlier substep of this step may be settled
    bool settles;      // groups may be settled until the next substep
} collision_find_args;

/// Return the slot of a particle of the block.
static inline int collision_slot( const collision_block* block, int i )
{
    return block->slot[i / COLLISION_GROUP] + i % COLLISION_GROUP;
}

/// Return the normal velocity with which a particle leaves if the body pushes it, m/s; -infinity if it does not bounce.
float collision_bounce( const collision_find_args* args, const collision_view* view, const collision_contact* c,
                        int slot );

// ---- contact generation: one block of particles against its bodies, in the order of the bodies ----

/// Add the contacts of a block with one body.
void collision_meet( const collision_find_args* args, const collision_view* view, collision_block* block );

/// Return the columns of the participant of a span, in its substep.
collision_find_args collision_find_args_of( wisp_frame* frame, const wisp_span* span, const collision_state* state );

/// Find the contacts of a block.
void collision_find_block( wisp_frame* frame, const wisp_span* span, const collision_find_args* args, int begin,
                           int end );

/// Find and project the contacts of some groups of a block, as bits, that keeps none.
void collision_find_and_project( wisp_frame* frame, const wisp_span* span, const collision_state* state, int begin,
                                 int end, uint32_t groups );

/// Load the contacts of particles that two bodies squeeze: see squeeze.c.
void collision_squeeze( const collision_find_args* args, const collision_block* block );

/// Do two contacts squeeze something of a thickness of `both` by a depth, m? @param oppose minus the product of their normals
bool collision_is_squeezed( float oppose, float depth, float both );

/// Return the correction with which two contacts begin the substep that squeeze something of a thickness of `both` by a depth, m.
float collision_squeeze_load( float dt, float oppose, float depth, float both );

/// Find two contacts of a particle that oppose each other and press. @return whether there are some
bool collision_find_loaded( const collision_contact* contacts, int count, int* first, int* second );

/// Take from loads what a body with a mass gives way to them within the substep.
void collision_unload( wisp_frame* frame, const collision_state* state, wisp_entity participant, int32_t body );

// ---- culling: which particles of a block may be within reach of a body ----

/// Gather the particles that may touch a body in this substep. Their contacts are cleared.
void collision_begin_block( const collision_find_args* args, int begin, int end, collision_block* block );

/// Compute the paths relative to a body, and list the particles that may be within reach. All others are surely
/// beyond it.
void collision_cull_block( const collision_find_args* args, const collision_view* view, collision_block* block );

/// Note that a body is at this distance from the box of the block, in m, which is beyond its reach.
void collision_skip_block( const collision_view* view, float apart, collision_block* block );

/// Store the distances that are clear, and which groups are settled.
void collision_end_block( const collision_find_args* args, const collision_block* block );
