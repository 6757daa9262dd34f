#include "scene_parts.h"
#include "io_file.h"

#include <string.h>

// ---- where strands come from ----

static bool is_name( const char* text )
{
    size_t length = 0;
    for ( ; text[length] && length <= WISP_SCENE_MAX_NAME; ++length )
    {
        char c = text[length];
        bool letter = ( c >= 'a' && c <= 'z' ) || ( c >= 'A' && c <= 'Z' );
        if ( !letter && !( c >= '0' && c <= '9' ) && c != '_' && c != '-' )
        {
            return false;
        }
    }
    return length > 0 && length <= WISP_SCENE_MAX_NAME;
}

wisp_status scene_read_name( scene_reader* r, const scene_node* node, void* at )
{
    const char* name = NULL;
    wisp_status status = scene_read_text( r, node, &name );
    if ( !status && !is_name( name ) )
    {
        return scene_refuse_node( r, node, "got '%s', expected 1 to %d of the characters A-Z a-z 0-9 _ -",
                                  scene_shorten( name ).text, WISP_SCENE_MAX_NAME );
    }
    *(const char**)at = name;
    return status;
}

// Relative files are relative to the folder of the scene, not to the working directory.
wisp_status scene_read_file( scene_reader* r, const scene_node* node, void* at )
{
    const char* file = NULL;
    wisp_status status = scene_read_text( r, node, &file );
    *(const char**)at = file;
    const char* slash = strrchr( r->source->name, '/' );
    if ( status || !slash || file[0] == '/' )
    {
        return status;
    }
    size_t folder = (size_t)( slash - r->source->name ) + 1;
    size_t length = strlen( file );
    char* path = scene_take( r->scene, folder + length + 1, 1 );
    if ( !path )
    {
        return scene_no_memory( r );
    }
    memcpy( path, r->source->name, folder );
    memcpy( path + folder, file, length );
    *(const char**)at = path;
    return WISP_OK;
}

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

// ---- environment and output ----

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
wisp_status scene_read_request( scene_reader* r, const scene_node* node, void* base )
{
    enum
    {
        OF_LOOK = 1,
        OF_DYNAMICS = 3,
        OF_COLLISION = 6,
    };
    wisp_scene_strands* s = base;
    bool* const requests[] = { &s->request_points, &s->request_width,        &s->request_colour,  &s->request_strain,
                               &s->request_speed,  &s->request_motion_stats, &s->request_contacts };

    wisp_status status = scene_expect_list( r, node, "a list of words" );
    int i = 0;
    for ( const scene_node* item = scene_first( r->tree, node ); item && !status; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, i++ );
        int word = 0;
        status = scene_read_choice( r, item, SCENE_STRANDS_WORDS, &word );
        if ( !status && *requests[word] )
        {
            return scene_refuse_node( r, item, "'%s' is listed twice", SCENE_STRANDS_WORDS[word].word );
        }
        if ( !status && word >= OF_LOOK && word < OF_DYNAMICS && !s->has_appearance )
        {
            return scene_refuse_node( r, item, "'%s' needs the key 'appearance'", SCENE_STRANDS_WORDS[word].word );
        }
        const bool moves = s->has_dynamics || ( word >= OF_COLLISION && s->has_ghosts );
        if ( !status && word >= OF_DYNAMICS && !moves )
        {
            return scene_refuse_node( r, item, "'%s' needs the key 'dynamics'", SCENE_STRANDS_WORDS[word].word );
        }
        if ( !status && word >= OF_COLLISION && !s->has_collision )
        {
            return scene_refuse_node( r, item, "'%s' needs the key 'collision'", SCENE_STRANDS_WORDS[word].word );
        }
        if ( !status )
        {
            *requests[word] = true;
            scene_leave( r, outside );
        }
    }
    return status;
}

// ---- the list ----

wisp_scene_strands scene_default_strands( wisp_vec3 gravity )
{
    wisp_scene_strands strands = {
        .generator = wisp_default_groom_generator( WISP_GROOM_STRAIGHT, 3 ),
        .scatter = { .around = -1, .count = 1, .seed = 1 },
        .curves = wisp_default_curves_def(),
        .curves_of = -1,
        .scale = 1.0f,
        .pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } },
        .frozen_hair = wisp_default_frozen_hair_def(),
        .environment = wisp_default_environment_def(),
        .appearance = wisp_default_strand_appearance_def(),
        .dynamics = wisp_default_strand_dynamics_def(),
        .grid = wisp_default_strand_grid_def(),
        .collision = wisp_default_collision_def(),
        .contact = wisp_default_contact_def(),
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

static wisp_status read_entry( scene_reader* r, const scene_node* node, wisp_scene_strands* strands )
{
    *strands = scene_default_strands( r->scene->gravity );
    strands->line = node->line;
    strands->column = node->column;
    // Ghosts move in every step, so frozen hair on them follows in every step.
    if ( scene_child( r, node, "ghosts" ) )
    {
        strands->frozen_hair.update_on = WISP_FROZEN_UPDATE_FRAME;
    }
    wisp_status status = scene_read_block( r, node, &SCENE_STRANDS_BLOCK, strands );
    return status ? status : scene_check_strands( r, node, strands );
}

wisp_status scene_read_strands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene* scene = base;
    wisp_status status = scene_expect_list( r, node, "a list of strands" );
    if ( status || node->count == 0 )
    {
        return status;
    }
    if ( node->count > WISP_SCENE_MAX_STRANDS )
    {
        return scene_refuse_node( r, node, "got %d entries, expected at most %d", node->count,
                                  WISP_SCENE_MAX_STRANDS );
    }
    scene->strands = scene_take( scene, (size_t)node->count, sizeof *scene->strands );
    if ( !scene->strands )
    {
        return scene_no_memory( r );
    }
    for ( const scene_node* item = scene_first( r->tree, node ); item; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, scene->strands_count );
        status = read_entry( r, item, &scene->strands[scene->strands_count] );
        if ( status )
        {
            return status;
        }
        scene->strands_count++;
        scene_leave( r, outside );
    }
    status = scene_register( r, SCENE_STRANDS, scene->strands, sizeof *scene->strands, scene->strands_count );
    return status ? status : scene_bind_strands( r, node );
}
