// Loads: the weight of upper layers in the friction of lower ones.
#pragma once

#include "supports.h"

/// Fetch the loads of the substep before.
void contact_begin_loads( const contact_work* work );

/// Apply friction to a supported row.
void contact_apply_pile_friction( const contact_work* work, contact_row* row );

/// Hand loads down to the layers below, for the next substep, and to the friction of bodies.
void contact_hand_down_loads( const contact_work* work );
