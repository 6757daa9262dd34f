// Keys that `wisp tune` may change. A key is listed only if its last value is that of the reference run, and if it
// does not change the material. For strands this excludes (measured with `wisp bench accuracy --scene
// strands_swing`):
//
// - `stretch`: links with a compliance are another strand, and without one they reach the error of the direct solve in
//   no less time.
// - `stretch_tolerance`: decides which strands are reset; a smaller one resets more of them, which is no nearer to the reference.
// - the grid's cell and friction: a smaller cell is friction with fewer neighbours.
// - counts of strands and vertices, and ghosts: the compared points must be as many as those of the reference.
//
// Rods have nothing to tune: bending is one direct solve per substep.
#include "tune_fields.h"

const tune_field tune_fields[FIELD_COUNT] = {
    [FIELD_SUBSTEPS] = { "substeps", NULL, NULL, "substeps", OF_SCENE, .candidates = { 1, 2, 4, 8, 16 } },
    [FIELD_ITERATIONS] = { "iterations", NULL, NULL, "iterations", OF_SCENE, .candidates = { 1, 2, 4 } },
    [FIELD_TETHERS] = { "cloth.tethers", "surfaces", "cloth", "tethers", OF_PINNED_CLOTH, .is_unordered = true,
                        .candidates = { 1 } },
    [FIELD_COARSE] = { "cloth.coarse_substeps", "surfaces", "cloth", "coarse_substeps", OF_XPBD_CLOTH,
                       .is_unordered = true, .candidates = { 1, 2 } },
    [FIELD_TOLERANCE] = { "implicit.tolerance", "surfaces", "implicit", "tolerance", OF_IMPLICIT, .is_falling = true,
                          .candidates = { 1e-1, 1e-2, 1e-3, 1e-4 } },
    [FIELD_REPEATS] = { "implicit.newton_iterations", "surfaces", "implicit", "newton_iterations", OF_IMPLICIT,
                        .candidates = { 1, 2, 4 } },
    [FIELD_PASSES] = { "dynamics.stretch_passes", "strands", "dynamics", "stretch_passes", OF_DIRECT_STRANDS,
                       .candidates = { 1, 2, 8 } },
};

// ---- what a scene has ----

int tune_field_entries( const wisp_scene* scene, int which )
{
    const tune_place place = tune_fields[which].place;
    return place == OF_SCENE ? 1 : place == OF_DIRECT_STRANDS ? scene->strands_count : scene->surface_count;
}

// An instance shares the fabric of its source, including the anchors of tethers.
static const wisp_scene_surface* fabric_of( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    return surface->instance_of < 0 ? surface : &scene->surfaces[surface->instance_of];
}

// Tethers reach to the pins of the source, and hold where the instance is pinned.
static bool may_have_tethers( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    return surface->has_cloth && wisp_scene_has_pins( surface ) && wisp_scene_has_pins( fabric_of( scene, surface ) );
}

static bool is_direct( const wisp_scene_strands* strands )
{
    return strands->has_dynamics && strands->dynamics.stretch == WISP_STRAND_STRETCH_DIRECT;
}

bool tune_field_is_in( const wisp_scene* scene, int which, int entry )
{
    switch ( tune_fields[which].place )
    {
        case OF_XPBD_CLOTH:
            return scene->surfaces[entry].has_cloth && !scene->surfaces[entry].has_membrane &&
                   scene->surfaces[entry].cloth.solver == WISP_SOLVER_XPBD;
        case OF_PINNED_CLOTH:
            return may_have_tethers( scene, &scene->surfaces[entry] );
        case OF_IMPLICIT:
            return scene->surfaces[entry].has_implicit;
        case OF_DIRECT_STRANDS:
            return is_direct( &scene->strands[entry] );
        case OF_SCENE:
            break;
    }
    return true;
}

double tune_field_value( const wisp_scene* scene, int which, int entry )
{
    switch ( which )
    {
        case FIELD_SUBSTEPS:
            return scene->substeps;
        case FIELD_ITERATIONS:
            return scene->iterations;
        case FIELD_TETHERS:
            return scene->surfaces[entry].cloth.tethers ? 1.0 : 0.0;
        case FIELD_COARSE:
            return scene->surfaces[entry].cloth.coarse_substeps;
        case FIELD_TOLERANCE:
            return (double)scene->surfaces[entry].implicit.tolerance;
        case FIELD_REPEATS:
            return scene->surfaces[entry].implicit.newton_iterations;
        default:
            return scene->strands[entry].dynamics.stretch_passes;
    }
}

void tune_field_set( wisp_scene* scene, int which, int entry, double value )
{
    switch ( which )
    {
        case FIELD_SUBSTEPS:
            scene->substeps = (int)value;
            break;
        case FIELD_ITERATIONS:
            scene->iterations = (int)value;
            break;
        case FIELD_TETHERS:
            scene->surfaces[entry].cloth.tethers = value > 0.0;
            break;
        case FIELD_COARSE:
            scene->surfaces[entry].cloth.coarse_substeps = (int)value;
            break;
        case FIELD_TOLERANCE:
            scene->surfaces[entry].implicit.tolerance = (float)value;
            break;
        case FIELD_REPEATS:
            scene->surfaces[entry].implicit.newton_iterations = (int)value;
            break;
        default:
            scene->strands[entry].dynamics.stretch_passes = (int)value;
            break;
    }
}

bool tune_field_own( const wisp_scene* scene, int which, double* out )
{
    for ( int i = 0; i < tune_field_entries( scene, which ); ++i )
    {
        if ( tune_field_is_in( scene, which, i ) )
        {
            *out = tune_field_value( scene, which, i );
            return true;
        }
    }
    return false;
}
