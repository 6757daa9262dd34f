// Values of strands: how they are generated, dynamics, environment, words of `compute`.
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

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

wisp_status scene_read_generate( scene_reader* r, const text_node* node, void* base )
{
    wisp_scene_strands* strands = base;
    strands->is_generated = true;

    // Defaults depend on shape and dimension, which may stand anywhere in the mapping: the first reading learns these
    // two, the second reads everything over their defaults.
    wisp_groom_generator* generator = &strands->generator;
    WISP_TRY( scene_read_block( r, node, &SCENE_GENERATE_BLOCK, generator ) );
    *generator = wisp_default_groom_generator( generator->shape, generator->dimension );
    WISP_TRY( scene_read_block( r, node, &SCENE_GENERATE_BLOCK, generator ) );
    return scene_made_vertices( strands ) <= WISP_GROOM_MAX_GENERATED
               ? WISP_OK
               : scene_refuse_node( r, node, "got %d strands of %d vertices, expected at most %d vertices in all",
                                    generator->strand_count, generator->vertices_per_strand,
                                    WISP_GROOM_MAX_GENERATED );
}

// ---- dynamics ----

int64_t scene_made_vertices( const wisp_scene_strands* strands )
{
    return (int64_t)strands->generator.strand_count * strands->generator.vertices_per_strand;
}

// How many vertices there are is known if the strands are made.
static wisp_status read_pin( scene_reader* r, const text_node* node, int index, void* vertices )
{
    static const scene_field field = { "vertex", SCENE_WHOLE, .range = RANGE( 0, 2147483647 ) };
    const wisp_scene_strands* strands = r->entry;
    int32_t* vertex = (int32_t*)vertices + index;
    WISP_TRY( scene_read_whole( r, node, &field, vertex ) );
    return scene_check_vertex( r, node, *vertex, strands->is_generated, scene_made_vertices( strands ), NULL );
}

const scene_list SCENE_STRAND_PINS = { .what = "a list of vertices", .size = sizeof( int32_t ), .read = read_pin };

static wisp_status check_masses( scene_reader* r, const text_node* node, void* at )
{
    const wisp_scene_strands* strands = at;
    return strands->is_generated && node->count != scene_made_vertices( strands )
               ? scene_refuse_node( r, node, "got %d masses, expected one per vertex", node->count )
               : WISP_OK;
}

static const scene_field MASS = { "mass", SCENE_NUMBER, .range = ANY_MASS, .unit = MASSES };
const scene_list SCENE_VERTEX_MASSES = { .what = "a list of masses, one per vertex",
                                         .size = sizeof( float ),
                                         .each = &MASS,
                                         .finish = check_masses,
                                         .empty = "got 0 masses, expected one per vertex" };

// ---- environment ----

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

static wisp_status read_control_point( scene_reader* r, const text_node* node, int i, void* at )
{
    wisp_environment_def* environment = at;
    static const scene_field pair[2] = { { "ice", SCENE_NUMBER, .range = { 0, 1 } },
                                         { "stiffness", SCENE_NUMBER, .range = { 1e-3, 1e12 } } };
    WISP_TRY( scene_read_pair( r, node, "a pair [ice, stiffness]", pair, &environment->ice[i],
                               &environment->stiffness[i] ) );
    bool last = i + 1 == environment->point_count;
    bool rises = i == 0 ? environment->ice[i] == 0.0f : environment->ice[i] > environment->ice[i - 1];
    if ( !rises || ( last && environment->ice[i] != 1.0f ) )
    {
        return scene_refuse_node( r, text_first( node ), "ice must rise from 0 at the first point to 1 at the last" );
    }
    return i > 0 && turns_back( environment, i )
               ? scene_refuse_node( r, node, "stiffness must rise or fall throughout" )
               : WISP_OK;
}

wisp_status scene_read_curve( scene_reader* r, const text_node* node, void* base )
{
    wisp_environment_def* environment = &( (wisp_scene_strands*)base )->environment;
    WISP_TRY( scene_expect_list( r, node, "a list of pairs [ice, stiffness]" ) );
    if ( node->count < 2 || node->count > WISP_ENVIRONMENT_MAX_POINTS )
    {
        return scene_refuse_node( r, node, "got %d points, expected 2 to %d", node->count,
                                  WISP_ENVIRONMENT_MAX_POINTS );
    }
    environment->point_count = node->count;
    return scene_read_items( r, node, read_control_point, environment );
}
