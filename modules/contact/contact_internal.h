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
    CONTACT_BATCH = 128,  // pairs whose distances are asked at once
    CONTACT_BLOCK = 64,   // rows of a block: it is projected by one worker, from its first to its last
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
    float gap;   // m, to be kept: never more than the pair has at rest
    float due;   // m, of what its sides went astray: until then it is farther apart than its gap
    float drift; // m a substep, that it may come nearer by what its points were at when it was found
} contact_candidate;

/// Pairs of one kind, in the order of their sides where a search of all found them.
typedef struct contact_list
{
    contact_candidate* items;
    int32_t* near;       // those that may meet in this substep; each batch of items has its own in front of its place
    int32_t* near_count; // [batch]
    int count, most;
    bool are_edges;
} contact_list;

/// So many points has a pair at most: two boundary particles, each between three.
#define CONTACT_MOST_POINTS 6

/// A pair in a substep: the plane between it where it was safe, and what keeping it apart has cost. The distance along the
/// normal is linear in the points; the first `split` of them are one side.
typedef struct contact_row
{
    int32_t a, b; // the pieces
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

/// Fixed blocks of rows: those of points and triangles, then those of edges. No block has both.
typedef struct contact_blocks
{
    int count;
    int32_t* begin;                      // [count + 1] rows
    int32_t* colour_of;                  // [count]
    int32_t* order;                      // [count] blocks by colour
    int32_t colour[CONTACT_COLOURS + 1]; // first of a colour in `order`
} contact_blocks;

/// The lists of pairs: what a search of all finds, and what is found behind it for points that went astray.
typedef enum contact_kind
{
    CONTACT_LATE_POINTS,
    CONTACT_POINTS,
    CONTACT_LATE_EDGES,
    CONTACT_EDGES_LIST,
    CONTACT_KIND_COUNT,
} contact_kind;

/// Arrays of the soup.
typedef enum contact_place
{
    CONTACT_NOW,
    CONTACT_SAFE,
    CONTACT_REST,
    CONTACT_DRIFT,
    CONTACT_REACH,
    CONTACT_SPENT,
    CONTACT_ASTRAY,
    CONTACT_AHEAD,
    CONTACT_LATE,
    CONTACT_GONE,
    CONTACT_POINT_WAY,
    CONTACT_EDGE_WAY,
    CONTACT_TRIANGLE_WAY,
    CONTACT_EDGE_REACH,
    CONTACT_TRIANGLE_REACH,
    CONTACT_EDGE_DRIFT,
    CONTACT_TRIANGLE_DRIFT,
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
    CONTACT_RENEWED,
    CONTACT_ITEMS, // of each kind
    CONTACT_NEAR = CONTACT_ITEMS + CONTACT_KIND_COUNT,
    CONTACT_NEAR_COUNT = CONTACT_NEAR + CONTACT_KIND_COUNT,
    CONTACT_MET = CONTACT_NEAR_COUNT + CONTACT_KIND_COUNT,
    CONTACT_LATE_ROWS,
    CONTACT_EDGE_LATE,
    CONTACT_TRIANGLE_LATE,
    CONTACT_ROWS,
    CONTACT_BLOCK_BEGIN,
    CONTACT_BLOCK_COLOUR,
    CONTACT_BLOCK_ORDER,
    CONTACT_SAMPLE_PARENTS,
    CONTACT_SAMPLE_WEIGHTS,
    CONTACT_PLACE_COUNT,
} contact_place;

/// Pieces whose points went astray since all pairs were looked for, with the boxes that they got then.
typedef struct contact_renewed
{
    int32_t* items;
    wisp_box* boxes;
    int count, most;
} contact_renewed;

/// Warm memory: a function of the columns, rebuilt when they were changed from outside. Which pairs are listed depends on its
/// past; which of them become rows does not.
typedef struct contact_soup
{
    int point_count, edge_count, triangle_count;
    float* now;            // [point][4] m, inverse mass: where the substep has them
    float* safe;           // [point][4] m: where nothing crossed, at the end of the substep before
    float* rest;           // [point][4] rest shape of the guest; the fourth is the guest
    float* shift;          // [point][4] m, that recovery moves in this substep: it gives no velocity
    float* share;          // [point] of the way from safe to now that may be gone
    float* ahead;          // [point][4] m: where it goes in this substep, give or take the fourth
    uint8_t* is_late;      // [point] it went elsewhere, which rows do not know yet
    int32_t* edges;        // [edge][2]
    int32_t* triangles;    // [triangle][3]
    uint8_t* is_tangled;   // [point]
    uint64_t* colours;     // [point] of blocks that have it
    float common[3];       // m, that all points together went; 0 where some cannot be cut
    float least_thickness; // m, of the guests

    // What a search takes for granted: each point goes on as it did, give or take its reach.
    float* drift;                       // [point][4] m a substep, less what all have in common
    float* reach;                       // [point] m
    float* spent;                       // [point] m, how far it went astray since
    float* astray;                      // [point] m, how far it may go astray in this substep
    float* gone;                        // [point] m, how far it did
    float *edge_reach, *triangle_reach; // m, of the points the largest
    float *edge_drift,
        *triangle_drift; // [piece][4] m a substep: of the middle, and how much a point's differs from it
    float travelled[3];  // m, that all points together went since
    int drifted;         // substeps since, as long as points are taken to drift
    float *point_way, *edge_way, *triangle_way; // m, how far astray each may be; of particles in place of edges
    uint8_t *edge_late, *triangle_late;         // [piece] one of its points is
    wisp_box *point_boxes, *edge_boxes, *triangle_boxes;
    wisp_box_pairs point_pairs, edge_pairs; // of points with triangles, or of particles; of edges
    wisp_box_pairs triangle_pairs;          // of triangles with points
    bool has_point_grid;
    contact_renewed renewed[3]; // points, edges, triangles
    int searches, renewals;     // in this step

    // Boundary particles, where they are what is kept apart: vertices, then points on edges and in triangles at rest.
    int sample_count;
    int32_t ( *sample_parents )[3]; // [sample] points
    float ( *sample_weights )[3];   // [sample]
    wisp_samples sampler;

    contact_list lists[CONTACT_KIND_COUNT];
    bool is_listed; // what may meet is in the lists
    bool is_short;  // there were more pairs than lists may have: points may go no farther than lists reach
    contact_row *rows, *late_rows; // the late ones are guarded, and not projected
    int split;                     // rows of points and triangles, which come first
    int row_count, late_row_count;
    contact_blocks blocks;
    wisp_crossings crossings;
    int32_t ( *faces )[2]; // [edge] its triangles, -1: none
    bool has_faces;        // they are looked for when something is crossed
    bool is_anew;          // safe places were taken anew: what was searched is worth nothing
    wisp_buffer buffers[CONTACT_PLACE_COUNT];
} contact_soup;

typedef struct contact_state
{
    wisp_component settings;      // contact_settings, of a guest
    wisp_component particle_safe; // quads of particles
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
/// Points back into the columns; what is safe with the last iteration.
void contact_scatter( const contact_work* work, bool is_end );
/// What is kept of a guest from substep to substep, into its columns.
void contact_keep_guest( const contact_work* work, const contact_guest* guest );

// contact_ways.c
/// How a substep's ways stand to what is known of them.
typedef enum contact_reached
{
    CONTACT_WITHIN,    ///< no point goes farther than it was expected to
    CONTACT_ELSEWHERE, ///< one does: rows are missing
    CONTACT_BEYOND,    ///< one goes farther astray than its reach: pairs are missing, and perhaps rows
} contact_reached;

/// How far each point may go from where it is safe, by where it is predicted. What all points have in common goes to the
/// soup, unless something is fixed.
contact_reached contact_expect_ways( const contact_work* work );
/// How far each point went.
contact_reached contact_measure_ways( const contact_work* work );
/// Take it that a point goes on as in this substep, and count anew how far it goes astray.
void contact_set_course( const contact_work* work, int point );
/// The same for all points.
void contact_set_courses( const contact_work* work );
/// Count the substep's ways.
void contact_spend_ways( const contact_work* work );
/// For so many substeps it is taken that points go on as they did.
int contact_drift_substeps( const contact_work* work );

// contact_search.c
/// Look for all pairs.
wisp_status contact_search( const contact_work* work, wisp_error* error );
/// The box that a piece stays in as long as its points keep to their courses, in a frame that goes where all go.
wisp_box contact_box_around( const contact_work* work, const int32_t* points, int count, float reach );
/// What its points say of a piece: drift [4] and reach.
void contact_take_course( const contact_soup* s, const int32_t* points, int count, float drift[4], float* reach );
/// Of a list of triangles, points or edges, those that may meet a point, a triangle or an edge. @return how many
int contact_keep_triangles( const contact_work* work, int point, int32_t* items, int count );
int contact_keep_points( const contact_work* work, int triangle, int32_t* items, int count );
int contact_keep_edges( const contact_work* work, int edge, int32_t* items, int count );
/// What two points, or pieces of them, keep: m, 0 if their guests, or their guest and itself, do not keep apart.
float contact_gap_of( const contact_work* work, int a, int b );
/// Do two guests, or a guest and itself, keep apart?
bool contact_may_meet( const contact_guest* a, const contact_guest* b );

// contact_renew.c
/// Look for the pairs of those points alone that go farther astray than their reach.
/// @param done false: there are too many, and all pairs are to be looked for
wisp_status contact_renew( const contact_work* work, bool* done, wisp_error* error );

// contact_near.c
/// Pairs of pieces whose distances are asked: all of points and triangles, or all of edges.
typedef struct contact_pieces
{
    _Alignas( 64 ) int32_t point4[CONTACT_BATCH / WISP_SLICE][4][WISP_SLICE];
    _Alignas( 64 ) float distance[CONTACT_BATCH / WISP_SLICE][WISP_SLICE];
    bool are_edges;
} contact_pieces;

/// Put a pair to its place, below CONTACT_BATCH.
void contact_put_pieces( contact_pieces* pieces, int at, const int32_t points[4] );
/// @param quads [point][4] where they are measured
/// @param weight, normal [group] as wisp_closest_job has them, or both null @return [count] m, the same bits either way
const float* contact_measure_pieces( const contact_work* work, const float* quads, contact_pieces* pieces, int count,
                                     float ( *weight )[4][WISP_SLICE], float ( *normal )[3][WISP_SLICE] );
const float* contact_measure_distances( const contact_work* work, const float* quads, contact_pieces* pieces,
                                        int count );

// contact_candidates.c
/// Room for so many pairs in a list. @return false without memory
bool contact_reserve_list( const contact_work* work, contact_kind kind, size_t count );
/// Put a search's pairs behind those of a list, which has room.
/// @param askers [pairs->asker_count] what the askers are, null: what they are called
/// @param turned the askers are the second side
void contact_fill_list( const contact_work* work, contact_kind kind, const wisp_box_pairs* pairs,
                        const int32_t* askers, bool turned );

// contact_samples.c
/// Sample all guests at rest, if particles are what is kept apart.
wisp_status contact_sample_guests( const contact_work* work );
/// Boxes around particles where they are safe: as askers and as what is asked.
wisp_status contact_find_sample_pairs( const contact_work* work, wisp_error* error );
/// What a pair of particles is to keep, m; 0 if it is none.
float contact_sample_gap_of( const contact_work* work, int a, int b );
/// The plane between two particles.
void contact_measure_samples( const contact_soup* s, const float* quads, const contact_candidate* c,
                              contact_row* row );

// contact_due.c
/// Look which pairs of the lists may become rows: into `near` of the lists. @param late_only those alone that have a point
/// that is late @return how many, as often as they are listed
int contact_search_lists( const contact_work* work, bool late_only );

// contact_rows.c
/// The points of a candidate.
void contact_set_points( const contact_work* work, const contact_candidate* c, bool is_edge, contact_row* row );
/// Rows of all pairs that may meet in this substep, in the order of points and edges, whatever found them.
wisp_status contact_find_rows( const contact_work* work, wisp_error* error );
/// Rows of the pairs that are missing because points are late, behind the others.
wisp_status contact_find_late_rows( const contact_work* work, wisp_error* error );

// contact_blocks.c
/// Cut the rows into blocks and colour them. @return false without memory
bool contact_make_blocks( const contact_work* work );

// contact_project.c
void contact_project_rows( const contact_work* work );
void contact_recover( const contact_work* work );

// contact_guard.c
/// Cut ways until no separating plane is passed. @return points that were cut
int contact_guard( const contact_work* work );
/// Cut all ways that can be to what all have in common.
void contact_hold( const contact_work* work );

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

/// How much nearer the pieces of two drifts may come in a substep, at most, m. A float is rounded: a little more than that.
static inline float contact_drift_between( const float a[4], const float b[4] )
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return 1.0001f * ( sqrtf( x * x + y * y + z * z ) + a[3] + b[3] );
}

/// May a point go farther astray than its reach?
static inline bool contact_is_beyond( const contact_soup* s, int point )
{
    return s->spent[point] + s->astray[point] > s->reach[point];
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
