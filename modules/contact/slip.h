// Tangential displacements of the two sides of a row, and how far friction takes them back.
#pragma once

#include "constraints.h"

/// Add how far the points [begin, end) of a row moved in the substep, with their weights.
void contact_add_way( const contact_contact_mesh* s, const contact_row* row, int begin, int end, float way[3] );

/// Find the tangential correction that a row still has to make, and add it to those made.
/// @param way m, how far its first side moved relative to the second @param most m, the greatest length of all of them
/// @param by m, receives it
void contact_find_slip( contact_row* row, const float way[3], float most, float by[3] );
