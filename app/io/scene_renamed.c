// Old names of keys and words. A scene that has one is refused with its new name, not as unknown.
#include "scene_renamed.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "wisp/base.h"

const scene_renamed SCENE_RENAMED_KEYS[] = {
    // scene
    { NULL, "step_seconds", "dt" },
    { NULL, "commands", "hair_events" },
    { NULL, "script", "events" },
    // strands and surfaces
    { NULL, "make", "generate" },
    { NULL, "want", "compute" },
    { NULL, "climate", "environment" },
    { NULL, "look", "appearance" },
    { NULL, "sweep", "solve_order" },
    // generated strands
    { "generate", "thickness", "diameter" },
    // frozen hair
    { NULL, "event", "update_on" },
    { NULL, "bend_angle_max", "max_bend_angle" },
    { "clump", "step", "step_length" },
    { "clump", "guard", "min_distance_clamp" },
    { NULL, "distance_min", "min_distance" },
    { NULL, "lambda_min", "min_lambda" },
    { NULL, "neighbour_limit", "max_neighbours" },
    // environment
    { "environment", "temperature", "temperature_celsius" },
    { NULL, "freezing", "freezing_celsius" },
    // dynamics
    { NULL, "follow_share", "leader_correction" },
    { "dynamics", "bend", "bending" },
    { "dynamics", "drag", "drag_coefficient" },
    { NULL, "cell", "cell_size" },
    // cloth
    { "cloth", "damping", "internal_damping" },
    { "cloth", "drag", "drag_coefficient" },
    { "cloth", "lift", "lift_coefficient" },
    // balloon and its events
    { NULL, "cross_stiffness", "bend_link_stiffness" },
    { NULL, "stretch_share", "stretch_stiffness" },
    { NULL, "bend_share", "bend_stiffness" },
    { NULL, "volume_share", "volume_stiffness" },
    { NULL, "fill", "gas_ratio" },
    { NULL, "fill_keyframes", "gas_ratio_keyframes" },
    { NULL, "least_fill", "min_gas_ratio" },
    { "balloon", "drag", "drag_model" },
    { "events", "open", "outlet_open" },
    // implicit cloth
    { NULL, "stiffness", "stiffness_model" },
    { "implicit", "damping", "link_damping" },
    { NULL, "newton_repeats", "newton_iterations" },
    { NULL, "stiff_repeats", "max_newton_iterations" },
    { NULL, "look_ahead", "speculative" },
    // collision, contact and colliders
    { "collision", "friction", "friction_scale" },
    { "collision", "layers", "mask" },
    { NULL, "recovery_speed", "max_push_out_speed" },
    { NULL, "features", "primitives" },
    { NULL, "sample_spacing", "particle_spacing" },
    { "contact", "guard", "displacement_limit" },
    { NULL, "sheet", "double_sided" },
    // boundary particles
    { "boundary", "limit", "max_points" },
    { NULL, "least_spacing", "min_spacing" },
    { NULL, "most_spacing", "max_spacing" },
};
const int SCENE_RENAMED_KEY_COUNT = WISP_COUNT( SCENE_RENAMED_KEYS );

const scene_renamed SCENE_RENAMED_WORDS[] = {
    { "compute", "figures", "stats" },
    { "compute", "figures", "effect_stats" },
    { "compute", "quality", "motion_stats" },
    { "compute", "contacts", "collision_stats" },
    { "compute", "crossings", "intersections" },
    { "repair", "loose", "unreferenced" },
    { "require", "one_shell", "one_component" },
    { "gap", "prose", "absolute" },
    { "gap", "printed", "signed" },
    { "gap", "closing", "reversed" },
    { "gap", "wet", "none" },
    { "update_on", "command", "hair_event" },
    { "bending", "cross", "bend_links" },
    { "bending", "links", "bend_links" },
    { "rest", "balanced", "sag_free" },
    { "elastic", "printed_cos", "cosine" },
    { "elastic", "printed_raw", "dot" },
    { "spin", "kick", "velocity" },
    { "spin", "printed", "position" },
    { "stiffness_model", "sheet", "material" },
    { "primitives", "exact", "triangles" },
    { "primitives", "samples", "particles" },
};
const int SCENE_RENAMED_WORD_COUNT = WISP_COUNT( SCENE_RENAMED_WORDS );

// Compare the last key of a path, without its indices.
static bool ends_in_key( const char* path, const char* key )
{
    const char* dot = strrchr( path, '.' );
    const char* last = dot ? dot + 1 : path;
    const size_t length = strcspn( last, "[" );
    return strlen( key ) == length && memcmp( last, key, length ) == 0;
}

static bool is_known( const char* name, const char* const* known, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( known[i], name ) == 0 )
        {
            return true;
        }
    }
    return false;
}

static const char* find( const scene_renamed* rows, int row_count, const char* path, const char* old,
                         const char* const* known, int count )
{
    for ( int i = 0; i < row_count; ++i )
    {
        const scene_renamed* row = &rows[i];
        if ( strcmp( row->old, old ) == 0 && ( !row->where || ends_in_key( path, row->where ) ) &&
             is_known( row->now, known, count ) )
        {
            return row->now;
        }
    }
    return NULL;
}

const char* scene_find_renamed_key( const char* path, const char* old, const char* const* known, int count )
{
    return find( SCENE_RENAMED_KEYS, SCENE_RENAMED_KEY_COUNT, path, old, known, count );
}

const char* scene_find_renamed_word( const char* path, const char* old, const char* const* known, int count )
{
    return find( SCENE_RENAMED_WORDS, SCENE_RENAMED_WORD_COUNT, path, old, known, count );
}
