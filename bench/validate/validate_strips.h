/// Strips and sheets of cloth among bodies.
#pragma once

#include "validate_bodies.h"

/// Add those of a definition, whose solver is one of cloth.
wisp_status validate_add_sheets( validate_bodies* bodies, wisp_error* error );
