// Boundary particles that stand for surfaces: vertices, and points on edges and in triangles.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/aabb_pairs.h"
#include "wisp/samples.h"

struct contact_candidate;

typedef struct contact_samples
{
    int count, capacity;
    int own_count;           // made here; behind them are those of layers
    int32_t ( *parents )[3]; // [sample] points
    float ( *weights )[3];   // [sample] barycentric
    float ( *rest )[4];      // [sample] m, rest position; the fourth is the index of the participant
    float ( *position )[3];  // [sample] m, at the last search
    float* deviation;        // [sample] m, the most that its clusters may deviate; in a search the margin
    wisp_aabb* boxes;        // [sample]
    wisp_samples sampler;
    wisp_aabb_pairs overlaps;
    struct contact_candidate* candidates; // sample_pairs.h
    int candidate_count;
    wisp_buffer buffers[6], candidate_buffer;
} contact_samples;

/// Make the particles of all participants: from the layer of a surface that has one, else from its rest shape.
wisp_status contact_sample_participants( const contact_work* work );

/// Take particles over from layers again, which may have changed since the step before.
wisp_status contact_follow_layers( const contact_work* work, wisp_error* error );

/// Compute the position of a particle.
void contact_place_sample( const contact_contact_mesh* s, const float* xyzw, int sample, float out[3] );

/// Return the distance of two particles, m.
float contact_sample_distance( const contact_contact_mesh* s, const float* xyzw, int a, int b );

/// Return the distance that a pair of particles keeps, m; 0 if they may touch.
float contact_sample_gap_of( const contact_work* work, int a, int b );
