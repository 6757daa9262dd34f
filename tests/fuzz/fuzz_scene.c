// Any bytes as a scene: refused with one sentence that begins with the name, or read into a scene whose promises hold.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size );

static void demand( bool condition )
{
    if ( !condition )
    {
        abort();
    }
}

static void demand_sentence( const wisp_error* error )
{
    static const char name[] = "fuzz.yaml:";
    demand( error->status == WISP_BAD_INPUT );
    demand( strncmp( error->sentence, name, sizeof name - 1 ) == 0 );
    for ( const char* c = error->sentence; *c; ++c )
    {
        demand( (unsigned char)*c >= 0x20 && *c != 0x7f );
    }
}

static void demand_numbers( const float* values, int count, float low, float high )
{
    demand( ( values == NULL ) == ( count == 0 ) );
    for ( int i = 0; i < count; ++i )
    {
        demand( values[i] >= low && values[i] <= high );
    }
}

static void demand_climate( const wisp_climate_def* climate )
{
    int last = climate->point_count - 1;
    demand( last >= 1 && last < WISP_CLIMATE_MAX_POINTS );
    demand( climate->ice[0] == 0.0f && climate->ice[last] == 1.0f && climate->span > 0.0f );
    bool rises = false, falls = false;
    for ( int i = 1; i <= last; ++i )
    {
        demand( climate->ice[i] > climate->ice[i - 1] );
        rises = rises || climate->stiffness[i] > climate->stiffness[i - 1];
        falls = falls || climate->stiffness[i] < climate->stiffness[i - 1];
    }
    demand( !rises || !falls );
}

static void demand_strands( const wisp_scene_strands* strands )
{
    const wisp_frozen_hair_def* hair = &strands->frozen_hair;
    demand( strands->name && strlen( strands->name ) <= WISP_SCENE_MAX_NAME && strands->line > 0 );
    demand( strands->is_made == ( strands->file == NULL ) );
    demand_numbers( hair->strand_stretch_stiffness, strands->stretch_count, 1e-3f, 1e12f );
    demand_numbers( hair->strand_bend_stiffness, strands->bend_count, 1e-3f, 1e12f );
    demand_numbers( hair->strand_intensity, strands->intensity_count, 0.0f, 1.0f );
    demand( strands->bend_count == 0 || !strands->is_made || strands->bend_count == strands->recipe.strand_count );
    demand( isfinite( hair->reach ) && isfinite( hair->cursor.x ) && hair->clump_radius > 0.0f );
    demand( strands->has_look || !( strands->want_width || strands->want_colour ) );
    demand_climate( &strands->climate );
}

static void demand_scene( const wisp_scene* scene )
{
    demand( scene->step_seconds > 0.0f && isfinite( scene->step_seconds ) && scene->steps >= 0 );
    demand( scene->substeps >= 1 && scene->iterations >= 1 );
    demand( scene->workers >= 0 && scene->workers <= WISP_MAX_WORKERS );
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        demand_strands( &scene->strands[i] );
    }
    for ( int i = 0; i < scene->command_count; ++i )
    {
        const wisp_scene_command* command = &scene->commands[i];
        demand( command->strands >= 0 && command->strands < scene->strands_count );
        demand( command->step >= 0 && command->step < scene->steps );
        demand( i == 0 || command->step >= command[-1].step );
        demand( scene->strands[command->strands].has_frozen_hair );
    }
    for ( int i = 0; i < scene->output_count; ++i )
    {
        const wisp_scene_output* output = &scene->outputs[i];
        demand( output->strands >= 0 && output->strands < scene->strands_count && output->file[0] );
        demand( scene->strands[output->strands].want_points );
    }
}

int LLVMFuzzerTestOneInput( const uint8_t* data, size_t size )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    wisp_status status = wisp_scene_parse( (const char*)data, size, "fuzz.yaml", &scene, &error );
    if ( status )
    {
        demand( status == WISP_BAD_INPUT && !scene.strands && !scene.blocks );
        demand_sentence( &error );
    }
    else
    {
        demand_scene( &scene );
    }
    wisp_scene_release( &scene );
    return 0;
}
