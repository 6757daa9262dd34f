#include "scene_calls.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

// ---- values as C ----

c_text c_number( float value )
{
    c_text n;
    snprintf( n.text, sizeof( n.text ), "%.9g", (double)value );
    const bool is_whole = strpbrk( n.text, ".en" ) == NULL; // inf and nan have an n
    snprintf( n.text, sizeof( n.text ), isinf( value ) ? "INFINITY" : is_whole ? "%.9g.0f" : "%.9gf", (double)value );
    return n;
}

static c_text text_of( const char* format, ... )
{
    c_text t;
    va_list values;
    va_start( values, format );
    vsnprintf( t.text, sizeof( t.text ), format, values );
    va_end( values );
    return t;
}

c_text c_whole( int64_t value )
{
    return text_of( "%lld", (long long)value );
}

c_text c_switch( bool value )
{
    return text_of( value ? "true" : "false" );
}

static c_text three( wisp_vec3 v )
{
    return text_of( "{ %s, %s, %s }", c_number( v.x ).text, c_number( v.y ).text, c_number( v.z ).text );
}

c_text c_vector( wisp_vec3 v )
{
    return text_of( "( wisp_vec3 )%s", three( v ).text );
}

c_text c_transform( wisp_transform t )
{
    const wisp_quat q = t.rotation;
    return text_of( "( wisp_transform ){ { %s, %s, %s, %s }, %s }", c_number( q.x ).text, c_number( q.y ).text,
                    c_number( q.z ).text, c_number( q.w ).text, three( t.translation ).text );
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

void scene_call_value( scene_world* world, c_text value )
{
    tell( world, ", %s", value.text );
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
        tell( world, "%s%s%s", i == 0 ? ", ( const wisp_vec3[] ){ " : ", ", three( points[i] ).text,
              i == count - 1 ? " }" : "" );
    }
}

void scene_call_end( scene_world* world, const char* last )
{
    tell( world, "%s ) );\n", last );
}
