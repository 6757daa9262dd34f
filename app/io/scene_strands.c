// Strands: an entry before its keys are read, and the list of them.
#include "scene_parts.h"

#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stddef.h>

// ---- tables ----

// Every key of strands besides those of their motion.

// ---- frozen_hair ----

#define AT( member ) offsetof( wisp_scene_strands, member )
#define HAIR( member ) offsetof( wisp_scene_strands, frozen_hair.member )

static const scene_field FREEZE_FIELDS[] = {
    { "stretch_stiffness", .list = HAIR( strand_stretch_stiffness ), .list_count = AT( stretch_count ),
      .help = "Stiffness against stretching; a larger value changes lengths less." },
    { "bend_stiffness", .list = HAIR( strand_bend_stiffness ), .list_count = AT( bend_count ),
      .help = "Stiffness against bending; a larger value bends less." },
    { "max_bend_angle", .help = "Largest angle that a segment can bend by." },
};
static const scene_block FREEZE_BLOCK =
    SCENE_BLOCK_OF( FREEZE_FIELDS, frozen_hair_def, wisp_scene_strands, frozen_hair );

static const scene_choice REACHES[] = { { "tip", "of the tip" },
                                        { "nearest", "of the nearest vertex" },
                                        { NULL, NULL } };

static const scene_field ALIGN_FIELDS[] = {
    { "intensity", .list = HAIR( strand_intensity ), .list_count = AT( intensity_count ),
      .help = "How far strands turn towards the cursor, from 0 (not at all) to 1 (all the way)." },
    { "cursor", .given = AT( has_cursor ),
      .help = "Point that the first update turns strands towards; not with `base: stroke`." },
    { "reach", .help = "Strands farther from the cursor than this do not turn." },
    { "reach_by", .member = "reach_nearest", .choices = REACHES, .help = "Which distance is compared with `reach`." },
};
static const scene_block ALIGN_BLOCK =
    SCENE_BLOCK_OF( ALIGN_FIELDS, frozen_hair_def, wisp_scene_strands, frozen_hair );

static const scene_choice GAPS[] = { { "absolute", "|r1 - r0|, any change brakes" },
                                     { "none", "no brake" },
                                     { NULL, NULL } };

static const scene_field CLUMP_FIELDS[] = {
    { "radius", .member = "clump_radius", .help = "Vertices closer than this attract each other." },
    { "iterations", .member = "clump_iterations", .help = "Iterations of the stage; 0 switches it off." },
    { "step_length", .member = "clump_step_length", .help = "Length scale of the move of a vertex in an iteration.",
      .initial = "a tenth of the radius" },
    { "gap", .choices = GAPS, .constants = "WISP_GAP_",
      .help = "How a change of the distance between two vertices brakes their attraction." },
    { "min_distance", .help = "Limits moves so that two vertices stay at least this far apart in an iteration.",
      .initial = "0.02 of the radius" },
    { "min_lambda", .help = "Smallest factor that the brake can multiply the attraction by, with `gap: absolute`." },
    { "max_neighbours", .help = "Neighbours of a vertex beyond this number are left out and counted." },
};
static const scene_block CLUMP_BLOCK =
    SCENE_BLOCK_OF( CLUMP_FIELDS, frozen_hair_def, wisp_scene_strands, frozen_hair );

static const scene_choice BASES[] = { { "rest", "the rest shape" },
                                      { "stroke",
                                        "the rest shape; random numbers are drawn once, and strands keep the "
                                        "direction and intensity of the last hair event that reached them" },
                                      { NULL, NULL } };
static const scene_choice EVENTS[] = { { "hair_event", "each hair event" },
                                       { "frame", "each step" },
                                       { NULL, NULL } };

static const scene_field FROZEN_HAIR_FIELDS[] = {
    { "seed", .help = "Seed of the random numbers of all stages." },
    { "base", .choices = BASES, .constants = "WISP_FROZEN_BASE_", .help = "Shape that each update starts from." },
    { "update_on", .choices = EVENTS, .constants = "WISP_FROZEN_UPDATE_",
      .help = "What updates the frozen shape, with new random numbers.",
      .initial = "`hair_event`; `frame` for ghosts" },
    { "max_depth_change",
      .help = "Largest move of a vertex along z, which is depth (2.5D): freezing is limited, and strands align and "
              "clump in "
              "x and y alone.",
      .initial = "no limit" },
    { "freeze", SCENE_BLOCK, .at = HAIR( freeze ), .block = &FREEZE_BLOCK,
      .help = "Runs the first stage: lengths almost kept, bends limited." },
    { "align", SCENE_BLOCK, .at = HAIR( align ), .block = &ALIGN_BLOCK,
      .help = "Runs the second stage: strands turn towards a cursor." },
    { "clump", SCENE_BLOCK, .at = HAIR( clump ), .block = &CLUMP_BLOCK,
      .help = "Runs the third stage: neighbouring vertices attract each other." },
};
static const scene_block FROZEN_HAIR_BLOCK =
    SCENE_BLOCK_OF( FROZEN_HAIR_FIELDS, frozen_hair_def, wisp_scene_strands, frozen_hair );

// ---- environment and appearance ----

static const scene_field ENVIRONMENT_FIELDS[] = {
    { "temperature_celsius", .help = "Temperature of the air." },
    { "wetness", .help = "Wetness of the hair, from 0 (dry) to 1." },
    { "freezing_celsius", .help = "Temperature where ice begins to form." },
    { "span", .help = "Kelvin below freezing at which all water is ice." },
    { "curve", SCENE_CUSTOM, .read = scene_read_curve,
      .help = "Control points of the stiffness as a function of ice; ice rises from 0 to 1, stiffness rises or falls "
              "throughout.",
      .form = "list of 2 to 8 pairs [ice, stiffness], ice in 0 .. 1, stiffness in 0.001 .. 1e12",
      .initial = "[[0, 1], [1, 20]]" },
};
static const scene_block ENVIRONMENT_BLOCK =
    SCENE_BLOCK_OF( ENVIRONMENT_FIELDS, environment_def, wisp_scene_strands, environment );

static const scene_field LOOK_FIELDS[] = {
    { "root_width", .help = "Width at the root." },
    { "tip_width", .help = "Width at the tip." },
    { "root_colour", .help = "Linear red, green and blue at the root." },
    { "tip_colour", .help = "Linear red, green and blue at the tip." },
    { "colour_bias", .help = "0.5 blends evenly; more shows the colour of the tip nearer to the root." },
};
static const scene_block LOOK_BLOCK =
    SCENE_BLOCK_OF( LOOK_FIELDS, strand_appearance_def, wisp_scene_strands, appearance );

// ---- compute ----

static const scene_choice WORDS[] = {
    { "points", "positions" },
    { "width", "width of each vertex; needs `appearance`" },
    { "colour", "colour of each vertex; needs `appearance`" },
    { "strain", "relative error of the length of each segment; needs `dynamics`" },
    { "speed", "speed of each vertex; needs `dynamics`" },
    { "motion_stats", "mass, momentum, energy, largest strain and speed; needs `dynamics`" },
    { "collision_stats", "largest penetration and number of contacts; needs `collision`" },
    { NULL, NULL },
};
static const size_t REQUESTS[] = { AT( request_points ),  AT( request_width ), AT( request_colour ),
                                   AT( request_strain ),  AT( request_speed ), AT( request_motion_stats ),
                                   AT( request_contacts ) };

// Words from OF_LOOK on need a look, those from OF_DYNAMICS on a motion, those from OF_COLLISION on a collision
// too, which ghosts can have without a motion of their own.
static wisp_status check_word( scene_reader* r, const text_node* item, int word, const void* entry )
{
    enum
    {
        OF_LOOK = 1,
        OF_DYNAMICS = 3,
        OF_COLLISION = 6,
    };
    const wisp_scene_strands* s = entry;
    const bool moves = s->has_dynamics || ( word >= OF_COLLISION && s->has_ghosts );
    const char* lacks = word >= OF_LOOK && word < OF_DYNAMICS && !s->has_appearance ? "appearance"
                        : word >= OF_DYNAMICS && !moves                             ? "dynamics"
                        : word >= OF_COLLISION && !s->has_collision                 ? "collision"
                                                                                    : NULL;
    return lacks ? scene_refuse_node( r, item, "'%s' needs the key '%s'", WORDS[word].word, lacks ) : WISP_OK;
}

// ---- an entry of strands ----

static const scene_field TRANSFORM_FIELDS[] = {
    { "scale", SCENE_NUMBER, .at = AT( scale ), .range = SIZE,
      .help = "Factor of the size, about the origin of the strands, before they are turned." },
    { "rotate", SCENE_CUSTOM, .at = AT( pose.rotation ), .read = scene_read_rotation,
      .help = "Rotation about the origin, before the strands are moved.", .form = "rotation", .initial = "none" },
    { "translate", SCENE_VECTOR, .at = AT( pose.translation ), .range = COORDINATE, .unit = METRES,
      .help = "Displacement after scale and rotation." },
};
static const scene_block TRANSFORM_BLOCK = SCENE_BLOCK_ALONE( TRANSFORM_FIELDS );

static const scene_block COPIES_BLOCK = SCENE_BLOCK_IN( SCENE_COPIES_FIELDS, wisp_scene_strands, copies );

static const scene_field START_FIELDS[] = { SCENE_START_FIELDS };
static const scene_block START_BLOCK = SCENE_BLOCK_IN( START_FIELDS, wisp_scene_strands, start );

// `generate` stands before what is numbered by its strands and vertices, and the effects before `compute`.
static const scene_field STRANDS_FIELDS[] = {
    SCENE_NAME_FIELD,
    { "file", SCENE_CUSTOM, .at = AT( file ), .read = scene_read_file,
      .help = "Groom to read (`.hair`), relative to the folder of the scene.", .form = "path", .initial = "none" },
    { "generate", SCENE_CUSTOM, .read = scene_read_generate, .help = "Generates the strands instead of reading them.",
      .form = "block" },
    { "scatter", SCENE_BLOCK, .at = AT( is_scattered ), .block = &SCENE_SCATTER_BLOCK,
      .help = "Places strands around those of another entry." },
    { "curves", SCENE_BLOCK, .at = AT( is_curves ), .block = &SCENE_CURVES_BLOCK,
      .help = "Draws smooth curves through the strands of another entry." },
    { "transform", SCENE_BLOCK, .block = &TRANSFORM_BLOCK,
      .help = "Scales, turns and moves the strands; not with `scatter` or `curves`." },
    { "copies", SCENE_BLOCK, .block = &COPIES_BLOCK,
      .help = "Makes several entries of this one, in a grid; not with `scatter`, `curves`, `ghosts`, `head` or "
              "`on_surface`." },
    { "start", SCENE_BLOCK, .at = AT( has_start ), .block = &START_BLOCK,
      .help = "Starts away from the rest shape; roots are only scaled; needs `dynamics`." },
    { "dynamics", SCENE_BLOCK, .at = AT( has_dynamics ), .block = &SCENE_DYNAMICS_BLOCK,
      .help = "Makes the strands move." },
    { "head", SCENE_BLOCK, .at = AT( has_head ), .block = &SCENE_HEAD_BLOCK,
      .help = "Motion of the body that carries the roots; needs `dynamics`." },
    { "frame", SCENE_BLOCK, .at = AT( has_frame ), .block = &SCENE_STRAND_FRAME_BLOCK,
      .help = "A frame that moves and carries the strands by what they do not feel of it; needs `dynamics`." },
    { "max_speed", SCENE_NUMBER, .at = AT( max_speed ), .range = RANGE( 1e-6, 1e6 ), .unit = "m/s",
      .help = "Largest speed of a vertex; faster velocities are scaled down and counted. Needs `dynamics`.",
      .initial = "no limit" },
    { "tips", SCENE_BLOCK, .at = AT( has_tips ), .block = &SCENE_TIPS_BLOCK,
      .help = "Holds the last vertex of every strand; needs `dynamics`." },
    { "on_surface", SCENE_CUSTOM, .read = scene_read_later_name,
      .help = "Surface whose nearest triangles carry the roots; needs `dynamics`, not with `head`.",
      .form = "name of a surface", .initial = "none" },
    { "grid", SCENE_BLOCK, .at = AT( has_grid ), .block = &SCENE_GRID_BLOCK,
      .help = "Interaction between strands through a grid of cells; needs `dynamics`." },
    { "collision", SCENE_USUAL, .at = AT( has_collision ), .block = &SCENE_STRAND_COLLISION_BLOCK,
      .initial = SCENE_COLLIDES "; of `ghosts` false",
      .help = "Collision with colliders; needs `dynamics` or `ghosts`." },
    { "contact", SCENE_BLOCK, .at = AT( has_contact ), .block = &SCENE_STRAND_CONTACT_BLOCK,
      .help = "Contact with surfaces, and with strands if they have `between_strands`; needs `dynamics`." },
    { "sleep", SCENE_BLOCK, .at = AT( has_sleep ), .block = &SCENE_STRANDS_SLEEP_BLOCK,
      .help = "Strands that rest cost nothing until something reaches or changes them; needs `dynamics`." },
    { "detail", SCENE_BLOCK, .at = AT( has_detail ), .block = &SCENE_STRANDS_DETAIL_BLOCK,
      .help = "Level of detail: strands that are far away or out of sight cost less; needs `dynamics` or `ghosts`." },
    { "ghosts", SCENE_BLOCK, .at = AT( has_ghosts ), .block = &SCENE_GHOSTS_BLOCK,
      .help = "Makes the strands follow simulated ones; not with `dynamics`." },
    { "frozen_hair", SCENE_BLOCK, .at = AT( has_frozen_hair ), .block = &FROZEN_HAIR_BLOCK,
      .help = "Frozen shape; not with `dynamics`." },
    { "environment", SCENE_BLOCK, .at = AT( has_environment ), .block = &ENVIRONMENT_BLOCK,
      .help = "Derives the stiffness of all strands from temperature and wetness." },
    { "appearance", SCENE_BLOCK, .at = AT( has_appearance ), .block = &LOOK_BLOCK,
      .help = "Width and colour from root to tip." },
    { "compute", SCENE_WORDS, .given = AT( has_compute ), .choices = WORDS, .switches = REQUESTS, .check = check_word,
      .help = "What is computed for output and statistics.",
      .initial = "`points`; none of strands that are not shown; `[]`: none" },
    { "show", SCENE_SWITCH, .at = AT( is_shown ), .given = AT( has_show ),
      .help = "Whether pictures show the strands.",
      .initial = "`true`; `false` for strands that ghosts follow or curves run through" },
};
#undef AT

const scene_block SCENE_STRANDS_BLOCK = SCENE_BLOCK_ALONE( STRANDS_FIELDS );

// ---- lists ----

wisp_scene_strands scene_default_strands( wisp_vec3 gravity )
{
    wisp_scene_strands strands = {
        .generator = wisp_default_groom_generator( WISP_GROOM_STRAIGHT, 3 ),
        .scatter = { .around = -1, .count = 4, .seed = 1 },
        .curves = wisp_default_curves_def(),
        .curves_of = -1,
        .scale = 1.0f,
        .copies = { .count = 1 },
        .start = scene_default_start(),
        .mass_ratio = 1.0f,
        .pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } },
        .frozen_hair = wisp_default_frozen_hair_def(),
        .environment = wisp_default_environment_def(),
        .appearance = wisp_default_strand_appearance_def(),
        .dynamics = wisp_default_strand_dynamics_def(),
        .grid = wisp_default_strand_grid_def(),
        .collision = wisp_default_collision_def(),
        .contact = wisp_default_contact_def(),
        .sleep = wisp_default_sleep_def(),
        .frame = wisp_default_moving_frame_def(),
        .max_speed = INFINITY,
        .detail = wisp_default_detail_def(),
        .tips_hold = WISP_STRAND_TIP_CLAMPED,
        .tips_release = INFINITY,
        .on_surface = -1,
        .ghosts = wisp_default_ghosts_def(),
        .targets = -1,
        .is_shown = true,
    };
    strands.dynamics.gravity = gravity;
    // A stage runs if its key is there, not by default.
    strands.frozen_hair.freeze = strands.frozen_hair.align = strands.frozen_hair.clump = false;
    return strands;
}

static wisp_status read_entry( scene_reader* r, const text_node* node, int index, void* entries )
{
    wisp_scene_strands* strands = (wisp_scene_strands*)entries + index;
    r->entry = strands;
    *strands = scene_default_strands( r->scene->gravity );
    strands->line = node->line;
    strands->column = node->column;
    // Ghosts move in every step, so frozen hair on them follows in every step.
    if ( text_find_path( node, "ghosts" ) )
    {
        strands->frozen_hair.update_on = WISP_FROZEN_UPDATE_FRAME;
    }
    strands->has_collision = r->body_count > 0;
    WISP_TRY( scene_read_block( r, node, &SCENE_STRANDS_BLOCK, strands ) );
    if ( strands->has_dynamics == false && text_find_path( node, "collision" ) == NULL )
    {
        strands->has_collision = false;
    }
    return scene_check_strands( r, node, strands );
}

const scene_list SCENE_STRANDS_LIST = { .what = "a list of strands",
                                        .size = sizeof( wisp_scene_strands ),
                                        .most = WISP_SCENE_MAX_STRANDS,
                                        .read = read_entry,
                                        .is_named = true,
                                        .named = SCENE_STRANDS };
