#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>

#define STIFFNESS RANGE( 1e-3, 1e12 )

// ---- generate ----

#define AT( member ) offsetof( wisp_groom_recipe, member )
#define SMALLEST 1e-6
#define FARTHEST ( (double)WISP_GROOM_FARTHEST )

static const char* const SHAPES[] = { "straight", "wavy", "curly", NULL };

static const scene_field MAKE_FIELDS[] = {
    { "shape", SCENE_CHOICE, .at = AT( shape ), .choices = SHAPES },
    { "dimension", SCENE_WHOLE, .at = AT( dimension ), .range = RANGE( 2, 3 ) },
    { "strands", SCENE_WHOLE, .at = AT( strand_count ), .range = RANGE( 1, WISP_GROOM_MADE_CAP / 2 ) },
    { "vertices", SCENE_WHOLE, .at = AT( vertices_per_strand ), .range = RANGE( 2, WISP_GROOM_MADE_CAP ) },
    { "length", SCENE_NUMBER, .at = AT( length ), .range = RANGE( SMALLEST, FARTHEST ), .unit = METRES },
    { "spacing", SCENE_NUMBER, .at = AT( spacing ), .range = RANGE( 0, FARTHEST ), .unit = METRES },
    { "scalp_radius", SCENE_NUMBER, .at = AT( scalp_radius ), .range = RANGE( SMALLEST, FARTHEST ), .unit = METRES },
    { "wave_amplitude", SCENE_NUMBER, .at = AT( wave_amplitude ), .range = RANGE( 0, FARTHEST ), .unit = METRES },
    { "wave_length", SCENE_NUMBER, .at = AT( wave_length ), .range = RANGE( SMALLEST, FARTHEST ), .unit = METRES },
    { "length_variation", SCENE_NUMBER, .at = AT( length_variation ), .range = RANGE( 0, 0.99 ) },
    { "diameter", SCENE_NUMBER, .at = AT( thickness ), .range = RANGE( 0, FARTHEST ), .unit = METRES },
    { "seed", SCENE_SEED, .at = AT( seed ) },
};
#undef AT

const scene_block SCENE_MAKE_BLOCK = { MAKE_FIELDS, WISP_COUNT( MAKE_FIELDS ) };

// ---- frozen_hair ----

#define AT( member ) offsetof( wisp_scene_strands, member )
#define HAIR( member ) offsetof( wisp_scene_strands, frozen_hair.member )

static const scene_field FREEZE_FIELDS[] = {
    { "stretch_stiffness", SCENE_NUMBERS, .at = HAIR( stretch_stiffness ), .range = STIFFNESS,
      .list = HAIR( strand_stretch_stiffness ), .list_count = AT( stretch_count ) },
    { "bend_stiffness", SCENE_NUMBERS, .at = HAIR( bend_stiffness ), .range = STIFFNESS,
      .list = HAIR( strand_bend_stiffness ), .list_count = AT( bend_count ) },
    { "max_bend_angle", SCENE_NUMBER, .at = HAIR( bend_angle_max ), .range = RANGE( 0, 3.14159265358979 ),
      .unit = RADIANS },
};
static const scene_block FREEZE_BLOCK = { FREEZE_FIELDS, WISP_COUNT( FREEZE_FIELDS ) };

static const char* const REACHES[] = { "tip", "nearest", NULL };
static const char* const BLENDS[] = { "arc", "chord", NULL };
static const char* const DIRECTIONS[] = { "mean", "root", NULL };

static const scene_field ALIGN_FIELDS[] = {
    { "intensity", SCENE_NUMBERS, .at = HAIR( intensity ), .range = UNIT_RANGE, .list = HAIR( strand_intensity ),
      .list_count = AT( intensity_count ) },
    { "cursor", SCENE_VECTOR, .at = HAIR( cursor ), .range = COORDINATE, .unit = METRES },
    { "reach", SCENE_NUMBER, .at = HAIR( reach ), .range = RANGE( 0, 1e7 ), .unit = METRES },
    { "reach_by", SCENE_EITHER, .at = HAIR( reach_nearest ), .choices = REACHES },
    { "blend", SCENE_EITHER, .at = HAIR( blend_chord ), .choices = BLENDS },
    { "direction", SCENE_EITHER, .at = HAIR( direction_from_root ), .choices = DIRECTIONS },
};
static const scene_block ALIGN_BLOCK = { ALIGN_FIELDS, WISP_COUNT( ALIGN_FIELDS ) };

static const char* const GAPS[] = { "absolute", "signed", "reversed", "none", NULL };
static const char* const GAP_REFERENCES[] = { "stage", "iteration", NULL };

static const scene_field CLUMP_FIELDS[] = {
    { "radius", SCENE_NUMBER, .at = HAIR( clump_radius ), .range = RANGE( SMALLEST, 1e6 ), .unit = METRES },
    { "iterations", SCENE_WHOLE, .at = HAIR( clump_iterations ), .range = RANGE( 0, 1000 ) },
    { "step_length", SCENE_NUMBER, .at = HAIR( clump_step ), .range = RANGE( 0, 1e3 ), .unit = METRES },
    { "gap", SCENE_CHOICE, .at = HAIR( gap ), .choices = GAPS },
    { "gap_reference", SCENE_EITHER, .at = HAIR( gap_by_iteration ), .choices = GAP_REFERENCES },
    { "min_distance_clamp", SCENE_SWITCH, .at = HAIR( guard ) },
    { "min_distance", SCENE_NUMBER, .at = HAIR( distance_min ), .range = RANGE( 0, 1e6 ), .unit = METRES },
    { "min_lambda", SCENE_NUMBER, .at = HAIR( lambda_min ), .range = UNIT_RANGE },
    { "max_neighbours", SCENE_WHOLE, .at = HAIR( neighbour_limit ), .range = RANGE( 1, 4096 ) },
};
static const scene_block CLUMP_BLOCK = { CLUMP_FIELDS, WISP_COUNT( CLUMP_FIELDS ) };

static const char* const BASES[] = { "rest", "previous", NULL };
static const char* const EVENTS[] = { "hair_event", "frame", NULL };

static const scene_field FROZEN_HAIR_FIELDS[] = {
    { "seed", SCENE_SEED, .at = HAIR( seed ) },
    { "base", SCENE_CHOICE, .at = HAIR( base ), .choices = BASES },
    { "update_on", SCENE_CHOICE, .at = HAIR( event ), .choices = EVENTS },
    { "epsilon", SCENE_NUMBER, .at = HAIR( epsilon ), .range = UNIT_RANGE },
    { "freeze", SCENE_BLOCK, .at = HAIR( freeze ), .block = &FREEZE_BLOCK },
    { "align", SCENE_BLOCK, .at = HAIR( align ), .block = &ALIGN_BLOCK },
    { "clump", SCENE_BLOCK, .at = HAIR( clump ), .block = &CLUMP_BLOCK },
};
static const scene_block FROZEN_HAIR_BLOCK = { FROZEN_HAIR_FIELDS, WISP_COUNT( FROZEN_HAIR_FIELDS ) };

// ---- environment and appearance ----

#define CLIMATE( member ) offsetof( wisp_scene_strands, climate.member )
#define LOOK( member ) offsetof( wisp_scene_strands, look.member )
#define TEMPERATURE RANGE( -273.15, 1000 )

static const scene_field CLIMATE_FIELDS[] = {
    { "temperature_celsius", SCENE_NUMBER, .at = CLIMATE( temperature ), .range = TEMPERATURE, .unit = CELSIUS },
    { "wetness", SCENE_NUMBER, .at = CLIMATE( wetness ), .range = UNIT_RANGE },
    { "freezing_celsius", SCENE_NUMBER, .at = CLIMATE( freezing ), .range = TEMPERATURE, .unit = CELSIUS },
    { "span", SCENE_NUMBER, .at = CLIMATE( span ), .range = RANGE( 1e-3, 1000 ), .unit = CELSIUS },
    { "curve", SCENE_CUSTOM, .read = scene_read_curve },
};
static const scene_block CLIMATE_BLOCK = { CLIMATE_FIELDS, WISP_COUNT( CLIMATE_FIELDS ) };

static const scene_field LOOK_FIELDS[] = {
    { "root_width", SCENE_NUMBER, .at = LOOK( root_width ), .range = UNIT_RANGE, .unit = METRES },
    { "tip_width", SCENE_NUMBER, .at = LOOK( tip_width ), .range = UNIT_RANGE, .unit = METRES },
    { "root_colour", SCENE_VECTOR, .at = LOOK( root_colour ), .range = UNIT_RANGE },
    { "tip_colour", SCENE_VECTOR, .at = LOOK( tip_colour ), .range = UNIT_RANGE },
    { "colour_bias", SCENE_NUMBER, .at = LOOK( colour_bias ), .range = RANGE( 0.001, 0.999 ) },
};
static const scene_block LOOK_BLOCK = { LOOK_FIELDS, WISP_COUNT( LOOK_FIELDS ) };

// ---- an entry of strands ----

static const scene_field TRANSFORM_FIELDS[] = {
    { "scale", SCENE_NUMBER, .at = AT( scale ), .range = SIZE },
    { "rotate", SCENE_CUSTOM, .at = AT( pose.rotation ), .read = scene_read_rotation },
    { "translate", SCENE_VECTOR, .at = AT( pose.translation ), .range = COORDINATE, .unit = METRES },
};
static const scene_block TRANSFORM_BLOCK = { TRANSFORM_FIELDS, WISP_COUNT( TRANSFORM_FIELDS ) };

// `generate` stands before what is numbered by its strands and vertices, and the effects before `compute`.
static const scene_field STRANDS_FIELDS[] = {
    { "name", SCENE_CUSTOM, .required = true, .at = AT( name ), .read = scene_read_name },
    { "file", SCENE_CUSTOM, .at = AT( file ), .read = scene_read_file },
    { "generate", SCENE_CUSTOM, .read = scene_read_make },
    { "scatter", SCENE_BLOCK, .at = AT( is_scattered ), .block = &SCENE_SCATTER_BLOCK },
    { "curves", SCENE_BLOCK, .at = AT( is_curves ), .block = &SCENE_CURVES_BLOCK },
    { "transform", SCENE_BLOCK, .block = &TRANSFORM_BLOCK },
    { "dynamics", SCENE_BLOCK, .at = AT( has_dynamics ), .block = &SCENE_DYNAMICS_BLOCK },
    { "head", SCENE_BLOCK, .at = AT( has_head ), .block = &SCENE_HEAD_BLOCK },
    { "on_surface", SCENE_CUSTOM, .read = scene_read_later_name },
    { "grid", SCENE_BLOCK, .at = AT( has_grid ), .block = &SCENE_GRID_BLOCK },
    { "collision", SCENE_BLOCK, .at = AT( has_collision ), .block = &SCENE_STRAND_COLLISION_BLOCK },
    { "contact", SCENE_BLOCK, .at = AT( has_contact ), .block = &SCENE_STRAND_CONTACT_BLOCK },
    { "ghosts", SCENE_BLOCK, .at = AT( has_ghosts ), .block = &SCENE_GHOSTS_BLOCK },
    { "frozen_hair", SCENE_BLOCK, .at = AT( has_frozen_hair ), .block = &FROZEN_HAIR_BLOCK },
    { "environment", SCENE_BLOCK, .at = AT( has_climate ), .block = &CLIMATE_BLOCK },
    { "appearance", SCENE_BLOCK, .at = AT( has_look ), .block = &LOOK_BLOCK },
    { "compute", SCENE_CUSTOM, .read = scene_read_want },
    { "show", SCENE_SWITCH, .at = AT( is_shown ), .given = AT( has_show ) },
};
#undef AT

const scene_block SCENE_STRANDS_BLOCK = { STRANDS_FIELDS, WISP_COUNT( STRANDS_FIELDS ) };

// ---- hair events, output, the scene ----

#define AT( member ) offsetof( wisp_scene_command, member )
static const scene_field COMMAND_FIELDS[] = {
    { "step", SCENE_WHOLE, .required = true, .at = AT( step ), .range = RANGE( 0, 999999 ) },
    { "strands", SCENE_CUSTOM, .required = true, .read = scene_read_command_strands },
    { "cursor", SCENE_VECTOR, .required = true, .at = AT( cursor ), .range = COORDINATE, .unit = METRES },
};
#undef AT
const scene_block SCENE_COMMAND_BLOCK = { COMMAND_FIELDS, WISP_COUNT( COMMAND_FIELDS ) };

static const scene_field OUTPUT_FIELDS[] = {
    { "strands", SCENE_CUSTOM, .read = scene_read_output_strands },
    { "surface", SCENE_CUSTOM, .read = scene_read_output_surface },
    { "file", SCENE_CUSTOM, .required = true, .read = scene_read_output_file },
};
const scene_block SCENE_OUTPUT_BLOCK = { OUTPUT_FIELDS, WISP_COUNT( OUTPUT_FIELDS ) };

// Hair events, events and output name the entries of the lists above them, and what they do must come before the last step.
// Surfaces and strands that move take the scene's gravity unless they have their own.
#define AT( member ) offsetof( wisp_scene, member )
static const scene_field SCENE_FIELDS[] = {
    { "wisp", SCENE_CUSTOM, .required = true, .read = scene_read_version },
    { "step_seconds", SCENE_NUMBER, .at = AT( step_seconds ), .range = RANGE( 1e-9, 1e6 ), .unit = SECONDS },
    { "steps", SCENE_WHOLE, .at = AT( steps ), .range = RANGE( 0, 1000000 ) },
    { "substeps", SCENE_WHOLE, .at = AT( substeps ), .range = RANGE( 1, 10000 ) },
    { "iterations", SCENE_WHOLE, .at = AT( iterations ), .range = RANGE( 1, 10000 ) },
    { "workers", SCENE_WHOLE, .at = AT( workers ), .range = RANGE( 0, WISP_MAX_WORKERS ) },
    { "gravity", SCENE_VECTOR, .at = AT( gravity ), .range = ACCELERATION, .unit = ACCELERATIONS },
    { "contact", SCENE_CUSTOM, .read = scene_read_contact },
    { "strands", SCENE_CUSTOM, .read = scene_read_strands },
    { "surfaces", SCENE_CUSTOM, .read = scene_read_surfaces },
    { "colliders", SCENE_CUSTOM, .read = scene_read_colliders },
    { "hair_events", SCENE_CUSTOM, .read = scene_read_commands },
    { "events", SCENE_CUSTOM, .read = scene_read_script },
    { "output", SCENE_CUSTOM, .read = scene_read_outputs },
};
#undef AT
const scene_block SCENE_BLOCK_OF_ALL = { SCENE_FIELDS, WISP_COUNT( SCENE_FIELDS ) };
