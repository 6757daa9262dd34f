// Messages for test_bad_scenes.c: meshes and maps of files, repairs, starts.
#include "bad_scenes.h"

// clang-format off
const bad_scene BAD_SCENES_FILES[] = {
    { "map_channel_of_text.yaml",
      ":5:43: surfaces[0].damping: 'channel' needs an image (.png) or 'map: colours'" },
    { "map_channel_unknown.yaml",
      ":5:39: surfaces[0].damping.channel: got 'alpha', expected one of mean, r, g, b" },
    { "map_colors.yaml",
      ":5:21: surfaces[0].damping.map: got 'colors', did you mean 'colours'?" },
    { "map_of_strand_contact.yaml",
      ":6:27: strands[0].contact.thickness: got a mapping, expected a number" },
    { "start_file_of_strands.yaml",
      ":6:14: strands[0].start: unknown key 'file', expected one of shape, scale, turns, shake, seed" },
    { "weld_distance_alone.yaml",
      ":7:20: surfaces[0]: 'weld_distance' needs 'repair: [weld]'" },
    { "weld_distance_of_collider.yaml",
      ":4:90: colliders[0]: 'weld_distance' needs 'repair: [weld]'" },
    { "weld_distance_of_instance.yaml",
      ":4:47: surfaces[1]: 'weld_distance' is not possible with 'instance_of'" },
    { "weld_distance_zero.yaml",
      ":7:20: surfaces[0].weld_distance: got 0, expected a value in [1e-06, 1000000]" },
};
// clang-format on
const int BAD_SCENES_FILES_COUNT = sizeof BAD_SCENES_FILES / sizeof BAD_SCENES_FILES[0];
