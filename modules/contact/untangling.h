// Untangling: surfaces that intersect are drawn apart.
#pragma once

#include "contact_mesh.h"

typedef struct contact_untangling
{
    int32_t ( *faces )[2]; // [edge] its triangles, -1: none
    bool has_faces;        // they were found since the contact mesh was built
    wisp_buffer buffer;
} contact_untangling;

/// Move the points of all intersections by a bounded step that undoes them.
void contact_untangle( const contact_work* work );
