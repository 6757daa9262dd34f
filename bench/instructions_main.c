// Steps the small scene of each effect on one worker, with every module registered and with only those of the scene.
// instructions.sh counts the instructions of the steps: an unused module must not cost a single one.
#include "effects/effect_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The C library's memcpy chooses its path by the positions of source and target within a page. Memory of registered
// modules moves other blocks; with pages of their own they keep their position within a page.
#define PAGE 4096u

enum
{
    FIRST_STEPS = 13, // cloth tears in the first ones, and its plan is made anew
    COUNTED_STEPS = 10,
};

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

// What is counted: repeated steps. The first ones compile the plan and fill buffers.
__attribute__( ( noinline ) ) wisp_status counted_steps( effect_world* world, wisp_error* error );

wisp_status counted_steps( effect_world* world, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < COUNTED_STEPS && status == WISP_OK; ++i )
    {
        status = effect_world_step( world, error );
    }
    return status;
}

static wisp_status count( const effect_world_def* def, const char* name, wisp_error* error )
{
    effect_world* world;
    wisp_status status = effect_world_open( def, &world, error );
    for ( int i = 0; i < FIRST_STEPS && status == WISP_OK; ++i )
    {
        status = effect_world_step( world, error );
    }
    if ( status == WISP_OK )
    {
        status = counted_steps( world, error );
        printf( "%s %d %d\n", name, world->world.module_count, wisp_world_plan_passes( world->world.world ) );
    }
    effect_world_close( world );
    return status;
}

static wisp_status count_scene( const effects* all, const char* name, wisp_error* error )
{
    const wisp_allocator allocator = { .allocate = allocate_pages, .release = release_pages };
    effect_world_def def = { .all = all,
                             .size = { .side = 10, .level = 1, .strands = 100 },
                             .allocator = &allocator };
    int effect;
    if ( read_scene( all, name, &def, &effect ) == false )
    {
        snprintf( error->message, sizeof( error->message ), "there is no scene '%s'", name );
        return WISP_BAD_INPUT;
    }
    const wisp_status status = count( &def, name, error );
    def.only_used = true;
    return status == WISP_OK ? count( &def, name, error ) : status;
}

int main( int argc, char** argv )
{
    effects all;
    wisp_error error = { 0 };
    wisp_status status = effects_read( &all, &error );
    for ( int i = 1; i < argc && status == WISP_OK; ++i )
    {
        status = count_scene( &all, argv[i], &error );
    }
    for ( int i = -1; i < all.count && argc == 1 && status == WISP_OK; ++i )
    {
        char off[64];
        const char* name = i < 0 ? "empty" : effects_name( &all, i );
        snprintf( off, sizeof( off ), "%s-off", name );
        status = count_scene( &all, name, &error );
        status = i >= 0 && status == WISP_OK ? count_scene( &all, off, &error ) : status;
    }
    effects_release( &all );
    if ( status != WISP_OK )
    {
        fprintf( stderr, "wisp_instructions: %s\n", error.message );
    }
    return status == WISP_OK ? 0 : 2;
}
