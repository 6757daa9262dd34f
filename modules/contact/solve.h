// Projection of contact constraints.
#pragma once

#include "constraints.h"

/// Project all constraints once, with friction.
void contact_project_rows( const contact_work* work );

/// Push pairs apart that are closer than their gap, at a bounded speed and without giving them velocity.
void contact_recover( const contact_work* work );
