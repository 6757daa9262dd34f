// Untangling: surfaces that intersect are drawn apart.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/intersections.h"

typedef struct contact_untangling
{
    int32_t ( *faces )[2]; // [edge] its triangles, -1: none
    bool has_faces;        // they were found since the contact mesh was built
    wisp_buffer buffer;
} contact_untangling;

/// Move the points of all intersections by a bounded step that undoes them.
void contact_untangle( const contact_work* work );

typedef struct contact_intersections
{
    wisp_intersections intersections;
    uint8_t* is_tangled; // [point] of an edge or a triangle that intersects
    wisp_buffer buffer;
} contact_intersections;

/// Make room for the points of the contact mesh; nothing is marked.
/// @return false without memory
bool contact_reserve_intersections( const contact_work* work );

/// Find all intersections exactly.
/// @param xyzw [point][4] m, positions
wisp_status contact_find_intersections( const contact_work* work, const float* xyzw, wisp_error* error );

/// Return whether an intersection is between participants that are kept apart.
bool contact_is_forbidden( const contact_work* work, const wisp_intersection* intersection );

/// Return whether any of its points can move. Nothing undoes an intersection of pinned points, so it is not counted.
bool contact_is_movable( const contact_contact_mesh* s, const wisp_intersection* intersection );

/// Count the movable ones of the last search between two participants, or of one with itself.
int contact_count_intersections( const contact_contact_mesh* s, int a, int b );

/// Mark the points of intersections at the intersection-free positions, while there may be any.
wisp_status contact_mark_intersections( const contact_work* work, wisp_error* error );

/// Part participants whose primitives start in one place, by a tenth of their distance and along the normals of the earlier one, in
/// the order of their numbers. One that has pins stays. The recovery does the rest.
/// @return whether any are: pairs and rows have to be found again
bool contact_part_coincident( const contact_work* work );
