// Every file in tests/bad/scene is refused with exactly the sentence below: place, key and what is wrong. The folder
// is walked, so that a file dropped there without a sentence fails.
#define _XOPEN_SOURCE 700

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <dirent.h>

#include <cmocka.h>

#include "bad_scenes.h"
#include "scene.h"

#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

static const char FOLDER[] = WISP_SOURCE_ROOT "/tests/bad/scene";

// clang-format off
static const bad_scene BAD_SCENES[] = {
    { "alias.yaml",
      ":2:8: an alias (*); write the values out where they are used" },
    { "anchor.yaml",
      ":1:7: an anchor (&); write the values out where they are used" },
    { "angle_in_degrees.yaml",
      ":6:33: strands[0].frozen_hair.freeze.bend_angle_max: 45 is out of range, must be in [0, 3.14159265]" },
    { "bad_indent.yaml",
      ":4:10: not YAML: mapping values are not allowed in this context" },
    { "balloon_allow_open_count.yaml",
      ":6:28: surfaces[0].balloon.allow_open: must be true or false, not '1'" },
    { "balloon_celsius.yaml",
      ":6:29: surfaces[0].balloon.temperature: '20 C' has a unit; temperatures of a gas are plain numbers in kelvin" },
    { "balloon_fill_below_least.yaml",
      ":4:5: surfaces[0]: balloon.fill is 0.5, below balloon.least_fill, which is 1" },
    { "balloon_keyframe_below_least.yaml",
      ":4:5: surfaces[0]: balloon.fill_keyframes[1] is 0.9, below balloon.least_fill, which is 1" },
    { "balloon_keyframes_flat.yaml",
      ":6:33: surfaces[0].balloon.fill_keyframes[0]: must be a pair [time, fill]" },
    { "balloon_open_without_outlet.yaml",
      ":4:5: surfaces[0]: balloon.outlet_open is true, but the balloon has no outlet" },
    { "balloon_outlet_beyond.yaml",
      ":6:28: surfaces[0].balloon.outlet[1]: there is no vertex 42: 42 are made, counted from 0" },
    { "balloon_outlet_empty.yaml",
      ":6:24: surfaces[0].balloon.outlet: must have 1 to 64 vertices, not 0" },
    { "balloon_outlet_radius_alone.yaml",
      ":4:5: surfaces[0]: balloon.outlet_radius needs balloon.outlet_nearest" },
    { "balloon_outlet_twice_told.yaml",
      ":4:5: surfaces[0]: has both balloon.outlet and balloon.outlet_nearest" },
    { "base_sixty.yaml",
      ":2:8: steps: must be a whole number, not '1:30'" },
    { "below_absolute_zero.yaml",
      ":5:29: strands[0].climate.temperature: -300 is out of range, must be in [-273.15, 1000]" },
    { "bias_one.yaml",
      ":5:26: strands[0].look.colour_bias: 1 is out of range, must be in [0.001, 0.999]" },
    { "block_is_list.yaml",
      ":6:7: strands[0].frozen_hair: must be a mapping ({} takes the defaults), not a list" },
    { "block_is_true.yaml",
      ":6:15: strands[0].frozen_hair.freeze: must be a mapping ({} takes the defaults), not 'true'" },
    { "capital_key.yaml",
      ":6:16: strands[0].frozen_hair.clump: unknown key 'Radius', did you mean 'radius'?" },
    { "celsius.yaml",
      ":5:29: strands[0].climate.temperature: '-10C' has a unit; temperatures are plain numbers in degrees Celsius" },
    { "choice_far.yaml",
      ":6:23: strands[0].frozen_hair.align.blend: must be one of arc, chord, not 'quadratic'" },
    { "choice_near.yaml",
      ":6:21: strands[0].frozen_hair.clump.gap: must be one of prose, printed, closing, wet, not 'pose', did you mean 'prose'?" },
    { "choice_number.yaml",
      ":6:13: strands[0].frozen_hair.base: must be one of rest, previous, not '1'" },
    { "cloth_bending_unknown.yaml",
      ":6:23: surfaces[0].cloth.bending: must be one of cross, dihedral, isometric, none, not 'angle'" },
    { "cloth_level_passes_no_levels.yaml",
      ":4:5: surfaces[0]: cloth.level_passes needs levels, but 'levels' is 0" },
    { "cloth_tethers_no_pins.yaml",
      ":4:5: surfaces[0]: cloth.tethers reach to pins, but nothing is pinned" },
    { "cloth_warp_zero.yaml",
      ":4:5: surfaces[0]: cloth.warp has no direction" },
    { "collider_friction_three.yaml",
      ":4:45: colliders[0].friction: must be a number, or a pair [static, kinetic]" },
    { "collider_friction_turned.yaml",
      ":4:45: colliders[0].friction: kinetic friction 0.4 is above static friction 0.2" },
    { "collider_keyframe_position.yaml",
      ":4:46: colliders[0].keyframes[0]: key 'position' is missing" },
    { "collider_mesh_no_source.yaml",
      ":4:5: colliders[0]: has neither 'file' nor 'make'; a mesh is read or made" },
    { "collider_mesh_two_sources.yaml",
      ":4:5: colliders[0]: has both 'file' and 'make'; a mesh is read or made" },
    { "collider_plane_radius.yaml",
      ":4:35: colliders[0]: unknown key 'radius', known are name, shape, position, rotation, keyframes, friction, thickness, layers" },
    { "collider_radius_zero.yaml",
      ":4:42: colliders[0].radius: 0 is out of range, must be in [1e-06, 1000000]" },
    { "collider_same_name.yaml",
      ":5:5: colliders[1]: the name 'a' is taken by the collider in line 4" },
    { "collider_search_near.yaml",
      ":4:53: colliders[0].search: must be one of tree, voxels, not 'voxel', did you mean 'voxels'?" },
    { "collider_search_of_sphere.yaml",
      ":4:34: colliders[0]: unknown key 'search', known are name, shape, position, rotation, keyframes, friction, thickness, layers, radius" },
    { "collider_shape_missing.yaml",
      ":4:5: colliders[0]: key 'shape' is missing" },
    { "collider_shape_near.yaml",
      ":4:26: colliders[0].shape: must be one of plane, sphere, capsule, box, mesh, not 'shpere', did you mean 'sphere'?" },
    { "collider_voxel_size_of_tree.yaml",
      ":4:57: colliders[0]: 'voxel_size' is of a mesh with 'search: voxels'" },
    { "collider_voxel_size_unit.yaml",
      ":4:73: colliders[0].voxel_size: '2cm' has a unit; lengths are plain numbers in metres" },
    { "collider_voxel_size_zero.yaml",
      ":4:73: colliders[0].voxel_size: 0 is out of range, must be in [1e-06, 1000000]" },
    { "collision_layer.yaml",
      ":6:30: surfaces[0].collision.layers[1]: 32 is out of range, must be in [0, 31]" },
    { "collision_layer_twice.yaml",
      ":6:30: surfaces[0].collision.layers[1]: layer 1 is listed twice" },
    { "colour_bytes.yaml",
      ":5:27: strands[0].look.root_colour[0]: 255 is out of range, must be in [0, 1]" },
    { "comma.yaml",
      ":2:15: step_seconds: '0,02' has a comma; write a decimal point" },
    { "command_no_strands.yaml",
      ":3:25: commands[0].strands: there are no strands 'hair': the scene has none" },
    { "command_not_frozen.yaml",
      ":6:25: commands[0].strands: the strands 'hair' have no key 'frozen_hair', which alone takes commands" },
    { "command_too_late.yaml",
      ":9:5: commands[0]: step 3 never comes: the scene has 3, counted from 0" },
    { "command_twice.yaml",
      ":11:5: commands: strands 'hair' have a command for step 2 already, in line 9" },
    { "command_unknown_strands.yaml",
      ":8:25: commands[0].strands: there are no strands 'hiar', did you mean 'hair'?" },
    { "command_without_cursor.yaml",
      ":8:5: commands[0]: key 'cursor' is missing" },
    { "control_character.yaml",
      ":2:8: control character U+001B is not allowed in a scene" },
    { "cursor_far.yaml",
      ":6:28: strands[0].frozen_hair.align.cursor[1]: 1e7 is out of range, must be in [-1000000, 1000000]" },
    { "cursor_mapping.yaml",
      ":6:24: strands[0].frozen_hair.align.cursor: must be a list of three numbers, not a mapping" },
    { "cursor_two_numbers.yaml",
      ":6:24: strands[0].frozen_hair.align.cursor: must be a list of three numbers, not of 2" },
    { "curve_ends_early.yaml",
      ":5:33: strands[0].climate.curve[1]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_from_half.yaml",
      ":5:25: strands[0].climate.curve[0]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_ice_falls.yaml",
      ":5:43: strands[0].climate.curve[2]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_nine_points.yaml",
      ":5:23: strands[0].climate.curve: must have 2 to 8 points, not 9" },
    { "curve_one_point.yaml",
      ":5:23: strands[0].climate.curve: must have 2 to 8 points, not 1" },
    { "curve_returns.yaml",
      ":5:42: strands[0].climate.curve[2]: stiffness turns back; it must rise or fall throughout" },
    { "curve_triple.yaml",
      ":5:24: strands[0].climate.curve[0]: must be a pair [ice, stiffness]" },
    { "curve_turns_back.yaml",
      ":5:52: strands[0].climate.curve[3]: stiffness turns back; it must rise or fall throughout" },
    { "cut_utf8.yaml",
      ":1:11: byte 0xe2 is not UTF-8; save the file as UTF-8" },
    { "cycle.yaml",
      ":2:10: an anchor (&); write the values out where they are used" },
    { "degrees.yaml",
      ":6:33: strands[0].frozen_hair.freeze.bend_angle_max: '45°' has a unit; angles are plain numbers in radians" },
    { "density_grams.yaml",
      ":6:19: surfaces[0].area_density: '150 g/m^2' has a unit; area densities are plain numbers in kg/m^2" },
    { "dimension_four.yaml",
      ":3:38: strands[0].make.dimension: 4 is out of range, must be in [2, 3]" },
    { "directive.yaml",
      ":1:1: a YAML directive; a scene has no use for them" },
    { "duplicate_key.yaml",
      ":8:7: strands[0].frozen_hair: key 'seed' is written twice, first in line 6" },
    { "duplicate_strands.yaml",
      ":4:1: key 'strands' is written twice, first in line 2" },
    { "empty.yaml",
      ": the scene is empty; it needs at least the line 'wisp: 1'" },
    { "empty_block.yaml",
      ":6:14: strands[0].frozen_hair.freeze: must be a mapping ({} takes the defaults), but nothing is written here" },
    { "entry_is_text.yaml",
      ":2:11: strands[0]: must be a mapping ({} takes the defaults), not 'hair'" },
    { "escape_in_key.yaml",
      ":2:1: unknown key 'st?[31m?rands', known are wisp, step_seconds, steps, substeps, iterations, workers, gravity, contact, strands, surfaces, colliders, commands, script, output" },
    { "escape_in_value.yaml",
      ":6:21: strands[0].frozen_hair.clump.gap: must be one of prose, printed, closing, wet, not 'pr?ose', did you mean 'prose'?" },
    { "exponent_for_whole.yaml",
      ":2:8: steps: must be a whole number, not '1e3'" },
    { "file_and_make.yaml",
      ":3:5: strands[0]: has more than one of 'file', 'make', 'scatter' and 'curves'" },
    { "file_empty.yaml",
      ":3:25: strands[0].file: must be text, but nothing is written here" },
    { "file_nothing.yaml",
      ":3:25: strands[0].file: must be text, but nothing is written here" },
    { "fraction_of_step.yaml",
      ":2:8: steps: must be a whole number, not '2.5'" },
    { "gravity_number.yaml",
      ":3:10: gravity: must be a list of three numbers, not '-9.8'" },
    { "gravity_with_unit.yaml",
      ":3:14: gravity[1]: '-9.8 m/s^2' has a unit; accelerations are plain numbers in m/s^2" },
    { "hexadecimal.yaml",
      ":6:13: strands[0].frozen_hair.seed: must be a whole number in [0, 18446744073709551615], not '0x10'" },
    { "inf.yaml",
      ":5:29: strands[0].climate.temperature: '-.inf' is not a finite number" },
    { "instance_of_instance.yaml",
      ":6:33: surfaces[2].instance_of: 'twin' is an instance itself; name 'ball', whose fabric it has" },
    { "instance_of_itself.yaml",
      ":4:32: surfaces[0].instance_of: 'twin' is not above this entry in the list" },
    { "instance_of_strands.yaml",
      ":5:32: surfaces[0].instance_of: there is no surface 'hair': that is the strands in line 3" },
    { "instance_repaired.yaml",
      ":5:46: surfaces[1]: an instance has the fabric of its source, and no key 'repair' of its own" },
    { "instance_scaled.yaml",
      ":5:58: surfaces[1]: an instance has the size of its source" },
    { "instance_tethers_no_pins.yaml",
      ":5:29: surfaces[1].instance_of: cloth.tethers reach to the pins of 'a', which has none" },
    { "instance_unknown.yaml",
      ":5:32: surfaces[1].instance_of: there is no surface 'bal', did you mean 'ball'?" },
    { "intensity_two.yaml",
      ":6:27: strands[0].frozen_hair.align.intensity: 2 is out of range, must be in [0, 1]" },
    { "invalid_utf8.yaml",
      ":2:6: byte 0xe9 is not UTF-8; save the file as UTF-8" },
    { "iterations_huge.yaml",
      ":2:13: iterations: 99999999999999999999 is out of range, must be in [1, 10000]" },
    { "finest_level_zero.yaml", ":7:19: surfaces[0].finest_level: 0 is out of range, must be in [1, 12]" },
    { "finest_level_without_levels.yaml",
      ":4:5: surfaces[0]: 'finest_level' is where levels begin, but 'levels' is 0" },
    { "levels_unused.yaml",
      ":4:5: surfaces[0]: 'levels' is 3, but nothing uses them: cloth.level_passes is 0" },
    { "levels_without_cloth.yaml",
      ":4:5: surfaces[0]: 'levels' are used by cloth alone, and there is no key 'cloth'" },
    { "list_as_key.yaml",
      ":2:3: a list or mapping is not usable as a key" },
    { "list_empty.yaml",
      ":6:33: strands[0].frozen_hair.freeze.bend_stiffness: the list is empty; it takes one number a strand" },
    { "list_for_number.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: must be a number, not a list" },
    { "list_item_range.yaml",
      ":6:37: strands[0].frozen_hair.freeze.bend_stiffness[1]: 0 is out of range, must be in [0.001, 1e+12]" },
    { "list_item_text.yaml",
      ":6:31: strands[0].frozen_hair.align.intensity[1]: must be a number, not text: write 1 without quotes" },
    { "list_too_long.yaml",
      ":6:27: strands[0].frozen_hair.align.intensity: the list has 4 numbers, but 3 strands are made" },
    { "list_too_short.yaml",
      ":6:36: strands[0].frozen_hair.freeze.stretch_stiffness: the list has 2 numbers, but 3 strands are made" },
    { "long_key.yaml",
      ":2:1: unknown key 'radiusradiusradiusradiusradiusradiusradiusra...', known are wisp, step_seconds, steps, substeps, iterations, workers, gravity, contact, strands, surfaces, colliders, commands, script, output" },
    { "long_number.yaml",
      ":2:8: steps: must be a whole number, not '11111111111111111111111111111111111111111111...'" },
    { "make_delaunay_few.yaml",
      ":4:55: surfaces[0].make.vertices: 3 is out of range, must be in [4, 16777216]" },
    { "make_delaunay_many.yaml",
      ":4:55: surfaces[0].make.vertices: 16777217 is out of range, must be in [4, 16777216]" },
    { "make_delaunay_seed.yaml",
      ":4:51: surfaces[0].make.seed: must be a whole number in [0, 18446744073709551615], not '-1'" },
    { "make_delaunay_slender.yaml",
      ":4:26: surfaces[0].make: depth 0.001 is not within a thousandth and a thousand times of width 2" },
    { "make_delaunay_spacing.yaml",
      ":4:45: surfaces[0].make: unknown key 'spacing', known are shape, width, depth, vertices, seed" },
    { "make_delaunay_width.yaml",
      ":4:52: surfaces[0].make.width: 0 is out of range, must be in [1e-06, 1000000]" },
    { "make_garment_few.yaml",
      ":4:54: surfaces[0].make.vertices: 63 is out of range, must be in [64, 16777216]" },
    { "make_garment_metres.yaml",
      ":4:51: surfaces[0].make.depth: '70cm' has a unit; lengths are plain numbers in metres" },
    { "make_is_text.yaml",
      ":4:26: surfaces[0].make: must be a mapping with the key 'shape', not 'plane'" },
    { "make_level_eleven.yaml",
      ":4:52: surfaces[0].make.level: 11 is out of range, must be in [0, 10]" },
    { "make_level_of_torus.yaml",
      ":4:41: surfaces[0].make: unknown key 'level', known are shape, segments, rings, radius, tube_radius" },
    { "make_plane_huge.yaml",
      ":4:26: surfaces[0].make: has 25000000 vertices, at most 16777216 are made" },
    { "make_shape_missing.yaml",
      ":4:26: surfaces[0].make: key 'shape' is missing" },
    { "make_shape_near.yaml",
      ":4:35: surfaces[0].make.shape: must be one of plane, alternating_plane, irregular_plane, delaunay, garment, icosphere, uv_sphere, torus, capsule, tube, pear, not 'icospere', did you mean 'icosphere'?" },
    { "make_torus_fat.yaml",
      ":4:25: surfaces[0].make: tube_radius 0.3 is not below radius 0.2" },
    { "make_vertices_few.yaml",
      ":4:26: surfaces[0].make: 30 vertices are not within half and twice of 10 columns times 10 rows" },
    { "merge_key.yaml",
      ":2:1: unknown key '<<', known are wisp, step_seconds, steps, substeps, iterations, workers, gravity, contact, strands, surfaces, colliders, commands, script, output" },
    { "millimetres.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: '10 mm' has a unit; lengths are plain numbers in metres" },
    { "milliseconds.yaml",
      ":2:15: step_seconds: '16ms' has a unit; times are plain numbers in seconds" },
    { "name_empty.yaml",
      ":3:13: strands[0].name: must be text, but nothing is written here" },
    { "name_too_long.yaml",
      ":3:13: strands[0].name: 'hhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhh...' is not a name: 1 to 64 of the characters A-Z a-z 0-9 _ -" },
    { "name_with_space.yaml",
      ":3:13: strands[0].name: 'long hair' is not a name: 1 to 64 of the characters A-Z a-z 0-9 _ -" },
    { "nan.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: '.nan' is not a finite number" },
    { "negative_seed.yaml",
      ":6:13: strands[0].frozen_hair.seed: must be a whole number in [0, 18446744073709551615], not '-1'" },
    { "neighbour_limit.yaml",
      ":6:33: strands[0].frozen_hair.clump.neighbour_limit: 5000 is out of range, must be in [1, 4096]" },
    { "neither_file_nor_make.yaml",
      ":3:5: strands[0]: has none of 'file', 'make', 'scatter' and 'curves'; one tells where the strands come from" },
    { "newer_version.yaml",
      ":1:7: wisp: the scene has version 2, this program reads version 1" },
    { "no_name.yaml",
      ":3:5: strands[0]: key 'name' is missing" },
    { "no_version.yaml",
      ":1:1: key 'wisp' is missing" },
    { "nothing.yaml",
      ":2:1: must be a mapping with the key 'wisp', but nothing is written here" },
    { "nothing_for_number.yaml",
      ":6:25: strands[0].frozen_hair.clump.radius: must be a number, but nothing is written here" },
    { "nul_byte.yaml",
      ":2:8: a NUL byte; a scene is text" },
    { "nul_escape.yaml",
      ":3:11: the text holds a NUL character" },
    { "octal.yaml",
      ":6:13: strands[0].frozen_hair.seed: '010' begins with a zero, which means octal in YAML 1.1; write decimal digits" },
    { "one_vertex.yaml",
      ":3:37: strands[0].make.vertices: 1 is out of range, must be in [2, 134217728]" },
    { "only_comments.yaml",
      ": the scene is empty; it needs at least the line 'wisp: 1'" },
    { "output_extension.yaml",
      ":6:28: output[0].file: 'out.abc' must end in .hair, .usda or .obj, which tells the format" },
    { "output_no_extension.yaml",
      ":6:28: output[0].file: 'v1.0/hair' must end in .hair, .usda or .obj, which tells the format" },
    { "output_of_both.yaml",
      ":7:5: output[0]: has both 'strands' and 'surface'; a file holds one of them" },
    { "output_of_nothing.yaml",
      ":4:5: output[0]: has neither 'strands' nor 'surface'; one tells what is written" },
    { "output_only_extension.yaml",
      ":6:28: output[0].file: '.hair' must end in .hair, .usda or .obj, which tells the format" },
    { "output_same_file.yaml",
      ":7:5: output: the file 'out.obj' is written in line 6 already" },
    { "output_strands_is_surface.yaml",
      ":6:16: output[0].strands: there are no strands 'cloth': that is the surface in line 4" },
    { "output_surface_hair.yaml",
      ":6:29: output[0].file: 'cloth.hair' must end in .obj or .ply, which tells the format" },
    { "output_unknown_strands.yaml",
      ":6:16: output[0].strands: there are no strands 'beard'" },
    { "output_without_file.json",
      ":4:15: output[0]: key 'file' is missing" },
    { "overflow.yaml",
      ":6:23: strands[0].frozen_hair.align.reach: 1e999 is out of range, must be in [0, 10000000]" },
    { "overlong_utf8.yaml",
      ":1:11: byte 0xc0 is not UTF-8; save the file as UTF-8" },
    { "percent.yaml",
      ":6:27: strands[0].frozen_hair.align.intensity: '80%' has a unit; this is a plain number without one" },
    { "pin_beyond.yaml",
      ":6:15: surfaces[0].pins[1]: there is no vertex 16: 16 are made, counted from 0" },
    { "pin_box_turned.yaml",
      ":6:14: surfaces[0].pin_box: a corner of 'min' is above that of 'max', so the box is empty" },
    { "pin_box_without_max.yaml",
      ":6:51: surfaces[0].pin_box[1]: key 'max' is missing" },
    { "pin_keyframe_without_time.yaml",
      ":7:21: surfaces[0].pin_keyframes[0]: key 'time' is missing" },
    { "pin_keyframes_no_pins.yaml",
      ":4:5: surfaces[0]: 'pin_keyframes' moves pins, but nothing is pinned" },
    { "pin_keyframes_time_falls.yaml",
      ":9:9: surfaces[0].pin_keyframes[1]: time 1 does not come after the one before, 1" },
    { "pin_nearest_flat.yaml",
      ":6:19: surfaces[0].pin_nearest[0]: must be a list of three numbers, not '0'" },
    { "pin_negative.yaml",
      ":6:12: surfaces[0].pins[0]: -1 is out of range, must be in [0, 16777215]" },
    { "plain_nan.yaml",
      ":6:28: strands[0].frozen_hair.align.cursor[1]: 'NaN' is not a finite number" },
    { "quoted_number.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: must be a number, not text: write 0.01 without quotes" },
    { "quoted_true.yaml",
      ":6:23: strands[0].frozen_hair.clump.guard: must be true or false, not the text 'true'" },
    { "radius_underflow.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: 1e-60 is out of range, must be in [1e-06, 1000000]" },
    { "radius_zero.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: 0 is out of range, must be in [1e-06, 1000000]" },
    { "repair_twice.yaml",
      ":6:21: surfaces[0].repair[1]: 'loose' is listed twice" },
    { "repair_unknown.yaml",
      ":6:14: surfaces[0].repair[0]: must be one of degenerates, duplicates, winding, loose, not 'holes'" },
    { "require_unknown.yaml",
      ":6:15: surfaces[0].require[0]: must be one of closed, oriented, manifold, clean, one_shell, not 'close', did you mean 'closed'?" },
    { "rotate_axis_and_angles.yaml",
      ":6:26: surfaces[0].transform.rotate: has an axis and three angles; an axis takes one angle" },
    { "rotate_axis_zero.yaml",
      ":6:26: surfaces[0].transform.rotate: the axis has no direction" },
    { "rotate_in_radians.yaml",
      ":6:45: surfaces[0].transform.rotate: unknown key 'radians', known are axis, degrees" },
    { "rotate_number.yaml",
      ":6:26: surfaces[0].transform.rotate: must be a mapping ({} takes the defaults), not '90'" },
    { "rotate_without_axis.yaml",
      ":6:26: surfaces[0].transform.rotate: one angle needs the key 'axis'" },
    { "same_name.yaml",
      ":6:5: strands[2]: the name 'hair' is taken by the strands in line 3" },
    { "script_does_nothing.yaml",
      ":7:5: script[0]: does nothing: it has none of fill, inflation_rate, open, wind, velocity, angular_velocity and release: true" },
    { "script_fill_below_least.yaml",
      ":7:5: script[0]: fill 0.5 is below the least of 'ball', which is 0.8" },
    { "script_fill_of_cloth.yaml",
      ":7:5: script[0]: 'fill' is a balloon's, but the surface 'cloth' has no key 'balloon'" },
    { "script_fill_under_keyframes.yaml",
      ":6:5: script[0]: the fill of 'ball' follows its fill_keyframes until 0.5 s" },
    { "script_no_time.yaml",
      ":7:5: script[0]: has neither 'step' nor 'time'; one tells when it happens" },
    { "script_open_without_outlet.yaml",
      ":7:5: script[0]: the balloon 'ball' has no outlet to open or close" },
    { "script_release_no_pins.yaml",
      ":7:5: script[0]: the surface 'ball' has no pins to release" },
    { "script_step_and_time.yaml",
      ":7:5: script[0]: has both 'step' and 'time'" },
    { "script_surface_missing.yaml",
      ":7:5: script[0]: has neither 'strands' nor 'surface'; one tells what it is for" },
    { "script_too_late.yaml",
      ":7:5: script[0]: step 60 never comes: the scene has 60, counted from 0" },
    { "script_twice.yaml",
      ":8:5: script: the surface 'cloth' has an entry for step 6 already, in line 7" },
    { "script_unknown_surface.yaml",
      ":7:25: script[0].surface: there is no surface 'clot', did you mean 'cloth'?" },
    { "script_wind_without_air.yaml",
      ":7:5: script[0]: wind needs air: the surface 'cloth' has no cloth.drag and no cloth.lift" },
    { "second_document.yaml",
      ":2:1: a second document; a scene file holds one" },
    { "seed_too_large.yaml",
      ":6:13: strands[0].frozen_hair.seed: must be a whole number in [0, 18446744073709551615], not '18446744073709551616'" },
    { "shape_unknown.yaml",
      ":3:34: strands[0].make.shape: must be one of straight, wavy, curly, not 'curley', did you mean 'curly'?" },
    { "step_negative.yaml",
      ":6:22: strands[0].frozen_hair.clump.step: -1 is out of range, must be in [0, 1000]" },
    { "step_zero.yaml",
      ":2:15: step_seconds: 0 is out of range, must be in [1e-09, 1000000]" },
    { "steps_negative.yaml",
      ":2:8: steps: -1 is out of range, must be in [0, 1000000]" },
    { "steps_too_many.yaml",
      ":2:8: steps: 1000001 is out of range, must be in [0, 1000000]" },
    { "stiffness_negative.yaml",
      ":6:36: strands[0].frozen_hair.freeze.stretch_stiffness: -7 is out of range, must be in [0.001, 1e+12]" },
    { "strain_limit_below_one.yaml",
      ":6:25: surfaces[0].strain_limit: 0.95 is out of range, must be in [1, 1000000]" },
    { "strain_limit_number.yaml",
      ":6:19: surfaces[0].strain_limit: must be a pair [least, most] of shares of the rest length" },
    { "strands_mapping.yaml",
      ":2:10: strands: must be a list of strands, not a mapping" },
    { "strands_nothing.yaml",
      ":2:9: strands: must be a list of strands, but nothing is written here" },
    { "substeps_zero.yaml",
      ":2:11: substeps: 0 is out of range, must be in [1, 10000]" },
    { "surface_cloth_and_balloon.yaml",
      ":4:5: surfaces[0]: has both 'cloth' and 'balloon'; a surface is one or the other" },
    { "surface_name_of_strands.yaml",
      ":5:5: surfaces[0]: the name 'hair' is taken by the strands in line 3" },
    { "surface_no_source.yaml",
      ":4:5: surfaces[0]: has none of 'file', 'make' and 'instance_of'; one tells where the mesh comes from" },
    { "surface_two_sources.yaml",
      ":4:5: surfaces[0]: has more than one of 'file', 'make' and 'instance_of'" },
    { "surface_unknown_key.yaml",
      ":6:5: surfaces[0]: unknown key 'gravitation', known are name, file, make, instance_of, repair, require, transform, area_density, vertex_mass, pins, pin_box, pin_nearest, pin_keyframes, pin_pivot, velocity, angular_velocity, gravity, damping, strain_limit, cloth, balloon, implicit, levels, finest_level, sweep, tile_size, collision, contact, boundary, want" },
    { "surface_unknown_key_far.yaml",
      ":6:5: surfaces[0]: unknown key 'colour', known are name, file, make, instance_of, repair, require, transform, area_density, vertex_mass, pins, pin_box, pin_nearest, pin_keyframes, pin_pivot, velocity, angular_velocity, gravity, damping, strain_limit, cloth, balloon, implicit, levels, finest_level, sweep, tile_size, collision, contact, boundary, want" },
    { "surfaces_mapping.yaml",
      ":3:11: surfaces: must be a list of surfaces, not a mapping" },
    { "surfaces_too_many_vertices.yaml",
      ":4:3: surfaces: the surfaces have 32000000 vertices, at most 16777216" },
    { "surrogate.yaml",
      ":2:3: byte 0xed is not UTF-8; save the file as UTF-8" },
    { "sweep_near.yaml",
      ":6:12: surfaces[0].sweep: must be one of colour, list, not 'color', did you mean 'colour'?" },
    { "tab_after_spaces.yaml",
      ":4:3: a tab where YAML wants spaces; indent with spaces" },
    { "tab_indent.yaml",
      ":3:1: a tab where YAML wants spaces; indent with spaces" },
    { "tag.yaml",
      ":1:7: a YAML tag; a scene has no use for them" },
    { "tag_bang.yaml",
      ":2:8: a YAML tag; a scene has no use for them" },
    { "tag_list.yaml",
      ":2:10: a YAML tag; a scene has no use for them" },
    { "tile_size_odd.yaml",
      ":6:16: surfaces[0].tile_size: 100 is not a tile size: 0, or a multiple of 8 in [64, 65536]" },
    { "too_deep.yaml",
      ":2:41: lists and mappings are nested more than 32 deep" },
    { "too_many_made.yaml",
      ":3:25: strands[0].make: 1000000 strands of 1000 vertices are more than 134217728 vertices" },
    { "top_is_list.yaml",
      ":1:1: must be a mapping with the key 'wisp', not a list" },
    { "top_is_text.yaml",
      ":1:1: must be a mapping with the key 'wisp', not 'wisp'" },
    { "trailing_text.json",
      ":1:15: not YAML: did not find expected <document start>" },
    { "transform_scale_zero.yaml",
      ":6:25: surfaces[0].transform.scale: 0 is out of range, must be in [1e-06, 1000000]" },
    { "truncated.json",
      ":1:40: not YAML: while scanning a quoted scalar, found unexpected end of stream" },
    { "unclosed_brace.yaml",
      ":2:35: not YAML: while parsing a flow mapping, did not find expected ',' or '}'" },
    { "unclosed_quote.yaml",
      ":4:1: not YAML: while scanning a quoted scalar, found unexpected end of stream" },
    { "underscore.yaml",
      ":2:8: steps: must be a whole number, not '1_000'" },
    { "unknown_key.yaml",
      ":6:16: strands[0].frozen_hair.clump: unknown key 'raduis', did you mean 'radius'?" },
    { "unknown_key_far.yaml",
      ":6:16: strands[0].frozen_hair.clump: unknown key 'mass', known are radius, iterations, step, gap, gap_reference, guard, distance_min, lambda_min, neighbour_limit" },
    { "unknown_top_key.yaml",
      ":2:1: unknown key 'strand', did you mean 'strands'?" },
    { "utf16.yaml",
      ":1:1: byte 0xff is not UTF-8; save the file as UTF-8" },
    { "version_half.yaml",
      ":1:7: wisp: must be a whole number, not '1.5'" },
    { "version_text.yaml",
      ":1:7: wisp: must be a whole number, not text: write 1 without quotes" },
    { "want_contacts_without_collision.yaml",
      ":6:12: surfaces[0].want[0]: 'contacts' come from a collision, but this surface has no key 'collision'" },
    { "want_figures_of_cloth.yaml",
      ":6:20: surfaces[0].want[1]: 'figures' need the key 'balloon' or 'implicit', but this surface has none of them" },
    { "want_text.yaml",
      ":5:11: strands[0].want: must be a list of words, not 'points'" },
    { "want_twice.yaml",
      ":5:20: strands[0].want[1]: 'points' is listed twice" },
    { "want_unknown.yaml",
      ":5:12: strands[0].want[0]: must be one of points, width, colour, strain, speed, quality, contacts, not 'point', did you mean 'points'?" },
    { "want_without_look.yaml",
      ":5:20: strands[0].want[1]: 'width' comes from a look, but these strands have no key 'look'" },
    { "wetness_percent.yaml",
      ":5:25: strands[0].climate.wetness: 70 is out of range, must be in [0, 1]" },
    { "word_for_number.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: must be a number, not 'wide'" },
    { "workers_many.yaml",
      ":2:10: workers: 65 is out of range, must be in [0, 64]" },
    { "yes_for_true.yaml",
      ":6:23: strands[0].frozen_hair.clump.guard: must be true or false, not 'yes'" },
};
// clang-format on

static int scene_count( void )
{
    return WISP_COUNT( BAD_SCENES ) + BAD_SCENES_MOTION_COUNT + BAD_SCENES_IMPLICIT_COUNT + BAD_SCENES_CONTACT_COUNT;
}

static const bad_scene* scene_at( int i )
{
    const int motion = i - WISP_COUNT( BAD_SCENES ), implicit = motion - BAD_SCENES_MOTION_COUNT;
    const int contact = implicit - BAD_SCENES_IMPLICIT_COUNT;
    return motion < 0     ? &BAD_SCENES[i]
           : implicit < 0 ? &BAD_SCENES_MOTION[motion]
           : contact < 0  ? &BAD_SCENES_IMPLICIT[implicit]
                          : &BAD_SCENES_CONTACT[contact];
}

static const bad_scene* find( const char* file )
{
    for ( int i = 0; i < scene_count(); ++i )
    {
        if ( strcmp( scene_at( i )->file, file ) == 0 )
        {
            return scene_at( i );
        }
    }
    return NULL;
}

static void path_in_folder( char* path, size_t room, const char* file )
{
    int length = snprintf( path, room, "%s/%s", FOLDER, file );
    assert_true( length > 0 && (size_t)length < room );
}

static void every_bad_file_is_refused_with_its_place_its_key_and_what_is_wrong( void** state )
{
    (void)state;
    for ( int i = 0; i < scene_count(); ++i )
    {
        const bad_scene* bad = scene_at( i );
        char path[1024];
        path_in_folder( path, sizeof path, bad->file );
        wisp_scene scene;
        wisp_error error = { .status = WISP_OK };
        wisp_status status = wisp_scene_read( path, &scene, &error );

        if ( status != WISP_BAD_INPUT || error.status != WISP_BAD_INPUT )
        {
            wisp_scene_release( &scene );
            fail_msg( "%s: status is \"%s\": %s", bad->file, wisp_status_name( status ), error.sentence );
        }
        // The folder before the name differs from machine to machine.
        const char* name = strstr( error.sentence, bad->file );
        assert_non_null( name );
        assert_string_equal( name + strlen( bad->file ), bad->sentence );
        assert_null( scene.strands );
        assert_null( scene.blocks );
    }
}

static void every_file_of_the_folder_has_its_sentence( void** state )
{
    (void)state;
    DIR* walk = opendir( FOLDER );
    assert_non_null( walk );
    int files = 0;
    for ( struct dirent* entry = readdir( walk ); entry; entry = readdir( walk ) )
    {
        if ( entry->d_name[0] == '.' )
        {
            continue;
        }
        ++files;
        if ( !find( entry->d_name ) )
        {
            print_error( "%s has no sentence in the table\n", entry->d_name );
        }
        assert_non_null( find( entry->d_name ) );
    }
    closedir( walk );
    assert_int_equal( files, scene_count() );
}

static void a_refusal_without_an_error_to_fill_still_has_its_status( void** state )
{
    (void)state;
    char path[1024];
    path_in_folder( path, sizeof path, BAD_SCENES[0].file );
    wisp_scene scene;
    assert_int_equal( wisp_scene_read( path, &scene, NULL ), WISP_BAD_INPUT );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_bad_file_is_refused_with_its_place_its_key_and_what_is_wrong ),
        cmocka_unit_test( every_file_of_the_folder_has_its_sentence ),
        cmocka_unit_test( a_refusal_without_an_error_to_fill_still_has_its_status ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
