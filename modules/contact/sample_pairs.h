// Pairs of boundary particles: broad and narrow phase.
#pragma once

#include "primitive_pairs.h"

/// Two boundary particles within their margins.
typedef struct contact_candidate
{
    contact_pair pair;
    float active_at; // m, sum of the deviations of its sides below which it cannot reach its gap
} contact_candidate;

/// Search for all pairs of particles.
wisp_status contact_find_sample_pairs( const contact_work* work, wisp_error* error );

/// Find the active pairs, as contact_find_near().
wisp_status contact_find_near_samples( const contact_work* work, bool missed_only, wisp_error* error );
