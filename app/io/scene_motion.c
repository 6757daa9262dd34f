// Strands: what no table can say about an entry, and the entries that it names.

#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <stddef.h>
#include <string.h>

// ---- tables ----

// Every key of strands that move, follow others, or are made of others.

#define AT( member ) offsetof( wisp_scene_strands, member )
// ---- dynamics ----

static const scene_choice STRETCHES[] = { { "direct", "the whole strand at once by a direct solve, exact" },
                                          { "links", "one pass over links per iteration, cheap" },
                                          { NULL, NULL } };
static const scene_choice BENDS[] = { { "rod", "an elastic rod in SI units" },
                                      { "bend_links", "links between vertices two apart" },
                                      { "none", "no resistance" },
                                      { NULL, NULL } };
static const scene_choice RESTS[] = {
    { "sag_free", "such that the given shape is in balance under gravity and does not sag at the start" },
    { "shape", "the given shape" },
    { "straight", "a straight line" },
    { NULL, NULL }
};
static const scene_choice SOLVERS[] = { { "xpbd", "extended position based dynamics, with compliances in SI units" },
                                        { "pbd", "position based dynamics, with stiffnesses in 0 .. 1" },
                                        { NULL, NULL } };

static const scene_choice INTEGRATORS[] = { { "euler", "implicit Euler, first order" },
                                            { "bdf2", "implicit, second order, with `stretch: direct`" },
                                            { NULL, NULL } };

static const scene_field DYNAMICS_FIELDS[] = {
    { "substeps", SCENE_WHOLE, .at = AT( substeps ), .range = RANGE( 0, 10000 ),
      .help = "Substeps of these strands, rounded up to a multiple of those of the scene, which has the fewest.",
      .initial = "those of the scene" },
    { "stretch", .choices = STRETCHES, .constants = "WISP_STRAND_STRETCH_",
      .help = "How segments keep their length." },
    { "stretch_passes",
      .help = "Newton passes of the direct solve in an iteration at most; they end early when lengths are right." },
    { "stretch_tolerance",
      .help = "Largest relative error of a length after the direct solve; strands beyond it are reset to their rest "
              "lengths and counted." },
    { "integrator", .choices = INTEGRATORS, .constants = "WISP_INTEGRATOR_", .help = "Time integration." },
    { "bending", .choices = BENDS, .constants = "WISP_STRAND_BEND_", .help = "How strands resist bending." },
    { "bend_rigidity", .help = "Bending rigidity EI of a rod." },
    { "twist_rigidity", .help = "Twisting rigidity GJ of a rod." },
    { "edgewise_rigidity",
      .help = "Bending rigidity of an elliptic section or a ribbon in the plane of its width, 1 to 1e5 times "
              "`bend_rigidity`, which is that across its flat side; 0 is circular." },
    { "flat_normal", .range = RANGE( -1e5, 1e5 ),
      .help = "Direction across the flat side at roots, with `edgewise_rigidity`.", .initial = "any direction" },
    { "natural_twist", .help = "Rotation of the section along a strand without load, with `edgewise_rigidity`." },
    { "free_roots",
      .help = "Roots are free, in place and direction: strands fall. With `rest: shape` or `straight`." },
    { "closed",
      .help = "Every strand is a loop that moves freely: its last vertex lies on its first and is the same one. With "
              "`stretch: direct`, `bending: rod` or `none`, and `rest: shape` or `straight`." },
    { "closing_twist",
      .help = "How far one end of a closed rod was turned against the other before they were joined." },
    { "bend_damping",
      .help = "Ratio of the force against the rate of bending to the force against bending, of a rod." },
    { "rest", .choices = RESTS, .constants = "WISP_STRAND_REST_", .help = "Shape of a rod where no force acts." },
    { "clamped", .help = "Whether the root holds the direction of a rod as well as its place." },
    { "solver", .choices = SOLVERS, .constants = "WISP_SOLVER_", .help = "Solver of links." },
    { "stretch_compliance", .help = "Compliance of links along segments, with `solver: xpbd`." },
    { "bend_compliance", .help = "Compliance of bend links, with `solver: xpbd`." },
    { "stretch_stiffness", .help = "Stiffness of links along segments, with `solver: pbd`." },
    { "bend_stiffness", .help = "Stiffness of bend links, with `solver: pbd`." },
    { "line_density", .help = "Mass per length of a strand." },
    { "vertex_mass", .range = ANY_MASS, .help = "Mass of every vertex, instead of the density.",
      .initial = "by density" },
    { "vertex_masses", SCENE_ENTRIES, .at = AT( dynamics.vertex_masses ), .list_count = AT( mass_count ),
      .of = &SCENE_VERTEX_MASSES, .help = "Mass of each vertex, instead of the density.",
      .form = "list of numbers in kg, one per vertex, 1e-12 .. 1e12", .initial = "by density" },
    { "mass_ratio", SCENE_NUMBER, .at = AT( mass_ratio ), .range = RANGE( 1e-9, 1e9 ),
      .help = "Mass of tips over what it would be; from 1 at roots it grows by equal factors." },
    { "pins", SCENE_ENTRIES, .at = AT( dynamics.pins ), .of = &SCENE_STRAND_PINS,
      .help = "Vertices held in addition to the roots.", .form = "list of vertices", .initial = "none" },
    { "gravity", .help = "Gravity of these strands.", .initial = "that of the scene" },
    { "damping", .help = "Rate at which motion relative to the head dies." },
    { "wind", .help = "Velocity of the air." },
    { "air_density", .help = "Density of the air." },
    { "drag_coefficient", .help = "Drag coefficient across a strand; 0 switches air off." },
    { "diameter", .range = SIZE, .help = "Diameter of a strand in the air." },
    { "teleport", .range = SIZE,
      .help = "A head that moves farther than this in a step, in lengths of the longest strand, gives its strands no "
              "velocity." },
};
const scene_block SCENE_DYNAMICS_BLOCK =
    SCENE_BLOCK_OF( DYNAMICS_FIELDS, strand_dynamics_def, wisp_scene_strands, dynamics );

static const scene_field HEAD_FIELDS[] = {
    { "keyframes", SCENE_ENTRIES, .required = true, .at = AT( head ), .of = &SCENE_HEAD_PATH,
      .help = "Poses of the head; it starts at its pivot, not turned.",
      .form = "list of keyframes {time, position, rotation}" },
    { "pivot", SCENE_VECTOR, .at = AT( head_pivot ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_head_pivot ), .help = "Where the head stands at the start.",
      .initial = "`transform.translate`" },
};
const scene_block SCENE_HEAD_BLOCK = SCENE_BLOCK_ALONE( HEAD_FIELDS );

static const scene_field FRAME_FIELDS[] = {
    { "linear_inertia", .help = "Fraction of the displacement of the frame that strands feel." },
    { "angular_inertia", .help = "Fraction of the rotation of the frame that strands feel." },
    { "keyframes", SCENE_ENTRIES, .at = AT( frame_path ), .of = &SCENE_PIN_PATH,
      .help = "Displacement of the frame from where it starts; without `jump`.",
      .form = "list of keyframes {time, translate, rotate}", .initial = "it goes with the head" },
    { "pivot", SCENE_VECTOR, .at = AT( frame_pivot ), .range = COORDINATE, .unit = METRES,
      .given = AT( has_frame_pivot ), .help = "Where the frame starts; it rotates about this point.",
      .initial = "that of the head" },
};
const scene_block SCENE_STRAND_FRAME_BLOCK =
    SCENE_BLOCK_OF( FRAME_FIELDS, moving_frame_def, wisp_scene_strands, frame );

static const scene_choice HOLDS[] = { { "free", "not at all" },
                                      { "pinned", "their positions" },
                                      { "guided", "their directions and twist; they slide freely" },
                                      { "clamped", "positions, directions and twist" },
                                      { NULL, NULL } };

static const scene_field TIPS_FIELDS[] = {
    { "hold", SCENE_CHOICE, .at = AT( tips_hold ), .choices = HOLDS, .constants = "WISP_STRAND_TIP_",
      .help = "What is held of the tips; a clamped tip at its own root makes a loop." },
    { "keyframes", SCENE_ENTRIES, .at = AT( tips_path ), .of = &SCENE_TIPS_PATH,
      .help = "How far tips are from rest, relative to the head, and turned about themselves.",
      .form = "list of keyframes {time, position, rotation}", .initial = "none" },
    { "release", SCENE_NUMBER, .at = AT( tips_release ), .range = RANGE( 0, 1e9 ), .unit = SECONDS,
      .help = "Time at which tips are released.", .initial = "never" },
};
const scene_block SCENE_TIPS_BLOCK = SCENE_BLOCK_ALONE( TIPS_FIELDS );

static const scene_field GRID_FIELDS[] = {
    { "cell_size", .range = SIZE, .help = "Edge of a cell.", .initial = "twice the mean segment" },
    { "friction",
      .help = "Part of the difference to the mean velocity of the cells around that is taken away in 1/60 s." },
    { "repulsion", .help = "Acceleration towards thinner cells where the density is twice that at rest." },
};
const scene_block SCENE_GRID_BLOCK = SCENE_BLOCK_OF( GRID_FIELDS, strand_grid_def, wisp_scene_strands, grid );

#define COLLISION( member ) offsetof( wisp_scene_strands, collision.member )

static const scene_field COLLISION_FIELDS[] = {
    { "thickness", .help = "Distance that vertices keep from colliders.", .initial = "the mean length of a segment" },
    { "friction_scale", .help = "Factor of the friction of the collider; ghosts have no friction." },
    { "max_push_out_speed",
      .help = "Speed at which a vertex that starts inside is moved out; ghosts are moved at once.",
      .initial = "ten mean segments per second" },
    { "mask", SCENE_CUSTOM, .at = COLLISION( mask ), .read = scene_read_layers,
      .help = "Numbers of the collider layers that stop it.", .form = "list of layers, 0 .. 31",
      .initial = "all layers" },
};
const scene_block SCENE_STRAND_COLLISION_BLOCK =
    SCENE_BLOCK_OF( COLLISION_FIELDS, collision_def, wisp_scene_strands, collision );

// ---- what follows others ----

static const scene_choice ELASTICS[] = { { "change", "0.5 - 0.5 cos: grows with the change of direction" },
                                         { "off", "no sway" },
                                         { NULL, NULL } };
static const scene_field GHOSTS_FIELDS[] = {
    { "targets", SCENE_CUSTOM, .read = scene_read_later_name,
      .help = "Strands with `dynamics` that the ghosts follow.", .form = "name of strands",
      .initial = "what the ghosts are scattered around" },
    { "target_count", .help = "Number of targets that each ghost follows." },
    { "resample", .help = "Allows ghosts with another number of vertices than their targets." },
    { "elastic", .choices = ELASTICS, .constants = "WISP_GHOST_ELASTIC_",
      .help = "Weight of the elastic sway, from the velocities of the target now and a step before." },
    { "tip_gain", .help = "How far tips sway." },
    { "centre_gain", .help = "How far ghosts far from their target sway." },
    { "time", .help = "Time that velocities are multiplied by; 0 takes the step." },
    { "spread", .help = "Factor of the distances within a group of ghosts; 1 leaves them as they are." },
    { "repair_length", .help = "Brings segments back to their rest length, from the root on." },
};
const scene_block SCENE_GHOSTS_BLOCK = SCENE_BLOCK_OF( GHOSTS_FIELDS, ghosts_def, wisp_scene_strands, ghosts );

static const scene_field SCATTER_FIELDS[] = {
    { "around", SCENE_CUSTOM, .required = true, .read = scene_read_later_name,
      .help = "Entry above this one, with `file` or `generate`.", .form = "name of strands" },
    { "count", SCENE_WHOLE, .at = AT( scatter.count ), .range = RANGE( 1, 1000000 ),
      .help = "Number of strands around each; at most 134217728 vertices in all." },
    { "radius", SCENE_NUMBER, .required = true, .at = AT( scatter.radius ), .range = RANGE( 0, 1e6 ), .unit = METRES,
      .help = "Radius of the disc that offsets are uniform in, across the direction in which the root grows." },
    { "seed", SCENE_SEED, .at = AT( scatter.seed ), .help = "Seed of the offsets." },
};
const scene_block SCENE_SCATTER_BLOCK = SCENE_BLOCK_ALONE( SCATTER_FIELDS );

static const scene_choice CURVE_KINDS[] = { { "bezier",
                                              "vertices in fours that share their ends and the tangents there" },
                                            { "catmull_rom", "passes through all vertices" },
                                            { NULL, NULL } };

static const scene_field CURVES_FIELDS[] = {
    { "of", SCENE_CUSTOM, .required = true, .read = scene_read_later_name, .help = "Strands of any kind but curves.",
      .form = "name of strands" },
    { "kind", .choices = CURVE_KINDS, .constants = "WISP_CURVE_", .help = "Kind of curve." },
    { "samples",
      .help =
          "Samples of each segment of the curve, which spans three segments of the strand with `bezier`, else one." },
};
const scene_block SCENE_CURVES_BLOCK = SCENE_BLOCK_OF( CURVES_FIELDS, curves_def, wisp_scene_strands, curves );

// ---- lists ----

// ---- an entry ----

static wisp_status check_dynamics( scene_reader* r, const text_node* node, const wisp_scene_strands* s )
{
    const bool is_guided = s->has_tips && ( s->tips_hold & WISP_STRAND_TIP_GUIDED ) != 0;
    const scene_case cases[] = {
        { s->has_ghosts, NULL, "got both 'dynamics' and 'ghosts', expected one of them" },
        { s->has_frozen_hair, NULL,
          "got both 'dynamics' and 'frozen_hair', expected one of them; ghosts can have 'frozen_hair'" },
        { s->mass_count > 0 && s->dynamics.vertex_mass > 0.0f, NULL,
          "got both dynamics.vertex_mass and dynamics.vertex_masses, expected one of them" },
        { s->has_head && text_find_path( node, "on_surface" ) != NULL, NULL,
          "got both 'head' and 'on_surface', expected one of them" },
    };
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    WISP_TRY( scene_refuse_jumps( r, text_find_path( node, "frame" ), &s->frame_path, SCENE_JUMPS ) );
    return is_guided && s->dynamics.bending != WISP_STRAND_BEND_ROD
               ? scene_refuse_node( r, text_find_path( node, "tips" ),
                                    "got tips whose direction is held, expected them with dynamics.bending: rod" )
               : WISP_OK;
}

// What only strands that move can take; ghosts are at least kept out of bodies.
static wisp_status check_still( scene_reader* r, const text_node* node, const wisp_scene_strands* s )
{
    static const char* const keys[] = { "head", "tips",    "frame", "max_speed", "on_surface",
                                        "grid", "contact", "sleep", "start",     "collision" };
    const bool may_collide = s->has_ghosts || !s->has_collision;
    return scene_refuse_keys( r, node, keys, WISP_COUNT( keys ) - may_collide, "needs the key 'dynamics'" );
}

wisp_status scene_check_strands( scene_reader* r, const text_node* node, const wisp_scene_strands* s )
{
    // Curves are drawn and nothing else: where they are is up to the strands that they run through.
    static const char* const not_of_curves[] = { "transform", "dynamics",    "head",        "on_surface", "grid",
                                                 "ghosts",    "frozen_hair", "environment", "collision",  "contact" };
    const int sources = ( s->file != NULL ) + s->is_generated + s->is_scattered + s->is_curves;
    const scene_case source_cases[] = {
        { sources == 0, NULL, "got none of 'file', 'generate', 'scatter' and 'curves', expected one of them" },
        { sources > 1, NULL,
          "got more than one of 'file', 'generate', 'scatter' and 'curves', expected one of them" },
    };
    WISP_TRY( scene_refuse_cases( r, node, source_cases, WISP_COUNT( source_cases ) ) );
    if ( s->is_curves )
    {
        return scene_refuse_keys( r, node, not_of_curves, WISP_COUNT( not_of_curves ),
                                  "is not possible with 'curves'" );
    }
    const scene_case cases[] = {
        { s->is_scattered && text_find_path( node, "transform" ) != NULL, "transform",
          "'transform' is not possible with 'scatter'" },
        { s->has_ghosts && !s->is_scattered && text_find_path( node, "ghosts.targets" ) == NULL, NULL,
          "got neither ghosts.targets nor 'scatter', expected one of them" },
    };
    WISP_TRY( scene_refuse_cases( r, node, cases, WISP_COUNT( cases ) ) );
    const text_node *detail = text_find_path( node, "detail" ), *level = text_find_path( detail, "level" );
    WISP_TRY( detail ? scene_check_strands_detail( r, level ? level : detail, s, s->detail.level ) : WISP_OK );
    if ( s->has_frozen_hair && s->frozen_hair.base == WISP_FROZEN_BASE_STROKE && s->has_cursor )
    {
        return scene_refuse_node(
            r, text_find_path( node, "frozen_hair" ),
            "'align.cursor' is not possible with 'base: stroke', where only hair events turn strands" );
    }
    return s->has_dynamics ? check_dynamics( r, node, s ) : check_still( r, node, s );
}

// ---- entries that are named ----

// A value of an entry, or null; the path leads to it then.
static const text_node* enter( scene_reader* r, const text_node* entry, const char* path )
{
    const text_node* node = text_find_path( entry, path );
    if ( node )
    {
        scene_enter_key( r, path );
    }
    return node;
}

// A source comes before what is scattered around it, so there is no circle, and it is read or made itself.
static wisp_status bind_scatter( scene_reader* r, const text_node* entry, int i, void* none )
{
    (void)none;
    wisp_scene_strands* s = &r->scene->strands[i];
    const text_node* node = enter( r, entry, "scatter.around" );
    if ( !node )
    {
        return WISP_OK;
    }
    WISP_TRY( scene_read_named( r, node, SCENE_STRANDS, &s->scatter.around ) );
    const wisp_scene_strands* source = &r->scene->strands[s->scatter.around];
    if ( s->scatter.around >= i )
    {
        return scene_refuse_node( r, node, "got '%s', expected an entry above this one", source->name );
    }
    if ( source->is_scattered || source->is_curves )
    {
        return scene_refuse_node( r, node, "got '%s', expected strands with 'file' or 'generate'", source->name );
    }
    int64_t made = source->is_generated ? scene_made_vertices( source ) * s->scatter.count : 0;
    return made <= WISP_GROOM_MAX_GENERATED
               ? WISP_OK
               : scene_refuse_node( r, node, "%d strands around each of '%s' have %lld vertices, expected at most %d",
                                    s->scatter.count, source->name, (long long)made, WISP_GROOM_MAX_GENERATED );
}

static wisp_status bind_curves( scene_reader* r, const text_node* entry, int i, void* none )
{
    (void)none;
    wisp_scene_strands* s = &r->scene->strands[i];
    const text_node* node = enter( r, entry, "curves.of" );
    if ( !node )
    {
        return WISP_OK;
    }
    WISP_TRY( scene_read_named( r, node, SCENE_STRANDS, &s->curves_of ) );
    wisp_scene_strands* source = &r->scene->strands[s->curves_of];
    if ( source->is_curves )
    {
        return scene_refuse_node( r, node, "got '%s', expected strands that are not curves", source->name );
    }
    source->is_shown = source->has_show && source->is_shown;
    return WISP_OK;
}

// Scattered ghosts follow what they are scattered around, unless they say otherwise.
static wisp_status bind_ghosts( scene_reader* r, const text_node* entry, int i, void* none )
{
    (void)none;
    wisp_scene_strands* s = &r->scene->strands[i];
    if ( !s->has_ghosts )
    {
        return WISP_OK;
    }
    const text_node* node = enter( r, entry, "ghosts.targets" );
    s->targets = s->scatter.around;
    WISP_TRY( node ? scene_read_named( r, node, SCENE_STRANDS, &s->targets ) : WISP_OK );
    wisp_scene_strands* targets = &r->scene->strands[s->targets];
    if ( !targets->has_dynamics )
    {
        return scene_refuse_node( r, node ? node : entry, "got '%s', expected strands with the key 'dynamics'",
                                  targets->name );
    }
    targets->is_shown = targets->has_show && targets->is_shown;
    return WISP_OK;
}

static wisp_status bind_root( scene_reader* r, const text_node* entry, int i, void* none )
{
    (void)none;
    const text_node* node = enter( r, entry, "on_surface" );
    return node ? scene_read_named( r, node, SCENE_SURFACE, &r->scene->strands[i].on_surface ) : WISP_OK;
}

static wisp_status bind_list( scene_reader* r, const text_node* root, const char* key, scene_item_fn* bind )
{
    const text_node* list = text_find_path( root, key );
    const size_t outside = scene_enter_key( r, key );
    WISP_TRY( list ? scene_read_items( r, list, bind, NULL ) : WISP_OK );
    scene_leave( r, outside );
    return WISP_OK;
}

wisp_status scene_bind_strands( scene_reader* r, const text_node* root )
{
    WISP_TRY( bind_list( r, root, "strands", bind_scatter ) );
    WISP_TRY( bind_list( r, root, "strands", bind_curves ) );
    return bind_list( r, root, "strands", bind_ghosts );
}

wisp_status scene_bind_to_surfaces( scene_reader* r, const text_node* root )
{
    WISP_TRY( bind_list( r, root, "strands", bind_root ) );
    return bind_list( r, root, "surfaces", scene_bind_attachments );
}
