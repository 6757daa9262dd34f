// Steps a small scene on one worker, with every module registered or only those the scene uses. instructions.sh
// counts what the steps execute: a module that no scene asks for must not cost a single instruction.
#include "frozen_hair/frozen_hair.h"
#include "groom.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WISP_MODULE( name ) extern const wisp_module wisp_##name##_module;
#include "modules.inc"
#undef WISP_MODULE

#define WISP_MODULE( name ) &wisp_##name##_module,
static const wisp_module* const every_module[] = {
#include "modules.inc"
};
#undef WISP_MODULE

static const wisp_module* const hair_module[] = { &wisp_frozen_hair_module };

// The C library's memcpy chooses its way by how source and target lie within a page. Where registered modules hold
// memory too, blocks lie elsewhere; on pages of their own they lie at the same place of a page whatever came before.
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

static const wisp_vec3 cursor = { 0.3f, -1.0f, 0.0f };

static wisp_status add_hair( wisp_world* world, wisp_entity* hair, wisp_error* error )
{
    wisp_groom_recipe recipe = wisp_default_groom_recipe( WISP_GROOM_WAVY, 2 );
    recipe.strand_count = 100;
    recipe.vertices_per_strand = 20;
    recipe.spacing = 0.0005f;
    wisp_groom groom;
    wisp_status status = wisp_groom_make( &recipe, &groom, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_strands_def strands = wisp_default_strands_def();
    strands.points = groom.points;
    strands.offsets = groom.offsets;
    strands.strand_count = groom.strand_count;
    strands.dimension = 2;
    status = wisp_add_strands( world, &strands, hair );
    wisp_groom_release( &groom );

    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.cursor = cursor;
    def.reach = 10.0f;
    def.clump_radius = 0.0045f;
    status = status == WISP_OK ? wisp_set_frozen_hair( world, *hair, &def ) : status;
    return status == WISP_OK ? wisp_want( world, *hair, WISP_STRAND_POINTS ) : status;
}

static wisp_status step_often( wisp_world* world, wisp_entity hair, bool has_hair, int steps )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < steps && status == WISP_OK; ++i )
    {
        status = has_hair ? wisp_command_frozen_hair( world, hair, cursor ) : WISP_OK;
        status = status == WISP_OK ? wisp_world_step( world, 1.0f / 60.0f ) : status;
    }
    return status;
}

int main( int argc, char** argv )
{
    bool every = argc == 4 && strcmp( argv[1], "every" ) == 0;
    bool has_hair = argc == 4 && strcmp( argv[2], "hair" ) == 0;
    int steps = argc == 4 ? atoi( argv[3] ) : 0;
    if ( steps < 1 || ( !every && strcmp( argv[1], "used" ) != 0 ) ||
         ( !has_hair && strcmp( argv[2], "empty" ) != 0 ) )
    {
        fputs( "usage: wisp_instructions every|used hair|empty STEPS\n", stderr );
        return 64;
    }

    // An empty scene uses no module at all.
    wisp_world_def def = wisp_default_world_def();
    def.modules = every ? every_module : hair_module;
    def.module_count = every ? WISP_COUNT( every_module ) : has_hair ? 1 : 0;
    def.workers = 1;
    def.allocator = ( wisp_allocator ){ .allocate = allocate_pages, .release = release_pages };
    wisp_error error = { 0 };
    wisp_world* world = NULL;
    wisp_entity hair = { 0 };
    wisp_status status = wisp_world_create( &def, &world, &error );
    if ( status == WISP_OK && has_hair )
    {
        status = add_hair( world, &hair, &error );
    }
    if ( status == WISP_OK )
    {
        status = step_often( world, hair, has_hair, steps );
    }
    if ( status != WISP_OK )
    {
        fprintf( stderr, "wisp_instructions: %s\n", world ? wisp_world_message( world ) : error.sentence );
    }
    else
    {
        printf( "%d modules, %d passes\n", def.module_count, wisp_world_plan_passes( world ) );
    }
    wisp_world_destroy( world );
    return status == WISP_OK ? 0 : 2;
}
