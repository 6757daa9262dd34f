// Every file in tests/bad/scene is rejected with exactly the message below: position, key and error. The test walks
// the folder, so a file in it without a message fails.
#define _XOPEN_SOURCE 700

#include "unit.h"

#include "bad_scenes.h"
#include "scene.h"

#include <dirent.h>

static const char FOLDER[] = WISP_SOURCE_ROOT "/tests/bad/scene";

// clang-format off
static const bad_scene BAD_SCENES[] = {
    { "alias.yaml", ":2:8: YAML aliases (*) are not supported; repeat the value" },
    { "anchor.yaml", ":1:7: YAML anchors (&) are not supported; repeat the value" },
    { "angle_in_degrees.yaml",
      ":6:33: strands[0].frozen_hair.freeze.max_bend_angle: got 45, expected a value in [0, 3.14159265]" },
    { "bad_indent.yaml", ":4:14: not YAML: mapping values are not allowed in this context" },
    { "balloon_allow_open_count.yaml", ":6:28: surfaces[0].balloon.allow_open: got '1', expected true or false" },
    { "balloon_celsius.yaml",
      ":6:29: surfaces[0].balloon.temperature: got '20 C', expected a number in K without its unit" },
    { "balloon_gas_ratio_low.yaml",
      ":4:5: surfaces[0]: got balloon.gas_ratio 0.5, expected at least balloon.min_gas_ratio, 1" },
    { "balloon_keyframe_low.yaml",
      ":4:5: surfaces[0]: got 0.9 in balloon.gas_ratio_keyframes[1], expected at least balloon.min_gas_ratio, 1" },
    { "balloon_keyframes_flat.yaml",
      ":6:38: surfaces[0].balloon.gas_ratio_keyframes[0]: got '0', expected a pair [time, gas_ratio]" },
    { "balloon_open_without_outlet.yaml",
      ":4:5: surfaces[0]: balloon.outlet_open is true, but the balloon has no outlet" },
    { "balloon_outlet_beyond.yaml", ":6:28: surfaces[0].balloon.outlet[1]: got vertex 42, expected 0 .. 41" },
    { "balloon_outlet_empty.yaml", ":6:24: surfaces[0].balloon.outlet: got 0 vertices, expected 1 to 64" },
    { "balloon_outlet_radius_alone.yaml", ":4:5: surfaces[0]: balloon.outlet_radius needs balloon.outlet_nearest" },
    { "balloon_outlet_twice_told.yaml",
      ":4:5: surfaces[0]: got both balloon.outlet and balloon.outlet_nearest, expected one of them" },
    { "base_sixty.yaml", ":2:8: steps: got '1:30', expected a whole number" },
    { "below_absolute_zero.yaml",
      ":5:41: strands[0].environment.temperature_celsius: got -300, expected a value in [-273.15, 1000]" },
    { "bias_one.yaml", ":5:32: strands[0].appearance.colour_bias: got 1, expected a value in [0.001, 0.999]" },
    { "block_is_list.yaml", ":6:7: strands[0].frozen_hair: got a list, expected a mapping ({} takes the defaults)" },
    { "block_is_true.yaml",
      ":6:15: strands[0].frozen_hair.freeze: got 'true', expected a mapping ({} takes the defaults)" },
    { "capital_key.yaml", ":6:16: strands[0].frozen_hair.clump: unknown key 'Radius', did you mean 'radius'?" },
    { "celsius.yaml",
      ":5:41: strands[0].environment.temperature_celsius: got '-10C', expected a number in degrees Celsius without its unit" },
    { "choice_far.yaml", ":6:26: strands[0].frozen_hair.align.reach_by: got 'quadratic', expected one of tip, nearest" },
    { "choice_near.yaml",
      ":6:21: strands[0].frozen_hair.clump.gap: got 'absolut', expected one of absolute, none; did you mean 'absolute'?" },
    { "choice_number.yaml", ":6:13: strands[0].frozen_hair.base: got '1', expected one of rest, stroke" },
    { "cloth_bending_unknown.yaml",
      ":6:23: surfaces[0].cloth.bending: got 'angle', expected one of bend_links, dihedral, isometric, none" },
    { "cloth_coarse_passes_zero.yaml", ":6:49: surfaces[0].cloth.coarse_passes: got 0, expected a value in [1, 64]" },
    { "cloth_coarse_pbd.yaml",
      ":4:5: surfaces[0]: cloth.coarse_substeps needs the solver xpbd, but 'solver' is pbd" },
    { "cloth_coarse_substeps_65.yaml",
      ":6:31: surfaces[0].cloth.coarse_substeps: got 65, expected a value in [0, 64]" },
    { "cloth_coarse_substeps_minus.yaml",
      ":6:31: surfaces[0].cloth.coarse_substeps: got -1, expected a value in [0, 64]" },
    { "cloth_tethers_no_pins.yaml", ":4:5: surfaces[0]: cloth.tethers needs pins, but nothing is pinned" },
    { "cloth_warp_zero.yaml", ":4:5: surfaces[0]: cloth.warp is zero" },
    { "collider_friction_three.yaml",
      ":4:45: colliders[0].friction: got a list of 3, expected a number, or a pair [static, kinetic]" },
    { "collider_friction_turned.yaml",
      ":4:45: colliders[0].friction: got kinetic friction 0.4, expected at most static friction, 0.2" },
    { "collider_keyframe_position.yaml", ":4:46: colliders[0].keyframes[0]: key 'position' is missing" },
    { "collider_mesh_no_source.yaml", ":4:5: colliders[0]: got neither 'file' nor 'generate', expected one of them" },
    { "collider_mesh_two_sources.yaml", ":4:5: colliders[0]: got both 'file' and 'generate', expected one of them" },
    { "collider_plane_radius.yaml",
      ":4:35: colliders[0]: unknown key 'radius', expected one of name, shape, position, rotation, keyframes, friction, thickness, restitution, layers, compute" },
    { "collider_restitution_above_one.yaml", ":4:43: colliders[0].restitution: got 1.5, expected a value in [0, 1]" },
    { "collider_heights_ragged.yaml",
      ":4:55: colliders[0].heights[1]: got a row of 1 heights, expected 2 as in the first row" },
    { "collider_heights_one_row.yaml",
      ":4:46: colliders[0].heights: got 1 rows of 2 heights, expected 2 to 8192 of each" },
    { "collider_convex_no_source.yaml", ":4:5: colliders[0]: got neither 'file' nor 'generate', expected one of them" },
    { "collider_radius_zero.yaml", ":4:42: colliders[0].radius: got 0, expected a value in [1e-06, 1000000]" },
    { "collider_same_name.yaml", ":5:5: colliders[1]: the name 'a' is taken by the collider in line 4" },
    { "collider_shape_missing.yaml", ":4:5: colliders[0]: key 'shape' is missing" },
    { "collider_shape_near.yaml",
      ":4:26: colliders[0].shape: got 'shpere', expected one of plane, sphere, capsule, box, mesh, tapered_capsule, convex, height_field; did you mean 'sphere'?" },
    { "collision_features_near.yaml",
      ":6:28: surfaces[0].collision.features: got 'every', expected one of vertices, all" },
    { "collision_features_of_strands.yaml",
      ":7:18: strands[0].collision: unknown key 'features', expected one of thickness, friction_scale, max_push_out_speed, mask" },
    { "collision_layer.yaml", ":6:28: surfaces[0].collision.mask[1]: got 32, expected a value in [0, 31]" },
    { "collision_layer_twice.yaml", ":6:28: surfaces[0].collision.mask[1]: layer 1 is listed twice" },
    { "colour_bytes.yaml", ":5:33: strands[0].appearance.root_colour[0]: got 255, expected a value in [0, 1]" },
    { "comma.yaml", ":2:5: dt: got '0,02', expected a decimal point instead of the comma" },
    { "compute_collision_stats_without_collision.yaml",
      ":6:15: surfaces[0].compute[0]: 'collision_stats' needs the key 'collision'" },
    { "compute_effect_stats_of_cloth.yaml",
      ":6:23: surfaces[0].compute[1]: 'effect_stats' needs the key 'balloon' or 'implicit'" },
    { "compute_text.yaml", ":5:14: strands[0].compute: got 'points', expected a list of words" },
    { "compute_twice.yaml", ":5:23: strands[0].compute[1]: 'points' is listed twice" },
    { "compute_unknown.yaml",
      ":5:15: strands[0].compute[0]: got 'point', expected one of points, width, colour, strain, speed, motion_stats, collision_stats; did you mean 'points'?" },
    { "compute_without_appearance.yaml", ":5:23: strands[0].compute[1]: 'width' needs the key 'appearance'" },
    { "control_character.yaml", ":2:8: got control character U+001B, expected text" },
    { "cursor_far.yaml",
      ":6:28: strands[0].frozen_hair.align.cursor[1]: got 1e7, expected a value in [-1000000, 1000000]" },
    { "cursor_mapping.yaml",
      ":6:24: strands[0].frozen_hair.align.cursor: got a mapping, expected a list of three numbers" },
    { "cursor_two_numbers.yaml",
      ":6:24: strands[0].frozen_hair.align.cursor: got a list of 2, expected a list of three numbers" },
    { "curve_ends_early.yaml",
      ":5:37: strands[0].environment.curve[1]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_from_half.yaml",
      ":5:29: strands[0].environment.curve[0]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_ice_falls.yaml",
      ":5:47: strands[0].environment.curve[2]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_nine_points.yaml", ":5:27: strands[0].environment.curve: got 9 points, expected 2 to 8" },
    { "curve_one_point.yaml", ":5:27: strands[0].environment.curve: got 1 points, expected 2 to 8" },
    { "curve_returns.yaml", ":5:46: strands[0].environment.curve[2]: stiffness must rise or fall throughout" },
    { "curve_triple.yaml",
      ":5:28: strands[0].environment.curve[0]: got a list of 3, expected a pair [ice, stiffness]" },
    { "curve_turns_back.yaml", ":5:56: strands[0].environment.curve[3]: stiffness must rise or fall throughout" },
    { "cut_utf8.yaml", ":1:11: got byte 0xe2, expected UTF-8" },
    { "cycle.yaml", ":2:10: YAML anchors (&) are not supported; repeat the value" },
    { "degrees.yaml",
      ":6:33: strands[0].frozen_hair.freeze.max_bend_angle: got '45°', expected a number in rad without its unit" },
    { "density_grams.yaml",
      ":6:19: surfaces[0].area_density: got '150 g/m^2', expected a number in kg/m^2 without its unit" },
    { "detail_coarse_without_ghosts.yaml",
      ":7:22: strands[0]: 'coarse' needs ghosts, but the strands 'hair' have no key 'ghosts'" },
    { "detail_coarse_without_sheets.yaml",
      ":7:22: surfaces[0]: 'coarse' needs coarse sheets, but the surface 'sheet' has no cloth.coarse_substeps" },
    { "detail_divisor.yaml",
      ":6:32: surfaces[0].detail.substep_divisor: got 0, expected a value in [1, 1000]" },
    { "detail_unknown.yaml",
      ":6:15: surfaces[0].detail: unknown key 'frames', expected one of level, substep_divisor, blend_steps" },
    { "detail_unknown_level.yaml",
      ":6:22: surfaces[0].detail.level: got 'course', expected one of full, fewer_substeps, coarse, nothing; did you mean 'coarse'?" },
    { "detail_without_dynamics.yaml",
      ":6:13: strands[0]: 'detail' needs the key 'dynamics' or 'ghosts'" },
    { "dimension_four.yaml", ":3:42: strands[0].generate.dimension: got 4, expected a value in [2, 3]" },
    { "directive.yaml", ":1:1: YAML directives are not supported" },
    { "dt_factors_empty.yaml", ":2:13: dt_factors: got an empty list, expected numbers" },
    { "dt_factors_zero.yaml", ":2:17: dt_factors[1]: got 0, expected a value in [0.001, 1000]" },
    { "duplicate_key.yaml", ":8:7: strands[0].frozen_hair: key 'seed' is written twice, first in line 6" },
    { "duplicate_strands.yaml", ":4:1: key 'strands' is written twice, first in line 2" },
    { "empty.yaml", ": got an empty file, expected at least the line 'wisp: 1'" },
    { "empty_block.yaml",
      ":6:14: strands[0].frozen_hair.freeze: got nothing, expected a mapping ({} takes the defaults)" },
    { "entry_is_text.yaml", ":2:11: strands[0]: got 'hair', expected a mapping ({} takes the defaults)" },
    { "escape_in_key.yaml",
      ":2:1: unknown key 'st?[31m?rands'; the nearest are strands, dt_factors, steps, iterations; wisp info --keys lists all 17" },
    { "escape_in_value.yaml",
      ":6:21: strands[0].frozen_hair.clump.gap: got 'abs?olute', expected one of absolute, none; did you mean 'absolute'?" },
    { "event_detail_coarse.yaml",
      ":8:40: events[0]: 'coarse' needs coarse sheets, but the surface 'sheet' has no cloth.coarse_substeps" },
    { "event_detail_still.yaml",
      ":7:39: events[0]: 'detail' needs the key 'dynamics' or 'ghosts'" },
    { "event_detail_unknown.yaml",
      ":8:40: events[0].detail: got 'low', expected one of full, fewer_substeps, coarse, nothing" },
    { "events_does_nothing.yaml",
      ":7:5: events[0]: got no change, expected one of gas_ratio, inflation_rate, outlet_open, wind, velocity, angular_velocity, gust, teleport, detail, attach_pins, and hold, release and detach_pins: true" },
    { "events_gas_ratio_low.yaml",
      ":7:5: events[0]: got gas_ratio 0.5, expected at least min_gas_ratio of 'ball', 0.8" },
    { "events_gas_ratio_of_cloth.yaml",
      ":7:5: events[0]: 'gas_ratio' needs a balloon, but the surface 'cloth' has no key 'balloon'" },
    { "events_gas_ratio_under_keyframes.yaml",
      ":6:5: events[0]: the gas ratio of 'ball' follows its gas_ratio_keyframes until 0.5 s" },
    { "events_gust_per_triangle_alone.yaml", ":7:5: events[0]: 'gust_per_triangle' needs the key 'gust'" },
    { "events_gust_too_fast.yaml", ":7:41: events[0].gust[1]: got 1e6, expected a value in [-500000, 500000]" },
    { "events_no_time.yaml", ":7:5: events[0]: got neither 'step' nor 'time', expected one of them" },
    { "events_open_without_outlet.yaml", ":7:5: events[0]: the balloon 'ball' has no outlet to open or close" },
    { "events_release_no_pins.yaml", ":7:5: events[0]: the surface 'ball' has no pins to release" },
    { "events_step_and_time.yaml", ":7:5: events[0]: got both 'step' and 'time', expected one of them" },
    { "events_surface_missing.yaml", ":7:5: events[0]: got neither 'strands' nor 'surface', expected one of them" },
    { "events_teleport_of_pins.yaml",
      ":8:5: events[0]: the pins of 'a' have pin_keyframes: a keyframe with 'jump: true' teleports it" },
    { "events_too_late.yaml", ":7:5: events[0]: got step 60, expected a step below 60, the number of steps" },
    { "events_twice.yaml", ":8:5: events: got a second entry of surface 'cloth' for step 6, the first is in line 7" },
    { "events_unknown_surface.yaml", ":7:25: events[0].surface: there is no surface 'clot', did you mean 'cloth'?" },
    { "events_wind_without_air.yaml",
      ":7:5: events[0]: 'wind' needs drag or lift, but the surface 'cloth' has no cloth.drag_coefficient and no cloth.lift_coefficient" },
    { "exponent_for_whole.yaml", ":2:8: steps: got '1e3', expected a whole number" },
    { "file_and_generate.yaml",
      ":3:5: strands[0]: got more than one of 'file', 'generate', 'scatter' and 'curves', expected one of them" },
    { "file_empty.yaml", ":3:25: strands[0].file: got nothing, expected text" },
    { "file_nothing.yaml", ":3:25: strands[0].file: got nothing, expected text" },
    { "fraction_of_step.yaml", ":2:8: steps: got '2.5', expected a whole number" },
    { "generate_delaunay_few.yaml",
      ":4:59: surfaces[0].generate.vertices: got 3, expected a value in [4, 16777216]" },
    { "generate_delaunay_many.yaml",
      ":4:59: surfaces[0].generate.vertices: got 16777217, expected a value in [4, 16777216]" },
    { "generate_delaunay_seed.yaml",
      ":4:55: surfaces[0].generate.seed: got '-1', expected a whole number in [0, 18446744073709551615]" },
    { "generate_delaunay_slender.yaml",
      ":4:30: surfaces[0].generate: got depth 0.001, expected a thousandth to a thousand times width, 2" },
    { "generate_delaunay_spacing.yaml",
      ":4:49: surfaces[0].generate: unknown key 'spacing', expected one of shape, width, depth, vertices, seed" },
    { "generate_delaunay_width.yaml",
      ":4:56: surfaces[0].generate.width: got 0, expected a value in [1e-06, 1000000]" },
    { "generate_figure.yaml",
      ":4:24: surfaces[0].generate.shape: 'figure' is gone; use `file: figure.glb` of the folder data, which has its clips too" },
    { "generate_garment_few.yaml",
      ":4:58: surfaces[0].generate.vertices: got 63, expected a value in [64, 16777216]" },
    { "generate_garment_metres.yaml",
      ":4:55: surfaces[0].generate.depth: got '70cm', expected a number in m without its unit" },
    { "generate_is_text.yaml", ":4:30: surfaces[0].generate: got 'plane', expected a mapping with the key 'shape'" },
    { "generate_level_eleven.yaml", ":4:56: surfaces[0].generate.level: got 11, expected a value in [0, 10]" },
    { "generate_level_of_torus.yaml",
      ":4:45: surfaces[0].generate: unknown key 'level', expected one of shape, segments, rings, radius, tube_radius" },
    { "generate_plane_huge.yaml", ":4:30: surfaces[0].generate: got 25000000 vertices, expected at most 16777216" },
    { "generate_shape_missing.yaml", ":4:30: surfaces[0].generate: key 'shape' is missing" },
    { "generate_shape_near.yaml",
      ":4:39: surfaces[0].generate.shape: got 'icospere', expected one of plane, alternating_plane, irregular_plane, delaunay, garment, icosphere, uv_sphere, torus, capsule, tube, pear; did you mean 'icosphere'?" },
    { "generate_torus_fat.yaml", ":4:29: surfaces[0].generate: got tube_radius 0.3, expected less than radius, 0.2" },
    { "generate_vertices_few.yaml",
      ":4:30: surfaces[0].generate: got 30 vertices, expected half to twice of 10 columns times 10 rows" },
    { "gone_key.yaml",
      ":6:16: strands[0].frozen_hair.align: 'blend' is gone; leave it out: vertices turn along an arc, which keeps distances to the root" },
    { "gone_word.yaml",
      ":6:21: strands[0].frozen_hair.clump.gap: 'signed' is gone; use `gap: absolute`, where a large change brakes" },
    { "gravity_number.yaml", ":3:10: gravity: got '-9.8', expected a list of three numbers" },
    { "gravity_with_unit.yaml", ":3:14: gravity[1]: got '-9.8 m/s^2', expected a number in m/s^2 without its unit" },
    { "hair_event_begins_no_stroke.yaml",
      ":7:5: hair_events[0]: 'begin_stroke' needs strands with 'base: stroke', 'hair' have none" },
    { "hair_event_changes_nothing.yaml",
      ":7:5: hair_events[0]: got no change, expected one of cursor, begin_stroke: true, intensity, reach, stretch_stiffness, bend_stiffness and clump_radius" },
    { "hair_event_no_strands.yaml",
      ":3:25: hair_events[0].strands: there are no strands 'hair': the scene has none" },
    { "hair_event_not_frozen.yaml",
      ":6:25: hair_events[0].strands: got 'hair', expected strands with the key 'frozen_hair'" },
    { "hair_event_radius_without_clump.yaml",
      ":7:5: hair_events[0]: 'clump_radius' needs a stage that the strands 'hair' lack, frozen_hair.clump" },
    { "hair_event_reach_negative.yaml",
      ":7:57: hair_events[0].reach: got -1, expected a value in [0, 10000000]" },
    { "hair_event_stiffness_of_climate.yaml",
      ":8:5: hair_events[0]: the stiffness of the strands 'hair' comes from their environment" },
    { "hair_event_too_late.yaml", ":9:5: hair_events[0]: got step 3, expected a step below 3, the number of steps" },
    { "hair_event_twice.yaml",
      ":11:5: hair_events: got a second entry of strands 'hair' for step 2, the first is in line 9" },
    { "hair_event_unknown_strands.yaml",
      ":8:25: hair_events[0].strands: there are no strands 'hiar', did you mean 'hair'?" },
    { "hair_event_without_cursor.yaml", ":8:5: hair_events[0]: key 'cursor' is missing" },
    { "hexadecimal.yaml",
      ":6:13: strands[0].frozen_hair.seed: got '0x10', expected a whole number in [0, 18446744073709551615]" },
    { "inf.yaml", ":5:41: strands[0].environment.temperature_celsius: got '-.inf', expected a finite number" },
    { "instance_of_instance.yaml",
      ":6:33: surfaces[2].instance_of: got 'twin', which is an instance, expected 'ball'" },
    { "instance_of_itself.yaml", ":4:32: surfaces[0].instance_of: got 'twin', expected an entry above this one" },
    { "instance_of_strands.yaml",
      ":5:32: surfaces[0].instance_of: there is no surface 'hair': that is the strands in line 3" },
    { "instance_repaired.yaml", ":5:46: surfaces[1]: 'repair' is not possible with 'instance_of'" },
    { "instance_scaled.yaml", ":5:58: surfaces[1]: 'scale' is not possible with 'instance_of'" },
    { "instance_tethers_no_pins.yaml", ":5:29: surfaces[1].instance_of: cloth.tethers needs pins, but 'a' has none" },
    { "instance_unknown.yaml", ":5:32: surfaces[1].instance_of: there is no surface 'bal', did you mean 'ball'?" },
    { "intensity_two.yaml", ":6:27: strands[0].frozen_hair.align.intensity: got 2, expected a value in [0, 1]" },
    { "invalid_utf8.yaml", ":2:6: got byte 0xe9, expected UTF-8" },
    { "iterations_huge.yaml", ":2:13: iterations: got 99999999999999999999, expected a value in [1, 10000]" },
    { "list_as_key.yaml", ":2:3: got a list or mapping, expected a key" },
    { "list_empty.yaml",
      ":6:33: strands[0].frozen_hair.freeze.bend_stiffness: got an empty list, expected one number per strand" },
    { "list_for_number.yaml", ":6:24: strands[0].frozen_hair.clump.radius: got a list, expected a number" },
    { "list_item_range.yaml",
      ":6:37: strands[0].frozen_hair.freeze.bend_stiffness[1]: got 0, expected a value in [0.001, 1e+12]" },
    { "list_item_text.yaml",
      ":6:31: strands[0].frozen_hair.align.intensity[1]: got the text '1', expected a number; write it without quotes" },
    { "list_too_long.yaml",
      ":6:27: strands[0].frozen_hair.align.intensity: got 4 numbers, expected 3, one per strand" },
    { "list_too_short.yaml",
      ":6:36: strands[0].frozen_hair.freeze.stretch_stiffness: got 2 numbers, expected 3, one per strand" },
    { "long_key.yaml",
      ":2:1: unknown key 'radiusradiusradiusradiusradiusradiusradiusra...'; wisp info --keys lists all 17" },
    { "long_number.yaml",
      ":2:8: steps: got '11111111111111111111111111111111111111111111...', expected a whole number" },
    { "max_depth_change.yaml",
      ":6:25: strands[0].frozen_hair.max_depth_change: got -0.001, expected a value in [0, 1000000]" },
    { "max_neighbours.yaml",
      ":6:32: strands[0].frozen_hair.clump.max_neighbours: got 5000, expected a value in [1, 4096]" },
    { "merge_key.yaml",
      ":2:1: unknown key '<<'; the nearest are dt, wisp, steps, seams; wisp info --keys lists all 17" },
    { "millimetres.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: got '10 mm', expected a number in m without its unit" },
    { "milliseconds.yaml", ":2:5: dt: got '16ms', expected a number in s without its unit" },
    { "name_empty.yaml", ":3:13: strands[0].name: got nothing, expected text" },
    { "name_too_long.yaml",
      ":3:13: strands[0].name: got 'hhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhh...', expected 1 to 64 of the characters A-Z a-z 0-9 _ -" },
    { "name_with_space.yaml",
      ":3:13: strands[0].name: got 'long hair', expected 1 to 64 of the characters A-Z a-z 0-9 _ -" },
    { "nan.yaml", ":6:24: strands[0].frozen_hair.clump.radius: got '.nan', expected a finite number" },
    { "negative_seed.yaml",
      ":6:13: strands[0].frozen_hair.seed: got '-1', expected a whole number in [0, 18446744073709551615]" },
    { "neither_file_nor_generate.yaml",
      ":3:5: strands[0]: got none of 'file', 'generate', 'scatter' and 'curves', expected one of them" },
    { "newer_version.yaml", ":1:7: wisp: got version 2, expected version 1" },
    { "no_name.yaml", ":3:5: strands[0]: key 'name' is missing" },
    { "no_version.yaml", ":1:1: key 'wisp' is missing" },
    { "nothing.yaml", ":2:1: got nothing, expected a mapping with the key 'wisp'" },
    { "nothing_for_number.yaml", ":6:25: strands[0].frozen_hair.clump.radius: got nothing, expected a number" },
    { "nul_byte.yaml", ":2:8: got a NUL byte, expected text" },
    { "nul_escape.yaml", ":3:11: got a NUL character, expected text" },
    { "octal.yaml",
      ":6:13: strands[0].frozen_hair.seed: got '010', which is octal in YAML 1.1, expected no leading zero" },
    { "one_vertex.yaml", ":3:41: strands[0].generate.vertices: got 1, expected a value in [2, 134217728]" },
    { "only_comments.yaml", ": got an empty file, expected at least the line 'wisp: 1'" },
    { "output_extension.yaml",
      ":6:28: output[0].file: got 'out.abc', expected a file that ends in .hair, .usda or .obj" },
    { "output_no_extension.yaml",
      ":6:28: output[0].file: got 'v1.0/hair', expected a file that ends in .hair, .usda or .obj" },
    { "output_of_both.yaml", ":7:5: output[0]: got both 'strands' and 'surface', expected one of them" },
    { "output_of_nothing.yaml", ":4:5: output[0]: got neither 'strands' nor 'surface', expected one of them" },
    { "output_only_extension.yaml",
      ":6:28: output[0].file: got '.hair', expected a file that ends in .hair, .usda or .obj" },
    { "output_same_file.yaml", ":7:5: output: the file 'out.obj' is written in line 6 already" },
    { "output_strands_is_surface.yaml",
      ":6:16: output[0].strands: there are no strands 'cloth': that is the surface in line 4" },
    { "output_surface_hair.yaml",
      ":6:29: output[0].file: got 'cloth.hair', expected a file that ends in .obj or .ply" },
    { "output_unknown_strands.yaml", ":6:16: output[0].strands: there are no strands 'beard'" },
    { "output_without_file.json", ":4:15: output[0]: key 'file' is missing" },
    { "overflow.yaml", ":6:23: strands[0].frozen_hair.align.reach: got 1e999, expected a value in [0, 10000000]" },
    { "overlong_utf8.yaml", ":1:11: got byte 0xc0, expected UTF-8" },
    { "percent.yaml", ":6:27: strands[0].frozen_hair.align.intensity: got '80%', expected a number without a unit" },
    { "pin_beyond.yaml", ":6:15: surfaces[0].pins[1]: got vertex 16, expected 0 .. 15" },
    { "pin_box_turned.yaml", ":6:14: surfaces[0].pin_box: got an empty box, expected 'min' below 'max'" },
    { "pin_box_without_max.yaml", ":6:51: surfaces[0].pin_box[1]: key 'max' is missing" },
    { "pin_keyframe_without_time.yaml", ":7:21: surfaces[0].pin_keyframes[0]: key 'time' is missing" },
    { "seam_neither.yaml", ":6:5: seams[0]: got neither 'pairs' nor 'within', expected one of them" },
    { "seam_both.yaml", ":6:5: seams[0]: got both 'pairs' and 'within', expected one of them" },
    { "seam_empty_pairs.yaml", ":6:5: seams[0]: got neither 'pairs' nor 'within', expected one of them" },
    { "seam_no_surfaces.yaml", ":6:5: seams[0]: key 'surfaces' is missing" },
    { "seam_one_surface.yaml", ":6:26: seams[0].surfaces: got a list of 1, expected a pair of names of surfaces" },
    { "seam_unknown_surface.yaml", ":6:30: seams[0].surfaces[1]: there is no surface 'c'" },
    { "seam_of_a_seam.yaml", ":7:30: seams[1].surfaces[1]: there is no surface 's'" },
    { "seam_vertex_beyond.yaml", ":6:54: seams[0].pairs[1][1]: got vertex 9 of 'b', expected 0 .. 8" },
    { "seam_vertex_negative.yaml", ":6:43: seams[0].pairs[0][0]: got -1, expected a value in [0, 16777215]" },
    { "seam_vertex_twice.yaml", ":6:50: seams[0].pairs[1]: got vertex 1 twice" },
    { "seam_pair_of_three.yaml", ":6:42: seams[0].pairs[0]: got a list of 3, expected a pair of vertices" },
    { "seam_within_itself.yaml", ":6:42: seams[0]: 'within' needs two surfaces, a surface that is sewn to itself needs 'pairs'" },
    { "seam_strength_zero.yaml", ":6:55: seams[0].strength: got 0, expected a value in [1e-09, 1e+12]" },
    { "seam_distance_negative.yaml", ":6:55: seams[0].distance: got -1, expected a value in [0, 1000000]" },
    { "seam_name_taken.yaml", ":6:5: seams[0]: the name 'a' is taken by the surface in line 3" },
    { "motion_constraints_jump.yaml", ":6:25: surfaces[0]: 'jump' in keyframe 0: only keyframes of pins, colliders and heads can jump" },
    { "motion_constraints_without_limit.yaml", ":5:25: surfaces[0]: 'motion_constraints' needs 'max_distance' or 'backstop'" },
    { "motion_constraints_radius_alone.yaml", ":5:63: surfaces[0]: 'backstop_radius' needs 'backstop'" },
    { "map_of_one_value.yaml", ":5:19: surfaces[0].area_density: got 1 for both 'from' (default 0) and 'to' (default 1), so the map says nothing" },
    { "events_hold_held.yaml", ":9:5: events: 'hold' changes nothing: its pins of 'a' are held before step 1" },
    { "events_detach_unattached.yaml", ":8:5: events: 'detach_pins' changes nothing: its pins of 'a' are not attached before step 1" },
    { "frame_and_implicit.yaml", ":7:12: surfaces[0]: 'frame' is not possible with 'implicit'" },
    { "membrane_links.yaml", ":5:15: surfaces[0]: 'membrane' needs cloth.bending dihedral, isometric or none, got links" },
    { "membrane_coarse.yaml", ":5:15: surfaces[0]: 'membrane' is not possible with coarse sheets: set cloth.coarse_substeps to 0" },
    { "membrane_compliance.yaml", ":6:46: surfaces[0]: 'warp_compliance' is of links, and a membrane has none" },
    { "membrane_edge_stiffness.yaml", ":6:32: surfaces[0]: 'edge_stiffness' is of links, and a membrane has none" },
    { "membrane_implicit.yaml", ":5:15: surfaces[0]: 'membrane' is not possible with 'implicit'" },
    { "membrane_thickness_zero.yaml", ":5:28: surfaces[0].membrane.thickness: got 0, expected a value in [1e-09, 1]" },
    { "tearing_without_cloth.yaml", ":5:14: surfaces[0]: 'tearing' needs the key 'cloth'" },
    { "tearing_pbd.yaml", ":6:14: surfaces[0]: 'tearing' needs the solver xpbd, but 'solver' of 'cloth' is pbd" },
    { "tearing_coarse.yaml", ":6:14: surfaces[0]: 'tearing' is not possible with coarse sheets: set cloth.coarse_substeps to 0" },
    { "tearing_tethers.yaml", ":7:14: surfaces[0]: 'tearing' is not possible with cloth.tethers" },
    { "tearing_held.yaml", ":7:14: surfaces[0]: 'tearing' is not possible with 'motion_constraints'" },
    { "tearing_layer.yaml", ":7:14: surfaces[0]: 'tearing' is not possible with 'boundary'" },
    { "tearing_collider.yaml", ":7:14: surfaces[0]: 'tearing' is not possible with 'collider'" },
    { "tearing_vertex_mass.yaml", ":7:14: surfaces[0]: 'tearing' needs 'area_density', but the surface has 'vertex_mass'" },
    { "tearing_mass_ratio.yaml", ":7:14: surfaces[0]: 'tearing' is not possible with 'mass_ratio'" },
    { "tearing_no_strength.yaml", ":6:14: surfaces[0].tearing: key 'strength' is missing" },
    { "tearing_strength_zero.yaml", ":6:26: surfaces[0].tearing.strength: got 0, expected a value in [1e-06, 1e+12]" },
    { "tearing_splits_zero.yaml", ":6:41: surfaces[0].tearing.max_splits: got 0, expected a value in [1, 1000000]" },
    { "pin_keyframes_no_pins.yaml", ":4:5: surfaces[0]: 'pin_keyframes' moves pins, but nothing is pinned" },
    { "pin_keyframes_time_falls.yaml",
      ":9:9: surfaces[0].pin_keyframes[1]: got time 1, expected more than the time before, 1" },
    { "pin_nearest_flat.yaml", ":6:19: surfaces[0].pin_nearest[0]: got '0', expected a list of three numbers" },
    { "pin_negative.yaml", ":6:12: surfaces[0].pins[0]: got -1, expected a value in [0, 16777215]" },
    { "plain_nan.yaml", ":6:28: strands[0].frozen_hair.align.cursor[1]: got 'NaN', expected a finite number" },
    { "quoted_number.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: got the text '0.01', expected a number; write it without quotes" },
    { "quoted_true.yaml",
      ":5:11: strands[0].show: got the text 'true', expected true or false" },
    { "radius_underflow.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: got 1e-60, expected a value in [1e-06, 1000000]" },
    { "radius_zero.yaml", ":6:24: strands[0].frozen_hair.clump.radius: got 0, expected a value in [1e-06, 1000000]" },
    { "repair_twice.yaml", ":6:28: surfaces[0].repair[1]: 'unreferenced' is listed twice" },
    { "repair_unknown.yaml",
      ":6:14: surfaces[0].repair[0]: got 'holes', expected one of weld, degenerates, duplicates, winding, flip, unreferenced" },
    { "require_unknown.yaml",
      ":6:15: surfaces[0].require[0]: got 'close', expected one of closed, oriented, manifold, clean, one_component; did you mean 'closed'?" },
    { "rotate_axis_and_angles.yaml",
      ":6:26: surfaces[0].transform.rotate: got an axis and three angles, expected one angle" },
    { "rotate_axis_zero.yaml", ":6:26: surfaces[0].transform.rotate: the axis is zero" },
    { "rotate_in_radians.yaml",
      ":6:45: surfaces[0].transform.rotate: unknown key 'radians', expected one of axis, degrees" },
    { "rotate_number.yaml",
      ":6:26: surfaces[0].transform.rotate: got '90', expected a mapping ({} takes the defaults)" },
    { "rotate_without_axis.yaml", ":6:26: surfaces[0].transform.rotate: one angle needs the key 'axis'" },
    { "same_name.yaml", ":6:5: strands[2]: the name 'hair' is taken by the strands in line 3" },
    { "second_document.yaml", ":2:1: got a second document, expected one" },
    { "seed_too_large.yaml",
      ":6:13: strands[0].frozen_hair.seed: got '18446744073709551616', expected a whole number in [0, 18446744073709551615]" },
    { "shape_unknown.yaml",
      ":3:38: strands[0].generate.shape: got 'curley', expected one of straight, wavy, curly, ring; did you mean 'curly'?" },
    { "sleep_negative.yaml", ":6:25: surfaces[0].sleep.max_speed: got -0.1, expected a value in [0, 1000000]" },
    { "sleep_unknown.yaml",
      ":6:14: surfaces[0].sleep: unknown key 'after', expected one of max_speed, seconds, enabled" },
    { "sleep_without_dynamics.yaml", ":6:12: strands[0]: 'sleep' needs the key 'dynamics'" },
    { "solve_order_near.yaml",
      ":6:18: surfaces[0].solve_order: got 'color', expected one of colour, list; did you mean 'colour'?" },
    { "step_negative.yaml",
      ":6:29: strands[0].frozen_hair.clump.step_length: got -1, expected a value in [0, 1000]" },
    { "step_zero.yaml", ":2:5: dt: got 0, expected a value in [1e-09, 1000000]" },
    { "steps_negative.yaml", ":2:8: steps: got -1, expected a value in [0, 1000000]" },
    { "steps_too_many.yaml", ":2:8: steps: got 1000001, expected a value in [0, 1000000]" },
    { "stiffness_negative.yaml",
      ":6:36: strands[0].frozen_hair.freeze.stretch_stiffness: got -7, expected a value in [0.001, 1e+12]" },
    { "strain_limit_below_one.yaml", ":6:25: surfaces[0].strain_limit: got 0.95, expected a value in [1, 1000000]" },
    { "strain_limit_number.yaml",
      ":6:19: surfaces[0].strain_limit: got '1.1', expected a pair [min, max] in rest lengths" },
    { "strands_mapping.yaml", ":2:10: strands: got a mapping, expected a list of strands" },
    { "strands_nothing.yaml", ":2:9: strands: got nothing, expected a list of strands" },
    { "stroke_with_cursor.yaml",
      ":5:18: strands[0]: 'align.cursor' is not possible with 'base: stroke', where only hair events turn strands" },
    { "substeps_zero.yaml", ":2:11: substeps: got 0, expected a value in [1, 10000]" },
    { "surface_cloth_and_balloon.yaml", ":4:5: surfaces[0]: got both 'cloth' and 'balloon', expected one of them" },
    { "surface_name_of_strands.yaml", ":5:5: surfaces[0]: the name 'hair' is taken by the strands in line 3" },
    { "surface_no_source.yaml",
      ":4:5: surfaces[0]: got none of 'file', 'generate' and 'instance_of', expected one of them" },
    { "surface_two_sources.yaml",
      ":4:5: surfaces[0]: got more than one of 'file', 'generate' and 'instance_of', expected one of them" },
    { "surface_unknown_key.yaml",
      ":6:5: surfaces[0]: unknown key 'gravitation'; the nearest are animation, gravity, mass_ratio, collision; wisp info --keys surfaces lists all 44" },
    { "surface_unknown_key_far.yaml",
      ":6:5: surfaces[0]: unknown key 'colour'; the nearest are cloth, copies, collider, compute; wisp info --keys surfaces lists all 44" },
    { "surfaces_mapping.yaml", ":3:11: surfaces: got a mapping, expected a list of surfaces" },
    { "surfaces_too_many_vertices.yaml",
      ":4:3: surfaces: got 32000000 vertices in all surfaces, expected at most 16777216" },
    { "surrogate.yaml", ":2:3: got byte 0xed, expected UTF-8" },
    { "tab_after_spaces.yaml", ":4:3: got a tab, expected spaces" },
    { "tab_indent.yaml", ":3:1: got a tab, expected spaces" },
    { "tag.yaml", ":1:7: YAML tags are not supported" },
    { "tag_bang.yaml", ":2:8: YAML tags are not supported" },
    { "tag_list.yaml", ":2:10: YAML tags are not supported" },
    { "tile_size_odd.yaml", ":6:16: surfaces[0].tile_size: got 100, expected 0, or a multiple of 8 in [64, 65536]" },
    { "too_deep.yaml", ":2:41: expected at most 32 levels of lists and mappings" },
    { "too_many_generated.yaml",
      ":3:29: strands[0].generate: got 1000000 strands of 1000 vertices, expected at most 134217728 vertices in all" },
    { "top_is_list.yaml", ":1:1: got a list, expected a mapping with the key 'wisp'" },
    { "top_is_text.yaml", ":1:1: got 'wisp', expected a mapping with the key 'wisp'" },
    { "trailing_text.json", ":1:15: not YAML: did not find expected <document start>" },
    { "transform_scale_zero.yaml",
      ":6:25: surfaces[0].transform.scale: got 0, expected a value in [1e-06, 1000000]" },
    { "truncated.json", ":1:40: not YAML: while scanning a quoted scalar, found unexpected end of stream" },
    { "unclosed_brace.yaml", ":2:39: not YAML: while parsing a flow mapping, did not find expected ',' or '}'" },
    { "unclosed_quote.yaml", ":4:1: not YAML: while scanning a quoted scalar, found unexpected end of stream" },
    { "underscore.yaml", ":2:8: steps: got '1_000', expected a whole number" },
    { "unknown_key.yaml", ":6:16: strands[0].frozen_hair.clump: unknown key 'raduis', did you mean 'radius'?" },
    { "unknown_key_far.yaml",
      ":6:16: strands[0].frozen_hair.clump: unknown key 'mass', expected one of radius, iterations, step_length, gap, min_distance, min_lambda, max_neighbours" },
    { "unknown_top_key.yaml", ":2:1: unknown key 'strand', did you mean 'strands'?" },
    { "utf16.yaml", ":1:1: got byte 0xff, expected UTF-8" },
    { "version_half.yaml", ":1:7: wisp: got '1.5', expected a whole number" },
    { "version_text.yaml", ":1:7: wisp: got the text '1', expected a whole number; write it without quotes" },
    { "wetness_percent.yaml", ":5:29: strands[0].environment.wetness: got 70, expected a value in [0, 1]" },
    { "word_for_number.yaml", ":6:24: strands[0].frozen_hair.clump.radius: got 'wide', expected a number" },
    { "workers_many.yaml", ":2:10: workers: got 65, expected a value in [0, 64]" },
    { "yes_for_true.yaml",
      ":5:11: strands[0].show: got 'yes', expected true or false" },
};
// clang-format on

static int scene_count( void )
{
    return WISP_COUNT( BAD_SCENES ) + BAD_SCENES_EFFECTS_COUNT + BAD_SCENES_IMPLICIT_COUNT;
}

static const bad_scene* scene_at( int i )
{
    const struct
    {
        const bad_scene* list;
        int count;
    } lists[] = {
        { BAD_SCENES, WISP_COUNT( BAD_SCENES ) },
        { BAD_SCENES_EFFECTS, BAD_SCENES_EFFECTS_COUNT },
        { BAD_SCENES_IMPLICIT, BAD_SCENES_IMPLICIT_COUNT },
    };
    int k = 0;
    for ( ; i >= lists[k].count; ++k )
    {
        i -= lists[k].count;
    }
    return &lists[k].list[i];
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

TEST( every_bad_file_is_refused_with_its_place_its_key_and_what_is_wrong )
{
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
            fail_msg( "%s: status is \"%s\": %s", bad->file, wisp_status_name( status ), error.message );
        }
        // The folder before the name differs from machine to machine.
        const char* name = strstr( error.message, bad->file );
        assert_non_null( name );
        // A message that is full ends within its list of keys, at a place that depends on the folder.
        const bool is_full = strlen( error.message ) == sizeof error.message - 1;
        const char* message = name + strlen( bad->file );
        if ( !is_full || strncmp( message, bad->message, strlen( message ) ) != 0 )
        {
            assert_string_equal( message, bad->message );
        }
        assert_null( scene.strands );
        assert_null( scene.blocks );
    }
}

TEST( every_file_of_the_folder_has_its_message )
{
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
            print_error( "%s has no message in the table\n", entry->d_name );
        }
        assert_non_null( find( entry->d_name ) );
    }
    closedir( walk );
    assert_int_equal( files, scene_count() );
}

TEST( a_refusal_without_an_error_to_fill_still_has_its_status )
{
    char path[1024];
    path_in_folder( path, sizeof path, BAD_SCENES[0].file );
    wisp_scene scene;
    assert_int_equal( wisp_scene_read( path, &scene, NULL ), WISP_BAD_INPUT );
}
