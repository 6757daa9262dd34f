/// Surfaces with a layer of boundary particles: static, pulsating, or the balloon of the boundary particle paper; and
/// the results of its equations in double precision for the same positions.
#pragma once

#include "balloon_scene.h"

#include "boundary/boundary.h"

#define LAYER_RADIUS 2.5f ///< m, of the paper's sphere
#define LAYER_SEGMENTS 30 ///< slices and stacks of it
#define LAYER_SPACING 0.1f
#define LAYER_ITERATIONS 5
#define LAYER_SKIN 0.9f   ///< stiffness of its distances
#define LAYER_DECAY 31.7f ///< 1/s: velocity times 0.59 in 1/60 s
#define LAYER_STEP ( 1.0f / 60.0f )
#define LAYER_PERIOD 60 ///< steps of a pulsation

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

/// A surface with a layer, as context of a bench_variant.
typedef struct layer_implementation
{
    surface_implementation surface;
    wisp_boundary_def def;
    bool is_resampled; ///< every step samples all elements again: case B everywhere
    bool has_little;   ///< of two definitions that give the same points, the present one
    /// Of the radius: the surface is scaled by 1 + amplitude sin( 2 pi step / LAYER_PERIOD ). 0: it is static
    double amplitude;
} layer_implementation;

/// A surface without forces. @param fabric the caller's, who keeps it until the implementation is closed
wisp_status layer_enter( wisp_fabric* fabric, const wisp_boundary_def* def, int workers, layer_implementation* out,
                         wisp_error* error );
/// Give a surface a layer, or another one. @param implementation of a world that has the module
wisp_status layer_set( surface_implementation* implementation, const wisp_boundary_def* def, wisp_error* error );
/// One step. @param context the implementation
wisp_status layer_step( void* context, wisp_error* error );
/// Keep the last step's profile.
wisp_status layer_keep_profile( void* context );
/// Milliseconds of a pass over the steps that were kept. @return NaN where it never ran
stats_summary layer_pass_ms( surface_implementation* implementation, const char* pass );

wisp_status layer_read( surface_implementation* implementation, wisp_boundary_view* out, wisp_error* error );
wisp_status layer_read_stats( surface_implementation* implementation, wisp_boundary_stats* out, wisp_error* error );
/// Hash of all outputs of a layer.
uint64_t layer_hash( const wisp_boundary_view* view );

/// Differences of a layer from the oracle's for the same positions.
typedef struct layer_check
{
    int edge_points, inner_points;     ///< of the engine
    int edge_expected, inner_expected; ///< of the oracle
    double farthest;                   ///< m, of a point from the oracle's; infinite if the counts differ
    double off_surface;                ///< m, of a point from its edge, or from the plane of its triangle
    double reach;                      ///< m, the largest coordinate of a point
} layer_check;

/// @param triangles the user's, of the cooked mesh
wisp_status layer_compare( surface_implementation* implementation, const wisp_mesh* mesh,
                           const wisp_boundary_def* def, layer_check* out, wisp_error* error );
/// Counts equal the oracle's, and points are at the oracle's positions and on the surface, up to rounding.
bool layer_check_is_met( const layer_check* check );

/// Volume over that of the mesh.
wisp_status layer_volume( surface_implementation* implementation, const wisp_mesh* mesh, double* volume,
                          wisp_error* error );

/// The balloon of the boundary particle paper. Start from layer_default_balloon().
typedef struct layer_balloon
{
    float skin;       ///< stiffness of the distances
    float multiplier; ///< of the rest volume
    float gravity;    ///< m/s^2
    bool is_hung;     ///< at its top
    float seconds;    ///< per step
} layer_balloon;

layer_balloon layer_default_balloon( void );
/// Its layer is not set yet. @param mesh hung by its first vertex along +y
wisp_status layer_enter_balloon( wisp_fabric* fabric, const wisp_mesh* mesh, const layer_balloon* setting,
                                 surface_implementation* out, wisp_error* error );
