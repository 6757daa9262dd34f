/// What the tables of a suite have beside times and errors, gathered from a sampled run.
#pragma once

#include "suite_measure.h"

/// Values of a row. The first ones are in the table of settings, those from SAMPLE_CONTACT_FIRST on in a table of contact.
typedef enum suite_sample
{
    SAMPLE_STRETCH_MAX,
    SAMPLE_STRETCH_MEAN,
    SAMPLE_ENERGY,
    SAMPLE_ENERGY_RISEN,
    SAMPLE_ENERGY_LOST,
    SAMPLE_SPEED,
    SAMPLE_PENETRATION,
    SAMPLE_RESETS,
    SAMPLE_ERROR_FIRST, ///< at suite_moments, one after another
    SAMPLE_ERROR_LAST = SAMPLE_ERROR_FIRST + SUITE_MOMENT_COUNT - 1,
    SAMPLE_LARGEST_DISTANCE,
    SAMPLE_DETAIL,
    SAMPLE_ENERGY_COMPARED,
    SAMPLE_ITERATIONS,
    SAMPLE_FIRST_ORDER,
    SAMPLE_NOT_CONVERGED,
    SAMPLE_VOLUME_ERROR,
    SAMPLE_PRESSURE,
    SAMPLE_EVEN_PRESSURE,
    SAMPLE_INTERSECTIONS,
    SAMPLE_INTERSECTIONS_DRIVEN,
    SAMPLE_MEMORY,
    SAMPLE_CANDIDATES,
    SAMPLE_CONTACT_FIRST = SAMPLE_CANDIDATES,
    SAMPLE_CONTACTS,
    SAMPLE_SEARCHES,
    SAMPLE_INTERSECTIONS_MAX,
    SAMPLE_INTERSECTED_STEPS,
    SAMPLE_MIN_GAP,
    SAMPLE_LIMITED,
    SAMPLE_IMPULSE,
    SAMPLE_NET_IMPULSE,
    SAMPLE_FORCE,
    SAMPLE_OVERLAP,
    SAMPLE_OVERLAP_MAX,
    SAMPLE_MISSED,
    SAMPLE_WALL_RADIUS,
    SAMPLE_WALL_UNEVENNESS,
    SAMPLE_COUNT,
} suite_sample;

extern const char* const suite_sample_names[SAMPLE_COUNT];

/// Mark the samples that a scene can have.
void suite_samples_of( const wisp_scene* scene, bool has[SAMPLE_COUNT] );

typedef struct suite_sampler
{
    int last_step; ///< of the run
    bool has_contact, has_overlap;
    double stretch_max, stretch_mean; // the largest, and the mean of steps
    double energy_first, energy;      // J, after the first and the last step
    double energy_most;               // J, after any step
    double potential_first, potential;
    double speed; // m/s, of the fastest vertex after the last step
    double candidates, contacts, searches, limited, impulse, net_impulse, force, min_gap;
    int intersections_max, intersected_steps, contact_steps;
    int intersections_driven; // after the last step
    suite_overlap overlap;
    double overlap_max, missed_max;               // m, fraction
    double iterations;                            // of conjugate gradients
    double first_order;                           // substeps
    double volume_error, pressure, even_pressure; // of the first balloon: fraction, Pa, Pa
    int steps;
} suite_sampler;

/// Tell it of a run's start and steps. @param user the sampler
wisp_status suite_sampler_observe( void* user, const scene_world* world, wisp_error* error );
/// The samples of a comparison with a reference, in their units. @param out [SAMPLE_COUNT] others stay as they are
void suite_sampler_comparison( const suite_comparison* compared, double* out );

/// @param out [SAMPLE_COUNT] NaN: the run does not have it
void suite_sampler_values( const suite_sampler* sampler, const suite_measurement* measured, double* out );
