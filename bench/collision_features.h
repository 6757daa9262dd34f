/// Table of the case `collision`: what it costs that edges and triangles of a surface collide, and what vertices alone leave.
#pragma once

#include "bench_options.h"

wisp_status collision_features_table( const bench_options* options, results* out, wisp_error* error );
