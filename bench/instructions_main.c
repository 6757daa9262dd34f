// Steps the small scene of an effect on one worker, with every module registered or only those of the scene.
// instructions.sh counts the instructions of the steps: an unused module must not cost a single one.
#include "effects/effect_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The C library's memcpy chooses its path by the positions of source and target within a page. Memory of registered
// modules moves other blocks; with pages of their own they keep their position within a page.
#define PAGE 4096u

static void* allocate_pages( void* user, size_t size, size_t alignment )
{
    (void)user;
    return alignment <= PAGE ? aligned_alloc( PAGE, ( size + PAGE - 1 ) / PAGE * PAGE ) : NULL;
}

static void release_pages( void* user, void* block, size_t size )
{
    (void)user;
    (void)size;
    free( block );
}

static int list_scenes( const effects* all )
{
    puts( "empty" );
    for ( int i = 0; i < all->count; ++i )
    {
        printf( "%s\n%s-off\n", effects_name( all, i ), effects_name( all, i ) );
    }
    return 0;
}

// "empty", the name of an effect, or that and "-off": its bodies without it.
static bool read_scene( const effects* all, const char* text, effect_world_def* def, int* effect )
{
    char name[64];
    const char* off = strstr( text, "-off" );
    snprintf( name, sizeof( name ), "%.*s", (int)( off != NULL ? off - text : (ptrdiff_t)strlen( text ) ), text );
    *effect = effects_find( all, name );
    def->chosen = effect;
    def->count = *effect >= 0 ? 1 : 0;
    def->is_on = off == NULL;
    return strcmp( text, "empty" ) == 0 || ( *effect >= 0 && ( off == NULL || strcmp( off, "-off" ) == 0 ) );
}

static wisp_status count_steps( const effect_world_def* def, int steps, wisp_error* error )
{
    effect_world* world;
    wisp_status status = effect_world_open( def, &world, error );
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        status = effect_world_step( world, error );
    }
    if ( status == WISP_OK )
    {
        printf( "%d modules, %d passes\n", world->world.module_count, wisp_world_plan_passes( world->world.world ) );
    }
    effect_world_close( world );
    return status;
}

int main( int argc, char** argv )
{
    effects all;
    int effect;
    wisp_error error = { 0 };
    wisp_status status = effects_read( &all, &error );
    if ( status == WISP_OK && argc == 2 && strcmp( argv[1], "list" ) == 0 )
    {
        return list_scenes( &all );
    }
    const wisp_allocator allocator = { .allocate = allocate_pages, .release = release_pages };
    effect_world_def def = { .all = &all,
                             .size = { .side = 10, .level = 1, .strands = 100 },
                             .allocator = &allocator };
    def.only_used = argc == 4 && strcmp( argv[1], "used" ) == 0;
    const int steps = argc == 4 ? atoi( argv[3] ) : 0;
    if ( status == WISP_OK && ( steps < 1 || ( !def.only_used && strcmp( argv[1], "every" ) != 0 ) ||
                                !read_scene( &all, argv[2], &def, &effect ) ) )
    {
        fputs( "usage: wisp_instructions list | every|used SCENE STEPS\n", stderr );
        return 64;
    }
    status = status == WISP_OK ? count_steps( &def, steps, &error ) : status;
    effects_release( &all );
    if ( status != WISP_OK )
    {
        fprintf( stderr, "wisp_instructions: %s\n", error.message );
    }
    return status == WISP_OK ? 0 : 2;
}
