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

static int list_scenes( void )
{
    int count;
    const effect* all = effects_all( &count );
    puts( "empty" );
    for ( int i = 0; i < count; ++i )
    {
        printf( "%s\n%s-off\n", all[i].name, all[i].name );
    }
    return 0;
}

// "empty", the name of an effect, or that and "-off": its entity without it.
static bool read_scene( const char* text, effect_world_def* def, const effect** storage )
{
    if ( strcmp( text, "empty" ) == 0 )
    {
        return true;
    }
    char name[64];
    const char* off = strstr( text, "-off" );
    const int length = (int)( off != NULL ? off - text : (ptrdiff_t)strlen( text ) );
    snprintf( name, sizeof( name ), "%.*s", length, text );
    *storage = effects_find( name );
    def->effects = storage;
    def->count = 1;
    def->is_on = off == NULL;
    return *storage != NULL && ( off == NULL || strcmp( off, "-off" ) == 0 );
}

int main( int argc, char** argv )
{
    if ( argc == 2 && strcmp( argv[1], "list" ) == 0 )
    {
        return list_scenes();
    }
    const effect* storage = NULL;
    effect_world_def def = { .size = { .side = 10, .level = 1, .strands = 100 },
                             .allocator = { .allocate = allocate_pages, .release = release_pages } };
    const bool every = argc == 4 && strcmp( argv[1], "every" ) == 0;
    const int steps = argc == 4 ? atoi( argv[3] ) : 0;
    if ( steps < 1 || ( !every && strcmp( argv[1], "used" ) != 0 ) || !read_scene( argv[2], &def, &storage ) )
    {
        fputs( "usage: wisp_instructions list | every|used SCENE STEPS\n", stderr );
        return 64;
    }
    def.registry = every ? EFFECT_EVERY : EFFECT_USED;

    wisp_error error = { 0 };
    effect_world world;
    wisp_status status = effect_world_open( &def, &world, &error );
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        status = effect_world_step( &world, &error );
    }
    if ( status != WISP_OK )
    {
        fprintf( stderr, "wisp_instructions: %s\n", error.message );
    }
    else
    {
        printf( "%d modules, %d passes\n", world.module_count, wisp_world_plan_passes( world.world ) );
    }
    effect_world_close( &world );
    return status == WISP_OK ? 0 : 2;
}
