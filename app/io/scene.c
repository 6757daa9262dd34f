#include "scene.h"
#include "io_file.h"
#include "scene_parts.h"

#include <stdlib.h>
#include <string.h>

// ---- hair events ----

wisp_status scene_read_command_strands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_hair_event* command = base;
    wisp_status status = scene_read_named( r, node, SCENE_STRANDS, &command->strands );
    if ( !status && !r->scene->strands[command->strands].has_frozen_hair )
    {
        return scene_refuse_node( r, node, "got '%s', expected strands with the key 'frozen_hair'",
                                  r->scene->strands[command->strands].name );
    }
    return status;
}

// Places rise with the file, so equals keep their order, which qsort does not promise.
static int compare_commands( const void* a, const void* b )
{
    const wisp_scene_hair_event *x = a, *y = b;
    int order = ( x->step > y->step ) - ( x->step < y->step );
    order = order ? order : ( x->strands > y->strands ) - ( x->strands < y->strands );
    order = order ? order : ( x->line > y->line ) - ( x->line < y->line );
    return order ? order : ( x->column > y->column ) - ( x->column < y->column );
}

static wisp_status read_command( scene_reader* r, const scene_node* node, wisp_scene_hair_event* command )
{
    command->line = node->line;
    command->column = node->column;
    wisp_status status = scene_read_block( r, node, &SCENE_COMMAND_BLOCK, command );
    if ( !status && command->step >= r->scene->steps )
    {
        return scene_refuse_node( r, node, "got step %d, expected a step below %d, the number of steps",
                                  command->step, r->scene->steps );
    }
    return status;
}

wisp_status scene_read_commands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene* scene = base;
    wisp_status status = scene_expect_list( r, node, "a list of hair events" );
    if ( status || node->count == 0 )
    {
        return status;
    }
    scene->commands = scene_take( scene, (size_t)node->count, sizeof *scene->commands );
    if ( !scene->commands )
    {
        return scene_no_memory( r );
    }
    for ( const scene_node* item = scene_first( r->tree, node ); item; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, scene->command_count );
        status = read_command( r, item, &scene->commands[scene->command_count++] );
        if ( status )
        {
            return status;
        }
        scene_leave( r, outside );
    }

    // Sort by step, as the program reads them. Of two entries for one step the first would have no effect.
    qsort( scene->commands, (size_t)scene->command_count, sizeof *scene->commands, compare_commands );
    for ( int i = 1; i < scene->command_count; ++i )
    {
        const wisp_scene_hair_event *c = &scene->commands[i], *before = c - 1;
        if ( c->step == before->step && c->strands == before->strands )
        {
            return scene_refuse( r->source, c->line, c->column, r->path,
                                 "got a second entry of strands '%s' for step %d, the first is in line %d",
                                 scene->strands[c->strands].name, c->step, before->line );
        }
    }
    return WISP_OK;
}

// ---- output ----

wisp_status scene_read_output_strands( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_output* output = base;
    wisp_status status = scene_read_named( r, node, SCENE_STRANDS, &output->strands );
    if ( !status )
    {
        r->scene->strands[output->strands].request_points = true;
    }
    return status;
}

wisp_status scene_read_output_surface( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene_output* output = base;
    wisp_status status = scene_read_named( r, node, SCENE_SURFACE, &output->surface );
    if ( !status )
    {
        r->scene->surfaces[output->surface].request_points = true;
    }
    return status;
}

static bool ends_in( const char* file, const char* const* extensions )
{
    const char* slash = strrchr( file, '/' );
    const char* last = slash ? slash + 1 : file;
    const char* dot = strrchr( last, '.' );
    for ( int i = 0; dot && dot > last && extensions[i]; ++i )
    {
        if ( strcmp( dot, extensions[i] ) == 0 )
        {
            return true;
        }
    }
    return false;
}

// `strands` and `surface` stand before `file` in the table, because they decide which formats are possible.
wisp_status scene_read_output_file( scene_reader* r, const scene_node* node, void* base )
{
    static const char* const of_strands[] = { ".hair", ".usda", ".obj", NULL };
    static const char* const of_surfaces[] = { ".obj", ".ply", NULL };
    wisp_scene_output* output = base;
    const bool is_surface = output->surface >= 0;
    wisp_status status = scene_read_text( r, node, &output->file );
    if ( !status && !ends_in( output->file, is_surface ? of_surfaces : of_strands ) )
    {
        return scene_refuse_node( r, node, "got '%s', expected a file that ends in %s",
                                  scene_shorten( output->file ).text,
                                  is_surface ? ".obj or .ply" : ".hair, .usda or .obj" );
    }
    return status;
}

static wisp_status read_output( scene_reader* r, const scene_node* node, wisp_scene_output* output )
{
    *output = ( wisp_scene_output ){ .strands = -1, .surface = -1, .line = node->line, .column = node->column };
    wisp_status status = scene_read_block( r, node, &SCENE_OUTPUT_BLOCK, output );
    if ( !status && ( output->strands >= 0 ) == ( output->surface >= 0 ) )
    {
        return scene_refuse_node( r, node,
                                  output->strands >= 0
                                      ? "got both 'strands' and 'surface', expected one of them"
                                      : "got neither 'strands' nor 'surface', expected one of them" );
    }
    return status;
}

static int compare_files( const void* a, const void* b )
{
    const wisp_scene_output *const *x = a, *const *y = b;
    int order = strcmp( ( *x )->file, ( *y )->file );
    return order ? order : ( *x > *y ) - ( *x < *y );
}

static wisp_status refuse_equal_files( scene_reader* r )
{
    wisp_scene* scene = r->scene;
    size_t count = (size_t)scene->output_count;
    const wisp_scene_output** sorted = scene_take( scene, count, sizeof *sorted );
    if ( !sorted )
    {
        return scene_no_memory( r );
    }
    for ( size_t i = 0; i < count; ++i )
    {
        sorted[i] = &scene->outputs[i];
    }
    qsort( sorted, count, sizeof *sorted, compare_files );
    for ( size_t i = 1; i < count; ++i )
    {
        if ( strcmp( sorted[i]->file, sorted[i - 1]->file ) == 0 )
        {
            return scene_refuse( r->source, sorted[i]->line, sorted[i]->column, r->path,
                                 "the file '%s' is written in line %d already", scene_shorten( sorted[i]->file ).text,
                                 sorted[i - 1]->line );
        }
    }
    return WISP_OK;
}

wisp_status scene_read_outputs( scene_reader* r, const scene_node* node, void* base )
{
    wisp_scene* scene = base;
    wisp_status status = scene_expect_list( r, node, "a list of files to write" );
    if ( status || node->count == 0 )
    {
        return status;
    }
    scene->outputs = scene_take( scene, (size_t)node->count, sizeof *scene->outputs );
    if ( !scene->outputs )
    {
        return scene_no_memory( r );
    }
    for ( const scene_node* item = scene_first( r->tree, node ); item; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, scene->output_count );
        status = read_output( r, item, &scene->outputs[scene->output_count++] );
        if ( status )
        {
            return status;
        }
        scene_leave( r, outside );
    }
    return refuse_equal_files( r );
}

// ---- the scene ----

wisp_status scene_read_version( scene_reader* r, const scene_node* node, void* base )
{
    (void)base;
    static const scene_field version = { "wisp", SCENE_WHOLE, .range = { 0, 1e9 } };
    int value = 0;
    wisp_status status = scene_read_whole( r, node, &version, &value );
    if ( !status && value != WISP_SCENE_VERSION )
    {
        return scene_refuse_node( r, node, "got version %d, expected version %d", value, WISP_SCENE_VERSION );
    }
    return status;
}

// Check the version first: a newer scene has keys that would only be called unknown.
static wisp_status check_version( scene_reader* r, const scene_node* root )
{
    for ( const scene_node* child = scene_first( r->tree, root ); child; child = scene_next( r->tree, child ) )
    {
        if ( root->kind == SCENE_MAP && strcmp( scene_key_of( r->tree, child ), "wisp" ) == 0 )
        {
            size_t outside = scene_enter_key( r, "wisp" );
            wisp_status status = scene_read_version( r, child, NULL );
            scene_leave( r, status ? r->path_length : outside );
            return status;
        }
    }
    return WISP_OK;
}

// Without the key `compute` a scene would simulate nothing, since passes without a request do not exist.
static void request_by_default( wisp_scene* scene )
{
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        wisp_scene_strands* strands = scene->strands + i;
        strands->request_points |= strands->has_compute == false && strands->is_shown;
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        scene->surfaces[i].request_points |= scene->surfaces[i].has_compute == false;
    }
}

static wisp_status read_root( const scene_source* source, const scene_tree* tree, wisp_scene* scene )
{
    scene_reader r = { .source = source, .tree = tree, .scene = scene };
    size_t length = strlen( source->name );
    char* name = scene_take( scene, length + 1, 1 );
    if ( !name )
    {
        return scene_no_memory( &r );
    }
    memcpy( name, source->name, length );
    scene->name = name;

    const scene_node* root = &tree->nodes[0];
    if ( root->kind != SCENE_MAP )
    {
        return scene_refuse_kind( &r, root, "a mapping with the key 'wisp'" );
    }
    wisp_status status = check_version( &r, root );
    status = status ? status : scene_read_block( &r, root, &SCENE_BLOCK_OF_ALL, scene );
    request_by_default( scene );
    return status ? status : scene_bind_roots( &r, root );
}

wisp_scene scene_defaults( void )
{
    return ( wisp_scene ){
        .dt = 1.0f / 60.0f,
        .steps = 1,
        .substeps = 10,
        .iterations = 1,
        .gravity = { 0.0f, -9.8f, 0.0f },
        .contact = wisp_default_contact_settings(),
    };
}

wisp_status wisp_scene_parse( const char* text, size_t size, const char* name, wisp_scene* out, wisp_error* error )
{
    *out = ( wisp_scene ){ 0 };
    const scene_source source = { name, text, size, error };
    wisp_scene scene = scene_defaults();

    io_numbers numbers;
    wisp_status status = io_numbers_begin( &numbers, error );
    if ( status )
    {
        return status;
    }
    scene_tree tree;
    status = scene_tree_build( &source, &tree );
    if ( !status )
    {
        status = read_root( &source, &tree, &scene );
    }
    scene_tree_release( &tree );
    io_numbers_end( &numbers );

    if ( status )
    {
        wisp_scene_release( &scene );
        return status;
    }
    *out = scene;
    return WISP_OK;
}

wisp_status wisp_scene_read( const char* path, wisp_scene* out, wisp_error* error )
{
    *out = ( wisp_scene ){ 0 };
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, SCENE_MAX_BYTES, &bytes, &size, error );
    if ( status )
    {
        return status;
    }
    status = wisp_scene_parse( bytes ? (const char*)bytes : "", size, path, out, error );
    free( bytes );
    return status;
}
