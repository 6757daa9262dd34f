#include "scene_calls.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

// ---- values as C ----

number_text c_number( float value )
{
    number_text n;
    snprintf( n.text, sizeof( n.text ), "%.9g", (double)value );
    const bool is_whole = strpbrk( n.text, ".en" ) == NULL; // inf and nan have an n
    snprintf( n.text, sizeof( n.text ), isinf( value ) ? "INFINITY" : is_whole ? "%.9g.0f" : "%.9gf", (double)value );
    return n;
}

static void write_three( FILE* out, wisp_vec3 v )
{
    fprintf( out, "{ %s, %s, %s }", c_number( v.x ).text, c_number( v.y ).text, c_number( v.z ).text );
}

void c_vector( FILE* out, wisp_vec3 v )
{
    fputs( "( wisp_vec3 )", out );
    write_three( out, v );
}

void c_transform( FILE* out, wisp_transform t )
{
    const wisp_quat q = t.rotation;
    fprintf( out, "( wisp_transform ){ { %s, %s, %s, %s }, ", c_number( q.x ).text, c_number( q.y ).text,
             c_number( q.z ).text, c_number( q.w ).text );
    write_three( out, t.translation );
    fputs( " }", out );
}

// ---- calls as C ----

static void tell( const scene_world* world, const char* format, ... )
{
    va_list values;
    va_start( values, format );
    if ( world->calls != NULL )
    {
        vfprintf( world->calls, format, values );
    }
    va_end( values );
}

// Entries have the names of variables.
void scene_call_entity( scene_world* world, wisp_entity value )
{
    const wisp_scene* scene = world->scene;
    const int strands = scene->strands_count, surfaces = strands + scene->surface_count;
    for ( int i = 0; world->calls != NULL && i < surfaces + scene->collider_count; ++i )
    {
        const wisp_entity one = i < strands    ? world->entities[i]
                                : i < surfaces ? world->surfaces[i - strands].entity
                                               : world->colliders[i - surfaces].entity;
        if ( memcmp( &one, &value, sizeof( one ) ) == 0 )
        {
            tell( world, ", %s%d",
                  i < strands    ? "strands"
                  : i < surfaces ? "surface"
                                 : "collider",
                  i < strands    ? i
                  : i < surfaces ? i - strands
                                 : i - surfaces );
        }
    }
}

void scene_call_begin( scene_world* world, const char* function, wisp_entity entity )
{
    if ( world->last_call < world->next_step )
    {
        tell( world, "%sstatic wisp_status before_%d( wisp_world* world )\n{\n",
              world->last_call >= 0 ? "    return WISP_OK;\n}\n\n" : "\n", world->next_step );
        world->last_call = world->calls != NULL ? world->next_step : world->last_call;
    }
    tell( world, "    TRY( %s( world", function );
    scene_call_entity( world, entity );
}

void scene_call_number( scene_world* world, float value )
{
    tell( world, ", %s", c_number( value ).text );
}

void scene_call_whole( scene_world* world, int value )
{
    tell( world, ", %d", value );
}

void scene_call_switch( scene_world* world, bool value )
{
    tell( world, value ? ", true" : ", false" );
}

void scene_call_vector( scene_world* world, wisp_vec3 value )
{
    tell( world, ", ( wisp_vec3 ){ %s, %s, %s }", c_number( value.x ).text, c_number( value.y ).text,
          c_number( value.z ).text );
}

void scene_call_transform( scene_world* world, wisp_transform value )
{
    tell( world, ", " );
    if ( world->calls != NULL )
    {
        c_transform( world->calls, value );
    }
}

void scene_call_vertices( scene_world* world, const int32_t* vertices, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        tell( world, "%s%d%s", i == 0 ? ", ( const int32_t[] ){ " : ", ", (int)vertices[i],
              i == count - 1 ? " }" : "" );
    }
}

void scene_call_points( scene_world* world, const wisp_vec3* points, int count )
{
    for ( int i = 0; i < count && world->calls != NULL; ++i )
    {
        tell( world, i == 0 ? ", ( const wisp_vec3[] ){ " : ", " );
        write_three( world->calls, points[i] );
        tell( world, i == count - 1 ? " }" : "" );
    }
}

void scene_call_end( scene_world* world, const char* last )
{
    tell( world, "%s ) );\n", last );
}
