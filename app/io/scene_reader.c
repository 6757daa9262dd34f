#include "scene_reader.h"
#include "io_file.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

// ---- memory ----

// A block of a scene's memory; blocks are chained and freed together.
typedef struct memory_block
{
    struct memory_block* next;
    max_align_t bytes[];
} memory_block;

void* scene_take( wisp_scene* scene, size_t count, size_t size )
{
    if ( count == 0 || count > ( SIZE_MAX - sizeof( memory_block ) ) / size )
    {
        return NULL;
    }
    memory_block* block = calloc( 1, sizeof *block + count * size );
    if ( !block )
    {
        return NULL;
    }
    block->next = scene->blocks;
    scene->blocks = block;
    return block->bytes;
}

void wisp_scene_release( wisp_scene* scene )
{
    if ( !scene )
    {
        return;
    }
    for ( memory_block* block = scene->blocks; block; )
    {
        memory_block* next = block->next;
        free( block );
        block = next;
    }
    *scene = ( wisp_scene ){ 0 };
}

wisp_status scene_no_memory( const scene_reader* r )
{
    return wisp_fail( r->source->error, WISP_NO_MEMORY, "%s: out of memory for the scene",
                      io_short_name( r->source->name ) );
}

// ---- where we are ----

static size_t lengthen( scene_reader* r, int printed )
{
    size_t before = r->path_length;
    size_t room = sizeof r->path - before - 1;
    r->path_length += (size_t)printed < room ? (size_t)printed : room;
    return before;
}

size_t scene_enter_key( scene_reader* r, const char* key )
{
    return lengthen( r, snprintf( r->path + r->path_length, sizeof r->path - r->path_length, "%s%s",
                                  r->path_length ? "." : "", key ) );
}

size_t scene_enter_index( scene_reader* r, int index )
{
    return lengthen( r, snprintf( r->path + r->path_length, sizeof r->path - r->path_length, "[%d]", index ) );
}

void scene_leave( scene_reader* r, size_t path_length )
{
    r->path_length = path_length;
    r->path[path_length] = 0;
}

wisp_status scene_refuse_node( const scene_reader* r, const scene_node* node, const char* format, ... )
{
    char message[420];
    va_list arguments;
    va_start( arguments, format );
    vsnprintf( message, sizeof message, format, arguments );
    va_end( arguments );
    return scene_refuse( r->source, node->line, node->column, r->path, "%s", message );
}
