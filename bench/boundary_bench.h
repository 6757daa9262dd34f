/// The case `boundary`: layers of boundary particles on the sphere of the paper, and what their points cost.
#pragma once

#include "bench.h"
#include "surfaces.h"

#include "boundary/boundary.h"

#define BOUNDARY_SIZES_MAX 8
#define BOUNDARY_WORKERS_MAX 2

/// Sizes. boundary_default_plan() has those of the case; tests have smaller ones.
typedef struct boundary_plan
{
    float spacings[BOUNDARY_SIZES_MAX]; ///< m, of points on the reference sphere
    int spacing_count;
    double seconds; ///< approximate time for the measurements
    int workers[BOUNDARY_WORKERS_MAX], worker_count;
    const bench_options* options; ///< for progress
} boundary_plan;

boundary_plan boundary_default_plan( const bench_options* options );

/// All tables of a plan: points, time and memory by spacing; accuracy against cost.
wisp_status boundary_bench_run( const boundary_plan* plan, results* out, wisp_error* error );

// ---- layers ----

#define LAYER_RADIUS 2.5f ///< m, of the paper's sphere
#define LAYER_SEGMENTS 30 ///< slices and stacks of it

/// A sphere of `segments` slices and as many stacks, its poles on the y axis.
wisp_status layer_sphere( int segments, float radius, wisp_mesh* out, wisp_error* error );
/// Cook without bend links: the boundary particle paper has none.
wisp_status layer_cook( const wisp_mesh* mesh, wisp_fabric** out, wisp_error* error );

/// Points at a spacing by one of the laws that are compared.
typedef struct layer_law
{
    const char* name;
    wisp_spacing policy;
    wisp_rounding rounding;
} layer_law;

#define LAYER_LAWS 3
extern const layer_law layer_laws[LAYER_LAWS]; ///< even, exact, and even without a gap above the spacing

wisp_boundary_def layer_def( const layer_law* law, float spacing );

/// A static surface with a layer, as context of a bench_variant.
typedef struct layer_implementation
{
    surface_implementation surface;
    wisp_boundary_def def;
    bool is_resampled; ///< every step samples all elements again: case B everywhere
    bool has_little;   ///< of two definitions that give the same points, the present one
} layer_implementation;

/// A surface without forces. @param fabric the caller's, who keeps it until the implementation is closed
wisp_status layer_enter( wisp_fabric* fabric, const wisp_boundary_def* def, int workers, layer_implementation* out,
                         wisp_error* error );
/// One step. @param context the implementation
wisp_status layer_step( void* context, wisp_error* error );

wisp_status layer_read( surface_implementation* implementation, wisp_boundary_view* out, wisp_error* error );
wisp_status layer_read_stats( surface_implementation* implementation, wisp_boundary_stats* out, wisp_error* error );
/// Hash of all outputs of a layer.
uint64_t layer_hash( const wisp_boundary_view* view );

/// How densely a layer covers its surface.
typedef struct layer_cover
{
    double gap; ///< m, the largest between neighbours along an edge, its ends included
    /// m, the largest distance of a sampled position of a triangle from the points and corners on it
    double reach;
} layer_cover;

/// @param mesh the user's, at the positions of the layer
wisp_status layer_find_cover( const wisp_boundary_view* view, const wisp_mesh* mesh, layer_cover* out,
                              wisp_error* error );
