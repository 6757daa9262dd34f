// Values of strands: how they are generated, dynamics, environment, words of `compute`.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>

// ---- generate ----

#define AT( member ) offsetof( wisp_groom_generator, member )
#define SMALLEST 1e-6
#define FARTHEST ( (double)WISP_GROOM_MAX_COORDINATE )

static const scene_choice SHAPES[] = { { "straight", "a straight line" },
                                       { "wavy", "waves in a plane" },
                                       { "curly", "a helix" },
                                       { "ring", "a ring that touches its root, for `dynamics.closed`" },
                                       { NULL, NULL } };

static const scene_field MAKE_FIELDS[] = {
    { "shape", SCENE_CHOICE, .at = AT( shape ), .choices = SHAPES,
      .help = "Shape of a strand; defaults of other keys depend on it." },
    { "dimension", SCENE_WHOLE, .at = AT( dimension ), .range = RANGE( 2, 3 ),
      .help = "2 sets roots on a line with z = 0; 3 sets them on a head; defaults of other keys depend on it." },
    { "strands", SCENE_WHOLE, .at = AT( strand_count ), .range = RANGE( 1, WISP_GROOM_MAX_GENERATED / 2 ),
      .help = "Number of strands; strands times vertices is at most 134217728." },
    { "vertices", SCENE_WHOLE, .at = AT( vertices_per_strand ), .range = RANGE( 2, WISP_GROOM_MAX_GENERATED ),
      .help = "Number of vertices of each strand." },
    { "length", SCENE_NUMBER, .at = AT( length ), .range = RANGE( SMALLEST, FARTHEST ), .unit = METRES,
      .help = "Length of the centre line of a strand." },
    { "spacing", SCENE_NUMBER, .at = AT( spacing ), .range = RANGE( 0, FARTHEST ), .unit = METRES,
      .help = "Distance between neighbouring roots, in two dimensions." },
    { "scalp_radius", SCENE_NUMBER, .at = AT( scalp_radius ), .range = RANGE( SMALLEST, FARTHEST ), .unit = METRES,
      .help = "Radius of the head that the roots are on, in three dimensions." },
    { "wave_amplitude", SCENE_NUMBER, .at = AT( wave_amplitude ), .range = RANGE( 0, FARTHEST ), .unit = METRES,
      .help = "Sideways amplitude of waves and curls; a straight strand has none." },
    { "wave_length", SCENE_NUMBER, .at = AT( wave_length ), .range = RANGE( SMALLEST, FARTHEST ), .unit = METRES,
      .help = "Length of a wave along the centre line, at least length / 10000; a straight strand has none." },
    { "length_variation", SCENE_NUMBER, .at = AT( length_variation ), .range = RANGE( 0, 0.99 ),
      .help = "With the value v, lengths lie between length (1 - v) and length (1 + v)." },
    { "diameter", SCENE_NUMBER, .at = AT( thickness ), .range = RANGE( 0, FARTHEST ), .unit = METRES,
      .help = "Diameter that is stored with every vertex; 0 stores none." },
    { "seed", SCENE_SEED, .at = AT( seed ), .help = "Seed of lengths and phases." },
};
#undef AT

const scene_block SCENE_GENERATE_BLOCK = SCENE_BLOCK_ALONE( MAKE_FIELDS );

wisp_status scene_read_generate( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_strands* strands = base;
    strands->is_generated = true;

    // Defaults depend on shape and dimension, which may stand anywhere in the mapping: the first reading learns these
    // two, the second reads everything over their defaults.
    wisp_groom_generator* generator = &strands->generator;
    wisp_status status = scene_read_block( r, node, &SCENE_GENERATE_BLOCK, generator );
    if ( status )
    {
        return status;
    }
    *generator = wisp_default_groom_generator( generator->shape, generator->dimension );
    status = scene_read_block( r, node, &SCENE_GENERATE_BLOCK, generator );

    if ( !status && (int64_t)generator->strand_count * generator->vertices_per_strand > WISP_GROOM_MAX_GENERATED )
    {
        return scene_refuse_node( r, node, "got %d strands of %d vertices, expected at most %d vertices in all",
                                  generator->strand_count, generator->vertices_per_strand, WISP_GROOM_MAX_GENERATED );
    }
    return status;
}

// ---- dynamics ----

int64_t scene_made_vertices( const wisp_scene_strands* strands )
{
    return (int64_t)strands->generator.strand_count * strands->generator.vertices_per_strand;
}

typedef struct strand_pins
{
    const wisp_scene_strands* strands;
    int32_t* out;
} strand_pins;

// How many vertices there are is known if the strands are made.
static wisp_status read_pin( scene_reader* r, const scene_node* node, int index, void* context )
{
    static const scene_field field = { "vertex", SCENE_WHOLE, .range = RANGE( 0, 2147483647 ) };
    const strand_pins* pins = context;
    const int64_t count = scene_made_vertices( pins->strands );
    int vertex = 0;
    wisp_status status = scene_read_whole( r, node, &field, &vertex );
    if ( !status && pins->strands->is_generated && vertex >= count )
    {
        return scene_refuse_node( r, node, "got vertex %d, expected 0 .. %lld", vertex, (long long)( count - 1 ) );
    }
    pins->out[index] = vertex;
    return status;
}

wisp_status scene_read_strand_pins( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene_strands* strands = at;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of vertices", SCENE_MAX_NODES, sizeof( int32_t ), &items );
    strand_pins pins = { strands, items };
    strands->dynamics.pins = items;
    strands->dynamics.pin_count = status ? 0 : node->count;
    return status ? status : scene_read_items( r, node, read_pin, &pins );
}

wisp_status scene_read_vertex_masses( scene_reader* r, const scene_node* node, void* at )
{
    static const scene_field mass = { "mass", SCENE_NUMBER, .range = ANY_MASS, .unit = MASSES };
    wisp_scene_strands* strands = at;
    void* items;
    wisp_status status =
        scene_begin_list( r, node, "a list of masses, one per vertex", SCENE_MAX_NODES, sizeof( float ), &items );
    if ( !status && ( !items || ( strands->is_generated && node->count != scene_made_vertices( strands ) ) ) )
    {
        return scene_refuse_node( r, node, "got %d masses, expected one per vertex", node->count );
    }
    strands->dynamics.vertex_masses = items;
    strands->mass_count = node->count;
    return status ? status : scene_read_numbers( r, node, &mass, items );
}

wisp_status scene_read_head_path( scene_reader* r, const scene_node* node, void* at )
{
    const wisp_quat straight = { 0.0f, 0.0f, 0.0f, 1.0f };
    wisp_scene_strands* strands = at;
    wisp_status status = scene_read_positions( r, node, straight, &strands->head );
    if ( !status && strands->head.count == 0 )
    {
        return scene_refuse_node( r, node, "got an empty list, expected keyframes" );
    }
    return status;
}

wisp_status scene_read_tips_path( scene_reader* r, const scene_node* node, void* at )
{
    const wisp_quat straight = { 0.0f, 0.0f, 0.0f, 1.0f };
    wisp_scene_strands* strands = at;
    return scene_read_positions( r, node, straight, &strands->tips_path );
}

// ---- environment ----

static wisp_status read_control_point( scene_reader* r, const scene_node* node, wisp_environment_def* environment,
                                       int i )
{
    static const scene_field ice = { "ice", SCENE_NUMBER, .range = { 0, 1 } };
    static const scene_field stiffness = { "stiffness", SCENE_NUMBER, .range = { 1e-3, 1e12 } };
    wisp_status status = scene_expect_pair( r, node, "a pair [ice, stiffness]" );
    const scene_node* first = scene_first( r->tree, node );
    status = status ? status : scene_read_number( r, first, &ice, &environment->ice[i] );
    if ( !status )
    {
        status = scene_read_number( r, scene_next( r->tree, first ), &stiffness, &environment->stiffness[i] );
    }
    if ( status )
    {
        return status;
    }
    bool last = i + 1 == environment->point_count;
    bool rises = i == 0 ? environment->ice[i] == 0.0f : environment->ice[i] > environment->ice[i - 1];
    if ( !rises || ( last && environment->ice[i] != 1.0f ) )
    {
        return scene_refuse_node( r, first, "ice must rise from 0 at the first point to 1 at the last" );
    }
    return WISP_OK;
}

// Stiffness may rise or fall, but not both: colder or wetter hair must not turn back.
static bool turns_back( const wisp_environment_def* environment, int i )
{
    float step = environment->stiffness[i] - environment->stiffness[i - 1];
    for ( int k = 1; k < i; ++k )
    {
        float before = environment->stiffness[k] - environment->stiffness[k - 1];
        if ( ( before < 0.0f && step > 0.0f ) || ( before > 0.0f && step < 0.0f ) )
        {
            return true;
        }
    }
    return false;
}

wisp_status scene_read_curve( scene_reader* r, const scene_node* node, void* base )
{
    wisp_environment_def* environment = &( (wisp_scene_strands*)base )->environment;
    wisp_status status = scene_expect_list( r, node, "a list of pairs [ice, stiffness]" );
    if ( status )
    {
        return status;
    }
    if ( node->count < 2 || node->count > WISP_ENVIRONMENT_MAX_POINTS )
    {
        return scene_refuse_node( r, node, "got %d points, expected 2 to %d", node->count,
                                  WISP_ENVIRONMENT_MAX_POINTS );
    }
    environment->point_count = node->count;
    const scene_node* point = scene_first( r->tree, node );
    for ( int i = 0; i < node->count; ++i, point = scene_next( r->tree, point ) )
    {
        size_t outside = scene_enter_index( r, i );
        status = read_control_point( r, point, environment, i );
        if ( status )
        {
            return status;
        }
        if ( i > 0 && turns_back( environment, i ) )
        {
            return scene_refuse_node( r, point, "stiffness must rise or fall throughout" );
        }
        scene_leave( r, outside );
    }
    return WISP_OK;
}

// ---- compute ----

const scene_choice SCENE_STRANDS_WORDS[] = {
    { "points", "positions" },
    { "width", "width of each vertex; needs `appearance`" },
    { "colour", "colour of each vertex; needs `appearance`" },
    { "strain", "relative error of the length of each segment; needs `dynamics`" },
    { "speed", "speed of each vertex; needs `dynamics`" },
    { "motion_stats", "mass, momentum, energy, largest strain and speed; needs `dynamics`" },
    { "collision_stats", "largest penetration and number of contacts; needs `collision`" },
    { NULL, NULL },
};

// Words from OF_LOOK on need a look, those from OF_DYNAMICS on a motion, those from OF_COLLISION on a collision
// too, which ghosts can have without a motion of their own.
static wisp_status check_word( scene_reader* r, const scene_node* item, int word, const void* entry )
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
    return lacks ? scene_refuse_node( r, item, "'%s' needs the key '%s'", SCENE_STRANDS_WORDS[word].word, lacks )
                 : WISP_OK;
}

wisp_status scene_read_request( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_strands* s = base;
    bool* const requests[] = { &s->request_points, &s->request_width,        &s->request_colour,  &s->request_strain,
                               &s->request_speed,  &s->request_motion_stats, &s->request_contacts };
    return scene_read_words( r, node, SCENE_STRANDS_WORDS, requests, check_word, s );
}
