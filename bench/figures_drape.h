/// The figures of Noh and Jung: a cloth that falls onto a ball, and what its engine makes of
/// energy, of long steps, of accuracy and of finer meshes.
#pragma once

#include "figures_bench.h"
#include "triangle_scene.h"

figures_fn
    figures_drape; ///< Noh and Jung, Fig. 8 to 11: at rest for stiffness 50 to 350, frames, against the quad mesh
figures_fn figures_drape_steps; ///< the stiffest cloth in steps of 1/100, 1/60 and 1/30 s
figures_fn
    figures_free_flight; ///< Noh and Jung, section 3.3: energy does not grow, and falls faster with more damping
figures_fn figures_hang_accuracy; ///< extension: gain and cost of tolerance, iterations and shorter steps
figures_fn figures_hang_refined;  ///< extension: stiffness of the sheet makes a finer mesh the same cloth

/// A cloth is at rest when this share of the largest kinetic energy is left ...
#define DRAPE_REST 1e-4
#define DRAPE_REST_SECONDS 15.0 ///< ... after so long
/// Largest allowed depth of a vertex in the ball, m.
#define DRAPE_DEPTH 1e-3

// ---- observations ----

/// The border of a mesh with one: its vertices one after another.
typedef struct drape_border
{
    int32_t* vertices; ///< [count]
    double* places;    ///< [count] share of the border's length at rest, rising from 0
    int count;
} drape_border;

wisp_status drape_border_find( const wisp_mesh* mesh, drape_border* out, wisp_error* error );
void drape_border_free( drape_border* border );

typedef struct drape_observation
{
    double kinetic;           ///< J
    double gap, gap_between;  ///< m, least distance from the ball's surface: of vertices, of the middles of edges
    double strain;            ///< largest of the links that stretch, 0 if none is longer than at rest
    double hem_mean, min_hem; ///< m, height of the border
    int folds;                ///< round the border: where it stands out farthest from the ball's axis
    bool is_finite;
} drape_observation;

/// What a step needs: kinetic energy and gap.
wisp_status drape_glance( surface_implementation* implementation, drape_observation* out, wisp_error* error );
/// All of it.
wisp_status drape_observe( const triangle_scene* scene, const drape_border* border,
                           surface_implementation* implementation, drape_observation* out, wisp_error* error );

// ---- a run ----

#define DRAPE_SHOTS_MAX 8

/// Sample a frame, and keep it in an album unless that is null.
typedef struct drape_shot
{
    int frame; ///< from 1
    figures_album* album;
} drape_shot;

typedef struct drape_plan
{
    const triangle_scene* scene;
    const drape_border* border;
    float stiffness; ///< N/m
    float seconds;   ///< a step
    int steps;
    drape_shot shots[DRAPE_SHOTS_MAX]; ///< frames rise; those behind the last step are not taken
    int shot_count;
} drape_plan;

typedef struct drape_result
{
    drape_observation shots[DRAPE_SHOTS_MAX];
    int frames[DRAPE_SHOTS_MAX];
    int contacts[DRAPE_SHOTS_MAX]; ///< vertices that the ball holds
    int shot_count;                ///< that were taken
    drape_observation end;         ///< after DRAPE_REST_SECONDS, or at the last step if that is earlier
    double max_kinetic;            ///< J
    double min_gap;                ///< m
    double iterations;             ///< a step, mean
    double ms;                     ///< a step, mean
    bool is_finite;                ///< always was
} drape_result;

/// Drop it onto the ball.
wisp_status drape_run( const figures_case* page, const drape_plan* plan, drape_result* out, wisp_error* error );
bool drape_is_at_rest( const drape_result* run );

// ---- tables ----

/// What the words of the tables below mean.
void drape_add_terms( figures_case* page );
/// A line for each of the first shots of a run.
void drape_add_sequence( figures_case* page, const char* title, int shot_count, const drape_result* run );
/// A line a run; what was not run is left out. @param stiffnesses [count]
void drape_add_runs( figures_case* page, const char* title, const float* stiffnesses, int count,
                     const drape_result* runs );

// ---- pictures ----

/// Write each shape as FOLDER/<name>_<number>.png, all of them side by side as FOLDER/<name>.png, and link that.
/// @param has_ball show the ball too
wisp_status drape_write( figures_case* page, const figures_album* album, bool has_ball, const char* name,
                         const char* caption, wisp_error* error );
