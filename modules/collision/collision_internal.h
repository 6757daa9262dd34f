/// What the files of this folder share.
#pragma once

#include "collision.h"

#include "wisp/mesh_tree.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>

/// What never changes about a body.
typedef struct collision_body
{
    wisp_entity entity;
    wisp_shape shape;     // unless there is a tree
    wisp_mesh_tree* tree; // null for a closed form
    bool sheet;
    wisp_vec3 centre;  // m, of a box and a ball around the body, in its frame
    wisp_vec3 half;    // m, of the box; infinite for a plane
    float ball_radius; // m
    float inner;       // m, of a closed form: the smallest of its half sizes; infinite for a plane, 0 for a mesh
} collision_body;

/// Bodies and who collides with them in the order they came: passes walk it, so it must not depend on anything else.
typedef struct collision_state
{
    wisp_component settings;       // collision_settings: the surface, or the strands, collide
    wisp_component contact;        // rows of particles; only while there is a body to touch
    wisp_component active;         // a mark on surfaces, likewise: also on those that need no contacts of ours
    wisp_component strand_contact; // rows of strands, likewise
    wisp_component carried;        // rows of strands that others carry, likewise
    wisp_component figures;        // wisp_collision_figures
    wisp_component collider;       // collision_collider
    wisp_component motion;         // a pose: the body is moved
    collision_body* bodies;
    int body_count, body_capacity;
    wisp_entity* guests; // surfaces and strands
    int guest_count, guest_capacity;
} collision_state;

/// The definition of a surface or of strands with the defaults filled in.
typedef struct collision_settings
{
    float thickness, friction, recovery_speed;
    uint32_t mask;
    int32_t enabled, figures;
} collision_settings;

/// A body where it is, and how it feels.
typedef struct collision_collider
{
    wisp_rigid from, to; // at the start and at the end of the step
    float static_friction, kinetic_friction;
    float thickness;
    uint32_t layers;
} collision_collider;

/// Of the thickness: so deep, a start is as good as on the surface.
static const float COLLISION_SHALLOW = 0.1f;

enum
{
    COLLISION_BLOCK = WISP_PARTICLE_BLOCK,
};

/// A half space that a particle must stay in for a substep, and what keeping it there has cost so far.
typedef struct collision_contact
{
    float point[3];  // m, on the body, where it is at the end of the substep
    float normal[3]; // unit, away from the body
    float motion[3]; // m, that the body's surface moves in the substep
    float gap;       // m, to be kept along the normal
    float pushed;    // m, along the normal, >= 0: stands for the normal impulse
    float rubbed[3]; // m, across it: stands for friction's
    float static_friction, kinetic_friction;
} collision_contact;

/// A body in one substep, seen from who collides with it.
typedef struct collision_view
{
    const collision_body* body;
    wisp_rigid before, after;
    float thickness; // m, of both
    float static_friction, kinetic_friction;
} collision_view;

/// A block of particles as arrays, so that who is far away from a body is found for many of them at once.
typedef struct collision_block
{
    int count;                     // of those that move, and are finite
    int32_t slot[COLLISION_BLOCK]; // of each of them
    float now[3][COLLISION_BLOCK]; // m, in the world
    float old[3][COLLISION_BLOCK]; // m, likewise, when the substep began
    wisp_vec3 low, high;           // m, of all paths, before a body moved anything
    float clear[COLLISION_BLOCK];  // m, how far away nothing is met that has no contact
    // of one body, in its frame
    float from[3][COLLISION_BLOCK], to[3][COLLISION_BLOCK];
    float path[COLLISION_BLOCK], reach[COLLISION_BLOCK]; // m
    int32_t asked[COLLISION_BLOCK];                      // in the block: who may be within reach
    int asked_count;
} collision_block;

/// What contacts are found for.
typedef struct collision_find_job
{
    const wisp_kernels* kernels;
    float *position, *previous; // quads
    int32_t* count;             // contacts met
    float* found;               // quads
    collision_contact ( *contact )[WISP_COLLISION_CONTACTS];
    float recovery; // m in this substep
} collision_find_job;

/// The bodies that the span's entity collides with in its substep, one after another: start with *next = 0.
bool collision_next( wisp_frame* frame, const wisp_span* span, const collision_state* state, int* next,
                     collision_view* out );

// ---- collision_query.c: closed forms and meshes alike, in the body's frame ----

/// How far a box in the world at least stays from the ball around the body in the substep, m; 0 for a body that turns.
float collision_ball_distance( const collision_view* view, wisp_vec3 low, wisp_vec3 high );
/// The surface near each point: false where nothing is within its radius, or the point is not finite. Inside a body
/// there always is a surface. A sheet has its normal towards the point and no distance below 0.
void collision_closest( const collision_body* body, const wisp_mesh_query* queries, int count,
                        wisp_surface_point* nearest, bool* found );
/// The first time a path enters the body, or crosses the sheet from either side.
bool collision_sweep( const collision_body* body, wisp_vec3 from, wisp_vec3 to, wisp_surface_point* hit );
/// Signed distance less the thickness of what starts at `from`, but no less than `gap`.
float collision_exact_gap( const collision_view* view, wisp_vec3 from, float gap );

// ---- collision_block.c: what is too far away ----

/// Take the slots that move and are finite; all lose their contacts and are found where they are.
void collision_begin_block( const collision_find_job* job, int begin, int end, collision_block* block );
/// Seen from the body: where each particle comes from and gets to, and who is asked for the closest point. Who is not
/// is surely beyond its reach, and is clear so far.
void collision_see_block( const wisp_kernels* kernels, const collision_view* view, collision_block* block );

// ---- collision_find.c: one block and its bodies, which are met in their order ----

void collision_meet( const collision_find_job* job, const collision_view* view, collision_block* block );
void collision_end_block( const collision_find_job* job, const collision_block* block );

// ---- passes ----

void collision_find( wisp_frame* frame, const wisp_span* span, void* user );
void collision_project( wisp_frame* frame, const wisp_span* span, void* user );
void collision_sense( wisp_frame* frame, const wisp_span* span, void* user );
void collision_measure( wisp_frame* frame, const wisp_span* span, void* user );
void collision_measure_touch( wisp_frame* frame, const wisp_span* span, void* user );
void collision_touch_strands( wisp_frame* frame, const wisp_span* span, void* user );
void collision_measure_strands( wisp_frame* frame, const wisp_span* span, void* user );
void collision_keep_out( wisp_frame* frame, const wisp_span* span, void* user );
void collision_measure_carried( wisp_frame* frame, const wisp_span* span, void* user );
void collision_carry( wisp_frame* frame, const wisp_span* span, void* user );

// ---- collision_module.c ----

/// Who collides has contacts while there is a body and it is enabled. Without memory everything is as it was.
wisp_status collision_dress_guests( wisp_world* world, collision_state* state );
/// The module's state, or a sentence that it is not registered.
wisp_status collision_find_state( wisp_world* world, collision_state** out );
/// Room for one more element behind `count`; the array may move.
bool collision_reserve( wisp_world* world, void** array, int* capacity, int count, size_t element );
/// Take a body off the list and free its tree. @return whether there was one
bool collision_forget_body( collision_state* state, wisp_entity entity );

// ---- small vectors ----

static inline wisp_vec3 collision_load( const float* p )
{
    return ( wisp_vec3 ){ p[0], p[1], p[2] };
}

static inline void collision_store( float* to, wisp_vec3 v )
{
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

static inline wisp_vec3 collision_sub( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

/// a + s b
static inline wisp_vec3 collision_add_scaled( wisp_vec3 a, float s, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static inline float collision_dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline float collision_length( wisp_vec3 a )
{
    return sqrtf( collision_dot( a, a ) );
}

// Of two numbers that are some: fminf() and fmaxf() are calls, because they also have to answer for NaN.
static inline float collision_smaller( float a, float b )
{
    return a < b ? a : b;
}

static inline float collision_larger( float a, float b )
{
    return a > b ? a : b;
}

static inline float collision_outside( float distance, float half )
{
    return collision_larger( fabsf( distance ) - half, 0.0f );
}

/// How far a point is from the box around the body, m; 0 inside.
static inline float collision_box_distance( const collision_body* body, wisp_vec3 p )
{
    const wisp_vec3 d = collision_sub( p, body->centre ), half = body->half;
    return collision_length( ( wisp_vec3 ){ collision_outside( d.x, half.x ), collision_outside( d.y, half.y ),
                                            collision_outside( d.z, half.z ) } );
}

/// Within what bodies can be asked about.
static inline bool collision_is_finite( wisp_vec3 v )
{
    return fabsf( v.x ) <= 1e9f && fabsf( v.y ) <= 1e9f && fabsf( v.z ) <= 1e9f;
}

/// One lane of a row of sixteen vertices.
static inline wisp_vec3 collision_load_lane( const float* x )
{
    return ( wisp_vec3 ){ x[0], x[WISP_LANES], x[2 * WISP_LANES] };
}

static inline void collision_store_lane( float* x, wisp_vec3 v )
{
    x[0] = v.x;
    x[WISP_LANES] = v.y;
    x[2 * WISP_LANES] = v.z;
}

/// Make a box hold a point.
static inline void collision_widen( wisp_vec3* low, wisp_vec3* high, wisp_vec3 p )
{
    *low = ( wisp_vec3 ){ collision_smaller( p.x, low->x ), collision_smaller( p.y, low->y ),
                          collision_smaller( p.z, low->z ) };
    *high = ( wisp_vec3 ){ collision_larger( p.x, high->x ), collision_larger( p.y, high->y ),
                           collision_larger( p.z, high->z ) };
}

/// Signed distance at the start of a path whose end has met a plane, less the thickness. The plane tells it well enough
/// near the surface; farther away the surface may be curved between the two places, and is asked.
static inline float collision_start_gap( const collision_view* view, const wisp_surface_point* plane, wisp_vec3 from,
                                         bool swept )
{
    float gap = collision_dot( plane->normal, collision_sub( from, plane->point ) ) - view->thickness;
    bool is_known = swept || gap >= -COLLISION_SHALLOW * view->thickness;
    return is_known ? gap : collision_exact_gap( view, from, gap );
}
