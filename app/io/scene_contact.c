// Boundary particles and contact: their tables, of surfaces, of strands and of the scene, and what no table can say.
#include "scene_parts.h"
#include "scene_ranges.h"

#include <stddef.h>

#define BLOCK( fields )                                                                                              \
    {                                                                                                                \
        fields, WISP_COUNT( fields )                                                                                 \
    }

// ---- boundary particles of a surface ----

#define BOUNDARY( member ) offsetof( wisp_scene_surface, boundary.member )

static const char* const POLICIES[] = { "even", "exact", NULL };
static const char* const ROUNDINGS[] = { "down", "nearest", "up", NULL };

static const scene_field BOUNDARY_FIELDS[] = {
    { "spacing", SCENE_NUMBER, .at = BOUNDARY( spacing ), .range = SIZE, .unit = METRES },
    { "policy", SCENE_CHOICE, .at = BOUNDARY( policy ), .choices = POLICIES },
    { "rounding", SCENE_CHOICE, .at = BOUNDARY( rounding ), .choices = ROUNDINGS },
    { "scanline_normals", SCENE_SWITCH, .at = BOUNDARY( scanline_normals ) },
    { "hysteresis", SCENE_NUMBER, .at = BOUNDARY( hysteresis ), .range = RANGE( 0, 0.5 ) },
    { "max_points", SCENE_WHOLE, .at = BOUNDARY( limit ), .range = RANGE( 1, 134217728 ) },
    { "min_spacing", SCENE_NUMBER, .at = BOUNDARY( least_spacing ), .range = SIZE, .unit = METRES },
    { "max_spacing", SCENE_NUMBER, .at = BOUNDARY( most_spacing ), .range = SIZE, .unit = METRES },
    { "curvature_gain", SCENE_NUMBER, .at = BOUNDARY( curvature_gain ), .range = RANGE( 0, 1e6 ) },
    { "strain_gain", SCENE_NUMBER, .at = BOUNDARY( strain_gain ), .range = RANGE( -1e6, 1e6 ) },
    { "by_screen", SCENE_SWITCH, .at = BOUNDARY( by_screen ) },
    { "eye", SCENE_VECTOR, .at = BOUNDARY( eye ), .range = COORDINATE, .unit = METRES },
    { "pixel_angle", SCENE_NUMBER, .at = BOUNDARY( pixel_angle ), .range = RANGE( 1e-6, 1 ), .unit = RADIANS },
    { "pixels", SCENE_NUMBER, .at = BOUNDARY( pixels ), .range = RANGE( 1e-3, 1e6 ) },
};
const scene_block SCENE_BOUNDARY_BLOCK = BLOCK( BOUNDARY_FIELDS );

// What is left out depends on the mesh; the module compares it with what is written.
wisp_status scene_check_boundary( scene_reader* r, const scene_node* node, const wisp_scene_surface* s )
{
    static const char* const screen_keys[] = { "eye", "pixel_angle", "pixels" };
    const wisp_boundary_def* b = &s->boundary;
    const scene_node* block = scene_child( r, node, "boundary" );
    for ( int i = 0; i < WISP_COUNT( screen_keys ) && !b->by_screen; ++i )
    {
        const scene_node* child = scene_child( r, block, screen_keys[i] );
        if ( child )
        {
            return scene_refuse_node( r, child, "boundary.%s is of a layer with 'by_screen: true'", screen_keys[i] );
        }
    }
    if ( b->most_spacing > 0.0f && b->least_spacing > b->most_spacing )
    {
        return scene_refuse_node( r, node, "boundary.min_spacing is %g, above boundary.max_spacing, which is %g",
                                  (double)b->least_spacing, (double)b->most_spacing );
    }
    return WISP_OK;
}

// ---- participants of contact ----

// Strands never meet themselves, so theirs is the same table without `self`.
#define GUEST_FIELDS( owner )                                                                                        \
    { "thickness", SCENE_NUMBER, .at = offsetof( owner, contact.thickness ), .range = RANGE( 0, 1e6 ),               \
      .unit = METRES },                                                                                              \
        { "friction", SCENE_NUMBER, .at = offsetof( owner, contact.friction ), .range = RANGE( 0, 1e6 ) },           \
        { "max_push_out_speed", SCENE_NUMBER, .at = offsetof( owner, contact.recovery_speed ),                       \
          .range = RANGE( 0, 1e6 ), .unit = SPEEDS },                                                                \
        { "layers", SCENE_CUSTOM, .at = offsetof( owner, contact.layers ), .read = scene_read_layers },              \
        { "mask", SCENE_CUSTOM, .at = offsetof( owner, contact.mask ), .read = scene_read_layers },                  \
    {                                                                                                                \
        "enabled", SCENE_SWITCH, .at = offsetof( owner, contact.enabled )                                            \
    }

static const scene_field SURFACE_FIELDS[] = {
    GUEST_FIELDS( wisp_scene_surface ),
    { "self", SCENE_SWITCH, .at = offsetof( wisp_scene_surface, contact.self ) },
};
const scene_block SCENE_CONTACT_BLOCK = BLOCK( SURFACE_FIELDS );

static const scene_field STRANDS_FIELDS[] = { GUEST_FIELDS( wisp_scene_strands ) };
const scene_block SCENE_STRAND_CONTACT_BLOCK = BLOCK( STRANDS_FIELDS );

// ---- contact of the scene ----

#define CONTACT( member ) offsetof( wisp_scene, contact.member )

static const char* const FEATURES[] = { "triangles", "particles", NULL };
static const char* const SEARCHES[] = { "auto", "grid", "tree", "brute", NULL };

static wisp_status read_wants( scene_reader* r, const scene_node* node, void* at )
{
    static const char* const words[] = { "stats", "intersections", NULL };
    wisp_scene* scene = at;
    bool* const wants[] = { &scene->want_contact_figures, &scene->want_crossings };
    wisp_status status = scene_expect_list( r, node, "a list of words" );
    int i = 0;
    for ( const scene_node* item = scene_first( r->tree, node ); item && !status; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, i++ );
        int word = 0;
        status = scene_read_choice( r, item, words, &word );
        if ( !status && *wants[word] )
        {
            return scene_refuse_node( r, item, "'%s' is listed twice", words[word] );
        }
        if ( !status )
        {
            *wants[word] = true;
            scene_leave( r, outside );
        }
    }
    return status;
}

static const scene_field WORLD_FIELDS[] = {
    { "primitives", SCENE_CHOICE, .at = CONTACT( features ), .choices = FEATURES },
    { "search", SCENE_CHOICE, .at = CONTACT( search ), .choices = SEARCHES },
    { "particle_spacing", SCENE_NUMBER, .at = CONTACT( sample_spacing ), .range = SIZE, .unit = METRES },
    { "margin", SCENE_NUMBER, .at = CONTACT( margin ), .range = RANGE( 0.01, 100 ) },
    { "displacement_limit", SCENE_SWITCH, .at = CONTACT( guard ) },
    { "compute", SCENE_CUSTOM, .read = read_wants },
};
static const scene_block WORLD_BLOCK = BLOCK( WORLD_FIELDS );

// A key that the other way to find contacts has no use for is refused, as sizes of other shapes are.
static wisp_status check_features( scene_reader* r, const scene_node* node, const wisp_contact_settings* settings )
{
    const bool exact = settings->features == WISP_CONTACT_EXACT;
    const char* const key = exact ? "particle_spacing" : "displacement_limit";
    const scene_node* child = scene_child( r, node, key );
    return child ? scene_refuse_node( r, child, "'%s' is of contact with 'primitives: %s'", key,
                                      exact ? "particles" : "triangles" )
                 : WISP_OK;
}

wisp_status scene_read_contact( scene_reader* r, const scene_node* node, void* at )
{
    wisp_scene* scene = at;
    wisp_status status = scene_read_block( r, node, &WORLD_BLOCK, scene );
    scene->has_contact = status == WISP_OK;
    return status ? status : check_features( r, node, &scene->contact );
}
