// Keys that `wisp tune` may change. A key is listed only if its last value is that of the reference run, and if it
// does not change the material. For strands this excludes (measured with `wisp bench accuracy --scene
// strands_swing`):
//
// - `stretch`: following the leader converges to another motion, 38 mm away at any number of substeps. Links with a
//   compliance are another strand, and without one they reach the error of the direct solve in no less time.
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
    [FIELD_LEVELS] = { "levels", "surfaces", NULL, "finest_level", OF_CLOTH, .is_unordered = true, .is_falling = true,
                       .candidates = { 3, 2, 1 } },
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

// An instance shares the fabric of its source, including levels and the anchors of tethers.
static const wisp_scene_surface* fabric_of( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    return surface->instance_of < 0 ? surface : &scene->surfaces[surface->instance_of];
}

static bool may_have_levels( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    return surface->has_cloth && fabric_of( scene, surface )->has_cloth;
}

static bool is_pinned( const wisp_scene_surface* surface )
{
    return surface->pin_count + surface->pin_box_count + surface->pin_nearest_count > 0;
}

// Tethers reach to the pins of the source, and hold where the instance is pinned.
static bool may_have_tethers( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    return surface->has_cloth && is_pinned( surface ) && is_pinned( fabric_of( scene, surface ) );
}

static bool is_direct( const wisp_scene_strands* strands )
{
    return strands->has_dynamics && strands->dynamics.stretch == WISP_STRAND_STRETCH_DIRECT;
}

bool tune_field_is_in( const wisp_scene* scene, int which, int entry )
{
    switch ( tune_fields[which].place )
    {
        case OF_CLOTH:
            return may_have_levels( scene, &scene->surfaces[entry] );
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

static double levels_of( const wisp_scene* scene, const wisp_scene_surface* surface )
{
    const wisp_scene_surface* fabric = fabric_of( scene, surface );
    return fabric->levels > 0 && surface->cloth.level_passes > 0 ? fabric->finest_level : 0.0;
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
        case FIELD_LEVELS:
            return levels_of( scene, &scene->surfaces[entry] );
        case FIELD_TOLERANCE:
            return (double)scene->surfaces[entry].implicit.tolerance;
        case FIELD_REPEATS:
            return scene->surfaces[entry].implicit.newton_iterations;
        default:
            return scene->strands[entry].dynamics.stretch_passes;
    }
}

// A surface with levels turned off keeps their number. Levels of an instance are its source's; only passes are its
// own.
static void set_levels( wisp_scene_surface* surface, double value, int passes )
{
    surface->cloth.level_passes = value > 0.0 ? passes : 0;
    if ( value > 0.0 && surface->instance_of < 0 )
    {
        surface->levels = surface->levels == 0 ? TUNE_LEVELS : surface->levels;
        surface->finest_level = (int)value;
    }
}

void tune_field_set( wisp_scene* scene, int which, int entry, double value, int level_passes )
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
        case FIELD_LEVELS:
            set_levels( &scene->surfaces[entry], value, level_passes );
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

int tune_level_passes( const wisp_scene* scene )
{
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        if ( tune_field_is_in( scene, FIELD_LEVELS, i ) && scene->surfaces[i].cloth.level_passes > 0 )
        {
            return scene->surfaces[i].cloth.level_passes;
        }
    }
    return 1;
}
