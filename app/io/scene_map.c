// Maps: values of a key that differ from vertex to vertex.
#include "io_file.h"
#include "scene_parts.h"
#include "scene_ranges.h"

#include "wisp/module/definition.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A file whose name is the word is written ./colours.
static const char COLOURS[] = "colours";

static wisp_status read_source( scene_reader* r, const text_node* node, void* at )
{
    wisp_scene_map* map = at;
    const char* text = NULL;
    wisp_status status = scene_read_text( r, node, &text );
    if ( !status && strcmp( text, "colors" ) == 0 )
    {
        return scene_refuse_node( r, node, "got 'colors', did you mean '%s'?", COLOURS );
    }
    return status || strcmp( text, COLOURS ) == 0 ? status : scene_read_file( r, node, &map->file );
}

static const scene_choice CHANNELS[] = {
    { "mean", "the mean of red, green and blue" }, { "r", "red" }, { "g", "green" }, { "b", "blue" }, { NULL, NULL },
};

#define AT( member ) offsetof( wisp_scene_map, member )
static const scene_field MAP_FIELDS[] = {
    { "map", SCENE_CUSTOM, .required = true, .read = read_source,
      .help = "Text file with one number per vertex, in the order of the mesh; or an image (.png); or `colours`." },
    { "channel", SCENE_CHOICE, .at = AT( channel ), .choices = CHANNELS,
      .help = "What counts of a colour, of an image or of the vertices." },
    { "from", SCENE_NUMBER, .at = AT( from ), .range = RANGE( -1e12, 1e12 ), .help = "Value of 0 in the file." },
    { "to", SCENE_NUMBER, .at = AT( to ), .range = RANGE( -1e12, 1e12 ), .help = "Value of 1 in the file." },
};
#undef AT
static const scene_block MAP_BLOCK = SCENE_BLOCK_ALONE( MAP_FIELDS );

wisp_status scene_read_map( scene_reader* r, const text_node* node, const scene_field* field, void* base )
{
    wisp_scene_surface* surface = base;
    if ( surface->maps == NULL )
    {
        surface->maps = scene_take( r->scene, WISP_SCENE_MAX_MAPS, sizeof *surface->maps );
    }
    if ( surface->maps == NULL )
    {
        return scene_no_memory( r );
    }
    WISP_ASSERT( surface->map_count < WISP_SCENE_MAX_MAPS );
    wisp_scene_map* map = surface->maps + surface->map_count;
    *map = ( wisp_scene_map ){ .map = field->map, .to = 1.0f, .line = node->line, .column = node->column };
    WISP_TRY( scene_read_block( r, node, &MAP_BLOCK, map ) );
    const text_node* channel = text_find_path( node, "channel" );
    if ( channel && map->file && !wisp_scene_map_is_image( map ) )
    {
        return scene_refuse_node( r, channel, "'channel' needs an image (.png) or 'map: %s'", COLOURS );
    }
    if ( map->from == map->to )
    {
        return scene_refuse_node( r, node,
                                  "got %g for both 'from' (default 0) and 'to' (default 1), so the map says nothing",
                                  (double)map->to );
    }
    snprintf( map->path, sizeof map->path, "%s", field->key );
    map->lower = (float)field->range.lower;
    map->upper = (float)field->range.upper;
    map->constant = fmaxf( map->from, map->to );
    if ( !( map->constant > 0.0f && (double)map->constant <= field->range.upper ) )
    {
        return scene_refuse_node( r, node, "got values from %g to %g, expected the larger above 0 and at most %g",
                                  (double)map->from, (double)map->to, field->range.upper );
    }
    surface->map_count += 1;
    *(float*)(void*)( (char*)base + field->at ) = map->constant;
    return WISP_OK;
}

bool wisp_scene_map_is_image( const wisp_scene_map* map )
{
    const size_t length = map->file ? strlen( map->file ) : 0;
    return length > 4 &&
           ( strcmp( map->file + length - 4, ".png" ) == 0 || strcmp( map->file + length - 4, ".PNG" ) == 0 );
}

// ---- numbers of a file ----

static wisp_status refuse_number( const wisp_scene_map* map, int line, const char* at, wisp_error* error )
{
    char word[24] = "";
    for ( size_t n = 0; n + 1 < sizeof word && isgraph( (unsigned char)at[n] ); ++n )
    {
        word[n] = at[n];
        word[n + 1] = '\0';
    }
    return word[0] != '\0' ? wisp_fail( error, WISP_BAD_INPUT, "%s:%d: got '%s', expected a finite number",
                                        io_short_name( map->file ), line, word )
                           : wisp_fail( error, WISP_BAD_INPUT,
                                        "%s:%d: got a byte that is no text, expected numbers, or an image "
                                        "that ends in .png",
                                        io_short_name( map->file ), line );
}

// Numbers between spaces, commas and ends of lines.
static wisp_status parse( const wisp_scene_map* map, const char* text, const char* end, int count, float* out,
                          wisp_error* error )
{
    int found = 0, line = 1;
    for ( const char* at = text; at < end; )
    {
        if ( isspace( (unsigned char)*at ) || *at == ',' || *at == ';' )
        {
            line += *at == '\n' ? 1 : 0;
            at += 1;
            continue;
        }
        char* rest;
        const float value = strtof( at, &rest );
        if ( rest == at || !isfinite( value ) )
        {
            return refuse_number( map, line, at, error );
        }
        if ( found < count )
        {
            out[found] = value;
        }
        found += 1;
        at = rest;
    }
    return found == count ? WISP_OK
                          : wisp_fail( error, WISP_BAD_INPUT, "%s: got %d numbers, but the mesh has %d vertices",
                                       io_short_name( map->file ), found, count );
}

wisp_status wisp_scene_map_numbers( const wisp_scene_map* map, int count, float* out, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    io_numbers numbers;
    wisp_status status = io_file_read( map->file, (size_t)count * 64 + 4096, &bytes, &size, error );
    char* text = status == WISP_OK ? malloc( size + 1 ) : NULL;
    if ( status == WISP_OK && text == NULL )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory", io_short_name( map->file ) );
    }
    status = status == WISP_OK ? io_numbers_begin( &numbers, error ) : status;
    if ( status == WISP_OK )
    {
        if ( size > 0 )
        {
            memcpy( text, bytes, size );
        }
        text[size] = '\0';
        status = parse( map, text, text + size, count, out, error );
        io_numbers_end( &numbers );
    }
    free( text );
    free( bytes );
    return status;
}
