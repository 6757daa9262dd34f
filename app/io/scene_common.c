// Values that strands, surfaces and colliders have: names, files, layers.
#include "io_file.h"
#include "scene_parts.h"
#include "scene_ranges.h"

#include <string.h>

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

// The value is looked up once all names are known; here it is only made sure that it is one.
wisp_status scene_read_later_name( scene_reader* r, const scene_node* node, void* at )
{
    (void)at;
    const char* name = NULL;
    return scene_read_name( r, node, &name );
}

// Relative files are relative to the folder of the scene, not to the working directory.
wisp_status scene_read_file( scene_reader* r, const scene_node* node, void* at )
{
    const char* file = NULL;
    wisp_status status = scene_read_text( r, node, &file );
    *(const char**)at = file;
    const size_t folder = io_folder_length( r->source->name );
    if ( status || folder == 0 || file[0] == '/' )
    {
        return status;
    }
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

wisp_status scene_read_layers( scene_reader* r, const scene_node* node, void* at )
{
    static const scene_field layer = { "layer", SCENE_WHOLE, .range = RANGE( 0, 31 ) };
    wisp_status status = scene_expect_list( r, node, "a list of layers" );
    uint32_t bits = 0;
    int i = 0;
    for ( const scene_node* item = scene_first( r->tree, node ); item && !status; item = scene_next( r->tree, item ) )
    {
        size_t outside = scene_enter_index( r, i++ );
        int number = 0;
        status = scene_read_whole( r, item, &layer, &number );
        if ( !status && ( bits & ( 1u << number ) ) )
        {
            return scene_refuse_node( r, item, "layer %d is listed twice", number );
        }
        if ( !status )
        {
            bits |= 1u << number;
            scene_leave( r, outside );
        }
    }
    *(uint32_t*)at = bits;
    return status;
}

wisp_status scene_read_items( scene_reader* r, const scene_node* list, scene_item_fn* read, void* context )
{
    int i = 0;
    wisp_status status = WISP_OK;
    for ( const scene_node* item = scene_first( r->tree, list ); item && !status; item = scene_next( r->tree, item ) )
    {
        const size_t outside = scene_enter_index( r, i );
        status = read( r, item, i++, context );
        if ( !status )
        {
            scene_leave( r, outside );
        }
    }
    return status;
}

typedef struct number_list
{
    const scene_field* field;
    float* out;
} number_list;

static wisp_status read_number( scene_reader* r, const scene_node* item, int index, void* context )
{
    const number_list* list = context;
    return scene_read_number( r, item, list->field, &list->out[index] );
}

wisp_status scene_read_numbers( scene_reader* r, const scene_node* list, const scene_field* field, float* out )
{
    number_list numbers = { field, out };
    return scene_read_items( r, list, read_number, &numbers );
}

wisp_status scene_check_rises( scene_reader* r, const scene_node* node, float before, float time )
{
    return time > before ? WISP_OK
                         : scene_refuse_node( r, node, "got time %g, expected more than the time before, %g",
                                              (double)time, (double)before );
}
