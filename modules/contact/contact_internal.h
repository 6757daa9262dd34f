// What the files of this folder share.
//
// All guests together are a soup: points, edges and triangles with one numbering. Passes gather the points from the columns
// of their entities, work on the soup, and scatter what moved.
#pragma once

#include "contact.h"

#include "wisp/module/components.h"
#include "wisp/module/crossings.h"
#include "wisp/module/module.h"
#include "wisp/module/sampling.h"

#include <math.h>

enum
{
    CONTACT_BATCH = 128,          // pairs whose distances are asked at once
    CONTACT_PAIRS_MOST = 24 * 24, // of pieces of one kind in two patches, or of the points of either with triangles
    CONTACT_ROOM = 6144,          // pairs that are looked at together
    CONTACT_PAIRS_PART = 1024,    // pairs of patches whose slack is counted together
    CONTACT_BLOCK = 64,           // rows of a block: it is projected by one worker, from its first to its last
    CONTACT_COLOURS = 64,         // of blocks; blocks of one colour share no point
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

/// Some pieces that lie together, which are looked at together: each piece of the soup is in one patch.
typedef struct contact_patch
{
    int32_t guest;
    int32_t first_point, point_count; // in patch_points: all points of its pieces; to eights the last repeats
    int32_t kind_row[3], rows[3];     // first row, and how many, of points, edges and triangles
} contact_patch;

/// Where the points of a patch go: the middle of their ways, and how far from it any of them is at most.
typedef struct contact_way
{
    float middle[3], spread; // m a substep
} contact_way;

/// What a search takes for granted: a patch goes on as it did, give or take its reach.
typedef struct contact_course
{
    float drift[3]; // m a substep, less what all points have in common
    float reach;    // m, how far it may go astray
    float spent;    // m, how far it went since
} contact_course;

/// A pair that is nearer than it might come to its gap: a point and a triangle, two edges, or two boundary particles.
typedef struct contact_pair
{
    int32_t a, b;
    float gap; // m, to be kept: never more than the pair has at rest
} contact_pair;

/// Pairs of one kind that may meet in this substep, in any order.
typedef struct contact_near
{
    contact_pair* items;
    int count, most;
} contact_near;

/// Pairs of patches that may come near each other. Those of a patch begin with itself, then others rise.
typedef struct contact_patch_pairs
{
    int32_t* begin; // [patch + 1]
    int32_t* patch; // [pair], to eights there are more
    int32_t* other; // [pair]
    float* slack;   // [pair] m: no two of their pieces are nearer to their gap
    int count;
} contact_patch_pairs;

/// Two boundary particles within reach.
typedef struct contact_candidate
{
    contact_pair pair;
    float due; // m, of what its sides went astray: until then it is farther apart than its gap
} contact_candidate;

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

/// What is found of pairs: points and triangles, or particles; edges.
typedef enum contact_kind
{
    CONTACT_POINTS,
    CONTACT_EDGES,
    CONTACT_KIND_COUNT,
} contact_kind;

/// Arrays of the soup.
typedef enum contact_place
{
    CONTACT_NOW,
    CONTACT_SAFE,
    CONTACT_REST,
    CONTACT_AHEAD,
    CONTACT_LATE,
    CONTACT_SHIFT,
    CONTACT_SHARE,
    CONTACT_EDGE_POINTS,
    CONTACT_TRIANGLE_POINTS,
    CONTACT_TANGLED,
    CONTACT_FACES,
    CONTACT_COLOUR_MASKS,
    CONTACT_PATCHES,
    CONTACT_PATCH_POINTS,
    CONTACT_PATCH_OF,
    CONTACT_PATCHES_BEGIN,
    CONTACT_PATCHES_OF,
    CONTACT_PIECE_ROWS,
    CONTACT_WAYS,
    CONTACT_WAYS_GONE,
    CONTACT_COURSES,
    CONTACT_PATCH_LATE,
    CONTACT_PATCH_PLACED,
    CONTACT_PATCH_ASKED,
    CONTACT_PATCH_BOXES,
    CONTACT_PATCH_NORMALS,
    CONTACT_REACHED_BOXES,
    CONTACT_PAIRS_BEGIN, // of two lists, which take turns
    CONTACT_PAIRS_PATCH = CONTACT_PAIRS_BEGIN + 2,
    CONTACT_PAIRS_OTHER = CONTACT_PAIRS_PATCH + 2,
    CONTACT_PAIRS_SLACK = CONTACT_PAIRS_OTHER + 2,
    CONTACT_DUE = CONTACT_PAIRS_SLACK + 2,
    CONTACT_DUE_COUNT,
    CONTACT_NEAR, // of each kind
    CONTACT_NEAR_SPARE = CONTACT_NEAR + CONTACT_KIND_COUNT,
    CONTACT_ROWS,
    CONTACT_LATE_ROWS,
    CONTACT_BLOCK_BEGIN,
    CONTACT_BLOCK_COLOUR,
    CONTACT_BLOCK_ORDER,
    CONTACT_SAMPLE_PARENTS,
    CONTACT_SAMPLE_WEIGHTS,
    CONTACT_SAMPLE_RESTS,
    CONTACT_SAMPLE_PLACES,
    CONTACT_SAMPLE_WAYS,
    CONTACT_SAMPLE_BOXES,
    CONTACT_CANDIDATES,
    CONTACT_PLACE_COUNT,
} contact_place;

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

    int patch_count;
    contact_patch* patches;
    int32_t* patch_points;    // points times 4
    int32_t* patch_of;        // [point] one that it is a point of
    int32_t* patches_begin;   // [point + 1]
    int32_t* patches_of;      // of each point, all that have it
    wisp_piece_row* pieces;   // [row]
    contact_way *ways, *gone; // [patch] in this substep, in the one before
    contact_course* courses;  // [patch]
    uint8_t* patch_late;      // [patch] one of its points is
    uint8_t* is_placed;       // [patch] its pieces are where its points are safe
    int32_t* asked;           // [patch + 1] those that are to be placed
    wisp_box* patch_boxes;    // [patch] where it is safe, if it is placed
    float* patch_normals;     // [patch][3] of any length, if it is placed
    wisp_box* reached_boxes;  // [patch] where it may be while it keeps to its course
    wisp_box_pairs overlaps;  // of patches, or of particles
    int listed_for;           // substeps since all pairs were looked for
    int searches;             // in this step

    contact_patch_pairs pairs[2]; // the second was in use before
    int pairs_turn;               // whose arrays the first has
    int32_t* due;                 // [pair] those that are looked at in this substep
    int32_t* due_count;           // [part of the pairs]
    contact_near near[CONTACT_KIND_COUNT];

    // Boundary particles, where they are what is kept apart: vertices, then points on edges and in triangles at rest.
    int sample_count;
    int32_t ( *sample_parents )[3]; // [sample] points
    float ( *sample_weights )[3];   // [sample]
    float ( *sample_rests )[4];     // [sample] m, where it is at rest; the fourth is the guest
    float ( *sample_places )[3];    // [sample] m, where it was safe when pairs were looked for
    wisp_samples sampler;
    float* sample_ways; // [sample] m, how far astray each may be
    wisp_box* sample_boxes;
    contact_candidate* candidates;
    int candidate_count;

    bool is_listed; // what may meet is in the lists
    bool is_short;  // there were more pairs than lists may have: patches may go no farther than lists reach
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

// contact_gather.c
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
/// Take it that all patches go on as in this substep, and count anew how far they go astray.
void contact_set_courses( const contact_work* work );
/// How far a way leads, beside what all points have in common, m.
float contact_length_of_way( const contact_soup* s, const contact_way* way );
/// Count the substep's ways.
void contact_spend_ways( const contact_work* work );
/// Were boundary particles listed while they went so much farther than now that it pays to list them anew?
bool contact_lists_too_many( const contact_work* work );
/// For so many substeps it is taken that patches go on as they did.
int contact_drift_substeps( const contact_work* work );

// contact_search.c
/// Look for all pairs.
wisp_status contact_search( const contact_work* work, wisp_error* error );
/// The box around a patch where it is safe.
wisp_box contact_box_around( const contact_work* work, const contact_patch* patch );
/// What two points, or pieces of them, keep: m, 0 if their guests, or their guest and itself, do not keep apart.
float contact_gap_of( const contact_work* work, int a, int b );
/// Do two guests, or a guest and itself, keep apart?
bool contact_may_meet( const contact_guest* a, const contact_guest* b );

// contact_patches.c
/// Cut the soup into patches. @return false without memory
bool contact_make_patches( const contact_work* work );

// contact_closest.c
/// Pairs of pieces whose distances are asked: all of points and triangles, or all of edges.
typedef struct contact_pieces
{
    int32_t point4[4][CONTACT_BATCH];
    float distance[CONTACT_BATCH];
    bool are_edges;
} contact_pieces;

/// Put a pair to its place, below CONTACT_BATCH.
static inline void contact_put_pieces( contact_pieces* pieces, int at, const int32_t points[4] )
{
    for ( int k = 0; k < 4; ++k )
    {
        pieces->point4[k][at] = points[k] * 4;
    }
}
/// @param quads [point][4] where they are measured
/// @param weight, normal [group] as wisp_closest_job has them, or both null @return [count] m, the same bits either way
const float* contact_measure_pieces( const contact_work* work, const float* quads, contact_pieces* pieces, int count,
                                     float ( *weight )[4][WISP_SLICE], float ( *normal )[3][WISP_SLICE] );
const float* contact_measure_distances( const contact_work* work, const float* quads, contact_pieces* pieces,
                                        int count );

// contact_near.c
/// Which pairs of pieces may become rows: into `near`, in any order. @param late_only of patches alone that have a point that is
/// late
wisp_status contact_find_near( const contact_work* work, bool late_only, wisp_error* error );

// contact_meet.c
/// Pairs of one kind of pieces that are looked at together.
typedef struct contact_batch
{
    int count;
    int32_t first[CONTACT_ROOM], second[CONTACT_ROOM], point4[4][CONTACT_ROOM];
    int32_t of[CONTACT_ROOM];                                               // which pair of patches they are of
    int32_t met[CONTACT_ROOM];                                              // those that go on
    float gap[CONTACT_ROOM], distance[CONTACT_ROOM], closing[CONTACT_ROOM]; // m
    contact_pair found[CONTACT_ROOM];
} contact_batch;

/// Room behind those that are there.
static inline void contact_take_room( contact_batch* batch, wisp_piece_pairs* out )
{
    out->of = batch->of + batch->count;
    out->first = batch->first + batch->count;
    out->second = batch->second + batch->count;
    for ( int k = 0; k < 4; ++k )
    {
        out->point4[k] = batch->point4[k] + batch->count;
    }
}

/// Is there room for all pairs of as many patches as are asked at once?
static inline bool contact_has_room( const contact_batch* batch )
{
    return batch->count + WISP_PIECE_JOBS * CONTACT_PAIRS_MOST + WISP_SLICE <= CONTACT_ROOM;
}

/// How far apart all pairs are where they are safe.
void contact_measure_batch( const contact_work* work, contact_kind kind, contact_batch* batch );
/// Of those that are met, with their gaps: which become rows. They go to `near`, as far as it has room.
/// @param total how many go there
void contact_meet( const contact_work* work, contact_kind kind, contact_batch* batch, int met, _Atomic int* total );
/// Room for so many. @return false without memory
bool contact_reserve_near( const contact_work* work, contact_kind kind, int count );

// contact_samples.c
/// Sample all guests at rest, if particles are what is kept apart.
wisp_status contact_sample_guests( const contact_work* work );
/// Where a particle is.
void contact_place_sample( const contact_soup* s, const float* quads, int sample, float out[3] );
/// How far two particles are apart, m.
float contact_sample_distance( const contact_soup* s, const float* quads, int a, int b );
/// What a pair of particles is to keep, m; 0 if it is none.
float contact_sample_gap_of( const contact_work* work, int a, int b );
/// The plane between two particles.
void contact_measure_samples( const contact_soup* s, const float* quads, const contact_pair* pair, contact_row* row );

// contact_sample_pairs.c
/// Look for all pairs of particles.
wisp_status contact_find_sample_pairs( const contact_work* work, wisp_error* error );
/// Which of them may become rows, as contact_find_near().
wisp_status contact_find_near_samples( const contact_work* work, bool late_only, wisp_error* error );

// contact_rows.c
/// The points of a pair.
void contact_set_points( const contact_work* work, const contact_pair* pair, bool is_edge, contact_row* row );
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
/// The edge between two points of a guest, the first of which is less.
int contact_find_edge( const contact_soup* s, const contact_guest* guest, int a, int b );
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

static inline float contact_distance( const float a[3], const float b[3] )
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrtf( x * x + y * y + z * z );
}

/// How much nearer two patches may come in a substep, at most, m. A float is rounded: a little more than that.
static inline float contact_closing_of( const contact_way* a, const contact_way* b )
{
    const float x = a->middle[0] - b->middle[0], y = a->middle[1] - b->middle[1], z = a->middle[2] - b->middle[2];
    return 1.0001f * ( sqrtf( x * x + y * y + z * z ) + ( a->spread + b->spread ) );
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
