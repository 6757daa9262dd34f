// Constraints: a separating plane for each active pair.
#pragma once

#include "narrow_phase.h"

/// A constraint in a substep: the plane between a pair at its intersection-free positions, and the accumulated
/// corrections. The distance along the normal is linear in the points; the first `split` of them are one side.
typedef struct contact_row
{
    int32_t a, b; // the primitives
    int32_t point[CONTACT_MAX_POINTS];
    float weight[CONTACT_MAX_POINTS]; // barycentric, of the second side negative
    float normal[3];                  // unit, from the second side to the first
    float gap;                        // m, to keep in this substep: the smaller of `wanted` and `distance`
    float distance;                   // m, at the intersection-free positions
    float requested;                  // m, half the sum of the thicknesses, or less where the pair is closer at rest
    float friction;
    uint32_t key;                // of the pair, whatever the contact mesh
    float normal_impulse;        // kg m, accumulated, >= 0: times the substep
    float tangential_impulse[3]; // kg m, accumulated
    float closing;               // m, most that its sides approach while points keep to their tolerance
    uint8_t split;               // points of the first side
    bool is_squeezed;            // bodies hold both sides
    bool is_lever;               // a point is a long lever, so that its impulse is not kept
    bool is_passed;              // in a round of the displacement limit
} contact_row;

/// Where an active pair is in the list of its kind.
typedef struct contact_place
{
    int32_t a, b, at;
} contact_place;

typedef struct contact_constraints
{
    contact_row* rows; // points and triangles; then edges. In the order of their primitives
    int split;         // first row of two edges
    int row_count;
    contact_row* missed_rows; // limit displacements, but are not projected
    int missed_row_count;
    contact_place* order[CONTACT_KIND_COUNT]; // of those that become rows
    int order_count[CONTACT_KIND_COUNT];
    wisp_buffer row_buffer, missed_buffer, order_buffer;
} contact_constraints;

/// Build the constraints of all active pairs, in an order that does not depend on the search.
wisp_status contact_find_rows( const contact_work* work, wisp_error* error );

/// Build the constraints that are missing because points left their tolerance.
wisp_status contact_find_missed_rows( const contact_work* work, wisp_error* error );
