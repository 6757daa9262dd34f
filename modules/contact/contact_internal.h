// What the files of this folder share.
//
// All guests together are a soup: points, edges and triangles with one numbering. Passes gather the points from the columns
// of their entities, work on the soup, and scatter what moved.
#pragma once

#include "contact.h"

#include "wisp/components.h"
#include "wisp/crossings.h"
#include "wisp/module.h"
#include "wisp/samples.h"

#include <math.h>

enum
{
    CONTACT_BLOCK = 128,  // candidates of a block: it is projected by one worker, from its first to its last
    CONTACT_COLOURS = 64, // of blocks; blocks of one colour share no point
};

/// The definition of a guest with the defaults filled in.
typedef struct contact_settings
{
    float thickness, friction, recovery_speed;
    uint32_t layers, mask;
    int32_t self;
    int32_t is_new; // what is kept from substep to substep is not known yet
} contact_settings;

/// What all guests share, from step to step.
typedef struct contact_memory
{
    int32_t tangled; // something may cross something: pairs there are let go, and drawn apart
    int32_t unused;  // rows of columns have no padding inside
    wisp_contact_figures figures;
} contact_memory;

/// A guest's part of the soup.
typedef struct contact_guest
{
    wisp_entity entity;
    bool is_strands, halted;
    int first_point, point_count, first_edge, edge_count, first_triangle, triangle_count;
    contact_settings settings;
    double impulse[3]; // N s, of this step
} contact_guest;

/// A pair within reach: a point and a triangle, two edges, or two boundary particles.
typedef struct contact_candidate
{
    int32_t a, b;
    float gap; // m, to be kept: never more than the pair has at rest
    float due; // m, of what is spent: until then it is farther apart than its gap
} contact_candidate;

/// So many points has a pair at most: two boundary particles, each between three.
#define CONTACT_MOST_POINTS 6

/// A pair in a substep: the plane between it where it was safe, and what keeping it apart has cost. The distance along the
/// normal is linear in the points; the first `split` of them are one side.
typedef struct contact_row
{
    int32_t count, split;
    int32_t point[CONTACT_MOST_POINTS];
    float weight[CONTACT_MOST_POINTS]; // barycentric, of the second side negative
    float normal[3];                   // unit, from the second side to the first
    float gap;      // m, to be kept in this substep: what it should be, or what it is if that is less
    float distance; // m, where it was safe
    float wanted;   // m, what the gap should be
    float friction;
    float pushed;    // m, along the normal, >= 0: stands for the normal impulse
    float rubbed[3]; // m, across it: stands for friction's
    float cut;       // of the ways of its points that may be gone, in a round of the guard
} contact_row;

/// Fixed blocks of candidates: points and triangles, then edges. No block has both.
typedef struct contact_blocks
{
    int count;
    int32_t* begin;  // [count + 1] candidates
    int32_t* rows;   // [count] rows that are alive in this substep, in front of the block's place
    int32_t* order;  // [count] blocks by colour
    int32_t* colour; // [CONTACT_COLOURS + 1] first of a colour in `order`
    int first_edge_block;
} contact_blocks;

/// Arrays of the soup.
typedef enum contact_place
{
    CONTACT_NOW,
    CONTACT_SAFE,
    CONTACT_REST,
    CONTACT_SEARCHED,
    CONTACT_CLOSING,
    CONTACT_POINT_WAY,
    CONTACT_EDGE_WAY,
    CONTACT_TRIANGLE_WAY,
    CONTACT_SHIFT,
    CONTACT_SHARE,
    CONTACT_EDGES,
    CONTACT_TRIANGLES,
    CONTACT_TANGLED,
    CONTACT_FACES,
    CONTACT_COLOUR_MASKS,
    CONTACT_POINT_BOXES,
    CONTACT_EDGE_BOXES,
    CONTACT_TRIANGLE_BOXES,
    CONTACT_PAIR_GAP,
    CONTACT_CANDIDATES,
    CONTACT_ROWS,
    CONTACT_BLOCK_BEGIN,
    CONTACT_BLOCK_ROWS,
    CONTACT_BLOCK_ORDER,
    CONTACT_BLOCK_COLOUR,
    CONTACT_SAMPLE_PARENTS,
    CONTACT_SAMPLE_WEIGHTS,
    CONTACT_PLACE_COUNT,
} contact_place;

/// Warm memory: a function of the columns, rebuilt when they were changed from outside.
typedef struct contact_soup
{
    int point_count, edge_count, triangle_count;
    float* now; // [point][4] m, inverse mass: where the substep has them
    float*
        safe; // [point][4] where nothing crossed, at the end of the substep before; the fourth is the point's reach, m:
              // what was farther apart than its gap and both reaches is no candidate
    float* rest;     // [point][4] rest shape of the guest; the fourth is the guest
    float* searched; // [point][4] where pairs were looked for; the fourth is what the point has gone since, m
    float* closing;  // [point] m, how far it may go in this substep; behind it, how far it went
    float *point_way, *edge_way, *triangle_way; // m, that each went and may go; of particles in place of edges
    float* shift;        // [point][4] m, that recovery moves in this substep: it gives no velocity
    float* share;        // [point] of the way from safe to now that may be gone
    int32_t* edges;      // [edge][2]
    int32_t* triangles;  // [triangle][3]
    uint8_t* is_tangled; // [point]
    uint64_t* colours;   // [point] of blocks that have it
    wisp_box *point_boxes, *edge_boxes, *triangle_boxes;
    // Boundary particles, where they are what is kept apart: vertices, then points on edges and in triangles at rest.
    int sample_count;
    int32_t ( *sample_parents )[3]; // [sample] points
    float ( *sample_weights )[3];   // [sample]
    wisp_samples sampler;
    wisp_box_pairs point_pairs, edge_pairs; // of particles the first
    float* pair_gap;                        // [pair] m, 0: none
    contact_candidate* candidates;
    int candidate_count;
    contact_row* rows; // [candidate]
    contact_blocks blocks;
    wisp_crossings crossings;
    int32_t ( *faces )[2]; // [edge] its triangles, -1: none
    bool has_faces;        // they are looked for when something is crossed
    bool is_anew;          // safe places were taken anew: what was searched is worth nothing
    float least_thickness; // m, of the guests
    float common[3];       // m, that all points together went; 0 where some cannot be cut
    wisp_buffer buffers[CONTACT_PLACE_COUNT];
} contact_soup;

typedef struct contact_state
{
    wisp_component settings;      // contact_settings, of a guest
    wisp_component particle_safe; // quads of particles, safe and searched
    wisp_component strand_safe;   // the same of strands
    wisp_component active;        // contact_memory, of the entity at which guests meet, while there are guests
    wisp_component touches;       // there: strands take part
    wisp_component pairs;         // written by finding, read by pushing
    wisp_component result;        // what is wanted of it
    wisp_component figures;       // wisp_contact_figures, on request
    wisp_entity meeting;
    contact_guest* guests;
    int guest_count, guest_capacity;
    wisp_contact_settings world;
    bool changed; // guests or settings: the soup is to be built anew
    bool wants_figures, counts_crossings;
    contact_soup soup;
} contact_state;

/// What the loops of a substep share.
typedef struct contact_work
{
    contact_state* state;
    contact_soup* soup;
    contact_memory* memory;
    const wisp_parallel* parallel;
    wisp_frame* frame;
    float seconds; // s, of the substep
    int worker;
} contact_work;

// contact_soup.c
/// Make room for an array. @return false without memory
bool contact_reserve( const contact_work* work, contact_place place, size_t bytes, void** out );
wisp_status contact_build_soup( const contact_work* work );
void contact_release_soup( contact_soup* soup, const wisp_allocator* allocator );
/// Points from the columns: where they are, and where they were safe.
void contact_gather( const contact_work* work, bool is_start );
/// Points back into the columns; what is safe and searched with the last iteration.
void contact_scatter( const contact_work* work, bool is_end );
/// What is kept of a guest from substep to substep, into its columns.
void contact_keep_guest( const contact_work* work, const contact_guest* guest );

// contact_ways.c
/// How a substep's ways stand to what is known of them.
typedef enum contact_reached
{
    CONTACT_WITHIN, ///< no point goes farther than it was expected to
    CONTACT_LATE,   ///< one does
    CONTACT_BEYOND, ///< one goes farther than its reach: a pair that is no candidate may come to its gap
} contact_reached;

/// How far each point may go from where it is safe, by where it is predicted. What all points have in common goes to the
/// soup, unless something is fixed.
contact_reached contact_expect_ways( const contact_work* work );
/// How far each point went.
contact_reached contact_measure_ways( const contact_work* work );
/// Give each point a reach for some substeps like this one, and begin to count its ways anew.
void contact_set_reach( const contact_work* work );
/// Count the substep's ways.
void contact_spend_ways( const contact_work* work );

// contact_search.c
wisp_status contact_search( const contact_work* work, wisp_error* error );
/// The largest reach of some points, m.
float contact_reach_of( const contact_soup* s, const int32_t* points, int count );
/// Do two guests, or a guest and itself, keep apart?
bool contact_may_meet( const contact_guest* a, const contact_guest* b );

// contact_candidates.c
/// Candidates of the pairs that were found, in blocks. @return false without memory
bool contact_make_candidates( const contact_work* work );

// contact_samples.c
/// Sample all guests at rest, if particles are what is kept apart.
wisp_status contact_sample_guests( const contact_work* work );
/// Boxes around particles where they were searched: as askers and as what is asked.
wisp_status contact_find_sample_pairs( const contact_work* work, wisp_error* error );
/// What each pair of particles is to keep; 0 if it is no candidate.
void contact_check_samples( const contact_work* work, float* gaps );
/// The plane between two particles.
void contact_measure_samples( const contact_soup* s, const float* quads, const contact_candidate* c,
                              contact_row* row );

// contact_rows.c
/// The points of a candidate.
void contact_set_points( const contact_work* work, int candidate, bool is_edge, contact_row* row );
/// Points, weights, normals and distances of up to CONTACT_BLOCK candidates, all of one kind.
/// @param quads [point][4] where they are measured @param rows [count] the rest of them is left as it is
void contact_measure_pairs( const contact_work* work, const float* quads, const int32_t* candidates, int count,
                            bool are_edges, contact_row* rows );
/// Rows of the candidates that may meet in this substep.
void contact_find_rows( const contact_work* work );

// contact_project.c
void contact_project_rows( const contact_work* work );
void contact_recover( const contact_work* work );

// contact_guard.c
/// Cut ways until no separating plane is passed. @return points that were cut
int contact_guard( const contact_work* work );

// contact_untangle.c
wisp_status contact_mark_tangles( const contact_work* work, wisp_error* error );
void contact_untangle( const contact_work* work );

// contact_figures.c
/// Add what the rows of the substep did.
void contact_sum_impulses( const contact_work* work );

/// Whose a point is.
static inline contact_guest* contact_guest_of( const contact_work* work, int point )
{
    return work->state->guests + (int)work->soup->rest[(size_t)point * 4 + 3];
}

static inline float contact_larger( float a, float b )
{
    return a > b ? a : b;
}

static inline float contact_smaller( float a, float b )
{
    return a < b ? a : b;
}

// passes
/// The loops' surroundings in a pass of the entity at which guests meet.
contact_work contact_begin_work( wisp_frame* frame, const wisp_span* span, contact_state* state );
int contact_find_guest( const contact_state* state, wisp_entity entity );
void contact_find( wisp_frame* frame, const wisp_span* span, void* user );
void contact_project( wisp_frame* frame, const wisp_span* span, void* user );
void contact_keep( wisp_frame* frame, const wisp_span* span, void* user );
void contact_measure( wisp_frame* frame, const wisp_span* span, void* user );
