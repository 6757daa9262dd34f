// Every key of strands that move, follow others, or are made of others.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>

#define AT( member ) offsetof( wisp_scene_strands, member )
#define BLOCK( fields )                                                                                              \
    {                                                                                                                \
        fields, WISP_COUNT( fields )                                                                                 \
    }

// ---- dynamics ----

#define MOVES( member ) offsetof( wisp_scene_strands, dynamics.member )

static const char* const STRETCHES[] = { "direct", "links", "follow", NULL };
static const char* const BENDS[] = { "rod", "bend_links", "none", NULL };
static const char* const RESTS[] = { "sag_free", "shape", "straight", NULL };
static const char* const SOLVERS[] = { "xpbd", "pbd", NULL };

static const scene_field DYNAMICS_FIELDS[] = {
    { "stretch", SCENE_CHOICE, .at = MOVES( stretch ), .choices = STRETCHES },
    { "stretch_passes", SCENE_WHOLE, .at = MOVES( stretch_passes ), .range = RANGE( 1, 16 ) },
    { "stretch_tolerance", SCENE_NUMBER, .at = MOVES( stretch_tolerance ), .range = RANGE( 1e-6, 1 ) },
    { "leader_correction", SCENE_NUMBER, .at = MOVES( follow_share ), .range = UNIT_RANGE },
    { "bending", SCENE_CHOICE, .at = MOVES( bend ), .choices = BENDS },
    { "bend_rigidity", SCENE_NUMBER, .at = MOVES( bend_rigidity ), .range = RANGE( 0, 1e12 ),
      .unit = ROD_RIGIDITIES },
    { "twist_rigidity", SCENE_NUMBER, .at = MOVES( twist_rigidity ), .range = RANGE( 0, 1e12 ),
      .unit = ROD_RIGIDITIES },
    { "bend_damping", SCENE_NUMBER, .at = MOVES( bend_damping ), .range = RANGE( 0, 1e3 ), .unit = SECONDS },
    { "rest", SCENE_CHOICE, .at = MOVES( rest ), .choices = RESTS },
    { "clamped", SCENE_SWITCH, .at = MOVES( clamped ) },
    { "solver", SCENE_CHOICE, .at = MOVES( solver ), .choices = SOLVERS },
    { "stretch_compliance", SCENE_NUMBER, .at = MOVES( stretch_compliance ), .range = COMPLIANCE,
      .unit = COMPLIANCES },
    { "bend_compliance", SCENE_NUMBER, .at = MOVES( bend_compliance ), .range = COMPLIANCE, .unit = COMPLIANCES },
    { "stretch_stiffness", SCENE_NUMBER, .at = MOVES( stretch_stiffness ), .range = UNIT_RANGE },
    { "bend_stiffness", SCENE_NUMBER, .at = MOVES( bend_stiffness ), .range = UNIT_RANGE },
    { "line_density", SCENE_NUMBER, .at = MOVES( line_density ), .range = ANY_MASS, .unit = LINE_DENSITIES },
    { "vertex_mass", SCENE_NUMBER, .at = MOVES( vertex_mass ), .range = ANY_MASS, .unit = MASSES },
    { "vertex_masses", SCENE_CUSTOM, .read = scene_read_vertex_masses },
    { "pins", SCENE_CUSTOM, .read = scene_read_strand_pins },
    { "gravity", SCENE_VECTOR, .at = MOVES( gravity ), .range = ACCELERATION, .unit = ACCELERATIONS },
    { "damping", SCENE_NUMBER, .at = MOVES( damping ), .range = RANGE( 0, 1e9 ), .unit = RATES },
    { "wind", SCENE_VECTOR, .at = MOVES( wind ), .range = WIND, .unit = SPEEDS },
    { "air_density", SCENE_NUMBER, .at = MOVES( air_density ), .range = RANGE( 0, 1e6 ), .unit = AIR_DENSITIES },
    { "drag_coefficient", SCENE_NUMBER, .at = MOVES( drag ), .range = RANGE( 0, 1e6 ) },
    { "diameter", SCENE_NUMBER, .at = MOVES( diameter ), .range = SIZE, .unit = METRES },
    { "teleport", SCENE_NUMBER, .at = MOVES( teleport ), .range = SIZE },
};
const scene_block SCENE_DYNAMICS_BLOCK = BLOCK( DYNAMICS_FIELDS );

static const scene_field HEAD_FIELDS[] = {
    { "keyframes", SCENE_CUSTOM, .required = true, .read = scene_read_head_path },
    { "pivot", SCENE_VECTOR, .at = AT( head_pivot ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_head_pivot ) },
};
const scene_block SCENE_HEAD_BLOCK = BLOCK( HEAD_FIELDS );

#define GRID( member ) offsetof( wisp_scene_strands, grid.member )

static const scene_field GRID_FIELDS[] = {
    { "cell_size", SCENE_NUMBER, .at = GRID( cell ), .range = SIZE, .unit = METRES },
    { "friction", SCENE_NUMBER, .at = GRID( friction ), .range = UNIT_RANGE },
    { "repulsion", SCENE_NUMBER, .at = GRID( repulsion ), .range = RANGE( 0, 1e6 ), .unit = ACCELERATIONS },
};
const scene_block SCENE_GRID_BLOCK = BLOCK( GRID_FIELDS );

#define COLLISION( member ) offsetof( wisp_scene_strands, collision.member )

static const scene_field COLLISION_FIELDS[] = {
    { "thickness", SCENE_NUMBER, .at = COLLISION( thickness ), .range = RANGE( 0, 1e6 ), .unit = METRES },
    { "friction_scale", SCENE_NUMBER, .at = COLLISION( friction ), .range = RANGE( 0, 1e6 ) },
    { "max_push_out_speed", SCENE_NUMBER, .at = COLLISION( recovery_speed ), .range = RANGE( 0, 1e6 ),
      .unit = SPEEDS },
    { "mask", SCENE_CUSTOM, .at = COLLISION( mask ), .read = scene_read_layers },
};
const scene_block SCENE_STRAND_COLLISION_BLOCK = BLOCK( COLLISION_FIELDS );

// ---- what follows others ----

#define GHOSTS( member ) offsetof( wisp_scene_strands, ghosts.member )

static const char* const ELASTICS[] = { "change", "cosine", "dot", "off", NULL };
static const char* const FRAMES[] = { "off", "root", "parallel", NULL };

static const scene_field GHOSTS_FIELDS[] = {
    { "targets", SCENE_CUSTOM, .read = scene_read_later_name },
    { "target_count", SCENE_WHOLE, .at = GHOSTS( target_count ), .range = RANGE( 1, 4 ) },
    { "resample", SCENE_SWITCH, .at = GHOSTS( resample ) },
    { "elastic", SCENE_CHOICE, .at = GHOSTS( elastic ), .choices = ELASTICS },
    { "tip_gain", SCENE_NUMBER, .at = GHOSTS( tip_gain ), .range = RANGE( 0, 1e3 ) },
    { "centre_gain", SCENE_NUMBER, .at = GHOSTS( centre_gain ), .range = RANGE( 0, 1e3 ) },
    { "time", SCENE_NUMBER, .at = GHOSTS( time ), .range = TIME, .unit = SECONDS },
    { "capped", SCENE_SWITCH, .at = GHOSTS( capped ) },
    { "keep_offset", SCENE_SWITCH, .at = GHOSTS( keep_offset ) },
    { "spread", SCENE_NUMBER, .at = GHOSTS( spread ), .range = SIZE },
    { "repair_length", SCENE_SWITCH, .at = GHOSTS( repair_length ) },
    { "frame", SCENE_CHOICE, .at = GHOSTS( frame ), .choices = FRAMES },
    { "feedback", SCENE_SWITCH, .at = GHOSTS( feedback ) },
};
const scene_block SCENE_GHOSTS_BLOCK = BLOCK( GHOSTS_FIELDS );

static const scene_field SCATTER_FIELDS[] = {
    { "around", SCENE_CUSTOM, .required = true, .read = scene_read_later_name },
    { "count", SCENE_WHOLE, .required = true, .at = AT( scatter.count ), .range = RANGE( 1, 1000000 ) },
    { "radius", SCENE_NUMBER, .required = true, .at = AT( scatter.radius ), .range = RANGE( 0, 1e6 ),
      .unit = METRES },
    { "seed", SCENE_SEED, .at = AT( scatter.seed ) },
};
const scene_block SCENE_SCATTER_BLOCK = BLOCK( SCATTER_FIELDS );

static const char* const CURVE_KINDS[] = { "bezier", "catmull_rom", NULL };

static const scene_field CURVES_FIELDS[] = {
    { "of", SCENE_CUSTOM, .required = true, .read = scene_read_later_name },
    { "kind", SCENE_CHOICE, .at = AT( curves.kind ), .choices = CURVE_KINDS },
    { "samples", SCENE_WHOLE, .at = AT( curves.samples ), .range = RANGE( 1, 64 ) },
};
const scene_block SCENE_CURVES_BLOCK = BLOCK( CURVES_FIELDS );
