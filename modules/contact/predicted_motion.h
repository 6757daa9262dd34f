// Displacements of points and clusters in a substep, and how well clusters follow their predicted motion.
#pragma once

#include "contact_mesh.h"

enum
{
    CONTACT_SUBSTEPS_AHEAD = 5, // for which clusters are predicted to drift
};

/// Displacements of the points of a cluster: the centre of their bounding box, and the radius around it.
typedef struct contact_way
{
    float middle[3], spread; // m per substep
} contact_way;

/// What a broad phase assumes of a cluster: it goes on as in the substep of the search, within a margin.
typedef struct contact_predicted_motion
{
    float displacement[3]; // m per substep, relative to the mean of all points
    float margin;          // m, the deviation that the pair lists cover
    float deviation;       // m, sum since the search
} contact_predicted_motion;

typedef struct contact_motion
{
    float* ahead;       // [point][4] m: displacement in this substep, and the tolerance around it
    uint8_t* is_missed; // [point] it left that tolerance, so constraints may be missing
    float common[3];    // m, mean displacement of all points; 0 if one of them is pinned or touches a body
    contact_way* ways;  // [cluster] displacements in this substep
    contact_way* gone;  // [cluster] displacements in the substep before
    contact_predicted_motion* predicted; // [cluster]
    uint8_t* cluster_is_missed;          // [cluster] one of its points is missed
    int substeps;                        // since the last search
    float reach;                         // m, relative to the mean: no free point goes farther in this substep
    wisp_buffer buffers[6];
} contact_motion;

/// What the displacements of a substep mean for the lists.
typedef enum contact_reached
{
    CONTACT_WITHIN,    ///< every point is within its tolerance
    CONTACT_ELSEWHERE, ///< a point is not: constraints may be missing
    CONTACT_BEYOND,    ///< a cluster deviates by more than its margin: pairs of clusters may be missing too
} contact_reached;

/// Make room for the points and clusters of the contact mesh.
/// @return false without memory
bool contact_reserve_motion( const contact_work* work );

/// Predict displacements at the start of a substep, from positions that the integrator predicted.
contact_reached contact_expect_ways( const contact_work* work );

/// Measure displacements at the end of a substep, and mark points outside their tolerance as missed.
contact_reached contact_measure_ways( const contact_work* work );

/// Shorten displacements, relative to the mean of all points, to `reach`.
void contact_shorten_ways( const contact_work* work );

/// Predict cluster motion from this substep; reset deviations.
void contact_predict_motion( const contact_work* work );

/// Add the deviations of this substep.
void contact_add_deviation( const contact_work* work );

/// Return the largest displacement of a cluster's points, relative to the mean of all points, m.
float contact_length_of_way( const contact_contact_mesh* s, const contact_way* way );

/// Return the most that two clusters can approach each other in a substep, m. Rounded up.
static inline float contact_closing_of( const contact_way* a, const contact_way* b )
{
    const float x = a->middle[0] - b->middle[0], y = a->middle[1] - b->middle[1], z = a->middle[2] - b->middle[2];
    return 1.0001f * ( sqrtf( x * x + y * y + z * z ) + ( a->spread + b->spread ) );
}
