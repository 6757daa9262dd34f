/// Rough floors that bodies press with their free ends.
#pragma once

#include "validate_bodies.h"

/// Add those of a definition that has floors, when its bodies are there.
wisp_status validate_add_floors( validate_bodies* bodies, wisp_error* error );
