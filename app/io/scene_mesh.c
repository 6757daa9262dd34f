// Where a mesh comes from, what is done to it, and how it is turned and moved: for surfaces and for colliders.
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "trig.h"

#define COUNT( least ) RANGE( least, WISP_SCENE_MAX_VERTICES )

// ---- generate: a table for each shape, so that a key that the shape has no use for is refused as unknown ----

#define AT( member ) offsetof( wisp_mesh_generator, member )

static const scene_choice SHAPES[] = { { "plane", "a grid in y = 0, all diagonals alike" },
                                       { "alternating_plane", "a grid in y = 0, diagonals alternate" },
                                       { "irregular_plane", "a grid in y = 0, shifted at random" },
                                       { "delaunay", "a rectangle in y = 0, Delaunay triangulation" },
                                       { "garment", "a front panel of a shirt in y = 0, finer at curved seams" },
                                       { "icosphere", "a sphere from an icosahedron" },
                                       { "uv_sphere", "a sphere of rings and segments" },
                                       { "torus", "a torus about y" },
                                       { "capsule", "a cylinder along y with two caps" },
                                       { "tube", "a cylinder along y without caps" },
                                       { "pear", "a closed pear shape" },
                                       { NULL, NULL } };

#define SHAPE_FIELD                                                                                                  \
    {                                                                                                                \
        "shape", SCENE_CHOICE, .required = true, .at = AT( shape ), .choices = SHAPES,                               \
                               .help = "Shape; it lies around the origin."                                           \
    }
#define COLUMNS_FIELD                                                                                                \
    {                                                                                                                \
        "columns", SCENE_WHOLE, .at = AT( columns ), .range = COUNT( 2 ),                                            \
                                .help = "Vertices along x; vertex (i, j) has the number j * columns + i."            \
    }
#define ROWS_FIELD                                                                                                   \
    {                                                                                                                \
        "rows", SCENE_WHOLE, .at = AT( rows ), .range = COUNT( 2 ), .help = "Vertices along z."                      \
    }
#define SPACING_FIELD                                                                                                \
    {                                                                                                                \
        "spacing", SCENE_NUMBER, .at = AT( spacing ), .range = SIZE, .unit = METRES,                                 \
                                 .help = "Distance between neighbouring vertices."                                   \
    }
#define SEGMENTS_FIELD                                                                                               \
    {                                                                                                                \
        "segments", SCENE_WHOLE, .at = AT( segments ), .range = COUNT( 3 ), .help = "Segments around the y axis."    \
    }
#define RINGS_FIELD( least, message )                                                                                \
    {                                                                                                                \
        "rings", SCENE_WHOLE, .at = AT( rings ), .range = COUNT( least ), .help = message                            \
    }
#define ALONG_FIELD                                                                                                  \
    {                                                                                                                \
        "length_segments", SCENE_WHOLE, .at = AT( length_segments ), .range = COUNT( 1 ),                            \
                                        .help = "Segments along the cylinder."                                       \
    }
#define RADIUS_FIELD                                                                                                 \
    {                                                                                                                \
        "radius", SCENE_NUMBER, .at = AT( radius ), .range = SIZE, .unit = METRES,                                   \
                                .help = "Radius; of a torus, that of the centre line."                               \
    }
#define LENGTH_FIELD                                                                                                 \
    {                                                                                                                \
        "length", SCENE_NUMBER, .at = AT( length ), .range = SIZE, .unit = METRES, .help = "Length of the cylinder." \
    }

#define WIDTH "Width along x."
#define DEPTH "Depth along z, within a thousandth and a thousand times of the width."
#define SIDE_FIELD( key, member, side )                                                                              \
    {                                                                                                                \
        key, SCENE_NUMBER, .at = AT( member ), .range = SIZE, .unit = METRES, .help = side                           \
    }
#define VERTICES_FIELD( least, count, message )                                                                      \
    {                                                                                                                \
        "vertices", SCENE_WHOLE, .at = AT( vertex_count ), .range = COUNT( least ), .initial = count,                \
                                 .help = message                                                                     \
    }
#define SEED_FIELD                                                                                                   \
    {                                                                                                                \
        "seed", SCENE_SEED, .at = AT( seed ),                                                                        \
                            .help = "Seed of the positions of vertices; another seed is another mesh."               \
    }

static const scene_field PLANE_FIELDS[] = { SHAPE_FIELD, COLUMNS_FIELD, ROWS_FIELD, SPACING_FIELD };
static const scene_field IRREGULAR_FIELDS[] = {
    SHAPE_FIELD,
    COLUMNS_FIELD,
    ROWS_FIELD,
    SPACING_FIELD,
    VERTICES_FIELD( 4, "columns times rows",
                    "Number of vertices in all, within half and twice of columns times rows." ),
    { "jitter", SCENE_NUMBER, .at = AT( jitter ), .range = RANGE( 0, 0.2 ),
      .help = "Largest shift of a vertex in x and in z, in spacings." },
    SEED_FIELD,
};
static const scene_field DELAUNAY_FIELDS[] = { SHAPE_FIELD, SIDE_FIELD( "width", width, WIDTH ),
                                               SIDE_FIELD( "depth", depth, DEPTH ),
                                               VERTICES_FIELD( 4, NULL, "Number of vertices in all." ), SEED_FIELD };
static const scene_field GARMENT_FIELDS[] = { SHAPE_FIELD, SIDE_FIELD( "width", width, WIDTH ),
                                              SIDE_FIELD( "depth", depth, DEPTH ),
                                              VERTICES_FIELD( 64, NULL, "Number of vertices in all." ), SEED_FIELD };
static const scene_field LEVEL_FIELDS[] = {
    SHAPE_FIELD,
    { "level", SCENE_WHOLE, .at = AT( level ), .range = RANGE( 0, 10 ),
      .help = "Subdivision level n, with 10 * 4^n + 2 vertices." },
    RADIUS_FIELD,
};
static const scene_field SPHERE_FIELDS[] = { SHAPE_FIELD, SEGMENTS_FIELD,
                                             RINGS_FIELD( 2, "Rings from pole to pole." ), RADIUS_FIELD };
static const scene_field TORUS_FIELDS[] = {
    SHAPE_FIELD,
    SEGMENTS_FIELD,
    RINGS_FIELD( 3, "Rings around the tube." ),
    RADIUS_FIELD,
    { "tube_radius", SCENE_NUMBER, .at = AT( tube_radius ), .range = SIZE, .unit = METRES,
      .help = "Radius of the tube, smaller than `radius`." },
};
static const scene_field CAPSULE_FIELDS[] = {
    SHAPE_FIELD, SEGMENTS_FIELD, RINGS_FIELD( 1, "Rings of each cap, from pole to cylinder." ),
    ALONG_FIELD, RADIUS_FIELD,   LENGTH_FIELD
};
static const scene_field TUBE_FIELDS[] = {
    SHAPE_FIELD,
    SEGMENTS_FIELD,
    ALONG_FIELD,
    RADIUS_FIELD,
    { "lower_radius", SCENE_NUMBER, .at = AT( lower_radius ), .range = SIZE, .unit = METRES,
      .help = "Radius at the lower end, such as that of a skirt.", .initial = "`radius`" },
    LENGTH_FIELD,
};
#undef AT

const scene_block SCENE_MESH_BLOCKS[WISP_MESH_SHAPE_COUNT] = {
    [WISP_MESH_PLANE_REGULAR] = SCENE_BLOCK_ALONE( PLANE_FIELDS ),
    [WISP_MESH_PLANE_ALTERNATING] = SCENE_BLOCK_ALONE( PLANE_FIELDS ),
    [WISP_MESH_PLANE_IRREGULAR] = SCENE_BLOCK_ALONE( IRREGULAR_FIELDS ),
    [WISP_MESH_DELAUNAY] = SCENE_BLOCK_ALONE( DELAUNAY_FIELDS ),
    [WISP_MESH_GARMENT] = SCENE_BLOCK_ALONE( GARMENT_FIELDS ),
    [WISP_MESH_ICOSPHERE] = SCENE_BLOCK_ALONE( LEVEL_FIELDS ),
    [WISP_MESH_UV_SPHERE] = SCENE_BLOCK_ALONE( SPHERE_FIELDS ),
    [WISP_MESH_TORUS] = SCENE_BLOCK_ALONE( TORUS_FIELDS ),
    [WISP_MESH_CAPSULE] = SCENE_BLOCK_ALONE( CAPSULE_FIELDS ),
    [WISP_MESH_TUBE] = SCENE_BLOCK_ALONE( TUBE_FIELDS ),
    [WISP_MESH_PEAR] = SCENE_BLOCK_ALONE( LEVEL_FIELDS ),
};

int64_t scene_generator_vertices( const wisp_mesh_generator* generator )
{
    const int64_t columns = generator->columns, segments = generator->segments, rings = generator->rings;
    switch ( generator->shape )
    {
        case WISP_MESH_PLANE_IRREGULAR:
            return generator->vertex_count ? generator->vertex_count : columns * generator->rows;
        case WISP_MESH_DELAUNAY:
        case WISP_MESH_GARMENT:
            return generator->vertex_count;
        case WISP_MESH_ICOSPHERE:
        case WISP_MESH_PEAR:
            return 10 * ( (int64_t)1 << ( 2 * generator->level ) ) + 2;
        case WISP_MESH_UV_SPHERE:
            return segments * ( rings - 1 ) + 2;
        case WISP_MESH_TORUS:
            return segments * rings;
        case WISP_MESH_CAPSULE:
            return segments * ( 2 * rings + generator->length_segments - 1 ) + 2;
        case WISP_MESH_TUBE:
            return segments * ( (int64_t)generator->length_segments + 1 );
        default:
            return columns * generator->rows;
    }
}

static wisp_status check_generator( scene_reader* r, const text_node* node, const wisp_mesh_generator* generator )
{
    int64_t count = scene_generator_vertices( generator );
    if ( count > WISP_SCENE_MAX_VERTICES )
    {
        return scene_refuse_node( r, node, "got %lld vertices, expected at most %d", (long long)count,
                                  WISP_SCENE_MAX_VERTICES );
    }
    if ( generator->shape == WISP_MESH_TORUS && !( generator->tube_radius < generator->radius ) )
    {
        return scene_refuse_node( r, node, "got tube_radius %g, expected less than radius, %g",
                                  (double)generator->tube_radius, (double)generator->radius );
    }
    bool is_delaunay = generator->shape == WISP_MESH_DELAUNAY || generator->shape == WISP_MESH_GARMENT;
    // The same condition as in the generator, in the same arithmetic.
    if ( is_delaunay &&
         !( generator->depth >= generator->width / 1e3f && generator->depth <= generator->width * 1e3f ) )
    {
        return scene_refuse_node( r, node, "got depth %g, expected a thousandth to a thousand times width, %g",
                                  (double)generator->depth, (double)generator->width );
    }
    int64_t grid = (int64_t)generator->columns * generator->rows;
    if ( generator->shape == WISP_MESH_PLANE_IRREGULAR && generator->vertex_count != 0 &&
         ( generator->vertex_count / generator->rows < 2 || generator->vertex_count > 2 * grid ||
           2 * (int64_t)generator->vertex_count < grid ) )
    {
        return scene_refuse_node( r, node, "got %d vertices, expected half to twice of %d columns times %d rows",
                                  generator->vertex_count, generator->columns, generator->rows );
    }
    return WISP_OK;
}

wisp_status scene_read_mesh_generate( scene_reader* r, const text_node* node, void* at )
{
    wisp_scene_mesh* mesh = at;
    int shape = 0;
    WISP_TRY( scene_read_shape( r, node, SHAPES, &shape ) );
    mesh->is_generated = true;
    mesh->generator = wisp_default_mesh_generator( (wisp_mesh_shape)shape );
    WISP_TRY( scene_read_block( r, node, &SCENE_MESH_BLOCKS[shape], &mesh->generator ) );
    return check_generator( r, node, &mesh->generator );
}

// ---- repair and require ----

const scene_choice SCENE_REPAIR_WORDS[] = {
    { "weld", "merges vertices within `weld_distance` of an earlier one, and removes triangles that collapse" },
    { "degenerates", "removes triangles without area and triangles that name a vertex twice" },
    { "duplicates", "removes triangles with the same vertices as an earlier one" },
    { "winding",
      "turns triangles until neighbours agree; closed parts then face outwards, open ones the way of most" },
    { "flip", "turns all triangles over: a mesh that is inside out faces outwards then" },
    { "unreferenced", "removes vertices that no triangle names" },
    { NULL, NULL },
};

const scene_choice SCENE_REQUIRE_WORDS[] = {
    { "closed", "has no open edges: each edge belongs to an even number of triangles" },
    { "oriented", "neighbouring triangles have the same winding, and no closed part is inside out" },
    { "manifold", "no edge belongs to more than two triangles, no vertex to more than one fan of triangles" },
    { "clean", "has no duplicate or degenerate triangles and no unreferenced vertices" },
    { "one_component", "all triangles are connected" },
    { NULL, NULL },
};

const int SCENE_REPAIR_BITS[] = {
    WISP_MESH_WELD, WISP_MESH_DROP_DEGENERATES, WISP_MESH_DROP_DUPLICATES, WISP_MESH_TURN_TRIANGLES,
    WISP_MESH_FLIP, WISP_MESH_DROP_UNREFERENCED
};
const int SCENE_REQUIRE_BITS[] = { WISP_MESH_CLOSED, WISP_MESH_ORIENTED, WISP_MESH_MANIFOLD, WISP_MESH_CLEAN,
                                   WISP_MESH_ONE_COMPONENT };

wisp_status scene_check_weld( scene_reader* r, const text_node* node, const wisp_scene_mesh* mesh )
{
    const text_node* distance = text_find_path( node, "weld_distance" );
    return distance && ( mesh->repairs & WISP_MESH_WELD ) == 0
               ? scene_refuse_node( r, distance, "'weld_distance' needs 'repair: [weld]'" )
               : WISP_OK;
}

// ---- rotations ----

typedef struct rotation
{
    bool is_list, has_axis;
    wisp_vec3 axis;
    wisp_vec3 degrees; // x alone with an axis
} rotation;

#define AT( member ) offsetof( rotation, member )
#define TURN RANGE( -36000, 36000 )

static wisp_status read_degrees( scene_reader* r, const text_node* node, void* at )
{
    static const scene_field field = { "degrees", SCENE_VECTOR, .range = TURN, .unit = DEGREES };
    rotation* turn = at;
    turn->is_list = node->kind == TEXT_LIST;
    return turn->is_list ? scene_read_vector( r, node, &field, &turn->degrees )
                         : scene_read_number( r, node, &field, &turn->degrees.x );
}

static const scene_field ROTATION_FIELDS[] = {
    { "axis", SCENE_VECTOR, .at = AT( axis ), .range = COORDINATE, .given = AT( has_axis ),
      .help = "Axis of the rotation, for one angle.", .initial = "none" },
    { "degrees", SCENE_CUSTOM, .required = true, .read = read_degrees,
      .help = "Angle about the axis, or angles about the x axis, then y, then z, which stay fixed.",
      .form = "number or [x, y, z], degrees, -36000 .. 36000" },
};
#undef AT
const scene_block SCENE_ROTATION_BLOCK = SCENE_BLOCK_ALONE( ROTATION_FIELDS );

// Not the C library's sine: the same scene gives the same bits on every machine.
static wisp_quat turn_about( wisp_vec3 axis, float degrees )
{
    double length =
        sqrt( (double)axis.x * (double)axis.x + (double)axis.y * (double)axis.y + (double)axis.z * (double)axis.z );
    double turns = (double)degrees / 720.0;
    float sine = 0.0f, cosine = 1.0f;
    trig_sincos( 6.28318530717958648f * (float)( turns - floor( turns ) ), &sine, &cosine );
    double scale = (double)sine / length;
    wisp_quat q = { (float)( (double)axis.x * scale ), (float)( (double)axis.y * scale ),
                    (float)( (double)axis.z * scale ), cosine };
    return wisp_transform_make( q, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ).rotation;
}

// About the fixed axes x, then y, then z.
static wisp_quat quat_of_degrees( wisp_vec3 degrees )
{
    wisp_quat x = turn_about( ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f }, degrees.x );
    wisp_quat y = turn_about( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, degrees.y );
    wisp_quat z = turn_about( ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f }, degrees.z );
    return wisp_transform_make( wisp_quat_multiply( z, wisp_quat_multiply( y, x ) ),
                                ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } )
        .rotation;
}

wisp_status scene_read_rotation( scene_reader* r, const text_node* node, void* at )
{
    rotation turn = { 0 };
    WISP_TRY( scene_read_block( r, node, &SCENE_ROTATION_BLOCK, &turn ) );
    if ( turn.has_axis == turn.is_list )
    {
        return scene_refuse_node( r, node,
                                  turn.has_axis ? "got an axis and three angles, expected one angle"
                                                : "one angle needs the key 'axis'" );
    }
    wisp_quat* out = at;
    if ( turn.is_list )
    {
        *out = quat_of_degrees( turn.degrees );
        return WISP_OK;
    }
    if ( !( fabsf( turn.axis.x ) + fabsf( turn.axis.y ) + fabsf( turn.axis.z ) >= 1e-6f ) )
    {
        return scene_refuse_node( r, node, "the axis is zero" );
    }
    *out = turn_about( turn.axis, turn.degrees.x );
    return WISP_OK;
}

// ---- paths ----

#define AT( member ) offsetof( wisp_scene_pose, member )
#define TIME_FIELD                                                                                                   \
    {                                                                                                                \
        "time", SCENE_NUMBER, .required = true, .at = AT( time ), .range = TIME, .unit = SECONDS,                    \
                              .help = "Time; the times of a list rise."                                              \
    }

#define JUMP_FIELD                                                                                                   \
    {                                                                                                                \
        "jump", SCENE_SWITCH, .at = AT( jump ),                                                                      \
                              .help = "Whether the pose is reached at once: surface, strands or collider are "       \
                                      "teleported, meet nothing on the way, and keep their velocity relative to it." \
    }

static const scene_field PIN_POSE_FIELDS[] = {
    TIME_FIELD,
    { "translate", SCENE_VECTOR, .at = AT( pose.translation ), .range = COORDINATE, .unit = METRES,
      .help = "Displacement from the start.", .initial = "that of the keyframe before" },
    { "rotate", SCENE_CUSTOM, .at = AT( pose.rotation ), .read = scene_read_rotation,
      .help = "Rotation from the start.", .form = "rotation", .initial = "that of the keyframe before" },
    JUMP_FIELD,
};
static const scene_field POSITION_FIELDS[] = {
    TIME_FIELD,
    { "position", SCENE_VECTOR, .required = true, .at = AT( pose.translation ), .range = COORDINATE, .unit = METRES,
      .help = "Position." },
    { "rotation", SCENE_CUSTOM, .at = AT( pose.rotation ), .read = scene_read_rotation, .help = "Rotation.",
      .form = "rotation", .initial = "that of the keyframe before" },
    JUMP_FIELD,
};
#undef AT
const scene_block SCENE_PIN_POSE_BLOCK = SCENE_BLOCK_ALONE( PIN_POSE_FIELDS );
const scene_block SCENE_POSITION_BLOCK = SCENE_BLOCK_ALONE( POSITION_FIELDS );

// A turn that is not written is the one before.
static wisp_status read_pose( scene_reader* r, const text_node* node, int index, void* poses,
                              const scene_block* block, wisp_quat start )
{
    wisp_scene_pose* pose = (wisp_scene_pose*)poses + index;
    pose->pose = index > 0 ? pose[-1].pose : ( wisp_transform ){ .rotation = start };
    WISP_TRY( scene_read_block( r, node, block, pose ) );
    return index == 0 ? WISP_OK : scene_check_rises( r, node, pose[-1].time, pose->time );
}

static const wisp_quat STRAIGHT = { 0.0f, 0.0f, 0.0f, 1.0f };

static wisp_status read_pin_pose( scene_reader* r, const text_node* node, int index, void* poses )
{
    return read_pose( r, node, index, poses, &SCENE_PIN_POSE_BLOCK, STRAIGHT );
}

static wisp_status read_position( scene_reader* r, const text_node* node, int index, void* poses )
{
    return read_pose( r, node, index, poses, &SCENE_POSITION_BLOCK, STRAIGHT );
}

static wisp_status read_collider_pose( scene_reader* r, const text_node* node, int index, void* poses )
{
    const wisp_scene_collider* collider = r->entry;
    return read_pose( r, node, index, poses, &SCENE_POSITION_BLOCK, collider->def.pose.rotation );
}

#define PATH( ... )                                                                                                  \
    {                                                                                                                \
        .what = "a list of keyframes", .size = sizeof( wisp_scene_pose ), .read = __VA_ARGS__                        \
    }
const scene_list SCENE_PIN_PATH = PATH( read_pin_pose );
const scene_list SCENE_TIPS_PATH = PATH( read_position );
const scene_list SCENE_HEAD_PATH = PATH( read_position, .empty = "got an empty list, expected keyframes" );
const scene_list SCENE_COLLIDER_PATH = PATH( read_collider_pose );
