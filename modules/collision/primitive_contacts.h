// Contacts of edges and triangles with convex bodies, beside those of particles.
#pragma once

#include "particle_contacts.h"
#include "collision_vectors.h"
#include "wisp/module/shapes.h"
#include "body_queries.h"

// ---- the deepest point of a segment or a triangle in a convex body, in the frame of the body ----

/// The point of a primitive with the smallest signed distance.
typedef struct collision_deepest
{
    float weights[3];           // of the corners; they sum to 1
    wisp_surface_point surface; // of the body, closest to the point
} collision_deepest;

/// Return a lower bound of the signed distance of the points of a segment or a triangle, m, from the tangent planes at its corners;
/// -INFINITY if one is not finite. @param corner receives the smallest signed distance of a corner
float collision_bound_deepest( const wisp_shape* shape, const wisp_vec3* corners, int corner_count, float* corner );

/// Find the deepest point of a segment (2 corners) or a triangle (3 corners).
/// @param tolerance m, by which its signed distance may be above the smallest one, where rounding allows it
/// @return false if a corner is not finite
bool collision_find_deepest( const wisp_shape* shape, const wisp_vec3* corners, int corner_count, float tolerance,
                             collision_deepest* out );

// ---- contacts of primitives ----

enum
{
    COLLISION_PRIMITIVE_CONTACTS = 2, // of an edge or a triangle; the deepest are kept
};

/// A half space that a point of an edge or a triangle must stay in for a substep.
typedef struct collision_primitive_contact
{
    collision_contact half_space;
    float weights[3]; // of the corners
    int32_t body;     // its place in the list
} collision_primitive_contact;

_Static_assert( sizeof( collision_primitive_contact ) == 20 * sizeof( float ), "no padding" );

/// The path of a primitive in the frame of a body.
typedef struct primitive_path
{
    int corner_count;
    wisp_vec3 from[3], to[3];
    float displacement; // m, of the fastest corner
    // half spaces of the corners' own contacts, of a mesh: normals in the frame of the body, and distances of the corners, m
    int plane_count;
    wisp_vec3 normals[3 * WISP_COLLISION_CONTACTS];
    float distances[3 * WISP_COLLISION_CONTACTS];
} primitive_path;

/// Where a primitive meets a body.
typedef struct collision_meeting
{
    collision_deepest deepest; // its surface point is that at the end of the substep
    wisp_vec3 motion;          // m, of that point in the substep; zero of a rigid mesh
} collision_meeting;

/// Edges or triangles of a participant, and their contacts.
typedef struct collision_primitives
{
    const int32_t* corners; // [count][corner_count] slots
    int count, corner_count;
    int32_t* found; // [count] contacts of the substep, those left out included
    collision_primitive_contact ( *contacts )[COLLISION_PRIMITIVE_CONTACTS];
    int32_t* active;            // primitives with contacts, in their order
    int32_t* active_count;      // of a participant
    int32_t *near, *near_count; // those that may meet a body in this step, likewise
} collision_primitives;

/// Get the edges ( corner_count 2 ) or the triangles ( 3 ) of a participant. They have rows while it collides with all features.
collision_primitives collision_primitives_of( wisp_frame* frame, wisp_entity participant,
                                              const collision_state* state, int corner_count );

/// Return the number of contacts that a primitive has.
static inline int collision_contacts_of( const collision_primitives* p, int primitive )
{
    return p->found[primitive] < COLLISION_PRIMITIVE_CONTACTS ? p->found[primitive] : COLLISION_PRIMITIVE_CONTACTS;
}

/// Find the contacts of all edges and triangles on their way from the previous positions to the positions.
/// @param recovery m, by which what starts too near is moved out; negative: not at all
void collision_search_primitives( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                                  float recovery );

/// Find where an edge or a triangle meets a body that is no closed form: up to two edges or corners of a mesh, or a point of a
/// convex body.
/// @param out [COLLISION_PRIMITIVE_CONTACTS] @return how many
int collision_meet_body( const collision_view* view, const primitive_path* path, collision_meeting* out );

/// Take over where a primitive meets a closed form. @return false: its corners are not finite
bool collision_take_meeting( const collision_view* view, const primitive_path* path,
                             const wisp_primitive_meeting* met, collision_meeting* out );

/// Return the signed distance less the thickness at which the point of a meeting starts.
float collision_meeting_gap( const collision_view* view, const primitive_path* path, const collision_meeting* m );

/// Return whether edges and triangles collide with a body. A plane needs no more than vertices.
static inline bool collision_meets_primitives( const collision_body* body )
{
    return body->tree != NULL || body->shape.kind != WISP_SHAPE_PLANE;
}

// ---- contacts of edges and triangles of a surface with the corners and edges of a mesh or a height field ----

/// Return whether a body has edges and corners of its own: a mesh, a surface or a height field.
static inline bool collision_has_features( const collision_body* body )
{
    return body->tree != NULL || body->shape.kind == WISP_SHAPE_HEIGHT_FIELD;
}

/// Find where an edge meets edges of such a body, or a triangle its corners: the two that come first, else the two that are nearest at
/// the end of the path. @param out [COLLISION_PRIMITIVE_CONTACTS] @return how many
int collision_meet_features( const collision_view* view, const primitive_path* path, collision_meeting* out );

/// Find the closest points of an edge and another edge, or of a triangle and a point.
/// @param corners [count] of the primitive, 2 or 3 @param ends of the feature; of a point twice the same
/// @param weights [3] receives those of the corners @param along receives where on the edge, 0 .. 1
/// @return distance, m
double collision_closest_feature( const wisp_vec3* corners, int count, const wisp_vec3 ends[2], float* weights,
                                  float* along );
