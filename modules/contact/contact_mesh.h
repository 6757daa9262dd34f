// The contact mesh: points, edges and triangles of all participants in one numbering, and what the stages of contact
// share.
//
// Each stage keeps its data in a struct of its own, which is defined in the header of the stage. A file includes the
// headers of the stages that it uses. Includes go one way, in the order in which a substep runs.
#pragma once

#include "contact.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/sleep.h"

#include <math.h>

// Least distance of spheres over the longest edge around a vertex. The middle of an equilateral triangle is 0.58 edges from its corners.
static const float CONTACT_COVER = 0.72f;

enum
{
    CONTACT_BATCH = 128,        // pairs whose distances are measured together
    CONTACT_POINT_GRAIN = 1024, // points of a task
    CONTACT_MAX_POINTS = 4,     // of a pair
    CONTACT_KEPT = 4,           // impulses that a point keeps for the next substep
};

/// The definition of a participant with the defaults filled in.
typedef struct contact_settings
{
    float thickness, friction, max_push_out_speed;
    uint32_t layers, mask;
    int32_t self;   // 1: it meets itself; 2: it is made of strands, and meets those of others that have this
    int32_t is_new; // its column of intersection-free positions has no values yet
    int32_t is_far; // nothing that it may meet is within reach, so the contact mesh leaves it out
} contact_settings;

/// State of contact from step to step, in a column, so that a snapshot has it.
typedef struct contact_memory
{
    int32_t tangled; // edges may pass through triangles: pairs there are not constrained but drawn apart
    int32_t unused;  // rows of columns have no padding inside
    wisp_contact_stats stats;
} contact_memory;

/// Impulses of pairs of a point in the substep before, those without any last. In a column, so that a snapshot has them.
typedef struct contact_load
{
    uint32_t key[CONTACT_KEPT];     // of the pair; 0: none
    float impulse[CONTACT_KEPT][4]; // kg m, times the substep: along the normal, and the tangential one
} contact_load;

/// Where the points of a participant are in a substep.
typedef struct contact_reach_box
{
    wisp_sleep_bounds bounds; // m, of the positions before and now
    float displacement2;      // m^2, square of the largest
} contact_reach_box;

/// A participant's part of the contact mesh.
typedef struct contact_participant
{
    wisp_entity entity;
    bool is_strands, halted;
    bool is_corrected; // another module solves for it
    bool is_left_out;  // of the contact mesh: its counts are 0
    bool joins;        // it was apart until this substep
    bool is_pushed;    // rows have points of it
    bool may_part;     // strands, far, whose reach is known
    float spacing;     // m, most that its vertices have to keep as spheres
    float cover;       // m, the same while spheres stand for it, else 0
    float layer_parts; // into which its layer divides an edge
    int first_point, point_count, first_edge, edge_count, first_triangle, triangle_count;
    int held_count; // points in `held`
    contact_settings settings;
    contact_reach_box box;
    double impulse[3];                 // N s, of this step
    wisp_vec3 place;                   // m, from its rows to those of the first participant
    float *position, *previous;        // [point][4] columns of a surface
    const float *thickness, *friction; // [point] factors of those of the settings; null: 1
    const int32_t* half_spaces;        // [point] number of half spaces that it is held in; null: none
    float* half_space_row;             // [point][WISP_MAX_HALF_SPACES][16] those, as rows of the kernel half_space
    contact_load* loads;               // [point] its column; null: of strands
} contact_participant;

/// The contact mesh. It is a function of the columns of the participants, built again after those changed from
/// outside. Which pairs are in the lists of the stages depends on the past; which pairs become constraints does not.
typedef struct contact_contact_mesh
{
    int point_count, edge_count, triangle_count;
    float* now;               // [point][4] m, inverse mass: position in this substep
    float* intersection_free; // [point][4] m: position at the end of the substep before, where nothing intersected
    float* rest;              // [point][4] m: rest position; the fourth is the index of the participant
    float* shift;             // [point][4] m: displacement of this substep that gives no velocity
    const int32_t* edges;     // [edge][2]
    const int32_t* triangles; // [triangle][3]
    uint8_t* is_pushed;       // [point] rows or spheres may push it in this substep
    int32_t* held;            // of each participant, from its first point on: its free points in half spaces
    float min_thickness;      // m, of the participants
    bool may_join;            // who is left out may come within reach in this step
    bool is_listed;           // the pair lists of the broad phase hold for these positions
    bool is_parting;          // pairs at no distance are found too
    bool is_reset;            // intersection-free positions were replaced: intersections and pairs are unknown
    wisp_buffer buffers[8];

    struct contact_clusters* clusters;           // clusters.h
    struct contact_motion* motion;               // predicted_motion.h
    struct contact_cached_bounds* bounds;        // broad_phase.h
    struct contact_broad_phase* broad_phase;     // broad_phase.h
    struct contact_intersections* intersections; // untangling.h
    struct contact_primitive_pairs* primitives;  // narrow_phase.h
    struct contact_constraints* constraints;     // constraints.h
    struct contact_spheres* spheres;             // spheres.h
    struct contact_colouring* colouring;         // solve.h
    struct contact_limit* limit;                 // displacement_limit.h
    struct contact_untangling* untangling;       // untangling.h
} contact_contact_mesh;

/// Components that participants have.
typedef struct contact_components
{
    wisp_component corrected;     // mark of surfaces that take part
    wisp_component samples_read;  // of surfaces whose layers spheres are made of
    wisp_component settings;      // contact_settings
    wisp_component particle_free; // intersection-free positions of particles, [4]
    wisp_component strand_free;   // the same of strands
} contact_components;

/// What the loops of a substep share.
typedef struct contact_work
{
    contact_contact_mesh* contact_mesh;
    contact_memory* memory;
    contact_participant* participants;
    int participant_count;
    const wisp_contact_settings* settings; // of the world
    const contact_components* components;
    const wisp_parallel* parallel;
    wisp_frame* frame;
    float seconds; // s, of the substep
    int worker;
    int substeps_left; // of the step, with this one
    bool counts_intersections, counts_impulses;
} contact_work;

/// Decide which participants have something within reach, by their boxes in this substep.
/// @param is_start of a step: later in it, participants only join
/// @return whether the contact mesh has others than these
bool contact_mark_far( const contact_work* work, bool is_start );

/// Number the points, edges and triangles of all participants within reach and copy their rest shapes.
/// @return false without memory
bool contact_build_contact_mesh( const contact_work* work );

/// Make room for an array, and a little more: kernels read and write whole groups of eight.
/// @return false without memory
bool contact_reserve( const contact_work* work, wisp_buffer* buffer, size_t bytes, void** out );

/// Find the edge between two points of a participant, a < b.
int contact_find_edge( const contact_contact_mesh* s, const contact_participant* participant, int a, int b );

/// Return whether two participants, or a participant and itself, are kept apart.
bool contact_may_meet( const contact_participant* a, const contact_participant* b );

/// Return whether two participants with these settings are kept apart from each other.
static inline bool contact_suit( const contact_participant* a, const contact_settings* of_a,
                                 const contact_participant* b, const contact_settings* of_b )
{
    return ( of_a->layers & of_b->mask ) != 0 && ( of_b->layers & of_a->mask ) != 0 &&
           ( a->is_strands == false || b->is_strands == false || ( of_a->self & of_b->self & 2 ) != 0 );
}

/// Return the participant that a point belongs to.
static inline contact_participant* contact_participant_of( const contact_work* work, int point )
{
    return work->participants + (int)work->contact_mesh->rest[(size_t)point * 4 + 3];
}

/// Return the distance that two participants keep, m.
static inline float contact_gap_between( const contact_participant* a, const contact_participant* b )
{
    const float thickness = 0.5f * ( a->settings.thickness + b->settings.thickness );
    const float cover = a->cover > b->cover ? a->cover : b->cover;
    return cover > thickness ? cover : thickness;
}

static inline float contact_distance( const float a[3], const float b[3] )
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrtf( x * x + y * y + z * z );
}

static inline float contact_dot( const float a[3], const float b[3] )
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline float contact_larger( float a, float b )
{
    return a > b ? a : b;
}

static inline float contact_smaller( float a, float b )
{
    return a < b ? a : b;
}
