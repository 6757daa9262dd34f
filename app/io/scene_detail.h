/// The block that tells at which level of detail an entry runs.
#pragma once

#include "scene_parts.h"
#include "scene_ranges.h"

/// Names of the levels.
extern const scene_choice SCENE_DETAIL_LEVELS[];

/// The fields of a block over an entry that has `detail`.
#define SCENE_DETAIL_FIELDS( entry )                                                                                 \
    { "level", SCENE_CHOICE, .at = offsetof( entry, detail.level ), .choices = SCENE_DETAIL_LEVELS,                  \
      .help = "Level from the start; an event can change it." },                                                     \
        { "substep_divisor", SCENE_WHOLE, .at = offsetof( entry, detail.substep_divisor ),                           \
          .range = RANGE( 1, 1000 ),                                                                                 \
          .help = "At `fewer_substeps` and `coarse`, the entry makes its substeps divided by this, rounded up." },   \
    {                                                                                                                \
        "blend_steps", SCENE_WHOLE, .at = offsetof( entry, detail.blend_steps ), .range = RANGE( 0, 10000 ),         \
                                    .help = "Steps over which a change of the level is blended."                     \
    }

/// Refuse a level that the entry has nothing for. @param node of the key
wisp_status scene_check_surface_detail( scene_reader* r, const scene_node* node, const wisp_scene_surface* s,
                                        wisp_detail level );
wisp_status scene_check_strands_detail( scene_reader* r, const scene_node* node, const wisp_scene_strands* s,
                                        wisp_detail level );
