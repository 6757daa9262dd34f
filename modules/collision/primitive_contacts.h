// Contacts of edges and triangles with convex bodies, beside those of particles.
#pragma once

#include "deepest_point.h"
#include "particle_contacts.h"

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

/// Edges or triangles of a participant, and their contacts.
typedef struct collision_primitives
{
    const int32_t* corners; // [count][corner_count] slots
    int count, corner_count;
    int32_t* found; // [count] contacts of the substep, those left out included
    collision_primitive_contact ( *contacts )[COLLISION_PRIMITIVE_CONTACTS];
    int32_t* active;       // primitives with contacts, in their order
    int32_t* active_count; // of a participant
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

/// Return whether edges and triangles collide with a body. A plane needs no more than vertices.
static inline bool collision_meets_primitives( const collision_body* body )
{
    return body->tree != NULL || body->shape.kind != WISP_SHAPE_PLANE;
}
